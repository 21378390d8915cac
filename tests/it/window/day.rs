//! A day of work from start to end: every step leaves what it should, and the invariants hold after each.

use app::compare::CompareMode;
use editor::Edit;
use editor::tools::select;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use scene::{BevLayer, BoxId, Class};

use super::bench::{Bench, Do, PATIENCE};

/// What must hold after every command.
fn sweep(bench: &mut Bench) {
    let frame = bench.frame();
    for (id, b) in &frame.boxes {
        assert_eq!(b.problem(), None);
        assert_eq!(*id, b.id);
    }
    let app = bench.app();
    let selected = app.state.selected;
    assert!(
        selected.is_none_or(|id| frame.boxes.contains_key(&id)),
        "{selected:?}"
    );
    assert!(app.state.chosen().iter().all(|id| frame.boxes.contains_key(id)));
    assert!(app.document.position() < app.document.history().len());
    assert!(app.document.can_undo() == (app.document.position() > 0));
}

#[test]
fn a_day_of_work() {
    let mut bench = Bench::new();
    bench.off();
    let first = bench.frame();
    // Paint.
    bench.click("Paint carpark area");
    let way = [bench.bev(-20.0, 25.0), bench.bev(0.0, 25.0)];
    bench.drag(&way, Modifiers::NONE);
    assert!(bench.frame().layout.count(BevLayer::CarparkArea) > first.layout.count(BevLayer::CarparkArea));
    sweep(&mut bench);
    // Ten boxes.
    bench.key(Modifiers::NONE, Key::A);
    bench.click("Add traffic cone");
    for i in 0..10 {
        let at = bench.bev(-30.0 + 2.0 * f64::from(i), -20.0);
        bench.drag(&[at], Modifiers::NONE);
        sweep(&mut bench);
    }
    assert_eq!(bench.frame().boxes.len(), 11);
    // Words.
    bench.key(Modifiers::NONE, Key::Escape);
    bench.key(Modifiers::NONE, Key::Slash);
    bench.steps(3);
    bench.harness.get_by_label("Prompt").type_text("remove #7");
    bench.steps(3);
    bench.key(Modifiers::NONE, Key::Enter);
    assert!(
        !bench.frame().boxes.contains_key(&BoxId(7)),
        "{:?}",
        bench.history()
    );
    bench.key(Modifiers::NONE, Key::Escape); // the keys belong to the tools again
    sweep(&mut bench);
    // Voxels, and forty nudges of a box.
    let ctx = bench.harness.ctx.clone();
    let wall = Edit::PaintVoxels {
        cells: (0..20)
            .flat_map(|y| (0..4).map(move |z| [150, 90 + y, z]))
            .collect(),
        class: Class::Manmade,
    };
    let command = app::Command::Apply("Paint voxels", vec![wall]);
    bench.app().execute(command, &ctx);
    bench.steps(2);
    assert_eq!(bench.frame().occupancy.get(150, 95, 2), Class::Manmade.id());
    let choose = app::Command::Select(Some(BoxId(8)));
    bench.app().execute(choose.clone(), &ctx);
    bench.steps(1);
    let start = bench.frame().boxes[&BoxId(8)].center_m;
    for _ in 0..40 {
        bench.harness.key_press_modifiers(Modifiers::NONE, Key::ArrowUp);
        bench.steps(1);
    }
    bench.steps(2);
    let moved = bench.frame().boxes[&BoxId(8)].center_m - start;
    assert!(
        (moved.truncate() - DVec2::new(4.0, 0.0)).length() < 1e-6,
        "{moved}"
    );
    sweep(&mut bench);
    // Generate, compare.
    bench.key(Modifiers::CTRL, Key::Enter);
    bench.started.recv_timeout(PATIENCE).expect("it starts");
    bench.orders.send(Do::Finish).expect("it listens");
    bench.wait_until("a version", |b| b.app().generation.versions.list().len() == 2);
    bench.steps(2);
    bench.click("Accept");
    bench.key(Modifiers::SHIFT, Key::Backslash);
    assert_eq!(bench.app().state.compare.mode, CompareMode::Wipe);
    bench.app().state.compare.mode = CompareMode::Off;
    sweep(&mut bench);
    let last = bench.frame();
    // Undo fifty steps, and all the way forward.
    let steps = bench.history().len() - 1;
    assert!(steps >= 50, "{steps}");
    for _ in 0..steps {
        bench.harness.key_press_modifiers(Modifiers::CTRL, Key::Z);
        bench.steps(1);
        sweep(&mut bench);
    }
    assert_eq!(bench.frame(), first);
    for _ in 0..steps {
        bench.harness.key_press_modifiers(Modifiers::CTRL, Key::Y);
        bench.steps(1);
    }
    assert_eq!(bench.frame(), last);
    // Save, reopen.
    let path = bench.open_path();
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    bench.app().execute(choose, &ctx);
    bench.steps(1);
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(bench.app().document.is_dirty());
    bench.key(Modifiers::CTRL, Key::O);
    bench.click("Discard changes");
    bench.give_path(&path, "Open file");
    bench.wait_until("the file", |b| !b.app().document.is_dirty());
    let reopened = bench.frame();
    assert_eq!(reopened.boxes, last.boxes);
    assert!(reopened.occupancy == last.occupancy && reopened.layout == last.layout);
    assert_eq!(bench.app().state.tool, select::ID);
    sweep(&mut bench);
    // The file has the whole day: undo goes on to its beginning.
    assert_eq!(bench.history().len() - 1, steps);
    for _ in 0..steps {
        bench.harness.key_press_modifiers(Modifiers::CTRL, Key::Z);
        bench.steps(1);
    }
    assert_eq!(bench.frame(), first);
}
