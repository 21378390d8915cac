//! Tests of sequences of KITTI.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{BevLayout, BoxId, Camera, Class, Frame, Key, Motion, Scene, SceneBox, SensorRig, VoxelGrid};

use super::*;
use crate::points_tests::{OneSweep, point, sweep};

/// A car ahead to the left, turned by 30 degrees.
fn car() -> SceneBox {
    SceneBox {
        id: BoxId(9),
        class: Class::Car,
        center_m: DVec3::new(16.0, 4.0, 0.85),
        size_m: DVec3::new(4.6, 1.9, 1.7),
        yaw_rad: 30f64.to_radians(),
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

/// A rig of one LiDAR and a camera that looks ahead, 12 degrees down, and one that looks back.
fn rig() -> SensorRig {
    let mut front = Camera::new("front", 80.0);
    front.translation_m = [1.5, 0.2, 1.6];
    let mut aim = front.aim();
    (aim.pitch_deg, aim.yaw_deg) = (-12.0, 5.0);
    front.set_aim(aim);
    let mut back = Camera::new("back", 80.0);
    aim.yaw_deg = 180.0;
    back.set_aim(aim);
    SensorRig {
        cameras: vec![back, front],
        ..SensorRig::default()
    }
}

fn scene_of(boxes: &[SceneBox], occupancy: VoxelGrid) -> Scene {
    let boxes: BTreeMap<_, _> = boxes.iter().map(|b| (b.id, *b)).collect();
    let frame = Frame::new(BevLayout::default(), boxes, occupancy);
    Scene::single("s", frame, Arc::new(rig()), 1)
}

fn files(scene: &Scene, points: Vec<scene::LidarPoint>) -> BTreeMap<String, Vec<u8>> {
    let files = write(scene, &mut OneSweep(sweep(points))).expect("a rig");
    files.into_iter().map(|f| (f.name, f.bytes)).collect()
}

fn text(files: &BTreeMap<String, Vec<u8>>, name: &str) -> String {
    String::from_utf8(files[name].clone()).expect("text")
}

/// The numbers of a line of a calibration.
fn numbers(text: &str, key: &str) -> Vec<f64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key)?.strip_prefix(": "));
    let words = line.unwrap_or_else(|| panic!("no {key}")).split(' ');
    words.map(|w| w.parse().expect("a number")).collect()
}

/// A 3 x 4 matrix times a point.
fn times(m: &[f64], p: DVec3) -> DVec3 {
    DVec3::from_array([0, 4, 8].map(|i| m[i] * p.x + m[i + 1] * p.y + m[i + 2] * p.z + m[i + 3]))
}

#[test]
fn scan_labels_and_calibration_say_what_they_must() {
    let moving = scene::LidarPoint {
        velocity_mps: [3.0, 0.0],
        ..point(DVec3::new(16.0, 4.0, 1.0), Class::Car)
    };
    let points = vec![
        moving,
        point(DVec3::new(16.0, 4.0, 1.2), Class::Car),
        point(DVec3::new(-9.0, 4.0, 1.2), Class::Car),
        point(DVec3::new(16.0, 4.0, 0.0), Class::Sidewalk),
    ];
    let scene = scene_of(&[car()], VoxelGrid::new());
    let files = files(&scene, points);
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let expected = "calib.txt calib/000000.txt label_2/000000.txt labels/000000.label poses.txt times.txt velodyne/000000.bin";
    assert_eq!(names.join(" "), expected);
    // The LiDAR is 0.943713 m ahead and 1.84023 m high; strength 51 of 255.
    let first: Vec<f32> = files["velodyne/000000.bin"][..16]
        .chunks(4)
        .map(|b| f32::from_le_bytes(b.try_into().expect("four")))
        .collect();
    assert_eq!(first, [15.056287, 4.0, -0.84023, 0.2]);
    let labels: Vec<u32> = files["labels/000000.label"]
        .chunks(4)
        .map(|b| u32::from_le_bytes(b.try_into().expect("four")))
        .collect();
    assert_eq!(labels, [1 << 16 | 252, 1 << 16 | 10, 10, 48]);
    assert_eq!(text(&files, "times.txt"), "0.000000e0\n");
    let pose = numbers(&format!("p: {}", text(&files, "poses.txt").trim()), "p");
    assert_eq!(pose, [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
}

/// A point of the scan, taken through the calibration as the development kits do, is where the camera sees it.
#[test]
fn calibration_takes_points_to_pixels() {
    let scene = scene_of(&[], VoxelGrid::new());
    let files = files(&scene, Vec::new());
    let (odometry, objects) = (text(&files, "calib.txt"), text(&files, "calib/000000.txt"));
    let tr = numbers(&objects, "Tr_velo_to_cam");
    assert_eq!(tr, numbers(&odometry, "Tr"));
    let to_velo = numbers(&odometry, "Tr_ego_to_velo");
    assert_eq!(
        (to_velo.clone(), numbers(&objects, "R0_rect").len()),
        (numbers(&objects, "Tr_imu_to_velo"), 9)
    );
    let camera = &rig().cameras[1];
    for at in [
        DVec3::new(20.0, 1.0, 0.5),
        DVec3::new(9.0, 5.0, 2.0),
        DVec3::new(40.0, -9.0, 0.0),
    ] {
        let in_rect = times(&tr, times(&to_velo, at));
        assert!((in_rect.y - (1.6 - at.z)).abs() < 1e-9, "level: {in_rect}");
        let p = times(&numbers(&objects, "P2"), in_rect);
        let in_camera = camera.ego_from_camera().inverse().apply(at);
        let x = camera.focal_px[0] * in_camera.x / in_camera.z + camera.center_px[0];
        let y = camera.focal_px[1] * in_camera.y / in_camera.z + camera.center_px[1];
        assert!(
            (p.x / p.z - x).abs() < 1e-6 && (p.y / p.z - y).abs() < 1e-6,
            "{p} {x} {y}"
        );
    }
}

fn objects_of(scene: &Scene) -> Vec<Vec<String>> {
    let text = text(&files(scene, Vec::new()), "label_2/000000.txt");
    text.lines()
        .map(|l| l.split(' ').map(str::to_owned).collect())
        .collect()
}

/// The box of a label, built as the development kit does (`computeBox3D.m`), has the corners of the box.
#[test]
fn an_elongated_rotated_box_is_where_it_was() {
    let lines = objects_of(&scene_of(&[car()], VoxelGrid::new()));
    let [line] = lines.as_slice() else {
        panic!("{lines:?}");
    };
    let n: Vec<f64> = line[1..].iter().map(|w| w.parse().expect("a number")).collect();
    assert_eq!((line.len(), line[0].as_str(), n[0], n[1]), (15, "Car", 0.0, 0.0));
    assert_eq!(n[7..10], [1.7, 1.9, 4.6]);
    let (place, rotation_y) = (DVec3::new(n[10], n[11], n[12]), n[13]);
    let camera = FrontCamera::from_rig(&rig()).expect("a front camera");
    let (sin, cos) = rotation_y.sin_cos();
    for (l, w, h) in [(2.3, 0.95, 0.0), (-2.3, 0.95, -1.7), (2.3, -0.95, -1.7)] {
        // x along the length, z along the width, y down.
        let corner = place + DVec3::new(cos * l + sin * w, h, -sin * l + cos * w);
        let in_ego = camera.ego_from_rect.apply(corner);
        let local = car().to_local(in_ego).abs() * 2.0;
        assert!((local - car().size_m).length() < 1e-3, "{local}");
        let ahead = car().to_local(in_ego).x;
        assert_eq!(ahead > 0.0, l > 0.0, "the front is the front");
    }
    let alpha = rotation_y - place.x.atan2(place.z);
    assert!((n[2] - alpha).abs() < 1e-3);
    // The rectangle holds every corner.
    for corner in corners(&car()) {
        let p = camera
            .pixel(camera.ego_from_rect.inverse().apply(corner))
            .expect("ahead");
        assert!(n[3] - 0.01 <= p.x && p.x <= n[5] + 0.01 && n[4] - 0.01 <= p.y && p.y <= n[6] + 0.01);
    }
}

fn corners(b: &SceneBox) -> Vec<DVec3> {
    let side = |i: usize, bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
    let corner = |i| b.to_ego(b.size_m * DVec3::new(side(i, 0), side(i, 1), side(i, 2)));
    (0..8).map(corner).collect()
}

#[test]
fn what_is_hidden_cut_or_without_a_name_is_told() {
    let moved = |id: u32, x: f64, y: f64, class: Class| SceneBox {
        id: BoxId(id),
        center_m: DVec3::new(x, y, 0.85),
        class,
        yaw_rad: 0.0,
        ..car()
    };
    let boxes = [
        moved(1, 14.0, 0.0, Class::Bus),
        moved(2, 5.0, -4.2, Class::Truck),
        moved(3, -14.0, 0.0, Class::Car),
        moved(4, 20.0, 5.0, Class::TrafficCone),
        moved(5, 20.0, -6.0, Class::Bicycle),
        moved(6, 200.0, 0.0, Class::Car),
    ];
    let lines = objects_of(&scene_of(&boxes, VoxelGrid::new()));
    let names: Vec<&str> = lines.iter().map(|l| l[0].as_str()).collect();
    assert_eq!(names, ["Misc", "Truck", "Cyclist"]);
    let truncated: Vec<f64> = lines.iter().map(|l| l[1].parse().expect("a number")).collect();
    assert!(
        truncated[0] == 0.0 && truncated[1] > 0.2 && truncated[1] < 1.0,
        "{truncated:?}"
    );
    // A wall before the first one, lower than it is high, then higher.
    let with_wall = |top: usize| {
        let mut grid = VoxelGrid::new();
        for y in 90..110 {
            (0..top).for_each(|z| grid.set(120, y, z, Class::Manmade.id()));
        }
        let lines = objects_of(&scene_of(&boxes[..1], grid));
        lines.first().map(|l| l[2].clone())
    };
    assert_eq!(with_wall(0).as_deref(), Some("0"));
    assert!(
        matches!(with_wall(5).as_deref(), Some("1" | "2")),
        "{:?}",
        with_wall(5)
    );
    assert_eq!(with_wall(12), None);
}

#[test]
fn a_clip_is_a_scan_every_tenth_of_a_second_and_a_pose() {
    let mut scene = scene_of(&[], VoxelGrid::new());
    scene.change_clip(|clip| {
        clip.length_s = 0.5;
        let key = |time_s: f64| Key {
            time_s,
            at_m: DVec2::new(10.0 * time_s, 0.0),
            yaw_deg: 0.0,
        };
        clip.ego = Some(Motion::Keys(vec![key(0.0), key(0.5)]));
    });
    let files = files(&scene, vec![point(DVec3::new(5.0, 1.0, 1.0), Class::Car)]);
    let scans = files.keys().filter(|n| n.starts_with("velodyne/")).count();
    assert_eq!((scans, text(&files, "times.txt").lines().count()), (6, 6));
    let poses = text(&files, "poses.txt");
    let last: Vec<f64> = poses
        .lines()
        .last()
        .expect("six")
        .split(' ')
        .map(|w| w.parse().expect("a number"))
        .collect();
    // The camera looks 5 degrees to the left: 5 m along the vehicle are along its z, a little along its x.
    let (sin, cos) = 5f64.to_radians().sin_cos();
    let place = DVec3::new(last[3], last[7], last[11]);
    assert!(
        (place - DVec3::new(5.0 * sin, 0.0, 5.0 * cos)).length() < 1e-6,
        "{place}"
    );
    scene.change_clip(|clip| clip.length_s = 200.0);
    let line = write(&scene, &mut OneSweep(sweep(Vec::new())))
        .map(drop)
        .expect_err("long")
        .to_string();
    assert_eq!(line, "2001 scans in 200.0 s, expected at most 1000");
}

#[test]
fn without_a_front_camera_there_are_scans_and_no_objects() {
    let mut scene = scene_of(&[car()], VoxelGrid::new());
    Arc::make_mut(&mut scene.rig).cameras.pop();
    let files_of = files(&scene, Vec::new());
    assert!(files_of.keys().all(|name| !name.starts_with("label_2")));
    let tr = numbers(&text(&files_of, "calib.txt"), "Tr");
    assert_eq!(times(&tr, DVec3::new(1.0, 2.0, 3.0)), DVec3::new(-2.0, -3.0, 1.0));
    Arc::make_mut(&mut scene.rig).lidars.clear();
    assert!(write(&scene, &mut OneSweep(sweep(Vec::new()))).is_err());
}
