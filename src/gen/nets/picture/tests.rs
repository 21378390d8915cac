//! Against the numbers of the twin.

mod refusals;

use std::ops::ControlFlow;
use std::time::Instant;

use super::*;
use crate::twin::{TOLERANCE, Twin, uniform};

const TWIN: Twin = Twin("pictures");
const PIXELS: [usize; 2] = [32, 64];
const VIEWS: usize = 6;

/// The bytes of a shipped file.
fn file(name: &str) -> Vec<u8> {
    match name == FILES[0] {
        true => assets::weights::PICTURES_VAE.to_vec(),
        false => assets::weights::PICTURES_DIT.to_vec(),
    }
}

fn nets() -> Arc<PictureNets> {
    PictureNets::bundled().expect("the shipped weights")
}

/// Inputs as `golden` of training/export_pictures.py makes them.
fn condition(size: RingSize) -> Condition {
    let count = size.views() * size.view_pixels();
    let classes: Vec<u8> = (0..count).map(|i| (i * 7 / 13 % 20) as u8).collect();
    let facing = |(i, class): (usize, &u8)| match class {
        1..11 => (1 + i % 16 + if i % 5 == 0 { 128 } else { 0 }) as u8,
        _ => 0,
    };
    let cameras = uniform(size.views() * CAMERA_NUMBERS, 2);
    Condition {
        size,
        facings: classes.iter().enumerate().map(facing).collect(),
        classes,
        depth_m: (0..count).map(|i| (i * 11 % 997) as f32 * 0.05).collect(),
        time: Some(2),
        weather: Some(3),
        cameras: cameras.as_chunks().0.to_vec(),
    }
}

fn size() -> RingSize {
    RingSize::new(VIEWS, PIXELS).expect("a size")
}

/// The camera stood 0.8 m behind and 0.1 m to the right.
fn motion() -> Motion {
    Motion {
        focal_px: [40.0, 40.0],
        center_px: [4.2 * 8.0, 1.9 * 8.0],
        then_from_now: [[1.0, 0.0, 0.0, -0.1], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.8]],
    }
}

fn before(size: RingSize, depth_m: &[f32]) -> WarpedLatents {
    let [_, width] = size.pixels();
    let mirrored = depth_m.chunks_exact(width).flat_map(|row| row.iter().rev());
    let mirrored: Vec<f32> = mirrored.copied().collect();
    let latents = uniform(size.views() * size.view_cells() * 8, 4);
    warp(size, &latents, [depth_m, &mirrored], &[motion(); VIEWS]).expect("finite inputs")
}

fn go_on(_: diffusion::solver::StepView<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn vae_against_the_twin() {
    let (nets, size) = (nets(), size());
    let pictures: Vec<f32> = uniform(VIEWS * size.view_pixels() * 3, 3)
        .iter()
        .map(|v| v / 1.75)
        .collect();
    TWIN.compare("latent", &nets.vae.encode(&pictures, PIXELS).expect("finite"));
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    TWIN.compare("picture", &nets.vae.decode(&x, size.cells()).expect("finite"));
    let segmenter = PictureSegmenter::bundled().expect("the shipped weights");
    let first = &pictures[..size.view_pixels() * 3];
    let logits = segmenter.logits(first, PIXELS).expect("finite");
    TWIN.compare("segmented", &logits);
    let classes = segmenter.classes(first, PIXELS).expect("finite");
    let of_pixel = &logits[77 * SHOWN..78 * SHOWN];
    assert!(of_pixel.iter().all(|l| *l <= of_pixel[usize::from(classes[77])]));
}

#[test]
fn windows_are_told_apart_by_what_they_show() {
    let segmenter = PictureSegmenter::bundled().expect("the shipped weights");
    let sides = [128, 192];
    let grey = vec![0.1; 128 * 192 * 3];
    let plain = segmenter.features(&grey, sides).expect("finite");
    // Two rows and three columns of 8 cells.
    assert_eq!(plain.len(), 6);
    let mut marked = grey.clone();
    for row in 90..100 {
        for column in 150..160 {
            marked[(row * 192 + column) * 3] = 0.9;
        }
    }
    let seen = segmenter.features(&marked, sides).expect("finite");
    let apart = |i: usize| -> f64 { plain[i].iter().zip(&seen[i]).map(|(a, b)| (a - b).abs()).sum() };
    let most = (0..6).max_by(|a, b| apart(*a).total_cmp(&apart(*b)));
    assert_eq!(most, Some(5), "the last window shows it");
    assert_eq!(apart(0), 0.0);
    assert!(segmenter.features(&grey[1..], sides).is_err());
    assert!(segmenter.features(&vec![f32::NAN; 128 * 192 * 3], sides).is_err());
}

#[test]
fn transformer_against_the_twin() {
    let (nets, size) = (nets(), size());
    let dit = &nets.dit;
    let condition = condition(size);
    let told = dit.tell(&condition).expect("a condition");
    let cells: Vec<f32> = told.cells.iter().flat_map(|map| map.data.clone()).collect();
    TWIN.compare("told", &cells);
    let before = before(size, &condition.depth_m);
    TWIN.compare("before", before.numbers());
    let seen = before.numbers().chunks_exact(35).filter(|c| c[34] == 1.0).count();
    assert!(seen > 0 && seen < VIEWS * size.view_cells(), "{seen} cells seen");
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    for (name, before) in [("v_alone", None), ("v_after", Some(&before))] {
        let each = [0.0, 437.5, 999.0].map(|t| dit.v(&x, t, &told, before).expect("finite"));
        TWIN.compare(name, &each.concat());
    }
    let silent = dit.silent(&told).expect("finite");
    TWIN.compare("v_silent", &dit.v(&x, 437.5, &silent, None).expect("finite"));

    let mut sampling = PictureSampling {
        told: &told,
        silent: None,
        before: Some(&before),
        steps: 8,
        guidance: 1.0,
    };
    let made = dit.sample(&x, &sampling, go_on).expect("finite");
    TWIN.compare("sampled", &made.latent_f32());
    (sampling.steps, sampling.guidance) = (4, 2.0);
    let mut seen = Vec::new();
    let made = dit.sample(&x, &sampling, |view| {
        seen.push(view.step);
        ControlFlow::Continue(())
    });
    assert_eq!(seen, [1, 2, 3, 4]);
    let made = made.expect("finite");
    TWIN.compare("sampled_guided", &made.latent_f32());
    sampling.silent = Some(&silent);
    assert_eq!(dit.sample(&x, &sampling, go_on).expect("finite"), made);
    let stopped = dit.sample(&x, &sampling, |_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(ModelError::Stopped { step: 1, steps: 4 }));
}

/// What is not painted again stays at every step, to the bit; the same again is the same again.
#[test]
fn some_cells_are_painted_again() {
    let (nets, size) = (nets(), size());
    let (mut condition, dit) = (condition(size), &nets.dit);
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    let told = dit.tell(&condition).expect("a condition");
    let sampling = |told| PictureSampling {
        told,
        silent: None,
        before: None,
        steps: 2,
        guidance: 2.0,
    };
    let first = dit.sample(&x, &sampling(&told), go_on).expect("finite");
    let mask: Vec<bool> = (0..VIEWS * size.view_cells()).map(|i| i % 5 == 0).collect();
    let again = dit
        .resample(&first, &mask, &sampling(&told), go_on)
        .expect("finite");
    assert!(again == first, "nothing else was told");
    condition.classes.iter_mut().for_each(|c| *c = (*c + 1) % 20);
    let other = dit.tell(&condition).expect("a condition");
    let changed = dit
        .resample(&first, &mask, &sampling(&other), go_on)
        .expect("finite");
    for (old, new) in first.states.iter().zip(&changed.states).skip(1) {
        for (cell, (old, new)) in old.chunks(8).zip(new.chunks(8)).enumerate() {
            assert_eq!(old == new, !mask[cell], "cell {cell}");
        }
    }
    let stopped = dit.resample(&first, &mask, &sampling(&other), |_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(ModelError::Stopped { step: 1, steps: 2 }));
    let mut more = sampling(&other);
    more.steps = 3;
    assert!(
        dit.resample(&first, &mask, &more, go_on).is_err(),
        "steps of another run"
    );
}

/// The comparison can fail: views that are confused, or left and right exchanged, differ by more than it allows.
#[test]
fn neighbours_and_the_frame_before_are_heard() {
    let (nets, size) = (nets(), size());
    let dit = &nets.dit;
    let mut told = dit.tell(&condition(size)).expect("a condition");
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    let gap = |told: &EncodedCondition| {
        let v = dit.v(&x, 437.5, told, None).expect("finite");
        let all = TWIN.numbers("v_alone");
        crate::golden::gap(&v, &all[v.len()..2 * v.len()])
    };
    assert!(gap(&told) <= TOLERANCE);
    let alone = TWIN.numbers("v_alone");
    let after = TWIN.numbers("v_after");
    let differing = alone.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert!(differing * 2 > alone.len(), "{differing}");
    told.cells.swap(0, 3);
    assert!(gap(&told) > 100.0 * TOLERANCE, "views are confused");
    told.cells.swap(0, 3);
    // Left and right changed places.
    told.cells.reverse();
    told.light.reverse();
    let numbers = size.view_cells() * 8;
    let reversed: Vec<f32> = x.chunks_exact(numbers).rev().flatten().copied().collect();
    let v = dit.v(&reversed, 437.5, &told, None).expect("finite");
    let v: Vec<f32> = v.chunks_exact(numbers).rev().flatten().copied().collect();
    let all = TWIN.numbers("v_alone");
    let gap = crate::golden::gap(&v, &all[v.len()..2 * v.len()]);
    assert!(gap > 10.0 * TOLERANCE, "left and right are the same: {gap}");
}

/// Seconds of a frame: run with `--ignored --nocapture`.
#[test]
#[ignore = "takes seconds; prints times"]
fn seconds_of_a_frame() {
    let start = Instant::now();
    let nets = nets();
    println!("load: {:.2} s", start.elapsed().as_secs_f64());
    let size = RingSize::new(VIEWS, [144, 256]).expect("a size");
    let condition = condition(size);
    let before = before(size, &condition.depth_m);
    let noise = uniform(VIEWS * size.view_cells() * 8, 1);
    for round in 0..3 {
        let timed =
            |what: &str, start: Instant| println!("{round} {what}: {:.2} s", start.elapsed().as_secs_f64());
        let start = Instant::now();
        let told = nets.dit.tell(&condition).expect("a condition");
        timed("tell", start);
        let start = Instant::now();
        let v = nets.dit.v(&noise, 500.0, &told, Some(&before)).expect("finite");
        timed("one call", start);
        assert_eq!(v.len(), noise.len());
        let start = Instant::now();
        let sampling = PictureSampling {
            told: &told,
            silent: None,
            before: Some(&before),
            steps: 4,
            guidance: 2.0,
        };
        let latents = nets.dit.sample(&noise, &sampling, go_on).expect("finite");
        timed("4 steps with guidance 2", start);
        let start = Instant::now();
        let pictures = nets
            .vae
            .decode(&latents.latent_f32(), size.cells())
            .expect("finite");
        timed("decode", start);
        let start = Instant::now();
        nets.vae.encode(&pictures, size.pixels()).expect("finite");
        timed("encode", start);
    }
}
