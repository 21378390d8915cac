//! Blocks over the nodes of a graph with candle's own operations.

use candle_core::{Device, Result, Tensor};

use super::{CandleLinear, by_head, index, modulated, softmax, unit};
use nn::ops::{MessageEdge, MessageParts, NodeBlockParts};

/// A round of messages along edges.
pub struct Messages {
    source: CandleLinear,
    target: CandleLinear,
    relation: Tensor, // [relations, width]
    distance: CandleLinear,
    out: CandleLinear,
}

impl Messages {
    /// The round of its parts.
    pub(super) fn new(parts: MessageParts<CandleLinear>, device: &Device) -> Result<Self> {
        let width = parts.out.weight.dim(1)?;
        let relations = parts.relation.len() / width;
        Ok(Self {
            source: parts.source,
            target: parts.target,
            relation: Tensor::from_vec(parts.relation, (relations, width), device)?,
            distance: parts.distance,
            out: parts.out,
        })
    }

    /// The nodes `[nodes, width]` after the round.
    pub(super) fn forward(&self, x: &Tensor, edges: &[MessageEdge]) -> Result<Tensor> {
        let (nodes, device) = (x.dim(0)?, x.device());
        let mut mean = x.zeros_like()?;
        if !edges.is_empty() {
            let of = |end: fn(&MessageEdge) -> usize| index(edges.iter().map(end), device);
            let (from, to) = (of(|e| e.from)?, of(|e| e.to)?);
            let distances: Vec<f32> = edges.iter().flat_map(|e| e.distance).collect();
            let distances = Tensor::from_vec(distances, (edges.len(), 2), device)?;
            let y = unit(x)?;
            let said = self.source.forward(&y)?.index_select(&from, 0)?;
            let said = (said + self.target.forward(&y)?.index_select(&to, 0)?)?;
            let said = (said + self.relation.index_select(&of(|e| e.relation)?, 0)?)?;
            let said = (said + self.distance.forward(&distances)?)?.gelu_erf()?;
            let mut counts = vec![0f32; nodes];
            edges.iter().for_each(|e| counts[e.to] += 1.0);
            counts.iter_mut().for_each(|n| *n = n.max(1.0));
            let counts = Tensor::from_vec(counts, (nodes, 1), device)?;
            mean = mean.index_add(&to, &said, 0)?.broadcast_div(&counts)?;
        }
        x + self.out.forward(&mean)?
    }
}

/// A transformer block over nodes.
pub struct NodeBlock {
    shift: Tensor, // [1, 6 width]
    qkv: CandleLinear,
    proj: CandleLinear,
    fc1: CandleLinear,
    fc2: CandleLinear,
    heads: usize,
}

impl NodeBlock {
    /// The block of its parts.
    pub(super) fn new(parts: NodeBlockParts<CandleLinear>, device: &Device) -> Result<Self> {
        let count = parts.shift.len();
        Ok(Self {
            shift: Tensor::from_vec(parts.shift, (1, count), device)?,
            qkv: parts.qkv,
            proj: parts.proj,
            fc1: parts.fc1,
            fc2: parts.fc2,
            heads: parts.heads,
        })
    }

    /// The nodes `[nodes, width]` after the block; `context` is `[tokens, keys | values]`, `bias` of `heads * nodes * nodes`
    /// numbers.
    pub(super) fn forward(
        &self,
        x: &Tensor,
        ada: &Tensor,
        context: Option<&Tensor>,
        bias: &Tensor,
    ) -> Result<Tensor> {
        let (nodes, width) = x.dims2()?;
        let ada = (ada + &self.shift)?.chunk(6, 1)?;
        let qkv = self.qkv.forward(&modulated(x, &ada[0], &ada[1])?)?;
        let queries = by_head(&qkv.narrow(1, 0, width)?, self.heads)?;
        let mut keys_values = qkv.narrow(1, width, 2 * width)?;
        let mut bias = bias.reshape((self.heads, nodes, nodes))?;
        if let Some(context) = context {
            keys_values = Tensor::cat(&[&keys_values, context], 0)?;
            bias = bias.pad_with_zeros(2, 0, context.dim(0)?)?;
        }
        let keys = by_head(&keys_values.narrow(1, 0, width)?, self.heads)?;
        let values = by_head(&keys_values.narrow(1, width, width)?, self.heads)?;
        let scale = ((width / self.heads) as f64).sqrt();
        let scores = ((queries.matmul(&keys.t()?)? / scale)? + bias)?;
        let mixed = softmax(&scores)?.matmul(&values)?.transpose(0, 1)?;
        let mixed = mixed.contiguous()?.reshape((nodes, width))?;
        let x = (x + self.proj.forward(&mixed)?.broadcast_mul(&ada[2])?)?;
        let hidden = self.fc1.forward(&modulated(&x, &ada[3], &ada[4])?)?.gelu_erf()?;
        &x + self.fc2.forward(&hidden)?.broadcast_mul(&ada[5])?
    }
}
