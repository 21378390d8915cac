//! Occupancy as OpenOccupancy (nuScenes-Occupancy) keeps it.

use super::{ExportSpan, Exporter, OutFile};
use crate::Holds;
use crate::sparse_npy::{self, OPEN_OCCUPANCY, SparseDataset};

/// Cells that a scene is written in.
pub(super) const KINDS: [SparseDataset; 1] = [OPEN_OCCUPANCY];

/// See `sparse_npy`: cells of 0.2 m, 512 x 512 x 40 of them around the first LiDAR.
pub const EXPORTER: Exporter = Exporter {
    id: "openoccupancy",
    title: "Occupancy: OpenOccupancy .npy, rows z, y, x, class in cells of 0.2 m, LiDAR frame",
    file_name: Some("openoccupancy.npy"),
    holds: &[Holds::Occupancy],
    lost: "of a scene in other voxels: the class others (noise there); what is more than 3 m above the LiDAR or 51 m away; things less than three voxels high \
           come back three high",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, _| {
        let bytes = sparse_npy::to_bytes(scene, &KINDS)?;
        Ok(vec![OutFile::new("openoccupancy.npy", bytes)])
    },
};
