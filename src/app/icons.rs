//! Icons drawn as lines, and the small widgets made of them. Each is drawn in a square of 16 points.

use egui::accesskit::Role;
use egui::{Color32, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::theme;

/// A picture on a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Arrow of the select tool.
    Cursor,
    /// Brush.
    Brush,
    /// Box with a plus.
    AddBox,
    /// Cube.
    Voxel,
    /// Arrow turning back.
    Undo,
    /// Arrow turning forward.
    Redo,
    /// Triangle: run.
    Play,
    /// Square: stop.
    Stop,
    /// Flash: live.
    Live,
    /// Open eye.
    Eye,
    /// Eye struck through.
    EyeOff,
    /// Bin.
    Trash,
    /// Two sheets.
    Copy,
    /// Frame with corners.
    Focus,
    /// Cross.
    Close,
    /// Camera.
    Camera,
    /// Ruler.
    Measure,
    /// Closed lock.
    Lock,
    /// Dashed square with a spark.
    Region,
    /// House.
    Building,
    /// Tree.
    Tree,
    /// Fence.
    Fence,
    /// Low bushes.
    Shrubs,
    /// Lamp with an arm.
    Lamp,
    /// Circle with its middle.
    Circle,
}

impl Icon {
    /// The icon that a tool names; an arrow for a name that is none.
    pub fn named(name: &str) -> Self {
        match name {
            "brush" => Self::Brush,
            "circle" => Self::Circle,
            "add_box" => Self::AddBox,
            "voxel" => Self::Voxel,
            "measure" => Self::Measure,
            "region" => Self::Region,
            "building" => Self::Building,
            "tree" => Self::Tree,
            "fence" => Self::Fence,
            "shrubs" => Self::Shrubs,
            "lamp" => Self::Lamp,
            _ => Self::Cursor,
        }
    }

    /// Draws the icon into the middle of `rect`.
    pub fn paint(self, ui: &Ui, rect: Rect, color: Color32) {
        let scale = (rect.width().min(rect.height()) / 16.0).min(1.25);
        let origin = rect.center() - Vec2::splat(8.0 * scale);
        let at = |x: f32, y: f32| origin + vec2(x, y) * scale;
        let stroke = Stroke::new(1.4, color);
        let painter = ui.painter();
        let line = |points: &[(f32, f32)]| {
            let points = points.iter().map(|p| at(p.0, p.1)).collect();
            painter.add(Shape::line(points, stroke));
        };
        let closed = |points: &[(f32, f32)]| {
            let points = points.iter().map(|p| at(p.0, p.1)).collect();
            painter.add(Shape::closed_line(points, stroke));
        };
        let solid = |points: &[(f32, f32)]| {
            let points = points.iter().map(|p| at(p.0, p.1)).collect();
            painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
        };
        let arc = |center: (f32, f32), radius: f32, from: f32, to: f32| {
            let steps = 14;
            let points = (0..=steps).map(|i| {
                let a = (from + (to - from) * i as f32 / steps as f32).to_radians();
                at(center.0 + radius * a.cos(), center.1 + radius * a.sin())
            });
            painter.add(Shape::line(points.collect(), stroke));
        };
        match self {
            Icon::Cursor => closed(&[(4.0, 2.0), (4.0, 13.0), (7.0, 10.3), (11.5, 10.3)]),
            Icon::Brush => {
                line(&[(13.5, 2.5), (7.5, 8.5)]);
                closed(&[
                    (7.6, 8.4),
                    (5.0, 9.2),
                    (3.8, 11.2),
                    (2.5, 13.5),
                    (5.4, 12.9),
                    (7.4, 11.6),
                    (8.6, 9.5),
                ]);
            }
            Icon::AddBox => {
                closed(&[(2.5, 5.0), (10.5, 5.0), (10.5, 13.0), (2.5, 13.0)]);
                line(&[(6.5, 7.0), (6.5, 11.0)]);
                line(&[(4.5, 9.0), (8.5, 9.0)]);
                line(&[(6.0, 2.5), (13.0, 2.5), (13.0, 9.5)]);
            }
            Icon::Voxel => {
                closed(&[
                    (8.0, 1.8),
                    (13.5, 4.8),
                    (13.5, 11.2),
                    (8.0, 14.2),
                    (2.5, 11.2),
                    (2.5, 4.8),
                ]);
                line(&[(2.5, 4.8), (8.0, 7.9), (13.5, 4.8)]);
                line(&[(8.0, 7.9), (8.0, 14.2)]);
            }
            Icon::Undo => {
                line(&[(6.2, 2.6), (3.0, 5.8), (6.2, 9.0)]);
                line(&[(3.0, 5.8), (9.5, 5.8)]);
                arc((9.5, 9.5), 3.7, -90.0, 90.0);
                line(&[(9.5, 13.2), (6.0, 13.2)]);
            }
            Icon::Redo => {
                line(&[(9.8, 2.6), (13.0, 5.8), (9.8, 9.0)]);
                line(&[(13.0, 5.8), (6.5, 5.8)]);
                arc((6.5, 9.5), 3.7, 90.0, 270.0);
                line(&[(6.5, 13.2), (10.0, 13.2)]);
            }
            Icon::Circle => {
                arc((8.0, 8.0), 6.0, 0.0, 360.0);
                arc((8.0, 8.0), 0.9, 0.0, 360.0);
            }
            Icon::Play => solid(&[(4.5, 2.5), (13.5, 8.0), (4.5, 13.5)]),
            Icon::Stop => solid(&[(3.5, 3.5), (12.5, 3.5), (12.5, 12.5), (3.5, 12.5)]),
            Icon::Live => closed(&[
                (9.2, 1.8),
                (3.6, 9.0),
                (7.4, 9.0),
                (6.6, 14.2),
                (12.4, 6.8),
                (8.4, 6.8),
            ]),
            Icon::Eye | Icon::EyeOff => {
                let lid = |sign: f32| {
                    let points = (0..=10).map(|i| {
                        let t = i as f32 / 10.0;
                        at(
                            1.8 + 12.4 * t,
                            8.0 + sign * 4.6 * (std::f32::consts::PI * t).sin(),
                        )
                    });
                    painter.add(Shape::line(points.collect(), stroke));
                };
                lid(1.0);
                lid(-1.0);
                if self == Icon::Eye {
                    painter.circle_filled(at(8.0, 8.0), 2.2 * scale, color);
                } else {
                    line(&[(3.0, 13.2), (13.0, 2.8)]);
                }
            }
            Icon::Trash => {
                line(&[(2.8, 4.4), (13.2, 4.4)]);
                line(&[(6.0, 4.2), (6.4, 2.4), (9.6, 2.4), (10.0, 4.2)]);
                line(&[(4.0, 4.6), (4.8, 13.6), (11.2, 13.6), (12.0, 4.6)]);
                line(&[(6.8, 7.0), (6.9, 11.2)]);
                line(&[(9.2, 7.0), (9.1, 11.2)]);
            }
            Icon::Copy => {
                closed(&[(2.5, 5.5), (9.5, 5.5), (9.5, 13.5), (2.5, 13.5)]);
                line(&[(6.0, 3.6), (6.0, 2.5), (13.5, 2.5), (13.5, 10.5), (11.4, 10.5)]);
            }
            Icon::Focus => {
                for (sx, sy) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                    let p = |x: f32, y: f32| (8.0 + sx * x, 8.0 + sy * y);
                    line(&[p(2.6, 5.6), p(5.6, 5.6), p(5.6, 2.6)]);
                }
                painter.circle_filled(at(8.0, 8.0), 1.6 * scale, color);
            }
            Icon::Close => {
                line(&[(4.0, 4.0), (12.0, 12.0)]);
                line(&[(12.0, 4.0), (4.0, 12.0)]);
            }
            Icon::Camera => {
                closed(&[
                    (2.0, 5.0),
                    (5.0, 5.0),
                    (6.2, 3.2),
                    (9.8, 3.2),
                    (11.0, 5.0),
                    (14.0, 5.0),
                    (14.0, 12.8),
                    (2.0, 12.8),
                ]);
                painter.circle_stroke(at(8.0, 8.8), 2.4 * scale, stroke);
            }
            Icon::Measure => {
                closed(&[(1.8, 10.6), (10.6, 1.8), (14.2, 5.4), (5.4, 14.2)]);
                line(&[(4.4, 8.0), (6.0, 9.6)]);
                line(&[(6.6, 5.8), (8.2, 7.4)]);
                line(&[(8.8, 3.6), (10.4, 5.2)]);
            }
            Icon::Region => {
                for (a, b) in [
                    ((2.0, 5.0), (2.0, 2.0)),
                    ((11.0, 2.0), (14.0, 2.0)),
                    ((14.0, 11.0), (14.0, 14.0)),
                ] {
                    line(&[a, b]);
                }
                line(&[(2.0, 2.0), (5.0, 2.0)]);
                line(&[(14.0, 2.0), (14.0, 5.0)]);
                line(&[(14.0, 14.0), (11.0, 14.0)]);
                line(&[(5.0, 14.0), (2.0, 14.0), (2.0, 11.0)]);
                line(&[(8.0, 4.8), (8.0, 11.2)]);
                line(&[(4.8, 8.0), (11.2, 8.0)]);
            }
            Icon::Building => {
                closed(&[(2.5, 6.6), (8.0, 2.2), (13.5, 6.6), (13.5, 13.8), (2.5, 13.8)]);
                line(&[(6.6, 13.8), (6.6, 9.6), (9.4, 9.6), (9.4, 13.8)]);
            }
            Icon::Tree => {
                painter.circle_stroke(at(8.0, 6.0), 4.2 * scale, stroke);
                line(&[(8.0, 14.2), (8.0, 7.4)]);
                line(&[(8.0, 9.6), (9.9, 7.6)]);
            }
            Icon::Fence => {
                for x in [3.0, 8.0, 13.0] {
                    line(&[(x, 14.0), (x, 3.6)]);
                }
                line(&[(1.4, 6.4), (14.6, 6.4)]);
                line(&[(1.4, 10.6), (14.6, 10.6)]);
            }
            Icon::Shrubs => {
                arc((4.8, 12.6), 3.2, 180.0, 360.0);
                arc((11.2, 12.6), 3.2, 180.0, 360.0);
                arc((8.0, 9.2), 3.4, 190.0, 350.0);
                line(&[(1.6, 12.6), (14.4, 12.6)]);
            }
            Icon::Lamp => {
                line(&[(5.0, 14.2), (5.0, 2.6), (12.2, 2.6)]);
                line(&[(10.2, 2.6), (10.2, 5.0), (13.6, 5.0), (13.6, 2.6)]);
                line(&[(3.2, 14.2), (6.8, 14.2)]);
            }
            Icon::Lock => {
                closed(&[(3.5, 7.2), (12.5, 7.2), (12.5, 13.6), (3.5, 13.6)]);
                arc((8.0, 6.8), 3.1, 180.0, 360.0);
            }
        }
    }
}

/// A square button with an icon. `name` is what a screen reader and the tooltip say.
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

/// What a tooltip says: the name, and the key or an explanation in weak type.
pub fn tip(ui: &mut Ui, name: &str, hint: &str) {
    ui.horizontal(|ui| {
        ui.label(name);
        if !hint.is_empty() {
            ui.weak(hint);
        }
    });
}

/// The ring around what has the keyboard's focus.
pub fn focus_ring(ui: &Ui, response: &Response, rect: Rect) {
    if response.has_focus() {
        let stroke = Stroke::new(1.0, theme::accent());
        ui.painter()
            .rect_stroke(rect, theme::RADIUS, stroke, egui::StrokeKind::Inside);
    }
}

/// A small filled square with rounded corners: the colour of a class or layer.
pub fn swatch(ui: &Ui, center: Pos2, size: f32, color: Color32) {
    let rect = Rect::from_center_size(center, Vec2::splat(size));
    ui.painter().rect_filled(rect, 3.0, color);
    // White on white is seen by its edge.
    let alpha = if ui.visuals().dark_mode { 0.25 } else { 0.6 };
    let edge = Stroke::new(1.0, theme::text_weak().gamma_multiply(alpha));
    ui.painter()
        .rect_stroke(rect, 3.0, edge, egui::StrokeKind::Inside);
}

/// A row of a list: a swatch, a name, something weak on the right. Chosen rows are filled.
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
    // Where both do not fit, the name stays.
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

/// Choices side by side where there is room for them, else as a list that opens; true if another was chosen. `label`
/// names the list for screen readers.
pub fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    chosen: &mut T,
    choices: &[(T, &str, &str)],
    label: &str,
) -> bool {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let width = |name: &str| {
        let galley = ui
            .painter()
            .layout_no_wrap(name.to_owned(), font.clone(), theme::text());
        galley.size().x + 18.0
    };
    let wanted: f32 = choices.iter().map(|(_, name, _)| width(name)).sum::<f32>() + 4.0;
    if ui.available_width() >= wanted {
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

/// Choices side by side, one of them chosen; true if it changed.
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
            // From left to right also where the bar is laid out from the right.
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

/// Title of a section of a panel.
pub fn section(ui: &mut Ui, title: &str) {
    ui.add_space(6.0);
    ui.label(
        egui::RichText::new(title.to_uppercase())
            .small()
            .color(theme::text_weak()),
    );
    ui.add_space(2.0);
}
