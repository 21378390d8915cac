//! A small classifier that is trained on the spot: one hidden layer, Adam (Kingma and Ba 2014), decayed weights. Plain
//! f64 in a fixed order, so equal input gives equal bits.

use world::draw::Draw;

/// Units of the hidden layer.
const HIDDEN: usize = 24;
const BATCH: usize = 64;
const EPOCHS: usize = 20;
const RATE: f64 = 3e-3;
/// Weight decay: share of a weight taken off per step, times the rate.
const DECAY: f64 = 0.03;
/// Features are clamped to so many standard deviations.
const LARGEST: f64 = 5.0;

/// A trained classifier.
pub struct Net {
    mean: Vec<f64>,
    scale: Vec<f64>,
    weights: Vec<f64>, // [hidden][width + 1], then [hidden + 1]
}

impl Net {
    /// Learns to tell rows labelled true from rows labelled false. Rows have one length; the same seed gives the same net.
    pub fn train(rows: &[&[f64]], labels: &[bool], seed: u64) -> Self {
        let width = rows.first().map_or(0, |r| r.len());
        let n = rows.len().max(1) as f64;
        let mean: Vec<f64> = (0..width)
            .map(|f| rows.iter().map(|r| r[f]).sum::<f64>() / n)
            .collect();
        let scale = (0..width).map(|f| {
            let variance = rows.iter().map(|r| (r[f] - mean[f]).powi(2)).sum::<f64>() / n;
            if variance > 1e-20 {
                1.0 / variance.sqrt()
            } else {
                0.0
            }
        });
        let scale = scale.collect();
        let mut draw = Draw::new(seed, "two-sample classifier");
        let mut uniform = |inputs: usize, count: usize| -> Vec<f64> {
            let most = (3.0 / inputs as f64).sqrt();
            (0..count).map(|_| draw.range(-most, most)).collect()
        };
        let mut weights = uniform(width + 1, HIDDEN * (width + 1));
        weights.extend(uniform(HIDDEN + 1, HIDDEN + 1).iter().map(|w| 0.3 * w));
        let mut net = Self { mean, scale, weights };
        let inputs: Vec<Vec<f64>> = rows.iter().map(|r| net.input(r)).collect();
        net.fit(&inputs, labels, &mut draw);
        net
    }

    /// Standardised features and a 1 for the bias.
    fn input(&self, row: &[f64]) -> Vec<f64> {
        let each = row.iter().zip(&self.mean).zip(&self.scale);
        let mut out: Vec<f64> = each
            .map(|((v, m), s)| ((v - m) * s).clamp(-LARGEST, LARGEST))
            .collect();
        out.push(1.0);
        out
    }

    fn hidden(&self, input: &[f64]) -> [f64; HIDDEN] {
        let mut out = [0.0; HIDDEN];
        for (unit, weights) in out.iter_mut().zip(self.weights.chunks_exact(input.len())) {
            *unit = weights.iter().zip(input).map(|(w, v)| w * v).sum::<f64>().tanh();
        }
        out
    }

    fn output(&self, hidden: &[f64; HIDDEN]) -> f64 {
        let last = &self.weights[self.weights.len() - HIDDEN - 1..];
        last[HIDDEN] + last.iter().zip(hidden).map(|(w, h)| w * h).sum::<f64>()
    }

    fn fit(&mut self, inputs: &[Vec<f64>], labels: &[bool], draw: &mut Draw) {
        let wide = self.mean.len() + 1;
        let first = HIDDEN * wide; // of the output's weights
        let [mut slow, mut fast] = [vec![0.0; self.weights.len()], vec![0.0; self.weights.len()]];
        let mut order: Vec<usize> = (0..inputs.len()).collect();
        let mut step = 0;
        for epoch in 0..EPOCHS {
            shuffle(&mut order, draw);
            // The rate falls linearly to 0.
            let rate = RATE * (1.0 - epoch as f64 / EPOCHS as f64);
            for batch in order.chunks(BATCH) {
                let mut gradient = vec![0.0; self.weights.len()];
                for &i in batch {
                    let hidden = self.hidden(&inputs[i]);
                    let p = 1.0 / (1.0 + (-self.output(&hidden)).exp());
                    let error = (p - f64::from(u8::from(labels[i]))) / batch.len() as f64;
                    gradient[first + HIDDEN] += error;
                    for (h, value) in hidden.iter().enumerate() {
                        gradient[first + h] += error * value;
                        let back = error * self.weights[first + h] * (1.0 - value * value);
                        let row = gradient[h * wide..][..wide].iter_mut();
                        row.zip(&inputs[i]).for_each(|(g, v)| *g += back * v);
                    }
                }
                step += 1;
                let (slow_left, fast_left) = (1.0 - 0.9f64.powi(step), 1.0 - 0.999f64.powi(step));
                for (i, g) in gradient.iter().enumerate() {
                    slow[i] = 0.9 * slow[i] + 0.1 * g;
                    fast[i] = 0.999 * fast[i] + 0.001 * g * g;
                    let change = slow[i] / slow_left / ((fast[i] / fast_left).sqrt() + 1e-8);
                    self.weights[i] -= rate * (change + DECAY * self.weights[i]);
                }
            }
        }
    }

    /// Score of a row: above 0 if it looks like the rows labelled true.
    pub fn score(&self, row: &[f64]) -> f64 {
        self.output(&self.hidden(&self.input(row)))
    }
}

/// Fisher and Yates.
pub fn shuffle(order: &mut [usize], draw: &mut Draw) {
    for i in (1..order.len()).rev() {
        order.swap(i, draw.below(i + 1));
    }
}
