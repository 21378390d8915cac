//! The parts that objects are made of, and where rays meet them.

use glam::{Vec2, Vec3, Vec4};

/// A part in box coordinates: x forward, y left, z up from the bottom of the box.
#[derive(Clone, Debug)]
pub enum ObjectPart {
    /// Half spaces `n.p <= w`.
    Convex(Vec<Vec4>),
    /// A wheel: middle, radius, half width; its axis is y.
    Wheel(Vec3, f32, f32),
    /// A wheel of spokes that are too thin to see: middle, radius, half width, radius of the hole; its axis is y.
    Ring(Vec3, f32, f32, f32),
    /// An ellipsoid: middle and radii.
    Round(Vec3, Vec3),
    /// An upright cone or cylinder: foot, height, radii at the foot and at the top.
    Cone(Vec3, f32, f32, f32),
}

/// The normal of a body whose edges are rounded over `reach` m: a blend of the faces near the point.
pub(super) fn rounded(planes: &[Vec4], p: Vec3, normal: Vec3, reach: f32) -> Vec3 {
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

impl ObjectPart {
    /// Where a ray enters, nearer than `limit`, and the outward normal there.
    pub(super) fn cast(&self, o: Vec3, d: Vec3, limit: f32) -> Option<(f32, Vec3)> {
        match self {
            ObjectPart::Convex(planes) => {
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
            ObjectPart::Wheel(c, r, half) => {
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
            ObjectPart::Ring(c, r, half, hole) => {
                let o = o - *c;
                let mut best: Option<(f32, Vec3)> = None;
                let mut consider = |t: f32, normal: Vec3| {
                    if t > 1e-4 && t < limit && best.is_none_or(|b| t < b.0) {
                        best = Some((t, normal));
                    }
                };
                if d.y.abs() > 1e-6 {
                    let t = (-half * d.y.signum() - o.y) / d.y;
                    let away = Vec2::new(o.x + d.x * t, o.z + d.z * t).length();
                    if (*hole..=*r).contains(&away) {
                        consider(t, -Vec3::Y * d.y.signum());
                    }
                }
                // The tyre from outside, and from inside through the hole.
                for (radius, side) in [(*r, 1.0), (*hole, -1.0)] {
                    let (a, b) = (d.x * d.x + d.z * d.z, o.x * d.x + o.z * d.z);
                    let c = o.x * o.x + o.z * o.z - radius * radius;
                    if let Some((t0, t1)) = quadratic(a, b, c) {
                        let t = if side > 0.0 { t0 } else { t1 };
                        if (o.y + d.y * t).abs() <= *half {
                            consider(t, Vec3::new(o.x + d.x * t, 0.0, o.z + d.z * t) * (side / radius));
                        }
                    }
                }
                best
            }
            ObjectPart::Round(c, r) => {
                let (p, q) = ((o - *c) / *r, d / *r);
                let (t, _) = quadratic(q.length_squared(), p.dot(q), p.length_squared() - 1.0)?;
                let normal = ((p + q * t) / *r).normalize_or(Vec3::Z);
                (t > 1e-4 && t < limit).then_some((t, normal))
            }
            ObjectPart::Cone(foot, height, bottom, top) => {
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
