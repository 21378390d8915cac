//! Shapes to grid cells: boxes, discs, polygons and lines, in the ego frame.

use glam::{DVec2, DVec3};

use super::{BevLayer, BevLayout, Extent, Polyline, PolylineKind, SceneBox};

/// Cells whose centre may lie in the given ego-frame rectangle, cut to the map; `None` if none can.
fn cell_range(extent: Extent, min: DVec2, max: DVec2) -> Option<([usize; 2], [usize; 2])> {
    let lo = extent.to_voxel_units(min.extend(0.0));
    let hi = extent.to_voxel_units(max.extend(0.0));
    let n = [extent.nx() as f64, extent.ny() as f64];
    let (mut from, mut to) = ([0; 2], [0; 2]);
    for axis in 0..2 {
        // Written so that NaN fails too.
        if !(hi[axis] >= 0.0 && lo[axis] < n[axis] && lo[axis] <= hi[axis]) {
            return None;
        }
        from[axis] = lo[axis].max(0.0) as usize;
        to[axis] = (hi[axis].min(n[axis] - 1.0)) as usize;
    }
    Some((from, to))
}

fn for_cells(extent: Extent, min: DVec2, max: DVec2, mut visit: impl FnMut(usize, usize, DVec2)) {
    if let Some((from, to)) = cell_range(extent, min, max) {
        for x in from[0]..=to[0] {
            for y in from[1]..=to[1] {
                visit(x, y, extent.center(x, y, 0).truncate());
            }
        }
    }
}

/// Visits the cells of a box's footprint grown by `margin_m`: those whose centre lies inside, and
/// always the cell under the box's own centre, so that a box below one cell is not lost.
/// A box with NaN visits nothing.
pub fn box_cells(extent: Extent, b: &SceneBox, margin_m: f64, mut visit: impl FnMut(usize, usize)) {
    let reach = b.size_m.truncate() / 2.0 + DVec2::splat(margin_m);
    let radius = reach.length();
    let center = b.center_m.truncate();
    let own = extent.column_at(center.x, center.y);
    let mut own_seen = false;
    for_cells(extent, center - radius, center + radius, |x, y, p| {
        let local = b.to_local(DVec3::new(p.x, p.y, b.center_m.z));
        // Half-open, so that an edge on a row of cell centres counts once.
        let within = |v: f64, r: f64| -r <= v && v < r;
        if within(local.x, reach.x) && within(local.y, reach.y) {
            own_seen |= own == Some([x, y]);
            visit(x, y);
        }
    });
    if let (false, Some([x, y])) = (own_seen, own)
        && b.yaw_rad.is_finite()
        && reach.is_finite()
    {
        visit(x, y);
    }
}

/// Visits the cells whose centre lies in a disc, and the cell under its centre.
pub fn disc_cells(extent: Extent, center_m: DVec2, radius_m: f64, mut visit: impl FnMut(usize, usize)) {
    let own = extent.column_at(center_m.x, center_m.y);
    for_cells(extent, center_m - radius_m, center_m + radius_m, |x, y, p| {
        if p.distance_squared(center_m) <= radius_m * radius_m || own == Some([x, y]) {
            visit(x, y);
        }
    });
}

/// Visits the cells whose centre lies inside a closed polygon (even-odd rule).
pub fn polygon_cells(extent: Extent, points_m: &[DVec2], mut visit: impl FnMut(usize, usize)) {
    if points_m.len() < 3 || points_m.iter().any(|p| !p.is_finite()) {
        return;
    }
    let min = points_m.iter().copied().reduce(DVec2::min).expect("three points");
    let max = points_m.iter().copied().reduce(DVec2::max).expect("three points");
    let Some((from, to)) = cell_range(extent, min, max) else {
        return;
    };
    // One scan line per row of cell centres: crossings are sorted, cells between pairs are inside.
    let mut crossings = Vec::new();
    for x in from[0]..=to[0] {
        let line = extent.center(x, 0, 0).x;
        crossings.clear();
        for (i, a) in points_m.iter().enumerate() {
            let b = points_m[(i + 1) % points_m.len()];
            if (a.x <= line) != (b.x <= line) {
                crossings.push(a.y + (line - a.x) / (b.x - a.x) * (b.y - a.y));
            }
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let lo = (extent.to_voxel_units(DVec3::new(0.0, pair[0], 0.0)).y - 0.5).ceil();
            let hi = (extent.to_voxel_units(DVec3::new(0.0, pair[1], 0.0)).y - 0.5).floor();
            for y in lo.max(0.0) as i64..=hi.min(extent.ny() as f64 - 1.0) as i64 {
                visit(x, y as usize);
            }
        }
    }
}

/// Visits the cells whose centre lies within `half_width_m` of an open polyline. Zero-length
/// segments are skipped, vertices that are not finite end their segments. Every cell is visited once.
/// The work is that of the cells along the line, however large the map and however far away its vertices are.
pub fn line_cells(
    extent: Extent,
    points_m: &[DVec2],
    half_width_m: f64,
    mut visit: impl FnMut(usize, usize),
) {
    let sound = |p: &&DVec2| p.is_finite();
    let low = points_m.iter().filter(sound).copied().reduce(DVec2::min);
    let high = points_m.iter().filter(sound).copied().reduce(DVec2::max);
    let (Some(low), Some(high)) = (low, high) else {
        return;
    };
    let Some((first, last)) = cell_range(extent, low - half_width_m, high + half_width_m) else {
        return;
    };
    // The short segments of a wide bend overlap almost wholly.
    let rows = last[1] - first[1] + 1;
    let mut seen = vec![false; (last[0] - first[0] + 1) * rows];
    for pair in points_m.windows(2) {
        segment_cells(extent, [pair[0], pair[1]], half_width_m, |x, y| {
            let seen = &mut seen[(x - first[0]) * rows + y - first[1]];
            if !std::mem::replace(seen, true) {
                visit(x, y);
            }
        });
    }
}

/// Visits the cells whose centre lies within a distance of a segment; in each column only the rows that may lie near
/// are tested.
fn segment_cells(extent: Extent, [a, b]: [DVec2; 2], half_width_m: f64, mut visit: impl FnMut(usize, usize)) {
    let d = b - a;
    let length_squared = d.length_squared();
    if !(length_squared.is_finite() && length_squared > 0.0) {
        return;
    }
    let range = cell_range(extent, a.min(b) - half_width_m, a.max(b) + half_width_m);
    let Some((from, to)) = range else { return };
    for x in from[0]..=to[0] {
        for y in rows_near(extent, [a, b], half_width_m, x) {
            if y < from[1] || y > to[1] {
                continue;
            }
            let p = extent.center(x, y, 0).truncate();
            let t = ((p - a).dot(d) / length_squared).clamp(0.0, 1.0);
            if p.distance_squared(a + d * t) <= half_width_m * half_width_m {
                visit(x, y);
            }
        }
    }
}

/// Rows of a column that may lie near a segment: all that do, and about two more on each side.
fn rows_near(extent: Extent, [a, b]: [DVec2; 2], half_width_m: f64, x: usize) -> std::ops::Range<usize> {
    // One cell more on every side, so that rounding does not matter.
    let reach_m = half_width_m + extent.voxel_m();
    let at_m = extent.center(x, 0, 0).x;
    let d = b - a;
    // The y of the part of the segment that comes near enough to the column in x.
    let ends = match d.x == 0.0 {
        true => [a.y, b.y],
        false => [at_m - reach_m, at_m + reach_m].map(|x_m| a.y + d.y * ((x_m - a.x) / d.x).clamp(0.0, 1.0)),
    };
    let row = |y_m: f64| extent.to_voxel_units(DVec3::new(0.0, y_m, 0.0)).y;
    let low = row(ends[0].min(ends[1]) - reach_m).max(0.0) as usize;
    let high = row(ends[0].max(ends[1]) + reach_m).clamp(-1.0, extent.ny() as f64 - 1.0) + 1.0;
    low..high as usize
}

/// Draws a polyline into the layer of its kind. Lines are one cell wide (half width 0.2 m and a
/// little, so that a diagonal stays connected), crossings are filled.
pub fn draw_polyline(layout: &mut BevLayout, line: &Polyline) {
    const HALF_LINE_M: f64 = 0.21;
    let mut cells = Vec::new();
    let layer = match line.kind {
        PolylineKind::LaneCenter | PolylineKind::SpeedLimit { .. } => return,
        PolylineKind::RoadDivider => BevLayer::RoadDivider,
        PolylineKind::LaneDivider => BevLayer::LaneDivider,
        PolylineKind::StopLine => BevLayer::StopLine,
        PolylineKind::PedCrossing => BevLayer::PedCrossing,
    };
    if line.kind == PolylineKind::PedCrossing {
        polygon_cells(layout.extent(), &line.points_m, |x, y| cells.push((x, y)));
    } else {
        line_cells(layout.extent(), &line.points_m, HALF_LINE_M, |x, y| {
            cells.push((x, y))
        });
    }
    for (x, y) in cells {
        layout.set(layer, x, y, true);
    }
}

/// All 18 channels as bits, `[x][y]`: the layout's map layers and the boxes' footprints.
pub fn bev_channels<'a>(layout: &BevLayout, boxes: impl Iterator<Item = &'a SceneBox>) -> Vec<u32> {
    let (extent, mut cells) = (layout.extent(), layout.cells().to_vec());
    for b in boxes {
        if let Some(layer) = BevLayer::of_object(b.class) {
            box_cells(extent, b, 0.0, |x, y| cells[extent.index(x, y)] |= layer.bit());
        }
    }
    cells
}

/// Number of quantised headings, besides 0 for none.
pub const HEADINGS: u8 = 240;

/// The heading of the object in every column, `[x][y]`: 0 where there is none, else 1 +
/// yaw / (2 pi / [`HEADINGS`]), rounded. A later box covers an earlier one.
pub fn headings<'a>(extent: Extent, boxes: impl Iterator<Item = &'a SceneBox>) -> Vec<u8> {
    let mut cells = vec![0; extent.columns()];
    for b in boxes.filter(|b| BevLayer::of_object(b.class).is_some()) {
        let turns = (b.yaw_rad / std::f64::consts::TAU).rem_euclid(1.0);
        let code = 1 + (turns * f64::from(HEADINGS)).round() as u8 % HEADINGS;
        box_cells(extent, b, 0.0, |x, y| cells[extent.index(x, y)] = code);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoxId, Class};

    fn car(center: [f64; 3], size: [f64; 3], yaw_rad: f64) -> SceneBox {
        SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: center.into(),
            size_m: size.into(),
            yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    fn cells(b: &SceneBox) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        box_cells(crate::Extent::WINDOW, b, 0.0, |x, y| out.push((x, y)));
        out
    }

    #[test]
    fn headings_are_codes_of_the_yaw() {
        use std::f64::consts::{FRAC_PI_2, TAU};
        for (yaw, code) in [
            (0.0, 1),
            (FRAC_PI_2, 61),
            (-FRAC_PI_2, 181),
            (TAU - 1e-9, 1),
            (3.0 * TAU, 1),
        ] {
            let b = car([1.0, 2.0, 0.0], [4.0, 2.0, 2.0], yaw);
            let found = headings(crate::Extent::WINDOW, [b].iter());
            assert_eq!(found.iter().max(), Some(&code), "yaw {yaw}");
            let set = found.iter().filter(|c| **c != 0).count();
            assert_eq!(set, cells(&b).len());
        }
        let nowhere = car([1.0, 2.0, 0.0], [4.0, 2.0, 2.0], f64::NAN);
        assert!(
            headings(crate::Extent::WINDOW, [nowhere].iter())
                .iter()
                .all(|c| *c == 0)
        );
    }

    /// Row 35 of the extremes table.
    #[test]
    fn row_35_box_raster() {
        for yaw in [0.0, 0.3, 1.0, 2.5] {
            let b = car([1.0, 2.0, 0.0], [20.0, 10.0, 2.0], yaw);
            let area = cells(&b).len() as f64 * 0.16;
            assert!((area - 200.0).abs() < 6.0, "area {area} at yaw {yaw}");
            let turned = car([1.0, 2.0, 0.0], [20.0, 10.0, 2.0], yaw + std::f64::consts::TAU);
            assert_eq!(cells(&b), cells(&turned));
        }
        // Far turned: the reduction in f64 keeps the heading to 1e-9 rad, so cells agree.
        let far = car([1.1, 2.1, 0.0], [4.0, 2.0, 2.0], 2e6 * std::f64::consts::PI);
        assert_eq!(cells(&far), cells(&car([1.1, 2.1, 0.0], [4.0, 2.0, 2.0], 0.0)));
        assert_eq!(
            cells(&car([0.1, 0.1, 0.0], [0.0, 0.0, 0.0], 0.0)),
            vec![(100, 100)]
        );
        assert_eq!(
            cells(&car([0.1, 0.1, 0.0], [0.01, 0.01, 0.1], 0.7)),
            vec![(100, 100)]
        );
        assert_eq!(
            cells(&car([0.0; 3], [1e6, 1e6, 1e6], 0.5)).len(),
            crate::Window::COLUMNS
        );
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(cells(&car([bad, 0.0, 0.0], [1.0; 3], 0.0)).is_empty());
            assert!(cells(&car([0.0; 3], [bad, 1.0, 1.0], 0.0)).is_empty() || bad.is_infinite());
            assert!(cells(&car([0.0; 3], [1.0; 3], bad)).is_empty());
        }
    }

    /// Row 36 of the extremes table.
    #[test]
    fn row_36_polyline() {
        let draw = |points: &[DVec2]| {
            let mut out = std::collections::BTreeSet::new();
            line_cells(crate::Extent::WINDOW, points, 0.3, |x, y| {
                out.insert((x, y));
            });
            out
        };
        let (a, b, c) = (DVec2::new(-3.0, 0.1), DVec2::new(4.0, 2.0), DVec2::new(0.0, -5.0));
        assert!(draw(&[a]).is_empty());
        assert_eq!(draw(&[a, a, b, b, b, c]), draw(&[a, b, c]));
        assert!(!draw(&[a, b, c, a]).is_empty());
        assert!(draw(&[a, DVec2::NAN, b]).is_empty());
        let spiral: Vec<DVec2> = (0..100_000)
            .map(|i| DVec2::from_angle(f64::from(i) * 0.01) * (f64::from(i) * 2e-4))
            .collect();
        assert!(!draw(&spiral).is_empty());
        let mut square = 0;
        polygon_cells(
            crate::Extent::WINDOW,
            &[
                DVec2::new(0.0, 0.0),
                DVec2::new(4.0, 0.0),
                DVec2::new(4.0, 4.0),
                DVec2::new(0.0, 4.0),
            ],
            |_, _| square += 1,
        );
        assert_eq!(square, 100);
    }

    /// Points drawn from a fixed sequence, with some far beyond the map.
    fn points(seed: u64, count: usize) -> Vec<DVec2> {
        let mut state = seed;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut out: Vec<DVec2> = (0..count)
            .map(|i| DVec2::new(unit(), unit()) * [100.0, 8.0, 1e4, 1e11][i % 4])
            .collect();
        out.push(out[0]);
        out.push(out[0] + DVec2::Y * 20.0);
        out
    }

    #[test]
    fn lines_have_the_cells_near_them_wherever_their_points_are() {
        let extent = Extent::new([-60, 11], [90, 70]).expect("sound");
        for seed in 0..40 {
            let half_m = [0.21, 0.3, 3.0, 25.0][seed as usize % 4];
            let points = points(seed, 9);
            let mut found = std::collections::BTreeSet::new();
            line_cells(extent, &points, half_m, |x, y| {
                assert!(found.insert([x, y]), "twice");
            });
            let near = |[x, y]: &[usize; 2]| {
                let p = extent.center(*x, *y, 0).truncate();
                points.windows(2).any(|s| {
                    let d = s[1] - s[0];
                    let t = ((p - s[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0);
                    p.distance_squared(s[0] + d * t) <= half_m * half_m
                })
            };
            let expected: std::collections::BTreeSet<[usize; 2]> =
                extent.all_columns().filter(near).collect();
            assert_eq!(found, expected, "seed {seed}");
        }
    }

    /// An earlier version visited every cell of the rectangle around a segment: 16 million for one line across a large
    /// map.
    #[test]
    fn a_line_across_a_large_map_costs_its_own_cells() {
        let extent = Extent::new([-2048, -2048], [4096, 4096]).expect("sound");
        for reach_m in [500.0, 1e3, 1e6, 1e11] {
            let ends = [DVec2::splat(-reach_m), DVec2::splat(reach_m)];
            let looked_at: usize = (0..extent.nx())
                .map(|x| rows_near(extent, ends, 0.21, x).len())
                .sum();
            assert!(looked_at < 12 * extent.nx(), "{looked_at} cells for {reach_m} m");
        }
    }
}
