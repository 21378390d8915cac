//! The own vehicle in the way of a LiDAR on its roof: which pulses end on it, at what distance, and which of those come
//! back. A tenth of the slots of real sweeps end there (`real_statistics.md`, section 3).

use glam::{DVec2, DVec3};

use scene::Pose;

use crate::lidar::EgoBox;

/// Edge of the roof and what is mounted on it as seen from the mast: angle from straight ahead in degrees (left and
/// right alike), distance in m. Fitted to the shares by ring and by azimuth of three real sweeps: long in front and
/// in the rear quarters, short at the sides, where the roof falls away.
const EDGE: [(f64, f64); 21] = [
    (0.0, 0.74),
    (12.0, 0.77),
    (22.0, 0.80),
    (30.0, 0.80),
    (36.0, 0.73),
    (50.0, 0.68),
    (62.0, 0.63),
    (75.0, 0.585),
    (88.0, 0.545),
    (96.0, 0.50),
    (112.0, 0.50),
    (118.0, 0.56),
    (128.0, 0.62),
    (140.0, 0.68),
    (149.0, 0.80),
    (153.0, 0.86),
    (159.0, 0.89),
    (161.5, 1.0),
    (164.0, 1.09),
    (168.0, 0.92),
    (180.0, 0.86),
];
/// Size of the vehicle that the edge belongs to, m.
const LENGTH_M: f64 = 4.08;
const WIDTH_M: f64 = 1.73;
/// The mast stands this far behind the middle of the vehicle, m.
const MAST_BEHIND_M: f64 = 0.056;
/// Mean height of the roof under the top of the vehicle's box, m: hits lie 0.33 m below the sensor.
const ROOF_BELOW_TOP_M: f64 = 0.05;
/// Largest height of a LiDAR above the roof, m: a higher one does not stand on this roof.
const HIGHEST_M: f64 = 1.5;
/// Distance below which an echo may come back too early to be timed, m; the share of such echoes grows with nearness.
const BLIND_M: f64 = 0.75;
const BLIND_PER_M: f64 = 2.9;
const MOST_BLIND: f64 = 0.45;

/// The roof of the own vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnBody {
    mast: DVec2,
    scale: DVec2,
    roof_m: f64,
    vehicle: Pose,
}

impl OwnBody {
    /// The roof of a vehicle; its outline grows with its length and width.
    pub fn new(ego: EgoBox) -> Self {
        let scale = DVec2::new(ego.size_m.x / LENGTH_M, ego.size_m.y / WIDTH_M);
        Self {
            mast: ego.center_m.truncate() - DVec2::X * (MAST_BEHIND_M * scale.x),
            scale,
            roof_m: ego.center_m.z + ego.size_m.z / 2.0 - ROOF_BELOW_TOP_M,
            vehicle: ego.vehicle,
        }
    }

    /// Distance to the own roof along a ray, m; `None` if it passes, also from below the roof and for
    /// numbers that are not finite. `direction` is a unit vector.
    pub fn meets(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let (origin, direction) = match self.vehicle == Pose::IDENTITY {
            true => (origin, direction),
            false => {
                let to_ego = self.vehicle.inverse();
                (to_ego.apply(origin), to_ego.rotation * direction)
            }
        };
        let above_m = origin.z - self.roof_m;
        if !(above_m > 0.0 && above_m <= HIGHEST_M && direction.z < 0.0) {
            return None;
        }
        let range_m = above_m / -direction.z;
        let at = ((origin + direction * range_m).truncate() - self.mast) / self.scale;
        let edge_m = edge_m(at.y.atan2(at.x).to_degrees().abs());
        (at.length() < edge_m && range_m.is_finite()).then_some(range_m)
    }
}

/// True if an echo from the own body at this distance is lost, too early to be timed; `fate` is uniform in 0..1.
pub fn is_blind(range_m: f64, fate: f64) -> bool {
    fate < ((BLIND_M - range_m) * BLIND_PER_M).clamp(0.0, MOST_BLIND)
}

fn edge_m(angle_deg: f64) -> f64 {
    let mut last = EDGE[0];
    for next in EDGE {
        if angle_deg < next.0 {
            return last.1 + (next.1 - last.1) * (angle_deg - last.0) / (next.0 - last.0);
        }
        last = next;
    }
    last.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::Rays;
    use scene::SensorRig;

    /// Mean of three real sweeps: share of a ring's slots that end on the own body, rings 0 to 12.
    const BY_RING: [f64; 13] = [
        0.583, 0.557, 0.524, 0.498, 0.443, 0.371, 0.306, 0.157, 0.041, 0.036, 0.017, 0.0, 0.0,
    ];
    /// The same, by sectors of 30 degrees from straight ahead to straight back.
    const BY_AZIMUTH: [f64; 6] = [0.153, 0.150, 0.038, 0.006, 0.102, 0.213];

    #[test]
    fn shares_by_ring_and_azimuth_are_those_of_real_sweeps() {
        let rig = SensorRig::default();
        let (pattern, body) = (&rig.lidars[0], OwnBody::new(EgoBox::of_rig(&rig)));
        let (rays, columns) = (Rays::new(pattern, DVec3::ZERO), pattern.columns as usize);
        let (mut ring, mut azimuth, mut slots) = ([0.0; 32], [0.0; 6], [0.0; 6]);
        for i in 0..rays.directions.len() {
            let (origin, direction) = rays.get(i);
            let bin = (direction.y.atan2(direction.x).to_degrees().abs() / 30.0) as usize;
            slots[bin.min(5)] += 1.0;
            // The fate of every echo runs evenly through 0..1.
            let fate = (i as f64 * 0.618_033_988_749_895).fract();
            if body
                .meets(origin, direction)
                .is_some_and(|range_m| !is_blind(range_m, fate))
            {
                ring[i / columns] += 1.0 / columns as f64;
                azimuth[bin.min(5)] += 1.0;
            }
        }
        let share = ring.iter().sum::<f64>() / 32.0;
        println!("{share:.4} {ring:.3?}");
        assert!((0.10..0.14).contains(&share), "{share}");
        assert!(ring[..9].iter().sum::<f64>() / 32.0 > 0.9 * share);
        for (i, (found, real)) in ring.iter().zip(BY_RING).enumerate() {
            assert!((found - real).abs() < 0.09, "ring {i}: {found} {real}");
        }
        for (bin, real) in BY_AZIMUTH.iter().enumerate() {
            let found = azimuth[bin] / slots[bin];
            println!("{bin} {found:.3} {real}");
            assert!((found - real).abs() < 0.045, "sector {bin}: {found} {real}");
        }
    }

    #[test]
    fn only_a_sensor_above_the_roof_meets_it() {
        let body = OwnBody::new(EgoBox::of_rig(&SensorRig::default()));
        let down = DVec3::new(0.3, 0.0, -0.8).normalize();
        let at = |z| DVec3::new(0.94, 0.0, z);
        assert!(body.meets(at(1.84), down).is_some());
        assert!(
            body.meets(at(1.84), -DVec3::Z)
                .is_some_and(|r| (r - 0.33).abs() < 1e-9)
        );
        assert!(body.meets(at(1.4), down).is_none(), "below the roof");
        assert!(body.meets(at(4.0), down).is_none(), "on a mast of its own");
        assert!(
            body.meets(DVec3::new(3.2, 0.0, 1.84), down).is_none(),
            "ahead of it"
        );
        assert!(body.meets(at(1.84), DVec3::X).is_none());
        for bad in [DVec3::NAN, DVec3::ZERO, DVec3::INFINITY, -DVec3::INFINITY] {
            assert_eq!(body.meets(bad, down), None);
            assert!(body.meets(at(1.84), bad).is_none_or(f64::is_finite));
        }
        let nothing = OwnBody::new(EgoBox {
            center_m: DVec3::ZERO,
            size_m: DVec3::ZERO,
            vehicle: Pose::IDENTITY,
        });
        assert_eq!(nothing.meets(DVec3::Z, -DVec3::Z), None);
    }
}
