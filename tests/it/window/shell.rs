//! Panes, workspaces, palette, keys, settings, versions and comparison.

use app::compare::CompareMode;
use app::dock::Workspace;
use app::panes::id::PaneId;
use app::settings::Settings;
use editor::tools::{add_box, select};
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use scene::{BoxId, Class};
use widgets::theme::Theme;

use super::bench::{Bench, Do};

#[test]
fn workspaces_and_panes_are_arranged() {
    let mut bench = Bench::new();
    bench.off();
    assert!(bench.harness.query_by_label("Camera Front").is_some());
    bench.click("Sensors");
    bench.wait_until("cameras", |b| b.app().sensors_are_current());
    bench.steps(3);
    let sweep = bench.pane("LiDAR sweep");
    assert!(sweep.width() > 300.0 && sweep.height() > 40.0, "{sweep:?}");
    assert!(
        bench.harness.query_by_label("Show walkway").is_none(),
        "no tools here"
    );
    // A double click on a header maximizes; the key for the pane under the pointer brings all back.
    let bev = bench.pane("Bird's-eye view");
    bench.harness.hover_at(bev.center());
    bench.steps(2);
    bench.key(Modifiers::SHIFT, Key::Space);
    assert!(bench.pane("Bird's-eye view").width() > 1300.0);
    bench.key(Modifiers::SHIFT, Key::Space);
    assert!(bench.pane("Bird's-eye view").width() < 700.0);
    bench.click("Label");
    bench.click("Box 7 car");
    let above = bench.pane("Box 7 from above");
    assert!(above.width() > 100.0);
    // The upper edge is the front of the car: dragged outward, the car grows and its back stays.
    let before = bench.frame().boxes[&BoxId(7)];
    let scale = {
        let view = vec2(above.width(), above.height() - 18.0);
        (f64::from(view.x) / (before.size_m.y + 3.2)).min(f64::from(view.y) / (before.size_m.x + 3.2))
    };
    let front = above.center() + vec2(0.0, 7.0 - (before.size_m.x / 2.0 * scale) as f32);
    bench.drag(&[front, front - vec2(0.0, scale as f32 * 0.5)], Modifiers::NONE);
    let after = bench.frame().boxes[&BoxId(7)];
    let grown = after.size_m.x - before.size_m.x;
    assert!((grown - 0.5).abs() < 0.12, "grew by {grown}");
    assert!((after.center_m.x - before.center_m.x - grown / 2.0).abs() < 1e-9);
    assert_eq!(bench.history().last().map(String::as_str), Some("Resize box"));
}

#[test]
fn the_palette_finds_and_runs() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::CTRL, Key::K);
    bench.steps(2);
    bench.harness.event(egui::Event::Text("cone".into()));
    bench.steps(2);
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.app().state.tool, add_box::ID);
    assert_eq!(bench.app().state.box_class, Class::TrafficCone);
    bench.key(Modifiers::CTRL, Key::P);
    bench.steps(2);
    bench.harness.event(egui::Event::Text("unrolled".into()));
    bench.steps(2);
    assert!(bench.harness.query_by_label("Nothing of that name").is_some());
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(bench.harness.query_by_label("Nothing of that name").is_none());
    assert_eq!(bench.app().state.tool, add_box::ID, "closing it is no shortcut");
}

#[test]
fn keys_are_changed_in_the_sheet() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::Questionmark);
    bench.click("A");
    // A keyboard sends the modifier first.
    bench.key(Modifiers::CTRL, Key::ControlLeft);
    bench.key(Modifiers::CTRL, Key::J);
    assert_eq!(bench.app().preferences.keymap.text("add_box_tool"), "Ctrl+J");
    bench.key(Modifiers::NONE, Key::Escape);
    bench.key(Modifiers::NONE, Key::A);
    assert_eq!(bench.app().state.tool, select::ID, "the old chord is free");
    bench.key(Modifiers::CTRL, Key::J);
    assert_eq!(bench.app().state.tool, add_box::ID);
}

#[test]
fn versions_are_compared_and_gone_back_to() {
    let mut bench = Bench::new();
    bench.off();
    let opened = bench.frame().occupancy.clone();
    bench.key(Modifiers::CTRL, Key::Enter);
    bench
        .started
        .recv_timeout(super::bench::PATIENCE)
        .expect("generation starts");
    bench.orders.send(Do::Finish).expect("it runs");
    bench.wait_until("versions", |b| b.app().generation.versions.list().len() == 2);
    bench.steps(2);
    bench.click("Accept");
    let generated = bench.frame().occupancy.clone();
    assert!(opened != generated);
    // Held, the key shows the version before; let go, the present one.
    bench.harness.key_down(Key::Backslash);
    bench.steps(3);
    assert!(bench.app().state.compare.holding_reference);
    bench.harness.key_up(Key::Backslash);
    bench.steps(2);
    assert!(!bench.app().state.compare.holding_reference);
    for mode in [
        CompareMode::Wipe,
        CompareMode::Side,
        CompareMode::Difference,
        CompareMode::Off,
    ] {
        bench.key(Modifiers::SHIFT, Key::Backslash);
        assert_eq!(bench.app().state.compare.mode, mode);
        bench.steps(4);
        // In the bird's-eye view and in the 3D view.
        let explained = bench
            .harness
            .query_all_by_label_contains(" of another class")
            .count();
        assert_eq!(explained, if mode == CompareMode::Difference { 2 } else { 0 });
    }
    bench.key(Modifiers::CTRL, Key::OpenBracket);
    assert!(bench.frame().occupancy == opened);
    assert_eq!(bench.history().last().map(String::as_str), Some("Go to version"));
    bench.key(Modifiers::CTRL, Key::CloseBracket);
    assert!(bench.frame().occupancy == generated);
    bench.key(Modifiers::CTRL, Key::Z);
    assert!(bench.frame().occupancy == opened);
    // A click compares, in the wipe. (Below the row of what the list offers there is room for both entries in a higher window.)
    bench.app().state.compare.mode = CompareMode::Off;
    bench.harness.set_size(vec2(1400.0, 1300.0));
    bench.steps(4);
    bench.click("Versions");
    bench.click("As opened");
    assert_eq!(bench.app().state.compare.mode, CompareMode::Wipe);
}

/// The line of a wipe lies on the view: who drags it does not paint.
#[test]
fn the_line_of_a_wipe_is_dragged_whatever_tool_is_held() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::B);
    bench.drag(&[bench.bev(-20.0, 10.0), bench.bev(-20.0, 14.0)], Modifiers::NONE);
    let (layout, steps) = (bench.frame().layout.clone(), bench.history());
    assert_eq!(steps.len(), 2, "{steps:?}");
    bench.app().state.compare.mode = CompareMode::Wipe;
    bench.steps(3);
    let area = bench.pane("Bird's-eye view");
    let at = bench.app().state.compare.wipe_at;
    let line = egui::pos2(area.left() + area.width() * at, area.top() + area.height() * 0.6);
    bench.drag(
        &[line, line + egui::vec2(30.0, 0.0), line + egui::vec2(70.0, 10.0)],
        Modifiers::NONE,
    );
    let moved = bench.app().state.compare.wipe_at - at;
    assert!((moved - 70.0 / area.width()).abs() < 0.03, "{moved}");
    assert_eq!(bench.history(), steps);
    assert!(bench.frame().layout == layout);
}

#[test]
fn settings_are_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("settings.json");
    let mut bench = Bench::with_settings(&file);
    assert!(
        bench.app().state.windows.start,
        "a new user sees the start screen"
    );
    bench.click("Go on with this scene");
    assert!(!bench.app().state.windows.start);
    bench.app().preferences.settings.theme = Theme::Light;
    bench.app().preferences.settings.start_screen = false;
    bench.click("Sensors");
    bench.wait_until("settings", |_| {
        Settings::load(&file).is_ok_and(|s| s.theme == Theme::Light && s.workspace == Workspace::Sensors)
    });
    drop(bench);
    let mut again = Bench::with_settings(&file);
    assert!(!again.app().state.windows.start);
    assert!(again.harness.query_by_label("LiDAR sweep").is_some());
    again.app().preferences.settings.theme = Theme::Dark; // the colours of a theme are the process's
    again.steps(3);
    assert_eq!(again.app().state.pointed.pane, None::<PaneId>);
}

#[test]
fn no_tooltip_shows_through_a_dialog() {
    let mut bench = Bench::new();
    bench.off();
    let brush = bench.harness.get_by_label("Brush").rect().center();
    bench.harness.hover_at(brush);
    bench.steps(60);
    let tips = |b: &Bench| b.harness.query_all_by_label("Brush").count();
    assert_eq!(tips(&bench), 2, "the button and its tooltip");
    bench.key(Modifiers::CTRL, Key::K);
    bench.steps(20);
    assert_eq!(tips(&bench), 1, "the button alone");
}

#[test]
fn the_list_of_boxes_keeps_its_height_and_is_made_higher() {
    let mut bench = Bench::new();
    bench.off();
    bench.harness.set_size(vec2(1280.0, 800.0));
    bench.steps(4);
    bench.click("Box 7 car");
    let list = |b: &Bench| {
        let title = b.harness.get_by_label("Height of the list of boxes").rect();
        // The pane below begins where the list ends.
        let prompt = b.harness.get_by_label("Prompt").rect();
        (title, prompt.top() - title.bottom())
    };
    let (title, height) = list(&bench);
    assert!(height > 110.0, "{height}");
    assert!(bench.harness.get_by_label("Heading").rect().bottom() < title.top());
    let way = [title.center(), title.center() - vec2(0.0, 60.0)];
    bench.drag(&way, Modifiers::NONE);
    assert!(
        (list(&bench).1 - height - 60.0).abs() < 8.0,
        "{} {height}",
        list(&bench).1
    );
}
