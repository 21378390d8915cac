//! Voxels that the sensors of a vehicle observe: those that a ray passes, and the one that it ends in. Occ3D defines
//! its masks in this way (arXiv 2304.14365); there the LiDAR's mask is of all sweeps of a drive, here of one.

use glam::DVec3;
use rayon::prelude::*;

use crate::lidar::own_body::OwnBody;
use crate::lidar::{EgoBox, Rays, look_through};
use crate::pictures::march::CameraRays;
use crate::raycast::ColumnMasks;
use scene::{Camera, Lattice, LidarPattern, SensorRig, VoxelGrid};

/// Rays of a camera are at most this far apart at the far end of the grid, m, unless its pixels are wider.
const APART_M: f64 = Lattice::OCC3D.voxel_m() / 2.0;
/// Rays that one thread works on in a row.
const RAYS: usize = 4096;

/// Observed voxels: for each column `[x][y]` of the grid one bit per bin, the lowest bin in bit 0. All zero without a
/// sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedVoxels {
    /// Voxels observed by the rays of all LiDARs, one turn each. A pulse without an echo within the range observes the
    /// free voxels on its way; one that ends nearer than the least range observes nothing.
    pub lidar: Vec<u16>,
    /// Voxels observed by the pixels of all cameras.
    pub camera: Vec<u16>,
}

/// Voxels of a grid that a rig without a [problem](SensorRig::problem) observes, both in the same frame. Rays pass
/// through voxels in the own vehicle. The result does not depend on the number of threads.
pub fn observed(grid: &VoxelGrid, rig: &SensorRig) -> ObservedVoxels {
    let mut masks = ColumnMasks::from_grid(grid);
    let ego = EgoBox::of_rig(rig);
    look_through(&mut masks, ego);
    let nothing = || vec![0; grid.extent().columns()];
    let lidars = rig
        .lidars
        .iter()
        .map(|l| of_lidar(&masks, l, rig.velocity_mps(), ego));
    let cameras = rig.cameras.iter().map(|c| of_camera(&masks, c));
    ObservedVoxels {
        lidar: lidars.fold(nothing(), either),
        camera: cameras.fold(nothing(), either),
    }
}

fn either(mut a: Vec<u16>, b: Vec<u16>) -> Vec<u16> {
    a.iter_mut().zip(&b).for_each(|(a, b)| *a |= b);
    a
}

fn of_lidar(masks: &ColumnMasks, pattern: &LidarPattern, velocity_mps: DVec3, ego: EgoBox) -> Vec<u16> {
    let rays = Rays::new(pattern, velocity_mps);
    let body = pattern.own_body.then(|| OwnBody::new(ego));
    marked(masks, rays.directions.len(), |ray| {
        let (origin, direction) = rays.get(ray);
        let roof_m = body.and_then(|body| body.meets(origin, direction));
        ObservationRay {
            origin,
            direction,
            range_m: [pattern.min_range_m, roof_m.unwrap_or(pattern.max_range_m)],
        }
    })
}

fn of_camera(masks: &ColumnMasks, camera: &Camera) -> Vec<u16> {
    let extent = masks.extent();
    let at = DVec3::from_array(camera.translation_m);
    let farthest_m = (at - extent.min_m())
        .abs()
        .max((at - extent.max_m()).abs())
        .length();
    let across = |pixels: u32, focal_px: f64| {
        let pixels_apart = (APART_M * focal_px / farthest_m).max(1.0);
        ((f64::from(pixels) / pixels_apart).ceil() as u32).max(1)
    };
    let [width, height] = [
        across(camera.width, camera.focal_px[0]),
        across(camera.height, camera.focal_px[1]),
    ];
    let rays = CameraRays::new(camera, width, height);
    marked(masks, width as usize * height as usize, |pixel| {
        let (u, v) = (pixel % width as usize, pixel / width as usize);
        let ray = rays.at(u as f64 + 0.5, v as f64 + 0.5);
        // Where the lens sees nothing, nothing is observed.
        let seen = ray.direction != DVec3::ZERO;
        ObservationRay {
            origin: ray.origin,
            direction: ray.direction.normalize_or(DVec3::X),
            range_m: [0.0, if seen { f64::INFINITY } else { 0.0 }],
        }
    })
}

/// A ray in the grid's frame: a unit direction, and the distances between which it observes voxels.
struct ObservationRay {
    origin: DVec3,
    direction: DVec3,
    range_m: [f64; 2],
}

/// The voxels that the rays 0 to `rays` - 1 observe.
fn marked(masks: &ColumnMasks, rays: usize, ray: impl Fn(usize) -> ObservationRay + Sync) -> Vec<u16> {
    let extent = masks.extent();
    let nothing = || vec![0; extent.columns()];
    let chunk = |chunk: usize| {
        let (mut words, mut way) = (nothing(), Vec::new());
        for i in chunk * RAYS..((chunk + 1) * RAYS).min(rays) {
            let ObservationRay {
                origin,
                direction,
                range_m: [least, most],
            } = ray(i);
            way.clear();
            let origin = extent.to_voxel_units(origin);
            let hit = masks.walk_in_voxels(origin, direction, most / Lattice::OCC3D.voxel_m(), |v| {
                way.push(v)
            });
            if hit.is_none_or(|(t, _)| t * Lattice::OCC3D.voxel_m() >= least) {
                way.iter()
                    .for_each(|&[x, y, z]| words[extent.index(x, y)] |= 1 << z);
            }
        }
        words
    };
    let chunks = (0..rays.div_ceil(RAYS)).into_par_iter();
    chunks.map(chunk).reduce(nothing, either)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;

    /// A rig with one LiDAR of one beam straight ahead, and no camera.
    fn beam() -> SensorRig {
        let mut rig = SensorRig::default();
        rig.cameras.clear();
        let lidar = &mut rig.lidars[0];
        lidar.elevations_deg = vec![0.0];
        (lidar.columns, lidar.min_range_m, lidar.max_range_m) = (1, 0.5, 30.0);
        lidar.rotation_wxyz = [1.0, 0.0, 0.0, 0.0];
        lidar.translation_m = [0.1, 0.1, 2.0];
        rig
    }

    fn bits(words: &[u16]) -> usize {
        words.iter().map(|w| w.count_ones() as usize).sum()
    }

    #[test]
    fn a_ray_observes_what_it_passes_and_where_it_ends() {
        let (rig, mut grid) = (beam(), VoxelGrid::new());
        let extent = grid.extent();
        let at = |x_m: f64| extent.voxel_at(DVec3::new(x_m, 0.1, 2.0)).expect("inside");
        let [wall_x, y, z] = at(10.1);
        for up in 0..16 {
            grid.set(wall_x, y, up, Class::Manmade.id());
        }
        let found = observed(&grid, &rig);
        let has = |x: usize| found.lidar[extent.index(x, y)] == 1 << z;
        let from = at(0.1)[0];
        assert!((from..=wall_x).all(has));
        assert_eq!(bits(&found.lidar), wall_x - from + 1);
        assert_eq!(bits(&found.camera), 0);
        // Without a wall as far as the LiDAR reaches: to x = 30.1 m.
        let open = observed(&VoxelGrid::new(), &rig);
        assert_eq!(bits(&open.lidar), at(30.1)[0] - from + 1);
        // A wall in its face tells nothing.
        grid.set(at(0.5)[0], y, z, Class::Manmade.id());
        assert_eq!(bits(&observed(&grid, &rig).lidar), 0);
    }

    #[test]
    fn two_lidars_are_united_and_the_own_vehicle_is_looked_through() {
        let mut rig = beam();
        let mut left = rig.lidars[0].clone();
        left.first_azimuth_deg = 90.0;
        rig.lidars.push(left);
        let mut grid = VoxelGrid::new();
        let extent = grid.extent();
        let [x, y, z] = extent.voxel_at(DVec3::new(0.1, 0.1, 1.0)).expect("inside");
        grid.set(x, y, z, Class::Car.id());
        let found = observed(&grid, &rig);
        let [ahead, beside] = [[x + 20, y], [x, y + 20]].map(|[x, y]| found.lidar[extent.index(x, y)]);
        assert!(ahead != 0 && beside != 0 && found.lidar[extent.index(x + 20, y + 20)] == 0);
        rig.lidars.truncate(1);
        rig.lidars[0].translation_m[2] = 1.0;
        assert!(bits(&observed(&grid, &rig).lidar) > 70, "no own voxel in the way");
    }

    #[test]
    fn cameras_see_no_voxel_behind_a_wall_and_miss_none_before_it() {
        let mut rig = SensorRig::default();
        let mut camera = Camera::new("AHEAD", 70.0);
        camera.translation_m = [0.0, 0.0, 1.5];
        rig.cameras = vec![camera];
        rig.lidars.clear();
        let mut grid = VoxelGrid::new();
        let extent = grid.extent();
        let wall = 180;
        for (y, z) in (0..extent.ny()).flat_map(|y| (0..Lattice::OCC3D.bins()).map(move |z| (y, z))) {
            grid.set(wall, y, z, Class::Manmade.id());
        }
        let found = observed(&grid, &rig);
        let word = |x: usize, y: usize| found.camera[extent.index(x, y)];
        assert!((0..extent.ny()).all(|y| word(wall + 1, y) == 0 && word(99, y) == 0));
        assert_eq!(bits(&found.lidar), 0);
        // All whose middle lies well inside the view, up to the wall.
        for x in 110..=wall {
            let ahead_m = extent.center(x, 0, 0).x;
            let [across_m, up_m] = [35f64.to_radians().tan() - 0.05, 0.35].map(|slope| slope * ahead_m);
            for (y, z) in (0..extent.ny()).flat_map(|y| (0..Lattice::OCC3D.bins()).map(move |z| (y, z))) {
                let p = extent.center(x, y, z);
                if p.y.abs() < across_m - 0.4 && (p.z - 1.5).abs() < up_m - 0.4 {
                    assert!(word(x, y) >> z & 1 == 1, "{p}");
                }
            }
        }
    }

    #[test]
    fn threads_do_not_change_what_is_observed() {
        let mut grid = VoxelGrid::new();
        for i in 0..4000usize {
            grid.set(i * 7919 % 200, i * 104_729 % 200, i * 31 % 16, (i % 17) as u8);
        }
        let rig = SensorRig::default();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool").install(|| observed(&grid, &rig))
        };
        let (one, three) = (run(1), run(3));
        assert!(one == three);
        assert!(bits(&one.lidar) > 20_000 && bits(&one.camera) > 20_000);
    }
}
