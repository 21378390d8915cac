//! Convolutions over sites: gather the neighbours of each tap, multiply, scatter. One form serves submanifold, strided
//! and transposed convolution; they differ in their tables (Graham et al. 2018, arXiv 1711.10275).

use rayon::prelude::*;

use crate::generation::model::layers::{Linear, Norm, View};
use crate::generation::model::panels::{Panels, Start};
use crate::generation::weights::{WeightFile, WeightsError};

/// Sites that are worked on together.
const PIECE: usize = 256;

/// A sparse convolution; the weight's rows are ordered (tap, input).
pub struct Convolution {
    weight: Panels,
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
            weight: Panels::new(View::rows(weight, bias.len()), taps * inputs, bias.len()),
            bias,
            taps,
            inputs,
        }
    }

    /// One row per row of the table `[rows][taps]`, each the sum over the taps of the sites of `x` that are there.
    pub fn apply(&self, x: &[f32], table: &[u32]) -> Vec<f32> {
        let (inputs, outputs, sites) = (self.inputs, self.bias.len(), x.len() / self.inputs);
        let mut out = vec![0.0; table.len() / self.taps * outputs];
        out.par_chunks_mut(PIECE * outputs)
            .zip(table.par_chunks(PIECE * self.taps))
            .for_each_init(
                || (vec![0.0; PIECE * inputs], vec![0.0; PIECE * outputs], Vec::new()),
                |(gathered, product, rows), (out, table)| {
                    out.chunks_exact_mut(outputs)
                        .for_each(|row| row.copy_from_slice(&self.bias));
                    for tap in 0..self.taps {
                        rows.clear();
                        for (row, sources) in table.chunks_exact(self.taps).enumerate() {
                            let site = sources[tap] as usize;
                            if site < sites {
                                gathered[rows.len() * inputs..][..inputs]
                                    .copy_from_slice(&x[site * inputs..][..inputs]);
                                rows.push(row);
                            }
                        }
                        let sizes = [rows.len(), tap * inputs, inputs];
                        self.weight
                            .multiply(gathered, inputs, sizes, Start::Zero, product, outputs);
                        for (row, add) in rows.iter().zip(product.chunks_exact(outputs)) {
                            let to = &mut out[row * outputs..][..outputs];
                            to.iter_mut().zip(add).for_each(|(v, a)| *v += a);
                        }
                    }
                },
            );
        out
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

    /// In place.
    pub fn apply(&self, x: &mut [f32], around: &[u32]) {
        let normed = normed(&self.norm, x);
        let mut inner = self.conv.apply(&normed, around);
        inner.iter_mut().for_each(|v| *v = v.max(0.0));
        let add = self.linear.parallel(&inner, PIECE);
        x.iter_mut().zip(&add).for_each(|(v, a)| *v += a);
    }
}

/// Layer norm of every row, on all cores.
pub fn normed(norm: &Norm, x: &[f32]) -> Vec<f32> {
    let piece = PIECE * norm.scale.len();
    let mut out = vec![0.0; x.len()];
    out.par_chunks_mut(piece)
        .zip(x.par_chunks(piece))
        .for_each(|(out, x)| norm.rows(x, out));
    out
}

#[cfg(test)]
mod tests {
    use super::super::sites::{CHILDREN, Sites, TAPS};
    use super::*;
    use crate::generation::model::golden::{Golden, gap};

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
    /// 2e-5 of the largest value); strided and transposed convolution; borders; duplicates.
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
                gap(&found, &expected) < 2e-5,
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
        assert!(gap(&down, &expected) < 2e-5);
        let up = convolution(&golden, "sparse.up", [4, 3, CHILDREN], true).apply(&down, &fine.parent);
        let expected = f64s(rows(&golden.f64("sparse.up.out"), 3, &fine.keys));
        assert!(gap(&up, &expected) < 2e-5);
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
