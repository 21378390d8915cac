//! Fields for the conditions of the scene: time of day, weather, wetness, visibility, sun and seed.

use egui::containers::menu::is_in_menu;
use egui::{DragValue, Ui};

use crate::command::Command;
use crate::fields::{fields, number};
use editor::Edit;
use language::t;
use scene::{Conditions, Scene, Sun, TimeOfDay, Weather};
use widgets::theme;

/// Name of the undo step.
const STEP: &str = "Change weather";

/// Draws time and weather in a row, and a menu with the other fields.
pub fn conditions(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let now = scene.conditions;
    let (mut time, mut weather) = (now.time, now.weather);
    if is_in_menu(ui) {
        listed(ui, &mut time, &mut weather);
    } else {
        dropped_down(ui, &mut time, &mut weather);
    }
    if (time, weather) != (now.time, now.weather) {
        commands.push(becomes(scene, time, weather));
    }
    widgets::menu::with_fields(ui, t("Air and sun…"), |ui| air_and_sun(ui, now, commands))
        .on_hover_text(t("Wet ground, visibility, sun and seed of the pictures"));
}

/// Lists every time of day and every weather, each one click away. A menu cannot hold a drop-down list: only one of the
/// two can be open.
fn listed(ui: &mut Ui, time: &mut TimeOfDay, weather: &mut Weather) {
    widgets::menu::side_by_side(
        ui,
        |ui| {
            ui.label(egui::RichText::new(t("Time of day")).color(theme::text_weak()));
            for value in TimeOfDay::ALL {
                ui.selectable_value(time, value, theme::sentence(t(value.name())));
            }
        },
        |ui| {
            ui.label(egui::RichText::new(t("Weather")).color(theme::text_weak()));
            for value in Weather::ALL {
                ui.selectable_value(weather, value, theme::sentence(t(value.name())));
            }
        },
    );
    ui.separator();
}

fn dropped_down(ui: &mut Ui, time: &mut TimeOfDay, weather: &mut Weather) {
    egui::ComboBox::from_id_salt("time of day")
        .width(80.0)
        .selected_text(theme::sentence(t(time.name())))
        .show_ui(ui, |ui| {
            for value in TimeOfDay::ALL {
                ui.selectable_value(time, value, theme::sentence(t(value.name())));
            }
        });
    egui::ComboBox::from_id_salt("weather")
        .width(100.0)
        .selected_text(theme::sentence(t(weather.name())))
        .show_ui(ui, |ui| {
            for value in Weather::ALL {
                ui.selectable_value(weather, value, theme::sentence(t(value.name())));
            }
        });
}

/// The command that sets time of day and weather, also in the words of the scene's style.
pub fn becomes(scene: &Scene, time: TimeOfDay, weather: Weather) -> Command {
    let prompt = with_conditions(&scene.prompt, time.name(), weather.name());
    let conditions = scene.conditions.at(time).under(weather);
    Command::Apply(
        STEP,
        vec![Edit::SetPrompt { prompt }, Edit::SetConditions { conditions }],
    )
}

/// Fields for the numbers behind time of day and weather.
fn air_and_sun(ui: &mut Ui, now: Conditions, commands: &mut Vec<Command>) {
    let mut new = now;
    let mut response = number(
        ui,
        t("Wet"),
        t("Wetness of the ground"),
        &mut new.wetness,
        0.0..=1.0,
        "",
        2,
    );
    let [near, far] = Conditions::VISIBILITY_M;
    response |= number(
        ui,
        t("Sight"),
        t("Visibility, m"),
        &mut new.visibility_m,
        near..=far,
        " m",
        0,
    );
    let mut placed = now.sun.is_some();
    response |= ui
        .checkbox(&mut placed, t("Place the sun"))
        .on_hover_text(t("Else it stands as the time of day has it"));
    new.sun = placed.then(|| {
        now.sun.unwrap_or(Sun {
            azimuth_deg: 0.0,
            elevation_deg: 30.0,
        })
    });
    if let Some(sun) = &mut new.sun {
        let azimuth = &mut sun.azimuth_deg;
        response |= number(
            ui,
            t("Azimuth"),
            t("Azimuth of the sun"),
            azimuth,
            -180.0..=180.0,
            "°",
            0,
        );
        let elevation = &mut sun.elevation_deg;
        response |= number(
            ui,
            t("Height"),
            t("Elevation of the sun"),
            elevation,
            0.0..=90.0,
            "°",
            0,
        );
    }
    response |= ui
        .horizontal(|ui| {
            crate::fields::caption(ui, t("Seed"));
            let seed = DragValue::new(&mut new.seed)
                .speed(0.05)
                .update_while_editing(false);
            ui.add_sized([86.0, theme::ROW], seed)
                .accessible_name(t("Seed of the pictures"))
        })
        .inner;
    let edit = Edit::SetConditions { conditions: new };
    fields(&response, STEP, vec![edit], commands);
}

/// The style text with its phrases about time and weather replaced; other phrases stay as they are.
fn with_conditions(prompt: &str, time: &str, weather: &str) -> String {
    let speaks =
        |phrase: &&str| words::conditions::read(phrase) != words::conditions::StatedConditions::default();
    let phrases = prompt.split(',').map(str::trim).filter(|p| !p.is_empty());
    let mut kept: Vec<&str> = phrases.filter(|p| !speaks(p)).collect();
    kept.extend([time, weather]);
    kept.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use words::conditions::read;

    #[test]
    fn other_phrases_stay() {
        let prompt = with_conditions("busy market, rainy evening, red cars", "night", "snow");
        assert_eq!(prompt, "busy market, red cars, night, snow");
        for time in TimeOfDay::ALL {
            for weather in Weather::ALL {
                let again = with_conditions(&prompt, time.name(), weather.name());
                let found = read(&again);
                assert_eq!(
                    (found.time, found.weather),
                    (Some(time), Some(weather)),
                    "{again}"
                );
            }
        }
        assert_eq!(with_conditions("", "day", "clear"), "day, clear");
    }
}
