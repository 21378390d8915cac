//! The town around a scene as a LiDAR sees it: roads that leave the grid continue, lined like those at the edge, with
//! blocks between them. Without it every pulse that leaves the grid would have no echo, which real sweeps do not show
//! (`real_statistics.md`, section 3: a hundredth of the echoes come from beyond 49 to 71 m).

use glam::{DVec2, DVec3};

use crate::beyond::border::{Border, Covered};
use crate::beyond::plots;
use crate::beyond::road_exits::{Exit, exits};
use scene::solid::Solid;
use scene::{Class, Polyline, VoxelGrid};
use world::World;

/// How far the continuation reaches from the edge, m.
pub const REACH_M: f64 = 88.0;
/// How far its bare ground reaches from the edge, m.
const GROUND_REACH_M: f64 = 216.0;
/// Edge of a bin of solids, m.
const BIN_M: f64 = 8.0;
/// First instance number of the continuation: boxes have lower numbers, scenery of the world has the upper half.
const INSTANCES: u32 = 1 << 30;
/// Ground that varies by more than this is searched along the ray, m.
const FLAT_M: f64 = 0.6;
/// Step of that search, m.
const STEP_M: f64 = 3.0;
/// The seed of the continuation of a scene that has none.
pub const SCENE_SEED: u64 = 0x6ac4_d0b1;

/// A surface beyond the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// Class of the surface.
    pub class: Class,
    /// Outward unit normal.
    pub normal: DVec3,
    /// Number of the house, tree or car, never 0; 0 for the ground.
    pub instance: u32,
    /// Which of the thing's solids.
    pub part: u8,
    /// Index of the solid that was hit, which tells a window from a lamp post; `None` for the ground.
    pub solid: Option<u32>,
}

/// Solids of the continuation, each with its owner and part.
#[derive(Default)]
pub(super) struct BackdropSolids {
    /// The solids.
    pub solids: Vec<Solid>,
    /// Number of the thing that each solid belongs to, and the solid's number within the thing.
    pub owners: Vec<(u32, u8)>,
    things: u32,
}

impl BackdropSolids {
    /// Takes the solids added since the last call as one thing.
    pub fn close(&mut self) {
        let first = self.owners.len();
        let owner = |i: usize| (INSTANCES + self.things, (i - first).min(255) as u8);
        self.owners.extend((first..self.solids.len()).map(owner));
        self.things += 1;
    }
}

/// The continuation of one scene beyond the grid.
pub struct Backdrop {
    border: Border,
    exits: Vec<Exit>,
    things: BackdropSolids,
    /// Rectangle that the continuation reaches.
    reached: Covered,
    /// Bins along x and y.
    along: [usize; 2],
    bins: Vec<Vec<u32>>, // [x][y] of 8 m
    top_m: f64,
    heights_m: [f64; 2],
}

impl Backdrop {
    /// The continuation of a procedural world.
    pub fn of_world(world: &World) -> Self {
        Self::new(Border::of_world(world), &world.layout.polylines, world.seed())
    }

    /// The continuation of a voxel grid; `lift_m` is the height by which labels put the ground too low.
    pub fn of_grid(grid: &VoxelGrid, lift_m: f64) -> Self {
        Self::new(Border::of_grid(grid, lift_m), &[], SCENE_SEED)
    }

    /// Draws up what lies beyond an edge. `lines` are those of the layout, for the directions of lanes; without any the
    /// direction of a road comes from its ground.
    pub fn new(border: Border, lines: &[Polyline], seed: u64) -> Self {
        let (mut things, mut found) = (BackdropSolids::default(), Vec::new());
        if !border.is_empty() {
            found = exits(&border, lines);
            plots::draw_up(&border, &found, seed, &mut things);
        }
        let reached = border.covered().wider(REACH_M);
        let along = ((reached.high - reached.low) / BIN_M).to_array();
        let along = along.map(|n| (n.ceil() as usize).max(1));
        let mut bins = vec![Vec::new(); along[0] * along[1]];
        let bin = |v: DVec3, axis: usize| {
            (((v[axis] - reached.low[axis]) / BIN_M).max(0.0) as usize).min(along[axis] - 1)
        };
        let mut top_m = f64::NEG_INFINITY;
        for (i, solid) in things.solids.iter().enumerate() {
            let (low, high) = (solid.center - solid.reach(), solid.center + solid.reach());
            top_m = f64::max(top_m, high.z);
            for x in bin(low, 0)..=bin(high, 0) {
                for y in bin(low, 1)..=bin(high, 1) {
                    bins[x * along[1] + y].push(i as u32);
                }
            }
        }
        let heights_m = border.heights_m();
        Self {
            border,
            exits: found,
            things,
            reached,
            along,
            bins,
            top_m: top_m.max(heights_m[1]),
            heights_m,
        }
    }

    /// The edge that it was drawn up from.
    pub fn border(&self) -> &Border {
        &self.border
    }

    /// Gives that edge back.
    pub fn into_border(self) -> Border {
        self.border
    }

    /// The roads that leave the grid.
    pub fn exits(&self) -> &[Exit] {
        &self.exits
    }

    /// A solid that [`cast`](Self::cast) named.
    pub fn solid(&self, index: u32) -> Option<&Solid> {
        self.things.solids.get(index as usize)
    }

    /// The first surface beyond the grid along a ray that meets nothing inside it; `dir` is a unit vector.
    pub fn cast(&self, origin: DVec3, dir: DVec3, max_range_m: f64) -> Option<Behind> {
        if !(origin.is_finite() && dir.is_finite() && self.heights_m[0].is_finite()) {
            return None;
        }
        let out_m = self.border.covered().left_by(origin, dir);
        // NaN is not within.
        let within = out_m < max_range_m;
        if !within || (dir.z >= 0.0 && origin.z + dir.z * out_m > self.top_m) {
            return None;
        }
        let mut best = self.ground(origin, dir, out_m, max_range_m);
        let limit = best.map_or(max_range_m, |b| b.range_m);
        if let Some((range_m, i)) = self.first_solid(origin, dir, out_m, limit) {
            let (solid, (instance, part)) = (&self.things.solids[i as usize], self.things.owners[i as usize]);
            best = Some(Behind {
                range_m,
                class: solid.class,
                normal: solid.normal(origin + dir * range_m),
                instance,
                part,
                solid: Some(i),
            });
        }
        best
    }

    /// Walks the bins under the ray from where it leaves the grid.
    fn first_solid(&self, origin: DVec3, dir: DVec3, out_m: f64, limit: f64) -> Option<(f64, u32)> {
        let (low, [along_x, along_y]) = (self.reached.low, self.along);
        let from = ((origin + dir * out_m).truncate() - low) / BIN_M;
        let (mut x, mut y) = (from.x.floor() as i64, from.y.floor() as i64);
        let next = |cell: i64, low: f64, o: f64, d: f64| match d == 0.0 {
            true => f64::INFINITY,
            false => ((cell + i64::from(d > 0.0)) as f64 * BIN_M + low - o) / d,
        };
        let (mut best, mut found) = (limit, None);
        let mut entered_m = out_m;
        for _ in 0..along_x + along_y + 2 {
            let inside = (0..along_x as i64).contains(&x) && (0..along_y as i64).contains(&y);
            if !inside || entered_m > best || (dir.z > 0.0 && origin.z + dir.z * entered_m > self.top_m) {
                break;
            }
            for &i in &self.bins[x as usize * along_y + y as usize] {
                if let Some(t) = self.things.solids[i as usize].enter(origin, dir, best)
                    && t < best
                    && t > out_m
                {
                    (best, found) = (t, Some(i));
                }
            }
            let (tx, ty) = (next(x, low.x, origin.x, dir.x), next(y, low.y, origin.y, dir.y));
            entered_m = tx.min(ty);
            if tx < ty {
                x += dir.x.signum() as i64;
            } else {
                y += dir.y.signum() as i64;
            }
        }
        found.map(|i| (best, i))
    }

    fn ground(&self, origin: DVec3, dir: DVec3, out_m: f64, max_range_m: f64) -> Option<Behind> {
        let height_m = |t: f64| self.border.height_m((origin + dir * t).truncate());
        let range_m = if self.heights_m[1] - self.heights_m[0] > FLAT_M {
            // The first step that ends under the ground, halved until it is a centimetre.
            let under = |t: f64| origin.z + dir.z * t <= height_m(t);
            let steps = ((max_range_m - out_m) / STEP_M).ceil().min(200.0) as usize;
            let mut above_m = out_m + 1e-6;
            let below = (1..=steps).map(|i| out_m + STEP_M * i as f64).find(|t| {
                let found = under(*t);
                above_m = if found { above_m } else { *t };
                found
            });
            let mut below_m = below?;
            for _ in 0..9 {
                let middle = (above_m + below_m) / 2.0;
                *(if under(middle) { &mut below_m } else { &mut above_m }) = middle;
            }
            below_m
        } else {
            if dir.z >= -1e-6 {
                return None;
            }
            let flat = |height_m: f64| (height_m - origin.z) / dir.z;
            let mut t = flat(self.heights_m[0]).max(out_m);
            for _ in 0..2 {
                t = flat(height_m(t)).max(out_m);
            }
            t
        };
        let p = origin + dir * range_m;
        if !(range_m <= max_range_m && self.border.covered().out_m(p.truncate()) < GROUND_REACH_M) {
            return None;
        }
        let class = self.ground_class(p.truncate())?;
        Some(Behind {
            range_m,
            class,
            normal: DVec3::Z,
            instance: 0,
            part: 0,
            solid: None,
        })
    }

    /// Ground at a point beyond the grid: the roads and their sidewalks, terrain between. `None` where the edge is
    /// unknown.
    pub fn ground_class(&self, p: DVec2) -> Option<Class> {
        let on = self.exits.iter().filter_map(|exit| exit.ground(p));
        let best = on.min_by_key(|class| u8::from(*class != Class::DriveableSurface));
        if best.is_some() {
            return best;
        }
        let nearest = self.border.nearest_ground(p);
        match nearest {
            Class::Free => None,
            // The ground at the edge continues for a few metres, so that a road along the edge is not cut off.
            _ if self.border.covered().out_m(p) < 3.0 => Some(nearest),
            _ => Some(Class::Terrain),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::voxelize::{Vertical, complete};

    /// All hits lie beyond the grid and within range; rays of any kind are survived.
    #[test]
    fn hits_lie_beyond_the_grid() {
        let world = World::random(4);
        let voxels = complete(&world, Vertical::Occ3d);
        for backdrop in [Backdrop::of_world(&world), Backdrop::of_grid(&voxels, 0.6)] {
            let origin = DVec3::new(0.9, 0.0, 1.84);
            let (mut found, mut things, mut far) = (0, 0, 0);
            for i in 0..4000 {
                let (a, z) = (f64::from(i) * 0.0157, f64::from(i % 37) * 0.01 - 0.06);
                let dir = DVec3::new(a.cos(), a.sin(), z).normalize();
                let hit = backdrop.cast(origin, dir, 90.0);
                assert_eq!(hit, backdrop.cast(origin, dir, 90.0));
                let Some(hit) = hit else { continue };
                let p = origin + dir * hit.range_m;
                assert!(p.truncate().abs().max_element() >= 40.0 - 1e-9 && hit.range_m <= 90.0);
                assert!((hit.normal.length() - 1.0).abs() < 1e-9 && hit.class != Class::Free);
                assert_eq!(hit.instance == 0, hit.solid.is_none());
                found += 1;
                things += usize::from(hit.instance > 0);
                far += usize::from(hit.range_m > 60.0);
            }
            assert!(found > 1000 && things > 500 && far > 50, "{found} {things} {far}");
            for bad in [DVec3::ZERO, DVec3::splat(f64::NAN), DVec3::Z, -DVec3::Z] {
                let hit = backdrop.cast(origin, bad, 90.0);
                assert!(hit.is_none_or(|h| h.range_m.is_finite()));
                assert!(
                    backdrop
                        .cast(bad * f64::INFINITY, DVec3::X, 90.0)
                        .is_none_or(|h| h.range_m.is_finite())
                );
            }
        }
        let nothing = Backdrop::of_grid(&VoxelGrid::new(), 0.0);
        assert_eq!(nothing.cast(DVec3::Z, DVec3::new(0.8, 0.0, -0.1), 90.0), None);
    }

    /// Where a road leaves the grid, there is road beyond it, and nothing but cars stands on it.
    #[test]
    fn roads_go_on() {
        let (mut roads, mut cars) = (0, 0);
        for seed in 0..12 {
            let backdrop = Backdrop::of_world(&World::random(seed));
            for exit in backdrop.exits() {
                roads += 1;
                for far_m in [1.0, 15.0, 40.0] {
                    let p = exit.at + exit.heading * far_m;
                    if p.abs().max_element() > 40.5 {
                        assert_eq!(
                            backdrop.ground_class(p),
                            Some(Class::DriveableSurface),
                            "{exit:?}"
                        );
                    }
                }
            }
            for solid in &backdrop.things.solids {
                assert!(solid.center.truncate().abs().max_element() > 40.0, "{solid:?}");
                let ground = backdrop.ground_class(solid.center.truncate());
                let on_road = ground == Some(Class::DriveableSurface);
                cars += usize::from(solid.class == Class::Car);
                assert!(
                    !on_road || solid.class == Class::Car || solid.center.z > 1.5,
                    "{solid:?}"
                );
            }
        }
        assert!(roads > 12 && cars > 20, "{roads} {cars}");
    }

    /// On a slope the ground is met where it lies.
    #[test]
    fn a_slope_is_met_at_its_height() {
        let mut grid = VoxelGrid::new();
        for x in 0..200 {
            for y in 0..200 {
                grid.set(x, y, x / 20, Class::Terrain.id());
            }
        }
        let backdrop = Backdrop::of_grid(&grid, 0.0);
        let (origin, dir) = (DVec3::new(0.0, 0.0, 6.0), DVec3::new(1.0, 0.0, -0.05).normalize());
        let hit = backdrop.ground(
            origin,
            dir,
            backdrop.border().covered().left_by(origin, dir),
            100.0,
        );
        let hit = hit.expect("the ground");
        let p = origin + dir * hit.range_m;
        assert!((p.z - 3.0).abs() < 0.1, "{p}"); // the top of bin 9
    }
}
