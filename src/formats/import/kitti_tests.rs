//! Tests of the reader of KITTI's scans.

use std::fs;

use glam::DVec3;
use scene::{Class, Window};

use super::*;
use crate::import::{self, GUESSED, ImportedScene};

/// One point: what the exporter makes of a sweep of one.
pub(super) fn sample() -> Vec<u8> {
    scan(&[[0.056287, 2.0, 1.15977]])
}

fn scan(points: &[[f32; 3]]) -> Vec<u8> {
    let point = |[x, y, z]: &[f32; 3]| [*x, *y, *z, 0.25].map(f32::to_le_bytes).concat();
    points.iter().flat_map(point).collect()
}

/// A sequence of one scan: a car ahead to the left of the sensor, one echo of noise, one point beside the map, two of a person.
fn sequence() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["velodyne", "labels"] {
        fs::create_dir(folder.path().join(name)).expect("made");
    }
    let points = [
        [12.0, 4.0, -1.0],
        [1.0, 1.0, 0.0],
        [90.0, 0.0, 0.0],
        [-5.0, -3.0, -0.5],
        [-5.0, -3.0, -0.55],
    ];
    let labels = [0x0007_000au32, 1, 40, 0x0003_00fe, 30];
    let path = folder.path().join("velodyne/000000.bin");
    fs::write(&path, scan(&points)).expect("written");
    let labels: Vec<u8> = labels.into_iter().flat_map(u32::to_le_bytes).collect();
    fs::write(folder.path().join("labels/000000.label"), labels).expect("written");
    (folder, path)
}

fn loaded(path: &Path) -> Result<ImportedScene, FormatError> {
    match import::read(path)? {
        (importer, Content::Scene(loaded)) => {
            assert_eq!(importer.id, "kitti");
            Ok(*loaded)
        }
        _ => panic!("a scan is no road"),
    }
}

fn at(loaded: &ImportedScene, at: [f64; 3]) -> u8 {
    let [x, y, z] = Window::voxel_at(DVec3::from_array(at)).expect("on the map");
    loaded.scene.frame().occupancy.get(x, y, z)
}

#[test]
fn a_car_ahead_to_the_left_lands_there_with_its_label() {
    let (folder, path) = sequence();
    for given in [folder.path(), &path] {
        let found = loaded(given).expect("sound");
        // The default rig's LiDAR is 0.94 m ahead of the axle and 1.84 m high.
        assert_eq!(at(&found, [12.94, 4.0, 0.84]), Class::Car.id());
        assert_eq!(at(&found, [-4.06, -3.0, 1.32]), Class::Pedestrian.id());
        assert_eq!(found.scene.frame().occupancy.count_set(), 2);
        let skipped: Vec<(&str, usize)> = found.skipped.iter().map(|(k, n)| (k.as_str(), *n)).collect();
        assert_eq!(
            skipped,
            [
                (
                    "place of the sensor, taken as 0.94, 0.00, 1.84 m as in the default rig, unless the ground shows another height",
                    1
                ),
                ("points beside the map", 1),
                ("points of noise", 1),
                ("remission", 1),
            ]
        );
        assert_eq!((found.inferred, &*found.scene.name), (&GUESSED[..], "000000"));
    }
}

#[test]
fn calibration_of_this_program_says_where_the_sensor_is() {
    let (folder, path) = sequence();
    let write = |text: &str| fs::write(folder.path().join("calib.txt"), text).expect("written");
    write("Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    assert!(
        loaded(&path)
            .expect("sound")
            .skipped
            .keys()
            .any(|k| k.starts_with("place of"))
    );
    write("P0: 1\nTr_ego_to_velo: 1 0 0 -2 0 1 0 0 0 0 1 -3\n");
    let found = loaded(&path).expect("sound");
    assert_eq!(at(&found, [14.0, 4.0, 2.0]), Class::Car.id());
    assert!(!found.skipped.keys().any(|k| k.starts_with("place of")));
    write("Tr_ego_to_velo: 1 0 0 -2 0 1\n");
    let line = loaded(&path).map(drop).expect_err("six numbers").to_string();
    assert!(
        line.ends_with("Tr_ego_to_velo: expected a rotation and a place in 12 numbers"),
        "{line}"
    );
}

#[test]
fn without_labels_the_shape_tells_and_wrong_ones_are_refused() {
    let (folder, path) = sequence();
    let labels = folder.path().join("labels/000000.label");
    for bytes in [&[][..], &[0; 19], &[0; 24], &[0; 9000]] {
        fs::write(&labels, bytes).expect("written");
        let line = loaded(&path).map(drop).expect_err("of another scan").to_string();
        assert!(line.contains("000000.label: "), "{line}");
    }
    fs::remove_file(&labels).expect("was there");
    assert_eq!(loaded(&path).expect("sound").inferred[0], "classes");
}

#[test]
fn other_numbers_are_no_scan() {
    let refused = |bytes: &[u8]| {
        let source = ImportFile {
            bytes,
            name: "scan",
            path: None,
            options: Default::default(),
        };
        (IMPORTER.read)(&source)
            .map(drop)
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        refused(b""),
        "0 bytes, expected points of 16: f32 x, y, z, remission"
    );
    assert_eq!(
        refused(&[0; 17]),
        "17 bytes, expected points of 16: f32 x, y, z, remission"
    );
    let text = b"a text of four lines, in sixteens of letters; no".repeat(5);
    assert!(
        refused(&text).starts_with("15 of 15 points have no coordinates in m"),
        "{}",
        refused(&text)
    );
    let wild = scan(&[
        [1.0, 1e-40, 0.0],
        [1e-40, 1e-9, 0.0],
        [1e9, 0.0, 0.0],
        [1.0, 1.0, 1.0],
    ]);
    assert!(refused(&wild).starts_with("3 of 4 points"));
    for nothing in [[f32::NAN; 3], [0.0; 3], [3e-5, -4e-5, 1e-6]] {
        let line = refused(&scan(&[nothing; 5]));
        assert!(line.starts_with("no return among 5 points"), "{line}");
    }
    assert!(refused(&scan(&[[70.0, 0.0, 0.0]])).starts_with("none of 1 points lies on the map"));
    // A few numbers that are not finite are counted.
    let mut points = vec![[1.0, 4.0, 1.0]; 30];
    points[3][1] = f32::INFINITY;
    let source = ImportFile {
        bytes: &scan(&points),
        name: "scan",
        path: None,
        options: Default::default(),
    };
    let Ok(Content::Scene(found)) = (IMPORTER.read)(&source) else {
        panic!("a scene");
    };
    assert_eq!(found.skipped.get("points that are not finite"), Some(&1));
}

/// Sensors write slots without a return as zeros, as NaN, or as zeros that a calibration turned: how many does not matter.
#[test]
fn slots_without_a_return_are_left_out_and_counted() {
    let nothing = [[0.0; 3], [5e-5, -2e-5, 1e-5], [f32::NAN; 3], [0.02, 0.0, -0.03]];
    let mut points = vec![[1.0, 4.0, 1.0]; 30];
    points.extend(nothing.repeat(20));
    let source = ImportFile {
        bytes: &scan(&points),
        name: "scan",
        path: None,
        options: Default::default(),
    };
    let Ok(Content::Scene(found)) = (IMPORTER.read)(&source) else {
        panic!("a scene");
    };
    assert_eq!(
        found.skipped.get("empty returns, at the sensor itself"),
        Some(&60)
    );
    assert_eq!(found.skipped.get("points that are not finite"), Some(&20));
    assert_eq!(found.scene.frame().occupancy.count_set(), 1);
    // Told by content too.
    let turned = [5e-5, -2e-5, 1e-5, 0.0].repeat(9);
    let head: Vec<u8> = [turned, vec![3.0, 4.0, -1.0, 0.5]]
        .concat()
        .iter()
        .flat_map(|v: &f32| v.to_le_bytes())
        .collect();
    assert!(ScanFormat::Kitti.are_in(&head));
}

#[test]
fn scans_are_told_apart_from_each_other_and_from_the_rest() {
    let is = |columns: ScanFormat, values: &[f32]| {
        columns.are_in(&values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
    };
    let kitti = [20.1, -3.5, -1.7, 0.32, 5.5, 8.25, 0.5, 0.0].repeat(40);
    // The sine of half a turn is not quite 0.
    let kitti_ahead = [20.1, 1e-15, -1.7, 0.32].repeat(40);
    assert!(is(ScanFormat::Kitti, &kitti_ahead));
    let nuscenes = [20.1, -3.5, -1.7, 12.0, 31.0, 5.5, 8.25, 0.5, 0.0, 0.0].repeat(40);
    assert!(is(ScanFormat::Kitti, &kitti) && !is(ScanFormat::NuScenes, &kitti));
    assert!(is(ScanFormat::NuScenes, &nuscenes) && !is(ScanFormat::Kitti, &nuscenes));
    for values in [&[0.0; 40][..], &[f32::NAN; 40], &[900.0; 40], &[]] {
        assert!(!is(ScanFormat::Kitti, values) && !is(ScanFormat::NuScenes, values));
    }
    assert!(!is(ScanFormat::Kitti, &kitti[..7]));
}
