//! What a camera would see, by day or night and in any weather: the analytic renderer.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, Card, Needs, PreparedCameras, RenderOptions,
    SourceId, View, ViewId,
};
use crate::appearance::Appearance;
use scene::Camera;

/// What it shows.
pub const VIEW: View = View::new(ViewId::new("appearance"), "Picture", "what a camera would see");

/// Name of the source.
pub const ID: SourceId = SourceId::new("pictures");

/// The source.
pub struct Pictures;

impl CameraSource for Pictures {
    fn id(&self) -> SourceId {
        ID
    }

    fn title(&self) -> &'static str {
        "Pictures"
    }

    fn hint(&self) -> &'static str {
        "materials, light and weather, ray marched"
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
        "appearance"
    }

    fn previews(&self) -> bool {
        true
    }

    fn bytes_per_pixel(&self) -> u64 {
        64
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(Ready(Appearance::new(input.frame, input.rig, &input.conditions)))
    }
}

struct Ready(Appearance);

impl PreparedCameras for Ready {
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
