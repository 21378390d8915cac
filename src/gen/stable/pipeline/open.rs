//! Opens the folders of a model.

use std::path::Path;

use serde::Deserialize;

use super::Pipeline;
use super::checks;
use crate::config::{
    ControlConfig, MpiConfig, SchedulerConfig, TextConfig, UnetConfig, VaeConfig, read_json,
};
use crate::control::{ControlNet, MpiEncoder};
use crate::text::{TextEncoder, Words};
use crate::unet::Unet;
use crate::vae::Vae;
use crate::weights::Weights;
use crate::{Folders, Machine, StableError};

/// Largest size of `model_index.json`, bytes.
const MOST_INDEX: u64 = 1 << 20;

#[derive(Deserialize)]
struct ModelIndex {
    #[serde(rename = "_class_name")]
    class: String,
}

/// A network's configuration and weights.
struct ConfiguredWeights<C> {
    config: C,
    weights: Weights,
}

impl<C> ConfiguredWeights<C> {
    fn read(
        folder: &Path,
        config: impl FnOnce(&Path) -> Result<C, StableError>,
    ) -> Result<Self, StableError> {
        Ok(Self {
            config: config(&folder.join("config.json"))?,
            weights: Weights::of_folder(folder)?,
        })
    }
}

/// All parts of a model, checked before any weight is read.
struct Parts {
    words: Words,
    scheduler: SchedulerConfig,
    text: ConfiguredWeights<TextConfig>,
    vae: ConfiguredWeights<VaeConfig>,
    unet: ConfiguredWeights<UnetConfig>,
    controls: Vec<ConfiguredWeights<ControlConfig>>,
    mpi: Option<ConfiguredWeights<MpiConfig>>,
}

impl Parts {
    fn read(folders: &Folders) -> Result<Self, StableError> {
        let base = &folders.base;
        check_index(&base.join("model_index.json"))?;
        let controls = folders.controls.iter();
        let mpi = folders.mpi.as_ref();
        let parts = Self {
            scheduler: SchedulerConfig::read(&base.join("scheduler/scheduler_config.json"))?,
            words: Words::open(&base.join("tokenizer"))?,
            text: ConfiguredWeights::read(&base.join("text_encoder"), TextConfig::read)?,
            vae: ConfiguredWeights::read(&base.join("vae"), VaeConfig::read)?,
            unet: ConfiguredWeights::read(&folders.unet, UnetConfig::read)?,
            controls: controls
                .map(|folder| ConfiguredWeights::read(folder, ControlConfig::read))
                .collect::<Result<_, _>>()?,
            mpi: mpi
                .map(|folder| ConfiguredWeights::read(folder, MpiConfig::read))
                .transpose()?,
        };
        parts.check()?;
        Ok(parts)
    }

    /// Fails unless the parts fit each other, and weights fit their configurations.
    fn check(&self) -> Result<(), StableError> {
        let unet = &self.unet.config;
        checks::fit_text(&self.words, &self.text.config, unet)?;
        checks::fit_latents(&self.vae.config, unet)?;
        for control in &self.controls {
            checks::fit_control(&control.config, unet)?;
            ControlNet::check(&control.config, &control.weights)?;
        }
        if let Some(mpi) = &self.mpi {
            checks::fit_mpi(&mpi.config, unet)?;
            MpiEncoder::check(&mpi.config, &mpi.weights)?;
        }
        TextEncoder::check(&self.text.config, &self.text.weights)?;
        Vae::check(&self.vae.config, &self.vae.weights)?;
        Unet::check(unet, &self.unet.weights)
    }
}

impl Pipeline {
    /// Checks that the folders hold a model that can be opened, by configurations, names, shapes and types: quick,
    /// whatever the size. Errors in one line that names the file.
    pub fn check(folders: &Folders) -> Result<(), StableError> {
        Parts::read(folders).map(|_| ())
    }

    /// Opens all parts of a model, after [`check`](Self::check). The autoencoder and the text encoder always compute in
    /// 32 bits. Errors in one line that names the file.
    pub fn open(folders: &Folders, machine: &Machine) -> Result<Self, StableError> {
        let parts = Parts::read(folders)?;
        let exact = machine.exact();
        let controls = parts.controls.into_iter();
        let controls = controls.map(|part| ControlNet::load(part.config, &part.weights, machine));
        let mpi = parts.mpi.as_ref();
        let mpi = mpi.map(|part| MpiEncoder::load(&part.config, &part.weights, machine));
        Ok(Self {
            words: parts.words,
            text: TextEncoder::load(parts.text.config, &parts.text.weights, &exact)?,
            vae: Vae::load(parts.vae.config, &parts.vae.weights, &exact)?,
            controls: controls.collect::<Result<_, _>>()?,
            control_names: folders.controls.iter().map(|f| name(f)).collect(),
            mpi: mpi.transpose()?,
            unet: Unet::load(parts.unet.config, &parts.unet.weights, machine)?,
            scheduler: parts.scheduler,
            machine: machine.clone(),
        })
    }
}

/// Last part of a path.
fn name(folder: &Path) -> String {
    let name = folder.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Fails unless the folder holds a Stable Diffusion of the first two generations.
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
