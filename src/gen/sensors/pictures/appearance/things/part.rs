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
    /// All balls between a ball at either end, whose radii run from one to the other, stretched across: middles and radii of
    /// those, and how many times wider than deep it is.
    Limb([Vec3; 2], [f32; 2], f32),
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

/// Where a ray meets a limb. A point of its side lies on the ball about `a + s (b - a)` with `s = w / (way^2 - thin^2)`,
/// `w = (p - a).(b - a) - ra thin`, where balls touch what envelops them: `(way^2 - thin^2) (|p - a|^2 - ra^2) = w^2`.
fn cast_limb([a, b]: [Vec3; 2], [ra, rb]: [f32; 2], (o, d): (Vec3, Vec3), limit: f32) -> Option<(f32, Vec3)> {
    // From the point of the ray that is nearest to an end: far away the squares of small radii would be lost.
    let near = (a - o).dot(d) / d.length_squared();
    let o = o + d * near;
    let (axis, from, thin) = (b - a, o - a, ra - rb);
    let span = axis.length_squared() - thin * thin;
    let mut best: Option<(f32, Vec3)> = None;
    let mut consider = |t: f32, normal: Vec3| {
        let t = t + near;
        if t > 1e-4 && t < limit && best.is_none_or(|b| t < b.0) {
            best = Some((t, normal));
        }
    };
    for (middle, r) in [(a, ra), (b, rb)] {
        let q = o - middle;
        if let Some((t, _)) = quadratic(d.length_squared(), q.dot(d), q.length_squared() - r * r) {
            consider(t, (q + d * t) / r);
        }
    }
    if span > 0.0 {
        let (w, step) = (from.dot(axis) - ra * thin, d.dot(axis));
        // Below 0 where the ray runs steeper than the side does.
        let square = span * d.length_squared() - step * step;
        let half = span * from.dot(d) - w * step;
        let rest = span * (from.length_squared() - ra * ra) - w * w;
        let root = (half * half - square * rest).sqrt();
        for t in [(-half - root) / square, (-half + root) / square] {
            let s = (w + step * t) / span;
            let normal = (from + d * t - axis * s) / (ra - thin * s);
            if (0.0..=1.0).contains(&s) && normal.dot(d) < 0.0 {
                consider(t, normal);
            }
        }
    }
    best
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
    /// How far it reaches along and across from the middle of the box, and up from its bottom, m; 0 for convex bodies, which lie
    /// in the box.
    pub(super) fn reach(&self) -> Vec3 {
        match self {
            ObjectPart::Convex(_) => Vec3::ZERO,
            ObjectPart::Wheel(c, r, half) | ObjectPart::Ring(c, r, half, _) => {
                c.abs() + Vec3::new(*r, *half, *r)
            }
            ObjectPart::Round(c, r) => c.abs() + *r,
            ObjectPart::Cone(foot, height, bottom, top) => {
                foot.abs() + Vec2::splat(bottom.max(*top)).extend(*height)
            }
            ObjectPart::Limb(ends, radii, wide) => {
                let reach = |i: usize| ends[i].abs() + Vec3::new(1.0, *wide, 1.0) * radii[i];
                reach(0).max(reach(1))
            }
        }
    }

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
            ObjectPart::Limb(ends, radii, wide) => {
                let narrow = Vec3::new(1.0, 1.0 / wide, 1.0);
                let hit = cast_limb(ends.map(|p| p * narrow), *radii, (o * narrow, d * narrow), limit);
                hit.map(|(t, normal)| (t, (normal * narrow).normalize_or(Vec3::Z)))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance to the nearest ball of a limb, found by trying many.
    fn distance([a, b]: [Vec3; 2], [ra, rb]: [f32; 2], p: Vec3) -> f32 {
        let balls = (0..=2000).map(|i| i as f32 / 2000.0);
        balls
            .map(|s| p.distance(a.lerp(b, s)) - (ra + (rb - ra) * s))
            .fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn rays_meet_limbs_where_their_balls_begin() {
        let limbs = [
            ([Vec3::ZERO, Vec3::new(0.1, 0.05, 0.4)], [0.06, 0.03]),
            ([Vec3::ZERO, Vec3::new(0.3, 0.0, 0.0)], [0.02, 0.12]),
            // One ball within the other; no length.
            ([Vec3::ZERO, Vec3::new(0.02, 0.0, 0.0)], [0.2, 0.05]),
            ([Vec3::ONE * 0.1; 2], [0.1, 0.1]),
        ];
        let mut met = 0;
        for (ends, radii) in limbs {
            for i in 0..600u32 {
                let angle = i as f32 * 2.4;
                let z = 1.0 - 2.0 * (i as f32 + 0.5) / 600.0;
                let flat = (1.0f32 - z * z).sqrt();
                let o = Vec3::new(angle.cos() * flat, angle.sin() * flat, z) * 2.0;
                let aim = ends[0].lerp(ends[1], (i % 7) as f32 / 6.0)
                    + Vec3::new((i % 5) as f32 - 2.0, (i % 3) as f32 - 1.0, (i % 4) as f32 - 1.5) * 0.05;
                // Some along the limb, which is steeper than its side is.
                let along = (ends[1] - ends[0]).normalize_or(Vec3::X);
                let (o, d) = match i % 10 {
                    0 => (ends[0] - along * 1.5 + Vec3::Y * 0.01, along),
                    1 => (ends[1] + along * 1.5 + Vec3::Z * 0.11, -along),
                    _ => (o, (aim - o).normalize()),
                };
                let part = ObjectPart::Limb(ends, radii, 1.0);
                let first = (0..4000)
                    .map(|k| k as f32 * 1e-3)
                    .find(|t| distance_fast(ends, radii, o + d * *t) < 0.0);
                match part.cast(o, d, 4.0) {
                    Some((t, normal)) => {
                        met += 1;
                        let off = distance(ends, radii, o + d * t);
                        assert!(off.abs() < 1e-3, "{i}: {off}");
                        assert!(
                            normal.dot(d) < 1e-3 && (normal.length() - 1.0).abs() < 1e-3,
                            "{i}: {normal}"
                        );
                        assert!(first.is_none_or(|first| first > t - 2e-3), "{i}: {t}, {first:?}");
                    }
                    None => assert!(first.is_none(), "{i} passes, {first:?}"),
                }
            }
        }
        assert!(met > 600, "{met}");
    }

    /// The same distance by trying few balls, a bit too large.
    fn distance_fast(ends: [Vec3; 2], [ra, rb]: [f32; 2], p: Vec3) -> f32 {
        let [a, b] = ends;
        let balls = (0..=60).map(|i| i as f32 / 60.0);
        balls
            .map(|s| p.distance(a.lerp(b, s)) - (ra + (rb - ra) * s))
            .fold(f32::INFINITY, f32::min)
            + 2e-4
    }

    #[test]
    fn wide_limbs_are_stretched_across() {
        let trunk = ObjectPart::Limb([Vec3::ZERO, Vec3::Z], [0.1, 0.1], 2.0);
        let (t, normal) = trunk.cast(Vec3::new(0.0, 3.0, 0.5), -Vec3::Y, 9.0).expect("hit");
        assert!(
            (t - 2.8).abs() < 1e-4 && normal.distance(Vec3::Y) < 1e-3,
            "{t} {normal}"
        );
        let (t, normal) = trunk.cast(Vec3::new(3.0, 0.1, 0.5), -Vec3::X, 9.0).expect("hit");
        // Half as far across as it reaches: cos 30 of its depth, and the normal of that ellipse.
        assert!((t - (3.0 - 0.1 * 0.75f32.sqrt())).abs() < 1e-4, "{t}");
        let ellipse = Vec3::new(0.75f32.sqrt() / 0.1, 0.5 / 0.2, 0.0).normalize();
        assert!(normal.distance(ellipse) < 1e-3, "{normal}");
        assert!(trunk.reach().distance(Vec3::new(0.1, 0.2, 1.1)) < 1e-6);
    }

    #[test]
    fn thin_limbs_far_away_are_met() {
        let stay = ObjectPart::Limb(
            [Vec3::new(0.2, 0.1, 0.3), Vec3::new(-0.3, 0.15, 0.9)],
            [0.011; 2],
            1.0,
        );
        for i in 0..400 {
            let turn = i as f32 * 0.7;
            let o = Vec3::new(turn.cos() * 50.0, turn.sin() * 50.0, 1.5 + (i % 5) as f32);
            let at = Vec3::new(0.2, 0.1, 0.3).lerp(Vec3::new(-0.3, 0.15, 0.9), (i % 9) as f32 / 8.0);
            let d = (at - o).normalize();
            let (t, _) = stay.cast(o, d, 99.0).expect("through its middle");
            assert!((t - (at - o).length()).abs() < 0.06, "{i}: {t}");
        }
    }

    #[test]
    fn limbs_of_no_size_or_number_are_passed() {
        let nothing = ObjectPart::Limb([Vec3::ZERO; 2], [0.0; 2], 1.0);
        assert!(
            nothing
                .cast(Vec3::X, -Vec3::X, 9.0)
                .is_none_or(|(t, _)| t.is_finite())
        );
        let wild = ObjectPart::Limb([Vec3::NAN, Vec3::ONE], [0.1; 2], 1.0);
        assert!(
            wild.cast(Vec3::X, -Vec3::X, 9.0)
                .is_none_or(|(t, _)| t.is_finite())
        );
    }
}
