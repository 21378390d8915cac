//! Input of the layout network: nodes, edges and the map as numbers. Training data and inference share this file.

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use scene::graph::{GraphNode, LaneRole, Locked, NodeKind, SceneGraph, SizeHint};
use scene::road_map::{RoadMap, resampled};
use scene::{BoxId, BoxLabel, Class, SceneBox};

/// Points of a lane.
pub const POINTS: usize = 8;
/// Numbers of a box: centre (3), log size (3), sine and cosine of the yaw.
pub const BOX: usize = 8;
/// Numbers of a node: a box, then a lane.
pub const VALUES: usize = BOX + 2 * POINTS;
/// Cells of the map along x and y, 0.8 m each.
pub const MAP_SIDE: usize = 100;
/// Numbers of a map cell.
pub const MAP_CHANNELS: usize = 8;
/// Kinds of nodes; 0 is none.
pub const KINDS: usize = 27;

/// Kind of geometry of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum NodeGeometry {
    /// None of its own: ego vehicle, strips, junction.
    None = 0,
    /// Objects and crossings.
    Box = 1,
    /// Lanes.
    Line = 2,
}

impl NodeGeometry {
    /// The part of a node's numbers that it uses.
    pub fn channels(self) -> Range<usize> {
        match self {
            NodeGeometry::None => 0..0,
            NodeGeometry::Box => 0..BOX,
            NodeGeometry::Line => BOX..VALUES,
        }
    }
}

/// A node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeInput {
    /// Kind: 1 ego, 2 to 11 objects in the order of [`Class::OBJECTS`], 12 to 24 lanes in the order of
    /// [`LaneRole::ALL`], 25 crossing, 26 junction.
    pub kind: u8,
    /// State: 0 unknown, else 1 + the state's place in its list.
    pub state: u8,
    /// Size: 0 not stated, 1 small, 2 large.
    pub size: u8,
    /// Kind of its geometry.
    pub shape: NodeGeometry,
    /// True if `values` are given and stay.
    pub locked: bool,
    /// Its geometry in the network's units; 0 where it is not given.
    pub values: [f32; VALUES],
}

/// An edge; a relation `between` is two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeInput {
    /// Index of a node.
    pub from: u16,
    /// Index of a node.
    pub to: u16,
    /// Place in [`RelationKind::ALL`](scene::graph::RelationKind::ALL).
    pub relation: u8,
    /// The stated distance, m.
    pub distance_m: Option<f32>,
}

/// Complete input apart from the noise.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutInput {
    /// Nodes, in the order of the graph.
    pub nodes: Vec<NodeInput>,
    /// Edges.
    pub edges: Vec<EdgeInput>,
    /// The map as [`map_raster`] gives it; `None` if the road is to be made too.
    pub map: Option<Arc<Vec<u8>>>,
}

/// Number of a node's kind.
pub fn kind_of(kind: &NodeKind) -> u8 {
    let place = |found: Option<usize>| found.unwrap_or(0) as u8;
    match kind {
        NodeKind::Ego => 1,
        NodeKind::Object(o) => 2 + place(Class::OBJECTS.iter().position(|c| *c == o.class)),
        NodeKind::Lane { role, .. } => 12 + place(LaneRole::ALL.iter().position(|r| r == role)),
        NodeKind::Crossing { .. } => 25,
        NodeKind::Junction => 26,
    }
}

/// Size that the logarithms of a kind's sizes are relative to, m.
pub fn typical_size_m(kind: u8) -> DVec3 {
    const CROSSING: [f64; 3] = [3.2, 12.0, 0.1];
    let class = usize::from(kind)
        .checked_sub(2)
        .and_then(|i| Class::OBJECTS.get(i));
    DVec3::from_array(class.and_then(|c| c.typical_size_m()).unwrap_or(CROSSING))
}

/// Metres of the map per unit of the network.
pub const UNIT_M: f64 = 20.0;
const HEIGHT_UNIT_M: f64 = 0.3;
const LOG_UNIT: f64 = 0.2;

/// A box in the network's units.
pub fn box_values(kind: u8, b: &SceneBox) -> [f32; VALUES] {
    let typical = typical_size_m(kind);
    let size = (b.size_m / typical).max(DVec3::splat(1e-3));
    let heading = b.heading();
    let mut out = [0.0; VALUES];
    let values = [
        b.center_m.x / UNIT_M,
        b.center_m.y / UNIT_M,
        (b.center_m.z - typical.z / 2.0) / HEIGHT_UNIT_M,
        size.x.ln() / LOG_UNIT,
        size.y.ln() / LOG_UNIT,
        size.z.ln() / LOG_UNIT,
        heading.y,
        heading.x,
    ];
    out.iter_mut().zip(values).for_each(|(o, v)| *o = v as f32);
    out
}

/// The box of a node's numbers. Sizes stay between a third and three times the typical ones; an object stands on the ground.
pub fn box_of(kind: u8, class: Class, id: BoxId, values: &[f64]) -> SceneBox {
    let v = |i: usize| values.get(i).copied().filter(|v| v.is_finite()).unwrap_or(0.0);
    let ratio = DVec3::new(v(3), v(4), v(5)) * LOG_UNIT;
    let size_m = typical_size_m(kind) * DVec3::from_array(ratio.to_array().map(|r| r.clamp(-1.1, 1.1).exp()));
    SceneBox {
        id,
        class,
        center_m: DVec3::new(
            (v(0) * UNIT_M).clamp(-200.0, 200.0),
            (v(1) * UNIT_M).clamp(-200.0, 200.0),
            size_m.z / 2.0,
        ),
        size_m,
        yaw_rad: v(6).atan2(v(7)),
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    }
}

/// A lane in the network's units: [`POINTS`] points at even distances.
pub fn line_values(points_m: &[DVec2]) -> [f32; VALUES] {
    let mut out = [0.0; VALUES];
    for (i, p) in resampled(points_m, POINTS).into_iter().enumerate() {
        out[BOX + 2 * i] = (p.x / UNIT_M) as f32;
        out[BOX + 2 * i + 1] = (p.y / UNIT_M) as f32;
    }
    out
}

/// The lane of a node's numbers, m.
pub fn line_of(values: &[f64]) -> Vec<DVec2> {
    let pairs = values.get(BOX..).unwrap_or_default().chunks_exact(2);
    pairs.map(|p| DVec2::new(p[0], p[1]) * UNIT_M).collect()
}

/// A crossing's outline as a box: length along the shorter side (the way cars drive), width along the longer.
pub fn crossing_box(outline_m: &[DVec2]) -> Option<SceneBox> {
    let n = outline_m.len();
    let side = |i: usize| outline_m[(i + 1) % n] - outline_m[i];
    let longest = (0..n).max_by(|a, b| side(*a).length().total_cmp(&side(*b).length()))?;
    let axis = side(longest).try_normalize()?;
    let center = outline_m.iter().sum::<DVec2>() / n as f64;
    let reach = |d: DVec2| {
        outline_m
            .iter()
            .map(|p| d.dot(*p - center).abs())
            .fold(0.0, f64::max)
    };
    let mut heading = -axis.perp();
    if heading.x < 0.0 || (heading.x == 0.0 && heading.y < 0.0) {
        heading = -heading;
    }
    Some(SceneBox {
        id: BoxId(0),
        class: Class::Others,
        center_m: center.extend(0.05),
        size_m: DVec3::new(2.0 * reach(axis.perp()), 2.0 * reach(axis), 0.1).max(DVec3::splat(0.1)),
        yaw_rad: heading.to_angle(),
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    })
}

/// The geometry that a node can have.
pub fn shape_of(node: &GraphNode) -> NodeGeometry {
    match &node.kind {
        NodeKind::Object(_) => NodeGeometry::Box,
        NodeKind::Crossing { polyline } if polyline.is_some() || node.locked.is_some() => NodeGeometry::Box,
        NodeKind::Lane { polyline, .. } if polyline.is_some() || node.locked.is_some() => NodeGeometry::Line,
        _ => NodeGeometry::None,
    }
}

/// A node as the network sees it; locked geometry becomes its values.
pub fn node_input(node: &GraphNode) -> NodeInput {
    let kind = kind_of(&node.kind);
    let shape = shape_of(node);
    let (state, size) = match &node.kind {
        NodeKind::Object(o) => (
            o.state.map_or(0, |s| 1 + s as u8),
            match o.size {
                None => 0,
                Some(SizeHint::Small) => 1,
                Some(SizeHint::Large) => 2,
            },
        ),
        _ => (0, 0),
    };
    let values = match (&node.locked, shape) {
        (Some(Locked::Box(b)), NodeGeometry::Box) => Some(box_values(kind, b)),
        (Some(Locked::Line(outline)), NodeGeometry::Box) => {
            crossing_box(outline).map(|b| box_values(kind, &b))
        }
        (Some(Locked::Line(points)), NodeGeometry::Line) => Some(line_values(points)),
        _ => None,
    };
    let sound = values.filter(|v| v.iter().all(|v| v.is_finite() && v.abs() < 1e3));
    NodeInput {
        kind,
        state,
        size,
        shape,
        locked: sound.is_some() || shape == NodeGeometry::None,
        values: sound.unwrap_or([0.0; VALUES]),
    }
}

/// A graph as the network sees it. Edges to nodes that do not exist are dropped.
pub fn input_of(graph: &SceneGraph, map: Option<Arc<Vec<u8>>>) -> LayoutInput {
    let at = |id: u32| graph.nodes.iter().position(|n| n.id == id).map(|i| i as u16);
    let mut edges = Vec::new();
    for e in &graph.edges {
        for to in [Some(e.to), e.and].into_iter().flatten() {
            if let (Some(from), Some(to)) = (at(e.from), at(to)) {
                edges.push(EdgeInput {
                    from,
                    to,
                    relation: e.relation as u8,
                    distance_m: e.distance_m.filter(|d| d.is_finite()).map(|d| d as f32),
                });
            }
        }
    }
    LayoutInput {
        nodes: graph.nodes.iter().map(node_input).collect(),
        edges,
        map,
    }
}

/// The map in cells of 0.8 m, `[x][y][channel]`: signed distances to the borders of road, car park, walkway and crossing,
/// the vector to the nearest lane (all in steps of 0.05 m, up to 6.35 m), its direction; 128 is 0.
pub fn map_raster(road: &RoadMap) -> Vec<u8> {
    let step = |v: f64, scale: f64| (v * scale + 128.0).round().clamp(0.0, 255.0) as u8;
    let mut out = Vec::with_capacity(MAP_SIDE * MAP_SIDE * MAP_CHANNELS);
    for i in 0..MAP_SIDE * MAP_SIDE {
        let at = |k: usize| (k as f64 + 0.5) * 0.8 - 40.0;
        let p = DVec2::new(at(i / MAP_SIDE), at(i % MAP_SIDE));
        // The centre is a corner of four columns: take the one beyond it.
        let inner = p + 0.1;
        for area in 0..4 {
            out.push(step(road.from_area_m(area, inner), 20.0));
        }
        let lane = road.nearest_lane(inner);
        let (to, direction) = lane.map_or((DVec2::splat(100.0), DVec2::ZERO), |l| {
            (l.position_m - p, l.direction)
        });
        out.extend([
            step(to.x, 20.0),
            step(to.y, 20.0),
            step(direction.x, 127.0),
            step(direction.y, 127.0),
        ]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_survive_the_network_s_units() {
        let b = SceneBox {
            id: BoxId(3),
            class: Class::Bus,
            center_m: DVec3::new(12.5, -31.0, 1.6),
            size_m: DVec3::new(10.0, 2.8, 3.2),
            yaw_rad: -2.5,
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        };
        let node = kind_of(&NodeKind::Object(scene::graph::ObjectNode::new(Class::Bus)));
        let values: Vec<f64> = box_values(node, &b).iter().map(|v| f64::from(*v)).collect();
        let back = box_of(node, Class::Bus, BoxId(3), &values);
        assert!((back.center_m - b.center_m).length() < 1e-5 && (back.size_m - b.size_m).length() < 1e-5);
        assert!((back.yaw_rad - b.yaw_rad).abs() < 1e-6);
        let bad = box_of(node, Class::Bus, BoxId(3), &[f64::NAN; VALUES]);
        assert_eq!(bad.problem(), None);
        assert_eq!(
            box_of(node, Class::Bus, BoxId(3), &[1e300; VALUES]).problem(),
            None
        );
    }

    #[test]
    fn a_crossing_is_a_box_across_the_road() {
        let outline = [(10.0, 6.0), (10.0, -6.0), (13.0, -6.0), (13.0, 6.0)].map(DVec2::from);
        let b = crossing_box(&outline).expect("four corners");
        assert!((b.size_m - DVec3::new(3.0, 12.0, 0.1)).length() < 1e-9);
        assert!((b.heading() - DVec2::X).length() < 1e-9 && (b.center_m.x - 11.5).abs() < 1e-9);
        assert!(crossing_box(&[]).is_none() && crossing_box(&[DVec2::ZERO; 3]).is_none());
    }
}
