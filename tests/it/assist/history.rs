//! The history by calls: listed, a step left out, kept in the file.

use serde_json::json;

use super::process::{Talk, command};

#[test]
fn a_session_goes_on_with_the_history_of_its_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    let prompt = |text: &str| json!([{ "set_prompt": { "prompt": text } }]);
    let car = json!([{ "add_box": {
        "class": "car", "center_m": [20, 0, 0.8], "size_m": [4.5, 1.9, 1.6], "yaw_deg": 0,
    } }]);
    talk.did("apply", json!({ "edits": prompt("fog"), "step": "fog" }));
    let added = talk.did("apply", json!({ "edits": car, "step": "car" }));
    let id = added["changed"]["boxes_added"][0].clone();
    let away = json!([{ "move_box": { "id": id, "center_m": [24, 0, 0.8] } }]);
    talk.did("apply", json!({ "edits": away, "step": "away" }));
    talk.did("save", json!({ "file": "a.loom" }));
    let left = talk.did("undo", json!({ "step": 2 }));
    assert_eq!(left["step"], "Leave out car");
    let warning = left["warnings"][0].as_str().expect("a warning");
    assert!(
        warning.starts_with("away: box ") && warning.ends_with("does not exist in this frame"),
        "{left}"
    );
    let found = talk.did("history", json!({}));
    let line = |i: usize| {
        (
            found["steps"][i]["name"].clone(),
            found["steps"][i]["left_out"].clone(),
        )
    };
    assert_eq!(
        [line(0), line(2)],
        [(json!("Open"), json!(false)), (json!("car"), json!(true))]
    );
    assert_eq!(
        (&found["shown"], &found["steps"][2]["author"]),
        (&json!(4), &json!("assistant"))
    );
    talk.did("undo", json!({}));
    let refused = talk.call("undo", json!({ "step": 9 })).expect_err("no step");
    assert_eq!(refused, "step 9 does not exist, expected 1 to 3");
    drop(talk);
    // By the command line, and in a session that begins with the file.
    let run = |args: &[&str]| {
        let mut command = command(args);
        command.current_dir(dir.path()).output().expect("runs")
    };
    let listed = run(&["history", "a.loom", "--replay"]);
    let text = String::from_utf8(listed.stdout).expect("text");
    let expected = "    0 Open\n    1 fog (assistant)\n    2 car (assistant)\n>   3 away (assistant)\nreplayed from its origin: the same scene\n";
    assert_eq!((listed.status.code(), text.as_str()), (Some(0), expected));
    let left = run(&["history", "a.loom", "--leave-out", "1", "-o", "b.loom", "--json"]);
    assert_eq!(left.status.code(), Some(0), "{left:?}");
    let again = run(&["history", "b.loom"]);
    let text = String::from_utf8(again.stdout).expect("text");
    assert!(
        text.contains("1 fog (assistant), left out\n") && text.contains(">   4 Leave out a step (user)"),
        "{text}"
    );
    let refused = run(&["history", "a.loom", "--leave-out", "7", "-o", "c.loom"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).expect("text");
    assert_eq!(
        said,
        "sceneloom: a.loom: step 7 does not exist, expected 1 to 3\n"
    );
}
