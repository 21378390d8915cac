//! Objects as oriented boxes.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BoxLabel, Class};

/// Names a box; the same id in several frames is one track.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct BoxId(pub u32);

/// An upright box in the ego frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneBox {
    /// Its id within the scene.
    pub id: BoxId,
    /// One of [`Class::OBJECTS`].
    pub class: Class,
    /// Centre in the ego frame, m.
    pub center_m: DVec3,
    /// Length (along heading), width, height, m.
    pub size_m: DVec3,
    /// Heading, rad, counter-clockwise from ego x.
    pub yaw_rad: f64,
    /// Velocity over ground in the ego frame's axes, m/s.
    #[serde(default)]
    pub velocity_mps: DVec2,
    /// Name and paint. They change no voxel.
    #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
    pub label: BoxLabel,
}

impl SceneBox {
    /// Farthest from the origin that a box may stand, m.
    pub const LIMIT_M: f64 = 10_000.0;
    /// Largest edge that a box may have, m.
    pub const MAX_SIZE_M: f64 = 1000.0;

    /// Its name and paint in words; the class where it has no name.
    pub fn called(&self) -> String {
        self.label.called(&self.class.label())
    }

    /// The first problem with this box (class, finite numbers, positive size); `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let id = self.id.0;
        if !self.class.is_object() {
            return Some(format!(
                "box {id}: class is {:?}, expected one of the ten object classes",
                self.class.name()
            ));
        }
        let numbers = [
            ("center_m", self.center_m.to_array().to_vec()),
            ("size_m", self.size_m.to_array().to_vec()),
            ("yaw_rad", vec![self.yaw_rad]),
            ("velocity_mps", self.velocity_mps.to_array().to_vec()),
        ];
        for (field, values) in numbers {
            if values.iter().any(|v| !v.is_finite()) {
                return Some(format!(
                    "box {id}: {field} is {values:?}, expected finite numbers"
                ));
            }
        }
        let limit = Self::LIMIT_M;
        if self.center_m.abs().max_element() > limit {
            return Some(format!(
                "box {id}: center_m is {}, expected within {limit} m",
                self.center_m
            ));
        }
        if self.size_m.min_element() <= 0.0 || self.size_m.max_element() > Self::MAX_SIZE_M {
            return Some(format!(
                "box {id}: size_m is {}, expected above 0 and at most {} m",
                self.size_m,
                Self::MAX_SIZE_M
            ));
        }
        None
    }

    /// Unit vector of the heading on the ground; yaw is reduced in f64 first.
    pub fn heading(&self) -> DVec2 {
        DVec2::from_angle(self.yaw_rad.rem_euclid(std::f64::consts::TAU))
    }

    /// A point of the ego frame in box coordinates: x along the heading, y left, z up, origin at the centre.
    pub fn to_local(&self, p_in_ego: DVec3) -> DVec3 {
        let (h, d) = (self.heading(), p_in_ego - self.center_m);
        DVec3::new(d.x * h.x + d.y * h.y, d.y * h.x - d.x * h.y, d.z)
    }

    /// A point in box coordinates in the ego frame.
    pub fn to_ego(&self, p_local: DVec3) -> DVec3 {
        let h = self.heading();
        self.center_m
            + DVec3::new(
                p_local.x * h.x - p_local.y * h.y,
                p_local.x * h.y + p_local.y * h.x,
                p_local.z,
            )
    }

    /// True if the point lies in the box grown by `margin_m` on every side.
    pub fn contains(&self, p_in_ego: DVec3, margin_m: f64) -> bool {
        let reach = self.size_m / 2.0 + DVec3::splat(margin_m);
        self.to_local(p_in_ego).abs().cmple(reach).all()
    }

    /// Corners of the footprint, counter-clockwise from front left.
    pub fn footprint(&self) -> [DVec2; 4] {
        let (l, w) = (self.size_m.x / 2.0, self.size_m.y / 2.0);
        [(l, w), (-l, w), (-l, -w), (l, -w)].map(|(x, y)| self.to_ego(DVec3::new(x, y, 0.0)).truncate())
    }
}
