//! Objects that stand, and objects that move.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use scene::clip::ObjectVoxels;
use scene::{BoxId, Class, Clip, Frame, Key, Motion, SceneBox, Track};

use super::read::{Annotation, Object, Recording};
use super::{Skipped, count};

/// What never leaves this distance from where it was first, and this heading, stands.
const STANDS_M: f64 = 0.05;
const STANDS_RAD: f64 = 0.01;
/// Longest time between two boxes from which the devkit tells a velocity, s; twice that for both neighbours.
const LONGEST_S: f64 = 1.5;

/// Objects of a scene.
pub(super) struct Things {
    /// Those that stand, always there.
    pub(super) standing: BTreeMap<BoxId, SceneBox>,
    /// Those that move, come or go.
    pub(super) tracks: BTreeMap<BoxId, Track>,
    /// Boxes of the tracks by key frame.
    pub(super) moving: Vec<Vec<SceneBox>>,
}

/// The objects, numbered in order. What is not sound is counted.
pub(super) fn things(recording: &Recording, skipped: &mut Skipped) -> Things {
    let times_s: Vec<f64> = recording.frames.iter().map(|f| f.time_s).collect();
    let mut out = Things {
        standing: BTreeMap::new(),
        tracks: BTreeMap::new(),
        moving: vec![Vec::new(); times_s.len()],
    };
    for (i, object) in recording.objects.iter().enumerate() {
        let id = BoxId(i as u32 + 1);
        let Some(&first) = object.boxes.values().next() else {
            continue;
        };
        let made = scene_box(id, object, &first, velocity_mps(object, &times_s));
        let full = out.standing.len() >= Frame::MAX_BOXES || out.tracks.len() >= Clip::MAX_TRACKS;
        if full || made.problem().is_some() {
            let what = if full {
                "objects beyond the most"
            } else {
                "objects that are not sound"
            };
            count(skipped, what, 1);
            continue;
        }
        let everywhere = object.boxes.len() == times_s.len();
        let is_fixed = object.parked || matches!(object.class, Class::Barrier | Class::TrafficCone);
        if stands(object, &first) && (everywhere || is_fixed) {
            let still = SceneBox {
                velocity_mps: DVec2::ZERO,
                ..made
            };
            out.standing.insert(id, still);
            continue;
        }
        let track = Track {
            made,
            motion: motion(object.boxes.iter().map(|(f, a)| key(times_s[*f], a)).collect()),
            there_s: there_s(object, &times_s),
            voxels: ObjectVoxels::drafted(&made),
            settled: true,
            own_shape: false,
        };
        if track.problem().is_some() {
            count(skipped, "objects that are not sound", 1);
            continue;
        }
        for (frame, a) in &object.boxes {
            out.moving[*frame].push(scene_box(id, object, a, DVec2::ZERO));
        }
        out.tracks.insert(id, track);
    }
    out
}

fn scene_box(id: BoxId, object: &Object, at: &Annotation, velocity_mps: DVec2) -> SceneBox {
    SceneBox {
        id,
        class: object.class,
        center_m: at.center_m,
        size_m: at.size_m,
        yaw_rad: at.yaw_rad,
        velocity_mps,
        label: object.label,
    }
}

/// The motion through keyframes. Before the first and after the last of them a motion stands; what moves there goes straight
/// on to one more key on either side, so that it has its velocity at all times.
pub(super) fn motion(keys: Vec<Key>) -> Motion {
    let beyond = |from: &Key, end: &Key| {
        let by_m = end.at_m - from.at_m;
        let turn = DVec2::from_angle(from.yaw_deg.to_radians())
            .angle_to(DVec2::from_angle(end.yaw_deg.to_radians()));
        let next = Key {
            time_s: 2.0 * end.time_s - from.time_s,
            at_m: end.at_m + by_m,
            yaw_deg: end.yaw_deg + turn.to_degrees(),
        };
        (by_m.length() > STANDS_M).then_some(next)
    };
    let ends = match keys.as_slice() {
        [first, second, ..] => [
            beyond(second, first),
            beyond(&keys[keys.len() - 2], &keys[keys.len() - 1]),
        ],
        _ => [None; 2],
    };
    let [before, after] = ends;
    Motion::Keys(before.into_iter().chain(keys).chain(after).collect())
}

fn key(time_s: f64, at: &Annotation) -> Key {
    Key {
        time_s,
        at_m: at.center_m.truncate(),
        yaw_deg: at.yaw_rad.to_degrees(),
    }
}

fn stands(object: &Object, first: &Annotation) -> bool {
    object.boxes.values().all(|a| {
        let turn = DVec2::from_angle(a.yaw_rad).angle_to(DVec2::from_angle(first.yaw_rad));
        a.center_m.distance(first.center_m) <= STANDS_M && turn.abs() <= STANDS_RAD
    })
}

/// From the first key frame that has it up to the one after the last.
fn there_s(object: &Object, times_s: &[f64]) -> [Option<f64>; 2] {
    let first = object.boxes.keys().next().copied().filter(|f| *f > 0);
    let after = object.boxes.keys().next_back().map(|f| f + 1);
    [
        first.map(|f| times_s[f]),
        after.and_then(|f| times_s.get(f)).copied(),
    ]
}

/// Velocity at the first box, as `NuScenes.box_velocity` tells it; 0 where it tells none.
fn velocity_mps(object: &Object, times_s: &[f64]) -> DVec2 {
    let mut boxes = object.boxes.iter();
    let (Some((from, a)), Some((to, b))) = (boxes.next(), boxes.next()) else {
        return DVec2::ZERO;
    };
    let apart_s = times_s[*to] - times_s[*from];
    match apart_s > 0.0 && apart_s <= LONGEST_S {
        true => (b.center_m - a.center_m).truncate() / apart_s,
        false => DVec2::ZERO,
    }
}

/// True if a point of the world frame lies in a box, grown by `margin_m`.
pub(super) fn holds(b: &SceneBox, p: DVec3, margin_m: f64) -> bool {
    let near = b.size_m.truncate().length_squared() / 4.0 + b.size_m.z * b.size_m.z / 4.0 + 4.0;
    p.distance_squared(b.center_m) <= near && b.contains(p, margin_m)
}
