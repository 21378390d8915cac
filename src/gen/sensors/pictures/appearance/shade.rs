//! Light on surfaces: sun with shadows, sky with ambient occlusion, lamps, mirrored surroundings, air.

use glam::Vec3;

use super::material::LitSurface;
use super::noise::ramp;
use super::prepared::{Appearance, Beam, SurfaceHit, SurfaceKind};
use scene::Class;
use scene::appearance::{
    FAR_M, HEAD_NEAR_M2, LAMP_CLEAR_M, LAMP_SHADOW_LIGHT, LAMP_STEP_M, MIRROR_M, SHADOW_M, SKYLINE_M,
};

/// A sample of a picture: its light and what was seen, to find edges.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadedSample {
    /// Linear light.
    pub color: Vec3,
    /// Distance of the surface on the map, m; infinite if there is none.
    pub t: f32,
    /// Key that differs between surfaces.
    pub key: u32,
}

/// Surface that a sample shows: the one that made its light.
#[derive(Clone, Copy, Debug, Default)]
pub enum VisibleSurface {
    /// Sky: the ray met nothing.
    #[default]
    Sky,
    /// A class of the skyline that stands around the map, and its distance, m.
    Skyline(Class, f32),
    /// A surface, and the width of a pixel on it, m.
    Surface(SurfaceHit, f32),
}

/// Least distance of a skyline, m.
const SKYLINE_FROM_M: f32 = 55.0;

/// Width of a pixel on a surface, m.
fn footprint(hit: &SurfaceHit, d: Vec3, pixel: f32) -> f32 {
    let slant = match hit.what {
        SurfaceKind::Ground => (-d.z).max(0.03),
        _ => 0.6,
    };
    hit.t * pixel / slant.sqrt()
}

/// A place of the skyline.
struct Beyond {
    /// Linear light, hazed.
    color: Vec3,
    class: Class,
    /// Distance, m.
    t: f32,
}

impl Appearance {
    /// Light along a ray; `pixel` is the angle between neighbouring pixels.
    pub(super) fn light_along(
        &self,
        (o, d): (Vec3, Vec3),
        after_s: f32,
        pixel: f32,
    ) -> (ShadedSample, VisibleSurface) {
        let Some(hit) = self.trace((o, d), after_s, FAR_M, false) else {
            let sample = |color| ShadedSample {
                color,
                t: f32::INFINITY,
                key: 0,
            };
            let (color, seen) = self.light_behind((o, d));
            return (sample(color), seen);
        };
        if hit.t > SKYLINE_FROM_M
            && let Some(b) = self.beyond(o, d, hit.t)
        {
            let sample = ShadedSample {
                color: b.color,
                t: hit.t,
                key: 1,
            };
            return (sample, VisibleSurface::Skyline(b.class, b.t));
        }
        let footprint = footprint(&hit, d, pixel);
        let s = self.surface(&hit, d, footprint);
        let color = self.lit(&hit, &s, d, true);
        let key = match hit.what {
            SurfaceKind::Ground => 2,
            SurfaceKind::Voxel(l) => 8 + u32::from(l),
            SurfaceKind::Thing(i, ..) => 64 + i,
        };
        let sample = ShadedSample {
            color: self.air.through(color, hit.t, self.anchor_dir(d)),
            t: hit.t,
            key: key << 8 | ((s.normal * 3.0 + 4.0).as_uvec3().dot(glam::UVec3::new(1, 8, 32)) & 0xff),
        };
        (sample, VisibleSurface::Surface(hit, footprint))
    }

    /// Light of the skyline or the sky along a ray, whatever is on the map.
    pub(super) fn light_behind(&self, (o, d): (Vec3, Vec3)) -> (Vec3, VisibleSurface) {
        match self.beyond(o, d, f32::INFINITY) {
            Some(b) => (b.color, VisibleSurface::Skyline(b.class, b.t)),
            None => (self.air.sky(self.anchor_dir(d)), VisibleSurface::Sky),
        }
    }

    /// Surface that [`Self::light_along`] shows along a ray, without computing its light.
    pub(super) fn seen_along(&self, (o, d): (Vec3, Vec3), after_s: f32, pixel: f32) -> VisibleSurface {
        let hit = self.trace((o, d), after_s, FAR_M, false);
        let limit = hit.map_or(f32::INFINITY, |hit| hit.t);
        let beyond = (limit > SKYLINE_FROM_M)
            .then(|| self.beyond(o, d, limit))
            .flatten();
        match (beyond, hit) {
            (Some(b), _) => VisibleSurface::Skyline(b.class, b.t),
            (None, Some(hit)) => VisibleSurface::Surface(hit, footprint(&hit, d, pixel)),
            (None, None) => VisibleSurface::Sky,
        }
    }

    /// The skyline outside the grid along a ray, nearer than `limit`, hazed.
    fn beyond(&self, o: Vec3, d: Vec3, limit: f32) -> Option<Beyond> {
        let flat = d.truncate().length_squared();
        let shape = self.field.shape();
        let eye = o.truncate() - shape.middle_m;
        for (ring, radius) in SKYLINE_M.into_iter().enumerate() {
            let radius = radius * shape.skyline;
            // The circle around the map's middle, from inside.
            let b = eye.dot(d.truncate());
            let c = eye.length_squared() - radius * radius;
            let disc = b * b - flat * c;
            if flat < 1e-8 || disc <= 0.0 || c > 0.0 {
                continue;
            }
            let t = (-b + disc.sqrt()) / flat;
            let p = o + d * t;
            if t > limit || p.z < 0.0 || p.z > 60.0 {
                continue;
            }
            let from_middle = p - shape.middle_m.extend(0.0);
            // Streets that leave the map stay open in front.
            let mut open = 0.0;
            if ring == 0 {
                // Lower and lower towards the gap.
                let aside = from_middle.truncate().perp().normalize_or_zero();
                for k in -3..=3 {
                    let q = p.truncate() + aside * (k as f32 * 2.6);
                    open += ramp(0.15, 0.6, self.ground.at(q, q).share[0]) / 4.0;
                }
                open = f32::min(open, 1.0);
            }
            let around = self.anchor_dir(from_middle);
            if let Some((color, class)) = self.air.skyline(around, radius, open) {
                let color = self.air.through(color, t, self.anchor_dir(d));
                return Some(Beyond { color, class, t });
            }
        }
        None
    }

    /// Light that a surface sends back along a ray. Mirrored surroundings are followed once.
    fn lit(&self, hit: &SurfaceHit, s: &LitSurface, d: Vec3, follow: bool) -> Vec3 {
        let (air, n) = (&self.air, s.normal);
        let view = -d;
        let lift = hit.p + self.geometric(hit, n) * (0.012 + hit.t * 2e-4);
        let to_sun = self.to_sun();
        let mut out = s.emit;
        let facing = n.dot(to_sun);
        let strength = air.sun.max_element();
        let lit_through = s.through * (-facing).max(0.0);
        if strength > 0.05 && (facing > 0.0 || lit_through > 0.02) {
            let shadow = if follow {
                self.occluded((lift, to_sun), hit.after_s, SHADOW_M, 0.16)
            } else {
                false
            };
            if !shadow {
                out += s.albedo * air.sun * (facing.max(0.0) * (1.0 - 0.3 * s.through) + lit_through * 0.6);
                if s.gloss > 0.0 {
                    let half = (to_sun + view).normalize_or(n);
                    let power = 2f32.powf(2.0 + 9.0 * s.gloss);
                    let spot = n.dot(half).max(0.0).powf(power) * (power + 2.0) * 0.125;
                    out += air.sun * (s.mirror * spot.min(25.0) * facing.max(0.0));
                }
            }
        } else if strength > 0.0 {
            out += s.albedo * air.sun * facing.max(0.0);
        }
        let open = self.openness(hit, n);
        let sky = 0.5 + 0.5 * n.z;
        let below = air.bounce.lerp(air.ambient * 0.75, air.snow * 0.6);
        out += s.albedo * (air.ambient * sky + below * (1.0 - sky) + air.horizon * 0.08) * open;
        if !self.lamps.is_empty() {
            out += self.lamp_light(hit, lift, view, s, follow);
        }
        if s.mirror > 0.008 {
            let grazing = (1.0 - n.dot(view).clamp(0.0, 1.0)).powi(5);
            let share = s.mirror + (1.0 - s.mirror) * grazing * s.gloss * s.gloss * 0.85;
            if share > 0.012 {
                let r = d - n * (2.0 * d.dot(n));
                let r = if r.dot(n) < 0.0 {
                    r - n * (2.0 * r.dot(n))
                } else {
                    r
                };
                let mut seen = if follow && s.gloss > 0.55 {
                    self.mirrored(lift, r, hit.after_s)
                } else {
                    air.horizon.lerp(air.zenith, r.z.max(0.0)) * open
                };
                // A rough mirror shows a mean of what is around.
                let mean = (air.ambient * 0.6 + air.horizon * 0.2) * open;
                seen = mean.lerp(seen, ramp(0.2, 0.8, s.gloss));
                out = out * (1.0 - share) + seen * share;
            }
        }
        out
    }

    fn geometric(&self, hit: &SurfaceHit, n: Vec3) -> Vec3 {
        match hit.what {
            SurfaceKind::Thing(..) => hit.normal,
            SurfaceKind::Ground => Vec3::Z,
            // Past the steps of a wall.
            SurfaceKind::Voxel(15) => n * 12.0,
            SurfaceKind::Voxel(_) => n,
        }
    }

    fn mirrored(&self, o: Vec3, r: Vec3, after_s: f32) -> Vec3 {
        let there = self.anchor_dir(r);
        let beyond = |limit: f32| self.beyond(o, r, limit).map(|b| b.color);
        let sky = |limit: f32| beyond(limit).unwrap_or_else(|| self.air.sky(there));
        match self.trace((o, r), after_s, MIRROR_M, true) {
            Some(hit) if hit.t > 0.02 => {
                let s = self.surface(&hit, r, 0.05 + hit.t * 0.004);
                self.air.through(self.lit(&hit, &s, r, false), hit.t, there)
            }
            _ => sky(f32::INFINITY),
        }
    }

    /// Share of the sky's light that reaches a point, from the field around and the things near.
    fn openness(&self, hit: &SurfaceHit, n: Vec3) -> f32 {
        let p = hit.p;
        let f = |d: Vec3| self.field.dense(p + d);
        let is_plant = matches!(hit.what, SurfaceKind::Voxel(16));
        let near = f(n * 0.45 + Vec3::Z * 0.1);
        let mid = f(n * 1.0 + Vec3::Z * 0.35);
        let mut closed = 0.34 * near + 0.26 * mid;
        closed += 0.16 * f(n * 1.6 + Vec3::Z * 1.2) + 0.14 * f(Vec3::Z * 2.4 + n * 0.8);
        let side = Vec3::new(-n.y, n.x, 0.0).normalize_or(Vec3::X) * 1.3;
        closed += 0.10 * (f(n * 0.7 + side) + f(n * 0.7 - side));
        if is_plant {
            // Deep inside a crown it is dark.
            closed = closed * 0.9 + 0.10 * (f(Vec3::Z * 0.9) + f(Vec3::Z * 1.8));
        }
        let mut open = (1.0 - closed).clamp(0.12, 1.0);
        if p.z - self.ground.base_m(p.truncate()) < 2.5 {
            for &i in self.things_near(p.truncate()) {
                let thing = &self.things[i as usize];
                let q = thing.to_local(thing.seen_from(p, hit.after_s));
                let out = (q.truncate().abs() - thing.size.truncate() / 2.0).max(glam::Vec2::ZERO);
                let over = match thing.is_scenery() {
                    false => (q.z / thing.size.z).clamp(0.0, 1.0),
                    true => ((q.z - thing.floor_m) / 2.5).clamp(0.0, 1.0),
                };
                match hit.what {
                    SurfaceKind::Ground => {
                        let small = (thing.size.x.min(thing.size.y) / 1.6).min(1.0);
                        let (dark, high) = match thing.is_scenery() {
                            false => (0.80, 1.6),
                            // What hangs above the ground shades it less than its shadow does.
                            true if thing.foot.z > p.z + 0.5 => continue,
                            true => (0.45, 2.4),
                        };
                        open *= 1.0 - dark * small * ramp(0.55 * thing.size.z.min(high), 0.0, out.length());
                    }
                    SurfaceKind::Thing(k, ..) if k == i => open *= 0.62 + 0.38 * ramp(0.0, 0.35, over),
                    _ => {}
                }
            }
        }
        open
    }

    /// Light of the lamps on a surface. `lift` is a point a little above the surface, from which shadow rays start if
    /// `shadows` is true.
    fn lamp_light(&self, hit: &SurfaceHit, lift: Vec3, view: Vec3, s: &LitSurface, shadows: bool) -> Vec3 {
        let (p, n) = (hit.p, s.normal);
        let mut out = Vec3::ZERO;
        for lamp in &self.lamps {
            let to = lamp.at - p;
            let d2 = to.length_squared();
            if d2 > lamp.range_m * lamp.range_m {
                continue;
            }
            let l = to / d2.sqrt().max(1e-3);
            let facing = n.dot(l);
            let cos = -l.dot(lamp.axis);
            let beam = match lamp.beam {
                Beam::Street => ramp(-0.15, 0.6, cos),
                Beam::Head => {
                    // Wide on the sides, cut off above the horizon.
                    let up = -l.z - lamp.axis.z;
                    // Brightest just below the horizon, so that the road is lit evenly; this does not hold for things
                    // close by.
                    let aim = (0.055 / (0.022 + (-up).max(0.0)))
                        .powf(1.25)
                        .min(2.4)
                        .min(0.12 * d2.sqrt());
                    ramp(0.80, 0.985, cos) * (0.07 + 0.93 * ramp(0.025, -0.02, up)) * aim
                        + 0.02 * ramp(0.2, 0.9, cos)
                }
                Beam::Glow => ramp(-0.1, 0.8, cos),
            };
            if beam <= 0.0 {
                continue;
            }
            let fade = ramp(1.0, 0.55, d2.sqrt() / lamp.range_m);
            let near = if lamp.beam == Beam::Head {
                HEAD_NEAR_M2
            } else {
                0.6
            };
            let light = lamp.color * (beam * fade / (d2 + near));
            let through = s.through * (-facing).max(0.0) * 0.5;
            // Shadows of head lights and street lamps, where they would be seen.
            if shadows
                && lamp.beam != Beam::Glow
                && facing.max(through) * light.max_element() * self.air.exposure > LAMP_SHADOW_LIGHT
            {
                let way = lamp.at - lift;
                let far = way.length();
                // A street lamp hangs beside its post, not on it: occluders around the post's axis do not count.
                let clear = match lamp.beam {
                    Beam::Street => LAMP_CLEAR_M * far / way.truncate().length().max(1e-3),
                    _ => LAMP_CLEAR_M,
                };
                if far > clear && self.occluded((lift, way / far), hit.after_s, far - clear, LAMP_STEP_M) {
                    continue;
                }
            }
            out += s.albedo * light * (facing.max(0.0) + through);
            if s.gloss > 0.2 && facing > 0.0 {
                let half = (l + view).normalize_or(n);
                let power = 2f32.powf(2.0 + 7.0 * s.gloss);
                let spot = n.dot(half).max(0.0).powf(power) * (power + 2.0) * 0.125;
                out += light * (s.mirror + 0.015) * spot.min(30.0) * facing;
            }
        }
        out
    }
}
