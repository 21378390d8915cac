//! Marks of a recording: computed from a scene, and compared with it.

use std::collections::BTreeSet;

use numeric::hash::Fnv1a;

use super::{BoxId, Motion, Recorded, Scene, SceneBox, Track, VoxelPaint};

impl Recorded {
    /// All boxes, tracks, voxels and the motion of the ego vehicle of a scene that was read from a recording.
    pub fn all_of(scene: &Scene) -> Self {
        let boxes = scene.canvas().boxes.iter().map(|(id, b)| (*id, of_box(b)));
        let tracks = scene.clip().tracks.iter().map(|(id, t)| (*id, of_track(t)));
        Self {
            boxes: boxes.chain(tracks).collect(),
            ego: scene.clip().ego.as_ref().map(of_motion),
            voxels: true,
            labels: Default::default(),
        }
    }

    /// Boxes and tracks of a scene that are still as recorded.
    pub fn boxes_in(scene: &Scene) -> BTreeSet<BoxId> {
        let (canvas, clip) = (scene.canvas(), scene.clip());
        let is_same = |id: &BoxId, mark: u64| {
            canvas.boxes.get(id).is_some_and(|b| of_box(b) == mark)
                || clip.tracks.get(id).is_some_and(|t| of_track(t) == mark)
        };
        let marks = canvas.inferred.recorded.boxes.iter();
        marks
            .filter(|(id, mark)| is_same(id, **mark))
            .map(|(id, _)| *id)
            .collect()
    }

    /// The voxels of a recording that the user painted; `None` if the voxels are not from a recording.
    pub fn painted_in(scene: &Scene) -> Option<VoxelPaint> {
        let canvas = scene.canvas();
        canvas.inferred.recorded.voxels.then(|| canvas.painted.clone())
    }

    /// True if the ego vehicle of a scene moves, or stands, as recorded.
    pub fn is_ego_in(scene: &Scene) -> bool {
        let recorded = &scene.canvas().inferred.recorded;
        let is_drive = recorded.ego.is_some() || !recorded.boxes.is_empty();
        is_drive && recorded.ego == scene.clip().ego.as_ref().map(of_motion)
    }
}

fn with(hash: Fnv1a, numbers: impl IntoIterator<Item = f64>) -> Fnv1a {
    numbers
        .into_iter()
        .fold(hash, |hash, n| hash.with(n.to_bits().to_le_bytes()))
}

fn hash_box(b: &SceneBox) -> Fnv1a {
    let place = b.center_m.to_array().into_iter().chain(b.size_m.to_array());
    with(Fnv1a::new().with([b.class.id()]), place.chain([b.yaw_rad]))
}

fn of_box(b: &SceneBox) -> u64 {
    hash_box(b).get()
}

fn of_track(track: &Track) -> u64 {
    let there = track.there_s.map(|s| s.unwrap_or(f64::NAN));
    let hash = with(hash_box(&track.made), there);
    add_motion(hash, &track.motion).get()
}

fn of_motion(motion: &Motion) -> u64 {
    add_motion(Fnv1a::new(), motion).get()
}

/// Adds a motion to a hash. Recordings hold keyframes; any other motion was made by a user.
fn add_motion(hash: Fnv1a, motion: &Motion) -> Fnv1a {
    match motion {
        Motion::Keys(keys) => keys.iter().fold(hash.with([1]), |hash, key| {
            with(hash, [key.time_s, key.at_m.x, key.at_m.y, key.yaw_deg])
        }),
        other => hash.with(format!("{other:?}").into_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DVec2, DVec3};

    use super::*;
    use crate::clip::ObjectVoxels;
    use crate::{BevLayout, Class, Clip, Frame, Key, SensorRig, VoxelGrid};

    fn drive() -> Scene {
        let car = |id: u32| SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(5.0 * f64::from(id), 1.0 / 3.0, 0.8),
            size_m: DVec3::new(4.5, 1.9, 1.6),
            yaw_rad: 0.1,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let keys = |x: f64| {
            let key = |time_s: f64| Key {
                time_s,
                at_m: DVec2::new(x + time_s, 0.0),
                yaw_deg: 0.0,
            };
            Motion::Keys(vec![key(0.0), key(0.5)])
        };
        let track = Track {
            made: car(2),
            motion: keys(10.0),
            there_s: [None, Some(0.5)],
            voxels: ObjectVoxels::drafted(crate::Lattice::OCC3D, &car(2)),
            settled: true,
            own_shape: false,
        };
        let frame = Frame::new(
            BevLayout::default(),
            [(BoxId(1), car(1))].into(),
            VoxelGrid::new(),
        );
        let mut scene = Scene::single("drive", frame, Arc::new(SensorRig::default()), 0);
        scene.change_clip(|clip| {
            *clip = Clip {
                length_s: 1.0,
                ego: Some(keys(0.0)),
                tracks: [(BoxId(2), track)].into(),
                ..Clip::default()
            }
        });
        let recorded = Recorded::all_of(&scene);
        scene.change_canvas(|canvas| canvas.inferred.recorded = Arc::new(recorded));
        scene
    }

    #[test]
    fn what_is_changed_is_recorded_no_more_and_what_is_put_back_is() {
        let both: BTreeSet<BoxId> = [BoxId(1), BoxId(2)].into();
        let mut scene = drive();
        assert!(Recorded::boxes_in(&scene) == both && Recorded::is_ego_in(&scene));
        scene.change_canvas(|canvas| {
            canvas.boxes.entry(BoxId(1)).and_modify(|b| b.center_m.x += 1e-3);
        });
        assert_eq!(Recorded::boxes_in(&scene), [BoxId(2)].into());
        let before = scene.clone();
        scene.change_clip(|clip| {
            clip.ego = None;
            if let Some(track) = clip.tracks.get_mut(&BoxId(2)) {
                track.there_s = [None; 2];
            }
        });
        assert!(Recorded::boxes_in(&scene).is_empty() && !Recorded::is_ego_in(&scene));
        assert!(Recorded::is_ego_in(&before), "undo brings it back");
        let made = Scene::single(
            "made",
            (**scene.frame()).clone(),
            Arc::new(SensorRig::default()),
            0,
        );
        assert!(!Recorded::is_ego_in(&made));
    }

    #[test]
    fn marks_are_kept_as_json() {
        let marks = Recorded::all_of(&drive());
        let text = serde_json::to_string(&marks).expect("plain numbers");
        let back: Recorded = serde_json::from_str(&text).expect(&text);
        assert!(back == marks && !back.is_empty());
    }
}
