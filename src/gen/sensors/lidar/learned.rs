//! One revolution of a spinning LiDAR through the learned field: sub-voxel ranges, echo strength, lost echoes. The
//! field covers 80 m around the vehicle; returns from the rest of a larger map come from the exact ray cast.

use std::borrow::Cow;

use glam::DVec3;

use crate::lidar::surroundings::{Height, SurroundingHits};
use crate::lidar::texture::textured;
use crate::lidar::{EgoBox, Rays};
use nets::ModelError;
use nets::lidar::field::{LidarRay, RaySampling, SignedDistanceField};
use nets::lidar::{LearnedRay, LidarNet};
use scene::moved::ColumnShift;
use scene::{Class, Extent, LidarPattern, LidarPoint, LidarSweep, Pose, SensorRig, VoxelGrid, Window};
use world::draw::{Draw, hash};

/// Treatment of echoes that a real sensor may lose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drops {
    /// Keeps all; their probability stands in the points.
    Keep,
    /// Removes those more likely lost than not.
    Likely,
    /// Removes each with its probability; the draw depends on the seed, beam and column.
    Drawn(u64),
}

/// True if the echo is lost; a logit of exactly 0 (one half) is, NaN is not.
pub fn is_dropped(drop_logit: f32) -> bool {
    drop_logit >= 0.0
}

/// The field of a scene as the network sees it, without the voxels of the own vehicle.
pub fn field(
    net: &LidarNet,
    grid: &VoxelGrid,
    exclude: Option<EgoBox>,
) -> Result<SignedDistanceField, ModelError> {
    net.field(&seen(grid, exclude))
}

/// Part of a grid that the network sees.
pub(super) const SEEN: Extent = Extent::WINDOW;

/// The part of a grid that the network sees. Voxels in the place of the own vehicle are free there, apart from ground.
pub fn seen(grid: &VoxelGrid, exclude: Option<EgoBox>) -> VoxelGrid {
    let mut seen = grid.crop(SEEN);
    let Some(ego) = exclude else {
        return seen;
    };
    // Casts saturate: a box of any size covers at most the grid, NaN nothing.
    let range = |axis: usize, n: usize| {
        let at = |p: DVec3| SEEN.to_voxel_units(p)[axis].floor();
        let (low, high) = ego.bounds_m();
        let (low, high) = (at(low), at(high));
        (low.max(0.0) as usize).min(n)..(high + 1.0).clamp(0.0, n as f64) as usize
    };
    for x in range(0, SEEN.nx()) {
        for y in range(1, SEEN.ny()) {
            for z in range(2, Window::NZ) {
                let class = seen.get(x, y, z);
                let near = || ego.contains(SEEN.center(x, y, z));
                if class != Class::FREE && near() && !class_is_ground(class) {
                    seen.set(x, y, z, Class::FREE);
                }
            }
        }
    }
    seen
}

fn class_is_ground(label: impl Into<u8>) -> bool {
    Class::from_id(label.into()).is_some_and(Class::is_ground)
}

/// A rig in the middle of the window of the network. Rig and grid are moved there by whole columns.
pub(super) struct Centred<'a> {
    /// The moved rig.
    pub rig: Cow<'a, SensorRig>,
    /// Moves the map there.
    pub from_map: ColumnShift,
}

impl<'a> Centred<'a> {
    /// A vehicle farther from the origin than any map is taken to be at the farthest place.
    const FARTHEST: f64 = 4096.0;

    /// The rig of a vehicle anywhere on a map.
    pub fn new(rig: &'a SensorRig) -> Self {
        let column = |m: f64| {
            -(m / Window::VOXEL_M)
                .round()
                .clamp(-Self::FARTHEST, Self::FARTHEST) as i32
        };
        let p = rig.vehicle.translation_m;
        let by = ColumnShift([column(p.x), column(p.y)]);
        if by == ColumnShift::default() {
            let rig = Cow::Borrowed(rig);
            return Self { rig, from_map: by };
        }
        let moved = Pose {
            translation_m: rig.vehicle.translation_m + by.way_m().extend(0.0),
            ..rig.vehicle
        };
        let rig = Cow::Owned(rig.standing_at(&moved));
        Self { rig, from_map: by }
    }

    /// The grid of the map, moved.
    pub fn grid(&self, grid: &VoxelGrid) -> VoxelGrid {
        self.from_map.grid(grid)
    }

    /// The way back onto the map, m.
    pub fn back_m(&self) -> DVec3 {
        self.from_map.back().way_m().extend(0.0)
    }
}

/// The rays of a pattern, beam-major; see [`Rays::new`].
pub fn rays(pattern: &LidarPattern, velocity_mps: DVec3) -> Vec<LidarRay> {
    rays_of(pattern, &Rays::new(pattern, velocity_mps))
}

/// The rays of a pattern, beam-major, made from rays that are computed already.
pub fn rays_of(pattern: &LidarPattern, rays: &Rays) -> Vec<LidarRay> {
    let ray = |i| {
        let (origin, direction) = rays.get(i);
        LidarRay {
            origin,
            direction,
            range_m: [pattern.min_range_m, pattern.max_range_m],
        }
    };
    (0..rays.directions.len()).map(ray).collect()
}

/// Casts the pattern through the grid alone, beam-major. Only hits that are not dropped become points. Errors if the
/// network cannot compute.
pub fn sweep(
    net: &LidarNet,
    field: &SignedDistanceField,
    pattern: &LidarPattern,
    drops: Drops,
) -> Result<LidarSweep, ModelError> {
    let rays = rays(pattern, DVec3::ZERO);
    let answers = net.shoot(field, &rays, RaySampling::Prior)?;
    let columns = pattern.columns_in_sector();
    Ok(points(&rays, &answers, columns, drops, None, DVec3::ZERO))
}

/// The sweep of the first LiDAR of a rig on its moving vehicle, with the vehicle itself and what lies beyond the grid;
/// empty if it has none.
pub fn rig_sweep(
    net: &LidarNet,
    grid: &VoxelGrid,
    rig: &SensorRig,
    drops: Drops,
) -> Result<LidarSweep, ModelError> {
    let centred = Centred::new(rig);
    let (rig, grid) = (&*centred.rig, &centred.grid(grid));
    let Some(pattern) = rig.lidars.first() else {
        return Ok(LidarSweep::default());
    };
    let ego = Some(EgoBox::of_rig(rig));
    let field = field(net, grid, ego)?;
    let shape = Rays::new(pattern, rig.velocity_mps());
    let around = SurroundingHits::new(grid, SEEN, pattern, &shape, ego, Height::Physical);
    let rays = rays_of(pattern, &shape);
    let answers = net.shoot(&field, &rays, RaySampling::Prior)?;
    let columns = pattern.columns_in_sector();
    let back_m = centred.back_m();
    Ok(points(&rays, &answers, columns, drops, Some(&around), back_m))
}

/// The points of answered rays, and of those that end on the surroundings of the grid (`around`), all moved by
/// `back_m`.
pub fn points(
    rays: &[LidarRay],
    answers: &[LearnedRay],
    columns: u32,
    drops: Drops,
    around: Option<&SurroundingHits>,
    back_m: DVec3,
) -> LidarSweep {
    let columns = columns.max(1) as usize;
    let is_lost = |ray: usize, probability: f32, dropped: bool| match drops {
        Drops::Keep => false,
        Drops::Likely => dropped,
        Drops::Drawn(seed) => Draw::new(hash(seed ^ ray as u64), "lost echo").chance(f64::from(probability)),
    };
    let mut points = Vec::with_capacity(rays.len());
    for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
        let range_m = answer.met.median_m;
        let position: DVec3 = ray.origin + ray.direction * f64::from(range_m) + back_m;
        let class = Class::from_id(answer.met.class).unwrap_or(Class::Others);
        let inside = || LidarPoint {
            position_in_ego: position.as_vec3().to_array(),
            range_m,
            ring: (i / columns) as u16,
            azimuth: (i % columns) as u16,
            class,
            intensity: textured(answer.intensity, class, position, i as u64),
            drop_probability: answer.drop_probability(),
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        };
        let met = answer.is_hit();
        let kept = match around.and_then(|around| around.instead(i, met)) {
            Some(other) => other
                .filter(|p| !is_lost(i, p.drop_probability, p.drop_probability >= 0.5))
                .map(|p| moved(p, back_m)),
            None => {
                let found = (met && range_m.is_finite()).then(inside);
                found.filter(|p| !is_lost(i, p.drop_probability, is_dropped(answer.drop_logit)))
            }
        };
        points.extend(kept);
    }
    LidarSweep {
        points,
        rays: rays.len(),
        physical: true,
        provenance: Vec::new(),
    }
}

fn moved(point: LidarPoint, by_m: DVec3) -> LidarPoint {
    let p = DVec3::from_array(point.position_in_ego.map(f64::from)) + by_m;
    LidarPoint {
        position_in_ego: p.as_vec3().to_array(),
        ..point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nets::lidar::drop_probability;
    use scene::Window;
    use world::World;
    use world::voxelize::{Vertical, complete};

    /// Row 51 of the extremes table: extreme logits, exactly one half, NaN; the same answer every time.
    #[test]
    fn row_51_drops() {
        for (logit, dropped, probability) in [
            (1e4f32, true, 1.0f32),
            (-1e4, false, 0.0),
            (0.0, true, 0.5),
            (-0.0, true, 0.5),
            (-1e-30, false, 0.5),
            (f32::INFINITY, true, 1.0),
            (f32::NEG_INFINITY, false, 0.0),
            (f32::NAN, false, 0.5),
        ] {
            assert_eq!(
                (is_dropped(logit), drop_probability(logit)),
                (dropped, probability),
                "{logit}"
            );
        }
        let near: Vec<f32> = (-2000..2000).map(|i| drop_probability(i as f32 * 0.01)).collect();
        assert!(near.is_sorted() && near.iter().all(|p| p.is_finite()));
    }

    #[test]
    fn a_sweep_is_repeatable_on_any_number_of_threads() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let grid = complete(&World::random(11), Vertical::Occ3d);
        let pattern = &SensorRig::default().lidars[0];
        let made = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let field = field(&net, &grid, None).expect("a finite field");
                sweep(&net, &field, pattern, Drops::Drawn(4)).expect("finite")
            })
        };
        let found = made(1);
        assert!(
            found == made(2) && found.points.len() > 15_000,
            "{}",
            found.points.len()
        );
        assert!(found.points.iter().all(|p| p.range_m.is_finite()
            && (0.0..=255.0).contains(&p.intensity)
            && (0.0..=1.0).contains(&p.drop_probability)));
    }

    /// Nothing, one voxel in a corner, everything, damaged labels, an own vehicle of any size; rays along the axes,
    /// through edges, from far away and NaN: no panic, nothing but finite points.
    #[test]
    fn extremes_are_survived() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let mut grids = vec![VoxelGrid::new(); 3];
        grids[1].set(199, 0, 15, 4);
        for k in 0..Window::VOXELS {
            grids[2].set(k / 3200, k / 16 % 200, k % 16, if k % 97 == 0 { 200 } else { 15 });
        }
        let ego = EgoBox {
            center_m: DVec3::ZERO,
            size_m: DVec3::splat(1e6),
            vehicle: scene::Pose::IDENTITY,
        };
        let mut pattern = SensorRig::default().lidars[0].clone();
        pattern.columns = 8;
        pattern.elevations_deg = vec![-90.0, -45.0, 0.0, 45.0, 90.0];
        for grid in &grids {
            for exclude in [None, Some(ego)] {
                let field = field(&net, grid, exclude).expect("a finite field");
                for place in [
                    [0.0; 3],
                    [0.2, 0.2, 0.2],
                    [-40.0, 40.0, 5.4],
                    [1e6, 0.0, 1.0],
                    [f64::NAN; 3],
                ] {
                    pattern.translation_m = place;
                    pattern.rotation_wxyz = [1.0, 0.0, 0.0, 0.0];
                    let found = sweep(&net, &field, &pattern, Drops::Keep).expect("finite");
                    assert_eq!(found.rays, 40);
                    assert!(
                        found
                            .points
                            .iter()
                            .all(|p| p.range_m.is_finite() && p.intensity.is_finite())
                    );
                    let empty = grid.count_set() == 0;
                    assert!(!empty || found.points.is_empty());
                }
            }
        }
    }

    /// Row 53: features move with the scene (by multiples of the coarsest stride) and one voxel alone is no exception.
    #[test]
    fn row_53_the_field_moves_with_the_scene() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let key = |x: usize, y: usize, z: usize| ((x * Window::NY + y) * Window::NZ + z) as u32;
        let shapes: [Vec<[usize; 3]>; 2] = [
            vec![[20, 20, 5]],
            (0..400)
                .map(|i| [20 + i * 7 % 31, 24 + i * 11 % 29, i * 5 % 16])
                .collect(),
        ];
        for shape in shapes {
            let field = |dx: usize, dy: usize| {
                let mut keys: Vec<u32> = shape.iter().map(|[x, y, z]| key(x + dx, y + dy, *z)).collect();
                keys.sort_unstable();
                keys.dedup();
                let classes = vec![Class::Car.id(); keys.len()];
                net.field_of(keys, classes).expect("finite")
            };
            let (here, there) = (field(0, 0), field(96, 40));
            assert!(!here.planes.is_empty());
            for (a, b) in here
                .hidden
                .iter()
                .flat_map(|l| l.0)
                .zip(there.hidden.iter().flat_map(|l| l.0))
            {
                assert!((a - b).abs() <= 1e-5 * a.abs().max(1.0), "{a} {b}");
            }
            assert!(
                here.planes == there.planes
                    || here
                        .planes
                        .iter()
                        .flatten()
                        .zip(there.planes.iter().flatten())
                        .all(|(a, b)| (a - b).abs() < 1e-5)
            );
        }
    }
}
