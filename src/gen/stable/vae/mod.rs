//! The autoencoder: pictures to latents and back. Kingma and Welling 2013; Esser et al. 2021 (arXiv 2012.09841).

mod coder;

use candle_core::Tensor;

use crate::config::VaeConfig;
use crate::layers::Conv;
use crate::weights::{Names, Weights};
use crate::{Machine, StableError, wrong};
use coder::{Decoder, VaeEncoder};

/// Smallest and largest log variance of a latent.
const LOG_VARIANCE: [f64; 2] = [-30.0, 20.0];

/// The autoencoder of pictures `[n, 3, height, width]`, sRGB from -1 to 1, and latents `[n, channels, rows, columns]`.
/// Latents are as the UNet sees them: multiplied by the scaling factor.
pub struct Vae {
    config: VaeConfig,
    pub(crate) encoder: VaeEncoder,
    quant: Conv,
    post_quant: Conv,
    decoder: Decoder,
}

impl Vae {
    /// Loads the network from weights. Errors if they do not fit the configuration.
    pub fn load(config: VaeConfig, weights: &Weights, machine: &Machine) -> Result<Self, StableError> {
        weights.build(machine, &[], |names| Self::from_weights(&config, names))
    }

    /// Checks that weights fit a configuration, by names, shapes and types alone. Errors list the first few that do
    /// not.
    pub fn check(config: &VaeConfig, weights: &Weights) -> Result<(), StableError> {
        weights.check(&[], |names| Self::from_weights(config, names))
    }

    fn from_weights(config: &VaeConfig, names: &Names<'_>) -> Result<Self, StableError> {
        let latent = config.latent_channels;
        Ok(Self {
            encoder: VaeEncoder::load(&names.at("encoder"), config)?,
            quant: Conv::load_point(&names.at("quant_conv"), 2 * latent, 2 * latent)?,
            post_quant: Conv::load_point(&names.at("post_quant_conv"), latent, latent)?,
            decoder: Decoder::load(&names.at("decoder"), config)?,
            config: config.clone(),
        })
    }

    /// Sizes of the network.
    pub fn config(&self) -> &VaeConfig {
        &self.config
    }

    /// Mean and log variance of latents, not scaled. Errors if a side is no multiple of a latent cell's pixels.
    pub fn moments(&self, pictures: &Tensor) -> Result<[Tensor; 2], StableError> {
        let (_, _, height, width) = pictures.dims4()?;
        let cell = self.config.cell();
        for side in [height, width] {
            if side == 0 || !side.is_multiple_of(cell) {
                return Err(wrong(
                    "side of a picture",
                    side,
                    format!("a multiple of {cell} px"),
                ));
            }
        }
        let moments = self.quant.forward(&self.encoder.forward(pictures)?)?;
        let latent = self.config.latent_channels;
        let [least, most] = LOG_VARIANCE;
        Ok([
            moments.narrow(1, 0, latent)?,
            moments.narrow(1, latent, latent)?.clamp(least, most)?,
        ])
    }

    /// Mean latents of pictures. Errors as [`moments`](Self::moments).
    pub fn encode(&self, pictures: &Tensor) -> Result<Tensor, StableError> {
        let [mean, _] = self.moments(pictures)?;
        Ok(mean.affine(self.config.scaling_factor, 0.0)?)
    }

    /// Pictures of latents, as the network gives them: not clamped to -1 and 1.
    pub fn decode(&self, latents: &Tensor) -> Result<Tensor, StableError> {
        let latents = latents.affine(1.0 / self.config.scaling_factor, 0.0)?;
        Ok(self.decoder.forward(&self.post_quant.forward(&latents)?)?)
    }
}
