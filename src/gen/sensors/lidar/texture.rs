//! Echo strengths that vary as those of real sensors do. The network gives the usual strength of a class at a place,
//! without paint, sheet metal, plates and reflectors, which no voxel shows.

use glam::DVec3;

use crate::lidar::material::{DIFFUSE_MOST, gaussian as bell};
use scene::Class;
use world::draw::{Draw, hash};

/// Edge of a patch of one material, m.
const PATCH_M: f64 = 0.3;
const SEED: u64 = 0x7e87_0e5e;

/// Variation of a class: spread of patches and of single echoes, in logarithms; share of retro-reflective patches, and
/// their strength.
struct Uneven {
    patches: f64,
    echoes: f64,
    retro: f64,
    retro_strength: f64,
}

fn of(class: Class) -> Uneven {
    let uneven = |patches, echoes, retro, retro_strength| Uneven {
        patches,
        echoes,
        retro,
        retro_strength,
    };
    match class {
        Class::DriveableSurface => uneven(0.6, 0.5, 0.0, 0.0),
        Class::Sidewalk | Class::OtherFlat | Class::Terrain => uneven(0.5, 0.45, 0.0, 0.0),
        Class::Vegetation => uneven(0.35, 0.5, 0.0, 0.0),
        Class::Manmade => uneven(0.85, 0.4, 0.02, 100.0),
        Class::Car => uneven(0.7, 0.5, 0.012, 105.0),
        Class::Truck | Class::Bus | Class::Trailer | Class::ConstructionVehicle => {
            uneven(0.4, 0.4, 0.03, 110.0)
        }
        Class::Pedestrian => uneven(0.5, 0.5, 0.02, 105.0),
        Class::TrafficCone => uneven(0.4, 0.6, 0.25, 170.0),
        Class::Barrier => uneven(0.4, 0.4, 0.05, 110.0),
        Class::Motorcycle | Class::Bicycle => uneven(0.5, 0.5, 0.03, 110.0),
        Class::Others | Class::Free => uneven(0.5, 0.4, 0.0, 0.0),
    }
}

/// The strength of one echo, 0 to 255, where `usual` is expected. The same for the same place and ray; another place has
/// another patch. NaN is 0.
pub fn textured(usual: f32, class: Class, at: DVec3, ray: u64) -> f32 {
    let kind = of(class);
    // Casts saturate: any place has a patch.
    let q = (at / PATCH_M).floor();
    let key = hash(q.x as i64 as u64 ^ hash(q.y as i64 as u64 ^ hash(q.z as i64 as u64 ^ SEED)));
    let mut patch = Draw::new(key, "patch");
    let (tone, is_retro) = (bell(&mut patch), patch.chance(kind.retro));
    let echo = bell(&mut Draw::new(hash(ray ^ SEED), "echo"));
    let bright = match is_retro {
        true => kind.retro_strength * (0.35 * echo).exp(),
        false => (f64::from(usual) * (kind.patches * tone + kind.echoes * echo).exp()).min(DIFFUSE_MOST),
    };
    // Sensors report whole numbers.
    if bright.is_nan() {
        0.0
    } else {
        bright.round().clamp(0.0, 255.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_keep_their_middle_and_gain_a_tail() {
        for class in Class::ALL {
            let mut found: Vec<f32> = (0..20_000u64)
                .map(|i| textured(12.0, class, DVec3::new(i as f64 * 0.7, 0.0, 1.0), i))
                .collect();
            found.sort_by(f32::total_cmp);
            let (p50, p99) = (found[10_000], found[19_800]);
            let usual = if class == Class::TrafficCone {
                6.0..40.0
            } else {
                10.0..14.5
            };
            assert!(usual.contains(&p50) && p99 > 2.0 * p50, "{class:?}: {p50} {p99}");
            assert!(found.iter().all(|v| (0.0..=255.0).contains(v)));
        }
        let at = DVec3::new(3.0, 4.0, 1.0);
        assert_eq!(textured(9.0, Class::Car, at, 5), textured(9.0, Class::Car, at, 5));
        for bad in [f32::NAN, f32::INFINITY, -1e30] {
            let found = textured(bad, Class::Car, DVec3::splat(f64::NAN), u64::MAX);
            assert!((0.0..=255.0).contains(&found));
        }
    }
}
