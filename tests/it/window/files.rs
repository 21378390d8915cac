//! Failures, saving, opening, closing.

use app::command::{Command, FileCommand};
use editor::Edit;
use editor::tools::select;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use formats::loom;

use super::bench::{Bench, Do, scene};

#[test]
fn a_failure_is_told_once_and_live_stops() {
    let mut bench = Bench::new();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::C);
    bench.wait_until("the job", |b| !b.started.is_empty());
    bench.orders.send(Do::Fail).expect("listens");
    bench.wait_until("its end", |b| b.app().generation.live.running.is_none());
    bench.steps(5);
    assert!(!bench.app().generation.live.on);
    let told = "Generation failed: weights are missing. Live is off now.";
    assert!(bench.harness.query_by_label(told).is_some());
    assert!(
        bench
            .harness
            .query_by_label("Edited, not generated: live is off")
            .is_some()
    );
    assert_eq!(bench.started.len(), 1, "never a loop");
    bench.key(Modifiers::CTRL, Key::Space);
    assert!(bench.app().generation.live.on);
    bench.wait_until("another try", |b| b.started.len() == 2);
}

#[test]
fn a_scene_is_saved_and_opened_again_by_the_path_field() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.open_path();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    let saved = bench.frame();
    assert!(bench.app().document.is_dirty());
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    assert!(path.is_file() && !bench.app().document.is_dirty());
    assert_eq!(bench.app().path(), Some(path.as_path()));
    // Letters typed into the field are no shortcuts.
    assert_eq!(bench.app().state.tool, select::ID);

    bench.key(Modifiers::NONE, Key::Delete);
    assert_ne!(bench.frame(), saved);
    bench.key(Modifiers::CTRL, Key::O);
    assert!(bench.harness.query_by_label("Unsaved changes").is_some());
    bench.click("Keep editing");
    assert!(bench.harness.query_by_label("Unsaved changes").is_none());
    bench.key(Modifiers::CTRL, Key::O);
    bench.click("Discard changes");
    bench.give_path(&path, "Open file");
    bench.wait_until("the scene", |b| !b.app().document.is_dirty());
    assert_eq!(bench.history().len(), 2, "the deletion was not saved");
    assert_eq!(bench.frame().boxes, saved.boxes);
    assert_eq!(bench.frame().occupancy, saved.occupancy);
    assert_eq!(bench.frame().layout, saved.layout);
    // Undo goes on, and the history can be replayed.
    bench.key(Modifiers::CTRL, Key::Z);
    assert_ne!(bench.frame().boxes, saved.boxes);
    bench.key(Modifiers::CTRL, Key::Y);
    assert_eq!(bench.frame().boxes, saved.boxes);
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(Command::ReplayHistory, &ctx);
    let told = "1 steps replayed from the origin: the same scene, bit for bit";
    assert_eq!(bench.app().toasts.last(), Some(told));
    // Saved again without a question, now that there is a file.
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    bench.key(Modifiers::CTRL, Key::S);
    assert!(!bench.app().document.is_dirty());
    // A file that is none is one line, and the scene stays.
    std::fs::write(&path, b"PK rubbish").expect("written");
    let stays = bench.frame();
    bench.key(Modifiers::CTRL, Key::O);
    bench.give_path(&path, "Open file");
    bench.wait_until("the error", |b| {
        b.app().toasts.last().is_some_and(|t| t.contains("scene.loom"))
    });
    assert_eq!(bench.frame(), stays);
    assert!(bench.app().toasts.last().is_some_and(|t| !t.contains('\n')));
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

#[test]
fn a_dropped_file_opens_and_closing_asks_first() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.open_path();
    let mut other = scene();
    other.name = "Dropped".into();
    loom::save(&path, &other).expect("saved");
    bench
        .harness
        .input_mut()
        .dropped_files
        .push(Arc::new(Dropped(path)));
    bench.steps(1);
    bench.harness.input_mut().dropped_files.clear();
    bench.wait_until("the scene", |b| &*b.app().document.scene().name == "Dropped");

    let close = |bench: &mut Bench| {
        let viewports = &mut bench.harness.input_mut().viewports;
        viewports.entry(egui::ViewportId::ROOT).or_default().events = vec![egui::ViewportEvent::Close];
        bench.steps(1);
        let viewports = &mut bench.harness.input_mut().viewports;
        viewports
            .entry(egui::ViewportId::ROOT)
            .or_default()
            .events
            .clear();
        let output = &bench.harness.output().viewport_output[&egui::ViewportId::ROOT];
        output.commands.contains(&egui::ViewportCommand::CancelClose)
    };
    assert!(!close(&mut bench), "nothing is unsaved");
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(close(&mut bench), "changes are unsaved");
    bench.steps(2);
    bench.click("Discard changes");
    assert!(!close(&mut bench), "the user has decided");
}

/// Asks for a scene named "Other", and deletes the only box before it has been read.
fn opens_while_editing(bench: &mut Bench) -> Arc<scene::Frame> {
    let path = bench.folder.path().join("other.loom");
    let mut other = scene();
    other.name = "Other".into();
    loom::save(&path, &other).expect("saved");
    let ctx = bench.harness.ctx.clone();
    let id = *bench.frame().boxes.keys().next().expect("a box");
    let app = bench.app();
    app.execute(Command::File(FileCommand::OpenPath(path)), &ctx);
    app.execute(Command::Apply("Delete", vec![Edit::RemoveBox { id }]), &ctx);
    let edited = bench.frame();
    bench.wait_until("the question", |b| {
        b.harness.query_by_label("Unsaved changes").is_some()
    });
    assert!(
        bench
            .harness
            .query_by_label("“Other” has been read and waits.")
            .is_some()
    );
    assert!(bench.frame() == edited && bench.app().document.is_dirty());
    edited
}

#[test]
fn what_is_edited_while_a_file_opens_stays_if_the_user_stays() {
    let mut bench = Bench::new();
    bench.off();
    let edited = opens_while_editing(&mut bench);
    bench.click("Keep editing");
    bench.steps(5);
    assert!(bench.frame() == edited && bench.app().document.is_dirty());
    let told = "Other was not opened: your changes stay";
    assert!(bench.app().toasts.last().is_some_and(|t| t.contains(told)));
    // Undo is there as before.
    bench.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.frame().boxes.len(), 1);
    opens_while_editing(&mut bench);
    bench.click("Discard changes");
    bench.wait_until("the scene", |b| &*b.app().document.scene().name == "Other");
    assert!(!bench.app().document.is_dirty());
}

#[test]
fn what_is_edited_while_a_file_opens_is_saved_first() {
    let mut bench = Bench::new();
    bench.off();
    let edited = opens_while_editing(&mut bench);
    bench.click("Save changes");
    let path = bench.open_path();
    bench.give_path(&path, "Save file");
    bench.wait_until("the scene", |b| &*b.app().document.scene().name == "Other");
    let saved = loom::load(&path).expect("saved");
    assert_eq!(saved.frame().boxes, edited.boxes);
}

#[test]
fn who_gives_no_name_for_the_edits_stays() {
    let mut bench = Bench::new();
    bench.off();
    let edited = opens_while_editing(&mut bench);
    bench.click("Save changes");
    bench.steps(2);
    bench.click("Cancel file");
    bench.steps(5);
    assert!(bench.frame() == edited);
    // What is saved later opens nothing.
    let path = bench.open_path();
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    bench.steps(20);
    assert!(path.is_file() && bench.frame() == edited);
}

#[test]
fn a_picture_brings_its_scene_and_what_that_was_made_with() {
    let mut bench = Bench::new();
    bench.off();
    let scene = bench.app().document.scene().clone();
    let params = job::GenParams {
        seed: 4711,
        steps: 9,
        ..job::GenParams::default()
    };
    let made = serde_json::json!({ "preset": "", "params": params });
    let picture = app::picture::layout_top(scene.frame(), 1);
    let bytes = app::capture::to_png_made_with(&scene, &picture, made).expect("a picture");
    let path = bench.folder.path().join("seen.png");
    std::fs::write(&path, bytes).expect("written");
    let open = Command::File(FileCommand::OpenPath(path));
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(open, &ctx);
    bench.wait_until("the scene", |b| b.app().state.seed.value == Some(4711));
    assert_eq!(bench.app().generation.live.params.steps, 9);
    let versions = bench.app().generation.versions.list();
    let kept = versions.last().and_then(|v| v.made.as_ref());
    assert_eq!(kept.expect("told").params.seed, 4711);
}

#[test]
fn a_second_enter_replaces_a_file() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.open_path();
    std::fs::write(&path, "old").expect("written");
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    assert!(bench.harness.query_by_label("Replace file").is_some());
    bench.steps(4);
    assert!(bench.harness.get_by_label("File path").is_focused());
    bench.key(Modifiers::NONE, Key::Enter);
    assert!(loom::load(&path).is_ok(), "replaced");
}
