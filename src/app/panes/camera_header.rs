//! The row above the camera strip: the view, and the control that belongs to it.

use egui::Ui;

use crate::camera_views::CamerasShown;
use crate::camera_views::offered_views;
use crate::command::{Command, ViewCommand, Window};
use crate::sensing::PaintStage;
use language::{t, tf};
use sensors::cameras::{self, Knob, ViewId, learned};
use widgets::icons::{self, Icon};
use widgets::theme;

use super::camera_strip::{CamerasInput, thousands};
use super::conditions::conditions;

/// Width of the button of the sensors, points.
const SENSORS_BUTTON: f32 = 84.0;
/// Width of the number of LiDAR returns, points.
const LIDAR_TEXT: f32 = 130.0;

/// Width of the row of sources, and of the list that replaces it, points.
const SOURCES: f32 = 270.0;
const FOLDED: f32 = 130.0;
/// Widths of the fields for light and weather, of the menu with them, and of the short menu, points.
const LIGHT: [f32; 3] = [310.0, 76.0, 36.0];
/// Width of the progress of pictures; the second is for painted pictures, with the button that stops them, points.
const UPDATING: f32 = 90.0;
const PAINTING: f32 = 170.0;

/// Size of the spinner, points.
const SPINNER: f32 = 12.0;

/// Draws the progress of newer pictures. Painting can be stopped, and resumed.
pub(super) fn progress(ui: &mut Ui, input: &CamerasInput<'_>, commands: &mut Vec<Command>) {
    let weak = |text: String| egui::RichText::new(text).small().color(theme::text_weak());
    let paints = input.view == learned::VIEW.id;
    // Buttons come before texts that change, so they stay under the pointer.
    if paints && input.stopped {
        ui.allocate_exact_size(egui::Vec2::splat(SPINNER), egui::Sense::hover());
        if ui.small_button(t("Go on")).clicked() {
            commands.push(Command::View(ViewCommand::PaintAgain));
        }
        ui.label(weak(t("stopped").to_owned()));
        return;
    }
    let stage = input.paint_stage.filter(|_| paints);
    let text = match stage {
        Some(PaintStage::Opening) => t("opening the weights").to_owned(),
        Some(PaintStage::Step(step, steps)) => tf!("painting, {step} of {steps}", step = step, steps = steps),
        Some(PaintStage::Stopping) => t("stopping after this step").to_owned(),
        None => t("updating").to_owned(),
    };
    ui.add(egui::Spinner::new().size(SPINNER).color(theme::text_weak()));
    if stage.is_some_and(|stage| stage != PaintStage::Stopping) {
        let stop = ui.small_button(t("Stop"));
        let hint = t("The pictures stay as they are by now until something changes");
        if stop.on_hover_text(hint).clicked() {
            commands.push(Command::View(ViewCommand::StopPainting));
        }
    }
    ui.label(weak(text));
}

/// The menu with time of day and weather; if `short`, with an icon in place of its name.
pub(super) fn light_menu(ui: &mut Ui, short: bool, content: impl FnOnce(&mut Ui)) {
    let (name, hint) = (t("Light…"), t("Time of day and weather of the scene"));
    if short {
        widgets::menu::of_icon(ui, Icon::Sun, name, hint, content);
    } else {
        widgets::menu::with_fields(ui, name, content)
            .on_hover_text(hint)
            .accessible_name(name);
    }
}

/// Division of the row.
struct Room {
    /// Width of the views, points; they fold into a list if it is too small for them.
    views: f32,
    /// Width of the sources, points; they fold likewise.
    sources: f32,
    /// Index into [`LIGHT`].
    light: usize,
}

impl Room {
    fn measure<T>(ui: &Ui, choices: &[(T, &str, &str)], sources: usize, lit: bool, view: ViewId) -> Self {
        let news = match view == learned::VIEW.id {
            true => PAINTING,
            false => UPDATING,
        };
        let all = ui.available_width() - news;
        let side_by_side = icons::segments_width(ui, choices);
        let from = match sources {
            ..=1 => 0.0,
            _ if all >= side_by_side + SOURCES + SENSORS_BUTTON => SOURCES,
            _ => FOLDED,
        };
        let left = |light: usize| all - from - if lit { LIGHT[light] } else { 0.0 };
        // First all views side by side, then the fields for the light, then the menu for the light.
        let fits = |views: f32| (0..LIGHT.len()).find(|light| left(*light) >= views);
        let light = fits(side_by_side).or_else(|| fits(FOLDED));
        let light = light.unwrap_or(LIGHT.len() - 1);
        Self {
            views: left(light).max(0.0),
            sources: from,
            light,
        }
    }
}

/// Draws the row.
pub fn header(
    ui: &mut Ui,
    input: &CamerasInput<'_>,
    stale: bool,
    shown: &mut CamerasShown,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let views = offered_views(shown.offers_learned, shown.view);
        let choices: Vec<_> = views.iter().map(|v| (v.id, t(v.title), t(v.hint))).collect();
        let sources = cameras::sources_of(shown.view);
        let lit = shown.shown_source().about().needs.conditions;
        let room = Room::measure(ui, &choices, sources.len(), lit, shown.view);
        ui.scope(|ui| {
            ui.set_max_width(room.views);
            icons::choice(ui, &mut shown.view, &choices, t("Cameras"));
        });
        ui.add_space(8.0);
        if sources.len() > 1 {
            let choices: Vec<_> = sources
                .iter()
                .map(|s| (s.id(), t(s.about().title), t(s.about().hint)))
                .collect();
            ui.scope(|ui| {
                ui.set_max_width(room.sources);
                icons::choice(ui, &mut shown.source, &choices, t("From"));
            });
        }
        if lit {
            match room.light {
                0 => conditions(ui, input.scene, commands),
                short => light_menu(ui, short > 1, |ui| conditions(ui, input.scene, commands)),
            }
        }
        match views.iter().find(|v| v.id == shown.view).and_then(|v| v.knob) {
            Some(Knob::PlaneDepth) => {
                let slider = egui::Slider::new(&mut shown.plane_m, 0.2..=51.0)
                    .suffix(" m")
                    .fixed_decimals(1);
                ui.spacing_mut().slider_width = 220.0;
                ui.add(slider).on_hover_text(t("Depth of the plane"));
            }
            None => {}
        }
        if stale {
            ui.add_space(4.0);
            progress(ui, input, commands);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // The button is left out in a narrow row; the menu has it too.
            if ui.available_width() > SENSORS_BUTTON && ui.button(t("Sensors…")).clicked() {
                commands.push(Command::Toggle(Window::Sensors));
            }
            let text = input
                .lidar_points
                .map(|n| tf!("LiDAR  {n} returns", n = thousands(n)));
            // Drawn only where it hides no button.
            if let Some(text) = text.filter(|_| ui.available_width() > LIDAR_TEXT) {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
        });
    });
}
