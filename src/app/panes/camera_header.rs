//! The row above the camera strip: what the pictures show, and the knob that belongs to it.

use egui::Ui;

use crate::command::{Command, Window};
use crate::state::UiState;
use crate::theme;
use crate::widgets::icons;
use editor::Edit;
use sensors::appearance::{Conditions, TimeOfDay, Weather};
use sensors::cameras::{self, Knob};

use super::camera_strip::{CamerasInput, thousands};

/// Width that the button of the sensors takes, points.
const SENSORS_BUTTON: f32 = 84.0;
/// Width that the number of LiDAR returns takes, points.
const LIDAR_TEXT: f32 = 130.0;

/// Draws the row.
pub fn header(
    ui: &mut Ui,
    input: &CamerasInput<'_>,
    stale: bool,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let views = cameras::views();
        let choices: Vec<_> = views.iter().map(|v| (v.id, v.title, v.hint)).collect();
        icons::segments(ui, &mut state.camera_view, &choices);
        ui.add_space(8.0);
        let sources = cameras::sources_of(state.camera_view);
        if sources.len() > 1 {
            let choices: Vec<_> = sources.iter().map(|s| (s.id(), s.title(), s.hint())).collect();
            icons::segments(ui, &mut state.camera_source, &choices);
        }
        if state.shown_source().needs().conditions {
            conditions(ui, input.prompt, commands);
        }
        match views
            .iter()
            .find(|v| v.id == state.camera_view)
            .and_then(|v| v.knob)
        {
            Some(Knob::PlaneDepth) => {
                let slider = egui::Slider::new(&mut state.plane_m, 0.2..=51.0)
                    .suffix(" m")
                    .fixed_decimals(1);
                ui.spacing_mut().slider_width = 220.0;
                ui.add(slider).on_hover_text("Depth of the plane");
            }
            None => {}
        }
        if stale {
            ui.add_space(4.0);
            ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()));
            ui.label(egui::RichText::new("updating").small().color(theme::text_weak()));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // The menu has it too.
            if ui.available_width() > SENSORS_BUTTON && ui.button("Sensors…").clicked() {
                commands.push(Command::Toggle(Window::Sensors));
            }
            let text = input
                .lidar_points
                .map(|n| format!("LiDAR  {} returns", thousands(n)));
            // Only where it hides no button.
            if let Some(text) = text.filter(|_| ui.available_width() > LIDAR_TEXT) {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
        });
    });
}

/// Time and weather, which stand in the scene's prompt.
fn conditions(ui: &mut Ui, prompt: &str, commands: &mut Vec<Command>) {
    let now = Conditions::from_prompt(prompt);
    let name =
        |all: &[(&'static str, TimeOfDay)], v| all.iter().find(|(_, t)| *t == v).map_or("", |(n, _)| *n);
    let (mut time, mut weather) = (now.time, now.weather);
    egui::ComboBox::from_id_salt("time of day")
        .width(80.0)
        .selected_text(theme::sentence(name(&TimeOfDay::ALL, time)))
        .show_ui(ui, |ui| {
            for (name, value) in TimeOfDay::ALL {
                ui.selectable_value(&mut time, value, theme::sentence(name));
            }
        });
    let weather_name = |v| Weather::ALL.iter().find(|(_, w)| *w == v).map_or("", |(n, _)| *n);
    egui::ComboBox::from_id_salt("weather")
        .width(100.0)
        .selected_text(theme::sentence(weather_name(weather)))
        .show_ui(ui, |ui| {
            for (name, value) in Weather::ALL {
                ui.selectable_value(&mut weather, value, theme::sentence(name));
            }
        });
    if (time, weather) != (now.time, now.weather) {
        let prompt = with_conditions(prompt, name(&TimeOfDay::ALL, time), weather_name(weather));
        commands.push(Command::Apply("Change weather", vec![Edit::SetPrompt { prompt }]));
    }
}

/// The prompt with its phrases about time and weather replaced; the others stay as they are.
fn with_conditions(prompt: &str, time: &str, weather: &str) -> String {
    // A phrase speaks of time or weather if it changes them away from each of two settings.
    let speaks = |phrase: &&str| {
        ["night, fog", "dawn, snow"].iter().any(|base| {
            let with = format!("{phrase}, {base}");
            Conditions::from_prompt(&with) != Conditions::from_prompt(base)
        })
    };
    let phrases = prompt.split(',').map(str::trim).filter(|p| !p.is_empty());
    let mut kept: Vec<&str> = phrases.filter(|p| !speaks(p)).collect();
    kept.extend([time, weather]);
    kept.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_phrases_stay() {
        let prompt = with_conditions("busy market, rainy evening, red cars", "night", "snow");
        assert_eq!(prompt, "busy market, red cars, night, snow");
        for (time_name, time) in TimeOfDay::ALL {
            for (weather_name, weather) in Weather::ALL {
                let again = with_conditions(&prompt, time_name, weather_name);
                let found = Conditions::from_prompt(&again);
                assert_eq!((found.time, found.weather), (time, weather), "{again}");
            }
        }
        assert_eq!(with_conditions("", "day", "clear"), "day, clear");
    }
}
