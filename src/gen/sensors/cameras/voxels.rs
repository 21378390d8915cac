//! Classes and depths by exact rays to the voxels.

use super::view::MAP_VIEWS;
use super::{CameraInput, CameraSource, Needs, PreparedCameras, SourceId, View, marched};
use crate::march::GroundHeight;

/// Name of the source.
pub const ID: SourceId = SourceId::new("voxels");

/// The source.
pub struct Voxels;

impl CameraSource for Voxels {
    fn id(&self) -> SourceId {
        ID
    }

    fn title(&self) -> &'static str {
        "Voxels"
    }

    fn hint(&self) -> &'static str {
        "exact rays to the voxels"
    }

    fn views(&self) -> &'static [View] {
        MAP_VIEWS
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
        "cameras"
    }

    fn bytes_per_pixel(&self) -> u64 {
        80
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        let scene = marched::march_scene(input.frame, false, input.conditions.seed);
        Box::new(marched::Ready(scene))
    }
}
