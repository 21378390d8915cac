//! Sentences that are taken, with their clauses, and sentences that must be left alone.

use std::collections::BTreeMap;

use glam::DVec2;

use super::edits::{OpenBackground, ThingOutcome, carry_out};
use super::*;
use scene::background::{Building, LineKind, PostKind, SceneryLine, Tree, TreeKind};
use scene::{Background, BevLayer, BevLayout, Edit, Form, Polyline, PolylineKind, ThingId, Window};
use world::scenery::RoadsideKind;

fn one(text: &str, edits: bool) -> SceneryClause {
    let taken = take(text, edits);
    assert_eq!(taken.said.len(), 1, "{text}: {:?}", taken.said);
    assert!(
        !taken.rest.chars().any(char::is_alphanumeric),
        "{text}: rest {:?}",
        taken.rest
    );
    taken.said.into_iter().next().expect("one")
}

#[test]
fn commands_are_taken() {
    use SideOf::{Left, Right};
    let hedge = SceneryKind::Line(LineKind::Hedge);
    let tree = SceneryKind::Tree(None);
    let house = SceneryKind::Building(None);
    for (text, verb, what, side) in [
        ("remove the trees on the left", Verb::Remove, tree, Some(Left)),
        (
            "raise the building on the right by two storeys",
            Verb::Raise,
            house,
            Some(Right),
        ),
        ("add a hedge along the right side", Verb::Add, hedge, Some(Right)),
        ("delete the tree row", Verb::Remove, tree, None),
        ("a taller building on the left", Verb::Raise, house, Some(Left)),
        ("no buildings on the right", Verb::Remove, house, Some(Right)),
        ("plant a tree 12 m ahead on the left", Verb::Add, tree, Some(Left)),
        ("Cut down all trees near the crossing.", Verb::Remove, tree, None),
        (
            "make the building on the left three storeys taller",
            Verb::Raise,
            house,
            Some(Left),
        ),
        ("make the building 12 m tall", Verb::Raise, house, None),
        (
            "lower the hedge on the left by 0.5 m",
            Verb::Lower,
            hedge,
            Some(Left),
        ),
        ("remove the nearest tree", Verb::Remove, tree, None),
        (
            "get rid of the wall on the right side of the road",
            Verb::Remove,
            SceneryKind::Line(LineKind::Wall),
            Some(Right),
        ),
        ("move the tree #7 3 m to the left", Verb::Move, tree, None),
        ("fell three trees on the right", Verb::Remove, tree, Some(Right)),
        (
            "build a warehouse 20 m ahead on the right",
            Verb::Add,
            SceneryKind::Building(Some(RoadsideKind::Industry)),
            Some(Right),
        ),
        (
            "add a bench on the left",
            Verb::Add,
            SceneryKind::Post(PostKind::Bench),
            Some(Left),
        ),
        (
            "remove the street lights",
            Verb::Remove,
            SceneryKind::Post(PostKind::StreetLight),
            None,
        ),
        (
            "plant a row of poplars along the left side",
            Verb::Add,
            SceneryKind::Tree(Some(TreeKind::Columnar)),
            Some(Left),
        ),
        (
            "remove all vegetation on the right",
            Verb::Remove,
            SceneryKind::Plants,
            Some(Right),
        ),
        (
            "add a 5-storey building on the left",
            Verb::Add,
            house,
            Some(Left),
        ),
    ] {
        let s = one(text, true);
        assert_eq!(
            (s.verb, s.what, s.place.side),
            (verb, what, side),
            "{text}: {s:?}"
        );
    }
    let s = one("raise the building on the right by two storeys", true);
    assert_eq!(
        (s.by, s.definite, s.plural),
        (Some(Amount::Storeys(2.0)), true, false)
    );
    let s = one("plant a tree 12 m ahead on the left", true);
    assert_eq!((s.place.distance_m, s.place.ahead), (Some(12.0), Some(true)));
    assert_eq!(
        one("cut down all trees near the crossing", true).place.near,
        Some(NearTo::Crossing)
    );
    let s = one("move the tree #7 3 m to the left", true);
    assert_eq!(
        (s.id, s.by, s.way),
        (Some(7), Some(Amount::Metres(3.0)), Some((0.0, 1.0)))
    );
    assert!(one("delete the tree row", true).row);
    let taken = take("remove the trees on the left and the hedge on the right", true);
    assert!(
        taken.said.len() == 2 && taken.said.iter().all(|s| s.verb == Verb::Remove),
        "{:?}",
        taken.said
    );
}

#[test]
fn descriptions_are_taken() {
    let text =
        "tall apartment buildings on the left, a dense forest on the right, no trees near the crossing";
    let said = take(text, false).said;
    let [a, b, c] = &said[..] else { panic!("{said:?}") };
    assert_eq!(
        (a.what, a.tall, a.place.side),
        (
            SceneryKind::Building(Some(RoadsideKind::City)),
            Some(true),
            Some(SideOf::Left)
        )
    );
    assert_eq!(
        (b.what, b.dense, b.place.side),
        (
            SceneryKind::Place(RoadsideKind::Forest),
            Some(true),
            Some(SideOf::Right)
        )
    );
    assert_eq!(
        (c.verb, c.what, c.place.near),
        (Verb::Remove, SceneryKind::Tree(None), Some(NearTo::Crossing))
    );
    for (text, what) in [
        (
            "warehouses on both sides",
            SceneryKind::Building(Some(RoadsideKind::Industry)),
        ),
        ("a park on the left", SceneryKind::Place(RoadsideKind::Park)),
        ("fields on the right", SceneryKind::Place(RoadsideKind::Country)),
        ("without trees", SceneryKind::Tree(None)),
        (
            "a hedge along the road on the left",
            SceneryKind::Line(LineKind::Hedge),
        ),
        ("a row of trees on both sides", SceneryKind::Tree(None)),
        ("fences along both sides", SceneryKind::Line(LineKind::Fence)),
    ] {
        assert_eq!(one(text, false).what, what, "{text}");
    }
    let taken = take("two cars ahead, trees on the left and a bus behind me", false);
    assert_eq!(taken.said.len(), 1);
    assert_eq!(
        taken.rest.len(),
        "two cars ahead, trees on the left and a bus behind me".len()
    );
    assert!(
        taken.rest.contains("two cars ahead")
            && taken.rest.contains("a bus behind me")
            && !taken.rest.contains("trees")
    );
}

/// A clause about something else, or not understood completely, is left to the other reader unchanged.
#[test]
fn other_sentences_are_left_alone() {
    for text in [
        "remove the truck behind the tree",
        "a car parks in front of the building",
        "two parked cars and a bus ahead, at night",
        "remove the car on the left",
        "a pedestrian near the trees",
        "a cyclist between a tree and a house",
        "move the bus 3 m to the left",
        "a car behind a truck and a tree",
        "make it night",
        "a busy intersection downtown",
        "a forest road at dusk",
        "add a car next to the hedge",
        "place a cone near the wall",
        "the building",
        "a barrier on the left",
        "a fence across the road",
        "delete the bollards",
        "a parking lot with many cars",
        "remove everything",
        "purple buildings on the left",
        "it is raining in the park",
        "add a crossing",
        "no cars near the junction",
        "a delivery van stops at the shop",
        "turn the car at the house around",
        "clear the car park",
        "bus stops 15 m ahead",
        "park it on the right",
    ] {
        for edits in [false, true] {
            let taken = take(text, edits);
            assert!(taken.said.is_empty(), "{text}: {:?}", taken.said);
            assert_eq!(taken.rest, text);
        }
    }
    for odd in [
        "",
        "🌲🌲",
        "trees 99999999999999999999 m ahead on the left",
        "#",
        "a # tree",
        "no no trees",
        "ä tree\u{0}",
    ] {
        take(odd, true);
        take(odd, false);
    }
}

/// A straight road with a sidewalk, trees and a house on either side, and a crossing 10 m ahead.
fn scene() -> (Background, BevLayout) {
    let mut layout = BevLayout::default();
    for c in 0..Window::COLUMNS {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let p = Window::center(x, y, 0);
        layout.set(BevLayer::DrivableArea, x, y, (-2.0..6.0).contains(&p.y));
    }
    let line = |kind, points: &[(f64, f64)]| Polyline {
        kind,
        points_m: points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect(),
    };
    let lane = line(PolylineKind::LaneCenter, &[(-40.0, 0.0), (40.0, 0.0)]);
    let crossing = line(
        PolylineKind::PedCrossing,
        &[(9.0, -2.0), (12.0, -2.0), (12.0, 6.0), (9.0, 6.0)],
    );
    std::sync::Arc::make_mut(&mut layout.polylines).extend([lane, crossing]);
    let mut things = Background::default();
    let tree = |x: f64, y: f64| {
        Form::Tree(Tree {
            position_m: DVec2::new(x, y),
            height_m: 6.0,
            crown_radius_m: 1.5,
            kind: TreeKind::Broadleaf,
        })
    };
    for x in [-12.0, -4.0, 4.0, 12.0] {
        things.add(tree(x, 7.4)); // 1 to 4: a row on the left
    }
    things.add(tree(14.0, -9.0)); // 5
    things.add(tree(-25.0, -16.0)); // 6
    let house = |x: f64, y: f64| {
        Form::Building(Building::rectangle(
            DVec2::new(x, y),
            DVec2::new(6.0, 4.0),
            DVec2::X,
            6.0,
        ))
    };
    things.add(house(-10.0, 16.0)); // 7
    things.add(house(-10.0, -12.0)); // 8
    things.add(house(20.0, -16.0)); // 9
    let points_m = vec![DVec2::new(-30.0, 9.5), DVec2::new(-18.0, 9.5)];
    things.add(Form::Line(SceneryLine::typical(LineKind::Hedge, points_m))); // 10
    (things, layout)
}

fn edit(text: &str) -> ThingOutcome {
    let SceneryClauses { said, rest, .. } = take(text, true);
    assert!(!rest.contains(char::is_alphanumeric), "{rest:?} was left over");
    carried_out(&said)
}

fn carried_out(said: &[SceneryClause]) -> ThingOutcome {
    let (things, layout) = scene();
    let boxes = BTreeMap::new();
    let open = OpenBackground {
        things: &things,
        layout: &layout,
        boxes: &boxes,
    };
    carry_out(said, &open, 3)
}

fn removed(text: &str) -> Vec<u32> {
    let reading = edit(text);
    let ids = reading.edits.iter().flat_map(|e| match e {
        Edit::RemoveThings { ids } => ids.iter().map(|id| id.0).collect(),
        _ => Vec::new(),
    });
    let mut ids: Vec<u32> = ids.collect();
    ids.sort_unstable();
    ids
}

#[test]
fn targets_are_what_the_words_name() {
    assert_eq!(removed("remove the trees on the left"), [1, 2, 3, 4]);
    assert_eq!(removed("delete the tree row"), [1, 2, 3, 4]);
    assert_eq!(removed("no buildings on the right"), [8, 9]);
    assert_eq!(removed("cut down all trees near the crossing"), [3, 4, 5]);
    assert_eq!(removed("remove the nearest tree on the right"), [5]);
    assert_eq!(removed("remove the tree #6"), [6]);
    assert_eq!(removed("remove the hedge"), [10]);
    assert_eq!(removed("remove the trees behind us on the right"), [6]);
    assert_eq!(removed("remove the hedge and the building on the left"), [7, 10]);
    let raised = |text: &str| edit(text).edits;
    let house = vec![ThingId(7)];
    let by = |by_m| {
        vec![Edit::RaiseThings {
            ids: house.clone(),
            by_m,
        }]
    };
    assert_eq!(raised("raise the building on the left by two storeys"), by(6.0));
    assert_eq!(raised("a taller building on the left"), by(6.0));
    assert_eq!(raised("make the building on the left 15 m tall"), by(9.0));
    assert_eq!(raised("lower the building on the left by one storey"), by(-3.0));
}

/// If several fit, a question offers words that name each of them alone. If none fits, or the change is not possible,
/// the outcome says so.
#[test]
fn what_is_unclear_is_asked_and_what_cannot_be_is_said() {
    for (text, which, id, by_m) in [
        ("raise the building on the right by two storeys", 0, 8, 6.0),
        ("make the building on the right three storeys taller", 1, 9, 9.0),
    ] {
        let outcome = edit(text);
        assert!(outcome.edits.is_empty());
        let [question] = &outcome.questions[..] else {
            panic!("{outcome:?}")
        };
        assert_eq!(question.text, "the building on the right: 2 fit, which one?");
        assert_eq!(question.candidates.len(), 2);
        let candidate = &question.candidates[which];
        assert_eq!(candidate.answer(), format!("the building #{id}"));
        let ids = vec![ThingId(id)];
        let edits = carried_out(std::slice::from_ref(&candidate.said)).edits;
        assert_eq!(edits, [Edit::RaiseThings { ids, by_m }]);
    }
    for text in [
        "remove the wall",
        "remove the trees near the junction",
        "lower the building on the left by five storeys",
        "remove the tree #99",
        "add a suburb on the left",
    ] {
        let reading = edit(text);
        assert!(
            reading.edits.is_empty() && reading.questions.is_empty(),
            "{text}: {reading:?}"
        );
        assert!(reading.cannot.len() == 1, "{text}");
    }
}

/// New things stand on the stated side and at the stated distance, off the road.
#[test]
fn new_things_stand_where_they_were_wanted() {
    {
        let forms = |text: &str| -> Vec<Form> {
            let all = edit(text).edits.into_iter().flat_map(|e| match e {
                Edit::AddThings { forms } => forms,
                _ => Vec::new(),
            });
            all.collect()
        };
        let found = forms("plant a tree 20 m ahead on the left");
        let [Form::Tree(t)] = &found[..] else {
            panic!("{found:?}")
        };
        assert!(
            (t.position_m.x - 20.0).abs() < 1.0 && (6.0..10.0).contains(&t.position_m.y),
            "{t:?}"
        );
        let hedge = forms("add a hedge along the right side");
        let length: f64 = hedge
            .iter()
            .flat_map(|f| {
                f.points_m()
                    .windows(2)
                    .map(|w| w[0].distance(w[1]))
                    .collect::<Vec<_>>()
            })
            .sum();
        assert!(length > 50.0, "{length}");
        assert!(
            hedge
                .iter()
                .flat_map(Form::points_m)
                .all(|p| (-5.0..-2.3).contains(&p.y))
        );
        let found = forms("build a 5-storey building on the left");
        let [Form::Building(b)] = &found[..] else {
            panic!("{found:?}")
        };
        assert!(
            b.height_m == 15.0 && b.outline_m.iter().all(|p| p.y > 6.0),
            "{b:?}"
        );
        assert_eq!(forms("add three trees on the right").len(), 3);
        assert!(forms("add a dense forest on the right").len() > 25);
    }
}

/// None of the sentences that the other reader is judged by is about the background, though many speak of trees,
/// houses, parks and walls.
#[test]
fn the_sentences_of_the_other_reader_are_left_alone() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/words/dev");
    let (mut all, mut taken) = (0, Vec::new());
    for entry in std::fs::read_dir(folder).expect("the folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "jsonl") {
            continue;
        }
        for line in std::fs::read_to_string(&path).expect("text").lines() {
            let Ok(case) = serde_json::from_str::<serde_json::Value>(line) else {
                continue;
            };
            let Some(text) = case["text"].as_str() else {
                continue;
            };
            all += 1;
            taken.extend(
                take(text, !case["base"].is_null())
                    .said
                    .iter()
                    .map(|s| format!("{:?} of {text}", s.span.expect("it is known").of(text))),
            );
        }
    }
    assert!(all > 10_000, "{all}");
    assert!(taken.is_empty(), "{taken:#?}");
}

/// The sides of a description look as described, without excluded things.
#[test]
fn descriptions_become_scenery() {
    use super::wishes::scenery;
    use ::place::description::Description;
    use world::template;
    let said = |list: &[&str]| Description {
        background: list.iter().flat_map(|s| take(s, false).said).collect(),
        ..Description::default()
    };
    let none = BTreeMap::new();
    let (mut houses, mut worlds) = (0, 0);
    for seed in 0..12 {
        let layout = template::layout("intersection", seed).expect("a template");
        let roads = scene::road_map::RoadMap::new(&layout);
        if roads.crossings.is_empty() {
            continue;
        }
        worlds += 1;
        let wish = said(&[
            "tall apartment buildings on the left",
            "a dense forest on the right",
            "no trees near the crossing",
        ]);
        let (things, short) = scenery(&wish, &layout, &none, seed);
        assert_eq!(things.problem(), None);
        assert!(short.is_empty(), "{short:?}");
        let on_left = |form: &Form| roads.along_ego_lane(form.middle_m()).y > 0.0;
        let (mut trees_right, mut near) = (0, 0);
        for thing in things.iter() {
            match &thing.form {
                Form::Building(b) if on_left(&thing.form) => {
                    houses += 1;
                    assert!(b.storeys() >= 8, "{}", b.storeys());
                }
                Form::Building(_) => panic!("a building in the forest"),
                Form::Tree(t) => {
                    trees_right += usize::from(!on_left(&thing.form));
                    let close = |c: &scene::road_map::CrossingArea| {
                        scene::road_map::outline_distance_m(&c.outline_m, t.position_m) < 12.0
                    };
                    near += usize::from(roads.crossings.iter().any(close));
                }
                _ => {}
            }
        }
        assert!(trees_right > 25, "{trees_right}");
        assert_eq!(near, 0);
        // The same words, the same scenery; and without them another.
        assert_eq!(scenery(&wish, &layout, &none, seed).0, things);
        let plain = scenery(&said(&[]), &layout, &none, seed).0;
        assert_eq!(plain, world::scenery::background(&layout, &none, seed));
        let (hedged, short) = scenery(&said(&["a hedge along the right side"]), &layout, &none, seed);
        let is_hedge = |f: &Form| matches!(f, Form::Line(l) if l.kind == LineKind::Hedge);
        assert!(
            short.is_empty() && hedged.iter().any(|t| is_hedge(&t.form) && !on_left(&t.form)),
            "{short:?}"
        );
    }
    assert!(worlds > 2 && houses > worlds, "{worlds} {houses}");
    // Wishes that cannot be met are reported.
    let empty = BevLayout::default();
    for words in ["no trees near the crossing", "a tree 300 m ahead on the left"] {
        let (_, short) = scenery(&said(&[words]), &empty, &none, 1);
        assert!(short.len() == 1 && short[0].contains(words), "{short:?}");
    }
}

/// Clauses can be read again: as words, and as the JSON of their schema.
#[test]
fn clauses_are_values_with_words() {
    for (text, edits, words) in [
        (
            "plant a tree 12 m ahead on the left",
            true,
            "adds a tree 12 m ahead on the left",
        ),
        (
            "cut down all trees near the crossing",
            true,
            "removes trees near the crossing",
        ),
        ("delete the tree row", true, "removes the row of trees"),
        (
            "make the building #7 12 m tall",
            true,
            "makes the building #7 12 m high",
        ),
        (
            "raise the houses on the right by two storeys",
            true,
            "makes the houses on the right taller by 2 storeys",
        ),
        (
            "move the tree #7 3 m to the left",
            true,
            "moves the tree #7 by 3 m to the left",
        ),
        (
            "fell three trees on the right",
            true,
            "removes 3 trees on the right",
        ),
        (
            "benches along the left side",
            false,
            "benches along the road on the left",
        ),
        ("a dense forest on the right", false, "dense forest on the right"),
        ("no trees near the crossing", false, "no trees near the crossing"),
        (
            "a 5-storey building on the left",
            false,
            "a building on the left, 5 storeys high",
        ),
    ] {
        let [said] = &take(text, edits).said[..] else {
            panic!("{text}")
        };
        assert_eq!(
            if edits { said.to_string() } else { said.described() },
            words,
            "{text}: {said:?}"
        );
        assert_eq!(said.problem(), None, "{text}");
        let json = serde_json::to_string(said).expect("JSON");
        assert_eq!(
            &serde_json::from_str::<SceneryClause>(&json).expect("the same"),
            said,
            "{json}"
        );
    }
}
