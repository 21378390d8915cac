//! The way around a corner: off the own road into one that leads to the side.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use crate::kerb::is_roadway;
use crate::lanes::{CentrelinePoint, along};
use scene::{BevLayout, Polyline, PolylineKind};

/// A street leads to the side if it turns off by so much, rad: 45 to 135 degrees.
const SIDEWAYS_RAD: [f64; 2] = [FRAC_PI_2 / 2.0, FRAC_PI_2 * 1.5];
/// A lane that begins this far beside the own way still leads off it, m: streets end at the border of a junction.
const BEGINS_M: f64 = 16.0;
/// The street goes on at least so far behind the corner, m.
const GOES_ON_M: f64 = 12.0;
/// Radius of a turn across the oncoming lanes, and of one to the near side, m.
const WIDE_M: f64 = 9.0;
const TIGHT_M: f64 = 6.5;
/// No vehicle bends sharper between two points of a way, rad.
const SHARPEST_RAD: f64 = 0.5;
/// Distance between points, m.
const STEP_M: f64 = 1.0;
/// Comfortable sideways acceleration, m/s².
const ASIDE_MPS2: f64 = 2.0;

/// A way with a corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning {
    /// Points a metre or less apart.
    pub points_m: Vec<DVec2>,
    /// Begin and end of the corner, m along the way.
    pub corner_m: [f64; 2],
    /// Speed around it, m/s.
    pub mps: f64,
}

/// A lane that the own way meets.
struct Meeting {
    /// Along the own way, m.
    along_m: f64,
    at_m: DVec2,
    heading: DVec2,
    lane: CentrelinePoint,
}

/// The way along `own_m` (points about a metre apart) up to the first street that leads to the left, or to the right, and
/// `length_m` into it. `None` if there is none.
pub fn turning(layout: &BevLayout, own_m: &[DVec2], left: bool, length_m: f64) -> Option<Turning> {
    let radius_m = if left { WIDE_M } else { TIGHT_M };
    let lanes: Vec<(usize, &Polyline)> = layout
        .polylines
        .iter()
        .enumerate()
        .filter(|(_, l)| l.kind == PolylineKind::LaneCenter && l.points_m.len() >= 2)
        .collect();
    let mut passed_m = 0.0;
    for pair in own_m.windows(2) {
        let length = pair[0].distance(pair[1]);
        let meet = |(i, lane): &(usize, &Polyline)| meeting(pair, passed_m, (*i, lane), left);
        let here = lanes.iter().filter_map(meet);
        // A corner begins ahead of the turning vehicle.
        let possible = here.filter(|m| m.along_m > radius_m + 1.0 && goes_on(layout, &m.lane, radius_m));
        let mut possible: Vec<Meeting> = possible.collect();
        possible.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
        let mut ways = possible
            .iter()
            .map(|m| around(layout, own_m, m, radius_m, length_m));
        if let Some(way) = ways.find(|way| can_be_driven(layout, way)) {
            return Some(way);
        }
        passed_m += length;
    }
    None
}

/// Place where a piece of the own way meets a lane that leads to the side asked for.
fn meeting(pair: &[DVec2], passed_m: f64, (line, lane): (usize, &Polyline), left: bool) -> Option<Meeting> {
    let own = pair[1] - pair[0];
    let points = &lane.points_m;
    let first = (points[1] - points[0]).normalize_or_zero();
    let before = [points[0] - first * BEGINS_M, points[0]];
    let pieces = std::iter::once((None, before)).chain(
        points
            .array_windows::<2>()
            .enumerate()
            .map(|(i, p)| (Some(i), *p)),
    );
    for (segment, [a, b]) in pieces {
        let way = b - a;
        let turned = own.angle_to(way) * if left { 1.0 } else { -1.0 };
        if !(SIDEWAYS_RAD[0]..=SIDEWAYS_RAD[1]).contains(&turned) {
            continue;
        }
        let across = own.perp_dot(way);
        let (t, u) = (
            (a - pair[0]).perp_dot(way) / across,
            (a - pair[0]).perp_dot(own) / across,
        );
        if !(0.0..1.0).contains(&t) || !(0.0..=1.0).contains(&u) {
            continue;
        }
        let at_m = a + way * u;
        let heading = way.normalize_or_zero();
        let on_lane_m = if segment.is_some() { at_m } else { points[0] };
        return Some(Meeting {
            along_m: passed_m + own.length() * t,
            at_m,
            heading,
            lane: CentrelinePoint::on(line, segment.unwrap_or(0), on_lane_m, heading.to_angle()),
        });
    }
    None
}

/// True if a street goes on where a lane leads, and does not turn back.
fn goes_on(layout: &BevLayout, lane: &CentrelinePoint, radius_m: f64) -> bool {
    let heading = DVec2::from_angle(lane.yaw_rad);
    let end_m = radius_m + GOES_ON_M;
    [0.4, 0.7, 1.0].iter().all(|share| {
        let (at_m, yaw_rad) = along(layout, lane, end_m * share);
        is_roadway(layout, at_m) && DVec2::from_angle(yaw_rad).dot(heading) > 0.3
    })
}

/// True if a way keeps to the road around its corner, and bends nowhere behind it as no vehicle could.
fn can_be_driven(layout: &BevLayout, way: &Turning) -> bool {
    let (mut passed_m, mut before) = (0.0, None);
    for pair in way.points_m.array_windows::<2>() {
        let step = pair[1] - pair[0];
        passed_m += step.length();
        if passed_m <= way.corner_m[0] || step.length() < 1e-6 {
            continue;
        }
        let bend_rad = before.map_or(0.0, |b: DVec2| b.angle_to(step).abs());
        let at_corner = passed_m < way.corner_m[1] + GOES_ON_M;
        if bend_rad > SHARPEST_RAD || at_corner && !is_roadway(layout, pair[1]) {
            return false;
        }
        before = Some(step);
    }
    true
}

/// Along the own way to the corner, around it, and along the lane.
fn around(layout: &BevLayout, own_m: &[DVec2], meeting: &Meeting, radius_m: f64, length_m: f64) -> Turning {
    let begin_m = meeting.along_m - radius_m;
    let mut points_m: Vec<DVec2> = Vec::new();
    let mut passed_m = 0.0;
    for pair in own_m.windows(2) {
        points_m.push(pair[0]);
        let length = pair[0].distance(pair[1]);
        if passed_m + length >= begin_m {
            points_m.push(pair[0].lerp(pair[1], ((begin_m - passed_m) / length.max(1e-9)).clamp(0.0, 1.0)));
            break;
        }
        passed_m += length;
    }
    let from_m = points_m.last().copied().unwrap_or(meeting.at_m);
    let ahead = (meeting.at_m - from_m).normalize_or_zero();
    let to_m = meeting.at_m + meeting.heading * radius_m;
    // Controls of a quarter of a circle of this radius.
    let arm_m = 0.552 * radius_m;
    let [p1, p2] = [from_m + ahead * arm_m, to_m - meeting.heading * arm_m];
    let steps = (radius_m * FRAC_PI_2 / STEP_M * 2.0).ceil() as usize;
    let curve = (1..=steps).map(|i| {
        let t = i as f64 / steps as f64;
        let u = 1.0 - t;
        from_m * (u * u * u) + p1 * (3.0 * u * u * t) + p2 * (3.0 * u * t * t) + to_m * (t * t * t)
    });
    let curve: Vec<DVec2> = curve.collect();
    let curved_m: f64 = std::iter::once(&from_m)
        .chain(&curve)
        .zip(&curve)
        .map(|(a, b)| a.distance(*b))
        .sum();
    points_m.extend(&curve);
    let on_m = (to_m - meeting.lane.at_m).dot(meeting.heading).max(0.0);
    let more = (length_m / STEP_M).ceil().clamp(1.0, 2000.0) as usize;
    points_m.extend((1..=more).map(|i| along(layout, &meeting.lane, on_m + i as f64 * STEP_M).0));
    Turning {
        points_m,
        corner_m: [begin_m, begin_m + curved_m],
        mps: (ASIDE_MPS2 * radius_m).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use scene::{BevLayer, Extent};

    /// A road along x, lanes at y = -2 (ours) and 2 (oncoming); one across it along y at x = 30, lanes at x = 32 (to the
    /// left, seen from us) and 28 (to the right); with `side` only the half at y < -4, its lanes beginning there.
    fn layout(side: bool) -> BevLayout {
        let extent = Extent::new([-100, -150], [400, 300]).expect("sound");
        let mut layout = BevLayout::over(extent);
        for [x, y] in extent.all_columns() {
            let p = extent.center(x, y, 0);
            let across = (26.0..34.0).contains(&p.x) && (!side || p.y < 4.0);
            layout.set(BevLayer::DrivableArea, x, y, p.y.abs() < 4.0 || across);
        }
        let lane = |a: [f64; 2], b: [f64; 2]| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![a.into(), b.into()],
        };
        let mut lanes = vec![
            lane([-40.0, -2.0], [120.0, -2.0]),
            lane([120.0, 2.0], [-40.0, 2.0]),
        ];
        match side {
            true => lanes.extend([
                lane([28.0, -5.0], [28.0, -60.0]),
                lane([32.0, -60.0], [32.0, -5.0]),
            ]),
            false => lanes.extend([
                lane([28.0, 60.0], [28.0, -60.0]),
                lane([32.0, -60.0], [32.0, 60.0]),
            ]),
        }
        layout.polylines = Arc::new(lanes);
        layout
    }

    fn own() -> Vec<DVec2> {
        (0..100).map(|i| DVec2::new(f64::from(i), -2.0)).collect()
    }

    #[test]
    fn left_and_right_lead_into_the_lanes_of_that_direction() {
        let layout = layout(false);
        for (left, x, sign) in [(true, 32.0, 1.0), (false, 28.0, -1.0)] {
            let found = turning(&layout, &own(), left, 40.0).expect("a street");
            let end = found.points_m.last().expect("points");
            assert!((end.x - x).abs() < 1e-6 && end.y * sign > 30.0, "{end}");
            // Smooth: no step far, no sharp turn.
            for three in found.points_m.windows(3) {
                let [a, b] = [three[1] - three[0], three[2] - three[1]];
                assert!(a.length() < 1.6, "{three:?}");
                assert!(
                    a.length() < 1e-6 || b.length() < 1e-6 || a.angle_to(b).abs() < 0.3,
                    "{three:?}"
                );
            }
            assert!(
                found
                    .points_m
                    .iter()
                    .all(|p| is_roadway(&layout, *p) || p.y.abs() > 55.0)
            );
            let [begin_m, end_m] = found.corner_m;
            assert!(begin_m > 15.0 && (8.0..20.0).contains(&(end_m - begin_m)));
            assert!((3.0..5.0).contains(&found.mps));
        }
    }

    #[test]
    fn a_side_street_that_ends_at_ours_is_found_and_none_is_invented() {
        let layout = layout(true);
        let right = turning(&layout, &own(), false, 30.0).expect("the side street");
        assert!((right.points_m.last().expect("points").x - 28.0).abs() < 1e-6);
        assert_eq!(turning(&layout, &own(), true, 30.0), None);
        // Too near to turn; and a lane that no vehicle could follow.
        assert_eq!(turning(&layout, &own()[24..], false, 30.0), None);
        let mut bent = layout.clone();
        let lane = Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: [[28.0, -5.0], [28.0, -16.0], [32.0, -18.0], [32.0, -60.0]]
                .map(DVec2::from)
                .into(),
        };
        bent.polylines = Arc::new(vec![layout.polylines[0].clone(), lane]);
        assert_eq!(turning(&bent, &own(), false, 30.0), None);
        assert_eq!(turning(&layout, &[], false, 30.0), None);
        assert_eq!(turning(&BevLayout::default(), &own(), false, 30.0), None);
    }
}
