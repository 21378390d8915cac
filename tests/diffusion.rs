//! Schedules, DDIM and its inversion against `tests/reference/schedulers.json`: trajectories made with
//! diffusers 0.42.1 (torch 2.15.0, float32 tables) and by an independent float64 implementation, on the
//! closed-form model tanh(0.7 x + 0.001 t). Tolerances are those of the file's `meta`: relative to
//! max(1, max|x|) of the run, 1e-9 for `f64_final`, max(1e-5, 4 gap) for diffusers (its tables are f32).

use sceneloom::generation::inversion::{Refinement, invert};
use sceneloom::generation::schedule::{Betas, Schedule, Spacing};
use sceneloom::generation::solver::{Branch, Denoiser, Guidance, Prediction, Sampler, SolverError};
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

/// All DDIM and inverse DDIM runs: N 2 to 50, three schedules, two spacings, noise and v prediction,
/// and zero terminal SNR.
#[test]
fn row_05_ddim_and_its_inverse() {
    let file = reference();
    let (mut runs, mut worst_f64, mut worst_share) = (0, (0.0f64, String::new()), 0.0f64);
    for run in &file.runs {
        let (inverse, zero_snr) = match run.solver.as_str() {
            "ddim" => (false, false),
            "ddim_zero_snr" => (false, true),
            "ddim_inverse" => (true, false),
            _ => continue, // other solvers come with another step
        };
        let spacing = match run.spacing.as_str() {
            "trailing" => Spacing::Trailing,
            "leading" => Spacing::Leading,
            other => panic!("spacing {other}"),
        };
        let schedule = schedule(&run.betas, file.meta.train_steps, zero_snr);
        let mut timesteps = schedule.timesteps(run.n, spacing).expect("valid");
        if inverse {
            timesteps.reverse();
        }
        assert_eq!(timesteps, run.timesteps, "{}", run.name());
        let sampler = Sampler {
            levels: schedule.levels(run.n, spacing).expect("valid"),
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
    // 3 schedules x 5 N x (2 predictions x 2 spacings x 2 directions + zero SNR).
    assert_eq!(runs, 135);
}
