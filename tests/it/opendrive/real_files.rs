//! Every real file at hand: counts as measured in the data folder's own table, and ground under the suggested place.

use formats::opendrive::geometry::CurveShape;
use formats::opendrive::objects::{ObjectKind, RoadObject};
use formats::opendrive::standing::RoadsideObject;
use formats::opendrive::{self, RoadNetwork};
use glam::DVec2;
use scene::BevLayer;

use super::{data_dir, layers_at};

/// name, [roads, in junctions, junctions, line, arc, spiral, paramPoly3, signals, objects, sections, lanes], km.
const TABLE: [(&str, [usize; 11], f64); 15] = [
    ("fabriksgatan", [16, 12, 1, 0, 8, 0, 16, 0, 0, 16, 44], 0.688),
    ("e6mini", [1, 0, 0, 1, 0, 0, 16, 0, 6, 1, 14], 1.464),
    ("soderleden", [5, 0, 1, 0, 1, 0, 16, 0, 0, 7, 33], 1.888),
    ("curves_elevation", [1, 0, 0, 2, 4, 7, 0, 0, 0, 1, 6], 1.154),
    ("velodrome", [1, 0, 0, 2, 2, 4, 0, 0, 0, 1, 3], 2.000),
    (
        "multi_intersections",
        [63, 42, 5, 95, 32, 56, 0, 127, 0, 63, 242],
        3.508,
    ),
    ("parking_demo", [7, 3, 1, 5, 1, 6, 0, 0, 12, 7, 32], 0.320),
    ("straight_500m_signs", [1, 0, 0, 1, 0, 0, 0, 19, 15, 1, 6], 0.500),
    ("tunnels", [2, 0, 0, 5, 4, 8, 0, 0, 3, 2, 14], 0.880),
    (
        "highway_example_with_merge_and_split",
        [9, 4, 2, 2, 3, 8, 0, 0, 0, 13, 53],
        0.760,
    ),
    (
        "lane_offset_intersection",
        [10, 6, 1, 4, 0, 18, 0, 2, 0, 10, 25],
        0.251,
    ),
    (
        "simple_3way_intersection_lht",
        [6, 3, 1, 3, 3, 6, 0, 0, 0, 6, 12],
        0.342,
    ),
    ("Ex_Entry_Exit", [6, 0, 2, 6, 16, 15, 0, 0, 0, 11, 48], 1.674),
    ("Town01", [98, 72, 12, 240, 112, 0, 0, 0, 0, 176, 306], 3.923),
    ("Town03", [279, 185, 34, 718, 358, 0, 0, 0, 0, 617, 1912], 9.142),
];

fn counts(network: &RoadNetwork) -> [usize; 11] {
    let records = || network.roads.iter().flat_map(|r| r.reference.records());
    let of_kind = |kind: fn(&CurveShape) -> bool| records().filter(|g| kind(g.shape())).count();
    let sections = || network.roads.iter().flat_map(|r| &r.sections);
    let skipped = |prefix: &str| -> usize {
        network
            .skipped
            .iter()
            .filter(|(kind, _)| kind.starts_with(prefix))
            .map(|(_, n)| n)
            .sum()
    };
    // In these files all stop lines are signals.
    let is_signal = |o: &&RoadObject| {
        matches!(
            o.kind,
            ObjectKind::StopLine { .. } | ObjectKind::Standing(RoadsideObject::Signal(_))
        )
    };
    let placed = |signal: bool| -> usize {
        let objects = network.roads.iter().flat_map(|r| &r.objects);
        objects.filter(|o| is_signal(o) == signal).count()
    };
    [
        network.roads.len(),
        network.roads.iter().filter(|r| r.junction.is_some()).count(),
        network.junctions.len(),
        of_kind(|s| matches!(s, CurveShape::Line)),
        of_kind(|s| matches!(s, CurveShape::Arc { .. })),
        of_kind(|s| matches!(s, CurveShape::Spiral { .. })),
        of_kind(|s| matches!(s, CurveShape::ParamPoly3 { .. })),
        skipped("signal") + placed(true),
        skipped("object ") + placed(false),
        sections().count(),
        sections().map(|s| s.lane_count()).sum(),
    ]
}

#[test]
fn every_real_file_imports() {
    let Some(dir) = data_dir() else {
        println!("no real road files here (../shared/data or SCENELOOM_DATA): skipped");
        return;
    };
    for (name, expected, km) in TABLE {
        let bytes = std::fs::read(dir.join(format!("{name}.xodr"))).unwrap_or_else(|e| panic!("{name}: {e}"));
        let network = opendrive::read(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(counts(&network), expected, "{name}");
        let length_km = network.length_m() / 1000.0;
        assert!((length_km - km).abs() < 0.0011, "{name}: {length_km} km");
        assert_eq!(network.skipped.get("gap in the reference line"), None, "{name}");
        let (at, heading) = network.suggest_pose();
        let import = network.to_layout(at, heading);
        assert!(
            layers_at(&import, 0.0, 0.0).contains(&BevLayer::DrivableArea),
            "{name}: not on a road"
        );
        assert!(
            import.drivable_share > 0.05 && import.drivable_share < 0.6,
            "{name}: {}",
            import.drivable_share
        );
        assert!(import.lane_count >= 2, "{name}");
        let pose = network.pose_on_lane_near(at).expect("lanes");
        assert!(pose.distance_m < 0.3, "{name}: {}", pose.distance_m);
        assert_eq!(import.background.problem(), None, "{name}");
        assert!(import.layout.relief.height_m(DVec2::ZERO).abs() < 1e-3, "{name}");
        // The same window twice is the same to the bit.
        assert_eq!(import, network.to_layout(at, heading), "{name}");
    }
    let files = std::fs::read_dir(&dir).expect("a folder").count();
    assert_eq!(files, TABLE.len(), "a file without a row in the table");
}
