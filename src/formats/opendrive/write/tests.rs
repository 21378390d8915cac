use std::collections::BTreeMap;

use glam::DVec2;
use roxmltree::{Document, Node};

use super::measure::{RoundTripFigures, figures, lanes, read_back};
use super::*;
use crate::opendrive::{self, RoadNetwork};
use crate::table_tests::random_scene;
use scene::raster::{draw_polyline, line_cells, polygon_cells};
use scene::{BevLayer, Extent, Polyline, PolylineKind, Relief};

/// Streets of one lane each way, 3.5 m wide, with shoulders of 0.4 m and walkways of 2 m.
pub(super) fn streets(axes: &[&[[f64; 2]]]) -> BevLayout {
    let mut layout = BevLayout::default();
    let mut lines = Vec::new();
    let paint = |layout: &mut BevLayout, layer: BevLayer, axis: &[DVec2], half_m: f64| {
        let mut cells = Vec::new();
        line_cells(Extent::WINDOW, axis, half_m, |x, y| cells.push((x, y)));
        cells.iter().for_each(|(x, y)| layout.set(layer, *x, *y, true));
    };
    let axes: Vec<Vec<DVec2>> = axes
        .iter()
        .map(|a| a.iter().copied().map(DVec2::from_array).collect())
        .collect();
    for axis in &axes {
        paint(&mut layout, BevLayer::Walkway, axis, 5.9);
    }
    for axis in &axes {
        paint(&mut layout, BevLayer::DrivableArea, axis, 3.9);
        let aside = |m: f64| {
            axis.iter()
                .map(|p| *p + (axis[1] - axis[0]).normalize().perp() * m)
                .collect::<Vec<_>>()
        };
        let mut back = aside(1.75);
        back.reverse();
        for (kind, points_m) in [
            (PolylineKind::LaneCenter, aside(-1.75)),
            (PolylineKind::LaneCenter, back),
            (PolylineKind::RoadDivider, axis.clone()),
        ] {
            lines.push(Polyline { kind, points_m });
        }
    }
    for [x, y] in Extent::WINDOW.all_columns() {
        if layout.has(BevLayer::DrivableArea, x, y) {
            layout.set(BevLayer::Walkway, x, y, false);
        }
    }
    lines.iter().for_each(|line| draw_polyline(&mut layout, line));
    layout.polylines = lines.into();
    layout
}

fn junction() -> BevLayout {
    streets(&[&[[-45.0, 1.75], [45.0, 1.75]], &[[12.0, -45.0], [15.0, 45.0]]])
}

fn read(text: &str) -> RoadNetwork {
    opendrive::read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
}

fn at_least(found: RoundTripFigures, road: f64, walkway: f64, lanes: f64) {
    assert!(
        found.road >= road && found.walkway >= walkway && found.lanes >= lanes,
        "{found:?}"
    );
}

#[test]
fn a_hundred_random_scenes_come_back_to_the_last_bit() {
    for seed in 0..100 {
        let mut layout = random_scene(seed).canvas().layout.clone();
        if seed % 3 == 0 {
            layout.relief = Relief::from_fn(layout.extent(), |p| (0.1 * p.x).sin() + 0.01 * p.y);
        }
        if seed % 2 == 0 {
            layout.polylines = junction().polylines;
        }
        let bytes = to_bytes(
            "random",
            &layout,
            &scene::RoadNetwork::default(),
            &scene::Background::default(),
        );
        assert!(
            bytes
                == to_bytes(
                    "random",
                    &layout,
                    &scene::RoadNetwork::default(),
                    &scene::Background::default()
                ),
            "{seed}: the same bytes"
        );
        let network = opendrive::read(&bytes).unwrap_or_else(|e| panic!("{seed}: {e}"));
        let back = network.to_layout_over(layout.extent(), DVec2::ZERO, 0.0);
        assert!(back.is_own && back.layout == layout, "{seed}");
        assert_eq!(network.suggest_pose(), (DVec2::ZERO, 0.0));
    }
}

/// Cells and lines of a street, read from its lanes alone.
#[test]
fn streets_come_back_from_their_lanes() {
    let straight = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
    at_least(
        figures(&straight, &read_back(&straight, Detail::Roads).layout),
        0.99,
        0.99,
        0.99,
    );
    let found = read_back(&junction(), Detail::Roads).layout;
    at_least(figures(&junction(), &found), 0.98, 0.95, 0.99);
    let dividers = found
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::RoadDivider);
    assert_eq!(dividers.count(), 4, "one on each arm");
    // A side street that ends in the middle of the other one.
    let side = streets(&[&[[-45.0, 1.75], [45.0, 1.75]], &[[12.0, 1.75], [15.0, 45.0]]]);
    let network = read(&to_text("side", &side, Detail::Roads));
    assert_eq!(network.junctions.len(), 1);
    // Two ways straight on, and from every arm to every other one that lies to its side.
    assert_eq!(network.junctions[0].connections, 6);
    at_least(
        figures(&side, &read_back(&side, Detail::Roads).layout),
        0.98,
        0.93,
        0.9,
    );
}

/// Every link has its counterpart, and lanes meet to the centimetre.
#[test]
fn links_lead_back_and_lanes_meet() {
    let text = to_text("junction", &junction(), Detail::Roads);
    let document = Document::parse(&text).expect("well formed");
    let network = read(&text);
    let of_name = |node: Node<'_, '_>, name: &'static str| {
        node.descendants().find(|n| n.has_tag_name(name)).map(|n| n.id())
    };
    let roads: BTreeMap<&str, Node<'_, '_>> = document
        .descendants()
        .filter(|n| n.has_tag_name("road"))
        .map(|n| (n.attribute("id").expect("an id"), n))
        .collect();
    assert_eq!(
        roads.len(),
        4 + 12,
        "four arms; two ways straight on each street and eight turns"
    );
    let connections: Vec<Node<'_, '_>> = document
        .descendants()
        .filter(|n| n.has_tag_name("connection"))
        .collect();
    assert_eq!(connections.len(), 12);
    let at_end = |road: &opendrive::XodrRoad, end: bool, lane: i32| -> [DVec2; 2] {
        let s = if end { road.length_m() } else { 0.0 };
        let section = &road.sections[0];
        let mut t = Vec::new();
        section.borders_m(road.lane_offset.at(s, s), s, s, &mut t);
        let i = match lane {
            1.. => section.center_index() - lane as usize,
            _ => section.center_index() + lane.unsigned_abs() as usize - 1,
        };
        [i, i + 1].map(|b| road.reference.at(s).offset(t[b]))
    };
    let find = |id: &str| network.roads.iter().find(|r| r.id == id).expect("a road");
    let mut joints = 0;
    for connection in connections {
        let connecting = roads[connection.attribute("connectingRoad").expect("a road")];
        let road = find(connecting.attribute("id").expect("an id"));
        assert!(road.junction.is_some());
        for (name, own_end) in [("predecessor", false), ("successor", true)] {
            let link = connecting
                .descendants()
                .find(|n| n.has_tag_name("link"))
                .expect("a link");
            let to = link.children().find(|n| n.has_tag_name(name)).expect(name);
            let other = find(to.attribute("elementId").expect("an id"));
            let other_end = to.attribute("contactPoint") == Some("end");
            let ends = [&other.predecessor, &other.successor];
            let back = ends[usize::from(other_end)].as_ref();
            assert_eq!(
                back,
                Some(&opendrive::RoadEnd::Junction(road.junction.clone().expect("one")))
            );
            let is_driving =
                |n: &Node<'_, '_>| n.has_tag_name("lane") && n.attribute("type") == Some("driving");
            let driving = connecting.descendants().find(is_driving).expect("a lane");
            let own: i32 = driving.attribute("id").expect("an id").parse().expect("a number");
            let link = driving
                .children()
                .find(|n| n.has_tag_name("link"))
                .expect("a link");
            let target = link.children().find(|n| n.has_tag_name(name)).expect(name);
            let target: i32 = target.attribute("id").expect("an id").parse().expect("a number");
            let (mut a, b) = (at_end(road, own_end, own), at_end(other, other_end, target));
            if a[0].distance(b[0]) > a[0].distance(b[1]) {
                a.reverse();
            }
            assert!(
                a[0].distance(b[0]) < 0.01 && a[1].distance(b[1]) < 0.01,
                "{name} {a:?} {b:?}"
            );
            joints += 1;
        }
        assert!(of_name(connecting, "planView").is_some());
    }
    assert_eq!(joints, 24);
}

/// Painted freehand: a bend, a fork, a yard, and no lane anywhere.
#[test]
fn painted_ground_without_lanes_becomes_roads() {
    let mut layout = BevLayout::default();
    let bend: Vec<DVec2> = (0..=40)
        .map(|i| DVec2::new(-42.0 + 1.8 * f64::from(i), 12.0 * (f64::from(i) * 0.08).sin()))
        .collect();
    let mut cells = Vec::new();
    line_cells(Extent::WINDOW, &bend, 3.3, |x, y| cells.push((x, y)));
    line_cells(
        Extent::WINDOW,
        &[DVec2::new(0.0, 12.0), DVec2::new(6.0, 42.0)],
        1.7,
        |x, y| cells.push((x, y)),
    );
    let yard = [[20.0, -30.0], [34.0, -30.0], [34.0, -20.0], [20.0, -20.0]].map(DVec2::from_array);
    polygon_cells(Extent::WINDOW, &yard, |x, y| cells.push((x, y)));
    cells
        .iter()
        .for_each(|(x, y)| layout.set(BevLayer::DrivableArea, *x, *y, true));
    let roads = read_back(&layout, Detail::Roads).layout;
    let found = figures(&layout, &roads);
    assert!(found.road > 0.85, "{found:?}");
    assert!(
        lanes(&roads).len() >= 4,
        "two lanes on the bend's arms, one on the fork's"
    );
    let all = figures(&layout, &read_back(&layout, Detail::Areas).layout);
    assert!(all.road > 0.97, "{all:?}");
}

#[test]
fn crossings_stop_lines_and_car_parks_come_back() {
    let mut layout = junction();
    let crossing = Polyline {
        kind: PolylineKind::PedCrossing,
        points_m: [[-6.0, -2.1], [-2.5, -2.1], [-2.5, 5.6], [-6.0, 5.6]]
            .map(DVec2::from_array)
            .to_vec(),
    };
    let stop = Polyline {
        kind: PolylineKind::StopLine,
        points_m: [[-7.0, -1.7], [-7.0, 1.7]].map(DVec2::from_array).to_vec(),
    };
    for line in [&crossing, &stop] {
        draw_polyline(&mut layout, line);
    }
    let mut lines = layout.polylines.to_vec();
    lines.extend([crossing.clone(), stop]);
    layout.polylines = lines.into();
    let lot = [[-30.0, -20.0], [-10.0, -20.0], [-10.0, -10.0], [-30.0, -10.0]].map(DVec2::from_array);
    let mut cells = Vec::new();
    polygon_cells(Extent::WINDOW, &lot, |x, y| cells.push((x, y)));
    cells
        .iter()
        .for_each(|(x, y)| layout.set(BevLayer::CarparkArea, *x, *y, true));
    let found = read_back(&layout, Detail::Areas).layout;
    let of = |kind| {
        found
            .polylines
            .iter()
            .filter(move |l| l.kind == kind)
            .collect::<Vec<_>>()
    };
    let back = of(PolylineKind::PedCrossing);
    assert_eq!(back.len(), 1);
    for (a, b) in crossing.points_m.iter().zip(&back[0].points_m) {
        assert!(a.distance(*b) < 1e-6, "{a} {b}");
    }
    let back = of(PolylineKind::StopLine);
    assert_eq!(back.len(), 1, "{back:?}");
    assert!(
        back[0]
            .points_m
            .iter()
            .all(|p| (p.x + 7.0).abs() < 0.05 && (-1.9..1.9).contains(&p.y)),
        "{back:?}"
    );
    let bit = BevLayer::CarparkArea.bit();
    let same = layout
        .cells()
        .iter()
        .zip(found.cells())
        .all(|(a, b)| a & bit == b & bit);
    assert!(same, "the car park");
}

#[test]
fn heights_and_tilts_come_back() {
    let mut layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
    layout.relief = Relief::from_fn(layout.extent(), |p| {
        0.04 * p.x + 0.02 * p.y + 0.5 * (0.1 * p.x).sin()
    });
    let found = read_back(&layout, Detail::Roads).layout;
    for x in -38..38 {
        for y in [-1.5, 1.75, 5.0] {
            let p = DVec2::new(f64::from(x), y);
            let [a, b] = [&layout, &found].map(|l| l.relief.height_m(p) - l.relief.height_m(DVec2::ZERO));
            assert!((a - b).abs() < 0.06, "{p}: {a} {b}");
        }
    }
}

#[test]
fn traffic_on_the_left_stays_there() {
    let mut layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]], &[[12.0, -45.0], [15.0, 45.0]]]);
    let mut lines = layout.polylines.to_vec();
    for line in lines.iter_mut().filter(|l| l.kind == PolylineKind::LaneCenter) {
        line.points_m.reverse();
    }
    layout.polylines = lines.into();
    let text = to_text("left", &layout, Detail::Roads);
    assert!(text.contains("rule=\"LHT\"") && !text.contains("rule=\"RHT\"") && !text.contains("reversed"));
    at_least(
        figures(&layout, &read_back(&layout, Detail::Roads).layout),
        0.98,
        0.95,
        0.99,
    );
}

/// Rows hold for their roads, their place and their map alone; else the roads are read, and that is said.
#[test]
fn own_rows_that_do_not_fit_are_left_out_and_said_to_be() {
    let layout = junction();
    let text = String::from_utf8(to_bytes(
        "rows",
        &layout,
        &scene::RoadNetwork::default(),
        &scene::Background::default(),
    ))
    .expect("text");
    let said = |text: &str, extent: Extent, at: [f64; 2]| -> Option<String> {
        let import = read(text).to_layout_over(extent, at.into(), 0.0);
        let said = import
            .skipped
            .keys()
            .find(|k| k.starts_with("sceneloom's"))
            .cloned();
        assert_eq!(import.is_own, said.is_none());
        assert!(import.layout.count(BevLayer::DrivableArea) > 2000);
        said
    };
    let window = Extent::WINDOW;
    assert_eq!(said(&text, window, [0.0; 2]), None);
    let part = Extent::new([-50, -50], [120, 100]).expect("a map");
    assert_eq!(said(&text, part, [0.0; 2]), None);
    assert!(read(&text).to_layout_over(part, DVec2::ZERO, 0.0).layout == layout.crop(part));
    let other = Some("sceneloom's rows for another place or map (its roads are read)".to_owned());
    assert_eq!(said(&text, window, [3.0, 0.0]), other);
    let wide = Extent::new([-150, -100], [300, 200]).expect("a map");
    assert_eq!(said(&text, wide, [0.0; 2]), other);
    let changed = text.replacen("junction=\"-1\"", "junction=\"\"", 1);
    let edited = "sceneloom's rows left out, as the roads were changed since";
    assert_eq!(said(&changed, window, [0.0; 2]).as_deref(), Some(edited));
    let runs = [
        ("rows=\"", "rows=\"9", "sceneloom's rows beyond their extent"),
        ("<cells rows", "<cells n", "sceneloom's rows beyond their extent"),
        (
            "value=\"layout 1\"",
            "value=\"layout 2\"",
            "sceneloom's rows of another version",
        ),
        (
            "columns=\"200 200\"",
            "columns=\"200 9999999\"",
            "sceneloom's rows without an extent",
        ),
        (
            "columns=\"200 200\"",
            "columns=\"200 201\"",
            "sceneloom's rows shorter than their extent",
        ),
        ("*", "x", "sceneloom's rows with an unreadable run"),
        (
            "kind=\"lane_center\">",
            "kind=\"lane_center\">NaN ",
            "sceneloom's rows with an unreadable line",
        ),
        (
            "kind=\"lane_center\">",
            "kind=\"other\">",
            "sceneloom's rows with an unreadable line",
        ),
    ];
    for (from, to, expected) in runs {
        let rows = text.find("<userData").expect("rows");
        let bad = format!("{}{}", &text[..rows], text[rows..].replacen(from, to, 1));
        assert_eq!(said(&bad, window, [0.0; 2]).as_deref(), Some(expected), "{from}");
    }
}

#[test]
fn an_empty_map_is_a_file_too() {
    for extent in [
        Extent::WINDOW,
        Extent::new([3, -4], [1, 1]).expect("a map"),
        Extent::new([0, 0], [7, 900]).expect("a map"),
    ] {
        let layout = BevLayout::over(extent);
        let text = String::from_utf8(to_bytes(
            "<&\">",
            &layout,
            &scene::RoadNetwork::default(),
            &scene::Background::default(),
        ))
        .expect("text");
        let network = read(&text);
        assert_eq!(network.name, "<&\">");
        let back = network.to_layout_over(extent, DVec2::ZERO, 0.0);
        assert!(back.is_own && back.layout == layout);
        let roads = read(&to_text("x", &layout, Detail::Areas)).to_layout_over(extent, DVec2::ZERO, 0.0);
        assert!(roads.layout.cells().iter().all(|c| *c == 0));
    }
}

/// Lanes that no map can have end in no panic and no endless search.
#[test]
fn wild_lanes_are_survived() {
    let wild: Vec<Vec<[f64; 2]>> = vec![
        vec![[0.0, 0.0], [0.0, 0.0]],
        vec![[0.0, 0.0], [f64::NAN, 1.0]],
        vec![[1e9, 1e9], [-1e9, -1e9]],
        (0..400)
            .map(|i| (DVec2::from_angle(f64::from(i)) * (f64::from(i) * 0.1)).to_array())
            .collect(),
        (0..300)
            .map(|i| [f64::from(i % 2) * 30.0, f64::from(i) * 0.1])
            .collect(),
        vec![[0.0, 0.0], [5.0, 0.0], [0.0, 0.0], [5.0, 0.0]],
        vec![],
        vec![[3.0, 3.0]],
    ];
    for n in 1..=wild.len() {
        let mut layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
        let mut lines = layout.polylines.to_vec();
        lines.extend(wild[..n].iter().map(|points| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: points.iter().copied().map(DVec2::from_array).collect(),
        }));
        layout.polylines = lines.into();
        read(&to_text("wild", &layout, Detail::Areas));
    }
}
