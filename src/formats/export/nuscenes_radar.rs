//! Radar scans as nuScenes keeps them, a file a radar.

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, nuscenes_radar, sensor_names};

/// See `nuscenes_radar`.
pub const EXPORTER: Exporter = Exporter {
    id: "nuscenes-radar",
    title: "Radar: nuScenes .pcd of 18 fields, sensor frame (place, cross-section, radial speed), a file a radar",
    file_name: None,
    holds: &[Holds::Points],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Radar],
    write: |scene, products| {
        if scene.rig.radars.is_empty() {
            return Err(FormatError::new(format!(
                "the rig {:?} has no radar",
                scene.rig.name
            )));
        }
        let names = sensor_names::radars(&scene.rig);
        let scans = products.radars()?;
        let files = scans.iter().zip(&scene.rig.radars).zip(names);
        let file = |((scan, radar), name): (_, String)| {
            OutFile::new(&format!("{name}.pcd"), nuscenes_radar::to_bytes(scan, radar))
        };
        Ok(files.map(file).collect())
    },
};
