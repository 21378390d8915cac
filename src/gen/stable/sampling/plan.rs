//! Training steps that a run visits.

use diffusion::schedule::{Betas, NoiseLevel, Schedule, ScheduleError};
use diffusion::solver::Prediction;

use crate::config::{BetaSchedule, Predicts, SchedulerConfig, SchedulerKind, Steps};
use crate::{StableError, wrong};

/// Least alpha^2 of the noisiest step. It is used if a method divides by its signal and the schedule leaves none.
const LEAST_ALPHA_BAR: f64 = 1.0 / (1u64 << 24) as f64;

/// A network call, with the levels of its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Call {
    /// Level of the network's input; the network is given its `t`.
    pub at: NoiseLevel,
    /// Level that the step starts from; it differs from `at` only in PNDM.
    pub from: NoiseLevel,
    /// Level of the state after the step.
    pub to: NoiseLevel,
}

/// All calls of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingPlan {
    /// The method.
    pub kind: SchedulerKind,
    /// Quantity that the network predicts.
    pub prediction: Prediction,
    /// The calls in order.
    pub calls: Vec<Call>,
    /// `calls + 1` levels from noise to data, for methods with a memory.
    pub(super) levels: Vec<NoiseLevel>,
    /// Spread of the noise that a run without a start picture begins with.
    pub spread: f64,
}

impl SamplingPlan {
    /// Plan of the last `strength` (0 to 1) of `steps` steps by `kind`; 1 is a run from pure noise, 0 has no calls.
    /// Errors if there are no steps or more than the schedule has, or if two steps coincide.
    pub fn new(
        config: &SchedulerConfig,
        kind: SchedulerKind,
        steps: usize,
        strength: f64,
    ) -> Result<Self, StableError> {
        if !(0.0..=1.0).contains(&strength) {
            return Err(wrong("strength", strength, "0 to 1"));
        }
        let train = config.num_train_timesteps;
        if steps == 0 {
            return Err(ScheduleError::NoSteps.into());
        }
        if steps > train {
            let error = ScheduleError::TooManySteps {
                found: steps,
                train_steps: train,
            };
            return Err(error.into());
        }
        let (first, last) = (config.beta_start, config.beta_end);
        let betas = match config.beta_schedule {
            BetaSchedule::Linear => Betas::Linear { first, last },
            BetaSchedule::ScaledLinear => Betas::ScaledLinear { first, last },
            BetaSchedule::Cosine => Betas::Cosine,
        };
        let schedule = NoiseLevelTable {
            schedule: Schedule::new(betas, train, config.rescale_betas_zero_snr)?,
            divides: kind != SchedulerKind::Ddim,
        };
        let spacing = config.timestep_spacing.unwrap_or(match kind {
            SchedulerKind::Ddim | SchedulerKind::Pndm => Steps::Leading,
            _ => Steps::Linspace,
        });
        let all = timesteps(kind, spacing, steps, train, config.steps_offset);
        if all.windows(2).any(|w| w[1] >= w[0]) {
            let error = ScheduleError::NotDecreasing {
                found: steps,
                train_steps: train,
            };
            return Err(error.into());
        }
        let kept = ((steps as f64 * strength) as usize).min(steps);
        let told = &all[steps - kept..];
        let to_one = config.set_alpha_to_one.unwrap_or(kind == SchedulerKind::Ddim);
        let behind = match kind {
            SchedulerKind::Ddim | SchedulerKind::Pndm if !to_one => NoiseLevel {
                t: -1.0,
                ..schedule.at(0.0)
            },
            _ => NoiseLevel::CLEAN,
        };
        let mut levels: Vec<NoiseLevel> = told.iter().map(|t| schedule.at(*t)).collect();
        levels.push(behind);
        let stride = (train / steps) as f64;
        let calls = match kind {
            SchedulerKind::Ddim => strides(&schedule, told, stride, behind),
            SchedulerKind::Pndm => repeated(strides(&schedule, told, stride, behind), &schedule, stride),
            _ => levels
                .windows(2)
                .map(|w| Call {
                    at: w[0],
                    from: w[0],
                    to: w[1],
                })
                .collect(),
        };
        let spread = match (kind, spacing) {
            (SchedulerKind::Euler, Steps::Linspace | Steps::Trailing) => levels[0].sigma,
            _ => 1.0,
        };
        Ok(Self {
            kind,
            prediction: match config.prediction_type {
                Predicts::Noise => Prediction::Epsilon,
                Predicts::V => Prediction::V,
            },
            calls,
            levels,
            spread,
        })
    }
}

/// Steps of equal stride. diffusers counts the stride in whole training steps, also if the next timestep is one
/// further.
fn strides(schedule: &NoiseLevelTable, told: &[f64], stride: f64, behind: NoiseLevel) -> Vec<Call> {
    let call = |t: &f64| {
        let at = schedule.at(*t);
        let to = if *t < stride {
            behind
        } else {
            schedule.at(t - stride)
        };
        Call { at, from: at, to }
    };
    told.iter().map(call).collect()
}

/// The calls of PNDM, whose first step is done twice: the second time from the same start, with the mean of the
/// predictions at its two ends.
fn repeated(mut calls: Vec<Call>, schedule: &NoiseLevelTable, stride: f64) -> Vec<Call> {
    if let Some(second) = calls.get(1).copied() {
        let again = Call {
            at: second.at,
            from: schedule.at(second.at.t + stride),
            to: second.at,
        };
        calls.insert(1, again);
    }
    calls
}

/// Levels of a schedule at whole training steps and between.
struct NoiseLevelTable {
    schedule: Schedule,
    /// Whether the method divides by the signal of the noisiest step.
    divides: bool,
}

impl NoiseLevelTable {
    fn whole(&self, t: usize) -> NoiseLevel {
        let level = self.schedule.level(t.min(self.schedule.train_steps() - 1));
        match self.divides && level.alpha == 0.0 {
            true => NoiseLevel::from_log_alpha_bar(level.t, LEAST_ALPHA_BAR.ln()),
            false => level,
        }
    }

    /// Between two training steps, noise per signal is interpolated linearly.
    fn at(&self, t: f64) -> NoiseLevel {
        let below = t.max(0.0).floor();
        let level = self.whole(below as usize);
        let part = t - below;
        if part <= 0.0 {
            return NoiseLevel { t, ..level };
        }
        let ratio = |level: NoiseLevel| level.sigma / level.alpha;
        let above = ratio(self.whole(below as usize + 1));
        let between = ratio(level) * (1.0 - part) + above * part;
        NoiseLevel::from_log_alpha_bar(t, -(between * between).ln_1p())
    }
}

/// The timesteps of diffusers, from the noisiest on.
fn timesteps(kind: SchedulerKind, spacing: Steps, steps: usize, train: usize, offset: usize) -> Vec<f64> {
    // DPM-Solver++ and UniPC count the end as a step of its own, and leave it out.
    let extra = usize::from(matches!(kind, SchedulerKind::DpmPp | SchedulerKind::UniPc));
    let (total, count) = (train as f64, (steps + extra) as f64);
    let most = total - 1.0;
    let at = |i: usize| match spacing {
        Steps::Linspace if count == 1.0 => 0.0,
        Steps::Linspace => {
            let t = (count - 1.0 - i as f64) * (most / (count - 1.0));
            match kind {
                SchedulerKind::Euler => t,
                _ => t.round_ties_even(),
            }
        }
        Steps::Leading => {
            let stride = train / (steps + extra);
            ((steps + extra - 1 - i) * stride + offset) as f64
        }
        Steps::Trailing => (total - i as f64 * (total / steps as f64)).round_ties_even() - 1.0,
    };
    (0..steps).map(|i| at(i).clamp(0.0, most)).collect()
}
