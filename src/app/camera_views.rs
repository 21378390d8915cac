//! What the cameras of the window show: which source of the table, in which colours, for which cameras.

use std::sync::Arc;

use egui::ColorImage;

use super::state::{LidarModel, UiState};
use scene::Scene;
use sensors::cameras::{self, CameraInput, CameraSource, Detail, SourceId, ViewId};
use sensors::march::MarchScene;
use viewport::LidarColorMode;

pub use sensors::cameras::CameraPicture;

/// Size of the picture that is enlarged.
pub const LARGE_SIZE: [u32; 2] = [800, 450];

/// What is asked of the sensors besides the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What the cameras' pictures come from.
    pub source: SourceId,
    /// Bit per camera that is not rendered.
    pub hidden: u32,
    /// The camera that is rendered large as well.
    pub enlarged: Option<usize>,
    /// How the LiDAR sweep comes about.
    pub lidar: LidarModel,
    /// Echoes that a real sensor would rather lose are in the learned sweep.
    pub lost_echoes: bool,
}

/// What decides the strip of pictures: source, cameras that are not rendered. One rendering holds all views of a source.
pub type Pictures = (SourceId, u32);

impl Wanted {
    /// What the window shows.
    pub fn of(state: &UiState) -> Self {
        Self {
            source: state.shown_source().id(),
            hidden: state.cameras_hidden,
            enlarged: state.inspected,
            lidar: state.lidar_model,
            lost_echoes: state.lidar_colors == LidarColorMode::Drop,
        }
    }

    /// What decides the strip of pictures.
    pub fn pictures(self) -> Pictures {
        (self.source, self.hidden)
    }

    /// The source in the table.
    pub fn camera_source(self) -> &'static dyn CameraSource {
        cameras::source(self.source).unwrap_or(&cameras::shapes::Shapes)
    }
}

/// The current frame of a scene as camera sources take it.
pub fn camera_input(scene: &Scene, detail: Detail) -> CameraInput<'_> {
    CameraInput {
        frame: scene.frame(),
        rig: &scene.rig,
        background: &scene.background,
        conditions: scene.conditions,
        detail,
    }
}

/// The current frame for exact rays; see [`cameras::march_scene`].
pub fn march(scene: &Scene, shapes: bool) -> MarchScene {
    cameras::march_scene(scene.frame(), shapes, scene.seed)
}

/// What one camera shows.
#[derive(Clone, Debug)]
pub struct CameraView {
    /// Index of the camera in the rig.
    pub camera: usize,
    /// What it shows.
    pub picture: Arc<CameraPicture>,
    /// The same in the colours of a view, made beforehand so that the window need not.
    shown: Option<(ViewId, Arc<ColorImage>)>,
}

impl CameraView {
    /// Of one camera of the rig.
    pub fn new(camera: usize, picture: CameraPicture) -> Self {
        Self {
            camera,
            picture: Arc::new(picture),
            shown: None,
        }
    }

    /// With the colours of the source's first view made now, unless a knob of the window decides them.
    pub fn colored(mut self, source: &dyn CameraSource) -> Self {
        if let Some(view) = source.views().first().filter(|v| v.knob.is_none()) {
            self.shown = Some((view.id, Arc::new(colors(&self.picture, view.id, 0.0))));
        }
        self
    }

    /// The picture in colours; `plane_m` is the depth of the plane that is shown.
    pub fn colors(&self, view: ViewId, plane_m: f64) -> Arc<ColorImage> {
        match &self.shown {
            Some((of, image)) if *of == view => image.clone(),
            _ => Arc::new(colors(&self.picture, view, plane_m)),
        }
    }
}

/// A picture as egui takes it.
fn colors(picture: &CameraPicture, view: ViewId, plane_m: f64) -> ColorImage {
    let (size, rgba) = picture.rgba(view, plane_m);
    ColorImage::from_rgba_unmultiplied(size, &rgba)
}
