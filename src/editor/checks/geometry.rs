//! Footprints of boxes against each other: how far two overlap and the shortest way apart.

use glam::DVec2;

use scene::SceneBox;

/// Area that two footprints share, m².
pub fn shared_area_m2(a: &SceneBox, b: &SceneBox) -> f64 {
    let mut polygon: Vec<DVec2> = a.footprint().to_vec();
    let clip = b.footprint();
    // Sutherland and Hodgman 1974: cut by the four half-planes of the other footprint.
    for i in 0..4 {
        let (from, along) = (clip[i], clip[(i + 1) % 4] - clip[i]);
        let side = |p: DVec2| along.perp_dot(p - from);
        let corners = std::mem::take(&mut polygon);
        for (j, p) in corners.iter().enumerate() {
            let q = corners[(j + 1) % corners.len()];
            let (sp, sq) = (side(*p), side(q));
            if sp >= 0.0 {
                polygon.push(*p);
            }
            if (sp >= 0.0) != (sq >= 0.0) {
                polygon.push(*p + (q - *p) * (sp / (sp - sq)));
            }
        }
    }
    let corner = |i: usize| polygon[i % polygon.len()];
    let twice: f64 = (0..polygon.len())
        .map(|i| corner(i).perp_dot(corner(i + 1)))
        .sum();
    (twice / 2.0).max(0.0)
}

/// Area of a footprint, m².
pub fn area_m2(b: &SceneBox) -> f64 {
    b.size_m.x * b.size_m.y
}

/// The shortest shift of `b` on the ground after which the footprints only touch, m; zero if they are apart already
/// (separating axes).
pub fn way_out_m(a: &SceneBox, b: &SceneBox) -> DVec2 {
    let (ca, cb) = (a.footprint(), b.footprint());
    let axes = [a.heading(), a.heading().perp(), b.heading(), b.heading().perp()];
    let span = |corners: &[DVec2; 4], axis: DVec2| {
        let on = corners.map(|p| p.dot(axis));
        let low = on.into_iter().fold(f64::INFINITY, f64::min);
        (low, on.into_iter().fold(f64::NEG_INFINITY, f64::max))
    };
    let mut shortest = DVec2::splat(f64::INFINITY);
    for axis in axes {
        let ((a_low, a_high), (b_low, b_high)) = (span(&ca, axis), span(&cb, axis));
        if a_high <= b_low || b_high <= a_low {
            return DVec2::ZERO;
        }
        let (up, down) = (a_high - b_low, b_high - a_low);
        let shift = if up <= down { axis * up } else { axis * -down };
        if shift.length_squared() < shortest.length_squared() {
            shortest = shift;
        }
    }
    shortest
}

/// Height that two boxes share, m; 0 or less if one is above the other.
pub fn shared_height_m(a: &SceneBox, b: &SceneBox) -> f64 {
    let span = |b: &SceneBox| (b.center_m.z - b.size_m.z / 2.0, b.center_m.z + b.size_m.z / 2.0);
    let ((a_low, a_high), (b_low, b_high)) = (span(a), span(b));
    a_high.min(b_high) - a_low.max(b_low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use scene::{BoxId, Class};

    fn block(x: f64, y: f64, length: f64, width: f64, yaw_deg: f64) -> SceneBox {
        SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(x, y, 1.0),
            size_m: DVec3::new(length, width, 2.0),
            yaw_rad: yaw_deg.to_radians(),
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    #[test]
    fn areas_and_ways_out() {
        let a = block(0.0, 0.0, 4.0, 2.0, 0.0);
        assert!((shared_area_m2(&a, &a) - 8.0).abs() < 1e-12);
        let b = block(3.0, 0.5, 4.0, 2.0, 180.0);
        assert!((shared_area_m2(&a, &b) - 1.5).abs() < 1e-9);
        assert!(
            way_out_m(&a, &b).distance(DVec2::new(1.0, 0.0)) < 1e-9,
            "{}",
            way_out_m(&a, &b)
        );
        // A square turned by 45 degrees inside a larger one is inside.
        let diamond = block(0.2, 0.1, 1.0, 1.0, 45.0);
        assert!((shared_area_m2(&a, &diamond) - 1.0).abs() < 1e-9);
        assert!((shared_area_m2(&diamond, &a) - 1.0).abs() < 1e-9);
        let out = way_out_m(&a, &diamond);
        let moved = block(0.2 + out.x, 0.1 + out.y, 1.0, 1.0, 45.0);
        assert!(shared_area_m2(&a, &moved) < 1e-9, "{out}");
        let far = block(30.0, 0.0, 4.0, 2.0, 17.0);
        assert_eq!(
            (shared_area_m2(&a, &far), way_out_m(&a, &far)),
            (0.0, DVec2::ZERO)
        );
        assert!(
            (shared_height_m(
                &a,
                &SceneBox {
                    center_m: DVec3::new(0.0, 0.0, 2.5),
                    ..a
                }
            ) - 0.5)
                .abs()
                < 1e-12
        );
    }
}
