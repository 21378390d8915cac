//! Smooth lines through points, and lines beside lines.

use glam::DVec2;

/// Longest step of a curve, m.
const STEP_M: f64 = 1.0;
/// Largest bend of a piece that stays one straight segment, rad.
const STRAIGHT_RAD: f64 = 0.004;

/// A smooth line through points: straight pieces stay straight, and a bend reaches no farther into a long piece than
/// its short neighbour is long. `before` and `after` are points beyond the ends, towards which the line would continue.
/// Points that are not distinct are dropped. Cubic Hermite pieces; the tangent at a point halves the angle.
pub fn through(before: Option<DVec2>, points_m: &[DVec2], after: Option<DVec2>) -> Vec<DVec2> {
    let points = distinct(points_m);
    if points.len() < 2 {
        return points;
    }
    let n = points.len();
    let chord = |i: usize| points[i + 1] - points[i];
    let beyond = |p: Option<DVec2>, end: DVec2| p.filter(|p| p.distance(end) > APART_M);
    // Direction, and the length of the shorter of the chords that meet.
    let tangent = |i: usize| {
        let back = match i {
            0 => beyond(before, points[0]).map(|p| points[0] - p),
            i => Some(chord(i - 1)),
        };
        let ahead = match i == n - 1 {
            true => beyond(after, points[n - 1]).map(|p| p - points[n - 1]),
            false => Some(chord(i)),
        };
        let (a, b) = (
            back.or(ahead).unwrap_or_default(),
            ahead.or(back).unwrap_or_default(),
        );
        let (ua, ub) = (a.normalize_or_zero(), b.normalize_or_zero());
        ((ua + ub).normalize_or(ub), a.length().min(b.length()))
    };
    let mut out = vec![points[0]];
    for i in 0..n - 1 {
        let (a, b) = (points[i], points[i + 1]);
        let way = (b - a).normalize_or_zero();
        let ((ta, la), (tb, lb)) = (tangent(i), tangent(i + 1));
        let is_straight = |t: DVec2| t.dot(way) > STRAIGHT_RAD.cos();
        if is_straight(ta) && is_straight(tb) {
            out.push(b);
            continue;
        }
        let (ma, mb) = (ta * la.min(a.distance(b)), tb * lb.min(a.distance(b)));
        let steps = (a.distance(b) / STEP_M).ceil().clamp(4.0, 10_000.0) as usize;
        for k in 1..=steps {
            let t = k as f64 / steps as f64;
            let (t2, t3) = (t * t, t * t * t);
            out.push(
                a * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + ma * (t3 - 2.0 * t2 + t)
                    + b * (3.0 * t2 - 2.0 * t3)
                    + mb * (t3 - t2),
            );
        }
    }
    distinct(&out)
}

/// Distance within which two points count as one, m.
const APART_M: f64 = 1e-3;

/// The points that are finite and differ from the one before.
pub fn distinct(points_m: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for p in points_m.iter().filter(|p| p.is_finite()) {
        if out.last().is_none_or(|last| last.distance(*p) > APART_M) {
            out.push(*p);
        }
    }
    out
}

/// The line `left_m` to the left of another (right if negative), mitred; sharp corners are cut at twice the offset.
pub fn beside(points_m: &[DVec2], left_m: f64) -> Vec<DVec2> {
    if points_m.len() < 2 {
        return points_m.to_vec();
    }
    let direction = |i: usize| (points_m[i + 1] - points_m[i]).normalize_or_zero();
    let last = points_m.len() - 1;
    (0..=last)
        .map(|i| {
            let before = direction(i.max(1) - 1).perp();
            let after = direction(i.min(last - 1)).perp();
            let middle = (before + after).normalize_or(after);
            points_m[i] + middle * (left_m / middle.dot(after).max(0.5))
        })
        .collect()
}

/// Length of a line, m.
pub fn length_m(points_m: &[DVec2]) -> f64 {
    points_m.array_windows::<2>().map(|[a, b]| a.distance(*b)).sum()
}

/// The point at a distance along a line, m, and the direction there; the line continues straight beyond its ends. A
/// line of fewer than two points has its point and no direction.
pub fn at(points_m: &[DVec2], along_m: f64) -> (DVec2, DVec2) {
    let mut left_m = along_m;
    let pieces = points_m.array_windows::<2>();
    let count = pieces.len();
    for (i, [a, b]) in pieces.enumerate() {
        let (length, way) = (a.distance(*b), (*b - *a).normalize_or_zero());
        if left_m <= length || i + 1 == count {
            return (*a + way * left_m, way);
        }
        left_m -= length;
    }
    (points_m.first().copied().unwrap_or_default(), DVec2::ZERO)
}

/// The part of a line between two distances along it, m; empty if there is none.
pub fn part(points_m: &[DVec2], from_m: f64, to_m: f64) -> Vec<DVec2> {
    let (from_m, to_m) = (from_m.max(0.0), to_m.min(length_m(points_m)));
    let is_some = to_m - from_m > APART_M;
    if !is_some {
        return Vec::new();
    }
    let mut out = vec![at(points_m, from_m).0];
    let mut along = 0.0;
    for [a, b] in points_m.array_windows::<2>() {
        along += a.distance(*b);
        if along > from_m && along < to_m {
            out.push(*b);
        }
    }
    out.push(at(points_m, to_m).0);
    distinct(&out)
}

/// The nearest point of a line: distance along the line, m, and distance to its left, m. `None` for fewer than two
/// points.
pub fn project(points_m: &[DVec2], p_m: DVec2) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64, f64)> = None;
    let mut along = 0.0;
    for [a, b] in points_m.array_windows::<2>() {
        let (d, length) = (*b - *a, a.distance(*b));
        if length > 0.0 {
            let t = ((p_m - *a).dot(d) / (length * length)).clamp(0.0, 1.0);
            let apart = p_m.distance(*a + d * t);
            if best.is_none_or(|b| apart < b.0) {
                let left = d.perp_dot(p_m - *a) / length;
                best = Some((apart, along + t * length, apart.copysign(left)));
            }
        }
        along += length;
    }
    best.map(|(_, along, left)| (along, left))
}

/// The first crossing of two lines: distances along the first and along the second, m.
pub fn crossing(a_m: &[DVec2], b_m: &[DVec2]) -> Option<(f64, f64)> {
    crossings(a_m, b_m).next()
}

/// The crossings of two lines, in the order of the first.
pub fn crossings<'a>(a_m: &'a [DVec2], b_m: &'a [DVec2]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let mut along_a = 0.0;
    a_m.array_windows::<2>().flat_map(move |[a, b]| {
        let (d, from_a, mut along_b) = (*b - *a, along_a, 0.0);
        along_a += d.length();
        let mut found = Vec::new();
        for [p, q] in b_m.array_windows::<2>() {
            let e = *q - *p;
            let cross = d.perp_dot(e);
            if cross.abs() > 1e-9 {
                let (t, u) = ((*p - *a).perp_dot(e) / cross, (*p - *a).perp_dot(d) / cross);
                if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
                    found.push((from_a + t * d.length(), along_b + u * e.length()));
                }
            }
            along_b += e.length();
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    })
}

/// The fewest of a line's points for which no dropped point is farther off than a tolerance, m; the ends stay (Ramer
/// 1972, Douglas and Peucker 1973).
pub fn simplified(points_m: &[DVec2], tolerance_m: f64) -> Vec<DVec2> {
    let mut keep = vec![false; points_m.len()];
    let Some(last) = points_m.len().checked_sub(1) else {
        return Vec::new();
    };
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let (a, d) = (points_m[from], points_m[to] - points_m[from]);
        let length_squared = d.length_squared();
        // A closed line is split at the point farthest from its beginning.
        let off = |i: usize| {
            let t = match length_squared > 0.0 {
                true => ((points_m[i] - a).dot(d) / length_squared).clamp(0.0, 1.0),
                false => 0.0,
            };
            points_m[i].distance(a + d * t)
        };
        let farthest = (from + 1..to)
            .map(|i| (off(i), i))
            .max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, i)) = farthest.filter(|(off, _)| *off > tolerance_m) {
            keep[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    let kept = points_m.iter().zip(keep).filter(|(_, k)| *k);
    kept.map(|(p, _)| *p).collect()
}

/// The convex hull of points, counter-clockwise (Andrew 1979).
pub fn hull(points_m: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points_m.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut out: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = out[..] {
                if (b - a).perp_dot(p - b) > 0.0 {
                    break;
                }
                out.pop();
            }
            out.push(p);
        }
        out.pop();
        out
    };
    let mut out = half(&mut sorted.iter().copied());
    out.extend(half(&mut sorted.iter().rev().copied()));
    out
}

/// A rounded corner from one point to another about a third (quadratic Bézier), in steps of half a metre or so.
pub fn corner(from: DVec2, about: DVec2, to: DVec2) -> Vec<DVec2> {
    let steps = ((from.distance(about) + about.distance(to)) / 0.5)
        .ceil()
        .clamp(4.0, 400.0);
    (0..=steps as usize)
        .map(|k| {
            let t = k as f64 / steps;
            from.lerp(about, t).lerp(about.lerp(to, t), t)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_stay_two_points_and_bends_are_smooth() {
        let line = [DVec2::ZERO, DVec2::X * 40.0, DVec2::X * 80.0];
        assert_eq!(through(None, &line, None).len(), 3);
        // An arc of 30 m drawn by a point at every 20 degrees stays an arc.
        let arc: Vec<DVec2> = (0..=6)
            .map(|k| DVec2::from_angle(f64::from(k) * 0.35) * 30.0)
            .collect();
        for p in through(None, &arc, None).iter().skip(12).rev().skip(12) {
            assert!((p.length() - 30.0).abs() < 0.1, "{p} is {} m out", p.length());
        }
        // A long straight piece does not bow where a bend begins.
        let bend = [
            DVec2::ZERO,
            DVec2::X * 80.0,
            DVec2::new(88.0, 1.0),
            DVec2::new(95.0, 5.0),
        ];
        for p in through(None, &bend, None).iter().filter(|p| p.x < 70.0) {
            assert!(p.y.abs() < 0.3, "{p}");
        }
        assert_eq!(through(None, &[DVec2::NAN, DVec2::ONE], None).len(), 1);
    }

    #[test]
    fn fewer_points_and_the_hull_around_them() {
        let line: Vec<DVec2> = (0..=20)
            .map(|x| DVec2::new(f64::from(x), f64::from(x % 2) * 0.1))
            .collect();
        assert_eq!(simplified(&line, 0.2), [line[0], line[20]]);
        assert_eq!(simplified(&line, 0.01).len(), 21);
        assert_eq!(
            simplified(&[DVec2::ZERO, DVec2::X * 5.0, DVec2::ZERO], 1.0).len(),
            3
        );
        assert!(simplified(&[], 1.0).is_empty());
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let within = [square.to_vec(), vec![DVec2::splat(0.5)]].concat();
        assert_eq!(hull(&within), square);
    }

    #[test]
    fn places_on_a_line() {
        let line = [DVec2::ZERO, DVec2::X * 10.0, DVec2::new(10.0, 10.0)];
        assert_eq!(length_m(&line), 20.0);
        assert_eq!(at(&line, 15.0), (DVec2::new(10.0, 5.0), DVec2::Y));
        assert_eq!(at(&line, 25.0).0, DVec2::new(10.0, 15.0));
        assert_eq!(project(&line, DVec2::new(4.0, 3.0)), Some((4.0, 3.0)));
        assert_eq!(project(&line, DVec2::new(12.0, 6.0)), Some((16.0, -2.0)));
        assert_eq!(
            part(&line, 5.0, 12.0),
            vec![DVec2::X * 5.0, DVec2::X * 10.0, DVec2::new(10.0, 2.0)]
        );
        assert!(part(&line, 12.0, 5.0).is_empty() && project(&line[..1], DVec2::ONE).is_none());
        let other = [DVec2::new(5.0, -5.0), DVec2::new(5.0, 5.0)];
        assert_eq!(crossing(&line, &other), Some((5.0, 5.0)));
    }
}
