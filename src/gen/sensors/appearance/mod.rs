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
use rayon::prelude::*;

use scene::{Conditions, Frame, SensorRig};

/// How much work goes into a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
    /// One sample per pixel: live.
    Preview,
    /// Four samples wherever a pixel differs from its neighbours.
    #[default]
    Full,
}

/// Everything a picture is made from.
#[derive(Clone, Copy, Debug)]
pub struct SynthesisInput<'a> {
    /// Occupancy, layout, boxes and the pose in the world.
    pub frame: &'a Frame,
    /// Cameras, all synthesised together; the ego vehicle's size for its headlights.
    pub rig: &'a SensorRig,
    /// Size of each picture in px; 0 gives empty pictures.
    pub size: [u32; 2],
    /// Free text; learned models read all of it.
    pub prompt: &'a str,
    /// Light and air; they win over the prompt.
    pub conditions: Conditions,
    /// Speed or beauty.
    pub quality: Quality,
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

/// Why no picture came out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SynthesisError {
    /// A file of weights is missing or does not fit.
    #[error("weights of {model}: {problem}")]
    Weights {
        /// Which model.
        model: String,
        /// What is wrong.
        problem: String,
    },
    /// The input cannot be drawn.
    #[error("{0}")]
    Input(String),
}

/// Makes camera pictures of a frame. Implementations: [`RayMarched`], and image models with weights.
pub trait ViewSynthesizer: Send + Sync {
    /// What to call it.
    fn name(&self) -> &str;

    /// One picture per camera of the rig, in the rig's order. The same input gives the same pictures,
    /// whatever the number of threads.
    fn synthesize(&self, input: &SynthesisInput<'_>) -> Result<Vec<CameraImage>, SynthesisError>;
}

/// Towards sun or moon under some conditions, a unit vector in the frame of the sensors' poses.
pub fn light_direction(conditions: &Conditions) -> Vec3 {
    sky::Air::new(conditions).to_sun
}

/// The renderer of this module: ray marching on the CPU.
#[derive(Clone, Copy, Debug, Default)]
pub struct RayMarched;

impl ViewSynthesizer for RayMarched {
    fn name(&self) -> &str {
        "ray marched"
    }

    fn synthesize(&self, input: &SynthesisInput<'_>) -> Result<Vec<CameraImage>, SynthesisError> {
        let [w, h] = input.size;
        if u64::from(w) * u64::from(h) > 1 << 28 {
            return Err(SynthesisError::Input(format!(
                "a picture of {w}x{h} px is too large"
            )));
        }
        let appearance = Appearance::new(input.frame, input.rig, &input.conditions);
        let cameras = input.rig.cameras.par_iter();
        Ok(cameras
            .map(|c| appearance.render(c, w, h, input.quality))
            .collect())
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth_tests;
