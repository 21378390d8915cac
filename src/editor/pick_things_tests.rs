//! Tests of picking things.

use std::collections::BTreeMap;

use super::*;
use scene::background::{Building, LineKind, Post, PostKind, SceneryLine, Tree, TreeKind};
use scene::{BevLayout, Extent, VoxelGrid};

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn background() -> (Background, [ThingId; 4]) {
    let mut all = Background::default();
    let house = all.add(Form::Building(Building::rectangle(
        v(20.0, 10.0),
        v(6.0, 4.0),
        DVec2::X,
        9.0,
    )));
    let tree = all.add(Form::Tree(Tree {
        position_m: v(24.0, 12.0),
        height_m: 6.0,
        crown_radius_m: 2.0,
        kind: TreeKind::Broadleaf,
    }));
    let hedge = all.add(Form::Line(SceneryLine::typical(
        LineKind::Hedge,
        vec![v(0.0, 5.0), v(10.0, 5.0)],
    )));
    let post = all.add(Form::Post(Post {
        kind: PostKind::Pole,
        position_m: v(5.0, 5.2),
        yaw_rad: 0.0,
        height_m: 6.0,
    }));
    (all, [house, tree, hedge, post])
}

#[test]
fn the_smallest_footprint_under_the_pointer_is_taken() {
    let (all, [house, tree, hedge, post]) = background();
    let at = |x, y| thing_at(&all, v(x, y), 0.5);
    assert_eq!(at(16.0, 10.0), Some(house));
    assert_eq!(
        at(24.0, 12.5),
        Some(tree),
        "in front of the house that it leans over"
    );
    assert_eq!(at(1.0, 5.2), Some(hedge));
    assert_eq!(at(5.0, 5.3), Some(post), "on the hedge");
    assert_eq!(at(10.6, 5.0), Some(hedge), "within reach");
    assert_eq!(at(12.0, 5.0), None);
    assert_eq!(at(f64::NAN, 5.0), None);
    assert_eq!(things_in(&all, |p| p.x > 10.0), [house, tree]);
}

#[test]
fn voxels_lead_to_their_thing() {
    let (all, [house, tree, _, post]) = background();
    let mut frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
    let mut voxel = |x: f64, y: f64, z: usize, class: Class| {
        let [cx, cy] = Extent::WINDOW.column_at(x, y).expect("inside");
        frame.occupancy.set(cx, cy, z, class.id());
        thing_of_voxel(&frame, &all, [cx, cy, z])
    };
    assert_eq!(
        voxel(16.0, 10.0, 5, Class::Manmade),
        Some(house),
        "world (16, 10)"
    );
    assert_eq!(
        voxel(24.0, 12.0, 8, Class::Vegetation),
        Some(tree),
        "world (24, 12)"
    );
    assert_eq!(
        voxel(24.0, 12.0, 3, Class::Manmade),
        Some(house),
        "the wall below"
    );
    assert_eq!(
        voxel(4.8, 5.0, 5, Class::Manmade),
        Some(post),
        "world (4.8, 5): not the hedge, which is no masonry"
    );
    assert_eq!(voxel(1.8000000000000007, 5.0, 5, Class::Manmade), None);
    assert_eq!(voxel(24.0, 12.0, 9, Class::Car), None);
}

#[test]
fn corners_are_taken_hold_of_and_moved() {
    let (all, [house, tree, ..]) = background();
    let form = |id| &all.get(id).expect("there").form;
    assert_eq!(corner_at(form(house), v(26.2, 14.0), 0.5), Some(2));
    assert_eq!(corner_at(form(house), v(20.0, 10.0), 0.5), None);
    assert_eq!(corner_at(form(tree), v(24.0, 12.0), 0.5), None);
    let moved = with_corner(form(house), 2, v(28.0, 15.0));
    assert_eq!(moved.points_m()[2], v(28.0, 15.0));
    assert_eq!(moved.points_m()[1], form(house).points_m()[1]);
    assert_eq!(distance_m(&moved, v(28.0, 16.0)), 1.0);
}
