//! A LiDAR sweep as nuScenes keeps it (`.pcd.bin`).

use glam::DVec3;

use scene::{LidarPattern, LidarSweep};

use super::pcd::physical_sweep;
use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds};

/// See [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "nuscenes-lidar",
    title: "LiDAR: nuScenes .pcd.bin, sensor frame (x, y, z, intensity, ring)",
    file_name: Some("LIDAR_TOP.pcd.bin"),
    holds: &[Holds::Points],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep],
    write: |scene, products| {
        let sweep = physical_sweep(scene, products)?;
        // The sweep is of the first one.
        let pattern = scene
            .rig
            .lidars
            .first()
            .ok_or_else(|| FormatError::new("the rig has no LiDAR"))?;
        Ok(vec![OutFile::new("LIDAR_TOP.pcd.bin", to_bytes(&sweep, pattern))])
    },
};

/// nuScenes `LIDAR_TOP` sweep: no header; x, y, z in the sensor's frame in m, intensity 0 to 255, ring index, each a
/// little-endian f32 (nuscenes-devkit, `LidarPointCloud.from_file`). Points in the order of the sweep.
pub fn to_bytes(sweep: &LidarSweep, pattern: &LidarPattern) -> Vec<u8> {
    let sensor_from_ego = pattern.ego_from_sensor().inverse();
    let mut out = Vec::with_capacity(sweep.points.len() * 20);
    for p in &sweep.points {
        let at = sensor_from_ego.apply(DVec3::from_array(p.position_in_ego.map(f64::from)));
        let [x, y, z] = at.as_vec3().to_array();
        let values = [x, y, z, p.intensity, f32::from(p.ring)];
        out.extend(values.into_iter().flat_map(f32::to_le_bytes));
    }
    out
}
