//! Upright prisms over a simple outline: inside test, ray, normal. Points are relative to the middle.

use glam::{DVec2, DVec3};

use crate::road_map::inside;

fn edges(outline: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..outline.len()).map(|i| (outline[i], outline[(i + 1) % outline.len()]))
}

/// Distances at which the ray first enters the prism ahead of its origin and at which it leaves it after that.
pub(super) fn clip(outline: &[DVec2], half: DVec3, o: DVec3, d: DVec3) -> Option<(f64, f64)> {
    const AHEAD: f64 = 1e-6;
    // The slab between bottom and top.
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if d[axis].abs() < 1e-15 {
            if o[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let (t0, t1) = (
            (-half[axis] - o[axis]) / d[axis],
            (half[axis] - o[axis]) / d[axis],
        );
        (low, high) = (low.max(t0.min(t1)), high.min(t0.max(t1)));
        if low > high {
            return None;
        }
    }
    let (o2, d2) = (o.truncate(), d.truncate());
    let (mut near, mut far) = (f64::INFINITY, high);
    let consider = |t: f64, near: &mut f64| {
        if t > AHEAD && t < *near {
            *near = t;
        }
    };
    for (a, b) in edges(outline) {
        let e = b - a;
        let cross = d2.perp_dot(e);
        // Counter-clockwise: a ray enters where it runs against the outward normal (e.y, -e.x).
        if cross >= -1e-15 {
            continue;
        }
        let t = (a - o2).perp_dot(e) / cross;
        let u = (a - o2).perp_dot(d2) / cross;
        if (0.0..=1.0).contains(&u) && (o.z + d.z * t).abs() <= half.z {
            consider(t, &mut near);
        }
    }
    if d.z.abs() > 1e-15 {
        let t = (-half.z * d.z.signum() - o.z) / d.z;
        if inside(outline, o2 + d2 * t) {
            consider(t, &mut near);
        }
    }
    if !near.is_finite() {
        return None;
    }
    for (a, b) in edges(outline) {
        let e = b - a;
        let cross = d2.perp_dot(e);
        if cross > 1e-15 {
            let t = (a - o2).perp_dot(e) / cross;
            let u = (a - o2).perp_dot(d2) / cross;
            if (0.0..=1.0).contains(&u) && t > near {
                far = far.min(t);
            }
        }
    }
    Some((near, far))
}

/// Outward unit normal of the face nearest to a point on the surface.
pub(super) fn normal_at(outline: &[DVec2], half: DVec3, q: DVec3) -> DVec3 {
    let mut best = ((half.z - q.z.abs()).abs(), DVec3::Z * q.z.signum());
    for (a, b) in edges(outline) {
        let e = b - a;
        let length = e.length();
        if length < 1e-9 {
            continue;
        }
        let t = ((q.truncate() - a).dot(e) / (length * length)).clamp(0.0, 1.0);
        let gap = q.truncate().distance(a + e * t);
        if gap < best.0 {
            best = (gap, DVec3::new(e.y, -e.x, 0.0) / length);
        }
    }
    best.1
}
