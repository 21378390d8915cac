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
        (moved(Some(good * 1e6)), "expected within 10000 m"),
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
        assert_eq!(scene.canvas(), before.canvas());
    }
}

/// What an edit costs follows its size: all that it does not touch stays the very memory it was.
#[test]
fn an_edit_copies_only_what_it_touches() {
    let scene = street();
    let before = scene.frame();
    let after = |edit: Edit| {
        let mut scene = scene.clone();
        edit.apply(&mut scene).expect("sound");
        scene.frame().clone()
    };
    let removed = after(Edit::RemoveBox { id: BoxId(1) });
    let bricks = removed.occupancy.changed_bricks(&before.occupancy).len();
    assert!((1..=4).contains(&bricks), "a car lies in {bricks} bricks");
    assert!(removed.layout.shares_cells(&before.layout));
    assert!(Arc::ptr_eq(&removed.source, &before.source));
    let painted = after(Edit::PaintVoxels {
        cells: vec![[100, 100, 9]],
        class: Class::Manmade,
    });
    assert_eq!(painted.occupancy.changed_bricks(&before.occupancy).len(), 1);
    let prompt = after(Edit::SetPrompt {
        prompt: "night".into(),
    });
    assert!(prompt.occupancy.changed_bricks(&before.occupancy).is_empty());
    assert!(prompt.layout.shares_cells(&before.layout));
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
