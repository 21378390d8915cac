//! The sky as Gaussians on a dome.

use glam::{Quat, Vec3};

use crate::pictures::appearance::Appearance;
use scene::{SceneGaussian, truth};

/// How far away they are, m.
const FAR_M: f32 = 2000.0;
/// The dome begins a little below the horizon.
const LOWEST: f32 = -0.07;
/// Standard deviation over the distance between neighbours.
const WIDE: f32 = 0.8;
/// Golden angle, rad.
const GOLDEN: f32 = 2.399_963_2;

/// About `count` Gaussians evenly around `middle`, on a Fibonacci lattice.
pub(super) fn dome(appearance: &Appearance, middle: Vec3, count: usize, opacity: f32) -> Vec<SceneGaussian> {
    let area = std::f32::consts::TAU * (1.0 - LOWEST);
    let apart = (area / count.max(1) as f32).sqrt();
    let std_m = WIDE * apart * FAR_M;
    let one = |i: usize| {
        let z = 1.0 - (1.0 - LOWEST) * (i as f32 + 0.5) / count as f32;
        // In f64, since the angle turns many times.
        let around = (f64::from(GOLDEN) * i as f64).rem_euclid(std::f64::consts::TAU) as f32;
        let flat = (1.0 - z * z).max(0.0).sqrt();
        let way = Vec3::new(around.cos() * flat, around.sin() * flat, z);
        let (side, up) = way.any_orthonormal_pair();
        let near = [(0.0, 0.0), (0.3, 0.1), (-0.1, 0.3), (-0.3, -0.1), (0.1, -0.3)];
        let color = near.map(|(a, b)| {
            let way = way + (side * a + up * b) * apart;
            appearance.sky_along(way.normalize_or(Vec3::Z))
        });
        let q = Quat::from_rotation_arc(Vec3::Z, way).normalize();
        SceneGaussian {
            position_m: (middle + way * FAR_M).to_array(),
            rotation_wxyz: [q.w, q.x, q.y, q.z],
            std_m: [std_m, std_m, 1.0],
            opacity,
            color: (color.iter().sum::<Vec3>() / near.len() as f32).to_array(),
            class: truth::SKY,
            instance: 0,
            strength: 0.0,
        }
    };
    (0..count).map(one).collect()
}
