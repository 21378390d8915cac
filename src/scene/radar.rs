//! Radars as data: what they see and how finely, and what they measure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rig::Aim;
use super::{Class, Pose};

/// A part of a radar's field of view, and how finely it tells targets apart there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RadarField {
    /// Largest azimuth to either side, degrees.
    pub half_azimuth_deg: f64,
    /// Farthest return, m.
    pub max_range_m: f64,
    /// Difference of range at which two targets are two, m.
    pub range_step_m: f64,
    /// Difference of azimuth at which two targets are two, degrees.
    pub azimuth_step_deg: f64,
}

/// How a radar looks around, and where it is mounted. The frame of the sensor has x ahead, y left, z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RadarPattern {
    /// Name, as in the data set: `RADAR_FRONT`.
    pub name: String,
    /// Parts of the field of view; where several hold a target, the first counts.
    pub fields: Vec<RadarField>,
    /// Elevation at which the antenna's gain has fallen to a half, degrees.
    pub half_elevation_deg: f64,
    /// Difference of elevation at which two targets are two, degrees; 0 for a radar that measures no heights.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elevation_step_deg: f64,
    /// Nearest return, m.
    pub min_range_m: f64,
    /// Difference of radial speed at which two targets are two, m/s.
    pub speed_step_mps: f64,
    /// Lowest and highest radial speed that is measured without doubt, m/s; others come back a whole span away.
    pub speeds_mps: [f64; 2],
    /// Distance at which a target of 10 m² is found in one of two scans, m.
    pub car_range_m: f64,
    /// Most returns of a scan; the strongest are kept.
    pub most_returns: u32,
    /// Scans per second.
    pub scan_hz: f64,
    /// Sensor frame to ego: quaternion w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Origin in the ego frame, m.
    pub translation_m: [f64; 3],
}

impl RadarPattern {
    /// Most parts of a field of view.
    pub const MOST_FIELDS: usize = 8;
    /// Farthest range, m.
    pub const FARTHEST_M: f64 = 1000.0;

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

    /// Largest azimuth to either side, degrees.
    pub fn half_azimuth_deg(&self) -> f64 {
        self.fields.iter().map(|f| f.half_azimuth_deg).fold(0.0, f64::max)
    }

    /// Farthest return, m.
    pub fn max_range_m(&self) -> f64 {
        self.fields.iter().map(|f| f.max_range_m).fold(0.0, f64::max)
    }

    /// The part of the field of view that holds a target, by its index.
    pub fn field_at(&self, azimuth_deg: f64, range_m: f64) -> Option<usize> {
        let holds = |f: &RadarField| azimuth_deg.abs() <= f.half_azimuth_deg && range_m <= f.max_range_m;
        self.fields.iter().position(holds)
    }

    /// A radial speed as it is measured: those out of the span come back a whole number of spans away.
    pub fn measured_speed_mps(&self, speed_mps: f64) -> f64 {
        let [low, high] = self.speeds_mps;
        low + (speed_mps - low).rem_euclid(high - low)
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let name = &self.name;
        let [low, high] = self.speeds_mps;
        let mut numbers = [&self.rotation_wxyz[..], &self.translation_m, &self.speeds_mps].concat();
        numbers.extend([
            self.half_elevation_deg,
            self.elevation_step_deg,
            self.min_range_m,
            self.speed_step_mps,
            self.car_range_m,
            self.scan_hz,
        ]);
        let of_field = |f: &RadarField| {
            [
                f.half_azimuth_deg,
                f.max_range_m,
                f.range_step_m,
                f.azimuth_step_deg,
            ]
        };
        numbers.extend(self.fields.iter().flat_map(of_field));
        if numbers.iter().any(|v| !v.is_finite()) {
            return Some(format!("radar {name}: a number is not finite"));
        }
        if !(1..=Self::MOST_FIELDS).contains(&self.fields.len()) {
            let most = Self::MOST_FIELDS;
            return Some(format!(
                "radar {name}: {} fields, expected 1 to {most}",
                self.fields.len()
            ));
        }
        for f in &self.fields {
            let sound = (0.1..=180.0).contains(&f.half_azimuth_deg)
                && (1.0..=Self::FARTHEST_M).contains(&f.max_range_m)
                && (0.01..=100.0).contains(&f.range_step_m)
                && (0.01..=90.0).contains(&f.azimuth_step_deg);
            if !sound {
                return Some(format!(
                    "radar {name}: a field of {} degrees to {} m in steps of {} degrees and {} m, expected 0.1 to 180 degrees to 1 to {} m in steps of 0.01 to 90 degrees and 0.01 to 100 m",
                    f.half_azimuth_deg,
                    f.max_range_m,
                    f.azimuth_step_deg,
                    f.range_step_m,
                    Self::FARTHEST_M
                ));
            }
        }
        let most_range_m = self.max_range_m();
        let ranges = [
            ("half_elevation_deg", self.half_elevation_deg, 0.1, 90.0),
            ("elevation_step_deg", self.elevation_step_deg, 0.0, 90.0),
            ("min_range_m", self.min_range_m, 0.0, most_range_m),
            ("speed_step_mps", self.speed_step_mps, 0.001, 100.0),
            ("car_range_m", self.car_range_m, 0.1, 10_000.0),
            ("most_returns", f64::from(self.most_returns), 1.0, 65_536.0),
            ("scan_hz", self.scan_hz, 0.1, 1000.0),
        ];
        for (field, found, least, most) in ranges {
            if !(least..=most).contains(&found) {
                return Some(format!(
                    "radar {name}: {field} is {found}, expected {least} to {most}"
                ));
            }
        }
        if self.elevation_step_deg > 0.0 && self.elevation_step_deg < 0.01 {
            return Some(format!(
                "radar {name}: elevation_step_deg is {}, expected 0 or 0.01 and more",
                self.elevation_step_deg
            ));
        }
        if low < -1000.0 || high > 1000.0 || high - low < self.speed_step_mps {
            return Some(format!(
                "radar {name}: speeds_mps is {low} to {high}, expected a span of a step and more within 1000 m/s"
            ));
        }
        let norm = self.rotation_wxyz.iter().map(|v| v * v).sum::<f64>().sqrt();
        if !(1e-6..1e6).contains(&norm) {
            return Some(format!("radar {name}: rotation_wxyz is zero or huge"));
        }
        None
    }
}

fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

/// One return of a radar: the peak of a cell of range, azimuth and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadarReturn {
    /// Position in the frame of the rig's poses, m. A radar that measures no heights puts it into its own plane.
    pub position_m: [f32; 3],
    /// Distance from the sensor, m.
    pub range_m: f32,
    /// Azimuth in the sensor frame, rad, counter-clockwise from straight ahead.
    pub azimuth_rad: f32,
    /// Elevation in the sensor frame, rad; `None` for a radar that measures no heights.
    pub elevation_rad: Option<f32>,
    /// Doppler: speed at which the distance grows, m/s.
    pub speed_mps: f32,
    /// That speed without the motion of the own vehicle, m/s.
    pub speed_over_ground_mps: f32,
    /// Radar cross-section, dB above 1 m².
    pub rcs_dbsm: f32,
    /// Strength of the echo above the noise, dB.
    pub snr_db: f32,
    /// Class of what gave most of the echo.
    pub class: Class,
}

/// One scan of a radar, at one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RadarScan {
    /// Name of the radar in the rig.
    pub radar: String,
    /// Returns, strongest echo first.
    pub returns: Vec<RadarReturn>,
}

impl RadarScan {
    /// Gives the positions in another frame.
    pub fn place(&mut self, to_from_here: &Pose) {
        if *to_from_here == Pose::IDENTITY {
            return;
        }
        for one in &mut self.returns {
            let p = glam::DVec3::from_array(one.position_m.map(f64::from));
            one.position_m = to_from_here.apply(p).as_vec3().to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig_presets::RADARS;

    #[test]
    fn speeds_fold_and_fields_are_found_in_order() {
        let radar = (RADARS[0].build)();
        assert_eq!(radar.problem(), None);
        let [low, high] = radar.speeds_mps;
        for speed in [low, 0.0, -12.5, high - 0.1] {
            assert!((radar.measured_speed_mps(speed) - speed).abs() < 1e-9);
        }
        assert!((radar.measured_speed_mps(high + 3.0) - (low + 3.0)).abs() < 1e-9);
        let near = radar.field_at(40.0, 30.0).expect("near");
        let far = radar.field_at(-3.0, 200.0).expect("far");
        assert!(near != far && radar.field_at(40.0, 200.0).is_none());
        assert!(radar.field_at(f64::NAN, 10.0).is_none());
    }

    #[test]
    fn what_is_no_radar_is_refused_in_one_line() {
        let spoiled: [fn(&mut RadarPattern); 10] = [
            |r| r.fields.clear(),
            |r| r.fields = vec![r.fields[0]; 9],
            |r| r.fields[0].max_range_m = f64::INFINITY,
            |r| r.fields[0].range_step_m = 0.0,
            |r| r.speeds_mps = [1.0, 1.0],
            |r| r.speeds_mps = [f64::NAN, 1.0],
            |r| r.rotation_wxyz = [0.0; 4],
            |r| r.most_returns = 0,
            |r| r.elevation_step_deg = 1e-9,
            |r| r.min_range_m = 300.0,
        ];
        for spoil in spoiled {
            let mut radar = (RADARS[0].build)();
            spoil(&mut radar);
            let problem = radar.problem().expect("no radar");
            assert!(
                problem.starts_with("radar ") && problem.lines().count() == 1,
                "{problem}"
            );
        }
    }
}
