//! Camera pictures by the picture networks: all cameras of a rig at once, and after an edit only what it changed.

mod control_pictures;
mod mask;
mod model;
mod noise;
mod public;
#[cfg(test)]
mod public_tests;
mod ring;
mod seen;
mod surfaces;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;

use rayon::prelude::*;

use crate::pictures::appearance::CameraImage;
use diffusion::inversion::Trajectory;
pub use model::{CameraPainter, PaintModel, PaintWith};
use nets::ModelError;
use nets::picture::{self, Motion, PictureNets, PictureSampling, RingSize, WarpedLatents};
pub use noise::NoisePrior;
use ring::Ring;
pub use ring::native_px;
use scene::{Background, Conditions, Frame, SensorRig};
use seen::RingFrame;
pub use stable::config::SchedulerKind;

/// Number of states whose pictures are kept, so that a state painted before is there again at once.
const KEPT: usize = 6;

/// Options of painting.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintOptions {
    /// Steps from noise to a picture, 1 to 1000.
    pub steps: usize,
    /// Guidance: how much more than in training the pictures follow the condition; 1 is as in training.
    pub guidance: f64,
    /// Shipped weights only: where the noise of a frame comes from.
    pub noise: NoisePrior,
    /// Shipped weights only: true if pictures painted before are an input, where the cameras stood near.
    pub hears_before: bool,
    /// Public weights only: how much of the rendered picture is painted anew, 0 (nothing) to 1 (all).
    pub strength: f64,
    /// Public weights only: width of a picture, px.
    pub width_px: usize,
    /// Public weights only: what the pictures show, in words. Time, weather and camera are added.
    pub prompt: String,
    /// Public weights only: what they do not show, in words.
    pub negative: String,
    /// Public weights only: how a step is made from a prediction; `None` takes the choice of their folder.
    pub scheduler: Option<SchedulerKind>,
}

impl PaintOptions {
    /// Usual options for public weights.
    pub fn public() -> Self {
        Self {
            steps: 20,
            guidance: 7.5,
            ..Self::default()
        }
    }
}

impl Default for PaintOptions {
    /// Options that were measured best: `training/weights/pictures/CARD.md`.
    fn default() -> Self {
        Self {
            steps: 4,
            guidance: 2.0,
            noise: NoisePrior::default(),
            hears_before: true,
            strength: 0.6,
            width_px: 512,
            prompt: String::new(),
            negative: String::new(),
            scheduler: None,
        }
    }
}

/// Input that pictures are painted from.
#[derive(Clone, Copy, Debug)]
pub struct PaintInput<'a> {
    /// Occupancy, layout and boxes.
    pub frame: &'a Frame,
    /// The cameras.
    pub rig: &'a SensorRig,
    /// Scenery beside the roads.
    pub background: &'a Background,
    /// Time and weather, and the seed that noise is drawn from.
    pub conditions: Conditions,
}

/// Error of painting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PaintError {
    /// The networks could not be read or refuse their input.
    #[error("picture networks: {0}")]
    Network(String),
    /// The watcher stopped the painting.
    #[error("stopped")]
    Stopped,
}

/// Progress of a painting.
#[derive(Debug)]
pub struct PaintProgress<'a> {
    /// Steps done; 0 before the first.
    pub step: usize,
    /// All steps.
    pub steps: usize,
    /// Index in the rig of a camera with a new preview, and its picture so far.
    pub news: Option<(usize, &'a CameraImage)>,
}

/// A painter that remembers its recent pictures.
pub struct Painter {
    nets: Arc<PictureNets>,
    options: PaintOptions,
    /// True if pictures are made of the steps too.
    previews: bool,
    /// Pictures of recent states, the newest last.
    kept: VecDeque<PaintedRing>,
}

/// Pictures of one state.
struct PaintedRing {
    seen: RingFrame,
    trajectory: Trajectory,
    /// Noise that the trajectory began with, and the number of frames of a drive that came before.
    noise: Vec<f32>,
    number: u32,
    /// Pictures in the ring's order.
    images: Vec<Arc<CameraImage>>,
}

impl Painter {
    /// Distance from a change at which pixels stay as they were, to the bit, px.
    pub const RIM_PX: usize = mask::RIM_PX;

    /// A painter with these networks.
    pub fn new(nets: Arc<PictureNets>, options: PaintOptions) -> Self {
        Self {
            nets,
            options,
            previews: true,
            kept: VecDeque::new(),
        }
    }

    /// Turns previews off, for files: no picture is made of the steps, which saves a decoding each.
    #[must_use]
    pub fn without_previews(self) -> Self {
        Self {
            previews: false,
            ..self
        }
    }

    /// Paints pictures of all cameras of the rig, in its order, each of some 256x144 px. Pictures of a state that was
    /// painted before are returned again. If only the scene differs from a state painted before, only pixels that show
    /// the difference are painted, and a rim of [`Painter::RIM_PX`] around them; all others stay as they were, to the
    /// bit. `watch` is told of every step and may stop the painting. Errors if it did, if there are more than 64
    /// cameras, or if the networks refuse their input.
    pub fn paint(
        &mut self,
        input: &PaintInput<'_>,
        mut watch: impl FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<Arc<CameraImage>>, PaintError> {
        let Some(ring) = Ring::of(&input.rig.cameras)? else {
            return Ok(Vec::new());
        };
        let seen = RingFrame::from_input(input, &ring);
        if let Some(at) = self.kept.iter().position(|p| p.seen == seen)
            && let Some(painted) = self.kept.remove(at)
        {
            let images = ring.in_rig_order(&painted.images);
            self.kept.push_back(painted);
            return Ok(images);
        }
        let painted = self.painted(seen, &ring, &mut watch)?;
        let images = ring.in_rig_order(&painted.images);
        if self.kept.len() >= KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back(painted);
        Ok(images)
    }

    fn painted(
        &self,
        seen: RingFrame,
        ring: &Ring,
        watch: &mut impl FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<PaintedRing, PaintError> {
        let source = self.kept.iter().rfind(|p| p.seen.differs_in_scene_alone(&seen));
        let changed = source.map(|source| mask::changed(&source.seen, &seen, ring.size));
        let brush = Brush {
            nets: &self.nets,
            size: ring.size,
            base: source.zip(changed.as_deref()).map(|(source, changed)| Base {
                images: &source.images,
                changed,
            }),
        };
        let touched_views = ring.touched_views(&brush);
        let condition = seen.condition(ring.size);
        begins(watch, self.options.steps)?;
        let told = self.nets.dit.tell(&condition).map_err(network_error)?;
        let earlier = match source {
            None => self.earlier(&seen, ring.size),
            Some(_) => None,
        };
        let before = match &earlier {
            Some((painted, motions)) if self.options.hears_before => {
                Some(before(painted, motions, &seen, ring.size)?)
            }
            _ => None,
        };
        let number = match (source, &earlier) {
            (Some(source), _) => source.number,
            (None, Some((painted, _))) => painted.number + 1,
            (None, None) => 0,
        };
        let noise = match source {
            Some(source) => source.noise.clone(),
            None => {
                let earlier = earlier.as_ref().map(|(p, _)| (&p.noise[..], &p.seen));
                let latent = self.nets.dit.config().latent;
                self.options.noise.of(&seen, ring, earlier, number, latent)?
            }
        };
        let sampling = PictureSampling {
            told: &told,
            silent: None,
            before: before.as_ref(),
            steps: self.options.steps,
            guidance: self.options.guidance,
        };
        let on_step = |view: diffusion::solver::StepView<'_>| {
            let (step, steps) = (view.step, view.steps);
            let clean = || {
                view.clean_estimate()
                    .iter()
                    .map(|v| *v as f32)
                    .collect::<Vec<_>>()
            };
            // The last step is followed by the pictures themselves.
            let preview = touched_views.first().filter(|_| self.previews && step < steps);
            let image = preview.and_then(|first| brush.image(*first, &clean(), &seen).ok());
            watch(PaintProgress {
                step,
                steps,
                news: preview.map(|first| ring.camera(*first)).zip(image.as_ref()),
            })
        };
        let trajectory = match (source, &changed) {
            (Some(source), Some(changed)) => {
                let cells = mask::cells(changed, ring.size);
                self.nets
                    .dit
                    .resample(&source.trajectory, &cells, &sampling, on_step)
            }
            _ => self.nets.dit.sample(&noise, &sampling, on_step),
        };
        let trajectory = trajectory.map_err(network_error)?;
        let latents = trajectory.latent_f32();
        let mut images: Vec<Option<Arc<CameraImage>>> = vec![None; ring.size.views()];
        if let Some((first, rest)) = touched_views.split_first() {
            let image = brush.image(*first, &latents, &seen)?;
            let steps = self.options.steps;
            let _ = watch(PaintProgress {
                step: steps,
                steps,
                news: Some((ring.camera(*first), &image)),
            });
            images[*first] = Some(Arc::new(image));
            let others: Result<Vec<_>, _> = rest
                .par_iter()
                .map(|view| Ok((*view, brush.image(*view, &latents, &seen)?)))
                .collect();
            for (view, image) in others? {
                images[view] = Some(Arc::new(image));
            }
        }
        let kept = |view: usize| source.map(|s| s.images[view].clone());
        let images = images.into_iter().enumerate();
        Ok(PaintedRing {
            images: images
                .filter_map(|(view, image)| image.or_else(|| kept(view)))
                .collect(),
            trajectory,
            noise,
            number,
            seen,
        })
    }

    /// The newest frame that was painted while these cameras stood near, and how they moved since.
    fn earlier(&self, seen: &RingFrame, size: RingSize) -> Option<(&PaintedRing, Vec<Motion>)> {
        let mut kept = self.kept.iter().rev();
        kept.find_map(|p| Some((p, seen.motion_since(&p.seen, size)?)))
    }
}

/// Input of the cells of a frame from an earlier frame that was painted.
fn before(
    painted: &PaintedRing,
    motions: &[Motion],
    seen: &RingFrame,
    size: RingSize,
) -> Result<WarpedLatents, PaintError> {
    let depths = [&seen.depth_m()[..], &painted.seen.depth_m()];
    let before = picture::warp(size, &painted.trajectory.latent_f32(), depths, motions);
    before.map_err(network_error)
}

/// Turns latents into pictures.
struct Brush<'a> {
    nets: &'a PictureNets,
    size: RingSize,
    /// Pictures that are painted over; `None` if all is painted.
    base: Option<Base<'a>>,
}

/// Pictures that are painted over.
#[derive(Clone, Copy)]
struct Base<'a> {
    images: &'a [Arc<CameraImage>],
    /// Changed pixels of each view.
    changed: &'a [Vec<bool>],
}

impl Brush<'_> {
    /// True if a view is to be painted at all.
    fn touches(&self, view: usize) -> bool {
        self.base.is_none_or(|base| base.changed[view].contains(&true))
    }

    /// Decodes the picture of one view of the ring from the latents of all.
    fn image(&self, view: usize, latents: &[f32], seen: &RingFrame) -> Result<CameraImage, PaintError> {
        let numbers = latents.len() / self.size.views();
        let latents = &latents[view * numbers..][..numbers];
        let colors = self
            .nets
            .vae
            .decode(latents, self.size.cells())
            .map_err(network_error)?;
        let [height, width] = self.size.pixels();
        let byte = |v: f32| ((v + 1.0) * 127.5).round().clamp(0.0, 255.0) as u8;
        let mut image = CameraImage {
            camera: seen.camera_name(view).to_owned(),
            width,
            height,
            rgba: colors
                .as_chunks::<3>()
                .0
                .iter()
                .flat_map(|[r, g, b]| [byte(*r), byte(*g), byte(*b), 255])
                .collect(),
        };
        if let Some(base) = self.base {
            let shares = mask::shares(&base.changed[view], width);
            mask::blend(&base.images[view].rgba, &mut image.rgba, &shares);
        }
        Ok(image)
    }
}

/// Tells the watcher the number of steps. Errors if the watcher stops the painting.
fn begins(
    watch: &mut dyn FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    steps: usize,
) -> Result<(), PaintError> {
    let progress = PaintProgress {
        step: 0,
        steps,
        news: None,
    };
    match watch(progress) {
        ControlFlow::Break(()) => Err(PaintError::Stopped),
        ControlFlow::Continue(()) => Ok(()),
    }
}

fn network_error(error: ModelError) -> PaintError {
    match error {
        ModelError::Stopped { .. } => PaintError::Stopped,
        error => PaintError::Network(error.to_string()),
    }
}
