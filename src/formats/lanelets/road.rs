//! From a lanelet to a road of one lane along its middle.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Lanelet;
use super::junctions::Junctions;
use crate::opendrive::XodrRoad;
use crate::opendrive::elevation::SurfaceProfile;
use crate::opendrive::lanes::{CubicPiece, Cubics, Extent, Lane, LaneKind, LaneSection, SideLanes, Travel};
use crate::opendrive::write::fit::{placed, reference};

/// Distance between two stations, m, at most.
const STEP_M: f64 = 0.5;
/// Stations of a lanelet, at most: longer ones have them farther apart.
const MOST_STATIONS: f64 = 20_000.0;

/// Longest lanelet that is read, m: motorways have some of two kilometres.
const LONGEST_M: f64 = 1e5;
/// Stations of all lanelets together, at most: those of 1,000 km of lanes. Each costs up to 400 bytes.
const MOST_IN_ALL: f64 = 2e6;

/// Stations that a lanelet is read at.
fn stations(lanelet: &Lanelet) -> f64 {
    (longest_m(lanelet) / STEP_M).ceil().clamp(2.0, MOST_STATIONS) + 1.0
}

/// Length of the longer bound.
fn longest_m(lanelet: &Lanelet) -> f64 {
    let [left, right] = &lanelet.bounds;
    length_m(left).max(length_m(right))
}

/// Names the first lanelet that is too long to become a road, or with which all are too long together, in one line.
/// Told before any work is done for them.
pub(super) fn problem<'a>(lanelets: impl Iterator<Item = &'a Lanelet>) -> Option<String> {
    let mut stations_in_all = 0.0;
    for lanelet in lanelets {
        let long_m = longest_m(lanelet);
        if !(0.0..=LONGEST_M).contains(&long_m) {
            return Some(format!(
                "lanelet {}: a bound of {long_m:.3e} m, expected at most {LONGEST_M:.0} m",
                lanelet.id
            ));
        }
        stations_in_all += stations(lanelet);
        if stations_in_all > MOST_IN_ALL {
            return Some(format!(
                "lanelet {}: with it more than {:.0} km of lanelets, expected fewer",
                lanelet.id,
                MOST_IN_ALL * STEP_M / 1e3
            ));
        }
    }
    None
}

/// The road; `None` if the lanelet has no length.
pub(super) fn of_lanelet(lanelet: &Lanelet, kind: LaneKind, junctions: &Junctions) -> Option<XodrRoad> {
    let [left, right] = &lanelet.bounds;
    let count = stations(lanelet) as usize;
    let (left, right) = (spread(left, count), spread(right, count));
    let middle: Vec<DVec3> = left.iter().zip(&right).map(|(l, r)| (l + r) / 2.0).collect();
    let plan: Vec<DVec2> = middle.iter().map(|p| p.truncate()).collect();
    let line = reference(&plan, [None, None])?;
    let (s_m, _) = placed(&line, &plan);
    let (mut offset, mut width, mut height, mut tilt) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, s) in s_m.iter().enumerate() {
        let base = line.at(*s);
        let across = DVec2::from_angle(base.heading_rad).perp();
        let t = |p: DVec3| (p.truncate() - base.position_m).dot(across);
        // The bounds where the line across the road meets them, near the points of the same share of their length.
        let [l, r] = [&left, &right]
            .map(|bound| meets(bound, i, base.position_m, across).unwrap_or_else(|| t(bound[i])));
        offset.push(l);
        width.push((l - r).max(0.0));
        height.push(middle[i].z);
        tilt.push(((left[i].z - right[i].z) / (l - r).max(0.5)).atan());
    }
    let is_flat = height.iter().all(|z| (z - height[0]).abs() < 1e-6) && tilt.iter().all(|t| t.abs() < 1e-6);
    let surface = SurfaceProfile {
        elevation: match is_flat && height[0] == 0.0 {
            true => Cubics::default(),
            false => pieces(&s_m, &height),
        },
        superelevation: match is_flat {
            true => Cubics::default(),
            false => pieces(&s_m, &tilt),
        },
        ..SurfaceProfile::default()
    };
    let lane = Lane {
        id: -1,
        kind,
        travel: if lanelet.two_way {
            Travel::Both
        } else {
            Travel::Forward
        },
        extent: Extent::Width(pieces(&s_m, &width)),
        heights: Vec::new(),
        marks: Vec::new(),
    };
    let section = LaneSection {
        start_s_m: 0.0,
        end_s_m: line.end_s_m(),
        left: Arc::default(),
        right: Arc::new(SideLanes {
            origin_s_m: 0.0,
            lanes: vec![lane],
        }),
        center_marks: Vec::new(),
    };
    let [predecessor, successor] = junctions.ends(lanelet.id);
    Some(XodrRoad {
        limits: Vec::new(),
        id: lanelet.id.to_string(),
        junction: junctions.junction_of.get(&lanelet.id).cloned(),
        left_hand: false,
        predecessor,
        successor,
        reference: line,
        surface,
        lane_offset: pieces(&s_m, &offset),
        sections: vec![section],
        objects: Vec::new(),
    })
}

fn length_m(points: &[DVec3]) -> f64 {
    points
        .windows(2)
        .map(|w| w[0].truncate().distance(w[1].truncate()))
        .sum()
}

/// So many points, evenly along a line.
fn spread(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let total = length_m(points);
    let mut out = Vec::with_capacity(count);
    let (mut i, mut behind) = (0, 0.0);
    for n in 0..count {
        let way = total * n as f64 / (count - 1) as f64;
        loop {
            let step = points[i].truncate().distance(points[i + 1].truncate());
            if way <= behind + step || i + 2 == points.len() {
                let share = if step > 0.0 {
                    ((way - behind) / step).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                out.push(points[i].lerp(points[i + 1], share));
                break;
            }
            behind += step;
            i += 1;
        }
    }
    out
}

/// How far along `across` a line meets a bound near its point `i`, m.
fn meets(bound: &[DVec3], i: usize, base: DVec2, across: DVec2) -> Option<f64> {
    const NEAR: usize = 6;
    let ahead = |k: usize| -across.perp_dot(bound[k].truncate() - base);
    let range = i.saturating_sub(NEAR)..(i + NEAR).min(bound.len() - 1);
    let crossing = |k: &usize| (ahead(*k) <= 0.0) != (ahead(k + 1) <= 0.0);
    let nearest = range.filter(crossing).min_by_key(|k| k.abs_diff(i))?;
    let (a, b) = (ahead(nearest), ahead(nearest + 1));
    let share = a / (a - b);
    let p = bound[nearest]
        .truncate()
        .lerp(bound[nearest + 1].truncate(), share);
    Some((p - base).dot(across))
}

/// Straight pieces from value to value; neighbouring pieces on one line are joined.
fn pieces(s_m: &[f64], values: &[f64]) -> Cubics {
    const NEAR: f64 = 1e-3;
    let mut out: Vec<CubicPiece> = Vec::new();
    for (s, v) in s_m.windows(2).zip(values.windows(2)) {
        let slope = (v[1] - v[0]) / (s[1] - s[0]);
        let goes_on = out.last().is_some_and(|last| {
            let at = |s: f64| last.k[0] + last.k[1] * (s - last.s_m);
            (at(s[0]) - v[0]).abs() < NEAR && (at(s[1]) - v[1]).abs() < NEAR
        });
        if !goes_on {
            out.push(CubicPiece {
                s_m: s[0],
                k: [v[0], slope, 0.0, 0.0],
            });
        }
    }
    Cubics(out)
}
