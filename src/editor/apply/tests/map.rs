//! Layers and lines.

use super::*;
use scene::PolylineKind;

#[test]
fn ground_replaces_other_ground_and_a_walkway_the_markings_too() {
    let mut scene = street();
    let line = Polyline {
        kind: PolylineKind::RoadDivider,
        points_m: vec![DVec2::new(-20.0, 0.1), DVec2::new(20.0, 0.1)],
    };
    let across = Shape::Rect {
        min_m: DVec2::new(-2.0, -8.0),
        max_m: DVec2::new(2.0, 8.0),
    };
    let paint = |layer| Edit::PaintBev {
        layer,
        shape: across.clone(),
        value: true,
    };
    let bits = |scene: &Scene| {
        let cells = across.cells(scene.frame().extent()).expect("inside");
        let of = |[x, y]: [usize; 2]| scene.frame().layout.cell(x, y);
        let all: Vec<u32> = cells.into_iter().map(of).collect();
        (
            all.iter().fold(u32::MAX, |a, b| a & b),
            all.iter().fold(0, |a, b| a | b),
        )
    };
    Edit::AddPolylines { lines: vec![line] }
        .apply(&mut scene)
        .expect("sound");
    paint(BevLayer::Walkway).apply(&mut scene).expect("inside");
    assert_eq!(bits(&scene), (BevLayer::Walkway.bit(), BevLayer::Walkway.bit()));
    let dividers = scene
        .frame()
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::RoadDivider);
    assert_eq!(dividers.count(), 2, "cut where people walk");
    for layer in [BevLayer::DrivableArea, BevLayer::CarparkArea] {
        paint(layer).apply(&mut scene).expect("inside");
        assert_eq!(bits(&scene), (layer.bit(), layer.bit()));
    }
    // Lines and crossings lie on the ground and replace nothing.
    paint(BevLayer::PedCrossing).apply(&mut scene).expect("inside");
    let both = BevLayer::PedCrossing.bit() | BevLayer::CarparkArea.bit();
    assert_eq!(bits(&scene), (both, both));
}

#[test]
fn painting_a_layer_lays_its_ground_and_lines_do_not() {
    let mut scene = street();
    let paint = |layer, x, y, value| Edit::PaintBev {
        layer,
        shape: Shape::Cells(vec![cell(x, y)]),
        value,
    };
    // A sidewalk with a kerb in bin 1 becomes road.
    let [x, y] = cell(0.1, 5.1);
    scene.change_canvas(|f| f.occupancy.set(x, y, 1, Class::Sidewalk.id()));
    paint(BevLayer::DrivableArea, 0.1, 5.1, true)
        .apply(&mut scene)
        .expect("inside");
    assert_eq!(
        scene.frame().occupancy.column(x, y)[..2],
        [Class::DriveableSurface.id(), FREE]
    );
    paint(BevLayer::DrivableArea, 0.1, 5.1, false)
        .apply(&mut scene)
        .expect("inside");
    // The walkway there was replaced: open ground is left.
    assert_eq!(label_at(&scene, 0.1, 5.1, 0), Class::Terrain.id());
    paint(BevLayer::DrivableArea, 0.1, 0.1, false)
        .apply(&mut scene)
        .expect("inside");
    assert_eq!(label_at(&scene, 0.1, 0.1, 0), Class::Terrain.id());
    paint(BevLayer::CarparkArea, 0.1, 0.1, true)
        .apply(&mut scene)
        .expect("inside");
    assert_eq!(label_at(&scene, 0.1, 0.1, 0), Class::DriveableSurface.id());
    // Under a car nothing changes in the voxels, but the layout does.
    paint(BevLayer::DrivableArea, 10.1, 1.7, false)
        .apply(&mut scene)
        .expect("inside");
    assert_eq!(label_at(&scene, 10.1, 1.7, 0), Class::Car.id());
    let [x, y] = cell(10.1, 1.7);
    assert!(!scene.frame().layout.has(BevLayer::DrivableArea, x, y));
    // Lines and crossings lie on the ground.
    let occupancy = scene.frame().occupancy.clone();
    for layer in [
        BevLayer::LaneDivider,
        BevLayer::PedCrossing,
        BevLayer::StopLine,
        BevLayer::RoadDivider,
        BevLayer::RoadBlock,
    ] {
        paint(layer, 5.1, 15.1, true).apply(&mut scene).expect("inside");
        let [x, y] = cell(5.1, 15.1);
        assert!(scene.frame().layout.has(layer, x, y));
    }
    assert_eq!(scene.frame().occupancy, occupancy);
}

#[test]
fn lines_bring_the_cells_of_their_layer_and_bad_ones_are_named() {
    let text = r#"{"add_polylines": {"lines": [
        {"kind": "lane_center", "points_m": [[-10, 2], [10, 2]]},
        {"kind": "road_divider", "points_m": [[-10, 0.2], [10, 0.2]]}]}}"#;
    let edit: Edit = serde_json::from_str(text).expect("known keys");
    let again: Edit = serde_json::from_str(&serde_json::to_string(&edit).expect("JSON")).expect("JSON");
    assert_eq!(again, edit);
    let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
    let mut scene = Scene::single("lines", frame, Arc::default(), 1);
    let before = scene.rev;
    edit.apply(&mut scene).expect("sound");
    assert_ne!(scene.rev, before);
    let layout = &scene.frame().layout;
    assert_eq!(layout.polylines.len(), 2);
    // 20 m of cells, and perhaps one more at either end.
    assert!((50..=52).contains(&layout.count(BevLayer::RoadDivider)));
    assert_eq!(layout.count(BevLayer::DrivableArea), 0);
    let refused = |lines: Vec<Polyline>, scene: &mut Scene| {
        let error = Edit::AddPolylines { lines }.apply(scene).expect_err("bad");
        error.to_string()
    };
    let line = |points_m| Polyline {
        kind: scene::PolylineKind::StopLine,
        points_m,
    };
    assert_eq!(
        refused(vec![], &mut scene),
        "lines holds 0 entries, expected at least 1"
    );
    assert_eq!(
        refused(vec![line(vec![DVec2::ZERO])], &mut scene),
        "points_m holds 1 entries, expected at least 2"
    );
    for bad in [f64::NAN, f64::INFINITY, 1e9] {
        let text = refused(vec![line(vec![DVec2::ZERO, DVec2::new(bad, 0.0)])], &mut scene);
        assert!(text.ends_with("expected finite numbers within 10000 m"), "{text}");
    }
    assert_eq!(scene.frame().layout.polylines.len(), 2);
    // As a correction the source has them too, and no voxel changes.
    let mut corrected = Scene::single(
        "lines",
        Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new()),
        Arc::default(),
        1,
    );
    let correct = Edit::Correct { edit: Box::new(edit) };
    correct.apply(&mut corrected).expect("sound");
    assert_eq!(corrected.frame().layout, corrected.frame().source.layout);
    assert_eq!(corrected.frame().layout.polylines.len(), 2);
}
