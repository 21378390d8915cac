//! Materials of surfaces by class and place: asphalt and paint, slabs and kerbs, grass, facades with windows, leaves
//! and bark, cars from their lamps to their tyres. Colours are linear.

mod built;
mod facade;
mod ground;
mod scenery;
mod thing;

use glam::Vec3;

use super::noise::{ramp, value3};
use super::prepared::{Appearance, SurfaceHit, SurfaceKind};
use super::things::rgb;
use scene::Class;

/// A surface to be lit.
#[derive(Clone, Copy, Debug)]
pub struct LitSurface {
    /// Share of light given back in all directions.
    pub albedo: Vec3,
    /// Share mirrored when seen straight on.
    pub mirror: f32,
    /// Sharpness of what is mirrored, 0 to 1.
    pub gloss: f32,
    /// Own light.
    pub emit: Vec3,
    /// Unit normal, ego frame.
    pub normal: Vec3,
    /// Share of light that shines through from behind (leaves).
    pub through: f32,
}

impl LitSurface {
    fn matt(albedo: Vec3, normal: Vec3) -> Self {
        Self {
            albedo,
            mirror: 0.0,
            gloss: 0.0,
            emit: Vec3::ZERO,
            normal,
            through: 0.0,
        }
    }
}

/// Share of a pattern's contrast left when a pixel covers `footprint` m of it.
#[inline]
fn visible(footprint: f32, feature: f32) -> f32 {
    ramp(feature * 1.4, feature * 0.35, footprint)
}

/// 1 inside a band of half width `half` around 0, softened over a pixel's footprint.
#[inline]
fn band(distance: f32, half: f32, footprint: f32) -> f32 {
    let soft = (footprint * 0.5).max(0.004);
    // A line thinner than a pixel keeps its share of it.
    (((half - distance) / soft * 0.5 + 0.5).clamp(0.0, 1.0) * (half / soft.max(half)).min(1.0))
        .clamp(0.0, 1.0)
}

fn gray(v: f32) -> Vec3 {
    Vec3::splat(v)
}

/// Light of tail lamps: exposed at night just beyond white in red alone, so that they stay red and keep a soft halo.
const TAIL: Vec3 = Vec3::new(1.0, 0.035, 0.02);

impl Appearance {
    /// The surface at a hit; `footprint` is the width of a pixel on it in m.
    pub(super) fn surface(&self, hit: &SurfaceHit, dir: Vec3, footprint: f32) -> LitSurface {
        let normal = self.normal(hit);
        match hit.what {
            SurfaceKind::Ground => self.ground_surface(hit.p, normal, footprint),
            SurfaceKind::Voxel(label) => self.voxel_surface(hit, label, normal, footprint),
            SurfaceKind::Thing(i, local, part) => {
                let thing = &self.things[i as usize];
                let n = thing.turn(hit.normal);
                let (part, material) = &thing.parts[part as usize];
                let mut s = match thing.is_scenery() {
                    false => self.thing_surface(thing, (local, n), (part, *material), footprint),
                    true => self.scenery_surface((thing, part, *material), local, n, footprint),
                };
                s.normal = if s.normal == n {
                    hit.normal
                } else {
                    thing.turn_back(s.normal)
                };
                self.cover(&mut s, hit.p, 0.75);
                let _ = dir;
                s
            }
        }
    }

    /// Snow, dust and water on a surface; `hold` is how much of them stays.
    fn cover(&self, s: &mut LitSurface, p: Vec3, hold: f32) {
        let a = self.anchor(p);
        if self.air.snow > 0.0 {
            let n = s.normal.z + 0.35 * (value3(a * 3.0, 31) - 0.5) + 0.15 * (value3(a * 11.0, 32) - 0.5);
            let lies = ramp(0.42, 0.75, n) * hold * self.air.snow;
            s.albedo = s.albedo.lerp(Vec3::new(0.80, 0.83, 0.88), lies);
            s.mirror *= 1.0 - lies;
            s.emit *= 1.0 - lies;
        }
        if self.air.dust > 0.0 {
            let lies = (0.28 + 0.45 * ramp(0.2, 0.9, s.normal.z)) * self.air.dust * hold;
            s.albedo = s.albedo.lerp(Vec3::new(0.46, 0.33, 0.19), lies);
            s.mirror *= 1.0 - lies;
        }
        if self.air.wet > 0.0 && s.mirror < 0.03 {
            s.albedo *= 1.0 - 0.35 * self.air.wet;
            s.mirror = s.mirror.max(0.02 * self.air.wet);
            s.gloss = s.gloss.max(0.35);
        }
    }
}

/// Colour of voxels that have no material of their own.
pub(super) fn calm(class: Class) -> Vec3 {
    let [r, g, b] = class.color();
    if class == Class::Others {
        rgb(104, 106, 104)
    } else {
        rgb(r, g, b).lerp(gray(0.2), 0.4)
    }
}
