//! The cameras of a rig as a ring: each one's neighbour on the right follows it.

use std::sync::Arc;

use glam::DVec3;

use super::{Brush, PaintError, network};
use crate::appearance::CameraImage;
use nets::picture::RingSize;
use scene::Camera;

/// Pixels of a picture that the networks learned, about.
const PIXELS: f64 = 256.0 * 144.0;
/// Sides are multiples of this, px.
const UNIT_PX: usize = 16;
/// Shortest and longest side, px.
const SIDE_PX: [usize; 2] = [64, 512];

/// A rig's cameras in the order in which they stand around the vehicle: clockwise from above, beginning with the front
/// camera (the rig's first, if none is called so). A place does not depend on the vehicle's heading.
pub(super) struct Ring {
    /// Number of cameras, and the size of their pictures.
    pub size: RingSize,
    /// Index in the rig of the camera at each place of the ring.
    cameras: Vec<usize>,
}

impl Ring {
    /// The ring at the size that the picture networks learned. `None` without cameras. Errors if there are more than
    /// 64.
    pub fn of(cameras: &[Camera]) -> Result<Option<Self>, PaintError> {
        match cameras.first() {
            Some(camera) => Self::sized(cameras, native_px(camera)),
            None => Ok(None),
        }
    }

    /// The ring at a size, height and width in px. `None` without cameras. Errors if there are more than 64, or if the
    /// networks do not take the size.
    pub fn sized(cameras: &[Camera], size: [usize; 2]) -> Result<Option<Self>, PaintError> {
        if cameras.is_empty() {
            return Ok(None);
        }
        let mut order: Vec<usize> = (0..cameras.len()).collect();
        let clockwise = |i: &usize| {
            let ahead = cameras[*i].ego_from_camera().rotation * DVec3::Z;
            -ahead.y.atan2(ahead.x)
        };
        order.sort_by(|a, b| clockwise(a).total_cmp(&clockwise(b)));
        let front = cameras
            .iter()
            .position(|c| c.name.ends_with("FRONT"))
            .unwrap_or(0);
        let first = order.iter().position(|i| *i == front).unwrap_or(0);
        order.rotate_left(first);
        Ok(Some(Self {
            size: RingSize::new(cameras.len(), size).map_err(network)?,
            cameras: order,
        }))
    }

    /// Index in the rig of the camera at a place.
    pub fn camera(&self, place: usize) -> usize {
        self.cameras[place]
    }

    /// All places, that of the front camera first.
    pub fn places(&self) -> Vec<usize> {
        (0..self.size.views()).collect()
    }

    /// Places that a brush touches, that of the front camera first.
    pub fn order(&self, brush: &Brush<'_>) -> Vec<usize> {
        let mut places = self.places();
        places.retain(|place| brush.touches(*place));
        places
    }

    /// Sorts pictures in the ring's order into the order of the rig.
    pub fn in_rig_order(&self, images: &[Arc<CameraImage>]) -> Vec<Arc<CameraImage>> {
        let mut sorted: Vec<_> = self.cameras.iter().zip(images).collect();
        sorted.sort_by_key(|(camera, _)| **camera);
        sorted.into_iter().map(|(_, image)| image.clone()).collect()
    }

    /// The cameras in the ring's order.
    pub fn sorted<'a>(&self, cameras: &'a [Camera]) -> Vec<&'a Camera> {
        self.cameras.iter().map(|i| &cameras[*i]).collect()
    }
}

/// Height and width of pictures of a camera as the picture networks take them, px: as many pixels as they learned, in the
/// camera's shape.
pub fn native_px(camera: &Camera) -> [usize; 2] {
    let aspect = f64::from(camera.width.max(1)) / f64::from(camera.height.max(1));
    let side = |px: f64| {
        let units = (px / UNIT_PX as f64).round() as usize;
        (units * UNIT_PX).clamp(SIDE_PX[0], SIDE_PX[1])
    };
    [side((PIXELS / aspect).sqrt()), side((PIXELS * aspect).sqrt())]
}
