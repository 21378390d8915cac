//! Where things stand in the window: nothing lies over a title or a tab, and what is pressed stays under the pointer.

use app::command::{Command, GenerationCommand, ViewCommand};
use app::dock::Workspace;
use app::panes::id::PaneId;
use editor::Edit;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect};
use egui_kittest::kittest::Queryable;
use glam::{DVec2, DVec3};
use scene::{BoxId, Class};

use super::bench::{Bench, Do, car};

fn execute(bench: &mut Bench, command: Command) {
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(command, &ctx);
    bench.steps(4);
}

fn rect(bench: &Bench, label: &str) -> Rect {
    bench.harness.get_by_label(label).rect()
}

fn is_there(bench: &Bench, label: &str) -> bool {
    bench.harness.query_all_by_label(label).next().is_some()
}

/// The places of everything of these names. (What is cut off by a list that is scrolled has a place beyond it.)
fn of_names(bench: &Bench, names: &[&'static str]) -> Vec<(&'static str, Rect)> {
    let of = |name: &&'static str| {
        let nodes = bench
            .harness
            .query_all_by_label(name)
            .map(|node| (*name, node.rect()));
        nodes.collect::<Vec<_>>()
    };
    names.iter().flat_map(of).collect()
}

fn lowest(bench: &Bench, label: &str) -> egui::Pos2 {
    let all = bench.harness.query_all_by_label(label).map(|node| node.rect());
    let lowest = all.max_by(|a, b| a.top().total_cmp(&b.top()));
    lowest.unwrap_or_else(|| panic!("no {label}")).center()
}

/// In a low and narrow window the controls lay over the title, and pushed the lists out of the pane to the left.
#[test]
fn the_perception_pane_fits_into_a_small_window() {
    let mut bench = Bench::new();
    bench.off();
    execute(
        &mut bench,
        Command::View(ViewCommand::ShowPane(PaneId::named("perception"))),
    );
    let both = lowest(&bench, "Both");
    bench.drag(&[both], Modifiers::NONE);
    bench.click("Box 7 car");
    for size in [[1400.0, 900.0], [1100.0, 620.0], [1024.0, 560.0], [860.0, 560.0]] {
        bench.harness.set_size(egui::vec2(size[0], size[1]));
        bench.steps(6);
        let title = rect(&bench, "Perception     ");
        let names = [
            "Cameras",
            "LiDAR",
            "Both",
            "By",
            "Show",
            "Its voxels in the 3D view",
            "What stands where, over the map",
        ];
        for (name, at) in of_names(&bench, &names) {
            let over = at.intersect(title).is_positive() && at != title;
            assert!(!over, "{size:?}: {name} at {at:?} over the title at {title:?}");
        }
        let missed = rect(&bench, "MISSED");
        assert!(
            missed.left() >= title.left() - 9.0,
            "{size:?}: {missed:?} {title:?}"
        );
        // What is shown in the large views is chosen here, at once or in a menu.
        let told = "Its voxels in the 3D view";
        if !is_there(&bench, told) {
            let menu = lowest(&bench, "Show");
            bench.drag(&[menu], Modifiers::NONE);
            bench.steps(3);
            assert!(is_there(&bench, told), "{size:?}");
            bench.key(Modifiers::NONE, Key::Escape);
        }
    }
}

/// The tab of the versions lay under their own buttons.
#[test]
fn no_tab_lies_under_a_button() {
    let mut bench = Bench::new();
    bench.off();
    for width in [1400.0, 1000.0] {
        bench.harness.set_size(egui::vec2(width, 800.0));
        bench.steps(4);
        for pane in [PaneId::VERSIONS, PaneId::HISTORY] {
            execute(&mut bench, Command::View(ViewCommand::ShowPane(pane)));
            for tab in ["History", "Versions"] {
                let tab_at = bench.harness.get_by_role_and_label(Role::Button, tab).rect();
                let names = [
                    "Keep",
                    "Compare",
                    "Off",
                    "Wipe",
                    "Diff",
                    "Menu of Versions",
                    "Menu of History",
                    "Scroll tabs left",
                    "Scroll tabs right",
                ];
                for (name, at) in of_names(&bench, &names) {
                    let over = at.intersect(tab_at).is_positive() && at != tab_at;
                    assert!(
                        !over,
                        "{width}: {name} at {at:?} over the tab {tab} at {tab_at:?}"
                    );
                }
            }
        }
        // Each is a press away, and what it offers is there.
        for (tab, keeps) in [("Versions", true), ("History", false), ("Versions", true)] {
            let at = bench
                .harness
                .get_by_role_and_label(Role::Button, tab)
                .rect()
                .center();
            bench.drag(&[at], Modifiers::NONE);
            bench.steps(3);
            assert_eq!(is_there(&bench, "Keep"), keeps, "{tab}");
        }
    }
}

#[test]
fn delete_removes_the_chosen_box_over_an_enlarged_camera() {
    let mut bench = Bench::new();
    bench.off();
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(2);
    bench.click("Camera Front");
    bench.steps(3);
    bench.app().state.choose(&[BoxId(7)], app::tools::Choose::Only);
    let over = bench.pane("Enlarged camera").center();
    bench.harness.hover_at(over);
    bench.steps(2);
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(bench.frame().boxes.is_empty());
    assert_eq!(bench.history().last().map(String::as_str), Some("Delete box"));
    // Over a window of another kind the key is not meant for the scene.
    bench.key(Modifiers::CTRL, Key::Z);
    bench.key(Modifiers::NONE, Key::Escape);
    bench.app().state.choose(&[BoxId(7)], app::tools::Choose::Only);
    execute(&mut bench, Command::Toggle(app::command::Window::Sensors));
    let over = rect(&bench, "Camera CAM_BACK").center();
    bench.harness.hover_at(over);
    bench.steps(2);
    bench.key(Modifiers::NONE, Key::Delete);
    assert_eq!(bench.frame().boxes.len(), 1);
}

#[test]
fn buttons_stay_under_the_pointer_while_something_is_generated() {
    let mut bench = Bench::new();
    bench.off();
    let (live, generate) = (rect(&bench, "Live"), rect(&bench, "Generate everything"));
    execute(
        &mut bench,
        Command::Generation(GenerationCommand::Generate { full: true }),
    );
    bench
        .started
        .recv_timeout(super::bench::PATIENCE)
        .expect("it starts");
    bench.wait_until("the button that cancels", |b| is_there(b, "Cancel job"));
    assert_eq!(
        (rect(&bench, "Live"), rect(&bench, "Cancel job")),
        (live, generate)
    );
    let stops = |b: &Bench| [rect(b, "Cancel generation"), rect(b, "Cancel all")];
    let first = stops(&bench);
    for step in 1..=3 {
        bench.orders.send(Do::Step).expect("it runs");
        let says = format!("{step}/3");
        bench.wait_until("the step", |b| b.harness.query_by_label_contains(&says).is_some());
        assert_eq!(stops(&bench), first, "step {step}");
    }
    bench.orders.send(Do::Finish).expect("it runs");
    bench.wait_until("the end", |b| is_there(b, "Generate everything"));
    assert_eq!(rect(&bench, "Live"), live);
}

#[test]
fn the_timeline_keeps_its_buttons_when_nothing_waits_to_drive() {
    let mut bench = Bench::new();
    bench.off();
    execute(&mut bench, Command::View(ViewCommand::Workspace(Workspace::Clip)));
    let length = Edit::SetLength {
        length_s: 4.0,
        rate_hz: None,
    };
    execute(&mut bench, Command::Apply("Set length", vec![length]));
    let forecast = rect(&bench, "Forecast");
    let waits = Edit::AddBox {
        class: Class::Car,
        center_m: DVec3::new(-20.0, -3.0, 0.85),
        size_m: car().size_m,
        yaw_deg: 0.0,
        velocity_mps: Some(DVec2::new(8.0, 0.0)),
        id: None,
        label: Default::default(),
    };
    execute(&mut bench, Command::Apply("Add box", vec![waits]));
    assert_eq!(rect(&bench, "Forecast"), forecast);
    bench.click("Let traffic drive");
    assert_eq!(rect(&bench, "Forecast"), forecast);
}

/// Types into a number field as a hand does: a press, a letter in each frame, Enter.
fn types(bench: &mut Bench, field: &str, text: &str) {
    let at = bench
        .harness
        .get_by_role_and_label(Role::SpinButton, field)
        .rect()
        .center();
    bench.drag(&[at], Modifiers::NONE);
    for letter in text.chars() {
        bench.harness.event(egui::Event::Text(letter.into()));
        bench.steps(3);
    }
    bench.key(Modifiers::NONE, Key::Enter);
}

#[test]
fn numbers_of_a_box_are_typed_and_are_one_step_each() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Box 7 car");
    let steps = bench.history().len();
    let b = |bench: &Bench| bench.frame().boxes[&BoxId(7)];
    types(&mut bench, "Heading", "33.37");
    assert!((b(&bench).yaw_rad.to_degrees() - 33.37).abs() < 1e-9);
    // It shows 33.4; opened and left, it is what it was, and nothing was done.
    types(&mut bench, "Heading", "");
    assert!((b(&bench).yaw_rad.to_degrees() - 33.37).abs() < 1e-9);
    assert_eq!(bench.history().len(), steps + 1);
    types(&mut bench, "Speed", "42.5");
    assert!((b(&bench).velocity_mps.length() * 3.6 - 42.5).abs() < 1e-9);
    assert!(b(&bench).velocity_mps.normalize().distance(b(&bench).heading()) < 1e-9);
    // Along its own axes, which give back another number than was typed.
    let from_m = b(&bench).center_m;
    bench.click("Local");
    types(&mut bench, "Ahead", "1.25");
    let moved = (b(&bench).center_m - from_m).truncate();
    assert!(moved.distance(b(&bench).heading() * 1.25) < 1e-9, "{moved}");
    let history = bench.history();
    assert_eq!(history[steps..], ["Turn box", "Set speed", "Move box"]);
    // Escape drops what was typed.
    let at = bench
        .harness
        .get_by_role_and_label(Role::SpinButton, "Speed")
        .rect()
        .center();
    bench.drag(&[at], Modifiers::NONE);
    bench.harness.event(egui::Event::Text("9".into()));
    bench.steps(2);
    bench.key(Modifiers::NONE, Key::Escape);
    assert!((b(&bench).velocity_mps.length() * 3.6 - 42.5).abs() < 1e-9);
    assert_eq!(bench.history(), history);
}
