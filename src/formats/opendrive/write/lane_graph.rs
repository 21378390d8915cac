//! The lanes of a layout and their connections, those of an OpenDRIVE file, as plain lines for other formats.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::network;
use super::roads::{End, WrittenRoad};
use super::strips::Strip;
use scene::BevLayout;
use scene::roads::curve::{distinct, length_m, simplified};

/// How far a line may be off the road's, m.
const OFF_M: f64 = 0.02;
/// A lane that is nowhere wider than this is dropped, m.
const NARROWEST_M: f64 = 0.5;
/// A lane shorter than this is dropped, m.
const SHORTEST_M: f64 = 0.5;
/// Halvings of a lane that is too wide for its bend.
const HALVINGS: usize = 4;

/// A lane, or a way through a junction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GraphLane {
    /// Number of its road.
    pub(crate) road: u32,
    /// Number of the junction that it leads through.
    pub(crate) junction: Option<u32>,
    /// Its middle in driving direction, frame of the layout, m.
    pub(crate) middle_m: Vec<DVec2>,
    /// Its left and right border in that direction. Neither they nor their ends cross.
    pub(crate) sides_m: [Vec<DVec2>; 2],
    /// Places of the lanes that lead into it.
    pub(crate) incoming: Vec<usize>,
    /// Places of the lanes that it leads into.
    pub(crate) outgoing: Vec<usize>,
}

/// The lanes of a layout, as far as they lie on its map.
pub(crate) fn lane_graph(layout: &BevLayout) -> Vec<GraphLane> {
    let (roads, _) = network(layout);
    let (mut lanes, mut place) = (Vec::new(), BTreeMap::new());
    for road in &roads {
        for strip in 0..road.strips.kinds.len() {
            if let Some(lane) = lane(layout, road, strip) {
                place.insert((road.id, road.lane_id(strip)), lanes.len());
                lanes.push(lane);
            }
        }
    }
    let mut leads = BTreeSet::new();
    for road in &roads {
        for (strip, kind) in road.strips.kinds.iter().enumerate() {
            let Strip::Lane { along, .. } = kind else { continue };
            let Some(&own) = place.get(&(road.id, road.lane_id(strip))) else {
                continue;
            };
            for (end, link) in road
                .ends
                .iter()
                .zip(road.links[strip])
                .enumerate()
                .map(|(i, (e, l))| ((i, e), l))
            {
                let ((i, Some(End::Road(id, _))), Some(lane)) = (end, link) else {
                    continue;
                };
                if let Some(&other) = place.get(&(*id, lane)) {
                    // Traffic leaves by the end that it drives towards.
                    leads.insert(match (i == 1) == *along {
                        true => (own, other),
                        false => (other, own),
                    });
                }
            }
        }
    }
    for (from, to) in leads {
        lanes[from].outgoing.push(to);
        lanes[to].incoming.push(from);
    }
    lanes
}

/// A strip of a road as a lane; `None` if it is no lane, or has no length or width on the map.
fn lane(layout: &BevLayout, road: &WrittenRoad, strip: usize) -> Option<GraphLane> {
    let Strip::Lane { along, .. } = road.strips.kinds[strip] else {
        return None;
    };
    let extent = layout.extent();
    let (mut middle, mut width) = (Vec::new(), Vec::new());
    for (i, s) in road.s_m.iter().enumerate() {
        let base = road.reference.at(*s);
        let [left, right] = [strip, strip + 1].map(|b| road.strips.borders_m[b][i]);
        let at = base.offset((left + right) / 2.0);
        if left - right > NARROWEST_M && extent.column_at(at.x, at.y).is_some() {
            middle.push(at);
            width.push((at, left - right));
        }
    }
    if !along {
        middle.reverse();
    }
    let middle_m = simplified(&distinct(&middle), OFF_M);
    if middle_m.len() < 2 || length_m(&middle_m) < SHORTEST_M {
        return None;
    }
    // The width is the median of those at its stations: borders are for looking up, not for driving on.
    let mut widths: Vec<f64> = width.iter().map(|(_, w)| *w).collect();
    widths.sort_by(f64::total_cmp);
    let mut half_m = widths[widths.len() / 2] / 2.0;
    let mut sides_m = [half_m, -half_m].map(|left_m| beside(&middle_m, left_m));
    for _ in 0..HALVINGS {
        if is_simple(&outline(&sides_m)) {
            break;
        }
        half_m /= 2.0;
        sides_m = [half_m, -half_m].map(|left_m| beside(&middle_m, left_m));
    }
    is_simple(&outline(&sides_m)).then_some(GraphLane {
        road: road.id,
        junction: road.junction,
        middle_m,
        sides_m,
        incoming: Vec::new(),
        outgoing: Vec::new(),
    })
}

/// The outline of a lane, counter-clockwise: along its right border and back along the left one.
pub(crate) fn outline([left, right]: &[Vec<DVec2>; 2]) -> Vec<DVec2> {
    right.iter().chain(left.iter().rev()).copied().collect()
}

/// A line beside another, `left_m` to its left; places where it would run backwards are left out.
fn beside(line: &[DVec2], left_m: f64) -> Vec<DVec2> {
    let last = line.len() - 1;
    let way = |from: usize, to: usize| (line[to] - line[from]).normalize_or(DVec2::X);
    let mut out: Vec<DVec2> = Vec::with_capacity(line.len());
    for (i, p) in line.iter().enumerate() {
        let (before, after) = (
            way(i.max(1) - 1, i.max(1)),
            way(i.min(last - 1), i.min(last - 1) + 1),
        );
        let middle = (before + after).normalize_or(after);
        // In a bend the border is farther from the corner than from the sides.
        let at = *p + middle.perp() * left_m / middle.dot(after).max(0.5);
        match out.last() {
            Some(q) if (at - *q).dot(before) <= 0.0 && i > 0 && i < last => {}
            _ => out.push(at),
        }
    }
    distinct(&out)
}

/// True for a ring of at least three corners whose sides meet at their ends alone.
fn is_simple(ring: &[DVec2]) -> bool {
    let n = ring.len();
    let side = |i: usize| (ring[i % n], ring[(i + 1) % n]);
    let apart = |(a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)| {
        let turn = |o: DVec2, p: DVec2, q: DVec2| (p - o).perp_dot(q - o);
        let outside = a.min(b).cmpgt(c.max(d)).any() || c.min(d).cmpgt(a.max(b)).any();
        outside || turn(a, b, c) * turn(a, b, d) > 0.0 || turn(c, d, a) * turn(c, d, b) > 0.0
    };
    let folds = |i: usize| {
        let ((a, b), (_, c)) = (side(i), side(i + 1));
        (b - a).perp_dot(c - b).abs() < 1e-12 && (b - a).dot(c - b) <= 0.0
    };
    n >= 3
        && (0..n).all(|i| {
            let far = (i + 2..n).filter(|j| (j + 1) % n != i);
            !folds(i) && far.into_iter().all(|j| apart(side(i), side(j)))
        })
}

/// Roads from the middle of a map to places of its border.
#[cfg(test)]
pub(crate) fn star(arms: &[[f64; 2]]) -> BevLayout {
    use scene::roads::{LaneKind, NodeId, RoadId};
    use scene::{Extent, Road, RoadLane, RoadNetwork};
    let mut roads = RoadNetwork::default();
    let middle = roads.add_node(DVec2::new(2.0, 1.0));
    let lanes = || vec![RoadLane::usual(LaneKind::Drive)];
    for arm in arms {
        let end: NodeId = roads.add_node(DVec2::from_array(*arm));
        roads.add_road(Road {
            id: RoadId(0),
            ends: [end, middle],
            via_m: Vec::new(),
            offset_m: 0.0,
            left: lanes(),
            right: lanes(),
            limit_kph: None,
            crossings: Vec::new(),
            stops: Vec::new(),
        });
    }
    roads.draw(Extent::WINDOW).layout
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn lanes_lead_into_lanes_that_begin_where_they_end() {
        let arms = [[-45.0, 0.0], [45.0, 3.0], [4.0, 45.0], [0.0, -45.0]];
        for (arms, ways) in [(&arms[..2], 0), (&arms[..3], 4), (&arms[..], 8)] {
            let name = format!("{} arms", arms.len());
            let layout = star(arms);
            let lanes = lane_graph(&layout);
            assert!(lanes.len() >= 2, "{name}: {} lanes", lanes.len());
            let through = lanes.iter().filter(|l| l.junction.is_some()).count();
            assert!(through >= ways, "{name}: {through} ways through junctions");
            for (i, lane) in lanes.iter().enumerate() {
                assert!(is_simple(&outline(&lane.sides_m)), "{name} {i}");
                for next in &lane.outgoing {
                    assert!(lanes[*next].incoming.contains(&i));
                    let gap = lane.middle_m[lane.middle_m.len() - 1].distance(lanes[*next].middle_m[0]);
                    assert!(gap < 1.0, "{name}: {gap} m between {i} and {next}");
                }
                if lane.junction.is_some() {
                    assert!(
                        !lane.incoming.is_empty() && !lane.outgoing.is_empty(),
                        "{name} {i}"
                    );
                }
                // The left border is on the left.
                let middle = lane.middle_m.len() / 2;
                let (a, b) = (lane.middle_m[middle - 1], lane.middle_m[middle]);
                let left = lane.sides_m[0]
                    .iter()
                    .min_by(|p, q| p.distance(b).total_cmp(&q.distance(b)));
                assert!((b - a).perp_dot(*left.expect("a point") - a) > 0.0);
            }
        }
    }

    #[test]
    fn rings_that_cross_themselves_are_known() {
        let ring = |points: &[[f64; 2]]| points.iter().map(|p| DVec2::from_array(*p)).collect::<Vec<_>>();
        assert!(is_simple(&ring(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 2.0],
            [0.0, 2.0]
        ])));
        assert!(!is_simple(&ring(&[
            [0.0, 0.0],
            [4.0, 2.0],
            [4.0, 0.0],
            [0.0, 2.0]
        ])));
        assert!(!is_simple(&ring(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [2.0, 0.0],
            [2.0, 2.0]
        ])));
        assert!(!is_simple(&ring(&[[0.0, 0.0], [4.0, 0.0]])));
    }
}
