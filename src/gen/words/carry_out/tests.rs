//! Readings on a scene: boxes that are meant, questions, and boxes that stay.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::super::describe::described;
use super::super::notation::parse;
use super::super::remark::Remark;
use super::super::stage::{OpenScene, ReadingOutcome};
use super::carry_out;
use place::road;
use place::rules::place_with;
use place::to_graph::to_graph;
use scene::clip::Template;
use scene::{BevLayout, BoxId, Class, Conditions, Edit, Paint, SceneBox, TimeOfDay, Weather};

struct Base {
    layout: BevLayout,
    boxes: BTreeMap<BoxId, SceneBox>,
}

impl Base {
    fn new(line: &str) -> Self {
        let d = described(line).expect("a reading");
        let g = to_graph(&d, 1);
        let chosen = road::choose(&d, &g.graph, 1);
        let p = place_with(&g.graph, &chosen.layout, 1, &g.sizes_m, &[]);
        Self {
            layout: chosen.layout,
            boxes: p.boxes.iter().map(|b| (b.id, *b)).collect(),
        }
    }

    fn edit(&self, line: &str) -> ReadingOutcome {
        let scene = OpenScene {
            boxes: &self.boxes,
            layout: &self.layout,
            prompt: "day",
            conditions: Default::default(),
            clip: None,
            ego_moves: false,
            length_s: 0.0,
        };
        carry_out(&parse(line).unwrap_or_else(|e| panic!("{line}: {e}")), &scene, 1)
    }

    fn of(&self, class: Class) -> Vec<BoxId> {
        self.boxes
            .values()
            .filter(|b| b.class == class)
            .map(|b| b.id)
            .collect()
    }
}

/// "Four cars on the right, the first one black, the others white": the others of these four.
#[test]
fn the_others_are_those_of_the_group() {
    let base = Base::new("add 3 parked car ( on left_roadside )");
    let outcome = base
        .edit("add 4 parked car ( on right_roadside ) ; set the nth 1 one black ; set all other one white");
    let mut paints: Vec<(BoxId, Option<Paint>)> = Vec::new();
    for e in &outcome.edits {
        if let Edit::LabelBox { id, label } = e {
            paints.push((*id, label.paint));
        }
    }
    let black = paints.iter().filter(|p| p.1 == Some(Paint::Black)).count();
    let white = paints.iter().filter(|p| p.1 == Some(Paint::White)).count();
    assert_eq!((black, white), (1, 3), "{outcome:?}");
    assert!(
        paints.iter().all(|p| !base.boxes.contains_key(&p.0)),
        "{paints:?}"
    );
}

/// "A cone behind each parked car": one for every car, in a scene and in a description.
#[test]
fn each_has_its_own() {
    let base = Base::new("add 3 parked car ( on right_roadside ) and 1 bus ( ahead ego 20m )");
    let cars = base.of(Class::Car).len();
    let outcome = base.edit("add 2 cone ( next_to each parked car )");
    let added = outcome.edits.iter().filter(|e| matches!(e, Edit::AddBox { .. }));
    assert!(cars == 3 && added.count() == 6, "{outcome:?}");
    let d = described("add 2 bus and 1 worker ( behind each bus )").expect("a reading");
    assert_eq!(d.foreground[1].count.n, 2);
    let g = to_graph(&d, 1);
    let anchors: Vec<u32> = g.graph.edges.iter().map(|e| e.to).collect();
    assert_eq!(anchors, g.nodes[0]);
}

#[test]
fn edits_hit_what_they_name() {
    let base = Base::new("add 1 bus ( ahead ego 15m ) and 3 parked car and 2 person ( on sidewalk )");
    let bus = base.of(Class::Bus)[0];
    assert_eq!(base.edit("remove the bus").edits, [Edit::RemoveBox { id: bus }]);
    assert_eq!(base.edit("remove all parked car").edits.len(), 3);
    assert_eq!(base.edit("count car to 1").edits.len(), 2);
    assert_eq!(base.edit("no person").edits.len(), 2);
    assert_eq!(base.edit("add 2 cone ( ahead the bus )").edits.len(), 2);
    assert_eq!(base.edit("keep the bus").edits.len(), 5);
    assert_eq!(
        base.edit("remove all car ( except the nearest one )").edits.len(),
        2
    );
    assert_eq!(base.edit("count person times 2").edits.len(), 2);
    let asked = base.edit("remove the parked car");
    assert!(asked.edits.is_empty());
    assert_eq!(asked.questions[0].text, "3 parked cars: which?");
    assert_eq!(asked.questions[0].candidates.len(), 3);
    let old = base.boxes[&bus];
    match base.edit("move the bus by left 3m").edits.as_slice() {
        [
            Edit::MoveBox {
                id,
                center_m: Some(center_m),
                ..
            },
        ] => {
            assert_eq!(*id, bus);
            assert!((center_m.y - old.center_m.y - 3.0).abs() < 1e-9);
        }
        other => panic!("{other:?}"),
    }
    match base.edit("turn the bus left 90deg").edits.as_slice() {
        [
            Edit::MoveBox {
                yaw_deg: Some(deg), ..
            },
        ] => {
            assert!((deg - old.yaw_rad.to_degrees() - 90.0).abs() < 1e-9)
        }
        other => panic!("{other:?}"),
    }
    match base.edit("replace the bus with 1 truck").edits.as_slice() {
        [Edit::RemoveBox { id }, Edit::AddBox { class, id: same, .. }] => {
            assert_eq!((*same, *class), (Some(*id), Class::Truck));
        }
        other => panic!("{other:?}"),
    }
    let prompt = "night, rain".to_owned();
    let style = base.edit("time night ; weather rain").edits;
    assert_eq!(style.last(), Some(&Edit::SetPrompt { prompt }));
    let conditions = Conditions::usual(TimeOfDay::Night, Weather::Rain, 0);
    assert!(style.contains(&Edit::SetConditions { conditions }), "{style:?}");
    match base.edit("set the bus red").edits.as_slice() {
        [Edit::LabelBox { id, label }] => assert_eq!((*id, label.paint), (bus, Some(Paint::Red))),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_second_act_sees_what_the_first_left() {
    let base = Base::new("add 1 bus ( ahead ego 15m ) and 2 person ( on sidewalk )");
    let done = base.edit("remove the bus ; add 1 truck ( there )");
    let stood = base.boxes[&base.of(Class::Bus)[0]].center_m;
    match done.edits.as_slice() {
        [Edit::RemoveBox { .. }, Edit::AddBox { center_m, .. }] => {
            assert!(center_m.truncate().distance(stood.truncate()) < 3.0);
        }
        other => panic!("{other:?}"),
    }
    let done = base.edit("add 1 red car ( ahead ego 30m ) ; set it blue");
    assert!(
        matches!(done.edits.as_slice(), [Edit::AddBox { .. }, Edit::LabelBox { label, .. }] if label.paint == Some(Paint::Blue))
    );
}

#[test]
fn what_cannot_be_done_is_remarked_and_changes_nothing() {
    let base = Base::new("add 1 bus ( ahead ego 15m )");
    let missing = base.edit("remove the trailer");
    assert!(missing.edits.is_empty());
    assert_eq!(
        missing.remarks[0].1,
        Remark::Nobody {
            what: "trailer".into()
        }
    );
    let outside = base.edit("move the bus by left 1000000000m");
    assert!(outside.edits.is_empty() && matches!(outside.remarks[0].1, Remark::Outside { .. }));
    assert!(matches!(
        base.edit("road highway").remarks[0].1,
        Remark::NotInEdits { .. }
    ));
    assert!(matches!(base.edit("time day").remarks[0].1, Remark::Already));
    for line in [
        "add 4000000000 car",
        "move the bus by nearer 1000000m",
        "turn the bus left 999999999999deg",
        "count bus times 1000000",
        "swap the bus and the bus",
        "remove half bus",
        "move it to ( there )",
        "replace all it with 3 bus",
        "set the bus paint_of the bus",
        "move the bus to ( between the bus and the bus )",
        "keep all thing ( except all thing )",
    ] {
        let done = base.edit(line);
        let sound = |b: &SceneBox| b.problem().is_none();
        for e in &done.edits {
            if let Some(b) = e.added_box() {
                assert!(sound(&b), "{line}: {b:?}");
            }
        }
    }
}

#[test]
fn what_is_said_to_stay_stays() {
    let base =
        Base::new("add 1 bus ( ahead ego 15m ) and 1 car ( ahead ego 30m ) and 2 person ( on sidewalk )");
    let bus = base.of(Class::Bus)[0];
    let done = base.edit("no all thing ; leave the bus");
    assert_eq!(done.edits.len(), 3, "{done:?}");
    assert!(!done.edits.contains(&Edit::RemoveBox { id: bus }));
    assert!(done.remarks.is_empty(), "{done:?}");
    let done = base.edit("keep the car ; leave the bus");
    assert_eq!(done.edits.len(), 2, "{done:?}");
    assert!(!done.edits.contains(&Edit::RemoveBox { id: bus }));
    // (in a contradiction a remark says that it did not stay)
    let done = base.edit("remove the bus ; leave the bus");
    let spared = Remark::Spared { what: "bus".into() };
    assert!(done.remarks.iter().any(|r| r.1 == spared), "{done:?}");
}

fn moved(edits: &[Edit], who: BoxId) -> (DVec3, f64) {
    let found = edits.iter().rev().find_map(|e| match e {
        Edit::MoveBox {
            id,
            center_m: Some(center_m),
            yaw_deg: Some(deg),
            ..
        } if *id == who => Some((*center_m, deg.to_radians())),
        edit => edit
            .added_box()
            .filter(|b| b.id == who)
            .map(|b| (b.center_m, b.yaw_rad)),
    });
    found.unwrap_or_else(|| panic!("box {} is not moved: {edits:?}", who.0))
}

#[test]
fn what_is_moved_is_not_its_own_anchor() {
    let base = Base::new("add 1 taxi ( ahead ego 9m ) and 1 suv ( ahead ego 34m )");
    let cars = base.of(Class::Car);
    let suv = *cars
        .iter()
        .max_by(|a, b| base.boxes[a].center_m.x.total_cmp(&base.boxes[b].center_m.x))
        .expect("two");
    // Two cars: "the car" that the taxi goes behind is the other one, so nothing is asked.
    let done = base.edit("move the taxi to ( behind the car )");
    assert!(done.questions.is_empty(), "{done:?}");
    let taxi = *cars.iter().find(|id| **id != suv).expect("two");
    let (at, _) = moved(&done.edits, taxi);
    let gap_m = base.boxes[&suv].center_m.x - at.x;
    assert!((4.0..16.0).contains(&gap_m), "{gap_m} {done:?}");
    // (long ones keep their distance: close means the gap, not the middles)
    let base = Base::new("add 1 truck ( ahead ego 11m ) and 1 bus ( ahead ego 37m )");
    let (truck, bus) = (base.of(Class::Truck)[0], base.of(Class::Bus)[0]);
    let (at, _) = moved(&base.edit("move the truck to ( behind the bus )").edits, truck);
    let (front, back) = (&base.boxes[&bus], &base.boxes[&truck]);
    let gap_m = front.center_m.x - at.x - (front.size_m.x + back.size_m.x) / 2.0;
    assert!((0.5..9.0).contains(&gap_m), "{gap_m}");
}

#[test]
fn two_that_swap_stand_where_the_other_stood() {
    let base = Base::new("add 1 bus ( ahead ego 12m ) and 1 truck ( ahead ego 30m )");
    let (bus, truck) = (base.of(Class::Bus)[0], base.of(Class::Truck)[0]);
    let done = base.edit("swap the bus and the truck");
    for (who, other) in [(bus, truck), (truck, bus)] {
        let (at, _) = moved(&done.edits, who);
        let apart_m = at.truncate().distance(base.boxes[&other].center_m.truncate());
        assert!(apart_m < 3.0, "{apart_m} m: {done:?}");
    }
}

#[test]
fn a_group_is_placed_by_each_other() {
    let base = Base::new("add 2 person ( on right_sidewalk )");
    let people = base.of(Class::Pedestrian);
    let done = base.edit("turn all person to ( facing each_other )");
    let (at, yaw): (Vec<_>, Vec<_>) = people.iter().map(|id| moved(&done.edits, *id)).unzip();
    for (i, j) in [(0, 1), (1, 0)] {
        let way = (at[j] - at[i]).truncate().normalize();
        assert!(DVec2::from_angle(yaw[i]).dot(way) > 0.9, "{done:?}");
    }
    let base = Base::new("add 3 car ( ahead ego )");
    let done = base.edit("move all car to ( in_line )");
    assert!(
        done.remarks
            .iter()
            .all(|r| !matches!(r.1, Remark::PlaceIgnored { .. })),
        "{done:?}"
    );
    let at: Vec<DVec3> = base
        .of(Class::Car)
        .iter()
        .map(|id| {
            let now = done.edits.iter().rev().find_map(|e| match e {
                Edit::MoveBox { id: i, center_m, .. } if i == id => *center_m,
                _ => None,
            });
            now.unwrap_or(base.boxes[id].center_m)
        })
        .collect();
    let spread = |f: &dyn Fn(&DVec3) -> f64| {
        let v: Vec<f64> = at.iter().map(f).collect();
        v.iter().copied().fold(f64::MIN, f64::max) - v.iter().copied().fold(f64::MAX, f64::min)
    };
    assert!(spread(&|p| p.y) < 1.5 && spread(&|p| p.x) > 8.0, "{at:?}");
}

#[test]
fn a_crossing_lies_as_far_away_as_was_said() {
    let base = Base::new("road straight ; lacks crossing ; add 1 bus ( ahead ego 30m )");
    let done = base.edit("has crossing ( ahead ego 14m )");
    let outline = done.edits.iter().find_map(|e| match e {
        Edit::AddPolylines { lines } => Some(lines[0].points_m.clone()),
        _ => None,
    });
    let outline = outline.unwrap_or_else(|| panic!("no crossing: {done:?}"));
    let x = outline.iter().map(|p| p.x).sum::<f64>() / outline.len() as f64;
    assert!((x - 14.0).abs() < 2.0, "{x} m");
}

#[test]
fn what_is_said_of_it_waits_for_the_answer() {
    let base = Base::new("add 1 taxi ( ahead ego 9m ) and 1 suv ( ahead ego 34m )");
    let done = base.edit("move the car by back 2m ; set it red");
    assert_eq!((done.questions.len(), done.remarks.len()), (1, 0), "{done:?}");
    // (without a question, a remark says that no box was named)
    let done = base.edit("set it red");
    assert_eq!(done.remarks.len(), 1, "{done:?}");
}

/// A motion is an edit of its own. A vehicle that cuts in needs one to cut in on, and a late start needs a longer
/// scene.
#[test]
fn motions_become_edits() {
    let base = Base::new("add 1 car ( ahead ego 15m ) and 1 bus ( behind ego )");
    let car = base.of(Class::Car)[0];
    let outcome = base.edit("go the car stop from 9s speed 36kmh");
    let [Edit::SetLength { length_s, .. }, stop] = outcome.edits.as_slice() else {
        panic!("{outcome:?}");
    };
    assert!(*length_s >= 14.0);
    let wanted = Edit::LetMove {
        id: Some(car),
        template: Template::Stop,
        mps: Some(10.0),
        from_s: Some(9.0),
        gap_m: None,
    };
    assert_eq!(*stop, wanted);
    let outcome = base.edit("go the car cut_in");
    assert!(
        matches!(outcome.edits[0], Edit::LetMove { id: None, .. }),
        "{outcome:?}"
    );
    assert_eq!(outcome.remarks, [(0, Remark::EgoDrives)]);
    let outcome = base.edit("go ego drive fast ; go the bus drive gap 5m");
    assert!(
        outcome.remarks.is_empty() && outcome.edits.len() == 2,
        "{outcome:?}"
    );
    // One manoeuvre after another: the speed stays; an earlier manoeuvre is lost, with a remark.
    let outcome = base.edit("go the car drive slow ; go the car stop from 2s");
    assert!(outcome.remarks.is_empty(), "{outcome:?}");
    assert!(
        matches!(outcome.edits[1], Edit::LetMove { mps: Some(5.0), .. }),
        "{outcome:?}"
    );
    let outcome = base.edit("go the car cross from 1s ; go the car stop from 2s");
    assert!(
        matches!(outcome.remarks[0].1, Remark::OneMotion { .. }),
        "{outcome:?}"
    );
    let outcome = base.edit("go the truck stop");
    assert!(outcome.edits.is_empty() && matches!(outcome.remarks[0].1, Remark::Nobody { .. }));
}

#[test]
fn roads_of_a_scene_are_reshaped_by_words() {
    use scene::Edit;
    use scene::roads::{LaneKind, RoadChange, RoadWish};
    let base = Base::new("add 1 bus ( ahead ego 15m )");
    let wish = |line: &str| {
        let out = base.edit(line);
        let [
            Edit::ChangeRoads {
                change: RoadChange::Wish { wish, .. },
            },
        ] = out.edits.as_slice()
        else {
            panic!("{line}: {:?}", out.edits);
        };
        assert!(out.remarks.is_empty(), "{line}: {:?}", out.remarks);
        *wish
    };
    assert_eq!(wish("lanes 4"), RoadWish::Lanes { count: 4 });
    assert_eq!(wish("one_way"), RoadWish::OneWay {});
    assert_eq!(wish("road straight"), RoadWish::Straight {});
    assert_eq!(wish("road roundabout"), RoadWish::Roundabout {});
    assert_eq!(wish("road intersection"), RoadWish::Junction {});
    assert_eq!(wish("lacks sidewalk"), RoadWish::Without { kind: LaneKind::Walk });
    let kind = LaneKind::Walk;
    assert_eq!(wish("has sidewalk"), RoadWish::Beside { kind, right: None });
    assert!(matches!(wish("wide"), RoadWish::Widths { times } if times > 1.0));
}
