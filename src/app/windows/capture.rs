//! The dialog of pictures: subject, size and annotations; also a turntable of the 3D view.

use egui::{DragValue, Ui, Window};

use crate::camera_views::camera_label;
use crate::camera_views::offered_views;
use crate::capture::{CaptureOptions, Subject};
use crate::command::{Command, FileCommand};
use language::{t, tf};
use scene::{Camera, Scene};
use widgets::icons::section;
use widgets::theme;

/// Settings of the dialog.
#[derive(Clone, Debug)]
pub struct CaptureDialog {
    /// True if it is shown.
    pub open: bool,
    /// Options of the picture.
    pub options: CaptureOptions,
    /// True for a turntable of the 3D view.
    pub turns: bool,
    /// Duration of the turntable, s.
    pub seconds: f64,
    /// True for moving pictures of the scene from its first moment to its last; see [`Self::is_clip`].
    pub moves: bool,
    /// The camera of moving pictures; all if `None`.
    pub camera: Option<usize>,
}

impl CaptureDialog {
    /// True if a clip of the scene is saved, not one picture or a turntable.
    pub fn is_clip(&self) -> bool {
        self.moves && !self.turns && Self::can_move(self.options.subject)
    }

    /// True for subjects that a clip can show.
    fn can_move(subject: Subject) -> bool {
        matches!(subject, Subject::View | Subject::Map | Subject::Cameras)
    }

    /// Shows the dialog with moving pictures chosen.
    pub fn open_for_clip(&mut self) {
        (self.open, self.turns, self.moves) = (true, false, true);
        if !Self::can_move(self.options.subject) {
            self.options.subject = Subject::View;
        }
    }
}

impl Default for CaptureDialog {
    fn default() -> Self {
        Self {
            open: false,
            options: CaptureOptions::default(),
            turns: false,
            seconds: 6.0,
            moves: false,
            camera: None,
        }
    }
}

/// Usual sizes of the 3D view or a map, with their names.
const SIZES: [(&str, [u32; 2]); 5] = [
    ("HD", [1280, 720]),
    ("Full HD", [1920, 1080]),
    ("4K", [3840, 2160]),
    ("Square", [2048, 2048]),
    ("A4 at 300 dpi", [3508, 2480]),
];
/// Usual sizes of a camera picture.
const CAMERA_SIZES: [(&str, [u32; 2]); 3] = [
    ("Small", [400, 225]),
    ("Medium", [800, 450]),
    ("Whole", [1600, 900]),
];
/// Largest side that can be set, pixels.
const MOST_PX: u32 = 16_384;

/// Draws the dialog while it is open.
pub fn capture_ui(
    ui: &Ui,
    dialog: &mut CaptureDialog,
    (scene, learned): (&Scene, bool),
    commands: &mut Vec<Command>,
) {
    if !dialog.open {
        return;
    }
    let mut open = true;
    Window::new(t("Pictures"))
        .id(egui::Id::unique("pictures"))
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos(ui.max_rect().center() - egui::vec2(210.0, 200.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(420.0);
            subject(ui, dialog, (scene, learned));
            section(ui, t("Size"));
            sizes(ui, dialog);
            if !dialog.is_clip() {
                section(ui, t("With"));
                beside(ui, dialog);
            }
            ui.add_space(theme::GAP);
            ui.horizontal(|ui| {
                let name = match (dialog.turns, dialog.is_clip()) {
                    (true, _) => t("Save turn…"),
                    (_, true) => t("Save moving pictures…"),
                    _ => t("Save picture…"),
                };
                let accent = egui::Button::new(egui::RichText::new(name).color(theme::text_strong()));
                if ui.add(accent.fill(theme::accent_fill())).clicked() {
                    commands.push(Command::File(FileCommand::AskCapture));
                }
                ui.weak(match dialog.turns || dialog.is_clip() {
                    true => t("GIF, MP4 or APNG, by the ending of the file"),
                    false => t("PNG with the scene inside: opening it opens the scene"),
                });
            });
        });
    dialog.open &= open;
}

fn subject(ui: &mut Ui, dialog: &mut CaptureDialog, (scene, learned): (&Scene, bool)) {
    let options = &mut dialog.options;
    ui.horizontal_wrapped(|ui| {
        for (subject, _, title) in Subject::ALL {
            let chosen = options.subject == subject && !(dialog.turns && subject == Subject::View);
            if ui.selectable_label(chosen, t(title)).clicked() {
                (options.subject, dialog.turns) = (subject, false);
            }
        }
        if ui
            .selectable_label(dialog.turns, t("Turntable"))
            .on_hover_text(t("The 3D view turned once around what it looks at"))
            .clicked()
        {
            (options.subject, dialog.turns) = (Subject::View, true);
        }
    });
    ui.add_space(theme::GAP / 2.0);
    match options.subject {
        Subject::View => {
            ui.weak(t("Seen as the 3D view shows it now."));
        }
        Subject::Cameras => {
            ui.horizontal(|ui| {
                ui.label(t("Showing"));
                for view in offered_views(learned, options.view) {
                    ui.selectable_value(&mut options.view, view.id, t(view.title))
                        .on_hover_text(t(view.hint));
                }
            });
        }
        _ => {
            ui.weak(t("Seen from above, ahead is up."));
        }
    }
    if !dialog.turns && CaptureDialog::can_move(dialog.options.subject) {
        ui.checkbox(&mut dialog.moves, t("Moving, from the first moment to the last"))
            .on_hover_text(t(
                "What the timeline plays; the 3D view goes along if it does so there",
            ));
        if dialog.is_clip() && dialog.options.subject == Subject::Cameras {
            cameras_of(ui, &mut dialog.camera, &scene.rig.cameras);
        }
    }
    ui.add_space(theme::GAP / 2.0);
}

/// The choice of the cameras in a clip.
fn cameras_of(ui: &mut Ui, chosen: &mut Option<usize>, cameras: &[Camera]) {
    *chosen = chosen.filter(|i| *i < cameras.len());
    let name = |i: Option<usize>| match i.and_then(|i| cameras.get(i)) {
        Some(camera) => camera_label(&camera.name),
        None => t("All cameras").to_owned(),
    };
    egui::ComboBox::from_id_salt("camera of the clip")
        .selected_text(name(*chosen))
        .show_ui(ui, |ui| {
            for i in std::iter::once(None).chain((0..cameras.len()).map(Some)) {
                ui.selectable_value(chosen, i, name(i));
            }
        });
}

fn sizes(ui: &mut Ui, dialog: &mut CaptureDialog) {
    let options = &mut dialog.options;
    let of_cameras = options.subject == Subject::Cameras;
    let (size, usual) = match of_cameras {
        true => (&mut options.camera_size, &CAMERA_SIZES[..]),
        false => (&mut options.shot.size, &SIZES[..]),
    };
    ui.horizontal(|ui| {
        let names = [t("Width"), t("Height")];
        for (side, name) in size.iter_mut().zip(names) {
            ui.add(DragValue::new(side).range(16..=MOST_PX).speed(4.0).suffix(" px"))
                .accessible_name(name);
        }
        egui::ComboBox::from_id_salt("usual sizes")
            .selected_text(t("Usual sizes"))
            .show_ui(ui, |ui| {
                for (name, usual) in usual {
                    let text = tf!("{name}, {w} × {h}", name = t(name), w = usual[0], h = usual[1]);
                    ui.selectable_value(size, *usual, text);
                }
            });
    });
    if of_cameras {
        ui.weak(match dialog.moves {
            true => t("Of each camera."),
            false => t("Of each camera; the sheet has three in a row."),
        });
    }
    if dialog.turns {
        ui.horizontal(|ui| {
            ui.label(t("One turn takes"));
            ui.add(
                DragValue::new(&mut dialog.seconds)
                    .range(1.0..=30.0)
                    .speed(0.1)
                    .suffix(" s"),
            )
            .accessible_name(t("One turn takes"));
        });
    }
    ui.add_space(theme::GAP / 2.0);
}

fn beside(ui: &mut Ui, dialog: &mut CaptureDialog) {
    let options = &mut dialog.options;
    ui.horizontal_wrapped(|ui| {
        if options.subject == Subject::View {
            ui.checkbox(&mut options.shot.boxes, t("Boxes"));
            ui.checkbox(&mut options.shot.lidar, t("LiDAR"));
            if !dialog.turns {
                ui.checkbox(&mut options.shot.transparent, t("Transparent background"));
            }
        }
        if !dialog.turns {
            ui.checkbox(&mut options.legend, t("Names, legend and scale"));
        }
    });
    if options.subject == Subject::View {
        ui.horizontal(|ui| {
            ui.label(t("Samples per axis"));
            ui.add(DragValue::new(&mut options.shot.supersample).range(1..=8))
                .on_hover_text(t("More make edges smoother and take longer"))
                .accessible_name(t("Samples per axis"));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clip_shows_what_can_move() {
        let mut dialog = CaptureDialog::default();
        assert!(!dialog.is_clip());
        dialog.options.subject = Subject::Lidar;
        dialog.turns = true;
        dialog.open_for_clip();
        assert!(dialog.is_clip() && dialog.open && dialog.options.subject == Subject::View);
        dialog.options.subject = Subject::Map;
        assert!(dialog.is_clip());
        // Settings for one subject do not count for others.
        dialog.options.subject = Subject::Occupancy;
        assert!(!dialog.is_clip());
    }
}
