//! The text of the 3D pane where no adapter can draw its picture.

use egui::accesskit::Role;
use egui::{Align2, Rect, Sense, Ui, WidgetInfo};

use language::t;
use widgets::theme;

/// Shows the text in place of a picture.
pub(crate) fn show(ui: &Ui, rect: Rect) {
    let hint_text =
        "Install a Vulkan driver (a software one such as lavapipe will do); editing works without.";
    hint(ui, rect, t("No GPU adapter"), t(hint_text));
    ui.interact(rect, ui.scope_id().with("no adapter"), Sense::hover())
        .widget_info(|| WidgetInfo::labeled(Role::Label, true, t("No GPU adapter")));
}

/// A title and a line in the middle of an empty pane.
pub(crate) fn hint(ui: &Ui, rect: Rect, title: &str, text: &str) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, theme::well());
    let heading = egui::TextStyle::Heading.resolve(ui.style());
    let body = egui::TextStyle::Body.resolve(ui.style());
    painter.text(
        rect.center(),
        Align2::CENTER_BOTTOM,
        title,
        heading,
        theme::text(),
    );
    let galley = painter.layout(
        text.into(),
        body,
        theme::text_weak(),
        (rect.width() - 40.0).max(60.0),
    );
    let at = rect.center() + egui::vec2(-galley.size().x / 2.0, 8.0);
    painter.galley(at, galley, theme::text_weak());
}
