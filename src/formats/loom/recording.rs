//! `sweep.json` and the folder `sweep/`: the recorded sweep that a scene was imported from.

use std::io::{Cursor, Read, Seek};
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use scene::message::quoted;
use scene::{Pose, Scene, SweepRecording};

use super::archive::{MAX_JSON, Reader, Writer, parse};
use super::read::read_alone;
use super::{LARGEST_FILE, ProjectError, alone_to_bytes, migrate};
use crate::sweep_file::SweepFile;

const HEADER: &str = "sweep.json";
const FILE: &str = "sweep/file";
const BEFORE: &str = "sweep/before.loom";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SweepHeader {
    /// Name of the file.
    file: String,
    world_from_file: Pose,
    sensor_m: DVec3,
}

/// Writes the file, its pose and the scene before any edit.
pub(super) fn write(out: &mut Writer, sweep: &SweepRecording) -> Result<(), ProjectError> {
    let header = SweepHeader {
        file: sweep.file.to_string(),
        world_from_file: sweep.world_from_file,
        sensor_m: sweep.sensor_m,
    };
    out.json(HEADER, &header)?;
    out.put(FILE, &sweep.bytes)?;
    out.packed(BEFORE, &alone_to_bytes(&sweep.before)?)
}

/// Reads the recording; `None` if there is none.
pub(super) fn read<R: Read + Seek>(file: &mut Reader<R>) -> Result<Option<SweepRecording>, ProjectError> {
    if !file.has(HEADER) {
        return Ok(None);
    }
    let header: SweepHeader = parse(HEADER, &file.bytes(HEADER, MAX_JSON)?)?;
    let is_turn = (header.world_from_file.rotation.length_squared() - 1.0).abs() < 1e-6;
    if !(is_turn && header.world_from_file.translation_m.is_finite() && header.sensor_m.is_finite()) {
        return Err(ProjectError::Unsound(format!(
            "{HEADER}: a pose or place that is none"
        )));
    }
    let bytes = file.bytes(FILE, SweepRecording::LARGEST as u64)?;
    let name = quoted(&header.file, Scene::LONGEST_NAME);
    let damaged = |detail: String| ProjectError::Damaged {
        entry: FILE.into(),
        detail,
    };
    let records = SweepFile::open(&name, &bytes).map_err(|e| damaged(e.to_string()))?;
    let returns = records.returns(&header.world_from_file);
    let before = file.bytes(BEFORE, LARGEST_FILE)?;
    let before = read_alone(Cursor::new(&before[..]), &migrate::ALL)?;
    Ok(Some(SweepRecording {
        file: name.into(),
        returns: Arc::new(returns),
        bytes: Arc::new(bytes),
        world_from_file: header.world_from_file,
        sensor_m: header.sensor_m,
        before: Arc::new(before),
    }))
}
