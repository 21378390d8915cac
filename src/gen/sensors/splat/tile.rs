//! Blends splats front to back into one 16 x 16 tile of an image, a row of pixels at a time.

use scene::sensor_data::RENDER_IDS;

/// Edge of a tile, px.
pub(crate) const TILE: usize = 16;

type TileRow = [f32; TILE];

/// A projected Gaussian as the inner loop wants it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splat {
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
pub(crate) struct BlendThresholds {
    pub alpha_min: f32,
    pub alpha_max: f32,
    pub t_stop: f32,
}

/// A splat and the pixels that it may touch: first and one past the last, x then y.
pub(crate) type SplatPixels = (Splat, [[u16; 2]; 2]);

/// Sums per pixel, `[row][column]`.
pub(crate) struct Tile {
    transmittance: [TileRow; TILE],
    expected_m: [TileRow; TILE],
    median_m: [TileRow; TILE],
    /// Weight per render id; only the ids in `used` are meaningful.
    weights: [[TileRow; TILE]; RENDER_IDS],
    used: u32,
}

/// Results of a row of pixels.
#[derive(Clone, Copy)]
pub(crate) struct Resolved {
    /// Sum of weights.
    pub coverage: TileRow,
    /// Sum of weight times depth, m.
    pub expected_m: TileRow,
    /// Depth at which less than half the light was left, -1 if never.
    pub median_m: TileRow,
    /// Heaviest id, the lowest on a tie; -1 where nothing was drawn.
    pub label: [i16; TILE],
    /// Lead of that id over the second.
    pub margin: TileRow,
    /// Light that is left.
    pub transmittance: TileRow,
}

/// A row on which nothing was drawn.
pub(crate) const NOTHING: Resolved = Resolved {
    coverage: [0.0; TILE],
    expected_m: [0.0; TILE],
    median_m: [-1.0; TILE],
    label: [-1; TILE],
    margin: [0.0; TILE],
    transmittance: [1.0; TILE],
};

impl Tile {
    /// Room for a tile, to be used again and again.
    pub fn new() -> Box<Tile> {
        Box::new(Tile {
            transmittance: [[0.0; TILE]; TILE],
            expected_m: [[0.0; TILE]; TILE],
            median_m: [[-1.0; TILE]; TILE],
            weights: [[[0.0; TILE]; TILE]; RENDER_IDS],
            used: 0,
        })
    }

    /// Blends the splats that `list` names, near to far, over the tile whose first pixel is
    /// `origin_px` and of which `size` pixels lie inside the image, and resolves its rows.
    /// Runs with the widest vectors this computer has; each lane computes the same on all of them.
    pub fn draw(
        &mut self,
        splats: &[SplatPixels],
        list: &[u32],
        origin_px: [usize; 2],
        size: [usize; 2],
        limits: BlendThresholds,
    ) -> [Resolved; TILE] {
        struct Draw<'a>(
            &'a mut Tile,
            &'a [SplatPixels],
            &'a [u32],
            [usize; 2],
            [usize; 2],
            BlendThresholds,
        );
        impl pulp::WithSimd for Draw<'_> {
            type Output = [Resolved; TILE];
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
                let Draw(tile, splats, list, origin_px, size, limits) = self;
                tile.reset(size);
                tile.blend(splats, list, origin_px, size, limits);
                std::array::from_fn(
                    #[inline(always)]
                    |row| tile.resolve(row),
                )
            }
        }
        pulp::Arch::new().dispatch(Draw(self, splats, list, origin_px, size, limits))
    }

    /// Full light on the pixels inside the image, none on the others, which then take nothing.
    #[inline(always)]
    fn reset(&mut self, [columns, rows]: [usize; 2]) {
        self.transmittance = [[0.0; TILE]; TILE];
        for row in self.transmittance.iter_mut().take(rows) {
            row[..columns.min(TILE)].fill(1.0);
        }
        self.expected_m = [[0.0; TILE]; TILE];
        self.median_m = [[-1.0; TILE]; TILE];
        self.used = 0;
    }

    #[inline(always)]
    fn blend(
        &mut self,
        splats: &[SplatPixels],
        list: &[u32],
        origin_px: [usize; 2],
        size: [usize; 2],
        limits: BlendThresholds,
    ) {
        // Rows in which every pixel has had its light are skipped; a look every few splats is enough.
        const LOOK: u32 = 8;
        let mut live = [true; TILE];
        let mut until_look = LOOK;
        for &index in list {
            let (splat, bounds) = &splats[index as usize];
            let weights = &mut self.weights[usize::from(splat.id) % RENDER_IDS];
            if self.used & 1 << splat.id == 0 {
                self.used |= 1 << splat.id;
                *weights = [[0.0; TILE]; TILE];
            }
            let dx0 = origin_px[0] as f32 + 0.5 - splat.mean_px[0];
            let first = usize::from(bounds[1][0]).saturating_sub(origin_px[1]);
            let end = usize::from(bounds[1][1])
                .saturating_sub(origin_px[1])
                .min(size[1]);
            for row in first..end {
                let dy = (origin_px[1] + row) as f32 + 0.5 - splat.mean_px[1];
                let from_y = splat.across * dy * dy;
                // The slack leaves the decision at the threshold itself to alpha.
                if !live[row] || from_y < splat.min_exponent - 1e-3 {
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
                    &mut weights[row],
                );
            }
            until_look -= 1;
            if until_look == 0 {
                until_look = LOOK;
                let mut any = false;
                for (live, row) in live.iter_mut().zip(&self.transmittance) {
                    let lit = row.iter().fold(0, |n, &t| n + u32::from(t >= limits.t_stop));
                    *live = lit > 0;
                    any |= lit > 0;
                }
                if !any {
                    return;
                }
            }
        }
    }

    #[inline(always)]
    fn resolve(&self, row: usize) -> Resolved {
        let mut out = Resolved {
            expected_m: self.expected_m[row],
            median_m: self.median_m[row],
            transmittance: self.transmittance[row],
            ..NOTHING
        };
        let (mut top, mut second, mut best) = ([0.0f32; TILE], [0.0f32; TILE], [-1i32; TILE]);
        for id in (0..RENDER_IDS).filter(|id| self.used >> id & 1 == 1) {
            let weights = &self.weights[id][row];
            for i in 0..TILE {
                let w = weights[i];
                out.coverage[i] += w;
                // Strictly more, so that the lowest id keeps a tie.
                let more = w > top[i];
                second[i] = if more { top[i] } else { second[i].max(w) };
                best[i] = if more { id as i32 } else { best[i] };
                top[i] = if more { w } else { top[i] };
            }
        }
        for i in 0..TILE {
            out.label[i] = best[i] as i16;
            out.margin[i] = top[i] - second[i];
        }
        out
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
    limits: BlendThresholds,
    transmittance: &mut TileRow,
    expected_m: &mut TileRow,
    median_m: &mut TileRow,
    weight: &mut TileRow,
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
pub(crate) fn exp(x: f32) -> f32 {
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
    #[cfg(target_arch = "x86_64")]
    fn loops_have_vectors_on_every_machine_that_has_any() {
        let arch = format!("{:?}", pulp::Arch::new());
        let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        println!("{arch}");
        // Before, what has AVX2 but no AVX-512 computed four numbers at a time.
        assert_eq!(arch == "Scalar", !has_avx2);
    }

    /// Weights of one pixel, set by hand, and what they resolve to.
    #[test]
    fn row_42_ties_go_to_the_lowest() {
        let of = |w: &[(usize, f32)]| {
            let mut tile = Tile::new();
            tile.reset([TILE, TILE]);
            for &(id, w) in w {
                tile.used |= 1 << id;
                tile.weights[id][3][5] = w;
            }
            let row = tile.resolve(3);
            assert_eq!([row.label[4], row.label[6]], [-1, -1]);
            (row.label[5], row.margin[5], row.coverage[5])
        };
        assert_eq!(of(&[(1, 0.25), (2, 0.5), (3, 0.5)]), (2, 0.0, 1.25));
        assert_eq!(of(&[(3, 0.5), (2, 0.5)]), (2, 0.0, 1.0));
        assert_eq!(of(&[(0, 0.5), (19, 0.5)]), (0, 0.0, 1.0));
        assert_eq!(of(&[(5, 0.25), (7, 0.75), (9, 0.5)]), (7, 0.25, 1.5));
        assert_eq!(of(&[(4, 0.0)]), (-1, 0.0, 0.0));
        assert_eq!(of(&[]), (-1, 0.0, 0.0));
    }
}
