//! DDIM inversion: the noise that a given latent comes from, and every state on the way.
//! Song et al. 2020, arXiv 2010.02502, section 4.3; as editing tool: UniScene C.1, at guidance 1.
//!
//! Plain inversion is first order: it reads the network at the state it comes from instead of the one it
//! goes to. [`Refinement`] iterates towards the true preimage (Pan et al. 2023, arXiv 2309.04907), damped,
//! because undamped iteration diverges on stiff steps. With O-BELM as solver the inverse is exact
//! (`obelm.rs`).

mod obelm;

use super::schedule::NoiseLevel;
use super::solver::{
    DdimStep, Denoiser, Sampler, SolverError, SolverKind, check_finite, check_length, standard_deviation,
};
use numeric::philox::{Stream, normal_field};

/// All states between noise and data of one latent, from noise to data.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Noise levels of the states; the last one is clean data.
    pub levels: Vec<NoiseLevel>,
    /// One state per level, each as long as the latent.
    pub states: Vec<Vec<f64>>,
}

impl Trajectory {
    /// A latent (`channels` numbers per cell, channel last) with one draw of noise, mixed at each level as in training. A
    /// network that denoises a part of it sees around that part what it saw in training.
    pub fn noised(clean: &[f64], levels: &[NoiseLevel], channels: usize, seed: u64) -> Self {
        let noise = normal_field(seed, Stream::Region, clean.len() / channels, channels);
        let state = |level: &NoiseLevel| {
            let pairs = clean.iter().zip(&noise);
            pairs.map(|(x, e)| level.alpha * x + level.sigma * e).collect()
        };
        Self {
            levels: levels.to_vec(),
            states: levels.iter().map(state).collect(),
        }
    }

    /// The noise that it starts from.
    pub fn noise(&self) -> &[f64] {
        &self.states[0]
    }

    /// The clean latent that it ends in.
    pub fn latent(&self) -> &[f64] {
        &self.states[self.states.len() - 1]
    }

    /// The clean latent in the precision of the networks.
    pub fn latent_f32(&self) -> Vec<f32> {
        self.latent().iter().map(|v| *v as f32).collect()
    }

    /// Training steps at which the network is evaluated, noise first.
    pub fn timesteps(&self) -> Vec<f64> {
        self.levels[..self.levels.len() - 1].iter().map(|l| l.t).collect()
    }
}

/// Damped fixed-point iteration on each inversion step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Updates per step; 0 = plain inversion. Each takes one prediction, and one more measures the last update.
    pub iterations: usize,
    /// Share of the way to the proposed state that an update goes.
    pub damping: f64,
    /// A step is done when its residual is at most this.
    pub tolerance_rms: f64,
}

impl Refinement {
    /// Plain inversion.
    pub const NONE: Refinement = Refinement::damped(0);

    /// Half-way updates, until the residual is at the level of f32 networks.
    pub const fn damped(iterations: usize) -> Refinement {
        Refinement {
            iterations,
            damping: 0.5,
            tolerance_rms: 1e-7,
        }
    }
}

/// Report of an inversion.
#[derive(Clone, Debug, PartialEq)]
pub struct InversionReport {
    /// Network calls.
    pub calls: usize,
    /// Per step from data to noise: RMS distance between the state and the one that would lead exactly
    /// back; empty without refinement, NaN for a step that forgets its state.
    pub residual_rms: Vec<f64>,
    /// Steps whose residual did not fall below that of the plain step, which was kept.
    pub fallback_steps: usize,
    /// Mean of the noise.
    pub mean: f64,
    /// Standard deviation of the noise.
    pub std: f64,
    /// Largest magnitude in the noise.
    pub max_abs: f64,
}

impl InversionReport {
    /// The moments of a noise; no calls yet.
    fn of_noise(noise: &[f64]) -> Self {
        Self {
            calls: 0,
            residual_rms: Vec::new(),
            fallback_steps: 0,
            mean: noise.iter().sum::<f64>() / noise.len().max(1) as f64,
            std: standard_deviation(noise),
            max_abs: noise.iter().fold(0.0, |m, v| m.max(v.abs())),
        }
    }

    /// True if the noise could be a draw: standard deviation in 0.9 to 1.1 and nothing at 6 or beyond. If it is false,
    /// edits that start from the noise are likely to look wrong.
    pub fn moments_ok(&self) -> bool {
        (0.9..=1.1).contains(&self.std) && self.max_abs < 6.0
    }
}

/// Inverts `clean` with the sampler's levels; exactly if its solver is O-BELM, which needs no
/// refinement, else as DDIM does. `on_step(done, steps)` runs after each step and may end
/// the run with an error. Errors also if a state is not finite.
pub fn invert<D: Denoiser + ?Sized>(
    sampler: &Sampler,
    clean: &[f64],
    refinement: Refinement,
    model: &mut D,
    mut on_step: impl FnMut(usize, usize) -> Result<(), D::Error>,
) -> Result<(Trajectory, InversionReport), D::Error> {
    if sampler.solver == SolverKind::OBelm {
        return obelm::invert(sampler, clean, model, on_step);
    }
    let steps = sampler.steps();
    check_finite(clean, 0, steps)?;
    let mut predictions = 0;
    let mut residual_rms = Vec::new();
    let mut fallback_steps = 0;
    let mut states = vec![clean.to_vec()]; // data first, turned round at the end
    for (done, k) in (0..steps).rev().enumerate() {
        let (noisy, cleaner) = (&sampler.levels[k], &sampler.levels[k + 1]);
        let target = &states[done];
        let up = DdimStep::new(sampler.prediction, cleaner, noisy).map_err(SolverError::from)?;
        let predicted = sampler.guidance.predict(model, target, noisy.t)?;
        predictions += 1;
        let mut state = up.apply_all(target, &predicted);
        check_finite(&state, done + 1, steps)?;
        if refinement.iterations > 0 {
            let down = sampler.step(k).map_err(SolverError::from)?;
            let refined = refine(&down, target, &state, refinement, |x| {
                predictions += 1;
                sampler.guidance.predict(model, x, noisy.t)
            })?;
            fallback_steps += usize::from(refined.fell_back);
            residual_rms.push(refined.residual_rms);
            state = refined.state;
        }
        on_step(done + 1, steps)?;
        states.push(state);
    }
    states.reverse();
    let report = InversionReport {
        calls: predictions * sampler.guidance.calls(),
        residual_rms,
        fallback_steps,
        ..InversionReport::of_noise(&states[0])
    };
    let levels = sampler.levels.clone();
    Ok((Trajectory { levels, states }, report))
}

struct Refined {
    state: Vec<f64>,
    residual_rms: f64,
    fell_back: bool,
}

/// Looks for the state that `down` takes to `target`, from the plain answer `start`. Every iterate is
/// measured and the best one kept, so refining never makes a step worse.
fn refine<E>(
    down: &DdimStep,
    target: &[f64],
    start: &[f64],
    refinement: Refinement,
    mut predict: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Refined, E> {
    let mut state = start.to_vec();
    let mut best = (f64::INFINITY, start.to_vec());
    let mut first = f64::NAN;
    for i in 0..=refinement.iterations {
        let predicted = predict(&state)?;
        let Some(proposed) = down.solve(target, &predicted) else {
            first = f64::NAN;
            break;
        };
        let residual = rms_difference(&proposed, &state);
        if i == 0 {
            first = residual;
        }
        // NaN and infinity are never better.
        if residual < best.0 {
            best = (residual, state.clone());
        }
        if !residual.is_finite() || residual <= refinement.tolerance_rms {
            break;
        }
        for (s, p) in state.iter_mut().zip(&proposed) {
            *s += refinement.damping * (p - *s);
        }
    }
    let settled = best.0 < first || best.0 <= refinement.tolerance_rms;
    Ok(Refined {
        residual_rms: if best.0.is_finite() { best.0 } else { first },
        fell_back: !settled,
        state: best.1,
    })
}

/// Root of the mean squared difference.
fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len().max(1) as f64).sqrt()
}

/// Samples from a trajectory's noise and compares with its latent: RMS error relative to the latent's RMS.
/// Costs as many network calls as sampling.
pub fn round_trip_error<D: Denoiser + ?Sized>(
    sampler: &Sampler,
    trajectory: &Trajectory,
    model: &mut D,
    mut on_step: impl FnMut(usize, usize) -> Result<(), D::Error>,
) -> Result<f64, D::Error> {
    check_length("the trajectory", trajectory.states.len(), sampler.levels.len())?;
    let given = trajectory.states[..sampler.states_of_noise()].to_vec();
    let states = sampler.sample_from(given, model, |view| on_step(view.step, view.steps))?;
    let latent = trajectory.latent();
    let size = rms_difference(latent, &vec![0.0; latent.len()]);
    let error = rms_difference(&states[states.len() - 1], latent);
    Ok(if error == 0.0 { 0.0 } else { error / size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::{Schedule, Spacing};
    use crate::solver::Guidance;
    use crate::solver::tests::toy;
    use numeric::philox::Stream;

    fn sampler(n: usize, weight: f64) -> Sampler {
        let guidance = Guidance { weight, rescale: 0.0 };
        Sampler::standard(SolverKind::Ddim, n, guidance).expect("valid")
    }

    /// A smooth nonlinear v: data lie near +-0.8 (two-peak Gaussian mixture, exact posterior mean).
    fn mixture(spread: f64, shift: f64) -> impl Fn(f64, f64) -> f64 {
        let schedule = Schedule::standard();
        move |x, t| {
            let l = schedule.level(t as usize);
            let variance = l.alpha * l.alpha * spread * spread + l.sigma * l.sigma;
            let centre = (x * l.alpha * 0.8 / variance + shift).tanh() * 0.8;
            let gain = l.alpha * spread * spread / variance;
            let x0 = centre + gain * (x - l.alpha * centre);
            if l.sigma == 0.0 {
                return 0.0;
            }
            let eps = (x - l.alpha * x0) / l.sigma;
            l.alpha * eps - l.sigma * x0
        }
    }

    fn data() -> Vec<f64> {
        normal_field(3, Stream::Start, 500, 1)
            .into_iter()
            .map(|z| if z > 0.3 { 0.8 + 0.3 * z } else { -0.8 + 0.3 * z })
            .collect()
    }

    fn error_of(n: usize, weight: f64, refinement: Refinement) -> (f64, InversionReport) {
        let mut model = toy(mixture(0.4, 0.0), mixture(0.5, 0.4));
        let s = sampler(n, weight);
        let (trajectory, report) =
            invert(&s, &data(), refinement, &mut model, |_, _| Ok(())).expect("finite");
        assert_eq!(trajectory.states.len(), n + 1);
        assert_eq!(trajectory.latent(), data());
        assert_eq!(report.calls, model.calls.iter().sum::<usize>());
        let error = round_trip_error(&s, &trajectory, &mut model, |_, _| Ok(())).expect("finite");
        (error, report)
    }

    /// Row 19 of the extremes table: plain inversion is approximate; its error is printed, finite, and
    /// shrinks with the number of steps at guidance 1.
    #[test]
    fn a_noised_source_has_the_noise_of_its_levels() {
        let levels = Schedule::standard().levels(10, Spacing::Trailing).expect("valid");
        let clean = normal_field(5, Stream::Encoder, 2500, 8);
        let noised = Trajectory::noised(&clean, &levels, 8, 6);
        assert_eq!(noised.states.len(), levels.len());
        assert_eq!(noised.latent(), clean, "the last state is the latent itself");
        for (state, level) in noised.states.iter().zip(&levels) {
            // Of data and noise with the same spread each mixture has it, too, and as much of the data as its level says.
            assert!((standard_deviation(state) - 1.0).abs() < 0.02);
            let share = state.iter().zip(&clean).map(|(a, b)| a * b).sum::<f64>() / clean.len() as f64;
            assert!((share - level.alpha).abs() < 0.03, "{share} {}", level.alpha);
        }
        assert_ne!(noised, Trajectory::noised(&clean, &levels, 8, 7));
    }

    #[test]
    fn row_19_plain_inverse_is_approximate() {
        for weight in [1.0, 3.0, 7.0] {
            let errors: Vec<f64> = [5, 10, 20, 50]
                .into_iter()
                .map(|n| {
                    let (error, report) = error_of(n, weight, Refinement::NONE);
                    println!(
                        "plain inverse, N {n}, w {weight}: round trip {error:.3e}, std {:.3}, max {:.2}, moments ok {}",
                        report.std,
                        report.max_abs,
                        report.moments_ok()
                    );
                    assert!(error.is_finite());
                    assert!(report.residual_rms.is_empty());
                    error
                })
                .collect();
            if weight == 1.0 {
                assert!(errors.windows(2).all(|e| e[1] < e[0]), "{errors:?}");
                assert!(
                    errors[0] > 1e-3,
                    "a first-order method cannot be exact: {errors:?}"
                );
            }
        }
    }

    /// Row 20 of the extremes table: the residual falls, or the step says that it fell back.
    #[test]
    fn row_20_damped_fixed_point() {
        for weight in [1.0, 3.0, 7.0] {
            for n in [2, 5, 10, 20] {
                let mut last = f64::INFINITY;
                for iterations in [1, 3, 10] {
                    let (error, report) = error_of(n, weight, Refinement::damped(iterations));
                    let worst = report.residual_rms.iter().copied().fold(0.0, f64::max);
                    println!(
                        "refined inverse, N {n}, w {weight}, {iterations} it: round trip {error:.3e}, residual {worst:.3e}, fell back {}",
                        report.fallback_steps
                    );
                    assert_eq!(report.residual_rms.len(), n);
                    assert!(report.residual_rms.iter().all(|r| r.is_finite()));
                    assert!(error.is_finite());
                    assert!(worst <= last || report.fallback_steps > 0);
                    last = worst;
                    if weight == 1.0 && n >= 5 && iterations == 10 {
                        let plain = error_of(n, weight, Refinement::NONE).0;
                        assert!(error < plain / 5.0, "N {n}: {error:e} against {plain:e}");
                    }
                }
            }
        }
        // A prediction that overshoots makes every update worse: all plain states stay, and are flagged.
        let mut wild = toy(|x, _| -50.0 * x, |_, _| 0.0);
        let s = sampler(5, 1.0);
        let (plain, _) =
            invert(&s, &[0.3, -0.2], Refinement::NONE, &mut wild, |_, _| Ok(())).expect("finite");
        let (kept, report) =
            invert(&s, &[0.3, -0.2], Refinement::damped(10), &mut wild, |_, _| Ok(())).expect("finite");
        assert_eq!((report.fallback_steps, kept), (5, plain));
        // One step from data to pure noise forgets its state: flagged, not divided by zero.
        let (_, report) = error_of(1, 1.0, Refinement::damped(3));
        assert_eq!(report.fallback_steps, 1);
        assert!(report.residual_rms[0].is_nan());
    }

    #[test]
    fn moments_are_judged_and_callbacks_end_the_run() {
        let identity_noise = normal_field(1, Stream::Start, 2500, 8);
        let report = |values: &[f64]| {
            let mut still = toy(|_, _| 0.0, |_, _| 0.0);
            let s = Sampler {
                levels: vec![NoiseLevel::CLEAN, NoiseLevel::CLEAN],
                ..sampler(1, 1.0)
            };
            invert(&s, values, Refinement::NONE, &mut still, |_, _| Ok(()))
                .expect("finite")
                .1
        };
        assert!(report(&identity_noise).moments_ok());
        let mut spiked = identity_noise.clone();
        spiked[7] = -6.5;
        assert!(!report(&spiked).moments_ok());
        let narrow: Vec<f64> = identity_noise.iter().map(|v| v * 0.5).collect();
        assert!(!report(&narrow).moments_ok());

        let mut model = toy(|x, _| x, |_, _| 0.0);
        let stop = SolverError::NotFinite { step: 99, steps: 0 };
        let ended = invert(
            &sampler(5, 1.0),
            &[1.0],
            Refinement::NONE,
            &mut model,
            |done, _| {
                if done == 2 { Err(stop) } else { Ok(()) }
            },
        );
        assert_eq!((ended, model.calls), (Err(stop), [2, 0]));
        let ended = invert(
            &sampler(5, 1.0),
            &[f64::NAN],
            Refinement::NONE,
            &mut model,
            |_, _| Ok(()),
        );
        assert_eq!(ended, Err(SolverError::NotFinite { step: 0, steps: 5 }));
    }
}
