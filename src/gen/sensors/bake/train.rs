//! Fits places, shapes and opacities of Gaussians, and their colours, to the pictures that were taken: gradient descent on squared
//! differences, the gradients those of Kerbl et al. 2023 (arXiv 2308.04079, appendix A), steps by Adam.

use glam::{DVec3, Quat, Vec3};
use rayon::prelude::*;

use super::blend::Slopes;
use super::draw::{Ellipsoid, OPTIONS, Projected};
use super::samples::CapturedPicture;
use crate::splat::project::SplatCamera;
use scene::SceneGaussian;

/// Views of one step.
const BATCH: usize = 4;
/// Numbers of a Gaussian: place, logarithms of spreads, turn about the axes of the frame, logit of the opacity, colour.
const NUMBERS: usize = 13;

/// Steps at the start, which shrink to a twentieth: of the place, in spreads of the Gaussian; of the logarithms of spreads; of the
/// turn, rad; of the logit of the opacity; of the colour.
const PLACE_RATE: f32 = 0.1;
const SPREAD_RATE: f32 = 0.04;
const TURN_RATE: f32 = 0.03;
const OPACITY_RATE: f32 = 0.2;
const COLOR_RATE: f32 = 0.01;
/// Spreads stay between these shares of what they were, and above this, m.
const SPREADS: [f32; 2] = [0.2, 2.0];
const THIN_M: f32 = 0.002;

/// Share of the moments of gradients that a step keeps.
const FIRST: f32 = 0.9;
const SECOND: f32 = 0.99;

type Gradient = [f32; NUMBERS];

/// First and second moments of gradients.
#[derive(Clone, Copy, Default)]
struct Moments {
    first: Gradient,
    second: Gradient,
    steps: u32,
}

/// Fits in `steps` steps of a few views each, which follow one another in a fixed order. Stops early once it was cancelled.
pub(super) fn fit(
    gaussians: &mut [SceneGaussian],
    taken: &[CapturedPicture],
    size: [u32; 2],
    steps: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) {
    if gaussians.is_empty() || taken.is_empty() {
        return;
    }
    let mut ellipsoids: Vec<Ellipsoid> = gaussians.par_iter().map(Ellipsoid::from_gaussian).collect();
    let mut colors: Vec<[f32; 3]> = gaussians.iter().map(|g| g.color).collect();
    let start: Vec<[f32; 3]> = gaussians.iter().map(|g| g.std_m).collect();
    let mut moments = vec![Moments::default(); gaussians.len()];
    let mut order = ViewOrder::new(taken.len());
    for step in 0..steps {
        if cancelled() {
            return;
        }
        let batch: Vec<usize> = (0..BATCH).map(|_| order.next()).collect();
        let of_view = |view: &usize| gradients(&ellipsoids, &colors, &taken[*view], size);
        let parts: Vec<Vec<(u32, Gradient)>> = batch.par_iter().map(of_view).collect();
        // One view after the other, so that sums are the same on any number of threads.
        let mut sums: Vec<(u32, Gradient)> = parts.concat();
        sums.par_sort_by_key(|(i, _)| *i);
        let sums: Vec<(u32, Gradient)> = sums
            .chunk_by(|a, b| a.0 == b.0)
            .map(|same| {
                let mut sum = [0.0; NUMBERS];
                for (_, g) in same {
                    for (s, v) in sum.iter_mut().zip(g) {
                        *s += v;
                    }
                }
                (same[0].0, sum)
            })
            .collect();
        let t = step as f32 / steps as f32;
        let rate = (1.0 - t).max(0.05);
        for (i, gradient) in &sums {
            let i = *i as usize;
            moments[i].step(gradient);
            change(&mut gaussians[i], &moments[i], &start[i], rate);
            ellipsoids[i] = Ellipsoid::from_gaussian(&gaussians[i]);
            colors[i] = gaussians[i].color;
        }
    }
}

/// Views in an order that brings each once before any comes again, neighbours far apart.
struct ViewOrder {
    count: usize,
    stride: usize,
    at: usize,
}

impl ViewOrder {
    fn new(count: usize) -> Self {
        let divides = |a: usize| (2..=a).any(|d| a.is_multiple_of(d) && count.is_multiple_of(d));
        let wanted = (count as f64 * 0.618) as usize;
        let stride = (wanted.max(1)..).find(|s| !divides(*s)).unwrap_or(1);
        Self { count, stride, at: 0 }
    }

    fn next(&mut self) -> usize {
        self.at = (self.at + self.stride) % self.count;
        self.at
    }
}

/// Gradient of the squared difference to a picture with each Gaussian in it.
fn gradients(
    ellipsoids: &[Ellipsoid],
    colors: &[[f32; 3]],
    taken: &CapturedPicture,
    size: [u32; 2],
) -> Vec<(u32, Gradient)> {
    let projected = Projected::new(ellipsoids, &taken.camera, size);
    let picture = projected.picture(colors);
    let slope: Vec<[f32; 3]> = picture
        .iter()
        .zip(&taken.rgb)
        .map(|(p, rgb)| [0, 1, 2].map(|c| p[c] - f32::from(rgb[c]) / 255.0))
        .collect();
    let slopes = projected.backward(colors, &picture, &slope);
    let view = SplatCamera::new(&taken.camera, size[0], size[1], OPTIONS.jacobian_clamp);
    let splats = projected.of.iter().zip(&slopes);
    splats
        .filter(|(_, slopes)| slopes.iter().any(|s| *s != 0.0))
        .filter_map(|(i, slopes)| Some((*i, chain(&view, &ellipsoids[*i as usize], slopes)?)))
        .collect()
}

/// Converts the gradient with a splat in the picture to that with the Gaussian itself. The change of the projection's
/// derivative with the place is left out: Gaussians are small.
fn chain(view: &SplatCamera, e: &Ellipsoid, s: &Slopes) -> Option<Gradient> {
    let around = view.around(e.position_m.as_dvec3(), [OPTIONS.near_m, OPTIONS.far_m])?;
    let axes = e.axes_m.map(|a| a.as_dvec3());
    let [xx, b, yy] = around.footprint(axes)?.covariance_px2;
    let (a, c) = (xx + OPTIONS.low_pass_px2, yy + OPTIONS.low_pass_px2);
    let det = (a * c - b * b).max(1e-12);
    let [r, g, bl, puu, puy, pyy, pu, py, p] = *s;
    let [puu, puy, pyy, pu, py] = [puu, puy, pyy, pu, py].map(f64::from);
    // Exponent = along u^2 + across dy^2 with u = dx - shear dy, along = -c / 2 det, shear = b / c, across = -1 / 2 c.
    let (along, shear, across) = (-0.5 * c / det, b / c, -0.5 / c);
    let of_shear = -2.0 * along * puy;
    let of_mean = [-2.0 * along * pu, 2.0 * along * shear * pu - 2.0 * across * py];
    let of_a = puu * 0.5 * c * c / (det * det);
    let of_b = -puu * b * c / (det * det) + of_shear / c;
    let of_c = puu * 0.5 * b * b / (det * det) - of_shear * b / (c * c) + pyy * 0.5 / (c * c);
    let [row_u, row_v] = around.px_per_m;
    let place = row_u * of_mean[0] + row_v * of_mean[1];
    let (mut spreads, mut turn) = ([0.0; 3], DVec3::ZERO);
    for (k, axis) in axes.into_iter().enumerate() {
        let (u, v) = (row_u.dot(axis), row_v.dot(axis));
        let of_axis = row_u * (2.0 * of_a * u + of_b * v) + row_v * (2.0 * of_c * v + of_b * u);
        spreads[k] = axis.dot(of_axis) as f32;
        turn += axis.cross(of_axis);
    }
    let (place, turn) = (place.as_vec3(), turn.as_vec3());
    let logit = p * (1.0 - e.opacity);
    let [sx, sy, sz] = spreads;
    let out = [
        place.x, place.y, place.z, sx, sy, sz, turn.x, turn.y, turn.z, logit, r, g, bl,
    ];
    out.iter().all(|v| v.is_finite()).then_some(out)
}

impl Moments {
    fn step(&mut self, gradient: &Gradient) {
        self.steps += 1;
        for (i, g) in gradient.iter().enumerate() {
            self.first[i] += (g - self.first[i]) * (1.0 - FIRST);
            self.second[i] += (g * g - self.second[i]) * (1.0 - SECOND);
        }
    }

    /// The step of a number, about -1 to 1, against its gradient.
    fn way(&self, i: usize) -> f32 {
        let n = self.steps as i32;
        let first = self.first[i] / (1.0 - FIRST.powi(n));
        let second = self.second[i] / (1.0 - SECOND.powi(n));
        -first / (second.sqrt() + 1e-12)
    }
}

/// One step of a Gaussian.
fn change(g: &mut SceneGaussian, m: &Moments, start: &[f32; 3], rate: f32) {
    let way = |i: usize| Vec3::new(m.way(i), m.way(i + 1), m.way(i + 2));
    // Scaled by the middle one of its spreads.
    let [a, b, c] = g.std_m;
    let size = a.max(b).min(a.max(c)).min(b.max(c));
    let at = Vec3::from(g.position_m) + way(0) * (rate * PLACE_RATE * size);
    g.position_m = at.to_array();
    for (axis, (std_m, start)) in g.std_m.iter_mut().zip(start).enumerate() {
        let changed = *std_m * (m.way(3 + axis) * (rate * SPREAD_RATE)).exp();
        *std_m = changed.clamp(start * SPREADS[0], start * SPREADS[1]).max(THIN_M);
    }
    let turn = way(6) * (rate * TURN_RATE);
    let [w, x, y, z] = g.rotation_wxyz;
    let q = (Quat::from_scaled_axis(turn) * Quat::from_xyzw(x, y, z, w)).normalize();
    g.rotation_wxyz = [q.w, q.x, q.y, q.z];
    let logit = (g.opacity / (1.0 - g.opacity)).ln() + m.way(9) * (rate * OPACITY_RATE);
    g.opacity = (1.0 / (1.0 + (-logit).exp())).clamp(0.02, 0.995);
    for (channel, color) in g.color.iter_mut().enumerate() {
        *color = (*color + m.way(10 + channel) * (rate * COLOR_RATE)).clamp(0.0, 1.0);
    }
}
