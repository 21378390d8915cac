//! A transformer block over a ring of maps with candle's own operations.

use candle_core::{Device, Result, Tensor};

use super::{CandleLinear, CandleMap, Norm, by_head, modulated, softmax};
use nn::ring::{AcrossParts, RingBlockParts};

/// A block with its weights.
pub struct RingBlock {
    offset: Tensor, // [1, 6 width]
    qkv: CandleLinear,
    proj: CandleLinear,
    fc1: CandleLinear,
    fc2: CandleLinear,
    local: (Tensor, Tensor), // [width, 1, 3, 3] and [1, width]
    across: Option<Across>,
    heads: usize,
}

/// Attention to the neighbours.
struct Across {
    norm: Norm,
    side: Tensor, // [2, width]
    qkv: CandleLinear,
    proj: CandleLinear,
}

impl RingBlock {
    /// The block of its parts.
    pub(super) fn new(parts: RingBlockParts<CandleLinear, Norm>, device: &Device) -> Result<Self> {
        let (weight, bias) = parts.local;
        let width = bias.len();
        let across = |parts: AcrossParts<CandleLinear, Norm>| -> Result<Across> {
            Ok(Across {
                norm: parts.norm,
                side: Tensor::from_vec(parts.side, (2, width), device)?,
                qkv: parts.qkv,
                proj: parts.proj,
            })
        };
        Ok(Self {
            offset: Tensor::from_vec(parts.offset, (1, 6 * width), device)?,
            qkv: parts.qkv,
            proj: parts.proj,
            fc1: parts.fc1,
            fc2: parts.fc2,
            local: (
                Tensor::from_vec(weight, (width, 1, 3, 3), device)?,
                Tensor::from_vec(bias, (1, width), device)?,
            ),
            across: parts.across.map(across).transpose()?,
            heads: parts.heads,
        })
    }

    /// The maps after the block; `ada` is `[1, 6 width]` for each.
    pub(super) fn forward(&self, maps: Vec<CandleMap>, ada: &[CandleMap]) -> Result<Vec<CandleMap>> {
        let told = ada.iter().map(|a| (&a.data + &self.offset)?.chunk(6, 1));
        let told: Vec<Vec<Tensor>> = told.collect::<Result<_>>()?;
        let inside = maps.iter().zip(&told).map(|(map, ada)| self.inside(map, ada));
        let mut maps: Vec<CandleMap> = inside.collect::<Result<_>>()?;
        if let Some(across) = &self.across {
            let qkv = maps
                .iter()
                .map(|m| across.qkv.forward(&across.norm.forward(&m.data)?));
            let qkv: Vec<Tensor> = qkv.collect::<Result<_>>()?;
            let count = maps.len();
            for (i, map) in maps.iter_mut().enumerate() {
                let beside = [&qkv[(i + count - 1) % count], &qkv[(i + 1) % count]];
                map.data = (&map.data + across.heard(&qkv[i], beside, self.heads)?)?;
            }
        }
        let ends = maps.into_iter().zip(&told).map(|(map, ada)| {
            let hidden = self.fc1.forward(&modulated(&map.data, &ada[3], &ada[4])?)?;
            let out = self.fc2.forward(&hidden.gelu_erf()?)?.broadcast_mul(&ada[5])?;
            map.with((&map.data + out)?)
        });
        ends.collect()
    }

    /// A map after attention in it.
    fn inside(&self, map: &CandleMap, ada: &[Tensor]) -> Result<CandleMap> {
        let (tokens, width) = map.data.dims2()?;
        let qkv = self.qkv.forward(&modulated(&map.data, &ada[0], &ada[1])?)?;
        let part = |i: usize| qkv.narrow(1, i * width, width);
        let mixed = attention(&part(0)?, &part(1)?, &part(2)?, self.heads)?;
        let planes = part(2)?.t()?.contiguous()?;
        let planes = planes.reshape((1, width, map.rows, map.columns))?;
        let near = planes.conv2d(&self.local.0, 1, 1, 1, width)?;
        let near = near.reshape((width, tokens))?.t()?.contiguous()?;
        let mixed = (mixed + near.broadcast_add(&self.local.1)?)?;
        map.with((&map.data + self.proj.forward(&mixed)?.broadcast_mul(&ada[2])?)?)
    }
}

impl Across {
    /// Attention of a map to the maps on its left and right.
    fn heard(&self, own: &Tensor, [left, right]: [&Tensor; 2], heads: usize) -> Result<Tensor> {
        let width = own.dim(1)? / 3;
        let keys = |qkv: &Tensor, side: usize| {
            qkv.narrow(1, width, width)?
                .broadcast_add(&self.side.narrow(0, side, 1)?)
        };
        let keys = Tensor::cat(&[keys(left, 0)?, keys(right, 1)?], 0)?;
        let values = |qkv: &Tensor| qkv.narrow(1, 2 * width, width);
        let values = Tensor::cat(&[values(left)?, values(right)?], 0)?;
        self.proj
            .forward(&attention(&own.narrow(1, 0, width)?, &keys, &values, heads)?)
    }
}

/// Softmax(q k / sqrt(d)) v, `[queries, width]`.
fn attention(queries: &Tensor, keys: &Tensor, values: &Tensor, heads: usize) -> Result<Tensor> {
    let (count, width) = queries.dims2()?;
    let [queries, keys, values] = [
        by_head(queries, heads)?,
        by_head(keys, heads)?,
        by_head(values, heads)?,
    ];
    let scores = (queries.matmul(&keys.t()?)? / ((width / heads) as f64).sqrt())?;
    let mixed = softmax(&scores)?.matmul(&values)?.transpose(0, 1)?;
    mixed.contiguous()?.reshape((count, width))
}
