//! The history of a scene in its file: 200 steps saved, reopened, undone to the start and replayed; a damaged one; on the command
//! line.

use std::sync::Arc;

use editor::Document;
use formats::loom;
use glam::{DVec2, DVec3};
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx, Pipeline};
use nets::OccModels;
use scene::op::Author;
use scene::{BevLayer, Class, Conditions, Edit, Scene, Shape, TimeOfDay, Weather};

/// Steps as a designer makes them: boxes, map, voxels, weather, words. The first few are generated.
fn edited(steps: usize, generated: usize) -> Document {
    let mut document = Document::new(app::open::bundled().expect("bundled"));
    let mut pipeline = OccPipeline::new(OccModels::bundled().expect("bundled"));
    let never = || false;
    for i in 0.. {
        if document.position() == steps {
            break;
        }
        let (a, b) = ((i * 37 % 60) as f64 - 30.0, (i * 23 % 40) as f64 - 20.0);
        let edit = match i % 5 {
            0 => Edit::AddBox {
                class: [Class::Car, Class::Pedestrian, Class::Truck][i / 5 % 3],
                center_m: DVec3::new(a, b, 0.9),
                size_m: DVec3::new(2.0, 1.0, 1.8),
                yaw_deg: a,
                velocity_mps: None,
                id: None,
                label: Default::default(),
            },
            1 => Edit::PaintBev {
                layer: [BevLayer::DrivableArea, BevLayer::Walkway][i / 5 % 2],
                shape: Shape::Disc {
                    center_m: DVec2::new(a, b),
                    radius_m: 1.0 + (i % 7) as f64 / 2.0,
                },
                value: i % 2 == 0,
            },
            2 => Edit::PaintVoxels {
                cells: (0..1 + i % 9)
                    .map(|k| [(i * 31 + k) % 200, i * 17 % 200, k])
                    .collect(),
                class: Class::Manmade,
            },
            3 => Edit::SetConditions {
                conditions: Conditions::usual(TimeOfDay::ALL[i % 4], Weather::ALL[i % 6], i as u64),
            },
            _ => Edit::SetPrompt {
                prompt: format!("street {i}"),
            },
        };
        document.apply(format!("Step {i}"), &edit).expect("sound");
        if i < generated && matches!(i % 5, 0..=2) {
            let job = Job {
                scene: document.scene().clone(),
                params: GenParams {
                    steps: 2,
                    ..GenParams::default()
                },
            };
            let result = pipeline
                .run(&job, &JobCtx::new(&never, &|_| {}))
                .expect("generated");
            document
                .adopt(result.rev(), result.occupancy.clone())
                .expect("shown");
        }
    }
    document
}

#[test]
fn two_hundred_steps_are_undone_after_the_file_is_opened_again() {
    let mut document = edited(200, 10);
    assert_eq!(document.position(), 200);
    let bytes = loom::to_bytes(&document.to_save()).expect("sound");
    let bare = loom::to_bytes(document.scene()).expect("sound");
    let (without, with) = (bare.len(), bytes.len());
    println!("a scene of 200 steps: {with} bytes, {without} without its history");
    assert!(with <= 3 * without, "{with} bytes, {without} without the history");
    let start = std::time::Instant::now();
    let loaded = loom::from_bytes(&bytes).expect("sound");
    let read_s = start.elapsed().as_secs_f64();
    let (mut again, note) = Document::open(loaded);
    let open_s = start.elapsed().as_secs_f64();
    println!("read in {read_s:.2} s, replayed by {open_s:.2} s");
    assert_eq!(note, None);
    assert!(!again.is_dirty());
    // Every step back is the state that was there, to the byte.
    let state = |scene: &Scene| loom::alone_to_bytes(scene).expect("sound");
    for step in (0..=200).rev() {
        assert_eq!((document.position(), again.position()), (step, step));
        assert_eq!(document.undo_label(), again.undo_label());
        if step % 20 == 0 {
            assert_eq!(state(again.scene()), state(document.scene()), "step {step}");
        } else {
            assert!(again.scene().is_same(document.scene()), "step {step}");
        }
        document.undo();
        again.undo();
    }
    assert!(again.scene().is_same(&app::open::bundled().expect("bundled")));
    while again.redo().is_some() {}
    assert_eq!(again.replays(), Ok(true));
    // Saved again it is the same file.
    assert_eq!(loom::to_bytes(&again.to_save()).expect("sound"), bytes);
}

/// A step in the middle is left out, and the scene is as if it had never been made; the file keeps that too.
#[test]
fn a_step_in_the_middle_is_left_out() {
    let mut document = edited(20, 0);
    let left = document.leave_out(6).expect("a step");
    assert_eq!(
        (left.label.as_str(), left.skipped.len(), left.changed),
        ("Step 5", 0, true)
    );
    let (mut again, note) = Document::open(document.to_save());
    assert_eq!(note, None);
    assert!(again.scene().is_same(document.scene()));
    assert!(again.history_steps()[6].is_left_out);
    again.undo();
    document.undo();
    assert!(again.scene().is_same(document.scene()), "undo brings it back");
    again.set_author(Author::ASSISTANT);
    assert_eq!(again.undo_own(), None, "none of these steps is the assistant's");
}

/// A file of the version before has no history, and begins one.
#[test]
fn an_older_file_begins_a_history() {
    let path = crate::house::root().join("tests/reference/loom/v9.loom");
    let (mut document, note) = Document::open(loom::load(&path).expect("opens"));
    assert_eq!((note, document.can_undo()), (None, false));
    assert!(document.log().is_none(), "nothing was changed");
    let edit = Edit::SetPrompt { prompt: "new".into() };
    document.apply("Words", &edit).expect("sound");
    let kept = document.to_save().kept.versions.len();
    let again = loom::from_bytes(&loom::to_bytes(&document.to_save()).expect("sound")).expect("sound");
    assert_eq!(again.kept.versions.len(), kept);
    let (again, note) = Document::open(again);
    assert_eq!((note, again.undo_label()), (None, Some("Words")));
}

/// A log that leads to another state than the file's: the scene is as saved, and a line says so.
#[test]
fn a_scene_that_was_changed_by_another_program_keeps_its_state() {
    let document = edited(5, 0);
    let mut scene = document.to_save();
    scene.touch();
    scene.prompt = Arc::from("by hand");
    let (document, note) = Document::open(scene);
    assert_eq!(
        note.as_deref(),
        Some("The scene was changed outside the history of its file")
    );
    assert_eq!(&*document.scene().prompt, "by hand");
    assert_eq!(document.history().last(), Some("Changed outside the history"));
    assert!(!document.is_dirty());
}
