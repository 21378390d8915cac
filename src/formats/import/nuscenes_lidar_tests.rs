//! Tests of the reader of nuScenes' scans.

use std::fs;

use glam::DVec3;
use scene::Window;

use super::*;
use crate::import::{self, ImportedScene};

/// Seven points ahead of the vehicle: the sensor's x axis points to the right, its y axis ahead.
pub(super) fn sample() -> Vec<u8> {
    scan(&[[-4.0, 12.0, -1.0]; 7])
}

fn scan(points: &[[f32; 3]]) -> Vec<u8> {
    let point = |[x, y, z]: &[f32; 3]| [*x, *y, *z, 12.0, 30.0].map(f32::to_le_bytes).concat();
    points.iter().flat_map(point).collect()
}

fn loaded(path: &Path) -> Result<ImportedScene, FormatError> {
    match import::read(path)?.1 {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}: expected a scene"),
    }
}

fn at(loaded: &ImportedScene, at: [f64; 3]) -> u8 {
    let [x, y, z] = Window::voxel_at(DVec3::from_array(at)).expect("on the map");
    loaded.scene.frame().occupancy.get(x, y, z)
}

#[test]
fn a_car_ahead_to_the_left_lands_there_with_its_label() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("n015__LIDAR_TOP__1.pcd.bin");
    let points = [
        [-4.0, 12.0, -1.0],
        [3.0, -5.0, -0.3],
        [0.0, 0.0, -0.5],
        [9.0, 9.0, -1.0],
    ];
    fs::write(&path, scan(&points)).expect("written");
    // Where it lies: 0.94 m ahead of the axle and 1.84 m high, and it leans a little.
    let (car, person) = ([12.9, 4.1, 0.57], [-4.1, -3.0, 1.64]);
    for (name, labels, expected) in [
        (
            "token_lidarseg.bin",
            [17, 2, 31, 0],
            [Class::Car, Class::Pedestrian],
        ),
        (
            "n015__LIDAR_TOP__1_lidarseg.bin",
            [4, 7, 0, 0],
            [Class::Car, Class::Pedestrian],
        ),
    ] {
        fs::write(folder.path().join(name), labels).expect("written");
        let found = loaded(&path).expect("sound");
        assert_eq!(
            [car, person].map(|p| at(&found, p)),
            expected.map(Class::id),
            "{name}"
        );
        let said = "pose of the sensor, taken as in the default rig: 0.94, 0.00, 1.84 m (unless the ground shows another height), x to the right";
        assert_eq!(found.skipped.get(said), Some(&1), "{:?}", found.skipped);
        let away = found.skipped.get("points of noise and of the own vehicle");
        assert_eq!(away.copied(), (name == "token_lidarseg.bin").then_some(2));
    }
    fs::write(folder.path().join("n015__LIDAR_TOP__1_lidarseg.bin"), [1, 2, 3]).expect("written");
    let line = loaded(&path).map(drop).expect_err("three labels").to_string();
    assert!(
        line.ends_with("3 bytes, expected 1 for each of 4 points"),
        "{line}"
    );
}

/// By its name alone it is read, too, and two files of labels of other scans are none.
#[test]
fn a_name_is_enough_where_the_numbers_are_unusual() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.pcd.bin");
    let mut bytes = sample();
    bytes[12..16].copy_from_slice(&300.0f32.to_le_bytes());
    fs::write(&path, &bytes).expect("written");
    for name in ["b_lidarseg.bin", "c_lidarseg.bin"] {
        fs::write(folder.path().join(name), [17]).expect("written");
    }
    let found = loaded(&path).expect("sound");
    assert_ne!(at(&found, [12.9, 4.1, 0.57]), Class::FREE);
    assert_eq!(found.inferred[0], "classes");
    bytes.pop();
    fs::write(&path, &bytes).expect("written");
    let line = loaded(&path).map(drop).expect_err("cut").to_string();
    assert!(
        line.ends_with("139 bytes, expected points of 20: f32 x, y, z, intensity, ring"),
        "{line}"
    );
}

#[test]
fn the_table_is_that_of_the_development_kit() {
    let classes = |class: Class| CLASSES.iter().filter(|c| **c == Some(class)).count();
    assert_eq!(
        (classes(Class::Pedestrian), classes(Class::Bus), CLASSES[24]),
        (4, 2, Some(Class::DriveableSurface))
    );
    assert_eq!(
        (CLASSES[0], CLASSES[31], CLASSES[30]),
        (None, None, Some(Class::Vegetation))
    );
}
