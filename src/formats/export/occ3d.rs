//! Occupancy as Occ3D labels.

use scene::{Class, Extent};

use super::{Exporter, OutFile, Span};
use crate::{FormatError, Holds, occ3d};

/// See [`occ3d`].
pub const EXPORTER: Exporter = Exporter {
    id: "occ3d",
    title: "Occupancy: Occ3D labels.npz, 200 x 200 x 16 class labels",
    file_name: Some("labels.npz"),
    holds: &[Holds::Occupancy],
    lost: "",
    span: Span::Moment,
    needs: &[],
    write: |scene, _| {
        // A map of another extent is cut to what the format holds.
        let occupancy = &scene.frame().occupancy.crop(Extent::WINDOW);
        if let Some((x, y, z, label)) = occupancy.iter_set().find(|(.., label)| *label > Class::FREE) {
            let free = Class::FREE;
            return Err(FormatError::new(format!(
                "voxel {x}, {y}, {z} holds label {label}, expected 0 to {free}"
            )));
        }
        Ok(vec![OutFile::new("labels.npz", occ3d::to_bytes(occupancy))])
    },
};
