//! Sequences of KITTI: scans of a velodyne in a folder of their own, with poses of another sensor.
//!
//! - **Odometry and SemanticKITTI**: `velodyne/`, `calib.txt`, `times.txt`; poses of the left camera in `poses.txt`, or in
//!   `../../poses/NAME.txt`. With `Tr` from `calib.txt` the velodyne is at `Tr⁻¹ P Tr`.
//! - **Raw**: `velodyne_points/data/`, `velodyne_points/timestamps.txt`; places of an IMU by satellite in `oxts/data/`, and where the
//!   velodyne is from there in `../calib_imu_to_velo.txt`.
//!
//! Geiger et al., "Vision meets Robotics", 2013; the Mercator projection of the places is that of its development kit.

use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3};
use scene::Pose;

use super::{clouds, poses};
use crate::{FormatError, input, kitti};

/// Folders of scans.
const SCANS: &str = "velodyne";
const RAW: &str = "velodyne_points";
const RAW_TIMES: &str = "timestamps.txt";
/// Radius of the earth of the projection, m.
const EARTH_M: f64 = 6_378_137.0;
/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// Scans, and time in s and pose of each.
pub(super) struct Sequence {
    pub(super) clouds: Vec<(u64, PathBuf)>,
    pub(super) poses: Vec<(f64, Pose)>,
}

/// The file by which a sequence with poses is known.
pub(super) fn file_in(folder: &Path) -> Option<PathBuf> {
    let calibration = folder.join("calib.txt");
    // Scans with labels are read one by one.
    let is_odometry = clouds(&folder.join(SCANS)).len() > 1
        && !folder.join("labels").is_dir()
        && calibration.is_file()
        && camera_poses(folder).is_some();
    let times = folder.join(RAW).join(RAW_TIMES);
    let is_raw = times.is_file()
        && folder.join("oxts/data").is_dir()
        && clouds(&folder.join(RAW).join("data")).len() > 1;
    is_odometry
        .then_some(calibration)
        .or_else(|| is_raw.then_some(times))
}

/// The folder of a sequence, from the file by which it is known.
pub(super) fn folder_of(file: &Path) -> Option<&Path> {
    let folder = file.parent()?;
    match folder.file_name().is_some_and(|name| name == RAW) {
        true => folder.parent(),
        false => Some(folder),
    }
}

/// Poses of the left camera.
fn camera_poses(folder: &Path) -> Option<PathBuf> {
    let name = folder.canonicalize().ok()?.file_name()?.to_owned();
    let beside = folder.join("../../poses").join(name).with_extension("txt");
    poses::file_in(folder).or_else(|| beside.is_file().then_some(beside))
}

/// Reads a sequence; `None` if the folder is none. Errors in one line.
pub(super) fn read(folder: &Path, notes: &mut Vec<String>) -> Result<Option<Sequence>, FormatError> {
    let Some(file) = file_in(folder) else {
        return Ok(None);
    };
    let sequence = match file.ends_with(RAW_TIMES) {
        true => raw(folder)?,
        false => odometry(folder, &file, notes)?,
    };
    Ok((sequence.clouds.len() > 1).then_some(sequence))
}

fn odometry(folder: &Path, calibration: &Path, notes: &mut Vec<String>) -> Result<Sequence, FormatError> {
    let clouds = clouds(&folder.join(SCANS));
    let numbers: Vec<u64> = clouds.iter().map(|c| c.0).collect();
    let text = text(calibration)?;
    let line = text.lines().find_map(|line| {
        line.strip_prefix("Tr:")
            .or_else(|| line.strip_prefix("Tr_velo_to_cam:"))
    });
    let camera_from_velo = line
        .and_then(kitti::pose_from)
        .ok_or_else(|| FormatError::new("no line Tr: of 12 numbers").at(&calibration.display()))?;
    let file = camera_poses(folder).ok_or_else(|| FormatError::new("no poses"))?;
    let cameras = poses::read_file(&file, folder, &numbers, notes)?;
    let velo_from_camera = camera_from_velo.inverse();
    let velo = |(time_s, camera): (f64, Pose)| (time_s, velo_from_camera * camera * camera_from_velo);
    Ok(Sequence {
        clouds,
        poses: cameras.into_iter().map(velo).collect(),
    })
}

fn raw(folder: &Path) -> Result<Sequence, FormatError> {
    let clouds = clouds(&folder.join(RAW).join("data"));
    let times = folder.join(RAW).join(RAW_TIMES);
    let lines = text(&times)?;
    let all_s: Vec<f64> = lines.lines().filter_map(seconds_of_day).collect();
    // A line for each number: files can be missing.
    let time_s = |number: u64| all_s.get(number as usize).copied();
    let times_s: Option<Vec<f64>> = clouds.iter().map(|c| time_s(c.0)).collect();
    let times_s = times_s.ok_or_else(|| {
        let last = clouds.last().map_or(0, |c| c.0);
        FormatError::new(format!("{} times, expected one for scan {last} too", all_s.len())).at(&RAW_TIMES)
    })?;
    let calibration = folder.join("../calib_imu_to_velo.txt");
    let velo_from_imu = match calibration.is_file() {
        true => imu_calibration(&text(&calibration)?)
            .ok_or_else(|| FormatError::new("expected lines R: and T:").at(&calibration.display()))?,
        false => Pose::IDENTITY,
    };
    let mut scale = None;
    let pose = |(_, cloud): &(u64, PathBuf)| {
        let stem = cloud.file_stem().unwrap_or_default();
        let file = folder.join("oxts/data").join(stem).with_extension("txt");
        let numbers: Vec<f64> = text(&file)?
            .split_whitespace()
            .filter_map(|word| word.parse().ok())
            .collect();
        let place = imu_pose(&numbers, &mut scale);
        let place = place.ok_or_else(|| {
            FormatError::new("expected latitude, longitude, height and three angles").at(&file.display())
        })?;
        Ok(place * velo_from_imu.inverse())
    };
    let poses: Result<Vec<Pose>, FormatError> = clouds.iter().map(pose).collect();
    Ok(Sequence {
        poses: times_s.into_iter().zip(poses?).collect(),
        clouds,
    })
}

/// Seconds since midnight of a line such as `2011-09-26 13:02:25.594360375`.
fn seconds_of_day(line: &str) -> Option<f64> {
    let (date, clock) = line.trim().split_once(' ')?;
    let day: f64 = date.rsplit('-').next()?.parse().ok()?;
    let mut seconds = 0.0;
    for part in clock.split(':') {
        seconds = seconds * 60.0 + part.parse::<f64>().ok()?;
    }
    Some(day * DAY_S + seconds)
}

/// The lines R: and T: of a calibration.
fn imu_calibration(text: &str) -> Option<Pose> {
    let numbers = |name: &str| -> Option<Vec<f64>> {
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().map(|word| word.parse().ok()).collect()
    };
    let (r, t) = (numbers("R:")?, numbers("T:")?);
    let [r, t]: [&[f64]; 2] = [r.as_slice(), t.as_slice()];
    let row = |i: usize| {
        Some(format!(
            "{} {} {} {}",
            r.get(3 * i)?,
            r.get(3 * i + 1)?,
            r.get(3 * i + 2)?,
            t.get(i)?
        ))
    };
    kitti::pose_from(&[row(0)?, row(1)?, row(2)?].join(" "))
}

/// The pose of the IMU from latitude and longitude (degrees), height (m), roll, pitch and yaw (rad). `scale` is that of the projection,
/// taken from the first latitude.
fn imu_pose(numbers: &[f64], scale: &mut Option<f64>) -> Option<Pose> {
    let [latitude, longitude, height_m, roll, pitch, yaw] = *numbers.first_chunk()?;
    let is_sound =
        latitude.abs() < 89.0 && longitude.abs() <= 360.0 && numbers[..6].iter().all(|v| v.is_finite());
    if !is_sound {
        return None;
    }
    let scale = *scale.get_or_insert(latitude.to_radians().cos());
    let north = ((90.0 + latitude).to_radians() / 2.0).tan().ln();
    Some(Pose {
        rotation: DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll),
        translation_m: DVec3::new(
            scale * EARTH_M * longitude.to_radians(),
            scale * EARTH_M * north,
            height_m,
        ),
    })
}

fn text(path: &Path) -> Result<String, FormatError> {
    let bytes = input::read(path, input::LARGEST_TEXT).map_err(FormatError::new)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
