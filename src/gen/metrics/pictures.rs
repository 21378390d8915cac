//! Likeness of pictures where they show the same surface: from one moment to the next, or from camera to camera.

use glam::DVec3;

use scene::Camera;
use sensors::pictures::appearance::CameraImage;

/// Largest relative difference of depths at which two cameras count as seeing the same surface.
const SAME_DEPTH: f64 = 0.05;
/// Least distance from a camera at which surfaces are compared, m.
const NEAREST_M: f64 = 0.1;

/// A picture with its camera and depths.
#[derive(Clone, Copy, Debug)]
pub struct DepthPicture<'a> {
    /// The camera, a pinhole at the size of the picture.
    pub camera: &'a Camera,
    /// The picture.
    pub image: &'a CameraImage,
    /// Depth of each pixel along the optical axis, m; 0 or less where there is no surface.
    pub depth_m: &'a [f32],
}

/// Sum and number of differences.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelDifference {
    sum: f64,
    pixels: usize,
}

impl PixelDifference {
    /// Adds the pixels of `now` that `other` sees too. Their difference is the mean over red, green and blue of the
    /// differences of their colours, 0 to 1. Colours of `other` are interpolated between its pixels.
    pub fn add(&mut self, now: &DepthPicture<'_>, other: &DepthPicture<'_>) {
        let (width, from_camera) = (now.image.width, now.camera.ego_from_camera());
        let to_other = other.camera.ego_from_camera().inverse();
        for (at, depth) in now.depth_m.iter().enumerate().filter(|(_, d)| **d > 0.0) {
            let ray = ray(now.camera, (at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
            let p = to_other.apply(from_camera.apply(ray * f64::from(*depth)));
            if let Some(there) = other.color_at(p) {
                let here = &now.image.rgba[at * 4..at * 4 + 3];
                let apart = here.iter().zip(there).map(|(a, b)| (f64::from(*a) - b).abs());
                self.sum += apart.sum::<f64>() / (3.0 * 255.0);
                self.pixels += 1;
            }
        }
    }

    /// The mean; NaN without pixels.
    pub fn mean(&self) -> f64 {
        self.sum / self.pixels as f64
    }

    /// Number of pixels that were compared.
    pub fn pixels(&self) -> usize {
        self.pixels
    }
}

/// The point at depth 1 m behind a position in a picture, optical frame.
fn ray(camera: &Camera, u: f64, v: f64) -> DVec3 {
    let ([fx, fy], [cx, cy]) = (camera.focal_px, camera.center_px);
    DVec3::new((u - cx) / fx, (v - cy) / fy, 1.0)
}

impl DepthPicture<'_> {
    /// Red, green and blue, 0 to 255, of the surface at a point of the optical frame; `None` if another surface is seen
    /// there.
    fn color_at(&self, p: DVec3) -> Option<[f64; 3]> {
        if p.z <= NEAREST_M {
            return None;
        }
        let ([fx, fy], [cx, cy]) = (self.camera.focal_px, self.camera.center_px);
        let (u, v) = (p.x / p.z * fx + cx - 0.5, p.y / p.z * fy + cy - 0.5);
        let (width, height) = (self.image.width, self.image.height);
        let inside = |a: f64, most: usize| a >= 0.0 && a <= most as f64 - 1.0;
        if !inside(u, width) || !inside(v, height) {
            return None;
        }
        let seen_m = f64::from(self.depth_m[v.round() as usize * width + u.round() as usize]);
        if (seen_m / p.z - 1.0).abs() > SAME_DEPTH {
            return None;
        }
        let (x, y) = (
            (u as usize).min(width.saturating_sub(2)),
            (v as usize).min(height.saturating_sub(2)),
        );
        let (s, t) = (u - x as f64, v - y as f64);
        let pixel = |dx: usize, dy: usize, c: usize| {
            let at = ((y + dy).min(height - 1) * width + (x + dx).min(width - 1)) * 4 + c;
            f64::from(self.image.rgba[at])
        };
        Some([0, 1, 2].map(|c| {
            let row = |dy| pixel(0, dy, c) * (1.0 - s) + pixel(1, dy, c) * s;
            row(0) * (1.0 - t) + row(1) * t
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall 10 m ahead whose brightness grows to the left, as a camera at that place sees it.
    fn wall(left_m: f64) -> (Camera, CameraImage, Vec<f32>) {
        let mut camera = Camera::new("CAM", 60.0).resized(64, 32);
        camera.translation_m = [0.0, left_m, 1.5];
        let pose = camera.ego_from_camera();
        let rgba = (0..64 * 32).flat_map(|at| {
            let p = pose.apply(ray(&camera, (at % 64) as f64 + 0.5, (at / 64) as f64 + 0.5) * 10.0);
            let c = (120.0 + 10.0 * p.y).round() as u8;
            [c, c, c, 255]
        });
        let image = CameraImage {
            camera: camera.name.clone(),
            width: 64,
            height: 32,
            rgba: rgba.collect(),
        };
        (camera, image, vec![10.0; 64 * 32])
    }

    fn taken((camera, image, depth_m): &(Camera, CameraImage, Vec<f32>)) -> DepthPicture<'_> {
        DepthPicture {
            camera,
            image,
            depth_m,
        }
    }

    #[test]
    fn what_is_seen_from_two_places_is_compared_where_both_see_it() {
        let (a, b) = (wall(0.0), wall(1.0));
        let (here, there, mut lit) = (a, b.clone(), b);
        let mut same = PixelDifference::default();
        same.add(&taken(&here), &taken(&there));
        assert!(same.mean() < 0.5 / 255.0, "{}", same.mean());
        assert!((1000..64 * 32).contains(&same.pixels()), "{}", same.pixels());
        // As much brighter everywhere.
        lit.1.rgba.iter_mut().for_each(|c| *c = c.saturating_add(51));
        let mut brighter = PixelDifference::default();
        brighter.add(&taken(&here), &taken(&lit));
        assert!((brighter.mean() - 0.2).abs() < 0.01, "{}", brighter.mean());
        // Another surface, or nothing, is not compared.
        lit.2.fill(4.0);
        let mut none = PixelDifference::default();
        none.add(&taken(&here), &taken(&lit));
        assert!(none.pixels() == 0 && none.mean().is_nan());
    }
}
