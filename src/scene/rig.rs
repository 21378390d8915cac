//! Sensors as data: cameras with intrinsics and mount, LiDARs as lists of elevations.

use serde::{Deserialize, Serialize};

use super::Pose;

/// A pinhole camera without distortion; optical axes x right, y down, z forward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// As in the data set: `CAM_FRONT`.
    pub name: String,
    /// Image size in pixels.
    pub width: u32,
    /// Image size in pixels.
    pub height: u32,
    /// Focal lengths in pixels.
    pub focal_px: [f64; 2],
    /// Principal point in pixels.
    pub center_px: [f64; 2],
    /// Optical frame to ego: quaternion w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Optical centre in the ego frame, m.
    pub translation_m: [f64; 3],
}

impl Camera {
    /// Takes points of the optical frame to the ego frame.
    pub fn ego_from_camera(&self) -> Pose {
        Pose::from_wxyz(self.rotation_wxyz, self.translation_m)
    }

    /// The same view at another image size; the focal length and centre scale with each axis.
    pub fn resized(&self, width: u32, height: u32) -> Camera {
        let (sx, sy) = (
            f64::from(width) / f64::from(self.width),
            f64::from(height) / f64::from(self.height),
        );
        Camera {
            width,
            height,
            focal_px: [self.focal_px[0] * sx, self.focal_px[1] * sy],
            center_px: [self.center_px[0] * sx, self.center_px[1] * sy],
            ..self.clone()
        }
    }
}

/// How a spinning LiDAR samples directions and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LidarPattern {
    /// As in the data set: `LIDAR_TOP`.
    pub name: String,
    /// Elevation of each beam in degrees, lowest first; ring i is entry i.
    pub elevations_deg: Vec<f64>,
    /// Columns per revolution; column i looks at azimuth first + 2 pi i / n in the sensor frame.
    pub columns: u32,
    /// Azimuth of column 0 in the sensor frame, degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub first_azimuth_deg: f64,
    /// Sector that returns anything, degrees from the first azimuth; 360 is all round.
    #[serde(default = "full_turn", skip_serializing_if = "is_full_turn")]
    pub sector_deg: f64,
    /// Columns follow each other clockwise, seen from above.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clockwise: bool,
    /// Revolutions per second; 0 = the whole sweep at one instant. Otherwise column i is fired when the vehicle
    /// was (1 - i / n) of a revolution short of where it stands (see [`SensorRig::ego_speed_mps`]).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub spin_hz: f64,
    /// Farthest return, m.
    pub max_range_m: f64,
    /// Nearest return, m.
    pub min_range_m: f64,
    /// Sensor frame to ego: quaternion w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Origin in the ego frame, m.
    pub translation_m: [f64; 3],
}

impl LidarPattern {
    /// Takes points of the sensor frame to the ego frame.
    pub fn ego_from_sensor(&self) -> Pose {
        Pose::from_wxyz(self.rotation_wxyz, self.translation_m)
    }

    /// Columns that return anything: those in the sector.
    pub fn columns_in_sector(&self) -> u32 {
        let share = (self.sector_deg / 360.0).clamp(0.0, 1.0);
        // A hair less than the product, so that a third of 1080 columns is 360 and not 361.
        (f64::from(self.columns) * share - 1e-6).ceil().max(0.0) as u32
    }

    /// Azimuth of a column in the sensor frame, rad. Formed in f64 from the index, so the last column of a full turn
    /// and the first are one step apart like any other two.
    pub fn azimuth_rad(&self, column: u32) -> f64 {
        let turn = std::f64::consts::TAU * f64::from(column) / f64::from(self.columns.max(1));
        self.first_azimuth_deg.to_radians() + if self.clockwise { -turn } else { turn }
    }

    /// Rays per revolution.
    pub fn rays(&self) -> usize {
        self.elevations_deg.len() * self.columns_in_sector() as usize
    }
}

fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

fn full_turn() -> f64 {
    360.0
}

fn is_full_turn(v: &f64) -> bool {
    *v == 360.0
}

/// All sensors of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorRig {
    /// Name of the rig.
    pub name: String,
    /// Cameras in ring order, front left first.
    pub cameras: Vec<Camera>,
    /// LiDARs; the first one is the default.
    pub lidars: Vec<LidarPattern>,
    /// Length, width, height of the ego vehicle, m; its rear axle is the origin.
    pub ego_size_m: [f64; 3],
    /// From the rear axle to the middle of the ego vehicle, m.
    pub ego_center_m: [f64; 3],
    /// Forward speed while a LiDAR spins, m/s; it matters only where `spin_hz` is set.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub ego_speed_mps: f64,
}

impl SensorRig {
    /// What is wrong with this rig, if anything: finite numbers, sizes, focal lengths, angles.
    pub fn problem(&self) -> Option<String> {
        for c in &self.cameras {
            let numbers = [&c.focal_px[..], &c.center_px, &c.rotation_wxyz, &c.translation_m].concat();
            if numbers.iter().any(|v| !v.is_finite()) {
                return Some(format!("camera {}: a number is not finite", c.name));
            }
            if !(1..=16384).contains(&c.width) || !(1..=16384).contains(&c.height) {
                return Some(format!(
                    "camera {}: size is {}x{}, expected 1 to 16384",
                    c.name, c.width, c.height
                ));
            }
            if c.focal_px.iter().any(|f| *f <= 0.0) {
                return Some(format!(
                    "camera {}: focal_px is {:?}, expected above 0",
                    c.name, c.focal_px
                ));
            }
            if norm(&c.rotation_wxyz) < 1e-6 {
                return Some(format!("camera {}: rotation_wxyz is zero", c.name));
            }
        }
        for l in &self.lidars {
            let mut numbers = [&l.rotation_wxyz[..], &l.translation_m, &l.elevations_deg].concat();
            numbers.extend([
                l.max_range_m,
                l.min_range_m,
                l.first_azimuth_deg,
                l.sector_deg,
                l.spin_hz,
            ]);
            if numbers.iter().any(|v| !v.is_finite()) {
                return Some(format!("lidar {}: a number is not finite", l.name));
            }
            if !(1..=65535).contains(&l.columns) || !(1..=1024).contains(&l.elevations_deg.len()) {
                return Some(format!(
                    "lidar {}: {} beams and {} columns, expected 1 to 1024 and 1 to 65535",
                    l.name,
                    l.elevations_deg.len(),
                    l.columns
                ));
            }
            if l.elevations_deg.iter().any(|e| e.abs() > 90.0) {
                return Some(format!("lidar {}: an elevation is beyond 90 degrees", l.name));
            }
            if !(0.0..=360.0).contains(&l.sector_deg) || !(0.0..=1000.0).contains(&l.spin_hz) {
                return Some(format!(
                    "lidar {}: sector_deg is {}, spin_hz {}, expected 0 to 360 and 0 to 1000",
                    l.name, l.sector_deg, l.spin_hz
                ));
            }
            if norm(&l.rotation_wxyz) < 1e-6 {
                return Some(format!("lidar {}: rotation_wxyz is zero", l.name));
            }
        }
        let ego = [&self.ego_size_m[..], &self.ego_center_m, &[self.ego_speed_mps]].concat();
        if ego.iter().any(|v| !v.is_finite()) || self.ego_speed_mps.abs() > 200.0 {
            return Some(
                "the ego vehicle's size, place and speed are not finite, or it is faster than 200 m/s".into(),
            );
        }
        None
    }
}

fn norm(q: &[f64; 4]) -> f64 {
    q.iter().map(|v| v * v).sum::<f64>().sqrt()
}

impl Default for SensorRig {
    /// The nuScenes vehicle: six cameras and a 32-beam LiDAR (published calibration).
    fn default() -> Self {
        serde_json::from_str(include_str!("../../assets/rigs/nuscenes.json"))
            .expect("the bundled rig is checked by a test")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundled_rig_is_sound() {
        let rig = SensorRig::default();
        assert_eq!(rig.problem(), None);
        assert_eq!(rig.cameras.len(), 6);
        assert_eq!(rig.lidars[0].elevations_deg.len(), 32);
        let forward = rig.cameras[1].ego_from_camera().rotation * glam::DVec3::Z;
        assert!(forward.x > 0.99, "front camera looks along ego x, got {forward}");
    }

    #[test]
    fn problems_are_named() {
        let mut rig = SensorRig::default();
        rig.cameras[0].focal_px[0] = f64::NAN;
        assert!(rig.problem().expect("NaN").contains("CAM_FRONT_LEFT"));
        let mut rig = SensorRig::default();
        rig.lidars[0].elevations_deg.clear();
        assert!(rig.problem().expect("no beams").contains("LIDAR_TOP"));
    }
}
