//! Pictures of the cameras while a clip plays.

use std::time::Instant;

use runtime::worker::Ctx;
use sensors::splat::{PREVIEW_SIZE, VIEW_SIZE};

use super::views::Views;
use super::{SensingEvent, SensingRequest, SensorCache};
use crate::camera_views::CameraView;

/// Most time for the pictures of one moment while a clip plays; those that are left keep an earlier moment and come next.
const PLAYING_S: f64 = 0.1;

/// Renders pictures of the strip while a clip plays: that of the camera shown large at every moment, the others in turns as far as
/// there is time.
pub(super) fn play(request: &SensingRequest, kept: &mut SensorCache, ctx: &Ctx<'_, SensingEvent>) {
    let SensingRequest { scene, wanted, .. } = request;
    let (source, key) = (wanted.camera_source(), wanted.pictures());
    let begun = Instant::now();
    let count = scene.rig.cameras.len();
    let is_shown = |i: &usize| *i >= 32 || wanted.hidden >> i & 1 == 0;
    let state = scene.content();
    let before = kept
        .playing
        .take()
        .filter(|(of, by, ..)| (*of, *by) == (state, key));
    let same_state = kept.rested == Some(state);
    let at_rest = kept
        .views
        .as_ref()
        .filter(|((_, by), _)| same_state && *by == key);
    let (mut views, mut next) = match before {
        Some((.., views, next)) => (views, next),
        None => (at_rest.map_or_else(Vec::new, |(_, views)| views.clone()), 0),
    };
    let large = wanted.large_of(source.id()).filter(is_shown);
    let others = (0..count).map(|i| (next + i) % count.max(1));
    let turns: Vec<usize> = others.filter(|i| is_shown(i) && Some(*i) != large).collect();
    let mut of_scene = Views::new(source, scene, &mut kept.graphics);
    let mut put = |view: CameraView| match views.iter_mut().find(|v| v.camera == view.camera) {
        Some(old) => *old = view,
        None => {
            views.push(view);
            views.sort_by_key(|v| v.camera);
        }
    };
    if let Some(view) = large.and_then(|camera| of_scene.view(camera, VIEW_SIZE, true)) {
        put(view);
    }
    for (done, camera) in turns.into_iter().enumerate() {
        let is_late = begun.elapsed().as_secs_f64() > PLAYING_S;
        if is_late && (large.is_some() || done > 0) {
            break;
        }
        let Some(view) = of_scene.view(camera, PREVIEW_SIZE, true) else {
            break;
        };
        put(view);
        next = camera + 1;
    }
    ctx.tell(SensingEvent::Cameras(scene.rev, *wanted, views.clone()));
    kept.playing = Some((state, key, views, next));
}
