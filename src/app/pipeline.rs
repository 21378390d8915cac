//! The generation that the window runs: the bundled networks, warmed up while nobody waits.

use job::inpaint;
use job::pipeline::OccPipeline;
use job::{GenError, GenReport, GenResult, Job, JobCtx, Pipeline, RegionMode};

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
        let scene = job.scene.for_generation();
        let frame = scene.frame();
        let nothing_edited =
            job.params.region == RegionMode::Auto && inpaint::region_of(frame, &job.params).is_empty();
        if !nothing_edited {
            return self.0.run(job, ctx);
        }
        let network_calls = self.0.prepare(job, ctx)?;
        Ok(GenResult {
            key: job.key(),
            occupancy: frame.occupancy.clone(),
            report: GenReport {
                network_calls,
                inversion_calls: network_calls,
                ..GenReport::default()
            },
        })
    }
}
