//! Work that outlives a crash, and the checks' window.

use app::recovery::Recovery;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use formats::loom;
use scene::{BoxId, Class};

use app::command::{Command, ViewCommand};
use app::panes::id::PaneId;

use super::bench::Bench;

#[test]
fn work_is_offered_after_a_crash_and_comes_back_unsaved() {
    let root = tempfile::tempdir().expect("a folder");
    let session = || Recovery::start(root.path(), 30.0, || {}).expect("a session");
    let mut bench = Bench::new();
    bench.off();
    bench.app().files.recovery = Some(session());
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    let worked = bench.frame();
    bench.steps(3);
    // The window's thread ends without the user having been asked.
    drop(bench);

    let mut bench = Bench::new();
    bench.off();
    assert_ne!(bench.frame(), worked);
    bench.app().files.recovery = Some(session());
    bench.steps(3);
    assert!(bench.harness.query_by_label("Recover “Test road”?").is_some());
    bench.click("Recover");
    bench.wait_until("the scene", |b| b.frame().boxes == worked.boxes);
    assert_eq!(bench.frame().occupancy, worked.occupancy);
    assert!(bench.app().document.is_dirty(), "it is in no file of the user");
    assert!(bench.harness.query_by_label("Recover “Test road”?").is_none());
    // Saved, nothing is left to offer.
    let path = bench.open_path();
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    bench.steps(3);
    assert_eq!(loom::load(&path).expect("saved").frame().boxes, worked.boxes);
    drop(bench);
    assert_eq!(std::fs::read_dir(root.path()).expect("there").count(), 0);
}

#[test]
fn findings_lead_to_their_place_and_are_fixed() {
    let mut bench = Bench::new();
    bench.off();
    let ctx = bench.harness.ctx.clone();
    bench
        .app()
        .execute(Command::View(ViewCommand::ShowPane(PaneId::CHECKS)), &ctx);
    let checked = |b: &mut Bench| {
        let rev = b.app().document.scene().rev;
        !b.app().threads.checking.is_stale(rev)
    };
    bench.wait_until("the checks", checked);
    bench.steps(3);
    // It stands on the left lane, as the bench has put it.
    bench.click("Turn to the lane's heading: car 7 faces against its lane, 180 degrees from it");
    assert_eq!(bench.history(), ["Open", "Turn to the lane's heading"]);
    bench.wait_until("the checks", checked);
    bench.steps(3);
    assert!(
        bench
            .harness
            .query_by_label("All is well: no check found anything.")
            .is_some()
    );
    // A box in the air, made by the user's own keys.
    bench.click("Box 7 car");
    for _ in 0..12 {
        bench.key(Modifiers::NONE, Key::PageUp);
    }
    bench.wait_until("the checks", checked);
    bench.steps(3);
    let text = "Warning: car 7 hovers 1.2 m above the ground";
    assert!(bench.harness.query_by_label(text).is_some());
    bench.app().state.selected = None;
    bench.steps(2);
    bench.click(text);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));
    bench.click("Drop to the ground: car 7 hovers 1.2 m above the ground");
    assert!((bench.frame().boxes[&BoxId(7)].center_m.z - 0.85).abs() < 1e-9);
    assert_eq!(
        bench.history().last().map(String::as_str),
        Some("Drop to the ground")
    );
    // Several things at once, one step to undo.
    let floats = editor::Edit::PaintVoxels {
        cells: vec![[30, 30, 9], [90, 30, 9]],
        class: Class::Manmade,
    };
    bench.app().document.apply("Paint", &floats).expect("sound");
    bench.wait_until("the checks", checked);
    bench.steps(3);
    bench.click("Fix all (2)…");
    bench.planned();
    bench.press("Repair ");
    assert_eq!(bench.frame().occupancy.get(30, 30, 9), Class::Free.id());
    assert_eq!(bench.frame().occupancy.get(90, 30, 9), Class::Free.id());
    assert_eq!(
        bench.history().last().map(String::as_str),
        Some("Repair findings")
    );
}
