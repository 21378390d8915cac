//! Rows 54 and 56 beyond the reference files: the Fréchet distance by another route, and distances of equal sets.

use metrics::frechet::frechet_distance;
use metrics::kernel::{Kernel, mmd2};
use nalgebra::{DMatrix, SymmetricEigen};
use numeric::philox::{Stream, normal_field};

fn sample(seed: u64, n: usize, d: usize) -> Vec<Vec<f64>> {
    let flat = normal_field(seed, Stream::Start, n, d);
    flat.chunks_exact(d).map(<[f64]>::to_vec).collect()
}

fn covariance(s: &[Vec<f64>]) -> (Vec<f64>, DMatrix<f64>) {
    let (n, d) = (s.len(), s[0].len());
    let mean: Vec<f64> = (0..d)
        .map(|c| s.iter().map(|r| r[c]).sum::<f64>() / n as f64)
        .collect();
    let centred = DMatrix::from_fn(n, d, |r, c| s[r][c] - mean[c]);
    (mean, centred.transpose() * &centred / (n - 1) as f64)
}

fn root(m: &DMatrix<f64>) -> DMatrix<f64> {
    let e = SymmetricEigen::new(m.clone());
    let values = e.eigenvalues.map(|v| v.max(0.0).sqrt());
    &e.eigenvectors * DMatrix::from_diagonal(&values) * e.eigenvectors.transpose()
}

/// |m - n|^2 + tr A + tr B - 2 tr sqrt(sqrt(A) B sqrt(A)) by symmetric eigenvalues; and tr A + tr B.
fn by_eigenvalues(x: &[Vec<f64>], y: &[Vec<f64>]) -> (f64, f64) {
    let ((mx, a), (my, b)) = (covariance(x), covariance(y));
    let half = root(&a);
    let cross = root(&(&half * &b * &half)).trace();
    let shift: f64 = mx.iter().zip(&my).map(|(a, b)| (a - b).powi(2)).sum();
    let traces = a.trace() + b.trace();
    (shift + traces - 2.0 * cross, traces)
}

/// Row 54: fewer samples than dimensions, dead dimensions, scales of 1e6, means of 1e4: as symmetric eigenvalues give it
/// within 1e-6 of the traces; both sets moved together change 1e-9 at most; a set and itself are 1e-9 of its trace apart.
#[test]
fn row_54_frechet() {
    for (n, d, scale, mean, dead) in [
        (50, 6, 1.0, 0.0, false),
        (4, 20, 1.0, 0.0, false),
        (60, 8, 1.0, 0.0, true),
        (60, 8, 1e6, 0.0, true),
        (60, 8, 1.0, 1e4, false),
        (2, 3, 1.0, 0.0, false),
    ] {
        let make = |seed: u64, gain: f64, by: f64| -> Vec<Vec<f64>> {
            let mut s = sample(seed, n, d);
            for row in &mut s {
                for (c, v) in row.iter_mut().enumerate() {
                    *v = (*v * gain * (1.0 + c as f64)) * scale + mean + by * scale;
                    if dead && c == d - 1 {
                        *v = mean;
                    }
                }
            }
            s
        };
        let (x, y) = (make(1, 1.0, 0.0), make(2, 1.7, 0.3));
        let found = frechet_distance(&x, &y).expect("sound");
        let (truth, traces) = by_eigenvalues(&x, &y);
        let name = format!("n {n}, d {d}, scale {scale}, mean {mean}, dead {dead}");
        assert!(
            (found - truth).abs() <= 1e-6 * traces,
            "{name}: {found}, expected {truth}"
        );
        let moved = |s: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let row = |r: &Vec<f64>| r.iter().map(|v| v + 17.0 * scale).collect();
            s.iter().map(row).collect()
        };
        let shifted = frechet_distance(&moved(&x), &moved(&y)).expect("sound");
        assert!(
            (shifted - found).abs() <= 1e-9 * traces,
            "{name}: moved {shifted}, {found}"
        );
        let itself = frechet_distance(&x, &x).expect("sound");
        let (_, twice) = by_eigenvalues(&x, &x);
        assert!(itself <= 1e-9 * twice / 2.0, "{name}: to itself {itself:e}");
    }
}

/// Row 56: sets of one distribution are 0 within three standard errors over many draws, signed, never forced above 0; two
/// samples are enough, one is an error; duplicates and a bandwidth of 0 divide by nothing.
#[test]
fn row_56_kernels() {
    for kernel in [Kernel::Cubic, Kernel::Gaussian { bandwidth: 1.0 }] {
        let values: Vec<f64> = (0..40)
            .map(|i| mmd2(kernel, &sample(2 * i, 50, 4), &sample(2 * i + 1, 50, 4)).expect("sound"))
            .collect();
        let mean = values.iter().sum::<f64>() / 40.0;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 39.0;
        let error = (variance / 40.0).sqrt();
        assert!(mean.abs() <= 3.0 * error, "{kernel:?}: {mean} +- {error}");
        assert!(values.iter().any(|v| *v < 0.0), "forced above 0");
    }
    let two = sample(1, 2, 3);
    for kernel in [
        Kernel::Cubic,
        Kernel::Gaussian { bandwidth: 0.0 },
        Kernel::median_gaussian(&two, &two),
    ] {
        assert!(mmd2(kernel, &two, &two).expect("two").is_finite());
        let same = vec![vec![1.0; 3]; 4];
        assert!(mmd2(kernel, &same, &same).expect("four").abs() <= 1e-9);
        assert!(mmd2(kernel, &two[..1], &two).is_err());
    }
}
