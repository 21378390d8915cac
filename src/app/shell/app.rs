//! The application. It owns the document, the worker, the sensors' threads and the views. In each frame it draws the
//! window, then carries out the commands that the user gave.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;

use editor::Document;
use job::worker;
use job::{GenError, GenParams, GenResult, Job, JobCtx, Pipeline};
use scene::{Extent, Scene, SceneRev};

use super::checking::Checking;
use super::dock::Dock;
use super::files::Disk;
use super::files::Files;
pub use super::files::{NewScene, OpenScene, SaveScene};
use super::folders;
use super::generation::Generation;
use super::guests::Guests;
use super::live::Live;
use super::perf::Perf;
use super::planning::Planning;
use super::preferences::Preferences;
use super::settings::{QUALITY, Settings};
use super::toasts::{MessageLevel, Toasts};
use super::tuning::Tuning;
use super::versions::{VersionedScene, Versions};
use super::views::Views;
use crate::sensing::Sensing;
use crate::state::UiState;
use crate::view3d::View3d;
use crate::windows::open::OpenWindows;
use crate::windows::palette::Palette;
use crate::windows::shortcuts::Shortcuts;
use language::tf;
use widgets::{fonts, theme};

/// Builds the pipeline, on the worker's thread.
pub type BuildPipeline = Box<dyn FnMut() -> Result<Box<dyn Pipeline>, GenError> + Send>;

/// Configuration of the application at the start.
pub struct AppConfig {
    /// The scene to show.
    pub scene: Scene,
    /// Its file, if it has one.
    pub path: Option<PathBuf>,
    /// The picture that held the scene, if it was opened from a picture.
    pub picture: Option<PathBuf>,
    /// Builds the pipeline.
    pub build_pipeline: BuildPipeline,
    /// Parameters of generation after an edit.
    pub params: GenParams,
    /// Parameters of generation of the whole scene.
    pub full_params: GenParams,
    /// True: after a scene is opened, a job that edits nothing warms up the pipeline for the first edit.
    pub warm_up: bool,
    /// Opens files.
    pub open: OpenScene,
    /// Saves files.
    pub save: SaveScene,
    /// Makes new scenes.
    pub new_scene: NewScene,
    /// True: uses the system's file dialogs. False: a field for the path only.
    pub native_dialogs: bool,
    /// File of the settings; `None`: default settings, not saved.
    pub settings_file: Option<PathBuf>,
}

/// Any pipeline that the configuration makes, as one type for the worker.
struct AnyPipeline(Box<dyn Pipeline>);

impl Pipeline for AnyPipeline {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        self.0.run(job, ctx)
    }
}

/// Threads that follow the scene.
pub struct SceneThreads {
    pub(crate) sensing: Sensing,
    /// Findings of the quality checks.
    pub checking: Checking,
    /// Repairs that are planned for them.
    pub planning: Planning,
}

/// Windows over the panes that have a state while they are open.
#[derive(Default)]
pub(crate) struct Overlays {
    pub palette: Palette,
    pub shortcuts: Shortcuts,
}

/// State for drawing frames: the clock, the time they took, the window's title.
pub struct Frames {
    /// Performance measurements.
    pub perf: Perf,
    pub(crate) clock: Instant,
    pub(crate) title: String,
    pub(crate) passes: u32,
}

/// The window's contents. Works without eframe and without a graphics device, for tests.
pub struct SceneloomApp {
    /// The scene with its history.
    pub document: Document,
    /// State of the views, the tools and the selection.
    pub state: UiState,
    /// Messages.
    pub toasts: Toasts,
    /// The scene's file, and reading and writing of files.
    pub files: Files,
    /// The worker and its results.
    pub generation: Generation,
    /// Views and panes.
    pub views: Views,
    /// Sensors and checks.
    pub threads: SceneThreads,
    pub(crate) overlays: Overlays,
    /// Settings and keys.
    pub preferences: Preferences,
    /// The window's frames.
    pub frames: Frames,
    /// Assistants that may drive the editor.
    pub guests: Guests,
    ctx: egui::Context,
}

impl SceneloomApp {
    /// Starts the threads. Errors if the system gives none.
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
        theme::apply(ctx, settings.theme);
        let strange = folders::settings().map_or_else(Vec::new, |f| language::add_from(&f.join("languages")));
        language::choose(&settings.language);
        fonts::apply(ctx, &settings.language);
        settings.classes.make_current();
        if settings.ui_scale != 1.0 {
            ctx.set_zoom_factor(settings.ui_scale);
        }
        let mut toasts = Toasts::default();
        for text in strange {
            toasts.push(MessageLevel::Error, text, 0.0);
        }
        if let Some(text) = complaint {
            let text = tf!("Standard settings are used: {error}", error = text);
            toasts.push(MessageLevel::Error, text, 0.0);
        }
        let state = UiState {
            brushes: settings.brushes.clone(),
            windows: OpenWindows {
                start: settings.start_screen
                    && config.settings_file.is_some()
                    && config.path.is_none()
                    && config.picture.is_none(),
                ..OpenWindows::default()
            },
            ..UiState::default()
        };
        // On a software rasteriser a frame takes as long as a step of generation, so fewer frames are drawn during
        // generation.
        let view3d = View3d::new(render_state.clone());
        let VersionedScene {
            scene,
            document,
            versions: kept,
            damaged,
            made,
            notes,
        } = match &config.picture {
            Some(picture) => VersionedScene::from_scene(config.scene).told_by(picture),
            None => VersionedScene::from_scene(config.scene),
        };
        let mut versions = Versions::default();
        versions.replace(kept);
        let shown = Arc::new(scene.clone());
        versions.push_made("As opened".into(), String::new(), shown, made.clone());
        let (between_frames_s, sensing_grace) = match view3d.is_software() {
            true => (0.15, Duration::from_millis(25)),
            false => (0.015, Duration::ZERO),
        };
        let wake = waker(ctx, between_frames_s);
        let mut build = config.build_pipeline;
        let worker = worker::spawn(move || build().map(AnyPipeline), Arc::new(wake.clone()))?;
        let tuning = Tuning::new(config.settings_file.as_deref());
        // Without a settings file the configuration's parameters are used.
        let quality = tuning
            .presets
            .named(&settings.quality)
            .or_else(|| tuning.presets.named(QUALITY)) // (old settings may name a removed preset)
            .filter(|_| config.settings_file.is_some());
        let params = quality.map_or(config.params.clone(), |preset| {
            preset.knobs.on(config.params.clone())
        });
        let dock = settings.dock.clone().and_then(Dock::from_kept);
        let dock = dock.map(|dock| dock.with_new_panes(&settings.panes_known));
        let dock = dock.unwrap_or_else(|| Dock::workspace(settings.workspace));
        let mut views = Views::new(view3d, dock, render_state);
        views.prompt.favourites.clone_from(&settings.kept_words);
        views.prompt.opened(&scene);
        let live = Live::new(params, config.full_params, config.warm_up);
        let disk = Disk {
            open: config.open,
            save: config.save,
            new_scene: config.new_scene,
        };
        let mut app = Self {
            document,
            state,
            toasts,
            files: Files::new(config.path, disk, config.native_dialogs),
            generation: Generation::new(worker, live, tuning, versions),
            views,
            threads: SceneThreads {
                checking: Checking::spawn(wake.clone())?,
                sensing: Sensing::spawn(sensing_grace, wake)?,
                planning: Planning::default(),
            },
            overlays: Overlays::default(),
            preferences: Preferences::new(config.settings_file, settings),
            frames: Frames {
                perf: Perf::default(),
                clock: Instant::now(),
                title: String::new(),
                passes: 0,
            },
            guests: Guests::default(),
            ctx: ctx.clone(),
        };
        app.tell_damaged(damaged);
        for note in notes {
            app.toasts.push(MessageLevel::Info, note, 0.0);
        }
        if let Some(made) = made {
            app.take_knobs(&made);
        }
        Ok(app)
    }

    /// Extent of the frame on screen.
    pub(crate) fn extent(&self) -> Extent {
        self.document.scene().frame().extent()
    }

    /// Seconds since the start.
    pub fn now_s(&self) -> f64 {
        self.frames.clock.elapsed().as_secs_f64()
    }

    /// File of the scene, if it has one.
    pub fn path(&self) -> Option<&Path> {
        self.files.path.as_deref()
    }

    /// The newest results of the sensors.
    pub fn sensing(&self) -> &Sensing {
        &self.threads.sensing
    }

    /// True if LiDAR and cameras show the state on screen.
    pub fn sensors_are_current(&self) -> bool {
        let rev = self.document.scene().rev;
        !self.threads.sensing.cameras_stale(rev) && !self.threads.sensing.lidar_stale(rev)
    }

    /// The document's scene, or a preview of its generation.
    pub(crate) fn shown_scene(&self) -> Arc<Scene> {
        if let (true, Some(reference)) = (
            self.state.compare.holding_reference,
            &self.views.compare.reference,
        ) {
            return reference.clone();
        }
        match &self.generation.preview {
            Some((content, scene)) if self.shows(*content, scene) => scene.clone(),
            _ => self.document.scene().clone(),
        }
    }

    /// True if a preview of a state has the state and the moment on screen.
    fn shows(&self, content: SceneRev, preview: &Scene) -> bool {
        let shown = self.document.scene();
        shown.content() == content && shown.time_s() == preview.time_s()
    }

    /// Does all work except drawing: takes updates of the worker, the sensors and the file threads.
    pub fn update(&mut self, ctx: &egui::Context) {
        self.threads.sensing.drain();
        let (cameras, large) = self.threads.sensing.take_fresh();
        if cameras > 0 {
            self.frames.perf.pictures(self.now_s(), cameras, large);
        }
        if let Some(problem) = self.threads.sensing.take_problem() {
            self.fail(problem);
        }
        self.generation.tuning.update();
        if self.document.history_limit() != self.preferences.settings.history_bytes() {
            self.document
                .set_history_limit(self.preferences.settings.history_bytes());
        }
        for event in self.generation.news() {
            self.take_event(event);
        }
        if !self.document.is_dragging()
            && let Some((result, own_step)) = self.generation.finished.take()
        {
            self.adopt(&result, own_step);
        }
        self.take_opened(ctx);
        self.serve_guests(ctx);
        self.play(ctx);
        self.update_drawing(ctx);
        if let Some((purpose, path)) = self.files.dialogs.poll() {
            self.file_chosen(purpose, path, ctx);
        }
        // The first picture is drawn before other work starts.
        if self.frames.passes > 1 {
            self.schedule(ctx);
        }
        self.update_checks(ctx);
        self.update_recovery(ctx);
        self.update_export();
        self.update_batches(ctx);
        self.set_title(ctx);
        self.keep_settings(ctx);
    }

    /// Applies changed settings, and writes them within two seconds.
    fn keep_settings(&mut self, ctx: &egui::Context) {
        self.state.cameras.offers_learned = self.preferences.settings.learned_pictures;
        if self.preferences.looks_changed() {
            theme::apply(ctx, self.preferences.settings.theme);
            language::choose(&self.preferences.settings.language);
            fonts::apply(ctx, &self.preferences.settings.language);
            self.preferences.settings.classes.make_current();
            self.views.forget_pictures();
        }
        if self.preferences.is_due(self.now_s()) {
            self.write_settings(ctx);
        }
    }

    fn write_settings(&mut self, ctx: &egui::Context) {
        let now_s = self.now_s();
        let settings = &mut self.preferences.settings;
        settings.brushes.clone_from(&self.state.brushes);
        settings.kept_words.clone_from(&self.views.prompt.favourites);
        let complaint = self.preferences.write(ctx.zoom_factor(), &self.views.dock, now_s);
        if let Some(text) = complaint {
            self.toasts.push(MessageLevel::Error, text, now_s);
        }
    }

    fn set_title(&mut self, ctx: &egui::Context) {
        let mark = if self.document.is_dirty() { "● " } else { "" };
        let title = format!(
            "{mark}{} – Sceneloom",
            self.files.called(&self.document.scene().name)
        );
        if title != self.frames.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.frames.title = title;
        }
    }
}

/// A function that requests a frame: at once, but at most one per `every_s`.
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

/// An error with its causes on one line.
pub(crate) fn one_line(error: &anyhow::Error) -> String {
    scene::message::of_error(error.as_ref())
}

impl eframe::App for SceneloomApp {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        // egui may lay out a frame twice and call this twice; that counts as one frame.
        let first = ctx.current_pass_index() == 0;
        if first {
            self.frame_begins(frame.info().cpu_usage);
        }
        self.update(ctx);
        if first {
            self.frames.perf.logic_done(self.now_s());
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.draw(ui);
    }

    fn on_exit(&mut self) {
        self.preferences.write_soon();
        let ctx = self.ctx.clone();
        self.write_settings(&ctx);
        self.frames.perf.finish(None);
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::panel().to_normalized_gamma_f32()
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }
}
