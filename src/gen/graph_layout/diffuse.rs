//! From a scene graph to a layout by diffusion: objects on a given road, lanes under given objects, or both; then the
//! projection that repairs impossible places.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::Serialize;
use thiserror::Error;

use super::graph_of::add_road;
use super::project::{Projection, project};
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverError, SolverKind};
use nets::ModelError;
use nets::layout::input::{VALUES, box_of, input_of, kind_of, line_of, map_raster};
use nets::layout::net::{Embedded, LayoutNet, MOST_NODES};
use nn::weights::WeightsError;
use numeric::philox::{Stream, normal_field};
use scene::graph::{GraphEdge, LaneRole, Locked, NodeKind, ObjectState, SceneGraph};
use scene::raster::{draw_polyline, line_cells};
use scene::road_map::RoadMap;
use scene::{BevLayer, BevLayout, BoxId, Class, Polyline, PolylineKind, SceneBox};

/// Default number of steps of a placement (X-Scene's number).
pub const STEPS: usize = 50;

/// Reason why nothing was placed.
#[derive(Debug, Error)]
pub enum PlacementError {
    /// A graph that contradicts itself.
    #[error("{0}")]
    Graph(String),
    /// More nodes than the network takes.
    #[error("the graph has {0} nodes with the map's own, expected at most {MOST_NODES}")]
    TooMany(usize),
    /// An error of the shipped weights.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// An error of the network.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An error of the sampler.
    #[error(transparent)]
    Solver(#[from] SolverError),
}

/// Report of a placement.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlacementReport {
    /// Network calls.
    pub steps: usize,
    /// Time of the diffusion, s.
    pub diffusion_s: f64,
    /// Time of the projection, s.
    pub projection_s: f64,
    /// Node of each box, in the order of the boxes.
    pub nodes: Vec<u32>,
    /// Repairs of the projection.
    pub projection: Projection,
}

struct Predictor<'a> {
    net: &'a LayoutNet,
    embedded: Embedded<'a>,
}

impl Denoiser for Predictor<'_> {
    type Error = PlacementError;

    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, PlacementError> {
        Ok(self.net.predict(&self.embedded, x, t)?)
    }
}

/// Numbers of every node, `[nodes][24]`, sampled by DDIM; locked nodes keep theirs. With `map` the road is given.
fn sample(
    net: &LayoutNet,
    graph: &SceneGraph,
    map: Option<Arc<Vec<u8>>>,
    steps: usize,
    seed: u64,
) -> Result<Vec<f64>, PlacementError> {
    if graph.nodes.len() > MOST_NODES {
        return Err(PlacementError::TooMany(graph.nodes.len()));
    }
    let input = input_of(graph, map);
    let mut noise = normal_field(seed, Stream::Start, input.nodes.len(), VALUES);
    for (x, node) in noise.chunks_exact_mut(VALUES).zip(&input.nodes) {
        let own = node.shape.channels();
        for (k, x) in x.iter_mut().enumerate() {
            if node.locked || !own.contains(&k) {
                *x = 0.0;
            }
        }
    }
    let mut model = Predictor {
        net,
        embedded: net.embed(&input)?,
    };
    let sampler = Sampler::standard(SolverKind::Ddim, steps, Guidance::NONE).map_err(SolverError::from)?;
    let states = sampler.sample(noise, &mut model, |_| Ok(()))?;
    let mut last = states.into_iter().next_back().unwrap_or_default();
    for (x, node) in last.chunks_exact_mut(VALUES).zip(&input.nodes) {
        for k in node.shape.channels().filter(|_| node.locked) {
            x[k] = f64::from(node.values[k]);
        }
    }
    Ok(last)
}

/// A usual speed of a moving object, m/s.
pub fn usual_speed_mps(class: Class) -> f64 {
    match class {
        Class::Pedestrian => 1.3,
        Class::Bicycle => 4.2,
        Class::Motorcycle => 6.0,
        Class::Bus => 5.5,
        Class::ConstructionVehicle => 1.5,
        class if class.is_vehicle() => 8.0,
        _ => 0.0,
    }
}

/// Adds the nodes of the map to a graph. Lanes, crossings and strips that the graph refers to by role become those of
/// the map.
pub fn with_road(graph: &SceneGraph, road: &RoadMap) -> SceneGraph {
    let mut out = graph.clone();
    let first = out.nodes.len();
    add_road(&mut out, road);
    let mut same: BTreeMap<u32, u32> = BTreeMap::new();
    for said in &graph.nodes {
        let fits = |found: &&scene::graph::GraphNode| match (&said.kind, &found.kind) {
            (NodeKind::Lane { role: a, polyline: p }, NodeKind::Lane { role: b, polyline: q }) => {
                a == b && (p.is_none() || p == q)
            }
            (NodeKind::Crossing { polyline: p }, NodeKind::Crossing { polyline: q }) => p.is_none() || p == q,
            (NodeKind::Junction, NodeKind::Junction) => true,
            _ => false,
        };
        if said.locked.is_none()
            && let Some(found) = out.nodes[first..].iter().find(fits)
        {
            same.insert(said.id, found.id);
        }
    }
    out.nodes.retain(|n| !same.contains_key(&n.id));
    let of = |id: u32| same.get(&id).copied().unwrap_or(id);
    for e in &mut out.edges {
        *e = GraphEdge {
            from: of(e.from),
            to: of(e.to),
            and: e.and.map(of),
            ..*e
        };
    }
    out
}

/// Boxes for the objects of a graph on a given road, by [`STEPS`] steps of the shipped network and the projection. Locked
/// objects stay where they are. The same arguments give the same boxes, on any number of threads.
pub fn place_by_diffusion(
    graph: &SceneGraph,
    layout: &BevLayout,
    seed: u64,
) -> Result<(Vec<SceneBox>, PlacementReport), PlacementError> {
    place_with(
        &*LayoutNet::bundled()?,
        graph,
        &BTreeMap::new(),
        layout,
        STEPS,
        seed,
    )
}

/// A placement with a given network, number of steps and sizes of objects (length, width, height, m, by node id) where
/// they are known better than by class.
pub fn place_with(
    net: &LayoutNet,
    graph: &SceneGraph,
    sizes_m: &BTreeMap<u32, [f64; 3]>,
    layout: &BevLayout,
    steps: usize,
    seed: u64,
) -> Result<(Vec<SceneBox>, PlacementReport), PlacementError> {
    if let Some(problem) = graph.problem() {
        return Err(PlacementError::Graph(problem));
    }
    let start = std::time::Instant::now();
    let road = RoadMap::new(layout);
    let full = with_road(graph, &road);
    let values = sample(net, &full, Some(Arc::new(map_raster(&road))), steps, seed)?;
    let diffusion_s = start.elapsed().as_secs_f64();
    let mut boxes = boxes_of(&full, &values);
    let locked = locked_objects(graph);
    for (id, size_m) in sizes_m.iter().filter(|(id, _)| !locked.contains(id)) {
        if let Some(b) = boxes.get_mut(id) {
            b.size_m = DVec3::from_array(*size_m);
            b.center_m.z = b.size_m.z / 2.0;
        }
    }
    let start = std::time::Instant::now();
    let projection = project(graph, &road, &mut boxes, &locked);
    let report = PlacementReport {
        steps,
        diffusion_s,
        projection_s: start.elapsed().as_secs_f64(),
        nodes: boxes.keys().copied().collect(),
        projection,
    };
    Ok((boxes.into_values().collect(), report))
}

/// Objects whose box is given.
pub fn locked_objects(graph: &SceneGraph) -> BTreeSet<u32> {
    let given = |n: &&scene::graph::GraphNode| matches!(n.locked, Some(Locked::Box(_)));
    graph.nodes.iter().filter(given).map(|n| n.id).collect()
}

/// Boxes of a graph's objects from the network's numbers, by node id.
fn boxes_of(graph: &SceneGraph, values: &[f64]) -> BTreeMap<u32, SceneBox> {
    let mut out = BTreeMap::new();
    for (node, values) in graph.nodes.iter().zip(values.chunks_exact(VALUES)) {
        let NodeKind::Object(object) = &node.kind else {
            continue;
        };
        let mut b = box_of(kind_of(&node.kind), object.class, BoxId(node.id), values);
        if object.state == Some(ObjectState::Moving) {
            b.velocity_mps = b.heading() * usual_speed_mps(object.class);
        }
        b.label = object.label;
        if let Some(Locked::Box(given)) = &node.locked {
            b = *given;
        }
        out.insert(node.id, b);
    }
    out
}

/// Road and objects of a graph in which lanes are to be made too: lane nodes of driving roles that are not locked get
/// their course from the network (a third as many points as metres), and are painted with sidewalks; then objects as in
/// [`place_by_diffusion`].
pub fn lay_out(
    graph: &SceneGraph,
    seed: u64,
) -> Result<(BevLayout, Vec<SceneBox>, PlacementReport), PlacementError> {
    lay_out_with(&*LayoutNet::bundled()?, graph, seed)
}

/// Road and objects as in [`lay_out`], with a given network.
pub fn lay_out_with(
    net: &LayoutNet,
    graph: &SceneGraph,
    seed: u64,
) -> Result<(BevLayout, Vec<SceneBox>, PlacementReport), PlacementError> {
    if let Some(problem) = graph.problem() {
        return Err(PlacementError::Graph(problem));
    }
    let mut open = graph.clone();
    for (i, node) in open.nodes.iter_mut().enumerate() {
        if let NodeKind::Lane { role, polyline } = &mut node.kind
            && matches!(
                role,
                LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming | LaneRole::Cross
            )
        {
            polyline.get_or_insert(i as u32);
        }
    }
    let start = std::time::Instant::now();
    let values = sample(net, &open, None, STEPS, seed)?;
    let mut lanes = Vec::new();
    for (node, values) in open.nodes.iter().zip(values.chunks_exact(VALUES)) {
        match (&node.kind, &node.locked) {
            (
                NodeKind::Lane {
                    polyline: Some(_), ..
                },
                Some(Locked::Line(points)),
            ) => lanes.push(points.clone()),
            (
                NodeKind::Lane {
                    polyline: Some(_), ..
                },
                None,
            ) => lanes.push(line_of(values)),
            _ => {}
        }
    }
    let layout = paint(&lanes);
    let road_s = start.elapsed().as_secs_f64();
    // The graph's polylines belong to another layout now.
    let mut placed = graph.clone();
    for node in &mut placed.nodes {
        if let NodeKind::Lane { polyline, .. } | NodeKind::Crossing { polyline } = &mut node.kind {
            *polyline = None;
            node.locked = None;
        }
    }
    let (boxes, mut report) = place_with(net, &placed, &BTreeMap::new(), &layout, STEPS, seed)?;
    report.diffusion_s += road_s;
    report.steps += STEPS;
    Ok((layout, boxes, report))
}

/// A layout around lanes: 3.6 m of road for each, a sidewalk of 2.4 m beside it where there is no road.
pub fn paint(lanes: &[Vec<DVec2>]) -> BevLayout {
    const HALF_M: f64 = 1.85;
    const WALK_M: f64 = 2.4;
    let mut layout = BevLayout::default();
    let mut road = BTreeSet::new();
    let mut walk = BTreeSet::new();
    let mut lines = Vec::new();
    for points in lanes.iter().filter(|l| l.iter().all(|p| p.is_finite())) {
        line_cells(scene::Extent::WINDOW, points, HALF_M, |x, y| {
            road.insert((x, y));
        });
        line_cells(scene::Extent::WINDOW, points, HALF_M + WALK_M, |x, y| {
            walk.insert((x, y));
        });
        lines.push(Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: points.clone(),
        });
    }
    for (x, y) in walk.difference(&road) {
        layout.set(BevLayer::Walkway, *x, *y, true);
    }
    for (x, y) in &road {
        layout.set(BevLayer::DrivableArea, *x, *y, true);
    }
    lines.iter().for_each(|line| draw_polyline(&mut layout, line));
    BevLayout::from_cells(layout.cells().to_vec(), lines).unwrap_or_default()
}
