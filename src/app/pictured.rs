//! The 3D view as a picture: what a camera at its viewpoint would see, made on a thread of its own. While the viewpoint or the
//! scene changes, small pictures follow; at rest comes one of all pixels.

use std::borrow::Cow;
use std::sync::Arc;

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use glam::DVec3;

use super::picture::RgbaPicture;
use anyhow::{Context as _, bail};
use runtime::guard::Panicked;
use runtime::worker::{Ctx, JobId, Product, Worker};
use scene::appearance::FAR_M;
use scene::resample::shared_in;
use scene::{BoxId, Camera, Class, Lattice, Scene, SceneBox, SceneRev, SensorRig};
use sensors::cameras::{CameraSource, bounds, pictures};
use sensors::pictures::appearance::{Appearance, AppearanceCache, CameraImage, Quality};
use viewport::{GROUND_TOP_M, ViewCamera};

/// Pixels of a picture while something moves.
const MOVING_PIXELS: f32 = 130_000.0;
/// Most pixels of a picture at rest.
const RESTING_PIXELS: f32 = 1_500_000.0;
/// Farthest place that is looked at, m: beyond [`FAR_M`] there is only sky.
const REACH_M: f64 = 0.75 * FAR_M as f64;
/// Number of the ego vehicle as a box of the picture.
const EGO: BoxId = BoxId(u32::MAX);

/// What decides a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PictureKey {
    rev: SceneRev,
    view: ViewCamera,
    size: [u32; 2],
    quality: Quality,
    ego: bool,
}

/// A request for a picture.
struct PictureRequest {
    scene: Arc<Scene>,
    camera: Camera,
    key: PictureKey,
}

/// News from the thread.
enum PictureEvent {
    Drawn(CameraImage),
    Failed(Panicked),
    GivenUp,
}

/// A picture and the texture that shows it.
struct ShownPicture {
    key: PictureKey,
    image: CameraImage,
    texture: TextureHandle,
}

/// Pictures of the 3D view.
#[derive(Default)]
pub struct PicturedView {
    worker: Option<Worker<PictureRequest, PictureEvent>>,
    running: Option<(JobId, PictureKey)>,
    shown: Option<ShownPicture>,
    scene: Option<Arc<Scene>>,
    /// A state of which no picture could be made.
    failed: Option<(SceneRev, String)>,
}

impl PicturedView {
    /// The newest picture for a pane of some pixels; asks for one of this scene and viewpoint if there is none. `None` if there
    /// is none yet, or [`can_show`] refuses the view. `moves` is true while something changes.
    pub fn picture(
        &mut self,
        ctx: &Context,
        scene: &Scene,
        view: &ViewCamera,
        (size_px, ego): ([u32; 2], bool),
        moves: bool,
    ) -> Option<TextureId> {
        self.take_news(ctx);
        if !can_show(scene, view) || self.problem(scene.rev).is_some() {
            return None;
        }
        let is_of_this = |key: &PictureKey| key.rev == scene.rev && key.view == *view && key.ego == ego;
        let here = self.shown.as_ref().filter(|shown| is_of_this(&shown.key));
        let rests = here.is_some_and(|shown| !moves || shown.key.quality == Quality::Full);
        let (pixels, quality) = match rests {
            true => (RESTING_PIXELS, Quality::Full),
            false => (MOVING_PIXELS, Quality::Play),
        };
        let key = PictureKey {
            rev: scene.rev,
            view: *view,
            size: fitted(size_px, pixels),
            quality,
            ego,
        };
        let is_there = self.shown.as_ref().is_some_and(|shown| shown.key == key);
        // A small picture is finished before the next one is asked for, a large one gives way.
        let is_busy = self
            .running
            .is_some_and(|(_, running)| running == key || running.quality == Quality::Play);
        if !is_there && !is_busy {
            self.ask(ctx, scene, key);
        }
        self.shown.as_ref().map(|shown| shown.texture.id())
    }

    fn ask(&mut self, ctx: &Context, scene: &Scene, key: PictureKey) {
        let Some(camera) = camera_of(&key.view, key.size) else {
            return;
        };
        if self.worker.is_none() {
            let wake = ctx.clone();
            let wake = Arc::new(move || wake.request_repaint());
            self.worker = Worker::start("3D pictures", Drawing::default, wake).ok();
        }
        if self.scene.as_ref().is_none_or(|kept| kept.rev != scene.rev) {
            self.scene = Some(Arc::new(scene.clone()));
        }
        if let (Some(worker), Some(scene)) = (&mut self.worker, &self.scene) {
            let request = PictureRequest {
                scene: scene.clone(),
                camera,
                key,
            };
            self.running = Some((worker.submit(request), key));
        }
    }

    fn take_news(&mut self, ctx: &Context) {
        let Some(worker) = &self.worker else { return };
        let news: Vec<_> = worker.updates().try_iter().collect();
        for event in news {
            // News of jobs that gave way to a newer one.
            let Some((_, key)) = self.running.take_if(|(id, _)| *id == event.id) else {
                continue;
            };
            match event.update {
                PictureEvent::Drawn(image) => {
                    let size = [image.width, image.height];
                    let colors = ColorImage::from_rgba_unmultiplied(size, &image.rgba);
                    let texture = match self.shown.take() {
                        Some(mut shown) => {
                            shown.texture.set(colors, TextureOptions::LINEAR);
                            shown.texture
                        }
                        None => ctx.load_texture("3D picture", colors, TextureOptions::LINEAR),
                    };
                    self.shown = Some(ShownPicture { key, image, texture });
                }
                PictureEvent::Failed(panic) => self.failed = Some((key.rev, panic.to_string())),
                PictureEvent::GivenUp => {}
            }
        }
    }

    /// Why no picture of the state could be made, if so.
    pub fn problem(&self, rev: SceneRev) -> Option<&str> {
        let failed = self.failed.as_ref().filter(|(of, _)| *of == rev);
        failed.map(|(_, problem)| problem.as_str())
    }

    /// The picture that is shown.
    pub fn image(&self) -> Option<&CameraImage> {
        self.shown.as_ref().map(|shown| &shown.image)
    }

    /// The picture at rest of a state from a viewpoint, once it is there.
    pub fn whole(&self, rev: SceneRev, view: &ViewCamera) -> Option<&CameraImage> {
        let shown = self.shown.as_ref()?;
        let is_it = shown.key.rev == rev && shown.key.view == *view && shown.key.quality == Quality::Full;
        is_it.then_some(&shown.image)
    }

    /// Forgets the picture, because another scene was opened.
    pub fn forget(&mut self) {
        (self.shown, self.scene, self.running, self.failed) = (None, None, None, None);
    }
}

/// A size of the same shape with at most so many pixels.
fn fitted([width, height]: [u32; 2], most: f32) -> [u32; 2] {
    let share = (most / (width as f32 * height as f32)).sqrt().min(1.0);
    [width, height].map(|side| ((side as f32 * share).round() as u32).max(1))
}

/// What the thread draws with.
#[derive(Default)]
struct Drawing {
    cache: AppearanceCache,
    ready: Option<(SceneRev, bool, Appearance)>,
}

impl Product for Drawing {
    type Request = PictureRequest;
    type Update = PictureEvent;

    fn make(&mut self, request: &PictureRequest, ctx: &Ctx<'_, PictureEvent>) -> PictureEvent {
        let PictureRequest { scene, camera, key } = request;
        let (_, _, appearance) = match self.ready.take() {
            Some(ready) if ready.0 == key.rev && ready.1 == key.ego => self.ready.insert(ready),
            _ => self
                .ready
                .insert((key.rev, key.ego, prepared(scene, key.ego, &self.cache))),
        };
        let goes_on = || key.quality == Quality::Play || !ctx.should_stop();
        match appearance.render_while(camera, key.size, key.quality, &goes_on) {
            Some(image) => PictureEvent::Drawn(image),
            None => PictureEvent::GivenUp,
        }
    }

    fn reset(&mut self) {
        *self = Self::default();
    }

    fn given_up() -> PictureEvent {
        PictureEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> PictureEvent {
        PictureEvent::Failed(panic)
    }

    fn is_terminal(_: &PictureEvent) -> bool {
        true
    }
}

/// True for views that pictures can show: in perspective, and no farther away than they reach.
pub fn can_show(scene: &Scene, view: &ViewCamera) -> bool {
    let map = scene.frame().extent();
    let half_m = f64::from(FAR_M);
    let vehicle_m = scene.frame().world_from_ego.translation_m.truncate();
    let is_seen = |corner_m: DVec3| (corner_m.truncate() - vehicle_m).abs().max_element() <= half_m;
    // Of large maps the part around the vehicle is drawn.
    let whole = is_seen(map.min_m()) && is_seen(map.max_m());
    let off_m = (view.target_m.truncate() - vehicle_m).abs().max_element();
    !view.ortho && view.distance_m < REACH_M && (whole || off_m < half_m / 2.0)
}

/// The viewpoint of the 3D view as a camera of pictures; `None` if it is orthographic.
fn camera_of(view: &ViewCamera, size: [u32; 2]) -> Option<Camera> {
    // The ground lies at its physical height in pictures, and lower among the voxels.
    let lift = DVec3::new(0.0, 0.0, -GROUND_TOP_M);
    let raised = ViewCamera {
        target_m: view.target_m + lift,
        ..*view
    };
    raised.to_camera(size)
}

/// The 3D view as a picture. Errors if it is one that [`can_show`] refuses, or does not fit into memory.
pub fn shot(
    scene: &Scene,
    view: &ViewCamera,
    size: [u32; 2],
    cache: &AppearanceCache,
) -> anyhow::Result<RgbaPicture> {
    bounds::check(size, pictures::PictureSource.about().bytes_per_pixel, 0)?;
    let camera =
        camera_of(view, size).context("pictures are made in perspective, and this view is orthographic")?;
    if !can_show(scene, view) {
        bail!("pictures reach {REACH_M} m and the map around the vehicle, and this view is farther away");
    }
    let [width, height] = size;
    let image = prepared(scene, true, cache).render(&camera, width, height, Quality::Full);
    Ok(RgbaPicture {
        width: image.width,
        height: image.height,
        rgba: image.rgba,
    })
}

/// A scene ready to be drawn, with or without the ego vehicle.
fn prepared(scene: &Scene, ego: bool, cache: &AppearanceCache) -> Appearance {
    let scene = match scene.frame().extent().lattice() == Lattice::OCC3D {
        true => Cow::Borrowed(scene),
        false => Cow::Owned(Scene::clone(&shared_in(&Arc::new(scene.clone()), Lattice::OCC3D))),
    };
    let placed = scene.with_rig_in_world();
    let mut frame = placed.frame().clone();
    if ego && let Some(b) = ego_box(&placed.rig) {
        Arc::make_mut(&mut frame).boxes.insert(EGO, b);
    }
    Appearance::with_cache(&frame, &placed.background, &placed.rig, &placed.conditions, cache)
}

/// The ego vehicle as a box; `None` without a size.
fn ego_box(rig: &SensorRig) -> Option<SceneBox> {
    let ahead = (rig.vehicle.rotation * DVec3::X).truncate();
    let b = SceneBox {
        id: EGO,
        class: Class::Car,
        center_m: rig.vehicle.apply(rig.ego_center_m.into()),
        size_m: rig.ego_size_m.into(),
        yaw_rad: ahead.to_angle(),
        velocity_mps: glam::DVec2::ZERO,
        label: Default::default(),
    };
    b.problem().is_none().then_some(b)
}
