//! Objects as they are drawn: a few convex bodies, wheels and rounded parts per box, with materials.
//! Made for the eye; sensors and worlds use `world::objects`.

use glam::{Vec2, Vec3, Vec4};

use super::noise::{hash1, unit};
use scene::{Class, Paint, SceneBox};

/// What a part is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// A car's lower body; lamps, grille and arches are found by position.
    Body,
    /// A car's cabin: glass with pillars and a roof.
    Cabin,
    /// A bus or a tram: windows in a band.
    Coach,
    /// A box body of a truck or trailer.
    Cargo,
    /// Tyre and rim.
    Wheel,
    /// Chassis, arms, frames.
    Dark,
    /// Bare metal or plastic in this linear colour.
    Plain(Vec3),
    /// Cloth in this linear colour.
    Cloth(Vec3),
    /// Skin or hair.
    Skin,
    /// Red and white, or orange and white, bands across z.
    Bands(Vec3),
}

/// A part in box coordinates: x forward, y left, z up from the bottom of the box.
#[derive(Clone, Debug)]
pub enum Part {
    /// Half spaces `n.p <= w`.
    Convex(Vec<Vec4>),
    /// A wheel: middle, radius, half width; its axis is y.
    Wheel(Vec3, f32, f32),
    /// An ellipsoid: middle and radii.
    Round(Vec3, Vec3),
    /// An upright cone or cylinder: foot, height, radii at the foot and at the top.
    Cone(Vec3, f32, f32, f32),
}

/// An object ready to be traced.
#[derive(Clone, Debug)]
pub struct Thing {
    /// Its box.
    pub class: Class,
    /// Middle of the bottom in the ego frame, m.
    pub foot: Vec3,
    /// Heading on the ground.
    pub heading: Vec2,
    /// Length, width, height, m.
    pub size: Vec3,
    /// Colour of its paint, linear.
    pub paint: Vec3,
    /// Hash that varies details.
    pub id: u32,
    /// Moving or in traffic: lamps are on at night.
    pub lamps: bool,
    /// Square of the radius of a circle on the ground that holds it, m^2.
    circle_m2: f32,
    /// Parts with materials.
    pub parts: Vec<(Part, Material)>,
}

/// Where a ray meets a thing.
#[derive(Clone, Copy, Debug)]
pub struct ThingHit {
    /// Distance, m.
    pub t: f32,
    /// In box coordinates.
    pub local: Vec3,
    /// In box coordinates.
    pub normal: Vec3,
    /// Of the part.
    pub material: Material,
}

/// sRGB to linear.
pub fn rgb(r: u8, g: u8, b: u8) -> Vec3 {
    Vec3::new(f32::from(r), f32::from(g), f32::from(b)).map(|c| (c / 255.0).powf(2.2))
}

/// Paints as they are met on streets.
fn car_paint(h: u32) -> Vec3 {
    const PAINTS: [[u8; 3]; 14] = [
        [236, 238, 238],
        [228, 230, 232],
        [40, 42, 46],
        [28, 29, 32],
        [152, 156, 160],
        [186, 190, 194],
        [104, 108, 114],
        [148, 30, 32],
        [168, 36, 30],
        [36, 64, 120],
        [58, 96, 148],
        [64, 78, 66],
        [186, 168, 134],
        [196, 120, 32],
    ];
    let [r, g, b] = PAINTS[h as usize % PAINTS.len()];
    rgb(r, g, b)
}

/// What is known by its colour wears it, unless it was given another.
fn usual_paint(name: &str) -> Option<Paint> {
    match name {
        "taxi" | "cab" | "school bus" => Some(Paint::Yellow),
        "fire engine" | "fire truck" => Some(Paint::Red),
        "ambulance" => Some(Paint::White),
        _ => None,
    }
}

struct Builder {
    parts: Vec<(Part, Material)>,
    s: Vec3,
}

impl Builder {
    /// A box from `lo` to `hi` in fractions (x, y from the middle, z from the bottom), edges bevelled by `bevel` m.
    fn block(&mut self, lo: [f32; 3], hi: [f32; 3], bevel: f32, material: Material) {
        let (lo, hi) = (Vec3::from(lo) * self.s, Vec3::from(hi) * self.s);
        let (mid, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
        let bevel = bevel.min(half.min_element());
        let mut planes = Vec::new();
        let mut add = |n: Vec3, reach: f32| {
            let n = n.normalize();
            planes.push(n.extend(n.dot(mid) + reach));
        };
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut n = Vec3::ZERO;
                n[axis] = sign;
                add(n, half[axis]);
            }
        }
        if bevel > 0.0 {
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                for (sa, sb) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    let mut n = Vec3::ZERO;
                    (n[a], n[b]) = (sa, sb);
                    add(n, (half[a] + half[b] - bevel) / 2f32.sqrt());
                }
            }
        }
        self.parts.push((Part::Convex(planes), material));
    }

    /// Half spaces through points of a side view, given in fractions of length and height, mirrored in y.
    fn profile(&mut self, points: &[[f32; 2]], sides: &[[f32; 2]], corner: f32, material: Material) {
        let s = self.s;
        let mut planes = Vec::new();
        let n = points.len();
        for i in 0..n {
            // Points run round the outline clockwise seen from the right: front to back over the top.
            let [a, b] = [points[i], points[(i + 1) % n]].map(|p| Vec2::new(p[0] * s.x, p[1] * s.z));
            let d = (b - a).normalize_or(Vec2::X);
            let out = Vec2::new(d.y, -d.x);
            planes.push(Vec4::new(out.x, 0.0, out.y, out.dot(a)));
        }
        for pair in sides.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| Vec2::new(p[0] * s.y / 2.0, p[1] * s.z));
            let d = (b - a).normalize_or(Vec2::Y);
            let out = Vec2::new(d.y, -d.x);
            for sign in [1.0, -1.0] {
                planes.push(Vec4::new(0.0, sign * out.x, out.y, out.dot(a)));
            }
        }
        if corner > 0.0 {
            for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let n = Vec2::new(0.55 * sx, 0.83 * sy).normalize();
                let reach = n.abs().dot(Vec2::new(s.x, s.y) / 2.0) - corner;
                planes.push(Vec4::new(n.x, n.y, 0.0, reach));
            }
        }
        self.parts.push((Part::Convex(planes), material));
    }

    fn wheels(&mut self, at: &[f32], radius: f32, width: f32) {
        for x in at {
            for side in [1.0, -1.0] {
                let y = side * (self.s.y / 2.0 - width / 2.0 - 0.01);
                let part = Part::Wheel(Vec3::new(x * self.s.x, y, radius), radius, width / 2.0);
                self.parts.push((part, Material::Wheel));
            }
        }
    }

    fn round(&mut self, at: [f32; 3], radii: [f32; 3], material: Material) {
        let part = Part::Round(Vec3::from(at) * self.s, Vec3::from(radii));
        self.parts.push((part, material));
    }
}

impl Thing {
    /// The look of a box; `None` if the box has a problem.
    pub fn of(b: &SceneBox, seed: u32) -> Option<Self> {
        if b.problem().is_some() {
            return None;
        }
        let id = hash1(b.id.0, seed);
        let size = b.size_m.as_vec3();
        let mut build = Builder {
            parts: Vec::new(),
            s: size,
        };
        let paint = match b.class {
            _ if let Some(paint) = b.label.paint.or_else(|| usual_paint(b.label.name.as_str())) => {
                let [r, g, b] = paint.srgb();
                rgb(r, g, b)
            }
            Class::Bus => [
                rgb(200, 60, 40),
                rgb(40, 90, 160),
                rgb(230, 230, 225),
                rgb(50, 120, 80),
            ][id as usize % 4],
            Class::Truck | Class::Trailer => [
                rgb(226, 228, 230),
                rgb(200, 204, 208),
                rgb(150, 40, 36),
                rgb(60, 90, 140),
            ][id as usize % 4],
            Class::ConstructionVehicle => rgb(232, 168, 20),
            _ => car_paint(id),
        };
        shape(&mut build, b.class, id);
        let bottom = b.center_m.z - b.size_m.z / 2.0;
        Some(Self {
            class: b.class,
            foot: b.center_m.truncate().extend(bottom).as_vec3(),
            heading: b.heading().as_vec2(),
            size,
            paint,
            id,
            lamps: b.class.is_vehicle() && (b.velocity_mps.length() > 0.3 || id.is_multiple_of(3)),
            circle_m2: (size.truncate() / 2.0 + 0.05).length_squared(),
            parts: build.parts,
        })
    }

    /// Square of the radius of a circle on the ground that holds it, m^2.
    pub fn circle_m2(&self) -> f32 {
        self.circle_m2
    }

    /// Radius on the ground and height that hold it, m.
    pub fn reach(&self) -> Vec3 {
        let r = self.size.truncate().length() / 2.0;
        Vec3::new(r, r, self.size.z)
    }

    /// A point of the ego frame in box coordinates.
    pub fn to_local(&self, p: Vec3) -> Vec3 {
        self.turn(p - self.foot)
    }

    /// A direction of the ego frame in box coordinates.
    #[inline]
    pub fn turn(&self, d: Vec3) -> Vec3 {
        let h = self.heading;
        Vec3::new(d.x * h.x + d.y * h.y, d.y * h.x - d.x * h.y, d.z)
    }

    /// A direction in box coordinates in the ego frame.
    #[inline]
    pub fn turn_back(&self, d: Vec3) -> Vec3 {
        let h = self.heading;
        Vec3::new(d.x * h.x - d.y * h.y, d.x * h.y + d.y * h.x, d.z)
    }

    /// The first surface nearer than `limit` m.
    pub fn cast(&self, origin: Vec3, dir: Vec3, limit: f32) -> Option<ThingHit> {
        // Rays that pass beside the circle around it on the ground.
        let (to, flat) = ((self.foot - origin).truncate(), dir.truncate());
        if to.perp_dot(flat).powi(2) > self.circle_m2 * flat.length_squared() {
            return None;
        }
        let (o, d) = (self.to_local(origin), self.turn(dir));
        // The box itself, a little grown, as a first test.
        let (lo, hi) = (
            Vec3::new(-self.size.x, -self.size.y, -0.2) / 2.0 - 0.02,
            Vec3::new(self.size.x / 2.0, self.size.y / 2.0, self.size.z) + 0.02,
        );
        let inv = d.recip();
        let (a, b) = ((lo - o) * inv, (hi - o) * inv);
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        // Written so that NaN (a ray within a face) is tested further.
        if near > far || far < 0.0 || near > limit {
            return None;
        }
        let mut best: Option<(ThingHit, &Part)> = None;
        for (part, material) in &self.parts {
            let limit = best.map_or(limit, |(b, _)| b.t);
            if let Some((t, normal)) = part.cast(o, d, limit) {
                let hit = ThingHit {
                    t,
                    local: o + d * t,
                    normal,
                    material: *material,
                };
                best = Some((hit, part));
            }
        }
        best.map(|(mut hit, part)| {
            if let Part::Convex(planes) = part {
                hit.normal = rounded(
                    planes,
                    hit.local,
                    hit.normal,
                    0.028 * self.size.z.max(self.size.x * 0.5),
                );
            }
            hit
        })
    }
}

/// The normal of a body whose edges are rounded over `reach` m: a blend of the faces near the point.
fn rounded(planes: &[Vec4], p: Vec3, normal: Vec3, reach: f32) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for plane in planes {
        let near = 1.0 - (plane.w - plane.truncate().dot(p)) / reach;
        // Opposite faces of a thin part do not blend.
        if near > 0.0 && plane.truncate().dot(normal) > -0.2 {
            sum += plane.truncate() * (near * near);
        }
    }
    sum.normalize_or(normal)
}

fn quadratic(a: f32, b: f32, c: f32) -> Option<(f32, f32)> {
    let disc = b * b - a * c;
    if !(disc >= 0.0 && a > 1e-12) {
        return None;
    }
    let s = disc.sqrt();
    Some(((-b - s) / a, (-b + s) / a))
}

impl Part {
    /// Where a ray enters, nearer than `limit`, and the outward normal there.
    fn cast(&self, o: Vec3, d: Vec3, limit: f32) -> Option<(f32, Vec3)> {
        match self {
            Part::Convex(planes) => {
                let (mut near, mut far, mut normal) = (f32::NEG_INFINITY, limit, Vec3::Z);
                for plane in planes {
                    let n = plane.truncate();
                    let (speed, gap) = (n.dot(d), plane.w - n.dot(o));
                    if speed.abs() < 1e-9 {
                        if gap < 0.0 {
                            return None;
                        }
                    } else if speed > 0.0 {
                        far = far.min(gap / speed);
                    } else if gap / speed > near {
                        (near, normal) = (gap / speed, n);
                    }
                    if near > far {
                        return None;
                    }
                }
                (near > 1e-4 && near < limit).then_some((near, normal))
            }
            Part::Wheel(c, r, half) => {
                let o = o - *c;
                let (t0, t1) = quadratic(
                    d.x * d.x + d.z * d.z,
                    o.x * d.x + o.z * d.z,
                    o.x * o.x + o.z * o.z - r * r,
                )?;
                let (mut near, mut far) = (t0, t1);
                let mut normal = Vec3::new(o.x + d.x * t0, 0.0, o.z + d.z * t0) / *r;
                if d.y.abs() > 1e-9 {
                    let (a, b) = ((-half - o.y) / d.y, (half - o.y) / d.y);
                    if a.min(b) > near {
                        (near, normal) = (a.min(b), -Vec3::Y * d.y.signum());
                    }
                    far = far.min(a.max(b));
                } else if o.y.abs() > *half {
                    return None;
                }
                (near <= far && near > 1e-4 && near < limit).then_some((near, normal))
            }
            Part::Round(c, r) => {
                let (p, q) = ((o - *c) / *r, d / *r);
                let (t, _) = quadratic(q.length_squared(), p.dot(q), p.length_squared() - 1.0)?;
                let normal = ((p + q * t) / *r).normalize_or(Vec3::Z);
                (t > 1e-4 && t < limit).then_some((t, normal))
            }
            Part::Cone(foot, height, bottom, top) => {
                let o = o - *foot;
                let k = (top - bottom) / height;
                let m = bottom + k * o.z;
                let a = d.x * d.x + d.y * d.y - k * k * d.z * d.z;
                let b = o.x * d.x + o.y * d.y - k * d.z * m;
                let c = o.x * o.x + o.y * o.y - m * m;
                let mut best: Option<(f32, Vec3)> = None;
                if let Some((t0, t1)) = quadratic(a, b, c) {
                    for t in [t0, t1] {
                        let p = o + d * t;
                        if t > 1e-4 && t < limit && (0.0..=*height).contains(&p.z) {
                            best = Some((
                                t,
                                Vec3::new(p.x, p.y, -k * p.truncate().length()).normalize_or(Vec3::Z),
                            ));
                            break;
                        }
                    }
                }
                let t = (height - o.z) / d.z;
                let p = o + d * t;
                if t > 1e-4 && t < limit && p.truncate().length() < *top && best.is_none_or(|b| t < b.0) {
                    best = Some((t, Vec3::Z));
                }
                best
            }
        }
    }
}

fn shape(b: &mut Builder, class: Class, id: u32) {
    let s = b.s;
    let pick = unit(hash1(id, 3));
    match class {
        Class::Car => {
            // Saloon, hatchback, van: hood, windscreen and tail as fractions of the length.
            let kinds = [
                ([0.20, 0.03, -0.24, -0.40], 0.57),
                ([0.24, 0.07, -0.36, -0.47], 0.58),
                ([0.27, 0.14, -0.42, -0.485], 0.60),
            ];
            let tall = s.z / s.x;
            let kind = if tall > 0.41 { 2 } else { usize::from(pick > 0.55) };
            let ([screen, front, back, tail], belt) = kinds[kind];
            let low = 0.12;
            b.profile(
                &[
                    [0.5, 0.22],
                    [0.5, 0.36],
                    [0.475, 0.46],
                    [screen, belt],
                    [tail, belt + 0.01],
                    [-0.485, belt - 0.04],
                    [-0.5, 0.36],
                    [-0.495, 0.2],
                    [-0.46, low],
                    [0.46, low],
                ],
                &[[0.94, 0.1], [1.0, 0.3], [0.985, 0.46], [0.93, 0.62]],
                0.14,
                Material::Body,
            );
            b.profile(
                &[
                    [screen + 0.01, belt - 0.04],
                    [front, 0.955],
                    [front - 0.08, 1.0],
                    [back + 0.06, 0.995],
                    [back, 0.95],
                    [tail, belt - 0.04],
                ],
                &[[0.965, 0.5], [0.93, belt], [0.72, 0.955], [0.55, 1.0]],
                0.0,
                Material::Cabin,
            );
            let r = (0.165 * s.z + 0.06).clamp(0.2, 0.42);
            b.wheels(&[-0.295, 0.3], r, 0.21);
            for side in [0.98, -0.98] {
                b.round(
                    [front + 0.1, side * 0.53, belt + 0.02],
                    [0.09, 0.11, 0.075],
                    Material::Body,
                );
            }
        }
        Class::Bus => {
            b.block([-0.5, -0.5, 0.1], [0.5, 0.5, 0.97], 0.14, Material::Coach);
            b.block(
                [-0.3, -0.3, 0.9],
                [0.1, 0.3, 1.0],
                0.05,
                Material::Plain(Vec3::splat(0.6)),
            );
            b.wheels(&[-0.28, 0.33], 0.48, 0.3);
        }
        Class::Truck => {
            let cab = 0.24 + 0.08 * pick;
            let van = pick > 0.55;
            b.profile(
                &[
                    [0.5, 0.14],
                    [0.5, 0.42],
                    [0.5 - 0.2 * cab, 0.8],
                    [0.5 - 0.35 * cab, 0.84],
                    [0.5 - cab, 0.84],
                    [0.5 - cab, 0.14],
                ],
                &[[0.94, 0.1], [0.96, 0.45], [0.86, 0.86]],
                0.1,
                Material::Cabin,
            );
            b.block([-0.5, -0.36, 0.14], [0.5 - cab, 0.36, 0.24], 0.0, Material::Dark);
            if van || s.z > 2.2 {
                b.block([-0.5, -0.5, 0.24], [0.49 - cab, 0.5, 1.0], 0.04, Material::Cargo);
            } else {
                b.block(
                    [-0.5, -0.48, 0.24],
                    [0.49 - cab, 0.48, 0.55],
                    0.03,
                    Material::Cargo,
                );
            }
            b.wheels(&[-0.34, 0.34], (0.16 * s.z).clamp(0.3, 0.5), 0.28);
        }
        Class::Trailer => {
            b.block([-0.5, -0.5, 0.28], [0.5, 0.5, 1.0], 0.04, Material::Cargo);
            b.block([-0.48, -0.3, 0.18], [0.48, 0.3, 0.28], 0.0, Material::Dark);
            b.wheels(&[-0.4, -0.3, -0.2], 0.46, 0.3);
        }
        Class::ConstructionVehicle => {
            b.block([-0.42, -0.5, 0.0], [0.42, -0.22, 0.26], 0.15, Material::Dark);
            b.block([-0.42, 0.22, 0.0], [0.42, 0.5, 0.26], 0.15, Material::Dark);
            let yellow = Material::Plain(rgb(232, 168, 20));
            b.block([-0.45, -0.42, 0.26], [0.2, 0.42, 0.62], 0.12, yellow);
            b.block([-0.15, 0.0, 0.6], [0.2, 0.42, 1.0], 0.08, Material::Cabin);
            b.block([0.1, -0.22, 0.5], [0.42, -0.06, 0.72], 0.05, yellow);
            b.block([0.36, -0.22, 0.3], [0.46, -0.06, 0.7], 0.05, yellow);
            b.block([0.38, -0.3, 0.02], [0.5, 0.1, 0.32], 0.05, Material::Dark);
        }
        Class::Barrier => {
            // Long in y or in x: either way it is a wall with bands.
            let bands = Material::Bands(rgb(206, 44, 30));
            b.block(
                [-0.5, -0.5, 0.0],
                [0.5, 0.5, 0.16],
                0.03,
                Material::Plain(Vec3::splat(0.12)),
            );
            b.block([-0.28, -0.5, 0.3], [0.28, 0.5, 0.62], 0.02, bands);
            b.block([-0.28, -0.5, 0.7], [0.28, 0.5, 1.0], 0.02, bands);
            for y in [-0.42, 0.4] {
                b.block(
                    [-0.2, y, 0.1],
                    [0.2, y + 0.04, 1.0],
                    0.0,
                    Material::Plain(Vec3::splat(0.4)),
                );
            }
        }
        Class::Motorcycle | Class::Bicycle => {
            let motor = class == Class::Motorcycle;
            let (r, w) = if motor { (0.3f32, 0.07) } else { (0.33, 0.02) };
            let r = r.min(s.z * 0.3);
            for x in [-0.5 * s.x + r, 0.5 * s.x - r] {
                b.parts
                    .push((Part::Wheel(Vec3::new(x, 0.0, r), r, w), Material::Wheel));
            }
            if motor {
                b.block([-0.3, -0.16, 0.26], [0.28, 0.16, 0.52], 0.08, Material::Body);
                b.block([-0.34, -0.14, 0.5], [0.02, 0.14, 0.57], 0.03, Material::Dark);
            } else {
                b.block(
                    [-0.26, -0.025, 0.36],
                    [0.26, 0.025, 0.41],
                    0.0,
                    Material::Plain(rgb(40, 90, 120)),
                );
                b.block(
                    [-0.14, -0.02, 0.3],
                    [-0.1, 0.02, 0.62],
                    0.0,
                    Material::Plain(rgb(40, 90, 120)),
                );
            }
            b.block([0.24, -0.4, 0.62], [0.29, 0.4, 0.66], 0.0, Material::Dark);
            b.block([0.24, -0.03, 0.3], [0.28, 0.03, 0.64], 0.0, Material::Dark);
            if pick < 0.7 {
                person(b, id, [-0.04, 0.0, 0.42], 0.6);
            }
        }
        Class::Pedestrian => person(b, id, [0.0; 3], 1.0),
        Class::TrafficCone => {
            b.block(
                [-0.5, -0.5, 0.0],
                [0.5, 0.5, 0.05],
                0.0,
                Material::Plain(Vec3::splat(0.03)),
            );
            let r = s.x.min(s.y) * 0.36;
            b.parts.push((
                Part::Cone(Vec3::new(0.0, 0.0, 0.05 * s.z), 0.95 * s.z, r, r * 0.2),
                Material::Bands(rgb(255, 84, 16)),
            ));
        }
        _ => {}
    }
}

/// A person whose feet are at `at` (fractions of the box), `part` of the box's height tall.
fn person(b: &mut Builder, id: u32, at: [f32; 3], part: f32) {
    let h = b.s.z * part;
    let cloth = |salt: u32| {
        let palette = [
            rgb(38, 44, 62),
            rgb(60, 62, 66),
            rgb(122, 52, 48),
            rgb(196, 190, 178),
            rgb(62, 78, 70),
            rgb(150, 126, 84),
            rgb(84, 98, 122),
            rgb(24, 24, 28),
        ];
        Material::Cloth(palette[hash1(id, salt) as usize % palette.len()])
    };
    let (coat, trousers) = (cloth(1), cloth(2));
    let foot = Vec3::from(at) * b.s;
    let stride = 0.09 * h * (unit(hash1(id, 5)) - 0.2);
    let mut put = |c: [f32; 3], r: [f32; 3], m: Material| {
        let centre = foot + Vec3::new(c[0], c[1], c[2]) * Vec3::new(1.0, h, h);
        b.parts.push((Part::Round(centre, Vec3::from(r) * h), m));
    };
    for side in [-1.0, 1.0] {
        put(
            [side * stride, side * 0.055, 0.25],
            [0.062, 0.055, 0.27],
            trousers,
        );
        put(
            [side * stride + 0.04, side * 0.055, 0.025],
            [0.075, 0.04, 0.03],
            Material::Dark,
        );
        put(
            [-side * stride * 0.6, side * 0.135, 0.63],
            [0.036, 0.034, 0.185],
            coat,
        );
    }
    put([0.0, 0.0, 0.65], [0.072, 0.108, 0.215], coat);
    put([0.0, 0.0, 0.795], [0.055, 0.125, 0.055], coat);
    put([0.01, 0.0, 0.935], [0.056, 0.048, 0.066], Material::Skin);
    put([-0.01, 0.0, 0.955], [0.058, 0.052, 0.058], Material::Dark);
}
