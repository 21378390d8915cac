//! `sceneloom prompt` as a user runs it: scenes and edits from words, questions, bad input.

use std::process::{Command, Output};

fn sceneloom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the built program runs")
}

fn report(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(&text)
        .unwrap_or_else(|e| panic!("{e}: {text}{}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn scenes_and_edits_from_words() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let (a, b, c) = (path("a.loom"), path("b.loom"), path("c.loom"));
    let text = "an intersection at night in the rain, five cones block my lane, three parked cars, a glorp";
    let made = sceneloom(&["prompt", text, "--seed", "3", "--json", "-o", &a]);
    assert_eq!(
        made.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let made = report(&made);
    for key in ["description", "graph", "reading", "answer", "not_understood"] {
        assert!(!made[key].is_null(), "{key}: {made}");
    }
    assert_eq!(made["boxes"], 8);
    assert_eq!(made["description"]["weather"], "rain");
    assert_eq!(made["not_understood"][0]["words"], "glorp");
    assert!(made["occupied_voxels"].as_u64() > Some(30_000));
    sceneloom(&["prompt", text, "--seed", "3", "--json", "-o", &b]);
    assert_eq!(
        std::fs::read(&a).expect("written"),
        std::fs::read(&b).expect("written")
    );

    let asked = sceneloom(&[
        "prompt",
        "remove the parked car",
        "--base",
        &a,
        "--json",
        "-o",
        &c,
    ]);
    assert_eq!(asked.status.code(), Some(1));
    assert!(!std::path::Path::new(&c).exists());
    let asked = report(&asked);
    let candidates = asked["questions"][0]["candidates"].as_array().expect("a list");
    assert_eq!(candidates.len(), 3);
    let one = format!("remove #{}", candidates[0]["id"]);
    let edited = sceneloom(&["prompt", &one, "--base", &a, "--json", "-o", &c]);
    assert_eq!(
        edited.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&edited.stderr)
    );
    assert_eq!(report(&edited)["boxes"], 7);
    let kept = formats::loom::load(std::path::Path::new(&c)).expect("a scene");
    assert_eq!(*kept.words, [text.to_owned(), one]);
}

#[test]
fn what_cannot_be_done_is_said_in_one_line() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let out = dir.path().join("x.loom").display().to_string();
    for (args, code, needle) in [
        (vec!["prompt", "", "-o", &out], 2, "empty"),
        (vec!["prompt", "夜晚", "-o", &out], 2, "English"),
        (
            vec![
                "prompt",
                "a car",
                "--endpoint",
                "https://x",
                "--model",
                "m",
                "-o",
                &out,
            ],
            2,
            "TLS",
        ),
        (
            vec!["prompt", "40 buses in my lane", "-o", &out],
            1,
            "of 40 placed",
        ),
        (
            vec!["prompt", "a car", "--base", "/nowhere.loom", "-o", &out],
            2,
            "nowhere",
        ),
    ] {
        let output = sceneloom(&args);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {error}");
        assert_eq!(error.trim_end().lines().count(), 1, "{args:?}: {error}");
        assert!(error.contains(needle), "{args:?}: {needle:?} is not in {error}");
    }
}

#[test]
fn placers_memory_and_kept_parts() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let (a, b, c) = (path("a.loom"), path("b.loom"), path("c.loom"));
    let text = "two parked cars and a bus ahead, no people";
    let made = sceneloom(&[
        "prompt",
        text,
        "--placer",
        "diffusion",
        "--memory",
        "--json",
        "-o",
        &a,
    ]);
    assert_eq!(
        made.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let made = report(&made);
    assert_eq!(made["placer"], "diffusion");
    let nodes = made["graph"]["nodes"].as_array().expect("nodes");
    let count = |class: &str| {
        nodes
            .iter()
            .filter(|n| n["kind"]["object"]["class"] == class)
            .count()
    };
    assert_eq!(
        (count("car"), count("bus"), count("pedestrian")),
        (2, 1, 0),
        "{made}"
    );
    assert_eq!(made["boxes"], 3, "{made}");
    assert!(made["memory"]["scenes"].as_array().is_some_and(|s| !s.is_empty()));
    assert!(made["diffusion"]["report"]["steps"].as_u64() > Some(0), "{made}");
    // A new scene on the road of that one, and one around its objects.
    let kept = sceneloom(&[
        "prompt",
        "a cyclist ahead",
        "--base",
        &a,
        "--keep",
        "road",
        "--json",
        "-o",
        &b,
    ]);
    assert_eq!(report(&kept)["boxes"], 1);
    let road = sceneloom(&[
        "prompt",
        "a straight road",
        "--base",
        &a,
        "--keep",
        "objects",
        "--json",
        "-o",
        &c,
    ]);
    assert_eq!(report(&road)["boxes"], made["boxes"], "{}", report(&road));
    let refused = sceneloom(&["prompt", "a car", "--keep", "road", "-o", &b]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn odd_prompts_get_one_clear_answer() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let out = dir.path().join("x.loom").display().to_string();
    let long = "two cars and a bus ahead, ".repeat(400);
    for text in [
        "🦄🦄🦄",
        "zwei Autos und ein Fahrrad",
        "no cars and three cars",
        "a bus behind itself",
        "999999999 cones",
        "a car 1e308 m ahead",
        "the the the of of",
        long.as_str(),
    ] {
        let output = sceneloom(&["prompt", text, "--json", "-o", &out]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0..=2)), "{text:.40}: {error}");
        assert!(error.trim_end().lines().count() <= 1, "{text:.40}: {error}");
        assert!(!error.contains("panicked"), "{text:.40}: {error}");
    }
}

/// Sentences that nobody has mended rules for, and voices that the reader never learned: what is read of them does not get
/// worse, and little goes wrong without a word.
#[test]
fn sentences_are_read_no_worse() {
    for (file, parts) in [
        ("dev/exam_13", &[("edited", 0.8, 0.06)][..]),
        ("dev/exam_9", &[("edited", 0.85, 0.05)]),
        ("dev/everyday", &[("edited", 0.5, 0.2), ("made", 0.6, 0.1)]),
        ("heldout", &[("made", 0.74, 0.05), ("edited", 0.72, 0.1)]),
    ] {
        let path = format!("tests/words/{file}.jsonl");
        let judged = sceneloom(&[
            "eval",
            "layout",
            "--prompts",
            &path,
            "--placer-prompts",
            "0",
            "--json",
        ]);
        assert_eq!(judged.status.code(), Some(0));
        let judged = report(&judged);
        for (part, right, silent) in parts {
            let found = &judged[part];
            let share = |name: &str| found[name]["share"].as_f64().expect("a share");
            assert!(
                share("wholly_right") >= *right,
                "{file}, {part}: {}",
                found["wholly_right"]
            );
            assert!(
                share("silently_wrong") <= *silent,
                "{file}, {part}: {}",
                found["silently_wrong"]
            );
        }
    }
    let nowhere = sceneloom(&["eval", "layout", "--prompts", "nowhere.jsonl"]);
    let error = String::from_utf8_lossy(&nowhere.stderr);
    assert_eq!(
        (nowhere.status.code(), error.lines().count()),
        (Some(2), 1),
        "{error}"
    );
}

#[test]
fn an_early_end_of_the_reader_is_no_panic() {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let out = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(["prompt", "--schema"])
        .stdout(writer)
        .output()
        .expect("it ends");
    assert_eq!(String::from_utf8_lossy(&out.stderr), "");
    assert_eq!(out.status.code(), Some(141));
}
