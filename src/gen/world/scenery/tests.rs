//! Tests of the scenery: sound, repeatable, off the road, and along it.

use super::*;
use crate::{World, template, traffic};
use scene::raster::polygon_cells;
use scene::{BevLayer, Extent, Form, Window};

#[test]
fn distance_is_zero_on_the_set_and_grows() {
    let d = distance_cells(scene::Extent::WINDOW, |c| c == 100 * Window::NY + 100);
    assert_eq!(d[100 * Window::NY + 100], 0.0);
    assert_eq!(d[100 * Window::NY + 110], 10.0);
    assert!((d[103 * Window::NY + 104] - 5.0).abs() < 0.5);
}

#[test]
fn scenery_is_sound_repeatable_and_off_the_road() {
    let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::Walkway.bit();
    let mut counts = [0; 3];
    for seed in 0..40 {
        let layout = template::any_layout(seed);
        let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
        let all = background(&layout, &boxes, seed);
        assert_eq!(all, background(&layout, &boxes, seed));
        assert_eq!(all.problem(), None, "seed {seed}");
        let mut owner = vec![None; Window::COLUMNS];
        for thing in all.iter() {
            match &thing.form {
                Form::Building(b) => {
                    counts[0] += 1;
                    polygon_cells(Extent::WINDOW, &b.outline_m, |x, y| {
                        assert_eq!(
                            layout.cell(x, y) & paved,
                            0,
                            "seed {seed}: {:?} on the road",
                            thing.id
                        );
                        let before = owner[x * Window::NY + y].replace(thing.id);
                        assert!(
                            before.is_none(),
                            "seed {seed}: {before:?} and {:?} overlap",
                            thing.id
                        );
                    });
                }
                Form::Tree(t) => {
                    counts[1] += 1;
                    if let Some([x, y]) = Window::column_at(t.position_m.x, t.position_m.y) {
                        let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
                        assert_eq!(layout.cell(x, y) & road, 0, "seed {seed}: a tree on the road");
                    }
                }
                Form::Line(_) => counts[2] += 1,
                _ => {}
            }
        }
    }
    println!("buildings, trees, lines in 40 worlds: {counts:?}");
    assert!(counts.iter().all(|n| *n > 100), "{counts:?}");
}

/// The facade of most buildings looks at the road: the front edge is at right angles to the way there.
#[test]
fn buildings_face_the_road() {
    let (mut aligned, mut all) = (0, 0);
    for seed in 0..20 {
        let world = World::random(seed);
        let style = Style::drawn(&world.layout, seed);
        let site = ScenerySite::new(&world.layout, &world.boxes, &style, seed);
        for thing in world.background.iter() {
            if let Form::Building(b) = &thing.form
                && let Some(away) = site.away((b.outline_m[0] + b.outline_m[1]) / 2.0)
            {
                let front = (b.outline_m[1] - b.outline_m[0]).normalize();
                all += 1;
                aligned += usize::from(front.dot(away).abs() < 0.35);
            }
        }
    }
    assert!(aligned * 10 > all * 8, "{aligned} of {all}");
}

#[test]
fn steps_are_held_by_walls_and_bridges_span_the_road() {
    use crate::terrain::Terrain;
    use scene::background::LineKind;
    let count = |all: &Background, kind: LineKind| {
        let lines = all.iter().filter_map(|t| match &t.form {
            Form::Line(l) if l.kind == kind => Some(super::walk::length_m(&l.points_m)),
            _ => None,
        });
        lines.sum::<f64>()
    };
    let mut bridges = 0;
    for seed in 0..60 {
        let mut layout = template::layout("straight", seed).expect("listed");
        let nothing = BTreeMap::new();
        layout.relief = Terrain::Terrace.relief(&layout, seed);
        let side = RoadsideStyle::usual(RoadsideKind::Motorway);
        let held = background_of(&layout, &nothing, &Style::both(side), seed);
        assert!(count(&held, LineKind::RetainingWall) > 40.0, "seed {seed}");
        layout.relief = Terrain::Viaduct.relief(&layout, seed);
        let carried = background_of(&layout, &nothing, &Style::both(side), seed);
        assert!(count(&carried, LineKind::Wall) > 20.0, "seed {seed}");
        layout.relief = scene::Relief::FLAT;
        let level = background_of(&layout, &nothing, &Style::both(side), seed);
        assert_eq!(count(&level, LineKind::RetainingWall), 0.0);
        let decks = level.iter().filter(|t| matches!(t.form, Form::Bridge(_)));
        for deck in decks {
            bridges += 1;
            // Nothing of it stands on the road, and a lorry passes below.
            let mut solids = Vec::new();
            deck.solids(&|_| 0.0, &mut solids);
            for s in solids.iter().filter(|s| s.center.z - s.reach().z < 4.4) {
                let cell = Window::column_at(s.center.x, s.center.y);
                let road = |[x, y]: [usize; 2]| layout.cell(x, y) & BevLayer::DrivableArea.bit() != 0;
                assert!(!cell.is_some_and(road), "seed {seed}: a pier on the road");
            }
        }
    }
    assert!((2..20).contains(&bridges), "{bridges}");
}
