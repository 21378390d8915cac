//! Occupancy as SurroundOcc and UniScene keep it.

use super::{ExportSpan, Exporter, OutFile};
use crate::Holds;
use crate::sparse_npy::{self, SURROUND_OCC, SURROUND_OCC_FINE, SparseDataset, UNI_SCENE};

/// Cells that a scene is written in: those that it was opened with, else the first.
pub(super) const KINDS: [SparseDataset; 3] = [SURROUND_OCC, SURROUND_OCC_FINE, UNI_SCENE];

/// See `sparse_npy`: cells of 0.5 m, 200 x 200 x 16 of them around the first LiDAR; of 0.2 m or UniScene's of 0.125 m for a scene
/// that was opened with those.
pub const EXPORTER: Exporter = Exporter {
    id: "surroundocc",
    title: "Occupancy: SurroundOcc .npy, rows x, y, z, class in cells of 0.5 m, LiDAR frame",
    file_name: Some("surroundocc.npy"),
    holds: &[Holds::Occupancy],
    lost: "of a scene in other voxels: the class others (ignored there); what is more than 3 m above the LiDAR or 50 m away; everything finer than 0.5 m: a \
           voxel comes back with the most frequent class of its cell, and so does what is free in that cell",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, _| {
        let bytes = sparse_npy::to_bytes(scene, &KINDS)?;
        Ok(vec![OutFile::new("surroundocc.npy", bytes)])
    },
};
