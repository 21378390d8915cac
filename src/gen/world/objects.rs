//! Plausible shapes for the ten object classes: a few solids each, fitted into the box.

use glam::{DVec2, DVec3};

use scene::draw::{Draw, hash};
use scene::solid::Solid;
use scene::{Class, SceneBox};

/// Builds parts in box coordinates: fractions of length and width from the middle, and of height from the ground.
struct Parts<'a> {
    b: &'a SceneBox,
    out: &'a mut Vec<Solid>,
}

impl Parts<'_> {
    fn base(&self, x: f64, y: f64, z: f64) -> DVec3 {
        let s = self.b.size_m;
        self.b.to_ego(DVec3::new(x * s.x, y * s.y, z * s.z - s.z / 2.0))
    }

    /// A tapered block: middle (x, y), bottom z, size as fractions, and the taper of its top.
    fn block(&mut self, at: [f64; 3], size: [f64; 3], taper: [f64; 2]) {
        let s = self.b.size_m * DVec3::from_array(size);
        let base = self.base(at[0], at[1], at[2]);
        self.out.push(Solid::tapered(
            self.b.class,
            base,
            s,
            DVec2::from_array(taper),
            self.b.heading(),
        ));
    }

    /// An upright frustum; height as a fraction, radii in m.
    fn round(&mut self, at: [f64; 3], height: f64, bottom: f64, top: f64) {
        let base = self.base(at[0], at[1], at[2]);
        self.out.push(Solid::frustum(
            self.b.class,
            base,
            height * self.b.size_m.z,
            bottom,
            top,
        ));
    }
}

/// Appends the solids of one object to `out`. Detail varies with `seed` and the box's id.
pub fn object(b: &SceneBox, seed: u64, out: &mut Vec<Solid>) {
    let mut draw = Draw::new(hash(seed ^ u64::from(b.id.0)), "object");
    let width = b.size_m.y;
    let mut p = Parts { b, out };
    match b.class {
        Class::Car => {
            p.block([0.0, 0.0, 0.1], [1.0, 1.0, 0.48], [0.98, 0.96]);
            // Saloon, hatchback or van: where the cabin sits and how steep it is.
            match draw.below(3) {
                0 => p.block([-0.06, 0.0, 0.55], [0.62, 0.92, 0.45], [0.68, 0.86]),
                1 => p.block([-0.14, 0.0, 0.55], [0.68, 0.92, 0.45], [0.78, 0.86]),
                _ => p.block([-0.08, 0.0, 0.55], [0.82, 0.96, 0.45], [0.88, 0.9]),
            }
            for x in [-0.3, 0.3] {
                p.block([x, 0.0, 0.0], [0.15, 0.96, 0.2], [1.0, 1.0]);
            }
        }
        Class::Bus => {
            p.block([0.0, 0.0, 0.1], [1.0, 1.0, 0.86], [0.99, 0.98]);
            p.block([-0.1, 0.0, 0.95], [0.3, 0.6, 0.05], [1.0, 1.0]);
            for x in [-0.3, 0.33] {
                p.block([x, 0.0, 0.0], [0.1, 0.96, 0.15], [1.0, 1.0]);
            }
        }
        Class::Truck => {
            let cab = draw.range(0.24, 0.34);
            p.block(
                [0.5 - cab / 2.0, 0.0, 0.12],
                [cab, 1.0, draw.range(0.62, 0.85)],
                [0.9, 0.95],
            );
            p.block([-cab / 2.0, 0.0, 0.12], [1.0 - cab, 0.9, 0.2], [1.0, 1.0]);
            p.block([-cab / 2.0 - 0.01, 0.0, 0.3], [0.98 - cab, 1.0, 0.7], [1.0, 1.0]);
            for x in [-0.34, -0.2, 0.36] {
                p.block([x, 0.0, 0.0], [0.1, 0.96, 0.2], [1.0, 1.0]);
            }
        }
        Class::Trailer => {
            p.block([0.0, 0.0, 0.26], [1.0, 1.0, 0.74], [1.0, 1.0]);
            p.block([0.0, 0.0, 0.18], [0.95, 0.5, 0.1], [1.0, 1.0]);
            for x in [-0.36, -0.26] {
                p.block([x, 0.0, 0.0], [0.08, 0.96, 0.28], [1.0, 1.0]);
            }
        }
        Class::ConstructionVehicle => {
            p.block([0.0, 0.0, 0.0], [0.85, 1.0, 0.28], [1.0, 1.0]);
            p.block([-0.15, 0.0, 0.28], [0.62, 0.9, 0.35], [0.95, 0.95]);
            p.block([-0.05, 0.18, 0.55], [0.28, 0.45, 0.42], [0.85, 0.9]);
            // The arm, as three steps from the body up and down to the bucket.
            p.block([0.22, -0.1, 0.45], [0.25, 0.22, 0.3], [0.9, 0.9]);
            p.block([0.36, -0.1, 0.62], [0.22, 0.2, 0.3], [0.9, 0.9]);
            p.block([0.45, -0.1, 0.0], [0.1, 0.4, 0.75], [0.7, 0.6]);
        }
        Class::Barrier => {
            p.block([0.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.7, 1.0]);
            p.block([0.0, 0.0, 0.3], [0.7, 1.0, 0.7], [0.5, 1.0]);
        }
        Class::Motorcycle | Class::Bicycle => {
            let wheel = if b.class == Class::Bicycle { 0.3 } else { 0.45 };
            for x in [-0.34, 0.34] {
                p.block([x, 0.0, 0.0], [0.3, wheel * 0.7, 0.42], [0.8, 0.9]);
            }
            p.block([0.0, 0.0, 0.2], [0.6, wheel, 0.35], [0.8, 0.9]);
            p.block([0.3, 0.0, 0.5], [0.08, 1.0, 0.12], [1.0, 1.0]);
            if draw.chance(0.6) {
                p.block([-0.05, 0.0, 0.5], [0.22, 0.7, 0.38], [0.9, 0.8]);
                p.round([0.0, 0.0, 0.86], 0.14, 0.12, 0.1);
            }
        }
        Class::Pedestrian => {
            for y in [-0.17, 0.17] {
                p.round(
                    [draw.range(-0.15, 0.15), y, 0.0],
                    0.48,
                    width * 0.16,
                    width * 0.18,
                );
            }
            p.round([0.0, 0.0, 0.46], 0.4, width * 0.4, width * 0.45);
            p.round([0.0, 0.0, 0.86], 0.14, width * 0.18, width * 0.16);
        }
        Class::TrafficCone => {
            p.block([0.0, 0.0, 0.0], [1.0, 1.0, 0.08], [1.0, 1.0]);
            p.round([0.0, 0.0, 0.08], 0.92, width * 0.42, width * 0.1);
        }
        _ => {}
    }
}
