//! The running export of the window: one at a time, on a thread of its own.

use std::path::PathBuf;
use std::sync::Arc;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use super::app::{SceneloomApp, one_line};
use super::file_dialogs::Purpose;
use super::toasts::MessageLevel;
use crate::capture::{self, Subject, Turntable};
use crate::clip_export::{ClipOptions, ClipView, clip};
use crate::export::{ExportOptions, ExportProgress, Format, export_all};
use crate::windows::export::{ExportAction, ExportDialog, ExportInput, export_window};
use editor::checks::{Severity, waive};
use formats::video::VideoKind;
use language::{t, tf};

/// Frames per second of a turntable.
const TURN_HZ: f64 = 15.0;

type ExportResult = anyhow::Result<Vec<(PathBuf, u64)>>;

/// The export dialog, and the export that is running.
#[derive(Default)]
pub struct Exporting {
    /// State of the dialog; `None` while it is closed.
    pub dialog: Option<ExportDialog>,
    running: Option<RunningExport>,
}

struct RunningExport {
    name: &'static str,
    progress: Arc<ExportProgress>,
    written: Receiver<ExportResult>,
}

impl Exporting {
    /// Name of the running export, and its progress.
    pub fn under_way(&self) -> Option<(&'static str, &ExportProgress)> {
        self.running.as_ref().map(|r| (r.name, &*r.progress))
    }
}

impl SceneloomApp {
    /// Opens the dialog, or closes it.
    pub(crate) fn toggle_export(&mut self) {
        self.files.exporting.dialog = match self.files.exporting.dialog.take() {
            Some(_) => None,
            None => Some(ExportDialog::new(&self.suggested("loom"))),
        };
    }

    /// Draws the dialog and starts the export that it asks for.
    pub(crate) fn export_dialog(&mut self, ui: &egui::Ui) {
        let Some(mut dialog) = self.files.exporting.dialog.take() else {
            return;
        };
        let findings = self.threads.checking.findings();
        let input = ExportInput {
            browse: self.files.dialogs.is_native(),
            busy: self.files.exporting.running.as_ref().map(|r| &*r.progress),
            scene: self.document.scene(),
            errors: findings.map_or(0, |f| {
                let open = waive::open(self.document.settled_scene().frame(), f);
                open.filter(|f| f.severity == Severity::Error).count()
            }),
        };
        let mut open = true;
        let wanted = export_window(ui, &input, &mut dialog, &mut open);
        let path = PathBuf::from(dialog.path.trim());
        match wanted {
            Some(ExportAction::Write(formats)) => {
                let mut options = dialog.options.clone();
                options.shot.camera = self.views.view3d.camera;
                options.parameters = self.parameters();
                dialog.written.clone_from(&dialog.path);
                self.start_export(formats, options, path, ui.ctx());
            }
            Some(ExportAction::Browse) => {
                let purpose = match dialog.fills_a_folder() {
                    true => Purpose::ExportFolder,
                    false => Purpose::ExportFile,
                };
                self.files.dialogs.ask(purpose, &path, ui.ctx());
            }
            Some(ExportAction::Checks) => self.views.dock.open(crate::panes::id::PaneId::CHECKS),
            None => {}
        }
        self.files.exporting.dialog = open.then_some(dialog);
    }

    pub(super) fn start_export(
        &mut self,
        formats: Vec<Format>,
        options: ExportOptions,
        path: PathBuf,
        ctx: &egui::Context,
    ) {
        let name = match formats.as_slice() {
            [format] => format.id,
            _ => "everything",
        };
        let scene = Arc::clone(self.document.settled_scene());
        self.run_export(name, ctx, move |told| {
            export_all(&scene, &formats, &options, &path, told)
        });
    }

    /// Writes the clip that the dialog of pictures describes: the 3D view from its present viewpoint, the map or
    /// cameras.
    pub(super) fn save_clip(&mut self, path: PathBuf, ctx: &egui::Context) {
        let kind = match VideoKind::of_path(&path) {
            Ok(kind) => kind,
            Err(error) => return self.fail(tf!("Not saved: {error}", error = error)),
        };
        let scene = Arc::clone(self.document.settled_scene());
        let playback = &self.state.playback;
        let span_s = playback.span(scene.clip().length_s);
        let mut camera = self.views.view3d.camera;
        if playback.follow {
            // A viewpoint that follows the vehicle is moved to its place at the first moment.
            let now = scene.frame().world_from_ego;
            camera.go_along(&now, &scene.at(span_s[0]).frame().world_from_ego);
        }
        let dialog = &self.state.windows.capture;
        let asked = &dialog.options;
        let (view, size) = match asked.subject {
            Subject::Map => (ClipView::Map, asked.shot.size),
            Subject::Cameras => {
                let view = ClipView::Cameras {
                    view: asked.view,
                    source: asked.source,
                    camera: dialog.camera,
                };
                (view, asked.camera_size)
            }
            _ => {
                let view = ClipView::View3d {
                    camera: Box::new(camera),
                    follow: playback.follow,
                    boxes: asked.shot.boxes,
                    look: self.state.shown.look_of(&camera),
                };
                (view, asked.shot.size)
            }
        };
        let options = ClipOptions {
            view,
            size,
            span_s,
            rate_hz: scene.clip().rate_hz,
            paint: None,
        };
        let wish = self.preferences.settings.painting.clone();
        self.run_export("the clip", ctx, move |told| {
            let paint = options.paints().then(|| wish.open()).transpose()?;
            let options = ClipOptions { paint, ..options };
            let go_on = |done, all| {
                told.count(done, all);
                !told.is_cancelled()
            };
            let bytes = clip(&scene, &options, kind, &go_on)?;
            formats::atomic::write(&path, &bytes)?;
            Ok(vec![(path, bytes.len() as u64)])
        });
    }

    /// Writes the picture or the turntable that the dialog of pictures describes.
    pub(super) fn save_capture(&mut self, path: PathBuf, ctx: &egui::Context) {
        let dialog = self.state.windows.capture.clone();
        let scene = Arc::clone(self.document.settled_scene());
        let mut options = dialog.options;
        options.shot.camera = self.views.view3d.camera;
        options.shot.look = self.state.shown.look_of(&options.shot.camera);
        if !dialog.turns {
            let parameters = self.parameters();
            return self.run_export("the picture", ctx, move |_| {
                let picture = capture::capture(&scene, &options)?;
                let bytes = capture::to_png_made_with(&scene, &picture, parameters)?;
                formats::atomic::write(&path, &bytes)?;
                Ok(vec![(path, bytes.len() as u64)])
            });
        }
        let kind = match VideoKind::of_path(&path) {
            Ok(kind) => kind,
            Err(error) => return self.fail(tf!("Not saved: {error}", error = error)),
        };
        let turn = Turntable {
            shot: options.shot,
            seconds: dialog.seconds,
            rate_hz: TURN_HZ,
        };
        self.run_export("the turn", ctx, move |told| {
            let go_on = |done, all| {
                told.count(done, all);
                !told.is_cancelled()
            };
            let bytes = capture::turntable(&scene, &turn, kind, &go_on)?;
            formats::atomic::write(&path, &bytes)?;
            Ok(vec![(path, bytes.len() as u64)])
        });
    }

    /// Runs an export on a thread of its own.
    fn run_export(
        &mut self,
        name: &'static str,
        ctx: &egui::Context,
        write: impl FnOnce(&ExportProgress) -> ExportResult + Send + 'static,
    ) {
        if self.files.exporting.running.is_some() {
            return self.fail(t("An export is on its way; one at a time").to_owned());
        }
        let (send, written) = bounded(1);
        let wake = ctx.clone();
        let progress = Arc::<ExportProgress>::default();
        let told = progress.clone();
        let write = move || write(&told);
        let thread = runtime::guard::spawn("export", write, move |written| {
            // Sending fails if the window has closed.
            let _ = send.send(written.unwrap_or_else(|panic| Err(panic.into())));
            wake.request_repaint();
        });
        match thread {
            Ok(_) => {
                self.files.exporting.running = Some(RunningExport {
                    name,
                    progress,
                    written,
                });
            }
            Err(error) => {
                let now_s = self.now_s();
                let text = tf!("Not exported: {error}", error = error);
                self.toasts.push(MessageLevel::Error, text, now_s);
            }
        }
    }

    /// Reports how an export ended.
    pub(crate) fn update_export(&mut self) {
        let Some(running) = &self.files.exporting.running else {
            return;
        };
        let answer = match running.written.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(answer) => answer,
            Err(TryRecvError::Disconnected) => Err(anyhow::anyhow!("writing it ended unexpectedly")),
        };
        let (name, now_s) = (running.name, self.now_s());
        let cancelled = running.progress.is_cancelled();
        self.files.exporting.running = None;
        match answer {
            Ok(files) => {
                let bytes: u64 = files.iter().map(|(_, bytes)| bytes).sum();
                let first = files
                    .first()
                    .map_or(String::new(), |(path, _)| path.display().to_string());
                let what = match files.len() {
                    1 => first,
                    n => tf!("{n} files, {first} and others", n = n, first = first),
                };
                let text = tf!(
                    "Exported {name}: {files} ({size} MB)",
                    name = t(name),
                    files = what,
                    size = format!("{:.1}", bytes as f64 / 1e6),
                );
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
            Err(_) if cancelled => {
                let text = t("Export cancelled: nothing was written").to_owned();
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
            Err(error) => {
                let text = tf!("Not exported: {error}", error = one_line(&error));
                self.toasts.push(MessageLevel::Error, text, now_s);
            }
        }
    }
}
