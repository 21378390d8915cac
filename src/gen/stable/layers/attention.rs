//! Attention between tokens.

use candle_core::{DType, Device, Result, Tensor};

use super::{TransposedLinear, softmax};
use crate::StableError;
use crate::weights::Names;

/// Most scores that are held at once: 256 MiB. Larger attentions are computed for a part of their queries at a time.
const MOST_SCORES: usize = 1 << 26;

/// The layers of an attention: query, key, value and output, with names as in a UNet: `to_q`, `to_k`, `to_v`,
/// `to_out.0`.
#[derive(Clone, Debug)]
pub(crate) struct Attention {
    query: TransposedLinear,
    key: TransposedLinear,
    value: TransposedLinear,
    out: TransposedLinear,
    heads: usize,
}

impl Attention {
    /// Loads an attention of a UNet: tokens of `width` attend to tokens of `context`; only the output layer has a bias.
    /// `heads` divides `width`.
    pub fn load(
        names: &Names<'_>,
        width: usize,
        context: usize,
        heads: usize,
    ) -> std::result::Result<Self, StableError> {
        Ok(Self {
            query: TransposedLinear::load_without_bias(&names.at("to_q"), width, width)?,
            key: TransposedLinear::load_without_bias(&names.at("to_k"), context, width)?,
            value: TransposedLinear::load_without_bias(&names.at("to_v"), context, width)?,
            out: TransposedLinear::load(&names.at("to_out.0"), width, width)?,
            heads,
        })
    }

    /// Loads an attention with biases. Each of query, key, value and output takes the first of its names that the file
    /// has.
    pub fn load_named(
        names: &Names<'_>,
        [query, key, value, out]: [&[&str]; 4],
        width: usize,
        heads: usize,
    ) -> std::result::Result<Self, StableError> {
        let layer = |all: &[&str]| TransposedLinear::load(&names.at_any(all, "weight"), width, width);
        Ok(Self {
            query: layer(query)?,
            key: layer(key)?,
            value: layer(value)?,
            out: layer(out)?,
            heads,
        })
    }

    /// Attention of tokens `x` `[batch, tokens, width]` to `context` `[batch, others, ..]`. `mask` `[tokens, others]`
    /// is added to the scores.
    pub fn forward(&self, x: &Tensor, context: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        let (batch, tokens, width) = x.dims3()?;
        let each = width / self.heads;
        let by_head = |x: &Tensor| {
            let (batch, tokens, _) = x.dims3()?;
            let x = x.reshape((batch, tokens, self.heads, each))?.transpose(1, 2)?;
            x.contiguous()?.reshape((batch * self.heads, tokens, each))
        };
        // The scale is applied to the queries, so that products stay small.
        let scale = 1.0 / (each as f64).sqrt();
        let queries = by_head(&self.query.forward(x)?.affine(scale, 0.0)?)?;
        let keys = by_head(&self.key.forward(context)?)?.t()?.contiguous()?;
        let values = by_head(&self.value.forward(context)?)?;
        let row = batch * self.heads * keys.dim(2)?;
        let part = (MOST_SCORES / row.max(1)).clamp(1, tokens.max(1));
        let mut parts = Vec::new();
        for first in (0..tokens).step_by(part) {
            let count = part.min(tokens - first);
            let scores = queries.narrow(1, first, count)?.contiguous()?.matmul(&keys)?;
            let scores = match mask {
                Some(mask) => {
                    let mask = mask.narrow(0, first, count)?;
                    scores.to_dtype(DType::F32)?.broadcast_add(&mask)?
                }
                None => scores,
            };
            parts.push(softmax(&scores)?.to_dtype(x.dtype())?.matmul(&values)?);
        }
        let mixed = Tensor::cat(&parts, 1)?.reshape((batch, self.heads, tokens, each))?;
        let mixed = mixed.transpose(1, 2)?.contiguous()?;
        self.out.forward(&mixed.reshape((batch, tokens, width))?)
    }
}

/// Mask that lets each of `tokens` attend to itself and those before it: 0 for these, a large negative number for the
/// others.
pub(crate) fn causal_mask(tokens: usize, device: &Device) -> Result<Tensor> {
    let all = (0..tokens).flat_map(|i| (0..tokens).map(move |j| if j > i { -1e30f32 } else { 0.0 }));
    Tensor::from_vec(all.collect::<Vec<_>>(), (tokens, tokens), device)
}
