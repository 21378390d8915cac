//! Predictions of a small network for pictures of the program's own renderer, compared with the ground truth: things
//! that it misses, and things that it sees where there are none.

use std::collections::BTreeMap;

use crate::pictures::appearance::{Appearance, CameraImage, Quality};
use crate::pictures::painter::{PaintError, native_px};
use nets::picture::PictureSegmenter;
use rayon::prelude::*;
use scene::truth::{self, OUTSIDE, TruthClass};
use scene::{BoxId, Camera, CameraTruth, Frame, Scene};

/// A box of fewer pixels is too small to be missed.
pub const LEAST_PX: usize = 24;
/// Share of a box's pixels that are predicted to be a thing, below which the box is missed.
pub const MISSED_BELOW: f64 = 0.25;
/// Share of the class's colour in the picture.
const TINT: f32 = 0.55;
/// Colour of missed pixels.
pub const MISSED: [u8; 3] = [255, 40, 40];
/// Colour of things where there are none.
pub const GHOST: [u8; 3] = [255, 225, 40];

/// One camera's picture, its ground truth, and the prediction of the network.
pub struct Perceived {
    /// The picture.
    pub image: CameraImage,
    /// Ground truth of the picture.
    pub truth: CameraTruth,
    /// Predicted class of each pixel, as in [`scene::truth`].
    pub classes: Vec<TruthClass>,
}

/// A box in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenThing {
    /// The box.
    pub id: BoxId,
    /// Pixels that show it.
    pub visible_px: usize,
    /// Share of them that the network predicts to be a thing.
    pub share: f64,
}

impl SeenThing {
    /// True if it is large enough to be missed and the network does not predict a thing there.
    pub fn is_missed(&self) -> bool {
        self.visible_px >= LEAST_PX && self.share < MISSED_BELOW
    }
}

impl Perceived {
    /// Looks at a camera's picture of some 256x144 px. Errors if the network cannot be read.
    pub fn of(appearance: &Appearance, frame: &Frame, camera: &Camera) -> Result<Self, PaintError> {
        let sides = native_px(camera);
        let size = [sides[1] as u32, sides[0] as u32];
        let (image, truth) = appearance.render_truth(camera, size, Quality::Preview, &frame.boxes, None);
        Ok(Self {
            classes: classes(&image)?,
            image,
            truth,
        })
    }

    /// Compares another picture that shows the same at the same size, such as a learned one. Errors if it is of another
    /// size, or if the network cannot be read.
    pub fn with_picture(self, image: CameraImage) -> Result<Self, PaintError> {
        let sizes = [&self.image, &image].map(|i| [i.width, i.height]);
        if sizes[0] != sizes[1] {
            let reason = format!("a picture of {:?} px, expected {:?}", sizes[1], sizes[0]);
            return Err(PaintError::Network(reason));
        }
        Ok(Self {
            classes: classes(&image)?,
            image,
            truth: self.truth,
        })
    }

    /// Boxes in the picture, the largest first.
    pub fn boxes(&self) -> Vec<SeenThing> {
        let mut seen: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
        for (pixel, class) in self.truth.pixels.iter().zip(&self.classes) {
            if pixel.instance != 0 && is_thing(pixel.class) {
                let [all, found] = seen.entry(pixel.instance).or_default();
                *all += 1;
                *found += usize::from(is_thing(*class));
            }
        }
        let thing = |(id, [visible_px, found]): (u32, [usize; 2])| SeenThing {
            id: BoxId(id),
            visible_px,
            share: found as f64 / visible_px as f64,
        };
        let mut boxes: Vec<SeenThing> = seen.into_iter().map(thing).collect();
        boxes.sort_by_key(|b| std::cmp::Reverse(b.visible_px));
        boxes
    }

    /// Boxes that are missed, the largest first.
    pub fn missed(&self) -> Vec<SeenThing> {
        let mut boxes = self.boxes();
        boxes.retain(SeenThing::is_missed);
        boxes
    }

    /// Pixels of a box, and the share of them that is predicted to be a thing; `None` if the picture does not show it.
    pub fn seen(&self, id: BoxId) -> Option<(usize, f64)> {
        let boxes = self.boxes().into_iter();
        boxes
            .filter(|b| b.id == id)
            .map(|b| (b.visible_px, b.share))
            .next()
    }

    /// Number of pixels that are predicted to be a thing where there is none.
    pub fn ghost_px(&self) -> usize {
        let pairs = self.truth.pixels.iter().zip(&self.classes);
        pairs
            .filter(|(p, class)| p.class != OUTSIDE && !is_thing(p.class) && is_thing(**class))
            .count()
    }

    /// Share of the pixels whose class is predicted correctly; 1 where the lens sees nothing.
    pub fn right(&self) -> f64 {
        let pairs = self.truth.pixels.iter().zip(&self.classes);
        let valid = pairs.filter(|(p, _)| p.class != OUTSIDE);
        let all = valid.clone().count();
        match all {
            0 => 1.0,
            _ => valid.filter(|(p, class)| p.class == **class).count() as f64 / all as f64,
        }
    }

    /// The picture in the colours of the predicted classes. Where a thing is missed every other pixel is red, where a
    /// thing is predicted that is not there every other pixel is yellow.
    pub fn shown(&self) -> CameraImage {
        let mut image = self.image.clone();
        let width = image.width.max(1);
        let pixels = image
            .rgba
            .chunks_exact_mut(4)
            .zip(&self.truth.pixels)
            .zip(&self.classes);
        for (at, ((out, truth), class)) in pixels.enumerate() {
            if truth.class == OUTSIDE {
                continue;
            }
            let wrong = match (is_thing(truth.class), is_thing(*class)) {
                (true, false) => Some(MISSED),
                (false, true) => Some(GHOST),
                _ => None,
            };
            let marked = wrong.filter(|_| (at % width + at / width).is_multiple_of(2));
            let color = marked.unwrap_or_else(|| truth::color(*class));
            let share = if marked.is_some() { 1.0 } else { TINT };
            for (out, color) in out.iter_mut().zip(color) {
                *out = (f32::from(*out) * (1.0 - share) + f32::from(color) * share).round() as u8;
            }
        }
        image
    }
}

/// Class of each pixel of a picture.
fn classes(image: &CameraImage) -> Result<Vec<TruthClass>, PaintError> {
    let network = |e: &dyn std::fmt::Display| PaintError::Network(e.to_string());
    let net = PictureSegmenter::bundled().map_err(|e| network(&e))?;
    let colors = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]);
    let colors: Vec<f32> = colors.map(|c| f32::from(c) / 127.5 - 1.0).collect();
    net.classes(&colors, [image.height, image.width])
        .map_err(|e| network(&e))
}

/// Predictions for all cameras of a rig, compared with the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraReport {
    /// Boxes that are large enough in a camera. Those that are missed in all cameras come first, then the largest.
    pub boxes: Vec<SeenByRig>,
    /// Pixels of each camera that are predicted to be a thing where there is none.
    pub ghost_px: Vec<usize>,
    /// Share of all pixels whose class is predicted correctly.
    pub right: f64,
}

/// A box as the cameras of a rig see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenByRig {
    /// Index of the camera that shows most of it.
    pub camera: usize,
    /// The box, its pixels there, and the largest share of its pixels that is predicted to be a thing in a camera where
    /// it is large enough.
    pub thing: SeenThing,
}

/// Looks at the pictures of all cameras of a scene whose rig stands in the frame of the boxes. Errors if the network cannot be
/// read.
pub fn report(scene: &Scene) -> Result<CameraReport, PaintError> {
    let (frame, rig) = (scene.frame(), &scene.rig);
    let appearance = Appearance::with_things(frame, &scene.background, rig, &scene.conditions);
    let look = |camera: &Camera| Perceived::of(&appearance, frame, camera);
    let all: Result<Vec<Perceived>, PaintError> = rig.cameras.par_iter().map(look).collect();
    let all = all?;
    let mut boxes: BTreeMap<BoxId, SeenByRig> = BTreeMap::new();
    for (camera, seen) in all.iter().enumerate() {
        for thing in seen.boxes().into_iter().filter(|t| t.visible_px >= LEAST_PX) {
            let kept = boxes.entry(thing.id).or_insert(SeenByRig { camera, thing });
            let share = kept.thing.share.max(thing.share);
            if thing.visible_px > kept.thing.visible_px {
                *kept = SeenByRig { camera, thing };
            }
            kept.thing.share = share;
        }
    }
    let mut boxes: Vec<SeenByRig> = boxes.into_values().collect();
    boxes.sort_by_key(|b| (!b.thing.is_missed(), std::cmp::Reverse(b.thing.visible_px)));
    Ok(CameraReport {
        boxes,
        ghost_px: all.iter().map(Perceived::ghost_px).collect(),
        right: all.iter().map(Perceived::right).sum::<f64>() / all.len().max(1) as f64,
    })
}

/// Classes of boxes: barrier to truck.
fn is_thing(class: TruthClass) -> bool {
    (1..=10).contains(&class)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Conditions, Frame, SensorRig};
    use world::World;
    use world::voxelize::{Vertical, complete};

    #[test]
    fn most_of_a_clear_day_is_seen_and_what_is_covered_is_missed() {
        let world = World::random(3);
        let grid = complete(&world, Vertical::Occ3d);
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
        let rig = SensorRig::default();
        let appearance = Appearance::new(&frame, &rig, &Conditions::default());
        let look = |camera| Perceived::of(&appearance, &frame, camera).expect("the shipped network");
        let all: Vec<Perceived> = rig.cameras.iter().map(look).collect();
        let right = all.iter().map(Perceived::right).sum::<f64>() / all.len() as f64;
        assert!(right > 0.85, "{right}");
        for mut seen in all {
            assert_eq!(seen.shown().rgba.len(), seen.image.rgba.len());
            // A network that says sky everywhere misses every box that is large enough.
            let boxes = seen
                .truth
                .boxes
                .iter()
                .filter(|b| b.visible_px as usize >= LEAST_PX)
                .count();
            assert!(seen.missed().len() <= boxes);
            seen.classes.fill(truth::SKY);
            let missed = seen.missed();
            assert_eq!(missed.len(), boxes, "{}", seen.image.camera);
            assert!(missed.is_sorted_by(|a, b| a.visible_px >= b.visible_px));
            let red = seen
                .shown()
                .rgba
                .chunks_exact(4)
                .filter(|p| p[..3] == MISSED)
                .count();
            let pixels: usize = missed.iter().map(|m| m.visible_px).sum();
            assert!(red * 3 >= pixels, "{red} of {pixels}");
        }
    }
}
