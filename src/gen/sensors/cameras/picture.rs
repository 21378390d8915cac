//! Data that a source renders, and its display in colours.

use super::view::ViewId;
use crate::pictures::appearance::CameraImage;
use crate::pictures::color::{depth_rgba, perspective_rgba, plane_rgba, semantic_rgba};
use scene::{CameraMaps, MultiPlaneImage, PerspectiveMap};

/// Depth at which the colours of depths begin and end in the window, m.
pub const DEPTH_M: (f32, f32) = (2.0, 60.0);

/// A picture of one camera, as data.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraPicture {
    /// Classes and depths.
    Maps(CameraMaps),
    /// Planes of classes.
    Planes(MultiPlaneImage),
    /// Boxes and lanes.
    Layout(PerspectiveMap),
    /// Colours.
    Picture(CameraImage),
}

impl CameraPicture {
    /// Width, height and RGBA of a view; `plane_m` is the depth of the plane that is shown.
    pub fn rgba(&self, view: ViewId, plane_m: f64) -> ([usize; 2], Vec<u8>) {
        match self {
            Self::Maps(maps) => {
                let rgba = match view {
                    ViewId::DEPTH => depth_rgba(&maps.depth_m, DEPTH_M.0, DEPTH_M.1),
                    _ => semantic_rgba(maps, true),
                };
                ([maps.width, maps.height], rgba)
            }
            Self::Planes(image) => {
                let step_m = image.planes.depth_m(1) - image.planes.depth_m(0);
                let plane = ((plane_m - image.planes.near_m) / step_m).round().max(0.0) as u16;
                let last = image.planes.count.saturating_sub(1);
                ([image.width, image.height], plane_rgba(image, plane.min(last)))
            }
            Self::Layout(map) => ([map.width, map.height], perspective_rgba(map)),
            Self::Picture(image) => ([image.width, image.height], image.rgba.clone()),
        }
    }
}
