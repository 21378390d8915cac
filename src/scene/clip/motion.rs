//! Motion of a thing: keyframes, a path with a profile of speeds, or attachment to another thing. The motion is what
//! the user made; poses are computed from it.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fit::fitted;
use super::path::Path;
use crate::{BoxId, SceneBox};

/// Time within which a path that became keyframes moves from its old line to the new one, s.
const COME_OVER_S: f64 = 1.0;

/// Place on the ground at a moment, and velocity. World frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Its centre, m.
    pub at_m: DVec2,
    /// Heading, rad, counter-clockwise from x.
    pub yaw_rad: f64,
    /// Velocity over ground, m/s.
    pub velocity_mps: DVec2,
}

impl Moving {
    /// Standing at a place.
    pub fn still(at_m: DVec2, yaw_rad: f64) -> Self {
        Self {
            at_m,
            yaw_rad,
            velocity_mps: DVec2::ZERO,
        }
    }

    /// A point given along and across its heading, in the world frame, m.
    pub fn to_world(&self, local_m: DVec2) -> DVec2 {
        self.at_m + DVec2::from_angle(self.yaw_rad).rotate(local_m)
    }
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Time in the clip, s.
    pub time_s: f64,
    /// Centre in the world frame, m.
    #[schemars(with = "[f64; 2]")]
    pub at_m: DVec2,
    /// Heading, degrees counter-clockwise from x.
    pub yaw_deg: f64,
}

/// How a thing moves, in the world frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Motion {
    /// Through keyframes, smoothly and without overshoot: it stands before the first, after the last, and between two that
    /// are at the same place.
    Keys(Vec<Key>),
    /// Along a path, with a profile of speeds.
    Path(Path),
    /// Fixed to another track, such as a trailer to its truck or a rider to a bicycle.
    Attached {
        /// Track that it is fixed to.
        to: BoxId,
        /// Its centre in the other's frame (along its heading, to its left), m.
        #[schemars(with = "[f64; 2]")]
        at_m: DVec2,
        /// Its heading against the other's, degrees.
        #[serde(default)]
        yaw_deg: f64,
    },
}

impl Motion {
    /// Keyframes or points of a motion at most.
    pub const MAX_POINTS: usize = 10_000;
    /// Latest time of a keyframe, s.
    pub const MAX_TIME_S: f64 = 3600.0;

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        match self {
            Self::Keys(keys) => keys_problem(keys),
            Self::Path(path) => path.problem(),
            Self::Attached { at_m, yaw_deg, .. } => {
                let sound = at_m.is_finite() && at_m.length() <= 100.0 && yaw_deg.is_finite();
                (!sound).then(|| {
                    format!(
                        "attached at [{}, {}] m, {yaw_deg} degrees, expected finite numbers and at most 100 m",
                        at_m.x, at_m.y
                    )
                })
            }
        }
    }

    /// Place and velocity at a time; `parent` finds the track that it is attached to. `None` if that one is not there.
    pub fn at(&self, time_s: f64, parent: impl FnOnce(BoxId) -> Option<Moving>) -> Option<Moving> {
        match self {
            Self::Keys(keys) => at_keys(keys, time_s),
            Self::Path(path) => Some(path.at(time_s)),
            Self::Attached { to, at_m, yaw_deg } => {
                let to = parent(*to)?;
                Some(Moving {
                    at_m: to.to_world(*at_m),
                    yaw_rad: to.yaw_rad + yaw_deg.to_radians(),
                    velocity_mps: to.velocity_mps,
                })
            }
        }
    }

    /// Distance covered by a time since the motion began, forward along the heading, m; 0 if it is attached.
    pub fn covered_m(&self, time_s: f64) -> f64 {
        match self {
            Self::Keys(keys) => covered_by_keys_m(keys, time_s),
            Self::Path(path) => path.covered_m(time_s),
            Self::Attached { .. } => 0.0,
        }
    }

    /// The times that the user set, s.
    pub fn times_s(&self) -> Vec<f64> {
        match self {
            Self::Keys(keys) => keys.iter().map(|k| k.time_s).collect(),
            Self::Path(path) => path.speeds.iter().map(|s| s.time_s).collect(),
            Self::Attached { .. } => Vec::new(),
        }
    }

    /// The motion with every place and heading changed by the move that takes `from` to `to`.
    pub fn carried(&self, from: &Moving, to: &Moving) -> Self {
        let turn_rad = to.yaw_rad - from.yaw_rad;
        let carry = |p: DVec2| match turn_rad == 0.0 {
            true => p + (to.at_m - from.at_m),
            false => to.at_m + DVec2::from_angle(turn_rad).rotate(p - from.at_m),
        };
        match self {
            Self::Keys(keys) => Self::Keys(keys.iter().map(|k| carried_key(k, turn_rad, carry)).collect()),
            Self::Path(path) => {
                let mut path = path.clone();
                path.points_m.iter_mut().for_each(|p| *p = carry(*p));
                Self::Path(path)
            }
            Self::Attached {
                to: id,
                at_m,
                yaw_deg,
            } => {
                // In the frame of the track that it is attached to, whose heading is this one's less the offset.
                let parent = from.yaw_rad - yaw_deg.to_radians();
                let by = DVec2::from_angle(-parent).rotate(to.at_m - from.at_m);
                Self::Attached {
                    to: *id,
                    at_m: *at_m + by,
                    yaw_deg: yaw_deg + turn_rad.to_degrees(),
                }
            }
        }
    }

    /// The motion changed from `time_s` on by the move that takes `from` (its place then) to `to`; the transition takes
    /// the second before. A path becomes keyframes.
    pub fn carried_from(&self, time_s: f64, from: &Moving, to: &Moving, sampling: &KeyframeSampling) -> Self {
        let mut keys = self.as_keys(sampling);
        self.hold(&mut keys, time_s - COME_OVER_S, sampling);
        set_key(&mut keys, key(time_s, from));
        let Self::Keys(moved) = Self::Keys(keys.clone()).carried(from, to) else {
            return self.clone();
        };
        for (key, moved) in keys.iter_mut().zip(moved) {
            if key.time_s >= time_s {
                *key = moved;
            }
        }
        Self::Keys(keys)
    }

    /// The motion changed so that it passes through `to` at a time; its other keyframes stay. A path becomes keyframes.
    pub fn through(&self, time_s: f64, to: &Moving, sampling: &KeyframeSampling) -> Self {
        let mut keys = self.as_keys(sampling);
        self.hold(&mut keys, time_s - COME_OVER_S, sampling);
        self.hold(&mut keys, time_s + COME_OVER_S, sampling);
        set_key(&mut keys, key(time_s, to));
        Self::Keys(keys)
    }

    /// Adds a key at the place of a motion without keys of its own, if the time lies between the keys made of it.
    fn hold(&self, keys: &mut Vec<Key>, time_s: f64, sampling: &KeyframeSampling) {
        let inside =
            keys.first().is_some_and(|k| k.time_s < time_s) && keys.last().is_some_and(|k| time_s < k.time_s);
        if !matches!(self, Self::Keys(_))
            && inside
            && let Some(pose) = self.at(time_s, |id| (sampling.parent)(id, time_s))
        {
            set_key(keys, key(time_s, &pose));
        }
    }

    /// The motion as keyframes; for a path, as few as reproduce it.
    fn as_keys(&self, sampling: &KeyframeSampling) -> Vec<Key> {
        match self {
            Self::Keys(keys) => keys.clone(),
            _ => {
                let steps = (sampling.length_s / KeyframeSampling::EVERY_S).ceil().max(1.0) as usize;
                let time_s = |i: usize| sampling.length_s * i as f64 / steps as f64;
                let pose = |i| {
                    self.at(time_s(i), |id| (sampling.parent)(id, time_s(i)))
                        .map(|m| key(time_s(i), &m))
                };
                fitted(&(0..=steps).filter_map(pose).collect::<Vec<_>>())
            }
        }
    }

    /// The motion at other times: `time` maps old ones to new ones and must keep their order.
    pub fn retimed(&self, time: impl Fn(f64) -> f64) -> Self {
        let mut out = self.clone();
        match &mut out {
            Self::Keys(keys) => keys.iter_mut().for_each(|k| k.time_s = time(k.time_s)),
            Self::Path(path) => path.retime(time),
            Self::Attached { .. } => {}
        }
        out
    }

    /// The motion mirrored in a line through `at_m` along `yaw_rad`.
    pub fn mirrored(&self, at_m: DVec2, yaw_rad: f64) -> Self {
        let along = DVec2::from_angle(yaw_rad);
        let flip = |p: DVec2| {
            let from = p - at_m;
            at_m + 2.0 * along * along.dot(from) - from
        };
        let turn = |yaw_deg: f64| 2.0 * yaw_rad.to_degrees() - yaw_deg;
        match self {
            Self::Keys(keys) => Self::Keys(
                keys.iter()
                    .map(|k| Key {
                        at_m: flip(k.at_m),
                        yaw_deg: turn(k.yaw_deg),
                        ..*k
                    })
                    .collect(),
            ),
            Self::Path(path) => {
                let mut path = path.clone();
                path.points_m.iter_mut().for_each(|p| *p = flip(*p));
                Self::Path(path)
            }
            Self::Attached { to, at_m, yaw_deg } => Self::Attached {
                to: *to,
                at_m: DVec2::new(at_m.x, -at_m.y),
                yaw_deg: -yaw_deg,
            },
        }
    }
}

/// Parameters for sampling keyframes from a motion that has none.
pub struct KeyframeSampling<'a> {
    /// Length of the clip, s.
    pub length_s: f64,
    /// Where another track is at a time.
    pub parent: &'a dyn Fn(BoxId, f64) -> Option<Moving>,
}

impl KeyframeSampling<'_> {
    /// Time between the sampled poses that the keyframes must reproduce, s.
    const EVERY_S: f64 = 0.1;
}

impl From<&SceneBox> for Moving {
    fn from(b: &SceneBox) -> Self {
        Self {
            at_m: b.center_m.truncate(),
            yaw_rad: b.yaw_rad,
            velocity_mps: b.velocity_mps,
        }
    }
}

fn key(time_s: f64, pose: &Moving) -> Key {
    Key {
        time_s,
        at_m: pose.at_m,
        yaw_deg: pose.yaw_rad.to_degrees(),
    }
}

/// Inserts a key at its time and replaces one that is there.
fn set_key(keys: &mut Vec<Key>, new: Key) {
    // Times that a person cannot tell apart are the same time.
    const SAME_S: f64 = 1e-6;
    match keys.iter_mut().find(|k| (k.time_s - new.time_s).abs() < SAME_S) {
        Some(key) => *key = new,
        None => {
            let at = keys.partition_point(|k| k.time_s < new.time_s);
            keys.insert(at, new);
        }
    }
}

fn carried_key(key: &Key, turn_rad: f64, carry: impl Fn(DVec2) -> DVec2) -> Key {
    Key {
        at_m: carry(key.at_m),
        yaw_deg: key.yaw_deg + turn_rad.to_degrees(),
        ..*key
    }
}

fn keys_problem(keys: &[Key]) -> Option<String> {
    let found = keys.len();
    if !(1..=Motion::MAX_POINTS).contains(&found) {
        return Some(format!("{found} keyframes, expected 1 to {}", Motion::MAX_POINTS));
    }
    for (i, key) in keys.iter().enumerate() {
        if key.time_s.is_nan() || key.time_s.abs() > Motion::MAX_TIME_S {
            return Some(format!(
                "keyframe {i}: time_s is {}, expected at most {}",
                key.time_s,
                Motion::MAX_TIME_S
            ));
        }
        let near = key.at_m.abs().cmple(DVec2::splat(SceneBox::LIMIT_M)).all();
        if !near || !key.yaw_deg.is_finite() {
            return Some(format!(
                "keyframe {i}: at [{}, {}] m, {} degrees, expected finite numbers and at most {} m",
                key.at_m.x,
                key.at_m.y,
                key.yaw_deg,
                SceneBox::LIMIT_M
            ));
        }
    }
    super::order_problem("keyframe", keys.iter().map(|k| k.time_s))
}

/// A cubic through the keys: the tangent at a key is the mean of its neighbours' slope, shortened so that nothing
/// overshoots (Fritsch and Carlson 1980, for vectors).
pub(super) fn at_keys(keys: &[Key], time_s: f64) -> Option<Moving> {
    let (first, last) = (keys.first()?, keys.last()?);
    let still = |k: &Key| Some(Moving::still(k.at_m, k.yaw_deg.to_radians()));
    if time_s.is_nan() || time_s < first.time_s || keys.len() == 1 {
        return still(first);
    }
    if time_s > last.time_s {
        return still(last);
    }
    // At the very first and last moment it moves as between the keys: a clip that ends there shows no sudden stop.
    let i = (keys.partition_point(|k| k.time_s <= time_s) - 1).min(keys.len() - 2);
    let (a, b) = (&keys[i], &keys[i + 1]);
    let span = b.time_s - a.time_s;
    let u = ((time_s - a.time_s) / span).clamp(0.0, 1.0);
    let at = |i: usize| keys[i].at_m;
    let (ma, mb) = (tangent(keys, i, at), tangent(keys, i + 1, at));
    let (p, v) = hermite(u, span, at(i), at(i + 1), ma, mb);
    let yaw = unwrapped(keys, i);
    let yaw_at = |j: usize| DVec2::new(yaw[j.abs_diff(i.saturating_sub(1))], 0.0);
    let ends = [i, i + 1].map(|j| tangent_within(keys, j, (i.saturating_sub(1), i + 2), yaw_at));
    let (yaw, _) = hermite(u, span, yaw_at(i), yaw_at(i + 1), ends[0], ends[1]);
    Some(Moving {
        at_m: p,
        yaw_rad: yaw.x,
        velocity_mps: v,
    })
}

/// Steps in which the way between two keyframes is measured.
const MEASURED_IN: usize = 12;

/// Distance covered between the first key and a time, forward along the heading, m. It grows without jumps.
fn covered_by_keys_m(keys: &[Key], time_s: f64) -> f64 {
    let spans = keys.windows(2).take_while(|pair| pair[0].time_s < time_s);
    let moving = spans.filter(|pair| pair[0].at_m != pair[1].at_m);
    let covered = moving.map(|pair| {
        let (from_s, step_s) = (
            pair[0].time_s,
            (pair[1].time_s - pair[0].time_s) / MEASURED_IN as f64,
        );
        let done = ((time_s - from_s) / step_s).min(MEASURED_IN as f64);
        let times = (0..=done as usize).map(|i| i as f64).chain([done]);
        let points: Vec<Moving> = times.filter_map(|n| at_keys(keys, from_s + n * step_s)).collect();
        let ways = points.windows(2).map(|pair| {
            let ahead = DVec2::from_angle(pair[0].yaw_rad);
            (pair[1].at_m - pair[0].at_m).dot(ahead)
        });
        ways.sum::<f64>()
    });
    covered.sum()
}

/// Headings of keys `i - 1` (where there is one) to `i + 2`, each within half a turn of the one before, rad.
fn unwrapped(keys: &[Key], i: usize) -> Vec<f64> {
    let from = i.saturating_sub(1);
    let to = (i + 3).min(keys.len());
    let mut out: Vec<f64> = Vec::with_capacity(4);
    for key in &keys[from..to] {
        let yaw = key.yaw_deg.to_radians();
        let next = match out.last() {
            None => yaw,
            Some(last) => {
                let turn = (yaw - last + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
                last + turn - std::f64::consts::PI
            }
        };
        out.push(next);
    }
    out
}

fn tangent(keys: &[Key], i: usize, at: impl Fn(usize) -> DVec2) -> DVec2 {
    tangent_within(keys, i, (0, keys.len() - 1), at)
}

/// Slope at a key, per second. Keys outside of `range` are not looked at.
fn tangent_within(keys: &[Key], i: usize, range: (usize, usize), at: impl Fn(usize) -> DVec2) -> DVec2 {
    let slope = |a: usize, b: usize| (at(b) - at(a)) / (keys[b].time_s - keys[a].time_s);
    let before = (i > range.0).then(|| slope(i - 1, i));
    let after = (i < range.1.min(keys.len() - 1)).then(|| slope(i, i + 1));
    match (before, after) {
        (Some(before), Some(after)) => {
            let most = 3.0 * before.length().min(after.length());
            slope(i - 1, i + 1).clamp_length_max(most)
        }
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => DVec2::ZERO,
    }
}

/// Value and slope per second of the cubic between two ends, `u` in 0 to 1 of `span` seconds.
fn hermite(u: f64, span: f64, a: DVec2, b: DVec2, slope_a: DVec2, slope_b: DVec2) -> (DVec2, DVec2) {
    let (u2, u3) = (u * u, u * u * u);
    let value = a * (2.0 * u3 - 3.0 * u2 + 1.0)
        + slope_a * span * (u3 - 2.0 * u2 + u)
        + b * (3.0 * u2 - 2.0 * u3)
        + slope_b * span * (u3 - u2);
    let slope = (b - a) * (6.0 * (u - u2)) / span
        + slope_a * (3.0 * u2 - 4.0 * u + 1.0)
        + slope_b * (3.0 * u2 - 2.0 * u);
    (value, slope)
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
