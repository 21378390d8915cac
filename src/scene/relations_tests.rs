//! Each relation on a street, where it holds and where it does not; gaps and overlaps of boxes.

use super::*;
use crate::graph::ObjectNode;
use crate::raster::{draw_polyline, line_cells, polygon_cells};
use crate::{BevLayout, Polyline, PolylineKind};

/// A street along x: the ego's lane, one to its left, one oncoming beyond it; a sidewalk on the right; a crossing at 20 m.
fn street() -> RoadMap {
    let mut layout = BevLayout::default();
    let line = |y: f64, back: bool| {
        let mut points: Vec<DVec2> = (-44..=44).map(|x| DVec2::new(f64::from(x), y)).collect();
        if back {
            points.reverse();
        }
        Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: points,
        }
    };
    let mut lines = vec![line(0.0, false), line(3.5, false), line(7.0, true)];
    let middle: Vec<DVec2> = lines[1].points_m.clone();
    line_cells(crate::Extent::WINDOW, &middle, 5.25, |x, y| {
        layout.set(BevLayer::DrivableArea, x, y, true)
    });
    let walk = [(-44.0, -1.75), (44.0, -1.75), (44.0, -4.0), (-44.0, -4.0)].map(DVec2::from);
    polygon_cells(crate::Extent::WINDOW, &walk, |x, y| {
        layout.set(BevLayer::Walkway, x, y, true)
    });
    let outline = [(20.0, 8.75), (20.0, -1.75), (23.0, -1.75), (23.0, 8.75)]
        .map(DVec2::from)
        .to_vec();
    lines.push(Polyline {
        kind: PolylineKind::PedCrossing,
        points_m: outline,
    });
    lines.iter().for_each(|l| draw_polyline(&mut layout, l));
    RoadMap::new(&BevLayout::from_cells(layout.cells().to_vec(), lines).expect("40,000 cells"))
}

fn boxed(class: Class, x: f64, y: f64, yaw_deg: f64, speed: f64) -> SceneBox {
    let size_m = DVec3::from_array(class.typical_size_m().expect("an object"));
    let yaw_rad = yaw_deg.to_radians();
    SceneBox {
        id: BoxId(1),
        class,
        center_m: DVec3::new(x, y, size_m.z / 2.0),
        size_m,
        yaw_rad,
        velocity_mps: DVec2::from_angle(yaw_rad) * speed,
        label: BoxLabel::default(),
    }
}

fn holds(road: &RoadMap, b: SceneBox, relation: RelationKind, to: NodeKind, distance_m: Option<f64>) -> bool {
    let mut graph = SceneGraph::with_ego();
    let from = graph.add(NodeKind::Object(ObjectNode::new(b.class)));
    let to = if to == NodeKind::Ego {
        SceneGraph::EGO
    } else {
        graph.add(to)
    };
    let boxes = BTreeMap::from([(from, b)]);
    let edge = GraphEdge {
        distance_m,
        ..GraphEdge::new(from, relation, to)
    };
    PlacedGraph {
        graph: &graph,
        boxes: &boxes,
        road,
    }
    .satisfied(&edge)
}

#[test]
fn the_street_is_read_right() {
    let road = street();
    let roles: Vec<LaneRole> = road.lanes.iter().map(|l| l.role).collect();
    assert_eq!(roles, [LaneRole::Ego, LaneRole::Left, LaneRole::Oncoming]);
    assert!((road.middle_m - 5.25).abs() < 0.1, "{}", road.middle_m);
    assert_eq!((road.crossings.len(), road.junctions_m.len()), (1, 0));
    let near = road.nearest_lane(DVec2::new(10.0, 0.6)).expect("a lane");
    assert!(near.lane == 0 && (near.offset_m - 0.6).abs() < 1e-9 && near.direction.x > 0.99);
    assert!(road.nearest_lane(DVec2::NAN).is_none() && road.from_road_m(DVec2::NAN) == 1000.0);
}

/// Each relation with a box for which it holds and one for which it does not.
fn cases() -> [(RelationKind, NodeKind, SceneBox, SceneBox); 18] {
    use RelationKind as R;
    let lane = |role| NodeKind::Lane { role, polyline: None };
    let crossing = || NodeKind::Crossing { polyline: None };
    let car = |x, y, yaw, speed| boxed(Class::Car, x, y, yaw, speed);
    let person = |x, y, yaw, speed| boxed(Class::Pedestrian, x, y, yaw, speed);
    [
        (
            R::InFrontOf,
            NodeKind::Ego,
            car(12.0, 0.0, 0.0, 5.0),
            car(-12.0, 0.0, 0.0, 5.0),
        ),
        (
            R::Behind,
            NodeKind::Ego,
            car(-12.0, 0.0, 0.0, 5.0),
            car(12.0, 0.0, 0.0, 5.0),
        ),
        (
            R::LeftOf,
            NodeKind::Ego,
            car(2.0, 3.5, 0.0, 5.0),
            car(2.0, -3.5, 0.0, 5.0),
        ),
        (
            R::RightOf,
            NodeKind::Ego,
            person(2.0, -3.0, 0.0, 0.0),
            person(2.0, 3.0, 0.0, 0.0),
        ),
        (
            R::Near,
            NodeKind::Ego,
            person(6.0, -3.0, 0.0, 0.0),
            person(30.0, -3.0, 0.0, 0.0),
        ),
        (
            R::FarFrom,
            NodeKind::Ego,
            person(30.0, -3.0, 0.0, 0.0),
            person(6.0, -3.0, 0.0, 0.0),
        ),
        (
            R::NextTo,
            NodeKind::Ego,
            car(2.0, 3.5, 0.0, 0.0),
            car(2.0, 8.5, 0.0, 0.0),
        ),
        (
            R::On,
            lane(LaneRole::Oncoming),
            car(9.0, 7.0, 180.0, 5.0),
            car(9.0, 0.0, 0.0, 5.0),
        ),
        (
            R::On,
            lane(LaneRole::RightSidewalk),
            person(9.0, -3.0, 0.0, 1.0),
            person(9.0, 3.0, 0.0, 1.0),
        ),
        (
            R::Across,
            lane(LaneRole::Ego),
            boxed(Class::Truck, 15.0, 1.0, 90.0, 0.0),
            car(15.0, 0.0, 0.0, 0.0),
        ),
        (
            R::Across,
            NodeKind::Ego,
            car(9.0, 7.0, 180.0, 5.0),
            car(9.0, 3.5, 0.0, 5.0),
        ),
        (
            R::Blocking,
            lane(LaneRole::Ego),
            car(15.0, 0.5, 0.0, 0.0),
            car(15.0, 3.5, 0.0, 0.0),
        ),
        (
            R::Facing,
            NodeKind::Ego,
            car(20.0, 0.0, 180.0, 0.0),
            car(20.0, 0.0, 0.0, 0.0),
        ),
        (
            R::Following,
            NodeKind::Ego,
            car(-12.0, 0.0, 0.0, 5.0),
            car(-12.0, 3.5, 0.0, 5.0),
        ),
        (
            R::Crossing,
            NodeKind::Ego,
            person(21.0, 1.0, 90.0, 1.2),
            person(21.0, 1.0, 0.0, 1.2),
        ),
        (
            R::ParkedOn,
            lane(LaneRole::Left),
            car(5.0, 3.5, 0.0, 0.0),
            car(5.0, 3.5, 0.0, 5.0),
        ),
        (
            R::WaitingAt,
            crossing(),
            car(14.0, 0.0, 0.0, 0.0),
            car(26.0, 0.0, 0.0, 0.0),
        ),
        (
            R::OppositeDirection,
            NodeKind::Ego,
            car(9.0, 7.0, 180.0, 5.0),
            car(9.0, 3.5, 0.0, 5.0),
        ),
    ]
}

#[test]
fn every_relation_holds_where_it_should_and_not_elsewhere() {
    use RelationKind as R;
    let road = street();
    let car = |x, y, yaw, speed| boxed(Class::Car, x, y, yaw, speed);
    for (relation, to, yes, no) in cases() {
        assert!(
            holds(&road, yes, relation, to.clone(), None),
            "{relation:?} {to:?}"
        );
        assert!(
            !holds(&road, no, relation, to.clone(), None),
            "not {relation:?} {to:?}"
        );
        let bad = SceneBox {
            center_m: DVec3::NAN,
            ..yes
        };
        assert!(
            !holds(&road, bad, relation, to.clone(), None),
            "{relation:?} of NaN"
        );
    }
    let ahead = car(12.0, 0.0, 0.0, 5.0);
    assert!(holds(&road, ahead, R::InFrontOf, NodeKind::Ego, Some(10.5)));
    assert!(!holds(&road, ahead, R::InFrontOf, NodeKind::Ego, Some(20.0)));
}

#[test]
fn between_needs_both() {
    let (road, mut graph) = (street(), SceneGraph::with_ego());
    let ids: Vec<u32> = (0..3)
        .map(|_| graph.add(NodeKind::Object(ObjectNode::new(Class::Car))))
        .collect();
    let at = |x| boxed(Class::Car, x, 0.0, 0.0, 0.0);
    let boxes = BTreeMap::from([(ids[0], at(20.0)), (ids[1], at(10.0)), (ids[2], at(30.0))]);
    let placed = PlacedGraph {
        graph: &graph,
        boxes: &boxes,
        road: &road,
    };
    let edge = |from: usize, a: usize, b: usize| GraphEdge {
        and: Some(ids[b]),
        ..GraphEdge::new(ids[from], RelationKind::Between, ids[a])
    };
    assert!(placed.satisfied(&edge(0, 1, 2)) && !placed.satisfied(&edge(1, 0, 2)));
    assert!(!placed.satisfied(&GraphEdge::new(ids[0], RelationKind::Between, ids[1])));
}

#[test]
fn overlaps_and_gaps() {
    let a = boxed(Class::Car, 0.0, 0.0, 0.0, 0.0);
    let b = boxed(Class::Car, 6.6, 0.0, 0.0, 0.0);
    assert!((gap_m(&a, &b) - 2.0).abs() < 1e-9 && (overlap_m(&a, &b) + 2.0).abs() < 1e-9);
    let turned = boxed(Class::Car, 2.0, 1.0, 40.0, 0.0);
    assert!(overlap_m(&a, &turned) > 0.0 && gap_m(&a, &turned) == 0.0);
    let nowhere = SceneBox {
        yaw_rad: f64::NAN,
        ..a
    };
    assert!(overlap_m(&a, &nowhere) < 0.0);
}
