//! Carries out commands, after the frame was drawn.

use std::path::{Path, PathBuf};

use crossbeam_channel::bounded;
use egui::Context;

use editor::Edit;
use editor::document::Label;
use editor::tools::{add_box, brush, region, select, voxel};
use scene::SceneBox;

use super::application::{Next, Opening, SceneloomApp, one_line};
use super::command::Command;
use super::compare::CompareMode;
use super::dock::{Dock, Workspace};
use super::file_dialogs::Purpose;
use super::open;
use super::panels::objects::neighbour;
use super::panels::toasts::Level;
use super::state::{Pane, UiState};
use super::tools::{Choose, ToolCommand, ToolId};

impl SceneloomApp {
    /// Carries out one command.
    pub fn execute(&mut self, command: Command, ctx: &Context) {
        let before = self.document.settled_scene().rev;
        let travels = matches!(command, Command::Undo | Command::Redo | Command::JumpTo(_));
        self.state.remember_selection(before);
        match command {
            Command::Apply(label, edits) => self.apply(label, &edits),
            Command::ApplyWords(words, edits) => self.apply_words(&words, &edits),
            Command::Preview(edits) => {
                let edits = self.state.as_meant(edits);
                if let Err(error) = self.document.preview_all(&edits) {
                    self.fail(error.to_string());
                }
            }
            Command::Commit(label) => {
                self.document.commit_drag(label);
                self.note_correction();
            }
            Command::CancelDrag => self.document.cancel_drag(),
            Command::Undo => {
                self.document.undo();
            }
            Command::Redo => {
                self.document.redo();
            }
            Command::JumpTo(index) => drop(self.document.jump_to(index)),
            Command::Tools(command) => self.tool_command(command, ctx),
            Command::Select(id) => self.state.choose(id.as_slice(), Choose::Only),
            Command::SelectNext(step) => {
                let ids: Vec<_> = self.document.scene().frame().boxes.keys().copied().collect();
                let next = neighbour(&ids, self.state.selected, step);
                self.state.choose(next.as_slice(), Choose::Only);
            }
            Command::Escape => self.escape(),
            Command::DeleteSelected => self.tool_command(ToolCommand::Delete, ctx),
            Command::DuplicateSelected => self.tool_command(ToolCommand::Duplicate, ctx),
            Command::Nudge(step_m) => self.tool_command(ToolCommand::Nudge(step_m), ctx),
            Command::Turn(degrees) => self.tool_command(ToolCommand::Turn(degrees), ctx),
            Command::Tool(tool) => {
                let UiState { toolbox, tools, .. } = &mut self.state;
                toolbox.take(&mut tools.hand, tool);
            }
            Command::BrushSize(step) => self.state.step_brush(step),
            Command::Generate { full } => self.generate(full),
            Command::DrawScenery => self.draw_scenery(),
            Command::Decide(verdict) => self.decide(verdict),
            Command::StopHere => self.stop_here(),
            Command::CancelGeneration => {
                if let Some(running) = &mut self.live.running {
                    running.cancelled = true;
                    self.worker.cancel();
                    let now_s = self.now_s();
                    self.toasts.push(Level::Info, "Generation cancelled", now_s);
                }
            }
            Command::CancelWaiting => self.live.drop_waiting(self.document.settled_scene()),
            Command::CancelAll => {
                self.live.drop_waiting(self.document.settled_scene());
                self.execute(Command::CancelGeneration, ctx);
            }
            Command::KeepBookmark(slot) => self.keep_bookmark(slot),
            Command::GoToBookmark(slot) => self.go_to_bookmark(slot),
            Command::CompareWith(rev) => {
                let version = self.versions.of(rev).map(|i| &self.versions.list()[i]);
                self.compare.chosen = version.map(|v| v.scene.clone());
                if self.state.compare == CompareMode::Off {
                    self.state.compare = CompareMode::Wipe;
                }
            }
            Command::RestoreVersion(rev) => {
                if let Some(i) = self.versions.of(rev) {
                    let scene = self.versions.list()[i].scene.clone();
                    self.restore(&scene);
                }
            }
            Command::StepVersion(step) => {
                let rev = self.document.settled_scene().rev;
                if let Some(scene) = self.versions.neighbour(rev, step).cloned() {
                    self.restore(&scene);
                }
            }
            Command::CycleCompare => self.state.compare = self.state.compare.next(),
            Command::ToggleLive => {
                self.live.on = !self.live.on;
                self.live.forget_asked();
            }
            Command::ConfirmInferred => {
                self.state.correcting = false;
                self.apply("Confirm what was inferred", &[Edit::ConfirmInferred {}]);
            }
            Command::ClearPaint => self.apply("Unlock painted voxels", &[Edit::ClearPaint {}]),
            Command::New => self.guarded(Next::New, ctx),
            Command::Open => self.guarded(Next::AskOpen, ctx),
            Command::OpenPath(path) => self.guarded(Next::Open(path), ctx),
            Command::Save => match self.path.clone() {
                Some(path) => self.save_to(path, ctx),
                None => self.dialogs.ask(Purpose::SaveAs, &self.suggested("loom"), ctx),
            },
            Command::SaveAs => self.dialogs.ask(Purpose::SaveAs, &self.suggested("loom"), ctx),
            Command::ExportScreenshot => {
                self.dialogs.ask(Purpose::Screenshot, &self.suggested("png"), ctx);
            }
            Command::QuickShot => {
                let path = free_name(&self.suggested("png"));
                self.screenshot(&path);
            }
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::FrameSelection => self.frame_selection(),
            Command::FrameAll => match self.state.hovered_pane {
                Some(Pane::View3d) => self.view3d.camera.focus_all(),
                Some(Pane::Bev) => self.canvas.frame_all_again(),
                _ => {
                    self.view3d.camera.focus_all();
                    self.canvas.frame_all_again();
                }
            },
            Command::ToggleExport => self.toggle_export(),
            Command::FrameAt(p_in_ego) => self.frame_at(p_in_ego),
            Command::FixAll => self.fix_all(ctx),
            Command::ToggleChecks => self.dock.toggle(Pane::Checks),
            Command::View(preset) => self.view3d.preset(preset),
            Command::LookThrough(index) => self.look_through(index),
            Command::Inspect(camera) => self.state.inspected = camera,
            Command::SwapPanes => self.dock.swap(Pane::Bev, Pane::View3d),
            Command::ShowPane(pane) => self.dock.open(pane),
            Command::TogglePane(pane) => self.dock.toggle(pane),
            Command::Quality(stop) => self.set_quality(stop),
            Command::Calibrate => {
                let ctx = ctx.clone();
                self.tuning.calibrate(move || ctx.request_repaint());
            }
            Command::Refine => {
                let ctx = ctx.clone();
                self.tuning.refine(move || ctx.request_repaint());
            }
            Command::StopMeasuring => self.tuning.stop(),
            Command::MaximizePane => {
                if let Some(tile) = self.state.hovered_pane.and_then(|pane| self.dock.find(pane)) {
                    self.dock.toggle_maximized(tile);
                }
            }
            Command::Workspace(workspace) => {
                self.settings.workspace = workspace;
                self.dock = Dock::workspace(workspace);
                // Its tool comes to hand, unless one of the kind is there already.
                self.state.tool = match (workspace, self.state.tool) {
                    (Workspace::Paint, tool) if paints_map(tool) => tool,
                    (Workspace::Paint, _) => brush::ID,
                    (Workspace::Voxels, _) => voxel::ID,
                    (_, tool) if tool == brush::ID || tool == voxel::ID => select::ID,
                    (_, tool) => tool,
                };
            }
            Command::PlaceClass(class) => {
                self.state.tool = add_box::ID;
                self.state.box_class = class;
            }
            Command::TogglePalette => self.palette.toggle(),
            Command::ToggleSettings => self.state.settings_open = !self.state.settings_open,
            Command::ToggleStart => self.state.start_open = !self.state.start_open,
            Command::NewFromPrompt(ask) => self.scene_from_words(*ask, ctx),
            Command::FocusPrompt => {
                self.dock.open(Pane::Prompt);
                self.prompt.focus();
            }
            Command::NewFrom(name) => self.guarded(Next::NewFrom(name), ctx),
            Command::ToggleGrid => self.state.show_grid = !self.state.show_grid,
            Command::ToggleSensors => self.state.sensors_open = !self.state.sensors_open,
            Command::ImportRig => {
                let suggestion = self.suggested("json");
                self.dialogs.ask(Purpose::ImportRig, &suggestion, ctx);
            }
            Command::ExportRig => {
                let suggestion = self.suggested("json");
                self.dialogs.ask(Purpose::ExportRig, &suggestion, ctx);
            }
            Command::TogglePerformance => self.perf.open = !self.perf.open,
            Command::ToggleLog => self.state.log_open = !self.state.log_open,
            Command::ToggleKeys => self.state.keys_open = !self.state.keys_open,
        }
        // Without a guess there is nothing to correct, and no switch to see it by.
        self.state.correcting &= self.document.scene().frame().inferred.any();
        // What an edit or undo took away is not selected any more.
        self.state.tidy_selection(self.document.scene());
        let after = self.document.settled_scene().rev;
        if travels && after != before {
            self.state.recall_selection(after, self.document.scene());
        }
    }

    /// A version becomes the present state; its result is there already.
    fn restore(&mut self, scene: &scene::Scene) {
        self.worker.cancel();
        self.document.restore("Go to version", scene);
        self.live.source_changed();
        self.compare.chosen = None;
    }

    pub(super) fn fail(&mut self, text: String) {
        let now_s = self.now_s();
        self.toasts.push(Level::Error, text, now_s);
    }

    pub(super) fn apply(&mut self, label: impl Into<Label>, edits: &[Edit]) {
        if let Some(layer) = self.state.locked_layer(edits) {
            return self.fail(format!("Layer {:?} is locked", layer.label()));
        }
        if self.state.tools.things.locked && edits.iter().any(Edit::is_of_things) {
            return self.fail("Background things are locked".to_owned());
        }
        let edits = self.state.as_meant(edits.to_vec());
        if let Err(error) = self.document.apply_all(label, &edits) {
            self.fail(error.to_string());
        }
        self.note_correction();
    }

    /// A correction changes what the source was inverted under.
    pub(super) fn note_correction(&mut self) {
        if self.state.correcting {
            self.live.source_changed();
        }
    }

    fn selected_box(&self) -> Option<SceneBox> {
        let id = self.state.selected?;
        self.document.scene().frame().boxes.get(&id).copied()
    }

    fn escape(&mut self) {
        if self.document.is_dragging() {
            self.document.cancel_drag();
        } else if self.state.inspected.is_some() {
            self.state.inspected = None;
        } else if !self.state.tools.voxels.is_empty() {
            self.state.tools.voxels.clear();
        } else if self.state.tool != select::ID {
            self.state.tool = select::ID;
        } else if self.state.any_chosen() {
            self.state.choose(&[], Choose::Only);
        } else {
            self.state.correcting = false;
        }
    }

    fn generate(&mut self, full: bool) {
        if self.document.is_dragging() {
            return;
        }
        let scene = self.document.settled_scene().clone();
        let now_s = self.now_s();
        let anew = !full && !self.state.tools.region.is_empty();
        if !full && !anew && self.live.look(&scene, now_s).is_empty {
            self.toasts
                .push(Level::Info, "Nothing was edited since the last generation", now_s);
            return;
        }
        let mut params = self.live.params_for(&scene, full);
        if anew {
            self.state.tools.draw_anew(&mut params);
        }
        if full && self.draws_scenery_first() {
            return self.generate_on_scenery(params);
        }
        let same = |r: &super::live::Running| r.key.rev == scene.rev && r.key.params == params;
        if !self.live.running.as_ref().is_some_and(same) {
            self.live.look(&scene, now_s);
            self.submit(scene, params);
        }
    }

    /// Puts a stop's settings to use, from the next edit on.
    pub(super) fn set_quality(&mut self, stop: usize) {
        let Some(stop) = self.tuning.stops.stops.get(stop) else {
            return;
        };
        self.live.params = stop.knobs.on(self.live.params);
        self.settings.quality.clone_from(&stop.name);
        // The source's trajectory belongs to its settings.
        self.live.source_changed();
    }

    fn frame_selection(&mut self) {
        let Some(b) = self.selected_box() else {
            return self.frame_things();
        };
        if self.state.hovered_pane != Some(Pane::View3d) {
            self.canvas.frame_box(&b);
        }
        if self.state.hovered_pane != Some(Pane::Bev) {
            self.view3d.frame_box(&b);
        }
    }

    fn look_through(&mut self, index: usize) {
        if let Some(camera) = self.document.scene().rig.cameras.get(index) {
            self.view3d.camera = viewport::ViewCamera::through(camera);
        }
    }

    /// Goes on at once if nothing is unsaved, else asks first.
    fn guarded(&mut self, next: Next, ctx: &Context) {
        if self.document.is_dirty() {
            self.unsaved = Some(next);
        } else {
            self.go_on(next, ctx);
        }
    }

    pub(super) fn go_on(&mut self, next: Next, ctx: &Context) {
        match next {
            Next::Quit => {
                self.may_close = true;
                if let Some(recovery) = &mut self.recovery {
                    recovery.forget();
                }
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            Next::AskOpen => {
                let folder = self.suggested("loom");
                let folder = folder.parent().unwrap_or(Path::new("")).join("");
                self.dialogs.ask(Purpose::Open, &folder, ctx);
            }
            Next::New => {
                let make = self.io.2.clone();
                self.load("New scene".into(), None, false, ctx, move || make());
            }
            Next::NewFrom(name) => {
                let seed = std::time::SystemTime::now()
                    .duration_since(std::time::UNIX_EPOCH)
                    .map_or(1, |d| u64::from(d.subsec_nanos()) % 100_000);
                let make = move || {
                    open::from_template(name, seed)
                        .ok_or_else(|| anyhow::anyhow!("there is no template {name:?}"))
                };
                self.load("New scene".into(), None, false, ctx, make);
            }
            Next::Open(path) => {
                let (open, file) = (self.io.0.clone(), path.clone());
                let what = format!("Opening {}", path.display());
                let own_file = path.extension().is_some_and(|e| e == "loom").then_some(path);
                let is_import = own_file.is_none();
                self.load(what, own_file, is_import, ctx, move || open(&file));
            }
        }
    }

    /// Makes a scene on a thread of its own; the window goes on meanwhile.
    pub(super) fn load(
        &mut self,
        what: String,
        path: Option<PathBuf>,
        is_import: bool,
        ctx: &Context,
        make: impl FnOnce() -> anyhow::Result<scene::Scene> + Send + 'static,
    ) {
        let (send, scene) = bounded(1);
        let wake = ctx.clone();
        let thread = std::thread::Builder::new().name("open".into()).spawn(move || {
            // Nobody listens if something else was opened meanwhile.
            let _ = send.send(make());
            wake.request_repaint();
        });
        match thread {
            Ok(_) => {
                self.opening = Some(Opening {
                    path,
                    what,
                    is_import,
                    step: None,
                    scene,
                })
            }
            Err(error) => self.fail(format!("{what}: {error}")),
        }
    }

    pub(super) fn file_chosen(&mut self, purpose: Purpose, path: PathBuf, ctx: &Context) {
        match purpose {
            Purpose::Open => self.go_on(Next::Open(path), ctx),
            Purpose::SaveAs => self.save_to(path, ctx),
            Purpose::Screenshot => self.screenshot(&path),
            Purpose::ImportRig => self.import_rig(&path),
            Purpose::ExportRig => self.export_rig(&path),
            Purpose::ExportFile | Purpose::ExportFolder => {
                if let Some(panel) = &mut self.exporting.panel {
                    panel.path = path.display().to_string();
                }
            }
        }
    }

    fn import_rig(&mut self, path: &Path) {
        match open::rig(path) {
            Ok(rig) => {
                let rig = Box::new(rig);
                self.apply("Import sensors", &[Edit::SetRig { rig }]);
            }
            Err(error) => self.fail(format!("Not imported: {}", one_line(&error))),
        }
    }

    fn export_rig(&mut self, path: &Path) {
        let saved = open::save_rig(&self.document.scene().rig, path);
        let now_s = self.now_s();
        match saved {
            Ok(()) => self
                .toasts
                .push(Level::Info, format!("Saved {}", path.display()), now_s),
            Err(error) => self.fail(format!("Not saved: {}", one_line(&error))),
        }
    }

    fn save_to(&mut self, path: PathBuf, ctx: &Context) {
        self.document.cancel_drag();
        let scene = self.document.settled_scene().clone();
        let next = self.after_save.take();
        match (self.io.1)(&scene, &path) {
            Ok(()) => {
                self.document.mark_saved();
                let now_s = self.now_s();
                self.toasts
                    .push(Level::Info, format!("Saved {}", path.display()), now_s);
                self.settings.remember(&path);
                self.path = Some(path);
                if let Some(next) = next {
                    self.go_on(next, ctx);
                }
            }
            Err(error) => self.fail(format!("Not saved: {}", one_line(&error))),
        }
    }

    /// A path beside the scene's file, or in the working folder, named after the scene.
    pub(super) fn suggested(&self, extension: &str) -> PathBuf {
        match &self.path {
            Some(path) => path.with_extension(extension),
            None => {
                let name = &self.document.scene().name;
                let tidy: String = name
                    .chars()
                    .map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' })
                    .collect();
                let folder = std::env::current_dir().unwrap_or_default();
                folder.join(format!("{tidy}.{extension}"))
            }
        }
    }

    fn screenshot(&mut self, path: &Path) {
        let scene = self.document.scene().clone();
        let shot = self.view3d.screenshot(&scene, &self.state, None);
        let saved = shot.and_then(|([width, height], rgba)| {
            image::save_buffer(path, &rgba, width, height, image::ColorType::Rgba8)?;
            Ok([width, height])
        });
        match saved {
            Ok([width, height]) => {
                let now_s = self.now_s();
                let text = format!("Saved {} ({width} × {height})", path.display());
                self.toasts.push(Level::Info, text, now_s);
            }
            Err(error) => self.fail(format!("No screenshot: {}", one_line(&error))),
        }
    }
}

/// True for a tool of the workspace that paints the map.
fn paints_map(tool: ToolId) -> bool {
    tool == region::ID || tool.def().paints && tool != voxel::ID
}

/// `a.png`, or if it is taken `a_1.png`, `a_2.png` and so on.
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
    fn names_that_are_taken_get_a_number() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = folder.path().join("a.png");
        assert_eq!(free_name(&first), first);
        std::fs::write(&first, "").expect("a file");
        assert_eq!(free_name(&first), folder.path().join("a_1.png"));
    }
}
