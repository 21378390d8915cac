//! The dialog about unsaved changes, over everything.

use egui::{Id, Modal, Ui};

use language::{t, tf};
use widgets::theme;

/// Decision of the user about unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaved {
    /// Save them, then go on.
    Save,
    /// Go on without them.
    Discard,
    /// Keep editing.
    Stay,
}

/// Asks about unsaved changes; `None` until there is an answer. `waits` is a text about a scene that waits for the
/// answer.
pub fn unsaved_ui(ui: &Ui, name: &str, waits: Option<&str>) -> Option<Unsaved> {
    let mut answer = None;
    let modal = Modal::new(Id::unique("unsaved"))
        .frame(theme::dialog_frame(ui.style()))
        .show(ui.ctx(), |ui| {
            ui.set_width(400.0);
            ui.heading(t("Unsaved changes"));
            ui.add_space(theme::GAP);
            ui.label(tf!("“{name}” has changes that are in no file yet.", name = name));
            if let Some(waits) = waits {
                ui.label(waits);
            }
            ui.add_space(2.0 * theme::GAP);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui
                    .add(egui::Button::new(t("Save changes")).fill(theme::accent_fill()))
                    .clicked()
                {
                    answer = Some(Unsaved::Save);
                }
                if ui.button(t("Discard changes")).clicked() {
                    answer = Some(Unsaved::Discard);
                }
                if ui.button(t("Keep editing")).clicked() {
                    answer = Some(Unsaved::Stay);
                }
            });
        });
    // Keys also work: Enter is the filled button.
    if answer.is_none() && ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Enter)) {
        answer = Some(Unsaved::Save);
    }
    if answer.is_none() && modal.should_close() {
        answer = Some(Unsaved::Stay);
    }
    answer
}
