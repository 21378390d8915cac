//! Convolutions over sites on the processor: gather the neighbours of each tap, multiply, scatter.

use rayon::prelude::*;

use crate::layers::{Linear, MatrixView, Norm};
use crate::packed_matrix::PackedMatrix;
use crate::rules::{PIECE, Piece, RuleBook};

/// A sparse convolution; the weight's rows are ordered (tap, input).
pub struct Convolution {
    weight: PackedMatrix,
    bias: Vec<f32>,
    taps: usize,
    inputs: usize,
}

impl Convolution {
    /// The convolution of a weight `[tap][input][output]`.
    pub fn from_parts(weight: &[f32], bias: Vec<f32>, taps: usize) -> Self {
        let inputs = weight.len() / (taps * bias.len());
        Self {
            weight: PackedMatrix::new(MatrixView::rows(weight, bias.len()), taps * inputs, bias.len()),
            bias,
            taps,
            inputs,
        }
    }

    /// Numbers of a row of the output.
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// One row per row of the rule book, each the sum over the taps of the sites of `x` that are there.
    pub fn apply(&self, x: &[f32], rules: &RuleBook) -> Vec<f32> {
        let outputs = self.outputs();
        let mut out = vec![0.0; rules.rows() * outputs];
        out.par_chunks_mut(PIECE * outputs)
            .zip(rules.pieces())
            .for_each(|(out, piece)| self.piece(x, piece, out));
        out
    }

    /// `out += `[`Self::apply`].
    pub fn add(&self, x: &[f32], rules: &RuleBook, out: &mut [f32]) {
        let outputs = self.outputs();
        out.par_chunks_mut(PIECE * outputs)
            .zip(rules.pieces())
            .for_each_init(Vec::new, |room, (out, piece)| {
                room.resize(out.len(), 0.0);
                self.piece(x, piece, room);
                out.iter_mut().zip(&*room).for_each(|(v, a)| *v += a);
            });
    }

    fn piece(&self, x: &[f32], piece: &Piece, out: &mut [f32]) {
        let outputs = self.outputs();
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
pub struct SiteResidual {
    norm: Norm,
    conv: Convolution,
    linear: Linear,
}

impl SiteResidual {
    /// The block of its parts.
    pub fn from_parts(norm: Norm, conv: Convolution, linear: Linear) -> Self {
        Self { norm, conv, linear }
    }

    /// Applies the block in place; `normed` is room that may be used again.
    pub fn apply(&self, x: &mut [f32], around: &RuleBook, normed: &mut Vec<f32>) {
        normed.resize(x.len().max(normed.len()), 0.0);
        let normed = &mut normed[..x.len()];
        norm_all(&self.norm, x, normed);
        let normed = &*normed;
        let width = self.conv.outputs();
        x.par_chunks_mut(PIECE * width)
            .zip(around.pieces())
            .for_each_init(
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
