//! Small widgets made of icons: buttons, choices, sections.

use egui::accesskit::Role;
use egui::{Color32, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

pub use super::icon::Icon;
use crate::theme;

/// A square button with an icon. `name` is for the screen reader and the tooltip.
pub fn button(ui: &mut Ui, icon: Icon, name: &str, hint: &str, selected: bool, enabled: bool) -> Response {
    let size = Vec2::splat(theme::ROW + 4.0);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, selected, name));
    let hovered = enabled && response.hovered();
    let fill = if selected {
        theme::accent_fill()
    } else if response.is_pointer_button_down_on() && enabled {
        theme::field_active()
    } else if hovered {
        theme::field_hover()
    } else {
        Color32::TRANSPARENT
    };
    let color = if !enabled {
        theme::text_weak().gamma_multiply(0.45)
    } else if selected || hovered {
        theme::text_strong()
    } else {
        theme::text()
    };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    icon.paint(ui, rect.shrink(5.5), color);
    focus_ring(ui, &response, rect);
    response.on_hover_ui(|ui| tip(ui, name, hint))
}

/// Content of a tooltip: the name, and the key or an explanation in weak type.
pub fn tip(ui: &mut Ui, name: &str, hint: &str) {
    ui.horizontal(|ui| {
        ui.label(name);
        if !hint.is_empty() {
            ui.weak(hint);
        }
    });
}

/// Draws a ring around a widget that has the keyboard's focus.
pub fn focus_ring(ui: &Ui, response: &Response, rect: Rect) {
    if response.has_focus() {
        let stroke = Stroke::new(1.0, theme::accent());
        ui.painter()
            .rect_stroke(rect, theme::RADIUS, stroke, egui::StrokeKind::Inside);
    }
}

/// A small filled square with rounded corners, in the colour of a class or layer.
pub fn swatch(ui: &Ui, center: Pos2, size: f32, color: Color32) {
    let rect = Rect::from_center_size(center, Vec2::splat(size));
    ui.painter().rect_filled(rect, 3.0, color);
    // An edge makes a white square visible on white.
    let alpha = if ui.visuals().dark_mode { 0.25 } else { 0.6 };
    let edge = Stroke::new(1.0, theme::text_weak().gamma_multiply(alpha));
    ui.painter()
        .rect_stroke(rect, 3.0, edge, egui::StrokeKind::Inside);
}

/// A row of a list: a swatch, a name, and a weak text on the right. Chosen rows are filled.
pub fn row(ui: &mut Ui, color: Color32, name: &str, right: &str, selected: bool, label: &str) -> Response {
    let size = vec2(ui.available_width(), theme::ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, label));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let fill = match (selected, response.hovered()) {
        (true, _) => theme::accent_fill(),
        (false, true) => theme::field(),
        (false, false) => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    swatch(ui, pos2(rect.left() + 14.0, rect.center().y), 12.0, color);
    let text = if selected {
        theme::text_strong()
    } else {
        theme::text()
    };
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let name_at = pos2(rect.left() + 28.0, rect.center().y);
    let name_rect = ui
        .painter()
        .text(name_at, egui::Align2::LEFT_CENTER, name, body, text);
    // If both do not fit, only the name is drawn.
    let right = ui
        .painter()
        .layout_no_wrap(right.to_owned(), small, theme::text_weak());
    let right_at = pos2(
        rect.right() - 8.0 - right.size().x,
        rect.center().y - right.size().y / 2.0,
    );
    if right_at.x > name_rect.right() + 4.0 {
        ui.painter().galley(right_at, right, theme::text_weak());
    }
    focus_ring(ui, &response, rect);
    response
}

/// Choices side by side if they fit, else as a drop-down list. Returns true if another was chosen. `label` names the
/// list for screen readers.
pub fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    chosen: &mut T,
    choices: &[(T, &str, &str)],
    label: &str,
) -> bool {
    if ui.available_width() >= segments_width(ui, choices) {
        return segments(ui, chosen, choices);
    }
    let before = *chosen;
    let shown = choices.iter().find(|(value, ..)| *value == before);
    egui::ComboBox::from_id_salt(label)
        .selected_text(shown.map_or("", |(_, name, _)| name))
        .width(72.0)
        .show_ui(ui, |ui| {
            for (value, name, hint) in choices {
                ui.selectable_value(chosen, *value, *name).on_hover_text(*hint);
            }
        })
        .response
        .accessible_name(label);
    *chosen != before
}

/// Width of choices side by side, points.
pub fn segments_width<T>(ui: &Ui, choices: &[(T, &str, &str)]) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let width = |name: &str| {
        let galley = ui
            .painter()
            .layout_no_wrap(name.to_owned(), font.clone(), theme::text());
        galley.size().x + 18.0
    };
    choices.iter().map(|(_, name, _)| width(name)).sum::<f32>() + 4.0
}

/// Choices side by side, one of them chosen. Returns true if the choice changed.
pub fn segments<T: Copy + PartialEq>(ui: &mut Ui, chosen: &mut T, choices: &[(T, &str, &str)]) -> bool {
    let before = *chosen;
    let frame = egui::Frame::new()
        .fill(theme::well())
        .corner_radius(theme::RADIUS)
        .inner_margin(2);
    frame.show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().interact_size.y = theme::ROW - 4.0;
        ui.spacing_mut().button_padding = vec2(8.0, 1.0);
        ui.horizontal(|ui| {
            // From left to right, even in a bar that is laid out from the right.
            let mut choices: Vec<_> = choices.iter().collect();
            if ui.layout().prefer_right_to_left() {
                choices.reverse();
            }
            for (value, name, hint) in choices {
                let on = *chosen == *value;
                let text = egui::RichText::new(*name).color(if on {
                    theme::text_strong()
                } else {
                    theme::text_weak()
                });
                let fill = if on {
                    theme::field_active()
                } else {
                    Color32::TRANSPARENT
                };
                let button = egui::Button::new(text)
                    .fill(fill)
                    .corner_radius(3)
                    .selected(false);
                let response = ui.add(button);
                response.widget_info(|| WidgetInfo::selected(Role::Button, true, on, *name));
                if response.on_hover_ui(|ui| tip(ui, name, hint)).clicked() {
                    *chosen = *value;
                }
            }
        });
    });
    *chosen != before
}

/// Title of a section of a pane.
pub fn section(ui: &mut Ui, title: &str) {
    ui.add_space(6.0);
    ui.label(
        egui::RichText::new(title.to_uppercase())
            .small()
            .color(theme::text_weak()),
    );
    ui.add_space(2.0);
}

/// A star of five points, filled or as an outline.
pub fn star(ui: &Ui, center: Pos2, color: Color32, filled: bool) {
    let point = |i: usize| {
        let radius = if i.is_multiple_of(2) { 7.0 } else { 3.2 };
        let angle = (i as f32) * std::f32::consts::PI / 5.0 - std::f32::consts::FRAC_PI_2;
        center + radius * egui::Vec2::angled(angle)
    };
    let points: Vec<_> = (0..10).map(point).collect();
    if filled {
        for i in 0..10 {
            let triangle = vec![center, points[i], points[(i + 1) % 10]];
            let shape = egui::Shape::convex_polygon(triangle, color, egui::Stroke::NONE);
            ui.painter().add(shape);
        }
    }
    ui.painter()
        .add(egui::Shape::closed_line(points, egui::Stroke::new(1.2, color)));
}
