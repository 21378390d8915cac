//! Edits of another moment than the one that is shown, and their effect on the other moments of a moving object.

use scene::{BoxId, Edit, EditError, Frame, Key, Motion, Scene, Scope};

use super::{Apply, apply_to, motion};

/// Applies [`Edit::At`] at the moment it names, and any other edit at the one that is shown. On error nothing has changed.
pub(super) fn apply(edit: &Edit, scene: &mut Scene) -> Result<(), EditError> {
    let Edit::At {
        frame,
        time_s,
        track,
        scope,
        edit,
    } = edit
    else {
        return edit.apply(scene);
    };
    if matches!(**edit, Edit::At { .. }) {
        return Err(EditError::BadMoment("an edit names its moment once".into()));
    }
    if frame.is_none() && time_s.is_none() && track.is_none() && scope.is_none() {
        return Err(EditError::BadMoment(
            "at needs one of frame, time_s, track and scope".into(),
        ));
    }
    let moment_s = moment(scene, (*frame, *time_s, *track), edit)?;
    let scope = scope.unwrap_or_default();
    let mut next = scene.clone();
    next.show(moment_s);
    let shown = next.content();
    match scope {
        Scope::WholeTrack => edit.apply(&mut next)?,
        scope => apply_scoped(edit, &mut next, scope)?,
    }
    if next.content() == shown {
        return Ok(()); // nothing was changed
    }
    next.show(scene.time_s());
    *scene = next;
    Ok(())
}

/// Applies an edit of the frame that is shown. An edit that changes nothing keeps the revision.
pub(super) fn apply_scoped(edit: &Edit, scene: &mut Scene, scope: Scope) -> Result<(), EditError> {
    // A frame is a few hundred pointers; working on a copy makes "all or nothing" certain.
    let mut frame = Frame::clone(scene.frame());
    apply_to(edit, &mut frame)?;
    if frame == **scene.frame() {
        return Ok(());
    }
    let new = match (edit, scope) {
        // An object that appears from here on is a track that stands still.
        (Edit::AddBox { .. }, Scope::FromHereOn) => frame
            .boxes
            .values()
            .find(|b| !scene.frame().boxes.contains_key(&b.id))
            .copied(),
        _ => None,
    };
    let mut next = scene.clone();
    next.set_frame(frame, scope);
    if let Some(b) = new {
        let key = Key {
            time_s: 0.0,
            at_m: b.center_m.truncate(),
            yaw_deg: b.yaw_rad.to_degrees(),
        };
        let from_s = Some(scene.time_s());
        motion::set(
            &mut next,
            Some(b.id),
            Some(&Motion::Keys(vec![key])),
            [from_s, None],
        )?;
    }
    *scene = next;
    Ok(())
}

type Moment = (Option<usize>, Option<f64>, Option<BoxId>);

/// The time that the edit names, s; the one that is shown if it names none.
fn moment(scene: &Scene, moment: Moment, edit: &Edit) -> Result<f64, EditError> {
    let clip = scene.clip();
    match moment {
        (None, None, None) => Ok(scene.time_s()),
        (Some(index), None, None) if index < clip.frames() => Ok(clip.time_of(index)),
        (Some(index), None, None) => Err(EditError::BadMoment(format!(
            "frame is {index}, expected 0 to {}",
            clip.frames() - 1
        ))),
        // Written so that NaN fails too.
        (None, Some(time_s), None) if (0.0..=clip.length_s).contains(&time_s) => Ok(time_s),
        (None, Some(time_s), None) => Err(EditError::BadMoment(format!(
            "time_s is {time_s}, expected 0 to {}",
            clip.length_s
        ))),
        (None, None, Some(track)) => of_track(scene, track, edit),
        _ => Err(EditError::BadMoment(
            "at needs at most one of frame, time_s and track".into(),
        )),
    }
}

/// The moment nearest to the one that is shown at which a track's box is there, s.
fn of_track(scene: &Scene, track: BoxId, edit: &Edit) -> Result<f64, EditError> {
    let id = match edit {
        Edit::RemoveBox { id }
        | Edit::LabelBox { id, .. }
        | Edit::SetBoxClass { id, .. }
        | Edit::MoveBox { id, .. } => *id,
        _ => {
            return Err(EditError::BadMoment(
                "a track can be removed, moved, labelled, given a class or a size".into(),
            ));
        }
    };
    if id != track {
        return Err(EditError::BadMoment(format!(
            "the edit is of box {}, expected track {}",
            id.0, track.0
        )));
    }
    if scene.frame().boxes.contains_key(&track) {
        return Ok(scene.time_s());
    }
    let clip = scene.clip();
    let from_here_s = |i: &usize| (clip.time_of(*i) - scene.time_s()).abs();
    let there = (0..clip.frames()).filter(|i| clip.moving(track, clip.time_of(*i)).is_some());
    there
        .min_by(|a, b| from_here_s(a).total_cmp(&from_here_s(b)))
        .map(|i| clip.time_of(i))
        .ok_or(EditError::UnknownBox { id: track })
}

#[cfg(test)]
#[path = "at_tests.rs"]
mod tests;
