//! Blends splats front to back into one 16 x 16 tile of an image, a row of pixels at a time.

use crate::scene::sensor_data::RENDER_IDS;

/// Edge of a tile, px.
pub(super) const TILE: usize = 16;

type Row = [f32; TILE];

/// A projected Gaussian as the inner loop wants it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    /// Centre, px.
    pub mean_px: [f32; 2],
    /// Exponent = `along` (dx - `shear` dy)^2 + `across` dy^2; both weights are negative.
    pub along: f32,
    pub shear: f32,
    pub across: f32,
    /// Opacity at the centre, 0 to 1.
    pub opacity: f32,
    /// Below this exponent alpha is under the threshold.
    pub min_exponent: f32,
    pub depth_m: f32,
    pub id: u8,
}

/// Thresholds of the blending.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub alpha_min: f32,
    pub alpha_max: f32,
    pub t_stop: f32,
}

/// What is summed per pixel, `[row][column]`.
pub(super) struct Tile {
    /// What light is left, falling from 1.
    pub transmittance: [Row; TILE],
    /// Sum of weight times depth, m.
    pub expected_m: [Row; TILE],
    /// Depth at which less than half the light is left, -1 before.
    pub median_m: [Row; TILE],
    /// Weight per render id.
    pub weights: [[Row; TILE]; RENDER_IDS],
}

impl Tile {
    /// A tile of which `columns` x `rows` pixels lie inside the image; the others never take light.
    pub fn new(columns: usize, rows: usize) -> Box<Tile> {
        let mut tile = Box::new(Tile {
            transmittance: [[0.0; TILE]; TILE],
            expected_m: [[0.0; TILE]; TILE],
            median_m: [[-1.0; TILE]; TILE],
            weights: [[[0.0; TILE]; TILE]; RENDER_IDS],
        });
        tile.reset(columns, rows);
        tile
    }

    /// Back to the state of [`Tile::new`].
    pub fn reset(&mut self, columns: usize, rows: usize) {
        self.transmittance = [[0.0; TILE]; TILE];
        for row in self.transmittance.iter_mut().take(rows) {
            row[..columns.min(TILE)].fill(1.0);
        }
        self.expected_m = [[0.0; TILE]; TILE];
        self.median_m = [[-1.0; TILE]; TILE];
        self.weights = [[[0.0; TILE]; TILE]; RENDER_IDS];
    }

    /// Blends `splats`, near to far, into the tile whose first pixel is `origin_px`.
    pub fn blend<'a>(
        &mut self,
        splats: impl Iterator<Item = &'a Splat>,
        origin_px: [usize; 2],
        limits: Limits,
    ) {
        // Rows in which every pixel has had its light are skipped; a look every few splats is enough.
        const LOOK: u32 = 8;
        let mut live = [true; TILE];
        let mut until_look = LOOK;
        for splat in splats {
            let dx0 = origin_px[0] as f32 + 0.5 - splat.mean_px[0];
            let dy0 = origin_px[1] as f32 + 0.5 - splat.mean_px[1];
            for (row, &live) in live.iter().enumerate() {
                let dy = dy0 + row as f32;
                let from_y = splat.across * dy * dy;
                // The slack leaves the decision at the threshold itself to alpha.
                if !live || from_y < splat.min_exponent - 1e-3 {
                    continue;
                }
                blend_row(
                    splat,
                    dx0 - splat.shear * dy,
                    from_y,
                    limits,
                    &mut self.transmittance[row],
                    &mut self.expected_m[row],
                    &mut self.median_m[row],
                    &mut self.weights[splat.id as usize][row],
                );
            }
            until_look -= 1;
            if until_look == 0 {
                until_look = LOOK;
                for (live, t) in live.iter_mut().zip(&self.transmittance) {
                    *live = t.iter().any(|&t| t >= limits.t_stop);
                }
                if live == [false; TILE] {
                    return;
                }
            }
        }
    }
}

/// One splat over one row of pixels; `dx` belongs to the first. Written without branches so that
/// the compiler makes vectors of it.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "four rows that are written at once")]
fn blend_row(
    splat: &Splat,
    dx: f32,
    from_y: f32,
    limits: Limits,
    transmittance: &mut Row,
    expected_m: &mut Row,
    median_m: &mut Row,
    weight: &mut Row,
) {
    for i in 0..TILE {
        let dx = dx + i as f32;
        let exponent = splat.along * dx * dx + from_y;
        let alpha = (splat.opacity * exp(exponent)).min(limits.alpha_max);
        let t = transmittance[i];
        let seen = (alpha >= limits.alpha_min) & (t >= limits.t_stop);
        let w = if seen { alpha * t } else { 0.0 };
        // As a difference: then weights and what is left add up to 1 whatever was rounded.
        let left = t - w;
        transmittance[i] = left;
        weight[i] += w;
        expected_m[i] += w * splat.depth_m;
        let passes_half = seen & (median_m[i] < 0.0) & (left < 0.5);
        median_m[i] = if passes_half { splat.depth_m } else { median_m[i] };
    }
}

/// e^x for x <= 0, relative error below 1e-6 down to -87; smaller x count as -87 (1e-38).
#[inline(always)]
pub(super) fn exp(x: f32) -> f32 {
    /// Adding it leaves the nearest integer in the low bits of the mantissa.
    const ROUND: f32 = 12_582_912.0;
    let y = x.max(-87.0) * std::f32::consts::LOG2_E;
    let rounded = y + ROUND;
    let f = (y - (rounded - ROUND)) * std::f32::consts::LN_2; // within ln 2 / 2
    let series = 1.0
        + f * (1.0
            + f * (1.0 / 2.0 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    let power = f32::from_bits((rounded.to_bits() << 23).wrapping_add(1.0f32.to_bits()));
    series * power
}

/// The heaviest render id of one pixel, the lowest on a tie, and how far it leads the second.
/// `None` where nothing was drawn.
pub(super) fn heaviest(weights: impl Iterator<Item = f32>) -> Option<(u8, f32)> {
    let (mut best, mut top, mut second) = (None, 0.0, 0.0);
    for (id, w) in weights.enumerate() {
        if w > top {
            (best, second, top) = (Some(id as u8), top, w);
        } else if w > second {
            second = w;
        }
    }
    best.map(|id| (id, top - second))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_is_close_and_never_rises() {
        let mut last = 2.0;
        for i in 0..=1_000_000 {
            let x = -(i as f32) * 9e-5;
            let (got, want) = (f64::from(exp(x)), f64::from(x.max(-87.0)).exp());
            assert!(
                (got / want - 1.0).abs() < 2e-6 * f64::from(1.0 - x / 8.0),
                "{x}: {got} {want}"
            );
            assert!(got <= last * (1.0 + 1e-6));
            last = got;
        }
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e30) < 1e-37 && exp(f32::NEG_INFINITY) < 1e-37);
    }

    #[test]
    fn row_42_ties_go_to_the_lowest() {
        let of = |w: &[f32]| heaviest(w.iter().copied());
        assert_eq!(of(&[0.0, 0.25, 0.5, 0.5, 0.1]), Some((2, 0.0)));
        assert_eq!(of(&[0.5, 0.25, 0.5]), Some((0, 0.0)));
        assert_eq!(of(&[0.0, 0.1, 0.4]), Some((2, 0.4 - 0.1)));
        assert_eq!(of(&[0.0; 20]), None);
        assert_eq!(of(&[]), None);
    }
}
