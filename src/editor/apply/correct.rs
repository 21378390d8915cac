//! Corrections of what an import inferred, and findings that the user lets stand.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;
use scene::{BoxId, Edit, EditError, Frame, Waiver};

use super::{apply_to, map};
use crate::checks::waive;
use crate::junction;

/// Applies a correction, a confirmation or a waiver; `false` if the edit is about something else.
pub(super) fn apply(edit: &Edit, frame: &mut Frame) -> Result<bool, EditError> {
    match edit {
        Edit::Correct { edit } => correct(frame, edit)?,
        Edit::ConfirmInferred {} => {
            frame.inferred.layout = false;
            frame.inferred.background = false;
            frame.inferred.boxes.clear();
        }
        Edit::Waive {
            check,
            box_id,
            where_m,
            reason,
        } => {
            let new = waive::checked(check, *box_id, *where_m, reason)?;
            let list = Arc::make_mut(&mut frame.waivers);
            list.retain(|w| !same_finding(w, check, *box_id, *where_m));
            if list.len() >= Frame::MAX_WAIVERS {
                return Err(EditError::TooManyWaivers(list.len()));
            }
            list.push(new);
        }
        Edit::Unwaive {
            check,
            box_id,
            where_m,
        } => Arc::make_mut(&mut frame.waivers).retain(|w| !same_finding(w, check, *box_id, *where_m)),
        _ => return Ok(false),
    }
    Ok(true)
}

/// True if the waiver is for that finding; a finding without a box must be at the same place, to the millimetre.
fn same_finding(w: &Waiver, check: &str, box_id: Option<BoxId>, where_m: DVec3) -> bool {
    &*w.check == check && w.box_id == box_id && (box_id.is_some() || w.where_m.distance(where_m) < 1e-3)
}

/// Applies a change of boxes or layers to the frame and to its source, and to no voxel.
fn correct(frame: &mut Frame, edit: &Edit) -> Result<(), EditError> {
    let before = frame.clone();
    apply_to(edit, frame)?;
    frame.occupancy = before.occupancy;
    let source = Arc::make_mut(&mut frame.source);
    match edit {
        Edit::AddBox { .. } | Edit::RemoveBox { .. } | Edit::MoveBox { .. } | Edit::SetBoxClass { .. } => {
            let ids: BTreeSet<_> = before.boxes.keys().chain(frame.boxes.keys()).collect();
            for id in ids {
                if before.boxes.get(id) == frame.boxes.get(id) {
                    continue;
                }
                // The source would take over this box's pending edit together with the correction, and the edit would
                // never be generated.
                if before.boxes.get(id) != source.boxes.get(id) {
                    return Err(EditError::Unsettled(format!("box {}", id.0)));
                }
                let corrected = frame.boxes.get(id).copied();
                match corrected {
                    Some(b) => source.boxes.insert(*id, b),
                    None => source.boxes.remove(id),
                };
                Arc::make_mut(&mut frame.inferred.recorded).correct(*id, corrected);
            }
        }
        Edit::PaintBev { layer, shape, value } => {
            let mut cells = shape.cells(source.layout.extent())?;
            match value {
                true => map::replace_ground(&mut source.layout, *layer, &cells),
                false => junction::cut_lines(&mut source.layout, *layer, &cells),
            }
            cells.retain(|[x, y]| before.layout.has(*layer, *x, *y) != *value);
            for [x, y] in cells {
                if source.layout.has(*layer, x, y) == *value {
                    return Err(EditError::Unsettled(format!("column ({x}, {y})")));
                }
                source.layout.set(*layer, x, y, *value);
            }
        }
        Edit::AddPolylines { lines } => map::add_lines(&mut source.layout, lines),
        _ => return Err(EditError::NoCorrection),
    }
    Ok(())
}
