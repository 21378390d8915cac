//! What the cameras show: classes, depths, pictures, planes or the layout, each from what suits it.

use std::sync::Arc;

use egui::ColorImage;

use super::graphics::Graphics;
use super::state::{CameraMode, CameraSource, LidarModel, UiState};
use scene::sensor_data::Planes;
use scene::{CameraMaps, MultiPlaneImage, PerspectiveMap, Scene};
use sensors::appearance::{CameraImage, Look, Quality};
use sensors::cloud::GaussianCloud;
use sensors::color::{depth_rgba, perspective_rgba, plane_rgba, semantic_rgba};
use sensors::march::ground::GroundHeight;
use sensors::march::{MarchOptions, MarchScene};
use sensors::mpi::{self, RenderIds};
use sensors::perspective;
use sensors::splat::{self, SplatOptions};
use viewport::LidarColorMode;

/// Size of the picture that is enlarged.
pub const LARGE_SIZE: [u32; 2] = [800, 450];
/// Voxels below the surface that still count for a picture; see [`GaussianCloud::from_grid_shell`].
const SHELL_LAYERS: usize = 2;
/// Depth at which the colours begin and end, m.
const DEPTH_M: (f32, f32) = (2.0, 60.0);

/// What is asked of the sensors besides the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What the cameras show.
    pub mode: CameraMode,
    /// What classes and depths are rendered from.
    pub source: CameraSource,
    /// Bit per camera that is not rendered.
    pub hidden: u32,
    /// The camera that is rendered large as well.
    pub enlarged: Option<usize>,
    /// How the LiDAR sweep comes about.
    pub lidar: LidarModel,
    /// Echoes that a real sensor would rather lose are in the learned sweep.
    pub lost_echoes: bool,
}

/// What decides the strip of pictures: kind, source, cameras that are not rendered.
pub type Pictures = (CameraMode, CameraSource, u32);

impl Wanted {
    /// What the window shows.
    pub fn of(state: &UiState) -> Self {
        let exact = matches!(state.camera_mode, CameraMode::Semantic | CameraMode::Depth);
        Self {
            // One rendering holds classes and depths.
            mode: if exact {
                CameraMode::Semantic
            } else {
                state.camera_mode
            },
            source: if exact {
                state.camera_source
            } else {
                CameraSource::default()
            },
            hidden: state.cameras_hidden,
            enlarged: state.inspected,
            lidar: state.lidar_model,
            lost_echoes: state.lidar_colors == LidarColorMode::Drop,
        }
    }

    /// What decides the strip of pictures.
    pub fn pictures(self) -> Pictures {
        (self.mode, self.source, self.hidden)
    }
}

/// The current frame for exact rays. Shapes of boxes stand on the road as it really lies; voxels alone are taken as
/// they are labelled, the road two bins lower.
pub fn march(scene: &Scene, shapes: bool) -> MarchScene {
    let frame = scene.frame();
    let options = MarchOptions {
        ground: if shapes {
            GroundHeight::Physical
        } else {
            GroundHeight::AsLabelled
        },
        boxes: shapes,
        lines: true,
        seed: scene.seed,
    };
    MarchScene::new(&frame.occupancy, &frame.layout, &frame.boxes, &options)
}

/// What one camera shows.
#[derive(Clone, Debug)]
pub struct CameraView {
    /// Index of the camera in the rig.
    pub camera: usize,
    /// What it shows.
    pub picture: Arc<CameraPicture>,
    /// The same in the colours of a mode, made beforehand so that the window need not.
    shown: Option<(CameraMode, Arc<ColorImage>)>,
}

impl CameraView {
    /// With the colours of a mode made now; which plane is shown is decided later.
    pub fn colored(mut self, mode: CameraMode) -> Self {
        if mode != CameraMode::Planes {
            self.shown = Some((mode, Arc::new(self.picture.colors(mode, 0.0))));
        }
        self
    }

    /// The picture in colours; `plane_m` is the depth of the plane that is shown.
    pub fn colors(&self, mode: CameraMode, plane_m: f64) -> Arc<ColorImage> {
        match &self.shown {
            Some((of, image)) if *of == mode => image.clone(),
            _ => Arc::new(self.picture.colors(mode, plane_m)),
        }
    }
}

/// A picture, as data.
#[derive(Clone, Debug)]
pub enum CameraPicture {
    /// Classes and depths.
    Maps(CameraMaps),
    /// Planes of classes.
    Planes(MultiPlaneImage),
    /// Boxes and lanes.
    Layout(PerspectiveMap),
    /// What a camera would see.
    Picture(CameraImage),
}

impl CameraPicture {
    /// The same as a picture of egui.
    fn colors(&self, mode: CameraMode, plane_m: f64) -> ColorImage {
        let (size, rgba) = self.rgba(mode, plane_m);
        ColorImage::from_rgba_unmultiplied(size, &rgba)
    }

    /// Width, height and RGBA; `plane_m` is the depth of the plane that is shown.
    pub fn rgba(&self, mode: CameraMode, plane_m: f64) -> ([usize; 2], Vec<u8>) {
        match self {
            Self::Maps(maps) => {
                let rgba = match mode {
                    CameraMode::Depth => depth_rgba(&maps.depth_m, DEPTH_M.0, DEPTH_M.1),
                    _ => semantic_rgba(maps, true),
                };
                ([maps.width, maps.height], rgba)
            }
            Self::Planes(image) => {
                let step_m = image.planes.depth_m(1) - image.planes.depth_m(0);
                let plane = ((plane_m - image.planes.near_m) / step_m).round().max(0.0) as u16;
                let last = image.planes.count.saturating_sub(1);
                ([image.width, image.height], plane_rgba(image, plane.min(last)))
            }
            Self::Layout(map) => ([map.width, map.height], perspective_rgba(map)),
            Self::Picture(image) => ([image.width, image.height], image.rgba.clone()),
        }
    }
}

/// A scene made ready for any number of cameras.
pub enum Prepared {
    /// Gaussians.
    Splats(GaussianCloud),
    /// Voxels and shapes.
    March(Box<MarchScene>),
    /// Classes of all voxels.
    Ids(RenderIds),
    /// Nothing to make ready.
    Layout,
    /// Materials, light and weather.
    Look(Box<Look>),
}

impl Prepared {
    /// Makes the current frame of a scene ready.
    pub fn new(scene: &Scene, mode: CameraMode, source: CameraSource) -> Self {
        let frame = scene.frame();
        match (mode, source) {
            (CameraMode::Semantic | CameraMode::Depth, CameraSource::Splats) => Self::Splats(
                GaussianCloud::from_grid_shell(&frame.occupancy, frame.layout.cells(), SHELL_LAYERS),
            ),
            (CameraMode::Semantic | CameraMode::Depth, source) => {
                Self::March(Box::new(march(scene, source == CameraSource::Shapes)))
            }
            (CameraMode::Planes, _) => Self::Ids(RenderIds::new(&frame.occupancy, frame.layout.cells())),
            (CameraMode::Layout, _) => Self::Layout,
            (CameraMode::Picture, _) => Self::Look(Box::new(Look::new(frame, &scene.rig, &scene.conditions))),
        }
    }

    /// True for what a graphics card can draw.
    pub fn suits_card(&self) -> bool {
        matches!(self, Self::Splats(_) | Self::Look(_))
    }

    /// Takes it up to a graphics card; false if the processor has to draw it.
    pub fn upload(&self, card: &mut Graphics) -> bool {
        match self {
            Self::Splats(cloud) => card.set_cloud(cloud),
            Self::Look(look) => card.set_look(look),
            _ => false,
        }
    }

    /// What camera `camera` of the scene's rig shows, drawn by the card that this was taken up to, if any. Panics if the
    /// rig has no such camera.
    pub fn view(
        &self,
        scene: &Scene,
        camera: usize,
        [width, height]: [u32; 2],
        quick: bool,
        mut card: Option<&mut Graphics>,
    ) -> CameraView {
        let (frame, of) = (scene.frame(), &scene.rig.cameras[camera]);
        let picture = match self {
            Self::Splats(cloud) => {
                let drawn = card.as_mut().and_then(|c| c.maps(of, [width, height]));
                let draw = || splat::render(cloud, of, width, height, &SplatOptions::default());
                CameraPicture::Maps(drawn.unwrap_or_else(draw))
            }
            Self::March(march) => {
                CameraPicture::Maps(march.render(of, width, height).into_camera_maps(&of.name))
            }
            Self::Ids(ids) => CameraPicture::Planes(mpi::render(ids, of, width, height, Planes::default())),
            Self::Layout => {
                let boxes = frame.boxes.values();
                CameraPicture::Layout(perspective::render(&frame.layout, boxes, of, width, height))
            }
            Self::Look(look) => {
                let quality = if quick { Quality::Preview } else { Quality::Full };
                let drawn = card.and_then(|c| c.picture(look, of, [width, height], quality));
                CameraPicture::Picture(drawn.unwrap_or_else(|| look.render(of, width, height, quality)))
            }
        };
        CameraView {
            camera,
            picture: Arc::new(picture),
            shown: None,
        }
    }
}
