//! Scenery: roofs, masonry, boards, concrete, metal, signs, lights, panes. Patterns are anchored in the thing and varied by
//! its number, so that nothing else changes its look. `scenery_material.wgsl` has the same formulas.

use glam::{IVec3, Vec2, Vec3};

use super::super::noise::{hash1, ramp, unit, unit3, value2, value3};
use super::super::prepared::Appearance;
use super::super::things::{DrawnObject, ObjectPart, PartMaterial, rgb};
use super::facade::{WALLS, wall_color};
use super::{LitSurface, band, gray, visible};

impl Appearance {
    /// The surface of a part of scenery at a point with a normal, both in box coordinates.
    pub(super) fn scenery_surface(
        &self,
        (t, part, material): (&DrawnObject, &ObjectPart, PartMaterial),
        p: Vec3,
        n: Vec3,
        fp: f32,
    ) -> LitSurface {
        // A corner of the noise of its own for each thing.
        let q = p + Vec3::new(unit(hash1(t.id, 31)), unit(hash1(t.id, 32)), 0.0) * 64.0;
        let along = Vec2::new(-n.y, n.x).normalize_or(Vec2::X);
        let u = p.truncate().dot(along);
        match material {
            PartMaterial::Walls(walls) if n.z.abs() < 0.7 => self.walls((t, part, walls), p, n, q, fp),
            PartMaterial::Walls(_) => gravel(q, n, fp),
            PartMaterial::Roof(color) => tiles(color, (t.id, u), p, q, n, fp),
            PartMaterial::Masonry(color) => masonry(color, (t.id, u), p, q, n, fp),
            PartMaterial::Boards(color) => boards(color, (t.id, u), p, q, n, fp),
            PartMaterial::Concrete(color) => concrete(color, q, n, fp),
            PartMaterial::SignPlate(plate) => sign(plate, t.id, p, n, fp),
            PartMaterial::SignalHead(head) => self.signal(head, t.id, p, n),
            PartMaterial::Lamp => self.lamp_arm(t, p, n),
            PartMaterial::Pane => pane(u, p, n, fp),
            PartMaterial::Metal(color) => metal(color, q, n),
            PartMaterial::Plain(color) => {
                // The opening of a bin.
                let color = if n.z > 0.7 { color * 0.25 } else { color };
                let mut s = metal(color, q, n);
                (s.mirror, s.gloss) = (0.03, 0.5);
                s
            }
            _ => LitSurface::matt(gray(0.2), n),
        }
    }

    /// Traffic lights: one of three lamps is lit.
    fn signal(&self, head: Vec3, id: u32, p: Vec3, n: Vec3) -> LitSurface {
        let mut s = LitSurface::matt(gray(0.018), n);
        (s.mirror, s.gloss) = (0.03, 0.4);
        if n.x < 0.7 {
            return s;
        }
        let colors = [
            Vec3::new(0.05, 0.9, 0.35),
            Vec3::new(1.0, 0.55, 0.05),
            Vec3::new(1.0, 0.06, 0.03),
        ];
        let lit = [0, 2, 2, 0][(hash1(id, 21) % 4) as usize];
        for (k, color) in colors.into_iter().enumerate() {
            let middle = head.x + head.y * 0.62 * (k as f32 - 1.0);
            let off = Vec2::new(p.y - head.z, p.z - middle).length();
            if off < head.y * 0.24 {
                s.albedo = color * 0.06 + gray(0.01);
                if k == lit {
                    s.emit = color * (1.1 + 1.9 * self.air.lamps) * ramp(head.y * 0.30, head.y * 0.1, off);
                }
            }
        }
        s
    }

    /// The arm of a street light, whose lamp shines downward from its end.
    fn lamp_arm(&self, t: &DrawnObject, p: Vec3, n: Vec3) -> LitSurface {
        let mut s = LitSurface::matt(gray(0.12), n);
        (s.mirror, s.gloss) = (0.04, 0.45);
        if n.z < -0.5 && p.x > t.size.x / 2.0 - 0.55 {
            s.albedo = gray(0.5);
            s.emit = Vec3::new(1.0, 0.74, 0.42) * 3.5 * self.air.lamps;
        }
        s
    }
}

/// A flat roof: gravel, with stains.
fn gravel(q: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let grain = value2(q.truncate() * 11.0, 19) - 0.5;
    let stain = value2(q.truncate() * 0.5, 33) + 0.5 * value2(q.truncate() * 1.7, 34);
    let c = gray(0.17) * (0.72 + 0.36 * stain) * (1.0 + 0.5 * grain * visible(fp, 0.09));
    LitSurface::matt(c * Vec3::new(1.0, 0.97, 0.92), n)
}

/// A tiled roof: rows across the slope, each tile of its own tone; its gable ends are rendered.
fn tiles(color: Vec3, (id, u): (u32, f32), p: Vec3, q: Vec3, n: Vec3, fp: f32) -> LitSurface {
    if n.z < 0.25 {
        // The gable belongs to the walls below it.
        return concrete(wall_color(hash1(id, 1) % WALLS), q, n, fp);
    }
    let steep = (1.0 - n.z * n.z).max(0.01).sqrt();
    let row = (p.z / steep / 0.32).floor();
    let column = (u / 0.24 + 0.5 * (row % 2.0)).floor();
    let tone = unit3(IVec3::new(column as i32, row as i32, 7), id);
    let down = p.z / steep / 0.32 - row;
    let shade = visible(fp, 0.22);
    let moss = ramp(0.55, 0.9, value2(q.truncate() * 0.8 + p.z * 0.3, 35)) * 0.35;
    let c = color * (0.86 + 0.28 * value2(q.truncate() * 0.35, 36));
    let c = c * (1.0 + shade * (0.42 * (tone - 0.5) - 0.35 * ramp(0.18, 0.0, down)));
    LitSurface::matt(c.lerp(Vec3::new(0.055, 0.065, 0.03), moss), n)
}

/// Courses of stone, with a coping on top.
fn masonry(color: Vec3, (id, u): (u32, f32), p: Vec3, q: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let stain = 0.78 + 0.3 * value3(q * 0.9, 37) + 0.12 * value3(q * 3.0, 38);
    let mut c = color * stain;
    if n.z < 0.7 {
        let row = (p.z / 0.15).floor();
        let x = u / 0.32 + 0.5 * (row % 2.0);
        let tone = unit3(IVec3::new(x.floor() as i32, row as i32, 3), id);
        let joint = band(0.5 - (p.z / 0.15 - row - 0.5).abs(), 0.07, fp / 0.15).max(band(
            0.5 - (x - x.floor() - 0.5).abs(),
            0.035,
            fp / 0.32,
        ));
        let shown = visible(fp, 0.13);
        c *= 1.0 + shown * (0.20 * (tone - 0.5) + 0.10 * (value3(q * 14.0, 41) - 0.5));
        c = c.lerp(gray(0.24), 0.75 * joint * shown);
        c *= 1.0 - 0.22 * ramp(0.5, 0.1, p.z);
    }
    LitSurface::matt(c, n)
}

/// Upright boards, weathered, each of its own tone.
fn boards(color: Vec3, (id, u): (u32, f32), p: Vec3, q: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let x = u / 0.13;
    let board = x.floor();
    let tone = unit3(IVec3::new(board as i32, 5, 5), id);
    let gap = band(0.5 - (x - board - 0.5).abs(), 0.06, fp / 0.13);
    let grain = value3(q * Vec3::new(22.0, 22.0, 1.6), 39) - 0.5;
    let c = color * (0.80 + 0.25 * value3(q * 0.8, 40));
    let c =
        c * (1.0 + visible(fp, 0.11) * (0.40 * (tone - 0.5) - 0.75 * gap) + 0.30 * grain * visible(fp, 0.04));
    LitSurface::matt(c * (1.0 - 0.25 * ramp(0.45, 0.1, p.z)), n)
}

/// Concrete: large soft stains, pores close by.
fn concrete(color: Vec3, q: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let stain = value3(q * 0.6, 51) + 0.5 * value3(q * 1.9, 52) + 0.25 * value3(q * 6.0, 53);
    let pores = (value3(q * 30.0, 54) - 0.5) * visible(fp, 0.03);
    LitSurface::matt(color * (0.72 + 0.32 * stain + 0.12 * pores), n)
}

fn metal(color: Vec3, q: Vec3, n: Vec3) -> LitSurface {
    let mut s = LitSurface::matt(color * (0.9 + 0.2 * value3(q * 3.0, 20)), n);
    (s.mirror, s.gloss) = (0.04, 0.45);
    s
}

/// Panes of glass in a metal frame.
fn pane(u: f32, p: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let x = u / 1.2;
    let bar =
        band(0.5 - (x - x.floor() - 0.5).abs(), 0.035, fp / 1.2).max(band((p.z - 0.95).abs(), 0.03, fp));
    let mut s = LitSurface::matt(Vec3::new(0.085, 0.105, 0.105).lerp(gray(0.11), bar), n);
    (s.mirror, s.gloss) = (0.08 * (1.0 - bar), 0.95);
    s
}

/// The plate of a traffic sign, by its number: a limit, a crossing, parking, one way; grey from behind.
fn sign(plate: Vec3, id: u32, p: Vec3, n: Vec3, fp: f32) -> LitSurface {
    let mut s = LitSurface::matt(gray(0.24), n);
    (s.mirror, s.gloss) = (0.04, 0.5);
    if n.x < 0.7 {
        return s;
    }
    // From the middle, as shares of half a side; x to the right as seen from in front.
    let at = Vec2::new(p.y, p.z - plate.x) / plate.y;
    let edge = (fp / plate.y * 0.6).max(0.012);
    let within = |d: f32| ramp(edge, -edge, d);
    let bar = |middle: Vec2, half: Vec2| within(((at - middle).abs() - half).max_element());
    let (white, red, blue) = (gray(0.62), rgb(178, 22, 26), rgb(18, 72, 140));
    let (base, over, mark) = match hash1(id, 22) % 4 {
        0 => {
            let r = at.length();
            let ring = within((r - 0.78).abs() - 0.13);
            let digits = bar(Vec2::new(-0.26, 0.0), Vec2::new(0.06, 0.34)).max(
                within((at - Vec2::new(0.22, 0.0)).length() - 0.30)
                    - within((at - Vec2::new(0.22, 0.0)).length() - 0.17),
            );
            (white, ring, (digits.max(0.0), gray(0.015)))
        }
        1 => {
            let triangle = within((at.x.abs() * 0.86 + (at.y + 0.12) * 0.5 - 0.36).max(-0.62 - at.y));
            let figure = bar(Vec2::new(0.0, -0.18), Vec2::new(0.05, 0.22))
                .max(within((at - Vec2::new(0.0, 0.14)).length() - 0.08));
            (blue, 0.0, (triangle * 0.98, white.lerp(gray(0.015), figure)))
        }
        2 => {
            let stem = bar(Vec2::new(-0.2, 0.0), Vec2::new(0.11, 0.58));
            let r = (at - Vec2::new(-0.02, 0.26)).length();
            let bowl = within((r - 0.24).abs() - 0.10) * ramp(-0.14, -0.10, at.x);
            (blue, 0.0, (stem.max(bowl), white))
        }
        _ => {
            let shaft = bar(Vec2::new(0.0, -0.14), Vec2::new(0.12, 0.44));
            let head = within((at.x.abs() + at.y - 0.62).max(0.22 - at.y));
            (blue, 0.0, (shaft.max(head), white))
        }
    };
    let rim = within(0.93 - at.abs().max_element());
    s.albedo = base.lerp(red, over).lerp(mark.1, mark.0).lerp(white, rim);
    s
}
