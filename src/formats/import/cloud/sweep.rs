//! The returns of a sweep without labels, for a network that finds objects in it, and what becomes of the objects.

use std::collections::BTreeSet;

use glam::DVec3;
use scene::{BoxId, Class, SceneBox, SensorRig, VoxelGrid};

use super::level::{GroundPlane, HIGHEST_MOUNT_M};
use crate::import::ImportedScene;
use crate::import::importer::{labelled, of_sensor};

/// Returns of a sweep at most: a larger cloud is a map of many.
const MOST: usize = 600_000;
/// Greatest strength of an echo of sensors that tell it as a share, and of others.
const SHARE: f32 = 1.0;
const STRONGEST: f32 = 255.0;
/// Distance beyond a box within which voxels are its own, m.
const BESIDE_M: f64 = 0.25;

/// Returns as they come.
#[derive(Default)]
pub(super) struct SweepReturns {
    returns: Vec<([f32; 3], f32)>,
    /// Where the sensor is, m; `None` if the points do not tell.
    pub(super) sensor_m: Option<DVec3>,
    /// The ground around it, if the returns show it.
    pub(super) ground: Option<GroundPlane>,
    /// The points are a map.
    pub(super) is_map: bool,
}

impl SweepReturns {
    /// Takes a return, in m in the ego frame, and the strength of its echo.
    pub(super) fn add(&mut self, at: DVec3, strength: f32) {
        if self.returns.len() <= MOST {
            self.returns.push((at.as_vec3().to_array(), strength));
        }
    }

    /// Finds the ground of returns that were lifted by hand; the sensor was at their origin if nothing else is known.
    pub(super) fn find_ground(&mut self, lift_m: f64) {
        self.ground = GroundPlane::from_points(self.returns.iter().map(|(at, _)| place(*at)));
        if lift_m > 0.0 && lift_m <= HIGHEST_MOUNT_M {
            let at = self.sensor_m.unwrap_or_default();
            self.sensor_m = Some(at + DVec3::Z * lift_m);
        }
    }

    /// All of them; `None` for maps, and if their ground is not known.
    pub(super) fn finished(self) -> Option<ImportedSweep> {
        let ground = self
            .ground
            .filter(|_| self.returns.len() <= MOST && !self.is_map)?;
        let scale = scale(self.returns.iter().map(|r| r.1));
        let above = |(at, strength): ([f32; 3], f32)| {
            let strength = if strength.is_finite() {
                strength * scale
            } else {
                0.0
            };
            let height_m = ground.above_m(place(at)) as f32;
            [at[0], at[1], height_m, strength.clamp(0.0, STRONGEST)]
        };
        let usual_m = SensorRig::default()
            .lidars
            .first()
            .map_or([0.0; 3], |lidar| lidar.translation_m);
        let seen_from = self
            .sensor_m
            .map_or(DVec3::from_array(usual_m), |at| at.with_z(ground.above_m(at)));
        Some(ImportedSweep {
            returns: self.returns.into_iter().map(above).collect(),
            sensor_m: seen_from,
            mount_m: self.sensor_m,
            ground,
        })
    }
}

fn place(at: [f32; 3]) -> DVec3 {
    DVec3::from_array(at.map(f64::from))
}

/// Factor that takes strengths of any sensor to 0 to 255: by a high quantile, as single ones are wild.
fn scale(strengths: impl Iterator<Item = f32>) -> f32 {
    let mut known: Vec<f32> = strengths.filter(|s| s.is_finite() && *s > 0.0).collect();
    known.sort_unstable_by(f32::total_cmp);
    match known.get(known.len() * 99 / 100).copied() {
        Some(high) if high <= SHARE => STRONGEST,
        Some(high) if high > STRONGEST => STRONGEST / high,
        _ => 1.0,
    }
}

/// A sweep without labels: its returns around the vehicle.
#[derive(Clone, Debug)]
pub struct ImportedSweep {
    /// x and y in the ego frame, height above the ground (m) and strength of the echo (0 to 255) of each return; 0 where the
    /// strength is unknown.
    pub returns: Vec<[f32; 4]>,
    /// Where the sensor is, in the same frame; where the default rig has it if the file does not tell.
    pub sensor_m: DVec3,
    /// The same in the ego frame, if the file tells.
    mount_m: Option<DVec3>,
    ground: GroundPlane,
}

impl ImportedScene {
    /// The scene with objects that were found in its sweep, in the frame of [`ImportedSweep::returns`]; their ids are given
    /// anew. Voxels within them get their class, and what was guessed of voxels is guessed again.
    pub fn with_objects(mut self, objects: Vec<SceneBox>) -> Self {
        let Some(sweep) = self.sweep.take() else {
            return self;
        };
        if let Some(mount_m) = sweep.mount_m {
            of_sensor(&mut self.scene, mount_m);
        }
        let mut objects: Vec<SceneBox> = objects.into_iter().filter(|b| b.problem().is_none()).collect();
        if objects.is_empty() {
            return self;
        }
        objects.iter_mut().zip(1..).for_each(|(b, id)| b.id = BoxId(id));
        let mut grid = self.scene.frame().occupancy.clone();
        for b in &objects {
            // Voxels are where the file has them.
            let ground_m = -sweep.ground.above_m(b.center_m.with_z(0.0));
            relabel(&mut grid, &lifted(b, ground_m));
        }
        let recorded = self.scene.frame().inferred.recorded.clone();
        let mut scene = labelled(&self.scene.name, grid, None);
        scene.rig = self.scene.rig.clone();
        scene.change_canvas(|canvas| {
            // Boxes stand on the ground of the scene.
            for b in &mut objects {
                let ground_m = canvas.layout.relief.height_m(b.center_m.truncate());
                b.center_m.z = ground_m + b.size_m.z / 2.0;
            }
            canvas.inferred.boxes = objects.iter().map(|b| b.id).collect::<BTreeSet<_>>();
            canvas.boxes = objects.into_iter().map(|b| (b.id, b)).collect();
            std::sync::Arc::make_mut(&mut canvas.source).boxes = canvas.boxes.clone();
            canvas.inferred.recorded = recorded;
        });
        self.scene = scene;
        self
    }
}

fn lifted(b: &SceneBox, by_m: f64) -> SceneBox {
    SceneBox {
        center_m: b.center_m + DVec3::Z * by_m,
        ..*b
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
