//! What would not end, or only after hours: refused in one line before the work, or kept to what a machine does, and said.

use std::process::Command;

use assets::weights as shipped;

use super::cli::{Folder, json, refused, sceneloom};

#[test]
fn far_coordinates_are_refused_and_name_their_element() {
    let dir = Folder::new();
    let out = dir.path("out.loom");
    let node = |id: u32, x: f64, y: f64| {
        format!("<node id=\"{id}\"><tag k=\"local_x\" v=\"{x}\"/><tag k=\"local_y\" v=\"{y}\"/></node>\n")
    };
    let lanelet2 = |far: f64| {
        let nodes: String = [(1, 0.0, 3.0), (2, far, 3.0), (3, 0.0, 0.0), (4, 90.0, 0.0)]
            .into_iter()
            .map(|(id, x, y)| node(id, x, y))
            .collect();
        format!(
            "<osm>\n{nodes}<way id=\"7\"><nd ref=\"1\"/><nd ref=\"2\"/></way><way id=\"8\"><nd ref=\"3\"/><nd ref=\"4\"/></way>\
             <relation id=\"5\"><member type=\"way\" role=\"left\" ref=\"7\"/><member type=\"way\" role=\"right\" ref=\"8\"/>\
             <tag k=\"type\" v=\"lanelet\"/></relation></osm>"
        )
    };
    let file = dir.write("far.osm", lanelet2(1e11));
    refused(
        &["import", &file, "-o", &out],
        &["far.osm", "node \"2\" (line 3)", "local_x", "1e9"],
    );
    let file = dir.write("long.osm", lanelet2(1e8));
    refused(
        &["import", &file, "-o", &out],
        &["long.osm", "lanelet 5: a bound of", "100000 m"],
    );
    let point = |x: f64, y: f64| format!("<point><x>{x}</x><y>{y}</y></point>");
    let text = format!(
        "<commonRoad><lanelet id=\"5\"><leftBound>{}{}</leftBound><rightBound>{}{}</rightBound></lanelet></commonRoad>",
        point(0.0, 3.0),
        point(1e11, 3.0),
        point(0.0, 0.0),
        point(80.0, 0.0)
    );
    let file = dir.write("far.xml", text);
    refused(
        &["import", &file, "-o", &out],
        &["far.xml", "lanelet \"5\"", "1e9"],
    );
    assert!(!std::path::Path::new(&out).exists(), "nothing may be written");
}

/// 100,000 threads hung the machine.
#[test]
fn a_number_of_threads_from_outside_is_kept_to_what_helps() {
    let dir = Folder::new();
    for (threads, lines) in [("100000", 1), ("-7", 1), ("2", 0), ("", 0)] {
        let output = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
            .args(["new", "--template", "straight", "-o", &dir.path("a.loom")])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .expect("the built program runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{threads}: {said}");
        let told = said
            .lines()
            .filter(|l| l.contains("RAYON_NUM_THREADS is"))
            .count();
        assert_eq!(told, lines, "{threads}: {said}");
    }
}

#[test]
fn unknown_options_are_one_line_that_says_what_was_meant() {
    let scene = "nowhere.loom";
    refused(&["--no-such"], &["found", "--no-such"]);
    refused(&["chekc"], &["chekc"]);
    refused(
        &["check", scene, "--fixx"],
        &["found --fixx", "(did you mean --fix"],
    );
    refused(
        &["render", scene, "-o", "x", "--lidar", "exakt"],
        &["expected one of", "(did you mean exact?)"],
    );
}

#[test]
fn weights_that_lack_what_was_asked_for_are_refused() {
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out.loom"));
    let weights = dir.path("weights");
    std::fs::create_dir(&weights).expect("writable");
    let prompt = |more: &[&str]| -> Vec<String> {
        let words = ["prompt", "a street", "--weights", &weights, "-o", &out];
        words.iter().chain(more).map(|w| (*w).to_owned()).collect()
    };
    let refused_prompt = |more: &[&str], needles: &[&str]| {
        let words = prompt(more);
        refused(&words.iter().map(String::as_str).collect::<Vec<_>>(), needles);
    };
    // Before, objects were placed by rules and a note said so.
    refused_prompt(&["--placer", "diffusion"], &["layout.safetensors"]);
    refused_prompt(&[], &["--weights", "--generate"]);
    dir.write(
        "weights/layout.safetensors",
        &shipped::LAYOUT[..shipped::LAYOUT.len() - 1],
    );
    refused_prompt(&["--placer", "diffusion"], &["layout.safetensors"]);
    refused(
        &["session", "--weights", &weights],
        &["--weights", ".safetensors"],
    );
    dir.write("weights/occ_vae.safetensors", shipped::OCC_VAE);
    dir.write("weights/occ_dit.safetensors", shipped::OCC_DIT);
    let generate = [
        "generate",
        &scene,
        "--weights",
        &weights,
        "-o",
        &out,
        "--fine-steps",
        "2",
    ];
    refused(&generate, &["--fine-steps 2", "no refiner.safetensors"]);
    // Before, what the folder lacked was taken from the shipped weights, and the figures were of both.
    let forecast = ["eval", "forecast", "--frames", "1", "--weights", &weights];
    refused(&forecast, &["occ_dit_time.safetensors"]);
    dir.write("weights/occ_dit_time.safetensors", shipped::OCC_DIT_TIME);
    refused(&forecast, &["time_decoder.safetensors"]);
    // A half of the fine stage is no fine stage.
    dir.write("weights/occ_vae_fine.safetensors", shipped::OCC_VAE_FINE);
    refused(&generate[..6], &["refiner.safetensors"]);
    assert!(!std::path::Path::new(&out).exists(), "nothing may be written");
}

#[test]
fn guidance_beyond_what_was_measured_is_said_and_nonsense_refused() {
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out.loom"));
    let generate = |guidance: &str| {
        let option = format!("--guidance={guidance}");
        sceneloom(&[
            "generate",
            &scene,
            &option,
            "--steps",
            "1",
            "--fine-steps",
            "0",
            "-o",
            &out,
            "--json",
        ])
    };
    let notes = |guidance: &str| json(&generate(guidance))["notes"].to_string();
    assert!(
        notes("50").contains("guidance is 50, measured is 0.5 to 2"),
        "{}",
        notes("50")
    );
    assert!(!notes("1.5").contains("guidance"), "{}", notes("1.5"));
    for nonsense in ["NaN", "-1", "inf", "101"] {
        let output = generate(nonsense);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{nonsense}: {said}");
        assert!(
            said.contains("guidance is ") && said.contains("expected 0 to 100"),
            "{nonsense}: {said}"
        );
    }
}
