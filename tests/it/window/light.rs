//! Time of day and weather, chosen by the mouse where the cameras have little room.

use app::command::{Command, ViewCommand};
use app::panes::id::PaneId;
use egui_kittest::kittest::Queryable;
use scene::{TimeOfDay, Weather};

use super::bench::Bench;

impl Bench {
    fn bring(&mut self, view: ViewCommand) {
        let ctx = self.harness.ctx.clone();
        self.app().execute(Command::View(view), &ctx);
        self.steps(4);
    }
}

/// Presses and lets go at a widget, as a hand does.
fn press(bench: &mut Bench, label: &str) {
    // What is open lies on top, and comes last.
    let all = bench.harness.query_all_by_label(label);
    let at = all.last().unwrap_or_else(|| panic!("no {label}")).rect().center();
    bench.drag(&[at], egui::Modifiers::NONE);
    bench.steps(3);
}

fn is_chosen_by_mouse(bench: &mut Bench) {
    let conditions = |b: &mut Bench| b.app().document.scene().conditions;
    press(bench, "Light…");
    press(bench, "Night");
    assert_eq!(conditions(bench).time, TimeOfDay::Night);
    // The menu stays: both are chosen on one visit.
    press(bench, "Rain");
    assert_eq!(conditions(bench).weather, Weather::Rain);
    press(bench, "Day");
    press(bench, "Overcast");
    assert_eq!(
        (conditions(bench).time, conditions(bench).weather),
        (TimeOfDay::Day, Weather::Overcast)
    );
    bench.key(egui::Modifiers::NONE, egui::Key::Escape);
    assert!(bench.harness.query_by_label("Rain").is_none(), "closed");
}

#[test]
fn light_is_set_by_mouse_in_every_workspace_and_in_a_narrow_window() {
    let mut bench = Bench::new();
    bench.off();
    for workspace in ["Sensors", "Trade"] {
        bench.click(workspace);
        bench.bring(ViewCommand::ShowPane(PaneId::CAMERAS));
        bench.bring(ViewCommand::ShowLight);
        if bench.harness.query_all_by_label("Light…").next().is_some() {
            is_chosen_by_mouse(&mut bench);
        }
    }
    bench.click("Layout");
    bench.bring(ViewCommand::ShowPane(PaneId::CAMERAS));
    for width in [1000.0, 760.0] {
        bench.harness.set_size(egui::vec2(width, 700.0));
        bench.steps(4);
        assert!(
            bench.harness.query_all_by_label("Light…").next().is_some(),
            "{width} points"
        );
        is_chosen_by_mouse(&mut bench);
    }
}
