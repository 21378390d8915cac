//! What holds of every run: the same bytes, pixels that stay, runs that end when told, and refusals in one line.

use std::ops::ControlFlow;

use super::opened;
use crate::noise::{carried, fresh, with_prior};
use crate::{
    Control, GeneratedPictures, PictureBatch, PictureRequest, Pipeline, SemanticPlanes, StableError,
    StartPictures,
};
use diffusion::solver::Guidance;

pub(super) fn go_on(_: &crate::DenoisingStep<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(super) fn request(seed: u64) -> PictureRequest<'static> {
    PictureRequest {
        steps: 4,
        ..PictureRequest::new("a road", [16, 24], seed)
    }
}

fn drawn(pipeline: &Pipeline, request: &PictureRequest<'_>) -> GeneratedPictures {
    pipeline.draw(request, go_on).expect("drawn")
}

pub(super) fn some_picture(count: usize, size: [usize; 2]) -> PictureBatch {
    let bytes: Vec<u8> = (0..count * size[0] * size[1] * 3)
        .map(|i| (i * 37 % 251) as u8)
        .collect();
    PictureBatch::from_bytes(count, size, &bytes).expect("pictures")
}

/// A worker thread may hold a model.
#[test]
fn a_model_can_go_to_another_thread() {
    fn goes<T: Send + Sync>() {}
    goes::<Pipeline>();
}

#[test]
fn the_same_request_gives_the_same_bits_on_any_number_of_threads() {
    let pipeline = opened("sd15");
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        let drawn = pool.install(|| drawn(&pipeline, &request(3)));
        drawn
            .pictures
            .rgb()
            .iter()
            .map(|v| v.to_bits())
            .collect::<Vec<_>>()
    };
    let one = bits(1);
    assert_eq!(one, bits(2));
    assert_eq!(one, bits(16));
    assert_ne!(
        drawn(&pipeline, &request(3)).pictures,
        drawn(&pipeline, &request(4)).pictures
    );
}

#[test]
fn pixels_outside_of_the_mask_stay_to_the_bit() {
    let pipeline = opened("sd15");
    let before = some_picture(1, [16, 24]);
    let mask: Vec<bool> = (0..16 * 24).map(|i| i % 24 < 7 && i / 24 > 4).collect();
    for strength in [0.5, 1.0] {
        let start = Some(StartPictures {
            pictures: &before,
            strength,
            mask: Some(&mask),
        });
        let after = drawn(&pipeline, &PictureRequest { start, ..request(1) }).pictures;
        let pairs = after
            .rgb()
            .chunks_exact(3)
            .zip(before.rgb().chunks_exact(3))
            .zip(&mask);
        let changed = pairs.clone().filter(|((a, b), anew)| **anew && a != b).count();
        assert!(pairs.clone().all(|((a, b), anew)| *anew || a == b));
        assert!(changed > 60, "{changed}");
    }
    // What is drawn depends on what stays around it.
    let other = some_picture(1, [16, 24]).rgb().iter().map(|v| -v).collect();
    let other = PictureBatch::new(1, [16, 24], other).expect("a picture");
    let inside = |pictures: &PictureBatch| {
        let start = Some(StartPictures {
            pictures,
            strength: 1.0,
            mask: Some(&mask),
        });
        let after = drawn(&pipeline, &PictureRequest { start, ..request(1) }).pictures;
        let pixels = after.rgb().chunks_exact(3).zip(&mask).filter(|(_, m)| **m);
        pixels.flat_map(|(p, _)| p.to_vec()).collect::<Vec<f32>>()
    };
    assert_ne!(inside(&before), inside(&other));
}

#[test]
fn nothing_to_draw_costs_no_call() {
    let pipeline = opened("sd15");
    let before = some_picture(1, [16, 24]);
    let nothing = vec![false; 16 * 24];
    for (strength, mask) in [(0.0, None), (1.0, Some(nothing.as_slice()))] {
        let start = Some(StartPictures {
            pictures: &before,
            strength,
            mask,
        });
        let after = drawn(&pipeline, &PictureRequest { start, ..request(1) });
        assert_eq!((after.calls, after.pictures), (0, before.clone()));
    }
}

#[test]
fn strength_keeps_or_leaves_the_picture() {
    let pipeline = opened("sd15");
    let before = some_picture(1, [16, 24]);
    let clean = pipeline.encode(&before).expect("encoded");
    let off = |strength| {
        let start = Some(StartPictures {
            pictures: &before,
            strength,
            mask: None,
        });
        let asked = PictureRequest {
            steps: 20,
            guidance: Guidance::NONE,
            start,
            ..request(2)
        };
        let after = drawn(&pipeline, &asked).latents;
        after
            .iter()
            .zip(&clean)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f32>()
    };
    assert!(off(0.1) < off(0.5) && off(0.5) < off(1.0));
}

#[test]
fn a_run_ends_when_its_watcher_says_so() {
    let pipeline = opened("sd15");
    let mut seen = Vec::new();
    let stopped = pipeline.draw(&request(1), |step| {
        seen.push((step.step, step.steps, step.clean_estimate().len()));
        match step.step {
            2 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    // PNDM calls once more than it has steps.
    assert!(matches!(stopped, Err(StableError::Stopped { step: 2, steps: 5 })));
    assert_eq!(seen, [(1, 5, 4 * 8 * 12), (2, 5, 4 * 8 * 12)]);
}

#[test]
fn guidance_of_one_and_zero_asks_one_branch() {
    let pipeline = opened("sd15");
    let with = |weight, negative: &str, prompt: &str| {
        let asked = PictureRequest {
            prompts: vec![prompt.into()],
            negative: negative.into(),
            guidance: Guidance { weight, rescale: 0.0 },
            ..request(1)
        };
        drawn(&pipeline, &asked)
    };
    assert_eq!(with(1.0, "a", "road").latents, with(1.0, "b", "road").latents);
    assert_eq!(with(0.0, "a", "road").latents, with(0.0, "a", "car").latents);
    assert_eq!(with(0.0, "road", "x").latents, with(1.0, "x", "road").latents);
    assert_eq!([with(1.0, "", "a").calls, with(7.0, "", "a").calls], [5, 10]);
}

/// A UNet without attention to views draws each as if alone, under its own text.
#[test]
fn each_view_has_its_own_text_and_noise() {
    let pipeline = opened("sd15");
    let prompts = ["a wet road", "two cars"];
    let all = drawn(
        &pipeline,
        &PictureRequest {
            views: 2,
            prompts: prompts.map(String::from).to_vec(),
            ..request(6)
        },
    );
    let half = all.noise.len() / 2;
    for (i, prompt) in prompts.iter().enumerate() {
        let part = |numbers: &[f32]| numbers[i * half..][..half].to_vec();
        let alone = drawn(
            &pipeline,
            &PictureRequest {
                prompts: vec![(*prompt).into()],
                noise: Some(part(&all.noise)),
                ..request(0)
            },
        );
        let off = super::largest_difference(&part(&all.latents), &alone.latents);
        assert!(off < 1e-4, "{prompt}: {off}");
    }
}

#[test]
fn a_control_is_heard_as_loud_and_as_long_as_asked() {
    let pipeline = opened("sd15");
    let picture: Vec<f32> = (0..3 * 16 * 24).map(|i| (i % 7) as f32 / 7.0).collect();
    let with = |scale, during| {
        let controls = vec![Control {
            scale,
            during,
            ..Control::new(0, &picture)
        }];
        drawn(
            &pipeline,
            &PictureRequest {
                controls,
                ..request(1)
            },
        )
        .latents
    };
    let silent = drawn(&pipeline, &request(1)).latents;
    assert_eq!(with(0.0, [0.0, 1.0]), silent);
    assert_eq!(with(1.0, [0.0, 0.0]), silent);
    let loud = with(1.0, [0.0, 1.0]);
    assert_ne!(loud, silent);
    let early = with(1.0, [0.0, 0.5]);
    assert!(early != loud && early != silent);
}

#[test]
fn a_reference_frame_comes_back_and_is_heard() {
    let folders = crate::Folders {
        unet: super::folder("ring").join("unet_add_zero_linear_2"),
        controls: Vec::new(),
        ..crate::Folders::from_base(&super::folder("ring"))
    };
    let pipeline = Pipeline::open(&folders, &crate::Machine::cpu()).expect("a model");
    assert!(pipeline.unet().hears_frames());
    let size = [8, 14];
    let mask: Vec<bool> = (0..12 * 8 * 14).map(|i| i >= 6 * 8 * 14).collect();
    let with = |pictures: &PictureBatch| {
        let asked = PictureRequest {
            views: 6,
            frames: 2,
            steps: 2,
            size,
            start: Some(StartPictures {
                pictures,
                strength: 1.0,
                mask: Some(&mask),
            }),
            ..request(1)
        };
        drawn(&pipeline, &asked)
    };
    let one = some_picture(12, size);
    let other: Vec<f32> = one.rgb().iter().map(|v| v * 0.5).collect();
    let other = PictureBatch::new(12, size, other).expect("pictures");
    let (a, b) = (with(&one), with(&other));
    let half = 6 * 8 * 14 * 3;
    assert_eq!(a.pictures.rgb()[..half], one.rgb()[..half]);
    assert_ne!(a.pictures.rgb()[half..], b.pictures.rgb()[half..]);
}

#[test]
fn noise_that_is_carried_stays_white() {
    let size = [1, 4, 20, 30];
    let (before, new) = (fresh(1, 0, size), fresh(1, 1, size));
    // One to the right; two cells that name the same; one that is new.
    let mut from: Vec<Option<u32>> = (0..600).map(|i| (i % 30 != 0).then(|| i as u32 - 1)).collect();
    from[5] = from[4];
    let moved = carried(&before, &from, &new, size).expect("carried");
    assert_eq!(moved[1], before[0]);
    assert_eq!(moved[600 + 31], before[600 + 30]);
    assert_eq!((moved[5], moved[0]), (new[5], new[0]));
    let variance = moved.iter().map(|v| v * v).sum::<f32>() / moved.len() as f32;
    assert!((variance - 1.0).abs() < 0.1, "{variance}");
    let error = carried(&before, &vec![Some(600); 600], &new, size).expect_err("no such cell");
    assert_eq!(
        error.to_string(),
        "cell of the frame before is 600, expected less than 600"
    );
    assert_eq!(
        with_prior(&[1.0, 2.0], &[10.0, 0.0], 0.03).expect("a prior"),
        [1.3, 2.0]
    );
    // Fixed by seed, frame and place.
    assert_eq!(fresh(1, 0, [2, 4, 20, 30])[..4 * 600], before);
    assert!(fresh(u64::MAX, u32::MAX, size).iter().all(|v| v.is_finite()));
}

#[test]
fn bytes_come_back_as_they_were() {
    let bytes: Vec<u8> = (0..=255).flat_map(|b| [b, b, b]).collect();
    let pictures = PictureBatch::from_bytes(1, [16, 16], &bytes).expect("a picture");
    assert_eq!(pictures.to_bytes(), bytes);
    assert!(PictureBatch::from_bytes(2, [16, 16], &bytes).is_err());
    assert!(PictureBatch::new(1, [1, 1], vec![f32::NAN; 3]).is_err());
    assert!(PictureBatch::new(usize::MAX, [8192, 8192], vec![]).is_err());
}

/// Cards compute in 16 bits: the same path on the processor.
#[test]
fn sixteen_bits_stay_near_thirty_two() {
    let half = crate::Machine {
        dtype: candle_core::DType::F16,
        ..crate::Machine::cpu()
    };
    for (model, size, views) in [("sd15", [16, 24], 1), ("ring", [8, 14], 6)] {
        let folders = crate::Folders::from_base(&super::folder(model));
        let rough = Pipeline::open(&folders, &half).expect("a model");
        let exact = opened(model);
        let picture: Vec<f32> = (0..3 * 16 * 24).map(|i| (i % 7) as f32 / 7.0).collect();
        let ids: Vec<f32> = (0..6 * 9 * 4 * 7).map(|i| (i % 17) as f32).collect();
        let planes = SemanticPlanes {
            ids: &ids,
            scale: 1.0,
        };
        let asked = PictureRequest {
            size,
            views,
            controls: (views == 1)
                .then(|| Control::new(0, &picture))
                .into_iter()
                .collect(),
            planes: (views > 1).then_some(planes),
            guidance: Guidance::NONE,
            ..request(9)
        };
        let (a, b) = (drawn(&rough, &asked).latents, drawn(&exact, &asked).latents);
        let (off, size) = a.iter().zip(&b).fold((0.0, 0.0), |(off, size), (a, b)| {
            (off + (a - b).powi(2), size + b * b)
        });
        let relative = (off / size).sqrt();
        println!("| {model} | 16 beside 32 bits, relative | {relative:.1e} |");
        assert!(relative > 0.0 && relative < 0.02, "{model}: {relative}");
    }
}
