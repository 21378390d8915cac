//! Pictures by the picture networks, which learned from the program's own renderer.

use std::ops::ControlFlow;
use std::sync::Arc;

use image::RgbaImage;
use image::imageops::{FilterType, resize};

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::pictures::appearance::CameraImage;
use crate::pictures::march::GroundHeight;
use crate::pictures::painter::{PaintError, PaintInput, PaintModel, PaintOptions, PaintWith};
use scene::{Camera, SensorRig};

/// The view of the learned picture.
pub const VIEW: SourceView = SourceView::new(
    ViewId::new("learned"),
    "Learned",
    "what the picture network makes of the voxels",
);

/// Name of the source.
pub const ID: SourceId = SourceId::new("learned");

/// The source.
pub struct Learned;

impl CameraSource for Learned {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Learned",
            hint: "drawn by a network that learned from the pictures, or by the weights chosen in the settings",
            views: &[VIEW],
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                conditions: true,
            },
            ground: GroundHeight::Physical,
            report_key: "learned",
            previews: false,
            bytes_per_pixel: 64,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        Box::new(PreparedPaintings {
            input: *input,
            images: painted(input),
        })
    }
}

struct PreparedPaintings<'a> {
    input: CameraInput<'a>,
    /// Pictures in the order of the rig.
    images: Result<Vec<Arc<CameraImage>>, CameraError>,
}

fn painted(input: &CameraInput<'_>) -> Result<Vec<Arc<CameraImage>>, CameraError> {
    let shipped = || {
        let model = PaintModel::bundled()?;
        Ok::<_, PaintError>(PaintWith {
            model,
            options: PaintOptions::default(),
        })
    };
    let with = input.paint.map_or_else(shipped, |with| Ok(with.clone()))?;
    let mut painter = with.painter(false);
    let input = PaintInput {
        frame: input.frame,
        rig: input.rig,
        background: input.background,
        conditions: input.conditions,
    };
    Ok(painter.paint(&input, &mut |_| ControlFlow::Continue(()))?)
}

impl From<PaintError> for CameraError {
    fn from(error: PaintError) -> Self {
        match error {
            PaintError::Network(problem) => Self::Network(problem),
            PaintError::Stopped => Self::Cancelled,
        }
    }
}

impl PreparedCameras for PreparedPaintings<'_> {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let place = self.input.rig.cameras.iter().position(|c| c == camera);
        let image = match place {
            Some(place) => self.images.clone()?.get(place).cloned(),
            // A camera outside the rig is painted alone.
            None => {
                let rig = SensorRig {
                    cameras: vec![camera.clone()],
                    ..self.input.rig.clone()
                };
                let alone = CameraInput {
                    rig: &rig,
                    ..self.input
                };
                painted(&alone)?.pop()
            }
        };
        let image = image.ok_or_else(|| CameraError::Network("no picture was painted".into()))?;
        Ok(CameraPicture::Picture(sized(&image, options.size)))
    }
}

/// A picture at another size, smoothly.
pub fn sized(image: &CameraImage, [width, height]: [u32; 2]) -> CameraImage {
    let [w, h] = [image.width as u32, image.height as u32];
    let source = RgbaImage::from_raw(w, h, image.rgba.clone()).unwrap_or_default();
    let empty = width == 0 || height == 0 || source.is_empty();
    let rgba = match () {
        () if [width, height] == [w, h] => source,
        () if empty => RgbaImage::new(width, height),
        () => resize(&source, width, height, FilterType::CatmullRom),
    };
    CameraImage {
        camera: image.camera.clone(),
        width: width as usize,
        height: height as usize,
        rgba: rgba.into_raw(),
    }
}
