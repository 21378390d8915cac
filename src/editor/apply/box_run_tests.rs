//! Long runs of edits of boxes: the same as one by one, in time that grows with their number only.

use crate::Apply;
use std::time::{Duration, Instant};

use glam::DVec3;

use super::*;
use scene::{BevLayout, BoxLabel, Class, SensorRig, VoxelGrid};

fn empty() -> Scene {
    let frame = Frame::new(BevLayout::default(), Default::default(), VoxelGrid::new());
    Scene::single("boxes", frame, SensorRig::default().into(), 1)
}

fn cone(i: usize) -> Edit {
    Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(
            (i % 199) as f64 * 0.4 - 39.0,
            (i / 199 % 199) as f64 * 0.4 - 39.0,
            0.4,
        ),
        size_m: DVec3::new(0.3, 0.3, 0.8),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: None,
        label: BoxLabel::default(),
    }
}

fn label(id: u32, i: usize) -> Edit {
    let paint = scene::Paint::ALL[i % scene::Paint::ALL.len()];
    Edit::LabelBox {
        id: BoxId(id),
        label: BoxLabel {
            paint: Some(paint),
            ..BoxLabel::default()
        },
    }
}

#[test]
fn a_hundred_thousand_edits_of_boxes_take_seconds() {
    let mut edits: Vec<Edit> = (0..Frame::MAX_BOXES).map(cone).collect();
    edits.extend((0..100_000 - Frame::MAX_BOXES).map(|i| label(1 + (i % Frame::MAX_BOXES) as u32, i)));
    let mut scene = empty();
    let start = Instant::now();
    crate::apply_all(&edits, &mut scene).expect("sound");
    let took = start.elapsed();
    assert_eq!(scene.frame().boxes.len(), Frame::MAX_BOXES);
    assert!(took < Duration::from_secs(20), "{took:?}");

    // More boxes than a frame holds are refused in one line, as soon as the first is too many.
    let edits: Vec<Edit> = (0..100_000).map(cone).collect();
    let mut scene = empty();
    let start = Instant::now();
    let error = crate::apply_all(&edits, &mut scene).expect_err("too many");
    assert!(start.elapsed() < Duration::from_secs(20));
    assert_eq!(
        error.to_string(),
        "this frame holds 20000 boxes already, expected at most 20000"
    );
}

#[test]
fn a_run_does_what_its_edits_do_one_by_one() {
    let mut edits: Vec<Edit> = (0..30).map(|i| cone(i * 37)).collect();
    edits.push(Edit::RemoveBox { id: BoxId(4) });
    edits.push(label(7, 3));
    edits.push(Edit::MoveBox {
        id: BoxId(9),
        center_m: Some(DVec3::new(3.0, 3.0, 0.4)),
        yaw_deg: Some(30.0),
        size_m: None,
    });
    edits.push(Edit::SetBoxClass {
        id: BoxId(9),
        class: Class::Barrier,
    });
    edits.push(cone(11));
    let one_by_one = |edits: &[Edit]| {
        let mut scene = empty();
        let ended = edits.iter().try_for_each(|e| e.apply(&mut scene));
        (scene, ended)
    };
    let (expected, _) = one_by_one(&edits);
    let mut scene = empty();
    crate::apply_all(&edits, &mut scene).expect("sound");
    assert!(scene.frame() == expected.frame());

    // An edit that is refused leaves those before it.
    edits.insert(20, Edit::RemoveBox { id: BoxId(900) });
    let (expected, ended) = one_by_one(&edits);
    let mut scene = empty();
    assert_eq!(crate::apply_all(&edits, &mut scene), ended);
    assert!(ended.is_err() && scene.frame() == expected.frame());
    assert_eq!(scene.frame().boxes.len(), 20);

    // What changes nothing keeps the revision.
    let rev = scene.rev;
    let same = Edit::MoveBox {
        id: BoxId(1),
        center_m: Some(scene.frame().boxes[&BoxId(1)].center_m),
        yaw_deg: None,
        size_m: None,
    };
    crate::apply_all(&[same.clone(), same], &mut scene).expect("sound");
    assert_eq!(scene.rev, rev);
}
