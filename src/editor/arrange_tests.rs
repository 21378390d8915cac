//! Tests of what is done to several boxes.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use super::*;
use crate::Document;
use scene::{BevLayout, Class, Polyline, PolylineKind, Scene, VoxelGrid};

pub(crate) fn car(id: u32, x: f64, y: f64, yaw_rad: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.85),
        size_m: DVec3::new(4.6, 1.9, 1.7),
        yaw_rad,
        velocity_mps: DVec2::new(5.0, 1.0),
        label: Default::default(),
    }
}

pub(crate) fn frame(boxes: &[SceneBox]) -> Frame {
    let line = |points: &[[f64; 2]]| Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: points.iter().map(|p| DVec2::from_array(*p)).collect(),
    };
    let lines = vec![line(&[[-30.0, 2.0], [10.0, 2.0], [10.0, 30.0]])];
    let layout = BevLayout::from_cells(vec![0; 40_000], lines).expect("the right size");
    let boxes = boxes.iter().map(|b| (b.id, *b)).collect();
    Frame::new(layout, boxes, VoxelGrid::new())
}

pub(crate) fn after(frame: &Frame, edits: &[Edit]) -> Frame {
    let scene = Scene::single("test", frame.clone(), Arc::default(), 1);
    let mut document = Document::new(scene);
    document.apply_all("test", edits).expect("sound edits");
    assert_eq!(document.history().len(), 2, "one step");
    Frame::clone(document.scene().frame())
}

#[test]
fn another_speed_keeps_place_heading_and_voxels() {
    let mut b = car(1, 3.0, 2.0, 0.3);
    let mut frame = frame(&[b, car(2, 12.0, 2.0, 0.0)]);
    // Voxels that the networks drew, not those of a draft.
    let [x, y] = frame.extent().column_at(3.0, 2.0).expect("on the map");
    frame.occupancy.set(x, y, 9, Class::Car.id());
    frame.source = Arc::new(scene::SourceFrame {
        layout: frame.layout.clone(),
        boxes: frame.boxes.clone(),
        occupancy: frame.occupancy.clone(),
    });
    let still = Scene::single("test", frame.clone(), Arc::default(), 1);
    let edits = with_speed(&still, BoxId(1), 12.5).expect("it stands in the scene");
    let faster = after(&frame, &edits);
    b.velocity_mps = DVec2::new(5.0, 1.0).normalize() * 12.5;
    assert!(faster.boxes[&BoxId(1)].velocity_mps.distance(b.velocity_mps) < 1e-9);
    let now = SceneBox {
        velocity_mps: b.velocity_mps,
        ..faster.boxes[&BoxId(1)]
    };
    assert_eq!(now, b, "nothing else changes");
    assert_eq!(faster.occupancy, frame.occupancy);
    assert_eq!(faster.source.boxes, faster.boxes, "nothing is to be generated");
    // What stood goes where it looks.
    let stopped = after(&frame, &with_speed(&still, BoxId(2), 0.0).expect("it stands"));
    assert_eq!(stopped.boxes[&BoxId(2)].velocity_mps, DVec2::ZERO);
    let stopped = Scene::single("test", stopped, Arc::default(), 1);
    let again = after(
        stopped.frame(),
        &with_speed(&stopped, BoxId(2), 3.0).expect("it stands"),
    );
    assert_eq!(again.boxes[&BoxId(2)].velocity_mps, DVec2::new(3.0, 0.0));
}

#[test]
fn a_path_is_driven_as_much_faster_as_its_speed_now_is_and_keyframes_keep_theirs() {
    use scene::clip::{Path, Speed};
    let frame = frame(&[car(1, 0.0, 0.0, 0.0), car(2, 0.0, 9.0, 0.0)]);
    let speed = |time_s: f64, mps: f64| Speed { time_s, mps };
    let path = Path {
        points_m: vec![DVec2::ZERO, DVec2::new(30.0, 0.0)],
        start_m: 0.0,
        speeds: vec![speed(0.0, 4.0), speed(2.0, 2.0)],
        rear_first: false,
    };
    let key = |time_s: f64, x: f64| scene::Key {
        time_s,
        at_m: DVec2::new(x, 9.0),
        yaw_deg: 0.0,
    };
    let keys = Motion::Keys(vec![key(0.0, 0.0), key(2.0, 8.0)]);
    let mut document = Document::new(Scene::single("test", frame, Arc::default(), 1));
    for (id, motion) in [(1, Motion::Path(path)), (2, keys)] {
        let edit = Edit::SetMotion {
            id: Some(BoxId(id)),
            motion: Some(motion),
            from_s: None,
            to_s: Some(1.5),
        };
        document.apply("motion", &edit).expect("sound");
    }
    let edits = with_speed(document.scene(), BoxId(1), 10.0).expect("a path");
    assert_eq!(with_speed(document.scene(), BoxId(2), 10.0), None);
    assert_eq!(with_speed(document.scene(), BoxId(3), 10.0), None);
    document.apply_all("speed", &edits).expect("sound");
    let track = &document.scene().clip().tracks[&BoxId(1)];
    let Motion::Path(path) = &track.motion else {
        panic!("{:?}", track.motion);
    };
    assert_eq!(path.speeds, [speed(0.0, 10.0), speed(2.0, 5.0)]);
    assert_eq!(track.there_s, [None, Some(1.5)]);
}

#[test]
fn several_are_removed_shifted_and_turned_at_once() {
    let frame = frame(&[
        car(1, 0.0, 0.0, 0.0),
        car(2, 10.0, 4.0, 0.5),
        car(5, -20.0, 0.0, 0.0),
    ]);
    let ids = [BoxId(1), BoxId(2), BoxId(77)];
    let left = after(&frame, &remove(&frame, &ids));
    assert_eq!(left.boxes.keys().copied().collect::<Vec<_>>(), [BoxId(5)]);
    let moved = after(&frame, &shift(&frame, &ids, DVec3::new(1.0, -2.0, 0.5)));
    assert_eq!(moved.boxes[&BoxId(2)].center_m, DVec3::new(11.0, 2.0, 1.35));
    assert_eq!(moved.boxes[&BoxId(5)], frame.boxes[&BoxId(5)]);
    let own = after(&frame, &turn(&frame, &ids, 90.0, Pivot::Own));
    assert_eq!(own.boxes[&BoxId(1)].center_m, DVec3::new(0.0, 0.0, 0.85));
    let group = after(&frame, &turn(&frame, &ids, 90.0, Pivot::Middle));
    // About (5, 2): the first goes from (-5, -2) to (2, -5).
    let first = group.boxes[&BoxId(1)];
    assert!(
        first.center_m.distance(DVec3::new(7.0, -3.0, 0.85)) < 1e-9,
        "{first:?}"
    );
    assert!((first.yaw_rad - FRAC_PI_2).abs() < 1e-9);
    assert!(turn(&frame, &[BoxId(77)], 3.0, Pivot::Middle).is_empty());
}

#[test]
fn copies_get_free_names_and_a_place_of_their_own() {
    let mut top = car(u32::MAX, 0.0, 0.0, 0.0);
    top.velocity_mps = DVec2::ZERO;
    let frame = frame(&[car(1, 0.0, 0.0, 0.0), car(2, 0.0, 5.0, 0.0), top]);
    let added = duplicate(&frame, &[BoxId(1), BoxId(2)]);
    assert_eq!(added.ids, [BoxId(3), BoxId(4)]);
    let now = after(&frame, &added.edits);
    assert_eq!(
        now.boxes[&BoxId(3)].center_m,
        DVec3::new(0.0, 5.0 + 1.9 + 0.6, 0.85)
    );
    assert_eq!(now.boxes[&BoxId(4)].velocity_mps, DVec2::new(5.0, 1.0));
    let scene = Scene::single("t", frame.clone(), Arc::default(), 1);
    let clipboard = Clipboard::from_selection(&scene, &[BoxId(1), BoxId(2)]);
    let pasted = paste(&frame, &clipboard, Some(DVec2::new(10.0, 10.0)));
    let now = after(&frame, &pasted.edits);
    assert_eq!(now.boxes[&BoxId(3)].center_m, DVec3::new(10.0, 7.5, 0.85));
    assert_eq!(paste(&frame, &Clipboard::default(), None), Added::default());
    assert_eq!(paste(&frame, &clipboard, Some(DVec2::NAN)).ids.len(), 2);
}

#[test]
fn copies_move_and_are_grouped_as_what_they_are_copies_of() {
    let frame = frame(&[
        car(1, 0.0, 0.0, 0.0),
        car(2, 0.0, 5.0, 0.0),
        car(3, 0.0, 9.0, 0.0),
    ]);
    let mut document = Document::new(Scene::single("t", frame, Arc::default(), 1));
    let name = Default::default();
    let key = |time_s, x| scene::Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.0,
    };
    let edits = [
        Edit::SetLength {
            length_s: 4.0,
            rate_hz: None,
        },
        Edit::SetMotion {
            id: Some(BoxId(1)),
            motion: Some(Motion::Keys(vec![key(0.0, 0.0), key(4.0, 20.0)])),
            from_s: None,
            to_s: Some(3.0),
        },
        Edit::Arrange {
            boxes: vec![BoxId(1), BoxId(2), BoxId(3)],
            things: Vec::new(),
            how: Arrangement::Group { name },
        },
    ];
    document.apply_all("x", &edits).expect("sound");
    let scene = document.scene().clone();
    let ids = [BoxId(1), BoxId(2)];
    let added = duplicate(scene.frame(), &ids).with(&Ties::from_selection(&scene, &ids));
    document.apply_all("Duplicate", &added.edits).expect("sound");
    let scene = document.scene();
    let [old, new] = [BoxId(1), added.ids[0]].map(|id| {
        let track = &scene.clip().tracks[&id];
        assert_eq!(track.there_s, [None, Some(3.0)]);
        [0.0, 2.0].map(|t| scene.clip().moving(id, t).expect("there").at_m)
    });
    assert_eq!(new[1] - new[0], old[1] - old[0]);
    assert_ne!(new[0], old[0]);
    let groups = &scene.arranged.groups;
    assert_eq!(groups[1].members.boxes, added.ids.iter().copied().collect());
    assert_eq!(groups[0].members.boxes.len(), 3);
}

#[test]
fn mirrored_boxes_drive_with_the_other_side() {
    let frame = frame(&[car(1, 3.0, -4.0, 0.3), car(2, 8.0, 0.0, 0.3)]);
    let ids = [BoxId(1), BoxId(2)];
    let now = after(&frame, &mirror(&frame, &ids, true));
    let b = now.boxes[&BoxId(1)];
    assert_eq!(b.center_m, DVec3::new(3.0, 4.0, 0.85));
    assert!((b.yaw_rad - (PI - 0.3)).abs() < 1e-9);
    assert_eq!(b.velocity_mps, DVec2::new(-5.0, 1.0));
    // On the axis nothing changes sides.
    assert!((now.boxes[&BoxId(2)].yaw_rad + 0.3).abs() < 1e-9);
    let plain = after(&frame, &mirror(&frame, &ids, false));
    assert!((plain.boxes[&BoxId(1)].yaw_rad + 0.3).abs() < 1e-9);
    let copies = mirror_copy(&frame, &ids[..1], false);
    assert_eq!(after(&frame, &copies.edits).boxes.len(), 3);
}

#[test]
fn boxes_are_set_down_and_follow_their_lane() {
    let mut high = car(1, -5.0, 4.0, 2.0);
    high.center_m.z = 3.0;
    let frame = frame(&[high, car(2, -5.0, 20.0, 2.0)]);
    let ids = [BoxId(1), BoxId(2)];
    let down = after(&frame, &drop_to_ground(&frame, &ids));
    assert_eq!(down.boxes[&BoxId(1)].center_m, DVec3::new(-5.0, 4.0, 0.85));
    let lane = after(&frame, &to_lane(&frame, &ids));
    let b = lane.boxes[&BoxId(1)];
    assert_eq!((b.center_m, b.yaw_rad), (DVec3::new(-5.0, 2.0, 0.85), 0.0));
    assert_eq!(lane.boxes[&BoxId(2)], frame.boxes[&BoxId(2)], "too far from any");
}

#[test]
fn angles_stay_in_range() {
    for (from, to) in [(0.0, 0.0), (181.0, -179.0), (-190.0, 170.0), (720.5, 0.5)] {
        assert!((wrapped_deg(from) - to).abs() < 1e-9, "{from}");
    }
}
