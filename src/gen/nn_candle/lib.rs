//! Candle 0.11 as a backend of the networks, in f32: the plain reference that the fused kernels are compared with, and
//! the way to CUDA (feature `cuda`) and Metal (feature `metal`). It is its own crate, so that the networks are
//! built without candle.

mod block;
mod graph;
mod ring;
mod sparse;

use candle_core::{D, Device, Result as CandleResult, Tensor};

use block::CandleBlock;
use graph::{Messages, NodeBlock};
use nn::Precision;
use nn::map::FeatureMap;
use nn::ops::{BackendTensor, BlockParts, MessageEdge, MessageParts, NodeBlockParts, Ops, OpsError};
use nn::ring::RingBlockParts;
use nn::rules::RuleBook;
use ring::RingBlock;
use sparse::Convolution;

/// Epsilon of every norm, as on the processor.
const EPSILON: f64 = nn::layers::NORM_EPS;

/// Candle on a device.
#[derive(Clone, Debug)]
pub struct Candle(Device);

impl Candle {
    /// The backend on the processor.
    pub fn cpu() -> Self {
        Self(Device::Cpu)
    }

    /// The backend on the first card that this build has a feature for; on the processor where there is none. Errors if
    /// the card cannot be opened.
    pub fn best() -> Result<Self, OpsError> {
        let device = if cfg!(feature = "cuda") {
            Device::new_cuda(0)
        } else if cfg!(feature = "metal") {
            Device::new_metal(0)
        } else {
            Ok(Device::Cpu)
        };
        device.map(Self).map_err(refused)
    }

    fn tensor(&self, data: Vec<f32>, rows: usize, columns: usize) -> CandleResult<Tensor> {
        Tensor::from_vec(data, (rows, columns), &self.0)
    }
}

/// A map: tensor `[places, width]`.
#[derive(Clone, Debug)]
pub struct CandleMap {
    data: Tensor,
    rows: usize,
    columns: usize,
    width: usize,
}

impl BackendTensor for CandleMap {
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

impl CandleMap {
    /// A map of the same places with other values `[places, width]`.
    fn with(&self, data: Tensor) -> CandleResult<Self> {
        let (_, width) = data.dims2()?;
        Ok(Self { data, width, ..*self })
    }
}

/// y = x W + b.
pub struct CandleLinear {
    weight: Tensor, // [inputs, outputs]
    bias: Tensor,
}

impl CandleLinear {
    fn forward(&self, x: &Tensor) -> CandleResult<Tensor> {
        x.matmul(&self.weight)?.broadcast_add(&self.bias)
    }
}

/// Scale and shift of a norm.
pub struct Norm {
    scale: Tensor,
    shift: Tensor,
}

impl Norm {
    fn forward(&self, x: &Tensor) -> CandleResult<Tensor> {
        unit(x)?.broadcast_mul(&self.scale)?.broadcast_add(&self.shift)
    }
}

/// Norms every place to mean 0 and variance 1.
fn unit(x: &Tensor) -> CandleResult<Tensor> {
    let centered = x.broadcast_sub(&x.mean_keepdim(D::Minus1)?)?;
    let variance = centered.sqr()?.mean_keepdim(D::Minus1)?;
    centered.broadcast_div(&(variance + EPSILON)?.sqrt()?)
}

/// x times 1 + scale, plus shift.
fn modulated(x: &Tensor, shift: &Tensor, scale: &Tensor) -> CandleResult<Tensor> {
    unit(x)?.broadcast_mul(&(scale + 1.0)?)?.broadcast_add(shift)
}

/// `[n, width]` to `[head, n, width / heads]`.
fn by_head(x: &Tensor, heads: usize) -> CandleResult<Tensor> {
    let (n, width) = x.dims2()?;
    let x = x.contiguous()?.reshape((n, heads, width / heads))?;
    x.transpose(0, 1)?.contiguous()
}

/// Softmax of every row.
fn softmax(scores: &Tensor) -> CandleResult<Tensor> {
    let scores = scores.broadcast_sub(&scores.max_keepdim(D::Minus1)?)?.exp()?;
    scores.broadcast_div(&scores.sum_keepdim(D::Minus1)?)
}

/// A residual block.
pub struct CandleResidual {
    norm: Norm,
    weight: Tensor, // [out, in, kernel, kernel]
    bias: Tensor,
    kernel: usize,
    second: CandleLinear,
}

impl CandleResidual {
    fn forward(&self, x: &CandleMap) -> CandleResult<Tensor> {
        let planes = self.norm.forward(&x.data)?;
        let planes = planes.reshape((x.rows, x.columns, x.width))?.permute((2, 0, 1))?;
        let planes = planes.unsqueeze(0)?.contiguous()?;
        let hidden = planes
            .conv2d(&self.weight, self.kernel / 2, 1, 1, 1)?
            .squeeze(0)?;
        let hidden = hidden.permute((1, 2, 0))?.contiguous()?;
        let hidden = hidden.reshape((x.rows * x.columns, x.width))?;
        let hidden = hidden.broadcast_add(&self.bias)?.gelu_erf()?;
        &x.data + self.second.forward(&hidden)?
    }
}

fn refused(error: candle_core::Error) -> OpsError {
    OpsError::new(Candle::NAME, error)
}

/// The values of an index on the device.
fn index(places: impl Iterator<Item = usize>, device: &Device) -> CandleResult<Tensor> {
    let places: Vec<u32> = places.map(|p| p as u32).collect();
    let count = places.len();
    Tensor::from_vec(places, count, device)
}

impl Ops for Candle {
    const NAME: &'static str = "candle";
    type Tensor = CandleMap;
    type Linear = CandleLinear;
    type Norm = Norm;
    type Residual = CandleResidual;
    type Table = Tensor;
    type Block = CandleBlock;
    type SparseConvolution = Convolution;
    type SparseResidual = sparse::CandleSiteResidual;
    type Room = ();
    type Messages = Messages;
    type NodeBlock = NodeBlock;
    type RingBlock = RingBlock;

    fn upload(&self, map: FeatureMap) -> Result<CandleMap, OpsError> {
        let (rows, columns, width) = (map.rows, map.columns, map.width);
        let data = self.tensor(map.data, rows * columns, width).map_err(refused)?;
        Ok(CandleMap {
            data,
            rows,
            columns,
            width,
        })
    }

    fn download(&self, x: CandleMap) -> Result<FeatureMap, OpsError> {
        let data = x.data.flatten_all().and_then(|t| t.to_vec1());
        Ok(FeatureMap {
            data: data.map_err(refused)?,
            rows: x.rows,
            columns: x.columns,
            width: x.width,
        })
    }

    fn linear_from(&self, weight: &[f32], bias: Vec<f32>, inputs: usize) -> Result<CandleLinear, OpsError> {
        let outputs = bias.len();
        let make = || {
            Ok(CandleLinear {
                weight: self.tensor(weight.to_vec(), outputs, inputs)?.t()?.contiguous()?,
                bias: self.tensor(bias, 1, outputs)?,
            })
        };
        make().map_err(refused)
    }

    fn norm_from(&self, scale: Vec<f32>, shift: Vec<f32>) -> Result<Norm, OpsError> {
        let width = scale.len();
        let make = || {
            Ok(Norm {
                scale: self.tensor(scale, 1, width)?,
                shift: self.tensor(shift, 1, width)?,
            })
        };
        make().map_err(refused)
    }

    fn residual_from(
        &self,
        norm: Norm,
        weight: &[f32],
        bias: Vec<f32>,
        kernel: usize,
        second: CandleLinear,
    ) -> Result<CandleResidual, OpsError> {
        let width = bias.len();
        let make = || {
            Ok(CandleResidual {
                norm,
                weight: Tensor::from_slice(weight, (width, width, kernel, kernel), &self.0)?,
                bias: self.tensor(bias, 1, width)?,
                kernel,
                second,
            })
        };
        make().map_err(refused)
    }

    fn table_from(&self, entries: Vec<f32>, width: usize) -> Result<Tensor, OpsError> {
        let count = entries.len() / width;
        self.tensor(entries, count, width).map_err(refused)
    }

    fn block_from(&self, parts: BlockParts<CandleLinear>) -> Result<CandleBlock, OpsError> {
        CandleBlock::new(parts, &self.0).map_err(refused)
    }

    fn sparse_from(&self, weight: &[f32], bias: Vec<f32>, taps: usize) -> Result<Convolution, OpsError> {
        Convolution::new(weight, bias, taps, &self.0).map_err(refused)
    }

    fn sparse_residual_from(
        &self,
        norm: Norm,
        convolution: Convolution,
        linear: CandleLinear,
    ) -> Result<sparse::CandleSiteResidual, OpsError> {
        Ok(sparse::CandleSiteResidual {
            norm,
            convolution,
            linear,
        })
    }

    fn messages_from(&self, parts: MessageParts<CandleLinear>) -> Result<Messages, OpsError> {
        Messages::new(parts, &self.0).map_err(refused)
    }

    fn node_block_from(&self, parts: NodeBlockParts<CandleLinear>) -> Result<NodeBlock, OpsError> {
        NodeBlock::new(parts, &self.0).map_err(refused)
    }

    fn ring_block_from(&self, parts: RingBlockParts<CandleLinear, Norm>) -> Result<RingBlock, OpsError> {
        RingBlock::new(parts, &self.0).map_err(refused)
    }

    fn ring_block(
        &self,
        block: &RingBlock,
        maps: Vec<CandleMap>,
        ada: &[CandleMap],
    ) -> Result<Vec<CandleMap>, OpsError> {
        block.forward(maps, ada).map_err(refused)
    }

    fn apply(&self, linear: &CandleLinear, x: &CandleMap, _: usize) -> Result<CandleMap, OpsError> {
        linear.forward(&x.data).and_then(|y| x.with(y)).map_err(refused)
    }

    fn apply_each(&self, layers: &[&CandleLinear], x: &CandleMap) -> Result<Vec<CandleMap>, OpsError> {
        layers.iter().map(|l| self.apply(l, x, 1)).collect()
    }

    fn norm(&self, norm: &Norm, x: CandleMap) -> Result<CandleMap, OpsError> {
        norm.forward(&x.data).and_then(|y| x.with(y)).map_err(refused)
    }

    fn modulate(&self, x: &CandleMap, ada: &CandleMap) -> Result<CandleMap, OpsError> {
        let parts = ada.data.chunk(2, 1).map_err(refused)?;
        let y = modulated(&x.data, &parts[0], &parts[1]);
        y.and_then(|y| x.with(y)).map_err(refused)
    }

    fn residual(&self, block: &CandleResidual, x: CandleMap) -> Result<CandleMap, OpsError> {
        block.forward(&x).and_then(|y| x.with(y)).map_err(refused)
    }

    fn reach(block: &CandleResidual) -> usize {
        block.kernel / 2
    }

    fn bag<I: Iterator<Item = usize>>(
        &self,
        table: &Tensor,
        x: CandleMap,
        entries: impl Fn(usize, usize) -> I + Sync,
    ) -> Result<CandleMap, OpsError> {
        let (mut codes, mut places) = (Vec::new(), Vec::new());
        for place in 0..x.rows * x.columns {
            for entry in entries(place / x.columns, place % x.columns) {
                codes.push(entry);
                places.push(place);
            }
        }
        if codes.is_empty() {
            return Ok(x);
        }
        let add = || {
            let vectors = table.index_select(&index(codes.into_iter(), &self.0)?, 0)?;
            x.with(
                x.data
                    .index_add(&index(places.into_iter(), &self.0)?, &vectors, 0)?,
            )
        };
        add().map_err(refused)
    }

    fn ada(block: &CandleBlock) -> &CandleLinear {
        block.ada()
    }

    fn block(
        &self,
        block: &CandleBlock,
        x: CandleMap,
        ada: &CandleMap,
        places: &[usize],
        keys_values: &mut CandleMap,
        precision: Precision,
    ) -> Result<CandleMap, OpsError> {
        if precision != Precision::F32 {
            return Err(OpsError::new(
                Self::NAME,
                "eight bits are for the processor's own kernels",
            ));
        }
        let run = || {
            let (y, kept) = block.forward(&x.data, &ada.data, places, &keys_values.data)?;
            Ok((x.with(y)?, keys_values.with(kept)?))
        };
        let (y, kept) = run().map_err(refused)?;
        *keys_values = kept;
        Ok(y)
    }

    fn likeliest(
        &self,
        head: &CandleLinear,
        x: &CandleMap,
        places: &[usize],
        voxels: usize,
        _: usize,
    ) -> Result<Vec<u8>, OpsError> {
        let run = || {
            let rows = x.data.index_select(&index(places.iter().copied(), &self.0)?, 0)?;
            let logits = head.forward(&rows)?;
            let classes = logits.dim(1)? / voxels;
            let best = logits.reshape((places.len(), classes, voxels))?.argmax(1)?;
            best.flatten_all()?.to_vec1::<u32>()
        };
        let best = run().map_err(refused)?;
        Ok(best.into_iter().map(|class| class as u8).collect())
    }

    fn sparse(
        &self,
        convolution: &Convolution,
        x: &CandleMap,
        rules: &RuleBook,
    ) -> Result<CandleMap, OpsError> {
        let run = || {
            let data = convolution.forward(&x.data, rules)?;
            let (rows, width) = data.dims2()?;
            Ok(CandleMap {
                data,
                rows,
                columns: 1,
                width,
            })
        };
        run().map_err(refused)
    }

    fn sparse_onto(
        &self,
        convolution: &Convolution,
        x: &CandleMap,
        rules: &RuleBook,
        onto: CandleMap,
    ) -> Result<CandleMap, OpsError> {
        self.add(onto, &self.sparse(convolution, x, rules)?)
    }

    fn sparse_residual(
        &self,
        block: &sparse::CandleSiteResidual,
        x: CandleMap,
        rules: &RuleBook,
        (): &mut (),
    ) -> Result<CandleMap, OpsError> {
        let y = block.forward(&x.data, rules);
        y.and_then(|y| x.with(y)).map_err(refused)
    }

    fn messages(&self, round: &Messages, x: CandleMap, edges: &[MessageEdge]) -> Result<CandleMap, OpsError> {
        let y = round.forward(&x.data, edges);
        y.and_then(|y| x.with(y)).map_err(refused)
    }

    fn node_block(
        &self,
        block: &NodeBlock,
        x: CandleMap,
        ada: &CandleMap,
        context: Option<&CandleMap>,
        bias: &CandleMap,
    ) -> Result<CandleMap, OpsError> {
        let y = block.forward(&x.data, &ada.data, context.map(|c| &c.data), &bias.data);
        y.and_then(|y| x.with(y)).map_err(refused)
    }

    fn relu(&self, x: CandleMap) -> Result<CandleMap, OpsError> {
        x.data.relu().and_then(|y| x.with(y)).map_err(refused)
    }

    fn gelu(&self, x: CandleMap) -> Result<CandleMap, OpsError> {
        x.data.gelu_erf().and_then(|y| x.with(y)).map_err(refused)
    }

    fn tanh(&self, x: CandleMap) -> Result<CandleMap, OpsError> {
        x.data.tanh().and_then(|y| x.with(y)).map_err(refused)
    }

    fn silu(&self, x: CandleMap) -> Result<CandleMap, OpsError> {
        x.data.silu().and_then(|y| x.with(y)).map_err(refused)
    }

    fn add(&self, x: CandleMap, y: &CandleMap) -> Result<CandleMap, OpsError> {
        let sum = x.data.broadcast_add(&y.data);
        sum.and_then(|sum| x.with(sum)).map_err(refused)
    }

    fn subtract(&self, x: &CandleMap, y: &CandleMap) -> Result<CandleMap, OpsError> {
        (&x.data - &y.data).and_then(|d| x.with(d)).map_err(refused)
    }

    fn fold(&self, x: &CandleMap) -> Result<CandleMap, OpsError> {
        let (rows, columns, width) = (x.rows / 2, x.columns / 2, x.width);
        let run = || {
            let parts = x
                .data
                .reshape((rows, 2, columns, 2, width))?
                .permute((0, 2, 1, 3, 4))?;
            parts.contiguous()?.reshape((rows * columns, 4 * width))
        };
        Ok(CandleMap {
            data: run().map_err(refused)?,
            rows,
            columns,
            width: 4 * width,
        })
    }

    fn unfold(&self, x: &CandleMap) -> Result<CandleMap, OpsError> {
        let width = x.width / 4;
        let run = || {
            let parts = x.data.reshape((x.rows, x.columns, 2, 2, width))?;
            let parts = parts.permute((0, 2, 1, 3, 4))?.contiguous()?;
            parts.reshape((4 * x.rows * x.columns, width))
        };
        Ok(CandleMap {
            data: run().map_err(refused)?,
            rows: 2 * x.rows,
            columns: 2 * x.columns,
            width,
        })
    }
}
