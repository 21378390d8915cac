//! The camera that KITTI's objects are seen by, and its level frame.

use glam::{DMat3, DQuat, DVec2, DVec3};
use scene::{Camera, Pose, SensorRig};

/// Least cosine between the direction of a front camera and the vehicle's x axis.
const LEAST_AHEAD: f64 = 0.5;
/// Near plane, m: parts of a box that are nearer to the camera are cut off.
const NEAR_M: f64 = 0.1;

/// The camera of the rig that looks ahead.
pub(super) struct FrontCamera {
    /// x right, y straight down, z ahead.
    pub(super) ego_from_rect: Pose,
    /// Takes directions of the level frame to homogeneous pixels of the camera as it is mounted.
    pixels: DMat3,
    /// Pixels per row, and rows.
    pub(super) size: DVec2,
}

/// A level frame (x right, y down, z ahead) at a place, its z along a direction on the ground.
pub(super) fn level(ahead: DVec2, at_m: DVec3) -> Pose {
    let ahead = ahead.normalize_or(DVec2::X);
    let right = DVec3::new(ahead.y, -ahead.x, 0.0);
    Pose {
        rotation: DQuat::from_mat3(&DMat3::from_cols(right, -DVec3::Z, ahead.extend(0.0))),
        translation_m: at_m,
    }
}

impl FrontCamera {
    /// The camera that looks most nearly ahead; `None` if none does.
    pub(super) fn from_rig(rig: &SensorRig) -> Option<Self> {
        let ahead = |c: &Camera| (c.ego_from_camera().rotation * DVec3::Z).x;
        let best = rig.cameras.iter().max_by(|a, b| ahead(a).total_cmp(&ahead(b)))?;
        if ahead(best) < LEAST_AHEAD {
            return None;
        }
        let pose = best.ego_from_camera();
        let ego_from_rect = level((pose.rotation * DVec3::Z).truncate(), pose.translation_m);
        let [fx, fy] = best.focal_px;
        let [cx, cy] = best.center_px;
        let intrinsics = DMat3::from_cols(
            DVec3::new(fx, 0.0, 0.0),
            DVec3::new(0.0, fy, 0.0),
            DVec3::new(cx, cy, 1.0),
        );
        let camera_from_rect = pose.rotation.conjugate() * ego_from_rect.rotation;
        Some(Self {
            ego_from_rect,
            pixels: intrinsics * DMat3::from_quat(camera_from_rect),
            size: DVec2::new(f64::from(best.width), f64::from(best.height)),
        })
    }

    /// The 3 x 4 matrix P, row by row.
    pub(super) fn projection(&self) -> [f64; 12] {
        let rows = self.pixels.transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis];
        std::array::from_fn(|i| if i % 4 == 3 { 0.0 } else { rows[i / 4][i % 4] })
    }

    /// Where a point of the level frame is in the picture, px; `None` behind the camera.
    pub(super) fn pixel(&self, in_rect: DVec3) -> Option<DVec2> {
        let p = self.pixels * in_rect;
        (p.z >= NEAR_M).then(|| p.truncate() / p.z)
    }

    /// The rectangle (lower and upper corner, px) around an upright box of eight corners in the level frame, not cut to the
    /// picture; `None` if all of it is behind the camera. Corners are those of `objects::corners_in_ego`.
    pub(super) fn rectangle(&self, corners: &[DVec3; 8]) -> Option<[DVec2; 2]> {
        // Bits of a corner's number are its sides, so an edge joins numbers that differ in one bit.
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut take = |in_camera: DVec3| {
            let at = in_camera.truncate() / in_camera.z;
            (low, high) = (low.min(at), high.max(at));
        };
        let seen = corners.map(|c| self.pixels * c);
        for (i, a) in seen.iter().enumerate() {
            if a.z >= NEAR_M {
                take(*a);
            }
            for bit in [1, 2, 4] {
                let b = seen[i ^ bit];
                if a.z < NEAR_M && b.z >= NEAR_M {
                    take(a.lerp(b, (NEAR_M - a.z) / (b.z - a.z)));
                }
            }
        }
        low.is_finite().then_some([low, high])
    }
}
