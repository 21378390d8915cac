//! Junctions: rounded corners between neighbouring arms, and the distance along each arm at which its markings begin.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{Arm, LaneKind, NodeId, NodeKind, Road, RoadId, RoadNetwork, RoadNode, curve, ring};

/// Distance from the node at which an arm's heading is read, m.
const HEADING_M: f64 = 8.0;
/// Distance along an arm within which corners are looked for, m.
const REACH_M: f64 = 70.0;
/// Largest part of an arm that a corner takes, m; the next constant is its largest share.
const CORNER_M: f64 = 25.0;
const CORNER_SHARE: f64 = 0.45;
/// Distance before the corner at which markings end, m.
const CLEAR_M: f64 = 0.6;

/// Geometry that the nodes of a network draw, and the part of each road that belongs to them.
#[derive(Debug, Default)]
pub(super) struct JunctionGeometry {
    /// Distance that markings keep from an end of a road, m.
    pub setback_m: BTreeMap<(RoadId, usize), f64>,
    /// Distance that they keep on one side of the road, m: true is the right of its line.
    pub side_m: BTreeMap<(RoadId, usize, bool), f64>,
    /// Outlines of carriageway.
    pub paved: Vec<Vec<DVec2>>,
    /// Lines with the width of the walkway on either side of them, m.
    pub walks: Vec<(Vec<DVec2>, f64)>,
    /// Islands: middle and radius, m. Nothing is drawn there.
    pub islands: Vec<(DVec2, f64)>,
    /// Middles of the nodes' own lanes, in driving direction.
    pub lanes: Vec<(NodeId, Vec<DVec2>)>,
}

/// An arm as a node sees it.
pub(super) struct JunctionArm<'a> {
    pub arm: Arm,
    pub road: &'a Road,
    /// Its line from the node outward, m.
    pub out_m: Vec<DVec2>,
    pub length_m: f64,
}

impl JunctionArm<'_> {
    /// Side of the road that is on the given side of an arm, looking outward: true for the road's right side.
    pub fn side(&self, left: bool) -> bool {
        (self.arm.end == 1) == left
    }

    /// The kerb on one side looking outward, m; parking strips count as carriageway.
    pub fn kerb(&self, left: bool) -> Vec<DVec2> {
        let off = self.road.kerb_m(self.side(left), true);
        let line = curve::part(&self.out_m, 0.0, REACH_M);
        curve::beside(&line, if left { off } else { -off })
    }

    /// Width of the walkway behind the kerb on one side looking outward, m.
    pub fn walk_m(&self, left: bool) -> f64 {
        let lanes = self.road.side(self.side(left));
        let walks = lanes.iter().filter(|l| l.kind == LaneKind::Walk);
        walks.map(|l| l.width_m).sum()
    }

    fn heading_rad(&self) -> f64 {
        let from = self.out_m.first().copied().unwrap_or_default();
        (curve::at(&self.out_m, HEADING_M.min(self.length_m)).0 - from).to_angle()
    }
}

/// Geometry that all nodes draw.
pub(super) fn corners(net: &RoadNetwork, lines: &BTreeMap<RoadId, Vec<DVec2>>) -> JunctionGeometry {
    let mut out = JunctionGeometry::default();
    let mut at: BTreeMap<NodeId, Vec<(Arm, &Road)>> = BTreeMap::new();
    for road in &net.roads {
        for end in [0, 1] {
            let arm = Arm { road: road.id, end };
            at.entry(road.ends[end]).or_default().push((arm, road));
        }
    }
    for node in &net.nodes {
        let mut arms: Vec<JunctionArm<'_>> = at
            .get(&node.id)
            .into_iter()
            .flatten()
            .filter_map(|(arm, road)| seen(road, lines, *arm))
            .collect();
        arms.sort_by(|a, b| a.heading_rad().total_cmp(&b.heading_rad()));
        match node.kind {
            NodeKind::Roundabout { island_m, ring_m } => {
                ring::draw(node, &arms, [island_m, ring_m], &mut out)
            }
            NodeKind::Plain { corner_m } if arms.len() > 2 => junction(node, &arms, corner_m, &mut out),
            NodeKind::Plain { .. } => {}
        }
    }
    out
}

fn seen<'a>(road: &'a Road, lines: &BTreeMap<RoadId, Vec<DVec2>>, arm: Arm) -> Option<JunctionArm<'a>> {
    let mut out_m = lines.get(&arm.road)?.clone();
    if arm.end == 1 {
        out_m.reverse();
    }
    let length_m = curve::length_m(&out_m);
    (out_m.len() > 1).then_some(JunctionArm {
        arm,
        road,
        out_m,
        length_m,
    })
}

fn junction(node: &RoadNode, arms: &[JunctionArm<'_>], corner_m: f64, out: &mut JunctionGeometry) {
    for (i, a) in arms.iter().enumerate() {
        let b = &arms[(i + 1) % arms.len()];
        let (kerb_a, kerb_b) = (a.kerb(true), b.kerb(false));
        let Some((at_a, at_b)) = curve::crossing(&kerb_a, &kerb_b) else {
            // Arms side by side: there is no corner, but each reaches as far as the other is wide.
            continue;
        };
        let (meet, way_a) = curve::at(&kerb_a, at_a);
        let (_, way_b) = curve::at(&kerb_b, at_b);
        let half = way_a.angle_to(way_b).abs() / 2.0;
        let room = |seen: &JunctionArm<'_>, at: f64| (seen.length_m * CORNER_SHARE - at).clamp(0.0, CORNER_M);
        let reach = (corner_m / half.tan().max(0.05))
            .min(room(a, at_a))
            .min(room(b, at_b));
        let (from, to) = (
            curve::at(&kerb_a, at_a + reach).0,
            curve::at(&kerb_b, at_b + reach).0,
        );
        let round = curve::corner(from, meet, to);
        let walk_m = a.walk_m(true).min(b.walk_m(false));
        if walk_m > 0.0 {
            out.walks.push((round.clone(), walk_m));
        }
        if reach > 0.0 {
            out.paved.push(std::iter::once(meet).chain(round).collect());
        }
        for (seen, left, end) in [(a, true, from), (b, false, to)] {
            set_back(out, seen, left, end);
        }
    }
    // The middle between corners of sharp angles that lie wide apart belongs to none of them.
    let middle: Vec<DVec2> = arms
        .iter()
        .flat_map(|a| [true, false].map(|left| a.kerb(left).first().copied()))
        .flatten()
        .chain([node.at_m])
        .collect();
    out.paved.push(curve::hull(&middle));
}

/// Makes the markings of an arm begin beyond a point beside it, on its left or right, looking outward.
pub(super) fn set_back(out: &mut JunctionGeometry, seen: &JunctionArm<'_>, left: bool, beside_m: DVec2) {
    let along = curve::project(&seen.out_m, beside_m).map_or(0.0, |p| p.0);
    let reach = (along + CLEAR_M).min(seen.length_m * 0.5);
    let arm = seen.arm;
    let at = out.setback_m.entry((arm.road, arm.end)).or_default();
    *at = at.max(reach);
    let side = out
        .side_m
        .entry((arm.road, arm.end, seen.side(left)))
        .or_default();
    *side = side.max(reach);
}
