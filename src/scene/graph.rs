//! The scene graph: objects, lanes, crossings and the ego vehicle as nodes, what was said about them as typed relations.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{BoxLabel, Class, SceneBox};

/// Whether an object moves.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum ObjectState {
    /// Drives, rides or walks.
    Moving,
    /// Stands for long: at the kerb, in a car park, at a site.
    Parked,
    /// Stands in traffic: in a queue, at a line, at a kerb.
    Waiting,
}

impl ObjectState {
    /// All states.
    pub const ALL: [Self; 3] = [Self::Moving, Self::Parked, Self::Waiting];
}

/// Larger or smaller than usual for the class.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum SizeHint {
    /// Smaller than usual.
    Small,
    /// Larger than usual.
    Large,
}

/// One object; counts are expanded, one node each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectNode {
    /// One of [`Class::OBJECTS`].
    pub class: Class,
    /// Whether it moves, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<ObjectState>,
    /// Its size beside that of its class, if anything was said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeHint>,
    /// Name and paint, if any were stated. No geometry follows from it.
    #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
    pub label: BoxLabel,
}

impl ObjectNode {
    /// An object of which only the class is known.
    pub fn new(class: Class) -> Self {
        Self {
            class,
            state: None,
            size: None,
            label: BoxLabel::default(),
        }
    }
}

/// Which lane or strip, as seen from the ego vehicle.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum LaneRole {
    /// The lane that the ego vehicle drives in.
    Ego,
    /// The next lane to the left in the same direction.
    Left,
    /// The next lane to the right in the same direction.
    Right,
    /// A lane of the same road in the other direction.
    Oncoming,
    /// A lane of a road that crosses or joins.
    Cross,
    /// Any lane or junction area: drivable ground.
    Road,
    /// The strip beside the outermost lane: kerb, parking strip, shoulder.
    Roadside,
    /// The roadside left of the ego vehicle.
    LeftRoadside,
    /// The roadside right of the ego vehicle.
    RightRoadside,
    /// Any sidewalk.
    Sidewalk,
    /// The sidewalk left of the ego vehicle.
    LeftSidewalk,
    /// The sidewalk right of the ego vehicle.
    RightSidewalk,
    /// A car park.
    Carpark,
}

impl LaneRole {
    /// All roles.
    pub const ALL: [Self; 13] = [
        Self::Ego,
        Self::Left,
        Self::Right,
        Self::Oncoming,
        Self::Cross,
        Self::Road,
        Self::Roadside,
        Self::LeftRoadside,
        Self::RightRoadside,
        Self::Sidewalk,
        Self::LeftSidewalk,
        Self::RightSidewalk,
        Self::Carpark,
    ];
}

/// Kind of a node.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeKind {
    /// The ego vehicle, at the origin.
    Ego,
    /// A box.
    Object(ObjectNode),
    /// A lane or strip.
    Lane {
        /// Which, as seen from the ego vehicle.
        role: LaneRole,
        /// Index into the layout's polylines, if it is a certain one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        polyline: Option<u32>,
    },
    /// A pedestrian crossing.
    Crossing {
        /// Index into the layout's polylines, if it is a certain one; else the nearest ahead.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        polyline: Option<u32>,
    },
    /// The junction nearest to the ego vehicle.
    Junction,
}

/// Geometry that a layout must keep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Locked {
    /// Box of an object.
    Box(SceneBox),
    /// Line of a lane (in driving direction) or a crossing (outline), ego frame, m.
    Line(Vec<DVec2>),
}

/// A node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraphNode {
    /// Its id within the graph.
    pub id: u32,
    /// Kind.
    pub kind: NodeKind,
    /// Geometry to keep; `None` is to be placed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub locked: Option<Locked>,
}

/// Relation of one node to another. Left, right, front and behind are those of the other's heading where it has one
/// (ego, vehicles and two-wheelers, lanes), else those of the ego vehicle; thresholds in `relations.rs`.
#[expect(missing_docs, reason = "relations.rs defines each of them")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RelationKind {
    LeftOf,
    RightOf,
    InFrontOf,
    Behind,
    Near,
    FarFrom,
    NextTo,
    On,
    Between,
    Across,
    Blocking,
    Facing,
    FacingAway,
    Following,
    Crossing,
    ParkedOn,
    WaitingAt,
    SameDirection,
    OppositeDirection,
}

impl RelationKind {
    /// All relations; a network's embedding table is in this order.
    pub const ALL: [Self; 19] = [
        Self::LeftOf,
        Self::RightOf,
        Self::InFrontOf,
        Self::Behind,
        Self::Near,
        Self::FarFrom,
        Self::NextTo,
        Self::On,
        Self::Between,
        Self::Across,
        Self::Blocking,
        Self::Facing,
        Self::FacingAway,
        Self::Following,
        Self::Crossing,
        Self::ParkedOn,
        Self::WaitingAt,
        Self::SameDirection,
        Self::OppositeDirection,
    ];

    /// Name as in files: `left_of`.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; RelationKind::ALL.len()] = [
            "left_of",
            "right_of",
            "in_front_of",
            "behind",
            "near",
            "far_from",
            "next_to",
            "on",
            "between",
            "across",
            "blocking",
            "facing",
            "facing_away",
            "following",
            "crossing",
            "parked_on",
            "waiting_at",
            "same_direction",
            "opposite_direction",
        ];
        NAMES[self as usize]
    }
}

/// A statement: `from` stands in `relation` to `to`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraphEdge {
    /// Which relation.
    pub relation: RelationKind,
    /// Node whose place is described.
    pub from: u32,
    /// Node that it is described by.
    pub to: u32,
    /// The second node of `between`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub and: Option<u32>,
    /// Distance that was stated, m: along the heading for front and behind, across it for left and right, else
    /// between centres (or to the area).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

impl GraphEdge {
    /// A statement without distance.
    pub fn new(from: u32, relation: RelationKind, to: u32) -> Self {
        Self {
            relation,
            from,
            to,
            and: None,
            distance_m: None,
        }
    }
}

/// Nodes and the statements about them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneGraph {
    /// Nodes, with different ids; at most one is the ego vehicle.
    pub nodes: Vec<GraphNode>,
    /// Statements between nodes of the graph.
    pub edges: Vec<GraphEdge>,
}

impl SceneGraph {
    /// Id of the ego vehicle in graphs made by [`with_ego`](Self::with_ego).
    pub const EGO: u32 = 0;

    /// A graph of the ego vehicle alone.
    pub fn with_ego() -> Self {
        let mut graph = Self::default();
        graph.add(NodeKind::Ego);
        graph
    }

    /// Adds a node and returns its id: one more than the largest.
    pub fn add(&mut self, kind: NodeKind) -> u32 {
        let id = self
            .nodes
            .iter()
            .map(|n| n.id)
            .max()
            .map_or(0, |id| id.saturating_add(1));
        self.nodes.push(GraphNode {
            id,
            kind,
            locked: None,
        });
        id
    }

    /// Adds a statement without distance.
    pub fn relate(&mut self, from: u32, relation: RelationKind, to: u32) {
        self.edges.push(GraphEdge::new(from, relation, to));
    }

    /// The node of that id.
    pub fn node(&self, id: u32) -> Option<&GraphNode> {
        self.nodes.iter().find(|n| n.id == id)
    }

    /// The object of that id.
    pub fn object(&self, id: u32) -> Option<&ObjectNode> {
        self.node(id).and_then(|n| match &n.kind {
            NodeKind::Object(o) => Some(o),
            _ => None,
        })
    }

    /// Ids and objects, in order.
    pub fn objects(&self) -> impl Iterator<Item = (u32, &ObjectNode)> {
        self.nodes.iter().filter_map(|n| match &n.kind {
            NodeKind::Object(o) => Some((n.id, o)),
            _ => None,
        })
    }

    /// The first problem with the graph, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let mut seen = std::collections::BTreeSet::new();
        for node in &self.nodes {
            let id = node.id;
            if !seen.insert(id) {
                return Some(format!("node {id}: the id is there twice"));
            }
            let fits = match (&node.kind, &node.locked) {
                (_, None) => true,
                (NodeKind::Object(o), Some(Locked::Box(b))) => {
                    if let Some(problem) = b.problem() {
                        return Some(format!("node {id}: {problem}"));
                    }
                    o.class == b.class
                }
                (NodeKind::Lane { .. } | NodeKind::Crossing { .. }, Some(Locked::Line(points))) => {
                    points.len() >= 2 && points.iter().all(|p| p.is_finite())
                }
                _ => false,
            };
            if !fits {
                return Some(format!("node {id}: the locked geometry does not fit the node"));
            }
            if let NodeKind::Object(o) = &node.kind
                && !o.class.is_object()
            {
                let name = o.class.name();
                return Some(format!(
                    "node {id}: class is {name:?}, expected one of the ten object classes"
                ));
            }
        }
        if self.nodes.iter().filter(|n| n.kind == NodeKind::Ego).count() > 1 {
            return Some("the graph has more than one ego vehicle".into());
        }
        for e in &self.edges {
            let name = e.relation.name();
            let missing = [Some(e.from), Some(e.to), e.and].into_iter().flatten();
            if let Some(id) = missing.into_iter().find(|id| !seen.contains(id)) {
                return Some(format!("relation {name}: node {id} does not exist"));
            }
            if e.from == e.to {
                return Some(format!("relation {name}: node {} is related to itself", e.from));
            }
            if e.distance_m.is_some_and(|d| !d.is_finite() || d < 0.0) {
                return Some(format!(
                    "relation {name}: distance_m is {:?}, expected 0 or more",
                    e.distance_m
                ));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_serde() {
        for relation in RelationKind::ALL {
            let json = serde_json::to_string(&relation).expect("serializable");
            assert_eq!(json, format!("\"{}\"", relation.name()));
        }
        for (i, relation) in RelationKind::ALL.into_iter().enumerate() {
            assert_eq!(relation as usize, i);
        }
    }

    #[test]
    fn problems_are_named() {
        let mut graph = SceneGraph::with_ego();
        let car = graph.add(NodeKind::Object(ObjectNode::new(Class::Car)));
        graph.relate(car, RelationKind::InFrontOf, SceneGraph::EGO);
        assert_eq!(graph.problem(), None);
        let text = serde_json::to_string(&graph).expect("serializable");
        assert_eq!(
            serde_json::from_str::<SceneGraph>(&text).expect("readable"),
            graph
        );
        let broken = |change: &dyn Fn(&mut SceneGraph)| {
            let mut graph = graph.clone();
            change(&mut graph);
            graph.problem().expect("a problem")
        };
        assert!(broken(&|g| g.edges[0].to = 9).contains("node 9 does not exist"));
        assert!(broken(&|g| g.edges[0].to = car).contains("itself"));
        assert!(broken(&|g| g.edges[0].distance_m = Some(f64::NAN)).contains("distance_m"));
        assert!(broken(&|g| g.nodes[1].id = 0).contains("twice"));
        assert!(broken(&|g| g.nodes[1].kind = NodeKind::Ego).contains("more than one"));
        assert!(broken(&|g| g.nodes[1].locked = Some(Locked::Line(vec![]))).contains("locked"));
        assert!(
            broken(&|g| g.nodes[1].kind = NodeKind::Object(ObjectNode::new(Class::Free))).contains("free")
        );
    }
}
