//! Semantic multi-plane images.

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, Card, Knob, Needs, PreparedCameras, RenderOptions,
    SourceId, View, ViewId,
};
use crate::march::GroundHeight;
use crate::mpi::{self, RenderIds};
use scene::Camera;
use scene::sensor_data::Planes;

/// What it shows.
pub const VIEW: View = View {
    knob: Some(Knob::PlaneDepth),
    ..View::new(ViewId::new("mpi"), "Planes", "one plane of the multi-plane image")
};

/// The source.
pub struct PlaneStacks;

impl CameraSource for PlaneStacks {
    fn id(&self) -> SourceId {
        SourceId::new("planes")
    }

    fn title(&self) -> &'static str {
        "Planes"
    }

    fn hint(&self) -> &'static str {
        "classes of the voxels at fixed depths"
    }

    fn views(&self) -> &'static [View] {
        &[VIEW]
    }

    fn needs(&self) -> Needs {
        Needs {
            occupancy: true,
            layout: true,
            ..Needs::default()
        }
    }

    fn ground(&self) -> GroundHeight {
        GroundHeight::AsLabelled
    }

    fn report_key(&self) -> &'static str {
        "mpi"
    }

    fn bytes_per_pixel(&self) -> u64 {
        120
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
