//! The built command on real input, and on bad input: one clear line, exit 2, nothing written.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn sceneloom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the built program runs")
}

pub fn json(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("one JSON object expected: {e}: {text}"))
}

/// The command fails with exit 2 and one line that holds every one of `needles`.
pub fn refused(args: &[&str], needles: &[&str]) {
    let output = sceneloom(args);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{args:?}: {error}");
    for needle in needles {
        assert!(error.contains(needle), "{args:?}: {needle:?} is not in {error}");
    }
}

pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
    pub fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("writable");
        path
    }
    pub fn scene(&self) -> String {
        let path = self.path("scene.loom");
        json(&sceneloom(&[
            "new",
            "--template",
            "straight",
            "--seed",
            "3",
            "-o",
            &path,
            "--json",
        ]));
        path
    }
}

#[test]
fn templates_make_scenes_that_repeat() {
    let dir = Folder::new();
    let list = json(&sceneloom(&["new", "--template", "list", "--json"]));
    for name in list["templates"].as_array().expect("a list") {
        let name = name.as_str().expect("a name");
        let (a, b) = (dir.path("a.loom"), dir.path("b.loom"));
        let report = json(&sceneloom(&[
            "new",
            "--template",
            name,
            "--seed",
            "5",
            "-o",
            &a,
            "--json",
        ]));
        assert!(report["occupied_voxels"].as_u64() > Some(30_000), "{report}");
        assert!(
            report["classes"]["driveable_surface"].as_u64() > Some(2000),
            "{report}"
        );
        sceneloom(&["new", "--template", name, "--seed", "5", "-o", &b]);
        assert_eq!(
            std::fs::read(&a).expect("written"),
            std::fs::read(&b).expect("written"),
            "{name}"
        );
    }
}

#[test]
fn own_roads_import_with_traffic() {
    let dir = Folder::new();
    let roads = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/roads");
    let files: Vec<PathBuf> = std::fs::read_dir(roads)
        .expect("bundled roads")
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "xodr"))
        .collect();
    assert!(files.len() >= 3);
    for file in files {
        let report = json(&sceneloom(&[
            "import",
            &file.display().to_string(),
            "-o",
            &dir.path("r.loom"),
            "--json",
        ]));
        assert_eq!(report["format"], "opendrive");
        assert!(
            report["roads"].as_u64() > Some(0) && report["lanes"].as_u64() > Some(0),
            "{report}"
        );
    }
}

#[test]
fn edits_keep_what_they_do_not_touch() {
    let dir = Folder::new();
    let scene = dir.scene();
    let edits = dir.write(
        "edits.json",
        r#"[{"add_box": {"class": "traffic_cone", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": 0}},
            {"paint_voxels": {"cells": [[100, 90, 3]], "class": "barrier"}}, {"set_prompt": {"prompt": "night"}}]"#,
    );
    let (a, b) = (dir.path("a.loom"), dir.path("b.loom"));
    let args = |out: &str| {
        let args = [
            "edit", &scene, "--edits", &edits, "--steps", "4", "--verify", "--json", "-o", out,
        ];
        args.map(String::from)
    };
    let run = |out: &str| {
        let args = args(out);
        json(&sceneloom(&args.each_ref().map(String::as_str)))
    };
    let report = run(&a);
    assert_eq!(report["untouched_voxels_changed"], 0);
    assert!(report["network_calls"].as_u64() >= Some(4));
    assert!(report["round_trip_error"].as_f64().is_some());
    run(&b);
    assert_eq!(
        std::fs::read(&a).expect("written"),
        std::fs::read(&b).expect("written")
    );
}

#[test]
fn sensors_and_views_render() {
    let dir = Folder::new();
    let scene = dir.scene();
    let out = dir.path("out");
    let what = "semantic,depth,lidar,bev,view";
    let report = json(&sceneloom(&[
        "render", &scene, "--what", what, "--size", "160x90", "-o", &out, "--json",
    ]));
    let files = report["files"].as_array().expect("a list");
    // Per camera a semantic picture, two of depth and the arrays; two each of the LiDAR and from above, the view, the
    // calibration.
    assert_eq!(files.len(), 6 + 12 + 6 + 2 + 2 + 1 + 1, "{files:?}");
    assert!(report["lidar"]["returns"].as_u64() > Some(10_000));
    let front = image::open(Path::new(&out).join("CAM_FRONT_semantic.png"))
        .expect("a picture")
        .to_rgb8();
    assert_eq!(front.dimensions(), (160, 90));
    let colors: std::collections::HashSet<_> = front.pixels().collect();
    assert!(colors.len() > 8, "{} colours", colors.len());
    let more = json(&sceneloom(&[
        "render",
        &scene,
        "--what",
        "semantic,appearance,perspective,mpi,lidar",
        "--source",
        "shapes",
        "--lidar",
        "learned",
        "--weather",
        "snow",
        "--time",
        "dusk",
        "--preview",
        "--size",
        "96x54",
        "-o",
        &out,
        "--json",
    ]));
    // Appearance comes with a sheet of all cameras.
    assert_eq!(
        more["files"].as_array().map(Vec::len),
        Some(12 + 7 + 12 + 12 + 2 + 1)
    );
    assert!(more["lidar"]["returns"].as_u64() > Some(10_000));
    let shot = dir.path("shot.png");
    json(&sceneloom(&[
        "shot",
        &scene,
        "--size",
        "320x200",
        "--transparent",
        "-o",
        &shot,
        "--json",
    ]));
    let shot = image::open(shot).expect("a picture").to_rgba8();
    assert!(shot.pixels().any(|p| p[3] == 0) && shot.pixels().any(|p| p[3] == 255));
}

#[test]
fn scenery_is_drawn_into_a_scene_and_the_same_wish_gives_the_same_bytes() {
    let dir = Folder::new();
    let (scene, town, again) = (dir.scene(), dir.path("town.loom"), dir.path("again.loom"));
    let draw = |out: &str| {
        json(&sceneloom(&[
            "scenery",
            &scene,
            "--setting",
            "old-town",
            "--json",
            "-o",
            out,
        ]))
    };
    let report = draw(&town);
    assert!(report["things"].as_u64() > Some(10), "{report}");
    assert!(report["voxels_changed"].as_u64() > Some(1000), "{report}");
    draw(&again);
    let bytes = |path: &str| std::fs::read(path).expect("written");
    assert!(bytes(&town) == bytes(&again));
}

#[test]
fn bad_arguments_are_named() {
    let dir = Folder::new();
    let scene = dir.scene();
    let out = dir.path("never.loom");
    refused(
        &["new", "--template", "spaceport", "-o", &out],
        &["spaceport", "straight"],
    );
    refused(
        &["generate", &dir.path("missing.loom"), "-o", &out],
        &["missing.loom"],
    );
    let scenery = |more: &[&str], needles: &[&str]| {
        refused(&[&["scenery", &scene, "-o", &out], more].concat(), needles);
    };
    scenery(&["--green", "-1"], &["--green is -1", "0 to 4"]);
    scenery(&["--built", "NaN"], &["--built is NaN"]);
    refused(&["generate", &scene, "--steps", "0", "-o", &out], &["steps", "0"]);
    refused(
        &["render", &scene, "--what", "smell", "-o", &dir.path("x")],
        &["smell", "semantic"],
    );
    refused(
        &["shot", &scene, "--view", "behind", "-o", &dir.path("x.png")],
        &["behind", "CAM_FRONT"],
    );
    let from_above = ["--eye", "0,0,40", "--look", "0,0,0", "-o", &dir.path("x.png")];
    refused(
        &[&["shot", &scene, "--what", "map"], &from_above[..]].concat(),
        &["--eye", "map"],
    );
    // Of a scene of one moment, too.
    refused(
        &["clip", &scene, "--what", "smell", "-o", &dir.path("x.gif")],
        &["smell", "turntable"],
    );
    for (text, needles) in [
        (r#"[{"remove_box": {"id": 99999}}]"#, ["99999", "edits.json"]),
        (r#"[{"remove_box": {"id": 1, "why": 2}}]"#, ["why", "edits.json"]),
        (
            r#"[{"paint_voxels": {"cells": [[200, 0, 0]], "class": "car"}}]"#,
            ["200", "edits.json"],
        ),
        (
            r#"[{"add_box": {"class": "terrain", "center_m": [1,1,1], "size_m": [1,1,1], "yaw_deg": 0}}]"#,
            ["terrain", "edits.json"],
        ),
        ("[{", ["edits.json", "line 1"]),
    ] {
        let edits = dir.write("edits.json", text);
        refused(&["edit", &scene, "--edits", &edits, "-o", &out], &needles);
    }
    assert!(!Path::new(&out).exists(), "nothing may be written");
}

#[test]
fn bad_files_are_named() {
    let dir = Folder::new();
    let whole = std::fs::read(dir.scene()).expect("written");
    let out = dir.path("never.loom");
    let truncated = dir.write("truncated.loom", &whole[..whole.len() / 2]);
    refused(&["generate", &truncated, "-o", &out], &["truncated.loom"]);
    let empty = dir.write("empty.loom", b"");
    refused(&["generate", &empty, "-o", &out], &["empty.loom"]);
    let road = |body: &str| {
        format!(
            r#"<OpenDRIVE><header revMajor="1" revMinor="6"/><road id="7" length="10" junction="-1"><planView>{body}</planView>
               <lanes><laneSection s="0"><right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right>
               </laneSection></lanes></road></OpenDRIVE>"#
        )
    };
    let line = |length: &str, x: &str| {
        format!(r#"<geometry s="0" x="{x}" y="0" hdg="0" length="{length}"><line/></geometry>"#)
    };
    for (name, body) in [
        ("nan.xodr", line("10", "NaN")),
        ("zero.xodr", line("0", "0")),
        ("none.xodr", String::new()),
    ] {
        let file = dir.write(name, road(&body));
        refused(&["import", &file, "-o", &out], &[name, "7"]);
    }
    let good = dir.write("good.xodr", road(&line("10", "0")));
    refused(
        &["import", &good, "--at", "5000,5000", "-o", &out],
        &["good.xodr", "5000"],
    );
    let scene = dir.path("scene.loom");
    let weights = dir.path("weights");
    std::fs::create_dir(&weights).expect("writable");
    refused(
        &["generate", &scene, "--weights", &weights, "-o", &out],
        &[".safetensors"],
    );
    for file in ["occ_vae.safetensors", "occ_dit.safetensors"] {
        std::fs::write(Path::new(&weights).join(file), b"not weights").expect("writable");
    }
    refused(
        &["generate", &scene, "--weights", &weights, "-o", &out],
        &[".safetensors"],
    );
    assert!(!Path::new(&out).exists(), "nothing may be written");
}

#[test]
fn doctor_reports_and_no_display_means_demo() {
    let report = json(&sceneloom(&["doctor", "--json"]));
    assert_eq!(report["display"], false);
    assert_eq!(report["weights"]["ok"], true, "{report}");
    assert!(
        report["adapter"]["name"].is_string(),
        "a software adapter at least: {report}"
    );
    let dir = Folder::new();
    let output = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .current_dir(dir.0.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the built program runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(String::from_utf8_lossy(&output.stderr).contains("no display"));
    let report = std::fs::read(dir.0.path().join("sceneloom-demo/report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
    let edits = report["edits"].as_array().expect("a list");
    assert!(edits.len() >= 5);
    assert!(
        edits.iter().all(|e| e["untouched_voxels_changed"] == 0),
        "{report}"
    );
    for file in report["files"].as_array().expect("a list") {
        let path = dir
            .0
            .path()
            .join("sceneloom-demo")
            .join(file.as_str().expect("a name"));
        assert!(path.metadata().is_ok_and(|m| m.len() > 500), "{}", path.display());
    }
}

/// A folder as Occ3D lays it out, made from procedural worlds: import, training data, evaluation.
#[test]
fn occ3d_frames_are_scenes_and_training_data() {
    use formats::{loom, occ3d};
    let dir = Folder::new();
    let scene = loom::load(Path::new(&dir.scene())).expect("a scene");
    let frame = scene.frame();
    let data = dir.path("gts");
    for token in ["a1", "b2"] {
        let folder = Path::new(&data).join("scene-1").join(token);
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("labels.npz"), occ3d::to_bytes(&frame.occupancy)).expect("writable");
    }
    let labels = format!("{data}/scene-1/a1/labels.npz");
    let imported = dir.path("imported.loom");
    let report = json(&sceneloom(&["import", &labels, "-o", &imported, "--json"]));
    assert_eq!(
        (&report["format"], &report["inferred"][1]),
        (&"occ3d".into(), &"boxes".into())
    );
    let found = loom::load(Path::new(&imported)).expect("a scene");
    assert_eq!((&*found.name, &found.frame().occupancy), ("a1", &frame.occupancy));
    // Most cars of the scene have a box of their class near their centre.
    let cars: Vec<_> = frame.boxes.values().filter(|b| b.class.name() == "car").collect();
    let near = |b: &scene::SceneBox| {
        let mut boxes = found.frame().boxes.values();
        boxes.any(|f| f.class == b.class && f.center_m.truncate().distance(b.center_m.truncate()) < 0.8)
    };
    let hit = cars.iter().filter(|b| near(b)).count();
    assert!(
        hit * 10 >= cars.len() * 8 && hit > 0,
        "{hit} of {} cars",
        cars.len()
    );

    let shards = dir.path("shards");
    let report = json(&sceneloom(&[
        "dataset",
        "occupancy",
        "--from",
        &data,
        "-o",
        &shards,
        "--json",
    ]));
    assert_eq!(report["frames"], 2);
    assert!(Path::new(&shards).join("shard_00000.safetensors").exists());
    let report = json(&sceneloom(&["eval", "vae", "--data", &data, "--json"]));
    assert_eq!(report["files"], 2);
    assert!(report["labels"]["mean"]["iou"].as_f64() > Some(0.5), "{report}");

    // What edits invent, on the same folder.
    let args = [
        "eval",
        "editing",
        "--data",
        &data,
        "--frames",
        "1",
        "--vehicles",
        "1",
    ];
    let report = json(&sceneloom(
        &[&args[..], &["--presets", "draft", "--json"]].concat(),
    ));
    let kinds = &report["invented"]["frames"]["by_preset"]["draft"]["kinds"];
    assert_eq!(kinds["remove"]["shown"]["invented"]["n"], 1, "{report}");
    assert_eq!(report["files"], 1);

    // Simulated labels as such files, with masks; a second run keeps them.
    let made = dir.path("made");
    let args = [
        "dataset", "occ3d", "--frames", "2", "--seed", "8", "-o", &made, "--json",
    ];
    assert_eq!(json(&sceneloom(&args))["frames"], 2);
    assert_eq!(json(&sceneloom(&args))["bytes"], 0);
    refused(
        &["dataset", "occ3d", "--frames", "3", "--seed", "9", "-o", &made],
        &["made with seed 8, found 9"],
    );
    let frame = occ3d::load(&Path::new(&made).join("00001/labels.npz")).expect("a frame");
    let [lidar, camera] = [frame.lidar_observed, frame.camera_observed].map(|m| m.expect("a mask"));
    let count = |mask: &[bool]| mask.iter().filter(|seen| **seen).count();
    assert!(frame.labels.count_set() > 5000 && count(&camera) > 1000);
    assert!(count(&lidar) > count(&camera) && camera.iter().zip(&lidar).all(|(c, l)| *l || !*c));

    refused(
        &["dataset", "occupancy", "--from", &dir.path("none"), "-o", &shards],
        &["none"],
    );
    refused(
        &["dataset", "occupancy", "--from", &shards, "-o", &shards],
        &["no .npz files"],
    );
    refused(
        &[
            "dataset",
            "occupancy",
            "--from",
            &data,
            "--frames",
            "9",
            "-o",
            &shards,
        ],
        &["--frames is 9", "at most 2"],
    );
    let broken = dir.write("labels.npz", "PK broken");
    refused(
        &["import", &broken, "-o", &dir.path("x.loom")],
        &["labels.npz", "not an npz archive"],
    );
    assert!(!Path::new(&dir.path("x.loom")).exists());
}

#[test]
fn folders_and_presets_that_no_edit_can_be_judged_on_are_named() {
    let dir = Folder::new();
    let empty = dir.path("empty");
    let bad = dir.path("bad");
    for folder in [&empty, &bad] {
        std::fs::create_dir_all(folder).expect("a folder");
    }
    std::fs::write(Path::new(&bad).join("labels.npz"), "PK broken").expect("writable");
    let of = |more: &[&str], needles: &[&str]| refused(&[&["eval", "editing"], more].concat(), needles);
    of(&["--presets", "best"], &["--presets best", "draft", "careful"]);
    of(&["--vehicles", "0"], &["--vehicles is 0"]);
    of(&["--frames", "0"], &["--frames is 0"]);
    of(&["--data", &dir.path("none")], &["none"]);
    of(&["--data", &empty], &["no .npz files"]);
    of(&["--data", &bad], &["labels.npz", "not an npz archive"]);
}
