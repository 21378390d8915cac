//! Labelled Gaussians and the constants for drawing them: the data that the renderers on the processor and on the
//! graphics card share.

use super::sensor_data::{CameraMaps, RenderId};

/// An isotropic Gaussian with a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Centre in the ego frame, m.
    pub position_m: [f32; 3],
    /// Standard deviation, m.
    pub std_m: f32,
    /// Alpha at the centre; held to 0..1, NaN draws nothing.
    pub opacity: f32,
    /// Label that it shows; ids from 20 on draw nothing.
    pub id: RenderId,
}

/// Constants of the renderer; the default is the papers' (and the reference data's).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatOptions {
    /// Gaussians whose centre is not beyond this depth are dropped, m. The rasteriser behind the
    /// papers uses 0.2 whatever its caller asks for.
    pub near_m: f64,
    /// Gaussians beyond this depth are dropped, m.
    pub far_m: f64,
    /// Added to the variance along both image axes, px^2.
    pub low_pass_px2: f64,
    /// Largest alpha of one splat, at most 0.999.
    pub alpha_max: f32,
    /// Alphas below this are skipped.
    pub alpha_min: f32,
    /// A pixel with less light left takes no more splats.
    pub t_stop: f32,
    /// Farthest distance from the axis at which the Jacobian is taken, in units of half the image.
    pub jacobian_clamp: f64,
    /// Multiply opacity by sqrt(det / det'), so that a splat far below a pixel does
    /// not gain weight (Mip-Splatting, arXiv 2311.16493).
    pub compensate_opacity: bool,
    /// [`CameraMaps::semantic`] is 0 where coverage is below this. 0.10 in the paper.
    pub min_coverage: f32,
}

impl Default for SplatOptions {
    fn default() -> Self {
        Self {
            near_m: 0.2,
            far_m: 200.0,
            low_pass_px2: 0.3,
            alpha_max: 0.99,
            alpha_min: 1.0 / 255.0,
            t_stop: 1e-4,
            jacobian_clamp: 1.3,
            compensate_opacity: false,
            min_coverage: 0.10,
        }
    }
}

/// Least coverage at which a normalised depth is meaningful.
pub const MIN_DEPTH_COVERAGE: f32 = 1e-3;

/// Maps of the pixels of one camera as the renderer computes them, row-major, `height * width` values each.
#[derive(Clone, Debug, PartialEq)]
pub struct RawMaps {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Sum of weights, 0 to 1.
    pub coverage: Vec<f32>,
    /// Sum of weight times depth in m, not normalised (equation 17).
    pub expected_m: Vec<f32>,
    /// Expected depth over coverage in m; -1 where coverage is below 1e-3.
    pub normalised_m: Vec<f32>,
    /// Depth in m of the first Gaussian after which less than half the light is left; -1 if none.
    pub median_m: Vec<f32>,
    /// Heaviest render id (equation 18), the lowest on a tie; -1 where nothing was drawn.
    pub label: Vec<i16>,
    /// Weight of the heaviest id minus that of the second.
    pub margin: Vec<f32>,
    /// Light that was left.
    pub transmittance: Vec<f32>,
}

impl RawMaps {
    /// Maps on which nothing was drawn.
    pub fn empty(width: usize, height: usize) -> Self {
        let n = width * height;
        RawMaps {
            width,
            height,
            coverage: vec![0.0; n],
            expected_m: vec![0.0; n],
            normalised_m: vec![-1.0; n],
            median_m: vec![-1.0; n],
            label: vec![-1; n],
            margin: vec![0.0; n],
            transmittance: vec![1.0; n],
        }
    }

    /// The output of the sensor: the label only where coverage is at least `min_coverage`, else 0.
    pub fn into_camera_maps(self, camera: &str, options: &SplatOptions) -> CameraMaps {
        let visible = |(&label, &coverage): (&i16, &f32)| {
            if coverage < options.min_coverage {
                0
            } else {
                label.max(0) as RenderId
            }
        };
        CameraMaps {
            camera: camera.to_owned(),
            width: self.width,
            height: self.height,
            semantic: self.label.iter().zip(&self.coverage).map(visible).collect(),
            depth_m: self.normalised_m,
            expected_m: self.expected_m,
            median_m: self.median_m,
            coverage: self.coverage,
        }
    }
}
