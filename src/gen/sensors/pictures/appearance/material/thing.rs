//! Objects: cars from their lamps to their tyres, people, cones, barriers.

use glam::{Vec2, Vec3};

use super::super::noise::{ramp, unit, unit3, value2, value3};
use super::super::prepared::Appearance;
use super::super::things::{DrawnObject, ObjectPart, PartMaterial, rgb};
use super::{LitSurface, TAIL, band, gray, visible};
use scene::Class;

/// A place on an object.
struct Spot<'a> {
    t: &'a DrawnObject,
    /// In box coordinates, m.
    p: Vec3,
    /// Normal in box coordinates.
    n: Vec3,
    /// Edge of a pixel there, m.
    fp: f32,
    /// How bright its lamps are.
    lamps: f32,
    /// How bright lamps are on the street.
    street_lamps: f32,
}

impl Spot<'_> {
    /// The place as a share of the length from the middle, of half the width, of the height.
    fn shares(&self) -> [f32; 3] {
        let (p, s) = (self.p, self.t.size);
        [p.x / s.x, p.y.abs() / (s.y / 2.0), p.z / s.z]
    }
}

impl Appearance {
    pub(super) fn thing_surface(
        &self,
        t: &DrawnObject,
        (p, n): (Vec3, Vec3),
        (part, material): (&ObjectPart, PartMaterial),
        fp: f32,
    ) -> LitSurface {
        let mut out = LitSurface::matt(gray(0.1), n);
        let spot = Spot {
            t,
            p,
            n,
            fp,
            lamps: if t.lamps { self.air.lamps } else { 0.0 },
            street_lamps: self.air.lamps,
        };
        match material {
            PartMaterial::Body => body(&mut out, &spot),
            PartMaterial::Cabin => cabin(&mut out, &spot),
            PartMaterial::Coach => coach(&mut out, &spot),
            PartMaterial::Cargo => cargo(&mut out, &spot),
            PartMaterial::Wheel => wheel(&mut out, &spot, part),
            PartMaterial::Dark => out.albedo = gray(0.022),
            PartMaterial::Plain(c) => {
                out.albedo = c;
                (out.mirror, out.gloss) = (0.03, 0.5);
            }
            PartMaterial::Cloth(c) => {
                let fold = value3(p * Vec3::new(14.0, 14.0, 7.0), t.id);
                out.albedo = c * (0.72 + 0.5 * fold);
            }
            PartMaterial::Skin => {
                out.albedo = [rgb(224, 172, 136), rgb(190, 130, 96), rgb(120, 78, 54)][t.id as usize % 3]
            }
            PartMaterial::Bands(c) => {
                let (s, [_, _, z]) = (t.size, spot.shares());
                let banded = if t.class == Class::TrafficCone {
                    (z > 0.42 && z < 0.60) || (z > 0.72 && z < 0.82)
                } else {
                    let wide = if s.y > s.x { p.y } else { p.x };
                    ((wide + p.z * 0.8) / 0.5).rem_euclid(1.0) < 0.5
                };
                out.albedo = if banded { gray(0.75) } else { c };
            }
            // Of scenery, see `scenery_surface`.
            _ => {}
        }
        out
    }
}

/// A car's lower body: arches, sills, doors, grille, plates and lamps.
fn body(out: &mut LitSurface, spot: &Spot<'_>) {
    let &Spot {
        t, p, n, fp, lamps, ..
    } = spot;
    let s = t.size;
    let [x, y, z] = spot.shares();
    out.albedo = t.paint;
    (out.mirror, out.gloss) = (0.05, 0.96);
    let r = (0.165 * s.z + 0.06).clamp(0.2, 0.42);
    for wheel in [-0.295, 0.3] {
        let d = Vec2::new(p.x - wheel * s.x, p.z - r).length();
        if d < r * 1.17 && n.y.abs() > 0.4 && t.class == Class::Car {
            out.albedo = gray(0.006);
            out.mirror = 0.0;
        }
    }
    if z < 0.17 || (z < 0.25 && n.y.abs() > 0.6) {
        out.albedo = gray(0.012);
        out.mirror = 0.01;
    }
    if t.class != Class::Car {
        return;
    }
    // Gaps of the doors, and their handles.
    if n.y.abs() > 0.6 && z > 0.22 && z < 0.6 {
        let gap = [0.185, -0.03, -0.225]
            .iter()
            .map(|g| (x - g).abs() * s.x)
            .fold(9.0, f32::min);
        out.albedo *= 1.0 - 0.75 * band(gap, 0.008, fp);
        for door in [-0.005, -0.205] {
            if (x - door).abs() < 0.016 && (z - 0.5).abs() < 0.010 {
                out.albedo = gray(0.25);
            }
        }
    }
    if x > 0.45 && n.x > 0.2 {
        if y < 0.60 && z > 0.22 && z < 0.40 {
            out.albedo = gray(0.010 + 0.03 * f32::from(u8::from((p.z * 36.0).fract() > 0.6)));
            out.mirror = 0.02;
        }
        if y < 0.30 && z > 0.25 && z < 0.32 {
            out.albedo = gray(0.62);
        }
    }
    let corner = x.abs() > 0.43 && y > 0.50 && n.x.abs() + n.y.abs() > 0.4;
    if x > 0.43 && corner && z > 0.365 && z < 0.455 {
        out.albedo = gray(0.55);
        (out.mirror, out.gloss) = (0.08, 0.97);
        out.emit = Vec3::new(1.0, 0.95, 0.85) * 7.0 * lamps * ramp(0.2, 0.7, n.x);
    }
    if x < -0.455 && y > 0.48 && z > 0.40 && z < 0.535 && n.x < 0.3 {
        out.albedo = Vec3::new(0.32, 0.008, 0.010);
        (out.mirror, out.gloss) = (0.06, 0.95);
        // Brighter towards the bulb in its middle.
        let aside = ((z - 0.4675) / 0.0675).abs().max((y - 0.74).abs() / 0.26);
        out.emit = TAIL * (0.03 + lamps * (0.40 + 0.85 * ramp(1.0, 0.25, aside)));
    }
    if x < -0.47 && n.x < -0.5 && y < 0.3 && z > 0.36 && z < 0.44 {
        out.albedo = gray(0.62);
        out.mirror = 0.0;
    }
}

/// Glass between pillars, a roof; a truck's grille and lamps.
fn cabin(out: &mut LitSurface, spot: &Spot<'_>) {
    let &Spot { t, n, lamps, .. } = spot;
    let s = t.size;
    let [x, y, z] = spot.shares();
    out.albedo = t.paint;
    (out.mirror, out.gloss) = (0.05, 0.96);
    let truck = t.class != Class::Car;
    let (low, high) = if truck { (0.48, 0.76) } else { (0.585, 0.925) };
    let glassy = z > low && z < high && n.z < 0.86;
    let across = 0.93 - 0.21 * ((z - 0.58) / 0.38).clamp(0.0, 1.0);
    let pane = if n.y.abs() > 0.75 {
        // Side windows between pillars.
        let pillars: &[f32] = if truck { &[0.9] } else { &[-0.035, -0.225] };
        pillars.iter().all(|g| (x - g).abs() * s.x > 0.045)
    } else {
        y < across * 0.94 || truck && y < 0.84
    };
    if glassy && pane {
        out.albedo = gray(0.012);
        (out.mirror, out.gloss) = (0.075, 0.99);
    }
    if truck && n.x > 0.5 && z < 0.34 {
        out.albedo = gray(0.03);
        if y > 0.58 && z > 0.2 && z < 0.28 {
            out.albedo = gray(0.5);
            out.emit = Vec3::new(1.0, 0.95, 0.85) * 7.0 * lamps;
        }
    }
}

/// A bus: windows in a band, its sign, its lamps.
fn coach(out: &mut LitSurface, spot: &Spot<'_>) {
    let &Spot { t, p, n, lamps, .. } = spot;
    let s = t.size;
    let [_, y, z] = spot.shares();
    out.albedo = t.paint;
    (out.mirror, out.gloss) = (0.05, 0.93);
    if z < 0.16 {
        out.albedo = gray(0.02);
    }
    let side = n.y.abs() > 0.6;
    let window = z > 0.40 && z < 0.74 && n.z.abs() < 0.5;
    let post = side && ((p.x / 1.45).fract().abs() - 0.5).abs() > 0.47;
    if window && !post && (side || y < 0.88) {
        out.albedo = gray(0.014);
        (out.mirror, out.gloss) = (0.075, 0.99);
        out.emit = Vec3::new(1.0, 0.86, 0.62) * 0.16 * ramp(0.5, 1.0, spot.street_lamps);
    }
    if z > 0.80 && z < 0.90 && n.x > 0.6 && y < 0.7 {
        out.albedo = gray(0.01);
        out.emit = Vec3::new(1.0, 0.55, 0.1)
            * (0.25 + 1.2 * lamps)
            * f32::from(u8::from(unit3((p * 22.0).floor().as_ivec3(), t.id) > 0.55));
    }
    for wheel in [-0.28, 0.33] {
        if side && Vec2::new(p.x - wheel * s.x, p.z - 0.48).length() < 0.56 {
            out.albedo = gray(0.006);
            out.mirror = 0.0;
        }
    }
    if n.x.abs() > 0.6 && y > 0.62 && z > 0.17 && z < 0.25 {
        out.emit = if n.x > 0.0 {
            Vec3::new(1.0, 0.95, 0.85) * 7.0
        } else {
            TAIL * 0.9
        } * lamps;
        out.albedo = if n.x > 0.0 {
            gray(0.5)
        } else {
            Vec3::new(0.3, 0.01, 0.01)
        };
    }
    if n.x > 0.6 && z > 0.30 && z < 0.74 && y < 0.9 {
        out.albedo = gray(0.014);
        (out.mirror, out.gloss) = (0.075, 0.99);
        out.emit = Vec3::ZERO;
    }
}

/// A box body: ribs, dirt, tail lamps, doors.
fn cargo(out: &mut LitSurface, spot: &Spot<'_>) {
    let &Spot {
        t, p, n, fp, lamps, ..
    } = spot;
    let [_, y, z] = spot.shares();
    let rib = ((p.x / 0.42).fract().abs() - 0.5).abs();
    out.albedo = t.paint * (0.92 + 0.08 * unit(t.id));
    if n.y.abs() > 0.6 {
        out.albedo *= 1.0 - 0.10 * visible(fp, 0.2) * ramp(0.40, 0.48, rib);
    }
    out.albedo *= 1.0 - 0.25 * ramp(0.55, 0.25, z) * value2(Vec2::new(p.x, p.z) * 2.0, t.id);
    (out.mirror, out.gloss) = (0.03, 0.6);
    if n.x < -0.6 && z < 0.36 && y > 0.68 {
        out.albedo = Vec3::new(0.3, 0.01, 0.01);
        out.emit = TAIL * (0.03 + 0.87 * lamps);
    }
    if n.x < -0.6 && y < 0.02 {
        out.albedo *= 0.4;
    }
}

/// A tyre, and a rim inside: of five spokes, or of steel with bolts.
fn wheel(out: &mut LitSurface, spot: &Spot<'_>, part: &ObjectPart) {
    let &Spot { t, p, n, .. } = spot;
    out.albedo = gray(0.010);
    let &ObjectPart::Wheel(middle, r, _) = part else {
        return;
    };
    if n.y.abs() <= 0.7 {
        return;
    }
    let q = Vec2::new(p.x - middle.x, p.z - middle.z);
    let d = q.length() / r;
    let turn = q.to_angle() / std::f32::consts::TAU;
    let is_rim = match t.class {
        Class::Car => {
            let spoke = (turn * 5.0).fract().abs();
            d < 0.70 && (!(0.2..=0.62).contains(&d) || (spoke - 0.5).abs() < 0.30)
        }
        _ => {
            let bolt = ((turn * 10.0).fract().abs() - 0.5).abs();
            d < 0.60 && !(0.22..=0.27).contains(&d) && !((0.33..=0.39).contains(&d) && bolt < 0.2)
        }
    };
    if is_rim {
        out.albedo = if t.class == Class::Car {
            gray(0.34)
        } else {
            gray(0.2)
        };
        (out.mirror, out.gloss) = (0.10, 0.8);
    }
}
