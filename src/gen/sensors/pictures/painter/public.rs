//! Camera pictures by public weights: Stable Diffusion starts from the program's own rendering of each camera. Its
//! inputs are text, and classes, depths or planes where the folder has networks for them.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;

use image::imageops::FilterType;

use super::control_pictures::{boxes_and_lanes, classes, depths, planes};
use super::ring::Ring;
use super::seen::RingFrame;
use super::surfaces::{cells_of, pixels_before, shared_cells};
use super::{KEPT, PaintError, PaintInput, PaintOptions, PaintProgress, begins, mask};
use crate::pictures::appearance::CameraImage;
use crate::pictures::painter::model::CameraPainter;
use diffusion::solver::Guidance;
use stable::noise::{carried, fresh};
use stable::{
    Control, DenoisingStep, PictureBatch, PictureRequest, Pipeline, SemanticPlanes, StableError,
    StartPictures,
};

/// Paints with public weights.
pub(super) struct PublicPainter {
    pipeline: Arc<Pipeline>,
    options: PaintOptions,
    /// True if pictures are made of the steps too.
    previews: bool,
    /// Pictures of recent states, the newest last.
    kept: VecDeque<DiffusionRing>,
}

/// Largest share of a picture that is painted anew if it continues the frame before: enough to mend what the warp tore.
const ONWARD: f64 = 0.5;

/// Pictures of one state, in the ring's order.
struct DiffusionRing {
    seen: RingFrame,
    images: Vec<Arc<CameraImage>>,
    /// Noise that they were drawn from, `[view][channel][row][column]`.
    noise: Vec<f32>,
    /// Number of the frame in a row of frames that continue each other.
    frame: u32,
}

/// The frame before, and for each pixel `[view][row][column]` the one that showed the same surface there.
struct Onward<'a> {
    images: &'a [Arc<CameraImage>],
    pixels: Vec<Option<u32>>,
}

/// The pictures before an edit, and for each view the share of each pixel that is new.
type PicturesBeforeEdit<'a> = (&'a [Arc<CameraImage>], Vec<Vec<f32>>);

/// Input that some views of one frame are drawn from.
struct ViewInputs<'a> {
    input: &'a PaintInput<'a>,
    seen: &'a RingFrame,
    ring: &'a Ring,
    before: Option<PicturesBeforeEdit<'a>>,
    onward: Option<Onward<'a>>,
    /// Noise of all views.
    noise: &'a [f32],
}

impl ViewInputs<'_> {
    /// Share of the pictures that is drawn anew: one step at least, unless it is 0 in the options.
    fn strength(&self, options: &PaintOptions) -> f64 {
        let strength = match self.onward {
            Some(_) => options.strength.min(ONWARD),
            None => options.strength,
        };
        // A little more than a step, so that it is not rounded to none.
        let least = (1.0 + 1e-9) / options.steps.max(1) as f64;
        if strength > 0.0 {
            strength.max(least).min(1.0)
        } else {
            0.0
        }
    }

    /// The picture that a view is drawn over: the rendered one, with the pixels that are known from earlier pictures.
    fn start(&self, view: usize) -> Vec<u8> {
        let plain = self.seen.pixels(view).1.iter().flatten().copied();
        let mut picture: Vec<u8> = plain.collect();
        if let Some((images, shares)) = &self.before {
            let old = images[view].rgba.chunks_exact(4).zip(&shares[view]);
            let kept = picture
                .chunks_exact_mut(3)
                .zip(old)
                .filter(|(_, (_, share))| **share == 0.0);
            kept.for_each(|(new, (old, _))| new.copy_from_slice(&old[..3]));
        }
        if let Some(onward) = &self.onward {
            let count = picture.len() / 3;
            let pixels = picture.chunks_exact_mut(3).zip(&onward.pixels[view * count..]);
            for (new, from) in pixels {
                if let Some(from) = from.map(|f| f as usize) {
                    let old = &onward.images[from / count].rgba[from % count * 4..];
                    new.copy_from_slice(&old[..3]);
                }
            }
        }
        picture
    }

    /// The picture of a view with new colours, and the earlier colours where nothing is new.
    fn image(&self, view: usize, rgb: &[u8]) -> CameraImage {
        let [height, width] = self.ring.size.pixels();
        let pixels = rgb.chunks_exact(3);
        let mut image = CameraImage {
            camera: self.seen.camera_name(view).to_owned(),
            width,
            height,
            rgba: pixels.flat_map(|p| [p[0], p[1], p[2], 255]).collect(),
        };
        if let Some((images, shares)) = &self.before {
            mask::blend(&images[view].rgba, &mut image.rgba, &shares[view]);
        }
        image
    }

    /// Preview of the first of some views: one pixel per cell, enlarged.
    fn preview(&self, step: &DenoisingStep<'_>, view: usize) -> Option<CameraImage> {
        let seen = step.preview()?;
        let [rows, columns] = seen.size().map(|side| side as u32);
        let mut rgb = seen.to_bytes();
        rgb.truncate((rows * columns * 3) as usize);
        let small = image::RgbImage::from_raw(columns, rows, rgb)?;
        let [height, width] = self.ring.size.pixels().map(|side| side as u32);
        let large = image::imageops::resize(&small, width, height, FilterType::Triangle);
        Some(self.image(view, &large))
    }
}

impl PublicPainter {
    pub fn new(pipeline: Arc<Pipeline>, options: PaintOptions, previews: bool) -> Self {
        Self {
            pipeline,
            options,
            previews,
            kept: VecDeque::new(),
        }
    }

    /// Height and width of the pictures of a rig, px.
    fn size(&self, input: &PaintInput<'_>) -> [usize; 2] {
        // The UNet halves the latents three times.
        let unit = self.pipeline.cell() * 8;
        let whole = |px: f64| ((px / unit as f64).round() as usize).max(1) * unit;
        let camera = &input.rig.cameras[0];
        let aspect = f64::from(camera.height.max(1)) / f64::from(camera.width.max(1));
        let width = whole(self.options.width_px as f64);
        [whole(width as f64 * aspect), width]
    }

    /// Draws views together and returns their pictures.
    fn draw(
        &self,
        told: &ViewInputs<'_>,
        views: &[usize],
        watch: &mut dyn FnMut(&DenoisingStep<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<CameraImage>, PaintError> {
        let [height, width] = told.ring.size.pixels();
        let start: Vec<u8> = views.iter().flat_map(|view| told.start(*view)).collect();
        let of_view = told.noise.len() / told.ring.size.views();
        let noise = views
            .iter()
            .flat_map(|view| &told.noise[view * of_view..][..of_view]);
        let start = PictureBatch::from_bytes(views.len(), [height, width], &start).map_err(public)?;
        let mask: Option<Vec<bool>> = told.before.as_ref().map(|(_, shares)| {
            let all = views.iter().flat_map(|view| &shares[*view]);
            all.map(|share| *share > 0.0).collect()
        });
        let shown = self.shown(told, views);
        let planes = self.pipeline.plane_channels().map(|channels| {
            let cell = self.pipeline.cell();
            planes(
                told.input.frame,
                told.seen,
                views,
                [height / cell, width / cell],
                channels,
            )
        });
        let planes = planes.transpose().map_err(public)?;
        let request = PictureRequest {
            prompts: views.iter().map(|view| self.prompt(told, *view)).collect(),
            negative: self.options.negative.clone(),
            size: [height, width],
            views: views.len(),
            frames: 1,
            steps: self.options.steps,
            guidance: Guidance {
                weight: self.options.guidance,
                rescale: 0.0,
            },
            scheduler: self.options.scheduler,
            seed: told.seen.seed(),
            noise: Some(noise.copied().collect()),
            start: Some(StartPictures {
                pictures: &start,
                strength: told.strength(&self.options),
                mask: mask.as_deref(),
            }),
            controls: shown
                .iter()
                .map(|(net, picture)| Control::new(*net, picture))
                .collect(),
            planes: planes.as_deref().map(|ids| SemanticPlanes { ids, scale: 1.0 }),
        };
        let drawn = self.pipeline.draw(&request, |step| watch(step)).map_err(public)?;
        let rgb = drawn.pictures.to_bytes();
        let of_views = views.iter().zip(rgb.chunks_exact(height * width * 3));
        Ok(of_views.map(|(view, rgb)| told.image(*view, rgb)).collect())
    }

    /// Input of each ControlNet that takes pictures: depths, or boxes and lanes, if its folder is named for them, else
    /// classes.
    fn shown(&self, told: &ViewInputs<'_>, views: &[usize]) -> Vec<(usize, Vec<f32>)> {
        let nets = self.pipeline.controls().iter().enumerate();
        let pictures = nets.filter(|(_, net)| !net.takes_planes());
        pictures
            .map(|(i, net)| {
                let channels = net.config().conditioning_channels;
                let name = self.pipeline.control_name(i);
                let of_view = |view: &usize| {
                    let hints = told.seen.pixels(*view).0;
                    match name {
                        name if name.contains("depth") => depths(hints, channels),
                        name if name.contains("box") => {
                            boxes_and_lanes(told.input.frame, told.seen.camera(*view), channels)
                        }
                        _ => classes(hints, channels),
                    }
                };
                (i, views.iter().flat_map(of_view).collect())
            })
            .collect()
    }

    /// Prompt of a view: the user's words, the light and the camera.
    fn prompt(&self, told: &ViewInputs<'_>, view: usize) -> String {
        let conditions = &told.input.conditions;
        let camera = told
            .seen
            .camera_name(view)
            .replace("CAM_", "")
            .replace('_', " ")
            .to_lowercase();
        let words = match self.options.prompt.trim() {
            "" => "a photograph of a street",
            words => words,
        };
        format!(
            "{words}, {}, {}, seen by the {camera} camera of a car",
            conditions.time.name(),
            conditions.weather.name()
        )
    }

    fn painted(
        &self,
        input: &PaintInput<'_>,
        seen: RingFrame,
        ring: &Ring,
        watch: &mut dyn FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<DiffusionRing, PaintError> {
        let together = self.pipeline.unet().views();
        let count = ring.size.views();
        if together > 1 && together != count {
            return Err(PaintError::Network(format!(
                "the weights draw {together} cameras together, the rig has {count}"
            )));
        }
        let source = self.kept.iter().rfind(|p| p.seen.differs_in_scene_alone(&seen));
        let [_, width] = ring.size.pixels();
        let earlier = match source {
            None => {
                let mut kept = self.kept.iter();
                kept.rfind(|p| seen.motion_since(&p.seen, ring.size).is_some())
            }
            Some(_) => None,
        };
        let onward = earlier.map(|earlier| Onward {
            images: &earlier.images,
            pixels: pixels_before(&seen, &earlier.seen, count),
        });
        let frame = match (source, earlier) {
            (Some(source), _) => source.frame,
            (None, Some(earlier)) => earlier.frame + 1,
            (None, None) => 0,
        };
        let noise = match source {
            Some(source) => source.noise.clone(),
            None => {
                let size = self.pipeline.latent_size(count, ring.size.pixels());
                let (cell, new) = (self.pipeline.cell(), fresh(seen.seed(), frame, size));
                let noise = match (earlier, &onward) {
                    (Some(earlier), Some(onward)) => {
                        let cells = cells_of(&onward.pixels, ring.size.pixels(), cell);
                        carried(&earlier.noise, &cells, &new, size)
                    }
                    _ => carried(&new, &shared_cells(&seen, &ring.views(), cell), &new, size),
                };
                noise.map_err(public)?
            }
        };
        let before = source.map(|source| {
            let changed = mask::changed(&source.seen, &seen, ring.size);
            let shares = changed.iter().map(|c| mask::shares(c, width)).collect();
            (&source.images[..], shares)
        });
        let told = ViewInputs {
            input,
            seen: &seen,
            ring,
            before,
            onward,
            noise: &noise,
        };
        let touched = |view: &usize| match &told.before {
            Some((_, shares)) => shares[*view].iter().any(|share| *share > 0.0),
            None => true,
        };
        let views: Vec<usize> = ring.views().into_iter().filter(touched).collect();
        let groups: Vec<Vec<usize>> = match together > 1 {
            true if views.is_empty() => Vec::new(),
            true => vec![(0..count).collect()],
            false => views.into_iter().map(|view| vec![view]).collect(),
        };
        if !groups.is_empty() {
            let PaintOptions { scheduler, steps, .. } = self.options;
            let calls = self
                .pipeline
                .calls(scheduler, steps, told.strength(&self.options));
            begins(watch, groups.len() * calls.map_err(public)?)?;
        }
        let mut images: Vec<Option<Arc<CameraImage>>> = match &told.before {
            Some((images, _)) => images.iter().cloned().map(Some).collect(),
            None => vec![None; count],
        };
        for (k, group) in groups.iter().enumerate() {
            let mut last = (0, 0);
            let drawn = self.draw(&told, group, &mut |step| {
                last = (k * step.steps + step.step, groups.len() * step.steps);
                // After the last step comes the picture itself.
                let shown = self.previews && step.step < step.steps;
                let preview = shown.then(|| told.preview(step, group[0])).flatten();
                watch(PaintProgress {
                    step: last.0,
                    steps: last.1,
                    news: preview.as_ref().map(|image| (ring.camera(group[0]), image)),
                })
            })?;
            for (view, image) in group.iter().zip(drawn) {
                let news = PaintProgress {
                    step: last.0,
                    steps: last.1,
                    news: Some((ring.camera(*view), &image)),
                };
                let ends = watch(news).is_break() && k + 1 < groups.len();
                images[*view] = Some(Arc::new(image));
                if ends {
                    return Err(PaintError::Stopped);
                }
            }
        }
        Ok(DiffusionRing {
            images: images.into_iter().flatten().collect(),
            seen,
            noise,
            frame,
        })
    }
}

impl CameraPainter for PublicPainter {
    fn paint(
        &mut self,
        input: &PaintInput<'_>,
        watch: &mut dyn FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<Arc<CameraImage>>, PaintError> {
        if input.rig.cameras.is_empty() {
            return Ok(Vec::new());
        }
        let Some(ring) = Ring::sized(&input.rig.cameras, self.size(input))? else {
            return Ok(Vec::new());
        };
        let seen = RingFrame::from_input(input, &ring);
        let known = self.kept.iter().position(|p| p.seen == seen);
        let painted = match known.and_then(|at| self.kept.remove(at)) {
            Some(painted) => painted,
            None => self.painted(input, seen, &ring, watch)?,
        };
        let images = ring.in_rig_order(&painted.images);
        if self.kept.len() >= KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back(painted);
        Ok(images)
    }
}

fn public(error: StableError) -> PaintError {
    match error {
        StableError::Stopped { .. } => PaintError::Stopped,
        error => PaintError::Network(error.to_string()),
    }
}
