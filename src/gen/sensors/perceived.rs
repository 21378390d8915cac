//! What a small network makes out in the pictures of the program's own renderer, beside what they show: things that it
//! misses, and things that it sees where there are none.

use crate::appearance::{Appearance, CameraImage, Quality};
use crate::cameras::CameraError;
use crate::painter::native_px;
use nets::picture::PictureSegmenter;
use scene::truth::{self, OUTSIDE, TruthClass};
use scene::{BoxId, Camera, CameraTruth, Frame};
use std::collections::BTreeMap;

/// A box of fewer pixels is too small to be missed.
const LEAST_PX: usize = 24;
/// A box of which less than this share is taken for a thing is missed.
const MISSED_BELOW: f64 = 0.25;
/// Share of the class's colour in the picture.
const TINT: f32 = 0.55;
/// Colour of missed pixels.
const MISSED: [u8; 3] = [255, 40, 40];
/// Colour of things where there are none.
const GHOST: [u8; 3] = [255, 225, 40];

/// One camera's picture, what it shows, and what the network makes of it.
pub struct Perceived {
    /// The picture.
    pub image: CameraImage,
    /// What it shows.
    pub truth: CameraTruth,
    /// Class of each pixel as the network says, as in [`scene::truth`].
    pub classes: Vec<TruthClass>,
}

/// A box that the network misses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// The box.
    pub id: BoxId,
    /// Pixels that show it.
    pub visible_px: usize,
    /// Share of them that is taken for a thing.
    pub share: f64,
}

impl Perceived {
    /// Looks at a camera's picture of some 256x144 px. Errors if the network cannot be read.
    pub fn of(appearance: &Appearance, frame: &Frame, camera: &Camera) -> Result<Self, CameraError> {
        let network = |e: &dyn std::fmt::Display| CameraError::Network(e.to_string());
        let net = PictureSegmenter::bundled().map_err(|e| network(&e))?;
        let sides = native_px(camera);
        let size = [sides[1] as u32, sides[0] as u32];
        let (image, truth) = appearance.render_truth(camera, size, Quality::Preview, &frame.boxes, None);
        let colors = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]);
        let colors: Vec<f32> = colors.map(|c| f32::from(c) / 127.5 - 1.0).collect();
        let classes = net.classes(&colors, sides).map_err(|e| network(&e))?;
        Ok(Self {
            image,
            truth,
            classes,
        })
    }

    /// Boxes that are plainly visible and that the network takes for something that is no thing, the largest first.
    pub fn missed(&self) -> Vec<Missed> {
        let mut seen: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
        for (pixel, class) in self.truth.pixels.iter().zip(&self.classes) {
            if pixel.instance != 0 && is_thing(pixel.class) {
                let [all, found] = seen.entry(pixel.instance).or_default();
                *all += 1;
                *found += usize::from(is_thing(*class));
            }
        }
        let missed = seen.into_iter().filter_map(|(id, [visible_px, found])| {
            let share = found as f64 / visible_px as f64;
            (visible_px >= LEAST_PX && share < MISSED_BELOW).then_some(Missed {
                id: BoxId(id),
                visible_px,
                share,
            })
        });
        let mut missed: Vec<Missed> = missed.collect();
        missed.sort_by_key(|m| std::cmp::Reverse(m.visible_px));
        missed
    }

    /// Share of the pixels whose class the network says rightly; 1 where the lens sees nothing.
    pub fn right(&self) -> f64 {
        let pairs = || self.truth.pixels.iter().zip(&self.classes);
        let valid = pairs().filter(|(p, _)| p.class != OUTSIDE);
        let all = valid.clone().count().max(1);
        let right = valid.filter(|(p, class)| p.class == **class).count();
        if right == 0 && pairs().all(|(p, _)| p.class == OUTSIDE) {
            return 1.0;
        }
        right as f64 / all as f64
    }

    /// The picture in the colours of the classes that the network sees. Where it misses a thing every other pixel is red, where
    /// it sees one that is none every other pixel is yellow.
    pub fn shown(&self) -> CameraImage {
        let mut image = self.image.clone();
        let width = image.width.max(1);
        let pixels = image.rgba.chunks_exact_mut(4).zip(&self.truth.pixels).zip(&self.classes);
        for (at, ((out, truth), class)) in pixels.enumerate() {
            if truth.class == OUTSIDE {
                continue;
            }
            let wrong = match (is_thing(truth.class), is_thing(*class)) {
                (true, false) => Some(MISSED),
                (false, true) => Some(GHOST),
                _ => None,
            };
            let marked = wrong.filter(|_| (at % width + at / width) % 2 == 0);
            let color = marked.unwrap_or_else(|| truth::color(*class));
            let share = if marked.is_some() { 1.0 } else { TINT };
            for (out, color) in out.iter_mut().zip(color) {
                *out = (f32::from(*out) * (1.0 - share) + f32::from(color) * share).round() as u8;
            }
        }
        image
    }
}

/// Classes of boxes: barrier to truck.
fn is_thing(class: TruthClass) -> bool {
    (1..=10).contains(&class)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Conditions, SensorRig};
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
            let boxes = seen.truth.boxes.iter().filter(|b| b.visible_px as usize >= LEAST_PX).count();
            assert!(seen.missed().len() <= boxes);
            seen.classes.fill(truth::SKY);
            let missed = seen.missed();
            assert_eq!(missed.len(), boxes, "{}", seen.image.camera);
            assert!(missed.is_sorted_by(|a, b| a.visible_px >= b.visible_px));
            let red = seen.shown().rgba.chunks_exact(4).filter(|p| p[..3] == MISSED).count();
            let pixels: usize = missed.iter().map(|m| m.visible_px).sum();
            assert!(red * 3 > pixels, "{red} of {pixels}");
        }
    }
}
