//! Options of the selected part: lanes, limit and marks of a road, the kind of a junction.

use glam::DVec2;

use language::{filled, t, tf};
use scene::roads::{LaneKind, NodeKind, RoadChange, RoadCrossing, RoadLane, RoadStop, curve};
use scene::{Road, RoadId, RoadNetwork, RoadNode};

use super::part::{RoadGeometry, RoadHand, RoadPart};
use super::{apply, recognised};
use crate::tools::Act;
use crate::tools::setting::{Choice, Control, ToolOption, Value};

/// Widths of lanes to choose from, m.
const WIDTHS_M: [f64; 12] = [1.2, 1.6, 2.0, 2.3, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 5.0];
/// Speed limits to choose from, km/h; 0 is none.
const LIMITS_KPH: [f64; 13] = [
    0.0, 7.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 100.0, 120.0, 130.0, 150.0,
];
/// Radii of corners, of islands, and widths of rings, m.
const CORNERS_M: [f64; 8] = [0.0, 2.0, 3.5, 5.0, 8.0, 12.0, 18.0, 25.0];
const ISLANDS_M: [f64; 8] = [3.0, 5.0, 7.0, 9.0, 12.0, 16.0, 22.0, 30.0];
const RINGS_M: [f64; 6] = [4.5, 5.5, 6.5, 8.0, 9.5, 11.0];
/// A new crossing, m.
const CROSSING_M: f64 = 3.0;

const NODES: [Choice; 2] = [
    ("Junction", "with round corners"),
    ("Roundabout", "a ring around an island"),
];

pub(super) fn of(seen: &RoadGeometry, hand: &RoadHand) -> Vec<ToolOption> {
    let net = &*seen.net;
    let mut out = vec![ToolOption::title("Road")];
    let road = hand.chosen.and_then(RoadPart::road).and_then(|id| net.road(id));
    let node = match hand.chosen {
        Some(RoadPart::Node(id)) => net.node(id),
        _ => None,
    };
    match (road, node) {
        (Some(road), _) => of_road(seen, road, hand, &mut out),
        (None, Some(node)) => of_node(net, node, &mut out),
        _ => {
            let count = net.roads.len();
            let text = match count {
                0 => "No road is here. Draw one with the street tool, or paint drivable area.".to_owned(),
                1 => "1 road. Click it to reshape it.".to_owned(),
                n => tf!(
                    "{n} roads. Click one, or a dot where they meet, to reshape it.",
                    n = n
                ),
            };
            out.push(ToolOption::text(text));
            let draw = ToolOption::button("draw", "Draw a street", "point by point", true);
            let found = ToolOption::button(
                "recognise",
                "Recognise",
                "takes what was painted since for roads",
                true,
            );
            out.push(ToolOption::new("", Control::Line(vec![draw, found])));
        }
    }
    out
}

fn list(id: &'static str, title: &'static str, value: f64, all: &[f64], unit: &str) -> ToolOption {
    let name = |v: &f64| match *v {
        v if v == 0.0 && unit == " km/h" => "none".to_owned(),
        v => format!("{v}{unit}"),
    };
    let mut choices: Vec<(String, &'static str)> = all.iter().map(|v| (name(v), "")).collect();
    let chosen = match all.iter().position(|v| (v - value).abs() < 1e-6) {
        Some(i) => i,
        // A value that was set otherwise is the last of the list.
        None => {
            choices.push((name(&((value * 100.0).round() / 100.0)), ""));
            choices.len() - 1
        }
    };
    let control = Control::List {
        title,
        label: title,
        chosen,
        choices,
    };
    ToolOption::new(id, control)
}

/// Its lanes and its speed limit, for a person.
pub(super) fn summary(road: &Road) -> String {
    let lanes = match (road.driven(true), road.driven(false)) {
        (0, 0) => t("no lanes").to_owned(),
        (1, 0) | (0, 1) => t("one-way, 1 lane").to_owned(),
        (n, 0) | (0, n) => tf!("one-way, {n} lanes", n = n),
        (ahead, back) => tf!("{ahead} + {back} lanes", ahead = ahead, back = back),
    };
    let limit = road.limit_kph.map(|v| format!(", {v:.0} km/h"));
    lanes + &limit.unwrap_or_default()
}

fn of_road(seen: &RoadGeometry, road: &Road, hand: &RoadHand, out: &mut Vec<ToolOption>) {
    let length_m = seen.lines.get(&road.id).map_or(0.0, |l| curve::length_m(l));
    out.push(ToolOption::text(tf!(
        "Road {id}: {summary}, {length} m",
        id = road.id.0,
        summary = summary(road),
        length = format!("{length_m:.0}")
    )));
    let names: Vec<(String, &'static str)> = lanes(road)
        .map(|(right, i)| {
            let lane = road.side(right)[i];
            let name = match right {
                true => "R{number} {kind}, {width} m",
                false => "L{number} {kind}, {width} m",
            };
            let (number, kind, width) = (i + 1, t(lane.kind.title()), format!("{:.1}", lane.width_m));
            let name = filled(
                t(name),
                &[("number", &number), ("kind", &kind), ("width", &width)],
            );
            (name, "")
        })
        .collect();
    let chosen = chosen_lane(road, hand).and_then(|lane| lanes(road).position(|l| l == lane));
    out.push(ToolOption::new(
        "lane",
        Control::List {
            title: "Lane",
            label: "Lane",
            chosen: chosen.unwrap_or(0),
            choices: names,
        },
    ));
    if let Some((right, i)) = chosen_lane(road, hand) {
        let lane = road.side(right)[i];
        let kinds = LaneKind::ALL
            .iter()
            .map(|(_, name)| ((*name).to_owned(), ""))
            .collect();
        out.push(ToolOption::new(
            "kind",
            Control::List {
                title: "Type",
                label: "Type of lane",
                chosen: LaneKind::ALL.iter().position(|k| k.0 == lane.kind).unwrap_or(0),
                choices: kinds,
            },
        ));
        out.push(list("width", "Width", lane.width_m, &WIDTHS_M, " m"));
        out.push(ToolOption::new(
            "",
            Control::Row(vec![
                ToolOption::button("add", "Add beside", "another lane like it, outside of it", true),
                ToolOption::button("drop", "Remove lane", "", road.left.len() + road.right.len() > 1),
            ]),
        ));
    }
    out.push(list(
        "limit",
        "Limit",
        road.limit_kph.unwrap_or(0.0),
        &LIMITS_KPH,
        " km/h",
    ));
    out.push(ToolOption::gap());
    out.push(ToolOption::new(
        "",
        Control::Row(vec![
            ToolOption::button(
                "crossing",
                "Crossing",
                "where the road was clicked; again takes it away",
                true,
            ),
            ToolOption::button(
                "stop",
                "Stop line",
                "where the road was clicked; again takes it away",
                true,
            ),
            ToolOption::button("split", "Split", "where the road was clicked", true),
            ToolOption::button("straighten", "Straighten", "", !road.via_m.is_empty()),
            ToolOption::button("turn", "Turn around", "the other direction of travel", true),
            ToolOption::button("redraw", "Draw anew", "what was painted on it goes", true),
            ToolOption::button("delete", "Delete", "", true),
        ]),
    ));
}

fn of_node(net: &RoadNetwork, node: &RoadNode, out: &mut Vec<ToolOption>) {
    let arms = net.arms(node.id).len();
    let what = match arms {
        0 | 1 => "End of a road".to_owned(),
        2 => "Joint of two roads".to_owned(),
        n => tf!("Junction of {n} roads", n = n),
    };
    out.push(ToolOption::text(what));
    let round = matches!(node.kind, NodeKind::Roundabout { .. });
    out.push(ToolOption::new(
        "node_kind",
        Control::Segments {
            chosen: usize::from(round),
            choices: NODES.to_vec(),
            columns: 2,
        },
    ));
    match node.kind {
        NodeKind::Plain { corner_m } => out.push(list("corner", "Corners", corner_m, &CORNERS_M, " m")),
        NodeKind::Roundabout { island_m, ring_m } => {
            out.push(list("island", "Island", island_m, &ISLANDS_M, " m"));
            out.push(list("ring", "Ring", ring_m, &RINGS_M, " m"));
        }
    }
    if arms == 2 {
        out.push(ToolOption::button(
            "join",
            "Make it one road",
            "takes the joint away",
            true,
        ));
    }
}

/// Lanes from left to right as one looks along the road: side, and place from the line outward.
fn lanes(road: &Road) -> impl Iterator<Item = (bool, usize)> {
    let left = (0..road.left.len()).rev().map(|i| (false, i));
    left.chain((0..road.right.len()).map(|i| (true, i)))
}

fn chosen_lane(road: &Road, hand: &RoadHand) -> Option<(bool, usize)> {
    let clicked = hand.lane.filter(|(right, i)| *i < road.side(*right).len());
    clicked.or_else(|| lanes(road).next())
}

/// The user set an option.
pub(super) fn set(seen: &RoadGeometry, hand: &mut RoadHand, id: &str, value: Value) -> Vec<Act> {
    let net = &*seen.net;
    match id {
        "draw" => return vec![Act::Ask("shape_street")],
        "recognise" => return vec![recognised()],
        _ => {}
    }
    if let Some(RoadPart::Node(node)) = hand.chosen {
        let node = net.node(node);
        return node.and_then(|n| set_node(*n, id, value)).into_iter().collect();
    }
    let road = hand.chosen.and_then(RoadPart::road).and_then(|id| net.road(id));
    let Some(road) = road.cloned() else {
        return Vec::new();
    };
    set_road(seen, road, hand, id, value).into_iter().collect()
}

fn pick(value: Value, all: &[f64]) -> Option<f64> {
    value.index().and_then(|i| all.get(i)).copied()
}

fn set_node(node: RoadNode, id: &str, value: Value) -> Option<Act> {
    let mut kind = node.kind;
    match (id, &mut kind) {
        ("join", _) => return Some(apply("Make one road", RoadChange::Join { node: node.id })),
        ("node_kind", kind) => {
            *kind = match value.index()? {
                0 => NodeKind::default(),
                _ => NodeKind::Roundabout {
                    island_m: 7.0,
                    ring_m: 6.5,
                },
            }
        }
        ("corner", NodeKind::Plain { corner_m }) => *corner_m = pick(value, &CORNERS_M)?,
        ("island", NodeKind::Roundabout { island_m, .. }) => *island_m = pick(value, &ISLANDS_M)?,
        ("ring", NodeKind::Roundabout { ring_m, .. }) => *ring_m = pick(value, &RINGS_M)?,
        _ => return None,
    }
    let node = RoadNode { kind, ..node };
    Some(apply("Change junction", RoadChange::PutNode { node }))
}

fn set_road(seen: &RoadGeometry, mut road: Road, hand: &mut RoadHand, id: &str, value: Value) -> Option<Act> {
    let put = |label, road| Some(apply(label, RoadChange::Put { road }));
    let lane = chosen_lane(&road, hand);
    match id {
        "lane" => {
            hand.lane = value.index().and_then(|i| lanes(&road).nth(i));
            None
        }
        "kind" | "width" | "add" | "drop" => {
            let (right, i) = lane?;
            let side = road.side_mut(right);
            match id {
                "kind" => {
                    let kind = LaneKind::ALL.get(value.index()?)?.0;
                    side[i] = RoadLane::usual(kind);
                }
                "width" => side[i].width_m = pick(value, &WIDTHS_M)?,
                "add" => {
                    side.insert(i + 1, side[i]);
                    hand.lane = Some((right, i + 1));
                }
                _ => {
                    side.remove(i);
                    hand.lane = None;
                }
            }
            put("Change lanes", road)
        }
        "limit" => {
            road.limit_kph = Some(pick(value, &LIMITS_KPH)?).filter(|v| *v > 0.0);
            put("Change speed limit", road)
        }
        "crossing" | "stop" => {
            let (along_m, left_m) = place(seen, road.id, hand.at_m)?;
            mark(&mut road, id == "stop", along_m, left_m);
            put("Change road marks", road)
        }
        "split" => {
            let at_m = hand.at_m;
            hand.chosen = None;
            Some(apply("Split road", RoadChange::Split { id: road.id, at_m }))
        }
        "straighten" => Some(apply("Straighten road", RoadChange::Straighten { id: road.id })),
        "turn" => {
            hand.lane = None;
            put("Turn road around", road.turned())
        }
        "redraw" => Some(apply("Draw road anew", RoadChange::Redraw { id: road.id })),
        "delete" => {
            hand.chosen = None;
            Some(apply("Delete road", RoadChange::Remove { id: road.id }))
        }
        _ => None,
    }
}

fn place(seen: &RoadGeometry, id: RoadId, at_m: DVec2) -> Option<(f64, f64)> {
    curve::project(seen.lines.get(&id)?, at_m)
}

/// Puts a mark at a place along a road, or takes away the one that is there.
fn mark(road: &mut Road, stop: bool, along_m: f64, left_m: f64) {
    const NEAR_M: f64 = 2.5;
    if stop {
        let right = left_m < 0.0;
        let before = road.stops.len();
        road.stops
            .retain(|s| s.right != right || (s.at_m - along_m).abs() > NEAR_M);
        if road.stops.len() == before {
            road.stops.push(RoadStop { at_m: along_m, right });
        }
        return;
    }
    let before = road.crossings.len();
    road.crossings.retain(|c| (c.at_m - along_m).abs() > NEAR_M);
    if road.crossings.len() == before {
        road.crossings.push(RoadCrossing {
            at_m: along_m,
            width_m: CROSSING_M,
        });
    }
}
