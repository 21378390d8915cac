//! Menus that hold fields: a click into one does not close them. No list drops down in them: egui keeps one of both open at
//! a time, so that the list would close the menu it is in.

use crate::icons::{self, Icon};
use egui::containers::menu::{MenuButton, MenuConfig, SubMenuButton, is_in_menu};
use egui::{Align, Layout, Popup, PopupCloseBehavior, Response, Ui, vec2};

/// A button, or an entry of a menu, whose menu stays open until a click outside, Escape, or `ui.close()` in it.
pub fn with_fields(ui: &mut Ui, title: impl Into<String>, content: impl FnOnce(&mut Ui)) -> Response {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    match is_in_menu(ui) {
        true => SubMenuButton::new(title.into()).config(config).ui(ui, content).0,
        false => MenuButton::new(title.into()).config(config).ui(ui, content).0,
    }
}

/// The same at a button that shows an icon.
pub fn of_icon(ui: &mut Ui, icon: Icon, name: &str, hint: &str, content: impl FnOnce(&mut Ui)) -> Response {
    let button = icons::button(ui, icon, name, hint, false, true);
    Popup::menu(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(content);
    button
}

/// Room for the line between two columns of a menu, points.
const LINE: f32 = 9.0;

/// Two columns of a menu with a line between them, as high as the higher one. A separator would be as high as the menu was in
/// the frame before, and what is below it would be added to that: the menu would grow with each frame until it has no room and
/// jumps up.
pub fn side_by_side(ui: &mut Ui, left: impl FnOnce(&mut Ui), right: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), 0.0);
    let layout = Layout::left_to_right(Align::Min);
    let row = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.vertical(left);
        let line = ui.cursor().left() + LINE / 2.0;
        ui.add_space(LINE);
        ui.vertical(right);
        line
    });
    let stroke = ui.visuals().widgets.noninteractive.bg_stroke;
    ui.painter().vline(row.inner, row.response.rect.y_range(), stroke);
}

/// The same at a right click on something.
pub fn on_right_click(response: &Response, content: impl FnOnce(&mut Ui)) {
    Popup::context_menu(response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(content);
}
