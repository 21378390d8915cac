//! Checks after words were carried out: deviations from stated distances, and collisions.

use super::prompting::Laid;
use place::lanes::LaneMap;
use place::off::off;

/// Most collisions that an answer names.
const MOST_CLASHES: usize = 4;

/// The collisions, in a line; `None` if there are none.
pub(crate) fn told(clashes: &[String]) -> Option<String> {
    let more = clashes.len().saturating_sub(MOST_CLASHES);
    let mut named = clashes[..clashes.len() - more].join("; ");
    if more > 0 {
        named += &format!("; and {more} more");
    }
    (!named.is_empty()).then(|| format!("collisions: {named}"))
}

/// Deviations from stated distances, in words, one line each.
pub fn off_by(made: &Laid) -> Vec<String> {
    let graph = &made.graphed.graph;
    let map = LaneMap::new(&made.road.layout);
    let mut out = Vec::new();
    for x in off(graph, &map, &made.placement.boxes) {
        let edge = &graph.edges[x.edge];
        let objects = made.description.foreground.iter().zip(&made.graphed.nodes);
        let Some((o, _)) = objects.into_iter().find(|(_, nodes)| nodes.contains(&edge.from)) else {
            continue;
        };
        // (of several in a line the first stands at the stated place)
        let mut stated = o.relations.iter().filter_map(|r| r.distance_m);
        if stated.any(|s| (s - x.asked_m).abs() < 1e-9) {
            out.push(format!(
                "{}: {}, {:.1} m in place of {:.1} m",
                o.called(),
                edge.relation.name().replace('_', " "),
                x.found_m,
                x.asked_m
            ));
        }
    }
    out
}
