//! Semantic multi-plane images.

use super::{
    About, CameraError, CameraInput, CameraPicture, CameraSource, Card, Knob, Needs, PreparedCameras,
    RenderOptions, SourceId, View, ViewId,
};
use crate::march::GroundHeight;
use crate::mpi::{self, RenderIds};
use scene::Camera;
use scene::sensor_data::Planes;

/// The view of one plane.
pub const VIEW: View = View {
    knob: Some(Knob::PlaneDepth),
    ..View::new(ViewId::new("mpi"), "Planes", "one plane of the multi-plane image")
};

/// Name of the source.
const ID: SourceId = SourceId::new("planes");

/// The source.
pub struct PlaneStacks;

impl CameraSource for PlaneStacks {
    fn about(&self) -> &'static About {
        &About {
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
        Box::new(Ready(RenderIds::new(&frame.occupancy, frame.layout.cells())))
    }
}

struct Ready(RenderIds);

impl PreparedCameras for Ready {
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
            Planes::default(),
        )))
    }
}
