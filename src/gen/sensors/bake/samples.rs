//! Looks at a scene from many cameras: what their rays meet, and the pictures themselves.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use crate::pictures::appearance::{Appearance, Probe};
use crate::raycast::rays::CameraRays;
use scene::Camera;
use scene::truth::{self, TruthClass};

/// A place that a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceSample {
    pub at: Vec3,
    /// Width of a pixel there across the ray, m.
    pub width_m: f32,
    /// Surface that a pixel covers there, m^2.
    pub area_m2: f32,
    /// sRGB-coded.
    pub rgb: [u8; 3],
    /// True if it lies beside another surface in its picture.
    pub is_edge: bool,
    /// Outward normal, 127 is 1.
    pub normal: [i8; 3],
    /// One of [`Sampled::groups`].
    pub group: u16,
}

/// Surface that a group of samples shows; the samples of one group may become one Gaussian.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SampleGroup {
    /// Instance of the box; 0 for none.
    pub instance: u32,
    pub class: TruthClass,
    /// True for the skyline, which stands around the map and not on it.
    pub is_skyline: bool,
}

/// A picture that was taken.
pub(super) struct CapturedPicture {
    pub camera: Camera,
    /// sRGB-coded, row-major.
    pub rgb: Vec<[u8; 3]>,
}

/// Samples and pictures of all cameras.
pub(super) struct Sampled {
    pub samples: Vec<SurfaceSample>,
    /// Groups in rising order.
    pub groups: Vec<SampleGroup>,
    pub taken: Vec<CapturedPicture>,
}

/// Angle between the rays that sample skyline and sky, rad.
const BEHIND_RAD: f32 = 0.01;
/// Most places from which skyline and sky are sampled.
const BEHIND: usize = 3;

/// Skyline and sky all around as seen from `eye`, whatever hides them, from a little below the horizon to straight up.
fn behind(appearance: &Appearance, eye: Vec3) -> Vec<Probe> {
    let rows = ((std::f32::consts::FRAC_PI_2 + 0.05) / BEHIND_RAD) as usize;
    let row = |i: usize| {
        let up = i as f32 * BEHIND_RAD - 0.05;
        let columns = (std::f32::consts::TAU * up.cos().max(0.0) / BEHIND_RAD) as usize + 1;
        (0..columns).map(move |c| {
            let around = std::f32::consts::TAU * c as f32 / columns as f32;
            let way = Vec3::new(around.cos() * up.cos(), around.sin() * up.cos(), up.sin());
            appearance.probe_behind(eye, way)
        })
    };
    (0..rows).into_par_iter().flat_map_iter(row).collect()
}

/// Takes a picture of `size` with every camera. `None` once it was cancelled.
pub(super) fn look(
    appearance: &Appearance,
    cameras: &[Camera],
    [width, height]: [u32; 2],
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Option<Sampled> {
    let (w, h) = (width as usize, height as usize);
    let mut samples = Vec::with_capacity(cameras.len() * w * h);
    let mut numbers = GroupNumbering::default();
    let mut taken = Vec::with_capacity(cameras.len());
    for camera in cameras {
        if cancelled() {
            return None;
        }
        let rays = CameraRays::new(camera, width, height);
        let pixel_rad = rays.optics().pixel_rad() as f32;
        let one = |i: usize| {
            let (x, y) = (i % w, i / w);
            appearance.probe(&rays.at(x as f64 + 0.5, y as f64 + 0.5), pixel_rad)
        };
        let probes: Vec<Option<Probe>> = (0..w * h).into_par_iter().with_min_len(w).map(one).collect();
        for (i, probe) in probes.iter().enumerate() {
            let Some(probe) = probe else { continue };
            if let Some(sample) = numbers.sample(probe, pixel_rad, is_edge(&probes, [w, h], i)) {
                samples.push(sample);
            }
        }
        if taken.len() % cameras.len().div_ceil(BEHIND).max(1) == 0 {
            for probe in behind(appearance, rays.origin.as_vec3()) {
                samples.extend(numbers.sample(&probe, BEHIND_RAD, false));
            }
        }
        let rgb = |p: &Option<Probe>| p.map_or([0; 3], |p| coded(p.color));
        taken.push(CapturedPicture {
            camera: camera.clone(),
            rgb: probes.iter().map(rgb).collect(),
        });
    }
    let groups = numbers.in_order(&mut samples);
    Some(Sampled {
        samples,
        groups,
        taken,
    })
}

fn group_of(probe: &Probe) -> SampleGroup {
    SampleGroup {
        instance: probe.instance,
        class: probe.class,
        is_skyline: probe.is_skyline,
    }
}

fn coded(color: Vec3) -> [u8; 3] {
    color.to_array().map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// Most groups; groups that come later share the last number.
const GROUPS: usize = 1 << 14;

/// Numbers of groups in the order of their first sample.
#[derive(Default)]
struct GroupNumbering(BTreeMap<SampleGroup, u16>);

impl GroupNumbering {
    /// Sample of the surface that a ray met; `None` for the sky.
    fn sample(&mut self, probe: &Probe, pixel_rad: f32, is_edge: bool) -> Option<SurfaceSample> {
        if probe.class == truth::SKY {
            return None;
        }
        let next = self.0.len().min(GROUPS - 1) as u16;
        let group = *self.0.entry(group_of(probe)).or_insert(next);
        let width_m = probe.t * pixel_rad;
        let facing = probe.normal.dot(probe.way).abs().max(0.1);
        Some(SurfaceSample {
            at: probe.from + probe.way * probe.t,
            width_m,
            area_m2: width_m * width_m / facing,
            rgb: coded(probe.color),
            is_edge,
            normal: probe
                .normal
                .to_array()
                .map(|v| (v.clamp(-1.0, 1.0) * 127.0).round() as i8),
            group,
        })
    }

    /// Sorts the groups, whatever was seen first, and numbers the samples by that order.
    fn in_order(self, samples: &mut [SurfaceSample]) -> Vec<SampleGroup> {
        let mut new = vec![0u16; self.0.len().min(GROUPS)];
        let mut groups: Vec<SampleGroup> = Vec::with_capacity(new.len());
        for (group, number) in self.0 {
            // Groups that share the last number are represented by one of them.
            if groups.len() < new.len() {
                new[usize::from(number)] = groups.len() as u16;
                groups.push(group);
            }
        }
        for s in samples {
            s.group = new[usize::from(s.group)];
        }
        groups
    }
}

/// True if a pixel's neighbour shows something else, or something much nearer or farther.
fn is_edge(probes: &[Option<Probe>], [w, h]: [usize; 2], i: usize) -> bool {
    let (x, y) = (i % w, i / w);
    let Some(here) = &probes[i] else { return false };
    let around = [
        (x.wrapping_sub(1), y),
        (x + 1, y),
        (x, y.wrapping_sub(1)),
        (x, y + 1),
    ];
    around.into_iter().any(|(x, y)| {
        x < w
            && y < h
            && probes[y * w + x].as_ref().is_some_and(|p| {
                let slope = (p.t - here.t).abs() > 0.25 * p.t.min(here.t);
                group_of(p) != group_of(here) || slope
            })
    })
}
