//! Folders of sweeps with poses: all sweeps become the voxels of one scene, the poses become the motion of the ego vehicle, and
//! each sweep stays with the scene at its moment.
//!
//! Clouds are files named by numbers (PCD, PLY, `.bin`) in the frame of their sensor; `poses.txt` ([`poses`]) has the pose of the
//! sensor at each of them. The world frame is that of the first sweep on its ground.

mod poses;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{Clip, Key, Motion, Pose, Recorded, SweepRecording};

use super::cloud::{Cloud, Label, is_own};
use super::imported_sweep::SweepSource;
use super::scan::file_name;
use super::{Content, ImportFile, ImportOptions, ImportedScene, Importer, scene_name};
use crate::sweep_file::{self, SweepFile};
use crate::{FormatError, Holds, input};

/// See the module. It is told by the folder alone, so it is no line of the table.
pub const IMPORTER: Importer = Importer {
    id: "sweeps",
    title: "folders of numbered clouds with poses.txt",
    extensions: &[],
    holds: &[Holds::Points],
    largest: input::LARGEST_TEXT,
    recognises: |_| false,
    in_folder: Some(poses::file_in),
    read: |source| {
        let folder = source.path.and_then(Path::parent);
        let folder = folder.ok_or_else(|| FormatError::new("read from memory, not from a folder"))?;
        read(folder, source.options)
    },
    #[cfg(test)]
    sample: Vec::new,
};

/// Endings of clouds.
const ENDINGS: [&str; 3] = ["pcd", "ply", "bin"];
/// Distance from the first sweep up to which sweeps are taken, m: the map ends 40 m from it.
const REACH_M: f64 = 30.0;
/// Distance between two sweeps that no vehicle drives, m.
const JUMP_M: f64 = 50.0;
/// Farthest place of a pose from the first, m.
const FARTHEST_M: f64 = 1e6;

/// A sweep that is read.
struct DriveSweep {
    path: PathBuf,
    time_s: f64,
    /// Pose of the sensor in the frame of the first one.
    first_from_sensor: Pose,
}

/// True for a folder of at least two numbered clouds and their poses.
pub(super) fn is_drive(folder: &Path) -> bool {
    poses::file_in(folder).is_some() && clouds(folder).len() > 1
}

/// The numbered clouds of a folder, by number.
fn clouds(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).into_iter().flatten();
    let numbered = files.filter_map(|file| {
        let path = file.ok()?.path();
        let name = path.file_name()?.to_string_lossy().into_owned();
        let (stem, ending) = name.split_once('.')?;
        let is_cloud = ENDINGS.contains(&ending) || ending == "pcd.bin";
        let number: u64 = stem.parse().ok().filter(|_| is_cloud)?;
        Some((number, path))
    });
    let mut numbered: Vec<(u64, PathBuf)> = numbered.collect();
    numbered.sort();
    numbered.into_iter().map(|(_, path)| path).collect()
}

/// Reads a folder. Errors in one line.
pub(super) fn read(folder: &Path, options: ImportOptions) -> Result<Content, FormatError> {
    let (clouds, mut notes) = (clouds(folder), Vec::new());
    let poses = poses::read(folder, clouds.len(), &mut notes)?;
    let sweeps = chosen(clouds, poses, &mut notes)?;
    let first = opened(&sweeps[0].path)?;
    let name = scene_name(folder);
    let source = ImportFile {
        bytes: &[],
        name: &name,
        path: None,
        options,
    };
    // The first sweep tells where the ground is and has the objects.
    let mut alone = Cloud::from_source(&source);
    for r in returns(&sweeps[0].path, &first)? {
        alone.add_return(r.0, &Pose::IDENTITY, Label::None, r.1);
    }
    let ImportedScene {
        sweep,
        notes: of_ground,
        ..
    } = alone.scene(&name, BTreeMap::new()).map_err(FormatError::new)?;
    let mut sweep = sweep.ok_or_else(|| FormatError::new("the first cloud is no sweep"))?;
    let level = sweep.world_from_file;
    let mut all = Cloud::at_level(level);
    let mut bytes = Some(first);
    for one in &sweeps {
        let bytes = match bytes.take() {
            Some(first) => first,
            None => opened(&one.path)?,
        };
        for (at, strength) in returns(&one.path, &bytes)? {
            if !is_own(level.apply(at)) {
                all.add_point(one.first_from_sensor.apply(at), Label::None, strength);
            }
        }
        let world_from_file = level * one.first_from_sensor;
        sweep.files.push(SweepSource {
            format: sweep_file::format_of(&file_name(Some(&one.path))),
            name: file_name(Some(&one.path)),
            bytes: Arc::new(bytes),
            time_s: one.time_s,
            world_from_file,
            sensor_m: world_from_file.translation_m,
        });
    }
    let mut loaded = all.scene(&name, BTreeMap::new()).map_err(FormatError::new)?;
    let clip = clip(&sweeps, &level);
    if let Some(problem) = clip.problem() {
        return Err(FormatError::new(problem));
    }
    let last = &sweeps[sweeps.len() - 1];
    notes.push(format!(
        "{} sweeps of {:.1} s, the sensor moves {:.1} m; what moves is smeared in the voxels",
        sweeps.len(),
        last.time_s,
        last.first_from_sensor.translation_m.length()
    ));
    loaded.scene.change_clip(|still| *still = clip);
    let recorded = Arc::new(Recorded::all_of(&loaded.scene));
    loaded
        .scene
        .change_canvas(|canvas| canvas.inferred.recorded = recorded);
    loaded.notes.splice(0..0, of_ground.into_iter().chain(notes));
    loaded.sweep = Some(sweep);
    Ok(Content::Scene(Box::new(loaded)))
}

/// The sweeps that are read: near the first, without jumps, as many as can be kept.
fn chosen(
    clouds: Vec<PathBuf>,
    poses: Vec<(f64, Pose)>,
    notes: &mut Vec<String>,
) -> Result<Vec<DriveSweep>, FormatError> {
    let first = poses.first().ok_or_else(|| FormatError::new("no pose"))?;
    let (first_s, sensor_from_first) = (first.0, first.1.inverse());
    let mut sweeps: Vec<DriveSweep> = Vec::new();
    let (mut beyond, mut after_jump) = (0, 0);
    for (path, (time_s, pose)) in clouds.into_iter().zip(poses) {
        let first_from_sensor = sensor_from_first * pose;
        let at = first_from_sensor.translation_m;
        if !at.is_finite() || at.length() > FARTHEST_M {
            return Err(FormatError::new(format!(
                "poses: a place {:.0} m from the first, expected at most {FARTHEST_M}",
                at.length()
            )));
        }
        let last = sweeps
            .last()
            .map_or(DVec3::ZERO, |s| s.first_from_sensor.translation_m);
        if after_jump > 0 || (beyond == 0 && at.distance(last) > JUMP_M) {
            after_jump += 1;
        } else if at.truncate().length() > REACH_M {
            beyond += 1;
        } else {
            sweeps.push(DriveSweep {
                path,
                time_s: time_s - first_s,
                first_from_sensor,
            });
        }
    }
    if beyond > 0 {
        notes.push(format!(
            "{beyond} sweeps farther than {REACH_M} m from the first are left out"
        ));
    }
    if after_jump > 0 {
        notes.push(format!(
            "{after_jump} sweeps after a jump of more than {JUMP_M} m are left out"
        ));
    }
    let size = |s: &DriveSweep| std::fs::metadata(&s.path).map_or(0, |m| m.len() as usize);
    let bytes: usize = sweeps.iter().map(size).sum();
    let every = bytes
        .div_ceil(SweepRecording::LARGEST)
        .max(sweeps.len().div_ceil(SweepRecording::MOST))
        .max(1);
    if every > 1 {
        notes.push(format!("of {} sweeps every {every}th is read", sweeps.len()));
        sweeps = sweeps.into_iter().step_by(every).collect();
    }
    Ok(sweeps)
}

fn opened(path: &Path) -> Result<Vec<u8>, FormatError> {
    input::read(path, SweepRecording::LARGEST as u64).map_err(FormatError::new)
}

/// Places of the returns of a file in its frame, m, and their strengths.
fn returns(path: &Path, bytes: &[u8]) -> Result<Vec<(DVec3, f32)>, FormatError> {
    let name = file_name(Some(path));
    let file = SweepFile::open(sweep_file::format_of(&name), bytes).map_err(|e| e.at(&path.display()))?;
    let all = file.returns(&Pose::IDENTITY).into_iter().flatten();
    Ok(all.map(|r| (r.place(), r.strength)).collect())
}

/// How the vehicle drives below its sensor.
fn clip(sweeps: &[DriveSweep], level: &Pose) -> Clip {
    let mount = level.translation_m.truncate();
    let turn_rad = |pose: &Pose| {
        let x = (level.rotation * pose.rotation * level.rotation.inverse()) * DVec3::X;
        x.y.atan2(x.x)
    };
    let mut turned_rad = 0.0;
    let keys = sweeps.iter().map(|sweep| {
        let yaw_rad = turn_rad(&sweep.first_from_sensor);
        // Headings go on beyond half a turn.
        turned_rad += (yaw_rad - turned_rad + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        let sensor = (*level * sweep.first_from_sensor).translation_m.truncate();
        Key {
            time_s: sweep.time_s,
            at_m: sensor - DVec2::from_angle(yaw_rad).rotate(mount),
            yaw_deg: f64::to_degrees(turned_rad),
        }
    });
    let keys: Vec<Key> = keys.collect();
    let moves = keys
        .iter()
        .any(|key| key.at_m.length() > 1e-6 || key.yaw_deg.abs() > 1e-6);
    Clip {
        length_s: sweeps.last().map_or(0.0, |sweep| sweep.time_s),
        ego: moves.then_some(Motion::Keys(keys)),
        ..Clip::default()
    }
}

#[cfg(test)]
mod tests;
