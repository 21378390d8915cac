//! A description to a scene graph: counts expanded to nodes, places to lane, crossing and junction nodes.

use std::collections::BTreeMap;

use super::description::{Anchor, Density, Description, ObjectSpec, Stated};
use scene::Class;
use scene::graph::{GraphEdge, LaneRole, NodeKind, ObjectNode, ObjectState, RelationKind, SceneGraph};
use world::draw::Draw;

/// Most things of one kind in a scene.
pub const MOST_OF_ONE: u32 = 400;

/// A graph with its origin in the description.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graphed {
    /// The graph.
    pub graph: SceneGraph,
    /// Nodes of each object of the description.
    pub nodes: Vec<Vec<u32>>,
    /// Usual size of a node where its noun has one, m.
    pub sizes_m: BTreeMap<u32, [f64; 3]>,
    /// Nodes that only fill a busy scene.
    pub fill: Vec<u32>,
}

/// The graph of a description; `seed` varies the objects that fill a busy scene.
pub fn to_graph(d: &Description, seed: u64) -> Graphed {
    let mut out = Graphed {
        graph: SceneGraph::with_ego(),
        ..Graphed::default()
    };
    let add = |out: &mut Graphed, node: ObjectNode| {
        // Ids by hand: asking for the largest of many is slow.
        let id = out.graph.nodes.len() as u32;
        out.graph.nodes.push(scene::graph::GraphNode {
            id,
            kind: NodeKind::Object(node),
            locked: None,
        });
        id
    };
    for o in &d.foreground {
        let mut ids = Vec::new();
        for _ in 0..o.count.n.min(MOST_OF_ONE) {
            let id = add(
                &mut out,
                ObjectNode {
                    class: o.class,
                    state: o.state,
                    size: o.size,
                    label: o.label,
                },
            );
            if let Some(size) = o.size_m {
                out.sizes_m.insert(id, size);
            }
            ids.push(id);
        }
        out.nodes.push(ids);
    }
    fill(d, seed, &mut out);
    let mut places: Vec<(NodeKind, u32)> = Vec::new();
    let mut place = |out: &mut Graphed, kind: NodeKind| {
        if let Some((_, id)) = places.iter().find(|(k, _)| *k == kind) {
            return *id;
        }
        let id = out.graph.add(kind.clone());
        places.push((kind, id));
        id
    };
    for (i, o) in d.foreground.iter().enumerate() {
        for r in &o.relations {
            // If the other object has no place of its own, the relation is turned around: that object stands beside
            // this one, whose place was stated.
            if let (RelationKind::Near | RelationKind::NextTo, Anchor::Object(j), None) =
                (r.relation, r.anchor, r.distance_m)
                && j != i
                && d.foreground.get(j).is_some_and(|x| x.relations.is_empty())
                && o.relations
                    .iter()
                    .any(|x| x.anchor == Anchor::Ego && x.distance_m.is_some())
                && let Some(&to) = out.nodes.get(i).and_then(|n| n.first())
            {
                for from in out.nodes[j].clone() {
                    out.graph.edges.push(GraphEdge {
                        relation: r.relation,
                        from,
                        to,
                        and: None,
                        distance_m: None,
                    });
                }
                continue;
            }
            for (k, from) in out.nodes[i].clone().into_iter().enumerate() {
                let mut node = |out: &mut Graphed, a: &Anchor, second: bool| match a {
                    Anchor::Ego => Some(SceneGraph::EGO),
                    Anchor::Object(j) => {
                        let ids = out.nodes.get(*j)?;
                        // "two cyclists behind two buses": one each; "between two cars": the first and the second.
                        let index = if second && ids.len() > 1 {
                            (k + 1) % ids.len()
                        } else {
                            k % ids.len().max(1)
                        };
                        let index = if r.relation == RelationKind::Between {
                            usize::from(second).min(ids.len().saturating_sub(1))
                        } else {
                            index
                        };
                        ids.get(index).copied()
                    }
                    Anchor::Lane(role) => Some(place(
                        out,
                        NodeKind::Lane {
                            role: *role,
                            polyline: None,
                        },
                    )),
                    Anchor::Crossing => Some(place(out, NodeKind::Crossing { polyline: None })),
                    Anchor::Junction => Some(place(out, NodeKind::Junction)),
                };
                let Some(to) = node(&mut out, &r.anchor, false) else {
                    continue;
                };
                let and = r.and.as_ref().and_then(|a| node(&mut out, a, true));
                if from == to
                    || (r.relation == RelationKind::Between && and.is_none_or(|a| a == to || a == from))
                {
                    continue;
                }
                out.graph.edges.push(GraphEdge {
                    relation: r.relation,
                    from,
                    to,
                    and,
                    distance_m: r.distance_m.map(|d| (d + in_line_m(o, r, k)).min(1e6)),
                });
            }
        }
    }
    out
}

/// Extra distance of the `k`-th vehicle of a group from the first, m: two cars at a stated distance in one lane stand
/// one behind the other.
fn in_line_m(o: &ObjectSpec, r: &Stated, k: usize) -> f64 {
    const GAP_M: f64 = 2.5;
    let along = matches!(r.relation, RelationKind::InFrontOf | RelationKind::Behind);
    let lane = o.relations.iter().any(|r| {
        r.relation == RelationKind::On
            && matches!(
                r.anchor,
                Anchor::Lane(LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
            )
    });
    if k == 0 || !along || !lane || !o.class.is_vehicle() {
        return 0.0;
    }
    let length = o.size_m.or(o.class.typical_size_m()).map_or(5.0, |s| s[0]);
    k as f64 * (length + GAP_M)
}

/// Adds objects that a busy scene holds besides the named ones. Classes that were named or excluded stay as stated.
fn fill(d: &Description, seed: u64, out: &mut Graphed) {
    let mut draw = Draw::new(seed, "text fill");
    let wanted: &[(Class, u32, Option<ObjectState>)] = match d.density {
        Some(Density::Busy) => &[
            (Class::Car, 8, Some(ObjectState::Moving)),
            (Class::Truck, 1, Some(ObjectState::Moving)),
            (Class::Pedestrian, 5, None),
            (Class::Bicycle, 1, Some(ObjectState::Moving)),
        ],
        Some(Density::Jam) => &[
            (Class::Car, 12, Some(ObjectState::Waiting)),
            (Class::Truck, 2, Some(ObjectState::Waiting)),
            (Class::Bus, 1, Some(ObjectState::Waiting)),
        ],
        Some(Density::Light) => &[
            (Class::Car, 2, Some(ObjectState::Moving)),
            (Class::Pedestrian, 1, None),
        ],
        Some(Density::Empty) | None => &[],
    };
    let named: Vec<Class> = d.foreground.iter().map(|o| o.class).collect();
    for (class, n, state) in wanted {
        let denied = d.absent.iter().any(|a| a.classes.contains(class));
        let highway = d.road.kind == Some(super::description::Road::Highway)
            && matches!(class, Class::Pedestrian | Class::Bicycle);
        if named.contains(class) || denied || highway {
            continue;
        }
        let n = if *n > 2 { n - 1 + draw.below(3) as u32 } else { *n };
        for _ in 0..n {
            let id = out.graph.nodes.len() as u32;
            let mut node = ObjectNode::new(*class);
            node.state = *state;
            out.graph.nodes.push(scene::graph::GraphNode {
                id,
                kind: NodeKind::Object(node),
                locked: None,
            });
            out.fill.push(id);
        }
    }
}

/// A graph node of a class, for callers that lock boxes.
pub fn node_of(class: Class) -> NodeKind {
    NodeKind::Object(ObjectNode::new(class))
}

/// Lane roles that the graph needs.
pub fn roles(graph: &SceneGraph) -> Vec<LaneRole> {
    let mut roles: Vec<LaneRole> = graph
        .nodes
        .iter()
        .filter_map(|n| match n.kind {
            NodeKind::Lane { role, .. } => Some(role),
            _ => None,
        })
        .collect();
    roles.sort_unstable();
    roles.dedup();
    roles
}
