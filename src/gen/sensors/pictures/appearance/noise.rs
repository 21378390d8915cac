//! Hashes and smooth noise of world positions: the same place looks the same from every camera.

use glam::{IVec3, Vec2, Vec3};

/// A hash of a lattice point (the finaliser of MurmurHash3 over mixed coordinates).
#[inline]
pub fn hash3(p: IVec3, seed: u32) -> u32 {
    let mut h = (p.x as u32).wrapping_mul(0x8da6_b343)
        ^ (p.y as u32).wrapping_mul(0xd816_3841)
        ^ (p.z as u32).wrapping_mul(0xcb1a_b31f)
        ^ seed.wrapping_mul(0x9e37_79b9);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}

/// A hash of one number.
#[inline]
pub fn hash1(v: u32, seed: u32) -> u32 {
    hash3(IVec3::new(v as i32, 17, 59), seed)
}

/// The upper bits of a hash as a number in 0..1.
#[inline]
pub fn unit(h: u32) -> f32 {
    (h >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A number in 0..1 for a lattice point.
#[inline]
pub fn unit3(p: IVec3, seed: u32) -> f32 {
    unit(hash3(p, seed))
}

/// Rounds down; inline where the target's own instruction is not assumed. For values an i32 holds.
#[inline(always)]
pub fn floor(v: f32) -> f32 {
    let whole = v as i32 as f32;
    if whole > v { whole - 1.0 } else { whole }
}

#[inline]
fn smooth(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// Smooth noise in 0..1 with features of about one unit.
#[inline]
pub fn value3(p: Vec3, seed: u32) -> f32 {
    let cell = p.map(floor);
    let f = p - cell;
    let (u, v, w) = (smooth(f.x), smooth(f.y), smooth(f.z));
    let c = cell.as_ivec3();
    let at = |x, y, z| unit3(c + IVec3::new(x, y, z), seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let low = mix(
        mix(at(0, 0, 0), at(1, 0, 0), u),
        mix(at(0, 1, 0), at(1, 1, 0), u),
        v,
    );
    let high = mix(
        mix(at(0, 0, 1), at(1, 0, 1), u),
        mix(at(0, 1, 1), at(1, 1, 1), u),
        v,
    );
    mix(low, high, w)
}

/// Smooth noise in the plane, as [`value3`] is in space.
#[inline]
pub fn value2(p: Vec2, seed: u32) -> f32 {
    let cell = p.map(floor);
    let f = p - cell;
    let (u, v) = (smooth(f.x), smooth(f.y));
    let c = cell.as_ivec2();
    let at = |x, y| unit3(IVec3::new(c.x + x, c.y + y, 7), seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(at(0, 0), at(1, 0), u), mix(at(0, 1), at(1, 1), u), v)
}

/// Octaves of [`value2`], each half as large and half as strong; 0..1.
pub fn fbm2(mut p: Vec2, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for i in 0..octaves {
        sum += weight * value2(p, seed.wrapping_add(i));
        total += weight;
        weight *= 0.5;
        // Turned a little, so that the lattices do not line up.
        p = Vec2::new(p.x * 1.6 - p.y * 1.2, p.x * 1.2 + p.y * 1.6) + 3.7;
    }
    sum / f32::max(total, 1e-6)
}

/// 0 below `from`, 1 above `to`, smooth between.
#[inline]
pub fn ramp(from: f32, to: f32, v: f32) -> f32 {
    smooth(((v - from) / (to - from)).clamp(0.0, 1.0))
}
