//! Triangles to columns: every column that a triangle touches, and between which heights. Nothing that is touched is missed,
//! so a wall has no holes.

use glam::DVec3;
use scene::Extent;

use super::work::{MOST_WORK, RIM};
use crate::FormatError;

/// Surfaces are moved up by this, in voxels, so that one on the border of two voxels belongs to the upper one alone.
const NUDGE: f64 = 1e-4;

/// Passes triangles on column by column, as long as that takes a bearable time.
pub(crate) struct TriangleRasteriser {
    extent: Extent,
    visits: u64,
}

/// The corners of a triangle after cuts; at most seven after four cuts.
struct ClippedTriangle {
    list: [DVec3; 8],
    count: usize,
}

impl TriangleRasteriser {
    /// For a map.
    pub(crate) fn new(extent: Extent) -> Self {
        Self { extent, visits: 0 }
    }

    /// Cost of [`visit`](Self::visit) for a triangle (m), told without doing it: one unit for each column that the
    /// triangle covers wholly, and [`RIM`] for each along its rim.
    pub(crate) fn cost(extent: Extent, corners: [DVec3; 3]) -> u64 {
        let corners = corners.map(|p| extent.to_voxel_units(p));
        let n = [extent.nx() as f64, extent.ny() as f64];
        let mut on_map = ClippedTriangle::from_corners(&corners);
        for (axis, n) in n.into_iter().enumerate() {
            on_map = on_map.half(axis, 0.0, 1.0).half(axis, n, -1.0);
        }
        let (Some([x0, x1]), Some([y0, y1])) = (on_map.range(0), on_map.range(1)) else {
            return 0;
        };
        let (rim, area) = (x1 - x0 + y1 - y0 + 1.0, on_map.area());
        // Not finite only where no column is touched.
        (area + rim * RIM as f64) as u64
    }

    /// Visits the columns that a triangle (m) touches, with the lowest and the highest point of it there, in voxels (0 at the
    /// bottom of the map, not cut to it).
    pub(crate) fn visit(&mut self, corners: [DVec3; 3], mut visit: impl FnMut([usize; 2], [f64; 2])) {
        let corners = corners.map(|p| self.extent.to_voxel_units(p) + DVec3::splat(NUDGE));
        let n = [self.extent.nx(), self.extent.ny()];
        let whole = ClippedTriangle::from_corners(&corners);
        let Some((x0, x1)) = whole.columns(0, n[0]) else {
            return;
        };
        for x in x0..=x1 {
            let strip = whole.cut(0, x as f64);
            let Some((y0, y1)) = strip.columns(1, n[1]) else {
                continue;
            };
            self.visits += (y1 - y0 + 1) as u64;
            if self.visits > MOST_WORK {
                return;
            }
            let inner = strip.inner(x as f64, (y0, y1));
            for y in y0..=y1 {
                match &inner {
                    Some(inner) if (inner.from..inner.to).contains(&y) => visit([x, y], inner.heights(y)),
                    _ => {
                        if let Some(heights) = strip.cut(1, y as f64).range(2) {
                            visit([x, y], heights);
                        }
                    }
                }
            }
        }
    }

    /// Errors where the triangles covered more than is looked at.
    pub(crate) fn finish(&self) -> Result<(), FormatError> {
        match self.visits > MOST_WORK {
            true => Err(FormatError::new(format!(
                "surfaces of more than {MOST_WORK} columns in all, expected fewer or a smaller map"
            ))),
            false => Ok(()),
        }
    }
}

/// The columns of a strip that a triangle covers wholly: their heights follow from those on the two sides of the strip.
struct Inner {
    /// First such column, and the one after the last.
    from: usize,
    to: usize,
    /// Height at y = 0 and its rise over y, on both sides.
    sides: [[f64; 2]; 2],
}

impl Inner {
    fn heights(&self, y: usize) -> [f64; 2] {
        let at = |[base, rise]: [f64; 2], y: f64| base + rise * y;
        let corner = |side: usize, y: usize| at(self.sides[side], y as f64);
        let all = [corner(0, y), corner(0, y + 1), corner(1, y), corner(1, y + 1)];
        let low = all[0].min(all[1]).min(all[2].min(all[3]));
        [low, all[0].max(all[1]).max(all[2].max(all[3]))]
    }
}

impl ClippedTriangle {
    fn from_corners(corners: &[DVec3]) -> Self {
        let mut list = [DVec3::ZERO; 8];
        let count = corners.len().min(list.len());
        list[..count].copy_from_slice(&corners[..count]);
        Self { list, count }
    }

    fn all(&self) -> &[DVec3] {
        &self.list[..self.count]
    }

    /// Least and greatest value on an axis; `None` where there is nothing.
    fn range(&self, axis: usize) -> Option<[f64; 2]> {
        let values = || self.all().iter().map(|p| p[axis]);
        let low = values().reduce(f64::min)?;
        Some([low, values().reduce(f64::max)?])
    }

    /// First and last column on an axis that it touches, of `n`.
    fn columns(&self, axis: usize, n: usize) -> Option<(usize, usize)> {
        let [low, high] = self.range(axis)?;
        // Written so that NaN fails too.
        if !(high >= 0.0 && low < n as f64) {
            return None;
        }
        Some((low.max(0.0) as usize, high.min(n as f64 - 1.0) as usize))
    }

    /// Its area seen from above.
    fn area(&self) -> f64 {
        let all = self.all();
        let first = all.first().copied().unwrap_or_default().truncate();
        let twice = |pair: &[DVec3]| (pair[0].truncate() - first).perp_dot(pair[1].truncate() - first);
        (all.windows(2).map(twice).sum::<f64>() / 2.0).abs()
    }

    /// The columns among some that the part of a triangle between x and x + 1 covers wholly.
    fn inner(&self, x: f64, (y0, y1): (usize, usize)) -> Option<Inner> {
        let side = |at: f64| {
            let on_side = || self.all().iter().filter(|p| p.x == at);
            let low = on_side().min_by(|a, b| a.y.total_cmp(&b.y))?;
            let high = on_side().max_by(|a, b| a.y.total_cmp(&b.y))?;
            Some([*low, *high])
        };
        let sides = [side(x)?, side(x + 1.0)?];
        let low = sides[0][0].y.max(sides[1][0].y).max(y0 as f64).ceil();
        let high = sides[0][1].y.min(sides[1][1].y).min(y1 as f64 + 1.0).floor();
        // Where a column fits, both sides are longer than one.
        let line = |[a, b]: [DVec3; 2]| {
            let rise = (b.z - a.z) / (b.y - a.y);
            [a.z - rise * a.y, rise]
        };
        (low < high).then(|| Inner {
            from: low as usize,
            to: high as usize,
            sides: sides.map(line),
        })
    }

    /// The part of it between a coordinate and the next whole one.
    fn cut(&self, axis: usize, from: f64) -> Self {
        self.half(axis, from, 1.0).half(axis, from + 1.0, -1.0)
    }

    /// The part of it on one side of a plane (Sutherland and Hodgman 1974).
    fn half(&self, axis: usize, at: f64, side: f64) -> Self {
        let mut out = Self {
            list: [DVec3::ZERO; 8],
            count: 0,
        };
        let mut push = |p: DVec3| {
            if let Some(slot) = out.list.get_mut(out.count) {
                *slot = p;
                out.count += 1;
            }
        };
        let inside = |p: DVec3| (p[axis] - at) * side >= 0.0;
        let all = self.all();
        for (i, a) in all.iter().enumerate() {
            let b = all[(i + 1) % all.len()];
            if inside(*a) {
                push(*a);
            }
            if inside(*a) != inside(b) {
                let mut p = a.lerp(b, (at - a[axis]) / (b[axis] - a[axis]));
                p[axis] = at;
                push(p);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn visited(corners: [DVec3; 3]) -> BTreeMap<[usize; 2], [f64; 2]> {
        let (mut surface, mut out) = (TriangleRasteriser::new(Extent::WINDOW), BTreeMap::new());
        surface.visit(corners, |column, heights| {
            assert_eq!(out.insert(column, heights), None, "a column twice");
        });
        surface.finish().expect("little work");
        out
    }

    /// A ray through the middle of any voxel-sized hole would show it: along a slanted wall every column row is touched.
    #[test]
    fn a_slanted_wall_has_no_holes() {
        let (a, b) = (DVec3::new(-7.3, 1.2, 0.0), DVec3::new(11.9, 9.7, 0.0));
        let up = DVec3::Z * 3.0;
        let mut columns = visited([a, b, b + up]);
        columns.extend(visited([a, b + up, a + up]));
        for i in 0..=5000 {
            let p = a.lerp(b, f64::from(i) / 5000.0);
            let [x, y] = Extent::WINDOW.column_at(p.x, p.y).expect("inside");
            assert!(columns.contains_key(&[x, y]), "{p}");
        }
        assert!(columns.len() < 100, "{} columns, not a thick wall", columns.len());
    }

    #[test]
    fn heights_are_those_within_the_column() {
        // z rises with x: 0.5 m over each metre.
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.5 * x);
        let columns = visited([at(0.0, -1.0), at(8.0, -1.0), at(4.0, 3.0)]);
        let [low, high] = columns[&[110, 99]]; // x from 4 to 4.4 m
        assert!((low - (2.0 + 1.0) * 2.5).abs() < 1e-3 && (high - (2.2 + 1.0) * 2.5).abs() < 1e-3);
        // A wall on the border of two voxels is in one of them.
        let wall = visited([
            DVec3::new(2.0, 0.1, 0.0),
            DVec3::new(2.0, 0.3, 0.0),
            DVec3::new(2.0, 0.3, 1.0),
        ]);
        assert_eq!(wall.keys().collect::<Vec<_>>(), [&[105, 100]]);
    }

    #[test]
    fn what_is_far_away_costs_nothing_and_a_pile_is_refused() {
        assert!(visited([DVec3::splat(1e30), DVec3::splat(1e31), DVec3::splat(2e30)]).is_empty());
        assert!(visited([DVec3::NAN; 3]).is_empty());
        let mut surface = TriangleRasteriser::new(Extent::new([-512; 2], [1024; 2]).expect("sound"));
        let far = 1e4;
        let all = [
            DVec3::new(-far, -far, 0.0),
            DVec3::new(far, -far, 0.0),
            DVec3::new(0.0, far, 0.0),
        ];
        surface.visits = MOST_WORK - 5000;
        let mut seen = 0u64;
        surface.visit(all, |_, _| seen += 1);
        assert!(seen <= 5000 && surface.finish().is_err());
    }

    /// Columns inside of a triangle have the heights that cutting it gives, and the cost is told beforehand.
    #[test]
    fn heights_within_and_costs_are_those_of_cutting() {
        let extent = Extent::new([-30, 4], [80, 60]).expect("sound");
        let mut state = 9u64;
        let mut dice = |size: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * size
        };
        let mut inside = 0;
        for i in 0..300 {
            let size = [3.0, 30.0, 300.0, 1e11][i % 4];
            let corners = [(); 3].map(|()| DVec3::new(dice(size), dice(size) + 10.0, dice(20.0)));
            let cut = ClippedTriangle::from_corners(
                &corners.map(|p| extent.to_voxel_units(p) + DVec3::splat(NUDGE)),
            );
            let (mut surface, mut visits) = (TriangleRasteriser::new(extent), 0u64);
            surface.visit(corners, |[x, y], [low, high]| {
                let strip = cut.cut(0, x as f64);
                let [l, h] = strip.cut(1, y as f64).range(2).expect("touched");
                let near = 1e-9 * size.max(1.0);
                assert!(
                    (l - low).abs() < near && (h - high).abs() < near,
                    "{l} {low}, {h} {high}"
                );
                visits += 1;
                inside += usize::from(strip.inner(x as f64, (y, y)).is_some());
            });
            let told = TriangleRasteriser::cost(extent, corners);
            assert!(
                told >= visits && told <= visits * RIM + 4 * RIM,
                "{told} for {visits}"
            );
        }
        assert!(inside > 10_000, "{inside}");
    }
}
