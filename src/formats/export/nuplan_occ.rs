//! Occupancy as Nuplan-Occ keeps it.

use super::{ExportSpan, Exporter, OutFile};
use crate::{Holds, nuplan_occ};

/// See `nuplan_occ`.
pub const EXPORTER: Exporter = Exporter {
    id: "nuplan-occ",
    title: "Occupancy: Nuplan-Occ .npz, rows x, y, z, label in cells of 0.25 m along the vehicle's axes",
    file_name: Some("nuplan_occ.npz"),
    holds: &[Holds::Occupancy],
    lost: "of a scene in other voxels: which vehicle it is; which ground and what stands beside the road, all background there; motorcycles come back as \
           bicycles; what is more than 5 m above the LiDAR or 50 m away; things less than three voxels high come back three high",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, _| Ok(vec![OutFile::new("nuplan_occ.npz", nuplan_occ::to_bytes(scene)?)]),
};
