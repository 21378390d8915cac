//! File dialogs: the system's dialog, or a path field of the window if no system dialog answers.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, TryRecvError, bounded};
use egui::accesskit::Role;
use egui::{Ui, WidgetInfo};

use language::{t, tf};
use widgets::theme;

/// Purpose of a file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene or a road to open.
    Open,
    /// Where to save the scene.
    SaveAs,
    /// Where to save a picture.
    Screenshot,
    /// Where to save a turntable of the 3D view.
    Turn,
    /// Where to save moving pictures.
    Clip,
    /// A model to put into the scene.
    Model,
    /// A model that gives its shape to the chosen box.
    ModelShape,
    /// A sensor rig to load.
    ImportRig,
    /// Where to save the sensor rig.
    ExportRig,
    /// Weights that paint camera pictures.
    PictureWeights,
    /// The file of an export.
    ExportFile,
    /// The folder of an export.
    ExportFolder,
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open scene or road",
            Purpose::SaveAs => "Save scene as",
            Purpose::Screenshot => "Save picture",
            Purpose::Turn => "Save turn: .gif, .png or .mp4",
            Purpose::Clip => "Save clip: .gif, .png or .mp4",
            Purpose::Model => "Place a model",
            Purpose::ModelShape => "Shape of the chosen box",
            Purpose::ImportRig => "Import sensors",
            Purpose::ExportRig => "Export sensors",
            Purpose::PictureWeights => "Folder of picture weights",
            Purpose::ExportFile => "Export to file",
            Purpose::ExportFolder => "Export into folder",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Purpose::Open => "Open file",
            Purpose::SaveAs => "Save file",
            Purpose::Screenshot | Purpose::Turn => "Save file",
            Purpose::Clip => "Save clip",
            Purpose::Model => "Place model",
            Purpose::ModelShape => "Take shape",
            Purpose::ImportRig => "Import file",
            Purpose::ExportRig => "Export file",
            Purpose::PictureWeights | Purpose::ExportFile | Purpose::ExportFolder => "Use path",
        }
    }

    fn is_save(self) -> bool {
        !matches!(
            self,
            Purpose::Open
                | Purpose::Model
                | Purpose::ModelShape
                | Purpose::ImportRig
                | Purpose::PictureWeights
        )
    }
}

/// Shortest time in which a user can dismiss a dialog. An earlier dismissal means that no dialog was shown.
const NO_DIALOG_AFTER: Duration = Duration::from_millis(350);

struct PendingDialog {
    purpose: Purpose,
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
    suggestion: PathBuf,
}

struct PathField {
    purpose: Purpose,
    text: String,
    /// Frames in which the field still requests the focus: a dialog that closes may take the first request.
    focus: u8,
    error: Option<String>,
    confirmed: bool, // the user agreed to replace the file
}

/// The file dialog that is open, if any.
pub struct FileDialogs {
    native: bool,
    waiting: Option<PendingDialog>,
    field: Option<PathField>,
}

impl FileDialogs {
    /// True if the system's dialog is tried before the path field.
    pub fn is_native(&self) -> bool {
        self.native
    }

    /// File dialogs of the system, or only the path field if `native` is false.
    pub fn new(native: bool) -> Self {
        Self {
            native: native && a_dialog_may_answer(),
            waiting: None,
            field: None,
        }
    }

    /// True while an answer is awaited.
    pub fn is_open(&self) -> bool {
        self.waiting.is_some() || self.field.is_some()
    }

    /// Opens a dialog. `suggestion` is the file or folder to begin with.
    pub fn ask(&mut self, purpose: Purpose, suggestion: &Path, ctx: &egui::Context) {
        if self.is_open() {
            return;
        }
        if !self.native {
            self.open_field(purpose, suggestion);
            return;
        }
        let mut dialog = rfd::AsyncFileDialog::new().set_title(t(purpose.title()));
        dialog = match purpose {
            Purpose::Open => dialog
                .add_filter(t("Scenes and what becomes one"), &formats::import::extensions())
                .add_filter(t("All files"), &["*"]),
            Purpose::SaveAs => dialog.add_filter(t("Sceneloom scene"), &["loom"]),
            Purpose::Screenshot => dialog.add_filter(t("PNG picture"), &["png"]),
            Purpose::Clip | Purpose::Turn => dialog.add_filter(t("Moving pictures"), &["mp4", "gif", "png"]),
            Purpose::Model | Purpose::ModelShape => dialog
                .add_filter(
                    t("Models and scenes of one object"),
                    &["glb", "gltf", "vox", "loom"],
                )
                .add_filter(t("All files"), &["*"]),
            Purpose::ImportRig | Purpose::ExportRig => dialog.add_filter(t("Sensor rig"), &["json"]),
            Purpose::PictureWeights | Purpose::ExportFile | Purpose::ExportFolder => dialog,
        };
        if let Some(folder) = suggestion.parent().filter(|p| p.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        if let (true, Some(name)) = (purpose.is_save(), suggestion.file_name()) {
            dialog = dialog.set_file_name(name.to_string_lossy());
        }
        let (send, answer) = bounded(1);
        let wake = ctx.clone();
        // The dialog is made here, on the main thread, as macOS requires; another thread waits for it.
        type Chosen = Option<rfd::FileHandle>;
        let chosen: std::pin::Pin<Box<dyn Future<Output = Chosen> + Send>> =
            if matches!(purpose, Purpose::ExportFolder | Purpose::PictureWeights) {
                Box::pin(dialog.pick_folder())
            } else if purpose.is_save() {
                Box::pin(dialog.save_file())
            } else {
                Box::pin(dialog.pick_file())
            };
        let wait = move || pollster::block_on(chosen).map(|file| file.path().to_path_buf());
        let thread = runtime::guard::spawn("file-dialog", wait, move |path| {
            // Sending fails if the window has closed. After a panic there is no answer, as after a dismissal.
            let _ = send.send(path.unwrap_or_default());
            wake.request_repaint();
        });
        if thread.is_err() {
            self.open_field(purpose, suggestion);
            return;
        }
        self.waiting = Some(PendingDialog {
            purpose,
            answer,
            since: Instant::now(),
            suggestion: suggestion.to_path_buf(),
        });
    }

    fn open_field(&mut self, purpose: Purpose, suggestion: &Path) {
        self.field = Some(PathField {
            purpose,
            text: suggestion.display().to_string(),
            focus: 3,
            error: None,
            confirmed: false,
        });
    }

    /// Takes the answer of the system dialog, once there is one.
    pub fn poll(&mut self) -> Option<(Purpose, PathBuf)> {
        let waiting = self.waiting.as_ref()?;
        let answer = match waiting.answer.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(path) => path,
            Err(TryRecvError::Disconnected) => None,
        };
        let waiting = self.waiting.take()?;
        if answer.is_none() && waiting.since.elapsed() < NO_DIALOG_AFTER {
            self.native = false;
            self.open_field(waiting.purpose, &waiting.suggestion);
        }
        answer.map(|path| (waiting.purpose, with_extension(path, waiting.purpose)))
    }

    /// Draws the path field, if it is open. Returns the path once the user confirms it.
    pub fn show(&mut self, ui: &mut Ui) -> Option<(Purpose, PathBuf)> {
        let field = self.field.as_mut()?;
        let modal = egui::Modal::new(egui::Id::unique("path field")).frame(theme::dialog_frame(ui.style()));
        let answer = modal.show(ui.ctx(), |ui| field_ui(ui, field));
        if answer.inner == Choice::Cancel || answer.should_close() {
            self.field = None;
            return None;
        }
        if answer.inner == Choice::Nothing {
            return None;
        }
        let path = with_extension(PathBuf::from(field.text.trim()), field.purpose);
        match problem(&path, field) {
            Some(text) => {
                // Enter took the focus away: the field takes it back for the next try.
                (field.error, field.focus) = (Some(text), 3);
                None
            }
            None => self.field.take().map(|field| (field.purpose, path)),
        }
    }
}

#[derive(PartialEq)]
enum Choice {
    Nothing,
    Cancel,
    Done,
}

fn field_ui(ui: &mut Ui, field: &mut PathField) -> Choice {
    ui.set_width(520.0);
    ui.heading(t(field.purpose.title()));
    ui.add_space(theme::GAP);
    let edit = egui::TextEdit::singleline(&mut field.text)
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 6))
        .hint_text(match field.purpose {
            Purpose::Model | Purpose::ModelShape => "/path/to/model.glb",
            Purpose::ImportRig | Purpose::ExportRig => "/path/to/sensors.json",
            _ => "/path/to/scene.loom",
        });
    let response = ui.add(edit).accessible_name(t("File path"));
    if field.focus > 0 {
        field.focus -= 1;
        response.request_focus();
    }
    if response.changed() {
        (field.error, field.confirmed) = (None, false);
    }
    let enter = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if let Some(error) = &field.error {
        ui.colored_label(theme::warn(), error);
    }
    ui.add_space(theme::GAP);
    let mut choice = if enter { Choice::Done } else { Choice::Nothing };
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let name = if field.confirmed {
            t("Replace file")
        } else {
            t(field.purpose.button())
        };
        let primary = egui::Button::new(name).fill(theme::accent_fill());
        let enabled = !field.text.trim().is_empty();
        if ui.add_enabled(enabled, primary).clicked() {
            choice = Choice::Done;
        }
        let cancel = ui.button(t("Cancel"));
        cancel.widget_info(|| WidgetInfo::labeled(Role::Button, true, t("Cancel file")));
        if cancel.clicked() {
            choice = Choice::Cancel;
        }
    });
    choice
}

fn problem(path: &Path, field: &mut PathField) -> Option<String> {
    if field.purpose == Purpose::PictureWeights {
        return (!path.is_dir()).then(|| tf!("There is no folder {folder}", folder = path.display()));
    }
    if !field.purpose.is_save() {
        return (!path.is_file()).then(|| tf!("There is no file {path}", path = path.display()));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|p| !p.is_dir()) {
        return Some(tf!("There is no folder {folder}", folder = folder.display()));
    }
    if path.exists() && !std::mem::replace(&mut field.confirmed, true) {
        return Some(t("The file exists. Press again to replace it.").into());
    }
    None
}

/// Adds the extension of the purpose to a name without one.
fn with_extension(path: PathBuf, purpose: Purpose) -> PathBuf {
    let extension = match purpose {
        Purpose::Open
        | Purpose::Model
        | Purpose::ModelShape
        | Purpose::ImportRig
        | Purpose::PictureWeights
        | Purpose::ExportFile
        | Purpose::ExportFolder => return path,
        Purpose::ExportRig => "json",
        Purpose::SaveAs => "loom",
        Purpose::Screenshot => "png",
        Purpose::Clip => "mp4",
        Purpose::Turn => "gif",
    };
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(extension)
    }
}

/// True if a dialog may answer. On Linux a dialog needs a session bus with a portal, or zenity; without either, asking
/// would only cost time.
fn a_dialog_may_answer() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let bus_of_session =
        std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    let on_path = |name: &str| {
        std::env::var_os("PATH")
            .is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(name).is_file()))
    };
    std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some() || bus_of_session || on_path("zenity")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_their_extension() {
        let named = |name: &str, purpose| with_extension(name.into(), purpose);
        assert_eq!(named("a", Purpose::SaveAs), PathBuf::from("a.loom"));
        assert_eq!(named("a.loom", Purpose::SaveAs), PathBuf::from("a.loom"));
        assert_eq!(named("b", Purpose::Screenshot), PathBuf::from("b.png"));
        assert_eq!(named("road", Purpose::Open), PathBuf::from("road"));
    }

    #[test]
    fn bad_paths_are_named_and_replacing_is_asked_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.loom");
        let mut field = PathField {
            purpose: Purpose::Open,
            text: String::new(),
            focus: 0,
            error: None,
            confirmed: false,
        };
        assert!(problem(&file, &mut field).is_some_and(|p| p.contains("no file")));
        field.purpose = Purpose::SaveAs;
        assert_eq!(problem(&file, &mut field), None);
        assert!(
            problem(&folder.path().join("x/a.loom"), &mut field).is_some_and(|p| p.contains("no folder"))
        );
        std::fs::write(&file, "x").expect("a file");
        field.confirmed = false;
        assert!(problem(&file, &mut field).is_some_and(|p| p.contains("replace")));
        assert_eq!(problem(&file, &mut field), None);
    }
}
