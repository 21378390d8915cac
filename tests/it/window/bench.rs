//! A window with a scripted pipeline, and hands to use it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use app::{AppConfig, SceneloomApp};
use crossbeam_channel::{Receiver, Sender, unbounded};
use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use formats::loom;
use glam::DVec2;
use job::composite::{composite, untouched_voxels_changed};
use job::region::Region;
use job::{GenError, GenParams, GenReport, GenResult, Job, JobCtx, Pipeline, RegionMode, Stage};
use scene::{BoxId, Class, Frame, Scene, SceneBox, VoxelGrid, Window, draft};
use world::template;

/// What a test tells the running job.
pub enum Do {
    Step,
    /// Shows a scene without anything in it.
    Show,
    Finish,
    Fail,
}

/// Does what the test says; a finished region becomes vegetation, which no draft would make.
pub struct Scripted {
    orders: Receiver<Do>,
    started: Sender<RegionMode>,
}

impl Pipeline for Scripted {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let frame = job.scene.frame();
        let region = match job.params.region {
            RegionMode::Auto => Region::of_edit(frame, job.params.halo_columns as usize),
            RegionMode::Full => Region::full(),
        };
        self.started.send(job.params.region).expect("the test listens");
        let mut step = 0;
        loop {
            ctx.check()?;
            match self.orders.recv_timeout(Duration::from_millis(2)) {
                Err(_) => {}
                Ok(Do::Step) => {
                    step += 1;
                    ctx.progress(Stage::Denoise, step, 3)?;
                }
                Ok(Do::Show) => ctx.preview(GenResult {
                    key: job.key(),
                    occupancy: VoxelGrid::new(),
                    report: GenReport::default(),
                }),
                Ok(Do::Fail) => return Err(GenError::failed("weights are missing")),
                Ok(Do::Finish) => break,
            }
        }
        let mut new = VoxelGrid::new();
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                new.column_mut(x, y)[0] = Class::Vegetation.id();
            }
        }
        let source = &frame.source.occupancy;
        let occupancy = composite(source, &new, &region, &frame.painted);
        let report = GenReport {
            network_calls: 20,
            untouched_voxels_changed: untouched_voxels_changed(source, &occupancy, &region, &frame.painted),
            ..GenReport::default()
        };
        Ok(GenResult {
            key: job.key(),
            occupancy,
            report,
        })
    }
}

/// A window of 1400 x 900 points on a straight road with one car, and the other end of its pipeline.
pub struct Bench {
    pub harness: Harness<'static, SceneloomApp>,
    pub orders: Sender<Do>,
    pub started: Receiver<RegionMode>,
    pub folder: tempfile::TempDir,
}

pub fn car() -> SceneBox {
    SceneBox {
        id: BoxId(7),
        class: Class::Car,
        center_m: glam::DVec3::new(14.0, 3.0, 0.85),
        size_m: glam::DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

pub fn scene() -> Scene {
    let layout = template::layout("straight", 5).expect("a template");
    let boxes = [(BoxId(7), car())].into();
    let occupancy = draft::draft(&layout, [car()].iter());
    Scene::single(
        "Test road",
        Frame::new(layout, boxes, occupancy),
        Arc::default(),
        5,
    )
}

/// Longest wait for another thread, so that a broken one fails the test instead of hanging it.
pub const PATIENCE: Duration = Duration::from_secs(60);

impl Bench {
    pub fn new() -> Self {
        Self::with(false)
    }

    /// Settings come from that file and are kept there.
    pub fn with_settings(file: &Path) -> Self {
        Self::build(false, Some(file.to_owned()))
    }

    /// With `gpu` true there is a real device; a machine without any adapter, Mesa's software one
    /// included, fails the test.
    pub fn with(gpu: bool) -> Self {
        Self::build(gpu, None)
    }

    fn build(gpu: bool, settings_file: Option<PathBuf>) -> Self {
        let (orders, orders_in) = unbounded();
        let (started_out, started) = unbounded();
        let folder = tempfile::tempdir().expect("a folder");
        let config = AppConfig {
            scene: scene(),
            path: None,
            picture: None,
            build_pipeline: Box::new(move || {
                Ok(Box::new(Scripted {
                    orders: orders_in.clone(),
                    started: started_out.clone(),
                }))
            }),
            params: GenParams::default(),
            full_params: GenParams {
                region: RegionMode::Full,
                ..GenParams::default()
            },
            warm_up: false,
            open: Arc::new(app::open::file),
            save: Arc::new(|scene, path| Ok(loom::save(path, scene).map(|_| ())?)),
            new_scene: Arc::new(|| Ok(scene())),
            native_dialogs: false,
            settings_file,
        };
        let builder = Harness::builder()
            .with_size(egui::vec2(1400.0, 900.0))
            .with_step_dt(1.0 / 60.0);
        let builder = if gpu { builder.wgpu() } else { builder };
        let harness = builder.build_eframe(|cc| {
            SceneloomApp::new(config, cc.wgpu_render_state.clone(), &cc.egui_ctx).expect("threads")
        });
        let mut bench = Self {
            harness,
            orders,
            started,
            folder,
        };
        bench.steps(4);
        bench
    }

    pub fn steps(&mut self, n: usize) {
        self.harness.run_steps(n);
    }

    pub fn app(&mut self) -> &mut SceneloomApp {
        self.harness.state_mut()
    }

    pub fn frame(&self) -> Arc<Frame> {
        self.harness.state().document.scene().frame().clone()
    }

    pub fn pane(&self, name: &str) -> egui::Rect {
        self.harness.get_by_role_and_label(Role::Canvas, name).rect()
    }

    pub fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.steps(3);
    }

    pub fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.steps(3);
    }

    pub fn bev(&self, x_m: f64, y_m: f64) -> Pos2 {
        self.harness
            .state()
            .views
            .canvas
            .map
            .expect("drawn")
            .to_screen(DVec2::new(x_m, y_m))
    }

    pub fn button(&mut self, at: Pos2, pressed: bool, modifiers: Modifiers) {
        let button = PointerButton::Primary;
        self.harness.event_modifiers(
            egui::Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers,
            },
            modifiers,
        );
        self.steps(1);
    }

    /// Presses at the first point, moves over the others, and releases at the last.
    pub fn drag(&mut self, way: &[Pos2], modifiers: Modifiers) {
        self.press_and_move(way, modifiers);
        self.button(way[way.len() - 1], false, modifiers);
        self.steps(2);
    }

    pub fn press_and_move(&mut self, way: &[Pos2], modifiers: Modifiers) {
        self.harness.hover_at(way[0]);
        self.steps(2);
        self.button(way[0], true, modifiers);
        for pair in way.windows(2) {
            for i in 1..=4 {
                self.harness.hover_at(pair[0].lerp(pair[1], i as f32 / 4.0));
                self.steps(1);
            }
        }
    }

    pub fn wait_until(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            assert!(start.elapsed() < PATIENCE, "waited in vain: {what}");
            std::thread::sleep(Duration::from_millis(2));
            self.steps(1);
        }
    }

    pub fn history(&mut self) -> Vec<String> {
        self.app().document.history().map(str::to_owned).collect()
    }

    pub fn off(&mut self) {
        self.app().generation.live.on = false;
    }
}

impl Bench {
    /// Fills the path field and confirms.
    pub fn give_path(&mut self, path: &Path, button: &str) {
        self.steps(2);
        let text = path.display().to_string();
        let field = self.harness.get_by_label("File path");
        assert!(field.is_focused());
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.steps(1);
        self.harness.get_by_label("File path").type_text(&text);
        self.steps(2);
        self.click(button);
    }

    pub fn open_path(&mut self) -> PathBuf {
        self.folder.path().join("scene.loom")
    }
}
