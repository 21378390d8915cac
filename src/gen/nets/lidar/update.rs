//! The field after an edit: only voxels within the network's sight of a changed one are computed again, from the voxels
//! within sight of those; all others keep their numbers. The result equals the field of a fresh run, bit for bit.

use super::field::{HIDDEN, SignedDistanceField, SiteFeatures};
use super::prior::SampleDensity;
use super::sites::{SiteLevel, Volume};
use super::{LidarNet, SHAPE, voxels};
use crate::ModelError;
use nn::Ops;
use scene::VoxelGrid;

/// How far along x and y a voxel's numbers depend on others: one voxel and one cell of 2 on the way in and on the way
/// out, four cells of 4 in the middle, and where these cells begin: 17, see `the_sight_is_not_too_short`.
const SIGHT: usize = 17;
/// Edge of the coarsest cells: pieces begin and end between them.
const CELL: usize = 4;
/// Changes of one square of this many columns are looked at together.
const SQUARE: usize = 16;
/// Share of the columns to be computed above which a fresh run costs no more.
const MOST: f64 = 0.6;

/// Columns, half-open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First along x and y.
    pub low: [usize; 2],
    /// One past the last along x and y.
    pub high: [usize; 2],
}

/// Places where a field differs from the one before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Changed {
    /// Anywhere.
    Everywhere,
    /// In these columns only; empty if it is the same.
    In(Vec<Region>),
}

impl Region {
    fn holds(&self, key: u32) -> bool {
        let [x, y, _] = SiteLevel::place(SHAPE, key);
        (self.low[0]..self.high[0]).contains(&x) && (self.low[1]..self.high[1]).contains(&y)
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|a| self.low[a].min(other.low[a])),
            high: std::array::from_fn(|a| self.high[a].max(other.high[a])),
        }
    }

    /// The region grown by the network's sight.
    fn around(&self) -> Self {
        Self {
            low: self.low.map(|v| v.saturating_sub(SIGHT)),
            high: std::array::from_fn(|a| (self.high[a] + SIGHT).min(SHAPE[a])),
        }
    }

    /// The region grown to whole cells of the coarsest level.
    fn whole(&self) -> Self {
        Self {
            low: self.low.map(|v| v / CELL * CELL),
            high: self.high.map(|v| v.next_multiple_of(CELL)),
        }
    }

    fn columns(&self) -> usize {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// Columns that the network works on if this changed.
    fn work(&self) -> usize {
        self.around().around().whole().columns()
    }
}

impl<B: Ops> LidarNet<B> {
    /// Updates a field to a grid, see [`LidarNet::field`].
    pub fn update(&self, field: &mut SignedDistanceField, grid: &VoxelGrid) -> Result<Changed, ModelError> {
        let (keys, classes) = voxels(grid);
        let changed = changed([&field.keys, &keys], [&field.classes, &classes]);
        if changed.is_empty() {
            return Ok(Changed::In(Vec::new()));
        }
        let work: usize = changed.iter().map(Region::work).sum();
        if work as f64 > MOST * (SHAPE[0] * SHAPE[1]) as f64 {
            *field = self.field_of(keys, classes)?;
            return Ok(Changed::Everywhere);
        }
        let again: Vec<Region> = changed.iter().map(Region::around).collect();
        let mut next = kept(field, keys, classes);
        for region in &again {
            let seen = match self.config.unet {
                true => region.around().whole(),
                false => *region,
            };
            let near = |site: &usize| seen.holds(next.keys[*site]);
            let sites: Vec<usize> = (0..next.keys.len()).filter(near).collect();
            let keys: Vec<u32> = sites.iter().map(|s| next.keys[*s]).collect();
            let classes: Vec<u8> = sites.iter().map(|s| next.classes[*s]).collect();
            let mut lines = [keys.len(); 2].map(|n| vec![SiteFeatures([0.0; HIDDEN]); n]);
            let mut planes = vec![[0.0; 4]; keys.len()];
            let [hidden, appearance] = &mut lines;
            self.fill(&keys, &classes, [hidden, appearance], &mut planes)?;
            for (i, site) in sites.iter().enumerate() {
                if region.holds(next.keys[*site]) {
                    next.hidden[*site] = hidden[i];
                    next.appearance[*site] = appearance[i];
                    next.planes[*site] = planes[i];
                }
            }
        }
        *field = next;
        Ok(Changed::In(again))
    }
}

/// Regions around the voxels that differ between the two lists; regions that cost less together are joined.
fn changed([old, new]: [&[u32]; 2], [old_classes, new_classes]: [&[u8]; 2]) -> Vec<Region> {
    let squares = [SHAPE[0].div_ceil(SQUARE), SHAPE[1].div_ceil(SQUARE)];
    let mut found: Vec<Option<Region>> = vec![None; squares[0] * squares[1]];
    let mut differs = |key: u32| {
        let [x, y, _] = SiteLevel::place(SHAPE, key);
        let one = Region {
            low: [x, y],
            high: [x + 1, y + 1],
        };
        let square = &mut found[x / SQUARE * squares[1] + y / SQUARE];
        *square = Some(square.map_or(one, |s| s.join(&one)));
    };
    let (mut i, mut j) = (0, 0);
    while i < old.len() || j < new.len() {
        let (a, b) = (old.get(i), new.get(j));
        match (a, b) {
            (Some(a), Some(b)) if a == b => {
                if old_classes[i] != new_classes[j] {
                    differs(*a);
                }
                (i, j) = (i + 1, j + 1);
            }
            (Some(a), b) if b.is_none_or(|b| a < b) => {
                differs(*a);
                i += 1;
            }
            (_, Some(b)) => {
                differs(*b);
                j += 1;
            }
            _ => break,
        }
    }
    let mut regions: Vec<Region> = found.into_iter().flatten().collect();
    // Joins regions until no two cost less together.
    while let Some((i, j, both)) = cheaper(&regions) {
        regions[i] = both;
        regions.swap_remove(j);
    }
    regions
}

fn cheaper(regions: &[Region]) -> Option<(usize, usize, Region)> {
    (0..regions.len())
        .flat_map(|i| (i + 1..regions.len()).map(move |j| (i, j)))
        .find_map(|(i, j)| {
            let both = regions[i].join(&regions[j]);
            (both.work() <= regions[i].work() + regions[j].work()).then_some((i, j, both))
        })
}

/// The new voxels with the numbers of those that were there before, zeros for the others.
fn kept(old: &SignedDistanceField, keys: Vec<u32>, classes: Vec<u8>) -> SignedDistanceField {
    let n = keys.len() + 1;
    let (mut hidden, mut planes, mut appearance) = (
        Vec::with_capacity(n),
        Vec::with_capacity(n),
        Vec::with_capacity(n),
    );
    let nothing = old.keys.len();
    let mut copy = |from: std::ops::Range<usize>| {
        hidden.extend_from_slice(&old.hidden[from.clone()]);
        planes.extend_from_slice(&old.planes[from.clone()]);
        appearance.extend_from_slice(&old.appearance[from]);
    };
    // Runs of voxels that are neighbours in both lists are copied in one piece.
    let mut run = 0..0;
    let mut at = 0;
    for key in &keys {
        while at < nothing && old.keys[at] < *key {
            at += 1;
        }
        let site = if at < nothing && old.keys[at] == *key {
            at
        } else {
            nothing
        };
        if site == run.end && site < nothing {
            run.end += 1;
        } else {
            copy(std::mem::replace(&mut run, site..site + 1));
        }
    }
    copy(run);
    copy(nothing..nothing + 1);
    SignedDistanceField {
        cells: SampleDensity::new(&keys, &classes),
        volume: Volume::new(SHAPE, &keys),
        hidden,
        planes,
        appearance,
        keys,
        classes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Class, Window};
    use world::World;
    use world::voxelize::{Vertical, complete};

    fn same(a: &SignedDistanceField, b: &SignedDistanceField) -> bool {
        a.keys == b.keys
            && a.classes == b.classes
            && a.hidden == b.hidden
            && a.planes == b.planes
            && a.appearance == b.appearance
            && a.volume.sites == b.volume.sites
            && a.cells == b.cells
    }

    /// A car comes, moves, goes; a lone voxel at the border; two changes far apart; nothing; everything.
    #[test]
    fn an_updated_field_is_a_fresh_one() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let grid = complete(&World::random(5), Vertical::Occ3d);
        let block = |grid: &VoxelGrid, x0: usize, y0: usize, label: u8| {
            let mut grid = grid.clone();
            for (x, y, z) in
                (x0..x0 + 11).flat_map(|x| (y0..y0 + 5).flat_map(move |y| (2..6).map(move |z| (x, y, z))))
            {
                grid.set(x.min(199), y.min(199), z, label);
            }
            grid
        };
        let car = Class::Car.id();
        let mut field = net.field(&grid).expect("finite");
        let steps = [
            (block(&grid, 120, 96, car), true),
            (block(&grid, 123, 97, car), true),
            (grid.clone(), true),
            (block(&block(&grid, 3, 190, car), 180, 7, Class::FREE), true),
            (grid.clone(), true),
            (grid.clone(), true),
            (VoxelGrid::new(), false),
            (block(&VoxelGrid::new(), 199, 0, car), true),
            (grid.clone(), false),
        ];
        for (i, (grid, local)) in steps.iter().enumerate() {
            let changed = net.update(&mut field, grid).expect("finite");
            assert_eq!(matches!(changed, Changed::In(_)), *local, "step {i}");
            assert!(i != 5 || changed == Changed::In(Vec::new()), "nothing changed");
            assert!(same(&field, &net.field(grid).expect("finite")), "step {i}");
        }
    }

    /// A voxel alone in dense surroundings, at every place within a cell: nothing farther than [`SIGHT`] changes, and
    /// something comes near it.
    #[test]
    fn the_sight_is_not_too_short() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let mut farthest = 0;
        for shift in 0..4 {
            let mut grid = VoxelGrid::new();
            for (x, y, z) in (40..120)
                .flat_map(|x| (40..120).flat_map(move |y| (4..6).map(move |z| (x, y, z))))
                .filter(|(x, y, z)| (x * 7 + y * 5 + z) % 3 != 0)
            {
                grid.set(x, y, z, Class::Vegetation.id());
            }
            let before = net.field(&grid).expect("finite");
            let (x, y) = (80 + shift, 78 + shift);
            let label = if grid.get(x, y, 5) == Class::FREE { 4 } else { 15 };
            grid.set(x, y, 5, label);
            let after = net.field(&grid).expect("finite");
            for (site, key) in after.keys.iter().enumerate() {
                let Ok(old) = before.keys.binary_search(key) else {
                    continue;
                };
                if before.hidden[old] != after.hidden[site] || before.planes[old] != after.planes[site] {
                    let [kx, ky, _] = SiteLevel::place(SHAPE, *key);
                    farthest = farthest.max(kx.abs_diff(x)).max(ky.abs_diff(y));
                }
            }
        }
        assert!((SIGHT - 3..=SIGHT).contains(&farthest), "{farthest}");
        assert_eq!(SHAPE, [Window::NX, Window::NY, Window::NZ]);
    }
}
