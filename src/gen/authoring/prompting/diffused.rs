//! Boxes by diffusion and projection; rules then place the objects that were left out or break a statement.

use std::collections::{BTreeMap, BTreeSet};

use super::Diffused;
use graph_layout::diffuse::{PlacementError, STEPS, place_with as place_by_network};
use nets::layout::net::LayoutNet;
use place::lanes::LaneMap;
use place::road;
use place::rules::{Placement, broken, place_with};
use place::to_graph::Graphed;
use scene::graph::{GraphEdge, LaneRole, Locked, NodeKind, ObjectState, SceneGraph};
use scene::{BevLayout, SceneBox};

/// Distance from the middle of its stated lane from which on a vehicle drives between two lanes, m.
const ASTRAY_M: f64 = 1.0;

/// Boxes of the network; those that the projection could not repair are placed by rules around the others. While a
/// statement still does not hold, the things that it names are placed again too, and finally everything: statements
/// take precedence over the network. Of these placements, the first that breaks the fewest is taken.
pub(super) fn diffuse_and_mend(
    net: &LayoutNet,
    graphed: &Graphed,
    layout: &BevLayout,
    others: &[SceneBox],
    seed: u64,
) -> Result<(Placement, Diffused), PlacementError> {
    let (boxes, report) = place_by_network(net, &graphed.graph, &graphed.sizes_m, layout, STEPS, seed)?;
    let moved = &report.projection.moved;
    let mut diffused = Diffused {
        mean_move_m: report.projection.mean_move_m(boxes.len()),
        most_move_m: moved.iter().map(|m| m.distance_m).fold(0.0, f64::max),
        report,
        by_rules: 0,
    };
    let found: BTreeMap<u32, SceneBox> = diffused.report.nodes.iter().copied().zip(boxes).collect();
    let map = LaneMap::new(layout);
    let bad = |id: &u32, b: &SceneBox| {
        road::misplaced(layout, &[*b]) > 0 || is_between_lanes(&graphed.graph, &map, *id, b)
    };
    let mut free: BTreeSet<u32> = diffused
        .report
        .projection
        .broken
        .iter()
        .map(|e| e.from)
        .chain(broken(&graphed.graph, layout, &found))
        .chain(found.iter().filter(|(id, b)| bad(id, b)).map(|f| *f.0))
        .collect();
    let mut best: Option<(Placement, usize)> = None;
    for last in [false, false, true] {
        let mut graph = graphed.graph.clone();
        for node in &mut graph.nodes {
            if let (None, Some(b)) = (&node.locked, found.get(&node.id))
                && !free.contains(&node.id)
                && !last
            {
                node.locked = Some(Locked::Box(*b));
            }
        }
        let by_rules = graph
            .nodes
            .iter()
            .filter(|n| n.locked.is_none() && matches!(n.kind, NodeKind::Object(_)))
            .count();
        let placement = place_with(&graph, layout, seed, &graphed.sizes_m, others);
        let bound: Vec<u32> = placement
            .unmet
            .iter()
            .map(|i| graph.edges[*i])
            .chain(left_out(&graph, &placement))
            .flat_map(|e| [Some(e.from), Some(e.to), e.and])
            .flatten()
            .collect();
        if best.as_ref().is_none_or(|(b, _)| placement.cost() < b.cost()) {
            best = Some((placement, by_rules));
        }
        if bound.is_empty() {
            break;
        }
        free.extend(bound);
    }
    let (placement, by_rules) = best.unwrap_or_default();
    diffused.by_rules = by_rules;
    Ok((placement, diffused))
}

/// Statements about things that found no place.
fn left_out(graph: &SceneGraph, placement: &Placement) -> Vec<GraphEdge> {
    let out: BTreeSet<u32> = placement.left_out.iter().map(|l| l.0).collect();
    let of = |e: &&GraphEdge| out.contains(&e.from);
    graph.edges.iter().filter(of).copied().collect()
}

/// True for a vehicle whose lane was stated, that does not stand at the lane's edge and is not in its middle.
fn is_between_lanes(graph: &SceneGraph, map: &LaneMap<'_>, id: u32, b: &SceneBox) -> bool {
    use LaneRole as L;
    let lane = |e: &&GraphEdge| {
        let to = graph.node(e.to).map(|n| &n.kind);
        e.from == id
            && matches!(
                to,
                Some(NodeKind::Lane {
                    role: L::Ego | L::Left | L::Right | L::Oncoming | L::Cross,
                    ..
                })
            )
    };
    let still = graph.object(id).and_then(|o| o.state) == Some(ObjectState::Parked);
    let p = b.center_m.truncate();
    b.class.is_vehicle()
        && !still
        && graph.edges.iter().any(|e| lane(&e))
        && map
            .nearest(p)
            .is_some_and(|l| l.dir.perp_dot(p - l.p).abs() > ASTRAY_M)
}
