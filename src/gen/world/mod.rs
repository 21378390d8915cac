//! Procedural driving worlds on top of a layout: analytic solids, finer than voxels, from which
//! occupancy and sensor truth are made alike.

pub mod draw;
pub mod objects;
pub mod scenery;
pub mod shapes;
pub mod template;
pub mod traffic;
pub mod voxelize;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::scene::{BevLayer, BevLayout, BoxId, Class, GridSpec, SceneBox};
use draw::noise;
use shapes::Solid;

/// A point where a ray met the world.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// What was hit.
    pub class: Class,
    /// Index of the solid that was hit; `None` is the ground.
    pub solid: Option<u32>,
}

/// What a point of a surface is made of, as far as the world knows.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Outward unit normal.
    pub normal: DVec3,
    /// Names the thing it belongs to: solids of one object have the same, another thing has another. 0 is the ground.
    pub instance: u32,
    /// Which of the object's solids, in the order of `objects.rs`; 0 for all others.
    pub part: u8,
}

const BIN_M: f64 = 4.0;
const BINS: usize = 20;

/// A driving world of 80 x 80 m in the ego frame, ground at about z = 0.
pub struct World {
    /// Roads and everything painted.
    pub layout: BevLayout,
    /// Objects.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    solids: Vec<Solid>,
    owners: Vec<(u32, u8)>, // instance and part of each solid
    bins: Vec<Vec<u32>>,    // [x][y] of 4 m, indices of solids that reach in
    ground: Vec<Class>,
    seed: u64,
}

impl World {
    /// Builds the world of `seed` on a layout with these boxes.
    pub fn new(layout: BevLayout, boxes: BTreeMap<BoxId, SceneBox>, seed: u64) -> Self {
        let (mut solids, mut owners) = (Vec::new(), Vec::new());
        for b in boxes.values() {
            objects::object(b, seed, &mut solids);
            let instance = 1 + b.id.0;
            owners.extend(
                (owners.len()..solids.len())
                    .enumerate()
                    .map(|(part, _)| (instance, part as u8)),
            );
        }
        scenery::scenery(&layout, &boxes, seed, &mut solids);
        // Beyond any box's id, so that a bush never shares a number with a car.
        owners.extend((owners.len()..solids.len()).map(|i| (1 << 31 | i as u32, 0)));
        let mut bins = vec![Vec::new(); BINS * BINS];
        let bin = |v: f64| ((v + 40.0) / BIN_M).floor();
        for (i, s) in solids.iter().enumerate() {
            let (lo, hi) = (s.center - s.reach(), s.center + s.reach());
            let last = BINS as f64 - 1.0;
            for x in bin(lo.x).max(0.0) as usize..=bin(hi.x).clamp(-1.0, last).max(0.0) as usize {
                for y in bin(lo.y).max(0.0) as usize..=bin(hi.y).clamp(-1.0, last).max(0.0) as usize {
                    bins[x * BINS + y].push(i as u32);
                }
            }
        }
        let ground = ground_classes(&layout, seed);
        Self {
            layout,
            boxes,
            solids,
            owners,
            bins,
            ground,
            seed,
        }
    }

    /// The world of `seed` on a varied template with ordinary traffic.
    pub fn random(seed: u64) -> Self {
        let layout = template::any_layout(seed);
        let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
        Self::new(layout, boxes, seed)
    }

    /// The solids standing on the ground.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Seed it was made from.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The surface at a point that [`cast`](Self::cast) found.
    pub fn surface(&self, hit: &Hit, p: DVec3) -> Surface {
        let solid = hit
            .solid
            .and_then(|i| self.solids.get(i as usize).zip(self.owners.get(i as usize)));
        match solid {
            Some((solid, &(instance, part))) => Surface {
                normal: solid.normal(p),
                instance,
                part,
            },
            None => Surface {
                normal: DVec3::Z,
                instance: 0,
                part: 0,
            },
        }
    }

    /// Class of the ground in a column.
    pub fn ground_class(&self, x: usize, y: usize) -> Class {
        self.ground[x * GridSpec::NY + y]
    }

    /// Height of the ground at a point of the ego frame, m.
    pub fn ground_height(&self, p: DVec2) -> f64 {
        let Some([x, y]) = GridSpec::column_at(p.x, p.y) else {
            return 0.0;
        };
        match self.ground_class(x, y) {
            Class::Sidewalk => 0.225 + 0.05 * noise(self.seed, p.x / 14.0, p.y / 14.0),
            Class::Terrain => 0.08 + 0.1 * noise(self.seed, p.x / 9.0, p.y / 9.0),
            Class::OtherFlat => 0.15,
            _ => 0.0,
        }
    }

    /// The first surface along a ray of the ego frame within `max_range_m`; `dir` is a unit vector.
    pub fn cast(&self, origin: DVec3, dir: DVec3, max_range_m: f64) -> Option<Hit> {
        let ground = self.cast_ground(origin, dir).filter(|h| h.range_m <= max_range_m);
        let mut best = ground.map_or(max_range_m, |h| h.range_m);
        let mut hit = ground;
        // Walk the 4 m bins under the ray; a bin's solids may be met up to the bin's far side.
        let to_bin = |v: f64| (v + 40.0) / BIN_M;
        let (mut x, mut y) = (to_bin(origin.x).floor() as i64, to_bin(origin.y).floor() as i64);
        let edge = |cell: i64, d: f64| (cell + i64::from(d > 0.0)) as f64 * BIN_M - 40.0;
        let inv = DVec2::new(1.0 / dir.x, 1.0 / dir.y);
        let next = |cell: i64, o: f64, d: f64, inv: f64| {
            if d == 0.0 {
                f64::INFINITY
            } else {
                (edge(cell, d) - o) * inv
            }
        };
        for _ in 0..2 * BINS + 2 {
            if !(0..BINS as i64).contains(&x) || !(0..BINS as i64).contains(&y) {
                break;
            }
            for &i in &self.bins[x as usize * BINS + y as usize] {
                let s = &self.solids[i as usize];
                if let Some(t) = s.enter(origin, dir, best)
                    && t < best
                {
                    best = t;
                    hit = Some(Hit {
                        range_m: t,
                        class: s.class,
                        solid: Some(i),
                    });
                }
            }
            let (tx, ty) = (next(x, origin.x, dir.x, inv.x), next(y, origin.y, dir.y, inv.y));
            if best < tx.min(ty) {
                break;
            }
            if tx < ty {
                x += dir.x.signum() as i64;
            } else {
                y += dir.y.signum() as i64;
            }
        }
        hit
    }

    fn cast_ground(&self, origin: DVec3, dir: DVec3) -> Option<Hit> {
        if dir.z >= -1e-6 {
            return None;
        }
        // The ground is flat to a few decimetres: two corrections of the height converge.
        let mut t = -origin.z / dir.z;
        for _ in 0..2 {
            let p = origin + dir * t;
            t = (self.ground_height(p.truncate()) - origin.z) / dir.z;
        }
        let p = origin + dir * t;
        let [x, y] = GridSpec::column_at(p.x, p.y)?;
        (t > 0.0).then(|| Hit {
            range_m: t,
            class: self.ground_class(x, y),
            solid: None,
        })
    }
}

fn ground_classes(layout: &BevLayout, seed: u64) -> Vec<Class> {
    let has = |cell: u32, layer: BevLayer| cell & layer.bit() != 0;
    let to_road = scenery::distance_cells(|c| has(layout.cells()[c], BevLayer::DrivableArea));
    let mut draw = draw::Draw::new(seed, "ground");
    // Some verges are paved (plazas, traffic islands): "other flat" in nuScenes.
    let paved = draw.chance(0.25);
    let mut out = Vec::with_capacity(GridSpec::COLUMNS);
    for (c, &cell) in layout.cells().iter().enumerate() {
        out.push(
            if has(cell, BevLayer::DrivableArea) || has(cell, BevLayer::CarparkArea) {
                Class::DriveableSurface
            } else if has(cell, BevLayer::Walkway) || has(cell, BevLayer::PedCrossing) {
                Class::Sidewalk
            } else if paved && to_road[c] < 8.0 {
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

    /// The walk over bins must find what testing every solid finds.
    #[test]
    fn cast_equals_brute_force() {
        let world = World::random(5);
        let mut draw = draw::Draw::new(1, "test rays");
        let mut hits = 0;
        for _ in 0..4000 {
            let origin = DVec3::new(
                draw.range(-30.0, 30.0),
                draw.range(-30.0, 30.0),
                draw.range(0.5, 3.0),
            );
            let dir = DVec3::new(
                draw.range(-1.0, 1.0),
                draw.range(-1.0, 1.0),
                draw.range(-0.3, 0.3),
            )
            .normalize();
            let mut best = world
                .cast_ground(origin, dir)
                .map_or(70.0, |h| h.range_m.min(70.0));
            for s in world.solids() {
                best = s.enter(origin, dir, best).map_or(best, |t| t.min(best));
            }
            let hit = world.cast(origin, dir, 70.0);
            let in_grid = origin + dir * best;
            if in_grid.truncate().abs().max_element() < 39.9 && best < 70.0 {
                hits += 1;
                let found = hit.expect("brute force hit").range_m;
                assert!((found - best).abs() < 1e-9, "{found} {best}");
            }
        }
        assert!(hits > 1000, "{hits}");
    }

    #[test]
    fn every_object_class_has_a_shape_that_fills_its_box() {
        for class in Class::OBJECTS {
            let size_m = DVec3::from_array(class.typical_size_m().expect("object"));
            let b = SceneBox {
                id: BoxId(1),
                class,
                center_m: DVec3::new(10.0, 5.0, size_m.z / 2.0),
                size_m,
                yaw_rad: 0.8,
                velocity_mps: DVec2::ZERO,
                label: Default::default(),
            };
            let mut solids = Vec::new();
            objects::object(&b, 1, &mut solids);
            assert!(!solids.is_empty(), "{class:?}");
            let (mut inside, mut n) = (0, 0);
            for s in &solids {
                assert_eq!(s.class, class);
                let (lo, hi) = (s.center - s.reach(), s.center + s.reach());
                for i in 0..1000 {
                    let f = |k: i32| f64::from(k) / 9.0;
                    let p = lo + (hi - lo) * DVec3::new(f(i % 10), f(i / 10 % 10), f(i / 100));
                    if s.contains(p) {
                        n += 1;
                        inside += usize::from(b.contains(p, 0.12));
                    }
                }
            }
            assert!(
                inside * 10 > n * 9,
                "{class:?}: {inside} of {n} points inside the box"
            );
        }
    }
}
