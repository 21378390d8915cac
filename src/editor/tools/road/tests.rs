use glam::DVec2;

use super::*;
use crate::roads::Street;
use crate::tools::testing::{NONE, Table};
use crate::tools::{Modifiers, ToolOption, setting::Control};
use crate::{Apply, apply_all};
use scene::roads::{LaneKind, NodeKind};
use scene::{BevLayer, Scene};

/// A table with a street along x and one that crosses it, and the tool.
fn table() -> (Table, RoadTool) {
    let mut table = Table::new();
    for ends in [[[-45.0, 0.0], [45.0, 0.0]], [[0.0, -45.0], [0.0, 45.0]]] {
        let change = Street::default()
            .along(&ends.map(DVec2::from_array))
            .expect("two points");
        Edit::ChangeRoads { change }
            .apply(&mut table.scene)
            .expect("sound");
    }
    (table, RoadTool::default())
}

/// Carries out what the tool answers; what is only previewed is kept aside.
fn carry_out(table: &mut Table, shown: &mut Option<Scene>, response: Response) {
    for act in response.acts {
        match act {
            Act::Apply(_, edits) => apply_all(&edits, &mut table.scene).expect("sound"),
            Act::Try(edits) | Act::Preview(edits) => {
                let mut after = table.scene.clone();
                apply_all(&edits, &mut after).expect("sound");
                *shown = Some(after);
            }
            Act::Commit(_) => table.scene = shown.take().expect("something was shown"),
            Act::Cancel => *shown = None,
            _ => {}
        }
    }
}

fn drag(table: &mut Table, tool: &mut RoadTool, from: [f64; 2], to: [f64; 2]) {
    let mut shown = None;
    for k in 0..=4 {
        let t = f64::from(k) / 4.0;
        let [x, y] = [0, 1].map(|i| from[i] + (to[i] - from[i]) * t);
        let response = match k {
            0 => table.press(tool, x, y, NONE),
            _ => table.drag(tool, x, y),
        };
        carry_out(table, &mut shown, response);
    }
    let response = table.release(tool, to[0], to[1]);
    carry_out(table, &mut shown, response);
}

fn has(table: &Table, x: f64, y: f64) -> bool {
    let layout = &table.scene.canvas().layout;
    let [i, j] = layout.extent().column_at(x, y).expect("on the map");
    layout.has(BevLayer::DrivableArea, i, j)
}

#[test]
fn a_line_is_bent_and_a_point_moved_and_taken_away() {
    let (mut table, mut tool) = table();
    drag(&mut table, &mut tool, [25.0, 0.0], [25.0, 8.0]);
    assert!(matches!(table.hand.road.chosen, Some(RoadPart::Via(_, 0))));
    assert!(has(&table, 25.0, 9.0) && !has(&table, 25.0, -2.0));
    drag(&mut table, &mut tool, [25.0, 8.0], [25.0, -8.0]);
    assert!(has(&table, 25.0, -9.0) && !has(&table, 25.0, 9.0));
    let alt = Modifiers { alt: true, ..NONE };
    let response = table.press(&mut tool, 25.0, -8.0, alt);
    carry_out(&mut table, &mut None, response);
    assert!(has(&table, 25.0, 0.0) && !has(&table, 25.0, -8.0));
    assert!(table.scene.roads.roads.iter().all(|r| r.via_m.is_empty()));
}

#[test]
fn painted_roads_are_recognised_when_they_are_first_reshaped() {
    let (mut table, mut tool) = table();
    table.scene.roads = Default::default();
    assert_eq!(tool.network(&table.scene).net.roads.len(), 4);
    drag(&mut table, &mut tool, [0.1, 0.1], [4.0, 6.0]);
    assert_eq!(table.scene.roads.roads.len(), 4);
    assert!(matches!(table.hand.road.chosen, Some(RoadPart::Node(_))));
    let middle = table
        .scene
        .roads
        .nodes
        .iter()
        .find(|n| table.scene.roads.arms(n.id).len() == 4);
    assert!(middle.expect("a junction").at_m.distance(DVec2::new(4.0, 6.0)) < 0.5);
    assert!(has(&table, 4.0, 6.0));
}

#[test]
fn a_free_end_that_is_let_go_of_on_a_road_meets_it() {
    let (mut table, mut tool) = table();
    let change = Street::default()
        .along(&[DVec2::new(20.0, 30.0), DVec2::new(35.0, 20.0)])
        .expect("two");
    Edit::ChangeRoads { change }
        .apply(&mut table.scene)
        .expect("sound");
    drag(&mut table, &mut tool, [35.0, 20.0], [30.0, 1.0]);
    let net = &table.scene.roads;
    let met: Vec<_> = net.nodes.iter().filter(|n| net.arms(n.id).len() == 3).collect();
    assert!(
        met.len() == 1 && met[0].at_m.distance(DVec2::new(30.0, 0.0)) < 0.1,
        "{net:#?}"
    );
    // Its other end meets the junction.
    drag(&mut table, &mut tool, [20.0, 30.0], [1.0, 1.0]);
    let net = &table.scene.roads;
    assert!(net.nodes.iter().any(|n| net.arms(n.id).len() == 5));
}

#[test]
fn options_change_lanes_limits_marks_and_junctions() {
    let (mut table, mut tool) = table();
    let set = |table: &mut Table, tool: &mut RoadTool, id: &str, value| {
        let frame = table.scene.frame().clone();
        for act in tool.set(&mut table.hand, &frame, id, value) {
            carry_out(table, &mut None, Response::act(act));
        }
        tool.network(&table.scene);
    };
    // The lane on the right of the western street.
    table.press(&mut tool, -25.0, -2.0, NONE);
    let Some(RoadPart::Road(id)) = table.hand.road.chosen else {
        panic!("a road")
    };
    assert_eq!(table.hand.road.lane, Some((true, 0)));
    set(&mut table, &mut tool, "add", Value::Pressed);
    set(&mut table, &mut tool, "kind", Value::Index(1));
    set(&mut table, &mut tool, "limit", Value::Index(3));
    set(&mut table, &mut tool, "crossing", Value::Pressed);
    set(&mut table, &mut tool, "stop", Value::Pressed);
    let road = table.scene.roads.road(id).expect("there").clone();
    assert_eq!(
        road.right.iter().map(|l| l.kind).collect::<Vec<_>>(),
        [LaneKind::Drive, LaneKind::Bus]
    );
    assert_eq!(
        (road.limit_kph, road.crossings.len(), road.stops.len()),
        (Some(30.0), 1, 1)
    );
    assert!(table.scene.canvas().layout.count(BevLayer::PedCrossing) > 50);
    set(&mut table, &mut tool, "crossing", Value::Pressed);
    assert_eq!(table.scene.canvas().layout.count(BevLayer::PedCrossing), 0);
    // A limit that is not in the list is shown all the same.
    let mut road = road;
    road.limit_kph = Some(45.0);
    let change = RoadChange::Put { road };
    Edit::ChangeRoads { change }
        .apply(&mut table.scene)
        .expect("sound");
    tool.network(&table.scene);
    let limit = |s: &ToolOption| match &s.control {
        Control::List { chosen, choices, .. } if s.id == "limit" => Some(choices[*chosen].0.clone()),
        _ => None,
    };
    assert_eq!(
        tool.options(&table.hand).iter().find_map(limit).as_deref(),
        Some("45 km/h")
    );
    table.press(&mut tool, 0.0, 0.0, NONE);
    set(&mut table, &mut tool, "node_kind", Value::Index(1));
    let ring = |table: &Table| {
        let net = &table.scene.roads;
        net.nodes
            .iter()
            .filter(|n| matches!(n.kind, NodeKind::Roundabout { .. }))
            .count()
    };
    assert_eq!(ring(&table), 1);
    assert!(!has(&table, 0.0, 0.0) && has(&table, 0.0, 10.0));
    let part = table.hand.road.chosen.expect("the node");
    assert!(deletion(&table.scene, part).is_some());
    table.press(&mut tool, -25.0, -2.0, NONE);
    set(&mut table, &mut tool, "delete", Value::Pressed);
    assert!(!has(&table, -30.0, 0.0) && table.hand.road.chosen.is_none());
    let names: Vec<_> = tool.options(&table.hand).iter().map(|s| s.id).collect();
    assert!(names.len() > 2);
}
