//! A clip as a world scenario: the tables; see [`crate::world_scenario`].

use super::{ExportSpan, Exporter, OutFile};
use crate::Holds;
use crate::world_scenario::{clip_id, tables};

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "world-scenario",
    title: "World scenario: parquet tables for Cosmos-Transfer, boxes, ego motion, cameras and map",
    file_name: None,
    holds: &[Holds::Boxes, Holds::Roads],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[],
    write: |scene, _| {
        let id = clip_id(scene);
        let tables = tables::tables(scene)?.into_iter();
        let files = tables.map(|(name, bytes)| OutFile::new(&format!("{id}.{name}.parquet"), bytes));
        Ok(files.collect())
    },
};
