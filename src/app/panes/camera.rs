//! One camera of the rig, as large as its pane.

use egui::Ui;

use scene::Scene;

use super::camera_strip::camera_label;
use super::cameras::compared;
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::Command;
use crate::state::CameraMode;
use crate::widgets::icons::Icon;

/// The camera of this index.
pub struct Camera(pub u8);

impl Pane for Camera {
    fn id(&self) -> PaneId {
        PaneId::of_camera(self.0)
    }

    fn title(&self) -> String {
        format!("Camera {}", usize::from(self.0) + 1)
    }

    fn title_in(&self, scene: &Scene) -> String {
        match scene.rig.cameras.get(usize::from(self.0)) {
            Some(camera) => format!("Camera: {}", camera_label(&camera.name)),
            None => self.title(),
        }
    }

    fn icon(&self) -> Icon {
        Icon::Camera
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let modes = [
            (CameraMode::Semantic, "Semantic"),
            (CameraMode::Depth, "Depth"),
            (CameraMode::Picture, "Picture"),
            (CameraMode::Planes, "Planes"),
            (CameraMode::Layout, "Boxes, lanes"),
        ];
        let shown = modes.iter().find(|(mode, _)| *mode == cx.state.camera_mode);
        egui::ComboBox::from_id_salt("camera mode")
            .selected_text(shown.map_or("", |(_, name)| name))
            .width(96.0)
            .show_ui(ui, |ui| {
                for (mode, name) in modes {
                    ui.selectable_value(&mut cx.state.camera_mode, mode, name);
                }
            })
            .response
            .accessible_name("Camera picture");
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        compared(ui, cx, Some(usize::from(self.0)), commands);
    }
}
