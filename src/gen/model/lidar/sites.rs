//! Which voxels the sparse network works on, and who is whose neighbour: sorted unique keys, tables of site numbers.
//! Twin of the first half of training/models/lidar.py.

use rayon::prelude::*;

use crate::scene::{Class, GridSpec, VoxelGrid};

/// How far the ground lies below its place in labels, and how far everything else is smeared down, in bins
/// (`real_statistics.md`, 2.2).
const RAISE: usize = 2;
/// Levels of the network.
pub const LEVELS: usize = 3;
/// Taps of a submanifold convolution.
pub const TAPS: usize = 27;
/// Children of a coarse site.
pub const CHILDREN: usize = 8;
/// Rows of a table that are filled in one piece.
const PIECE: usize = 1024;

/// Labels with the vertical convention of Occ3D undone, `[x][y][z]`: the ground two bins up; of every vertical run of
/// other things the lowest two voxels gone (all but the top, if it has no more).
pub fn physical(grid: &VoxelGrid) -> Vec<u8> {
    let mut out = vec![Class::FREE; GridSpec::VOXELS];
    for (c, to) in out.chunks_exact_mut(GridSpec::NZ).enumerate() {
        let from = grid.column(c / GridSpec::NY, c % GridSpec::NY);
        let is_ground = |label: u8| Class::from_id(label).is_some_and(Class::is_ground);
        let is_thing = |z: usize| z < GridSpec::NZ && from[z] != Class::FREE && !is_ground(from[z]);
        let mut below = 0;
        for z in 0..GridSpec::NZ {
            if !is_thing(z) {
                below = 0;
                continue;
            }
            if below >= RAISE || !is_thing(z + 1) {
                to[z] = from[z];
            }
            below += 1;
        }
        for (z, &label) in from.iter().enumerate() {
            let raised = (z + RAISE).min(GridSpec::NZ - 1);
            if is_ground(label) && to[raised] == Class::FREE {
                to[raised] = label;
            }
        }
    }
    out
}

/// Keys in rising order of the voxels of `[x][y][z]` labels that have a free neighbour: of six, the one below only above
/// bin 3, since nothing looks at a building from underground.
pub fn surface(labels: &[u8]) -> Vec<u32> {
    let (nx, ny, nz) = (GridSpec::NX, GridSpec::NY, GridSpec::NZ);
    let free = |x: usize, y: usize, z: usize| labels[(x * ny + y) * nz + z] == Class::FREE;
    let column = |c: usize| {
        let (x, y) = (c / ny, c % ny);
        let at_edge = x == 0 || y == 0 || x + 1 == nx || y + 1 == ny;
        (0..nz).filter_map(move |z| {
            let shows = || {
                at_edge
                    || free(x - 1, y, z)
                    || free(x + 1, y, z)
                    || free(x, y - 1, z)
                    || free(x, y + 1, z)
                    || z + 1 == nz
                    || free(x, y, z + 1)
                    || (z > RAISE + 1 && free(x, y, z - 1))
            };
            (!free(x, y, z) && shows()).then_some((c * nz + z) as u32)
        })
    };
    (0..nx * ny).flat_map(column).collect()
}

/// One level: sites in rising order of their keys, and tables of their neighbours' numbers; the number of sites stands
/// for a neighbour that is not there.
pub struct Level {
    /// Places along each axis.
    pub shape: [usize; 3],
    /// Keys, (x * ny + y) * nz + z.
    pub keys: Vec<u32>,
    /// `[site][27]`, tap (dx, dy, dz) with dz fastest.
    pub around: Vec<u32>,
    /// `[site][8]`: sites of the finer level by corner (x, y, z), z fastest; empty at the finest.
    pub children: Vec<u32>,
    /// `[site][8]`: the coarse site above, at the place of the corner that this one is; empty at the coarsest.
    pub parent: Vec<u32>,
}

impl Level {
    fn new(shape: [usize; 3], keys: Vec<u32>) -> Self {
        let volume = Volume::new(shape, &keys);
        let mut around = vec![0; keys.len() * TAPS];
        around
            .par_chunks_mut(PIECE * TAPS)
            .zip(keys.par_chunks(PIECE))
            .for_each(|(around, keys)| {
                for (row, key) in around.chunks_exact_mut(TAPS).zip(keys) {
                    let at = volume.place(*key);
                    for (tap, site) in row.iter_mut().enumerate() {
                        let steps = volume.steps;
                        let place = at + tap / 9 * steps[0] + tap / 3 % 3 * steps[1] + tap % 3;
                        *site = volume.sites[place - steps[0] - steps[1] - 1];
                    }
                }
            });
        Self {
            shape,
            keys,
            around,
            children: Vec::new(),
            parent: Vec::new(),
        }
    }

    /// Coordinates of a key.
    pub fn place(shape: [usize; 3], key: u32) -> [usize; 3] {
        let key = key as usize;
        [
            key / (shape[1] * shape[2]),
            key / shape[2] % shape[1],
            key % shape[2],
        ]
    }
}

/// Site number of every voxel, one voxel of border around.
pub struct Volume {
    shape: [usize; 3],
    /// Places from one x to the next and from one y to the next.
    pub steps: [usize; 2],
    /// Numbers; the number of sites where there is none.
    pub sites: Vec<u32>,
}

impl Volume {
    /// Of sites in this order.
    pub fn new(shape: [usize; 3], keys: &[u32]) -> Self {
        let steps = [(shape[1] + 2) * (shape[2] + 2), shape[2] + 2];
        let mut volume = Self {
            shape,
            steps,
            sites: vec![keys.len() as u32; (shape[0] + 2) * steps[0]],
        };
        for (site, key) in keys.iter().enumerate() {
            let place = volume.place(*key);
            volume.sites[place] = site as u32;
        }
        volume
    }

    fn place(&self, key: u32) -> usize {
        let [x, y, z] = Level::place(self.shape, key);
        (x + 1) * self.steps[0] + (y + 1) * self.steps[1] + z + 1
    }
}

/// Sites of all levels.
pub struct Sites {
    /// Finest first; each half as fine as the one before.
    pub levels: [Level; LEVELS],
}

impl Sites {
    /// Of these voxels of a grid of `shape`; duplicates count once, keys beyond the grid not at all.
    pub fn new(shape: [usize; 3], mut keys: Vec<u32>) -> Self {
        let end = shape.iter().product::<usize>() as u32;
        keys.retain(|k| *k < end);
        keys.sort_unstable();
        keys.dedup();
        let mut fine = Level::new(shape, keys);
        let levels = std::array::from_fn(|level| {
            if level + 1 < LEVELS {
                let coarse = coarser(&mut fine);
                std::mem::replace(&mut fine, coarse)
            } else {
                std::mem::replace(&mut fine, Level::new([1; 3], Vec::new()))
            }
        });
        Self { levels }
    }
}

/// The next level; fills the parents of `fine`.
fn coarser(fine: &mut Level) -> Level {
    let shape = fine.shape.map(|n| n.div_ceil(2));
    let above = |key: u32| {
        let [x, y, z] = Level::place(fine.shape, key);
        let corner = (x % 2) * 4 + (y % 2) * 2 + z % 2;
        ((((x / 2) * shape[1] + y / 2) * shape[2] + z / 2) as u32, corner)
    };
    let mut keys: Vec<u32> = fine.keys.iter().map(|k| above(*k).0).collect();
    keys.sort_unstable();
    keys.dedup();
    let mut coarse = Level::new(shape, keys);
    coarse.children = vec![fine.keys.len() as u32; coarse.keys.len() * CHILDREN];
    fine.parent = vec![coarse.keys.len() as u32; fine.keys.len() * CHILDREN];
    for (site, key) in fine.keys.iter().enumerate() {
        let (parent_key, corner) = above(*key);
        if let Ok(parent) = coarse.keys.binary_search(&parent_key) {
            fine.parent[site * CHILDREN + corner] = parent as u32;
            coarse.children[parent * CHILDREN + corner] = site as u32;
        }
    }
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertical_convention_is_undone() {
        let mut grid = VoxelGrid::new();
        let (road, car, kerb) = (
            Class::DriveableSurface.id(),
            Class::Car.id(),
            Class::Sidewalk.id(),
        );
        grid.set(3, 4, 0, road);
        // A thing in bins 4 and 5, smeared to 2 and 3, above the road.
        grid.set(5, 5, 0, road);
        (2..6).for_each(|z| grid.set(5, 5, z, car));
        grid.set(7, 7, 1, kerb);
        grid.set(8, 8, 9, car); // a single painted voxel stays
        let labels = physical(&grid);
        let at = |x: usize, y: usize, z: usize| labels[(x * 200 + y) * 16 + z];
        assert_eq!((at(3, 4, 2), at(3, 4, 0)), (road, Class::FREE));
        let column: Vec<u8> = (0..7).map(|z| at(5, 5, z)).collect();
        assert_eq!(column, [17, 17, road, 17, car, car, 17]);
        assert_eq!((at(7, 7, 3), at(8, 8, 9)), (kerb, car));
        assert_eq!(labels.iter().filter(|l| **l != Class::FREE).count(), 6);
    }

    #[test]
    fn what_is_enclosed_is_left_out() {
        let mut labels = vec![Class::FREE; GridSpec::VOXELS];
        for x in 10..15 {
            for y in 10..15 {
                (2..8).for_each(|z| labels[(x * 200 + y) * 16 + z] = Class::Manmade.id());
            }
        }
        // 25 columns of 6, without the 3x3 core of bins 2 to 6.
        assert_eq!(surface(&labels).len(), 25 * 6 - 9 * 5);
    }

    #[test]
    fn parents_and_children_agree() {
        let sites = Sites::new([6, 6, 4], vec![0, 1, 143, 143, 70, 9999]);
        assert_eq!(sites.levels[0].keys, [0, 1, 70, 143]);
        for [fine, coarse] in [[0, 1], [1, 2]] {
            let (fine, coarse) = (&sites.levels[fine], &sites.levels[coarse]);
            let children = coarse
                .children
                .iter()
                .filter(|c| (**c as usize) < fine.keys.len());
            assert_eq!(children.count(), fine.keys.len());
        }
        assert!(Sites::new([200, 200, 16], Vec::new()).levels[2].keys.is_empty());
    }
}
