//! Element-wise arithmetic of the networks: stable at the extremes, the same bits on every machine
//! and thread count (no fused multiply-add, sums in a fixed order).

/// exp(x) within 2e-7 relative; 0 below -87.3, exp(88.3) above that, NaN stays NaN.
/// Range reduction by ln 2 in two parts, then a polynomial (Cephes' coefficients).
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    const LN2_HI: f32 = 0.693_359_4;
    const LN2_LO: f32 = -2.121_944_4e-4;
    // Written so that NaN passes through both comparisons.
    let c = if x > 88.3 { 88.3 } else { x };
    let c = if c < -87.3 { -87.3 } else { c };
    // Adding 1.5 * 2^23 rounds to the nearest integer, without a library call.
    const ROUND: f32 = 12_582_912.0;
    let shifted = c * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = c - n * LN2_HI - n * LN2_LO;
    let p = 1.987_569_1e-4;
    let p = p * r + 1.398_199_9e-3;
    let p = p * r + 8.333_452e-3;
    let p = p * r + 4.166_579_6e-2;
    let p = p * r + 1.666_666_5e-1;
    let p = p * r + 0.5;
    let p = p * r * r + r + 1.0;
    // 2^n through the exponent bits: n, within -126..=127, stands in the low bits of `shifted`.
    let scale = f32::from_bits(shifted.to_bits().wrapping_add(127) << 23);
    if x < -87.3 { 0.0 } else { p * scale }
}

/// Exact GELU, x * Phi(x), with Phi from a complementary error function that is good to 1.2e-7
/// relative also in the tail (Numerical Recipes' Chebyshev fit), where 1 + erf would cancel.
#[inline(always)]
pub fn gelu(x: f32) -> f32 {
    let z = x.abs() * std::f32::consts::FRAC_1_SQRT_2;
    let t = 1.0 / (1.0 + 0.5 * z);
    let p = 0.170_872_77;
    let p = p * t - 0.822_152_23;
    let p = p * t + 1.488_515_9;
    let p = p * t - 1.135_204;
    let p = p * t + 0.278_868_07;
    let p = p * t - 0.186_288_06;
    let p = p * t + 0.096_784_18;
    let p = p * t + 0.374_091_96;
    let p = p * t + 1.000_023_7;
    let p = p * t - 1.265_512_2;
    let half_erfc = 0.5 * t * exp(p - z * z);
    let value = if x < 0.0 {
        x * half_erfc
    } else {
        x * (1.0 - half_erfc)
    };
    if x < -13.5 { -0.0 } else { value } // also -infinity, where the product is NaN
}

/// x * sigmoid(x).
#[inline(always)]
pub fn silu(x: f32) -> f32 {
    if x < -104.0 { -0.0 } else { x / (1.0 + exp(-x)) }
}

/// Writes a function three times: as it stands, and compiled for AVX2 and AVX-512, which are taken where the
/// machine has them. No fused operations are switched on, so all give the same bits; AVX2 is several times faster.
/// (A closure or generic helper would not do: it keeps its own instruction set.)
#[macro_export]
macro_rules! vectorised {
    ($(#[$meta:meta])* pub fn $name:ident($($arg:ident: $type:ty),* $(,)?) $body:block) => {
        $(#[$meta])*
        pub fn $name($($arg: $type),*) {
            #[inline(always)]
            fn plain($($arg: $type),*) $body
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn wide($($arg: $type),*) {
                    plain($($arg),*);
                }
                #[target_feature(enable = "avx512f")]
                fn widest($($arg: $type),*) {
                    plain($($arg),*);
                }
                if std::arch::is_x86_feature_detected!("avx512f") {
                    // SAFETY: the feature was just found on this machine.
                    unsafe { widest($($arg),*) };
                    return;
                }
                if std::arch::is_x86_feature_detected!("avx2") {
                    // SAFETY: the feature was just found on this machine.
                    unsafe { wide($($arg),*) };
                    return;
                }
            }
            plain($($arg),*);
        }
    };
}

vectorised! {
    /// GELU of a whole slice.
    pub fn gelu_all(values: &mut [f32]) {
        for v in values {
            *v = gelu(*v);
        }
    }
}

vectorised! {
    /// GELU within 3e-4, for the eight-bit path, whose steps are larger: 2 Phi(x) - 1 as an odd polynomial that was
    /// fitted for the least largest error of x Phi(x) up to |x| = 3.8, and +-1 beyond.
    pub fn gelu_all_roughly(values: &mut [f32]) {
        for v in values {
            let x = *v;
            let u = x * x;
            let p = 6.050_34e-8 * u - 3.913_720_5e-6;
            let p = p * u + 1.092_406_6e-4;
            let p = p * u - 1.748_819_1e-3;
            let p = p * u + 1.809_130_4e-2;
            let p = p * u - 0.130_264_97;
            let p = (p * u + 0.796_513) * x;
            let p = if x > 3.8 { 1.0 } else { p };
            let p = if x < -3.8 { -1.0 } else { p };
            let half = 0.5 * x;
            *v = if p == -1.0 { 0.0 } else { half + half * p };
        }
    }
}

vectorised! {
    /// Softmax of every row, in place and not yet divided; `sums` gets the divisors. A row's largest
    /// value is subtracted first. A row that is masked out (all -infinity) becomes zeros with sum 1.
    pub fn softmax_rows(scores: &mut [f32], row_length: usize, sums: &mut [f32]) {
        for (row, sum) in scores.chunks_exact_mut(row_length).zip(sums) {
            let max = max8(row);
            if max == f32::NEG_INFINITY && !row.iter().any(|v| v.is_nan()) {
                row.fill(0.0);
                *sum = 1.0;
                continue;
            }
            for v in row.iter_mut() {
                *v = exp(*v - max);
            }
            *sum = sum8(row);
        }
    }
}

/// Largest value; NaN is passed over.
#[inline(always)]
fn max8(row: &[f32]) -> f32 {
    let mut maxima = [f32::NEG_INFINITY; 8];
    let eights = row.chunks_exact(8);
    for v in eights.remainder() {
        maxima[0] = if *v > maxima[0] { *v } else { maxima[0] };
    }
    for eight in eights {
        for (max, v) in maxima.iter_mut().zip(eight) {
            *max = if *v > *max { *v } else { *max };
        }
    }
    maxima.into_iter().fold(f32::NEG_INFINITY, f32::max)
}

/// Eight sums side by side: vectorises, and the order is fixed.
#[inline(always)]
fn sum8(row: &[f32]) -> f32 {
    let mut sums = [0.0f32; 8];
    let eights = row.chunks_exact(8);
    for (sum, v) in sums.iter_mut().zip(eights.remainder()) {
        *sum += v;
    }
    for eight in eights {
        for (sum, v) in sums.iter_mut().zip(eight) {
            *sum += v;
        }
    }
    sums.iter().sum()
}

vectorised! {
    /// Layer norm of every row: (x - mean) / sqrt(variance + eps), times `scale` plus `shift`, all of
    /// `scale.len()` columns. Mean and variance are taken in two passes in f64: a large mean or a
    /// value of 1e30 does no harm.
    pub fn norm_rows(x: &[f32], eps: f64, scale: &[f32], shift: &[f32], out: &mut [f32]) {
        let width = scale.len();
        for (row, out) in x.chunks_exact(width).zip(out.chunks_exact_mut(width)) {
            let mean = moment8(row, 0.0, 1) / width as f64;
            let variance = moment8(row, mean, 2) / width as f64;
            let inverse = 1.0 / (variance + eps).sqrt();
            for (((o, v), s), b) in out.iter_mut().zip(row).zip(scale).zip(shift) {
                *o = ((f64::from(*v) - mean) * inverse) as f32 * s + b;
            }
        }
    }
}

/// Sum of (x - center) or of its square.
#[inline(always)]
fn moment8(row: &[f32], center: f64, power: u8) -> f64 {
    let term = |v: f32| {
        let d = f64::from(v) - center;
        if power == 2 { d * d } else { d }
    };
    let mut sums = [0.0f64; 8];
    let eights = row.chunks_exact(8);
    for (sum, v) in sums.iter_mut().zip(eights.remainder()) {
        *sum += term(*v);
    }
    for eight in eights {
        for (sum, v) in sums.iter_mut().zip(eight) {
            *sum += term(*v);
        }
    }
    sums.iter().sum()
}

vectorised! {
    /// x += gate * y for every row; `gate` has one value per column.
    pub fn add_gated(x: &mut [f32], gate: &[f32], y: &[f32]) {
        for (row, y) in x.chunks_exact_mut(gate.len()).zip(y.chunks_exact(gate.len())) {
            for ((x, g), y) in row.iter_mut().zip(gate).zip(y) {
                *x += g * y;
            }
        }
    }
}

vectorised! {
    /// The class of the largest logit for every voxel; the lowest class keeps a tie. Logits are
    /// `[class][voxel]`. A voxel whose logits are all NaN gets class 0: callers check that they are
    /// finite.
    pub fn likeliest(logits: &[f32], labels: &mut [u8]) {
        let voxels = labels.len();
        let mut best = [f32::NEG_INFINITY; 16];
        assert!(voxels <= best.len());
        labels.fill(0);
        for (class, logits) in logits.chunks_exact(voxels).enumerate() {
            for ((label, best), logit) in labels.iter_mut().zip(&mut best).zip(logits) {
                let better = *logit > *best;
                *best = if better { *logit } else { *best };
                *label = if better { class as u8 } else { *label };
            }
        }
    }
}

/// Index of the largest value, the lowest one on ties; `None` for an empty slice or one with NaN.
pub fn argmax(values: &[f32]) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (i, v) in values.iter().enumerate() {
        if v.is_nan() {
            return None;
        }
        if best.is_none_or(|(_, b)| *v > b) {
            best = Some((i, *v));
        }
    }
    best.map(|(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::super::golden::Golden;
    use super::*;

    #[test]
    fn exp_against_f64() {
        for i in -873_000..883_000 {
            let x = i as f32 * 1e-4;
            let (found, truth) = (f64::from(exp(x)), f64::from(x).exp());
            assert!(
                (found / truth - 1.0).abs() < 3e-7,
                "exp({x}) = {found}, expected {truth}"
            );
        }
        assert_eq!((exp(0.0), exp(-88.0), exp(f32::NEG_INFINITY)), (1.0, 0.0, 0.0));
        assert!(exp(f32::NAN).is_nan());
    }

    /// Row 14 of the extremes table, 1e-6; torch 2.15.0 in float64 (reference/nn.json).
    #[test]
    fn row_14_activations() {
        let golden = Golden::nn();
        let x = golden.f32("act.x");
        for (name, f) in [("act.gelu", gelu as fn(f32) -> f32), ("act.silu", silu)] {
            for (x, truth) in x.iter().zip(golden.f64(name)) {
                let found = f64::from(f(*x));
                assert!(
                    (found - truth).abs() <= 1e-6 * truth.abs().max(1.0),
                    "{name}({x}) = {found}, expected {truth}"
                );
            }
        }
        for f in [gelu, silu] {
            assert_eq!(
                (f(0.0), f(f32::INFINITY), f(f32::NEG_INFINITY)),
                (0.0, f32::INFINITY, 0.0)
            );
            assert!(f(f32::NAN).is_nan());
            for x in [88.0, 104.0, 1e4, 3e38f32] {
                assert_eq!((f(x), f(-x).abs() < 1e-30), (x, true), "{x}");
            }
            let above: Vec<f32> = (0..20_000).map(|i| f(i as f32 * 1e-3)).collect();
            assert!(above.is_sorted());
        }
    }

    /// Row 14, for the eight-bit path.
    #[test]
    fn row_14_rough_gelu() {
        let x: Vec<f32> = (-12_000..12_000).map(|i| i as f32 * 1e-3).collect();
        let mut rough = x.clone();
        gelu_all_roughly(&mut rough);
        for (x, found) in x.iter().zip(&rough) {
            assert!(
                (found - gelu(*x)).abs() < 3e-4,
                "{x}: {found}, expected {}",
                gelu(*x)
            );
        }
        let mut ends = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 3e38, -3e38, 0.0];
        gelu_all_roughly(&mut ends);
        assert!(ends[0] == f32::INFINITY && ends[1] == 0.0 && ends[2].is_nan());
        assert_eq!(ends[3..], [3e38, 0.0, 0.0]);
    }

    /// Row 11: rows sum to one whatever the scores.
    #[test]
    fn row_11_softmax() {
        for scores in [
            vec![1e4f32, -1e4, 0.0],
            vec![3e38, -3e38, 3e38, 1.0],
            vec![-3e38; 7],
            vec![0.25; 625],
            vec![42.0],
            (0..625).map(|i| (i as f32 * 0.7).sin() * 30.0).collect(),
        ] {
            let mut row = scores.clone();
            let mut sum = [0.0];
            softmax_rows(&mut row, scores.len(), &mut sum);
            let total: f64 = row.iter().map(|v| f64::from(v / sum[0])).sum();
            assert!((total - 1.0).abs() < 1e-6, "{total}");
            let max = f64::from(scores.iter().copied().fold(f32::MIN, f32::max));
            let truth: Vec<f64> = scores.iter().map(|s| (f64::from(*s) - max).exp()).collect();
            let all: f64 = truth.iter().sum();
            for (v, t) in row.iter().zip(&truth) {
                assert!((f64::from(v / sum[0]) - t / all).abs() < 1e-6);
            }
        }
    }

    /// Row 12: a fully masked row is zeros, NaN is not hidden.
    #[test]
    fn row_12_masked_softmax() {
        let mut rows = vec![f32::NEG_INFINITY; 24];
        rows[12..].fill(1.0);
        rows[14] = f32::NEG_INFINITY;
        let mut sums = [0.0; 2];
        softmax_rows(&mut rows, 12, &mut sums);
        assert_eq!((&rows[..12], sums[0]), (&[0.0; 12][..], 1.0));
        assert_eq!((rows[12], rows[14], sums[1]), (1.0, 0.0, 11.0));
        for mut bad in [vec![1.0, f32::NAN], vec![f32::NAN; 2]] {
            softmax_rows(&mut bad, 2, &mut sums[..1]);
            assert!(sums[0].is_nan());
        }
    }

    /// Row 13: constant rows, a large mean, huge values; torch's layer norm, eps 1e-5.
    #[test]
    fn row_13_norm() {
        let golden = Golden::nn();
        let (x, scale, shift) = (
            golden.f32("norm.layer.x"),
            golden.f32("norm.layer.weight"),
            golden.f32("norm.layer.bias"),
        );
        let mut out = vec![0.0; x.len()];
        norm_rows(&x, 1e-5, &scale, &shift, &mut out);
        for (found, truth) in out.iter().zip(golden.f64("norm.layer.out")) {
            assert!(
                (f64::from(*found) - truth).abs() <= 1e-5 * truth.abs().max(1.0),
                "{found}, expected {truth}"
            );
        }
        let (one, zero) = (vec![1.0f32; 192], vec![0.0f32; 192]);
        for make in [
            |_| 3.7e5,
            |i: usize| 1e6 + (i % 7) as f32 * 0.125,
            |i| if i % 2 == 0 { 1e30 } else { -1e30 },
        ] {
            let x: Vec<f32> = (0..192).map(make).collect();
            let mut out = vec![0.0; 192];
            norm_rows(&x, 1e-6, &one, &zero, &mut out);
            let mean = x.iter().map(|v| f64::from(*v)).sum::<f64>() / 192.0;
            let variance = x.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / 192.0;
            for (v, x) in out.iter().zip(&x) {
                let truth = (f64::from(*x) - mean) / (variance + 1e-6).sqrt();
                assert!((f64::from(*v) - truth).abs() <= 1e-4, "{v}, expected {truth}");
            }
        }
    }

    /// Row 33: the lowest index wins a tie, NaN is an error.
    #[test]
    fn row_33_argmax() {
        assert_eq!(argmax(&[1.0, 3.0, 3.0]), Some(1));
        assert_eq!(argmax(&[f32::NEG_INFINITY; 18]), Some(0));
        assert_eq!(argmax(&[0.0, -0.0]), Some(0));
        assert_eq!((argmax(&[0.0, f32::NAN, 1.0]), argmax(&[])), (None, None));
    }
}
