//! Carries out commands about files: opening, saving, screenshots, sensors.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam_channel::bounded;
use egui::Context;

use super::app::{SceneloomApp, one_line};
use super::file_dialogs::Purpose;
use super::files::{Next, Opening};
use super::toasts::MessageLevel;
use super::versions::VersionedScene;
use crate::capture;
use crate::command::FileCommand;
use crate::open;
use crate::picture::RgbaPicture;
use editor::Edit;
use language::{t, tf};
use scene::{ProjectHistory, Scene};
use sensors::cameras::{self, ViewId};

impl SceneloomApp {
    /// Carries out one file command.
    pub(crate) fn file_command(&mut self, command: FileCommand, ctx: &Context) {
        match command {
            FileCommand::New => self.guarded(Next::New, ctx),
            FileCommand::Open => self.guarded(Next::AskOpen, ctx),
            FileCommand::OpenPath(path) => self.guarded(Next::Open(path), ctx),
            FileCommand::Save => match self.files.path.clone() {
                Some(path) => self.save_to(path, ctx),
                None => self
                    .files
                    .dialogs
                    .ask(Purpose::SaveAs, &self.suggested("loom"), ctx),
            },
            FileCommand::SaveAs => self
                .files
                .dialogs
                .ask(Purpose::SaveAs, &self.suggested("loom"), ctx),
            FileCommand::SaveClip => self.state.windows.capture.open_for_clip(),
            FileCommand::AskCapture => {
                let dialog = &self.state.windows.capture;
                let (purpose, ending) = match (dialog.turns, dialog.is_clip()) {
                    (true, _) => (Purpose::Turn, "gif"),
                    (_, true) => (Purpose::Clip, "mp4"),
                    _ => (Purpose::Screenshot, "png"),
                };
                let path = self.suggested(ending);
                self.files.dialogs.ask(purpose, &path, ctx);
            }
            FileCommand::QuickShot => {
                let path = free_name(&self.suggested("png"));
                self.screenshot(&path);
            }
            FileCommand::SavePicture(camera, view) => self.save_picture(camera, view),
            FileCommand::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            FileCommand::NewFromPrompt(ask) => self.scene_from_words(*ask, ctx),
            FileCommand::Describe(words) => {
                let scene = self.document.settled_scene().clone();
                let mut commands = Vec::new();
                self.views.prompt.describe(&words, &scene, &mut commands);
                if commands.is_empty() {
                    // The prompt shows which words were not understood.
                    self.views.dock.open(crate::panes::id::PaneId::PROMPT);
                    self.note(t("No scene was read from these words"));
                }
                for command in commands {
                    self.execute(command, ctx);
                }
            }
            FileCommand::NewFrom(name, lattice) => self.guarded(Next::NewFrom(name, lattice), ctx),
            FileCommand::PlaceModel => self.ask_model(false, ctx),
            FileCommand::ShapeOfChosen => self.ask_model(true, ctx),
            FileCommand::PictureWeights => {
                let kept = self.preferences.settings.painting.weights.clone();
                let folder = self.suggested("loom");
                let folder = folder.parent().unwrap_or(Path::new("")).to_owned();
                let suggestion = kept.unwrap_or(folder);
                self.files.dialogs.ask(Purpose::PictureWeights, &suggestion, ctx);
            }
            FileCommand::ImportRig => {
                let suggestion = self.suggested("json");
                self.files.dialogs.ask(Purpose::ImportRig, &suggestion, ctx);
            }
            FileCommand::ExportRig => {
                let suggestion = self.suggested("json");
                self.files.dialogs.ask(Purpose::ExportRig, &suggestion, ctx);
            }
        }
    }

    /// Goes on at once if there are no unsaved changes, else asks first.
    pub(crate) fn guarded(&mut self, next: Next, ctx: &Context) {
        if self.document.is_dirty() {
            self.files.unsaved = Some(next);
        } else {
            self.go_on(next, ctx);
        }
    }

    pub(crate) fn go_on(&mut self, next: Next, ctx: &Context) {
        self.files.leaves = Some(self.left());
        match next {
            Next::Arrived => self.show_arrived(ctx),
            Next::Quit => {
                self.files.may_close = true;
                if let Some(recovery) = &mut self.files.recovery {
                    recovery.forget();
                }
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            Next::AskOpen => {
                let folder = self.suggested("loom");
                let folder = folder.parent().unwrap_or(Path::new("")).join("");
                self.files.dialogs.ask(Purpose::Open, &folder, ctx);
            }
            Next::Variant(id, variant) => self.open_variant(id, variant, ctx),
            Next::New => {
                let make = self.files.disk.new_scene.clone();
                self.load(t("New scene").into(), None, false, ctx, move || make());
            }
            Next::NewFrom(name, lattice) => {
                let seed = std::time::SystemTime::now()
                    .duration_since(std::time::UNIX_EPOCH)
                    .map_or(1, |d| u64::from(d.subsec_nanos()) % 100_000);
                let make = move || {
                    open::from_template(name, seed)
                        .map(|scene| scene.drawn_in(lattice))
                        .ok_or_else(|| anyhow::anyhow!("there is no template {name:?}"))
                };
                self.load(t("New scene").into(), None, false, ctx, make);
            }
            Next::Open(path) if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xodr")) => {
                self.pick_place(path, ctx);
            }
            Next::Open(path) => {
                let (open, file) = (self.files.disk.open.clone(), path.clone());
                let what = tf!("Opening {file}", file = path.display());
                let own_file = path.extension().is_some_and(|e| e == "loom").then_some(path);
                let is_picture = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
                let is_import = own_file.is_none() && !is_picture;
                let opened = move || open(&file).map(|found| VersionedScene::from(found).told_by(&file));
                self.load(what, own_file, is_import, ctx, opened);
            }
        }
    }

    /// Makes a scene on a thread of its own, while the window goes on.
    pub(crate) fn load<Read: Into<VersionedScene>>(
        &mut self,
        what: String,
        path: Option<PathBuf>,
        is_import: bool,
        ctx: &Context,
        make: impl FnOnce() -> anyhow::Result<Read> + Send + 'static,
    ) {
        let (send, scene) = bounded(1);
        let wake = ctx.clone();
        let thread = runtime::guard::spawn(
            "open",
            move || make().map(Into::into),
            move |scene| {
                // Sending fails if another scene was opened meanwhile.
                let _ = send.send(scene.unwrap_or_else(|panic| Err(panic.into())));
                wake.request_repaint();
            },
        );
        match thread {
            Ok(_) => {
                let leaves = self.files.leaves.take().unwrap_or_else(|| self.left());
                self.files.opening = Some(Opening {
                    path,
                    what,
                    is_import,
                    recovers: false,
                    step: None,
                    leaves,
                    scene,
                })
            }
            Err(error) => self.fail(format!("{what}: {error}")),
        }
    }

    pub(crate) fn file_chosen(&mut self, purpose: Purpose, path: PathBuf, ctx: &Context) {
        match purpose {
            Purpose::Open => self.go_on(Next::Open(path), ctx),
            Purpose::SaveAs => self.save_to(path, ctx),
            Purpose::Screenshot | Purpose::Turn => self.save_capture(path, ctx),
            Purpose::Clip => self.save_clip(path, ctx),
            Purpose::Model => self.read_model(path, false, ctx),
            Purpose::ModelShape => self.read_model(path, true, ctx),
            Purpose::PictureWeights => {
                let painting = &mut self.preferences.settings.painting;
                // Other networks have other default values.
                (painting.weights, painting.steps, painting.guidance) = (Some(path), None, None);
            }
            Purpose::ImportRig => self.import_rig(&path),
            Purpose::ExportRig => self.export_rig(&path),
            Purpose::ExportFile | Purpose::ExportFolder => {
                if let Some(dialog) = &mut self.files.exporting.dialog {
                    dialog.path = path.display().to_string();
                }
            }
        }
    }

    pub(crate) fn import_rig(&mut self, path: &Path) {
        match open::rig(path) {
            Ok(rig) => {
                let rig = Box::new(rig);
                self.apply("Import sensors", &[Edit::SetRig { rig }]);
            }
            Err(error) => self.fail(tf!("Not imported: {error}", error = one_line(&error))),
        }
    }

    pub(crate) fn export_rig(&mut self, path: &Path) {
        let saved = open::save_rig(&self.document.scene().rig, path);
        let now_s = self.now_s();
        match saved {
            Ok(()) => {
                let text = tf!("Saved {file}", file = path.display());
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
            Err(error) => self.fail(tf!("Not saved: {error}", error = one_line(&error))),
        }
    }

    pub(crate) fn save_to(&mut self, path: PathBuf, ctx: &Context) {
        self.document.cancel_drag();
        let scene = self.with_kept(self.document.settled_scene());
        let next = self.files.after_save.take();
        match (self.files.disk.save)(&scene, &path) {
            Ok(()) => {
                self.document.mark_saved();
                self.generation.versions.changed = false;
                let now_s = self.now_s();
                let text = tf!("Saved {file}", file = path.display());
                self.toasts.push(MessageLevel::Info, text, now_s);
                self.preferences.settings.remember(&path);
                self.files.path = Some(path);
                if let Some(next) = next {
                    self.go_on(next, ctx);
                }
            }
            Err(error) => self.fail(tf!("Not saved: {error}", error = one_line(&error))),
        }
    }

    /// A scene with the data that its file keeps beside it: versions, typed prompts, and the log.
    pub(crate) fn with_kept(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.kept = Arc::new(ProjectHistory {
            versions: self.generation.versions.kept(scene.content()),
            typed: self.views.prompt.typed().to_vec(),
            log: self.document.log(),
            log_problem: None,
            sweeps: scene.kept.sweeps.clone(),
        });
        scene
    }

    /// A path beside the scene's file, or in the working folder, named after the scene.
    pub(crate) fn suggested(&self, extension: &str) -> PathBuf {
        self.files.suggested(&self.document.scene().name, extension)
    }

    /// Saves the picture of a camera as it is shown.
    fn save_picture(&mut self, camera: usize, view: ViewId) {
        let source = cameras::source_of(view, self.state.cameras.source).id();
        let pictures = self.threads.sensing.pictures_of(source);
        let found = pictures.and_then(|all| all.iter().find(|v| v.camera == camera));
        let Some(found) = found else {
            return self.fail(t("No picture saved: the camera is not rendered yet").into());
        };
        let ([width, height], rgba) = found.picture.rgba(view, self.state.cameras.plane_m);
        let name = self
            .document
            .scene()
            .rig
            .cameras
            .get(camera)
            .map_or("camera", |c| &c.name);
        let tidy: String = name
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || c == '-' {
                    c.to_ascii_lowercase()
                } else {
                    '_'
                }
            })
            .collect();
        let path = self.suggested("png");
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let path = free_name(&path.with_file_name(format!("{stem}_{tidy}_{}.png", view.name())));
        // The message shows the absolute path, because a scene that was never saved has no folder.
        let path = std::path::absolute(&path).unwrap_or(path);
        let scene = self.document.scene().clone();
        // A picture of the state before an edit must not carry the scene after it.
        let is_of_it = !self.threads.sensing.is_stale(source, scene.rev);
        let picture = RgbaPicture { width, height, rgba };
        match save_png(is_of_it.then(|| (&*scene, self.parameters())), &picture, &path) {
            Ok(()) => {
                let text = tf!(
                    "Saved {file} ({width} × {height})",
                    file = path.display(),
                    width = width,
                    height = height,
                );
                self.toasts.push(MessageLevel::Info, text, self.now_s());
            }
            Err(error) => self.fail(tf!("No picture saved: {error}", error = one_line(&error))),
        }
    }

    pub(crate) fn screenshot(&mut self, path: &Path) {
        let scene = self.document.scene().clone();
        let made = self.parameters();
        let shot = self.views.view3d.screenshot(&scene, &self.state.shown, None);
        let saved = shot.and_then(|([width, height], rgba)| {
            let [w, h] = [width, height].map(|side| side as usize);
            let picture = RgbaPicture {
                width: w,
                height: h,
                rgba,
            };
            save_png(Some((&*scene, made)), &picture, path)?;
            Ok([width, height])
        });
        match saved {
            Ok([width, height]) => {
                let now_s = self.now_s();
                let text = tf!(
                    "Saved {file} ({width} × {height})",
                    file = path.display(),
                    width = width,
                    height = height,
                );
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
            Err(error) => self.fail(tf!("No screenshot: {error}", error = one_line(&error))),
        }
    }
}

/// Writes a picture, with the scene inside if it is known. The file is written whole or not at all.
fn save_png(
    scene: Option<(&Scene, serde_json::Value)>,
    picture: &RgbaPicture,
    path: &Path,
) -> anyhow::Result<()> {
    let bytes = match scene {
        Some((scene, made)) => capture::to_png_made_with(scene, picture, made)?,
        None => formats::png::rgba(picture.width, picture.height, &picture.rgba, &Default::default())?,
    };
    formats::atomic::write(path, &bytes)?;
    Ok(())
}

/// The first free name: `a.png`, `a_1.png`, `a_2.png` and so on.
fn free_name(path: &Path) -> PathBuf {
    let stem = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let numbered = |i: u32| path.with_file_name(format!("{stem}_{i}.{extension}"));
    std::iter::once(path.to_path_buf())
        .chain((1..10_000).map(numbered))
        .find(|p| !p.exists())
        .unwrap_or_else(|| path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_leads_back_to_its_scene() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("shot.png");
        let scene = open::from_template("straight", 3).expect("a template");
        let picture = RgbaPicture::filled(4, 3, [9, 8, 7]);
        let made = serde_json::json!({"params": {"seed": 7}});
        save_png(Some((&scene, made)), &picture, &path).expect("written");
        let back = crate::scene_of(&path).expect("a scene inside");
        assert!(back.canvas() == scene.canvas());
        let bytes = std::fs::read(&path).expect("written");
        let inside = formats::png::notes_inside(&bytes).expect("sound");
        let recipe = inside.text.iter().find(|(name, _)| name == "recipe");
        let recipe: formats::recipe::Recipe =
            serde_json::from_str(&recipe.expect("there").1).expect("as written");
        assert_eq!(recipe.parameters["params"]["seed"], 7);
        // A failed write leaves no file behind.
        let nowhere = folder.path().join("missing").join("shot.png");
        assert!(save_png(None, &picture, &nowhere).is_err() && !nowhere.exists());
    }

    #[test]
    fn names_that_are_taken_get_a_number() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = folder.path().join("a.png");
        assert_eq!(free_name(&first), first);
        std::fs::write(&first, "").expect("a file");
        assert_eq!(free_name(&first), folder.path().join("a_1.png"));
    }
}
