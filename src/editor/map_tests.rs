//! Tests of edits on a map that is larger than the networks' window.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use scene::background::{Building, Form, Shrubs};
use scene::draft::draft;
use scene::{
    BevLayer, BevLayout, BoxId, Class, Extent, Frame, Pose, Relief, Scene, SceneBox, SensorRig, VoxelGrid,
};

use crate::checks::run_checks;
use crate::flood::{FillBounds, flood};
use crate::pick::{self, PickHit, PickRay};
use crate::roads::Street;
use crate::tools::{Hand, farthest_m};
use crate::{Apply, Document, Edit, Shape, Stale, kerb, outline, part, voxel_ops};

/// From -60 to 132 m along x, from -44 to 84 m along y.
fn large() -> Extent {
    Extent::new([-150, -110], [480, 320]).expect("sound")
}

/// Open ground with a road along x, 8 m wide.
fn open_ground(extent: Extent) -> Scene {
    let mut layout = BevLayout::over(extent);
    for [x, y] in extent.all_columns() {
        let on_road = extent.center(x, y, 0).y.abs() < 4.0;
        layout.set(BevLayer::DrivableArea, x, y, on_road);
    }
    let occupancy = draft(&layout, std::iter::empty());
    let frame = Frame::new(layout, BTreeMap::new(), occupancy);
    Scene::single("map", frame, Arc::new(SensorRig::default()), 0)
}

fn disc(x: f64, y: f64) -> Edit {
    Edit::PaintBev {
        layer: BevLayer::Walkway,
        shape: Shape::Disc {
            center_m: DVec2::new(x, y),
            radius_m: 3.03,
        },
        value: true,
    }
}

fn car(id: u32, x: f64, y: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.85),
        size_m: DVec3::new(4.61, 1.93, 1.7),
        yaw_rad: 0.31,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn paint(extent: Extent, x: f64, y: f64, class: Class) -> Edit {
    let [x, y] = extent.column_at(x, y).expect("on the map");
    Edit::PaintVoxels {
        cells: (9..12).map(|z| [x, y, z]).collect(),
        class,
    }
}

fn same_bricks(a: &Frame, b: &Frame) -> bool {
    let grids = [(&a.occupancy, &b.occupancy)];
    a == b
        && grids.iter().all(|(a, b)| a.changed_bricks(b).is_empty())
        && a.painted.changed_bricks(&b.painted).is_empty()
        && a.layout.shares_cells(&b.layout)
}

#[test]
fn edits_beyond_the_window_change_nothing_within_it() {
    let extent = large();
    let mut document = Document::new(open_ground(extent));
    let start = document.scene().frame().clone();
    let edits = [
        disc(100.0, 60.0),
        car(7, 100.0, 1.0).into(),
        paint(extent, 110.0, 60.0, Class::Manmade),
    ];
    for edit in &edits {
        document.apply("Far away", edit).expect("on the map");
    }
    let frame = document.scene().frame().clone();
    let column = |x: f64, y: f64| extent.column_at(x, y).expect("on the map");
    let [x, y] = column(100.0, 60.0);
    assert!(frame.layout.has(BevLayer::Walkway, x, y));
    assert_eq!(frame.occupancy.get(x, y, 0), Class::Sidewalk.id());
    let [x, y] = column(100.0, 1.0);
    assert_eq!(frame.occupancy.get(x, y, 1), Class::Car.id());
    let [x, y] = column(110.0, 60.0);
    assert_eq!(frame.painted.get(x, y, 10), Class::Manmade.id());
    // All of it is beyond the window.
    let (before, after) = (start.crop(Extent::WINDOW), frame.crop(Extent::WINDOW));
    assert_eq!(before.occupancy, after.occupancy);
    assert_eq!(before.painted, after.painted);
    assert_eq!(before.layout, after.layout);
    // It is seen from above.
    let down = |x: f64, y: f64| PickRay::new(DVec3::new(x, y, 50.0), -DVec3::Z).expect("a ray");
    let hit = pick::pick(&frame, &down(100.0, 1.0));
    assert!(matches!(hit, Some(PickHit::Box { id: BoxId(7), .. })), "{hit:?}");
    let hit = pick::ray_voxels(&down(110.0, 60.0), &frame.occupancy, |_, _| true).expect("painted");
    assert_eq!(hit.cell, [x, y, 11]);
    assert_eq!(hit.neighbour(extent), Some([x, y, 12]));
    assert_eq!(pick::box_at(&frame, DVec2::new(100.0, 1.0)), Some(BoxId(7)));
    // The car is on the map and on the road; what was painted hangs in the air where it is.
    let findings = run_checks(document.scene(), None);
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!(findings[0].check, "floating_voxels");
    let off_m = findings[0].where_m.truncate() - DVec2::new(110.0, 60.0);
    assert!(off_m.abs().max_element() < 0.3, "{off_m}");
    for _ in &edits {
        document.undo();
    }
    assert!(same_bricks(document.scene().frame(), &start));
}

#[test]
fn a_place_beyond_the_window_is_like_one_within_it() {
    /// Edits about a place, and what they make.
    fn edited(extent: Extent, at: DVec2) -> Scene {
        let mut scene = open_ground(extent);
        let v = |x: f64, y: f64| at + DVec2::new(x, y);
        let middle_m = [v(5.03, -20.07), v(4.11, 21.03)];
        let change = Street::default().along(&middle_m).expect("two points");
        let mut edits = vec![Edit::ChangeRoads { change }];
        let shrubs = Shrubs {
            outline_m: outline::of_stroke(extent, &[v(-12.03, 8.11), v(-6.1, 9.07)], 3.0)
                .expect("on the map"),
            height_m: 1.13,
            per_m2: 0.5,
        };
        let house = Building::rectangle(v(-20.03, -14.07), DVec2::new(5.1, 4.2), DVec2::X, 6.1);
        edits.push(Edit::AddThings {
            forms: vec![Form::Shrubs(shrubs), Form::Building(house)],
        });
        let p = v(-10.0, 1.03);
        edits.push(car(3, p.x, p.y).into());
        edits.push(Edit::MoveBox {
            id: BoxId(3),
            center_m: Some(v(-12.07, 1.51).extend(0.85)),
            yaw_deg: None,
            size_m: None,
        });
        let p = v(1.03, -9.13);
        edits.push(paint(extent, p.x, p.y, Class::Vegetation));
        for edit in &edits {
            edit.apply(&mut scene).expect("sound");
        }
        Edit::ClearScenery {
            shape: Some(Shape::Disc {
                center_m: v(1.03, -9.13),
                radius_m: 9.0,
            }),
        }
        .apply(&mut scene)
        .expect("sound");
        scene
    }
    let here = edited(Extent::WINDOW, DVec2::ZERO);
    let away = Extent::new([150, -100], [200, 200]).expect("sound");
    let there = edited(away, DVec2::new(100.0, 0.0));
    let dense = |s: &Scene| [s.frame().occupancy.to_dense(), s.frame().painted.to_dense()];
    let count = here.frame().occupancy.class_counts();
    assert!(count[Class::Manmade as usize] > 500 && count[Class::Car as usize] > 50);
    assert_eq!(here.frame().layout.cells(), there.frame().layout.cells());
    assert!(dense(&here) == dense(&there), "the same voxels");
    // What the checks find, and what repairs it, is the same too.
    let (a, b) = (run_checks(&here, None), run_checks(&there, None));
    assert!(!a.is_empty());
    let texts = |found: &[crate::checks::Finding]| -> Vec<_> {
        let of = |f: &crate::checks::Finding| (f.check, f.cells.clone(), f.fixes.len());
        found.iter().map(of).collect()
    };
    assert_eq!(texts(&a), texts(&b));
    for (a, b) in a.iter().zip(&b) {
        assert!((b.where_m - a.where_m - DVec3::X * 100.0).length() < 1e-6);
    }
}

#[test]
fn a_box_around_voxels_stands_where_they_are() {
    let extent = large();
    let mut scene = open_ground(extent);
    Edit::from(car(5, 100.0, 1.0))
        .apply(&mut scene)
        .expect("on the map");
    scene.change_canvas(|f| f.boxes.clear());
    let findings = run_checks(&scene, None);
    assert_eq!(findings[0].check, "occupancy_without_box", "{findings:?}");
    let fix = &findings[0].fixes[0].edits;
    fix[0].apply(&mut scene).expect("sound");
    let b = *scene.frame().boxes.values().next().expect("a box");
    assert!(
        b.center_m.truncate().distance(DVec2::new(100.0, 1.0)) < 0.5,
        "{b:?}"
    );
}

#[test]
fn a_result_settles_what_was_authored_anywhere() {
    let extent = large();
    let mut scene = open_ground(extent);
    let start = scene.frame().clone();
    let edits = [
        disc(20.0, 20.0),
        disc(100.0, 60.0),
        car(1, 20.0, 1.0).into(),
        car(2, 100.0, 1.0).into(),
        // On the border of the window, and beside the map.
        car(3, 40.3, -1.0).into(),
        car(4, 500.0, 0.0).into(),
        paint(extent, 110.0, 60.0, Class::Manmade),
    ];
    for edit in &edits {
        edit.apply(&mut scene).expect("sound");
    }
    let mut result = scene.frame().occupancy.clone();
    let [x, y] = extent.column_at(10.0, 30.0).expect("on the map");
    result.set(x, y, 4, Class::Vegetation.id());
    // What is painted is kept, wherever it is.
    let [px, py] = extent.column_at(110.0, 60.0).expect("on the map");
    result.set(px, py, 10, Class::FREE);
    scene = crate::replay::with_result(&scene, result, None).expect("of this map");
    let frame = scene.frame();
    assert_eq!(frame.occupancy.get(x, y, 4), Class::Vegetation.id());
    assert_eq!(frame.occupancy.get(px, py, 10), Class::Manmade.id());
    let source = &frame.source;
    assert_eq!(source.occupancy, frame.occupancy);
    let ids: Vec<u32> = source.boxes.keys().map(|id| id.0).collect();
    assert_eq!(
        ids,
        [1, 2, 3, 4],
        "none is pending, the one beside the map included"
    );
    let walkway = |layout: &BevLayout, x: f64, y: f64| {
        let [x, y] = extent.column_at(x, y).expect("on the map");
        layout.has(BevLayer::Walkway, x, y)
    };
    assert!(walkway(&source.layout, 20.0, 20.0) && walkway(&source.layout, 100.0, 60.0));
    assert_eq!(source.layout.relief, Relief::FLAT);
    let source = source.clone();
    // A result of another map is none.
    let before = scene.clone();
    let error = crate::replay::with_result(&scene, VoxelGrid::new(), None).expect_err("a window");
    assert!(error.to_string().contains("expected 480 x 320 x 16"), "{error}");
    assert_eq!(scene.rev, before.rev);
    assert_eq!(scene.frame().source, source);
    let mut document = Document::new(scene);
    let rev = document.scene().content();
    assert_eq!(document.adopt(rev, VoxelGrid::new()), Err(Stale));
    assert_eq!(document.scene().content(), rev);
    assert_eq!(start.source.layout, start.layout);
}

#[test]
fn tools_reach_the_whole_map() {
    let extent = large();
    let mut scene = open_ground(extent);
    let far = DVec2::new(120.1, 70.1);
    assert_eq!(farthest_m(Extent::WINDOW), 400.0);
    let city = Extent::new([-2000, -2000], [4000, 4000]).expect("sound");
    assert!((farthest_m(city) - 800.0 * 2f64.sqrt()).abs() < 1e-6);
    // Fills, kerbs and outlines.
    let layout = scene.frame().layout.clone();
    let [x, y] = extent.column_at(far.x, far.y).expect("on the map");
    let cells = flood(&layout, BevLayer::Walkway, [x, y], FillBounds::AnyLayer);
    assert_eq!(cells.len(), 480 * (210 - 10), "the ground left of the road");
    let found = kerb::nearest_kerb(&layout, DVec2::new(120.0, 4.5), 1.0).expect("near");
    assert!((found.at_m.y - 4.0).abs() < 0.1 && found.away.y > 0.99);
    assert!(kerb::is_roadway(&layout, DVec2::new(120.0, 0.0)));
    let around = outline::of_stroke(extent, &[far], 3.0).expect("on the map");
    let middle = around.iter().sum::<DVec2>() / around.len() as f64;
    assert!(middle.distance(far) < 0.3, "{middle}");
    // Both sides of the ego axis, where the map has both.
    let hand = Hand {
        symmetry: true,
        ..Hand::default()
    };
    let at = |y_m: f64| {
        extent
            .column_at(100.1, y_m)
            .map(|[x, y]| [x, y, 3])
            .expect("on the map")
    };
    assert_eq!(hand.both_sides(extent, vec![at(20.1)]), [at(-20.1), at(20.1)]);
    assert_eq!(hand.both_sides(extent, vec![at(70.1)]), [at(70.1)]);
    // Whole blocks, and what is connected.
    let all = voxel_ops::between(extent, [0; 3], [usize::MAX; 3]);
    assert_eq!(all.len(), extent.voxels());
    let ground = voxel_ops::connected(&scene.frame().occupancy, [479, 319, 0]);
    assert_eq!(ground.len(), 480 * 200);
    // A part of a result.
    let before = scene.frame().occupancy.clone();
    paint(extent, far.x, far.y, Class::Vegetation)
        .apply(&mut scene)
        .expect("on the map");
    let after = &scene.frame().occupancy;
    assert_eq!(part::changed_by_class(&before, after), [(Class::Vegetation, 3)]);
    let mut columns = vec![false; extent.columns()];
    columns[extent.index(x, y)] = true;
    assert_eq!(part::AcceptedPart::Columns(columns).taken(&before, after), *after);
    let other = VoxelGrid::new();
    assert_eq!(part::changed_by_class(&before, &other), []);
    assert_eq!(
        part::AcceptedPart::Class(Class::Terrain).taken(&before, &other),
        before
    );
    // Things stand where they stand, wherever the vehicle is.
    scene.change_canvas(|f| f.world_from_ego = Pose::planar(7.0, 3.0, 0.0));
    let house = Building::rectangle(far, DVec2::new(4.0, 3.0), DVec2::X, 3.0);
    let forms = vec![Form::Building(house)];
    Edit::AddThings { forms }.apply(&mut scene).expect("sound");
    let [x, y] = extent.column_at(far.x, far.y).expect("on the map");
    assert_eq!(scene.frame().occupancy.get(x, y, 4), Class::Manmade.id());
    let cleared = Edit::ClearScenery { shape: None };
    cleared.apply(&mut scene).expect("sound");
    assert_eq!(
        scene.frame().occupancy.get(x, y, 4),
        Class::Manmade.id(),
        "it belongs to a thing"
    );
}
