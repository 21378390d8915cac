//! Measures how well a source is restored when it is inverted and sampled again.

use super::OccPipeline;
use crate::contract::{ChosenDensities, GenError, GenParams, GenReport, Job, JobCtx, Stage};
use crate::region::Region;
use diffusion::inversion::{Refinement, invert, round_trip_error};
use diffusion::solver::{Guidance, Sampler};
use nets::DecoderInput;
use nn::Ops;
use scene::{Scene, Unobserved, VoxelGrid};

/// Result of inverting and sampling again.
#[derive(Clone, Copy, Debug)]
pub struct RoundTrip {
    /// Relative RMS error of the latent.
    pub error: f64,
    /// Standard deviation of the noise in between.
    pub noise_std: f64,
}

impl<B: Ops + Clone> OccPipeline<B> {
    /// The occupancy of a scene's frame, encoded and decoded by the VAE; the decoder gets the frame's draft and masks.
    pub fn reconstruct(&mut self, scene: &Scene) -> Result<VoxelGrid, GenError> {
        let frame = scene.frame();
        let condition = self.condition(scene, &frame.layout, &frame.boxes, ChosenDensities::default());
        let observed = frame.inferred.unobserved.as_ref().map(Unobserved::observed);
        let input = DecoderInput {
            observed: observed.as_deref(),
            ..condition.decoder_input()
        };
        let vae = &self.models.vae;
        vae.encode(&frame.occupancy)
            .and_then(|latent| vae.decode_with(&latent, &Region::full().latent_cells, input))
            .map_err(GenError::failed)
    }

    /// Inverts the source of the job's frame and samples it again, with the solver that edits of it use. Returns the
    /// relative RMS error.
    pub fn round_trip(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<f64, GenError> {
        let condition = self.condition_of_source(&job.scene);
        let known = self.source(
            &job.scene,
            &condition,
            &job.params,
            &mut GenReport::default(),
            ctx,
        )?;
        let mut network = self.network_of_source(&condition, &job.params)?;
        let sampler = Sampler::standard(known.solver, job.params.steps as usize, Guidance::NONE)?;
        round_trip_error(&sampler, &known.trajectory, &mut network, |k, n| {
            ctx.progress(Stage::Denoise, k, n)
        })
    }

    /// Inverts a source and samples it again with exactly the given solver, where an edit would fall back to another;
    /// keeps nothing in memory.
    pub fn round_trip_of(
        &mut self,
        scene: &Scene,
        params: &GenParams,
        ctx: &JobCtx<'_>,
    ) -> Result<RoundTrip, GenError> {
        let latent = self.models.vae.encode(&scene.frame().source.occupancy);
        let clean: Vec<f64> = latent
            .map_err(GenError::failed)?
            .into_iter()
            .map(f64::from)
            .collect();
        let condition = self.condition_of_source(scene);
        let mut network = self.network_of_source(&condition, params)?;
        let sampler = Sampler::standard(params.solver, params.steps as usize, Guidance::NONE)?;
        let refinement = Refinement::damped(params.inversion_iterations as usize);
        let (trajectory, inversion) = invert(&sampler, &clean, refinement, &mut network, |k, n| {
            ctx.progress(Stage::Invert, k, n)
        })?;
        let error = round_trip_error(&sampler, &trajectory, &mut network, |k, n| {
            ctx.progress(Stage::Denoise, k, n)
        })?;
        Ok(RoundTrip {
            error,
            noise_std: inversion.std,
        })
    }
}
