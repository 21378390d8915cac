//! Attention to the neighbouring views and frames. Li et al. 2024 (SyntheOcc), equation 5: h + connector(sum over neighbours i of
//! attention(query of h, keys and values of i)).

use candle_core::{Result, Tensor};

use crate::config::{Connector, NeighbourFusion};
use crate::layers::{Attention, LayerNorm, TransposedLinear};
use crate::weights::Names;
use crate::{StableError, wrong};

/// Epsilon of the norm.
const EPSILON: f64 = 1e-5;

/// Neighbours of each item, by index in the batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct NeighbourIndices {
    /// Neighbouring views of the same frame; empty if the network draws views one by one.
    pub views: Vec<Vec<usize>>,
    /// Items of the same view in the frames before and after; empty if there is one frame.
    pub frames: Vec<Vec<usize>>,
}

impl NeighbourIndices {
    /// Neighbours in a batch of all views of the first frame, then of the next. `neighbours` lists those of each view.
    /// Errors if the batch does not hold whole frames.
    pub fn from_neighbours(
        neighbours: &[Vec<usize>],
        frames: usize,
        batch: usize,
    ) -> std::result::Result<Self, StableError> {
        let views = match neighbours.len() {
            0 => batch / frames.max(1),
            views => views,
        };
        if frames == 0 || views == 0 || !batch.is_multiple_of(views) || !batch.is_multiple_of(views * frames)
        {
            let expected = format!("a multiple of {views} views times {frames} frames");
            return Err(wrong("number of latents", batch, expected));
        }
        let of_views = |item: usize| {
            let start = item - item % views;
            neighbours[item % views].iter().map(|n| start + n).collect()
        };
        let of_frames = |item: usize| {
            let frame = item / views % frames;
            let before = (frame > 0).then(|| item - views);
            let after = (frame + 1 < frames).then(|| item + views);
            before.into_iter().chain(after).collect()
        };
        Ok(Self {
            views: match neighbours.is_empty() {
                true => Vec::new(),
                false => (0..batch).map(of_views).collect(),
            },
            frames: match frames {
                1 => Vec::new(),
                _ => (0..batch).map(of_frames).collect(),
            },
        })
    }
}

/// Layer behind the attention.
#[derive(Clone, Debug)]
enum Behind {
    Linear(TransposedLinear),
    Gate(Tensor), // tanh of alpha, [width]
    Nothing,
}

/// The attention with its norm and connector.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    norm: LayerNorm,
    attention: Attention,
    behind: Behind,
    heard: NeighbourFusion,
}

impl Neighbours {
    /// Loads the layers. `names` are those of a transformer block; `ours` its norm, attention and connector in it.
    pub fn load(
        names: &Names<'_>,
        ours: [&str; 3],
        [width, heads]: [usize; 2],
        connector: Connector,
        heard: NeighbourFusion,
    ) -> std::result::Result<Self, StableError> {
        let [norm, attention, behind] = ours.map(|name| names.at(name));
        Ok(Self {
            norm: LayerNorm::load(&norm, width, EPSILON)?,
            attention: Attention::load(&attention, width, width, heads)?,
            behind: match connector {
                Connector::Linear => Behind::Linear(TransposedLinear::load(&behind, width, width)?),
                Connector::Gated => Behind::Gate(behind.tensor("alpha", &[width])?.tanh()?),
                Connector::None => Behind::Nothing,
            },
            heard,
        })
    }

    /// Tokens `[batch, tokens, width]` after attention to those of `around`, one list for each item of the batch.
    pub fn forward(&self, x: &Tensor, around: &[Vec<usize>]) -> Result<Tensor> {
        let normed = self.norm.forward(x)?;
        let heard = match self.heard {
            NeighbourFusion::Add => self.added(&normed, around)?,
            NeighbourFusion::Concat => self.joined(&normed, around)?,
        };
        let heard = match &self.behind {
            Behind::Linear(layer) => layer.forward(&heard)?,
            Behind::Gate(gate) => heard.broadcast_mul(gate)?,
            Behind::Nothing => heard,
        };
        x + heard
    }

    /// Attention to the first neighbours of all items, then to the second: never more than the batch at once.
    fn added(&self, x: &Tensor, around: &[Vec<usize>]) -> Result<Tensor> {
        let most = around.iter().map(Vec::len).max().unwrap_or(0);
        let mut heard = x.zeros_like()?;
        for rank in 0..most {
            let with = |(item, others): (usize, &Vec<usize>)| others.get(rank).map(|other| (item, *other));
            let (items, others): (Vec<usize>, Vec<usize>) =
                around.iter().enumerate().filter_map(with).unzip();
            let context = picked(x, &others)?;
            if items.len() == around.len() {
                heard = (heard + self.attention.forward(x, &context, None)?)?;
            } else {
                let said = self.attention.forward(&picked(x, &items)?, &context, None)?;
                heard = heard.index_add(&index(&items, x)?, &said, 0)?;
            }
        }
        Ok(heard)
    }

    /// Attention of each item to the tokens of all its neighbours at once.
    fn joined(&self, x: &Tensor, around: &[Vec<usize>]) -> Result<Tensor> {
        let each = around.iter().enumerate().map(|(item, others)| {
            if others.is_empty() {
                return x.narrow(0, item, 1)?.zeros_like();
            }
            let tokens: Vec<Tensor> = others.iter().map(|o| x.narrow(0, *o, 1)).collect::<Result<_>>()?;
            let query = x.narrow(0, item, 1)?;
            self.attention.forward(&query, &Tensor::cat(&tokens, 1)?, None)
        });
        Tensor::cat(&each.collect::<Result<Vec<_>>>()?, 0)
    }
}

fn index(places: &[usize], x: &Tensor) -> Result<Tensor> {
    let places: Vec<u32> = places.iter().map(|p| *p as u32).collect();
    Tensor::from_slice(&places, places.len(), x.device())
}

fn picked(x: &Tensor, places: &[usize]) -> Result<Tensor> {
    x.index_select(&index(places, x)?, 0)
}
