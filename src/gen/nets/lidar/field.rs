//! The signed distance field of a scene and the rays through it. Every voxel holds a plane and sixteen numbers; between
//! eight voxel centres they are blended, and a small network corrects the blend.

use glam::DVec3;

use super::neus;
use super::prior::SampleDensity;
use super::sites::Volume;
use nn::vectorised;
use scene::{Class, Window};

/// Hidden numbers of a voxel, and of the network behind them.
pub const HIDDEN: usize = 16;
/// Numbers of a voxel for its appearance.
pub const APPEARANCE: usize = 16;
/// Inputs of a ray's heads: appearance, slope, and three facts about the ray.
pub const RAY_INPUTS: usize = APPEARANCE + 4;
/// Distance to the next surface where no voxel is near, m.
const FREE_SDF_M: f32 = scene::Window::VOXEL_M as f32;
const LEAST_SUPPORT: f32 = 0.05;
/// Weight from which on the appearance of an interval counts.
const LEAST_WEIGHT: f32 = 0.01;
/// ln of the share that must pass for a ray to go on.
const OPAQUE: f32 = -6.9;
/// Samples of a ray at most; one in a wood or along a hedge may want more.
const MOST_SAMPLES: usize = 160;
/// Intervals shorter than this are not divided, m.
const FINE_M: f32 = 0.02;

/// The network that turns blended numbers into a distance, and the steepness of NeuS.
pub struct SdfHead {
    /// Added where voxels are.
    pub support: [f32; HIDDEN],
    /// `[input][output]`.
    pub first: [[f32; HIDDEN]; HIDDEN],
    /// Bias of the first layer.
    pub first_bias: [f32; HIDDEN],
    /// Weights of the second layer.
    pub second: [f32; HIDDEN],
    /// Its bias.
    pub second_bias: f32,
    /// Steepness, 1/m.
    pub s: f32,
}

/// Sixteen numbers of a site that lie in one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct SiteFeatures(pub [f32; HIDDEN]);

/// Features of a scene by the UNet, ready for rays. After the last site all lists but `keys` and `classes` hold one
/// more entry of zeros, for the corners where no voxel is.
pub struct SignedDistanceField {
    /// The voxels in rising order.
    pub keys: Vec<u32>,
    /// Where the voxels are.
    pub volume: Volume,
    /// Cells where samples are worth it.
    pub cells: SampleDensity,
    /// Label of each site.
    pub classes: Vec<u8>,
    /// Hidden numbers, `[site]`.
    pub hidden: Vec<SiteFeatures>,
    /// Planes, `[site]`: offset in m, slopes in m per voxel.
    pub planes: Vec<[f32; 4]>,
    /// Appearance, `[site]`.
    pub appearance: Vec<SiteFeatures>,
}

/// Placement of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySampling {
    /// Samples where the prior wants them, refined at the surface, until the ray is opaque.
    Prior,
    /// Samples in this number at equal distances on the whole ray.
    Uniform(usize),
}

/// Hit of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SdfHit {
    /// Mean distance of the hit, m; 0 if nothing was met.
    pub mean_m: f32,
    /// Median distance of the hit, m: it lies on one of the surfaces.
    pub median_m: f32,
    /// ln of the share that passes.
    pub log_pass: f32,
    /// Label of the nearest voxel there; free if nothing was met.
    pub class: u8,
    /// Inputs of the heads.
    pub inputs: [f32; RAY_INPUTS],
    /// Samples that were taken.
    pub samples: u16,
    /// Distance beyond which nothing influenced the result, m; infinite unless the ray was stopped early.
    pub reach_m: f32,
}

/// The eight voxel centres around a point.
struct TrilinearCorners {
    base: usize,
    cell: [usize; 3],
    share: [f32; 3],
    weights: [[f32; 2]; 3],
}

impl SignedDistanceField {
    #[inline(always)]
    fn corners(&self, p: [f32; 3]) -> Option<TrilinearCorners> {
        const LOWER: [f32; 3] = [-40.0, -40.0, -1.0];
        const PLACES: [i32; 3] = [Window::NX as i32, Window::NY as i32, Window::NZ as i32];
        let (mut share, mut place) = ([0.0; 3], [0usize; 3]);
        for axis in 0..3 {
            let q = (p[axis] - LOWER[axis]) / Window::VOXEL_M as f32 - 0.5;
            let floor = q.floor();
            // Written so that NaN is outside.
            if !(floor >= -1.0 && floor < PLACES[axis] as f32) {
                return None;
            }
            share[axis] = q - floor;
            place[axis] = (floor as i32 + 1) as usize;
        }
        let steps = self.volume.steps;
        Some(TrilinearCorners {
            base: place[0] * steps[0] + place[1] * steps[1] + place[2],
            cell: place,
            weights: share.map(|s| [1.0 - s, 1.0 - (1.0 - s)]),
            share,
        })
    }

    /// Site (the number of sites where there is none), weight (0 there) and offset from its centre (in voxels) of a
    /// corner.
    #[inline(always)]
    fn corner(&self, c: &TrilinearCorners, corner: usize) -> (usize, f32, [f32; 3]) {
        let steps = self.volume.steps;
        let bits = [corner >> 2, corner >> 1 & 1, corner & 1];
        let site = self.volume.sites[c.base + bits[0] * steps[0] + bits[1] * steps[1] + bits[2]] as usize;
        let offset = [0, 1, 2].map(|a| c.share[a] - bits[a] as f32);
        let weight = c.weights[0][bits[0]] * c.weights[1][bits[1]] * c.weights[2][bits[2]];
        // No branch: which corners exist cannot be predicted.
        (site, if site < self.classes.len() { weight } else { 0.0 }, offset)
    }

    /// Signed distance at a point of the ego frame, m.
    #[inline(always)]
    pub fn sdf(&self, head: &SdfHead, p_in_ego: [f32; 3]) -> f32 {
        let Some(corners) = self.corners(p_in_ego).filter(|c| self.cells.is_active(c.cell)) else {
            return FREE_SDF_M;
        };
        let (mut there, mut planes, mut blended) = (0.0f32, [0.0f32; 4], [0.0f32; HIDDEN]);
        for corner in 0..8 {
            let (site, weight, offset) = self.corner(&corners, corner);
            there += weight;
            let (own, at) = (&self.planes[site], [1.0, offset[0], offset[1], offset[2]]);
            for ((sum, own), at) in planes.iter_mut().zip(own).zip(at) {
                *sum += weight * own * at;
            }
            for (b, h) in blended.iter_mut().zip(&self.hidden[site].0) {
                *b += weight * h;
            }
        }
        if there <= 0.0 {
            return FREE_SDF_M;
        }
        let plane = (planes[0] + planes[1]) + (planes[2] + planes[3]);
        for (b, support) in blended.iter_mut().zip(&head.support) {
            *b = (*b + there * support).max(0.0);
        }
        // Four sums side by side: none waits for the one before.
        let mut sums = [[0.0f32; HIDDEN]; 4];
        sums[0] = head.first_bias;
        for (four, weights) in blended.chunks_exact(4).zip(head.first.chunks_exact(4)) {
            for ((sum, h), weights) in sums.iter_mut().zip(four).zip(weights) {
                for (n, w) in sum.iter_mut().zip(weights) {
                    *n += h * w;
                }
            }
        }
        let [a, b, c, d] = &sums;
        let mut parts: [f32; HIDDEN] = std::array::from_fn(|i| {
            let n = (a[i] + b[i]) + (c[i] + d[i]);
            n.max(0.0) * head.second[i]
        });
        let mut half = HIDDEN / 2;
        while half > 0 {
            for i in 0..half {
                parts[i] += parts[i + half];
            }
            half /= 2;
        }
        plane / there.max(LEAST_SUPPORT) + (parts[0] + head.second_bias)
    }

    /// Appearance at a point, zero where no voxel is near.
    #[inline(always)]
    fn looks(&self, p_in_ego: [f32; 3]) -> [f32; APPEARANCE] {
        let mut out = [0.0; APPEARANCE];
        if let Some(corners) = self.corners(p_in_ego) {
            for corner in 0..8 {
                let (site, weight, _) = self.corner(&corners, corner);
                for (o, a) in out.iter_mut().zip(&self.appearance[site].0) {
                    *o += weight * a;
                }
            }
        }
        out
    }

    /// Label of the voxel whose centre is nearest of the eight around a point.
    #[inline(always)]
    fn class(&self, p_in_ego: [f32; 3]) -> u8 {
        let (mut best, mut class) = (-1.0, Class::FREE);
        if let Some(corners) = self.corners(p_in_ego) {
            for corner in 0..8 {
                let (site, weight, _) = self.corner(&corners, corner);
                if site < self.classes.len() && weight > best {
                    (best, class) = (weight, self.classes[site]);
                }
            }
        }
        class
    }

    /// The hit of a ray whose samples lie at `t` (m, rising) with signed distances `f` and [`neus::tail`] of s f, s
    /// being the steepness. Twin of `Lidar.render`.
    #[inline(always)]
    pub fn render(
        &self,
        s: f32,
        [origin, direction]: [[f32; 3]; 2],
        [t, f, tails]: [&[f32]; 3],
        weights: &mut Vec<f32>,
    ) -> SdfHit {
        let log_pass = neus::weights(s, f, tails, weights);
        let total: f32 = weights.iter().sum();
        let at = |i: usize| neus::crossing(t[i], t[i + 1], f[i], f[i + 1]);
        let mut met = SdfHit {
            log_pass,
            class: Class::FREE,
            samples: t.len() as u16,
            ..SdfHit::default()
        };
        let (mut sum, mut passed, mut median) = (0.0, 0.0, None);
        for (i, w) in weights.iter().enumerate() {
            sum += w * at(i);
            passed += w;
            if median.is_none() && passed * 2.0 >= total && total > 0.0 {
                median = Some(at(i));
            }
            if *w > LEAST_WEIGHT {
                let looks = self.looks(along(origin, direction, at(i)));
                for (v, l) in met.inputs.iter_mut().zip(looks) {
                    *v += w * l;
                }
                let slope = (f[i] - f[i + 1]) / (t[i + 1] - t[i]).max(1e-3);
                met.inputs[APPEARANCE] += w * slope.clamp(-2.0, 2.0);
            }
        }
        met.mean_m = sum / total.max(1e-6);
        met.median_m = median.unwrap_or(met.mean_m);
        if median.is_some() {
            met.class = self.class(along(origin, direction, met.median_m));
        }
        met.inputs[APPEARANCE + 1] = met.mean_m / 40.0;
        met.inputs[APPEARANCE + 2] = 1.0 / (1.0 + met.mean_m / 5.0);
        met.inputs[APPEARANCE + 3] = direction[2] * 2.0;
        met
    }

    #[inline(always)]
    fn shoot(&self, head: &SdfHead, ray: &LidarRay, sampling: RaySampling, room: &mut Room) -> SdfHit {
        room.t.clear();
        room.f.clear();
        room.tails.clear();
        let line = [ray.origin, ray.direction].map(|v| v.as_vec3().to_array());
        let (mut log_pass, mut reach_m) = (0.0f32, f32::INFINITY);
        match sampling {
            RaySampling::Prior => {
                for position in self.cells.samples(ray.origin, ray.direction, ray.range_m) {
                    if !self.take(head, line, position, &mut log_pass, room) {
                        reach_m = position;
                        break;
                    }
                }
                self.refine(head, line, room);
            }
            RaySampling::Uniform(n) => {
                let [near, far] = ray.range_m.map(|v| v as f32);
                for i in 0..n.min(MOST_SAMPLES) {
                    let position = near + (far.min(60.0) - near) * (i as f32 + 0.5) / n as f32;
                    self.take(head, line, position, &mut log_pass, room);
                }
            }
        }
        let samples = [&room.t[..], &room.f, &room.tails];
        let mut met = self.render(head.s, line, samples, &mut room.weights);
        met.reach_m = reach_m;
        met
    }

    /// Takes a sample; false if the ray need not go on.
    #[inline(always)]
    fn take(
        &self,
        head: &SdfHead,
        [origin, direction]: [[f32; 3]; 2],
        position: f32,
        log_pass: &mut f32,
        room: &mut Room,
    ) -> bool {
        let value = self.sdf(head, along(origin, direction, position));
        let tail = neus::tail(head.s * value);
        if let (Some(f), Some(before)) = (room.f.last(), room.tails.last()) {
            *log_pass += neus::log_pass(head.s, [*f, value], [*before, tail]);
        }
        room.t.push(position);
        room.f.push(value);
        room.tails.push(tail);
        *log_pass > OPAQUE && room.t.len() < MOST_SAMPLES
    }

    /// Divides the heaviest interval where it is crossed, twice: the importance step of NeuS, at the one place where it
    /// matters.
    #[inline(always)]
    fn refine(&self, head: &SdfHead, [origin, direction]: [[f32; 3]; 2], room: &mut Room) {
        for _ in 0..2 {
            neus::weights(head.s, &room.f, &room.tails, &mut room.weights);
            let (mut heaviest, mut weight) = (0, 0.1);
            for (i, w) in room.weights.iter().enumerate() {
                if *w > weight {
                    (heaviest, weight) = (i, *w);
                }
            }
            let Some(&[t0, t1]) = room.t.get(heaviest..heaviest + 2).and_then(|s| s.first_chunk()) else {
                return;
            };
            if weight <= 0.1 || t1 - t0 < FINE_M {
                return;
            }
            let position = neus::crossing(t0, t1, room.f[heaviest], room.f[heaviest + 1]);
            let value = self.sdf(head, along(origin, direction, position));
            room.t.insert(heaviest + 1, position);
            room.f.insert(heaviest + 1, value);
            room.tails.insert(heaviest + 1, neus::tail(head.s * value));
        }
    }
}

/// A ray of the ego frame.
#[derive(Clone, Copy, Debug)]
pub struct LidarRay {
    /// Origin, m.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// Distances between which it looks, m.
    pub range_m: [f64; 2],
}

/// Buffers of one thread.
#[derive(Default)]
pub struct Room {
    t: Vec<f32>,
    f: Vec<f32>,
    tails: Vec<f32>,
    weights: Vec<f32>,
}

#[inline(always)]
fn along(origin: [f32; 3], direction: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|a| origin[a] + direction[a] * t)
}

vectorised! {
    /// Hits of some rays, one after another.
    pub fn shoot_all(field: &SignedDistanceField, head: &SdfHead, rays: &[LidarRay], sampling: RaySampling, room: &mut Room, out: &mut [SdfHit]) {
        for (ray, met) in rays.iter().zip(out) {
            *met = field.shoot(head, ray, sampling, room);
        }
    }
}
