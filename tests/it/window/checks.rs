//! The list of what the quality checks found: beside what it speaks of, and marking it.

use app::command::{Command, ViewCommand};
use app::dock::Dock;
use app::panes::id::PaneId;
use app::settings::Settings;
use editor::Edit;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use scene::{BoxId, Class, Window};

use super::bench::Bench;

impl Bench {
    fn command(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.app().execute(command, &ctx);
        self.steps(3);
    }

    fn shows(&self, label: &str) -> bool {
        self.harness.query_by_label_contains(label).is_some()
    }

    fn all_checked(&mut self) {
        self.wait_until("the checks", |b| {
            let rev = b.app().document.scene().rev;
            !b.app().threads.checking.is_stale(rev)
        });
        self.steps(3);
    }
}

#[test]
fn findings_stand_beside_the_views_and_mark_what_they_mean() {
    let mut bench = Bench::new();
    bench.off();
    // Three voxels in the air, beside the road.
    let [x, y] = Window::column_at(-20.0, 30.0).expect("inside");
    let cells = vec![[x, y, 9], [x, y, 10], [x + 1, y, 10]];
    let class = Class::Manmade;
    let paint = Edit::PaintVoxels {
        cells: cells.clone(),
        class,
    };
    bench.command(Command::Apply("Paint voxels", vec![paint]));
    bench.all_checked();
    bench.command(Command::View(ViewCommand::TogglePane(PaneId::CHECKS)));
    assert!(bench.shows("Fix all ("));
    let floats = "Warning: 3 voxels of manmade float 2.6 m above the ground";
    let row = bench.harness.get_by_label(floats).rect();
    for view in ["Bird's-eye view", "3D view"] {
        let view = bench.pane(view);
        assert!(view.height() > 300.0 && !view.intersects(row), "{view:?} {row:?}");
    }
    let marks = |b: &mut Bench| b.app().state.shown.finding_marks.as_deref().cloned();
    assert_eq!(marks(&mut bench), None);
    bench.harness.hover_at(row.center());
    bench.steps(3);
    assert_eq!(marks(&mut bench).expect("pointed at").cells, cells);
    let turned = "Error: car 7 faces against its lane, 180 degrees from it";
    let turned = match bench.harness.query_by_label(turned) {
        Some(_) => turned,
        None => "Warning: car 7 faces against its lane, 180 degrees from it",
    };
    let other = bench.harness.get_by_label(turned).rect().center();
    bench.harness.hover_at(other);
    bench.steps(3);
    assert_eq!(marks(&mut bench).expect("pointed at").box_id, Some(BoxId(7)));
    // A click keeps the mark when the pointer leaves.
    bench.click(floats);
    let away = bench.bev(0.0, 0.0);
    bench.harness.hover_at(away);
    bench.steps(3);
    assert_eq!(marks(&mut bench).expect("clicked").cells, cells);
    bench.key(Modifiers::CTRL, Key::Z);
    bench.all_checked();
    assert_eq!(marks(&mut bench), None, "it is gone, and so is its mark");
    bench.command(Command::View(ViewCommand::TogglePane(PaneId::CHECKS)));
    assert!(!bench.shows("All is well") && !bench.shows("Fix all ("));
}

#[test]
fn a_kept_dock_gains_the_panes_that_are_new() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("settings.json");
    let mut old = Dock::default();
    let tile = old.find(PaneId::HISTORY).expect("there");
    old.close(tile);
    let keep = |known: &[PaneId]| {
        let settings = Settings {
            start_screen: false,
            dock: Some(old.tree().clone()),
            panes_known: known.to_vec(),
            ..Settings::default()
        };
        std::fs::write(&file, serde_json::to_string(&settings).expect("JSON")).expect("written");
    };
    keep(&[]);
    let bench = Bench::with_settings(&file);
    assert!(bench.shows("History 0 Open"), "settings of a version without it");
    drop(bench);
    // Closed by the user, it stays closed; a tick in the menu brings it back and takes it away.
    keep(&app::panes::infos().iter().map(|p| p.id).collect::<Vec<_>>());
    let mut bench = Bench::with_settings(&file);
    assert!(!bench.shows("History 0 Open"));
    for shown in [true, false] {
        // The bar's own comes first, then that of the 3D view.
        let menu = bench.harness.query_all_by_label("View").next().expect("the bar");
        menu.click();
        bench.steps(3);
        let panes = bench.harness.get_by_label_contains("Panes").rect().center();
        bench.harness.hover_at(panes);
        bench.steps(20);
        bench.click("History");
        assert_eq!(bench.shows("History 0 Open"), shown);
        bench.key(Modifiers::NONE, Key::Escape);
        bench.steps(3);
    }
}

#[test]
fn the_statistics_open_from_the_view_menu_and_follow_the_scene() {
    let mut bench = Bench::new();
    bench.off();
    assert!(bench.harness.query_by_label_contains("Drivable area: ").is_none());
    let menu = bench.harness.query_all_by_label("View").next().expect("the bar");
    menu.click();
    bench.steps(3);
    let panes = bench.harness.get_by_label_contains("Panes").rect().center();
    bench.harness.hover_at(panes);
    bench.steps(20);
    bench.click("Statistics");
    bench.key(Modifiers::NONE, Key::Escape);
    bench.steps(3);
    let cells = bench.frame().layout.count(scene::BevLayer::DrivableArea);
    let area = format!("Drivable area: {:.0} m²", cells as f64 * 0.16);
    assert!(bench.shows(&area), "{area}");
    assert!(bench.shows("Car: 1 box"));
    let cars = |bench: &Bench| bench.frame().occupancy.class_counts()[usize::from(Class::Car.id())];
    let before = cars(&bench);
    assert!(before > 0 && bench.shows(&format!("Car: {before} voxels")));
    let more = Edit::PaintVoxels {
        cells: vec![[150, 150, 9], [150, 150, 10]],
        class: Class::Car,
    };
    bench.command(Command::Apply("Paint voxels", vec![more]));
    bench.steps(3);
    assert_eq!(cars(&bench), before + 2);
    assert!(bench.shows(&format!("Car: {} voxels", before + 2)));
}
