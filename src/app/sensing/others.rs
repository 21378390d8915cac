//! Pictures of other sources than the strip's.

use runtime::worker::Ctx;
use scene::SceneRev;
use sensors::cameras::{SourceId, learned};

use super::senses::SensorCache;
use super::views::{Views, detail};
use super::{Haste, SensingEvent, SensingRequest};
use crate::camera_views::CameraView;

/// Renders the other sources that panes of single cameras show.
pub(super) fn other_sources(request: &SensingRequest, kept: &mut SensorCache, ctx: &Ctx<'_, SensingEvent>) {
    let SensingRequest {
        scene, wanted, haste, ..
    } = request;
    let preview = *haste != Haste::Rest;
    for (id, mask) in wanted.others.iter().filter(|(id, _)| *id != learned::ID) {
        let source = sensors::cameras::source(id).unwrap_or(&sensors::cameras::shapes::ShapeMaps);
        let mut of_scene = Views::new(source, scene, &mut kept.graphics, &kept.appearance);
        let is_known = |o: &&(SceneRev, SourceId, u32, _)| (o.0, o.1, o.2) == (scene.rev, id, mask);
        let known = kept.others.iter().find(is_known).map(|(.., views)| views.clone());
        let mut render = |quick: bool| -> Option<Vec<CameraView>> {
            let (size, quality) = detail(quick);
            let mut views = Vec::new();
            for i in (0..scene.rig.cameras.len().min(32)).filter(|i| mask >> i & 1 == 1) {
                if !quick && ctx.should_stop() {
                    return None;
                }
                views.push(of_scene.view(i, size, quality)?);
            }
            Some(views)
        };
        let views = match known {
            Some(views) => views,
            None => {
                if (preview || source.about().previews)
                    && let Some(views) = render(true)
                {
                    ctx.tell(SensingEvent::Other(scene.rev, id, views));
                }
                if preview {
                    continue;
                }
                let Some(views) = render(false) else { return };
                kept.others.retain(|(_, of, ..)| *of != id);
                kept.others.push((scene.rev, id, mask, views.clone()));
                views
            }
        };
        ctx.tell(SensingEvent::Other(scene.rev, id, views.clone()));
        if let Some(camera) = wanted.large_of(id)
            && let Some(views) = of_scene.with_large(&views, camera, ctx)
        {
            ctx.tell(SensingEvent::Other(scene.rev, id, views));
        }
    }
}
