//! Diffusion that refines: from what the coarse latent decodes to, the fine latent (100x100x16) of what it may have been. v from a
//! noisy fine latent, those of the coarse result's labels and of the draft, the coarse latent and a timestep. Twin of `training/models/refiner.py`.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use serde::Deserialize;

use super::encoder::{Level, PIECE, through};
use super::occ_dit::timestep_embedding;
use super::{CHANNELS, ModelError, OccVae, check_finite, check_length, fine_file};
use nn::kernels;
use nn::layers::{Linear, Norm};
use nn::map::{Map, Window};
use nn::weights::{WeightFile, WeightsError};

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

/// The network with its weights, and the fine VAE whose latents it knows.
pub struct Refiner {
    /// Labels to fine latents and back.
    pub vae: OccVae,
    /// Names both files.
    pub hash: u64,
    config: RefinerConfig,
    stem: Linear,
    hint: Linear,
    time1: Linear,
    time2: Linear,
    tell: [Linear; 3],
    enter: Level,
    down: Linear,
    middle: Level,
    up: Linear,
    leave: Level,
    norm: Norm,
    head: Linear,
}

/// What is refined: latents of a window.
pub struct Rough<'a> {
    /// Fine latents of the coarse result's labels, `[x][y][16]`.
    pub fine: &'a [f32],
    /// Fine latents of the draft that was asked for; all 0 where that is hidden.
    pub told: &'a [f32],
    /// Coarse latents, `[x][y][8]`.
    pub coarse: &'a [f32],
    /// Which coarse cells these are.
    pub window: Window,
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

    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown, and another fine VAE than the
    /// one that it was trained with.
    pub fn new(mut file: WeightFile<'_>, fine: WeightFile<'_>) -> Result<Self, WeightsError> {
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
        let vae = OccVae::new(fine)?;
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
        let told = |w: &mut WeightFile<'_>, i: usize, to| Linear::new(w, &format!("tell.{i}"), wide, to, &[]);
        let net = Self {
            stem: Linear::new(w, "stem", 3 * latent, fine, &[1, 1])?,
            hint: Linear::new(w, "hint", config.coarse, wide, &[1, 1])?,
            time1: Linear::new(w, "time1", config.frequencies, wide, &[])?,
            time2: Linear::new(w, "time2", wide, wide, &[])?,
            tell: [told(w, 0, fine)?, told(w, 1, wide)?, told(w, 2, fine)?],
            enter: Level::new(w, "enter", fine, &config.kernels[0])?,
            down: Linear::new(w, "down", 4 * fine, wide, &[1, 1])?,
            middle: Level::new(w, "middle", wide, &config.kernels[1])?,
            up: Linear::new(w, "up", wide, 4 * fine, &[1, 1])?,
            leave: Level::new(w, "leave", fine, &config.kernels[0])?,
            norm: Norm::new(w, "norm", fine)?,
            head: Linear::new(w, "head", fine, latent, &[1, 1])?,
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
        let mut time = self.time1.vector(&timestep_embedding(t, self.config.frequencies));
        time.iter_mut().for_each(|v| *v = kernels::silu(*v));
        let mut time = self.time2.vector(&time);
        time.iter_mut().for_each(|v| *v = kernels::silu(*v));
        let [entered, between, left] = self.tell.each_ref().map(|tell| tell.vector(&time));

        let mut map = Map {
            data: self.stem.parallel(&features, PIECE),
            rows,
            columns,
            width: self.config.widths[0],
        };
        add_to_rows(&mut map, &entered);
        self.enter.apply(&mut map);
        let mut coarser = through(&self.down, &map.fold());
        add(&mut coarser, &self.hint.parallel(rough.coarse, PIECE));
        add_to_rows(&mut coarser, &between);
        self.middle.apply(&mut coarser);
        let mut out = through(&self.up, &coarser).unfold();
        add(&mut out, &map.data);
        add_to_rows(&mut out, &left);
        self.leave.apply(&mut out);
        let mut normed = vec![0.0; out.data.len()];
        self.norm.rows(&out.data, &mut normed);
        let v = self.head.parallel(&normed, PIECE);
        check_finite("predicted v", &v)?;
        Ok(v)
    }
}

fn add(map: &mut Map, values: &[f32]) {
    map.data.iter_mut().zip(values).for_each(|(m, v)| *m += v);
}

fn add_to_rows(map: &mut Map, adds: &[f32]) {
    let rows = map.data.par_chunks_exact_mut(map.width);
    rows.for_each(|row| row.iter_mut().zip(adds).for_each(|(v, a)| *v += a));
}
