//! What small networks see of the scene in its cameras and its LiDAR: boxes that they miss, things where there are none, and a
//! search for a change after which one misses the chosen box.

mod lists;
mod search;

use std::sync::Arc;

use egui::{RichText, Ui};

use authoring::corner_case::{Sensor, Vary};
use language::{t, tf};
use sensors::cameras::perceived;
use sensors::perceived_sweep::SweepReport;
use widgets::icons::{self, Icon};
use widgets::theme;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, Place};
use crate::command::{Command, ViewCommand};
use crate::detection_marks::DetectionMarks;
use crate::perceiving::Perceiving;
use lists::{report_ui, sweep_ui};
use search::search_ui;

/// From this width on there are columns, points.
const WIDE: f32 = 560.0;

/// The pane.
pub struct Perception {
    perceiving: Option<Perceiving>,
    vary: Vary,
    by: Sensor,
    /// What stands is shown over the map.
    stands: bool,
    /// The marks that are shown, and of which report.
    marks: Option<(Arc<SweepReport>, bool, Arc<DetectionMarks>)>,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            perceiving: None,
            vary: Vary::Distance,
            by: Sensor::Cameras,
            stands: false,
            marks: None,
        }
    }
}

impl Pane for Perception {
    fn id(&self) -> PaneId {
        PaneId::named("perception")
    }

    fn title(&self) -> String {
        "Perception".into()
    }

    fn icon(&self) -> Icon {
        Icon::Eye
    }

    fn place(&self) -> Place {
        Place::BelowViews
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let Some(perceiving) = &self.perceiving else {
            return;
        };
        let choices = Sensor::ALL.map(|(by, name)| (by, t(name), t("Whose network looks at the scene")));
        icons::choice(ui, &mut self.by, &choices, t("By"));
        if let Some(problem) = &perceiving.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        match self.by {
            Sensor::Cameras => {
                if let Some((_, report)) = &perceiving.seen {
                    let percent = format!("{:.1}", report.right * 100.0);
                    let text = tf!("Classes right: {percent} % of the pixels", percent = percent);
                    let what =
                        t("A small camera network that learned from the pictures looks at all cameras.");
                    ui.label(RichText::new(text).small().color(theme::text_weak()))
                        .on_hover_text(what);
                }
                if ui.button(t("Show what it sees in the cameras")).clicked() {
                    commands.push(Command::View(ViewCommand::Cameras(perceived::VIEW.id)));
                }
            }
            Sensor::Lidar => {
                if let Some((_, report)) = &perceiving.swept {
                    let percent = format!("{:.1}", report.right * 100.0);
                    let text = tf!("Right where the LiDAR sees: {percent} %", percent = percent);
                    let what = t(
                        "A small network that learned from the sweeps of procedural worlds looks at the exact sweep of the first LiDAR.",
                    );
                    ui.label(RichText::new(text).small().color(theme::text_weak()))
                        .on_hover_text(what);
                }
                ui.checkbox(&mut self.stands, t("What stands where, over the map"));
            }
        }
        if perceiving.is_stale(cx.document.scene().rev, self.by) {
            ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()));
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if self.perceiving.is_none() {
            let ctx = ui.ctx().clone();
            self.perceiving = Perceiving::spawn(Arc::new(move || ctx.request_repaint())).ok();
        }
        let Some(perceiving) = &mut self.perceiving else {
            ui.label(t("The system gives no thread for it"));
            return;
        };
        if !cx.document.is_dragging() {
            perceiving.update(cx.document.scene(), self.by);
        }
        let swept = perceiving
            .swept
            .as_ref()
            .filter(|(rev, _)| *rev == cx.document.scene().rev);
        let swept = swept
            .filter(|_| self.by == Sensor::Lidar)
            .map(|(_, report)| report.clone());
        show_marks(ui, &mut self.marks, swept, self.stands, cx);
        let (vary, by) = (&mut self.vary, self.by);
        if !by.varies().contains(vary) {
            *vary = Vary::Distance;
        }
        let wide = ui.available_width() > WIDE;
        theme::panel_frame().show(ui, |ui| {
            let area = egui::ScrollArea::vertical()
                .id_salt("perception")
                .auto_shrink(false);
            area.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 3.0;
                let report = match by {
                    Sensor::Cameras => report_ui,
                    Sensor::Lidar => sweep_ui,
                };
                if !wide {
                    report(ui, perceiving, cx, [true, true], commands);
                    search_ui(ui, perceiving, (vary, by), cx, commands);
                    return;
                }
                ui.columns(3, |columns| {
                    report(&mut columns[0], perceiving, cx, [true, false], commands);
                    report(&mut columns[1], perceiving, cx, [false, true], commands);
                    search_ui(&mut columns[2], perceiving, (vary, by), cx, commands);
                });
            });
        });
    }
}

/// Has the marks of a report drawn over the views, or none.
fn show_marks(
    ui: &Ui,
    kept: &mut Option<(Arc<SweepReport>, bool, Arc<DetectionMarks>)>,
    report: Option<Arc<SweepReport>>,
    stands: bool,
    cx: &mut PaneContext<'_>,
) {
    let known = |(of, with, _): &(Arc<SweepReport>, bool, _)| {
        *with == stands && report.as_ref().is_some_and(|r| Arc::ptr_eq(r, of))
    };
    if !kept.as_ref().is_some_and(known) {
        *kept = report.map(|report| {
            let detections = report.detections.iter().map(|d| (d.thing, d.of.is_none()));
            let missed = report.boxes.iter().filter(|b| b.is_missed()).map(|b| b.id);
            let marks = DetectionMarks {
                detections: detections.collect(),
                missed: missed.collect(),
                stands: stands.then(|| {
                    let image = from_above(&report);
                    ui.ctx()
                        .load_texture("what stands", image, egui::TextureOptions::NEAREST)
                }),
                map_from_vehicle: report.map_from_vehicle,
                window: report.window,
            };
            (report, stands, Arc::new(marks))
        });
        // The views are drawn before this pane or after it.
        ui.ctx().request_repaint();
    }
    cx.state.shown.detection_marks = kept.as_ref().map(|(.., marks)| marks.clone());
}

/// What stands in each column, ahead is up.
fn from_above(report: &SweepReport) -> egui::ColorImage {
    let [nx, ny] = [report.window.nx(), report.window.ny()];
    let at = |x: usize, y: usize| theme::class_color(report.stands[x * ny + y].class());
    let pixels = (0..nx * ny).map(|i| at(nx - 1 - i / ny, ny - 1 - i % ny));
    egui::ColorImage::new([ny, nx], pixels.collect())
}
