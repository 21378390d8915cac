//! Assistants in the window: off until the user lets them in, and then at work on the scene that is shown.

use std::net::TcpStream;
use std::thread::JoinHandle;

use app::shell::guests::Guests;
use assist::WindowDoor;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use serde_json::{Value, json};

use super::bench::Bench;
use crate::assist::http::call;

/// A window with a door on any free port.
fn bench() -> Bench {
    let mut bench = Bench::new();
    bench.off();
    let folder = bench.folder.path().to_owned();
    bench.app().guests = Guests::new(Box::new(WindowDoor { folder, port: 0 }));
    bench.steps(2);
    bench
}

/// Waits for another thread while the window draws.
fn while_drawing<T>(bench: &mut Bench, thread: JoinHandle<T>) -> T {
    bench.wait_until("the assistant", |_| thread.is_finished());
    thread.join().expect("it does not panic")
}

#[test]
fn assistants_come_in_when_they_may_and_work_on_the_scene_that_is_shown() {
    let mut bench = bench();
    assert!(bench.app().guests.open().is_none(), "off by default");
    bench.app().state.windows.settings = true;
    bench.steps(3);
    bench.click("May drive this editor");
    bench.wait_until("the door", |b| b.app().guests.open().is_some());
    bench.steps(2);
    let open = bench.app().guests.open().expect("open");
    let (url, token) = (open.url.clone(), open.token.clone());
    assert!(
        token.len() == 32 && bench.harness.query_by_label(&token).is_some(),
        "the token is shown"
    );
    assert!(bench.harness.query_by_label(&url).is_some());
    let address = url
        .trim_start_matches("http://")
        .trim_end_matches("/mcp")
        .to_owned();
    assert!(address.starts_with("127.0.0.1:"), "{address}");

    let ask = |name: &'static str, args: Value| {
        let (address, token) = (address.clone(), token.clone());
        std::thread::spawn(move || call(&address, &token, name, &args).1["result"].clone())
    };
    let edits = json!([{ "add_box": {
        "class": "pedestrian", "center_m": [9, 2, 0.9], "size_m": [0.7, 0.7, 1.8], "yaw_deg": 0,
    } }]);
    let thread = ask("apply", json!({ "edits": edits, "step": "somebody" }));
    let applied = while_drawing(&mut bench, thread);
    assert_eq!(applied["isError"], false, "{applied}");
    assert_eq!(bench.history(), ["Open", "somebody"]);
    assert_eq!(bench.frame().boxes.len(), 2);

    // The user takes it back, and the assistant sees that.
    let (before, after) = (1, applied["structuredContent"]["revision"].clone());
    assert_eq!(after, 2);
    bench.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.frame().boxes.len(), 1);
    let thread = ask("state", json!({}));
    let state = while_drawing(&mut bench, thread);
    assert_eq!(state["structuredContent"]["revision"], before);
    assert_eq!(state["structuredContent"]["redo"], "somebody");

    // A failed call changes nothing, and a file goes to the folder of the window.
    let thread = ask("apply", json!({ "edits": [{ "remove_box": { "id": 999 } }] }));
    assert_eq!(while_drawing(&mut bench, thread)["isError"], true);
    let thread = ask("save", json!({ "file": "by_assistant.loom" }));
    assert_eq!(while_drawing(&mut bench, thread)["isError"], false);
    assert!(bench.folder.path().join("by_assistant.loom").is_file());
    assert_eq!(bench.history(), ["Open", "somebody"]);

    bench.click("May drive this editor");
    bench.wait_until("the door", |b| b.app().guests.open().is_none());
    assert!(TcpStream::connect(&address).is_err(), "nobody listens any more");
}

/// Both at one scene: each takes back its own, and what the other did stays.
#[test]
fn user_and_assistant_undo_their_own_steps() {
    let mut bench = bench();
    bench.app().preferences.settings.assistants = true;
    bench.wait_until("the door", |b| b.app().guests.open().is_some());
    let open = bench.app().guests.open().expect("open");
    let address = open
        .url
        .trim_start_matches("http://")
        .trim_end_matches("/mcp")
        .to_owned();
    let token = open.token.clone();
    let ask = |name: &'static str, args: Value| {
        let (address, token) = (address.clone(), token.clone());
        std::thread::spawn(move || call(&address, &token, name, &args).1["result"].clone())
    };
    let first = bench.frame();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    let mine = bench.frame();
    let edits = json!([{ "set_prompt": { "prompt": "fog" } }]);
    let thread = ask("apply", json!({ "edits": edits, "step": "theirs" }));
    while_drawing(&mut bench, thread);
    bench.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.frame().boxes, first.boxes);
    assert_eq!(&*bench.app().document.scene().prompt, "fog");
    let told = "Left out: Nudge box. Later steps stay";
    assert_eq!(bench.app().toasts.last(), Some(told));
    bench.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(bench.frame().boxes, mine.boxes);
    // The assistant takes back its own step and none of the user's.
    let thread = ask("undo", json!({}));
    let undone = while_drawing(&mut bench, thread);
    assert_eq!(undone["structuredContent"]["steps"], json!(["theirs"]));
    let thread = ask("undo", json!({}));
    assert_eq!(while_drawing(&mut bench, thread)["isError"], true);
    assert_eq!(bench.frame().boxes, mine.boxes);
    let thread = ask("history", json!({}));
    let found = while_drawing(&mut bench, thread);
    let steps = found["structuredContent"]["steps"].as_array().expect("steps");
    assert_eq!(steps[1]["author"], "user", "{found}");
    assert_eq!(steps[2]["author"], "assistant", "{found}");
}

#[test]
fn a_door_that_cannot_open_is_told_once() {
    let mut bench = Bench::new();
    bench.off();
    let folder = bench.folder.path().join("nowhere");
    bench.app().guests = Guests::new(Box::new(WindowDoor { folder, port: 0 }));
    bench.app().preferences.settings.assistants = true;
    bench.steps(5);
    let guests = &bench.app().guests;
    assert!(guests.open().is_none());
    assert!(
        guests.problem().is_some_and(|p| p.contains("nowhere")),
        "{:?}",
        guests.problem()
    );
    bench.app().preferences.settings.assistants = false;
    bench.steps(2);
    assert!(bench.app().guests.problem().is_none());
}
