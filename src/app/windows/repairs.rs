//! The list of planned repairs, shown before they are applied.

use egui::{RichText, Ui};

use crate::command::{Command, RepairCommand, ViewCommand};
use crate::panes::checks::in_words;
use crate::shell::planning::RepairPlanState;
use editor::checks::SeverityCounts;
use editor::fix::{RepairPlan, Stays};
use language::{t, tf};
use scene::SceneRev;
use widgets::theme;

/// Width of the window, and height of the list, points.
const WIDTH: f32 = 560.0;
const LIST: f32 = 300.0;

/// Draws the window; `now` is the state to which the repairs would be applied.
pub fn repairs_ui(ui: &Ui, shown: &RepairPlanState, now: SceneRev, commands: &mut Vec<Command>) {
    let mut open = true;
    egui::Window::new(t("Repairs"))
        .id(egui::Id::unique("repairs"))
        .open(&mut open)
        .default_pos(egui::pos2(ui.max_rect().center().x - WIDTH / 2.0, 90.0))
        .resizable(false)
        .collapsible(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            match shown {
                RepairPlanState::Planning(progress) => {
                    let text = match progress {
                        Some(p) => tf!(
                            "Trying repairs: {n} of {all}, {kept} help",
                            n = p.decided,
                            all = p.of,
                            kept = p.kept
                        ),
                        None => t("Looking for repairs…").to_owned(),
                    };
                    ui.horizontal(|ui| {
                        let hint = t("Lists what was found by then");
                        if ui.button(t("Stop")).on_hover_text(hint).clicked() {
                            commands.push(Command::Repair(RepairCommand::Stop));
                        }
                        ui.add(egui::Spinner::new().size(13.0));
                        ui.label(text);
                    });
                    ui.weak(t("Nothing is changed before you have seen the list."));
                }
                RepairPlanState::Planned(plan) => planned(ui, plan, plan.of != now, commands),
            }
        });
    if !open {
        commands.push(Command::Repair(RepairCommand::Close));
    }
}

fn planned(ui: &mut Ui, plan: &RepairPlan, stale: bool, commands: &mut Vec<Command>) {
    let open = |counts: SeverityCounts| in_words(SeverityCounts { infos: 0, ..counts });
    ui.label(match plan.repairs.is_empty() {
        true => t("No repair makes the scene better.").to_owned(),
        false => tf!(
            "Now: {before}. Afterwards: {after}.",
            before = open(plan.before),
            after = open(plan.after)
        ),
    });
    if plan.stopped {
        ui.label(RichText::new(t("Stopped: there may be more.")).color(theme::warn()));
    }
    ui.separator();
    let rows: Vec<RepairRow<'_>> = plan
        .repairs
        .iter()
        .map(|r| RepairRow {
            does: t(r.label),
            says: t(&r.finding.text),
            at: r.finding.where_m,
            done: true,
        })
        .chain(plan.stays.iter().map(|(f, why)| RepairRow {
            does: reason(*why),
            says: t(&f.text),
            at: f.where_m,
            done: false,
        }))
        .collect();
    egui::ScrollArea::vertical()
        .auto_shrink([false, true])
        .max_height(LIST)
        .show_rows(ui, theme::ROW, rows.len(), |ui, range| {
            for row in &rows[range] {
                row.ui(ui, commands);
            }
        });
    ui.separator();
    if stale {
        let text = t("The scene has changed since. Look again before anything is repaired.");
        ui.label(RichText::new(text).color(theme::warn()));
    }
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        if stale {
            if ui.button(t("Look again")).clicked() {
                commands.push(Command::Repair(RepairCommand::Again));
            }
        } else if !plan.repairs.is_empty() {
            let text = tf!("Repair {n}", n = plan.repairs.len());
            let button = egui::Button::new(text).fill(theme::accent_fill());
            let hint = t("All of it as one step to undo");
            if ui.add(button).on_hover_text(hint).clicked() {
                commands.push(Command::Repair(RepairCommand::Apply));
            }
        }
        if ui.button(t("Close")).clicked() {
            commands.push(Command::Repair(RepairCommand::Close));
        }
    });
}

/// A line of the list.
struct RepairRow<'a> {
    does: &'a str,
    says: &'a str,
    at: glam::DVec3,
    done: bool,
}

impl RepairRow<'_> {
    fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let name = format!("{}: {}", self.does, self.says);
        let color = match self.done {
            true => theme::text(),
            false => theme::text_weak(),
        };
        let text = RichText::new(&name).color(color);
        let response = ui.add(egui::Button::new(text).frame(false).truncate());
        if response.on_hover_text(&name).clicked() {
            commands.push(Command::View(ViewCommand::FrameAt(self.at)));
        }
    }
}

/// The reason why a finding stays, as the beginning of a line.
fn reason(why: Stays) -> &'static str {
    match why {
        Stays::NoBetter => t("Stays, as its repair makes nothing better"),
        Stays::AskedForAlone => t("Stays, as its repair makes the map larger: use its own button"),
        Stays::Locked => t("Stays, as it is locked"),
        Stays::NotTried => t("Stays, as it was not tried"),
    }
}
