use glam::DVec2;
use scene::{BevLayer, Class, PolylineKind};

use super::commonroad::read;

fn lanelet(id: i64, left: &[[f64; 2]], right: &[[f64; 2]], more: &str) -> String {
    let points = |side: &[[f64; 2]]| -> String {
        side.iter()
            .map(|[x, y]| format!("<point><x>{x}</x><y>{y}</y></point>"))
            .collect()
    };
    format!(
        "<lanelet id=\"{id}\"><leftBound>{}</leftBound><rightBound>{}</rightBound>{more}</lanelet>\n",
        points(left),
        points(right)
    )
}

/// A street along y that meets one along x: one lane each way, a turn to the right, a sidewalk, a crossing, a stop line, an
/// obstacle.
pub(super) fn street() -> String {
    let up = [[0.0, 0.0], [0.0, 30.0]];
    let right = [[3.5, 0.0], [3.5, 30.0]];
    let on = |x: f64| [[x, 30.0], [x, 44.0]];
    let far = |x: f64| [[x, 44.0], [x, 90.0]];
    let left_side = [[-3.5, 90.0], [-3.5, 0.0]];
    let lanelets = [
        lanelet(
            1,
            &up,
            &right,
            "<successor ref=\"2\"/><successor ref=\"4\"/><adjacentLeft ref=\"6\" drivingDir=\"opposite\"/>\
             <stopLine><lineMarking>solid</lineMarking></stopLine><laneletType>urban</laneletType>",
        ),
        lanelet(
            2,
            &on(0.0),
            &on(3.5),
            "<predecessor ref=\"1\"/><successor ref=\"3\"/>",
        ),
        lanelet(3, &far(0.0), &far(3.5), "<predecessor ref=\"2\"/>"),
        lanelet(
            4,
            &[[0.0, 30.0], [1.0, 36.0], [4.0, 39.0], [10.0, 40.0]],
            &[[3.5, 30.0], [4.3, 34.0], [6.0, 36.0], [10.0, 36.5]],
            "<predecessor ref=\"1\"/><successor ref=\"5\"/>",
        ),
        lanelet(
            5,
            &[[10.0, 40.0], [60.0, 40.0]],
            &[[10.0, 36.5], [60.0, 36.5]],
            "<predecessor ref=\"4\"/>",
        ),
        lanelet(
            6,
            &[[0.0, 90.0], [0.0, 0.0]],
            &left_side,
            "<laneletType>urban</laneletType>",
        ),
        lanelet(
            7,
            &[[-6.0, 0.0], [-6.0, 90.0]],
            &[[-3.5, 0.0], [-3.5, 90.0]],
            "<laneletType>sidewalk</laneletType>",
        ),
        lanelet(
            8,
            &[[-3.5, 24.0], [3.5, 24.0]],
            &[[-3.5, 21.0], [3.5, 21.0]],
            "<laneletType>crosswalk</laneletType>",
        ),
    ];
    format!(
        "<?xml version='1.0'?>\n<commonRoad timeStepSize=\"0.1\" commonRoadVersion=\"2020a\" benchmarkID=\"ZAM_Own-1_1_T-1\">\n{}\
         <trafficSign id=\"90\"><trafficSignElement><trafficSignID>206</trafficSignID></trafficSignElement></trafficSign>\n\
         <dynamicObstacle id=\"91\"><type>truck</type><shape><rectangle><length>7.5</length><width>2.2</width></rectangle></shape>\
         <initialState><position><point><x>0.75</x><y>30.0</y></point></position><orientation><exact>1.6707963267948966</exact>\
         </orientation><velocity><exact>5</exact></velocity></initialState><trajectory/></dynamicObstacle>\n\
         <staticObstacle id=\"93\"><type>train</type></staticObstacle>\n\
         <planningProblem id=\"92\"><initialState><position><point><x>1.75</x><y>10.0</y></point></position><orientation>\
         <exact>1.5707963267948966</exact></orientation></initialState></planningProblem>\n</commonRoad>\n",
        lanelets.concat()
    )
}

#[test]
fn a_street_lies_where_it_is_seen_from_the_planning_problem() {
    let network = read(street().as_bytes(), "street").expect("roads");
    let (at_m, heading_rad) = network.suggest_pose();
    assert_eq!(
        (at_m, heading_rad),
        (DVec2::new(1.75, 10.0), std::f64::consts::FRAC_PI_2)
    );
    let layout = network.to_layout(at_m, heading_rad).layout;
    let at = |layer, x: f64, y: f64| {
        let [x, y] = layout.extent().column_at(x, y).expect("inside");
        layout.has(layer, x, y)
    };
    // y of the file is ahead, x of the file to the right.
    for (y, road, walk) in [
        (-1.5, true, false),
        (5.0, true, false),
        (6.0, false, true),
        (8.0, false, false),
    ] {
        assert_eq!(at(BevLayer::DrivableArea, 5.0, y), road, "{y}");
        assert_eq!(at(BevLayer::Walkway, 5.0, y), walk, "{y}");
    }
    assert!(at(BevLayer::DrivableArea, 28.0, -30.0), "the street to the right");
    assert!(at(BevLayer::PedCrossing, 12.5, 2.0) && !at(BevLayer::PedCrossing, 16.0, 2.0));
    let lines = |kind| layout.polylines.iter().filter(move |l| l.kind == kind);
    let stop = lines(PolylineKind::StopLine).next().expect("a stop line");
    assert!(
        stop.points_m.iter().all(|p| (p.x - 20.0).abs() < 0.01),
        "{stop:?}"
    );
    let divider = lines(PolylineKind::RoadDivider).next().expect("a divider");
    assert!(
        divider.points_m.iter().all(|p| (p.y - 1.75).abs() < 0.01),
        "{divider:?}"
    );
    assert_eq!(network.junctions.len(), 1);
    assert_eq!(network.junctions[0].incoming, ["1"]);
    // A truck 20 m ahead and 1 m to the left, turned a little to the left.
    let boxes = network.to_layout(at_m, heading_rad).boxes;
    let truck = boxes.values().next().expect("one box");
    assert_eq!((boxes.len(), truck.class), (1, Class::Truck));
    assert!(
        truck.center_m.truncate().distance(DVec2::new(20.0, 1.0)) < 1e-9,
        "{truck:?}"
    );
    assert_eq!(truck.size_m.truncate(), DVec2::new(7.5, 2.2));
    assert!((truck.yaw_rad - 0.1).abs() < 1e-9);
    assert!(truck.velocity_mps.distance(DVec2::from_angle(0.1) * 5.0) < 1e-9);
    assert_eq!(network.skipped.get("obstacle train"), Some(&1));
    assert_eq!(network.skipped.get("trafficSign"), Some(&1));
}

#[test]
fn bad_scenarios_are_one_line() {
    let whole = street();
    let line = |text: &str| {
        let line = read(text.as_bytes(), "bad").expect_err(text).to_string();
        assert!(line.chars().count() <= 300 && !line.contains('\n'), "{line}");
        line
    };
    assert!(line("<a/>").contains("expected <commonRoad>, found <a>"));
    assert!(line("<commonRoad/>").contains("no lanelet for traffic among 0"));
    assert!(line(&whole.replace("<x>3.5</x>", "<x>far</x>")).contains("expected a finite number"));
    assert!(line(&whole.replace("<x>3.5</x>", "")).contains("x: expected one element, found none"));
    assert!(line(&whole.replace("id=\"4\"", "id=\"four\"")).contains("expected a whole number"));
    for at in (0..whole.len() - 12).step_by(31) {
        line(&whole[..at]);
    }
}

/// The public scenarios, where they are there: `SCENELOOM_ROADS=folder`.
#[test]
#[ignore = "reads files of others"]
fn scenarios_of_others() {
    let folder = std::path::PathBuf::from(std::env::var("SCENELOOM_ROADS").expect("a folder"));
    let mut files: Vec<_> = std::fs::read_dir(folder.join("commonroad"))
        .expect("a folder")
        .map(|e| e.expect("an entry").path())
        .collect();
    files.sort();
    for path in files {
        let network = read(&std::fs::read(&path).expect("read"), "other").expect("roads");
        let (at_m, heading_rad) = network.suggest_pose();
        let import = network.to_layout(at_m, heading_rad);
        println!(
            "{}: at {at_m} {heading_rad:.2}, {} roads, {} lanes, {} junctions, {:?}",
            path.display(),
            network.roads.len(),
            import.lane_count,
            network.junctions.len(),
            network.skipped
        );
        assert!(import.drivable_share > 0.02 && import.lane_count > 1);
        if let Ok(out) = std::env::var("SCENELOOM_OUT") {
            let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
            crate::opendrive::write::picture(
                &std::path::Path::new(&out).join(stem + ".png"),
                &import.layout,
                &import.layout,
            );
        }
    }
}
