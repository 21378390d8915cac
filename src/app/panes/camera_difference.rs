//! Differences between pictures of two states: equal parts are grey and dim.

use std::sync::Arc;

use egui::{Color32, ColorImage, TextureHandle, TextureOptions, Ui};

use crate::camera_views::CameraView;
use sensors::cameras::ViewId;

/// Largest difference of a colour channel at which pixels count as equal; a coarse picture differs slightly from a fine
/// one.
const ALIKE: u8 = 10;

/// Pictures of differences, and the pictures that they were made from.
#[derive(Default)]
pub(super) struct Differing {
    textures: Vec<Option<TextureHandle>>,
    made_from: Option<[Arc<Vec<CameraView>>; 2]>,
    shown: Option<(ViewId, f64)>,
}

impl Differing {
    /// Updates the pictures.
    pub fn refresh(
        &mut self,
        ui: &Ui,
        now: &Arc<Vec<CameraView>>,
        before: &Arc<Vec<CameraView>>,
        (view, plane_m): (ViewId, f64),
    ) {
        let known = self
            .made_from
            .as_ref()
            .is_some_and(|[a, b]| Arc::ptr_eq(a, now) && Arc::ptr_eq(b, before));
        if known && self.shown == Some((view, plane_m)) {
            return;
        }
        let count = now.iter().map(|v| v.camera + 1).max().unwrap_or(0);
        self.textures.resize(count, None);
        for of_camera in now.iter() {
            let Some(other) = before.iter().find(|v| v.camera == of_camera.camera) else {
                continue;
            };
            let image = difference(&of_camera.colors(view, plane_m), &other.colors(view, plane_m));
            match &mut self.textures[of_camera.camera] {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                empty => {
                    *empty = Some(
                        ui.ctx()
                            .load_texture("camera difference", image, TextureOptions::LINEAR),
                    )
                }
            }
        }
        (self.made_from, self.shown) = (Some([now.clone(), before.clone()]), Some((view, plane_m)));
    }

    /// The texture of one camera; `None` if there is none.
    pub fn texture(&self, camera: usize) -> Option<&TextureHandle> {
        self.textures.get(camera).and_then(Option::as_ref)
    }
}

/// The later picture, in its colours where it differs from the earlier one, elsewhere grey and dim. Pictures of
/// different sizes differ everywhere.
fn difference(now: &ColorImage, before: &ColorImage) -> ColorImage {
    if now.size != before.size {
        return now.clone();
    }
    let mut out = now.clone();
    for (pixel, other) in out.pixels.iter_mut().zip(&before.pixels) {
        let [r, g, b, _] = pixel.to_array();
        let off = |a: u8, b: u8| a.abs_diff(b) > ALIKE;
        if !(off(r, other.r()) || off(g, other.g()) || off(b, other.b())) {
            let luma = (u32::from(r) * 3 + u32::from(g) * 6 + u32::from(b)) / 10;
            *pixel = Color32::from_gray((luma / 4) as u8 + 12);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_differs_keeps_its_colour() {
        let before = ColorImage::filled([2, 1], Color32::from_rgb(200, 100, 50));
        let mut now = before.clone();
        now.pixels[1] = Color32::from_rgb(20, 100, 50);
        let shown = difference(&now, &before);
        assert_eq!(shown.pixels[1], now.pixels[1]);
        let [r, g, b, _] = shown.pixels[0].to_array();
        assert!(r == g && g == b && r < 60);
        let small = ColorImage::filled([1, 1], Color32::RED);
        assert_eq!(difference(&now, &small), now);
    }
}
