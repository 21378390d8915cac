//! The row above the camera strip: what the pictures show, and the knob that belongs to it.

use egui::Ui;

use crate::command::Command;
use crate::icons;
use crate::state::{CameraMode, CameraSource, UiState};
use crate::theme;

use super::cameras::{CamerasInput, thousands};
use super::conditions::conditions;

const MODES: [(CameraMode, &str, &str); 5] = [
    (CameraMode::Semantic, "Semantic", "classes"),
    (CameraMode::Depth, "Depth", "2 m warm to 60 m cold"),
    (CameraMode::Picture, "Picture", "what a camera would see"),
    (CameraMode::Planes, "Planes", "one plane of the multi-plane image"),
    (
        CameraMode::Layout,
        "Boxes, lanes",
        "in perspective, hidden or not",
    ),
];

const SOURCES: [(CameraSource, &str, &str); 3] = [
    (
        CameraSource::Splats,
        "Splats",
        "Gaussians at voxel centres, as the papers render",
    ),
    (CameraSource::Voxels, "Voxels", "exact rays to the voxels"),
    (
        CameraSource::Shapes,
        "Shapes",
        "exact rays; boxes as the shapes they stand for",
    ),
];

/// Width that the button of the sensors takes, points.
const SENSORS_BUTTON: f32 = 84.0;
/// Width that the number of LiDAR returns takes, points.
const LIDAR_TEXT: f32 = 130.0;

/// Draws the row.
pub fn header(
    ui: &mut Ui,
    input: &CamerasInput<'_>,
    stale: bool,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        icons::segments(ui, &mut state.camera_mode, &MODES);
        ui.add_space(8.0);
        match state.camera_mode {
            CameraMode::Semantic | CameraMode::Depth => {
                icons::segments(ui, &mut state.camera_source, &SOURCES);
            }
            CameraMode::Picture => conditions(ui, input.scene, commands),
            CameraMode::Planes => {
                let slider = egui::Slider::new(&mut state.plane_m, 0.2..=51.0)
                    .suffix(" m")
                    .fixed_decimals(1);
                ui.spacing_mut().slider_width = 220.0;
                ui.add(slider).on_hover_text("Depth of the plane");
            }
            CameraMode::Layout => {}
        }
        if stale {
            ui.add_space(4.0);
            ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()));
            ui.label(egui::RichText::new("updating").small().color(theme::text_weak()));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // The menu has it too.
            if ui.available_width() > SENSORS_BUTTON && ui.button("Sensors…").clicked() {
                commands.push(Command::ToggleSensors);
            }
            let text = input
                .lidar_points
                .map(|n| format!("LiDAR  {} returns", thousands(n)));
            // Only where it hides no button.
            if let Some(text) = text.filter(|_| ui.available_width() > LIDAR_TEXT) {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
        });
    });
}
