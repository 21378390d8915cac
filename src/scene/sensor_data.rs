//! What sensors return: label and depth maps of a camera, points of a LiDAR sweep.

/// Label of a splat map, a type apart from [`super::Class`] because 17 to 19 mean lines here:
/// 0 nothing, 1 to 16 as the occupancy classes, 17 crossing, 18 road divider, 19 lane divider.
pub type RenderId = u8;

/// Number of render ids.
pub const RENDER_IDS: usize = 20;

/// Maps of one camera, row-major, `height * width` values each.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraMaps {
    /// Name of the camera in the rig.
    pub camera: String,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Most visible render id; 0 where nothing was drawn.
    pub semantic: Vec<RenderId>,
    /// Depth along the optical axis in m, normalised by coverage; -1 where coverage is below 1e-3.
    /// Between two surfaces where both are seen.
    pub depth_m: Vec<f32>,
    /// Sum of weight times depth in m, not normalised (UniScene's depth map, equation 17): falls
    /// with coverage; 0 where nothing was drawn.
    pub expected_m: Vec<f32>,
    /// Depth in m of the first splat after which less than half the light is left, so always that of a
    /// surface; -1 where more is left.
    pub median_m: Vec<f32>,
    /// Sum of blending weights, 0 to 1.
    pub coverage: Vec<f32>,
}

/// One LiDAR return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarPoint {
    /// Position in the ego frame, m.
    pub position_in_ego: [f32; 3],
    /// Distance from the sensor, m.
    pub range_m: f32,
    /// Beam index, 0 = lowest elevation.
    pub ring: u16,
    /// Column of the sweep.
    pub azimuth: u16,
    /// Class of the voxel that was hit.
    pub class: super::Class,
}

/// One revolution of a LiDAR.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LidarSweep {
    /// Returns in beam-major order.
    pub points: Vec<LidarPoint>,
    /// Rays that were cast.
    pub rays: usize,
}
