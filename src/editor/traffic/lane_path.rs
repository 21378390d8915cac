//! The path that something takes along its lane.

use glam::DVec2;

use crate::lanes::{along, nearest_lane};
use scene::{BevLayout, Moving};

/// A lane is an object's own if it is this near, m.
pub(crate) const REACH_M: f64 = 6.0;
/// Distance between two points of a path, m.
const STEP_M: f64 = 1.0;
/// Over this way something that stands beside the middle of its lane comes onto it, m.
const SETTLE_M: f64 = 18.0;

/// The way ahead from a pose, `length_m` long: along the lane under it, whose middle it nears gradually; straight ahead where
/// there is no lane. A lane that leads the other way is driven against its direction.
pub fn lane_path(layout: &BevLayout, from: &Moving, length_m: f64) -> Vec<DVec2> {
    let heading = DVec2::from_angle(from.yaw_rad);
    let steps = (length_m / STEP_M).ceil().clamp(1.0, 5000.0) as usize;
    let Some(lane) = nearest_lane(layout, from.at_m, REACH_M) else {
        let point = |i: usize| from.at_m + heading * (i as f64 * STEP_M);
        return (0..=steps).map(point).collect();
    };
    let sign = if DVec2::from_angle(lane.yaw_rad).dot(heading) < 0.0 {
        -1.0
    } else {
        1.0
    };
    // How far beside the lane it is now, to the left of the lane's direction.
    let way = DVec2::from_angle(lane.yaw_rad);
    let aside_m = way.perp_dot(from.at_m - lane.at_m);
    // Beyond the lane's end the way begins where it is, not where the lane ends.
    let beyond_m = way.dot(from.at_m - lane.at_m);
    let point = |i: usize| {
        let along_m = i as f64 * STEP_M;
        let (at_m, yaw_rad) = along(layout, &lane, beyond_m + sign * along_m);
        let left = 1.0 - smooth(along_m / SETTLE_M.min(length_m).max(STEP_M));
        at_m + DVec2::from_angle(yaw_rad).perp() * (aside_m * left)
    };
    (0..=steps).map(point).collect()
}

/// The middle of the lane under a pose, from `back_m` behind to `ahead_m` ahead; a straight line where there is no lane.
pub fn lane_through(layout: &BevLayout, from: &Moving, back_m: f64, ahead_m: f64) -> Vec<DVec2> {
    let lane = nearest_lane(layout, from.at_m, REACH_M);
    let point = |along_m: f64| match &lane {
        Some(lane) => along(layout, lane, along_m).0,
        None => from.at_m + DVec2::from_angle(from.yaw_rad) * along_m,
    };
    let steps = ((back_m + ahead_m) / (2.0 * STEP_M)).clamp(1.0, 5000.0) as usize;
    (0..=steps)
        .map(|i| point(-back_m + (back_m + ahead_m) * i as f64 / steps as f64))
        .collect()
}

/// From 0 to 1 with no slope and no curvature at either end.
pub fn smooth(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (u * (6.0 * u - 15.0) + 10.0)
}

/// A path moved to its left by so many metres at each distance along it.
pub fn aside(points_m: &[DVec2], left_m: impl Fn(f64) -> f64) -> Vec<DVec2> {
    let mut along_m = 0.0;
    let way = |i: usize| {
        let (a, b) = (
            points_m[i.saturating_sub(1)],
            points_m[(i + 1).min(points_m.len() - 1)],
        );
        (b - a).normalize_or_zero()
    };
    let mut out = Vec::with_capacity(points_m.len());
    for (i, p) in points_m.iter().enumerate() {
        if i > 0 {
            along_m += p.distance(points_m[i - 1]);
        }
        out.push(*p + way(i).perp() * left_m(along_m));
    }
    out
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use scene::{Polyline, PolylineKind};

    /// Whoever stands beyond the end of a lane starts from there, and comes back onto the lane if it leads there.
    #[test]
    fn a_way_begins_where_one_stands() {
        let mut layout = BevLayout::default();
        layout.polylines = Arc::new(vec![Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![DVec2::new(-40.0, 0.0), DVec2::new(30.0, 0.0)],
        }]);
        for (x, y, yaw_rad) in [
            (34.5, 1.0, 0.0),
            (34.5, -1.0, 3.0),
            (-43.0, 0.5, 0.1),
            (5.0, 1.5, 0.0),
        ] {
            let from = Moving::still(DVec2::new(x, y), yaw_rad);
            let path = lane_path(&layout, &from, 40.0);
            assert!(path[0].distance(from.at_m) < 1e-9, "{x} {y}: {}", path[0]);
            let step_m = path.array_windows::<2>().map(|[a, b]| a.distance(*b));
            assert!(step_m.fold(0.0, f64::max) < 1.2, "{x} {y}: no leap");
            assert!(
                path[40].y.abs() < 0.05,
                "{x} {y}: on the lane at last: {}",
                path[40]
            );
        }
    }
}
