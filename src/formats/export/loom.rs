//! The program's own scenes.

use super::{ExportSpan, Exporter, OutFile};
use crate::{FormatError, Holds, loom};

/// See [`loom`].
pub const EXPORTER: Exporter = Exporter {
    id: "loom",
    title: "Scene: everything, as sceneloom keeps it",
    file_name: Some("scene.loom"),
    holds: &[Holds::Scene],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[],
    write: |scene, _| {
        let bytes = loom::to_bytes(scene).map_err(FormatError::new)?;
        Ok(vec![OutFile::new("scene.loom", bytes)])
    },
};
