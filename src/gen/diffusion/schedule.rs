//! Noise schedules: how much signal and how much noise is in a state, in f64.
//!
//! Ho et al. 2020 (linear betas), Rombach et al. 2022 (scaled linear), Nichol and Dhariwal 2021 (cosine);
//! zero terminal SNR by Lin et al. 2023, arXiv 2305.08891. Everything is kept as log(alpha_bar), because
//! 1 - exp(log alpha_bar) loses all digits near the clean end.

use thiserror::Error;

/// Choice of the noise variances of the training steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Betas {
    /// Evenly spaced from `first` to `last`.
    Linear {
        /// Variance of the first training step.
        first: f64,
        /// Variance of the last training step.
        last: f64,
    },
    /// Squares of evenly spaced roots from sqrt(`first`) to sqrt(`last`).
    ScaledLinear {
        /// Variance of the first training step.
        first: f64,
        /// Variance of the last training step.
        last: f64,
    },
    /// alpha_bar(u) = cos^2((u + 0.008) / 1.008 * pi / 2), betas at most 0.999.
    Cosine,
}

/// Placement of the sampling steps among the training steps (names as in diffusers).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// Counted back from the noisiest step, which is included.
    Trailing,
    /// Multiples of floor(T / N), starting at the cleanest step.
    Leading,
    /// Evenly from the noisiest step to the cleanest, both included.
    Linspace,
}

/// Error of a schedule or of a choice of steps.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ScheduleError {
    /// No sampling step was asked for.
    #[error("steps is 0, expected at least 1")]
    NoSteps,
    /// More sampling steps than training steps.
    #[error("steps is {found}, expected at most {train_steps}")]
    TooManySteps {
        /// Steps asked for.
        found: usize,
        /// Training steps of the schedule.
        train_steps: usize,
    },
    /// Two sampling steps fell on the same training step.
    #[error("{found} steps over {train_steps} training steps are not strictly decreasing")]
    NotDecreasing {
        /// Steps asked for.
        found: usize,
        /// Training steps of the schedule.
        train_steps: usize,
    },
    /// A schedule needs at least two training steps.
    #[error("train_steps is {found}, expected at least 2")]
    TooFewTrainSteps {
        /// Training steps asked for.
        found: usize,
    },
    /// A variance outside (0, 1).
    #[error("betas run from {first} to {last}, expected numbers between 0 and 1")]
    BetaRange {
        /// First variance.
        first: f64,
        /// Last variance.
        last: f64,
    },
    /// A solver that divides by the signal met a level without any.
    #[error("no signal at t = {t}, expected a noisiest level with alpha above 0")]
    NoSignal {
        /// The training step.
        t: f64,
    },
    /// With alpha = 0 a noise prediction says nothing about the data.
    #[error("noise prediction cannot leave t = {t}, where alpha is 0; expected v prediction")]
    EpsilonWithoutSignal {
        /// The training step.
        t: f64,
    },
}

/// One noise level: a state there is `alpha * data + sigma * noise` with alpha^2 + sigma^2 = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLevel {
    /// The training step that a network is told; -1 for clean data.
    pub t: f64,
    /// log(alpha^2); 0 for clean data, minus infinity for pure noise.
    pub log_alpha_bar: f64,
    /// Weight of the data.
    pub alpha: f64,
    /// Weight of the noise.
    pub sigma: f64,
}

impl NoiseLevel {
    /// Clean data.
    pub const CLEAN: NoiseLevel = NoiseLevel {
        t: -1.0,
        log_alpha_bar: 0.0,
        alpha: 1.0,
        sigma: 0.0,
    };

    /// The level of log(alpha^2), which is at most 0 and may be minus infinity.
    pub fn from_log_alpha_bar(t: f64, log_alpha_bar: f64) -> NoiseLevel {
        NoiseLevel {
            t,
            log_alpha_bar,
            alpha: (0.5 * log_alpha_bar).exp(),
            sigma: (-log_alpha_bar.exp_m1()).sqrt(),
        }
    }
}

/// The noise levels of all training steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    log_alpha_bar: Vec<f64>,
}

impl Schedule {
    /// Training steps of every network of this project.
    pub const TRAIN_STEPS: usize = 1000;

    /// Tables for `train_steps` steps; with `zero_snr` the last one is pure noise.
    pub fn new(betas: Betas, train_steps: usize, zero_snr: bool) -> Result<Self, ScheduleError> {
        if train_steps < 2 {
            return Err(ScheduleError::TooFewTrainSteps { found: train_steps });
        }
        if let Betas::Linear { first, last } | Betas::ScaledLinear { first, last } = betas
            && !(first > 0.0 && first < 1.0 && last > 0.0 && last < 1.0)
        {
            return Err(ScheduleError::BetaRange { first, last });
        }
        let mut log_alpha_bar = Vec::with_capacity(train_steps);
        let mut sum = 0.0;
        for i in 0..train_steps {
            sum += log_one_minus_beta(betas, i, train_steps);
            log_alpha_bar.push(sum);
        }
        if zero_snr {
            rescale_to_zero_snr(&mut log_alpha_bar);
        }
        Ok(Self { log_alpha_bar })
    }

    /// The schedule of this project's networks: 1000 cosine steps, zero terminal SNR.
    pub fn standard() -> Self {
        Self::new(Betas::Cosine, Self::TRAIN_STEPS, true).expect("fixed numbers in range")
    }

    /// Number of training steps.
    pub fn train_steps(&self) -> usize {
        self.log_alpha_bar.len()
    }

    /// The level of training step `t`. Panics if `t` is not below [`Schedule::train_steps`].
    pub fn level(&self, t: usize) -> NoiseLevel {
        NoiseLevel::from_log_alpha_bar(t as f64, self.log_alpha_bar[t])
    }

    /// The training steps of `n` sampling steps, strictly decreasing.
    pub fn timesteps(&self, n: usize, spacing: Spacing) -> Result<Vec<usize>, ScheduleError> {
        let train_steps = self.train_steps();
        if n == 0 {
            return Err(ScheduleError::NoSteps);
        }
        if n > train_steps {
            return Err(ScheduleError::TooManySteps {
                found: n,
                train_steps,
            });
        }
        let (total, count) = (train_steps as f64, n as f64);
        let steps: Vec<usize> = (0..n)
            .map(|i| match spacing {
                // numpy rounds halves to even, and so do the tables a network may have been tuned with.
                Spacing::Trailing => (total - i as f64 * (total / count)).round_ties_even() as usize - 1,
                Spacing::Leading => (n - 1 - i) * (train_steps / n),
                Spacing::Linspace if n == 1 => 0,
                Spacing::Linspace => {
                    ((n - 1 - i) as f64 * ((total - 1.0) / (count - 1.0))).round_ties_even() as usize
                }
            })
            .collect();
        if steps.windows(2).any(|w| w[1] >= w[0]) {
            return Err(ScheduleError::NotDecreasing {
                found: n,
                train_steps,
            });
        }
        Ok(steps)
    }

    /// `n` levels spaced evenly over the training steps below `top`, noisiest first, then clean data.
    pub fn levels_below(&self, top: usize, n: usize) -> Result<Vec<NoiseLevel>, ScheduleError> {
        let below = Self {
            log_alpha_bar: self.log_alpha_bar[..top.min(self.train_steps())].to_vec(),
        };
        below.levels(n, Spacing::Trailing)
    }

    /// The `n + 1` levels that a sampler visits, from noise to clean data.
    pub fn levels(&self, n: usize, spacing: Spacing) -> Result<Vec<NoiseLevel>, ScheduleError> {
        let mut levels: Vec<NoiseLevel> = self
            .timesteps(n, spacing)?
            .into_iter()
            .map(|t| self.level(t))
            .collect();
        levels.push(NoiseLevel::CLEAN);
        Ok(levels)
    }
}

fn log_one_minus_beta(betas: Betas, i: usize, train_steps: usize) -> f64 {
    let share = i as f64 / (train_steps - 1) as f64;
    match betas {
        Betas::Linear { first, last } => (-(first + (last - first) * share)).ln_1p(),
        Betas::ScaledLinear { first, last } => {
            let (a, b) = (first.sqrt(), last.sqrt());
            (-(a + (b - a) * share).powi(2)).ln_1p()
        }
        Betas::Cosine => {
            // log cos^2 as log(1 - sin^2): keeps its digits where cos is near 1.
            let log_bar = |k: usize| {
                let u = k as f64 / train_steps as f64;
                let angle = (u + 0.008) / 1.008 * std::f64::consts::FRAC_PI_2;
                (-angle.sin().powi(2)).ln_1p()
            };
            let smallest = (1.0f64 - 0.999).ln();
            (log_bar(i + 1) - log_bar(i)).max(smallest)
        }
    }
}

/// Lin et al. 2023, algorithm 1: shift sqrt(alpha_bar) so that its last value is 0 and scale it so that
/// its first value stays. Differences are taken in the log domain, where neither end cancels.
fn rescale_to_zero_snr(log_alpha_bar: &mut [f64]) {
    let (Some(&first), Some(&last)) = (log_alpha_bar.first(), log_alpha_bar.last()) else {
        return;
    };
    // With r = sqrt(alpha_bar): (r - r_last) / (r_first - r_last) = 1 - (r_first - r) / (r_first - r_last).
    let root = |log: f64| (0.5 * log).exp();
    let span = -root(first) * (0.5 * (last - first)).exp_m1();
    for log in log_alpha_bar.iter_mut() {
        let above_last = root(last) * (0.5 * (*log - last)).exp_m1();
        let below_first = -root(first) * (0.5 * (*log - first)).exp_m1();
        let log_ratio = if below_first < above_last {
            (-below_first / span).ln_1p()
        } else {
            (above_last / span).ln()
        };
        *log = first + 2.0 * log_ratio;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_schedules() -> Vec<(String, Schedule)> {
        let linear = Betas::Linear {
            first: 1e-4,
            last: 0.02,
        };
        let scaled = Betas::ScaledLinear {
            first: 0.00085,
            last: 0.012,
        };
        let mut out = Vec::new();
        for betas in [linear, scaled, Betas::Cosine] {
            for zero_snr in [false, true] {
                let schedule = Schedule::new(betas, 1000, zero_snr).expect("valid");
                out.push((format!("{betas:?}, zero SNR {zero_snr}"), schedule));
            }
        }
        out
    }

    /// Row 1 of the extremes table.
    #[test]
    fn row_01_sigma_near_the_clean_end() {
        for exponent in 30..=80 {
            let log = -(10f64.powf(-f64::from(exponent) / 10.0));
            let level = NoiseLevel::from_log_alpha_bar(0.0, log);
            // 1 - e^x = -x (1 + x/2 + x^2/6 + ...): all digits for small x.
            let series = 1.0
                + log / 2.0 * (1.0 + log / 3.0 * (1.0 + log / 4.0 * (1.0 + log / 5.0 * (1.0 + log / 6.0))));
            let exact = (-log * series).sqrt();
            assert!((level.sigma / exact - 1.0).abs() <= 1e-12);
            assert!((f64::from(level.sigma as f32) / exact - 1.0).abs() <= 2.0 * f64::from(f32::EPSILON));
        }
        // A whole table: sigma^2 grows by sums of positive terms, which lose nothing.
        let (first, last) = (1e-4, 0.02);
        let schedule = Schedule::new(Betas::Linear { first, last }, 1000, false).expect("valid");
        let mut variance = 0.0;
        for t in 0..1000 {
            let beta = first + (last - first) * t as f64 / 999.0;
            variance += (1.0 - variance) * beta;
            let error = schedule.level(t).sigma / variance.sqrt() - 1.0;
            assert!(error.abs() <= 1e-12, "t {t}: {error:e}");
        }
    }

    /// Row 2 of the extremes table (the tables; the step is tested beside the solver).
    #[test]
    fn row_02_end_of_the_schedule() {
        for (name, schedule) in all_schedules() {
            let end = schedule.level(999);
            assert!(end.alpha.is_finite() && end.sigma.is_finite(), "{name}");
            if name.ends_with("true") {
                assert_eq!((end.alpha, end.sigma), (0.0, 1.0), "{name}");
                // Only the last step is pure noise, and the first one is as before.
                assert!(schedule.level(998).alpha > 0.0, "{name}");
            }
        }
        let plain = Schedule::new(Betas::Cosine, 1000, false).expect("valid");
        let shift = Schedule::standard().level(0).sigma / plain.level(0).sigma - 1.0;
        assert!(shift.abs() <= 1e-12, "{shift:e}");
    }

    /// Row 3 of the extremes table.
    #[test]
    fn row_03_signal_and_noise_sum_to_one() {
        for (name, schedule) in all_schedules() {
            for t in 0..1000 {
                let l = schedule.level(t);
                let drift = (l.alpha * l.alpha + l.sigma * l.sigma - 1.0).abs();
                assert!(drift <= 4.0 * f64::EPSILON, "{name}, t {t}: {drift:e}");
                if t > 0 {
                    assert!(
                        l.log_alpha_bar < schedule.level(t - 1).log_alpha_bar,
                        "{name}, t {t}"
                    );
                }
            }
        }
    }

    /// Row 4 of the extremes table: every N gives N strictly decreasing steps or a typed error.
    #[test]
    fn row_04_timesteps() {
        let schedule = Schedule::standard();
        for spacing in [Spacing::Trailing, Spacing::Leading, Spacing::Linspace] {
            for n in 1..=1000 {
                let steps = schedule.timesteps(n, spacing).expect("N up to T");
                assert_eq!(steps.len(), n);
                assert!(steps.windows(2).all(|w| w[0] > w[1]), "{spacing:?} {n}");
                assert!(steps[0] < 1000);
                if spacing == Spacing::Trailing {
                    assert_eq!(steps[0], 999);
                }
            }
            assert_eq!(schedule.timesteps(0, spacing), Err(ScheduleError::NoSteps));
            let too_many = schedule.timesteps(1001, spacing).expect_err("T + 1");
            assert_eq!(too_many.to_string(), "steps is 1001, expected at most 1000");
        }
        let t = |n, s| schedule.timesteps(n, s).expect("valid");
        assert_eq!(t(3, Spacing::Trailing), vec![999, 666, 332]);
        assert_eq!(t(3, Spacing::Leading), vec![666, 333, 0]);
        assert_eq!(t(3, Spacing::Linspace), vec![999, 500, 0]);
        assert_eq!(schedule.levels(5, Spacing::Trailing).expect("valid").len(), 6);
    }

    #[test]
    fn bad_betas_are_refused() {
        let make = |first, last| Schedule::new(Betas::Linear { first, last }, 1000, true);
        for (first, last) in [(0.0, 0.02), (1e-4, 1.0), (f64::NAN, 0.02), (1e-4, f64::INFINITY)] {
            assert!(matches!(make(first, last), Err(ScheduleError::BetaRange { .. })));
        }
        assert_eq!(
            Schedule::new(Betas::Cosine, 1, true),
            Err(ScheduleError::TooFewTrainSteps { found: 1 })
        );
    }
}
