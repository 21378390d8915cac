//! Agreement with the layout over frames.

use serde_json::{Value, json};

use crate::suite::{Bar, with_interval};
use metrics::agreement::AgreementCount;
use scene::{Scene, VoxelGrid};

/// Counts of columns, of all frames together and frame by frame.
#[derive(Default)]
pub struct Agreement {
    all: AgreementCount,
    drivable: Vec<f64>,
    vehicles: Vec<f64>,
}

impl Agreement {
    /// Counts occupancy made for the layout of a scene.
    pub fn add(&mut self, scene: &Scene, occupancy: &VoxelGrid) {
        self.all.add(scene.frame(), occupancy);
        let mut one = AgreementCount::default();
        one.add(scene.frame(), occupancy);
        self.drivable.extend(one.iou().drivable);
        self.vehicles.extend(one.iou().vehicles);
    }

    pub fn report(&self) -> Value {
        json!({
            "columns": self.all.iou(),
            "drivable_per_frame": with_interval(&self.drivable),
            "vehicles_per_frame": with_interval(&self.vehicles),
        })
    }

    pub fn bars(&self) -> Vec<Bar> {
        let iou = self.all.iou();
        vec![
            ("drivable agreement", iou.drivable.unwrap_or(f64::NAN), 0.985),
            ("vehicle agreement", iou.vehicles.unwrap_or(f64::NAN), 0.975),
        ]
    }
}
