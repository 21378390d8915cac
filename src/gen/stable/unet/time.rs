//! Embedding of a timestep.

use candle_core::Tensor;

use crate::config::UnetConfig;
use crate::layers::TransposedLinear;
use crate::weights::Names;
use crate::{Machine, StableError};

/// Longest wavelength of a sinusoid, in timesteps, over 2 pi.
const LONGEST: f64 = 10000.0;

/// Sinusoids, then two linear layers.
#[derive(Clone, Debug)]
pub(crate) struct TimeEmbedding {
    layers: [TransposedLinear; 2],
    width: usize,
    cosines_first: bool,
    shift: f64,
}

impl TimeEmbedding {
    /// Width of the embedding.
    pub fn width(config: &UnetConfig) -> usize {
        4 * config.block_out_channels[0]
    }

    pub fn load(names: &Names<'_>, config: &UnetConfig) -> Result<Self, StableError> {
        let (inner, width) = (config.block_out_channels[0], Self::width(config));
        Ok(Self {
            layers: [
                TransposedLinear::load(&names.at("linear_1"), inner, width)?,
                TransposedLinear::load(&names.at("linear_2"), width, width)?,
            ],
            width: inner,
            cosines_first: config.flip_sin_to_cos,
            shift: config.freq_shift,
        })
    }

    /// The embedding `[1, width]` of a training step, which may lie between two.
    pub fn forward(&self, t: f64, machine: &Machine) -> Result<Tensor, StableError> {
        let half = self.width / 2;
        let angle = |i: usize| t * (-LONGEST.ln() * i as f64 / (half as f64 - self.shift)).exp();
        let sines = (0..half).map(|i| angle(i).sin() as f32);
        let cosines = (0..half).map(|i| angle(i).cos() as f32);
        let all: Vec<f32> = match self.cosines_first {
            true => cosines.chain(sines).collect(),
            false => sines.chain(cosines).collect(),
        };
        let x = Tensor::from_vec(all, (1, self.width), &machine.device)?.to_dtype(machine.dtype)?;
        Ok(self.layers[1].forward(&self.layers[0].forward(&x)?.silu()?)?)
    }
}
