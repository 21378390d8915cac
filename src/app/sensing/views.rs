//! Camera views of one scene from one source.

use runtime::worker::Ctx;
use scene::Scene;
use sensors::cameras::{CameraSource, Card, Detail, PreparedSource, RenderContext, RenderOptions};
use sensors::pictures::appearance::Quality;

use super::SensingEvent;
use crate::camera_views::{CameraView, LARGE_SIZE, camera_input};
use crate::graphics::Graphics;

/// Views of one scene from one source, which is made ready when the first of them is asked for.
pub(super) struct Views<'a> {
    source: &'static dyn CameraSource,
    scene: &'a Scene,
    graphics: &'a mut Option<Option<Graphics>>,
    ready: Option<(PreparedSource<'a>, bool)>,
}

impl<'a> Views<'a> {
    pub(super) fn new(
        source: &'static dyn CameraSource,
        scene: &'a Scene,
        graphics: &'a mut Option<Option<Graphics>>,
    ) -> Self {
        Self {
            source,
            scene,
            graphics,
            ready: None,
        }
    }

    /// The view of one camera; `None` without such a camera, or where the picture is too large for the bounds.
    pub(super) fn view(&mut self, camera: usize, size: [u32; 2], quick: bool) -> Option<CameraView> {
        let (scene, source) = (self.scene, self.source);
        let graphics = &mut *self.graphics;
        let (ready, on_card) = self.ready.get_or_insert_with(|| {
            let ready = PreparedSource::new(source, &camera_input(scene, Detail::Live));
            let on_card = ready.upload_to(|| {
                let card = graphics.get_or_insert_with(Graphics::find).as_mut();
                card.map(|card| card as &mut dyn Card)
            });
            (ready, on_card)
        });
        let card = graphics.as_mut().and_then(Option::as_mut).filter(|_| *on_card);
        let options = RenderOptions {
            size,
            quality: if quick { Quality::Preview } else { Quality::Full },
        };
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
        let large = self.view(camera, LARGE_SIZE, false)?;
        let mut views = views.to_vec();
        *views.get_mut(place)? = large;
        Some(views)
    }
}
