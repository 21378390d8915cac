//! What the sources that cast exact rays share.

use super::{CameraPicture, Card, PreparedCameras, RenderOptions};
use crate::march::{GroundHeight, MarchOptions, MarchScene};
use scene::{Camera, Frame};

/// A frame for exact rays. Shapes of boxes stand on the road as it really lies; voxels alone are taken as they are
/// labelled, the road two bins lower. `seed` varies the shapes.
pub fn march_scene(frame: &Frame, shapes: bool, seed: u64) -> MarchScene {
    let options = MarchOptions {
        ground: match shapes {
            true => GroundHeight::Physical,
            false => GroundHeight::AsLabelled,
        },
        boxes: shapes,
        lines: true,
        seed,
    };
    MarchScene::new(&frame.occupancy, &frame.layout, &frame.boxes, &options)
}

/// A frame made ready for rays.
pub(super) struct Ready(pub MarchScene);

impl PreparedCameras for Ready {
    fn draw(&self, camera: &Camera, options: &RenderOptions, _card: Option<&mut dyn Card>) -> CameraPicture {
        let [width, height] = options.size;
        CameraPicture::Maps(self.0.render_maps(camera, width, height))
    }
}
