//! Common parts of the commands: options, knobs of a generation, and how a command ends.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::region_arg::RegionArg;
use ::trade::Presets;
use diffusion::solver::SolverKind;
use job::{ChosenDensities, GenParams, Precision, RegionMode};
use nets::OccModels;

/// Options that every command has.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Common {
    /// Print exactly one JSON object on stdout at the end.
    #[arg(long)]
    pub(super) json: bool,
    /// Show progress on stderr even when it is not a terminal.
    #[arg(long)]
    pub(super) progress: bool,
}

/// Which networks a command that generates takes.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Weights {
    /// Folder of weights (occ_vae.safetensors, occ_dit.safetensors) instead of the bundled ones.
    #[arg(long = "weights", value_name = "DIR")]
    pub(super) folder: Option<PathBuf>,
}

/// Knobs of a generation.
#[derive(Args, Clone, Debug)]
pub(super) struct Gen {
    /// Steps of the sampler.
    #[arg(long, value_name = "N")]
    pub(super) steps: Option<u32>,
    /// Method of the sampler: ddim, dpmpp2m, unipc, or obelm, whose inversion is exact.
    #[arg(long)]
    pub(super) solver: Option<SolverKind>,
    /// Classifier-free guidance weight; 1 means none.
    #[arg(long, value_name = "W")]
    pub(super) guidance: Option<f64>,
    /// How far guided predictions are scaled back to the spread of the unguided ones, 0 to 1.
    #[arg(long, value_name = "R")]
    pub(super) guidance_rescale: Option<f64>,
    /// How much grows beside the road, 0 to 1; not named, the networks choose, or an edit keeps it.
    #[arg(long, value_name = "D")]
    pub(super) vegetation: Option<f32>,
    /// How much is built beside the road, 0 to 1.
    #[arg(long, value_name = "D")]
    pub(super) buildings: Option<f32>,
    /// How much low furniture stands beside the road, 0 to 1.
    #[arg(long, value_name = "D")]
    pub(super) clutter: Option<f32>,
    /// Share of columns that hold anything: 1 complete (the default for all of a scene), about 0.4 as real labels are.
    #[arg(long, value_name = "D")]
    pub(super) completeness: Option<f32>,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Region that is regenerated: `auto`, what an edit touches; `full`, everything from fresh noise; or `X0,Y0,X1,Y1`,
    /// what an edit touches and a rectangle (ego frame, m; give it a strength above 0).
    #[arg(long, value_name = "REGION", allow_hyphen_values = true)]
    pub(super) region: Option<RegionArg>,
    /// Number of fixed-point updates per inversion step.
    #[arg(long, value_name = "N")]
    pub(super) inversion_iterations: Option<u32>,
    /// Inpaint the region from fresh noise at this share of the steps, 0 to 1: 1 keeps nothing of what was there; 0, the
    /// default, starts from the noise that its source comes from.
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    pub(super) strength: f64,
    /// Compute every token, not only those around an edit.
    #[arg(long)]
    pub(super) dense: bool,
    /// A preset of the measured trade: `draft`, `balanced`, `careful` or another that `sceneloom trade` names; the
    /// options beside it go first.
    #[arg(long, value_name = "PRESET")]
    pub(super) quality: Option<String>,
    /// In what the network's products are computed: f32, or int8, which is faster where the machine has AVX-512 VNNI.
    #[arg(long, value_parser = ["f32", "int8"])]
    pub(super) precision: Option<String>,
    /// Steps in which what the coarse latent decodes to is refined, down to single voxels; 0 leaves it.
    #[arg(long, value_name = "N")]
    pub(super) fine_steps: Option<u32>,
    /// Leave out the corrections of the networks' output: placed boxes, painted ground, inventions, what hangs, holes.
    #[arg(long)]
    pub(super) raw: bool,
}

impl Gen {
    /// The networks that a generation takes. Errors in one line if the folder of weights lacks or damages a network
    /// that was asked for by name.
    pub(super) fn models(&self, weights: &Weights) -> anyhow::Result<Arc<OccModels>> {
        let models = OccModels::open(weights.folder.as_deref())?;
        if let (Some(n @ 1..), None, Some(folder)) = (self.fine_steps, &models.refiner, &weights.folder) {
            anyhow::bail!(
                "--fine-steps {n}: {} has no refiner.safetensors, expected it beside the other weights",
                folder.display()
            );
        }
        Ok(models)
    }

    pub(super) fn params(&self, default: GenParams) -> anyhow::Result<GenParams> {
        let default = match &self.quality {
            Some(name) => {
                let presets = Presets::bundled();
                let Some(preset) = presets.named(name) else {
                    let names: Vec<&str> = presets.all.iter().map(|s| s.name.as_str()).collect();
                    anyhow::bail!("--quality {name}: expected one of {}", names.join(", "));
                };
                preset.knobs.on(default)
            }
            None => default,
        };
        Ok(GenParams {
            steps: self.steps.unwrap_or(default.steps),
            solver: self.solver.unwrap_or(default.solver),
            guidance: self.guidance.unwrap_or(default.guidance),
            guidance_rescale: self.guidance_rescale.unwrap_or(default.guidance_rescale),
            named: ChosenDensities {
                vegetation: self.vegetation,
                building: self.buildings,
                clutter: self.clutter,
                completeness: self.completeness,
            }
            .or_else(&default.named),
            seed: self.seed,
            region: match self.region {
                Some(RegionArg::Full) => RegionMode::Full,
                Some(_) => RegionMode::Auto,
                None => default.region,
            },
            inpaint: match &self.region {
                Some(RegionArg::Rect(mask)) => mask.clone(),
                _ => default.inpaint.clone(),
            },
            inversion_iterations: self.inversion_iterations.unwrap_or(default.inversion_iterations),
            fine_steps: self.fine_steps.unwrap_or(default.fine_steps),
            strength: self.strength,
            keep_objects: !self.raw,
            local: !self.dense && default.local,
            precision: match self.precision.as_deref() {
                Some("int8") => Precision::Int8,
                Some(_) => Precision::F32,
                None => default.precision,
            },
            ..default
        })
    }
}

/// Why a command ends other than well.
pub(super) enum Stop {
    /// It ran, and what was checked fell short: exit 1.
    Short(String),
    /// Bad input or arguments: one line, exit 2.
    Bad(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Stop {
    fn from(error: E) -> Self {
        Stop::Bad(error.into())
    }
}

pub(super) type CommandResult = Result<(), Stop>;

/// Which moment of a clip a command looks at.
#[derive(clap::Args)]
pub struct Moment {
    /// Moment of a scene that lasts, s; the one that the file shows if left out.
    #[arg(long = "at", value_name = "S", allow_negative_numbers = true)]
    at_s: Option<f64>,
}

impl Moment {
    /// The scene at that moment. Errors in one line if it has no such moment.
    pub fn apply_to(&self, scene: scene::Scene) -> anyhow::Result<scene::Scene> {
        let Some(at_s) = self.at_s else {
            return Ok(scene);
        };
        let length_s = scene.clip().length_s;
        // Written so that NaN fails too.
        if !(0.0..=length_s).contains(&at_s) {
            anyhow::bail!("--at is {at_s}, expected a moment of 0 to {length_s} s");
        }
        Ok(scene.at(at_s))
    }
}
