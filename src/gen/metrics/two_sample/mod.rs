//! Can two sets of scenes be told apart? A classifier learns to on one half of the scenes and is judged on the other
//! (Lopez-Paz and Oquab 2017, arXiv 1610.06545): .5 is guessing, 1 certainty. Halves are made of scenes, never of
//! windows.

mod differing_features;
mod net;

use rayon::prelude::*;
use serde::Serialize;

use super::MetricError;
use super::frechet::check;
use super::local::Windows;
use super::stats::{interval, t_quantile_975};
pub use differing_features::{Tell, tells};
use net::Net;
use world::draw::Draw;

/// Number of random splits into halves; each half of a split is judged once.
const SPLITS: usize = 3;

/// Accuracy of a classifier on scenes that it has not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// Share of right answers; the two sets count the same.
    pub mean: f64,
    /// Half of its 95 % interval.
    pub ci95: f64,
}

impl Accuracy {
    /// True if .5 lies within the interval: the sets could not be told apart.
    pub fn is_guessing(&self) -> bool {
        (self.mean - 0.5).abs() <= self.ci95
    }
}

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TwoSample {
    /// Accuracy on single windows.
    pub window: Accuracy,
    /// Accuracy on whole scenes, by the mean answer for their windows.
    pub scene: Accuracy,
    /// Number of scenes of each set.
    pub scenes: usize,
}

/// Tells the scenes of `a` from those of `b`. Takes as many of each as the smaller set has, at least four, each with at
/// least one window.
pub fn two_sample(a: &[Windows], b: &[Windows], seed: u64) -> Result<TwoSample, MetricError> {
    let n = a.len().min(b.len());
    for (set, which) in [(a, "x"), (b, "y")] {
        if n < 4 || set.iter().any(Vec::is_empty) {
            return Err(MetricError::TooFewScenes { found: n });
        }
        check(&set.concat(), which)?;
    }
    if a[0][0].len() != b[0][0].len() {
        let (found, expected) = (b[0][0].len(), a[0][0].len());
        return Err(MetricError::Width { found, expected });
    }
    // Accuracies of a pair of scenes, one of each set, which stay in the same half: a bias of the answers cancels.
    let folds: Vec<(u64, Vec<usize>, Vec<usize>)> = (0..SPLITS as u64)
        .flat_map(|split| {
            let mut order: Vec<usize> = (0..n).collect();
            net::shuffle(&mut order, &mut Draw::new(seed ^ split, "halves of scenes"));
            let (one, other) = order.split_at(n / 2);
            let (one, other) = (one.to_vec(), other.to_vec());
            [
                (2 * split, one.clone(), other.clone()),
                (2 * split + 1, other, one),
            ]
        })
        .collect();
    let judged: Vec<Vec<(usize, [f64; 2])>> = folds
        .par_iter()
        .map(|(fold, learned, judged)| judge(a, b, learned, judged, seed.wrapping_add(*fold)))
        .collect();
    let mut pairs = vec![[0.0; 2]; n];
    for (pair, found) in judged.into_iter().flatten() {
        for (sum, found) in pairs[pair].iter_mut().zip(found) {
            *sum += found / SPLITS as f64;
        }
    }
    let [window, scene] = [0, 1].map(|k| accuracy(&pairs.iter().map(|p| p[k]).collect::<Vec<_>>()));
    Ok(TwoSample {
        window,
        scene,
        scenes: n,
    })
}

/// Learns on some pairs of scenes. Gives the share of right windows and of right scenes for each of the other pairs.
fn judge(
    a: &[Windows],
    b: &[Windows],
    learned: &[usize],
    judged: &[usize],
    seed: u64,
) -> Vec<(usize, [f64; 2])> {
    let (mut rows, mut labels) = (Vec::new(), Vec::new());
    for &pair in learned {
        for (set, label) in [(a, false), (b, true)] {
            rows.extend(set[pair].iter().map(Vec::as_slice));
            labels.resize(rows.len(), label);
        }
    }
    let net = Net::train(&rows, &labels, seed);
    let right = |windows: &Windows, sign: f64| {
        let scores: Vec<f64> = windows.iter().map(|w| sign * net.score(w)).collect();
        let share = scores.iter().filter(|s| **s > 0.0).count() as f64 / scores.len() as f64;
        let vote = scores.iter().map(|s| s.clamp(-4.0, 4.0)).sum::<f64>();
        [share, f64::from(u8::from(vote > 0.0))]
    };
    let each = judged.iter().map(|&pair| {
        let (of_a, of_b) = (right(&a[pair], -1.0), right(&b[pair], 1.0));
        (pair, [0, 1].map(|k| (of_a[k] + of_b[k]) / 2.0))
    });
    each.collect()
}

/// Mean over pairs of scenes. The two halves judge each other, so chance findings of one tend to show in the other, and
/// in further splits too. So the interval is that of one half, with Student's t for its few scenes.
fn accuracy(pairs: &[f64]) -> Accuracy {
    let half = pairs.len() / 2;
    let (mean, standard_error) = interval(pairs);
    let wider = (pairs.len() as f64 / half as f64).sqrt() * t_quantile_975(half - 1);
    // Answers that are all right have no spread; one pair that is half wrong is the least error that cannot be
    // excluded.
    let least = 0.5 / pairs.len() as f64;
    Accuracy {
        mean,
        ci95: (standard_error * wider).max(least),
    }
}

#[cfg(test)]
mod tests;
