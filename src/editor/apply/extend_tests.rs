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

/// Lanes of templates and of road files reach a little beyond the map: they go on as well, and so does the network.
#[test]
fn what_ends_beyond_the_edge_goes_on_too() {
    for beyond_m in [0.0, 3.5, 60.0] {
        let mut scene = scene(0.3);
        let ends = |x: f64| DVec2::new(x, 0.3 * x);
        scene.change_canvas(|canvas| {
            let mut lines = canvas.layout.polylines.to_vec();
            // (a bend out there is not what the drawn road does)
            let far = ends(40.0 + beyond_m) + DVec2::new(0.0, 0.2 * beyond_m.min(1.0));
            lines[0].points_m = vec![ends(-40.0), ends(0.0), ends(40.0), far];
            if beyond_m == 0.0 {
                lines[0].points_m.pop();
            }
            let mut back = lines[0].clone();
            back.points_m.reverse();
            lines.push(back);
            canvas.layout.polylines = lines.into();
        });
        let mut net = RoadNetwork::default();
        let nodes = [ends(-40.0), ends(40.0 + beyond_m)].map(|p| net.add_node(p));
        let id = net.add_road(Road {
            id: scene::RoadId(0),
            ends: [nodes[1], nodes[0]],
            via_m: vec![ends(0.0)],
            offset_m: 0.0,
            left: Vec::new(),
            right: vec![scene::RoadLane::usual(scene::roads::LaneKind::Drive)],
            limit_kph: None,
            crossings: vec![scene::roads::RoadCrossing {
                at_m: 50.0,
                width_m: 3.0,
            }],
            stops: Vec::new(),
        });
        scene.roads = net.into();
        let at = |scene: &Scene| {
            let road = scene.roads.road(id).expect("there");
            let along = scene.roads.points_m(road);
            scene::road_map::at_along(&along, road.crossings[0].at_m)
        };
        let crossing = at(&scene);
        extend(&mut scene, 60.0, 0.0).expect("a map");
        for (line, last) in scene.canvas().layout.polylines.iter().zip([true, false]) {
            let points = &line.points_m;
            let end = if last { points[points.len() - 1] } else { points[0] };
            assert!(end.x > 100.0, "{beyond_m}: {points:?}");
            let off_m = points.iter().map(|p| (p.y - 0.3 * p.x).abs());
            assert!(off_m.fold(0.0, f64::max) < 0.6, "{beyond_m}: {points:?}");
        }
        let lane = crate::lanes::nearest_lane(&scene.canvas().layout, ends(90.0), 1.0);
        assert!(lane.is_some(), "a lane lies on the new road");
        let node = scene.roads.node(nodes[1]).expect("there").at_m;
        assert!(node.x > 100.0 && (node.y - 0.3 * node.x).abs() < 0.01, "{node}");
        assert!(
            at(&scene).distance(crossing) < 0.1,
            "{beyond_m}: the crossing stays"
        );
        assert_eq!(scene.roads.problem(), None);
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
