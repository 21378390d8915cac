//! Scenes of other programs.

use glam::{DMat4, DQuat, DVec3};
use scene::{BevLayer, Class, Extent};
use serde_json::{Value, json};

use super::{Blocks, read, text};

/// The marker of every import format: a single car ahead to the left, a cone to the right.
#[test]
fn a_foreign_scene_has_its_things_where_they_are() {
    let document = Blocks::of(&[
        // 12 m along x of glTF and 5 m against z: ahead and left.
        ("Car_01", DVec3::new(12.0, 0.8, -5.0), DVec3::new(4.5, 1.6, 1.8)),
        (
            "traffic cone",
            DVec3::new(8.0, 0.4, 3.0),
            DVec3::new(0.4, 0.8, 0.4),
        ),
        ("road", DVec3::new(0.0, -0.05, 0.0), DVec3::new(60.0, 0.1, 30.0)),
        (
            "house wall",
            DVec3::new(0.0, 2.0, -12.0),
            DVec3::new(20.0, 4.0, 0.2),
        ),
        ("SkyDome", DVec3::ZERO, DVec3::splat(5000.0)),
        (
            "grass field",
            DVec3::new(0.0, -0.05, 25.0),
            DVec3::new(60.0, 0.1, 20.0),
        ),
    ]);
    let loaded = read(&text(&document));
    let frame = loaded.scene.frame();
    assert_eq!(loaded.skipped["meshes of the sky"], 1);
    assert_eq!(frame.extent(), Extent::WINDOW);
    let of = |class: Class| frame.boxes.values().find(|b| b.class == class).expect("that box");
    let car = of(Class::Car);
    assert!(
        (car.center_m - DVec3::new(12.0, 5.0, 0.8)).length() < 1e-6,
        "{}",
        car.center_m
    );
    assert!(
        (car.size_m - DVec3::new(4.5, 1.8, 1.6)).length() < 1e-6,
        "{}",
        car.size_m
    );
    assert!((of(Class::TrafficCone).center_m - DVec3::new(8.0, -3.0, 0.4)).length() < 1e-6);
    assert_eq!(frame.boxes.len(), 2);
    let label = |x: f64, y: f64, z: usize| {
        let [x, y] = Extent::WINDOW.column_at(x, y).expect("on the map");
        frame.occupancy.get(x, y, z)
    };
    // In the convention of the labels: the ground in bin 0, a car from there to its roof (1.6 m: bin 6).
    let column: Vec<u8> = (0..8).map(|z| label(12.1, 5.1, z)).collect();
    assert_eq!(column, [4, 4, 4, 4, 4, 4, 4, Class::FREE]);
    assert_eq!((label(-10.1, 0.1, 0), label(-10.1, 0.1, 1)), (11, Class::FREE));
    assert_eq!(label(0.1, -25.1, 0), Class::Terrain.id());
    // The wall has no holes, from the ground to 4 m.
    for x in -24..=24 {
        let wall = (0..12).all(|z| label(f64::from(x) * 0.4, 12.0, z) == Class::Manmade.id());
        assert!(wall, "column {x} of the wall");
    }
    assert!(frame.layout.count(BevLayer::DrivableArea) > 10_000);
}

#[test]
fn the_order_of_quaternions_and_sizes_is_that_of_the_standard() {
    // 30 degrees counter-clockwise from above; glTF has x, y, z, w, and up is y.
    let turn = DQuat::from_rotation_y(30f64.to_radians());
    let mut blocks = Blocks::new();
    blocks.block("bus", DVec3::new(-9.0, 1.5, -11.0), DVec3::new(2.6, 3.0, 11.0));
    blocks.block("street", DVec3::ZERO, DVec3::new(70.0, 0.01, 70.0));
    let mut document = blocks.document();
    document["nodes"][0]["rotation"] = json!(turn.to_array());
    let b = |document: &Value| {
        *read(&text(document))
            .scene
            .frame()
            .boxes
            .values()
            .next()
            .expect("a bus")
    };
    let found = b(&document);
    assert!(
        (found.size_m - DVec3::new(11.0, 2.6, 3.0)).length() < 1e-6,
        "{}",
        found.size_m
    );
    assert!((found.center_m - DVec3::new(-9.0, 11.0, 1.5)).length() < 1e-6);
    // Its front is +z of glTF, our -y, turned by 30 degrees.
    assert!(
        (found.yaw_rad.to_degrees() + 60.0).abs() < 1e-4,
        "{}",
        found.yaw_rad.to_degrees()
    );
    // The same as a matrix, column by column.
    let m = DMat4::from_rotation_translation(turn, DVec3::new(-9.0, 1.5, -11.0));
    let node = document["nodes"][0].as_object_mut().expect("a node");
    node.remove("rotation");
    node.remove("translation");
    node.insert("matrix".into(), json!(m.to_cols_array()));
    let again = b(&document);
    assert!(
        (again.center_m - found.center_m).length() < 1e-5 && (again.yaw_rad - found.yaw_rad).abs() < 1e-6
    );
}

#[test]
fn a_group_of_cars_is_several_and_a_joined_mesh_is_voxels() {
    let mut blocks = Blocks::new();
    for (i, name) in ["first", "second", "third"].into_iter().enumerate() {
        blocks.block(
            name,
            DVec3::new(0.0, 0.8, -3.0 * i as f64),
            DVec3::new(4.5, 1.6, 1.8),
        );
    }
    let mut document = blocks.document();
    document["nodes"]
        .as_array_mut()
        .expect("nodes")
        .push(json!({"name": "Cars", "children": [0, 1, 2]}));
    document["scenes"][0]["nodes"] = json!([3]);
    let loaded = read(&text(&document));
    let frame = loaded.scene.frame();
    assert_eq!(frame.boxes.len(), 3);
    assert!(
        frame
            .boxes
            .values()
            .all(|b| b.class == Class::Car && b.size_m.x == 4.5)
    );
    let long = Blocks::of(&[("cars", DVec3::new(0.0, 0.8, 0.0), DVec3::new(60.0, 1.6, 2.0))]);
    let loaded = read(&text(&long));
    assert!(loaded.scene.frame().boxes.is_empty());
    assert!(
        loaded
            .scene
            .frame()
            .occupancy
            .iter_set()
            .filter(|v| v.3 == 4)
            .count()
            > 500
    );
}

#[test]
fn far_maps_come_to_the_origin_and_large_ones_are_cut() {
    let far = Blocks::of(&[
        (
            "road",
            DVec3::new(9000.2, 112.0, -70.0),
            DVec3::new(300.0, 0.1, 20.0),
        ),
        (
            "house",
            DVec3::new(9050.0, 114.0, -90.0),
            DVec3::new(10.0, 4.0, 10.0),
        ),
    ]);
    let loaded = read(&text(&far));
    let extent = loaded.scene.frame().extent();
    assert_eq!(
        (
            extent.nx().abs_diff(750) <= 1,
            extent.from()[0].abs_diff(-375) <= 2
        ),
        (true, true),
        "{extent}"
    );
    assert!(loaded.scene.frame().layout.count(BevLayer::DrivableArea) > 30_000);
    let large = Blocks::of(&[("terrain", DVec3::ZERO, DVec3::new(5e4, 0.1, 60.0))]);
    let extent = read(&text(&large)).scene.frame().extent();
    assert_eq!([extent.nx(), extent.ny()], [2048, 150]);
}
