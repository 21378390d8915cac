use glam::DVec2;
use scene::{BevLayer, BevLayout, PolylineKind};

use super::lanelet2::read;
use crate::opendrive::RoadNetwork;

/// Where the street's lower left corner is, m.
const CORNER: [f64; 2] = [3000.0, 7000.0];

/// Writes a map: nodes by `node`, ways of `(kind, subtype, points)` and the relations as given.
fn map(
    node: impl Fn(usize, [f64; 2]) -> String,
    ways: &[(i64, &str, &str, &[[f64; 2]])],
    relations: &str,
) -> String {
    let (mut nodes, mut lines, mut id) = (String::new(), String::new(), 1);
    for (way, kind, subtype, points) in ways {
        lines.push_str(&format!("<way id=\"{way}\">"));
        for p in *points {
            nodes.push_str(&node(id, *p));
            lines.push_str(&format!("<nd ref=\"{id}\"/>"));
            id += 1;
        }
        lines.push_str(&format!(
            "<tag k=\"type\" v=\"{kind}\"/><tag k=\"subtype\" v=\"{subtype}\"/></way>\n"
        ));
    }
    format!("<?xml version=\"1.0\"?>\n<osm version=\"0.6\">\n{nodes}{lines}{relations}</osm>\n")
}

fn lanelet(id: i64, left: i64, right: i64, tags: &[(&str, &str)]) -> String {
    let tags: String = tags
        .iter()
        .map(|(k, v)| format!("<tag k=\"{k}\" v=\"{v}\"/>"))
        .collect();
    format!(
        "<relation id=\"{id}\"><member type=\"way\" role=\"left\" ref=\"{left}\"/><member type=\"way\" role=\"right\" \
         ref=\"{right}\"/><tag k=\"type\" v=\"lanelet\"/>{tags}</relation>\n"
    )
}

/// A street along x: two lanes one way, one the other way, a walkway on its left, a crossing, a stop line and a car park.
fn street_of(node: impl Fn(usize, [f64; 2]) -> String) -> String {
    let line = |y: f64| [[0.0, y], [40.0, y], [100.0, y]];
    let (kerb, middle, lane, edge, walk) = (line(7.0), line(3.5), line(0.0), line(-3.5), line(9.5));
    let ways: &[(i64, &str, &str, &[[f64; 2]])] = &[
        (901, "curbstone", "high", &kerb),
        (902, "line_thin", "solid", &middle),
        (903, "line_thin", "dashed", &lane),
        (904, "curbstone", "low", &edge),
        (905, "wall", "", &walk),
        (906, "pedestrian_marking", "", &[[60.0, -3.5], [60.0, 7.0]]),
        (907, "pedestrian_marking", "", &[[63.0, -3.5], [63.0, 7.0]]),
        (908, "stop_line", "solid", &[[58.0, 3.5], [58.0, -3.5]]),
        (
            909,
            "line_thin",
            "",
            &[[20.0, -3.5], [20.0, -9.0], [40.0, -9.0], [40.0, -3.5]],
        ),
        (910, "fence", "", &[[0.0, 20.0], [50.0, 20.0]]),
    ];
    let relations = [
        // The right bound is drawn against the left one.
        lanelet(1, 902, 903, &[("subtype", "road"), ("one_way", "yes")]),
        lanelet(2, 903, 904, &[("subtype", "road"), ("one_way", "yes")]),
        lanelet(3, 902, 901, &[("subtype", "road"), ("one_way", "yes")]),
        lanelet(4, 905, 901, &[("subtype", "walkway"), ("one_way", "no")]),
        lanelet(5, 906, 907, &[("subtype", "crosswalk")]),
        lanelet(6, 999, 901, &[("subtype", "road")]),
        "<relation id=\"7\"><member type=\"way\" role=\"outer\" ref=\"909\"/><tag k=\"type\" v=\"multipolygon\"/>\
         <tag k=\"subtype\" v=\"parking\"/></relation>\n"
            .to_owned(),
        "<relation id=\"8\"><tag k=\"type\" v=\"regulatory_element\"/><tag k=\"subtype\" v=\"speed_limit\"/></relation>\n".to_owned(),
    ];
    map(node, ways, &relations.concat())
}

/// The street in metres.
pub(super) fn street() -> String {
    street_of(|id, [x, y]| {
        format!(
            "<node id=\"{id}\" lat=\"\" lon=\"\"><tag k=\"local_x\" v=\"{}\"/><tag k=\"local_y\" v=\"{}\"/><tag k=\"ele\" v=\"{}\"/></node>\n",
            x + CORNER[0],
            y + CORNER[1],
            10.0 + 0.02 * x,
        )
    })
}

fn at(layout: &BevLayout, layer: BevLayer, x: f64, y: f64) -> bool {
    let [x, y] = layout.extent().column_at(x, y).expect("inside");
    layout.has(layer, x, y)
}

fn lines(layout: &BevLayout, kind: PolylineKind) -> Vec<Vec<DVec2>> {
    let lines = layout.polylines.iter().filter(|l| l.kind == kind);
    lines.map(|l| l.points_m.clone()).collect()
}

/// The ego vehicle in the middle of the right lane, 50 m along.
fn checked(network: &RoadNetwork, corner: DVec2) {
    let place = corner + DVec2::new(50.0, -1.75);
    let pose = network.pose_on_lane_near(place).expect("a lane");
    assert!(pose.distance_m < 0.3 && pose.heading_rad.abs() < 0.01, "{pose:?}");
    let layout = network.to_layout(place, 0.0).layout;
    // Seen from there the lanes reach from 1.75 m to the right to 8.75 m to the left, the walkway lies behind them.
    for (y, road, walk) in [
        (-1.5, true, false),
        (8.4, true, false),
        (9.8, false, true),
        (12.0, false, false),
    ] {
        assert_eq!(at(&layout, BevLayer::DrivableArea, 5.0, y), road, "{y}");
        assert_eq!(at(&layout, BevLayer::Walkway, 5.0, y), walk, "{y}");
    }
    assert!(
        at(&layout, BevLayer::CarparkArea, -20.0, -4.0) && !at(&layout, BevLayer::CarparkArea, 5.0, -4.0)
    );
    // Stop line and crossing ahead.
    let stop = &lines(&layout, PolylineKind::StopLine)[0];
    assert!(stop.iter().all(|p| (p.x - 8.0).abs() < 0.05), "{stop:?}");
    assert!(at(&layout, BevLayer::PedCrossing, 11.5, 0.0) && !at(&layout, BevLayer::PedCrossing, 9.0, 0.0));
    // Two lanes ahead, one back.
    let centers = lines(&layout, PolylineKind::LaneCenter);
    let mut found: Vec<(i64, bool)> = centers
        .iter()
        .map(|c| ((c[0].y * 10.0).round() as i64, c[c.len() - 1].x > c[0].x))
        .collect();
    found.sort_unstable();
    assert_eq!(found, [(0, true), (35, true), (70, false)]);
    let divider = |kind| {
        lines(&layout, kind)
            .iter()
            .map(|l| (l[0].y * 10.0).round() as i64)
            .collect::<Vec<_>>()
    };
    assert_eq!(divider(PolylineKind::RoadDivider), [53]);
    assert_eq!(divider(PolylineKind::LaneDivider), [18]);
}

#[test]
fn a_street_in_metres_lies_where_it_is() {
    let network = read(street().as_bytes(), "street").expect("roads");
    checked(&network, CORNER.into());
    // It climbs by two in a hundred.
    let place = DVec2::from(CORNER) + DVec2::new(50.0, -1.75);
    let relief = network.to_layout(place, 0.0).layout.relief;
    assert!((relief.height_m(DVec2::new(30.0, 0.0)) - 0.6).abs() < 0.05);
    let skipped = &network.skipped;
    assert_eq!(skipped.get("lanelet without two bounds"), Some(&1), "{skipped:?}");
    assert_eq!(skipped.get("way fence"), Some(&1));
    assert_eq!(skipped.get("regulatory_element speed_limit"), Some(&1));
}

/// Tags of metres count beside empty degrees, without them and beside those of another place; of nodes that no way uses nothing is
/// asked.
#[test]
fn tags_of_metres_are_read_whatever_the_degrees_say() {
    for degrees in ["", " lat=\" \" lon=\"\"", " lat=\"35.1\" lon=\"139.7\""] {
        let text = street().replace(" lat=\"\" lon=\"\"", degrees);
        let with_another = text.replace(
            "<way id=\"901\"",
            "<node id=\"5000\" lat=\"\" lon=\"\"/><way id=\"901\"",
        );
        for text in [text, with_another] {
            checked(&read(text.as_bytes(), "street").expect("roads"), CORNER.into());
        }
    }
}

/// 500 km east of a zone's edge a degree of longitude is turned by little: near the central meridian east is x.
#[test]
fn a_street_in_degrees_is_projected() {
    let (latitude, longitude) = (50.0, 9.0);
    let metres_north = 111_229.03 * 0.9996; // of a degree of latitude there, as PROJ has it
    let metres_east = 71_695.75 * 0.9996;
    let text = street_of(|id, [x, y]| {
        let (lat, lon) = (latitude + y / metres_north, longitude + x / metres_east);
        format!("<node id=\"{id}\" lat=\"{lat:.12}\" lon=\"{lon:.12}\"/>\n")
    });
    let network = read(text.as_bytes(), "street").expect("roads");
    let zone = crate::lanelets::utm::Zone::from_degrees(latitude, longitude).expect("a zone");
    checked(&network, zone.project(latitude, longitude));
}

#[test]
fn bad_maps_are_one_line() {
    let whole = street();
    let line = |text: &str| {
        let line = read(text.as_bytes(), "bad").expect_err(text).to_string();
        assert!(line.chars().count() <= 300 && !line.contains('\n'), "{line}");
        line
    };
    assert!(line("<a/>").contains("expected <osm>, found <a>"));
    assert!(line("<osm/>").contains("no lanelet for traffic among 0"));
    assert!(line(&whole.replace("id=\"3\"", "id=\"x\"")).contains("expected a whole number"));
    assert!(line(&whole.replace("v=\"3000\"", "v=\"NaN\"")).contains("local_x: expected a finite number"));
    let nowhere = whole.replace("local_x", "x");
    let told = line(&nowhere);
    assert!(
        told.contains("lat and lon") && told.contains("27 of 27 without"),
        "{told}"
    );
    // Cut anywhere, it is refused.
    for at in (0..whole.len() - 8)
        .step_by(37)
        .filter(|at| whole.is_char_boundary(*at))
    {
        line(&whole[..at]);
    }
    // A node that is not there is counted.
    let holed = whole.replace("<nd ref=\"2\"/>", "<nd ref=\"12345\"/>");
    let network = read(holed.as_bytes(), "holed").expect("roads");
    assert!(
        network
            .skipped
            .contains_key("way with a node that is not in the file")
    );
}

/// The public maps, where they are there: `SCENELOOM_ROADS=folder`.
#[test]
#[ignore = "reads files of others"]
fn maps_of_others() {
    let folder = std::path::PathBuf::from(std::env::var("SCENELOOM_ROADS").expect("a folder"));
    for name in [
        "lanelet2/autoware_test_map.osm",
        "lanelet2/karlsruhe_mapping_example.osm",
    ] {
        let bytes = std::fs::read(folder.join(name)).expect("read");
        let network = read(&bytes, name).expect(name);
        let (at_m, heading_rad) = network.suggest_pose();
        let import = network.to_layout(at_m, heading_rad);
        println!(
            "{name}: at {at_m} {heading_rad:.2}, {} roads, {} lanes, {} junctions",
            network.roads.len(),
            import.lane_count,
            network.junctions.len()
        );
        println!("{:?}", network.skipped);
        assert!(import.drivable_share > 0.05 && import.lane_count > 2);
        if let Ok(out) = std::env::var("SCENELOOM_OUT") {
            let stem = std::path::Path::new(name)
                .file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            crate::opendrive::write::picture(
                &std::path::Path::new(&out).join(stem + ".png"),
                &import.layout,
                &import.layout,
            );
        }
    }
}
