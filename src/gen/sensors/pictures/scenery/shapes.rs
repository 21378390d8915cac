//! Scenery as exact rays meet it: the solids of things whose voxels are there, instead of those voxels.

use glam::DVec3;

use super::{SceneryInput, ShownScenery};
use crate::pictures::march::solids::{SolidHit, SolidIndex};
use scene::{Background, Class, Extent, Frame, Scene, VoxelGrid};

/// Solids of a map's scenery, and the voxels that they stand for.
pub struct SceneryShapes {
    extent: Extent,
    /// A bit for each bin of each column.
    stood_for: Vec<u64>,
    /// Height of the ground in each column, m: below it labels go down to their ground.
    ground_m: Vec<f32>,
    solids: SolidIndex,
}

impl SceneryShapes {
    /// The scenery of a scene's frame; `None` if nothing can stand for its voxels.
    pub fn from_scene(scene: &Scene) -> Option<Self> {
        Self::new(scene.frame(), &scene.background)
    }

    /// The scenery of a frame; `None` if nothing can stand for its voxels. Things of which something was cut out stay voxels.
    pub fn new(frame: &Frame, background: &Background) -> Option<Self> {
        let (layout, extent) = (&frame.layout, frame.extent());
        let input = SceneryInput {
            background,
            occupancy: &frame.occupancy,
            painted: &frame.painted,
            layout,
            inferred: frame.inferred.background,
        };
        let shown = ShownScenery::new(input).of_whole_things();
        let whole = || {
            shown
                .things()
                .iter()
                .filter(|shown| shown.cuts_m(extent).is_some())
        };
        whole().next()?;
        let solids = |thing: &scene::Thing| {
            let mut solids = Vec::new();
            thing.solids(&|p| layout.relief.height_m(p), &mut solids);
            // Fences are of boards, as pictures show them.
            solids.iter_mut().for_each(|solid| solid.porosity = 0.0);
            solids
        };
        let groups = whole().map(|shown| solids(&shown.thing));
        let height = |[x, y]: [usize; 2]| layout.relief.column_m(x, y) as f32;
        Some(Self {
            extent,
            stood_for: shown.stood_for(&frame.occupancy, &frame.painted),
            ground_m: extent.all_columns().map(height).collect(),
            solids: SolidIndex::of_groups(extent, groups),
        })
    }

    /// True if solids stand for a voxel that was met at a height, m.
    pub(crate) fn stands_for(&self, [x, y, z]: [usize; 3], met_m: f64) -> bool {
        let i = self.extent.index(x, y);
        let mask = self.stood_for.get(i).copied().unwrap_or(0);
        mask >> z & 1 == 1 && met_m >= f64::from(self.ground_m[i])
    }

    /// Removes the voxels that solids stand for from a grid of the same map, as far as they are above the ground.
    pub(crate) fn remove_from(&self, grid: &mut VoxelGrid) {
        for [x, y] in self
            .extent
            .all_columns()
            .filter(|[x, y]| self.stood_for[self.extent.index(*x, *y)] != 0)
        {
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
