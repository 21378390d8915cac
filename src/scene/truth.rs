//! Ground truth of a camera picture, pixel by pixel, from the same rays that gave its colours; and the boxes in it.

use glam::DVec3;

use crate::sensor_data::RenderId;
use crate::{Camera, Class, SceneBox};

/// Class of a pixel: 0 sky, 1 to 16 the occupancy classes, 17 crossing, 18 road divider, 19 lane divider (as
/// [`RenderId`]), 20 others, 21 stop line, 255 outside the lens.
pub type TruthClass = u8;

/// Sky.
pub const SKY: TruthClass = 0;
/// Class of a surface that has none of the 16.
pub const OTHERS: TruthClass = 20;
/// A stop line.
pub const STOP_LINE: TruthClass = 21;
/// The lens sees nothing here.
pub const OUTSIDE: TruthClass = 255;

/// Names of the classes in the order of their numbers, 0 to 21.
pub fn class_names() -> Vec<String> {
    let of = |id: TruthClass| match id {
        SKY => "sky".to_owned(),
        17 => "ped_crossing".to_owned(),
        18 => "road_divider".to_owned(),
        19 => "lane_divider".to_owned(),
        STOP_LINE => "stop_line".to_owned(),
        id => Class::from_id(id).unwrap_or(Class::Others).name().to_owned(),
    };
    (0..=STOP_LINE).map(of).collect()
}

/// The class of a voxel's label.
pub fn of_class(class: Class) -> TruthClass {
    match class {
        Class::Others | Class::Free => OTHERS,
        class => class.id(),
    }
}

/// sRGB colour of a class.
pub fn color(class: TruthClass) -> [u8; 3] {
    match class {
        STOP_LINE => crate::BevLayer::StopLine.color(),
        OUTSIDE => [0; 3],
        id => crate::sensor_data::render_id_color(id as RenderId),
    }
}

/// Ground truth of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthPixel {
    /// Its class.
    pub class: TruthClass,
    /// The box it belongs to; 0 where it belongs to none.
    pub instance: u32,
    /// Depth, m: along the optical axis, of wide lenses from the optical centre; -1 for the sky and outside the lens.
    pub depth_m: f32,
    /// Outward unit normal in the optical frame; zero where there is no surface of the scene.
    pub normal_in_camera: [f32; 3],
    /// Way to where the same point is seen at the next moment, px; NaN where it is not seen then or nothing is known.
    pub flow_px: [f32; 2],
}

impl Default for TruthPixel {
    /// Outside the lens.
    fn default() -> Self {
        Self {
            class: OUTSIDE,
            instance: 0,
            depth_m: -1.0,
            normal_in_camera: [0.0; 3],
            flow_px: [f32::NAN; 2],
        }
    }
}

/// A box in a camera's picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenBox {
    /// The box, in the frame of the sensors' poses.
    pub of: SceneBox,
    /// Its centre in the optical frame, m.
    pub center_in_camera_m: DVec3,
    /// Corners in the picture, px; bits of an index are the signs along x, y and z. None where the lens does not see one.
    pub corners_px: [Option<[f64; 2]>; 8],
    /// Pixels that show it.
    pub visible_px: u32,
    /// Pixels that would show it if nothing stood in front, inside the picture.
    pub whole_px: u32,
    /// Share of those pixels that do show it, 0 to 1.
    pub visibility: f64,
    /// Share of its outline's bounds that lies inside the picture, 0 to 1.
    pub in_picture: f64,
    /// Bounds of the pixels that show it: left, top, right, bottom, px; none if none does.
    pub visible_bounds_px: Option<[f64; 4]>,
    /// Bounds of the pixels that would show it.
    pub whole_bounds_px: [f64; 4],
}

/// The truth about one camera's picture; planes are row-major, `height * width` values each.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraTruth {
    /// The camera at the size of the picture, its pose in the frame of the sensors' poses.
    pub camera: Camera,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The pixels.
    pub pixels: Vec<TruthPixel>,
    /// Time from this moment to the one that the flow leads to, s; none without flow.
    pub flow_s: Option<f64>,
    /// The boxes that it shows or would show if nothing stood in front, in the order of their ids.
    pub boxes: Vec<SeenBox>,
}

impl CameraTruth {
    /// One value of each pixel.
    pub fn plane<T>(&self, of: impl Fn(&TruthPixel) -> T) -> Vec<T> {
        self.pixels.iter().map(of).collect()
    }
}
