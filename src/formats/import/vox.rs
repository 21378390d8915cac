//! MagicaVoxel models: the colours of classes become those classes.

use super::{Content, GUESSED, ImportFile, ImportedScene, Importer, labelled};
use crate::vox::{VoxFile, VoxMap, place};
use crate::{FormatError, Holds};

/// See `vox`.
pub const IMPORTER: Importer = Importer {
    id: "vox",
    title: "MagicaVoxel models",
    extensions: &["vox"],
    holds: &[Holds::Occupancy],
    largest: 256 << 20,
    recognises: |head| head.starts_with(b"VOX "),
    in_folder: None,
    read: |source| read(source).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

fn read(source: &ImportFile<'_>) -> Result<Content, String> {
    let VoxMap { grid, skipped } = place(&VoxFile::read(source.bytes)?)?;
    Ok(Content::Scene(Box::new(ImportedScene {
        sweep: None,
        scene: labelled(source.name, grid, None),
        inferred: &GUESSED,
        skipped,
        notes: Vec::new(),
    })))
}

#[cfg(test)]
#[path = "vox_tests.rs"]
mod tests;
