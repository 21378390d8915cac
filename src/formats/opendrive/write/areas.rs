//! Ground that no road covers, as outlines along the borders of its cells.

use glam::DVec2;

use scene::Extent;

/// Smaller patches are left out, cells (0.64 m²).
const SMALLEST: usize = 4;

/// Outlines of all cells for which `is_in` holds, m. Each is free of holes; together they cover exactly the patches of
/// at least [`SMALLEST`] cells. Corners lie on borders of cells, so a centre of a cell is never on an edge.
pub(super) fn outlines(extent: Extent, is_in: impl Fn(usize) -> bool) -> Vec<Vec<DVec2>> {
    let is_in = large(extent, is_in);
    let mut open: Vec<PatchRuns> = Vec::new();
    let mut out = Vec::new();
    for x in 0..extent.nx() {
        let runs = runs(extent.ny(), |y| is_in[extent.index(x, y)]);
        let meets = |a: &[usize; 2], b: &[usize; 2]| a[0] < b[1] && b[0] < a[1];
        let before: Vec<PatchRuns> = std::mem::take(&mut open);
        let last: Vec<[usize; 2]> = before.iter().map(|s| s.runs[s.runs.len() - 1]).collect();
        let mut goes_on: Vec<Option<usize>> = vec![None; runs.len()];
        for (i, run) in runs.iter().enumerate() {
            // A patch goes on where one run follows one run; where it parts or joins, new ones begin.
            let mut met = (0..last.len()).filter(|s| meets(&last[*s], run));
            if let (Some(s), None) = (met.next(), met.next()) {
                let alone = runs.iter().filter(|r| meets(&last[s], r)).count() == 1;
                goes_on[i] = alone.then_some(s);
            }
        }
        for (s, sweep) in before.into_iter().enumerate() {
            match goes_on.iter().position(|g| *g == Some(s)) {
                Some(i) => {
                    let mut sweep = sweep;
                    sweep.runs.push(runs[i]);
                    open.push(sweep);
                }
                None => out.push(sweep.outline(extent)),
            }
        }
        let fresh = runs.iter().zip(&goes_on).filter(|(_, g)| g.is_none());
        open.extend(fresh.map(|(run, _)| PatchRuns { x, runs: vec![*run] }));
    }
    out.extend(open.into_iter().map(|s| s.outline(extent)));
    out
}

/// One run of cells in each column of x, from column `x` on.
struct PatchRuns {
    x: usize,
    runs: Vec<[usize; 2]>, // first cell, one behind the last
}

impl PatchRuns {
    /// Counter-clockwise: the lower borders with growing x, then the upper ones back.
    fn outline(&self, extent: Extent) -> Vec<DVec2> {
        let low = extent.min_m().truncate();
        let at = |x: usize, y: usize| low + DVec2::new(x as f64, y as f64) / extent.lattice().per_m();
        let n = self.runs.len();
        let side = |which: usize| {
            let mut points: Vec<DVec2> = Vec::new();
            for (i, run) in self.runs.iter().enumerate() {
                let (x, y) = (self.x + i, run[which]);
                if i == 0 || self.runs[i - 1][which] != y {
                    if i > 0 {
                        points.push(at(x, self.runs[i - 1][which]));
                    }
                    points.push(at(x, y));
                }
            }
            points.push(at(self.x + n, self.runs[n - 1][which]));
            points
        };
        let mut points = side(0);
        points.extend(side(1).into_iter().rev());
        points
    }
}

/// The runs of a column.
fn runs(n: usize, is_in: impl Fn(usize) -> bool) -> Vec<[usize; 2]> {
    let mut out: Vec<[usize; 2]> = Vec::new();
    for y in (0..n).filter(|y| is_in(*y)) {
        match out.last_mut().filter(|run| run[1] == y) {
            Some(run) => run[1] = y + 1,
            None => out.push([y, y + 1]),
        }
    }
    out
}

/// The cells in patches that are large enough, joined by their sides.
fn large(extent: Extent, is_in: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut out: Vec<bool> = (0..extent.columns()).map(is_in).collect();
    let mut seen = vec![false; extent.columns()];
    for first in 0..extent.columns() {
        if !out[first] || seen[first] {
            continue;
        }
        seen[first] = true;
        let mut patch = vec![first];
        let mut next = 0;
        while next < patch.len() {
            let [x, y] = extent.column(patch[next]);
            next += 1;
            let sides = [
                (x > 0).then(|| extent.index(x - 1, y)),
                (x + 1 < extent.nx()).then(|| extent.index(x + 1, y)),
                (y > 0).then(|| extent.index(x, y - 1)),
                (y + 1 < extent.ny()).then(|| extent.index(x, y + 1)),
            ];
            for side in sides.into_iter().flatten() {
                if out[side] && !std::mem::replace(&mut seen[side], true) {
                    patch.push(side);
                }
            }
        }
        if patch.len() < SMALLEST {
            patch.iter().for_each(|c| out[*c] = false);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use scene::raster::polygon_cells;

    use super::*;

    #[test]
    fn outlines_cover_their_cells_and_no_others() {
        let extent = Extent::new([-10, 5], [40, 30]).expect("a map");
        // A ring with a spur, a speck, and a comb.
        let is_in = |c: usize| {
            let [x, y] = extent.column(c);
            let from = (x as f64 - 12.0).hypot(y as f64 - 12.0);
            (5.0..9.0).contains(&from)
                || (y == 12 && (20..26).contains(&x))
                || (x, y) == (1, 28)
                || (x > 28 && y > 20 && (y == 21 || x % 3 == 0))
        };
        let mut covered = vec![0; extent.columns()];
        for outline in outlines(extent, is_in) {
            assert!(outline.len() >= 4);
            polygon_cells(extent, &outline, |x, y| covered[extent.index(x, y)] += 1);
        }
        for (c, times) in covered.iter().enumerate() {
            let expected = is_in(c) && extent.column(c) != [1, 28];
            assert_eq!(*times, usize::from(expected), "{:?}", extent.column(c));
        }
        assert!(outlines(extent, |_| false).is_empty());
    }
}
