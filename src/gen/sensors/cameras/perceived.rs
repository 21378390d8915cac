//! What a small network sees in the pictures: classes, and where it misses things or sees some that are none.

use super::learned::sized;
use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, Card, Needs, PreparedCameras, RenderOptions,
    SourceId, View, ViewId,
};
use crate::appearance::Appearance;
use crate::perceived::Perceived;
use scene::{Camera, Frame};

/// What it shows.
pub const VIEW: View = View::new(
    ViewId::new("perceived"),
    "Perceived",
    "what a small network sees in the pictures: red where it misses a thing, yellow where it sees one that is none",
);

/// Name of the source.
pub const ID: SourceId = SourceId::new("perceived");

/// The source.
pub struct PerceivedClasses;

impl CameraSource for PerceivedClasses {
    fn id(&self) -> SourceId {
        ID
    }

    fn title(&self) -> &'static str {
        "Perceived"
    }

    fn hint(&self) -> &'static str {
        "a segmenter that learned from the pictures, at 256 x 144"
    }

    fn views(&self) -> &'static [View] {
        &[VIEW]
    }

    fn needs(&self) -> Needs {
        Needs {
            occupancy: true,
            layout: true,
            boxes: true,
            conditions: true,
            ..Needs::default()
        }
    }

    fn report_key(&self) -> &'static str {
        "perceived"
    }

    fn bytes_per_pixel(&self) -> u64 {
        64
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(Ready {
            appearance: Appearance::new(input.frame, input.rig, &input.conditions),
            frame: input.frame,
        })
    }
}

struct Ready<'a> {
    appearance: Appearance,
    frame: &'a Frame,
}

impl PreparedCameras for Ready<'_> {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let seen = Perceived::of(&self.appearance, self.frame, camera)?;
        Ok(CameraPicture::Picture(sized(&seen.shown(), options.size)))
    }
}
