//! The processor as a backend: packed matrices, eight bits, fused attention. Work is cut into pieces of fixed size, so
//! the number of threads cannot change a bit.

use rayon::prelude::*;

use crate::Precision;
use crate::graph;
use crate::kernels;
use crate::layers::{Linear, NORM_EPS, Norm, ResBlock};
use crate::map::FeatureMap;
use crate::ops::{BackendTensor, BlockParts, MessageEdge, MessageParts, NodeBlockParts, Ops, OpsError};
use crate::ring::{RingBlock, RingBlockParts};
use crate::rules::RuleBook;
use crate::sparse::{Convolution, SiteResidual};
use crate::transformer::TransformerBlock;

/// Rows of a map that are normed in one piece.
const PIECE: usize = 200;

/// The processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

/// Vectors of a table.
pub struct EmbeddingTable {
    entries: Vec<f32>, // [entry][width]
    width: usize,
}

impl BackendTensor for FeatureMap {
    fn rows(&self) -> usize {
        self.rows
    }
    fn columns(&self) -> usize {
        self.columns
    }
    fn width(&self) -> usize {
        self.width
    }
}

/// A map of the same places with other values.
fn with(map: &FeatureMap, data: Vec<f32>, width: usize) -> FeatureMap {
    FeatureMap { data, width, ..*map }
}

impl Ops for Cpu {
    const NAME: &'static str = "cpu";
    type Tensor = FeatureMap;
    type Linear = Linear;
    type Norm = Norm;
    type Residual = ResBlock;
    type Table = EmbeddingTable;
    type Block = TransformerBlock;
    type SparseConvolution = Convolution;
    type SparseResidual = SiteResidual;
    type Room = Vec<f32>;
    type Messages = MessageParts<Linear>;
    type NodeBlock = NodeBlockParts<Linear>;
    type RingBlock = RingBlock;

    fn upload(&self, map: FeatureMap) -> Result<FeatureMap, OpsError> {
        Ok(map)
    }

    fn download(&self, x: FeatureMap) -> Result<FeatureMap, OpsError> {
        Ok(x)
    }

    fn linear_from(&self, weight: &[f32], bias: Vec<f32>, inputs: usize) -> Result<Linear, OpsError> {
        Ok(Linear::from_parts(weight, bias, inputs))
    }

    fn norm_from(&self, scale: Vec<f32>, shift: Vec<f32>) -> Result<Norm, OpsError> {
        Ok(Norm { scale, shift })
    }

    fn residual_from(
        &self,
        norm: Norm,
        weight: &[f32],
        bias: Vec<f32>,
        kernel: usize,
        second: Linear,
    ) -> Result<ResBlock, OpsError> {
        Ok(ResBlock::from_parts(norm, weight, bias, kernel, second))
    }

    fn table_from(&self, entries: Vec<f32>, width: usize) -> Result<EmbeddingTable, OpsError> {
        Ok(EmbeddingTable { entries, width })
    }

    fn block_from(&self, parts: BlockParts<Linear>) -> Result<TransformerBlock, OpsError> {
        Ok(TransformerBlock::new(parts))
    }

    fn sparse_from(&self, weight: &[f32], bias: Vec<f32>, taps: usize) -> Result<Convolution, OpsError> {
        Ok(Convolution::from_parts(weight, bias, taps))
    }

    fn sparse_residual_from(
        &self,
        norm: Norm,
        convolution: Convolution,
        linear: Linear,
    ) -> Result<SiteResidual, OpsError> {
        Ok(SiteResidual::from_parts(norm, convolution, linear))
    }

    fn messages_from(&self, parts: MessageParts<Linear>) -> Result<MessageParts<Linear>, OpsError> {
        Ok(parts)
    }

    fn node_block_from(&self, parts: NodeBlockParts<Linear>) -> Result<NodeBlockParts<Linear>, OpsError> {
        Ok(parts)
    }

    fn ring_block_from(&self, parts: RingBlockParts<Linear, Norm>) -> Result<RingBlock, OpsError> {
        Ok(RingBlock::new(parts))
    }

    fn apply(&self, linear: &Linear, x: &FeatureMap, piece: usize) -> Result<FeatureMap, OpsError> {
        // One piece is not worth waking other threads for.
        let data = match x.rows * x.columns <= piece {
            true => linear.vector(&x.data),
            false => linear.parallel(&x.data, piece),
        };
        Ok(with(x, data, linear.outputs()))
    }

    fn apply_each(&self, layers: &[&Linear], x: &FeatureMap) -> Result<Vec<FeatureMap>, OpsError> {
        let each = layers.par_iter();
        Ok(each.map(|l| with(x, l.vector(&x.data), l.outputs())).collect())
    }

    fn norm(&self, norm: &Norm, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        // In place: fresh memory costs as much as what is written into it.
        let pieces = x.data.par_chunks_mut(PIECE * x.width);
        pieces.for_each_init(Vec::new, |before: &mut Vec<f32>, x| {
            before.clear();
            before.extend_from_slice(x);
            norm.rows(before, x);
        });
        Ok(x)
    }

    fn modulate(&self, x: &FeatureMap, ada: &FeatureMap) -> Result<FeatureMap, OpsError> {
        let (shift, scale) = ada.data.split_at(x.width);
        let scale: Vec<f32> = scale.iter().map(|s| 1.0 + s).collect();
        let mut out = vec![0.0; x.data.len()];
        out.par_chunks_mut(PIECE * x.width)
            .zip(x.data.par_chunks(PIECE * x.width))
            .for_each(|(out, x)| kernels::norm_rows(x, NORM_EPS, &scale, shift, out));
        Ok(with(x, out, x.width))
    }

    fn residual(&self, block: &ResBlock, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        block.apply(&mut x);
        Ok(x)
    }

    fn reach(block: &ResBlock) -> usize {
        block.reach()
    }

    fn bag<I: Iterator<Item = usize>>(
        &self,
        table: &EmbeddingTable,
        mut x: FeatureMap,
        entries: impl Fn(usize, usize) -> I + Sync,
    ) -> Result<FeatureMap, OpsError> {
        let width = table.width;
        x.data
            .par_chunks_mut(x.columns * width)
            .enumerate()
            .for_each(|(row, sums)| {
                for (column, sum) in sums.chunks_exact_mut(width).enumerate() {
                    for entry in entries(row, column) {
                        let vector = &table.entries[entry * width..][..width];
                        sum.iter_mut().zip(vector).for_each(|(s, v)| *s += v);
                    }
                }
            });
        Ok(x)
    }

    fn ada(block: &TransformerBlock) -> &Linear {
        &block.ada
    }

    fn block(
        &self,
        block: &TransformerBlock,
        mut x: FeatureMap,
        ada: &FeatureMap,
        places: &[usize],
        keys_values: &mut FeatureMap,
        precision: Precision,
    ) -> Result<FeatureMap, OpsError> {
        block.apply(&mut x.data, &ada.data, places, &mut keys_values.data, precision);
        Ok(x)
    }

    fn likeliest(
        &self,
        head: &Linear,
        x: &FeatureMap,
        places: &[usize],
        voxels: usize,
        piece: usize,
    ) -> Result<Vec<u8>, OpsError> {
        let mut labels = vec![0; places.len() * voxels];
        labels
            .par_chunks_mut(piece * voxels)
            .zip(places.par_chunks(piece))
            .for_each(|(labels, places)| {
                let mut rows = Vec::with_capacity(places.len() * x.width);
                for place in places {
                    rows.extend_from_slice(&x.data[place * x.width..][..x.width]);
                }
                let logits = head.vector(&rows);
                let each = logits.chunks_exact(head.outputs());
                each.zip(labels.chunks_exact_mut(voxels))
                    .for_each(|(logits, labels)| kernels::likeliest(logits, labels));
            });
        Ok(labels)
    }

    fn sparse(
        &self,
        convolution: &Convolution,
        x: &FeatureMap,
        rules: &RuleBook,
    ) -> Result<FeatureMap, OpsError> {
        let data = convolution.apply(&x.data, rules);
        Ok(FeatureMap {
            data,
            rows: rules.rows(),
            columns: 1,
            width: convolution.outputs(),
        })
    }

    fn sparse_onto(
        &self,
        convolution: &Convolution,
        x: &FeatureMap,
        rules: &RuleBook,
        mut onto: FeatureMap,
    ) -> Result<FeatureMap, OpsError> {
        convolution.add(&x.data, rules, &mut onto.data);
        Ok(onto)
    }

    fn sparse_residual(
        &self,
        block: &SiteResidual,
        mut x: FeatureMap,
        rules: &RuleBook,
        room: &mut Vec<f32>,
    ) -> Result<FeatureMap, OpsError> {
        block.apply(&mut x.data, rules, room);
        Ok(x)
    }

    fn messages(
        &self,
        round: &MessageParts<Linear>,
        mut x: FeatureMap,
        edges: &[MessageEdge],
    ) -> Result<FeatureMap, OpsError> {
        graph::messages(round, &mut x.data, x.width, edges);
        Ok(x)
    }

    fn node_block(
        &self,
        block: &NodeBlockParts<Linear>,
        mut x: FeatureMap,
        ada: &FeatureMap,
        context: Option<&FeatureMap>,
        bias: &FeatureMap,
    ) -> Result<FeatureMap, OpsError> {
        let context = context.map_or(&[][..], |c| &c.data);
        graph::block(block, &mut x.data, &ada.data, context, &bias.data);
        Ok(x)
    }

    fn ring_block(
        &self,
        block: &RingBlock,
        mut maps: Vec<FeatureMap>,
        ada: &[FeatureMap],
    ) -> Result<Vec<FeatureMap>, OpsError> {
        block.apply(&mut maps, ada);
        Ok(maps)
    }

    fn relu(&self, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        x.data.iter_mut().for_each(|v| *v = v.max(0.0));
        Ok(x)
    }

    fn gelu(&self, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        kernels::gelu_all(&mut x.data);
        Ok(x)
    }

    fn tanh(&self, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        x.data.iter_mut().for_each(|v| *v = v.tanh());
        Ok(x)
    }

    fn silu(&self, mut x: FeatureMap) -> Result<FeatureMap, OpsError> {
        x.data.iter_mut().for_each(|v| *v = kernels::silu(*v));
        Ok(x)
    }

    fn add(&self, mut x: FeatureMap, y: &FeatureMap) -> Result<FeatureMap, OpsError> {
        let add = |x: &mut [f32]| x.iter_mut().zip(&y.data).for_each(|(x, y)| *x += y);
        match y.data.len() == x.data.len() {
            true => add(&mut x.data),
            false => x.data.par_chunks_exact_mut(x.width).for_each(add),
        }
        Ok(x)
    }

    fn subtract(&self, x: &FeatureMap, y: &FeatureMap) -> Result<FeatureMap, OpsError> {
        let data = x.data.iter().zip(&y.data).map(|(x, y)| x - y).collect();
        Ok(with(x, data, x.width))
    }

    fn fold(&self, x: &FeatureMap) -> Result<FeatureMap, OpsError> {
        Ok(x.fold())
    }

    fn unfold(&self, x: &FeatureMap) -> Result<FeatureMap, OpsError> {
        Ok(x.unfold())
    }
}
