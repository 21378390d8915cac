//! How people stand and walk: joints of a person, as shares of the height; x forward, y left, z up from the ground.

use std::f32::consts::PI;

use glam::Vec3;

use crate::pictures::appearance::noise::{hash1, unit};

/// How a person or a two-wheeler moves at the moment.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gait {
    /// Distance covered so far, m.
    pub covered_m: f32,
    /// Speed along its heading, m/s.
    pub speed_mps: f32,
    /// True if it moves now, or at another moment of its clip.
    pub moves: bool,
}

/// Length of the thigh, and of the shank down to the ankle.
pub(super) const LEG: f32 = 0.245;
/// Height of the ankle above the ground.
pub(super) const ANKLE: f32 = 0.042;
/// Length of the upper arm, and of the forearm down to the wrist.
pub(super) const ARM: [f32; 2] = [0.17, 0.145];
/// Half the distance of the hips, and of the shoulders.
pub(super) const HALF_HIPS: f32 = 0.05;
pub(super) const HALF_SHOULDERS: f32 = 0.104;
/// Length of the torso from hips to shoulders.
pub(super) const TORSO: f32 = 0.285;
/// From the shoulders to the top of the head.
pub(super) const NECK_AND_HEAD: f32 = 0.185;
/// Share of a stride during which a foot is on the ground.
const ON_GROUND: f32 = 0.6;
/// Lengths of a stride: shortest, longest; its distance may reach this far beyond the box in front and behind, m.
const STRIDES: [f32; 2] = [0.35, 0.82];
const BEYOND_BOX_M: f32 = 0.12;
/// Speed from which somebody walks with whole strides, m/s.
const WALKING_MPS: f32 = 0.6;

/// Joints of a person; of pairs the left one is first.
pub(super) struct Joints {
    pub hips: Vec3,
    pub shoulders: Vec3,
    pub ankles: [Vec3; 2],
    pub toes: [Vec3; 2],
    pub wrists: [Vec3; 2],
    /// Where elbows point.
    pub elbows_to: Vec3,
}

/// Length of a stride for a height and the length of the box, as a share of the height.
fn stride(height_m: f32, length_m: f32) -> f32 {
    let reach_m = length_m / 2.0 + BEYOND_BOX_M - 0.08 * height_m;
    (reach_m / (ON_GROUND / 2.0) / height_m).clamp(STRIDES[0], STRIDES[1])
}

/// Place of an ankle against the hips at a share of its stride, which begins when the heel meets the ground.
fn step(share: f32, stride: f32) -> (f32, f32) {
    let half = stride * ON_GROUND / 2.0;
    if share < ON_GROUND {
        (half - stride * share, ANKLE)
    } else {
        let swing = (share - ON_GROUND) / (1.0 - ON_GROUND);
        (-half * (PI * swing).cos(), ANKLE + 0.075 * (PI * swing).sin())
    }
}

/// A walking person, the closer to standing the slower; feet that stand on the ground do not slide.
pub(super) fn on_foot(id: u32, height_m: f32, length_m: f32, gait: Gait) -> Joints {
    let amount = (gait.speed_mps / WALKING_MPS).clamp(0.0, 1.0);
    let stride = stride(height_m, length_m);
    let begin = unit(hash1(id, 5));
    let phase = gait.covered_m / (stride * height_m) + begin;
    let feet = [phase, phase + 0.5].map(|p| step(p.rem_euclid(1.0), stride));
    let reach = 2.0 * LEG * 0.995;
    // The hips are as high as the straighter leg on the ground allows; heels rise before they would be low.
    let high = |(x, z): (f32, f32)| {
        if z > ANKLE {
            1.0
        } else {
            ANKLE + (reach * reach - x * x).sqrt()
        }
    };
    let lowest = high(feet[0]).min(high(feet[1]));
    let top = ANKLE + reach;
    let hips = Vec3::Z * (top - amount * 0.45 * (top - lowest).max(0.0));
    let mut ankles = [Vec3::ZERO; 2];
    let mut toes = ankles;
    let mut wrists = ankles;
    let shoulders = hips + Vec3::new(0.015 * amount, 0.0, TORSO);
    for (i, side) in [1.0, -1.0].into_iter().enumerate() {
        let (x, z) = feet[i];
        let stands = Vec3::new(0.012 * side * (begin - 0.5), side * (HALF_HIPS + 0.012), ANKLE);
        let walks = Vec3::new(x, side * HALF_HIPS, z);
        let from = hips + Vec3::Y * side * HALF_HIPS;
        let ankle = stands.lerp(walks, amount);
        // Heels rise where the leg is too short.
        let x = ankle.x.clamp(-reach, reach);
        ankles[i] = Vec3::new(x, ankle.y, ankle.z.max(from.z - (reach * reach - x * x).sqrt()));
        let toe_z = 0.016 + 0.6 * (z - ANKLE) * amount;
        toes[i] = Vec3::new(ankles[i].x + 0.095, ankles[i].y * 1.1, toe_z);
        // Arms swing against the leg of their side.
        let swing = -(x / (stride * ON_GROUND / 2.0)).clamp(-1.0, 1.0) * 0.42 * amount;
        let bend = 0.16 + 0.3 * amount + 0.25 * swing.max(0.0);
        let shoulder = shoulders + Vec3::Y * side * HALF_SHOULDERS;
        let down = |angle: f32, length: f32| Vec3::new(angle.sin(), 0.0, -angle.cos()) * length;
        wrists[i] = shoulder + down(swing, ARM[0]) + down(swing + bend, ARM[1]) + Vec3::Y * side * 0.022;
    }
    // Some who stand look at something in their hand.
    if begin < 0.3 {
        let looks = shoulders + Vec3::new(0.15, 0.04, -0.13);
        wrists[0] = looks.lerp(wrists[0], (3.0 * amount).min(1.0));
    }
    Joints {
        hips,
        shoulders,
        ankles,
        toes,
        wrists,
        elbows_to: Vec3::new(-1.0, 0.0, -0.3),
    }
}

/// The joint between two limbs of these lengths from `a` to `b`, bent towards a side.
pub(super) fn bent([a, b]: [Vec3; 2], [first, second]: [f32; 2], to: Vec3) -> Vec3 {
    let way = b - a;
    let far = way.length().clamp(1e-4, first + second);
    let along = ((far * far + first * first - second * second) / (2.0 * far)).clamp(-first, first);
    let axis = way.normalize_or(Vec3::NEG_Z);
    let aside = (to - axis * to.dot(axis)).normalize_or(Vec3::X);
    a + axis * along + aside * (first * first - along * along).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feet of a walker at a distance covered, m: ankles over the ground, in the frame of the ground.
    fn ankles(covered_m: f32) -> [Vec3; 2] {
        let gait = Gait {
            covered_m,
            speed_mps: 1.4,
            moves: true,
        };
        on_foot(7, 1.75, 0.73, gait)
            .ankles
            .map(|a| a * 1.75 + Vec3::X * covered_m)
    }

    #[test]
    fn a_foot_on_the_ground_stays_where_it_is() {
        let mut walked = [0.0f32; 2];
        for i in 0..400 {
            let (now, next) = (ankles(i as f32 * 0.01), ankles((i + 1) as f32 * 0.01));
            let way = [0, 1].map(|side| next[side].x - now[side].x);
            let rests = |side: usize| way[side].abs() < 1e-4 && now[side].z < ANKLE * 1.75 + 0.05;
            assert!(rests(0) || rests(1), "slides or flies at {i}: {now:?}, {next:?}");
            walked = [0, 1].map(|side| walked[side] + way[side]);
        }
        // Both feet went as far as the walker.
        assert!(walked.iter().all(|w| (w - 4.0).abs() < 0.8), "{walked:?}");
    }

    #[test]
    fn whoever_stands_stands_on_both_feet() {
        let joints = on_foot(3, 1.75, 0.73, Gait::default());
        assert!(
            joints.ankles.iter().all(|a| (a.z - ANKLE).abs() < 2e-3),
            "{:?}",
            joints.ankles
        );
        let top = joints.shoulders.z + NECK_AND_HEAD;
        assert!((0.99..1.03).contains(&top), "{top}");
    }

    #[test]
    fn limbs_keep_their_lengths_and_bend_to_their_side() {
        let [a, b] = [Vec3::Z, Vec3::new(0.1, 0.0, 0.7)];
        let knee = bent([a, b], [0.2, 0.2], Vec3::X);
        assert!((knee.distance(a) - 0.2).abs() < 1e-5 && (knee.distance(b) - 0.2).abs() < 1e-5);
        assert!(knee.x > 0.05);
        // Too far, at the same place, and no side: finite.
        for b in [Vec3::splat(9.0), a, Vec3::Z * 0.5] {
            assert!(bent([a, b], [0.2, 0.2], Vec3::ZERO).is_finite());
        }
    }
}
