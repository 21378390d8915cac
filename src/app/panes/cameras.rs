//! All cameras of the rig in a row.

use egui::{Rect, Ui};

use super::areas::{halves, in_rect, upper_and_lower};
use super::camera_header::progress;
use super::camera_strip::{CameraStrip, CamerasInput};
use super::compare::{CompareMode, tag};
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::Command;
use crate::state::UiState;
use language::tf;
use sensors::cameras::{ViewId, learned};
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
        let cameras =
            CamerasInput::from_scene(cx.scene, cx.document.scene().rev, cx.sensing, &cx.state.cameras);
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            cx.strip.controls(ui, &cameras, &mut cx.state.cameras, commands);
        });
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        compared(ui, cx, None, commands);
    }
}

/// Picture strips of one camera's pane.
pub(super) struct Strips<'a> {
    /// Strip of the present state.
    pub now: &'a mut CameraStrip,
    /// Strip of the reference state.
    pub before: &'a mut CameraStrip,
    /// Index of the camera.
    pub camera: usize,
    /// View of the camera.
    pub view: ViewId,
}

/// Draws one camera or all of them: the present state, the reference state, both, or the differences.
pub(super) fn compared(
    ui: &mut Ui,
    cx: &mut PaneContext<'_>,
    one: Option<Strips<'_>>,
    commands: &mut Vec<Command>,
) {
    let area = ui.available_rect_before_wrap().shrink2(egui::vec2(8.0, 2.0));
    let mode = cx.compare.mode(&cx.state.compare);
    let shows_reference = cx.compare.shows_reference(&cx.state.compare, cx.scene);
    let rev = cx.document.scene().rev;
    let cameras = cx.state.cameras.clone();
    let (view, camera) = one
        .as_ref()
        .map_or((cameras.view, None), |o| (o.view, Some(o.camera)));
    let of = |scene, rev, sensing| {
        CamerasInput::from_scene(scene, rev, sensing, &cameras).of_view(rev, sensing, &cameras, view)
    };
    let now = of(cx.scene, rev, cx.sensing);
    let reference = cx.compare.reference.clone();
    let other = match (&reference, &cx.compare.sensing) {
        (Some(reference), Some(sensing)) => Some(of(reference, reference.rev, sensing)),
        _ => None,
    };
    let (strip, earlier) = match one {
        Some(one) => (one.now, one.before),
        None => (&mut *cx.strip, &mut cx.compare.strip),
    };
    let mut draw =
        |ui: &mut Ui, rect: Rect, strip: &mut CameraStrip, input: &CamerasInput<'_>, state: &mut UiState| {
            in_rect(ui, rect, |ui| match camera {
                Some(i) => strip.single(ui, i, input, state, commands),
                None => strip.show(ui, input, state, commands),
            });
        };
    let single = camera.is_some();
    let differs = mode == CompareMode::Difference;
    strip.differ(ui, &now, other.as_ref().filter(|_| differs));
    if mode != CompareMode::Wipe {
        strip.wipe(None);
    }
    match (mode, other) {
        (_, Some(other)) if shows_reference => draw(ui, area, earlier, &other, cx.state),
        (CompareMode::Side, Some(other)) => {
            let (first, second) = match camera {
                Some(_) => halves(area),
                None => upper_and_lower(area),
            };
            draw(ui, first, earlier, &other, cx.state);
            draw(ui, second, strip, &now, cx.state);
        }
        (CompareMode::Wipe, Some(other)) => {
            let textures = earlier.textures(ui, &other);
            strip.wipe(Some((textures, cx.state.compare.wipe_at)));
            draw(ui, area, strip, &now, cx.state);
        }
        (_, other) => {
            strip.wipe(None);
            draw(ui, area, strip, &now, cx.state);
            if differs && other.is_some_and(|o| o.views.is_some()) {
                let name = cx.state.compare.names()[0];
                let text = tf!("in colour: differs from “{other}”  ·  grey: alike", other = name);
                tag(ui, area.left_bottom() + egui::vec2(4.0, -22.0), &text, false);
            }
        }
    }
    // The row above the strip shows the progress; the pane of a single camera has no such row.
    if single && now.stale && now.view == learned::VIEW.id {
        let line = Rect::from_min_max(area.left_bottom() - egui::vec2(0.0, 24.0), area.right_bottom());
        in_rect(ui, line, |ui| {
            ui.painter()
                .rect_filled(line, 3.0, egui::Color32::from_black_alpha(170));
            ui.horizontal_centered(|ui| {
                ui.add_space(6.0);
                progress(ui, &now, commands);
            });
        });
    }
}
