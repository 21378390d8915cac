//! Outlines of the areas that a layer of the map covers.

use glam::DVec2;
use scene::Extent;

/// Where two parts of an area meet at a corner alone, both keep this far from it, m: an outline must not touch itself.
const APART_M: f64 = 0.01;

/// A connected area: cells that share an edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PolygonWithHoles {
    /// Counter-clockwise, in the frame of the map, m.
    pub(super) outside: Vec<DVec2>,
    /// Clockwise.
    pub(super) holes: Vec<Vec<DVec2>>,
}

/// Sides of a cell in counter-clockwise order from the lower one: the neighbour across, and the way along.
const ACROSS: [[i64; 2]; 4] = [[0, -1], [1, 0], [0, 1], [-1, 0]];
const ALONG: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
/// Corner of a cell where each side ends.
const ENDS: [[i64; 2]; 4] = [[1, 0], [1, 1], [0, 1], [0, 0]];

/// Areas of the columns for which `covers` holds, by their lowest column.
pub(super) fn areas(extent: Extent, covers: impl Fn(usize, usize) -> bool) -> Vec<PolygonWithHoles> {
    let cells: Vec<bool> = extent.all_columns().map(|[x, y]| covers(x, y)).collect();
    let map = CoveredCells { extent, cells };
    let (area_of, count) = map.areas();
    let mut out = vec![PolygonWithHoles::default(); count];
    // Sides that an outline has passed, a bit each.
    let mut passed = vec![0u8; extent.columns()];
    for at in 0..extent.columns() {
        let [x, y] = extent.column(at).map(|v| v as i64);
        for side in 0..4 {
            if map.is_open([x, y], side) && passed[at] & 1 << side == 0 {
                let ring = map.follow([x, y], side, &mut passed);
                let area = &mut out[area_of[at] as usize - 1];
                match signed_area(&ring) > 0.0 {
                    true => area.outside = ring,
                    false => area.holes.push(ring),
                }
            }
        }
    }
    out
}

struct CoveredCells {
    extent: Extent,
    cells: Vec<bool>,
}

impl CoveredCells {
    fn index(&self, [x, y]: [i64; 2]) -> Option<usize> {
        let inside = |v: i64, n: usize| usize::try_from(v).ok().filter(|v| *v < n);
        let (x, y) = (inside(x, self.extent.nx())?, inside(y, self.extent.ny())?);
        Some(self.extent.index(x, y))
    }

    fn has(&self, cell: [i64; 2]) -> bool {
        self.index(cell).is_some_and(|at| self.cells[at])
    }

    /// True for a side of a cell of an area if the cell across it is in no area.
    fn is_open(&self, cell: [i64; 2], side: usize) -> bool {
        self.has(cell) && !self.has(plus(cell, ACROSS[side]))
    }

    /// Number of the area of each cell, from 1; 0 outside all; and how many there are.
    fn areas(&self) -> (Vec<u32>, usize) {
        let mut area_of = vec![0; self.cells.len()];
        let mut count = 0;
        let mut open = Vec::new();
        for start in 0..self.cells.len() {
            if !self.cells[start] || area_of[start] != 0 {
                continue;
            }
            count += 1;
            area_of[start] = count;
            open.push(start);
            while let Some(at) = open.pop() {
                let cell = self.extent.column(at).map(|v| v as i64);
                for next in ACROSS.iter().filter_map(|way| self.index(plus(cell, *way))) {
                    if self.cells[next] && area_of[next] == 0 {
                        area_of[next] = count;
                        open.push(next);
                    }
                }
            }
        }
        (area_of, count as usize)
    }

    /// The outline that runs along a side, the area to its left.
    fn follow(&self, start: [i64; 2], start_side: usize, passed: &mut [u8]) -> Vec<DVec2> {
        let (mut cell, mut side) = (start, start_side);
        let mut ring = Vec::new();
        loop {
            let Some(at) = self.index(cell) else { return ring };
            passed[at] |= 1 << side;
            let corner = plus(cell, ENDS[side]);
            let next_side = (side + 1) % 4;
            let ahead = plus(cell, ALONG[side]);
            let aside = plus(ahead, ACROSS[side]);
            if !self.has(ahead) {
                // Around the cell; where another area's corner is met, a little inside.
                let mut p = self.corner(corner);
                if self.has(aside) {
                    let inwards = |axis: usize| -(ACROSS[side][axis] + ACROSS[next_side][axis]) as f64;
                    p += DVec2::new(inwards(0), inwards(1)) * APART_M;
                }
                ring.push(p);
                side = next_side;
            } else if self.has(aside) {
                ring.push(self.corner(corner));
                (cell, side) = (aside, (side + 3) % 4);
            } else {
                cell = ahead;
            }
            if (cell, side) == (start, start_side) {
                return ring;
            }
        }
    }

    fn corner(&self, [x, y]: [i64; 2]) -> DVec2 {
        let from = self.extent.from().map(i64::from);
        DVec2::new((from[0] + x) as f64, (from[1] + y) as f64) / self.extent.lattice().per_m()
    }
}

fn plus(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Positive if counter-clockwise.
fn signed_area(ring: &[DVec2]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[&str]) -> Vec<PolygonWithHoles> {
        let extent = Extent::new([-2, 3], [rows[0].len(), rows.len()]).expect("sound");
        areas(extent, |x, y| rows[rows.len() - 1 - y].as_bytes()[x] == b'#')
    }

    #[test]
    fn a_rectangle_has_four_corners_where_the_map_has_them() {
        let found = of(&["....", ".##.", ".##."]);
        assert_eq!(found.len(), 1);
        let at = |x: i32, y: i32| DVec2::new(f64::from(x - 2) / 2.5, f64::from(y + 3) / 2.5);
        let mut ring = found[0].outside.clone();
        ring.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).expect("finite"));
        assert_eq!(ring, [at(1, 0), at(1, 2), at(3, 0), at(3, 2)]);
        assert!((signed_area(&found[0].outside) - 0.64).abs() < 1e-9);
        assert!(found[0].holes.is_empty());
    }

    #[test]
    fn areas_less_their_holes_are_as_large_as_their_cells() {
        let mut dice = scene::draw::SplitMix64::new(5);
        for _ in 0..200 {
            let extent = Extent::new([0, 0], [9, 7]).expect("sound");
            let cells: Vec<bool> = (0..63).map(|_| dice.below(5) < 3).collect();
            let found = areas(extent, |x, y| cells[extent.index(x, y)]);
            let area = |a: &PolygonWithHoles| {
                assert!(signed_area(&a.outside) > 0.0);
                let holes = a.holes.iter().map(|h| signed_area(h));
                signed_area(&a.outside) + holes.inspect(|h| assert!(*h < 0.0)).sum::<f64>()
            };
            let (sum, expected) = (
                found.iter().map(area).sum::<f64>(),
                cells.iter().filter(|c| **c).count() as f64 * 0.16,
            );
            // Corners that keep apart take next to nothing away.
            assert!(
                (sum - expected).abs() < 0.05 * expected + 0.01,
                "{sum} {expected}"
            );
            for area in &found {
                for ring in std::iter::once(&area.outside).chain(&area.holes) {
                    let mut points: Vec<[u64; 2]> =
                        ring.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
                    points.sort_unstable();
                    points.dedup();
                    assert_eq!(points.len(), ring.len(), "a ring meets itself");
                }
            }
        }
        // A ring whose ends meet at a corner has no hole; one that closes has.
        assert_eq!(
            of(&["###", "#.#", "##."])
                .iter()
                .map(|a| a.holes.len())
                .sum::<usize>(),
            0
        );
        assert_eq!(of(&["###", "#.#", "###"])[0].holes.len(), 1);
        assert!(of(&["..."]).is_empty());
    }
}
