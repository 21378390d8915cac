//! World scenarios: the tables that NVIDIA's driving-video models and simulators take (Cosmos-Transfer 2.5,
//! `docs/world_scenario_parquet.md`), and the control video that is drawn of them (`docs/world_scenario_video_generation.md`).
//!
//! Both are in the frame of the ego vehicle at the beginning of the clip, on the ground, with z straight up: x forward, y left.

pub(crate) mod boundary;
pub(crate) mod draw;
pub(crate) mod draw_lines;
pub(crate) mod draw_scene;
pub mod ftheta;
pub(crate) mod map;
pub(crate) mod rig;
pub(crate) mod tables;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};
use scene::{Class, Pose, Scene, SceneBox};

/// Rows of the tables per second; readers interpolate between them.
pub(crate) const TABLE_HZ: f64 = 10.0;
/// Pictures of the control video per second.
pub(crate) const VIDEO_HZ: f64 = 30.0;
/// Length of the scenario of a scene that stands still, s: readers drop objects that they see at a single moment.
const STILL_S: f64 = 1.0;

/// How long the scenario of a scene is, s.
pub(crate) fn length_s(scene: &Scene) -> f64 {
    match scene.clip().length_s {
        length_s if length_s > 0.0 => length_s,
        _ => STILL_S,
    }
}

/// Moments of a scene, s: `rate_hz` per second from 0, and its end.
pub(crate) fn times_s(scene: &Scene, rate_hz: f64) -> Vec<f64> {
    let length_s = length_s(scene);
    let count = (length_s * rate_hz + 1e-6) as usize;
    let mut out: Vec<f64> = (0..=count).map(|i| i as f64 / rate_hz).collect();
    if out.last().is_some_and(|last| length_s - last > 1e-6) {
        out.push(length_s);
    }
    out
}

/// Takes points of the scene's world to the frame of the scenario.
pub(crate) fn scenario_from_world(scene: &Scene) -> Pose {
    let first = ego_at(scene, 0.0);
    let ahead = first.rotation * DVec3::X;
    let level = Pose {
        translation_m: first.translation_m,
        ..Pose::planar(0.0, 0.0, ahead.truncate().to_angle())
    };
    level.inverse()
}

/// Where the ego vehicle is at a time, in the scene's world.
pub(crate) fn ego_at(scene: &Scene, time_s: f64) -> Pose {
    let canvas = scene.canvas();
    scene
        .clip()
        .ego_at(time_s, &canvas.world_from_ego, &canvas.layout.relief)
}

/// Every box that is there at a time, those that stand still first; in the frame of the scenario.
pub(crate) fn boxes_at(scene: &Scene, time_s: f64, scenario_from_world: &Pose) -> Vec<SceneBox> {
    let still = scene.canvas().boxes.values().copied();
    let moving = scene.clip().boxes_at(time_s, scene.canvas());
    still
        .chain(moving)
        .map(|b| b.in_frame(scenario_from_world))
        .collect()
}

/// The five kinds of objects that the models tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ObjectCategory {
    Car,
    Truck,
    Pedestrian,
    Cyclist,
    Others,
}

/// The category of a class in the tables, and the kind that readers make of it.
pub(crate) fn category(class: Class) -> (&'static str, ObjectCategory) {
    match class {
        Class::Car => ("automobile", ObjectCategory::Car),
        Class::Truck | Class::ConstructionVehicle => ("heavy_truck", ObjectCategory::Truck),
        Class::Bus => ("bus", ObjectCategory::Truck),
        Class::Trailer => ("trailer", ObjectCategory::Truck),
        Class::Bicycle | Class::Motorcycle => ("rider", ObjectCategory::Cyclist),
        Class::Pedestrian => ("person", ObjectCategory::Pedestrian),
        _ => ("protruding_object", ObjectCategory::Others),
    }
}

/// The name that all files of a scenario begin with.
pub(crate) fn clip_id(scene: &Scene) -> String {
    let tidy = |c: char| {
        if c.is_ascii_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = scene.name.chars().map(tidy).take(80).collect();
    match name.trim_matches('_') {
        "" => format!("scene_{}", scene.seed),
        _ => name,
    }
}

/// A point of the ground in the frame of the scenario.
pub(crate) fn on_ground(scene: &Scene, scenario_from_world: &Pose, at_m: DVec2) -> DVec3 {
    let height_m = scene.canvas().layout.relief.height_m(at_m);
    scenario_from_world.apply(at_m.extend(height_m))
}
