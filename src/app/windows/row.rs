//! The window of rows of copies: its numbers are previewed over the map, then applied as one undo step.

use egui::{DragValue, Ui};

use crate::command::Command;
use crate::fields::{caption, number};
use editor::rows::{self, MAX_COPIES, RowAlong};
use language::{t, tf};
use scene::{Form, Scene, SceneBox};
use widgets::icons;
use widgets::theme;

use crate::tools::{Hand, ToolCommand};

/// The copies that the row would add: boxes, and things (world frame).
pub(crate) fn coming(scene: &Scene, hand: &Hand) -> (Vec<SceneBox>, Vec<Form>) {
    let things: Vec<&Form> = hand
        .things
        .chosen_in(&scene.background)
        .map(|t| &t.form)
        .collect();
    let forms = rows::row_forms(scene, &things, &hand.row);
    (rows::row_boxes(scene.frame(), &hand.chosen(), &hand.row), forms)
}

/// Draws the window while it is open.
pub fn show(ui: &Ui, scene: &Scene, hand: &mut Hand, commands: &mut Vec<Command>) {
    if !hand.row_open {
        return;
    }
    let mut done = None;
    // Below the views, which are not dimmed, since they show the preview.
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
                        (RowAlong::Lane, t("Lane"), t("the nearest lane")),
                        (RowAlong::Side, t("Left"), t("to the left of the heading")),
                    ],
                );
            });
            ui.horizontal(|ui| {
                caption(ui, t("Rows"));
                let drag = DragValue::new(&mut row.rows).range(1..=MAX_COPIES);
                ui.add_sized([86.0, theme::ROW], drag)
                    .accessible_name(t("Rows"))
                    .on_hover_text(t("beside each other: a grid"));
            });
            if row.rows > 1 {
                let apart = t("Apart");
                number(ui, apart, apart, &mut row.apart_m, -80.0..=80.0, " m", 2);
            }
            let chosen = hand.chosen().len() + hand.things.chosen_in(&scene.background).count();
            let (boxes, things) = coming(scene, hand);
            let (asked, come) = (hand.row.asked() * chosen, boxes.len() + things.len());
            let text = match asked - come.min(asked) {
                0 => tf!("{n} copies come", n = come),
                out => tf!(
                    "{n} copies come; {out} would lie outside the map and are left out",
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
