//! The returns of a sweep without labels, for a network that finds objects in it, and what becomes of the objects.

use std::collections::BTreeSet;

use glam::DVec3;
use scene::{BoxId, Class, SceneBox, VoxelGrid};

use super::GroundPlane;
use crate::import::ImportedScene;
use crate::import::importer::{labelled, of_sensor};

/// Returns of a sweep at most: a larger cloud is a map of many.
const MOST: usize = 600_000;
/// Greatest strength of an echo of sensors that tell it as a share.
const SHARE: f32 = 1.0;
/// Distance beyond a box within which voxels are its own, m.
const BESIDE_M: f64 = 0.25;

/// Returns as they come.
#[derive(Default)]
pub(super) struct SweepReturns {
    returns: Vec<([f32; 3], f32)>,
    /// Where the sensor is, m.
    pub(super) sensor_m: DVec3,
    /// The ground around it, if the returns show it.
    pub(super) ground: Option<GroundPlane>,
}

impl SweepReturns {
    /// Takes a return, in m in the ego frame, and the strength of its echo.
    pub(super) fn add(&mut self, at: DVec3, strength: f32) {
        if self.returns.len() <= MOST {
            self.returns.push((at.as_vec3().to_array(), strength));
        }
    }

    /// All of them; `None` if their ground is not known or they are too many for a sweep.
    pub(super) fn finished(self) -> Option<ImportedSweep> {
        let ground = self.ground.filter(|_| self.returns.len() <= MOST)?;
        let strongest = self.returns.iter().map(|r| r.1).fold(0.0, f32::max);
        let scale = if strongest <= SHARE { 255.0 } else { 1.0 };
        let above = |([x, y, z], strength): ([f32; 3], f32)| {
            let at = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let strength = if strength.is_finite() {
                strength * scale
            } else {
                0.0
            };
            [x, y, ground.above_m(at) as f32, strength.clamp(0.0, 255.0)]
        };
        Some(ImportedSweep {
            returns: self.returns.into_iter().map(above).collect(),
            sensor_m: self.sensor_m.with_z(ground.above_m(self.sensor_m)),
            mount_m: self.sensor_m,
            ground,
        })
    }
}

/// A sweep without labels: its returns around the vehicle.
#[derive(Clone, Debug)]
pub struct ImportedSweep {
    /// x and y in the ego frame, height above the ground (m) and strength of the echo (0 to 255) of each return; 0 where the
    /// strength is unknown.
    pub returns: Vec<[f32; 4]>,
    /// Where the sensor is, in the same frame.
    pub sensor_m: DVec3,
    /// The same in the ego frame.
    mount_m: DVec3,
    ground: GroundPlane,
}

impl ImportedScene {
    /// The scene with objects that were found in its sweep, in the frame of [`ImportedSweep::returns`]; their ids are given
    /// anew. Voxels within them get their class, and what was guessed of voxels is guessed again.
    pub fn with_objects(mut self, objects: Vec<SceneBox>) -> Self {
        let Some(sweep) = self.sweep.take() else {
            return self;
        };
        let mut objects: Vec<SceneBox> = objects.into_iter().filter(|b| b.problem().is_none()).collect();
        for (b, id) in objects.iter_mut().zip(1..) {
            b.id = BoxId(id);
            // The height of the ground below it.
            b.center_m.z -= sweep.ground.above_m(b.center_m.with_z(0.0));
        }
        let mut grid = self.scene.frame().occupancy.clone();
        objects.iter().for_each(|b| relabel(&mut grid, b));
        let recorded = self.scene.frame().inferred.recorded.clone();
        let mut scene = labelled(&self.scene.name, grid, None);
        scene.change_canvas(|canvas| {
            canvas.inferred.boxes = objects.iter().map(|b| b.id).collect::<BTreeSet<_>>();
            canvas.boxes = objects.into_iter().map(|b| (b.id, b)).collect();
            std::sync::Arc::make_mut(&mut canvas.source).boxes = canvas.boxes.clone();
            canvas.inferred.recorded = recorded;
        });
        of_sensor(&mut scene, sweep.mount_m);
        self.scene = scene;
        self
    }
}

/// Gives the voxels of an object its class.
fn relabel(grid: &mut VoxelGrid, b: &SceneBox) {
    let extent = grid.extent();
    let grown = SceneBox {
        size_m: b.size_m + DVec3::new(2.0 * BESIDE_M, 2.0 * BESIDE_M, 0.0),
        ..*b
    };
    let [bottom_m, top_m] = [-1.0, 1.0].map(|side| b.center_m.z + side * b.size_m.z / 2.0);
    for (x, y, _) in scene::draft::box_columns(extent, &grown) {
        for z in 0..extent.nz() {
            let height_m = extent.center(x, y, z).z;
            let label = grid.get(x, y, z);
            let stands = Class::from_id(label).is_some_and(|c| c != Class::Free && !c.is_ground());
            if stands && (bottom_m..=top_m + BESIDE_M).contains(&height_m) {
                grid.set(x, y, z, b.class.id());
            }
        }
    }
}
