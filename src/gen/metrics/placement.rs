//! Judges placements on held-out streets. Their graphs keep the statements and lose the positions of objects; boxes
//! placed from them are checked against the statements and compared with figures of real drives.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::layout::{Diversity, LayoutFigures, LayoutQuantity, Soundness, diversity};
use crate::stats::mean_ci95;
use dataset::layout::street;
use graph_layout::diffuse::{PlacementError, PlacementReport, locked_objects};
use graph_layout::graph_of::graph_of;
use graph_layout::project::project;
use numeric::quantile::median;
use scene::graph::{NodeKind, SceneGraph};
use scene::road_map::RoadMap;
use scene::{BevLayout, SceneBox, Window};
use world::draw::{Draw, hash};

/// A placer of the objects of a graph. Gives boxes in the order of `PlacementReport::nodes`.
pub type ObjectPlacer<'a> =
    &'a dyn Fn(&SceneGraph, &BevLayout, u64) -> Result<(Vec<SceneBox>, PlacementReport), PlacementError>;

/// Figures of one placer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlacementFigures {
    /// Number of graphs.
    pub n: usize,
    /// Number of objects in all.
    pub objects: usize,
    /// Share of objects for which no place was left.
    pub dropped: f64,
    /// Number of statements in all.
    pub statements: usize,
    /// Share of statements that hold.
    pub satisfied: f64,
    /// Distance by which the projection moved an object, m: mean over objects.
    pub mean_move_m: f64,
    /// Share of objects that the projection left in place.
    pub unmoved: f64,
    /// Time of the diffusion, median over graphs, s.
    pub diffusion_s: f64,
    /// Time of the projection, median over graphs, s.
    pub projection_s: f64,
    /// Overlaps, and vehicles off the road or against their lane.
    pub soundness: Soundness,
    /// Spacing, sizes and headings beside those of real drives.
    pub rows: Vec<LayoutQuantity>,
    /// Diversity of four seeds on the first graphs: footprints (1 - IoU) and displacement.
    pub diversity: Diversity,
}

/// The graph of held-out street `index` of `seed` with all nodes unlocked and its own statements, and its layout.
pub fn held_out(seed: u64, index: u64) -> (SceneGraph, BevLayout) {
    let (layout, boxes, _) = street(seed, index, |_| None);
    let road = RoadMap::new(&layout);
    let (mut graph, _) = graph_of(&road, &boxes, hash(seed ^ hash(index)));
    for node in &mut graph.nodes {
        if matches!(node.kind, NodeKind::Object(_)) {
            node.locked = None;
        }
    }
    (graph, layout)
}

/// Places the graphs of `count` held-out streets.
pub fn evaluate(
    place: ObjectPlacer<'_>,
    seed: u64,
    count: usize,
) -> Result<PlacementFigures, PlacementError> {
    const DIVERSE: usize = 4;
    let (mut objects, mut dropped, mut statements, mut broken, mut moved, mut moves) =
        (0, 0, 0, 0, 0, Vec::new());
    let (mut diffusion, mut projection) = (Vec::new(), Vec::new());
    let mut figures = LayoutFigures::default();
    let (mut spread, mut pairs) = ((0.0, 0.0), 0);
    for index in 0..count as u64 {
        let (graph, layout) = held_out(seed, index);
        let road = RoadMap::new(&layout);
        let (boxes, report) = place(&graph, &layout, index)?;
        let all = graph.objects().count();
        objects += all;
        dropped += all - boxes.len();
        statements += report.projection.stated;
        broken += report.projection.broken.len();
        moved += report.projection.moved.len();
        moves.push(report.projection.mean_move_m(all));
        diffusion.push(report.diffusion_s);
        projection.push(report.projection_s);
        figures.add(&road, &boxes);
        if index < DIVERSE as u64 {
            let by_node = |(boxes, report): (Vec<SceneBox>, PlacementReport)| {
                report.nodes.into_iter().zip(boxes).collect()
            };
            let runs: Result<Vec<BTreeMap<u32, SceneBox>>, PlacementError> = (0..4)
                .map(|k| Ok(by_node(place(&graph, &layout, 100 + k)?)))
                .collect();
            let found = diversity(&runs?);
            spread = (spread.0 + found.footprints, spread.1 + found.displacement_m);
            pairs += found.pairs;
        }
    }
    let share = |n: usize, of: usize| n as f64 / of.max(1) as f64;
    let graphs = DIVERSE.min(count).max(1) as f64;
    Ok(PlacementFigures {
        n: count,
        objects,
        dropped: share(dropped, objects),
        statements,
        satisfied: 1.0 - share(broken, statements),
        mean_move_m: mean_ci95(&moves).0,
        unmoved: 1.0 - share(moved + dropped, objects),
        diffusion_s: median(&diffusion),
        projection_s: median(&projection),
        soundness: figures.soundness(),
        rows: figures.rows(),
        diversity: Diversity {
            footprints: spread.0 / graphs,
            displacement_m: spread.1 / graphs,
            pairs,
        },
    })
}

/// Baseline of the network: every object at a random place of the map, then the same projection.
pub fn place_at_random(
    graph: &SceneGraph,
    layout: &BevLayout,
    seed: u64,
) -> Result<(Vec<SceneBox>, PlacementReport), PlacementError> {
    let road = RoadMap::new(layout);
    let mut draw = Draw::new(seed, "random places");
    let mut boxes = BTreeMap::new();
    for (id, object) in graph.objects() {
        let size_m = object.class.typical_size_m().unwrap_or([1.0; 3]).into();
        let mut b = SceneBox {
            class: object.class,
            size_m,
            ..scene::relations::ego_box()
        };
        b.id = scene::BoxId(id);
        let cell = [draw.below(Window::NX), draw.below(Window::NY)];
        b.center_m = Window::center(cell[0], cell[1], 0);
        b.center_m.z = b.size_m.z / 2.0;
        b.yaw_rad = draw.range(-3.1, 3.1);
        if object.state == Some(scene::graph::ObjectState::Moving) {
            b.velocity_mps = b.heading() * graph_layout::diffuse::usual_speed_mps(b.class);
        }
        boxes.insert(id, b);
    }
    let start = std::time::Instant::now();
    let projection = project(graph, &road, &mut boxes, &locked_objects(graph));
    let report = PlacementReport {
        projection_s: start.elapsed().as_secs_f64(),
        nodes: boxes.keys().copied().collect(),
        projection,
        ..PlacementReport::default()
    };
    Ok((boxes.into_values().collect(), report))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_places_become_sound_ones() {
        let figures = evaluate(&place_at_random, 3, 2).expect("placed");
        assert!(figures.objects > 5 && figures.statements > 5, "{figures:?}");
        assert_eq!(figures.soundness.overlapping_pairs, 0.0);
        assert_eq!(figures.soundness.vehicles_on_road, 1.0);
        assert!(figures.mean_move_m > 0.5 && figures.diversity.pairs == 12);
    }
}
