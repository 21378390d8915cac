//! O-BELM inversion: exact up to rounding. Wang et al. 2024, arXiv 2410.07273.
//!
//! The noise of a latent is a pair here, the two noisiest states: sampling from both gives the latent
//! back. Every step towards noise multiplies rounding errors by up to 1 / r^2, so states are f64, levels
//! are even in the training step, and fewer than ten steps or guidance above 1 are for the moments check
//! to judge.

use super::{InversionReport, Trajectory};
use crate::solver::multistep::{ObelmStep, noise};
use crate::solver::{DdimStep, Denoiser, Sampler, SolverError, check_finite};

/// Inverts `clean`. One network call per step.
pub(super) fn invert<D: Denoiser + ?Sized>(
    sampler: &Sampler,
    clean: &[f64],
    model: &mut D,
    mut on_step: impl FnMut(usize, usize) -> Result<(), D::Error>,
) -> Result<(Trajectory, InversionReport), D::Error> {
    let (levels, steps) = (&sampler.levels, sampler.steps());
    check_finite(clean, 0, steps)?;
    let mut states = vec![clean.to_vec()]; // data first, turned round at the end
    for k in (0..steps).rev() {
        let done = states.len();
        let state = if k + 1 == steps {
            // The first step is a plain inverse one, made at the clean end (networks know no t below 0).
            let predicted = sampler.guidance.predict(model, clean, levels[steps].t.max(0.0))?;
            let up =
                DdimStep::new(sampler.prediction, &levels[steps], &levels[k]).map_err(SolverError::from)?;
            up.apply_all(clean, &predicted)
        } else {
            let (x, next) = (&states[done - 1], &states[done - 2]);
            let level = &levels[k + 1];
            let predicted = sampler.guidance.predict(model, x, level.t)?;
            let step = ObelmStep::new([&levels[k], level, &levels[k + 2]]).map_err(SolverError::from)?;
            let values = next.iter().zip(x).zip(&predicted);
            values
                .map(|((next, x), p)| step.backward(*next, *x, noise(sampler.prediction, level, *x, *p)))
                .collect()
        };
        check_finite(&state, done, steps)?;
        on_step(done, steps)?;
        states.push(state);
    }
    states.reverse();
    let report = InversionReport {
        calls: steps * sampler.guidance.calls(),
        residual_rms: Vec::new(),
        fallback_steps: 0,
        ..InversionReport::of_noise(&states[0])
    };
    let levels = levels.clone();
    Ok((Trajectory { levels, states }, report))
}
