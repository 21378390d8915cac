//! A new road among others: where it begins, ends and crosses them there are nodes.

use glam::DVec2;

use scene::roads::{NodeId, NodeKind, curve};
use scene::{Road, RoadId, RoadNetwork, SceneBox};

use super::change::split_at;

/// An end so near to a node, or to the kerb of a road, is there, m.
const SNAP_M: f64 = 4.0;
/// A crossing so near to a node is there, m.
const NODE_M: f64 = 9.0;
/// Roads that meet at a smaller angle run side by side, rad.
const CROSSES_RAD: f64 = 0.35;
/// This share of a line on one road alone is too much for a new road.
const ALONG: f64 = 0.7;

/// Puts a road with the lanes of `like` in along points, m.
pub(super) fn add(net: &mut RoadNetwork, points_m: &[DVec2], like: Road) -> Result<(), String> {
    let points = curve::distinct(points_m);
    if points.len() < 2 {
        return Err(format!(
            "points_m holds {} distinct points, expected at least 2",
            points.len()
        ));
    }
    if points.len() > Road::MAX_VIA {
        return Err(format!(
            "points_m holds {} points, expected at most {}",
            points.len(),
            Road::MAX_VIA
        ));
    }
    let limit = DVec2::splat(SceneBox::LIMIT_M);
    if let Some(p) = points.iter().find(|p| !p.abs().cmple(limit).all()) {
        return Err(format!(
            "the road runs through {p}, expected numbers within 10000 m"
        ));
    }
    let straight_m = curve::length_m(&points);
    if straight_m > Road::MAX_M {
        return Err(format!(
            "the road is {straight_m:.0} m long, expected at most {:.0} m",
            Road::MAX_M
        ));
    }
    let line = curve::through(None, &points, None);
    let length_m = curve::length_m(&line);
    if let Some(road) = beside(net, &line) {
        return Err(format!(
            "the line runs along road {}: change the lanes of that one instead",
            road.0
        ));
    }
    let mut stations: Vec<(f64, NodeId)> = Vec::new();
    for (along, p) in [(0.0, points[0]), (length_m, points[points.len() - 1])] {
        let node = match snap(net, p)? {
            Some(node) => node,
            None => net.add_node(p),
        };
        stations.push((along, node));
    }
    cross(net, &line, &mut stations)?;
    stations.sort_by(|a, b| a.0.total_cmp(&b.0));
    stations.dedup_by(|b, a| a.1 == b.1);
    // A loop comes back to where it began.
    if stations.len() == 1 && points.len() > 3 {
        stations.push((length_m, stations[0].1));
    }
    if stations.len() < 2 {
        return Err("the road would end where it begins, expected it to lead somewhere".into());
    }
    let last = points.len() - 1;
    let inner: Vec<(f64, DVec2)> = points[1..last]
        .iter()
        .filter_map(|p| Some((curve::project(&line, *p)?.0, *p)))
        .collect();
    for [(from, a), (to, b)] in stations.array_windows::<2>().copied() {
        let within = inner.iter().filter(|(along, p)| {
            let clear = |n: NodeId| net.node(n).is_none_or(|n| n.at_m.distance(*p) > 1.0);
            *along > from && *along < to && clear(a) && clear(b)
        });
        let via_m = within.map(|(_, p)| *p).collect();
        net.add_road(Road {
            ends: [a, b],
            via_m,
            ..like.clone()
        });
    }
    net.tidy();
    Ok(())
}

/// The road along which most of a line runs.
fn beside(net: &RoadNetwork, line: &[DVec2]) -> Option<RoadId> {
    let length_m = curve::length_m(line);
    let steps = (length_m / 2.0).ceil().clamp(4.0, 200.0) as usize;
    let lines = net.lines();
    net.roads.iter().map(|r| r.id).find(|id| {
        let (road, of) = (net.road(*id), &lines[id]);
        let on = (0..=steps).filter(|k| {
            let (p, way) = curve::at(line, length_m * *k as f64 / steps as f64);
            curve::project(of, p).is_some_and(|(along, left)| {
                let reach = road.map_or(0.0, |r| r.kerb_m(left < 0.0, false));
                left.abs() < reach && curve::at(of, along).1.dot(way).abs() > CROSSES_RAD.cos()
            })
        });
        on.count() as f64 > ALONG * (steps + 1) as f64
    })
}

/// The node at which an end belongs; a road that it comes to is split there.
pub(super) fn snap(net: &mut RoadNetwork, p: DVec2) -> Result<Option<NodeId>, String> {
    let reach = |kind: NodeKind| match kind {
        NodeKind::Plain { .. } => SNAP_M,
        NodeKind::Roundabout { island_m, ring_m } => island_m + ring_m + SNAP_M,
    };
    let near = net.nodes.iter().filter(|n| n.at_m.distance(p) < reach(n.kind));
    if let Some(node) = near.min_by(|a, b| a.at_m.distance(p).total_cmp(&b.at_m.distance(p))) {
        return Ok(Some(node.id));
    }
    let Some(road) = net.road_at(p, SNAP_M / 2.0) else {
        return Ok(None);
    };
    match split_at(net, road, p) {
        Ok(node) => Ok(Some(node)),
        // Too near to an end: that end it is.
        Err(_) => Ok(nearest_end(net, road, p)),
    }
}

fn nearest_end(net: &RoadNetwork, road: RoadId, p: DVec2) -> Option<NodeId> {
    let ends = net.road(road)?.ends.into_iter().filter_map(|e| net.node(e));
    let nearest = ends.min_by(|a, b| a.at_m.distance(p).total_cmp(&b.at_m.distance(p)));
    nearest.map(|n| n.id)
}

/// Splits the roads that a line crosses, and notes where.
fn cross(net: &mut RoadNetwork, line: &[DVec2], stations: &mut Vec<(f64, NodeId)>) -> Result<(), String> {
    let mut open: Vec<RoadId> = net.roads.iter().map(|r| r.id).collect();
    let mut lines = net.axes();
    while let Some(id) = open.pop() {
        let Some(of) = lines.get(&id) else { continue };
        let all: Vec<(f64, f64)> = curve::crossings(line, of).collect();
        for (along, there) in all {
            let (p, way) = curve::at(line, along);
            let Some(road) = net.road(id) else { break };
            let end = road
                .ends
                .into_iter()
                .find(|e| net.node(*e).is_some_and(|n| n.at_m.distance(p) < NODE_M));
            let is_flat = curve::at(&lines[&id], there).1.dot(way).abs() > CROSSES_RAD.cos();
            if is_flat || end.is_some_and(|e| stations.iter().any(|(_, n)| *n == e)) {
                continue;
            }
            if let Some(end) = end {
                stations.push((along, end));
                continue;
            }
            let node = split_at(net, id, p)?;
            stations.push((along, node));
            // Both parts may cross the line again.
            lines = net.axes();
            open.push(id);
            open.extend(net.roads.last().map(|r| r.id));
            break;
        }
    }
    Ok(())
}
