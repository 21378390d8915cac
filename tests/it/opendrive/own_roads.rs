//! The bundled roads: what they were made of has to come out.

use std::f64::consts::{FRAC_PI_2, PI};

use formats::opendrive::geometry::CurveShape;
use formats::opendrive::lanes::MarkStyle;
use formats::opendrive::objects::ObjectKind;
use glam::DVec2;
use scene::{BevLayer, PolylineKind, Window};

use super::{OWN, area_m2, layers_at, own, same_heading, window_at};

fn lines(import: &formats::opendrive::LayoutImport, kind: PolylineKind) -> Vec<Vec<DVec2>> {
    let all = import.layout.polylines.iter();
    all.filter(|l| l.kind == kind)
        .map(|l| l.points_m.clone())
        .collect()
}

/// Length, m.
fn run(points: &[DVec2]) -> f64 {
    points.windows(2).map(|p| p[0].distance(p[1])).sum()
}

#[test]
fn a_straight_road_has_its_analytic_areas() {
    let network = own("straight_two_way");
    let here = network.roads[0].reference.at(100.0);
    // A strip of width w that crosses the window from side to side covers w * 80 / cos(angle).
    for angle in [0.0, 0.2, -0.5, PI, 3.0] {
        let import = network.to_layout(here.position_m, here.heading_rad + angle);
        let across = 80.0 / angle.cos().abs();
        for (layer, width) in [(BevLayer::DrivableArea, 7.0), (BevLayer::Walkway, 4.0)] {
            let (got, expected) = (area_m2(&import, layer), width * across);
            assert!(
                (got - expected).abs() < 0.4 * across,
                "{layer:?} at {angle}: {got} for {expected}"
            );
        }
        let crossing = area_m2(&import, BevLayer::PedCrossing);
        assert!((crossing - 28.0).abs() < 4.0, "{crossing}");
        assert_eq!(
            (import.road_count, import.lane_count, import.crossing_count),
            (1, 2, 1)
        );
    }
    // Turned by an odd angle the raster's bias averages out.
    let slanted = network.to_layout(here.position_m, here.heading_rad + 0.2);
    let got = area_m2(&slanted, BevLayer::DrivableArea) * 0.2f64.cos() / 80.0;
    assert!((got - 7.0).abs() < 0.05, "mean width {got}");
}

#[test]
fn a_straight_road_has_its_lines() {
    let network = own("straight_two_way");
    let import = network.to_layout(DVec2::new(100.0, -1.75), 0.0);
    let centers = lines(&import, PolylineKind::LaneCenter);
    let expected = [(3.5, PI), (0.0, 0.0)]; // y and heading, from the left
    for (line, (y, heading)) in centers.iter().zip(expected) {
        assert_eq!(line.len(), 2, "straight lines are thinned to their ends");
        assert!(line.iter().all(|p| (p.y - y).abs() < 1e-9));
        assert!(same_heading((line[1] - line[0]).to_angle(), heading, 1e-9));
        assert!((run(line) - 80.0).abs() < 1e-9);
    }
    assert_eq!(
        lines(&import, PolylineKind::RoadDivider),
        [[DVec2::new(-40.0, 1.75), DVec2::new(40.0, 1.75)]]
    );
    assert!(lines(&import, PolylineKind::LaneDivider).is_empty());
    // Stop lines: four metres before and behind the middle, each across the lane it holds.
    let stops = lines(&import, PolylineKind::StopLine);
    for (stop, (x, y)) in stops.iter().zip([(-4.0, 0.0), (4.0, 3.5)]) {
        assert!((stop[0].midpoint(stop[1]) - DVec2::new(x, y)).length() < 1e-9);
        assert!((run(stop) - 3.5).abs() < 1e-9);
    }
    assert_eq!(stops.len(), 2);
    assert_eq!(
        layers_at(&import, 0.0, 0.0),
        [BevLayer::DrivableArea, BevLayer::PedCrossing]
    );
    assert_eq!(layers_at(&import, 20.0, -2.8), [BevLayer::Walkway]);
    assert_eq!(layers_at(&import, 20.0, -4.2), []);
    let things: Vec<&str> = import.background.iter().map(|t| t.form.name()).collect();
    assert_eq!(things, ["pole"]);
    assert_eq!(
        network.roads[0].sections[0].center_marks[0].style,
        MarkStyle::Broken
    );
}

#[test]
fn a_junction_is_whole_and_symmetric() {
    let network = own("four_arm_junction");
    assert_eq!((network.roads.len(), network.junctions.len()), (16, 1));
    assert_eq!(
        (
            network.junctions[0].incoming.len(),
            network.junctions[0].connections
        ),
        (4, 12)
    );
    let counts: Vec<usize> = (0..4)
        .map(|quarter| {
            let import = network.to_layout(DVec2::ZERO, 0.3 + f64::from(quarter) * FRAC_PI_2);
            assert_eq!(
                (import.road_count, import.lane_count, import.crossing_count),
                (16, 20, 4)
            );
            import.layout.count(BevLayer::DrivableArea)
        })
        .collect();
    assert!(
        counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 8,
        "{counts:?}"
    );

    let import = network.to_layout(DVec2::ZERO, 0.0);
    // Nothing enclosed: every cell that cannot be driven on is reached from the corners of the window.
    let mut reached = vec![false; Window::COLUMNS];
    let last = Window::NX - 1;
    let mut stack = vec![(0, 0), (0, last), (last, 0), (last, last)];
    while let Some((x, y)) = stack.pop() {
        if import.layout.has(BevLayer::DrivableArea, x, y)
            || std::mem::replace(&mut reached[x * Window::NY + y], true)
        {
            continue;
        }
        stack.extend([
            (x.saturating_sub(1), y),
            ((x + 1).min(last), y),
            (x, y.saturating_sub(1)),
            (x, (y + 1).min(last)),
        ]);
    }
    let free = Window::COLUMNS - import.layout.count(BevLayer::DrivableArea);
    assert_eq!(reached.iter().filter(|r| **r).count(), free);

    for kind in [PolylineKind::RoadDivider, PolylineKind::LaneDivider] {
        for line in lines(&import, kind) {
            assert!(
                line.iter().all(|p| p.abs().max_element() > 15.9),
                "no divider in the junction"
            );
        }
    }
    assert_eq!(lines(&import, PolylineKind::RoadDivider).len(), 4);
    // Each way through begins where a lane arrives and ends where one leaves, in line with both.
    let centers = lines(&import, PolylineKind::LaneCenter);
    let (inside, arms): (Vec<_>, Vec<_>) = centers.iter().partition(|line| {
        line[0].abs().max_element() < 17.0 && line[line.len() - 1].abs().max_element() < 17.0
    });
    assert_eq!((inside.len(), arms.len()), (12, 8));
    for line in inside {
        let n = line.len();
        let arrives = arms.iter().any(|arm| {
            arm[1].distance(line[0]) < 1e-6
                && same_heading((arm[1] - arm[0]).to_angle(), (line[1] - line[0]).to_angle(), 0.1)
        });
        let leaves = arms.iter().any(|arm| {
            arm[0].distance(line[n - 1]) < 1e-6
                && same_heading(
                    (arm[1] - arm[0]).to_angle(),
                    (line[n - 1] - line[n - 2]).to_angle(),
                    0.1,
                )
        });
        assert!(arrives && leaves, "{line:?}");
    }
    // Stop lines hold the lane that arrives: on its right-hand side, seen towards the middle.
    let stops = lines(&import, PolylineKind::StopLine);
    assert_eq!(stops.len(), 4);
    for stop in stops {
        let middle = stop[0].midpoint(stop[1]);
        assert!((middle.length() - 23f64.hypot(1.75)).abs() < 1e-6);
        let axis = if middle.x.abs() > middle.y.abs() {
            DVec2::new(-middle.x.signum(), 0.0)
        } else {
            DVec2::new(0.0, -middle.y.signum())
        };
        assert!(axis.perp_dot(middle) < 0.0, "{middle}");
    }
}

#[test]
fn every_kind_of_geometry_joins_and_is_paved() {
    let network = own("every_geometry");
    let reference = &network.roads[0].reference;
    let kinds: Vec<&str> = reference
        .records()
        .iter()
        .map(|g| match g.shape() {
            CurveShape::Line => "line",
            CurveShape::Arc { .. } => "arc",
            CurveShape::Spiral { .. } => "spiral",
            CurveShape::Poly3 { .. } => "poly3",
            CurveShape::ParamPoly3 { normalized: true, .. } => "normalized",
            CurveShape::ParamPoly3 { .. } => "arcLength",
        })
        .collect();
    assert_eq!(
        kinds,
        [
            "line",
            "spiral",
            "arc",
            "spiral",
            "poly3",
            "normalized",
            "arcLength"
        ]
    );
    for pair in reference.records().windows(2) {
        // The file was made by an independent quadrature in Python.
        let (end, start) = (pair[0].at(pair[0].length_m), pair[1].at(0.0));
        assert!(
            end.position_m.distance(start.position_m) < 1e-8,
            "{:?}",
            pair[1].shape()
        );
        assert!(same_heading(end.heading_rad, start.heading_rad, 1e-8));
    }
    let samples: Vec<DVec2> = (0..=3600)
        .map(|i| reference.at(f64::from(i) * 0.05).position_m)
        .collect();
    for s in [30.0, 90.0, 125.0, 150.0] {
        let here = reference.at(s);
        let import = window_at(&network, 0, s);
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let cell = Window::center(x, y, 0).truncate();
                let p = here.position_m + DVec2::from_angle(here.heading_rad).rotate(cell);
                let distance = samples
                    .iter()
                    .map(|q| q.distance(p))
                    .fold(f64::INFINITY, f64::min);
                let beyond = [samples[0], samples[3600]].iter().any(|q| q.distance(p) < 4.0);
                let drivable = import.layout.has(BevLayer::DrivableArea, x, y);
                if !beyond && distance < 3.2 {
                    assert!(drivable, "s = {s}: hole at {cell}, {distance} m from the line");
                }
                if distance > 3.3 + 0.4 {
                    assert!(!drivable, "s = {s}: paved at {cell}, {distance} m from the line");
                }
            }
        }
        // The road climbs by 2 % from end to end.
        let ends = [-25.0, 25.0].map(|x| {
            let there = network.roads[0].reference.at(s + x).position_m;
            let here = network.roads[0].reference.at(s);
            let p = DVec2::from_angle(-here.heading_rad).rotate(there - here.position_m);
            import.layout.relief.height_m(p)
        });
        assert!((ends[1] - ends[0] - 1.0).abs() < 0.02, "s = {s}: {ends:?}");
        for line in lines(&import, PolylineKind::LaneCenter) {
            assert!(run(&line) > 60.0, "lanes are not broken where records meet");
        }
    }
    assert!(network.skipped.is_empty(), "{:?}", network.skipped);
}

#[test]
fn a_street_has_its_lanes_side_by_side() {
    use BevLayer::{CarparkArea, DrivableArea, LaneDivider, Walkway};
    let network = own("parking_street");
    let check = |s: f64, expected: &[(f64, &[BevLayer])]| {
        let import = window_at(&network, 0, s);
        for (t, layers) in expected {
            assert_eq!(layers_at(&import, 0.1, *t), *layers, "at s = {s}, t = {t}");
        }
    };
    check(
        30.0,
        &[
            (2.3, &[]),
            (0.9, &[Walkway]),
            (-1.6, &[DrivableArea]),
            (-3.2, &[DrivableArea, LaneDivider]),
            (-4.0, &[DrivableArea]),              // bicycle lane on the road
            (-5.8, &[DrivableArea, CarparkArea]), // parking lane
            (-8.0, &[Walkway]),
            (-9.8, &[]),
        ],
    );
    // The lanes have moved 1.5 m to the left; a second one is open; only the right side was declared anew.
    check(
        115.0,
        &[
            (1.5 + 0.9, &[Walkway]),
            (1.5 - 1.6, &[DrivableArea]),
            (1.5 - 3.2, &[DrivableArea, LaneDivider]),
            (1.5 - 4.8, &[DrivableArea]),
            (1.5 - 7.6, &[Walkway]),
            (10.0, &[DrivableArea, CarparkArea]), // the yard, an object
        ],
    );
    // By borders instead of widths.
    check(
        145.0,
        &[
            (1.5 + 0.9, &[Walkway]),
            (1.5 - 1.6, &[DrivableArea]),
            (1.5 - 3.2, &[DrivableArea, LaneDivider]),
            (1.5 - 4.8, &[DrivableArea]),
            (1.5 - 7.4, &[Walkway]),
            (1.5 - 9.0, &[]),
        ],
    );
    // The mark between the lanes begins ten metres after the second lane does.
    let import = window_at(&network, 0, 80.0);
    let ahead: Vec<f64> = lines(&import, PolylineKind::LaneDivider)
        .iter()
        .flatten()
        .map(|p| p.x)
        .filter(|x| *x > 1.0)
        .collect();
    let first = ahead.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((first - 10.0).abs() < 0.3, "{first}");
    assert!(lines(&import, PolylineKind::RoadDivider).is_empty(), "one way");
    let bays = network.roads[0]
        .objects
        .iter()
        .find(|o| o.kind == ObjectKind::Parking)
        .expect("bays");
    assert_eq!(bays.repeats.len(), 1);
    assert_eq!(network.skipped.len(), 0, "{:?}", network.skipped);
}

#[test]
fn left_hand_traffic_keeps_left() {
    let network = own("left_hand_bend");
    assert!(network.roads[0].left_hand);
    let import = window_at(&network, 0, 20.0);
    let centers = lines(&import, PolylineKind::LaneCenter);
    assert_eq!(centers.len(), 2);
    for line in &centers {
        let near = line
            .iter()
            .min_by(|a, b| a.length().total_cmp(&b.length()))
            .expect("points");
        let forward = line[line.len() - 1].x > line[0].x;
        assert_eq!(forward, near.y > 0.0, "the lane on the left runs forward");
    }
    // Length by width, turned by a quarter: 6 m across, 4 m along. The other one is a line 3 m wide.
    let area = area_m2(&import, BevLayer::PedCrossing);
    assert!((area - 24.0).abs() < 2.5, "{area}");
    assert_eq!(
        layers_at(&import, 1.8, 2.6),
        [BevLayer::DrivableArea, BevLayer::PedCrossing]
    );
    assert_eq!(layers_at(&import, 2.4, 2.6), [BevLayer::DrivableArea]);
    let zebra = window_at(&network, 0, 125.0);
    let area = area_m2(&zebra, BevLayer::PedCrossing);
    assert!((area - 18.0).abs() < 2.5, "{area}");
    // Shoulders are paved, the verge (a wide border) is not: 8 m.
    let width = area_m2(&window_at(&network, 0, 0.0), BevLayer::DrivableArea) / 40.0;
    assert!((width - 8.0).abs() < 0.5, "{width}");
}

#[test]
fn a_motorway_keeps_its_median_and_its_exit() {
    let network = own("motorway_exit");
    let import = window_at(&network, 0, 110.0);
    assert_eq!(layers_at(&import, 0.1, 0.3), [], "the median");
    assert_eq!(
        layers_at(&import, 0.1, 2.6),
        [BevLayer::DrivableArea],
        "the inner shoulder"
    );
    let dividers = lines(&import, PolylineKind::RoadDivider);
    assert_eq!(dividers.len(), 2, "one on each side of the median");
    for divider in &dividers {
        assert!(divider.iter().all(|p| (p.y.abs() - 2.0).abs() < 1.0));
    }
    // Five lanes of the road, and the two beyond its end that the window shows less of.
    let exit = lines(&import, PolylineKind::LaneCenter)
        .iter()
        .filter(|l| l[0].y < -8.0)
        .count();
    assert!(exit >= 1, "the exit lane has a centre");
    let end = window_at(&network, 0, 165.0);
    assert_eq!(end.road_count, 3);
    let (at, heading) = network.suggest_pose();
    let pose = network.pose_on_lane_near(at).expect("lanes");
    assert_eq!((pose.road.as_str(), pose.lane), ("1", -5));
    assert!(same_heading(pose.heading_rad, heading, 0.01));
}

#[test]
fn suggested_places_are_on_a_lane_and_look_along_it() {
    for name in OWN {
        let network = own(name);
        let (at, heading) = network.suggest_pose();
        let import = network.to_layout(at, heading);
        assert!(
            layers_at(&import, 0.0, 0.0).contains(&BevLayer::DrivableArea),
            "{name}"
        );
        let pose = network.pose_on_lane_near(at).expect("lanes");
        assert!(
            pose.distance_m < 0.3,
            "{name}: {} m off the lane",
            pose.distance_m
        );
        assert!(same_heading(pose.heading_rad, heading, 0.02), "{name}");
        // Seen from there some lane centre runs through the ego vehicle, ahead.
        let through = lines(&import, PolylineKind::LaneCenter).iter().any(|line| {
            line.windows(2).any(|p| {
                let d = (p[1] - p[0]).normalize_or_zero();
                let along = (-p[0]).dot(d);
                along >= -0.1
                    && along <= p[0].distance(p[1]) + 0.1
                    && (p[0] + d * along).length() < 0.15
                    && d.x > 0.99
            })
        });
        assert!(through, "{name}");
    }
    let junction = own("four_arm_junction");
    let (at, _) = junction.suggest_pose();
    assert!(
        (at.length() - 28f64.hypot(1.75)).abs() < 1e-6,
        "12 m before the junction: {at}"
    );
    // A place off the road is taken to the nearest lane, with that lane's heading.
    let pose = own("straight_two_way")
        .pose_on_lane_near(DVec2::new(50.0, 9.0))
        .expect("lanes");
    assert!(same_heading(pose.heading_rad, PI, 1e-9) && pose.lane == 1);
    assert!((pose.position_m.y - 1.75).abs() < 1e-9 && (pose.position_m.x - 50.0).abs() < 0.3);
    assert_eq!(junction.pose_on_lane_near(DVec2::NAN), None);
    let nowhere = junction.to_layout(DVec2::NAN, 0.0);
    assert_eq!((nowhere.road_count, nowhere.drivable_share), (0, 0.0));
    let far = junction.to_layout(DVec2::splat(1e7), 1.0);
    assert_eq!((far.road_count, far.drivable_share), (0, 0.0));
}
