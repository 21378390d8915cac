//! Menus that hold fields: a click into one does not close them. No list drops down in them: egui keeps one of both open at
//! a time, so that the list would close the menu it is in.

use crate::icons::{self, Icon};
use egui::containers::menu::{MenuButton, MenuConfig, SubMenuButton, is_in_menu};
use egui::{Popup, PopupCloseBehavior, Response, Ui};

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

/// The same at a right click on something.
pub fn on_right_click(response: &Response, content: impl FnOnce(&mut Ui)) {
    Popup::context_menu(response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(content);
}
