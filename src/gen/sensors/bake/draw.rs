//! Draws coloured anisotropic Gaussians: EWA projection, sorted by distance, blended front to back in tiles as in Kerbl
//! et al. 2023 (arXiv 2308.04079). Exact, on the processor: the same picture as in viewers of such files.

use glam::{DVec3, Quat, Vec3};
use rayon::prelude::*;

use super::blend::{Light, Slopes, Sums};
use crate::splat::order::depth_order;
use crate::splat::project::SplatCamera;
use crate::splat::tile::{BlendThresholds, SplatPixels, TILE};
use crate::splat::{Bins, placed};
use scene::splats::SplatOptions;
use scene::{Camera, SceneGaussian};

/// Constants of Kerbl et al.; there is no far limit.
pub const OPTIONS: SplatOptions = SplatOptions {
    near_m: 0.2,
    far_m: 1e7,
    low_pass_px2: 0.3,
    alpha_max: 0.99,
    alpha_min: 1.0 / 255.0,
    t_stop: 1e-4,
    jacobian_clamp: 1.3,
    compensate_opacity: false,
    min_coverage: 0.0,
};

const LIMITS: BlendThresholds = BlendThresholds {
    alpha_min: OPTIONS.alpha_min,
    alpha_max: OPTIONS.alpha_max,
    t_stop: OPTIONS.t_stop,
};

/// A Gaussian as every view projects it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipsoid {
    pub position_m: Vec3,
    /// Principal axes, each as long as the standard deviation along it, m.
    pub axes_m: [Vec3; 3],
    pub opacity: f32,
}

impl Ellipsoid {
    pub fn from_gaussian(g: &SceneGaussian) -> Self {
        let [w, x, y, z] = g.rotation_wxyz;
        let turn = Quat::from_xyzw(x, y, z, w);
        let [a, b, c] = g.std_m;
        Self {
            position_m: Vec3::from(g.position_m),
            axes_m: [turn * Vec3::X * a, turn * Vec3::Y * b, turn * Vec3::Z * c],
            opacity: g.opacity,
        }
    }
}

/// Gaussians projected onto a picture, which can be drawn again and again with other colours.
pub(super) struct Projected {
    pub splats: Vec<SplatPixels>,
    /// Index of the Gaussian of each splat.
    pub of: Vec<u32>,
    bins: Bins,
    size: [usize; 2],
}

impl Projected {
    pub fn new(ellipsoids: &[Ellipsoid], camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let view = SplatCamera::new(camera, width, height, OPTIONS.jacobian_clamp);
        let sight = ViewCone::from_camera(camera, [width, height]);
        let one = |(i, e): (usize, &Ellipsoid)| -> Option<(SplatPixels, u32)> {
            if !sight.may_show(e) {
                return None;
            }
            let axes = e.axes_m.map(|a| a.as_dvec3());
            let near_far = [OPTIONS.near_m, OPTIONS.far_m];
            let around = view.around(e.position_m.as_dvec3(), near_far)?;
            let footprint = around.footprint(axes)?;
            let splat = placed(&footprint, (e.opacity, 0), [width, height], &OPTIONS)?;
            Some((splat, i as u32))
        };
        let found: Vec<(SplatPixels, u32)> = ellipsoids.par_iter().enumerate().filter_map(one).collect();
        let away = |i: u32| ellipsoids[i as usize].position_m.distance(sight.eye);
        let depths: Vec<f32> = found.iter().map(|(_, i)| away(*i)).collect();
        let order = depth_order(&depths);
        let splats: Vec<SplatPixels> = order.iter().map(|i| found[*i as usize].0).collect();
        let size = [width as usize, height as usize];
        Self {
            bins: Bins::new(&splats, size[0], size[1]),
            of: order.iter().map(|i| found[*i as usize].1).collect(),
            splats,
            size,
        }
    }

    /// Calls `one` for each tile: its first pixel, how many pixels it has inside the picture, and its splats.
    fn each_tile(&self, mut one: impl FnMut([usize; 2], [usize; 2], &[u32])) {
        let [w, h] = self.size;
        for tile_y in 0..h.div_ceil(TILE) {
            for tile_x in 0..w.div_ceil(TILE) {
                let origin = [tile_x * TILE, tile_y * TILE];
                let size = [TILE.min(w - origin[0]), TILE.min(h - origin[1])];
                one(origin, size, self.bins.list(tile_x, tile_y));
            }
        }
    }

    /// The picture with these colours of the Gaussians, row-major; black where there are none.
    pub fn picture(&self, colors: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let w = self.size[0];
        let mut out = vec![[0.0; 3]; w * self.size[1]];
        let colors: Vec<[f32; 3]> = self.of.iter().map(|i| colors[*i as usize]).collect();
        let row_of_tiles = |(tile_y, out): (usize, &mut [[f32; 3]])| {
            let mut light = Light::new();
            let rows = out.len() / w;
            for tile_x in 0..w.div_ceil(TILE) {
                let size = [TILE.min(w - tile_x * TILE), rows];
                let place = ([tile_x * TILE, tile_y * TILE], size);
                let list = self.bins.list(tile_x, tile_y);
                light.blend(&self.splats, &colors, list, place, LIMITS);
                for row in 0..rows {
                    let at = row * w + tile_x * TILE;
                    for (column, out) in out[at..at + size[0]].iter_mut().enumerate() {
                        *out = light.pixel(row, column);
                    }
                }
            }
        };
        out.par_chunks_mut(w.max(1) * TILE)
            .enumerate()
            .for_each(row_of_tiles);
        out
    }

    /// For each Gaussian adds up weight times value over all pixels, for the three channels of `values`, and weight squared.
    pub fn gather(&self, values: &[[f32; 3]], sums: &mut [[f32; 4]]) {
        let w = self.size[0];
        let mut light = Light::new();
        self.each_tile(|origin, size, list| {
            if list.is_empty() {
                return;
            }
            let mut tile = Sums::new();
            for row in 0..size[1] {
                let at = (origin[1] + row) * w + origin[0];
                tile.set_row(row, &values[at..at + size[0]]);
            }
            light.gather(
                &self.splats,
                (list, &self.of),
                (origin, size),
                LIMITS,
                &tile,
                sums,
            );
        });
    }

    /// Gradient of a sum over the picture with each splat; `slope` is its gradient with each pixel, `picture` the
    /// picture with these colours of the Gaussians.
    pub fn backward(&self, colors: &[[f32; 3]], picture: &[[f32; 3]], slope: &[[f32; 3]]) -> Vec<Slopes> {
        let w = self.size[0];
        let colors: Vec<[f32; 3]> = self.of.iter().map(|i| colors[*i as usize]).collect();
        let mut out = vec![[0.0; 9]; self.splats.len()];
        let mut light = Light::new();
        self.each_tile(|origin, size, list| {
            if list.is_empty() {
                return;
            }
            let (mut slopes, mut shown) = (Sums::new(), Sums::new());
            for row in 0..size[1] {
                let at = (origin[1] + row) * w + origin[0];
                slopes.set_row(row, &slope[at..at + size[0]]);
                shown.set_row(row, &picture[at..at + size[0]]);
            }
            let place = (origin, size);
            light.backward(
                (&self.splats, &colors, list),
                place,
                LIMITS,
                (&slopes, &shown),
                &mut out,
            );
        });
        out
    }
}

/// A cone around the picture, to leave out early the Gaussians outside it.
struct ViewCone {
    eye: Vec3,
    ahead: Vec3,
    /// Sine and cosine of the angle from the optical axis to a corner; `None` for wide lenses.
    corner: Option<(f32, f32)>,
}

impl ViewCone {
    fn from_camera(camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let rays = crate::raycast::rays::CameraRays::new(camera, width, height);
        let pose = camera.ego_from_camera();
        let (w, h) = (f64::from(width), f64::from(height));
        let ahead = pose.rotation * DVec3::Z;
        let corners = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)].map(|(u, v)| rays.at(u, v).direction);
        let cos = |d: DVec3| d.normalize_or_zero().dot(ahead);
        let least = corners.into_iter().map(cos).fold(1.0, f64::min);
        let corner = (rays.is_plain() && least > 0.3)
            .then(|| ((1.0 - least * least).max(0.0).sqrt() as f32, least as f32));
        Self {
            eye: pose.translation_m.as_vec3(),
            ahead: ahead.as_vec3(),
            corner,
        }
    }

    fn may_show(&self, e: &Ellipsoid) -> bool {
        let Some((sin, cos)) = self.corner else {
            return true;
        };
        let d = e.position_m - self.eye;
        let along = d.dot(self.ahead);
        let aside = (d.length_squared() - along * along).max(0.0).sqrt();
        // Beyond the border of the cone by more than the splat reaches: where alpha ends, at 3.4 deviations.
        let largest = e.axes_m.iter().map(|a| a.length_squared()).fold(0.0, f32::max);
        aside * cos - along * sin < 4.0 * largest.sqrt() + 0.02 * along.abs() + 0.5
    }
}

/// Gaussians made ready to be drawn from many places.
pub struct PreparedGaussians {
    ellipsoids: Vec<Ellipsoid>,
    colors: Vec<[f32; 3]>,
}

impl PreparedGaussians {
    /// Prepares the Gaussians; takes some 60 bytes for each.
    pub fn new(gaussians: &[SceneGaussian]) -> Self {
        Self {
            ellipsoids: gaussians.par_iter().map(Ellipsoid::from_gaussian).collect(),
            colors: gaussians.iter().map(|g| g.color).collect(),
        }
    }

    /// The picture that a camera sees, `width * height` sRGB-coded colours, row-major, top row first; black where there is
    /// nothing. The same on any number of threads.
    pub fn render(&self, camera: &Camera, size: [u32; 2]) -> Vec<[f32; 3]> {
        Projected::new(&self.ellipsoids, camera, size).picture(&self.colors)
    }
}

/// See [`PreparedGaussians::render`].
pub fn render(gaussians: &[SceneGaussian], camera: &Camera, size: [u32; 2]) -> Vec<[f32; 3]> {
    PreparedGaussians::new(gaussians).render(camera, size)
}
