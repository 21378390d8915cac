//! Drives without labels of voxels or points, whose poses know no height: as nuScenes publishes them, and as T4.

use glam::{DQuat, DVec2};
use scene::{BevLayer, BoxId, Class, SensorRig};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::*;

const FRAMES: usize = 13;
const STEP_M: f64 = 2.5;
const MOUNT_M: DVec3 = DVec3::new(0.9, 0.0, 1.8);

/// Height of a road that rises by 6 % from x = 10 m on.
fn height_m(x: f64) -> f64 {
    (0.06 * (x - 10.0)).max(0.0)
}

/// The vehicle on the road at a key frame.
fn world_from_ego(frame: usize) -> Pose {
    let x = frame as f64 * STEP_M;
    let grade: f64 = if x > 10.0 { 0.06 } else { 0.0 };
    Pose {
        rotation: DQuat::from_rotation_y(-grade.atan()),
        translation_m: DVec3::new(x, 0.0, height_m(x)),
    }
}

/// The same as a data set that knows no height gives it.
fn given(frame: usize) -> Pose {
    Pose::planar(frame as f64 * STEP_M, 0.0, 0.0)
}

/// Road, walls with bays on both sides and a parked car, as the LiDAR sees them: x, y, z, intensity and ring.
fn scan(frame: usize, ring: f32, is_t4: bool) -> Vec<u8> {
    let lidar_from_world = (world_from_ego(frame) * lidar(is_t4)).inverse();
    let at_x = frame as f64 * STEP_M;
    let mut bytes = Vec::new();
    let mut put = |p: DVec3| {
        let at = lidar_from_world.apply(p).as_vec3();
        let record = [at.x, at.y, at.z, 20.0, ring];
        bytes.extend(record.iter().flat_map(|v| v.to_le_bytes()));
    };
    for i in -100..=100 {
        let x = at_x + f64::from(i) * 0.35 + 0.01 * f64::from(i % 7);
        for j in -20..=20 {
            put(DVec3::new(x, f64::from(j) * 0.4, height_m(x)));
        }
        for k in 1..12 {
            // Bays of 4 m, 1 m deep.
            let y = if (x / 4.0).floor() as i64 % 2 == 0 {
                9.0
            } else {
                10.0
            };
            put(DVec3::new(x, y, height_m(x) + f64::from(k) * 0.25));
            put(DVec3::new(x, -y, height_m(x) + f64::from(k) * 0.25));
        }
    }
    for bay in -10..20 {
        let x = f64::from(bay) * 4.0;
        for (j, k) in (0..4).flat_map(|j| (1..12).map(move |k| (j, k))) {
            let y = 9.0 + f64::from(j) * 0.33;
            put(DVec3::new(x, y, height_m(x) + f64::from(k) * 0.25));
            put(DVec3::new(x, -y, height_m(x) + f64::from(k) * 0.25));
        }
    }
    for (i, k) in (0..16).flat_map(|i| (1..6).map(move |k| (i, k))) {
        let x = 33.0 + f64::from(i) * 0.27;
        put(DVec3::new(x, 5.1, height_m(x) + f64::from(k) * 0.25));
    }
    bytes
}

/// The frame of the points in that of the vehicle: in T4 it is the same.
fn lidar(is_t4: bool) -> Pose {
    if is_t4 {
        return Pose::IDENTITY;
    }
    Pose {
        rotation: DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_2),
        translation_m: MOUNT_M,
    }
}

fn row(pose: &Pose) -> (Value, Value) {
    let (q, t) = (pose.rotation, pose.translation_m);
    (json!([q.w, q.x, q.y, q.z]), json!([t.x, t.y, t.z]))
}

/// A folder of such a drive; `annotated` are the objects of its key frames: category, and place in the frame of the vehicle.
fn folder(is_t4: bool, annotated: &dyn Fn(usize) -> Vec<(&'static str, Pose)>) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let (tables, channel, data) = match is_t4 {
        true => ("annotation", "LIDAR_CONCAT", "data/LIDAR_CONCAT"),
        false => ("v1.0-mini", "LIDAR_TOP", "samples/LIDAR_TOP"),
    };
    for name in [tables, data] {
        std::fs::create_dir_all(folder.path().join(name)).expect("made");
    }
    let (mut samples, mut measured, mut poses) = (Vec::new(), Vec::new(), Vec::new());
    let (mut annotations, mut instances) = (Vec::new(), BTreeMap::new());
    for i in 0..FRAMES {
        let (time, name) = (1_000_000 + 500_000 * i as i64, format!("{data}/{i:05}.pcd.bin"));
        std::fs::write(
            folder.path().join(&name),
            scan(i, if is_t4 { -1.0 } else { 3.0 }, is_t4),
        )
        .expect("written");
        samples.push(json!({"token": format!("s{i}"), "timestamp": time, "scene_token": "scene"}));
        measured.push(json!({
            "token": format!("d{i}"), "sample_token": format!("s{i}"), "ego_pose_token": format!("e{i}"),
            "calibrated_sensor_token": "c", "timestamp": time, "fileformat": "pcd.bin", "is_key_frame": true,
            "height": 0, "width": 0, "filename": name, "prev": "", "next": "",
        }));
        let (rotation, translation) = row(&given(i));
        poses.push(json!({
            "token": format!("e{i}"), "timestamp": time, "rotation": rotation, "translation": translation
        }));
        for (n, (category, in_ego)) in annotated(i).into_iter().enumerate() {
            let (rotation, translation) = row(&(given(i) * in_ego));
            instances.insert(n, category);
            annotations.push(json!({
                "token": format!("a{i}-{n}"), "sample_token": format!("s{i}"), "instance_token": format!("i{n}"),
                "visibility_token": "", "attribute_tokens": [], "translation": translation,
                "size": [1.9, 4.5, 1.6], "rotation": rotation, "prev": "", "next": "",
                "num_lidar_pts": 1, "num_radar_pts": 0,
            }));
        }
    }
    let (rotation, translation) = row(&lidar(is_t4));
    let categories: Vec<Value> = instances
        .values()
        .map(|name| json!({"token": name, "name": name, "description": ""}))
        .collect();
    let instances: Vec<Value> = instances
        .iter()
        .map(|(n, name)| json!({"token": format!("i{n}"), "category_token": name}))
        .collect();
    for (name, rows) in [
        (
            "scene",
            vec![
                json!({"token": "scene", "name": "hill", "nbr_samples": FRAMES, "first_sample_token": "s0"}),
            ],
        ),
        ("sample", samples),
        ("sample_data", measured),
        ("ego_pose", poses),
        (
            "sensor",
            vec![json!({"token": "l", "channel": channel, "modality": "lidar"})],
        ),
        (
            "calibrated_sensor",
            vec![json!({
                "token": "c", "sensor_token": "l", "rotation": rotation, "translation": translation,
                "camera_intrinsic": [],
            })],
        ),
        ("category", categories),
        ("instance", instances),
        ("sample_annotation", annotations),
    ] {
        let file = folder.path().join(tables).join(format!("{name}.json"));
        std::fs::write(file, Value::from(rows).to_string()).expect("written");
    }
    folder
}

/// The parked car in the frame of the vehicle at a key frame.
fn parked(frame: usize) -> Pose {
    let x = 35.0;
    let at = DVec3::new(x, 5.5, height_m(x) + 0.8);
    world_from_ego(frame).inverse()
        * Pose {
            rotation: world_from_ego(FRAMES).rotation,
            translation_m: at,
        }
}

#[test]
fn a_rising_road_is_one_road_and_its_boxes_stand_on_it() {
    for is_t4 in [false, true] {
        let name = if is_t4 { "car" } else { "vehicle.car" };
        let folder = folder(is_t4, &|i| vec![(name, parked(i))]);
        let found = tests::read(folder.path()).expect("a drive");
        assert!(
            found.notes.iter().any(|n| n.contains("are aligned")),
            "{:?}",
            found.notes
        );
        let scene = &found.scene;
        for (i, sweep) in found.sweep.iter().flat_map(|s| &s.files).enumerate() {
            // T4 does not tell where the LiDAR is: it is where that of the known vehicle is.
            let usual_m = DVec3::from_array(SensorRig::default().lidars[0].translation_m);
            let at_m = if is_t4 { usual_m } else { MOUNT_M };
            let off_m = sweep.sensor_m.distance(world_from_ego(i).apply(at_m));
            assert!(off_m < 0.05, "{i}: {off_m} m");
        }
        let layout = &scene.canvas().layout;
        for x in [0.0, 15.0, 30.0] {
            let found_m = layout.relief.height_m(DVec2::new(x, 0.0));
            assert!((found_m - height_m(x)).abs() < 0.1, "{x}: {found_m}");
            let [x, y] = layout.extent().column_at(x, 1.0).expect("on the map");
            assert!(
                layout.has(BevLayer::DrivableArea, x, y),
                "{x} {y} {:?}",
                scene.canvas().occupancy.column(x, y)
            );
        }
        // The parked car does not jitter up and down any more: it is one box on the road.
        assert!(scene.clip().tracks.is_empty(), "{:?}", scene.clip().tracks);
        let b = scene.canvas().boxes[&BoxId(1)];
        assert!(
            b.class == Class::Car && b.center_m.distance(DVec3::new(35.0, 5.5, height_m(35.0) + 0.8)) < 0.15
        );
        assert!(found.knows_objects() && found.moments() == FRAMES);
    }
}

#[test]
fn a_drive_without_boxes_has_its_objects_to_be_found() {
    let found = tests::read(folder(true, &|_| Vec::new()).path()).expect("a drive");
    assert!(!found.knows_objects() && found.moments() == FRAMES);
    let moment = found.moment(6).expect("a moment");
    let on_road = moment.returns.iter().filter(|r| r[2].abs() < 0.1).count();
    assert!(
        on_road > moment.returns.len() / 3,
        "{on_road} of {}",
        moment.returns.len()
    );
    // Cut sweeps are left out.
    let cut = folder(true, &|_| Vec::new());
    std::fs::write(cut.path().join("data/LIDAR_CONCAT/00003.pcd.bin"), [0u8; 33]).expect("written");
    assert_eq!(tests::read(cut.path()).expect("the others").moments(), FRAMES - 1);
}
