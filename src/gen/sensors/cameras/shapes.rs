//! Classes and depths by exact rays to the voxels, boxes and scenery as the shapes that they stand for.

use super::view::MAP_VIEWS;
use super::{CameraInput, CameraSource, CameraSourceDescription, Needs, PreparedCameras, SourceId, marched};
use crate::pictures::march::GroundHeight;

/// Name of the source.
pub const ID: SourceId = SourceId::new("shapes");

/// The source.
pub struct ShapeMaps;

impl CameraSource for ShapeMaps {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Shapes",
            hint: "exact rays; boxes and scenery as the shapes they stand for",
            views: MAP_VIEWS,
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                ..Needs::NONE
            },
            ground: GroundHeight::Physical,
            report_key: "cameras",
            previews: false,
            bytes_per_pixel: 80,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        let scene = marched::march_scene(input.frame, input.background, true, input.conditions.seed);
        Box::new(marched::PreparedMarch(scene))
    }
}
