//! Tables of nuScenes and T4 (Autoware): a scene of a folder becomes a scene with a clip. See [`crate::nuscenes`].
//!
//! The first scene by name is read; [`pictures`] reads all, for training. The vehicle moves through its poses at the
//! key frames, objects through their annotations, and both go straight on beyond the first and the last. Objects that
//! stay within 5 cm in all key frames stand still. Barriers, cones and parked objects stand in the middle of their
//! places if they stay within half a metre: annotations jitter. Boxes, tracks and poses are marked as recorded
//! ([`Recorded`]), so that checks do not call them mistakes. Sensors become the rig. Voxels come from Occ3D's
//! `gts/SCENE/SAMPLE/labels.npz` if they lie beside, else from the LiDAR sweeps of the key frames with their lidarseg
//! labels; there, points in boxes are left out and boxes drawn as drafts. The map is inferred from the voxels.
//!
//! The world frame is that of the first ego pose (x forward, on the ground), except in folders that Sceneloom wrote: their
//! `map.json` names the origin that the scene had.

mod aligned;
mod objects;
mod occupancy;
pub mod pictures;
mod read;
mod rig;
mod rows;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use scene::message::shortened;
use scene::{
    BevLayout, Clip, Conditions, Frame, Inferred, Key, Motion, Pose, Recorded, Scene, TimeOfDay, Weather,
    draft, infer,
};

use super::drive::survey::extent_around;
use super::{Content, ImportFile, ImportedScene, Importer};
use crate::nuscenes::yaw_rad;
use crate::{FormatError, Holds, input};
use aligned::Surveys;

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "nuscenes",
    title: "T4 and nuScenes tables",
    extensions: &[],
    holds: &[Holds::Boxes, Holds::Points],
    largest: input::LARGEST_TEXT,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        text.contains("\"nbr_samples\"") && text.contains("\"first_sample_token\"")
    },
    in_folder: Some(in_folder),
    read: |source| read_scene(source).map(|loaded| Content::Scene(Box::new(loaded))),
    #[cfg(test)]
    sample: tests::sample,
};

/// How much is left out of a scene, by kind.
type Skipped = BTreeMap<String, usize>;

fn count(skipped: &mut Skipped, what: &str, how_many: usize) {
    if how_many > 0 {
        *skipped.entry(what.to_owned()).or_default() += how_many;
    }
}

/// Longest name and description of a scene that is kept, characters.
const LONGEST_NAME: usize = 120;
const LONGEST_DESCRIPTION: usize = 2000;

fn in_folder(folder: &Path) -> Option<PathBuf> {
    let tables = |folder: &Path| {
        let scene = folder.join("scene.json");
        (scene.is_file() && folder.join("sample_data.json").is_file()).then_some(scene)
    };
    // Versions of nuScenes; the tables of T4, or a version of such a data set.
    let inner = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy());
        let is_number = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
        name.is_some_and(|n| n.starts_with("v1.0") || n == T4_TABLES || is_number(&n))
    };
    let inside = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        let mut inside: Vec<PathBuf> = entries
            .filter_map(|e| Some(e.ok()?.path()))
            .filter(inner)
            .collect();
        inside.sort();
        inside
    };
    tables(folder).or_else(|| {
        inside(folder)
            .iter()
            .find_map(|path| tables(path).or_else(|| tables(&path.join(T4_TABLES))))
    })
}

/// Folder of the tables of T4.
const T4_TABLES: &str = "annotation";

fn read_scene(source: &ImportFile<'_>) -> Result<ImportedScene, FormatError> {
    Ok(read_drive(source, 0)?.0)
}

/// A scene by its place in the list of their names, and what it was made of.
fn read_drive(
    source: &ImportFile<'_>,
    which: usize,
) -> Result<(ImportedScene, read::Recording), FormatError> {
    let mut skipped = Skipped::new();
    let mut recording = read::recording(source, which, &mut skipped)?;
    let mut of_sweeps = Skipped::new();
    let surveys = (!recording.is_own).then(|| Surveys::read(source, &recording, &mut of_sweeps));
    let aligned = surveys.as_ref().and_then(|surveys| surveys.align(&mut recording));
    let frames = &recording.frames;
    let poses: Vec<Pose> = frames.iter().map(|f| f.world_from_ego).collect();
    let places: Vec<DVec3> = poses.iter().map(|p| p.translation_m).collect();
    let extent = extent_around(&places).map_err(FormatError::new)?;
    let things = objects::things(&recording, &mut skipped);
    // Sweeps without labels tell by their shapes what they saw.
    let is_labelled = occupancy::is_labelled(source, &recording);
    let drive = surveys
        .filter(|_| !is_labelled)
        .map(|s| s.drive(&recording, &things));
    if drive.is_some() {
        skipped.extend(of_sweeps);
    }
    let world = drive
        .as_ref()
        .and_then(|drive| drive.world(drive.told().unwrap_or_default(), &[]));
    let by_shape = world.is_some();
    let observed = match world {
        Some(world) => Some(occupancy::StaticScene::of_shapes(world, &things)),
        None => occupancy::observed(source, &recording, &things, extent, &mut skipped),
    };
    let (layout, voxels, unobserved, inferred) = match observed {
        Some(o) if by_shape => (o.layout, o.voxels, o.unobserved, &GUESSED_BY_SHAPE[..]),
        Some(o) => (o.layout, o.voxels, o.unobserved, &GUESSED[..]),
        // Nothing was measured: open ground, as for a list of boxes.
        None => {
            let layout = BevLayout::over(extent);
            let voxels = draft::draft(&layout, things.standing.values());
            (layout, voxels, None, &[][..])
        }
    };
    let background = match !inferred.is_empty() {
        true => infer::background(&voxels, &layout),
        false => Default::default(),
    };
    let frame = Frame {
        inferred: Inferred {
            layout: !inferred.is_empty(),
            background: !background.is_empty(),
            unobserved,
            ..Inferred::default()
        },
        world_from_ego: poses[0],
        ..Frame::new(layout, things.standing, voxels)
    };
    let clip = Clip {
        length_s: frames.last().map_or(0.0, |f| f.time_s),
        ego: ego_motion(&recording),
        tracks: things.tracks,
        ..Clip::default()
    };
    if let Some(problem) = clip.problem() {
        return Err(FormatError::new(problem));
    }
    let name = match recording.name.as_str() {
        "" => source.name,
        name => name,
    };
    let mut scene = Scene::single(
        &shortened(&plain(name), LONGEST_NAME),
        frame,
        Arc::new(recording.rig.clone()),
        0,
    );
    let description = plain(&recording.description);
    scene.conditions = conditions(&description);
    scene.prompt = shortened(&description, LONGEST_DESCRIPTION).into();
    scene.background = Arc::new(background);
    scene.change_clip(|still| *still = clip);
    if !recording.is_own {
        let recorded = Arc::new(Recorded::all_of(&scene));
        scene.change_canvas(|canvas| canvas.inferred.recorded = recorded);
    }
    let loaded = ImportedScene {
        sweep: (!recording.is_own)
            .then(|| occupancy::kept_sweeps(source, &recording, drive))
            .flatten(),
        scene,
        inferred,
        skipped,
        notes: aligned.into_iter().collect(),
    };
    Ok((loaded, recording))
}

/// The parts that are guessed from the voxels, and those of sweeps without labels.
const GUESSED: [&str; 2] = ["layout", "background"];
const GUESSED_BY_SHAPE: [&str; 3] = ["classes", "layout", "background"];

/// Text of a file with spaces in place of control characters.
fn plain(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

/// How the vehicle drives; `None` if it stands.
fn ego_motion(recording: &read::Recording) -> Option<Motion> {
    let frames = &recording.frames;
    let first = frames.first()?.world_from_ego;
    let same = |pose: &Pose| {
        pose.translation_m.distance(first.translation_m) < 1e-9
            && pose.rotation.dot(first.rotation).abs() > 1.0 - 1e-15
    };
    let key = |frame: &read::KeyFrame| Key {
        time_s: frame.time_s,
        at_m: frame.world_from_ego.translation_m.truncate(),
        yaw_deg: yaw_rad(frame.world_from_ego.rotation).to_degrees(),
    };
    let moves = frames.iter().any(|f| !same(&f.world_from_ego));
    moves.then(|| objects::motion(frames.iter().map(key).collect()))
}

/// Light and air from the words that the devkit's evaluation goes by, and the program's own names of them.
fn conditions(description: &str) -> Conditions {
    let words: Vec<String> = description
        .to_lowercase()
        .split(|c: char| !c.is_alphanumeric())
        .map(str::to_owned)
        .collect();
    let says = |name: &str| words.iter().any(|w| w == name);
    let time = TimeOfDay::ALL.into_iter().filter(|t| *t != TimeOfDay::Day);
    let weather = Weather::ALL.into_iter().filter(|w| *w != Weather::Clear);
    Conditions::usual(
        time.clone().find(|t| says(t.name())).unwrap_or_default(),
        weather.clone().find(|w| says(w.name())).unwrap_or_default(),
        0,
    )
}

#[cfg(test)]
mod bad_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod unlabelled_tests;
