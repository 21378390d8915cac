//! Shared parts of the sources that cast exact rays.

use std::borrow::Cow;

use super::{CameraError, CameraPicture, Card, PreparedCameras, RenderOptions};
use crate::pictures::march::{GroundHeight, MarchOptions, MarchScene};
use crate::pictures::scenery::SceneryShapes;
use scene::{Background, Camera, Frame};

/// A frame for exact rays. With `shapes`, boxes and scenery have solids and stand on the road at its physical height. Without them
/// voxels are taken as they are labelled, the road two bins lower. `seed` varies the shapes.
pub fn march_scene(frame: &Frame, background: &Background, shapes: bool, seed: u64) -> MarchScene {
    let options = MarchOptions {
        ground: match shapes {
            true => GroundHeight::Physical,
            false => GroundHeight::AsLabelled,
        },
        boxes: shapes,
        lines: true,
        seed,
    };
    // A box with voxels of its own is drawn by these voxels.
    let mut boxes = Cow::Borrowed(&frame.boxes);
    if shapes && !frame.own_shapes.is_empty() {
        boxes.to_mut().retain(|id, _| !frame.own_shapes.contains_key(id));
    }
    let scenery = shapes.then(|| SceneryShapes::new(frame, background)).flatten();
    MarchScene::new(&frame.occupancy, &frame.layout, &boxes, &options).with_scenery(scenery)
}

/// A frame made ready for rays.
pub(super) struct PreparedMarch(pub MarchScene);

impl PreparedCameras for PreparedMarch {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let [width, height] = options.size;
        Ok(CameraPicture::Maps(self.0.render_maps(camera, width, height)))
    }
}
