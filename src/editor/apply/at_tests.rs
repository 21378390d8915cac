use std::sync::Arc;

use glam::DVec3;
use scene::{BevLayout, Class, Frame, VoxelGrid};

use super::*;

/// 4 s at 10 Hz; car 7 drives along x at 5 m/s, car 8 stands.
fn clip() -> Scene {
    let frame = Frame::new(BevLayout::default(), Default::default(), VoxelGrid::new());
    let mut scene = Scene::single("clip", frame, Arc::default(), 1);
    for (id, y) in [(7, 0.0), (8, 10.0)] {
        apply_json(
            &format!(
                r#"{{"add_box": {{"class": "car", "center_m": [0, {y}, 0.8], "size_m": [4.5, 1.9, 1.6], "yaw_deg": 0, "id": {id}}}}}"#
            ),
            &mut scene,
        );
    }
    apply_json(
        r#"{"set_motion": {"id": 7, "motion": {"keys": [{"time_s": 0, "at_m": [0, 0], "yaw_deg": 0},
        {"time_s": 4, "at_m": [20, 0], "yaw_deg": 0}]}}}"#,
        &mut scene,
    );
    scene
}

fn json(text: &str) -> Edit {
    serde_json::from_str(text).expect("an edit")
}

fn apply_json(text: &str, scene: &mut Scene) {
    json(text).apply(scene).expect("sound");
}

fn held(scene: &Scene, id: u32) -> [bool; 5] {
    [0.0, 1.0, 2.0, 3.0, 4.0].map(|t| scene.at(t).frame().boxes.contains_key(&BoxId(id)))
}

#[test]
fn a_motion_lifts_a_box_with_its_voxels_and_none_sets_it_down() {
    let mut scene = clip();
    assert_eq!((scene.clip().length_s, scene.clip().frames()), (4.0, 41));
    assert!(!scene.canvas().boxes.contains_key(&BoxId(7)) && scene.canvas().boxes.contains_key(&BoxId(8)));
    let car = |s: &Scene| {
        let cars = s.frame().occupancy.iter_set().filter(|v| v.3 == Class::Car.id());
        cars.map(|v| v.0).max().unwrap_or(0)
    };
    // Its front is 20 m farther on at the end.
    assert_eq!(car(&scene.at(4.0)) - car(&scene), 50);
    let moving = scene.clip().tracks[&BoxId(7)].voxels.count();
    assert!(moving > 200, "{moving} voxels");
    scene.show(4.0);
    apply_json(r#"{"set_motion": {"id": 7}}"#, &mut scene);
    assert!(scene.clip().tracks.is_empty() && scene.canvas().boxes[&BoxId(7)].center_m.x == 20.0);
    assert_eq!(car(&scene.at(0.0)), car(&scene.at(4.0)));
}

#[test]
fn an_edit_applies_at_the_moment_it_names() {
    let mut scene = clip();
    apply_json(
        r#"{"at": {"time_s": 2, "scope": "from_here_on", "edit": {"remove_box": {"id": 7}}}}"#,
        &mut scene,
    );
    assert_eq!(held(&scene, 7), [true, true, false, false, false]);
    assert_eq!(scene.time_s(), 0.0, "the moment shown stays");
    apply_json(
        r#"{"at": {"frame": 10, "scope": "from_here_on", "edit": {"add_box": {"class": "truck",
        "center_m": [-20, 0, 1.5], "size_m": [8, 2.5, 3], "yaw_deg": 0, "id": 9}}}}"#,
        &mut scene,
    );
    assert_eq!(held(&scene, 9), [false, true, true, true, true]);
    // Without a scope it is there at all times.
    apply_json(
        r#"{"at": {"time_s": 3, "edit": {"add_box": {"class": "truck", "center_m": [-20, 9, 1.5],
        "size_m": [8, 2.5, 3], "yaw_deg": 0, "id": 10}}}}"#,
        &mut scene,
    );
    assert_eq!(held(&scene, 10), [true; 5]);
}

#[test]
fn an_edit_of_a_track_finds_a_moment_at_which_it_is_there() {
    let mut scene = clip();
    apply_json(
        r#"{"at": {"time_s": 2, "scope": "from_here_on", "edit": {"remove_box": {"id": 7}}}}"#,
        &mut scene,
    );
    scene.show(3.5);
    for edit in [
        r#"{"at": {"track": 7, "edit": {"set_box_class": {"id": 7, "class": "truck"}}}}"#,
        r#"{"at": {"track": 7, "edit": {"move_box": {"id": 7, "size_m": [8, 2.5, 3]}}}}"#,
    ] {
        apply_json(edit, &mut scene);
    }
    let b = scene.at(1.0).frame().boxes[&BoxId(7)];
    assert_eq!((b.class, b.size_m), (Class::Truck, DVec3::new(8.0, 2.5, 3.0)));
    assert!(!scene.clip().tracks[&BoxId(7)].settled, "its voxels are a draft");
    apply_json(
        r#"{"at": {"track": 7, "edit": {"remove_box": {"id": 7}}}}"#,
        &mut scene,
    );
    assert_eq!(held(&scene, 7), [false; 5]);
}

#[test]
fn moments_and_motions_that_cannot_be_are_refused_in_one_line() {
    let mut scene = clip();
    let before = scene.content();
    let remove = r#""edit": {"remove_box": {"id": 7}}"#;
    let keys = |list: &str| format!(r#"{{"set_motion": {{"id": 7, "motion": {{"keys": [{list}]}}}}}}"#);
    let key = |t: f64| format!(r#"{{"time_s": {t}, "at_m": [0, 0], "yaw_deg": 0}}"#);
    let at = |moment: &str| format!(r#"{{"at": {{{moment}}}}}"#);
    for (edit, says) in [
        (at(&format!(r#""frame": 41, {remove}"#)), "frame is 41, expected 0 to 40"),
        (at(&format!(r#""time_s": 9, {remove}"#)), "time_s is 9, expected 0 to 4"),
        (at(&format!(r#""track": 8, {remove}"#)), "the edit is of box 7, expected track 8"),
        (at(r#""track": 99, "edit": {"remove_box": {"id": 99}}"#), "box 99 does not exist"),
        (at(&format!(r#""track": 7, "frame": 1, {remove}"#)), "at most one of"),
        (at(remove), "one of frame, time_s, track and scope"),
        (at(r#""track": 7, "edit": {"clear_paint": {}}"#), "a track can be"),
        (at(&format!(r#""frame": 1, "edit": {{"at": {{"frame": 1, {remove}}}}}"#)), "once"),
        (keys(&format!("{}, {}", key(2.0), key(1.0))), "before the one before it"),
        (keys(&format!("{}, {}", key(1.0), key(1.0))), "at the same time"),
        (keys(""), "0 keyframes"),
        (keys(r#"{"time_s": 1, "at_m": [1e9, 0], "yaw_deg": 0}"#), "at most 10000 m"),
        (
            r#"{"set_motion": {"id": 7, "motion": {"path": {"points_m": [[0, 0]], "speeds": [{"time_s": 0, "mps": 1}]}}}}"#
                .to_owned(),
            "a path of 1 points",
        ),
        (r#"{"set_motion": {"id": 77, "motion": {"attached": {"to": 7, "at_m": [1, 0]}}}}"#.into(), "box 77 does not"),
        (r#"{"set_motion": {"id": 8, "motion": {"attached": {"to": 8, "at_m": [1, 0]}}}}"#.into(), "in a circle"),
        (r#"{"set_length": {"length_s": -1}}"#.into(), "a clip of -1 s"),
        (r#"{"set_length": {"length_s": 1e9}}"#.into(), "expected 0 to 600"),
    ] {
        let error = json(&edit).apply(&mut scene).expect_err(says).to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{error}");
        assert_eq!(scene.content(), before, "{says}");
    }
}
