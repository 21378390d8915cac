//! The generation that window and command line run: its networks, its parameters, and how it gets ready while nobody
//! waits.

use std::path::Path;
use std::sync::Arc;

use job::pipeline::OccPipeline;
use job::redraw;
use job::{GenError, GenParams, GenReport, GenResult, Job, JobCtx, Named, Pipeline, RegionMode};
use nets::OccModels;

/// Parameters of a generation from the layout alone.
pub fn full_params() -> GenParams {
    GenParams {
        region: RegionMode::Full,
        steps: 20,
        guidance: 1.5,
        named: Named {
            completeness: Some(1.0),
            ..Named::default()
        },
        ..GenParams::default()
    }
}

/// The networks of `--weights`, or the bundled ones.
pub fn models(weights: Option<&Path>) -> anyhow::Result<Arc<OccModels>> {
    Ok(match weights {
        Some(dir) => OccModels::from_dir(dir)?,
        None => OccModels::bundled()?,
    })
}

/// [`OccPipeline`], where a job that edits nothing reads the networks and inverts the frame's source,
/// so that the first edit finds both ready.
pub struct WarmPipeline(OccPipeline);

impl WarmPipeline {
    /// With the weights that ship with the program.
    pub fn bundled() -> Result<Self, GenError> {
        OccPipeline::bundled().map(Self)
    }
}

impl Pipeline for WarmPipeline {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let frame = job.scene.frame();
        let nothing_edited =
            job.params.region == RegionMode::Auto && redraw::region_of(frame, &job.params).is_empty();
        if !nothing_edited {
            return self.0.run(job, ctx);
        }
        let network_calls = self.0.prepare(job, ctx)?;
        Ok(GenResult {
            key: job.key(),
            frame: job.scene.current,
            occupancy: frame.occupancy.clone(),
            report: GenReport {
                network_calls,
                inversion_calls: network_calls,
                ..GenReport::default()
            },
        })
    }
}
