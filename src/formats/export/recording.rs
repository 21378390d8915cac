//! The sweeps that a scene was imported from, in the format of their files, with its edits.

use std::sync::Arc;

use scene::{Provenance, Scene, SweepRecording};

use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::sweep_file::SweepFile;
use crate::{FormatError, Holds, kitti};

/// Ending of the file of origins: a byte for each record, the number of its [`Provenance`].
const ORIGINS: &str = ".provenance";

/// Each file under its own name, and the origin of each of its records beside it. Records that no edit touches keep their
/// bytes; without edits the file is the same.
pub const EXPORTER: Exporter = Exporter {
    id: "recording",
    title: "LiDAR: the imported sweeps in their own format, only what edits touch changed",
    file_name: None,
    holds: &[Holds::Points],
    lost: "classes and boxes: only the returns of the sweep are written",
    span: ExportSpan::Moment,
    needs: &[Product::Recording],
    write,
};

fn write(scene: &Scene, products: &mut dyn Products) -> Result<Vec<OutFile>, FormatError> {
    if scene.kept.sweeps.is_empty() {
        return Err(FormatError::new(
            "the scene keeps no sweep: it was imported from none, or from a file that could not be kept",
        ));
    }
    let mut files = Vec::new();
    for (i, recording) in scene.kept.sweeps.iter().enumerate() {
        let edits = products.sweep_edits(i)?;
        let file = SweepFile::open(&recording.format, &recording.bytes)?;
        let (bytes, origins) = file.edited(&edits, &recording.world_from_file.inverse());
        let origins: Vec<u8> = origins
            .into_iter()
            .map(|origin: Provenance| origin as u8)
            .collect();
        files.push(OutFile::new(&recording.file, bytes));
        files.push(OutFile::new(&format!("{}{ORIGINS}", recording.file), origins));
    }
    files.extend(poses(scene));
    Ok(files)
}

/// Poses and times of the sweeps of a drive whose files are numbered, so that the folder opens as a drive again.
fn poses(scene: &Scene) -> Vec<OutFile> {
    let sweeps = &scene.kept.sweeps;
    let is_numbered = |name: &str| {
        let stem = name.split('.').next().unwrap_or_default();
        stem.parse::<u64>().is_ok()
    };
    if sweeps.len() < 2 || !sweeps.iter().all(|sweep| is_numbered(&sweep.file)) {
        return Vec::new();
    }
    let from_first = sweeps[0].world_from_file.inverse();
    let pose = |sweep: &Arc<SweepRecording>| {
        let numbers = kitti::matrix_of(&(from_first * sweep.world_from_file));
        numbers.map(|v| v.to_string()).join(" ") + "\n"
    };
    let (poses, times): (String, String) = sweeps
        .iter()
        .map(|sweep| (pose(sweep), format!("{}\n", sweep.time_s)))
        .unzip();
    vec![
        OutFile::new("poses.txt", poses.into_bytes()),
        OutFile::new("times.txt", times.into_bytes()),
    ]
}
