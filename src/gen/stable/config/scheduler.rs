//! `scheduler/scheduler_config.json`.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{check_plain, check_range, read_config};
use crate::StableError;

/// Method that computes the next state from a prediction. All are deterministic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
pub enum SchedulerKind {
    /// First order.
    #[serde(rename = "DDIMScheduler")]
    Ddim,
    /// Adams-Bashforth of up to fourth order, with one Heun step at the start.
    #[serde(rename = "PNDMScheduler")]
    Pndm,
    /// DPM-Solver++ of second order.
    #[serde(rename = "DPMSolverMultistepScheduler")]
    DpmPp,
    /// Euler steps in noise per signal: DDIM with timesteps of its own.
    #[serde(rename = "EulerDiscreteScheduler")]
    Euler,
    /// UniPC of second order.
    #[serde(rename = "UniPCMultistepScheduler")]
    UniPc,
}

impl SchedulerKind {
    /// All methods.
    pub const ALL: [Self; 5] = [Self::Ddim, Self::Pndm, Self::DpmPp, Self::Euler, Self::UniPc];

    /// Name for users.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ddim => "ddim",
            Self::Pndm => "pndm",
            Self::DpmPp => "dpmpp2m",
            Self::Euler => "euler",
            Self::UniPc => "unipc",
        }
    }
}

/// Rule by which the variances of the training steps were chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BetaSchedule {
    /// Evenly spaced.
    Linear,
    /// Squares of evenly spaced roots.
    ScaledLinear,
    /// From a cosine.
    #[serde(rename = "squaredcos_cap_v2")]
    Cosine,
}

/// Quantity that the UNet predicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Predicts {
    /// The noise.
    #[default]
    #[serde(rename = "epsilon")]
    Noise,
    /// alpha noise - sigma data.
    #[serde(rename = "v_prediction")]
    V,
}

/// Positions of the sampling steps among the training steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Steps {
    /// From the cleanest step on.
    Leading,
    /// From the noisiest step back.
    Trailing,
    /// Evenly spaced between the two ends.
    Linspace,
}

/// The scheduler of a folder.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct SchedulerConfig {
    /// The method; a request may take another.
    #[serde(rename = "_class_name")]
    pub kind: SchedulerKind,
    /// Training steps.
    #[serde(default = "thousand")]
    pub num_train_timesteps: usize,
    /// First variance.
    #[serde(default = "first")]
    pub beta_start: f64,
    /// Last variance.
    #[serde(default = "last")]
    pub beta_end: f64,
    /// The variances between.
    #[serde(default = "linear")]
    pub beta_schedule: BetaSchedule,
    /// Offset added to the steps of [`Steps::Leading`].
    #[serde(default)]
    pub steps_offset: usize,
    /// Whether the level after the last step is clean data, not the first training step. DDIM and PNDM only.
    #[serde(default)]
    pub set_alpha_to_one: Option<bool>,
    /// Positions of the steps; `None` takes the method's own.
    #[serde(default)]
    pub timestep_spacing: Option<Steps>,
    /// Quantity that the UNet predicts.
    #[serde(default)]
    pub prediction_type: Predicts,
    /// Whether the noisiest step is pure noise (Lin et al. 2023).
    #[serde(default)]
    pub rescale_betas_zero_snr: bool,
    #[serde(flatten)]
    rest: Map<String, Value>,
}

fn thousand() -> usize {
    1000
}
fn first() -> f64 {
    1e-4
}
fn last() -> f64 {
    0.02
}
fn linear() -> BetaSchedule {
    BetaSchedule::Linear
}

/// Fields that change the method, and the values that are known here. `clip_sample` is ignored, as in pipelines of
/// Stable Diffusion: latents are not bounded by 1.
const PLAIN: [(&str, &[&str]); 13] = [
    ("algorithm_type", &["\"dpmsolver++\""]),
    ("final_sigmas_type", &["\"zero\""]),
    ("interpolation_type", &["\"linear\""]),
    ("predict_x0", &["true"]),
    ("solver_order", &["2"]),
    ("solver_type", &["\"midpoint\"", "\"bh2\""]),
    ("thresholding", &["false"]),
    ("trained_betas", &["null"]),
    ("use_beta_sigmas", &["false", "null"]),
    ("use_exponential_sigmas", &["false", "null"]),
    ("use_flow_sigmas", &["false", "null"]),
    ("use_karras_sigmas", &["false", "null"]),
    ("variance_type", &["null"]),
];

impl SchedulerConfig {
    /// Reads a configuration file. Errors in one line if a value is not known here.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        read_config(path, Self::check)
    }

    fn check(&self) -> Result<(), String> {
        check_plain(&self.rest, &PLAIN)?;
        if self.kind == SchedulerKind::Pndm {
            check_plain(&self.rest, &[("skip_prk_steps", &["true"])])?;
        }
        check_range("num_train_timesteps", self.num_train_timesteps, 2..=100_000)?;
        check_range(
            "steps_offset",
            self.steps_offset,
            0..=self.num_train_timesteps - 1,
        )
    }
}
