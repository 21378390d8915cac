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
    let (length_s, notes) = told([at(0.0), at(1.0), at(900.0), at(2.0)]);
    assert!(
        (length_s - 0.1).abs() < 1e-9 && notes.contains("2 sweeps after a jump"),
        "{notes}"
    );
    assert!(notes.contains("ten sweeps a second"), "{notes}");
    // (the second is 45 m away, the last ones farther than is read)
    let far = |x: f64| at(x * 0.999);
    let (_, notes) = told([far(0.0), far(45.0), at(90.0), at(135.0)]);
    assert!(!notes.contains("farther"), "{notes}");
}
