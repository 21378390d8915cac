//! Sampling: from noise to data with few network calls. One file per method; states are f64, a network
//! may compute in f32 behind [`Denoiser`].

mod ddim;
mod guidance;
pub mod multistep;
mod sampler;
#[cfg(test)]
pub(crate) mod tests;

use thiserror::Error;

pub use ddim::{DdimStep, clean_estimate};
pub use guidance::Guidance;
pub use guidance::standard_deviation;
pub use multistep::{SolverKind, Stepper};
pub use sampler::{Sampler, StepView};

use super::schedule::ScheduleError;

/// Meaning of a network's output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Prediction {
    /// The noise in the state.
    Epsilon,
    /// `alpha * noise - sigma * data`; finite everywhere, the choice with zero terminal SNR.
    V,
}

/// Branch of a prediction, with or without the condition (layout, text) of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Branch {
    /// The condition is shown.
    Conditional,
    /// The condition is dropped, as in training with condition dropout.
    Unconditional,
}

/// A network as a solver sees it.
pub trait Denoiser {
    /// Error of the network; solvers add their own errors to it.
    type Error: From<SolverError>;

    /// The prediction for state `x` at training step `t`, as long as `x`. Must be deterministic:
    /// inversion relies on the same input giving the same output.
    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, Self::Error>;
}

/// Error of a solver.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SolverError {
    /// See [`ScheduleError`].
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// A network's output, a stored state or a mask of the wrong size.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A trajectory inverted with another number or spacing of steps.
    #[error("the trajectory was made for other noise levels than the sampler's")]
    OtherLevels,
    /// NaN or infinity in a state.
    #[error("state after step {step} of {steps} is not finite")]
    NotFinite {
        /// The step, counted from 1.
        step: usize,
        /// All steps.
        steps: usize,
    },
}

/// Fails unless `found` is `expected`.
pub fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), SolverError> {
    if found == expected {
        return Ok(());
    }
    Err(SolverError::Length {
        what,
        found,
        expected,
    })
}
/// Fails if a value of the state is NaN or infinite after step `step` of `steps`.
pub fn check_finite(state: &[f64], step: usize, steps: usize) -> Result<(), SolverError> {
    if state.iter().all(|v| v.is_finite()) {
        return Ok(());
    }
    Err(SolverError::NotFinite { step, steps })
}
