//! Solver: the step from a prediction to the next state.

use diffusion::solver::{DdimStep, SolverKind, Stepper};

use super::SamplingPlan;
use crate::StableError;
use crate::config::SchedulerKind;

/// Runs through a plan and keeps what the method needs of earlier steps. States are in 64 bits.
pub(crate) struct Solver<'a> {
    plan: &'a SamplingPlan,
    memory: SolverHistory<'a>,
}

enum SolverHistory<'a> {
    /// DDIM and Euler need no memory.
    None,
    /// PNDM: predictions of up to four steps, oldest first, and the state before the first step.
    Past { said: Vec<Vec<f64>>, start: Vec<f64> },
    /// DPM-Solver++ and UniPC.
    Stepper(Stepper<'a>),
}

/// Weights by which PNDM combines predictions, newest first: Adams-Bashforth of first to fourth order (Liu et al. 2022,
/// arXiv 2202.09778).
const WEIGHTS: [&[f64]; 4] = [
    &[1.0],
    &[1.5, -0.5],
    &[23.0 / 12.0, -16.0 / 12.0, 5.0 / 12.0],
    &[55.0 / 24.0, -59.0 / 24.0, 37.0 / 24.0, -9.0 / 24.0],
];

impl<'a> Solver<'a> {
    /// A solver at the first call of a plan.
    pub fn new(plan: &'a SamplingPlan) -> Self {
        let stepper = |kind| SolverHistory::Stepper(Stepper::new(kind, plan.prediction, &plan.levels));
        let memory = match plan.kind {
            SchedulerKind::Ddim | SchedulerKind::Euler => SolverHistory::None,
            SchedulerKind::Pndm => SolverHistory::Past {
                said: Vec::new(),
                start: Vec::new(),
            },
            SchedulerKind::DpmPp => stepper(SolverKind::DpmPp2M),
            SchedulerKind::UniPc => stepper(SolverKind::UniPc),
        };
        Self { plan, memory }
    }

    /// The state after call `k`. Calls must come in order. Errors if a prediction of noise would have to leave pure
    /// noise.
    pub fn advance(&mut self, k: usize, x: &[f64], predicted: &[f64]) -> Result<Vec<f64>, StableError> {
        let call = &self.plan.calls[k];
        let step = || DdimStep::new(self.plan.prediction, &call.from, &call.to);
        match &mut self.memory {
            SolverHistory::None => Ok(step()?.apply_all(x, predicted)),
            SolverHistory::Stepper(stepper) => Ok(stepper.advance(k, x, predicted)?),
            SolverHistory::Past { said, start } if k == 1 => {
                let first = said.first().map_or(predicted, |s| s.as_slice());
                let mean: Vec<f64> = first.iter().zip(predicted).map(|(a, b)| 0.5 * (a + b)).collect();
                Ok(step()?.apply_all(start, &mean))
            }
            SolverHistory::Past { said, start } => {
                if k == 0 {
                    *start = x.to_vec();
                }
                if said.len() == WEIGHTS.len() {
                    said.remove(0);
                }
                said.push(predicted.to_vec());
                let weights = WEIGHTS[said.len() - 1];
                let mut joined = vec![0.0; x.len()];
                for (said, weight) in said.iter().rev().zip(weights) {
                    joined.iter_mut().zip(said).for_each(|(j, s)| *j += weight * s);
                }
                Ok(step()?.apply_all(x, &joined))
            }
        }
    }
}
