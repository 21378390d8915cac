//! The dialog that exports a scene: format, options, path.

use std::path::Path;

use egui::{DragValue, Ui};

use crate::camera_views::LidarModel;
use crate::export::{ExportOptions, ExportProgress, Format};
use formats::export::{ExportSpan, Product};
use language::{t, tf};
use scene::Scene;
use sensors::cameras::{self, ViewId};
use widgets::{icons, theme};

/// Largest height of the list of formats, points.
const LIST_HEIGHT: f32 = 280.0;

/// Input of the dialog.
pub struct ExportInput<'a> {
    /// Progress of the running export.
    pub busy: Option<&'a ExportProgress>,
    /// True if the system's file dialog can be used for the path.
    pub browse: bool,
    /// Number of findings of severity error.
    pub errors: usize,
    /// The scene.
    pub scene: &'a Scene,
}

/// Request of the user.
pub enum ExportAction {
    /// Write these formats.
    Write(Vec<Format>),
    /// Choose the path with the system's file dialog.
    Browse,
    /// Show the findings of the checks.
    Checks,
}

/// Choices of the user.
#[derive(Clone, Debug)]
pub struct ExportDialog {
    /// The format; `None`: all formats except Gaussians, into one folder.
    pub format: Option<Format>,
    /// The options.
    pub options: ExportOptions,
    /// The path.
    pub path: String,
    /// Path of the last export; replacing it needs no warning.
    pub written: String,
    /// True if the user exports in spite of errors of the checks.
    pub anyway: bool,
    search: String,
    folder: std::path::PathBuf,
    stem: String,
}

impl ExportDialog {
    /// A dialog with paths beside the scene's file.
    pub fn new(scene_file: &Path) -> Self {
        let stem = scene_file
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let mut dialog = Self {
            format: formats::export::all().first().copied(),
            written: String::new(),
            options: ExportOptions::default(),
            path: String::new(),
            search: String::new(),
            anyway: false,
            folder: scene_file.parent().unwrap_or(Path::new("")).to_path_buf(),
            stem,
        };
        dialog.path = dialog.suggested();
        dialog
    }

    /// A path for the chosen format: a file, or a folder for the formats that fill one.
    fn suggested(&self) -> String {
        let name = match self.format.map(|f| (f.file_name, f.id)) {
            Some((Some(file), _)) => format!("{}_{file}", self.stem),
            Some((None, name)) => format!("{}_{name}", self.stem),
            None => format!("{}_export", self.stem),
        };
        self.folder.join(name).display().to_string()
    }

    /// True if the path names a folder that is filled.
    pub fn fills_a_folder(&self) -> bool {
        self.format.is_none_or(|f| f.file_name.is_none())
    }
}

/// Draws the dialog. Returns the request of the user.
pub fn export_window(
    ui: &Ui,
    input: &ExportInput<'_>,
    dialog: &mut ExportDialog,
    open: &mut bool,
) -> Option<ExportAction> {
    let mut asked = None;
    egui::Window::new(t("Export"))
        .id(egui::Id::unique("export"))
        .open(open)
        .default_pos(egui::pos2(380.0, 120.0))
        .default_width(500.0)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(500.0);
            kinds(ui, dialog);
            ui.separator();
            options(ui, dialog);
            let folder = dialog.fills_a_folder();
            ui.horizontal(|ui| {
                ui.label(if folder { t("Folder") } else { t("File") });
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if input.browse && ui.button(t("Browse…")).clicked() {
                        asked = Some(ExportAction::Browse);
                    }
                    let field = egui::TextEdit::singleline(&mut dialog.path).desired_width(f32::INFINITY);
                    ui.add(field).accessible_name(t("Export path"));
                });
            });
            let there = Path::new(dialog.path.trim()).is_file() && dialog.path != dialog.written;
            if !folder && there {
                ui.colored_label(
                    ui.visuals().warn_fg_color,
                    t("The file exists and will be replaced."),
                );
            }
            if input.errors > 0 {
                let text = match input.errors {
                    1 => t("The checks found an error in this scene.").to_owned(),
                    n => tf!("The checks found {n} errors in this scene.", n = n),
                };
                ui.horizontal(|ui| {
                    ui.colored_label(ui.visuals().warn_fg_color, text);
                    if ui.small_button(t("Show checks")).clicked() {
                        asked = Some(ExportAction::Checks);
                    }
                });
                ui.checkbox(&mut dialog.anyway, t("Export all the same"))
                    .on_hover_text(t("Repair or waive the errors instead, in the list of checks"));
            }
            ui.add_space(theme::GAP);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let sound = input.errors == 0 || dialog.anyway;
                let enabled = sound && input.busy.is_none() && !dialog.path.trim().is_empty();
                let button = egui::Button::new(t("Export files")).fill(ui.visuals().selection.bg_fill);
                if ui.add_enabled(enabled, button).clicked() {
                    let formats = dialog
                        .format
                        .map_or_else(|| formats::export::usual(input.scene), |f| vec![f]);
                    asked = Some(ExportAction::Write(formats));
                }
                if let Some(progress) = input.busy {
                    busy(ui, progress);
                }
            });
        });
    asked
}

/// Draws the progress of the export, and the button that cancels it.
fn busy(ui: &mut Ui, progress: &ExportProgress) {
    let stop = !progress.is_cancelled();
    if ui
        .add_enabled(stop, egui::Button::new(t("Cancel export")))
        .on_hover_text(t("Stops before the next picture; nothing is written"))
        .clicked()
    {
        progress.cancel();
    }
    if !stop {
        ui.weak(t("Stopping…"));
        return;
    }
    let (share, text) = match (progress.baked_percent(), progress.pictures()) {
        (Some(percent), _) => (
            percent as f32 / 100.0,
            tf!("Baking: {percent} %", percent = percent),
        ),
        (None, Some((done, of))) => {
            let text = tf!("Picture {n} of {all}", n = (done + 1).min(of), all = of);
            (done as f32 / of as f32, text)
        }
        (None, None) => {
            ui.spinner();
            ui.weak(t("Exporting…"));
            return;
        }
    };
    let bar = egui::ProgressBar::new(share).desired_width(150.0);
    ui.add(bar.text(text)).accessible_name(t("Export progress"));
    // No other event wakes the window while a picture is made.
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_millis(250));
}

/// Headings of the list, each with the prefixes of its titles. The last one takes all other formats.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Occupancy and meshes", &["Occupancy: ", "Meshes: ", "Splats: "]),
    ("LiDAR", &["LiDAR: "]),
    ("Pictures", &["Cameras: ", "3D view: "]),
    ("Boxes, roads, clips", &[]),
];

/// The index of the heading of a format.
fn group_of(format: Format) -> usize {
    let begins = |(_, starts): &(&str, &[&str])| starts.iter().any(|s| format.title.starts_with(s));
    GROUPS.iter().position(begins).unwrap_or(GROUPS.len() - 1)
}

/// The formats that contain every word of a search, by heading.
fn found(search: &str) -> [Vec<Format>; GROUPS.len()] {
    let words: Vec<String> = search.split_whitespace().map(str::to_lowercase).collect();
    let mut out: [Vec<Format>; GROUPS.len()] = Default::default();
    for format in formats::export::all() {
        let text = format!("{} {} {}", format.id, format.title, t(format.title)).to_lowercase();
        if words.iter().all(|word| text.contains(word)) {
            out[group_of(format)].push(format);
        }
    }
    out
}

/// If a search hides the chosen format, the first found one is chosen.
fn pick_found(dialog: &mut ExportDialog) {
    let found = found(&dialog.search).concat();
    let is_found = dialog.format.is_some_and(|f| found.iter().any(|g| g.id == f.id));
    if let (false, Some(first)) = (is_found, found.first()) {
        dialog.format = Some(*first);
    }
}

/// The title of a format without its prefix, which the heading repeats.
fn short(format: Format, starts: &[&str]) -> &'static str {
    let own = t(format.title);
    match starts.iter().any(|s| format.title.starts_with(s)) {
        true => own
            .split_once([':', '：'])
            .map_or(own, |(_, rest)| rest.trim_start()),
        false => own,
    }
}

fn kinds(ui: &mut Ui, dialog: &mut ExportDialog) {
    let before = dialog.format;
    let hint = tf!("Search {n} formats", n = formats::export::all().len());
    let field = egui::TextEdit::singleline(&mut dialog.search)
        .hint_text(hint)
        .desired_width(f32::INFINITY);
    let field = ui.add(field);
    if field.changed() {
        pick_found(dialog);
    }
    field.accessible_name(t("Search formats"));
    egui::ScrollArea::vertical()
        .max_height(LIST_HEIGHT)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            let found = found(&dialog.search);
            for ((heading, starts), formats) in GROUPS.iter().zip(&found) {
                if formats.is_empty() {
                    continue;
                }
                icons::section(ui, t(heading));
                for format in formats {
                    let is_chosen = dialog.format == Some(*format);
                    let radio = egui::RadioButton::new(is_chosen, short(format, starts));
                    if ui.add(radio).clicked() {
                        dialog.format = Some(*format);
                    }
                }
            }
            if found.iter().all(Vec::is_empty) {
                ui.weak(t("No format is called so."));
            }
        });
    ui.radio_value(
        &mut dialog.format,
        None,
        t("Every format but splats, into one folder"),
    );
    if let Some(format) = dialog.format {
        let span = match format.span {
            ExportSpan::Moment => t("The moment that is shown."),
            ExportSpan::Clip => t("The whole clip."),
        };
        ui.weak(match format.lost {
            "" => span.to_owned(),
            lost => tf!("{span} Read again it lacks: {lost}.", span = span, lost = t(lost)),
        });
    }
    if dialog.format != before {
        dialog.path = dialog.suggested();
    }
}

fn options(ui: &mut Ui, dialog: &mut ExportDialog) {
    let (format, options) = (dialog.format, &mut dialog.options);
    let size = |ui: &mut Ui, size: &mut [u32; 2]| {
        ui.horizontal(|ui| {
            ui.label(t("Size"));
            for (value, name) in size.iter_mut().zip([t("Width"), t("Height")]) {
                ui.add(DragValue::new(value).range(1..=8192).suffix(" px"))
                    .accessible_name(name);
            }
        });
    };
    let Some(format) = format else {
        size(ui, &mut options.camera_size);
        ui.weak(t(
            "Cameras of this size; everything else as it is set for its kind.",
        ));
        return;
    };
    for product in format.needs {
        match product {
            Product::CameraMaps => {
                size(ui, &mut options.camera_size);
                ui.horizontal(|ui| {
                    ui.label(t("From"));
                    // The default source comes first.
                    for source in cameras::sources_of(ViewId::SEMANTIC).into_iter().rev() {
                        ui.radio_value(&mut options.source, source.id(), t(source.id().name()));
                    }
                });
            }
            Product::Pictures | Product::Truth => {
                size(ui, &mut options.camera_size);
                ui.weak(t("Some twenty seconds for six pictures of 800 x 450."));
            }
            Product::Sweep => {
                ui.horizontal(|ui| {
                    ui.label(t("Sweep"));
                    ui.radio_value(
                        &mut options.lidar,
                        LidarModel::Recorded,
                        t("recorded, where there is one"),
                    );
                    ui.radio_value(&mut options.lidar, LidarModel::Exact, t("exact"));
                    ui.radio_value(
                        &mut options.lidar,
                        LidarModel::Learned,
                        t("learned, with intensity and lost echoes"),
                    );
                });
            }
            Product::Radar | Product::Recording => {}
            Product::View => {
                size(ui, &mut options.shot.size);
                ui.horizontal(|ui| {
                    ui.label(t("Samples per axis"));
                    ui.add(DragValue::new(&mut options.shot.supersample).range(1..=8))
                        .accessible_name(t("Samples per axis"));
                    ui.checkbox(&mut options.shot.transparent, t("Transparent"));
                    ui.checkbox(&mut options.shot.boxes, t("Boxes"));
                    ui.checkbox(&mut options.shot.lidar, t("LiDAR"));
                });
                ui.weak(t("Seen as the 3D view shows it now."));
            }
            Product::Gaussians => {
                ui.weak(t("Baked from pictures of many places: a minute or two."));
            }
            Product::Observed | Product::Seen => {}
        }
    }
}
