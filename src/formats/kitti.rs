//! Frames of KITTI (Geiger et al., "Vision meets Robotics", 2013), shared by reading and writing.
//!
//! The velodyne looks along the vehicle: x forward, y left, z up, so its axes are those of the ego frame here. A camera's
//! frame is x right, y down, z forward; labels of objects are in that of the rectified reference camera.

use glam::{DMat3, DQuat, DVec3};
use scene::{Pose, SensorRig};

/// The line of `calib.txt` with the pose that takes points of the ego frame to the velodyne's; this program's own.
pub const EGO_TO_VELO: &str = "Tr_ego_to_velo";

/// Where a velodyne is that no file tells of: the LiDAR of the default rig, its axes along the vehicle.
pub fn ego_from_default_velo() -> Pose {
    ego_from_velo(&SensorRig::default()).unwrap_or_default()
}

/// The velodyne's frame: where the rig's first LiDAR is, its axes along the vehicle. `None` without one.
pub fn ego_from_velo(rig: &SensorRig) -> Option<Pose> {
    let lidar = rig.lidars.first()?;
    Some(Pose {
        rotation: DQuat::IDENTITY,
        translation_m: DVec3::from_array(lidar.translation_m),
    })
}

/// A pose as the 12 numbers of a 3 x 4 matrix, row by row.
pub fn matrix_of(pose: &Pose) -> [f64; 12] {
    let rows = DMat3::from_quat(pose.rotation).transpose();
    let of = |row: DVec3, place: f64| [row.x, row.y, row.z, place];
    let t = pose.translation_m;
    let rows = [of(rows.x_axis, t.x), of(rows.y_axis, t.y), of(rows.z_axis, t.z)];
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

/// The pose of 12 numbers of a 3 x 4 matrix; `None` if they are not 12, not finite, or no rotation and place.
pub fn pose_from(line: &str) -> Option<Pose> {
    let numbers: Option<Vec<f64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
    let m: [f64; 12] = numbers?.try_into().ok()?;
    let row = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    let rotation = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let off = rotation * rotation.transpose() - DMat3::IDENTITY;
    let is_rotation = off.to_cols_array().iter().all(|v| v.abs() < 1e-3) && rotation.determinant() > 0.0;
    let translation_m = DVec3::new(m[3], m[7], m[11]);
    (is_rotation && translation_m.is_finite()).then(|| Pose {
        rotation: DQuat::from_mat3(&rotation).normalize(),
        translation_m,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_come_back() {
        let pose = Pose::from_wxyz([0.7, -0.1, 0.2, -0.6], [1.0, -2.5, 3.25]);
        let m = matrix_of(&pose);
        let p = DVec3::new(4.0, -5.0, 6.0);
        let by_hand = DVec3::from_array(
            [0, 1, 2].map(|i| m[4 * i] * p.x + m[4 * i + 1] * p.y + m[4 * i + 2] * p.z + m[4 * i + 3]),
        );
        assert!((by_hand - pose.apply(p)).length() < 1e-12);
        let line = m.map(|v| v.to_string()).join(" ");
        let back = pose_from(&line).expect("a pose");
        assert!((back.apply(p) - pose.apply(p)).length() < 1e-9);
        for bad in [
            "",
            "1 0 0 0 0 1 0 0 0 0 1",
            "2 0 0 0 0 1 0 0 0 0 1 0",
            "1 0 0 0 0 1 0 nan 0 0 1 0",
            "1 0 0 0 0 -1 0 0 0 0 1 0",
        ] {
            assert_eq!(pose_from(bad), None, "{bad}");
        }
    }
}
