//! Edits of voxels: paint, unlock, a generated result that is taken over.

use scene::grid::NOT_PAINTED;
use scene::shape::at_least;
use scene::{Edit, EditError, Extent, Frame, VoxelGrid, VoxelPaint};

/// Applies an edit of voxels; `false` if it is about something else.
pub(super) fn apply(edit: &Edit, frame: &mut Frame) -> Result<bool, EditError> {
    match edit {
        Edit::PaintVoxels { cells, class } => {
            check_voxels(frame.extent(), cells)?;
            for &[x, y, z] in cells {
                frame.painted.set(x, y, z, class.id());
                frame.occupancy.set(x, y, z, class.id());
            }
        }
        Edit::UnlockVoxels { cells } => {
            check_voxels(frame.extent(), cells)?;
            for &[x, y, z] in cells {
                frame.painted.set(x, y, z, NOT_PAINTED);
            }
        }
        Edit::ClearPaint {} => frame.painted = VoxelPaint::over(frame.extent()),
        _ => return Ok(false),
    }
    Ok(true)
}

/// Makes a generated occupancy the frame's own and its source. Painted voxels keep their label. Errors if it covers
/// another part of the ground than the frame.
pub(crate) fn adopt(frame: &mut Frame, mut occupancy: VoxelGrid) -> Result<(), EditError> {
    let (found, expected) = (occupancy.extent(), frame.extent());
    if found != expected {
        return Err(EditError::OtherExtent { found, expected });
    }
    for (x, y, z, class) in frame.painted.iter_set() {
        occupancy.set(x, y, z, class);
    }
    frame.occupancy = occupancy;
    frame.settle();
    Ok(())
}

fn check_voxels(extent: Extent, cells: &[[usize; 3]]) -> Result<(), EditError> {
    at_least("cells", cells.len(), 1)?;
    let outside = |c: &&[usize; 3]| !extent.holds(c[0], c[1]) || c[2] >= extent.nz();
    match cells.iter().find(outside) {
        Some(c) => Err(EditError::CellOutside {
            cell: c.to_vec(),
            extent,
        }),
        None => Ok(()),
    }
}
