//! A sampler: all of sampling but the network.

use super::{DdimStep, Denoiser, Guidance, Prediction, SolverKind, Stepper, check_finite, clean_estimate};
use crate::schedule::{NoiseLevel, Schedule, ScheduleError, Spacing};

/// Training steps that O-BELM uses: above, the signal (6 % here) is too weak to divide by.
const OBELM_TRAIN_STEPS: usize = 960;

/// State of a solver after each of its network calls.
#[derive(Clone, Copy, Debug)]
pub struct StepView<'a> {
    /// Steps done, from 1.
    pub step: usize,
    /// All steps.
    pub steps: usize,
    /// State that the prediction was made for.
    pub x: &'a [f64],
    /// The prediction.
    pub predicted: &'a [f64],
    /// Level of `x` as the network was told.
    pub level: NoiseLevel,
    /// State after the step.
    pub next: &'a [f64],
    prediction: Prediction,
}

impl<'a> StepView<'a> {
    /// A step that has just been done.
    pub fn new(
        (step, steps): (usize, usize),
        prediction: Prediction,
        level: NoiseLevel,
        (x, predicted, next): (&'a [f64], &'a [f64], &'a [f64]),
    ) -> Self {
        Self {
            step,
            steps,
            x,
            predicted,
            level,
            next,
            prediction,
        }
    }

    /// The clean data that this step's prediction implies, for previews.
    pub fn clean_estimate(&self) -> Vec<f64> {
        let pairs = self.x.iter().zip(self.predicted);
        pairs
            .map(|(x, p)| clean_estimate(self.prediction, &self.level, *x, *p))
            .collect()
    }
}

/// Settings of a sampler, without the network: method, levels from noise to data, what the network predicts, guidance.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampler {
    /// Method by which a prediction becomes the next state.
    pub solver: SolverKind,
    /// `steps + 1` levels, from noise to clean data.
    pub levels: Vec<NoiseLevel>,
    /// Meaning of the network's output.
    pub prediction: Prediction,
    /// How its two branches are combined.
    pub guidance: Guidance,
}

impl Sampler {
    /// The sampler for this project's networks: the standard schedule, trailing steps, v prediction. O-BELM, which
    /// divides by the signal, starts a little below pure noise.
    pub fn standard(solver: SolverKind, steps: usize, guidance: Guidance) -> Result<Self, ScheduleError> {
        let schedule = Schedule::standard();
        let levels = if solver == SolverKind::OBelm {
            schedule.levels_below(OBELM_TRAIN_STEPS, steps)?
        } else {
            schedule.levels(steps, Spacing::Trailing)?
        };
        Ok(Self {
            solver,
            levels,
            prediction: Prediction::V,
            guidance,
        })
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    /// The DDIM step from level `k` to level `k + 1`.
    pub fn step(&self, k: usize) -> Result<DdimStep, ScheduleError> {
        DdimStep::new(self.prediction, &self.levels[k], &self.levels[k + 1])
    }

    /// The solver at its first level.
    pub fn stepper(&self) -> Stepper<'_> {
        Stepper::new(self.solver, self.prediction, &self.levels)
    }

    /// Number of states that make up the noise of an inverted latent: O-BELM needs the two noisiest.
    pub fn states_of_noise(&self) -> usize {
        if self.solver == SolverKind::OBelm { 2 } else { 1 }
    }

    /// Samples from the noise `start` to data; returns all `steps + 1` states. `on_step` runs after each step and may
    /// end the run with an error (a newer job waits).
    pub fn sample<D: Denoiser + ?Sized>(
        &self,
        start: Vec<f64>,
        model: &mut D,
        on_step: impl FnMut(StepView<'_>) -> Result<(), D::Error>,
    ) -> Result<Vec<Vec<f64>>, D::Error> {
        self.sample_from(vec![start], model, on_step)
    }

    /// Samples as [`Self::sample`] does, from the first one or two states.
    pub fn sample_from<D: Denoiser + ?Sized>(
        &self,
        given: Vec<Vec<f64>>,
        model: &mut D,
        mut on_step: impl FnMut(StepView<'_>) -> Result<(), D::Error>,
    ) -> Result<Vec<Vec<f64>>, D::Error> {
        let steps = self.steps();
        let mut states = given;
        let mut stepper = self.stepper();
        states[..states.len() - 1].iter().for_each(|x| stepper.pass(x));
        for k in states.len() - 1..steps {
            let x = &states[k];
            let level = self.levels[k];
            let predicted = self.guidance.predict(model, x, level.t)?;
            let next = stepper.advance(k, x, &predicted)?;
            check_finite(&next, k + 1, steps)?;
            on_step(StepView::new(
                (k + 1, steps),
                self.prediction,
                level,
                (x, &predicted, &next),
            ))?;
            states.push(next);
        }
        Ok(states)
    }
}
