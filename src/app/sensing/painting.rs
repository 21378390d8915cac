//! Learned camera pictures for the window: the weights, and the thread that paints.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Sensing;
use crate::camera_views::{CameraView, Wanted, paint_input};
use crate::painting::PaintWish;
use language::tf;
use runtime::guard::Panicked;
use runtime::worker::{Ctx, Product};
use scene::{Lattice, Scene, SceneRev};
use sensors::cameras::{CameraPicture, learned};
use sensors::pictures::appearance::CameraImage;
use sensors::pictures::painter::{CameraPainter, PaintError, PaintModel, PaintProgress};

/// A request to paint a scene.
pub(super) struct PaintingRequest {
    /// The scene, with its rig in the world.
    pub scene: Arc<Scene>,
    /// Settings of the painting.
    pub settings: Arc<PaintWish>,
    /// True if the scene is still changing. With the program's own weights such a painting goes on when a newer scene
    /// comes; otherwise the strip would get no pictures while the user drags. Public weights take too long for that.
    pub moving: bool,
}

/// Progress of a painting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaintStage {
    /// The weights are being opened.
    Opening,
    /// Steps done, and all steps.
    Step(usize, usize),
    /// The painting stops after its current step.
    Stopping,
}

/// News from the thread.
pub(super) enum PaintingEvent {
    /// Progress, and a picture in its current state.
    Stage(PaintStage, Option<CameraView>),
    /// The pictures of all cameras.
    Painted(SceneRev, Vec<CameraView>),
    /// The user stopped the painting.
    Stopped,
    /// No pictures could be made, for this reason.
    Problem(String),
    /// The painting was cancelled, because a newer scene waits.
    GivenUp,
}

impl Sensing {
    /// Requests learned pictures of a scene.
    pub(super) fn paint(&mut self, scene: Arc<Scene>, wanted: Wanted, moving: bool) {
        self.stop.store(false, Ordering::Relaxed);
        self.stopped = false;
        // Existing pictures are shown at once. Their state tells whether they are stale.
        if let Some((rev, views)) = self.painted.clone() {
            self.show_painted(rev, &views, Some(wanted));
        }
        self.painting.submit(PaintingRequest {
            scene,
            settings: self.paint.clone(),
            moving,
        });
    }

    /// Shows learned pictures in the strip or in panes.
    fn show_painted(&mut self, rev: SceneRev, views: &Arc<Vec<CameraView>>, wanted: Option<Wanted>) {
        self.version += 1;
        match wanted {
            Some(wanted) if wanted.source == learned::ID => {
                let shown = |v: &&CameraView| v.camera >= 32 || wanted.hidden >> v.camera & 1 == 0;
                let shown = views.iter().filter(shown).cloned().collect();
                self.cameras = Some((rev, wanted, Arc::new(shown)));
            }
            _ => {
                self.others.retain(|(_, of, _)| *of != learned::ID);
                self.others.push((rev, learned::ID, views.clone()));
            }
        }
    }

    /// Takes in the news of the painting thread.
    pub(super) fn drain_painting(&mut self) {
        let news = self.painting.updates().try_iter();
        let news: Vec<_> = news.filter(|event| event.id.0 > self.forgotten[1]).collect();
        for news in news.into_iter().map(|event| event.update) {
            let wanted = self.asked.map(|(_, wanted, _)| wanted);
            match news {
                PaintingEvent::Stage(stage, view) => {
                    self.stage = Some(stage);
                    // A fresh revision matches no scene, so the pictures stay stale while one of them changes.
                    let shown = self.painted.as_ref().map(|(_, views)| views);
                    if let Some(view) = view {
                        let shown = shown.or(self.cameras()).map_or(&[][..], |views| views);
                        let views = Arc::new(with(shown, view));
                        self.show_painted(SceneRev::fresh(), &views, wanted);
                    }
                }
                PaintingEvent::Painted(rev, views) => {
                    self.stage = None;
                    let views = Arc::new(views);
                    self.painted = Some((rev, views.clone()));
                    self.show_painted(rev, &views, wanted);
                }
                PaintingEvent::Stopped => (self.stage, self.stopped) = (None, true),
                PaintingEvent::GivenUp => self.stage = None,
                PaintingEvent::Problem(problem) => {
                    (self.stage, self.stopped) = (None, true);
                    self.problem = Some(tf!("No learned pictures: {problem}", problem = problem));
                }
            }
        }
    }
}

/// Painter of scenes, kept with the settings that it was made for.
pub(super) struct Painting {
    settings: Arc<PaintWish>,
    /// The weights of the settings; they take long to open.
    model: Option<PaintModel>,
    painter: Option<Box<dyn CameraPainter>>,
    /// Set when the user stops the painting.
    stop: Arc<AtomicBool>,
}

impl Painting {
    /// A painter that stops its current painting when `stop` is set.
    pub fn new(stop: Arc<AtomicBool>) -> Self {
        Self {
            settings: Arc::default(),
            model: None,
            painter: None,
            stop,
        }
    }

    /// The painter for some settings. Calls `opens` before weights are opened.
    fn painter(
        &mut self,
        settings: &Arc<PaintWish>,
        opens: impl FnOnce(),
    ) -> Result<&mut dyn CameraPainter, String> {
        if self.settings.weights != settings.weights {
            self.model = None;
        }
        if *self.settings != **settings {
            self.settings = settings.clone();
            self.painter = None;
        }
        let painter = match self.painter.take() {
            Some(painter) => painter,
            None => {
                let model = match self.model.take() {
                    Some(model) => model,
                    None => {
                        opens();
                        settings.model().map_err(|e| match e {
                            PaintError::Network(problem) => problem,
                            e => e.to_string(),
                        })?
                    }
                };
                settings.with(self.model.insert(model).clone()).painter(true)
            }
        };
        Ok(&mut **self.painter.insert(painter))
    }
}

impl Product for Painting {
    type Request = PaintingRequest;
    type Update = PaintingEvent;

    fn make(&mut self, request: &PaintingRequest, ctx: &Ctx<'_, PaintingEvent>) -> PaintingEvent {
        let stop = self.stop.clone();
        let goes_on = request.moving && !request.settings.is_public();
        let opens = || ctx.tell(PaintingEvent::Stage(PaintStage::Opening, None));
        let painter = match self.painter(&request.settings, opens) {
            Ok(painter) => painter,
            Err(problem) => return PaintingEvent::Problem(problem),
        };
        let scene = request.scene.in_lattice(Lattice::OCC3D);
        let painted = painter.paint(&paint_input(&scene), &mut |progress| {
            let PaintProgress { step, steps, news } = progress;
            ctx.tell(PaintingEvent::Stage(
                PaintStage::Step(step, steps),
                news.map(|(camera, image)| view(camera, image)),
            ));
            match stop.load(Ordering::Relaxed) || (ctx.should_stop() && !goes_on) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        match painted {
            Ok(images) => {
                let views = images
                    .iter()
                    .enumerate()
                    .map(|(camera, image)| view(camera, image));
                PaintingEvent::Painted(request.scene.rev, views.collect())
            }
            Err(PaintError::Stopped) if stop.load(Ordering::Relaxed) => PaintingEvent::Stopped,
            Err(PaintError::Stopped) => PaintingEvent::GivenUp,
            Err(error) => PaintingEvent::Problem(error.to_string()),
        }
    }

    fn reset(&mut self) {
        (self.painter, self.model) = (None, None);
    }

    fn given_up() -> PaintingEvent {
        PaintingEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> PaintingEvent {
        PaintingEvent::Problem(panic.to_string())
    }

    fn is_terminal(news: &PaintingEvent) -> bool {
        !matches!(news, PaintingEvent::Stage(..))
    }
}

fn view(camera: usize, image: &CameraImage) -> CameraView {
    CameraView::new(camera, CameraPicture::Picture(image.clone())).colored(&learned::Learned)
}

/// The pictures with one camera's picture replaced or added, in the order of the rig.
pub(super) fn with(views: &[CameraView], view: CameraView) -> Vec<CameraView> {
    let mut views = views.to_vec();
    match views.binary_search_by_key(&view.camera, |v| v.camera) {
        Ok(at) => views[at] = view,
        Err(at) => views.insert(at, view),
    }
    views
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::path::Path;

    use super::*;

    #[test]
    fn weights_are_opened_once_whatever_else_changes() {
        let mut painting = Painting::new(Arc::default());
        let mut opens = |weights: &str, steps: usize| {
            let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/stable");
            let wish = PaintWish {
                weights: Some(all.join(weights)),
                steps: Some(steps),
                ..PaintWish::default()
            };
            let opened = Cell::new(false);
            let painter = painting.painter(&Arc::new(wish), || opened.set(true));
            assert!(painter.is_ok(), "{weights}");
            opened.get()
        };
        assert!(opens("sd15", 3));
        assert!(!opens("sd15", 3) && !opens("sd15", 5));
        assert!(opens("sd21", 5) && opens("sd15", 5));
    }
}
