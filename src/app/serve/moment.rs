//! A moment of a scene as a request asks for it: the clip at a time, with objects where the simulator has them.

use std::collections::BTreeSet;
use std::sync::Arc;

use editor::apply::Apply;
use glam::DVec2;
use tonic::Status;

use crate::limits::{LONGEST_FRAME_US, MOST_OBJECTS};
use crate::poses::{self, Pair};
use crate::wire::DynamicObject;
use scene::{BoxId, Edit, Frame, Key, Motion, Scene, SceneBox};

/// Tolerance within which an object is left where the scene has it, m and rad: the protocol's numbers have 24 bits.
const NEAR: f64 = 1e-4;

/// From when to when a frame or a spin lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSpan {
    /// Its start, s.
    pub start_s: f64,
    /// How long it lasts, s.
    pub length_s: f64,
}

impl TimeSpan {
    /// Reads the times of a request. Errors in one line if they are not in order, too far apart, or beyond the end of
    /// the clip; a scene that stands still has no end.
    pub fn read(start_us: u64, end_us: u64, scene: &Scene) -> Result<Self, Status> {
        let Some(length_us) = end_us.checked_sub(start_us).filter(|l| *l <= LONGEST_FRAME_US) else {
            return Err(Status::invalid_argument(format!(
                "frame_start_us is {start_us} and frame_end_us {end_us}, expected an end at most {LONGEST_FRAME_US} us after the start"
            )));
        };
        let last_s = scene.clip().length_s;
        let span = Self {
            start_s: poses::seconds(start_us),
            length_s: poses::seconds(length_us),
        };
        if last_s > 0.0 && span.start_s > last_s {
            return Err(Status::out_of_range(format!(
                "frame_start_us is {start_us}, expected at most {:.0}: the clip lasts {last_s} s",
                last_s * 1e6
            )));
        }
        Ok(span)
    }

    /// The time at a share of it, s.
    pub fn at(&self, share: f64) -> f64 {
        self.start_s + share * self.length_s
    }
}

/// An object and where it is in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedObject {
    /// The box or track.
    pub id: BoxId,
    /// Pose of the middle of its box.
    pub at: Pair,
}

impl PlacedObject {
    /// Position on the ground at a share of the frame, m, and heading, rad.
    fn on_ground(&self, share: f64) -> (DVec2, f64) {
        let pose = self.at.at(share);
        (pose.translation_m.truncate(), poses::yaw_rad(&pose))
    }

    /// How fast it is, m/s.
    fn velocity_mps(&self, span: &TimeSpan) -> DVec2 {
        let way_m = (self.at.end.translation_m - self.at.start.translation_m).truncate();
        if span.length_s > 0.0 {
            way_m / span.length_s
        } else {
            DVec2::ZERO
        }
    }
}

/// The objects of a request. Errors in one line if one is not in the scene, is there twice, or has a bad pose.
pub fn placed(scene: &Scene, objects: &[DynamicObject]) -> Result<Vec<PlacedObject>, Status> {
    if objects.len() > MOST_OBJECTS {
        return Err(Status::invalid_argument(format!(
            "{} dynamic_objects, expected at most {MOST_OBJECTS}",
            objects.len()
        )));
    }
    let mut seen = BTreeSet::new();
    let read = |object: &DynamicObject| {
        let named: String = object.track_id.chars().take(80).collect();
        let id = object.track_id.parse().ok().map(BoxId);
        let known =
            |id: &BoxId| scene.clip().tracks.contains_key(id) || scene.canvas().boxes.contains_key(id);
        let Some(id) = id.filter(known) else {
            return Err(Status::invalid_argument(format!(
                "dynamic_objects has track_id {named:?}, expected the number of a box or track of the scene"
            )));
        };
        if !seen.insert(id) {
            return Err(Status::invalid_argument(format!(
                "dynamic_objects has track_id {named:?} twice"
            )));
        }
        let at = Pair::read(
            object.pose_pair.as_ref(),
            &format!("dynamic_objects {named}: pose_pair"),
        )?;
        Ok(PlacedObject { id, at })
    };
    objects.iter().map(read).collect()
}

/// The scene at a share of a span, objects where they are placed. Objects that stand there already stay as the scene has them;
/// others stand on the scene's ground, upright. Errors in one line if an object cannot stand there.
pub fn frame(
    scene: &Scene,
    span: &TimeSpan,
    share: f64,
    placed: &[PlacedObject],
) -> Result<Arc<Frame>, Status> {
    let mut scene = scene.at(span.at(share));
    let moved: Vec<&PlacedObject> = placed.iter().filter(|p| !stands(&scene, p, share)).collect();
    if moved.is_empty() {
        return Ok(scene.frame().clone());
    }
    let time_s = scene.time_s();
    let tracks: BTreeSet<BoxId> = scene.clip().tracks.keys().copied().collect();
    for one in moved.iter().filter(|p| !tracks.contains(&p.id)) {
        move_box(&mut scene, one, share)?;
    }
    if moved.iter().any(|p| tracks.contains(&p.id)) {
        scene.change_clip(|clip| {
            for one in &moved {
                let Some(track) = clip.tracks.get_mut(&one.id) else {
                    continue;
                };
                let (at_m, yaw_rad) = one.on_ground(share);
                track.there_s = [None; 2];
                track.motion = Motion::Keys(vec![Key {
                    time_s,
                    at_m,
                    yaw_deg: yaw_rad.to_degrees(),
                }]);
            }
        });
    }
    let mut frame = scene.frame().clone();
    let boxes = &mut Arc::make_mut(&mut frame).boxes;
    for one in moved {
        if let Some(b) = boxes.get_mut(&one.id) {
            b.velocity_mps = one.velocity_mps(span);
        }
    }
    Ok(frame)
}

/// True if the scene has an object where it is placed.
fn stands(scene: &Scene, placed: &PlacedObject, share: f64) -> bool {
    let (at_m, yaw_rad) = placed.on_ground(share);
    let there = |b: &SceneBox| {
        let turned = DVec2::from_angle(yaw_rad).distance(b.heading());
        b.center_m.truncate().distance(at_m) <= NEAR && turned <= NEAR
    };
    scene.frame().boxes.get(&placed.id).is_some_and(there)
}

/// Moves a box of the canvas, with its voxels.
fn move_box(scene: &mut Scene, placed: &PlacedObject, share: f64) -> Result<(), Status> {
    let Some(b) = scene.frame().boxes.get(&placed.id).copied() else {
        return Ok(());
    };
    let (at_m, yaw_rad) = placed.on_ground(share);
    let relief = &scene.frame().layout.relief;
    let up_m = relief.height_m(at_m) - relief.height_m(b.center_m.truncate());
    let edit = Edit::MoveBox {
        id: placed.id,
        center_m: Some(at_m.extend(b.center_m.z + up_m)),
        yaw_deg: Some(yaw_rad.to_degrees()),
        size_m: None,
    };
    let refused =
        |e: scene::EditError| Status::invalid_argument(format!("dynamic_objects {}: {e}", placed.id.0));
    edit.apply(scene).map_err(refused)
}
