//! Schedules, solvers and inversions against `tests/reference/schedulers.json`: trajectories made with
//! diffusers 0.42.1 (torch 2.15.0, float32 tables) and by an independent float64 implementation, on the
//! closed-form model tanh(0.7 x + 0.001 t). Tolerances are those of the file's `meta`: relative to
//! max(1, max|x|) of the run, 1e-9 for `f64_final`, max(1e-5, 4 gap) for diffusers (its tables are f32).

use diffusion::inversion::{Refinement, invert, round_trip_error};
use diffusion::schedule::{Betas, NoiseLevel, Schedule, Spacing};
use diffusion::solver::{Branch, Denoiser, Guidance, Prediction, Sampler, SolverError, SolverKind};
use serde::Deserialize;

#[derive(Deserialize)]
struct File {
    meta: Meta,
    alpha_bar: std::collections::BTreeMap<String, Table>,
    runs: Vec<Run>,
}

#[derive(Deserialize)]
struct Meta {
    x_init: Vec<f64>,
    train_steps: usize,
}

#[derive(Deserialize)]
struct Table {
    t: Vec<usize>,
    alpha_bar: Vec<f64>,
}

#[derive(Deserialize)]
struct Run {
    solver: String,
    betas: String,
    prediction: String,
    spacing: String,
    n: usize,
    timesteps: Vec<usize>,
    steps: Vec<usize>,
    diffusers: Vec<Vec<f64>>,
    f64_final: Vec<f64>,
    gap: f64,
}

impl Run {
    fn name(&self) -> String {
        format!(
            "{} {} {} {} N {}",
            self.solver, self.betas, self.prediction, self.spacing, self.n
        )
    }
}

fn reference() -> File {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/schedulers.json");
    let text = std::fs::read_to_string(path).expect("the reference file");
    serde_json::from_str(&text).expect("its format")
}

fn schedule(betas: &str, train_steps: usize, zero_snr: bool) -> Schedule {
    let betas = match betas {
        "linear" => Betas::Linear {
            first: 1e-4,
            last: 0.02,
        },
        "scaled_linear" => Betas::ScaledLinear {
            first: 0.00085,
            last: 0.012,
        },
        "cosine" => Betas::Cosine,
        other => panic!("betas {other}"),
    };
    Schedule::new(betas, train_steps, zero_snr).expect("valid")
}

struct Closed;

impl Denoiser for Closed {
    type Error = SolverError;
    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, SolverError> {
        assert_eq!(branch, Branch::Conditional);
        Ok(x.iter().map(|x| (0.7 * x + 0.001 * t).tanh()).collect())
    }
}

fn largest(state: &[f64]) -> f64 {
    state.iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// alpha_bar of every schedule, relative to its own value. The reference makes its cosine betas by a
/// subtraction that costs it a few digits.
#[test]
fn row_05_alpha_bar_tables() {
    let file = reference();
    let mut worst = 0.0f64;
    for (name, table) in &file.alpha_bar {
        let (betas, zero_snr) = match name.strip_suffix("_zero_snr") {
            Some(betas) => (betas, true),
            None => (name.as_str(), false),
        };
        let schedule = schedule(betas, file.meta.train_steps, zero_snr);
        for (t, expected) in table.t.iter().zip(&table.alpha_bar) {
            let found = schedule.level(*t).log_alpha_bar.exp();
            let error = (found - expected).abs() / expected.max(f64::MIN_POSITIVE);
            worst = worst.max(error);
            assert!(error <= 1e-9, "{name}, t {t}: {found:e}, expected {expected:e}");
        }
    }
    println!("alpha_bar: worst relative deviation {worst:.1e}");
    assert_eq!(file.alpha_bar.len(), 6);
}

/// All runs: DDIM and its inverse, DPM-Solver++(2M), UniPC; N 2 to 50, three schedules, two spacings (and
/// even steps in log SNR), noise and v prediction, zero terminal SNR.
#[test]
fn row_05_solvers() {
    let file = reference();
    let (mut runs, mut worst_f64, mut worst_share) = (0, (0.0f64, String::new()), 0.0f64);
    for run in &file.runs {
        let solver = match run.solver.as_str() {
            "ddim" | "ddim_zero_snr" | "ddim_inverse" => SolverKind::Ddim,
            "dpmpp_2m" | "dpmpp_2m_uniform_lambda" => SolverKind::DpmPp2M,
            "unipc_bh2" => SolverKind::UniPc,
            other => panic!("solver {other}"),
        };
        let inverse = run.solver == "ddim_inverse";
        let schedule = schedule(&run.betas, file.meta.train_steps, run.solver == "ddim_zero_snr");
        let levels = match run.spacing.as_str() {
            "trailing" => schedule.levels(run.n, Spacing::Trailing),
            "leading" => schedule.levels(run.n, Spacing::Leading),
            "uniform_lambda" => Ok(even_in_log_snr(&schedule, &run.timesteps)),
            other => panic!("spacing {other}"),
        };
        let levels = levels.expect("valid");
        let mut timesteps: Vec<usize> = levels[..run.n].iter().map(|l| l.t as usize).collect();
        if inverse {
            timesteps.reverse();
        }
        assert_eq!(timesteps, run.timesteps, "{}", run.name());
        let sampler = Sampler {
            solver,
            levels,
            prediction: match run.prediction.as_str() {
                "epsilon" => Prediction::Epsilon,
                "v_prediction" => Prediction::V,
                other => panic!("prediction {other}"),
            },
            guidance: Guidance::NONE,
        };
        // States in the order of the walk, without the start.
        let path: Vec<Vec<f64>> = if inverse {
            let (trajectory, report) = invert(
                &sampler,
                &file.meta.x_init,
                Refinement::NONE,
                &mut Closed,
                |_, _| Ok(()),
            )
            .expect("finite");
            assert_eq!(report.calls, run.n);
            trajectory.states.into_iter().rev().skip(1).collect()
        } else {
            let states = sampler.sample(file.meta.x_init.clone(), &mut Closed, |_| Ok(()));
            states.expect("finite").into_iter().skip(1).collect()
        };
        let scale = path.iter().fold(1.0, |m: f64, x| m.max(largest(x)));
        let error = distance(&path[run.n - 1], &run.f64_final) / scale;
        if error > worst_f64.0 {
            worst_f64 = (error, run.name());
        }
        assert!(error <= 1e-9, "{}: {error:e} from f64_final", run.name());
        let tolerance = (4.0 * run.gap).max(1e-5);
        for (step, expected) in run.steps.iter().zip(&run.diffusers) {
            let error = distance(&path[*step], expected) / scale;
            worst_share = worst_share.max(error / tolerance);
            assert!(
                error <= tolerance,
                "{}, step {step}: {error:e} from diffusers",
                run.name()
            );
        }
        runs += 1;
    }
    println!(
        "{runs} runs: worst distance from f64_final {:.1e} ({}), from diffusers {worst_share:.2} of the tolerance",
        worst_f64.0, worst_f64.1
    );
    // 3 schedules x 5 N x (2 predictions x (2 spacings x 2 directions + 3 multistep) + zero SNR).
    assert_eq!(runs, 225);
}

/// Levels evenly spaced in log(sigma / alpha) from the noisiest to the cleanest step, then clean data; the
/// network is shown `timesteps`.
fn even_in_log_snr(schedule: &Schedule, timesteps: &[usize]) -> Vec<NoiseLevel> {
    let log_ratio = |t: usize| {
        let level = schedule.level(t);
        (level.sigma / level.alpha).ln()
    };
    let (first, last) = (log_ratio(schedule.train_steps() - 1), log_ratio(0));
    let n = timesteps.len();
    let mut levels: Vec<NoiseLevel> = timesteps
        .iter()
        .enumerate()
        .map(|(i, t)| {
            let log_ratio = first + (last - first) * i as f64 / (n - 1) as f64;
            // alpha^2 = 1 / (1 + ratio^2)
            NoiseLevel::from_log_alpha_bar(*t as f64, -(2.0 * log_ratio).exp().ln_1p())
        })
        .collect();
    levels.push(NoiseLevel::CLEAN);
    levels
}

#[derive(Deserialize)]
struct ObelmFile {
    meta: ObelmMeta,
    runs: Vec<ObelmRun>,
}

#[derive(Deserialize)]
struct ObelmMeta {
    x_init: Vec<f64>,
}

#[derive(Deserialize)]
struct ObelmRun {
    model: String,
    grid: String,
    n: usize,
    timesteps: Vec<usize>,
    x_noise: Vec<f64>,
    sample_x: Vec<f64>,
    inverse_end_x0: Vec<f64>,
    inverse_end_x1: Vec<f64>,
    max_abs_inverted: f64,
    exact_sample_x: Option<Vec<f64>>,
}

/// The two closed-form models of obelm.json, as noise predictions.
struct ObelmModel<'a> {
    gauss: bool,
    schedule: &'a Schedule,
}

impl Denoiser for ObelmModel<'_> {
    type Error = SolverError;
    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, SolverError> {
        let l = self.schedule.level(t as usize);
        let variance = l.alpha * l.alpha * 0.25 + l.sigma * l.sigma;
        let noise = |x: &f64| {
            if self.gauss {
                l.sigma * (x - l.alpha * 0.3) / variance
            } else {
                (0.7 * x + 0.001 * t).tanh()
            }
        };
        Ok(x.iter().map(noise).collect())
    }
}

/// Rows 21 and 23 of the extremes table: O-BELM against obelm.json (own float64 program, checked with mpmath
/// 1.3.0 at 40 digits); samples 1e-10, inverted states 1e-9 of the largest, round trip 1e-11, second order.
#[test]
fn row_21_and_23_obelm() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/obelm.json");
    let file: ObelmFile = serde_json::from_str(&std::fs::read_to_string(path).expect("the reference file"))
        .expect("its format");
    let schedule = schedule("linear", 1000, false);
    let mut order: Vec<(usize, f64)> = Vec::new();
    for run in &file.runs {
        let name = format!("{} {} N {}", run.model, run.grid, run.n);
        let gauss = run.model == "gauss";
        let sampler = Sampler {
            solver: SolverKind::OBelm,
            // The file ends at t = 0, not at clean data.
            levels: run.timesteps.iter().map(|t| schedule.level(*t)).collect(),
            prediction: Prediction::Epsilon,
            guidance: Guidance::NONE,
        };
        let mut model = ObelmModel {
            gauss,
            schedule: &schedule,
        };
        let states = sampler
            .sample(run.x_noise.clone(), &mut model, |_| Ok(()))
            .expect("finite");
        let error = distance(&states[run.n], &run.sample_x) / largest(&run.sample_x).max(1.0);
        assert!(error <= 1e-10, "{name}: sample {error:e}");
        if let Some(exact) = run.exact_sample_x.as_ref().filter(|_| run.grid == "t") {
            order.push((run.n, distance(&states[run.n], exact)));
        }
        let (trajectory, report) = invert(
            &sampler,
            &file.meta.x_init,
            Refinement::NONE,
            &mut model,
            |_, _| Ok(()),
        )
        .expect("finite");
        assert_eq!(report.calls, run.n);
        for (state, expected) in trajectory
            .states
            .iter()
            .zip([&run.inverse_end_x0, &run.inverse_end_x1])
        {
            let error = distance(state, expected) / run.max_abs_inverted.max(1.0);
            assert!(error <= 1e-9, "{name}: inverse {error:e}");
        }
        let error = round_trip_error(&sampler, &trajectory, &mut model, |_, _| Ok(())).expect("finite");
        assert!(error <= 1e-11, "{name}: round trip {error:e}");
    }
    println!("O-BELM, distance from the exact flow: {order:?}");
    for pair in order.windows(2) {
        let ((n, error), (more, less)) = (pair[0], pair[1]);
        let halvings = (more as f64 / n as f64).log2();
        assert!(
            less / error <= 0.35f64.powf(halvings),
            "N {n} to {more}: {error:e} to {less:e}"
        );
    }
}

/// Row 8 of the extremes table for DPM-Solver++(2M), and UniPC with it: second order on Gaussian data, finite
/// where a step is far longer than the one before, first order at both ends.
#[test]
fn row_08_second_order_solvers() {
    let schedule = schedule("linear", 1000, false);
    let gauss = |levels: &[NoiseLevel], solver| {
        let mut model = ObelmModel {
            gauss: true,
            schedule: &schedule,
        };
        let sampler = Sampler {
            solver,
            levels: levels.to_vec(),
            prediction: Prediction::Epsilon,
            guidance: Guidance::NONE,
        };
        let states = sampler.sample(vec![1.0], &mut model, |_| Ok(())).expect("finite");
        // The exact flow from the first level to the last one with noise.
        let (a, b) = (levels[0], levels[levels.len() - 1]);
        let spread = |l: &NoiseLevel| (l.alpha * l.alpha * 0.25 + l.sigma * l.sigma).sqrt();
        let exact = b.alpha * 0.3 + (1.0 - a.alpha * 0.3) * spread(&b) / spread(&a);
        (states[levels.len() - 1][0] - exact).abs()
    };
    // Twelve and more even steps in log SNR between two noisy levels.
    let grid = |n: usize| -> Vec<NoiseLevel> {
        let of = |t: usize| (schedule.level(t).sigma / schedule.level(t).alpha).ln();
        let mut at: Vec<usize> = Vec::new();
        for i in 0..=n {
            let wanted = of(950) + (of(150) - of(950)) * i as f64 / n as f64;
            let near = |t: &usize| ((of(*t) - wanted).abs() * 1e9) as u64;
            at.extend((150..=950).min_by_key(near));
        }
        at.dedup();
        at.into_iter().map(|t| schedule.level(t)).collect()
    };
    for solver in [SolverKind::DpmPp2M, SolverKind::UniPc] {
        for n in [20, 40] {
            let ratio = gauss(&grid(2 * n), solver) / gauss(&grid(n), solver);
            assert!(ratio <= 0.35, "{} N {n}: {ratio}", solver.name());
        }
        // Steps of very unequal length, both ways.
        let uneven = [999, 998, 500, 499, 498, 3, 2, 1].map(|t| schedule.level(t));
        assert!(gauss(&uneven, solver).is_finite());
        // Equal levels are passed through.
        let twice = [900, 500, 500, 100].map(|t| schedule.level(t));
        assert!(gauss(&twice, solver).is_finite());
        // Out of pure noise, and N = 1 and 2.
        for n in [1, 2, 3, 10] {
            let sampler = Sampler::standard(solver, n, Guidance::NONE).expect("valid");
            let states = sampler.sample(vec![0.7, -3.0], &mut Closed, |_| Ok(()));
            assert!(states.expect("finite")[n].iter().all(|v| v.abs() < 10.0));
        }
    }
}
