//! Light that reaches each voxel: how much of the sky and of the sun, baked on the CPU.
//!
//! Rays of one direction cross the same cells relative to where they start, so a whole column is
//! traced at once: each bin is a bit of a word, and "blocked" is an OR of shifted neighbour columns.

use rayon::prelude::*;

use super::meshing::Solidity;
use super::pool;
use scene::Lattice;

/// Toward the sun, ego frame, unit length: from behind, left and above.
pub const SUN: [f32; 3] = [-0.452, 0.362, 0.815];

/// Farthest that light looks sideways, in columns: a change reaches no farther than this.
pub const REACH: usize = 14;

/// Farthest that light looks up, in bins.
const HEIGHT: isize = Lattice::OCC3D.bins() as isize;
/// Columns up to which no other threads are asked.
const FEW: usize = 64 * 64;
const SUN_RAYS: usize = 8;
const SKY_RAYS: usize = 24;
const SKY_REACH: f64 = 9.0;

/// Sky light of a drawn voxel itself, 0 to 1, where light is interpolated between it and its neighbours.
const SKY_IN_SOLID: f64 = 0.30;

/// Sky and sun, 0 to 255, of every cell in a rectangle of columns.
#[derive(Clone, Debug, PartialEq)]
pub struct LightBlock {
    /// Lower corner, columns.
    pub origin: [usize; 2],
    /// Columns along x and y.
    pub size: [usize; 2],
    /// `[z][y][x]`, a layer per bin.
    pub cells: Vec<[u8; 2]>,
}

/// A step of a ray: columns aside, and bins up.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RayStep {
    aside: [isize; 2],
    dz: u32,
}

/// A step of a ray in a grid: how far its column lies from the start in [`Solidity::padded`], and bins up.
#[derive(Clone, Copy, Debug)]
struct Offset {
    offset: isize,
    dz: u32,
}

/// The rays of both kinds, as steps from a cell's centre.
#[derive(Clone, Debug)]
pub struct LightRays {
    sun: Vec<Vec<RayStep>>,
    sky: Vec<Vec<RayStep>>,
}

impl Default for LightRays {
    fn default() -> Self {
        Self::new()
    }
}

impl LightRays {
    /// Traces the ray directions once.
    pub fn new() -> Self {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let sun_dir = glam::DVec3::from_array(SUN.map(f64::from)).normalize();
        let (side, up) = sun_dir.any_orthonormal_pair();
        let sun = (0..SUN_RAYS).map(|i| {
            // A disc of directions: a sun as wide as a lamp gives edges half a voxel soft.
            let r = 0.11 * ((i as f64 + 0.5) / SUN_RAYS as f64).sqrt();
            let (s, c) = (i as f64 * golden).sin_cos();
            steps(
                (sun_dir + side * (r * c) + up * (r * s)).normalize(),
                f64::INFINITY,
            )
        });
        let sky = (0..SKY_RAYS).map(|i| {
            // Even in solid angle over the upper half, the lowest ring a little above the horizon.
            let z = 0.06 + 0.94 * (i as f64 + 0.5) / SKY_RAYS as f64;
            let (s, c) = (i as f64 * golden).sin_cos();
            let r = (1.0 - z * z).sqrt();
            steps(glam::DVec3::new(r * c, r * s, z), SKY_REACH)
        });
        Self {
            sun: sun.collect(),
            sky: sky.collect(),
        }
    }

    /// Bakes the columns `origin..origin + size`, which must lie in the grid.
    pub fn bake(&self, solid: &Solidity, origin: [usize; 2], size: [usize; 2]) -> LightBlock {
        // One more column on every side, because drawn voxels take the sun of their neighbours.
        let (w, h) = (size[0] + 2, size[1] + 2);
        let stride = solid.stride();
        let [sun, sky] = [&self.sun, &self.sky].map(|rays| offsets(rays, stride));
        let column = |i: usize| {
            // The margin of the padded columns is wide enough for this one and for every ray.
            let at = solid.index(origin[0] + i % w, origin[1] + i / w) - stride - 1;
            ColumnLight {
                own: solid.padded()[at],
                sun: RayCounts::of_column(solid.padded(), &sun, at),
                sky: RayCounts::of_column(solid.padded(), &sky, at),
            }
        };
        // Around an edit in this thread: others would take longer to wake.
        let traced: Vec<ColumnLight> = match w * h {
            0..=FEW => (0..w * h).map(column).collect(),
            _ => pool::run(|| (0..w * h).into_par_iter().with_min_len(64).map(column).collect()),
        };
        let bins = solid.extent().nz();
        let mut cells = vec![[0; 2]; size[0] * size[1] * bins];
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = |dx: usize, dy: usize| &traced[(y + dy) * w + x + dx];
                let around = [at(1, 1), at(0, 1), at(2, 1), at(1, 0), at(1, 2)];
                for z in 0..bins {
                    cells[(z * size[1] + y) * size[0] + x] = cell(around, z, bins);
                }
            }
        }
        LightBlock { origin, size, cells }
    }
}

struct ColumnLight {
    own: u64,
    sun: RayCounts,
    sky: RayCounts,
}

impl ColumnLight {
    fn is_free(&self, z: usize) -> bool {
        self.own >> z & 1 == 0
    }
}

fn cell(around: [&ColumnLight; 5], z: usize, bins: usize) -> [u8; 2] {
    let byte = |v: f64| (v * 255.0).round() as u8;
    let here = around[0];
    if here.is_free(z) {
        let sun = f64::from(here.sun.at(z)) / SUN_RAYS as f64;
        return [byte(f64::from(here.sky.at(z)) / SKY_RAYS as f64), byte(sun)];
    }
    // Without this, the sunny foot of a wall would show a shadow that is not there.
    let (mut sum, mut n) = (0.0, 0.0);
    for column in around.into_iter().filter(|c| c.is_free(z)) {
        sum += f64::from(column.sun.at(z)) / SUN_RAYS as f64;
        n += 1.0;
    }
    for zz in [z.wrapping_sub(1), z + 1] {
        if zz < bins && here.is_free(zz) {
            sum += f64::from(here.sun.at(zz)) / SUN_RAYS as f64;
            n += 1.0;
        }
    }
    [byte(SKY_IN_SOLID), byte(if n > 0.0 { sum / n } else { 0.0 })]
}

/// Offsets of the steps of rays in columns, `stride` apart along x.
fn offsets(rays: &[Vec<RayStep>], stride: usize) -> Vec<Vec<Offset>> {
    let offset = |&RayStep { aside: [dx, dy], dz }: &RayStep| Offset {
        offset: dx * stride as isize + dy,
        dz,
    };
    rays.iter().map(|ray| ray.iter().map(offset).collect()).collect()
}

/// Numbers of rays that reach the end unblocked, of every bin of a column: counters side by side, one bit of each per word.
struct RayCounts([u64; 5]);

impl RayCounts {
    fn of_column(columns: &[u64], rays: &[Vec<Offset>], at: usize) -> Self {
        let mut counters = [0u64; 5];
        for ray in rays {
            let mut blocked = 0u64;
            for step in ray {
                blocked |= columns[at.wrapping_add_signed(step.offset)] >> step.dz;
            }
            // Adding a ray is a carry through five words.
            let mut carry = !blocked;
            for word in &mut counters {
                (*word, carry) = (*word ^ carry, *word & carry);
            }
        }
        Self(counters)
    }

    fn at(&self, z: usize) -> u8 {
        let bits = self.0.iter().enumerate();
        bits.fold(0, |sum, (i, word)| sum | ((word >> z & 1) as u8) << i)
    }
}

/// Cells that a ray from a cell's centre enters, until it is above all that light looks at or `reach` cells away.
fn steps(dir: glam::DVec3, reach: f64) -> Vec<RayStep> {
    let mut cell = [0isize; 3];
    let axis_t = |d: f64| if d == 0.0 { f64::INFINITY } else { 0.5 / d.abs() };
    let mut next = [axis_t(dir.x), axis_t(dir.y), axis_t(dir.z)];
    let mut out = Vec::new();
    loop {
        let axis = (0..3).fold(0, |a, b| if next[b] < next[a] { b } else { a });
        if next[axis] > reach {
            break;
        }
        cell[axis] += if dir[axis] < 0.0 { -1 } else { 1 };
        next[axis] += 1.0 / dir[axis].abs();
        if cell[2] >= HEIGHT || cell[2] < 0 {
            break;
        }
        debug_assert!(cell[0].unsigned_abs() < REACH && cell[1].unsigned_abs() < REACH);
        out.push(RayStep {
            aside: [cell[0], cell[1]],
            dz: cell[2] as u32,
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::Visible;
    use scene::VoxelGrid;

    fn bake(grid: &VoxelGrid, origin: [usize; 2], size: [usize; 2]) -> LightBlock {
        LightRays::new().bake(&Solidity::from_grid(grid, Visible::ALL), origin, size)
    }

    #[test]
    fn an_empty_grid_is_fully_lit() {
        let block = bake(&VoxelGrid::new(), [0, 0], [5, 7]);
        assert_eq!(block.cells.len(), 5 * 7 * 16);
        assert!(block.cells.iter().all(|c| *c == [255, 255]));
    }

    #[test]
    fn a_roof_shades_what_is_below() {
        let mut grid = VoxelGrid::new();
        for x in 80..120 {
            for y in 80..120 {
                grid.set(x, y, 8, 15);
            }
        }
        let block = bake(&grid, [100, 100], [1, 1]);
        assert_eq!(block.cells[2][1], 0, "no sun below");
        let sky = |z: usize| block.cells[z][0];
        assert!(sky(7) < 40, "hardly any sky right below: {}", sky(7));
        assert!(
            sky(7) < sky(2) && sky(2) < sky(9),
            "more of it farther down, and all above"
        );
        assert_eq!(block.cells[9], [255, 255], "all of it above");
    }

    #[test]
    fn changes_reach_no_farther_than_stated() {
        let rays = LightRays::new();
        for step in rays.sun.iter().chain(&rays.sky).flatten() {
            let [dx, dy] = step.aside;
            // One column less, because solid voxels ask their neighbours.
            assert!(
                dx.unsigned_abs() < REACH && dy.unsigned_abs() < REACH,
                "{dx} {dy}"
            );
        }
        const { assert!(REACH < Solidity::MARGIN) };
        let whole = bake(&VoxelGrid::new(), [0, 0], [20, 20]);
        let mut grid = VoxelGrid::new();
        grid.set(10 + REACH + 1, 10, 15, 15);
        let part = bake(&grid, [0, 0], [20, 20]);
        assert!(
            (0..=10).all(|x| part.cells[(14 * 20 + 10) * 20 + x] == whole.cells[(14 * 20 + 10) * 20 + x])
        );
    }

    #[test]
    fn parts_equal_the_whole() {
        let mut grid = VoxelGrid::new();
        for i in 0..60 {
            grid.set(i * 3 % 41, i * 7 % 43, i % 16, 15);
        }
        let whole = bake(&grid, [0, 0], [40, 40]);
        let part = bake(&grid, [16, 16], [16, 16]);
        for z in 0..16 {
            for y in 0..16 {
                for x in 0..16 {
                    let a = whole.cells[(z * 40 + y + 16) * 40 + x + 16];
                    assert_eq!(a, part.cells[(z * 16 + y) * 16 + x]);
                }
            }
        }
    }
}
