//! Roads of templates as a network: what is recognised is what is there, and reshaping one changes nothing else.

use editor::roads::{network_of, recognise};
use editor::{Apply, Edit};
use scene::roads::{NodeKind, RoadChange, RoadWish};
use scene::{BevLayer, BevLayout, RoadNetwork};
use world::template::{TEMPLATES, layout};

/// Share of the columns with a layer in either that have it in both.
fn iou(a: &BevLayout, b: &BevLayout, layer: BevLayer) -> f64 {
    let (mut both, mut any) = (0u32, 0u32);
    for [x, y] in a.extent().all_columns() {
        let (a, b) = (a.has(layer, x, y), b.has(layer, x, y));
        both += u32::from(a && b);
        any += u32::from(a || b);
    }
    f64::from(both) / f64::from(any.max(1))
}

#[test]
fn roads_of_templates_are_recognised() {
    let mut all = Vec::new();
    for name in TEMPLATES {
        for seed in 0..4 {
            let there = layout(name, seed).expect("listed");
            let net = recognise(&there, &RoadNetwork::default());
            assert_eq!(net.problem(), None, "{name} {seed}");
            all.push(iou(
                &there,
                &net.draw(there.extent()).layout,
                BevLayer::DrivableArea,
            ));
            let arms = |n: usize| {
                net.nodes
                    .iter()
                    .filter(|node| net.arms(node.id).len() == n)
                    .count()
            };
            let rings = net
                .nodes
                .iter()
                .filter(|n| matches!(n.kind, NodeKind::Roundabout { .. }))
                .count();
            match name {
                "straight" | "curve" => assert_eq!((net.roads.len(), arms(1)), (1, 2), "{name} {seed}"),
                "t-junction" => assert_eq!((arms(3), rings), (1, 0), "{name} {seed}"),
                "intersection" => assert_eq!((arms(4), rings), (1, 0), "{name} {seed}"),
                "roundabout" => assert_eq!(rings, 1, "{name} {seed}"),
                _ => assert!(!net.is_empty(), "{name} {seed}"),
            }
        }
    }
    all.sort_by(f64::total_cmp);
    // Where parking strips end beside a junction is drawn otherwise, and drives at the border are missed.
    assert!(all[0] > 0.7 && all[all.len() / 2] > 0.95, "{all:.3?}");
}

#[test]
fn a_street_is_widened_by_words_and_undone() {
    let there = layout("t-junction", 1).expect("listed");
    let grid = scene::draft::draft(&there, std::iter::empty());
    let frame = scene::Frame::new(there, Default::default(), grid);
    let mut document = editor::Document::new(scene::Scene::single("roads", frame, Default::default(), 1));
    let before = document.scene().clone();
    let change = RoadChange::Wish {
        at_m: glam::DVec2::ZERO,
        heading_deg: 0.0,
        wish: RoadWish::Lanes { count: 4 },
    };
    document
        .apply("Wider", &Edit::ChangeRoads { change })
        .expect("sound");
    let after = document.scene().clone();
    let wide = |scene: &scene::Scene| scene.canvas().layout.count(BevLayer::DrivableArea);
    assert!(
        wide(&after) > wide(&before) + 500,
        "{} {}",
        wide(&before),
        wide(&after)
    );
    assert!(!network_of(&after).is_empty());
    document.undo();
    assert!(document.scene().roads.is_empty());
    assert_eq!(wide(document.scene()), wide(&before));
    // What cannot be leaves the scene as it is.
    let mut scene = (*after).clone();
    let change = RoadChange::Remove {
        id: scene::RoadId(9999),
    };
    let error = Edit::ChangeRoads { change }
        .apply(&mut scene)
        .expect_err("refused");
    assert_eq!(error.to_string(), "road 9999 does not exist in this scene");
    assert_eq!(scene.rev, after.rev);
}
