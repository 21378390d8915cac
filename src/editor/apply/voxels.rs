//! Edits of voxels: paint, unlock, a generated result that is taken over.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use scene::grid::NOT_PAINTED;
use scene::raster::box_cells;
use scene::shape::at_least;
use scene::{BevLayout, BoxId, Edit, EditError, Extent, Frame, SceneBox, SourceFrame, VoxelGrid, VoxelPaint};

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
        Edit::AdoptResult { occupancy } => adopt(frame, occupancy.clone())?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Makes a generated occupancy the frame's own and its source. Painted voxels keep what was painted. It was generated
/// within the networks' window alone: what was authored beyond it stays as it was in the source, to be generated yet.
/// Refused if it covers another part of the ground than the frame.
pub(crate) fn adopt(frame: &mut Frame, mut occupancy: VoxelGrid) -> Result<(), EditError> {
    let (found, expected) = (occupancy.extent(), frame.extent());
    if found != expected {
        return Err(EditError::OtherExtent { found, expected });
    }
    for (x, y, z, class) in frame.painted.iter_set() {
        occupancy.set(x, y, z, class);
    }
    frame.occupancy = occupancy;
    let (layout, boxes) = match expected == Extent::WINDOW {
        true => (frame.layout.clone(), frame.boxes.clone()),
        false => settled_within(Extent::WINDOW, frame),
    };
    frame.source = Arc::new(SourceFrame {
        layout,
        boxes,
        occupancy: frame.occupancy.clone(),
    });
    Ok(())
}

/// Layout and boxes of a frame's source, with what was authored within an extent taken over.
fn settled_within(extent: Extent, frame: &Frame) -> (BevLayout, BTreeMap<BoxId, SceneBox>) {
    let mut layout = frame.source.layout.clone();
    layout.paste(&frame.layout.crop(extent));
    let mut boxes = frame.source.boxes.clone();
    let ids: BTreeSet<_> = boxes.keys().chain(frame.boxes.keys()).copied().collect();
    for id in ids {
        let states = [frame.source.boxes.get(&id), frame.boxes.get(&id)];
        if states[0] == states[1] || !is_settled(frame.extent(), extent, states) {
            continue;
        }
        match states[1] {
            Some(now) => boxes.insert(id, *now),
            None => boxes.remove(&id),
        };
    }
    (layout, boxes)
}

/// True if some state of a box stands within an extent, or none on the map: nothing is ever generated there.
fn is_settled(map: Extent, extent: Extent, states: [Option<&SceneBox>; 2]) -> bool {
    let (mut within, mut on_map) = (false, false);
    for b in states.into_iter().flatten() {
        box_cells(map, b, 0.0, |x, y| {
            let p = map.center(x, y, 0);
            on_map = true;
            within |= extent.column_at(p.x, p.y).is_some();
        });
    }
    within || !on_map
}

fn check_voxels(extent: Extent, cells: &[[usize; 3]]) -> Result<(), EditError> {
    at_least("cells", cells.len(), 1)?;
    let outside = |c: &&[usize; 3]| !extent.holds(c[0], c[1]) || c[2] >= Extent::NZ;
    match cells.iter().find(outside) {
        Some(c) => Err(EditError::CellOutside {
            cell: c.to_vec(),
            extent,
        }),
        None => Ok(()),
    }
}
