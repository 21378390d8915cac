//! The ground of a world: its class per column, its height at every point, and its intersection with rays.

use glam::{DVec2, DVec3};

use super::{BIN_M, BINS, WorldHit, scenery};
use scene::draw::{Draw, Noise};
use scene::{BevLayer, BevLayout, Class, Relief, Window};

/// Height of a kerb above the road, m.
const KERB_M: f64 = 0.24;
/// Greatest height of the ground above the relief, m.
const MOST_ABOVE_RELIEF_M: f64 = 0.35;
/// A ray over uneven ground is tested at steps of this length on the ground, m.
const STEP_M: f64 = 0.4;

pub(super) struct WorldGround {
    classes: Vec<Class>, // [x][y]
    above_m: Vec<f32>,   // kerbs and bumps over the relief, [x][y]
    relief: Relief,
    highest_m: Vec<f64>, // per bin of the world
}

impl WorldGround {
    pub(super) fn new(layout: &BevLayout, seed: u64) -> Self {
        let relief = layout.relief.clone();
        let highest = |bin: usize| {
            let columns = (BIN_M / Window::VOXEL_M) as usize;
            let from = [bin / BINS * columns, bin % BINS * columns];
            let mut most = f64::NEG_INFINITY;
            // One column more on each side: heights are blended between centres.
            for x in from[0].saturating_sub(1)..(from[0] + columns + 1).min(Window::NX) {
                for y in from[1].saturating_sub(1)..(from[1] + columns + 1).min(Window::NY) {
                    most = most.max(relief.column_m(x, y));
                }
            }
            most + MOST_ABOVE_RELIEF_M
        };
        let classes = classes(layout, seed);
        let (walk, open) = (Noise::new(seed), Noise::new(seed));
        let above = |(c, class): (usize, &Class)| {
            let p = Window::center(c / Window::NY, c % Window::NY, 0).truncate();
            let height_m = match class {
                Class::Sidewalk => KERB_M + 0.05 * walk.at(p.x / 14.0, p.y / 14.0),
                Class::Terrain => 0.08 + 0.1 * open.at(p.x / 9.0, p.y / 9.0),
                Class::OtherFlat => 0.15,
                _ => 0.0,
            };
            height_m as f32
        };
        Self {
            above_m: classes.iter().enumerate().map(above).collect(),
            classes,
            highest_m: match relief.is_flat() {
                true => Vec::new(),
                false => (0..BINS * BINS).map(highest).collect(),
            },
            relief,
        }
    }

    pub(super) fn class(&self, x: usize, y: usize) -> Class {
        self.classes[x * Window::NY + y]
    }

    /// Height at a point of the ego frame, m: the relief, kerbs and small bumps.
    pub(super) fn height_m(&self, p: DVec2) -> f64 {
        let Some([x, y]) = Window::column_at(p.x, p.y) else {
            return self.relief.height_m(p);
        };
        self.relief.height_m(p) + f64::from(self.above_m[x * Window::NY + y])
    }

    /// The hit of a ray on ground without relief; `None` if there is relief.
    pub(super) fn cast_flat(&self, origin: DVec3, dir: DVec3) -> Option<WorldHit> {
        if dir.z >= -1e-6 || !self.relief.is_flat() {
            return None;
        }
        // The ground is flat to a few decimetres: two corrections of the height converge.
        let mut t = -origin.z / dir.z;
        for _ in 0..2 {
            let p = origin + dir * t;
            t = (self.height_m(p.truncate()) - origin.z) / dir.z;
        }
        self.hit(origin + dir * t, t)
    }

    /// The hit of a ray on ground with relief, between two distances inside one bin; `None` if there is no relief.
    pub(super) fn cast_in_bin(
        &self,
        bin: usize,
        origin: DVec3,
        dir: DVec3,
        from: f64,
        to: f64,
    ) -> Option<WorldHit> {
        let highest = *self.highest_m.get(bin)?;
        let z = |t: f64| origin.z + dir.z * t;
        if z(from).min(z(to)) > highest || from >= to {
            return None;
        }
        let above = |t: f64| z(t) - self.height_m((origin + dir * t).truncate());
        let flat = dir.truncate().length();
        let steps = ((to - from) * flat / STEP_M).ceil().clamp(1.0, 64.0) as usize;
        let at = |i: usize| from + (to - from) * i as f64 / steps as f64;
        let mut before = above(from);
        for i in 1..=steps {
            let now = above(at(i));
            if before > 0.0 && now <= 0.0 {
                let (mut low, mut high) = (at(i - 1), at(i));
                for _ in 0..8 {
                    let middle = (low + high) / 2.0;
                    match above(middle) > 0.0 {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                return self.hit(origin + dir * high, high);
            }
            before = now;
        }
        None
    }

    fn hit(&self, p: DVec3, range_m: f64) -> Option<WorldHit> {
        let [x, y] = Window::column_at(p.x, p.y)?;
        (range_m > 0.0).then(|| WorldHit {
            range_m,
            class: self.class(x, y),
            solid: None,
        })
    }
}

fn classes(layout: &BevLayout, seed: u64) -> Vec<Class> {
    let has = |cell: u32, layer: BevLayer| cell & layer.bit() != 0;
    let mut draw = Draw::new(seed, "ground");
    // Some verges are paved (plazas, traffic islands): "other flat" in nuScenes.
    let to_road = draw.chance(0.25).then(|| {
        scenery::distance_cells(layout.extent(), |c| {
            has(layout.cells()[c], BevLayer::DrivableArea)
        })
    });
    let mut out = Vec::with_capacity(Window::COLUMNS);
    for (c, &cell) in layout.cells().iter().enumerate() {
        out.push(
            if has(cell, BevLayer::DrivableArea) || has(cell, BevLayer::CarparkArea) {
                Class::DriveableSurface
            } else if has(cell, BevLayer::Walkway) || has(cell, BevLayer::PedCrossing) {
                Class::Sidewalk
            } else if to_road.as_ref().is_some_and(|d| d[c] < 8.0) {
                Class::OtherFlat
            } else {
                Class::Terrain
            },
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Extent;

    /// On a slope the ray must end on the ground, at the distance that a fine march finds.
    #[test]
    fn rays_meet_uneven_ground_where_it_is() {
        let mut layout = BevLayout::default();
        layout.relief = Relief::from_fn(Extent::WINDOW, |p| 0.06 * p.x + 0.8 * (p.y / 9.0).sin() - 0.3);
        let world = super::super::World::with_background(layout, Default::default(), Default::default(), 5);
        let mut draw = Draw::new(2, "rays over hills");
        let mut met = 0;
        for _ in 0..600 {
            let p = DVec2::new(draw.range(-30.0, 30.0), draw.range(-30.0, 30.0));
            let origin = p.extend(world.ground_height(p) + draw.range(0.5, 3.0));
            let dir = DVec3::new(
                draw.range(-1.0, 1.0),
                draw.range(-1.0, 1.0),
                draw.range(-0.25, 0.1),
            )
            .normalize();
            let above = |t: f64| {
                let q = origin + dir * t;
                q.z - world.ground_height(q.truncate())
            };
            let inside = |t: f64| (origin + dir * t).truncate().abs().max_element() < 39.5;
            let marched = (1..6000)
                .map(|i| f64::from(i) * 0.01)
                .take_while(|t| inside(*t))
                .find(|t| above(*t) <= 0.0);
            if let Some(expected) = marched {
                let hit = world.cast(origin, dir, 70.0).expect("the ground is ahead");
                assert!(above(hit.range_m).abs() < 0.06, "{}", above(hit.range_m));
                // A kerb of bumps may be grazed between two steps; nothing ends far behind the first contact.
                assert!(
                    hit.range_m < expected + 3.0 && hit.range_m > expected - 0.05,
                    "{} {expected}",
                    hit.range_m
                );
                met += 1;
            }
        }
        assert!(met > 250, "{met}");
    }
}
