//! Explanations in small letters.

use egui::Ui;

use crate::theme;

/// A hint in small letters.
pub fn caption(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
}
