//! Objects that are followed through the sweeps of a drive: what one look finds is kept if the next ones find it too.
//!
//! Finds are joined forward in time: each track says where it expects its object (Kalman filters of constant velocity along x and y),
//! and the nearest pairs of tracks and finds are joined first. A track that is seen often enough is an object. One that stays at
//! its place stands there, at the median of its places; others move through smoothed places, heading along their way.
//! After Weng et al., "AB3DMOT" (arXiv 1907.03961), whose measure of nearness is replaced by the distance seen from above.

use formats::import::TrackedObject;
use glam::{DVec2, DVec3};
use nets::perceiver::detection::DetectionGroup;
use numeric::quantile::{median, quantile};
use scene::Class;

/// A find of a moment, in the world frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Find {
    pub(crate) group: DetectionGroup,
    pub(crate) score: f64,
    pub(crate) at_m: DVec2,
    pub(crate) size_m: DVec3,
    pub(crate) yaw_rad: f64,
}

/// Least score of a find with which a track begins.
const BEGINS: f64 = 0.3;
/// Time without a find after which a track ends, s, but never before this number of moments.
const LOST_S: f64 = 1.2;
const LOST_MOMENTS: usize = 2;
/// Fewest finds of an object, fewer where there are few moments; the least mean of their scores (of
/// vehicles, of people and two-wheelers, which street furniture is taken for), and the least share of the moments from the first to the last.
const LEAST_FINDS: usize = 3;
const LEAST_MEAN: [f64; 2] = [0.33, 0.5];
const LEAST_SHARE: f64 = 0.5;
/// An object whose first and last places are nearer than this, m, or that is slower than this, m/s, stands.
const STANDS_M: f64 = 1.0;
const STANDS_MPS: f64 = 0.4;
/// Deviation of a find from its place, m, and of the acceleration of an object, m/s².
const FIND_M: f64 = 0.35;
const ACCELERATION: f64 = 2.5;
/// Speed from which an object heads where it goes, m/s.
const HEADS_MPS: f64 = 1.0;

/// Kinds that are told apart: a van is a car to some looks and a truck to others.
fn kind(group: DetectionGroup) -> usize {
    match group {
        DetectionGroup::Car | DetectionGroup::Large => 0,
        DetectionGroup::Person => 1,
        DetectionGroup::Cycle => 2,
        DetectionGroup::Barrier => 3,
    }
}

/// Distance between two objects of a kind that cannot be both there, m; `None` for kinds that are not told from street furniture
/// on real sweeps.
fn apart_m(group: DetectionGroup) -> Option<f64> {
    match kind(group) {
        0 => Some(2.0),
        1 | 2 => Some(0.8),
        _ => None,
    }
}

/// A filter of place and velocity along one axis.
#[derive(Clone, Copy, Debug)]
struct AxisFilter {
    place: f64,
    velocity: f64,
    /// Covariance: of place, of both, of velocity.
    spread: [f64; 3],
}

impl AxisFilter {
    fn new(place: f64) -> Self {
        Self {
            place,
            velocity: 0.0,
            spread: [FIND_M * FIND_M, 0.0, 100.0],
        }
    }

    fn after(self, s: f64) -> Self {
        let [pp, pv, vv] = self.spread;
        let noise = ACCELERATION * ACCELERATION;
        Self {
            place: self.place + s * self.velocity,
            velocity: self.velocity,
            spread: [
                pp + 2.0 * s * pv + s * s * vv + noise * s.powi(4) / 4.0,
                pv + s * vv + noise * s.powi(3) / 2.0,
                vv + noise * s * s,
            ],
        }
    }

    fn seen_at(self, place: f64) -> Self {
        let [pp, pv, vv] = self.spread;
        let off = place - self.place;
        let [gain_p, gain_v] = [pp, pv].map(|c| c / (pp + FIND_M * FIND_M));
        Self {
            place: self.place + gain_p * off,
            velocity: self.velocity + gain_v * off,
            spread: [(1.0 - gain_p) * pp, (1.0 - gain_p) * pv, vv - gain_v * pv],
        }
    }
}

/// An object that is being followed.
struct Followed {
    finds: Vec<(usize, Find)>,
    time_s: f64,
    axes: [AxisFilter; 2],
}

impl Followed {
    fn new(moment: usize, time_s: f64, find: Find) -> Self {
        Self {
            finds: vec![(moment, find)],
            time_s,
            axes: find.at_m.to_array().map(AxisFilter::new),
        }
    }

    /// Where it is expected, and how far from there it may be, m.
    fn expected(&self, time_s: f64) -> (DVec2, f64) {
        let axes = self.axes.map(|axis| axis.after(time_s - self.time_s));
        let spread = axes[0].spread[0].max(axes[1].spread[0]).sqrt();
        let kind = kind(self.finds[0].1.group);
        let most = [4.0, 1.5, 2.5, 1.0][kind.min(3)];
        (
            DVec2::from_array(axes.map(|a| a.place)),
            (3.0 * spread).clamp(0.8, most),
        )
    }

    fn joined(&mut self, moment: usize, time_s: f64, find: Find) {
        let at = find.at_m.to_array();
        for (axis, at) in self.axes.iter_mut().zip(at) {
            *axis = axis.after(time_s - self.time_s).seen_at(at);
        }
        self.time_s = time_s;
        self.finds.push((moment, find));
    }

    fn last(&self) -> usize {
        self.finds.last().map_or(0, |f| f.0)
    }

    fn mean_score(&self) -> f64 {
        self.finds.iter().map(|f| f.1.score).sum::<f64>() / self.finds.len() as f64
    }

    fn is_object(&self, moments: usize) -> bool {
        let span = self.last() - self.finds[0].0 + 1;
        self.finds.len() >= LEAST_FINDS.min(moments.div_ceil(2))
            && self.mean_score() >= LEAST_MEAN[kind(self.finds[0].1.group).min(1)]
            && self.finds.len() as f64 >= LEAST_SHARE * span as f64
    }
}

/// The objects that these finds of the moments are of; `times_s` are those of the moments, rising.
pub(crate) fn objects(moments: &[Vec<Find>], times_s: &[f64]) -> Vec<TrackedObject> {
    let mut tracks: Vec<Followed> = Vec::new();
    for (moment, (finds, time_s)) in moments.iter().zip(times_s).enumerate() {
        let mut pairs = Vec::new();
        for (t, track) in tracks.iter().enumerate() {
            let is_lost = time_s - track.time_s > LOST_S && moment - track.last() > LOST_MOMENTS;
            if is_lost {
                continue;
            }
            let (at_m, within_m) = track.expected(*time_s);
            for (f, find) in finds.iter().enumerate() {
                let off_m = at_m.distance(find.at_m);
                if kind(find.group) == kind(track.finds[0].1.group) && off_m <= within_m {
                    pairs.push((off_m, t, f));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut is_joined, mut is_taken) = (vec![false; tracks.len()], vec![false; finds.len()]);
        for (_, t, f) in pairs {
            if !is_joined[t] && !is_taken[f] {
                (is_joined[t], is_taken[f]) = (true, true);
                tracks[t].joined(moment, *time_s, finds[f]);
            }
        }
        for (find, is_taken) in finds.iter().zip(is_taken) {
            if !is_taken && find.score >= BEGINS && apart_m(find.group).is_some() {
                tracks.push(Followed::new(moment, *time_s, *find));
            }
        }
    }
    tracks.retain(|track| track.is_object(moments.len()));
    tracks.sort_by_key(|track| std::cmp::Reverse(track.finds.len()));
    let mut out: Vec<(usize, TrackedObject)> = Vec::new();
    for track in &tracks {
        let object = object(track, times_s);
        let group = kind(track.finds[0].1.group);
        let near_m = apart_m(track.finds[0].1.group).unwrap_or(0.0);
        let is_new = out
            .iter()
            .all(|(other_group, other)| *other_group != group || !are_one(&object, other, near_m));
        if is_new {
            out.push((group, object));
        }
    }
    out.into_iter().map(|(_, object)| object).collect()
}

/// True if two objects are at one place at one moment; one that stands is there at all moments.
fn are_one(a: &TrackedObject, b: &TrackedObject, near_m: f64) -> bool {
    a.places.iter().any(|(moment, at_m, _)| {
        let there = b
            .places
            .iter()
            .filter(|place| place.0 == *moment || a.places.len() == 1 || b.places.len() == 1);
        there.into_iter().any(|place| place.1.distance(*at_m) < near_m)
    })
}

/// The object of a track.
fn object(track: &Followed, times_s: &[f64]) -> TrackedObject {
    let of = |value: fn(&Find) -> f64| -> Vec<f64> { track.finds.iter().map(|f| value(&f.1)).collect() };
    let size = |value: fn(&Find) -> f64| quantile(&of(value), 0.7);
    let size_m = DVec3::new(size(|f| f.size_m.x), size(|f| f.size_m.y), size(|f| f.size_m.z));
    let third = (track.finds.len() / 3).max(1);
    let middle = |finds: &[(usize, Find)]| {
        let of = |value: fn(&Find) -> f64| median(&finds.iter().map(|f| value(&f.1)).collect::<Vec<_>>());
        DVec2::new(of(|f| f.at_m.x), of(|f| f.at_m.y))
    };
    let way_m = middle(&track.finds[track.finds.len() - third..]).distance(middle(&track.finds[..third]));
    let time_s = times_s[track.last()] - times_s[track.finds[0].0];
    let stands = way_m < STANDS_M || way_m < STANDS_MPS * time_s;
    let places = match stands {
        true => {
            let surest = track.finds.iter().max_by(|a, b| a.1.score.total_cmp(&b.1.score));
            let axis_rad = surest.map_or(0.0, |f| f.1.yaw_rad);
            let yaw_rad = heading(track, axis_rad);
            vec![(track.finds[0].0, middle(&track.finds), yaw_rad)]
        }
        false => smoothed(track, times_s),
    };
    TrackedObject {
        class: class(track),
        size_m,
        places,
    }
}

/// The class that most finds have, by their scores.
fn class(track: &Followed) -> Class {
    let score = |group: DetectionGroup| -> f64 {
        let same = track.finds.iter().filter(|f| f.1.group == group);
        same.map(|f| f.1.score).sum()
    };
    let best = DetectionGroup::ALL
        .into_iter()
        .max_by(|a, b| score(*a).total_cmp(&score(*b)));
    best.map_or(Class::Others, DetectionGroup::class)
}

/// The mean heading of finds that lie along an axis, towards the end that most of them take for the front.
fn heading(track: &Followed, axis_rad: f64) -> f64 {
    let (mut sum, mut ahead) = (DVec2::ZERO, 0.0);
    for (_, find) in &track.finds {
        let off = DVec2::from_angle(find.yaw_rad - axis_rad);
        if off.x.abs() > 0.8 {
            sum += find.score * off * off.x.signum();
            ahead += find.score * off.x.signum();
        }
    }
    let turned = axis_rad + sum.to_angle();
    match ahead < 0.0 {
        true => turned + std::f64::consts::PI,
        false => turned,
    }
}

/// Filters after each of these finds; their times rise.
fn filtered(finds: impl Iterator<Item = (f64, DVec2)>) -> Vec<[AxisFilter; 2]> {
    let mut out: Vec<[AxisFilter; 2]> = Vec::new();
    let mut before_s = None;
    for (time_s, at_m) in finds {
        let at = at_m.to_array();
        let now = match (out.last(), before_s) {
            (Some(axes), Some(before_s)) => {
                [0, 1].map(|axis| axes[axis].after(time_s - before_s).seen_at(at[axis]))
            }
            _ => at.map(AxisFilter::new),
        };
        before_s = Some(time_s);
        out.push(now);
    }
    out
}

/// Places of an object that moves: those of filters forward and backward in time, the surer one counting more; heading along the
/// way.
fn smoothed(track: &Followed, times_s: &[f64]) -> Vec<(usize, DVec2, f64)> {
    let finds = || {
        track
            .finds
            .iter()
            .map(|(moment, find)| (times_s[*moment], find.at_m))
    };
    let forward = filtered(finds());
    let mut backward = filtered(finds().rev().map(|(time_s, at_m)| (-time_s, at_m)));
    backward.reverse();
    let mut heading = None;
    let place = |(i, (moment, find)): (usize, &(usize, Find))| {
        let joined = |axis: usize| {
            let (a, b) = (forward[i][axis], backward[i][axis]);
            let mean = |a: (f64, f64), b: (f64, f64)| (a.0 / a.1 + b.0 / b.1) / (1.0 / a.1 + 1.0 / b.1);
            [
                mean((a.place, a.spread[0]), (b.place, b.spread[0])),
                mean((a.velocity, a.spread[2]), (-b.velocity, b.spread[2])),
            ]
        };
        let [x, y] = [joined(0), joined(1)];
        let velocity = DVec2::new(x[1], y[1]);
        let yaw_rad = match velocity.length() >= HEADS_MPS {
            true => velocity.to_angle(),
            false => heading.unwrap_or(find.yaw_rad),
        };
        heading = Some(yaw_rad);
        (*moment, DVec2::new(x[0], y[0]), yaw_rad)
    };
    track.finds.iter().enumerate().map(place).collect()
}

#[cfg(test)]
#[path = "tracks_tests.rs"]
mod tests;
