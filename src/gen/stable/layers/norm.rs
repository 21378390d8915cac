//! Norms, in 32 bits whatever type the network computes in.

use candle_core::{D, DType, Result, Tensor};

use crate::StableError;
use crate::weights::Names;

/// Normalises to mean 0 and variance 1 over the last dimension. Takes two passes, so a large mean does no harm.
fn unit(x: &Tensor, epsilon: f64) -> Result<Tensor> {
    let centered = x.broadcast_sub(&x.mean_keepdim(D::Minus1)?)?;
    let variance = centered.sqr()?.mean_keepdim(D::Minus1)?;
    centered.broadcast_div(&(variance + epsilon)?.sqrt()?)
}

/// Norm over groups of channels of a map.
#[derive(Clone, Debug)]
pub(crate) struct GroupNorm {
    scale: Tensor, // [1, channels, 1]
    shift: Tensor,
    groups: usize,
    epsilon: f64,
}

impl GroupNorm {
    /// Loads `weight` and `bias` below a prefix. The channels are divisible by the groups.
    pub fn load(
        names: &Names<'_>,
        channels: usize,
        groups: usize,
        epsilon: f64,
    ) -> std::result::Result<Self, StableError> {
        let shape = (1, channels, 1);
        Ok(Self {
            scale: names
                .tensor("weight", &[channels])?
                .to_dtype(DType::F32)?
                .reshape(shape)?,
            shift: names
                .tensor("bias", &[channels])?
                .to_dtype(DType::F32)?
                .reshape(shape)?,
            groups,
            epsilon,
        })
    }

    /// Normalises a map, or `[batch, channels, places]`.
    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let (dims, dtype) = (x.dims().to_vec(), x.dtype());
        let (batch, channels) = (dims[0], dims[1]);
        let each = dims[2..].iter().product::<usize>() * channels / self.groups;
        let x = x.to_dtype(DType::F32)?.contiguous()?;
        let x = unit(&x.reshape((batch, self.groups, each))?, self.epsilon)?;
        let x = x.reshape((batch, channels, each * self.groups / channels))?;
        let x = x.broadcast_mul(&self.scale)?.broadcast_add(&self.shift)?;
        x.reshape(dims)?.to_dtype(dtype)
    }
}

/// Norm over the channels of each token.
#[derive(Clone, Debug)]
pub(crate) struct LayerNorm {
    scale: Tensor, // [width]
    shift: Tensor,
    epsilon: f64,
}

impl LayerNorm {
    /// Loads `weight` and `bias` below a prefix.
    pub fn load(names: &Names<'_>, width: usize, epsilon: f64) -> std::result::Result<Self, StableError> {
        Ok(Self {
            scale: names.tensor("weight", &[width])?.to_dtype(DType::F32)?,
            shift: names.tensor("bias", &[width])?.to_dtype(DType::F32)?,
            epsilon,
        })
    }

    /// Normalises tokens.
    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let y = unit(&x.to_dtype(DType::F32)?, self.epsilon)?;
        let y = y.broadcast_mul(&self.scale)?.broadcast_add(&self.shift)?;
        y.to_dtype(x.dtype())
    }
}
