//! Edits that are refused: one line each, and nothing changes.

use super::*;

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
