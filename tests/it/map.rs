//! A map of 480 x 320 x 16, larger than the networks' window: made, generated within the window, edited in it and far
//! beyond it, seen by the sensors, saved, and worked on by the command line.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use editor::{Document, Edit};
use formats::loom;
use glam::{DVec2, DVec3};
use job::inpaint::InpaintMask;
use job::pipeline::OccPipeline;
use job::{GenError, GenParams, GenResult, Job, JobCtx, Pipeline, RegionMode};
use scene::{
    BevLayer, BevLayout, BoxId, BoxLabel, Class, Conditions, Extent, Frame, Scene, SensorRig, Shape,
    VoxelGrid, draft,
};
use sensors::cameras::{self, CameraInput, Detail, PreparedSource, RenderContext, RenderOptions};
use sensors::pictures::appearance::Quality;

use super::cli::{Folder, json, sceneloom};

fn map() -> Extent {
    Extent::new([-150, -110], [480, 320]).expect("a sound size")
}

/// A road of 192 m along x over the whole map, walkways beside it, and its rough voxels.
fn road() -> Scene {
    let layout = BevLayout::over(map());
    let frame = Frame::new(layout, Default::default(), VoxelGrid::over(map()));
    let mut document = Document::new(Scene::single("map", frame, Arc::new(SensorRig::default()), 3));
    let strip = |layer, low, high| Edit::PaintBev {
        layer,
        shape: Shape::Rect {
            min_m: DVec2::new(-1e4, low),
            max_m: DVec2::new(1e4, high),
        },
        value: true,
    };
    let strips = [
        strip(BevLayer::DrivableArea, -5.2, 3.6),
        strip(BevLayer::Walkway, 3.6, 6.0),
        strip(BevLayer::Walkway, -7.6, -5.2),
    ];
    document.apply_all("Paint", &strips).expect("on the map");
    let layout = document.scene().frame().layout.clone();
    assert_eq!(layout.count(BevLayer::DrivableArea), 480 * 22, "over all of it");
    let voxels = draft::draft(&layout, std::iter::empty());
    let frame = Frame::new(layout, Default::default(), voxels);
    Scene::single("map", frame, Arc::new(SensorRig::default()), 3)
}

fn car(id: u32, at_m: DVec2) -> Edit {
    Edit::AddBox {
        class: Class::Car,
        center_m: at_m.extend(0.8),
        size_m: DVec3::new(4.6, 1.9, 1.6),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(BoxId(id)),
        label: BoxLabel::default(),
    }
}

fn generate(pipeline: &mut OccPipeline, document: &mut Document, params: GenParams) -> GenResult {
    let job = Job {
        scene: document.scene().clone(),
        params: GenParams { steps: 4, ..params },
    };
    let result = pipeline.run(&job, &JobCtx::detached()).expect("a result");
    document
        .adopt(result.rev(), result.occupancy.clone())
        .expect("the current state");
    result
}

/// Fresh content in a rectangle.
fn redraw(min_m: DVec2, max_m: DVec2) -> GenParams {
    GenParams {
        inpaint: InpaintMask::of_rect(map(), min_m, max_m),
        strength: 1.0,
        ..GenParams::default()
    }
}

/// Voxels that differ, within the window and beyond it.
fn differing(a: &VoxelGrid, b: &VoxelGrid) -> [usize; 2] {
    let all = a.count_different(b);
    let within = a.crop(Extent::WINDOW).count_different(&b.crop(Extent::WINDOW));
    [within, all - within]
}

const NEAR: BoxId = BoxId(1);
const FAR: BoxId = BoxId(2);

/// The road with a part in the window at the origin generated, a car in it and one far beyond it.
fn edited() -> Document {
    let mut document = Document::new(road());
    let mut pipeline = OccPipeline::bundled().expect("the shipped weights load");
    let rough = document.scene().frame().occupancy.clone();
    let part = redraw(DVec2::new(-30.0, -30.0), DVec2::new(30.0, 30.0));
    let result = generate(&mut pipeline, &mut document, part);
    let generated = document.scene().frame().occupancy.clone();
    let [within, beyond] = differing(&rough, &generated);
    assert!(within > 2_000 && beyond == 0, "{within} and {beyond} changed");
    let share = result.report.region_columns as f64 / map().columns() as f64;
    assert_eq!(result.report.region_share, share, "of the map");
    // A car in that window: it is generated, and nothing else changes.
    document
        .apply("Add", &car(NEAR.0, DVec2::new(14.0, -1.8)))
        .expect("on the map");
    let result = generate(&mut pipeline, &mut document, GenParams::default());
    assert!(result.report.network_calls > 0 && result.report.untouched_voxels_changed == 0);
    let with_car = document.scene().frame().occupancy.clone();
    let [within, beyond] = differing(&generated, &with_car);
    assert!(
        within > 50 && within < 3000 && beyond == 0,
        "{within} and {beyond}"
    );
    // A car beyond it is generated where it stands: the window follows.
    document
        .apply("Add", &car(FAR.0, DVec2::new(100.0, 0.0)))
        .expect("on the map");
    let result = generate(&mut pipeline, &mut document, GenParams::default());
    assert!(result.report.network_calls > 0 && result.report.untouched_voxels_changed == 0);
    let frame = document.scene().frame();
    let [within, beyond] = differing(&with_car, &frame.occupancy);
    assert!(
        within == 0 && beyond > 100 && beyond < 3000,
        "{within} and {beyond}"
    );
    assert!(frame.source.boxes.contains_key(&NEAR) && frame.source.boxes.contains_key(&FAR));
    document
}

/// Two windows side by side, and the seam between them.
#[test]
fn a_map_is_generated_window_by_window() {
    let extent = Extent::new([-100, -100], [260, 200]).expect("sound");
    let mut scene = road();
    let frame = scene.frame().crop(extent);
    scene.change_canvas(|f| *f = frame);
    let mut document = Document::new(scene);
    let mut pipeline = OccPipeline::bundled().expect("the shipped weights load");
    let params = GenParams {
        steps: 2,
        region: RegionMode::Full,
        ..GenParams::default()
    };
    let job = Job {
        scene: document.scene().clone(),
        params,
    };
    let result = pipeline.run(&job, &JobCtx::detached()).expect("a result");
    // Two steps in each window and at the seam.
    assert_eq!(result.report.network_calls, 6);
    let mut again = OccPipeline::bundled().expect("the shipped weights load");
    let same = again.run(&job, &JobCtx::detached()).expect("a result");
    assert_eq!(same.occupancy, result.occupancy, "whatever came before");
    goes_on_where_it_was_stopped(&job, &result);
    document
        .adopt(result.rev(), result.occupancy)
        .expect("the current state");
    let grid = &document.scene().frame().occupancy;
    for x in 0..extent.nx() {
        let [_, y] = extent.column_at(0.0, 0.0).expect("on the map");
        assert_eq!(grid.get(x, y, 0), Class::DriveableSurface.id(), "no gap at {x}");
    }
}

/// A map that was made larger has ground there after an edit's generation, also where no road goes; the rest stays.
#[test]
fn new_ground_is_drawn_whole() {
    let mut scene = road();
    let frame = scene.frame().crop(Extent::WINDOW);
    scene.change_canvas(|f| *f = frame);
    let mut document = Document::new(scene);
    let grow = Edit::ExtendMap {
        ahead_m: 48.0,
        behind_m: 0.0,
        left_m: 0.0,
        right_m: 0.0,
    };
    document.apply("Grow", &grow).expect("a map");
    let before = document.scene().frame().occupancy.clone();
    let job = Job {
        scene: document.scene().clone(),
        params: GenParams {
            steps: 4,
            ..GenParams::default()
        },
    };
    let mut pipeline = OccPipeline::bundled().expect("the shipped weights load");
    let result = pipeline.run(&job, &JobCtx::detached()).expect("a result");
    let extent = before.extent();
    for [x, y] in extent.all_columns() {
        let column = result.occupancy.column(x, y);
        match x {
            ..190 => assert_eq!(column, before.column(x, y), "({x}, {y})"),
            210.. => assert!(column.iter().any(|l| *l != Class::FREE), "a hole at ({x}, {y})"),
            _ => (),
        }
    }
    let road = Class::DriveableSurface.id();
    let [_, y] = extent.column_at(0.0, 0.0).expect("on the map");
    assert!((210..extent.nx()).all(|x| result.occupancy.column(x, y).contains(&road)));
}

/// Stopped in the last of three parts, a job does the rest alone when it is asked again, and makes the same.
fn goes_on_where_it_was_stopped(job: &Job, whole: &GenResult) {
    let mut pipeline = OccPipeline::bundled().expect("the shipped weights load");
    let asked = |limit: usize, pipeline: &mut OccPipeline| {
        let count = AtomicUsize::new(0);
        let stop = || count.fetch_add(1, Ordering::Relaxed) >= limit;
        let result = pipeline.run(job, &JobCtx::new(&stop, &|_| {}));
        (result, count.into_inner())
    };
    let (all, steps) = asked(usize::MAX, &mut pipeline);
    assert_eq!(all.expect("a result").occupancy, whole.occupancy);
    let (stopped, _) = asked(steps * 3 / 4, &mut pipeline);
    assert!(matches!(stopped, Err(GenError::Superseded)));
    let (rest, more) = asked(usize::MAX, &mut pipeline);
    assert_eq!(rest.expect("a result").occupancy, whole.occupancy);
    assert!(more <= steps / 2, "{more} of {steps} steps again");
}

/// The frame without the box and the voxels of the far car.
fn without_the_far_car(frame: &Frame) -> Frame {
    let mut frame = frame.clone();
    frame.boxes.remove(&FAR);
    let car = |v: &(usize, usize, usize, u8)| v.3 == Class::Car.id();
    let cars: Vec<_> = frame.occupancy.iter_set().filter(car).collect();
    for (x, y, z, _) in cars {
        if map().center(x, y, z).x > 90.0 {
            frame.occupancy.set(x, y, z, Class::FREE);
        }
    }
    frame
}

#[test]
fn the_window_is_one_part_of_a_larger_map() {
    let mut document = edited();
    let scene = document.scene().clone();
    let frame = scene.frame();

    // The LiDAR and the front camera meet the far car where it stands.
    let sweep = sensors::lidar::rig_sweep(&frame.occupancy, &scene.rig).expect("a LiDAR");
    let near_far_car =
        |p: DVec3| (97.0..103.0).contains(&p.x) && p.y.abs() < 1.6 && (0.2..2.0).contains(&p.z);
    let far_points = sweep
        .points
        .iter()
        .filter(|p| near_far_car(DVec3::from_array(p.position_in_ego.map(f64::from))));
    assert!(far_points.clone().count() > 0, "no return from the far car");
    assert!(far_points.clone().all(|p| p.class == Class::Car));
    let front = scene
        .rig
        .cameras
        .iter()
        .find(|c| c.name.contains("FRONT") && !c.name.contains("FRONT_"));
    let front = front.expect("a front camera");
    let input = CameraInput {
        frame,
        rig: &scene.rig,
        background: &scene.background,
        conditions: Conditions::default(),
        detail: Detail::Full,
        paint: None,
        cache: None,
    };
    let options = RenderOptions {
        size: [400, 225],
        quality: Quality::Preview,
    };
    let near_alone = without_the_far_car(frame);
    // A multi-plane image ends nearer than the far car.
    let sources = cameras::all().iter().filter(|s| s.id().name() != "planes");
    for source in sources {
        let picture = |frame: &Frame| {
            let input = CameraInput { frame, ..input };
            PreparedSource::new(*source, &input)
                .render(front, &options, RenderContext::processor())
                .unwrap_or_else(|e| panic!("{}: {e}", source.id().name()))
        };
        let differs = picture(frame) != picture(&near_alone);
        assert!(differs, "{}: the far car is not seen", source.id().name());
    }

    // Saved, it comes back the same, and undo leads back to the road with its generated window.
    let folder = Folder::new();
    let path = folder.path("map.loom");
    loom::save(path.as_ref(), &scene).expect("saved");
    let again = loom::load(path.as_ref()).expect("opens");
    assert!(again.canvas() == scene.canvas());
    while document.undo().is_some() {}
    let frame = document.scene().frame();
    let [within, beyond] = differing(&road().frame().occupancy, &frame.occupancy);
    assert!(frame.boxes.is_empty() && within > 2_000 && beyond == 0);
}

#[test]
fn the_commands_work_on_a_larger_map() {
    let (document, folder) = (edited(), Folder::new());
    let path = folder.path("map.loom");
    loom::save(path.as_ref(), document.scene()).expect("saved");
    let out = folder.path("pictures");
    let what = "semantic,depth,lidar,appearance";
    let size = ["--size", "240x135", "--preview", "--json"];
    json(&sceneloom(
        &[&["render", &path, "--what", what, "-o", &out], &size[..]].concat(),
    ));
    let report = json(&sceneloom(&["check", &path, "--json"]));
    assert!(report.get("findings").is_some(), "{report}");
    let edits = folder.write(
        "edits.json",
        r#"[{"remove_box": {"id": 1}}, {"remove_box": {"id": 2}}]"#,
    );
    let edited = folder.path("edited.loom");
    json(&sceneloom(&[
        "edit", &path, "--edits", &edits, "--steps", "4", "-o", &edited, "--json",
    ]));
    let after = loom::load(edited.as_ref()).expect("opens");
    assert_eq!(after.frame().extent(), map());
    assert!(after.frame().boxes.is_empty());
    let cars = |scene: &Scene| scene.frame().occupancy.class_counts()[usize::from(Class::Car.id())];
    assert!(
        cars(document.scene()) > 100 && cars(&after) == 0,
        "{}",
        cars(&after)
    );
    let report = json(&sceneloom(&["diff", &path, &edited, "--json"]));
    assert_eq!(
        report["boxes"]["removed"].as_array().map(Vec::len),
        Some(2),
        "{report}"
    );
    // Files of other programs hold the networks' window, as their readers expect.
    let npz = folder.path("labels.npz");
    json(&sceneloom(&[
        "export", &path, "--format", "occ3d", "-o", &npz, "--json",
    ]));
    let labels = formats::occ3d::load(npz.as_ref())
        .expect("a file of Occ3D")
        .labels;
    assert_eq!(labels, document.scene().frame().occupancy.crop(Extent::WINDOW));
}
