//! A residual block of two convolutions.

use candle_core::{Result, Tensor};

use super::{Conv, GroupNorm, TransposedLinear};
use crate::StableError;
use crate::weights::Names;

/// x + convolution(silu(norm(convolution(silu(norm(x))) + time))); x passes through a 1x1 convolution if the channels
/// change.
#[derive(Clone, Debug)]
pub(crate) struct StableResidual {
    norms: [GroupNorm; 2],
    convolutions: [Conv; 2],
    time: Option<TransposedLinear>,
    shortcut: Option<Conv>,
}

impl StableResidual {
    /// Loads a block. `time` is the width of the timestep's embedding, if the block takes it.
    pub fn load(
        names: &Names<'_>,
        [inputs, outputs]: [usize; 2],
        time: Option<usize>,
        groups: usize,
        epsilon: f64,
    ) -> std::result::Result<Self, StableError> {
        let time = time.map(|width| TransposedLinear::load(&names.at("time_emb_proj"), width, outputs));
        let shortcut =
            (inputs != outputs).then(|| Conv::load_point(&names.at("conv_shortcut"), inputs, outputs));
        Ok(Self {
            norms: [
                GroupNorm::load(&names.at("norm1"), inputs, groups, epsilon)?,
                GroupNorm::load(&names.at("norm2"), outputs, groups, epsilon)?,
            ],
            convolutions: [
                Conv::load(&names.at("conv1"), inputs, outputs)?,
                Conv::load(&names.at("conv2"), outputs, outputs)?,
            ],
            time: time.transpose()?,
            shortcut: shortcut.transpose()?,
        })
    }

    /// Applies the block to a map, with the timestep's embedding `[1, width]`.
    pub fn forward(&self, x: &Tensor, time: Option<&Tensor>) -> Result<Tensor> {
        let mut y = self.convolutions[0].forward(&self.norms[0].forward(x)?.silu()?)?;
        if let (Some(layer), Some(time)) = (&self.time, time) {
            let told = layer.forward(&time.silu()?)?;
            let (batch, width) = told.dims2()?;
            y = y.broadcast_add(&told.reshape((batch, width, 1, 1))?)?;
        }
        let y = self.convolutions[1].forward(&self.norms[1].forward(&y)?.silu()?)?;
        match &self.shortcut {
            Some(shortcut) => shortcut.forward(x)? + y,
            None => x + y,
        }
    }
}
