//! Picture VAE: sRGB to a latent of 8 numbers per 8x8 px and back, in levels of 2, 4 and 8 px.

use std::path::Path;

use rayon::prelude::*;

use super::{CELL, PictureVaeConfig, check_kind, check_sides};
use crate::encoder::{EncoderLevel, PIECE, levels, steps};
use crate::{ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// Red, green, blue.
const COLOURS: usize = 3;
/// Numbers of the folded square of 2x2 px at the first and the last layer.
const SQUARE: usize = 4 * COLOURS;

/// The network with its weights, on a backend.
pub struct PictureVae<B: Ops = Cpu> {
    ops: B,
    config: PictureVaeConfig,
    stem: B::Linear,
    encoder: Vec<EncoderLevel<B>>, // finest first
    down: Vec<B::Linear>,
    encoder_norm: B::Norm,
    encoder_head: B::Linear, // mean, then log variance
    decoder_stem: B::Linear,
    decoder: Vec<EncoderLevel<B>>, // coarsest first
    up: Vec<B::Linear>,
    decoder_norm: B::Norm,
    decoder_head: B::Linear,
    latent_mean: Vec<f32>,
    latent_std: Vec<f32>,
}

impl PictureVae {
    /// Loads the network of a file onto the processor. Errors name the file, in one line.
    pub fn load(path: &Path) -> Result<Self, WeightsError> {
        Self::new(WeightFile::parse(
            &path.display().to_string(),
            &weights::read(path)?,
        )?)
    }

    /// Loads the network onto the processor. Takes all tensors of the file; refuses one that is missing, misshapen, not
    /// finite or unknown.
    pub fn new(file: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file)
    }
}

impl<B: Ops> PictureVae<B> {
    /// Loads the network onto a backend; otherwise as [`PictureVae::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        check_kind(&file, "picture_vae")?;
        let config: PictureVaeConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let ([fine, middle, coarse], latent) = (config.widths, config.latent);
        let (w, point) = (&mut file, &[1, 1]);
        let vae = Self {
            stem: ops.linear(w, "stem", [SQUARE, fine], point)?,
            encoder: levels(&ops, w, "encoder", &config.widths, &config.encoder_kernels)?,
            down: steps(&ops, w, "down", vec![[4 * fine, middle], [4 * middle, coarse]])?,
            encoder_norm: ops.load_norm(w, "encoder_norm", coarse)?,
            encoder_head: ops.linear(w, "encoder_head", [coarse, 2 * latent], point)?,
            decoder_stem: ops.linear(w, "decoder_stem", [latent, coarse], point)?,
            decoder: levels(
                &ops,
                w,
                "decoder",
                &[coarse, middle, fine],
                &config.decoder_kernels,
            )?,
            up: steps(&ops, w, "up", vec![[coarse, 4 * middle], [middle, 4 * fine]])?,
            decoder_norm: ops.load_norm(w, "decoder_norm", fine)?,
            decoder_head: ops.linear(w, "decoder_head", [fine, SQUARE], point)?,
            latent_mean: w.take("latent_mean", &[latent])?,
            latent_std: w.take("latent_std", &[latent])?,
            config,
            ops,
        };
        if let Some(i) = vae.latent_std.iter().position(|s| *s < 1e-6) {
            let found = vae.latent_std[i];
            let reason = format!("latent_std {i}: expected more than 1e-6, found {found}");
            return Err(file.config_error("config", reason));
        }
        file.finish()?;
        Ok(vae)
    }

    /// Sizes of the network.
    pub fn config(&self) -> &PictureVaeConfig {
        &self.config
    }

    /// Pictures `[n][height][width][3]`, sRGB from -1 to 1, to mean latents `[n][height / 8][width / 8][8]` of zero mean and
    /// unit spread over the training set. Height and width are multiples of 8 px. Errors if the sizes do not fit or a number
    /// is not finite.
    pub fn encode(&self, pictures: &[f32], [height, width]: [usize; 2]) -> Result<Vec<f32>, ModelError> {
        check_sides([height, width], CELL, "a multiple of 8 px up to 8192")?;
        let size = height * width * COLOURS;
        check_length("pictures", pictures.len(), whole(pictures.len(), size))?;
        check_finite("picture", pictures)?;
        let latent = self.config.latent;
        let each = pictures.par_chunks(size).map(|picture| {
            let mut moments = self.moments(FeatureMap {
                data: picture.to_vec(),
                rows: height,
                columns: width,
                width: COLOURS,
            })?;
            moments = moments
                .chunks_exact(2 * latent)
                .flat_map(|cell| {
                    let of = cell.iter().zip(&self.latent_mean).zip(&self.latent_std);
                    of.map(|((value, mean), std)| (value - mean) / std)
                })
                .collect();
            check_finite("encoded latent", &moments)?;
            Ok(moments)
        });
        Ok(each.collect::<Result<Vec<_>, ModelError>>()?.concat())
    }

    /// Mean and log variance of every cell of a picture.
    fn moments(&self, picture: FeatureMap) -> Result<Vec<f32>, ModelError> {
        let ops = &self.ops;
        let squares = ops.fold(&ops.upload(picture)?)?;
        let mut map = self.encoder[0].apply(ops, ops.apply(&self.stem, &squares, PIECE)?)?;
        for (down, level) in self.down.iter().zip(&self.encoder[1..]) {
            map = level.apply(ops, ops.apply(down, &ops.fold(&map)?, PIECE)?)?;
        }
        let normed = ops.norm(&self.encoder_norm, map)?;
        let moments = ops.apply(&self.encoder_head, &normed, PIECE)?;
        Ok(ops.download(moments)?.data)
    }

    /// Latents `[n][rows][columns][8]` to pictures `[n][8 rows][8 columns][3]`, sRGB from -1 to 1. Errors if the sizes do not
    /// fit or a number is not finite.
    pub fn decode(&self, latents: &[f32], [rows, columns]: [usize; 2]) -> Result<Vec<f32>, ModelError> {
        let size = rows * columns * self.config.latent;
        if size == 0 {
            return Err(ModelError::OutOfRange {
                what: "number of latent cells",
                found: 0,
                expected: "1 or more",
            });
        }
        check_length("latents", latents.len(), whole(latents.len(), size))?;
        check_finite("latent", latents)?;
        let each = latents.par_chunks(size).map(|latent| {
            let cells = latent.chunks_exact(self.config.latent);
            let scaled = cells.flat_map(|cell| {
                let of = cell.iter().zip(&self.latent_std).zip(&self.latent_mean);
                of.map(|((value, std), mean)| value * std + mean)
            });
            self.draw(FeatureMap {
                data: scaled.collect(),
                rows,
                columns,
                width: self.config.latent,
            })
        });
        Ok(each.collect::<Result<Vec<_>, ModelError>>()?.concat())
    }

    /// The picture of a latent that is not normalised.
    fn draw(&self, latent: FeatureMap) -> Result<Vec<f32>, ModelError> {
        let ops = &self.ops;
        let cells = ops.upload(latent)?;
        let mut map = self.decoder[0].apply(ops, ops.apply(&self.decoder_stem, &cells, PIECE)?)?;
        for (up, level) in self.up.iter().zip(&self.decoder[1..]) {
            map = level.apply(ops, ops.unfold(&ops.apply(up, &map, PIECE)?)?)?;
        }
        let normed = ops.norm(&self.decoder_norm, map)?;
        let picture = ops.unfold(&ops.apply(&self.decoder_head, &normed, PIECE)?)?;
        let mut picture = ops.download(picture)?.data;
        check_finite("decoded picture", &picture)?;
        picture.iter_mut().for_each(|v| *v = v.clamp(-1.0, 1.0));
        Ok(picture)
    }
}

/// Rounds `length` up to a multiple of `size`, at least one.
fn whole(length: usize, size: usize) -> usize {
    length.next_multiple_of(size).max(size)
}
