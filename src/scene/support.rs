//! Groups of voxels that touch each other, and the part of the occupancy that stands on the ground.

use crate::{Class, Extent, Lattice, Unobserved, VoxelGrid};

/// Area of connected ground voxels above the ground's bins from which on they carry objects, m².
const WIDE_GROUND_M2: f64 = 16.0;

/// Bins in which what stands on a flat map may begin: up to the true height of the ground, which is bin 2 in Occ3D; in its labels
/// it is in bin 0.
fn ground_bins(extent: Extent) -> u64 {
    let lattice = extent.lattice();
    u64::MAX >> (63 - lattice.foot_bin(lattice.bin(0.0)))
}

/// One word per column `[x][y]`, one bit per bin that is not free.
pub fn occupied(grid: &VoxelGrid) -> Vec<u64> {
    let mut out = vec![0; grid.extent().columns()];
    for (x, y, z, _) in grid.iter_set() {
        out[grid.extent().index(x, y)] |= 1 << z;
    }
    out
}

/// One word per column and class, by class id: one bit per bin that holds it. Empty for a class that does not occur.
pub fn by_class(grid: &VoxelGrid) -> Vec<Vec<u64>> {
    let mut out = vec![Vec::new(); Class::COUNT];
    for (x, y, z, label) in grid.iter_set() {
        if let Some(words) = out.get_mut(usize::from(label)) {
            words.resize(grid.extent().columns(), 0u64);
            words[grid.extent().index(x, y)] |= 1 << z;
        }
    }
    out
}

/// One word per column, one bit per bin that holds ground.
pub fn ground(extent: Extent, by_class: &[Vec<u64>]) -> Vec<u64> {
    let mut out = vec![0; extent.columns()];
    let grounds = Class::ALL.iter().filter(|c| c.is_ground());
    for words in grounds.filter_map(|c| by_class.get(usize::from(c.id()))) {
        out.iter_mut().zip(words).for_each(|(out, word)| *out |= word);
    }
    out
}

/// Number of voxels from which on a floating group of vegetation counts as the crown of a tree.
pub const CROWN: usize = 8;

/// Bins up to the one on the ground of most columns that have any, where labels are where things are: data sets leave ground out
/// under what stands on it. None where labels let the ground down.
pub fn usual_ground_bins(extent: Extent, ground: &[u64]) -> u64 {
    if extent.lattice().lowered() > 0 {
        return 0;
    }
    let mut counts = [0usize; Lattice::MAX_BINS];
    for word in ground.iter().filter(|word| **word != 0) {
        counts[word.trailing_zeros() as usize] += 1;
    }
    let usual = (0..counts.len()).max_by_key(|bin| (counts[*bin], usize::MAX - bin));
    match usual.filter(|bin| counts[*bin] > 0) {
        Some(bin) => u64::MAX >> (63 - extent.lattice().foot_bin(bin)),
        None => 0,
    }
}

/// The part of `occupied` that stands: voxels connected to the ground bins, or to wide ground that lies higher, through
/// voxels that touch by a face, an edge or a corner.
pub fn supported(extent: Extent, occupied: &[u64], ground: &[u64]) -> Vec<u64> {
    let usual = usual_ground_bins(extent, ground);
    let out = reached(extent, occupied, |_| usual);
    // A hill that does not reach the lowest bins is ground too.
    let mut high = Vec::new();
    for (c, (ground, out)) in ground.iter().zip(&out).enumerate() {
        high.extend(bins_set(extent, c, ground & !out));
    }
    let wide = (WIDE_GROUND_M2 / extent.voxel_m().powi(2)).round() as usize;
    if high.len() < wide {
        return out;
    }
    let mut seeds = out.clone();
    for group in groups(extent, high).iter().filter(|g| g.len() >= wide) {
        group
            .iter()
            .for_each(|[x, y, z]| seeds[extent.index(*x, *y)] |= 1 << z);
    }
    reached(extent, occupied, |c| seeds[c])
}

/// The part of `occupied` that is connected to the ground bins or to the seeds of a column, through voxels that touch
/// by a face, an edge or a corner.
pub fn reached(extent: Extent, occupied: &[u64], seeds: impl Fn(usize) -> u64) -> Vec<u64> {
    let (ground_bins, all) = (ground_bins(extent), extent.lattice().all_bins());
    let start = |(c, bits): (usize, &u64)| match *bits {
        0 => 0,
        bits => fill(bits & (ground_bins | seeds(c)), bits),
    };
    let mut out: Vec<u64> = occupied.iter().enumerate().map(start).collect();
    // Columns whose neighbours may still gain voxels: one that reaches no higher than the ground bins adds nothing.
    let mut queue: Vec<usize> = (0..out.len())
        .filter(|c| out[*c] << 1 & all & !ground_bins != 0)
        .collect();
    while let Some(c) = queue.pop() {
        let reach = out[c] | out[c] << 1 | out[c] >> 1;
        for near in neighbours(extent, c) {
            let gained = fill(out[near] | reach & occupied[near], occupied[near]);
            if gained != out[near] {
                out[near] = gained;
                queue.push(near);
            }
        }
    }
    out
}

/// The voxels of a column whose bits are set in a word.
pub fn bins_set(extent: Extent, column: usize, mut word: u64) -> impl Iterator<Item = [usize; 3]> {
    let [x, y] = extent.column(column);
    std::iter::from_fn(move || {
        let z = word.trailing_zeros() as usize;
        word &= word.wrapping_sub(1);
        (z < extent.nz()).then_some([x, y, z])
    })
}

/// Spreads set bits over the runs of `within` that they lie in.
fn fill(mut bits: u64, within: u64) -> u64 {
    loop {
        let spread = (bits | bits << 1 | bits >> 1) & within;
        if spread == bits {
            return bits;
        }
        bits = spread;
    }
}

/// The up to eight columns around one.
pub fn neighbours(extent: Extent, column: usize) -> impl Iterator<Item = usize> {
    let [x, y] = extent.column(column);
    let xs = x.saturating_sub(1)..=(x + 1).min(extent.nx() - 1);
    let ys = y.saturating_sub(1)..=(y + 1).min(extent.ny() - 1);
    xs.flat_map(move |i| ys.clone().map(move |j| extent.index(i, j)))
        .filter(move |c| *c != column)
}

/// Connected groups of voxels (26 neighbours) among the given ones; the groups in the order of their first voxel,
/// voxels in order within each.
pub fn groups(extent: Extent, mut cells: Vec<[usize; 3]>) -> Vec<Vec<[usize; 3]>> {
    cells.sort_unstable();
    let mut left = vec![0u64; extent.columns()];
    for &[x, y, z] in &cells {
        left[extent.index(x, y)] |= 1 << z;
    }
    let mut out = Vec::new();
    for first in cells {
        let [x, y, z] = first;
        if left[extent.index(x, y)] >> z & 1 == 0 {
            continue;
        }
        left[extent.index(x, y)] &= !(1 << z);
        let mut group = vec![first];
        let mut next = 0;
        while next < group.len() {
            let [x, y, z] = group[next];
            next += 1;
            let own = extent.index(x, y);
            let reach = 1u64 << z | (1u64 << z) << 1 | (1u64 << z) >> 1;
            for c in neighbours(extent, own).chain([own]) {
                let taken = left[c] & reach;
                left[c] &= !taken;
                let [x, y] = extent.column(c);
                let bins = (0..extent.nz()).filter(|k| taken >> k & 1 == 1);
                group.extend(bins.map(|k| [x, y, k]));
            }
        }
        group.sort_unstable();
        out.push(group);
    }
    out
}

/// The class that most of the voxels have; of several, the one with the lowest id.
pub fn main_class(grid: &VoxelGrid, cells: &[[usize; 3]]) -> Class {
    let mut votes = [0usize; Class::COUNT];
    for &[x, y, z] in cells {
        if let Some(votes) = votes.get_mut(grid.get(x, y, z) as usize) {
            *votes += 1;
        }
    }
    let most = votes.iter().copied().max().unwrap_or(0);
    let first = votes.iter().position(|v| *v == most).unwrap_or(0);
    Class::from_id(first as u8).unwrap_or(Class::Others)
}

/// True if a group is known to float. False if something that the grid does not show may hold it: beyond its sides or
/// its top (except for objects, which stand on their own), or voxels below that no sensor observed.
pub fn is_known_to_float(grid: &VoxelGrid, unobserved: Option<&Unobserved>, group: &[[usize; 3]]) -> bool {
    let is_object = |[x, y, z]: [usize; 3]| Class::from_id(grid.get(x, y, z)).is_some_and(Class::is_object);
    let at_edge =
        |cell: [usize; 3]| reaches_side(grid.extent(), &[cell]) || cell[2] + 1 == grid.extent().nz();
    let unknown_below = |[x, y, z]: [usize; 3]| {
        let words = unobserved.map(Unobserved::words);
        z > 0 && words.is_some_and(|w| w[grid.extent().index(x, y)] >> (z - 1) & 1 == 1)
    };
    !group
        .iter()
        .any(|c| (at_edge(*c) && !is_object(*c)) || unknown_below(*c))
}

/// True if something beyond the sides of the grid may hold the group.
pub fn reaches_side(extent: Extent, group: &[[usize; 3]]) -> bool {
    let at_side = |[x, y, _]: &[usize; 3]| *x == 0 || *y == 0 || x + 1 == extent.nx() || y + 1 == extent.ny();
    group.iter().any(at_side)
}

/// Free voxels from the underside of a group down to what is below it, under the voxel that is nearest to its middle.
pub fn stem(grid: &VoxelGrid, group: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let n = group.len().max(1) as f64;
    let middle = [0, 1].map(|axis| group.iter().map(|c| c[axis] as f64).sum::<f64>() / n);
    let lowest = |[x, y, z]: &&[usize; 3]| !group.contains(&[*x, *y, z.wrapping_sub(1)]);
    let off = |c: &[usize; 3]| (c[0] as f64 - middle[0]).powi(2) + (c[1] as f64 - middle[1]).powi(2);
    let nearest = group
        .iter()
        .filter(lowest)
        .min_by(|a, b| off(a).total_cmp(&off(b)));
    let Some(&[x, y, top]) = nearest else {
        return Vec::new();
    };
    let free = |z: &usize| grid.get(x, y, *z) == Class::FREE;
    let mut cells: Vec<_> = (0..top).rev().take_while(free).map(|z| [x, y, z]).collect();
    cells.reverse();
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn support_climbs_bridges_and_stops_at_gaps() {
        let mut grid = VoxelGrid::new();
        let put = |grid: &mut VoxelGrid, cells: &[[usize; 3]]| {
            cells
                .iter()
                .for_each(|c| grid.set(c[0], c[1], c[2], Class::Manmade.id()));
        };
        // A post, an arm that leaves it over a corner and dips down again: all of it stands.
        let post: Vec<_> = (0..9).map(|z| [10, 10, z]).collect();
        put(&mut grid, &post);
        put(&mut grid, &[[11, 11, 9], [12, 11, 9], [13, 11, 8], [13, 11, 7]]);
        // Two bins above the post: floats.
        put(&mut grid, &[[10, 10, 11], [10, 11, 11]]);
        put(&mut grid, &[[199, 199, 6]]);
        let all = occupied(&grid);
        let stands = supported(Extent::WINDOW, &all, &ground(Extent::WINDOW, &by_class(&grid)));
        assert_eq!(stands[13 * 200 + 11], 1 << 8 | 1 << 7);
        assert_eq!(stands[10 * 200 + 10], (1 << 9) - 1);
        assert_eq!(stands[199 * 200 + 199], 0);
        let floating: u32 = all.iter().zip(&stands).map(|(a, s)| (a & !s).count_ones()).sum();
        assert_eq!(floating, 3);
    }

    #[test]
    fn raised_ground_carries_and_a_lone_slab_does_not() {
        let mut grid = VoxelGrid::new();
        for x in 50..150 {
            for y in 50..150 {
                grid.set(x, y, 5, Class::Terrain.id());
            }
        }
        (6..9).for_each(|z| grid.set(100, 100, z, Class::Manmade.id()));
        (0..9).for_each(|x| grid.set(x, 10, 5, Class::Sidewalk.id()));
        let stands = supported(
            Extent::WINDOW,
            &occupied(&grid),
            &ground(Extent::WINDOW, &by_class(&grid)),
        );
        assert_eq!(stands[100 * 200 + 100], 0b1111 << 5);
        assert_eq!(stands[4 * 200 + 10], 0);
    }

    #[test]
    fn groups_are_apart_and_whole() {
        let cells = vec![[5, 5, 5], [0, 0, 0], [6, 6, 6], [0, 1, 0], [8, 5, 5]];
        assert_eq!(
            groups(Extent::WINDOW, cells),
            [
                vec![[0, 0, 0], [0, 1, 0]],
                vec![[5, 5, 5], [6, 6, 6]],
                vec![[8, 5, 5]]
            ]
        );
        assert!(groups(Extent::WINDOW, Vec::new()).is_empty());
    }

    #[test]
    fn walls_without_ground_under_them_stand_where_data_leave_it_out() {
        let lattice = Lattice::new(0.2, 32, -0.16).expect("sound");
        let extent = Extent::over(lattice, [0, 0], [40, 40]).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        for x in 0..40 {
            grid.set(x, 5, 1, Class::DriveableSurface.id());
            (2..9).for_each(|z| grid.set(x, 20, z, Class::Manmade.id()));
        }
        grid.set(30, 30, 6, Class::Manmade.id());
        let stands = supported(extent, &occupied(&grid), &ground(extent, &by_class(&grid)));
        assert_eq!(stands[extent.index(10, 20)], 0b1_1111_1100);
        assert_eq!(stands[extent.index(30, 30)], 0);
    }
}
