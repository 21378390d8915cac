//! The noise that pictures are drawn from.

#[cfg(feature = "networks")]
use diffusion::schedule::NoiseLevel;
use numeric::philox::{Stream, normal};

use crate::{StableError, check_finite, check_length};

/// Size of latents: pictures, channels, rows, columns, in the order in which numbers lie.
pub type LatentSize = [usize; 4];

/// Number of values of such latents.
pub(crate) fn count(size: LatentSize) -> usize {
    size.iter().product()
}

/// Standard normal noise that depends on the seed, the frame and the place alone: Philox4x32-10 with the seed as its
/// key, counted by (picture * rows * columns + row * columns + column, channel, frame, [`Stream::Pictures`]), by Box
/// and Muller. It is equal on every machine and with any number of threads, and differs from PyTorch's.
pub fn fresh(seed: u64, frame: u32, size: LatentSize) -> Vec<f32> {
    let [_, channels, rows, columns] = size;
    let cells = rows * columns;
    let at = |i: usize| {
        let (picture, channel, cell) = (i / (channels * cells), i / cells % channels, i % cells);
        let cell = (picture * cells + cell) as u32;
        normal(seed, Stream::Pictures, cell, channel as u32, frame) as f32
    };
    (0..count(size)).map(at).collect()
}

/// The noise of the frame before, moved to where its surfaces are seen now. For each latent cell
/// `[picture][row][column]` of this frame, `from` gives the cell of the frame before that showed the same surface.
/// Cells without one take `fresh` noise, and so does the second of two cells with the same origin: the noise stays
/// white and of unit spread. Errors if sizes do not fit or a given cell does not exist.
pub fn carried(
    before: &[f32],
    from: &[Option<u32>],
    fresh: &[f32],
    size: LatentSize,
) -> Result<Vec<f32>, StableError> {
    let [pictures, channels, rows, columns] = size;
    let cells = rows * columns;
    check_length("noise of the frame before", before.len(), count(size))?;
    check_length("fresh noise", fresh.len(), count(size))?;
    check_length("cells of the frame before", from.len(), pictures * cells)?;
    let mut taken = vec![false; from.len()];
    let mut out = fresh.to_vec();
    for (to, from) in from.iter().enumerate() {
        let Some(from) = from.map(|f| f as usize) else {
            continue;
        };
        let Some(taken) = taken.get_mut(from) else {
            let expected = format!("less than {}", pictures * cells);
            return Err(crate::wrong("cell of the frame before", from, expected));
        };
        if std::mem::replace(taken, true) {
            continue;
        }
        for channel in 0..channels {
            let at = |cell: usize| (cell / cells * channels + channel) * cells + cell % cells;
            out[at(to)] = before[at(from)];
        }
    }
    Ok(out)
}

/// UniScene's noise prior (Li et al. 2024, equation 5): noise + `lambda` times the latents of a reference frame, warped
/// to this frame's view and 0 where it does not see them. UniScene takes 0.03. Errors if sizes do not fit or a number
/// is not finite.
pub fn with_prior(noise: &[f32], warped: &[f32], lambda: f32) -> Result<Vec<f32>, StableError> {
    check_length("latents of the reference", warped.len(), noise.len())?;
    check_finite("latents of the reference", warped)?;
    check_finite("lambda", &[lambda])?;
    Ok(noise.iter().zip(warped).map(|(n, z)| n + lambda * z).collect())
}

/// Clean latents with noise at a level, in 64 bits.
#[cfg(feature = "networks")]
pub(crate) fn noised(clean: &[f32], noise: &[f32], level: &NoiseLevel) -> Vec<f64> {
    let pairs = clean.iter().zip(noise);
    pairs
        .map(|(c, n)| level.alpha * f64::from(*c) + level.sigma * f64::from(*n))
        .collect()
}
