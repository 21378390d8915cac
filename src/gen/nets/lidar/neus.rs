//! Weights of the intervals between samples of a signed distance along a ray, in log space (NeuS, Wang et al. 2021,
//! arXiv 2106.10689; UniScene, equations 9 and 10): finite for any steepness, no constant added anywhere.

use nn::kernels::exp;

/// ln(1 + e^-|x|): what ln sigmoid(x) lies below the smaller of x and 0.
#[inline(always)]
pub fn tail(x: f32) -> f32 {
    let small = exp(-x.abs());
    // Most samples are far from any surface: two terms of the series are exact there.
    if small < 1e-3 {
        small * (1.0 - 0.5 * small)
    } else {
        ln_1p(small)
    }
}

/// ln(1 + x) for x from 0 to 1, within 2e-7 relative: 2 artanh(x / (2 + x)) as a series.
#[inline(always)]
fn ln_1p(x: f32) -> f32 {
    let z = x / (2.0 + x);
    let y = z * z;
    let p = 1.0 / 15.0;
    let p = p * y + 1.0 / 13.0;
    let p = p * y + 1.0 / 11.0;
    let p = p * y + 1.0 / 9.0;
    let p = p * y + 1.0 / 7.0;
    let p = p * y + 1.0 / 5.0;
    let p = p * y + 1.0 / 3.0;
    2.0 * z + 2.0 * z * y * p
}

/// 1 - e^x for x up to 0, within 3e-7 relative.
#[inline(always)]
fn one_minus_exp(x: f32) -> f32 {
    if x < -0.35 {
        return 1.0 - exp(x);
    }
    let p = 1.0 / 5040.0;
    let p = p * x + 1.0 / 720.0;
    let p = p * x + 1.0 / 120.0;
    let p = p * x + 1.0 / 24.0;
    let p = p * x + 1.0 / 6.0;
    let p = p * x + 0.5;
    -(x + x * x * p)
}

/// ln(1 - alpha) of an interval from signed distance `f0` to `f1`, given [`tail`] of both, never above 0; NaN inputs give
/// 0, an interval that nothing stops in.
#[inline(always)]
pub fn log_pass(s: f32, [f0, f1]: [f32; 2], [tail0, tail1]: [f32; 2]) -> f32 {
    // Inside, both products are large and nearly equal: their difference is formed before it is multiplied.
    let whole = if f0 <= 0.0 {
        s * (f1 - f0)
    } else {
        (s * f1).min(0.0)
    };
    let change = whole - (tail1 - tail0);
    // Written so that NaN and -0 end as 0.
    if change < 0.0 && f1 < f0 { change } else { 0.0 }
}

/// alpha = max((Phi(f0) - Phi(f1)) / Phi(f0), 0) with Phi(x) = 1 / (1 + e^(-s x)), 0 to 1, given [`tail`] of s `f1`.
/// As sigmoid(-s f1) (1 - e^(-s (f0 - f1))) nothing cancels, however close the distances; NaN gives 0.
#[inline(always)]
pub fn alpha(s: f32, [f0, f1]: [f32; 2], tail1: f32) -> f32 {
    let fall = s * (f0 - f1);
    let stopped = one_minus_exp((s * f1).min(0.0) - tail1) * one_minus_exp(-fall);
    if fall > 0.0 && stopped > 0.0 { stopped } else { 0.0 }
}

/// Weight of each interval between consecutive samples with signed distances `f`, given [`tail`] of each s f, which a
/// ray computes once; returns the logarithm of what passes them all.
#[inline(always)]
pub fn weights(s: f32, f: &[f32], tails: &[f32], out: &mut Vec<f32>) -> f32 {
    out.clear();
    let mut passed = 0.0f32;
    for (f, tails) in f.windows(2).zip(tails.windows(2)) {
        // Most intervals stop nothing; NaN stops nothing either.
        if f[1] < f[0] {
            out.push(alpha(s, [f[0], f[1]], tails[1]) * exp(passed));
            passed += log_pass(s, [f[0], f[1]], [tails[0], tails[1]]);
        } else {
            out.push(0.0);
        }
    }
    passed
}

/// Where an interval from `t0` to `t1` is crossed: where a straight line between the distances is zero, the middle
/// where they do not change sign.
#[inline(always)]
pub fn crossing(t0: f32, t1: f32, f0: f32, f1: f32) -> f32 {
    let share = if f0 > 0.0 && f1 <= 0.0 {
        f0 / (f0 - f1)
    } else {
        0.5
    };
    t0 + (t1 - t0) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn reference() -> Value {
        serde_json::from_str(include_str!("../../../../tests/reference/neus.json"))
            .expect("the reference file")
    }

    fn numbers(value: &Value) -> Vec<f64> {
        let all = value.as_array().expect("a list").iter();
        all.map(|v| v.as_f64().expect("a number")).collect()
    }

    fn f32s(value: &Value) -> Vec<f32> {
        numbers(value).into_iter().map(|v| v as f32).collect()
    }

    fn tails(s: f32, f: &[f32]) -> Vec<f32> {
        f.iter().map(|f| tail(s * f)).collect()
    }

    fn alpha_of(s: f32, f0: f32, f1: f32) -> f32 {
        alpha(s, [f0, f1], tail(s * f1))
    }

    /// The same in f64, in the form that does not cancel.
    fn exact(s: f64, f0: f64, f1: f64) -> f64 {
        let fall = s * (f0 - f1);
        if fall > 0.0 {
            -(-fall).exp_m1() / (1.0 + (s * f1).exp())
        } else {
            0.0
        }
    }

    /// Row 48: 1e-4 relative or 1e-7 absolute against f64 on the same f32 inputs, and that f64 form against mpmath 1.3.0
    /// at 60 digits (reference/neus.json).
    #[test]
    fn row_48_alpha() {
        let (mut worst, mut inputs) = (0.0f64, Vec::new());
        for case in reference()["alphas"].as_array().expect("cases") {
            let [s, f0, f1, truth] = numbers(case)[..] else {
                panic!("four numbers")
            };
            let form = exact(s, f0, f1);
            // The reference's inputs are f64: their own rounding is all that may part the two.
            let close = 4.0 * f64::EPSILON * (s * f0).abs() / (s * (f0 - f1)).abs().max(1e-300);
            assert!(
                (form - truth).abs() <= 1e-300 + (1e-9 + close) * truth,
                "{form} {truth}"
            );
            inputs.push([s as f32, f0 as f32, f1 as f32]);
        }
        // Every steepness with distances far apart, close, and one bit apart, inside, outside and across.
        for e in -12..=20 {
            let s = 10f32.powf(e as f32 / 4.0);
            for k in -40..=40 {
                let f0 = k as f32 * 0.013 / s.sqrt().max(0.05);
                for step in [1e-7f32, 1e-5, 1e-3, 0.05, 0.4, 3.0] {
                    inputs.push([s, f0, f0 - step]);
                    inputs.push([s, f0, f0 + step]);
                }
                inputs.push([s, f0, f0.next_down()]);
            }
        }
        for [s, f0, f1] in inputs {
            let found = f64::from(alpha_of(s, f0, f1));
            let truth = exact(s.into(), f0.into(), f1.into());
            assert!((0.0..=1.0).contains(&found));
            let gap = (found - truth).abs();
            assert!(
                gap <= 1e-7 || gap <= 1e-4 * truth,
                "alpha({s}, {f0}, {f1}) = {found}, expected {truth}"
            );
            if truth > 1e-30 {
                worst = worst.max(gap / truth);
            }
        }
        println!("alpha: largest relative error {worst:.1e}");
        for s in [1e-3f32, 1.0, 1e5, f32::INFINITY] {
            for f in [
                0.0f32,
                -0.0,
                0.1,
                -0.1,
                1e30,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::NAN,
            ] {
                assert_eq!(alpha_of(s, f, f), 0.0);
                assert!((0.0..=1.0).contains(&alpha_of(s, 0.3, f)), "{s} {f}");
                assert!((0.0..=1.0).contains(&alpha_of(s, f, -0.3)), "{s} {f}");
            }
        }
    }

    /// Row 49: weights, their sum and the depths of all reference rays (outside, inside, sign flips, shells).
    #[test]
    fn row_49_weights() {
        for case in reference()["rays"].as_array().expect("cases") {
            let (s, f) = (case["s"].as_f64().expect("s") as f32, f32s(&case["sdf_m"]));
            let mut found = Vec::new();
            let passed = weights(s, &f, &tails(s, &f), &mut found);
            let sum: f64 = found.iter().map(|w| f64::from(*w)).sum();
            assert!(sum <= 1.0 + 1e-6, "{}: {sum}", case["name"]);
            assert!((sum - (1.0 - f64::from(passed).exp())).abs() < 1e-5);
            for (w, truth) in found.iter().zip(numbers(&case["weights"])) {
                assert!(
                    (f64::from(*w) - truth).abs() <= 1e-5,
                    "{}: {w} {truth}",
                    case["name"]
                );
            }
            let t = numbers(&case["depth_m"]);
            let left: f64 = found.iter().zip(&t).map(|(w, t)| f64::from(*w) * t).sum();
            let truth = case["depth_left"].as_f64().expect("a depth");
            let far = t.iter().fold(0.0f64, |m, v| m.max(*v));
            assert!(
                (left - truth).abs() <= 1e-5 * far,
                "{}: {left} {truth}",
                case["name"]
            );
        }
    }

    /// Row 49: one crossing takes all of the light, however steep and however many samples stand about it.
    #[test]
    fn row_49_one_crossing_takes_all() {
        let mut w = Vec::new();
        for s in [100.0f32, 1e3, 1e5] {
            for n in [2usize, 3, 50, 768] {
                let f: Vec<f32> = (0..n).map(|i| 1.0 - 2.0 * i as f32 / (n - 1) as f32).collect();
                weights(s, &f, &tails(s, &f), &mut w);
                let sum: f64 = w.iter().map(|w| f64::from(*w)).sum();
                assert!((sum - 1.0).abs() <= 1e-6, "s {s}, {n} samples: {sum}");
            }
        }
        // Wholly inside from the start, in small steps: what is stopped adds up to what does not pass.
        let f: Vec<f32> = (0..768).map(|i| -0.1 - i as f32 * 1e-6).collect();
        let passed = weights(1e5, &f, &tails(1e5, &f), &mut w);
        let sum: f64 = w.iter().map(|w| f64::from(*w)).sum();
        assert!(sum <= 1.0 + 1e-6 && (sum - 1.0 + f64::from(passed).exp()).abs() <= 1e-5);
    }

    /// Row 50: the depth of a known plane is off by half a step at most and the error halves with the step; the
    /// straight line between samples finds it.
    #[test]
    fn row_50_depth() {
        let mut before = None;
        for step in [1.0f32, 0.5, 0.25, 0.125, 0.0625] {
            // Planes anywhere within a step: one alone may happen to lie in the middle of one.
            let planes = (0..97).map(|i| 4.003 + i as f32 / 97.0);
            let mut off = 0.0;
            for plane in planes.clone() {
                let t: Vec<f32> = (0..(8.0 / step) as usize)
                    .map(|i| 1.0 + i as f32 * step)
                    .collect();
                let f: Vec<f32> = t.iter().map(|t| plane - t).collect();
                let mut w = Vec::new();
                weights(2e5, &f, &tails(2e5, &f), &mut w);
                let depth =
                    |at: &dyn Fn(usize) -> f32| -> f32 { w.iter().enumerate().map(|(i, w)| w * at(i)).sum() };
                let middle = depth(&|i| (t[i] + t[i + 1]) / 2.0);
                assert!(
                    (middle - plane).abs() <= step / 2.0 + 1e-3,
                    "{step}: {middle} for {plane}"
                );
                off += (middle - plane).abs();
                let line = depth(&|i| crossing(t[i], t[i + 1], f[i], f[i + 1]));
                assert!((line - plane).abs() < 1e-3, "{step}: {line} for {plane}");
            }
            let off = off / planes.count() as f32;
            if let Some(before) = before.replace(off) {
                let ratio = off / before;
                assert!((0.4..=0.6).contains(&ratio), "{step}: {off} after {before}");
            }
        }
    }
}
