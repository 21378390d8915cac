//! From rays to a picture: samples, more of them at edges, rain and flakes in the air, glare of lamps,
//! exposure and tone.

use std::collections::BTreeMap;

use glam::{IVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::noise::{hash3, ramp, unit, unit3};
use super::prepared::Appearance;
use super::shade::{ShadedSample, VisibleSurface};
use super::sparse;
use super::truth::{NextMoment, Teller, usable};
use super::{CameraImage, Quality};
use crate::raycast::rays::{CameraRay, CameraRays};
use scene::appearance::CONTRAST;
use scene::{BoxId, Camera, CameraTruth, SceneBox, TruthPixel};

impl Appearance {
    /// The picture of one camera at `width` x `height` px.
    pub fn render(&self, camera: &Camera, width: u32, height: u32, quality: Quality) -> CameraImage {
        let light = self.gather((camera, [width, height]), quality, Drops::Drawn, (None, &|| true));
        self.finish(camera, [width as usize, height as usize], light)
    }

    /// The picture of [`Self::render`], as long as it is wanted: `None` once `goes_on` says that it is not.
    pub fn render_while(
        &self,
        camera: &Camera,
        [width, height]: [u32; 2],
        quality: Quality,
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Option<CameraImage> {
        let light = self.gather((camera, [width, height]), quality, Drops::Drawn, (None, goes_on));
        goes_on().then(|| self.finish(camera, [width as usize, height as usize], light))
    }

    /// Renders the picture of [`Self::render`] without effects of the lens and of the moment: no rain or flakes in the
    /// air, no glare, no darkened corners, no noise. sRGB-coded, 0 to 1, row-major, top row first.
    pub fn render_plain(
        &self,
        camera: &Camera,
        [width, height]: [u32; 2],
        quality: Quality,
    ) -> Vec<[f32; 3]> {
        let light = self.gather(
            (camera, [width, height]),
            quality,
            Drops::LeftOut,
            (None, &|| true),
        );
        let shown = light.par_iter().map(|c| self.shown(*c, 1.0).to_array());
        shown.collect()
    }

    /// Renders the picture of [`Self::render`] and its ground truth: each pixel is labelled by a hit that made its
    /// colour. If four samples make a pixel, this is the nearest of those that show what most of them show. `boxes` are
    /// those of the frame; flow leads to `next`.
    pub fn render_truth(
        &self,
        camera: &Camera,
        size: [u32; 2],
        quality: Quality,
        boxes: &BTreeMap<BoxId, SceneBox>,
        next: Option<&NextMoment<'_>>,
    ) -> (CameraImage, CameraTruth) {
        let teller = Teller::new(self, camera, size, next);
        let mut pixels = vec![TruthPixel::default(); size[0] as usize * size[1] as usize];
        let light = self.gather(
            (camera, size),
            quality,
            Drops::Drawn,
            (Some((&teller, &mut pixels)), &|| true),
        );
        let image = self.finish(camera, size.map(|n| n as usize), light);
        let truth = self.finish_truth(&teller, camera, size, boxes, pixels, next);
        (image, truth)
    }

    /// The light of every pixel, linear. Rows that are not wanted any more stay black.
    fn gather(
        &self,
        (camera, [width, height]): (&Camera, [u32; 2]),
        quality: Quality,
        drops: Drops,
        (truth, goes_on): (Option<ToldPixels<'_>>, &(dyn Fn() -> bool + Sync)),
    ) -> Vec<Vec3> {
        let (w, h) = (width as usize, height as usize);
        let rays = CameraRays::new(camera, width, height);
        let pixel = rays.optics().pixel_rad() as f32;
        let at = |u: f64, v: f64| {
            let ray = rays.at(u, v);
            let (o, d) = usable(&ray)?;
            let (mut sample, seen) = self.light_along((o, d), ray.after_s as f32, pixel);
            if drops == Drops::Drawn {
                sample.color = self.falling(o, d, sample.t, pixel, sample.color);
            }
            if !sample.color.is_finite() {
                sample.color = Vec3::ZERO;
            }
            Some((sample, seen, ray))
        };
        let (teller, told) = truth.unzip();
        let told = told.unwrap_or_default();
        // The truth is told for every pixel.
        let sparse = quality == Quality::Play && teller.is_none();
        let mut samples = vec![ShadedSample::default(); w * h];
        let row_of = |y: usize, row: &mut [ShadedSample], mut told: Option<&mut [TruthPixel]>| {
            if !goes_on() {
                return;
            }
            for (x, out) in row.iter_mut().enumerate() {
                if sparse && sparse::is_between(x, y) {
                    continue;
                }
                let uv = (x as f64 + 0.5, y as f64 + 0.5);
                let Some((sample, seen, ray)) = at(uv.0, uv.1) else {
                    continue;
                };
                *out = sample;
                if let (Some(teller), Some(told)) = (teller, &mut told) {
                    told[x] = teller.pixel(&seen, &ray, uv);
                }
            }
        };
        if !samples.is_empty() {
            each_row(w, &mut samples, &mut *told, row_of);
        }
        if sparse {
            let sample = |x: usize, y: usize| at(x as f64 + 0.5, y as f64 + 0.5).map(|(sample, ..)| sample);
            sparse::fill(&mut samples, w, |c| self.tone(c), sample);
        }
        let mut light: Vec<Vec3> = samples.iter().map(|s| s.color).collect();
        if quality == Quality::Full && w > 1 && h > 1 {
            // Clamped, so that a single spark does not fill a pixel with steps.
            let limit = Vec3::splat(5.0 / self.air.exposure);
            let rough = |x: usize, y: usize| {
                let s = &samples[y * w + x];
                let tone = |c: Vec3| self.tone(c);
                let near = [
                    (x.wrapping_sub(1), y),
                    (x + 1, y),
                    (x, y.wrapping_sub(1)),
                    (x, y + 1),
                ];
                near.into_iter().any(|(x, y)| {
                    x < w && y < h && {
                        let o = &samples[y * w + x];
                        (tone(o.color) - tone(s.color)).abs() > CONTRAST
                            || o.key != s.key && (tone(o.color) - tone(s.color)).abs() > 0.03
                    }
                })
            };
            let row_of = |y: usize, row: &mut [Vec3], mut told: Option<&mut [TruthPixel]>| {
                if !goes_on() {
                    return;
                }
                for (x, out) in row.iter_mut().enumerate() {
                    if !rough(x, y) {
                        continue;
                    }
                    // Four places turned against the pixel's sides.
                    let places = [(0.375, 0.125), (0.875, 0.375), (0.625, 0.875), (0.125, 0.625)];
                    let four = places.map(|(u, v)| at(x as f64 + u, y as f64 + v));
                    let color = |s: &Option<(ShadedSample, VisibleSurface, CameraRay)>| {
                        s.as_ref().map_or(Vec3::ZERO, |s| s.0.color.min(limit))
                    };
                    *out = four.iter().map(color).sum::<Vec3>() / 4.0;
                    if let (Some(teller), Some(told)) = (teller, &mut told)
                        && let Some(i) = foremost(&four)
                        && let Some((_, seen, ray)) = &four[i]
                    {
                        told[x] = teller.pixel(seen, ray, (x as f64 + places[i].0, y as f64 + places[i].1));
                    }
                }
            };
            each_row(w, &mut light, &mut *told, row_of);
        }
        light
    }

    /// Brightness as it is seen, for comparing pixels.
    fn tone(&self, c: Vec3) -> f32 {
        (c.element_sum() * self.air.exposure).sqrt()
    }

    /// The picture of light that was computed elsewhere, `width * height` linear colours: glare, exposure, tone.
    pub fn picture(&self, camera: &Camera, width: u32, height: u32, light: &[[f32; 3]]) -> CameraImage {
        let (w, h) = (width as usize, height as usize);
        let mut light: Vec<Vec3> = light.iter().map(|c| Vec3::from_array(*c)).collect();
        light.resize(w * h, Vec3::ZERO);
        self.finish(camera, [w, h], light)
    }

    fn finish(&self, camera: &Camera, [w, h]: [usize; 2], mut light: Vec<Vec3>) -> CameraImage {
        glare(&mut light, w, h, self.air.lamps, self.air.exposure);
        let rgba = light
            .par_iter()
            .enumerate()
            .flat_map_iter(|(i, c)| {
                let (x, y) = (i % w, i / w);
                self.develop(
                    *c,
                    Vec2::new(x as f32 / w as f32, y as f32 / h as f32) - 0.5,
                    x,
                    y,
                )
            })
            .collect();
        CameraImage {
            camera: camera.name.clone(),
            width: w,
            height: h,
            rgba,
        }
    }

    /// Rain, snow and dust between the camera and what it sees: drops and flakes sit on cylinders around
    /// the vehicle, so that all cameras see the same ones.
    fn falling(&self, o: Vec3, d: Vec3, t: f32, pixel: f32, mut color: Vec3) -> Vec3 {
        let air = &self.air;
        let (rain, snow) = (air.rain, air.snow > 0.0);
        if !rain && !snow {
            return color;
        }
        let flat = d.truncate().length_squared();
        let o = o - self.vehicle.extend(0.0);
        let radii: &[f32] = if rain {
            &[3.2, 5.0, 7.5, 11.0]
        } else {
            &[2.9, 4.0, 5.2, 6.6, 8.2, 10.0, 12.5, 15.5, 19.0]
        };
        for (layer, radius) in radii.iter().enumerate() {
            let b = o.truncate().dot(d.truncate());
            let c = o.truncate().length_squared() - radius * radius;
            let disc = b * b - flat * c;
            if flat < 1e-6 || disc <= 0.0 || c > 0.0 {
                continue;
            }
            let at = (-b + disc.sqrt()) / flat;
            if at > t {
                break;
            }
            let p = self.anchor_dir(o + d * at);
            let s = p.y.atan2(p.x) * radius;
            let px = at * pixel;
            if rain {
                let cell = Vec2::new(0.11, 0.62);
                let q = Vec2::new(s + p.z * (0.05 + 0.015 * layer as f32), p.z + 0.37 * layer as f32) / cell;
                let c = q.floor().as_ivec2();
                let h = hash3(IVec3::new(c.x, c.y, layer as i32), self.seed ^ 0x7a1);
                if h % 100 < 40 {
                    let x = ((q.x - c.x as f32) - 0.2 - 0.6 * unit(h)).abs() * cell.x;
                    let y = (q.y - c.y as f32 - 0.5).abs();
                    let half = 0.0022f32.max(px * 0.55);
                    let line = ramp(half, half * 0.4, x) * ramp(0.5, 0.25, y);
                    let share = 0.13 * (0.0022 / half).powf(0.7) * line;
                    color = color.lerp(air.ambient * 0.75 + air.haze * 0.4, share);
                }
            } else {
                let cell = 0.22 + 0.02 * layer as f32;
                let q = Vec2::new(s, p.z) / cell;
                let c = q.floor().as_ivec2();
                let h = hash3(IVec3::new(c.x, c.y, layer as i32), self.seed ^ 0x5e0);
                if h % 100 < 46 {
                    let middle = Vec2::new(
                        unit3(IVec3::new(c.x, c.y, 1), h),
                        unit3(IVec3::new(c.x, c.y, 2), h),
                    ) * 0.7
                        + 0.15;
                    let off = (q - c.as_vec2() - middle) * cell * Vec2::new(1.0, 0.8);
                    let radius = 0.0035 + 0.0055 * unit(h);
                    let r = radius.max(px * 0.6);
                    let share = 0.75 * (radius / r).powi(2) * ramp(r * 1.15, r * 0.3, off.length());
                    color = color.lerp(air.ambient * 0.95 + air.haze * 0.1, share);
                }
            }
        }
        color
    }

    /// Exposure, tone curve, fine sensor noise (the only thing that belongs to the pixel), sRGB.
    fn develop(&self, c: Vec3, at: Vec2, x: usize, y: usize) -> [u8; 4] {
        let vignette = 1.0 - 0.34 * at.length_squared();
        let shown = self.shown(c, vignette);
        let noise =
            unit3(IVec3::new(x as i32, y as i32, 5), 99) - unit3(IVec3::new(x as i32, y as i32, 6), 99);
        let strength = 0.006 + 0.010 * ramp(0.9, 1.0, self.air.lamps);
        let byte = |v: f32| ((v + noise * strength).clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        [byte(shown.x), byte(shown.y), byte(shown.z), 255]
    }

    /// Exposure, tone curve and sRGB, 0 to 1; `left` is the share of the light that the lens lets through.
    pub(super) fn shown(&self, c: Vec3, left: f32) -> Vec3 {
        let c = film(c.max(Vec3::ZERO) * (self.air.exposure * left));
        c.map(|v| {
            if v <= 0.003_130_8 {
                12.92 * v
            } else {
                1.055 * v.powf(1.0 / 2.4) - 0.055
            }
        })
    }
}

/// Who tells the truth about pixels, and the pixels.
type ToldPixels<'a> = (&'a Teller<'a>, &'a mut [TruthPixel]);

/// Whether what falls between camera and surface is drawn.
#[derive(Clone, Copy, PartialEq)]
enum Drops {
    /// Rain and flakes, where they fall.
    Drawn,
    /// Haze alone.
    LeftOut,
}

/// Calls `one` for each row of `values`, with its row of `told` where there is one.
fn each_row<T: Send>(
    w: usize,
    values: &mut [T],
    told: &mut [TruthPixel],
    one: impl Fn(usize, &mut [T], Option<&mut [TruthPixel]>) + Sync,
) {
    match told.is_empty() {
        true => {
            let rows = values.par_chunks_mut(w).enumerate();
            rows.for_each(|(y, row)| one(y, row, None));
        }
        false => {
            let rows = values.par_chunks_mut(w).zip(told.par_chunks_mut(w)).enumerate();
            rows.for_each(|(y, (row, told))| one(y, row, Some(told)));
        }
    }
}

/// Index of the sample that labels a pixel: the nearest of those that show what most samples show. On a tie the nearest
/// sample wins.
fn foremost(samples: &[Option<(ShadedSample, VisibleSurface, CameraRay)>; 4]) -> Option<usize> {
    let thing = |i: usize| samples[i].as_ref().map(|(sample, ..)| sample.key >> 8);
    let like = |i: usize| (0..4).filter(|j| thing(*j) == thing(i)).count();
    let rank = |i: &usize| {
        let t = samples[*i]
            .as_ref()
            .map_or(f32::INFINITY, |(sample, ..)| sample.t);
        (std::cmp::Reverse(like(*i)), t.to_bits())
    };
    (0..4).filter(|i| samples[*i].is_some()).min_by_key(rank)
}

/// The filmic curve of K. Narkowicz (2015), an approximation of ACES, with colours drawn a little
/// towards grey as they burn out.
fn film(c: Vec3) -> Vec3 {
    let c = c.lerp(
        Vec3::splat(c.element_sum() / 3.0),
        ramp(0.8, 6.0, c.max_element()) * 0.5,
    );
    let curve = |x: f32| (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
    c.map(|v| curve(v * 0.92).clamp(0.0, 1.0))
}

/// Adds light scattered in the lens: what is brighter than white, blurred at a quarter of the size.
fn glare(light: &mut [Vec3], w: usize, h: usize, lamps: f32, exposure: f32) {
    let (sw, sh) = (w.div_ceil(4), h.div_ceil(4));
    if sw < 2 || sh < 2 {
        return;
    }
    let mut small = vec![Vec3::ZERO; sw * sh];
    for (i, c) in light.iter().enumerate() {
        let bright = (*c * exposure - 1.1).max(Vec3::ZERO).min(Vec3::splat(14.0));
        small[i / w / 4 * sw + i % w / 4] += bright / 16.0;
    }
    let blur = |from: &[Vec3], reach: isize| {
        let pass = |from: &[Vec3], along_x: bool| {
            let mut out = vec![Vec3::ZERO; from.len()];
            out.par_chunks_mut(sw).enumerate().for_each(|(y, row)| {
                for (x, out) in row.iter_mut().enumerate() {
                    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
                    for k in -reach..=reach {
                        let weight = (-(k * k) as f32 / (0.18 * (reach * reach) as f32)).exp();
                        total += weight;
                        let (px, py) = if along_x {
                            (x.wrapping_add_signed(k), y)
                        } else {
                            (x, y.wrapping_add_signed(k))
                        };
                        if px < sw && py < sh {
                            sum += from[py * sw + px] * weight;
                        }
                    }
                    *out = sum / total;
                }
            });
            out
        };
        pass(&pass(from, true), false)
    };
    let reach = (sw / 40).max(1) as isize;
    let (near, far) = (blur(&small, reach), blur(&small, reach * 4));
    let strength = (0.10 + 0.30 * lamps) / exposure;
    for (i, c) in light.iter_mut().enumerate() {
        // Between the middles of the small pixels.
        let (x, y) = ((i % w) as f32 / 4.0 - 0.375, (i / w) as f32 / 4.0 - 0.375);
        let (x0, y0) = (x.floor().max(0.0) as usize, y.floor().max(0.0) as usize);
        let (fx, fy) = ((x - x0 as f32).clamp(0.0, 1.0), (y - y0 as f32).clamp(0.0, 1.0));
        let (x1, y1) = ((x0 + 1).min(sw - 1), (y0 + 1).min(sh - 1));
        let at = |x: usize, y: usize| near[y * sw + x] * 0.55 + far[y * sw + x] * 0.9;
        let low = at(x0, y0).lerp(at(x1, y0), fx);
        let high = at(x0, y1).lerp(at(x1, y1), fx);
        *c += low.lerp(high, fy) * strength;
    }
}
