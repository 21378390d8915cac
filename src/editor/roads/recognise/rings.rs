//! Roundabouts: round holes in the paved area that have a road all the way around.

use glam::DVec2;

use super::mask::{Mask, parts};
use super::skeleton::Graph;

/// Radii of islands, m.
const ISLAND_M: std::ops::RangeInclusive<f64> = 2.0..=40.0;
/// The border of a round island is so near to its middle radius, as a share of it.
const ROUND: f64 = 0.22;
/// A chain with at least this share on the ring belongs to it.
const ON_RING: f64 = 0.7;

/// A roundabout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// The knot that it became.
    pub knot: usize,
    /// Radius of the island, m.
    pub island_m: f64,
    /// Width of the ring, m.
    pub ring_m: f64,
}

/// Takes the rings out of a graph: each becomes one knot.
pub(super) fn take(graph: &mut Graph, mask: &Mask) -> Vec<Ring> {
    let mut out = Vec::new();
    for hole in parts(mask.extent, &mask.paved, false) {
        let Some((center, island_m)) = round(mask, &hole) else {
            continue;
        };
        let around = (0..64).map(|k| DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 64.0));
        let mut widths: Vec<f64> = around
            .filter_map(|way| width_m(mask, center, way, island_m))
            .collect();
        if widths.len() < 50 {
            continue;
        }
        widths.sort_by(f64::total_cmp);
        // The ring is wider where arms open; its own width is that of the rest.
        let ring_m = widths[widths.len() / 4];
        let middle_m = island_m + ring_m / 2.0;
        let on_ring = |p: &DVec2| (p.distance(center) - middle_m).abs() < ring_m * 0.6 + 0.8;
        let is_of_ring = |points: &[DVec2]| {
            let on = points.iter().filter(|p| on_ring(p)).count();
            on as f64 >= ON_RING * points.len() as f64
        };
        if !graph.chains.iter().any(|c| is_of_ring(&c.points_m)) {
            continue;
        }
        let knot = graph.knots.len();
        graph.knots.push(super::skeleton::Knot {
            at_m: center,
            depth_m: island_m + ring_m,
        });
        let gone: Vec<usize> = graph
            .chains
            .iter()
            .filter(|c| is_of_ring(&c.points_m))
            .flat_map(|c| c.ends)
            .collect();
        graph.chains.retain(|c| !is_of_ring(&c.points_m));
        for chain in &mut graph.chains {
            for end in &mut chain.ends {
                if gone.contains(end) {
                    *end = knot;
                }
            }
        }
        graph.chains.retain(|c| c.ends != [knot, knot]);
        out.push(Ring {
            knot,
            island_m,
            ring_m: ring_m.clamp(*scene::RoadNode::RING_M.start(), *scene::RoadNode::RING_M.end()),
        });
    }
    out
}

/// Middle and radius of a hole if it is round.
fn round(mask: &Mask, hole: &[usize]) -> Option<(DVec2, f64)> {
    let cell_m2 = mask.extent.voxel_m().powi(2);
    let radius_m = (hole.len() as f64 * cell_m2 / std::f64::consts::PI).sqrt();
    if !ISLAND_M.contains(&radius_m) {
        return None;
    }
    let center = hole.iter().map(|i| mask.point_m(*i)).sum::<DVec2>() / hole.len() as f64;
    let farthest = hole
        .iter()
        .map(|i| mask.point_m(*i).distance(center))
        .fold(0.0, f64::max);
    (farthest < radius_m * (1.0 + ROUND) + 0.4).then_some((center, radius_m))
}

/// Width of the paved ring from an island outward, m; `None` if it does not end soon.
fn width_m(mask: &Mask, center: DVec2, way: DVec2, island_m: f64) -> Option<f64> {
    const STEP_M: f64 = 0.2;
    const MOST: usize = 150;
    let paved = |at_m: f64| mask.depth_at(center + way * at_m) > 0.0;
    let from = (0..20)
        .map(|k| island_m + f64::from(k) * STEP_M)
        .find(|r| paved(*r))?;
    let steps = (0..MOST)
        .position(|k| !paved(from + k as f64 * STEP_M))
        .unwrap_or(MOST);
    Some(from - island_m + steps as f64 * STEP_M)
}
