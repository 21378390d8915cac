//! What a camera would see of a frame by day or night, in any weather: RGB pictures from occupancy,
//! layout and boxes, without any weights. Everything is computed in the world (hashes of places, never
//! of pixels), so neighbouring cameras and successive frames agree.

mod field;
mod ground;
mod material;
mod noise;
mod pack;
mod prepared;
mod probe;
mod render;
mod shade;
mod sky;
mod things;
mod truth;

pub use prepared::Appearance;
pub(crate) use probe::Probe;
pub use truth::NextMoment;

use glam::Vec3;

use scene::Conditions;

/// How much work goes into a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
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

/// Towards sun or moon under some conditions, a unit vector in the frame of the sensors' poses.
pub fn light_direction(conditions: &Conditions) -> Vec3 {
    sky::Air::new(conditions).to_sun
}

#[cfg(test)]
mod looks_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth_tests;
