//! Classes and depths by exact rays to the voxels, boxes as the shapes that they stand for.

use super::view::MAP_VIEWS;
use super::{CameraInput, CameraSource, Needs, PreparedCameras, SourceId, View, marched};

/// Name of the source.
pub const ID: SourceId = SourceId::new("shapes");

/// The source.
pub struct Shapes;

impl CameraSource for Shapes {
    fn id(&self) -> SourceId {
        ID
    }

    fn title(&self) -> &'static str {
        "Shapes"
    }

    fn hint(&self) -> &'static str {
        "exact rays; boxes as the shapes they stand for"
    }

    fn views(&self) -> &'static [View] {
        MAP_VIEWS
    }

    fn needs(&self) -> Needs {
        Needs {
            occupancy: true,
            layout: true,
            boxes: true,
            ..Needs::default()
        }
    }

    fn report_key(&self) -> &'static str {
        "cameras"
    }

    fn bytes_per_pixel(&self) -> u64 {
        80
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        let scene = marched::march_scene(input.frame, true, input.conditions.seed);
        Box::new(marched::Ready(scene))
    }
}
