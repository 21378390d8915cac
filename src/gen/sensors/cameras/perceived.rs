//! Classes that a small network predicts in the pictures, with things that it misses and things that it sees where
//! there are none.

use super::learned::sized;
use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::perceive::pictures::Perceived;
use crate::pictures::appearance::Appearance;
use crate::pictures::march::GroundHeight;
use scene::{Camera, Frame};

/// The view of predicted classes.
pub const VIEW: SourceView = SourceView::new(
    ViewId::new("perceived"),
    "Perceived",
    "what a small network sees in the pictures: red where it misses a thing, yellow where it sees one that is none",
);

/// Name of the source.
pub const ID: SourceId = SourceId::new("perceived");

/// The source.
pub struct PerceivedClasses;

impl CameraSource for PerceivedClasses {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Perceived",
            hint: "a segmenter that learned from the pictures, at 256 x 144",
            views: &[VIEW],
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                conditions: true,
            },
            ground: GroundHeight::Physical,
            report_key: "perceived",
            previews: false,
            bytes_per_pixel: 64,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(PreparedPerception {
            appearance: input.appearance(),
            frame: input.frame,
        })
    }
}

struct PreparedPerception<'a> {
    appearance: Appearance,
    frame: &'a Frame,
}

impl PreparedCameras for PreparedPerception<'_> {
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
