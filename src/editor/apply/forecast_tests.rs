use glam::DVec3;
use scene::{BevLayer, BevLayout, Extent, Frame, Polyline, PolylineKind, SceneBox, SensorRig, VoxelGrid};

use super::*;

fn car(id: u32, x: f64, mps: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, 0.0, 0.8),
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::new(mps, 0.0),
        label: Default::default(),
    }
}

/// A straight road; car 1 drives 20 m ahead of us, car 2 stands 60 m ahead of it.
fn scene() -> Scene {
    let extent = Extent::new([-100, -50], [350, 100]).expect("sound");
    let mut layout = BevLayout::over(extent);
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0);
        layout.set(BevLayer::DrivableArea, x, y, p.y.abs() < 4.0);
    }
    layout.polylines = std::sync::Arc::new(vec![Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: vec![DVec2::new(-40.0, 0.0), DVec2::new(100.0, 0.0)],
    }]);
    let boxes = [car(1, 20.0, 10.0), car(2, 80.0, 0.0)].map(|b| (b.id, b)).into();
    let frame = Frame::new(layout, boxes, VoxelGrid::over(extent));
    let rig = SensorRig {
        ego_speed_mps: 10.0,
        ..SensorRig::default()
    };
    Scene::single("test", frame, rig.into(), 1)
}

fn after(scene: &Scene, seconds: f64) -> Scene {
    let mut later = scene.clone();
    let found = forecast(scene, seconds).expect("it goes on");
    apply_all(&found.edits, &mut later).expect("sound edits");
    later
}

#[test]
fn what_moves_goes_on_and_stops_behind_what_stands() {
    let start = scene();
    let three = after(&start, 3.0);
    assert_eq!(three.clip().length_s, 3.0);
    let x = |scene: &Scene, id: u32, t: f64| scene.at(t).frame().boxes[&BoxId(id)].center_m.x;
    let ego = |scene: &Scene, t: f64| scene.at(t).frame().world_from_ego.translation_m.x;
    assert!((40.0..52.0).contains(&x(&three, 1, 3.0)), "{}", x(&three, 1, 3.0));
    assert_eq!(x(&three, 2, 3.0), 80.0);
    assert!(x(&three, 1, 3.0) - ego(&three, 3.0) > 8.0);
    // Once more, and again: it comes to a stop behind the one that stands, and what was is as it was.
    let six = after(&three, 3.0);
    let nine = after(&six, 6.0);
    for t in [0.0, 1.0, 2.5] {
        assert!((x(&three, 1, t) - x(&nine, 1, t)).abs() < 0.3, "at {t} s");
    }
    let end = x(&nine, 1, 12.0);
    assert!((60.0..76.0).contains(&end), "{end}");
    assert!(end - ego(&nine, 12.0) > 5.0);
}

#[test]
fn the_map_grows_to_where_we_come() {
    let mut free = scene();
    free.change_canvas(|c| c.boxes.remove(&BoxId(2)));
    let fast = after(&free, 10.0);
    assert_eq!(
        fast.canvas().extent().ny(),
        100,
        "nothing is missing to the sides"
    );
    let extent = fast.canvas().extent();
    assert!(extent.max_m().x > 100.0, "{extent:?}");
    let still = {
        let mut scene = scene();
        scene.change_canvas(|c| c.boxes.values_mut().for_each(|b| b.velocity_mps = DVec2::ZERO));
        std::sync::Arc::make_mut(&mut scene.rig).ego_speed_mps = 0.0;
        scene
    };
    let error = forecast(&still, 3.0).expect_err("nothing moves");
    assert!(error.starts_with("nothing moves"), "{error}");
    for bad in [0.0, -1.0, f64::NAN, 1e9] {
        let error = forecast(&scene(), bad).expect_err("no time");
        assert!(
            error.contains("s more after 0 s") && !error.contains('\n'),
            "{error}"
        );
    }
}

/// Who goes on through a wall or somebody who walks is told with the seconds that are added.
#[test]
fn what_goes_on_into_something_is_told() {
    let mut start = scene();
    start.change_canvas(|c| {
        c.boxes.remove(&BoxId(2));
        let [x, _] = c.extent().column_at(60.0, 0.0).expect("inside");
        for y in 0..c.extent().ny() {
            (0..9).for_each(|z| c.occupancy.set(x, y, z, Class::Manmade.id()));
        }
    });
    let found = forecast(&start, 6.0).expect("it goes on");
    let said = found.said().expect("a wall is ahead");
    assert!(
        said.contains("car 1 drives through manmade") && !said.contains('\n'),
        "{said}"
    );
    let edits = [Edit::Forecast { seconds: 6.0 }];
    assert_eq!(crate::remarks(&start, &edits), [said]);
    assert_eq!(forecast(&scene(), 3.0).expect("it goes on").said(), None);
}
