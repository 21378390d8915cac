//! `sweeps.json` and the folder `sweeps/`: the recorded sweeps that a scene was imported from.

use std::io::{Cursor, Read, Seek};
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use scene::message::quoted;
use scene::{Motion, Pose, Scene, SweepRecording};

use super::archive::{MAX_JSON, Reader, Writer, parse, within};
use super::read::read_alone;
use super::{LARGEST_FILE, ProjectError, alone_to_bytes, migrate};
use crate::sweep_file::SweepFile;

const HEADER: &str = "sweeps.json";
const BEFORE: &str = "sweeps/before.loom";
/// Farthest place of a sensor, m.
const FARTHEST_M: f64 = 1e6;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SweepHeader {
    /// Name of the file, and id of its format.
    file: String,
    format: String,
    time_s: f64,
    world_from_file: Pose,
    sensor_m: DVec3,
}

impl SweepHeader {
    fn is_sound(&self) -> bool {
        let pose = &self.world_from_file;
        let is_turn = (pose.rotation.length_squared() - 1.0).abs() < 1e-6;
        let is_moment = (0.0..=Motion::MAX_TIME_S).contains(&self.time_s);
        let is_near = |at: DVec3| at.abs().max_element() <= FARTHEST_M;
        is_turn && is_moment && is_near(pose.translation_m) && is_near(self.sensor_m)
    }
}

fn entry(index: usize) -> String {
    format!("sweeps/{index:04}")
}

/// Writes the files, their poses and the scene before any edit; nothing without sweeps.
pub(super) fn write(out: &mut Writer, sweeps: &[Arc<SweepRecording>]) -> Result<(), ProjectError> {
    let Some(first) = sweeps.first() else {
        return Ok(());
    };
    check(sweeps.len(), sweeps.iter().map(|sweep| sweep.bytes.len()).sum())?;
    let header = |sweep: &Arc<SweepRecording>| SweepHeader {
        file: sweep.file.to_string(),
        format: sweep.format.to_string(),
        time_s: sweep.time_s,
        world_from_file: sweep.world_from_file,
        sensor_m: sweep.sensor_m,
    };
    out.json(HEADER, &sweeps.iter().map(header).collect::<Vec<_>>())?;
    for (i, sweep) in sweeps.iter().enumerate() {
        out.packed(&entry(i), &sweep.bytes)?;
    }
    out.packed(BEFORE, &alone_to_bytes(&first.before)?)
}

/// Reads the recordings.
pub(super) fn read<R: Read + Seek>(file: &mut Reader<R>) -> Result<Vec<Arc<SweepRecording>>, ProjectError> {
    if !file.has(HEADER) {
        return Ok(Vec::new());
    }
    let headers: Vec<SweepHeader> = parse(HEADER, &file.bytes(HEADER, MAX_JSON)?)?;
    check(headers.len(), 0)?;
    let before = file.bytes(BEFORE, LARGEST_FILE)?;
    let before = read_alone(Cursor::new(&before[..]), &migrate::ALL).map_err(|e| ProjectError::Damaged {
        entry: BEFORE.into(),
        detail: e.to_string(),
    })?;
    let before = Arc::new(before);
    let (mut sweeps, mut bytes) = (Vec::new(), 0);
    for (i, header) in headers.into_iter().enumerate() {
        let sweep = read_one(file, i, header, before.clone())?;
        bytes += sweep.bytes.len();
        check(i, bytes)?;
        sweeps.push(Arc::new(sweep));
    }
    Ok(sweeps)
}

fn read_one<R: Read + Seek>(
    file: &mut Reader<R>,
    index: usize,
    header: SweepHeader,
    before: Arc<Scene>,
) -> Result<SweepRecording, ProjectError> {
    if !header.is_sound() {
        return Err(ProjectError::Unsound(format!(
            "{HEADER}: sweep {index} has a pose, place or time that is none"
        )));
    }
    let bytes = file.bytes(&entry(index), SweepRecording::LARGEST as u64)?;
    let name = quoted(&header.file, Scene::LONGEST_NAME);
    let records = SweepFile::open(&header.format, &bytes).map_err(|e| ProjectError::Damaged {
        entry: entry(index),
        detail: e.to_string(),
    })?;
    Ok(SweepRecording {
        returns: Arc::new(records.returns(&header.world_from_file)),
        file: name.into(),
        format: header.format.into(),
        time_s: header.time_s,
        bytes: Arc::new(bytes),
        world_from_file: header.world_from_file,
        sensor_m: header.sensor_m,
        before,
    })
}

fn check(sweeps: usize, bytes: usize) -> Result<(), ProjectError> {
    within("the number of sweeps", sweeps as u64, SweepRecording::MOST as u64)?;
    let most = SweepRecording::LARGEST as u64;
    within("the size of all sweeps", bytes as u64, most)
}
