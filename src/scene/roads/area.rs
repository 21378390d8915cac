//! The columns alongside a line, and their places along it.

use glam::DVec2;

use crate::Extent;

/// A column near a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alongside {
    /// The column.
    pub cell: [usize; 2],
    /// Distance along the line to its nearest point, m.
    pub along_m: f64,
    /// Distance to the left of the line, m.
    pub left_m: f64,
}

/// Tolerance beyond the ends of a line within which columns still count, m.
const BEYOND_M: f64 = 0.01;

/// The columns of a map whose middle lies within `reach_m` of a line and not beyond its ends, each once, with the
/// nearest place on the line.
pub(super) fn alongside(extent: Extent, line_m: &[DVec2], reach_m: f64) -> Vec<Alongside> {
    let Some((lo, hi)) = bounds(line_m) else {
        return Vec::new();
    };
    let column = |p: DVec2, upper: bool| {
        let at = extent.to_voxel_units(p.extend(0.0)).truncate();
        let last = [extent.nx(), extent.ny()].map(|n| n as f64 - 1.0);
        let at = if upper { at.ceil() } else { at.floor() };
        [
            at.x.clamp(0.0, last[0]) as usize,
            at.y.clamp(0.0, last[1]) as usize,
        ]
    };
    let (from, to) = (column(lo - reach_m, false), column(hi + reach_m, true));
    let (w, h) = (to[0] - from[0] + 1, to[1] - from[1] + 1);
    // Distance, along, left; the distance is infinite until a segment comes near.
    let mut best = vec![(f64::INFINITY, 0.0, 0.0); w * h];
    let (mut along, pieces) = (0.0, line_m.len() - 1);
    for (i, [a, b]) in line_m.array_windows::<2>().enumerate() {
        let (d, length) = (*b - *a, a.distance(*b));
        if !(length.is_finite() && length > 0.0) {
            continue;
        }
        let (lo, hi) = (
            column(a.min(*b) - reach_m, false),
            column(a.max(*b) + reach_m, true),
        );
        for x in lo[0].max(from[0])..=hi[0].min(to[0]) {
            for y in lo[1].max(from[1])..=hi[1].min(to[1]) {
                let p = extent.center(x, y, 0).truncate();
                let t = (p - *a).dot(d) / (length * length);
                let beyond =
                    i == 0 && t * length < -BEYOND_M || i + 1 == pieces && (t - 1.0) * length > BEYOND_M;
                let t = t.clamp(0.0, 1.0);
                let apart = p.distance(*a + d * t);
                let best = &mut best[(x - from[0]) * h + y - from[1]];
                if apart <= reach_m && apart < best.0 {
                    let left = apart.copysign(d.perp_dot(p - *a));
                    // A place beyond the end is nearest to the end, and left out below.
                    *best = (apart, if beyond { f64::NAN } else { along + t * length }, left);
                }
            }
        }
        along += length;
    }
    let near = best
        .iter()
        .enumerate()
        .filter(|(_, b)| b.0.is_finite() && b.1.is_finite());
    near.map(|(i, b)| Alongside {
        cell: [from[0] + i / h, from[1] + i % h],
        along_m: b.1,
        left_m: b.2,
    })
    .collect()
}

fn bounds(line_m: &[DVec2]) -> Option<(DVec2, DVec2)> {
    let all = || line_m.iter().copied().filter(|p| p.is_finite());
    let enough = line_m.len() > 1;
    Some((all().reduce(DVec2::min)?, all().reduce(DVec2::max)?)).filter(|_| enough)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_know_where_they_are() {
        let line = [DVec2::new(-10.0, 0.0), DVec2::new(10.0, 0.0)];
        let found = alongside(Extent::WINDOW, &line, 2.0);
        assert_eq!(found.len(), 50 * 10);
        for a in &found {
            let p = Extent::WINDOW.center(a.cell[0], a.cell[1], 0);
            assert!((a.left_m - p.y).abs() < 1e-9 && (a.along_m - p.x - 10.0).abs() < 1e-9);
        }
        assert!(alongside(Extent::WINDOW, &line[..1], 2.0).is_empty());
        let far = [DVec2::splat(500.0), DVec2::splat(600.0)];
        assert!(alongside(Extent::WINDOW, &far, 2.0).is_empty());
    }
}
