//! Conditions as pictures: ControlNet (Zhang et al. 2023, arXiv 2302.05543), and the planes of SyntheOcc (arXiv 2410.00337).

use candle_core::Tensor;

use crate::config::{ControlConfig, MpiConfig};
use crate::layers::Conv;
use crate::unet::{Down, Extra, NeighbourIndices, TimeEmbedding, UnetBottleneck, UnetLevels, told_to_each};
use crate::weights::{Names, Weights};
use crate::{Machine, StableError, wrong};

/// Encoder of multi-plane images: two 1x1 convolutions with a ReLU between, at the size of latents. A pixel is encoded
/// from its own planes alone.
pub struct MpiEncoder {
    layers: [Conv; 2],
    channels: usize,
    machine: Machine,
}

impl MpiEncoder {
    /// Loads the layers from weights named `position_encoder.0` and `position_encoder.2`. Errors if they do not fit the
    /// configuration.
    pub fn load(config: &MpiConfig, weights: &Weights, machine: &Machine) -> Result<Self, StableError> {
        let (channels, width) = (config.conditioning_channels, config.embedding_channels);
        weights.build(machine, &[], |names| {
            Self::from_weights(names, channels, width, machine)
        })
    }

    /// Checks that weights fit a configuration, by names, shapes and types alone. Errors list the first few that do
    /// not.
    pub fn check(config: &MpiConfig, weights: &Weights) -> Result<(), StableError> {
        let (channels, width) = (config.conditioning_channels, config.embedding_channels);
        weights.check(&[], |names| {
            Self::from_weights(names, channels, width, &Machine::cpu())
        })
    }

    fn from_weights(
        names: &Names<'_>,
        channels: usize,
        width: usize,
        machine: &Machine,
    ) -> Result<Self, StableError> {
        let names = names.at("position_encoder");
        Ok(Self {
            layers: [
                Conv::load_point(&names.at(0), channels, width)?,
                Conv::load_point(&names.at(2), width, width)?,
            ],
            channels,
            machine: machine.clone(),
        })
    }

    /// Channels of its input: the class ids of all planes, from the nearest to the farthest, as plain numbers, 0 for
    /// empty; the last channel is the first visible id.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Encodes `[n, channels, rows, columns]` to `[n, width, rows, columns]`.
    pub fn forward(&self, planes: &Tensor) -> Result<Tensor, StableError> {
        let planes = planes.to_dtype(self.machine.dtype)?;
        let y = self.layers[0].forward(&planes)?.relu()?;
        Ok(self.layers[1].forward(&y)?)
    }
}

/// Layers that bring the picture to the size of latents.
enum Embedding {
    /// Convolutions of stride 2, from pixels.
    Pixels { all: Vec<Conv> },
    /// Encoder of planes, which have that size already.
    Planes(MpiEncoder),
}

/// Half a UNet, whose outputs are added to the maps of a whole one.
pub struct ControlNet {
    config: ControlConfig,
    embedding: Embedding,
    time: TimeEmbedding,
    first: Conv,
    down: Vec<Down>,
    middle: UnetBottleneck,
    zeros: Vec<Conv>,
    zero_middle: Conv,
    machine: Machine,
}

impl ControlNet {
    /// Loads the network from weights; those of SyntheOcc have `controlnet_cond_embedding.position_encoder`. Errors if
    /// they do not fit the configuration.
    pub fn load(config: ControlConfig, weights: &Weights, machine: &Machine) -> Result<Self, StableError> {
        weights.build(machine, &[], |names| Self::from_weights(&config, names, machine))
    }

    /// Checks that weights fit a configuration, by names, shapes and types alone. Errors list the first few that do
    /// not.
    pub fn check(config: &ControlConfig, weights: &Weights) -> Result<(), StableError> {
        weights.check(&[], |names| Self::from_weights(config, names, &Machine::cpu()))
    }

    fn from_weights(
        config: &ControlConfig,
        names: &Names<'_>,
        machine: &Machine,
    ) -> Result<Self, StableError> {
        let unet = &config.unet;
        let levels = UnetLevels::from_config(unet);
        let (finest, coarsest) = (
            unet.block_out_channels[0],
            unet.block_out_channels[unet.block_out_channels.len() - 1],
        );
        let at = names.at("controlnet_cond_embedding");
        let embedding = if at.has("position_encoder.0.weight") {
            let planes = MpiEncoder::from_weights(&at, config.conditioning_channels, finest, machine)?;
            Embedding::Planes(planes)
        } else {
            let widths = &config.embedding;
            let mut all = vec![Conv::load(
                &at.at("conv_in"),
                config.conditioning_channels,
                widths[0],
            )?];
            for (i, pair) in widths.windows(2).enumerate() {
                let block = |j: usize| at.at("blocks").at(2 * i + j);
                all.push(Conv::load(&block(0), pair[0], pair[0])?);
                all.push(Conv::load_with(&block(1), [pair[0], pair[1]], 3, 2, 1)?);
            }
            all.push(Conv::load(&at.at("conv_out"), widths[widths.len() - 1], finest)?);
            Embedding::Pixels { all }
        };
        let kept = levels.kept().into_iter().enumerate();
        let zero = |(i, width): (usize, usize)| {
            Conv::load_point(&names.at("controlnet_down_blocks").at(i), width, width)
        };
        Ok(Self {
            embedding,
            time: TimeEmbedding::load(&names.at("time_embedding"), unet)?,
            first: Conv::load(&names.at("conv_in"), unet.in_channels, finest)?,
            down: levels.down(names)?,
            middle: levels.middle(names)?,
            zeros: kept.map(zero).collect::<Result<_, StableError>>()?,
            zero_middle: Conv::load_point(&names.at("controlnet_mid_block"), coarsest, coarsest)?,
            config: config.clone(),
            machine: machine.clone(),
        })
    }

    /// Sizes of the network.
    pub fn config(&self) -> &ControlConfig {
        &self.config
    }

    /// Pixels of its picture for each latent cell along a side: 1 if its input is planes.
    pub fn cell(&self) -> usize {
        match &self.embedding {
            Embedding::Planes(_) => 1,
            Embedding::Pixels { .. } => 1 << (self.config.embedding.len() - 1),
        }
    }

    /// Whether its input is planes of classes at the size of latents, not a picture from 0 to 1.
    pub fn takes_planes(&self) -> bool {
        matches!(self.embedding, Embedding::Planes(_))
    }

    /// Embeds the picture `[n, channels, height, width]`; the result serves all steps.
    pub fn embed(&self, picture: &Tensor) -> Result<Tensor, StableError> {
        let picture = match self.config.is_bgr {
            true => picture.flip(&[1])?,
            false => picture.clone(),
        };
        match &self.embedding {
            Embedding::Planes(encoder) => encoder.forward(&picture),
            Embedding::Pixels { all } => {
                let mut x = picture.to_dtype(self.machine.dtype)?;
                for (i, layer) in all.iter().enumerate() {
                    x = layer.forward(&x)?;
                    if i + 1 < all.len() {
                        x = x.silu()?;
                    }
                }
                Ok(x)
            }
        }
    }

    /// Values to add to the UNet's maps for noisy latents `[n, channels, rows, columns]` at training step `t`, times
    /// `scale`. `embedded` is the result of [`embed`](Self::embed). Errors if sizes do not fit.
    pub fn forward(
        &self,
        x: &Tensor,
        t: f64,
        context: &Tensor,
        embedded: &Tensor,
        scale: f64,
    ) -> Result<Extra, StableError> {
        let context = told_to_each(context, x.dim(0)?)?.to_dtype(self.machine.dtype)?;
        let time = self.time.forward(t, &self.machine)?;
        let around = NeighbourIndices::default();
        let x = self.first.forward(&x.to_dtype(self.machine.dtype)?)?;
        if x.dims() != embedded.dims() {
            let expected = format!("{:?}, that of the latents", x.dims());
            return Err(wrong(
                "size of an embedded condition",
                format!("{:?}", embedded.dims()),
                expected,
            ));
        }
        let mut x = (x + embedded)?;
        let mut kept = vec![x.clone()];
        for level in &self.down {
            x = level.forward(x, &time, &context, &around, &mut kept)?;
        }
        let x = self.middle.forward(&x, &time, &context, &around)?;
        let scaled = |(zero, x): (&Conv, &Tensor)| zero.forward(x)?.affine(scale, 0.0);
        let down = self.zeros.iter().zip(&kept).map(scaled);
        Ok(Extra {
            first: None,
            down: down.collect::<candle_core::Result<_>>()?,
            middle: Some(scaled((&self.zero_middle, &x))?),
        })
    }
}
