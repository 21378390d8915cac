//! Classes and depths by splatting Gaussians at voxel centres.

use super::view::MAP_VIEWS;
use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Detail, Needs,
    PreparedCameras, RenderOptions, SourceId,
};
use crate::pictures::march::GroundHeight;
use crate::splat::cloud::GaussianCloud;
use crate::splat::{self, SplatOptions};
use scene::Camera;

/// Name of the source.
pub const ID: SourceId = SourceId::new("splats");

/// Voxels below the surface that still count for a live picture; see [`GaussianCloud::from_grid_shell`].
const SHELL_LAYERS: usize = 2;

/// The source.
pub struct Splats;

impl CameraSource for Splats {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Splats",
            hint: "Gaussians at voxel centres, as the papers render",
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
        let (grid, cells) = (&input.frame.occupancy, input.frame.layout.cells());
        Box::new(PreparedSplats(match input.detail {
            Detail::Live => GaussianCloud::from_grid_shell(grid, cells, SHELL_LAYERS),
            Detail::Full => GaussianCloud::from_grid(grid, cells),
        }))
    }
}

struct PreparedSplats(GaussianCloud);

impl PreparedCameras for PreparedSplats {
    fn suits_card(&self) -> bool {
        true
    }

    fn upload(&self, card: &mut dyn Card) -> bool {
        card.set_cloud(&self.0)
    }

    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let [width, height] = options.size;
        let drawn = card.and_then(|c| c.maps(camera, options.size));
        let draw = || splat::render(&self.0, camera, width, height, &SplatOptions::default());
        Ok(CameraPicture::Maps(drawn.unwrap_or_else(draw)))
    }
}
