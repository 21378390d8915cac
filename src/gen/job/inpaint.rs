//! Parts of a scene that are inpainted although they were not edited.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::params::GenParams;
use super::region::{COLUMNS_PER_CELL, Region, edited_columns};
use scene::raster::{box_cells, polygon_cells};
use scene::{Extent, Frame, Lattice, SceneBox, Window};

/// A sparse set of latent cells, 1.6 m wide: `[i, j]` along ego x and y, counted from the corner of the networks' window, so
/// that a cell of the window at the origin lies in `0..50`. A cell may lie anywhere on the map. As JSON a list of `[i, j]`.
#[derive(Clone, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "Vec<[i32; 2]>", into = "Vec<[i32; 2]>")]
pub struct InpaintMask(Arc<BTreeSet<[i32; 2]>>);

impl std::fmt::Debug for InpaintMask {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "InpaintMask({} cells)", self.count())
    }
}

/// Margin around an unchanged box in which nothing is inpainted, m.
pub const KEPT_M: f64 = Window::VOXEL_M;

impl InpaintMask {
    /// Largest distance of a cell from the corner of the window; no map is larger, so farther cells are refused.
    const FARTHEST: i32 = (Extent::MAX_COLUMNS / COLUMNS_PER_CELL) as i32;

    /// True if it holds no cell.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// True if it holds the cell.
    pub fn has(&self, cell: [i32; 2]) -> bool {
        self.0.contains(&cell)
    }

    /// True if it holds the cell of a column of a map.
    pub fn has_column(&self, extent: Extent, column: [usize; 2]) -> bool {
        !self.is_empty() && self.has(Self::cell_of(extent, column))
    }

    /// Puts a cell in or takes it out.
    pub fn set(&mut self, cell: [i32; 2], on: bool) {
        if self.has(cell) == on {
            return;
        }
        let cells = Arc::make_mut(&mut self.0);
        match on {
            true => cells.insert(cell),
            false => cells.remove(&cell),
        };
    }

    /// The cell that holds a column of a map.
    pub fn cell_of(extent: Extent, [x, y]: [usize; 2]) -> [i32; 2] {
        if extent.lattice() != Lattice::OCC3D {
            let p = extent.center(x, y, 0).truncate() - Extent::WINDOW.min_m().truncate();
            let cell_m = COLUMNS_PER_CELL as f64 * Window::VOXEL_M;
            return (p / cell_m).floor().as_ivec2().to_array();
        }
        let (from, window) = (extent.from(), Extent::WINDOW.from());
        let along = |axis: usize, at: usize| {
            (from[axis] - window[axis] + at as i32).div_euclid(COLUMNS_PER_CELL as i32)
        };
        [along(0, x), along(1, y)]
    }

    /// Puts the cells of columns `[x, y]` of a map in, or takes them out.
    pub fn set_columns(&mut self, extent: Extent, columns: &[[usize; 2]], on: bool) {
        for column in columns {
            self.set(Self::cell_of(extent, *column), on);
        }
    }

    /// Flags of the columns of a map that it holds, `[x][y]`.
    pub fn columns(&self, extent: Extent) -> Vec<bool> {
        let held = |column| self.has_column(extent, column);
        extent.all_columns().map(held).collect()
    }

    /// The cells of a map that an upright rectangle of the ego frame touches by the centre of a column, m.
    pub fn of_rect(extent: Extent, a_m: DVec2, b_m: DVec2) -> Self {
        let (min, max) = (a_m.min(b_m), a_m.max(b_m));
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        Self::of_outline(extent, &corners)
    }

    /// The cells of a map that an outline of the ego frame, m, goes around or touches by the centre of a column.
    pub fn of_outline(extent: Extent, points_m: &[DVec2]) -> Self {
        let mut cells = BTreeSet::new();
        polygon_cells(extent, points_m, |x, y| {
            cells.insert(Self::cell_of(extent, [x, y]));
        });
        Self(Arc::new(cells))
    }

    /// Every cell `[i, j]`, in order.
    pub fn cells(&self) -> impl Iterator<Item = [i32; 2]> + '_ {
        self.0.iter().copied()
    }

    /// A rectangle of cells along x and y.
    pub fn of_cells([x, y]: &[std::ops::Range<i32>; 2]) -> Self {
        let cells = x.clone().flat_map(|i| y.clone().map(move |j| [i, j]));
        Self(Arc::new(cells.collect()))
    }

    /// The mask with its cells counted from the given cell.
    pub fn from_cell(&self, [i0, j0]: [i32; 2]) -> Self {
        match [i0, j0] == [0, 0] {
            true => self.clone(),
            false => Self(Arc::new(self.cells().map(|[i, j]| [i - i0, j - j0]).collect())),
        }
    }

    /// The mask without the cells of a square of `side` cells whose lowest cell is `low`.
    pub fn without(&self, low: [i32; 2], side: i32) -> Self {
        let within = |cell: &[i32; 2]| (0..2).all(|axis| (0..side).contains(&(cell[axis] - low[axis])));
        Self(Arc::new(self.cells().filter(|cell| !within(cell)).collect()))
    }

    /// True if a box stands on one of its cells, in the window at the origin.
    pub fn touches(&self, b: &SceneBox) -> bool {
        let mut found = false;
        box_cells(Extent::WINDOW, b, 0.0, |x, y| {
            found |= self.has_column(Extent::WINDOW, [x, y])
        });
        found
    }
}

impl From<InpaintMask> for Vec<[i32; 2]> {
    fn from(mask: InpaintMask) -> Self {
        mask.cells().collect()
    }
}

impl TryFrom<Vec<[i32; 2]>> for InpaintMask {
    type Error = String;
    fn try_from(cells: Vec<[i32; 2]>) -> Result<Self, String> {
        let far = |n: &i32| n.unsigned_abs() > Self::FARTHEST as u32;
        if let Some([i, j]) = cells.iter().find(|cell| cell.iter().any(far)) {
            return Err(format!(
                "redraw holds [{i}, {j}], expected indices within {}",
                Self::FARTHEST
            ));
        }
        Ok(Self(Arc::new(cells.into_iter().collect())))
    }
}

/// The region of the window that parameters in automatic mode regenerate; see [`wanted_columns`].
pub fn region_of(frame: &Frame, params: &GenParams) -> Region {
    match frame.extent() == Extent::WINDOW {
        true => Region::of_columns(wanted_columns(frame, params)),
        false => region_of(&frame.crop(Extent::WINDOW), params),
    }
}

/// The columns `[x][y]` of a frame's map that parameters in automatic mode regenerate: edited columns, and those of the
/// mask. Unchanged boxes in the mask are left out, so that no untouched object is inpainted.
pub fn wanted_columns(frame: &Frame, params: &GenParams) -> Vec<bool> {
    let edited = edited_columns(frame, params.halo_columns as usize);
    if params.inpaint.is_empty() {
        return edited;
    }
    let extent = frame.extent();
    let mut columns = params.inpaint.columns(extent);
    let kept = frame
        .boxes
        .values()
        .filter(|b| frame.source.boxes.get(&b.id) == Some(b));
    for b in kept {
        box_cells(extent, b, KEPT_M, |x, y| columns[extent.index(x, y)] = false);
    }
    for (column, edited) in columns.iter_mut().zip(edited) {
        *column |= edited;
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{composite, untouched_voxels_changed};
    use crate::region::CELLS;
    use scene::Window;
    use scene::{BevLayer, BevLayout, BoxId, Class, SceneBox, VoxelGrid};

    const WINDOW: Extent = Extent::WINDOW;

    #[test]
    fn masks_are_sets_and_travel_as_json() {
        let mut mask = InpaintMask::of_rect(WINDOW, DVec2::new(-40.0, -40.0), DVec2::new(-36.8, -38.4));
        assert_eq!(mask.cells().collect::<Vec<_>>(), [[0, 0], [1, 0]]);
        mask.set([49, 49], true);
        mask.set([0, 0], false);
        mask.set([-3, 60], true);
        assert_eq!((mask.count(), mask.is_empty()), (3, false));
        let text = serde_json::to_string(&mask).expect("JSON");
        assert_eq!(text, "[[-3,60],[1,0],[49,49]]");
        assert_eq!(serde_json::from_str::<InpaintMask>(&text).expect("JSON"), mask);
        let error = serde_json::from_str::<InpaintMask>("[[0,99999999]]").expect_err("outside");
        assert!(
            error
                .to_string()
                .starts_with("redraw holds [0, 99999999], expected"),
            "{error}"
        );
        assert!(InpaintMask::of_rect(WINDOW, DVec2::NAN, DVec2::ZERO).is_empty());
        let all = InpaintMask::of_rect(WINDOW, DVec2::splat(-1e9), DVec2::splat(1e9));
        assert_eq!(all.count(), CELLS);
        assert!(all.columns(WINDOW).iter().all(|held| *held));
    }

    #[test]
    fn a_place_has_the_same_cell_on_every_map() {
        let map = Extent::new([-150, -110], [480, 320]).expect("sound");
        let at = |extent: Extent, p: DVec2| {
            InpaintMask::cell_of(extent, extent.column_at(p.x, p.y).expect("inside"))
        };
        for p in [DVec2::ZERO, DVec2::new(-39.9, 39.9), DVec2::new(12.3, -7.7)] {
            assert_eq!(at(map, p), at(WINDOW, p), "{p}");
        }
        assert_eq!(at(map, DVec2::new(-40.1, 41.7)), [-1, 51]);
        let mask = InpaintMask::of_rect(map, DVec2::new(96.0, 0.0), DVec2::new(99.2, 1.6));
        assert_eq!(mask.count(), 2);
        let moved = mask.from_cell([85, 24]);
        assert_eq!(moved.cells().collect::<Vec<_>>(), [[0, 1], [1, 1]]);
        assert_eq!(moved.without([1, 0], 4).cells().collect::<Vec<_>>(), [[0, 1]]);
        assert_eq!(mask.columns(map).iter().filter(|held| **held).count(), 2 * 16);
        assert!(!mask.columns(WINDOW).contains(&true));
    }

    #[test]
    fn only_the_mask_and_the_edit_are_redrawn_and_boxes_stay() {
        let car = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: glam::DVec3::new(0.0, 0.0, 0.8),
            size_m: glam::DVec3::new(4.6, 1.9, 1.7),
            yaw_rad: 0.4,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let boxes = [(BoxId(1), car)].into();
        let mut frame = Frame::new(BevLayout::default(), boxes, VoxelGrid::new());
        let params = GenParams {
            inpaint: InpaintMask::of_rect(WINDOW, DVec2::splat(-8.0), DVec2::splat(8.0)),
            halo_columns: 0,
            ..GenParams::default()
        };
        assert!(region_of(&frame, &GenParams::default()).is_empty());
        frame.layout.set(BevLayer::Walkway, 10, 10, true);
        let region = region_of(&frame, &params);
        let [x, y] = Window::column_at(0.0, 0.0).expect("inside");
        assert!(!region.columns[x * Window::NY + y], "the car stays");
        assert!(region.columns[10 * Window::NY + 10], "the edit counts too");
        assert!(
            (1400..=1601).contains(&region.column_count()),
            "{}",
            region.column_count()
        );
        let mut new = VoxelGrid::new();
        for c in 0..Window::COLUMNS {
            new.column_mut(c / Window::NY, c % Window::NY)[3] = Class::Vegetation.id();
        }
        let source = &frame.source.occupancy;
        let result = composite(source, &new, &region, &frame.painted);
        assert_eq!(result.count_set(), region.column_count());
        assert_eq!(
            untouched_voxels_changed(source, &result, &region, &frame.painted),
            0
        );
    }
}
