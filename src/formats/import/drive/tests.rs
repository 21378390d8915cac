//! Tests of folders of sweeps: made ones, whose truth is known.

use tempfile::TempDir;

use super::*;
use crate::import::{self, ImportOptions};

/// A street of ground and two walls in the world, as a sensor at `pose`, 2 m above the ground, sees it: KITTI's form.
fn scan(pose: &Pose) -> Vec<u8> {
    let sensor_from_world = pose.inverse();
    let mut bytes = Vec::new();
    let mut put = |p: DVec3| {
        let at = sensor_from_world.apply(p);
        let numbers = [at.x as f32, at.y as f32, at.z as f32, 0.5];
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    };
    for i in -60..=60 {
        for j in -30..=30 {
            put(DVec3::new(f64::from(i) * 0.5, f64::from(j) * 0.4, -2.0));
        }
        for j in 0..10 {
            for side in [-12.5, 12.5] {
                put(DVec3::new(f64::from(i) * 0.5, side, -1.8 + f64::from(j) * 0.4));
            }
        }
    }
    bytes
}

/// Poses of a vehicle that drives ahead and to the left.
fn poses() -> Vec<Pose> {
    (0..4)
        .map(|i| Pose::planar(f64::from(i) * 1.5, f64::from(i) * 0.2, 0.05 * f64::from(i)))
        .collect()
}

fn kitti_line(pose: &Pose) -> String {
    let m = glam::DMat3::from_quat(pose.rotation).transpose().to_cols_array();
    let t = pose.translation_m;
    let row = |i: usize, t: f64| format!("{} {} {} {t}", m[3 * i], m[3 * i + 1], m[3 * i + 2]);
    format!("{} {} {}\n", row(0, t.x), row(1, t.y), row(2, t.z))
}

fn tum_line(time_s: f64, pose: &Pose) -> String {
    let (q, t) = (pose.rotation, pose.translation_m);
    format!(
        "{time_s} {} {} {} {} {} {} {}\n",
        t.x, t.y, t.z, q.x, q.y, q.z, q.w
    )
}

/// A folder of the four scans with these other files.
fn folder(others: &[(&str, String)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (i, pose) in poses().iter().enumerate() {
        std::fs::write(folder.path().join(format!("{i:06}.bin")), scan(pose)).expect("written");
    }
    for (name, text) in others {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn loaded(folder: &TempDir) -> Result<ImportedScene, FormatError> {
    match import::read_with(folder.path(), ImportOptions::default())?.1 {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}"),
    }
}

fn all_poses() -> String {
    poses().iter().map(kitti_line).collect()
}

#[test]
fn sweeps_become_one_scene_and_the_poses_its_motion() {
    let times = ("times.txt", "10\n10.5\n11\n11.5\n".to_owned());
    let tum: String = poses()
        .iter()
        .enumerate()
        .map(|(i, pose)| tum_line(10.0 + 0.5 * i as f64, pose))
        .collect();
    for others in [
        vec![("poses.txt", all_poses()), times],
        vec![("poses.txt", format!("# time x y z qx qy qz qw\n{tum}"))],
    ] {
        let found = loaded(&folder(&others)).expect("sound");
        let scene = &found.scene;
        assert_eq!(scene.clip().length_s, 1.5);
        for (i, pose) in poses().iter().enumerate() {
            let there = scene.at(0.5 * i as f64).frame().world_from_ego;
            let off_m = there
                .translation_m
                .truncate()
                .distance(pose.translation_m.truncate());
            assert!(off_m < 1e-6, "{i}: {off_m}");
            assert!(there.rotation.angle_between(pose.rotation) < 1e-6);
        }
        // Walls of all sweeps fall together, at the height of the ground.
        let frame = scene.frame();
        let column = |x: f64, y: f64| {
            let [x, y] = frame.extent().column_at(x, y).expect("on the map");
            frame
                .occupancy
                .column(x, y)
                .iter()
                .filter(|l| **l != scene::Class::FREE)
                .count()
        };
        assert!(column(0.1, 12.5) > 5 && column(0.1, 11.0) <= 2);
        // Each file stays, and lies where its returns are in the world.
        let kept = found.with_recording();
        let sweeps = &kept.scene.kept.sweeps;
        assert_eq!(sweeps.len(), 4);
        for (sweep, pose) in sweeps.iter().zip(poses()) {
            assert!(*sweep.bytes == scan(&pose));
            let on_ground = sweep.returns.iter().flatten().filter(|r| r.at_m[2].abs() < 0.02);
            assert_eq!(on_ground.count(), 121 * 61, "{}", sweep.file);
        }
        assert!(
            kept.notes.iter().any(|n| n.contains("4 sweeps of 1.5 s")),
            "{:?}",
            kept.notes
        );
    }
}

#[test]
fn what_is_wrong_with_a_folder_is_one_line() {
    let refused = |others: &[(&str, String)]| {
        let line = loaded(&folder(others))
            .map(drop)
            .expect_err("refused")
            .to_string();
        assert!(!line.contains('\n'), "{line}");
        line
    };
    assert!(refused(&[]).contains("poses.txt"));
    let three: String = poses()[..3].iter().map(kitti_line).collect();
    assert!(refused(&[("poses.txt", three)]).contains("3 poses for 4 clouds"));
    assert!(refused(&[("poses.txt", "1 2 3\n".repeat(4))]).contains("expected 12 numbers"));
    assert!(
        refused(&[(
            "poses.txt",
            kitti_line(&Pose::IDENTITY).replace('1', "nan").repeat(4)
        )])
        .contains("pose 0")
    );
    let w_first = "0 0 0 0 2 0 0 0\n".repeat(4);
    assert!(refused(&[("poses.txt", w_first)]).contains("quaternion"));
    let backwards = ("times.txt", "3 2 1 0".to_owned());
    assert!(refused(&[("poses.txt", all_poses()), backwards]).contains("not later"));
    let few = ("times.txt", "3 4".to_owned());
    assert!(refused(&[("poses.txt", all_poses()), few]).contains("2 times for 4"));
    let cut = folder(&[("poses.txt", all_poses())]);
    std::fs::write(cut.path().join("000002.bin"), [1u8; 17]).expect("written");
    assert!(
        loaded(&cut)
            .map(drop)
            .expect_err("cut")
            .to_string()
            .contains("000002.bin")
    );
}

#[test]
fn jumps_and_far_sweeps_are_left_out_and_told() {
    let at = |x: f64| kitti_line(&Pose::planar(x, 0.0, 0.0));
    let told = |lines: [String; 4]| {
        let found = loaded(&folder(&[("poses.txt", lines.concat())])).expect("the first ones");
        (found.scene.clip().length_s, found.notes.join("; "))
    };
    // One wrong pose costs its sweep alone.
    let (length_s, notes) = told([at(0.0), at(1.0), at(900.0), at(2.0)]);
    assert!(
        (length_s - 0.3).abs() < 1e-9 && notes.contains("1 sweeps that jump"),
        "{notes}"
    );
    let (length_s, notes) = told([at(0.0), at(1.0), at(900.0), at(901.0)]);
    assert!(
        (length_s - 0.1).abs() < 1e-9 && notes.contains("2 sweeps that jump"),
        "{notes}"
    );
    assert!(notes.contains("ten sweeps a second"), "{notes}");
    // (the second is 45 m away, the last ones farther than is read)
    let far = |x: f64| at(x * 0.999);
    let (_, notes) = told([far(0.0), far(45.0), at(90.0), at(135.0)]);
    assert!(!notes.contains("farther"), "{notes}");
}

/// The four scans as KITTI's odometry has them, poses those of the left camera, and as its raw drives do, with an IMU.
#[test]
fn sequences_of_kitti_are_drives() {
    let camera_from_velo = Pose {
        rotation: glam::DQuat::from_mat3(&glam::DMat3::from_cols_array(&[
            0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0,
        ])),
        translation_m: DVec3::new(0.01, -0.08, -0.27),
    };
    let write = |folder: &Path, name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, bytes).expect("written");
    };
    let odometry = tempfile::tempdir().expect("a folder");
    let raw = tempfile::tempdir().expect("a folder");
    let velo_from_imu = Pose {
        rotation: glam::DQuat::from_rotation_z(0.01),
        translation_m: DVec3::new(-0.81, 0.32, -0.8),
    };
    let (mut cameras, mut clock) = (String::new(), String::new());
    for (i, pose) in poses().iter().enumerate() {
        write(
            odometry.path(),
            &format!("sequences/07/velodyne/{i:06}.bin"),
            &scan(pose),
        );
        cameras += &kitti_line(&(camera_from_velo * *pose * camera_from_velo.inverse()));
        let drive = raw.path().join("drive_0001");
        write(&drive, &format!("velodyne_points/data/{i:010}.bin"), &scan(pose));
        clock += &format!("2011-09-26 23:59:{:09.6}\n", 59.2 + 0.1 * i as f64);
        // Places by satellite, as the development kit's projection has them.
        let imu = *pose * velo_from_imu;
        let scale = 49f64.to_radians().cos() * 6_378_137.0;
        let origin = DVec3::new(900_000.0, scale * (139f64.to_radians() / 2.0).tan().ln(), 110.0);
        let at = origin + imu.translation_m;
        let latitude = 2.0 * (at.y / scale).exp().atan().to_degrees() - 90.0;
        let (yaw, pitch, roll) = imu.rotation.to_euler(glam::EulerRot::ZYX);
        let line = format!(
            "{latitude:.13} {:.13} {} {roll} {pitch} {yaw} 0 0 0",
            (at.x / scale).to_degrees(),
            at.z
        );
        write(&drive, &format!("oxts/data/{i:010}.txt"), line.as_bytes());
    }
    let folder = odometry.path().join("sequences/07");
    write(
        &folder,
        "calib.txt",
        format!(
            "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: {}",
            kitti_line(&camera_from_velo)
        )
        .as_bytes(),
    );
    write(&folder, "times.txt", b"0\n0.1\n0.2\n0.3\n");
    write(odometry.path(), "poses/07.txt", cameras.as_bytes());
    write(
        &raw.path().join("drive_0001"),
        "velodyne_points/timestamps.txt",
        clock.as_bytes(),
    );
    let r = glam::DMat3::from_quat(velo_from_imu.rotation)
        .transpose()
        .to_cols_array();
    let numbers = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let calibration = format!(
        "R: {}\nT: {}\n",
        numbers(&r),
        numbers(&velo_from_imu.translation_m.to_array())
    );
    write(raw.path(), "calib_imu_to_velo.txt", calibration.as_bytes());
    for folder in [folder, raw.path().join("drive_0001")] {
        let read = import::read_with(&folder, ImportOptions::default())
            .expect("a drive")
            .1;
        let Content::Scene(found) = read else {
            panic!("no scene")
        };
        assert_eq!(found.moments(), 4, "{:?}", found.notes);
        let scene = &found.scene;
        assert!(
            (scene.clip().length_s - 0.3).abs() < 1e-6,
            "{}",
            scene.clip().length_s
        );
        for (i, pose) in poses().iter().enumerate() {
            let there = scene.at(0.1 * i as f64).frame().world_from_ego;
            let off_m = there
                .translation_m
                .truncate()
                .distance(pose.translation_m.truncate());
            assert!(off_m < 0.03, "{i}: {off_m}");
        }
    }
}

#[test]
fn sweeps_have_the_poses_of_their_numbers_where_files_are_missing() {
    let folder = folder(&[("poses.txt", all_poses()), ("times.txt", "0 0.5 1.0 1.5".into())]);
    std::fs::remove_file(folder.path().join("000001.bin")).expect("removed");
    let found = loaded(&folder).expect("sound");
    let notes = found.notes.join("; ");
    assert!(
        notes.contains("4 poses for 3 clouds: those of their numbers"),
        "{notes}"
    );
    assert_eq!(found.scene.clip().length_s, 1.5);
    let there = found.scene.at(1.0).frame().world_from_ego.translation_m;
    assert!(there.truncate().distance(poses()[2].translation_m.truncate()) < 0.03);
}
