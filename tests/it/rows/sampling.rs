//! Rows 5, 21 and 22: solvers against a plain program of their own, and the exact inversion.

use diffusion::inversion::{Refinement, invert, round_trip_error};
use diffusion::schedule::{Betas, NoiseLevel, Schedule, Spacing};
use diffusion::solver::{Branch, Denoiser, Guidance, Prediction, Sampler, SolverError, SolverKind};
use numeric::philox::{Stream, normal_field};

const N: [usize; 6] = [1, 2, 5, 10, 20, 50];

fn betas() -> [Betas; 3] {
    [
        Betas::Linear {
            first: 1e-4,
            last: 0.02,
        },
        Betas::ScaledLinear {
            first: 0.00085,
            last: 0.012,
        },
        Betas::Cosine,
    ]
}

/// A closed-form network with two branches, in f64 or as f32 computes it.
struct Closed {
    single: bool,
}

impl Denoiser for Closed {
    type Error = SolverError;
    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, SolverError> {
        let (gain, shift) = match branch {
            Branch::Conditional => (0.7, 0.001),
            Branch::Unconditional => (0.6, 0.0008),
        };
        let one = |x: &f64| match self.single {
            true => f64::from((gain as f32 * *x as f32 + shift as f32 * t as f32).tanh()),
            false => (gain * x + shift * t).tanh(),
        };
        Ok(x.iter().map(one).collect())
    }
}

/// The same DDIM sampler written down plainly: running products, timesteps by numpy's formulas.
fn plain_ddim(betas: Betas, n: usize, spacing: Spacing, prediction: Prediction, start: &[f64]) -> Vec<f64> {
    let t_all = 1000.0;
    let beta = |i: usize| {
        let u = i as f64 / 999.0;
        match betas {
            Betas::Linear { first, last } => first + (last - first) * u,
            Betas::ScaledLinear { first, last } => (first.sqrt() + (last.sqrt() - first.sqrt()) * u).powi(2),
            Betas::Cosine => {
                let bar = |s: f64| ((s + 0.008) / 1.008 * std::f64::consts::FRAC_PI_2).cos().powi(2);
                (1.0 - bar((i + 1) as f64 / t_all) / bar(i as f64 / t_all)).min(0.999)
            }
        }
    };
    let bars: Vec<f64> = (0..1000)
        .scan(1.0, |product, i| {
            *product *= 1.0 - beta(i);
            Some(*product)
        })
        .collect();
    let count = n as f64;
    let steps: Vec<usize> = (0..n)
        .map(|i| match spacing {
            Spacing::Trailing => (t_all - i as f64 * t_all / count).round_ties_even() as usize - 1,
            Spacing::Leading => (n - 1 - i) * (1000 / n),
            // linspace(0, 999, N) backwards; of one point it is the first.
            Spacing::Linspace if n == 1 => 0,
            Spacing::Linspace => ((n - 1 - i) as f64 * 999.0 / (count - 1.0)).round_ties_even() as usize,
        })
        .collect();
    let mut x = start.to_vec();
    for (i, t) in steps.iter().enumerate() {
        let bar = bars[*t];
        let next = steps.get(i + 1).map_or(1.0, |t| bars[*t]);
        let out = Closed { single: false }.predict(&x, *t as f64, Branch::Conditional);
        for (x, p) in x.iter_mut().zip(out.expect("closed form")) {
            let (clean, noise) = match prediction {
                Prediction::Epsilon => ((*x - (1.0 - bar).sqrt() * p) / bar.sqrt(), p),
                Prediction::V => (
                    bar.sqrt() * *x - (1.0 - bar).sqrt() * p,
                    bar.sqrt() * p + (1.0 - bar).sqrt() * *x,
                ),
            };
            *x = next.sqrt() * clean + (1.0 - next).sqrt() * noise;
        }
    }
    x
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(1.0f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / scale
}

/// Row 5 for what the golden tables of `tests/diffusion.rs` leave out: one step, and evenly spaced ones. f64 within 1e-6,
/// with a network in f32 within 2e-5.
#[test]
fn row_05_every_spacing_and_one_step() {
    let start = normal_field(5, Stream::Start, 16, 1);
    let (mut worst, mut worst_single) = (0.0f64, 0.0f64);
    for betas in betas() {
        for spacing in [Spacing::Trailing, Spacing::Leading, Spacing::Linspace] {
            for prediction in [Prediction::Epsilon, Prediction::V] {
                for n in N {
                    let schedule = Schedule::new(betas, 1000, false).expect("valid");
                    let sampler = Sampler {
                        solver: SolverKind::Ddim,
                        levels: schedule.levels(n, spacing).expect("valid"),
                        prediction,
                        guidance: Guidance::NONE,
                    };
                    let truth = plain_ddim(betas, n, spacing, prediction, &start);
                    let found = |single: bool| {
                        let states = sampler.sample(start.clone(), &mut Closed { single }, |_| Ok(()));
                        gap(&states.expect("finite")[n], &truth)
                    };
                    let (double, single) = (found(false), found(true));
                    let name = format!("{betas:?} {spacing:?} {prediction:?} N {n}");
                    assert!(double <= 1e-6, "{name}: {double:e}");
                    assert!(single <= 2e-5, "{name}, f32 network: {single:e}");
                    (worst, worst_single) = (worst.max(double), worst_single.max(single));
                }
            }
        }
    }
    println!("worst {worst:.1e}, with a network in f32 {worst_single:.1e}");
}

/// Levels even in log SNR between the noisiest and the cleanest training step of the linear schedule.
fn even_in_log_snr(n: usize) -> Vec<NoiseLevel> {
    let schedule = Schedule::new(betas()[0], 1000, false).expect("valid");
    let log_ratio = |t: usize| (schedule.level(t).sigma / schedule.level(t).alpha).ln();
    let (first, last) = (log_ratio(999), log_ratio(0));
    let level = |i: usize| {
        let wanted = first + (last - first) * i as f64 / n as f64;
        let near = |t: &usize| ((log_ratio(*t) - wanted).abs() * 1e12) as u64;
        let t = (0..1000).min_by_key(near).unwrap_or(0);
        NoiseLevel::from_log_alpha_bar(t as f64, -(2.0 * wanted).exp().ln_1p())
    };
    (0..=n).map(level).collect()
}

fn exact(n: usize, on_log_snr: bool, weight: f64) -> Sampler {
    let guidance = Guidance { weight, rescale: 0.0 };
    match on_log_snr {
        false => Sampler::standard(SolverKind::OBelm, n, guidance).expect("valid"),
        true => Sampler {
            solver: SolverKind::OBelm,
            levels: even_in_log_snr(n),
            prediction: Prediction::Epsilon,
            guidance,
        },
    }
}

/// Row 21: the round trip by N and grid. At guidance 1 within 1e-12 in f64 and 1e-5 with a network in f32, at 7 within
/// 1e-9.
#[test]
fn row_21_round_trip() {
    let data = normal_field(21, Stream::Start, 400, 1);
    for on_log_snr in [false, true] {
        for n in [2, 3, 5, 10, 20, 50] {
            for (weight, single, most) in [(1.0, false, 1e-12), (1.0, true, 1e-5), (7.0, false, 1e-9)] {
                let sampler = exact(n, on_log_snr, weight);
                let mut model = Closed { single };
                let name = format!("log SNR {on_log_snr}, N {n}, w {weight}, f32 {single}");
                let (trajectory, report) =
                    invert(&sampler, &data, Refinement::NONE, &mut model, |_, _| Ok(())).expect("finite");
                let error =
                    round_trip_error(&sampler, &trajectory, &mut model, |_, _| Ok(())).expect("finite");
                println!(
                    "{name}: {error:.1e}, std {:.2}, max {:.1}",
                    report.std, report.max_abs
                );
                assert!(error <= most, "{name}: {error:e}");
            }
        }
    }
}

/// Row 22: few steps on the grid even in log SNR blow the noise up, and the report says so, as wherever its moments are
/// not those of a draw; noise that could have been drawn is not flagged.
#[test]
fn row_22_moments_are_flagged() {
    let data = normal_field(22, Stream::Start, 2500, 1);
    let (_, report) = invert(
        &exact(5, true, 1.0),
        &data,
        Refinement::NONE,
        &mut Closed { single: false },
        |_, _| Ok(()),
    )
    .expect("finite");
    println!("N 5, log SNR: std {:.2}, max {:.1}", report.std, report.max_abs);
    assert!(report.max_abs >= 6.0 && !report.moments_ok());
    /// For data N(0, 1) the exact v is 0.
    struct Still;
    impl Denoiser for Still {
        type Error = SolverError;
        fn predict(&mut self, x: &[f64], _: f64, _: Branch) -> Result<Vec<f64>, SolverError> {
            Ok(vec![0.0; x.len()])
        }
    }
    let (mut fine, mut flagged) = (0, 0);
    for solver in [SolverKind::Ddim, SolverKind::OBelm] {
        for n in [1, 2, 3, 5, 10, 20, 50, 200] {
            let sampler = Sampler::standard(solver, n, Guidance::NONE).expect("valid");
            let (trajectory, report) =
                invert(&sampler, &data, Refinement::NONE, &mut Still, |_, _| Ok(())).expect("finite");
            let noise = trajectory.noise();
            let mean = noise.iter().sum::<f64>() / 2500.0;
            let std = (noise.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 2500.0).sqrt();
            let most = noise.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            println!(
                "{} N {n}: std {std:.3}, max {most:.2}, {}",
                solver.name(),
                report.moments_ok()
            );
            assert!((report.std - std).abs() < 1e-9 && report.max_abs == most);
            assert_eq!(report.moments_ok(), (0.9..=1.1).contains(&std) && most < 6.0);
            *if report.moments_ok() {
                &mut fine
            } else {
                &mut flagged
            } += 1;
        }
    }
    assert!(fine > 0 && flagged > 0, "{fine} fine, {flagged} flagged");
}
