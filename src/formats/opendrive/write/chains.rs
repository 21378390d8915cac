//! Lanes of a layout as chains of evenly spaced samples, and the samples near a place.

use std::collections::HashMap;

use glam::DVec2;

use super::super::lines::clipped;
use scene::road_map::{at_along, resampled};
use scene::{BevLayout, Extent, PolylineKind};

/// Distance between the samples of a chain, m.
pub(super) const STEP_M: f64 = 0.5;
/// Roads go on this far beyond the border of the map, so that one that leaves it at a slant has all its lanes there, m.
pub(super) const BEYOND_M: f64 = 12.0;
/// A lane that ends so close to the border leaves the map, m.
const BORDER_M: f64 = 0.6;
/// Pieces of one lane are no farther apart, m.
const GAP_M: f64 = 1.2;
/// Least cosine of the angle between two pieces of one lane.
const LEAST_COSINE: f64 = 0.9;
/// A lane that is this close to another one all the way is the same lane drawn twice, m.
const SAME_M: f64 = 0.6;
/// Shortest lane that becomes a road, m.
const SHORTEST_M: f64 = 2.0;

/// A lane from its start to its end.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    /// Samples in driving direction, [`STEP_M`] apart or nearly so.
    pub points_m: Vec<DVec2>,
    /// True if the first sample follows the last.
    pub closed: bool,
    /// Half of the width where it is known, m: of lanes that are made of painted ground.
    pub half_m: Option<f64>,
    /// True if it is driven both ways.
    pub two_way: bool,
}

impl Chain {
    /// Through points in driving direction.
    pub fn new(points: &[DVec2], closed: bool) -> Self {
        let mut points = points.to_vec();
        if closed {
            points.extend(points.first().copied());
        }
        let total: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let count = (total / STEP_M).round().max(1.0) as usize + 1;
        let mut points_m = resampled(&points, count);
        if closed {
            points_m.pop();
        }
        Self {
            points_m,
            closed,
            half_m: None,
            two_way: false,
        }
    }

    pub fn len(&self) -> usize {
        self.points_m.len()
    }

    /// The sample `by` places on; `None` beyond an end.
    pub fn step(&self, k: usize, by: isize) -> Option<usize> {
        let (n, at) = (self.len() as isize, k as isize + by);
        match self.closed {
            true => Some(at.rem_euclid(n) as usize),
            false => (0..n).contains(&at).then_some(at as usize),
        }
    }

    /// Unit vector of the driving direction at a sample.
    pub fn direction(&self, k: usize) -> DVec2 {
        let before = self.step(k, -1).unwrap_or(k);
        let after = self.step(k, 1).unwrap_or(k);
        (self.points_m[after] - self.points_m[before]).normalize_or(DVec2::X)
    }
}

/// The lanes of a layout, joined of their pieces, up to a little beyond its map.
pub(super) fn of_layout(layout: &BevLayout) -> Vec<Chain> {
    let extent = layout.extent();
    let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
    let corners = (low - BEYOND_M, high + BEYOND_M);
    let lanes = layout
        .polylines
        .iter()
        .filter(|line| line.kind == PolylineKind::LaneCenter);
    let sound = lanes.filter(|line| line.points_m.iter().all(|p| p.is_finite()));
    let pieces: Vec<Vec<DVec2>> = sound.flat_map(|line| clipped(&line.points_m, corners)).collect();
    let mut chains = Vec::new();
    for (mut points, closed) in joined(&pieces) {
        if !closed {
            extend(&mut points, (low, high));
            points.reverse();
            extend(&mut points, (low, high));
            points.reverse();
        }
        let meets = |p: &DVec2| p.cmpge(low).all() && p.cmple(high).all();
        let chain = Chain::new(&points, closed);
        if chain.len() as f64 * STEP_M > SHORTEST_M && chain.points_m.iter().any(meets) {
            chains.push(chain);
        }
    }
    once(chains)
}

/// Continues a line that ends at the border of the map, beyond it.
fn extend(points: &mut Vec<DVec2>, (low, high): (DVec2, DVec2)) {
    let n = points.len();
    let end = points[n - 1];
    let beyond = |p: DVec2, by: f64| p.cmplt(low - by).any() || p.cmpgt(high + by).any();
    if !beyond(end, -BORDER_M) || beyond(end, BEYOND_M - BORDER_M) {
        return;
    }
    let total: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let ahead = (end - at_along(points, total - 2.0)).normalize_or_zero();
    // Outward only: a lane may also begin just beyond the border and lead onto the map.
    let outside = |p: DVec2| (low - p).max(p - high).max_element();
    if outside(end + ahead) <= outside(end) {
        return;
    }
    let mut reach_m = 0.0;
    while ahead != DVec2::ZERO && reach_m < 2.0 * BEYOND_M && !beyond(end + ahead * reach_m, BEYOND_M) {
        reach_m += 1.0;
    }
    if reach_m > 0.0 {
        points.push(end + ahead * reach_m);
    }
}

/// Pieces joined where one ends and another goes on; true for a ring.
fn joined(pieces: &[Vec<DVec2>]) -> Vec<(Vec<DVec2>, bool)> {
    let cell = |p: DVec2| (p / GAP_M).floor().as_ivec2().to_array();
    let mut starts: HashMap<[i32; 2], Vec<usize>> = HashMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        starts.entry(cell(piece[0])).or_default().push(i);
    }
    let mut links: Vec<(f64, usize, usize)> = Vec::new();
    for (a, piece) in pieces.iter().enumerate() {
        let n = piece.len();
        let (end, direction) = (piece[n - 1], (piece[n - 1] - piece[n - 2]).normalize_or_zero());
        let [x, y] = cell(end);
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            for &b in starts.get(&[x + dx, y + dy]).into_iter().flatten() {
                let next = (pieces[b][1] - pieces[b][0]).normalize_or_zero();
                let (gap_m, cosine) = (end.distance(pieces[b][0]), direction.dot(next));
                if gap_m < GAP_M && cosine > LEAST_COSINE {
                    links.push((gap_m + 4.0 * (1.0 - cosine), a, b));
                }
            }
        }
    }
    links.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut next, mut before) = (vec![None; pieces.len()], vec![None; pieces.len()]);
    for (_, a, b) in links {
        if next[a].is_none() && before[b].is_none() {
            (next[a], before[b]) = (Some(b), Some(a));
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut out = Vec::new();
    let firsts: Vec<usize> = (0..pieces.len()).filter(|i| before[*i].is_none()).collect();
    let open = firsts.len();
    for (order, first) in firsts.into_iter().chain(0..pieces.len()).enumerate() {
        let (mut points, mut at) = (Vec::new(), Some(first));
        while let Some(i) = at.filter(|i| !used[*i]) {
            used[i] = true;
            points.extend_from_slice(&pieces[i]);
            at = next[i];
        }
        if points.len() >= 2 {
            // A chain that is reached from no first piece is a ring.
            out.push((points, order >= open));
        }
    }
    out
}

/// Without lanes that run along others from their start to their end.
fn once(chains: Vec<Chain>) -> Vec<Chain> {
    let near = Near::new(&chains);
    let mut kept: Vec<bool> = vec![true; chains.len()];
    for i in (0..chains.len()).rev() {
        let chain = &chains[i];
        let is_drawn_twice = (0..chain.len()).all(|k| {
            let (p, direction) = (chain.points_m[k], chain.direction(k));
            let mut others = near.within(p, SAME_M).filter(|s| s.chain != i && kept[s.chain]);
            others.any(|s| s.direction.dot(direction) > LEAST_COSINE)
        });
        kept[i] = !is_drawn_twice;
    }
    let mut keep = kept.into_iter();
    let mut chains = chains;
    chains.retain(|_| keep.next() == Some(true));
    chains
}

/// A sample of a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChainSample {
    pub chain: usize,
    pub k: usize,
    pub at_m: DVec2,
    pub direction: DVec2,
}

/// All samples by place.
pub(super) struct Near {
    cells: HashMap<[i32; 2], Vec<ChainSample>>,
}

/// Side of a cell, m.
const CELL_M: f64 = 4.0;

impl Near {
    pub fn new(chains: &[Chain]) -> Self {
        let mut cells: HashMap<[i32; 2], Vec<ChainSample>> = HashMap::new();
        for (i, chain) in chains.iter().enumerate() {
            for (k, p) in chain.points_m.iter().enumerate() {
                cells.entry(Self::cell(*p)).or_default().push(ChainSample {
                    chain: i,
                    k,
                    at_m: *p,
                    direction: chain.direction(k),
                });
            }
        }
        Self { cells }
    }

    fn cell(p: DVec2) -> [i32; 2] {
        (p / CELL_M).floor().as_ivec2().to_array()
    }

    /// Samples within a distance, always in the same order.
    pub fn within(&self, p: DVec2, reach_m: f64) -> impl Iterator<Item = &ChainSample> {
        let [x0, y0] = Self::cell(p - reach_m);
        let [x1, y1] = Self::cell(p + reach_m);
        (x0..=x1)
            .flat_map(move |x| (y0..=y1).map(move |y| [x, y]))
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .filter(move |s| s.at_m.distance_squared(p) <= reach_m * reach_m)
    }
}

/// Ground at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GroundKind {
    Road,
    Carpark,
    Walkway,
    Other,
    Beyond,
}

/// The surface under a point of a map.
pub(super) fn surface(layout: &BevLayout, extent: Extent, p: DVec2) -> GroundKind {
    use scene::BevLayer::{CarparkArea, DrivableArea, Walkway};
    let Some([x, y]) = extent.column_at(p.x, p.y) else {
        return GroundKind::Beyond;
    };
    let cell = layout.cell(x, y);
    if cell & CarparkArea.bit() != 0 {
        GroundKind::Carpark
    } else if cell & DrivableArea.bit() != 0 {
        GroundKind::Road
    } else if cell & Walkway.bit() != 0 {
        GroundKind::Walkway
    } else {
        GroundKind::Other
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Polyline;

    fn layout(lanes: &[&[[f64; 2]]]) -> BevLayout {
        let lines = lanes.iter().map(|points| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: points.iter().copied().map(DVec2::from_array).collect(),
        });
        BevLayout::from_cells(vec![0; 40_000], lines.collect()).expect("a window")
    }

    #[test]
    fn pieces_join_and_lanes_go_on_beyond_the_map() {
        let chains = of_layout(&layout(&[
            &[[0.5, 1.0], [40.0, 1.0]],
            &[[-40.0, 1.0], [0.0, 1.0]],
            &[[-20.0, 5.0], [20.0, 5.0]],
            &[[10.0, 1.1], [20.0, 1.1]],
        ]));
        assert_eq!(chains.len(), 2, "one is drawn twice");
        let ends = |c: &Chain| [c.points_m[0].x, c.points_m[c.len() - 1].x];
        assert_eq!(ends(&chains[0]), [-53.0, 53.0]);
        assert_eq!(ends(&chains[1]), [-20.0, 20.0]);
        assert!((chains[0].points_m[7].x + 49.5).abs() < 0.01);
    }

    #[test]
    fn a_ring_is_closed() {
        let ring: Vec<[f64; 2]> = (0..=40)
            .map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 40.0) * 10.0)
            .map(|p| p.to_array())
            .collect();
        let chains = of_layout(&layout(&[&ring]));
        assert!(chains[0].closed && chains.len() == 1);
        let n = chains[0].len();
        assert!((n as f64 * STEP_M - 62.8).abs() < 1.0, "{n}");
        assert_eq!(chains[0].step(n - 1, 1), Some(0));
        assert!(chains[0].points_m[0].distance(chains[0].points_m[n - 1]) < 0.6);
    }
}
