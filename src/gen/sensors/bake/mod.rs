//! Lifts a scene to 3-D Gaussians (after X-Scene, arXiv 2506.13558). The renderer's own rays are cast from many places
//! where the vehicle could stand. Their hits become flat coloured discs, which are then fitted to the pictures.

mod blend;
mod discs;
mod dome;
pub mod draw;
mod of_scene;
mod refine;
mod samples;
pub mod stands;
mod strength;
mod train;
mod tree;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use crate::pictures::appearance::Appearance;
use draw::Ellipsoid;
pub use of_scene::{bake_scene, between, places};
use samples::{Sampled, SurfaceSample};
use scene::{Background, Baking, Conditions, Frame, GaussianScene, Pose, SceneGaussian, SensorRig};
use tree::Leaf;

/// Effort of a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeOptions {
    /// Most Gaussians.
    pub most: usize,
    /// Most places from which the scene is looked at.
    pub stands: usize,
    /// Largest distance of these places from the vehicle's path, m.
    pub reach_m: f64,
    /// Size of the pictures that are taken, px.
    pub size_px: [u32; 2],
    /// Steps in which places, shapes, opacities and colours are fitted to the pictures, a few pictures each.
    pub steps: usize,
    /// Steps in which colours are fitted to all pictures at the end.
    pub rounds: usize,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            most: 300_000,
            stands: 20,
            reach_m: 22.0,
            size_px: [320, 180],
            steps: 160,
            rounds: 3,
        }
    }
}

/// Most rays that are cast: samples and pictures of them take some 60 bytes each.
const MOST_RAYS: u64 = 10_000_000;
/// Alpha of a Gaussian at its centre.
const OPACITY: f32 = 0.99;
/// One of this many Gaussians belongs to the sky.
const SKY_SHARE: usize = 25;
/// Weight of a Gaussian's initial colour against the pictures, in pixels, and its increase per sample that the Gaussian
/// was made of.
const KEEP: f32 = 0.4;
const KEEP_PER_SAMPLE: f32 = 0.05;
/// Number of samples that a Gaussian of the sky counts for.
const SKY_SAMPLES: f32 = 100.0;

/// Scene to bake, all in one frame.
#[derive(Clone, Copy, Debug)]
pub struct BakeInput<'a> {
    /// Occupancy, layout and boxes.
    pub frame: &'a Frame,
    /// Sensors at the place of the vehicle.
    pub rig: &'a SensorRig,
    /// Scenery beside the roads.
    pub background: &'a Background,
    /// Light and air. Rain and flakes in the air are left out.
    pub conditions: Conditions,
    /// Path of the vehicle; if empty, only the place where it stands counts.
    pub path: &'a [Pose],
}

/// Bakes a scene. The same input gives the same Gaussians on any number of threads. `go_on` gets the progress, 0 to 1;
/// returns `None` once `go_on` returns false.
pub fn bake(
    input: &BakeInput<'_>,
    options: &BakeOptions,
    go_on: &(dyn Fn(f32) -> bool + Sync),
) -> Option<GaussianScene> {
    // Makes a closure that says whether to stop. It is called `calls` times while the progress goes from `from` to
    // `to`.
    let counted = |from: f32, to: f32, calls: usize| {
        let done = AtomicUsize::new(0);
        move || {
            let done = done.fetch_add(1, Ordering::Relaxed) as f32 / calls.max(1) as f32;
            !go_on(from + (to - from) * done.min(1.0))
        }
    };
    let appearance = Appearance::with_things(input.frame, input.background, input.rig, &input.conditions);
    let here = [input.rig.vehicle];
    let path = if input.path.is_empty() { &here } else { input.path };
    let stands = stands::stands(input.frame, input.rig, path, options.reach_m, options.stands);
    let size = options.size_px;
    let mut cameras = stands::views(input.rig, &stands);
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    cameras.truncate((MOST_RAYS / pixels.max(1)) as usize);
    let mut sampled = samples::look(&appearance, &cameras, size, &counted(0.0, 0.2, cameras.len()))?;
    let seen = sampled.samples.len() as u64;
    let eyes: Vec<Vec3> = cameras
        .iter()
        .map(|c| glam::DVec3::from(c.translation_m).as_vec3())
        .collect();
    let sky = (options.most / SKY_SHARE).clamp(500, 20_000).min(options.most);
    let sky = dome::dome(&appearance, path[0].translation_m.as_vec3(), sky, OPACITY);
    let (mut gaussians, mut keep) = surfaces(&mut sampled, &eyes, options.most - sky.len());
    keep.resize(keep.len() + sky.len(), KEEP + KEEP_PER_SAMPLE * SKY_SAMPLES);
    gaussians.extend(sky);
    let training = counted(0.2, 0.9, options.steps);
    train::fit(&mut gaussians, &sampled.taken, size, options.steps, &training);
    let ellipsoids: Vec<Ellipsoid> = gaussians.par_iter().map(Ellipsoid::from_gaussian).collect();
    let mut colors: Vec<[f32; 3]> = gaussians.iter().map(|g| g.color).collect();
    let start = (&mut colors, &keep[..]);
    refine::fit(
        &ellipsoids,
        &sampled.taken,
        size,
        start,
        options.rounds,
        &counted(0.9, 1.0, (options.rounds + 1) * (sampled.taken.len() + 1)),
    );
    if !go_on(1.0) {
        return None;
    }
    for (g, color) in gaussians.iter_mut().zip(colors) {
        g.color = color.map(|v| v.clamp(0.0, 1.0));
    }
    Some(GaussianScene {
        gaussians,
        baking: Baking {
            stands: stands.len() as u32,
            views: sampled.taken.len() as u32,
            size_px: size,
            samples: seen,
            most: options.most as u32,
            rounds: (options.steps + options.rounds) as u32,
        },
    })
}

/// Gaussians of all samples, and the weight of each one's colour. Consumes the samples.
fn surfaces(sampled: &mut Sampled, eyes: &[Vec3], most: usize) -> (Vec<SceneGaussian>, Vec<f32>) {
    let samples = std::mem::take(&mut sampled.samples);
    let (samples, leaves) = tree::leaves(samples, &sampled.groups, eyes, most);
    let strengths = strength::Strengths::new();
    let one = |leaf: &Leaf| {
        let own = &samples[leaf.from as usize..leaf.to as usize];
        let disc = discs::disc(own, leaf);
        let group = sampled.groups[usize::from(own[0].group)];
        let q = disc.rotation;
        SceneGaussian {
            position_m: disc.position_m.to_array(),
            rotation_wxyz: [q.w, q.x, q.y, q.z],
            std_m: disc.std_m.to_array(),
            opacity: OPACITY,
            color: mean_color(own),
            class: group.class,
            instance: group.instance,
            strength: strengths.of(&group, disc.position_m, disc.normal),
        }
    };
    let weight = |leaf: &Leaf| KEEP + KEEP_PER_SAMPLE * (leaf.to - leaf.from) as f32;
    let keep = leaves.iter().map(weight).collect();
    (leaves.par_iter().map(one).collect(), keep)
}

fn mean_color(samples: &[SurfaceSample]) -> [f32; 3] {
    let mut sum = [0u32; 3];
    for s in samples {
        for (sum, v) in sum.iter_mut().zip(s.rgb) {
            *sum += u32::from(v);
        }
    }
    sum.map(|v| v as f32 / (255.0 * samples.len().max(1) as f32))
}

#[cfg(test)]
mod tests;
