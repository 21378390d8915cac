use glam::DVec3;
use scene::{BevLayer, BoxId, Class, SceneBox, SensorRig};

use super::*;
use crate::Apply;

/// A road that leaves the window at an angle, as cells and as a lane.
fn scene(slope: f64) -> Scene {
    let mut layout = BevLayout::default();
    for [x, y] in Extent::WINDOW.all_columns() {
        let p = Extent::WINDOW.center(x, y, 0);
        layout.set(BevLayer::DrivableArea, x, y, (p.y - slope * p.x).abs() < 4.0);
    }
    let at = |x: f64| DVec2::new(x, slope * x);
    layout.polylines = Arc::new(vec![Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: vec![at(-40.0), at(0.0), at(40.0)],
    }]);
    let car = SceneBox {
        id: BoxId(1),
        class: Class::Car,
        center_m: DVec3::new(10.0, slope * 10.0, 0.8),
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let occupancy = draft::draft(&layout, [car].iter());
    let frame = Frame::new(layout, [(BoxId(1), car)].into(), occupancy);
    Scene::single("test", frame, SensorRig::default().into(), 1)
}

fn extend(scene: &mut Scene, ahead_m: f64, right_m: f64) -> Result<(), EditError> {
    let edit = Edit::ExtendMap {
        ahead_m,
        behind_m: 0.0,
        left_m: 0.0,
        right_m,
    };
    edit.apply(scene)
}

#[test]
fn no_second_road_comes_of_one_that_leaves_to_the_side() {
    let mut scene = scene(0.9);
    extend(&mut scene, 100.0, 0.0).expect("a map");
    let (extent, layout) = (scene.canvas().extent(), &scene.canvas().layout);
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0);
        let off_m = (p.y - 0.9 * p.x).abs();
        assert!(
            off_m < 5.0 || layout.cell(x, y) & BevLayer::DrivableArea.bit() == 0,
            "{p}"
        );
    }
}

#[test]
fn a_road_goes_on_as_it_leaves_the_map() {
    for slope in [0.0, 0.3, -0.3] {
        let mut scene = scene(slope);
        let before = scene.canvas().clone();
        extend(&mut scene, 60.0, 20.0).expect("a map");
        let canvas = scene.canvas();
        let extent = canvas.extent();
        assert_eq!(
            (extent.from(), extent.nx(), extent.ny()),
            ([-100, -150], 350, 250)
        );
        for x_m in [45.0, 70.0, 99.0] {
            for (aside_m, road) in [
                (0.0, true),
                (2.5, true),
                (-2.5, true),
                (6.0, false),
                (-6.0, false),
            ] {
                let Some([x, y]) = extent.column_at(x_m, slope * x_m + aside_m) else {
                    continue;
                };
                let found = canvas.layout.has(BevLayer::DrivableArea, x, y);
                assert_eq!(found, road, "slope {slope}, {x_m} m, {aside_m} m aside");
            }
        }
        let lane = &canvas.layout.polylines[0].points_m;
        let end = lane[lane.len() - 1];
        assert!(end.x > 100.0 && (end.y - slope * end.x).abs() < 0.01, "{end}");
        // What was there is the same, and nothing of it waits to be generated.
        assert_eq!(canvas.layout.crop(Extent::WINDOW).cells(), before.layout.cells());
        assert_eq!(canvas.occupancy.crop(Extent::WINDOW), before.occupancy);
        assert_eq!(
            canvas.source.occupancy.crop(Extent::WINDOW),
            before.source.occupancy
        );
        let [x, y] = extent.column_at(80.0, slope * 80.0).expect("inside");
        assert_eq!(canvas.occupancy.get(x, y, 0), Class::DriveableSurface.id());
        assert_eq!(canvas.source.occupancy.get(x, y, 0), Class::FREE);
    }
}

#[test]
fn no_map_is_too_large_or_of_no_number() {
    let mut scene = scene(0.0);
    let before = scene.clone();
    for bad in [-1.0, f64::NAN, f64::INFINITY, 2001.0] {
        let error = extend(&mut scene, bad, 0.0).expect_err("no number").to_string();
        assert!(error.starts_with("ahead_m is "), "{error}");
    }
    for _ in 0..40 {
        if let Err(error) = extend(&mut scene, 2000.0, 0.0) {
            assert!(error.to_string().starts_with("a map of "), "{error}");
            assert!(!error.to_string().contains('\n'));
            let same = scene.canvas().extent();
            assert!(extend(&mut scene, 0.0, 0.0).is_ok());
            assert_eq!(scene.canvas().extent(), same);
            return;
        }
    }
    assert_ne!(scene.canvas().extent(), before.canvas().extent());
    panic!("a map without an end");
}
