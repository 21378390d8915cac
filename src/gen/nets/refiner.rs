//! Refinement by diffusion: generates the fine latent (100x100x16) of an occupancy from the decoded result of its
//! coarse latent. Predicts v from a noisy fine latent, the fine latents of the coarse result's labels and of the draft,
//! the coarse latent and a timestep. Twin of `training/models/refiner.py`.

use std::sync::{Arc, OnceLock};

use serde::Deserialize;

use super::encoder::{EncoderLevel, PIECE};
use super::occ_dit::timestep_embedding;
use super::{CHANNELS, ModelError, OccVae, check_finite, check_length, fine_file};
use nn::map::{CellRect, FeatureMap};
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// File name of the weights.
pub const FILE: &str = "refiner.safetensors";

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RefinerConfig {
    /// Numbers of a fine latent cell.
    pub latent: usize,
    /// Numbers of a coarse one.
    pub coarse: usize,
    /// Channels at 0.8 and 1.6 m.
    pub widths: [usize; 2],
    /// Kernels of each level's blocks; the finer level is passed twice.
    pub kernels: [Vec<usize>; 2],
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
}

impl RefinerConfig {
    fn check(&self) -> Result<(), String> {
        let expected =
            |name: &str, range: &str, found: String| Err(format!("{name}: expected {range}, found {found}"));
        if self.coarse != CHANNELS {
            return expected("coarse", &CHANNELS.to_string(), self.coarse.to_string());
        }
        for (name, sizes) in [("widths", &self.widths[..]), ("latent", &[self.latent])] {
            if let Some(bad) = sizes.iter().find(|w| !(1..=4096).contains(*w)) {
                return expected(name, "1 to 4096", bad.to_string());
            }
        }
        if let Some(bad) = self.kernels.iter().flatten().find(|k| ![1, 3].contains(*k)) {
            return expected("kernels", "1 or 3", bad.to_string());
        }
        if !(2..=4096).contains(&self.frequencies) || !self.frequencies.is_multiple_of(2) {
            return expected(
                "frequencies",
                "an even number up to 4096",
                self.frequencies.to_string(),
            );
        }
        Ok(())
    }
}

/// The network with its weights, on a backend, and the fine VAE whose latents it knows.
pub struct Refiner<B: Ops = Cpu> {
    /// Labels to fine latents and back.
    pub vae: OccVae<B>,
    /// Hash of both files.
    pub hash: u64,
    config: RefinerConfig,
    ops: B,
    stem: B::Linear,
    hint: B::Linear,
    time1: B::Linear,
    time2: B::Linear,
    tell: [B::Linear; 3],
    enter: EncoderLevel<B>,
    down: B::Linear,
    middle: EncoderLevel<B>,
    up: B::Linear,
    leave: EncoderLevel<B>,
    norm: B::Norm,
    head: B::Linear,
}

/// Latents of a window that are to be refined.
pub struct Rough<'a> {
    /// Fine latents of the coarse result's labels, `[x][y][16]`.
    pub fine: &'a [f32],
    /// Fine latents of the draft that was asked for; all 0 where it is hidden.
    pub told: &'a [f32],
    /// Coarse latents, `[x][y][8]`.
    pub coarse: &'a [f32],
    /// Which coarse cells these are.
    pub window: CellRect,
}

impl Refiner {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<Refiner>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let bytes = assets::weights::REFINER;
        let net = Self::new(WeightFile::parse(FILE, bytes)?, fine_file()?)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }

    /// Loads the network onto the processor. Takes all tensors of the file; refuses one that is missing, misshapen, not
    /// finite or unknown, and another fine VAE than the one that it was trained with.
    pub fn new(file: WeightFile<'_>, fine: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file, fine)
    }
}

impl<B: Ops + Clone> Refiner<B> {
    /// Loads the network onto a backend; otherwise as [`Refiner::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>, fine: WeightFile<'_>) -> Result<Self, WeightsError> {
        let (knows, name) = (file.metadata("fine"), fine.metadata("name"));
        if knows.is_some() && knows != name {
            let [knows, name] = [knows, name].map(|n| n.unwrap_or("none").to_owned());
            let reason = format!(
                "expected {knows}, the fine VAE it was trained with, found {name} in {}",
                fine.name()
            );
            return Err(file.config_error("fine", reason));
        }
        let hash = file.hash() ^ fine.hash().rotate_left(1);
        let vae = OccVae::on(ops.clone(), fine)?;
        let config: RefinerConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        if config.latent != vae.config().latent {
            let (found, expected) = (config.latent, vae.config().latent);
            let reason = format!("latent: expected {expected} as in the fine VAE, found {found}");
            return Err(file.config_error("config", reason));
        }
        let ([fine, wide], latent) = (config.widths, config.latent);
        let w = &mut file;
        let mut linear = |name: &str, sizes, tail: &[usize]| ops.linear(w, name, sizes, tail);
        let (stem, hint) = (
            linear("stem", [3 * latent, fine], &[1, 1])?,
            linear("hint", [config.coarse, wide], &[1, 1])?,
        );
        let (time1, time2) = (
            linear("time1", [config.frequencies, wide], &[])?,
            linear("time2", [wide, wide], &[])?,
        );
        let tell = [
            linear("tell.0", [wide, fine], &[])?,
            linear("tell.1", [wide, wide], &[])?,
            linear("tell.2", [wide, fine], &[])?,
        ];
        let (down, up) = (
            linear("down", [4 * fine, wide], &[1, 1])?,
            linear("up", [wide, 4 * fine], &[1, 1])?,
        );
        let net = Self {
            head: linear("head", [fine, latent], &[1, 1])?,
            stem,
            hint,
            time1,
            time2,
            tell,
            enter: EncoderLevel::new(&ops, w, "enter", fine, &config.kernels[0])?,
            down,
            middle: EncoderLevel::new(&ops, w, "middle", wide, &config.kernels[1])?,
            up,
            leave: EncoderLevel::new(&ops, w, "leave", fine, &config.kernels[0])?,
            norm: ops.load_norm(w, "norm", fine)?,
            ops,
            config,
            vae,
            hash,
        };
        file.finish()?;
        Ok(net)
    }

    /// v for the noisy fine latents `x` of a window, as if nothing were around it, at training step `t` (0 to 999, fractions allowed).
    pub fn forward(&self, x: &[f32], t: f32, rough: &Rough<'_>) -> Result<Vec<f32>, ModelError> {
        let (rows, columns, latent) = (
            2 * rough.window.rows,
            2 * rough.window.columns,
            self.config.latent,
        );
        check_length("state", x.len(), rows * columns * latent)?;
        check_length("rough latent", rough.fine.len(), x.len())?;
        check_length("told latent", rough.told.len(), x.len())?;
        check_length("coarse latent", rough.coarse.len(), rows * columns / 4 * CHANNELS)?;
        let inputs = [
            ("state", x),
            ("rough latent", rough.fine),
            ("told latent", rough.told),
            ("coarse latent", rough.coarse),
        ];
        for (what, values) in inputs {
            check_finite(what, values)?;
        }
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        let mut features = Vec::with_capacity(3 * x.len());
        for place in (0..x.len()).step_by(latent) {
            [x, rough.fine, rough.told]
                .iter()
                .for_each(|part| features.extend_from_slice(&part[place..place + latent]));
        }
        let ops = &self.ops;
        let time = ops.vector(timestep_embedding(t, self.config.frequencies))?;
        let time = ops.silu(ops.apply(&self.time1, &time, 1)?)?;
        let time = ops.silu(ops.apply(&self.time2, &time, 1)?)?;
        let told = |i: usize| ops.apply(&self.tell[i], &time, 1);

        let features = ops.upload(FeatureMap {
            data: features,
            rows,
            columns,
            width: 3 * latent,
        })?;
        let hint = ops.upload(FeatureMap {
            data: rough.coarse.to_vec(),
            rows: rough.window.rows,
            columns: rough.window.columns,
            width: CHANNELS,
        })?;
        let map = ops.add(ops.apply(&self.stem, &features, PIECE)?, &told(0)?)?;
        let map = self.enter.apply(ops, map)?;
        let coarser = ops.apply(&self.down, &ops.fold(&map)?, PIECE)?;
        let coarser = ops.add(coarser, &ops.apply(&self.hint, &hint, PIECE)?)?;
        let coarser = self.middle.apply(ops, ops.add(coarser, &told(1)?)?)?;
        let out = ops.unfold(&ops.apply(&self.up, &coarser, PIECE)?)?;
        let out = ops.add(ops.add(out, &map)?, &told(2)?)?;
        let normed = ops.norm(&self.norm, self.leave.apply(ops, out)?)?;
        let v = ops.download(ops.apply(&self.head, &normed, PIECE)?)?.data;
        check_finite("predicted v", &v)?;
        Ok(v)
    }
}
