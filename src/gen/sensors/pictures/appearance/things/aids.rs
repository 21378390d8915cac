//! What people sit in or push: wheelchairs and prams. Lengths in m, from the middle of the box.

use glam::Vec3;

use super::build::ObjectBuilder;
use super::gait::{Joints, NECK_AND_HEAD, TORSO};
use super::person::{Looks, body};
use super::{ObjectPart, PartMaterial, rgb};

/// A pram whose handle is at `handle` m, up to the front of the box.
pub(super) fn pram(b: &mut ObjectBuilder, handle: f32) {
    let front = 0.5 * b.s.x;
    let (dark, hood) = (PartMaterial::Dark, PartMaterial::Cloth(rgb(56, 66, 92)));
    let middle = front - 0.42;
    for (x, r) in [(front - 0.13, 0.12), (front - 0.62, 0.14)] {
        for side in [1.0, -1.0] {
            let wheel = ObjectPart::Wheel(Vec3::new(x, side * 0.26, r), r, 0.02);
            b.parts.push((wheel, dark));
        }
    }
    for side in [0.24, -0.24] {
        let from = Vec3::new(front - 0.13, side, 0.14);
        b.limb([from, Vec3::new(handle, side * 0.9, 0.98)], [0.013; 2], dark);
        b.limb(
            [Vec3::new(front - 0.62, side, 0.16), Vec3::new(middle, side, 0.55)],
            [0.012; 2],
            dark,
        );
    }
    b.limb(
        [Vec3::new(handle, 0.23, 0.98), Vec3::new(handle, -0.23, 0.98)],
        [0.016; 2],
        dark,
    );
    b.limb(
        [
            Vec3::new(middle - 0.2, 0.0, 0.6),
            Vec3::new(middle + 0.22, 0.0, 0.6),
        ],
        [0.19, 0.17],
        hood,
    );
    b.limb(
        [
            Vec3::new(middle - 0.14, 0.1, 0.74),
            Vec3::new(middle - 0.14, -0.1, 0.74),
        ],
        [0.17; 2],
        hood,
    );
}

/// Somebody in a wheelchair as long as the box.
pub(super) fn wheelchair(b: &mut ObjectBuilder, id: u32, looks: &Looks) {
    let s = b.s;
    let half = (s.y / 2.0 - 0.03).clamp(0.15, 0.32);
    let hub = Vec3::new(-0.5 * s.x + 0.36, 0.0, 0.3);
    for side in [half, -half] {
        b.parts.push((
            ObjectPart::Ring(hub + Vec3::Y * side, 0.3, 0.018, 0.265),
            PartMaterial::Wheel,
        ));
        b.parts.push((
            ObjectPart::Wheel(hub + Vec3::Y * side, 0.035, 0.04),
            PartMaterial::Dark,
        ));
        let caster = Vec3::new(hub.x + 0.42, side * 0.8, 0.09);
        b.parts
            .push((ObjectPart::Wheel(caster, 0.09, 0.018), PartMaterial::Dark));
        let frame = [
            Vec3::new(hub.x - 0.12, side * 0.85, 0.92),
            Vec3::new(hub.x - 0.06, side * 0.85, 0.46),
        ];
        b.limb(frame, [0.014; 2], PartMaterial::Dark);
        b.limb(
            [frame[1], Vec3::new(hub.x + 0.4, side * 0.8, 0.44)],
            [0.014; 2],
            PartMaterial::Dark,
        );
        b.limb(
            [Vec3::new(hub.x + 0.4, side * 0.8, 0.44), caster],
            [0.013; 2],
            PartMaterial::Dark,
        );
    }
    let seat = PartMaterial::Cloth(rgb(34, 36, 44));
    for [from, to] in [
        [Vec3::new(-0.08, 0.0, 0.47), Vec3::new(0.34, 0.0, 0.47)],
        [Vec3::new(-0.1, 0.0, 0.5), Vec3::new(-0.14, 0.0, 0.88)],
    ] {
        for side in [0.5, -0.5] {
            let aside = Vec3::new(hub.x, side * half, 0.0);
            b.limb([from + aside, to + aside], [0.04; 2], seat);
        }
    }
    // As tall as a person whose head is at the height of the box.
    let height_m = ((s.z - 0.54) / (TORSO + NECK_AND_HEAD)).clamp(0.9, 1.9);
    let hips = Vec3::new(hub.x, 0.0, 0.55) / height_m;
    let shoulders = hips + Vec3::new(-0.03, 0.0, TORSO);
    let foot = |side: f32| Vec3::new((hub.x + 0.56) / height_m, side * 0.06, 0.19 / height_m);
    let ankles = [foot(1.0), foot(-1.0)];
    let rim = |side: f32| Vec3::new(hub.x + 0.08, side * half, 0.62) / height_m;
    let joints = Joints {
        hips,
        shoulders,
        ankles,
        toes: ankles.map(|a| a + Vec3::new(0.09, 0.0, -0.015)),
        wrists: [rim(1.0), rim(-1.0)],
        elbows_to: Vec3::new(-1.0, 0.0, 0.2),
    };
    body(b, Vec3::ZERO, height_m, id, &joints, looks);
}
