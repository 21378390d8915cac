//! Schedulers beside those of diffusers, with a formula in place of a network.

use super::{Golden, folder, largest_difference};
use crate::config::{SchedulerConfig, SchedulerKind};
use crate::sampling::{SamplingPlan, Solver};

#[derive(serde::Deserialize)]
struct Case {
    kind: String,
    steps: usize,
    config: SchedulerConfig,
}

fn cases() -> Vec<Case> {
    let bytes = std::fs::read(folder("schedules.json")).expect("the cases");
    serde_json::from_slice(&bytes).expect("cases")
}

fn run(plan: &SamplingPlan, start: &[f32]) -> Vec<f32> {
    let mut x: Vec<f64> = start.iter().map(|v| f64::from(*v) * plan.spread).collect();
    let mut solver = Solver::new(plan);
    for (k, call) in plan.calls.iter().enumerate() {
        let said: Vec<f64> = x
            .iter()
            .map(|x| (x * 1.3 + call.at.t / 1000.0).cos() * 0.7)
            .collect();
        x = solver.advance(k, &x, &said).expect("a step");
    }
    x.iter().map(|v| *v as f32).collect()
}

#[test]
fn parity_of_schedulers() {
    let golden = Golden::open("schedules.safetensors");
    let start = golden.numbers("schedule.start");
    let mut worst: std::collections::BTreeMap<String, (f32, usize)> = Default::default();
    let mut wrong = Vec::new();
    for (i, case) in cases().iter().enumerate() {
        let plan = SamplingPlan::new(&case.config, case.config.kind, case.steps, 1.0).expect("a plan");
        let expected = golden.numbers(&format!("schedule.case.{i}"));
        // Without a network nothing bounds a state: what is large is compared with its size.
        let size = expected.iter().fold(1.0f32, |most, v| most.max(v.abs()));
        let off = largest_difference(&run(&plan, start), expected) / size;
        let entry = worst.entry(case.kind.clone()).or_default();
        *entry = (entry.0.max(off), entry.1 + 1);
        if off.is_nan() || off > super::TOLERANCE {
            wrong.push(format!("{i} {}: {off}; {:?}", case.kind, case.config));
        }
    }
    for (kind, (off, count)) in worst {
        println!("| schedulers | {kind}, {count} runs | {off:.1e} |");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_number_of_steps_is_a_plan_or_an_error() {
    let config = &cases()[0].config;
    for kind in SchedulerKind::ALL {
        for steps in [
            0,
            1,
            2,
            3,
            49,
            50,
            333,
            499,
            500,
            501,
            999,
            1000,
            1001,
            usize::MAX,
        ] {
            for strength in [0.0, 0.3, 1.0, -0.1, f64::NAN] {
                let Ok(plan) = SamplingPlan::new(config, kind, steps, strength) else {
                    continue;
                };
                assert!((0.0..=1.0).contains(&strength) && (1..=1000).contains(&steps));
                let x = run(&plan, &[0.3, -1.0]);
                assert!(x.iter().all(|v| v.is_finite()), "{kind:?} {steps} {strength}");
            }
        }
        assert!(SamplingPlan::new(config, kind, 20, 1.0).is_ok());
        assert!(SamplingPlan::new(config, kind, 0, 1.0).is_err());
    }
}

#[test]
fn pure_noise_is_survived() {
    let text = r#"{"_class_name": "DDIMScheduler", "beta_schedule": "scaled_linear", "beta_start": 0.00085, "beta_end": 0.012,
        "timestep_spacing": "trailing", "rescale_betas_zero_snr": true, "prediction_type": "v_prediction"}"#;
    let config: SchedulerConfig = serde_json::from_str(text).expect("a scheduler");
    for kind in SchedulerKind::ALL {
        for steps in [1, 2, 4, 20] {
            let plan = SamplingPlan::new(&config, kind, steps, 1.0).expect("a plan");
            assert!(
                run(&plan, &[1.0, -2.0])
                    .iter()
                    .all(|v| v.is_finite() && v.abs() < 20.0),
                "{kind:?} {steps}"
            );
        }
    }
    // A noise prediction cannot leave pure noise.
    let text = text.replace("v_prediction", "epsilon");
    let config: SchedulerConfig = serde_json::from_str(&text).expect("a scheduler");
    let plan = SamplingPlan::new(&config, SchedulerKind::Ddim, 4, 1.0).expect("a plan");
    let error = Solver::new(&plan)
        .advance(0, &[1.0], &[1.0])
        .expect_err("no signal")
        .to_string();
    assert!(
        error.starts_with("noise prediction cannot leave t = 999"),
        "{error}"
    );
}
