//! One camera of the rig, as large as its pane, with a view of its own.

use egui::Ui;

use scene::Scene;

use super::camera_header::light_menu;
use super::camera_strip::{CameraStrip, is_large};
use super::cameras::{Strips, compared};
use super::conditions::conditions;
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::camera_views::camera_label;
use crate::camera_views::offered_views;
use crate::command::{Command, FileCommand};
use language::{t, tf};
use sensors::cameras;
use widgets::icons::{self, Icon};

/// Frames after which a pane that was not drawn is no longer rendered for.
const FRAMES: u8 = 3;
/// Width of the light menu with its name, points.
const LIGHT_POINTS: f32 = 72.0;
/// Width of an icon with its distance to the next, points.
const ICON_POINTS: f32 = 32.0;
/// Width of the list of views, and its least readable width, points.
const MODES_POINTS: f32 = 124.0;
const LEAST_MODES_POINTS: f32 = 56.0;

/// The pane of a camera index. The user can show another camera in it.
pub struct Camera {
    index: u8,
    strip: CameraStrip,
    before: CameraStrip,
}

impl Camera {
    /// The pane of a camera index.
    pub fn new(index: u8) -> Self {
        Self {
            index,
            strip: CameraStrip::default(),
            before: CameraStrip::default(),
        }
    }
}

impl Pane for Camera {
    fn id(&self) -> PaneId {
        PaneId::of_camera(self.index)
    }

    fn title(&self) -> String {
        format!("Camera {}", usize::from(self.index) + 1)
    }

    fn title_in(&self, scene: &Scene) -> String {
        match scene.rig.cameras.get(usize::from(self.index)) {
            Some(camera) => tf!("Camera: {name}", name = camera_label(&camera.name)),
            None => t(&self.title()).to_owned(),
        }
    }

    fn icon(&self) -> Icon {
        Icon::Camera
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let rig = &cx.scene.rig;
        let count = rig.cameras.len();
        let (camera, view) = cx.state.cameras.of_pane(self.index, count);
        let chosen = cx.state.cameras.own.get(&self.index).and_then(|own| own.view);
        let views = offered_views(
            cx.state.cameras.offers_learned,
            chosen.unwrap_or(cx.state.cameras.view),
        );
        let strip = cx.state.cameras.view;
        let own = cx.state.cameras.own.entry(self.index).or_default();
        let title = |id| views.iter().find(|v| v.id == id).map_or("", |v| v.title);
        let selected = match own.view {
            Some(id) => t(title(id)).to_owned(),
            None => tf!("{view} (all)", view = t(title(strip))),
        };
        // Laid out from right to left. The pane may show another camera than the one in its name.
        let name = rig
            .cameras
            .get(camera)
            .map_or(String::new(), |c| camera_label(&c.name));
        let source = cameras::source_of(view, cx.state.cameras.source);
        let lit = source.about().needs.conditions;
        // The title comes first. Buttons without room beside it are left out; those that are also found elsewhere go
        // first.
        let mut room = ui.available_width() - MODES_POINTS - if lit { ICON_POINTS } else { 0.0 };
        let mut fits = |n: f32| {
            room -= n * ICON_POINTS;
            room >= 0.0
        };
        let [steps, legend, save] = [fits(2.0), fits(1.0), fits(1.0)];
        if save
            && icons::button(
                ui,
                Icon::Camera,
                t("Save picture"),
                t("as it is shown, beside the scene; File > Pictures… has other sizes"),
                false,
                count > 0,
            )
            .clicked()
        {
            commands.push(Command::File(FileCommand::SavePicture(camera, view)));
        }
        if legend {
            let (name, hint) = (t("Legend"), t("what the colours mean"));
            if icons::button(ui, Icon::List, name, hint, own.legend, true).clicked() {
                own.legend = !own.legend;
            }
        }
        if steps {
            if icons::button(ui, Icon::StepForward, t("Next camera"), &name, false, count > 1).clicked() {
                own.on_by = step(own.on_by, count, true);
            }
            if icons::button(ui, Icon::StepBack, t("Previous camera"), &name, false, count > 1).clicked() {
                own.on_by = step(own.on_by, count, false);
            }
        }
        let left = ui.available_width() - if lit { ICON_POINTS } else { 0.0 };
        if left >= LEAST_MODES_POINTS {
            egui::ComboBox::from_id_salt(("camera mode", self.index))
                .selected_text(selected)
                .width((left - 8.0).min(112.0))
                .truncate()
                .show_ui(ui, |ui| {
                    ui.selectable_value(&mut own.view, None, t("As in the strip"))
                        .on_hover_text(t("What all cameras show"));
                    for view in &views {
                        ui.selectable_value(&mut own.view, Some(view.id), t(view.title))
                            .on_hover_text(t(view.hint));
                    }
                })
                .response
                .accessible_name(t("Camera picture"));
        }
        if lit {
            let short = ui.available_width() < LIGHT_POINTS;
            light_menu(ui, short, |ui| conditions(ui, cx.scene, commands));
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let count = cx.scene.rig.cameras.len();
        let (camera, view) = cx.state.cameras.of_pane(self.index, count);
        let own = cx.state.cameras.own.entry(self.index).or_default();
        own.drawn = FRAMES;
        let room = ui.available_size();
        let shape = cx.scene.rig.cameras.get(camera);
        let aspect = shape.map_or(16.0 / 9.0, |c| c.width as f32 / c.height.max(1) as f32);
        own.large = is_large(ui, room.x.min(room.y * aspect));
        self.strip.set_legend(own.legend.then_some(camera));
        // A camera index beyond the rig is reported as missing.
        let camera = if usize::from(self.index) < count {
            camera
        } else {
            self.index.into()
        };
        let strips = Strips {
            now: &mut self.strip,
            before: &mut self.before,
            camera,
            view,
        };
        compared(ui, cx, Some(strips), commands);
    }
}

/// The next camera, or the previous one.
fn step(on_by: u8, count: usize, forward: bool) -> u8 {
    let count = count.clamp(1, 255) as u8;
    let by = if forward { 1 } else { count - 1 };
    ((u16::from(on_by) + u16::from(by)) % u16::from(count)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_and_previous_go_around() {
        assert_eq!((step(5, 6, true), step(0, 6, false), step(0, 1, true)), (0, 5, 0));
        assert_eq!((step(0, 0, true), step(250, 300, true)), (0, 251));
    }
}
