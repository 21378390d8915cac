//! Pictures by the picture networks for the window: which weights, how far the painting is, and the painter itself.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::camera_views::{CameraView, camera_input};
use nets::picture::PictureNets;
use scene::Scene;
use sensors::appearance::CameraImage;
use sensors::cameras::{CameraError, CameraPicture, Detail, learned};
use sensors::painter::{PaintOptions, Painter, Progress};

/// How the user wants learned pictures to be painted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PaintSettings {
    /// Folder of the weights; those that ship with the program if none.
    pub weights: Option<PathBuf>,
    /// Steps from noise to a picture.
    pub steps: usize,
    /// How much more than in training the pictures obey the voxels.
    pub guidance: f64,
}

impl Default for PaintSettings {
    fn default() -> Self {
        let PaintOptions { steps, guidance } = PaintOptions::default();
        Self {
            weights: None,
            steps,
            guidance,
        }
    }
}

impl PaintSettings {
    /// Steps that can be chosen.
    pub const STEPS: std::ops::RangeInclusive<usize> = 1..=50;
    /// Guidance that can be chosen.
    pub const GUIDANCE: std::ops::RangeInclusive<f64> = 1.0..=6.0;

    /// With numbers that a painter takes, whatever a file of settings said.
    fn options(&self) -> PaintOptions {
        let guidance = match self.guidance.is_finite() {
            true => self
                .guidance
                .clamp(*Self::GUIDANCE.start(), *Self::GUIDANCE.end()),
            false => PaintOptions::default().guidance,
        };
        PaintOptions {
            steps: self.steps.clamp(*Self::STEPS.start(), *Self::STEPS.end()),
            guidance,
        }
    }
}

/// The painter, with what it was made for.
#[derive(Default)]
pub(super) struct Painting {
    settings: Arc<PaintSettings>,
    painter: Option<Painter>,
}

/// What comes of a painting.
pub(super) enum Painted {
    /// The pictures of all cameras that are wanted.
    Done(Vec<CameraView>),
    /// It was stopped.
    Stopped,
    /// There is none; why.
    Problem(String),
}

impl Painting {
    /// True if other settings than before are to be used from now on.
    pub fn set(&mut self, settings: &Arc<PaintSettings>) -> bool {
        let other = *self.settings != **settings;
        if other {
            self.settings = settings.clone();
            self.painter = None;
        }
        other
    }

    /// Paints the cameras of a scene. `tell` hears of every step, and how a picture looks by then; `stops` is asked after every
    /// step.
    pub fn paint(
        &mut self,
        scene: &Scene,
        wanted: impl Fn(usize) -> bool,
        mut tell: impl FnMut((usize, usize), Option<CameraView>),
        stops: impl Fn() -> bool,
    ) -> Painted {
        if self.painter.is_none() {
            let nets = match &self.settings.weights {
                None => PictureNets::bundled(),
                Some(folder) => PictureNets::from_dir(folder).map(Arc::new),
            };
            match nets {
                Ok(nets) => self.painter = Some(Painter::new(nets, self.settings.options())),
                Err(error) => return Painted::Problem(error.to_string()),
            }
        }
        let Some(painter) = &mut self.painter else {
            return Painted::Stopped;
        };
        let painted = painter.paint(&camera_input(scene, Detail::Live), |progress| {
            let Progress { step, steps, news } = progress;
            let news = news.filter(|(camera, _)| wanted(*camera));
            tell((step, steps), news.map(|(camera, image)| view(camera, image)));
            match stops() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        match painted {
            Ok(images) => {
                let images = images.iter().enumerate().filter(|(camera, _)| wanted(*camera));
                Painted::Done(images.map(|(camera, image)| view(camera, image)).collect())
            }
            Err(CameraError::Cancelled) => Painted::Stopped,
            Err(error) => Painted::Problem(error.to_string()),
        }
    }
}

fn view(camera: usize, image: &CameraImage) -> CameraView {
    CameraView::new(camera, CameraPicture::Picture(image.clone())).colored(&learned::Learned)
}

/// Pictures with that of one camera exchanged; the order stays that of the rig.
pub(super) fn with(views: Option<&[CameraView]>, view: CameraView) -> Vec<CameraView> {
    let mut views = views.map(<[_]>::to_vec).unwrap_or_default();
    match views.binary_search_by_key(&view.camera, |v| v.camera) {
        Ok(at) => views[at] = view,
        Err(at) => views.insert(at, view),
    }
    views
}
