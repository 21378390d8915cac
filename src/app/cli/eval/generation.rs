//! `eval generation`: scenes from their layout alone.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{Bar, Eval, scene, with_interval};
use crate::app::cli::generate::full_params;
use crate::app::cli::progress::Progress;
use crate::generation::job::{GenParams, Job, JobCtx, Pipeline};
use crate::generation::metrics::agreement::AgreementCount;
use crate::generation::metrics::stats::median;
use crate::generation::pipeline::OccPipeline;

impl Eval {
    /// Occupancy from the layout alone, against the layout.
    pub(super) fn generation(
        &self,
        pipeline: &mut OccPipeline,
        progress: &Progress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let (mut all, mut world_all) = (AgreementCount::default(), AgreementCount::default());
        let (mut drivable, mut vehicles, mut wall_s) = (Vec::new(), Vec::new(), Vec::new());
        let mut params = GenParams {
            keep_objects: false,
            ..self.generation.params(full_params())
        };
        for i in 0..self.frames {
            progress.at("generation", i, self.frames);
            let scene = scene(i as u64);
            world_all.add(scene.frame(), &scene.frame().occupancy);
            params.seed = self.generation.seed + i as u64;
            let job = Job {
                scene: Arc::new(scene),
                params,
            };
            let result = pipeline.run(&job, &JobCtx::detached())?;
            wall_s.push(result.report.total_s());
            all.add(job.scene.frame(), &result.occupancy);
            let mut one = AgreementCount::default();
            one.add(job.scene.frame(), &result.occupancy);
            drivable.extend(one.iou().drivable);
            vehicles.extend(one.iou().vehicles);
        }
        let found = all.iou();
        let report = json!({
            "layout_agreement": found,
            "drivable_per_frame": with_interval(&drivable),
            "vehicles_per_frame": with_interval(&vehicles),
            "layout_agreement_of_the_worlds_themselves": world_all.iou(),
            "wall_s_median": median(&wall_s),
            "steps": params.steps,
            "guidance": params.guidance,
        });
        let bars = vec![
            ("drivable agreement", found.drivable.unwrap_or(f64::NAN), 0.80),
            ("vehicle agreement", found.vehicles.unwrap_or(f64::NAN), 0.80),
        ];
        Ok((report, bars))
    }
}
