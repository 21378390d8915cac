//! Objects, things and voxels that edits add to a recorded sweep, as rays meet them.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use scene::solid::Solid;
use scene::{Class, Lattice, SceneBox, VoxelGrid};
use world::objects;

use super::NEAREST_M;
use super::changes::SceneChanges;
use crate::lidar::shaped::within;
use crate::pictures::march::solids::SolidIndex;
use crate::raycast::ColumnMasks;

/// Things that are new, as rays meet them.
pub struct NewSolids {
    solids: SolidIndex,
    voxels: Option<(ColumnMasks, VoxelGrid)>,
    boxes: Vec<SceneBox>,
    /// Directions and half widths of what is new, rad.
    windows: Vec<[f64; 2]>,
}

impl NewSolids {
    /// Additions of some changes, as seen from a sensor. The scene's seed varies the solids of objects.
    pub fn new(changes: &SceneChanges, sensor: DVec3, seed: u64) -> Self {
        let mut groups: Vec<Vec<Solid>> = changes.things.clone();
        let mut boxes = Vec::new();
        let mut windows = Vec::new();
        for b in &changes.added {
            let mut solids = Vec::new();
            objects::object(b, seed, &mut solids);
            windows.push(window(
                b.center_m.truncate(),
                b.size_m.truncate().length() / 2.0,
                sensor,
            ));
            match solids.is_empty() {
                true => boxes.push(*b),
                false => groups.push(solids),
            }
        }
        for thing in changes.things.iter().filter(|solids| !solids.is_empty()) {
            let reach = |side: f64| {
                thing
                    .iter()
                    .map(move |s| (s.center + s.reach() * side).truncate())
            };
            let low = reach(-1.0).fold(DVec2::INFINITY, DVec2::min);
            let high = reach(1.0).fold(DVec2::NEG_INFINITY, DVec2::max);
            windows.push(window((low + high) / 2.0, (high - low).length() / 2.0, sensor));
        }
        if changes.voxels.is_some() {
            windows.push([0.0, PI]);
        }
        let voxels = changes.voxels.as_ref();
        Self {
            solids: SolidIndex::of_groups(changes.extent, groups.into_iter()),
            voxels: voxels.map(|grid| (ColumnMasks::from_grid(grid), grid.clone())),
            boxes,
            windows,
        }
    }

    /// Distance and class at which a ray meets something new, nearer than `limit_m`.
    pub fn met_by(&self, origin: DVec3, direction: DVec3, limit_m: f64) -> Option<(f64, Class)> {
        if !is_in_windows(&self.windows, direction) {
            return None;
        }
        let solid = self.solids.cast(origin, direction, limit_m);
        let solid = solid.map(|hit| (hit.t_m, hit.solid.class));
        let boxes = self.boxes.iter().filter_map(|b| {
            let t_m = entered(b, origin, direction)?;
            (t_m < limit_m).then_some((t_m, b.class))
        });
        let voxel = self.voxels.as_ref().and_then(|(masks, grid)| {
            let voxel_m = Lattice::OCC3D.voxel_m();
            let from = grid.extent().to_voxel_units(origin);
            let (t, [x, y, z]) = masks.cast_in_voxels(from, direction, limit_m / voxel_m)?;
            Some((
                t * voxel_m,
                Class::from_id(grid.get(x, y, z)).unwrap_or(Class::Others),
            ))
        });
        let all = boxes.chain(solid).chain(voxel);
        all.filter(|(t_m, _)| *t_m >= NEAREST_M)
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Direction and half width of a circle as seen from above the sensor, rad.
pub fn window(middle: DVec2, radius_m: f64, sensor: DVec3) -> [f64; 2] {
    let way = middle - sensor.truncate();
    match way.length() > radius_m {
        true => [way.y.atan2(way.x), (radius_m / way.length()).asin() + 1e-6],
        false => [0.0, PI],
    }
}

/// True if a way from the sensor leads into one of some directions.
pub fn is_in_windows(windows: &[[f64; 2]], way: DVec3) -> bool {
    let turn = way.y.atan2(way.x);
    let is_in = |[middle, half]: &[f64; 2]| ((turn - middle + PI).rem_euclid(TAU) - PI).abs() <= *half;
    windows.iter().any(is_in)
}

/// Distance at which a ray enters a box, m.
pub fn entered(b: &SceneBox, origin: DVec3, direction: DVec3) -> Option<f64> {
    within(b, origin, direction, 0.0).map(|[near_m, _]| near_m)
}
