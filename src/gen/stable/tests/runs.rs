//! Whole runs beside the pipelines of diffusers.

use std::ops::ControlFlow;

use super::{Golden, opened};
use crate::config::SchedulerKind;
use crate::noise::noised;
use crate::sampling::{SamplingPlan, Solver};
use crate::{Control, PictureRequest};
use diffusion::solver::Guidance;

const PROMPT: &str = "A wet road, it's dawn; two cars";

/// What the script asks for.
fn request(weight: f64, rescale: f64, noise: &[f32]) -> PictureRequest<'static> {
    PictureRequest {
        negative: "blur".into(),
        steps: 5,
        guidance: Guidance { weight, rescale },
        noise: Some(noise.to_vec()),
        ..PictureRequest::new(PROMPT, [16, 16], 0)
    }
}

const KINDS: [(&str, SchedulerKind); 5] = [
    ("ddim", SchedulerKind::Ddim),
    ("pndm", SchedulerKind::Pndm),
    ("dpm", SchedulerKind::DpmPp),
    ("euler", SchedulerKind::Euler),
    ("unipc", SchedulerKind::UniPc),
];

#[test]
fn parity_of_text_to_picture() {
    let golden = Golden::open("sd15/golden.safetensors");
    let pipeline = opened("sd15");
    for (name, kind) in KINDS {
        let asked = PictureRequest {
            scheduler: Some(kind),
            ..request(7.5, 0.0, golden.numbers("run.noise"))
        };
        let drawn = pipeline
            .draw(&asked, |_| ControlFlow::Continue(()))
            .expect("drawn");
        golden.compare_numbers("sd15", &format!("run.{name}.latents"), &drawn.latents);
        let expected = golden.tensor(&format!("run.{name}.picture"));
        let expected = crate::PictureBatch::of_tensor(&expected).expect("a picture");
        let off = super::largest_difference(drawn.pictures.rgb(), expected.rgb());
        println!("| sd15 | run.{name}.picture | {off:.1e} |");
        assert!(off <= super::TOLERANCE, "{name}: {off}");
    }
}

#[test]
fn parity_of_v_prediction_with_rescaled_guidance() {
    let golden = Golden::open("sd21/golden.safetensors");
    let pipeline = opened("sd21");
    let asked = request(5.0, 0.7, golden.numbers("run.noise"));
    let drawn = pipeline
        .draw(&asked, |_| ControlFlow::Continue(()))
        .expect("drawn");
    golden.compare_numbers("sd21", "run.ddim.latents", &drawn.latents);
}

#[test]
fn parity_of_control_run() {
    let golden = Golden::open("sd15/golden.safetensors");
    let pipeline = opened("sd15");
    let asked = PictureRequest {
        scheduler: Some(SchedulerKind::Ddim),
        controls: vec![Control {
            scale: 0.7,
            ..Control::new(0, golden.numbers("control.hint"))
        }],
        ..request(7.5, 0.0, golden.numbers("run.noise"))
    };
    let drawn = pipeline
        .draw(&asked, |_| ControlFlow::Continue(()))
        .expect("drawn");
    golden.compare_numbers("sd15", "run.control.latents", &drawn.latents);
}

/// The script gives latents in place of pictures, which diffusers takes as they are.
#[test]
fn parity_of_picture_to_picture() {
    let golden = Golden::open("sd15/golden.safetensors");
    let pipeline = opened("sd15");
    let words = |text: &str| {
        pipeline
            .words
            .ids(text, 77)
            .and_then(|ids| pipeline.text.encode(&ids))
    };
    let (told, negative) = (words(PROMPT).expect("told"), words("blur").expect("told"));
    let guidance = Guidance {
        weight: 7.5,
        rescale: 0.0,
    };
    for (name, kind) in KINDS.into_iter().filter(|(name, _)| *name != "pndm") {
        let plan = SamplingPlan::new(&pipeline.scheduler, kind, 5, 0.6).expect("a plan");
        assert_eq!(plan.calls.len(), 3);
        let [clean, noise] = ["again.latents", "again.noise"].map(|n| golden.numbers(n));
        let mut x = noised(clean, noise, &plan.calls[0].at);
        let mut solver = Solver::new(&plan);
        for (k, call) in plan.calls.iter().enumerate() {
            let small: Vec<f32> = x.iter().map(|v| *v as f32).collect();
            let tensor = candle_core::Tensor::from_vec(small, (1, 4, 8, 8), &candle_core::Device::Cpu);
            let tensor = tensor.expect("latents");
            let said = |context| -> Vec<f64> {
                let said = pipeline
                    .unet
                    .forward(&tensor, call.at.t, context, &Default::default(), 1);
                let said = said.expect("said").flatten_all().and_then(|t| t.to_vec1::<f32>());
                said.expect("numbers").into_iter().map(f64::from).collect()
            };
            let said = guidance.combine(&said(&told), &said(&negative));
            x = solver.advance(k, &x, &said).expect("a step");
        }
        let found: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        golden.compare_numbers("sd15", &format!("again.{name}"), &found);
    }
}
