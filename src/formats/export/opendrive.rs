//! Roads as OpenDRIVE.

use super::{ExportSpan, Exporter, OutFile};
use crate::{Holds, opendrive};

/// See [`opendrive::write`].
pub const EXPORTER: Exporter = Exporter {
    id: "opendrive",
    title: "Roads: OpenDRIVE 1.8 with lanes, junctions, crossings, heights",
    file_name: Some("map.xodr"),
    holds: &[Holds::Roads],
    lost: "",
    // Roads stand still: they are written as they lie in the world frame.
    span: ExportSpan::Clip,
    needs: &[],
    write: |scene, _| {
        let bytes = opendrive::write::to_bytes(
            &scene.name,
            &scene.canvas().layout,
            &scene.roads,
            &scene.background,
        );
        Ok(vec![OutFile::new("map.xodr", bytes)])
    },
};
