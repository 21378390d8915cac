//! `sceneloom perceive`, and learned pictures in files: what the camera networks see and paint.

use std::process::{Command, Output};

use serde_json::Value;

fn sceneloom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .output()
        .expect("the built program runs")
}

fn json(args: &[&str]) -> Value {
    let output = sceneloom(&[args, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {error}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn what_is_missed_is_told_and_a_corner_case_is_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let (scene, out) = (path("s.loom"), path("missed.loom"));
    json(&["new", "--template", "t-junction", "--seed", "1", "-o", &scene]);
    let seen = json(&["perceive", &scene]);
    assert!(seen["pixels_right"].as_f64() > Some(0.85), "{seen}");
    assert_eq!(seen["ghost_px"].as_object().map(|o| o.len()), Some(6));
    let boxes = seen["boxes"].as_array().expect("a list");
    let plain = boxes
        .iter()
        .find(|b| b["missed"] == false)
        .expect("a box that is seen");
    let lidar = &seen["lidar"];
    assert!(lidar["columns_right"].as_f64() > Some(0.5), "{lidar}");
    let swept = lidar["boxes"].as_array().expect("a list");
    assert!(
        swept
            .iter()
            .any(|b| b["missed"] == false && b["returns"].as_u64() >= Some(5))
    );
    let number = plain["box"].clone();
    let id = number.to_string();

    let found = json(&["perceive", &scene, "--box", &id, "--vary", "fog", "-o", &out]);
    assert_eq!(
        (&found["missed"], &found["file"]),
        (&Value::Bool(true), &Value::from(&*out))
    );
    assert!(
        found["at"]
            .as_str()
            .is_some_and(|at| at.starts_with("visibility")),
        "{found}"
    );
    let again = json(&["perceive", &out]);
    let of = |report: &Value| {
        let boxes = report["boxes"].as_array().expect("a list").clone();
        boxes.into_iter().find(|b| b["box"] == number).expect("the box")
    };
    assert_eq!(of(&again)["missed"], true, "{again}");

    for (args, needle) in [
        (
            vec!["perceive", &scene, "--box", "9999", "--vary", "fog"],
            "there is no box 9999",
        ),
        (
            vec!["perceive", &scene, "--box", "1", "--vary", "fog", "--by", "lidar"],
            "light and air mean nothing to the LiDAR",
        ),
        (vec!["perceive", &scene, "--box", "1"], "--vary"),
        (vec!["perceive", &scene, "--box", "1", "--vary", "mood"], "mood"),
        (vec!["perceive", &scene, "-o", &out], "--vary"),
        (vec!["perceive", &scene, "--by", "lidar"], "--by is of a search"),
        (vec!["perceive", "nowhere.loom"], "nowhere.loom"),
    ] {
        let output = sceneloom(&args);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
        assert!(error.contains(needle), "{args:?}: {error}");
    }
}

/// A file of learned pictures has the size asked for, and the same scene gives the same bytes.
#[test]
fn learned_pictures_are_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let scene = path("s.loom");
    json(&["new", "--template", "straight", "--seed", "2", "-o", &scene]);
    let bytes = ["a", "b"].map(|folder| {
        let out = path(folder);
        json(&[
            "render",
            &scene,
            "--what",
            "learned,perceived",
            "--size",
            "320x180",
            "-o",
            &out,
        ]);
        let read = |name: &str| std::fs::read(dir.path().join(folder).join(name)).expect(name);
        [read("CAM_FRONT_learned.png"), read("CAM_BACK_perceived.png")]
    });
    assert_eq!(bytes[0], bytes[1]);
    let image = image::load_from_memory(&bytes[0][0])
        .expect("a picture")
        .to_rgb8();
    assert_eq!(image.dimensions(), (320, 180));
    let colors: std::collections::BTreeSet<_> = image.pixels().map(|p| p.0).collect();
    assert!(colors.len() > 1000, "{} colours", colors.len());
}

/// Public weights of either kind paint by command; tiny ones with random numbers stand for them. Damaged ones are one line.
#[test]
fn public_weights_paint_by_command() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let scene = path("s.loom");
    json(&["new", "--template", "straight", "--seed", "2", "-o", &scene]);
    let paint = |weights: &str, more: &[&str]| {
        let out = path("out");
        let args = [
            "render",
            &scene,
            "--what",
            "learned",
            "--size",
            "64x64",
            "-o",
            &out,
            "--weights",
            weights,
            "--paint-steps",
            "2",
        ];
        sceneloom(&[&args[..], more].concat())
    };
    let reference = |name: &str| format!("{}/tests/reference/stable/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut pictures = std::collections::BTreeSet::new();
    for name in ["sd15", "sd21", "ring"] {
        let output = paint(&reference(name), &["--paint-width", "64"]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {error}");
        let picture = std::fs::read(dir.path().join("out/CAM_FRONT_learned.png")).expect("a picture");
        assert!(pictures.insert(picture), "{name} paints as another does");
    }
    let damaged = dir.path().join("damaged");
    let copied = std::process::Command::new("cp")
        .arg("-r")
        .arg(reference("sd15"))
        .arg(&damaged)
        .status();
    assert!(copied.expect("cp").success());
    let file = damaged.join("unet/diffusion_pytorch_model.safetensors");
    let bytes = std::fs::read(&file).expect("weights");
    std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("written");
    let damaged = damaged.display().to_string();
    for (weights, more, needle) in [
        (&*damaged, &[][..], "not a usable safetensors file"),
        (&path("nowhere"), &[], "no folder of weights"),
        (
            &reference("sd15"),
            &["--paint-strength", "nan"],
            "expected 0.1 to 1",
        ),
        (
            &reference("sd15"),
            &["--paint-guidance", "99"],
            "expected 1 to 15",
        ),
        (
            &reference("sd15"),
            &["--paint-scheduler", "heun"],
            "expected ddim, pndm, dpmpp2m, euler, unipc",
        ),
    ] {
        let output = paint(weights, more);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{weights}: {error}");
        assert!(error.contains(needle) && error.lines().count() <= 2, "{error}");
    }
    // Options that nothing would come of are refused.
    for (what, option, value, needle) in [
        (
            "semantic",
            "--paint-steps",
            "8",
            "of learned pictures alone, but --what is semantic",
        ),
        (
            "learned",
            "--paint-width",
            "64",
            "--paint-width is of public weights alone",
        ),
    ] {
        let out = path("none");
        let output = sceneloom(&["render", &scene, "--what", what, "-o", &out, option, value][..]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{what}: {error}");
        assert!(error.contains(needle) && error.lines().count() == 1, "{error}");
        assert!(!std::path::Path::new(&out).exists(), "{what}");
    }
}
