//! What is refused: damaged weights, sizes, ids, numbers that are none; and what must not be.

use std::path::PathBuf;

use safetensors::{SafeTensors, tensor::TensorView};

use super::*;

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
    let (nets, size) = (nets(), RingSize::new(2, [16, 32]).expect("a size"));
    let cells = 2 * size.view_cells();
    let x = uniform(cells * 8, 5);
    for depth in [0.0f32, -0.0, -4.0, 1e-30, 1e-4, 0.3, 1e6, 9e29] {
        let mut condition = condition(size);
        condition.depth_m.fill(depth);
        let told = nets.dit.tell(&condition).expect("a depth");
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
            nets.dit.v(&x, 500.0, &told, Some(&before)).expect("finite");
        }
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        let mut condition = condition(size);
        condition.depth_m[70] = bad;
        let expected = |what: &str| format!("{what}: value 70 is {bad}, expected finite numbers below 1e30");
        let error = nets.dit.tell(&condition).expect_err("not finite").to_string();
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
    let sampling = |steps| PictureSampling {
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
