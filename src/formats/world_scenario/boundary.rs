//! Borders of an area of columns as lines: traced from cell to cell, then straightened.

use glam::DVec2;
use scene::Extent;
use scene::roads::curve;

/// Rounds of smoothing, in which each point comes nearer to its neighbours: the steps of a slanted border go.
const ROUNDS: usize = 5;
/// Largest distance of a line from the smooth border, m.
const OFF_M: f64 = 0.12;
/// Shorter borders are left out, m: holes of a cell or two.
const SHORTEST_M: f64 = 3.0;

/// Ways from a corner of cells to the next: +x, +y, -x, -y.
const STEPS: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// A border: its points, m, with the area on the left; a closed one does not repeat its first point.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Border {
    pub(crate) points_m: Vec<DVec2>,
    pub(crate) is_closed: bool,
}

/// The borders of the columns for which `inside` holds (by place in arrays `[x][y]`). The side of the map is no border.
pub(crate) fn borders(extent: Extent, inside: impl Fn(usize) -> bool) -> Vec<Border> {
    let mut sides = Sides::from_inside(extent, inside);
    let mut out = Vec::new();
    for only_ends in [true, false] {
        for corner in 0..sides.outgoing.len() {
            while sides.begins(corner, only_ends) {
                let corners = sides.walk(corner);
                out.extend(straightened(extent, &corners));
            }
        }
    }
    out
}

/// Sides between an inner and an outer cell, as ways from corner to corner.
struct Sides {
    extent: Extent,
    /// Per corner `[x][y]`, one more than cells along each axis: a bit for each way out, and how many lead in.
    outgoing: Vec<u8>,
    incoming: Vec<u8>,
}

impl Sides {
    fn from_inside(extent: Extent, inside: impl Fn(usize) -> bool) -> Self {
        let corners = (extent.nx() + 1) * (extent.ny() + 1);
        let mut out = Self {
            extent,
            outgoing: vec![0; corners],
            incoming: vec![0; corners],
        };
        for [x, y] in extent.all_columns().filter(|[x, y]| inside(extent.index(*x, *y))) {
            let (i, j) = (x as i64, y as i64);
            // The neighbour, the corner from which the side is walked with the cell on the left, and the way.
            for (beside, from, way) in [
                ([i, j - 1], [i, j], 0),
                ([i + 1, j], [i + 1, j], 1),
                ([i, j + 1], [i + 1, j + 1], 2),
                ([i - 1, j], [i, j + 1], 3),
            ] {
                let [u, v] = beside.map(|c| usize::try_from(c).unwrap_or(usize::MAX));
                if extent.holds(u, v) && !inside(extent.index(u, v)) {
                    let from = out.corner(from);
                    out.outgoing[from] |= 1 << way;
                    let to = out.next(from, way);
                    out.incoming[to] += 1;
                }
            }
        }
        out
    }

    fn corner(&self, at: [i64; 2]) -> usize {
        at[0] as usize * (self.extent.ny() + 1) + at[1] as usize
    }

    fn next(&self, corner: usize, way: usize) -> usize {
        let [dx, dy] = STEPS[way];
        (corner as i64 + dx * (self.extent.ny() as i64 + 1) + dy) as usize
    }

    /// True if a border is to be walked from here: where one begins at the side of the map, or anywhere on a closed one.
    fn begins(&self, corner: usize, only_ends: bool) -> bool {
        let out = self.outgoing[corner].count_ones();
        out > 0 && (!only_ends || out > u32::from(self.incoming[corner]))
    }

    /// Walks a border to its end and takes it away. The corners; the first is the last on a closed one.
    fn walk(&mut self, first: usize) -> Vec<usize> {
        let (mut at, mut last_way, mut out) = (first, None, vec![first]);
        loop {
            // Where two borders touch, to the left: it stays with its own area.
            let turns = last_way.map_or([0, 1, 2, 3], |way: usize| {
                [1, 0, 3, 2].map(|turn| (way + turn) % 4)
            });
            let Some(way) = turns.into_iter().find(|way| self.outgoing[at] >> way & 1 == 1) else {
                return out;
            };
            self.outgoing[at] &= !(1 << way);
            at = self.next(at, way);
            self.incoming[at] -= 1;
            out.push(at);
            last_way = Some(way);
            if at == first && self.incoming[first] == 0 {
                return out;
            }
        }
    }
}

/// A border through the middles of its sides, with as few points as tell it.
fn straightened(extent: Extent, corners: &[usize]) -> Option<Border> {
    let place = |corner: usize| {
        let row = extent.ny() + 1;
        let at = DVec2::new((corner / row) as f64, (corner % row) as f64);
        extent.from_voxel_units(at.extend(0.0)).truncate()
    };
    let is_closed = corners.first() == corners.last();
    let mut points: Vec<DVec2> = corners
        .windows(2)
        .map(|w| (place(w[0]) + place(w[1])) / 2.0)
        .collect();
    match (is_closed, corners) {
        (true, _) => points.push(*points.first()?),
        (false, [first, .., last]) => {
            points.insert(0, place(*first));
            points.push(place(*last));
        }
        _ => return None,
    }
    (0..ROUNDS).for_each(|_| smooth(&mut points, is_closed));
    let mut points_m = curve::simplified(&points, OFF_M);
    let length_m: f64 = points_m.windows(2).map(|w| w[0].distance(w[1])).sum();
    if is_closed {
        points_m.pop();
    }
    (length_m >= SHORTEST_M).then_some(Border { points_m, is_closed })
}

/// Moves each point half of the way to the middle of its neighbours. The ends of an open line stay.
fn smooth(points: &mut [DVec2], is_closed: bool) {
    let before = points.to_vec();
    let last = before.len().saturating_sub(1);
    for i in 1..last {
        points[i] = (before[i - 1] + 2.0 * before[i] + before[i + 1]) / 4.0;
    }
    if is_closed && last > 1 {
        points[0] = (before[last - 1] + 2.0 * before[0] + before[1]) / 4.0;
        points[last] = points[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_road_across_the_map_has_two_sides_and_an_island_one() {
        let extent = Extent::WINDOW;
        let inside = |i: usize| {
            let [x, y] = extent.column(i);
            (90..110).contains(&y) && !((50..60).contains(&x) && (95..105).contains(&y))
        };
        let found = borders(extent, inside);
        assert_eq!(found.len(), 3, "{found:?}");
        let sides: Vec<_> = found.iter().filter(|b| !b.is_closed).collect();
        assert_eq!(sides.len(), 2);
        for side in sides {
            assert_eq!(side.points_m.len(), 2, "{side:?}");
            let [a, b] = [side.points_m[0], side.points_m[1]];
            assert!((a.x - b.x).abs() > 79.9 && a.y == b.y);
            // The road is on the left: the right side is walked forward.
            assert_eq!(b.x > a.x, a.y < 0.0);
            assert!((a.y.abs() - 4.0).abs() < 1e-9);
        }
        let island = found.iter().find(|b| b.is_closed).expect("the island");
        assert!((4..=16).contains(&island.points_m.len()), "{island:?}");
        let n = island.points_m.len();
        let area: f64 = (0..n)
            .map(|i| island.points_m[i].perp_dot(island.points_m[(i + 1) % n]) / 2.0)
            .sum();
        // The road is on the left, so the island is walked clockwise; its corners are a little round.
        assert!((-16.0..-14.0).contains(&area), "{area} m2");
    }

    #[test]
    fn a_slanted_side_is_straight_and_areas_that_touch_at_a_corner_stay_apart() {
        let extent = Extent::WINDOW;
        let slanted = |i: usize| {
            let [x, y] = extent.column(i);
            y as f64 > 20.0 + x as f64 * 0.37
        };
        let found = borders(extent, slanted);
        assert_eq!((found.len(), found[0].is_closed), (1, false));
        assert!(found[0].points_m.len() <= 6, "{} points", found[0].points_m.len());
        let squares = |i: usize| {
            let [x, y] = extent.column(i);
            let within = |low: usize| (low..low + 10).contains(&x) && (low..low + 10).contains(&y);
            within(50) || within(60)
        };
        let found = borders(extent, squares);
        assert_eq!(found.iter().filter(|b| b.is_closed).count(), 2);
        assert!(borders(extent, |_| true).is_empty() && borders(extent, |_| false).is_empty());
        // A hole of one cell is no border.
        assert!(borders(extent, |i| i != 20_100).is_empty());
    }
}
