//! Analytic solids that a world is made of: tapered boxes, upright frustums, ellipsoids, prisms. Each can test whether
//! a point is inside, and find where a ray enters.

pub mod fill;
mod prism;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Class;
use super::draw::hash;
use super::road_map::inside;

/// Geometry of a solid.
#[derive(Clone, Debug)]
pub enum SolidShape {
    /// An upright box whose sides may lean in: half extents at the bottom, and at the top
    /// (`top` holds half length and half width there).
    Hull {
        /// Half length, half width at the bottom, half height, m.
        half: DVec3,
        /// Half length and half width at the top, m.
        top: DVec2,
        /// Unit vector of its length axis on the ground.
        heading: DVec2,
    },
    /// An upright cylinder or cone.
    Frustum {
        /// Radius at the bottom, m.
        bottom: f64,
        /// Radius at the top, m.
        top: f64,
        /// Half height, m.
        half_height: f64,
    },
    /// An ellipsoid with vertical axis.
    Ellipsoid {
        /// Radii along x, y and z, m.
        radii: DVec3,
    },
    /// An upright prism over an outline.
    Prism {
        /// Corners relative to the middle, counter-clockwise, m.
        outline: Arc<[DVec2]>,
        /// Half extents of the box around it, m.
        half: DVec3,
    },
}

/// A solid of one class.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Geometry.
    pub shape: SolidShape,
    /// Its middle in the ego frame, m.
    pub center: DVec3,
    /// Label of its surface.
    pub class: Class,
    /// Share of its volume that rays pass through, 0 = solid, as leaves do; in lumps of 0.35 m.
    pub porosity: f64,
}

const LUMP_M: f64 = 0.35;

impl Solid {
    /// A box with vertical sides. `size` is length, width, height; `bottom` its lower face.
    pub fn block(class: Class, base: DVec3, size: DVec3, heading: DVec2) -> Self {
        Self::tapered(class, base, size, DVec2::ONE, heading)
    }

    /// A box standing on `base` whose top is scaled by `taper` in length and width.
    pub fn tapered(class: Class, base: DVec3, size: DVec3, taper: DVec2, heading: DVec2) -> Self {
        let half = size / 2.0;
        let (center, top) = (base + DVec3::Z * half.z, half.truncate() * taper);
        let shape = SolidShape::Hull { half, top, heading };
        Self {
            shape,
            center,
            class,
            porosity: 0.0,
        }
    }

    /// A cylinder or cone standing on `base`.
    pub fn frustum(class: Class, base: DVec3, height: f64, bottom: f64, top: f64) -> Self {
        let half_height = height / 2.0;
        let shape = SolidShape::Frustum {
            bottom,
            top,
            half_height,
        };
        Self {
            shape,
            center: base + DVec3::Z * half_height,
            class,
            porosity: 0.0,
        }
    }

    /// An ellipsoid around `center`.
    pub fn ellipsoid(class: Class, center: DVec3, radii: DVec3, porosity: f64) -> Self {
        Self {
            shape: SolidShape::Ellipsoid { radii },
            center,
            class,
            porosity,
        }
    }

    /// A prism over a simple outline between two heights, m.
    pub fn prism(class: Class, outline_m: &[DVec2], bottom_m: f64, top_m: f64) -> Self {
        let min = outline_m.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let max = outline_m.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let middle = (min + max) / 2.0;
        let mut outline: Vec<DVec2> = outline_m.iter().map(|p| *p - middle).collect();
        let twice_area: f64 = (0..outline.len())
            .map(|i| outline[i].perp_dot(outline[(i + 1) % outline.len()]))
            .sum();
        if twice_area < 0.0 {
            outline.reverse();
        }
        let half = ((max - min) / 2.0).extend((top_m - bottom_m) / 2.0);
        Self {
            shape: SolidShape::Prism {
                outline: outline.into(),
                half,
            },
            center: middle.extend((top_m + bottom_m) / 2.0),
            class,
            porosity: 0.0,
        }
    }

    /// The solid with a radius or half width of at least `half_m` on the ground.
    fn at_least(&self, half_m: f64) -> Self {
        let mut out = self.clone();
        match &mut out.shape {
            SolidShape::Hull { half, top, .. } => {
                let thin = half.truncate().cmplt(DVec2::splat(half_m));
                *top = DVec2::select(thin, top.max(DVec2::splat(half_m)), *top);
                let floor = DVec2::splat(half_m);
                *half = half.truncate().max(floor).extend(half.z);
            }
            SolidShape::Frustum { bottom, top, .. } => {
                *bottom = bottom.max(half_m);
                *top = if *top > 0.02 { top.max(half_m) } else { *top };
            }
            SolidShape::Ellipsoid { .. } | SolidShape::Prism { .. } => {}
        }
        out
    }

    /// Half extents of the axis-aligned box around it, m.
    pub fn reach(&self) -> DVec3 {
        match &self.shape {
            SolidShape::Prism { half, .. } => *half,
            &SolidShape::Hull { half, top, heading } => {
                let wide = half.truncate().max(top);
                let h = heading.abs();
                DVec3::new(wide.x * h.x + wide.y * h.y, wide.x * h.y + wide.y * h.x, half.z)
            }
            &SolidShape::Frustum {
                bottom,
                top,
                half_height,
            } => {
                let r = bottom.max(top);
                DVec3::new(r, r, half_height)
            }
            SolidShape::Ellipsoid { radii } => *radii,
        }
    }

    fn local(&self, p: DVec3, heading: DVec2) -> DVec3 {
        let d = p - self.center;
        DVec3::new(
            d.x * heading.x + d.y * heading.y,
            d.y * heading.x - d.x * heading.y,
            d.z,
        )
    }

    /// A hash of the lump that holds a point. Lumps are counted from the middle of the solid: they move with it.
    fn lump(&self, p: DVec3) -> u64 {
        let q = ((p - self.center) / LUMP_M).floor();
        let size = match &self.shape {
            SolidShape::Hull { half, .. } | SolidShape::Prism { half, .. } => half.x,
            SolidShape::Frustum { bottom, .. } => *bottom,
            SolidShape::Ellipsoid { radii } => radii.x,
        };
        hash(q.x as i64 as u64 ^ hash(q.y as i64 as u64 ^ hash(q.z as i64 as u64 ^ size.to_bits())))
    }

    fn is_pore(&self, p: DVec3) -> bool {
        if self.porosity <= 0.0 {
            return false;
        }
        let h = self.lump(p);
        ((h >> 11) as f64) < self.porosity * (1u64 << 53) as f64
    }

    /// True if all its levels look the same, so that a point is inside if its height and its place on the ground are.
    fn is_upright(&self) -> bool {
        matches!(self.shape, SolidShape::Prism { .. }) && self.porosity <= 0.0
    }

    /// True if the height `z_m` is between its bottom and its top.
    fn spans(&self, z_m: f64) -> bool {
        (z_m - self.center.z).abs() <= self.reach().z
    }

    /// True if the point is in the solid and not in one of its pores.
    pub fn contains(&self, p: DVec3) -> bool {
        let inside = match &self.shape {
            SolidShape::Prism { outline, half } => {
                let q = p - self.center;
                q.abs().cmple(*half).all() && inside(outline, q.truncate())
            }
            &SolidShape::Hull { half, top, heading } => {
                let q = self.local(p, heading);
                let t = (q.z + half.z) / (2.0 * half.z).max(1e-9);
                let wide = half.truncate().lerp(top, t);
                q.z.abs() <= half.z && q.x.abs() <= wide.x && q.y.abs() <= wide.y
            }
            &SolidShape::Frustum {
                bottom,
                top,
                half_height,
            } => {
                let q = p - self.center;
                let t = (q.z + half_height) / (2.0 * half_height).max(1e-9);
                let r = bottom + (top - bottom) * t;
                q.z.abs() <= half_height && q.truncate().length_squared() <= r * r
            }
            &SolidShape::Ellipsoid { radii } => ((p - self.center) / radii).length_squared() <= 1.0,
        };
        inside && !self.is_pore(p)
    }

    /// Outward unit normal at a point of the surface, as it affects an echo. Leaves of a porous solid face any
    /// direction: their normal is a hash of the lump.
    pub fn normal(&self, p: DVec3) -> DVec3 {
        if self.porosity > 0.0 {
            let h = hash(self.lump(p) ^ 0x1eaf);
            let unit = |shift: u32| f64::from((h >> shift) as u16) / 32767.5 - 1.0;
            return DVec3::new(unit(0), unit(16), unit(32)).normalize_or(DVec3::Z);
        }
        self.normal_at(p)
    }

    /// Outward unit normal of the face nearest to a point on the surface; pores count as the surface
    /// that they were cut from. Up where there is no nearest face.
    pub fn normal_at(&self, p: DVec3) -> DVec3 {
        let in_world = |n: DVec3, heading: DVec2| {
            DVec3::new(
                n.x * heading.x - n.y * heading.y,
                n.x * heading.y + n.y * heading.x,
                n.z,
            )
        };
        match &self.shape {
            SolidShape::Prism { outline, half } => prism::normal_at(outline, *half, p - self.center),
            &SolidShape::Hull { half, top, heading } => {
                let q = self.local(p, heading);
                let mut best = (half.z - q.z.abs(), DVec3::Z * q.z.signum());
                for axis in 0..2 {
                    let slope = (top[axis] - half[axis]) / (2.0 * half.z).max(1e-9);
                    let middle = (top[axis] + half[axis]) / 2.0;
                    let mut n = DVec3::new(0.0, 0.0, -slope);
                    n[axis] = q[axis].signum();
                    let gap = (middle + slope * q.z - q[axis].abs()) / n.length();
                    if gap < best.0 {
                        best = (gap, n);
                    }
                }
                in_world(best.1, heading).normalize_or(DVec3::Z)
            }
            &SolidShape::Frustum {
                bottom,
                top,
                half_height,
            } => {
                let q = p - self.center;
                let slope = (top - bottom) / (2.0 * half_height).max(1e-9);
                let side = (top + bottom) / 2.0 + slope * q.z - q.truncate().length();
                if half_height - q.z.abs() < side / (1.0 + slope * slope).sqrt() {
                    return DVec3::Z * q.z.signum();
                }
                let out = q.truncate().normalize_or(DVec2::X);
                out.extend(-slope).normalize_or(DVec3::Z)
            }
            &SolidShape::Ellipsoid { radii } => ((p - self.center) / (radii * radii)).normalize_or(DVec3::Z),
        }
    }

    /// Distance along the ray to the first point of the solid, at most `limit`; rays that start
    /// inside a solid pass out of it unseen. `dir` is a unit vector.
    pub fn enter(&self, origin: DVec3, dir: DVec3, limit: f64) -> Option<f64> {
        let (near, far) = match &self.shape {
            SolidShape::Prism { outline, half } => prism::clip(outline, *half, origin - self.center, dir)?,
            &SolidShape::Hull { half, top, heading } => {
                let (o, r2) = (self.local(origin, heading), dir.truncate());
                let d = DVec3::new(r2.dot(heading), -r2.perp_dot(heading), dir.z);
                clip_hull(o, d, half, top)?
            }
            &SolidShape::Frustum {
                bottom,
                top,
                half_height,
            } => clip_frustum(origin - self.center, dir, bottom, top, half_height)?,
            &SolidShape::Ellipsoid { radii } => {
                let (o, d) = ((origin - self.center) / radii, dir / radii);
                roots(d.length_squared(), o.dot(d), o.length_squared() - 1.0)?
            }
        };
        if near <= 1e-6 || near > limit {
            return None;
        }
        if self.porosity <= 0.0 {
            return Some(near);
        }
        // March through the foliage until a lump stops the ray.
        let mut t = near + 1e-3;
        while t < far.min(limit) {
            if !self.is_pore(origin + dir * t) {
                return Some(t);
            }
            t += LUMP_M / 2.0;
        }
        None
    }
}

/// Roots of a t^2 + 2 b t + c.
fn roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let disc = b * b - a * c;
    if !(disc >= 0.0 && a > 1e-18) {
        return None;
    }
    let s = disc.sqrt();
    Some(((-b - s) / a, (-b + s) / a))
}

/// Clips the ray against one half space n.p <= w; false if nothing is left.
fn clip(range: &mut (f64, f64), n_dot_o: f64, n_dot_d: f64, w: f64) -> bool {
    let gap = w - n_dot_o;
    if n_dot_d.abs() < 1e-15 {
        return gap >= 0.0;
    }
    let t = gap / n_dot_d;
    if n_dot_d > 0.0 {
        range.1 = range.1.min(t);
    } else {
        range.0 = range.0.max(t);
    }
    range.0 <= range.1
}

fn clip_hull(o: DVec3, d: DVec3, half: DVec3, top: DVec2) -> Option<(f64, f64)> {
    let mut range = (f64::NEG_INFINITY, f64::INFINITY);
    if !clip(&mut range, o.z, d.z, half.z) || !clip(&mut range, -o.z, -d.z, half.z) {
        return None;
    }
    for axis in 0..2 {
        // |p| <= middle + slope * z
        let slope = (top[axis] - half[axis]) / (2.0 * half.z).max(1e-9);
        let middle = (top[axis] + half[axis]) / 2.0;
        for sign in [1.0, -1.0] {
            let (no, nd) = (sign * o[axis] - slope * o.z, sign * d[axis] - slope * d.z);
            if !clip(&mut range, no, nd, middle) {
                return None;
            }
        }
    }
    Some(range)
}

fn clip_frustum(o: DVec3, d: DVec3, bottom: f64, top: f64, half_height: f64) -> Option<(f64, f64)> {
    let mut range = (f64::NEG_INFINITY, f64::INFINITY);
    if !clip(&mut range, o.z, d.z, half_height) || !clip(&mut range, -o.z, -d.z, half_height) {
        return None;
    }
    // x^2 + y^2 <= (m + k z)^2 with z from the middle; the quadratic opens downward for a ray
    // steeper than the cone's side.
    let k = (top - bottom) / (2.0 * half_height).max(1e-9);
    let m = (top + bottom) / 2.0;
    let (o2, d2) = (o.truncate(), d.truncate());
    let a = d2.length_squared() - k * k * d.z * d.z;
    let b = o2.dot(d2) - k * d.z * (m + k * o.z);
    let c = o2.length_squared() - (m + k * o.z).powi(2);
    if a > 1e-12 {
        let (t0, t1) = roots(a, b, c)?;
        range = (range.0.max(t0), range.1.min(t1));
    } else if a < -1e-12 && b * b - a * c >= 0.0 {
        // Inside the cone means outside the roots; the solid is convex, so one side of them is left.
        let s = (b * b - a * c).sqrt();
        let (t0, t1) = ((-b + s) / a, (-b - s) / a);
        let at = |t: f64| a * t * t + 2.0 * b * t + c;
        if at(range.0) <= 0.0 {
            range.1 = if t0 > range.0 { range.1.min(t0) } else { range.1 };
        } else {
            range.0 = range.0.max(t1);
        }
    }
    (range.0 <= range.1).then_some(range)
}

#[cfg(test)]
mod tests;
