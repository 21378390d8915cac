//! Odd sizes, devices and cameras; and pictures to look at.

use std::path::Path;

use scene::splats::{RawMaps, SplatOptions};
use scene::{Camera, SensorRig};
use sensors::splat::cloud::GaussianCloud;
use sensors::{pictures::color, splat};
use viewport::{SplatError, SplatRenderer};

use super::{assert_same, camera, clouds, draw, draw_on_processor, gaps, gpu, sheet};

/// Sizes from nothing to odd, no cameras, a hundred cameras, cameras that are no cameras.
#[test]
fn row_63_sizes() {
    let (grid, bev) = crate::sensor_scene::street();
    let cloud = GaussianCloud::from_grid_shell(&grid, &bev, 1);
    let rig = SensorRig::default();
    let options = SplatOptions::default();
    let mut gpu = gpu();
    gpu.set_cloud(cloud.gaussians()).expect("room");
    for [w, h] in [[0, 0], [1, 1], [0, 9], [17, 33], [1, 300], [257, 16]] {
        let got = gpu
            .render_raw(&rig.cameras[1..3], [w, h], &options)
            .expect("maps");
        assert_eq!(got.len(), 2);
        for (got, camera) in got.iter().zip(&rig.cameras[1..3]) {
            let want = splat::render_raw(&cloud, camera, w, h, &options);
            // Of a few pixels one may differ.
            let gaps = gaps(got, &want);
            assert!(gaps.clear_labels == 0 && gaps.beyond.iter().all(|b| b * 100 <= gaps.pixels));
        }
    }
    assert!(
        gpu.render_raw(&[], [40, 30], &options)
            .expect("no maps")
            .is_empty()
    );
    // More than one batch holds.
    let many: Vec<Camera> = rig.cameras.iter().cycle().take(140).cloned().collect();
    let got = gpu.render_raw(&many, [24, 16], &options).expect("maps");
    assert_eq!(got.len(), 140);
    assert!((6..140).all(|i| got[i] == got[i - 6]) && got[0] != got[1]);
    // Cameras without a place, and options without a meaning, draw nothing.
    let mut lost = rig.cameras[1].clone();
    lost.rotation_wxyz = [f64::NAN; 4];
    let mut flat = rig.cameras[1].clone();
    flat.focal_px = [0.0, f64::INFINITY];
    let got = gpu.render_raw(&[lost, flat], [24, 16], &options).expect("maps");
    assert!(got.iter().all(|m| *m == RawMaps::empty(24, 16)));
    for options in [
        SplatOptions {
            near_m: 5.0,
            far_m: 1.0,
            ..options
        },
        SplatOptions {
            far_m: f64::NAN,
            ..options
        },
        SplatOptions {
            low_pass_px2: f64::NAN,
            ..options
        },
        SplatOptions {
            alpha_min: f32::NAN,
            ..options
        },
        SplatOptions {
            t_stop: f32::NAN,
            ..options
        },
        SplatOptions {
            jacobian_clamp: f64::NAN,
            ..options
        },
        SplatOptions {
            jacobian_clamp: -3.0,
            ..options
        },
    ] {
        let got = gpu
            .render_raw(&rig.cameras[1..2], [40, 24], &options)
            .expect("maps");
        let want = splat::render_raw(&cloud, &rig.cameras[1], 40, 24, &options);
        assert_eq!(gaps(&got[0], &want).clear_labels, 0, "{options:?}");
    }
}

/// Too small a device, too large an image, too many splats: an error that says so, and a renderer
/// that goes on.
#[test]
fn row_63_device() {
    let adapter = pollster::block_on(async {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        descriptor.backends = wgpu::Backends::PRIMARY;
        let instance = wgpu::Instance::new(descriptor);
        instance
            .request_adapter(&wgpu::RequestAdapterOptions::default())
            .await
    })
    .expect("a graphics adapter, software or not");
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::downlevel_webgl2_defaults(),
        ..Default::default()
    }))
    .expect("a device of the smallest kind");
    match SplatRenderer::new(&device, &queue) {
        Err(SplatError::Unable {
            has: 0,
            needs: 4,
            limit,
            ..
        }) => assert!(limit.contains("storage")),
        other => panic!("{other:?}"),
    }

    let options = SplatOptions::default();
    let camera = camera(400, 225, 60.0);
    let cameras = [camera.clone(), camera.clone()];
    // More touches than there is room for at first: 25 x 15 tiles, 3,000 times.
    let layers: Vec<_> = (0..3000u16)
        .map(|i| sheet(1.0 + f32::from(i) * 0.01, 0.05, (i / 300) as u8))
        .collect();
    let got = draw(&layers, &camera, &options);
    assert_same(
        &got,
        &draw_on_processor(&layers, &camera, &options),
        "room that grew",
    );

    let mut gpu = gpu();
    let size = gpu.render_raw(&cameras, [9000, 9000], &options);
    assert!(
        matches!(
            size,
            Err(SplatError::Size {
                width: 9000,
                height: 9000
            })
        ),
        "{size:?}"
    );
    gpu.set_cloud(&vec![sheet(3.0, 0.5, 4); 100_000]).expect("room");
    let crowded = gpu.render_raw(&cameras, [400, 225], &options);
    let Err(SplatError::Crowded { touches, max }) = crowded else {
        panic!("{:?}", crowded.map(|m| m.len()));
    };
    assert_eq!((touches, max), (100_000 * 25 * 15, 1 << 24));
    let many = gpu.set_cloud(&vec![sheet(3.0, 0.5, 4); (4 << 20) + 1]);
    assert!(
        matches!(many, Err(SplatError::Gaussians { count: 4_194_305, .. })),
        "{many:?}"
    );
    // It goes on with what it had.
    gpu.set_cloud(&layers).expect("room");
    let again = gpu.render_raw(&cameras[..1], [400, 225], &options);
    assert!(again.expect("maps") == [got]);
}

/// Six cameras as both draw them (processor above graphics card, then where labels differ), to look
/// at: `cargo test --release --test splat_gpu -- --ignored`.
#[test]
#[ignore = "writes pictures to look at"]
fn pictures() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let rig = SensorRig::default();
    let options = SplatOptions::default();
    let [w, h] = splat::VIEW_SIZE;
    let row = [0, 1, 2, 3, 4, 5];
    for (name, cloud) in clouds() {
        let want = splat::render_rig(&cloud, &rig, w, h, &options);
        let mut gpu = gpu();
        gpu.set_cloud(cloud.gaussians()).expect("room");
        let got = gpu.render_rig(&rig, [w, h], &options).expect("maps");
        let mut sheet = image::RgbaImage::new(w * 3, h * 8);
        let mut put = |rgba: Vec<u8>, i: u32, line: u32| {
            let picture = image::RgbaImage::from_raw(w, h, rgba).expect("as large as it says");
            image::imageops::replace(
                &mut sheet,
                &picture,
                (i % 3 * w).into(),
                ((line + i / 3) * h).into(),
            );
        };
        for (i, n) in row.into_iter().zip(0u32..) {
            put(color::semantic_rgba(&want[i], true), n, 0);
            put(color::semantic_rgba(&got[i], true), n, 2);
            put(color::depth_rgba(&got[i].median_m, 1.0, 60.0), n, 4);
            let pairs = want[i].semantic.iter().zip(&got[i].semantic);
            put(
                pairs
                    .flat_map(|(a, b)| [if a == b { 0 } else { 255 }, 0, 0, 255])
                    .collect(),
                n,
                6,
            );
        }
        sheet
            .save(folder.join(format!("splat_gpu_{}.png", name.replace(' ', "_"))))
            .expect("a picture");
    }
    println!("{}", folder.display());
}
