//! The layout network and the text encoder against the Python versions that trained the shipped weights: goldens
//! written by training/export_layout.py and training/train_text.py (PyTorch, f32) for exactly these files. Also the
//! guarantees of a placement.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::diffuse::{lay_out, place_by_diffusion};
use crate::facts::Facts;
use crate::memory::{RetrievalQuery, SceneMemory};
use nets::layout::input::{EdgeInput, LayoutInput, NodeGeometry, NodeInput, VALUES};
use nets::layout::net::LayoutNet;
use nets::text::{TOKENS, TextEncoder, cosine, token_ids};
use safetensors::{Dtype, SafeTensors};
use scene::graph::{LaneRole, Locked, NodeKind, ObjectNode, ObjectState, RelationKind, SceneGraph};
use scene::relations::{ego_box, overlap_m};
use scene::road_map::RoadMap;
use scene::{BevLayer, Class};
use world::template;

const TOLERANCE: f64 = 1e-4;

struct Golden(Vec<u8>);

impl Golden {
    fn open(name: &str) -> Self {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../../tests/reference")
            .join(name);
        Self(std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
    }

    fn words(&self, name: &str, dtype: Dtype) -> Vec<[u8; 4]> {
        let file = SafeTensors::deserialize(&self.0).expect("a safetensors file");
        let tensor = file.tensor(name).expect("a tensor of the golden");
        assert_eq!(tensor.dtype(), dtype, "{name}");
        tensor
            .data()
            .chunks_exact(4)
            .map(|b| b.try_into().expect("4 bytes"))
            .collect()
    }

    fn f32(&self, name: &str) -> Vec<f32> {
        self.words(name, Dtype::F32)
            .into_iter()
            .map(f32::from_le_bytes)
            .collect()
    }

    fn i32(&self, name: &str) -> Vec<i32> {
        self.words(name, Dtype::I32)
            .into_iter()
            .map(i32::from_le_bytes)
            .collect()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        let file = SafeTensors::deserialize(&self.0).expect("a safetensors file");
        file.tensor(name).expect("a tensor of the golden").data().to_vec()
    }
}

fn input(golden: &Golden, task: &str) -> LayoutInput {
    let name = |part: &str| format!("{task}_{part}");
    let values = golden.f32(&name("values"));
    let nodes = golden.i32(&name("nodes"));
    let nodes = nodes
        .chunks_exact(5)
        .zip(values.chunks_exact(VALUES))
        .map(|(n, v)| NodeInput {
            kind: n[0] as u8,
            state: n[1] as u8,
            size: n[2] as u8,
            shape: [NodeGeometry::None, NodeGeometry::Box, NodeGeometry::Line][n[3] as usize],
            locked: n[4] == 1,
            values: v.try_into().expect("24 values"),
        });
    let distances = golden.f32(&name("distance"));
    let edges = golden.i32(&name("edges"));
    let edges = edges.chunks_exact(3).zip(distances).map(|(e, d)| EdgeInput {
        from: e[0] as u16,
        to: e[1] as u16,
        relation: e[2] as u8,
        distance_m: (d >= 0.0).then_some(d),
    });
    let map = golden.bytes(&name("map"));
    LayoutInput {
        nodes: nodes.collect(),
        edges: edges.collect(),
        map: (!map.is_empty()).then(|| Arc::new(map)),
    }
}

#[test]
fn layout_network_equals_pytorch() {
    let golden = Golden::open("parity_layout.safetensors");
    let net = LayoutNet::bundled().expect("the shipped weights");
    for task in ["place", "road"] {
        let input = input(&golden, task);
        assert_eq!(input.map.is_some(), task == "place");
        let embedded = net.embed(&input).expect("sound");
        let x: Vec<f64> = golden
            .f32(&format!("{task}_x"))
            .into_iter()
            .map(f64::from)
            .collect();
        for t in [950, 120] {
            let found = net.predict(&embedded, &x, f64::from(t)).expect("sound");
            let truth = golden.f32(&format!("{task}_v{t}"));
            assert_eq!(found.len(), truth.len());
            let scale = truth.iter().fold(1.0f64, |m, v| m.max(f64::from(v.abs())));
            let worst = found
                .iter()
                .zip(&truth)
                .map(|(f, t)| (f - f64::from(*t)).abs())
                .fold(0.0, f64::max);
            println!("{task} t {t}: largest difference {worst:.1e}, largest value {scale:.2}");
            assert!(worst <= TOLERANCE * scale && scale > 0.2, "{task} {t}: {worst}");
        }
    }
}

#[test]
fn text_encoder_equals_pytorch() {
    let golden = Golden::open("parity_text.safetensors");
    let encoder = TextEncoder::bundled().expect("the shipped weights");
    let texts = golden.bytes("text");
    let vectors = golden.f32("vectors");
    let ids = golden.i32("ids");
    let sentences: Vec<String> = texts
        .chunks_exact(320)
        .map(|t| String::from_utf8_lossy(t).trim_end_matches('\0').to_owned())
        .collect();
    let mut seen = 0;
    for ((text, truth), ids) in sentences
        .iter()
        .zip(vectors.chunks_exact(64))
        .zip(ids.chunks_exact(TOKENS))
    {
        if text.len() >= 319 {
            continue; // cut
        }
        seen += 1;
        let known: Vec<u32> = ids.iter().filter(|i| **i >= 0).map(|i| *i as u32).collect();
        assert_eq!(token_ids(text), known, "{text}");
        let found = encoder.encode(text).expect("the processor never fails");
        let worst = found
            .iter()
            .zip(truth)
            .map(|(a, b)| f64::from((a - b).abs()))
            .fold(0.0, f64::max);
        assert!(worst <= TOLERANCE, "{text}: {worst}");
    }
    assert!(seen >= 12);
    let encode = |text: &str| encoder.encode(text).expect("the processor never fails");
    assert!(encode("").iter().all(|v| *v == 0.0));
    let near = cosine(&encode("a motorway at night"), &encode("night, freeway"));
    let far = cosine(
        &encode("a motorway at night"),
        &encode("roundabout with pedestrians by day"),
    );
    assert!(near > far, "{near} {far}");
}

fn street() -> SceneGraph {
    let mut graph = SceneGraph::with_ego();
    let lane = graph.add(NodeKind::Lane {
        role: LaneRole::Ego,
        polyline: None,
    });
    let object = |class, state| {
        let mut o = ObjectNode::new(class);
        o.state = Some(state);
        NodeKind::Object(o)
    };
    let bus = graph.add(object(Class::Bus, ObjectState::Moving));
    graph.relate(bus, RelationKind::InFrontOf, SceneGraph::EGO);
    graph.relate(bus, RelationKind::On, lane);
    for _ in 0..5 {
        let car = graph.add(object(Class::Car, ObjectState::Moving));
        graph.relate(car, RelationKind::Near, bus);
    }
    for _ in 0..3 {
        let cone = graph.add(object(Class::TrafficCone, ObjectState::Parked));
        graph.relate(cone, RelationKind::RightOf, SceneGraph::EGO);
    }
    graph
}

#[test]
fn placements_are_sound_repeatable_and_keep_what_is_locked() {
    let layout = template::layout("intersection", 3).expect("listed");
    let road = RoadMap::new(&layout);
    let mut graph = street();
    let (boxes, report) = place_by_diffusion(&graph, &layout, 5).expect("placed");
    assert_eq!(boxes.len(), 9);
    assert_eq!(place_by_diffusion(&graph, &layout, 5).expect("placed").0, boxes);
    assert_ne!(place_by_diffusion(&graph, &layout, 6).expect("placed").0, boxes);
    assert!(
        report.projection.broken.is_empty() && report.projection.dropped.is_empty(),
        "{report:?}"
    );
    for (i, a) in boxes.iter().enumerate() {
        assert_eq!(a.problem(), None);
        assert!(!a.class.is_vehicle() || road.is_for_vehicles(a.center_m.truncate()));
        assert!(overlap_m(a, &ego_box()) <= 0.0);
        assert!(boxes[i + 1..].iter().all(|b| overlap_m(a, b) <= 0.0));
    }
    // The bus stays at its place; the others are placed again around it.
    let bus = graph
        .nodes
        .iter_mut()
        .find(|n| n.id == report.nodes[0])
        .expect("a node");
    let given = boxes[0];
    bus.locked = Some(Locked::Box(given));
    let (again, _) = place_by_diffusion(&graph, &layout, 9).expect("placed");
    assert_eq!(again[0], given);
    assert_ne!(again[1..], boxes[1..]);
}

#[test]
fn graphs_that_contradict_themselves_are_refused_in_one_line() {
    let layout = template::layout("straight", 1).expect("listed");
    let mut graph = street();
    graph.edges[0].to = 77;
    let text = place_by_diffusion(&graph, &layout, 1)
        .expect_err("a missing node")
        .to_string();
    assert!(text.contains("77") && !text.contains('\n'), "{text}");
    assert!(
        place_by_diffusion(&SceneGraph::default(), &layout, 1)
            .expect("nothing")
            .0
            .is_empty()
    );
}

#[test]
fn a_road_is_made_where_none_is_given() {
    let mut graph = street();
    graph.add(NodeKind::Lane {
        role: LaneRole::Oncoming,
        polyline: None,
    });
    let (layout, boxes, report) = lay_out(&graph, 4).expect("laid out");
    assert!(
        layout.count(BevLayer::DrivableArea) > 500,
        "{}",
        layout.count(BevLayer::DrivableArea)
    );
    assert_eq!(boxes.len() + report.projection.dropped.len(), 9);
}

#[test]
fn memory_fills_in_what_is_left_open() {
    let memory = SceneMemory::bundled().expect("the shipped bank");
    assert!(memory.entries().len() >= 100);
    let nearest = memory
        .nearest("a roundabout at night in the rain", 8)
        .expect("encoded");
    assert!(nearest.windows(2).all(|w| w[0].score >= w[1].score));
    let open = RetrievalQuery {
        text: "roundabout, a bus".into(),
        night: Some(true),
        counts: BTreeMap::from([(Class::Bus, 1)]),
        ..RetrievalQuery::default()
    };
    let fill_in = |open: &RetrievalQuery, seed: u64| memory.fill_in(open, seed).expect("encoded");
    let proposal = fill_in(&open, 3).expect("entries");
    assert_eq!(fill_in(&open, 3), Some(proposal.clone()));
    assert!(proposal.night == Some(true) && !proposal.counts.contains_key(&Class::Bus));
    // Without being asked for, only objects that most of the retrieved scenes have are filled in.
    let (mut agreed, mut open_left) = (0, 0);
    for entry in memory.entries().iter().take(40) {
        let open = RetrievalQuery {
            text: entry.text.clone(),
            ..RetrievalQuery::default()
        };
        let found = fill_in(&open, 3).expect("entries");
        let says = |f: &dyn Fn(&Facts) -> bool| {
            let with = found.from.iter().filter(|r| f(&memory.entries()[r.entry].facts));
            4 * with.count() >= 3 * found.from.len()
        };
        match (found.night, found.weather) {
            (Some(night), _) if !says(&|f| f.night == night) => panic!("{}: night", entry.text),
            (_, Some(weather)) if !says(&|f| f.weather == weather) => panic!("{}: weather", entry.text),
            (Some(_), Some(_)) => agreed += 1,
            _ => open_left += 1,
        }
    }
    assert!(agreed > 0 && open_left > 0, "{agreed} {open_left}");
    for text in ["", "🚌🚌🚌", &"very long ".repeat(2000), "zwei Busse im Regen"] {
        let open = RetrievalQuery {
            text: text.into(),
            ..RetrievalQuery::default()
        };
        assert!(fill_in(&open, 1).is_some());
    }
}
