//! Transformers over the cells of a map, with attention to the text and to neighbours.

use candle_core::{D, Result, Tensor};

use super::neighbours::{NeighbourIndices, Neighbours};
use crate::StableError;
use crate::config::{Connector, UnetConfig};
use crate::layers::{Attention, GroupNorm, LayerNorm, TransposedLinear};
use crate::weights::Names;

/// Epsilon of the norm of maps.
const MAP_EPSILON: f64 = 1e-6;
/// Epsilon of the norms of tokens.
const EPSILON: f64 = 1e-5;

type StableResult<T> = std::result::Result<T, StableError>;

/// A gated perceptron (Shazeer 2020): narrow(a gelu(b)) with (a, b) = widen(x).
#[derive(Clone, Debug)]
pub(crate) struct Gated {
    widen: TransposedLinear,
    narrow: TransposedLinear,
}

impl Gated {
    fn load(names: &Names<'_>, width: usize) -> StableResult<Self> {
        Ok(Self {
            widen: TransposedLinear::load(&names.at("net.0.proj"), width, 8 * width)?,
            narrow: TransposedLinear::load(&names.at("net.2"), 4 * width, width)?,
        })
    }

    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let both = self.widen.forward(x)?.chunk(2, D::Minus1)?;
        let gate = both[1].contiguous()?.gelu_erf()?;
        self.narrow.forward(&(both[0].contiguous()? * gate)?)
    }
}

/// A transformer block: attention to itself, to the text and to its neighbours, then the perceptron.
#[derive(Clone, Debug)]
pub(crate) struct UnetTransformerBlock {
    norms: [LayerNorm; 3],
    itself: Attention,
    text: Attention,
    views: Option<Neighbours>,
    frames: Option<Neighbours>,
    pub(crate) gated: Gated,
}

impl UnetTransformerBlock {
    fn load(names: &Names<'_>, config: &UnetConfig, width: usize, heads: usize) -> StableResult<Self> {
        let norm = |name: &str| LayerNorm::load(&names.at(name), width, EPSILON);
        let sizes = [width, heads];
        let views = config.neighboring_view_pair.is_some().then(|| {
            let ours = ["norm4", "attn4", "connector"];
            let (connector, heard) = (config.zero_module_type, config.neighboring_attn_type);
            Neighbours::load(names, ours, sizes, connector, heard)
        });
        let frames = config.cross_frame_attn_type.map(|heard| {
            let ours = ["norm5", "attn5", "connector5"];
            Neighbours::load(names, ours, sizes, Connector::Linear, heard)
        });
        Ok(Self {
            norms: [norm("norm1")?, norm("norm2")?, norm("norm3")?],
            itself: Attention::load(&names.at("attn1"), width, width, heads)?,
            text: Attention::load(&names.at("attn2"), width, config.cross_attention_dim, heads)?,
            views: views.transpose()?,
            frames: frames.transpose()?,
            gated: Gated::load(&names.at("ff"), width)?,
        })
    }

    /// Applies the block to tokens `[batch, tokens, width]`.
    pub fn forward(&self, x: &Tensor, context: &Tensor, around: &NeighbourIndices) -> Result<Tensor> {
        let y = self.norms[0].forward(x)?;
        let x = (x + self.itself.forward(&y, &y, None)?)?;
        let y = self.norms[1].forward(&x)?;
        let mut x = (&x + self.text.forward(&y, context, None)?)?;
        for (attention, around) in [(&self.views, &around.views), (&self.frames, &around.frames)] {
            if let (Some(attention), false) = (attention, around.is_empty()) {
                x = attention.forward(&x, around)?;
            }
        }
        let y = self.norms[2].forward(&x)?;
        &x + self.gated.forward(&y)?
    }
}

/// Blocks between two projections; the map itself is added to their result.
#[derive(Clone, Debug)]
pub(crate) struct Transformer {
    norm: GroupNorm,
    enter: TransposedLinear,
    pub(crate) blocks: Vec<UnetTransformerBlock>,
    leave: TransposedLinear,
}

impl Transformer {
    /// Loads the layers. The projections may be stored as linear layers or as 1x1 convolutions, which are equivalent.
    pub fn load(
        names: &Names<'_>,
        config: &UnetConfig,
        [width, heads, depth]: [usize; 3],
    ) -> StableResult<Self> {
        let block = |i: usize| {
            let names = names.at("transformer_blocks").at(i);
            UnetTransformerBlock::load(&names, config, width, heads)
        };
        Ok(Self {
            norm: GroupNorm::load(&names.at("norm"), width, config.norm_num_groups, MAP_EPSILON)?,
            enter: TransposedLinear::load(&names.at("proj_in"), width, width)?,
            blocks: (0..depth).map(block).collect::<StableResult<_>>()?,
            leave: TransposedLinear::load(&names.at("proj_out"), width, width)?,
        })
    }

    /// Applies the transformer to a map.
    pub fn forward(&self, x: &Tensor, context: &Tensor, around: &NeighbourIndices) -> Result<Tensor> {
        let (batch, width, rows, columns) = x.dims4()?;
        let tokens = self.norm.forward(x)?.reshape((batch, width, rows * columns))?;
        let tokens = self.enter.forward(&tokens.transpose(1, 2)?)?;
        let through = |y: Tensor, block: &UnetTransformerBlock| block.forward(&y, context, around);
        let tokens = self
            .leave
            .forward(&self.blocks.iter().try_fold(tokens, through)?)?;
        x + tokens
            .transpose(1, 2)?
            .contiguous()?
            .reshape((batch, width, rows, columns))?
    }
}
