//! Convolutions over sites: the rows of each tap are gathered, multiplied and added to where they belong.

use candle_core::{Device, Result, Tensor};

use super::{CandleLinear, Norm, index};
use nn::rules::RuleBook;

/// A convolution over sites.
pub struct Convolution {
    taps: Vec<Tensor>, // [inputs, outputs] each
    bias: Tensor,      // [1, outputs]
}

impl Convolution {
    /// The convolution of `weight`, `[tap][input][output]`.
    pub(super) fn new(weight: &[f32], bias: Vec<f32>, taps: usize, device: &Device) -> Result<Self> {
        let outputs = bias.len();
        let each = weight.chunks_exact(weight.len() / taps);
        let tap = |w: &[f32]| Tensor::from_slice(w, (w.len() / outputs, outputs), device);
        Ok(Self {
            taps: each.map(tap).collect::<Result<_>>()?,
            bias: Tensor::from_vec(bias, (1, outputs), device)?,
        })
    }

    /// Sites `[sites, inputs]` to rows of the rule book `[rows, outputs]`.
    pub(super) fn forward(&self, x: &Tensor, rules: &RuleBook) -> Result<Tensor> {
        let shape = (rules.rows(), self.bias.dim(1)?);
        let mut out = self.bias.broadcast_as(shape)?.contiguous()?;
        for (tap, weight) in self.taps.iter().enumerate() {
            let pairs: Vec<[u32; 2]> = rules.pairs(tap).collect();
            if pairs.is_empty() {
                continue;
            }
            let side = |i: usize| index(pairs.iter().map(move |p| p[i] as usize), x.device());
            let product = x.index_select(&side(1)?, 0)?.matmul(weight)?;
            out = out.index_add(&side(0)?, &product, 0)?;
        }
        Ok(out)
    }
}

/// x + W relu(convolution(norm(x))).
pub struct CandleSiteResidual {
    pub(super) norm: Norm,
    pub(super) convolution: Convolution,
    pub(super) linear: CandleLinear,
}

impl CandleSiteResidual {
    pub(super) fn forward(&self, x: &Tensor, rules: &RuleBook) -> Result<Tensor> {
        let inner = self.convolution.forward(&self.norm.forward(x)?, rules)?;
        x + self.linear.forward(&inner.relu()?)?
    }
}
