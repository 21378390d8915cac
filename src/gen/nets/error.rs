//! Errors of the networks.

use diffusion::schedule::ScheduleError;
use diffusion::solver::SolverError;
use nn::ops::OpsError;
use thiserror::Error;

/// Error of a network: an input that it refuses, or a result that it cannot guarantee.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ModelError {
    /// An input of the wrong size.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Which input.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// NaN, infinity, or so large that the network would overflow.
    #[error("{what}: value {index} is {value}, expected finite numbers below 1e30")]
    NotFinite {
        /// Which input or output.
        what: &'static str,
        /// Index of the first such value.
        index: usize,
        /// That value.
        value: f32,
    },
    /// A label that is no class.
    #[error("voxel ({x}, {y}, {z}) has label {found}, expected 0 to 17")]
    Label {
        /// Index of the voxel.
        x: usize,
        /// Index of the voxel.
        y: usize,
        /// Index of the voxel.
        z: usize,
        /// The label.
        found: u8,
    },
    /// The backend could not compute.
    #[error(transparent)]
    Backend(#[from] OpsError),
    /// A size, an id or an index that the network does not know.
    #[error("{what} is {found}, expected {expected}")]
    OutOfRange {
        /// Which input.
        what: &'static str,
        /// The given value.
        found: usize,
        /// The values allowed.
        expected: &'static str,
    },
    /// A number of steps that the schedule does not have.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The solver refuses a state.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The watcher of a run stopped it. Not an error to show.
    #[error("stopped after step {step} of {steps}")]
    Stopped {
        /// Steps done, from 1.
        step: usize,
        /// All steps.
        steps: usize,
    },
    /// A time outside the schedule.
    #[error("timestep is {0}, expected 0 to 999")]
    Timestep(f32),
}

/// Fails unless an input has the expected length.
pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), ModelError> {
    if found == expected {
        Ok(())
    } else {
        Err(ModelError::Length {
            what,
            found,
            expected,
        })
    }
}

/// Fails at the first value that is not finite, or so large that a network would overflow.
pub(crate) fn check_finite(what: &'static str, values: &[f32]) -> Result<(), ModelError> {
    match values.iter().position(|v| v.is_nan() || v.abs() >= 1e30) {
        None => Ok(()),
        Some(index) => Err(ModelError::NotFinite {
            what,
            index,
            value: values[index],
        }),
    }
}
