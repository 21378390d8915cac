//! Pictures that a camera would take, by day or night and in any weather: the analytic renderer.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::pictures::appearance::Appearance;
use crate::pictures::march::GroundHeight;
use scene::Camera;

/// The view of the picture.
pub const VIEW: SourceView = SourceView::new(ViewId::new("appearance"), "Picture", "what a camera would see");

/// Name of the source.
pub const ID: SourceId = SourceId::new("pictures");

/// The source.
pub struct PictureSource;

impl CameraSource for PictureSource {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Pictures",
            hint: "materials, light and weather, ray marched",
            views: &[VIEW],
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                conditions: true,
            },
            ground: GroundHeight::Physical,
            report_key: "appearance",
            previews: true,
            bytes_per_pixel: 64,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(PreparedPictures(input.appearance()))
    }
}

struct PreparedPictures(Appearance);

impl PreparedCameras for PreparedPictures {
    fn suits_card(&self) -> bool {
        true
    }

    fn upload(&self, card: &mut dyn Card) -> bool {
        card.set_appearance(&self.0)
    }

    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let ([width, height], quality) = (options.size, options.quality);
        let drawn = card.and_then(|c| c.picture(&self.0, camera, options.size, quality));
        let draw = || self.0.render(camera, width, height, quality);
        Ok(CameraPicture::Picture(drawn.unwrap_or_else(draw)))
    }
}
