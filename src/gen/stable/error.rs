//! Errors of weights that are refused and of pictures that cannot be drawn. Every message is one line.

use std::path::PathBuf;

use diffusion::schedule::ScheduleError;
use diffusion::solver::SolverError;
use thiserror::Error;

/// Errors of this crate.
#[derive(Debug, Error)]
pub enum StableError {
    /// The program was built without the networks.
    #[error(
        "this program was built without the networks for public weights; one with them: cargo run --release --features pictures"
    )]
    Absent,
    /// The system could not read a file or folder.
    #[error("{}: {source}", path.display())]
    Read {
        /// Path of the file or folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file or folder is missing, or is of another kind.
    #[error("{}: expected {expected}, found {found}", path.display())]
    Folder {
        /// Path of the file or folder.
        path: PathBuf,
        /// Description of the expected file or folder.
        expected: String,
        /// Description of the file or folder found.
        found: String,
    },
    /// Not a safetensors file, or a damaged one.
    #[error("{}: not a usable safetensors file: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
    /// A configuration that does not describe a network of this crate.
    #[error("{}: {reason}", path.display())]
    Config {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
    /// Tensors that are missing, have another shape or type, or belong to another network.
    #[error("{}: {reason}", path.display())]
    Tensors {
        /// The folder or file.
        path: PathBuf,
        /// The first few names, and the number of the others.
        reason: String,
    },
    /// An input of the wrong size.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Name of the input.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A value that the pipeline does not take.
    #[error("{what} is {found}, expected {expected}")]
    Value {
        /// Name of the input.
        what: &'static str,
        /// The given value.
        found: String,
        /// The allowed values.
        expected: String,
    },
    /// NaN, infinity, or a number so large that the network would overflow.
    #[error("{what}: value {index} is {value}, expected finite numbers below 1e30")]
    NotFinite {
        /// Name of the input or output.
        what: &'static str,
        /// Index of the first such value.
        index: usize,
        /// That value.
        value: f32,
    },
    /// The tokenizer refuses a text or its own files.
    #[error("tokenizer: {0}")]
    Tokenizer(String),
    /// A number of steps that the schedule does not have.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The solver refuses a state.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The caller stopped a run. Not shown as an error.
    #[error("stopped after step {step} of {steps}")]
    Stopped {
        /// Steps done, from 1.
        step: usize,
        /// All steps.
        steps: usize,
    },
    /// Candle or the graphics card could not compute.
    #[error("candle: {0}")]
    Backend(String),
}

#[cfg(feature = "networks")]
impl From<candle_core::Error> for StableError {
    fn from(error: candle_core::Error) -> Self {
        // The lines after the first tell where in the program the error came from.
        let text = error.to_string();
        Self::Backend(text.lines().next().unwrap_or("no message").trim().to_owned())
    }
}

/// Fails unless an input has the expected length.
pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), StableError> {
    if found == expected {
        return Ok(());
    }
    Err(StableError::Length {
        what,
        found,
        expected,
    })
}

/// Fails at the first value that is not finite, or so large that a network would overflow.
pub(crate) fn check_finite(what: &'static str, values: &[f32]) -> Result<(), StableError> {
    match values.iter().position(|v| v.is_nan() || v.abs() >= 1e30) {
        None => Ok(()),
        Some(index) => Err(StableError::NotFinite {
            what,
            index,
            value: values[index],
        }),
    }
}

/// An error about a value.
pub(crate) fn wrong(
    what: &'static str,
    found: impl std::fmt::Display,
    expected: impl Into<String>,
) -> StableError {
    StableError::Value {
        what,
        found: found.to_string(),
        expected: expected.into(),
    }
}
