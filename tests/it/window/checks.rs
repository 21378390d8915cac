//! The list of what the quality checks found: beside what it speaks of, and marking it.

use app::command::{Command, FileCommand, RepairCommand, ViewCommand};
use app::dock::Dock;
use app::panes::id::PaneId;
use app::settings::Settings;
use app::shell::planning::RepairPlanState;
use editor::Edit;
use editor::checks::{SeverityCounts, run_checks};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use formats::loom;
use scene::{BoxId, Class, Window};

use super::bench::{Bench, car};

impl Bench {
    fn command(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.app().execute(command, &ctx);
        self.steps(3);
    }

    fn shows(&self, label: &str) -> bool {
        self.harness.query_all_by_label_contains(label).next().is_some()
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

/// A second car half in the first: an error that moving it repairs.
fn crash(bench: &mut Bench) {
    let other = Edit::AddBox {
        class: Class::Car,
        center_m: car().center_m + glam::DVec3::new(1.0, 0.3, 0.0),
        size_m: car().size_m,
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(BoxId(8)),
        label: Default::default(),
    };
    bench.command(Command::Apply("Add a box", vec![other]));
    bench.all_checked();
}

fn errors(bench: &Bench) -> usize {
    let scene = bench.harness.state().document.scene().clone();
    SeverityCounts::from_findings(&run_checks(&scene, None)).errors
}

impl Bench {
    pub(super) fn planned(&mut self) {
        self.wait_until("the plan", |b| {
            matches!(
                b.app().threads.planning.shown(),
                Some(RepairPlanState::Planned(_))
            )
        });
        self.steps(3);
    }

    pub(super) fn press(&mut self, label: &str) {
        self.harness.get_by_label_contains(label).click();
        self.steps(3);
    }
}

#[test]
fn what_would_be_repaired_is_listed_first_and_done_as_one_step() {
    let mut bench = Bench::new();
    bench.off();
    crash(&mut bench);
    assert!(errors(&bench) > 0);
    bench.command(Command::View(ViewCommand::ShowPane(PaneId::CHECKS)));
    let before = bench.app().document.scene().rev;
    let steps = bench.history().len();
    bench.press("Fix all (");
    bench.planned();
    assert!(bench.shows("Repairs"), "the window");
    let lines = bench
        .harness
        .query_all_by_label_contains("Move apart: car 7 and car 8 overlap");
    assert_eq!(lines.count(), 2, "of the pane and of the list");
    assert!(bench.shows("Now: 1 error"));
    assert_eq!(bench.app().document.scene().rev, before, "nothing is done yet");
    bench.click("Close");
    assert!(!bench.shows("Now: 1 error") && bench.history().len() == steps);
    bench.press("Fix all (");
    bench.planned();
    bench.press("Repair ");
    let now = bench.history();
    assert_eq!(
        (now.len(), now.last().map(String::as_str)),
        (steps + 1, Some("Repair findings"))
    );
    assert_eq!(errors(&bench), 0);
    assert_eq!(bench.frame().boxes.len(), 2, "nothing is taken away");
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.app().document.scene().rev, before);
}

#[test]
fn a_plan_is_made_beside_the_window_and_is_of_one_state() {
    let mut bench = Bench::new();
    bench.off();
    crash(&mut bench);
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(Command::Repair(RepairCommand::PlanAll), &ctx);
    // The command has returned, and the plan is still to come.
    assert!(matches!(
        bench.app().threads.planning.shown(),
        Some(RepairPlanState::Planning(None))
    ));
    bench.planned();
    assert!(bench.shows("Move apart: "));
    // Edited meanwhile, it is a plan for another state: it is not done, but made again.
    bench.command(Command::Apply(
        "Remove box",
        vec![Edit::RemoveBox { id: BoxId(8) }],
    ));
    let removed = bench.app().document.scene().rev;
    assert!(bench.shows("The scene has changed since") && !bench.shows("Repair "));
    bench.command(Command::Repair(RepairCommand::Apply));
    assert_eq!(bench.app().document.scene().rev, removed);
    bench.click("Look again");
    bench.planned();
    assert!(!bench.shows("Move apart: ") && !bench.shows("The scene has changed since"));
    // Stopped, what there is by then is listed, and the window can be closed.
    bench.command(Command::Repair(RepairCommand::PlanThese(Vec::new())));
    bench.command(Command::Repair(RepairCommand::Stop));
    bench.planned();
    assert!(bench.shows("No repair makes the scene better."));
    bench.click("Close");
    assert!(bench.app().threads.planning.shown().is_none());
}

#[test]
fn nothing_of_the_scene_before_is_shown_of_a_new_one() {
    let mut bench = Bench::new();
    bench.off();
    crash(&mut bench);
    bench.command(Command::View(ViewCommand::ShowPane(PaneId::CHECKS)));
    bench.press("Error: car 7 and car 8 overlap");
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.press("Fix all (");
    bench.planned();
    let path = bench.open_path();
    loom::save(&path, &super::bench::scene()).expect("saved");
    bench.app().document.mark_saved();
    bench.command(Command::File(FileCommand::OpenPath(path.clone())));
    bench.wait_until("the scene", |b| b.app().path() == Some(&*path));
    // In the first frame that shows it: what there is, is of it.
    let app = bench.app();
    let rev = app.document.scene().rev;
    assert!(app.threads.checking.findings().is_none() || !app.threads.checking.is_stale(rev));
    assert!(app.sensing().cameras().is_none() || !app.sensing().cameras_stale(rev));
    assert!(app.sensing().lidar().is_none() || !app.sensing().lidar_stale(rev));
    assert!(app.threads.planning.shown().is_none());
    assert!(app.state.shown.finding_marks.is_none());
    // What was on its way for the scene before does not come after all.
    bench.all_checked();
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    assert!(!bench.shows("car 7 and car 8 overlap"));
}
