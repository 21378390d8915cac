//! Scans of KITTI and SemanticKITTI: x, y, z and remission as f32, no header; with labels if they are beside it.
//!
//! A scan `velodyne/000123.bin` has its labels in `labels/000123.label` (u32: below the class, above the instance).
//! Points are in the sensor's frame: x forward, y left, z up. The pose of the sensor in the ego frame is that of
//! `calib.txt` beside the folder (`Tr_ego_to_velo`, as this program writes it); without it, that of the LiDAR of the
//! default rig, and a note says so. See `cloud` for the use of points with and without labels.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use scene::Pose;

use super::cloud::{Cloud, Label};
use super::scan::{ScanFormat, file_name, labels_beside};
use super::{Content, ImportFile, Importer, nuscenes_lidar};
use crate::kitti::{self, EGO_TO_VELO};
use crate::{FormatError, Holds, input, semantic_kitti};

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "kitti",
    title: "KITTI and nuScenes scans",
    extensions: &["bin"],
    holds: &[Holds::Points],
    largest: 512 << 20,
    recognises: |head| ScanFormat::Kitti.are_in(head),
    in_folder: Some(first_scan),
    read: |source| match file_name(source.path).ends_with(".pcd.bin") {
        true => nuscenes_lidar::read(source),
        false => read(source),
    },
    #[cfg(test)]
    sample: tests::sample,
};

/// The first scan of a sequence: of the files in `velodyne` the one whose name comes first.
fn first_scan(folder: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(folder.join("velodyne")).ok()?;
    let paths = files.filter_map(|file| Some(file.ok()?.path()));
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "bin"))
        .min()
}

fn read(source: &ImportFile<'_>) -> Result<Content, FormatError> {
    let points = ScanFormat::Kitti.read(source.bytes)?;
    let count = points.len();
    let stem = source.path.and_then(Path::file_stem).map(|s| s.to_string_lossy());
    let labels = match stem {
        Some(stem) => labels_beside(source, &format!("../labels/{stem}.label"), (count, 4))?,
        None => None,
    };
    let mut left_out = BTreeMap::new();
    let calibrated = calibration(source)?;
    let mut cloud = match calibrated {
        Some(_) => Cloud::from_source(source),
        None => Cloud::of_guessed_sensor(source),
    };
    let ego_from_velo = match calibrated {
        Some(pose) => pose,
        None => {
            let pose = kitti::ego_from_default_velo();
            let [x, y, z] = pose.translation_m.to_array();
            let what = format!(
                "place of the sensor, taken as {x:.2}, {y:.2}, {z:.2} m as in the default rig, unless the ground shows another height"
            );
            left_out.insert(what, 1);
            pose
        }
    };
    let mut noise = 0;
    let words = labels.as_deref().map(|bytes| bytes.as_chunks::<4>().0);
    for (i, (at, strength)) in points.enumerate() {
        // The upper half is the instance.
        let number = words.map(|words| u32::from_le_bytes(words[i]) as u16);
        if number == Some(semantic_kitti::OUTLIER) {
            noise += 1;
            continue;
        }
        let label = match number {
            Some(number) => semantic_kitti::class_of_point(number).map_or(Label::Unknown, Label::Class),
            None => Label::None,
        };
        cloud.add_return(at, &ego_from_velo, label, strength);
    }
    if noise > 0 {
        left_out.insert("points of noise".into(), noise);
    }
    left_out.insert("remission".into(), 1);
    let loaded = cloud.scene(source.name, left_out).map_err(FormatError::new)?;
    Ok(Content::Scene(Box::new(loaded)))
}

/// Where the sensor is, from `calib.txt` beside the folder of scans; `None` if that is not there or does not say.
fn calibration(source: &ImportFile<'_>) -> Result<Option<Pose>, FormatError> {
    const FILE: &str = "../calib.txt";
    match source.path.map(|_| source.place(FILE)).transpose()? {
        Some(place) if place.is_file() => {}
        _ => return Ok(None),
    }
    let bytes = source.beside(FILE, input::LARGEST_TEXT)?;
    let text = String::from_utf8_lossy(&bytes);
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix(EGO_TO_VELO)?.strip_prefix(':'));
    let Some(line) = line else { return Ok(None) };
    let velo_from_ego = kitti::pose_from(line).ok_or_else(|| {
        FormatError::new(format!(
            "{FILE}, {EGO_TO_VELO}: expected a rotation and a place in 12 numbers"
        ))
    })?;
    Ok(Some(velo_from_ego.inverse()))
}

#[cfg(test)]
#[path = "kitti_tests.rs"]
mod tests;
