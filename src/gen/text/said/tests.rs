//! Sentences and the edits that they must give.

use std::collections::BTreeMap;

use super::super::edit::{EditReading, OpenScene, TextEdit, read_edit};
use super::super::place::place_with;
use super::super::to_graph::to_graph;
use super::super::{read, road};
use crate::scene::{BoxId, Class, SceneBox};

const STREET: &str = "a bus 20 m ahead of me in my lane, two parked cars on the right roadside, a pedestrian on the left sidewalk, \
                      two workers on the right sidewalk, four barriers on the left roadside";

/// What an edit does to the scene of `STREET`: what goes, what comes, how many are moved.
fn changes(text: &str) -> (Vec<Class>, Vec<Class>, usize, EditReading) {
    let d = read(STREET).description;
    let graph = to_graph(&d, 1);
    let chosen = road::choose(&d, &graph.graph, 1);
    let placed = place_with(&graph.graph, &chosen.layout, 1, &graph.sizes_m, &[]);
    let boxes: BTreeMap<BoxId, SceneBox> = placed.boxes.iter().map(|b| (b.id, *b)).collect();
    let scene = OpenScene {
        boxes: &boxes,
        layout: &chosen.layout,
        prompt: "rain",
    };
    let reading = read_edit(text, &scene, 1);
    let (mut after, mut moved) = (boxes.clone(), Vec::new());
    for e in &reading.edits {
        match e {
            TextEdit::Remove { id } => drop(after.remove(id)),
            TextEdit::Add { object } => drop(after.insert(object.id, *object)),
            TextEdit::Replace { id, object } => {
                if after.get(id).is_some_and(|b| b.class == object.class) {
                    moved.push(*id);
                }
                after.insert(*id, *object);
            }
            TextEdit::Move { id, .. } => moved.push(*id),
            TextEdit::Style { .. }
            | TextEdit::Label { .. }
            | TextEdit::Crossing { .. }
            | TextEdit::EraseCrossing { .. } => {}
        }
    }
    moved.sort_unstable();
    moved.dedup();
    let mut left: Vec<Class> = after.values().map(|b| b.class).collect();
    let mut gone = Vec::new();
    for b in boxes.values() {
        match left.iter().position(|c| *c == b.class) {
            Some(i) => drop(left.swap_remove(i)),
            None => gone.push(b.class),
        }
    }
    (gone, left, moved.len(), reading)
}

#[test]
fn sentences_give_their_edits() {
    use Class::{Barrier, Bicycle, Bus, Car, Pedestrian, TrafficCone, Truck};
    let people = vec![Pedestrian; 3];
    for (text, gone, new, moved) in [
        ("the bus has driven off", vec![Bus], vec![], 0),
        ("both parked cars should go", vec![Car, Car], vec![], 0),
        ("The bus ought to be a truck.", vec![Bus], vec![Truck], 0),
        ("everyone who is on foot must vanish", people.clone(), vec![], 0),
        ("All those on foot leave.", people, vec![], 0),
        ("a cyclist rides behind me", vec![], vec![Bicycle], 0),
        (
            "cones not barriers - replace all four, same spot",
            vec![Barrier; 4],
            vec![TrafficCone; 4],
            0,
        ),
        (
            "I meant cones, not barriers.",
            vec![Barrier; 4],
            vec![TrafficCone; 4],
            0,
        ),
        ("The bus stays where it is.", vec![], vec![], 0),
        ("The bus should be behind me, not in front.", vec![], vec![], 1),
        (
            "Take the bus out of my lane and put it behind me.",
            vec![],
            vec![],
            1,
        ),
        (
            "One worker crosses over and now stands on the left sidewalk, his mate stays put.",
            vec![],
            vec![],
            1,
        ),
    ] {
        let (g, n, m, reading) = changes(text);
        assert_eq!((g, n, m), (gone, new, moved), "{text}: {reading:?}");
        assert!(reading.questions.is_empty(), "{text}: {reading:?}");
    }
}

#[test]
fn what_is_open_is_asked_and_nothing_else_breaks() {
    assert_eq!(
        changes("Change the car into a bus.").3.questions[0]
            .candidates
            .len(),
        2
    );
    for text in [
        "Those should be cones, not barriers.",
        "It should be.",
        "not",
        ", not left",
        "his mate",
        "one behind another",
    ] {
        let _ = changes(text);
    }
    for text in ["It has stopped raining.", "The rain is over.", "No more rain."] {
        let edits = changes(text).3.edits;
        assert!(
            matches!(edits.as_slice(), [TextEdit::Style { prompt }] if prompt.contains("clear")),
            "{text}: {edits:?}"
        );
    }
}

#[test]
fn what_shall_be_left_is_kept_and_nothing_else() {
    for text in [
        "Let nothing remain but the bus.",
        "Leave nothing but the bus.",
        "Nothing should be left except for the bus.",
        "The bus alone stays.",
    ] {
        let (gone, came, moved, _) = changes(text);
        assert_eq!((gone.len(), came.len(), moved), (9, 0, 0), "{text}: {gone:?}");
        assert!(!gone.contains(&Class::Bus), "{text}");
    }
    for text in [
        "Not a single barrier should be left.",
        "I do not want to see any barriers.",
        "No barrier should remain.",
    ] {
        let (gone, came, moved, _) = changes(text);
        assert_eq!(
            (gone, came.len(), moved),
            (vec![Class::Barrier; 4], 0, 0),
            "{text}"
        );
    }
}
