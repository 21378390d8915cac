//! The window of settings: theme, colours, size, what happens at the start, and whether assistants may come in.

use egui::{Ui, Window};

use crate::shell::guests::{Guests, OpenDoor};
use crate::shell::settings::Settings;
use language::t;
use scene::classes::Palette;
use widgets::theme::{self, Theme};

/// Draws the window while it is open.
pub fn settings_ui(ui: &Ui, settings: &mut Settings, guests: &Guests, open: &mut bool) {
    if !*open {
        return;
    }
    Window::new(t("Settings"))
        .id(egui::Id::unique("settings"))
        .open(open)
        .resizable(false)
        .collapsible(false)
        .default_pos(ui.max_rect().center() - egui::vec2(190.0, 160.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(380.0);
            egui::Grid::new("settings")
                .num_columns(2)
                .spacing([theme::GAP * 2.0, theme::GAP])
                .show(ui, |ui| {
                    ui.label(t("Theme"));
                    ui.horizontal(|ui| {
                        ui.selectable_value(&mut settings.theme, Theme::Dark, t("Dark"));
                        ui.selectable_value(&mut settings.theme, Theme::Light, t("Light"));
                    });
                    ui.end_row();
                    ui.label(t("Class colours"));
                    ui.horizontal(|ui| {
                        ui.selectable_value(&mut settings.classes, Palette::Standard, t("Standard"));
                        ui.selectable_value(
                            &mut settings.classes,
                            Palette::ColorBlindSafe,
                            t("Colour-blind safe"),
                        );
                    });
                    ui.end_row();
                    ui.label(t("Size of everything"));
                    let mut percent = (ui.ctx().zoom_factor() * 100.0).round();
                    let slider = egui::DragValue::new(&mut percent)
                        .range(50.0..=300.0)
                        .speed(5.0)
                        .suffix(" %");
                    if ui.add(slider).on_hover_text(t("Ctrl + and Ctrl −")).changed() {
                        settings.ui_scale = percent / 100.0;
                        ui.ctx().set_zoom_factor(settings.ui_scale);
                    }
                    ui.end_row();
                    ui.label(t("Memory for undo"));
                    let field = egui::DragValue::new(&mut settings.history_mb)
                        .range(Settings::HISTORY_MB)
                        .speed(4.0)
                        .suffix(" MB");
                    ui.add(field)
                        .on_hover_text(t("Older steps go when the history takes more"))
                        .accessible_name(t("Memory for undo"));
                    ui.end_row();
                    ui.label(t("At the start"));
                    ui.checkbox(&mut settings.start_screen, t("Show the start screen"));
                    ui.end_row();
                    if guests.are_possible() {
                        ui.label(t("Assistants"));
                        ui.checkbox(&mut settings.assistants, t("May drive this editor"))
                            .on_hover_text(t(
                                "Programs on this machine that show the token work on the scene, by a fixed set of calls; each change can be undone",
                            ));
                        ui.end_row();
                    }
                });
            if let (true, Some(door)) = (settings.assistants, guests.open()) {
                door_ui(ui, door);
            }
            if let Some(problem) = guests.problem() {
                ui.colored_label(ui.visuals().error_fg_color, problem);
            }
        });
}

/// Where assistants ask, and what they must show.
fn door_ui(ui: &mut Ui, door: &OpenDoor) {
    ui.add_space(theme::GAP);
    let row = |ui: &mut Ui, name: &str, copies: &str, value: &str| {
        ui.label(name);
        ui.horizontal(|ui| {
            ui.monospace(value);
            let copy = ui.small_button(t("Copy")).on_hover_text(copies);
            if copy.clicked() {
                ui.ctx().copy_text(value.to_owned());
            }
        });
        ui.end_row();
    };
    egui::Grid::new("assistants")
        .num_columns(2)
        .spacing([theme::GAP * 2.0, theme::GAP])
        .show(ui, |ui| {
            row(ui, t("Address"), t("Copy the address"), &door.url);
            row(ui, t("Token"), t("Copy the token"), &door.token);
            ui.label(t("Files"));
            ui.monospace(door.folder.display().to_string())
                .on_hover_text(t("The one folder whose files assistants may read and write"));
            ui.end_row();
        });
}
