//! From the graph of middles to roads and nodes.

use glam::DVec2;

use scene::roads::{NodeId, NodeKind, RoadCrossing, RoadStop, curve};
use scene::{BevLayout, PolylineKind, Road, RoadId, RoadNetwork};

use super::across::{self, Across};
use super::mask::Mask;
use super::rings::Ring;
use super::skeleton::{Chain, Graph};

/// A road's line keeps to the middle within this, m.
const TOLERANCE_M: f64 = 0.3;
/// Columns on either side over which the middle is averaged.
const SMOOTH: usize = 8;
/// Length by which roads that leave the map go on beyond it, m.
const BEYOND_M: f64 = 5.0;
/// Shorter roads are none, m.
const SHORTEST_M: f64 = 4.0;
/// A crossing or stop line so far from a road's line is another's, m.
const MARK_M: f64 = 3.0;

/// A road before its nodes are placed.
struct Draft {
    ends: [usize; 2],
    line: Vec<DVec2>,
    across: Across,
    trimmed: [bool; 2],
}

/// The network of a graph.
pub(super) fn network(graph: &Graph, rings: &[Ring], mask: &Mask, layout: &BevLayout) -> RoadNetwork {
    let drafts: Vec<Draft> = graph
        .chains
        .iter()
        .filter_map(|c| draft(graph, rings, c, mask, layout))
        .collect();
    let mut net = RoadNetwork::default();
    let mut nodes: Vec<(usize, NodeId)> = Vec::new();
    for (knot, place) in graph.knots.iter().enumerate() {
        let ring = rings.iter().find(|r| r.knot == knot);
        let arms: Vec<(DVec2, DVec2)> = drafts.iter().flat_map(|d| d.arms(knot)).collect();
        if arms.is_empty() {
            continue;
        }
        let at_m = match ring {
            Some(_) => place.at_m,
            None => meeting(&arms, place.at_m, place.depth_m),
        };
        let id = net.add_node(at_m);
        if let (Some(ring), Some(node)) = (ring, net.node_mut(id)) {
            node.kind = NodeKind::Roundabout {
                island_m: ring.island_m,
                ring_m: ring.ring_m,
            };
        }
        nodes.push((knot, id));
    }
    for draft in drafts {
        let node = |knot: usize| nodes.iter().find(|n| n.0 == knot).map(|n| n.1);
        let [Some(a), Some(b)] = draft.ends.map(node) else {
            continue;
        };
        let mut points = draft.line;
        // An end that is a node's own place is no point between.
        if !draft.trimmed[0] {
            points.remove(0);
        }
        if !draft.trimmed[1] {
            points.pop();
        }
        let ends = [a, b].map(|n| net.node(n).map_or(DVec2::ZERO, |n| n.at_m));
        let via_m = spare(ends, &points);
        let road = Road {
            id: RoadId(0),
            ends: [a, b],
            via_m,
            offset_m: 0.0,
            left: draft.across.left,
            right: draft.across.right,
            limit_kph: None,
            crossings: Vec::new(),
            stops: Vec::new(),
        };
        if a != b || road.via_m.len() > 1 {
            net.add_road(road);
        }
    }
    net.tidy();
    marks(&mut net, layout);
    net
}

impl Draft {
    /// Starting point and outward direction of the draft at a knot, once for each of its ends that lies there.
    fn arms(&self, knot: usize) -> Vec<(DVec2, DVec2)> {
        const HEADING_M: f64 = 10.0;
        let mut out = Vec::new();
        if self.ends[0] == knot {
            let ahead = curve::at(&self.line, HEADING_M.min(curve::length_m(&self.line))).0;
            out.push((self.line[0], (ahead - self.line[0]).normalize_or_zero()));
        }
        if self.ends[1] == knot {
            let length = curve::length_m(&self.line);
            let (last, back) = (
                self.line[self.line.len() - 1],
                curve::at(&self.line, (length - HEADING_M).max(0.0)).0,
            );
            out.push((last, (back - last).normalize_or_zero()));
        }
        out
    }
}

fn draft(graph: &Graph, rings: &[Ring], chain: &Chain, mask: &Mask, layout: &BevLayout) -> Option<Draft> {
    let smooth = smoothed(&chain.points_m);
    let length_m = curve::length_m(&smooth);
    let depth = |end: usize| graph.knots[chain.ends[end]].depth_m;
    let is_free =
        |end: usize| graph.degree(chain.ends[end]) == 1 && rings.iter().all(|r| r.knot != chain.ends[end]);
    // The middle bends within a junction, so its part there is left out.
    let mut back = [0, 1].map(|end| if is_free(end) { 0.0 } else { depth(end) });
    if rings.iter().any(|r| chain.ends.contains(&r.knot)) {
        let of_ring = |end: usize| rings.iter().find(|r| r.knot == chain.ends[end]);
        for (end, back) in back.iter_mut().enumerate() {
            // The chain begins on the ring already.
            if let Some(ring) = of_ring(end) {
                *back = ring.ring_m / 2.0 + 2.0;
            }
        }
    }
    let room = length_m - 4.0;
    if back[0] + back[1] > room {
        let share = (room / (back[0] + back[1])).clamp(0.0, 1.0);
        back = back.map(|b| b * share);
    }
    let mut middle = curve::part(&smooth, back[0], length_m - back[1]);
    if middle.len() < 2 {
        return None;
    }
    for end in [0, 1] {
        if end == 1 {
            middle.reverse();
        }
        if is_free(end) {
            finish_end(&mut middle, mask);
        }
        if end == 1 {
            middle.reverse();
        }
    }
    let simple = curve::simplified(&middle, TOLERANCE_M);
    let whole = curve::through(None, &simple, None);
    let is_short = curve::length_m(&whole) < SHORTEST_M && [0, 1].iter().any(|e| is_free(*e));
    let across = across::read(layout, &whole).filter(|_| !is_short)?;
    let mut line = curve::beside(&simple, across.left_m);
    let (mut ends, mut trimmed) = (chain.ends, [0, 1].map(|end| !is_free(end)));
    let mut across = across;
    if across.against {
        line.reverse();
        ends.reverse();
        trimmed.reverse();
        std::mem::swap(&mut across.left, &mut across.right);
    }
    Some(Draft {
        ends,
        line,
        across,
        trimmed,
    })
}

/// Finishes the first end of a line, at the kerb: beyond the border for a road that leaves the map, else at the end of
/// the paved area.
fn finish_end(middle: &mut Vec<DVec2>, mask: &Mask) {
    let inside = middle.iter().position(|p| mask.is_on_map(*p));
    if let Some(first) = inside.filter(|i| *i > 0) {
        middle.drain(..first);
        // Beyond the border the middle bends.
        let from = middle[0];
        let ahead = curve::at(middle, 8.0f64.min(curve::length_m(middle))).0;
        let way = (from - ahead).normalize_or_zero();
        middle.insert(0, from + way * BEYOND_M);
        return;
    }
    let from = middle[0];
    let ahead = curve::at(middle, 6.0f64.min(curve::length_m(middle))).0;
    let way = (from - ahead).normalize_or_zero();
    let reach = (0..80)
        .map(|k| f64::from(k) * 0.2)
        .take_while(|d| mask.depth_at(from + way * *d) > 0.0)
        .last();
    if let Some(reach) = reach.filter(|r| *r > 0.4) {
        middle.insert(0, from + way * reach);
    }
}

fn smoothed(points: &[DVec2]) -> Vec<DVec2> {
    let n = points.len();
    let mean = |i: usize| {
        let reach = SMOOTH.min(i).min(n - 1 - i);
        let near = &points[i - reach..=i + reach];
        near.iter().sum::<DVec2>() / near.len() as f64
    };
    curve::distinct(&(0..n).map(mean).collect::<Vec<_>>())
}

/// Points between two ends without those that lie on the way anyway.
fn spare(ends: [DVec2; 2], points: &[DVec2]) -> Vec<DVec2> {
    let all: Vec<DVec2> = std::iter::once(ends[0])
        .chain(points.iter().copied())
        .chain([ends[1]])
        .collect();
    let simple = curve::simplified(&curve::distinct(&all), TOLERANCE_M);
    simple
        .get(1..simple.len().saturating_sub(1))
        .unwrap_or_default()
        .to_vec()
}

/// Meeting point of lines: the point nearest to all of them; the place of the knot if they are parallel or meet far
/// from it.
fn meeting(arms: &[(DVec2, DVec2)], knot_m: DVec2, depth_m: f64) -> DVec2 {
    if let [(at, _)] = arms {
        return *at;
    }
    let (mut a, mut b) = (glam::DMat2::ZERO, DVec2::ZERO);
    for (at, way) in arms {
        let n = way.perp();
        let outer = glam::DMat2::from_cols(n * n.x, n * n.y);
        a += outer;
        b += outer * *at;
    }
    let middle = arms.iter().map(|(at, _)| *at).sum::<DVec2>() / arms.len() as f64;
    let point = if a.determinant().abs() > 0.05 {
        a.inverse() * b
    } else {
        middle
    };
    if point.distance(knot_m) < 2.0 * depth_m + 4.0 {
        point
    } else {
        knot_m
    }
}

/// Crossings and stop lines of a layout belong to the roads they lie on.
fn marks(net: &mut RoadNetwork, layout: &BevLayout) {
    let lines = net.lines();
    for mark in layout.polylines.iter() {
        if !matches!(mark.kind, PolylineKind::PedCrossing | PolylineKind::StopLine)
            || mark.points_m.is_empty()
        {
            continue;
        }
        let middle = mark.points_m.iter().sum::<DVec2>() / mark.points_m.len() as f64;
        let on = net.roads.iter().enumerate().filter_map(|(i, road)| {
            let line = &lines[&road.id];
            let (along, left) = curve::project(line, middle)?;
            let reach = road.kerb_m(left < 0.0, false) + MARK_M;
            (left.abs() < reach).then(|| (left.abs(), i, along, left, curve::at(line, along).1))
        });
        let Some((_, i, along, left, way)) = on.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        let road = &mut net.roads[i];
        match mark.kind {
            PolylineKind::StopLine => road.stops.push(RoadStop {
                at_m: along,
                right: left < 0.0,
            }),
            _ => {
                let offs = mark.points_m.iter().map(|p| (*p - middle).dot(way));
                let (low, high) = offs.fold((0.0f64, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
                road.crossings.push(RoadCrossing {
                    at_m: along,
                    width_m: (high - low).clamp(1.0, 12.0),
                });
            }
        }
    }
}
