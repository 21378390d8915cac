//! Occupancy as SurroundOcc keeps it.

use super::{ExportSpan, Exporter, OutFile};
use crate::{Holds, sparse_npy};

/// See `sparse_npy`: cells of 0.5 m, 200 x 200 x 16 of them around the first LiDAR.
pub const EXPORTER: Exporter = Exporter {
    id: "surroundocc",
    title: "Occupancy: SurroundOcc .npy, rows x, y, z, class in cells of 0.5 m, LiDAR frame",
    file_name: Some("surroundocc.npy"),
    holds: &[Holds::Occupancy],
    lost: "the class others (ignored there); what is more than 3 m above the LiDAR or 50 m away; everything finer than 0.5 m: a \
           voxel comes back with the most frequent class of its cell, and so does what is free in that cell",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, _| {
        let bytes = sparse_npy::to_bytes(scene, &sparse_npy::SURROUND_OCC)?;
        Ok(vec![OutFile::new("surroundocc.npy", bytes)])
    },
};
