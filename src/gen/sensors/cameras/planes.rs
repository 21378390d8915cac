//! Semantic multi-plane images.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Knob, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::pictures::march::GroundHeight;
use crate::pictures::mpi::{self, RenderIds};
use scene::Camera;
use scene::sensor_data::PlaneDepths;

/// The view of one plane.
pub const VIEW: SourceView = SourceView {
    knob: Some(Knob::PlaneDepth),
    ..SourceView::new(ViewId::new("mpi"), "Planes", "one plane of the multi-plane image")
};

/// Name of the source.
const ID: SourceId = SourceId::new("planes");

/// The source.
pub struct PlaneStacks;

impl CameraSource for PlaneStacks {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Planes",
            hint: "classes of the voxels at fixed depths",
            views: &[VIEW],
            needs: Needs {
                occupancy: true,
                layout: true,
                ..Needs::NONE
            },
            ground: GroundHeight::AsLabelled,
            report_key: "mpi",
            previews: false,
            bytes_per_pixel: 120,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        let frame = input.frame;
        Box::new(PreparedPlanes(RenderIds::new(
            &frame.occupancy,
            frame.layout.cells(),
        )))
    }
}

struct PreparedPlanes(RenderIds);

impl PreparedCameras for PreparedPlanes {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let [width, height] = options.size;
        Ok(CameraPicture::Planes(mpi::render(
            &self.0,
            camera,
            width,
            height,
            PlaneDepths::default(),
        )))
    }
}
