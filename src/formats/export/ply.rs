//! A LiDAR sweep as PLY, for viewers.

use scene::{Class, LidarSweep};

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::Holds;

/// See [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "ply",
    title: "LiDAR: PLY for viewers, ego frame, with class, intensity, ring",
    file_name: Some("lidar.ply"),
    holds: &[Holds::Points],
    lost: "single points: they come back as voxels with the class of most of them",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep],
    write: |_, products| Ok(vec![OutFile::new("lidar.ply", to_bytes(&products.sweep()?))]),
};

/// Binary little-endian PLY: x, y, z in the ego frame in m, range in m, intensity, drop probability, time in s (0 at the end of the
/// sweep, before it less), velocity over the ground in m/s along x and y, ring, class; the names of the classes as comments.
pub fn to_bytes(sweep: &LidarSweep) -> Vec<u8> {
    let classes: String = Class::ALL
        .iter()
        .map(|c| format!("comment class {} {}\n", c.id(), c.name()))
        .collect();
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\ncomment frame ego: x forward, y left, z up, m\n{classes}element vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty float range_m\nproperty float intensity\n\
         property float drop_probability\nproperty float time_s\nproperty float velocity_x\nproperty float velocity_y\nproperty ushort ring\nproperty uchar class\nend_header\n",
        sweep.points.len()
    )
    .into_bytes();
    for p in &sweep.points {
        let [along, aside] = p.velocity_mps;
        let floats = [p.range_m, p.intensity, p.drop_probability, p.time_s, along, aside];
        let floats = p.position_in_ego.into_iter().chain(floats);
        out.extend(floats.flat_map(f32::to_le_bytes));
        out.extend(p.ring.to_le_bytes());
        out.push(p.class.id());
    }
    out
}
