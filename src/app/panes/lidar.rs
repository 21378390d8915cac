//! The newest sweep unrolled: azimuth from left to right as the driver sees it, beams from top to bottom.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Color32, ColorImage, Rect, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, pos2};
use glam::DVec3;

use super::areas::{clipped, in_rect, left_part, upper_and_lower};
use super::compare::{CompareMode, DIFFERENCE_COLORS, legend, wipe_line};
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::camera_views::LidarModel;
use crate::command::Command;
use language::{t, tf};
use scene::{LidarSweep, Scene};
use viewport::{LidarColorMode, lidar_colors};
use widgets::icons::Icon;
use widgets::theme;

/// Columns of the picture.
const COLUMNS: usize = 1080;

/// The newest sweep.
#[derive(Default)]
pub struct Lidar {
    sweep: SweepPicture,
    difference: SweepDifference,
}

impl Pane for Lidar {
    fn id(&self) -> PaneId {
        PaneId::LIDAR
    }

    fn title(&self) -> String {
        "LiDAR sweep".into()
    }

    fn icon(&self) -> Icon {
        Icon::Sweep
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let models = [(LidarModel::Exact, "Exact"), (LidarModel::Learned, "Learned")];
        let model = models.iter().find(|(m, _)| *m == cx.state.lidar.model);
        egui::ComboBox::from_id_salt("sweep model")
            .selected_text(t(model.map_or("Exact", |(_, name)| name)))
            .width(84.0)
            .show_ui(ui, |ui| {
                for (model, name) in models {
                    ui.selectable_value(&mut cx.state.lidar.model, model, t(name));
                }
            })
            .response
            .accessible_name(t("LiDAR model"));
        let colors = [
            (LidarColorMode::Range, "Range"),
            (LidarColorMode::Class, "Class"),
            (LidarColorMode::Ring, "Ring"),
            (LidarColorMode::Intensity, "Echo"),
            (LidarColorMode::Drop, "Loss"),
        ];
        let shown = colors.iter().find(|(mode, _)| *mode == cx.state.lidar.colors);
        egui::ComboBox::from_id_salt("sweep colours")
            .selected_text(t(shown.map_or("Range", |(_, name)| name)))
            .width(84.0)
            .show_ui(ui, |ui| {
                for (mode, name) in colors {
                    ui.selectable_value(&mut cx.state.lidar.colors, mode, t(name));
                }
            })
            .response
            .accessible_name(t("LiDAR colour"));
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        let scene = cx.scene;
        let (colors, readout) = (cx.state.lidar.colors, &mut cx.state.pointed.readout);
        let mode = cx.compare.mode(&cx.state.compare);
        let before = cx.compare.before.clone();
        let other = cx.compare.sensing.as_ref().and_then(|s| s.lidar()).cloned();
        if let (true, Some(before)) = (cx.state.compare.holding_before, &before) {
            let sweep = &mut cx.compare.sweep;
            sweep.show(ui, before, other.as_ref(), colors, readout);
            return;
        }
        let (top, bottom) = upper_and_lower(area);
        let rect = if mode == CompareMode::Side { bottom } else { area };
        in_rect(ui, rect, |ui| {
            self.sweep.show(ui, scene, cx.sensing.lidar(), colors, readout);
        });
        let Some(before) = before else { return };
        match mode {
            CompareMode::Side => in_rect(ui, top, |ui| {
                cx.compare
                    .sweep
                    .show(ui, &before, other.as_ref(), colors, readout);
            }),
            CompareMode::Difference => {
                if let (Some(now), Some(other)) = (cx.sensing.lidar(), &other) {
                    in_rect(ui, area, |ui| self.difference.show(ui, scene, now, other));
                }
            }
            CompareMode::Wipe => {
                let part = left_part(area, cx.state.compare.wipe_at);
                clipped(ui, part, |ui| {
                    in_rect(ui, area, |ui| {
                        cx.compare
                            .sweep
                            .show(ui, &before, other.as_ref(), colors, readout);
                    });
                });
                wipe_line(ui, area, &mut cx.state.compare);
            }
            CompareMode::Off => {}
        }
    }
}

/// The picture and what it was made from.
#[derive(Default)]
pub struct SweepPicture {
    texture: Option<(Arc<LidarSweep>, LidarColorMode, usize, TextureHandle)>,
}

impl SweepPicture {
    /// Draws the sweep into all the space there is.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        sweep: Option<&Arc<LidarSweep>>,
        mode: LidarColorMode,
        readout: &mut String,
    ) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("LiDAR sweep")));
        ui.painter().rect_filled(rect, 0.0, theme::well());
        let (Some(sweep), Some(lidar)) = (sweep, scene.rig.lidars.first()) else {
            let text = t("This vehicle has no LiDAR. Sensors… adds one.");
            let font = egui::TextStyle::Body.resolve(ui.style());
            let painter = ui.painter();
            painter.text(
                rect.center(),
                egui::Align2::CENTER_CENTER,
                text,
                font,
                theme::text_weak(),
            );
            return;
        };
        let rings = lidar.elevations_deg.len().max(1);
        let mount = DVec3::from_array(lidar.translation_m);
        let known = |(of, m, n, _): &(Arc<LidarSweep>, LidarColorMode, usize, _)| {
            Arc::ptr_eq(of, sweep) && *m == mode && *n == rings
        };
        if !self.texture.as_ref().is_some_and(known) {
            let image = picture(sweep, mode, rings, mount);
            let options = TextureOptions::NEAREST;
            let handle = ui.ctx().load_texture("sweep", image, options);
            self.texture = Some((sweep.clone(), mode, rings, handle));
        }
        let Some((.., handle)) = &self.texture else { return };
        let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(handle.id(), rect, unit, Color32::WHITE);
        if let Some(p) = response.hover_pos() {
            let part = (p - rect.min) / rect.size();
            let azimuth_deg = 180.0 - f64::from(part.x) * 360.0;
            let ring = (f64::from(1.0 - part.y) * rings as f64) as usize;
            let near = nearest(sweep, mount, ring.min(rings - 1), azimuth_deg);
            *readout = match near {
                Some((range_m, class)) => tf!(
                    "azimuth {azimuth}°  ·  beam {beam}  ·  {range} m  ·  {class}",
                    azimuth = format!("{azimuth_deg:.0}"),
                    beam = ring,
                    range = format!("{range_m:.2}"),
                    class = class
                ),
                None => tf!(
                    "azimuth {azimuth}°  ·  beam {beam}  ·  no return",
                    azimuth = format!("{azimuth_deg:.0}"),
                    beam = ring
                ),
            };
        }
    }
}

/// Where two sweeps differ, and what the picture of it was made from.
#[derive(Default)]
struct SweepDifference {
    texture: Option<(Arc<LidarSweep>, Arc<LidarSweep>, TextureHandle)>,
}

impl SweepDifference {
    fn show(&mut self, ui: &mut Ui, scene: &Scene, now: &Arc<LidarSweep>, before: &Arc<LidarSweep>) {
        let Some(lidar) = scene.rig.lidars.first() else {
            return;
        };
        let rings = lidar.elevations_deg.len().max(1);
        let known =
            |(a, b, _): &(Arc<LidarSweep>, Arc<LidarSweep>, _)| Arc::ptr_eq(a, now) && Arc::ptr_eq(b, before);
        if !self.texture.as_ref().is_some_and(known) {
            let image = difference(now, before, rings, DVec3::from_array(lidar.translation_m));
            let handle = ui
                .ctx()
                .load_texture("sweep difference", image, TextureOptions::NEAREST);
            self.texture = Some((now.clone(), before.clone(), handle));
        }
        let Some((.., handle)) = &self.texture else { return };
        let rect = ui.available_rect_before_wrap();
        let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(handle.id(), rect, unit, Color32::WHITE);
        let names = [t("nearer or new"), t("farther or gone")];
        let colors = DIFFERENCE_COLORS.map(|[r, g, b]| Color32::from_rgb(r, g, b));
        let entries: Vec<_> = colors.into_iter().zip(names.map(str::to_owned)).collect();
        legend(ui, rect.left_top() + egui::vec2(8.0, 8.0), &entries);
    }
}

/// Returns that are alike are grey; green are those nearer than before, or where nothing returned; red those farther, or gone.
fn difference(now: &LidarSweep, before: &LidarSweep, rings: usize, mount: DVec3) -> ColorImage {
    const ALIKE_M: f32 = 0.1;
    let ranges = |sweep: &LidarSweep| {
        let mut out = vec![f32::INFINITY; rings * COLUMNS];
        for point in sweep.points.iter().filter(|p| usize::from(p.ring) < rings) {
            let at = usize::from(point.ring) * COLUMNS + column(azimuth_deg(point.position_in_ego, mount));
            out[at] = out[at].min(point.range_m);
        }
        out
    };
    let mut image = ColorImage::filled([COLUMNS, rings], theme::well());
    for (i, (a, b)) in ranges(now).into_iter().zip(ranges(before)).enumerate() {
        let [r, g, b] = match (a.is_finite(), b.is_finite()) {
            (false, false) => continue,
            (true, true) if (a - b).abs() <= ALIKE_M => [70, 74, 80],
            _ if a < b => DIFFERENCE_COLORS[0],
            _ => DIFFERENCE_COLORS[1],
        };
        image[(i % COLUMNS, rings - 1 - i / COLUMNS)] = Color32::from_rgb(r, g, b);
    }
    image
}

/// Azimuth of a return as seen from the sensor, degrees, counter-clockwise from forward.
fn azimuth_deg(p_in_ego: [f32; 3], mount: DVec3) -> f64 {
    let d = DVec3::from_array(p_in_ego.map(f64::from)) - mount;
    d.y.atan2(d.x).to_degrees()
}

fn column(azimuth_deg: f64) -> usize {
    (((180.0 - azimuth_deg) / 360.0 * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

fn picture(sweep: &LidarSweep, mode: LidarColorMode, rings: usize, mount: DVec3) -> ColorImage {
    let mut image = ColorImage::filled([COLUMNS, rings], theme::well());
    for (point, [r, g, b, _]) in sweep.points.iter().zip(lidar_colors(sweep, mode)) {
        let ring = usize::from(point.ring);
        if ring < rings {
            let x = column(azimuth_deg(point.position_in_ego, mount));
            image[(x, rings - 1 - ring)] = Color32::from_rgb(r, g, b);
        }
    }
    image
}

/// Range and class of the return of a beam that is nearest to an azimuth, within a degree.
fn nearest(sweep: &LidarSweep, mount: DVec3, ring: usize, at_deg: f64) -> Option<(f64, String)> {
    let off = |p: [f32; 3]| (azimuth_deg(p, mount) - at_deg).abs();
    let found = sweep
        .points
        .iter()
        .filter(|p| usize::from(p.ring) == ring)
        .min_by(|a, b| off(a.position_in_ego).total_cmp(&off(b.position_in_ego)))?;
    (off(found.position_in_ego) <= 1.0)
        .then(|| (f64::from(found.range_m), t(&found.class.label()).to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sweep_is_unrolled_as_the_driver_sees_it() {
        let mount = DVec3::new(1.0, 0.0, 1.8);
        let at = |x: f32, y: f32| column(azimuth_deg([x, y, 0.0], mount));
        assert_eq!(at(11.0, 0.0), COLUMNS / 2, "forward is in the middle");
        assert_eq!(at(1.0, 10.0), COLUMNS / 4, "left is left");
        assert_eq!(at(1.0, -10.0), COLUMNS * 3 / 4, "right is right");
    }
}
