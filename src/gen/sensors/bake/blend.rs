//! Blends coloured splats front to back into one tile of a picture, and goes backwards through the same sum for the
//! gradient with each splat.

use crate::splat::tile::{BlendThresholds, Splat, SplatPixels, TILE, exp};

type BlendRow = [f32; TILE];

/// First pixel of a tile, and how many of its pixels lie inside the picture.
type TileBounds = ([usize; 2], [usize; 2]);

/// Light of a tile's pixels, `[row][column]`.
pub(super) struct Light {
    transmittance: [BlendRow; TILE],
    color: [[BlendRow; 3]; TILE],
}

/// Values of a tile's pixels in three channels; 0 outside the picture.
pub(super) struct Sums {
    values: [[BlendRow; 3]; TILE],
}

impl Sums {
    pub fn new() -> Self {
        Self {
            values: [[[0.0; TILE]; 3]; TILE],
        }
    }

    pub fn set_row(&mut self, row: usize, values: &[[f32; 3]]) {
        for (i, v) in values.iter().enumerate().take(TILE) {
            for (out, value) in self.values[row].iter_mut().zip(v) {
                out[i] = *value;
            }
        }
    }
}

/// Gradient of a sum over a picture with a splat: with its three colours, then sums over its pixels of p u u, p u dy, p
/// dy dy, p u, p dy and p. Here p is the derivative with the exponent at a pixel, u the sheared x and dy the y from the
/// splat's middle.
pub(super) type Slopes = [f32; 9];

/// Rows are checked every few splats: rows in which every pixel has had its light are skipped.
const LOOK: u32 = 8;

impl Light {
    pub fn new() -> Box<Light> {
        Box::new(Light {
            transmittance: [[0.0; TILE]; TILE],
            color: [[[0.0; TILE]; 3]; TILE],
        })
    }

    /// Colour of a pixel after [`Self::blend`].
    pub fn pixel(&self, row: usize, column: usize) -> [f32; 3] {
        [0, 1, 2].map(|channel| self.color[row][channel][column])
    }

    /// Blends the splats that `list` names, near to far; `colors` are theirs.
    pub fn blend(
        &mut self,
        splats: &[SplatPixels],
        colors: &[[f32; 3]],
        list: &[u32],
        place: TileBounds,
        limits: BlendThresholds,
    ) {
        struct Blend<'a>(
            &'a mut Light,
            &'a [SplatPixels],
            &'a [[f32; 3]],
            &'a [u32],
            TileBounds,
            BlendThresholds,
        );
        impl pulp::WithSimd for Blend<'_> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) {
                let Blend(light, splats, colors, list, place, limits) = self;
                light.color = [[[0.0; TILE]; 3]; TILE];
                light.walk(
                    (splats, list),
                    place,
                    limits,
                    #[inline(always)]
                    |at, transmittance, color| {
                        let (index, weights) = (at.index, weigh(&at, limits, transmittance));
                        for (channel, out) in color.iter_mut().enumerate() {
                            let value = colors[index][channel];
                            for i in 0..TILE {
                                out[i] += weights[i] * value;
                            }
                        }
                    },
                    #[inline(always)]
                    |_| {},
                );
            }
        }
        pulp::Arch::new().dispatch(Blend(self, splats, colors, list, place, limits));
    }

    /// Adds for each splat of the list, to `sums` at its place in `of`, weight times the tile's values and weight squared.
    pub fn gather(
        &mut self,
        splats: &[SplatPixels],
        (list, of): (&[u32], &[u32]),
        place: TileBounds,
        limits: BlendThresholds,
        tile: &Sums,
        sums: &mut [[f32; 4]],
    ) {
        struct Gather<'a>(
            &'a mut Light,
            &'a [SplatPixels],
            (&'a [u32], &'a [u32]),
            TileBounds,
            BlendThresholds,
            &'a Sums,
            &'a mut [[f32; 4]],
        );
        impl pulp::WithSimd for Gather<'_> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) {
                let Gather(light, splats, (list, of), place, limits, tile, sums) = self;
                // Sums of the splat at hand, lane by lane.
                let mut lanes = [[0.0f32; TILE]; 4];
                let cell = std::cell::Cell::from_mut(&mut lanes);
                light.walk(
                    (splats, list),
                    place,
                    limits,
                    #[inline(always)]
                    |at, transmittance, _| {
                        let weights = weigh(&at, limits, transmittance);
                        let mut lanes = cell.get();
                        for (lane, values) in lanes.iter_mut().zip(&tile.values[at.row]) {
                            for i in 0..TILE {
                                lane[i] += weights[i] * values[i];
                            }
                        }
                        for i in 0..TILE {
                            lanes[3][i] += weights[i] * weights[i];
                        }
                        cell.set(lanes);
                    },
                    #[inline(always)]
                    |index| {
                        let lanes = cell.replace([[0.0; TILE]; 4]);
                        let out = &mut sums[of[index] as usize];
                        for channel in 0..4 {
                            out[channel] += lanes[channel].iter().sum::<f32>();
                        }
                    },
                );
            }
        }
        pulp::Arch::new().dispatch(Gather(self, splats, (list, of), place, limits, tile, sums));
    }

    /// For each splat of the list adds to `out`, at its place among the splats, the gradient of a sum over the picture
    /// with it. `lists` are splats, their colours and the list; `slope` is the gradient of that sum with the colours of
    /// pixels, `picture` the colours that [`Self::blend`] gave.
    pub fn backward(
        &mut self,
        lists: (&[SplatPixels], &[[f32; 3]], &[u32]),
        place: TileBounds,
        limits: BlendThresholds,
        (slope, picture): (&Sums, &Sums),
        out: &mut [Slopes],
    ) {
        struct Backward<'a>(
            &'a mut Light,
            (&'a [SplatPixels], &'a [[f32; 3]], &'a [u32]),
            TileBounds,
            BlendThresholds,
            (&'a Sums, &'a Sums),
            &'a mut [Slopes],
        );
        impl pulp::WithSimd for Backward<'_> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) {
                let Backward(light, (splats, colors, list), place, limits, (slope, picture), out) = self;
                light.color = [[[0.0; TILE]; 3]; TILE];
                let mut lanes = [[0.0f32; TILE]; 9];
                let cell = std::cell::Cell::from_mut(&mut lanes);
                light.walk(
                    (splats, list),
                    place,
                    limits,
                    #[inline(always)]
                    |at, transmittance, color| {
                        let mut lanes = cell.get();
                        slope_row(
                            &at,
                            &colors[at.index],
                            limits,
                            (&slope.values[at.row], &picture.values[at.row]),
                            transmittance,
                            color,
                            &mut lanes,
                        );
                        cell.set(lanes);
                    },
                    #[inline(always)]
                    |index| {
                        let lanes = cell.replace([[0.0; TILE]; 9]);
                        for (out, lane) in out[index].iter_mut().zip(lanes) {
                            *out += lane.iter().sum::<f32>();
                        }
                    },
                );
            }
        }
        pulp::Arch::new().dispatch(Backward(self, lists, place, limits, (slope, picture), out));
    }

    /// Walks the splats near to far: `row_of` is called for each row that a splat may touch, with the row's light and colours;
    /// `done` after the last row of each splat.
    #[inline(always)]
    fn walk(
        &mut self,
        (splats, list): (&[SplatPixels], &[u32]),
        (origin_px, size): TileBounds,
        limits: BlendThresholds,
        mut row_of: impl FnMut(At<'_>, &mut BlendRow, &mut [BlendRow; 3]),
        mut done: impl FnMut(usize),
    ) {
        self.transmittance = [[0.0; TILE]; TILE];
        for row in self.transmittance.iter_mut().take(size[1]) {
            row[..size[0].min(TILE)].fill(1.0);
        }
        let mut live = [true; TILE];
        let mut until_look = LOOK;
        for &index in list {
            let index = index as usize;
            let (splat, bounds) = &splats[index];
            let dx0 = origin_px[0] as f32 + 0.5 - splat.mean_px[0];
            let first = usize::from(bounds[1][0]).saturating_sub(origin_px[1]);
            let end = usize::from(bounds[1][1])
                .saturating_sub(origin_px[1])
                .min(size[1]);
            for (row, live) in live.iter().enumerate().take(end).skip(first) {
                let dy = (origin_px[1] + row) as f32 + 0.5 - splat.mean_px[1];
                let from_y = splat.across * dy * dy;
                if !live || from_y < splat.min_exponent - 1e-3 {
                    continue;
                }
                let at = At {
                    splat,
                    index,
                    row,
                    u: dx0 - splat.shear * dy,
                    dy,
                    from_y,
                };
                row_of(at, &mut self.transmittance[row], &mut self.color[row]);
            }
            done(index);
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
}

/// A splat on a row of pixels.
struct At<'a> {
    splat: &'a Splat,
    /// Its place in the list of splats.
    index: usize,
    row: usize,
    /// Sheared x of the first pixel from the splat's middle, and y of all, px.
    u: f32,
    dy: f32,
    /// Contribution of y to the exponent.
    from_y: f32,
}

/// Weights of a splat over a row of pixels; takes the splat's light from `transmittance`.
#[inline(always)]
fn weigh(at: &At<'_>, limits: BlendThresholds, transmittance: &mut BlendRow) -> BlendRow {
    let mut weights = [0.0; TILE];
    for i in 0..TILE {
        let u = at.u + i as f32;
        let exponent = at.splat.along * u * u + at.from_y;
        let alpha = (at.splat.opacity * exp(exponent)).min(limits.alpha_max);
        let t = transmittance[i];
        let seen = (alpha >= limits.alpha_min) & (t >= limits.t_stop);
        let w = if seen { alpha * t } else { 0.0 };
        transmittance[i] = t - w;
        weights[i] = w;
    }
    weights
}

/// One row of [`Light::backward`].
#[inline(always)]
fn slope_row(
    at: &At<'_>,
    own: &[f32; 3],
    limits: BlendThresholds,
    (slope, picture): (&[BlendRow; 3], &[BlendRow; 3]),
    transmittance: &mut BlendRow,
    color: &mut [BlendRow; 3],
    lanes: &mut [BlendRow; 9],
) {
    for i in 0..TILE {
        let u = at.u + i as f32;
        let exponent = at.splat.along * u * u + at.from_y;
        let raw = at.splat.opacity * exp(exponent);
        let alpha = raw.min(limits.alpha_max);
        let t = transmittance[i];
        let seen = (alpha >= limits.alpha_min) & (t >= limits.t_stop);
        let w = if seen { alpha * t } else { 0.0 };
        transmittance[i] = t - w;
        let behind = 1.0 / (1.0 - alpha);
        let mut p = 0.0;
        for channel in 0..3 {
            let front = color[channel][i] + w * own[channel];
            color[channel][i] = front;
            let g = slope[channel][i];
            lanes[channel][i] += w * g;
            // The more opaque the splat, the less is seen of the light behind it.
            p += g * (t * own[channel] - (picture[channel][i] - front) * behind);
        }
        let p = if seen & (raw < limits.alpha_max) {
            p * alpha
        } else {
            0.0
        };
        lanes[3][i] += p * u * u;
        lanes[4][i] += p * u * at.dy;
        lanes[5][i] += p * at.dy * at.dy;
        lanes[6][i] += p * u;
        lanes[7][i] += p * at.dy;
        lanes[8][i] += p;
    }
}
