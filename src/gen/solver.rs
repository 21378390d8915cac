//! DDIM sampling and classifier-free guidance. Song et al. 2020, arXiv 2010.02502 (eta 0);
//! Ho and Salimans 2022, arXiv 2207.12598; v prediction by Salimans and Ho 2022, arXiv 2202.00512.
//! States are f64; a network may compute in f32 behind [`Denoiser`].

use thiserror::Error;

use super::schedule::{Level, Schedule, ScheduleError, Spacing};

/// What a network's output means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Prediction {
    /// The noise in the state.
    Epsilon,
    /// `alpha * noise - sigma * data`; finite everywhere, the choice with zero terminal SNR.
    V,
}

/// With or without the condition (layout, text) of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Branch {
    /// The condition is shown.
    Conditional,
    /// The condition is dropped, as in training with condition dropout.
    Unconditional,
}

/// A network as a solver sees it.
pub trait Denoiser {
    /// What may go wrong inside; solvers add their own errors to it.
    type Error: From<SolverError>;

    /// The prediction for state `x` at training step `t`, as long as `x`. Must be deterministic:
    /// inversion relies on the same input giving the same output.
    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, Self::Error>;
}

/// What a solver refuses.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SolverError {
    /// See [`ScheduleError`].
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// A network's output, a stored state or a mask of the wrong size.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A trajectory inverted with another number or spacing of steps.
    #[error("the trajectory was made for other noise levels than the sampler's")]
    OtherLevels,
    /// NaN or infinity in a state.
    #[error("state after step {step} of {steps} is not finite")]
    NotFinite {
        /// The step, counted from 1.
        step: usize,
        /// All steps.
        steps: usize,
    },
}

/// Fails unless `found` is `expected`.
pub(super) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), SolverError> {
    if found == expected {
        return Ok(());
    }
    Err(SolverError::Length {
        what,
        found,
        expected,
    })
}

/// Classifier-free guidance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance {
    /// 0 = without condition, 1 = the conditional prediction itself, above 1 = exaggerated.
    pub weight: f64,
    /// 0 = as it comes, 1 = scaled back to the spread of the conditional prediction
    /// (Lin et al. 2023, section 3.4, about 0.7 there). Guidance grows the variance as weight squared.
    pub rescale: f64,
}

impl Guidance {
    /// The conditional prediction as it is, one network call.
    pub const NONE: Guidance = Guidance {
        weight: 1.0,
        rescale: 0.0,
    };

    /// Network calls per prediction: weights 0 and 1 need only one branch.
    pub fn calls(&self) -> usize {
        if self.weight == 0.0 || self.weight == 1.0 {
            1
        } else {
            2
        }
    }

    /// The guided prediction.
    pub fn predict<D: Denoiser + ?Sized>(
        &self,
        model: &mut D,
        x: &[f64],
        t: f64,
    ) -> Result<Vec<f64>, D::Error> {
        if self.weight == 0.0 {
            return ask(model, x, t, Branch::Unconditional);
        }
        let conditional = ask(model, x, t, Branch::Conditional)?;
        if self.weight == 1.0 {
            return Ok(conditional);
        }
        let unconditional = ask(model, x, t, Branch::Unconditional)?;
        Ok(self.combine(&conditional, &unconditional))
    }

    /// `u + weight (c - u)`, then rescaled. Weights 0 and 1 return their branch bit for bit.
    pub fn combine(&self, conditional: &[f64], unconditional: &[f64]) -> Vec<f64> {
        if self.weight == 0.0 {
            return unconditional.to_vec();
        }
        if self.weight == 1.0 {
            return conditional.to_vec();
        }
        let pairs = conditional.iter().zip(unconditional);
        let mut guided: Vec<f64> = pairs.map(|(c, u)| u + self.weight * (c - u)).collect();
        if self.rescale != 0.0 {
            let spread = standard_deviation(&guided);
            if spread > 0.0 {
                let back = standard_deviation(conditional) / spread;
                let factor = self.rescale * back + (1.0 - self.rescale);
                guided.iter_mut().for_each(|g| *g *= factor);
            }
        }
        guided
    }
}

fn ask<D: Denoiser + ?Sized>(model: &mut D, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, D::Error> {
    let out = model.predict(x, t, branch)?;
    check_length("the network's prediction", out.len(), x.len())?;
    Ok(out)
}

/// Population standard deviation, two-pass; 0 for an empty slice.
pub(super) fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// One deterministic DDIM step as two numbers: `next = keep * x + push * prediction`.
///
/// With v prediction the levels are angles on a circle and the step is a rotation, so it stays finite
/// where alpha is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DdimStep {
    /// Weight of the state.
    pub keep: f64,
    /// Weight of the prediction.
    pub push: f64,
}

impl DdimStep {
    /// The step between two levels, in either direction; `prediction` is made at level `from`.
    pub fn new(prediction: Prediction, from: &Level, to: &Level) -> Result<Self, ScheduleError> {
        // Equal levels are an exact identity; the products below are so only up to rounding.
        if from.log_alpha_bar == to.log_alpha_bar {
            return Ok(Self { keep: 1.0, push: 0.0 });
        }
        match prediction {
            Prediction::Epsilon if from.alpha == 0.0 => {
                Err(ScheduleError::EpsilonWithoutSignal { t: from.t })
            }
            Prediction::Epsilon => {
                let keep = to.alpha / from.alpha;
                Ok(Self {
                    keep,
                    push: to.sigma - keep * from.sigma,
                })
            }
            Prediction::V => Ok(Self {
                keep: from.alpha * to.alpha + from.sigma * to.sigma,
                push: to.sigma * from.alpha - to.alpha * from.sigma,
            }),
        }
    }

    /// The next value of one number. A step between equal levels returns it bit for bit.
    #[inline]
    pub fn apply(&self, x: f64, predicted: f64) -> f64 {
        if self.push == 0.0 && self.keep == 1.0 {
            return x;
        }
        self.keep * x + self.push * predicted
    }

    /// The next state.
    pub fn apply_all(&self, x: &[f64], predicted: &[f64]) -> Vec<f64> {
        x.iter().zip(predicted).map(|(x, p)| self.apply(*x, *p)).collect()
    }

    /// The state that this step takes to `next` if the prediction there is `predicted`;
    /// `None` if the step forgets its state.
    pub fn solve(&self, next: &[f64], predicted: &[f64]) -> Option<Vec<f64>> {
        // Below this the division returns mostly rounding errors (one step from pure noise to data: cos 90 deg).
        const LEAST_KEEP: f64 = 1e-9;
        if self.keep.abs() < LEAST_KEEP {
            return None;
        }
        let pairs = next.iter().zip(predicted);
        Some(
            pairs
                .map(|(n, p)| {
                    if self.push == 0.0 && self.keep == 1.0 {
                        *n
                    } else {
                        (n - self.push * p) / self.keep
                    }
                })
                .collect(),
        )
    }
}

/// The clean data that a prediction implies.
pub fn clean_estimate(prediction: Prediction, level: &Level, x: f64, predicted: f64) -> f64 {
    match prediction {
        Prediction::Epsilon => (x - level.sigma * predicted) / level.alpha,
        Prediction::V => level.alpha * x - level.sigma * predicted,
    }
}

/// What a caller sees after each network call of a solver.
#[derive(Clone, Copy, Debug)]
pub struct StepView<'a> {
    /// Steps done, from 1.
    pub step: usize,
    /// All steps.
    pub steps: usize,
    /// State that the prediction was made for.
    pub x: &'a [f64],
    /// The prediction.
    pub predicted: &'a [f64],
    /// Level of `x` as the network was told.
    pub level: Level,
    /// State after the step.
    pub next: &'a [f64],
    prediction: Prediction,
}

impl<'a> StepView<'a> {
    pub(super) fn new(
        (step, steps): (usize, usize),
        prediction: Prediction,
        level: Level,
        (x, predicted, next): (&'a [f64], &'a [f64], &'a [f64]),
    ) -> Self {
        Self {
            step,
            steps,
            x,
            predicted,
            level,
            next,
            prediction,
        }
    }

    /// The clean data that this step's prediction implies: what a preview shows.
    pub fn clean_estimate(&self) -> Vec<f64> {
        let pairs = self.x.iter().zip(self.predicted);
        pairs
            .map(|(x, p)| clean_estimate(self.prediction, &self.level, *x, *p))
            .collect()
    }
}

/// Everything about a sampler but the network: levels from noise to data, what the network predicts, guidance.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampler {
    /// `steps + 1` levels, from noise to clean data.
    pub levels: Vec<Level>,
    /// What the network's output means.
    pub prediction: Prediction,
    /// How its two branches are combined.
    pub guidance: Guidance,
}

impl Sampler {
    /// For this project's networks: the standard schedule, trailing steps, v prediction.
    pub fn standard(steps: usize, guidance: Guidance) -> Result<Self, ScheduleError> {
        Ok(Self {
            levels: Schedule::standard().levels(steps, Spacing::Trailing)?,
            prediction: Prediction::V,
            guidance,
        })
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    /// The step from level `k` to level `k + 1`.
    pub(super) fn step(&self, k: usize) -> Result<DdimStep, ScheduleError> {
        DdimStep::new(self.prediction, &self.levels[k], &self.levels[k + 1])
    }

    /// DDIM from the noise `start` to data: all `steps + 1` states. `on_step` runs after each step and
    /// may end the run with an error (a newer job waits).
    pub fn sample<D: Denoiser + ?Sized>(
        &self,
        start: Vec<f64>,
        model: &mut D,
        mut on_step: impl FnMut(StepView<'_>) -> Result<(), D::Error>,
    ) -> Result<Vec<Vec<f64>>, D::Error> {
        let steps = self.steps();
        let mut states = Vec::with_capacity(steps + 1);
        states.push(start);
        for k in 0..steps {
            let x = &states[k];
            let level = self.levels[k];
            let step = self.step(k).map_err(SolverError::from)?;
            let predicted = self.guidance.predict(model, x, level.t)?;
            let next = step.apply_all(x, &predicted);
            check_finite(&next, k + 1, steps)?;
            on_step(StepView::new(
                (k + 1, steps),
                self.prediction,
                level,
                (x, &predicted, &next),
            ))?;
            states.push(next);
        }
        Ok(states)
    }
}

pub(super) fn check_finite(state: &[f64], step: usize, steps: usize) -> Result<(), SolverError> {
    if state.iter().all(|v| v.is_finite()) {
        return Ok(());
    }
    Err(SolverError::NotFinite { step, steps })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::generation::schedule::Betas;

    /// A closed-form model from two functions of one value and t; counts its calls.
    pub(in crate::generation) struct Toy<C, U> {
        pub conditional: C,
        pub unconditional: U,
        pub calls: [usize; 2],
    }

    pub(in crate::generation) fn toy<C, U>(conditional: C, unconditional: U) -> Toy<C, U>
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
        crate::generation::rng::normal_field(5, crate::generation::rng::Stream::Start, n, 1)
    }

    /// Row 2 of the extremes table: the step out of pure noise.
    #[test]
    fn row_02_leaving_pure_noise() {
        let schedule = Schedule::standard();
        let end = schedule.level(999);
        for to in [schedule.level(998), schedule.level(499), Level::CLEAN] {
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
        let error = DdimStep::new(Prediction::Epsilon, &end, &Level::CLEAN).expect_err("alpha is 0");
        assert_eq!(
            error.to_string(),
            "noise prediction cannot leave t = 999, where alpha is 0; expected v prediction"
        );
        // Cosine without rescaling: alpha is tiny, noise prediction explodes but stays finite.
        let plain = Schedule::new(Betas::Cosine, 1000, false).expect("valid");
        let step = DdimStep::new(Prediction::Epsilon, &plain.level(999), &Level::CLEAN).expect("alpha > 0");
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
            let spread = |l: &Level| (l.alpha * l.alpha * s * s + l.sigma * l.sigma).sqrt();
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
        let sampler = Sampler::standard(5, Guidance::NONE).expect("valid");
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
}
