//! A path on the ground that is driven with a profile of speeds.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::{Motion, Moving};
use crate::SceneBox;

/// A speed at a time; between two the speed changes evenly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Speed {
    /// Time in the clip, s.
    pub time_s: f64,
    /// Speed along the path, m/s; negative goes back along it.
    pub mps: f64,
}

/// A path and how fast it is driven. What drives it stands where it starts until the first speed, keeps the last one, and
/// stops at the path's ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Line of the path, world frame, m; at least two points that differ.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub points_m: Vec<DVec2>,
    /// Where on it the motion starts, m from the first point.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub start_m: f64,
    /// How fast; at least one.
    pub speeds: Vec<Speed>,
    /// True if it is driven backwards, with the rear first.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rear_first: bool,
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl Path {
    /// Largest speed, m/s.
    pub const MAX_MPS: f64 = 100.0;
    /// Half of the chord along which a heading is taken, m: about half a wheelbase.
    const CHORD_M: f64 = 1.3;

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let (points, speeds) = (self.points_m.len(), self.speeds.len());
        let most = Motion::MAX_POINTS;
        if points > most {
            return Some(format!("a path of {points} points, expected at most {most}"));
        }
        if let Some(i) = self
            .points_m
            .iter()
            .position(|p| !p.abs().cmple(DVec2::splat(SceneBox::LIMIT_M)).all())
        {
            let p = self.points_m[i];
            return Some(format!(
                "point {i} of a path is [{}, {}] m, expected finite numbers and at most {} m",
                p.x,
                p.y,
                SceneBox::LIMIT_M
            ));
        }
        if self.points_m.windows(2).all(|pair| pair[0] == pair[1]) {
            return Some(format!(
                "a path of {points} points in one place, expected at least two that differ"
            ));
        }
        if !self.start_m.is_finite() {
            return Some(format!("start_m is {}, expected a finite number", self.start_m));
        }
        if !(1..=most).contains(&speeds) {
            return Some(format!("{speeds} speeds, expected 1 to {most}"));
        }
        for (i, speed) in self.speeds.iter().enumerate() {
            if speed.mps.is_nan() || speed.mps.abs() > Self::MAX_MPS {
                let (found, most) = (speed.mps, Self::MAX_MPS);
                return Some(format!("speed {i} is {found} m/s, expected at most {most}"));
            }
            if speed.time_s.is_nan() || speed.time_s.abs() > Motion::MAX_TIME_S {
                let (found, most) = (speed.time_s, Motion::MAX_TIME_S);
                return Some(format!("speed {i}: time_s is {found}, expected at most {most}"));
            }
        }
        super::order_problem("speed", self.speeds.iter().map(|s| s.time_s))
    }

    /// Length of the path, m.
    pub fn length_m(&self) -> f64 {
        self.points_m
            .windows(2)
            .map(|pair| pair[0].distance(pair[1]))
            .sum()
    }

    /// Distance along the path at a time, m, and speed then, m/s.
    pub fn along(&self, time_s: f64) -> (f64, f64) {
        let length_m = self.length_m();
        let start_m = self.start_m.clamp(0.0, length_m);
        let Some(first) = self.speeds.first().filter(|first| time_s >= first.time_s) else {
            return (start_m, 0.0);
        };
        let (mut along_m, mut now) = (start_m, *first);
        for next in self.speeds[1..].iter().take_while(|s| s.time_s <= time_s) {
            along_m += (now.mps + next.mps) / 2.0 * (next.time_s - now.time_s);
            along_m = along_m.clamp(0.0, length_m);
            now = *next;
        }
        let left_s = time_s - now.time_s;
        let next = self.speeds.iter().find(|s| s.time_s > time_s);
        let rate = next.map_or(0.0, |next| (next.mps - now.mps) / (next.time_s - now.time_s));
        let mps = now.mps + rate * left_s;
        along_m += (now.mps + mps) / 2.0 * left_s;
        match (0.0..=length_m).contains(&along_m) {
            true => (along_m, mps),
            false => (along_m.clamp(0.0, length_m), 0.0),
        }
    }

    /// Distance covered by a time since the start, forward along the heading, m.
    pub fn covered_m(&self, time_s: f64) -> f64 {
        let way_m = self.along(time_s).0 - self.along(f64::NEG_INFINITY).0;
        if self.rear_first { -way_m } else { way_m }
    }

    /// Place and velocity at a time.
    pub fn at(&self, time_s: f64) -> Moving {
        let (along_m, mps) = self.along(time_s);
        let way = self.way(along_m);
        let at_m = self.point(along_m);
        let heading = if self.rear_first { -way } else { way };
        Moving {
            at_m,
            yaw_rad: heading.to_angle(),
            velocity_mps: way * mps,
        }
    }

    /// The point at a distance along the path, m.
    pub fn point(&self, along_m: f64) -> DVec2 {
        let mut left_m = along_m;
        for pair in self.points_m.windows(2) {
            let length_m = pair[0].distance(pair[1]);
            if left_m <= length_m && length_m > 0.0 {
                return pair[0].lerp(pair[1], (left_m / length_m).max(0.0));
            }
            left_m -= length_m;
        }
        self.points_m.last().copied().unwrap_or_default()
    }

    /// Direction of the path at a distance along it, a unit vector: along a chord as long as a wheelbase, so that a
    /// corner turns it gradually.
    fn way(&self, along_m: f64) -> DVec2 {
        let length_m = self.length_m();
        let from = (along_m - Self::CHORD_M).max(0.0);
        let to = (along_m + Self::CHORD_M).min(length_m);
        (self.point(to) - self.point(from))
            .try_normalize()
            .or_else(|| {
                let mut ways = self.points_m.windows(2).map(|p| p[1] - p[0]);
                ways.find_map(DVec2::try_normalize)
            })
            .unwrap_or(DVec2::X)
    }

    /// Moves the speeds to other times and scales them, so that every place is reached at its new time.
    pub(super) fn retime(&mut self, time: impl Fn(f64) -> f64) {
        let old = self.speeds.clone();
        for (i, speed) in self.speeds.iter_mut().enumerate() {
            let (a, b) = (old[i.saturating_sub(1)], old[(i + 1).min(old.len() - 1)]);
            let span_s = b.time_s - a.time_s;
            let new_s = time(b.time_s) - time(a.time_s);
            speed.time_s = time(old[i].time_s);
            if span_s > 0.0 && new_s > 0.0 {
                speed.mps *= span_s / new_s;
            }
        }
    }
}
