//! Frames from data sets: what is inferred is marked, can be corrected without a voxel changing, and confirmed.

use std::collections::BTreeSet;

use app::open;
use dataset::occupancy_frame;
use editor::{Document, Edit, Shape};
use formats::{loom, occ3d};
use job::region::Region;
use scene::{BevLayer, BoxId, Class, Scene, Unobserved, Window};

/// Simulated labels, imported from a file as a user would.
fn imported() -> Scene {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("labels.npz");
    let labels = occupancy_frame(3, 1, |_| None).labels;
    std::fs::write(&path, occ3d::to_bytes(&labels)).expect("written");
    open::labels(&path).expect("an Occ3D frame")
}

#[test]
fn an_imported_frame_is_marked_and_survives_saving() {
    let mut scene = imported();
    let mut words = vec![0u64; Window::COLUMNS];
    words[..700].fill(0xa001);
    scene.change_canvas(|f| f.inferred.unobserved = Unobserved::from_words(scene::Extent::WINDOW, words));
    let frame = scene.frame();
    assert!(frame.inferred.layout && frame.inferred.any());
    assert_eq!(
        frame.inferred.boxes,
        frame.boxes.keys().copied().collect::<BTreeSet<_>>()
    );
    assert!(frame.boxes.len() > 3, "{} boxes", frame.boxes.len());
    assert!(frame.inferred.background && scene.background.len() > 10);
    let bytes = loom::to_bytes(&scene).expect("sound");
    let again = loom::from_bytes(&bytes).expect("readable");
    assert_eq!(again.frame(), frame);
    assert_eq!(again.background, scene.background);

    // A guess about no box is refused.
    scene.change_canvas(|f| f.inferred.boxes.insert(BoxId(9_999)));
    let bytes = loom::to_bytes(&scene).expect("written as it is");
    let error = loom::from_bytes(&bytes).expect_err("no such box").to_string();
    assert!(error.contains("box 9999 is marked as inferred"), "{error}");
}

#[test]
fn a_pending_edit_is_not_swallowed_by_a_correction() {
    let mut document = Document::new(imported());
    let id = *document.scene().frame().boxes.keys().next().expect("a box");
    let shift = Edit::MoveBox {
        id,
        center_m: Some(document.scene().frame().boxes[&id].center_m + glam::DVec3::X),
        yaw_deg: None,
        size_m: None,
    };
    document.apply("Move", &shift).expect("sound");
    let before = document.scene().frame().clone();
    let text = format!(
        r#"{{"correct": {{"edit": {{"set_box_class": {{"id": {}, "class": "bus"}}}}}}}}"#,
        id.0
    );
    let correct: Edit = serde_json::from_str(&text).expect("the form of the command line");
    let error = document
        .apply("Correct", &correct)
        .expect_err("unsettled")
        .to_string();
    assert!(
        error.contains("not generated yet") && error.lines().count() == 1,
        "{error}"
    );
    assert_eq!(**document.scene().frame(), *before);
    let confirm: Edit =
        serde_json::from_str(r#"{"confirm_inferred": {}}"#).expect("the form of the command line");
    document.apply("Confirm", &confirm).expect("sound");
    // Undo brings back frame and source alike.
    while document.undo().is_some() {}
    let frame = document.scene().frame();
    assert_eq!(
        (&frame.boxes, &frame.layout),
        (&frame.source.boxes, &frame.source.layout)
    );
}

#[test]
fn corrections_change_no_voxel_and_leave_nothing_to_generate() {
    let scene = imported();
    let before = scene.frame().clone();
    let (car, other) = {
        let mut cars = before.boxes.values().filter(|b| b.class == Class::Car);
        (*cars.next().expect("a car"), *cars.next().expect("another"))
    };
    let correct = |edit| Edit::Correct { edit: Box::new(edit) };
    let mut document = Document::new(scene);
    for edit in [
        correct(Edit::SetBoxClass {
            id: car.id,
            class: Class::Truck,
        }),
        correct(Edit::MoveBox {
            id: car.id,
            center_m: None,
            yaw_deg: Some(car.yaw_rad.to_degrees() + 180.0),
            size_m: Some(car.size_m * 1.1),
        }),
        correct(Edit::RemoveBox { id: other.id }),
        correct(Edit::PaintBev {
            layer: BevLayer::DrivableArea,
            shape: Shape::Disc {
                center_m: glam::DVec2::new(5.0, 12.0),
                radius_m: 3.0,
            },
            value: true,
        }),
    ] {
        document.apply("Correct", &edit).expect("sound");
    }
    let after = document.scene().frame().clone();
    assert_eq!(after.occupancy, before.occupancy);
    assert_eq!(after.boxes[&car.id].class, Class::Truck);
    assert_eq!(
        (&after.boxes, &after.layout),
        (&after.source.boxes, &after.source.layout)
    );
    assert!(after.layout != before.layout && !after.boxes.contains_key(&other.id));
    assert!(Region::of_edit(&after, 2).is_empty());
    // What was corrected is no guess any more; the rest still is.
    assert_eq!(after.inferred.boxes.len(), before.inferred.boxes.len() - 2);

    // Other edits are no corrections, and leave the scene as it was.
    let voxels = correct(Edit::PaintVoxels {
        cells: vec![[1, 2, 3]],
        class: Class::Car,
    });
    let error = document
        .apply("Correct", &voxels)
        .expect_err("voxels are not inferred");
    assert_eq!(error.to_string(), "only boxes and map layers can be corrected");
    assert_eq!(**document.scene().frame(), *after);

    // An ordinary edit of a guessed box makes it the user's; confirming takes all marks away.
    let third = *after.inferred.boxes.first().expect("a guess");
    document
        .apply("Remove", &Edit::RemoveBox { id: third })
        .expect("sound");
    assert!(!document.scene().frame().inferred.boxes.contains(&third));
    document
        .apply("Confirm", &Edit::ConfirmInferred {})
        .expect("sound");
    assert!(!document.scene().frame().inferred.any());
    document.undo();
    assert!(document.scene().frame().inferred.any());
}
