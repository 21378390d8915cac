//! Motion in a scene: tracks of objects and of the ego vehicle over time. The parts that stand still are the scene's
//! canvas; a frame is the canvas with the moving objects at their places of a moment.

mod fit;
mod fold;
mod motion;
mod object_voxels;
mod path;
mod template;
mod view;

use std::collections::BTreeMap;
use std::sync::Arc;

pub use fold::{ComposedFrame, Scope, fold};
pub use motion::{Key, KeyframeSampling, Motion, Moving};
pub use object_voxels::{MARGIN_M, ObjectVoxels, OwnShape, upright};
pub use path::{Path, Speed};
pub use template::{Manoeuvre, Pace, Template};

use crate::{BoxId, Pose, Relief, SceneBox};

/// An object that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Class, size and label; its pose is the one at which the voxels were made.
    pub made: SceneBox,
    /// How it moves.
    pub motion: Motion,
    /// Time span in which it is there, s: from the first up to, but not at, the second. None means from the beginning,
    /// or to the end.
    pub there_s: [Option<f64>; 2],
    /// Its voxels at the pose of `made`.
    pub voxels: Arc<ObjectVoxels>,
    /// False while the voxels are a draft that the networks have not drawn yet.
    pub settled: bool,
    /// True if the voxels are its own, in place of those of its class: pictures show them.
    pub own_shape: bool,
}

impl Track {
    /// True if it is there at a time.
    pub fn is_there(&self, time_s: f64) -> bool {
        self.there_s[0].is_none_or(|from| time_s >= from) && self.there_s[1].is_none_or(|to| time_s < to)
    }

    /// True if it stands at one place all the time.
    pub fn stands(&self) -> bool {
        matches!(&self.motion, Motion::Keys(keys) if keys.len() <= 1) && self.there_s == [None; 2]
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let named = |problem: String| format!("track {}: {problem}", self.made.id.0);
        if let Some(problem) = self.made.problem() {
            return Some(problem);
        }
        if let Some(problem) = self.motion.problem().or_else(|| self.voxels.problem()) {
            return Some(named(problem));
        }
        let [from, to] = self.there_s;
        let finite = |t: Option<f64>| t.is_none_or(|t| t.abs() <= Motion::MAX_TIME_S);
        let ordered = from.zip(to).is_none_or(|(from, to)| from < to);
        (!(finite(from) && finite(to) && ordered)).then(|| {
            named(format!(
                "there from {from:?} to {to:?} s, expected the first before the second"
            ))
        })
    }
}

/// Moving objects, and the length of the scene. A scene that stands still lasts 0 s and has no tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// How long the scene lasts, s.
    pub length_s: f64,
    /// Frames per second of what is written and of single steps.
    pub rate_hz: f64,
    /// How the ego vehicle moves; none if it stands where the canvas says.
    pub ego: Option<Motion>,
    /// Moving objects.
    pub tracks: BTreeMap<BoxId, Track>,
}

impl Default for Clip {
    fn default() -> Self {
        Self {
            length_s: 0.0,
            rate_hz: 10.0,
            ego: None,
            tracks: BTreeMap::new(),
        }
    }
}

impl Clip {
    /// Longest clip, s.
    pub const MAX_LENGTH_S: f64 = 600.0;
    /// Tracks at most.
    pub const MAX_TRACKS: usize = 2000;
    /// Frames at most.
    pub const MAX_FRAMES: usize = 6000;
    /// How many things may be attached to each other in a row.
    const MAX_ATTACHED: usize = 8;

    /// True if there is only the canvas.
    pub fn is_still(&self) -> bool {
        self.ego.is_none() && self.tracks.is_empty()
    }

    /// True if nothing ever changes its place: the ego vehicle has no motion, and every track stands where it is all
    /// the time.
    pub fn stands(&self) -> bool {
        self.ego.is_none() && self.tracks.values().all(Track::stands)
    }

    /// Number of frames, the first at 0 s.
    pub fn frames(&self) -> usize {
        (self.length_s * self.rate_hz + 1e-6) as usize + 1
    }

    /// Time of a frame, s.
    pub fn time_of(&self, frame: usize) -> f64 {
        frame as f64 / self.rate_hz
    }

    /// The frame nearest to a time.
    pub fn frame_at(&self, time_s: f64) -> usize {
        let frame = (time_s.clamp(0.0, self.length_s) * self.rate_hz).round() as usize;
        frame.min(self.frames() - 1)
    }

    /// Where a track is at a time; `None` if it is not there then.
    pub fn moving(&self, id: BoxId, time_s: f64) -> Option<Moving> {
        self.moving_within(id, time_s, Self::MAX_ATTACHED)
    }

    fn moving_within(&self, id: BoxId, time_s: f64, left: usize) -> Option<Moving> {
        let track = self.tracks.get(&id).filter(|t| t.is_there(time_s))?;
        track
            .motion
            .at(time_s, |to| self.moving_within(to, time_s, left.checked_sub(1)?))
    }

    /// Distance that a track has covered since its motion began, forward along its heading, m; of an attached one that of what it
    /// is attached to, and 0 for other ids.
    pub fn covered_m(&self, id: BoxId, time_s: f64) -> f64 {
        self.covered_within(id, time_s, Self::MAX_ATTACHED)
    }

    fn covered_within(&self, id: BoxId, time_s: f64, left: usize) -> f64 {
        match self.motion(Some(id)) {
            Some(Motion::Attached { to, .. }) => {
                let left = left.checked_sub(1);
                left.map_or(0.0, |left| self.covered_within(*to, time_s, left))
            }
            Some(motion) => motion.covered_m(time_s),
            None => 0.0,
        }
    }

    /// The box of a track at a time, standing on the ground there; `None` if it is not there then.
    pub fn box_at(&self, id: BoxId, time_s: f64, relief: &Relief) -> Option<SceneBox> {
        let moving = self.moving(id, time_s)?;
        let mut b = self.tracks.get(&id)?.made;
        if !relief.is_flat() {
            b.center_m.z += relief.height_m(moving.at_m) - relief.height_m(b.center_m.truncate());
        }
        b.center_m = moving.at_m.extend(b.center_m.z);
        b.yaw_rad = moving.yaw_rad;
        b.velocity_mps = moving.velocity_mps;
        Some(b)
    }

    /// Where the ego vehicle is at a time; `still` is where the canvas puts it.
    pub fn ego_at(&self, time_s: f64, still: &Pose, relief: &Relief) -> Pose {
        let moving = self
            .ego
            .as_ref()
            .and_then(|motion| motion.at(time_s, |to| self.moving(to, time_s)));
        match moving {
            None => *still,
            Some(m) if relief.is_flat() => Pose::planar(m.at_m.x, m.at_m.y, m.yaw_rad),
            Some(m) => relief.pose_on(m.at_m, m.yaw_rad),
        }
    }

    /// How the ego vehicle moves at a time, as far as a motion says it.
    pub fn ego_moving(&self, time_s: f64) -> Option<Moving> {
        let motion = self.ego.as_ref()?;
        motion.at(time_s, |to| self.moving(to, time_s))
    }

    /// The motion of a track, or (`None`) of the ego vehicle.
    pub fn motion(&self, id: Option<BoxId>) -> Option<&Motion> {
        match id {
            Some(id) => self.tracks.get(&id).map(|t| &t.motion),
            None => self.ego.as_ref(),
        }
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        // Written so that NaN fails too.
        if !(0.0..=Self::MAX_LENGTH_S).contains(&self.length_s) {
            let (found, most) = (self.length_s, Self::MAX_LENGTH_S);
            return Some(format!("a clip of {found} s, expected 0 to {most}"));
        }
        if !(0.1..=100.0).contains(&self.rate_hz) {
            return Some(format!(
                "a clip of {} frames per second, expected .1 to 100",
                self.rate_hz
            ));
        }
        let (frames, most) = (self.frames(), Self::MAX_FRAMES);
        if frames > most {
            return Some(format!("a clip of {frames} frames, expected at most {most}"));
        }
        let (tracks, most) = (self.tracks.len(), Self::MAX_TRACKS);
        if tracks > most {
            return Some(format!("{tracks} tracks, expected at most {most}"));
        }
        if let Some(problem) = self.ego.as_ref().and_then(Motion::problem) {
            return Some(format!("ego: {problem}"));
        }
        for (id, track) in &self.tracks {
            if *id != track.made.id {
                let (found, filed) = (track.made.id.0, id.0);
                return Some(format!("track {found} is filed under id {filed}"));
            }
            if let Some(problem) = track.problem().or_else(|| self.attachment_problem(*id)) {
                return Some(problem);
            }
        }
        if let Some(Motion::Attached { to, .. }) = self.ego
            && !self.tracks.contains_key(&to)
        {
            return Some(format!("ego: attached to track {}, which does not exist", to.0));
        }
        None
    }

    fn attachment_problem(&self, id: BoxId) -> Option<String> {
        let mut at = id;
        for _ in 0..=Self::MAX_ATTACHED {
            match &self.tracks.get(&at)?.motion {
                Motion::Attached { to, .. } if !self.tracks.contains_key(to) => {
                    return Some(format!(
                        "track {}: attached to track {}, which does not exist",
                        at.0, to.0
                    ));
                }
                Motion::Attached { to, .. } => at = *to,
                _ => return None,
            }
        }
        let most = Self::MAX_ATTACHED;
        Some(format!(
            "track {}: attached in a circle, or to more than {most} in a row",
            id.0
        ))
    }
}

/// The problem with times that do not increase, in one line.
fn order_problem(what: &str, times_s: impl Iterator<Item = f64>) -> Option<String> {
    let mut last: Option<f64> = None;
    for (i, time_s) in times_s.enumerate() {
        if let Some(last) = last.filter(|last| *last >= time_s) {
            let problem = if last == time_s {
                "at the same time as"
            } else {
                "before"
            };
            return Some(format!(
                "{what} {i} at {time_s} s is {problem} the one before it at {last} s, expected increasing times"
            ));
        }
        last = Some(time_s);
    }
    None
}

#[cfg(test)]
mod tests;
