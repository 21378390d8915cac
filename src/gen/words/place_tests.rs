//! Descriptions to boxes: nothing overlaps, objects that do not fit are counted, the same seed gives the same result.

use std::collections::BTreeMap;

use crate::describe::described;
use place::holds::overlap_m;
use place::road;
use place::rules::place_with;
use place::to_graph::to_graph;
use scene::{BevLayout, BoxId, SceneBox};

struct Made {
    layout: BevLayout,
    boxes: BTreeMap<BoxId, SceneBox>,
    left_out: usize,
    wanted: usize,
}

fn make(line: &str, seed: u64) -> Made {
    let d = described(line).expect("a reading");
    let g = to_graph(&d, seed);
    assert_eq!(g.graph.problem(), None, "{line}");
    let chosen = road::choose(&d, &g.graph, seed);
    let p = place_with(&g.graph, &chosen.layout, seed, &g.sizes_m, &[]);
    let boxes: BTreeMap<_, _> = p.boxes.iter().map(|b| (b.id, *b)).collect();
    for b in boxes.values() {
        assert_eq!(b.problem(), None, "{line}");
        for o in boxes.values().filter(|o| o.id > b.id) {
            assert!(overlap_m(b, o, 0.0) <= 0.0, "{line}: {b:?} {o:?}");
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
fn the_impossible_is_counted() {
    let m = make("add 40 bus ( on ego_lane )", 1);
    assert_eq!(m.wanted, 40);
    assert!(m.boxes.len() >= 4, "{} buses", m.boxes.len());
    assert_eq!(m.boxes.len() + m.left_out, 40);
    for line in [
        "add 4000000000 car",
        "add 1 car ( ahead ego 1000000000m )",
        "add 0 car",
        "add 1 bus ( ahead ego 0m )",
        "add 1 car ( behind 1 car ( behind 1 car ( behind 1 car ) ) )",
        "add 3 person ( between the bus and the bus )",
        "no car ; add 3 car",
    ] {
        make(line, 2);
    }
}

#[test]
fn the_same_seed_gives_the_same_scene_and_another_one_another() {
    let line = "density busy ; add 2 parked van and 1 bus ( ahead ego ) and 4 person ( crossing road )";
    let (a, b, c) = (make(line, 7), make(line, 7), make(line, 8));
    assert_eq!(a.boxes, b.boxes);
    assert_eq!(a.layout, b.layout);
    assert_ne!(a.boxes, c.boxes);
}
