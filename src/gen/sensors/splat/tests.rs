//! Rows 37 to 42 and 44 of the extremes table, on projection and rendering.

use glam::DVec3;

use super::*;
use scene::Class;

/// At the origin, looking along ego x, `fov_deg` wide.
fn camera(width: u32, height: u32, fov_deg: f64) -> Camera {
    let focal = f64::from(width) / 2.0 / (fov_deg.to_radians() / 2.0).tan();
    Camera {
        name: "TEST".into(),
        width,
        height,
        focal_px: [focal; 2],
        center_px: [f64::from(width) / 2.0, f64::from(height) / 2.0],
        rotation_wxyz: [0.5, -0.5, 0.5, -0.5],
        translation_m: [0.0; 3],
        ..Camera::new("TEST", fov_deg)
    }
}

fn gaussian(position_m: [f32; 3], std_m: f32, opacity: f32, id: u8) -> Gaussian {
    Gaussian {
        position_m,
        std_m,
        opacity,
        id,
    }
}

fn draw(gaussians: &[Gaussian], camera: &Camera, options: &SplatOptions) -> RawMaps {
    let cloud = GaussianCloud::from_gaussians(gaussians.to_vec());
    render_raw(&cloud, camera, camera.width, camera.height, options)
}

/// Options under which each Gaussian counts, however thin.
fn open() -> SplatOptions {
    SplatOptions {
        alpha_min: 0.0,
        alpha_max: 0.999,
        ..SplatOptions::default()
    }
}

/// So large that it covers the image evenly.
fn sheet(depth_m: f32, opacity: f32, id: u8) -> Gaussian {
    gaussian([depth_m, 0.0, 0.0], 1e6, opacity, id)
}

#[test]
fn row_37_projection() {
    let camera = camera(64, 48, 90.0);
    let view = SplatCamera::new(&camera, 64, 48, 1.3);
    for x in [
        0.0,
        -0.0,
        1e-7,
        -1e-7,
        -1e-30,
        -5.0,
        -1e6,
        f64::NAN,
        f64::NEG_INFINITY,
    ] {
        assert_eq!(
            view.project(DVec3::new(x, 0.1, 0.1), 0.2, 0.0, 1e9).is_some(),
            x == 1e-7
        );
        assert_eq!(view.project(DVec3::new(x, 0.1, 0.1), 0.2, 0.2, 1e9), None);
        assert_eq!(
            view.project(DVec3::new(x, 0.1, 0.1), 0.2, -10.0, 1e9).is_some(),
            x == 1e-7
        );
        let maps = draw(
            &[gaussian([x as f32, 0.1, 0.1], 0.2, 1.0, 4)],
            &camera,
            &SplatOptions::default(),
        );
        assert!(maps.coverage.iter().all(|&c| c == 0.0), "drawn from x = {x}");
    }
    assert_eq!(
        view.project(DVec3::new(f64::INFINITY, 0.0, 0.0), 0.2, 0.2, 1e9),
        None
    );
    assert_eq!(view.project(DVec3::X, f64::NAN, 0.2, 1e9), None);
    // There and back, from a hand's breadth to a thousand kilometres.
    for depth in [0.201, 1.0, 7.3, 150.0, 1e6] {
        for (u, v) in [(0.1, 0.2), (31.9, 47.7), (63.5, 0.5), (-20.0, 90.0)] {
            let (fx, fy) = (camera.focal_px[0], camera.focal_px[1]);
            let (x, y) = ((u - 32.0) / fx * depth, (v - 24.0) / fy * depth);
            // Optical x is right (ego -y), optical y is down (ego -z).
            let position = DVec3::new(depth, -x, -y).as_vec3().as_dvec3();
            let got = view.project(position, 0.2, 0.2, 1e9).expect("in front");
            let gap = (got.mean_px[0] - u).abs().max((got.mean_px[1] - v).abs());
            assert!(gap <= 1e-3, "{gap} px at {depth} m");
        }
    }
}

#[test]
fn row_38_ewa_jacobian() {
    let (w, h) = (128, 96);
    let camera = camera(w, h, 120.0);
    let view = SplatCamera::new(&camera, w, h, 1.3);
    let near = 0.2;
    let focal = camera.focal_px[0];
    let limit = |size: u32| 1.3 * 0.5 * f64::from(size) / focal;
    // With x/z and y/z held, no splat is larger than this at its depth.
    let steepest = 1.0 + limit(w).powi(2) + limit(h).powi(2);
    for depth in [0.2 + 1e-9, 0.25, 1.0, 40.0] {
        for side in [0.0, 0.3, 1.7, 40.0, 1e4] {
            for up in [0.0, -0.3, 1.7, -1e4] {
                let footprint = view.project(DVec3::new(depth, side, up), 0.2, near, 1e9);
                let f = footprint.expect("beyond the near plane");
                let [a, b, c] = f.covariance_px2;
                let middle = (a + c) / 2.0;
                let spread = ((a - c).powi(2) / 4.0 + b * b).sqrt();
                assert!(
                    middle - spread >= -1e-9 * middle,
                    "negative at {depth} {side} {up}"
                );
                let cap = (0.2 / depth * focal).powi(2) * steepest;
                assert!(
                    middle + spread <= cap * (1.0 + 1e-9),
                    "{} > {cap}",
                    middle + spread
                );
            }
        }
    }
    // Just off the near plane and far to the side: nothing wraps into the picture.
    let beside = gaussian([0.21, 30.0, 0.0], 0.2, 1.0, 4);
    assert!(
        draw(&[beside], &camera, &SplatOptions::default())
            .coverage
            .iter()
            .all(|&c| c == 0.0)
    );
}

#[test]
fn row_39_conic() {
    for aspect in [1.0, 10.0, 1e3, 3e3, 1e4] {
        for turn in 0..24 {
            let (s, c) = (f64::from(turn) * 0.13).sin_cos();
            for narrow in [0.0, 1e-3, 0.5, 20.0] {
                let wide = (narrow + 0.05) * aspect;
                let (l, n) = (wide * wide, narrow * narrow);
                let cov = [l * c * c + n * s * s, (l - n) * s * c, l * s * s + n * c * c];
                let conic = Conic::new(cov, 0.3).expect("finite");
                assert!(conic.along > 0.0 && conic.across > 0.0 && conic.compensation <= 1.0);
                let (a, b, d) = (cov[0] + 0.3, cov[1], cov[2] + 0.3);
                let [p, q, r] = conic.matrix();
                let product = [a * p + b * q, a * q + b * r, b * p + d * q, b * q + d * r];
                for (got, want) in product.into_iter().zip([1.0, 0.0, 0.0, 1.0]) {
                    assert!((got - want).abs() <= 1e-3, "{product:?} at {aspect}");
                }
            }
        }
    }
    // Without a low-pass a line stays invertible, if thin.
    let line = Conic::new([1e8, 1e4, 1.0], 0.0).expect("finite");
    assert!(line.along > 0.0 && line.across > 0.0);
    let nothing = Conic::new([0.0; 3], 0.0).expect("finite");
    assert!(nothing.along > 0.0 && nothing.along.is_finite());
    assert_eq!(Conic::new([f64::NAN, 0.0, 1.0], 0.3), None);
    assert_eq!(Conic::new([f64::INFINITY, 0.0, 1.0], 0.3), None);
}

#[test]
fn row_40_low_pass() {
    let camera = camera(64, 48, 60.0);
    let focal = camera.focal_px[0];
    for std_px in [0.01, 0.05, 0.2, 0.5, 3.0] {
        let depth = 30.0;
        let std_m = (std_px * depth / focal) as f32;
        // Some way off the pixel grid.
        let offset = (0.37 * depth / focal) as f32;
        let splat = gaussian([depth as f32, offset, offset], std_m, 0.5, 4);
        let total = |compensate_opacity| -> f64 {
            let options = SplatOptions {
                compensate_opacity,
                ..open()
            };
            let maps = draw(&[splat], &camera, &options);
            maps.coverage.iter().map(|&c| f64::from(c)).sum()
        };
        let view = SplatCamera::new(&camera, 64, 48, 1.3);
        let position = DVec3::new(depth, offset.into(), offset.into());
        let [a, b, c] = view
            .project(position, std_m.into(), 0.2, 200.0)
            .expect("in view")
            .covariance_px2;
        let want = 0.5 * std::f64::consts::TAU * (a * c - b * b).sqrt();
        let kept = total(true);
        assert!(
            (kept / want - 1.0).abs() <= 0.02,
            "{kept} for {want} at {std_px} px"
        );
        // What it is for: without it a splat far below a pixel gains weight.
        if std_px <= 0.2 {
            assert!(total(false) > 2.0 * want);
        }
    }
}

#[test]
fn row_41_compositing() {
    let camera = camera(20, 10, 60.0);
    let check = |layers: &[Gaussian], what: &str| -> RawMaps {
        let maps = draw(layers, &camera, &open());
        for i in 0..maps.coverage.len() {
            let (c, t) = (maps.coverage[i], maps.transmittance[i]);
            assert!((c + t - 1.0).abs() <= 1e-5, "{what}: {c} + {t}");
            assert!((0.0..=1.0).contains(&t), "{what}: {t}");
        }
        maps
    };
    // Ten thousand thin layers: transmittance must not stick at 1.
    let thin: Vec<_> = (0..10_000)
        .map(|i| sheet(1.0 + i as f32 * 0.01, 1e-4, 4))
        .collect();
    let maps = check(&thin, "thin");
    let want = (-1e-4f64).ln_1p() * 1e4;
    let t = f64::from(maps.transmittance[0]);
    assert!((t / want.exp() - 1.0).abs() < 1e-3, "{t}");
    // It only falls.
    let mut last = 1.0;
    for n in [1, 10, 100, 1000] {
        let t = draw(&thin[..n], &camera, &open()).transmittance[0];
        assert!(t < last, "{n} layers: {t}");
        last = t;
    }
    // Opacity 1, above 1, below 0, not a number.
    let maps = check(&[sheet(2.0, 1.0, 4), sheet(3.0, 1.0, 5)], "opaque");
    assert!((maps.coverage[0] - 0.999_999).abs() < 1e-5);
    let above = check(&[sheet(2.0, 7.0, 4), sheet(3.0, f32::INFINITY, 5)], "above");
    assert_eq!(above, maps);
    for opacity in [-0.0, -3.0, f32::NAN, f32::NEG_INFINITY] {
        let maps = check(&[sheet(2.0, opacity, 4)], "nothing");
        assert!(maps.coverage.iter().all(|&c| c == 0.0));
        assert!(maps.label.iter().all(|&l| l == -1));
    }
    // It stops once little light is left, and the wish for more than 0.999 is refused.
    let greedy = SplatOptions {
        alpha_max: 5.0,
        ..open()
    };
    let maps = draw(&vec![sheet(2.0, 1.0, 4); 50], &camera, &greedy);
    assert!(maps.transmittance.iter().all(|&t| t > 0.0 && t < 1e-4));
}

#[test]
fn row_42_semantics() {
    let small = camera(20, 10, 60.0);
    // Nothing hit, and nearly nothing: no class, whatever its id.
    let none = render(
        &GaussianCloud::default(),
        &small,
        20,
        10,
        &SplatOptions::default(),
    );
    assert!(none.semantic.iter().all(|&s| s == 0) && none.depth_m.iter().all(|&d| d == -1.0));
    for (min_coverage, opacity, want) in [(0.10, 0.09, 0), (0.10, 0.11, 4), (0.5, 0.49, 0), (0.5, 0.51, 4)] {
        let options = SplatOptions {
            min_coverage,
            ..SplatOptions::default()
        };
        let cloud = GaussianCloud::from_gaussians(vec![sheet(5.0, opacity, 4)]);
        let maps = render(&cloud, &small, 20, 10, &options);
        assert!(maps.semantic.iter().all(|&s| s == want), "{opacity}");
    }
    // The order in which Gaussians are listed changes nothing.
    let (w, h) = (64, 48);
    let mut listed: Vec<_> = (0..200u32)
        .map(|i| {
            let k = |m: u32| (i * m % 97) as f32 / 97.0;
            let id = (1 + i % 19) as u8;
            gaussian(
                [3.0 + i as f32 * 0.05, k(31) * 6.0 - 3.0, k(57) * 4.0 - 2.0],
                0.2,
                0.3 + 0.7 * k(13),
                id,
            )
        })
        .collect();
    let wide = camera(w, h, 70.0);
    let first = draw(&listed, &wide, &SplatOptions::default());
    listed.reverse();
    assert_eq!(draw(&listed, &wide, &SplatOptions::default()), first);
    listed.swap(3, 90);
    listed.rotate_left(57);
    assert_eq!(draw(&listed, &wide, &SplatOptions::default()), first);
    assert!(first.label.iter().filter(|&&l| l > 0).count() > 500);
    // Ids that do not exist draw nothing.
    let odd = draw(
        &[sheet(5.0, 1.0, 20), sheet(6.0, 1.0, 255)],
        &wide,
        &SplatOptions::default(),
    );
    assert!(odd.label.iter().all(|&l| l == -1));
}

#[test]
fn row_44_depth_map() {
    let camera = camera(20, 10, 60.0);
    let at = |layers: &[Gaussian]| {
        let m = draw(layers, &camera, &open());
        [
            m.coverage[105],
            m.expected_m[105],
            m.normalised_m[105],
            m.median_m[105],
        ]
    };
    assert_eq!(at(&[]), [0.0, 0.0, -1.0, -1.0]);
    // Hardly anything there: no depth, rather than one made of noise.
    let [coverage, expected, normalised, median] = at(&[sheet(10.0, 1e-6, 4)]);
    assert!(coverage > 0.0 && coverage < 1.1e-6 && expected > 0.0);
    assert_eq!([normalised, median], [-1.0, -1.0]);
    let [_, _, normalised, _] = at(&[sheet(10.0, 1.1e-3, 4)]);
    assert!((normalised - 10.0).abs() < 1e-4);
    // An object at 10 m (alpha 0.3) before a wall at 50 m (0.5): 20.5, 31.5 and 50.
    let near = |got: f32, want: f32| assert!((got - want).abs() < 1e-3, "{got} for {want}");
    let [coverage, expected, normalised, median] = at(&[sheet(10.0, 0.3, 4), sheet(50.0, 0.5, 15)]);
    near(coverage, 0.65);
    near(expected, 20.5);
    near(normalised, 20.5 / 0.65);
    assert_eq!(median, 50.0, "the median is one of the surfaces");
    assert_eq!(at(&[sheet(10.0, 0.51, 4), sheet(50.0, 0.9, 15)])[3], 10.0);
    // The maps of a camera follow the same rule.
    let cloud = GaussianCloud::from_gaussians(vec![sheet(10.0, 5e-4, 4)]);
    let maps = render(
        &cloud,
        &camera,
        20,
        10,
        &SplatOptions {
            alpha_min: 0.0,
            ..Default::default()
        },
    );
    assert!(maps.depth_m.iter().all(|&d| d == -1.0));
}

#[test]
fn sizes_and_threads() {
    let grid = {
        let mut grid = scene::VoxelGrid::new();
        for i in 0..6000usize {
            grid.set(i * 7919 % 200, i * 104_729 % 200, i * 31 % 16, (i % 17) as u8);
        }
        grid
    };
    let cloud = GaussianCloud::from_grid(&grid, &[]);
    let rig = SensorRig::default();
    let run = |threads, [w, h]: [u32; 2]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let options = SplatOptions::default();
        pool.expect("a pool")
            .install(|| render_rig(&cloud, &rig, w, h, &options))
    };
    for [w, h] in [[0, 0], [1, 1], [0, 9], [17, 33], PREVIEW_SIZE] {
        let maps = run(3, [w, h]);
        assert_eq!(maps, run(1, [w, h]));
        assert_eq!(maps.len(), 6);
        assert!(maps.iter().all(|m| m.semantic.len() == (w * h) as usize));
    }
    assert!(VIEW_SIZE[0] * 900 == VIEW_SIZE[1] * 1600 && PREVIEW_SIZE[0] * 900 == PREVIEW_SIZE[1] * 1600);
    let known = |id: u8| id == 0 || Class::from_id(id).is_some();
    assert!(
        run(2, PREVIEW_SIZE)
            .iter()
            .all(|m| m.semantic.iter().all(|&s| known(s)))
    );
}
