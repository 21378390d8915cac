//! The rays of a camera: through its lens and, with a rolling shutter, from the place that the vehicle has reached when
//! the row is read.

use std::f64::consts::PI;

use glam::{DQuat, DVec2, DVec3};

use scene::rig::Carried;
use scene::{Camera, Lens, Optics, Shutter};

/// A ray of the frame of the sensors' poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// The camera's optical centre, m.
    pub origin: DVec3,
    /// Direction; its length is that of 1 m of depth. Zero where the lens sees nothing.
    pub direction: DVec3,
    /// Time at which it is seen, s after the moment of the picture.
    pub after_s: f64,
}

/// The rays of a camera at an image size.
#[derive(Clone, Copy, Debug)]
pub struct CameraRays {
    /// Optical centre in the frame of the sensors' poses at the moment of the picture, m.
    pub origin: DVec3,
    rotation: DQuat,
    optics: Optics,
    size: DVec2,
    rolling: Option<(Shutter, Carried)>,
    is_pinhole: bool,
}

/// Number of points on the border of the area that a sphere covers.
const AROUND: usize = 32;

impl CameraRays {
    /// The rays for pictures of `width` x `height` pixels.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let camera = camera.resized(width.max(1), height.max(1));
        let pose = camera.ego_from_camera();
        let shutter = camera.shutter.filter(|s| s.readout_s > 0.0);
        Self {
            origin: pose.translation_m,
            rotation: pose.rotation,
            optics: Optics::new(&camera),
            size: DVec2::new(f64::from(width.max(1)), f64::from(height.max(1))),
            rolling: shutter.map(|s| (s, camera.carried)),
            is_pinhole: camera.lens == Lens::Pinhole,
        }
    }

    /// True for a pinhole whose picture is read at one instant: straight lines are straight.
    pub fn is_plain(&self) -> bool {
        self.is_pinhole && self.rolling.is_none()
    }

    /// The lens at this image size.
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// The ray through the image point (u, v) in px; pixel i has its middle at i + 1/2.
    #[inline]
    pub fn at(&self, u: f64, v: f64) -> CameraRay {
        let direction = self.optics.direction(u, v);
        let Some((shutter, _)) = &self.rolling else {
            return CameraRay {
                origin: self.origin,
                direction: self.rotation * direction,
                after_s: 0.0,
            };
        };
        let after_s = shutter.after_s(DVec2::new(u, v) / self.size);
        let (origin, rotation) = self.pose_after(after_s);
        CameraRay {
            origin,
            direction: rotation * direction,
            after_s,
        }
    }

    /// Optical centre and turn of the camera some time after the moment of the picture.
    fn pose_after(&self, after_s: f64) -> (DVec3, DQuat) {
        let Some((_, carried)) = &self.rolling else {
            return (self.origin, self.rotation);
        };
        let turn = DQuat::from_rotation_z(carried.yaw_rate_rps * after_s);
        let origin =
            carried.origin_m + turn * (self.origin - carried.origin_m) + carried.velocity_mps * after_s;
        (origin, turn * self.rotation)
    }

    /// A point as the camera sees it, optical frame, m; `velocity_mps` is that of the point. With a rolling shutter it is seen
    /// when its row is read.
    pub fn to_camera(&self, p: DVec3, velocity_mps: DVec3) -> DVec3 {
        let at = |after_s: f64| {
            let (origin, rotation) = self.pose_after(after_s);
            rotation.conjugate() * (p + velocity_mps * after_s - origin)
        };
        let mut seen = at(0.0);
        if let Some((shutter, _)) = &self.rolling {
            // Rows are read much faster than points cross them: each turn leaves a hundredth of the error.
            for _ in 0..4 {
                let Some(px) = self.optics.project(seen) else {
                    break;
                };
                seen = at(shutter.after_s((px / self.size).clamp(DVec2::ZERO, DVec2::ONE)));
            }
        }
        seen
    }

    /// Image point in px and depth in m of a point that stands still; NaN and infinity where no lens could show it.
    pub fn project(&self, p: DVec3) -> DVec3 {
        let q = self.to_camera(p, DVec3::ZERO);
        if self.is_pinhole {
            let px = q.truncate() / q.z * self.optics.focal_px() + self.optics.center_px();
            return px.extend(q.z);
        }
        let px = self.optics.project(q).unwrap_or(DVec2::NAN);
        px.extend(self.optics.depth_m(q))
    }

    /// Image point of a point that moves; `None` where the camera does not see it, or outside the picture by more than
    /// its size.
    pub fn seen_at(&self, p: DVec3, velocity_mps: DVec3) -> Option<DVec2> {
        self.optics.project(self.to_camera(p, velocity_mps))
    }

    /// Pixels that a sphere may cover: lower and upper corner, infinite where they cannot be determined; `None` if the
    /// lens cannot see it. `speed_mps` bounds its speed.
    pub fn bounds(&self, middle: DVec3, radius_m: f64, speed_mps: f64) -> Option<[DVec2; 2]> {
        const ANYWHERE: Option<[DVec2; 2]> = Some([DVec2::NEG_INFINITY, DVec2::INFINITY]);
        let q = self.rotation.conjugate() * (middle - self.origin);
        let distance = q.length();
        let mut radius = radius_m;
        if let Some((shutter, carried)) = &self.rolling {
            let own = carried.velocity_mps.length() + carried.yaw_rate_rps.abs() * distance;
            radius += (speed_mps + own) * shutter.readout_s / 2.0;
        }
        if !(radius < distance * 0.98 && distance.is_finite()) {
            return ANYWHERE;
        }
        // The border of the cone that holds the sphere.
        let angle = (radius / distance).asin();
        let axis = q / distance;
        let (across, up) = axis.any_orthonormal_pair();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut seen = 0;
        for i in 0..AROUND {
            let turn = DVec2::from_angle(2.0 * PI * i as f64 / AROUND as f64);
            let way = axis * angle.cos() + (across * turn.x + up * turn.y) * angle.sin();
            if let Some(px) = self.optics.project(way) {
                (low, high) = (low.min(px), high.max(px));
                seen += 1;
            }
        }
        match seen {
            AROUND => {
                // Between the points the border bends out by less than this.
                let room = (high - low) * 0.02 + 1.0;
                Some([low - room, high + room])
            }
            // Half seen, or around the whole field of view.
            0 if angle < 0.5 && self.optics.project(axis).is_none() => None,
            _ => ANYWHERE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{ReadOut, SensorRig};

    fn rolling(velocity_mps: DVec3, yaw_rate_rps: f64) -> Camera {
        let mut camera = SensorRig::default().cameras[1].clone();
        camera.shutter = Some(Shutter {
            readout_s: 0.03,
            direction: ReadOut::TopToBottom,
        });
        camera.carried = Carried {
            velocity_mps,
            yaw_rate_rps,
            origin_m: DVec3::ZERO,
        };
        camera
    }

    #[test]
    fn rows_are_seen_from_where_the_vehicle_is_by_then() {
        let rays = CameraRays::new(&rolling(DVec3::X * 20.0, 0.5), 1600, 900);
        let (top, middle, bottom) = (rays.at(800.0, 0.0), rays.at(800.0, 450.0), rays.at(800.0, 900.0));
        assert_eq!(
            (top.after_s, middle.after_s, bottom.after_s),
            (-0.015, 0.0, 0.015)
        );
        // 20 m/s for 30 ms, and a little to the side for the turn.
        let way = bottom.origin - top.origin;
        assert!((way.x - 0.6).abs() < 1e-3 && way.y > 0.01, "{way}");
        assert_eq!(middle.origin, rays.origin);
        // A point that a pixel sees projects to that pixel, moving or not.
        for (velocity, uv) in [
            (DVec3::ZERO, (300.5, 80.5)),
            (DVec3::new(-8.0, 12.0, 0.0), (1400.5, 820.5)),
        ] {
            let ray = rays.at(uv.0, uv.1);
            let p = ray.origin + ray.direction * 14.0 - velocity * ray.after_s;
            let px = rays.seen_at(p, velocity).expect("seen");
            assert!(px.distance(DVec2::new(uv.0, uv.1)) < 1e-3, "{px}");
        }
        let still = CameraRays::new(&SensorRig::default().cameras[1], 1600, 900);
        assert!(still.is_plain() && !rays.is_plain());
    }

    #[test]
    fn spheres_cover_no_more_than_their_bounds() {
        let mut fisheye = rolling(DVec3::X * 15.0, -0.3);
        fisheye.lens = Lens::Fisheye {
            k: [-0.01, 0.0, 0.0, 0.0],
            max_angle_deg: 95.0,
        };
        fisheye.focal_px = [500.0; 2];
        for camera in [SensorRig::default().cameras[0].clone(), fisheye] {
            let rays = CameraRays::new(&camera, 800, 450);
            let mut bounded = 0;
            for i in 0..400 {
                let turn = f64::from(i) * 0.37;
                let middle = DVec3::new(turn.cos(), turn.sin(), 0.1) * (3.0 + f64::from(i % 40));
                let radius = 0.4 + f64::from(i % 7) * 0.3;
                let bounds = rays.bounds(middle, radius, 0.0);
                bounded += usize::from(bounds.is_some_and(|b| b[0].is_finite()));
                for j in 0..60 {
                    let (a, b) = (f64::from(j) * 0.9, f64::from(j) * 0.31);
                    let p = middle + DVec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * radius;
                    if let Some(px) = rays.seen_at(p, DVec3::ZERO) {
                        let [low, high] = bounds.unwrap_or_else(|| panic!("{middle} is seen at {px}"));
                        assert!(
                            px.cmpge(low).all() && px.cmple(high).all(),
                            "{px} beyond {low} {high}"
                        );
                    }
                }
            }
            assert!(bounded > 40, "{bounded}");
        }
    }
}
