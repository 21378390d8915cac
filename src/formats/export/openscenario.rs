//! A clip as OpenSCENARIO.

use super::{ExportSpan, Exporter, OutFile};
use crate::{Holds, opendrive, openscenario};

/// See [`openscenario`].
pub const EXPORTER: Exporter = Exporter {
    id: "openscenario",
    title: "Scenario: OpenSCENARIO XML 1.3 with its roads, for players and simulators",
    file_name: None,
    holds: &[Holds::Roads, Holds::Boxes],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[],
    write: |scene, _| {
        Ok(vec![
            OutFile::new("scenario.xosc", openscenario::to_bytes(scene)?),
            OutFile::new(
                openscenario::MAP,
                opendrive::write::to_bytes(
                    &scene.name,
                    &scene.canvas().layout,
                    &scene.roads,
                    &scene.background,
                ),
            ),
        ])
    },
};
