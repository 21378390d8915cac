//! Layers on plain row-major slices: matrix product, linear, 3x3 convolution, layer norm, attention.
//! Work is cut into pieces of fixed size before it is spread over threads, so the number of threads
//! cannot change a bit.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::int8::Int8Matrix;
use super::kernels;
use super::map::FeatureMap;
pub use super::view::MatrixView;
use crate::Precision;
use crate::packed_matrix::{InitialSum, LANES, PANEL, PackedMatrix, product};
use crate::weights::{WeightFile, WeightsError};

/// Epsilon of every norm in these networks.
pub const NORM_EPS: f64 = 1e-6;

/// out[m x n, rows `out_stride` apart] = a[m x k] b[k x n], plus what `out` held if `add`.
/// One thread; sums over k run in the same order for every m.
pub fn matmul(
    out: &mut [f32],
    out_stride: usize,
    add: bool,
    a: MatrixView<'_>,
    b: MatrixView<'_>,
    [m, n, k]: [usize; 3],
) {
    if m == 0 || n == 0 {
        return;
    }
    assert!(k > 0 && out_stride >= n && (m - 1) * out_stride + n <= out.len());
    assert!(a.holds(m, k) && b.holds(k, n));
    // SAFETY: the asserts keep every address inside its slice, and `out` is borrowed for writing,
    // so it overlaps neither `a` nor `b`.
    unsafe {
        gemm::gemm(
            m,
            n,
            k,
            out.as_mut_ptr(),
            1,
            out_stride as isize,
            add,
            a.data.as_ptr(),
            a.column_stride as isize,
            a.row_stride as isize,
            b.data.as_ptr(),
            b.column_stride as isize,
            b.row_stride as isize,
            1.0,
            1.0,
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

/// y = x W + b.
pub struct Linear {
    weight: PackedMatrix, // [inputs][outputs]
    bias: Vec<f32>,
    /// The weight in eight bits, made when it is first needed.
    int8: OnceLock<Int8Matrix>,
}

impl Linear {
    /// Takes `name.weight` [outputs, inputs] and `name.bias`; `tail` is what the stored shape has
    /// after those two (1x1 of a convolution).
    pub fn new(
        w: &mut WeightFile<'_>,
        name: &str,
        inputs: usize,
        outputs: usize,
        tail: &[usize],
    ) -> Result<Self, WeightsError> {
        let bias = w.take(&format!("{name}.bias"), &[outputs])?;
        Ok(Self {
            bias,
            ..Self::without_bias(w, name, inputs, outputs, tail)?
        })
    }

    /// Takes `name.weight` as [`Self::new`] does; there is no bias.
    pub fn without_bias(
        w: &mut WeightFile<'_>,
        name: &str,
        inputs: usize,
        outputs: usize,
        tail: &[usize],
    ) -> Result<Self, WeightsError> {
        let shape = [&[outputs, inputs], tail].concat();
        let weight = w.take(&format!("{name}.weight"), &shape)?;
        Ok(Self::from_parts(&weight, vec![0.0; outputs], inputs))
    }

    /// The layer of a weight `[outputs][inputs]`.
    pub fn from_parts(weight: &[f32], bias: Vec<f32>, inputs: usize) -> Self {
        let weight = PackedMatrix::new(MatrixView::columns(weight, inputs), inputs, bias.len());
        Self {
            weight,
            bias,
            int8: OnceLock::new(),
        }
    }

    /// Rows of `x` to rows of `out`, on the calling thread.
    pub fn rows(&self, x: &[f32], out: &mut [f32]) {
        let (inputs, outputs) = (self.weight.inputs(), self.weight.outputs());
        let rows = x.len() / inputs;
        self.weight.multiply(
            x,
            inputs,
            [rows, 0, inputs],
            InitialSum::Bias(&self.bias),
            out,
            outputs,
        );
    }

    /// Rows of `x` to rows of `out`, on the calling thread, in the precision asked for.
    pub fn rows_in(&self, precision: Precision, x: &[f32], out: &mut [f32]) {
        match precision {
            Precision::F32 => self.rows(x, out),
            Precision::Int8 => {
                let int8 = self.int8.get_or_init(|| self.weight.to_int8());
                int8.multiply(x, &self.bias, out);
            }
        }
    }

    /// Numbers of a row of the output.
    pub fn outputs(&self) -> usize {
        self.weight.outputs()
    }

    /// Rows to rows, on the calling thread.
    pub fn vector(&self, x: &[f32]) -> Vec<f32> {
        let mut out = vec![0.0; x.len() / self.weight.inputs() * self.weight.outputs()];
        self.rows(x, &mut out);
        out
    }

    /// All rows of `x`, in pieces of `piece` rows on all cores.
    pub fn parallel(&self, x: &[f32], piece: usize) -> Vec<f32> {
        let (inputs, outputs) = (self.weight.inputs(), self.weight.outputs());
        let mut out = vec![0.0; x.len() / inputs * outputs];
        out.par_chunks_mut(piece * outputs)
            .zip(x.par_chunks(piece * inputs))
            .for_each(|(out, x)| self.rows(x, out));
        out
    }
}

/// Scale and shift of a norm.
pub struct Norm {
    /// Scale per channel.
    pub scale: Vec<f32>,
    /// Shift per channel.
    pub shift: Vec<f32>,
}

impl Norm {
    /// Takes `name.weight` and `name.bias`.
    pub fn new(w: &mut WeightFile<'_>, name: &str, width: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            scale: w.take(&format!("{name}.weight"), &[width])?,
            shift: w.take(&format!("{name}.bias"), &[width])?,
        })
    }

    /// Layer norm of every row.
    pub fn rows(&self, x: &[f32], out: &mut [f32]) {
        kernels::norm_rows(x, NORM_EPS, &self.scale, &self.shift, out);
    }
}

/// Rows of a map that are worked on in one piece.
const PIECE_ROWS: usize = 5;

/// x + W2 gelu(W1 norm(x)): W1 is a 3x3 or 1x1 convolution, W2 1x1. Twin of `ResBlock`.
pub struct ResBlock {
    norm: Norm,
    first: Linear, // rows of the weight ordered (dx, dy, channel)
    kernel: usize,
    second: Linear,
}

impl ResBlock {
    /// The block of its parts; `weight` is that of the convolution, `[out][in][kernel][kernel]`.
    pub fn from_parts(norm: Norm, weight: &[f32], bias: Vec<f32>, kernel: usize, second: Linear) -> Self {
        let width = bias.len();
        Self {
            norm,
            first: Self::convolution(weight, bias, width, kernel),
            kernel,
            second,
        }
    }

    /// `[out][in][kernel][kernel]` to `[out][kernel * kernel * in]`.
    fn convolution(weight: &[f32], bias: Vec<f32>, width: usize, kernel: usize) -> Linear {
        let taps = kernel * kernel;
        let mut moved = vec![0.0; weight.len()];
        for (at, v) in weight.iter().enumerate() {
            let (o, i, tap) = (at / (width * taps), at / taps % width, at % taps);
            moved[(o * taps + tap) * width + i] = *v;
        }
        Linear::from_parts(&moved, bias, width * taps)
    }

    /// How many cells away the block looks.
    pub fn reach(&self) -> usize {
        self.kernel / 2
    }

    /// Applies the block in place, on all cores.
    pub fn apply(&self, map: &mut FeatureMap) {
        let (columns, width) = (map.columns, map.width);
        if self.kernel == 1 {
            map.data
                .par_chunks_mut(PIECE_ROWS * columns * width)
                .for_each(|x| {
                    let (mut normed, mut hidden) = (vec![0.0; x.len()], vec![0.0; x.len()]);
                    self.norm.rows(x, &mut normed);
                    self.first.rows(&normed, &mut hidden);
                    kernels::gelu_all(&mut hidden);
                    self.second.rows(&hidden, &mut normed);
                    x.iter_mut().zip(&normed).for_each(|(x, y)| *x += y);
                });
            return;
        }
        // The normed map with a border of zeros: a cell and its two neighbours along y are then
        // 3 * width values in a row, so that a row of the convolution's matrix is just a place in
        // memory and nothing needs to be gathered.
        let stride = (columns + 2) * width;
        let mut padded = vec![0.0; (map.rows + 2) * stride];
        padded[stride..]
            .par_chunks_mut(stride)
            .zip(map.data.par_chunks(columns * width))
            .for_each(|(out, x)| {
                self.norm.rows(x, &mut out[width..(columns + 1) * width]);
            });
        let padded = &padded;
        map.data
            .par_chunks_mut(PIECE_ROWS * columns * width)
            .enumerate()
            .for_each(|(piece, x)| {
                let rows = x.len() / (columns * width);
                // Two cells between rows of the map belong to the border; they are computed and ignored.
                let cells = rows * (columns + 2) - 2;
                let mut hidden = vec![0.0; cells * width];
                for dx in 0..3 {
                    let from = (piece * PIECE_ROWS + dx) * stride;
                    let start = if dx == 0 {
                        InitialSum::Bias(&self.first.bias)
                    } else {
                        InitialSum::Add
                    };
                    let sizes = [cells, dx * 3 * width, 3 * width];
                    self.first
                        .weight
                        .multiply(&padded[from..], width, sizes, start, &mut hidden, width);
                }
                kernels::gelu_all(&mut hidden);
                let mut out = vec![0.0; cells * width];
                self.second.rows(&hidden, &mut out);
                for (x, y) in x.chunks_exact_mut(columns * width).zip(out.chunks(stride)) {
                    x.iter_mut().zip(y).for_each(|(x, y)| *x += y);
                }
            });
    }
}

/// Queries that are worked on together: their scores stay in the nearest cache.
const QUERIES: usize = 8;

/// Softmax(q k^T) v of one head.
pub struct Head<'a> {
    /// The head's keys, `[channel][token]`.
    keys: PackedMatrix,
    /// Keys and values of all tokens, one row each.
    keys_values: &'a [f32],
    /// Length of such a row.
    stride: usize,
    /// Start of the head's values in a row.
    value_at: usize,
}

impl<'a> Head<'a> {
    /// The head whose `width` keys start at `key_at` of every row of `stride` values, and whose values at `value_at`.
    pub fn new(keys_values: &'a [f32], stride: usize, width: usize, key_at: usize, value_at: usize) -> Self {
        let tokens = keys_values.len() / stride;
        Self {
            keys: PackedMatrix::new(MatrixView::columns(&keys_values[key_at..], stride), width, tokens),
            keys_values,
            stride,
            value_at,
        }
    }

    /// `queries`: rows x width, scaled by 1 / sqrt(width) already. Writes rows x width into `out`,
    /// rows `out_stride` apart.
    pub fn attend(&self, queries: &[f32], out: &mut [f32], out_stride: usize) {
        let (width, tokens) = (self.keys.inputs(), self.keys.outputs());
        let mut scores = vec![0.0; QUERIES * tokens];
        let mut sums = [0.0; QUERIES];
        for (queries, out) in queries
            .chunks(QUERIES * width)
            .zip(out.chunks_mut(QUERIES * out_stride))
        {
            let rows = queries.len() / width;
            let scores = &mut scores[..rows * tokens];
            self.keys
                .multiply(queries, width, [rows, 0, width], InitialSum::Zero, scores, tokens);
            kernels::softmax_rows(scores, tokens, &mut sums[..rows]);
            self.mix(scores, [rows, width, tokens], out, out_stride);
            for (row, sum) in out.chunks_mut(out_stride).zip(&sums) {
                row[..width].iter_mut().for_each(|v| *v /= sum);
            }
        }
    }

    /// out = scores times values.
    fn mix(&self, scores: &[f32], [rows, width, tokens]: [usize; 3], out: &mut [f32], out_stride: usize) {
        let values = &self.keys_values[self.value_at..];
        if width.is_multiple_of(LANES) {
            // Read where they lie, as many columns at a time as the product takes.
            let parts = width.div_ceil(PANEL);
            let part = (width / LANES).div_ceil(parts) * LANES;
            for first in (0..width).step_by(part) {
                let sizes = [rows, part.min(width - first), tokens];
                let (values, out) = (&values[first..], &mut out[first..]);
                product(
                    scores,
                    tokens,
                    values,
                    self.stride,
                    sizes,
                    InitialSum::Zero,
                    out,
                    out_stride,
                );
            }
        } else {
            let (a, b) = (
                MatrixView::rows(scores, tokens),
                MatrixView::rows(values, self.stride),
            );
            matmul(out, out_stride, false, a, b, [rows, width, tokens]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, step: f32) -> Vec<f32> {
        (0..n).map(|i| (i as f32 * step).sin()).collect()
    }

    /// Row 17: odd sizes, wide spread, against f64 sums.
    #[test]
    fn row_17_matmul() {
        for [m, n, k] in [
            [1, 1, 1],
            [3, 5, 31],
            [40, 17, 33],
            [2, 3, 100_000],
            [258, 128, 384],
        ] {
            let (mut a, b) = (wave(m * k, 0.37), wave(k * n, 0.73));
            for (i, v) in a.iter_mut().enumerate() {
                *v *= [1e18, 1e-18, 1.0, 1e-40][i % 4];
            }
            let mut out = vec![f32::NAN; m * n];
            matmul(
                &mut out,
                n,
                false,
                MatrixView::rows(&a, k),
                MatrixView::rows(&b, n),
                [m, n, k],
            );
            for (at, found) in out.iter().enumerate() {
                let terms = (0..k).map(|i| f64::from(a[at / n * k + i]) * f64::from(b[i * n + at % n]));
                let bound: f64 =
                    terms.clone().map(f64::abs).sum::<f64>() * k as f64 * f64::from(f32::EPSILON);
                let truth: f64 = terms.sum();
                assert!(
                    (f64::from(*found) - truth).abs() <= bound + 1e-37,
                    "{m} {n} {k}: {found}, expected {truth}"
                );
            }
        }
    }

    fn block(width: usize, kernel: usize) -> ResBlock {
        let weight = wave(width * width * kernel * kernel, 0.91);
        ResBlock {
            norm: Norm {
                scale: wave(width, 0.3),
                shift: wave(width, 0.2),
            },
            first: ResBlock::convolution(&weight, wave(width, 0.7), width, kernel),
            kernel,
            second: Linear::from_parts(&wave(width * width, 0.57), wave(width, 0.4), width),
        }
    }

    /// Row 18: against a direct f64 convolution, also on maps of one row or column. Padding is
    /// zeros that stand there, so nothing outside can leak in.
    #[test]
    fn row_18_residual_block() {
        const WIDTH: usize = 6;
        for (rows, columns, kernel) in [(7, 9, 3), (1, 4, 3), (5, 1, 3), (1, 1, 3), (12, 3, 1), (11, 2, 3)] {
            let block = block(WIDTH, kernel);
            let mut map = FeatureMap {
                data: wave(rows * columns * WIDTH, 0.17),
                rows,
                columns,
                width: WIDTH,
            };
            let x = map.data.clone();
            block.apply(&mut map);

            let (weight, reach) = (wave(WIDTH * WIDTH * kernel * kernel, 0.91), kernel as isize / 2);
            let mut normed = vec![0.0; x.len()];
            block.norm.rows(&x, &mut normed);
            let second = wave(WIDTH * WIDTH, 0.57);
            for at in 0..rows * columns {
                let (r, c) = ((at / columns) as isize, (at % columns) as isize);
                let mut hidden = [0.0f64; WIDTH];
                for (o, sum) in hidden.iter_mut().enumerate() {
                    *sum = f64::from(block.first.bias[o]);
                    for tap in 0..kernel * kernel {
                        let (y, z) = (
                            r + (tap / kernel) as isize - reach,
                            c + (tap % kernel) as isize - reach,
                        );
                        if y < 0 || z < 0 || y >= rows as isize || z >= columns as isize {
                            continue;
                        }
                        for i in 0..WIDTH {
                            let w = weight[(o * WIDTH + i) * kernel * kernel + tap];
                            *sum += f64::from(w)
                                * f64::from(normed[(y as usize * columns + z as usize) * WIDTH + i]);
                        }
                    }
                    *sum = f64::from(kernels::gelu(*sum as f32));
                }
                for o in 0..WIDTH {
                    let branch: f64 = hidden
                        .iter()
                        .enumerate()
                        .map(|(i, h)| f64::from(second[o * WIDTH + i]) * h)
                        .sum();
                    let truth = f64::from(x[at * WIDTH + o]) + branch + f64::from(block.second.bias[o]);
                    let found = f64::from(map.data[at * WIDTH + o]);
                    assert!(
                        (found - truth).abs() < 1e-5 * truth.abs().max(1.0),
                        "{rows}x{columns}: {found}, expected {truth}"
                    );
                }
            }
        }
    }
}
