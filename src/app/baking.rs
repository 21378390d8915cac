//! Gaussians in the background: a thread that lifts a scene to Gaussians, and a thread that draws them.

use std::sync::Arc;

use egui::ColorImage;
use glam::{DMat3, DQuat};

use runtime::guard::Panicked;
use runtime::worker::{Ctx, Product, Wake, Worker};
use scene::{Camera, Lens, Scene, SceneRev};
use sensors::bake::draw::PreparedGaussians;
use sensors::bake::{BakeOptions, bake_scene};
use viewport::ViewCamera;

/// A picture to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatViewpoint {
    /// Viewpoint, in the world.
    pub camera: ViewCamera,
    /// Width and height, px.
    pub size: [u32; 2],
}

/// Gaussians of a state, in the world.
#[derive(Clone)]
pub struct Baked {
    /// The state that they were made from, with its moment.
    pub of: SceneRev,
    /// Number of Gaussians.
    pub count: usize,
    ready: Arc<PreparedGaussians>,
}

enum BakingEvent {
    At(f32),
    Baked(Baked),
    Drawn(SplatViewpoint, ColorImage),
    GivenUp,
    Failed(Panicked),
}

struct Baker;

impl Product for Baker {
    type Request = Arc<Scene>;
    type Update = BakingEvent;

    fn make(&mut self, scene: &Arc<Scene>, ctx: &Ctx<'_, BakingEvent>) -> BakingEvent {
        let go_on = |share: f32| {
            ctx.tell(BakingEvent::At(share));
            !ctx.should_stop()
        };
        let in_world = scene.for_sensors();
        let Some(mut lifted) = bake_scene(&in_world, &BakeOptions::default(), &go_on) else {
            return BakingEvent::GivenUp;
        };
        lifted.place(&scene.frame().world_from_ego);
        BakingEvent::Baked(Baked {
            of: scene.rev,
            count: lifted.gaussians.len(),
            ready: Arc::new(PreparedGaussians::new(&lifted.gaussians)),
        })
    }

    fn reset(&mut self) {}

    fn given_up() -> BakingEvent {
        BakingEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> BakingEvent {
        BakingEvent::Failed(panic)
    }

    fn is_terminal(news: &BakingEvent) -> bool {
        !matches!(news, BakingEvent::At(_))
    }
}

struct GaussianRenderer;

impl Product for GaussianRenderer {
    type Request = (Baked, SplatViewpoint);
    type Update = BakingEvent;

    fn make(&mut self, (baked, seen): &(Baked, SplatViewpoint), _: &Ctx<'_, BakingEvent>) -> BakingEvent {
        let pixels = baked.ready.render(&camera_of(seen), seen.size);
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        let rgb: Vec<u8> = pixels.iter().flat_map(|p| p.map(byte)).collect();
        let size = seen.size.map(|n| n as usize);
        BakingEvent::Drawn(*seen, ColorImage::from_rgb(size, &rgb))
    }

    fn reset(&mut self) {}

    fn given_up() -> BakingEvent {
        BakingEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> BakingEvent {
        BakingEvent::Failed(panic)
    }

    fn is_terminal(_: &BakingEvent) -> bool {
        true
    }
}

/// The view as a camera.
fn camera_of(seen: &SplatViewpoint) -> Camera {
    let view = seen.camera.sane();
    let [right, up, ahead] = view.axes();
    let turn = DQuat::from_mat3(&DMat3::from_cols(right, -up, ahead));
    let [width, height] = seen.size.map(f64::from);
    let focal_px = height / 2.0 / (view.fov_y_rad / 2.0).tan();
    Camera {
        name: "VIEW".into(),
        width: seen.size[0],
        height: seen.size[1],
        focal_px: [focal_px; 2],
        center_px: [width / 2.0, height / 2.0],
        rotation_wxyz: [turn.w, turn.x, turn.y, turn.z],
        translation_m: view.eye_m().to_array(),
        lens: Lens::default(),
        shutter: None,
        carried: Default::default(),
    }
}

/// The two threads, and the newest results of both.
pub struct Baking {
    baker: Worker<Arc<Scene>, BakingEvent>,
    drawer: Worker<(Baked, SplatViewpoint), BakingEvent>,
    /// State that is being baked.
    pub busy: Option<SceneRev>,
    /// Share of it that is done, 0 to 1.
    pub share: f32,
    /// The newest Gaussians.
    pub baked: Option<Baked>,
    /// The last failure.
    pub problem: Option<String>,
    drawing: Option<SplatViewpoint>,
    wanted: Option<SplatViewpoint>,
    drawn: Option<(SplatViewpoint, ColorImage)>,
}

impl Baking {
    /// Starts the threads. Errors if the system gives none.
    pub fn spawn(wake: Wake) -> std::io::Result<Self> {
        Ok(Self {
            baker: Worker::start("baking", || Baker, wake.clone())?,
            drawer: Worker::start("splats", || GaussianRenderer, wake)?,
            busy: None,
            share: 0.0,
            baked: None,
            problem: None,
            drawing: None,
            wanted: None,
            drawn: None,
        })
    }

    /// Lifts a scene; takes a minute or two.
    pub fn bake(&mut self, scene: &Arc<Scene>) {
        (self.busy, self.share) = (Some(scene.rev), 0.0);
        self.problem = None;
        self.baker.submit(scene.clone());
    }

    /// Cancels the running bake.
    pub fn cancel(&mut self) {
        self.baker.cancel();
        self.busy = None;
    }

    /// Asks for a picture of the newest Gaussians. A newer request replaces one that is not begun yet.
    pub fn look(&mut self, seen: SplatViewpoint) {
        self.wanted = Some(seen);
        self.update();
    }

    /// Takes news from the threads. Returns a picture if there is a new one.
    pub fn update(&mut self) -> Option<(SplatViewpoint, ColorImage)> {
        let news: Vec<BakingEvent> = self.baker.updates().try_iter().map(|e| e.update).collect();
        for news in news {
            match news {
                BakingEvent::At(share) => self.share = share,
                BakingEvent::Baked(baked) if self.busy == Some(baked.of) => {
                    (self.baked, self.busy) = (Some(baked), None);
                    (self.drawing, self.drawn) = (None, None);
                }
                BakingEvent::Failed(panic) => (self.busy, self.problem) = (None, Some(panic.to_string())),
                _ => {}
            }
        }
        let drawn: Vec<BakingEvent> = self.drawer.updates().try_iter().map(|e| e.update).collect();
        for news in drawn {
            self.drawing = None;
            match news {
                BakingEvent::Drawn(seen, image) => self.drawn = Some((seen, image)),
                BakingEvent::Failed(panic) => self.problem = Some(panic.to_string()),
                _ => {}
            }
        }
        if let (None, Some(seen), Some(baked)) = (self.drawing, self.wanted.take(), &self.baked) {
            self.drawing = Some(seen);
            self.drawer.submit((baked.clone(), seen));
        }
        self.drawn.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use sensors::raycast::rays::CameraRays;

    /// The centre of the view is the centre of the picture, and up is up.
    #[test]
    fn the_view_is_that_camera() {
        let view = ViewCamera {
            target_m: DVec3::new(4.0, 2.0, 1.0),
            distance_m: 12.0,
            yaw_rad: 0.7,
            pitch_rad: -0.3,
            ..ViewCamera::default()
        };
        let seen = SplatViewpoint {
            camera: view,
            size: [320, 180],
        };
        let camera = camera_of(&seen);
        let rays = CameraRays::new(&camera, 320, 180);
        for p in [view.target_m, view.target_m + DVec3::new(0.5, -1.0, 1.5)] {
            let expected = view.project(p, [320, 180]).expect("in sight");
            let found = rays.project(p);
            assert!(
                (found.truncate() - expected).length() < 0.01,
                "{found} {expected}"
            );
        }
    }
}
