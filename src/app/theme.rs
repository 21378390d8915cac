//! The look of the window: one dark theme, one spacing scale, the colours that panels share.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, vec2};

use crate::scene::Class;

/// Behind everything: gaps between panels.
pub const BACKGROUND: Color32 = Color32::from_rgb(20, 22, 26);
/// Surface of panels and bars.
pub const PANEL: Color32 = Color32::from_rgb(30, 33, 39);
/// Surface of the canvas and of empty picture frames.
pub const WELL: Color32 = Color32::from_rgb(22, 24, 29);
/// A row or field on a panel.
pub const FIELD: Color32 = Color32::from_rgb(42, 46, 54);
/// The same under the pointer.
pub const FIELD_HOVER: Color32 = Color32::from_rgb(53, 58, 68);
/// The same while pressed.
pub const FIELD_ACTIVE: Color32 = Color32::from_rgb(62, 68, 80);
/// Text that matters.
pub const TEXT: Color32 = Color32::from_rgb(214, 218, 225);
/// Titles and chosen things.
pub const TEXT_STRONG: Color32 = Color32::from_rgb(242, 244, 247);
/// Units, hints, captions.
pub const TEXT_WEAK: Color32 = Color32::from_rgb(140, 148, 160);
/// What is chosen or runs.
pub const ACCENT: Color32 = Color32::from_rgb(86, 152, 240);
/// Surface of what is chosen.
pub const ACCENT_FILL: Color32 = Color32::from_rgb(43, 74, 117);
/// All is well.
pub const GOOD: Color32 = Color32::from_rgb(104, 190, 130);
/// Look at this.
pub const WARN: Color32 = Color32::from_rgb(236, 180, 90);
/// This failed.
pub const BAD: Color32 = Color32::from_rgb(238, 112, 104);

/// One step of the spacing scale, points.
pub const GAP: f32 = 8.0;
/// Height of a row, a button, a field, points.
pub const ROW: f32 = 24.0;
/// Corners of fields and buttons, points.
pub const RADIUS: u8 = 4;

/// Puts the theme on a context.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.style_mut_of(egui::Theme::Dark, style);
    ctx.options_mut(|o| o.fallback_theme = egui::Theme::Dark);
}

fn style(style: &mut egui::Style) {
    let font = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(11.0)),
        (TextStyle::Body, font(13.0)),
        (TextStyle::Button, font(13.0)),
        (TextStyle::Heading, font(15.0)),
        (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
    ]
    .into();
    style.animation_time = 0.09;
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.45;
    let space = &mut style.spacing;
    space.item_spacing = vec2(GAP, 4.0);
    space.button_padding = vec2(8.0, 3.0);
    space.interact_size = vec2(28.0, ROW);
    space.window_margin = Margin::same(14);
    space.menu_margin = Margin::same(6);
    space.menu_width = 220.0;
    space.combo_width = 96.0;
    space.slider_width = 96.0;
    space.slider_rail_height = 4.0;
    space.icon_width = 15.0;
    space.icon_width_inner = 9.0;
    space.tooltip_width = 320.0;
    visuals(&mut style.visuals);
}

fn visuals(v: &mut egui::Visuals) {
    *v = egui::Visuals::dark();
    v.panel_fill = PANEL;
    v.window_fill = Color32::from_rgb(36, 39, 46);
    v.window_stroke = Stroke::new(1.0, Color32::from_rgb(58, 63, 73));
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    v.extreme_bg_color = WELL;
    v.text_edit_bg_color = Some(WELL);
    v.faint_bg_color = Color32::from_rgb(35, 38, 45);
    v.code_bg_color = WELL;
    v.weak_text_color = Some(TEXT_WEAK);
    v.hyperlink_color = ACCENT;
    v.warn_fg_color = WARN;
    v.error_fg_color = BAD;
    v.selection.bg_fill = ACCENT_FILL;
    v.selection.stroke = Stroke::new(1.0, TEXT_STRONG);
    v.slider_trailing_fill = true;
    v.striped = false;
    v.indent_has_left_vline = false;
    let radius = CornerRadius::same(RADIUS);
    let widget = |w: &mut egui::style::WidgetVisuals, fill: Color32, text: Color32| {
        w.bg_fill = fill;
        w.weak_bg_fill = fill;
        w.bg_stroke = Stroke::NONE;
        w.fg_stroke = Stroke::new(1.0, text);
        w.corner_radius = radius;
        w.expansion = 0.0;
    };
    let w = &mut v.widgets;
    widget(&mut w.noninteractive, PANEL, TEXT);
    w.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(48, 52, 61));
    widget(&mut w.inactive, FIELD, TEXT);
    widget(&mut w.hovered, FIELD_HOVER, TEXT_STRONG);
    widget(&mut w.active, FIELD_ACTIVE, TEXT_STRONG);
    widget(&mut w.open, FIELD_HOVER, TEXT_STRONG);
}

/// Frame of a dialog.
pub fn dialog_frame(style: &egui::Style) -> egui::Frame {
    egui::Frame::window(style).inner_margin(Margin::same(18))
}

/// Colour of an sRGB triple.
pub fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// The same, with an opacity of 0 to 1.
pub fn rgba([r, g, b]: [u8; 3], opacity: f32) -> Color32 {
    Color32::from_rgba_unmultiplied(r, g, b, (opacity.clamp(0.0, 1.0) * 255.0) as u8)
}

/// Colour of a class on a panel; free space, black as a voxel, shows as a dim grey.
pub fn class_color(class: Class) -> Color32 {
    match class {
        Class::Free => Color32::from_rgb(70, 76, 86),
        class => rgb(class.color()),
    }
}

/// Frame of a side panel. Not filled: the window is cleared with [`PANEL`], and pixels drawn twice
/// cost on a software rasteriser.
pub fn panel_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(12, 10))
}

/// Frame of a bar; not filled either.
pub fn bar_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(10, 4))
}

/// First letter large: `driveable surface` becomes `Driveable surface`.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_start_large() {
        assert_eq!(sentence("driveable surface"), "Driveable surface");
        assert_eq!(sentence(""), "");
    }

    /// Text on its surface has a contrast of at least 4.5 to 1 (WCAG 2.1 AA).
    #[test]
    fn text_is_legible() {
        let luminance = |c: Color32| {
            let linear = |v: u8| {
                let v = f64::from(v) / 255.0;
                if v <= 0.04045 {
                    v / 12.92
                } else {
                    ((v + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * linear(c.r()) + 0.7152 * linear(c.g()) + 0.0722 * linear(c.b())
        };
        for text in [TEXT, TEXT_STRONG, TEXT_WEAK, GOOD, WARN, BAD] {
            for surface in [PANEL, WELL, BACKGROUND] {
                let ratio = (luminance(text) + 0.05) / (luminance(surface) + 0.05);
                assert!(ratio >= 4.5, "{text:?} on {surface:?} is {ratio}");
            }
        }
    }
}
