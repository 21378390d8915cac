//! nuScenes tables (nutonomy/nuscenes-devkit, `docs/schema_nuscenes.md`): definitions that reading and writing share.
//!
//! A folder holds `v1.0-*/` with one JSON array per table, and the files that `sample_data` names. Tokens are 32 hexadecimal
//! digits; quaternions are w, x, y, z; sizes are width, length, height; annotations and ego poses are in the global frame,
//! sensors in the ego frame (x forward, y left, z up); times are microseconds. Key frames are 2 Hz.

pub mod categories;
pub mod tables;
pub mod tokens;

use glam::DQuat;
use scene::Pose;

/// Key frames per second.
pub const KEY_FRAMES_HZ: f64 = 2.0;

/// A quaternion in the order of the tables.
pub fn wxyz(q: DQuat) -> [f64; 4] {
    [q.w, q.x, q.y, q.z]
}

/// A pose of a table. Errors in one line if a number is not finite, or the quaternion cannot be brought to length 1.
pub fn pose(what: &str, rotation: [f64; 4], translation_m: [f64; 3]) -> Result<Pose, String> {
    let norm = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
    // Written so that NaN fails too.
    let turns = (1e-6..1e6).contains(&norm);
    match turns && translation_m.iter().all(|v| v.is_finite()) {
        true => Ok(Pose::from_wxyz(rotation, translation_m)),
        false => Err(format!(
            "{what}: translation {translation_m:?}, rotation {rotation:?}, expected finite numbers and a quaternion"
        )),
    }
}

/// Heading of a rotation, rad, counter-clockwise from x.
pub fn yaw_rad(rotation: DQuat) -> f64 {
    (rotation * glam::DVec3::X).truncate().to_angle()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_that_are_none_are_refused() {
        let turned = pose("a", [0.0, 0.0, 0.0, -2.0], [1.0, 2.0, 3.0]).expect("sound");
        assert!((yaw_rad(turned.rotation).abs() - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(wxyz(turned.rotation), [0.0, 0.0, 0.0, -1.0]);
        for (q, t) in [([0.0; 4], 0.0), ([f64::NAN; 4], 0.0), ([1.0; 4], f64::INFINITY)] {
            assert!(pose("box 3", q, [t; 3]).expect_err("none").starts_with("box 3"));
        }
    }
}
