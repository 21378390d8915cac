//! The fields of a radar in the window of the sensors.

use egui::Ui;

use super::sensors::{aim_rows, changed, mount, name_row};
use crate::command::Command;
use crate::fields::{caption, field, number};
use language::{t, tf};
use scene::rig_presets::RADARS;
use scene::{RadarPattern, SensorRig};
use widgets::icons::section;
use widgets::theme;

/// Draws them; an edit goes into `commands`.
pub(super) fn fields(
    ui: &mut Ui,
    rig: &SensorRig,
    index: usize,
    radar: &RadarPattern,
    commands: &mut Vec<Command>,
) {
    section(ui, &radar.name);
    let mut new = radar.clone();
    let set = |new: RadarPattern| changed(rig, |r| r.radars[index] = new);
    if name_row(ui, &mut new.name) {
        commands.push(Command::Apply("Rename sensor", vec![set(new.clone())]));
    }
    ui.horizontal(|ui| {
        caption(ui, t("Pattern"));
        let known = RADARS.iter().find(|preset| is_of(radar, &(preset.build)()));
        let name = known.map_or(t("Other"), |preset| t(preset.name));
        ui.menu_button(name, |ui| {
            for preset in &RADARS {
                if ui.button(t(preset.name)).clicked() {
                    // The pattern changes, the mount stays.
                    let pattern = mounted((preset.build)(), &new);
                    commands.push(Command::Apply("Change pattern", vec![set(pattern)]));
                    ui.close();
                }
            }
        });
    });
    let moved = mount(ui, &mut new.translation_m);
    field(&moved, "Move sensor", set(new.clone()), commands);
    let mut aim = new.aim();
    let turned = aim_rows(ui, &mut aim);
    if turned.changed() {
        new.set_aim(aim);
    }
    field(&turned, "Aim sensor", set(new.clone()), commands);
    let reach = number(
        ui,
        t("Finds a car"),
        t("Distance at which a car is found in every other scan"),
        &mut new.car_range_m,
        5.0..=1000.0,
        " m",
        0,
    );
    field(&reach, "Change range", set(new.clone()), commands);
    let mut most = f64::from(new.most_returns);
    let returns = number(
        ui,
        t("Returns"),
        t("Most returns of a scan"),
        &mut most,
        1.0..=10_000.0,
        "",
        0,
    );
    new.most_returns = most as u32;
    field(&returns, "Change returns", set(new.clone()), commands);
    super::sensors::speed_row(ui, rig, commands);
    let text = tf!(
        "±{azimuth}°, up to {range} m, {speed} m/s apart",
        azimuth = format!("{:.0}", radar.half_azimuth_deg()),
        range = format!("{:.0}", radar.max_range_m()),
        speed = format!("{:.2}", radar.speed_step_mps)
    );
    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
}

/// A pattern on the mount of another radar, with its name.
fn mounted(pattern: RadarPattern, on: &RadarPattern) -> RadarPattern {
    RadarPattern {
        name: on.name.clone(),
        rotation_wxyz: on.rotation_wxyz,
        translation_m: on.translation_m,
        ..pattern
    }
}

fn is_of(radar: &RadarPattern, pattern: &RadarPattern) -> bool {
    mounted(pattern.clone(), radar) == *radar
}
