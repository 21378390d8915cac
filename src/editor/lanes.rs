//! Lanes as the tools use them: the nearest one, and the way along it.

use glam::DVec2;

use scene::{BevLayout, Polyline, PolylineKind};

/// A point on the middle of a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentrelinePoint {
    /// Position, ego frame, m.
    pub at_m: DVec2,
    /// Driving direction there, rad.
    pub yaw_rad: f64,
    /// Distance from the point that was asked for, m.
    pub distance_m: f64,
    line: usize,
    segment: usize,
}

impl CentrelinePoint {
    /// A place on a piece of a lane's middle: which line of the layout, and which of its segments.
    pub(crate) fn on(line: usize, segment: usize, at_m: DVec2, yaw_rad: f64) -> Self {
        Self {
            at_m,
            yaw_rad,
            distance_m: 0.0,
            line,
            segment,
        }
    }
}

fn centers(layout: &BevLayout) -> impl Iterator<Item = (usize, &Polyline)> {
    let lines = layout.polylines.iter().enumerate();
    lines.filter(|(_, l)| l.kind == PolylineKind::LaneCenter)
}

/// The nearest point of any lane's middle within `reach_m`; the first in the list of those equally near.
pub fn nearest_lane(layout: &BevLayout, p_m: DVec2, reach_m: f64) -> Option<CentrelinePoint> {
    let pieces = centers(layout).flat_map(|(line, l)| {
        let windows = l.points_m.array_windows::<2>().enumerate();
        windows.map(move |(segment, [a, b])| (line, segment, *a, *b))
    });
    let measured = pieces.filter_map(|(line, segment, a, b)| {
        let along = b - a;
        let length_squared = along.length_squared();
        if !(length_squared.is_finite() && length_squared > 0.0) {
            return None;
        }
        let t = ((p_m - a).dot(along) / length_squared).clamp(0.0, 1.0);
        let at_m = a + along * t;
        Some(CentrelinePoint {
            at_m,
            yaw_rad: along.to_angle(),
            distance_m: p_m.distance(at_m),
            line,
            segment,
        })
    });
    let nearest = measured.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))?;
    (nearest.distance_m <= reach_m).then_some(nearest)
}

/// The point `distance_m` further along from a lane point (backward if negative), and the direction there.
/// At the end of a line it goes on with the one that continues it straightest, else straight ahead.
pub fn along(layout: &BevLayout, from: &CentrelinePoint, distance_m: f64) -> (DVec2, f64) {
    let backward = distance_m < 0.0;
    let mut left_m = distance_m.abs();
    let (mut line, mut at_m, mut yaw_rad) = (from.line, from.at_m, from.yaw_rad);
    let mut next = if backward { from.segment } else { from.segment + 1 };
    // Each line is entered once at most, so that a ring ends too.
    let mut seen = vec![line];
    while let Some(points_m) = layout.polylines.get(line).map(|l| &l.points_m) {
        while let Some(&to_m) = points_m.get(next) {
            let step = to_m - at_m;
            let length_m = step.length();
            if length_m.is_finite() && length_m > 0.0 {
                let heading = if backward { -step } else { step };
                yaw_rad = heading.to_angle();
                if length_m >= left_m {
                    return (at_m + step * (left_m / length_m), yaw_rad);
                }
                left_m -= length_m;
                at_m = to_m;
            }
            // One before the first is none: `get` fails on it.
            next = if backward { next.wrapping_sub(1) } else { next + 1 };
        }
        let Some((other, start)) = continuation(layout, at_m, yaw_rad, backward, &seen) else {
            break;
        };
        seen.push(other);
        (line, next) = (other, start);
    }
    let ahead = DVec2::from_angle(yaw_rad) * if backward { -left_m } else { left_m };
    (at_m + ahead, yaw_rad)
}

/// The line that begins (or, backward, ends) where another one ends, turning least; and its first vertex.
fn continuation(
    layout: &BevLayout,
    at_m: DVec2,
    yaw_rad: f64,
    backward: bool,
    seen: &[usize],
) -> Option<(usize, usize)> {
    const JOINT_M: f64 = 0.6;
    let heading = DVec2::from_angle(yaw_rad);
    let candidates = centers(layout).filter_map(|(i, l)| {
        let n = l.points_m.len();
        if n < 2 || seen.contains(&i) {
            return None;
        }
        let (joint, inner, next) = match backward {
            true => (l.points_m[n - 1], l.points_m[n - 2], n - 2),
            false => (l.points_m[0], l.points_m[1], 1),
        };
        let direction = if backward { joint - inner } else { inner - joint };
        let straight = direction.normalize_or_zero().dot(heading);
        (joint.distance(at_m) <= JOINT_M && straight > 0.3).then_some((straight, i, next))
    });
    let best = candidates.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
    Some((best.1, best.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(lines: &[&[[f64; 2]]]) -> BevLayout {
        let line = |points: &&[[f64; 2]]| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: points.iter().map(|p| DVec2::from_array(*p)).collect(),
        };
        let lines = lines.iter().map(line).collect();
        BevLayout::from_cells(vec![0; 40_000], lines).expect("the right size")
    }

    #[test]
    fn the_way_goes_on_over_joints_and_ends() {
        let layout = layout(&[
            &[[0.0, 0.0], [10.0, 0.0]],
            &[[10.0, 0.0], [10.0, 20.0]], // a right angle is no continuation
            &[[10.2, 0.0], [20.0, 0.0], [20.0, 5.0]],
        ]);
        let start = nearest_lane(&layout, DVec2::new(4.0, 1.0), 2.0).expect("near");
        assert_eq!((start.at_m, start.distance_m), (DVec2::new(4.0, 0.0), 1.0));
        assert_eq!(along(&layout, &start, 3.0), (DVec2::new(7.0, 0.0), 0.0));
        let (at_m, yaw) = along(&layout, &start, 18.0);
        assert!(at_m.distance(DVec2::new(20.0, 2.0)) < 1e-9, "{at_m}");
        assert!((yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!(along(&layout, &start, 31.0).0.distance(DVec2::new(20.0, 15.0)) < 1e-9);
        assert_eq!(along(&layout, &start, -6.0), (DVec2::new(-2.0, 0.0), 0.0));
        assert!(nearest_lane(&layout, DVec2::new(4.0, 3.0), 2.0).is_none());
        assert!(nearest_lane(&layout, DVec2::NAN, 2.0).is_none());
    }

    #[test]
    fn a_ring_and_a_point_end() {
        let ring = layout(&[
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 0.0]],
            &[[1.0, 1.0], [1.0, 1.0]],
        ]);
        let start = nearest_lane(&ring, DVec2::new(1.0, 0.0), 2.0).expect("near");
        assert!(along(&ring, &start, 1e6).0.is_finite());
        assert!(along(&ring, &start, -1e6).0.is_finite());
    }
}
