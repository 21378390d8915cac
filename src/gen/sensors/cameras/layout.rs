//! Boxes and lanes in perspective, hidden or not.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, Card, Needs, PreparedCameras, RenderOptions,
    SourceId, View, ViewId,
};
use crate::perspective;
use scene::{Camera, Frame};

/// What it shows.
pub const VIEW: View = View::new(
    ViewId::new("perspective"),
    "Boxes, lanes",
    "in perspective, hidden or not",
);

/// The source.
pub struct LayoutMaps;

impl CameraSource for LayoutMaps {
    fn id(&self) -> SourceId {
        SourceId::new("layout")
    }

    fn title(&self) -> &'static str {
        "Layout"
    }

    fn hint(&self) -> &'static str {
        "boxes and lanes as image models take them"
    }

    fn views(&self) -> &'static [View] {
        &[VIEW]
    }

    fn needs(&self) -> Needs {
        Needs {
            layout: true,
            boxes: true,
            ..Needs::default()
        }
    }

    fn report_key(&self) -> &'static str {
        "perspective"
    }

    fn bytes_per_pixel(&self) -> u64 {
        24
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(Ready(input.frame))
    }
}

struct Ready<'a>(&'a Frame);

impl PreparedCameras for Ready<'_> {
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
