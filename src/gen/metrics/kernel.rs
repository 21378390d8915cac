//! Kernel distances between two sets of feature vectors: squared MMD with a Gaussian kernel, and KID, which is squared
//! MMD with the kernel (x.y / d + 1)^3 (Binkowski et al. 2018, arXiv 1801.01401). Both are unbiased U-statistics, which
//! may be a little below zero.

use super::frechet::check;
use super::{MetricError, stats::mean_ci95};

/// Smallest bandwidth of a Gaussian kernel.
const LEAST_BANDWIDTH: f64 = 1e-12;

/// A kernel on pairs of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// (x.y / d + 1)^3.
    Cubic,
    /// exp(-|x - y|^2 / (2 bandwidth^2)).
    Gaussian {
        /// Its standard deviation.
        bandwidth: f64,
    },
}

impl Kernel {
    /// Gaussian with the median distance of all pairs as bandwidth.
    pub fn median_gaussian(x: &[Vec<f64>], y: &[Vec<f64>]) -> Self {
        let all: Vec<&Vec<f64>> = x.iter().chain(y).collect();
        let mut distances = Vec::with_capacity(all.len() * (all.len().max(1) - 1) / 2);
        for (i, a) in all.iter().enumerate() {
            distances.extend(all[..i].iter().map(|b| squared_distance(a, b).sqrt()));
        }
        Kernel::Gaussian {
            bandwidth: numeric::quantile::median(&distances).max(LEAST_BANDWIDTH),
        }
    }

    /// Value of the kernel for two samples.
    pub(super) fn of(self, a: &[f64], b: &[f64]) -> f64 {
        match self {
            Kernel::Cubic => {
                let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                (dot / a.len() as f64 + 1.0).powi(3)
            }
            Kernel::Gaussian { bandwidth } => {
                let bandwidth = bandwidth.max(LEAST_BANDWIDTH);
                (-squared_distance(a, b) / (2.0 * bandwidth * bandwidth)).exp()
            }
        }
    }
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Squared maximum mean discrepancy as a biased V-statistic: every pair counts, and it is at least 0. LidarDM's
/// definition.
pub fn mmd2_biased(kernel: Kernel, x: &[Vec<f64>], y: &[Vec<f64>]) -> Result<f64, MetricError> {
    let (wide, found) = (check(x, "x")?, check(y, "y")?);
    if wide != found {
        return Err(MetricError::Width {
            found,
            expected: wide,
        });
    }
    let mean = |a: &[Vec<f64>], b: &[Vec<f64>]| {
        let sums = a.iter().map(|a| b.iter().map(|b| kernel.of(a, b)).sum::<f64>());
        sums.sum::<f64>() / (a.len() * b.len()) as f64
    };
    Ok((mean(x, x) + mean(y, y) - 2.0 * mean(x, y)).max(0.0))
}

/// Squared maximum mean discrepancy, unbiased.
pub fn mmd2(kernel: Kernel, x: &[Vec<f64>], y: &[Vec<f64>]) -> Result<f64, MetricError> {
    let (wide, found) = (check(x, "x")?, check(y, "y")?);
    if wide != found {
        return Err(MetricError::Width {
            found,
            expected: wide,
        });
    }
    let within = |s: &[Vec<f64>]| {
        let mut sum = 0.0;
        for (i, a) in s.iter().enumerate() {
            sum += s[..i].iter().map(|b| kernel.of(a, b)).sum::<f64>();
        }
        2.0 * sum / (s.len() * (s.len() - 1)) as f64
    };
    let between: f64 = x
        .iter()
        .map(|a| y.iter().map(|b| kernel.of(a, b)).sum::<f64>())
        .sum();
    Ok(within(x) + within(y) - 2.0 * between / (x.len() * y.len()) as f64)
}

/// Mean over `subsets` disjoint parts of the sets, and half of its 95 % interval. Takes fewer parts if the sets are too
/// small.
pub fn mmd2_with_interval(
    kernel: Kernel,
    x: &[Vec<f64>],
    y: &[Vec<f64>],
    subsets: usize,
) -> Result<(f64, f64), MetricError> {
    let whole = mmd2(kernel, x, y)?;
    let parts = subsets.min(x.len() / 2).min(y.len() / 2).max(1);
    // Every `parts`-th sample belongs to one part.
    let part =
        |s: &[Vec<f64>], k: usize| -> Vec<Vec<f64>> { s.iter().skip(k).step_by(parts).cloned().collect() };
    let values: Result<Vec<f64>, MetricError> = (0..parts)
        .map(|k| mmd2(kernel, &part(x, k), &part(y, k)))
        .collect();
    Ok((whole, mean_ci95(&values?).1))
}

#[cfg(test)]
mod tests {
    use super::super::reference::{Reference, rows};
    use super::*;
    use numeric::philox::{Stream, normal_field};

    /// Row 56 of the extremes table; NumPy 2.4.6, U-statistics, tolerance 1e-12 (cubic 1e-11 relative).
    #[test]
    fn row_56_mmd_and_kid_against_numpy() {
        for case in Reference::open().array("mmd") {
            let (x, y) = (rows(&case["x"]), rows(&case["y"]));
            let truth = |kernel: &str| case[kernel]["u"].as_f64();
            for (kernel, truth) in [
                (Kernel::Cubic, truth("kid_poly3")),
                (Kernel::Gaussian { bandwidth: 0.5 }, truth("rbf_0.5")),
                (Kernel::median_gaussian(&x, &y), truth("rbf_median")),
            ] {
                let Some(truth) = truth else { continue };
                let found = mmd2(kernel, &x, &y).expect("sound samples");
                assert!(
                    (found - truth).abs() <= 1e-11 * truth.abs().max(1.0),
                    "{} {kernel:?}: {found}, expected {truth}",
                    case["name"]
                );
            }
        }
        for case in Reference::open().array("mmd") {
            let (x, y) = (rows(&case["x"]), rows(&case["y"]));
            let found = mmd2_biased(Kernel::Gaussian { bandwidth: 0.5 }, &x, &y).expect("sound samples");
            let truth = case["rbf_0.5"]["v"].as_f64().expect("a number");
            assert!(
                (found - truth).abs() < 1e-12,
                "{}: {found}, expected {truth}",
                case["name"]
            );
        }
        let one = vec![vec![0.0]];
        assert_eq!(
            mmd2(Kernel::Cubic, &one, &one).expect_err("one").to_string(),
            "x has 1 samples, expected at least 2"
        );
        // Duplicates only: bandwidth 0 is held above nothing.
        let same = vec![vec![2.0, 1.0]; 5];
        let kernel = Kernel::median_gaussian(&same, &same);
        assert!(mmd2(kernel, &same, &same).expect("finite").abs() < 1e-12);
    }

    #[test]
    fn one_distribution_is_at_no_distance_within_its_interval() {
        let sample = |seed: u64| -> Vec<Vec<f64>> {
            let flat = normal_field(seed, Stream::Start, 400, 8);
            flat.chunks_exact(8).map(<[f64]>::to_vec).collect()
        };
        let (x, y) = (sample(1), sample(2));
        let kernel = Kernel::median_gaussian(&x, &y);
        let (found, half) = mmd2_with_interval(kernel, &x, &y, 10).expect("sound");
        assert!(found.abs() <= 3.0 * half && half > 0.0, "{found} +- {half}");
        let moved: Vec<Vec<f64>> = y.iter().map(|r| r.iter().map(|v| v + 1.0).collect()).collect();
        assert!(mmd2(kernel, &x, &moved).expect("sound") > 10.0 * half);
    }
}
