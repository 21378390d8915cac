//! The window of rows of copies: numbers, then one undo step.

use egui::{DragValue, Ui};

use crate::app::command::Command;
use crate::app::icons;
use crate::app::panels::fields::{caption, number};
use crate::app::state::UiState;
use crate::app::theme;
use crate::editor::arrange::{MAX_COPIES, RowAlong};

use super::ToolCommand;

/// Draws the windows of the tools that are open.
pub fn show(ui: &Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    if !state.tools.row_open {
        return;
    }
    let mut done = None;
    let modal = egui::Modal::new(egui::Id::unique("row of copies"))
        .frame(theme::dialog_frame(ui.style()))
        .show(ui.ctx(), |ui| {
            ui.set_width(330.0);
            ui.heading("Row of copies");
            ui.add_space(theme::GAP);
            let row = &mut state.tools.row;
            ui.horizontal(|ui| {
                caption(ui, "Copies");
                let drag = DragValue::new(&mut row.copies).range(1..=MAX_COPIES);
                ui.add_sized([86.0, theme::ROW], drag).accessible_name("Copies");
            });
            number(
                ui,
                "Spacing",
                "Spacing",
                &mut row.spacing_m,
                -80.0..=80.0,
                " m",
                2,
            );
            ui.horizontal(|ui| {
                caption(ui, "Along");
                icons::segments(
                    ui,
                    &mut row.along,
                    &[
                        (RowAlong::Heading, "Heading", "straight ahead"),
                        (RowAlong::Lane, "Lane", "the lane under each box"),
                        (RowAlong::Side, "Left", "to the left of the heading"),
                    ],
                );
            });
            ui.add_space(theme::GAP);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let add = ui.add(egui::Button::new("Add copies").fill(theme::accent_fill()));
                let enter = ui.input(|i| i.key_pressed(egui::Key::Enter));
                if add.clicked() || enter {
                    done = Some(true);
                }
                if ui.button("Close row").clicked() {
                    done = Some(false);
                }
            });
        });
    if done.is_none() && modal.should_close() {
        done = Some(false);
    }
    if let Some(add) = done {
        state.tools.row_open = false;
        if add {
            commands.push(Command::Tools(ToolCommand::Row(state.tools.row)));
        }
    }
}
