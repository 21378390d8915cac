//! The analytic renderer: RGB pictures that a camera would take of a frame by day or night, in any weather, from
//! occupancy, layout and boxes, without any weights. Everything is computed in the world (hashes of places, never of
//! pixels), so neighbouring cameras and successive frames agree.

mod field;
mod ground;
mod material;
mod noise;
mod pack;
mod prepared;
mod probe;
mod relief;
mod render;
mod scenery;
mod shade;
mod sky;
mod sparse;
mod still;
mod things;
mod truth;

pub use prepared::Appearance;
pub(crate) use probe::Probe;
pub use still::AppearanceCache;
pub use truth::NextMoment;

use glam::Vec3;

use scene::Conditions;

/// Effort for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
    /// Every second pixel; those between take the mean of their neighbours where these show the same. For clips that play.
    Play,
    /// One sample per pixel: live.
    Preview,
    /// Four samples wherever a pixel differs from its neighbours.
    #[default]
    Full,
}

/// A picture of one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraImage {
    /// Name of the camera in the rig.
    pub camera: String,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// sRGB and an opaque alpha, 4 bytes per pixel, row-major, top row first.
    pub rgba: Vec<u8>,
}

/// Direction to the sun or the moon under some conditions, a unit vector in the frame of the sensors' poses.
pub fn light_direction(conditions: &Conditions) -> Vec3 {
    sky::Air::new(conditions).to_sun
}

#[cfg(test)]
mod looks_tests;
#[cfg(test)]
mod still_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth_tests;
