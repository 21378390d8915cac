//! The start screen: a description, recent files, ready-made roads, import, a tour.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Id, Modal, Sense, Ui, WidgetInfo, vec2};

use crate::command::{Command, FileCommand};
use crate::shell::settings::Settings;
use language::{t, tf};
use scene::{Lattice, drawn};
use widgets::theme;
use world::template::TEMPLATES;

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
        let text = t("Paint a street, place what stands on it, and see what the sensors would see.");
        ui.label(egui::RichText::new(text).color(theme::text_weak()));
        ui.add_space(theme::GAP);
        if let Some(words) = describe(ui) {
            choose(open, Command::File(FileCommand::Describe(words)));
        }
        ui.add_space(theme::GAP);
        ui.columns_const(|[left, right]: &mut [Ui; 2]| {
            widgets::icons::section(left, t("Begin"));
            if wide(left, t("Go on with this scene"), "Esc").clicked() {
                *open = false;
            }
            if wide(left, t("Open or import…"), "Ctrl+O").clicked() {
                choose(open, Command::File(FileCommand::Open));
            }
            if wide(left, t("New random scene"), "Ctrl+N").clicked() {
                choose(open, Command::File(FileCommand::New));
            }
            if wide(left, t("Tour in three steps"), "").clicked() {
                choose(open, Command::BeginTour);
            }
            left.add_space(theme::GAP);
            widgets::icons::section(left, t("Recent"));
            if settings.recent.is_empty() {
                let text = t(
                    "Scenes that you open or save appear here. A file can also be dropped on the window: a scene, a road (OpenDRIVE, Lanelet2, CommonRoad), labels, a point cloud, a glTF model.",
                );
                // Columns justify their contents; text should not be justified.
                left.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
                });
            }
            for path in settings.recent.iter().take(6) {
                if recent(left, path).clicked() {
                    choose(open, Command::File(FileCommand::OpenPath(path.to_owned())));
                }
            }
            widgets::icons::section(right, t("Roads to begin with"));
            let lattice = voxels_of(right);
            for pair in TEMPLATES.chunks(2) {
                right.columns(2, |cells| {
                    for (ui, name) in cells.iter_mut().zip(pair) {
                        if road(ui, name).clicked() {
                            choose(open, Command::File(FileCommand::NewFrom(name, lattice)));
                        }
                    }
                });
                right.add_space(4.0);
            }
        });
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            ui.checkbox(&mut settings.start_screen, t("Show this at the start"));
            let text = t("Ctrl+K finds any command, ? shows the keys");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            });
        });
    });
    if shown.should_close() {
        *open = false;
    }
}

/// The choice of voxels of a new scene: those of the networks, or finer ones.
fn voxels_of(ui: &mut Ui) -> Lattice {
    let id = Id::unique("voxels of a new scene");
    let mut is_fine: bool = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label(
            egui::RichText::new(t("Voxels of"))
                .small()
                .color(theme::text_weak()),
        );
        ui.selectable_value(&mut is_fine, false, "0.4 m");
        let finer = ui.selectable_value(&mut is_fine, true, "0.2 m");
        finer.on_hover_text(t("Finer to paint; sensors and networks work in 0.4 m"));
    });
    ui.data_mut(|d| d.insert_temp(id, is_fine));
    match is_fine {
        true => drawn::new_lattice(0.2, None).unwrap_or(Lattice::OCC3D),
        false => Lattice::OCC3D,
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

/// State of the description field.
#[derive(Clone, Default)]
struct Described {
    words: String,
    /// The last pass in which it was drawn; the field takes the focus when it appears.
    drawn: Option<u64>,
}

/// The field for a description. Returns the words once a scene is to be made of them.
fn describe(ui: &mut Ui) -> Option<String> {
    let id = Id::unique("described at the start");
    let mut typed: Described = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let made = ui
        .horizontal(|ui| {
            let example = "night, rain, a roundabout, five cones block my lane";
            let field = egui::TextEdit::singleline(&mut typed.words)
                .hint_text(tf!("Describe a scene: {example}", example = example))
                .margin(vec2(8.0, 6.0))
                .desired_width(ui.available_width() - 96.0);
            let field = ui.add(field).accessible_name(t("Describe a scene"));
            let pass = ui.ctx().cumulative_pass_nr();
            if typed.drawn.replace(pass).is_none_or(|drawn| drawn + 2 < pass) {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
            let some = !typed.words.trim().is_empty();
            let button = egui::Button::new(t("Make it"))
                .fill(theme::accent_fill())
                .min_size(vec2(84.0, 28.0));
            let clicked = ui.add_enabled(some, button).clicked();
            some && (clicked || entered)
        })
        .inner;
    let words = made.then(|| typed.words.trim().to_owned());
    ui.data_mut(|d| {
        // A description that became a scene is cleared.
        let left = if made { Described::default() } else { typed };
        d.insert_temp(id, left);
    });
    words
}

/// Picture of a scene on a road of this kind; `None` if there is no picture.
fn picture(ui: &Ui, name: &str) -> Option<egui::TextureHandle> {
    let bytes = match name {
        "straight" => assets::thumbnails::STRAIGHT,
        "curve" => assets::thumbnails::CURVE,
        "t-junction" => assets::thumbnails::T_JUNCTION,
        "intersection" => assets::thumbnails::INTERSECTION,
        "roundabout" => assets::thumbnails::ROUNDABOUT,
        "highway" => assets::thumbnails::HIGHWAY,
        "parking" => assets::thumbnails::PARKING,
        "suburb" => assets::thumbnails::SUBURB,
        _ => return None,
    };
    // The picture is decoded once.
    let id = Id::unique(("road to begin with", name));
    let kept: Option<egui::TextureHandle> = ui.data(|d| d.get_temp(id));
    kept.or_else(|| {
        let image = image::load_from_memory(bytes).ok()?.to_rgb8();
        let size = [image.width() as usize, image.height() as usize];
        let image = egui::ColorImage::from_rgb(size, image.as_raw());
        let texture = ui.ctx().load_texture(name, image, egui::TextureOptions::LINEAR);
        ui.data_mut(|d| d.insert_temp(id, texture.clone()));
        Some(texture)
    })
}

/// A template as a picture, with its name below.
fn road(ui: &mut Ui, name: &'static str) -> egui::Response {
    const HEIGHT: f32 = 100.0;
    let label = theme::sentence(t(&name.replace('_', " ")));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let (above, below) = rect.split_top_bottom_at_y(rect.bottom() - 18.0);
    ui.painter().rect_filled(rect, theme::RADIUS, theme::field());
    if let Some(picture) = picture(ui, name) {
        let uv = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        ui.painter()
            .image(picture.id(), above.shrink(3.0), uv, egui::Color32::WHITE);
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
