//! The dialog about a scene from a session that died.

use egui::{Id, Modal, Ui};

use crate::shell::recovery::{Stale, ago};
use language::{t, tf};
use widgets::theme;

/// Answer of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecoveryChoice {
    /// Open it.
    Recover,
    /// Remove it for good.
    Discard,
    /// Ask again at the next start.
    Later,
}

/// Asks about one scene; `None` until there is an answer. `more` is the number of further offers.
pub fn recovery_ui(ui: &Ui, offer: &Stale, more: usize) -> Option<RecoveryChoice> {
    let mut answer = None;
    let modal = Modal::new(Id::unique("recovery"))
        .frame(theme::dialog_frame(ui.style()))
        .show(ui.ctx(), |ui| {
            ui.set_width(440.0);
            ui.heading(tf!("Recover “{name}”?", name = offer.name));
            ui.add_space(theme::GAP);
            let when = offer.saved.elapsed().map_or_else(|_| t("just now").into(), ago);
            ui.label(tf!(
                "Sceneloom ended unexpectedly. Unsaved work from {when} was kept.",
                when = when
            ));
            if let Some(original) = &offer.original {
                ui.weak(tf!(
                    "It belongs to {file}, which is as it was last saved.",
                    file = original.display()
                ));
            }
            if more > 0 {
                ui.weak(tf!("{n} more to ask about after this.", n = more));
            }
            ui.add_space(2.0 * theme::GAP);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui
                    .add(egui::Button::new(t("Recover")).fill(ui.visuals().selection.bg_fill))
                    .clicked()
                {
                    answer = Some(RecoveryChoice::Recover);
                }
                if ui.button(t("Later")).clicked() {
                    answer = Some(RecoveryChoice::Later);
                }
                if ui.button(t("Discard")).clicked() {
                    answer = Some(RecoveryChoice::Discard);
                }
            });
        });
    if answer.is_none() && modal.should_close() {
        answer = Some(RecoveryChoice::Later);
    }
    answer
}
