//! Strength with which Gaussians would answer a LiDAR's pulse.

use glam::Vec3;

use super::samples::SampleGroup;
use crate::lidar::material::{Materials, PulseHit};
use scene::Class;
use scene::truth::{self, TruthClass};
use world::SurfacePoint;

/// Echo of paint on the road, as in [`Materials::of`].
const PAINT: f32 = 34.0;
/// Distance for which strengths are given, m.
const RANGE_M: f64 = 10.0;
/// Middle value for detail that is finer than a surface.
const DETAIL: f64 = 0.5;

/// Strengths of the materials of an ordinary, dry scene.
pub(super) struct Strengths(Materials<'static>);

impl Strengths {
    pub fn new() -> Self {
        Self(Materials::ordinary(0))
    }

    /// Strength of the echo at normal incidence from 10 m, 0 to 255; 0 for sky and skyline.
    pub fn of(&self, group: &SampleGroup, at: Vec3, normal: Vec3) -> f32 {
        if group.is_skyline {
            return 0.0;
        }
        let Some(class) = class_of(group.class) else {
            return PAINT;
        };
        let surface = SurfacePoint {
            normal: normal.as_dvec3(),
            instance: group.instance,
            part: 0,
        };
        let met = PulseHit {
            class,
            surface: &surface,
            solid: None,
            at: at.as_dvec3(),
            range_m: RANGE_M,
            cosine: 1.0,
        };
        let material = self.0.of(&met, DETAIL);
        self.0.strength(&material, 1.0, 0.0) as f32
    }
}

/// The class of a surface; `None` for paint on the road.
fn class_of(class: TruthClass) -> Option<Class> {
    match class {
        17..=19 | truth::STOP_LINE => None,
        truth::OTHERS => Some(Class::Others),
        id => Some(Class::from_id(id).unwrap_or(Class::Others)),
    }
}
