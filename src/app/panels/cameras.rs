//! The strip of camera pictures, and one of them enlarged.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{
    Align2, Color32, ColorImage, Rect, Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui,
    WidgetInfo, pos2, vec2,
};

use crate::app::command::Command;
use crate::app::icons;
use crate::app::state::{CameraMode, UiState};
use crate::app::theme;
use crate::generation::sensors::color::{depth_rgba, semantic_rgba};
use crate::scene::{CameraMaps, Class, SensorRig};

/// Depth at which the colours begin and end, m.
const DEPTH_M: (f32, f32) = (2.0, 60.0);

/// Textures of the pictures.
#[derive(Default)]
pub struct CameraStrip {
    textures: Vec<TextureHandle>,
    made_from: Option<(Arc<Vec<CameraMaps>>, CameraMode)>,
    stale_since_s: Option<f64>,
    looks_stale: bool,
}

/// What the strip shows.
pub struct CamerasInput<'a> {
    /// The rig.
    pub rig: &'a SensorRig,
    /// The newest maps, in the rig's order.
    pub maps: Option<&'a Arc<Vec<CameraMaps>>>,
    /// The maps belong to an earlier state.
    pub stale: bool,
    /// Returns of the newest sweep.
    pub lidar_points: Option<usize>,
}

impl CameraStrip {
    /// Draws header and pictures.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        input: &CamerasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        self.refresh(ui, input.maps, state.camera_mode);
        self.note_stale(ui, input.stale);
        header(ui, input, self.looks_stale, state);
        ui.add_space(2.0);
        let count = input.rig.cameras.len().max(1) as f32;
        let gap = 6.0;
        let room = ui.available_size();
        let width = ((room.x - gap * (count - 1.0)) / count)
            .min(room.y * 16.0 / 9.0)
            .max(40.0);
        let used = width * count + gap * (count - 1.0);
        let left = ui.max_rect().left() + ((room.x - used) / 2.0).max(0.0);
        let top = ui.cursor().top();
        for (i, camera) in input.rig.cameras.iter().enumerate() {
            let at = pos2(left + i as f32 * (width + gap), top);
            let rect = Rect::from_min_size(at, vec2(width, width * 9.0 / 16.0));
            self.picture(ui, rect, i, &camera.name, state, commands);
        }
    }

    /// Pictures that are renewed at once should not flicker: only what stays stale looks so.
    fn note_stale(&mut self, ui: &Ui, stale: bool) {
        const AFTER_S: f64 = 0.35;
        let now_s = ui.input(|i| i.time);
        if !stale {
            (self.stale_since_s, self.looks_stale) = (None, false);
            return;
        }
        let since_s = *self.stale_since_s.get_or_insert(now_s);
        self.looks_stale = now_s - since_s >= AFTER_S;
        if !self.looks_stale {
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_secs_f64(AFTER_S));
        }
    }

    fn refresh(&mut self, ui: &Ui, maps: Option<&Arc<Vec<CameraMaps>>>, mode: CameraMode) {
        let Some(maps) = maps else { return };
        if self
            .made_from
            .as_ref()
            .is_some_and(|(of, in_mode)| Arc::ptr_eq(of, maps) && *in_mode == mode)
        {
            return;
        }
        self.textures.truncate(maps.len());
        for (i, map) in maps.iter().enumerate() {
            let rgba = match mode {
                CameraMode::Semantic => semantic_rgba(map, true),
                CameraMode::Depth => depth_rgba(&map.depth_m, DEPTH_M.0, DEPTH_M.1),
            };
            let image = ColorImage::from_rgba_unmultiplied([map.width, map.height], &rgba);
            match self.textures.get_mut(i) {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => self
                    .textures
                    .push(ui.ctx().load_texture("camera", image, TextureOptions::LINEAR)),
            }
        }
        self.made_from = Some((maps.clone(), mode));
    }

    fn picture(
        &self,
        ui: &Ui,
        rect: Rect,
        index: usize,
        name: &str,
        state: &UiState,
        commands: &mut Vec<Command>,
    ) {
        let label = camera_label(name);
        let response = ui.interact(rect, ui.scope_id().with(("camera", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Camera {label}")));
        let painter = ui.painter_at(rect.expand(1.0));
        match self.textures.get(index) {
            Some(texture) => {
                let tint = if self.looks_stale {
                    Color32::from_gray(170)
                } else {
                    Color32::WHITE
                };
                painter.image(texture.id(), rect, unit(), tint);
            }
            None => {
                painter.rect_filled(rect, 3.0, theme::WELL);
                let font = egui::TextStyle::Small.resolve(ui.style());
                painter.text(
                    rect.center(),
                    Align2::CENTER_CENTER,
                    "rendering…",
                    font,
                    theme::TEXT_WEAK,
                );
            }
        }
        let chosen = state.inspected == Some(index);
        let edge = match (chosen, response.hovered()) {
            (true, _) => Stroke::new(2.0, theme::ACCENT),
            (_, true) => Stroke::new(1.0, theme::TEXT_WEAK),
            _ => Stroke::new(1.0, Color32::from_black_alpha(120)),
        };
        painter.rect_stroke(rect, 2.0, edge, StrokeKind::Inside);
        badge(
            ui,
            &painter,
            rect.left_bottom() + vec2(6.0, -6.0),
            &label,
            theme::TEXT_STRONG,
        );
        let response = response
            .on_hover_ui(|ui| icons::tip(ui, &label, "click to enlarge, double click to look through"));
        if response.double_clicked() {
            commands.push(Command::Inspect(None));
            commands.push(Command::LookThrough(index));
        } else if response.clicked() {
            commands.push(Command::Inspect((!chosen).then_some(index)));
        }
    }

    /// One camera large, over the views; its pixels can be read.
    pub fn enlarged(
        &self,
        ui: &Ui,
        over: Rect,
        input: &CamerasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        let Some(index) = state.inspected else { return };
        let (Some(texture), Some(maps)) = (self.textures.get(index), input.maps.and_then(|m| m.get(index)))
        else {
            return;
        };
        let aspect = maps.width as f32 / maps.height.max(1) as f32;
        let width = (over.width() * 0.72).min((over.height() * 0.8) * aspect);
        let name = input.rig.cameras.get(index).map_or("", |c| c.name.as_str());
        let window = egui::Window::new(format!("Camera: {}", camera_label(name)))
            .id(egui::Id::unique("enlarged camera"))
            .collapsible(false)
            .resizable(false)
            .default_pos(over.center() - vec2(width, width / aspect + 60.0) / 2.0);
        let mut open = true;
        window.open(&mut open).show(ui.ctx(), |ui| {
            let size = vec2(width, width / aspect);
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            ui.painter().image(texture.id(), rect, unit(), Color32::WHITE);
            ui.horizontal(|ui| {
                let text = response
                    .hover_pos()
                    .map(|p| pixel_text(maps, (p - rect.min) / rect.size()));
                ui.label(text.unwrap_or_else(|| "Move over the picture to read a pixel".into()));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if ui.button("Look through in 3D").clicked() {
                        commands.push(Command::LookThrough(index));
                        commands.push(Command::Inspect(None));
                    }
                });
            });
        });
        if !open {
            state.inspected = None;
        }
    }
}

fn header(ui: &mut Ui, input: &CamerasInput<'_>, stale: bool, state: &mut UiState) {
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new("Cameras").color(theme::TEXT));
        ui.add_space(4.0);
        icons::segments(
            ui,
            &mut state.camera_mode,
            &[
                (CameraMode::Semantic, "Semantic", "classes"),
                (CameraMode::Depth, "Depth", "2 m warm to 60 m cold"),
            ],
        );
        if stale {
            ui.add_space(4.0);
            ui.add(egui::Spinner::new().size(12.0).color(theme::TEXT_WEAK));
            ui.label(egui::RichText::new("updating").small().color(theme::TEXT_WEAK));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if let Some(n) = input.lidar_points {
                let text = format!("LiDAR  {} returns", thousands(n));
                ui.label(egui::RichText::new(text).small().color(theme::TEXT_WEAK));
            }
        });
    });
}

fn unit() -> Rect {
    Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0))
}

fn badge(ui: &Ui, painter: &egui::Painter, left_bottom: egui::Pos2, text: &str, color: Color32) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let size = galley.size() + vec2(10.0, 4.0);
    let rect = Rect::from_min_size(left_bottom - vec2(0.0, size.y), size);
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(150));
    painter.galley(rect.min + vec2(5.0, 2.0), galley, color);
}

/// What a pixel shows; `part` runs from 0 to 1 across the picture.
fn pixel_text(maps: &CameraMaps, part: egui::Vec2) -> String {
    let (x, y) = (
        (part.x * maps.width as f32) as usize,
        (part.y * maps.height as f32) as usize,
    );
    if x >= maps.width || y >= maps.height {
        return String::new();
    }
    let i = y * maps.width + x;
    let name = match maps.semantic[i] {
        0 => "nothing".to_owned(),
        17 => "crossing".to_owned(),
        18 => "road divider".to_owned(),
        19 => "lane divider".to_owned(),
        id => Class::from_id(id).map_or_else(|| "unknown".into(), Class::label),
    };
    match maps.depth_m[i] {
        d if d > 0.0 => format!("{x}, {y}  ·  {name}  ·  {d:.1} m"),
        _ => format!("{x}, {y}  ·  {name}"),
    }
}

/// `CAM_FRONT_LEFT` as a person says it.
pub fn camera_label(name: &str) -> String {
    theme::sentence(&name.trim_start_matches("CAM_").replace('_', " ").to_lowercase())
}

/// 34567 as `34,567`.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_for_people() {
        assert_eq!(camera_label("CAM_FRONT_LEFT"), "Front left");
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(34_720), "34,720");
        assert_eq!(thousands(1_234_567), "1,234,567");
    }

    #[test]
    fn pixels_are_read_and_the_edge_is_no_pixel() {
        let maps = CameraMaps {
            camera: "CAM".into(),
            width: 2,
            height: 1,
            semantic: vec![4, 0],
            depth_m: vec![12.34, -1.0],
            expected_m: vec![12.34, 0.0],
            median_m: vec![12.34, -1.0],
            coverage: vec![1.0, 0.0],
        };
        assert_eq!(pixel_text(&maps, vec2(0.1, 0.5)), "0, 0  ·  car  ·  12.3 m");
        assert_eq!(pixel_text(&maps, vec2(0.9, 0.5)), "1, 0  ·  nothing");
        assert_eq!(pixel_text(&maps, vec2(1.0, 0.5)), "");
    }
}
