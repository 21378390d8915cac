//! Pictures of every second pixel, like the white fields of a chessboard. A pixel between takes the mean of its neighbours where
//! they show the same, else a sample of its own: edges and thin posts stay whole.

use glam::Vec3;
use rayon::prelude::*;

use super::shade::ShadedSample;

/// Largest difference of tone between the neighbours of a pixel that takes their mean.
const ALIKE: f32 = 0.06;

/// True for a pixel between those that are sampled first.
pub fn is_between(x: usize, y: usize) -> bool {
    (x + y) % 2 == 1
}

/// What a sample shows, without its normal, which the lower bits tell; sky and skyline have no normal.
fn surface(sample: &ShadedSample) -> u32 {
    match sample.key >> 8 {
        0 => sample.key,
        surface => surface << 8,
    }
}

/// Fills the pixels between in rows of `w` px. `tone` is the brightness of light, `sample` the sample of a pixel.
pub fn fill(
    samples: &mut [ShadedSample],
    w: usize,
    tone: impl Fn(Vec3) -> f32 + Sync,
    sample: impl Fn(usize, usize) -> Option<ShadedSample> + Sync,
) {
    if samples.is_empty() {
        return;
    }
    let h = samples.len() / w;
    let known = &*samples;
    let of = |x: usize, y: usize| -> Option<ShadedSample> {
        let around = [
            (x.wrapping_sub(1), y),
            (x + 1, y),
            (x, y.wrapping_sub(1)),
            (x, y + 1),
        ];
        let near = around.into_iter().filter(|(x, y)| *x < w && *y < h);
        let near = near.map(|(x, y)| &known[y * w + x]);
        let Some(first) = near.clone().next() else {
            return sample(x, y);
        };
        let (mut sum, mut n) = (Vec3::ZERO, 0.0);
        let (mut darkest, mut brightest) = (f32::INFINITY, f32::NEG_INFINITY);
        for other in near {
            let tone = tone(other.color);
            (darkest, brightest) = (darkest.min(tone), brightest.max(tone));
            (sum, n) = (sum + other.color, n + 1.0);
            if surface(other) != surface(first) || brightest - darkest > ALIKE {
                return sample(x, y);
            }
        }
        Some(ShadedSample {
            color: sum / n,
            ..*first
        })
    };
    let between: Vec<Vec<ShadedSample>> = (0..h)
        .into_par_iter()
        .map(|y| {
            let row = (0..w).filter(|x| is_between(*x, y));
            row.map(|x| of(x, y).unwrap_or_default()).collect()
        })
        .collect();
    for (y, row) in between.into_iter().enumerate() {
        let places = (0..w).filter(|x| is_between(*x, y));
        for (x, filled) in places.zip(row) {
            samples[y * w + x] = filled;
        }
    }
}
