//! The window in which the vehicle's sensors are placed, aimed, added and removed.

use egui::Ui;
use glam::DVec3;

use super::lens;
use super::open::{OpenWindows, SensorChoice};
use crate::camera_views::CamerasShown;
use crate::camera_views::camera_label;
use crate::command::{Command, FileCommand};
use crate::fields::{caption, field, number, numbers};
use editor::Edit;
use language::{t, tf};
use scene::rig::Aim;
use scene::rig_presets::{LIDARS, RADARS, RIGS};
use scene::{Camera, LidarPattern, RadarPattern, SensorRig};
use widgets::icons::{self, Icon, section};
use widgets::theme;

/// Most sensors of a kind in a rig; a strip of more cameras would be too small to read.
const MAX_CAMERAS: usize = 12;
const MAX_LIDARS: usize = 8;
const MAX_RADARS: usize = 12;
/// Height that the window leaves to its own header and to the bars around it, points.
const AROUND_POINTS: f32 = 130.0;

/// Draws the window.
pub fn sensors_ui(
    ui: &Ui,
    rig: &SensorRig,
    windows: &mut OpenWindows,
    cameras: &mut CamerasShown,
    commands: &mut Vec<Command>,
) {
    let mut open = windows.sensors;
    egui::Window::new(t("Sensors"))
        .id(egui::Id::unique("sensors"))
        .open(&mut open)
        // Beside the views, which show the fields of view.
        .default_pos(egui::pos2(ui.max_rect().right() - 356.0, 60.0))
        .default_width(330.0)
        .resizable(false)
        .collapsible(true)
        .show(ui.ctx(), |ui| {
            ui.set_width(330.0);
            let most = (ui.ctx().content_rect().height() - AROUND_POINTS).max(200.0);
            let scrolled = egui::ScrollArea::vertical()
                .max_height(most)
                .min_scrolled_height(most)
                .auto_shrink([false, true]);
            scrolled.show(ui, |ui| {
                presets(ui, commands);
                ui.add_space(4.0);
                lists(ui, rig, (&mut windows.sensor, cameras), commands);
                ui.add_space(theme::GAP);
                match windows.sensor {
                    SensorChoice::Camera(i) => {
                        if let Some(camera) = rig.cameras.get(i) {
                            camera_fields(ui, rig, i, camera, commands);
                        }
                    }
                    SensorChoice::Lidar(i) => {
                        if let Some(lidar) = rig.lidars.get(i) {
                            lidar_fields(ui, rig, i, lidar, commands);
                        }
                    }
                    SensorChoice::Radar(i) => {
                        if let Some(radar) = rig.radars.get(i) {
                            super::radar::fields(ui, rig, i, radar, commands);
                        }
                    }
                }
            });
        });
    windows.sensors = open;
}

/// The edit that sets the rig after a change.
pub(super) fn changed(rig: &SensorRig, change: impl FnOnce(&mut SensorRig)) -> Edit {
    let mut rig = Box::new(rig.clone());
    change(&mut rig);
    Edit::SetRig { rig }
}

fn presets(ui: &mut Ui, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.menu_button(t("Presets"), |ui| {
            for preset in &RIGS {
                if ui.button(t(preset.name)).clicked() {
                    let rig = Box::new((preset.build)());
                    commands.push(Command::Apply("Replace sensors", vec![Edit::SetRig { rig }]));
                    ui.close();
                }
            }
        });
        if ui.button(t("Import…")).clicked() {
            commands.push(Command::File(FileCommand::ImportRig));
        }
        if ui.button(t("Export…")).clicked() {
            commands.push(Command::File(FileCommand::ExportRig));
        }
    });
}

fn lists(
    ui: &mut Ui,
    rig: &SensorRig,
    (choice, cameras): (&mut SensorChoice, &mut CamerasShown),
    commands: &mut Vec<Command>,
) {
    section(ui, t("Cameras"));
    for (i, camera) in rig.cameras.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let shown = !cameras.is_hidden(i);
            let (icon, hint) = match shown {
                true => (Icon::Eye, t("in the strip and in the 3D view")),
                false => (Icon::EyeOff, t("not rendered")),
            };
            let show = tf!("Show {name}", name = camera.name);
            if icons::button(ui, icon, &show, hint, false, true).clicked() {
                cameras.hidden ^= 1 << i;
            }
            let right = format!("{:.0}°", camera.fov_deg());
            let chosen = *choice == SensorChoice::Camera(i);
            let label = tf!("Camera {name}", name = camera.name);
            if icons::row(
                ui,
                theme::accent(),
                t(&camera_label(&camera.name)),
                &right,
                chosen,
                &label,
            )
            .clicked()
            {
                *choice = SensorChoice::Camera(i);
            }
        });
    }
    section(ui, t("LiDARs"));
    for (i, lidar) in rig.lidars.iter().enumerate() {
        let right = format!("{} x {}", lidar.elevations_deg.len(), lidar.columns);
        let chosen = *choice == SensorChoice::Lidar(i);
        let name = if i == 0 {
            tf!("{name} (shown)", name = lidar.name)
        } else {
            lidar.name.clone()
        };
        let label = tf!("LiDAR {name}", name = lidar.name);
        if icons::row(ui, theme::text(), &name, &right, chosen, &label).clicked() {
            *choice = SensorChoice::Lidar(i);
        }
    }
    section(ui, t("Radars"));
    for (i, radar) in rig.radars.iter().enumerate() {
        let right = tf!("{range} m", range = format!("{:.0}", radar.max_range_m()));
        let chosen = *choice == SensorChoice::Radar(i);
        let label = tf!("Radar {name}", name = radar.name);
        if icons::row(ui, theme::text(), &radar.name, &right, chosen, &label).clicked() {
            *choice = SensorChoice::Radar(i);
        }
    }
    add_buttons(ui, rig, (choice, cameras), commands);
}

/// Buttons that add a sensor, and those for the chosen one.
fn add_buttons(
    ui: &mut Ui,
    rig: &SensorRig,
    (choice, cameras): (&mut SensorChoice, &mut CamerasShown),
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        if ui
            .add_enabled(
                rig.cameras.len() < MAX_CAMERAS,
                egui::Button::new(t("Add camera")),
            )
            .clicked()
        {
            let mut camera = Camera::new(&free_name("CAM", rig), 70.0);
            camera.translation_m = [1.5, 0.0, 1.5];
            *choice = SensorChoice::Camera(rig.cameras.len());
            commands.push(Command::Apply(
                "Add camera",
                vec![changed(rig, |r| r.cameras.push(camera))],
            ));
        }
        ui.add_enabled_ui(rig.lidars.len() < MAX_LIDARS, |ui| {
            ui.menu_button(t("Add LiDAR"), |ui| {
                for preset in &LIDARS {
                    if ui.button(t(preset.name)).clicked() {
                        let mut lidar = (preset.build)();
                        lidar.name = free_name("LIDAR", rig);
                        *choice = SensorChoice::Lidar(rig.lidars.len());
                        commands.push(Command::Apply(
                            "Add LiDAR",
                            vec![changed(rig, |r| r.lidars.push(lidar))],
                        ));
                        ui.close();
                    }
                }
            });
        });
    });
    ui.horizontal(|ui| {
        ui.add_enabled_ui(rig.radars.len() < MAX_RADARS, |ui| {
            ui.menu_button(t("Add radar"), |ui| {
                for preset in &RADARS {
                    if ui.button(t(preset.name)).clicked() {
                        let mut radar = (preset.build)();
                        radar.name = free_name("RADAR", rig);
                        *choice = SensorChoice::Radar(rig.radars.len());
                        commands.push(Command::Apply(
                            "Add radar",
                            vec![changed(rig, |r| r.radars.push(radar))],
                        ));
                        ui.close();
                    }
                }
            });
        });
        let what = *choice;
        let exists = match what {
            SensorChoice::Camera(i) => i < rig.cameras.len(),
            SensorChoice::Lidar(i) => i < rig.lidars.len(),
            SensorChoice::Radar(i) => i < rig.radars.len(),
        };
        if icons::button(ui, Icon::Copy, t("Duplicate sensor"), "", false, exists).clicked() {
            let copy = changed(rig, |r| match what {
                SensorChoice::Camera(i) => r.cameras.push(Camera {
                    name: free_name("CAM", rig),
                    ..rig.cameras[i].clone()
                }),
                SensorChoice::Lidar(i) => r.lidars.push(LidarPattern {
                    name: free_name("LIDAR", rig),
                    ..rig.lidars[i].clone()
                }),
                SensorChoice::Radar(i) => r.radars.push(RadarPattern {
                    name: free_name("RADAR", rig),
                    ..rig.radars[i].clone()
                }),
            });
            *choice = match what {
                SensorChoice::Camera(_) => SensorChoice::Camera(rig.cameras.len()),
                SensorChoice::Lidar(_) => SensorChoice::Lidar(rig.lidars.len()),
                SensorChoice::Radar(_) => SensorChoice::Radar(rig.radars.len()),
            };
            commands.push(Command::Apply("Duplicate sensor", vec![copy]));
        }
        if icons::button(ui, Icon::Trash, t("Remove sensor"), "", false, exists).clicked() {
            let rest = changed(rig, |r| match what {
                SensorChoice::Camera(i) => drop(r.cameras.remove(i)),
                SensorChoice::Lidar(i) => drop(r.lidars.remove(i)),
                SensorChoice::Radar(i) => drop(r.radars.remove(i)),
            });
            if let SensorChoice::Camera(i) = what {
                cameras.forget(i);
            }
            commands.push(Command::Apply("Remove sensor", vec![rest]));
        }
    });
}

/// The first free name: `CAM_1`, `CAM_2` and so on.
fn free_name(stem: &str, rig: &SensorRig) -> String {
    let names = rig
        .cameras
        .iter()
        .map(|c| &c.name)
        .chain(rig.lidars.iter().map(|l| &l.name))
        .chain(rig.radars.iter().map(|r| &r.name));
    let taken: Vec<&String> = names.collect();
    let mut numbered = (1..).map(|i| format!("{stem}_{i}"));
    numbered
        .find(|name| !taken.contains(&name))
        .expect("numbers do not end")
}

fn camera_fields(ui: &mut Ui, rig: &SensorRig, index: usize, camera: &Camera, commands: &mut Vec<Command>) {
    section(ui, t(&camera_label(&camera.name)));
    let mut new = camera.clone();
    let set = |new: Camera| changed(rig, |r| r.cameras[index] = new);
    let renamed = name_row(ui, &mut new.name);
    if renamed {
        commands.push(Command::Apply("Rename sensor", vec![set(new.clone())]));
    }
    let moved = mount(ui, &mut new.translation_m);
    field(&moved, "Move sensor", set(new.clone()), commands);
    let mut aim = new.aim();
    let turned = aim_rows(ui, &mut aim);
    if turned.changed() {
        new.set_aim(aim);
    }
    field(&turned, "Aim sensor", set(new.clone()), commands);
    let mut fov_deg = new.fov_deg();
    let widest = if new.lens.is_wide() { 340.0 } else { 170.0 };
    let zoomed = number(
        ui,
        t("View"),
        t("Field of view"),
        &mut fov_deg,
        5.0..=widest,
        "°",
        1,
    );
    if zoomed.changed() {
        new.set_fov_deg(fov_deg);
    }
    field(&zoomed, "Change field of view", set(new.clone()), commands);
    lens::rows(ui, &new, &set, commands);
    let text = format!(
        "{} x {} px, f {:.0} px",
        camera.width, camera.height, camera.focal_px[0]
    );
    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
}

fn lidar_fields(
    ui: &mut Ui,
    rig: &SensorRig,
    index: usize,
    lidar: &LidarPattern,
    commands: &mut Vec<Command>,
) {
    section(ui, &lidar.name);
    let mut new = lidar.clone();
    let set = |new: LidarPattern| changed(rig, |r| r.lidars[index] = new);
    if name_row(ui, &mut new.name) {
        commands.push(Command::Apply("Rename sensor", vec![set(new.clone())]));
    }
    ui.horizontal(|ui| {
        caption(ui, t("Pattern"));
        ui.menu_button(tf!("{n} beams", n = lidar.elevations_deg.len()), |ui| {
            for preset in &LIDARS {
                if ui.button(t(preset.name)).clicked() {
                    // The pattern changes, the mount stays.
                    let pattern = LidarPattern {
                        name: new.name.clone(),
                        rotation_wxyz: new.rotation_wxyz,
                        translation_m: new.translation_m,
                        ..(preset.build)()
                    };
                    commands.push(Command::Apply("Change pattern", vec![set(pattern)]));
                    ui.close();
                }
            }
        });
        if index > 0 && ui.button(t("Show this one")).clicked() {
            commands.push(Command::Apply(
                "Choose LiDAR",
                vec![changed(rig, |r| r.lidars.swap(0, index))],
            ));
        }
    });
    let moved = mount(ui, &mut new.translation_m);
    field(&moved, "Move sensor", set(new.clone()), commands);
    let mut aim = new.aim();
    let turned = aim_rows(ui, &mut aim);
    if turned.changed() {
        new.set_aim(aim);
    }
    field(&turned, "Aim sensor", set(new.clone()), commands);
    let mut columns = f64::from(new.columns);
    let stepped = number(ui, t("Columns"), t("Columns"), &mut columns, 1.0..=8192.0, "", 0);
    new.columns = columns as u32;
    field(&stepped, "Change columns", set(new.clone()), commands);
    let ranged = number(
        ui,
        t("Range"),
        t("Range"),
        &mut new.max_range_m,
        1.0..=300.0,
        " m",
        0,
    );
    field(&ranged, "Change range", set(new.clone()), commands);
    let sector = number(
        ui,
        t("Sector"),
        t("Sector"),
        &mut new.sector_deg,
        1.0..=360.0,
        "°",
        0,
    );
    field(&sector, "Change sector", set(new.clone()), commands);
    let spin = number(
        ui,
        t("Spin"),
        t("Revolutions per second"),
        &mut new.spin_hz,
        0.0..=50.0,
        " Hz",
        0,
    );
    field(&spin, "Change spin", set(new.clone()), commands);
    for (text, hover, name) in [
        (
            "Ego vehicle",
            "The own roof is in the way of a sensor above it and sends pulses back, as in real sweeps",
            "Change own vehicle",
        ),
        (
            "Beyond the map",
            "Pulses that leave the grid meet a continuation of the scene: roads, houses, trees",
            "Change beyond the grid",
        ),
    ] {
        let on = match name {
            "Change own vehicle" => &mut new.own_body,
            _ => &mut new.beyond_grid,
        };
        if ui.checkbox(on, t(text)).on_hover_text(t(hover)).changed() {
            commands.push(Command::Apply(name, vec![set(new.clone())]));
        }
    }
    speed_row(ui, rig, commands);
    let low = lidar.elevations_deg.first().copied().unwrap_or(0.0);
    let high = lidar.elevations_deg.last().copied().unwrap_or(0.0);
    let text = tf!(
        "{low}° to {high}°, {rays} rays a sweep",
        low = format!("{low:.1}"),
        high = format!("{high:.1}"),
        rays = lidar.rays()
    );
    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
}

/// A field for the speed of the vehicle.
pub(super) fn speed_row(ui: &mut Ui, rig: &SensorRig, commands: &mut Vec<Command>) {
    let mut kmh = rig.ego_speed_mps * 3.6;
    let speed = number(
        ui,
        t("Speed"),
        t("Speed of the vehicle"),
        &mut kmh,
        0.0..=200.0,
        " km/h",
        0,
    );
    let edit = changed(rig, |r| r.ego_speed_mps = kmh / 3.6);
    field(&speed, "Change speed", edit, commands);
}

/// A field for a name. Returns true when the focus leaves the field with a new name.
pub(super) fn name_row(ui: &mut Ui, name: &mut String) -> bool {
    let memory = ui.scope_id().with("sensor name");
    let mut text = ui.data(|d| d.get_temp::<(String, String)>(memory));
    if text.as_ref().is_none_or(|(of, _)| of != name) {
        text = Some((name.clone(), name.clone()));
    }
    let (of, mut typed) = text.expect("just set");
    let response = ui
        .horizontal(|ui| {
            caption(ui, t("Name"));
            ui.add(egui::TextEdit::singleline(&mut typed).desired_width(180.0))
        })
        .inner;
    ui.data_mut(|d| d.insert_temp(memory, (of, typed.clone())));
    let done = response.lost_focus() && !typed.trim().is_empty() && typed.trim() != name;
    if done {
        *name = typed.trim().to_owned();
    }
    done
}

pub(super) fn mount(ui: &mut Ui, translation_m: &mut [f64; 3]) -> egui::Response {
    let mut p = DVec3::from(*translation_m);
    let response = numbers(
        ui,
        t("Mount"),
        ["Forward", "Left", "Up"].map(t),
        &mut p,
        -20.0..=20.0,
        0.02,
    );
    *translation_m = p.to_array();
    response
}

pub(super) fn aim_rows(ui: &mut Ui, aim: &mut Aim) -> egui::Response {
    let yaw = number(ui, t("Yaw"), t("Yaw"), &mut aim.yaw_deg, -180.0..=180.0, "°", 1);
    let pitch = number(
        ui,
        t("Pitch"),
        t("Pitch"),
        &mut aim.pitch_deg,
        -89.0..=89.0,
        "°",
        1,
    );
    let roll = number(
        ui,
        t("Roll"),
        t("Roll"),
        &mut aim.roll_deg,
        -180.0..=180.0,
        "°",
        1,
    );
    yaw.union(pitch).union(roll)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_free() {
        let mut rig = SensorRig::default();
        assert_eq!(free_name("CAM", &rig), "CAM_1");
        rig.cameras[2].name = "CAM_1".into();
        rig.lidars[0].name = "CAM_2".into();
        assert_eq!(free_name("CAM", &rig), "CAM_3");
    }
}
