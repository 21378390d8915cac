//! Boxes and lanes in perspective, hidden or not.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::pictures::march::GroundHeight;
use crate::pictures::perspective;
use scene::{Camera, Frame};

/// The view of boxes and lanes.
pub const VIEW: SourceView = SourceView::new(
    ViewId::new("perspective"),
    "Boxes, lanes",
    "in perspective, hidden or not",
);

/// Name of the source.
const ID: SourceId = SourceId::new("layout");

/// The source.
pub struct LayoutMaps;

impl CameraSource for LayoutMaps {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Layout",
            hint: "boxes and lanes as image models take them",
            views: &[VIEW],
            needs: Needs {
                layout: true,
                boxes: true,
                ..Needs::NONE
            },
            ground: GroundHeight::Physical,
            report_key: "perspective",
            previews: false,
            bytes_per_pixel: 24,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(PreparedLayoutMaps(input.frame))
    }
}

struct PreparedLayoutMaps<'a>(&'a Frame);

impl PreparedCameras for PreparedLayoutMaps<'_> {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let ([width, height], boxes) = (options.size, self.0.boxes.values());
        let map = perspective::render(&self.0.layout, boxes, camera, width, height);
        Ok(CameraPicture::Layout(map))
    }
}
