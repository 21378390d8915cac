//! Poses of the sweeps of a folder: 12 numbers a line as KITTI has them, or 8 as TUM has them (time, place, quaternion with w
//! last); times from `times.txt`, from the lines, or ten a second.

use std::path::{Path, PathBuf};

use glam::DVec3;
use scene::Pose;
use scene::message::quoted;

use crate::{FormatError, input, kitti};

/// Names of files of poses.
const NAMES: [&str; 4] = ["poses.txt", "poses.tum", "trajectory.txt", "traj.txt"];
const TIMES: &str = "times.txt";
/// Time between two sweeps if nobody tells, s.
const STEP_S: f64 = 0.1;
/// Largest error of a quaternion's length.
const ROUNDING: f64 = 0.01;

/// The file of poses in a folder.
pub(super) fn file_in(folder: &Path) -> Option<PathBuf> {
    NAMES
        .iter()
        .map(|name| folder.join(name))
        .find(|path| path.is_file())
}

/// Time in s and pose of each of `clouds` sweeps, by time. Errors in one line; notes say what was assumed.
pub(super) fn read(
    folder: &Path,
    clouds: usize,
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Pose)>, FormatError> {
    let path = file_in(folder).ok_or_else(|| FormatError::new("no poses.txt"))?;
    read_file(&path, folder, clouds, notes)
}

/// The same from this file; times are those of the folder.
pub(super) fn read_file(
    path: &Path,
    folder: &Path,
    clouds: usize,
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Pose)>, FormatError> {
    let named = |e: FormatError| e.at(&path.display());
    let text = text(path)?;
    let lines = text.lines().map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let poses: Result<Vec<(Option<f64>, Pose)>, FormatError> = lines
        .enumerate()
        .map(|(i, line)| {
            pose(line).ok_or_else(|| {
                let found = quoted(line, 60);
                FormatError::new(format!(
                    "pose {i}: {found}, expected 12 numbers (rotation and place by rows) or 8 (time, place, quaternion x y z w)"
                ))
            })
        })
        .collect();
    let poses = poses.map_err(named)?;
    if poses.len() < clouds {
        let line = format!("{} poses for {clouds} clouds", poses.len());
        return Err(named(FormatError::new(line)));
    }
    if poses.len() > clouds {
        notes.push(format!(
            "{} poses for {clouds} clouds: the first are taken",
            poses.len()
        ));
    }
    let times = times(folder, &poses[..clouds], notes)?;
    let known: Vec<(f64, Pose)> = times.into_iter().zip(poses.into_iter().map(|p| p.1)).collect();
    let backwards = known.windows(2).filter(|two| two[1].0 <= two[0].0).count();
    match backwards {
        0 => Ok(known),
        n => Err(FormatError::new(format!(
            "times: {n} of {clouds} are not later than the one before, expected rising times in s"
        ))),
    }
}

/// Times of the sweeps, s from any origin.
fn times(
    folder: &Path,
    poses: &[(Option<f64>, Pose)],
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, FormatError> {
    let path = folder.join(TIMES);
    if path.is_file() {
        let text = text(&path)?;
        let words = text.split_whitespace();
        let times: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        if times.len() < poses.len() || times.iter().any(|t| !t.is_finite()) {
            let line = format!("{} times for {} clouds", times.len(), poses.len());
            return Err(FormatError::new(line).at(&path.display()));
        }
        return Ok(times);
    }
    if let Some(times) = poses.iter().map(|(time_s, _)| *time_s).collect() {
        return Ok(times);
    }
    notes.push("times are not told: ten sweeps a second are assumed".into());
    Ok((0..poses.len()).map(|i| i as f64 * STEP_S).collect())
}

fn text(path: &Path) -> Result<String, FormatError> {
    let bytes = input::read(path, input::LARGEST_TEXT).map_err(FormatError::new)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The pose of a line, and its time if it has one.
fn pose(line: &str) -> Option<(Option<f64>, Pose)> {
    if let Some(pose) = kitti::pose_from(line) {
        return Some((None, pose));
    }
    let numbers: Option<Vec<f64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
    let [time_s, x, y, z, qx, qy, qz, qw]: [f64; 8] = numbers?.try_into().ok()?;
    let length = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
    let at = DVec3::new(x, y, z);
    let is_sound = (length - 1.0).abs() <= ROUNDING && at.is_finite() && time_s.is_finite();
    is_sound.then(|| (Some(time_s), Pose::from_wxyz([qw, qx, qy, qz], at.to_array())))
}
