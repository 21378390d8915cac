//! The application: owns document, worker, sensing and views; draws them, then carries out what the
//! user asked for.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, TryRecvError};
use egui::{Rect, Ui};

use crate::editor::Document;
use crate::editor::checks::{Severity, waive};
use crate::generation::job::{
    GenError, GenParams, GenResult, Job, JobCtx, JobEvent, JobUpdate, Named, Pipeline, UpdateGate,
};
use crate::generation::redraw::RedrawMask;
use crate::generation::worker::GenWorker;
use crate::scene::{Scene, SceneRev};

use super::camera_views::Wanted;
use super::canvas::Canvas;
use super::checking::Checking;
use super::command::Command;
use super::compare::Compare;
use super::dock::Dock;
use super::exporting::Exporting;
use super::file_dialogs::FileDialogs;
use super::keymap::Keymap;
use super::keys;
use super::keys::Hands;
use super::live::{Advice, Bounds, Live, Purpose};
use super::panels::box_views::BoxViewsPane;
use super::panels::cameras::{CameraStrip, CamerasInput};
use super::panels::dialogs::{self, Unsaved};
use super::panels::lidar_sweep::SweepPane;
use super::panels::palette::Palette;
use super::panels::performance::performance_ui;
use super::panels::prompt::PromptPane;
use super::panels::sensors::sensors_ui;
use super::panels::settings::settings_ui;
use super::panels::shortcuts::Shortcuts;
use super::panels::start::start_ui;
use super::panels::status::{Receipt, StatusInput, status_ui};
use super::panels::toasts::{Level, Toasts};
use super::panels::toolbar::{ToolbarInput, toolbar_ui};
use super::perf::Perf;
use super::recovery::Recovery;
use super::sensing::Sensing;
use super::settings::Settings;
use super::state::{Pane, UiState};
use super::theme;
use super::tuning::Tuning;
use super::versions::Versions;
use super::view3d::View3d;

/// Reads a scene from a file of any kind that can be opened.
pub type OpenScene = Arc<dyn Fn(&Path) -> anyhow::Result<Scene> + Send + Sync>;
/// Writes a scene to a `.loom` file.
pub type SaveScene = Arc<dyn Fn(&Scene, &Path) -> anyhow::Result<()> + Send + Sync>;
/// Makes a new scene.
pub type NewScene = Arc<dyn Fn() -> anyhow::Result<Scene> + Send + Sync>;
/// Makes the pipeline, on the worker's thread.
pub type BuildPipeline = Box<dyn FnMut() -> Result<Box<dyn Pipeline>, GenError> + Send>;

/// What the application starts with.
pub struct AppConfig {
    /// The scene to show.
    pub scene: Scene,
    /// Its file, if it has one.
    pub path: Option<PathBuf>,
    /// Makes the pipeline.
    pub build_pipeline: BuildPipeline,
    /// How to generate what was edited.
    pub params: GenParams,
    /// How to generate everything.
    pub full_params: GenParams,
    /// Send a job that edits nothing when a scene was opened, so that the pipeline can get ready.
    pub warm_up: bool,
    /// Opens files.
    pub open: OpenScene,
    /// Saves files.
    pub save: SaveScene,
    /// Makes new scenes.
    pub new_scene: NewScene,
    /// Ask the system for file dialogs; false: only the path field.
    pub native_dialogs: bool,
    /// Where settings are kept; none: standard ones, kept nowhere.
    pub settings_file: Option<PathBuf>,
}

/// [`GenWorker`] wants a type; this is one for whatever the configuration makes.
struct AnyPipeline(Box<dyn Pipeline>);

impl Pipeline for AnyPipeline {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        self.0.run(job, ctx)
    }
}

/// What to do once unsaved changes are dealt with.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Next {
    New,
    NewFrom(&'static str),
    AskOpen,
    Open(PathBuf),
    Quit,
}

/// A scene on its way from a file.
pub(super) struct Opening {
    pub path: Option<PathBuf>,
    pub what: String,
    /// From a file that is no scene: its occupancy is a draft.
    pub is_import: bool,
    /// It becomes an undo step of this name, not a document of its own.
    pub step: Option<&'static str>,
    pub scene: Receiver<anyhow::Result<Scene>>,
}

/// The window's contents. Works without eframe and without a graphics device, for tests.
pub struct SceneloomApp {
    /// What is edited.
    pub document: Document,
    /// What the window shows and holds in hand.
    pub state: UiState,
    /// The bird's-eye view.
    pub canvas: Canvas,
    /// The 3D view.
    pub view3d: View3d,
    /// The scheduler.
    pub live: Live,
    /// Of the last generation.
    pub receipt: Option<Receipt>,
    /// Messages.
    pub toasts: Toasts,
    /// Findings of the quality checks.
    pub checking: Checking,
    /// Copies of unsaved work; none in tests.
    pub recovery: Option<Recovery>,
    /// How fast the window is.
    pub perf: Perf,
    pub(super) exporting: Exporting,
    /// The quality slider.
    pub tuning: Tuning,
    pub(super) path: Option<PathBuf>,
    pub(super) worker: GenWorker,
    pub(super) dialogs: FileDialogs,
    pub(super) opening: Option<Opening>,
    /// Waits for an answer about unsaved changes.
    pub(super) unsaved: Option<Next>,
    /// Goes on after the scene was saved.
    pub(super) after_save: Option<Next>,
    pub(super) may_close: bool,
    pub(super) io: (OpenScene, SaveScene, NewScene),
    pub(super) clock: Instant,
    gate: UpdateGate,
    pub(super) sensing: Sensing,
    pub(super) strip: CameraStrip,
    pub(super) sweep: SweepPane,
    pub(super) box_views: BoxViewsPane,
    pub(super) dock: Dock,
    /// What was generated so far.
    pub versions: Versions,
    pub(super) compare: Compare,
    pub(super) prompt: PromptPane,
    pub(super) render_state: Option<egui_wgpu::RenderState>,
    pub(super) palette: Palette,
    /// What is kept between sessions.
    pub settings: Settings,
    /// What each chord calls for.
    pub keymap: Keymap,
    shortcuts: Shortcuts,
    kept: (Option<PathBuf>, Settings, f64), // file of the settings, what it holds, when it was compared, s
    finished: Option<(Arc<GenResult>, Option<&'static str>)>, // came during a drag, and the label if it is a step
    preview: Option<(SceneRev, Arc<Scene>)>,
    title: String,
    center: Rect,
    passes: u32,
    ctx: egui::Context,
    pub(super) unsettled: Arc<[Bounds]>, // columns that are to be generated
}

impl SceneloomApp {
    /// Starts worker and sensing. Errors if the system gives no thread.
    pub fn new(
        config: AppConfig,
        render_state: Option<egui_wgpu::RenderState>,
        ctx: &egui::Context,
    ) -> std::io::Result<Self> {
        let (settings, complaint) = match config.settings_file.as_deref().map(Settings::load) {
            Some(Ok(settings)) => (settings, None),
            Some(Err(error)) => (Settings::default(), Some(one_line(&error))),
            None => (Settings::default(), None),
        };
        theme::apply(ctx, settings.look);
        settings.classes.make_current();
        if settings.ui_scale != 1.0 {
            ctx.set_zoom_factor(settings.ui_scale);
        }
        let mut toasts = Toasts::default();
        if let Some(text) = complaint {
            toasts.push(Level::Error, format!("Standard settings are used: {text}"), 0.0);
        }
        let state = UiState {
            start_open: settings.start_screen && config.settings_file.is_some() && config.path.is_none(),
            ..UiState::default()
        };
        // On a software rasteriser a frame costs the time of a step of generation: fewer of them then.
        let view3d = View3d::new(render_state.clone());
        let mut versions = Versions::default();
        versions.push("As opened".into(), String::new(), Arc::new(config.scene.clone()));
        let (between_frames_s, sensing_grace) = match view3d.is_software() {
            true => (0.15, Duration::from_millis(25)),
            false => (0.015, Duration::ZERO),
        };
        let wake = waker(ctx, between_frames_s);
        let mut build = config.build_pipeline;
        let worker = GenWorker::spawn(move || build().map(AnyPipeline), Arc::new(wake.clone()))?;
        let tuning = Tuning::new(config.settings_file.as_deref());
        // Whoever starts the window without settings names its parameters.
        let quality = tuning
            .stops
            .named(&settings.quality)
            .filter(|_| config.settings_file.is_some());
        let params = quality.map_or(config.params, |stop| stop.knobs.on(config.params));
        Ok(Self {
            tuning,
            document: Document::new(config.scene),
            state,
            canvas: Canvas::default(),
            view3d,
            live: Live::new(params, config.full_params, config.warm_up),
            receipt: None,
            toasts,
            checking: Checking::spawn(wake.clone())?,
            recovery: None,
            perf: Perf::default(),
            exporting: Exporting::default(),
            path: config.path,
            worker,
            dialogs: FileDialogs::new(config.native_dialogs),
            opening: None,
            unsaved: None,
            after_save: None,
            may_close: false,
            io: (config.open, config.save, config.new_scene),
            clock: Instant::now(),
            gate: UpdateGate::default(),
            sensing: Sensing::spawn(sensing_grace, wake)?,
            strip: CameraStrip::default(),
            sweep: SweepPane::default(),
            box_views: BoxViewsPane::default(),
            dock: settings
                .dock
                .clone()
                .and_then(Dock::from_kept)
                .map(|dock| dock.with_new_panes(&settings.panes_known))
                .unwrap_or_else(|| Dock::workspace(settings.workspace)),
            keymap: Keymap::new(&settings.key_preset, settings.keys.clone()),
            palette: Palette::default(),
            versions,
            compare: Compare::default(),
            prompt: PromptPane::default(),
            render_state,
            shortcuts: Shortcuts::default(),
            kept: (config.settings_file, settings.clone(), 0.0),
            settings,
            finished: None,
            preview: None,
            title: String::new(),
            center: Rect::NOTHING,
            passes: 0,
            ctx: ctx.clone(),
            unsettled: Arc::default(),
        })
    }

    /// Seconds since the start.
    pub fn now_s(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    /// File of the scene, if it has one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// What the sensors returned last.
    pub fn sensing(&self) -> &Sensing {
        &self.sensing
    }

    /// True if LiDAR and cameras show the state on screen.
    pub fn sensors_are_current(&self) -> bool {
        let rev = self.document.scene().rev;
        !self.sensing.cameras_stale(rev) && !self.sensing.lidar_stale(rev)
    }

    /// The document's scene, or a preview of its generation.
    fn shown_scene(&self) -> Arc<Scene> {
        if let (true, Some(before)) = (self.state.holding_before, &self.compare.before) {
            return before.clone();
        }
        match &self.preview {
            Some((rev, scene)) if *rev == self.document.scene().rev => scene.clone(),
            _ => self.document.scene().clone(),
        }
    }

    /// Everything that happens without drawing: news of the worker, of sensing, of files.
    pub fn update(&mut self, ctx: &egui::Context) {
        self.sensing.drain();
        self.tuning.update();
        if self.document.history_limit() != self.settings.history_bytes() {
            self.document.set_history_limit(self.settings.history_bytes());
        }
        let events: Vec<JobEvent> = self.worker.updates().try_iter().collect();
        for event in events {
            if self.gate.admit(&event) {
                self.take_event(event);
            }
        }
        if !self.document.is_dragging()
            && let Some((result, own_step)) = self.finished.take()
        {
            self.adopt(&result, own_step);
        }
        self.take_opened(ctx);
        if let Some((purpose, path)) = self.dialogs.poll() {
            self.file_chosen(purpose, path, ctx);
        }
        // The first picture comes first.
        if self.passes > 1 {
            self.schedule(ctx);
        }
        self.update_checks(ctx);
        self.update_recovery(ctx);
        self.update_export();
        self.set_title(ctx);
        self.keep_settings(ctx);
    }

    /// Puts changed settings to use, and writes them two seconds later at most.
    fn keep_settings(&mut self, ctx: &egui::Context) {
        const EVERY_S: f64 = 2.0;
        if self.settings.look != self.kept.1.look || self.settings.classes != self.kept.1.classes {
            theme::apply(ctx, self.settings.look);
            self.settings.classes.make_current();
            self.canvas.forget_pictures();
            self.strip = CameraStrip::default();
            self.view3d.forget_pictures();
            (self.kept.1.look, self.kept.1.classes) = (self.settings.look, self.settings.classes);
            self.kept.2 = f64::NEG_INFINITY;
        }
        if self.now_s() - self.kept.2 >= EVERY_S {
            self.write_settings(ctx);
        }
    }

    fn write_settings(&mut self, ctx: &egui::Context) {
        self.settings.ui_scale = ctx.zoom_factor();
        self.settings.dock = Some(self.dock.tree().clone());
        self.settings.panes_known = Pane::CHOICES.to_vec();
        self.settings.key_preset.clone_from(&self.keymap.preset);
        self.settings.keys.clone_from(&self.keymap.own);
        let now_s = self.now_s();
        let (file, kept, at_s) = &mut self.kept;
        let forced = *at_s == f64::NEG_INFINITY;
        *at_s = now_s;
        let Some(path) = file.as_deref() else { return };
        if (forced || *kept != self.settings)
            && let Err(error) = self.settings.save(path)
        {
            let text = format!("Settings are not kept: {}", one_line(&error));
            self.toasts.push(Level::Error, text, now_s);
            *file = None; // said once
        }
        self.kept.1 = self.settings.clone();
    }

    fn schedule(&mut self, ctx: &egui::Context) {
        let now_s = self.now_s();
        let scene = self.document.settled_scene().clone();
        self.live.foretold_s = self.tuning.foretold_now_s(&self.live.params);
        match self.live.advise(&scene, self.document.is_dragging(), now_s) {
            Advice::Rest => {}
            Advice::Wait(seconds) => {
                ctx.request_repaint_after(Duration::from_secs_f64(seconds));
            }
            Advice::Cancel => self.worker.cancel(),
            Advice::Submit(params) | Advice::WarmUp(params) => self.submit(scene, params),
        }
        // Small pictures while they will not last; the large ones cost as much as the generation itself.
        let for_a_moment = self.document.is_dragging() || self.live.running.is_some();
        let wanted = Wanted::of(&self.state);
        self.sensing.ask(self.document.scene(), wanted, for_a_moment);
    }

    pub(super) fn submit(&mut self, scene: Arc<Scene>, params: GenParams) {
        let now_s = self.now_s();
        let job = Job { scene, params };
        let key = job.key();
        let id = self.worker.submit(job);
        self.perf.job_begins();
        self.live.submitted(id, key, now_s);
    }

    fn take_event(&mut self, event: JobEvent) {
        match event.update {
            JobUpdate::Progress { stage, step, steps } => {
                if let Some(running) = self.live.running.as_mut().filter(|r| r.id == event.id) {
                    running.progress = Some((stage, step, steps));
                    self.perf.stage(stage, self.clock.elapsed().as_secs_f64());
                }
            }
            JobUpdate::Preview(result) => {
                let mut scene = Scene::clone(self.document.scene());
                if scene.rev == result.rev() {
                    let rev = scene.rev;
                    scene.frame_mut().occupancy = result.occupancy.clone();
                    self.preview = Some((rev, Arc::new(scene)));
                }
            }
            JobUpdate::Finished(result) => {
                let now_s = self.now_s();
                let mut own_step = None;
                if let Some(running) = self.live.ended(event.id) {
                    own_step = running.own_step();
                    let settled_s = (running.purpose == Purpose::Edit).then_some(now_s - running.edited_s);
                    self.perf.job_ended(now_s, settled_s, "finished");
                    let full = running.purpose == Purpose::Full;
                    if running.purpose == Purpose::WarmUp {
                        let calls = result.report.network_calls;
                        let took_s = now_s - running.submitted_s;
                        self.toasts.log(
                            format!("Ready to edit after {took_s:.1} s, {calls} network calls"),
                            now_s,
                        );
                        return;
                    }
                    // What is drawn anew says nothing about the time of an edit.
                    if !full && running.key.params.strength == 0.0 {
                        self.live.took(running.share, now_s - running.submitted_s);
                    }
                    if !full && running.key.rev == self.document.settled_scene().rev {
                        let edited = self.document.settled_scene().clone();
                        self.tuning.note(edited, result.clone(), now_s - running.edited_s);
                    }
                    if running.key.rev == self.document.settled_scene().rev {
                        self.receipt = Some(Receipt::new(&result.report, now_s - running.edited_s, full));
                    }
                }
                if self.document.is_dragging() {
                    self.finished = Some((result, own_step));
                } else {
                    self.adopt(&result, own_step);
                }
            }
            JobUpdate::Failed(error) => {
                self.live.ended(event.id);
                self.preview = None;
                self.tuning.note_failure(&error.to_string());
                let now_s = self.now_s();
                self.perf.job_ended(now_s, None, "failed");
                let paused = if std::mem::replace(&mut self.live.on, false) {
                    " Live is off now."
                } else {
                    ""
                };
                self.toasts.push(
                    Level::Error,
                    format!("Generation failed: {error}.{paused}"),
                    now_s,
                );
            }
            JobUpdate::Superseded => {
                if self.live.ended(event.id).is_some() {
                    self.perf.job_ended(self.now_s(), None, "cancelled");
                }
                self.preview = None;
            }
        }
    }

    /// Takes a result into the document, if it still shows the state it was made for.
    fn adopt(&mut self, result: &GenResult, own_step: Option<&'static str>) {
        self.preview = None;
        // What the user asked to be drawn anew is a step of its own; what follows an edit belongs to that edit.
        let adopted = match own_step {
            Some(label) => self
                .document
                .adopt_as_step(label, result.rev(), result.occupancy.clone())
                .is_ok(),
            None => self
                .document
                .adopt(result.rev(), result.occupancy.clone())
                .is_ok(),
        };
        if adopted {
            let now_s = self.now_s();
            let note = self.receipt.as_ref().map_or_else(String::new, Receipt::text);
            let label = self.document.undo_label().unwrap_or("Generated");
            let scene = self.document.settled_scene().clone();
            self.versions.push(label.to_owned(), note.clone(), scene);
            self.compare.chosen = None;
            if self.receipt.is_some() {
                self.toasts.log(note, now_s);
            }
            for note in &result.report.notes {
                self.toasts.log(note.clone(), now_s);
            }
        }
    }

    fn take_opened(&mut self, ctx: &egui::Context) {
        let Some(opening) = &self.opening else { return };
        let answer = match opening.scene.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(answer) => answer,
            Err(TryRecvError::Disconnected) => Err(anyhow::anyhow!("reading it ended unexpectedly")),
        };
        let Some(opening) = self.opening.take() else {
            return;
        };
        let now_s = self.now_s();
        match answer {
            Ok(scene) => {
                self.worker.cancel();
                self.live.reset();
                (self.receipt, self.finished, self.preview) = (None, None, None);
                self.tuning.reset();
                if opening.is_import {
                    let text = format!("Imported {} as a draft. Ctrl+Enter generates it.", scene.name);
                    self.toasts.push(Level::Info, text, now_s);
                } else {
                    self.toasts.log(format!("Opened {}", scene.name), now_s);
                }
                let version = match opening.step {
                    Some(label) => {
                        self.document.restore(label, &scene);
                        label
                    }
                    None => {
                        self.document = Document::new(scene);
                        self.versions.clear();
                        "As opened"
                    }
                };
                let opened = self.document.settled_scene().clone();
                self.versions.push(version.into(), String::new(), opened);
                self.compare.chosen = None;
                if let Some(path) = &opening.path {
                    self.settings.remember(path);
                }
                // What the camera looked at is not there any more.
                self.view3d.camera.focus_all();
                // Saving must not replace the file of another scene without asking.
                self.path = opening.path;
                self.state.choose(&[], super::tools::Choose::Only);
                self.state.correcting = false;
                self.state.tools.region = RedrawMask::default();
                self.state.named = Named::default();
                self.note_opened(&opening.what, true);
                ctx.request_repaint();
            }
            Err(error) => {
                self.note_opened(&opening.what, false);
                let text = format!("{}: {}", opening.what, one_line(&error));
                self.toasts.push(Level::Error, text, now_s);
            }
        }
    }

    fn set_title(&mut self, ctx: &egui::Context) {
        let mark = if self.document.is_dirty() { "● " } else { "" };
        let title = format!("{mark}{} – Sceneloom", self.document.scene().name);
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Draws the window and carries out what the user asked for.
    pub fn draw(&mut self, ui: &mut Ui) {
        self.passes = self.passes.saturating_add(1);
        let mut commands = Vec::new();
        self.take_window_events(ui.ctx(), &mut commands);
        self.prepare_compare(ui);
        let scene = self.shown_scene();
        // What a dialog covers answers nothing, and keeps no tooltip open over it.
        let mut below = ui.new_child(egui::UiBuilder::new().max_rect(ui.max_rect()));
        if self.has_dialog() {
            below.visuals_mut().disabled_alpha = 1.0;
            below.disable();
        }
        self.bars(&mut below, &scene, &mut commands);
        self.views(&mut below, &scene, &mut commands);
        // Asked before: the key that closes a dialog is no shortcut.
        let dialog = self.has_dialog();
        self.overlays(ui, &scene, &mut commands);
        // What is shown is not what a key would change.
        if !dialog && !self.state.holding_before {
            let (primary, secondary) = ui.input(|i| (i.pointer.primary_down(), i.pointer.secondary_down()));
            let hands = Hands {
                flying: secondary && self.state.hovered_pane == Some(Pane::View3d),
                dragging: primary && (self.canvas.is_dragging() || self.view3d.is_dragging()),
            };
            keys::commands(ui.ctx(), &self.keymap, &mut self.state, hands, &mut commands);
        }
        let any = !commands.is_empty();
        let before = self.document.scene().rev;
        for command in commands {
            self.execute(command, ui.ctx());
        }
        let edited = self.document.scene().rev != before;
        self.frame_drawn(ui.ctx(), edited);
        let at_once = edited && self.show_at_once(ui.ctx());
        if any && !at_once || self.passes < 3 {
            ui.ctx().request_repaint();
        }
    }

    /// True while a dialog lies over everything.
    fn has_dialog(&self) -> bool {
        self.unsaved.is_some()
            || self.dialogs.is_open()
            || self.state.keys_open
            || self.state.start_open
            || self.palette.open
            || self.asks_to_recover()
            || self.state.tools.row_open
    }

    fn take_window_events(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) {
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_path_buf()));
        commands.extend(dropped.map(Command::OpenPath));
        if ctx.input(|i| i.viewport().close_requested()) && !self.may_close && self.document.is_dirty() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.unsaved = Some(Next::Quit);
        }
    }

    fn bars(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let input = ToolbarInput {
            name: &scene.name,
            dirty: self.document.is_dirty(),
            recent: &self.settings.recent,
            undo: self.document.undo_label(),
            redo: self.document.redo_label(),
            live: self.live.on,
            busy: self.live.running.is_some(),
            waiting: self.live.has_waiting(self.document.settled_scene().rev),
            bookmarks: self.settings.bookmarks.keys().copied().collect(),
            has_paint: scene.frame().painted.iter_set().next().is_some(),
            workspace: self.settings.workspace,
            shown: Pane::CHOICES
                .into_iter()
                .filter(|p| self.dock.is_shown(*p))
                .collect(),
            cameras: scene.rig.cameras.len(),
            stops: self.tuning.foretold(),
            stop: self.tuning.current(&self.live.params),
        };
        egui::Panel::top("toolbar")
            .exact_size(42.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| toolbar_ui(ui, &input, &mut self.state, commands));
        let now_s = self.now_s();
        let settled = self.document.settled_scene().clone();
        let touched = self.live.look(&settled, now_s);
        self.unsettled = self.live.parts();
        let unsettled = !touched.is_empty;
        let findings = self.checking.findings().map(|all| {
            let open = waive::open(settled.frame(), all);
            let (errors, warnings): (Vec<_>, Vec<_>) = open.partition(|f| f.severity == Severity::Error);
            (errors.len(), warnings.len())
        });
        let status = StatusInput {
            findings,
            running: self.live.running.as_ref(),
            now_s,
            receipt: self.receipt.as_ref(),
            live: self.live.on,
            unsettled,
            busy_with: self.opening.as_ref().map(|o| o.what.as_str()),
            unread: self.toasts.unread(),
            paused: self.live.paused.as_ref(),
            waiting: self.live.has_waiting(settled.rev),
            dragging: self.document.is_dragging(),
            hint: &super::hints::hint(&self.state),
        };
        egui::Panel::bottom("status")
            .exact_size(28.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| status_ui(ui, &status, &self.state, commands));
        // The status bar has shown what the last frame found under the pointer.
        self.state.readout.clear();
    }

    fn views(&mut self, ui: &mut Ui, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        self.state.hovered_pane = None;
        self.center = ui.available_rect_before_wrap();
        self.dock_ui(ui, scene, commands);
        // What nobody lists is not pointed at.
        if !self.dock.is_shown(Pane::Checks) {
            self.state.meant = None;
        }
        self.live.named = self.state.named;
    }

    fn overlays(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let now_s = self.now_s();
        let cameras = cameras_input(scene, self.document.scene().rev, &self.sensing);
        self.strip
            .enlarged(ui, self.center, &cameras, &mut self.state, commands);
        self.toasts.log_window(ui, self.center, &mut self.state.log_open);
        if self.state.sensors_open {
            sensors_ui(ui, &scene.rig, &mut self.state, commands);
        }
        super::tools::dialogs::show(ui, scene.frame(), &mut self.state, commands);
        let recent = &self.settings.recent;
        self.palette
            .show(ui, &self.keymap, recent, &mut self.state, commands);
        self.shortcuts
            .show(ui, &mut self.keymap, &mut self.state.keys_open);
        settings_ui(ui, &mut self.settings, &mut self.state.settings_open);
        start_ui(ui, &mut self.settings, &mut self.state.start_open, commands);
        // Over the 3D view, where it hides no list.
        let over = match self.view3d.rect.is_positive() {
            true => self.view3d.rect,
            false => self.center,
        };
        performance_ui(ui, over, &mut self.perf);
        self.toasts.show(ui, self.center, now_s);
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            drop_hint(ui, self.center);
        }
        self.export_dialog(ui);
        self.recovery_dialog(ui);
        if self.unsaved.is_some()
            && let Some(answer) = dialogs::unsaved_ui(ui, &scene.name)
        {
            self.answer_unsaved(answer, ui.ctx());
        }
        if let Some((purpose, path)) = self.dialogs.show(ui) {
            let ctx = ui.ctx().clone();
            self.file_chosen(purpose, path, &ctx);
        }
    }

    fn answer_unsaved(&mut self, answer: Unsaved, ctx: &egui::Context) {
        let Some(next) = self.unsaved.take() else { return };
        match answer {
            Unsaved::Stay => {}
            Unsaved::Discard => self.go_on(next, ctx),
            Unsaved::Save => {
                self.after_save = Some(next);
                self.execute(Command::Save, ctx);
            }
        }
    }
}

/// Asks for a frame when called, at once but at most one per `every_s`.
fn waker(ctx: &egui::Context, every_s: f64) -> impl Fn() + Clone + Send + Sync + 'static {
    let ctx = ctx.clone();
    let last: Arc<std::sync::Mutex<Option<Instant>>> = Arc::default();
    move || {
        let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let now = Instant::now();
        let every = Duration::from_secs_f64(every_s);
        match last.map(|at| now.saturating_duration_since(at)) {
            Some(since) if since < every => ctx.request_repaint_after(every - since),
            _ => {
                *last = Some(now);
                ctx.request_repaint();
            }
        }
    }
}

pub(super) fn cameras_input<'a>(scene: &'a Scene, rev: SceneRev, sensing: &'a Sensing) -> CamerasInput<'a> {
    CamerasInput {
        scene,
        views: sensing.cameras(),
        prompt: &scene.prompt,
        stale: sensing.cameras_stale(rev),
        lidar_points: sensing.lidar().map(|l| l.points.len()),
    }
}

fn drop_hint(ui: &Ui, over: Rect) {
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
    let painter = ui.ctx().layer_painter(layer);
    painter.rect_filled(over, 0.0, egui::Color32::from_black_alpha(170));
    let font = egui::TextStyle::Heading.resolve(ui.style());
    painter.text(
        over.center(),
        egui::Align2::CENTER_CENTER,
        "Drop to open",
        font,
        theme::ON_CANVAS,
    );
}

/// An error with its causes on one line.
pub(super) fn one_line(error: &anyhow::Error) -> String {
    format!("{error:#}")
        .lines()
        .map(str::trim)
        .collect::<Vec<_>>()
        .join("; ")
}

impl eframe::App for SceneloomApp {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        // A frame that is laid out twice comes here twice; it is one frame.
        let first = ctx.current_pass_index() == 0;
        if first {
            self.frame_begins(frame.info().cpu_usage);
        }
        self.update(ctx);
        if first {
            self.perf.logic_done(self.now_s());
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.draw(ui);
    }

    fn on_exit(&mut self) {
        self.kept.2 = f64::NEG_INFINITY;
        let ctx = self.ctx.clone();
        self.write_settings(&ctx);
        self.perf.finish(None);
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::panel().to_normalized_gamma_f32()
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }
}
