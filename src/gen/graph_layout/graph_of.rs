//! The scene graph of a finished scene: its lanes, crossings and objects as nodes, some of its true statements as
//! edges. Data for the layout network and for the memory bank.

use std::collections::BTreeMap;

use glam::DVec2;

use scene::graph::{
    GraphEdge, LaneRole, Locked, NodeKind, ObjectNode, ObjectState, RelationKind, SceneGraph, SizeHint,
};
use scene::relations::{PlacedGraph, STANDING_MPS};
use scene::road_map::RoadMap;
use scene::{BoxId, Class, SceneBox};
use world::draw::Draw;

/// Most lanes, crossings and objects of such a graph; with the ego vehicle, a junction and five strips at most 64 nodes.
pub const MOST: [usize; 3] = [12, 4, 41];
/// Most edges.
pub const MOST_EDGES: usize = 112;

/// Strips that occur in graphs.
pub const STRIPS: [LaneRole; 5] = [
    LaneRole::LeftRoadside,
    LaneRole::RightRoadside,
    LaneRole::LeftSidewalk,
    LaneRole::RightSidewalk,
    LaneRole::Carpark,
];

/// Number of neighbours that are looked for, per object.
const NEIGHBOURS: usize = 3;

/// The graph of a scene, with every node locked at its place, and the box of each object node. `seed` selects the true
/// statements that are made.
pub fn graph_of(
    road: &RoadMap,
    boxes: &BTreeMap<BoxId, SceneBox>,
    seed: u64,
) -> (SceneGraph, BTreeMap<u32, SceneBox>) {
    let mut draw = Draw::new(seed, "graph");
    let mut graph = SceneGraph::with_ego();
    add_road(&mut graph, road);
    let mut nearest: Vec<&SceneBox> = boxes.values().filter(|b| b.problem().is_none()).collect();
    nearest.sort_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()));
    nearest.truncate(MOST[2]);
    let mut placed = BTreeMap::new();
    for b in nearest {
        let mut object = ObjectNode::new(b.class);
        object.state = Some(state_of(road, b));
        object.size = size_of(b);
        object.label = b.label;
        let id = graph.add(NodeKind::Object(object));
        if let Some(node) = graph.nodes.last_mut() {
            node.locked = Some(Locked::Box(*b));
        }
        placed.insert(id, *b);
    }
    let edges = statements(&graph, &placed, road, &mut draw);
    graph.edges = edges;
    (graph, placed)
}

/// Adds the lanes (the ego's own, its neighbours, then the longest), crossings, strips and the junction of a map.
pub fn add_road(graph: &mut SceneGraph, road: &RoadMap) {
    let rank = |role: LaneRole| match role {
        LaneRole::Ego => 0,
        LaneRole::Left | LaneRole::Right => 1,
        LaneRole::Oncoming => 2,
        _ => 3,
    };
    let mut lanes: Vec<usize> = (0..road.lanes.len()).collect();
    lanes.sort_by_key(|i| {
        let lane = &road.lanes[*i];
        let inside = lane.points_m.iter().filter(|p| p.abs().max_element() <= 40.0);
        (rank(lane.role), std::cmp::Reverse(inside.count()), *i)
    });
    for i in lanes.into_iter().take(MOST[0]) {
        let lane = &road.lanes[i];
        let points = visible(&lane.points_m);
        if points.len() >= 2 {
            graph.add(NodeKind::Lane {
                role: lane.role,
                polyline: Some(lane.polyline),
            });
            if let Some(node) = graph.nodes.last_mut() {
                node.locked = Some(Locked::Line(points));
            }
        }
    }
    for crossing in road.crossings.iter().take(MOST[1]) {
        graph.add(NodeKind::Crossing {
            polyline: Some(crossing.polyline),
        });
        if let Some(node) = graph.nodes.last_mut() {
            node.locked = Some(Locked::Line(crossing.outline_m.clone()));
        }
    }
    for role in STRIPS {
        graph.add(NodeKind::Lane { role, polyline: None });
    }
    if !road.junctions_m.is_empty() {
        graph.add(NodeKind::Junction);
    }
}

/// The longest run of points within the grid.
pub fn visible(points_m: &[DVec2]) -> Vec<DVec2> {
    let runs = points_m.split(|p| p.is_nan() || p.abs().max_element() > 40.0);
    runs.max_by_key(|run| run.len())
        .map(<[DVec2]>::to_vec)
        .unwrap_or_default()
}

/// State of an object (moving, waiting in traffic or parked), judged by speed and place.
pub fn state_of(road: &RoadMap, b: &SceneBox) -> ObjectState {
    let p = b.center_m.truncate();
    if b.velocity_mps.length() > STANDING_MPS {
        return ObjectState::Moving;
    }
    let in_lane = road
        .nearest_lane(p)
        .is_some_and(|l| l.distance_m < 1.2 && l.direction.dot(b.heading()).abs() > 0.9);
    if in_lane || b.class == Class::Pedestrian {
        ObjectState::Waiting
    } else {
        ObjectState::Parked
    }
}

fn size_of(b: &SceneBox) -> Option<SizeHint> {
    let typical = b.class.typical_size_m()?;
    let share = b.size_m.x * b.size_m.z / (typical[0] * typical[2]);
    match share {
        s if s < 0.9 => Some(SizeHint::Small),
        s if s > 1.1 => Some(SizeHint::Large),
        _ => None,
    }
}

/// Weight of a true statement of that kind.
fn weight(relation: RelationKind) -> f64 {
    match relation {
        RelationKind::FarFrom | RelationKind::FacingAway | RelationKind::SameDirection => 0.1,
        RelationKind::Facing
        | RelationKind::OppositeDirection
        | RelationKind::Near
        | RelationKind::Across => 0.3,
        _ => 1.0,
    }
}

fn statements(
    graph: &SceneGraph,
    boxes: &BTreeMap<u32, SceneBox>,
    road: &RoadMap,
    draw: &mut Draw,
) -> Vec<GraphEdge> {
    let placed = PlacedGraph { graph, boxes, road };
    let surroundings: Vec<u32> = graph
        .nodes
        .iter()
        .filter(|n| !matches!(n.kind, NodeKind::Object(_)))
        .map(|n| n.id)
        .collect();
    let mut edges = Vec::new();
    for (id, b) in boxes {
        let mut others: Vec<(f64, u32)> = boxes
            .iter()
            .filter(|(other, _)| *other != id)
            .map(|(other, o)| (o.center_m.distance(b.center_m), *other))
            .collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        let neighbours: Vec<u32> = others.iter().take(NEIGHBOURS).map(|o| o.1).collect();
        let mut found: Vec<(f64, GraphEdge)> = Vec::new();
        for to in surroundings.iter().chain(&neighbours) {
            for relation in RelationKind::ALL {
                let edge = GraphEdge::new(*id, relation, *to);
                if relation != RelationKind::Between && placed.satisfied(&edge) {
                    found.push((weight(relation), edge));
                }
            }
        }
        if let [a, c, ..] = neighbours[..] {
            let edge = GraphEdge {
                and: Some(c),
                ..GraphEdge::new(*id, RelationKind::Between, a)
            };
            if placed.satisfied(&edge) {
                found.push((1.0, edge));
            }
        }
        for _ in 0..1 + draw.below(4) {
            let weights: Vec<f64> = found.iter().map(|f| f.0).collect();
            if found.is_empty() {
                break;
            }
            let mut edge = found.swap_remove(draw.weighted(&weights)).1;
            let measurable = matches!(
                edge.relation,
                RelationKind::InFrontOf | RelationKind::Behind | RelationKind::LeftOf | RelationKind::RightOf
            );
            if measurable && draw.chance(0.3) {
                edge.distance_m = measured(&placed, &edge);
            }
            edges.push(edge);
        }
    }
    while edges.len() > MOST_EDGES {
        edges.swap_remove(draw.below(edges.len()));
    }
    edges
}

/// The distance that the statement could state, m.
fn measured(placed: &PlacedGraph<'_>, edge: &GraphEdge) -> Option<f64> {
    let (from, (to, at)) = (placed.thing(edge.from)?.0, placed.thing(edge.to)?);
    let (axis, d) = (scene::relations::course(&to), from.center_m.truncate() - at);
    Some(match edge.relation {
        RelationKind::LeftOf | RelationKind::RightOf => axis.perp_dot(d).abs(),
        _ => axis.dot(d).abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::{template, traffic};

    #[test]
    fn statements_are_true_and_repeatable() {
        let mut kinds = std::collections::BTreeSet::new();
        for seed in 0..16 {
            let name = template::TEMPLATES[seed as usize % template::TEMPLATES.len()];
            let layout = template::layout(name, seed).expect("listed");
            let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
            let road = RoadMap::new(&layout);
            let (graph, placed) = graph_of(&road, &boxes, seed);
            assert_eq!(graph.problem(), None, "{name}");
            assert!(graph.nodes.len() <= 64);
            assert!(road.ego_lane.is_some(), "{name} {seed}");
            assert_eq!(graph, graph_of(&road, &boxes, seed).0);
            let view = PlacedGraph {
                graph: &graph,
                boxes: &placed,
                road: &road,
            };
            for edge in &graph.edges {
                assert!(view.satisfied(edge), "{name}: {edge:?}");
                kinds.insert(edge.relation);
            }
        }
        assert!(kinds.len() >= 14, "{kinds:?}");
    }
}
