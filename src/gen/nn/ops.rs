//! Operations of a backend: blocks of networks and the values that pass between them. A network written against [`Ops`]
//! runs on the processor's kernels ([`Cpu`](crate::Cpu)) and on any other implementation.

use thiserror::Error;

use crate::Precision;
use crate::map::FeatureMap;
use crate::ring::RingBlockParts;
use crate::rules::RuleBook;
use crate::weights::{WeightFile, WeightsError};

/// Error of a backend that could not compute. One line. The processor's never fails.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{backend}: {reason}")]
pub struct OpsError {
    /// Name of the backend.
    pub backend: &'static str,
    /// Reason that it gave.
    pub reason: String,
}

impl OpsError {
    /// Makes one from any error, on one line.
    pub fn new(backend: &'static str, error: impl std::fmt::Display) -> Self {
        let text = error.to_string();
        let reason = text.lines().next().unwrap_or("no reason").to_owned();
        Self { backend, reason }
    }
}

/// Values of a backend: `rows x columns` places of `width` channels, as [`FeatureMap`] has them.
pub trait BackendTensor: Clone + Send + Sync {
    /// Places along x.
    fn rows(&self) -> usize;
    /// Places along y.
    fn columns(&self) -> usize;
    /// Channels of a place.
    fn width(&self) -> usize;
    /// All numbers.
    fn numbers(&self) -> usize {
        self.rows() * self.columns() * self.width()
    }
}

/// Parts of a transformer block ([`Ops::block`]).
pub struct BlockParts<L> {
    /// Time to shift, scale and gate of attention, then of the MLP: `width` to `6 width`.
    pub ada: L,
    /// Queries, keys and values: `width` to `3 width`.
    pub qkv: L,
    /// `width` to `width`.
    pub proj: L,
    /// `width` to `4 width`.
    pub fc1: L,
    /// `4 width` to `width`.
    pub fc2: L,
    /// Weight `[width][3][3]` and bias of a depthwise convolution over the values, where there is one.
    pub local: Option<(Vec<f32>, Vec<f32>)>,
    /// Attention heads.
    pub heads: usize,
    /// Tokens along one side of the square map.
    pub side: usize,
}

/// A directed edge of a graph ([`Ops::messages`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MessageEdge {
    /// Node that the message comes from.
    pub from: usize,
    /// Node that the message goes to.
    pub to: usize,
    /// Number of the relation between them.
    pub relation: usize,
    /// Stated distance between them, and 1 if one is stated.
    pub distance: [f32; 2],
}

/// Parts of a round of messages along the edges of a graph ([`Ops::messages`]).
pub struct MessageParts<L> {
    /// Layer of the node that a message comes from: `width` to `width`.
    pub source: L,
    /// Layer of the node that a message goes to: `width` to `width`.
    pub target: L,
    /// `[relation][width]`.
    pub relation: Vec<f32>,
    /// [`MessageEdge::distance`] to `width`.
    pub distance: L,
    /// `width` to `width`.
    pub out: L,
}

/// Parts of a transformer block over the nodes of a graph ([`Ops::node_block`]).
pub struct NodeBlockParts<L> {
    /// Added to what modulates the block: shift, scale and gate of attention, then of the MLP, `[6][width]`.
    pub shift: Vec<f32>,
    /// Queries, keys and values: `width` to `3 width`.
    pub qkv: L,
    /// `width` to `width`.
    pub proj: L,
    /// First layer of the MLP.
    pub fc1: L,
    /// Second layer of the MLP, to `width`.
    pub fc2: L,
    /// Attention heads.
    pub heads: usize,
}

/// A backend. The `_from` functions make a block of its numbers, the named ones take those numbers from a weight file;
/// the others compute.
pub trait Ops: Send + Sync + Sized + 'static {
    /// Name for messages.
    const NAME: &'static str;
    /// Value that passes between blocks.
    type Tensor: BackendTensor;
    /// y = x W + b at every place.
    type Linear: Send + Sync;
    /// Layer norm of every place, with scale and shift.
    type Norm: Send + Sync;
    /// x + W2 gelu(W1 norm(x)) of a map: W1 is a 3x3 or 1x1 convolution, W2 1x1.
    type Residual: Send + Sync;
    /// One vector per entry.
    type Table: Send + Sync;
    /// A transformer block with modulation by time (adaLN-Zero).
    type Block: Send + Sync;
    /// A convolution over sites: rows by way of a rule book.
    type SparseConvolution: Send + Sync;
    /// x + W relu(convolution(norm(x))) of sites.
    type SparseResidual: Send + Sync;
    /// Memory that sparse blocks may use again; its content means nothing.
    type Room: Default;
    /// A round of messages along the edges of a graph.
    type Messages: Send + Sync;
    /// A transformer block over the nodes of a graph, modulated by time.
    type NodeBlock: Send + Sync;
    /// A transformer block over a ring of maps, modulated by time.
    type RingBlock: Send + Sync;

    /// Moves values from the processor to the backend.
    fn upload(&self, map: FeatureMap) -> Result<Self::Tensor, OpsError>;
    /// Moves values back to the processor.
    fn download(&self, x: Self::Tensor) -> Result<FeatureMap, OpsError>;

    /// A linear layer; `weight` is `[outputs][inputs]`.
    fn linear_from(&self, weight: &[f32], bias: Vec<f32>, inputs: usize) -> Result<Self::Linear, OpsError>;
    /// A norm, with scale and shift per channel.
    fn norm_from(&self, scale: Vec<f32>, shift: Vec<f32>) -> Result<Self::Norm, OpsError>;
    /// A residual block; `weight` is that of the convolution, `[out][in][kernel][kernel]`; the kernel is 1 or 3.
    fn residual_from(
        &self,
        norm: Self::Norm,
        weight: &[f32],
        bias: Vec<f32>,
        kernel: usize,
        second: Self::Linear,
    ) -> Result<Self::Residual, OpsError>;
    /// A table; `entries` is `[entry][width]`.
    fn table_from(&self, entries: Vec<f32>, width: usize) -> Result<Self::Table, OpsError>;
    /// A transformer block.
    fn block_from(&self, parts: BlockParts<Self::Linear>) -> Result<Self::Block, OpsError>;

    /// A sparse convolution; `weight` is `[tap][input][output]`.
    fn sparse_from(
        &self,
        weight: &[f32],
        bias: Vec<f32>,
        taps: usize,
    ) -> Result<Self::SparseConvolution, OpsError>;
    /// A residual block of sites; the convolution keeps their number and width.
    fn sparse_residual_from(
        &self,
        norm: Self::Norm,
        convolution: Self::SparseConvolution,
        linear: Self::Linear,
    ) -> Result<Self::SparseResidual, OpsError>;
    /// A round of messages.
    fn messages_from(&self, parts: MessageParts<Self::Linear>) -> Result<Self::Messages, OpsError>;
    /// A transformer block over nodes.
    fn node_block_from(&self, parts: NodeBlockParts<Self::Linear>) -> Result<Self::NodeBlock, OpsError>;
    /// A transformer block over a ring of maps.
    fn ring_block_from(
        &self,
        parts: RingBlockParts<Self::Linear, Self::Norm>,
    ) -> Result<Self::RingBlock, OpsError>;

    /// Applies a linear layer at every place; the processor works on `piece` places at a time.
    fn apply(&self, linear: &Self::Linear, x: &Self::Tensor, piece: usize) -> Result<Self::Tensor, OpsError>;
    /// Applies several layers to the same input.
    fn apply_each(&self, layers: &[&Self::Linear], x: &Self::Tensor) -> Result<Vec<Self::Tensor>, OpsError>;
    /// Layer norm of every place.
    fn norm(&self, norm: &Self::Norm, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// Layer norm of every place without learned numbers, then times 1 + scale plus shift; `ada` is one place of
    /// shift, then scale.
    fn modulate(&self, x: &Self::Tensor, ada: &Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// A residual block.
    fn residual(&self, block: &Self::Residual, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// How many places away such a block looks.
    fn reach(block: &Self::Residual) -> usize;
    /// Adds to every place of `x` the sum of some entries of a table, which are given by row and column.
    fn bag<I: Iterator<Item = usize>>(
        &self,
        table: &Self::Table,
        x: Self::Tensor,
        entries: impl Fn(usize, usize) -> I + Sync,
    ) -> Result<Self::Tensor, OpsError>;
    /// The layer of a transformer block that modulates it.
    fn ada(block: &Self::Block) -> &Self::Linear;
    /// A transformer block over some tokens of a square map, which stand at `places` of it. `keys_values` holds keys, then
    /// values of all tokens of the map; those of these tokens are renewed first. `ada` is one place: what
    /// [`ada`](Self::ada) makes of the time.
    fn block(
        &self,
        block: &Self::Block,
        x: Self::Tensor,
        ada: &Self::Tensor,
        places: &[usize],
        keys_values: &mut Self::Tensor,
        precision: Precision,
    ) -> Result<Self::Tensor, OpsError>;
    /// The likeliest class of every voxel of some places, `[place][voxel]`: `head` gives logits `[class][voxel]`. The
    /// lowest class keeps a tie. The processor works on `piece` places at a time.
    fn likeliest(
        &self,
        head: &Self::Linear,
        x: &Self::Tensor,
        places: &[usize],
        voxels: usize,
        piece: usize,
    ) -> Result<Vec<u8>, OpsError>;

    /// One place per row of the rule book, `[rows][outputs]`: the bias and the sum over its taps. `x` holds the sites that the
    /// rules speak of.
    fn sparse(
        &self,
        convolution: &Self::SparseConvolution,
        x: &Self::Tensor,
        rules: &RuleBook,
    ) -> Result<Self::Tensor, OpsError>;
    /// `onto` + [`sparse`](Self::sparse).
    fn sparse_onto(
        &self,
        convolution: &Self::SparseConvolution,
        x: &Self::Tensor,
        rules: &RuleBook,
        onto: Self::Tensor,
    ) -> Result<Self::Tensor, OpsError>;
    /// A residual block of sites; the rules lead from sites to the same sites.
    fn sparse_residual(
        &self,
        block: &Self::SparseResidual,
        x: Self::Tensor,
        rules: &RuleBook,
        room: &mut Self::Room,
    ) -> Result<Self::Tensor, OpsError>;

    /// x + out(m) of the nodes `x`: m is the mean over the edges to a node of gelu(source(y of the node that the edge
    /// comes from) + target(y of the node) + relation + distance), 0 without an edge; y is x after a layer norm without
    /// learned numbers.
    fn messages(
        &self,
        round: &Self::Messages,
        x: Self::Tensor,
        edges: &[MessageEdge],
    ) -> Result<Self::Tensor, OpsError>;
    /// A transformer block over the nodes `x`, which also see the keys and values of `context`, `[token][keys | values]`.
    /// `bias`, `[head][query][key]`, is added to the scores of nodes. `ada` is one
    /// place of `6 width`, see [`NodeBlockParts::shift`].
    fn node_block(
        &self,
        block: &Self::NodeBlock,
        x: Self::Tensor,
        ada: &Self::Tensor,
        context: Option<&Self::Tensor>,
        bias: &Self::Tensor,
    ) -> Result<Self::Tensor, OpsError>;

    /// A transformer block over a ring of maps of one size: the map before one is on its left, the last one on the left of the
    /// first. `ada` has one place of `6 width` for each of them, see [`RingBlockParts::offset`].
    fn ring_block(
        &self,
        block: &Self::RingBlock,
        maps: Vec<Self::Tensor>,
        ada: &[Self::Tensor],
    ) -> Result<Vec<Self::Tensor>, OpsError>;

    /// max(x, 0).
    fn relu(&self, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// x Phi(x), exactly.
    fn gelu(&self, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// Hyperbolic tangent.
    fn tanh(&self, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// x * sigmoid(x).
    fn silu(&self, x: Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// x + y, or x + one place at every place if `y` is one place.
    fn add(&self, x: Self::Tensor, y: &Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// x - y.
    fn subtract(&self, x: &Self::Tensor, y: &Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// [`FeatureMap::fold`].
    fn fold(&self, x: &Self::Tensor) -> Result<Self::Tensor, OpsError>;
    /// [`FeatureMap::unfold`].
    fn unfold(&self, x: &Self::Tensor) -> Result<Self::Tensor, OpsError>;

    /// Places of `width` numbers, one after the other.
    fn sequence(&self, numbers: Vec<f32>, width: usize) -> Result<Self::Tensor, OpsError> {
        self.upload(FeatureMap {
            rows: numbers.len() / width.max(1),
            columns: 1,
            width,
            data: numbers,
        })
    }

    /// One place of these numbers.
    fn vector(&self, numbers: Vec<f32>) -> Result<Self::Tensor, OpsError> {
        let width = numbers.len();
        self.sequence(numbers, width)
    }

    /// Takes `name.weight` [outputs, inputs] and `name.bias`; `tail` is what the stored shape has after those two (1x1 of a
    /// convolution).
    fn linear(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        [inputs, outputs]: [usize; 2],
        tail: &[usize],
    ) -> Result<Self::Linear, WeightsError> {
        let weight = w.take(&format!("{name}.weight"), &[&[outputs, inputs], tail].concat())?;
        let bias = w.take(&format!("{name}.bias"), &[outputs])?;
        self.linear_from(&weight, bias, inputs)
            .map_err(|e| w.backend_error(e))
    }

    /// Takes `name.weight` of the shape `[outputs, inputs]`; there is no bias.
    fn linear_without_bias(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        [inputs, outputs]: [usize; 2],
    ) -> Result<Self::Linear, WeightsError> {
        let weight = w.take(&format!("{name}.weight"), &[outputs, inputs])?;
        self.linear_from(&weight, vec![0.0; outputs], inputs)
            .map_err(|e| w.backend_error(e))
    }

    /// Takes `name.weight` and `name.bias`.
    fn load_norm(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        width: usize,
    ) -> Result<Self::Norm, WeightsError> {
        let scale = w.take(&format!("{name}.weight"), &[width])?;
        let shift = w.take(&format!("{name}.bias"), &[width])?;
        self.norm_from(scale, shift).map_err(|e| w.backend_error(e))
    }

    /// Takes `name.norm`, `name.conv1`, `name.conv2`; the kernel is 1 or 3.
    fn load_residual(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        width: usize,
        kernel: usize,
    ) -> Result<Self::Residual, WeightsError> {
        let weight = w.take(&format!("{name}.conv1.weight"), &[width, width, kernel, kernel])?;
        let bias = w.take(&format!("{name}.conv1.bias"), &[width])?;
        let norm = self.load_norm(w, &format!("{name}.norm"), width)?;
        let second = self.linear(w, &format!("{name}.conv2"), [width, width], &[1, 1])?;
        self.residual_from(norm, &weight, bias, kernel, second)
            .map_err(|e| w.backend_error(e))
    }

    /// Takes `name.ada`, `name.qkv`, `name.proj`, `name.fc1`, `name.fc2`, and `name.local` where it is wanted.
    fn load_block(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        width: usize,
        [heads, side]: [usize; 2],
        local: bool,
    ) -> Result<Self::Block, WeightsError> {
        let local = match local {
            true => Some((
                w.take(&format!("{name}.local.weight"), &[width, 1, 3, 3])?,
                w.take(&format!("{name}.local.bias"), &[width])?,
            )),
            false => None,
        };
        let mut linear =
            |part: &str, inputs, outputs| self.linear(w, &format!("{name}.{part}"), [inputs, outputs], &[]);
        let parts = BlockParts {
            ada: linear("ada", width, 6 * width)?,
            qkv: linear("qkv", width, 3 * width)?,
            proj: linear("proj", width, width)?,
            fc1: linear("fc1", width, 4 * width)?,
            fc2: linear("fc2", 4 * width, width)?,
            local,
            heads,
            side,
        };
        self.block_from(parts).map_err(|e| w.backend_error(e))
    }
    /// Takes `name.weight` of the stored `shape`, in the order `[tap][input][output]`, and `name.bias`.
    fn load_sparse(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        [taps, outputs]: [usize; 2],
        shape: &[usize],
    ) -> Result<Self::SparseConvolution, WeightsError> {
        let weight = w.take(&format!("{name}.weight"), shape)?;
        let bias = w.take(&format!("{name}.bias"), &[outputs])?;
        self.sparse_from(&weight, bias, taps)
            .map_err(|e| w.backend_error(e))
    }

    /// Takes `name.norm`, `name.conv` and `name.linear`.
    fn load_sparse_residual(
        &self,
        w: &mut WeightFile<'_>,
        name: &str,
        [taps, width]: [usize; 2],
    ) -> Result<Self::SparseResidual, WeightsError> {
        let norm = self.load_norm(w, &format!("{name}.norm"), width)?;
        let convolution =
            self.load_sparse(w, &format!("{name}.conv"), [taps, width], &[taps * width, width])?;
        let linear = self.linear(w, &format!("{name}.linear"), [width, width], &[])?;
        self.sparse_residual_from(norm, convolution, linear)
            .map_err(|e| w.backend_error(e))
    }
}
