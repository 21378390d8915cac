//! Bicycles and motorcycles, with riders whose feet pedal as far as they ride. Lengths in m, from the middle of the box.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;

use super::build::ObjectBuilder;
use super::gait::{Gait, Joints, NECK_AND_HEAD, TORSO};
use super::person::{Looks, body};
use super::{ObjectPart, PartMaterial, rgb};
use crate::pictures::appearance::noise::{hash1, unit};

/// Height of a bicycle's saddle and of its bars, and of a grown person, m; smaller ones are as their boxes are.
const SADDLE_M: f32 = 0.94;
const BARS_M: f32 = 1.03;
const GROWN_M: f32 = 1.74;
/// Height over ground of the middle of the cranks, their length, and the way of a bicycle during one of their turns, m.
const CRANKS_M: [f32; 2] = [0.28, 0.165];
const GEAR_M: f32 = 4.6;
/// Height of a motorcycle's seat, m.
const SEAT_M: f32 = 0.8;
/// Cosines of the lean of a rider: farthest forward, upright.
const LEANS: [f32; 2] = [0.55, 0.98];
/// Below this height of the box, as a share of the vehicle's own, there is no room for a rider.
const RIDERLESS: f32 = 1.2;

/// Adds a bicycle; someone rides it if the box is high enough.
pub(super) fn bicycle(b: &mut ObjectBuilder, id: u32, name: &str, gait: Gait) {
    let s = b.s;
    // Those between a bicycle's and a rider's height are with a rider or without, by their number.
    let ridden = s.z > 1.45 || (s.z > RIDERLESS && (gait.moves || unit(hash1(id, 3)) < 0.7));
    let with_rider = SADDLE_M + GROWN_M * (0.6 * TORSO + NECK_AND_HEAD);
    let scale = match ridden {
        true => (s.z / with_rider).min(1.0),
        false => (s.z / (BARS_M + 0.03)).min(1.1),
    };
    let frame = Frame::new(s, scale);
    frame.draw(b, id);
    let angle = crank_angle(gait.covered_m / scale, GEAR_M, unit(hash1(id, 5)));
    let pedals = [0.0, std::f32::consts::PI].map(|turn| {
        let (sin, cos) = (angle + turn).sin_cos();
        frame.cranks + Vec3::new(cos, 0.0, sin) * CRANKS_M[1] * scale
    });
    for (pedal, side) in pedals.into_iter().zip([1.0, -1.0]) {
        let aside = Vec3::Y * side * 0.07 * scale;
        b.limb(
            [frame.cranks + aside, pedal + aside],
            [0.011; 2],
            PartMaterial::Dark,
        );
        let out = Vec3::Y * side * 0.1 * scale;
        b.limb(
            [pedal + aside, pedal + aside + out],
            [0.016; 2],
            PartMaterial::Dark,
        );
    }
    if ridden {
        let height_m = GROWN_M * scale;
        let seat = frame.saddle + Vec3::Z * 0.055 * scale;
        let side = |i: usize| Vec3::Y * (if i == 0 { 0.1 } else { -0.1 }) * scale;
        let ankles = [0, 1].map(|i| pedals[i] + side(i) + Vec3::new(-0.06, 0.0, 0.085) * scale);
        let toes = [0, 1].map(|i| pedals[i] + side(i) + Vec3::new(0.09, 0.0, 0.035) * scale);
        let wrists = [0.24, -0.24].map(|y| frame.bars + Vec3::new(-0.05, y, 0.03) * scale);
        let mut looks = Looks::new(id, name);
        if unit(hash1(id, 11)) < 0.55 {
            let colors = [[226, 226, 222], [30, 32, 36], [180, 40, 36], [44, 84, 150]];
            let [r, g, b] = colors[hash1(id, 12) as usize % colors.len()];
            looks.helmet = Some(PartMaterial::Plain(rgb(r, g, b)));
        }
        rider(
            b,
            id,
            [seat, Vec3::ZERO],
            height_m,
            [ankles, toes, wrists],
            &looks,
        );
    }
}

/// Angle of the cranks of a bicycle after a distance, rad; `gear_m` is the distance of a turn.
fn crank_angle(covered_m: f32, gear_m: f32, begin: f32) -> f32 {
    -TAU * (covered_m / gear_m).rem_euclid(1.0) + TAU * begin + FRAC_PI_2
}

/// Adds a motorcycle or a scooter; someone rides it if the box is high enough.
pub(super) fn motorcycle(b: &mut ObjectBuilder, id: u32, name: &str, gait: Gait) {
    let s = b.s;
    let ridden = s.z > 1.35 || gait.moves && s.z > 1.1;
    let with_rider = SEAT_M + GROWN_M * (0.7 * TORSO + NECK_AND_HEAD);
    let scale = match ridden {
        true => (s.z / with_rider).min(1.05),
        false => (s.z / 1.14).min(1.1),
    };
    let r = 0.305 * scale;
    let (rear, front) = (-0.5 * s.x + r, 0.5 * s.x - r);
    let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * Vec3::new(1.0, scale, scale);
    for x in [rear, front] {
        b.parts.push((
            ObjectPart::Ring(p(x, 0.0, 0.305), r, 0.052 * scale, r * 0.66),
            PartMaterial::Wheel,
        ));
        b.parts.push((
            ObjectPart::Wheel(p(x, 0.0, 0.305), r * 0.64, 0.022 * scale),
            PartMaterial::Plain(rgb(58, 59, 62)),
        ));
    }
    let head = p(front - 0.30 * scale, 0.0, 0.86);
    let metal = PartMaterial::Plain(rgb(96, 98, 102));
    for y in [0.09, -0.09] {
        let axle = p(front, y, 0.305);
        b.limb(
            [axle, head + Vec3::Y * y * scale],
            [0.028 * scale, 0.03 * scale],
            metal,
        );
        b.limb(
            [p(rear, y, 0.305), p(rear + 0.5 * scale, y, 0.38)],
            [0.028 * scale, 0.04 * scale],
            PartMaterial::Dark,
        );
    }
    let middle = (rear + front) / 2.0;
    // Engine, tank, seat and tail; a fairing before them.
    b.limb(
        [p(middle - 0.16, 0.0, 0.36), p(middle + 0.2, 0.0, 0.40)],
        [0.17 * scale, 0.16 * scale],
        PartMaterial::Dark,
    );
    b.limb(
        [p(middle + 0.22, 0.0, 0.80), p(middle - 0.1, 0.0, 0.75)],
        [0.14 * scale, 0.11 * scale],
        PartMaterial::Body,
    );
    b.limb(
        [p(middle - 0.16, 0.0, 0.73), p(rear - 0.05, 0.0, 0.79)],
        [0.105 * scale, 0.08 * scale],
        PartMaterial::Dark,
    );
    b.limb(
        [p(rear + 0.2, 0.0, 0.66), p(rear - 0.12, 0.0, 0.74)],
        [0.08 * scale, 0.06 * scale],
        PartMaterial::Body,
    );
    b.limb(
        [head + Vec3::new(0.02, 0.0, 0.0), p(middle + 0.3, 0.0, 0.56)],
        [0.12 * scale, 0.14 * scale],
        PartMaterial::Body,
    );
    b.limb(
        [p(front, 0.0, 0.63), p(front - 0.12 * scale, 0.0, 0.61)],
        [0.05 * scale, 0.05 * scale],
        PartMaterial::Body,
    );
    b.parts.push((
        ObjectPart::Round(
            head + Vec3::new(0.1, 0.0, 0.02) * scale,
            Vec3::new(0.05, 0.09, 0.09) * scale,
        ),
        PartMaterial::Plain(rgb(220, 224, 228)),
    ));
    b.limb(
        [p(rear - 0.16, 0.04, 0.72), p(rear - 0.16, -0.04, 0.72)],
        [0.026 * scale; 2],
        PartMaterial::Plain(rgb(150, 12, 14)),
    );
    b.limb(
        [p(middle - 0.1, -0.2, 0.3), p(rear - 0.05, -0.2, 0.42)],
        [0.045 * scale, 0.055 * scale],
        metal,
    );
    let bars = head + Vec3::new(-0.16, 0.0, 0.16) * scale;
    let half = (0.36 * scale).min(s.y / 2.0 - 0.03);
    b.limb(
        [bars + Vec3::Y * half, bars - Vec3::Y * half],
        [0.018 * scale; 2],
        PartMaterial::Dark,
    );
    b.limb([bars, head], [0.03 * scale; 2], PartMaterial::Dark);
    if ridden {
        let seat = p(middle - 0.28 * scale, 0.0, SEAT_M + 0.08);
        let foot = |side: f32| p(middle - 0.12 * scale, side * 0.19, 0.40);
        let ankles = [foot(1.0), foot(-1.0)];
        let toes = ankles.map(|a| a + Vec3::new(0.16, 0.0, -0.04) * scale);
        let wrists = [half - 0.06, 0.06 - half].map(|y| bars + Vec3::new(-0.05, y, 0.02));
        let mut looks = Looks::new(id, name);
        let colors = [[24, 25, 28], [220, 222, 224], [160, 30, 32], [40, 70, 140]];
        let [r, g, blue] = colors[hash1(id, 12) as usize % colors.len()];
        looks.helmet = Some(PartMaterial::Plain(rgb(r, g, blue)));
        rider(
            b,
            id,
            [seat, Vec3::ZERO],
            GROWN_M * scale,
            [ankles, toes, wrists],
            &looks,
        );
    }
}

/// Adds somebody who sits at `seat`, and leans so that the head is as high as the box; ankles, toes and wrists are given, m.
fn rider(
    b: &mut ObjectBuilder,
    id: u32,
    [seat, foot]: [Vec3; 2],
    height_m: f32,
    [ankles, toes, wrists]: [[Vec3; 2]; 3],
    looks: &Looks,
) {
    let room = (b.s.z - seat.z) / height_m - NECK_AND_HEAD;
    let cos = (room / TORSO).clamp(LEANS[0], LEANS[1]);
    let lean = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let hips = seat / height_m;
    let shares = |p: [Vec3; 2]| p.map(|p| p / height_m);
    let joints = Joints {
        hips,
        shoulders: hips + lean * TORSO,
        ankles: shares(ankles),
        toes: shares(toes),
        wrists: shares(wrists),
        elbows_to: Vec3::new(-0.2, 0.0, -1.0),
    };
    body(b, foot, height_m, id, &joints, looks);
}

/// Points of a bicycle's frame.
struct Frame {
    scale: f32,
    wheel_m: f32,
    rear: Vec3,
    front: Vec3,
    cranks: Vec3,
    saddle: Vec3,
    /// Upper and lower end of the head tube.
    head: [Vec3; 2],
    bars: Vec3,
}

impl Frame {
    fn new(s: Vec3, scale: f32) -> Self {
        let wheel_m = (0.34 * scale).min(0.24 * s.x);
        let (rear, front) = (-0.5 * s.x + wheel_m, 0.5 * s.x - wheel_m);
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z * scale);
        // Long bicycles carry their load in front.
        let cranks = at((rear + 0.44 * scale).min(front), CRANKS_M[0]);
        let steer = (cranks.x + 0.58 * scale).min(front - 0.05);
        Self {
            scale,
            wheel_m,
            rear: Vec3::new(rear, 0.0, wheel_m),
            front: Vec3::new(front, 0.0, wheel_m),
            cranks,
            saddle: at(cranks.x - 0.19 * scale, SADDLE_M - 0.05),
            head: [at(steer - 0.12 * scale, 0.9), at(steer - 0.06 * scale, 0.68)],
            bars: at(steer - 0.16 * scale, BARS_M - 0.02),
        }
    }

    fn draw(&self, b: &mut ObjectBuilder, id: u32) {
        let k = self.scale;
        let paints = [
            [40, 90, 120],
            [24, 26, 30],
            [150, 36, 34],
            [206, 208, 206],
            [40, 96, 70],
            [196, 150, 40],
        ];
        let [red, green, blue] = paints[hash1(id, 13) as usize % paints.len()];
        let paint = PartMaterial::Plain(rgb(red, green, blue));
        for hub in [self.rear, self.front] {
            let tire = ObjectPart::Ring(hub, self.wheel_m, 0.019 * k, self.wheel_m - 0.04 * k);
            b.parts.push((tire, PartMaterial::Wheel));
            b.parts
                .push((ObjectPart::Wheel(hub, 0.032 * k, 0.05 * k), PartMaterial::Dark));
        }
        let post = self.cranks.lerp(self.saddle, 0.86);
        let mut tube = |ends: [Vec3; 2], r: f32, material: PartMaterial| b.limb(ends, [r * k; 2], material);
        tube([self.cranks, post], 0.017, paint);
        tube([post, self.saddle], 0.013, PartMaterial::Dark);
        tube([post, self.head[0]], 0.017, paint);
        tube([self.cranks, self.head[1]], 0.019, paint);
        tube(self.head, 0.02, paint);
        for side in [0.05, -0.05] {
            let aside = Vec3::Y * side * k;
            tube([self.cranks + aside * 0.5, self.rear + aside], 0.011, paint);
            tube([post, self.rear + aside], 0.010, paint);
            tube([self.head[1], self.front + aside], 0.013, paint);
        }
        tube([self.head[0], self.bars], 0.014, PartMaterial::Dark);
        let aside = Vec3::Y * 0.29 * k;
        tube([self.bars + aside, self.bars - aside], 0.013, PartMaterial::Dark);
        let seat = Vec3::X * 0.1 * k;
        tube(
            [self.saddle - seat, self.saddle + seat * 1.3],
            0.034,
            PartMaterial::Dark,
        );
        tube(
            [
                self.saddle - seat * 1.6 - Vec3::Z * 0.14 * k,
                self.saddle - seat * 1.6 - Vec3::Z * 0.17 * k,
            ],
            0.024,
            PartMaterial::Plain(rgb(150, 12, 14)),
        );
        // A chest between bars and front wheel.
        let room = self.front.x - self.wheel_m - self.head[1].x;
        if room > 0.15 {
            let [lo, hi] = [self.head[1].x - 0.02, self.front.x + 0.1].map(|x| x / b.s.x);
            let z = [0.5 * k / b.s.z, 0.86 * k / b.s.z];
            b.block(
                [lo, -0.42, z[0]],
                [hi, 0.42, z[1]],
                0.03,
                PartMaterial::Plain(rgb(140, 104, 66)),
            );
        }
    }
}
