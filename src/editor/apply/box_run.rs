//! A run of edits of boxes. It copies and compares the frame once for all of them, not once for each.

use super::{apply_to, boxes};
use scene::{BoxId, Edit, EditError, Frame, Scene, SceneBox, Scope};

/// Applies edits of boxes in order and stops at the first error. The edits before it stay applied.
pub(super) fn apply(run: &[Edit], scene: &mut Scene) -> Result<(), EditError> {
    let mut frame = Frame::clone(scene.frame());
    let mut changed = false;
    let mut done = 0;
    while let Some(edit) = run.get(done) {
        // The speed of a moving object belongs to its motion.
        let stands = touched_id(edit).is_some_and(|id| !scene.clip().tracks.contains_key(&id));
        let next = run.get(done + 1).filter(|_| stands);
        if next.is_some_and(|next| boxes::respeed(edit, next, &mut frame)) {
            (changed, done) = (true, done + 2);
            continue;
        }
        let before = touched(edit, &frame);
        if let Err(error) = apply_to(edit, &mut frame) {
            // The copy may be half changed: the edits before this one are applied again, to a new copy.
            apply(&run[..done], scene)?;
            return Err(error);
        }
        changed |= before.is_none_or(|before| touched(edit, &frame) != Some(before));
        done += 1;
    }
    if changed {
        scene.set_frame(frame, Scope::default());
    }
    Ok(())
}

/// The box that an edit may change, in the frame and in its source; none for a new one.
fn touched(edit: &Edit, frame: &Frame) -> Option<[Option<SceneBox>; 2]> {
    let of = |id: BoxId| [&frame.boxes, &frame.source.boxes].map(|boxes| boxes.get(&id).copied());
    touched_id(edit).map(of)
}

/// The number of the box that is there and that an edit may change.
fn touched_id(edit: &Edit) -> Option<BoxId> {
    match edit {
        Edit::RemoveBox { id }
        | Edit::MoveBox { id, .. }
        | Edit::LabelBox { id, .. }
        | Edit::SetBoxClass { id, .. } => Some(*id),
        _ => None,
    }
}

#[cfg(test)]
#[path = "box_run_tests.rs"]
mod tests;
