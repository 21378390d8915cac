//! Sensors as data: cameras with intrinsics and mount, LiDARs as lists of elevations; radars are in `radar.rs`.

use glam::{DQuat, DVec3, EulerRot};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Lens, Optics, Pose, RadarPattern, Shutter};

/// A camera; optical axes x right, y down, z forward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Name, as in the data set: `CAM_FRONT`.
    pub name: String,
    /// Image size in pixels.
    pub width: u32,
    /// Image size in pixels.
    pub height: u32,
    /// Focal lengths in pixels.
    pub focal_px: [f64; 2],
    /// Principal point in pixels.
    pub center_px: [f64; 2],
    /// Optical frame to ego: quaternion w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Optical centre in the ego frame, m.
    pub translation_m: [f64; 3],
    /// How the lens bends rays.
    #[serde(default, skip_serializing_if = "is_pinhole")]
    pub lens: Lens,
    /// How the picture is read; all at one instant if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shutter: Option<Shutter>,
    /// How the vehicle carries it while the picture is read. Not in files.
    #[serde(skip)]
    pub carried: Carried,
}

/// Motion of a vehicle while a picture is read, in the frame of the sensors' poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried {
    /// Velocity of the vehicle's origin, m/s.
    pub velocity_mps: DVec3,
    /// Turn about the vertical through the vehicle's origin, rad/s.
    pub yaw_rate_rps: f64,
    /// The vehicle's origin, m.
    pub origin_m: DVec3,
}

impl Camera {
    /// Transform from the optical frame to the ego frame.
    pub fn ego_from_camera(&self) -> Pose {
        Pose::from_wxyz(self.rotation_wxyz, self.translation_m)
    }

    /// A level camera at the origin that looks ahead: 1600 x 900 pixels, `fov_deg` wide.
    pub fn new(name: &str, fov_deg: f64) -> Camera {
        let mut camera = Camera {
            name: name.into(),
            width: 1600,
            height: 900,
            focal_px: [1.0; 2],
            center_px: [800.0, 450.0],
            rotation_wxyz: [0.5, -0.5, 0.5, -0.5],
            translation_m: [0.0; 3],
            lens: Lens::Pinhole,
            shutter: None,
            carried: Carried::default(),
        };
        camera.set_fov_deg(fov_deg);
        camera
    }

    /// Horizontal field of view, degrees, as if the principal point were in the middle.
    pub fn fov_deg(&self) -> f64 {
        let middle = Camera {
            center_px: [f64::from(self.width) / 2.0, f64::from(self.height) / 2.0],
            ..self.clone()
        };
        let d = Optics::new(&middle).direction(f64::from(self.width), middle.center_px[1]);
        match self.lens {
            Lens::Fisheye { max_angle_deg, .. } | Lens::FTheta { max_angle_deg, .. } if d == DVec3::ZERO => {
                2.0 * max_angle_deg
            }
            _ => 2.0 * d.x.atan2(d.z).to_degrees(),
        }
    }

    /// Sets the horizontal field of view (held to 1 to 179 degrees, of wide lenses to 340 or twice the lens's largest angle);
    /// pixels keep their aspect.
    pub fn set_fov_deg(&mut self, fov_deg: f64) {
        let aspect = self.focal_px[1] / self.focal_px[0];
        let most = match self.lens {
            Lens::Fisheye { max_angle_deg, .. } | Lens::FTheta { max_angle_deg, .. } => {
                (2.0 * max_angle_deg).min(340.0)
            }
            Lens::Pinhole | Lens::Distorted { .. } => 179.0,
        };
        let half = (fov_deg.clamp(1.0, most) / 2.0).to_radians();
        let radius = Optics::new(self).radius_at(half);
        let focal = f64::from(self.width) / 2.0 / if radius > 1e-6 { radius } else { half.tan() };
        self.focal_px = [focal, focal * if aspect.is_finite() { aspect } else { 1.0 }];
    }

    /// Direction of the camera.
    pub fn aim(&self) -> Aim {
        Aim::from_rotation(self.ego_from_camera().rotation * BODY_FROM_OPTICAL.inverse())
    }

    /// Turns the camera.
    pub fn set_aim(&mut self, aim: Aim) {
        let q = aim.rotation() * BODY_FROM_OPTICAL;
        self.rotation_wxyz = [q.w, q.x, q.y, q.z];
    }

    /// The camera at another image size; the focal length and centre scale with each axis.
    pub fn resized(&self, width: u32, height: u32) -> Camera {
        let (sx, sy) = (
            f64::from(width) / f64::from(self.width),
            f64::from(height) / f64::from(self.height),
        );
        Camera {
            width,
            height,
            focal_px: [self.focal_px[0] * sx, self.focal_px[1] * sy],
            center_px: [self.center_px[0] * sx, self.center_px[1] * sy],
            ..self.clone()
        }
    }
}

/// Optical axes (x right, y down, z forward) to body axes (x forward, y left, z up).
const BODY_FROM_OPTICAL: DQuat = DQuat::from_xyzw(-0.5, 0.5, -0.5, 0.5);

/// The direction of a sensor's body (x forward, y left, z up) in the ego frame: turned about z by yaw, then raised by
/// pitch, then rolled about its own axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Angle from straight ahead, counter-clockwise, degrees.
    pub yaw_deg: f64,
    /// Angle upward, degrees.
    pub pitch_deg: f64,
    /// Roll, clockwise as the sensor sees it, degrees.
    pub roll_deg: f64,
}

impl Aim {
    /// The angles of a rotation from body to ego.
    pub fn from_rotation(rotation: DQuat) -> Aim {
        let (yaw, down, roll) = rotation.normalize().to_euler(EulerRot::ZYX);
        // Adding 0 turns -0 into 0.
        let tidy = |v: f64| (v.to_degrees() * 1e6).round() / 1e6 + 0.0;
        Aim {
            yaw_deg: tidy(yaw),
            pitch_deg: tidy(-down),
            roll_deg: tidy(roll),
        }
    }

    /// Rotation from body to ego.
    pub fn rotation(&self) -> DQuat {
        let [yaw, pitch, roll] = [self.yaw_deg, self.pitch_deg, self.roll_deg].map(f64::to_radians);
        DQuat::from_euler(EulerRot::ZYX, yaw, -pitch, roll)
    }
}

/// How a spinning LiDAR samples directions and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LidarPattern {
    /// Name, as in the data set: `LIDAR_TOP`.
    pub name: String,
    /// Elevation of each beam in degrees, lowest first; ring i is entry i.
    pub elevations_deg: Vec<f64>,
    /// Columns per revolution; column i looks at azimuth first + 2 pi i / n in the sensor frame.
    pub columns: u32,
    /// Azimuth of column 0 in the sensor frame, degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub first_azimuth_deg: f64,
    /// Sector that returns anything, degrees from the first azimuth; 360 is all round.
    #[serde(default = "full_turn", skip_serializing_if = "is_full_turn")]
    pub sector_deg: f64,
    /// Columns follow each other clockwise, seen from above.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clockwise: bool,
    /// Revolutions per second; 0 = the whole sweep at one instant. Otherwise column i is fired when the vehicle
    /// was (1 - i / n) of a revolution short of where it stands (see [`SensorRig::ego_speed_mps`]).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub spin_hz: f64,
    /// Farthest return, m.
    pub max_range_m: f64,
    /// Nearest return, m.
    pub min_range_m: f64,
    /// The own vehicle's roof is in the way of a sensor above it and sends pulses back, as in real sweeps; else it is
    /// looked through.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub own_body: bool,
    /// Pulses that leave the grid meet a continuation of the scene: roads, houses, trees.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub beyond_grid: bool,
    /// Sensor frame to ego: quaternion w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Origin in the ego frame, m.
    pub translation_m: [f64; 3],
    /// A part of the revolution: its first column and how many. Not in files.
    #[serde(skip)]
    pub part: Option<[u32; 2]>,
}

impl LidarPattern {
    /// Transform from the sensor frame to the ego frame.
    pub fn ego_from_sensor(&self) -> Pose {
        Pose::from_wxyz(self.rotation_wxyz, self.translation_m)
    }

    /// Direction of its x axis.
    pub fn aim(&self) -> Aim {
        Aim::from_rotation(self.ego_from_sensor().rotation)
    }

    /// Turns the sensor.
    pub fn set_aim(&mut self, aim: Aim) {
        let q = aim.rotation();
        self.rotation_wxyz = [q.w, q.x, q.y, q.z];
    }

    /// The LiDAR limited to `count` columns from `first` on. They become its columns 0 to `count`, and its sweep ends
    /// right after the last of them.
    pub fn part(&self, first: u32, count: u32) -> LidarPattern {
        LidarPattern {
            part: Some([first, count]),
            ..self.clone()
        }
    }

    /// Number of columns that return anything: those in the sector, or in the part of the revolution.
    pub fn columns_in_sector(&self) -> u32 {
        if let Some([_, count]) = self.part {
            return count;
        }
        let share = (self.sector_deg / 360.0).clamp(0.0, 1.0);
        // Slightly less than the product, so that a third of 1080 columns is 360 and not 361.
        (f64::from(self.columns) * share - 1e-6).ceil().max(0.0) as u32
    }

    /// Azimuth of a column in the sensor frame, rad. Formed in f64 from the index, so the last column of a full turn
    /// and the first are one step apart like any other two.
    pub fn azimuth_rad(&self, column: u32) -> f64 {
        let column = self.part.map_or(0, |[first, _]| first) + column;
        let turn = std::f64::consts::TAU * f64::from(column) / f64::from(self.columns.max(1));
        self.first_azimuth_deg.to_radians() + if self.clockwise { -turn } else { turn }
    }

    /// Time before the end of the sweep at which a column is fired, s; 0 where the whole sweep is one instant.
    pub fn before_end_s(&self, column: u32) -> f64 {
        let all = self.part.map_or(self.columns, |[_, count]| count);
        match self.spin_hz > 0.0 {
            true => (f64::from(all) - f64::from(column)) / f64::from(self.columns.max(1)) / self.spin_hz,
            false => 0.0,
        }
    }

    /// Rays per revolution.
    pub fn rays(&self) -> usize {
        self.elevations_deg.len() * self.columns_in_sector() as usize
    }
}

fn is_pinhole(lens: &Lens) -> bool {
    *lens == Lens::Pinhole
}

fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

fn yes() -> bool {
    true
}

fn is_yes(v: &bool) -> bool {
    *v
}

fn full_turn() -> f64 {
    360.0
}

fn is_full_turn(v: &f64) -> bool {
    *v == 360.0
}

/// All sensors of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorRig {
    /// Name of the rig.
    pub name: String,
    /// Cameras, in any order; bundled rigs have them clockwise from above, beginning on the left.
    pub cameras: Vec<Camera>,
    /// LiDARs; the first one is the default.
    pub lidars: Vec<LidarPattern>,
    /// Radars, in any order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub radars: Vec<RadarPattern>,
    /// Length, width, height of the ego vehicle, m; its rear axle is the origin.
    pub ego_size_m: [f64; 3],
    /// From the rear axle to the middle of the ego vehicle, m.
    pub ego_center_m: [f64; 3],
    /// Forward speed while a LiDAR spins and a radar measures, m/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub ego_speed_mps: f64,
    /// Where the vehicle is in the frame that the sensors' poses are given in: the ego frame itself, unless the rig was
    /// placed somewhere. Not in files.
    #[serde(skip)]
    pub vehicle: Pose,
}

impl SensorRig {
    /// The sensors with their vehicle moved to a pose, wherever it stood before; their poses are in the outer frame of
    /// that pose. A second call with the same pose changes nothing: poses are not applied on top of each other.
    pub fn standing_at(&self, vehicle: &Pose) -> SensorRig {
        let mut out = self.clone();
        if self.vehicle == *vehicle {
            return out;
        }
        let moved = match self.vehicle == Pose::IDENTITY {
            true => *vehicle,
            false => *vehicle * self.vehicle.inverse(),
        };
        let place = |rotation_wxyz: &mut [f64; 4], translation_m: &mut [f64; 3]| {
            let pose = moved * Pose::from_wxyz(*rotation_wxyz, *translation_m);
            let q = pose.rotation;
            (*rotation_wxyz, *translation_m) = ([q.w, q.x, q.y, q.z], pose.translation_m.to_array());
        };
        for camera in &mut out.cameras {
            place(&mut camera.rotation_wxyz, &mut camera.translation_m);
        }
        for lidar in &mut out.lidars {
            place(&mut lidar.rotation_wxyz, &mut lidar.translation_m);
        }
        for radar in &mut out.radars {
            place(&mut radar.rotation_wxyz, &mut radar.translation_m);
        }
        out.vehicle = *vehicle;
        out
    }

    /// The rig with the vehicle's motion set in the cameras that have a rolling shutter; `yaw_rate_rps` is its turn
    /// rate to the left, rad/s.
    pub fn carried(mut self, yaw_rate_rps: f64) -> SensorRig {
        let carried = Carried {
            velocity_mps: self.velocity_mps(),
            yaw_rate_rps,
            origin_m: self.vehicle.translation_m,
        };
        for camera in self.cameras.iter_mut().filter(|c| c.shutter.is_some()) {
            camera.carried = carried;
        }
        self
    }

    /// Velocity of the vehicle while a LiDAR spins, in the frame of the sensors' poses, m/s.
    pub fn velocity_mps(&self) -> glam::DVec3 {
        match self.vehicle == Pose::IDENTITY {
            true => glam::DVec3::X * self.ego_speed_mps,
            false => self.vehicle.rotation * glam::DVec3::X * self.ego_speed_mps,
        }
    }

    /// Most cameras, most LiDARs and most radars.
    pub const MOST_SENSORS: usize = 64;
    /// Most rays of a LiDAR: several times as many as the densest model has.
    pub const MOST_RAYS: usize = 4 << 20;

    /// The first problem with this rig (names, finite numbers, sizes, focal lengths, angles, numbers of sensors and
    /// rays); `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let counts = [self.cameras.len(), self.lidars.len(), self.radars.len()];
        if counts.iter().any(|count| *count > Self::MOST_SENSORS) {
            let [cameras, lidars, radars] = counts;
            return Some(format!(
                "{cameras} cameras, {lidars} lidars and {radars} radars, expected at most {} each",
                Self::MOST_SENSORS
            ));
        }
        if let Some(problem) = self.names_problem() {
            return Some(problem);
        }
        for c in &self.cameras {
            let numbers = [&c.focal_px[..], &c.center_px, &c.rotation_wxyz, &c.translation_m].concat();
            if numbers.iter().any(|v| !v.is_finite()) {
                return Some(format!("camera {}: a number is not finite", c.name));
            }
            if !(1..=16384).contains(&c.width) || !(1..=16384).contains(&c.height) {
                return Some(format!(
                    "camera {}: size is {}x{}, expected 1 to 16384",
                    c.name, c.width, c.height
                ));
            }
            if let Some(problem) = c.lens.problem() {
                return Some(format!("camera {}: {problem}", c.name));
            }
            if let Some(shutter) = c.shutter
                && !(0.0..=Shutter::MAX_READOUT_S).contains(&shutter.readout_s)
            {
                return Some(format!(
                    "camera {}: readout_s is {}, expected 0 to {}",
                    c.name,
                    shutter.readout_s,
                    Shutter::MAX_READOUT_S
                ));
            }
            if c.focal_px.iter().any(|f| *f <= 0.0) {
                return Some(format!(
                    "camera {}: focal_px is {:?}, expected above 0",
                    c.name, c.focal_px
                ));
            }
            if !is_rotation(&c.rotation_wxyz) {
                return Some(format!("camera {}: rotation_wxyz is zero or huge", c.name));
            }
        }
        for l in &self.lidars {
            let mut numbers = [&l.rotation_wxyz[..], &l.translation_m, &l.elevations_deg].concat();
            numbers.extend([
                l.max_range_m,
                l.min_range_m,
                l.first_azimuth_deg,
                l.sector_deg,
                l.spin_hz,
            ]);
            if numbers.iter().any(|v| !v.is_finite()) {
                return Some(format!("lidar {}: a number is not finite", l.name));
            }
            if !(1..=65535).contains(&l.columns) || !(1..=1024).contains(&l.elevations_deg.len()) {
                return Some(format!(
                    "lidar {}: {} beams and {} columns, expected 1 to 1024 and 1 to 65535",
                    l.name,
                    l.elevations_deg.len(),
                    l.columns
                ));
            }
            if l.elevations_deg.iter().any(|e| e.abs() > 90.0) {
                return Some(format!("lidar {}: an elevation is beyond 90 degrees", l.name));
            }
            if !(0.0..=360.0).contains(&l.sector_deg) || !(0.0..=1000.0).contains(&l.spin_hz) {
                return Some(format!(
                    "lidar {}: sector_deg is {}, spin_hz {}, expected 0 to 360 and 0 to 1000",
                    l.name, l.sector_deg, l.spin_hz
                ));
            }
            if !is_rotation(&l.rotation_wxyz) {
                return Some(format!("lidar {}: rotation_wxyz is zero or huge", l.name));
            }
            if l.rays() > Self::MOST_RAYS {
                return Some(format!(
                    "lidar {}: {} rays, expected at most {}",
                    l.name,
                    l.rays(),
                    Self::MOST_RAYS
                ));
            }
        }
        if let Some(problem) = self.radars.iter().find_map(RadarPattern::problem) {
            return Some(problem);
        }
        let ego = [&self.ego_size_m[..], &self.ego_center_m, &[self.ego_speed_mps]].concat();
        if ego.iter().any(|v| !v.is_finite()) || self.ego_speed_mps.abs() > 200.0 {
            return Some(
                "the ego vehicle's size, place and speed are not finite, or it is faster than 200 m/s".into(),
            );
        }
        None
    }
}

/// True if a quaternion can be normalised.
fn is_rotation(q: &[f64; 4]) -> bool {
    let norm = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    (1e-6..1e6).contains(&norm)
}

impl Default for SensorRig {
    /// The nuScenes vehicle: six cameras and a 32-beam LiDAR (published calibration), five radars about where they are there.
    fn default() -> Self {
        serde_json::from_str(assets::rigs::NUSCENES).expect("the bundled rig is checked by a test")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundled_rig_is_sound() {
        let rig = SensorRig::default();
        assert_eq!(rig.problem(), None);
        assert_eq!(rig.cameras.len(), 6);
        assert_eq!(rig.lidars[0].elevations_deg.len(), 32);
        let forward = rig.cameras[1].ego_from_camera().rotation * glam::DVec3::Z;
        assert!(forward.x > 0.99, "front camera looks along ego x, got {forward}");
    }

    #[test]
    fn aims_and_fields_of_view_come_back() {
        for camera in &mut SensorRig::default().cameras {
            let (before, aim) = (camera.ego_from_camera().rotation, camera.aim());
            assert!(
                aim.pitch_deg.abs() < 3.0 && aim.roll_deg.abs() < 3.0,
                "{}: {aim:?}",
                camera.name
            );
            camera.set_aim(aim);
            assert!(before.angle_between(camera.ego_from_camera().rotation) < 1e-6);
            let (fov_deg, focal_px) = (camera.fov_deg(), camera.focal_px);
            camera.set_fov_deg(fov_deg);
            assert!((camera.focal_px[1] - focal_px[1]).abs() < 1e-9 * focal_px[1]);
        }
        let mut camera = Camera::new("CAM", 90.0);
        assert!((camera.focal_px[0] - 800.0).abs() < 1e-9);
        let forward = |c: &Camera| c.ego_from_camera().rotation * glam::DVec3::Z;
        assert!(forward(&camera).distance(glam::DVec3::X) < 1e-12);
        camera.set_aim(Aim {
            yaw_deg: 90.0,
            pitch_deg: 30.0,
            roll_deg: 0.0,
        });
        let up = glam::DVec3::new(0.0, 0.75f64.sqrt(), 0.5);
        assert!(
            forward(&camera).distance(up) < 1e-12,
            "left and 30 degrees up: {}",
            forward(&camera)
        );
        camera.set_aim(Aim {
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            roll_deg: 90.0,
        });
        // Rolled clockwise by a quarter, what was its right side is below.
        let right = camera.ego_from_camera().rotation * glam::DVec3::X;
        assert!(right.distance(-glam::DVec3::Z) < 1e-12, "{right}");
        camera.set_fov_deg(f64::NAN);
    }

    #[test]
    fn problems_are_named() {
        let mut rig = SensorRig::default();
        rig.cameras[0].focal_px[0] = f64::NAN;
        assert!(rig.problem().expect("NaN").contains("CAM_FRONT_LEFT"));
        let mut rig = SensorRig::default();
        rig.lidars[0].elevations_deg.clear();
        assert!(rig.problem().expect("no beams").contains("LIDAR_TOP"));
    }
}
