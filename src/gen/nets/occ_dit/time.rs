//! Temporal blocks of the occupancy transformer: between its own blocks each token attends to the tokens of all frames
//! of a drive that lie at its place of the world. Twin of `training/models/occ_dit_time.py`.

use rayon::prelude::*;
use serde::Deserialize;

use super::{OccDit, Prepared, TOKENS};
use crate::between::{Between, OFFSETS, Pair};
use crate::{LATENT, ModelError, check_finite, check_length};
use nn::kernels;
use nn::layers::{Linear, NORM_EPS};
use nn::ops::Ops;
use nn::transformer::piece_of;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Precision};

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeConfig {
    /// Channels of a token; as the transformer has.
    pub width: usize,
    /// Attention heads.
    pub heads: usize,
    /// Temporal blocks.
    pub blocks: usize,
    /// Number of blocks of the transformer before each temporal block.
    pub every: usize,
    /// True if keys come from the same token of each frame, instead of the same place of the world.
    pub same_cell: bool,
}

struct TimeBlock {
    ada: Linear,
    qkv: Linear,
    q_offset: Linear,
    v_offset: Linear,
    proj: Linear,
    fc1: Linear,
    fc2: Linear,
}

/// The temporal blocks with their weights, on the processor.
pub struct OccDitTime {
    config: TimeConfig,
    blocks: Vec<TimeBlock>,
}

impl OccDitTime {
    /// Most frames that are worked on together.
    pub const MOST_FRAMES: usize = 32;

    /// File name of the weights.
    pub const FILE: &str = "occ_dit_time.safetensors";

    /// The weights that ship with the program.
    pub fn bundled() -> Result<Self, WeightsError> {
        Self::new(WeightFile::parse(Self::FILE, assets::weights::OCC_DIT_TIME)?)
    }

    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: TimeConfig = file.config("config")?;
        let sound = (1..=4096).contains(&config.width)
            && config.heads > 0
            && config.width.is_multiple_of(config.heads)
            && (1..=256).contains(&config.blocks)
            && config.every > 0;
        if !sound {
            return Err(file.config_error("config", format!("sizes out of range: {config:?}")));
        }
        let (width, offsets) = (config.width, config.heads * OFFSETS);
        let block = |i: usize| {
            let mut linear = |name: &str, inputs, outputs| {
                Cpu.linear(&mut file, &format!("blocks.{i}.{name}"), [inputs, outputs], &[])
            };
            Ok(TimeBlock {
                ada: linear("ada", width, 6 * width)?,
                qkv: linear("qkv", width, 3 * width)?,
                q_offset: linear("q_offset", width, offsets)?,
                proj: linear("proj", width, width)?,
                fc1: linear("fc1", width, 2 * width)?,
                fc2: linear("fc2", 2 * width, width)?,
                v_offset: Cpu.linear_without_bias(
                    &mut file,
                    &format!("blocks.{i}.v_offset"),
                    [offsets, width],
                )?,
            })
        };
        let blocks = (0..config.blocks)
            .map(block)
            .collect::<Result<_, WeightsError>>()?;
        file.finish()?;
        Ok(Self { config, blocks })
    }

    /// Sizes of the network.
    pub fn config(&self) -> &TimeConfig {
        &self.config
    }

    /// v for the states `x` (each 50x50x8) of the frames of a drive at training step `t`. Conditions are of all tokens, one for
    /// each frame. Errors on other lengths and numbers that are not finite.
    pub fn forward(
        &self,
        dit: &OccDit,
        x: &[Vec<f32>],
        t: f32,
        conditions: &[Prepared],
        between: &Between,
    ) -> Result<Vec<Vec<f32>>, ModelError> {
        check_length("conditions", conditions.len(), x.len())?;
        check_length("places of frames", between.frames(), x.len())?;
        check_length("places of tokens", between.squares(), TOKENS)?;
        check_length("channels of temporal blocks", self.config.width, dit.config.width)?;
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        let (mut frames, mut times) = (Vec::new(), Vec::new());
        for (x, condition) in x.iter().zip(conditions) {
            check_length("state", x.len(), LATENT)?;
            check_finite("state", x)?;
            check_length("tokens", condition.tokens(), TOKENS)?;
            let (tokens, time) = dit.enter(x, t, condition)?;
            frames.push(tokens);
            times.push(time);
        }
        let places: Vec<usize> = (0..TOKENS).collect();
        let row = 2 * dit.config.width;
        let mut keys_values = Cpu.sequence(vec![0.0; TOKENS * row], row)?;
        for (i, block) in dit.blocks.iter().enumerate() {
            for (tokens, time) in frames.iter_mut().zip(&times) {
                let ada = Cpu.apply(Cpu::ada(block), time, 1)?;
                let empty = Cpu.sequence(Vec::new(), dit.config.width)?;
                let before = std::mem::replace(tokens, empty);
                *tokens = Cpu.block(block, before, &ada, &places, &mut keys_values, Precision::F32)?;
            }
            let behind = (i + 1)
                .is_multiple_of(self.config.every)
                .then(|| (i + 1) / self.config.every - 1);
            if let Some(temporal) = behind.and_then(|k| self.blocks.get(k)) {
                let mut data: Vec<&mut [f32]> = frames.iter_mut().map(|f| f.data.as_mut_slice()).collect();
                let times: Vec<&[f32]> = times.iter().map(|t| t.data.as_slice()).collect();
                temporal.apply(&mut data, &times, between, self.config.heads);
            }
        }
        let each = frames.iter().zip(&times).zip(x.iter().zip(conditions));
        each.map(|((tokens, time), (x, condition))| dit.leave(tokens, time, x, condition))
            .collect()
    }
}

impl TimeBlock {
    /// In place over the tokens of all frames.
    fn apply(&self, frames: &mut [&mut [f32]], times: &[&[f32]], between: &Between, heads: usize) {
        let adas: Vec<Vec<f32>> = times.iter().map(|time| self.ada.vector(time)).collect();
        let width = adas[0].len() / 6;
        let part = |f: usize, i: usize| &adas[f][i * width..][..width];
        let scale = |f: usize, i: usize| part(f, i).iter().map(|s| 1.0 + s).collect::<Vec<f32>>();
        let piece = piece_of(TOKENS);
        let mut told = Vec::new(); // of each frame: queries, keys and values, and what queries ask of offsets
        for (f, tokens) in frames.iter().enumerate() {
            let mut normed = vec![0.0; tokens.len()];
            kernels::norm_rows(tokens, NORM_EPS, &scale(f, 1), part(f, 0), &mut normed);
            told.push((
                self.qkv.parallel(&normed, piece),
                self.q_offset.parallel(&normed, piece),
            ));
        }
        for (f, tokens) in frames.iter_mut().enumerate() {
            let (scale2, told) = (scale(f, 4), &told);
            tokens
                .par_chunks_mut(piece * width)
                .enumerate()
                .for_each(|(at, x)| {
                    let (mut attended, mut places) =
                        (vec![0.0; x.len()], vec![0.0; x.len() / width * heads * OFFSETS]);
                    let rows = attended
                        .chunks_exact_mut(width)
                        .zip(places.chunks_exact_mut(heads * OFFSETS));
                    for (i, (out, place)) in rows.enumerate() {
                        attend(told, between, (f, at * piece + i), heads, out, place);
                    }
                    let mut out = vec![0.0; x.len()];
                    self.v_offset.rows(&places, &mut out);
                    attended.iter_mut().zip(&out).for_each(|(a, o)| *a += o);
                    self.proj.rows(&attended, &mut out);
                    kernels::add_gated(x, part(f, 2), &out);
                    kernels::norm_rows(x, NORM_EPS, &scale2, part(f, 3), &mut attended);
                    let mut hidden = vec![0.0; 2 * x.len()];
                    self.fc1.rows(&attended, &mut hidden);
                    kernels::gelu_all(&mut hidden);
                    self.fc2.rows(&hidden, &mut out);
                    kernels::add_gated(x, part(f, 5), &out);
                });
        }
    }
}

/// Attention of one token to its place in all frames: values into `out`, offsets into `place`, both head by head.
fn attend(
    told: &[(Vec<f32>, Vec<f32>)],
    between: &Between,
    (frame, token): (usize, usize),
    heads: usize,
    out: &mut [f32],
    place: &mut [f32],
) {
    let width = out.len();
    let head_width = width / heads;
    let shrink = 1.0 / (head_width as f32).sqrt();
    let seen: Vec<(usize, &Pair)> = (0..told.len())
        .filter_map(|s| between.at(frame, s, token).map(|pair| (s, pair)))
        .collect();
    let row = |s: usize, n: usize, part: usize| &told[s].0[(n * 3 + part) * width..][..width];
    let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    for head in 0..heads {
        let channels = head * head_width..(head + 1) * head_width;
        let query = &row(frame, token, 0)[channels.clone()];
        let asked = &told[frame].1[(token * heads + head) * OFFSETS..][..OFFSETS];
        let score = |&(s, (n, offset)): &(usize, &Pair)| {
            dot(query, &row(s, usize::from(*n), 1)[channels.clone()]) * shrink + dot(asked, offset)
        };
        let scores: Vec<f32> = seen.iter().map(score).collect();
        let most = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let weights: Vec<f32> = scores.iter().map(|s| (s - most).exp()).collect();
        let sum: f32 = weights.iter().sum();
        for ((s, (n, offset)), weight) in seen.iter().zip(&weights) {
            let weight = weight / sum;
            let values = &row(*s, usize::from(*n), 2)[channels.clone()];
            out[channels.clone()]
                .iter_mut()
                .zip(values)
                .for_each(|(o, v)| *o += weight * v);
            let offsets = &mut place[head * OFFSETS..][..OFFSETS];
            offsets.iter_mut().zip(offset).for_each(|(p, o)| *p += weight * o);
        }
    }
}
