//! What the headers of the views offer.

use egui::Ui;

use crate::command::Command;
use crate::state::{CameraMode, LidarModel, UiState, Underlay};
use crate::theme;
use crate::widgets::icons::{self, Icon};
use viewport::{LayoutPlane, LidarColorMode, ViewOptions, ViewPreset};

/// Of the bird's-eye view.
pub fn bev_controls(ui: &mut Ui, state: &mut UiState) {
    let choices = [
        (Underlay::Layout, "Layout", "map layers"),
        (Underlay::Occupancy, "Occupancy", "voxels from above"),
        (Underlay::Both, "Both", "layers over voxels"),
    ];
    icons::choice(ui, &mut state.underlay, &choices, "Bird's-eye view shows");
}

/// Of the 3D view.
pub fn view3d_controls(
    ui: &mut Ui,
    options: &mut ViewOptions,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    if icons::button(ui, Icon::Camera, "Screenshot", "F12", false, true).clicked() {
        commands.push(Command::QuickShot);
    }
    let show = egui::containers::menu::MenuButton::new("Show").config(
        egui::containers::menu::MenuConfig::new()
            .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside),
    );
    show.ui(ui, |ui| show_menu(ui, options, state));
    ui.menu_button("View", |ui| {
        for preset in ViewPreset::ALL {
            if ui.button(theme::sentence(preset.name())).clicked() {
                commands.push(Command::View(preset));
                ui.close();
            }
        }
    });
}

/// Of a single camera.
pub fn camera_controls(ui: &mut Ui, state: &mut UiState) {
    let modes = [
        (CameraMode::Semantic, "Semantic"),
        (CameraMode::Depth, "Depth"),
        (CameraMode::Picture, "Picture"),
        (CameraMode::Planes, "Planes"),
        (CameraMode::Layout, "Boxes, lanes"),
    ];
    let shown = modes.iter().find(|(mode, _)| *mode == state.camera_mode);
    egui::ComboBox::from_id_salt("camera mode")
        .selected_text(shown.map_or("", |(_, name)| name))
        .width(96.0)
        .show_ui(ui, |ui| {
            for (mode, name) in modes {
                ui.selectable_value(&mut state.camera_mode, mode, name);
            }
        })
        .response
        .accessible_name("Camera picture");
}

/// Of the unrolled sweep.
pub fn lidar_controls(ui: &mut Ui, state: &mut UiState) {
    let colors = [
        (LidarColorMode::Range, "Range"),
        (LidarColorMode::Class, "Class"),
        (LidarColorMode::Ring, "Ring"),
        (LidarColorMode::Intensity, "Echo"),
        (LidarColorMode::Drop, "Loss"),
    ];
    let shown = colors.iter().find(|(mode, _)| *mode == state.lidar_colors);
    egui::ComboBox::from_id_salt("sweep colours")
        .selected_text(shown.map_or("Range", |(_, name)| name))
        .width(84.0)
        .show_ui(ui, |ui| {
            for (mode, name) in colors {
                ui.selectable_value(&mut state.lidar_colors, mode, name);
            }
        })
        .response
        .accessible_name("LiDAR colour");
}

fn show_menu(ui: &mut Ui, options: &mut ViewOptions, state: &mut UiState) {
    ui.set_min_width(200.0);
    ui.checkbox(&mut options.voxels, "Voxels");
    ui.checkbox(&mut options.voxel_edges, "Voxel edges");
    ui.checkbox(&mut options.shadows, "Shadows");
    ui.checkbox(&mut options.markings, "Road markings");
    ui.checkbox(&mut state.show_boxes, "Boxes");
    ui.checkbox(&mut options.lidar, "LiDAR points");
    ui.checkbox(&mut options.ego, "Ego vehicle");
    ui.checkbox(&mut options.frusta, "Camera frusta");
    ui.checkbox(&mut state.show_grid, "Grid");
    let mut plane = options.layout_plane == LayoutPlane::Always;
    if ui.checkbox(&mut plane, "Layout on the ground").changed() {
        options.layout_plane = if plane {
            LayoutPlane::Always
        } else {
            LayoutPlane::WhereEmpty
        };
    }
    let mut clipped = options.clip_above_m.is_some();
    if ui.checkbox(&mut clipped, "Cut above").changed() {
        options.clip_above_m = clipped.then_some(2.0);
    }
    if let Some(height_m) = &mut options.clip_above_m {
        ui.add(
            egui::Slider::new(height_m, -1.0..=5.4)
                .suffix(" m")
                .fixed_decimals(1),
        );
    }
    ui.separator();
    ui.label(egui::RichText::new("LiDAR").small().color(theme::text_weak()));
    icons::segments(
        ui,
        &mut state.lidar_model,
        &[
            (LidarModel::Exact, "Exact", "every ray to the first voxel"),
            (
                LidarModel::Learned,
                "Learned",
                "ranges within voxels, echo strength, lost echoes",
            ),
        ],
    );
    ui.label(
        egui::RichText::new("LiDAR colour")
            .small()
            .color(theme::text_weak()),
    );
    icons::segments(
        ui,
        &mut state.lidar_colors,
        &[
            (LidarColorMode::Range, "Range", "near warm, far cool"),
            (LidarColorMode::Class, "Class", "of the voxel hit"),
            (LidarColorMode::Ring, "Ring", "beam"),
            (
                LidarColorMode::Intensity,
                "Echo",
                "strength, from the learned LiDAR",
            ),
            (
                LidarColorMode::Drop,
                "Loss",
                "how likely an echo is lost, from the learned LiDAR",
            ),
        ],
    );
}
