//! Figures of merit, each with its definition.

pub mod agreement;
mod components;
pub mod extractor;
pub mod frechet;
pub mod iou;
pub mod kernel;
pub mod layout;
pub mod lidar;
pub mod local;
pub mod logistic;
pub mod maps;
pub mod occupancy;
pub mod pictures;
pub mod placement;
#[cfg(test)]
mod reference;
pub mod scenewise;
pub mod shape;
pub mod stats;
pub mod sweep;
pub mod two_sample;

use thiserror::Error;

/// Reason why a figure cannot be computed from the samples.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MetricError {
    /// Fewer than two samples.
    #[error("{which} has {found} samples, expected at least 2")]
    TooFew {
        /// Name of the set.
        which: &'static str,
        /// Size of the set.
        found: usize,
    },
    /// Samples of different length.
    #[error("a sample has {found} numbers, expected {expected}")]
    Width {
        /// Length of the sample.
        found: usize,
        /// Length of the first sample.
        expected: usize,
    },
    /// Fewer than four scenes, or scenes without windows.
    #[error("{found} scenes in each set, expected at least 4 with windows")]
    TooFewScenes {
        /// Scenes of the smaller set.
        found: usize,
    },
    /// NaN or infinity.
    #[error("{which} holds a number that is not finite")]
    NotFinite {
        /// Name of the set.
        which: &'static str,
    },
}
