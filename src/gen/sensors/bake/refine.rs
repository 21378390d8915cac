//! Fits colours to the pictures that were taken. A picture is linear in the colours of the Gaussians, so the best ones solve a
//! least-squares problem: a few steps of conjugate gradients on its normal equations.

use rayon::prelude::*;

use super::draw::{Ellipsoid, Projected};
use super::samples::CapturedPicture;

/// Views are shared out to as many sums, which are added in order: the result is the same on any number of threads.
const PARTS: usize = 8;
type Colors = Vec<[f32; 3]>;

/// Fits `colors` in `rounds` steps; `keep` is the weight of each colour at the start, in pixels that are all the Gaussian's own.
/// Stops early once it was cancelled.
pub(super) fn fit(
    ellipsoids: &[Ellipsoid],
    taken: &[CapturedPicture],
    size: [u32; 2],
    (colors, keep): (&mut Colors, &[f32]),
    rounds: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) {
    let n = colors.len();
    if n == 0 || rounds == 0 {
        return;
    }
    let pass = |colors: &Colors, is_first: bool| -> Vec<[f32; 4]> {
        let part = |part: usize| {
            let mut sums = vec![[0.0f32; 4]; n];
            for t in taken.iter().skip(part).step_by(PARTS) {
                if cancelled() {
                    break;
                }
                let projected = Projected::new(ellipsoids, &t.camera, size);
                let mut picture = projected.picture(colors);
                if is_first {
                    for (p, rgb) in picture.iter_mut().zip(&t.rgb) {
                        for channel in 0..3 {
                            p[channel] = f32::from(rgb[channel]) / 255.0 - p[channel];
                        }
                    }
                }
                projected.gather(&picture, &mut sums);
            }
            sums
        };
        let parts: Vec<Vec<[f32; 4]>> = (0..PARTS).into_par_iter().map(part).collect();
        let add = |i: usize| {
            let mut sum = [0.0; 4];
            for part in &parts {
                for (s, v) in sum.iter_mut().zip(part[i]) {
                    *s += v;
                }
            }
            sum
        };
        (0..n).into_par_iter().map(add).collect()
    };
    // Preconditioned with the diagonal.
    let first = pass(colors, true);
    let inverse: Vec<f32> = first
        .iter()
        .zip(keep)
        .map(|(s, keep)| 1.0 / (s[3] + keep))
        .collect();
    let mut residual: Colors = first.iter().map(|s| [s[0], s[1], s[2]]).collect();
    let precondition = |r: &Colors| -> Colors {
        let scaled = r.iter().zip(&inverse).map(|(r, s)| r.map(|v| v * s));
        scaled.collect()
    };
    let mut z = precondition(&residual);
    let mut way = z.clone();
    let mut rz = dot(&residual, &z);
    for _ in 0..rounds {
        if cancelled() {
            return;
        }
        let through = pass(&way, false);
        let mut q: Colors = through.iter().map(|s| [s[0], s[1], s[2]]).collect();
        for ((q, w), keep) in q.iter_mut().zip(&way).zip(keep) {
            for channel in 0..3 {
                q[channel] += keep * w[channel];
            }
        }
        let curve = dot(&way, &q);
        let step = [0, 1, 2].map(|c| {
            if curve[c] > 0.0 {
                (rz[c] / curve[c]) as f32
            } else {
                0.0
            }
        });
        for i in 0..n {
            for channel in 0..3 {
                colors[i][channel] += step[channel] * way[i][channel];
                residual[i][channel] -= step[channel] * q[i][channel];
            }
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        let turn = [0, 1, 2].map(|c| {
            if rz[c] > 0.0 {
                (next[c] / rz[c]) as f32
            } else {
                0.0
            }
        });
        rz = next;
        for (w, z) in way.iter_mut().zip(&z) {
            for channel in 0..3 {
                w[channel] = z[channel] + turn[channel] * w[channel];
            }
        }
    }
}

/// Sums of products, channel by channel.
fn dot(a: &Colors, b: &Colors) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (a, b) in a.iter().zip(b) {
        for channel in 0..3 {
            sum[channel] += f64::from(a[channel]) * f64::from(b[channel]);
        }
    }
    sum
}
