//! Straightness of walls: the outlines of manmade parts seen from above are followed side by side, and a line is fitted
//! to every short stretch (its principal axis).

use super::manmade::tops;
use super::{ShapeFigures, share};
use scene::{VoxelGrid, Window};

/// Share of the stretches that deviate from a line by no more than the steps of its columns do.
pub const STRAIGHT: &str = "wall_straightness";
/// RMS distance of a stretch's sides to its fitted line, mean over stretches, m.
pub const DEVIATION_M: &str = "wall_deviation_m";

/// Sides before and behind the middle of a stretch; 9 sides are 3.6 m of a wall along an axis.
const REACH: usize = 4;
/// RMS distance to the line up to which a stretch counts as straight, columns. A line of any direction, drawn in
/// columns, stays below it; a corner of 90 degrees (0.9) is far above.
const STRAIGHT_COLUMNS: f64 = 0.35;
/// Fewest sides of an outline that counts as a wall; shorter ones are posts, lamps, signs.
const FEWEST_SIDES: usize = 12;

const NX: usize = Window::NX;
const NY: usize = Window::NY;
/// Steps along +x, +y, -x, -y; the next in the list is a turn to the left.
const STEP: [(isize, isize); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// A side of a column as a step between two corners of the column raster, with the part on its left: (corner, direction).
type OutlineStep = usize;

fn side(x: usize, y: usize, direction: usize) -> OutlineStep {
    (x * (NY + 1) + y) * 4 + direction
}

fn middle(side: OutlineStep) -> (f64, f64) {
    let (corner, direction) = (side / 4, STEP[side % 4]);
    let half = |v: usize, d: isize| v as f64 + 0.5 * d as f64;
    (
        half(corner / (NY + 1), direction.0),
        half(corner % (NY + 1), direction.1),
    )
}

/// For every side of an outline, the sides before and behind it, unless the outline ends at the edge of the grid.
struct Outlines {
    before: Vec<Option<OutlineStep>>,
    behind: Vec<Option<OutlineStep>>,
    sides: Vec<OutlineStep>,
}

impl Outlines {
    fn from_mask(inside: &[bool]) -> Self {
        let open = |x: isize, y: isize| {
            let within = (0..NX as isize).contains(&x) && (0..NY as isize).contains(&y);
            within && !inside[x as usize * NY + y as usize]
        };
        let mut sides = Vec::new();
        let mut present = vec![false; (NX + 1) * (NY + 1) * 4];
        for c in (0..inside.len()).filter(|c| inside[*c]) {
            let (x, y) = (c / NY, c % NY);
            let all = [
                (0, -1, side(x, y, 0)),
                (1, 0, side(x + 1, y, 1)),
                (0, 1, side(x + 1, y + 1, 2)),
                (-1, 0, side(x, y + 1, 3)),
            ];
            for (dx, dy, side) in all {
                if open(x as isize + dx, y as isize + dy) {
                    present[side] = true;
                    sides.push(side);
                }
            }
        }
        let (mut before, mut behind) = (vec![None; present.len()], vec![None; present.len()]);
        for &from in &sides {
            let (corner, direction) = (from / 4, from % 4);
            let (dx, dy) = STEP[direction];
            let x = (corner / (NY + 1)) as isize + dx;
            let y = (corner % (NY + 1)) as isize + dy;
            // Turns right first: parts that touch by a corner are one, so that a thin slanting wall is not cut up.
            let turns =
                [direction + 3, direction, direction + 1].map(|d| side(x as usize, y as usize, d % 4));
            if let Some(to) = turns.into_iter().find(|s| present[*s]) {
                behind[from] = Some(to);
                before[to] = Some(from);
            }
        }
        Self {
            before,
            behind,
            sides,
        }
    }

    /// A side with `REACH` sides before and behind it; `None` near an end and on the outline of something small.
    fn stretch(&self, middle: OutlineStep) -> Option<Vec<OutlineStep>> {
        let walk = |links: &[Option<OutlineStep>], n: usize| -> Option<Vec<OutlineStep>> {
            let mut at = middle;
            (0..n)
                .map(|_| {
                    at = links[at]?;
                    Some(at)
                })
                .collect()
        };
        let mut out = walk(&self.before, REACH)?;
        let behind = walk(&self.behind, REACH)?;
        // Leaves out a closed outline that returns to its start too soon.
        let mut at = middle;
        for _ in 1..FEWEST_SIDES {
            match self.behind[at] {
                Some(next) if next == middle => return None,
                Some(next) => at = next,
                None => break,
            }
        }
        out.extend(behind);
        out.push(middle);
        Some(out)
    }
}

/// RMS distance of points to the line that fits them best.
fn deviation(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (sx, sy) = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (mx, my) = (sx / n, sy / n);
    let [mut a, mut b, mut c] = [0.0; 3];
    for (x, y) in points {
        a += (x - mx).powi(2) / n;
        b += (x - mx) * (y - my) / n;
        c += (y - my).powi(2) / n;
    }
    let least = (a + c - ((a - c).powi(2) + 4.0 * b * b).sqrt()) / 2.0;
    least.max(0.0).sqrt()
}

pub fn figures(grid: &VoxelGrid, out: &mut ShapeFigures) {
    let inside: Vec<bool> = tops(grid).iter().map(Option::is_some).collect();
    let outlines = Outlines::from_mask(&inside);
    let stretches = outlines.sides.iter().filter_map(|s| outlines.stretch(*s));
    let deviations: Vec<f64> = stretches
        .map(|s| deviation(&s.into_iter().map(middle).collect::<Vec<_>>()))
        .collect();
    let straight = deviations.iter().filter(|d| **d <= STRAIGHT_COLUMNS).count();
    share(out, STRAIGHT, straight, deviations.len());
    if !deviations.is_empty() {
        let mean = deviations.iter().sum::<f64>() / deviations.len() as f64;
        out.insert(DEVIATION_M, mean * Window::VOXEL_M);
    }
}
