//! Edits of a named moment of a clip, or of a whole track.

use scene::{BoxId, Edit, EditError, Scene};

use super::Apply;

/// Applies [`Edit::At`] to the frames it names, and any other edit to the current frame. On error nothing has changed.
pub(super) fn apply(edit: &Edit, scene: &mut Scene) -> Result<(), EditError> {
    let Edit::At {
        frame,
        time_s,
        track,
        edit,
    } = edit
    else {
        return edit.apply(scene);
    };
    if matches!(**edit, Edit::At { .. }) {
        return Err(EditError::BadMoment("an edit names its moment once".into()));
    }
    let mut next = scene.clone();
    for index in frames(scene, (*frame, *time_s, *track), edit)? {
        next.current = index;
        edit.apply(&mut next)?;
    }
    next.current = scene.current;
    *scene = next;
    Ok(())
}

type Moment = (Option<usize>, Option<f64>, Option<BoxId>);

/// Indices of the frames that the edit names.
fn frames(scene: &Scene, moment: Moment, edit: &Edit) -> Result<Vec<usize>, EditError> {
    match moment {
        (Some(index), None, None) if index < scene.frames.len() => Ok(vec![index]),
        (Some(index), None, None) => Err(EditError::BadMoment(format!(
            "frame is {index}, expected 0 to {}",
            scene.frames.len() - 1
        ))),
        (None, Some(time_s), None) => at_time(scene, time_s).map(|index| vec![index]),
        (None, None, Some(track)) => of_track(scene, track, edit),
        _ => Err(EditError::BadMoment(
            "at needs exactly one of frame, time_s and track".into(),
        )),
    }
}

/// The frame nearest to a time, s; the earlier of two.
fn at_time(scene: &Scene, time_s: f64) -> Result<usize, EditError> {
    let (first, last) = (
        scene.frames[0].time_s,
        scene.frames[scene.frames.len() - 1].time_s,
    );
    // Written so that NaN fails too.
    if !(time_s >= first && time_s <= last) {
        return Err(EditError::BadMoment(format!(
            "time_s is {time_s}, expected {first} to {last}"
        )));
    }
    let gap_s = |i: &usize| (scene.frames[*i].time_s - time_s).abs();
    let nearest = (0..scene.frames.len()).min_by(|a, b| gap_s(a).total_cmp(&gap_s(b)));
    Ok(nearest.unwrap_or(scene.current))
}

/// The frames that hold a track's box. Errors for edits that cannot be applied to several frames alike.
fn of_track(scene: &Scene, track: BoxId, edit: &Edit) -> Result<Vec<usize>, EditError> {
    let id = match edit {
        Edit::RemoveBox { id } | Edit::LabelBox { id, .. } | Edit::SetBoxClass { id, .. } => *id,
        Edit::MoveBox {
            id,
            center_m: None,
            yaw_deg: None,
            ..
        } => *id,
        _ => {
            return Err(EditError::BadMoment(
                "a whole track can be removed, labelled, given a class or a size".into(),
            ));
        }
    };
    if id != track {
        return Err(EditError::BadMoment(format!(
            "the edit is of box {}, expected track {}",
            id.0, track.0
        )));
    }
    let holds = |i: &usize| scene.frames[*i].boxes.contains_key(&track);
    let found: Vec<usize> = (0..scene.frames.len()).filter(holds).collect();
    match found.is_empty() {
        true => Err(EditError::UnknownBox { id: track }),
        false => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use scene::{BevLayout, Class, Frame, VoxelGrid};

    use super::*;

    /// Three frames, 0.5 s apart; car 7 is in the last two.
    fn clip() -> Scene {
        let frame = Frame::new(BevLayout::default(), Default::default(), VoxelGrid::new());
        let mut scene = Scene::single("clip", frame.clone(), Arc::default(), 1);
        scene.frames = (0..3)
            .map(|i| {
                Arc::new(Frame {
                    time_s: f64::from(i) * 0.5,
                    ..frame.clone()
                })
            })
            .collect();
        for index in [1, 2] {
            at(
                json(&format!(
                    r#"{{"at": {{"frame": {index}, "edit": {{"add_box": {{"class": "car", "center_m": [{index}0, 0, 0.8],
                    "size_m": [4.5, 1.9, 1.6], "yaw_deg": 0, "id": 7}}}}}}}}"#
                )),
                &mut scene,
            );
        }
        scene
    }

    fn json(text: &str) -> Edit {
        serde_json::from_str(text).expect("an edit")
    }

    fn at(edit: Edit, scene: &mut Scene) {
        edit.apply(scene).expect("sound");
    }

    fn held(scene: &Scene) -> Vec<bool> {
        scene
            .frames
            .iter()
            .map(|f| f.boxes.contains_key(&BoxId(7)))
            .collect()
    }

    #[test]
    fn an_edit_changes_the_frame_it_names_and_no_other() {
        let mut scene = clip();
        assert_eq!((held(&scene), scene.current), (vec![false, true, true], 0));
        assert!(scene.frames[1].occupancy.count_set() > 0 && scene.frames[0].occupancy.count_set() == 0);
        let (before, third) = (scene.rev, scene.frames[2].clone());
        at(
            json(r#"{"at": {"time_s": 0.6, "edit": {"remove_box": {"id": 7}}}}"#),
            &mut scene,
        );
        assert_eq!(held(&scene), [false, false, true]);
        assert!(scene.rev != before && Arc::ptr_eq(&third, &scene.frames[2]));
    }

    #[test]
    fn an_edit_of_a_track_changes_every_frame_that_holds_it() {
        let mut scene = clip();
        at(
            json(r#"{"at": {"track": 7, "edit": {"set_box_class": {"id": 7, "class": "truck"}}}}"#),
            &mut scene,
        );
        at(
            json(r#"{"at": {"track": 7, "edit": {"move_box": {"id": 7, "size_m": [8, 2.5, 3]}}}}"#),
            &mut scene,
        );
        for frame in &scene.frames[1..] {
            let b = frame.boxes[&BoxId(7)];
            assert_eq!((b.class, b.size_m), (Class::Truck, DVec3::new(8.0, 2.5, 3.0)));
        }
        at(
            json(r#"{"at": {"track": 7, "edit": {"remove_box": {"id": 7}}}}"#),
            &mut scene,
        );
        assert_eq!(held(&scene), [false; 3]);
    }

    #[test]
    fn moments_that_are_not_there_are_refused_in_one_line() {
        let mut scene = clip();
        let before = scene.rev;
        let remove = r#""edit": {"remove_box": {"id": 7}}"#;
        for (moment, says) in [
            (format!(r#""frame": 3, {remove}"#), "frame is 3, expected 0 to 2"),
            (
                format!(r#""time_s": 9, {remove}"#),
                "time_s is 9, expected 0 to 1",
            ),
            (
                format!(r#""track": 8, {remove}"#),
                "the edit is of box 7, expected track 8",
            ),
            (
                r#""track": 9, "edit": {"remove_box": {"id": 9}}"#.into(),
                "box 9 does not exist",
            ),
            (format!(r#""track": 7, "frame": 1, {remove}"#), "exactly one of"),
            (remove.to_owned(), "exactly one of"),
            (
                r#""track": 7, "edit": {"clear_paint": {}}"#.into(),
                "a whole track can be",
            ),
            (
                format!(r#""frame": 1, "edit": {{"at": {{"frame": 1, {remove}}}}}"#),
                "once",
            ),
        ] {
            let error = json(&format!(r#"{{"at": {{{moment}}}}}"#))
                .apply(&mut scene)
                .expect_err(says)
                .to_string();
            assert!(error.contains(says) && !error.contains('\n'), "{error}");
        }
        assert_eq!(scene.rev, before);
    }
}
