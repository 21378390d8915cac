//! What each template does, and gaps from bumper to bumper.

use std::sync::Arc;

use glam::DVec3;
use scene::{BevLayer, BevLayout, Extent, Frame, Polyline, PolylineKind, VoxelGrid};

use super::*;
use crate::Apply;

/// A road of two lanes along x: ours at y = 0, the one to the left at 3.6; a sidewalk beyond y = -4.
fn scene() -> Scene {
    let extent = Extent::new([-100, -100], [600, 200]).expect("sound");
    let mut layout = BevLayout::over(extent);
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0);
        layout.set(BevLayer::DrivableArea, x, y, (-4.0..6.0).contains(&p.y));
    }
    let lane = |y: f64| Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: vec![DVec2::new(-40.0, y), DVec2::new(200.0, y)],
    };
    layout.polylines = Arc::new(vec![lane(0.0), lane(3.6)]);
    let object = |id: u32, class, x: f64, y: f64, size: [f64; 3]| SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(x, y, size[2] / 2.0),
        size_m: size.into(),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let boxes = [
        object(1, Class::Car, -10.0, 3.6, [4.5, 1.9, 1.6]),
        object(2, Class::Car, 40.0, 0.0, [4.5, 1.9, 1.6]),
        object(3, Class::Pedestrian, 25.0, -6.0, [0.6, 0.6, 1.75]),
        object(4, Class::Bus, 20.0, -2.6, [11.0, 2.6, 3.2]),
    ];
    let frame = Frame::new(layout, boxes.map(|b| (b.id, b)).into(), VoxelGrid::over(extent));
    Scene::single("road", frame, Arc::new(SensorRig::default()), 1)
}

fn with(scene: &Scene, id: Option<u32>, template: Template, mps: f64) -> Scene {
    let mut scene = scene.clone();
    let wish = Wish {
        mps,
        ..Wish::usual(template, None)
    };
    for edit in motion_of(&scene, id.map(BoxId), &wish).expect("a motion") {
        edit.apply(&mut scene).expect("sound");
    }
    scene
}

fn at(scene: &Scene, id: u32, time_s: f64) -> SceneBox {
    scene.at(time_s).frame().boxes[&BoxId(id)]
}

#[test]
fn every_template_does_what_its_name_says() {
    let start = scene();
    let drives = with(&start, Some(1), Template::Drive, 10.0);
    assert_eq!(drives.clip().length_s, USUAL_LENGTH_S);
    assert!((at(&drives, 1, 4.0).center_m.truncate() - DVec2::new(30.0, 3.6)).length() < 1e-6);
    let stops = with(&start, Some(1), Template::Stop, 10.0);
    // 2 s at 10 m/s, then 5 s of braking: 20 + 25 m.
    assert!((at(&stops, 1, 8.0).center_m.x - 35.0).abs() < 1e-6);
    assert_eq!(at(&stops, 1, 7.9).velocity_mps, DVec2::ZERO);
    let cuts = with(&start, Some(1), Template::CutIn, 12.0);
    assert!((at(&cuts, 1, 2.0).center_m.y - 3.6).abs() < 1e-6 && at(&cuts, 1, 5.2).center_m.y.abs() < 1e-6);
    assert!(at(&cuts, 1, 3.5).yaw_rad < -0.05, "it steers to the right");
    let mut oncoming = start.clone();
    oncoming.change_canvas(|f| {
        f.boxes.get_mut(&BoxId(1)).expect("there").yaw_rad = std::f64::consts::PI;
    });
    let wish = Wish::usual(Template::CutIn, Some(Class::Car));
    let refused = motion_of(&oncoming, Some(BoxId(1)), &wish).expect_err("it comes towards us");
    assert!(refused.contains("goes our way"), "{refused}");
    let crosses = with(&start, Some(3), Template::Cross, 1.5);
    assert!((at(&crosses, 3, 2.0).center_m.y + 6.0).abs() < 1e-6);
    assert!((at(&crosses, 3, 4.0).center_m.y + 3.375).abs() < 1e-6);
    assert!((at(&crosses, 3, 4.0).yaw_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let pulls = with(&start, Some(4), Template::PullOut, 8.0);
    assert!((at(&pulls, 4, 2.0).center_m.truncate() - DVec2::new(20.0, -2.6)).length() < 1e-6);
    assert!(at(&pulls, 4, 8.0).center_m.y.abs() < 0.4 && at(&pulls, 4, 8.0).center_m.x > 40.0);
    let parks = with(&start, Some(2), Template::Park, 5.0);
    let parked = at(&parks, 2, 8.0);
    assert!(
        (-3.5..=-2.0).contains(&parked.center_m.y) && parked.velocity_mps == DVec2::ZERO,
        "{parked:?}"
    );
    let ego = with(&start, None, Template::Follow, 14.0);
    let x = |t: f64| ego.at(t).frame().world_from_ego.translation_m.x;
    // Car 2 stands 40 m ahead: the vehicle comes to a stop behind it.
    assert!(x(8.0) > 20.0 && x(8.0) < 40.0 - 2.25 - 2.04, "{}", x(8.0));
}

#[test]
fn a_follower_keeps_behind_one_who_stops() {
    let stops = with(&scene(), Some(2), Template::Stop, 8.0);
    let both = with(&stops, None, Template::Follow, 14.0);
    for i in 0..=80 {
        let view = both.at(f64::from(i) * 0.1);
        let gap = view.frame().boxes[&BoxId(2)].center_m.x - view.frame().world_from_ego.translation_m.x;
        assert!(gap > 4.5, "{gap} m at {} s", view.time_s());
    }
}

/// The free distance counts from the bumper of the ego vehicle, wherever on it its origin is.
#[test]
fn the_time_of_an_approach_is_found() {
    let drives = with(&scene(), None, Template::Drive, 10.0);
    let found = |rig: &SensorRig, id, gap_m| time_near(drives.clip(), drives.canvas(), rig, id, gap_m);
    let rig = SensorRig::default();
    // The rear of car 2 is at 37.75 m; our front is 10 m before it at 27.75 m.
    let front_m = rig.ego_center_m[0] + rig.ego_size_m[0] / 2.0;
    let wanted_s = (27.75 - front_m) / 10.0;
    let at_s = found(&rig, BoxId(2), 10.0).expect("they meet");
    assert!((at_s - wanted_s).abs() < 0.06, "{at_s} {wanted_s}");
    let mut long = rig.clone();
    long.ego_center_m[0] += 3.0;
    let sooner_s = found(&long, BoxId(2), 10.0).expect("they meet");
    assert!((at_s - sooner_s - 0.3).abs() < 0.06, "{sooner_s}");
    assert_eq!(found(&rig, BoxId(99), 10.0), None);
}

/// Somebody who drives 14 m/s, 35 m ahead of us, does not get away from who follows them, at whatever speed that was
/// asked to begin; a gap that is asked for is kept, from our front bumper on.
#[test]
fn who_follows_does_not_let_the_leader_go() {
    let mut start = scene();
    let long = Edit::SetLength {
        length_s: 16.0,
        rate_hz: None,
    };
    long.apply(&mut start).expect("sound");
    let leads = with(&start, Some(2), Template::Drive, 14.0);
    let gap = |scene: &Scene, t: f64| relations::gap_m(&ego_box(scene, t), &at(scene, 2, t));
    let before_m = gap(&leads, 0.0);
    for gap_m in [None, Some(12.0), Some(before_m)] {
        let mut both = leads.clone();
        let wish = Wish {
            mps: 10.0,
            gap_m,
            ..Wish::usual(Template::Follow, None)
        };
        for edit in motion_of(&leads, None, &wish).expect("it follows") {
            edit.apply(&mut both).expect("sound");
        }
        let worst_m = (0..=160)
            .map(|i| gap(&both, f64::from(i) * 0.1))
            .fold(0.0, f64::max);
        assert!(worst_m < before_m + 5.0, "{worst_m} m from {before_m}, {gap_m:?}");
        let last_m = gap(&both, 16.0);
        match gap_m {
            Some(asked_m) => assert!((last_m - asked_m).abs() < 0.5, "{last_m} m in place of {asked_m}"),
            None => assert!(last_m < before_m, "{last_m} m"),
        }
    }
    // Who walks cannot keep up with it, and that is said.
    let wish = Wish {
        mps: 2.0,
        ..Wish::usual(Template::Follow, Some(Class::Pedestrian))
    };
    let mut walker = leads.clone();
    walker.change_canvas(|f| {
        let b = f.boxes.get_mut(&BoxId(3)).expect("there");
        (b.center_m.x, b.center_m.y, b.yaw_rad) = (20.0, 0.0, 0.0);
    });
    let refused = motion_of(&walker, Some(BoxId(3)), &wish).expect_err("too slow");
    assert!(
        refused.contains("goes up to 50 km/h") && !refused.contains('\n'),
        "{refused}"
    );
    let nobody = Wish {
        gap_m: Some(5.0),
        ..Wish::usual(Template::Follow, None)
    };
    let mut alone = start;
    alone.change_canvas(|f| f.boxes.retain(|id, _| *id == BoxId(1)));
    let refused = motion_of(&alone, Some(BoxId(1)), &nobody).expect_err("nobody is ahead");
    assert!(refused.contains("nobody is ahead"), "{refused}");
}

#[test]
fn what_cannot_be_is_told_in_one_line() {
    let scene = scene();
    let wish = Wish::usual(Template::Drive, None);
    assert_eq!(
        motion_of(&scene, Some(BoxId(77)), &wish),
        Err("box 77 does not exist in this frame".to_owned())
    );
    for bad in [f64::NAN, -1.0, 1e9] {
        let wish = Wish { mps: bad, ..wish };
        let error = motion_of(&scene, None, &wish).expect_err("no speed");
        assert!(
            error.contains("at most 100 m/s") && !error.contains('\n'),
            "{error}"
        );
    }
}
