//! The network as a whole: looking up its parts, finding the roads that continue each other, and the course of each
//! road.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{NodeId, NodeKind, Road, RoadChange, RoadId, RoadNode, curve};
use crate::Pose;

/// Largest bend at which two roads at a junction continue each other, rad.
const GOES_ON_RAD: f64 = 0.7;

/// Roads and the nodes at which they end, world frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadNetwork {
    /// Nodes, by number.
    #[serde(default)]
    pub nodes: Vec<RoadNode>,
    /// Roads, by number.
    #[serde(default)]
    pub roads: Vec<Road>,
}

/// One end of a road, as it is seen from the node there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arm {
    /// The road.
    pub road: RoadId,
    /// 0: the road begins here; 1: it ends here.
    pub end: usize,
}

impl RoadNetwork {
    /// Most roads, and most nodes.
    pub const MOST: usize = 20_000;

    /// True if there is no road.
    pub fn is_empty(&self) -> bool {
        self.roads.is_empty()
    }

    /// The road of that number.
    pub fn road(&self, id: RoadId) -> Option<&Road> {
        self.roads.iter().find(|r| r.id == id)
    }

    /// The road of that number.
    pub fn road_mut(&mut self, id: RoadId) -> Option<&mut Road> {
        self.roads.iter_mut().find(|r| r.id == id)
    }

    /// The node of that number.
    pub fn node(&self, id: NodeId) -> Option<&RoadNode> {
        self.nodes.iter().find(|n| n.id == id)
    }

    /// The node of that number.
    pub fn node_mut(&mut self, id: NodeId) -> Option<&mut RoadNode> {
        self.nodes.iter_mut().find(|n| n.id == id)
    }

    /// Adds a plain node and returns its number.
    pub fn add_node(&mut self, at_m: DVec2) -> NodeId {
        let id = NodeId(self.nodes.iter().map(|n| n.id.0 + 1).max().unwrap_or(1));
        self.nodes.push(RoadNode {
            id,
            at_m,
            kind: NodeKind::default(),
        });
        id
    }

    /// Adds a road under the next free number, which it returns.
    pub fn add_road(&mut self, road: Road) -> RoadId {
        let id = RoadId(self.roads.iter().map(|r| r.id.0 + 1).max().unwrap_or(1));
        self.roads.push(Road { id, ..road });
        id
    }

    /// Ends of roads at a node, in the order of roads.
    pub fn arms(&self, node: NodeId) -> Vec<Arm> {
        let ends = self.roads.iter().flat_map(|r| [0, 1].map(|end| (r, end)));
        let here = ends.filter(|(r, end)| r.ends[*end] == node);
        here.map(|(r, end)| Arm { road: r.id, end }).collect()
    }

    /// All points that define a road's line, with its ends, m.
    pub fn points_m(&self, road: &Road) -> Vec<DVec2> {
        let end = |i: usize| self.node(road.ends[i]).map(|n| n.at_m);
        end(0)
            .into_iter()
            .chain(road.via_m.iter().copied())
            .chain(end(1))
            .collect()
    }

    /// Pairs of arms that continue each other at a node: the two of a joint, and at a junction those that bend least.
    fn pairs(&self, index: &Index<'_>, node: &RoadNode, arms: &[Arm]) -> Vec<[Arm; 2]> {
        if let NodeKind::Roundabout { .. } = node.kind {
            return Vec::new();
        }
        if let [a, b] = arms {
            return vec![[*a, *b]];
        }
        let way = |a: &Arm| {
            let next = index.next_m(*a);
            next.map_or(DVec2::ZERO, |p| (p - node.at_m).normalize_or_zero())
        };
        let mut found: Vec<(f64, [Arm; 2])> = Vec::new();
        for (i, a) in arms.iter().enumerate() {
            found.extend(arms[i + 1..].iter().map(|b| (way(a).dot(way(b)), [*a, *b])));
        }
        found.retain(|(cos, _)| *cos < -GOES_ON_RAD.cos());
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut out: Vec<[Arm; 2]> = Vec::new();
        for (_, pair) in found {
            if !out.iter().flatten().any(|a| pair.contains(a)) {
                out.push(pair);
            }
        }
        out
    }

    /// The roads that continue each other through a road, along its line; true for those that run in the opposite
    /// direction.
    pub fn street(&self, id: RoadId) -> Vec<(RoadId, bool)> {
        let (mut out, index) = (vec![(id, false)], Index::of(self));
        for forward in [false, true] {
            out.reverse();
            // From the outermost known road through its far node.
            while let Some((last, turned)) = out.last().copied() {
                let end = usize::from(forward != turned);
                let here = Arm { road: last, end };
                let Some(node) = self.road(last).and_then(|r| self.node(r.ends[end])) else {
                    break;
                };
                let pairs = self.pairs(&index, node, &self.arms(node.id));
                let next = pairs.into_iter().find_map(|[a, b]| match here {
                    h if h == a => Some(b),
                    h if h == b => Some(a),
                    _ => None,
                });
                let Some(next) = next.filter(|n| out.iter().all(|o| o.0 != n.road)) else {
                    break;
                };
                // It continues along its line if this node is its beginning.
                out.push((next.road, (next.end == 1) == forward));
            }
        }
        out
    }

    /// The line from which each road's lanes are counted on both sides, from its beginning to its end, m: its line,
    /// shifted by its offset. There is no kink where roads continue each other.
    pub fn lines(&self) -> BTreeMap<RoadId, Vec<DVec2>> {
        let mut out = self.axes();
        for road in self.roads.iter().filter(|r| r.offset_m != 0.0) {
            if let Some(line) = out.get_mut(&road.id) {
                *line = curve::beside(line, road.offset_m);
            }
        }
        out
    }

    /// The line of every road through its points, m.
    pub fn axes(&self) -> BTreeMap<RoadId, Vec<DVec2>> {
        let index = Index::of(self);
        let mut beyond: BTreeMap<(RoadId, usize), DVec2> = BTreeMap::new();
        for node in &self.nodes {
            let arms = index.arms.get(&node.id).map_or(&[][..], |a| a);
            for [a, b] in self.pairs(&index, node, arms) {
                for (from, to) in [(a, b), (b, a)] {
                    if let Some(p) = index.next_m(to) {
                        beyond.insert((from.road, from.end), p);
                    }
                }
            }
        }
        let line = |r: &Road| {
            let ghost = |end| beyond.get(&(r.id, end)).copied();
            let end = |i: usize| index.nodes.get(&r.ends[i]).map(|n| n.at_m);
            let points: Vec<DVec2> = end(0)
                .into_iter()
                .chain(r.via_m.iter().copied())
                .chain(end(1))
                .collect();
            (r.id, curve::through(ghost(0), &points, ghost(1)))
        };
        self.roads.iter().map(line).collect()
    }

    /// The road whose surface a point lies on or within `slack_m` of; of several, the one whose middle is nearest.
    pub fn road_at(&self, p_m: DVec2, slack_m: f64) -> Option<RoadId> {
        self.road_among(&self.lines(), p_m, slack_m)
    }

    /// The road that [`road_at`](Self::road_at) finds, with the lines given.
    pub fn road_among(
        &self,
        lines: &BTreeMap<RoadId, Vec<DVec2>>,
        p_m: DVec2,
        slack_m: f64,
    ) -> Option<RoadId> {
        let on = self.roads.iter().filter_map(|r| {
            let (_, left_m) = curve::project(lines.get(&r.id)?, p_m)?;
            let (right, left) = (r.kerb_m(true, true), r.kerb_m(false, true));
            let inside = left_m <= left + slack_m && -left_m <= right + slack_m;
            inside.then(|| ((left_m - (left - right) / 2.0).abs(), r.id))
        });
        on.min_by(|a, b| a.0.total_cmp(&b.0)).map(|b| b.1)
    }

    /// Removes nodes at which no road ends.
    pub fn tidy(&mut self) {
        let used: BTreeSet<NodeId> = self.roads.iter().flat_map(|r| r.ends).collect();
        self.nodes.retain(|n| used.contains(&n.id));
    }

    /// This network in another frame: `pose` is that of this frame in the other one.
    pub fn in_frame(&self, pose: &Pose) -> Self {
        let mut out = self.clone();
        let there = |p: DVec2| pose.apply(p.extend(0.0)).truncate();
        out.nodes.iter_mut().for_each(|n| n.at_m = there(n.at_m));
        out.roads
            .iter_mut()
            .flat_map(|r| &mut r.via_m)
            .for_each(|p| *p = there(*p));
        out
    }

    /// The reason why it cannot be used, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        if self.roads.len().max(self.nodes.len()) > Self::MOST {
            let (roads, nodes) = (self.roads.len(), self.nodes.len());
            return Some(format!(
                "the network has {roads} roads and {nodes} nodes, expected at most {}",
                Self::MOST
            ));
        }
        let mut nodes: Vec<u32> = self.nodes.iter().map(|n| n.id.0).collect();
        let mut roads: Vec<u32> = self.roads.iter().map(|r| r.id.0).collect();
        for (what, ids) in [("node", &mut nodes), ("road", &mut roads)] {
            ids.sort_unstable();
            if let Some([id, _]) = ids.array_windows::<2>().find(|[a, b]| a == b) {
                return Some(format!("there are two of {what} {id}"));
            }
            if ids.last() == Some(&u32::MAX) {
                return Some(format!("{what} {} has the last number there is", u32::MAX));
            }
        }
        for road in &self.roads {
            let lost = road.ends.iter().find(|e| nodes.binary_search(&e.0).is_err());
            if let Some(end) = lost {
                return Some(format!(
                    "road {} ends at node {}, which does not exist",
                    road.id.0, end.0
                ));
            }
        }
        if let Some(problem) = self.too_long() {
            return Some(problem);
        }
        let bad_road = self.roads.iter().find_map(Road::problem);
        bad_road.or_else(|| self.nodes.iter().find_map(RoadNode::problem))
    }
}

/// Roads, nodes and arms by number, for fast look-ups.
struct Index<'a> {
    roads: BTreeMap<RoadId, &'a Road>,
    nodes: BTreeMap<NodeId, &'a RoadNode>,
    arms: BTreeMap<NodeId, Vec<Arm>>,
}

impl<'a> Index<'a> {
    fn of(net: &'a RoadNetwork) -> Self {
        let mut arms: BTreeMap<NodeId, Vec<Arm>> = BTreeMap::new();
        for road in &net.roads {
            for end in [0, 1] {
                arms.entry(road.ends[end])
                    .or_default()
                    .push(Arm { road: road.id, end });
            }
        }
        Self {
            roads: net.roads.iter().map(|r| (r.id, r)).collect(),
            nodes: net.nodes.iter().map(|n| (n.id, n)).collect(),
            arms,
        }
    }

    /// The next point that defines the line, from a node along an arm.
    fn next_m(&self, arm: Arm) -> Option<DVec2> {
        let road = self.roads.get(&arm.road)?;
        let other = || self.nodes.get(&road.ends[1 - arm.end]).map(|n| n.at_m);
        match arm.end {
            0 => road.via_m.first().copied().or_else(other),
            _ => road.via_m.last().copied().or_else(other),
        }
    }
}

impl RoadNetwork {
    /// Greatest length of all roads together, m.
    pub const MAX_M: f64 = 2_000_000.0;

    fn too_long(&self) -> Option<String> {
        let index = Index::of(self);
        let mut all_m = 0.0;
        for road in &self.roads {
            let end = |i: usize| index.nodes.get(&road.ends[i]).map(|n| n.at_m);
            let points: Vec<DVec2> = end(0)
                .into_iter()
                .chain(road.via_m.iter().copied())
                .chain(end(1))
                .collect();
            let length_m = curve::length_m(&points);
            if length_m > Road::MAX_M {
                let most = Road::MAX_M;
                return Some(format!(
                    "road {} is {length_m:.0} m long, expected at most {most:.0} m",
                    road.id.0
                ));
            }
            all_m += length_m;
        }
        (all_m > Self::MAX_M).then(|| {
            format!(
                "the network is {all_m:.0} m long, expected at most {:.0} m",
                Self::MAX_M
            )
        })
    }
}

impl RoadChange {
    /// This change in another frame: `pose` is that of this frame in the other one, `turn_deg` its heading.
    pub fn in_frame(self, pose: &Pose, turn_deg: f64) -> Self {
        let there = |p: DVec2| pose.apply(p.extend(0.0)).truncate();
        match self {
            Self::Add {
                points_m,
                left,
                right,
                limit_kph,
            } => Self::Add {
                points_m: points_m.into_iter().map(there).collect(),
                left,
                right,
                limit_kph,
            },
            Self::Put { mut road } => {
                road.via_m.iter_mut().for_each(|p| *p = there(*p));
                Self::Put { road }
            }
            Self::PutNode { node } => Self::PutNode {
                node: RoadNode {
                    at_m: there(node.at_m),
                    ..node
                },
            },
            Self::Split { id, at_m } => Self::Split {
                id,
                at_m: there(at_m),
            },
            Self::Wish {
                at_m,
                heading_deg,
                wish,
            } => Self::Wish {
                at_m: there(at_m),
                heading_deg: heading_deg + turn_deg,
                wish,
            },
            other => other,
        }
    }
}
