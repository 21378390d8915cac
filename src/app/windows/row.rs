//! The window of rows of copies: numbers, with what would come shown over the map, then one undo step.

use egui::{DragValue, Ui};

use crate::command::Command;
use crate::fields::{caption, number};
use editor::arrange::{self, MAX_COPIES, RowAlong};
use language::{t, tf};
use scene::{Frame, SceneBox};
use widgets::icons;
use widgets::theme;

use crate::tools::{Hand, ToolCommand};

/// The copies that the row of the dialog would add.
pub(crate) fn coming(frame: &Frame, hand: &Hand) -> Vec<SceneBox> {
    arrange::row_boxes(frame, &hand.chosen(), &hand.row)
}

/// Draws the windows of the tools that are open.
pub fn show(ui: &Ui, frame: &Frame, hand: &mut Hand, commands: &mut Vec<Command>) {
    if !hand.row_open {
        return;
    }
    let mut done = None;
    // Below the views, undimmed: they show what would come.
    let id = egui::Id::unique("row of copies");
    let area = egui::Modal::default_area(id).anchor(egui::Align2::CENTER_BOTTOM, egui::vec2(0.0, -60.0));
    let modal = egui::Modal::new(id)
        .area(area)
        .backdrop_color(egui::Color32::TRANSPARENT)
        .frame(theme::dialog_frame(ui.style()))
        .show(ui.ctx(), |ui| {
            ui.set_width(330.0);
            ui.heading(t("Row of copies"));
            ui.add_space(theme::GAP);
            let row = &mut hand.row;
            ui.horizontal(|ui| {
                caption(ui, t("Copies"));
                let drag = DragValue::new(&mut row.copies).range(1..=MAX_COPIES);
                ui.add_sized([86.0, theme::ROW], drag)
                    .accessible_name(t("Copies"));
            });
            number(
                ui,
                t("Spacing"),
                t("Spacing"),
                &mut row.spacing_m,
                -80.0..=80.0,
                " m",
                2,
            );
            ui.horizontal(|ui| {
                caption(ui, t("Along"));
                icons::segments(
                    ui,
                    &mut row.along,
                    &[
                        (RowAlong::Heading, t("Heading"), t("straight ahead")),
                        (RowAlong::Lane, t("Lane"), t("the lane under each box")),
                        (RowAlong::Side, t("Left"), t("to the left of the heading")),
                    ],
                );
            });
            let (asked, come) = (hand.row.copies * hand.chosen().len(), coming(frame, hand).len());
            let text = match asked - come.min(asked) {
                0 => tf!("{n} boxes come", n = come),
                out => tf!(
                    "{n} boxes come; {out} would lie outside the map and are left out",
                    n = come,
                    out = out
                ),
            };
            ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            ui.add_space(theme::GAP);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let add = ui.add(egui::Button::new(t("Add copies")).fill(theme::accent_fill()));
                let enter = ui.input(|i| i.key_pressed(egui::Key::Enter));
                if add.clicked() || enter {
                    done = Some(true);
                }
                if ui.button(t("Cancel row")).clicked() {
                    done = Some(false);
                }
            });
        });
    if done.is_none() && modal.should_close() {
        done = Some(false);
    }
    if let Some(add) = done {
        hand.row_open = false;
        if add {
            commands.push(Command::Tools(ToolCommand::Row(hand.row)));
        }
    }
}
