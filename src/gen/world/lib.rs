//! Procedural driving worlds on a layout. They consist of exact solids, finer than voxels; both the occupancy and the true
//! sensor data are made from these.

mod ground;
pub mod objects;
pub mod scenery;
pub mod template;
pub mod terrain;
pub mod traffic;
pub mod voxelize;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use ground::WorldGround;
pub use scene::draw;
use scene::solid::Solid;
use scene::{Background, BevLayout, BoxId, Class, SceneBox, ThingId};

/// A point where a ray met the world.
#[derive(Clone, Copy, Debug)]
pub struct WorldHit {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// Class of the surface that was hit.
    pub class: Class,
    /// Index of the solid that was hit; `None` for the ground.
    pub solid: Option<u32>,
}

/// Properties of a point of a surface, as far as the world knows them.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Outward unit normal.
    pub normal: DVec3,
    /// Number of the thing it belongs to: the same for all solids of one object. 0 is the ground.
    pub instance: u32,
    /// Number of the solid within the object, in the order of `objects.rs`; 0 for all others.
    pub part: u8,
}

/// A sphere around a solid: a cheap test that most rays through the solid's bin fail.
#[derive(Clone, Copy)]
struct Sphere {
    center: DVec3,
    radius_squared: f64,
}

impl Sphere {
    fn around(solid: &Solid) -> Self {
        Self {
            center: solid.center,
            radius_squared: solid.reach().length_squared() * (1.0 + 1e-9) + 1e-9,
        }
    }

    /// False if the ray passes it, or meets it only beyond `limit`; `dir` is a unit vector.
    fn is_met(&self, origin: DVec3, dir: DVec3, limit: f64) -> bool {
        let to = self.center - origin;
        let along = to.dot(dir);
        let aside_squared = to.length_squared() - along * along;
        let left = self.radius_squared - aside_squared;
        // Half the chord inside the sphere is the root of `left`.
        left >= 0.0 && (along >= 0.0 || along * along <= left) && {
            let early = along - limit;
            early <= 0.0 || early * early <= left
        }
    }
}

const BIN_M: f64 = 4.0;
const BINS: usize = 20;
/// Bit set in the instance numbers of background things, so that a bush never has the number of a car.
const THING_BIT: u32 = 1 << 31;

/// A driving world of 80 x 80 m in the ego frame. The ego vehicle stands at the origin, the ground there is at z = 0.
pub struct World {
    /// Roads and everything painted, and the height of the ground.
    pub layout: BevLayout,
    /// Objects.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// Scenery.
    pub background: Background,
    solids: Vec<Solid>,
    spheres: Vec<Sphere>,   // around each solid
    owners: Vec<(u32, u8)>, // instance and part of each solid
    bins: Vec<Vec<u32>>,    // [x][y] of 4 m, indices of solids that reach in
    ground: WorldGround,
    seed: u64,
}

impl World {
    /// The world of `seed` on a layout with these boxes: its background is drawn from the seed.
    pub fn new(layout: BevLayout, boxes: BTreeMap<BoxId, SceneBox>, seed: u64) -> Self {
        let background = scenery::background(&layout, &boxes, seed);
        Self::with_background(layout, boxes, background, seed)
    }

    /// A world of these parts; the seed draws details of objects and ground.
    pub fn with_background(
        layout: BevLayout,
        boxes: BTreeMap<BoxId, SceneBox>,
        background: Background,
        seed: u64,
    ) -> Self {
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
        let ground = WorldGround::new(&layout, seed);
        for thing in background.iter() {
            thing.solids(&|p| ground.height_m(p), &mut solids);
            owners.resize(solids.len(), (THING_BIT | thing.id.0, 0));
        }
        let mut bins = vec![Vec::new(); BINS * BINS];
        let bin = |v: f64| ((v + 40.0) / BIN_M).floor();
        let last = BINS as f64 - 1.0;
        for (i, s) in solids.iter().enumerate() {
            let (lo, hi) = (s.center - s.reach(), s.center + s.reach());
            let range = |axis: usize| {
                (bin(lo[axis]).max(0.0) as usize)..(bin(hi[axis]).clamp(-1.0, last) + 1.0) as usize
            };
            for x in range(0) {
                for y in range(1) {
                    bins[x * BINS + y].push(i as u32);
                }
            }
        }
        Self {
            layout,
            boxes,
            background,
            spheres: solids.iter().map(Sphere::around).collect(),
            solids,
            owners,
            bins,
            ground,
            seed,
        }
    }

    /// The world of `seed` on a varied template and terrain with ordinary traffic.
    pub fn random(seed: u64) -> Self {
        let mut layout = template::any_layout(seed);
        layout.relief = terrain::Terrain::drawn(seed).relief(&layout, seed);
        let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
        Self::new(layout, boxes, seed)
    }

    /// The world of `seed` on a varied template with ordinary traffic, on level ground.
    pub fn random_level(seed: u64) -> Self {
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
    pub fn surface(&self, hit: &WorldHit, p: DVec3) -> SurfacePoint {
        let solid = hit
            .solid
            .and_then(|i| self.solids.get(i as usize).zip(self.owners.get(i as usize)));
        match solid {
            Some((solid, &(instance, part))) => SurfacePoint {
                normal: solid.normal(p),
                instance,
                part,
            },
            None => SurfacePoint {
                normal: self.layout.relief.normal(p.truncate()),
                instance: 0,
                part: 0,
            },
        }
    }

    /// The thing of the background that an instance of a [`SurfacePoint`] is, if it is one.
    pub fn thing_of(instance: u32) -> Option<ThingId> {
        (instance & THING_BIT != 0).then_some(ThingId(instance & !THING_BIT))
    }

    /// Class of the ground in a column.
    pub fn ground_class(&self, x: usize, y: usize) -> Class {
        self.ground.class(x, y)
    }

    /// Height of the ground at a point of the ego frame, m.
    pub fn ground_height(&self, p: DVec2) -> f64 {
        self.ground.height_m(p)
    }

    /// The first surface along a ray of the ego frame within `max_range_m`; `dir` is a unit vector.
    pub fn cast(&self, origin: DVec3, dir: DVec3, max_range_m: f64) -> Option<WorldHit> {
        let flat = self
            .ground
            .cast_flat(origin, dir)
            .filter(|h| h.range_m <= max_range_m);
        let mut best = flat.map_or(max_range_m, |h| h.range_m);
        let mut hit = flat;
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
        let mut entered = 0.0;
        for _ in 0..2 * BINS + 2 {
            if !(0..BINS as i64).contains(&x) || !(0..BINS as i64).contains(&y) {
                break;
            }
            let bin = x as usize * BINS + y as usize;
            for &i in &self.bins[bin] {
                if !self.spheres[i as usize].is_met(origin, dir, best) {
                    continue;
                }
                let s = &self.solids[i as usize];
                if let Some(t) = s.enter(origin, dir, best)
                    && t < best
                {
                    best = t;
                    hit = Some(WorldHit {
                        range_m: t,
                        class: s.class,
                        solid: Some(i),
                    });
                }
            }
            let (tx, ty) = (next(x, origin.x, dir.x, inv.x), next(y, origin.y, dir.y, inv.y));
            let leaves = tx.min(ty).min(best);
            if let Some(ground) = self.ground.cast_in_bin(bin, origin, dir, entered, leaves)
                && ground.range_m < best
            {
                best = ground.range_m;
                hit = Some(ground);
            }
            entered = tx.min(ty);
            if best < entered {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The walk over bins must find what testing every solid finds.
    #[test]
    fn cast_equals_brute_force() {
        let world = World::new(template::any_layout(5), BTreeMap::new(), 5);
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
                .ground
                .cast_flat(origin, dir)
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
