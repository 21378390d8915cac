//! The start screen: recent files, ready-made roads, import.

use std::path::Path;
use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Id, Modal, Sense, Ui, WidgetInfo, vec2};

use crate::command::{Command, FileCommand};
use crate::shell::settings::Settings;
use scene::BevLayout;
use widgets::theme;
use widgets::thumbnail;
use world::template::{TEMPLATES, layout};

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
        ui.label(
            egui::RichText::new("Sceneloom")
                .size(24.0)
                .color(theme::text_strong()),
        );
        let text = "Paint a street, place what stands on it, and see what the sensors would see.";
        ui.label(egui::RichText::new(text).color(theme::text_weak()));
        ui.add_space(2.0 * theme::GAP);
        ui.columns_const(|[left, right]: &mut [Ui; 2]| {
            widgets::icons::section(left, "Begin");
            if wide(left, "Go on with this scene", "Esc").clicked() {
                *open = false;
            }
            if wide(left, "Open or import…", "Ctrl+O").clicked() {
                choose(open, Command::File(FileCommand::Open));
            }
            if wide(left, "New random scene", "Ctrl+N").clicked() {
                choose(open, Command::File(FileCommand::New));
            }
            left.add_space(theme::GAP);
            widgets::icons::section(left, "Recent");
            if settings.recent.is_empty() {
                let text = format!(
                    "Scenes that you open or save appear here. Files can also be dropped on the window: {}.",
                    formats::import::in_words()
                );
                // Columns justify what is in them; words do not want that.
                left.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
                });
            }
            for path in settings.recent.iter().take(6) {
                if recent(left, path).clicked() {
                    choose(open, Command::File(FileCommand::OpenPath(path.to_owned())));
                }
            }
            widgets::icons::section(right, "Roads to begin with");
            for pair in TEMPLATES.chunks(2) {
                right.columns(2, |cells| {
                    for (ui, name) in cells.iter_mut().zip(pair) {
                        if road(ui, name).clicked() {
                            choose(open, Command::File(FileCommand::NewFrom(name)));
                        }
                    }
                });
                right.add_space(4.0);
            }
        });
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            ui.checkbox(&mut settings.start_screen, "Show this at the start");
            let text = "Ctrl+K finds any command, ? shows the keys";
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

/// A template as it looks from above, with its name below.
fn road(ui: &mut Ui, name: &'static str) -> egui::Response {
    const HEIGHT: f32 = 78.0;
    let label = theme::sentence(&name.replace('_', " "));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let (above, below) = rect.split_top_bottom_at_y(rect.bottom() - 18.0);
    ui.painter().rect_filled(rect, theme::RADIUS, theme::field());
    // The same picture each time: made once.
    let id = Id::unique(("road to begin with", name));
    let layout: Option<Arc<BevLayout>> = ui.data_mut(|d| {
        d.get_temp_mut_or_insert_with(id, || layout(name, 1).map(Arc::new))
            .clone()
    });
    if let Some(layout) = layout {
        thumbnail::road(ui, above.shrink(3.0), &layout);
    }
    let color = match response.hovered() {
        true => theme::text_strong(),
        false => theme::text(),
    };
    if response.hovered() {
        let edge = egui::Stroke::new(1.0, theme::accent());
        ui.painter()
            .rect_stroke(rect, theme::RADIUS, edge, egui::StrokeKind::Inside);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    ui.painter()
        .text(below.center(), egui::Align2::CENTER_CENTER, label, font, color);
    widgets::icons::focus_ring(ui, &response, rect);
    response
}

fn recent(ui: &mut Ui, path: &Path) -> egui::Response {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    wide(ui, &name, "").on_hover_text(path.display().to_string())
}
