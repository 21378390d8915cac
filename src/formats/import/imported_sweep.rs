//! The sweep that a scene is of: what becomes of the objects that are found in it, and its file, which stays with the scene.

use std::sync::Arc;

use glam::DVec3;
use scene::message::quoted;
use scene::{Pose, Scene, SweepRecording};

use super::drive::survey::SurveyedDrive;
use super::importer::ImportedScene;
use crate::FormatError;
use crate::sweep_file::SweepFile;

/// A sweep, and its returns around the vehicle if these have no labels.
#[derive(Clone, Debug)]
pub struct ImportedSweep {
    /// x and y in the ego frame, height above the ground (m) and strength of the echo (0 to 255) of each return; 0 where the
    /// strength is unknown. Empty for a sweep with labels, of unknown ground, or of too many returns.
    pub returns: Vec<[f32; 4]>,
    /// Where the sensor is, in the same frame; where the default rig has it if the file does not tell.
    pub sensor_m: DVec3,
    /// The same in the ego frame, if the file tells.
    pub(super) mount_m: Option<DVec3>,
    /// Pose of the file's frame in the world frame.
    pub(super) world_from_file: Pose,
    /// Files that stay with the scene.
    pub(crate) files: Vec<SweepSource>,
    /// All sweeps of a drive without labels.
    pub(super) drive: Option<Arc<SurveyedDrive>>,
}

/// A file of returns.
#[derive(Clone, Debug)]
pub(crate) struct SweepSource {
    /// Name, without folders.
    pub(super) name: String,
    /// Id of its format.
    pub(super) format: &'static str,
    /// Its bytes.
    pub(super) bytes: Arc<Vec<u8>>,
    /// Moment of the clip, s.
    pub(super) time_s: f64,
    /// Pose of its frame in the world frame, and place of the sensor there, m.
    pub(super) world_from_file: Pose,
    pub(super) sensor_m: DVec3,
}

impl ImportedSweep {
    /// A sweep in whose returns no objects are looked for.
    pub(crate) fn without_returns(world_from_file: Pose, sensor_m: DVec3) -> Self {
        Self {
            returns: Vec::new(),
            sensor_m,
            mount_m: None,
            world_from_file,
            files: Vec::new(),
            drive: None,
        }
    }

    /// Keeps the file of a sweep by itself.
    pub(super) fn keep(&mut self, name: String, format: &'static str, bytes: Arc<Vec<u8>>) {
        self.files = vec![SweepSource {
            name,
            format,
            bytes,
            time_s: 0.0,
            world_from_file: self.world_from_file,
            sensor_m: self.mount_m.unwrap_or(self.sensor_m),
        }];
    }

    /// The recordings of a scene from these files. Errors in one line if they cannot be kept.
    fn recordings(&self, scene: &Scene) -> Result<Vec<Arc<SweepRecording>>, FormatError> {
        let bytes: usize = self.files.iter().map(|file| file.bytes.len()).sum();
        if bytes > SweepRecording::LARGEST {
            let line = format!("{bytes} bytes, expected at most {}", SweepRecording::LARGEST);
            return Err(FormatError::new(line));
        }
        let before = Arc::new(scene.clone());
        let recording = |file: &SweepSource| {
            let returns = SweepFile::open(file.format, &file.bytes)?.returns(&file.world_from_file);
            Ok(Arc::new(SweepRecording {
                file: quoted(&file.name, Scene::LONGEST_NAME).into(),
                format: file.format.into(),
                time_s: file.time_s,
                bytes: file.bytes.clone(),
                world_from_file: file.world_from_file,
                sensor_m: file.sensor_m,
                returns: Arc::new(returns),
                before: before.clone(),
            }))
        };
        self.files.iter().map(recording).collect()
    }
}

impl ImportedScene {
    /// The scene with its sweep kept beside it, as it came; a note says if it cannot be kept.
    pub fn with_recording(mut self) -> Self {
        let Some(sweep) = self.sweep.take() else {
            return self;
        };
        match sweep.recordings(&self.scene) {
            Ok(recordings) => {
                let told = match recordings.as_slice() {
                    [one] => format!("{} stays with the scene, all its fields too", one.file),
                    all => format!("{} sweeps stay with the scene", all.len()),
                };
                self.notes.push(told);
                self.skipped.retain(|what, _| !is_kept(what));
                Arc::make_mut(&mut self.scene.kept).sweeps = recordings;
            }
            Err(why) => self
                .notes
                .push(format!("the sweep is not kept with the scene: {why}")),
        }
        self
    }
}

/// True for what voxels do not tell and a file that is kept does.
fn is_kept(what: &str) -> bool {
    let fields = ["intensity", "ring", "remission"];
    fields.contains(&what) || what.starts_with("field ") || what.starts_with("property ")
}
