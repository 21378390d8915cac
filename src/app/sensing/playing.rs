//! Pictures of the cameras while a clip plays.

use std::time::Instant;

use runtime::worker::Ctx;
use sensors::pictures::appearance::Quality;
use sensors::splat::PREVIEW_SIZE;

use super::reel::moment;
use super::senses::SensorCache;
use super::views::Views;
use super::{SensingEvent, SensingRequest};
use crate::camera_views::CameraView;

/// Size of the large picture while a clip plays.
pub(super) const PLAYING_SIZE: [u32; 2] = [480, 270];
/// Most time for the pictures of one moment while a clip plays; those that are left keep an earlier moment and come next.
const PLAYING_S: f64 = 0.1;
/// Time that a small picture takes, s: none is begun that would come too late.
const SMALL_S: f64 = 0.03;
/// Moments after which a small picture is made even if there is no time for it.
const LONGEST_WAIT: u32 = 4;

/// Pictures on screen while a clip plays.
#[derive(Default)]
pub(super) struct Playing {
    views: Vec<CameraView>,
    /// Number of the camera whose turn comes next.
    next: usize,
    /// Moments without a new small picture.
    waited: u32,
}

/// Shows pictures of the strip while a clip plays: those of this moment that were made before; that of the camera shown large at
/// every moment; the others in turns as far as there is time.
pub(super) fn play(request: &SensingRequest, kept: &mut SensorCache, ctx: &Ctx<'_, SensingEvent>) {
    let SensingRequest { scene, wanted, .. } = request;
    let (source, key) = (wanted.camera_source(), wanted.pictures());
    let begun = Instant::now();
    let count = scene.rig.cameras.len();
    let is_shown = |i: &usize| *i >= 32 || wanted.hidden >> i & 1 == 0;
    let state = scene.content();
    let before = kept.playing.take();
    let before = before.filter(|(of, by, _)| (*of, *by) == (state, key));
    let same_state = kept.rested == Some(state);
    let at_rest = kept.views.as_ref();
    let at_rest = at_rest.filter(|((_, by), _)| same_state && *by == key);
    let mut playing = match before {
        Some((.., playing)) => playing,
        None => Playing {
            views: at_rest.map_or_else(Vec::new, |(_, views)| views.clone()),
            ..Playing::default()
        },
    };
    let (at, of) = (moment(scene.time_s()), (state, source.id()));
    let mut of_scene = Views::new(source, scene, &mut kept.graphics, &kept.appearance);
    let reel = &mut kept.pictures;
    let large = wanted.large_of(source.id()).filter(is_shown);
    let mut missing = Vec::new();
    let from = playing.next;
    for camera in (0..count).map(|i| (from + i) % count.max(1)).filter(is_shown) {
        let known = reel
            .get(&of, at, camera)
            .filter(|view| Some(camera) != large || view.is_wide(PLAYING_SIZE[0]));
        match known {
            // (the colours of classes may have changed since)
            Some(view) => playing.put(view.clone().colored(source)),
            None if Some(camera) == large => missing.insert(0, camera),
            None => missing.push(camera),
        }
    }
    playing.waited += 1;
    for camera in missing {
        let is_large = Some(camera) == large;
        let is_late = begun.elapsed().as_secs_f64() + SMALL_S > PLAYING_S;
        if !is_large && is_late && playing.waited <= LONGEST_WAIT {
            break;
        }
        let size = if is_large { PLAYING_SIZE } else { PREVIEW_SIZE };
        let Some(view) = of_scene.view(camera, size, Quality::Play) else {
            continue;
        };
        if let Some(bytes) = view.bytes() {
            reel.put(of, (at, camera), view.clone(), bytes);
        }
        playing.put(view);
        if !is_large {
            (playing.next, playing.waited) = (camera + 1, 0);
        }
    }
    ctx.tell(SensingEvent::Cameras(scene.rev, *wanted, playing.views.clone()));
    kept.playing = Some((state, key, playing));
}

impl Playing {
    fn put(&mut self, view: CameraView) {
        match self.views.iter_mut().find(|v| v.camera == view.camera) {
            Some(old) => *old = view,
            None => {
                self.views.push(view);
                self.views.sort_by_key(|v| v.camera);
            }
        }
    }
}
