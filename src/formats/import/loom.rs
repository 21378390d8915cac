//! The program's own scenes, of every version.

use std::collections::BTreeMap;

use super::{Content, ImportedScene, Importer, first_entry_ends};
use crate::{FormatError, Holds, loom};

/// See [`loom`].
pub const IMPORTER: Importer = Importer {
    id: "loom",
    title: "Sceneloom scenes",
    extensions: &["loom"],
    holds: &[Holds::Scene],
    largest: loom::LARGEST_FILE,
    recognises: |head| first_entry_ends(head, "manifest.json"),
    in_folder: None,
    read: |source| {
        let scene = loom::from_bytes(source.bytes).map_err(FormatError::new)?;
        Ok(Content::Scene(Box::new(ImportedScene {
            sweep: None,
            scene,
            inferred: &[],
            skipped: BTreeMap::new(),
            notes: Vec::new(),
        })))
    },
    #[cfg(test)]
    sample: || loom::to_bytes(&crate::table_tests::scene()).expect("sound"),
};
