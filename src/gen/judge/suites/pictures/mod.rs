//! `eval pictures`: learned pictures of held-out worlds. Does a segmenter see in them what they should show? Do they
//! stay the same from moment to moment and from camera to camera? How like rendered ones are they, what does an edit
//! change, and how long does it take?

mod likeness;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Context;
use serde_json::{Value, json};

use self::likeness::{Likeness, light_of};
use crate::suite::{Options, SuiteFigures, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use dataset::picture_pairs::poses;
use dataset::world_of;
use metrics::pictures::{DepthPicture, PixelDifference};
use metrics::stats::mean_ci95;
use nets::picture::{PictureNets, PictureSegmenter};
use numeric::quantile::median;
use scene::truth::OUTSIDE;
use scene::{Camera, Class, Conditions, Frame, SceneBox, SensorRig, TruthPixel};
use sensors::pictures::appearance::{Appearance, CameraImage, Quality};
use sensors::pictures::painter::{NoisePrior, PaintInput, PaintOptions, Painter, native_px};
use sensors::pictures::picture_hints::{HintedFrame, PictureHints};
use world::World;
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Distances at which a car is near enough to be removed, m.
const NEAR_M: std::ops::Range<f64> = 5.0..30.0;
/// Bar: share of the segmenter's agreement on the renderer's own pictures.
const AGREEMENT: f64 = 0.85;
/// Bar: longest time for six pictures, s.
const LONGEST_S: f64 = 3.0;

/// Whether a frame gets the picture before it, and where its noise comes from.
const PRIORS: [(bool, NoisePrior); 6] = [
    (false, NoisePrior::Frames),
    (false, NoisePrior::Places),
    (false, NoisePrior::Surfaces),
    (true, NoisePrior::Frames),
    (true, NoisePrior::Places),
    (true, NoisePrior::Surfaces),
];

/// Figures, one value per world.
#[derive(Default)]
struct PictureFigures {
    rendered: Vec<f64>,
    learned: Vec<f64>,
    after: Vec<f64>,
    alone: Vec<f64>,
    rendered_after: Vec<f64>,
    gain: Vec<f64>,
    /// Each frame alone, then each with the frame before as input: with noise of the frame, of the places and of the
    /// surfaces.
    priors: [Vec<f64>; 6],
    sides: Vec<f64>,
    /// Differences between cameras, and share of pixels told rightly (`learned_own`), if each camera has noise of its
    /// own.
    sides_own: Vec<f64>,
    learned_own: Vec<f64>,
    rendered_sides: Vec<f64>,
    painted_share: Vec<f64>,
    elsewhere_px: usize,
    first_s: Vec<f64>,
    edit_s: Vec<f64>,
    likeness: Likeness,
}

/// Renderings of the cameras of a rig: pictures and truths, and the cameras at that size.
struct RenderedRig {
    cameras: Vec<Camera>,
    images: Vec<CameraImage>,
    pixels: Vec<Vec<TruthPixel>>,
    depths: Vec<Vec<f32>>,
    hints: Vec<PictureHints>,
}

impl RenderedRig {
    fn from_input(input: &PaintInput<'_>) -> Self {
        let appearance = Appearance::with_things(input.frame, input.background, input.rig, &input.conditions);
        let mut out = Self {
            cameras: Vec::new(),
            images: Vec::new(),
            pixels: Vec::new(),
            depths: Vec::new(),
            hints: Vec::new(),
        };
        let teller = HintedFrame::new(input.frame);
        for camera in &input.rig.cameras {
            let [height, width] = native_px(camera).map(|n| n as u32);
            let boxes = &input.frame.boxes;
            let (image, truth) =
                appearance.render_truth(camera, [width, height], Quality::Preview, boxes, None);
            out.cameras.push(camera.resized(width, height));
            out.images.push(image);
            out.hints.push(teller.of(camera, [width, height]));
            out.depths.push(truth.plane(|p| p.depth_m));
            out.pixels.push(truth.pixels);
        }
        out
    }

    fn taken<'a>(&'a self, i: usize, image: &'a CameraImage) -> DepthPicture<'a> {
        DepthPicture {
            camera: &self.cameras[i],
            image,
            depth_m: &self.depths[i],
        }
    }

    /// Difference of pictures from those of another moment.
    fn since(&self, then: &Self, [now, before]: [&[&CameraImage]; 2]) -> f64 {
        let mut apart = PixelDifference::default();
        for (i, (now, before)) in now.iter().zip(before).enumerate() {
            apart.add(&self.taken(i, now), &then.taken(i, before));
        }
        apart.mean()
    }

    /// Difference between pictures of different cameras.
    fn between(&self, images: &[&CameraImage]) -> f64 {
        let mut apart = PixelDifference::default();
        for i in 0..images.len() {
            for j in (0..images.len()).filter(|j| *j != i) {
                apart.add(&self.taken(i, images[i]), &self.taken(j, images[j]));
            }
        }
        apart.mean()
    }
}

/// Share of the pixels that the segmenter classifies rightly.
fn agreement(net: &PictureSegmenter, rendered: &RenderedRig, images: &[&CameraImage]) -> anyhow::Result<f64> {
    let (mut right, mut all) = (0usize, 0usize);
    for (image, truth) in images.iter().zip(&rendered.pixels) {
        let classes = net.classes(&colours(image), [image.height, image.width])?;
        for (pixel, class) in truth.iter().zip(classes).filter(|(p, _)| p.class != OUTSIDE) {
            all += 1;
            right += usize::from(pixel.class == class);
        }
    }
    Ok(right as f64 / all.max(1) as f64)
}

/// Colours of a picture as networks take them, -1 to 1.
fn colours(image: &CameraImage) -> Vec<f32> {
    let colors = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]);
    colors.map(|c| f32::from(c) / 127.5 - 1.0).collect()
}

fn frame_of(world: &World) -> Frame {
    let grid = complete(world, Vertical::Occ3d);
    Frame::new(world.layout.clone(), world.boxes.clone(), grid)
}

/// Numbers of pixels that differ: those that show what an edit changed or lie around it, and others; and the number of
/// all pixels.
fn changes(before: &RenderedRig, after: &RenderedRig, [old, new]: [&[Arc<CameraImage>]; 2]) -> [usize; 3] {
    let [mut touched, mut elsewhere, mut all] = [0; 3];
    for (i, (old, new)) in old.iter().zip(new).enumerate() {
        let (width, height) = (old.width as i64, old.height as i64);
        let differs = |x: i64, y: i64| {
            let at = (y * width + x) as usize;
            let shown = |r: &RenderedRig| {
                let (pixel, hints) = (&r.pixels[i][at], &r.hints[i]);
                let light = [0, 1, 2].map(|c| r.images[i].rgba[at * 4 + c]);
                (
                    pixel.class,
                    pixel.depth_m,
                    hints.class[at],
                    hints.depth_m[at],
                    hints.facing[at],
                    light,
                )
            };
            shown(before) != shown(after)
        };
        for (at, (a, b)) in old.rgba.chunks_exact(4).zip(new.rgba.chunks_exact(4)).enumerate() {
            all += 1;
            if a == b {
                continue;
            }
            let (x, y) = (at as i64 % width, at as i64 / width);
            let rim = Painter::RIM_PX as i64;
            let near = (-rim..=rim).any(|dy| {
                (-rim..=rim).any(|dx| {
                    let (x, y) = (x + dx, y + dy);
                    (0..width).contains(&x) && (0..height).contains(&y) && differs(x, y)
                })
            });
            match near {
                true => touched += 1,
                false => elsewhere += 1,
            }
        }
    }
    [touched, elsewhere, all]
}

/// Watches a painting without stopping it.
pub(super) fn go_on(_: sensors::pictures::painter::PaintProgress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn refs(images: &[Arc<CameraImage>]) -> Vec<&CameraImage> {
    images.iter().map(|i| &**i).collect()
}

fn refs_of(images: &[CameraImage]) -> Vec<&CameraImage> {
    images.iter().collect()
}

impl PictureFigures {
    fn add(
        &mut self,
        index: u64,
        nets: &Arc<PictureNets>,
        segmenter: &PictureSegmenter,
    ) -> anyhow::Result<()> {
        let (mut world, seed) = world_of(TEST_SEED, index, |_| None);
        let (frame, background) = (frame_of(&world), world.background.clone());
        let places = poses(&frame, &mut Draw::new(seed, "learned pictures"));
        let [rig, rig_ahead] = places.map(|pose| SensorRig::default().standing_at(&pose));
        let (time, weather) = light_of(index);
        let input = PaintInput {
            frame: &frame,
            rig: &rig,
            background: &background,
            conditions: Conditions::usual(time, weather, seed),
        };
        let painter = || Painter::new(nets.clone(), PaintOptions::default());
        let mut memory = painter();
        let start = Instant::now();
        let first = memory.paint(&input, go_on)?;
        self.first_s.push(start.elapsed().as_secs_f64());
        let rendered = RenderedRig::from_input(&input);
        let renders = refs_of(&rendered.images);
        self.likeness.add(segmenter, &renders, &refs(&first))?;
        self.rendered.push(agreement(segmenter, &rendered, &renders)?);
        self.learned.push(agreement(segmenter, &rendered, &refs(&first))?);
        self.sides.push(rendered.between(&refs(&first)));
        self.rendered_sides.push(rendered.between(&renders));

        let ahead = PaintInput {
            rig: &rig_ahead,
            ..input
        };
        let now = RenderedRig::from_input(&ahead);
        let (next, alone) = (memory.paint(&ahead, go_on)?, painter().paint(&ahead, go_on)?);
        let since = |images: &[Arc<CameraImage>]| now.since(&rendered, [&refs(images), &refs(&first)]);
        let (after, without) = (since(&next), since(&alone));
        self.after.push(after);
        self.alone.push(without);
        self.gain.push(without - after);
        for (values, (hears_before, noise)) in self.priors.iter_mut().zip(PRIORS) {
            let options = PaintOptions {
                noise,
                hears_before,
                ..PaintOptions::default()
            };
            let mut painter = Painter::new(nets.clone(), options);
            let start = painter.paint(&input, go_on)?;
            let then = painter.paint(&ahead, go_on)?;
            values.push(now.since(&rendered, [&refs(&then), &refs(&start)]));
            if !hears_before && noise == NoisePrior::Places {
                self.sides_own.push(rendered.between(&refs(&start)));
                let own = agreement(segmenter, &rendered, &refs(&start))?;
                self.learned_own.push(own);
            }
        }
        self.rendered_after
            .push(now.since(&rendered, [&refs_of(&now.images), &renders]));

        let is_near = |b: &&SceneBox| {
            let away_m = (b.center_m - rig.vehicle.translation_m).truncate().length();
            b.class == Class::Car && NEAR_M.contains(&away_m)
        };
        let Some(id) = world.boxes.values().find(is_near).map(|b| b.id) else {
            return Ok(());
        };
        world.boxes.remove(&id);
        let without_car = frame_of(&world);
        let edited = PaintInput {
            frame: &without_car,
            ..input
        };
        let start = Instant::now();
        let painted = memory.paint(&edited, go_on)?;
        self.edit_s.push(start.elapsed().as_secs_f64());
        let [touched, elsewhere, all] =
            changes(&rendered, &RenderedRig::from_input(&edited), [&first, &painted]);
        self.painted_share.push(touched as f64 / all.max(1) as f64);
        self.elsewhere_px += elsewhere;
        Ok(())
    }
}

/// Difference `a` - `b`, world by world.
fn less(a: &[f64], b: &[f64]) -> Value {
    let each: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    with_interval(&each)
}

impl PictureFigures {
    /// Differences over time by source of the noise, and how much smaller they are than with noise of the frame's own.
    fn by_noise(&self) -> Value {
        let [frames, places, surfaces, told_frames, told_places, told_surfaces] = &self.priors;
        let of = |[frames, places, surfaces]: [&[f64]; 3]| {
            json!({
                "frames": with_interval(frames),
                "places": with_interval(places),
                "surfaces": with_interval(surfaces),
                "gain_by_places": less(frames, places),
                "gain_by_surfaces": less(frames, surfaces),
                "surfaces_less_than_places": less(places, surfaces),
            })
        };
        json!({
            "alone": of([frames, places, surfaces]),
            "after_the_frame_before": of([told_frames, told_places, told_surfaces]),
        })
    }
}

impl Options {
    /// Judges agreement, likeness over time and between cameras, edits and times.
    pub(crate) fn pictures(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let nets = PictureNets::bundled().context("the shipped picture networks")?;
        let segmenter = PictureSegmenter::bundled().context("the shipped segmenter")?;
        let mut found = PictureFigures::default();
        for i in 0..self.frames {
            progress.at("pictures", i, self.frames);
            found.add(i as u64, &nets, &segmenter)?;
            let other = (self.frames + i) as u64;
            found.likeness.add_other(&segmenter, other, i as u64)?;
        }
        let mean = |values: &[f64]| mean_ci95(values).0;
        let share = mean(&found.learned) / mean(&found.rendered);
        let (gain, half) = mean_ci95(&found.gain);
        let report = json!({
            "agreement": { "rendered": with_interval(&found.rendered), "learned": with_interval(&found.learned), "share": share },
            "over_time": {
                "rendered": with_interval(&found.rendered_after),
                "after_the_frame_before": with_interval(&found.after),
                "alone": with_interval(&found.alone),
                "gain": with_interval(&found.gain),
                "noise": found.by_noise(),
            },
            "between_cameras": {
                "rendered": with_interval(&found.rendered_sides),
                "learned": with_interval(&found.sides),
                "learned_noise_of_its_own": with_interval(&found.sides_own),
                "gain_by_sharing": less(&found.sides_own, &found.sides),
                "agreement_noise_of_its_own": with_interval(&found.learned_own),
            },
            "likeness": found.likeness.report()?,
            "edit": {
                "painted_share": with_interval(&found.painted_share),
                "pixels_changed_elsewhere": found.elsewhere_px,
                "s_median": median(&found.edit_s),
            },
            "six_pictures_s_median": median(&found.first_s),
        });
        let [own, _, surfaces, ..] = &found.priors;
        let each: Vec<f64> = own.iter().zip(surfaces).map(|(a, b)| a - b).collect();
        let (by_noise, by_noise_half) = mean_ci95(&each);
        let bars = vec![
            ("agreement as a share of the renderer's", share, AGREEMENT),
            ("gain by the frame before, beyond its interval", gain - half, 0.0),
            (
                "gain by noise that moves with surfaces, beyond its interval",
                by_noise - by_noise_half,
                0.0,
            ),
            (
                "longest time wanted / time of six pictures",
                LONGEST_S / median(&found.first_s),
                1.0,
            ),
            (
                "pixels changed elsewhere, negative",
                0.0 - found.elsewhere_px as f64,
                0.0,
            ),
        ];
        Ok((report, bars))
    }
}
