//! The built command on files of many formats, and on what is no file at all: one line, no waiting, no reading to the end.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use formats::{box_list, export, import, loom};
use scene::{Class, Window};
use serde_json::Value;

fn sceneloom(args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the built program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

fn import(file: &str, out: &str) -> Value {
    let (code, said, error) = sceneloom(&["import", file, "-o", out, "--json"]);
    assert_eq!(code, 0, "{error}");
    serde_json::from_str(&said).expect("one JSON object")
}

/// A labelled cloud of a scene's own voxels is that scene's occupancy.
#[test]
fn a_point_cloud_becomes_a_scene() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let scene = app::open::from_template("straight", 3).expect("a template");
    let occupancy = &scene.frame().occupancy;
    let mut cloud = Vec::new();
    for (x, y, z, class) in occupancy.iter_set() {
        let at = Window::center(x, y, z).as_vec3();
        cloud.extend([at.x, at.y, at.z].into_iter().flat_map(f32::to_le_bytes));
        cloud.push(class);
    }
    let header = format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
        cloud.len() / 13
    );
    std::fs::write(path("street.pcd"), [header.as_bytes(), &cloud].concat()).expect("written");
    let report = import(&path("street.pcd"), &path("street.loom"));
    assert_eq!(
        (&report["format"], &report["skipped"]),
        (&"pcd".into(), &serde_json::json!({}))
    );
    assert_eq!(report["occupied_voxels"], occupancy.count_set());
    let found = loom::load(Path::new(&path("street.loom"))).expect("a scene");
    assert!(found.frame().occupancy == *occupancy && &*found.name == "street");
    // The classes are enough to infer roads and boxes from, as with any labels.
    let cars = found
        .frame()
        .boxes
        .values()
        .filter(|b| b.class == Class::Car)
        .count();
    assert!(cars > 0 && found.frame().inferred.layout, "{report}");
    // Any command takes it as it is.
    let (code, said, error) = sceneloom(&["check", &path("street.pcd"), "--json"]);
    assert!(code < 2 && said.starts_with('{'), "{error}");
}

#[test]
fn a_list_of_boxes_becomes_a_scene() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let scene = app::open::from_template("straight", 3).expect("a template");
    let bytes = box_list::to_bytes("s", scene.frame(), None, None, None).expect("finite");
    std::fs::write(path("boxes.json"), bytes).expect("written");
    let report = import(&path("boxes.json"), &path("boxes.loom"));
    assert_eq!(report["boxes"], scene.frame().boxes.len());
    let found = loom::load(Path::new(&path("boxes.loom"))).expect("a scene");
    assert_eq!(found.frame().boxes, scene.frame().boxes);
}

/// The help names what the tables hold.
#[test]
fn the_help_lists_every_format() {
    let (code, help, _) = sceneloom(&["import", "--help"]);
    let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(code == 0 && words.contains(&import::in_words()), "{help}");
    let (_, help, _) = sceneloom(&["export", "--help"]);
    for format in export::all() {
        assert!(help.contains(format.id), "{} is not in {help}", format.id);
    }
}

/// Pipes, devices, folders and sparse files are refused at once wherever a file can be named.
#[cfg(unix)]
#[test]
fn what_is_no_file_of_a_sane_size_is_refused_at_once() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let made = Command::new("mkfifo").arg(path("pipe")).status();
    assert!(made.expect("mkfifo").success());
    let sparse = std::fs::File::create(path("sparse.loom")).expect("made");
    sparse.set_len(1 << 36).expect("a sparse file");
    std::fs::write(path("s.loom"), assets::scenes::FIRST_LIGHT).expect("written");
    let since = Instant::now();
    let mut refusals = 0;
    for (name, what) in [
        (path("pipe"), "a pipe, expected a regular file"),
        ("/dev/zero".to_owned(), "a device, expected a regular file"),
        (path(""), "a folder, expected a regular file"),
        (path("sparse.loom"), "bytes, expected at most"),
    ] {
        let (scene, out) = (path("s.loom"), path("out"));
        let commands: [&[&str]; 6] = [
            &["import", &name, "-o", &out],
            &["check", &name],
            &["export", &name, "--format", "occ3d", "-o", &out],
            &["edit", &scene, "--edits", &name, "-o", &out],
            &["render", &scene, "--what", "lidar", "--rig", &name, "-o", &out],
            &["diff", &name, &scene],
        ];
        for args in commands {
            let (code, _, error) = sceneloom(args);
            let lines = error.trim_end().lines().count();
            assert!(
                code == 2 && lines == 1 && error.contains(what),
                "{args:?}: {code} {error}"
            );
            refusals += 1;
        }
    }
    assert!(
        refusals == 24 && since.elapsed() < Duration::from_secs(60),
        "{:?}",
        since.elapsed()
    );
    assert!(!dir.path().join("out").exists());
}

/// What a file holds a megabyte of is quoted in part.
#[test]
fn a_megabyte_in_a_file_is_a_line_of_300_characters() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let long = "x".repeat(1 << 20);
    std::fs::write(path("s.loom"), assets::scenes::FIRST_LIGHT).expect("written");
    std::fs::write(
        path("a.xodr"),
        format!("<OpenDRIVE><road length='{long}'/></OpenDRIVE>"),
    )
    .expect("written");
    std::fs::write(path("b.xodr"), format!("<{long}/>")).expect("written");
    let list = format!("{{\"format\":\"sceneloom_boxes\",\"boxes\":[{{\"id\":1,\"class\":{long:?}}}]}}");
    std::fs::write(path("boxes.json"), list).expect("written");
    std::fs::write(path("edits.json"), format!("[{{{long:?}:1}}]")).expect("written");
    std::fs::write(path("rig.json"), format!("{{\"name\":1,{long:?}:1}}")).expect("written");
    let out = path("out");
    let (scene, edits, rig) = (path("s.loom"), path("edits.json"), path("rig.json"));
    let (a, b, boxes) = (path("a.xodr"), path("b.xodr"), path("boxes.json"));
    let commands: [(&[&str], &str); 5] = [
        (&["import", &a, "-o", &out], "a.xodr"),
        (&["import", &b, "-o", &out], "b.xodr"),
        (&["import", &boxes, "-o", &out], "boxes.json"),
        (&["edit", &scene, "--edits", &edits, "-o", &out], "edits.json"),
        (
            &["render", &scene, "--what", "lidar", "--rig", &rig, "-o", &out],
            "rig.json",
        ),
    ];
    for (args, file) in commands {
        let (code, _, error) = sceneloom(args);
        let line = error.trim_end();
        // "sceneloom: " goes before it.
        assert!(code == 2 && line.contains(file), "{args:?}: {line}");
        assert!(
            line.chars().count() <= 312 && !line.contains('\n'),
            "{}: {line}",
            line.len()
        );
    }
}

/// A drive with pictures in tables of nuScenes becomes what the networks that draw pictures learn from.
#[test]
fn drives_become_pictures_to_train_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let run = |args: &[&str]| {
        let (code, said, error) = sceneloom(args);
        assert_eq!(code, 0, "{args:?}: {error}");
        said
    };
    let [edits, still, drive, tables, shards] =
        ["edits.json", "still.loom", "drive.loom", "tables", "shards"].map(path);
    let moves = r#"[{"set_length": {"length_s": 1.0, "rate_hz": 2.0}}, {"let_move": {"template": "follow", "mps": 4.0}}]"#;
    std::fs::write(&edits, moves).expect("written");
    run(&["new", "--template", "t-junction", "--seed", "1", "-o", &still]);
    run(&["edit", &still, "--edits", &edits, "-o", &drive]);
    let export = [
        "export", "--format", "nuscenes", "--size", "160x90", "-o", &tables,
    ];
    run(&[&export[..1], &[&drive], &export[1..]].concat());
    let pictures = |more: &[&str]| {
        let args = [
            "dataset", "pictures", "--from", &tables, "-o", &shards, "--size", "160x90",
        ];
        sceneloom(&[&args[..], more].concat())
    };
    let (code, said, error) = pictures(&["--json"]);
    assert_eq!(code, 0, "{error}");
    let report: Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!(report["frames"], 2, "three key frames: {report}");
    assert_eq!(report["key_frames_without_pictures"], 0);
    let bytes = std::fs::read(Path::new(&shards).join("shard_00000.safetensors")).expect("a shard");
    let file = safetensors::SafeTensors::deserialize(&bytes).expect("safetensors");
    let tensor = |name: &str| file.tensor(name).expect("an array");
    assert_eq!(tensor("rgb").shape(), [2, 2, 6, 90, 160, 3]);
    // The second moment of a pair is the first of the next.
    let rgb = tensor("rgb").data().to_vec();
    let moment = rgb.len() / 4;
    assert!(rgb[moment..2 * moment] == rgb[2 * moment..3 * moment]);
    // Clockwise, each camera's own pictures, in order of time.
    let ring = [
        "FRONT_LEFT",
        "FRONT",
        "FRONT_RIGHT",
        "BACK_RIGHT",
        "BACK",
        "BACK_LEFT",
    ];
    for (view, name) in ring.iter().enumerate() {
        let folder = Path::new(&tables).join(format!("samples/CAM_{name}"));
        let mut files: Vec<_> = std::fs::read_dir(folder).expect("pictures").collect();
        files.sort_by_key(|f| f.as_ref().expect("a file").file_name());
        for (i, file) in files.iter().take(2).enumerate() {
            let picture = image::open(file.as_ref().expect("a file").path())
                .expect("a JPEG")
                .to_rgb8();
            let at = i * moment + view * moment / 6;
            assert!(picture.as_raw()[..] == rgb[at..at + moment / 6], "{name} {i}");
        }
    }
    // What the voxels tell is what the renderer shows at the places of the cameras.
    let (class, told) = (
        tensor("class").data().to_vec(),
        tensor("told_class").data().to_vec(),
    );
    let depth = tensor("told_depth").data().to_vec();
    let known = |i: &usize| depth[2 * i] != 0 || depth[2 * i + 1] != 0;
    let all: Vec<usize> = (0..class.len()).filter(known).collect();
    let same = all.iter().filter(|i| class[**i] == told[**i]).count();
    assert!(
        all.len() * 3 > class.len() && same * 10 > all.len() * 7,
        "{same} of {}",
        all.len()
    );
    let floats = |name: &str| -> Vec<f32> {
        let (quads, _) = tensor(name).data().as_chunks::<4>();
        quads.iter().map(|q| f32::from_le_bytes(*q)).collect()
    };
    let poses = floats("map_from_camera");
    let front = |moment: usize| [3, 7].map(|axis| poses[(moment * 6 + 1) * 16 + axis]);
    let [a, b] = [front(0), front(1)];
    let way_m = (a[0] - b[0]).hypot(a[1] - b[1]);
    assert!(
        (1.5..2.5).contains(&way_m) && a[0].hypot(a[1]) < 3.0,
        "{a:?} {b:?}"
    );
    for (more, needle) in [
        (&["--frames", "3"][..], "--frames is 3, expected 1 to 2"),
        (&["--drives", "1..2"], "--drives is 1..2"),
        (&["--drives", "x"], "0..8"),
    ] {
        let (code, _, error) = pictures(more);
        assert!(
            code == 2 && error.contains(needle) && error.lines().count() <= 2,
            "{code} {error}"
        );
    }
    let (code, _, error) = sceneloom(&["dataset", "pictures", "--from", &shards, "-o", &path("x")]);
    assert!(
        code == 2 && error.contains("expected a folder of nuScenes tables"),
        "{error}"
    );
}

/// A sweep in its sensor's frame says that it was lifted, and is lifted as it is asked to be.
#[test]
fn a_sweep_is_lifted_onto_the_map_and_says_so() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let mut points = String::new();
    for i in 0..2560 {
        let (x, y) = (f64::from(i % 80) * 0.5 - 20.0, f64::from(i / 80) * 0.5 - 8.0);
        points.push_str(&format!("{x} {y} -1.84\n"));
    }
    let header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2560\nHEIGHT 1\nPOINTS 2560\nDATA ascii\n";
    std::fs::write(path("sweep.pcd"), format!("{header}{points}")).expect("written");
    let report = import(&path("sweep.pcd"), &path("sweep.loom"));
    let told = "the sweep lies in its sensor's frame: lifted by 1.84 m";
    let kept = "sweep.pcd stays with the scene, all its fields too";
    assert_eq!(report["notes"], serde_json::json!([told, kept]));
    let args = |lift: &str| {
        [
            "import",
            &path("sweep.pcd"),
            "--lift",
            lift,
            "-o",
            &path("b.loom"),
        ]
        .map(str::to_owned)
    };
    let run = |lift: &str| {
        let args = args(lift);
        sceneloom(&args.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let (code, said, _) = run("1.5");
    assert!(
        code == 0 && said.contains("lifted by 1.50 m, as asked for"),
        "{said}"
    );
    let (code, _, error) = run("0");
    assert!(
        code == 2 && error.contains("none of 2560 points lies on the map"),
        "{code} {error}"
    );
    let (code, _, error) = run("NaN");
    assert!(code == 2 && error.contains("a lift of NaN m"), "{code} {error}");
    let (code, _, error) = sceneloom(&[
        "import",
        &path("sweep.loom"),
        "--lift",
        "1",
        "-o",
        &path("c.loom"),
    ]);
    assert!(
        code == 2 && error.contains("expected a point cloud"),
        "{code} {error}"
    );
}

/// What is not read is called what it is, whatever its name says.
#[test]
fn files_that_are_not_read_are_called_what_they_are() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    for (name, bytes, word) in [
        (
            "sample.json",
            &b"[{\"token\": \"a\"}]"[..],
            "a part of nuScenes' tables",
        ),
        ("drive.mcap", b"\x89MCAP0\r\n", "an MCAP recording"),
        ("map", b"{\"type\": \"FeatureCollection\"}", "GeoJSON"),
        ("a.xodr", b"PK\x03\x04", "a zip archive"),
        ("b.json", b"{\"boxes\": []}", "no list of boxes"),
        ("c.dat", b"\0\0\0\0", "a file of a kind that is not known"),
    ] {
        std::fs::write(path(name), bytes).expect("written");
        let (code, _, error) = sceneloom(&["import", &path(name), "-o", &path("out.loom")]);
        assert_eq!(code, 2, "{error}");
        assert!(
            error.contains(word) && error.trim_end().lines().count() == 1,
            "{error}"
        );
    }
    std::fs::create_dir(dir.path().join("clouds")).expect("made");
    std::fs::write(path("clouds/000000.pcd"), "").expect("written");
    let (code, _, error) = sceneloom(&["import", &path("clouds"), "-o", &path("out.loom")]);
    assert!(code == 2 && error.contains("such as 000000.pcd"), "{error}");
}
