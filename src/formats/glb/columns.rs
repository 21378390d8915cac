//! Foreign meshes to voxels: surfaces of still parts, and columns of things, in the convention of the labels.

use glam::DVec3;
use scene::raster::box_cells;
use scene::solid::fill::{SMEAR, smear_down};
use scene::{Class, Extent, SceneBox, VoxelGrid, Window};

use super::surface::TriangleRasteriser;
use crate::FormatError;

/// The surfaces of still parts at their measured height; ground apart.
pub(crate) struct Statics {
    surface: TriangleRasteriser,
    stands: VoxelGrid,
    ground: VoxelGrid,
}

impl Statics {
    pub(crate) fn new(extent: Extent) -> Self {
        Self {
            surface: TriangleRasteriser::new(extent),
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
            let top = Window::NZ as f64;
            if high >= 0.0 && low < top {
                touched = true;
                let to = high.min(top - 1.0) as usize;
                // Of ground its highest voxel in the column is enough: it has no sides.
                let from = if class.is_ground() {
                    to
                } else {
                    low.max(0.0) as usize
                };
                // Many triangles lie in voxels that are so already.
                if grid.column(x, y)[from..=to]
                    .iter()
                    .any(|label| *label != class.id())
                {
                    grid.column_mut(x, y)[from..=to].fill(class.id());
                }
            }
        });
        touched
    }

    /// Puts all into a grid in the convention of the labels: ground two bins lower, and things on it reaching down to
    /// it.
    pub(crate) fn finish(self, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        for [x, y] in grid.extent().all_columns() {
            let (mut column, ground) = (self.stands.column(x, y).to_vec(), self.ground.column(x, y));
            if column.iter().chain(ground).all(|label| *label == Class::FREE) {
                continue;
            }
            smear_down(&mut column, SMEAR);
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

/// How high a thing is in each column that its box may cover.
pub(crate) struct Heights {
    surface: TriangleRasteriser,
    /// First column, and how many along x and y.
    from: [usize; 2],
    size: [usize; 2],
    /// `[x][y]` from the first column on; `NEG_INFINITY` where nothing was found.
    top: Vec<f64>,
}

impl Heights {
    /// The heights of a thing with this box, none found yet.
    pub(crate) fn new(extent: Extent, b: &SceneBox) -> Self {
        let reach = DVec3::new(1.0, 1.0, 0.0) * (b.size_m.truncate().length() / 2.0);
        let [low, high] = [-reach, reach].map(|r| extent.to_voxel_units(b.center_m + r));
        let most = [extent.nx(), extent.ny()];
        let column = |v: f64, axis: usize| v.clamp(0.0, most[axis] as f64) as usize;
        let from = [0, 1].map(|axis| column(low[axis].floor(), axis));
        let size = [0, 1].map(|axis| column(high[axis].floor() + 1.0, axis) - from[axis]);
        Self {
            surface: TriangleRasteriser::new(extent),
            from,
            size,
            top: vec![f64::NEG_INFINITY; size[0] * size[1]],
        }
    }

    fn place(from: [usize; 2], size: [usize; 2], [x, y]: [usize; 2]) -> Option<usize> {
        let (x, y) = (x.checked_sub(from[0])?, y.checked_sub(from[1])?);
        (x < size[0] && y < size[1]).then_some(x * size[1] + y)
    }

    pub(crate) fn add(&mut self, corners: [DVec3; 3]) {
        let (top, from, size) = (&mut self.top, self.from, self.size);
        self.surface.visit(corners, |column, [_, high]| {
            if let Some(place) = Self::place(from, size, column) {
                top[place] = top[place].max(high);
            }
        });
    }

    /// Fills the columns of the box from the ground to the height that was found there. A voxel counts once a sixth of
    /// it is filled, as in the draft of a box.
    pub(crate) fn fill(self, b: &SceneBox, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        let extent = grid.extent();
        let bottom = extent
            .to_voxel_units(b.center_m - DVec3::Z * (b.size_m.z / 2.0))
            .z;
        let mut columns = Vec::new();
        box_cells(extent, b, 0.0, |x, y| columns.push([x, y]));
        for [x, y] in columns {
            let place = Self::place(self.from, self.size, [x, y]);
            let top = place.map_or(f64::NEG_INFINITY, |place| self.top[place]);
            if top == f64::NEG_INFINITY {
                continue;
            }
            let column = grid.column_mut(x, y);
            let ground = |label: &u8| Class::from_id(*label).is_some_and(Class::is_ground);
            let base = column.iter().position(ground);
            let below = (bottom.floor().clamp(0.0, Window::NZ as f64 - 1.0) as usize).saturating_sub(SMEAR);
            let base = base.filter(|base| *base <= below + 1).unwrap_or(below);
            let layers = ((top - 1.0 / 6.0).floor() + 1.0).clamp(0.0, Window::NZ as f64) as usize;
            column[base..layers.max(base + 1)].fill(b.class.id());
        }
        Ok(())
    }
}
