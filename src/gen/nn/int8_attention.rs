//! Softmax(q k^T) v of one head in eight bits: scores and mixtures are exact integer sums, each weight of the softmax
//! is one of 256 steps of the row's largest, and the divisor is the sum of those steps, so that weights that were
//! rounded still sum to one. The same bits on every machine.

use super::int8::{Int8Matrix, Wide, quantise_rows};
use crate::vectorised;

/// Queries that are worked on together.
const QUERIES: usize = 8;

/// Keys and values of one head.
pub struct Int8Head {
    /// `[channel][token]`.
    keys: Int8Matrix,
    /// `[token][channel]`.
    values: Int8Matrix,
}

impl Int8Head {
    /// The head whose `width` keys start at `key_at` of every row of `stride` values, and whose values at `value_at`.
    pub fn new(keys_values: &[f32], stride: usize, width: usize, key_at: usize, value_at: usize) -> Self {
        Self {
            keys: Int8Matrix::of_columns(&keys_values[key_at..], stride, width),
            values: Int8Matrix::of_rows(&keys_values[value_at..], stride, width),
        }
    }

    /// `queries`: rows x width, scaled by 1 / sqrt(width) already. Writes rows x width into `out`, rows `out_stride`
    /// apart; NaN where a query is not finite.
    pub fn attend(&self, queries: &[f32], out: &mut [f32], out_stride: usize) {
        let (width, tokens) = (self.keys.inputs(), self.keys.outputs());
        let mut quantised = vec![0u8; QUERIES * width.next_multiple_of(4)];
        let mut steps = [0.0; QUERIES];
        let mut scores = vec![0.0; QUERIES * tokens];
        let weights_stride = tokens.next_multiple_of(4);
        let mut weights = vec![0u8; QUERIES * weights_stride];
        for (queries, out) in queries
            .chunks(QUERIES * width)
            .zip(out.chunks_mut(QUERIES * out_stride))
        {
            let rows = queries.len() / width;
            let quantised = &mut quantised[..rows * width.next_multiple_of(4)];
            quantise_rows(queries, width, quantised, &mut steps[..rows]);
            self.keys.sums(quantised, rows, |first, columns, sums| {
                for (r, sums) in sums.iter().enumerate() {
                    let (offsets, scales) = self.keys.of(first, columns);
                    let scores = &mut scores[r * tokens + first..][..columns];
                    scaled_scores(&sums[..columns], offsets, scales, steps[r], scores);
                }
            });
            let mut totals = [0u32; QUERIES];
            for r in 0..rows {
                let weights = &mut weights[r * weights_stride..][..tokens];
                softmax_steps(&scores[r * tokens..][..tokens], weights, &mut totals[r]);
            }
            let weights = &weights[..rows * weights_stride];
            self.values.sums(weights, rows, |first, columns, sums: &[Wide]| {
                for (r, sums) in sums.iter().enumerate() {
                    let (_, scales) = self.values.of(first, columns);
                    // A total is at least 255: the largest score's weight is.
                    let whole = if steps[r].is_nan() {
                        f32::NAN
                    } else {
                        1.0 / totals[r] as f32
                    };
                    let out = &mut out[r * out_stride + first..][..columns];
                    for ((o, s), scale) in out.iter_mut().zip(sums).zip(scales) {
                        *o = *s as f32 * (scale * whole);
                    }
                }
            });
        }
    }
}

vectorised! {
    /// Sums of one query to scores.
    pub fn scaled_scores(sums: &[i32], offsets: &[i32], columns: &[f32], row: f32, out: &mut [f32]) {
        for (((o, s), offset), c) in out.iter_mut().zip(sums).zip(offsets).zip(columns) {
            *o = (*s - offset) as f32 * (row * c);
        }
    }
}

vectorised! {
    #[allow(clippy::approx_constant)] // fitted coefficients; the measured results of the presets hang on their bits
    /// exp(score - largest) in steps of 1/255, within half a step and a thousandth, and the sum of them.
    pub fn softmax_steps(scores: &[f32], steps: &mut [u8], total: &mut u32) {
        let mut maxima = [f32::NEG_INFINITY; 16];
        let chunks = scores.chunks_exact(16);
        for v in chunks.remainder() {
            maxima[0] = if *v > maxima[0] { *v } else { maxima[0] };
        }
        for chunk in chunks {
            for (m, v) in maxima.iter_mut().zip(chunk) {
                *m = if *v > *m { *v } else { *m };
            }
        }
        let largest = maxima.into_iter().fold(f32::NEG_INFINITY, f32::max);
        // Adding 1.5 * 2^23 rounds to the nearest whole number, which then stands in the low bits.
        const ROUND: f32 = 12_582_912.0;
        for (step, score) in steps.iter_mut().zip(scores) {
            let power = (score - largest) * std::f32::consts::LOG2_E;
            let power = if power > -20.0 { power } else { -20.0 };
            let shifted = power + ROUND;
            let f = power - (shifted - ROUND);
            // 2^f for |f| <= 1/2, within 1e-4.
            let p = ((0.055_5 * f + 0.240_23) * f + 0.693_147) * f + 1.0;
            let two_to_n = f32::from_bits(shifted.to_bits().wrapping_add(127) << 23);
            *step = (p * two_to_n * 255.0 + ROUND).to_bits() as u8;
        }
        let mut sum = 0u32;
        for step in steps.iter() {
            sum += u32::from(*step);
        }
        *total = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row 11, for eight bits: the weights are within half a step of the true ones whatever the scores, and sum to one.
    #[test]
    fn row_11_int8_softmax() {
        for scores in [
            vec![1e4f32, -1e4, 0.0],
            vec![3e38, -3e38, 3e38, 1.0],
            vec![-3e38; 7],
            vec![0.25; 625],
            vec![42.0],
            (0..625).map(|i| (i as f32 * 0.7).sin() * 6.0).collect(),
        ] {
            let (mut steps, mut total) = (vec![0u8; scores.len()], 0);
            softmax_steps(&scores, &mut steps, &mut total);
            assert_eq!(total, steps.iter().map(|s| u32::from(*s)).sum::<u32>());
            assert!(total >= 255);
            let max = f64::from(scores.iter().copied().fold(f32::MIN, f32::max));
            for (step, score) in steps.iter().zip(&scores) {
                let truth = 255.0 * (f64::from(*score) - max).exp();
                assert!(
                    (f64::from(*step) - truth).abs() <= 0.5 + 0.26,
                    "{step}, expected {truth}"
                );
            }
        }
    }

    /// Against f64 on plain numbers; rows alone and among others, any number of tokens.
    #[test]
    fn attention_is_near_the_truth() {
        let width = 48;
        for tokens in [1, 5, 61, 625] {
            let stride = 2 * width;
            let kv: Vec<f32> = (0..tokens * stride).map(|i| (i as f32 * 0.731).sin()).collect();
            let queries: Vec<f32> = (0..11 * width).map(|i| (i as f32 * 0.377).cos() * 0.3).collect();
            let head = Int8Head::new(&kv, stride, width, 0, width);
            let mut out = vec![f32::NAN; 11 * width];
            head.attend(&queries, &mut out, width);
            let mut alone = vec![f32::NAN; width];
            head.attend(&queries[10 * width..], &mut alone, width);
            assert_eq!(alone, out[10 * width..]);
            for r in 0..11 {
                let dot = |t: usize| -> f64 {
                    (0..width)
                        .map(|c| f64::from(queries[r * width + c]) * f64::from(kv[t * stride + c]))
                        .sum()
                };
                let scores: Vec<f64> = (0..tokens).map(dot).collect();
                let max = scores.iter().copied().fold(f64::MIN, f64::max);
                let total: f64 = scores.iter().map(|s| (s - max).exp()).sum();
                for c in 0..width {
                    let truth: f64 = (0..tokens)
                        .map(|t| (scores[t] - max).exp() / total * f64::from(kv[t * stride + width + c]))
                        .sum();
                    let found = f64::from(out[r * width + c]);
                    assert!(
                        (found - truth).abs() < 0.02,
                        "{tokens}: {found}, expected {truth}"
                    );
                }
            }
        }
    }
}
