//! Tests of the solids: rays enter where the inside begins, normals point outward.

use super::*;
use crate::draw::Draw;

/// A prism over an outline that is not convex.
fn l_shape(base: DVec3) -> Solid {
    let corner = |x: f64, y: f64| base.truncate() + DVec2::new(x, y);
    let outline = [
        corner(-2.0, -2.0),
        corner(2.0, -2.0),
        corner(2.0, 0.0),
        corner(0.0, 0.0),
        corner(0.0, 2.0),
        corner(-2.0, 2.0),
    ];
    Solid::prism(Class::Manmade, &outline, base.z, base.z + 1.6)
}

/// Where a ray enters must agree with the inside test sampled along the ray.
#[test]
fn rays_enter_where_the_inside_begins() {
    let heading = DVec2::from_angle(0.6);
    let base = DVec3::new(1.0, 2.0, 0.2);
    let solids = [
        Solid::block(Class::Car, base, DVec3::new(4.0, 2.0, 1.5), heading),
        Solid::tapered(
            Class::Car,
            base,
            DVec3::new(4.0, 2.0, 1.5),
            DVec2::new(0.5, 0.8),
            heading,
        ),
        Solid::frustum(Class::TrafficCone, base, 1.5, 0.8, 0.1),
        Solid::frustum(Class::Manmade, base, 3.0, 0.4, 0.4),
        Solid::ellipsoid(Class::Vegetation, base, DVec3::new(2.0, 1.0, 1.5), 0.0),
        l_shape(base),
    ];
    let mut draw = Draw::new(3, "rays");
    let (mut hits, mut under) = (0, 0);
    for solid in solids {
        for _ in 0..2000 {
            let origin = DVec3::new(
                draw.range(-9.0, 9.0),
                draw.range(-9.0, 9.0),
                draw.range(-1.0, 5.0),
            );
            let aim = solid.center
                + DVec3::new(
                    draw.range(-2.0, 2.0),
                    draw.range(-2.0, 2.0),
                    draw.range(-1.0, 1.0),
                );
            let dir = (aim - origin).normalize_or(DVec3::X);
            if solid.contains(origin) {
                continue;
            }
            let marched = (0..20_000)
                .map(|i| f64::from(i) * 1e-3)
                .find(|t| solid.contains(origin + dir * *t));
            match (solid.enter(origin, dir, 20.0), marched) {
                (Some(t), Some(m)) => {
                    hits += 1;
                    assert!((t - m).abs() < 3e-3, "{solid:?} {t} {m}");
                    let (p, n) = (origin + dir * t, solid.normal(origin + dir * t));
                    assert!(
                        (n.length() - 1.0).abs() < 1e-9 && n.dot(dir) < 1e-6,
                        "{solid:?} {n}"
                    );
                    assert!(!solid.contains(p + n * 1e-3), "{solid:?} {n}");
                    under += usize::from(solid.contains(p - n * 2e-3));
                }
                (None, None) => {}
                // A graze shorter than the march's step.
                (Some(t), None) => assert!(!solid.contains(origin + dir * (t + 2e-3))),
                (None, Some(m)) => panic!("{solid:?} missed at {m}"),
            }
        }
    }
    assert!(hits > 2000, "{hits} hits");
    // Below the surface is inside, but for points right at an edge.
    assert!(under * 100 > hits * 97, "{under} of {hits}");
}

/// Towards the normal lies the outside, against it the inside.
#[test]
fn normals_point_outward() {
    let heading = DVec2::from_angle(-1.1);
    let base = DVec3::new(-3.0, 1.0, 0.1);
    let solids = [
        Solid::tapered(
            Class::Car,
            base,
            DVec3::new(4.0, 2.0, 1.5),
            DVec2::new(0.5, 0.8),
            heading,
        ),
        Solid::frustum(Class::TrafficCone, base, 1.5, 0.8, 0.1),
        Solid::ellipsoid(Class::Vegetation, base, DVec3::new(2.0, 1.0, 1.5), 0.0),
        l_shape(base),
    ];
    let mut draw = Draw::new(4, "normals");
    let mut hits = 0;
    for solid in solids {
        for _ in 0..500 {
            let from = base
                + DVec3::new(
                    draw.range(-8.0, 8.0),
                    draw.range(-8.0, 8.0),
                    draw.range(-2.0, 5.0),
                );
            let aim = base + DVec3::new(draw.range(-1.0, 1.0), draw.range(-1.0, 1.0), draw.range(0.0, 1.0));
            let dir = (aim - from).normalize_or(DVec3::X);
            if solid.contains(from) {
                continue;
            }
            if let Some(t) = solid.enter(from, dir, 30.0) {
                let p = from + dir * t;
                let n = solid.normal_at(p);
                hits += 1;
                assert!(
                    (n.length() - 1.0).abs() < 1e-9 && n.dot(dir) < 1e-6,
                    "{solid:?} {n} {dir}"
                );
                assert!(!solid.contains(p + n * 1e-3), "{solid:?} at {p}");
                assert!(solid.contains(p - n * 1e-3 + dir * 1e-6) || n.dot(dir) > -0.02);
            }
        }
    }
    assert!(hits > 500, "{hits}");
}
