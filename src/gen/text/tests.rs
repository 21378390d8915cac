//! Prompts, placements and edits by text, extremes included.

use std::collections::BTreeMap;

use super::description::{Anchor, Density, Road, TimeOfDay, Weather};
use super::edit::{OpenScene, TextEdit, read_edit};
use super::holds::overlap_m;
use super::place::place_with;
use super::to_graph::to_graph;
use super::{read, road};
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};
use crate::scene::{BevLayout, BoxId, Class, Paint, SceneBox};

fn counts(prompt: &str) -> Vec<(Class, u32)> {
    let r = read(prompt);
    r.description
        .foreground
        .iter()
        .map(|o| (o.class, o.count.n))
        .collect()
}

fn relations(prompt: &str) -> Vec<(usize, RelationKind, Anchor)> {
    let d = read(prompt).description;
    let all = d.foreground.iter().enumerate();
    all.flat_map(|(i, o)| o.relations.iter().map(move |r| (i, r.relation, r.anchor)))
        .collect()
}

#[test]
fn counts_classes_and_spelling() {
    use Class::{
        Barrier, Bicycle, Bus, Car, ConstructionVehicle, Motorcycle, Pedestrian, TrafficCone, Truck,
    };
    for (prompt, expected) in [
        ("three cars and a lorry", vec![(Car, 3), (Truck, 1)]),
        ("a couple of cabs, a coach", vec![(Car, 2), (Bus, 1)]),
        (
            "half a dozen cones; twelve people",
            vec![(TrafficCone, 6), (Pedestrian, 12)],
        ),
        ("twenty-two cyclists", vec![(Bicycle, 22)]),
        ("cones x5", vec![(TrafficCone, 5)]),
        ("2x motorbike", vec![(Motorcycle, 2)]),
        (
            "an excavatr and two jersey barriers",
            vec![(ConstructionVehicle, 1), (Barrier, 2)],
        ),
        ("🚗🚗 🚌", vec![(Car, 1), (Car, 1), (Bus, 1)]),
        ("no cars", vec![]),
    ] {
        assert_eq!(counts(prompt), expected, "{prompt}");
    }
    assert!(read("an excavatr").notes.iter().any(|n| n.contains("excavator")));
    let parts = read("three cars: one behind me and two ahead").description;
    let n: u32 = parts.foreground.iter().map(|o| o.count.n).sum();
    assert_eq!(n, 3);
}

#[test]
fn relations_belong_to_the_right_things() {
    use Anchor::{Crossing, Ego, Lane, Object};
    use RelationKind as R;
    for (prompt, expected) in [
        ("a bus in front of me", vec![(0, R::InFrontOf, Ego)]),
        ("Behind me, a van.", vec![(0, R::Behind, Ego)]),
        (
            "five cones block my lane, a bus waits at the crossing",
            vec![(0, R::Blocking, Lane(LaneRole::Ego)), (1, R::WaitingAt, Crossing)],
        ),
        (
            "my lane is blocked by three cones",
            vec![(0, R::Blocking, Lane(LaneRole::Ego))],
        ),
        ("a bus followed by two cars", vec![(1, R::Following, Object(0))]),
        (
            "There is a bus ahead and behind it a taxi",
            vec![(0, R::InFrontOf, Ego), (1, R::Behind, Object(0))],
        ),
        (
            "a man crossing the road",
            vec![(0, R::Crossing, Lane(LaneRole::Road))],
        ),
        (
            "on the left a van, on the right a bus",
            vec![(0, R::LeftOf, Ego), (1, R::RightOf, Ego)],
        ),
        ("a bus in the left lane", vec![(0, R::On, Lane(LaneRole::Left))]),
        ("an oncoming lorry", vec![(0, R::OppositeDirection, Ego)]),
        (
            "kids on the left pavement",
            vec![(0, R::On, Lane(LaneRole::LeftSidewalk)), (0, R::LeftOf, Ego)],
        ),
        ("a bus and, behind it, a truck", vec![(1, R::Behind, Object(0))]),
        ("a cyclist approaching from the right", vec![(0, R::RightOf, Ego)]),
    ] {
        assert_eq!(relations(prompt), expected, "{prompt}");
    }
    let far = read("a lorry 30 ft ahead").description;
    let metres = far.foreground[0].relations[0].distance_m.expect("stated");
    assert!((metres - 9.144).abs() < 1e-9);
    let parked = read("a parked car").description;
    assert_eq!(parked.foreground[0].state, Some(ObjectState::Parked));
}

#[test]
fn what_was_said_before_is_not_said_again() {
    let counts = |prompt: &str| -> Vec<(Class, u32)> {
        let d = read(prompt).description;
        d.foreground.iter().map(|o| (o.class, o.count.n)).collect()
    };
    for (prompt, expected) in [
        (
            "on the left there are three cars, and on the right two",
            vec![(Class::Car, 3), (Class::Car, 2)],
        ),
        (
            "cones along the left edge, six of them",
            vec![(Class::TrafficCone, 6)],
        ),
        (
            "cones block my lane, four in total",
            vec![(Class::TrafficCone, 4)],
        ),
        ("seven vehicles, all trucks", vec![(Class::Truck, 7)]),
        ("two people on bikes", vec![(Class::Bicycle, 2)]),
        ("a roadblock of five barriers", vec![(Class::Barrier, 5)]),
        (
            "two cars on the left and two on the right",
            vec![(Class::Car, 2), (Class::Car, 2)],
        ),
        (
            "a car ahead and a second one behind me",
            vec![(Class::Car, 1), (Class::Car, 1)],
        ),
    ] {
        assert_eq!(counts(prompt), expected, "{prompt}");
    }
}

#[test]
fn style_and_road() {
    let d = read("busy intersection at night in the rain").description;
    assert_eq!(
        (d.time_of_day, d.weather),
        (Some(TimeOfDay::Night), Some(Weather::Rain))
    );
    assert_eq!(
        (d.road.kind, d.density),
        (Some(Road::Intersection), Some(Density::Busy))
    );
    assert_eq!(d.style(), "night, rain");
    assert_eq!(
        read("not raining, a bus").description.weather,
        Some(Weather::Clear)
    );
    assert_eq!(
        read("at 3 am a taxi").description.time_of_day,
        Some(TimeOfDay::Night)
    );
    assert_eq!(read("a T-junction").description.road.kind, Some(Road::TJunction));
}

#[test]
fn what_is_not_understood_is_said() {
    let r = read("a purple wug gyres near the bus and two dogs");
    let texts: Vec<&str> = r.not_understood.iter().map(|u| u.text.as_str()).collect();
    assert!(texts.iter().any(|t| t.contains("wug")), "{texts:?}");
    assert!(texts.iter().any(|t| t.contains("two dogs")), "{texts:?}");
    // Every phrase names its own words.
    let prompt = "Five cones block my lane; a bus waits at the crossing, at night.";
    for p in read(prompt).phrases {
        assert_eq!(p.span.of(prompt), p.text);
        assert!(!p.text.is_empty());
    }
}

struct Made {
    layout: BevLayout,
    boxes: BTreeMap<BoxId, SceneBox>,
    left_out: usize,
    wanted: usize,
}

fn make(prompt: &str, seed: u64) -> Made {
    let d = read(prompt).description;
    let g = to_graph(&d, seed);
    assert_eq!(g.graph.problem(), None, "{prompt}");
    let chosen = road::choose(&d, &g.graph, seed);
    let p = place_with(&g.graph, &chosen.layout, seed, &g.sizes_m, &[]);
    let boxes: BTreeMap<_, _> = p.boxes.iter().map(|b| (b.id, *b)).collect();
    for b in boxes.values() {
        assert_eq!(b.problem(), None, "{prompt}");
        for o in boxes.values().filter(|o| o.id > b.id) {
            assert!(overlap_m(b, o, 0.0) <= 0.0, "{prompt}: {b:?} {o:?}");
        }
    }
    Made {
        layout: chosen.layout,
        boxes,
        left_out: p.left_out.len(),
        wanted: g.graph.objects().count(),
    }
}

#[test]
fn extremes_are_answered() {
    // Empty, emoji, other languages: nothing, said so.
    for prompt in [
        "",
        "   ",
        "\u{0}\u{7f}",
        "😀😀",
        "夜晚的十字路口",
        "مرحبا",
        "zxcvb qwerty",
    ] {
        let r = read(prompt);
        assert!(r.description.is_empty(), "{prompt:?}: {:?}", r.description);
        make(prompt, 1);
    }
    // Long ones end.
    for part in [
        "a car behind ",
        "no ",
        "between and ",
        "car ",
        "1 ",
        "the left of ",
        "🚗",
        "one of them ",
        "with it ",
        "xkcd ",
        ", ",
    ] {
        let prompt = part.repeat(10_000 / part.len() + 1);
        let r = read(&prompt);
        assert!(
            r.description.foreground.len() <= super::parse::MOST_MENTIONS,
            "{part}"
        );
    }
    let beyond = "a car ".repeat(5_000);
    assert!(read(&beyond).not_understood.iter().any(|u| u.why.is_some()));
    // Contradictions are named.
    let r = read("no cars and three cars");
    assert!(
        r.notes.iter().any(|n| n.contains("contradiction")),
        "{:?}",
        r.notes
    );
    // Numbers beyond reason.
    for prompt in [
        "99999999999999999999 cars",
        "a car -5 m ahead",
        "a car 1e9 m ahead",
        "0 cars",
        "a bus 0 m ahead",
        "a million cars",
    ] {
        make(prompt, 2);
    }
}

#[test]
fn the_impossible_is_counted() {
    let m = make("40 buses in my lane", 1);
    assert_eq!(m.wanted, 40);
    assert!(m.boxes.len() >= 4, "{} buses", m.boxes.len());
    assert_eq!(m.boxes.len() + m.left_out, 40);
}

#[test]
fn the_same_seed_gives_the_same_scene_and_another_one_another() {
    let prompt = "busy street, two parked vans, a bus ahead, four people crossing";
    let (a, b, c) = (make(prompt, 7), make(prompt, 7), make(prompt, 8));
    assert_eq!(a.boxes, b.boxes);
    assert_eq!(a.layout, b.layout);
    assert_ne!(a.boxes, c.boxes);
}

fn edit(base: &Made, text: &str) -> super::edit::EditReading {
    let scene = OpenScene {
        boxes: &base.boxes,
        layout: &base.layout,
        prompt: "day",
    };
    read_edit(text, &scene, 1)
}

#[test]
fn edits_hit_what_they_name() {
    let base = make(
        "a bus 15 m ahead, three parked cars, two pedestrians on the sidewalk",
        1,
    );
    let of = |class: Class| -> Vec<BoxId> {
        base.boxes
            .values()
            .filter(|b| b.class == class)
            .map(|b| b.id)
            .collect()
    };
    let bus = of(Class::Bus)[0];
    assert_eq!(
        edit(&base, "remove the bus").edits,
        [TextEdit::Remove { id: bus }]
    );
    assert_eq!(edit(&base, "delete all parked cars").edits.len(), 3);
    assert_eq!(edit(&base, "only one car").edits.len(), 2);
    assert_eq!(edit(&base, "no pedestrians").edits.len(), 2);
    assert_eq!(edit(&base, "add two cones in front of the bus").edits.len(), 2);
    let asked = edit(&base, "remove the parked car");
    assert!(asked.edits.is_empty());
    assert_eq!(asked.questions.len(), 1);
    assert_eq!(asked.questions[0].text, "3 parked cars: which?");
    assert_eq!(asked.questions[0].candidates.len(), 3);
    let old = base.boxes[&bus];
    match edit(&base, "move the bus 3 m left").edits.as_slice() {
        [TextEdit::Move { id, center_m, .. }] => {
            assert_eq!(*id, bus);
            assert!((center_m.y - old.center_m.y - 3.0).abs() < 1e-9);
        }
        other => panic!("{other:?}"),
    }
    match edit(&base, "turn the bus around").edits.as_slice() {
        [TextEdit::Move { yaw_rad, .. }] => assert!((yaw_rad - old.yaw_rad).cos() < -0.999),
        other => panic!("{other:?}"),
    }
    match edit(&base, "replace the bus with a lorry").edits.as_slice() {
        [TextEdit::Replace { object, .. }] => assert_eq!(object.class, Class::Truck),
        other => panic!("{other:?}"),
    }
    let style = edit(&base, "make it night, heavy rain");
    assert_eq!(
        style.edits,
        [TextEdit::Style {
            prompt: "night, rain".into()
        }]
    );
    match edit(&base, "paint the bus red").edits.as_slice() {
        [TextEdit::Label { id, label }] => assert_eq!((*id, label.paint), (bus, Some(Paint::Red))),
        other => panic!("{other:?}"),
    }
    let unknown = edit(&base, "paint the bus two tone");
    assert!(
        unknown.edits.is_empty() && unknown.notes[0].contains("no paint"),
        "{:?}",
        unknown.notes
    );
    let nothing = edit(&base, "remove the trailer");
    assert!(
        nothing.edits.is_empty() && nothing.notes[0].contains("no trailer"),
        "{:?}",
        nothing.notes
    );
    for text in [
        "",
        "move",
        "turn the",
        "replace the bus with",
        "remove remove remove",
        "🚗",
        "add",
        "move the bus 1e300 m left",
        "夜",
    ] {
        edit(&base, text);
    }
}

#[test]
fn a_chip_that_is_removed_takes_its_relations_along() {
    let mut d = read("a bus ahead, a car behind the bus, a truck behind the car").description;
    assert_eq!(d.foreground.len(), 3);
    d.remove_object(0);
    assert_eq!(d.foreground.len(), 2);
    assert!(d.foreground[0].relations.is_empty());
    assert_eq!(d.foreground[1].relations[0].anchor, Anchor::Object(0));
    d.remove_object(9);
}
