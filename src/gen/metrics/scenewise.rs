//! Distances between sets of scenes by features of small windows. Windows of one scene are alike, so the scene is the
//! unit: kernels are never taken within a scene, and intervals come from leaving scenes out (jackknife).

use rayon::prelude::*;
use serde::Serialize;

use super::MetricError;
use super::frechet::{check, frechet_distance};
use super::kernel::Kernel;
use super::local::Windows;

/// Groups of scenes that are left out in turn for the interval of the Fréchet distance.
const GROUPS: usize = 6;
/// Deviation below which a feature counts as constant.
const LEAST_SPREAD: f64 = 1e-10;

/// A distance and half of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distance {
    /// Distance over all scenes.
    pub mean: f64,
    /// Half of its 95 % interval, from a jackknife over scenes.
    pub ci95: f64,
}

/// Half of a 95 % interval from the values when each of some groups is left out.
fn jackknife(left: &[f64]) -> f64 {
    let n = left.len() as f64;
    let mean = left.iter().sum::<f64>() / n;
    let spread: f64 = left.iter().map(|v| (v - mean).powi(2)).sum();
    1.96 * (spread * (n - 1.0) / n).sqrt()
}

/// Takes equally many scenes of each set, at least two. Checks that windows are finite and of equal length.
fn scenes<'a>(x: &'a [Windows], y: &'a [Windows]) -> Result<[&'a [Windows]; 2], MetricError> {
    let n = x.len().min(y.len());
    let (x, y) = (&x[..n], &y[..n]);
    let expected = check(&x.concat(), "x")?;
    let found = check(&y.concat(), "y")?;
    if n < 2 || x.iter().chain(y).any(Vec::is_empty) {
        return Err(MetricError::TooFew { which: "x", found: n });
    }
    if found != expected {
        return Err(MetricError::Width { found, expected });
    }
    Ok([x, y])
}

/// The two sets, shifted and scaled so that the first has mean 0 and spread 1 in every feature and each feature counts
/// the same.
pub fn standardised(x: &[Windows], y: &[Windows]) -> Result<[Vec<Windows>; 2], MetricError> {
    let [x, y] = scenes(x, y)?;
    let rows: Vec<&Vec<f64>> = x.iter().flatten().collect();
    let n = rows.len() as f64;
    let scale: Vec<(f64, f64)> = (0..rows[0].len())
        .map(|f| {
            let mean = rows.iter().map(|r| r[f]).sum::<f64>() / n;
            let variance = rows.iter().map(|r| (r[f] - mean).powi(2)).sum::<f64>() / n;
            (mean, 1.0 / variance.sqrt().max(LEAST_SPREAD))
        })
        .collect();
    let set = |set: &[Windows]| -> Vec<Windows> {
        let row = |r: &Vec<f64>| {
            let each = r.iter().zip(&scale);
            each.map(|(v, (mean, scale))| ((v - mean) * scale).clamp(-10.0, 10.0))
                .collect()
        };
        set.iter().map(|w| w.iter().map(row).collect()).collect()
    };
    Ok([set(x), set(y)])
}

/// Fréchet distance of the windows of the two sets; takes as many scenes of each as the smaller set has.
pub fn frechet(x: &[Windows], y: &[Windows]) -> Result<Distance, MetricError> {
    let [x, y] = scenes(x, y)?;
    let groups = GROUPS.min(x.len());
    let of = |left_out: Option<usize>| {
        let kept = |set: &[Windows]| -> Windows {
            let scenes = set.iter().enumerate();
            let kept = scenes.filter(|(i, _)| Some(i % groups) != left_out);
            kept.flat_map(|(_, w)| w.iter().cloned()).collect()
        };
        frechet_distance(&kept(x), &kept(y))
    };
    let all: Result<Vec<f64>, MetricError> = (0..=groups)
        .into_par_iter()
        .map(|g| of((g < groups).then_some(g)))
        .collect();
    let all = all?;
    Ok(Distance {
        mean: all[groups],
        ci95: jackknife(&all[..groups]),
    })
}

/// Squared maximum mean discrepancy with the cubic kernel of KID. Unbiased: two windows of one set are never of one
/// scene.
pub fn kernel(x: &[Windows], y: &[Windows]) -> Result<Distance, MetricError> {
    let [x, y] = scenes(x, y)?;
    let n = x.len();
    let mean = |a: &Windows, b: &Windows| {
        let sums = a
            .iter()
            .map(|a| b.iter().map(|b| Kernel::Cubic.of(a, b)).sum::<f64>());
        sums.sum::<f64>() / (a.len() * b.len()) as f64
    };
    let table = |a: &[Windows], b: &[Windows]| -> Vec<f64> {
        let cells = (0..n * n).into_par_iter();
        cells.map(|i| mean(&a[i / n], &b[i % n])).collect()
    };
    let (xx, yy, xy) = (table(x, x), table(y, y), table(x, y));
    let of = |left_out: Option<usize>| {
        let kept: Vec<usize> = (0..n).filter(|i| Some(*i) != left_out).collect();
        let (mut within, mut between) = (0.0, 0.0);
        for &i in &kept {
            for &j in &kept {
                between += xy[i * n + j];
                within += if i == j {
                    0.0
                } else {
                    xx[i * n + j] + yy[i * n + j]
                };
            }
        }
        let m = kept.len() as f64;
        within / (m * (m - 1.0)) - 2.0 * between / (m * m)
    };
    // With only two scenes none can be left out.
    let left: Vec<f64> = (0..n).filter(|_| n > 2).map(|i| of(Some(i))).collect();
    Ok(Distance {
        mean: of(None),
        ci95: if left.is_empty() {
            f64::INFINITY
        } else {
            jackknife(&left)
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::draw::Draw;

    /// Windows around something of their scene's own; `shift` moves one window in four.
    fn set(seed: u64, scenes: usize, shift: f64) -> Vec<Windows> {
        let mut draw = Draw::new(seed, "windows");
        let mut normal = move || (0..12).map(|_| draw.unit()).sum::<f64>() - 6.0;
        let scene = |_| {
            let own: Vec<f64> = (0..5).map(|_| normal()).collect();
            let moved = |w: usize| if w.is_multiple_of(4) { shift } else { 0.0 };
            (0..16)
                .map(|w| own.iter().map(|o| o + normal() + moved(w)).collect())
                .collect()
        };
        (0..scenes).map(scene).collect()
    }

    #[test]
    fn equal_sets_are_at_no_distance_and_a_shift_of_few_windows_is_seen() {
        let within = (0..20)
            .filter(|seed| {
                let [x, y] = standardised(&set(*seed, 12, 0.0), &set(50 + seed, 12, 0.0)).expect("sound");
                let found = kernel(&x, &y).expect("sound");
                found.mean.abs() <= 1.5 * found.ci95
            })
            .count();
        assert!(within >= 17, "{within} of 20");
        let [x, y] = standardised(&set(1, 12, 0.0), &set(2, 12, 6.0)).expect("sound");
        let found = kernel(&x, &y).expect("sound");
        assert!(found.mean > 2.0 * found.ci95, "{found:?}");
        let [_, same] = standardised(&set(1, 12, 0.0), &set(2, 12, 0.0)).expect("sound");
        let (near, far) = (
            frechet(&x, &same).expect("sound"),
            frechet(&x, &y).expect("sound"),
        );
        assert!(
            far.mean > 2.0 * near.mean && far.mean > far.ci95,
            "{near:?} {far:?}"
        );
        assert!(near.ci95 > 0.0 && near.ci95.is_finite());
    }

    /// A thousand windows of two scenes are two scenes: the interval must not shrink with them.
    #[test]
    fn windows_do_not_stand_for_scenes() {
        let few = set(3, 6, 0.0);
        let many: Vec<Windows> = few
            .iter()
            .map(|w| w.iter().cycle().take(160).cloned().collect())
            .collect();
        let other = set(4, 6, 0.0);
        let [one, ten] = [&few, &many].map(|x| kernel(x, &other).expect("sound"));
        assert!(
            (one.mean - ten.mean).abs() < 1e-9 && (one.ci95 - ten.ci95).abs() < 1e-9,
            "{one:?} {ten:?}"
        );
        assert!(kernel(&few[..1], &other).is_err());
        assert!(frechet(&few, &vec![vec![vec![1.0]; 3]; 6]).is_err());
    }
}
