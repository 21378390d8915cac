//! The start screen: recent files, ready-made roads, import.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Id, Modal, Ui, WidgetInfo, vec2};

use crate::app::command::Command;
use crate::app::settings::Settings;
use crate::app::theme;
use crate::generation::world::template::TEMPLATES;

/// Draws the start screen while it is open.
pub fn start_ui(ui: &Ui, settings: &mut Settings, open: &mut bool, commands: &mut Vec<Command>) {
    if !*open {
        return;
    }
    let mut choose = |open: &mut bool, command: Command| {
        *open = false;
        commands.push(command);
    };
    let modal = Modal::new(Id::unique("start")).frame(theme::dialog_frame(ui.style()));
    let shown = modal.show(ui.ctx(), |ui| {
        ui.set_width(640.0);
        ui.label(egui::RichText::new("Sceneloom").size(24.0).color(theme::text_strong()));
        let text = "Paint a street, place what stands on it, and see what the sensors would see.";
        ui.label(egui::RichText::new(text).color(theme::text_weak()));
        ui.add_space(2.0 * theme::GAP);
        ui.columns_const(|[left, right]: &mut [Ui; 2]| {
            crate::app::icons::section(left, "Begin");
            if wide(left, "Go on with this scene", "Esc").clicked() {
                *open = false;
            }
            if wide(left, "Open or import…", "Ctrl+O").clicked() {
                choose(open, Command::Open);
            }
            if wide(left, "New random scene", "Ctrl+N").clicked() {
                choose(open, Command::New);
            }
            left.add_space(theme::GAP);
            crate::app::icons::section(left, "Recent");
            if settings.recent.is_empty() {
                let text = "Scenes that you open or save appear here. Files can also be dropped on the window: \
                            .loom scenes, OpenDRIVE roads (.xodr), Occ3D labels (.npz).";
                left.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
            for path in settings.recent.iter().take(6) {
                if recent(left, path).clicked() {
                    choose(open, Command::OpenPath(path.to_owned()));
                }
            }
            crate::app::icons::section(right, "Roads to begin with");
            for name in TEMPLATES {
                if wide(right, &theme::sentence(&name.replace('_', " ")), "").clicked() {
                    choose(open, Command::NewFrom(name));
                }
            }
        });
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            ui.checkbox(&mut settings.start_screen, "Show this at the start");
            let text = "Ctrl+K finds any command, F1 shows the keys";
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            });
        });
    });
    if shown.should_close() {
        *open = false;
    }
}

fn wide(ui: &mut Ui, name: &str, keys: &str) -> egui::Response {
    let button = egui::Button::new(name)
        .shortcut_text(egui::RichText::new(keys).color(theme::text_weak()))
        .min_size(vec2(ui.available_width(), 26.0));
    let response = ui.add(button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response
}

fn recent(ui: &mut Ui, path: &Path) -> egui::Response {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    wide(ui, &name, "").on_hover_text(path.display().to_string())
}
