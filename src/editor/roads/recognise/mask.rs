//! Mask of the paved columns, with a margin beyond the border of the map so that roads run on through it.

use glam::DVec2;

use scene::distance::signed_distance_m;
use scene::{BevLayer, BevLayout, Extent};

/// Width of the margin beyond the border, columns.
const MARGIN: usize = 25;
/// Smallest patch of road, or hole in it, that counts, columns.
const FEWEST: usize = 45;

/// Paved columns.
pub(super) struct Mask {
    /// Columns of the map and its margin.
    pub extent: Extent,
    /// Columns of the map.
    pub map: Extent,
    /// `[x][y]` of `extent`.
    pub paved: Vec<bool>,
    /// Distance to the kerb within the paved columns, m.
    pub depth_m: Vec<f64>,
}

impl Mask {
    /// Reads the paved columns of a layout without the `own` columns; `None` if no column is paved.
    pub fn from_layout(layout: &BevLayout, own: &[bool]) -> Option<Self> {
        let map = layout.extent();
        let [x0, y0] = map.from();
        let from = [x0 - MARGIN as i32, y0 - MARGIN as i32];
        let extent = map
            .with_columns(from, [map.nx() + 2 * MARGIN, map.ny() + 2 * MARGIN])
            .ok()?;
        let inner = |at: usize, n: usize| at.saturating_sub(MARGIN).min(n - 1);
        let is_paved = |[x, y]: [usize; 2]| {
            let (x, y) = (inner(x, map.nx()), inner(y, map.ny()));
            let is_own = own.get(map.index(x, y)).copied().unwrap_or(false);
            layout.has(BevLayer::DrivableArea, x, y) && !is_own
        };
        let mut paved: Vec<bool> = extent.all_columns().map(is_paved).collect();
        for value in [false, true] {
            drop_small(extent, &mut paved, value);
        }
        if !paved.contains(&true) {
            return None;
        }
        let depth_m = signed_distance_m(extent, |i| paved[i]);
        let depth_m = depth_m
            .into_iter()
            .map(|d| f64::from((-d).clamp(0.0, 100.0)))
            .collect();
        Some(Self {
            extent,
            map,
            paved,
            depth_m,
        })
    }

    /// Middle of a column, world frame, m.
    pub fn point_m(&self, i: usize) -> DVec2 {
        let [x, y] = self.extent.column(i);
        self.extent.center(x, y, 0).truncate()
    }

    /// Distance to the kerb at a point, m; 0 outside.
    pub fn depth_at(&self, p: DVec2) -> f64 {
        let cell = self.extent.column_at(p.x, p.y);
        cell.map_or(0.0, |[x, y]| self.depth_m[self.extent.index(x, y)])
    }

    /// True within the map, without its margin.
    pub fn is_on_map(&self, p: DVec2) -> bool {
        self.map.column_at(p.x, p.y).is_some()
    }
}

/// The columns of each connected part with that value, side by side.
pub(super) fn parts(extent: Extent, cells: &[bool], value: bool) -> Vec<Vec<usize>> {
    let (nx, ny) = (extent.nx(), extent.ny());
    let mut seen = vec![false; cells.len()];
    let mut out = Vec::new();
    for start in 0..cells.len() {
        if cells[start] != value || seen[start] {
            continue;
        }
        let (mut part, mut open) = (Vec::new(), vec![start]);
        seen[start] = true;
        while let Some(i) = open.pop() {
            part.push(i);
            let (x, y) = (i / ny, i % ny);
            let beside = [
                (x > 0).then(|| i - ny),
                (x + 1 < nx).then(|| i + ny),
                (y > 0).then(|| i - 1),
                (y + 1 < ny).then(|| i + 1),
            ];
            for j in beside.into_iter().flatten() {
                if cells[j] == value && !seen[j] {
                    seen[j] = true;
                    open.push(j);
                }
            }
        }
        out.push(part);
    }
    out
}

fn drop_small(extent: Extent, cells: &mut [bool], value: bool) {
    for part in parts(extent, cells, value) {
        if part.len() < FEWEST {
            part.into_iter().for_each(|i| cells[i] = !value);
        }
    }
}
