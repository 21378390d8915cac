//! Occ3D labels: their voxels as they are, and what they do not carry inferred.

use std::collections::BTreeMap;

use scene::Unobserved;

use super::{Content, GUESSED, Importer, Loaded, first_entry_ends, labelled};
use crate::{FormatError, Holds, occ3d};

/// See [`occ3d`].
pub const IMPORTER: Importer = Importer {
    id: "occ3d",
    title: "Occ3D labels",
    extensions: &["npz"],
    holds: &[Holds::Occupancy],
    largest: occ3d::LARGEST_FILE,
    recognises: |head| first_entry_ends(head, ".npy"),
    in_folder: None,
    read: |source| {
        let frame = occ3d::read(source.bytes).map_err(FormatError::new)?;
        // A voxel was seen if any sensor that the file tells of saw it.
        let seen = match (frame.lidar_observed, frame.camera_observed) {
            (Some(lidar), Some(camera)) => Some(lidar.iter().zip(&camera).map(|(a, b)| *a || *b).collect()),
            (one, other) => one.or(other),
        };
        let unobserved = seen.and_then(|seen: Vec<bool>| Unobserved::from_observed(&seen));
        Ok(Content::Scene(Box::new(Loaded {
            scene: labelled(source.name, frame.labels, unobserved),
            inferred: &GUESSED,
            skipped: BTreeMap::new(),
        })))
    },
    #[cfg(test)]
    sample: || occ3d::to_bytes(&crate::table_tests::scene().frame().occupancy),
};
