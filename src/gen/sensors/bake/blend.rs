//! Blends coloured splats front to back into one tile of a picture, and the same backwards: what each splat had of it.

use crate::tile::{Limits, Splat, SplatPixels, TILE, exp};

type Row = [f32; TILE];

/// A row is gone through in two halves: most splats are narrower than one, and touch one alone.
const HALF: usize = TILE / 2;

/// First pixel of a tile, and how many of its pixels lie inside the picture.
type Place = ([usize; 2], [usize; 2]);

/// Light of a tile's pixels, `[row][column]`.
pub(super) struct Light {
    transmittance: [Row; TILE],
    color: [[Row; 3]; TILE],
}

/// Values of a tile's pixels in three channels; 0 outside the picture.
pub(super) struct Sums {
    values: [[Row; 3]; TILE],
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

/// How a sum over a picture changes with a splat: with its three colours; then sums over its pixels of p u u, p u dy, p dy dy,
/// p u, p dy and p, where p is how the sum changes with the exponent there, u the sheared x and dy the y from its middle.
pub(super) type Slopes = [f32; 9];

/// Rows are looked at every few splats: those in which every pixel has had its light are skipped.
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
        place: Place,
        limits: Limits,
    ) {
        struct Blend<'a>(
            &'a mut Light,
            &'a [SplatPixels],
            &'a [[f32; 3]],
            &'a [u32],
            Place,
            Limits,
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
                    &mut (),
                    #[inline(always)]
                    |(), at, transmittance, color| {
                        for half in 0..2 {
                            if !at.touches(half) {
                                continue;
                            }
                            let weights = weigh(&at, half, limits, transmittance);
                            for (channel, out) in color.iter_mut().enumerate() {
                                let (out, value) = (half_mut(out, half), colors[at.index][channel]);
                                for i in 0..HALF {
                                    out[i] += weights[i] * value;
                                }
                            }
                        }
                    },
                    #[inline(always)]
                    |(), _| {},
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
        place: Place,
        limits: Limits,
        tile: &Sums,
        sums: &mut [[f32; 4]],
    ) {
        struct Gather<'a>(
            &'a mut Light,
            &'a [SplatPixels],
            (&'a [u32], &'a [u32]),
            Place,
            Limits,
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
                light.walk(
                    (splats, list),
                    place,
                    limits,
                    &mut lanes,
                    #[inline(always)]
                    |lanes, at, transmittance, _| {
                        for half in 0..2 {
                            if !at.touches(half) {
                                continue;
                            }
                            let weights = weigh(&at, half, limits, transmittance);
                            for (lane, values) in lanes.iter_mut().zip(&tile.values[at.row]) {
                                let (lane, values) = (half_mut(lane, half), half_of(values, half));
                                for i in 0..HALF {
                                    lane[i] += weights[i] * values[i];
                                }
                            }
                            let lane = half_mut(&mut lanes[3], half);
                            for i in 0..HALF {
                                lane[i] += weights[i] * weights[i];
                            }
                        }
                    },
                    #[inline(always)]
                    |lanes, index| {
                        let lanes = std::mem::replace(lanes, [[0.0; TILE]; 4]);
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

    /// For each splat of the list adds to `out`, at its place among the splats, how a sum over the picture changes with it.
    /// `lists` are splats, their colours and the list; `slope` is how that sum changes with the colours of pixels, `picture` the
    /// colours that [`Self::blend`] gave.
    pub fn backward(
        &mut self,
        lists: (&[SplatPixels], &[[f32; 3]], &[u32]),
        place: Place,
        limits: Limits,
        (slope, picture): (&Sums, &Sums),
        out: &mut [Slopes],
    ) {
        struct Backward<'a>(
            &'a mut Light,
            (&'a [SplatPixels], &'a [[f32; 3]], &'a [u32]),
            Place,
            Limits,
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
                light.walk(
                    (splats, list),
                    place,
                    limits,
                    &mut lanes,
                    #[inline(always)]
                    |lanes, at, transmittance, color| {
                        let sides = (&slope.values[at.row], &picture.values[at.row]);
                        let own = &colors[at.index];
                        for half in 0..2 {
                            if at.touches(half) {
                                slope_half((&at, half), own, limits, sides, (transmittance, color), lanes);
                            }
                        }
                    },
                    #[inline(always)]
                    |lanes, index| {
                        let lanes = std::mem::replace(lanes, [[0.0; TILE]; 9]);
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
    /// `done` after the last row of each splat that touches any. Both are given `sums`.
    #[inline(always)]
    fn walk<T>(
        &mut self,
        (splats, list): (&[SplatPixels], &[u32]),
        (origin_px, size): Place,
        limits: Limits,
        sums: &mut T,
        mut row_of: impl FnMut(&mut T, At<'_>, &mut Row, &mut [Row; 3]),
        mut done: impl FnMut(&mut T, usize),
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
            let mut touched = false;
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
                touched = true;
                row_of(sums, at, &mut self.transmittance[row], &mut self.color[row]);
            }
            if touched {
                done(sums, index);
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
    /// What y adds to the exponent.
    from_y: f32,
}

impl At<'_> {
    /// True unless the splat is too faint to be seen in all of a half of the row.
    #[inline(always)]
    fn touches(&self, half: usize) -> bool {
        let [first, last] = [0, HALF - 1].map(|i| self.u + (half * HALF + i) as f32);
        let nearest = match first < 0.0 && last > 0.0 {
            true => 0.0,
            false => first.abs().min(last.abs()),
        };
        let most = self.splat.along * nearest * nearest + self.from_y;
        // The slack leaves the decision at the threshold itself to alpha.
        most >= self.splat.min_exponent - 1e-3
    }
}

/// A half of a row.
#[inline(always)]
fn half_of(row: &Row, half: usize) -> &[f32; HALF] {
    &row.as_chunks().0[half]
}

#[inline(always)]
fn half_mut(row: &mut Row, half: usize) -> &mut [f32; HALF] {
    &mut row.as_chunks_mut().0[half]
}
/// Weights of a splat over a half of a row of pixels, whose light it takes.
#[inline(always)]
fn weigh(at: &At<'_>, half: usize, limits: Limits, transmittance: &mut Row) -> [f32; HALF] {
    let transmittance = half_mut(transmittance, half);
    let mut weights = [0.0; HALF];
    for i in 0..HALF {
        let u = at.u + (half * HALF + i) as f32;
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

/// A half of a row of [`Light::backward`].
#[inline(always)]
fn slope_half(
    (at, half): (&At<'_>, usize),
    own: &[f32; 3],
    limits: Limits,
    (slope, picture): (&[Row; 3], &[Row; 3]),
    (transmittance, color): (&mut Row, &mut [Row; 3]),
    lanes: &mut [Row; 9],
) {
    let transmittance = half_mut(transmittance, half);
    let color = color.each_mut().map(|row| half_mut(row, half));
    let lanes = lanes.each_mut().map(|row| half_mut(row, half));
    let (slope, picture) = (
        slope.each_ref().map(|row| half_of(row, half)),
        picture.each_ref().map(|row| half_of(row, half)),
    );
    for i in 0..HALF {
        let u = at.u + (half * HALF + i) as f32;
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
            // What is seen behind this splat would be seen the less, the more there is of it.
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

#[cfg(test)]
mod tests {
    use super::*;
    use world::draw::Draw;

    #[test]
    fn what_is_left_out_of_a_row_would_not_be_seen() {
        let mut draw = Draw::new(7, "splats");
        let mut between = |from: f64, to: f64| draw.range(from, to) as f32;
        let alpha_min = 1.0 / 255.0f32;
        let (mut left_out, mut seen) = (0, 0);
        for _ in 0..20_000 {
            let opacity = between(0.01, 0.99);
            let splat = Splat {
                mean_px: [0.0; 2],
                along: -between(0.001, 2.0),
                shear: 0.0,
                across: -between(0.001, 2.0),
                opacity,
                min_exponent: (alpha_min / opacity).ln(),
                depth_m: 1.0,
                id: 0,
            };
            let dy = between(-4.0, 4.0);
            let at = At {
                splat: &splat,
                index: 0,
                row: 0,
                u: between(-24.0, 8.0),
                dy,
                from_y: splat.across * dy * dy,
            };
            for half in 0..2 {
                let alpha = |i: usize| {
                    let u = at.u + (half * HALF + i) as f32;
                    splat.opacity * exp(splat.along * u * u + at.from_y)
                };
                let is_seen = (0..HALF).any(|i| alpha(i) >= alpha_min);
                assert!(at.touches(half) || !is_seen, "{splat:?} at {}, {dy}", at.u);
                seen += usize::from(is_seen);
                left_out += usize::from(!at.touches(half));
            }
        }
        assert!(left_out > 10_000 && seen > 5_000, "{left_out} {seen}");
    }
}
