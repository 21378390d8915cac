//! Weights of the intervals between samples of a signed distance along a ray, in log space (NeuS, Wang et al. 2021,
//! arXiv 2106.10689; UniScene, equations 9 and 10): finite for any steepness, no constant added anywhere.

use crate::generation::model::kernels::exp;

/// ln sigmoid(x).
#[inline(always)]
pub fn log_sigmoid(x: f32) -> f32 {
    let small = exp(-x.abs());
    // Most samples are far from any surface: two terms of the series are exact there.
    let tail = if small < 1e-3 {
        small * (1.0 - 0.5 * small)
    } else {
        ln_1p(small)
    };
    x.min(0.0) - tail
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

/// ln(1 - alpha) of an interval from signed distance `f0` to `f1`, never above 0; NaN inputs give 0, an interval that
/// nothing stops in.
#[inline(always)]
pub fn log_pass(s: f32, f0: f32, f1: f32) -> f32 {
    let change = log_sigmoid(s * f1) - log_sigmoid(s * f0);
    // Written so that NaN and -0 end as 0.
    if change < 0.0 { change } else { 0.0 }
}

/// alpha = max((Phi(f0) - Phi(f1)) / Phi(f0), 0) with Phi(x) = 1 / (1 + e^(-s x)), 0 to 1.
#[inline(always)]
pub fn alpha(s: f32, f0: f32, f1: f32) -> f32 {
    one_minus_exp(log_pass(s, f0, f1))
}

/// Weight of each interval between consecutive samples; returns the logarithm of what passes them all.
pub fn weights(s: f32, f: &[f32], out: &mut Vec<f32>) -> f32 {
    let logs: Vec<f32> = f.iter().map(|f| log_sigmoid(s * f)).collect();
    weights_of_logs(&logs, out)
}

/// The same from ln sigmoid(s f) of each sample, which a ray computes once.
#[inline(always)]
pub fn weights_of_logs(logs: &[f32], out: &mut Vec<f32>) -> f32 {
    out.clear();
    let mut passed = 0.0f32;
    for pair in logs.windows(2) {
        let change = pair[1] - pair[0];
        // Most intervals stop nothing; NaN stops nothing either.
        if change < 0.0 {
            out.push(one_minus_exp(change) * exp(passed));
            passed += change;
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

    /// Row 48: mpmath 1.3.0 at 60 digits; 1e-7 absolute + 2e-4 relative, or 4 eps |s f0| / |s (f0 - f1)| where the
    /// inputs are nearly equal (reference/neus.json).
    #[test]
    fn row_48_alpha() {
        for case in reference()["alphas"].as_array().expect("cases") {
            let [s, f0, f1, truth] = numbers(case)[..] else {
                panic!("four numbers")
            };
            let found = f64::from(alpha(s as f32, f0 as f32, f1 as f32));
            let close = 4.0 * f64::from(f32::EPSILON) * (s * f0).abs() / (s * (f0 - f1)).abs();
            let relative = if close.is_finite() { close.max(2e-4) } else { 2e-4 };
            assert!((0.0..=1.0).contains(&found));
            assert!(
                (found - truth).abs() <= 1e-7 + relative * truth,
                "alpha({s}, {f0}, {f1}) = {found}, expected {truth}"
            );
        }
        for s in [1e-3f32, 1.0, 1e5, f32::INFINITY] {
            for f in [0.0f32, -0.0, 0.1, -0.1, 1e30, f32::NAN] {
                assert_eq!(alpha(s, f, f), 0.0);
                assert!((0.0..=1.0).contains(&alpha(s, 0.3, f)), "{s} {f}");
            }
        }
    }

    /// Row 49: weights, their sum and the depths of all reference rays (outside, inside, sign flips, shells).
    #[test]
    fn row_49_weights() {
        for case in reference()["rays"].as_array().expect("cases") {
            let (s, f) = (case["s"].as_f64().expect("s") as f32, f32s(&case["sdf_m"]));
            let mut found = Vec::new();
            let passed = weights(s, &f, &mut found);
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
                weights(2e5, &f, &mut w);
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
