//! Predictions of small networks from the cameras, the LiDAR and both: missed boxes, false detections, and a search for
//! a change after which a network misses the chosen box.

mod lists;
mod search;

use std::sync::Arc;

use egui::{RichText, Ui};

use authoring::corner_case::{NetworkSensors, Vary};
use language::{t, tf};
use nets::perceiver::stands::{Stands, standing};
use scene::{Extent, Scene, SceneRev};
use sensors::cameras::perceived;
use sensors::perceive::sweep::SweepReport;
use sensors::perceive::voxels::{VoxelReport, on_map};
use widgets::icons::{self, Icon};
use widgets::theme;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::{Command, ViewCommand};
use crate::detection_marks::DetectionMarks;
use crate::perceiving::Perceiving;
use lists::{report_ui, sweep_ui, told_ui};
use search::search_ui;

/// Least width for columns, points.
const WIDE: f32 = 560.0;

/// The pane of the predictions.
pub struct Perception {
    perceiving: Option<Perceiving>,
    vary: Vary,
    by: NetworkSensors,
    /// True if the predicted kind of each column is shown over the map.
    stands: bool,
    /// True if the predicted voxels are shown in the 3D view.
    told: bool,
    marks: ShownMarks,
    /// Last value of [`UiState::opened`](crate::state::UiState::opened), which counts opened scenes.
    opened: u64,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            perceiving: None,
            vary: Vary::Distance,
            by: NetworkSensors::Cameras,
            stands: false,
            told: true,
            opened: 0,
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

    fn place(&self) -> PanePlacement {
        PanePlacement::BelowViews
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let Some(perceiving) = &self.perceiving else {
            return;
        };
        let choices =
            NetworkSensors::ALL.map(|(by, name)| (by, t(name), t("Whose network looks at the scene")));
        icons::choice(ui, &mut self.by, &choices, t("By"));
        if let Some(problem) = &perceiving.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        let shows = Shows {
            by: self.by,
            stands: &mut self.stands,
            told: &mut self.told,
        };
        match ui.available_width() >= shows.width(ui) {
            true => shows.ui(ui, commands),
            false => drop(widgets::menu::with_fields(ui, t("Show"), |ui| {
                shows.ui(ui, commands)
            })),
        }
        if perceiving.is_stale(cx.document.scene().rev, self.by) {
            ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()));
        }
        if let Some((text, what)) = summary(perceiving, self.by) {
            // The text takes the width that the controls leave.
            ui.add_space(4.0);
            let text = RichText::new(text).small().color(theme::text_weak());
            ui.add(egui::Label::new(text).truncate()).on_hover_text(what);
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
        // Predictions of an earlier state stay until the network is done again, but not those of another scene.
        let opened = cx.state.opened;
        if std::mem::replace(&mut self.opened, opened) != opened {
            perceiving.forget();
        }
        if !cx.document.is_dragging() {
            perceiving.update(cx.document.scene(), self.by);
        }
        let shown = match self.by {
            NetworkSensors::Cameras => None,
            NetworkSensors::Lidar => perceiving
                .swept
                .clone()
                .map(|(of, r)| (of, MarkedPrediction::Swept(r))),
            NetworkSensors::Both => perceiving
                .told
                .clone()
                .map(|(of, r)| (of, MarkedPrediction::Told(r))),
        };
        show_marks(ui, &mut self.marks, shown, [self.stands, self.told], cx);
        let (vary, by) = (&mut self.vary, self.by);
        if !by.varies().contains(vary) {
            *vary = Vary::Distance;
        }
        let wide = ui.available_width() > WIDE;
        let report = match by {
            NetworkSensors::Cameras => report_ui,
            NetworkSensors::Lidar => sweep_ui,
            NetworkSensors::Both => told_ui,
        };
        theme::panel_frame().show(ui, |ui| {
            if !wide {
                scrolled(ui, "all", |ui| {
                    report(ui, perceiving, cx, [true, true], commands);
                    search_ui(ui, perceiving, (vary, by), cx, commands);
                });
                return;
            }
            ui.columns(3, |columns| {
                let [wrong, right, corner_case] = columns else {
                    return;
                };
                scrolled(wrong, "wrong", |ui| {
                    report(ui, perceiving, cx, [true, false], commands)
                });
                scrolled(right, "right", |ui| {
                    report(ui, perceiving, cx, [false, true], commands)
                });
                scrolled(corner_case, "corner case", |ui| {
                    search_ui(ui, perceiving, (vary, by), cx, commands);
                });
            });
        });
    }
}

/// Width of a checkbox or of a button's edge beside its text, points.
const BESIDE_TEXT: f32 = 14.0;

/// Switches for the predictions in the large views.
struct Shows<'a> {
    by: NetworkSensors,
    stands: &'a mut bool,
    told: &'a mut bool,
}

impl Shows<'_> {
    fn texts(&self) -> &'static [&'static str] {
        match self.by {
            NetworkSensors::Cameras => &["Show what it sees in the cameras"],
            NetworkSensors::Lidar => &["What stands where, over the map"],
            NetworkSensors::Both => &["Its voxels in the 3D view", "What stands where, over the map"],
        }
    }

    /// Width of the switches in a row, points.
    fn width(&self, ui: &Ui) -> f32 {
        let texts = self.texts().iter();
        texts
            .map(|text| icons::segments_width(ui, &[((), t(text), "")]) + BESIDE_TEXT)
            .sum()
    }

    fn ui(self, ui: &mut Ui, commands: &mut Vec<Command>) {
        match self.by {
            NetworkSensors::Cameras => {
                if ui.button(t("Show what it sees in the cameras")).clicked() {
                    commands.push(Command::View(ViewCommand::Cameras(perceived::VIEW.id)));
                }
            }
            NetworkSensors::Lidar => {
                ui.checkbox(self.stands, t("What stands where, over the map"));
            }
            NetworkSensors::Both => {
                ui.checkbox(self.told, t("Its voxels in the 3D view"));
                ui.checkbox(self.stands, t("What stands where, over the map"));
            }
        }
    }
}

/// The share that a network predicts correctly, and a description of the network. `None` before its first prediction.
fn summary(perceiving: &Perceiving, by: NetworkSensors) -> Option<(String, &'static str)> {
    let percent = |right: f64| format!("{:.1}", right * 100.0);
    Some(match by {
        NetworkSensors::Cameras => {
            let (_, report) = perceiving.seen.as_ref()?;
            let text = tf!(
                "Classes right: {percent} % of the pixels",
                percent = percent(report.right)
            );
            let what = t("A small camera network that learned from the pictures looks at all cameras.");
            (text, what)
        }
        NetworkSensors::Lidar => {
            let (_, report) = perceiving.swept.as_ref()?;
            let text = tf!(
                "Right where the LiDAR sees: {percent} %",
                percent = percent(report.right)
            );
            let what = t(
                "A small network that learned from the sweeps of procedural worlds looks at the exact sweep of the first LiDAR.",
            );
            (text, what)
        }
        NetworkSensors::Both => {
            let (_, report) = perceiving.told.as_ref()?;
            let text = tf!(
                "Voxels where the LiDAR sees: IoU {iou}, classes right {percent} %",
                iou = format!("{:.2}", report.iou),
                percent = percent(report.right)
            );
            let what = t(
                "A small network that learned from procedural worlds tells voxels from the exact sweep of the first LiDAR and from what the camera network sees.",
            );
            (text, what)
        }
    })
}

/// A column with its own scroll area.
fn scrolled(ui: &mut Ui, name: &str, show: impl FnOnce(&mut Ui)) {
    let area = egui::ScrollArea::vertical().id_salt(name).auto_shrink(false);
    area.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 3.0;
        show(ui);
    });
}

/// Prediction whose marks are shown in the large views.
#[derive(Clone)]
enum MarkedPrediction {
    Swept(Arc<SweepReport>),
    Told(Arc<VoxelReport>),
}

impl MarkedPrediction {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Swept(a), Self::Swept(b)) => Arc::ptr_eq(a, b),
            (Self::Told(a), Self::Told(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// The marks on screen, with the report and the switches that they were made from.
type ShownMarks = Option<(MarkedPrediction, [bool; 2], Arc<DetectionMarks>)>;

/// Sets the marks of a report for the views, or none; with the kinds of columns over the map (`stands`) and the
/// predicted voxels in the 3D view (`told`).
fn show_marks(
    ui: &Ui,
    kept: &mut ShownMarks,
    report: Option<(SceneRev, MarkedPrediction)>,
    with @ [stands, told]: [bool; 2],
    cx: &mut PaneContext<'_>,
) {
    let known = |(of, with_, _): &(MarkedPrediction, [bool; 2], _)| {
        *with_ == with && report.as_ref().is_some_and(|(_, report)| report.is(of))
    };
    if !kept.as_ref().is_some_and(known) {
        *kept = report.map(|(of, report)| {
            let mut marks = match &report {
                MarkedPrediction::Swept(report) => of_sweep(of, report),
                MarkedPrediction::Told(report) => of_voxels(of, report, cx.document.scene()),
            };
            marks.stands = stands.then(|| {
                let (standing, window) = match &report {
                    MarkedPrediction::Swept(report) => (report.stands.clone(), report.window),
                    MarkedPrediction::Told(report) => (standing_of(report), report.voxels.extent()),
                };
                let image = from_above(&standing, window);
                let options = egui::TextureOptions::NEAREST;
                let texture = ui.ctx().load_texture("what stands", image, options);
                (texture, standing.into_iter().collect())
            });
            if let (MarkedPrediction::Told(report), true) = (&report, told) {
                marks.told = Some(with_told(cx.document.scene(), report));
            }
            (report, with, Arc::new(marks))
        });
        // Some views are drawn before this pane, so another frame is needed.
        ui.ctx().request_repaint();
    }
    cx.state.shown.detection_marks = kept.as_ref().map(|(.., marks)| marks.clone());
}

fn of_sweep(of: SceneRev, report: &SweepReport) -> DetectionMarks {
    let detections = report.detections.iter().map(|d| (d.thing, d.of.is_none()));
    let missed = report.boxes.iter().filter(|b| b.is_missed()).map(|b| b.id);
    DetectionMarks {
        of,
        detections: detections.collect(),
        missed: missed.collect(),
        stands: None,
        told: None,
        map_from_vehicle: report.map_from_vehicle,
        window: report.window,
    }
}

fn of_voxels(of: SceneRev, report: &VoxelReport, scene: &Scene) -> DetectionMarks {
    let missed = report.boxes.iter().filter(|b| b.is_missed()).map(|b| b.id);
    let seen = report.boxes.iter().filter(|b| !b.is_missed());
    let seen = seen.filter_map(|b| Some((*scene.frame().boxes.get(&b.id)?, false)));
    let ghosts = report.ghosts.iter().map(|g| (g.thing, true));
    DetectionMarks {
        of,
        detections: seen.chain(ghosts).collect(),
        missed: missed.collect(),
        stands: None,
        told: None,
        map_from_vehicle: report.map_from_vehicle,
        window: report.voxels.extent(),
    }
}

/// The kind of each column of the predicted voxels.
fn standing_of(report: &VoxelReport) -> Vec<Stands> {
    let labels = standing(&report.voxels).into_iter();
    labels
        .map(|label| Stands::of_label(label).unwrap_or(Stands::OtherGround))
        .collect()
}

/// The scene with the predicted voxels in place of its own.
fn with_told(scene: &Scene, report: &VoxelReport) -> Arc<Scene> {
    let mut still = scene.still();
    let told = on_map(&report.voxels, scene.frame().extent(), &report.map_from_vehicle);
    still.change_canvas(|canvas| canvas.occupancy = told);
    Arc::new(still)
}

/// Picture of the kind of each column of the window, ahead is up.
fn from_above(stands: &[Stands], window: Extent) -> egui::ColorImage {
    let [nx, ny] = [window.nx(), window.ny()];
    let at = |x: usize, y: usize| theme::class_color(stands[x * ny + y].class());
    let pixels = (0..nx * ny).map(|i| at(nx - 1 - i / ny, ny - 1 - i % ny));
    egui::ColorImage::new([ny, nx], pixels.collect())
}
