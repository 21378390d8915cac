//! All cameras of the rig in a row.

use egui::{Rect, Ui};

use super::areas::{halves, in_rect, upper_and_lower};
use super::camera_strip::{CameraStrip, CamerasInput};
use super::compare::CompareMode;
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::Command;
use crate::state::UiState;
use widgets::icons::Icon;

/// All cameras.
pub struct Cameras;

impl Pane for Cameras {
    fn id(&self) -> PaneId {
        PaneId::CAMERAS
    }

    fn title(&self) -> String {
        "Cameras".into()
    }

    fn icon(&self) -> Icon {
        Icon::Camera
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let cameras = CamerasInput::of(cx.scene, cx.document.scene().rev, cx.sensing);
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            cx.strip.controls(ui, &cameras, &mut cx.state.cameras, commands);
        });
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        compared(ui, cx, None, commands);
    }
}

/// Draws one camera, or all of them: the present state, the one before it, or both.
pub(super) fn compared(
    ui: &mut Ui,
    cx: &mut PaneContext<'_>,
    camera: Option<usize>,
    commands: &mut Vec<Command>,
) {
    let area = ui.available_rect_before_wrap().shrink2(egui::vec2(8.0, 2.0));
    let mode = cx.compare.mode(&cx.state.compare);
    let now = CamerasInput::of(cx.scene, cx.document.scene().rev, cx.sensing);
    let before = cx.compare.before.clone();
    let other = match (&before, &cx.compare.sensing) {
        (Some(before), Some(sensing)) => Some(CamerasInput::of(before, before.rev, sensing)),
        _ => None,
    };
    let mut draw =
        |ui: &mut Ui, rect: Rect, strip: &mut CameraStrip, input: &CamerasInput<'_>, state: &mut UiState| {
            in_rect(ui, rect, |ui| match camera {
                Some(i) => strip.single(ui, i, input, state, commands),
                None => strip.show(ui, input, state, commands),
            });
        };
    match (mode, other) {
        (_, Some(other)) if cx.compare.shows_before(&cx.state.compare, cx.scene) => {
            draw(ui, area, &mut cx.compare.strip, &other, cx.state);
        }
        (CompareMode::Side, Some(other)) => {
            let (first, second) = match camera {
                Some(_) => halves(area),
                None => upper_and_lower(area),
            };
            cx.strip.wipe(None);
            draw(ui, first, &mut cx.compare.strip, &other, cx.state);
            draw(ui, second, cx.strip, &now, cx.state);
        }
        (CompareMode::Wipe, Some(other)) => {
            let textures = cx.compare.strip.textures(ui, &other, &cx.state.cameras);
            cx.strip.wipe(Some((textures, cx.state.compare.wipe_at)));
            draw(ui, area, cx.strip, &now, cx.state);
        }
        _ => {
            cx.strip.wipe(None);
            draw(ui, area, cx.strip, &now, cx.state);
        }
    }
}
