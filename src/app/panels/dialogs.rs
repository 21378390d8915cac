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
    let modal = Modal::new(Id::unique("unsaved"))
        .frame(theme::dialog_frame(ui.style()))
        .show(ui.ctx(), |ui| {
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
pub fn keys_sheet(ui: &Ui, open: &mut bool) {
    let modal = Modal::new(Id::unique("keys")).frame(theme::dialog_frame(ui.style()));
    let shown = modal.show(ui.ctx(), |ui| {
        ui.set_width(800.0);
        ui.heading("Keys");
        ui.columns_const(|[left, right]: &mut [Ui; 2]| {
            for (column, sections) in [(left, &SHEET[..2]), (right, &SHEET[2..])] {
                for (title, keys) in sections {
                    section(column, title, keys);
                }
            }
        });
    });
    let toggled = ui.input(|i| i.key_pressed(Key::F1));
    if shown.should_close() || toggled {
        *open = false;
    }
}

fn section(ui: &mut Ui, title: &str, keys: &[(&str, &str)]) {
    crate::app::icons::section(ui, title);
    for (key, what) in keys {
        ui.horizontal(|ui| {
            let name = egui::Label::new(egui::RichText::new(*key).color(theme::TEXT_STRONG));
            ui.scope(|ui| {
                ui.set_width(172.0);
                ui.add(name);
            });
            ui.label(egui::RichText::new(*what).color(theme::TEXT_WEAK));
        });
    }
}
