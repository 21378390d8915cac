//! A session from its first call to the end of its input.

use std::fs;

use serde_json::{Value, json};

use super::process::{Talk, command};

/// A pedestrian at a place, as an edit.
fn pedestrian(x: f64, y: f64) -> Value {
    json!({ "add_box": {
        "class": "pedestrian", "center_m": [x, y, 0.9], "size_m": [0.7, 0.7, 1.8], "yaw_deg": -90,
    } })
}

#[test]
fn a_scene_is_made_changed_taken_back_and_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    let first = talk.did("state", json!({}));
    assert_eq!((&first["revision"], &first["undo"]), (&json!(1), &Value::Null));

    let made = talk.did("new", json!({ "template": "t-junction", "seed": 3 }));
    assert_eq!(made["revision"], 2);
    assert!(
        made["boxes"].as_u64() > Some(2) && made["occupied_voxels"].as_u64() > Some(10_000),
        "{made}"
    );
    talk.did("keep_version", json!({ "name": "before" }));

    let crossing = json!({ "paint_bev": {
        "layer": "ped_crossing", "shape": { "rect": { "min_m": [12, -3], "max_m": [15, 3] } }, "value": true,
    } });
    let edits = [
        pedestrian(13.0, 1.0),
        pedestrian(13.5, 2.0),
        pedestrian(14.0, -1.0),
        crossing,
    ];
    let applied = talk.did("apply", json!({ "edits": edits, "step": "people on a crossing" }));
    assert_eq!(
        (&applied["revision"], &applied["step"]),
        (&json!(3), &json!("people on a crossing"))
    );
    let changed = &applied["changed"];
    let ids = changed["boxes_added"].as_array().expect("ids").clone();
    assert_eq!(
        (ids.len(), &changed["boxes"]["added"]),
        (3, &json!(3)),
        "{changed}"
    );
    assert!(changed["layers"]["ped_crossing"]["gained"].as_u64() > Some(30));
    assert!(changed["classes"]["pedestrian"]["gained"].as_u64() > Some(5));
    assert!(applied["draft_columns"].as_u64() > Some(0));

    // One call is one step, and an old state has its old number.
    let undone = talk.did("undo", json!({}));
    assert_eq!(
        (&undone["revision"], &undone["steps"]),
        (&json!(2), &json!(["people on a crossing"]))
    );
    assert_eq!(undone["changed"]["boxes_removed"], json!(ids));
    assert_eq!(talk.did("redo", json!({}))["revision"], 3);
    let diff = talk.did("diff", json!({ "version": "before" }));
    assert_eq!(diff["changed"], *changed);

    let state = talk.did("state", json!({ "most_boxes": 1000 }));
    let of_us: Vec<&Value> = state["boxes"]
        .as_array()
        .expect("boxes")
        .iter()
        .filter(|b| ids.contains(&b["id"]))
        .collect();
    assert_eq!(of_us.len(), 3);
    assert!(
        of_us.iter().any(|b| b["place"] == "13 m ahead, 1 m left"),
        "{of_us:?}"
    );

    // Saved, opened again, and nothing differs.
    let saved = talk.did("save", json!({ "file": "made/a.loom" }));
    let bytes = fs::metadata(dir.path().join("made/a.loom"))
        .expect("written")
        .len();
    assert_eq!(saved["file"]["bytes"], bytes);
    assert!(talk.call("save", json!({ "file": "made/a.loom" })).is_err());
    talk.did("undo", json!({ "steps": 2 }));
    let opened = talk.did("open", json!({ "file": "made/a.loom" }));
    assert_eq!(opened["boxes"], state["counts"]["boxes"]);
    // The file keeps what was kept here.
    let kept = formats::loom::load(&dir.path().join("made/a.loom"))
        .expect("a project")
        .kept
        .clone();
    let names: Vec<_> = kept
        .versions
        .iter()
        .map(|v| (v.name.as_str(), v.starred))
        .collect();
    assert_eq!(names, [("before", true)]);
    let diff = talk.did("diff", json!({ "file": "made/a.loom" }));
    assert_eq!(
        (&diff["changed"]["voxels"], &diff["changed"]["boxes"]["added"]),
        (&json!(0), &json!(0))
    );

    let written = talk.did("export", json!({ "format": "occ3d" }));
    assert_eq!(written["files"][0]["name"], "labels.npz");
    let listed = talk.did("list_files", json!({}));
    let names: Vec<&Value> = listed["files"]
        .as_array()
        .expect("files")
        .iter()
        .map(|f| &f["name"])
        .collect();
    assert_eq!(names, ["labels.npz", "made/a.loom"]);
    let (rest, ended) = talk.end();
    assert!(rest.is_empty() && ended);
}

#[test]
fn words_make_a_scene_and_change_it_and_say_what_they_became() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    let text = "an intersection at night in the rain, three parked cars, a glorp";
    let made = talk.did("prompt", json!({ "text": text, "make": "new", "seed": 3 }));
    assert_eq!(
        made["not_understood"][0],
        json!({ "words": "glorp", "why": "unknown" })
    );
    let cars = made["phrases"].as_array().expect("phrases").iter();
    let cars: Vec<&Value> = cars
        .filter(|p| p["added"].as_array().is_some_and(|a| a.len() == 3))
        .collect();
    assert_eq!(cars.len(), 1, "{made}");
    assert!(
        cars[0]["became"].as_str().is_some_and(|b| b.contains("parked")),
        "{made}"
    );
    let state = talk.did("state", json!({}));
    assert_eq!(
        (&state["conditions"]["weather"], &state["words"]),
        (&json!("rain"), &json!([text]))
    );

    // More than one fits: nothing changes, and the answer names one.
    let asked = talk.did("prompt", json!({ "text": "remove the parked car" }));
    assert_eq!(asked["changed"]["boxes"]["removed"], 0);
    let name = asked["questions"][0]["candidates"][1]["name"]
        .as_str()
        .expect("a name")
        .to_owned();
    let revision = asked["revision"].clone();
    let removed = talk.did("prompt", json!({ "text": format!("remove {name}") }));
    assert_ne!(removed["revision"], revision);
    assert_eq!(format!("#{}", removed["changed"]["boxes_removed"][0]), name);
    assert_eq!(talk.did("undo", json!({}))["revision"], revision);
    let nothing = talk.call("prompt", json!({ "text": "  " })).expect_err("empty");
    assert!(nothing.contains("text is empty"), "{nothing}");
    assert!(talk.end().1);
}

#[test]
fn what_moves_is_added_listed_shown_and_stopped() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    talk.did("new", json!({ "template": "straight", "seed": 3 }));
    let added = talk.did("apply", json!({ "edits": [pedestrian(20.0, 8.0)] }));
    let id = added["changed"]["boxes_added"][0].clone();
    talk.did(
        "add_track",
        json!({ "template": "drive", "mps": 5, "length_s": 6 }),
    );
    let crossing = talk.did(
        "add_track",
        json!({ "box": id, "template": "cross", "mps": 1.5, "from_s": 1 }),
    );
    assert_eq!(
        (&crossing["length_s"], &crossing["track"]["box"]),
        (&json!(6.0), &id)
    );
    assert_eq!(
        crossing["changed"]["tracks"],
        json!({ "added": 1, "removed": 0, "changed": 0 })
    );
    let tracks = talk.did("list_tracks", json!({}));
    assert_eq!(tracks["tracks"].as_array().map(Vec::len), Some(2));
    let passes = |at: usize| -> Vec<f64> {
        let pass = &tracks["tracks"][1]["passes"][at];
        pass.as_array()
            .expect("a pass")
            .iter()
            .filter_map(Value::as_f64)
            .collect()
    };
    assert!((passes(0)[2] - passes(2)[2]).abs() > 3.0, "it crosses: {tracks}");
    let shown = talk.did("show", json!({ "time_s": 4 }));
    assert!(shown["ego"][0].as_f64() > Some(15.0), "{shown}");
    for beyond in [json!(-1), json!(7), json!(1e300)] {
        let error = talk
            .call("show", json!({ "time_s": beyond }))
            .expect_err("no such moment");
        assert!(error.contains("expected 0 to 6 s"), "{error}");
    }
    talk.did("remove_track", json!({ "box": id }));
    let gone = talk.call("remove_track", json!({ "box": id })).expect_err("gone");
    assert!(gone.contains("has no track"), "{gone}");
    assert!(talk.end().1);
}

#[test]
fn generating_changes_nothing_elsewhere_and_is_one_step() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    talk.did("new", json!({ "template": "straight", "seed": 3 }));
    let added = talk.did("apply", json!({ "edits": [pedestrian(12.0, 6.0)] }));
    let made = talk.did("generate", json!({ "quality": "draft", "steps": 1 }));
    assert_eq!(made["untouched_voxels_changed"], 0);
    assert_eq!(
        (&made["draft_columns"], &made["step"]),
        (&json!(0), &json!("Generate")),
        "{made}"
    );
    assert!(made["region_columns"].as_u64() > Some(0) && made["network_calls"].as_u64() > Some(0));
    assert_eq!(talk.did("undo", json!({}))["revision"], added["revision"]);
    let unknown = talk
        .call("generate", json!({ "quality": "best" }))
        .expect_err("no such preset");
    assert!(unknown.contains("expected one of draft"), "{unknown}");
    assert!(talk.end().1);
}

#[test]
fn pictures_and_findings() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    talk.did("new", json!({ "template": "straight", "seed": 3 }));
    let rendered = talk.did(
        "render",
        json!({ "what": ["bev", "semantic", "lidar"], "cameras": ["CAM_FRONT"], "size": [160, 90] }),
    );
    let names: Vec<&str> = rendered["files"]
        .as_array()
        .expect("files")
        .iter()
        .filter_map(|f| f["name"].as_str())
        .collect();
    assert!(
        names.contains(&"pictures/bev.png") && names.contains(&"pictures/CAM_FRONT_semantic.png"),
        "{names:?}"
    );
    assert!(!names.iter().any(|n| n.contains("CAM_BACK")), "{names:?}");
    for name in &names {
        assert!(dir.path().join(name).is_file(), "{name}");
    }
    let again = talk
        .call("render", json!({ "what": ["bev"] }))
        .expect_err("there already");
    assert!(again.contains("replace"), "{again}");

    // Two pedestrians in one place: told at once, and found by the check.
    let both = talk.did(
        "apply",
        json!({ "edits": [pedestrian(15.0, 7.0), pedestrian(15.35, 7.0)] }),
    );
    let warnings = both["warnings"].to_string();
    assert!(warnings.contains("overlapping_boxes"), "{warnings}");
    let checked = talk.did("check", json!({ "sensors": false }));
    let found = checked["findings"].as_array().expect("findings").iter();
    assert!(
        found.clone().any(|f| f["check"] == "overlapping_boxes"),
        "{checked}"
    );
    assert_eq!(checked["fixed"], Value::Null);
    let fixed = talk.did("check", json!({ "sensors": false, "fix": true }));
    assert!(
        fixed["errors"].as_u64() < checked["errors"].as_u64() || checked["errors"] == 0,
        "{fixed}"
    );
    assert!(talk.end().1);
}

#[test]
fn the_same_calls_give_the_same_replies() {
    let run = || {
        let dir = tempfile::tempdir().expect("a folder");
        let mut talk = Talk::start("session", dir.path());
        let calls = [
            ("new", json!({ "template": "roundabout", "seed": 5 })),
            ("prompt", json!({ "text": "two buses ahead, at dusk", "seed": 2 })),
            ("apply", json!({ "edits": [pedestrian(9.0, 5.0)] })),
            ("state", json!({})),
            ("save", json!({ "file": "a.loom" })),
            ("undo", json!({ "steps": 9 })),
        ];
        let replies: Vec<Result<Value, String>> = calls.into_iter().map(|(c, a)| talk.call(c, a)).collect();
        let bytes = fs::read(dir.path().join("a.loom")).expect("written");
        (replies, bytes)
    };
    let (a, b) = (run(), run());
    assert_eq!(a.0, b.0);
    assert!(a.0.iter().all(Result::is_ok) && a.1 == b.1);
}

#[test]
fn every_example_of_the_schema_is_carried_out() {
    let dir = tempfile::tempdir().expect("a folder");
    let schema = command(&["schema", "--compact"])
        .output()
        .expect("it runs")
        .stdout;
    let schema: Value = serde_json::from_slice(&schema).expect("JSON");
    let mut talk = Talk::start("session", dir.path());
    talk.did("new", json!({ "template": "straight", "seed": 3 }));
    // What others need comes first.
    let first = [
        "save",
        "keep_version",
        "apply",
        "undo",
        "redo",
        "add_track",
        "remove_track",
    ];
    let calls = schema["x-calls"].as_object().expect("calls");
    let others = calls
        .keys()
        .map(String::as_str)
        .filter(|c| !first.contains(c) && *c != "generate");
    for name in first.into_iter().chain(others) {
        talk.did(name, calls[name]["example"].clone());
    }
    assert!(talk.end().1);
}

#[test]
fn a_session_that_cannot_begin_says_why() {
    for (args, needle) in [
        (vec!["session", "--folder", "/nowhere"], "folder /nowhere"),
        (vec!["session", "/nowhere.loom"], "/nowhere.loom"),
        (vec!["mcp", "--folder", "/nowhere"], "folder /nowhere"),
        (
            vec!["mcp", "--listen", "0.0.0.0:0", "--token", "0123456789abcdef"],
            "loopback",
        ),
        (
            vec!["mcp", "--listen", "127.0.0.1:0", "--token", "short"],
            "at least 16",
        ),
    ] {
        let output = command(&args).output().expect("it runs");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            (output.status.code(), error.trim_end().lines().count()),
            (Some(2), 1),
            "{args:?}: {error}"
        );
        assert!(error.contains(needle), "{args:?}: {error}");
    }
}
