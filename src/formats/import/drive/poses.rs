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

/// Time in s and pose of each sweep, by time; `numbers` are those of their files. Errors in one line; notes say what was assumed.
pub(super) fn read(
    folder: &Path,
    numbers: &[u64],
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Pose)>, FormatError> {
    let path = file_in(folder).ok_or_else(|| FormatError::new("no poses.txt"))?;
    read_file(&path, folder, numbers, notes)
}

/// The same from this file; times are those of the folder.
pub(super) fn read_file(
    path: &Path,
    folder: &Path,
    numbers: &[u64],
    notes: &mut Vec<String>,
) -> Result<Vec<(f64, Pose)>, FormatError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let named = |e: FormatError| e.at(&name);
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
    let clouds = numbers.len();
    if poses.len() < clouds {
        let line = format!("{} poses for {clouds} clouds", poses.len());
        return Err(named(FormatError::new(line)));
    }
    // Where files are missing, those that are there have the poses of their numbers.
    let is_numbered = numbers.iter().all(|number| (*number as usize) < poses.len());
    let place = |i: usize| match poses.len() > clouds && is_numbered {
        true => numbers[i] as usize,
        false => i,
    };
    if poses.len() > clouds {
        let taken = if is_numbered {
            "those of their numbers"
        } else {
            "the first"
        };
        notes.push(format!(
            "{} poses for {clouds} clouds: {taken} are taken",
            poses.len()
        ));
    }
    let places: Vec<usize> = (0..clouds).map(place).collect();
    let times = times(folder, &poses, &places, notes)?;
    let known: Vec<(f64, Pose)> = times
        .into_iter()
        .zip(places.iter().map(|place| poses[*place].1))
        .collect();
    let backwards = known.windows(2).filter(|two| two[1].0 <= two[0].0).count();
    match backwards {
        0 => Ok(known),
        n => Err(FormatError::new(format!(
            "times: {n} of {clouds} are not later than the one before, expected rising times in s"
        ))),
    }
}

/// Times of the sweeps, s from any origin, whose poses are at these places in the list.
fn times(
    folder: &Path,
    poses: &[(Option<f64>, Pose)],
    places: &[usize],
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, FormatError> {
    let path = folder.join(TIMES);
    if path.is_file() {
        let text = text(&path)?;
        let words = text.split_whitespace();
        let times: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        if times.len() < places.len() || times.iter().any(|t| !t.is_finite()) {
            let line = format!("{} times for {} clouds", times.len(), places.len());
            return Err(FormatError::new(line).at(&TIMES));
        }
        // One for each pose, or one for each cloud.
        let of_poses = times.len() >= poses.len();
        let time = |(i, place): (usize, &usize)| times[if of_poses { *place } else { i }];
        return Ok(places.iter().enumerate().map(time).collect());
    }
    if let Some(times) = places.iter().map(|place| poses[*place].0).collect() {
        return Ok(times);
    }
    notes.push("times are not told: ten sweeps a second are assumed".into());
    Ok(places.iter().map(|place| *place as f64 * STEP_S).collect())
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
