//! What a motion does wrong, each with its time.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::clip::{Path, Speed};
use scene::{BevLayout, Frame, Key, Scene, SensorRig, VoxelGrid};

use super::*;
use crate::Apply;
use crate::Edit;
use crate::checks::run_checks;

/// Cars 1 (moving as given) and 2 (standing 30 m ahead), a wall 50 m ahead.
fn found(motion: Motion, ego: bool) -> BTreeMap<&'static str, (String, f64)> {
    found_of(Class::Car, motion, ego)
}

/// The same with things of another class.
fn found_of(class: Class, motion: Motion, ego: bool) -> BTreeMap<&'static str, (String, f64)> {
    let extent = Extent::new([-50, -50], [300, 100]).expect("sound");
    let car = |id: u32, x: f64| SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(x, 0.0, 0.8),
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let mut grid = VoxelGrid::over(extent);
    let [x, _] = extent.column_at(50.0, 0.0).expect("inside");
    (0..100).for_each(|y| (0..9).for_each(|z| grid.set(x, y, z, Class::Manmade.id())));
    let boxes = [car(1, 0.0), car(2, 30.0)].map(|b| (b.id, b));
    let mut frame = Frame::new(BevLayout::over(extent), boxes.into(), grid);
    // Where nothing of this comes.
    frame.world_from_ego = scene::Pose::planar(-15.0, -15.0, 0.0);
    let mut scene = Scene::single("clip", frame, Arc::new(SensorRig::default()), 1);
    let set = Edit::SetMotion {
        id: (!ego).then_some(BoxId(1)),
        motion: Some(motion),
        from_s: None,
        to_s: None,
    };
    set.apply(&mut scene).expect("sound");
    let of_time = |f: Finding| f.time_s.map(|t| (f.check, (f.text, t)));
    run_checks(&scene, None).into_iter().filter_map(of_time).collect()
}

fn path(to: [f64; 2], speeds: &[(f64, f64)], rear_first: bool) -> Motion {
    Motion::Path(Path {
        points_m: vec![DVec2::ZERO, to.into()],
        start_m: 0.0,
        speeds: speeds
            .iter()
            .map(|&(time_s, mps)| Speed { time_s, mps })
            .collect(),
        rear_first,
    })
}

/// A pedestrian drove through a wall.
#[test]
fn only_what_has_an_engine_drives() {
    for (class, verb) in [
        (Class::Car, "drives"),
        (Class::Truck, "drives"),
        (Class::Pedestrian, "walks"),
        (Class::Bicycle, "moves"),
        (Class::Motorcycle, "moves"),
        (Class::TrafficCone, "moves"),
    ] {
        let fast = path([90.0, 0.0], &[(0.0, 90.0), (0.5, 90.0)], false);
        let back = path([-15.0, 4.0], &[(0.0, 2.0), (5.0, 2.0)], true);
        let ahead = path([90.0, 0.0], &[(0.0, 10.0), (8.0, 10.0)], false);
        let texts = [fast, back, ahead].map(|motion| found_of(class, motion, false));
        let texts: Vec<String> = texts.into_iter().flatten().map(|(_, (text, _))| text).collect();
        let says = |part: &str| texts.iter().any(|text| text.contains(part));
        assert!(says(&format!("{verb} through manmade")), "{texts:?}");
        assert!(says("324 km/h"), "{texts:?}");
        let drives = texts.iter().any(|text| text.contains("drives"));
        assert_eq!(drives, verb == "drives", "{texts:?}");
    }
}

#[test]
fn what_a_motion_does_wrong_is_found_with_its_time() {
    // Gently, past the standing car.
    let fine = found(path([0.0, 15.0], &[(0.0, 0.0), (3.0, 5.0)], false), false);
    assert_eq!(fine, BTreeMap::new());
    let ahead = found(path([90.0, 0.0], &[(0.0, 10.0), (8.0, 10.0)], false), false);
    let (text, time_s) = &ahead[COLLISION];
    assert!(
        text.contains("car 1 and car 2 meet at 2.6 s") && (2.5..2.7).contains(time_s),
        "{text}"
    );
    assert!(
        ahead[THROUGH_WALL].0.contains("drives through manmade at 4.9 s"),
        "{:?}",
        ahead[THROUGH_WALL]
    );
    let fast = found(path([90.0, 0.0], &[(0.0, 90.0), (0.5, 90.0)], false), false);
    assert!(fast[TOO_FAST].0.contains("324 km/h"), "{fast:?}");
    let sudden = found(
        path(
            [20.0, 12.0],
            &[(0.0, 20.0), (0.5, 20.0), (0.7, 0.0), (2.0, 0.0)],
            false,
        ),
        false,
    );
    assert!(
        sudden[TOO_SUDDEN].0.contains("car 1 changes its speed by"),
        "{sudden:?}"
    );
    let back = found(path([-15.0, 4.0], &[(0.0, 2.0), (5.0, 2.0)], true), false);
    assert!(back[BACKWARDS].0.contains("backwards from 0.0 s on"), "{back:?}");
    let key = |time_s: f64, x: f64| Key {
        time_s,
        at_m: DVec2::new(x, 12.0),
        yaw_deg: 0.0,
    };
    let off = found(Motion::Keys(vec![key(0.0, 0.0), key(6.0, -60.0)]), true);
    assert!(
        off[LEAVES_MAP].0.contains("the ego vehicle leaves the map at"),
        "{off:?}"
    );
}

/// Who drives through the ego vehicle is found, although it has no motion of its own.
#[test]
fn an_ego_vehicle_that_stands_is_met() {
    let through = path([-15.0, -15.0], &[(0.0, 4.0), (8.0, 4.0)], false);
    let (text, time_s) = &found(through, false)[COLLISION];
    assert!(
        text.contains("car 1 and the ego vehicle meet") && *time_s > 3.0,
        "{text}"
    );
}
