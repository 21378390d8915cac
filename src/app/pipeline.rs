//! The generation pipeline of the window: the bundled networks, warmed up in idle time.

use job::pipeline::{OccPipeline, is_idle};
use job::{GenError, GenReport, GenResult, Job, JobCtx, Pipeline};

/// [`OccPipeline`] with a warm-up: a job that edits nothing reads the networks and inverts the frame's source, so that
/// the first edit finds both ready.
pub struct WarmPipeline(OccPipeline);

impl WarmPipeline {
    /// The pipeline with the bundled weights.
    pub fn bundled() -> Result<Self, GenError> {
        OccPipeline::bundled().map(Self)
    }
}

impl Pipeline for WarmPipeline {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        if !is_idle(job) {
            return self.0.run(job, ctx);
        }
        let scene = job.scene.for_generation();
        let network_calls = self.0.prepare(job, ctx)?;
        Ok(GenResult {
            key: job.key(),
            occupancy: scene.frame().occupancy.clone(),
            report: GenReport {
                network_calls,
                inversion_calls: network_calls,
                ..GenReport::default()
            },
        })
    }
}
