//! The same by the program itself: commands, a session, the assistants' server, a batch.

use serde_json::{Value, json};

use super::process::{refused, run};
use super::{Place, changed, hostile, small};
use crate::assist::process::Talk;

#[test]
fn commands_refuse_such_names_with_status_2() {
    let mut place = Place::new();
    let (scene, loom) = small();
    let text = |name: &str| place.at(name).display().to_string();
    let (good, bad, rig, edits, taken) = (
        text("good.loom"),
        text("bad.loom"),
        text("rig.json"),
        text("edits.json"),
        text("taken.loom"),
    );
    let out = place.out().display().to_string();
    for file in [&bad, &rig, &edits] {
        std::fs::write(file, "").expect("written");
    }
    std::fs::write(&good, &loom).expect("written");
    let rig_json = serde_json::to_value(&*scene.rig).expect("JSON");
    place.begin();
    let names = [
        place.at("elsewhere/x").display().to_string(),
        "../../x".into(),
        "..\\..\\x".into(),
        "\u{1b}[2J".into(),
        "NUL".into(),
    ];
    for (i, name) in names.iter().enumerate() {
        let mut hostile = rig_json.clone();
        hostile["cameras"][0]["name"] = json!(name);
        std::fs::write(
            &bad,
            changed(&loom, "scene.json", |value| value["rig"] = hostile.clone()),
        )
        .expect("written");
        std::fs::write(&rig, hostile.to_string()).expect("written");
        std::fs::write(&edits, json!([{ "set_rig": { "rig": hostile } }]).to_string()).expect("written");
        let small = ["--size", "16x9", "-o", &out];
        let ways: [Vec<&str>; 6] = [
            [&["render", &bad, "--what", "semantic"][..], &small].concat(),
            [
                &["render", &good, "--rig", &rig, "--what", "semantic,truth"][..],
                &small,
            ]
            .concat(),
            [&["export", &bad, "--format", "pictures"][..], &small].concat(),
            vec!["edit", &good, "--edits", &edits, "-o", &taken],
            vec!["import", &bad, "-o", &taken],
            vec!["check", &bad],
        ];
        // (the first name takes every way, the others those that wrote)
        for args in ways.iter().take(if i == 0 { 6 } else { 2 }) {
            let line = refused(args);
            assert!(line.contains("camera 0: the name"), "{line}");
        }
    }
    for file in [&bad, &rig, &edits] {
        std::fs::write(file, "").expect("written");
    }
    assert!(place.written().is_empty());
}

#[cfg(unix)]
#[test]
fn links_in_a_folder_lead_no_picture_out() {
    let mut place = Place::new();
    let (_, loom) = small();
    let file = place.at("scene.loom").display().to_string();
    std::fs::write(&file, loom).expect("written");
    std::os::unix::fs::symlink(
        place.at("elsewhere/x_semantic.png"),
        place.out().join("CAM_FRONT_LEFT_semantic.png"),
    )
    .expect("a link");
    std::os::unix::fs::symlink(place.at("elsewhere"), place.out().join("samples")).expect("a link");
    place.begin();
    let out = place.out().display().to_string();
    for args in [
        [
            "render", &file, "--what", "semantic", "--size", "16x9", "-o", &out,
        ],
        [
            "export", &file, "--format", "semantic", "--size", "16x9", "-o", &out,
        ],
        [
            "export", &file, "--format", "nuscenes", "--size", "16x9", "-o", &out,
        ],
    ] {
        let line = refused(&args);
        assert!(line.contains("a link that leads out"), "{line}");
    }
    place.written();
}

/// What a call wrote is in the folder; what it refused is one line.
fn tried(talk: &mut Talk, name: &str, args: Value) -> bool {
    match talk.call(name, args) {
        Ok(_) => true,
        Err(line) => {
            super::one_line(&line);
            false
        }
    }
}

#[test]
fn a_session_is_kept_in_its_folder() {
    let mut place = Place::new();
    let (scene, loom) = small();
    std::fs::write(place.out().join("small.loom"), loom).expect("written");
    let rig_json = serde_json::to_value(&*scene.rig).expect("JSON");
    place.begin();
    let mut talk = Talk::start("session", &place.out());
    talk.did("open", json!({ "file": "small.loom" }));
    let (mut refused, mut written) = (0, 0);
    for (i, name) in hostile(&place).into_iter().enumerate() {
        let mut rig = rig_json.clone();
        rig["cameras"][0]["name"] = json!(name);
        assert!(
            !tried(
                &mut talk,
                "apply",
                json!({ "edits": [{ "set_rig": { "rig": rig } }] })
            ),
            "{name:?}"
        );
        // As names of files: what leads nowhere else may be written.
        let calls = [
            ("save", json!({ "file": format!("{name}.loom"), "replace": true })),
            (
                "render",
                json!({ "what": ["bev"], "folder": name, "replace": true }),
            ),
            (
                "export",
                json!({ "format": "boxes", "name": format!("{name}.json"), "replace": true }),
            ),
            (
                "export",
                json!({ "format": "boxes", "name": name, "replace": true }),
            ),
            ("open", json!({ "file": name })),
        ];
        for (call, args) in calls.into_iter().take(if i % 5 == 0 { 5 } else { 1 }) {
            match tried(&mut talk, call, args) {
                true => written += 1,
                false => refused += 1,
            }
        }
        place.written();
    }
    assert!(refused > 80, "{refused} refused, {written} written");
    let render = json!({ "what": ["semantic"], "size": [16, 9], "folder": "pictures" });
    let files = talk.did("render", render)["files"].clone();
    assert!(
        files.to_string().contains("pictures/CAM_FRONT_LEFT_semantic.png"),
        "{files}"
    );
    assert!(talk.end().1);
    assert!(!place.written().is_empty());
}

#[cfg(unix)]
#[test]
fn a_session_writes_over_no_pipe() {
    let place = Place::new();
    let pipe = place.out().join("pipe.loom");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo").success());
    let mut talk = Talk::start("session", &place.out());
    let line = talk
        .call("save", json!({ "file": "pipe.loom", "replace": true }))
        .expect_err("a pipe");
    assert!(line.contains("is a pipe or a device"), "{line}");
    assert!(talk.end().1);
}

#[test]
fn the_assistants_server_is_kept_in_its_folder() {
    let mut place = Place::new();
    let (scene, _) = small();
    let rig_json = serde_json::to_value(&*scene.rig).expect("JSON");
    place.begin();
    let mut talk = Talk::start("mcp", &place.out());
    crate::assist::mcp::hello(&mut talk);
    for name in hostile(&place).into_iter().step_by(4) {
        let mut rig = rig_json.clone();
        rig["cameras"][0]["name"] = json!(name);
        let apply = json!({ "edits": [{ "set_rig": { "rig": rig } }] });
        let save = json!({ "file": format!("{name}/a.loom"), "replace": true });
        for (call, args) in [("apply", apply), ("save", save)] {
            talk.send(&json!({
                "jsonrpc": "2.0", "id": 1, "method": "tools/call",
                "params": { "name": call, "arguments": args },
            }));
            let reply = talk.line();
            let is_refused = reply["result"]["isError"] == true || !reply["error"].is_null();
            assert!(is_refused || call == "save", "{name:?}: {reply}");
        }
        place.written();
    }
    assert!(talk.end().1);
    place.written();
}

#[test]
fn plans_of_batches_name_no_folder() {
    let mut place = Place::new();
    let plan = place.at("plan.json");
    std::fs::write(&plan, "").expect("written");
    place.begin();
    let out = place.out().join("batch").display().to_string();
    let file = plan.display().to_string();
    for name in hostile(&place).into_iter().step_by(9) {
        let text = json!({
            "format": "sceneloom_batch", "version": 1, "base": { "template": "straight" }, "write": [{ "format": name }],
        });
        std::fs::write(&plan, text.to_string()).expect("written");
        let (code, said, error) = run(&["batch", &file, "-o", &out]);
        assert!(
            code != 0 && error.lines().count() <= 1,
            "{name:?}: {said} {error}"
        );
    }
    std::fs::write(&plan, "").expect("written");
    place.written();
}
