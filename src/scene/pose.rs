//! Rigid transforms between named frames: `world_from_ego`, `ego_from_sensor`.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// Maps points of the frame after `from` to the frame before it: `p_a = pose_a_from_b.apply(p_b)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Rotation, a unit quaternion (x, y, z, w).
    pub rotation: DQuat,
    /// Origin of the inner frame in the outer one, m.
    pub translation_m: DVec3,
}

impl Pose {
    /// The transform that leaves points as they are.
    pub const IDENTITY: Pose = Pose {
        rotation: DQuat::IDENTITY,
        translation_m: DVec3::ZERO,
    };

    /// From a quaternion in the order w, x, y, z (as nuScenes writes it), normalised here.
    pub fn from_wxyz(q: [f64; 4], translation_m: [f64; 3]) -> Pose {
        Pose {
            rotation: DQuat::from_xyzw(q[1], q[2], q[3], q[0]).normalize(),
            translation_m: DVec3::from_array(translation_m),
        }
    }

    /// A pose on the ground plane: position in m and heading in rad, counter-clockwise from x.
    pub fn planar(x_m: f64, y_m: f64, yaw_rad: f64) -> Pose {
        Pose {
            rotation: DQuat::from_rotation_z(yaw_rad),
            translation_m: DVec3::new(x_m, y_m, 0.0),
        }
    }

    /// The point in the outer frame.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation_m
    }

    /// The inverse transform.
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.conjugate();
        Pose {
            rotation,
            translation_m: -(rotation * self.translation_m),
        }
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl std::ops::Mul for Pose {
    type Output = Pose;
    /// `a_from_c = a_from_b * b_from_c`.
    fn mul(self, inner: Pose) -> Pose {
        Pose {
            rotation: self.rotation * inner.rotation,
            translation_m: self.apply(inner.translation_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_and_product_chains() {
        let a = Pose::planar(3.0, -2.0, 0.7);
        let b = Pose::from_wxyz([0.7, -0.1, 0.2, -0.6], [1.0, 2.0, 3.0]);
        let p = DVec3::new(4.0, -5.0, 6.0);
        assert!((a.inverse().apply(a.apply(p)) - p).length() < 1e-12);
        assert!(((a * b).apply(p) - a.apply(b.apply(p))).length() < 1e-12);
    }
}
