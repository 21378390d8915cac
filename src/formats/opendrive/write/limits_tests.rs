//! Speed limits and signals go out and come back.

use glam::DVec2;

use super::tests::streets;
use super::*;
use crate::opendrive;
use scene::background::{Post, PostKind};
use scene::speed_limits::SpeedLimits;
use scene::{Form, Polyline, PolylineKind};

/// Read from the roads alone.
fn back(text: &str) -> opendrive::LayoutImport {
    let rows = text.find("  <userData").unwrap_or(text.len());
    let roads = format!(
        "{}</OpenDRIVE>\n",
        text[..rows].trim_end_matches("</OpenDRIVE>\n")
    );
    let network = opendrive::read(roads.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    network.to_layout(DVec2::ZERO, 0.0)
}

#[test]
fn limits_come_back_where_they_were() {
    let mut layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
    let mut lines = layout.polylines.to_vec();
    // 50 km/h up to the origin, 30 mph behind it, in both lanes.
    for (mm_per_s, [from, to]) in [(13_889, [-45.0, 0.0]), (13_411, [0.0, 45.0])] {
        for y in [0.0, 3.5] {
            lines.push(Polyline {
                kind: PolylineKind::SpeedLimit { mm_per_s },
                points_m: vec![DVec2::new(from, y), DVec2::new(to, y)],
            });
        }
    }
    layout.polylines = lines.into();
    let bytes = to_bytes("limits", &layout, &RoadNetwork::default(), &Background::default());
    let text = String::from_utf8(bytes).expect("text");
    for limit in ["max=\"50\" unit=\"km/h\"", "max=\"30\" unit=\"mph\""] {
        assert!(text.contains(limit), "{limit}");
    }
    let found = SpeedLimits::from_layout(&back(&text).layout);
    for x in [-38.0, -20.0, -4.0, 4.0, 20.0, 38.0] {
        for y in [0.0, 3.5] {
            let wanted = if x < 0.0 { 13.889 } else { 13.411 };
            assert_eq!(found.at_mps(DVec2::new(x, y), 0.5), Some(wanted), "{x} {y}");
        }
    }
    // And with Sceneloom's own rows to the last bit.
    let own = opendrive::read(text.as_bytes()).expect("sound");
    assert!(own.to_layout(DVec2::ZERO, 0.0).layout == layout);
}

#[test]
fn no_limit_is_written_where_none_is_known_and_bad_ones_are_counted() {
    let layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
    let text = to_text("none", &layout, Detail::Roads);
    assert!(!text.contains("<speed") && !text.contains("<type"));
    let with = |speed: &str| {
        let record = format!("    <type s=\"0\" type=\"town\">{speed}</type>\n    <planView>");
        let text = text.replacen("    <planView>", &record, 1);
        let network = opendrive::read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
        let limits = SpeedLimits::from_layout(&network.to_layout(DVec2::ZERO, 0.0).layout);
        let bad = network.skipped.get("speed limit that cannot be read").copied();
        (limits.at_mps(DVec2::ZERO, 1.0), bad)
    };
    assert_eq!(with("<speed max=\"10\"/>"), (Some(10.0), None));
    assert_eq!(with("<speed max=\"36\" unit=\"km/h\"/>"), (Some(10.0), None));
    assert_eq!(with("<speed max=\"no limit\"/>"), (None, None));
    assert_eq!(with(""), (None, None));
    for bad in ["NaN", "-5", "1e300", "0", "fast"] {
        assert_eq!(with(&format!("<speed max=\"{bad}\"/>")), (None, Some(1)), "{bad}");
    }
    assert_eq!(with("<speed max=\"10\" unit=\"knots\"/>"), (None, Some(1)));
}

#[test]
fn signs_and_lights_come_back_where_they_stood_and_look_the_same_way() {
    let layout = streets(&[&[[-45.0, 1.75], [45.0, 1.75]]]);
    let posts = [
        (PostKind::Sign, [10.0, -4.5], 3.1, 2.4),
        (PostKind::Sign, [-12.0, 8.0], 0.05, 2.6),
        (PostKind::TrafficLight, [20.0, -4.6], -3.0, 3.6),
    ];
    let mut background = Background::default();
    for (kind, at, yaw_rad, height_m) in posts {
        background.add(Form::Post(Post {
            kind,
            position_m: DVec2::from_array(at),
            yaw_rad,
            height_m,
        }));
    }
    let bytes = to_bytes("signals", &layout, &RoadNetwork::default(), &background);
    let found = back(&String::from_utf8(bytes).expect("text")).background;
    let found: Vec<&Post> = found
        .iter()
        .filter_map(|t| match &t.form {
            Form::Post(post) => Some(post),
            _ => None,
        })
        .collect();
    assert_eq!(found.len(), posts.len());
    for (kind, at, yaw_rad, height_m) in posts {
        let near = |p: &&&Post| p.kind == kind && p.position_m.distance(DVec2::from_array(at)) < 0.05;
        let post = found
            .iter()
            .find(near)
            .unwrap_or_else(|| panic!("{kind:?} at {at:?}: {found:?}"));
        let off = (post.yaw_rad - yaw_rad).rem_euclid(std::f64::consts::TAU);
        assert!(
            off.min(std::f64::consts::TAU - off) < 0.01,
            "{kind:?}: {}",
            post.yaw_rad
        );
        assert!(
            (post.height_m - height_m).abs() < 0.01,
            "{kind:?}: {}",
            post.height_m
        );
    }
}
