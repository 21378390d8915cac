//! Time of day and weather, chosen by the mouse where the cameras have little room; and menus that stay as they are.

use app::command::{Command, ViewCommand};
use app::dock::Workspace;
use app::panes::id::PaneId;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use scene::{TimeOfDay, Weather};

use super::bench::Bench;

fn view(bench: &mut Bench, view: ViewCommand) {
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(Command::View(view), &ctx);
    bench.steps(4);
}

/// Presses and lets go at a widget, as a hand does.
fn press(bench: &mut Bench, label: &str) {
    // What is open lies on top, and comes last.
    let all = bench.harness.query_all_by_label(label);
    let at = all.last().unwrap_or_else(|| panic!("no {label}")).rect().center();
    bench.drag(&[at], egui::Modifiers::NONE);
    bench.steps(3);
}

fn is_there(bench: &Bench, label: &str) -> bool {
    bench.harness.query_all_by_label(label).next().is_some()
}

fn is_chosen_by_mouse(bench: &mut Bench, where_: &str) {
    assert!(is_there(bench, "Light…"), "{where_}");
    let conditions = |b: &mut Bench| b.app().document.scene().conditions;
    press(bench, "Light…");
    press(bench, "Night");
    assert_eq!(conditions(bench).time, TimeOfDay::Night, "{where_}");
    // The menu stays, and where it is: both are chosen on one visit, however long it takes.
    let rain = bench.harness.get_by_label("Rain").rect();
    bench.steps(40);
    assert_eq!(bench.harness.get_by_label("Rain").rect(), rain, "{where_}");
    bench.drag(&[rain.center()], egui::Modifiers::NONE);
    assert_eq!(conditions(bench).weather, Weather::Rain, "{where_}");
    press(bench, "Day");
    press(bench, "Overcast");
    assert_eq!(
        (conditions(bench).time, conditions(bench).weather),
        (TimeOfDay::Day, Weather::Overcast),
        "{where_}"
    );
    bench.key(egui::Modifiers::NONE, egui::Key::Escape);
    assert!(!is_there(bench, "Rain"), "{where_}: closed");
}

#[test]
fn light_is_set_by_mouse_in_every_workspace_and_in_a_narrow_window() {
    let mut bench = Bench::new();
    bench.off();
    for (workspace, name) in Workspace::ALL {
        view(&mut bench, ViewCommand::Workspace(workspace));
        view(&mut bench, ViewCommand::ShowLight);
        // Where there is room the fields stand side by side, without a menu.
        let menu = is_there(&bench, "Light…");
        assert!(
            menu || !matches!(workspace, Workspace::Sensors | Workspace::Trade),
            "{name}"
        );
        if menu {
            is_chosen_by_mouse(&mut bench, name);
        }
    }
    view(&mut bench, ViewCommand::Workspace(Workspace::Edit));
    view(&mut bench, ViewCommand::ShowPane(PaneId::CAMERAS));
    for width in [1000.0, 760.0] {
        bench.harness.set_size(egui::vec2(width, 700.0));
        bench.steps(4);
        is_chosen_by_mouse(&mut bench, &format!("{width} points"));
    }
}

/// Everything with a name, and where it is.
fn places(bench: &Bench) -> Vec<(String, egui::Rect)> {
    let roles = [
        Role::Button,
        Role::CheckBox,
        Role::ComboBox,
        Role::Label,
        Role::MenuItem,
    ];
    let mut out = Vec::new();
    for role in roles {
        for node in bench.harness.query_all_by_role(role) {
            if let Some(label) = node.accesskit_node().label() {
                out.push((label, node.rect()));
            }
        }
    }
    out
}

/// A menu that is as high as it was in the frame before and a bit grows until it has no room, and jumps.
#[test]
fn menus_that_are_open_stay_as_they_are() {
    let mut bench = Bench::new();
    bench.off();
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    view(&mut bench, ViewCommand::ShowLight);
    bench.harness.set_size(egui::vec2(1000.0, 800.0));
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(40);
    for menu in ["File", "View", "Generate", "Help", "Show", "Light…"] {
        let at = {
            let mut found = bench.harness.query_all_by_label(menu);
            found
                .next()
                .unwrap_or_else(|| panic!("no {menu}"))
                .rect()
                .center()
        };
        let closed = places(&bench).len();
        bench.drag(&[at], egui::Modifiers::NONE);
        bench.steps(6);
        let opened = places(&bench);
        assert!(opened.len() > closed, "{menu} opens");
        bench.steps(40);
        assert_eq!(places(&bench), opened, "{menu}");
        bench.key(egui::Modifiers::NONE, egui::Key::Escape);
        bench.steps(3);
    }
}
