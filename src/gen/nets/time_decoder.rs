//! Temporal decoder: adapts the latents of the frames of a drive for the decoder of the VAE, so that the frames do not
//! flicker. Each cell attends to the cells of all frames that lie at its place of the world. Twin of
//! `training/models/time_decoder.py`.

use rayon::prelude::*;
use serde::Deserialize;

use super::between::{Between, OFFSETS, Pair, Squares};
use super::{CELLS, CHANNELS, LATENT, ModelError, SIDE, check_finite, check_length};
use nn::Cpu;
use nn::kernels;
use nn::layers::{Linear, Norm};
use nn::ops::Ops;
use nn::transformer::piece_of;
use nn::weights::{WeightFile, WeightsError};

/// Side of the first layer's kernel, cells.
const KERNEL: usize = 3;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeDecoderConfig {
    /// Numbers of a latent cell.
    pub latent: usize,
    /// Channels of a cell inside.
    pub width: usize,
    /// Attention heads.
    pub heads: usize,
    /// Blocks, one after another.
    pub blocks: usize,
}

struct CellBlock {
    norm1: Norm,
    norm2: Norm,
    q: Linear,
    kv: Linear,
    q_offset: Linear,
    kv_offset: Linear,
    proj: Linear,
    fc1: Linear,
    fc2: Linear,
}

/// The network with its weights, on the processor.
pub struct TimeDecoder {
    config: TimeDecoderConfig,
    lift: Linear,
    blocks: Vec<CellBlock>,
    head: Linear,
}

impl TimeDecoder {
    /// File name of the weights.
    pub const FILE: &str = "time_decoder.safetensors";

    /// The weights that ship with the program.
    pub fn bundled() -> Result<Self, WeightsError> {
        Self::new(WeightFile::parse(Self::FILE, assets::weights::TIME_DECODER)?)
    }

    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: TimeDecoderConfig = file.config("config")?;
        let sound = config.latent == CHANNELS
            && (1..=4096).contains(&config.width)
            && config.heads > 0
            && config.width.is_multiple_of(config.heads)
            && (1..=256).contains(&config.blocks);
        if !sound {
            return Err(file.config_error("config", format!("sizes out of range: {config:?}")));
        }
        let width = config.width;
        let weight = file.take("lift.weight", &[width, CHANNELS, KERNEL, KERNEL])?;
        let bias = file.take("lift.bias", &[width])?;
        let lift = Linear::from_parts(&weight, bias, CHANNELS * KERNEL * KERNEL);
        let blocks = (0..config.blocks)
            .map(|i| CellBlock::new(&mut file, &format!("blocks.{i}"), &config))
            .collect::<Result<_, WeightsError>>()?;
        let head = Cpu.linear(&mut file, "head", [width, CHANNELS], &[])?;
        file.finish()?;
        Ok(Self {
            config,
            lift,
            blocks,
            head,
        })
    }

    /// Latents for the decoder from the latents (50x50x8 each) of the frames of a drive, whose vehicles stand at these
    /// places (x and y in m, heading in rad) every `step_s` seconds. Errors on other lengths and numbers that are not
    /// finite.
    pub fn apply(
        &self,
        latents: &[Vec<f32>],
        poses: &[[f64; 3]],
        step_s: f64,
    ) -> Result<Vec<Vec<f32>>, ModelError> {
        check_length("places of frames", poses.len(), latents.len())?;
        for latent in latents {
            check_length("latent", latent.len(), LATENT)?;
            check_finite("latent", latent)?;
        }
        let between = Between::of(poses, step_s, Squares::CELLS);
        let piece = piece_of(CELLS);
        let mut frames: Vec<Vec<f32>> = latents
            .iter()
            .map(|latent| self.lift.parallel(&around(latent), piece))
            .collect();
        for block in &self.blocks {
            block.apply(&mut frames, &between, self.config.heads);
        }
        let added = frames.iter().map(|frame| self.head.parallel(frame, piece));
        Ok(latents
            .iter()
            .zip(added)
            .map(|(latent, added)| latent.iter().zip(added).map(|(l, a)| l + a).collect())
            .collect())
    }
}

/// For each cell the numbers of the cells around it, `[cell][channel][x][y]`; 0 beyond the edge.
fn around(latent: &[f32]) -> Vec<f32> {
    let area = KERNEL * KERNEL;
    let mut out = vec![0.0; CELLS * CHANNELS * area];
    for (cell, out) in out.chunks_exact_mut(CHANNELS * area).enumerate() {
        for tap in 0..area {
            // Coordinates are counted from one cell beyond the edge; places beyond the map are left out.
            let (x, y) = (cell / SIDE + tap / KERNEL, cell % SIDE + tap % KERNEL);
            if (1..=SIDE).contains(&x) && (1..=SIDE).contains(&y) {
                let from = &latent[((x - 1) * SIDE + y - 1) * CHANNELS..][..CHANNELS];
                for (channel, value) in from.iter().enumerate() {
                    out[channel * area + tap] = *value;
                }
            }
        }
    }
    out
}

impl CellBlock {
    fn new(file: &mut WeightFile<'_>, name: &str, config: &TimeDecoderConfig) -> Result<Self, WeightsError> {
        let width = config.width;
        let norm = |file: &mut WeightFile<'_>, which| Norm::new(file, &format!("{name}.{which}"), width);
        let (norm1, norm2) = (norm(file, "norm1")?, norm(file, "norm2")?);
        let kv_offset = Cpu.linear_without_bias(file, &format!("{name}.kv_offset"), [OFFSETS, 2 * width])?;
        let mut linear =
            |which, inputs, outputs| Cpu.linear(file, &format!("{name}.{which}"), [inputs, outputs], &[]);
        Ok(Self {
            norm1,
            norm2,
            q: linear("q", width, width)?,
            kv: linear("kv", width, 2 * width)?,
            q_offset: linear("q_offset", width, config.heads * OFFSETS)?,
            kv_offset,
            proj: linear("proj", width, width)?,
            fc1: linear("fc1", width, 2 * width)?,
            fc2: linear("fc2", 2 * width, width)?,
        })
    }

    /// Applies the block in place over the cells of all frames.
    fn apply(&self, frames: &mut [Vec<f32>], between: &Between, heads: usize) {
        let piece = piece_of(CELLS);
        let width = self.q.outputs();
        let told: Vec<CellProjections> = frames.iter().map(|cells| self.told(cells, piece)).collect();
        for (f, cells) in frames.iter_mut().enumerate() {
            let pieces = cells.par_chunks_mut(piece * width).enumerate();
            pieces.for_each(|(at, x)| {
                let mut heard = vec![0.0; x.len()];
                for (i, out) in heard.chunks_exact_mut(width).enumerate() {
                    self.attend(&told, between, (f, at * piece + i), heads, out);
                }
                let mut out = vec![0.0; x.len()];
                self.proj.rows(&heard, &mut out);
                x.iter_mut().zip(&out).for_each(|(x, o)| *x += o);
                self.norm2.rows(x, &mut heard);
                let mut hidden = vec![0.0; 2 * x.len()];
                self.fc1.rows(&heard, &mut hidden);
                kernels::gelu_all(&mut hidden);
                self.fc2.rows(&hidden, &mut out);
                x.iter_mut().zip(&out).for_each(|(x, o)| *x += o);
            });
        }
    }

    fn told(&self, cells: &[f32], piece: usize) -> CellProjections {
        let mut normed = vec![0.0; cells.len()];
        self.norm1.rows(cells, &mut normed);
        CellProjections {
            queries: self.q.parallel(&normed, piece),
            keys_values: self.kv.parallel(&normed, piece),
            asked: self.q_offset.parallel(&normed, piece),
        }
    }

    /// Attention of one cell to its place in all frames, head by head.
    fn attend(
        &self,
        told: &[CellProjections],
        between: &Between,
        (frame, cell): (usize, usize),
        heads: usize,
        out: &mut [f32],
    ) {
        let width = out.len();
        let head_width = width / heads;
        let shrink = 1.0 / (head_width as f32).sqrt();
        let seen: Vec<(usize, &Pair)> = (0..told.len())
            .filter_map(|s| between.at(frame, s, cell).map(|pair| (s, pair)))
            .collect();
        let offsets: Vec<f32> = seen.iter().flat_map(|(_, (_, offset))| *offset).collect();
        let mut there = self.kv_offset.vector(&offsets);
        for (row, (s, (n, _))) in there.chunks_exact_mut(2 * width).zip(&seen) {
            let heard = &told[*s].keys_values[usize::from(*n) * 2 * width..];
            row.iter_mut().zip(heard).for_each(|(r, h)| *r = h * (1.0 + *r));
        }
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        for head in 0..heads {
            let channels = head * head_width..(head + 1) * head_width;
            let query = &told[frame].queries[cell * width..][channels.clone()];
            let asked = &told[frame].asked[(cell * heads + head) * OFFSETS..][..OFFSETS];
            let pairs = there.chunks_exact(2 * width).zip(&seen);
            let mut weights: Vec<f32> = pairs
                .map(|(row, (_, (_, offset)))| {
                    dot(query, &row[channels.clone()]) * shrink + dot(asked, offset)
                })
                .collect();
            let most = weights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            weights.iter_mut().for_each(|w| *w = (*w - most).exp());
            let sum: f32 = weights.iter().sum();
            for (row, weight) in there.chunks_exact(2 * width).zip(&weights) {
                let values = &row[width..][channels.clone()];
                let out = &mut out[channels.clone()];
                out.iter_mut()
                    .zip(values)
                    .for_each(|(o, v)| *o += weight / sum * v);
            }
        }
    }
}

/// Projections of the cells of a frame, for attention.
struct CellProjections {
    queries: Vec<f32>,
    keys_values: Vec<f32>,
    /// Weights of the offsets in the scores, for each query.
    asked: Vec<f32>,
}
