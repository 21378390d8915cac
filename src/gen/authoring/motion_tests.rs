//! Readings with motion become clips; the reader network has tests of its own.

use scene::{BoxId, Class, Edit, Key, Motion, Scene, SceneBox};
use words::describe::describe;
use words::hear::{By, CheckedReading};
use words::notation::parse;

use super::*;

fn made_of(line: &str, seed: u64) -> (Scene, Vec<String>) {
    let description = describe(&parse(line).expect("notation")).description;
    let made = make("", &description, seed, &How::default());
    (made.scene, made.laid.road.missing)
}

fn first(scene: &Scene, class: Class) -> BoxId {
    let of_class = scene.clip().tracks.values().find(|t| t.made.class == class);
    of_class.expect("it moves").made.id
}

/// Where a box is in the frame of the ego vehicle, m.
fn seen(scene: &Scene, id: BoxId, time_s: f64) -> glam::DVec2 {
    let view = scene.at(time_s);
    let frame = view.frame();
    let at = frame.boxes[&id].center_m;
    frame.world_from_ego.inverse().apply(at).truncate()
}

#[test]
fn a_car_from_the_right_lane_ends_in_ours() {
    for seed in 0..6 {
        let (scene, missing) = made_of(
            "road straight ; lanes 4 ; own_lane left ; add 1 car ( on right_lane ) ( ahead ego ) ; go the car cut_in from 2s",
            seed,
        );
        assert_eq!(missing, Vec::<String>::new());
        assert_eq!(scene.clip().length_s, 8.0);
        let car = first(&scene, Class::Car);
        let [before, after] = [1.5, 7.0].map(|t| seen(&scene, car, t).y);
        assert!(
            before < -2.0 && after.abs() < 1.2,
            "seed {seed}: {before} to {after} m"
        );
        assert!(scene.clip().ego.is_some());
    }
}

#[test]
fn a_motion_of_ours_is_kept() {
    let (scene, _) = made_of("road straight ; add 1 bus ( ahead ego 20m )", 2);
    let say = |scene: &Scene| {
        let line = "go the bus pull_out gap 10m";
        let heard = CheckedReading {
            reading: parse(line).expect("notation"),
            by: By::Hand,
            other: None,
            unsure: Vec::new(),
            missing: Vec::new(),
            mended: Vec::new(),
        };
        edited(heard, scene, 1).edits()
    };
    let of_us = |edits: &[Edit]| edits.iter().any(|e| matches!(e, Edit::LetMove { id: None, .. }));
    assert!(of_us(&say(&scene)), "nobody comes nearer while we stand");
    let mut driven = scene;
    driven.change_clip(|clip| {
        clip.length_s = 8.0;
        clip.ego = Some(Motion::Keys(vec![
            Key {
                time_s: 0.0,
                at_m: glam::DVec2::ZERO,
                yaw_deg: 0.0,
            },
            Key {
                time_s: 8.0,
                at_m: glam::DVec2::new(40.0, 0.0),
                yaw_deg: 0.0,
            },
        ]));
    });
    assert!(!of_us(&say(&driven)));
}

#[test]
fn somebody_who_is_not_there_comes_in() {
    let (scene, _) = made_of("road straight ; add 2 person ( ahead ego )", 2);
    let said = read_edit("a child runs across 15 m ahead at second 3", &scene, 1).expect("the reader");
    let edits = said.edits();
    assert!(said.outcome.questions.is_empty(), "{:?}", said.outcome.questions);
    let adds = |e: &Edit| {
        matches!(
            e,
            Edit::AddBox {
                class: Class::Pedestrian,
                ..
            }
        )
    };
    assert_eq!(edits.iter().filter(|e| adds(e)).count(), 1, "{edits:?}");
    let crosses = |e: &Edit| {
        matches!(
            e,
            Edit::LetMove {
                id: Some(_),
                from_s: Some(3.0),
                ..
            }
        )
    };
    assert!(edits.iter().any(crosses), "{edits:?}");
    // A box that is there moves.
    let said = read_edit("a pedestrian crosses the road after 2 s", &scene, 1).expect("the reader");
    assert!(!said.edits().iter().any(adds) && said.outcome.questions.is_empty());
}

#[test]
fn a_child_waits_at_the_side_and_runs_across() {
    for seed in 0..6 {
        let (scene, missing) = made_of(
            "add 1 child ( ahead ego 15m ) ; go the child cross from 3s fast",
            seed,
        );
        assert_eq!(missing, Vec::<String>::new());
        let child = first(&scene, Class::Pedestrian);
        let at = |t: f64| scene.at(t).frame().boxes[&child].center_m.truncate();
        assert_eq!(at(0.0), at(2.9), "seed {seed}");
        let way = at(6.0) - at(3.0);
        assert!(
            way.length() > 5.0 && way.y.abs() > way.x.abs(),
            "seed {seed}: {way}"
        );
    }
}

#[test]
fn a_bus_pulls_out_when_we_are_near() {
    let (scene, missing) = made_of("add 1 bus ( ahead ego 30m ) ; go the bus pull_out gap 10m", 2);
    assert_eq!(missing, Vec::<String>::new());
    let bus = first(&scene, Class::Bus);
    let moves = |t: f64| scene.at(t).frame().boxes[&bus].velocity_mps.length() > 0.2;
    let from_s = (0..80)
        .map(|i| f64::from(i) * 0.1)
        .find(|t| moves(*t))
        .expect("it moves");
    let gap_m = seen(&scene, bus, from_s).length() - 5.5 - 2.1;
    assert!((5.0..12.0).contains(&gap_m), "{gap_m} m at {from_s} s");
}

#[test]
fn what_cannot_be_is_said_and_the_rest_is_done() {
    let (scene, missing) = made_of(
        "length 4s ; add 1 bus ( behind ego 30m ) and 1 person ; go the bus pull_out gap 2m ; go the person cross from 1s",
        1,
    );
    assert_eq!(scene.clip().length_s, 4.0);
    assert!(
        missing.iter().any(|m| m.contains("never come within 2 m")),
        "{missing:?}"
    );
    assert!(
        scene
            .clip()
            .tracks
            .values()
            .any(|t| t.made.class == Class::Pedestrian)
    );
    let (still, _) = made_of("add 1 bus", 1);
    assert!(still.clip().is_still());
}

fn by_hand(line: &str) -> CheckedReading {
    CheckedReading {
        reading: parse(line).expect("notation"),
        by: By::Hand,
        other: None,
        unsure: Vec::new(),
        missing: Vec::new(),
        mended: Vec::new(),
    }
}

/// "Nobody moves any more" removes motions, but no box; the answer says that we go on.
#[test]
fn what_moves_is_halted_and_stays() {
    let (scene, _) = made_of(
        "road straight ; add 1 bus ( ahead ego 20m ) and 2 person ( on sidewalk ) ; go the bus drive",
        2,
    );
    assert!(!scene.clip().stands() && scene.clip().ego.is_some());
    let boxes = scene.frame().boxes.len();
    let edited = edited(by_hand("set all thing waiting"), &scene, 1);
    let mut after = scene.clone();
    apply_all(&edited.edits(), &mut after).expect("sound");
    assert_eq!(after.frame().boxes.len(), boxes);
    assert!(
        after.clip().tracks.values().all(|t| t.stands()),
        "{:?}",
        edited.edits()
    );
    let standing = |id: &BoxId| after.at(5.0).frame().boxes[id].center_m;
    assert!(
        after
            .frame()
            .boxes
            .iter()
            .all(|(id, b)| standing(id).distance(b.center_m) < 1e-6)
    );
    assert!(
        edited.answer().contains("we ourselves go on"),
        "{}",
        edited.answer()
    );
}

/// The answer to words reports new collisions, but none that were there before.
#[test]
fn collisions_are_told_in_the_answer() {
    let (scene, _) = made_of("road straight ; add 1 bus ( ahead ego 20m )", 2);
    let mut full = scene.clone();
    let bus = scene.frame().boxes.values().next().copied().expect("a bus");
    // We drive into it.
    let edited = edited(by_hand("go ego drive speed 60kmh"), &full, 1);
    let answer = edited.answer_on(&full);
    assert!(
        answer.contains("But collisions:") && answer.contains("the ego vehicle"),
        "{answer}"
    );
    // Another box that overlaps already is not reported.
    let second = SceneBox {
        id: BoxId(900),
        ..bus
    };
    full.change_canvas(|c| c.boxes.insert(second.id, second));
    let said = super::edited(by_hand("time night"), &full, 1).answer_on(&full);
    assert!(!said.contains("collisions"), "{said}");
}

/// A distance that could not be kept is reported with the one found.
#[test]
fn a_place_elsewhere_than_asked_is_told_with_its_figure() {
    let description = describe(
        &parse("road straight ; add 1 bus ( ahead ego 6m ) and 1 car ( ahead ego 8m )").expect("notation"),
    )
    .description;
    let made = make("", &description, 3, &How::default());
    let map = place::lanes::LaneMap::new(&made.laid.road.layout);
    let graph = &made.laid.graphed.graph;
    let off = place::off::off(graph, &map, &made.laid.placement.boxes);
    for x in &off {
        let figures = format!("{:.1} m in place of {:.1} m", x.found_m, x.asked_m);
        assert!(
            made.laid.notes.iter().any(|n| n.contains(&figures)),
            "{figures}: {:?}",
            made.laid.notes
        );
    }
    // (two long vehicles do not fit 2 m apart)
    assert!(!off.is_empty() || !made.laid.placement.left_out.is_empty());
    // An open scene reports it too.
    let (scene, _) = made_of("road straight ; add 1 bus ( ahead ego 20m )", 2);
    for metres in [10.0, 19.0, 24.0] {
        let edited = edited(
            by_hand(&format!("add 1 truck ( ahead ego {metres}m )")),
            &scene,
            1,
        );
        let added = edited.outcome.edits.iter().find_map(Edit::added_box);
        let Some(truck) = added else { continue };
        let found_m = truck.center_m.x;
        let told = edited.answer().contains("in place of");
        assert_eq!(
            told,
            (found_m - metres).abs() > 0.5,
            "{found_m} m: {}",
            edited.answer()
        );
    }
}
