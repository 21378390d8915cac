//! Poses of the key frames, aligned by their sweeps: the tables know no height, roll and pitch of the vehicle. Boxes of a key frame
//! were drawn on its sweep, so they move with it.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{BoxId, Pose, SceneBox, SweepRecording};

use super::objects::{RecordedObjects, holds, scene_box};
use super::occupancy::{on_vehicle, sweep_points};
use super::read::Recording;
use super::{Skipped, count};
use crate::import::ImportFile;
use crate::import::drive::align::align;
use crate::import::drive::survey::{PlacedSurvey, Survey, SurveyedDrive};
use crate::nuscenes::yaw_rad;

/// A point this far outside of a box may come from what is in it, m.
const BESIDE_M: f64 = 0.2;

/// The sweeps of key frames.
pub(super) struct Surveys {
    /// Key frame of each.
    frames: Vec<usize>,
    surveys: Vec<Survey>,
}

impl Surveys {
    /// Reads the sweeps of all key frames; those that cannot be read are left out and counted.
    pub(super) fn read(source: &ImportFile<'_>, recording: &Recording, skipped: &mut Skipped) -> Self {
        let mut out = Self {
            frames: Vec::new(),
            surveys: Vec::new(),
        };
        for (i, frame) in recording.frames.iter().enumerate() {
            let Some(sweep) = &frame.sweep else { continue };
            let Some(points) = sweep_points(source, sweep) else {
                count(skipped, "LiDAR sweeps that could not be read", 1);
                continue;
            };
            let (mut seen, mut not_finite) = (Vec::new(), 0);
            for p in points {
                not_finite += usize::from(!p.is_finite());
                if p.is_finite() && !on_vehicle(&recording.rig, sweep.ego_from_lidar.apply(p)) {
                    seen.push(p);
                }
            }
            count(skipped, "points that are not finite", not_finite);
            if out.frames.len() == SweepRecording::MOST {
                break;
            }
            out.frames.push(i);
            out.surveys.push(Survey::new(seen.into_iter()));
        }
        out
    }

    /// Aligns the poses of the key frames, and moves their boxes with them; a note for a person.
    pub(super) fn align(&self, recording: &mut Recording) -> Option<String> {
        if self.frames.len() < 2 {
            return None;
        }
        let place = |i: &usize| {
            let frame = &recording.frames[*i];
            let lidar = frame.sweep.as_ref().map_or(Pose::IDENTITY, |s| s.ego_from_lidar);
            frame.world_from_ego * lidar
        };
        let given: Vec<Pose> = self.frames.iter().map(place).collect();
        // What is annotated may move: only the rest tells where the vehicle is.
        let fixed: Vec<Vec<DVec3>> = (self.frames.iter().zip(&self.surveys).zip(&given))
            .map(|((i, survey), pose)| {
                let boxes = boxes_of(recording, *i);
                let in_box = |p: &DVec3| {
                    let at = pose.apply(*p);
                    boxes.iter().any(|b| holds(b, at, BESIDE_M))
                };
                survey.points().iter().copied().filter(|p| !in_box(p)).collect()
            })
            .collect();
        let points: Vec<&[DVec3]> = fixed.iter().map(Vec::as_slice).collect();
        let aligned = align(&points, &given);
        let moved: Vec<Pose> = aligned
            .poses
            .iter()
            .zip(&given)
            .map(|(now, given)| *now * given.inverse())
            .collect();
        for (i, frame) in recording.frames.iter_mut().enumerate() {
            // A key frame without a sweep moves with the last one that has one.
            let known = self.frames.partition_point(|f| *f <= i).saturating_sub(1);
            let by = moved[known];
            frame.world_from_ego = by * frame.world_from_ego;
            for object in &mut recording.objects {
                if let Some(b) = object.boxes.get_mut(&i) {
                    let turned = by
                        * Pose {
                            translation_m: b.center_m,
                            ..Pose::planar(0.0, 0.0, b.yaw_rad)
                        };
                    (b.center_m, b.yaw_rad) = (turned.translation_m, yaw_rad(turned.rotation));
                }
            }
        }
        Some(aligned.note())
    }

    /// The sweeps, put together, with the objects of the tables.
    pub(super) fn drive(self, recording: &Recording, things: &RecordedObjects) -> Arc<SurveyedDrive> {
        let of = |i: &usize| {
            let frame = &recording.frames[*i];
            let lidar = frame.sweep.as_ref().map_or(Pose::IDENTITY, |s| s.ego_from_lidar);
            (frame.world_from_ego, lidar)
        };
        let moving = self.frames.iter().map(|i| things.moving[*i].clone()).collect();
        let placed = self.frames.iter().map(of).zip(self.surveys);
        let placed = placed.map(|((world_from_ego, lidar), survey)| {
            PlacedSurvey::of_sensor(survey, world_from_ego * lidar, &lidar)
        });
        let placed = placed.collect();
        Arc::new(match recording.objects.is_empty() {
            true => SurveyedDrive::new(placed),
            false => SurveyedDrive::with_objects(placed, moving),
        })
    }
}

/// Boxes of a key frame.
fn boxes_of(recording: &Recording, frame: usize) -> Vec<SceneBox> {
    let annotated = recording.objects.iter().filter_map(|object| {
        let at = object.boxes.get(&frame)?;
        Some(scene_box(BoxId(0), object, at, DVec2::ZERO))
    });
    annotated.collect()
}
