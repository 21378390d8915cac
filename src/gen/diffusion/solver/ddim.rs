//! DDIM steps. Song et al. 2020, arXiv 2010.02502 (eta 0); v prediction by Salimans and Ho 2022,
//! arXiv 2202.00512.

use super::Prediction;
use crate::schedule::{NoiseLevel, ScheduleError};

/// One deterministic DDIM step as two numbers: `next = keep * x + push * prediction`.
///
/// With v prediction the levels are angles on a circle and the step is a rotation, so it stays finite
/// where alpha is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DdimStep {
    /// Weight of the state.
    pub keep: f64,
    /// Weight of the prediction.
    pub push: f64,
}

impl DdimStep {
    /// The step between two levels, in either direction; `prediction` is made at level `from`.
    pub fn new(prediction: Prediction, from: &NoiseLevel, to: &NoiseLevel) -> Result<Self, ScheduleError> {
        // Equal levels are an exact identity; the products below are so only up to rounding.
        if from.log_alpha_bar == to.log_alpha_bar {
            return Ok(Self { keep: 1.0, push: 0.0 });
        }
        match prediction {
            Prediction::Epsilon if from.alpha == 0.0 => {
                Err(ScheduleError::EpsilonWithoutSignal { t: from.t })
            }
            Prediction::Epsilon => {
                let keep = to.alpha / from.alpha;
                Ok(Self {
                    keep,
                    push: to.sigma - keep * from.sigma,
                })
            }
            Prediction::V => Ok(Self {
                keep: from.alpha * to.alpha + from.sigma * to.sigma,
                push: to.sigma * from.alpha - to.alpha * from.sigma,
            }),
        }
    }

    /// The next value of one number. A step between equal levels returns it bit for bit.
    #[inline]
    pub fn apply(&self, x: f64, predicted: f64) -> f64 {
        if self.push == 0.0 && self.keep == 1.0 {
            return x;
        }
        self.keep * x + self.push * predicted
    }

    /// The next state.
    pub fn apply_all(&self, x: &[f64], predicted: &[f64]) -> Vec<f64> {
        x.iter().zip(predicted).map(|(x, p)| self.apply(*x, *p)).collect()
    }

    /// The state that this step takes to `next` if the prediction there is `predicted`;
    /// `None` if the step forgets its state.
    pub fn solve(&self, next: &[f64], predicted: &[f64]) -> Option<Vec<f64>> {
        // Below this the division returns mostly rounding errors (one step from pure noise to data: cos 90 deg).
        const LEAST_KEEP: f64 = 1e-9;
        if self.keep.abs() < LEAST_KEEP {
            return None;
        }
        let pairs = next.iter().zip(predicted);
        Some(
            pairs
                .map(|(n, p)| {
                    if self.push == 0.0 && self.keep == 1.0 {
                        *n
                    } else {
                        (n - self.push * p) / self.keep
                    }
                })
                .collect(),
        )
    }
}

/// The clean data that a prediction implies.
pub fn clean_estimate(prediction: Prediction, level: &NoiseLevel, x: f64, predicted: f64) -> f64 {
    match prediction {
        Prediction::Epsilon => (x - level.sigma * predicted) / level.alpha,
        Prediction::V => level.alpha * x - level.sigma * predicted,
    }
}
