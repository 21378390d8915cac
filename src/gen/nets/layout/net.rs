//! The layout network: messages along typed relations give every node an embedding; a denoiser then predicts v for all
//! boxes and lanes at once, its attention biased by the relations and open to the map. Twin of training/models/layout.py.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use serde::Deserialize;

use super::input::{KINDS, LayoutInput, MAP_CHANNELS, MAP_SIDE, NodeGeometry, NodeInput, VALUES};
use crate::occ_dit::timestep_embedding;
use crate::{ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::ops::{MessageEdge, MessageParts, NodeBlockParts, OpsError};
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};
use scene::graph::RelationKind;

/// File name of the weights.
pub const FILE: &str = "layout.safetensors";
/// Most nodes that one call takes: attention over them is quadratic.
pub const MOST_NODES: usize = 512;

const RELATIONS: usize = RelationKind::ALL.len();
/// Numbers of states and sizes that a node may have, 0 for unknown.
const STATES: usize = 4;
const SIZES: usize = 3;
/// Side of a map token, cells, and means along a side that encode it.
const PATCH: usize = 20;
const SUB: usize = 10;
const TOKENS_PER_SIDE: usize = MAP_SIDE / PATCH;
const TOKENS: usize = TOKENS_PER_SIDE * TOKENS_PER_SIDE;
/// Numbers of a box's place: the map under it, the place within the cell, whether there is a map.
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

/// A block of the denoiser, with its attention to the map and its biases by edges.
struct DenoiserBlock<B: Ops> {
    block: B::NodeBlock,
    map_kv: B::Linear,
    bias: Vec<f32>, // [2 * relations + 1][heads]
}

/// The network, on a backend.
pub struct LayoutNet<B: Ops = Cpu> {
    ops: B,
    config: LayoutConfig,
    told: B::Table, // kinds, then states, then sizes
    given: B::Linear,
    rounds: Vec<B::Messages>,
    /// A norm without learned numbers.
    plain: B::Norm,
    node: B::Linear,
    enter: B::Linear,
    patch: B::Linear,
    place: B::Tensor,
    time: [B::Linear; 2],
    modulation: B::Linear,
    blocks: Vec<DenoiserBlock<B>>,
    last: B::Linear,
    leave: B::Linear,
    hash: u64,
}

/// State that stays the same while one layout is sampled. `T` is the backend's tensor.
pub struct Embedded<'a, T = FeatureMap> {
    input: &'a LayoutInput,
    nodes: T,               // [N][width]
    map_kv: Vec<Option<T>>, // per block [TOKENS][2 width]; none without a map
    bias: Vec<T>,           // per block [heads][N][N]
    cells: Vec<f32>,        // the map as numbers, [100][100][8]; empty without a map
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

    /// Loads the network onto the processor. Takes all tensors of the file.
    pub fn new(file: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file)
    }
}

impl<B: Ops> LayoutNet<B> {
    /// Loads the network onto a backend; otherwise as [`LayoutNet::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let c: LayoutConfig = file.config("config")?;
        c.check().map_err(|reason| file.config_error("config", reason))?;
        let (width, w) = (c.width, &mut file);
        let rounds = (0..c.rounds).map(|i| round(&ops, w, &format!("rounds.{i}"), width));
        let rounds = rounds.collect::<Result<_, _>>()?;
        let blocks = (0..c.depth).map(|i| DenoiserBlock::new(&ops, w, &format!("blocks.{i}"), &c));
        let blocks = blocks.collect::<Result<_, _>>()?;
        let tables = [("kind", KINDS), ("state", STATES), ("size", SIZES)];
        let tables = tables.map(|(name, rows)| w.take(&format!("{name}.weight"), &[rows, width]));
        let tables: Vec<Vec<f32>> = tables.into_iter().collect::<Result<_, _>>()?;
        let told = ops.table_from(tables.concat(), width);
        let plain = ops.norm_from(vec![1.0; width], vec![0.0; width]);
        let place = ops.sequence(w.take("place", &[TOKENS, width])?, width);
        let refused = |e| w.backend_error(e);
        let (told, plain, place) = (
            told.map_err(refused)?,
            plain.map_err(refused)?,
            place.map_err(refused)?,
        );
        let mut linear = |name: &str, inputs, outputs| ops.linear(w, name, [inputs, outputs], &[]);
        let net = Self {
            given: linear("given", VALUES + 1, width)?,
            node: linear("node", width, width)?,
            enter: linear("enter", VALUES + LOCAL, width)?,
            patch: linear("patch", SUB * SUB * MAP_CHANNELS, width)?,
            time: [
                linear("time1", c.frequencies, width)?,
                linear("time2", width, width)?,
            ],
            modulation: linear("modulation", width, 6 * width)?,
            last: linear("last", width, 2 * width)?,
            leave: linear("leave", width, VALUES)?,
            hash: w.hash(),
            told,
            plain,
            place,
            rounds,
            blocks,
            config: c,
            ops,
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
    pub fn embed<'a>(&self, input: &'a LayoutInput) -> Result<Embedded<'a, B::Tensor>, ModelError> {
        let (ops, width, n) = (&self.ops, self.config.width, input.nodes.len());
        if n > MOST_NODES {
            check_length("layout graph", n, MOST_NODES)?;
        }
        let mut given = vec![0.0; n * (VALUES + 1)];
        for (node, given) in input.nodes.iter().zip(given.chunks_exact_mut(VALUES + 1)) {
            check_finite("given geometry", &node.values)?;
            if node.locked {
                let own = node.shape.channels();
                given[own.clone()].copy_from_slice(&node.values[own]);
                given[VALUES] = 1.0;
            }
        }
        let told = ops.sequence(vec![0.0; n * width], width)?;
        let told = ops.bag(&self.told, told, |i, _| told_of(&input.nodes[i]).into_iter())?;
        let given = ops.apply(&self.given, &ops.sequence(given, VALUES + 1)?, PIECE)?;
        let mut h = ops.add(told, &given)?;
        let edges = directed(input)?;
        for round in &self.rounds {
            h = ops.messages(round, h, &edges)?;
        }
        let nodes = ops.apply(&self.node, &ops.norm(&self.plain, h)?, PIECE)?;
        let (mut cells, mut tokens) = (Vec::new(), None);
        if let Some(map) = &input.map {
            check_length("layout map", map.len(), MAP_SIDE * MAP_SIDE * MAP_CHANNELS)?;
            cells = map.iter().map(|v| (f32::from(*v) - 128.0) / 127.0).collect();
            tokens = Some(self.tokens(&cells)?);
        }
        let of_map = |b: &DenoiserBlock<B>| {
            tokens
                .as_ref()
                .map(|t| ops.apply(&b.map_kv, t, PIECE))
                .transpose()
        };
        Ok(Embedded {
            input,
            nodes,
            map_kv: self.blocks.iter().map(of_map).collect::<Result<_, _>>()?,
            bias: self.biases(n, &edges)?,
            cells,
        })
    }

    /// Bias that the edges add to the scores of attention, for each block.
    fn biases(&self, n: usize, edges: &[MessageEdge]) -> Result<Vec<B::Tensor>, OpsError> {
        let heads = self.config.heads;
        let bias = |block: &DenoiserBlock<B>| {
            let mut data = vec![0.0; heads * n * n];
            for edge in edges {
                // Torch adds the row of (query = from, key = to, relation) and its mirror image; `edges` has both.
                for head in 0..heads {
                    data[(head * n + edge.from) * n + edge.to] += block.bias[edge.relation * heads + head];
                }
            }
            self.ops.sequence(data, 1)
        };
        self.blocks.iter().map(bias).collect()
    }

    fn tokens(&self, cells: &[f32]) -> Result<B::Tensor, OpsError> {
        let (ops, step) = (&self.ops, PATCH / SUB);
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
        let tokens = ops.apply(&self.patch, &ops.sequence(seen, SUB * SUB * MAP_CHANNELS)?, PIECE)?;
        ops.norm(&self.plain, ops.gelu(ops.add(tokens, &self.place)?)?)
    }

    /// v for the state `x` `[N][24]` at training step `t`; locked nodes keep their own values whatever `x` holds.
    pub fn predict(
        &self,
        embedded: &Embedded<'_, B::Tensor>,
        x: &[f64],
        t: f64,
    ) -> Result<Vec<f64>, ModelError> {
        let (ops, n) = (&self.ops, embedded.input.nodes.len());
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
            if node.shape == NodeGeometry::Box && !embedded.cells.is_empty() {
                let (out, place) = out.split_at_mut(VALUES);
                local(&embedded.cells, [out[0], out[1]], place);
            }
        }
        check_finite("layout state", &seen)?;
        let h = ops.apply(&self.enter, &ops.sequence(seen, VALUES + LOCAL)?, PIECE)?;
        let mut h = ops.add(h, &embedded.nodes)?;
        let time = ops.vector(timestep_embedding(t as f32, self.config.frequencies))?;
        let time = ops.silu(ops.apply(&self.time[0], &time, 1)?)?;
        let time = ops.silu(ops.apply(&self.time[1], &time, 1)?)?;
        let ada = ops.apply(&self.modulation, &time, 1)?;
        let each = self.blocks.iter().zip(&embedded.map_kv).zip(&embedded.bias);
        for ((block, map_kv), bias) in each {
            h = ops.node_block(&block.block, h, &ada, map_kv.as_ref(), bias)?;
        }
        let y = ops.modulate(&h, &ops.apply(&self.last, &time, 1)?)?;
        let out = ops.download(ops.apply(&self.leave, &y, PIECE)?)?.data;
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

/// Entries of the table of kinds, states and sizes.
fn told_of(node: &NodeInput) -> [usize; 3] {
    let [kind, state, size] = [node.kind, node.state, node.size].map(usize::from);
    [
        kind.min(KINDS - 1),
        KINDS + state.min(STATES - 1),
        KINDS + STATES + size.min(SIZES - 1),
    ]
}

/// Takes the tensors of a round of messages.
fn round<B: Ops>(
    ops: &B,
    w: &mut WeightFile<'_>,
    name: &str,
    width: usize,
) -> Result<B::Messages, WeightsError> {
    let of = |part: &str| format!("{name}.{part}");
    let parts = MessageParts {
        source: ops.linear(w, &of("source"), [width, width], &[])?,
        target: ops.linear_without_bias(w, &of("target"), [width, width])?,
        relation: w.take(&of("relation.weight"), &[2 * RELATIONS, width])?,
        distance: ops.linear_without_bias(w, &of("distance"), [2, width])?,
        out: ops.linear(w, &of("out"), [width, width], &[])?,
    };
    ops.messages_from(parts).map_err(|e| w.backend_error(e))
}

impl<B: Ops> DenoiserBlock<B> {
    fn new(ops: &B, w: &mut WeightFile<'_>, name: &str, c: &LayoutConfig) -> Result<Self, WeightsError> {
        let width = c.width;
        let shift = w.take(&format!("{name}.shift"), &[6, width])?;
        let bias = w.take(&format!("{name}.bias.weight"), &[2 * RELATIONS + 1, c.heads])?;
        let mut linear =
            |part: &str, inputs, outputs| ops.linear(w, &format!("{name}.{part}"), [inputs, outputs], &[]);
        let map_kv = linear("map_kv", width, 2 * width)?;
        let parts = NodeBlockParts {
            shift,
            qkv: linear("qkv", width, 3 * width)?,
            proj: linear("proj", width, width)?,
            fc1: linear("fc1", width, c.hidden)?,
            fc2: linear("fc2", c.hidden, width)?,
            heads: c.heads,
        };
        let block = ops.node_block_from(parts).map_err(|e| w.backend_error(e))?;
        Ok(Self { block, map_kv, bias })
    }
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

/// Every edge both ways; relations of the mirrored ones come behind the first 19.
fn directed(input: &LayoutInput) -> Result<Vec<MessageEdge>, ModelError> {
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
            out.push(match mirrored {
                true => MessageEdge {
                    from: to,
                    to: from,
                    relation: relation + RELATIONS,
                    distance,
                },
                false => MessageEdge {
                    from,
                    to,
                    relation,
                    distance,
                },
            });
        }
    }
    Ok(out)
}
