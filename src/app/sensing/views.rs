//! Camera views of one scene from one source.

use runtime::worker::Ctx;
use scene::Scene;
use sensors::cameras::{
    CameraInput, CameraSource, Card, Detail, PreparedSource, RenderContext, RenderOptions,
};
use sensors::pictures::appearance::{AppearanceCache, Quality};
use sensors::splat::{PREVIEW_SIZE, VIEW_SIZE};

use super::SensingEvent;
use crate::camera_views::{CameraView, LARGE_SIZE, camera_input};
use crate::graphics::Graphics;

/// Views of one scene from one source, which is made ready when the first of them is asked for.
pub(super) struct Views<'a> {
    source: &'static dyn CameraSource,
    scene: &'a Scene,
    graphics: &'a mut Option<Option<Graphics>>,
    cache: &'a AppearanceCache,
    ready: Option<(PreparedSource<'a>, bool)>,
}

/// Size and effort of pictures: coarse ones, or those of a scene at rest.
pub(super) fn detail(quick: bool) -> ([u32; 2], Quality) {
    match quick {
        true => (PREVIEW_SIZE, Quality::Preview),
        false => (VIEW_SIZE, Quality::Full),
    }
}

impl<'a> Views<'a> {
    pub(super) fn new(
        source: &'static dyn CameraSource,
        scene: &'a Scene,
        graphics: &'a mut Option<Option<Graphics>>,
        cache: &'a AppearanceCache,
    ) -> Self {
        Self {
            source,
            scene,
            graphics,
            cache,
            ready: None,
        }
    }

    /// The view of one camera; `None` without such a camera, or where the picture is too large for the bounds.
    pub(super) fn view(&mut self, camera: usize, size: [u32; 2], quality: Quality) -> Option<CameraView> {
        let (scene, source, cache) = (self.scene, self.source, self.cache);
        let graphics = &mut *self.graphics;
        let (ready, on_card) = self.ready.get_or_insert_with(|| {
            let input = CameraInput {
                cache: Some(cache),
                ..camera_input(scene, Detail::Live)
            };
            let ready = PreparedSource::new(source, &input);
            let on_card = ready.upload_to(|| {
                let card = graphics.get_or_insert_with(Graphics::find).as_mut();
                card.map(|card| card as &mut dyn Card)
            });
            (ready, on_card)
        });
        let card = graphics.as_mut().and_then(Option::as_mut).filter(|_| *on_card);
        let options = RenderOptions { size, quality };
        let context = RenderContext {
            card: card.map(|card| card as &mut dyn Card),
            ..RenderContext::processor()
        };
        let picture = ready
            .render(scene.rig.cameras.get(camera)?, &options, context)
            .ok()?;
        Some(CameraView::new(camera, picture).colored(source))
    }

    /// `views` with that of `camera` rendered large; `None` if it is not among them, or if the work should stop.
    pub(super) fn with_large(
        &mut self,
        views: &[CameraView],
        camera: usize,
        ctx: &Ctx<'_, SensingEvent>,
    ) -> Option<Vec<CameraView>> {
        let place = views.iter().position(|v| v.camera == camera)?;
        if ctx.should_stop() {
            return None;
        }
        let large = self.view(camera, LARGE_SIZE, Quality::Full)?;
        let mut views = views.to_vec();
        *views.get_mut(place)? = large;
        Some(views)
    }
}
