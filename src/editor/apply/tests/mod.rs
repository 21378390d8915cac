//! Tests of single edits: their JSON, their immediate voxels, their errors.

mod bounds;
mod boxes;
mod json;
mod map;
mod voxels;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::grid::NOT_PAINTED;

use serde_json::{Value, json};

use super::*;
use scene::draft::draft;
use scene::{
    BevLayer, BevLayout, BoxId, BoxName, Class, Extent, Polyline, SceneBox, SensorRig, Shape, VoxelGrid,
};

const FREE: u8 = Class::FREE;

/// A road along x (|y| < 4 m) with sidewalks (to 7 m), drafted; a car ahead, another beside it.
fn street() -> Scene {
    let mut layout = BevLayout::default();
    for x in 0..Extent::WINDOW.nx() {
        for y in 0..Extent::WINDOW.ny() {
            let side_m = Extent::WINDOW.center(x, y, 0).y.abs();
            layout.set(BevLayer::DrivableArea, x, y, side_m < 4.0);
            layout.set(BevLayer::Walkway, x, y, (4.0..7.0).contains(&side_m));
        }
    }
    let boxes = [car(1, 10.0, 1.6), car(2, 10.0, -1.6)].map(|b| (b.id, b));
    let boxes: BTreeMap<_, _> = boxes.into();
    let occupancy = draft(&layout, boxes.values());
    let frame = Frame::new(layout, boxes, occupancy);
    Scene::single("street", frame, Arc::new(SensorRig::default()), 0)
}

fn car(id: u32, x: f64, y: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn label_at(scene: &Scene, x: f64, y: f64, z: usize) -> u8 {
    let [x, y] = Extent::WINDOW.column_at(x, y).expect("inside");
    scene.frame().occupancy.get(x, y, z)
}

fn cars(scene: &Scene) -> usize {
    scene.frame().occupancy.class_counts()[Class::Car as usize]
}

fn cell(x: f64, y: f64) -> [usize; 2] {
    Extent::WINDOW.column_at(x, y).expect("inside")
}

fn parse(value: Value) -> Result<Edit, String> {
    serde_json::from_value(value).map_err(|e| e.to_string())
}
