//! The returns of a sweep without labels as they come, for a network that finds objects in it.

use std::sync::Arc;

use glam::DVec3;
use scene::{Pose, SensorRig};

use super::level::{GroundPlane, HIGHEST_MOUNT_M};
use crate::import::ImportedSweep;
use crate::import::drive::survey::{PlacedSurvey, Survey, SurveyedDrive};

/// Returns of a sweep at most: a larger cloud is a map of many.
pub(super) const MOST: usize = 600_000;
/// Greatest strength of an echo of sensors that tell it as a share, and of others.
const SHARE: f32 = 1.0;
const STRONGEST: f32 = 255.0;

/// Returns as they come.
#[derive(Default)]
pub(super) struct SweepReturns {
    returns: Vec<([f32; 3], f32)>,
    /// Where the sensor is, m; `None` if the points do not tell.
    pub(super) sensor_m: Option<DVec3>,
    /// The ground around it, if the returns show it.
    pub(super) ground: Option<GroundPlane>,
    /// Pose of the file's frame in the ego frame before the points were leveled.
    pub(super) ego_from_file: Pose,
    /// The points are a map.
    pub(super) is_map: bool,
}

impl SweepReturns {
    /// Takes a return, in m in the ego frame, and the strength of its echo.
    pub(super) fn add(&mut self, at: DVec3, strength: f32) {
        if self.returns.len() <= MOST {
            self.returns.push((at.as_vec3().to_array(), strength));
        }
    }

    fn is_unlabelled(&self) -> bool {
        !self.returns.is_empty()
    }

    /// Finds the ground of returns that were lifted by hand; the sensor was at their origin if nothing else is known.
    pub(super) fn find_ground(&mut self, lift_m: f64) {
        self.ground = GroundPlane::from_points(self.returns.iter().map(|(at, _)| place(*at)));
        let is_mount = lift_m > 0.0 && lift_m <= HIGHEST_MOUNT_M;
        let is_below = self.ground.is_some_and(GroundPlane::is_below_a_sensor);
        let at = self.sensor_m.or((is_mount || is_below).then_some(DVec3::ZERO));
        self.sensor_m = at.map(|at| at + DVec3::Z * lift_m);
    }

    /// The sweep, of points that were moved by `level`; `None` for maps. Without returns if there are too many, or if their
    /// ground is not known.
    pub(super) fn finished(self, level: &Pose) -> Option<ImportedSweep> {
        if self.is_map {
            return None;
        }
        let usual_m = SensorRig::default()
            .lidars
            .first()
            .map_or([0.0; 3], |lidar| lidar.translation_m);
        let world_from_file = *level * self.ego_from_file;
        let Some(ground) = self.ground.filter(|_| self.returns.len() <= MOST) else {
            return Some(ImportedSweep::without_returns(
                world_from_file,
                match self.is_unlabelled() {
                    // Nothing tells of a vehicle: the origin of the file is that of its sensor.
                    true => self.sensor_m.unwrap_or(world_from_file.translation_m),
                    false => self.sensor_m.unwrap_or(DVec3::from_array(usual_m)),
                },
            ));
        };
        let scale = strength_scale(self.returns.iter().map(|r| r.1));
        let above = |(at, strength): ([f32; 3], f32)| {
            let strength = if strength.is_finite() {
                strength * scale
            } else {
                0.0
            };
            let height_m = ground.above_m(place(at)) as f32;
            [at[0], at[1], height_m, strength.clamp(0.0, STRONGEST)]
        };
        let seen_from = self
            .sensor_m
            .map_or(DVec3::from_array(usual_m), |at| at.with_z(ground.above_m(at)));
        // One sweep is a drive of one moment.
        let sensor_m = self.sensor_m.unwrap_or(DVec3::from_array(usual_m));
        let survey = Survey::new(self.returns.iter().map(|(at, _)| place(*at) - sensor_m));
        let world_from_sensor = Pose {
            translation_m: sensor_m,
            ..Pose::IDENTITY
        };
        let placed = PlacedSurvey::of_ground(survey, world_from_sensor, ground.height_m, ground.slope);
        Some(ImportedSweep {
            drive: Some(Arc::new(SurveyedDrive::new(vec![placed]))),
            returns: self.returns.into_iter().map(above).collect(),
            sensor_m: seen_from,
            mount_m: self.sensor_m,
            world_from_file,
            files: Vec::new(),
        })
    }
}

fn place(at: [f32; 3]) -> DVec3 {
    DVec3::from_array(at.map(f64::from))
}

/// Factor that takes strengths of any sensor to 0 to 255: by a high quantile, as single ones are wild.
pub(crate) fn strength_scale(strengths: impl Iterator<Item = f32>) -> f32 {
    let mut known: Vec<f32> = strengths.filter(|s| s.is_finite() && *s > 0.0).collect();
    known.sort_unstable_by(f32::total_cmp);
    match known.get(known.len() * 99 / 100).copied() {
        Some(high) if high <= SHARE => STRONGEST,
        Some(high) if high > STRONGEST => STRONGEST / high,
        _ => 1.0,
    }
}
