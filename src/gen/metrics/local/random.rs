//! Convolutions with fixed random weights, rectified and averaged over windows.

use rayon::prelude::*;

use world::draw::Draw;

/// A map `[rows][columns][channels]`.
pub struct FeatureMapView<'a> {
    pub data: &'a [f32],
    pub rows: usize,
    pub columns: usize,
}

/// Filters of `side x side` places over some channels.
pub struct Bank {
    channels: usize,
    side: usize,
    weights: Vec<Vec<f32>>, // per filter [dx][dy][channel], then the bias
}

/// A standard normal number (Box and Muller).
pub fn normal(draw: &mut Draw) -> f64 {
    let radius = (-2.0 * (1.0 - draw.unit()).ln()).sqrt();
    radius * (std::f64::consts::TAU * draw.unit()).cos()
}

impl Bank {
    /// The bank of that name; the same name always gives the same weights.
    pub fn new(name: &str, channels: usize, side: usize, filters: usize) -> Self {
        let mut draw = Draw::new(1, name);
        let inputs = side * side * channels;
        let weights = (0..filters).map(|_| {
            let mut filter: Vec<f32> = (0..inputs)
                .map(|_| (normal(&mut draw) / (inputs as f64).sqrt()) as f32)
                .collect();
            filter.push((normal(&mut draw) * 0.3) as f32);
            filter
        });
        Self {
            channels,
            side,
            weights: weights.collect(),
        }
    }

    /// Mean of every filter's positive part over every whole window of `window` places, row by row. Filters reach
    /// beyond their window, but stay inside the map.
    pub fn means(&self, map: &FeatureMapView<'_>, window: [usize; 2]) -> Vec<Vec<f64>> {
        let (down, across) = (map.rows / window[0], map.columns / window[1]);
        (0..down * across)
            .into_par_iter()
            .map(|i| {
                let (x0, y0) = (i / across * window[0], i % across * window[1]);
                let mut sums = vec![0.0f64; self.weights.len()];
                for x in x0..(x0 + window[0]).min((map.rows + 1).saturating_sub(self.side)) {
                    for y in y0..(y0 + window[1]).min((map.columns + 1).saturating_sub(self.side)) {
                        self.add(map, x, y, &mut sums);
                    }
                }
                let area = (window[0] * window[1]) as f64;
                sums.iter_mut().for_each(|s| *s /= area);
                sums
            })
            .collect()
    }

    fn add(&self, map: &FeatureMapView<'_>, x: usize, y: usize, sums: &mut [f64]) {
        let row = self.side * self.channels;
        for (filter, sum) in self.weights.iter().zip(sums) {
            let mut value = filter[filter.len() - 1];
            for (dx, weights) in filter.chunks_exact(row).enumerate() {
                let at = ((x + dx) * map.columns + y) * self.channels;
                let places = &map.data[at..at + row];
                value += weights.iter().zip(places).map(|(w, v)| w * v).sum::<f32>();
            }
            *sum += f64::from(value.max(0.0));
        }
    }
}
