//! Puts objects together from parts, in fractions of their size.

use glam::{Vec2, Vec3, Vec4};

use super::{ObjectPart, PartMaterial};

/// Collects the parts of one object.
pub(super) struct ObjectBuilder {
    /// Parts so far, with materials.
    pub parts: Vec<(ObjectPart, PartMaterial)>,
    /// Length, width, height, m.
    pub s: Vec3,
}

impl ObjectBuilder {
    /// A box from `lo` to `hi` in fractions (x, y from the middle, z from the bottom), edges bevelled by `bevel` m.
    pub fn block(&mut self, lo: [f32; 3], hi: [f32; 3], bevel: f32, material: PartMaterial) {
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
        self.parts.push((ObjectPart::Convex(planes), material));
    }

    /// Half spaces through points of a side view, given in fractions of length and height, mirrored in y.
    pub fn profile(&mut self, points: &[[f32; 2]], sides: &[[f32; 2]], corner: f32, material: PartMaterial) {
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
        self.parts.push((ObjectPart::Convex(planes), material));
    }

    /// A pair of wheels at each fraction of the length.
    pub fn wheels(&mut self, at: &[f32], radius: f32, width: f32) {
        for x in at {
            for side in [1.0, -1.0] {
                let y = side * (self.s.y / 2.0 - width / 2.0 - 0.01);
                let part = ObjectPart::Wheel(Vec3::new(x * self.s.x, y, radius), radius, width / 2.0);
                self.parts.push((part, PartMaterial::Wheel));
            }
        }
    }

    /// A limb between two points with a radius at each, m.
    pub fn limb(&mut self, ends: [Vec3; 2], radii: [f32; 2], material: PartMaterial) {
        self.parts.push((ObjectPart::Limb(ends, radii, 1.0), material));
    }

    /// An ellipsoid at fractions of the size; radii in m.
    pub fn round(&mut self, at: [f32; 3], radii: [f32; 3], material: PartMaterial) {
        let part = ObjectPart::Round(Vec3::from(at) * self.s, Vec3::from(radii));
        self.parts.push((part, material));
    }
}
