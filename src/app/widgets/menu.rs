//! Menus that hold fields: a click into a field does not close them. They hold no drop-down lists: egui keeps only one
//! popup open at a time, so a list would close its menu.

use crate::icons::{self, Icon};
use egui::containers::menu::{MenuButton, MenuConfig, SubMenuButton, is_in_menu};
use egui::{Align, Layout, Popup, PopupCloseBehavior, Response, Ui, vec2};

/// A button, or an entry of a menu, with a menu that stays open until a click outside, Escape, or `ui.close()` in it.
pub fn with_fields(ui: &mut Ui, title: impl Into<String>, content: impl FnOnce(&mut Ui)) -> Response {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    match is_in_menu(ui) {
        true => SubMenuButton::new(title.into()).config(config).ui(ui, content).0,
        false => MenuButton::new(title.into()).config(config).ui(ui, content).0,
    }
}

/// A button with an icon and such a menu.
pub fn of_icon(ui: &mut Ui, icon: Icon, name: &str, hint: &str, content: impl FnOnce(&mut Ui)) -> Response {
    let button = icons::button(ui, icon, name, hint, false, true);
    Popup::menu(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(content);
    button
}

/// Width of the gap with the line between two columns of a menu, points.
const LINE: f32 = 9.0;

/// Two columns of a menu with a line between them, as high as the higher column. A separator would have the height of
/// the menu in the frame before, and the contents below would be added to it: the menu would grow with each frame until
/// it has no room and jumps up.
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

/// Such a menu at a right click on a widget.
pub fn on_right_click(response: &Response, content: impl FnOnce(&mut Ui)) {
    Popup::context_menu(response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(content);
}
