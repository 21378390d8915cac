//! Frames from data sets: what is inferred is marked, can be corrected without a voxel changing, and confirmed.

use std::collections::BTreeSet;

use sceneloom::app::open;
use sceneloom::editor::{Document, Edit, Shape};
use sceneloom::formats::{occ3d, project};
use sceneloom::generation::dataset::occupancy_frame;
use sceneloom::generation::region::Region;
use sceneloom::scene::{BevLayer, Class, Scene};

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
    let scene = imported();
    let frame = scene.frame();
    assert!(frame.inferred.layout && frame.inferred.any());
    assert_eq!(
        frame.inferred.boxes,
        frame.boxes.keys().copied().collect::<BTreeSet<_>>()
    );
    assert!(frame.boxes.len() > 3, "{} boxes", frame.boxes.len());
    let bytes = project::to_bytes(&scene).expect("sound");
    let again = project::from_bytes(&bytes).expect("readable");
    assert_eq!(again.frame(), frame);
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
