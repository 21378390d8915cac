//! Deviations of things from their stated distances: a place may fit and still be metres off.

use super::holds::{RelationReference, ego, from_m};
use super::lanes::LaneMap;
use scene::SceneBox;
use scene::graph::{NodeKind, SceneGraph};

/// Largest deviation at which a distance counts as stated, m.
pub const TOLERATED_M: f64 = 0.5;

/// A distance that differs from the stated one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// Index of the edge that states it.
    pub edge: usize,
    /// Distance that was stated, m.
    pub asked_m: f64,
    /// Distance that was found, m.
    pub found_m: f64,
}

/// The distances of a graph that its boxes do not keep; the id of each box is that of its node.
pub fn off(graph: &SceneGraph, map: &LaneMap<'_>, boxes: &[SceneBox]) -> Vec<Off> {
    let placed = |id: u32| boxes.iter().find(|b| b.id.0 == id);
    let target = |id: u32| {
        Some(match &graph.node(id)?.kind {
            NodeKind::Ego => RelationReference::Thing(ego()),
            NodeKind::Object(_) => RelationReference::Thing(*placed(id)?),
            NodeKind::Lane { role, .. } => RelationReference::Lane(*role),
            NodeKind::Crossing { .. } => RelationReference::Crossing,
            NodeKind::Junction => RelationReference::Junction,
        })
    };
    let of = |(i, e): (usize, &scene::graph::GraphEdge)| {
        let asked_m = e.distance_m?;
        let found_m = from_m(map, e.relation, placed(e.from)?, &target(e.to)?)?;
        let is_off = (found_m - asked_m).abs() > TOLERATED_M;
        is_off.then_some(Off {
            edge: i,
            asked_m,
            found_m,
        })
    };
    graph.edges.iter().enumerate().filter_map(of).collect()
}
