//! The sweeps that a scene was imported from, in the format of their files, with its edits.

use scene::{Provenance, Scene};

use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::sweep_file::SweepFile;
use crate::{FormatError, Holds};

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
    Ok(files)
}
