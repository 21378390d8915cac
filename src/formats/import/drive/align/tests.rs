//! Tests on made sweeps and on those of other people, whose poses are known.

use std::path::PathBuf;

use glam::DQuat;

use super::*;
use crate::sweep_file::{self, SweepFile};

/// Folder of other people's sweeps, if it is there.
fn sweeps() -> Option<PathBuf> {
    let data = std::env::var_os("SCENELOOM_DATA").map(PathBuf::from);
    let data =
        data.unwrap_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")));
    let folder = data.join("sweeps");
    if !folder.is_dir() {
        println!("skipped: no sweeps in {}", folder.display());
        return None;
    }
    Some(folder)
}

fn survey(path: &std::path::Path) -> Vec<DVec3> {
    let bytes = std::fs::read(path).expect("read");
    let file = SweepFile::open(sweep_file::format_of(&path.to_string_lossy()), &bytes).expect("sound");
    let returns = file.returns(&Pose::IDENTITY).into_iter().flatten();
    surveyed(returns.map(|r| r.place()))
}

fn slices(clouds: &[Vec<DVec3>]) -> Vec<&[DVec3]> {
    clouds.iter().map(Vec::as_slice).collect()
}

fn off(place_m: [f64; 3], turn_deg: [f64; 3]) -> Pose {
    let [x, y, z] = turn_deg.map(f64::to_radians);
    Pose {
        rotation: DQuat::from_euler(glam::EulerRot::XYZ, x, y, z),
        translation_m: DVec3::from_array(place_m),
    }
}

#[test]
fn sweeps_of_a_street_come_to_where_they_were_measured() {
    let Some(folder) = sweeps() else { return };
    let drive = folder.join("os1_drive");
    let text = std::fs::read_to_string(drive.join("poses.txt")).expect("poses");
    let truth: Vec<Pose> = text.lines().filter_map(crate::kitti::pose_from).collect();
    let clouds: Vec<Vec<DVec3>> = (0..3)
        .map(|i| survey(&drive.join(format!("00000{i}.pcd"))))
        .collect();
    let errors = [
        off([0.0; 3], [0.0; 3]),
        off([0.1, -0.1, 0.3], [0.0, 1.5, 0.4]),
        off([0.0, -0.2, 0.5], [1.0, 0.5, 0.9]),
    ];
    let given: Vec<Pose> = truth.iter().zip(errors).map(|(pose, by)| *pose * by).collect();
    let found = align(&slices(&clouds), &given);
    assert_eq!(found.unaligned, 0);
    for (i, (pose, truth)) in found.poses.iter().zip(&truth).enumerate() {
        let (m, rad) = difference(pose, truth);
        println!(
            "os1_drive {i}: {:.3} m, {:.2} deg off, rms {:.3} m",
            m,
            rad.to_degrees(),
            found.rms_m
        );
        assert!(m < 0.02 && rad.to_degrees() < 0.1, "{i}");
    }
    // Poses that are known well stay to the last bit.
    assert_eq!(align(&slices(&clouds), &truth).poses, truth);
}

#[test]
fn a_tilted_pair_comes_to_its_makers_relation() {
    let Some(folder) = sweeps() else { return };
    let pair = folder.join("registration");
    let text = std::fs::read_to_string(pair.join("T_target_source.txt")).expect("a relation");
    let line: Vec<&str> = text.split_whitespace().take(12).collect();
    let truth = crate::kitti::pose_from(&line.join(" ")).expect("a pose");
    let clouds = ["target.ply", "source.ply"].map(|name| survey(&pair.join(name)));
    let found = align(&slices(&clouds), &[Pose::IDENTITY; 2]);
    let (m, rad) = difference(&found.poses[1], &truth);
    println!(
        "registration: {m:.3} m, {:.2} deg off, rms {:.3} m",
        rad.to_degrees(),
        found.rms_m
    );
    assert!(found.unaligned == 0 && m < 0.05 && rad.to_degrees() < 0.4);
}
