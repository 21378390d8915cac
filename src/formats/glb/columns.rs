//! Foreign meshes to voxels: surfaces of what stands still, and columns of things, in the convention of the labels.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::raster::box_cells;
use scene::solid::fill::{SMEAR, smear_down};
use scene::{Class, Extent, SceneBox, VoxelGrid};

use super::surface::Surface;
use crate::FormatError;

/// The surfaces of what stands still, as they are measured; ground apart.
pub(crate) struct Statics {
    surface: Surface,
    stands: VoxelGrid,
    ground: VoxelGrid,
}

impl Statics {
    pub(crate) fn new(extent: Extent) -> Self {
        Self {
            surface: Surface::new(extent),
            stands: VoxelGrid::over(extent),
            ground: VoxelGrid::over(extent),
        }
    }

    /// Adds a triangle (m). False if it touches no voxel.
    pub(crate) fn add(&mut self, class: Class, corners: [DVec3; 3]) -> bool {
        let grid = if class.is_ground() {
            &mut self.ground
        } else {
            &mut self.stands
        };
        let mut touched = false;
        self.surface.visit(corners, |[x, y], [low, high]| {
            let top = Extent::NZ as f64;
            if high >= 0.0 && low < top {
                touched = true;
                // Of ground its highest voxel in the column is enough: it has no sides.
                let from = if class.is_ground() {
                    high.min(top - 1.0)
                } else {
                    low.max(0.0)
                };
                (from as usize..=high.min(top - 1.0) as usize).for_each(|z| grid.set(x, y, z, class.id()));
            }
        });
        touched
    }

    /// Puts all into a grid in the convention of the labels: ground two bins lower, what stands on it reaching down to it.
    pub(crate) fn finish(self, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        for [x, y] in grid.extent().all_columns() {
            let (mut column, ground) = (*self.stands.column(x, y), self.ground.column(x, y));
            if column.iter().chain(ground).all(|label| *label == Class::FREE) {
                continue;
            }
            smear_down(&mut column);
            let mut lowest = None;
            for (z, class) in ground
                .iter()
                .enumerate()
                .filter(|(_, class)| **class != Class::FREE)
            {
                let bin = z.saturating_sub(SMEAR);
                lowest.get_or_insert(bin);
                if column[bin] == Class::FREE {
                    column[bin] = *class;
                }
            }
            column[..lowest.unwrap_or(0)].fill(Class::FREE);
            let out = grid.column_mut(x, y);
            for (to, label) in out
                .iter_mut()
                .zip(column)
                .filter(|(_, label)| *label != Class::FREE)
            {
                *to = label;
            }
        }
        Ok(())
    }
}

/// How high a thing is in each column that it touches.
pub(crate) struct Heights {
    surface: Surface,
    top: BTreeMap<[usize; 2], f64>,
}

impl Heights {
    pub(crate) fn new(extent: Extent) -> Self {
        Self {
            surface: Surface::new(extent),
            top: BTreeMap::new(),
        }
    }

    pub(crate) fn add(&mut self, corners: [DVec3; 3]) {
        let top = &mut self.top;
        self.surface.visit(corners, |column, [_, high]| {
            let known = top.entry(column).or_insert(high);
            *known = known.max(high);
        });
    }

    /// Fills the columns of the box from the ground to what was found there. As in the draft of a box, a voxel counts once a
    /// sixth of it is filled.
    pub(crate) fn fill(self, b: &SceneBox, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        let extent = grid.extent();
        let bottom = extent
            .to_voxel_units(b.center_m - DVec3::Z * (b.size_m.z / 2.0))
            .z;
        let mut columns = Vec::new();
        box_cells(extent, b, 0.0, |x, y| columns.push([x, y]));
        for [x, y] in columns {
            let Some(top) = self.top.get(&[x, y]) else {
                continue;
            };
            let column = grid.column_mut(x, y);
            let ground = |label: &u8| Class::from_id(*label).is_some_and(Class::is_ground);
            let base = column.iter().position(ground);
            let below = (bottom.floor().clamp(0.0, Extent::NZ as f64 - 1.0) as usize).saturating_sub(SMEAR);
            let base = base.filter(|base| *base <= below + 1).unwrap_or(below);
            let layers = ((top - 1.0 / 6.0).floor() + 1.0).clamp(0.0, Extent::NZ as f64) as usize;
            column[base..layers.max(base + 1)].fill(b.class.id());
        }
        Ok(())
    }
}
