//! The newest sweep, unrolled: azimuth from left to right as the driver sees it, beams from top to bottom.

use std::sync::Arc;

use egui::{Color32, ColorImage, Rect, TextureHandle, TextureOptions, Ui, pos2};

use super::areas::{clipped, in_rect, left_part, upper_and_lower};
use super::compare::{CompareMode, DIFFERENCE_COLORS, legend, wipe_line};
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use super::sweep_picture::{COLUMNS, Mount, SweepPicture};
use crate::camera_views::LidarModel;
use crate::command::Command;
use language::t;
use scene::{LidarSweep, Scene};
use sensors::lidar::recorded;
use viewport::LidarColorMode;
use widgets::icons::Icon;
use widgets::theme;

/// The pane of the newest sweep.
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
        let is_recorded = recorded::recording_of(cx.scene).is_some();
        let models = [
            (LidarModel::Recorded, "Recorded"),
            (LidarModel::Exact, "Exact"),
            (LidarModel::Learned, "Learned"),
        ];
        let models = &models[usize::from(!is_recorded)..];
        let of_scene = cx.state.lidar.model.of_scene(cx.scene);
        let model = models.iter().find(|(m, _)| *m == of_scene);
        egui::ComboBox::from_id_salt("sweep model")
            .selected_text(t(model.map_or("Exact", |(_, name)| name)))
            .width(84.0)
            .show_ui(ui, |ui| {
                for (model, name) in models {
                    let is_chosen = *model == of_scene;
                    if ui.selectable_label(is_chosen, t(name)).clicked() {
                        cx.state.lidar.model = *model;
                    }
                }
            })
            .response
            .accessible_name(t("LiDAR model"));
        let colors = [
            (LidarColorMode::Range, "Range"),
            (LidarColorMode::Class, "Class"),
            (LidarColorMode::Ring, "Ring"),
            (LidarColorMode::Intensity, "Intensity"),
            (LidarColorMode::Drop, "Loss"),
            (LidarColorMode::Origin, "Origin"),
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
        let stale = cx.sensing.lidar_stale(cx.document.scene().rev);
        if stale && cx.sensing.lidar().is_some() && !cx.state.playback.playing {
            let spinner = egui::Spinner::new().size(12.0).color(theme::text_weak());
            ui.add(spinner).on_hover_text(t("updating"));
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        let scene = cx.scene;
        let mode = cx.compare.mode(&cx.state.compare);
        let reference = cx.compare.reference.clone();
        let other_at = cx
            .compare
            .sensing
            .as_ref()
            .map(|s| *s.swept_at())
            .unwrap_or_default();
        let other = cx.compare.sensing.as_ref().and_then(|s| s.lidar()).cloned();
        let before = other.as_ref().map(|sweep| (sweep, &other_at));
        if let (true, Some(reference)) = (cx.state.compare.holding_reference, &reference) {
            let sweep = &mut cx.compare.sweep;
            sweep.show(ui, reference, before, cx.state, commands);
            return;
        }
        let (top, bottom) = upper_and_lower(area);
        let rect = if mode == CompareMode::Side { bottom } else { area };
        in_rect(ui, rect, |ui| {
            let now = cx.sensing.lidar().map(|sweep| (sweep, cx.sensing.swept_at()));
            self.sweep.show(ui, scene, now, cx.state, commands);
        });
        let Some(reference) = reference else { return };
        match mode {
            CompareMode::Side => in_rect(ui, top, |ui| {
                cx.compare.sweep.show(ui, &reference, before, cx.state, commands);
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
                        cx.compare.sweep.show(ui, &reference, before, cx.state, commands);
                    });
                });
                wipe_line(ui, area, &mut cx.state.compare);
            }
            CompareMode::Off => {}
        }
    }
}

/// The difference of two sweeps, and the sweeps that its picture was made from.
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
        let mount = Mount::new(&scene.frame().world_from_ego, lidar);
        let known =
            |(a, b, _): &(Arc<LidarSweep>, Arc<LidarSweep>, _)| Arc::ptr_eq(a, now) && Arc::ptr_eq(b, before);
        if !self.texture.as_ref().is_some_and(known) {
            let image = difference(now, before, rings, &mount);
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

/// Picture of a difference: equal returns are grey; returns nearer than before, or new, are green; returns farther than
/// before, or gone, are red.
fn difference(now: &LidarSweep, before: &LidarSweep, rings: usize, mount: &Mount) -> ColorImage {
    const ALIKE_M: f32 = 0.1;
    let ranges = |sweep: &LidarSweep| {
        let mut out = vec![f32::INFINITY; rings * COLUMNS];
        for point in sweep.points.iter().filter(|p| usize::from(p.ring) < rings) {
            let at = usize::from(point.ring) * COLUMNS + mount.column(point);
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
