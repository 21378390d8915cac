//! A smooth reference line through points: straight records and parametric cubics that meet without a kink.

use glam::DVec2;

use super::super::geometry::{CurveShape, Geometry, ReferenceLine};
use scene::road_map::project;

/// The curve stays this close to the points, m.
const NEAR_M: f64 = 0.02;
/// A record that turns by less is straight, rad.
const STRAIGHT_RAD: f64 = 2e-4;
/// A record turns by no more: so p runs nearly with the arc length, as readers take it to.
const MOST_TURN_RAD: f64 = 0.4;
/// Longest record, m.
const LONGEST_M: f64 = 60.0;
/// Directions are taken over this way to both sides of a point, m.
const OVER_M: f64 = 1.5;

/// Through points at most a metre or so apart, from the first to the last; headings (rad) at the ends where they are given.
/// `None` for fewer than two points, a line without length, and two neighbours farther apart than any record reaches.
pub(crate) fn reference(points: &[DVec2], ends_rad: [Option<f64>; 2]) -> Option<ReferenceLine> {
    let mut clean: Vec<DVec2> = Vec::with_capacity(points.len());
    for p in points.iter().filter(|p| p.is_finite()) {
        if clean.last().is_none_or(|last| last.distance(*p) > 1e-3) {
            clean.push(*p);
        }
    }
    if clean.len() < 2 {
        return None;
    }
    let line = SampledLine::new(clean, ends_rad);
    let mut stack = vec![(0, line.points.len() - 1)];
    let mut records: Vec<Geometry> = Vec::new();
    while let Some((from, to)) = stack.pop() {
        match line.record(from, to) {
            Some(record) => match records.last().and_then(|last| one(last, &record)) {
                Some(both) => {
                    records.pop();
                    records.push(both);
                }
                None => {
                    let s_m = records.last().map_or(0.0, Geometry::end_s_m);
                    records.push(record.at_s(s_m));
                }
            },
            // There is no point left to divide at.
            None if to - from <= 1 => return None,
            None => {
                let middle = usize::midpoint(from, to);
                stack.push((middle, to));
                stack.push((from, middle));
            }
        }
    }
    ReferenceLine::new(records)
}

/// Two straight records in one direction are one.
fn one(last: &Geometry, next: &Geometry) -> Option<Geometry> {
    let straight = |g: &Geometry| *g.shape() == CurveShape::Line;
    let [a, b] = [last.at(0.0), next.at(next.length_m)];
    let alike = straight(last)
        && straight(next)
        && wrapped(a.heading_rad - b.heading_rad).abs() < STRAIGHT_RAD / 10.0;
    let chord = b.position_m - a.position_m;
    let both = || {
        Geometry::new(
            last.s_m,
            a.position_m,
            chord.to_angle(),
            chord.length(),
            CurveShape::Line,
        )
    };
    alike.then(both)?.ok()
}

/// Points with the way to each and the heading at each.
struct SampledLine {
    points: Vec<DVec2>,
    along_m: Vec<f64>,
    heading_rad: Vec<f64>,
}

impl SampledLine {
    fn new(points: Vec<DVec2>, ends_rad: [Option<f64>; 2]) -> Self {
        let mut along_m = vec![0.0];
        for pair in points.windows(2) {
            along_m.push(along_m[along_m.len() - 1] + pair[0].distance(pair[1]));
        }
        let mut line = Self {
            heading_rad: Vec::new(),
            points,
            along_m,
        };
        line.heading_rad = (0..line.points.len()).map(|i| line.direction_rad(i)).collect();
        let last = line.points.len() - 1;
        for (end, heading) in [0, last].into_iter().zip(ends_rad) {
            if let Some(heading) = heading {
                line.heading_rad[end] = heading;
            }
        }
        line
    }

    /// The point that lies `way_m` along the line, by index, kept within the line.
    fn index_at(&self, way_m: f64) -> usize {
        self.along_m
            .partition_point(|a| *a < way_m - 1e-9)
            .min(self.points.len() - 1)
    }

    fn direction_rad(&self, i: usize) -> f64 {
        let at = self.along_m[i];
        let whole = self.along_m[self.points.len() - 1];
        let chord = |from: usize, to: usize| (self.points[to] - self.points[from]).to_angle();
        let over = OVER_M.min(whole / 2.0);
        if at < over || whole - at < over {
            // At an end the chord to one side lags behind the curve by half of its own turn.
            let first = at < over;
            let (near, far) = match first {
                true => (self.index_at(at + over), self.index_at(at + 2.0 * over)),
                false => (self.index_at(at - over), self.index_at(at - 2.0 * over)),
            };
            if near == i {
                return match first {
                    true => chord(i, (i + 1).min(self.points.len() - 1)),
                    false => chord(i.saturating_sub(1), i),
                };
            }
            let near_rad = match first {
                true => chord(i, near),
                false => chord(near, i),
            };
            if far == near {
                return near_rad;
            }
            let far_rad = match first {
                true => chord(near, far),
                false => chord(far, near),
            };
            return near_rad - wrapped(far_rad - near_rad) / 2.0;
        }
        chord(self.index_at(at - over), self.index_at(at + over))
    }

    /// One record from point to point, if it comes close enough to those between.
    fn record(&self, from: usize, to: usize) -> Option<Geometry> {
        let (start, end) = (self.points[from], self.points[to]);
        let chord = end - start;
        let turn = wrapped(self.heading_rad[to] - self.heading_rad[from]);
        let bend = [from, to].map(|i| wrapped(self.heading_rad[i] - chord.to_angle()).abs());
        let between = &self.points[from..=to];
        let shortest = to - from <= 1;
        let way_m = self.along_m[to] - self.along_m[from];
        let straight = bend.iter().all(|b| *b < STRAIGHT_RAD);
        if straight && between.iter().all(|p| away_m(*p, start, end) < NEAR_M / 2.0) {
            return Geometry::new(0.0, start, chord.to_angle(), chord.length(), CurveShape::Line).ok();
        }
        if !shortest && (way_m > LONGEST_M || turn.abs() > MOST_TURN_RAD) {
            return None;
        }
        let heading = self.heading_rad[from];
        let local = DVec2::from_angle(-heading).rotate(chord);
        // The speed at both ends: that of a circle with the same turn.
        let speed = chord.length() / (turn / 4.0).cos().powi(2);
        let (out, back) = (DVec2::X * speed, DVec2::from_angle(turn) * speed);
        let square = 3.0 * local - 2.0 * out - back;
        let cube = out + back - 2.0 * local;
        let u = [0.0, out.x, square.x, cube.x];
        let v = [0.0, out.y, square.y, cube.y];
        let length_m = arc_length(&u, &v);
        let shape = CurveShape::ParamPoly3 {
            u,
            v,
            normalized: true,
        };
        let record = Geometry::new(0.0, start, heading, length_m, shape).ok()?;
        if shortest {
            return Some(record);
        }
        let steps = (2 * (to - from)).min(64);
        let drawn: Vec<DVec2> = (0..=steps)
            .map(|i| record.at(length_m * i as f64 / steps as f64).position_m)
            .collect();
        let near = |p: &DVec2| project(&drawn, *p).is_none_or(|hit| hit.distance_m < NEAR_M);
        between.iter().all(near).then_some(record)
    }
}

/// Length of a parametric cubic over p from 0 to 1.
fn arc_length(u: &[f64; 4], v: &[f64; 4]) -> f64 {
    const PIECES: usize = 8;
    // Five nodes of Gauss and Legendre on [-1, 1].
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let rate = |k: &[f64; 4], p: f64| k[1] + p * (2.0 * k[2] + p * 3.0 * k[3]);
    let half = 0.5 / PIECES as f64;
    let pieces = (0..PIECES).flat_map(|i| {
        let middle = (2 * i + 1) as f64 * half;
        NODES
            .map(|(node, weight)| weight * rate(u, middle + half * node).hypot(rate(v, middle + half * node)))
    });
    pieces.sum::<f64>() * half
}

/// Distance of a point from a segment, m.
fn away_m(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + d * t)
}

/// Where points that a line was made of lie along it, and how far to its left, m. The ways begin at 0, grow and end with the line.
pub(crate) fn placed(line: &ReferenceLine, points: &[DVec2]) -> (Vec<f64>, Vec<f64>) {
    let (end, last) = (line.end_s_m(), points.len() - 1);
    let (mut s_m, mut off_m) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
    for (i, p) in points.iter().enumerate() {
        let before = s_m.last().copied().unwrap_or(0.0);
        let mut s = match i {
            0 => 0.0,
            i => before + points[i - 1].distance(*p),
        };
        for _ in 0..4 {
            let base = line.at(s);
            let tangent = DVec2::from_angle(base.heading_rad);
            s = (s + (*p - base.position_m).dot(tangent)).clamp(0.0, end);
        }
        // A step of a hundredth is left for each point to come.
        let least = if i == 0 { 0.0 } else { before + end * 1e-5 };
        let most = end - end * 1e-5 * (last - i) as f64;
        s = s.max(least).min(most);
        if i == last {
            s = end;
        }
        let base = line.at(s);
        let left = DVec2::from_angle(base.heading_rad).perp();
        s_m.push(s);
        off_m.push((*p - base.position_m).dot(left));
    }
    (s_m, off_m)
}

/// An angle from -pi to pi.
pub(crate) fn wrapped(rad: f64) -> f64 {
    (rad + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(points: &[DVec2]) -> ReferenceLine {
        let line = reference(points, [None, None]).expect("a line");
        for pair in line.records().windows(2) {
            let (end, start) = (pair[0].at(pair[0].length_m), pair[1].at(0.0));
            assert!(end.position_m.distance(start.position_m) < 1e-6);
            assert!(wrapped(end.heading_rad - start.heading_rad).abs() < 1e-3);
        }
        let drawn: Vec<DVec2> = (0..=4000)
            .map(|i| line.at(line.end_s_m() * f64::from(i) / 4000.0).position_m)
            .collect();
        for p in points {
            let off_m = project(&drawn, *p).expect("a line").distance_m;
            assert!(off_m < 0.05, "{off_m} at {p}");
        }
        line
    }

    #[test]
    fn a_straight_line_is_one_record() {
        let points: Vec<DVec2> = (0..=160)
            .map(|i| DVec2::new(-40.0 + 0.5 * f64::from(i), 3.0 + 0.1 * f64::from(i)))
            .collect();
        let line = checked(&points);
        assert_eq!(line.records().len(), 1);
        assert_eq!(line.records()[0].shape(), &CurveShape::Line);
        assert!((line.end_s_m() - points[0].distance(points[160])).abs() < 1e-9);
    }

    #[test]
    fn bends_are_followed_to_two_centimetres() {
        for radius in [6.0, 12.0, 90.0] {
            let mut points: Vec<DVec2> = (0..40)
                .map(|i| DVec2::new(0.5 * f64::from(i) - 20.0, 0.0))
                .collect();
            let steps = (radius * 1.5 / 0.5) as i32;
            points.extend((0..steps).map(|i| {
                let a = f64::from(i) * 0.5 / radius;
                DVec2::new(radius * a.sin(), radius * (1.0 - a.cos()))
            }));
            let line = checked(&points);
            assert!(line.records().len() < 16, "{}", line.records().len());
            // p runs nearly with the arc length.
            for record in line.records() {
                let half = record.at(record.length_m / 2.0).position_m;
                let [a, b] = [0.0, record.length_m].map(|s| record.at(s).position_m.distance(half));
                assert!((a - b).abs() < 0.05 * record.length_m, "{a} {b}");
            }
        }
    }

    #[test]
    fn given_headings_are_kept_and_hopeless_lines_refused() {
        let points = [[0.0, 0.0], [1.0, 0.2], [2.0, 0.0], [3.0, 0.0]].map(DVec2::from_array);
        let line = reference(&points, [Some(0.5), Some(-0.25)]).expect("a line");
        assert!((line.at(0.0).heading_rad - 0.5).abs() < 1e-9);
        assert!(wrapped(line.at(line.end_s_m()).heading_rad + 0.25).abs() < 1e-9);
        // Points too far apart for a record were divided for ever.
        let far = [DVec2::ZERO, DVec2::new(1e11, 3.0), DVec2::new(1e11, 9.0)];
        for bad in [&points[..1], &[DVec2::NAN, DVec2::ONE], &[DVec2::ONE; 3], &far] {
            assert!(reference(bad, [None, None]).is_none());
        }
    }

    #[test]
    fn ways_along_a_line_grow_from_0_to_its_end() {
        let points: Vec<DVec2> = (0..50)
            .map(|i| DVec2::from_angle(f64::from(i) * 0.05) * 10.0)
            .collect();
        let line = reference(&points, [None, None]).expect("an arc");
        let (s, off) = placed(&line, &points);
        assert_eq!((s[0], s[49]), (0.0, line.end_s_m()));
        assert!(s.windows(2).all(|w| w[0] < w[1]));
        assert!(off.iter().all(|m| m.abs() < 0.03));
    }
}
