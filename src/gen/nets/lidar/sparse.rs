//! Convolutions over sites: gather the neighbours of each tap, multiply, scatter. One form serves submanifold, strided
//! and transposed convolution; they differ in their tables (Graham et al. 2018, arXiv 1711.10275).

use rayon::prelude::*;

use nn::layers::{Linear, Norm, View};
use nn::packed_matrix::PackedMatrix;
use nn::weights::{WeightFile, WeightsError};

/// Sites that are worked on together.
pub const PIECE: usize = 256;

/// Where the rows of a convolution take their inputs from: a piece is [`PIECE`] rows.
pub struct Gather {
    rows: usize,
    pieces: Vec<Piece>,
}

/// One piece: pairs [row of the piece, site], tap by tap.
struct Piece {
    ends: Vec<u32>, // of each tap's pairs
    pairs: Vec<[u32; 2]>,
}

impl Gather {
    /// For `rows` rows of `taps` taps each; `source(row, tap)` is the site there, `sites` or more for none.
    pub fn new(rows: usize, taps: usize, sites: usize, source: impl Fn(usize, usize) -> u32 + Sync) -> Self {
        let piece = |room: &mut Vec<[u32; 2]>, first: usize| {
            let last = (first + PIECE).min(rows);
            room.resize(PIECE * taps, [0; 2]);
            let (mut ends, mut n) = (Vec::with_capacity(taps), 0);
            for tap in 0..taps {
                for row in first..last {
                    // Written so that nothing has to be guessed by the processor: what is not there is overwritten.
                    let site = source(row, tap);
                    room[n] = [(row - first) as u32, site];
                    n += usize::from((site as usize) < sites);
                }
                ends.push(n as u32);
            }
            Piece {
                ends,
                pairs: room[..n].to_vec(),
            }
        };
        let firsts: Vec<usize> = (0..rows).step_by(PIECE).collect();
        let pieces = firsts.into_par_iter().map_init(Vec::new, piece).collect();
        Self { rows, pieces }
    }

    /// Of no rows.
    pub fn none() -> Self {
        Self {
            rows: 0,
            pieces: Vec::new(),
        }
    }

    /// All pairs [row, site] of a tap, in order.
    pub fn pairs(&self, tap: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.pieces.iter().enumerate().flat_map(move |(i, piece)| {
            let first = (i * PIECE) as u32;
            piece.tap(tap).iter().map(move |[row, site]| [first + row, *site])
        })
    }
}

impl Piece {
    fn tap(&self, tap: usize) -> &[[u32; 2]] {
        let from = if tap == 0 { 0 } else { self.ends[tap - 1] };
        &self.pairs[from as usize..self.ends[tap] as usize]
    }
}

/// A sparse convolution; the weight's rows are ordered (tap, input).
pub struct Convolution {
    weight: PackedMatrix,
    bias: Vec<f32>,
    taps: usize,
    inputs: usize,
}

impl Convolution {
    /// Takes `name.weight` of `shape`, whose numbers are `taps * inputs * outputs`, and `name.bias`.
    pub fn new(
        w: &mut WeightFile<'_>,
        name: &str,
        [taps, inputs, outputs]: [usize; 3],
        shape: &[usize],
    ) -> Result<Self, WeightsError> {
        let weight = w.take(&format!("{name}.weight"), shape)?;
        let bias = w.take(&format!("{name}.bias"), &[outputs])?;
        Ok(Self::from_parts(&weight, bias, taps, inputs))
    }

    /// From a weight `[tap][input][output]`.
    pub fn from_parts(weight: &[f32], bias: Vec<f32>, taps: usize, inputs: usize) -> Self {
        Self {
            weight: PackedMatrix::new(View::rows(weight, bias.len()), taps * inputs, bias.len()),
            bias,
            taps,
            inputs,
        }
    }

    /// One row per row of the gather, each the sum over the taps of the sites of `x` that are there.
    pub fn apply(&self, x: &[f32], from: &Gather) -> Vec<f32> {
        let outputs = self.bias.len();
        let mut out = vec![0.0; from.rows * outputs];
        out.par_chunks_mut(PIECE * outputs)
            .zip(&from.pieces)
            .for_each(|(out, piece)| self.piece(x, piece, out));
        out
    }

    /// `out += `[`Self::apply`].
    pub fn add(&self, x: &[f32], from: &Gather, out: &mut [f32]) {
        let outputs = self.bias.len();
        out.par_chunks_mut(PIECE * outputs)
            .zip(&from.pieces)
            .for_each_init(Vec::new, |room, (out, piece)| {
                room.resize(out.len(), 0.0);
                self.piece(x, piece, room);
                out.iter_mut().zip(&*room).for_each(|(v, a)| *v += a);
            });
    }

    fn piece(&self, x: &[f32], piece: &Piece, out: &mut [f32]) {
        let outputs = self.bias.len();
        out.chunks_exact_mut(outputs)
            .for_each(|row| row.copy_from_slice(&self.bias));
        for tap in 0..self.taps {
            let rows = [tap * self.inputs, self.inputs];
            self.weight
                .add_pairs(x, self.inputs, piece.tap(tap), rows, out, outputs);
        }
    }
}

/// x + W relu(conv(norm(x))). Twin of `Block`.
pub struct Block {
    norm: Norm,
    conv: Convolution,
    linear: Linear,
}

impl Block {
    /// Takes `name.norm`, `name.conv`, `name.linear`.
    pub fn new(w: &mut WeightFile<'_>, name: &str, width: usize) -> Result<Self, WeightsError> {
        let sizes = [super::sites::TAPS, width, width];
        Ok(Self {
            norm: Norm::new(w, &format!("{name}.norm"), width)?,
            conv: Convolution::new(w, &format!("{name}.conv"), sizes, &[sizes[0] * width, width])?,
            linear: Linear::new(w, &format!("{name}.linear"), width, width, &[])?,
        })
    }

    /// In place; `normed` is room that may be used again.
    pub fn apply(&self, x: &mut [f32], around: &Gather, normed: &mut Vec<f32>) {
        normed.resize(x.len().max(normed.len()), 0.0);
        let normed = &mut normed[..x.len()];
        norm_all(&self.norm, x, normed);
        let normed = &*normed;
        let width = self.conv.bias.len();
        x.par_chunks_mut(PIECE * width).zip(&around.pieces).for_each_init(
            || (Vec::new(), Vec::new()),
            |(inner, add), (x, piece)| {
                inner.resize(x.len(), 0.0);
                add.resize(x.len(), 0.0);
                self.conv.piece(normed, piece, inner);
                inner.iter_mut().for_each(|v| *v = v.max(0.0));
                self.linear.rows(inner, add);
                x.iter_mut().zip(&*add).for_each(|(v, a)| *v += a);
            },
        );
    }
}

/// Layer norm of every row, on all cores.
fn norm_all(norm: &Norm, x: &[f32], out: &mut [f32]) {
    let piece = PIECE * norm.scale.len();
    out.par_chunks_mut(piece)
        .zip(x.par_chunks(piece))
        .for_each(|(out, x)| norm.rows(x, out));
}

#[cfg(test)]
mod tests {
    use super::super::sites::{CHILDREN, Sites, TAPS};
    use super::*;
    use crate::golden::{Golden, gap};

    const SHAPE: [usize; 3] = [6, 6, 4];

    /// `[out][in][taps]` to a convolution over (tap, in, out); `swap` for `[in][out][taps]`.
    fn convolution(
        golden: &Golden,
        name: &str,
        [inputs, outputs, taps]: [usize; 3],
        swap: bool,
    ) -> Convolution {
        let weight = golden.f32(&format!("{name}.weight"));
        let mut ordered = vec![0.0; weight.len()];
        for (i, v) in weight.iter().enumerate() {
            let (a, b, tap) = (
                i / (taps * if swap { outputs } else { inputs }),
                i / taps,
                i % taps,
            );
            let (input, output) = if swap { (a, b % outputs) } else { (b % inputs, a) };
            ordered[(tap * inputs + input) * outputs + output] = *v;
        }
        Convolution::from_parts(&ordered, golden.f32(&format!("{name}.bias")), taps, inputs)
    }

    /// Sites where `active` is set, and rows of the dense `[channel][x][y][z]` field there.
    fn rows(field: &[f64], channels: usize, keys: &[u32]) -> Vec<f32> {
        let places = field.len() / channels;
        let row = |k: &u32| {
            (0..channels)
                .map(|c| field[c * places + *k as usize] as f32)
                .collect::<Vec<_>>()
        };
        keys.iter().flat_map(row).collect()
    }

    fn keys(active: &[f64]) -> Vec<u32> {
        (0..active.len() as u32)
            .filter(|k| active[*k as usize] > 0.0)
            .collect()
    }

    fn f64s(values: Vec<f32>) -> Vec<f64> {
        values.into_iter().map(f64::from).collect()
    }

    /// Row 53 of the extremes table: no, one, some and all voxels against torch 2.15.0 in float64 (reference/nn.json,
    /// 1e-5 of the largest value); strided and transposed convolution; borders; duplicates.
    #[test]
    fn row_53_sparse_convolutions() {
        let golden = Golden::nn();
        let conv = convolution(&golden, "sparse", [3, 5, TAPS], false);
        for name in ["none", "one", "some", "all"] {
            let mut active = keys(&f64s(golden.f32(&format!("sparse.{name}.active"))));
            let x = rows(&f64s(golden.f32(&format!("sparse.{name}.x"))), 3, &active);
            let truth = golden.f64(&format!("sparse.{name}.submanifold"));
            active.extend(active.clone()); // duplicates count once
            let sites = Sites::new(SHAPE, active);
            let found = conv.apply(&x, &sites.levels[0].around);
            assert_eq!(found.len(), sites.levels[0].keys.len() * 5);
            if found.is_empty() {
                assert!(truth.iter().all(|v| *v == 0.0));
                continue;
            }
            let expected = f64s(rows(&truth, 5, &sites.levels[0].keys));
            assert!(
                gap(&found, &expected) < 1e-5,
                "{name}: {}",
                gap(&found, &expected)
            );
        }
        let sites = Sites::new(SHAPE, keys(&f64s(golden.f32("sparse.some.active"))));
        let (fine, coarse) = (&sites.levels[0], &sites.levels[1]);
        assert_eq!(coarse.keys, keys(&golden.f64("sparse.down.active")));
        let x = rows(&golden.f64("sparse.some.submanifold"), 5, &fine.keys);
        let down = convolution(&golden, "sparse.down", [5, 4, CHILDREN], false).apply(&x, &coarse.children);
        let expected = f64s(rows(&golden.f64("sparse.down.out"), 4, &coarse.keys));
        assert!(gap(&down, &expected) < 1e-5);
        let up = convolution(&golden, "sparse.up", [4, 3, CHILDREN], true).apply(&down, &fine.parent);
        let expected = f64s(rows(&golden.f64("sparse.up.out"), 3, &fine.keys));
        assert!(gap(&up, &expected) < 1e-5);
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let keys: Vec<u32> = (0..200 * 200 * 16).step_by(31).collect();
        let sites = Sites::new([200, 200, 16], keys);
        let x: Vec<f32> = (0..sites.levels[0].keys.len() * 3)
            .map(|i| (i as f32 * 0.37).sin())
            .collect();
        let conv = convolution(&Golden::nn(), "sparse", [3, 5, TAPS], false);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| conv.apply(&x, &sites.levels[0].around))
        };
        assert_eq!(on(1), on(3));
    }
}
