//! Poses of the protocol and of scenes. Both take points of the inner frame to the outer one, with the same axes: world and
//! vehicle x forward, y left, z up; cameras x right, y down, z forward. The protocol's numbers are 32-bit floats.

use glam::{DQuat, DVec3};
use tonic::Status;

use crate::limits::FARTHEST_M;
use crate::wire;
use scene::Pose;

/// The poses at the start and at the end of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// At the start.
    pub start: Pose,
    /// At the end.
    pub end: Pose,
}

impl Pair {
    /// Reads a message; `what` names it in errors. An end that is missing is the start. Errors in one line if the start
    /// is missing, a number is not finite, a quaternion is none, or a place is too far away.
    pub fn read(pair: Option<&wire::PosePair>, what: &str) -> Result<Self, Status> {
        let pair = pair.ok_or_else(|| missing(what))?;
        let start = pair.start_pose.as_ref().ok_or_else(|| missing(what))?;
        let start = read(start, &format!("{what}.start_pose"))?;
        let end = match &pair.end_pose {
            Some(end) => read(end, &format!("{what}.end_pose"))?,
            None => start,
        };
        Ok(Self { start, end })
    }

    /// The pose at a share of the frame, 0 at its start and 1 at its end.
    pub fn at(&self, share: f64) -> Pose {
        if share <= 0.0 || self.start == self.end {
            return self.start;
        }
        if share >= 1.0 {
            return self.end;
        }
        Pose {
            rotation: self.start.rotation.slerp(self.end.rotation, share),
            translation_m: self.start.translation_m.lerp(self.end.translation_m, share),
        }
    }

    /// The pair with a pose of the inner frame multiplied on the right.
    pub fn then(&self, inner: &Pose) -> Self {
        Self {
            start: self.start * *inner,
            end: self.end * *inner,
        }
    }

    /// True if both pairs are the same as far as the protocol's numbers can tell.
    pub fn is_near(&self, other: &Self) -> bool {
        is_near(&self.start, &other.start) && is_near(&self.end, &other.end)
    }
}

fn missing(what: &str) -> Status {
    Status::invalid_argument(format!(
        "{what} is missing, expected a start_pose and an end_pose"
    ))
}

fn read(pose: &wire::WirePose, what: &str) -> Result<Pose, Status> {
    let at = pose.vec.unwrap_or_default();
    let at = DVec3::new(at.x.into(), at.y.into(), at.z.into());
    // Written so that NaN fails too.
    if !at.abs().cmple(DVec3::splat(FARTHEST_M)).all() {
        return Err(Status::invalid_argument(format!(
            "{what}.vec is {at}, expected finite numbers within {FARTHEST_M} m"
        )));
    }
    let Some(q) = pose.quat else {
        return Err(Status::invalid_argument(format!("{what}.quat is missing")));
    };
    let q = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
    let length = q.length();
    if !(0.9..=1.1).contains(&length) {
        return Err(Status::invalid_argument(format!(
            "{what}.quat has length {length}, expected a unit quaternion"
        )));
    }
    Ok(Pose {
        rotation: q.normalize(),
        translation_m: at,
    })
}

/// A pose as a message.
pub fn write(pose: &Pose) -> wire::WirePose {
    let (at, q) = (pose.translation_m, pose.rotation);
    wire::WirePose {
        vec: Some(wire::Vec3 {
            x: at.x as f32,
            y: at.y as f32,
            z: at.z as f32,
        }),
        quat: Some(wire::Quat {
            w: q.w as f32,
            x: q.x as f32,
            y: q.y as f32,
            z: q.z as f32,
        }),
    }
}

/// True if two poses are the same as far as the protocol's numbers can tell: clients multiply them in 32 bits.
pub fn is_near(a: &Pose, b: &Pose) -> bool {
    let farther_m = a.translation_m.abs().max_element();
    let off_m = a.translation_m.distance(b.translation_m);
    // A rotation by an angle has 1 - |dot| of an eighth of its square.
    let off_rad = (8.0 * (1.0 - a.rotation.dot(b.rotation).abs()).max(0.0)).sqrt();
    off_m <= 1e-5 + 1e-6 * farther_m && off_rad <= 1e-5
}

/// Heading on the ground, rad, counter-clockwise from x.
pub fn yaw_rad(pose: &Pose) -> f64 {
    (pose.rotation * DVec3::X).truncate().to_angle()
}

/// A time of the protocol, s.
pub fn seconds(us: u64) -> f64 {
    us as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_come_back_and_bad_ones_are_refused() {
        let pose = Pose::from_wxyz([0.7, -0.1, 0.2, -0.6], [12.5, -3.25, 1.5]);
        let pair = |pose| wire::PosePair {
            start_pose: Some(pose),
            end_pose: None,
        };
        let read = |pose| Pair::read(Some(&pair(pose)), "sensor_pose");
        let back = read(write(&pose)).expect("a pose");
        assert!(is_near(&back.start, &pose) && back.start == back.end);
        assert!(!is_near(&back.start, &(pose * Pose::planar(0.0, 0.0, 1e-4))));
        assert!(!is_near(&back.start, &(pose * Pose::planar(1e-3, 0.0, 0.0))));
        for bad in [f32::NAN, f32::INFINITY, 1e9] {
            let mut sent = write(&pose);
            sent.vec = sent.vec.map(|v| wire::Vec3 { y: bad, ..v });
            let told = read(sent).expect_err("a bad place");
            assert!(told.message().starts_with("sensor_pose.start_pose.vec"), "{told}");
            let mut sent = write(&pose);
            sent.quat = sent.quat.map(|q| wire::Quat { z: bad, ..q });
            let told = read(sent).expect_err("a bad rotation");
            assert!(
                told.message().starts_with("sensor_pose.start_pose.quat"),
                "{told}"
            );
        }
        assert!(Pair::read(None, "sensor_pose").is_err());
        assert!(read(wire::WirePose::default()).is_err());
    }

    #[test]
    fn a_pose_between_lies_between() {
        let pair = Pair {
            start: Pose::planar(0.0, 0.0, 0.0),
            end: Pose::planar(4.0, 2.0, 1.0),
        };
        let middle = pair.at(0.5);
        assert!((middle.translation_m - DVec3::new(2.0, 1.0, 0.0)).length() < 1e-12);
        assert!((yaw_rad(&middle) - 0.5).abs() < 1e-12);
        assert_eq!(pair.at(1.0), pair.end);
    }
}
