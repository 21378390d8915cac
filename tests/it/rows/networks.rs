//! Rows 11 to 14, 16, 17 and 33: the arithmetic below the networks.

use nets::lidar::{drop_probability, neus};
use nn::kernels::{argmax, gelu, likeliest, norm_rows, silu, softmax_rows};
use nn::layers::{Head, MatrixView, matmul};
use nn::packed_matrix::{InitialSum, PackedMatrix};
use nn::weights::{WeightFile, WeightsError};
use safetensors::{Dtype, tensor::TensorView};

fn wave(n: usize, step: f32) -> Vec<f32> {
    (0..n).map(|i| (i as f32 * step).sin()).collect()
}

/// Rows 11 and 12 in the whole head: scores of +-1e4 and +-3e38, equal ones, a single token; and masked rows of a softmax
/// beside others. Every path is finite and equals f64.
#[test]
fn row_11_and_12_attention() {
    for (tokens, size) in [
        (1, 1.0f32),
        (7, 0.0),
        (625, 1.0),
        (625, 1e4),
        (40, 3e37),
        (33, 1e19),
    ] {
        for width in [16, 48, 50] {
            // One key channel carries the score, so that it is q[0] k[0] exactly.
            let mut rows = vec![0.0; tokens * 2 * width];
            for (t, row) in rows.chunks_exact_mut(2 * width).enumerate() {
                row[0] = size.sqrt() * (t as f32 * 0.7).sin();
                row[width..].copy_from_slice(&wave(width, 0.3 + t as f32));
            }
            let head = Head::new(&rows, 2 * width, width, 0, width);
            let mut queries = vec![0.0; 3 * width];
            (0..3).for_each(|q| queries[q * width] = size.sqrt() * [1.0, -1.0, 0.25][q]);
            let mut out = vec![f32::NAN; 3 * width];
            head.attend(&queries, &mut out, width);
            for q in 0..3 {
                let score = |t: usize| f64::from(queries[q * width]) * f64::from(rows[t * 2 * width]);
                let most = (0..tokens).map(score).fold(f64::MIN, f64::max);
                let weights: Vec<f64> = (0..tokens).map(|t| (score(t) - most).exp()).collect();
                let all: f64 = weights.iter().sum();
                // Where scores are huge their own rounding in f32 is worth e^(eps |score|).
                if f64::from(size) * 6e-8 > 1e-7 && size < 1e19 && tokens > 1 {
                    assert!(out.iter().all(|v| v.is_finite() && v.abs() <= 1.0 + 1e-5));
                    continue;
                }
                for c in 0..width {
                    let value = |t: usize| f64::from(rows[t * 2 * width + width + c]);
                    let truth = (0..tokens).map(|t| weights[t] * value(t)).sum::<f64>() / all;
                    let found = f64::from(out[q * width + c]);
                    assert!(
                        (found - truth).abs() <= 2e-6,
                        "{tokens} tokens, scores to {size}: {found}, expected {truth}"
                    );
                }
            }
        }
    }
    for length in [1, 7, 8, 9, 625] {
        let mut rows = vec![f32::NEG_INFINITY; 2 * length];
        rows[length..].fill(-3e38);
        let mut sums = [f32::NAN; 2];
        softmax_rows(&mut rows, length, &mut sums);
        assert!(rows[..length].iter().all(|v| *v == 0.0) && sums[0] == 1.0);
        assert!(rows[length..].iter().all(|v| *v == 1.0) && sums[1] == length as f32);
    }
}

/// Row 13: a constant row is 0 within 1e-6, whatever its value; a mean of 1e6 with a deviation of 1e-3, as far as f32
/// holds it; 1e30. Within 1e-4 of f64.
#[test]
fn row_13_norm() {
    for width in [1, 5, 8, 192] {
        let (one, zero) = (vec![1.0f32; width], vec![0.0f32; width]);
        let run = |x: &[f32], eps: f64| {
            let mut out = vec![f32::NAN; width];
            norm_rows(x, eps, &one, &zero, &mut out);
            let mean = x.iter().map(|v| f64::from(*v)).sum::<f64>() / width as f64;
            let variance = x.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / width as f64;
            for (v, x) in out.iter().zip(x) {
                let truth = (f64::from(*x) - mean) / (variance + eps).sqrt();
                assert!((f64::from(*v) - truth).abs() <= 1e-4, "{v}, expected {truth}");
            }
            out
        };
        for eps in [1e-6, 1e-5] {
            for value in [0.0f32, -0.0, 1.0, 0.1, 3.7e5, 1e6, -1e30, 1e30, 1e-40, f32::MAX] {
                let out = run(&vec![value; width], eps);
                assert!(out.iter().all(|v| v.abs() <= 1e-6), "constant {value}: {out:?}");
            }
            let spread: Vec<f32> = (0..width).map(|i| 1e6 + (i as f32 * 0.7).sin() * 1e-3).collect();
            run(&spread, eps);
            run(
                &(0..width)
                    .map(|i| if i % 2 == 0 { 1e30 } else { -1e30 })
                    .collect::<Vec<_>>(),
                eps,
            );
        }
    }
}

/// erfc in f64: the series of erf below 2.5, the continued fraction above.
fn erfc(x: f64) -> f64 {
    if x < 0.0 {
        return 2.0 - erfc(-x);
    }
    if x < 2.5 {
        let (mut term, mut sum) = (x, x);
        for n in 1..200 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        return 1.0 - sum * 2.0 / std::f64::consts::PI.sqrt();
    }
    let mut fraction = 0.0;
    for n in (1..120).rev() {
        fraction = f64::from(n) / 2.0 / (x + fraction);
    }
    (-x * x).exp() / std::f64::consts::PI.sqrt() / (x + fraction)
}

/// Row 14: GELU, SiLU, sigmoid and softplus within 1e-6 of f64 (relative above 1) at the listed places and between them,
/// monotone where the function is.
#[test]
fn row_14_activations() {
    let softplus = |x: f32| x.max(0.0) + neus::tail(x);
    type Pair<'a> = (&'a str, &'a dyn Fn(f32) -> f32, &'a dyn Fn(f64) -> f64);
    let functions: [Pair<'_>; 4] = [
        ("gelu", &gelu, &|x| 0.5 * x * erfc(-x / 2f64.sqrt())),
        ("silu", &silu, &|x| x / (1.0 + (-x).exp())),
        ("sigmoid", &drop_probability, &|x| 1.0 / (1.0 + (-x).exp())),
        ("softplus", &softplus, &|x| x.max(0.0) + (-x.abs()).exp().ln_1p()),
    ];
    for (name, f, exact) in functions {
        let mut worst = 0.0f64;
        let listed = [0.0f32, -0.0, 88.0, -88.0, 104.0, -104.0, 1e4, -1e4, 1e-30, -1e-30];
        let between = (-120_000..120_000).map(|i| i as f32 * 1e-3);
        for x in listed.into_iter().chain(between) {
            let truth = match exact(f64::from(x)) {
                v if v.is_nan() => 0.0, // -inf * 0 far below 0
                v => v,
            };
            let found = f64::from(f(x));
            let error = (found - truth).abs() / truth.abs().max(1.0);
            worst = worst.max(error);
            assert!(error <= 1e-6, "{name}({x}) = {found}, expected {truth}");
        }
        println!("{name}: worst {worst:.1e}");
        let from = if matches!(name, "sigmoid" | "softplus") {
            -110_000
        } else {
            0
        };
        let rising: Vec<f32> = (from..110_000).map(|i| f(i as f32 * 1e-3)).collect();
        // One unit in the last place of rounding between neighbours is no fall.
        let falls = rising
            .windows(2)
            .any(|w| w[1] < w[0] - 4.0 * f32::EPSILON * w[0].abs());
        assert!(!falls, "{name} falls");
        let ends = (f(f32::NEG_INFINITY), f(f32::INFINITY));
        match name {
            "sigmoid" => assert_eq!(ends, (0.0, 1.0)),
            _ => assert_eq!(ends, (0.0, f32::INFINITY), "{name}"),
        }
    }
    assert!(gelu(f32::NAN).is_nan() && silu(f32::NAN).is_nan());
    assert_eq!(drop_probability(f32::NAN), 0.5);
}

/// Row 16: no activation is ever f16 here; a weight file may be, and one beyond 65,504 is refused by name.
#[test]
fn row_16_half_precision_is_refused_where_it_overflows() {
    let file = |value: f32| {
        let bits = half::f16::from_f32(value).to_le_bytes();
        let view = TensorView::new(Dtype::F16, vec![1], &bits).expect("one number");
        safetensors::serialize([("a", view)], None).expect("serializable")
    };
    for (value, sound) in [
        (65_504.0, true),
        (1e-7, true),
        (65_520.0, false),
        (1e30, false),
        (f32::NAN, false),
    ] {
        let bytes = file(value);
        let mut weights = WeightFile::parse("w", &bytes).expect("a file");
        match weights.take("a", &[1]) {
            Ok(v) => assert!(sound && v[0].is_finite()),
            Err(e) => assert!(
                !sound && matches!(e, WeightsError::NotFinite { index: 0, .. }),
                "{e}"
            ),
        }
    }
}

/// Row 17: K of 1, 31, 33 and 100,000, numbers spread over 1e+-18, denormals: within K eps32 sum |a b| of f64 (what is
/// below the least normal number may go).
#[test]
fn row_17_products() {
    for k in [1, 31, 33, 100_000] {
        let (m, n) = (3, 17);
        let (mut a, b) = (wave(m * k, 0.37), wave(k * n, 0.73));
        for (i, v) in a.iter_mut().enumerate() {
            *v = (*v + 1.5) * [1e18, 1e-18, 1.0, 1e-40][i % 4];
        }
        let (mut ours, mut theirs) = (vec![f32::NAN; m * n], vec![f32::NAN; m * n]);
        let panels = PackedMatrix::new(MatrixView::rows(&b, n), k, n);
        panels.multiply(&a, k, [m, 0, k], InitialSum::Zero, &mut ours, n);
        matmul(
            &mut theirs,
            n,
            false,
            MatrixView::rows(&a, k),
            MatrixView::rows(&b, n),
            [m, n, k],
        );
        for at in 0..m * n {
            let terms = (0..k).map(|i| f64::from(a[at / n * k + i]) * f64::from(b[i * n + at % n]));
            let (truth, size) = terms.fold((0.0, 0.0), |(s, z), t| (s + t, z + t.abs()));
            let bound = k as f64 * f64::from(f32::EPSILON) * size + 1e-37;
            for found in [ours[at], theirs[at]] {
                assert!(
                    (f64::from(found) - truth).abs() <= bound,
                    "K {k}: {found}, expected {truth}"
                );
            }
        }
    }
}

/// Row 33: ties go to the lowest class, also among -infinity; NaN never wins.
#[test]
fn row_33_decode() {
    let of = |classes: &[f32]| {
        let mut label = [99u8];
        likeliest(classes, &mut label);
        label[0]
    };
    assert_eq!(of(&[1.0, 3.0, 3.0]), 1);
    assert_eq!(of(&[f32::NEG_INFINITY; 18]), 0);
    assert_eq!(of(&[-0.0, 0.0]), 0);
    assert_eq!(of(&[f32::NAN, -5.0, f32::NAN]), 1);
    assert_eq!(of(&[f32::NAN; 18]), 0);
    assert_eq!(of(&[f32::NEG_INFINITY, -3e38, f32::NAN]), 1);
    // Sixteen voxels at once are as good as one by one, and as argmax where nothing is NaN.
    let logits: Vec<f32> = (0..18 * 16).map(|i| (i * 7919 % 13) as f32).collect();
    let mut labels = [0u8; 16];
    likeliest(&logits, &mut labels);
    for (voxel, label) in labels.into_iter().enumerate() {
        let own: Vec<f32> = logits.iter().skip(voxel).step_by(16).copied().collect();
        assert_eq!((Some(usize::from(label)), label), (argmax(&own), of(&own)));
    }
}
