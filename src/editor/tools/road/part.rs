//! Parts of roads that can be chosen, and which of them lies under the pointer.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use scene::roads::{NodeId, curve};
use scene::{Road, RoadId, RoadNetwork};

/// Selected part of the roads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoadPart {
    /// A road.
    Road(RoadId),
    /// A point of a road between its ends.
    Via(RoadId, usize),
    /// A node, where roads end or meet.
    Node(NodeId),
}

impl RoadPart {
    /// The road, or the road of the point.
    pub fn road(self) -> Option<RoadId> {
        match self {
            Self::Road(id) | Self::Via(id, _) => Some(id),
            Self::Node(_) => None,
        }
    }
}

/// Selection of the road tool.
#[derive(Clone, Debug, Default)]
pub struct RoadHand {
    /// Selected part.
    pub chosen: Option<RoadPart>,
    /// Point of that click, m; additions to a road are made there.
    pub at_m: DVec2,
    /// The lane that was clicked: true right of the line, and its place from the line outward.
    pub lane: Option<(bool, usize)>,
}

/// A network and the lines of its roads.
#[derive(Clone, Debug, Default)]
pub(super) struct RoadGeometry {
    pub net: Arc<RoadNetwork>,
    pub lines: Arc<BTreeMap<RoadId, Vec<DVec2>>>,
}

impl RoadGeometry {
    pub fn from_network(net: Arc<RoadNetwork>) -> Self {
        let lines = Arc::new(net.lines());
        Self { net, lines }
    }
}

/// The part at a point: points of the chosen road come before nodes, nodes before roads.
pub(super) fn at(
    seen: &RoadGeometry,
    p_m: DVec2,
    reach_m: f64,
    chosen: Option<RoadPart>,
) -> Option<RoadPart> {
    let net = &*seen.net;
    let near = |q: DVec2| q.distance(p_m) <= reach_m;
    if let Some(road) = chosen.and_then(RoadPart::road).and_then(|id| net.road(id))
        && let Some(i) = road.via_m.iter().position(|p| near(*p))
    {
        return Some(RoadPart::Via(road.id, i));
    }
    let nodes = net.nodes.iter().filter(|n| near(n.at_m));
    let node = nodes.min_by(|a, b| a.at_m.distance(p_m).total_cmp(&b.at_m.distance(p_m)));
    node.map(|n| RoadPart::Node(n.id))
        .or_else(|| net.road_among(&seen.lines, p_m, 0.0).map(RoadPart::Road))
}

/// Index among the points of a road's line at which a place on it lies; `None` beside the line.
pub(super) fn on_line(seen: &RoadGeometry, id: RoadId, p_m: DVec2, reach_m: f64) -> Option<usize> {
    let (road, line) = (seen.net.road(id)?, seen.lines.get(&id)?);
    let (along_m, left_m) = curve::project(line, p_m)?;
    let before = |p: &&DVec2| curve::project(line, **p).is_some_and(|(along, _)| along < along_m);
    (left_m.abs() <= reach_m).then(|| road.via_m.iter().filter(before).count())
}

/// The lane of a road at a point.
pub(super) fn lane_at(seen: &RoadGeometry, road: &Road, p_m: DVec2) -> Option<(bool, usize)> {
    let (_, left_m) = curve::project(seen.lines.get(&road.id)?, p_m)?;
    let right = left_m < 0.0;
    let mut edge = 0.0;
    let lane = road.side(right).iter().position(|l| {
        edge += l.width_m;
        left_m.abs() <= edge
    });
    lane.map(|i| (right, i))
}
