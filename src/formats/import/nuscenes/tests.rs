use glam::DVec2;
use scene::{BevLayer, BoxId, Class, Extent, SceneBox};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::*;
use crate::clip_tests::{Plain, clip_scene};
use crate::export::nuscenes::EXPORTER;
use crate::import::{self, Content};
use crate::table_tests::in_folder as folder_of;

/// A table of scenes, as the exporter writes it.
pub(super) fn sample() -> Vec<u8> {
    let scene = crate::table_tests::scene();
    let files = (EXPORTER.write)(&scene, &mut Plain::of(&scene)).expect("written");
    let scenes = files.into_iter().find(|f| f.name == "v1.0-mini/scene.json");
    scenes.expect("a table of scenes").bytes
}

pub(super) fn written(scene: &Scene) -> TempDir {
    let mut products = Plain::of(scene);
    products.every = 90;
    folder_of(&(EXPORTER.write)(scene, &mut products).expect("written"))
}

pub(super) fn read(folder: &Path) -> Result<ImportedScene, FormatError> {
    match import::read(folder)?.1 {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}"),
    }
}

/// What comes back of a moment: classes, centres, sizes and headings of the boxes, in the order of their ids.
fn assert_same_boxes(a: &Scene, b: &Scene) {
    let (of_a, of_b) = (&a.frame().boxes, &b.frame().boxes);
    assert_eq!(of_a.len(), of_b.len(), "at {} s", a.time_s());
    for (x, y) in of_a.values().zip(of_b.values()) {
        assert_eq!(x.class, y.class);
        assert!((x.center_m - y.center_m).length() < 1e-6, "{x:?} {y:?}");
        assert!((x.size_m - y.size_m).length() < 1e-6);
        let turn = x.heading().angle_to(y.heading());
        assert!(turn.abs() < 1e-6, "{turn}");
    }
}

#[test]
fn boxes_poses_times_and_rig_of_a_hundred_clips_come_back() {
    for seed in 0..100 {
        let scene = clip_scene(seed);
        let folder = written(&scene);
        let loaded = read(folder.path()).expect("ours");
        let back = loaded.scene;
        assert_eq!(
            loaded.skipped.keys().filter(|k| !k.starts_with("points")).count(),
            0
        );
        assert_eq!((&back.name, back.clip().length_s), (&scene.name, 2.0));
        for i in 0..5 {
            let [a, b] = [&scene, &back].map(|s| s.at(f64::from(i) * 0.5));
            assert_same_boxes(&a, &b);
            let [p, q] = [&a, &b].map(|s| s.frame().world_from_ego);
            assert!((p.translation_m - q.translation_m).length() < 1e-6);
            assert!(p.rotation.angle_between(q.rotation) < 1e-6);
        }
        assert_eq!(back.clip().tracks.len(), scene.clip().tracks.len());
        let expected = scene.rig.cameras.iter().map(|c| c.resized(32, 18));
        for (a, b) in back.rig.cameras.iter().zip(expected) {
            assert_eq!((&a.name, a.width, a.height), (&b.name, 32, 18));
            let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(near(&a.focal_px, &b.focal_px) && near(&a.center_px, &b.center_px));
            assert!(near(&a.translation_m, &b.translation_m) && near(&a.rotation_wxyz, &b.rotation_wxyz));
        }
        assert_eq!(back.rig.cameras.len(), 6);
        let [a, b] = [&scene, &back].map(|s| s.rig.lidars[0].ego_from_sensor());
        assert!(
            a.translation_m.distance(b.translation_m) < 1e-9 && a.rotation.angle_between(b.rotation) < 1e-6
        );
    }
}

#[test]
fn voxels_and_map_follow_from_the_sweeps() {
    let scene = clip_scene(8);
    let back = read(written(&scene).path()).expect("ours");
    assert_eq!(back.inferred, ["layout", "background"]);
    let frame = back.scene.canvas();
    // The road under the vehicle, in the bin of flat ground, between the rings as well.
    for x_m in [-4.0, 3.0, 9.0] {
        let [x, y] = frame.extent().column_at(x_m, 0.1).expect("on the map");
        let stands = frame.occupancy.column(x, y).iter().any(|l| (1..=10).contains(l));
        assert!(
            stands || frame.occupancy.get(x, y, 0) == Class::DriveableSurface.id(),
            "at {x_m}"
        );
        assert!(stands || frame.layout.has(BevLayer::DrivableArea, x, y));
    }
    let counts = frame.occupancy.class_counts();
    assert_eq!(
        counts[usize::from(Class::Others.id())],
        0,
        "every point has a label: {counts:?}"
    );
    // Each standing box has voxels of its class at its place, each track its own.
    for b in frame.boxes.values() {
        let Some([x, y, z]) = frame.extent().voxel_at(b.center_m) else {
            continue;
        };
        let column = frame.occupancy.column(x, y);
        assert!(column[..=z].iter().any(|l| (1..=10).contains(l)), "{b:?}");
    }
    assert!(back.scene.clip().tracks.values().all(|t| t.voxels.count() > 0));
}

#[test]
fn words_and_light_come_back() {
    let mut scene = crate::table_tests::scene();
    scene.prompt = "a street after Rain at night, \"wet\"".into();
    let back = read(written(&scene).path()).expect("ours").scene;
    assert_eq!(back.prompt, scene.prompt);
    assert_eq!(
        back.conditions,
        Conditions::usual(TimeOfDay::Night, Weather::Rain, 0)
    );
    assert!(back.clip().is_still() && back.clip().length_s == 0.0);
    assert_same_boxes(&scene, &back);
    assert_eq!(back.frame().extent(), Extent::WINDOW);
    assert_eq!(conditions("trains and knights"), Conditions::default());
}

/// Tables as the data set has them: a city's coordinates, no lidarseg, other keys, rows of other scenes.
pub(super) fn foreign() -> TempDir {
    // The vehicle is at (1010, 612) and looks along the global y axis.
    let quarter = [0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()];
    let tables = [
        (
            "scene",
            json!([
            {"token": "s2", "log_token": "l", "nbr_samples": 9, "first_sample_token": "x", "name": "scene-0103", "description": ""},
            {"token": "s1", "log_token": "l", "nbr_samples": 2, "first_sample_token": "a", "name": "scene-0061",
             "description": "Parked truck, construction, rain"}]),
        ),
        (
            "sample",
            json!([
            {"token": "b", "timestamp": 1_532_402_928_147_847_i64, "prev": "a", "next": "", "scene_token": "s1"},
            {"token": "x", "timestamp": 1_532_402_928_147_847_i64, "prev": "", "next": "", "scene_token": "s2"},
            {"token": "a", "timestamp": 1_532_402_927_647_951_i64, "prev": "", "next": "b", "scene_token": "s1"}]),
        ),
        (
            "sensor",
            json!([
            {"token": "cam", "channel": "CAM_FRONT", "modality": "camera"},
            {"token": "lid", "channel": "LIDAR_TOP", "modality": "lidar"},
            {"token": "rad", "channel": "RADAR_FRONT", "modality": "radar"}]),
        ),
        (
            "calibrated_sensor",
            json!([
            {"token": "ccam", "sensor_token": "cam", "translation": [1.7, 0.02, 1.5], "rotation": [0.5, -0.5, 0.5, -0.5],
             "camera_intrinsic": [[1266.0, 0.0, 816.0], [0.0, 1267.0, 491.0], [0.0, 0.0, 1.0]]},
            {"token": "clid", "sensor_token": "lid", "translation": [0.9, 0.0, 1.8], "rotation": [1.0, 0, 0, 0], "camera_intrinsic": []},
            {"token": "crad", "sensor_token": "rad", "translation": [3.4, 0.0, 0.5], "rotation": [1.0, 0, 0, 0], "camera_intrinsic": []}]),
        ),
        (
            "sample_data",
            json!([
                data("a1", "a", "ccam", true),
                data("a2", "a", "clid", true),
                data("a3", "a", "crad", true),
                data("b2", "b", "clid", true),
                data("b9", "b", "clid", false),
                data("x2", "x", "clid", true)
            ]),
        ),
        (
            "ego_pose",
            json!([
            {"token": "a2", "timestamp": 1, "rotation": quarter, "translation": [1010.0, 612.0, 0.0]},
            {"token": "a1", "timestamp": 1, "rotation": quarter, "translation": [0.0, 0.0, 0.0]},
            {"token": "b2", "timestamp": 1, "rotation": quarter, "translation": [1010.0, 614.8, 0.0]}]),
        ),
        (
            "category",
            json!([
            {"token": "c1", "name": "vehicle.truck", "description": "Trucks"},
            {"token": "c2", "name": "human.pedestrian.stroller", "description": ""},
            {"token": "c3", "name": "vehicle.emergency.police", "description": ""}]),
        ),
        (
            "attribute",
            json!([{"token": "at", "name": "vehicle.parked", "description": ""}]),
        ),
        (
            "instance",
            json!([
            {"token": "i1", "category_token": "c1", "nbr_annotations": 1},
            {"token": "i2", "category_token": "c2", "nbr_annotations": 1},
            {"token": "i3", "category_token": "c3", "nbr_annotations": 2}]),
        ),
        // A parked truck, ahead and to the left: 8 m along y and 3 m to the lower x; it looks along y plus 0.3 rad.
        (
            "sample_annotation",
            json!([
                annotation(
                    "n1",
                    "a",
                    "i1",
                    [1007.0, 620.0, 1.4],
                    Some("at"),
                    std::f64::consts::FRAC_PI_2 + 0.3
                ),
                annotation("n2", "b", "i2", [1000.0, 600.0, 1.0], None, 0.0),
                annotation(
                    "n3",
                    "a",
                    "i3",
                    [1012.0, 632.0, 1.0],
                    None,
                    std::f64::consts::FRAC_PI_2
                ),
                annotation(
                    "n4",
                    "b",
                    "i3",
                    [1012.0, 637.0, 1.0],
                    None,
                    std::f64::consts::FRAC_PI_2
                ),
                annotation("n9", "x", "i3", [0.0, 0.0, 1.0], None, 0.0)
            ]),
        ),
    ];
    let files = tables.map(|(name, rows): (&str, Value)| {
        (
            format!("v1.0-mini/{name}.json"),
            serde_json::to_vec_pretty(&rows).expect("JSON"),
        )
    });
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("samples/LIDAR_TOP")).expect("made");
    std::fs::create_dir(folder.path().join("v1.0-mini")).expect("made");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("written");
    }
    // A wall to the right, one point in the truck (its rear, above the ground), one that is not finite, one far away.
    let points: [[f32; 5]; 4] = [
        [5.2, -7.1, 0.9, 20.0, 3.0],
        [7.1, 3.0, -0.4, 20.0, 4.0],
        [f32::NAN, 0.0, 0.0, 0.0, 0.0],
        [400.0, 0.0, 0.0, 0.0, 0.0],
    ];
    let bytes: Vec<u8> = points.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(folder.path().join("samples/LIDAR_TOP/a2.bin"), bytes).expect("written");
    folder
}

fn data(token: &str, sample: &str, calibrated: &str, key: bool) -> Value {
    let (width, height) = if calibrated == "ccam" { (1600, 900) } else { (0, 0) };
    json!({"token": token, "sample_token": sample, "ego_pose_token": token, "calibrated_sensor_token": calibrated,
        "timestamp": 1, "fileformat": "pcd", "is_key_frame": key, "height": height, "width": width,
        "filename": format!("samples/LIDAR_TOP/{token}.bin"), "prev": "", "next": "", "unknown": [1, {"a": null}]})
}

fn annotation(
    token: &str,
    sample: &str,
    instance: &str,
    at: [f64; 3],
    attribute: Option<&str>,
    yaw_rad: f64,
) -> Value {
    let attributes: Vec<&str> = attribute.into_iter().collect();
    json!({"token": token, "sample_token": sample, "instance_token": instance, "visibility_token": "4",
        "attribute_tokens": attributes, "translation": at, "size": [2.5, 7.0, 2.8],
        "rotation": [(yaw_rad / 2.0).cos(), 0.0, 0.0, (yaw_rad / 2.0).sin()],
        "prev": "", "next": "", "num_lidar_pts": 5, "num_radar_pts": 0})
}

/// One truck ahead and to the left, elongated and turned: orders of quaternion and size, and the frame.
#[test]
fn a_truck_ahead_and_to_the_left_is_there() {
    let folder = foreign();
    let loaded = read(folder.path()).expect("as the data set is");
    let scene = loaded.scene;
    assert_eq!(
        (&*scene.name, &*scene.prompt),
        ("scene-0061", "Parked truck, construction, rain")
    );
    assert_eq!(scene.conditions.weather, Weather::Rain);
    let truck = scene.canvas().boxes[&BoxId(1)];
    assert_eq!(truck.class, Class::Truck);
    // All of it is marked as recorded, and still is when it was kept.
    let all: std::collections::BTreeSet<BoxId> = scene
        .canvas()
        .boxes
        .keys()
        .chain(scene.clip().tracks.keys())
        .copied()
        .collect();
    let kept = crate::loom::from_bytes(&crate::loom::to_bytes(&scene).expect("written")).expect("read");
    for scene in [&scene, &kept] {
        assert!(Recorded::boxes_in(scene) == all && Recorded::is_ego_in(scene));
    }
    assert!(
        (truck.center_m - DVec3::new(8.0, 3.0, 1.4)).length() < 1e-6,
        "{truck:?}"
    );
    assert!((truck.size_m - DVec3::new(7.0, 2.5, 2.8)).length() < 1e-12);
    assert!((truck.yaw_rad - 0.3).abs() < 1e-9);
    // A police car 20 m ahead drives on at 5 m in half a second.
    let track = &scene.clip().tracks[&BoxId(2)];
    assert_eq!(
        (track.made.class, track.made.label.name.as_str()),
        (Class::Car, "police car")
    );
    assert!((track.made.velocity_mps - DVec2::new(5.0 / 0.499_896, 0.0)).length() < 1e-6);
    let end_s = 0.499_896;
    // At either end it has that velocity, and so has the vehicle.
    for time_s in [0.0, end_s] {
        let b: SceneBox = scene.at(time_s).frame().boxes[&BoxId(2)];
        assert!(
            (b.velocity_mps - track.made.velocity_mps).length() < 1e-6,
            "{b:?}"
        );
        let ego = scene.clip().ego_moving(time_s).expect("it moves");
        assert!((ego.velocity_mps.x - 2.8 / end_s).abs() < 1e-6, "{ego:?}");
    }
    assert!((scene.clip().length_s - end_s).abs() < 1e-9);
    let b: SceneBox = scene.at(end_s).frame().boxes[&BoxId(2)];
    assert!(
        (b.center_m - DVec3::new(25.0, -2.0, 1.0)).length() < 1e-6,
        "{b:?}"
    );
    let ego = scene.at(end_s).frame().world_from_ego;
    assert!((ego.translation_m - DVec3::new(2.8, 0.0, 0.0)).length() < 1e-6);
    // The pose at the time of the LiDAR counts, not the camera's.
    assert_eq!(scene.rig.cameras[0].focal_px, [1266.0, 1267.0]);
    assert_eq!(scene.rig.lidars[0].translation_m, [0.9, 0.0, 1.8]);
    let radars: Vec<_> = scene
        .rig
        .radars
        .iter()
        .map(|r| (r.name.as_str(), r.translation_m))
        .collect();
    assert_eq!(radars, [("RADAR_FRONT", [3.4, 0.0, 0.5])]);
    let frame = scene.canvas();
    let label = |p: DVec3| {
        let [x, y, z] = frame.extent().voxel_at(p).expect("on the map");
        frame.occupancy.get(x, y, z)
    };
    assert_eq!(label(DVec3::new(6.1, -7.1, 2.7)), Class::Others.id(), "the wall");
    assert_eq!(
        label(DVec3::new(8.0, 3.0, 1.4)),
        Class::Truck.id(),
        "the truck's draft"
    );
    let expected = [
        ("LiDAR sweeps that could not be read", 1),
        ("boxes of human.pedestrian.stroller", 1),
        ("points that are not finite", 1),
        ("scenes", 1),
    ];
    let skipped: Vec<(&str, usize)> = loaded.skipped.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(skipped, expected);
}

/// The sweeps of key frames stay, each where the vehicle was; those that are damaged do not.
#[test]
fn sweeps_of_key_frames_stay_with_the_scene() {
    let folder = foreign();
    let kept = read(folder.path()).expect("as the data set is").with_recording();
    let [sweep] = kept.scene.kept.sweeps.as_slice() else {
        panic!("{:?}", kept.notes);
    };
    assert_eq!(&*sweep.file, "a2.bin");
    let bytes = std::fs::read(folder.path().join("samples/LIDAR_TOP/a2.bin")).expect("there");
    assert!(*sweep.bytes == bytes);
    let then = kept.scene.at(sweep.time_s).frame().world_from_ego;
    let lidar = DVec3::from_array(kept.scene.rig.lidars[0].translation_m);
    assert!(
        then.apply(lidar).distance(sweep.sensor_m) < 1e-9,
        "{}",
        sweep.sensor_m
    );
    let wall = sweep
        .returns
        .iter()
        .flatten()
        .filter(|r| r.place().distance(DVec3::new(6.1, -7.1, 2.7)) < 0.5);
    assert!(wall.count() > 0);
}

#[test]
fn occ3d_labels_beside_go_before_sweeps() {
    let folder = foreign();
    let mut labels = scene::VoxelGrid::new();
    (0..200).for_each(|x| labels.set(x, 100, 0, Class::DriveableSurface.id()));
    // The police car of the second key frame, 2.8 m nearer than the first, is in its labels; so is a hedge.
    (0..5).for_each(|z| labels.set(155, 95, z, Class::Car.id()));
    labels.set(150, 120, 3, Class::Vegetation.id());
    let place = folder.path().join("gts/scene-0061/b");
    std::fs::create_dir_all(&place).expect("made");
    std::fs::write(place.join("labels.npz"), crate::occ3d::to_bytes(&labels)).expect("written");
    let scene = read(folder.path()).expect("sound").scene;
    let frame = scene.canvas();
    let column = |x_m: f64, y_m: f64| {
        let [x, y] = frame.extent().column_at(x_m, y_m).expect("on the map");
        *frame.occupancy.window_column(x, y)
    };
    // Labels are in the ego frame of the second key frame, 2.8 m ahead of the world's.
    let center = scene::Window::center(150, 120, 3);
    assert_eq!(column(center.x + 2.8, center.y)[3], Class::Vegetation.id());
    let car = scene::Window::center(155, 95, 0);
    assert_eq!(
        column(car.x + 2.8, car.y),
        [Class::FREE; 16],
        "what moves is taken out"
    );
    assert!(frame.layout.count(BevLayer::DrivableArea) > 150);
}
