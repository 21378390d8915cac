//! Plans of repairs on scenes of noise, and what they never do.

use glam::{DVec2, DVec3};
use scene::clip::{Path, Speed};
use scene::{BoxId, Class, Motion, SceneBox};

use super::*;
use crate::Apply;
use crate::checks::tests::{object, street, traffic};
use crate::checks::tests_noise::{noise, random};

fn counts(scene: &Scene) -> SeverityCounts {
    checks::tally(scene).counts()
}

/// The plan, ended after so many scenes that were tried out.
fn plan_in(scene: &Scene, tries: usize) -> RepairPlan {
    let findings = checks::run_checks(scene, None);
    let mut left = tries;
    plan_all(scene, &findings, &|edits| edits, &mut |_| match left {
        0 => ControlFlow::Break(()),
        _ => {
            left -= 1;
            ControlFlow::Continue(())
        }
    })
}

/// Applies a plan and holds it to what it says: as many errors as it says and never more than before.
fn holds(scene: &Scene, plan: &RepairPlan, what: &str) -> SeverityCounts {
    let before = counts(scene);
    let mut after = scene.clone();
    apply_all(&plan.edits(), &mut after).expect("a plan applies");
    let after_all = counts(&after);
    assert_eq!((plan.before, plan.after), (before, after_all), "{what}");
    assert!(
        after_all.errors <= before.errors,
        "{what}: {before:?} {after_all:?}"
    );
    let errors = |r: &&Repair| r.finding.severity == Severity::Error;
    let repaired = plan.repairs.iter().filter(errors).count();
    assert!(
        after_all.errors + repaired <= before.errors,
        "{what}: {repaired} repaired"
    );
    // Warnings are no price for the repair of warnings.
    if repaired == 0 {
        assert!(after_all.warnings <= before.warnings, "{what}");
    }
    assert_eq!(after.frame().extent(), scene.frame().extent(), "{what}");
    after_all
}

/// Boxes of all kinds anywhere, also in each other, in the ground and off the map, on a street.
fn crowd(seed: u64, boxes: u64) -> Scene {
    let mut next = random(seed);
    let mut at = |low: f64, high: f64| low + (high - low) * next(1 << 20) as f64 / f64::from(1 << 20);
    let all: Vec<SceneBox> = (1..=boxes)
        .map(|i| {
            let class = Class::OBJECTS[(i % Class::OBJECTS.len() as u64) as usize];
            let b = object(i as u32, class, at(-42.0, 42.0), at(-20.0, 20.0), at(0.0, 360.0));
            SceneBox {
                center_m: b.center_m + DVec3::new(0.0, 0.0, at(-1.0, 1.0)),
                ..b
            }
        })
        .collect();
    street(&all)
}

#[test]
fn repairs_of_noise_never_leave_more_errors() {
    let mut less = 0;
    for seed in 1..=4 {
        let scene = crowd(seed, 12 * seed);
        let plan = plan_in(&scene, 30);
        let after = holds(&scene, &plan, &format!("crowd {seed}"));
        less += plan.before.errors - after.errors;
    }
    assert!(less > 0, "some of them can be repaired");
    for (seed, percent) in [(2, 8), (1, 100)] {
        let scene = noise(seed, percent);
        let plan = plan_in(&scene, 3);
        holds(&scene, &plan, &format!("{percent} % of noise"));
        assert!(
            plan.stopped && !plan.stays.is_empty(),
            "what was not tried is told"
        );
    }
}

#[test]
fn a_plan_says_what_it_does_and_what_stays() {
    // A car in the ground, one that is put twice, and two that cannot get apart: one is locked.
    let mut boxes = traffic();
    boxes[0].center_m.z = -1.0;
    boxes.push(SceneBox {
        id: BoxId(8),
        ..boxes[1]
    });
    boxes.push(object(9, Class::Car, -15.5, -1.6, 0.0));
    let mut scene = street(&boxes);
    let mut arranged = scene.arranged.as_ref().clone();
    arranged.locked.boxes.insert(BoxId(9));
    scene.arranged = arranged.into();
    let findings = checks::run_checks(&scene, None);
    let plan = plan_at_once(&scene, &findings);
    let done: Vec<_> = plan
        .repairs
        .iter()
        .map(|r| (r.finding.check, r.finding.box_id, r.label))
        .collect();
    assert!(
        done.contains(&("out_of_range", Some(BoxId(1)), "Drop to the ground")),
        "{done:?}"
    );
    assert!(
        done.contains(&("unsound", Some(BoxId(8)), "Remove the copy")),
        "{done:?}"
    );
    let stays: Vec<_> = plan.stays.iter().map(|(f, why)| (f.box_id, *why)).collect();
    assert_eq!(stays, [(Some(BoxId(9)), Stays::Locked)], "{done:?}");
    assert!(!plan.stopped && plan.of == scene.rev);
    holds(&scene, &plan, "a street");
    // The same again, and nothing where the first scene to try is not wanted.
    assert_eq!(plan_at_once(&scene, &findings), plan);
    let none = plan_in(&scene, 0);
    assert!(none.repairs.is_empty() && none.stopped);
    assert!(none.stays.iter().any(|(_, why)| *why == Stays::NotTried));
}

#[test]
fn a_repair_that_brings_an_error_is_left_out() {
    // The voxels in the lane are of no box; a box around them would stand in the truck.
    let mut scene = street(&traffic());
    let findings = checks::run_checks(&scene, None);
    assert!(findings.is_empty());
    let cells = |from: usize| (0..40).map(move |i| [from + i % 10, 96, 1 + i / 10]).collect();
    let paint = Edit::PaintVoxels {
        cells: cells(58),
        class: Class::Car,
    };
    paint.apply(&mut scene).expect("sound");
    let before = checks::run_checks(&scene, None);
    let plan = plan_at_once(&scene, &before);
    holds(&scene, &plan, "voxels in a truck");
    // Each repair by itself, as it was done before, is what a plan has to be better than.
    let mut worse = scene.clone();
    for fix in before.iter().filter_map(|f| f.fixes.first()) {
        apply_all(&fix.edits, &mut worse).expect("it applies");
    }
    assert!(
        counts(&worse).errors > counts(&scene).errors,
        "the scene shows nothing: {before:?}"
    );
}

#[test]
fn no_map_grows_unasked() {
    let mut scene = street(&traffic());
    let drives = Motion::Path(Path {
        points_m: vec![DVec2::new(20.0, 1.8), DVec2::new(-90.0, 1.8)],
        start_m: 0.0,
        speeds: vec![
            Speed {
                time_s: 0.0,
                mps: 12.0,
            },
            Speed {
                time_s: 9.0,
                mps: 12.0,
            },
        ],
        rear_first: false,
    });
    for edit in [
        Edit::SetLength {
            length_s: 8.0,
            rate_hz: None,
        },
        Edit::SetMotion {
            id: Some(BoxId(2)),
            motion: Some(drives),
            from_s: None,
            to_s: None,
        },
    ] {
        edit.apply(&mut scene).expect("sound");
    }
    let findings = checks::run_checks(&scene, None);
    let leaves = findings.iter().find(|f| f.check == "leaves_map").expect("found");
    assert!(leaves.fixes[0].enlarges_the_map() && leaves.first_fix().is_none());
    let plan = plan_at_once(&scene, &findings);
    holds(&scene, &plan, "a car that leaves");
    let stays: Vec<_> = plan.stays.iter().map(|(f, why)| (f.check, *why)).collect();
    assert!(stays.contains(&("leaves_map", Stays::AskedForAlone)), "{stays:?}");
}
