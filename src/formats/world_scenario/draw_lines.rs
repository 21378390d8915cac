//! Lines on the ground as they are painted: a line beside another, and dashes.

use glam::DVec3;

/// Length of a dash of a line between lanes, and of the gap after it, m.
pub(crate) const LONG_DASH_M: [f64; 2] = [3.0, 9.0];
/// Distance of each line of a double line from its middle, m.
pub(crate) const DOUBLE_M: f64 = 0.1;

/// A line `offset_m` to the left of another along the ground, m.
pub(crate) fn beside(line: &[DVec3], offset_m: f64) -> Vec<DVec3> {
    let last = line.len().saturating_sub(1);
    let left = |i: usize| {
        let along = (line[(i + 1).min(last)] - line[i.saturating_sub(1)]).truncate();
        along.try_normalize().unwrap_or_default().perp().extend(0.0)
    };
    (0..line.len()).map(|i| line[i] + left(i) * offset_m).collect()
}

/// The dashes of a line, each `dash` long with `gap` after it, m.
pub(crate) fn dashes(line: &[DVec3], [dash_m, gap_m]: [f64; 2]) -> Vec<Vec<DVec3>> {
    let mut out: Vec<Vec<DVec3>> = Vec::new();
    let mut along_m = 0.0;
    for pair in line.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        let at =
            |way_m: f64| pair[0].lerp(pair[1], ((way_m - along_m) / length_m.max(1e-12)).clamp(0.0, 1.0));
        let end_m = along_m + length_m;
        let mut period = (along_m / (dash_m + gap_m)).floor();
        loop {
            let begin_m = period * (dash_m + gap_m);
            let (from_m, to_m) = (begin_m.max(along_m), (begin_m + dash_m).min(end_m));
            if begin_m >= end_m {
                break;
            }
            if from_m < to_m {
                match out.last_mut() {
                    // A dash that goes around a point of the line.
                    Some(last) if from_m == along_m && from_m > begin_m => last.push(at(to_m)),
                    _ => out.push(vec![at(from_m), at(to_m)]),
                }
            }
            period += 1.0;
        }
        along_m = end_m;
    }
    out
}

/// The triangles of a polygon (seen from above) by cutting off its ears; of one that crosses itself, some of them.
pub(crate) fn triangles(outline: &[DVec3]) -> Vec<[DVec3; 3]> {
    let turn = |a: DVec3, b: DVec3, c: DVec3| (b - a).truncate().perp_dot((c - b).truncate());
    let mut left: Vec<DVec3> = outline.to_vec();
    let area: f64 = (0..left.len())
        .map(|i| left[i].truncate().perp_dot(left[(i + 1) % left.len()].truncate()))
        .sum();
    if area < 0.0 {
        left.reverse();
    }
    let mut out = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        let ear = (0..n).find(|i| {
            let [a, b, c] = [left[(i + n - 1) % n], left[*i], left[(i + 1) % n]];
            let holds = |p: &DVec3| {
                let inside = turn(a, b, *p) >= 0.0 && turn(b, c, *p) >= 0.0 && turn(c, a, *p) >= 0.0;
                inside && *p != a && *p != b && *p != c
            };
            turn(a, b, c) > 0.0 && !left.iter().any(holds)
        });
        let at = ear.unwrap_or(0);
        out.push([left[(at + n - 1) % n], left[at], left[(at + 1) % n]]);
        left.remove(at);
    }
    if let [a, b, c] = left[..] {
        out.push([a, b, c]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_have_their_length_and_go_around_corners() {
        let line = [
            DVec3::ZERO,
            DVec3::new(10.0, 0.0, 0.0),
            DVec3::new(13.0, 0.0, 0.0),
            DVec3::new(13.0, 20.0, 0.0),
        ];
        let found = dashes(&line, LONG_DASH_M);
        let length = |dash: &Vec<DVec3>| dash.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        assert!(found.len() == 3 && found.iter().all(|dash| (length(dash) - 3.0).abs() < 1e-9));
        // The second from 12 to 15 m: around the corner at 13 m.
        let corner = [DVec3::new(12.0, 0.0, 0.0), line[2], DVec3::new(13.0, 2.0, 0.0)];
        let near = |(a, b): (&DVec3, &DVec3)| a.distance(*b) < 1e-9;
        assert!(
            found[1].len() == 3 && found[1].iter().zip(&corner).all(near),
            "{:?}",
            found[1]
        );
        assert!(dashes(&line[..1], LONG_DASH_M).is_empty());
        assert!(dashes(&[DVec3::ONE, DVec3::ONE], LONG_DASH_M).is_empty());
    }

    #[test]
    fn the_line_beside_is_to_the_left() {
        let line = [DVec3::ZERO, DVec3::new(5.0, 0.0, 1.0), DVec3::new(5.0, 5.0, 1.0)];
        let left = beside(&line, 0.5);
        assert!((left[0] - DVec3::new(0.0, 0.5, 0.0)).length() < 1e-12);
        assert!((left[2] - DVec3::new(4.5, 5.0, 1.0)).length() < 1e-12);
    }

    #[test]
    fn a_polygon_with_a_bay_has_its_area() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let outline = [
            corner(0.0, 0.0),
            corner(4.0, 0.0),
            corner(4.0, 3.0),
            corner(2.0, 1.0),
            corner(0.0, 3.0),
        ];
        for reversed in [false, true] {
            let mut outline = outline.to_vec();
            if reversed {
                outline.reverse();
            }
            let found = triangles(&outline);
            let area = |t: &[DVec3; 3]| (t[1] - t[0]).truncate().perp_dot((t[2] - t[0]).truncate()) / 2.0;
            assert_eq!(found.len(), 3);
            assert!((found.iter().map(area).sum::<f64>() - 8.0).abs() < 1e-9);
            assert!(found.iter().all(|t| area(t) > 0.0));
        }
        assert!(triangles(&outline[..2]).is_empty());
    }
}
