//! Headers of the two large views: name, and what they show.

use egui::{Ui, vec2};

use crate::app::command::Command;
use crate::app::icons::{self, Icon};
use crate::app::state::{LidarModel, UiState, Underlay};
use crate::app::theme;
use crate::viewport::{LayoutPlane, LidarColorMode, ViewOptions, ViewPreset};

/// Height of a header, points.
pub const HEADER: f32 = 32.0;

fn title(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).color(theme::TEXT));
}

/// A header: the title on the left, the rest from the right.
fn header(ui: &mut Ui, name: &str, rest: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), HEADER);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let inner = rect.shrink2(vec2(10.0, 2.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| {
        ui.set_clip_rect(rect);
        ui.horizontal_centered(|ui| {
            title(ui, name);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), rest);
        });
    });
}

/// Of the bird's-eye view.
pub fn bev_header(ui: &mut Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    header(ui, "Bird's-eye view", |ui| {
        swap(ui, commands);
        icons::segments(
            ui,
            &mut state.underlay,
            &[
                (Underlay::Layout, "Layout", "map layers"),
                (Underlay::Occupancy, "Occupancy", "voxels from above"),
                (Underlay::Both, "Both", "layers over voxels"),
            ],
        );
    });
}

/// Of the 3D view.
pub fn view3d_header(
    ui: &mut Ui,
    options: &mut ViewOptions,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    header(ui, "3D view", |ui| {
        swap(ui, commands);
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
    });
}

fn swap(ui: &mut Ui, commands: &mut Vec<Command>) {
    if icons::button(ui, Icon::Swap, "Swap views", "Tab", false, true).clicked() {
        commands.push(Command::SwapPanes);
    }
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
    ui.label(egui::RichText::new("LiDAR").small().color(theme::TEXT_WEAK));
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
            .color(theme::TEXT_WEAK),
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
