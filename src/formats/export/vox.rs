//! Occupancy for MagicaVoxel.

use super::{ExportSpan, Exporter, OutFile};
use crate::{Holds, vox, voxels};

/// See `vox`.
pub const EXPORTER: Exporter = Exporter {
    id: "vox",
    title: "Occupancy: MagicaVoxel .vox, a voxel each, coloured by class",
    file_name: Some("occupancy.vox"),
    holds: &[Holds::Occupancy],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, _| {
        let frame = scene.frame();
        voxels::check(frame)?;
        Ok(vec![OutFile::new(
            "occupancy.vox",
            vox::to_bytes(&frame.occupancy),
        )])
    },
};
