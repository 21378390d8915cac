//! The 3D view, with the reference state on it or beside it.

use std::sync::Arc;

use egui::Ui;

use super::areas::{clipped, halves, in_rect, left_part, sides};
use super::box_menu::{self, Under};
use super::compare::{CompareMode, legend, wipe_line};
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::camera_views::{LidarModel, LidarShown};
use crate::command::{Command, FileCommand, ViewCommand};
use crate::detection_marks::DetectionMarks;
use crate::look::Look;
use crate::state::UiState;
use crate::view3d::{View3d, View3dInput};
use crate::views_shown::ViewsShown;
use editor::pick::{self, PickHit};
use language::t;
use scene::Scene;
use viewport::{LayoutPlane, LidarColorMode, ViewOptions, ViewPreset};
use widgets::icons::{self, Icon};
use widgets::theme;

/// The pane of the 3D view.
pub struct View3dPane;

impl Pane for View3dPane {
    fn id(&self) -> PaneId {
        PaneId::VIEW3D
    }

    fn title(&self) -> String {
        "3D view".into()
    }

    fn icon(&self) -> Icon {
        Icon::Voxel
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if icons::button(ui, Icon::Camera, t("Screenshot"), "F12", false, true).clicked() {
            commands.push(Command::File(FileCommand::QuickShot));
        }
        let looks = [
            (
                Look::Voxels,
                t("Voxels"),
                t("Classes as the networks and sensors take them"),
            ),
            (
                Look::Pictures,
                t("Pictures"),
                t("What a camera would see from here; in perspective views"),
            ),
        ];
        icons::choice(ui, &mut cx.state.shown.look, &looks, t("3D view as"));
        let show = egui::containers::menu::MenuButton::new(t("Show")).config(
            egui::containers::menu::MenuConfig::new()
                .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside),
        );
        let (options, UiState { shown, lidar, .. }) = (&mut cx.view3d.options, &mut *cx.state);
        show.ui(ui, |ui| show_menu(ui, options, shown, lidar));
        ui.menu_button(t("View"), |ui| {
            for preset in ViewPreset::ALL {
                if ui.button(theme::sentence(t(preset.name()))).clicked() {
                    commands.push(Command::View(ViewCommand::Preset(preset)));
                    ui.close();
                }
            }
            ui.separator();
            let mut parallel = cx.view3d.camera.ortho;
            let tick = ui.checkbox(&mut parallel, t("Orthographic"));
            if tick.on_hover_text(t("Lines that are parallel stay so")).clicked() {
                commands.push(Command::View(ViewCommand::ToggleParallel));
                ui.close();
            }
        });
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        let scene = cx.scene;

        let mode = cx.compare.mode(&cx.state.compare);
        let (left, right) = halves(area);
        let rect = if mode == CompareMode::Side { right } else { area };
        let shows_reference = cx.compare.shows_reference(&cx.state.compare, scene);
        let difference = match mode {
            CompareMode::Difference => cx.compare.difference(ui, scene).map(|(d, _)| d),
            _ => None,
        };
        let entries = difference.map(|d| d.legend());
        let marked = difference.map(|d| d.marked());
        let marks = cx.state.shown.detection_marks.clone();
        let marks = marks.filter(|_| mode == CompareMode::Off);
        let told = marks.as_ref().and_then(|m| m.told.clone());
        let input = View3dInput {
            scene: told.as_ref().unwrap_or(&cx.seen.scene),
            settled: told.as_ref().unwrap_or(&cx.seen.settled),
            lidar: cx.sensing.lidar(),
            dragging: cx.document.is_dragging(),
            marked: marked.as_ref().map_or(&[], |m| &m[..]),
            unsettled: (cx.unsettled, cx.generating),
            is_told: told.is_some(),
        };
        let (view, state) = (&mut *cx.view3d, &mut *cx.state);
        if shows_reference {
            let (camera, options) = (view.camera, view.options.clone());
            clipped(ui, area, |ui| {
                view.still(ui, area, (&camera, &options), &input, state)
            });
            return;
        }
        in_rect(ui, rect, |ui| {
            box_menu::hold(ui, PaneId::VIEW3D);
            let response = view.show(ui, &input, state, commands);
            box_menu::of_view(ui, &response, (PaneId::VIEW3D, scene, state), commands, |at| {
                under(view, input.scene, at)
            });
        });
        let of_marks = |m: Arc<DetectionMarks>| match m.told {
            Some(_) => m.told_legend(scene.rev),
            None => m.legend(scene.rev),
        };
        let entries = entries.or_else(|| marks.map(of_marks));
        if let Some(entries) = entries {
            legend(ui, rect.left_top() + egui::vec2(8.0, 8.0), &entries);
        }
        let Some(reference) = cx.compare.reference.clone() else {
            return;
        };
        if !matches!(mode, CompareMode::Side | CompareMode::Wipe) {
            return;
        }
        let other = cx
            .compare
            .view3d
            .get_or_insert_with(|| View3d::new(cx.render_state.cloned()));
        let lidar = cx.compare.sensing.as_ref().and_then(|s| s.lidar());
        let input = View3dInput {
            scene: &reference,
            settled: &reference,
            lidar,
            dragging: false,
            marked: &[],
            is_told: false,
            unsettled: (&[], false),
        };
        let seen_from = (&cx.view3d.camera, &cx.view3d.options);
        if mode == CompareMode::Side {
            clipped(ui, left, |ui| other.still(ui, left, seen_from, &input, cx.state));
            sides(ui, left, right, cx.state.compare.names());
        } else {
            let part = left_part(area, cx.state.compare.wipe_at);
            clipped(ui, part, |ui| other.still(ui, area, seen_from, &input, cx.state));
            wipe_line(ui, area, &mut cx.state.compare);
        }
    }
}

/// The box or the place under a point of the screen.
fn under(view: &View3d, scene: &Scene, at: egui::Pos2) -> Under {
    let ray = view.pointer(at).map(|p| p.ray);
    let hit = ray.and_then(|ray| pick::pick(scene.frame(), &ray).map(|hit| (ray, hit)));
    match hit {
        None => Under::default(),
        Some((_, PickHit::Box { id, .. })) => Under {
            id: Some(id),
            at_m: None,
        },
        Some((ray, PickHit::Voxel(v))) => Under {
            id: None,
            at_m: Some(ray.at(v.distance_m).truncate()),
        },
        Some((_, PickHit::Ground { point_in_ego })) => Under {
            id: None,
            at_m: Some(point_in_ego.truncate()),
        },
    }
}

fn show_menu(ui: &mut Ui, options: &mut ViewOptions, shown: &mut ViewsShown, sweep: &mut LidarShown) {
    ui.set_min_width(200.0);
    ui.checkbox(&mut options.voxels, t("Voxels"));
    ui.checkbox(&mut options.voxel_edges, t("Voxel edges"));
    ui.checkbox(&mut options.shadows, t("Shadows"));
    ui.checkbox(&mut options.markings, t("Road markings"));
    ui.checkbox(&mut shown.boxes, t("Boxes"));
    ui.checkbox(&mut options.lidar, t("LiDAR points"));
    ui.checkbox(&mut options.ego, t("Ego vehicle"));
    ui.checkbox(&mut options.frusta, t("Camera frusta"));
    ui.checkbox(&mut shown.grid, t("Grid"));
    let mut plane = options.layout_plane == LayoutPlane::Always;
    if ui.checkbox(&mut plane, t("Layout on the ground")).changed() {
        options.layout_plane = if plane {
            LayoutPlane::Always
        } else {
            LayoutPlane::WhereEmpty
        };
    }
    let mut clipped = options.clip_above_m.is_some();
    if ui.checkbox(&mut clipped, t("Cut above")).changed() {
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
    ui.label(egui::RichText::new(t("LiDAR")).small().color(theme::text_weak()));
    icons::segments(
        ui,
        &mut sweep.model,
        &[
            (
                LidarModel::Recorded,
                t("Recorded"),
                t("the imported sweep, where the scene has one"),
            ),
            (LidarModel::Exact, t("Exact"), t("every ray to the first voxel")),
            (
                LidarModel::Learned,
                t("Learned"),
                t("ranges within voxels, echo strength, lost echoes"),
            ),
        ],
    );
    ui.label(
        egui::RichText::new(t("LiDAR colour"))
            .small()
            .color(theme::text_weak()),
    );
    icons::segments(
        ui,
        &mut sweep.colors,
        &[
            (LidarColorMode::Range, t("Range"), t("near warm, far cool")),
            (LidarColorMode::Class, t("Class"), t("of the voxel hit")),
            (LidarColorMode::Ring, t("Ring"), t("beam")),
            (
                LidarColorMode::Intensity,
                t("Intensity"),
                t("strength, from the learned LiDAR"),
            ),
            (
                LidarColorMode::Drop,
                t("Loss"),
                t("how likely an echo is lost, from the learned LiDAR"),
            ),
            (
                LidarColorMode::Origin,
                t("Origin"),
                t("grey: recorded; green: added; orange, violet: told from what was measured nearby"),
            ),
        ],
    );
}
