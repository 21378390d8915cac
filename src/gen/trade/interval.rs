//! Medians with bootstrap intervals (Efron's percentile method).

use serde::{Deserialize, Serialize};

use numeric::quantile::{median, quantile};
use world::draw::Draw;

/// Resamples of a bootstrap.
const RESAMPLES: usize = 10_000;

/// A figure with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The median of the values.
    pub median: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Number of values.
    pub n: usize,
}

impl Interval {
    /// True if a value lies in it.
    pub fn holds(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    /// True if all of it lies below all of `other`.
    pub fn below(&self, other: &Self) -> bool {
        self.high < other.low
    }
}

/// Median of values and the 95 % interval of that median. NaN counts as infinity, since a failed run must not look
/// good. One value is its own interval; no values give NaN.
pub fn bootstrap_median(values: &[f64], seed: u64) -> Interval {
    let mut sorted: Vec<f64> = values
        .iter()
        .map(|v| if v.is_nan() { f64::INFINITY } else { *v })
        .collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    if n < 2 {
        let v = sorted.first().copied().unwrap_or(f64::NAN);
        return Interval {
            median: v,
            low: v,
            high: v,
            n,
        };
    }
    let mut draw = Draw::new(seed, "bootstrap");
    let mut medians = Vec::with_capacity(RESAMPLES);
    // The middle of a resample needs no sorting: counting how often each sorted value is drawn is enough.
    let mut counts = vec![0u32; n];
    for _ in 0..RESAMPLES {
        counts.fill(0);
        for _ in 0..n {
            counts[draw.below(n)] += 1;
        }
        let place = |rank: u32| {
            let mut seen = 0;
            let at = counts.iter().position(|c| {
                seen += c;
                seen > rank
            });
            sorted[at.unwrap_or(n - 1)]
        };
        let (low, high) = (place((n as u32 - 1) / 2), place(n as u32 / 2));
        medians.push(if low == high { low } else { (low + high) / 2.0 });
    }
    Interval {
        median: median(&sorted),
        low: quantile(&medians, 0.025),
        high: quantile(&medians, 0.975),
        n,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_covers_the_true_median_as_often_as_it_says() {
        let mut draw = Draw::new(5, "coverage");
        let trials = 200;
        let covered = (0..trials)
            .filter(|trial| {
                let values: Vec<f64> = (0..25).map(|_| draw.unit().powi(3)).collect();
                bootstrap_median(&values, *trial).holds(0.125)
            })
            .count();
        assert!((178..=200).contains(&covered), "{covered} of {trials}");
    }

    #[test]
    fn extremes() {
        assert!(bootstrap_median(&[], 0).median.is_nan());
        let one = bootstrap_median(&[3.0], 0);
        assert_eq!((one.low, one.median, one.high, one.n), (3.0, 3.0, 3.0, 1));
        let same = bootstrap_median(&[2.0; 9], 0);
        assert_eq!((same.low, same.high), (2.0, 2.0));
        let bad = bootstrap_median(&[1.0, f64::NAN, f64::NAN], 0);
        assert_eq!(bad.median, f64::INFINITY);
        assert!(bad.low <= bad.high);
        assert_eq!(
            bootstrap_median(&[1.0, 2.0, 5.0], 7),
            bootstrap_median(&[5.0, 1.0, 2.0], 7)
        );
    }
}
