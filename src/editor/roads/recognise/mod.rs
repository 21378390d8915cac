//! Roads recognised in a layout: the middle of the paved area becomes lines and nodes, and its cross-sections become
//! lanes. No cell changes.
//!
//! The middle is found by thinning (Zhang and Suen 1984, "A Fast Parallel Algorithm for Thinning Digital Patterns"). Lane
//! middles and dividers of the layout, where there are any, say which lanes there are; elsewhere the width does.

mod across;
mod fit;
mod mask;
mod rings;
mod skeleton;

use glam::DVec2;

use scene::roads::NodeId;
use scene::{BevLayout, RoadNetwork};

use super::add::snap;
use mask::Mask;

/// Columns within this distance of the network's own roads belong to them, m.
const OWN_RIM_M: f64 = 1.2;

/// The network, extended by the roads that are painted in a layout and not in it yet.
pub fn recognise(layout: &BevLayout, known: &RoadNetwork) -> RoadNetwork {
    let owners: Vec<_> = known.owners();
    let own = match owners.is_empty() {
        true => Vec::new(),
        false => known.surface_of(layout.extent(), &owners, OWN_RIM_M),
    };
    let Some(mask) = Mask::from_layout(layout, &own) else {
        return known.clone();
    };
    let mut graph = skeleton::trace(&mask);
    let rings = rings::take(&mut graph, &mask);
    let found = fit::network(&graph, &rings, &mask, layout);
    join(known, found)
}

/// Joins the two networks: free ends of `found` that come to a known road meet it there.
fn join(known: &RoadNetwork, found: RoadNetwork) -> RoadNetwork {
    let mut net = known.clone();
    if net.is_empty() {
        return found;
    }
    let nodes: Vec<(NodeId, NodeId)> = found
        .nodes
        .iter()
        .map(|n| {
            let is_end = found.arms(n.id).len() == 1;
            let met = is_end.then(|| meeting(&mut net, &found, n.id, n.at_m)).flatten();
            let now = met.unwrap_or_else(|| {
                let id = net.add_node(n.at_m);
                if let Some(node) = net.node_mut(id) {
                    node.kind = n.kind;
                }
                id
            });
            (n.id, now)
        })
        .collect();
    for road in found.roads {
        let ends = road
            .ends
            .map(|e| nodes.iter().find(|n| n.0 == e).map_or(e, |n| n.1));
        if ends[0] != ends[1] || road.via_m.len() > 1 {
            net.add_road(scene::Road { ends, ..road });
        }
    }
    net.tidy();
    net
}

/// The node of a known network that a free end leads to, straight on within the longest of `AHEAD_M`; `None` if it
/// leads to none.
fn meeting(net: &mut RoadNetwork, found: &RoadNetwork, node: NodeId, at_m: DVec2) -> Option<NodeId> {
    const AHEAD_M: [f64; 5] = [0.0, 2.0, 4.0, 6.0, 9.0];
    let arm = *found.arms(node).first()?;
    let points = found.points_m(found.road(arm.road)?);
    let inner = if arm.end == 0 {
        points.get(1)?
    } else {
        points.iter().rev().nth(1)?
    };
    let way = (at_m - *inner).normalize_or_zero();
    AHEAD_M
        .into_iter()
        .find_map(|d| snap(net, at_m + way * d).ok().flatten())
}
