//! The layers of all networks of this crate. Maps are `[batch, channels, rows, columns]`, tokens
//! `[batch, tokens, width]`.

mod attention;
pub(crate) mod convolution;
mod linear;
mod norm;
mod residual;

pub(crate) use attention::{Attention, causal_mask};
pub(crate) use convolution::Conv;
pub(crate) use linear::TransposedLinear;
pub(crate) use norm::{GroupNorm, LayerNorm};
pub(crate) use residual::StableResidual;

use candle_core::{DType, Result, Tensor};

/// x sigmoid(1.702 x); finite for all finite x.
pub(crate) fn quick_gelu(x: &Tensor) -> Result<Tensor> {
    // At -infinity in the exponent the denominator is infinite, and the product 0.
    x * x.affine(-1.702, 0.0)?.exp()?.affine(1.0, 1.0)?.recip()?
}

/// Softmax over the last dimension, in 32 bits. The largest score is subtracted first, so any finite scores work.
pub(crate) fn softmax(scores: &Tensor) -> Result<Tensor> {
    let last = candle_core::D::Minus1;
    let scores = scores.to_dtype(DType::F32)?;
    let scores = scores.broadcast_sub(&scores.max_keepdim(last)?)?.exp()?;
    scores.broadcast_div(&scores.sum_keepdim(last)?)
}
