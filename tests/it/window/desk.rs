//! What keeps an editor open all day: measurements, kept views, live that waits, waivers, the export dialog.

use std::time::Duration;

use app::command::{Command, ViewCommand};
use app::panes::id::PaneId;
use app::tools::RegionShape;
use editor::{Edit, Shape as Area};
use egui::{Key, Modifiers, Rect, Shape};
use egui_kittest::kittest::Queryable;
use formats::loom;
use glam::DVec2;
use job::RegionMode;
use scene::{BevLayer, BoxId};
use viewport::{ViewCamera, ViewPreset};

use super::bench::{Bench, Do, PATIENCE, car};

impl Bench {
    fn run_command(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.app().execute(command, &ctx);
        self.steps(2);
    }

    fn sees(&self, label: &str) -> bool {
        self.harness.query_by_label(label).is_some()
    }

    fn checked(&mut self) {
        self.wait_until("the checks", |b| {
            let rev = b.app().document.scene().rev;
            !b.app().threads.checking.is_stale(rev)
        });
        self.steps(3);
    }
}

fn everywhere() -> Edit {
    Edit::PaintBev {
        layer: BevLayer::Walkway,
        shape: Area::Rect {
            min_m: DVec2::splat(-39.9),
            max_m: DVec2::splat(39.9),
        },
        value: true,
    }
}

#[test]
fn the_window_measures_itself() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.folder.path().join("trace.jsonl");
    bench.app().trace_to(&path).expect("a file");
    bench.key(Modifiers::NONE, Key::F10);
    assert!(bench.sees("Performance") && bench.sees("Edit to picture"));
    bench.click("Box 7 car");
    for _ in 0..5 {
        bench.key(Modifiers::NONE, Key::ArrowUp);
    }
    let perf = &bench.app().frames.perf;
    assert!(perf.frames.quantiles().n > 10);
    assert_eq!(perf.visible.quantiles().n, 5, "each edit was seen");
    assert!(perf.visible.quantiles().max > 0.0);
    bench.key(Modifiers::NONE, Key::F10);
    assert!(!bench.sees("Edit to picture"));
    bench.app().frames.perf.finish(None);
    let text = std::fs::read_to_string(&path).expect("written");
    let last = text.lines().last().expect("lines");
    let summary: serde_json::Value = serde_json::from_str(last).expect("JSON");
    assert_eq!(summary["kind"], "summary");
    assert_eq!(summary["edit_to_visible_ms"]["n"], 5);
}

#[test]
fn edits_show_in_the_frame_that_takes_them() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Box 7 car");
    let x = |b: &Bench| {
        b.harness.query_by_value("14.10").is_some() || b.harness.query_by_label("14.10").is_some()
    };
    assert!(!x(&bench));
    bench.harness.key_press_modifiers(Modifiers::NONE, Key::ArrowUp);
    bench.steps(1);
    assert!((bench.frame().boxes[&BoxId(7)].center_m.x - 14.1).abs() < 1e-9);
    let history = bench.harness.query_by_label("History 1 Nudge box").is_some();
    assert!(history, "the panel of the same frame shows the step");
}

#[test]
fn views_are_kept_and_gone_back_to() {
    let mut bench = Bench::new();
    bench.off();
    let here = ViewCamera {
        distance_m: 17.0,
        ..ViewCamera::default()
    };
    bench.app().views.view3d.camera = here;
    bench.app().views.canvas.go_to(DVec2::new(5.0, -3.0), 11.0);
    bench.steps(2);
    bench.key(Modifiers::CTRL, Key::F3);
    bench.app().views.view3d.camera = ViewCamera::preset(ViewPreset::Top);
    bench.app().views.canvas.go_to(DVec2::ZERO, 4.0);
    bench.key(Modifiers::NONE, Key::F4);
    assert!(bench.sees("No view is kept as 4: Ctrl+F4 keeps this one"));
    assert_eq!(
        bench.app().views.view3d.camera,
        ViewCamera::preset(ViewPreset::Top)
    );
    bench.key(Modifiers::NONE, Key::F3);
    let now = bench.app().views.view3d.camera;
    assert!(
        (now.distance_m, now.ortho) == (17.0, false) && (now.yaw_rad - here.yaw_rad).abs() < 1e-9,
        "{now:?}"
    );
    assert_eq!(bench.app().views.canvas.place(), (DVec2::new(5.0, -3.0), 11.0));
    let kept = serde_json::to_string(&bench.app().preferences.settings).expect("JSON");
    assert!(kept.contains("\"bookmarks\":{\"3\":{"), "{kept}");
}

#[test]
fn large_edits_wait_and_say_why() {
    let mut bench = Bench::new();
    bench.run_command(Command::Apply("Paint", vec![everywhere()]));
    bench.steps(4);
    assert!(bench.started.is_empty(), "nothing starts by itself");
    assert!(bench.sees("Live waits: 100 % of the map was edited") || bench.sees("Generate it"));
    bench.click("Generate it");
    assert_eq!(bench.started.recv_timeout(PATIENCE), Ok(RegionMode::Auto));
    // Cancelled for good: nothing runs, nothing waits.
    bench.steps(2);
    bench.click("Cancel all");
    bench.wait_until("rest", |b| b.app().generation.live.running.is_none());
    bench.steps(5);
    assert!(bench.started.is_empty());
    bench.key(Modifiers::CTRL, Key::Z);
    bench.steps(3);
    assert!(!bench.sees("Generate it"), "undone, nothing waits");
}

#[test]
fn the_history_keeps_to_its_memory() {
    let mut bench = Bench::new();
    bench.off();
    bench.app().preferences.settings.history_mb = 16;
    bench.steps(2);
    assert_eq!(bench.app().document.history_limit(), 16 << 20);
    for i in 0..80 {
        let mut edit = everywhere();
        if let Edit::PaintBev { value, .. } = &mut edit {
            *value = i % 2 == 0;
        }
        bench.run_command(Command::Apply("Paint", vec![edit]));
    }
    let document = &bench.app().document;
    assert!(
        document.history_bytes() <= 16 << 20,
        "{}",
        document.history_bytes()
    );
    assert!(
        (9..80).contains(&document.history().len()),
        "{}",
        document.history().len()
    );
}

#[test]
fn while_the_state_before_is_shown_nothing_answers() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::CTRL, Key::Enter);
    bench.started.recv_timeout(PATIENCE).expect("generation starts");
    bench.orders.send(Do::Finish).expect("it runs");
    bench.wait_until("versions", |b| b.app().generation.versions.list().len() == 2);
    bench.steps(3);
    let steps = bench.history().len();
    bench.harness.key_down(Key::Backslash);
    bench.steps(3);
    assert!(bench.app().state.compare.holding_reference);
    let at = bench.bev(14.0, 3.0);
    bench.drag(&[at, at + egui::vec2(60.0, 0.0)], Modifiers::NONE);
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.app().state.selected, None);
    assert_eq!(
        (bench.history().len(), bench.frame().boxes[&BoxId(7)]),
        (steps, car())
    );
    bench.harness.key_up(Key::Backslash);
    bench.steps(3);
    bench.drag(&[at, at + egui::vec2(60.0, 0.0)], Modifiers::NONE);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)), "now it does");
    assert_ne!(bench.frame().boxes[&BoxId(7)], car());
}

/// Line segments that are drawn inside a rectangle.
fn lines_in(bench: &Bench, rect: Rect) -> usize {
    let shapes = &bench.harness.output().shapes;
    let inside = |s: &Shape| match s {
        Shape::LineSegment { points, .. } => points.iter().any(|p| rect.contains(*p)),
        _ => false,
    };
    shapes
        .iter()
        .filter(|s| s.clip_rect.intersects(rect) && inside(&s.shape))
        .count()
}

#[test]
fn the_chosen_box_is_lit_in_the_cameras_that_see_it() {
    let mut bench = Bench::new();
    bench.off();
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(2);
    let rect = |b: &Bench, name: &str| b.harness.get_by_label(name).rect().shrink(4.0);
    let (front, back) = (rect(&bench, "Camera Front"), rect(&bench, "Camera Back"));
    let before = (lines_in(&bench, front), lines_in(&bench, back));
    bench.click("Box 7 car");
    let after = (lines_in(&bench, front), lines_in(&bench, back));
    assert!(after.0 >= before.0 + 12, "{before:?} {after:?}");
    assert_eq!(after.1, before.1);
    // A click on it in the enlarged picture chooses it.
    bench.app().state.choose(&[], app::tools::Choose::Only);
    bench.click("Camera Front");
    bench.steps(3);
    let large = bench.pane("Enlarged camera");
    let camera = bench.app().document.scene().rig.cameras[1].clone();
    assert_eq!(camera.name, "CAM_FRONT");
    let pose = camera.ego_from_camera();
    let p = pose.rotation.inverse() * (car().center_m - pose.translation_m);
    let part = [0, 1].map(|i| {
        let size = [camera.width, camera.height][i];
        ((camera.focal_px[i] * p[i] / p.z + camera.center_px[i]) / f64::from(size)) as f32
    });
    let at = large.min + egui::vec2(part[0], part[1]) * large.size();
    bench.drag(&[at], Modifiers::NONE);
    bench.steps(2);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));
}

#[test]
fn the_status_bar_says_what_the_buttons_do() {
    let mut bench = Bench::new();
    bench.off();
    let at = bench.bev(0.0, 0.0);
    bench.harness.hover_at(at);
    bench.key(Modifiers::NONE, Key::B);
    let hint = "Drag replaces ground  ·  Shift erases  ·  Ctrl straight  ·  Alt picks  ·  [ ] size  ·  Middle pans  ·  Wheel zooms";
    assert!(bench.sees(hint));
    bench.key(Modifiers::NONE, Key::M);
    assert!(bench.sees("Click sets a point  ·  Esc clears  ·  Middle pans  ·  Wheel zooms"));
}

#[test]
fn a_finding_is_waived_with_a_reason_and_taken_back() {
    let mut bench = Bench::new();
    bench.off();
    bench.run_command(Command::View(ViewCommand::ShowPane(PaneId::CHECKS)));
    bench.checked();
    let finding = "car 7 faces against its lane, 180 degrees from it";
    bench.click(&format!("Waive: {finding}"));
    bench.steps(2);
    bench
        .harness
        .get_by_label("Reason of the waiver")
        .type_text("it turns round");
    bench.steps(2);
    bench.click("Let it stand");
    assert_eq!(bench.history(), ["Open", "Waive a finding"]);
    bench.checked();
    assert!(bench.sees("All is well, but for what was waived."));
    assert_eq!(&*bench.frame().waivers[0].reason, "it turns round");
    let bytes = loom::to_bytes(bench.app().document.scene()).expect("written");
    let again = loom::from_bytes(&bytes).expect("read");
    assert_eq!(
        again.frame().waivers,
        bench.frame().waivers,
        "kept in the project"
    );
    bench.click("1 waived");
    bench.steps(3);
    assert!(bench.sees(&format!("{finding}  ·  it turns round")));
    bench.click(&format!("Take back: {finding}"));
    bench.checked();
    assert!(bench.frame().waivers.is_empty());
    assert!(bench.sees(&format!("Waive: {finding}")));
}

#[test]
fn a_region_is_painted_by_a_brush() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::N);
    bench.app().state.tools.region_shape = RegionShape::Brush;
    bench.app().state.brush_m = 1.6;
    let way = [(0.0, -10.0), (0.0, 10.0), (10.0, 10.0)].map(|(x, y)| bench.bev(x, y));
    bench.drag(&way, Modifiers::NONE);
    let marked = bench.app().state.tools.region.count();
    // 30 m of 1.6 m cells; a stroke of their width touches two in a row here and there.
    assert!((18..60).contains(&marked), "{marked}");
    assert_eq!(bench.history(), ["Open"], "a mark is no edit");
    bench.drag(&way, Modifiers::SHIFT);
    assert_eq!(bench.app().state.tools.region.count(), 0);
}

#[test]
fn the_export_dialog_writes_what_was_chosen() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::CTRL, Key::E);
    bench.steps(2);
    assert!(bench.sees("Occ3D labels.npz, 200 x 200 x 16 class labels, masks of LiDAR and cameras"));
    bench.type_into("Search formats", "boxes json");
    bench.click("Boxes: JSON with centre, size, heading, velocity, LiDAR points");
    let path = bench.folder.path().join("cars.json");
    bench.harness.get_by_label("Export path").focus();
    bench.steps(2);
    bench.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.steps(1);
    let text = path.display().to_string();
    bench.harness.get_by_label("Export path").type_text(&text);
    bench.steps(2);
    bench.click("Export files");
    bench.wait_until("the file", |_| path.is_file());
    bench.wait_until("the end", |b| !b.sees("Exporting…"));
    let bytes = std::fs::read(&path).expect("written");
    let written: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    assert!(written.to_string().contains("\"car\""), "{written}");
    // A folder that cannot be made is told of, and the dialog stays.
    let bad = path.join("below a file.json");
    bench.harness.get_by_label("Export path").focus();
    bench.steps(2);
    bench.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.steps(1);
    bench
        .harness
        .get_by_label("Export path")
        .type_text(&bad.display().to_string());
    bench.steps(2);
    bench.click("Export files");
    std::thread::sleep(Duration::from_millis(50));
    bench.wait_until("the complaint", |b| {
        b.harness.query_by_label_contains("Not exported").is_some()
    });
    bench.key(Modifiers::CTRL, Key::E);
    assert!(!bench.sees("Export files"));
}
