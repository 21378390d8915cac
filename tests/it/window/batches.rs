//! Batches from the window, and versions that are named and come back from the file.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::bench::Bench;
use app::batch::marks::Marks;
use app::batch::queue::BatchState;

impl Bench {
    pub fn type_into(&mut self, label: &str, text: &str) {
        self.harness.get_by_label(label).focus();
        self.steps(2);
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.steps(1);
        self.harness.get_by_label(label).type_text(text);
        self.steps(2);
    }
}

#[test]
fn variants_are_made_marked_and_opened() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::CTRL, Key::B);
    let folder = bench.folder.path().join("variants");
    bench.click("Night");
    bench.click("Rain");
    bench.type_into("Folder of the batch", &folder.display().to_string());
    bench.click("count what the quality checks find");
    bench.click("Add to the queue");
    assert_eq!(bench.app().batches().items().len(), 1);
    bench.wait_until("the batch", |b| {
        matches!(b.app().batches().items()[0].state, BatchState::Done(_))
    });
    bench.steps(4);
    for name in [
        "000000/pictures",
        "000000/loom/scene.loom",
        "base.loom",
        "index.parquet",
    ] {
        assert!(folder.join(name).exists(), "{name}");
    }
    bench.click("Star variant 0");
    let marks = Marks::read(&folder).expect("marks");
    assert_eq!((marks.starred.len(), marks.discarded.len()), (1, 0));
    bench.click("Discard variant 0");
    let marks = Marks::read(&folder).expect("marks");
    assert_eq!((marks.starred.len(), marks.discarded.len()), (0, 1));
    // The same folder again is told, not written over.
    bench.click("New batch…");
    bench.type_into("Folder of the batch", &folder.display().to_string());
    bench.click("Add to the queue");
    let told = bench.harness.query_by_label_contains("is in the queue already");
    assert!(told.is_some());
}

#[test]
fn a_named_version_is_saved_with_the_scene() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Versions");
    let rev = bench.app().document.scene().content();
    let versions = &mut bench.app().generation.versions;
    versions.rename(rev, "before the rain");
    bench.steps(3);
    assert!(bench.app().document.is_dirty(), "a name is something to save");
    let file = bench.folder.path().join("named.loom");
    bench.key(Modifiers::CTRL | Modifiers::SHIFT, Key::S);
    bench.steps(2);
    bench.give_path(&file, "Save file");
    bench.wait_until("the file", |_| file.exists());
    bench.steps(2);
    assert!(!bench.app().document.is_dirty());
    let kept = formats::loom::load(&file).expect("a project").kept.clone();
    assert_eq!(kept.versions.len(), 1);
    assert_eq!(kept.versions[0].name, "before the rain");
}

#[test]
fn a_state_without_a_generation_is_kept_as_a_version() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Versions");
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    let rev = bench.app().document.scene().content();
    assert_eq!(
        bench.app().generation.versions.index_of(rev),
        None,
        "an edit alone is none"
    );
    bench.click("Keep");
    bench
        .harness
        .get_by_label("Name of the version")
        .type_text("further left");
    bench.steps(2);
    bench.key(Modifiers::NONE, Key::Enter);
    bench.steps(2);
    let versions = &bench.app().generation.versions;
    let i = versions.index_of(rev).expect("it is kept");
    assert_eq!(versions.list()[i].title(), "further left");
    assert!(versions.list()[i].starred);
    // Going back to it is one step.
    bench.key(Modifiers::NONE, Key::Delete);
    let ctx = bench.harness.ctx.clone();
    let back = app::command::GenerationCommand::RestoreVersion(rev);
    bench.app().execute(app::Command::Generation(back), &ctx);
    assert_eq!(bench.frame().boxes.len(), 1);
}
