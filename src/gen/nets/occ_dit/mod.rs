//! Latent diffusion transformer for occupancy: predicts v from a noisy latent, a timestep and a
//! condition (mask, context, draft, layout). adaLN-Zero blocks of Peebles and Xie, arXiv 2212.09748,
//! over 625 tokens of 2x2 cells, with a depthwise convolution over the values (LePE, arXiv 2107.00652).
//! Twin of `training/models/occ_dit.py`.

mod condition;
mod config;
mod time;
mod tokens;

use super::{CHANNELS, LATENT, ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::ops::{BackendTensor, Ops};
use nn::transformer::piece_of;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Precision};

pub use condition::DitCondition;
use condition::{CONDITION, NAMED};
pub use config::DitConfig;
pub use time::{OccDitTime, TimeConfig};
pub(super) use tokens::positions;
pub(super) use tokens::timestep_embedding;
use tokens::{PATCH_CELLS, TOKENS_PER_SIDE, patch};
pub use tokens::{TOKENS, tokens_of};

/// Parts of a condition that depend on neither state nor time, for some of the tokens. `T` is the backend's tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared<T = FeatureMap> {
    /// Tokens that are computed, in rising order.
    tokens: Vec<usize>,
    /// Embedded condition, `[token][width]`.
    embedded: T,
    /// Draft latent, 50x50x8.
    draft: Vec<f32>,
    /// 1 where all of the background is given, 50x50.
    given: Vec<f32>,
    /// Contribution of the named numbers to the embedded time, `[width]`.
    named: T,
}

impl<T> Prepared<T> {
    /// Number of tokens that are computed.
    pub fn tokens(&self) -> usize {
        self.tokens.len()
    }
}

/// Keys and values of every token in every block at one state: tokens that are computed attend by them to those that
/// are not. `T` is the backend's tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct KeysValues<T = FeatureMap>(Vec<T>); // [block], each [token][keys | values]

impl<T> Default for KeysValues<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: BackendTensor> KeysValues<T> {
    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|block| 4 * block.numbers()).sum()
    }
}

/// Handling of the blocks between the first and the last: their contribution to the tokens changes slowly from one step
/// to the next (Delta-DiT, 2406.01125).
pub enum BlockReuse<'a> {
    /// They are computed.
    Computed,
    /// They are computed, and their contribution is kept here.
    Kept(&'a mut Vec<f32>),
    /// Their contribution of an earlier step is added again; they are computed if that is of other tokens.
    Reused(&'a [f32]),
}

/// The network with its weights, on a backend.
pub struct OccDit<B: Ops = Cpu> {
    ops: B,
    config: DitConfig,
    embed_x: B::Linear,
    embed_condition: B::Linear,
    time1: B::Linear,
    time2: B::Linear,
    named1: B::Linear,
    named2: B::Linear,
    blocks: Vec<B::Block>,
    final_ada: B::Linear,
    last: B::Linear,
    /// Gates of the noisy latent and of the draft per channel: the linear part of the prediction.
    skip: B::Linear,
    /// Added to these gates where the background is given.
    skip_given: B::Linear,
    positions: Vec<f32>, // [token][width]
}

impl OccDit {
    /// Loads the network onto the processor. Takes all tensors of the file; refuses one that is missing, misshapen, not
    /// finite or unknown.
    pub fn new(file: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file)
    }
}

impl<B: Ops> OccDit<B> {
    /// Loads the network onto a backend; otherwise as [`OccDit::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: DitConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, width) = (&mut file, config.width);
        let shape = [config.heads, TOKENS_PER_SIDE];
        let blocks = (0..config.depth).map(|i| {
            let name = format!("blocks.{i}");
            ops.load_block(w, &name, width, shape, config.local)
        });
        let blocks = blocks.collect::<Result<_, _>>()?;
        let row = PATCH_CELLS * CONDITION;
        let embed_condition = ops.linear_without_bias(w, "embed_condition", [row, width])?;
        let mut linear = |name: &str, inputs, outputs| ops.linear(w, name, [inputs, outputs], &[]);
        let dit = Self {
            embed_x: linear("embed_x", PATCH_CELLS * CHANNELS, width)?,
            embed_condition,
            time1: linear("time1", config.frequencies, width)?,
            time2: linear("time2", width, width)?,
            named1: linear("named1", 2 * NAMED + 1, width)?,
            named2: linear("named2", width, width)?,
            blocks,
            final_ada: linear("final_ada", width, 2 * width)?,
            last: linear("final", width, PATCH_CELLS * CHANNELS)?,
            skip: linear("skip", width, 2 * CHANNELS)?,
            skip_given: linear("skip_given", width, 2 * CHANNELS)?,
            positions: positions([TOKENS_PER_SIDE; 2], width, 10000.0),
            config,
            ops,
        };
        file.finish()?;
        Ok(dit)
    }

    /// Sizes of the network.
    pub fn config(&self) -> &DitConfig {
        &self.config
    }

    /// The condition for guidance, without everything that is asked for, as training shows it one time in fourteen.
    pub fn null_condition(&self, condition: &DitCondition) -> DitCondition {
        condition.without_wishes()
    }

    /// Embeds a condition for all tokens, once per job.
    pub fn prepare(&self, condition: &DitCondition) -> Result<Prepared<B::Tensor>, ModelError> {
        self.prepare_some(condition, (0..TOKENS).collect())
    }

    /// Embeds a condition for some tokens, in rising order: only they are computed.
    pub fn prepare_some(
        &self,
        condition: &DitCondition,
        tokens: Vec<usize>,
    ) -> Result<Prepared<B::Tensor>, ModelError> {
        condition.check()?;
        let (ops, width) = (&self.ops, self.config.width);
        let features = ops.sequence(condition.features(&tokens), PATCH_CELLS * CONDITION)?;
        let embedded = ops.apply(&self.embed_condition, &features, piece_of(tokens.len()))?;
        let places = tokens.iter().flat_map(|t| &self.positions[t * width..][..width]);
        let positions = ops.sequence(places.copied().collect(), width)?;
        let named = ops.vector(condition.named_numbers())?;
        let named = ops.silu(ops.apply(&self.named1, &named, 1)?)?;
        Ok(Prepared {
            embedded: ops.add(embedded, &positions)?,
            tokens,
            draft: condition.draft_latent.clone(),
            given: condition.given.iter().map(|g| g.iter().product()).collect(),
            named: ops.apply(&self.named2, &named, 1)?,
        })
    }

    /// v for the state `x` (50x50x8) at training step `t` (0 to 999, fractions allowed), for all tokens.
    pub fn forward(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared<B::Tensor>,
    ) -> Result<Vec<f32>, ModelError> {
        check_length("tokens", condition.tokens.len(), TOKENS)?;
        self.forward_some(x, t, condition, &mut KeysValues::default())
    }

    /// v at the tokens of `condition`, 0 elsewhere. The other tokens are seen through `keys_values`, where
    /// the computed tokens leave theirs; if it is empty, all tokens must be computed, and it is filled.
    pub fn forward_some(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared<B::Tensor>,
        keys_values: &mut KeysValues<B::Tensor>,
    ) -> Result<Vec<f32>, ModelError> {
        self.forward_in(x, t, condition, keys_values, Precision::F32, BlockReuse::Computed)
    }

    /// v as [`Self::forward_some`] gives it, with the precision asked for in the blocks' products, and the middle
    /// blocks computed or not.
    pub fn forward_in(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared<B::Tensor>,
        keys_values: &mut KeysValues<B::Tensor>,
        precision: Precision,
        middle: BlockReuse<'_>,
    ) -> Result<Vec<f32>, ModelError> {
        check_length("state", x.len(), LATENT)?;
        check_finite("state", x)?;
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        self.make_room(keys_values, condition.tokens.len())?;
        let (tokens, time) = self.enter(x, t, condition)?;
        let tokens = self.through_blocks(tokens, &time, &condition.tokens, keys_values, precision, middle)?;
        self.leave(&tokens, &time, x, condition)
    }

    /// A state as tokens before the first block, and the embedding of the time and the named numbers for the blocks.
    fn enter(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared<B::Tensor>,
    ) -> Result<(B::Tensor, B::Tensor), ModelError> {
        let (ops, width, places) = (&self.ops, self.config.width, &condition.tokens);
        check_length("condition", condition.embedded.numbers(), places.len() * width)?;
        let time = ops.vector(timestep_embedding(t, self.config.frequencies))?;
        let time = ops.silu(ops.apply(&self.time1, &time, 1)?)?;
        let time = ops.add(ops.apply(&self.time2, &time, 1)?, &condition.named)?;
        let time = ops.silu(time)?;
        let cells = places.iter().flat_map(|token| patch(*token));
        let patches = cells.flat_map(|cell| &x[cell * CHANNELS..][..CHANNELS]);
        let patches = ops.sequence(patches.copied().collect(), PATCH_CELLS * CHANNELS)?;
        let tokens = ops.apply(&self.embed_x, &patches, piece_of(places.len()))?;
        Ok((ops.add(tokens, &condition.embedded)?, time))
    }

    /// v at the tokens of `condition`, from the output of the last block; 0 elsewhere.
    fn leave(
        &self,
        tokens: &B::Tensor,
        time: &B::Tensor,
        x: &[f32],
        condition: &Prepared<B::Tensor>,
    ) -> Result<Vec<f32>, ModelError> {
        let (ops, places) = (&self.ops, &condition.tokens);
        let cells = || places.iter().flat_map(|token| patch(*token));
        let normed = ops.modulate(tokens, &ops.apply(&self.final_ada, time, 1)?)?;
        let patches = ops
            .download(ops.apply(&self.last, &normed, piece_of(places.len()))?)?
            .data;
        let gates = ops.download(ops.apply(&self.skip, time, 1)?)?.data;
        let added = ops.download(ops.apply(&self.skip_given, time, 1)?)?.data;
        let mut out = vec![0.0; LATENT];
        for (cell, values) in cells().zip(patches.chunks_exact(CHANNELS)) {
            let given = condition.given[cell];
            let gate = |i: usize| gates[i] + given * added[i];
            for (c, value) in values.iter().enumerate() {
                let at = cell * CHANNELS + c;
                out[at] = value + gate(c) * x[at] + gate(CHANNELS + c) * condition.draft[at];
            }
        }
        check_finite("predicted v", &out)?;
        Ok(out)
    }

    /// Makes room for keys and values of all tokens, if there is none yet: then all must be computed.
    fn make_room(&self, keys_values: &mut KeysValues<B::Tensor>, tokens: usize) -> Result<(), ModelError> {
        let row = 2 * self.config.width;
        if keys_values.0.is_empty() {
            check_length("tokens", tokens, TOKENS)?;
            let empty = |_: &B::Block| self.ops.sequence(vec![0.0; TOKENS * row], row);
            keys_values.0 = self.blocks.iter().map(empty).collect::<Result<_, _>>()?;
        }
        check_length("keys and values", keys_values.0.len(), self.blocks.len())?;
        check_length("keys and values", keys_values.0[0].numbers(), TOKENS * row)
    }

    /// Runs the blocks, all of them or the first and the last.
    fn through_blocks(
        &self,
        mut tokens: B::Tensor,
        time: &B::Tensor,
        places: &[usize],
        keys_values: &mut KeysValues<B::Tensor>,
        precision: Precision,
        mut middle: BlockReuse<'_>,
    ) -> Result<B::Tensor, ModelError> {
        let ops = &self.ops;
        let layers: Vec<&B::Linear> = self.blocks.iter().map(B::ada).collect();
        let modulations = ops.apply_each(&layers, time)?;
        let last = self.blocks.len() - 1;
        let mut before = None;
        let each = self.blocks.iter().zip(&modulations).zip(&mut keys_values.0);
        for (i, ((block, ada), keys_values)) in each.enumerate() {
            let skips = matches!(&middle, BlockReuse::Reused(added) if added.len() == tokens.numbers());
            match &mut middle {
                BlockReuse::Reused(added) if skips && i == 1 && last > 1 => {
                    let added = ops.sequence(added.to_vec(), tokens.width())?;
                    tokens = ops.add(tokens, &added)?;
                }
                BlockReuse::Kept(_) if i == 1 => before = Some(tokens.clone()),
                BlockReuse::Kept(added) if i == last && last > 1 => {
                    if let Some(before) = &before {
                        **added = ops.download(ops.subtract(&tokens, before)?)?.data;
                    }
                }
                _ => {}
            }
            if !skips || i == 0 || i == last {
                tokens = ops.block(block, tokens, ada, places, keys_values, precision)?;
            }
        }
        Ok(tokens)
    }
}
