//! A small picture of a variant: the map from above and the front camera.

use std::path::Path;

use anyhow::Context;

use crate::camera_views::camera_input;
use crate::picture::{self, RgbaPicture};
use formats::{atomic, png};
use scene::Scene;
use sensors::cameras::Detail;
use sensors::pictures::appearance::{Appearance, Quality};

/// Name of its file in the variant's folder.
pub const FILE: &str = "thumb.png";
/// Size of the camera's part, pixels; the map is a square of the same height.
const SIZE: [u32; 2] = [213, 120];

/// Draws and writes the picture.
pub fn write(scene: &Scene, path: &Path) -> anyhow::Result<()> {
    let picture = draw(scene);
    let bytes = png::rgba(
        picture.width,
        picture.height,
        &picture.rgba,
        &png::Notes::default(),
    )?;
    atomic::write(path, &bytes).with_context(|| format!("write {}", path.display()))
}

/// The map from above and beside it the view of the front camera, if the rig has a camera.
fn draw(scene: &Scene) -> RgbaPicture {
    let scene = scene.for_sensors();
    let map = fitted(picture::layout_top(scene.frame(), 1), SIZE[1]);
    let front = scene.rig.cameras.iter().find(|c| c.name.ends_with("FRONT"));
    let Some(camera) = front.or(scene.rig.cameras.first()) else {
        return map;
    };
    let input = camera_input(&scene, Detail::Full);
    let appearance = Appearance::with_things(input.frame, input.background, input.rig, &input.conditions);
    let image = appearance.render(camera, SIZE[0], SIZE[1], Quality::Preview);
    let seen = RgbaPicture {
        width: image.width,
        height: image.height,
        rgba: image.rgba,
    };
    RgbaPicture::sheet(&[vec![map, seen]], 2)
}

/// A picture shrunk so that neither side is longer than `side`.
fn fitted(picture: RgbaPicture, side: u32) -> RgbaPicture {
    let (width, height) = (picture.width as u32, picture.height as u32);
    let Some(image) = image::RgbaImage::from_raw(width, height, picture.rgba.clone()) else {
        return picture;
    };
    let share = f64::from(side) / f64::from(width.max(height).max(1));
    let [w, h] = [width, height].map(|v| ((f64::from(v) * share).round() as u32).max(1));
    let small = image::imageops::thumbnail(&image, w, h);
    RgbaPicture {
        width: w as usize,
        height: h as usize,
        rgba: small.into_raw(),
    }
}
