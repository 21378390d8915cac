//! From noise to latents in a few steps.

use std::ops::ControlFlow;

use super::{Before, PictureDit, Told};
use crate::ModelError;
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverKind, StepView};
use nn::Ops;
use nn::map::Map;

/// What a run of the sampler needs. `T` is the backend's tensor.
pub struct Sampling<'a, T = Map> {
    /// What the pictures shall show.
    pub told: &'a Told<T>,
    /// What [`PictureDit::silent`] made of it. Needed by guidance other than 1; made where it is needed and not given.
    pub silent: Option<&'a Told<T>>,
    /// The frame before, if there is one.
    pub before: Option<&'a Before>,
    /// Steps, 1 to 1000.
    pub steps: usize,
    /// How far to go from the silent answer to the told one: 1 takes the told one, 2 was measured best.
    pub guidance: f64,
}

/// The network as the solver sees it.
struct Asked<'a, B: Ops> {
    dit: &'a PictureDit<B>,
    told: &'a Told<B::Tensor>,
    silent: Option<&'a Told<B::Tensor>>,
    before: Option<&'a Before>,
}

impl<B: Ops> Denoiser for Asked<'_, B> {
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
    /// From noise `[view][row][column][8]` of unit spread to latents of the same shape: DDIM without fresh noise, trailing steps.
    /// `on_step` runs after each step and may stop the run, which then ends with [`ModelError::Stopped`]. Errors also if sizes do
    /// not fit, a number is not finite, or there are no steps or too many.
    pub fn sample(
        &self,
        noise: &[f32],
        sampling: &Sampling<'_, B::Tensor>,
        mut on_step: impl FnMut(StepView<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<f32>, ModelError> {
        let guidance = Guidance {
            weight: sampling.guidance,
            rescale: 0.0,
        };
        let sampler =
            Sampler::standard(SolverKind::Ddim, sampling.steps, guidance).map_err(ModelError::Schedule)?;
        let made = match sampling.silent {
            None if sampling.guidance != 1.0 => Some(self.silent(sampling.told)?),
            _ => None,
        };
        let mut asked = Asked {
            dit: self,
            told: sampling.told,
            silent: sampling.silent.or(made.as_ref()),
            before: sampling.before,
        };
        let start = noise.iter().map(|v| f64::from(*v)).collect();
        let mut states = sampler.sample(start, &mut asked, |view| {
            let (step, steps) = (view.step, view.steps);
            match on_step(view) {
                ControlFlow::Break(()) if step < steps => Err(ModelError::Stopped { step, steps }),
                _ => Ok(()),
            }
        })?;
        let last = states.pop().unwrap_or_default();
        Ok(last.into_iter().map(|v| v as f32).collect())
    }
}
