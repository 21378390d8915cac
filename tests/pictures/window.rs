//! A window on a scene of a template, without a graphics card of its own, whose content does not depend on time.

use std::sync::Arc;
use std::time::{Duration, Instant};

use app::command::{Command, ViewCommand};
use app::panes::id::PaneId;
use app::settings::Settings;
use app::{AppConfig, SceneloomApp, open};
use egui_kittest::Harness;
use formats::loom;
use image::RgbaImage;
use job::{GenError, GenParams, GenResult, Job, JobCtx, Pipeline, RegionMode};
use scene::{Edit, Scene};
use widgets::theme::{self, Theme};

/// Longest wait for sensors.
const PATIENCE: Duration = Duration::from_secs(120);
/// Frames after which nothing moves.
const STEPS: usize = 40;

/// Pipeline that nobody asks.
struct Idle;

impl Pipeline for Idle {
    fn run(&mut self, _: &Job, _: &JobCtx<'_>) -> Result<GenResult, GenError> {
        Err(GenError::failed("not asked for"))
    }
}

pub struct TestWindow {
    harness: Harness<'static, SceneloomApp>,
    _folder: tempfile::TempDir,
}

fn scene() -> Scene {
    let mut scene = open::from_template("t-junction", 3).expect("a template");
    scene.name = "Junction".into();
    scene
}

impl TestWindow {
    pub fn new(theme: Theme, language: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("settings.json");
        let settings = Settings {
            theme,
            language: language.to_owned(),
            start_screen: false,
            ..Settings::default()
        };
        std::fs::write(&file, serde_json::to_vec(&settings).expect("plain data")).expect("written");
        let config = AppConfig {
            scene: scene(),
            path: None,
            picture: None,
            build_pipeline: Box::new(|| Ok(Box::new(Idle))),
            params: GenParams::default(),
            full_params: GenParams {
                region: RegionMode::Full,
                ..GenParams::default()
            },
            warm_up: false,
            open: Arc::new(open::file),
            save: Arc::new(|scene, path| Ok(loom::save(path, scene).map(|_| ())?)),
            new_scene: Arc::new(|| Ok(scene())),
            native_dialogs: false,
            settings_file: Some(file),
        };
        let harness = Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .with_step_dt(1.0 / 30.0)
            .with_theme(match theme {
                Theme::Dark => egui::Theme::Dark,
                Theme::Light => egui::Theme::Light,
            })
            .build_eframe(|cc| SceneloomApp::new(config, None, &cc.egui_ctx).expect("threads"));
        let mut window = Self {
            harness,
            _folder: folder,
        };
        window.harness.state_mut().generation.live.on = false;
        window.harness.run_steps(4);
        window
    }

    pub fn execute(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().execute(command, &ctx);
        self.harness.run_steps(3);
    }

    /// Lets a pane fill the window, or gives it its place again.
    pub fn maximize(&mut self, pane: PaneId) {
        self.harness.state_mut().state.pointed.pane = Some(pane);
        self.execute(Command::View(ViewCommand::MaximizePane));
    }

    /// Removes a box, so that there is something to save and to undo.
    pub fn change(&mut self) {
        let id = *self
            .harness
            .state()
            .document
            .scene()
            .frame()
            .boxes
            .keys()
            .next()
            .expect("a box");
        self.execute(Command::Apply("Remove", vec![Edit::RemoveBox { id }]));
    }

    /// The window once sensors and checks are current and nothing moves.
    pub fn picture(&mut self) -> RgbaImage {
        let start = Instant::now();
        while !self.harness.state().sensors_are_current() {
            assert!(start.elapsed() < PATIENCE, "waited in vain for the sensors");
            std::thread::sleep(Duration::from_millis(5));
            self.harness.run_steps(1);
        }
        // Off everything, so that nothing is hovered.
        self.harness.hover_at(egui::pos2(1399.0, 450.0));
        self.harness.run_steps(STEPS);
        let rendered = self.harness.render();
        let mut picture = rendered.expect("a driver, Mesa's software one at least");
        // What no panel covers has the colour that the window is cleared with.
        let behind = theme::panel().to_array();
        for pixel in picture.pixels_mut() {
            let through = 255 - u16::from(pixel.0[3]);
            for (channel, behind) in pixel.0.iter_mut().zip(behind) {
                *channel = channel.saturating_add((through * u16::from(behind) / 255) as u8);
            }
        }
        picture
    }
}
