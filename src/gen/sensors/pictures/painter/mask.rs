//! Parts of the pictures that change when the scene does.

use super::seen::RingFrame;
use nets::picture::{CELL, RingSize};

/// Cells around that of a changed pixel that are painted too.
const AROUND: usize = RIM_PX.div_ceil(CELL);
/// Least difference of the renderer's colours, of 255, for which a pixel is painted because of its light alone.
const LIGHT: u8 = 5;
/// Pixels this near to a changed one count as new too: the network paints things a little wider than their voxels.
const WIDER_PX: usize = 6;
/// Width of the rim around changed pixels in which new paint fades into the old picture, px.
pub const RIM_PX: usize = 10;

/// Changed pixels of each view: those that show another class, depth or heading, or another light on it, such as the
/// shadow of a thing that was added or removed.
pub(super) fn changed(then: &RingFrame, now: &RingFrame, size: RingSize) -> Vec<Vec<bool>> {
    let [height, width] = size.pixels();
    let of_view = |view: usize| {
        let ((a, old), (b, new)) = (then.pixels(view), now.pixels(view));
        let told =
            |i: usize| a.class[i] != b.class[i] || a.depth_m[i] != b.depth_m[i] || a.facing[i] != b.facing[i];
        let lit = |i: usize| old[i].iter().zip(new[i]).any(|(a, b)| a.abs_diff(b) > LIGHT);
        (0..height * width).map(|i| told(i) || lit(i)).collect()
    };
    (0..size.views()).map(of_view).collect()
}

/// Latent cells that pixels around a change depend on, `[view][row][column]`.
pub(super) fn cells(changed: &[Vec<bool>], size: RingSize) -> Vec<bool> {
    let [rows, columns] = size.cells();
    let width = columns * CELL;
    let mut out = vec![false; size.views() * rows * columns];
    for (view, pixels) in changed.iter().enumerate() {
        for (at, _) in pixels.iter().enumerate().filter(|(_, c)| **c) {
            let [row, column] = [at / width / CELL, at % width / CELL];
            for r in row.saturating_sub(AROUND)..(row + AROUND + 1).min(rows) {
                for c in column.saturating_sub(AROUND)..(column + AROUND + 1).min(columns) {
                    out[(view * rows + r) * columns + c] = true;
                }
            }
        }
    }
    out
}

/// Share of each pixel that is new: 1 within [`WIDER_PX`] pixels of a change, then less, 0 from [`RIM_PX`] pixels on.
pub(super) fn shares(changed: &[bool], width: usize) -> Vec<f32> {
    let mut shares: Vec<f32> = changed.iter().map(|c| f32::from(u8::from(*c))).collect();
    let height = changed.len() / width.max(1);
    for ring in 1..RIM_PX {
        let over = ring.saturating_sub(WIDER_PX) as f32;
        let share = 1.0 - over / (RIM_PX - WIDER_PX) as f32;
        let before = shares.clone();
        for y in 0..height {
            for x in 0..width {
                let near = |(x, y): (usize, usize)| before[y * width + x] >= share;
                let rows = y.saturating_sub(1)..(y + 2).min(height);
                let mut around =
                    rows.flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (x, y)));
                let at = &mut shares[y * width + x];
                if *at == 0.0 && around.any(near) {
                    *at = share;
                }
            }
        }
    }
    shares
}

/// New colours where they are new, old ones elsewhere; 4 bytes a pixel.
pub(super) fn blend(old: &[u8], new: &mut [u8], shares: &[f32]) {
    let pixels = old.chunks_exact(4).zip(new.chunks_exact_mut(4)).zip(shares);
    for ((old, new), share) in pixels {
        for (old, new) in old.iter().zip(new) {
            let (a, b) = (f32::from(*old), f32::from(*new));
            *new = (a + (b - a) * share).round() as u8;
        }
    }
}
