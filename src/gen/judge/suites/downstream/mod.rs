//! `eval downstream`: are generated scenes like worlds to a network that learned from worlds? The shipped network of
//! the LiDAR looks at sweeps of held-out worlds and of scenes generated from their layouts, both as the window shows
//! them, where boxes keep the voxels that they need, and as the networks give them. A loss there shows what generation
//! gets wrong where a LiDAR looks. The network that tells voxels from LiDAR and cameras looks at the same scenes, and
//! at the worlds in other light and weather. `training/downstream.py` measures what generated scenes are worth as
//! training data.

mod voxels;

use std::sync::Arc;

use serde_json::{Value, json};

use crate::suite::{Options, SuiteFigures, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::scene;
use editor::Document;
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx, Pipeline};
use scene::{Class, Scene};
use sensors::perceive::sweep::report;
use voxels::VoxelFigures;

/// Figures of the LiDAR network on scenes, a value per scene.
#[derive(Default)]
struct DetectionFigures {
    cars: Vec<f64>,
    others: Vec<f64>,
    ghosts: Vec<f64>,
    right: Vec<f64>,
}

impl DetectionFigures {
    fn add(&mut self, scene: &Scene) -> anyhow::Result<()> {
        let report = report(scene)?;
        let boxes = &scene.frame().boxes;
        let share = |is_car: bool| {
            let asked = report.boxes.iter();
            let asked = asked.filter(|b| (boxes.get(&b.id).map(|b| b.class) == Some(Class::Car)) == is_car);
            let found: Vec<bool> = asked.map(|b| !b.is_missed()).collect();
            let seen = found.iter().filter(|f| **f).count();
            // A scene without boxes to find has missed none.
            if found.is_empty() {
                1.0
            } else {
                seen as f64 / found.len() as f64
            }
        };
        self.cars.push(share(true));
        self.others.push(share(false));
        let ghosts = report.detections.iter().filter(|d| d.of.is_none()).count();
        self.ghosts.push(ghosts as f64);
        self.right.push(report.right);
        Ok(())
    }

    fn named(&self) -> [(&'static str, &[f64]); 4] {
        [
            ("cars_found", &self.cars),
            ("other_boxes_found", &self.others),
            ("ghosts_per_scene", &self.ghosts),
            ("columns_right", &self.right),
        ]
    }

    fn report(&self) -> Value {
        let pairs = self.named();
        pairs
            .into_iter()
            .map(|(name, values)| (name.to_owned(), with_interval(values)))
            .collect()
    }

    /// Difference from `other`, scene by scene.
    fn more_than(&self, other: &Self) -> Value {
        let pairs = self.named().into_iter().zip(other.named());
        let more = pairs.map(|((name, a), (_, b))| {
            let each: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            (name.to_owned(), with_interval(&each))
        });
        more.collect()
    }
}

impl Options {
    /// The shipped networks of the LiDAR, and of LiDAR and cameras, on held-out worlds and on scenes from their layouts.
    pub(crate) fn downstream(
        &self,
        pipeline: &mut OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        let mut worlds = DetectionFigures::default();
        let mut voxels = VoxelFigures::default();
        let mut made = [true, false].map(|keeps_objects| (keeps_objects, DetectionFigures::default()));
        for i in 0..self.frames {
            progress.at("downstream", i, self.frames);
            let world = scene(i as u64);
            worlds.add(&world)?;
            let world = Arc::new(world);
            for (keep_objects, seen) in &mut made {
                let job = Job {
                    scene: world.clone(),
                    params: GenParams {
                        keep_objects: *keep_objects,
                        seed: self.scene_params.seed.wrapping_add(i as u64),
                        ..self.scene_params.clone()
                    },
                };
                let result = pipeline.run(&job, &JobCtx::detached())?;
                let mut document = Document::new(Scene::clone(&world));
                document.adopt(result.rev(), result.occupancy.clone())?;
                seen.add(document.scene())?;
                if *keep_objects {
                    voxels.add(&world, document.scene())?;
                }
            }
        }
        let [shown, own] = made.map(|(_, seen)| seen);
        let report = json!({
            "worlds": worlds.report(),
            "generated": shown.report(),
            "generated_more_than_worlds": shown.more_than(&worlds),
            "own_output": own.report(),
            "own_output_more_than_worlds": own.more_than(&worlds),
            "voxels": voxels.report(),
        });
        Ok((report, Vec::new()))
    }
}
