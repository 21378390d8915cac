//! Chips: a phrase with what takes it out, in one rounded shape that no line break parts; some open a menu.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, CornerRadius, PopupCloseBehavior, Response, RichText, TextStyle, Ui};

use crate::app::theme;

const ROUND: u8 = 10;
/// Gap between the text of a chip and its end, points.
const SEAM: f32 = 1.0;

/// Begins a new line where the rest of this one is too short for a chip.
pub fn make_room(ui: &mut Ui, text: &str) {
    let font = TextStyle::Button.resolve(ui.style());
    let galley = |text: &str| {
        let galley = ui
            .painter()
            .layout_no_wrap(text.to_owned(), font.clone(), theme::text());
        galley.size().x
    };
    let width = galley(text) + galley("×") + 4.0 * ui.spacing().button_padding.x + SEAM;
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

/// A chip without a menu; a click takes it out.
pub fn plain(ui: &mut Ui, text: &str) -> Response {
    ui.add(button(&format!("{text}  ×"), true, true))
}

/// The text of a chip, with a menu; [`end`] follows.
pub fn menu(ui: &mut Ui, text: &str, add: impl FnOnce(&mut Ui)) -> Response {
    let gap = std::mem::replace(&mut ui.spacing_mut().item_spacing.x, SEAM);
    // What is in it is typed into and dragged; what chooses closes it.
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let menu = MenuButton::from_button(button(text, true, false)).config(config);
    let (response, _) = menu.ui(ui, |ui| {
        ui.spacing_mut().item_spacing.x = gap;
        add(ui);
    });
    ui.spacing_mut().item_spacing.x = gap;
    response
}

/// The end of a chip with a menu: a click takes it out.
pub fn end(ui: &mut Ui) -> Response {
    ui.add(button("×", false, true))
}
