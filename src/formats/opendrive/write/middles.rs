//! Lanes for paved ground that no lane crosses: along the middle of it, found by thinning it in the order of the distance to its
//! border (Pudney 1998, "Distance-ordered homotopic thinning").

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::chains::{Chain, GroundKind, Near, surface};
use scene::distance::signed_distance_m;
use scene::{BevLayer, BevLayout, Extent};

/// Ground so near to a lane belongs to that lane's road, m.
const COVERED_M: f64 = 5.0;
/// Ground narrower than twice this carries no lane, m.
const NARROWEST_M: f64 = 0.9;
/// Shortest middle line, m.
const SHORTEST_M: f64 = 5.0;
/// Least ratio of a road's length to its width.
const LONGER: f64 = 1.2;
/// A branch is a corner of the ground, not a road, if it is no longer than that times its reach, m.
const CORNER: f64 = 1.5;
/// From this width on there are two lanes, m.
const TWO_LANES_M: f64 = 5.0;
/// Middle of the wider roads' lanes from the middle of the road, at most, m.
const ASIDE_M: f64 = 1.9;
/// A road of one lane is joined to others if it is as long, m. Shorter ones are ways to a door.
const JOINED_M: f64 = 20.0;
/// Longest ground over which a middle line is continued to meet another road, m.
const REACH_M: f64 = 12.0;
/// Rounds of pruning, at most.
const ROUNDS: usize = 12;

/// The lanes.
pub(super) fn lanes(layout: &BevLayout, near: &Near, left_hand: bool) -> Vec<Chain> {
    let extent = layout.extent();
    let is_open = |c: usize| {
        let [x, y] = extent.column(c);
        let p = extent.center(x, y, 0).truncate();
        layout.has(BevLayer::DrivableArea, x, y)
            && !layout.has(BevLayer::CarparkArea, x, y)
            && near.within(p, COVERED_M).next().is_none()
    };
    let open: Vec<bool> = (0..extent.columns()).map(is_open).collect();
    if !open.contains(&true) {
        return Vec::new();
    }
    let depth: Vec<f32> = signed_distance_m(extent, |c| open[c])
        .iter()
        .map(|m| -m)
        .collect();
    let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    let whole = signed_distance_m(extent, |c| layout.cells()[c] & paved != 0);
    let whole: Vec<f32> = whole.iter().map(|m| -m).collect();
    let mut skeleton = Skeleton {
        extent,
        depth: &depth,
        set: open.clone(),
    };
    skeleton.thin();
    let mut lines = skeleton.lines();
    for _ in 0..ROUNDS {
        if !skeleton.prune(&lines) {
            break;
        }
        skeleton.thin();
        lines = skeleton.lines();
    }
    let mut out = Vec::new();
    for line in &lines {
        out.extend(of_line(layout, near, [&depth, &whole], line, left_hand));
    }
    out
}

/// Columns that are one thin line after the other.
struct Skeleton<'a> {
    extent: Extent,
    /// Distance to the border of the ground, m.
    depth: &'a [f32],
    set: Vec<bool>,
}

/// A line of the skeleton: its cells, and whether it ends freely at its start and end.
struct SkeletonLine {
    cells: Vec<usize>,
    free: [bool; 2],
}

/// The eight neighbours, counter-clockwise.
const AROUND: [(i64, i64); 8] = [
    (1, 0),
    (1, 1),
    (0, 1),
    (-1, 1),
    (-1, 0),
    (-1, -1),
    (0, -1),
    (1, -1),
];

impl Skeleton<'_> {
    fn neighbour(&self, cell: usize, (dx, dy): (i64, i64)) -> Option<usize> {
        let [x, y] = self.extent.column(cell).map(|n| n as i64);
        let (x, y) = (x + dx, y + dy);
        let inside = (0..self.extent.nx() as i64).contains(&x) && (0..self.extent.ny() as i64).contains(&y);
        inside.then(|| self.extent.index(x as usize, y as usize))
    }

    fn ring(&self, cell: usize) -> [bool; 8] {
        AROUND.map(|step| self.neighbour(cell, step).is_some_and(|n| self.set[n]))
    }

    /// True if the cell can go without a hole, a gap or the loss of an end.
    fn can_go(&self, cell: usize) -> bool {
        let ring = self.ring(cell);
        let count = ring.iter().filter(|r| **r).count();
        // The number of 8-connected parts around it (Yokoi and others 1975).
        let parts: i32 = [0, 2, 4, 6]
            .iter()
            .map(|&k| {
                let [a, b, c] = [k, (k + 1) % 8, (k + 2) % 8].map(|i| i32::from(!ring[i]));
                a - a * b * c
            })
            .sum();
        count > 1 && parts == 1
    }

    /// Takes cells away, the shallowest first, until lines are left.
    fn thin(&mut self) {
        // Of equal depths every other cell first, so that a line two cells wide is not eaten up from one end.
        let extent = self.extent;
        let key = |depth: f32, cell: usize| {
            let [x, y] = extent.column(cell);
            Reverse(((depth * 1000.0) as i64, 2 * (x % 2) + y % 2, cell))
        };
        let mut queue: BinaryHeap<_> = (0..self.set.len())
            .filter(|c| self.set[*c])
            .map(|c| key(self.depth[c], c))
            .collect();
        while let Some(Reverse((_, _, cell))) = queue.pop() {
            if !self.set[cell] || !self.can_go(cell) {
                continue;
            }
            self.set[cell] = false;
            for step in AROUND {
                if let Some(n) = self.neighbour(cell, step)
                    && self.set[n]
                {
                    queue.push(key(self.depth[n], n));
                }
            }
        }
    }

    /// The neighbours that a line goes on to: across a side, and across a corner unless it goes on across a side beside
    /// that corner.
    fn next(&self, cell: usize) -> Vec<usize> {
        let ring = self.ring(cell);
        let counts = |i: &usize| {
            let corner = i % 2 == 1;
            ring[*i] && !(corner && (ring[(i + 7) % 8] || ring[(i + 1) % 8]))
        };
        let of = |i: usize| self.neighbour(cell, AROUND[i]);
        (0..8).filter(counts).filter_map(of).collect()
    }

    /// The lines between ends and forks, and rings.
    fn lines(&self) -> Vec<SkeletonLine> {
        let cells: Vec<usize> = (0..self.set.len()).filter(|c| self.set[*c]).collect();
        let degree = |c: usize| self.next(c).len();
        let mut out = Vec::new();
        let mut walked = std::collections::HashSet::new();
        let is_node = |c: usize| degree(c) != 2;
        let starts = cells.iter().copied().filter(|c| is_node(*c));
        // Rings come last: no node is on them.
        for start in starts.chain(cells.iter().copied()) {
            for first in self.next(start) {
                if walked.contains(&(start, first)) || (!is_node(start) && walked.contains(&(first, start))) {
                    continue;
                }
                let mut line = vec![start];
                let (mut before, mut at) = (start, first);
                loop {
                    walked.insert((before, at));
                    walked.insert((at, before));
                    line.push(at);
                    if at == start || is_node(at) {
                        break;
                    }
                    let Some(next) = self.next(at).into_iter().find(|n| *n != before) else {
                        break;
                    };
                    (before, at) = (at, next);
                }
                let end = line[line.len() - 1];
                out.push(SkeletonLine {
                    cells: line,
                    free: [degree(start) == 1, degree(end) == 1],
                });
            }
        }
        out
    }

    fn length_m(&self, cells: &[usize]) -> f64 {
        let at = |c: usize| {
            let [x, y] = self.extent.column(c);
            self.extent.center(x, y, 0).truncate()
        };
        cells.windows(2).map(|w| at(w[0]).distance(at(w[1]))).sum()
    }

    /// Takes away branches into corners; false if there is no such branch.
    fn prune(&mut self, lines: &[SkeletonLine]) -> bool {
        let mut any = false;
        for line in lines {
            let fork = match line.free {
                [true, false] => line.cells[line.cells.len() - 1],
                [false, true] => line.cells[0],
                _ => continue,
            };
            if self.length_m(&line.cells) <= CORNER * f64::from(self.depth[fork]) + 0.8 {
                let branch = line.cells.iter().filter(|c| **c != fork);
                branch.for_each(|c| self.set[*c] = false);
                any = true;
            }
        }
        any
    }
}

/// One or two lanes along a middle line; none if it is too short or too narrow. `depths` are those in the ground
/// without lanes and in all paved ground, m.
fn of_line(
    layout: &BevLayout,
    near: &Near,
    depths: [&[f32]; 2],
    line: &SkeletonLine,
    left_hand: bool,
) -> Vec<Chain> {
    let extent = layout.extent();
    let [half_m, whole_m] = depths.map(|depth| {
        let mut all: Vec<f64> = line.cells.iter().map(|c| f64::from(depth[*c])).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    });
    let depth = depths[0];
    let closed = line.cells.len() > 8 && line.cells[0] == line.cells[line.cells.len() - 1];
    // Free ends run into corners; the middle is read from where the ground is as wide as it mostly is.
    let wide = |c: &usize| f64::from(depth[*c]) >= 0.8 * half_m;
    let first = if line.free[0] {
        line.cells.iter().position(wide).unwrap_or(0)
    } else {
        0
    };
    let last = line.cells.len() - 1;
    let last = if line.free[1] {
        line.cells.iter().rposition(wide).unwrap_or(last)
    } else {
        last
    };
    let points = line.cells[first..=last.max(first)].iter().map(|c| {
        let [x, y] = extent.column(*c);
        extent.center(x, y, 0).truncate()
    });
    let mut points = smooth(&points.collect::<Vec<_>>(), closed);
    let length = |p: &[DVec2]| -> f64 { p.windows(2).map(|w| w[0].distance(w[1])).sum() };
    if half_m < NARROWEST_M || points.len() < 3 {
        return Vec::new();
    }
    let wide = 2.0 * half_m >= TWO_LANES_M;
    if !closed {
        for at_start in [true, false] {
            if at_start {
                points.reverse();
            }
            if line.free[usize::from(!at_start)] {
                let join = wide || length(&points) > JOINED_M;
                extend(layout, near, &mut points, join);
            }
            if at_start {
                points.reverse();
            }
        }
    }
    if length(&points) < SHORTEST_M.max(LONGER * 2.0 * half_m.max(whole_m)) {
        return Vec::new();
    }
    if closed {
        points.pop();
    }
    if !wide {
        let mut chain = Chain::new(&points, closed);
        chain.half_m = Some(half_m.min(2.4));
        chain.two_way = true;
        return vec![chain];
    }
    let aside = (half_m / 2.0).min(ASIDE_M) * if left_hand { 1.0 } else { -1.0 };
    let back: Vec<DVec2> = points.iter().rev().copied().collect();
    [points, back]
        .iter()
        .map(|line| Chain::new(&shifted(line, aside, closed), closed))
        .collect()
}

/// Goes on over paved ground to its end, or to the middle of another lane if it is to be joined.
fn extend(layout: &BevLayout, near: &Near, points: &mut Vec<DVec2>, join: bool) {
    let extent = layout.extent();
    let n = points.len();
    let from = points[n.saturating_sub(6)];
    let end = points[n - 1];
    let ahead = (end - from).normalize_or_zero();
    if ahead == DVec2::ZERO {
        return;
    }
    let mut reach_m = 0.0;
    while reach_m < REACH_M {
        let p = end + ahead * (reach_m + 0.2);
        let paved = matches!(surface(layout, extent, p), GroundKind::Road | GroundKind::Carpark);
        let met = near
            .within(p, if join { 1.0 } else { COVERED_M - 1.0 })
            .next()
            .is_some();
        if !paved || met {
            break;
        }
        reach_m += 0.2;
    }
    if reach_m > 0.4 {
        points.push(end + ahead * reach_m);
    }
}

/// Means over half a metre to a metre, again and again; ends stay.
fn smooth(points: &[DVec2], closed: bool) -> Vec<DVec2> {
    const TIMES: usize = 12;
    let mut out = points.to_vec();
    let n = out.len();
    for _ in 0..TIMES {
        let before = out.clone();
        for i in 0..n {
            let (a, b) = match (i, closed) {
                (0, true) => (n - 2, 1),
                (i, true) if i == n - 1 => (n - 2, 1),
                (0, false) => continue,
                (i, false) if i == n - 1 => continue,
                _ => (i - 1, i + 1),
            };
            out[i] = (before[a] + before[i] * 2.0 + before[b]) / 4.0;
        }
    }
    out
}

/// A line shifted to its left, m.
fn shifted(points: &[DVec2], left_m: f64, closed: bool) -> Vec<DVec2> {
    let n = points.len();
    (0..n)
        .map(|i| {
            let (a, b) = match closed {
                true => ((i + n - 2) % n, (i + 2) % n),
                false => (i.saturating_sub(2), (i + 2).min(n - 1)),
            };
            points[i] + (points[b] - points[a]).normalize_or(DVec2::X).perp() * left_m
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::raster::line_cells;

    fn painted(strokes: &[(&[[f64; 2]], f64)]) -> BevLayout {
        let mut layout = BevLayout::default();
        for (points, half) in strokes {
            let points: Vec<DVec2> = points.iter().copied().map(DVec2::from_array).collect();
            let mut cells = Vec::new();
            line_cells(Extent::WINDOW, &points, *half, |x, y| cells.push((x, y)));
            for (x, y) in cells {
                layout.set(BevLayer::DrivableArea, x, y, true);
            }
        }
        layout
    }

    fn found(layout: &BevLayout) -> Vec<Chain> {
        lanes(layout, &Near::new(&[]), false)
    }

    #[test]
    fn a_wide_stroke_gets_two_lanes_and_a_narrow_one_gets_one() {
        let wide = found(&painted(&[(&[[-30.0, 5.0], [30.0, 5.0]], 3.5)]));
        assert_eq!(wide.len(), 2);
        for (chain, side) in wide.iter().zip([-1.0, 1.0]) {
            let ends = [chain.points_m[0], chain.points_m[chain.len() - 1]];
            let along = ends[1].x - ends[0].x;
            // Along x on the right, back on the left.
            assert!(along.abs() > 55.0 && chain.points_m.iter().all(|p| (p.y - 5.0).abs() > 1.2));
            let aside = chain.points_m[chain.len() / 2].y - 5.0;
            assert!(aside * along < 0.0, "{aside} {along} {side}");
        }
        let narrow = found(&painted(&[(&[[-30.0, -5.0], [10.0, 12.0]], 1.6)]));
        assert!(narrow.len() == 1 && narrow[0].two_way);
        assert!((narrow[0].half_m.expect("known") - 1.6).abs() < 0.35);
    }

    #[test]
    fn corners_are_no_roads_and_arms_are() {
        let cross = painted(&[
            (&[[-30.0, 0.0], [30.0, 0.0]], 3.2),
            (&[[4.0, -30.0], [4.0, 30.0]], 3.2),
        ]);
        assert_eq!(found(&cross).len(), 8, "two lanes on each of four arms");
        assert!(found(&painted(&[(&[[-2.0, 0.0], [2.0, 0.0]], 0.5)])).is_empty());
        assert!(found(&BevLayout::default()).is_empty());
    }

    #[test]
    fn a_ring_is_closed() {
        let ring: Vec<[f64; 2]> = (0..=60)
            .map(|i| (DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 60.0) * 15.0).to_array())
            .collect();
        let lanes = found(&painted(&[(&ring, 2.0)]));
        assert_eq!(lanes.len(), 1);
        assert!(lanes[0].closed);
        assert!(lanes[0].points_m.iter().all(|p| (p.length() - 15.0).abs() < 0.6));
    }
}
