//! The reference of the splat renderers, tests/reference/splat.json, and how one is checked against it.

use glam::{DMat3, DQuat, DVec3};
use scene::Camera;
use scene::splats::{RawMaps, SplatOptions};
use sensors::splat::cloud::{Gaussian, GaussianCloud};
use serde_json::Value;

/// A JSON file of tests/reference.
pub fn json(name: &str) -> Value {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("tests/reference").join(name)).expect("a reference file");
    serde_json::from_str(&text).expect("JSON")
}

/// An array of numbers.
pub fn floats(v: &Value) -> Vec<f64> {
    let list = v.as_array().expect("an array");
    list.iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// The reference's camera in the terms of a rig.
pub fn camera_of(v: &Value) -> Camera {
    let m: Vec<Vec<f64>> = v["camera_from_world"]
        .as_array()
        .expect("rows")
        .iter()
        .map(floats)
        .collect();
    let row = |i: usize| DVec3::new(m[i][0], m[i][1], m[i][2]);
    // Rows of the forward rotation are columns of its inverse.
    let world_from_camera = DMat3::from_cols(row(0), row(1), row(2));
    let q = DQuat::from_mat3(&world_from_camera);
    let number = |name: &str| v[name].as_f64().expect("a number");
    Camera {
        name: v["name"].as_str().expect("a name").into(),
        width: number("width") as u32,
        height: number("height") as u32,
        focal_px: [number("fx"), number("fy")],
        center_px: [number("cx"), number("cy")],
        rotation_wxyz: [q.w, q.x, q.y, q.z],
        translation_m: (-(world_from_camera * DVec3::new(m[0][3], m[1][3], m[2][3]))).to_array(),
        ..Camera::new("", 60.0)
    }
}

/// The Gaussians of the reference.
pub fn reference_cloud(data: &Value) -> GaussianCloud {
    let g = &data["gaussians"];
    let list = |name: &str| g[name].as_array().expect("a list").clone();
    let (opacity, std_m) = (floats(&g["opacity"]), floats(&g["std_m"]));
    let gaussians = list("position_m")
        .into_iter()
        .zip(list("label"))
        .enumerate()
        .map(|(i, (p, label))| Gaussian {
            position_m: DVec3::from_slice(&floats(&p)).as_vec3().to_array(),
            std_m: std_m[i] as f32,
            opacity: opacity[i] as f32,
            id: label.as_u64().expect("a label") as u8,
        });
    GaussianCloud::from_gaussians(gaussians.collect())
}

/// Checks a renderer: maps against splat.json (float64 NumPy 2.4.6, checked there with torch 2.15.0). Tolerance of the
/// file for float32: 2e-3 coverage and 2e-2 m on 99 % of pixels, labels where margin > 0.01.
pub fn check(mut render: impl FnMut(&GaussianCloud, &Camera, &SplatOptions) -> RawMaps) {
    let data = json("splat.json");
    let cloud = reference_cloud(&data);
    for want in data["renders"].as_array().expect("renders") {
        let cameras = data["cameras"].as_array().expect("cameras");
        let camera = cameras
            .iter()
            .find(|c| c["name"] == want["camera"])
            .map(camera_of);
        let camera = camera.expect("the camera of a render");
        let compensate = want["opacity_compensation"].as_bool().expect("a flag");
        let options = SplatOptions {
            compensate_opacity: compensate,
            ..Default::default()
        };
        let got = render(&cloud, &camera, &options);
        let n = got.coverage.len();
        let compare = |name: &str, got: &[f32], limit: f64| {
            let gaps = got
                .iter()
                .zip(floats(&want[name]))
                .map(|(a, b)| (f64::from(*a) - b).abs());
            let gaps: Vec<f64> = gaps.collect();
            let over = gaps.iter().filter(|g| **g > limit).count();
            let largest = gaps.iter().copied().fold(0.0, f64::max);
            println!(
                "{} {compensate} {name}: largest gap {largest:.1e}, {over} over {limit}",
                camera.name
            );
            assert!(over * 100 <= n, "{name}: {over} of {n} pixels beyond {limit}");
        };
        compare("coverage", &got.coverage, 2e-3);
        if !compensate {
            compare("expected", &got.expected_m, 2e-2);
            compare("normalised", &got.normalised_m, 2e-2);
            compare("median", &got.median_m, 1e-3);
            compare("margin", &got.margin, 2e-3);
            let (labels, margin) = (floats(&want["labels"]), floats(&want["margin"]));
            for i in 0..n {
                if margin[i] > 0.01 {
                    assert_eq!(f64::from(got.label[i]), labels[i], "pixel {i}");
                }
            }
        }
    }
}
