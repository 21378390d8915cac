//! Tests of rows and grids of copies.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::*;
use crate::arrange::tests::{after, car, frame};
use scene::background::{Building, Post, PostKind, Tree, TreeKind};

#[test]
fn rows_run_along_headings_and_lanes() {
    let frame = frame(&[car(1, -4.0, 1.0, 0.0)]);
    let row_of = |along| {
        let row = super::row(
            &frame,
            &[BoxId(1)],
            &CopyRows {
                copies: 3,
                spacing_m: 6.0,
                along,
                ..CopyRows::default()
            },
        );
        let now = after(&frame, &row.edits);
        now.boxes.values().skip(1).copied().collect::<Vec<_>>()
    };
    let straight = row_of(RowAlong::Heading);
    assert_eq!(straight.len(), 3);
    assert_eq!(straight[2].center_m, DVec3::new(14.0, 1.0, 0.85));
    assert_eq!(row_of(RowAlong::Side)[0].center_m, DVec3::new(-4.0, 7.0, 0.85));
    // 14 m to the corner, then 4 m up; one metre right of the lane stays one metre right of it.
    let bent = row_of(RowAlong::Lane)[2];
    assert!(
        bent.center_m.distance(DVec3::new(11.0, 6.0, 0.85)) < 1e-9,
        "{bent:?}"
    );
    assert!((bent.yaw_rad - FRAC_PI_2).abs() < 1e-9);
    assert!(bent.velocity_mps.distance(DVec2::new(-1.0, 5.0)) < 1e-9);
    let many = CopyRows {
        copies: usize::MAX,
        spacing_m: 1e300,
        along: RowAlong::Lane,
        ..CopyRows::default()
    };
    assert!(super::row(&frame, &[BoxId(1)], &many).edits.is_empty());
    let nan = CopyRows {
        spacing_m: f64::NAN,
        ..many
    };
    assert!(super::row(&frame, &[BoxId(1)], &nan).edits.is_empty());
}

#[test]
fn rows_beside_each_other_make_a_grid() {
    let frame = frame(&[car(1, -4.0, -8.0, FRAC_PI_2)]);
    let grid = CopyRows {
        copies: 2,
        spacing_m: 6.0,
        rows: 3,
        apart_m: -2.5,
        along: RowAlong::Heading,
    };
    let mut found: Vec<_> = row_boxes(&frame, &[BoxId(1)], &grid)
        .iter()
        .map(|b| [b.center_m.x, b.center_m.y].map(|v| (v * 2.0).round() / 2.0))
        .collect();
    // It looks to the left; to the right of that is ahead.
    let mut wanted = Vec::new();
    for x in [-4.0, -1.5, 1.0] {
        wanted.extend([-8.0, -2.0, 4.0].map(|y| [x, y]));
    }
    wanted.remove(0);
    found.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
    wanted.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
    assert_eq!(found, wanted);
    assert_eq!(grid.asked(), 8);
    let huge = CopyRows {
        copies: usize::MAX,
        rows: usize::MAX,
        ..grid
    };
    assert_eq!(huge.asked(), MAX_COPIES);
}

#[test]
fn trees_stand_along_a_lane() {
    let scene = Scene::single("test", frame(&[]), Default::default(), 1);
    let tree = Form::Tree(Tree {
        position_m: DVec2::new(0.0, 8.0),
        height_m: 7.0,
        crown_radius_m: 2.0,
        kind: TreeKind::default(),
    });
    let row = CopyRows {
        copies: 3,
        spacing_m: 6.0,
        along: RowAlong::Lane,
        ..CopyRows::default()
    };
    let copies = row_forms(&scene, &[&tree], &row);
    let at: Vec<DVec2> = copies.iter().map(Form::middle_m).collect();
    // Six metres to the left of the lane, also behind the corner at x = 10.
    assert_eq!(at[0], DVec2::new(6.0, 8.0));
    assert!(at[2].distance(DVec2::new(4.0, 10.0)) < 1e-9, "{at:?}");
}

#[test]
fn things_are_mirrored_in_the_frame_of_the_ego_vehicle() {
    let mut frame = frame(&[]);
    let sign = Form::Post(Post::typical(PostKind::Sign, DVec2::new(12.0, 5.0), 0.5));
    let Form::Post(post) = mirrored_form(&frame, &sign, true) else {
        panic!("a sign stays one");
    };
    assert_eq!(post.position_m, DVec2::new(12.0, -5.0));
    assert!(
        (post.yaw_rad - (PI - 0.5)).abs() < 1e-9,
        "it faces those who drive there"
    );
    // The arm of a lamp still points over the road.
    let lamp = Form::Post(Post::typical(
        PostKind::StreetLight,
        DVec2::new(12.0, 5.0),
        -FRAC_PI_2,
    ));
    let Form::Post(post) = mirrored_form(&frame, &lamp, true) else {
        panic!("a lamp stays one");
    };
    assert!((post.yaw_rad - FRAC_PI_2).abs() < 1e-9);
    let house = Form::Building(Building::rectangle(
        DVec2::new(10.0, 10.0),
        DVec2::new(6.0, 3.0),
        DVec2::X,
        6.0,
    ));
    let turns = |form: &Form| {
        let points = form.points_m();
        (points[1] - points[0]).perp_dot(points[2] - points[1]).signum()
    };
    frame.world_from_ego.translation_m = DVec3::new(100.0, 4.0, 0.0);
    let other = mirrored_form(&frame, &house, false);
    assert_eq!(
        other.middle_m(),
        DVec2::new(10.0, -2.0),
        "the axis lies at y = 4 m"
    );
    assert_eq!(turns(&other), turns(&house));
    assert_eq!(mirrored_form(&frame, &other, false).middle_m(), house.middle_m());
}
