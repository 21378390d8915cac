//! Extremes of guidance, DDIM steps and models that misbehave.

use super::*;
use crate::schedule::{Betas, NoiseLevel, Schedule, Spacing};

/// A closed-form model from two functions of one value and t; counts its calls.
pub struct Toy<C, U> {
    pub conditional: C,
    pub unconditional: U,
    pub calls: [usize; 2],
}
pub fn toy<C, U>(conditional: C, unconditional: U) -> Toy<C, U>
where
    C: Fn(f64, f64) -> f64,
    U: Fn(f64, f64) -> f64,
{
    Toy {
        conditional,
        unconditional,
        calls: [0; 2],
    }
}

impl<C: Fn(f64, f64) -> f64, U: Fn(f64, f64) -> f64> Denoiser for Toy<C, U> {
    type Error = SolverError;
    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, SolverError> {
        self.calls[branch as usize] += 1;
        Ok(x.iter()
            .map(|x| match branch {
                Branch::Conditional => (self.conditional)(*x, t),
                Branch::Unconditional => (self.unconditional)(*x, t),
            })
            .collect())
    }
}

fn noise(n: usize) -> Vec<f64> {
    numeric::philox::normal_field(5, numeric::philox::Stream::Start, n, 1)
}

/// Row 2 of the extremes table: the step out of pure noise.
#[test]
fn row_02_leaving_pure_noise() {
    let schedule = Schedule::standard();
    let end = schedule.level(999);
    for to in [schedule.level(998), schedule.level(499), NoiseLevel::CLEAN] {
        let step = DdimStep::new(Prediction::V, &end, &to).expect("v");
        for v in [-3.0, 0.0, 1e-30, 2.5] {
            let next = step.apply(0.7, v);
            assert!(next.is_finite());
            let x0 = clean_estimate(Prediction::V, &end, 0.7, v);
            assert!(x0.is_finite() && x0.abs() <= 1.01 * v.abs());
            assert_eq!(x0, -v);
            // The same by way of data and noise.
            let direct = to.alpha * -v + to.sigma * 0.7;
            assert!((next - direct).abs() <= 1e-15);
        }
    }
    let error = DdimStep::new(Prediction::Epsilon, &end, &NoiseLevel::CLEAN).expect_err("alpha is 0");
    assert_eq!(
        error.to_string(),
        "noise prediction cannot leave t = 999, where alpha is 0; expected v prediction"
    );
    // Cosine without rescaling: alpha is tiny, noise prediction explodes but stays finite.
    let plain = Schedule::new(Betas::Cosine, 1000, false).expect("valid");
    let step = DdimStep::new(Prediction::Epsilon, &plain.level(999), &NoiseLevel::CLEAN).expect("alpha > 0");
    assert!(step.apply(1.0, -1.0).is_finite());
}

/// Row 6 of the extremes table.
#[test]
fn row_06_equal_levels_are_an_identity() {
    let schedule = Schedule::standard();
    for t in 0..1000 {
        for prediction in [Prediction::Epsilon, Prediction::V] {
            let level = schedule.level(t);
            let step = DdimStep::new(prediction, &level, &level).expect("an identity everywhere");
            for x in [-0.0, 0.1, -1e300, f64::MIN_POSITIVE] {
                assert_eq!(step.apply(x, 3.7).to_bits(), x.to_bits());
            }
        }
    }
}

/// Row 7 of the extremes table: for data N(0, s^2) the exact prediction is linear in x and the
/// probability flow scales x by sqrt(alpha^2 s^2 + sigma^2).
#[test]
fn row_07_first_order_on_gaussian_data() {
    let s = 0.5f64;
    let linear = Betas::Linear {
        first: 1e-4,
        last: 0.02,
    };
    for (betas, zero_snr, prediction) in [
        (linear, false, Prediction::Epsilon),
        (linear, false, Prediction::V),
        (Betas::Cosine, true, Prediction::V),
    ] {
        let schedule = Schedule::new(betas, 1000, zero_snr).expect("valid");
        let spread = |l: &NoiseLevel| (l.alpha * l.alpha * s * s + l.sigma * l.sigma).sqrt();
        let of_model = schedule.clone();
        let exact = move |x: f64, t: f64| {
            let l = of_model.level(t as usize);
            let variance = l.alpha * l.alpha * s * s + l.sigma * l.sigma;
            match prediction {
                Prediction::Epsilon => l.sigma * x / variance,
                Prediction::V => l.alpha * l.sigma * (1.0 - s * s) * x / variance,
            }
        };
        let error = |n: usize| {
            let levels = schedule.levels(n, Spacing::Trailing).expect("valid");
            let truth = spread(&levels[n]) / spread(&levels[0]);
            let sampler = Sampler {
                solver: SolverKind::Ddim,
                levels,
                prediction,
                guidance: Guidance::NONE,
            };
            let mut model = toy(&exact, |_, _| f64::NAN);
            let states = sampler.sample(vec![1.0], &mut model, |_| Ok(())).expect("finite");
            assert_eq!(model.calls, [n, 0]);
            (states[n][0] - truth).abs()
        };
        for n in [50, 125, 250] {
            let ratio = error(2 * n) / error(n);
            assert!(
                (0.4..=0.6).contains(&ratio),
                "{betas:?} {prediction:?} N {n}: ratio {ratio}"
            );
        }
    }
}

/// Row 10 of the extremes table.
#[test]
fn row_10_guidance() {
    let c: Vec<f64> = noise(4000);
    let u: Vec<f64> = c
        .iter()
        .enumerate()
        .map(|(i, c)| 0.8 * c + 0.3 * (i as f64).sin())
        .collect();
    let guide = |weight, rescale| Guidance { weight, rescale };
    let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&guide(1.0, 0.7).combine(&c, &u)), bits(&c));
    assert_eq!(bits(&guide(0.0, 0.7).combine(&c, &u)), bits(&u));
    for w in [0.0, 1.0, 1.0 + 1e-7, 3.0, 7.0, 30.0, 100.0, -1.0] {
        assert_eq!(
            bits(&guide(w, 0.0).combine(&c, &c)),
            bits(&c),
            "equal branches, w {w}"
        );
        let plain = guide(w, 0.0).combine(&c, &u);
        let full = guide(w, 1.0).combine(&c, &u);
        let part = guide(w, 0.7).combine(&c, &u);
        let (target, before) = (standard_deviation(&c), standard_deviation(&plain));
        if w != 0.0 {
            let ratio = standard_deviation(&full) / target;
            assert!((0.9..=1.1).contains(&ratio), "w {w}: {ratio}");
        }
        if w != 0.0 && w != 1.0 {
            let expected = 0.7 * target + 0.3 * before;
            assert!(
                (standard_deviation(&part) / expected - 1.0).abs() < 1e-12,
                "w {w}"
            );
        }
    }
    let near = guide(1.0 + 1e-7, 0.0).combine(&c, &u);
    assert!(near.iter().zip(&c).all(|(a, b)| (a - b).abs() < 1e-6));
    // A constant prediction has no spread to scale.
    assert_eq!(guide(3.0, 1.0).combine(&[2.0; 4], &[2.0; 4]), vec![2.0; 4]);
    // Calls: one branch is enough at 0 and 1.
    for (weight, calls) in [(0.0, [0, 1]), (1.0, [1, 0]), (3.0, [1, 1])] {
        let mut model = toy(|x, _| x, |x, _| 2.0 * x);
        let guidance = guide(weight, 0.0);
        let out = guidance.predict(&mut model, &[1.0], 0.0).expect("finite");
        assert_eq!(model.calls, calls);
        assert_eq!(guidance.calls(), calls.iter().sum::<usize>());
        assert_eq!(out, vec![2.0 - weight]);
    }
}

#[test]
fn bad_models_give_typed_errors() {
    struct Short;
    impl Denoiser for Short {
        type Error = SolverError;
        fn predict(&mut self, _: &[f64], _: f64, _: Branch) -> Result<Vec<f64>, SolverError> {
            Ok(vec![0.0])
        }
    }
    let sampler = Sampler::standard(SolverKind::Ddim, 5, Guidance::NONE).expect("valid");
    let error = sampler
        .sample(vec![0.0; 3], &mut Short, |_| Ok(()))
        .expect_err("short");
    assert_eq!(
        error.to_string(),
        "the network's prediction has 1 values, expected 3"
    );
    let mut nan_late = toy(|x, t| if t < 500.0 { f64::NAN } else { x }, |_, _| 0.0);
    let error = sampler
        .sample(vec![0.5], &mut nan_late, |_| Ok(()))
        .expect_err("NaN");
    assert_eq!(error, SolverError::NotFinite { step: 4, steps: 5 });
    // The callback ends the run.
    let stop = SolverError::NotFinite { step: 2, steps: 5 };
    let mut model = toy(|x, _| x, |_, _| 0.0);
    let ended = sampler.sample(vec![0.5], &mut model, |view| {
        if view.step == 2 { Err(stop) } else { Ok(()) }
    });
    assert_eq!((ended, model.calls), (Err(stop), [2, 0]));
}

/// Row 9 of the extremes table: UniPC's weights near h = 0, where (e^h - 1)/h - 1 cancels. Truth: the
/// quotients of the two series to twenty terms, which hold for small h.
#[test]
fn row_09_unipc_weights() {
    for exponent in -120..=-1 {
        let h = -(10f64.powf(f64::from(exponent) / 10.0));
        let series = |first: u32| {
            // sum over n of h^n / (n + first)!, without its first term's h taken out
            let mut term = 1.0 / (1..=first + 1).map(f64::from).product::<f64>();
            let mut sum = 0.0;
            for n in 1..=20 {
                sum += term;
                term *= h / f64::from(n + first + 1);
            }
            sum
        };
        // e^h - 1 over h, phi_2 over h, phi_3 over h.
        let (one, two, three) = (series(0), series(1), series(2));
        let found = multistep::weights_of(h);
        for (found, truth) in found.into_iter().zip([two / one, 2.0 * three / one]) {
            assert!(
                (found / truth - 1.0).abs() <= 1e-10,
                "h {h:e}: {found}, expected {truth}"
            );
        }
    }
    assert_eq!(multistep::weights_of(0.0), [0.5, 1.0 / 3.0]);
    assert_eq!(multistep::weights_of(f64::NEG_INFINITY), [1.0, 1.0]);
}

/// Row 22 of the extremes table: the moments of exactly inverted noise are judged, and a sampler without
/// signal at its noisiest level is refused.
#[test]
fn row_22_obelm_needs_signal() {
    let with_pure_noise = Sampler {
        solver: SolverKind::OBelm,
        ..Sampler::standard(SolverKind::Ddim, 5, Guidance::NONE).expect("valid")
    };
    let mut model = toy(|x, _| x, |_, _| 0.0);
    let error = with_pure_noise
        .sample(vec![0.5], &mut model, |_| Ok(()))
        .expect_err("no signal");
    assert_eq!(
        error.to_string(),
        "no signal at t = 999, expected a noisiest level with alpha above 0"
    );
    let sampler = Sampler::standard(SolverKind::OBelm, 10, Guidance::NONE).expect("valid");
    assert!(sampler.levels[0].alpha > 0.05);
}
