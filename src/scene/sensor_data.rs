//! Output of sensors: label and depth maps of a camera, points of a LiDAR sweep.

use super::{BevLayer, Class, Provenance};

/// Label of a splat map, a type apart from [`super::Class`] because 17 to 19 mean lines here:
/// 0 nothing, 1 to 16 as the occupancy classes, 17 crossing, 18 road divider, 19 lane divider.
pub type RenderId = u8;

/// Number of render ids.
pub const RENDER_IDS: usize = 20;

/// sRGB colour of pixels on which nothing was drawn.
pub const SKY: [u8; 3] = [46, 58, 78];

/// sRGB colour of a render id: the classes' colours, and those of the painted lines for 17 to 19.
/// Id 0 is the sky; ids from 20 on are drawn as the class "others".
pub fn render_id_color(id: RenderId) -> [u8; 3] {
    match id {
        0 => SKY,
        17 => BevLayer::PedCrossing.color(),
        18 => BevLayer::RoadDivider.color(),
        19 => BevLayer::LaneDivider.color(),
        _ => Class::from_id(id).unwrap_or(Class::Others).color(),
    }
}

/// Depth in whole millimetres for a 16-bit picture, as in common RGB-D data: 0 where there is none
/// (not above 0, or NaN), 65,535 for that many millimetres and more.
pub fn depth_mm(depth_m: &[f32]) -> Vec<u16> {
    let mm = |&d: &f32| if d > 0.0 { (d * 1000.0).round() as u16 } else { 0 };
    depth_m.iter().map(mm).collect()
}

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

/// Depths of the planes of a multi-plane image: plane l at near + (far - near) l / count (SyntheOcc, equation 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDepths {
    /// Number of planes.
    pub count: u16,
    /// Depth of the first plane along the optical axis, m.
    pub near_m: f64,
    /// Depth that one more plane would have, m.
    pub far_m: f64,
}

impl Default for PlaneDepths {
    fn default() -> Self {
        Self {
            count: 256,
            near_m: 0.2,
            far_m: 51.2,
        }
    }
}

impl PlaneDepths {
    /// Depth of a plane along the optical axis, m.
    pub fn depth_m(&self, plane: u16) -> f64 {
        self.near_m + (self.far_m - self.near_m) * f64::from(plane) / f64::from(self.count.max(1))
    }
}

/// Planes that show one class at one pixel: from `first` up to, but not including, `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneRun {
    /// Nearest plane.
    pub first: u16,
    /// One past the farthest.
    pub end: u16,
    /// Class that they show.
    pub id: RenderId,
}

/// A semantic multi-plane image of one camera, stored as runs per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct MultiPlaneImage {
    /// Name of the camera in the rig.
    pub camera: String,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Depths.
    pub planes: PlaneDepths,
    /// Start of each pixel's runs, row-major; one entry more than there are pixels.
    pub starts: Vec<u32>,
    /// Runs, near to far in each pixel.
    pub runs: Vec<PlaneRun>,
}

impl MultiPlaneImage {
    /// Runs of a pixel, near to far. Panics beyond the last pixel.
    pub fn pixel(&self, pixel: usize) -> &[PlaneRun] {
        &self.runs[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }

    /// The class that a pixel shows on a plane; `None` where the plane is free.
    pub fn at(&self, pixel: usize, plane: u16) -> Option<RenderId> {
        let runs = self.pixel(pixel);
        runs.iter()
            .find(|r| (r.first..r.end).contains(&plane))
            .map(|r| r.id)
    }

    /// One plane, row-major.
    pub fn slice(&self, plane: u16) -> Vec<Option<RenderId>> {
        (0..self.width * self.height).map(|i| self.at(i, plane)).collect()
    }

    /// The nearest class of each pixel (SyntheOcc's channel 257).
    pub fn first_visible(&self) -> Vec<Option<RenderId>> {
        (0..self.width * self.height)
            .map(|i| self.pixel(i).first().map(|r| r.id))
            .collect()
    }
}

/// Objects and lines in a camera's picture, whether hidden or not: one bit per channel and pixel, row-major. X-Scene
/// section 6.6: three lines, the road, ten classes of boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct PerspectiveMap {
    /// Name of the camera in the rig.
    pub camera: String,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bits: 0 road divider, 1 lane divider, 2 crossing, 3 drivable area, 4 to 13 the object classes in their order.
    pub channels: Vec<u16>,
    /// Edges of boxes: 1 + the channel minus 4 of the nearest box whose edge runs here, 0 elsewhere.
    pub edges: Vec<u8>,
}

/// One LiDAR return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarPoint {
    /// Position in the frame of the rig's poses, m: the ego frame, or the world frame where the rig was placed there.
    pub position_in_ego: [f32; 3],
    /// Distance from the sensor, m.
    pub range_m: f32,
    /// Beam index, 0 = lowest elevation.
    pub ring: u16,
    /// Column of the sweep.
    pub azimuth: u16,
    /// Class of the voxel that was hit.
    pub class: super::Class,
    /// Strength of the echo as sensors report it, 0 to 255; 0 where it is unknown.
    pub intensity: f32,
    /// Probability that a real sensor gets no echo from there, 0 to 1.
    pub drop_probability: f32,
    /// Time of the measurement, s from the end of the sweep: 0 or less.
    pub time_s: f32,
    /// Velocity over the ground of the object that was hit, in the frame of the position, m/s.
    pub velocity_mps: [f32; 2],
}

/// One revolution of a LiDAR.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LidarSweep {
    /// Returns in beam-major order.
    pub points: Vec<LidarPoint>,
    /// Rays that were cast.
    pub rays: usize,
    /// True if the ground is at its true height, and not two bins lower as in the labels.
    pub physical: bool,
    /// Origin of each point; empty if all were computed.
    pub provenance: Vec<Provenance>,
}

impl LidarSweep {
    /// Memory that its points take, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.points) + size_of_val(&*self.provenance)
    }

    /// Gives the points in another frame.
    pub fn place(&mut self, to_from_here: &super::Pose) {
        if *to_from_here == super::Pose::IDENTITY {
            return;
        }
        for point in &mut self.points {
            let p = glam::DVec3::from_array(point.position_in_ego.map(f64::from));
            point.position_in_ego = to_from_here.apply(p).as_vec3().to_array();
            let v = glam::Vec2::from(point.velocity_mps).as_dvec2().extend(0.0);
            point.velocity_mps = (to_from_here.rotation * v).as_vec3().truncate().to_array();
        }
    }
}
