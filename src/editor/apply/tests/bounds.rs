//! Edits that change nothing, that are refused, that are large.

use super::*;
use scene::{Conditions, TimeOfDay, Weather};

#[test]
fn what_changes_nothing_keeps_the_revision() {
    let mut scene = street();
    let rev = scene.rev;
    let nothing = [
        Edit::SetPrompt { prompt: "".into() },
        Edit::ClearPaint {},
        Edit::SetConditions {
            conditions: scene.conditions,
        },
        Edit::SetBoxClass {
            id: BoxId(1),
            class: Class::Car,
        },
        Edit::MoveBox {
            id: BoxId(1),
            center_m: Some(scene.frame().boxes[&BoxId(1)].center_m),
            yaw_deg: Some(0.0),
            size_m: None,
        },
        Edit::PaintBev {
            layer: BevLayer::DrivableArea,
            shape: Shape::Cells(vec![cell(0.0, 0.0)]),
            value: true,
        },
    ];
    for edit in nothing {
        edit.apply(&mut scene).expect("sound");
        assert_eq!(scene.rev, rev, "{edit:?}");
    }
    Edit::SetPrompt { prompt: "fog".into() }
        .apply(&mut scene)
        .expect("sound");
    assert_ne!(scene.rev, rev);
}

#[test]
fn errors_are_one_line_and_change_nothing() {
    let mut scene = street();
    let before = scene.clone();
    let good = DVec3::new(1.0, 1.0, 1.0);
    let add = |class, center_m, size_m, yaw_deg, id| Edit::AddBox {
        class,
        center_m,
        size_m,
        yaw_deg,
        velocity_mps: None,
        id,
        label: Default::default(),
    };
    let nan = DVec3::new(f64::NAN, 0.0, 0.0);
    let moved = |center_m| Edit::MoveBox {
        id: BoxId(1),
        center_m,
        yaw_deg: None,
        size_m: None,
    };
    let cells = |cells, class| Edit::PaintVoxels { cells, class };
    let cases = [
        (
            Edit::RemoveBox { id: BoxId(9) },
            "box 9 does not exist in this frame",
        ),
        (
            Edit::SetBoxClass {
                id: BoxId(9),
                class: Class::Car,
            },
            "box 9 does not exist",
        ),
        (
            Edit::SetBoxClass {
                id: BoxId(1),
                class: Class::Terrain,
            },
            "class is \"terrain\"",
        ),
        (
            add(Class::Car, good, good, 0.0, Some(BoxId(1))),
            "box 1 exists already",
        ),
        (
            add(Class::Vegetation, good, good, 0.0, None),
            "class is \"vegetation\"",
        ),
        (
            add(Class::Car, nan, good, 0.0, None),
            "center_m is [NaN, 0.0, 0.0], expected finite numbers",
        ),
        (
            add(Class::Car, good, good, f64::INFINITY, None),
            "yaw_rad is [inf]",
        ),
        (add(Class::Car, good, -good, 0.0, None), "expected above 0"),
        (moved(None), "at least one of"),
        (moved(Some(nan)), "center_m is [NaN"),
        (moved(Some(good * 1e6)), "expected within 1000 m"),
        (
            cells(vec![], Class::Car),
            "cells holds 0 entries, expected at least 1",
        ),
        (
            cells(vec![[1, 1, 1], [1, 2, 16]], Class::Car),
            "cell [1, 2, 16] is outside the grid",
        ),
        (
            Edit::UnlockVoxels {
                cells: vec![[200, 0, 0]],
            },
            "cell [200, 0, 0] is outside",
        ),
        (
            Edit::PaintBev {
                layer: BevLayer::Car,
                shape: Shape::Cells(vec![[1, 1]]),
                value: true,
            },
            "layer \"car\" shows boxes",
        ),
        (
            Edit::PaintBev {
                layer: BevLayer::Walkway,
                shape: Shape::Cells(vec![[1, 1], [1, 200]]),
                value: true,
            },
            "cell [1, 200] is outside",
        ),
    ];
    for (edit, expected) in cases {
        let text = edit.apply(&mut scene).expect_err("refused").to_string();
        assert!(
            text.contains(expected) && !text.contains('\n'),
            "{edit:?}: {text}"
        );
        assert_eq!(scene.rev, before.rev);
        assert_eq!(scene.frames, before.frames);
    }
}

#[test]
fn the_largest_edits_are_quick() {
    let scene = street();
    let everything = Edit::PaintBev {
        layer: BevLayer::DrivableArea,
        shape: Shape::Rect {
            min_m: DVec2::splat(-50.0),
            max_m: DVec2::splat(50.0),
        },
        value: true,
    };
    let best = |edit: &Edit| {
        let tries = (0..10).map(|_| {
            let mut scene = scene.clone();
            let start = std::time::Instant::now();
            edit.apply(&mut scene).expect("sound");
            start.elapsed()
        });
        tries.min().expect("ten tries")
    };
    let (paint, remove) = (best(&everything), best(&Edit::RemoveBox { id: BoxId(1) }));
    println!("paint 40,000 cells: {paint:?}, remove a car: {remove:?}");
    assert!(paint.as_millis() < 16 && remove.as_millis() < 4);
}

#[test]
fn conditions_are_set_whole_or_not_at_all() {
    let mut scene = street();
    let (rev, before) = (scene.rev, scene.conditions);
    let bad = Conditions {
        wetness: 2.0,
        ..before
    };
    let error = Edit::SetConditions { conditions: bad }
        .apply(&mut scene)
        .expect_err("refused");
    assert_eq!(error.to_string(), "wetness is 2, expected 0 to 1");
    assert_eq!((scene.rev, scene.conditions), (rev, before));
    let night = before.at(TimeOfDay::Night).under(Weather::Snow);
    let edit = Edit::SetConditions { conditions: night };
    let frame = scene.frame().clone();
    edit.apply(&mut scene).expect("sound");
    assert_eq!(scene.conditions, night);
    assert!(
        scene.rev != rev && Arc::ptr_eq(&frame, scene.frame()),
        "no voxel changes"
    );
}
