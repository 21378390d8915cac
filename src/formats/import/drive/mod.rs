//! Folders of sweeps with poses: all sweeps become the voxels of one scene, the poses become the motion of the ego vehicle, and
//! each sweep stays with the scene at its moment.
//!
//! Clouds are files named by numbers (PCD, PLY, `.bin`) in the frame of their sensor; `poses.txt` ([`poses`]) has the pose of the
//! sensor at each of them. Poses are aligned by the sweeps ([`mod@align`]), which then show ground, its relief, and what stands on it
//! ([`survey`]). The world frame is that of the first sweep on its ground.

pub(super) mod align;
mod kitti_sequence;
mod poses;
pub(super) mod survey;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{Clip, Key, Motion, Pose, Recorded, SweepRecording};

use super::cloud::{Cloud, Label, is_own};
use super::imported_sweep::{ImportedSweep, SweepSource};
use super::scan::file_name;
use super::{Content, ImportFile, ImportOptions, ImportedScene, Importer, scene_name};
use crate::sweep_file::{self, SweepFile};
use crate::{FormatError, Holds, input};
use align::align;
use survey::{PlacedSurvey, Survey, SurveyedDrive};

/// See the module. It is told by the folder alone, so it is no line of the table.
pub const IMPORTER: Importer = Importer {
    id: "sweeps",
    title: "folders of numbered clouds with poses.txt, sequences of KITTI",
    extensions: &[],
    holds: &[Holds::Points],
    largest: input::LARGEST_TEXT,
    recognises: |_| false,
    in_folder: Some(|folder| kitti_sequence::file_in(folder).or_else(|| poses::file_in(folder))),
    read: |source| {
        let folder = source.path.and_then(kitti_sequence::folder_of);
        let folder = folder.ok_or_else(|| FormatError::new("read from memory, not from a folder"))?;
        read(folder, source.options)
    },
    #[cfg(test)]
    sample: Vec::new,
};

/// Endings of clouds.
const ENDINGS: [&str; 3] = ["pcd", "ply", "bin"];
/// Distance from the first sweep up to which sweeps are taken, m.
const REACH_M: f64 = 250.0;
/// Distance between two sweeps that no vehicle drives, m.
const JUMP_M: f64 = 50.0;
/// Way that tells where the front of a vehicle is, m.
const LEAST_WAY_M: f64 = 0.3;
/// Farthest place of a pose from the first, m.
const FARTHEST_M: f64 = 1e6;

/// A sweep that is read.
pub(super) struct ChosenSweep<T> {
    /// Where it is.
    pub(super) what: T,
    /// From the first on, s.
    pub(super) time_s: f64,
    /// Pose of the sensor in the frame of the first one.
    pub(super) first_from_sensor: Pose,
}

/// True for a sequence of KITTI with poses.
pub(super) fn is_sequence(folder: &Path) -> bool {
    kitti_sequence::file_in(folder).is_some()
}

/// True for a folder of at least two numbered clouds and their poses.
pub(super) fn is_drive(folder: &Path) -> bool {
    poses::file_in(folder).is_some() && clouds(folder).len() > 1
}

/// The numbered clouds of a folder, by number.
fn clouds(folder: &Path) -> Vec<(u64, PathBuf)> {
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
    numbered
}

/// Reads a folder. Errors in one line.
pub(super) fn read(folder: &Path, options: ImportOptions) -> Result<Content, FormatError> {
    let mut notes = Vec::new();
    let (clouds, poses) = match kitti_sequence::read(folder, &mut notes)? {
        Some(sequence) => (sequence.clouds, sequence.poses),
        None => {
            let clouds = clouds(folder);
            let numbers: Vec<u64> = clouds.iter().map(|c| c.0).collect();
            let poses = poses::read(folder, &numbers, &mut notes)?;
            (clouds, poses)
        }
    };
    let all = clouds.into_iter().zip(poses);
    let all = all.map(|((_, path), (time_s, pose))| (path, time_s, pose));
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |m| m.len() as usize);
    let sweeps = chosen(all.collect(), size, &mut notes)?;
    let open = |sweep: ChosenSweep<PathBuf>| {
        let bytes = input::read(&sweep.what, SweepRecording::LARGEST as u64).map_err(FormatError::new)?;
        let name = file_name(Some(&sweep.what));
        let file = SweepSource {
            format: sweep_file::format_of(&name),
            name,
            bytes: Arc::new(bytes),
            time_s: sweep.time_s,
            world_from_file: Pose::IDENTITY,
            sensor_m: DVec3::ZERO,
        };
        Ok((file, sweep.first_from_sensor))
    };
    let files: Result<Vec<(SweepSource, Pose)>, FormatError> = sweeps.into_iter().map(open).collect();
    scene_of(&scene_name(folder), files?, options, notes)
}

/// The scene of sweeps with their poses in the frame of the first, one at least. Errors in one line.
pub(super) fn scene_of(
    name: &str,
    sweeps: Vec<(SweepSource, Pose)>,
    options: ImportOptions,
    mut notes: Vec<String>,
) -> Result<Content, FormatError> {
    let (files, given): (Vec<SweepSource>, Vec<Pose>) = sweeps.into_iter().unzip();
    let (level, of_ground) = level(name, files.first(), &given, options)?;
    let surveys: Result<Vec<Survey>, FormatError> = files
        .iter()
        .map(|file| {
            let at = returns(file)?.into_iter().map(|r| r.0);
            Ok(Survey::new(at.filter(|at| !is_own(level.apply(*at)))))
        })
        .collect();
    let surveys = surveys?;
    let points: Vec<&[DVec3]> = surveys.iter().map(Survey::points).collect();
    let aligned = align(&points, &given);
    if let (Some(last), [_, .., file]) = (aligned.poses.last(), files.as_slice()) {
        let way_m = last.translation_m.length();
        notes.push(format!(
            "{} sweeps of {:.1} s, the sensor moves {way_m:.1} m",
            files.len(),
            file.time_s,
        ));
        notes.push(aligned.note());
    }
    let placed = surveys
        .into_iter()
        .zip(&aligned.poses)
        .map(|(survey, pose)| PlacedSurvey::of_sensor(survey, level * *pose, &level));
    let drive = SurveyedDrive::new(placed.collect());
    let world = drive
        .world(&[], &[])
        .ok_or_else(|| FormatError::new("no return of the sweeps lies on the map"))?;
    notes.extend(world.notes());
    let mut scene = world.scene(name, BTreeMap::new());
    let times_s = files.iter().map(|file| file.time_s);
    let clip = clip(times_s.zip(&aligned.poses), &level);
    if let Some(problem) = clip.problem() {
        return Err(FormatError::new(problem));
    }
    scene.change_clip(|still| *still = clip);
    let recorded = Arc::new(Recorded::all_of(&scene));
    scene.change_canvas(|canvas| canvas.inferred.recorded = recorded);
    let mut sweep = ImportedSweep::without_returns(level, level.translation_m);
    sweep.mount_m = Some(level.translation_m);
    for (mut file, pose) in files.into_iter().zip(&aligned.poses) {
        file.world_from_file = level * *pose;
        file.sensor_m = file.world_from_file.translation_m;
        sweep.files.push(file);
    }
    sweep.drive = Some(Arc::new(drive));
    Ok(Content::Scene(Box::new(ImportedScene {
        scene,
        sweep: Some(sweep),
        inferred: &GUESSED_OF_DRIVE,
        skipped: BTreeMap::new(),
        notes: of_ground.into_iter().chain(notes).collect(),
    })))
}

/// How the frame of the first sensor lies in the world: on the ground that its sweep shows, its vehicle ahead; notes for a person.
fn level(
    name: &str,
    first: Option<&SweepSource>,
    poses: &[Pose],
    options: ImportOptions,
) -> Result<(Pose, Vec<String>), FormatError> {
    let first = first.ok_or_else(|| FormatError::new("no sweep"))?;
    let mut cloud = Cloud::from_source(&ImportFile {
        bytes: &[],
        name,
        path: None,
        options,
    });
    for (at, strength) in returns(first)? {
        cloud.add_return(at, &Pose::IDENTITY, Label::None, strength);
    }
    let (level, mut notes) = cloud.leveled();
    let turned_deg = sideways_deg(poses);
    if turned_deg != 0.0 {
        notes.push(format!(
            "the vehicle drives at {turned_deg:.0} degrees to the sensor's x: the sweeps are turned"
        ));
    }
    Ok((Pose::planar(0.0, 0.0, -turned_deg.to_radians()) * level, notes))
}

/// Angle from the x axis of a sensor to the way that its vehicle drives, in quarter turns, degrees; 0 for one that hardly moves.
fn sideways_deg(poses: &[Pose]) -> f64 {
    let step = |two: &[Pose]| (two[0].inverse() * two[1]).translation_m.truncate();
    let way: DVec2 = poses.windows(2).map(step).sum();
    match way.length() >= LEAST_WAY_M {
        true => (way.to_angle().to_degrees() / 90.0).round() * 90.0,
        false => 0.0,
    }
}

/// Guessed parts of the scene of a drive without labels.
const GUESSED_OF_DRIVE: [&str; 3] = ["classes", "layout", "background"];

/// The sweeps that are read, of all with their times (s) and poses: near the first, without jumps, as many as can be kept; `size` is
/// that of the file of one, bytes.
pub(super) fn chosen<T>(
    all: Vec<(T, f64, Pose)>,
    size: impl Fn(&T) -> usize,
    notes: &mut Vec<String>,
) -> Result<Vec<ChosenSweep<T>>, FormatError> {
    let first = all.first().ok_or_else(|| FormatError::new("no pose"))?;
    let (first_s, sensor_from_first) = (first.1, first.2.inverse());
    let mut sweeps: Vec<ChosenSweep<T>> = Vec::new();
    let (mut beyond, mut after_jump) = (0, 0);
    for (what, time_s, pose) in all {
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
        if beyond == 0 && at.distance(last) > JUMP_M {
            after_jump += 1;
        } else if at.truncate().length() > REACH_M {
            beyond += 1;
        } else {
            sweeps.push(ChosenSweep {
                what,
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
            "{after_jump} sweeps that jump by more than {JUMP_M} m are left out"
        ));
    }
    let bytes: usize = sweeps.iter().map(|s| size(&s.what)).sum();
    let every = bytes
        .div_ceil(SweepRecording::LARGEST)
        .max(sweeps.len().div_ceil(SweepRecording::MOST))
        .max(1);
    if every > 1 {
        notes.push(format!("of {} sweeps one of every {every} is read", sweeps.len()));
        sweeps = sweeps.into_iter().step_by(every).collect();
    }
    Ok(sweeps)
}

/// Places of the returns of a file in its frame, m, and their strengths.
fn returns(file: &SweepSource) -> Result<Vec<(DVec3, f32)>, FormatError> {
    let read = SweepFile::open(file.format, &file.bytes).map_err(|e| e.at(&file.name))?;
    let all = read.returns(&Pose::IDENTITY).into_iter().flatten();
    Ok(all.map(|r| (r.place(), r.strength)).collect())
}

/// How the vehicle drives below its sensor, from times in s and poses in the frame of the first sensor.
fn clip<'a>(poses: impl Iterator<Item = (f64, &'a Pose)>, level: &Pose) -> Clip {
    let mount = level.translation_m.truncate();
    let turn_rad = |pose: &Pose| {
        let x = (level.rotation * pose.rotation * level.rotation.inverse()) * DVec3::X;
        x.y.atan2(x.x)
    };
    let mut turned_rad = 0.0;
    let keys = poses.map(|(time_s, pose)| {
        let yaw_rad = turn_rad(pose);
        // Headings go on beyond half a turn.
        turned_rad += (yaw_rad - turned_rad + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        let sensor = (*level * *pose).translation_m.truncate();
        Key {
            time_s,
            at_m: sensor - DVec2::from_angle(yaw_rad).rotate(mount),
            yaw_deg: f64::to_degrees(turned_rad),
        }
    });
    let keys: Vec<Key> = keys.collect();
    let moves = keys
        .iter()
        .any(|key| key.at_m.length() > 1e-6 || key.yaw_deg.abs() > 1e-6);
    Clip {
        length_s: keys.last().map_or(0.0, |key| key.time_s),
        ego: moves.then_some(Motion::Keys(keys)),
        ..Clip::default()
    }
}

#[cfg(test)]
mod tests;
