//! The look of the window: a dark and a light theme, the spacing scale, and the colours of panels.

use std::sync::atomic::{AtomicBool, Ordering};

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, vec2};
use serde::{Deserialize, Serialize};

use scene::Class;

/// Theme of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Theme {
    /// Light text on dark surfaces.
    #[default]
    Dark,
    /// Dark text on light surfaces.
    Light,
}

/// Colours of a theme.
struct Colors {
    background: Color32,
    panel: Color32,
    well: Color32,
    field: Color32,
    field_hover: Color32,
    field_active: Color32,
    window: Color32,
    edge: Color32,
    text: Color32,
    text_strong: Color32,
    text_weak: Color32,
    accent: Color32,
    accent_fill: Color32,
    good: Color32,
    warn: Color32,
    bad: Color32,
}

const DARK: Colors = Colors {
    background: Color32::from_rgb(20, 22, 26),
    panel: Color32::from_rgb(30, 33, 39),
    well: Color32::from_rgb(22, 24, 29),
    field: Color32::from_rgb(42, 46, 54),
    field_hover: Color32::from_rgb(53, 58, 68),
    field_active: Color32::from_rgb(62, 68, 80),
    window: Color32::from_rgb(36, 39, 46),
    edge: Color32::from_rgb(58, 63, 73),
    text: Color32::from_rgb(214, 218, 225),
    text_strong: Color32::from_rgb(242, 244, 247),
    text_weak: Color32::from_rgb(140, 148, 160),
    accent: Color32::from_rgb(86, 152, 240),
    accent_fill: Color32::from_rgb(43, 74, 117),
    good: Color32::from_rgb(104, 190, 130),
    warn: Color32::from_rgb(236, 180, 90),
    bad: Color32::from_rgb(238, 112, 104),
};

const LIGHT: Colors = Colors {
    background: Color32::from_rgb(206, 210, 216),
    panel: Color32::from_rgb(240, 242, 245),
    well: Color32::from_rgb(252, 253, 254),
    field: Color32::from_rgb(222, 226, 232),
    field_hover: Color32::from_rgb(210, 215, 223),
    field_active: Color32::from_rgb(194, 201, 212),
    window: Color32::from_rgb(247, 248, 250),
    edge: Color32::from_rgb(190, 196, 206),
    text: Color32::from_rgb(38, 42, 50),
    text_strong: Color32::from_rgb(12, 15, 20),
    text_weak: Color32::from_rgb(76, 83, 95),
    accent: Color32::from_rgb(24, 98, 205),
    accent_fill: Color32::from_rgb(176, 207, 248),
    good: Color32::from_rgb(18, 96, 48),
    warn: Color32::from_rgb(118, 68, 0),
    bad: Color32::from_rgb(168, 30, 26),
};

/// The theme of this process's window. It is global, because its colours are used everywhere.
static LIGHT_THEME: AtomicBool = AtomicBool::new(false);

fn colors() -> &'static Colors {
    if LIGHT_THEME.load(Ordering::Relaxed) {
        &LIGHT
    } else {
        &DARK
    }
}

/// True if surfaces are light.
pub fn is_light() -> bool {
    LIGHT_THEME.load(Ordering::Relaxed)
}

/// Colour behind everything, in the gaps between panels.
pub fn background() -> Color32 {
    colors().background
}

/// Colour of panels and bars.
pub fn panel() -> Color32 {
    colors().panel
}

/// Colour of empty picture frames and text fields.
pub fn well() -> Color32 {
    colors().well
}

/// Colour of a row or field on a panel.
pub fn field() -> Color32 {
    colors().field
}

/// Colour of a row or field under the pointer.
pub fn field_hover() -> Color32 {
    colors().field_hover
}

/// Colour of a row or field while pressed.
pub fn field_active() -> Color32 {
    colors().field_active
}

/// Colour of normal text.
pub fn text() -> Color32 {
    colors().text
}

/// Colour of titles and of the selection.
pub fn text_strong() -> Color32 {
    colors().text_strong
}

/// Colour of units, hints and captions.
pub fn text_weak() -> Color32 {
    colors().text_weak
}

/// Accent colour, for the selection and for running work.
pub fn accent() -> Color32 {
    colors().accent
}

/// Fill colour of the selection.
pub fn accent_fill() -> Color32 {
    colors().accent_fill
}

/// Colour of success.
pub fn good() -> Color32 {
    colors().good
}

/// Colour of warnings.
pub fn warn() -> Color32 {
    colors().warn
}

/// Colour of failures.
pub fn bad() -> Color32 {
    colors().bad
}

/// Colour around the grid of the bird's-eye view. Views are dark in both themes, because their colours are made for
/// dark.
pub const CANVAS: Color32 = Color32::from_rgb(20, 22, 26);
/// Colour of text on views and pictures.
pub const ON_CANVAS: Color32 = Color32::from_rgb(236, 239, 243);

/// One step of the spacing scale, points.
pub const GAP: f32 = 8.0;
/// Height of a row, a button, a field, points.
pub const ROW: f32 = 24.0;
/// Corner radius of fields and buttons, points.
pub const RADIUS: u8 = 4;

/// Applies the theme to a context.
pub fn apply(ctx: &egui::Context, theme: Theme) {
    LIGHT_THEME.store(theme == Theme::Light, Ordering::Relaxed);
    let theme = match theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    };
    ctx.set_theme(theme);
    ctx.style_mut_of(theme, style);
    ctx.options_mut(|o| o.fallback_theme = theme);
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
    *v = if is_light() {
        egui::Visuals::light()
    } else {
        egui::Visuals::dark()
    };
    v.panel_fill = panel();
    v.window_fill = colors().window;
    v.window_stroke = Stroke::new(1.0, colors().edge);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    v.extreme_bg_color = well();
    v.text_edit_bg_color = Some(well());
    v.faint_bg_color = field().gamma_multiply(0.5);
    v.code_bg_color = well();
    v.weak_text_color = Some(text_weak());
    v.hyperlink_color = accent();
    v.warn_fg_color = warn();
    v.error_fg_color = bad();
    v.selection.bg_fill = accent_fill();
    v.selection.stroke = Stroke::new(1.0, text_strong());
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
    widget(&mut w.noninteractive, panel(), text());
    w.noninteractive.bg_stroke = Stroke::new(1.0, colors().edge);
    widget(&mut w.inactive, field(), text());
    // Without this, checkboxes, radio rings and rails would be invisible on a dialog.
    w.inactive.bg_fill = field_active();
    widget(&mut w.hovered, field_hover(), text_strong());
    widget(&mut w.active, field_active(), text_strong());
    widget(&mut w.open, field_hover(), text_strong());
}

/// Frame of a dialog.
pub fn dialog_frame(style: &egui::Style) -> egui::Frame {
    egui::Frame::window(style).inner_margin(Margin::same(18))
}

/// Colour of an sRGB triple.
pub fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Colour of an sRGB triple with an opacity of 0 to 1.
pub fn rgba([r, g, b]: [u8; 3], opacity: f32) -> Color32 {
    Color32::from_rgba_unmultiplied(r, g, b, (opacity.clamp(0.0, 1.0) * 255.0) as u8)
}

/// Colour of a class on a panel. Free space, which is black as a voxel, is a dim grey.
pub fn class_color(class: Class) -> Color32 {
    match class {
        Class::Free => Color32::from_rgb(70, 76, 86),
        class => rgb(class.color()),
    }
}

/// Frame of a side panel. It is not filled: the window is cleared with [`panel`], and pixels drawn twice are slow on a
/// software rasteriser.
pub fn panel_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(12, 10))
}

/// Frame of a bar, not filled either.
pub fn bar_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(10, 4))
}

/// The text with its first letter in upper case: `driveable surface` becomes `Driveable surface`.
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
        for c in [DARK, LIGHT] {
            for text in [c.text, c.text_strong, c.text_weak, c.good, c.warn, c.bad] {
                for surface in [c.panel, c.well, c.background, c.window] {
                    let (a, b) = (luminance(text) + 0.05, luminance(surface) + 0.05);
                    let ratio = a.max(b) / a.min(b);
                    assert!(ratio >= 4.5, "{text:?} on {surface:?} is {ratio}");
                }
            }
            let (a, b) = (luminance(c.text_strong) + 0.05, luminance(c.accent_fill) + 0.05);
            assert!(a.max(b) / a.min(b) >= 4.5);
        }
    }
}
