//! The shape of each class of objects, as parts.

use glam::Vec3;

use super::build::ObjectBuilder;
use super::gait::Gait;
use super::person::person;
use super::two_wheeler::{bicycle, motorcycle};
use super::{ObjectPart, PartMaterial, rgb};
use crate::pictures::appearance::noise::{hash1, unit};
use scene::Class;

/// Adds the parts of an object; `id` varies them, and so does what it is called.
pub(super) fn shape(b: &mut ObjectBuilder, class: Class, id: u32, name: &str, gait: Gait) {
    let pick = unit(hash1(id, 3));
    match class {
        Class::Car => car(b, pick),
        Class::Bus => bus(b),
        Class::Truck => truck(b, pick),
        Class::Trailer => trailer(b),
        Class::ConstructionVehicle => construction_vehicle(b),
        Class::Barrier => barrier(b),
        Class::Motorcycle => motorcycle(b, id, name, gait),
        Class::Bicycle => bicycle(b, id, name, gait),
        Class::Pedestrian => person(b, id, name, gait),
        Class::TrafficCone => traffic_cone(b),
        _ => {}
    }
}

/// A saloon, a hatchback or a van.
fn car(b: &mut ObjectBuilder, pick: f32) {
    let s = b.s;
    // Saloon, hatchback, van: hood, windscreen and tail as fractions of the length.
    let kinds = [
        ([0.20, 0.03, -0.24, -0.40], 0.57),
        ([0.24, 0.07, -0.36, -0.47], 0.58),
        ([0.27, 0.14, -0.42, -0.485], 0.60),
    ];
    let tall = s.z / s.x;
    let kind = if tall > 0.41 { 2 } else { usize::from(pick > 0.55) };
    let ([screen, front, back, tail], belt) = kinds[kind];
    let low = 0.12;
    b.profile(
        &[
            [0.5, 0.22],
            [0.5, 0.36],
            [0.475, 0.46],
            [screen, belt],
            [tail, belt + 0.01],
            [-0.485, belt - 0.04],
            [-0.5, 0.36],
            [-0.495, 0.2],
            [-0.46, low],
            [0.46, low],
        ],
        &[[0.94, 0.1], [1.0, 0.3], [0.985, 0.46], [0.93, 0.62]],
        0.14,
        PartMaterial::Body,
    );
    b.profile(
        &[
            [screen + 0.01, belt - 0.04],
            [front, 0.955],
            [front - 0.08, 1.0],
            [back + 0.06, 0.995],
            [back, 0.95],
            [tail, belt - 0.04],
        ],
        &[[0.965, 0.5], [0.93, belt], [0.72, 0.955], [0.55, 1.0]],
        0.0,
        PartMaterial::Cabin,
    );
    let r = (0.165 * s.z + 0.06).clamp(0.2, 0.42);
    b.wheels(&[-0.295, 0.3], r, 0.21);
    for side in [0.98, -0.98] {
        b.round(
            [front + 0.1, side * 0.53, belt + 0.02],
            [0.09, 0.11, 0.075],
            PartMaterial::Body,
        );
    }
}

/// A bus.
fn bus(b: &mut ObjectBuilder) {
    b.block([-0.5, -0.5, 0.1], [0.5, 0.5, 0.97], 0.14, PartMaterial::Coach);
    b.block(
        [-0.3, -0.3, 0.9],
        [0.1, 0.3, 1.0],
        0.05,
        PartMaterial::Plain(Vec3::splat(0.6)),
    );
    b.wheels(&[-0.28, 0.33], 0.48, 0.3);
}

/// A cab with a box or a flat bed behind.
fn truck(b: &mut ObjectBuilder, pick: f32) {
    let s = b.s;
    let cab = 0.24 + 0.08 * pick;
    let van = pick > 0.55;
    b.profile(
        &[
            [0.5, 0.14],
            [0.5, 0.42],
            [0.5 - 0.2 * cab, 0.8],
            [0.5 - 0.35 * cab, 0.84],
            [0.5 - cab, 0.84],
            [0.5 - cab, 0.14],
        ],
        &[[0.94, 0.1], [0.96, 0.45], [0.86, 0.86]],
        0.1,
        PartMaterial::Cabin,
    );
    b.block(
        [-0.5, -0.36, 0.14],
        [0.5 - cab, 0.36, 0.24],
        0.0,
        PartMaterial::Dark,
    );
    if van || s.z > 2.2 {
        b.block(
            [-0.5, -0.5, 0.24],
            [0.49 - cab, 0.5, 1.0],
            0.04,
            PartMaterial::Cargo,
        );
    } else {
        b.block(
            [-0.5, -0.48, 0.24],
            [0.49 - cab, 0.48, 0.55],
            0.03,
            PartMaterial::Cargo,
        );
    }
    b.wheels(&[-0.34, 0.34], (0.16 * s.z).clamp(0.3, 0.5), 0.28);
}

/// A box on wheels.
fn trailer(b: &mut ObjectBuilder) {
    b.block([-0.5, -0.5, 0.28], [0.5, 0.5, 1.0], 0.04, PartMaterial::Cargo);
    b.block([-0.48, -0.3, 0.18], [0.48, 0.3, 0.28], 0.0, PartMaterial::Dark);
    b.wheels(&[-0.4, -0.3, -0.2], 0.46, 0.3);
}

/// A digger on tracks.
fn construction_vehicle(b: &mut ObjectBuilder) {
    b.block([-0.42, -0.5, 0.0], [0.42, -0.22, 0.26], 0.15, PartMaterial::Dark);
    b.block([-0.42, 0.22, 0.0], [0.42, 0.5, 0.26], 0.15, PartMaterial::Dark);
    let yellow = PartMaterial::Plain(rgb(232, 168, 20));
    b.block([-0.45, -0.42, 0.26], [0.2, 0.42, 0.62], 0.12, yellow);
    b.block([-0.15, 0.0, 0.6], [0.2, 0.42, 1.0], 0.08, PartMaterial::Cabin);
    b.block([0.1, -0.22, 0.5], [0.42, -0.06, 0.72], 0.05, yellow);
    b.block([0.36, -0.22, 0.3], [0.46, -0.06, 0.7], 0.05, yellow);
    b.block([0.38, -0.3, 0.02], [0.5, 0.1, 0.32], 0.05, PartMaterial::Dark);
}

/// A wall with bands.
fn barrier(b: &mut ObjectBuilder) {
    // Long in y or in x: either way it is a wall with bands.
    let bands = PartMaterial::Bands(rgb(206, 44, 30));
    b.block(
        [-0.5, -0.5, 0.0],
        [0.5, 0.5, 0.16],
        0.03,
        PartMaterial::Plain(Vec3::splat(0.12)),
    );
    b.block([-0.28, -0.5, 0.3], [0.28, 0.5, 0.62], 0.02, bands);
    b.block([-0.28, -0.5, 0.7], [0.28, 0.5, 1.0], 0.02, bands);
    for y in [-0.42, 0.4] {
        b.block(
            [-0.2, y, 0.1],
            [0.2, y + 0.04, 1.0],
            0.0,
            PartMaterial::Plain(Vec3::splat(0.4)),
        );
    }
}

/// A cone on its foot.
fn traffic_cone(b: &mut ObjectBuilder) {
    let s = b.s;
    b.block(
        [-0.5, -0.5, 0.0],
        [0.5, 0.5, 0.05],
        0.0,
        PartMaterial::Plain(Vec3::splat(0.03)),
    );
    let r = s.x.min(s.y) * 0.36;
    b.parts.push((
        ObjectPart::Cone(Vec3::new(0.0, 0.0, 0.05 * s.z), 0.95 * s.z, r, r * 0.2),
        PartMaterial::Bands(rgb(255, 84, 16)),
    ));
}
