//! The layout network: messages along typed relations give every node an embedding; a denoiser then predicts v for all
//! boxes and lanes at once, its attention biased by the relations and open to the map. Twin of training/models/layout.py.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use serde::Deserialize;

use super::input::{KINDS, LayoutInput, MAP_CHANNELS, MAP_SIDE, Shape, VALUES};
use crate::{ModelError, check_finite, check_length};
use nn::kernels;
use nn::layers::{Linear, NORM_EPS, View, matmul};
use nn::weights::{self, WeightFile, WeightsError};
use scene::graph::RelationKind;

/// File name of the weights.
pub const FILE: &str = "layout.safetensors";
/// Most nodes that one call takes: attention over them is quadratic.
pub const MOST_NODES: usize = 512;

const RELATIONS: usize = RelationKind::ALL.len();
/// Cells of a map token along one side, and the means it is seen as.
const PATCH: usize = 20;
const SUB: usize = 10;
const TOKENS_PER_SIDE: usize = MAP_SIDE / PATCH;
const TOKENS: usize = TOKENS_PER_SIDE * TOKENS_PER_SIDE;
/// The map under a box, the place within the cell, whether there is a map.
const LOCAL: usize = MAP_CHANNELS + 3;
/// Rows that go through a layer in one piece.
const PIECE: usize = 32;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutConfig {
    /// Channels of a node.
    pub width: usize,
    /// Blocks of the denoiser.
    pub depth: usize,
    /// Attention heads.
    pub heads: usize,
    /// Rounds of messages.
    pub rounds: usize,
    /// Channels between the two layers behind attention.
    pub hidden: usize,
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
}

impl LayoutConfig {
    fn check(&self) -> Result<(), String> {
        let in_range = |name: &str, value: usize, most: usize| {
            let fits = (1..=most).contains(&value);
            fits.then_some(())
                .ok_or(format!("{name}: expected 1 to {most}, found {value}"))
        };
        in_range("width", self.width, 1024)?;
        in_range("depth", self.depth, 64)?;
        in_range("rounds", self.rounds, 64)?;
        in_range("hidden", self.hidden, 4096)?;
        in_range("frequencies", self.frequencies, 1024)?;
        if self.heads == 0 || !self.width.is_multiple_of(self.heads) {
            return Err(format!(
                "heads: expected a divisor of {}, found {}",
                self.width, self.heads
            ));
        }
        if !self.frequencies.is_multiple_of(2) {
            return Err(format!(
                "frequencies: expected an even number, found {}",
                self.frequencies
            ));
        }
        Ok(())
    }
}

struct Round {
    source: Linear,
    target: Linear,
    relation: Vec<f32>, // [2 * relations][width]
    distance: Linear,
    out: Linear,
}

struct Block {
    qkv: Linear,
    map_kv: Linear,
    proj: Linear,
    fc1: Linear,
    fc2: Linear,
    shift: Vec<f32>, // [6][width]
    bias: Vec<f32>,  // [2 * relations + 1][heads]
}

/// The network.
pub struct LayoutNet {
    config: LayoutConfig,
    kind: Vec<f32>,
    state: Vec<f32>,
    size: Vec<f32>,
    given: Linear,
    rounds: Vec<Round>,
    node: Linear,
    enter: Linear,
    patch: Linear,
    place: Vec<f32>,
    time: [Linear; 2],
    modulation: Linear,
    blocks: Vec<Block>,
    last: Linear,
    leave: Linear,
    hash: u64,
}

/// What does not change while one layout is sampled.
pub struct Embedded<'a> {
    input: &'a LayoutInput,
    nodes: Vec<f32>,       // [N][width]
    map_kv: Vec<Vec<f32>>, // per block [TOKENS][2 width]; empty without a map
    bias: Vec<Vec<f32>>,   // per block [heads][N][N]
    cells: Vec<f32>,       // the map as numbers, [100][100][8]; empty without a map
}

impl LayoutNet {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<LayoutNet>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let bytes = assets::weights::LAYOUT;
        let net = Self::new(WeightFile::parse(FILE, bytes)?)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }

    /// `layout.safetensors` of a folder.
    pub fn from_dir(folder: &Path) -> Result<Arc<Self>, WeightsError> {
        Ok(Arc::new(Self::new(WeightFile::parse(
            FILE,
            &weights::read(&folder.join(FILE))?,
        )?)?))
    }

    /// Takes all tensors of the file.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let c: LayoutConfig = file.config("config")?;
        c.check().map_err(|reason| file.config_error("config", reason))?;
        let (width, w) = (c.width, &mut file);
        let rounds = (0..c.rounds).map(|i| {
            let name = |part: &str| format!("rounds.{i}.{part}");
            Ok(Round {
                source: Linear::new(w, &name("source"), width, width, &[])?,
                target: Linear::without_bias(w, &name("target"), width, width, &[])?,
                relation: w.take(&name("relation.weight"), &[2 * RELATIONS, width])?,
                distance: Linear::without_bias(w, &name("distance"), 2, width, &[])?,
                out: Linear::new(w, &name("out"), width, width, &[])?,
            })
        });
        let rounds: Vec<Round> = rounds.collect::<Result<_, WeightsError>>()?;
        let blocks = (0..c.depth).map(|i| {
            let name = |part: &str| format!("blocks.{i}.{part}");
            Ok(Block {
                qkv: Linear::new(w, &name("qkv"), width, 3 * width, &[])?,
                map_kv: Linear::new(w, &name("map_kv"), width, 2 * width, &[])?,
                proj: Linear::new(w, &name("proj"), width, width, &[])?,
                fc1: Linear::new(w, &name("fc1"), width, c.hidden, &[])?,
                fc2: Linear::new(w, &name("fc2"), c.hidden, width, &[])?,
                shift: w.take(&name("shift"), &[6, width])?,
                bias: w.take(&name("bias.weight"), &[2 * RELATIONS + 1, c.heads])?,
            })
        });
        let blocks: Vec<Block> = blocks.collect::<Result<_, WeightsError>>()?;
        let net = Self {
            kind: w.take("kind.weight", &[KINDS, width])?,
            state: w.take("state.weight", &[4, width])?,
            size: w.take("size.weight", &[3, width])?,
            given: Linear::new(w, "given", VALUES + 1, width, &[])?,
            node: Linear::new(w, "node", width, width, &[])?,
            enter: Linear::new(w, "enter", VALUES + LOCAL, width, &[])?,
            patch: Linear::new(w, "patch", SUB * SUB * MAP_CHANNELS, width, &[])?,
            place: w.take("place", &[TOKENS, width])?,
            time: [
                Linear::new(w, "time1", c.frequencies, width, &[])?,
                Linear::new(w, "time2", width, width, &[])?,
            ],
            modulation: Linear::new(w, "modulation", width, 6 * width, &[])?,
            last: Linear::new(w, "last", width, 2 * width, &[])?,
            leave: Linear::new(w, "leave", width, VALUES, &[])?,
            hash: w.hash(),
            rounds,
            blocks,
            config: c,
        };
        file.finish()?;
        Ok(net)
    }

    /// FNV-1a of the weight file.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Runs the graph network and reads the map. Refuses more than [`MOST_NODES`] nodes, edges beyond the nodes, and a
    /// map of another size.
    pub fn embed<'a>(&self, input: &'a LayoutInput) -> Result<Embedded<'a>, ModelError> {
        let (width, n) = (self.config.width, input.nodes.len());
        if n > MOST_NODES {
            check_length("layout graph", n, MOST_NODES)?;
        }
        let mut h = vec![0.0; n * width];
        let mut given = vec![0.0; n * (VALUES + 1)];
        for (i, node) in input.nodes.iter().enumerate() {
            check_finite("given geometry", &node.values)?;
            let rows = [
                row(&self.kind, width, node.kind.min(KINDS as u8 - 1)),
                row(&self.state, width, node.state.min(3)),
                row(&self.size, width, node.size.min(2)),
            ];
            for (k, out) in h[i * width..(i + 1) * width].iter_mut().enumerate() {
                *out = rows[0][k] + rows[1][k] + rows[2][k];
            }
            let given = &mut given[i * (VALUES + 1)..(i + 1) * (VALUES + 1)];
            if node.locked {
                let own = node.shape.channels();
                given[own.clone()].copy_from_slice(&node.values[own]);
                given[VALUES] = 1.0;
            }
        }
        let shown = self.given.parallel(&given, PIECE);
        h.iter_mut().zip(&shown).for_each(|(h, g)| *h += g);
        let edges: Vec<(usize, usize, usize, [f32; 2])> = directed(input)?;
        for round in &self.rounds {
            round.apply(&mut h, width, &edges);
        }
        let nodes = self.node.parallel(&normed(&h, width), PIECE);
        let (cells, tokens) = match &input.map {
            None => (Vec::new(), Vec::new()),
            Some(map) => {
                check_length("layout map", map.len(), MAP_SIDE * MAP_SIDE * MAP_CHANNELS)?;
                let cells: Vec<f32> = map.iter().map(|v| (f32::from(*v) - 128.0) / 127.0).collect();
                let tokens = self.tokens(&cells);
                (cells, tokens)
            }
        };
        let map_kv = self
            .blocks
            .iter()
            .map(|b| b.map_kv.parallel(&tokens, PIECE))
            .collect();
        let heads = self.config.heads;
        let bias = self.blocks.iter().map(|b| {
            let mut bias = vec![0.0; heads * n * n];
            for (source, target, relation, _) in &edges {
                // Torch adds the row of (query = from, key = to, relation) and its mirror image; `edges` has both.
                for head in 0..heads {
                    bias[(head * n + source) * n + target] += b.bias[relation * heads + head];
                }
            }
            bias
        });
        Ok(Embedded {
            input,
            nodes,
            map_kv,
            bias: bias.collect(),
            cells,
        })
    }

    fn tokens(&self, cells: &[f32]) -> Vec<f32> {
        let (width, step) = (self.config.width, PATCH / SUB);
        let mut seen = vec![0.0; TOKENS * SUB * SUB * MAP_CHANNELS];
        for (token, out) in seen.chunks_exact_mut(SUB * SUB * MAP_CHANNELS).enumerate() {
            let (px, py) = (token / TOKENS_PER_SIDE * PATCH, token % TOKENS_PER_SIDE * PATCH);
            for (sub, out) in out.chunks_exact_mut(MAP_CHANNELS).enumerate() {
                for k in 0..step * step {
                    let (x, y) = (px + sub / SUB * step + k / step, py + sub % SUB * step + k % step);
                    let cell = &cells[(x * MAP_SIDE + y) * MAP_CHANNELS..][..MAP_CHANNELS];
                    out.iter_mut()
                        .zip(cell)
                        .for_each(|(o, c)| *o += c / (step * step) as f32);
                }
            }
        }
        let mut tokens = self.patch.parallel(&seen, PIECE);
        tokens.iter_mut().zip(&self.place).for_each(|(t, p)| *t += p);
        kernels::gelu_all(&mut tokens);
        normed(&tokens, width)
    }

    /// v for the state `x` `[N][24]` at training step `t`; locked nodes show their own values whatever `x` says.
    pub fn predict(&self, embedded: &Embedded<'_>, x: &[f64], t: f64) -> Result<Vec<f64>, ModelError> {
        let (width, n) = (self.config.width, embedded.input.nodes.len());
        check_length("layout state", x.len(), n * VALUES)?;
        if !(0.0..=999.0).contains(&t) {
            return Err(ModelError::Timestep(t as f32));
        }
        let mut seen = vec![0.0; n * (VALUES + LOCAL)];
        for ((out, x), node) in seen
            .chunks_exact_mut(VALUES + LOCAL)
            .zip(x.chunks_exact(VALUES))
            .zip(&embedded.input.nodes)
        {
            for k in node.shape.channels() {
                out[k] = if node.locked { node.values[k] } else { x[k] as f32 };
            }
            if node.shape == Shape::Box && !embedded.cells.is_empty() {
                let (out, place) = out.split_at_mut(VALUES);
                local(&embedded.cells, [out[0], out[1]], place);
            }
        }
        check_finite("layout state", &seen)?;
        let mut h = self.enter.parallel(&seen, PIECE);
        h.iter_mut().zip(&embedded.nodes).for_each(|(h, e)| *h += e);
        let mut c = self.time[0].vector(&timestep_embedding(t as f32, self.config.frequencies));
        c.iter_mut().for_each(|v| *v = kernels::silu(*v));
        let mut c = self.time[1].vector(&c);
        c.iter_mut().for_each(|v| *v = kernels::silu(*v));
        let modulation = self.modulation.vector(&c);
        for ((block, map_kv), bias) in self.blocks.iter().zip(&embedded.map_kv).zip(&embedded.bias) {
            block.apply(&mut h, &modulation, map_kv, bias, &self.config);
        }
        let last = self.last.vector(&c);
        let (shift, scale) = last.split_at(width);
        let y = modulated(&h, shift, scale);
        let out = self.leave.parallel(&y, PIECE);
        check_finite("layout network", &out)?;
        let free = |i: usize| {
            let node = &embedded.input.nodes[i / VALUES];
            !node.locked && node.shape.channels().contains(&(i % VALUES))
        };
        Ok(out
            .iter()
            .enumerate()
            .map(|(i, v)| if free(i) { f64::from(*v) } else { 0.0 })
            .collect())
    }
}

fn row(table: &[f32], width: usize, index: u8) -> &[f32] {
    &table[usize::from(index) * width..][..width]
}

fn normed(x: &[f32], width: usize) -> Vec<f32> {
    let mut out = vec![0.0; x.len()];
    kernels::norm_rows(x, NORM_EPS, &vec![1.0; width], &vec![0.0; width], &mut out);
    out
}

fn modulated(x: &[f32], shift: &[f32], scale: &[f32]) -> Vec<f32> {
    let scale: Vec<f32> = scale.iter().map(|s| 1.0 + s).collect();
    let mut out = vec![0.0; x.len()];
    kernels::norm_rows(x, NORM_EPS, &scale, shift, &mut out);
    out
}

fn timestep_embedding(t: f32, n: usize) -> Vec<f32> {
    let angle = |i: usize| f64::from(t) * (-(10_000f64.ln()) * i as f64 / (n / 2) as f64).exp();
    let (cos, sin) = (
        (0..n / 2).map(|i| angle(i).cos()),
        (0..n / 2).map(|i| angle(i).sin()),
    );
    cos.chain(sin).map(|v| v as f32).collect()
}

/// The map's cell under a place, the place within it, and 1 for "there is a map".
fn local(cells: &[f32], place: [f32; 2], out: &mut [f32]) {
    let at = place.map(|p| (p.clamp(-2.0, 2.0) * 20.0 + 40.0) * 1.25);
    let cell = at.map(|a| a.floor().clamp(0.0, MAP_SIDE as f32 - 1.0));
    let index = cell[0] as usize * MAP_SIDE + cell[1] as usize;
    out[..MAP_CHANNELS].copy_from_slice(&cells[index * MAP_CHANNELS..][..MAP_CHANNELS]);
    out[MAP_CHANNELS] = at[0] - cell[0] - 0.5;
    out[MAP_CHANNELS + 1] = at[1] - cell[1] - 0.5;
    out[MAP_CHANNELS + 2] = 1.0;
}

/// Source, target, relation (mirrored ones beyond the first 19), stated distance.
type Directed = (usize, usize, usize, [f32; 2]);

/// Every edge both ways.
fn directed(input: &LayoutInput) -> Result<Vec<Directed>, ModelError> {
    let n = input.nodes.len();
    let mut out = Vec::with_capacity(2 * input.edges.len());
    for mirrored in [false, true] {
        for e in &input.edges {
            let (from, to) = (usize::from(e.from), usize::from(e.to));
            for (what, end) in [("edge's start", from), ("edge's end", to)] {
                if end >= n {
                    check_length(what, end, n)?;
                }
            }
            let relation = usize::from(e.relation).min(RELATIONS - 1);
            let distance = match e.distance_m {
                Some(d) if d.is_finite() => [(d / 20.0).clamp(0.0, 100.0), 1.0],
                _ => [0.0, 0.0],
            };
            out.push(if mirrored {
                (to, from, relation + RELATIONS, distance)
            } else {
                (from, to, relation, distance)
            });
        }
    }
    Ok(out)
}

impl Round {
    fn apply(&self, h: &mut [f32], width: usize, edges: &[(usize, usize, usize, [f32; 2])]) {
        let n = h.len() / width;
        let y = normed(h, width);
        let (source, target) = (self.source.parallel(&y, PIECE), self.target.parallel(&y, PIECE));
        let (mut total, mut count) = (vec![0.0f32; h.len()], vec![0.0f32; n]);
        let mut message = vec![0.0; width];
        for (from, to, relation, distance) in edges {
            let far = self.distance.vector(distance);
            let (s, t) = (&source[from * width..], &target[to * width..]);
            let r = &self.relation[relation * width..];
            for k in 0..width {
                message[k] = s[k] + t[k] + r[k] + far[k];
            }
            kernels::gelu_all(&mut message);
            let total = &mut total[to * width..(to + 1) * width];
            total.iter_mut().zip(&message).for_each(|(t, m)| *t += m);
            count[*to] += 1.0;
        }
        for (row, n) in total.chunks_exact_mut(width).zip(&count) {
            row.iter_mut().for_each(|v| *v /= n.max(1.0));
        }
        let out = self.out.parallel(&total, PIECE);
        h.iter_mut().zip(&out).for_each(|(h, o)| *h += o);
    }
}

impl Block {
    fn apply(&self, h: &mut [f32], modulation: &[f32], map_kv: &[f32], bias: &[f32], c: &LayoutConfig) {
        let width = c.width;
        let m: Vec<f32> = modulation.iter().zip(&self.shift).map(|(a, b)| a + b).collect();
        let part = |i: usize| &m[i * width..(i + 1) * width];
        let qkv = self.qkv.parallel(&modulated(h, part(0), part(1)), PIECE);
        let mixed = attention(&qkv, map_kv, bias, c);
        add_gated(h, part(2), &self.proj.parallel(&mixed, PIECE));
        let mut hidden = self.fc1.parallel(&modulated(h, part(3), part(4)), PIECE);
        kernels::gelu_all(&mut hidden);
        add_gated(h, part(5), &self.fc2.parallel(&hidden, PIECE));
    }
}

fn add_gated(h: &mut [f32], gate: &[f32], y: &[f32]) {
    for (h, y) in h.chunks_exact_mut(gate.len()).zip(y.chunks_exact(gate.len())) {
        for ((h, y), g) in h.iter_mut().zip(y).zip(gate) {
            *h += g * y;
        }
    }
}

/// Softmax(q k / sqrt(d) + bias) v over the nodes and the map's tokens, rows of all heads side by side.
fn attention(qkv: &[f32], map_kv: &[f32], bias: &[f32], c: &LayoutConfig) -> Vec<f32> {
    let (width, heads) = (c.width, c.heads);
    let (d, n, tokens) = (width / heads, qkv.len() / (3 * width), map_kv.len() / (2 * width));
    let mut out = vec![0.0; n * width];
    if n == 0 {
        return out;
    }
    let (all, scale) = (n + tokens, 1.0 / (d as f32).sqrt());
    let mix = |head: usize| {
        let (mut scores, mut mixed) = (vec![0.0f32; n * all], vec![0.0f32; n * d]);
        let nodes = |part: usize| &qkv[part * width + head * d..];
        let map = |part: usize| &map_kv[part * width + head * d..];
        let (q, keys) = (
            View::rows(nodes(0), 3 * width),
            View::columns(nodes(1), 3 * width),
        );
        matmul(&mut scores, all, false, q, keys, [n, n, d]);
        if tokens > 0 {
            let keys = View::columns(map(0), 2 * width);
            matmul(&mut scores[n..], all, false, q, keys, [n, tokens, d]);
        }
        for (i, scores) in scores.chunks_exact_mut(all).enumerate() {
            scores.iter_mut().for_each(|s| *s *= scale);
            let bias = &bias[(head * n + i) * n..][..n];
            scores.iter_mut().zip(bias).for_each(|(s, b)| *s += b);
            let most = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            scores.iter_mut().for_each(|s| *s = kernels::exp(*s - most));
            let sum: f32 = scores.iter().sum();
            scores.iter_mut().for_each(|s| *s /= sum);
        }
        let values = View::rows(nodes(2), 3 * width);
        matmul(&mut mixed, d, false, View::rows(&scores, all), values, [n, d, n]);
        if tokens > 0 {
            let (scores, values) = (View::rows(&scores[n..], all), View::rows(map(1), 2 * width));
            matmul(&mut mixed, d, true, scores, values, [n, d, tokens]);
        }
        mixed
    };
    let heads: Vec<Vec<f32>> = (0..heads).into_par_iter().map(mix).collect();
    for (i, out) in out.chunks_exact_mut(width).enumerate() {
        for (out, mixed) in out.chunks_exact_mut(d).zip(&heads) {
            out.copy_from_slice(&mixed[i * d..(i + 1) * d]);
        }
    }
    out
}
