//! A block of a diffusion transformer over a map of tokens (adaLN-Zero of Peebles and Xie, arXiv 2212.09748, with
//! a depthwise convolution over the values: LePE, arXiv 2107.00652), fused for the processor.

use rayon::prelude::*;

use crate::Precision;
use crate::int8_attention::Int8Head;
use crate::kernels;
use crate::layers::{Head, Linear, NORM_EPS};
use crate::ops::BlockParts;

/// Most tokens that are worked on in one piece.
const PIECE: usize = 80;
/// Fewest: small sets are spread over the cores too.
const SMALL_PIECE: usize = 16;
/// Neighbours that a value is mixed with, itself among them.
const NEAR: usize = 9;

enum AnyHead<'a> {
    F32(Head<'a>),
    Int8(Int8Head),
}

/// A block with its weights, over a square map.
pub struct TransformerBlock {
    /// Time to shift, scale and gate of attention, then of the MLP.
    pub(crate) ada: Linear,
    body: TransformerCore,
    side: usize,
}

/// The part of a block after its modulation: shifts, scales and gates are given. Works on a map of any shape.
pub(crate) struct TransformerCore {
    qkv: Linear,
    proj: Linear,
    fc1: Linear,
    fc2: Linear,
    local: Option<Local>,
    heads: usize,
}

/// A depthwise 3x3 convolution over the map of tokens.
struct Local {
    weight: Vec<f32>, // [neighbour][width]
    bias: Vec<f32>,
}

/// Which tokens of a map are computed.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    /// Places of the tokens, row by row.
    pub at: &'a [usize],
    /// Rows and columns of the map.
    pub shape: [usize; 2],
}

/// Tokens in a piece of work; depends on nothing but their number.
pub fn piece_of(tokens: usize) -> usize {
    tokens.div_ceil(4).clamp(SMALL_PIECE, PIECE)
}

impl TransformerBlock {
    /// The block of its parts.
    pub fn new(parts: BlockParts<Linear>) -> Self {
        Self {
            body: TransformerCore::new(
                [parts.qkv, parts.proj, parts.fc1, parts.fc2],
                parts.local,
                parts.heads,
            ),
            ada: parts.ada,
            side: parts.side,
        }
    }

    /// Applies the block in place to some tokens of one sequence, which stand at `places` of it. `keys_values` holds
    /// those of the whole sequence; these tokens' own are renewed first. `ada` is shift, scale, gate for attention,
    /// then the same for the MLP.
    pub fn apply(
        &self,
        tokens: &mut [f32],
        ada: &[f32],
        places: &[usize],
        keys_values: &mut [f32],
        precision: Precision,
    ) {
        let places = Places {
            at: places,
            shape: [self.side; 2],
        };
        let mlp = self.body.mlp(ada, precision);
        self.body.attend(tokens, ada, places, keys_values, precision, mlp);
    }
}

impl TransformerCore {
    /// The body of its parts, without a convolution if `local` is `None`.
    pub(crate) fn new(
        [qkv, proj, fc1, fc2]: [Linear; 4],
        local: Option<(Vec<f32>, Vec<f32>)>,
        heads: usize,
    ) -> Self {
        Self {
            qkv,
            proj,
            fc1,
            fc2,
            local: local.map(|(weight, bias)| Local::new(&weight, bias)),
            heads,
        }
    }

    /// Attention of the block, see [`TransformerBlock::apply`]; `then` is called with every piece of tokens.
    pub(crate) fn attend(
        &self,
        tokens: &mut [f32],
        ada: &[f32],
        places: Places<'_>,
        keys_values: &mut [f32],
        precision: Precision,
        then: impl Fn(&mut [f32]) + Sync,
    ) {
        let width = ada.len() / 6;
        let part = |i: usize| &ada[i * width..][..width];
        let scale: Vec<f32> = part(1).iter().map(|s| 1.0 + s).collect();
        let piece_tokens = piece_of(places.at.len());

        let mut qkv = vec![0.0; places.at.len() * 3 * width];
        qkv.par_chunks_mut(piece_tokens * 3 * width)
            .zip(tokens.par_chunks(piece_tokens * width))
            .for_each(|(qkv, x)| {
                let mut normed = vec![0.0; x.len()];
                kernels::norm_rows(x, NORM_EPS, &scale, part(0), &mut normed);
                self.qkv.rows_in(precision, &normed, qkv);
            });
        for (row, place) in qkv.chunks_exact(3 * width).zip(places.at) {
            keys_values[place * 2 * width..][..2 * width].copy_from_slice(&row[width..]);
        }
        let keys_values = &*keys_values;
        let head_width = width / self.heads;
        let heads: Vec<AnyHead<'_>> = (0..self.heads)
            .into_par_iter()
            .map(|h| {
                let (at, stride) = (h * head_width, 2 * width);
                match precision {
                    Precision::F32 => {
                        AnyHead::F32(Head::new(keys_values, stride, head_width, at, width + at))
                    }
                    Precision::Int8 => {
                        AnyHead::Int8(Int8Head::new(keys_values, stride, head_width, at, width + at))
                    }
                }
            })
            .collect();
        tokens
            .par_chunks_mut(piece_tokens * width)
            .zip(qkv.par_chunks(piece_tokens * 3 * width))
            .enumerate()
            .for_each(|(piece, (x, qkv))| {
                let mut attended = vec![0.0; x.len()];
                for (h, head) in heads.iter().enumerate() {
                    let at = h * head_width;
                    let queries = shrunk_queries(qkv, 3 * width, at, head_width);
                    match head {
                        AnyHead::F32(head) => head.attend(&queries, &mut attended[at..], width),
                        AnyHead::Int8(head) => head.attend(&queries, &mut attended[at..], width),
                    }
                }
                if let Some(local) = &self.local {
                    let rows = attended.chunks_exact_mut(width);
                    for (row, place) in rows.zip(&places.at[piece * piece_tokens..]) {
                        local.add_at(*place, places.shape, keys_values, row);
                    }
                }
                let mut out = vec![0.0; x.len()];
                self.proj.rows_in(precision, &attended, &mut out);
                kernels::add_gated(x, part(2), &out);
                then(x);
            });
    }

    /// The MLP of the block, applied in place to some tokens.
    pub(crate) fn mlp<'a>(&'a self, ada: &'a [f32], precision: Precision) -> impl Fn(&mut [f32]) + Sync + 'a {
        let width = ada.len() / 6;
        let part = move |i: usize| &ada[i * width..][..width];
        let scale: Vec<f32> = part(4).iter().map(|s| 1.0 + s).collect();
        move |x| {
            let mut out = vec![0.0; x.len()];
            kernels::norm_rows(x, NORM_EPS, &scale, part(3), &mut out);
            let mut hidden = vec![0.0; 4 * x.len()];
            self.fc1.rows_in(precision, &out, &mut hidden);
            match precision {
                Precision::F32 => kernels::gelu_all(&mut hidden),
                Precision::Int8 => kernels::gelu_all_roughly(&mut hidden),
            }
            self.fc2.rows_in(precision, &hidden, &mut out);
            kernels::add_gated(x, part(5), &out);
        }
    }
}

/// A head's queries, which start at `at` of every row of `stride` numbers, divided by the root of their width.
pub(crate) fn shrunk_queries(rows: &[f32], stride: usize, at: usize, width: usize) -> Vec<f32> {
    let shrink = 1.0 / (width as f32).sqrt();
    let mut queries = Vec::with_capacity(rows.len() / stride * width);
    for row in rows.chunks_exact(stride) {
        queries.extend(row[at..][..width].iter().map(|q| q * shrink));
    }
    queries
}

impl Local {
    /// The convolution of `weight`, `[width][3][3]`.
    fn new(weight: &[f32], bias: Vec<f32>) -> Self {
        let width = bias.len();
        Self {
            weight: (0..NEAR * width)
                .map(|i| weight[i % width * NEAR + i / width])
                .collect(),
            bias,
        }
    }

    /// Adds to `row` the convolution of the values around the token at `place`; beyond the map there is nothing.
    fn add_at(&self, place: usize, [rows, columns]: [usize; 2], keys_values: &[f32], row: &mut [f32]) {
        let width = row.len();
        row.iter_mut().zip(&self.bias).for_each(|(r, b)| *r += b);
        let [x, y] = [place / columns, place % columns];
        for (near, weight) in self.weight.chunks_exact(width).enumerate() {
            let (x, y) = (x + near / 3, y + near % 3); // one too far each
            if (1..=rows).contains(&x) && (1..=columns).contains(&y) {
                let token = (x - 1) * columns + y - 1;
                let values = &keys_values[(2 * token + 1) * width..][..width];
                for ((r, v), w) in row.iter_mut().zip(values).zip(weight) {
                    *r += v * w;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{Golden, gap};

    const WIDTH: usize = 16;
    const HEADS: usize = 4;

    fn linear(golden: &Golden, name: &str, inputs: usize) -> Linear {
        Linear::from_parts(
            &golden.f32(&format!("{name}.weight")),
            golden.f32(&format!("{name}.bias")),
            inputs,
        )
    }

    fn block(golden: &Golden, ada: Linear) -> TransformerBlock {
        TransformerBlock::new(BlockParts {
            ada,
            qkv: linear(golden, "dit.qkv", WIDTH),
            proj: linear(golden, "dit.proj", WIDTH),
            fc1: linear(golden, "dit.fc1", WIDTH),
            fc2: linear(golden, "dit.fc2", 4 * WIDTH),
            local: None,
            heads: HEADS,
            side: 25,
        })
    }

    /// Runs the block over sequences of `length` tokens: x [2][..][length][16], c [2][16].
    fn run(block: &TransformerBlock, x: &[f32], c: &[f32], length: usize) -> Vec<f32> {
        let mut out = x.to_vec();
        for (half, c) in out.chunks_exact_mut(x.len() / 2).zip(c.chunks_exact(WIDTH)) {
            let time: Vec<f32> = c.iter().map(|v| kernels::silu(*v)).collect();
            let places: Vec<usize> = (0..length).collect();
            for sequence in half.chunks_exact_mut(length * WIDTH) {
                let mut keys_values = vec![f32::NAN; length * 2 * WIDTH];
                block.apply(
                    sequence,
                    &block.ada.vector(&time),
                    &places,
                    &mut keys_values,
                    Precision::F32,
                );
            }
        }
        out
    }

    /// Tolerance of nn.json: 2e-5 of the largest value.
    #[test]
    fn adaln_zero_block_against_torch() {
        let golden = Golden::nn();
        let (x, c) = (golden.f32("dit.x"), golden.f32("dit.c"));
        let ours = block(&golden, linear(&golden, "dit.ada", WIDTH));
        assert!(gap(&run(&ours, &x, &c, 12), &golden.f64("dit.spatial")) < 2e-5);
        // One token each: the first one of every sequence of the first frame.
        let single: Vec<f32> = x
            .chunks_exact(3 * 12 * WIDTH)
            .flat_map(|b| b[..WIDTH].to_vec())
            .collect();
        assert!(gap(&run(&ours, &single, &c, 1), &golden.f64("dit.single_token")) < 2e-5);
        // Zero modulation gates both branches off: x comes back bit for bit.
        let zero = Linear::from_parts(&vec![0.0; 6 * WIDTH * WIDTH], vec![0.0; 6 * WIDTH], WIDTH);
        assert_eq!(run(&block(&golden, zero), &x, &c, 12), x);
    }
}
