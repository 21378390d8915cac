//! The frame before, as seen from the cells of this one.

use rayon::prelude::*;

use super::{CELL, RingSize};
use crate::{ModelError, check_finite, check_length};

/// Number of latents of the frame before in the input of a cell; two numbers and a flag follow.
pub(super) const BEFORE: usize = 4;
/// Depth taken where there is no surface, m.
const FAR_M: f32 = 1000.0;
/// Least depth at which a surface is projected, m.
const NEAREST_M: f32 = 0.1;
/// Share of its depth below which a nearer surface at its place counts as hiding it.
const HIDDEN: f32 = 0.75;

/// Optics of a camera, and its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Focal lengths along x and y, px.
    pub focal_px: [f32; 2],
    /// Principal point, px from the picture's upper left corner.
    pub center_px: [f32; 2],
    /// First three rows of the matrix that takes points, m, from the camera's optical frame now to that of the frame before.
    pub then_from_now: [[f32; 4]; 3],
}

/// Input of cells from the frame before, `[view][row][column][4 * 8 + 3]`: the four latents around the place where
/// their surface was seen (row by row), how far the place is between them (row, column; 0 to 1), and 1; all 0 where the
/// surface was outside of the picture or hidden.
#[derive(Clone, Debug, PartialEq)]
pub struct WarpedLatents(Vec<f32>);

impl WarpedLatents {
    /// All numbers.
    pub fn numbers(&self) -> &[f32] {
        &self.0
    }

    /// Numbers of a view.
    pub(super) fn view(&self, view: usize, size: RingSize) -> &[f32] {
        let numbers = self.0.len() / size.views();
        &self.0[view * numbers..][..numbers]
    }
}

/// Latents of the frame before, `[view][row][column][numbers]`, as the input of the cells of this one. Depths are of
/// pixels now and then, `[view][height][width]`, m along the optical axis, 0 where there is nothing; one motion per
/// view. Errors if the sizes do not fit or a number is not finite.
pub fn warp(
    size: RingSize,
    latents_before: &[f32],
    [depth_m, depth_before_m]: [&[f32]; 2],
    motions: &[Motion],
) -> Result<WarpedLatents, ModelError> {
    let (views, pixels) = (size.views(), size.view_pixels());
    let numbers = latents_before.len() / (views * size.view_cells());
    let expected = views * size.view_cells() * numbers.max(1);
    check_length("latents before", latents_before.len(), expected)?;
    check_length("depths", depth_m.len(), views * pixels)?;
    check_length("depths before", depth_before_m.len(), views * pixels)?;
    check_length("motions", motions.len(), views)?;
    check_finite("latent before", latents_before)?;
    check_finite("depth", depth_m)?;
    check_finite("depth before", depth_before_m)?;
    for motion in motions {
        check_finite("focal length", &motion.focal_px)?;
        check_finite("principal point", &motion.center_px)?;
        check_finite("motion", motion.then_from_now.as_flattened())?;
    }
    let wide = BEFORE * numbers + 3;
    let mut out = vec![0.0; views * size.view_cells() * wide];
    out.par_chunks_mut(size.view_cells() * wide)
        .zip(latents_before.par_chunks(size.view_cells() * numbers))
        .zip(depth_m.par_chunks(pixels).zip(depth_before_m.par_chunks(pixels)))
        .zip(motions)
        .for_each(|(((out, latents), (now, then)), motion)| {
            let (now, then) = (cell_depths(now, size), cell_depths(then, size));
            for (cell, (out, deep)) in out.chunks_exact_mut(wide).zip(now).enumerate() {
                let at = [cell / size.columns, cell % size.columns];
                if let Some(seen) = WarpSource::from_depths(at, deep, &then, motion, size) {
                    seen.write(latents, size, out);
                }
            }
        });
    Ok(WarpedLatents(out))
}

/// Depth of each cell of a view: that of the pixel right below its middle; far away where there is none.
fn cell_depths(depth_m: &[f32], size: RingSize) -> Vec<f32> {
    let [rows, columns] = size.cells();
    let middle = |cell: usize| cell * CELL + CELL / 2;
    let at = |row: usize, column: usize| depth_m[middle(row) * columns * CELL + middle(column)];
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| at(row, column)));
    all.map(|d| if d <= 0.0 { FAR_M } else { d }).collect()
}

/// Place where a cell's surface was seen in the frame before.
struct WarpSource {
    /// The cell above and left of the place; may be one outside.
    low: [f32; 2],
    /// Offset from there to the place, 0 to 1.
    part: [f32; 2],
}

impl WarpSource {
    /// The place where a cell's surface was seen; `None` if it was outside or hidden. `depths_then_m` are of cells. All
    /// in 32 bits and in the order of the twin, since a rounding may decide.
    fn from_depths(
        [row, column]: [usize; 2],
        depth_m: f32,
        depths_then_m: &[f32],
        motion: &Motion,
        size: RingSize,
    ) -> Option<Self> {
        let in_cells = |px: [f32; 2]| px.map(|v| v / CELL as f32);
        let ([fx, fy], [cx, cy]) = (in_cells(motion.focal_px), in_cells(motion.center_px));
        let ray = [
            (column as f32 + 0.5 - cx) / fx * depth_m,
            (row as f32 + 0.5 - cy) / fy * depth_m,
            depth_m,
        ];
        let [x, y, z] = motion
            .then_from_now
            .map(|m| m[0] * ray[0] + m[1] * ray[1] + m[2] * ray[2] + m[3]);
        let ahead = z.max(NEAREST_M);
        let (at_v, at_u) = (y / ahead * fy + cy - 0.5, x / ahead * fx + cx - 0.5);
        let [rows, columns] = size.cells().map(|n| n as f32);
        // Written so that NaN is outside.
        let inside = at_u > -0.5 && at_u < columns - 0.5 && at_v > -0.5 && at_v < rows - 0.5 && z > NEAREST_M;
        if !inside {
            return None;
        }
        let low = [at_v.floor(), at_u.floor()];
        let part = [at_v - low[0], at_u - low[1]];
        let seen = Self { low, part };
        let nearest = part.map(f32::round_ties_even);
        (depths_then_m[seen.cell(nearest, size)] > HIDDEN * z).then_some(seen)
    }

    /// The cell at an offset from [`low`](Self::low), or the one at the rim.
    fn cell(&self, off: [f32; 2], size: RingSize) -> usize {
        let [row, column] = [0, 1].map(|i| {
            let last = size.cells()[i] - 1;
            (self.low[i] + off[i]).clamp(0.0, last as f32) as usize
        });
        row * size.columns + column
    }

    /// Writes the cell's numbers.
    fn write(&self, latents: &[f32], size: RingSize, out: &mut [f32]) {
        let numbers = (out.len() - 3) / BEFORE;
        let around = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        for (out, off) in out.chunks_exact_mut(numbers).zip(around) {
            out.copy_from_slice(&latents[self.cell(off, size) * numbers..][..numbers]);
        }
        out[BEFORE * numbers..].copy_from_slice(&[self.part[0], self.part[1], 1.0]);
    }
}
