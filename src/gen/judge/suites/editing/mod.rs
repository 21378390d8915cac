//! `eval editing`: do edits do what they say, and nothing else? Tried on complete worlds, on simulated labels and on
//! any folder of Occ3D frames.

mod fidelity;
mod fit;
mod fresh;
mod invention;
mod materials;
mod success;
mod tally;
mod trial_run;

use anyhow::bail;
use serde_json::json;

use crate::suite::{Options, SuiteFigures};
use authoring::open;
use calibration::MeasurementProgress;
use calibration::trials::Trial;
use editor::Document;
use job::pipeline::OccPipeline;
use job::{GenParams, GenReport, Job, JobCtx, Pipeline};
use materials::TrialScenes;
use scene::{Scene, VoxelGrid};

impl Options {
    /// Runs all parts on procedural worlds; on a folder of frames, only counts what edits invent.
    pub(crate) fn editing(
        &self,
        pipeline: &mut OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        if self.vehicles == 0 {
            bail!("--vehicles is 0, expected at least 1");
        }
        let presets = self.presets()?;
        if let Some(dir) = &self.data {
            let mut files = open::files_below(dir, "npz", "Occ3D frames")?;
            files.truncate(self.frames);
            let material = TrialScenes::Files(files);
            let found = self.invention(&material, &presets, pipeline, progress)?;
            let report =
                json!({ "data": dir, "files": material.count(), "invented": { "frames": found.report } });
            return Ok((report, Vec::new()));
        }
        let (mut report, mut bars) = self.success(pipeline, progress)?;
        for material in [
            TrialScenes::Complete(self.frames),
            TrialScenes::Labels(self.frames),
        ] {
            let found = self.invention(&material, &presets, pipeline, progress)?;
            report["invented"][material.name()] = found.report;
            let name = match material {
                TrialScenes::Complete(_) => "removals that invent little, complete worlds",
                _ => "removals that invent little, simulated labels",
            };
            bars.extend(found.removals_clear.map(|share| (name, share, 0.95)));
        }
        Ok((report, bars))
    }
}

/// Applies one edit and regenerates. Returns the occupancy after it, and the report.
pub(super) fn edited(
    pipeline: &mut OccPipeline,
    scene: &Scene,
    trial: &Trial,
    params: GenParams,
) -> anyhow::Result<(VoxelGrid, GenReport)> {
    let mut document = Document::new(scene.clone());
    document.apply("Edit", &trial.edit)?;
    let job = Job {
        scene: document.scene().clone(),
        params,
    };
    let result = pipeline.run(&job, &JobCtx::detached())?;
    Ok((result.occupancy, result.report))
}
