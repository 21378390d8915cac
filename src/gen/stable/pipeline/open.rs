//! Opens the folders of a model.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::Pipeline;
use super::checks;
use crate::config::{ControlConfig, MpiConfig, SchedulerConfig, TextConfig, UnetConfig, VaeConfig, read_json};
use crate::control::{ControlNet, MpiEncoder};
use crate::text::{TextEncoder, Words};
use crate::unet::Unet;
use crate::vae::Vae;
use crate::weights::Weights;
use crate::{Machine, StableError};

/// Most bytes of `model_index.json`.
const MOST_INDEX: u64 = 1 << 20;

/// Where the parts of a model lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folders {
    /// With `model_index.json`, `text_encoder`, `tokenizer`, `vae` and `scheduler`.
    pub base: PathBuf,
    /// With `config.json` and the weights of the UNet.
    pub unet: PathBuf,
    /// One for each ControlNet.
    pub controls: Vec<PathBuf>,
    /// Of the encoder of multi-plane images that is added behind the first convolution, as in SyntheOcc's paper.
    pub mpi: Option<PathBuf>,
}

impl Folders {
    /// All that a folder holds: `unet`, `controlnet` and whatever else begins with it, in the order of their names, and `mpi_encoder`.
    /// Parts that lie elsewhere, as SyntheOcc's UNet and ControlNet do, can be put in their place.
    pub fn of(base: &Path) -> Self {
        let entries = std::fs::read_dir(base).into_iter().flatten().flatten();
        let is_control = |name: &str| name.starts_with("controlnet");
        let mut controls: Vec<PathBuf> = entries
            .filter(|e| is_control(&e.file_name().to_string_lossy()))
            .map(|e| e.path())
            .filter(|path| path.join("config.json").is_file())
            .collect();
        controls.sort();
        let mpi = base.join("mpi_encoder");
        Self {
            base: base.to_owned(),
            unet: base.join("unet"),
            controls,
            mpi: mpi.is_dir().then_some(mpi),
        }
    }
}

#[derive(Deserialize)]
struct ModelIndex {
    #[serde(rename = "_class_name")]
    class: String,
}

impl Pipeline {
    /// Opens all parts of a model. Every configuration, and every name, shape and type of a tensor is checked before weights are
    /// read. The autoencoder and the text encoder always compute in 32 bits. Errors in one line that names the file.
    pub fn open(folders: &Folders, machine: &Machine) -> Result<Self, StableError> {
        let base = &folders.base;
        check_index(&base.join("model_index.json"))?;
        let config = "config.json";
        let scheduler = SchedulerConfig::read(&base.join("scheduler/scheduler_config.json"))?;
        let [text, vae] = ["text_encoder", "vae"].map(|name| base.join(name));
        let text_config = TextConfig::read(&text.join(config))?;
        let vae_config = VaeConfig::read(&vae.join(config))?;
        let unet_config = UnetConfig::read(&folders.unet.join(config))?;
        let controls = folders.controls.iter();
        let control_configs: Vec<ControlConfig> = controls
            .map(|folder| ControlConfig::read(&folder.join(config)))
            .collect::<Result<_, _>>()?;
        let mpi_config = folders.mpi.as_ref().map(|folder| MpiConfig::read(&folder.join(config)));
        let mpi_config = mpi_config.transpose()?;
        let words = Words::open(&base.join("tokenizer"))?;
        checks::fit_text(&words, &text_config, &unet_config)?;
        checks::fit_latents(&vae_config, &unet_config)?;
        for control in &control_configs {
            checks::fit_control(control, &unet_config)?;
        }
        checks::fit_mpi(mpi_config.as_ref(), &unet_config)?;
        // All headers first: what is not there at all is said before anything is read.
        let weights = |folder: &PathBuf| Weights::of_folder(folder);
        let (text_weights, vae_weights) = (weights(&text)?, weights(&vae)?);
        let unet_weights = weights(&folders.unet)?;
        let control_weights = folders.controls.iter().map(weights).collect::<Result<Vec<_>, _>>()?;
        let mpi_weights = folders.mpi.as_ref().map(weights).transpose()?;
        let exact = machine.exact();
        let controls = control_configs.into_iter().zip(&control_weights);
        let controls = controls.map(|(config, weights)| ControlNet::load(config, weights, machine));
        let mpi = mpi_config.iter().zip(&mpi_weights).next();
        let mpi = mpi.map(|(config, weights)| MpiEncoder::load(config, weights, machine));
        Ok(Self {
            words,
            text: TextEncoder::load(text_config, &text_weights, &exact)?,
            vae: Vae::load(vae_config, &vae_weights, &exact)?,
            controls: controls.collect::<Result<_, _>>()?,
            control_names: folders.controls.iter().map(|f| name(f)).collect(),
            mpi: mpi.transpose()?,
            unet: Unet::load(unet_config, &unet_weights, machine)?,
            scheduler,
            machine: machine.clone(),
        })
    }
}

/// Last part of a path.
fn name(folder: &Path) -> String {
    let name = folder.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Fails unless the folder is that of a Stable Diffusion of the first two generations.
fn check_index(path: &Path) -> Result<(), StableError> {
    let class = read_json::<ModelIndex>(path, MOST_INDEX)?.class;
    let later = ["XL", "3", "Cascade", "Upscale", "Depth2Img"];
    if class.starts_with("StableDiffusion") && !later.iter().any(|l| class.contains(l)) {
        return Ok(());
    }
    Err(StableError::Config {
        path: path.to_owned(),
        reason: format!("_class_name is {class:?}, expected a pipeline of Stable Diffusion 1 or 2"),
    })
}
