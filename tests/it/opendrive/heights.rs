//! Elevation, superelevation, lane heights and roads above one another: against heights computed by hand.

use formats::opendrive::{self, LayoutImport, RoadNetwork};
use glam::DVec2;
use scene::{BevLayer, Form, PolylineKind, Relief};

use super::{data_dir, layers_at, own, window_at};

/// A straight road of one lane of 3.5 m on each side; what is inside its elements is added.
fn road(id: &str, at: [f64; 3], length: f64, profiles: &str, lane: &str) -> String {
    let [x, y, heading] = at;
    let lane = |id: i32| {
        format!(
            r#"<lane id="{id}" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>{lane}</lane>"#
        )
    };
    format!(
        r#"<road id="{id}" length="{length}" junction="-1"><planView>
        <geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="{length}"><line/></geometry></planView>
        {profiles}<lanes><laneSection s="0"><left>{}</left><center><lane id="0" type="none"/></center>
        <right>{}</right></laneSection></lanes></road>"#,
        lane(1),
        lane(-1)
    )
}

fn network(roads: &[String]) -> RoadNetwork {
    let text = format!("<OpenDRIVE>{}</OpenDRIVE>", roads.concat());
    opendrive::read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
}

fn elevation(records: &[[f64; 5]]) -> String {
    let record =
        |[s, a, b, c, d]: &[f64; 5]| format!(r#"<elevation s="{s}" a="{a}" b="{b}" c="{c}" d="{d}"/>"#);
    let records: String = records.iter().map(record).collect();
    format!("<elevationProfile>{records}</elevationProfile>")
}

fn superelevation(rad: f64) -> String {
    format!(r#"<lateralProfile><superelevation s="0" a="{rad}" b="0" c="0" d="0"/></lateralProfile>"#)
}

fn height(import: &LayoutImport, x: f64, y: f64) -> f64 {
    import.layout.relief.height_m(DVec2::new(x, y))
}

#[test]
fn a_crest_has_the_heights_of_its_polynomial() {
    let profile = elevation(&[[0.0, 100.0, 0.04, 0.0, 0.0], [100.0, 104.0, 0.04, -0.001, 0.0]]);
    let network = network(&[road("1", [500.0, -300.0, 0.7], 200.0, &profile, "")]);
    let import = window_at(&network, 0, 110.0);
    // At s = 110: 104 + 0.4 - 0.1 = 104.3; at 140: 104 + 1.6 - 1.6 = 104; at 90: 103.6.
    for (x, expected) in [(30.0, -0.3), (0.0, 0.0), (-20.0, -0.7), (20.0, 0.0)] {
        let got = height(&import, x, 0.0);
        assert!((got - expected).abs() < 0.002, "{x}: {got}");
        // Beside the road the ground goes on at about that height.
        let beside = height(&import, x, 8.0);
        assert!((beside - expected).abs() < 0.3, "{x}: {beside} beside");
    }
    assert!(import.skipped.is_empty(), "{:?}", import.skipped);
    assert!(import.background.is_empty());
}

#[test]
fn superelevation_tilts_and_narrows() {
    let network = network(&[road("1", [0.0; 3], 200.0, &superelevation(-0.3), "")]);
    let import = window_at(&network, 0, 100.0);
    // The left side is lower by 2 tan 0.3.
    let (left, right) = (height(&import, 10.0, 2.0), height(&import, 10.0, -2.0));
    assert!((left + 2.0 * 0.3f64.tan()).abs() < 0.01, "{left}");
    assert!((right - 2.0 * 0.3f64.tan()).abs() < 0.01, "{right}");
    // Lanes of 3.5 m on the slope are 3.34 m wide in the plan: their middle shows it.
    let center = import
        .layout
        .polylines
        .iter()
        .find(|l| l.kind == PolylineKind::LaneCenter);
    let y = center.expect("a lane").points_m[0].y.abs();
    assert!((y - 1.75 * 0.3f64.cos()).abs() < 1e-6, "{y}");
}

#[test]
fn crossfall_lets_both_sides_drop() {
    let profile =
        r#"<lateralProfile><crossfall side="both" s="0" a="0.05" b="0" c="0" d="0"/></lateralProfile>"#;
    let network = network(&[road("1", [0.0; 3], 200.0, profile, "")]);
    let import = window_at(&network, 0, 100.0);
    for side in [-1.0, 1.0] {
        let drop = height(&import, 5.0, side) - height(&import, 5.0, 3.0 * side);
        assert!((drop - 2.0 * 0.05f64.tan()).abs() < 0.002, "{side}: {drop}");
    }
}

#[test]
fn raised_lanes_are_relief_and_kerbs_are_not() {
    let kerb = r#"<height sOffset="0" inner="0.12" outer="0.15"/>"#;
    let flat = window_at(&network(&[road("1", [0.0; 3], 200.0, "", kerb)]), 0, 100.0);
    assert!(flat.layout.relief.is_flat(), "worlds draw kerbs by themselves");
    let ramp = r#"<height sOffset="0" inner="0.25" outer="1.65"/>"#;
    let raised = window_at(&network(&[road("1", [0.0; 3], 200.0, "", ramp)]), 0, 100.0);
    // From the kerb's height up, 0.4 m per metre.
    let rise = height(&raised, 3.0, 3.0) - height(&raised, 3.0, 1.0);
    assert!((rise - 0.8).abs() < 0.01, "{rise}");
}

#[test]
fn level_roads_are_flat_wherever_they_lie() {
    let high = elevation(&[[0.0, 412.5, 0.0, 0.0, 0.0]]);
    let of = |profile: &str| window_at(&network(&[road("1", [0.0; 3], 200.0, profile, "")]), 0, 60.0);
    let (plain, raised) = (of(""), of(&high));
    assert!(raised.layout.relief.is_flat());
    assert_eq!(plain.layout, raised.layout);
    for name in super::OWN.into_iter().filter(|n| *n != "every_geometry") {
        assert!(window_at(&own(name), 0, 10.0).layout.relief.is_flat(), "{name}");
    }
}

/// One road along x at 0 and one along y at `height`, crossing at the origin.
fn crossing(height: f64) -> RoadNetwork {
    let above = elevation(&[[0.0, height, 0.0, 0.0, 0.0]]);
    network(&[
        road("low", [-100.0, 0.0, 0.0], 200.0, "", ""),
        road(
            "high",
            [0.0, -100.0, std::f64::consts::FRAC_PI_2],
            200.0,
            &above,
            "",
        ),
    ])
}

#[test]
fn the_upper_road_is_a_bridge_over_the_ego() {
    let import = crossing(6.0).to_layout(DVec2::new(-20.0, -1.75), 0.0);
    assert_eq!(import.bridge_count, 1, "{:?}", import.background);
    let bridge = import.background.iter().find_map(|t| match &t.form {
        Form::Bridge(b) => Some(b.clone()),
        _ => None,
    });
    let bridge = bridge.expect("counted");
    assert!(bridge.for_vehicles);
    assert!((bridge.height_m - 6.0).abs() < 0.05, "{bridge:?}");
    assert!((bridge.width_m - 7.0).abs() < 1e-9);
    // 7 m of road below and 3 m of abutment on each side, in steps.
    let (a, b) = (bridge.points_m[0], bridge.points_m[bridge.points_m.len() - 1]);
    assert!(
        (a.distance(b) - 13.0).abs() < 1.0 && (a.x - 20.0).abs() < 0.1,
        "{a} {b}"
    );
    // Below it the road goes on, on the ground, with its lanes; above, no line crosses it.
    assert_eq!(layers_at(&import, 20.0, 0.0), [BevLayer::DrivableArea]);
    assert!(height(&import, 20.0, 0.0).abs() < 0.01);
    assert!(height(&import, 20.0, 30.0) > 5.9, "the ramp beside it");
    for line in import.layout.polylines.iter() {
        let mut on_road = line.points_m.iter().filter(|p| (p.y - 1.75).abs() < 3.0);
        let along = (line.points_m[1] - line.points_m[0]).normalize();
        assert!(on_road.next().is_none() || along.x.abs() > 0.9, "{line:?}");
    }
    assert_eq!(import.road_count, 2);
}

#[test]
fn the_ego_on_the_upper_road_stays_on_the_ground() {
    let import = crossing(6.0).to_layout(DVec2::new(1.75, -20.0), std::f64::consts::FRAC_PI_2);
    assert_eq!(import.bridge_count, 0);
    let line = "road below the ego's road (left out there)";
    assert_eq!(import.skipped.get(line), Some(&1), "{:?}", import.skipped);
    assert!(height(&import, 20.0, 0.0).abs() < 0.01, "the ego's road");
    assert!(height(&import, 20.0, 30.0) < -5.9, "the other road beside it");
    assert_eq!(layers_at(&import, 20.0, 0.0), [BevLayer::DrivableArea]);
    let lanes = import
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    assert_eq!(
        lanes.count(),
        6,
        "two of the ego's road, the other's two cut in two"
    );
}

#[test]
fn roads_at_one_height_cross_on_the_ground() {
    for height_m in [0.0, 2.0] {
        let import = crossing(height_m).to_layout(DVec2::new(-20.0, -1.75), 0.0);
        assert_eq!(import.bridge_count, 0, "{height_m}");
        let lanes = import
            .layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter);
        assert_eq!(lanes.count(), 4);
    }
}

#[test]
fn bad_profiles_are_said_and_bounded() {
    let said = |profile: &str| {
        let network = network(&[road("1", [0.0; 3], 200.0, profile, "")]);
        for s in [0.0, 50.0, 150.0] {
            let import = window_at(&network, 0, s);
            let heights = import.layout.relief.heights_m().unwrap_or_default();
            assert!(heights.iter().all(|h| h.abs() <= Relief::LIMIT_M), "{profile}");
        }
        network.skipped.keys().cloned().collect::<Vec<_>>()
    };
    let zero = [0.0; 5];
    assert_eq!(said(&elevation(&[zero, [60.0, 0.0, 0.02, 0.0, 0.0]])), [""; 0]);
    assert_eq!(
        said(&elevation(&[zero, [60.0, 5.0, 0.0, 0.0, 0.0]])),
        ["jump in the elevation"]
    );
    assert_eq!(
        said(&elevation(&[
            [60.0, 1.2, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.02, 0.0, 0.0]
        ])),
        ["elevation records out of order (sorted)"]
    );
    assert_eq!(
        said(&elevation(&[[-30.0, 0.0, 0.01, 0.0, 0.0]])),
        ["elevation that begins before its road"]
    );
    assert_eq!(
        said(&elevation(&[[0.0, 1e300, -1e300, 1e300, 1e300]])),
        ["elevation beyond 10000 m (cut)"]
    );
    assert_eq!(
        said(&elevation(&[[0.0, 0.0, 1e6, 0.0, 0.0]])),
        ["elevation beyond 10000 m (cut)"]
    );
    assert!(said(&superelevation(1e12)).is_empty());
    for bad in ["NaN", "inf", "high", ""] {
        let profile = elevation(&[zero]).replace("b=\"0\"", &format!("b=\"{bad}\""));
        let text = format!(
            "<OpenDRIVE>{}</OpenDRIVE>",
            road("1", [0.0; 3], 200.0, &profile, "")
        );
        let line = opendrive::read(text.as_bytes()).expect_err(bad).to_string();
        assert!(line.contains("elevation 1") && line.contains("finite"), "{line}");
    }
    let side = r#"<lateralProfile><crossfall side="up" s="0" a="0" b="0" c="0" d="0"/></lateralProfile>"#;
    let text = format!("<OpenDRIVE>{}</OpenDRIVE>", road("1", [0.0; 3], 200.0, side, ""));
    let line = opendrive::read(text.as_bytes()).expect_err("side").to_string();
    assert!(line.contains("left, right or both"), "{line}");
}

#[test]
fn real_roads_climb_as_their_files_say() {
    let Some(dir) = data_dir() else {
        println!("no real road files here (../shared/data or SCENELOOM_DATA): skipped");
        return;
    };
    let read = |name: &str| {
        let bytes = std::fs::read(dir.join(format!("{name}.xodr"))).unwrap_or_else(|e| panic!("{name}: {e}"));
        opendrive::read(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let curves = read("curves_elevation");
    let import = window_at(&curves, 0, 620.0);
    let here = curves.roads[0].reference.at(620.0);
    // The cubic of the file, evaluated elsewhere.
    let expected = [
        (590.0, 0.886_772_690_409_841_9),
        (600.0, 0.712_321_330_502_851_1),
        (630.0, -0.452_361_485_518_469_66),
        (650.0, -1.335_717_294_967_468),
    ];
    for (s, expected_m) in expected {
        let there = curves.roads[0].reference.at(s).position_m - here.position_m;
        let p = DVec2::from_angle(-here.heading_rad).rotate(there);
        let got = import.layout.relief.height_m(p);
        assert!((got - expected_m).abs() < 0.01, "{s}: {got} for {expected_m}");
    }
    for name in ["Town01", "fabriksgatan", "soderleden", "lane_offset_intersection"] {
        let network = read(name);
        let (at, heading) = network.suggest_pose();
        assert!(network.to_layout(at, heading).layout.relief.is_flat(), "{name}");
    }
}
