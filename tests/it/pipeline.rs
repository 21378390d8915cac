//! The shipped networks at work: edits by inversion keep what they do not touch, to the bit.

use std::sync::Arc;

use editor::{Document, Edit};
use glam::{DVec2, DVec3};
use job::inpaint::InpaintMask;
use job::pipeline::OccPipeline;
use job::{GenParams, GenResult, Job, JobCtx, JobUpdate, Pipeline, RegionMode, Stage};
use nets::OccModels;
use scene::raster::box_cells;
use scene::{BoxId, Class, Frame, Scene, SensorRig, Window};
use world::voxelize::{Vertical, complete};
use world::{World, template, traffic};

fn scene() -> Scene {
    let layout = template::layout("intersection", 4).expect("a template");
    let boxes = traffic::place(&layout, 4, &traffic::TrafficSpec::NORMAL);
    let world = World::new(layout, boxes, 4);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    Scene::single("test", frame, Arc::new(SensorRig::default()), 4)
}

fn pipeline() -> OccPipeline {
    OccPipeline::new(OccModels::bundled().expect("the shipped weights load"))
}

fn params() -> GenParams {
    GenParams {
        steps: 5,
        ..GenParams::default()
    }
}

fn run(pipeline: &mut OccPipeline, document: &mut Document) -> GenResult {
    let job = Job {
        scene: document.scene().clone(),
        params: params(),
    };
    let result = pipeline.run(&job, &JobCtx::detached()).expect("a result");
    document
        .adopt(result.rev(), result.occupancy.clone())
        .expect("the current state");
    result
}

fn a_car(document: &Document) -> BoxId {
    let boxes = &document.scene().frame().boxes;
    *boxes
        .iter()
        .find(|(_, b)| b.class == Class::Car)
        .expect("a car")
        .0
}

#[test]
fn an_edit_of_nothing_asks_no_network() {
    let mut document = Document::new(scene());
    let before = document.scene().frame().occupancy.clone();
    let result = run(&mut pipeline(), &mut document);
    assert_eq!(result.report.network_calls, 0);
    assert_eq!(result.occupancy, before);
    document
        .apply(
            "Prompt",
            &Edit::SetPrompt {
                prompt: "night".into(),
            },
        )
        .expect("a valid edit");
    assert_eq!(run(&mut pipeline(), &mut document).report.network_calls, 0);
}

#[test]
fn a_removed_car_goes_and_the_next_edit_needs_no_inversion() {
    let mut pipeline = pipeline();
    let mut document = Document::new(scene());
    let id = a_car(&document);
    let car = document.scene().frame().boxes[&id];
    let before = document.scene().frame().occupancy.clone();
    document
        .apply("Remove car", &Edit::RemoveBox { id })
        .expect("a valid edit");
    let first = run(&mut pipeline, &mut document);
    assert_eq!(first.report.untouched_voxels_changed, 0);
    assert_eq!(
        (first.report.inversion_calls, first.report.network_calls),
        (5, 10)
    );
    let (mut all, mut gone) = (0, 0);
    box_cells(scene::Extent::WINDOW, &car, 0.0, |x, y| {
        for (old, new) in before.column(x, y).iter().zip(first.occupancy.column(x, y)) {
            all += i32::from(*old == Class::Car.id());
            let left = *new == Class::FREE || Class::from_id(*new).is_some_and(Class::is_ground);
            gone += i32::from(*old == Class::Car.id() && left);
        }
    });
    assert!(
        all > 100 && gone * 100 >= all * 90,
        "{gone} of {all} voxels of the car are gone"
    );

    let cone = Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(6.0, -1.0, 0.5),
        size_m: DVec3::new(0.5, 0.5, 1.0),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: None,
        label: Default::default(),
    };
    document.apply("Add cone", &cone).expect("a valid edit");
    let second = run(&mut pipeline, &mut document);
    assert_eq!(
        (second.report.inversion_calls, second.report.network_calls),
        (0, 5)
    );
    assert_eq!(second.report.untouched_voxels_changed, 0);
}

#[test]
fn an_edit_is_seen_from_its_first_step_on() {
    let mut document = Document::new(scene());
    let id = a_car(&document);
    document.apply("Remove", &Edit::RemoveBox { id }).expect("there");
    let job = Job {
        scene: document.scene().clone(),
        params: params(),
    };
    let news = std::sync::Mutex::new(Vec::new());
    let report = |update| news.lock().expect("one thread").push(update);
    let ctx = JobCtx::new(&|| false, &report).with_previews();
    let result = pipeline().run(&job, &ctx).expect("a result");
    let steps_before_the_first = news
        .lock()
        .expect("one thread")
        .iter()
        .take_while(|update| !matches!(update, JobUpdate::Preview(_)))
        .filter(|update| {
            matches!(
                update,
                JobUpdate::Progress {
                    stage: Stage::Denoise,
                    ..
                }
            )
        })
        .count();
    let news = news.into_inner().expect("one thread");
    let previews: Vec<_> = news
        .iter()
        .filter_map(|update| match update {
            JobUpdate::Preview(result) => Some(result),
            _ => None,
        })
        .collect();
    assert!(
        !previews.is_empty() && steps_before_the_first == 1,
        "{steps_before_the_first}"
    );
    // They show the region alone, and the result does not depend on them.
    let (source, region) = (
        &document.scene().frame().source.occupancy,
        job::inpaint::region_of(document.scene().frame(), &job.params),
    );
    for preview in &previews {
        let other = job::composite::untouched_voxels_changed(
            source,
            &preview.occupancy,
            &region,
            &document.scene().frame().painted,
        );
        assert_eq!(other, 0);
    }
    let unseen = pipeline().run(&job, &JobCtx::detached()).expect("a result");
    assert_eq!(unseen.occupancy, result.occupancy);
}

#[test]
fn painted_voxels_are_kept_by_every_generation() {
    let mut document = Document::new(scene());
    let cells: Vec<[usize; 3]> = (0..6).map(|z| [120, 104, z]).collect();
    let wall = Edit::PaintVoxels {
        cells: cells.clone(),
        class: Class::Manmade,
    };
    document.apply("Wall", &wall).expect("a valid edit");
    for region in [RegionMode::Auto, RegionMode::Full] {
        let job = Job {
            scene: document.scene().clone(),
            params: GenParams { region, ..params() },
        };
        let result = pipeline().run(&job, &JobCtx::detached()).expect("a result");
        for [x, y, z] in &cells {
            assert_eq!(result.occupancy.get(*x, *y, *z), Class::Manmade.id());
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let id = a_car(&Document::new(scene()));
    let generate = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| {
            let mut document = Document::new(scene());
            document
                .apply("Remove car", &Edit::RemoveBox { id })
                .expect("a valid edit");
            run(&mut pipeline(), &mut document).occupancy
        })
    };
    let one = generate(1);
    assert_eq!(one, generate(2));
    assert_eq!(one, generate(5));
}

#[test]
fn a_region_is_inpainted_and_nothing_outside_it() {
    let document = Document::new(scene());
    let source = document.scene().frame().source.occupancy.clone();
    let inpaint = InpaintMask::of_rect(
        scene::Extent::WINDOW,
        DVec2::new(-12.0, 8.0),
        DVec2::new(4.0, 24.0),
    );
    let draw = |seed: u64| {
        let params = GenParams {
            inpaint: inpaint.clone(),
            strength: 0.9,
            seed,
            ..params()
        };
        let job = Job {
            scene: document.scene().clone(),
            params,
        };
        pipeline().run(&job, &JobCtx::detached()).expect("a result")
    };
    let result = draw(1);
    // From fresh noise at nine tenths of the steps: nothing is inverted, and every token sees what lies around.
    let steps = (0.9 * f64::from(params().steps)).round() as usize;
    assert_eq!(result.report.network_calls, steps);
    assert_eq!(result.report.inversion_calls, 0);
    assert_eq!(result.report.tokens, OccModels::TOKENS);
    assert_eq!(result.report.untouched_voxels_changed, 0);
    let mut changed = 0;
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            let differs = result.occupancy.column(x, y) != source.column(x, y);
            assert!(
                !differs || inpaint.has_column(scene::Extent::WINDOW, [x, y]),
                "column ({x}, {y})"
            );
            changed += usize::from(differs);
        }
    }
    assert!(changed > 0, "something new");
    assert_ne!(draw(2).occupancy, result.occupancy, "other noise, another result");
}
