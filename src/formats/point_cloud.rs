//! LiDAR sweeps as files: nuScenes `.pcd.bin`, and PLY.

use glam::DVec3;

use scene::{Class, LidarPattern, LidarSweep};

/// nuScenes `LIDAR_TOP` sweep: no header; x, y, z in the sensor's frame in m, intensity 0 to 255, ring index, each a
/// little-endian f32 (nuscenes-devkit, `LidarPointCloud.from_file`). Points in the order of the sweep.
pub fn nuscenes(sweep: &LidarSweep, pattern: &LidarPattern) -> Vec<u8> {
    let sensor_from_ego = pattern.ego_from_sensor().inverse();
    let mut out = Vec::with_capacity(sweep.points.len() * 20);
    for p in &sweep.points {
        let at = sensor_from_ego.apply(DVec3::from_array(p.position_in_ego.map(f64::from)));
        let [x, y, z] = at.as_vec3().to_array();
        out.extend(
            [x, y, z, p.intensity, f32::from(p.ring)]
                .into_iter()
                .flat_map(f32::to_le_bytes),
        );
    }
    out
}

/// Binary little-endian PLY: x, y, z in the ego frame in m, range, intensity, drop probability, ring, class; the names
/// of the classes as comments.
pub fn ply(sweep: &LidarSweep) -> Vec<u8> {
    let classes: String = Class::ALL
        .iter()
        .map(|c| format!("comment class {} {}\n", c.id(), c.name()))
        .collect();
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\ncomment frame ego: x forward, y left, z up, m\n{classes}element vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty float range_m\nproperty float intensity\n\
         property float drop_probability\nproperty ushort ring\nproperty uchar class\nend_header\n",
        sweep.points.len()
    )
    .into_bytes();
    for p in &sweep.points {
        let floats = [p.range_m, p.intensity, p.drop_probability];
        out.extend(
            p.position_in_ego
                .into_iter()
                .chain(floats)
                .flat_map(f32::to_le_bytes),
        );
        out.extend(p.ring.to_le_bytes());
        out.push(p.class.id());
    }
    out
}
