//! Exact distance transform on the columns of a map (Felzenszwalb and Huttenlocher 2012, "Distance Transforms of
//! Sampled Functions"), with the nearest source cell.

use super::Extent;

/// For every column `[x][y]` the index of the nearest column in `source`; `None` if there is no source.
/// Ties go to the lower index along each axis.
pub fn nearest_source(extent: Extent, source: impl Fn(usize) -> bool) -> Option<Vec<u32>> {
    let (nx, ny) = (extent.nx(), extent.ny());
    // Along y: the nearest source of the same row, both ways.
    let mut in_row = vec![u32::MAX; nx * ny];
    for x in 0..nx {
        let row = &mut in_row[x * ny..(x + 1) * ny];
        let mut last = u32::MAX;
        for (y, out) in row.iter_mut().enumerate() {
            if source(x * ny + y) {
                last = y as u32;
            }
            *out = last;
        }
        let mut next = u32::MAX;
        for y in (0..ny).rev() {
            if source(x * ny + y) {
                next = y as u32;
            }
            let before = row[y];
            if before == u32::MAX || (next != u32::MAX && next - (y as u32) < y as u32 - before) {
                row[y] = next;
            }
        }
    }
    // Along x: the lower envelope of the parabolas above the rows.
    let mut out = vec![u32::MAX; nx * ny];
    let mut any = false;
    let (mut vertex, mut from) = (Vec::<usize>::new(), Vec::<f64>::new());
    for y in 0..ny {
        vertex.clear();
        from.clear();
        let height = |x: usize| (f64::from(in_row[x * ny + y]) - y as f64).powi(2);
        for x in (0..nx).filter(|x| in_row[x * ny + y] != u32::MAX) {
            let mut start = f64::NEG_INFINITY;
            while let Some(&v) = vertex.last() {
                let (xf, vf) = (x as f64, v as f64);
                start = (height(x) + xf * xf - height(v) - vf * vf) / (2.0 * (xf - vf));
                if start > *from.last().unwrap_or(&f64::NEG_INFINITY) {
                    break;
                }
                vertex.pop();
                from.pop();
                start = f64::NEG_INFINITY;
            }
            vertex.push(x);
            from.push(start);
        }
        let mut k = 0;
        for x in 0..nx {
            while k + 1 < vertex.len() && from[k + 1] < x as f64 {
                k += 1;
            }
            if let Some(&v) = vertex.get(k) {
                any = true;
                out[x * ny + y] = v as u32 * ny as u32 + in_row[v * ny + y];
            }
        }
    }
    any.then_some(out)
}

/// Distance from every column's centre to the border of the set, m: negative inside, positive outside. Space beyond the
/// grid counts as neither. 1000 m and more where there is no border.
pub fn signed_distance_m(extent: Extent, inside: impl Fn(usize) -> bool) -> Vec<f32> {
    const NO_BORDER_M: f32 = 1000.0;
    let ny = extent.ny();
    let distance = |from: usize, to: u32| {
        let (dx, dy) = (from / ny, from % ny);
        let (dx, dy) = (
            dx as f32 - (to as usize / ny) as f32,
            dy as f32 - (to as usize % ny) as f32,
        );
        // The border runs between a cell of the set and one beside it, half a cell from both centres.
        ((dx * dx + dy * dy).sqrt() - 0.5) * extent.voxel_m() as f32
    };
    let (set, rest) = (
        nearest_source(extent, &inside),
        nearest_source(extent, |c| !inside(c)),
    );
    (0..extent.columns())
        .map(|c| match (inside(c), &set, &rest) {
            (true, _, Some(rest)) => -distance(c, rest[c]),
            (false, Some(set), _) => distance(c, set[c]),
            (true, _, None) => -NO_BORDER_M,
            (false, None, _) => NO_BORDER_M,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_brute_force() {
        let ny = Extent::WINDOW.ny();
        let source = |c: usize| (c * 2_654_435_761) % 9973 < 12;
        let sources: Vec<usize> = (0..Extent::WINDOW.columns()).filter(|c| source(*c)).collect();
        assert!(sources.len() > 10);
        let found = nearest_source(Extent::WINDOW, source).expect("there are sources");
        let square = |a: usize, b: usize| {
            let d = |p: usize, q: usize| (p as i64 - q as i64).pow(2);
            d(a / ny, b / ny) + d(a % ny, b % ny)
        };
        for c in (0..Extent::WINDOW.columns()).step_by(37) {
            let best = sources.iter().map(|s| square(c, *s)).min();
            assert_eq!(Some(square(c, found[c] as usize)), best, "column {c}");
        }
        assert!(nearest_source(Extent::WINDOW, |_| false).is_none());
    }

    #[test]
    fn signs_and_borders() {
        let square = |c: usize| (90..110).contains(&(c / 200)) && (90..110).contains(&(c % 200));
        let d = signed_distance_m(Extent::WINDOW, square);
        assert!((d[100 * 200 + 90] + 0.2).abs() < 1e-6 && (d[100 * 200 + 89] - 0.2).abs() < 1e-6);
        assert!((d[100 * 200 + 100] + 3.8).abs() < 1e-6, "{}", d[100 * 200 + 100]);
        assert!(
            signed_distance_m(Extent::WINDOW, |_| false)
                .iter()
                .all(|v| *v == 1000.0)
        );
        assert!(
            signed_distance_m(Extent::WINDOW, |_| true)
                .iter()
                .all(|v| *v == -1000.0)
        );
    }
}
