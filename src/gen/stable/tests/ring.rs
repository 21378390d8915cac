//! What SyntheOcc adds, beside the script's own words for it.

use std::ops::ControlFlow;

use super::{Golden, folder, opened};
use crate::config::UnetConfig;
use crate::{Extra, Folders, Machine, PictureRequest, Pipeline, SemanticPlanes, Unet, Weights};
use diffusion::solver::Guidance;

fn request<'a>(golden: &'a Golden) -> PictureRequest<'a> {
    PictureRequest {
        negative: "blur".into(),
        steps: 5,
        views: 6,
        guidance: Guidance {
            weight: 7.0,
            rescale: 0.0,
        },
        noise: Some(golden.numbers("run.noise").to_vec()),
        planes: Some(SemanticPlanes {
            ids: golden.numbers("mpi"),
            scale: 1.0,
        }),
        ..PictureRequest::new("A wet road, it's dawn; two cars", [8, 14], 0)
    }
}

#[test]
fn parity_of_neighbours() {
    let golden = Golden::open("ring/golden.safetensors");
    let context = golden.tensor("context");
    for (name, at, frames) in [
        ("unet_add_zero_linear_1", "unet", 1),
        ("unet_concat_gated_1", "unet_concat_gated_1", 1),
        ("unet_add_none_1", "unet_add_none_1", 1),
        ("unet_add_zero_linear_2", "unet_add_zero_linear_2", 2),
    ] {
        let at = folder("ring").join(at);
        let config = UnetConfig::read(&at.join("config.json")).expect("a configuration");
        let weights = Weights::of_folder(&at).expect("weights");
        let unet = Unet::load(config, &weights, &Machine::cpu()).expect("a network");
        let x = golden.tensor(&format!("{name}.x"));
        let out = unet
            .forward(&x, 300.0, &context, &Extra::default(), frames)
            .expect("computed");
        golden.compare("ring", &format!("{name}.out"), &out);
    }
}

#[test]
fn parity_of_planes() {
    let golden = Golden::open("ring/golden.safetensors");
    let pipeline = opened("ring");
    let encoder = pipeline.mpi.as_ref().expect("an encoder");
    golden.compare(
        "ring",
        "encoded",
        &encoder.forward(&golden.tensor("mpi")).expect("encoded"),
    );
}

/// Both ways in which planes come in: that of the released code, and that of the paper.
#[test]
fn parity_of_six_views() {
    let golden = Golden::open("ring/golden.safetensors");
    let all = Folders::from_base(&folder("ring"));
    let released = Folders {
        mpi: None,
        ..all.clone()
    };
    let paper = Folders {
        controls: Vec::new(),
        ..all
    };
    for (name, folders) in [("control", released), ("encoder", paper)] {
        let pipeline = Pipeline::open(&folders, &Machine::cpu()).expect("a model");
        assert_eq!((pipeline.plane_channels(), pipeline.unet().views()), (Some(9), 6));
        let drawn = pipeline
            .draw(&request(&golden), |_| ControlFlow::Continue(()))
            .expect("drawn");
        golden.compare_numbers("ring", &format!("run.{name}.latents"), &drawn.latents);
    }
}

#[test]
fn views_and_frames_hear_their_neighbours_alone() {
    let at = folder("ring").join("unet_add_zero_linear_2");
    let config = UnetConfig::read(&at.join("config.json")).expect("a configuration");
    let weights = Weights::of_folder(&at).expect("weights");
    let unet = Unet::load(config, &weights, &Machine::cpu()).expect("a network");
    let golden = Golden::open("ring/golden.safetensors");
    let (x, context) = (
        golden.tensor("unet_add_zero_linear_2.x"),
        golden.tensor("context"),
    );
    let said = |x: &candle_core::Tensor, frames| {
        unet.forward(x, 300.0, &context, &Extra::default(), frames)
            .expect("computed")
    };
    // Frames without attention between them are drawn as if alone.
    let alone = said(&x.narrow(0, 0, 6).expect("a frame"), 1);
    let together = said(&x, 2).narrow(0, 0, 6).expect("a frame");
    let off = |a: &candle_core::Tensor, b: &candle_core::Tensor| {
        let [a, b] = [a, b].map(|t| t.flatten_all().and_then(|t| t.to_vec1::<f32>()).expect("numbers"));
        super::largest_difference(&a, &b)
    };
    assert!(off(&alone, &together) > 1e-3);
    // A batch that does not hold whole frames is refused.
    for (count, frames) in [(5, 1), (7, 1), (6, 2), (12, 0)] {
        let x = x.narrow(0, 0, count).expect("some");
        let error = unet
            .forward(&x, 300.0, &context, &Extra::default(), frames)
            .expect_err("refused");
        assert!(error.to_string().starts_with("number of latents is"), "{error}");
    }
}
