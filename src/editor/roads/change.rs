//! Each change of a network as a function from one network to the next.

use glam::DVec2;

use scene::roads::{NodeId, RoadChange, RoadCrossing, RoadStop, curve};
use scene::{Road, RoadId, RoadNetwork};

use super::{add, wish};

/// A road is split no nearer to its ends, m.
const NEAREST_END_M: f64 = 2.0;
/// A bend keeps its shape where it is split by points so far on either side, m.
const HOLD_M: f64 = 3.0;

pub(super) fn changed(before: &RoadNetwork, change: &RoadChange) -> Result<RoadNetwork, String> {
    let mut net = before.clone();
    match change {
        RoadChange::Recognise {} | RoadChange::Redraw { .. } => {}
        RoadChange::Add {
            points_m,
            left,
            right,
            limit_kph,
        } => {
            let road = Road {
                id: RoadId(0),
                ends: [NodeId(0); 2],
                via_m: Vec::new(),
                offset_m: 0.0,
                left: left.clone(),
                right: right.clone(),
                limit_kph: *limit_kph,
                crossings: Vec::new(),
                stops: Vec::new(),
            };
            add::add(&mut net, points_m, road)?;
        }
        RoadChange::Put { road } => {
            let old = net.road_mut(road.id).ok_or_else(|| no_road(road.id))?;
            let ends = old.ends;
            *old = Road { ends, ..road.clone() };
        }
        RoadChange::PutNode { node } => {
            let old = net.node_mut(node.id).ok_or_else(|| no_node(node.id))?;
            *old = *node;
        }
        RoadChange::Split { id, at_m } => {
            split_at(&mut net, *id, *at_m)?;
        }
        RoadChange::Join { node } => join(&mut net, *node)?,
        RoadChange::Connect { node, to } => connect(&mut net, *node, *to)?,
        RoadChange::Wish {
            at_m,
            heading_deg,
            wish,
        } => wish::grant(&mut net, *at_m, *heading_deg, *wish)?,
        RoadChange::Straighten { id } => {
            let road = net.road_mut(*id).ok_or_else(|| no_road(*id))?;
            road.via_m.clear();
        }
        RoadChange::Remove { id } => {
            net.road(*id).ok_or_else(|| no_road(*id))?;
            net.roads.retain(|r| r.id != *id);
            net.tidy();
        }
    }
    Ok(net)
}

fn no_road(id: RoadId) -> String {
    format!("road {} does not exist in this scene", id.0)
}

fn no_node(id: NodeId) -> String {
    format!("node {} does not exist in this scene", id.0)
}

/// Splits a road near a point; the new node.
pub(super) fn split_at(net: &mut RoadNetwork, id: RoadId, at_m: DVec2) -> Result<NodeId, String> {
    let line = net.axes().remove(&id).ok_or_else(|| no_road(id))?;
    let (along_m, _) = curve::project(&line, at_m).ok_or_else(|| format!("road {} has no length", id.0))?;
    let length_m = curve::length_m(&line);
    // Written so that NaN fails too.
    if !(along_m >= NEAREST_END_M && along_m <= length_m - NEAREST_END_M) {
        let from_end = along_m.min(length_m - along_m);
        return Err(format!(
            "road {} would be split {from_end:.1} m from its end, expected at least {NEAREST_END_M} m",
            id.0
        ));
    }
    let node = net.add_node(curve::at(&line, along_m).0);
    let road = net.road_mut(id).ok_or_else(|| no_road(id))?;
    let whole = road.clone();
    let before = |p: &DVec2| curve::project(&line, *p).is_some_and(|(along, _)| along < along_m);
    let (mut first, mut second): (Vec<DVec2>, Vec<DVec2>) = whole.via_m.iter().partition(|p| before(p));
    // The line would bend otherwise than before without a point near the new end.
    let ways = [-HOLD_M, 0.0, HOLD_M].map(|d| curve::at(&line, along_m + d));
    if ways[0].1.dot(ways[2].1) < 0.9999 {
        let free = |points: Option<&DVec2>, p: DVec2| points.is_none_or(|q| q.distance(p) > HOLD_M);
        if along_m > 2.0 * HOLD_M && free(first.last(), ways[0].0) {
            first.push(ways[0].0);
        }
        if length_m - along_m > 2.0 * HOLD_M && free(second.first(), ways[2].0) {
            second.insert(0, ways[2].0);
        }
    }
    road.via_m = first;
    road.ends[1] = node;
    road.crossings.retain(|c| c.at_m <= along_m);
    road.stops.retain(|s| s.at_m <= along_m);
    let rest = Road {
        ends: [node, whole.ends[1]],
        via_m: second,
        crossings: later(&whole.crossings, along_m),
        stops: later_stops(&whole.stops, along_m),
        ..whole
    };
    net.add_road(rest);
    Ok(node)
}

fn later(all: &[RoadCrossing], from_m: f64) -> Vec<RoadCrossing> {
    let later = all.iter().filter(|c| c.at_m > from_m);
    later
        .map(|c| RoadCrossing {
            at_m: c.at_m - from_m,
            ..*c
        })
        .collect()
}

fn later_stops(all: &[RoadStop], from_m: f64) -> Vec<RoadStop> {
    let later = all.iter().filter(|s| s.at_m > from_m);
    later
        .map(|s| RoadStop {
            at_m: s.at_m - from_m,
            ..*s
        })
        .collect()
}

fn join(net: &mut RoadNetwork, node: NodeId) -> Result<(), String> {
    let place = *net.node(node).ok_or_else(|| no_node(node))?;
    let arms = net.arms(node);
    let [a, b] = arms.as_slice() else {
        return Err(format!(
            "{} roads end at node {}, expected two to join",
            arms.len(),
            node.0
        ));
    };
    if a.road == b.road {
        return Err(format!("road {} meets itself at node {}", a.road.0, node.0));
    }
    let lines = net.lines();
    // The first so that it ends here, the second so that it begins here.
    let turned = |arm: &scene::roads::Arm, end: usize| {
        let road = net.road(arm.road).ok_or_else(|| no_road(arm.road))?;
        let length_m = curve::length_m(&lines[&arm.road]);
        let road = if arm.end == end {
            road.clone()
        } else {
            road.reversed(length_m)
        };
        Ok::<_, String>((road, length_m))
    };
    let ((first, first_m), (second, second_m)) = (turned(a, 1)?, turned(b, 0)?);
    let like = if second_m > first_m { &second } else { &first };
    let mut via_m = first.via_m.clone();
    via_m.push(place.at_m);
    via_m.extend(&second.via_m);
    let shifted = |c: &RoadCrossing| RoadCrossing {
        at_m: c.at_m + first_m,
        ..*c
    };
    let shifted_stop = |s: &RoadStop| RoadStop {
        at_m: s.at_m + first_m,
        ..*s
    };
    let joined = Road {
        id: a.road,
        ends: [first.ends[0], second.ends[1]],
        via_m,
        offset_m: like.offset_m,
        left: like.left.clone(),
        right: like.right.clone(),
        limit_kph: like.limit_kph,
        crossings: first
            .crossings
            .iter()
            .copied()
            .chain(second.crossings.iter().map(shifted))
            .collect(),
        stops: first
            .stops
            .iter()
            .copied()
            .chain(second.stops.iter().map(shifted_stop))
            .collect(),
    };
    let gone = b.road;
    net.roads.retain(|r| r.id != gone);
    if let Some(road) = net.road_mut(joined.id) {
        *road = joined;
    }
    net.tidy();
    Ok(())
}

fn connect(net: &mut RoadNetwork, node: NodeId, to: NodeId) -> Result<(), String> {
    for id in [node, to] {
        net.node(id).ok_or_else(|| no_node(id))?;
    }
    if node == to {
        return Err(format!("node {} meets itself", node.0));
    }
    for end in net.roads.iter_mut().flat_map(|r| &mut r.ends) {
        if *end == node {
            *end = to;
        }
    }
    // A road between the two has no length left.
    net.roads.retain(|r| r.ends[0] != r.ends[1] || r.via_m.len() > 1);
    net.tidy();
    Ok(())
}
