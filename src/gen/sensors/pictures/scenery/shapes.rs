//! Scenery as exact rays meet it: the solids of things whose voxels are there, instead of those voxels.

use std::collections::HashMap;

use glam::DVec3;

use super::{SceneryInput, ShownScenery};
use crate::pictures::march::solids::{SolidHit, SolidIndex};
use scene::{Background, Class, Extent, Frame, Relief, Scene, Thing, VoxelGrid};

/// Way of a vehicle during one turn of its LiDAR, m.
const MOVES_M: f64 = 10.0;

/// Solids of a map's scenery, and the voxels that they stand for.
pub struct SceneryShapes {
    extent: Extent,
    /// A bit for each bin, by column.
    stood_for: HashMap<usize, u64>,
    /// Ground below which labels go down to theirs.
    relief: Relief,
    solids: SolidIndex,
    shown: ShownScenery,
}

impl SceneryShapes {
    /// The scenery that the LiDARs of a scene's rig can reach, which stands in the frame's coordinates; `None` if there is
    /// none that can stand for its voxels. What is the same as in `before` is taken from there.
    pub fn of_lidars(scene: &Scene, before: Option<&Self>) -> Option<Self> {
        let lidars = scene.rig.lidars.iter();
        let reach = lidars.map(|l| (l.ego_from_sensor().translation_m, l.max_range_m));
        let near = within(&scene.background, &reach.collect::<Vec<_>>());
        Self::again(scene.frame(), &near, before)
    }

    /// The scenery of a frame within some distances of some places, m.
    pub fn within(frame: &Frame, background: &Background, reach: &[(DVec3, f64)]) -> Option<Self> {
        Self::new(frame, &within(background, reach))
    }

    /// The scenery of a frame; `None` if nothing can stand for its voxels. Things of which something was cut out stay voxels.
    pub fn new(frame: &Frame, background: &Background) -> Option<Self> {
        Self::again(frame, background, None)
    }

    fn again(frame: &Frame, background: &Background, before: Option<&Self>) -> Option<Self> {
        let (layout, extent) = (&frame.layout, frame.extent());
        let input = SceneryInput {
            background,
            occupancy: &frame.occupancy,
            painted: &frame.painted,
            layout,
            inferred: frame.inferred.background,
        };
        let shown = ShownScenery::new(input, before.map(|b| &b.shown)).of_whole_things();
        let whole = || {
            shown
                .things()
                .iter()
                .filter(|shown| shown.cuts_m(extent).is_some())
        };
        whole().next()?;
        let solids = |thing: &Thing| {
            let mut solids = Vec::new();
            thing.solids(&|p| layout.relief.height_m(p), &mut solids);
            // Fences are of boards, as pictures show them.
            solids.iter_mut().for_each(|solid| solid.porosity = 0.0);
            solids
        };
        let groups = whole().map(|shown| solids(&shown.thing));
        Some(Self {
            extent,
            stood_for: shown
                .stood_for(&frame.occupancy, &frame.painted)
                .into_iter()
                .collect(),
            relief: layout.relief.clone(),
            solids: SolidIndex::of_groups(extent, groups),
            shown,
        })
    }

    /// True if solids stand for a voxel that was met at a height, m.
    pub(crate) fn stands_for(&self, [x, y, z]: [usize; 3], met_m: f64) -> bool {
        let mask = self.stood_for.get(&self.extent.index(x, y)).copied();
        mask.unwrap_or(0) >> z & 1 == 1 && met_m >= self.relief.column_m(x, y)
    }

    /// Removes the voxels that solids stand for from a grid of the same map, as far as they are above the ground.
    pub(crate) fn remove_from(&self, grid: &mut VoxelGrid) {
        for [x, y] in self.stood_for.keys().map(|i| self.extent.column(*i)) {
            for z in 0..self.extent.nz() {
                if self.stands_for([x, y, z], self.extent.center(x, y, z).z) {
                    grid.set(x, y, z, Class::FREE);
                }
            }
        }
    }

    /// The first solid along a ray, nearer than `limit_m`; the direction is a unit vector.
    pub(crate) fn cast(&self, origin: DVec3, direction: DVec3, limit_m: f64) -> Option<SolidHit<'_>> {
        self.solids.cast(origin, direction, limit_m)
    }
}

/// The things within some distances of some places, m.
fn within(background: &Background, reach: &[(DVec3, f64)]) -> Background {
    let is_near = |thing: &&Thing| {
        let (low, high) = thing.form.bounds_m();
        let near = |(at, reach_m): &(DVec3, f64)| {
            let at = at.truncate();
            at.clamp(low, high).distance(at) <= reach_m + MOVES_M
        };
        reach.iter().any(near)
    };
    background.iter().filter(is_near).cloned().collect()
}
