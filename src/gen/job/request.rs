//! The user's request in voxels: where the boxes of a frame allow objects, which voxels are painted, and which columns
//! an edit changed.

use glam::DVec3;

use super::region::Region;
use scene::grid::NOT_PAINTED;
use scene::raster::box_cells;
use scene::{Class, Extent, Frame, SceneBox, VoxelGrid, Window, draft};

/// Largest distance of an object's voxels outside its box: one voxel.
pub const OVERHANG_M: f64 = Window::VOXEL_M;
const OBJECTS: usize = Class::OBJECTS.len();

/// Voxels and columns of a frame that the user's boxes, paint and edits ask for.
pub struct VoxelRequest<'a> {
    frame: &'a Frame,
    /// `[x][y]`: number of bins from the lowest up that each object class (ids 1 to 10) may fill.
    heights: Vec<[u8; OBJECTS]>,
    /// `[x][y]`: columns in which a box of the source stood that is now gone, moved or of another class.
    left: Vec<bool>,
    /// `[x][y]`: those columns, the columns of new and changed boxes, those whose ground the layout changed, and new
    /// ground.
    edited: Vec<bool>,
}

impl<'a> VoxelRequest<'a> {
    /// The request of a frame and its source.
    pub fn from_frame(frame: &'a Frame) -> Self {
        let mut heights = vec![[0; OBJECTS]; Window::COLUMNS];
        for b in frame.boxes.values() {
            let Some(slot) = slot(b.class.id()) else { continue };
            let bins = bins_of(b);
            box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
                let height = &mut heights[x * Window::NY + y][slot];
                *height = bins.max(*height);
            });
        }
        let (mut left, mut edited) = (vec![false; Window::COLUMNS], vec![false; Window::COLUMNS]);
        let source = &*frame.source;
        for (id, b) in &source.boxes {
            if frame.boxes.get(id) != Some(b) {
                box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
                    left[x * Window::NY + y] = true
                });
            }
        }
        edited.copy_from_slice(&left);
        for (id, b) in &frame.boxes {
            if source.boxes.get(id) != Some(b) {
                box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
                    edited[x * Window::NY + y] = true
                });
            }
        }
        let layouts = frame.layout.cells().iter().zip(source.layout.cells());
        for (edited, (now, before)) in edited.iter_mut().zip(layouts) {
            *edited |= draft::ground_class(*now) != draft::ground_class(*before);
        }
        for (edited, [x, y]) in edited.iter_mut().zip(Extent::WINDOW.all_columns()) {
            *edited |= frame.is_new_ground(x, y);
        }
        Self {
            frame,
            heights,
            left,
            edited,
        }
    }

    /// True if this label at this voxel belongs to a box of the frame, or was painted by the user.
    pub fn holds(&self, x: usize, y: usize, z: usize, label: u8) -> bool {
        let boxed = slot(label).is_some_and(|s| z < usize::from(self.heights[x * Window::NY + y][s]));
        boxed || self.frame.painted.get(x, y, z) != NOT_PAINTED
    }

    /// True for a column (index `[x][y]`) of a source box that is not there any more.
    pub fn left_by_a_box(&self, column: usize) -> bool {
        self.left[column]
    }

    /// True for a column (index `[x][y]`) whose box or ground was added, removed or changed.
    pub fn edited(&self, column: usize) -> bool {
        self.edited[column]
    }

    /// Calls `visit` with place and label of each invented voxel: one in the region's columns, above the ground, that was
    /// neither in the source nor asked for.
    pub fn each_invented(
        &self,
        after: &VoxelGrid,
        region: &Region,
        mut visit: impl FnMut(usize, usize, usize, u8),
    ) {
        let source = &self.frame.source.occupancy;
        for (c, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
            let (x, y) = (c / Window::NY, c % Window::NY);
            let labels = source.column(x, y).iter().zip(after.column(x, y));
            for (z, (before, now)) in labels.enumerate() {
                if now != before && stands(*now) && !self.holds(x, y, z, *now) {
                    visit(x, y, z, *now);
                }
            }
        }
    }
}

/// True for labels of things that stand on the ground: all but free and the four ground classes.
pub fn stands(label: u8) -> bool {
    Class::from_id(label).is_some_and(|c| c != Class::Free && !c.is_ground())
}

/// Number of voxels that belong to a box: those of its class in its columns and a voxel around them, up to a voxel
/// above it.
pub fn voxels_of(grid: &VoxelGrid, b: &SceneBox) -> usize {
    let (mut count, bins) = (0, usize::from(bins_of(b)));
    box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
        let column = grid.column(x, y)[..bins].iter();
        count += column.filter(|l| **l == b.class.id()).count();
    });
    count
}

fn slot(label: u8) -> Option<usize> {
    let class = Class::from_id(label).filter(|c| c.is_object())?;
    Some(usize::from(class.id()) - 1)
}

/// Bins from the lowest one up to a voxel above the box's top.
fn bins_of(b: &SceneBox) -> u8 {
    let top_m = b.center_m.z + b.size_m.z / 2.0 + OVERHANG_M;
    let bins = Window::to_voxel_units(DVec3::new(0.0, 0.0, top_m)).z.ceil();
    // A box under the ground counts as one voxel high.
    bins.clamp(1.0, Window::NZ as f64) as u8
}

#[cfg(test)]
pub(crate) mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::region::tests::car;
    use scene::{BevLayer, BevLayout, BoxId};

    /// A road over the whole map with two cars, of which the second was just removed.
    pub fn removal() -> Frame {
        let mut layout = BevLayout::default();
        for c in 0..Window::COLUMNS {
            layout.set(BevLayer::DrivableArea, c / Window::NY, c % Window::NY, true);
        }
        let cars = [car(1, -10.0, 0.0, 0.0), car(2, 10.0, 0.0, 0.0)];
        let before = draft::draft(&layout, cars.iter());
        let boxes: BTreeMap<BoxId, SceneBox> = cars.into_iter().map(|b| (b.id, b)).collect();
        let mut frame = Frame::new(layout, boxes, before);
        frame.boxes.remove(&BoxId(2));
        frame
    }

    #[test]
    fn boxes_and_paint_are_asked_for_and_what_was_removed_is_not() {
        let mut frame = removal();
        frame.painted.set(5, 5, 5, Class::Vegetation.id());
        let request = VoxelRequest::from_frame(&frame);
        let [x, y] = Window::column_at(-10.0, 0.0).expect("inside");
        assert!(request.holds(x, y, 3, Class::Car.id()));
        assert!(!request.holds(x, y, 3, Class::Truck.id()), "a car was asked for");
        assert!(!request.holds(x, y, 12, Class::Car.id()), "far above its roof");
        assert!(!request.holds(x, y + 9, 3, Class::Car.id()), "beside it");
        assert!(request.holds(5, 5, 5, Class::Vegetation.id()));
        assert!(!request.left_by_a_box(x * Window::NY + y) && !request.edited(x * Window::NY + y));
        let [x, y] = Window::column_at(10.0, 0.0).expect("inside");
        assert!(!request.holds(x, y, 3, Class::Car.id()));
        assert!(request.left_by_a_box(x * Window::NY + y) && request.edited(x * Window::NY + y));
        let mut found = Vec::new();
        let mut after = VoxelGrid::new();
        after.set(x, y, 6, Class::Vegetation.id());
        after.set(x, y, 0, Class::DriveableSurface.id());
        let region = Region::of_edit(&frame, 2);
        request.each_invented(&after, &region, |x, y, z, label| {
            found.push([x, y, z, label.into()])
        });
        assert_eq!(found, [[x, y, 6, Class::Vegetation.id().into()]]);
    }
}
