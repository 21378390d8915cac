//! Surfaces outside the voxels that end a pulse: the own vehicle's roof, and the continuation of the scene beyond the
//! grid. Exact and learned sweeps add them to what they find in the grid.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::beyond::backdrop::{Backdrop, Behind, SCENE_SEED};
use crate::beyond::border::{Border, Covered};
use crate::lidar::material::{Materials, PulseHit};
use crate::lidar::own_body::{OwnBody, is_blind};
use crate::lidar::{EgoBox, Rays};
use crate::pictures::march::{GroundHeight, MarchOptions, MarchScene};
use scene::{BevLayout, Class, Extent, Lattice, LidarPattern, LidarPoint, VoxelGrid};
use world::SurfacePoint;
use world::draw::{Draw, hash};

/// Rays that one thread works on in a row.
const RAYS: usize = 512;
/// Echo strength of the own paintwork, white, of 255.
const OWN_STRENGTH: f64 = 18.0;

/// Height of the ground in the sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Height {
    /// At the height of the labels, two bins too low.
    AsLabelled,
    /// At its physical height.
    Physical,
}

impl Height {
    /// Height that is added to the top of a label's ground voxel, m.
    fn lift_m(self) -> f64 {
        match self {
            Height::AsLabelled => 0.0,
            // The top of bin 0 is at -0.6 m, the road at 0.
            Height::Physical => 0.6,
        }
    }
}

/// Hit of a ray outside the voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outside {
    Nothing,
    /// Beyond the grid, if nothing in the grid is in the way.
    Beyond(LidarPoint),
    /// The own vehicle; `None` if no echo comes back from it.
    Own(Option<LidarPoint>),
}

/// Hits outside the voxels for every ray of one pattern.
#[derive(Clone, Debug)]
pub struct SurroundingHits {
    height: Height,
    body: Option<OwnBody>,
    /// The edge that the continuation was drawn up from; `None` without one.
    border: Option<Border>,
    /// The grid and the part of it that the sweep covers itself; `None` if it covers all.
    partly: Option<(VoxelGrid, Extent)>,
    outside: Vec<Outside>,
}

impl SurroundingHits {
    /// Surroundings of a pattern in a scene; `ego` is the vehicle that carries it, if it is known. The sweep itself
    /// covers the part of the grid in `seen`: voxels outside it count as surroundings.
    pub fn new(
        grid: &VoxelGrid,
        seen: Extent,
        pattern: &LidarPattern,
        rays: &Rays,
        ego: Option<EgoBox>,
        height: Height,
    ) -> Self {
        let body = ego.filter(|_| pattern.own_body).map(OwnBody::new);
        let mut around = Self {
            height,
            body,
            border: None,
            partly: partly(grid, seen),
            outside: Vec::new(),
        };
        let border = pattern
            .beyond_grid
            .then(|| Border::of_grid(grid, height.lift_m()));
        around.shoot(border, pattern, rays);
        around
    }

    /// Updates the surroundings to the voxels; true if they changed. Only voxels near the edge or outside `seen` can
    /// change them.
    pub fn update(&mut self, grid: &VoxelGrid, seen: Extent, pattern: &LidarPattern, rays: &Rays) -> bool {
        let known = self.border.as_ref();
        let border = known.map(|_| Border::of_grid(grid, self.height.lift_m()));
        let partly = partly(grid, seen);
        if border == self.border && is_same_around(&partly, &self.partly) {
            return false;
        }
        self.partly = partly;
        self.shoot(border, pattern, rays);
        true
    }

    /// The return of a ray in place of what it finds in the grid; `met` says whether it meets a voxel there. The outer
    /// `None` is "nothing else", the inner one an echo that does not come back.
    #[inline]
    pub fn instead(&self, ray: usize, met: bool) -> Option<Option<LidarPoint>> {
        match self.outside.get(ray) {
            Some(Outside::Own(point)) => Some(*point),
            Some(Outside::Beyond(point)) if !met => Some(Some(*point)),
            _ => None,
        }
    }

    fn shoot(&mut self, border: Option<Border>, pattern: &LidarPattern, rays: &Rays) {
        let backdrop = border.map(|border| Backdrop::new(border, &[], SCENE_SEED));
        let rest = self.partly.as_ref().map(|(grid, seen)| {
            let options = MarchOptions {
                ground: match self.height {
                    Height::AsLabelled => GroundHeight::AsLabelled,
                    Height::Physical => GroundHeight::Physical,
                },
                boxes: false,
                lines: false,
                seed: SCENE_SEED,
            };
            let nothing = BevLayout::over(grid.extent());
            let scene = MarchScene::new(grid, &nothing, &BTreeMap::new(), &options);
            (scene, Covered::by(*seen))
        });
        let materials = Materials::ordinary(SCENE_SEED);
        let columns = rays.origins.len().max(1);
        let outside = |ray: usize| {
            let (origin, direction) = rays.get(ray);
            let point = |range_m: f64, class, intensity: f64, lost: f64| LidarPoint {
                position_in_ego: (origin + direction * range_m).as_vec3().to_array(),
                range_m: range_m as f32,
                ring: (ray / columns) as u16,
                azimuth: (ray % columns) as u16,
                class,
                intensity: intensity as f32,
                drop_probability: lost as f32,
                time_s: 0.0,
                velocity_mps: [0.0; 2],
            };
            let mut draw = Draw::new(hash(SCENE_SEED ^ ray as u64), "outside");
            let (fate, detail) = (draw.unit(), draw.unit());
            if let Some(range_m) = self.body.and_then(|body| body.meets(origin, direction)) {
                let seen = range_m >= pattern.min_range_m && !is_blind(range_m, fate);
                let strength = OWN_STRENGTH * (0.5 + fate);
                return Outside::Own(seen.then(|| point(range_m, Class::Others, strength, 0.0)));
            }
            let beyond = || {
                let backdrop = backdrop.as_ref()?;
                // The height of things above the voxels is not known.
                let left_m = backdrop.border().covered().left_by(origin, direction);
                if origin.z + direction.z * left_m > Lattice::OCC3D.top_m() {
                    return None;
                }
                backdrop.cast(origin, direction, pattern.max_range_m)
            };
            let in_rest = rest
                .as_ref()
                .and_then(|(scene, seen)| unseen(scene, *seen, origin, direction));
            let hit = match in_rest {
                Some(hit) => (hit.range_m <= pattern.max_range_m).then_some(hit),
                None => beyond(),
            };
            let Some(hit) = hit else {
                return Outside::Nothing;
            };
            let surface = SurfacePoint {
                normal: hit.normal,
                instance: hit.instance,
                part: hit.part,
            };
            let met = PulseHit {
                class: hit.class,
                surface: &surface,
                solid: hit.solid.and_then(|i| backdrop.as_ref()?.solid(i)),
                at: origin + direction * hit.range_m,
                range_m: hit.range_m,
                cosine: hit.normal.dot(direction).abs().clamp(0.0, 1.0),
            };
            let material = materials.of(&met, detail);
            let strength = materials.strength(&material, met.cosine, (fate - 0.5) * 3.0);
            let lost = materials.lost(&material, &met);
            Outside::Beyond(point(hit.range_m, hit.class, strength.round(), lost))
        };
        self.outside = (0..rays.directions.len())
            .into_par_iter()
            .with_min_len(RAYS)
            .map(outside)
            .collect();
        self.border = backdrop.map(Backdrop::into_border);
    }
}

/// The grid and the part of it that a sweep covers itself; `None` if it covers all.
fn partly(grid: &VoxelGrid, seen: Extent) -> Option<(VoxelGrid, Extent)> {
    let extent = grid.extent();
    let all = extent
        .overlap(&seen)
        .is_some_and(|shared| shared.size == [extent.nx(), extent.ny()]);
    (!all).then(|| (grid.clone(), seen))
}

/// True if two grids are equal outside the parts that sweeps cover themselves.
fn is_same_around(a: &Option<(VoxelGrid, Extent)>, b: &Option<(VoxelGrid, Extent)>) -> bool {
    let (Some((a, seen)), Some((b, also))) = (a, b) else {
        return a.is_none() && b.is_none();
    };
    if (a.extent(), seen) != (b.extent(), also) {
        return false;
    }
    let (mut from, mut to) = ([0; 2], [0; 2]);
    if let Some(shared) = a.extent().overlap(seen) {
        from = shared.here;
        to = [0, 1].map(|axis| from[axis] + shared.size[axis]);
    }
    a.changed_bricks(b).into_iter().all(|brick| {
        let ([x0, y0], [along_x, along_y]) = a.brick_columns(brick);
        (x0..x0 + along_x).all(|x| {
            (y0..y0 + along_y).all(|y| {
                let is_seen = (from[0]..to[0]).contains(&x) && (from[1]..to[1]).contains(&y);
                is_seen || a.column(x, y) == b.column(x, y)
            })
        })
    })
}

/// The first voxel along a ray beyond the part that a sweep covers itself.
fn unseen(scene: &MarchScene, seen: Covered, origin: DVec3, direction: DVec3) -> Option<Behind> {
    let left_m = seen.left_by(origin, direction);
    let hit = scene.cast(origin + direction * left_m, direction)?;
    Some(Behind {
        range_m: left_m + hit.t,
        class: Class::from_id(hit.id)?,
        normal: hit.normal,
        instance: 0,
        part: 0,
        solid: None,
    })
}

/// True if a point of a sweep may be on the own vehicle: nearer than any wheel of another.
pub fn is_own(point: &LidarPoint) -> bool {
    point.class == Class::Others && point.range_m < 3.0
}

/// True if a point of a sweep is on the continuation, beyond the grid.
pub fn is_beyond(extent: Extent, point: &LidarPoint) -> bool {
    let p = DVec3::from_array(point.position_in_ego.map(f64::from));
    Covered::by(extent).out_m(p.truncate()) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::caster::Caster;
    use scene::SensorRig;
    use world::World;
    use world::voxelize::{Vertical, complete};

    /// Both options off is the grid alone; on, only slots on the roof and slots without an echo change.
    #[test]
    fn what_is_around_replaces_no_voxel() {
        let rig = SensorRig::default();
        let (ego, mut pattern) = (Some(EgoBox::of_rig(&rig)), rig.lidars[0].clone());
        let grid = complete(&World::random(6), Vertical::Occ3d);
        let is_beyond = |p: &LidarPoint| super::is_beyond(grid.extent(), p);
        let sweep = |p: &LidarPattern| Caster::new(&grid, p, DVec3::ZERO, ego).sweep();
        let with = sweep(&pattern);
        (pattern.own_body, pattern.beyond_grid) = (false, false);
        let bare = sweep(&pattern);
        assert!(bare.points.iter().all(|p| !is_own(p) && !is_beyond(p)));
        let own = with.points.iter().filter(|p| is_own(p)).count() as f64 / with.rays as f64;
        let beyond = with.points.iter().filter(|p| is_beyond(p)).count();
        assert!((0.09..0.14).contains(&own) && beyond > 1000, "{own} {beyond}");
        let key = |p: &LidarPoint| (p.ring, p.azimuth);
        let there: std::collections::HashMap<_, _> = bare.points.iter().map(|p| (key(p), *p)).collect();
        for p in with.points.iter().filter(|p| !is_own(p)) {
            match there.get(&key(p)) {
                Some(same) => assert_eq!(p, same),
                None => assert!(is_beyond(p), "{p:?}"),
            }
        }
        // No ray comes twice, and the order stays.
        assert!(with.points.windows(2).all(|w| key(&w[0]) < key(&w[1])));
        pattern.own_body = true;
        let own_only = sweep(&pattern);
        assert!(own_only.points.iter().any(is_own) && !own_only.points.iter().any(is_beyond));
    }
}
