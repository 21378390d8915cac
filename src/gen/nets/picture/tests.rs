//! Against the numbers of the twin, and what is refused.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use safetensors::{Dtype, SafeTensors, tensor::TensorView};

use super::*;

const FOLDER: &str = "../../../training/weights/pictures";
const PIXELS: [usize; 2] = [32, 64];
const VIEWS: usize = 6;
/// Largest difference, as a share of the largest number of the twin.
const TOLERANCE: f64 = 1e-4;

fn file(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(name);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn nets() -> PictureNets {
    PictureNets::from_dir(&PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(FOLDER)).expect("weights")
}

/// Numbers from -1.75 to 1.75 as training/export.py makes them.
fn uniform(count: usize, stream: u64) -> Vec<f32> {
    let number = |i: u64| {
        let h = (i * 2_654_435_761 + stream * 40_503 + 12_345) % (1 << 32);
        let h = (h ^ (h >> 15)) * 2_246_822_519 % (1 << 32);
        (h as f64 / 4_294_967_296.0 * 3.5 - 1.75) as f32
    };
    (0..count as u64).map(number).collect()
}

/// Expected outputs by name.
struct Golden(Vec<u8>);

impl Golden {
    fn open() -> Self {
        Self(file("golden.safetensors"))
    }

    fn f64(&self, name: &str) -> Vec<f64> {
        let file = SafeTensors::deserialize(&self.0).expect("a safetensors file");
        let tensor = file.tensor(name).expect("a tensor of the golden");
        assert_eq!(tensor.dtype(), Dtype::F32, "{name}");
        let (quads, _) = tensor.data().as_chunks::<4>();
        quads.iter().map(|q| f64::from(f32::from_le_bytes(*q))).collect()
    }

    /// Prints the largest difference and fails if it is too large.
    fn compare(&self, name: &str, found: &[f32]) {
        let gap = crate::golden::gap(found, &self.f64(name));
        println!("{name}: {gap:.1e} of the largest number");
        assert!(gap <= TOLERANCE, "{name}: {gap}, expected at most {TOLERANCE}");
    }
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

fn before(size: RingSize, depth_m: &[f32]) -> Before {
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
    let (golden, nets, size) = (Golden::open(), nets(), size());
    let pictures: Vec<f32> = uniform(VIEWS * size.view_pixels() * 3, 3)
        .iter()
        .map(|v| v / 1.75)
        .collect();
    golden.compare("latent", &nets.vae.encode(&pictures, PIXELS).expect("finite"));
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    golden.compare("picture", &nets.vae.decode(&x, size.cells()).expect("finite"));
}

#[test]
fn transformer_against_the_twin() {
    let (golden, dit, size) = (Golden::open(), nets().dit, size());
    let condition = condition(size);
    let told = dit.tell(&condition).expect("a condition");
    let cells: Vec<f32> = told.cells.iter().flat_map(|map| map.data.clone()).collect();
    golden.compare("told", &cells);
    let before = before(size, &condition.depth_m);
    golden.compare("before", before.numbers());
    let seen = before.numbers().chunks_exact(35).filter(|c| c[34] == 1.0).count();
    assert!(seen > 0 && seen < VIEWS * size.view_cells(), "{seen} cells seen");
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    for (name, before) in [("v_alone", None), ("v_after", Some(&before))] {
        let each = [0.0, 437.5, 999.0].map(|t| dit.v(&x, t, &told, before).expect("finite"));
        golden.compare(name, &each.concat());
    }
    let silent = dit.silent(&told).expect("finite");
    golden.compare("v_silent", &dit.v(&x, 437.5, &silent, None).expect("finite"));

    let mut sampling = Sampling {
        told: &told,
        silent: None,
        before: Some(&before),
        steps: 8,
        guidance: 1.0,
    };
    golden.compare("sampled", &dit.sample(&x, &sampling, go_on).expect("finite"));
    (sampling.steps, sampling.guidance) = (4, 2.0);
    let mut seen = Vec::new();
    let made = dit.sample(&x, &sampling, |view| {
        seen.push(view.step);
        ControlFlow::Continue(())
    });
    assert_eq!(seen, [1, 2, 3, 4]);
    let made = made.expect("finite");
    golden.compare("sampled_guided", &made);
    sampling.silent = Some(&silent);
    assert_eq!(dit.sample(&x, &sampling, go_on).expect("finite"), made);
    let stopped = dit.sample(&x, &sampling, |_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(ModelError::Stopped { step: 1, steps: 4 }));
}

/// The comparison can fail: views that are confused, or left and right exchanged, differ by more than it allows.
#[test]
fn neighbours_and_the_frame_before_are_heard() {
    let (golden, dit, size) = (Golden::open(), nets().dit, size());
    let mut told = dit.tell(&condition(size)).expect("a condition");
    let x = uniform(VIEWS * size.view_cells() * 8, 1);
    let gap = |told: &Told| {
        let v = dit.v(&x, 437.5, told, None).expect("finite");
        let all = golden.f64("v_alone");
        crate::golden::gap(&v, &all[v.len()..2 * v.len()])
    };
    assert!(gap(&told) <= TOLERANCE);
    let alone = golden.f64("v_alone");
    let after = golden.f64("v_after");
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
    let all = golden.f64("v_alone");
    let gap = crate::golden::gap(&v, &all[v.len()..2 * v.len()]);
    assert!(gap > 10.0 * TOLERANCE, "left and right are the same: {gap}");
}

/// The bytes of a file with a tensor left out, or of another shape, or with a number that is none.
fn damaged(name: &str, tensor: &str, how: &str) -> Vec<u8> {
    let bytes = file(name);
    let parsed = SafeTensors::deserialize(&bytes).expect("a safetensors file");
    let (_, header) = SafeTensors::read_metadata(&bytes).expect("a header");
    let nan: Vec<u8> = match parsed.tensor(tensor) {
        Ok(view) => [&half_nan(), &view.data()[2..]].concat(),
        Err(_) => Vec::new(),
    };
    let views = parsed.tensors().into_iter().filter_map(|(at, view)| {
        let (shape, data) = (view.shape().to_vec(), view.data());
        let view = match (at == tensor, how) {
            (true, "missing") => return None,
            (true, "misshapen") => {
                let count = shape.iter().product();
                TensorView::new(
                    view.dtype(),
                    vec![count],
                    parsed.tensor(tensor).expect("there").data(),
                )
            }
            (true, "nan") => TensorView::new(view.dtype(), shape, &nan),
            _ => TensorView::new(view.dtype(), shape, &bytes[offset(&bytes, data)..][..data.len()]),
        };
        Some((at, view.expect("data of that shape")))
    });
    safetensors::serialize(views.collect::<Vec<_>>(), header.metadata().clone()).expect("serializable")
}

fn half_nan() -> [u8; 2] {
    [0x00, 0x7e]
}

fn offset(all: &[u8], part: &[u8]) -> usize {
    part.as_ptr() as usize - all.as_ptr() as usize
}

/// Row 62 of the extremes table: weights that are missing, misshapen, not finite, cut, or another network's.
#[test]
fn row_62_weights() {
    let (vae, dit) = (file(FILES[0]), file(FILES[1]));
    let refusal = |vae: &[u8], dit: &[u8]| match PictureNets::parse(vae, dit) {
        Ok(_) => "accepted".to_owned(),
        Err(error) => error.to_string(),
    };
    let of_dit = |tensor: &str, how| refusal(&vae, &damaged(FILES[1], tensor, how));
    let of_vae = |tensor: &str, how| refusal(&damaged(FILES[0], tensor, how), &dit);
    assert_eq!(
        of_dit("blocks.3.side", "missing"),
        "dit.safetensors: tensor \"blocks.3.side\" is missing, expected shape [2, 224]"
    );
    assert_eq!(
        of_dit("told.facings.weight", "misshapen"),
        "dit.safetensors: tensor \"told.facings.weight\": expected shape [17, 12], found [204]"
    );
    assert!(of_dit("camera.weight", "nan").contains("\"camera.weight\": value 0 is NaN"));
    assert_eq!(
        of_vae("encoder_head.bias", "missing"),
        "vae.safetensors: tensor \"encoder_head.bias\" is missing, expected shape [16]"
    );
    assert_eq!(
        of_vae("up.1.weight", "misshapen"),
        "vae.safetensors: tensor \"up.1.weight\": expected shape [256, 96, 1, 1], found [24576]"
    );
    assert_eq!(
        refusal(&dit, &dit),
        "vae.safetensors: metadata \"kind\": expected picture_vae, found picture_dit"
    );
    for cut in [0, 7, 4096, dit.len() - 1] {
        let error = refusal(&vae, &dit[..cut]);
        assert!(error.starts_with("dit.safetensors: not a usable") && !error.contains('\n'));
    }
    let nowhere = PathBuf::from("/nowhere/vae.safetensors");
    let error = PictureVae::load(&nowhere).map(|_| ()).expect_err("no file");
    assert!(error.to_string().starts_with("/nowhere/vae.safetensors: "));
}

/// Rows 37 and 44: depths that are none, negative, huge or no number; cameras that stand still, turn around or have no lens.
#[test]
fn rows_37_44_depths() {
    let (dit, size) = (nets().dit, RingSize::new(2, [16, 32]).expect("a size"));
    let cells = 2 * size.view_cells();
    let x = uniform(cells * 8, 5);
    for depth in [0.0f32, -0.0, -4.0, 1e-30, 1e-4, 0.3, 1e6, 9e29] {
        let mut condition = condition(size);
        condition.depth_m.fill(depth);
        let told = dit.tell(&condition).expect("a depth");
        let here = &told.cells[0].data;
        assert!(here.iter().all(|v| v.is_finite()), "{depth}");
        let depths = [&condition.depth_m[..], &condition.depth_m];
        let turned = [[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]];
        let still = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        for (then_from_now, focal) in [(still, 20.0), (turned, 20.0), (still, 0.0), (turned, 1e-30)] {
            let motion = Motion {
                focal_px: [focal; 2],
                center_px: [16.0, 8.0],
                then_from_now,
            };
            let before = warp(size, &x, depths, &[motion; 2]).expect("finite inputs");
            assert!(before.numbers().iter().all(|v| v.is_finite()), "{depth} {focal}");
            let flags = before.numbers().chunks_exact(35).map(|c| c[34]);
            let seen = flags.filter(|f| *f == 1.0).count();
            // What is near is not projected; what has no depth is far away, and stays where it is.
            let near = depth > 0.0 && depth <= 0.1;
            let expected = (then_from_now == still && focal == 20.0 && !near) as usize * cells;
            assert_eq!(seen, expected, "{depth} {focal}");
            dit.v(&x, 500.0, &told, Some(&before)).expect("finite");
        }
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        let mut condition = condition(size);
        condition.depth_m[70] = bad;
        let expected = |what: &str| format!("{what}: value 70 is {bad}, expected finite numbers below 1e30");
        let error = dit.tell(&condition).expect_err("not finite").to_string();
        assert_eq!(error, expected("depth"));
        let depth_m = &condition.depth_m[..];
        let good = vec![1.0; depth_m.len()];
        let motions = [motion(); 2];
        let error = warp(size, &x, [&good, depth_m], &motions).expect_err("not finite");
        assert_eq!(error.to_string(), expected("depth before"));
        let mut noise = x.clone();
        noise[70] = bad;
        let error = warp(size, &noise, [&good, &good], &motions).expect_err("not finite");
        assert_eq!(error.to_string(), expected("latent before"));
    }
}

#[test]
fn refuses_sizes_and_ids() {
    let size = RingSize::new(1, [16, 16]).expect("a size");
    for (views, pixels) in [
        (0, [16, 16]),
        (65, [16, 16]),
        (1, [0, 16]),
        (1, [24, 16]),
        (1, [16, 8208]),
    ] {
        let error = RingSize::new(views, pixels).expect_err("no size").to_string();
        assert!(error.contains(", expected ") && !error.contains('\n'), "{error}");
    }
    let nets = nets();
    let refusal = |change: fn(&mut Condition)| {
        let mut condition = condition(size);
        change(&mut condition);
        nets.dit
            .tell(&condition)
            .map(|_| ())
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        refusal(|c| c.classes[3] = 20),
        "largest class id is 20, expected 0 to 19"
    );
    assert!(refusal(|c| c.facings[3] = 0x80 + 17).starts_with("largest facing is 17"));
    assert_eq!(refusal(|c| c.time = Some(4)), "time of day is 4, expected 0 to 3");
    assert_eq!(refusal(|c| c.weather = Some(6)), "weather is 6, expected 0 to 5");
    assert_eq!(refusal(|c| c.cameras.clear()), "cameras has 0 values, expected 1");
    assert_eq!(
        refusal(|c| c.classes.truncate(255)),
        "classes has 255 values, expected 256"
    );
    // What is not told is no error.
    let mut condition = condition(size);
    (condition.time, condition.weather) = (None, None);
    let told = nets.dit.tell(&condition).expect("a condition");
    let x = uniform(4 * 8, 1);
    for t in [-1.0, 1000.0, f32::NAN] {
        assert!(matches!(
            nets.dit.v(&x, t, &told, None),
            Err(ModelError::Timestep(_))
        ));
    }
    assert!(nets.dit.v(&x[1..], 1.0, &told, None).is_err());
    let sampling = |steps| Sampling {
        told: &told,
        silent: None,
        before: None,
        steps,
        guidance: 1.0,
    };
    for steps in [0, 1001] {
        assert!(nets.dit.sample(&x, &sampling(steps), go_on).is_err());
    }
    assert!(nets.dit.sample(&x, &sampling(1), go_on).is_ok());
    assert!(nets.vae.encode(&[0.0; 3 * 64], [8, 9]).is_err());
    assert!(nets.vae.encode(&[0.0; 3 * 65], [8, 8]).is_err());
    assert!(nets.vae.encode(&[f32::NAN; 3 * 64], [8, 8]).is_err());
    assert!(nets.vae.decode(&[0.0; 9], [1, 1]).is_err() && nets.vae.decode(&[], [1, 0]).is_err());
    assert_eq!(
        nets.vae.encode(&[0.0; 3 * 64], [8, 8]).expect("a picture").len(),
        8
    );
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
        let sampling = Sampling {
            told: &told,
            silent: None,
            before: Some(&before),
            steps: 4,
            guidance: 2.0,
        };
        let latents = nets.dit.sample(&noise, &sampling, go_on).expect("finite");
        timed("4 steps with guidance 2", start);
        let start = Instant::now();
        let pictures = nets.vae.decode(&latents, size.cells()).expect("finite");
        timed("decode", start);
        let start = Instant::now();
        nets.vae.encode(&pictures, size.pixels()).expect("finite");
        timed("encode", start);
    }
}
