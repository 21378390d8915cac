//! The window driven as a user drives it: by labels, pointer and keys, with a scripted pipeline.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, unbounded};
use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use image::GenericImageView;
use sceneloom::app::state::{Pane, Tool, VoxelVerb};
use sceneloom::app::{AppConfig, SceneloomApp};
use sceneloom::formats::project;
use sceneloom::generation::composite::{composite, untouched_voxels_changed};
use sceneloom::generation::job::{
    GenError, GenParams, GenReport, GenResult, Job, JobCtx, Pipeline, RegionMode, Stage,
};
use sceneloom::generation::region::Region;
use sceneloom::generation::world::template;
use sceneloom::scene::{BevLayer, BoxId, Class, Frame, GridSpec, Scene, SceneBox, VoxelGrid, draft};

/// What a test tells the running job.
enum Do {
    Step,
    Finish,
    Fail,
}

/// Does what the test says; a finished region becomes vegetation, which no draft would make.
struct Scripted {
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
                Ok(Do::Fail) => return Err(GenError::failed("weights are missing")),
                Ok(Do::Finish) => break,
            }
        }
        let mut new = VoxelGrid::new();
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
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
            frame: job.scene.current,
            occupancy,
            report,
        })
    }
}

/// A window of 1400 x 900 points on a straight road with one car, and the other end of its pipeline.
struct Bench {
    harness: Harness<'static, SceneloomApp>,
    orders: Sender<Do>,
    started: Receiver<RegionMode>,
    folder: tempfile::TempDir,
}

fn car() -> SceneBox {
    SceneBox {
        id: BoxId(7),
        class: Class::Car,
        center_m: glam::DVec3::new(14.0, 3.0, 0.85),
        size_m: glam::DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
    }
}

fn scene() -> Scene {
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
const PATIENCE: Duration = Duration::from_secs(60);

impl Bench {
    fn new() -> Self {
        Self::with(false)
    }

    /// With `gpu` true there is a real device; a machine without any adapter, Mesa's software one
    /// included, fails the test.
    fn with(gpu: bool) -> Self {
        let (orders, orders_in) = unbounded();
        let (started_out, started) = unbounded();
        let folder = tempfile::tempdir().expect("a folder");
        let config = AppConfig {
            scene: scene(),
            path: None,
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
            open: Arc::new(|path| Ok(project::load(path)?)),
            save: Arc::new(|scene, path| Ok(project::save(path, scene).map(|_| ())?)),
            new_scene: Arc::new(|| Ok(scene())),
            native_dialogs: false,
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

    fn steps(&mut self, n: usize) {
        self.harness.run_steps(n);
    }

    fn app(&mut self) -> &mut SceneloomApp {
        self.harness.state_mut()
    }

    fn frame(&self) -> Arc<Frame> {
        self.harness.state().document.scene().frame().clone()
    }

    fn pane(&self, name: &str) -> egui::Rect {
        self.harness.get_by_role_and_label(Role::Canvas, name).rect()
    }

    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.steps(3);
    }

    fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.steps(3);
    }

    fn bev(&self, x_m: f64, y_m: f64) -> Pos2 {
        self.harness
            .state()
            .canvas
            .map
            .expect("drawn")
            .to_screen(DVec2::new(x_m, y_m))
    }

    fn button(&mut self, at: Pos2, pressed: bool, modifiers: Modifiers) {
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
    fn drag(&mut self, way: &[Pos2], modifiers: Modifiers) {
        self.press_and_move(way, modifiers);
        self.button(way[way.len() - 1], false, modifiers);
        self.steps(2);
    }

    fn press_and_move(&mut self, way: &[Pos2], modifiers: Modifiers) {
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

    fn wait_until(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            assert!(start.elapsed() < PATIENCE, "waited in vain: {what}");
            std::thread::sleep(Duration::from_millis(2));
            self.steps(1);
        }
    }

    fn history(&mut self) -> Vec<&'static str> {
        self.app().document.history().collect()
    }

    fn off(&mut self) {
        self.app().live.on = false;
    }
}

#[test]
fn a_stroke_is_one_undo_step_and_shows_at_once() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Paint carpark area");
    assert_eq!(
        (bench.app().state.tool, bench.app().state.layer),
        (Tool::Brush, BevLayer::CarparkArea)
    );
    let before = bench.frame();
    let way = [bench.bev(-20.0, 25.0), bench.bev(0.0, 25.0), bench.bev(0.0, 32.0)];
    bench.press_and_move(&way, Modifiers::NONE);
    assert!(bench.app().document.is_dragging());
    assert!(
        bench.frame().layout.count(BevLayer::CarparkArea) > 300,
        "shown while painting"
    );
    bench.button(way[2], false, Modifiers::NONE);
    bench.steps(2);
    assert_eq!(bench.history(), ["Open", "Paint layer"]);
    let painted = bench.frame();
    let [x, y] = GridSpec::column_at(-10.0, 25.0).expect("inside");
    assert!(painted.layout.has(BevLayer::CarparkArea, x, y));
    assert_eq!(painted.occupancy.get(x, y, 0), Class::DriveableSurface.id());
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame(), before);
    bench.key(Modifiers::CTRL, Key::Y);
    assert_eq!(bench.frame(), painted);
    bench.click("Undo");
    assert_eq!(bench.frame(), before);
    bench.key(Modifiers::CTRL | Modifiers::SHIFT, Key::Z);
    assert_eq!(bench.frame(), painted);
    // Shift erases; Escape takes a stroke back.
    let back = [bench.bev(-12.0, 25.0), bench.bev(-8.0, 25.0)];
    bench.drag(&back, Modifiers::SHIFT);
    assert!(!bench.frame().layout.has(BevLayer::CarparkArea, x, y));
    let erased = bench.frame();
    bench.press_and_move(&way, Modifiers::NONE);
    assert_ne!(bench.frame(), erased);
    bench.key(Modifiers::NONE, Key::Escape);
    assert_eq!(bench.frame(), erased);
    bench.button(way[2], false, Modifiers::NONE);
    assert_eq!(bench.history(), ["Open", "Paint layer", "Erase layer"]);
}

#[test]
fn a_box_is_added_moved_turned_copied_and_deleted() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::A);
    bench.click("Add truck");
    let at = bench.bev(-15.0, 2.0);
    bench.drag(&[at], Modifiers::NONE);
    let truck = bench.frame().boxes[&BoxId(8)];
    assert_eq!(truck.class, Class::Truck);
    assert!(
        (truck.center_m.truncate() - DVec2::new(-15.0, 2.0)).length() < 0.1,
        "{truck:?}"
    );
    assert!(
        (truck.center_m.z - truck.size_m.z / 2.0).abs() < 1e-9,
        "stands on the ground"
    );
    assert!(bench.app().state.selected == Some(BoxId(8)));
    let [x, y] = GridSpec::column_at(-15.0, 2.0).expect("inside");
    assert_eq!(
        bench.frame().occupancy.get(x, y, 1),
        Class::Truck.id(),
        "voxels at once"
    );

    bench.key(Modifiers::NONE, Key::V);
    let way = [bench.bev(-15.0, 2.0), bench.bev(-9.0, 4.0)];
    bench.drag(&way, Modifiers::NONE);
    let moved = bench.frame().boxes[&BoxId(8)];
    assert!(
        (moved.center_m - truck.center_m)
            .truncate()
            .distance(DVec2::new(6.0, 2.0))
            < 0.15,
        "{moved:?}"
    );
    let knob = sceneloom::editor::pick::rotate_knob(&moved);
    let aim = moved.center_m.truncate() + DVec2::new(0.0, 6.0);
    let way = [bench.bev(knob.x, knob.y), bench.bev(aim.x, aim.y)];
    bench.drag(&way, Modifiers::NONE);
    let turned = bench.frame().boxes[&BoxId(8)];
    assert!(
        (turned.yaw_rad.to_degrees() - 90.0).abs() < 1.5,
        "{}",
        turned.yaw_rad.to_degrees()
    );

    bench.key(Modifiers::NONE, Key::ArrowUp);
    let nudged = bench.frame().boxes[&BoxId(8)];
    assert!((nudged.center_m.x - turned.center_m.x - 0.1).abs() < 1e-9);
    bench.key(Modifiers::CTRL, Key::D);
    assert!(bench.frame().boxes.contains_key(&BoxId(9)));
    assert_eq!(bench.app().state.selected, Some(BoxId(9)));
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(!bench.frame().boxes.contains_key(&BoxId(9)));
    assert_eq!(bench.app().state.selected, None);
    assert_eq!(
        bench.history(),
        [
            "Open",
            "Add box",
            "Move box",
            "Turn box",
            "Nudge box",
            "Duplicate box",
            "Delete box"
        ]
    );
    // Chosen by name in the list, deleted by the button of the inspector, brought back.
    bench.click("Box 7 car");
    bench.click("Delete box");
    assert!(!bench.frame().boxes.contains_key(&BoxId(7)));
    bench.click("Undo");
    assert!(bench.frame().boxes.contains_key(&BoxId(7)));
    // A step of the history is one click away.
    bench.click("History 3 Turn box");
    assert_eq!(bench.frame().boxes[&BoxId(8)], turned);
    assert_eq!(bench.app().document.position(), 3);
}

#[test]
fn an_edit_is_generated_in_the_background_and_adopted() {
    let mut bench = Bench::new();
    bench.steps(3);
    assert!(bench.started.is_empty(), "nothing was edited");
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::Delete);
    let rough = bench.frame();
    bench.wait_until("the job", |b| !b.started.is_empty());
    assert_eq!(bench.started.recv(), Ok(RegionMode::Auto));
    bench.orders.send(Do::Step).expect("listens");
    bench.wait_until("progress", |b| {
        b.harness.query_by_label_contains("Denoising 1/3").is_some()
    });
    assert!(bench.harness.query_by_label("Generation progress").is_some());
    assert_eq!(bench.frame(), rough, "nothing changes before it is done");
    bench.orders.send(Do::Finish).expect("listens");
    bench.wait_until("the result", |b| b.app().live.running.is_none());
    bench.steps(3);
    let frame = bench.frame();
    let [x, y] = GridSpec::column_at(14.0, 3.0).expect("inside");
    assert_eq!(frame.occupancy.get(x, y, 0), Class::Vegetation.id(), "adopted");
    assert_eq!(
        frame.occupancy, frame.source.occupancy,
        "the source of what comes next"
    );
    let receipt = bench.app().receipt.clone().expect("a receipt");
    assert_eq!((receipt.network_calls, receipt.untouched_voxels_changed), (20, 0));
    assert!(
        bench
            .harness
            .query_by_label_contains("untouched voxels changed: 0")
            .is_some()
    );
    // No second job for the same state; undo and redo need none either.
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame().boxes.len(), 1);
    bench.key(Modifiers::CTRL, Key::Y);
    bench.steps(10);
    assert!(bench.started.is_empty());
    assert_eq!(bench.frame().occupancy.get(x, y, 0), Class::Vegetation.id());
    assert_eq!(
        bench.history(),
        ["Open", "Delete box"],
        "adopting is no undo step"
    );
}

#[test]
fn everything_is_generated_on_request_and_cancelled_on_request() {
    let mut bench = Bench::new();
    let before = bench.frame();
    bench.key(Modifiers::CTRL, Key::Enter);
    bench.wait_until("the job", |b| !b.started.is_empty());
    assert_eq!(bench.started.recv(), Ok(RegionMode::Full));
    bench.click("Cancel generation");
    bench.wait_until("its end", |b| b.app().live.running.is_none());
    bench.steps(5);
    assert_eq!(bench.frame(), before);
    assert!(
        bench.started.is_empty(),
        "a cancelled job does not come back by itself"
    );
    bench.click("Generate everything");
    bench.wait_until("the job", |b| !b.started.is_empty());
    bench.started.recv().expect("it started");
    bench.orders.send(Do::Finish).expect("listens");
    bench.wait_until("the result", |b| b.app().live.running.is_none());
    bench.steps(2);
    assert_eq!(bench.frame().occupancy.get(3, 3, 0), Class::Vegetation.id());
}

#[test]
fn the_newest_edit_wins_and_undo_stops_what_is_useless() {
    let mut bench = Bench::new();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowUp);
    bench.wait_until("the first job", |b| b.started.len() == 1);
    bench.key(Modifiers::NONE, Key::ArrowUp);
    bench.wait_until("the second job", |b| b.started.len() == 2);
    bench.key(Modifiers::CTRL, Key::Z);
    bench.wait_until("a job for the state before", |b| b.started.len() == 3);
    bench.key(Modifiers::CTRL, Key::Z);
    bench.wait_until("rest", |b| b.app().live.running.is_none());
    bench.steps(5);
    assert_eq!((bench.started.len(), bench.frame().boxes[&BoxId(7)]), (3, car()));
}

#[test]
fn a_failure_is_told_once_and_live_stops() {
    let mut bench = Bench::new();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::C);
    bench.wait_until("the job", |b| !b.started.is_empty());
    bench.orders.send(Do::Fail).expect("listens");
    bench.wait_until("its end", |b| b.app().live.running.is_none());
    bench.steps(5);
    assert!(!bench.app().live.on);
    let told = "Generation failed: weights are missing. Live is off now.";
    assert!(bench.harness.query_by_label(told).is_some());
    assert!(
        bench
            .harness
            .query_by_label("Edited, not generated: live is off")
            .is_some()
    );
    assert_eq!(bench.started.len(), 1, "never a loop");
    bench.key(Modifiers::CTRL, Key::Space);
    assert!(bench.app().live.on);
    bench.wait_until("another try", |b| b.started.len() == 2);
}

impl Bench {
    /// Fills the path field and confirms.
    fn give_path(&mut self, path: &Path, button: &str) {
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

    fn open_path(&mut self) -> PathBuf {
        self.folder.path().join("scene.loom")
    }
}

#[test]
fn a_scene_is_saved_and_opened_again_by_the_path_field() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.open_path();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    let saved = bench.frame();
    assert!(bench.app().document.is_dirty());
    bench.key(Modifiers::CTRL, Key::S);
    bench.give_path(&path, "Save file");
    assert!(path.is_file() && !bench.app().document.is_dirty());
    assert_eq!(bench.app().path(), Some(path.as_path()));
    // Letters typed into the field are no shortcuts.
    assert_eq!(bench.app().state.tool, Tool::Select);

    bench.key(Modifiers::NONE, Key::Delete);
    assert_ne!(bench.frame(), saved);
    bench.key(Modifiers::CTRL, Key::O);
    assert!(bench.harness.query_by_label("Unsaved changes").is_some());
    bench.click("Keep editing");
    assert!(bench.harness.query_by_label("Unsaved changes").is_none());
    bench.key(Modifiers::CTRL, Key::O);
    bench.click("Discard changes");
    bench.give_path(&path, "Open file");
    bench.wait_until("the scene", |b| b.app().document.history().len() == 1);
    assert_eq!(bench.frame().boxes, saved.boxes);
    assert_eq!(bench.frame().occupancy, saved.occupancy);
    assert_eq!(bench.frame().layout, saved.layout);
    // Saved again without a question, now that there is a file.
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    bench.key(Modifiers::CTRL, Key::S);
    assert!(!bench.app().document.is_dirty());
    // A file that is none is one line, and the scene stays.
    std::fs::write(&path, b"PK rubbish").expect("written");
    let stays = bench.frame();
    bench.key(Modifiers::CTRL, Key::O);
    bench.give_path(&path, "Open file");
    bench.wait_until("the error", |b| {
        b.app().toasts.last().is_some_and(|t| t.contains("scene.loom"))
    });
    assert_eq!(bench.frame(), stays);
    assert!(bench.app().toasts.last().is_some_and(|t| !t.contains('\n')));
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

#[test]
fn a_dropped_file_opens_and_closing_asks_first() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.open_path();
    let mut other = scene();
    other.name = "Dropped".into();
    project::save(&path, &other).expect("saved");
    bench
        .harness
        .input_mut()
        .dropped_files
        .push(Arc::new(Dropped(path)));
    bench.steps(1);
    bench.harness.input_mut().dropped_files.clear();
    bench.wait_until("the scene", |b| &*b.app().document.scene().name == "Dropped");

    let close = |bench: &mut Bench| {
        let viewports = &mut bench.harness.input_mut().viewports;
        viewports.entry(egui::ViewportId::ROOT).or_default().events = vec![egui::ViewportEvent::Close];
        bench.steps(1);
        let viewports = &mut bench.harness.input_mut().viewports;
        viewports
            .entry(egui::ViewportId::ROOT)
            .or_default()
            .events
            .clear();
        let output = &bench.harness.output().viewport_output[&egui::ViewportId::ROOT];
        output.commands.contains(&egui::ViewportCommand::CancelClose)
    };
    assert!(!close(&mut bench), "nothing is unsaved");
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(close(&mut bench), "changes are unsaved");
    bench.steps(2);
    bench.click("Discard changes");
    assert!(!close(&mut bench), "the user has decided");
}

#[test]
fn views_and_layers_answer_their_controls() {
    let mut bench = Bench::new();
    bench.off();
    assert!(bench.harness.query_by_label("No GPU adapter").is_some());
    bench.click("Show walkway");
    assert!(!bench.app().state.shows(BevLayer::Walkway));
    let bev = bench.pane("Bird's-eye view");
    bench.key(Modifiers::NONE, Key::Tab);
    let swapped = bench.pane("Bird's-eye view");
    assert!(swapped.left() > bev.left() + 100.0, "{bev:?} {swapped:?}");
    bench.key(Modifiers::NONE, Key::Tab);
    bench.key(Modifiers::NONE, Key::G);
    assert!(!bench.app().state.show_grid);
    // The wheel keeps the point under the pointer where it is.
    let at = bench.bev(10.0, -5.0);
    bench.harness.hover_at(at);
    bench.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    bench.steps(30);
    assert!(bench.bev(10.0, -5.0).distance(at) < 0.5);
    assert!(bench.bev(20.0, -5.0).distance(at) > 70.0, "closer than before");
    bench.key(Modifiers::NONE, Key::CloseBracket);
    assert!(bench.app().state.brush_m > 3.2);
    bench.click("Depth");
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.click("Camera Front");
    assert!(bench.harness.query_by_label("Look through in 3D").is_some());
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(bench.harness.query_by_label("Look through in 3D").is_none());
    bench.key(Modifiers::NONE, Key::F1);
    assert!(bench.harness.query_by_label("Ctrl+Backspace").is_some());
}

#[test]
fn voxels_are_painted_and_shot_in_the_3d_view() {
    let mut bench = Bench::with(true);
    bench.off();
    let pane = bench.pane("3D view");
    bench.harness.hover_at(pane.center());
    bench.steps(2);
    assert_eq!(bench.app().state.hovered_pane, Some(Pane::View3d));
    bench.key(Modifiers::NONE, Key::B);
    assert_eq!(
        (bench.app().state.tool, bench.app().state.verb),
        (Tool::Voxel, VoxelVerb::Attach)
    );
    let before = bench.frame();
    let middle = pane.center() + egui::vec2(0.0, 60.0);
    bench.drag(&[middle, middle + egui::vec2(60.0, 0.0)], Modifiers::NONE);
    let after = bench.frame();
    let new: Vec<_> = after.painted.iter_set().collect();
    assert!(new.len() > 3, "{} voxels", new.len());
    assert!(new.iter().all(|(x, y, z, class)| {
        *class == Class::Manmade.id()
            && before.occupancy.get(*x, *y, *z) == Class::FREE
            && after.occupancy.get(*x, *y, *z) == *class
    }));
    assert_eq!(bench.history(), ["Open", "Attach voxels"]);
    bench.key(Modifiers::NONE, Key::R);
    bench.drag(&[middle], Modifiers::NONE);
    assert_eq!(bench.history(), ["Open", "Attach voxels", "Remove voxels"]);
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame(), after);
    // A click chooses the car where it is seen.
    bench.key(Modifiers::NONE, Key::V);
    bench.key(Modifiers::NONE, Key::Num7);
    let view = &bench.harness.state().view3d;
    let size = [view.rect.width() as u32, view.rect.height() as u32];
    let at = view.camera.project(car().center_m, size).expect("in view");
    let at = view.rect.min + egui::vec2(at.x as f32, at.y as f32);
    bench.drag(&[at], Modifiers::NONE);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));
    // The window's own picture is no blank frame.
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(20);
    let picture = bench.harness.render().expect("drawn");
    let pane = picture
        .view(pane.left() as u32, pane.top() as u32, 300, 300)
        .to_image();
    let colors: std::collections::HashSet<_> = pane.pixels().copied().collect();
    assert!(colors.len() > 100, "{} colours", colors.len());
    let path = bench.folder.path().join("scene.loom");
    project::save(&path, bench.app().document.scene()).expect("saved");
    bench.app().document.mark_saved();
    bench.app().execute(
        sceneloom::app::Command::OpenPath(path.clone()),
        &egui::Context::default(),
    );
    bench.wait_until("the scene", |b| b.app().path().is_some());
    bench.key(Modifiers::NONE, Key::F12);
    let shot = image::open(path.with_extension("png"))
        .expect("a picture")
        .to_rgba8();
    let colors: std::collections::HashSet<_> = shot.pixels().copied().collect();
    assert!(colors.len() > 100, "{} colours", colors.len());
}
