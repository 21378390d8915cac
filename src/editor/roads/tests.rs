use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::*;
use crate::{Apply, Edit, Shape};
use scene::roads::{LaneKind, NodeKind, RoadLane, curve};
use scene::{BevLayer, BevLayout, Extent, Frame, PolylineKind, Road, RoadId, VoxelGrid, Window};

fn empty() -> Scene {
    let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
    Scene::single("roads", frame, Arc::default(), 1)
}

fn lanes(kinds: &[LaneKind]) -> Vec<RoadLane> {
    kinds.iter().copied().map(RoadLane::usual).collect()
}

fn add(scene: &mut Scene, points: &[[f64; 2]], left: &[LaneKind], right: &[LaneKind]) {
    let change = RoadChange::Add {
        points_m: points.iter().map(|p| DVec2::from_array(*p)).collect(),
        left: lanes(left),
        right: lanes(right),
        limit_kph: None,
    };
    Edit::ChangeRoads { change }.apply(scene).expect("sound");
}

const STREET: [LaneKind; 2] = [LaneKind::Drive, LaneKind::Walk];

/// A street along x and one along y.
fn crossing() -> Scene {
    let mut scene = empty();
    add(&mut scene, &[[-45.0, 1.0], [45.0, 1.0]], &STREET, &STREET);
    add(&mut scene, &[[2.0, -45.0], [2.0, 45.0]], &STREET, &STREET);
    scene
}

fn kinds(scene: &Scene, kind: PolylineKind) -> usize {
    let lines = &scene.canvas().layout.polylines;
    lines.iter().filter(|l| l.kind == kind).count()
}

/// Share of the columns with a layer in either that have it in both.
fn iou(a: &BevLayout, b: &BevLayout, layer: BevLayer) -> f64 {
    let (mut both, mut any) = (0, 0);
    for [x, y] in a.extent().all_columns() {
        let (a, b) = (a.has(layer, x, y), b.has(layer, x, y));
        both += usize::from(a && b);
        any += usize::from(a || b);
    }
    f64::from(both as u32) / f64::from(any.max(1) as u32)
}

#[test]
fn a_street_has_its_lanes_and_is_drawn_once() {
    let mut scene = empty();
    let right = [
        LaneKind::Drive,
        LaneKind::Drive,
        LaneKind::Parking,
        LaneKind::Walk,
    ];
    add(&mut scene, &[[-20.0, 0.0], [20.0, 0.0]], &STREET, &right);
    let layout = &scene.canvas().layout;
    let across = |layer| (0..200).filter(|y| layout.has(layer, 100, *y)).count() as f64 * Window::VOXEL_M;
    assert!((across(BevLayer::DrivableArea) - 10.5).abs() < 0.5);
    assert!((across(BevLayer::CarparkArea) - 2.3).abs() < 0.5);
    assert!((across(BevLayer::Walkway) - 4.8).abs() < 0.5);
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 3);
    assert_eq!(kinds(&scene, PolylineKind::RoadDivider), 1);
    assert_eq!(kinds(&scene, PolylineKind::LaneDivider), 1);
    // The lane on the left is driven the other way.
    let left = layout
        .polylines
        .iter()
        .find(|l| l.points_m[0].y > 0.1)
        .expect("a lane");
    assert_eq!(left.points_m[0], DVec2::new(20.0, 1.75));
    let rev = scene.rev;
    let road = scene.roads.roads[0].clone();
    let change = RoadChange::Put { road };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    assert_eq!(scene.rev, rev, "nothing changed");
}

#[test]
fn streets_that_cross_have_a_junction_with_round_corners() {
    let scene = crossing();
    let net = &scene.roads;
    assert_eq!((net.roads.len(), net.nodes.len()), (4, 5));
    let middle = net
        .nodes
        .iter()
        .find(|n| net.arms(n.id).len() == 4)
        .expect("a junction");
    assert!(middle.at_m.distance(DVec2::new(2.0, 1.0)) < 0.01);
    let layout = &scene.canvas().layout;
    let has = |x: f64, y: f64, layer| {
        let [i, j] = layout.extent().column_at(x, y).expect("on the map");
        layout.has(layer, i, j)
    };
    // Half a road is 3.5 m: within the corner but off both roads.
    for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let off = |d: f64| (2.0 + sx * (3.5 + d), 1.0 + sy * (3.5 + d));
        assert!(has(off(0.7).0, off(0.7).1, BevLayer::DrivableArea), "{sx} {sy}");
        assert!(has(off(2.2).0, off(2.2).1, BevLayer::Walkway), "{sx} {sy}");
        assert!(!has(off(6.0).0, off(6.0).1, BevLayer::Walkway), "{sx} {sy}");
    }
    for (x, y) in [(2.0, 1.0), (6.0, 1.0), (2.0, 5.0)] {
        assert!(!has(x, y, BevLayer::RoadDivider) && !has(x, y, BevLayer::Walkway));
    }
    assert_eq!(kinds(&scene, PolylineKind::RoadDivider), 4);
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 8);
    assert!(net.problem().is_none());
}

#[test]
fn a_change_leaves_alone_what_it_does_not_draw() {
    let mut scene = crossing();
    let paint = |x, layer| Edit::PaintBev {
        layer,
        shape: Shape::Cells((100..110).map(|y| [x, y]).collect()),
        value: true,
    };
    paint(20, BevLayer::RoadBlock).apply(&mut scene).expect("sound");
    paint(180, BevLayer::Walkway).apply(&mut scene).expect("sound");
    let before = scene.canvas().layout.clone();
    // The northern street gets a bus lane.
    let net = scene.roads.clone();
    let north = net
        .roads
        .iter()
        .find(|r| net.points_m(r).iter().any(|p| p.y > 40.0))
        .expect("a road");
    let mut road = north.clone();
    road.right.insert(1, RoadLane::usual(LaneKind::Bus));
    let change = RoadChange::Put { road };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    let after = &scene.canvas().layout;
    let mut changed = 0;
    for [x, y] in after.extent().all_columns() {
        if after.cell(x, y) != before.cell(x, y) {
            changed += 1;
            let p = after.extent().center(x, y, 0);
            assert!(p.y > 0.0 && p.x > -8.0 && p.x < 16.0, "{p}");
        }
    }
    assert!(changed > 300, "{changed}");
    assert!(after.has(BevLayer::Walkway, 180, 105) && after.has(BevLayer::RoadBlock, 20, 105));
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 9);
    // And away again: the map is as it was.
    let back = RoadChange::Put { road: north.clone() };
    Edit::ChangeRoads { change: back }
        .apply(&mut scene)
        .expect("sound");
    assert_eq!(scene.canvas().layout.cells(), before.cells());
}

#[test]
fn what_is_drawn_is_recognised() {
    let mut scene = crossing();
    add(
        &mut scene,
        &[[-30.0, 1.0], [-30.0, 20.0], [-20.0, 30.0], [-5.0, 32.0]],
        &[],
        &[LaneKind::Drive],
    );
    let layout = scene.canvas().layout.clone();
    let found = recognise(&layout, &RoadNetwork::default());
    let drawn = found.draw(layout.extent()).layout;
    for (layer, least) in [(BevLayer::DrivableArea, 0.93), (BevLayer::Walkway, 0.7)] {
        let same = iou(&layout, &drawn, layer);
        assert!(same > least, "{layer:?} {same}");
    }
    let junctions = found.nodes.iter().filter(|n| found.arms(n.id).len() > 2).count();
    assert_eq!(junctions, 2, "{found:#?}");
    let two_way = found
        .roads
        .iter()
        .filter(|r| r.driven(true) == 1 && r.driven(false) == 1)
        .count();
    assert!(two_way >= 4 && two_way < found.roads.len(), "{found:#?}");
    // Lines and cells stay until a road changes.
    scene.roads = Arc::default();
    let before = scene.canvas().layout.clone();
    let change = RoadChange::Recognise {};
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    assert_eq!((*scene.roads).clone(), found);
    assert!(scene.canvas().layout == before);
}

#[test]
fn paint_becomes_a_street_that_can_be_moved() {
    let mut scene = empty();
    let stroke = Edit::PaintBev {
        layer: BevLayer::DrivableArea,
        shape: Shape::Line {
            points_m: vec![DVec2::new(-20.0, -12.0), DVec2::new(20.0, -10.0)],
            width_m: 7.3,
        },
        value: true,
    };
    stroke.apply(&mut scene).expect("sound");
    let net = network_of(&scene);
    assert_eq!((net.roads.len(), net.nodes.len()), (1, 2), "{net:#?}");
    let road = &net.roads[0];
    assert_eq!((road.driven(true), road.driven(false)), (1, 1));
    let mut node = net.nodes[0];
    node.at_m.y += 15.0;
    let change = RoadChange::PutNode { node };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    // Nothing of the old street is left where the new one is not.
    let drawn = scene.roads.draw(Extent::WINDOW).layout;
    let stray = Extent::WINDOW.all_columns().filter(|[x, y]| {
        scene.canvas().layout.has(BevLayer::DrivableArea, *x, *y)
            && !drawn.has(BevLayer::DrivableArea, *x, *y)
    });
    assert!(stray.count() < 40);
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 2);
}

#[test]
fn roundabouts_are_drawn_and_recognised() {
    let mut scene = crossing();
    let net = scene.roads.clone();
    let mut node = *net
        .nodes
        .iter()
        .find(|n| net.arms(n.id).len() == 4)
        .expect("a junction");
    node.kind = NodeKind::Roundabout {
        island_m: 7.0,
        ring_m: 5.5,
    };
    let change = RoadChange::PutNode { node };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    let layout = scene.canvas().layout.clone();
    let at = |p: DVec2| layout.extent().column_at(p.x, p.y).expect("on the map");
    for k in 0..32 {
        let way = DVec2::from_angle(f64::from(k) * 0.2);
        let [[ix, iy], [rx, ry]] = [4.0, 9.7].map(|r| at(node.at_m + way * r));
        assert_eq!(layout.cell(ix, iy), 0, "the island");
        assert!(layout.has(BevLayer::DrivableArea, rx, ry), "the ring");
    }
    // The ring is driven counter-clockwise, and every arm leads in and out.
    let ring: Vec<_> = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter)
        .filter(|l| {
            l.points_m
                .iter()
                .all(|p| (p.distance(node.at_m) - 9.75).abs() < 0.2)
        })
        .collect();
    assert_eq!(ring.len(), 8);
    for line in ring {
        let [a, b, ..] = line.points_m.as_slice() else {
            panic!("a piece")
        };
        assert!((*a - node.at_m).perp_dot(*b - *a) > 0.0);
    }
    let found = recognise(&layout, &RoadNetwork::default());
    let rings: Vec<_> = found
        .nodes
        .iter()
        .filter(|n| matches!(n.kind, NodeKind::Roundabout { .. }))
        .collect();
    assert_eq!(rings.len(), 1, "{found:#?}");
    assert!(rings[0].at_m.distance(node.at_m) < 0.5 && found.arms(rings[0].id).len() == 4);
    assert!(
        iou(
            &layout,
            &found.draw(layout.extent()).layout,
            BevLayer::DrivableArea
        ) > 0.88
    );
}

#[test]
fn roads_are_split_joined_and_taken_away() {
    let mut scene = crossing();
    let before = scene.canvas().layout.clone();
    let east = scene.roads.road_at(DVec2::new(30.0, 1.0), 0.0).expect("a road");
    let apply = |scene: &mut Scene, change| Edit::ChangeRoads { change }.apply(scene);
    let at_m = DVec2::new(30.0, 3.0);
    apply(&mut scene, RoadChange::Split { id: east, at_m }).expect("sound");
    assert_eq!(scene.roads.roads.len(), 5);
    assert_eq!(
        scene.canvas().layout.cells(),
        before.cells(),
        "a split is not seen"
    );
    let joint = scene
        .roads
        .nodes
        .iter()
        .find(|n| n.at_m.distance(DVec2::new(30.0, 1.0)) < 0.1);
    let node = joint.expect("a node").id;
    apply(&mut scene, RoadChange::Join { node }).expect("sound");
    assert_eq!((scene.roads.roads.len(), scene.roads.nodes.len()), (4, 5));
    assert_eq!(scene.canvas().layout.cells(), before.cells());
    let east = scene.roads.road_at(DVec2::new(30.0, 1.0), 0.0).expect("a road");
    apply(&mut scene, RoadChange::Remove { id: east }).expect("sound");
    let layout = &scene.canvas().layout;
    assert!(!layout.has(BevLayer::DrivableArea, 180, 102) && layout.has(BevLayer::DrivableArea, 20, 102));
    // Three arms are left: the lanes of the one that went are gone.
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 6);
    for (change, said) in [
        (
            RoadChange::Remove { id: RoadId(99) },
            "road 99 does not exist in this scene",
        ),
        (
            RoadChange::Join {
                node: scene.roads.nodes[0].id,
            },
            "expected two to join",
        ),
    ] {
        let error = apply(&mut scene, change).expect_err("refused").to_string();
        assert!(error.contains(said), "{error}");
    }
    let bad = Road {
        right: vec![RoadLane {
            kind: LaneKind::Drive,
            width_m: f64::NAN,
        }],
        ..scene.roads.roads[0].clone()
    };
    let rev = scene.rev;
    assert!(apply(&mut scene, RoadChange::Put { road: bad }).is_err());
    assert_eq!(scene.rev, rev);
}

#[test]
fn a_bend_is_straightened_and_a_split_bend_keeps_its_shape() {
    let mut scene = empty();
    let arc: Vec<[f64; 2]> = (0..=8)
        .map(|k| (DVec2::from_angle(f64::from(k) * 0.2 - 1.57) * 30.0 + DVec2::new(-15.0, 20.0)).to_array())
        .collect();
    add(&mut scene, &arc, &STREET, &STREET);
    let before = scene.canvas().layout.clone();
    let line = scene.roads.lines()[&RoadId(1)].clone();
    let at_m = curve::at(&line, curve::length_m(&line) * 0.43).0;
    let split = RoadChange::Split { id: RoadId(1), at_m };
    Edit::ChangeRoads { change: split }
        .apply(&mut scene)
        .expect("sound");
    assert!(iou(&before, &scene.canvas().layout, BevLayer::DrivableArea) > 0.99);
    let mut scene = empty();
    add(&mut scene, &arc, &STREET, &STREET);
    let change = RoadChange::Straighten { id: RoadId(1) };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    let net = &scene.roads;
    assert_eq!(net.lines()[&RoadId(1)].len(), 2);
    assert_eq!(kinds(&scene, PolylineKind::LaneCenter), 2);
}

#[test]
fn poor_maps_have_no_roads_and_poor_lines_make_none() {
    assert!(network_of(&empty()).is_empty());
    let mut scene = empty();
    for points in [vec![], vec![DVec2::ONE; 3], vec![DVec2::NAN, DVec2::ONE]] {
        let change = RoadChange::Add {
            points_m: points,
            left: vec![],
            right: lanes(&STREET),
            limit_kph: None,
        };
        assert!(Edit::ChangeRoads { change }.apply(&mut scene).is_err());
    }
    // All of the map is paved: a place, not a road. It must only end.
    let all = Edit::PaintBev {
        layer: BevLayer::DrivableArea,
        shape: Shape::Cells(Extent::WINDOW.all_columns().collect()),
        value: true,
    };
    all.apply(&mut scene).expect("sound");
    let net = network_of(&scene);
    assert!(net.problem().is_none());
    // Strewn about without order, by a simple generator: no network, or a sound one, and soon.
    for step in [3u64, 7, 11, 2] {
        let mut scene = empty();
        let mut state = step;
        let strewn = Extent::WINDOW.all_columns().filter(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % step.max(3) != 0
        });
        let paint = Edit::PaintBev {
            layer: BevLayer::DrivableArea,
            shape: Shape::Cells(strewn.collect()),
            value: true,
        };
        paint.apply(&mut scene).expect("sound");
        let net = network_of(&scene);
        assert!(net.problem().is_none());
        net.draw(Extent::WINDOW);
    }
}

#[test]
fn wishes_change_the_whole_street() {
    use scene::roads::RoadWish;
    let mut scene = crossing();
    let wish = |scene: &mut Scene, wish| {
        let change = RoadChange::Wish {
            at_m: DVec2::new(-20.0, 0.0),
            heading_deg: 0.0,
            wish,
        };
        Edit::ChangeRoads { change }.apply(scene)
    };
    wish(&mut scene, RoadWish::Lanes { count: 4 }).expect("sound");
    let along: Vec<_> = scene
        .roads
        .roads
        .iter()
        .filter(|r| r.driven(true) == 2 && r.driven(false) == 2)
        .collect();
    assert_eq!(along.len(), 2, "both halves, and not the street across");
    let right = Some(true);
    wish(
        &mut scene,
        RoadWish::Beside {
            kind: LaneKind::Bus,
            right,
        },
    )
    .expect("sound");
    // The bus lane lies on the right as one looks: at negative y.
    let bus = |r: &&Road| r.right.iter().chain(&r.left).any(|l| l.kind == LaneKind::Bus);
    for road in scene.roads.roads.iter().filter(bus) {
        let points = scene.roads.points_m(road);
        let runs_ahead = points[1].x > points[0].x;
        assert_eq!(road.right.iter().any(|l| l.kind == LaneKind::Bus), runs_ahead);
    }
    assert_eq!(scene.roads.roads.iter().filter(bus).count(), 2);
    wish(&mut scene, RoadWish::Without { kind: LaneKind::Walk }).expect("sound");
    wish(&mut scene, RoadWish::OneWay {}).expect("sound");
    let one_way = scene
        .roads
        .roads
        .iter()
        .filter(|r| r.driven(true) == 0 || r.driven(false) == 0);
    assert_eq!(one_way.count(), 2);
    wish(&mut scene, RoadWish::Widths { times: 100.0 }).expect("sound");
    assert!(
        scene
            .roads
            .roads
            .iter()
            .flat_map(|r| &r.right)
            .all(|l| l.width_m <= 5.0)
    );
    wish(&mut scene, RoadWish::Roundabout {}).expect("sound");
    let rings = |scene: &Scene| {
        let round = |n: &&scene::RoadNode| matches!(n.kind, NodeKind::Roundabout { .. });
        scene.roads.nodes.iter().filter(round).count()
    };
    assert_eq!(rings(&scene), 1);
    wish(&mut scene, RoadWish::Junction {}).expect("sound");
    assert_eq!(rings(&scene), 0);
    for bad in [
        RoadWish::Lanes { count: 0 },
        RoadWish::Widths { times: f64::NAN },
        RoadWish::Junction {},
    ] {
        assert!(wish(&mut scene, bad).is_err());
    }
    assert!(scene.roads.problem().is_none());
    let far = RoadChange::Wish {
        at_m: DVec2::splat(9000.0),
        heading_deg: 0.0,
        wish: RoadWish::OneWay {},
    };
    assert!(Edit::ChangeRoads { change: far }.apply(&mut scene).is_err());
    // A bend made straight.
    let mut scene = empty();
    let bend = [[-40.0, 0.0], [0.0, 0.0], [30.0, 25.0]];
    add(&mut scene, &bend, &STREET, &STREET);
    let change = RoadChange::Wish {
        at_m: DVec2::new(-20.0, 0.0),
        heading_deg: 0.0,
        wish: RoadWish::Straight {},
    };
    Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
    assert!(scene.roads.roads.iter().all(|r| r.via_m.is_empty()));
}

#[test]
fn the_only_painted_road_can_be_deleted_and_recognising_paints_nothing() {
    let mut scene = empty();
    add(&mut scene, &[[-30.0, 0.0], [30.0, 0.0]], &STREET, &STREET);
    // A pocket beside the road, wider than any rim.
    let pocket = Edit::PaintBev {
        layer: BevLayer::DrivableArea,
        shape: Shape::Rect {
            min_m: DVec2::new(0.0, 3.0),
            max_m: DVec2::new(12.0, 9.0),
        },
        value: true,
    };
    pocket.apply(&mut scene).expect("sound");
    let apply = |scene: &mut Scene, change| Edit::ChangeRoads { change }.apply(scene);
    let layout = scene.canvas().layout.clone();
    apply(&mut scene, RoadChange::Recognise {}).expect("sound");
    assert!(scene.canvas().layout == layout, "a known network");
    let mut scene = empty();
    add(&mut scene, &[[-30.0, 0.0], [30.0, 0.0]], &STREET, &STREET);
    scene.roads = Arc::default();
    let layout = scene.canvas().layout.clone();
    apply(&mut scene, RoadChange::Recognise {}).expect("sound");
    assert!(scene.canvas().layout == layout && scene.roads.roads.len() == 1);
    scene.roads = Arc::default();
    let id = network_of(&scene).roads[0].id;
    apply(&mut scene, RoadChange::Remove { id }).expect("sound");
    assert!(scene.canvas().layout.count(BevLayer::DrivableArea) < 20);
    assert!(scene.canvas().layout.polylines.is_empty());
}

#[test]
fn another_direction_leaves_the_carriageway_where_it_is() {
    use scene::roads::RoadWish;
    let mut scene = empty();
    add(&mut scene, &[[-45.0, 0.0], [45.0, 0.0]], &STREET, &STREET);
    let before = scene.canvas().layout.clone();
    let wish = |heading_deg| RoadChange::Wish {
        at_m: DVec2::ZERO,
        heading_deg,
        wish: RoadWish::OneWay {},
    };
    for heading_deg in [0.0, 180.0] {
        let mut scene = scene.clone();
        let change = wish(heading_deg);
        Edit::ChangeRoads { change }.apply(&mut scene).expect("sound");
        assert!(iou(&before, &scene.canvas().layout, BevLayer::DrivableArea) > 0.99);
        let road = scene.roads.roads[0].turned();
        let stays = RoadChange::Put { road };
        Edit::ChangeRoads { change: stays }
            .apply(&mut scene)
            .expect("sound");
        assert!(iou(&before, &scene.canvas().layout, BevLayer::DrivableArea) > 0.99);
        let lines = &scene.canvas().layout.polylines;
        let runs: Vec<f64> = lines.iter().map(|l| l.points_m[1].x - l.points_m[0].x).collect();
        let ahead = heading_deg != 0.0;
        assert!(
            runs.iter().filter(|r| (**r > 0.0) == ahead).count() >= 2,
            "{runs:?}"
        );
    }
}

#[test]
fn streets_that_lead_nowhere_or_too_far_are_refused_and_loops_close() {
    let mut scene = empty();
    let add_points = |scene: &mut Scene, points_m: Vec<DVec2>| {
        let change = RoadChange::Add {
            points_m,
            left: vec![],
            right: lanes(&[LaneKind::Drive]),
            limit_kph: None,
        };
        Edit::ChangeRoads { change }.apply(scene)
    };
    let short = vec![DVec2::ZERO, DVec2::X * 2.0];
    assert!(add_points(&mut scene, short).is_err());
    let zigzag = (0..9000)
        .map(|k| DVec2::new(f64::from(k % 2) * 9000.0, f64::from(k)))
        .collect();
    let error = add_points(&mut scene, zigzag).expect_err("too long").to_string();
    assert!(error.contains("expected at most 50000 m"), "{error}");
    let ring = (0..=12)
        .map(|k| DVec2::from_angle(f64::from(k) / 12.0 * std::f64::consts::TAU) * 20.0)
        .collect();
    add_points(&mut scene, ring).expect("a loop");
    assert_eq!((scene.roads.roads.len(), scene.roads.nodes.len()), (1, 1));
    // A street across a divided road has a junction with each carriageway.
    let mut scene = empty();
    for y in [-2.5, 2.5] {
        add_points(
            &mut scene,
            vec![DVec2::new(-40.0, y + 3.0), DVec2::new(40.0, y + 3.0)],
        )
        .expect("sound");
    }
    add(&mut scene, &[[0.0, -40.0], [0.0, 40.0]], &STREET, &STREET);
    let met = scene
        .roads
        .nodes
        .iter()
        .filter(|n| scene.roads.arms(n.id).len() == 4)
        .count();
    assert_eq!(met, 2, "{:#?}", scene.roads);
}
