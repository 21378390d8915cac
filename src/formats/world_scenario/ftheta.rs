//! The f-theta camera: the angle of a ray from the optical axis is a polynomial of its distance from the principal
//! point.
//!
//! World scenarios know this model alone. Any other camera, also a pinhole, is brought to it by a fit of the angle over
//! the distance in pixels: within a tenth of a pixel up to a view 105 degrees wide (of 1600 pixels), 0.45 pixels at 120
//! degrees.

use glam::{DVec2, DVec3};
use numeric::linear::solve;
use scene::{Camera, Lens, Optics};

/// Coefficients above the constant one, which is 0.
const TERMS: usize = 5;
/// Distances from the principal point at which the fit is made, and at which its error is looked for.
const SAMPLES: usize = 400;
const CHECKS: usize = 2000;
/// Points of the picture along each side at which its error is looked for.
const CELLS: usize = 32;
/// Rounds of reweighting after which the greatest error is as small as it gets.
const ROUNDS: usize = 200;
/// The model goes on straight beyond the corners of the picture for this angle, rad.
const BEYOND_RAD: f64 = 0.2;

/// An f-theta camera; optical axes x right, y down, z forward. Pixel (0, 0) reaches from 0 to 1 on both axes.
#[derive(Clone, Debug, PartialEq)]
pub struct FTheta {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Principal point, pixels.
    pub center_px: [f64; 2],
    /// Angle from the optical axis in rad over the distance from the principal point in pixels: coefficients of the powers 0 to 5.
    pub angle_of_px: [f64; TERMS + 1],
    /// Pixels along x for one along y.
    pub linear_c: f64,
    /// How far a point of the picture is from where the camera that was fitted has it, at most, pixels.
    pub error_px: f64,
    farthest_px: f64,
}

impl FTheta {
    /// The model of a camera. Tangential distortion and a rolling shutter are left out.
    pub fn from_camera(camera: &Camera) -> Self {
        let [fx, fy] = camera.focal_px;
        let linear_c = fx / fy;
        let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        let center = DVec2::from_array(camera.center_px);
        let corner = center.abs().max((size - center).abs());
        let corner_px = DVec2::new(corner.x / linear_c, corner.y).length();
        // The lens alone, without tangential distortion.
        let radial = Camera {
            focal_px: [1.0; 2],
            center_px: [0.0; 2],
            lens: match camera.lens {
                Lens::Distorted { k, .. } => Lens::Distorted { k, p: [0.0; 2] },
                lens => lens,
            },
            ..camera.clone()
        };
        let optics = Optics::new(&radial);
        let angle_of = |r_px: f64| {
            let way = optics.direction(r_px / fy, 0.0);
            (way != DVec3::ZERO).then(|| way.x.atan2(way.z))
        };
        let farthest_px = last(corner_px, |r_px| angle_of(r_px).is_some());
        let angle_of = |r_px: f64| angle_of(r_px.clamp(0.0, farthest_px)).unwrap_or_default();
        let mut out = Self {
            width: camera.width,
            height: camera.height,
            center_px: camera.center_px,
            angle_of_px: [0.0; TERMS + 1],
            linear_c,
            error_px: 0.0,
            farthest_px,
        };
        // The factor from an error of the angle to one in pixels.
        let px_per_rad = |r_px: f64| {
            let step = farthest_px * 1e-4;
            let (near, far) = ((r_px - step).max(0.0), (r_px + step).min(farthest_px));
            (far - near) / (angle_of(far) - angle_of(near)).max(1e-12)
        };
        out.angle_of_px = fitted(farthest_px, angle_of, px_per_rad);
        let off_px = |i: usize| {
            let r_px = farthest_px * i as f64 / CHECKS as f64;
            (out.px_of_angle(angle_of(r_px)) - r_px).abs() * linear_c.max(1.0)
        };
        let along_px = (1..=CHECKS).map(off_px).fold(0.0, f64::max);
        out.error_px = out.off_px(camera).fold(along_px, f64::max);
        out
    }

    /// How far points all over the picture are from where a camera has them, pixels.
    fn off_px(&self, camera: &Camera) -> impl Iterator<Item = f64> {
        let optics = Optics::new(camera);
        let at = |i: usize, side: u32| f64::from(side) * i as f64 / CELLS as f64;
        let pixels = (0..=CELLS).flat_map(move |i| (0..=CELLS).map(move |j| (i, j)));
        pixels.filter_map(move |(i, j)| {
            let pixel = DVec2::new(at(i, camera.width), at(j, camera.height));
            let way = optics.direction(pixel.x, pixel.y);
            (way != DVec3::ZERO).then(|| {
                self.project(way)
                    .map_or(f64::INFINITY, |found| found.distance(pixel))
            })
        })
    }

    /// The view in a picture of another size with the same aspect ratio.
    pub fn resized(&self, width: u32, height: u32) -> Self {
        let sx = f64::from(width) / f64::from(self.width);
        let sy = f64::from(height) / f64::from(self.height);
        let mut angle_of_px = self.angle_of_px;
        for (power, coefficient) in angle_of_px.iter_mut().enumerate() {
            *coefficient /= sy.powi(power as i32);
        }
        Self {
            width,
            height,
            center_px: [self.center_px[0] * sx, self.center_px[1] * sy],
            angle_of_px,
            linear_c: self.linear_c * sx / sy,
            error_px: self.error_px * sx.max(sy),
            farthest_px: self.farthest_px * sy,
        }
    }

    /// Angle, rad, of a ray that meets the picture at this distance from the principal point (in pixels along y).
    pub fn angle(&self, r_px: f64) -> f64 {
        self.angle_of_px.iter().rev().fold(0.0, |sum, k| sum * r_px + k)
    }

    /// Angle from the optical axis beyond which nothing is projected, rad.
    pub fn widest_rad(&self) -> f64 {
        self.angle(self.farthest_px) + BEYOND_RAD
    }

    fn slope(&self, r_px: f64) -> f64 {
        let powers = self.angle_of_px.iter().enumerate().skip(1).rev();
        powers.fold(0.0, |sum, (power, k)| sum * r_px + power as f64 * k)
    }

    /// Distance from the principal point of a ray at an angle; beyond the corners it goes on straight.
    fn px_of_angle(&self, angle_rad: f64) -> f64 {
        let last_rad = self.angle(self.farthest_px);
        if angle_rad >= last_rad {
            return self.farthest_px + (angle_rad - last_rad) / self.slope(self.farthest_px);
        }
        let (mut low, mut high) = (0.0, self.farthest_px);
        let mut r_px = self.farthest_px * angle_rad / last_rad;
        for _ in 0..60 {
            let off = self.angle(r_px) - angle_rad;
            if off > 0.0 {
                high = r_px
            } else {
                low = r_px
            }
            let next = r_px - off / self.slope(r_px);
            // Newton, and halving where it leaves the bracket.
            let next = if next > low && next < high {
                next
            } else {
                (low + high) / 2.0
            };
            if (next - r_px).abs() < 1e-9 {
                return next;
            }
            r_px = next;
        }
        r_px
    }

    /// Where a point (optical axes, m) is in the picture, pixels. `None` far beyond its corners and for the camera itself.
    pub fn project(&self, point_m: DVec3) -> Option<DVec2> {
        let aside = point_m.truncate();
        let (aside_m, distance_m) = (aside.length(), point_m.length());
        if distance_m.is_nan() || distance_m <= 1e-9 {
            return None;
        }
        let angle_rad = aside_m.atan2(point_m.z);
        if angle_rad > self.widest_rad() {
            return None;
        }
        let direction = aside.try_normalize().unwrap_or_default();
        let at = direction * self.px_of_angle(angle_rad);
        Some(DVec2::new(at.x * self.linear_c, at.y) + DVec2::from_array(self.center_px))
    }
}

/// The greatest length up to `most` for which `holds` is true, if it is true for all shorter ones.
fn last(most: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if holds(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    low
}

/// Coefficients of the powers 1 to 5 that keep the greatest error in pixels small: least squares, with more weight where the
/// error was large (Lawson 1961).
fn fitted(
    farthest_px: f64,
    angle_of: impl Fn(f64) -> f64,
    px_per_rad: impl Fn(f64) -> f64,
) -> [f64; TERMS + 1] {
    let at = |i: usize| (i + 1) as f64 / SAMPLES as f64;
    let rows: Vec<([f64; TERMS], f64, f64)> = (0..SAMPLES)
        .map(|i| {
            let r_px = at(i) * farthest_px;
            let powers = std::array::from_fn(|k| at(i).powi(k as i32 + 1));
            (powers, angle_of(r_px), px_per_rad(r_px))
        })
        .collect();
    let mut weights = vec![1.0; SAMPLES];
    let (mut best, mut least_px) = (vec![0.0; TERMS], f64::INFINITY);
    for _ in 0..ROUNDS {
        let mut normal = vec![vec![0.0; TERMS + 1]; TERMS];
        for ((powers, angle, scale), weight) in rows.iter().zip(&weights) {
            let weight = weight * scale * scale;
            for (row, p) in normal.iter_mut().zip(powers) {
                for (cell, q) in row.iter_mut().zip(powers.iter().chain([angle])) {
                    *cell += weight * p * q;
                }
            }
        }
        let Some(solution) = solve(normal) else {
            break;
        };
        let off_px = |(powers, angle, scale): &([f64; TERMS], f64, f64)| {
            let found: f64 = powers.iter().zip(&solution).map(|(p, k)| p * k).sum();
            (found - angle).abs() * scale
        };
        let worst_px = rows.iter().map(off_px).fold(0.0, f64::max);
        for (weight, row) in weights.iter_mut().zip(&rows) {
            *weight *= off_px(row) / worst_px.max(1e-300) + 1e-3;
        }
        let most = weights.iter().copied().fold(0.0, f64::max);
        weights.iter_mut().for_each(|w| *w /= most);
        if worst_px < least_px {
            (best, least_px) = (solution, worst_px);
        }
    }
    let mut out = [0.0; TERMS + 1];
    for (k, coefficient) in best.iter().enumerate() {
        out[k + 1] = coefficient / farthest_px.powi(k as i32 + 1);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::SensorRig;

    #[test]
    fn the_cameras_of_the_rig_are_met_within_a_tenth_of_a_pixel() {
        let rig = SensorRig::default();
        for camera in &rig.cameras {
            let model = FTheta::from_camera(camera);
            assert!(model.error_px < 0.1, "{}: {} px", camera.name, model.error_px);
            // By points of the picture, not by the fit's own measure.
            let mut worst_px: f64 = 0.0;
            for (u, v) in (0..=16).flat_map(|i| (0..=9).map(move |j| (i * 100, j * 100))) {
                let pixel = DVec2::new(f64::from(u), f64::from(v));
                let [fx, fy] = camera.focal_px;
                let at = (pixel - DVec2::from_array(camera.center_px)) / DVec2::new(fx, fy);
                let found = model.project(at.extend(1.0) * 7.0).expect("in the picture");
                worst_px = worst_px.max(found.distance(pixel));
            }
            assert!(
                worst_px < 0.1 && worst_px <= model.error_px + 1e-6,
                "{}: {worst_px} px",
                camera.name
            );
        }
        // How wide a pinhole may be: the error grows quickly beyond.
        for (fov_deg, most_px) in [(30.0, 0.001), (90.0, 0.04), (105.0, 0.1), (120.0, 0.5)] {
            let found = FTheta::from_camera(&Camera::new("CAM", fov_deg)).error_px;
            assert!(found < most_px, "{fov_deg} degrees: {found} px");
        }
        assert!(FTheta::from_camera(&Camera::new("CAM", 120.0)).error_px > 0.1);
    }

    #[test]
    fn lenses_of_all_kinds_are_met_and_what_cannot_be_is_told() {
        let with = |lens: Lens, focal_px: f64| {
            let mut camera = Camera {
                lens,
                ..Camera::new("CAM", 90.0)
            };
            camera.focal_px = [focal_px; 2];
            FTheta::from_camera(&camera)
        };
        let fisheye = Lens::Fisheye {
            k: [-0.012, 0.009, -0.007, 0.0015],
            max_angle_deg: 100.0,
        };
        let f_theta = Lens::FTheta {
            c: [1.0, -0.01, 0.02, -0.015, 0.002, 0.0],
            max_angle_deg: 100.0,
        };
        for lens in [fisheye, f_theta] {
            let model = with(lens, 520.0);
            assert!(model.error_px < 0.6, "{}: {} px", lens.name(), model.error_px);
            // It sees what is beside and behind it, where the picture goes that far.
            assert!(
                model.widest_rad() > 1.6,
                "{}: {} rad",
                lens.name(),
                model.widest_rad()
            );
            assert!(model.project(DVec3::new(1.0, 0.0, 0.05)).is_some());
        }
        let k = [-0.33, 0.13, -0.02, 0.0, 0.0, 0.0];
        let radial = with(Lens::Distorted { k, p: [0.0; 2] }, 1200.0);
        assert!(radial.error_px < 0.2, "{} px", radial.error_px);
        // What is bent to one side has no place in the model: the error says so.
        let aside = with(Lens::Distorted { k, p: [3e-3, -2e-3] }, 1200.0);
        assert_eq!(aside.angle_of_px, radial.angle_of_px);
        assert!((0.5..20.0).contains(&aside.error_px), "{} px", aside.error_px);
    }

    #[test]
    fn pixels_that_are_not_square_and_other_sizes() {
        let mut camera = Camera::new("CAM", 70.0);
        camera.focal_px[0] *= 1.3;
        camera.center_px = [700.0, 470.0];
        let model = FTheta::from_camera(&camera);
        assert!(model.error_px < 0.1, "{}", model.error_px);
        let p = DVec3::new(0.4, -0.3, 1.0);
        let [fx, fy] = camera.focal_px;
        let expected = DVec2::new(700.0 + 0.4 * fx, 470.0 - 0.3 * fy);
        assert!(model.project(p).expect("in the picture").distance(expected) < 0.1);
        let half = model.resized(800, 450);
        assert!(half.project(p).expect("in the picture").distance(expected / 2.0) < 0.05);
        assert!((half.angle(100.0) - model.angle(200.0)).abs() < 1e-12);
    }

    #[test]
    fn what_is_behind_is_not_in_the_picture() {
        let model = FTheta::from_camera(&Camera::new("CAM", 90.0));
        assert_eq!(model.project(DVec3::new(0.0, 0.1, -5.0)), None);
        assert_eq!(model.project(DVec3::ZERO), None);
        assert_eq!(model.project(DVec3::NAN), None);
        let ahead = model.project(DVec3::Z * 3.0).expect("straight ahead");
        assert!(ahead.distance(DVec2::new(800.0, 450.0)) < 1e-9);
        // A little beyond the corner it goes on, so that what reaches into the picture is drawn.
        let corner = model.project(DVec3::new(1.4, 0.75, 1.0)).expect("just outside");
        assert!(corner.x > 1600.0 && corner.y > 900.0);
    }
}
