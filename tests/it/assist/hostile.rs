//! Lines that no honest program sends: each is refused in one line, and the session goes on.

use std::fs;

use serde_json::{Value, json};

use super::process::{Talk, outcome};

/// Memory that hostile lines may cost, MiB.
const MEMORY_MIB: u64 = 200;

#[test]
fn lines_that_are_no_calls_are_refused_one_by_one() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    let revision = talk.did("state", json!({}))["revision"].clone();
    let before = talk.most_memory_mib();
    let deep = format!("{{\"id\": 9, \"call\": {}", "[".repeat(100_000));
    let nested = {
        let at = r#"{"at": {"time_s": 0, "edit": "#;
        let inner = r#"{"remove_box": {"id": 1}}"#;
        format!(
            r#"{{"id": 10, "call": "apply", "args": {{"edits": [{}{inner}{}]}}}}"#,
            at.repeat(60),
            "}}".repeat(60)
        )
    };
    let ten_megabytes = format!(
        r#"{{"id": 11, "call": "prompt", "args": {{"text": "{}"}}}}"#,
        "x".repeat(10 << 20)
    );
    let late_id = format!(
        r#"{{"call": "prompt", "args": {{"text": "{}"}}, "id": "late"}}"#,
        "y".repeat(10 << 20)
    );
    let numbers = format!(
        r#"{{"id": 12, "call": "apply", "args": {{"edits": [{}]}}}}"#,
        "0,".repeat(500_000) + "0"
    );
    let cases: Vec<(Vec<u8>, Value, &str)> = vec![
        (b"hello".to_vec(), Value::Null, "no JSON"),
        (b"[1, 2]".to_vec(), Value::Null, "no JSON object"),
        (b"{\"id\": 1".to_vec(), Value::Null, "no JSON"),
        (b"\xff\xfe{}".to_vec(), Value::Null, "no JSON"),
        (
            b"{\"id\": NaN, \"call\": \"state\"}".to_vec(),
            Value::Null,
            "no JSON",
        ),
        (
            b"{\"id\": {}, \"call\": \"state\"}".to_vec(),
            Value::Null,
            "id is neither",
        ),
        (b"{\"id\": 2}".to_vec(), json!(2), "call is missing"),
        (
            b"{\"id\": 3, \"call\": 4}".to_vec(),
            json!(3),
            "call is no string",
        ),
        (
            b"{\"id\": 4, \"call\": \"rm -rf /\"}".to_vec(),
            json!(4),
            "no call",
        ),
        (
            b"{\"id\": 5, \"call\": \"state\", \"args\": []}".to_vec(),
            json!(5),
            "args is no object",
        ),
        (
            b"{\"id\": 6, \"call\": \"state\", \"code\": \"x\"}".to_vec(),
            json!(6),
            "unknown key",
        ),
        (
            b"{\"id\": 7, \"call\": \"show\", \"args\": {\"time_s\": NaN}}".to_vec(),
            Value::Null,
            "no JSON",
        ),
        (
            b"{\"id\": 8, \"call\": \"show\", \"args\": {\"time_s\": 1e999}}".to_vec(),
            Value::Null,
            "no JSON",
        ),
        (deep.into_bytes(), Value::Null, "recursion limit"),
        (nested.into_bytes(), json!(10), ""),
        (ten_megabytes.into_bytes(), json!(11), "expected at most 1048576"),
        (late_id.into_bytes(), json!("late"), "expected at most 1048576"),
        (numbers.into_bytes(), json!(12), "edits[0]"),
    ];
    for (mut line, id, needle) in cases {
        line.push(b'\n');
        talk.write(&line);
        let reply = talk.line();
        let shown = String::from_utf8_lossy(&line[..line.len().min(80)]).into_owned();
        assert_eq!(reply["id"], id, "{shown}: {reply}");
        let error = outcome(&reply).expect_err(&shown);
        assert!(error.contains(needle), "{shown}: {error}");
    }
    talk.write(b"\n  \r\n");
    assert_eq!(
        talk.did("state", json!({}))["revision"],
        revision,
        "nothing has changed"
    );
    let more = talk.most_memory_mib().saturating_sub(before);
    assert!(more < MEMORY_MIB, "{more} MiB");
    assert!(talk.end().1);
}

#[test]
fn arguments_that_make_no_sense_are_refused_by_name() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    let revision = talk.did("state", json!({}))["revision"].clone();
    let car = |key: &str, value: Value| {
        let mut car = json!({ "class": "car", "center_m": [8, 0, 0.8], "size_m": [4, 2, 1.6], "yaw_deg": 0 });
        car[key] = value;
        json!({ "edits": [{ "add_box": car }] })
    };
    let cases = [
        ("apply", json!({ "edits": [] }), "edits holds 0"),
        ("apply", json!({ "edits": [{ "run": "rm" }] }), "edits[0]"),
        ("apply", json!({ "edits": [{ "adopt_result": {} }] }), "edits[0]"),
        ("apply", car("class", json!("dragon")), "class"),
        ("apply", car("center_m", json!([1e300, 0, 0])), "center"),
        ("apply", car("center_m", json!([1, 2])), "center_m"),
        ("apply", car("center_m", json!(["NaN", 0, 0])), "center_m"),
        ("apply", car("size_m", json!([-1, 2, 1])), "size"),
        ("apply", car("yaw_deg", json!(null)), "yaw_deg"),
        ("apply", car("code", json!("x")), "code"),
        (
            "apply",
            json!({ "edits": [{ "remove_box": { "id": 4_000_000_000_u32 } }] }),
            "does not exist",
        ),
        (
            "apply",
            json!({ "edits": [{ "remove_box": { "id": 1e20 } }] }),
            "id",
        ),
        (
            "apply",
            json!({ "edits": [{ "extend_map": { "ahead_m": 1e12 } }] }),
            "ahead_m",
        ),
        (
            "apply",
            json!({ "edits": [{ "set_length": { "length_s": 1e9 } }] }),
            "expected 0 to 600",
        ),
        (
            "apply",
            json!({ "edits": [{ "paint_voxels": { "cells": [[9_999_999, 0, 0]], "class": "car" } }] }),
            "outside",
        ),
        ("new", json!({ "template": "moon" }), "expected one of straight"),
        ("new", json!({ "template": "straight", "seed": -1 }), "seed"),
        ("render", json!({ "what": [] }), "what is empty"),
        ("render", json!({ "what": ["secrets"] }), "what holds"),
        (
            "render",
            json!({ "what": ["bev"], "cameras": ["CAM_UP"] }),
            "expected some of",
        ),
        ("render", json!({ "what": ["semantic"], "size": [0, 10] }), "size"),
        (
            "render",
            json!({ "what": ["semantic"], "size": [8192, 8192] }),
            "pixel",
        ),
        ("generate", json!({ "steps": 0 }), "steps"),
        ("generate", json!({ "steps": 1_000_000 }), "steps"),
        ("export", json!({ "format": "exe" }), "expected one of"),
        (
            "export",
            json!({ "format": "occ3d", "name": "run.sh" }),
            "ends in .npz",
        ),
        ("save", json!({ "file": "a.sh" }), "ends in .loom"),
        ("undo", json!({ "steps": 0 }), "steps"),
        ("undo", json!({}), "nothing to undo"),
        ("redo", json!({}), "nothing to redo"),
        ("restore_version", json!({ "name": "x" }), "no version"),
        (
            "keep_version",
            json!({ "name": "x".repeat(1000) }),
            "1000 characters",
        ),
        ("diff", json!({}), "exactly one"),
        ("add_track", json!({ "template": "fly" }), "template"),
        (
            "add_track",
            json!({ "box": 4_000_000, "template": "drive" }),
            "does not exist",
        ),
        (
            "add_track",
            json!({ "template": "drive", "length_s": 0 }),
            "length_s",
        ),
        ("open", json!({ "file": "missing.loom" }), "no such file"),
    ];
    for (call, args, needle) in cases {
        let error = talk
            .call(call, args.clone())
            .expect_err(&format!("{call} {args}"));
        assert!(error.contains(needle), "{call} {args}: {error}");
    }
    assert_eq!(
        talk.did("state", json!({}))["revision"],
        revision,
        "nothing has changed"
    );
    assert_eq!(
        fs::read_dir(dir.path()).expect("a folder").count(),
        0,
        "nothing was written"
    );
    assert!(talk.end().1);
}

#[test]
fn names_never_lead_out_of_the_folder() {
    let dir = tempfile::tempdir().expect("a folder");
    let inner = dir.path().join("in");
    fs::create_dir(&inner).expect("a folder");
    fs::copy("assets/scenes/first_light.loom", dir.path().join("secret.loom"))
        .or_else(|_| fs::write(dir.path().join("secret.loom"), "x").map(|()| 0))
        .expect("a file");
    let absolute = dir.path().join("secret.loom").display().to_string();
    let mut names = vec![
        "../secret.loom".to_owned(),
        "a/../../secret.loom".to_owned(),
        absolute,
        "..".to_owned(),
        ".hidden.loom".to_owned(),
        "a\\..\\..\\secret.loom".to_owned(),
        "".to_owned(),
        "a\u{0}.loom".to_owned(),
        format!("{}.loom", "n".repeat(5000)),
    ];
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink(dir.path(), inner.join("up")).expect("a link");
        symlink(dir.path().join("secret.loom"), inner.join("link.loom")).expect("a link");
        symlink(dir.path().join("made.loom"), inner.join("dangling.loom")).expect("a link");
        names.extend(["up/secret.loom", "link.loom", "dangling.loom"].map(str::to_owned));
    }
    let secret = fs::read(dir.path().join("secret.loom")).expect("a file");
    let mut talk = Talk::start("session", &inner);
    for name in &names {
        for (call, args) in [
            ("open", json!({ "file": name })),
            ("diff", json!({ "file": name })),
            ("save", json!({ "file": name, "replace": true })),
            (
                "export",
                json!({ "format": "occ3d", "name": format!("{name}.npz").replace("loom.npz", "npz"), "replace": true }),
            ),
            (
                "render",
                json!({ "what": ["bev"], "folder": name, "replace": true }),
            ),
        ] {
            // (a name that is only too odd to be a project is a fine name of another file inside)
            let is_inside = name == "link.loom" || name == "dangling.loom";
            if is_inside && call == "export" {
                continue;
            }
            let error = talk.call(call, args).expect_err(&format!("{call} {name}"));
            assert!(!error.contains("No such file"), "{call} {name}: {error}");
        }
    }
    assert_eq!(fs::read(dir.path().join("secret.loom")).expect("a file"), secret);
    let outside: Vec<_> = fs::read_dir(dir.path())
        .expect("a folder")
        .filter_map(Result::ok)
        .collect();
    assert_eq!(outside.len(), 2, "nothing was written outside: {outside:?}");
    assert!(talk.end().1);
}
