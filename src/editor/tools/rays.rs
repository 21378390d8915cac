//! Rays near axes and through planes: the distances by which a pointer pulls along them.

use glam::DVec3;

use crate::pick::PickRay;

use scene::Extent;

use super::farthest_m;

/// Rays this near to parallel with an axis say nothing about it.
const PARALLEL: f64 = 1e-6;

/// Place along a line through `point` at which the ray comes nearest, m; `None` for a ray that runs along it.
pub(super) fn along_axis(ray: &PickRay, point_m: DVec3, axis: DVec3) -> Option<f64> {
    let (d, w) = (ray.direction_in_ego, point_m - ray.origin_in_ego);
    let b = axis.dot(d);
    let denominator = 1.0 - b * b;
    (denominator > PARALLEL).then(|| (b * d.dot(w) - axis.dot(w)) / denominator)
}

/// The place where a ray meets the plane through a point across an axis of the grid.
pub(super) fn on_plane(extent: Extent, ray: &PickRay, point_m: DVec3, axis: usize) -> Option<DVec3> {
    let d = ray.direction_in_ego[axis];
    if d.abs() < PARALLEL {
        return None;
    }
    let t = (point_m[axis] - ray.origin_in_ego[axis]) / d;
    // The limit is on the place, not on the distance along the ray: the rays of an orthographic view begin far away.
    let p = ray.at(t);
    (t >= 0.0 && p.abs().max_element() < farthest_m(extent)).then_some(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_axes_and_planes() {
        let ray = PickRay::new(DVec3::new(0.0, -10.0, 2.0), DVec3::Y).expect("a direction");
        let at = along_axis(&ray, DVec3::new(-3.0, 0.0, 2.0), DVec3::X).expect("crosses");
        assert!((at - 3.0).abs() < 1e-12);
        let up = along_axis(&ray, DVec3::new(1.0, 5.0, 0.0), DVec3::Z).expect("passes by");
        assert!((up - 2.0).abs() < 1e-12);
        assert_eq!(along_axis(&ray, DVec3::ZERO, DVec3::Y), None);
        assert_eq!(
            on_plane(Extent::WINDOW, &ray, DVec3::new(0.0, 4.0, 0.0), 1),
            Some(DVec3::new(0.0, 4.0, 2.0))
        );
        assert_eq!(on_plane(Extent::WINDOW, &ray, DVec3::ZERO, 2), None);
        assert_eq!(
            on_plane(Extent::WINDOW, &ray, DVec3::new(0.0, -20.0, 0.0), 1),
            None
        );
    }
}
