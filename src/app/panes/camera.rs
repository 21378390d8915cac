//! One camera of the rig, as large as its pane.

use egui::Ui;

use scene::Scene;

use super::camera_strip::camera_label;
use super::cameras::compared;
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::Command;
use widgets::icons::Icon;

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
        let views = sensors::cameras::views();
        let shown = views.iter().find(|view| view.id == cx.state.cameras.view);
        egui::ComboBox::from_id_salt("camera mode")
            .selected_text(shown.map_or("", |view| view.title))
            .width(96.0)
            .show_ui(ui, |ui| {
                for view in &views {
                    ui.selectable_value(&mut cx.state.cameras.view, view.id, view.title);
                }
            })
            .response
            .accessible_name("Camera picture");
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        compared(ui, cx, Some(usize::from(self.0)), commands);
    }
}
