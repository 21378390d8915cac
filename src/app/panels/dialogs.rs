//! Windows over everything: unsaved changes, the sheet of keys.

use egui::{Id, Key, Modal, Ui};

use crate::app::keys::SHEET;
use crate::app::theme;

/// What the user wants to become of unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaved {
    /// Save them, then go on.
    Save,
    /// Go on without them.
    Discard,
    /// Stay.
    Stay,
}

/// Asks what should become of unsaved changes; `None` until there is an answer.
pub fn unsaved_ui(ui: &Ui, name: &str) -> Option<Unsaved> {
    let mut answer = None;
    let modal = Modal::new(Id::unique("unsaved")).show(ui.ctx(), |ui| {
        ui.set_width(400.0);
        ui.heading("Unsaved changes");
        ui.add_space(theme::GAP);
        ui.label(format!("“{name}” has changes that are in no file yet."));
        ui.add_space(2.0 * theme::GAP);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui
                .add(egui::Button::new("Save changes").fill(theme::ACCENT_FILL))
                .clicked()
            {
                answer = Some(Unsaved::Save);
            }
            if ui.button("Discard changes").clicked() {
                answer = Some(Unsaved::Discard);
            }
            if ui.button("Keep editing").clicked() {
                answer = Some(Unsaved::Stay);
            }
        });
    });
    if answer.is_none() && modal.should_close() {
        answer = Some(Unsaved::Stay);
    }
    answer
}

/// The sheet of keys.
pub fn keys_window(ui: &Ui, open: &mut bool) {
    let close = ui.input(|i| i.key_pressed(Key::Escape));
    let window = egui::Window::new("Keys")
        .open(open)
        .collapsible(false)
        .resizable(false);
    window
        .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ui.ctx(), |ui| {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = 36.0;
                let columns = [&SHEET[..2], &SHEET[2..]];
                for sections in columns {
                    ui.vertical(|ui| {
                        for (title, keys) in sections {
                            crate::app::icons::section(ui, title);
                            egui::Grid::new(title)
                                .num_columns(2)
                                .spacing([20.0, 5.0])
                                .show(ui, |ui| {
                                    for (key, what) in *keys {
                                        ui.label(egui::RichText::new(*key).color(theme::TEXT_STRONG));
                                        ui.label(egui::RichText::new(*what).color(theme::TEXT_WEAK));
                                        ui.end_row();
                                    }
                                });
                            ui.add_space(theme::GAP);
                        }
                    });
                }
            });
        });
    if close {
        *open = false;
    }
}
