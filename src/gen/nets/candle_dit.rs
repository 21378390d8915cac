//! The diffusion transformer written once more with candle's own operations, as plainly as it goes:
//! a reference for the fused kernels of `src/gen/model`, in values (`tests/candle.rs`) and in time
//! (`benches/networks.rs`). One frame, shapes at the seams.

use std::collections::HashMap;

use super::{ColumnHeights, DitCondition};
use candle_core::{D, DType, Device, Result, Tensor, safetensors};

const TOKENS: usize = 625;
const CHANNELS: usize = 8;
const EPSILON: f64 = 1e-6;

/// Weights by name, f32, on the CPU.
pub struct CandleDit {
    tensors: HashMap<String, Tensor>,
    width: usize,
    depth: usize,
    heads: usize,
}

impl CandleDit {
    /// From the bytes of a weight file; `heads` stands in its metadata.
    pub fn new(bytes: &[u8], heads: usize) -> Result<Self> {
        let mut tensors = safetensors::load_buffer(bytes, &Device::Cpu)?;
        for tensor in tensors.values_mut() {
            *tensor = tensor.to_dtype(DType::F32)?;
        }
        let width = tensors["time2.weight"].dim(0)?;
        let depth = (0..)
            .take_while(|i| tensors.contains_key(&format!("blocks.{i}.ada.weight")))
            .count();
        Ok(Self {
            tensors,
            width,
            depth,
            heads,
        })
    }

    fn linear(&self, name: &str, x: &Tensor) -> Result<Tensor> {
        let y = x.matmul(&self.tensors[&format!("{name}.weight")].t()?)?;
        match self.tensors.get(&format!("{name}.bias")) {
            Some(bias) => y.broadcast_add(bias),
            None => Ok(y),
        }
    }

    /// Layer norm without learned scale, then x * (1 + scale) + shift; x [625, W], shift and scale [1, W].
    fn modulate(x: &Tensor, shift: &Tensor, scale: &Tensor) -> Result<Tensor> {
        let centered = x.broadcast_sub(&x.mean_keepdim(D::Minus1)?)?;
        let variance = centered.sqr()?.mean_keepdim(D::Minus1)?;
        let normed = centered.broadcast_div(&(variance + EPSILON)?.sqrt()?)?;
        normed.broadcast_mul(&(scale + 1.0)?)?.broadcast_add(shift)
    }

    /// Fixed sin-cos of the 25 x 25 token grid: the column in the first half of the channels, the row in the second.
    fn positions(&self) -> Result<Tensor> {
        let quarter = self.width / 4;
        let mut out = Vec::with_capacity(TOKENS * self.width);
        for token in 0..TOKENS {
            for at in [token % 25, token / 25] {
                let angle = |i: usize| at as f64 / 10000f64.powf(i as f64 / quarter as f64);
                out.extend((0..quarter).map(|i| angle(i).sin() as f32));
                out.extend((0..quarter).map(|i| angle(i).cos() as f32));
            }
        }
        Tensor::from_vec(out, (TOKENS, self.width), &Device::Cpu)
    }

    /// The condition as tokens [625, W].
    pub fn condition(&self, c: &DitCondition) -> Result<Tensor> {
        let cell = |i: usize, j: usize| -> Vec<f32> {
            let at = i * 50 + j;
            let mut features = vec![c.mask[at]];
            let mut heading = [0.0; 2];
            features.extend(&c.context[at * CHANNELS..(at + 1) * CHANNELS]);
            features.extend(&c.draft_latent[at * CHANNELS..(at + 1) * CHANNELS]);
            for column in 0..16 {
                let place = (4 * i + column / 4) * 200 + 4 * j + column % 4;
                features.extend((0..18).map(|layer| (c.bev[place] >> layer & 1) as f32));
                if let Some(code) = c.heading[place].checked_sub(1) {
                    let (sin, cos) = (f32::from(code) * std::f32::consts::TAU / 240.0).sin_cos();
                    heading = [heading[0] + cos / 16.0, heading[1] + sin / 16.0];
                }
            }
            features.extend(heading);
            let columns = (0..16).map(|k| c.columns[(4 * i + k / 4) * 200 + 4 * j + k % 4]);
            let columns: Vec<ColumnHeights> = columns.collect();
            let ground = f32::from(u8::from(c.ground));
            features.extend(c.given[at]);
            for (group, given) in c.given[at].iter().enumerate() {
                let stands = |k: &ColumnHeights| k.standing[group][1] > 0;
                let bins = |n: u8| f32::from(n) / 16.0;
                features.extend(columns.iter().map(|k| given * f32::from(u8::from(stands(k)))));
                features.extend(
                    columns
                        .iter()
                        .map(|k| given * bins(k.standing[group][0].saturating_sub(1))),
                );
                features.extend(columns.iter().map(|k| given * bins(k.standing[group][1])));
            }
            features.push(ground);
            features.extend(columns.iter().map(|k| ground * f32::from(k.ground) / 16.0));
            features
        };
        let tokens = patches(cell);
        let n = tokens.len() / TOKENS;
        let tokens = Tensor::from_vec(tokens, (TOKENS, n), &Device::Cpu)?;
        self.linear("embed_condition", &tokens)? + self.positions()?
    }

    /// v [2500 * 8] for the noisy latent `state` at training step `t`; `condition` is what
    /// [`condition`](Self::condition) makes of `c`.
    pub fn forward(&self, state: &[f32], t: f64, c: &DitCondition, condition: &Tensor) -> Result<Vec<f32>> {
        let (draft, given) = (&c.draft_latent, &c.given);
        let frequencies = self.tensors["time1.weight"].dim(1)? / 2;
        let angle = |i: usize| t * (-(10000f64.ln()) * i as f64 / frequencies as f64).exp();
        let mut time: Vec<f32> = (0..frequencies).map(|i| angle(i).cos() as f32).collect();
        time.extend((0..frequencies).map(|i| angle(i).sin() as f32));
        let time = Tensor::from_vec(time, (1, 2 * frequencies), &Device::Cpu)?;
        let mut named: Vec<f32> = c.named.iter().map(|n| n.unwrap_or(0.0)).collect();
        named.extend(c.named.iter().map(|n| f32::from(u8::from(n.is_some()))));
        named.push(f32::from(u8::from(draft.iter().any(|v| *v != 0.0))));
        let named = Tensor::from_vec(named, (1, 9), &Device::Cpu)?;
        let named = self.linear("named2", &self.linear("named1", &named)?.silu()?)?;
        let time = self.linear("time2", &self.linear("time1", &time)?.silu()?)?;
        let c = (time + named)?.silu()?; // [1, W]
        let tokens = patches(|i, j| state[(i * 50 + j) * CHANNELS..][..CHANNELS].to_vec());
        let tokens = Tensor::from_vec(tokens, (TOKENS, 4 * CHANNELS), &Device::Cpu)?;
        let mut x = (self.linear("embed_x", &tokens)? + condition)?; // [625, W]
        for i in 0..self.depth {
            let name = |part: &str| format!("blocks.{i}.{part}");
            let ada = self.linear(&name("ada"), &c)?.chunk(6, 1)?;
            let qkv = self.linear(&name("qkv"), &Self::modulate(&x, &ada[0], &ada[1])?)?;
            let size = self.width / self.heads;
            let qkv = qkv
                .reshape((TOKENS, 3, self.heads, size))?
                .permute((1, 2, 0, 3))?
                .contiguous()?; // [3, H, 625, S]
            let scores = (qkv.get(0)?.matmul(&qkv.get(1)?.t()?)? / (size as f64).sqrt())?; // [H, 625, 625]
            let scores = scores.broadcast_sub(&scores.max_keepdim(D::Minus1)?)?.exp()?;
            let weights = scores.broadcast_div(&scores.sum_keepdim(D::Minus1)?)?;
            let flat = |heads: Tensor| heads.transpose(0, 1)?.reshape((TOKENS, self.width));
            let mut mixed = flat(weights.matmul(&qkv.get(2)?)?)?;
            if let Some(local) = self.tensors.get(&name("local.weight")) {
                let map = flat(qkv.get(2)?)?.t()?.reshape((1, self.width, 25, 25))?;
                let near = map.conv2d(local, 1, 1, 1, self.width)?;
                let near = near.reshape((self.width, TOKENS))?.t()?;
                mixed = (mixed + near.broadcast_add(&self.tensors[&name("local.bias")])?)?;
            }
            x = (&x + self.linear(&name("proj"), &mixed)?.broadcast_mul(&ada[2])?)?;
            let hidden = self
                .linear(&name("fc1"), &Self::modulate(&x, &ada[3], &ada[4])?)?
                .gelu_erf()?;
            x = (&x + self.linear(&name("fc2"), &hidden)?.broadcast_mul(&ada[5])?)?;
        }
        let ada = self.linear("final_ada", &c)?.chunk(2, 1)?;
        let out: Vec<f32> = self
            .linear("final", &Self::modulate(&x, &ada[0], &ada[1])?)?
            .flatten_all()?
            .to_vec1()?;
        let gates: Vec<f32> = self.linear("skip", &c)?.flatten_all()?.to_vec1()?;
        let added: Vec<f32> = self.linear("skip_given", &c)?.flatten_all()?.to_vec1()?;
        let mut latent = vec![0.0; 2500 * CHANNELS];
        for (k, cell) in out.chunks_exact(CHANNELS).enumerate() {
            let (token, part) = (k / 4, k % 4);
            let (i, j) = (token / 25 * 2 + part / 2, token % 25 * 2 + part % 2);
            let gate =
                |number: usize| gates[number] + given[i * 50 + j].iter().product::<f32>() * added[number];
            for (channel, value) in cell.iter().enumerate() {
                let at = (i * 50 + j) * CHANNELS + channel;
                latent[at] = value + gate(channel) * state[at] + gate(CHANNELS + channel) * draft[at];
            }
        }
        Ok(latent)
    }
}

/// Tokens of 2 x 2 cells, row by row, the cells of a token one after the other.
fn patches(cell: impl Fn(usize, usize) -> Vec<f32>) -> Vec<f32> {
    let mut out = Vec::new();
    for token in 0..TOKENS {
        for part in 0..4 {
            out.extend(cell(token / 25 * 2 + part / 2, token % 25 * 2 + part % 2));
        }
    }
    out
}
