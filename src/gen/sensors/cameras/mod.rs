//! Camera sources: ways to make camera pictures of a scene. The window, the export and the command line share one table.
//!
//! A new source is one file with a type that implements [`CameraSource`], and one line in [`all`].

pub mod bounds;
pub mod layout;
pub mod learned;
mod marched;
pub mod normals;
pub mod perceived;
mod picture;
pub mod pictures;
pub mod planes;
pub mod shapes;
pub mod splats;
pub mod told;
mod view;
pub mod voxels;

pub use bounds::CameraError;
pub use marched::march_scene;
pub use picture::{CameraPicture, DEPTH_M};
pub use view::{Knob, SourceId, SourceView, ViewId};

use rayon::prelude::*;

use crate::pictures::appearance::{Appearance, AppearanceCache, CameraImage, Quality};
use crate::pictures::march::GroundHeight;
use crate::pictures::painter::PaintWith;
use crate::splat::cloud::GaussianCloud;
use scene::Conditions;
use scene::{Background, Camera, CameraMaps, Frame, SensorRig};

/// Every source, in the order of menus: sources of the same view follow each other.
pub fn all() -> &'static [&'static dyn CameraSource] {
    &[
        &splats::Splats,
        &voxels::VoxelCameraSource,
        &shapes::ShapeMaps,
        &told::TruthCameraSource,
        &pictures::PictureSource,
        &learned::Learned,
        &perceived::PerceivedClasses,
        &planes::PlaneStacks,
        &layout::LayoutMaps,
        &normals::Normals,
    ]
}

/// Every view, in the order of menus.
pub fn views() -> Vec<SourceView> {
    let mut views: Vec<SourceView> = Vec::new();
    for view in all().iter().flat_map(|s| s.views()) {
        if views.iter().all(|v| v.id != view.id) {
            views.push(*view);
        }
    }
    views
}

/// The sources that give a view, in the order of menus.
pub fn sources_of(view: ViewId) -> Vec<&'static dyn CameraSource> {
    let gives = |s: &&&'static dyn CameraSource| s.views().iter().any(|v| v.id == view);
    all().iter().filter(gives).copied().collect()
}

/// The source that gives a view: the preferred one if it does, else the first that does.
pub fn source_of(view: ViewId, preferred: SourceId) -> &'static dyn CameraSource {
    let sources = sources_of(view);
    let chosen = sources.iter().find(|s| s.id() == preferred).or(sources.first());
    chosen.copied().unwrap_or(&shapes::ShapeMaps)
}

/// The source of that name.
pub fn source(id: SourceId) -> Option<&'static dyn CameraSource> {
    all().iter().find(|s| s.id() == id).copied()
}

/// Parts of a scene. A source names those that its pictures depend on, besides rig and seed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The voxels.
    pub occupancy: bool,
    /// Map layers, lines, relief.
    pub layout: bool,
    /// The boxes.
    pub boxes: bool,
    /// Scenery beside the roads, apart from its voxels.
    pub background: bool,
    /// Time of day and weather.
    pub conditions: bool,
}

impl Needs {
    /// No part of a scene.
    pub const NONE: Self = Self {
        occupancy: false,
        layout: false,
        boxes: false,
        background: false,
        conditions: false,
    };
}

/// Which part of the scene is prepared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// The visible part, for the window.
    Live,
    /// The whole scene, for files.
    #[default]
    Full,
}

/// Input that pictures are made from.
#[derive(Clone, Copy, Debug)]
pub struct CameraInput<'a> {
    /// Occupancy, layout, boxes and the pose in the world.
    pub frame: &'a Frame,
    /// The cameras and the size of the ego vehicle.
    pub rig: &'a SensorRig,
    /// Scenery beside the roads.
    pub background: &'a Background,
    /// Time, weather, and the seed that varies shapes and textures.
    pub conditions: Conditions,
    /// Part of the scene that is made ready.
    pub detail: Detail,
    /// Networks that paint learned pictures; the weights that ship if `None`.
    pub paint: Option<&'a PaintWith>,
    /// Parts of the moment before that the next one shares; `None` if all are made anew.
    pub cache: Option<&'a AppearanceCache>,
}

impl CameraInput<'_> {
    /// The frame ready for the analytic renderer.
    pub fn appearance(&self) -> Appearance {
        let own = AppearanceCache::default();
        let cache = self.cache.unwrap_or(&own);
        Appearance::with_cache(self.frame, self.background, self.rig, &self.conditions, cache)
    }
}

/// Options of rendering one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// Width and height in pixels; 0 gives an empty picture.
    pub size: [u32; 2],
    /// Effort for the picture, if a source has more than one.
    pub quality: Quality,
}

/// A graphics card that can draw instead of the processor. If it cannot, the method returns false or `None`.
pub trait Card {
    /// Uploads a cloud; false if the processor has to draw it.
    fn set_cloud(&mut self, cloud: &GaussianCloud) -> bool;
    /// Maps of the cloud that was set last; `None` if the processor has to draw them.
    fn maps(&mut self, camera: &Camera, size: [u32; 2]) -> Option<CameraMaps>;
    /// Uploads an appearance; false if the processor has to draw it.
    fn set_appearance(&mut self, appearance: &Appearance) -> bool;
    /// A picture of `appearance`, which was uploaded last; `None` if the processor has to draw it.
    fn picture(
        &mut self,
        appearance: &Appearance,
        camera: &Camera,
        size: [u32; 2],
        quality: Quality,
    ) -> Option<CameraImage>;
}

/// Resources that a rendering may use, and a check whether it is still wanted.
pub struct RenderContext<'a> {
    /// The card that the scene was uploaded to; `None` if the processor draws.
    pub card: Option<&'a mut dyn Card>,
    /// True once the picture is no longer wanted.
    pub cancelled: &'a dyn Fn() -> bool,
}

impl RenderContext<'_> {
    /// A context in which the processor draws and nothing is cancelled.
    pub fn processor() -> Self {
        Self {
            card: None,
            cancelled: &|| false,
        }
    }
}

/// Description of a source and its needs.
#[derive(Debug)]
pub struct CameraSourceDescription {
    /// Its name, unique in the table.
    pub id: SourceId,
    /// Name on a button.
    pub title: &'static str,
    /// Description for the tip of the button.
    pub hint: &'static str,
    /// The views that one rendering gives, at least one.
    pub views: &'static [SourceView],
    /// Parts of the scene that decide its pictures.
    pub needs: Needs,
    /// Height at which its pictures show the ground.
    pub ground: GroundHeight,
    /// Name of its time in the report of `sceneloom render`.
    pub report_key: &'static str,
    /// True if the window shows a coarse picture first, because a full one takes its time.
    pub previews: bool,
    /// Memory that rendering one picture and writing its files take at most, bytes per pixel.
    pub bytes_per_pixel: u64,
}

/// One way to make camera pictures of a scene.
pub trait CameraSource: Sync {
    /// Description of the source and its needs.
    fn about(&self) -> &'static CameraSourceDescription;

    /// Its name, unique in the table.
    fn id(&self) -> SourceId {
        self.about().id
    }

    /// The views that one rendering gives, at least one.
    fn views(&self) -> &'static [SourceView] {
        self.about().views
    }

    /// Makes a scene ready for any number of cameras.
    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a>;
}

/// A scene made ready by one source.
pub trait PreparedCameras: Sync {
    /// True if a graphics card can draw the scene.
    fn suits_card(&self) -> bool {
        false
    }

    /// Uploads the scene to a graphics card; false if the processor has to draw it.
    fn upload(&self, _card: &mut dyn Card) -> bool {
        false
    }

    /// Draws the picture of a camera. Called by [`PreparedSource::render`], which checks size and cancellation first. Errors if
    /// a network refuses its input.
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError>;
}

/// A source with a scene made ready, which renders pictures.
pub struct PreparedSource<'a> {
    source: &'static dyn CameraSource,
    scene: Box<dyn PreparedCameras + 'a>,
}

impl<'a> PreparedSource<'a> {
    /// Makes a scene ready.
    pub fn new(source: &'static dyn CameraSource, input: &CameraInput<'a>) -> Self {
        Self {
            source,
            scene: source.prepare(input),
        }
    }

    /// Uploads the scene to the card that `find` returns; `find` is called only if a card can draw the scene. True if
    /// the card will draw.
    pub fn upload_to<'c>(&self, find: impl FnOnce() -> Option<&'c mut (dyn Card + 'c)>) -> bool {
        self.scene.suits_card() && find().is_some_and(|card| self.scene.upload(card))
    }

    /// Renders the picture of a camera. Errors if the picture is larger than [`bounds`] allow, is no longer wanted, or
    /// a network refuses its input.
    pub fn render(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        context: RenderContext<'_>,
    ) -> Result<CameraPicture, CameraError> {
        bounds::check(options.size, self.source.about().bytes_per_pixel, 0)?;
        if (context.cancelled)() {
            return Err(CameraError::Cancelled);
        }
        self.scene.draw(camera, options, context.card)
    }

    /// Best number of cameras for one call of [`Self::render_all`], at least one.
    pub fn side_by_side(&self, options: &RenderOptions) -> usize {
        bounds::side_by_side(options.size, self.source.about().bytes_per_pixel)
    }

    /// Renders the pictures of these cameras, by the card if there is one, else by the processor side by side: one
    /// small picture does not fill the cores. Errors as [`Self::render`].
    pub fn render_all(
        &self,
        cameras: &[Camera],
        options: &RenderOptions,
        card: Option<&mut dyn Card>,
    ) -> Result<Vec<CameraPicture>, CameraError> {
        let Some(card) = card else {
            let processor = |c| self.render(c, options, RenderContext::processor());
            return cameras.par_iter().map(processor).collect();
        };
        let mut on_card = |camera| {
            let context = RenderContext {
                card: Some(&mut *card),
                ..RenderContext::processor()
            };
            self.render(camera, options, context)
        };
        cameras.iter().map(&mut on_card).collect()
    }
}

#[cfg(test)]
mod tests;
