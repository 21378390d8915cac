//! Classes and depths by exact rays to the voxels.

use super::view::MAP_VIEWS;
use super::{CameraInput, CameraSource, CameraSourceDescription, Needs, PreparedCameras, SourceId, marched};
use crate::pictures::march::GroundHeight;

/// Name of the source.
pub const ID: SourceId = SourceId::new("voxels");

/// The source.
pub struct VoxelCameraSource;

impl CameraSource for VoxelCameraSource {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Voxels",
            hint: "exact rays to the voxels",
            views: MAP_VIEWS,
            needs: Needs {
                occupancy: true,
                layout: true,
                ..Needs::NONE
            },
            ground: GroundHeight::AsLabelled,
            report_key: "cameras",
            previews: false,
            bytes_per_pixel: 80,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        let scene = marched::march_scene(input.frame, input.background, false, input.conditions.seed);
        Box::new(marched::PreparedMarch(scene))
    }
}
