//! The application: owns document, worker, sensing and views; draws them, then carries out what the
//! user asked for.

mod news;
mod window;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::Receiver;
use egui::{Rect, Ui};

use editor::Document;
use job::worker::GenWorker;
use job::{GenError, GenParams, GenResult, Job, JobCtx, JobEvent, Pipeline, UpdateGate};
use scene::{Scene, SceneRev};

use super::canvas::Canvas;
use super::checking::Checking;
use super::compare::Compare;
use super::dock::Dock;
use super::drawing::Drawing;
use super::exporting::Exporting;
use super::file_dialogs::FileDialogs;
use super::keymap::Keymap;
use super::live::{Bounds, Live};
use super::panels::box_views::BoxViewsPane;
use super::panels::cameras::{CameraStrip, CamerasInput};
use super::panels::lidar_sweep::SweepPane;
use super::panels::palette::Palette;
use super::panels::prompt::PromptPane;
use super::panels::shortcuts::Shortcuts;
use super::panels::status::Receipt;
use super::panels::toasts::{Level, Toasts};
use super::perf::Perf;
use super::recovery::Recovery;
use super::sensing::Sensing;
use super::settings::Settings;
use super::staged::Staged;
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
    pub(super) drawing: Option<Drawing>,
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
    pub(super) staged: Option<Staged>,
    pub(super) prompt: PromptPane,
    pub(super) render_state: Option<egui_wgpu::RenderState>,
    pub(super) palette: Palette,
    /// What is kept between sessions.
    pub settings: Settings,
    /// What each chord calls for.
    pub keymap: Keymap,
    shortcuts: Shortcuts,
    kept: (Option<PathBuf>, Settings, f64), // file of the settings, what it holds, when it was compared, s
    pub(super) drawn_first: Option<(SceneRev, Arc<Scene>)>, // scenery that waits for its generation, and the state before
    pub(super) words: Option<(SceneRev, Arc<Scene>)>, // the state that a sentence made, and the one before
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
            drawing: None,
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
            staged: None,
            words: None,
            drawn_first: None,
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
        self.update_drawing(ctx);
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

    fn set_title(&mut self, ctx: &egui::Context) {
        let mark = if self.document.is_dirty() { "● " } else { "" };
        let title = format!("{mark}{} – Sceneloom", self.document.scene().name);
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
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
        stale: sensing.cameras_stale(rev),
        lidar_points: sensing.lidar().map(|l| l.points.len()),
    }
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
