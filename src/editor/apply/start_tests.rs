use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{
    BevLayer, BevLayout, Class, Extent, Frame, Polyline, PolylineKind, SceneBox, SensorRig, VoxelGrid,
};

use super::*;
use crate::apply::{Apply, apply_all};

fn body(id: u32, class: Class, at_m: [f64; 2], yaw_rad: f64, mps: f64) -> (BoxId, SceneBox) {
    let size_m = match class {
        Class::Pedestrian => DVec3::new(0.6, 0.6, 1.75),
        _ => DVec3::new(4.5, 1.9, 1.6),
    };
    let b = SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(at_m[0], at_m[1], size_m.z / 2.0),
        size_m,
        yaw_rad,
        velocity_mps: DVec2::from_angle(yaw_rad) * mps,
        label: Default::default(),
    };
    (BoxId(id), b)
}

/// A road of two lanes along x, ours at y = 0 and the next at 3.6; a wall along y = 9.
fn scene(boxes: &[(BoxId, SceneBox)]) -> Scene {
    let extent = Extent::new([-100, -100], [400, 200]).expect("sound");
    let mut layout = BevLayout::over(extent);
    let mut grid = VoxelGrid::over(extent);
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0);
        layout.set(BevLayer::DrivableArea, x, y, (-4.0..6.0).contains(&p.y));
        if (9.0..9.5).contains(&p.y) {
            (0..9).for_each(|z| grid.set(x, y, z, Class::Manmade.id()));
        }
    }
    let lane = |y: f64| Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: vec![DVec2::new(-40.0, y), DVec2::new(120.0, y)],
    };
    layout.polylines = Arc::new(vec![lane(0.0), lane(3.6)]);
    let frame = Frame::new(layout, boxes.iter().copied().collect(), grid);
    let mut scene = Scene::single("road", frame, Arc::new(SensorRig::default()), 1);
    let long = Edit::SetLength {
        length_s: 8.0,
        rate_hz: None,
    };
    long.apply(&mut scene).expect("sound");
    scene
}

fn stay(start: &TrafficStart) -> Vec<u32> {
    start.stays.keys().map(|id| id.0).collect()
}

#[test]
fn traffic_that_only_has_speeds_is_let_drive() {
    let mut scene = scene(&[
        body(1, Class::Car, [20.0, 0.0], 0.0, 10.0),
        body(2, Class::Car, [80.0, 0.0], 0.0, 0.0),
    ]);
    let start = traffic_drives(&scene).expect("sound");
    assert_eq!((start.edits.len(), start.starts, start.said()), (1, 1, None));
    apply_all(&start.edits, &mut scene).expect("sound edits");
    let x = |t: f64| scene.at(t).frame().boxes[&BoxId(1)].center_m.x;
    assert!(x(0.0) == 20.0 && (58.0..76.0).contains(&x(5.0)), "{}", x(5.0));
    assert_eq!(traffic_drives(&scene), Ok(TrafficStart::default()));
}

#[test]
fn what_would_come_into_something_stays_and_is_told() {
    let scene = scene(&[
        // Fine.
        body(1, Class::Car, [30.0, 0.0], 0.0, 8.0),
        // Into the wall.
        body(2, Class::Pedestrian, [10.0, 7.0], FRAC_PI_2, 1.5),
        // Across the road, and through whoever drives there or we.
        body(3, Class::Pedestrian, [-3.0, 8.0], -FRAC_PI_2, 1.0),
        body(4, Class::Car, [-30.0, 3.6], 0.0, 9.0),
        // Through the ego vehicle, which stands.
        body(5, Class::Pedestrian, [1.0, -4.0], FRAC_PI_2, 1.2),
        // Stands in a parked car from the beginning.
        body(6, Class::Car, [60.0, -3.0], 0.0, 5.0),
        body(7, Class::Car, [61.0, -3.4], 0.0, 0.0),
    ]);
    let before = collisions(&scene).len();
    assert_eq!(before, 0, "nothing moves");
    let start = traffic_drives(&scene).expect("sound");
    let staying = stay(&start);
    for id in [2, 5, 6] {
        assert!(staying.contains(&id), "{id} drives off: {staying:?}");
    }
    assert!(!staying.contains(&1) && !staying.contains(&7), "{staying:?}");
    // Of the two that meet, one goes.
    assert_eq!(
        [3, 4].iter().filter(|id| staying.contains(id)).count(),
        1,
        "{staying:?}"
    );
    let said = start.said().expect("some stay");
    assert!(
        said.starts_with("4 of 6 stay where they are") && said.contains("manmade") && !said.contains('\n'),
        "{said}"
    );
    let mut after = scene.clone();
    apply_all(&start.edits, &mut after).expect("sound edits");
    assert_eq!(after.clip().tracks.len(), 2);
    let met: Vec<String> = collisions(&after).into_iter().map(|m| m.text).collect();
    assert!(met.is_empty(), "{met:?}");
    // The edit that commands and calls use does the same, and says the same.
    let edit = [Edit::LetTrafficDrive {}];
    assert_eq!(remarks(&scene, &edit), [said]);
    let mut by_edit = scene.clone();
    apply_all(&edit, &mut by_edit).expect("sound");
    assert_eq!(by_edit.clip(), after.clip());
}

/// Without the look ahead the same scene is full of errors.
#[test]
fn everybody_driving_off_would_meet() {
    let scene = scene(&[
        body(2, Class::Pedestrian, [10.0, 7.0], FRAC_PI_2, 1.5),
        body(5, Class::Pedestrian, [1.0, -4.0], FRAC_PI_2, 1.2),
    ]);
    let mut all = goers(&scene, 0.0);
    all.retain(|g| g.id.is_some());
    let (_, later) = together(&scene, &all, &[], (0.0, 8.0)).expect("sound");
    let met = collisions(&later);
    assert_eq!(met.len(), 2);
    assert!(
        met.iter().any(|m| m.other == CollisionPartner::Ego),
        "the ego vehicle that stands is met"
    );
    assert!(
        met.iter()
            .any(|m| m.other == CollisionPartner::Wall(Class::Manmade))
    );
}

#[test]
fn a_moment_becomes_a_clip_and_a_scene_without_traffic_stays_one() {
    let mut moving = scene(&[body(1, Class::Car, [30.0, 0.0], 0.0, 8.0)]);
    moving.change_clip(|clip| clip.length_s = 0.0);
    let start = traffic_drives(&moving).expect("sound");
    apply_all(&start.edits, &mut moving).expect("sound");
    assert_eq!(moving.clip().length_s, USUAL_LENGTH_S);
    let x = moving.at(4.0).frame().boxes[&BoxId(1)].center_m.x;
    assert!((50.0..63.0).contains(&x), "{x}");
    let mut still = scene(&[body(1, Class::Car, [30.0, 0.0], 0.0, 0.0)]);
    still.change_clip(|clip| clip.length_s = 0.0);
    assert_eq!(traffic_drives(&still), Ok(TrafficStart::default()));
}
