//! A transformer block with candle's own operations, as plainly as it goes.

use candle_core::{Device, Result, Tensor};

use super::{CandleLinear, by_head, index, modulated, softmax};
use nn::ops::BlockParts;

/// A block with its weights.
pub struct CandleBlock {
    ada: CandleLinear,
    qkv: CandleLinear,
    proj: CandleLinear,
    fc1: CandleLinear,
    fc2: CandleLinear,
    local: Option<(Tensor, Tensor)>, // [width, 1, 3, 3] and [1, width]
    heads: usize,
    side: usize,
}

impl CandleBlock {
    /// The block of its parts.
    pub(super) fn new(parts: BlockParts<CandleLinear>, device: &Device) -> Result<Self> {
        let local = match parts.local {
            Some((weight, bias)) => {
                let width = bias.len();
                let weight = Tensor::from_vec(weight, (width, 1, 3, 3), device)?;
                Some((weight, Tensor::from_vec(bias, (1, width), device)?))
            }
            None => None,
        };
        Ok(Self {
            ada: parts.ada,
            qkv: parts.qkv,
            proj: parts.proj,
            fc1: parts.fc1,
            fc2: parts.fc2,
            local,
            heads: parts.heads,
            side: parts.side,
        })
    }

    /// The layer that modulates the block.
    pub(super) fn ada(&self) -> &CandleLinear {
        &self.ada
    }

    /// The tokens `[places, width]` after the block, and `[tokens, keys | values]` of the whole map.
    pub(super) fn forward(
        &self,
        x: &Tensor,
        ada: &Tensor,
        places: &[usize],
        keys_values: &Tensor,
    ) -> Result<(Tensor, Tensor)> {
        let (count, width) = x.dims2()?;
        let (device, tokens) = (x.device(), keys_values.dim(0)?);
        let ada = ada.chunk(6, 1)?;
        let qkv = self.qkv.forward(&modulated(x, &ada[0], &ada[1])?)?;
        // Behind the old rows stand the new ones; each token takes the one that is its own.
        let both = Tensor::cat(&[keys_values, &qkv.narrow(1, width, 2 * width)?], 0)?;
        let mut newest: Vec<usize> = (0..tokens).collect();
        for (i, place) in places.iter().enumerate() {
            newest[*place] = tokens + i;
        }
        let keys_values = both.index_select(&index(newest.into_iter(), device)?, 0)?;
        let queries = by_head(&qkv.narrow(1, 0, width)?, self.heads)?;
        let keys = by_head(&keys_values.narrow(1, 0, width)?, self.heads)?;
        let all_values = keys_values.narrow(1, width, width)?.contiguous()?;
        let values = by_head(&all_values, self.heads)?;
        let scores = (queries.matmul(&keys.t()?)? / ((width / self.heads) as f64).sqrt())?;
        let mixed = softmax(&scores)?.matmul(&values)?.transpose(0, 1)?;
        let mut mixed = mixed.contiguous()?.reshape((count, width))?;
        if let Some((weight, bias)) = &self.local {
            let map = all_values
                .t()?
                .contiguous()?
                .reshape((1, width, self.side, self.side))?;
            let near = map.conv2d(weight, 1, 1, 1, width)?;
            let near = near.reshape((width, tokens))?.t()?.contiguous()?;
            let near = near.index_select(&index(places.iter().copied(), device)?, 0)?;
            mixed = (mixed + near.broadcast_add(bias)?)?;
        }
        let x = (x + self.proj.forward(&mixed)?.broadcast_mul(&ada[2])?)?;
        let hidden = self.fc1.forward(&modulated(&x, &ada[3], &ada[4])?)?.gelu_erf()?;
        let x = (&x + self.fc2.forward(&hidden)?.broadcast_mul(&ada[5])?)?;
        Ok((x, keys_values))
    }
}
