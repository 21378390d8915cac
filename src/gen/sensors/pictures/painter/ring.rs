//! The cameras of a rig as a ring: each one's neighbour on the right follows it.

use std::sync::Arc;

use glam::DVec3;

use super::{Brush, PaintError, network_error};
use crate::pictures::appearance::CameraImage;
use nets::picture::RingSize;
use scene::Camera;

/// Approximate number of pixels of the training pictures.
const TRAINING_PIXELS: f64 = 256.0 * 144.0;
/// Sides are multiples of this, px.
const UNIT_PX: usize = 16;
/// Shortest and longest side, px.
const SIDE_PX: [usize; 2] = [64, 512];

/// A rig's cameras in the order in which they stand around the vehicle: clockwise from above, beginning with the front
/// camera (the one whose name ends in FRONT; else the rig's first). The order goes round a circle, so it does not
/// change when the vehicle turns.
pub(super) struct Ring {
    /// Number of cameras, and the size of their pictures.
    pub size: RingSize,
    /// Index in the rig of each view of the ring.
    rig_indices: Vec<usize>,
}

impl Ring {
    /// The ring with every picture in the native size of the first camera ([`native_px`]). `None` without cameras.
    /// Errors if there are more than 64.
    pub fn of(cameras: &[Camera]) -> Result<Option<Self>, PaintError> {
        match cameras.first() {
            Some(camera) => Self::sized(cameras, native_px(camera)),
            None => Ok(None),
        }
    }

    /// The ring with every picture in this size. `None` without cameras. Errors if there are more than 64, or if the
    /// networks do not take the size.
    pub fn sized(cameras: &[Camera], height_width_px: [usize; 2]) -> Result<Option<Self>, PaintError> {
        if cameras.is_empty() {
            return Ok(None);
        }
        let mut order: Vec<usize> = (0..cameras.len()).collect();
        let clockwise_bearing_rad = |i: &usize| {
            let ahead = cameras[*i].ego_from_camera().rotation * DVec3::Z;
            -ahead.y.atan2(ahead.x)
        };
        order.sort_by(|a, b| clockwise_bearing_rad(a).total_cmp(&clockwise_bearing_rad(b)));
        let front = cameras
            .iter()
            .position(|c| c.name.ends_with("FRONT"))
            .unwrap_or(0);
        let first = order.iter().position(|i| *i == front).unwrap_or(0);
        order.rotate_left(first);
        Ok(Some(Self {
            size: RingSize::new(cameras.len(), height_width_px).map_err(network_error)?,
            rig_indices: order,
        }))
    }

    /// Index in the rig of the camera of a view.
    pub fn camera(&self, view: usize) -> usize {
        self.rig_indices[view]
    }

    /// All views: 0 up to the number of cameras; 0 is the front.
    pub fn views(&self) -> Vec<usize> {
        (0..self.size.views()).collect()
    }

    /// Views that a brush touches, in the ring's order.
    pub fn touched_views(&self, brush: &Brush<'_>) -> Vec<usize> {
        let mut views = self.views();
        views.retain(|view| brush.touches(*view));
        views
    }

    /// Sorts pictures in the ring's order into the order of the rig.
    pub fn in_rig_order(&self, images: &[Arc<CameraImage>]) -> Vec<Arc<CameraImage>> {
        let mut by_rig: Vec<_> = self.rig_indices.iter().zip(images).collect();
        by_rig.sort_by_key(|(rig_index, _)| **rig_index);
        by_rig.into_iter().map(|(_, image)| image.clone()).collect()
    }

    /// The cameras in the ring's order.
    pub fn in_ring_order<'a>(&self, cameras: &'a [Camera]) -> Vec<&'a Camera> {
        self.rig_indices.iter().map(|i| &cameras[*i]).collect()
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
    [
        side((TRAINING_PIXELS / aspect).sqrt()),
        side((TRAINING_PIXELS * aspect).sqrt()),
    ]
}
