//! Edits of boxes, and their voxels at once.

use std::sync::Arc;

use scene::{BoxId, BoxName, Edit, EditError, Frame, SceneBox};

use crate::immediate::{self, CarriedVoxels};

/// Applies an edit of one box; `false` if it is about something else.
pub(super) fn apply(edit: &Edit, frame: &mut Frame) -> Result<bool, EditError> {
    match edit {
        Edit::RemoveBox { id } => {
            let old = take_box(frame, *id)?;
            immediate::clear_box(frame, &old);
        }
        Edit::AddBox {
            class,
            center_m,
            size_m,
            yaw_deg,
            velocity_mps,
            id,
            label,
        } => {
            if frame.boxes.len() >= Frame::MAX_BOXES {
                return Err(EditError::TooManyBoxes(frame.boxes.len()));
            }
            let id = match *id {
                Some(id) => id,
                None => next_id(frame)?,
            };
            if frame.is_taken(id) {
                return Err(EditError::DuplicateBox { id });
            }
            let new = SceneBox {
                id,
                class: *class,
                center_m: *center_m,
                size_m: *size_m,
                yaw_rad: yaw_deg.to_radians(),
                velocity_mps: velocity_mps.unwrap_or_default(),
                label: *label,
            };
            put_box(frame, new)?;
        }
        Edit::MoveBox {
            id,
            center_m,
            yaw_deg,
            size_m,
        } => {
            if center_m.is_none() && yaw_deg.is_none() && size_m.is_none() {
                return Err(EditError::NothingToMove);
            }
            change_box(frame, *id, |b| {
                b.center_m = center_m.unwrap_or(b.center_m);
                b.size_m = size_m.unwrap_or(b.size_m);
                b.yaw_rad = yaw_deg.map_or(b.yaw_rad, f64::to_radians);
            })?;
        }
        Edit::LabelBox { id, label } => {
            let b = frame.boxes.get_mut(id).ok_or(EditError::UnknownBox { id: *id })?;
            b.label = *label;
            // The source gets it too: a label needs no generation.
            if frame.source.boxes.get(id).is_some_and(|b| b.label != *label)
                && let Some(b) = Arc::make_mut(&mut frame.source).boxes.get_mut(id)
            {
                b.label = *label;
            }
        }
        Edit::SetBoxClass { id, class } => change_box(frame, *id, |b| {
            if b.class != *class {
                b.label.name = BoxName::default();
            }
            b.class = *class;
        })?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Gives a box another velocity where two edits in a row take it out and put the same one in with that; false where they do
/// anything else. Its voxels stay, and the source gets it too: a speed needs no generation.
pub(super) fn respeed(taken: &Edit, put: &Edit, frame: &mut Frame) -> bool {
    let Edit::RemoveBox { id } = taken else {
        return false;
    };
    let Edit::AddBox {
        class,
        center_m,
        size_m,
        yaw_deg,
        velocity_mps,
        id: Some(again),
        label,
    } = put
    else {
        return false;
    };
    let velocity_mps = velocity_mps.unwrap_or_default();
    let is_it = |b: &&mut SceneBox| {
        // Degrees are not exact radians.
        let turned = (b.yaw_rad - yaw_deg.to_radians()).abs();
        (b.class, b.center_m, b.size_m, b.label) == (*class, *center_m, *size_m, *label) && turned < 1e-9
    };
    let Some(b) = frame.boxes.get_mut(id).filter(is_it) else {
        return false;
    };
    let new = SceneBox { velocity_mps, ..*b };
    if id != again || new.problem().is_some() {
        return false;
    }
    let old = std::mem::replace(b, new);
    if frame.source.boxes.get(id) == Some(&old) {
        Arc::make_mut(&mut frame.source).boxes.insert(*id, new);
    }
    true
}

fn next_id(frame: &Frame) -> Result<BoxId, EditError> {
    if frame.is_taken(BoxId(u32::MAX)) {
        // No id above the highest is left: take the lowest free one.
        let free = (1..=u32::MAX).map(BoxId).find(|id| !frame.is_taken(*id));
        return free.ok_or(EditError::NoIdLeft);
    }
    Ok(frame.next_box_id())
}

fn take_box(frame: &mut Frame, id: BoxId) -> Result<SceneBox, EditError> {
    frame.inferred.boxes.remove(&id);
    frame.boxes.remove(&id).ok_or(EditError::UnknownBox { id })
}

fn put_box(frame: &mut Frame, new: SceneBox) -> Result<(), EditError> {
    check(&new)?;
    frame.boxes.insert(new.id, new);
    immediate::stamp_box(frame, &new);
    Ok(())
}

fn check(b: &SceneBox) -> Result<(), EditError> {
    b.problem()
        .map_or(Ok(()), |problem| Err(EditError::BadBox(problem)))
}

fn change_box(frame: &mut Frame, id: BoxId, change: impl FnOnce(&mut SceneBox)) -> Result<(), EditError> {
    let old = *frame.boxes.get(&id).ok_or(EditError::UnknownBox { id })?;
    let mut new = old;
    change(&mut new);
    if new == old {
        return Ok(());
    }
    // On an error this copy of the frame may be half changed; the scene keeps the old frame.
    take_box(frame, id)?;
    let carried = CarriedVoxels::cut(frame, &old, &new);
    immediate::clear_box(frame, &old);
    let Some(voxels) = carried else {
        return put_box(frame, new);
    };
    check(&new)?;
    frame.boxes.insert(id, new);
    voxels.stamp(frame, &new);
    Ok(())
}
