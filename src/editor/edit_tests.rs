//! Tests of single edits: their JSON, their immediate voxels, their errors.

use serde_json::{Value, json};

use super::*;
use scene::draft::draft;
use scene::{BevLayout, SensorRig, TimeOfDay, Weather};

#[path = "edit_errors_tests.rs"]
mod errors;

const FREE: u8 = Class::FREE;

/// A road along x (|y| < 4 m) with sidewalks (to 7 m), drafted; a car ahead, another beside it.
fn street() -> Scene {
    let mut layout = BevLayout::default();
    for x in 0..GridSpec::NX {
        for y in 0..GridSpec::NY {
            let side_m = GridSpec::center(x, y, 0).y.abs();
            layout.set(BevLayer::DrivableArea, x, y, side_m < 4.0);
            layout.set(BevLayer::Walkway, x, y, (4.0..7.0).contains(&side_m));
        }
    }
    let boxes = [car(1, 10.0, 1.6), car(2, 10.0, -1.6)].map(|b| (b.id, b));
    let boxes: BTreeMap<_, _> = boxes.into();
    let occupancy = draft(&layout, boxes.values());
    let frame = Frame::new(layout, boxes, occupancy);
    Scene::single("street", frame, Arc::new(SensorRig::default()), 0)
}

fn car(id: u32, x: f64, y: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn label_at(scene: &Scene, x: f64, y: f64, z: usize) -> u8 {
    let [x, y] = GridSpec::column_at(x, y).expect("inside");
    scene.frame().occupancy.get(x, y, z)
}

fn cars(scene: &Scene) -> usize {
    scene.frame().occupancy.class_counts()[Class::Car as usize]
}

fn cell(x: f64, y: f64) -> [usize; 2] {
    GridSpec::column_at(x, y).expect("inside")
}

fn parse(value: Value) -> Result<Edit, String> {
    serde_json::from_value(value).map_err(|e| e.to_string())
}

/// The forms that the command line documents, there and back.
#[test]
fn json_forms_are_those_of_the_command_line() {
    let list = json!([
        {"remove_box": {"id": 7}},
        {"add_box": {"class": "traffic_cone", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": 0}},
        {"paint_bev": {"layer": "drivable_area", "shape": {"disc": {"center_m": [3, -6], "radius_m": 2}}, "value": true}},
        {"paint_voxels": {"cells": [[100, 90, 3]], "class": "barrier"}},
        {"set_prompt": {"prompt": "night, rain"}},
    ]);
    let edits: Vec<Edit> = serde_json::from_value(list).expect("the documented forms");
    assert_eq!(
        edits,
        vec![
            Edit::RemoveBox { id: BoxId(7) },
            Edit::AddBox {
                class: Class::TrafficCone,
                center_m: DVec3::new(8.0, 0.5, 0.4),
                size_m: DVec3::new(0.5, 0.5, 0.8),
                yaw_deg: 0.0,
                velocity_mps: None,
                id: None,
                label: Default::default(),
            },
            Edit::PaintBev {
                layer: BevLayer::DrivableArea,
                shape: Shape::Disc {
                    center_m: DVec2::new(3.0, -6.0),
                    radius_m: 2.0
                },
                value: true,
            },
            Edit::PaintVoxels {
                cells: vec![[100, 90, 3]],
                class: Class::Barrier
            },
            Edit::SetPrompt {
                prompt: "night, rain".into()
            },
        ]
    );
    // Every form, written exactly so and read back the same.
    for form in [
        json!({"remove_box": {"id": 7}}),
        json!({"add_box": {"class": "bus", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": -30.5}}),
        json!({"add_box": {"class": "bus", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": 1.0, "velocity_mps": [1.0, 2.0], "id": 9}}),
        json!({"move_box": {"id": 3, "center_m": [1.0, 2.0, 3.0]}}),
        json!({"move_box": {"id": 3, "yaw_deg": 90.0, "size_m": [1.0, 2.0, 3.0]}}),
        json!({"set_box_class": {"id": 3, "class": "truck"}}),
        json!({"label_box": {"id": 3, "label": {"name": "taxi", "paint": "yellow"}}}),
        json!({"label_box": {"id": 3, "label": {}}}),
        json!({"paint_bev": {"layer": "walkway", "shape": {"rect": {"min_m": [0.0, 1.0], "max_m": [2.0, 3.0]}}, "value": false}}),
        json!({"paint_bev": {"layer": "lane_divider", "shape": {"polygon": {"points_m": [[0.0, 1.0], [2.0, 3.0], [0.0, 4.0]]}}, "value": true}}),
        json!({"paint_bev": {"layer": "carpark_area", "shape": {"line": {"points_m": [[0.0, 1.0], [2.0, 3.0]], "width_m": 0.5}}, "value": true}}),
        json!({"paint_bev": {"layer": "ped_crossing", "shape": {"cells": [[1, 2], [3, 4]]}, "value": true}}),
        json!({"paint_voxels": {"cells": [[1, 2, 3]], "class": "free"}}),
        json!({"unlock_voxels": {"cells": [[1, 2, 3]]}}),
        json!({"clear_paint": {}}),
        json!({"set_prompt": {"prompt": ""}}),
        json!({"keep_words": {"words": "remove the bus"}}),
        json!({"set_conditions": {"conditions": {"time": "night", "weather": "rain", "wetness": 0.5, "visibility_m": 400.0,
            "sun": {"azimuth_deg": 20.0, "elevation_deg": 30.0}, "seed": 3}}}),
    ] {
        let edit = parse(form.clone()).expect("a documented form");
        assert_eq!(serde_json::to_value(&edit).expect("plain data"), form);
    }
}

#[test]
fn json_that_is_wrong_is_refused_by_name() {
    let refusal = |value: Value| {
        let text = parse(value).expect_err("refused");
        assert!(!text.contains('\n'));
        text
    };
    let text = refusal(json!({"remove_box": {"id": 7, "colour": 1}}));
    assert!(text.contains("unknown field `colour`"), "{text}");
    let text = refusal(json!({"paint_bev": {"layer": "walkway", "value": true,
        "shape": {"disc": {"center_m": [0, 0], "radius_m": 1, "radius": 2}}}}));
    assert!(text.contains("unknown field `radius`"), "{text}");
    let text = refusal(json!({"explode_box": {"id": 7}}));
    assert!(text.contains("unknown variant `explode_box`"), "{text}");
    let text = refusal(json!({"move_box": {"yaw_deg": 3}}));
    assert!(text.contains("missing field `id`"), "{text}");
    let text = refusal(json!({"paint_voxels": {"cells": [[1, 2, -3]], "class": "car"}}));
    assert!(text.contains("-3"), "{text}");
    let text = refusal(json!({"adopt_result": {"occupancy": []}}));
    assert!(text.contains("unknown variant `adopt_result`"), "{text}");
    let text = refusal(json!({"clear_paint": {"x": 1}}));
    assert!(text.contains("unknown field `x`"), "{text}");
}

#[test]
fn removing_a_car_leaves_road_and_the_neighbour() {
    let mut scene = street();
    let before = cars(&scene);
    let source = scene.frame().source.clone();
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert!(!scene.frame().boxes.contains_key(&BoxId(1)));
    assert_eq!(cars(&scene) * 2, before, "one of two equal cars is left, whole");
    assert_eq!(label_at(&scene, 10.1, 1.7, 0), Class::DriveableSurface.id());
    assert_eq!(label_at(&scene, 10.1, 1.7, 3), FREE);
    assert_eq!(label_at(&scene, 10.1, -1.7, 3), Class::Car.id());
    assert!(
        Arc::ptr_eq(&source, &scene.frame().source),
        "edits leave the source"
    );
    Edit::RemoveBox { id: BoxId(2) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(cars(&scene), 0);
    let layout = scene.frame().layout.clone();
    assert_eq!(
        scene.frame().occupancy,
        draft(&layout, std::iter::empty()),
        "with both gone the street is as drafted without them"
    );
}

#[test]
fn a_hole_without_layout_continues_the_ground_around() {
    let mut scene = street();
    let frame = scene.frame_mut();
    frame.layout = BevLayout::default(); // nothing says what the ground is; the voxels still do
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(label_at(&scene, 10.1, 1.7, 0), Class::DriveableSurface.id());
    // In the middle of nowhere it becomes terrain.
    let lost = car(1, -20.0, 20.0);
    let mut grid = VoxelGrid::new();
    let [x, y] = cell(-20.0, 20.0);
    grid.set(x, y, 0, Class::Car.id());
    let frame = Frame::new(BevLayout::default(), [(lost.id, lost)].into(), grid);
    let mut scene = Scene::single("nowhere", frame, Arc::new(SensorRig::default()), 0);
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(scene.frame().occupancy.count_set(), 1);
    assert_eq!(scene.frame().occupancy.get(x, y, 0), Class::Terrain.id());
}

#[test]
fn boxes_that_overlap_keep_their_voxels() {
    let mut scene = street();
    // A third car shares half its place with the first.
    let add = |x: f64, id: u32| Edit::AddBox {
        class: Class::Car,
        center_m: DVec3::new(x, 1.6, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(BoxId(id)),
        label: Default::default(),
    };
    add(12.0, 3).apply(&mut scene).expect("sound");
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(
        label_at(&scene, 11.3, 1.7, 2),
        Class::Car.id(),
        "shared place stays"
    );
    assert_eq!(label_at(&scene, 8.3, 1.7, 2), FREE, "own place goes");
}

#[test]
fn adding_stamps_and_moving_is_removing_and_adding() {
    let mut scene = street();
    let add = Edit::AddBox {
        class: Class::Pedestrian,
        center_m: DVec3::new(-5.0, 5.0, 0.9),
        size_m: DVec3::new(0.7, 0.7, 1.8),
        yaw_deg: 45.0,
        velocity_mps: Some(DVec2::new(1.0, 0.0)),
        id: None,
        label: Default::default(),
    };
    add.apply(&mut scene).expect("sound");
    let b = scene.frame().boxes[&BoxId(3)];
    assert_eq!(b.velocity_mps, DVec2::new(1.0, 0.0));
    assert!((b.yaw_rad - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    assert_eq!(label_at(&scene, -5.0, 5.0, 0), Class::Pedestrian.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 6), Class::Pedestrian.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 8), FREE);
    let moved = Edit::MoveBox {
        id: BoxId(3),
        center_m: Some(DVec3::new(-5.0, -5.0, 0.9)),
        yaw_deg: None,
        size_m: None,
    };
    moved.apply(&mut scene).expect("is there");
    assert_eq!(
        scene.frame().boxes[&BoxId(3)].yaw_rad,
        b.yaw_rad,
        "what is left out stays"
    );
    assert_eq!(label_at(&scene, -5.0, 5.0, 0), Class::Sidewalk.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 4), FREE);
    assert_eq!(label_at(&scene, -5.0, -5.0, 4), Class::Pedestrian.id());
    Edit::SetBoxClass {
        id: BoxId(3),
        class: Class::Barrier,
    }
    .apply(&mut scene)
    .expect("is there");
    assert_eq!(label_at(&scene, -5.0, -5.0, 4), Class::Barrier.id());
    assert_eq!(
        scene.frame().occupancy.class_counts()[Class::Pedestrian as usize],
        0
    );
}

#[test]
fn a_box_put_into_a_hedge_and_taken_out_leaves_the_hedge() {
    let mut scene = street();
    let frame = scene.frame_mut();
    for x in 100..110 {
        frame.occupancy.column_mut(x, 130)[..4].fill(Class::Vegetation.id());
    }
    *frame = Frame::new(frame.layout.clone(), frame.boxes.clone(), frame.occupancy.clone());
    let before = frame.occupancy.clone();
    let mut put = car(9, 0.0, 0.0);
    put.center_m.x = 2.0;
    put.center_m.y = GridSpec::center(100, 130, 0).y;
    Edit::AddBox {
        class: put.class,
        center_m: put.center_m,
        size_m: put.size_m,
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(put.id),
        label: Default::default(),
    }
    .apply(&mut scene)
    .expect("sound");
    assert!(scene.frame().occupancy.count_different(&before) > 100);
    Edit::RemoveBox { id: put.id }.apply(&mut scene).expect("there");
    assert_eq!(scene.frame().occupancy, before);
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
    scene.frame_mut().occupancy.set(x, y, 1, Class::Sidewalk.id());
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
    assert_eq!(label_at(&scene, 0.1, 5.1, 0), Class::Sidewalk.id());
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
fn a_label_is_no_work_for_the_networks_and_goes_with_the_class() {
    let mut scene = street();
    let before = scene.frame().clone();
    let label = scene::BoxLabel {
        name: BoxName::new("taxi"),
        paint: Some(scene::Paint::Yellow),
    };
    let id = BoxId(1);
    let edit = Edit::LabelBox { id, label };
    edit.apply(&mut scene).expect("box 1 is there");
    let frame = scene.frame();
    assert_eq!(frame.boxes[&id].called(), "yellow taxi");
    assert_eq!(frame.occupancy, before.occupancy);
    assert_eq!(frame.boxes, frame.source.boxes, "nothing waits to be generated");
    let class = Class::Truck;
    Edit::SetBoxClass { id, class }
        .apply(&mut scene)
        .expect("a class of objects");
    assert_eq!(scene.frame().boxes[&id].called(), "yellow truck");
    let nobody = Edit::LabelBox { id: BoxId(99), label };
    assert!(matches!(
        nobody.apply(&mut scene),
        Err(EditError::UnknownBox { .. })
    ));
}

#[test]
fn painted_voxels_are_locked() {
    let mut scene = street();
    let source = scene.frame().source.clone();
    let [x, y] = cell(10.1, 1.7);
    let paint = |z, class| Edit::PaintVoxels {
        cells: vec![[x, y, z]],
        class,
    };
    paint(3, Class::Free).apply(&mut scene).expect("inside");
    paint(12, Class::Car).apply(&mut scene).expect("inside");
    paint(0, Class::Manmade).apply(&mut scene).expect("inside");
    let column = |scene: &Scene| *scene.frame().occupancy.column(x, y);
    assert_eq!(column(&scene)[3], FREE);
    // Neither stamping nor clearing nor ground touches them.
    let nudge = |dx: f64| Edit::MoveBox {
        id: BoxId(1),
        center_m: Some(DVec3::new(10.0 + dx, 1.6, 0.85)),
        yaw_deg: None,
        size_m: None,
    };
    nudge(0.2).apply(&mut scene).expect("is there");
    assert_eq!(column(&scene)[2], Class::Car.id());
    assert_eq!(
        [column(&scene)[0], column(&scene)[3], column(&scene)[12]],
        [15, FREE, 4]
    );
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(
        [column(&scene)[0], column(&scene)[2], column(&scene)[12]],
        [15, FREE, 4]
    );
    // A result cannot overrule them either.
    Edit::AdoptResult {
        occupancy: VoxelGrid::new(),
    }
    .apply(&mut scene)
    .expect("always");
    assert_eq!([column(&scene)[0], column(&scene)[12]], [15, 4]);
    assert_eq!(scene.frame().occupancy.count_set(), 2);
    assert!(!Arc::ptr_eq(&source, &scene.frame().source));
    assert_eq!(scene.frame().source.occupancy, scene.frame().occupancy);
    assert_eq!(scene.frame().source.boxes, scene.frame().boxes);
    // Unlocking keeps what is shown.
    Edit::UnlockVoxels {
        cells: vec![[x, y, 0]],
    }
    .apply(&mut scene)
    .expect("inside");
    assert_eq!(scene.frame().painted.get(x, y, 0), NOT_PAINTED);
    assert_eq!(scene.frame().painted.count_set(), 2);
    assert_eq!(column(&scene)[0], 15);
    Edit::ClearPaint {}.apply(&mut scene).expect("always");
    assert_eq!(scene.frame().painted.count_set(), 0);
}

#[test]
fn what_changes_nothing_keeps_the_revision() {
    let mut scene = street();
    let rev = scene.rev;
    let nothing = [
        Edit::SetPrompt { prompt: "".into() },
        Edit::ClearPaint {},
        Edit::SetConditions {
            conditions: scene.conditions,
        },
        Edit::SetBoxClass {
            id: BoxId(1),
            class: Class::Car,
        },
        Edit::MoveBox {
            id: BoxId(1),
            center_m: Some(scene.frame().boxes[&BoxId(1)].center_m),
            yaw_deg: Some(0.0),
            size_m: None,
        },
        Edit::PaintBev {
            layer: BevLayer::DrivableArea,
            shape: Shape::Cells(vec![cell(0.0, 0.0)]),
            value: true,
        },
    ];
    for edit in nothing {
        edit.apply(&mut scene).expect("sound");
        assert_eq!(scene.rev, rev, "{edit:?}");
    }
    Edit::SetPrompt { prompt: "fog".into() }
        .apply(&mut scene)
        .expect("sound");
    assert_ne!(scene.rev, rev);
}

#[test]
fn conditions_are_set_whole_or_not_at_all() {
    let mut scene = street();
    let (rev, before) = (scene.rev, scene.conditions);
    let bad = Conditions {
        wetness: 2.0,
        ..before
    };
    let error = Edit::SetConditions { conditions: bad }
        .apply(&mut scene)
        .expect_err("refused");
    assert_eq!(error.to_string(), "wetness is 2, expected 0 to 1");
    assert_eq!((scene.rev, scene.conditions), (rev, before));
    let night = before.at(TimeOfDay::Night).under(Weather::Snow);
    let edit = Edit::SetConditions { conditions: night };
    let frame = scene.frame().clone();
    edit.apply(&mut scene).expect("sound");
    assert_eq!(scene.conditions, night);
    assert!(
        scene.rev != rev && Arc::ptr_eq(&frame, scene.frame()),
        "no voxel changes"
    );
}

#[test]
fn ids_run_on_and_find_gaps() {
    let mut scene = street();
    let add = |id| Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(-10.0, 0.0, 0.4),
        size_m: DVec3::new(0.4, 0.4, 0.8),
        yaw_deg: 0.0,
        velocity_mps: None,
        id,
        label: Default::default(),
    };
    add(Some(BoxId(u32::MAX))).apply(&mut scene).expect("free");
    add(None).apply(&mut scene).expect("a gap is left");
    let ids: Vec<u32> = scene.frame().boxes.keys().map(|id| id.0).collect();
    assert_eq!(ids, [1, 2, 3, u32::MAX]);
}

/// The largest edits fit into a frame of 16 ms; the best of a few tries, since tests share the machine.
#[test]
fn the_largest_edits_are_quick() {
    let scene = street();
    let everything = Edit::PaintBev {
        layer: BevLayer::DrivableArea,
        shape: Shape::Rect {
            min_m: DVec2::splat(-50.0),
            max_m: DVec2::splat(50.0),
        },
        value: true,
    };
    let best = |edit: &Edit| {
        let tries = (0..10).map(|_| {
            let mut scene = scene.clone();
            let start = std::time::Instant::now();
            edit.apply(&mut scene).expect("sound");
            start.elapsed()
        });
        tries.min().expect("ten tries")
    };
    let (paint, remove) = (best(&everything), best(&Edit::RemoveBox { id: BoxId(1) }));
    println!("paint 40,000 cells: {paint:?}, remove a car: {remove:?}");
    assert!(paint.as_millis() < 16 && remove.as_millis() < 4);
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
        assert!(text.ends_with("expected finite numbers within 1000 m"), "{text}");
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
