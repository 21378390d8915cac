//! One revolution of a spinning LiDAR over the voxels: exact ranges, no noise, no dropped rays. The modules below add
//! what is kept between edits, shapes, the surroundings, materials, and learned sweeps.

pub mod caster;
pub mod learned;
pub mod learned_caster;
pub mod material;
pub mod observed;
pub mod own_body;
pub mod recorded;
pub mod rolling;
#[cfg(test)]
mod scenery_tests;
pub mod shaped;
pub mod surroundings;
mod texture;
pub mod truth;

use glam::DVec3;

use crate::lidar::caster::Caster;
use crate::raycast::ColumnMasks;
use scene::{Lattice, LidarPattern, LidarSweep, Pose, SensorRig, VoxelGrid};

/// The ego vehicle as a box along the ego frame's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EgoBox {
    /// Middle in the ego frame, m.
    pub center_m: DVec3,
    /// Length, width, height, m.
    pub size_m: DVec3,
    /// Pose of the ego frame in the frame of the grid and the sensors.
    pub vehicle: Pose,
}

impl EgoBox {
    /// The ego vehicle of a rig.
    pub fn of_rig(rig: &SensorRig) -> Self {
        Self {
            center_m: rig.ego_center_m.into(),
            size_m: rig.ego_size_m.into(),
            vehicle: rig.vehicle,
        }
    }

    /// True if a point of the grid's frame lies in it.
    pub fn contains(&self, p: DVec3) -> bool {
        let p_in_ego = match self.vehicle == Pose::IDENTITY {
            true => p,
            false => self.vehicle.inverse().apply(p),
        };
        (p_in_ego - self.center_m).abs().cmple(self.size_m / 2.0).all()
    }

    /// Corners of a box along the grid's axes around it, m.
    pub fn bounds_m(&self) -> (DVec3, DVec3) {
        let (center, half) = (self.vehicle.apply(self.center_m), self.size_m / 2.0);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (self.vehicle.rotation * axis).abs());
        let reach = match self.vehicle == Pose::IDENTITY {
            true => half,
            false => x * half.x + y * half.y + z * half.z,
        };
        (center - reach, center + reach)
    }
}

/// Unit direction in the sensor frame of a beam at an elevation and an azimuth.
pub fn direction_in_sensor(elevation_deg: f64, azimuth_rad: f64) -> DVec3 {
    let (sin_e, cos_e) = elevation_deg.to_radians().sin_cos();
    let (sin_a, cos_a) = azimuth_rad.sin_cos();
    DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// The rays of one revolution, beam-major.
#[derive(Clone, Debug)]
pub struct Rays {
    /// Origin of each column in the ego frame of the sweep's end, m.
    pub origins: Vec<DVec3>,
    /// Unit direction of each ray in the ego frame: beam * columns + column.
    pub directions: Vec<DVec3>,
}

impl Rays {
    /// Rays of a pattern; the vehicle drives at `velocity_mps` while the sensor spins.
    pub fn new(pattern: &LidarPattern, velocity_mps: DVec3) -> Self {
        let ego_from_sensor = pattern.ego_from_sensor();
        let columns = pattern.columns_in_sector();
        let origin = |column| ego_from_sensor.translation_m - velocity_mps * pattern.before_end_s(column);
        let azimuths: Vec<(f64, f64)> = (0..columns).map(|i| pattern.azimuth_rad(i).sin_cos()).collect();
        let mut directions = Vec::with_capacity(pattern.rays());
        for elevation_deg in &pattern.elevations_deg {
            let (sin_e, cos_e) = elevation_deg.to_radians().sin_cos();
            directions.extend(azimuths.iter().map(|&(sin_a, cos_a)| {
                ego_from_sensor.rotation * DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
            }));
        }
        Self {
            origins: (0..columns).map(origin).collect(),
            directions,
        }
    }

    /// Unit normals, ego frame, of the planes that hold the rays of each column of their `pattern`.
    pub fn normals(&self, pattern: &LidarPattern) -> Vec<DVec3> {
        let rotation = pattern.ego_from_sensor().rotation;
        let normal = |column: usize| {
            let (sin_a, cos_a) = pattern.azimuth_rad(column as u32).sin_cos();
            rotation * DVec3::new(-sin_a, cos_a, 0.0)
        };
        (0..self.origins.len()).map(normal).collect()
    }

    /// Origin and direction of a ray in the ego frame.
    #[inline]
    pub fn get(&self, ray: usize) -> (DVec3, DVec3) {
        (self.origins[ray % self.origins.len()], self.directions[ray])
    }
}

/// Casts one ray per beam and column, beam-major, and returns those that meet a voxel within the pattern's range
/// limits. Rays pass through voxels whose centre lies in `exclude` (the ego vehicle). The result does not depend on the
/// number of threads.
pub fn sweep(grid: &VoxelGrid, pattern: &LidarPattern, exclude: Option<EgoBox>) -> LidarSweep {
    Caster::new(grid, pattern, DVec3::ZERO, exclude).sweep()
}

/// Sweep of the first LiDAR of a rig on its moving vehicle; `None` if it has none.
pub fn rig_sweep(grid: &VoxelGrid, rig: &SensorRig) -> Option<LidarSweep> {
    let pattern = rig.lidars.first()?;
    Some(Caster::new(grid, pattern, rig.velocity_mps(), Some(EgoBox::of_rig(rig))).sweep())
}

/// Takes the voxels whose centre lies in the box out of the masks.
pub(super) fn look_through(masks: &mut ColumnMasks, ego: EgoBox) {
    let extent = masks.extent();
    let cell = |p: DVec3| extent.to_voxel_units(p).floor();
    let (low, high) = ego.bounds_m();
    let (low, high) = (cell(low), cell(high));
    // Casts saturate, so a box of any size covers at most the grid; NaN covers nothing much.
    let range = |axis: usize, n: usize| {
        low[axis].max(0.0) as usize..(high[axis] + 1.0).max(0.0).min(n as f64) as usize
    };
    for x in range(0, extent.nx()) {
        for y in range(1, extent.ny()) {
            for z in range(2, Lattice::OCC3D.bins()) {
                if ego.contains(extent.center(x, y, z)) {
                    masks.set(x, y, z, false);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use scene::Class;

    fn pattern(beams: usize, columns: u32) -> LidarPattern {
        let elevations = (0..beams).map(|i| match beams {
            1 => 0.0,
            _ => -90.0 + 180.0 * i as f64 / (beams - 1) as f64,
        });
        LidarPattern {
            name: "TEST".into(),
            elevations_deg: elevations.collect(),
            columns,
            first_azimuth_deg: 0.0,
            sector_deg: 360.0,
            clockwise: false,
            spin_hz: 0.0,
            part: None,
            max_range_m: 100.0,
            min_range_m: 0.0,
            own_body: true,
            beyond_grid: true,
            rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
            translation_m: [0.0, 0.0, 1.0],
        }
    }

    #[test]
    fn row_52_lidar_pattern() {
        for columns in [1, 2, 3, 360, 1080, 1084, 4096] {
            for beams in [1, 2, 16, 32, 64, 128] {
                let p = pattern(beams, columns);
                let mut seen = HashSet::new();
                for (ring, &e) in p.elevations_deg.iter().enumerate() {
                    for i in 0..columns {
                        let d = direction_in_sensor(e, p.azimuth_rad(i));
                        assert!((d.length() - 1.0).abs() < 1e-15, "{d}");
                        // At the poles all azimuths share one direction; elsewhere each is its own.
                        let bits = d.to_array().map(f64::to_bits);
                        if e.abs() < 90.0 {
                            assert!(seen.insert(bits), "ring {ring} column {i} of {columns}");
                        }
                    }
                }
            }
            // The wrap is a step like any other: no gap, no double.
            let step = std::f64::consts::TAU / f64::from(columns);
            let p = pattern(1, columns);
            let of = |i| direction_in_sensor(0.0, p.azimuth_rad(i));
            if columns > 2 {
                let seam = of(columns - 1).angle_between(of(0));
                let first = of(0).angle_between(of(1));
                assert!((seam - first).abs() < 1e-12 && (first - step).abs() < 1e-12);
            }
        }
        assert_eq!(direction_in_sensor(90.0, 0.04).z, 1.0);
        assert_eq!(direction_in_sensor(-90.0, 0.04).z, -1.0);
    }

    #[test]
    fn a_box_of_voxels_returns_every_ray() {
        // The sensor sits inside a closed shell of one voxel.
        let mut grid = VoxelGrid::new();
        for (x, y, z) in (90..111).flat_map(|x| (90..111).flat_map(move |y| (0..16).map(move |z| (x, y, z))))
        {
            if [x, y].contains(&90) || [x, y].contains(&110) || z == 0 || z == 15 {
                grid.set(x, y, z, Class::Manmade.id());
            }
        }
        let p = pattern(64, 1084);
        let sweep = sweep(&grid, &p, None);
        assert_eq!(sweep.points.len(), sweep.rays);
        assert_eq!(sweep.rays, 64 * 1084);
        for (k, point) in sweep.points.iter().enumerate() {
            assert_eq!(usize::from(point.ring) * 1084 + usize::from(point.azimuth), k);
            assert_eq!(point.class, Class::Manmade);
            let at = glam::Vec3::from(point.position_in_ego) - glam::Vec3::Z;
            assert!((at.length() - point.range_m).abs() < 1e-5);
        }
    }

    #[test]
    fn range_limits_and_ego_box() {
        let mut grid = VoxelGrid::new();
        grid.set(105, 100, 5, Class::Car.id()); // 2.0 to 2.4 m ahead at the sensor's height
        grid.set(150, 100, 5, Class::Truck.id()); // 20 m ahead
        let mut p = pattern(1, 1);
        p.translation_m = [0.0, 0.1, 1.1];
        let first = |p: &LidarPattern, ego| sweep(&grid, p, ego).points.first().map(|q| (q.class, q.range_m));
        assert_eq!(first(&p, None), Some((Class::Car, 2.0)));
        p.min_range_m = 3.0;
        assert_eq!(first(&p, None), None, "a near surface hides what is behind");
        let ego = EgoBox {
            center_m: DVec3::new(2.0, 0.0, 1.0),
            size_m: DVec3::splat(1.5),
            vehicle: Pose::IDENTITY,
        };
        assert_eq!(first(&p, Some(ego)), Some((Class::Truck, 20.0)));
        p.max_range_m = 19.9;
        assert_eq!(first(&p, Some(ego)), None);
        let bad = EgoBox {
            center_m: DVec3::NAN,
            size_m: DVec3::INFINITY,
            vehicle: Pose::IDENTITY,
        };
        assert_eq!(first(&p, Some(bad)), None);
        let everything = EgoBox {
            center_m: DVec3::ZERO,
            size_m: DVec3::splat(1e9),
            vehicle: Pose::IDENTITY,
        };
        p.max_range_m = 100.0;
        assert_eq!(sweep(&grid, &p, Some(everything)).points, vec![]);
    }

    #[test]
    fn threads_do_not_change_a_sweep() {
        let mut grid = VoxelGrid::new();
        for i in 0..4000usize {
            grid.set(i * 7919 % 200, i * 104_729 % 200, i * 31 % 16, (i % 17) as u8);
        }
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool")
                .install(|| sweep(&grid, &pattern(32, 500), None))
        };
        assert_eq!(run(1), run(3));
    }
}
