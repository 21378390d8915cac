//! Classes and depths of the very surfaces that the pictures show.

use super::view::MAP_VIEWS;
use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId,
};
use crate::pictures::appearance::Appearance;
use crate::pictures::march::GroundHeight;
use scene::truth::{OUTSIDE, STOP_LINE};
use scene::{Camera, CameraMaps, CameraTruth, Class, Frame};

/// Name of the source.
pub const ID: SourceId = SourceId::new("truth");

/// The source.
pub struct TruthCameraSource;

impl CameraSource for TruthCameraSource {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "As pictures",
            hint: "what the pictures show, pixel by pixel: paint, crowns and the skyline too",
            views: MAP_VIEWS,
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                ..Needs::NONE
            },
            ground: GroundHeight::Physical,
            report_key: "truth",
            previews: false,
            bytes_per_pixel: 80,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(PreparedSurfaceTruth {
            appearance: input.appearance(),
            frame: input.frame,
        })
    }
}

struct PreparedSurfaceTruth<'a> {
    appearance: Appearance,
    frame: &'a Frame,
}

impl PreparedCameras for PreparedSurfaceTruth<'_> {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let truth = self
            .appearance
            .truth(camera, options.size, &self.frame.boxes, None);
        Ok(CameraPicture::Maps(maps(&truth)))
    }
}

/// Classes and depths as maps; a stop line is road there.
pub fn maps(truth: &CameraTruth) -> CameraMaps {
    let class = |class: u8| match class {
        STOP_LINE => Class::DriveableSurface.id(),
        OUTSIDE => 0,
        class => class,
    };
    let depth_m = truth.plane(|p| p.depth_m);
    CameraMaps {
        camera: truth.camera.name.clone(),
        width: truth.width,
        height: truth.height,
        semantic: truth.plane(|p| class(p.class)),
        coverage: depth_m.iter().map(|d| f32::from(*d >= 0.0)).collect(),
        expected_m: depth_m.iter().map(|d| d.max(0.0)).collect(),
        median_m: depth_m.clone(),
        depth_m,
    }
}
