//! Numbers far beyond anything that a scene holds, in the place of every number of every format that is text: what is made of them
//! stays small, and what is refused is refused in one line. Work is counted in what it leaves behind, not by the clock.

use std::ops::Range;

use glam::DVec2;
use scene::{Background, Extent, SceneBox};

use super::{Content, ImportFile, all};
use crate::FormatError;
use crate::opendrive::RoadNetwork;

/// What numbers are replaced by. A coordinate of 1e11 m in a Lanelet2 or CommonRoad file of 5 kB ran for ever.
const FAR: [&str; 9] = [
    "1e11",
    "-1e11",
    "1e300",
    "-999999999",
    "99999",
    "-7000",
    "1e-300",
    "4294967296",
    "0",
];
/// Numbers of one file that are replaced, at most: every so-manyth of more.
const MOST_NUMBERS: usize = 20;

/// Where the numbers of a text are: those that stand alone, not the digits of names.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E');
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::new(), 0);
    while at < text.len() {
        let length = text[at..].chars().take_while(|c| part(*c)).count();
        let alone = |i: Option<&u8>| i.is_none_or(|b| !b.is_ascii_alphanumeric() && *b != b'_');
        let is_alone = alone(at.checked_sub(1).and_then(|i| bytes.get(i))) && alone(bytes.get(at + length));
        if length > 0 && is_alone && text[at..at + length].parse::<f64>().is_ok() {
            out.push(at..at + length);
        }
        at += length.max(1);
        while !text.is_char_boundary(at) {
            at += 1;
        }
    }
    out
}

/// What there is of a network: records, pieces of lanes and marks, points.
fn size(network: &RoadNetwork) -> usize {
    let of_road = |road: &crate::opendrive::XodrRoad| {
        let sections = road.sections.iter().map(|s| s.breaks_m().len()).sum::<usize>();
        road.reference.records().len() + road.lane_offset.0.len() + sections + road.objects.len()
    };
    let lines = network
        .drawn
        .lines
        .iter()
        .map(|l| l.points_m.len())
        .sum::<usize>();
    network.roads.iter().map(of_road).sum::<usize>() + lines
}

fn is_small(content: Result<Content, FormatError>, what: &str) {
    match content {
        Err(error) => {
            let line = error.to_string();
            assert!(
                !line.contains('\n') && line.chars().count() <= 300,
                "{what}: {line}"
            );
        }
        Ok(Content::Roads(network)) => {
            assert!(size(&network) < 500_000, "{what}: {} parts", size(&network));
            network.pose_on_lane_near(DVec2::ZERO);
            let (at_m, heading_rad) = network.suggest_pose();
            let import = network.to_layout(at_m, heading_rad);
            let points: usize = import.layout.polylines.iter().map(|l| l.points_m.len()).sum();
            assert!(points < 20_000, "{what}: {points} points of lines");
            assert!(import.background.len() <= Background::MAX_THINGS, "{what}");
            assert!(import.boxes.values().all(|b| b.problem().is_none()), "{what}");
        }
        Ok(Content::Scene(loaded)) => {
            let frame = loaded.scene.frame();
            assert!(frame.extent().columns() <= Extent::WINDOW.columns(), "{what}");
            assert_eq!(frame.boxes.values().find_map(SceneBox::problem), None, "{what}");
        }
        Ok(Content::Recipe(_)) => {}
    }
}

#[test]
fn far_numbers_in_every_format_of_text_stay_small() {
    let (mut formats, mut tried) = (0, 0);
    for importer in all() {
        let Ok(text) = String::from_utf8((importer.sample)()) else {
            continue;
        };
        formats += 1;
        let places = numbers(&text);
        let step = places.len().div_ceil(MOST_NUMBERS).max(1);
        for place in places.into_iter().step_by(step) {
            for far in FAR {
                let changed = format!("{}{far}{}", &text[..place.start], &text[place.end..]);
                let source = ImportFile {
                    bytes: changed.as_bytes(),
                    name: "far",
                    path: None,
                    options: Default::default(),
                };
                let line = 1 + text[..place.start].matches('\n').count();
                let what = format!("{}, {far} in line {line}", importer.id);
                is_small((importer.read)(&source), &what);
                tried += 1;
            }
        }
    }
    assert!(formats >= 4 && tried > 500, "{tried} files of {formats} formats");
}

fn lanelet2(nodes: &str, lanelets: usize) -> String {
    let of = |i: usize| {
        format!(
            "<relation id=\"{i}\"><member type=\"way\" role=\"left\" ref=\"7\"/><member type=\"way\" role=\"right\" ref=\"8\"/>\
             <tag k=\"type\" v=\"lanelet\"/></relation>"
        )
    };
    let all: String = (100..100 + lanelets).map(of).collect();
    format!(
        "<osm>{nodes}<way id=\"7\"><nd ref=\"1\"/><nd ref=\"2\"/></way><way id=\"8\"><nd ref=\"3\"/><nd ref=\"4\"/></way>{all}</osm>"
    )
}

fn node(id: usize, [x, y]: [f64; 2]) -> String {
    format!("<node id=\"{id}\"><tag k=\"local_x\" v=\"{x}\"/><tag k=\"local_y\" v=\"{y}\"/></node>")
}

#[test]
fn what_is_too_far_or_too_much_is_named() {
    let street = |x: f64| [[0.0, 3.5], [x, 3.5], [0.0, 0.0], [x, 0.0]];
    let nodes = |x: f64| -> String {
        let all = street(x).into_iter().enumerate();
        all.map(|(i, p)| node(i + 1, p)).collect()
    };
    let refused = |text: &str| {
        super::lanelet2::read(text.as_bytes(), "far")
            .expect_err("refused")
            .to_string()
    };
    assert!(super::lanelet2::read(lanelet2(&nodes(90.0), 3).as_bytes(), "near").is_ok());
    let line = refused(&lanelet2(&nodes(1e11), 1));
    assert!(line.contains("node \"2\" (line 1): local_x: expected"), "{line}");
    let line = refused(&lanelet2(&nodes(9e8), 1));
    assert_eq!(
        line,
        "lanelet 100: a bound of 9.000e8 m, expected at most 100000 m"
    );
    // 10,000 lanelets of 9 km: each may be, all of them are not made.
    let line = refused(&lanelet2(&nodes(9e3), 10_000));
    assert_eq!(
        line,
        "lanelet 211: with it more than 1000 km of lanelets, expected fewer"
    );
    let point = |x: f64, y: f64| format!("<point><x>{x}</x><y>{y}</y></point>");
    let bound = |x: f64, y: f64| point(0.0, y) + &point(x, y);
    let commonroad = |x: f64| {
        format!(
            "<commonRoad><lanelet id=\"5\"><leftBound>{}</leftBound><rightBound>{}</rightBound></lanelet></commonRoad>",
            bound(x, 3.0),
            bound(x, 0.0)
        )
    };
    let read = |x: f64| super::commonroad::read(commonroad(x).as_bytes(), "far");
    assert!(read(80.0).is_ok());
    let line = read(1e11).expect_err("refused").to_string();
    assert!(
        line.contains("lanelet \"5\"") && line.contains("1e9, found 100000000000"),
        "{line}"
    );
}

/// Areas as large as the map, one over the other: what goes beyond the budget is left out and counted.
#[test]
fn areas_and_lines_over_the_whole_map_have_a_budget() {
    let around: String = [[-1e6, -1e6], [1e6, -1e6], [1e6, 1e6], [-1e6, 1e6]]
        .into_iter()
        .enumerate()
        .map(|(i, p)| node(i + 11, p))
        .collect();
    let street: String = [[0.0, 3.5], [90.0, 3.5], [0.0, 0.0], [90.0, 0.0]]
        .into_iter()
        .enumerate()
        .map(|(i, p)| node(i + 1, p))
        .collect();
    let area = |i: usize| {
        let ring: String = (11..15).map(|n| format!("<nd ref=\"{n}\"/>")).collect();
        format!("<way id=\"{i}\">{ring}<tag k=\"type\" v=\"parking\"/><tag k=\"area\" v=\"yes\"/></way>")
    };
    let map = |areas: usize| {
        let areas: String = (1000..1000 + areas).map(area).collect();
        let text =
            lanelet2(&(street.clone() + &around), 1).replace("<way id=\"7\">", &(areas + "<way id=\"7\">"));
        super::lanelet2::read(text.as_bytes(), "areas").expect("a map")
    };
    const BEYOND: &str = "roads beyond the drawing budget";
    let few = map(20).to_layout(DVec2::new(40.0, 0.0), 0.0);
    assert!(!few.skipped.contains_key(BEYOND));
    let many = map(20_000).to_layout(DVec2::new(40.0, 0.0), 0.0);
    assert_eq!(many.skipped.get(BEYOND), Some(&1));
}

/// Lanelets that all begin and end in one place: each would be behind every other one, 800 MB for 10,000 of them.
#[test]
fn a_knot_of_lanelets_stays_small() {
    let ring = [[0.0, 3.5], [4.0, 7.5], [8.0, 3.5]];
    let inner = [[0.0, 0.0], [4.0, 4.0], [8.0, 0.0]];
    let all = ring.into_iter().chain(inner).enumerate();
    let nodes: String = all.map(|(i, p)| node(i + 1, p)).collect();
    let way = |first: usize| -> String {
        let ids = [first, first + 1, first + 2, first];
        ids.map(|id| format!("<nd ref=\"{id}\"/>")).concat()
    };
    let text = lanelet2(&nodes, 5000)
        .replace("<nd ref=\"1\"/><nd ref=\"2\"/>", &way(1))
        .replace(
            "<nd ref=\"3\"/><nd ref=\"4\"/></way><rel",
            &(way(4) + "</way><rel"),
        );
    let network = super::lanelet2::read(text.as_bytes(), "knot").expect("a map");
    let connections: usize = network.junctions.iter().map(|j| j.connections).sum();
    assert!(connections <= 5000 * 64, "{connections} connections");
    assert_eq!(network.skipped["lanelet with more than 64 behind it"], 5000);
}
