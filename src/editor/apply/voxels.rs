//! Edits of voxels: paint, unlock, a generated result that is taken over.

use std::sync::Arc;

use scene::grid::NOT_PAINTED;
use scene::shape::at_least;
use scene::{Edit, EditError, Frame, SourceFrame, VoxelGrid, VoxelPaint};

/// Applies an edit of voxels; `false` if it is about something else.
pub(super) fn apply(edit: &Edit, frame: &mut Frame) -> Result<bool, EditError> {
    match edit {
        Edit::PaintVoxels { cells, class } => {
            check_voxels(scene::Extent::WINDOW, cells)?;
            for &[x, y, z] in cells {
                frame.painted.set(x, y, z, class.id());
                frame.occupancy.set(x, y, z, class.id());
            }
        }
        Edit::UnlockVoxels { cells } => {
            check_voxels(scene::Extent::WINDOW, cells)?;
            for &[x, y, z] in cells {
                frame.painted.set(x, y, z, NOT_PAINTED);
            }
        }
        Edit::ClearPaint {} => frame.painted = VoxelPaint::new(),
        Edit::AdoptResult { occupancy } => adopt(frame, occupancy.clone()),
        _ => return Ok(false),
    }
    Ok(true)
}

/// Makes a generated occupancy the frame's own and its source. Painted voxels keep what was painted.
pub(crate) fn adopt(frame: &mut Frame, mut occupancy: VoxelGrid) {
    for (x, y, z, class) in frame.painted.iter_set() {
        occupancy.set(x, y, z, class);
    }
    frame.occupancy = occupancy;
    frame.source = Arc::new(SourceFrame {
        layout: frame.layout.clone(),
        boxes: frame.boxes.clone(),
        occupancy: frame.occupancy.clone(),
    });
}

fn check_voxels(extent: scene::Extent, cells: &[[usize; 3]]) -> Result<(), EditError> {
    at_least("cells", cells.len(), 1)?;
    let outside = |c: &&[usize; 3]| !extent.holds(c[0], c[1]) || c[2] >= scene::Extent::NZ;
    match cells.iter().find(outside) {
        Some(c) => Err(EditError::CellOutside {
            cell: c.to_vec(),
            extent,
        }),
        None => Ok(()),
    }
}
