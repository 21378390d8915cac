//! Chips: a phrase with a button that removes it, in one rounded shape without line breaks. Some open a menu.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, CornerRadius, PopupCloseBehavior, Response, RichText, TextStyle, Ui};

use crate::theme;

const ROUND: u8 = 10;
/// Gap between the text of a chip and its removing end, points.
const SEAM: f32 = 1.0;

/// Width of a chip with its end, points.
fn width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Button.resolve(ui.style());
    let galley = |text: &str| {
        let galley = ui
            .painter()
            .layout_no_wrap(text.to_owned(), font.clone(), theme::text());
        galley.size().x
    };
    galley(text) + galley("  ×") + 4.0 * ui.spacing().button_padding.x + SEAM
}

/// The text cut to the width of a line; hovering shows the full text.
fn shortened(ui: &Ui, text: &str) -> String {
    let most = ui.max_rect().width();
    if width(ui, text) <= most {
        return text.to_owned();
    }
    let cut = |n: usize| text.chars().take(n).collect::<String>().trim_end().to_owned() + "…";
    let fits = |n: &usize| width(ui, &cut(*n)) <= most;
    (1..text.chars().count())
        .rev()
        .find(fits)
        .map_or_else(|| cut(1), cut)
}

/// Begins a new line if the rest of this one is too short for a chip.
pub fn make_room(ui: &mut Ui, text: &str) {
    let width = width(ui, &shortened(ui, text));
    let begun = ui.cursor().left() > ui.max_rect().left() + 1.0;
    if begun && ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}

fn button(text: &str, left: bool, right: bool) -> Button<'static> {
    let corner = |round: bool| if round { ROUND } else { 2 };
    let text = RichText::new(text).color(theme::text_strong());
    Button::new(text)
        .fill(theme::field_active())
        .corner_radius(CornerRadius {
            nw: corner(left),
            sw: corner(left),
            ne: corner(right),
            se: corner(right),
        })
}

/// A chip without a menu; a click removes it.
pub fn plain(ui: &mut Ui, text: &str) -> Response {
    let shown = shortened(ui, text);
    let response = ui.add(button(&format!("{shown}  ×"), true, true));
    if shown == text {
        response
    } else {
        response.on_hover_text(text)
    }
}

/// The text of a chip, with a menu; [`end`] follows.
pub fn menu(ui: &mut Ui, text: &str, add: impl FnOnce(&mut Ui)) -> Response {
    let gap = std::mem::replace(&mut ui.spacing_mut().item_spacing.x, SEAM);
    // Fields in the menu are typed into and dragged, so a click inside does not close it.
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let shown = shortened(ui, text);
    let menu = MenuButton::from_button(button(&shown, true, false)).config(config);
    let (response, _) = menu.ui(ui, |ui| {
        ui.spacing_mut().item_spacing.x = gap;
        add(ui);
    });
    ui.spacing_mut().item_spacing.x = gap;
    if shown == text {
        response
    } else {
        response.on_hover_text(text)
    }
}

/// The end of a chip with a menu; a click removes the chip.
pub fn end(ui: &mut Ui) -> Response {
    ui.add(button("×", false, true))
}
