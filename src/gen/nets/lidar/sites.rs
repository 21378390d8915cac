//! Sites of the sparse network: the voxels that it works on and their neighbours, as sorted unique keys and tables of
//! site numbers. Twin of the first half of training/models/lidar.py.

use rayon::prelude::*;

use nn::rules::RuleBook;
use scene::{Class, VoxelGrid, Window};

/// How far the ground lies below its place in labels, and how far everything else is smeared down, in bins
/// (`real_statistics.md`, 2.2).
const RAISE: usize = 2;
/// Levels of the network.
pub const LEVELS: usize = 3;
/// Taps of a submanifold convolution.
pub const TAPS: usize = 27;
/// Children of a coarse site.
pub const CHILDREN: usize = 8;
/// Columns that are worked on in one piece.
const PIECE: usize = 1024;

/// Labels with the vertical convention of Occ3D undone, `[x][y][z]`: the ground two bins up; of every vertical run of
/// other things the lowest two voxels gone (all but the top, if it has no more).
pub fn physical(grid: &VoxelGrid) -> Vec<u8> {
    let mut out = vec![Class::FREE; Window::VOXELS];
    let kinds: [SiteKind; 256] = std::array::from_fn(|label| match Class::from_id(label as u8) {
        _ if label == usize::from(Class::FREE) => SiteKind::Free,
        Some(class) if class.is_ground() => SiteKind::Ground,
        _ => SiteKind::Thing,
    });
    out.par_chunks_mut(Window::NY * Window::NZ)
        .enumerate()
        .for_each(|(x, slice)| {
            for (y, to) in slice.chunks_exact_mut(Window::NZ).enumerate() {
                raise(grid.window_column(x, y), to, &kinds);
            }
        });
    out
}

#[derive(Clone, Copy, PartialEq)]
enum SiteKind {
    Free,
    Ground,
    Thing,
}

fn raise(from: &[u8; Window::NZ], to: &mut [u8], kinds: &[SiteKind; 256]) {
    let kind = |z: usize| kinds[usize::from(from[z])];
    let mut below = 0;
    for z in 0..Window::NZ {
        if kind(z) != SiteKind::Thing {
            below = 0;
            continue;
        }
        if below >= RAISE || z + 1 == Window::NZ || kind(z + 1) != SiteKind::Thing {
            to[z] = from[z];
        }
        below += 1;
    }
    for (z, &label) in from.iter().enumerate() {
        let raised = (z + RAISE).min(Window::NZ - 1);
        if kind(z) == SiteKind::Ground && to[raised] == Class::FREE {
            to[raised] = label;
        }
    }
}

/// Keys, in rising order, of the voxels of `[x][y][z]` labels that have a free neighbour. Of the six neighbours the one
/// below counts only above bin 3, since no sensor looks at a building from underground.
pub fn surface(labels: &[u8]) -> Vec<u32> {
    let (nx, ny, nz) = (Window::NX, Window::NY, Window::NZ);
    // Bit z of a column is a voxel that is not free.
    let solid: Vec<u16> = labels
        .par_chunks_exact(nz)
        .with_min_len(PIECE)
        .map(|column| {
            let bits = column.iter().enumerate();
            bits.fold(0, |bits, (z, l)| bits | u16::from(*l != Class::FREE) << z)
        })
        .collect();
    let slice = |x: usize| {
        let solid = &solid;
        (0..ny).flat_map(move |y| {
            let c = x * ny + y;
            let own = solid[c];
            let mut shows = if x == 0 || y == 0 || x + 1 == nx || y + 1 == ny {
                own
            } else {
                own & !(solid[c - ny] & solid[c + ny] & solid[c - 1] & solid[c + 1])
            };
            // Above it; below it only above bin RAISE + 1.
            shows |= own & !(own >> 1);
            shows |= own & !(own << 1) & (u16::MAX << (RAISE + 2));
            (0..nz)
                .filter(move |z| shows >> z & 1 == 1)
                .map(move |z| (c * nz + z) as u32)
        })
    };
    let slices: Vec<Vec<u32>> = (0..nx).into_par_iter().map(|x| slice(x).collect()).collect();
    slices.concat()
}

/// One level: sites in rising order of their keys, and the rule books of their neighbours.
pub struct SiteLevel {
    /// Places along each axis.
    pub shape: [usize; 3],
    /// Keys, (x * ny + y) * nz + z.
    pub keys: Vec<u32>,
    /// Site numbers by place.
    pub volume: Volume,
    /// 27 taps (dx, dy, dz) with dz fastest.
    pub around: RuleBook,
    /// 8 taps: sites of the finer level by corner (x, y, z), z fastest; no rows at the finest.
    pub children: RuleBook,
    /// 8 taps: the coarse site above, at the corner that this one is; no rows at the coarsest.
    pub parent: RuleBook,
}

impl SiteLevel {
    fn new(shape: [usize; 3], keys: Vec<u32>) -> Self {
        let volume = Volume::new(shape, &keys);
        let places: Vec<u32> = keys.iter().map(|k| volume.place(*k) as u32).collect();
        let first = volume.steps[0] + volume.steps[1] + 1;
        let steps: [usize; TAPS] =
            std::array::from_fn(|tap| tap / 9 * volume.steps[0] + tap / 3 % 3 * volume.steps[1] + tap % 3);
        let around = RuleBook::new(keys.len(), TAPS, keys.len(), |row, tap| {
            volume.sites[places[row] as usize - first + steps[tap]]
        });
        Self {
            shape,
            keys,
            volume,
            around,
            children: RuleBook::none(),
            parent: RuleBook::none(),
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
    /// Site numbers; the number of sites where there is none.
    pub sites: Vec<u32>,
}

impl Volume {
    /// Site numbers for these keys, in their order.
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
        let [x, y, z] = SiteLevel::place(self.shape, key);
        (x + 1) * self.steps[0] + (y + 1) * self.steps[1] + z + 1
    }
}

impl Volume {
    fn at(&self, [x, y, z]: [usize; 3]) -> u32 {
        self.sites[(x + 1) * self.steps[0] + (y + 1) * self.steps[1] + z + 1]
    }
}

/// Sites of all levels.
pub struct Sites {
    /// Finest first; each half as fine as the one before.
    pub levels: [SiteLevel; LEVELS],
}

impl Sites {
    /// Levels for these voxels of a grid of `shape`; duplicates count once, keys beyond the grid are ignored.
    pub fn new(shape: [usize; 3], mut keys: Vec<u32>) -> Self {
        let end = shape.iter().product::<usize>() as u32;
        keys.retain(|k| *k < end);
        keys.sort_unstable();
        keys.dedup();
        let mut fine = SiteLevel::new(shape, keys);
        let levels = std::array::from_fn(|level| {
            if level + 1 < LEVELS {
                let coarse = coarser(&mut fine);
                std::mem::replace(&mut fine, coarse)
            } else {
                std::mem::replace(&mut fine, SiteLevel::new([1; 3], Vec::new()))
            }
        });
        Self { levels }
    }
}

/// The next level; fills the parents of `fine`.
fn coarser(fine: &mut SiteLevel) -> SiteLevel {
    let shape = fine.shape.map(|n| n.div_ceil(2));
    let above = |key: u32| {
        let [x, y, z] = SiteLevel::place(fine.shape, key);
        let corner = (x % 2) * 4 + (y % 2) * 2 + z % 2;
        ([x / 2, y / 2, z / 2], corner as u32)
    };
    let mut there = vec![false; shape.iter().product()];
    for key in &fine.keys {
        let [x, y, z] = above(*key).0;
        there[(x * shape[1] + y) * shape[2] + z] = true;
    }
    let keys = (0..there.len() as u32).filter(|k| there[*k as usize]).collect();
    let mut coarse = SiteLevel::new(shape, keys);
    let (sites, fine_sites) = (coarse.keys.len(), fine.keys.len());
    let parents: Vec<[u32; 2]> = fine
        .keys
        .iter()
        .map(|key| {
            let (place, corner) = above(*key);
            [coarse.volume.at(place), corner]
        })
        .collect();
    fine.parent = RuleBook::new(fine_sites, CHILDREN, sites, |row, tap| {
        let [parent, corner] = parents[row];
        if corner == tap as u32 { parent } else { u32::MAX }
    });
    coarse.children = RuleBook::new(sites, CHILDREN, fine_sites, |row, tap| {
        let [x, y, z] = SiteLevel::place(shape, coarse.keys[row]);
        fine.volume
            .at([2 * x + tap / 4, 2 * y + tap / 2 % 2, 2 * z + tap % 2])
    });
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
        let mut labels = vec![Class::FREE; Window::VOXELS];
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
            for tap in 0..CHILDREN {
                let mut children: Vec<[u32; 2]> = coarse.children.pairs(tap).collect();
                children.sort_unstable_by_key(|[_, child]| *child);
                let parents = fine.parent.pairs(tap).map(|[child, parent]| [parent, child]);
                assert_eq!(children, parents.collect::<Vec<_>>());
            }
            let all = (0..CHILDREN)
                .map(|tap| fine.parent.pairs(tap).count())
                .sum::<usize>();
            assert_eq!(all, fine.keys.len());
        }
        assert!(Sites::new([200, 200, 16], Vec::new()).levels[2].keys.is_empty());
    }
}
