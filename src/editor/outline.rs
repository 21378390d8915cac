//! From a stroke of a brush to the outline of the area that it covers.

use std::collections::BTreeMap;

use glam::DVec2;

use scene::Extent;
use scene::background::crossing_edges;
use scene::roads::curve::hull;

use super::Shape;

/// Most corners of an outline.
const MOST_CORNERS: usize = 100;
/// How far corners may move to make an outline simpler, tried in this order, m.
const TOLERANCES_M: [f64; 4] = [0.3, 0.5, 0.8, 1.2];

/// Outline of a stroke along points (ego frame, m), counter-clockwise, its holes filled; `None` beside the map.
pub fn of_stroke(extent: Extent, points_m: &[DVec2], width_m: f64) -> Option<Vec<DVec2>> {
    let stroke = Shape::Line {
        points_m: points_m.to_vec(),
        width_m,
    };
    let border = border(extent, &stroke.cells(extent).ok()?)?;
    let simple = TOLERANCES_M
        .iter()
        .map(|tolerance_m| simplified(&border, *tolerance_m))
        .find(|o| (3..=MOST_CORNERS).contains(&o.len()) && crossing_edges(o).is_none());
    Some(simple.unwrap_or_else(|| hull(&border)))
}

/// The longest closed border of cells, through the middles of their sides, m: through their corners it would be a
/// staircase, and touch itself where cells meet at a corner.
fn border(extent: Extent, cells: &[[usize; 2]]) -> Option<Vec<DVec2>> {
    let set: std::collections::BTreeSet<[i64; 2]> =
        cells.iter().map(|[x, y]| [*x as i64, *y as i64]).collect();
    // Directed sides with the area on their left, by where they begin.
    let mut from: BTreeMap<[i64; 2], Vec<[i64; 2]>> = BTreeMap::new();
    for &[x, y] in &set {
        let sides = [
            ([x, y - 1], [x, y], [x + 1, y]),
            ([x + 1, y], [x + 1, y], [x + 1, y + 1]),
            ([x, y + 1], [x + 1, y + 1], [x, y + 1]),
            ([x - 1, y], [x, y + 1], [x, y]),
        ];
        for (neighbour, a, b) in sides {
            if !set.contains(&neighbour) {
                from.entry(a).or_default().push(b);
            }
        }
    }
    let mut longest: Vec<[i64; 2]> = Vec::new();
    while let Some(start) = from.iter().find(|(_, to)| !to.is_empty()).map(|(at, _)| *at) {
        let (mut at, mut before, mut way) = (start, start, Vec::new());
        while let Some(next) = from.get_mut(&at).and_then(|to| leftmost(before, at, to)) {
            way.push(at);
            (before, at) = (at, next);
        }
        // The outer border is longer than that of any hole in it.
        if way.len() > longest.len() {
            longest = way;
        }
    }
    let corner =
        |[x, y]: [i64; 2]| extent.min_m().truncate() + DVec2::new(x as f64, y as f64) * extent.voxel_m();
    let n = longest.len();
    let middle = |i: usize| (corner(longest[i]) + corner(longest[(i + 1) % n])) / 2.0;
    (n >= 4).then(|| (0..n).map(middle).collect())
}

/// Takes out of the sides that begin at a corner the one that turns left most: areas that touch there stay apart.
fn leftmost(before: [i64; 2], at: [i64; 2], to: &mut Vec<[i64; 2]>) -> Option<[i64; 2]> {
    let came = [at[0] - before[0], at[1] - before[1]];
    let turn = |next: &[i64; 2]| came[0] * (next[1] - at[1]) - came[1] * (next[0] - at[0]);
    let best = (0..to.len()).max_by_key(|i| turn(&to[*i]))?;
    Some(to.swap_remove(best))
}

/// Ramer 1972, Douglas and Peucker 1973, for a closed outline: its two corners farthest apart stay.
fn simplified(outline: &[DVec2], tolerance_m: f64) -> Vec<DVec2> {
    let n = outline.len();
    let far = (0..n)
        .max_by(|a, b| {
            let d = |i: &usize| outline[*i].distance_squared(outline[0]);
            d(a).total_cmp(&d(b))
        })
        .unwrap_or(0);
    let mut keep = vec![false; n + 1];
    (keep[0], keep[far]) = (true, true);
    let at = |i: usize| outline[i % n];
    let mut pieces = vec![(0, far), (far, n)];
    while let Some((a, b)) = pieces.pop() {
        let along = (at(b) - at(a)).normalize_or_zero();
        let off = |i: usize| match along == DVec2::ZERO {
            true => at(i).distance(at(a)),
            false => (at(i) - at(a)).perp_dot(along).abs(),
        };
        let worst = (a + 1..b).max_by(|i, j| off(*i).total_cmp(&off(*j)));
        if let Some(i) = worst.filter(|i| off(*i) > tolerance_m) {
            keep[i] = true;
            pieces.extend([(a, i), (i, b)]);
        }
    }
    (0..n).filter(|i| keep[*i]).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choose::is_inside;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn a_stroke_becomes_an_outline_around_it() {
        let outline =
            of_stroke(Extent::WINDOW, &[v(0.0, 0.0), v(8.0, 0.0), v(8.0, 6.0)], 3.0).expect("an area");
        assert!((3..40).contains(&outline.len()), "{}", outline.len());
        assert_eq!(crossing_edges(&outline), None);
        for (p, inside) in [
            (v(4.0, 0.0), true),
            (v(8.0, 5.0), true),
            (v(4.0, 3.5), false),
            (v(12.0, 0.0), false),
        ] {
            assert_eq!(is_inside(&outline, p), inside, "{p}");
        }
        let area: f64 = (0..outline.len())
            .map(|i| outline[i].perp_dot(outline[(i + 1) % outline.len()]) / 2.0)
            .sum();
        assert!(area > 0.0, "counter-clockwise");
    }

    #[test]
    fn a_slanting_stroke_has_straight_sides() {
        let outline = of_stroke(Extent::WINDOW, &[v(0.0, 0.0), v(14.0, 3.0)], 3.0).expect("an area");
        assert!(outline.len() < 16, "{outline:?}");
    }

    #[test]
    fn loops_and_scribbles_never_cross() {
        // A ring: the hole is filled.
        let ring: Vec<DVec2> = (0..=24)
            .map(|i| DVec2::from_angle(f64::from(i) * 0.27) * 6.0)
            .collect();
        let outline = of_stroke(Extent::WINDOW, &ring, 1.2).expect("an area");
        assert!(is_inside(&outline, v(0.0, 0.0)) && crossing_edges(&outline).is_none());
        // A scribble over itself, as thin as the brush goes.
        let scribble: Vec<DVec2> = (0..200)
            .map(|i| {
                let t = f64::from(i) * 0.21;
                v(
                    7.0 * (t * 1.3).sin() + 3.0 * (t * 4.1).cos(),
                    6.0 * (t * 1.7).cos(),
                )
            })
            .collect();
        for width_m in [0.4, 1.0, 2.5] {
            let outline = of_stroke(Extent::WINDOW, &scribble, width_m).expect("an area");
            assert_eq!(crossing_edges(&outline), None, "{width_m}");
            assert!((3..=MOST_CORNERS).contains(&outline.len()), "{}", outline.len());
        }
        assert_eq!(of_stroke(Extent::WINDOW, &[v(90.0, 0.0)], 2.0), None);
        assert!(of_stroke(Extent::WINDOW, &[v(39.9, 0.0)], 2.0).is_some());
    }
}
