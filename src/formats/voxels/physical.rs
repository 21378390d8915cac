//! Labels with everything at its true height.
//!
//! Occ3D's labels have the ground two bins below where it is, in bin 0, and every other thing reaches two bins further down
//! than it is ([`scene::solid::fill::SMEAR`]). Other data sets have things where they are, so labels are taken from one
//! convention to the other on the way out and in.

use glam::DVec3;
use scene::grid;
use scene::solid::fill::SMEAR;
use scene::{Class, Extent, Lattice, Unobserved, VoxelGrid, Window};

/// Classes of voxels of 0.4 m with the ground of a flat map in bin 2, from -1 to 6.2 m of the ego frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Physical {
    extent: Extent,
    columns: Vec<[u8; Physical::NZ]>, // [x][y]
}

/// Within this distance of the ego vehicle the height of the ground is looked for, m.
const NEAR_M: f64 = 20.0;

impl Physical {
    /// Bins of a column.
    pub const NZ: usize = Window::NZ + SMEAR;

    /// A map without anything.
    pub fn over(extent: Extent) -> Self {
        Self {
            extent,
            columns: vec![[Class::FREE; Self::NZ]; extent.columns()],
        }
    }

    /// From labels of Occ3D's convention: ground goes up by two bins, and every other thing loses its lowest two. Where such
    /// a thing is less than three bins high, its highest bin is kept; one that stands on the ground or on the bottom of the
    /// grid stays on it.
    pub fn raised(grid: &VoxelGrid) -> Self {
        let columns = grid
            .extent()
            .all_columns()
            .map(|[x, y]| raise(grid.window_column(x, y)));
        Self {
            extent: grid.extent(),
            columns: columns.collect(),
        }
    }

    /// Labels of Occ3D's convention, the inverse of [`Self::raised`]. Things that end above the grid's top are cut off
    /// there.
    pub fn lowered(&self) -> VoxelGrid {
        self.grid(lower)
    }

    /// The bins as labels, unchanged: for bins that follow Occ3D's convention already.
    pub fn as_it_is(&self) -> VoxelGrid {
        self.grid(|column| *column)
    }

    fn grid(&self, of: impl Fn(&[u8; Self::NZ]) -> [u8; Self::NZ]) -> VoxelGrid {
        let mut grid = VoxelGrid::over(self.extent);
        for ([x, y], column) in self.extent.all_columns().zip(&self.columns) {
            if column.iter().any(|label| *label != Class::FREE) {
                *grid.window_column_mut(x, y) = *of(column).first_chunk().expect("taller than a column");
            }
        }
        grid
    }

    /// Which part of the ground it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// A column, lowest bin first.
    #[cfg(test)]
    pub fn column(&self, x: usize, y: usize) -> &[u8; Self::NZ] {
        &self.columns[self.extent.index(x, y)]
    }

    /// A column for writing, lowest bin first.
    pub fn column_mut(&mut self, x: usize, y: usize) -> &mut [u8; Self::NZ] {
        &mut self.columns[self.extent.index(x, y)]
    }

    /// The voxel that holds a point of the ego frame; half-open, `None` outside or for NaN.
    pub fn voxel_at(extent: Extent, p_in_ego: DVec3) -> Option<[usize; 3]> {
        let u = extent.to_voxel_units(p_in_ego);
        let size = [extent.nx(), extent.ny(), Self::NZ];
        let inside = (0..3).all(|axis| u[axis] >= 0.0 && u[axis] < size[axis] as f64);
        inside.then(|| u.to_array().map(|v| v as usize))
    }

    /// Every voxel that is not free: x, y, z, class.
    pub fn iter_set(&self) -> impl Iterator<Item = (usize, usize, usize, u8)> + '_ {
        let columns = self.extent.all_columns().zip(&self.columns);
        columns.flat_map(|([x, y], column)| {
            let bins = column
                .iter()
                .enumerate()
                .filter(|(_, label)| **label != Class::FREE);
            bins.map(move |(z, label)| (x, y, z, *label))
        })
    }

    /// True if the ground lies where Occ3D's labels have it, more than one bin below its true place. The median of the
    /// ground's voxels around the ego vehicle tells, or of all if there are none around it. False without ground.
    pub fn is_lowered(&self) -> bool {
        let ground = |near_m: f64| {
            let near = |(x, y, z, label): (usize, usize, usize, u8)| {
                let p = self.extent.center(x, y, 0);
                (is_ground(label) && p.truncate().length() < near_m).then_some(z)
            };
            let mut bins: Vec<usize> = self.iter_set().filter_map(near).collect();
            let middle = bins.len() / 2;
            (!bins.is_empty()).then(|| *bins.select_nth_unstable(middle).1)
        };
        ground(NEAR_M)
            .or_else(|| ground(f64::INFINITY))
            .is_some_and(|bin| bin == 0)
    }

    /// A map that holds all voxels that are not free and the networks' window, and no more columns than that needs.
    pub fn snug(&self) -> Self {
        let window = Extent::WINDOW;
        let (mut low, mut high) = (window.from(), [0, 1].map(|a| window.from()[a] + side(window, a)));
        for (x, y, ..) in self.iter_set() {
            for (axis, at) in [x, y].into_iter().enumerate() {
                let at = self.extent.from()[axis] + at as i32;
                low[axis] = low[axis].min(at);
                high[axis] = high[axis].max(at + 1);
            }
        }
        let size = [0, 1].map(|axis| (high[axis] - low[axis]) as usize);
        let extent = Extent::new(low, size).unwrap_or(self.extent);
        Self {
            extent,
            columns: extent.crop(&self.extent, &self.columns, [Class::FREE; Self::NZ]),
        }
    }
}

fn side(extent: Extent, axis: usize) -> i32 {
    [extent.nx(), extent.ny()][axis] as i32
}

fn is_ground(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_ground)
}

fn raise(column: &[u8; Window::NZ]) -> [u8; Physical::NZ] {
    let mut out = [Class::FREE; Physical::NZ];
    grid::raise(Lattice::OCC3D, column, &mut out);
    out
}

fn lower(column: &[u8; Physical::NZ]) -> [u8; Physical::NZ] {
    let mut out = *column;
    grid::lower(Lattice::OCC3D, &mut out);
    out
}

/// The unobserved voxels in labels of Occ3D's convention where these bins of each column `[x][y]` are observed. A voxel
/// is observed if one of the bins that it may stand for is: its own or one of the two above it.
pub(crate) fn unobserved(extent: Extent, observed: &[u32]) -> Option<Unobserved> {
    let word = |bits: &u32| u64::from(!((0..=SMEAR).fold(0, |all, up| all | bits >> up) as u16));
    Unobserved::from_words(extent, observed.iter().map(word).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_tests::random_scene;

    const FREE: u8 = Class::FREE;
    const ROAD: u8 = Class::DriveableSurface as u8;
    const CAR: u8 = Class::Car as u8;
    const TREE: u8 = Class::Vegetation as u8;

    fn column<const N: usize>(of: &[(usize, u8)]) -> [u8; N] {
        let mut column = [FREE; N];
        of.iter().for_each(|(z, label)| column[*z] = *label);
        column
    }

    fn back(of: [u8; 16]) -> [u8; 16] {
        *lower(&raise(&of)).first_chunk().expect("taller")
    }

    #[test]
    fn ground_rises_and_things_lose_what_was_added_to_them() {
        // A car of 1.6 m on the road, as Occ3D has it, and a branch above.
        let occ3d = column(&[
            (0, ROAD),
            (1, CAR),
            (2, CAR),
            (3, CAR),
            (4, CAR),
            (10, TREE),
            (11, TREE),
            (12, TREE),
        ]);
        let physical = column(&[(2, ROAD), (3, CAR), (4, CAR), (12, TREE)]);
        assert_eq!(raise(&occ3d), physical);
        assert_eq!(back(occ3d), occ3d);
        // A car that hides the road under it.
        let occ3d = column(&[(0, CAR), (1, CAR), (2, CAR), (3, CAR)]);
        assert_eq!(raise(&occ3d), column(&[(2, CAR), (3, CAR)]));
        assert_eq!(back(occ3d), occ3d);
        // What is thinner comes back three bins high: on the ground upward, in the air downward.
        assert_eq!(
            back(column(&[(0, ROAD), (1, TREE)])),
            column(&[(0, ROAD), (1, TREE), (2, TREE), (3, TREE)])
        );
        assert_eq!(
            back(column(&[(9, TREE)])),
            column(&[(7, TREE), (8, TREE), (9, TREE)])
        );
        assert_eq!(
            raise(&column(&[(0, ROAD), (2, CAR)])),
            column(&[(2, ROAD), (3, CAR)])
        );
        // The top of the grid is not the top of the world.
        assert_eq!(raise(&column(&[(15, ROAD)])), column(&[(17, ROAD)]));
        assert_eq!(
            lower(&column(&[(17, TREE), (0, ROAD), (1, ROAD)])),
            column(&[(0, ROAD), (15, TREE), (16, TREE), (17, TREE)])
        );
    }

    /// Of a hundred scenes every column comes back in which things are at least three bins high and of one class in their
    /// lowest three; of the others the ground does, and the top of each thing.
    #[test]
    fn what_stands_as_in_occ3d_comes_back() {
        let mut whole = 0;
        for seed in 0..100 {
            let grid = random_scene(seed).frame().occupancy.clone();
            let again = Physical::raised(&grid).lowered();
            for [x, y] in grid.extent().all_columns() {
                let (before, after) = (grid.column(x, y), again.column(x, y));
                let is_thing = |z: &usize| before[*z] != FREE && !is_ground(before[*z]);
                let bottoms = (0..16).filter(|z| is_thing(z) && (*z == 0 || !is_thing(&(z - 1))));
                let regular = bottoms
                    .clone()
                    .all(|z| z + 2 < 16 && before[z] == before[z + 1] && before[z] == before[z + 2]);
                if regular {
                    assert_eq!(before, after, "seed {seed}, column {x}, {y}");
                    whole += usize::from(before.iter().any(|l| *l != FREE));
                }
            }
        }
        assert!(whole > 100_000, "{whole} columns tell nothing");
    }

    #[test]
    fn where_the_ground_lies_is_found_near_the_vehicle() {
        let extent = Extent::WINDOW;
        let mut grid = VoxelGrid::new();
        for x in 0..200 {
            (95..105).for_each(|y| grid.set(x, y, if x > 150 { 5 } else { 0 }, ROAD));
        }
        let raised = Physical::raised(&grid);
        assert!(!raised.is_lowered());
        let mut as_occ3d = Physical::over(extent);
        for (x, y, z, label) in grid.iter_set() {
            as_occ3d.column_mut(x, y)[z] = label;
        }
        assert!(as_occ3d.is_lowered() && as_occ3d.as_it_is() == grid);
        assert!(!Physical::over(extent).is_lowered());
    }

    #[test]
    fn a_map_grows_beyond_the_window_only_for_what_is_there() {
        let wide = Extent::new([-140, -140], [280, 280]).expect("sound");
        let mut map = Physical::over(wide);
        assert_eq!(map.snug().extent(), Extent::WINDOW);
        map.column_mut(0, 140)[2] = ROAD;
        let snug = map.snug();
        assert_eq!(
            snug.extent(),
            Extent::new([-140, -100], [240, 200]).expect("sound")
        );
        assert_eq!(snug.column(0, 100)[2], ROAD);
        assert_eq!(snug.iter_set().count(), 1);
    }

    #[test]
    fn what_was_seen_above_was_seen_below() {
        let mut observed = vec![0; Extent::WINDOW.columns()];
        observed[7] = 1 << 2 | 1 << 17;
        let found = unobserved(Extent::WINDOW, &observed).expect("a word per column");
        assert_eq!(found.words()[7], 0xffff & !(0b111 | 1 << 15));
        assert_eq!(found.words()[8], 0xffff);
    }
}
