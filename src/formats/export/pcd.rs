//! A LiDAR sweep as PCD (PCL's format, version 0.7, binary).

use glam::DVec3;
use scene::{LidarSweep, Scene};

use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::physical::to_physical_ground;
use crate::{FormatError, Holds};

/// See [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "pcd",
    title: "LiDAR: PCD for PCL and ROS, ego frame, with class, intensity, ring, time",
    file_name: Some("lidar.pcd"),
    holds: &[Holds::Points],
    lost: "single points: they come back as voxels with the class of most of them",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep],
    write: |scene, products| {
        let sweep = physical_sweep(scene, products)?;
        Ok(vec![OutFile::new("lidar.pcd", to_bytes(&sweep))])
    },
};

/// The sweep of a moment's scene in the ego frame, its ground where the vehicle stands on it.
pub(super) fn physical_sweep(scene: &Scene, products: &mut dyn Products) -> Result<LidarSweep, FormatError> {
    let mut sweep = products.sweep()?;
    if let Some(lidar) = scene.rig.lidars.first() {
        to_physical_ground(&mut sweep, DVec3::from_array(lidar.translation_m), scene.frame());
    }
    Ok(sweep)
}

/// PCD 0.7, `DATA binary`: x, y, z in the ego frame in m, intensity 0 to 255 (f32 each), ring (u16), label (u8, the class in
/// Occ3D), time in s (f32, 0 at the end of the sweep, before it less). Points in the order of the sweep.
pub fn to_bytes(sweep: &LidarSweep) -> Vec<u8> {
    let points = sweep.points.len();
    let mut out = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity ring label time\n\
         SIZE 4 4 4 4 2 1 4\nTYPE F F F F U U F\nCOUNT 1 1 1 1 1 1 1\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary\n"
    )
    .into_bytes();
    out.reserve(points * 23);
    for p in &sweep.points {
        let floats = p.position_in_ego.into_iter().chain([p.intensity]);
        out.extend(floats.flat_map(f32::to_le_bytes));
        out.extend(p.ring.to_le_bytes());
        out.push(p.class.id());
        out.extend(p.time_s.to_le_bytes());
    }
    out
}
