//! Checks of a project's content, whether it comes from a file or goes into one.

use glam::DVec2;

use scene::message::one_line;
use scene::{BoxId, Frame, Relief, Scene, Track};

use super::ProjectError;

/// Largest coordinate of a polyline's point, m.
const LARGEST_M: f64 = 1e5;

/// Errors on the first thing that is not sound; JSON could not even hold a NaN.
pub(super) fn check(scene: &Scene) -> Result<(), ProjectError> {
    let unsound = |text: String| Err(ProjectError::Unsound(one_line(&format!("scene.json: {text}"))));
    if let Some(problem) = scene.conditions.problem() {
        return unsound(format!("conditions: {problem}"));
    }
    if let Some(problem) = scene.rig.problem() {
        return unsound(format!("rig: {problem}"));
    }
    if let Some(problem) = scene.background.problem() {
        return unsound(problem);
    }
    if let Some(problem) = scene.roads.problem() {
        return unsound(format!("roads: {problem}"));
    }
    if let Some(problem) = scene.arranged.problem() {
        return unsound(format!("arranged: {problem}"));
    }
    if let Some(problem) = frame_problem(scene.canvas()) {
        return unsound(format!("canvas: {problem}"));
    }
    if let Some(problem) = scene.clip().problem() {
        return unsound(format!("clip: {problem}"));
    }
    let twice = scene
        .clip()
        .tracks
        .keys()
        .find(|id| scene.canvas().boxes.contains_key(id));
    if let Some(id) = twice {
        return unsound(format!("box {} stands and moves, expected one of both", id.0));
    }
    if let Some(id) = foreign_track(scene) {
        return unsound(format!(
            "voxels of track {} are of another lattice than the map",
            id.0
        ));
    }
    Ok(())
}

/// The first track whose voxels are of another lattice than the map.
fn foreign_track(scene: &Scene) -> Option<BoxId> {
    let lattice = scene.canvas().extent().lattice();
    let foreign = |track: &Track| !track.voxels.labels.is_empty() && track.voxels.lattice != lattice;
    let mut tracks = scene.clip().tracks.iter();
    tracks.find(|(_, track)| foreign(track)).map(|(id, _)| *id)
}

fn frame_problem(frame: &Frame) -> Option<String> {
    let extent = frame.extent();
    let relief = |relief: &Relief| relief.extent().is_none_or(|e| e == extent);
    let agree = frame.occupancy.extent() == extent
        && frame.painted.extent() == extent
        && frame.source.layout.extent() == extent
        && frame.source.occupancy.extent() == extent
        && frame
            .inferred
            .unobserved
            .as_ref()
            .is_none_or(|u| u.extent() == extent)
        && frame
            .inferred
            .data_labels
            .as_ref()
            .is_none_or(|labels| labels.extent() == extent)
        && relief(&frame.layout.relief)
        && relief(&frame.source.layout.relief);
    if !agree {
        return Some(format!("layout, occupancy and source are not all of {extent}"));
    }
    if !frame.time_s.is_finite() {
        return Some(format!("time_s is {}, expected a finite number", frame.time_s));
    }
    let pose = &frame.world_from_ego;
    if !pose.translation_m.is_finite() {
        return Some(format!(
            "world_from_ego is at {}, expected finite numbers",
            pose.translation_m
        ));
    }
    if let Some(i) = frame.waivers.iter().position(|w| !w.where_m.is_finite()) {
        return Some(format!("waiver {i}: where_m is not finite"));
    }
    let norm = pose.rotation.length();
    if norm.is_nan() || (norm - 1.0).abs() > 1e-3 {
        return Some(format!(
            "world_from_ego has a quaternion of length {norm}, expected 1"
        ));
    }
    for (of, boxes, layout) in [
        ("", &frame.boxes, &frame.layout),
        ("source: ", &frame.source.boxes, &frame.source.layout),
    ] {
        let (found, most) = (boxes.len(), Frame::MAX_BOXES);
        if found > most {
            return Some(format!("{of}{found} boxes, expected at most {most}"));
        }
        for (id, b) in boxes {
            if *id != b.id {
                return Some(format!("{of}box {} is filed under id {}", b.id.0, id.0));
            }
            if let Some(problem) = b.problem() {
                return Some(format!("{of}{problem}"));
            }
        }
        let lines = layout.polylines.iter().enumerate();
        for (i, line) in lines {
            // Written so that NaN fails too. Lines are walked in steps of metres: one of 1e300 m would have no end.
            let within = |p: &DVec2| p.abs().cmple(DVec2::splat(LARGEST_M)).all();
            if !line.points_m.iter().all(within) {
                return Some(format!(
                    "{of}polyline {i}: a point is not finite or beyond {LARGEST_M} m"
                ));
            }
        }
    }
    None
}
