//! Objects that stand, and objects that move.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use scene::clip::ObjectVoxels;
use scene::{BoxId, Class, Clip, Frame, Key, Motion, SceneBox, Track};

use super::read::{Annotation, Object, Recording};
use super::{Skipped, count};

/// An object stands if it stays within this distance of its first place, m, and this angle of its first heading, rad.
const STANDS_M: f64 = 0.05;
const STANDS_RAD: f64 = 0.01;
/// Parked objects, barriers and cones stand if they stay within this distance of their middle place, m: annotations
/// jitter.
const JITTER_M: f64 = 0.5;
/// Longest time between two boxes from which the devkit tells a velocity, s; twice that for both neighbours.
const LONGEST_S: f64 = 1.5;

/// Objects of a scene.
pub(super) struct RecordedObjects {
    /// Objects that stand and are always there.
    pub(super) standing: BTreeMap<BoxId, SceneBox>,
    /// Objects that move, come or go.
    pub(super) tracks: BTreeMap<BoxId, Track>,
    /// Boxes of the tracks by key frame.
    pub(super) moving: Vec<Vec<SceneBox>>,
}

/// The objects, numbered in order. Objects that are not sound are counted.
pub(super) fn things(recording: &Recording, skipped: &mut Skipped) -> RecordedObjects {
    let times_s: Vec<f64> = recording.frames.iter().map(|f| f.time_s).collect();
    let mut out = RecordedObjects {
        standing: BTreeMap::new(),
        tracks: BTreeMap::new(),
        moving: vec![Vec::new(); times_s.len()],
    };
    for (i, object) in recording.objects.iter().enumerate() {
        let id = BoxId(i as u32 + 1);
        let Some(&first) = object.boxes.values().next() else {
            continue;
        };
        let everywhere = object.boxes.len() == times_s.len();
        let is_fixed = object.parked || matches!(object.class, Class::Barrier | Class::TrafficCone);
        // (a folder that Sceneloom wrote does not jitter)
        let jitters = is_fixed && !recording.is_own;
        let middle = middle(recording, object).filter(|m| jitters && stays(object, m.center_m, JITTER_M));
        let at = middle.unwrap_or(first);
        let made = scene_box(id, object, &at, velocity_mps(object, &times_s));
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
        if middle.is_some() || stands(object, &first) && (everywhere || is_fixed) {
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
            voxels: ObjectVoxels::drafted(scene::Lattice::OCC3D, &made),
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

/// The box of an object at a place.
pub(super) fn scene_box(id: BoxId, object: &Object, at: &Annotation, velocity_mps: DVec2) -> SceneBox {
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

/// The motion through keyframes. A motion stands before its first keyframe and after its last. So an object that moves
/// there gets one more keyframe straight on at either end, to have its velocity at all times.
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

/// The box that stands for all places of an object: the middle place along x and along y, with heading and size of the
/// box nearest to it. Its height is that of the key frame in which the vehicle is nearest, as poses on a slope are
/// known without their height. `None` for an object that never moves: it is where it was first, to the last bit.
fn middle(recording: &Recording, object: &Object) -> Option<Annotation> {
    let first = object.boxes.values().next()?;
    if stands(object, first) {
        return None;
    }
    let axis = |of: fn(&Annotation) -> f64| {
        numeric::quantile::median(&object.boxes.values().map(of).collect::<Vec<_>>())
    };
    let at_m = DVec2::new(axis(|a| a.center_m.x), axis(|a| a.center_m.y));
    let off = |a: &Annotation| a.center_m.truncate().distance_squared(at_m);
    let nearest = object.boxes.values().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let seen_from = |(frame, a): &(&usize, &Annotation)| {
        let ego_m = recording.frames[**frame].world_from_ego.translation_m;
        a.center_m.truncate().distance_squared(ego_m.truncate())
    };
    let closest = object
        .boxes
        .iter()
        .min_by(|a, b| seen_from(a).total_cmp(&seen_from(b)))?;
    Some(Annotation {
        center_m: at_m.extend(closest.1.center_m.z),
        ..*nearest
    })
}

/// True if no box of an object is farther than this from a place, seen from above.
fn stays(object: &Object, at: DVec3, within_m: f64) -> bool {
    let off = |a: &Annotation| a.center_m.truncate().distance(at.truncate());
    object.boxes.values().all(|a| off(a) <= within_m)
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

/// Velocity at the first box as `NuScenes.box_velocity` gives it; 0 where that gives none.
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

#[cfg(test)]
mod tests {
    use scene::{Pose, SensorRig};

    use super::*;
    use crate::import::nuscenes::read::KeyFrame;

    /// A drive of 20 s at 5 m/s with a key frame every half second, past objects whose annotations are off by some centimetres and,
    /// as the poses know no height, rise by two metres with the slope of the road.
    fn drive(object: impl Fn(usize) -> (Class, bool, f64, f64)) -> Recording {
        let frames = (0..40).map(|i| KeyFrame {
            token: i.to_string(),
            time_s: i as f64 * 0.5,
            world_from_ego: Pose::planar(i as f64 * 2.5, 0.0, 0.0),
            sweep: None,
        });
        let one = |n: usize| {
            let (class, parked, speed_mps, jitter_m) = object(n);
            let boxes = (0..40).map(|i| {
                let off = |k: usize| (((i * 7 + k * 3) % 11) as f64 / 5.0 - 1.0) * jitter_m;
                let x = 50.0 + speed_mps * i as f64 * 0.5;
                let annotation = Annotation {
                    center_m: DVec3::new(
                        x + off(0),
                        4.0 * n as f64 + off(1),
                        0.8 + (50.0 - i as f64 * 2.5) / 25.0,
                    ),
                    size_m: DVec3::new(0.5, 2.0, 1.0),
                    yaw_rad: off(2),
                };
                (i, annotation)
            });
            Object {
                class,
                label: Default::default(),
                parked,
                boxes: boxes.collect(),
            }
        };
        Recording {
            name: "drive".into(),
            description: String::new(),
            frames: frames.collect(),
            objects: (0..4).map(one).collect(),
            rig: SensorRig::default(),
            world_from_global: Pose::IDENTITY,
            is_own: false,
            labels: Vec::new(),
        }
    }

    #[test]
    fn barriers_and_parked_cars_stand_although_their_annotations_jitter() {
        let recording = drive(|n| match n {
            0 => (Class::Barrier, false, 0.0, 0.2),
            1 => (Class::Car, true, 0.0, 0.2),
            2 => (Class::Car, false, 0.0, 0.2),
            _ => (Class::Car, true, 3.0, 0.05),
        });
        let things = things(&recording, &mut Skipped::new());
        let standing: Vec<u32> = things.standing.keys().map(|id| id.0).collect();
        // A car that nobody calls parked may creep; one that drives drives, whatever it is called.
        assert_eq!(standing, [1, 2]);
        assert_eq!(things.tracks.keys().map(|id| id.0).collect::<Vec<_>>(), [3, 4]);
        for (n, b) in things.standing.values().enumerate() {
            let off_m = b.center_m.truncate().distance(DVec2::new(50.0, 4.0 * n as f64));
            assert!(off_m < 0.1, "{b:?}");
            // The height is that of the key frame in which the vehicle passes.
            assert!((b.center_m.z - 0.8).abs() < 0.11, "{b:?}");
            assert_eq!(b.velocity_mps, DVec2::ZERO);
        }
    }
}
