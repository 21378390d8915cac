//! Parts of a scene that are inpainted although nothing was edited there.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::params::GenParams;
use super::region::{CELLS, CELLS_PER_SIDE, COLUMNS_PER_CELL, Region};
use scene::raster::{box_cells, polygon_cells};
use scene::{Frame, GridSpec};

const WORDS: usize = CELLS.div_ceil(64);

/// A set of latent cells, 1.6 m wide, `[i][j]` along ego x and y. As JSON a list of `[i, j]`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "Vec<[usize; 2]>", into = "Vec<[usize; 2]>")]
pub struct InpaintMask([u64; WORDS]);

impl Default for InpaintMask {
    fn default() -> Self {
        Self([0; WORDS])
    }
}

impl std::fmt::Debug for InpaintMask {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "InpaintMask({} cells)", self.count())
    }
}

impl InpaintMask {
    /// True if it holds no cell.
    pub fn is_empty(&self) -> bool {
        self.0 == [0; WORDS]
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.0.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// True if it holds the cell; false outside.
    pub fn has(&self, i: usize, j: usize) -> bool {
        let at = i * CELLS_PER_SIDE + j;
        i < CELLS_PER_SIDE && j < CELLS_PER_SIDE && self.0[at / 64] >> (at % 64) & 1 == 1
    }

    /// Puts a cell in or takes it out; nothing outside.
    pub fn set(&mut self, i: usize, j: usize, on: bool) {
        if i < CELLS_PER_SIDE && j < CELLS_PER_SIDE {
            let at = i * CELLS_PER_SIDE + j;
            let bit = 1u64 << (at % 64);
            self.0[at / 64] = if on {
                self.0[at / 64] | bit
            } else {
                self.0[at / 64] & !bit
            };
        }
    }

    /// Puts the cells of columns `[x, y]` in, or takes them out.
    pub fn set_columns(&mut self, columns: &[[usize; 2]], on: bool) {
        for [x, y] in columns {
            self.set(x / COLUMNS_PER_CELL, y / COLUMNS_PER_CELL, on);
        }
    }

    /// The cells that an upright rectangle of the ego frame touches by the centre of a column, m.
    pub fn of_rect(a_m: DVec2, b_m: DVec2) -> Self {
        let (min, max) = (a_m.min(b_m), a_m.max(b_m));
        Self::of_outline(&[min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)])
    }

    /// The cells that an outline of the ego frame, m, goes around or touches by the centre of a column.
    pub fn of_outline(points_m: &[DVec2]) -> Self {
        let mut mask = Self::default();
        polygon_cells(scene::Extent::WINDOW, points_m, |x, y| {
            mask.set_columns(&[[x, y]], true)
        });
        mask
    }

    /// Every cell `[i, j]`, in order.
    pub fn cells(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let all = (0..CELLS).map(|at| [at / CELLS_PER_SIDE, at % CELLS_PER_SIDE]);
        all.filter(|[i, j]| self.has(*i, *j))
    }
}

impl From<InpaintMask> for Vec<[usize; 2]> {
    fn from(mask: InpaintMask) -> Self {
        mask.cells().collect()
    }
}

impl TryFrom<Vec<[usize; 2]>> for InpaintMask {
    type Error = String;
    fn try_from(cells: Vec<[usize; 2]>) -> Result<Self, String> {
        let mut mask = Self::default();
        for [i, j] in cells {
            if i >= CELLS_PER_SIDE || j >= CELLS_PER_SIDE {
                return Err(format!(
                    "redraw holds [{i}, {j}], expected indices below {CELLS_PER_SIDE}"
                ));
            }
            mask.set(i, j, true);
        }
        Ok(mask)
    }
}

/// The region that parameters in automatic mode regenerate: what was edited, and the mask. Unchanged boxes in the mask are
/// left out, so that no untouched object is inpainted.
pub fn region_of(frame: &Frame, params: &GenParams) -> Region {
    let edited = Region::of_edit(frame, params.halo_columns as usize);
    if params.inpaint.is_empty() {
        return edited;
    }
    let mut columns: Vec<bool> = (0..GridSpec::COLUMNS)
        .map(|c| {
            let (x, y) = (c / GridSpec::NY, c % GridSpec::NY);
            params.inpaint.has(x / COLUMNS_PER_CELL, y / COLUMNS_PER_CELL)
        })
        .collect();
    let kept = frame
        .boxes
        .values()
        .filter(|b| frame.source.boxes.get(&b.id) == Some(b));
    for b in kept {
        box_cells(scene::Extent::WINDOW, b, GridSpec::VOXEL_M, |x, y| {
            columns[x * GridSpec::NY + y] = false
        });
    }
    for (column, edited) in columns.iter_mut().zip(edited.columns) {
        *column |= edited;
    }
    Region::of_columns(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{composite, untouched_voxels_changed};
    use scene::{BevLayer, BevLayout, BoxId, Class, SceneBox, VoxelGrid};

    #[test]
    fn masks_are_sets_and_travel_as_json() {
        let mut mask = InpaintMask::of_rect(DVec2::new(-40.0, -40.0), DVec2::new(-36.8, -38.4));
        assert_eq!(mask.cells().collect::<Vec<_>>(), [[0, 0], [1, 0]]);
        mask.set(49, 49, true);
        mask.set(50, 0, true);
        mask.set(0, 0, false);
        assert_eq!(
            (mask.count(), mask.is_empty(), mask.has(99, 99)),
            (2, false, false)
        );
        let text = serde_json::to_string(&mask).expect("JSON");
        assert_eq!(text, "[[1,0],[49,49]]");
        assert_eq!(serde_json::from_str::<InpaintMask>(&text).expect("JSON"), mask);
        let error = serde_json::from_str::<InpaintMask>("[[0,50]]").expect_err("outside");
        assert!(
            error
                .to_string()
                .starts_with("redraw holds [0, 50], expected indices below 50")
        );
        assert!(InpaintMask::of_rect(DVec2::NAN, DVec2::ZERO).is_empty());
        assert_eq!(
            InpaintMask::of_rect(DVec2::splat(-1e9), DVec2::splat(1e9)).count(),
            CELLS
        );
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
            inpaint: InpaintMask::of_rect(DVec2::splat(-8.0), DVec2::splat(8.0)),
            halo_columns: 0,
            ..GenParams::default()
        };
        assert!(region_of(&frame, &GenParams::default()).is_empty());
        frame.layout.set(BevLayer::Walkway, 10, 10, true);
        let region = region_of(&frame, &params);
        let [x, y] = GridSpec::column_at(0.0, 0.0).expect("inside");
        assert!(!region.columns[x * GridSpec::NY + y], "the car stays");
        assert!(region.columns[10 * GridSpec::NY + 10], "the edit counts too");
        assert!(
            (1400..=1601).contains(&region.column_count()),
            "{}",
            region.column_count()
        );
        let mut new = VoxelGrid::new();
        for c in 0..GridSpec::COLUMNS {
            new.column_mut(c / GridSpec::NY, c % GridSpec::NY)[3] = Class::Vegetation.id();
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
