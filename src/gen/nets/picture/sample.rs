//! Sampling of latents from noise in a few steps, and again for some of their cells.

use std::ops::ControlFlow;

use super::{EncodedCondition, PictureDit, WarpedLatents};
use crate::ModelError;
use diffusion::inversion::Trajectory;
use diffusion::replay;
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverKind, StepView};
use nn::Ops;
use nn::map::FeatureMap;

/// Input of a run of the sampler. `T` is the backend's tensor.
pub struct PictureSampling<'a, T = FeatureMap> {
    /// Condition of the pictures.
    pub told: &'a EncodedCondition<T>,
    /// Condition without classes, depths and facings, made by [`PictureDit::silent`]. Needed by guidance other than 1;
    /// made where it is needed and not given.
    pub silent: Option<&'a EncodedCondition<T>>,
    /// The frame before, if there is one.
    pub before: Option<&'a WarpedLatents>,
    /// Steps, 1 to 1000.
    pub steps: usize,
    /// Guidance: how far to go from the prediction for `silent` to that for `told`. 1 takes that for `told`, 2 was
    /// measured best.
    pub guidance: f64,
}

impl<T> PictureSampling<'_, T> {
    fn sampler(&self) -> Result<Sampler, ModelError> {
        let guidance = Guidance {
            weight: self.guidance,
            rescale: 0.0,
        };
        Ok(Sampler::standard(SolverKind::Ddim, self.steps, guidance)?)
    }
}

/// The network as the solver sees it.
struct PictureDenoiser<'a, B: Ops> {
    dit: &'a PictureDit<B>,
    told: &'a EncodedCondition<B::Tensor>,
    silent: Option<&'a EncodedCondition<B::Tensor>>,
    before: Option<&'a WarpedLatents>,
}

impl<B: Ops> Denoiser for PictureDenoiser<'_, B> {
    type Error = ModelError;

    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, ModelError> {
        let x: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let (told, before) = match (branch, self.silent) {
            (Branch::Unconditional, Some(silent)) => (silent, None),
            _ => (self.told, self.before),
        };
        let v = self.dit.v(&x, t as f32, told, before)?;
        Ok(v.into_iter().map(f64::from).collect())
    }
}

impl<B: Ops> PictureDit<B> {
    /// Samples latents from noise `[view][row][column][8]` of unit spread, in the same shape: DDIM without fresh noise,
    /// trailing steps. The last state holds the latents. `on_step` runs after each step and may stop the run, which
    /// then ends with [`ModelError::Stopped`]. Errors also if sizes do not fit, a number is not finite, or there are no
    /// steps or too many.
    pub fn sample(
        &self,
        noise: &[f32],
        sampling: &PictureSampling<'_, B::Tensor>,
        mut on_step: impl FnMut(StepView<'_>) -> ControlFlow<()>,
    ) -> Result<Trajectory, ModelError> {
        let sampler = sampling.sampler()?;
        let start = noise.iter().map(|v| f64::from(*v)).collect();
        let states = self.asked(sampling, |asked| {
            sampler.sample(start, asked, |view| go_on(view, &mut on_step))
        })?;
        Ok(Trajectory {
            levels: sampler.levels,
            states,
        })
    }

    /// Samples the cells of a mask `[view][row][column]` again, under the present condition; the others stay as they
    /// were at every step of `source`, to the bit. Otherwise as [`sample`](Self::sample); errors also if the steps of
    /// `source` are others.
    pub fn resample(
        &self,
        source: &Trajectory,
        mask: &[bool],
        sampling: &PictureSampling<'_, B::Tensor>,
        mut on_step: impl FnMut(StepView<'_>) -> ControlFlow<()>,
    ) -> Result<Trajectory, ModelError> {
        let (sampler, latent) = (sampling.sampler()?, self.config().latent);
        let edited = self.asked(sampling, |asked| {
            replay::edit_with_replay(&sampler, source, mask, latent, asked, |view| {
                go_on(view, &mut on_step)
            })
        })?;
        Ok(edited.trajectory)
    }

    /// Gives the network as the solver sees it to `run`.
    fn asked<R>(
        &self,
        sampling: &PictureSampling<'_, B::Tensor>,
        run: impl FnOnce(&mut PictureDenoiser<'_, B>) -> Result<R, ModelError>,
    ) -> Result<R, ModelError> {
        let made = match sampling.silent {
            None if sampling.guidance != 1.0 => Some(self.silent(sampling.told)?),
            _ => None,
        };
        run(&mut PictureDenoiser {
            dit: self,
            told: sampling.told,
            silent: sampling.silent.or(made.as_ref()),
            before: sampling.before,
        })
    }
}

/// Ends a run that its watcher stops, unless it is at its end.
fn go_on(
    view: StepView<'_>,
    on_step: &mut impl FnMut(StepView<'_>) -> ControlFlow<()>,
) -> Result<(), ModelError> {
    let (step, steps) = (view.step, view.steps);
    match on_step(view) {
        ControlFlow::Break(()) if step < steps => Err(ModelError::Stopped { step, steps }),
        _ => Ok(()),
    }
}
