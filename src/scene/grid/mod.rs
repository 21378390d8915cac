//! Voxel grids, stored in copy-on-write bricks: a snapshot costs a pointer per brick (169 for a window), an edit copies
//! only the bricks it touches, and changes are found by comparing pointers. All empty bricks share one memory.

mod extent;
mod lattice;
mod lowering;
mod patch;
mod window;

use std::sync::{Arc, OnceLock};

pub use extent::{Extent, Overlap};
pub use lattice::Lattice;
pub use lowering::{lower, raise};
pub use patch::{BrickPatch, VoxelPatch};
pub use window::Window;

use super::Class;

/// Edge of a brick in columns; a brick is as high as the grid.
pub const BRICK: usize = 16;

/// One brick: labels `[x][y][z]` of 16 x 16 columns, z fastest, so that a column is its bins in a row.
pub type Brick = [u8];

/// A byte per voxel of a map in copy-on-write bricks; `FILL` is the value of untouched space.
#[derive(Clone, Debug)]
pub struct BrickGrid<const FILL: u8> {
    extent: Extent,
    bricks: Vec<Arc<Brick>>, // [bx][by]
}

/// Semantic occupancy: label values of [`Class`], free by default.
pub type VoxelGrid = BrickGrid<{ Class::FREE }>;

/// Voxels that the user painted: a class id, or [`NOT_PAINTED`].
pub type VoxelPaint = BrickGrid<NOT_PAINTED>;

/// Value of a voxel of [`VoxelPaint`] that the user did not touch.
pub const NOT_PAINTED: u8 = 255;

/// Bricks along x and along y.
pub fn bricks_along(extent: Extent) -> [usize; 2] {
    [extent.nx().div_ceil(BRICK), extent.ny().div_ceil(BRICK)]
}

/// See [`BrickGrid::brick_columns`].
pub fn brick_columns(extent: Extent, brick: usize) -> ([usize; 2], [usize; 2]) {
    let [_, along_y] = bricks_along(extent);
    let from = [brick / along_y * BRICK, brick % along_y * BRICK];
    let size = [
        BRICK.min(extent.nx().saturating_sub(from[0])),
        BRICK.min(extent.ny() - from[1]),
    ];
    (from, size)
}

fn empty_brick(fill: u8, bins: usize) -> Arc<Brick> {
    type OfHeights = [OnceLock<Arc<Brick>>; Lattice::MAX_BINS + 1];
    static FREE: OfHeights = [const { OnceLock::new() }; Lattice::MAX_BINS + 1];
    static NONE: OfHeights = [const { OnceLock::new() }; Lattice::MAX_BINS + 1];
    let new = || vec![fill; BRICK * BRICK * bins].into();
    match fill {
        NOT_PAINTED => NONE[bins].get_or_init(new).clone(),
        Class::FREE => FREE[bins].get_or_init(new).clone(),
        _ => new(),
    }
}

impl<const FILL: u8> Default for BrickGrid<FILL> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const FILL: u8> BrickGrid<FILL> {
    /// A window that holds only `FILL`.
    pub fn new() -> Self {
        Self::over(Extent::WINDOW)
    }

    /// A map that holds only `FILL`.
    pub fn over(extent: Extent) -> Self {
        let [bx, by] = bricks_along(extent);
        Self {
            extent,
            bricks: vec![empty_brick(FILL, extent.nz()); bx * by],
        }
    }

    /// A window from labels `[x][y][z]`, C order. Errors with the length found if it is not 640,000.
    pub fn from_dense(labels: &[u8]) -> Result<Self, usize> {
        Self::from_dense_over(Extent::WINDOW, labels)
    }

    /// A grid from labels `[x][y][z]` of a map, C order. Errors with the length found if it is another one.
    pub fn from_dense_over(extent: Extent, labels: &[u8]) -> Result<Self, usize> {
        if labels.len() != extent.voxels() {
            return Err(labels.len());
        }
        let mut grid = Self::over(extent);
        for ([x, y], column) in extent.all_columns().zip(labels.chunks_exact(extent.nz())) {
            if column.iter().any(|&v| v != FILL) {
                grid.column_mut(x, y).copy_from_slice(column);
            }
        }
        Ok(grid)
    }

    /// Labels `[x][y][z]`, C order; 640,000 of a window.
    pub fn to_dense(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.extent.voxels());
        for [x, y] in self.extent.all_columns() {
            out.extend_from_slice(self.column(x, y));
        }
        out
    }

    /// Which part of the ground it covers.
    #[inline]
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// These bricks over another extent of the same size.
    pub(crate) fn relabelled(&self, extent: Extent) -> Self {
        assert_eq!(extent.shape(), self.extent.shape(), "another size");
        Self {
            extent,
            bricks: self.bricks.clone(),
        }
    }

    /// The part of it that lies in another extent; `FILL` where this one has no columns. Costs pointers alone where both
    /// are the same.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent {
            return self.clone();
        }
        let mut out = Self::over(extent);
        out.paste(self);
        out
    }

    /// Takes over the voxels of another grid wherever both have columns. Columns that are equal copy no brick.
    pub fn paste(&mut self, other: &Self) {
        if other.extent == self.extent {
            self.clone_from(other);
            return;
        }
        let Some(Overlap { here, there, size }) = self.extent.overlap(&other.extent) else {
            return;
        };
        for x in 0..size[0] {
            for y in 0..size[1] {
                let column = other.column(there[0] + x, there[1] + y);
                let (x, y) = (here[0] + x, here[1] + y);
                if self.column(x, y) != column {
                    self.column_mut(x, y).copy_from_slice(column);
                }
            }
        }
    }

    /// The labels above a BEV cell, lowest first. Panics outside the grid.
    #[inline]
    pub fn column(&self, x: usize, y: usize) -> &[u8] {
        let (brick, at) = self.locate(x, y);
        &self.bricks[brick][at..at + self.extent.nz()]
    }

    /// Mutable access to the labels above a BEV cell; copies the brick if a snapshot shares it. Panics outside the grid.
    #[inline]
    pub fn column_mut(&mut self, x: usize, y: usize) -> &mut [u8] {
        let (brick, at) = self.locate(x, y);
        &mut Arc::make_mut(&mut self.bricks[brick])[at..at + self.extent.nz()]
    }

    /// The labels above a BEV cell of a grid of the networks' lattice. Panics on a grid of another height.
    #[inline]
    pub fn window_column(&self, x: usize, y: usize) -> &[u8; Window::NZ] {
        debug_assert_eq!(self.extent.lattice(), Lattice::OCC3D);
        self.column(x, y)
            .try_into()
            .expect("a grid of the networks' height")
    }

    /// Mutable access as [`column_mut`](Self::column_mut), of a grid of the networks' lattice. Panics on a grid of another
    /// height.
    #[inline]
    pub fn window_column_mut(&mut self, x: usize, y: usize) -> &mut [u8; Window::NZ] {
        debug_assert_eq!(self.extent.lattice(), Lattice::OCC3D);
        self.column_mut(x, y)
            .try_into()
            .expect("a grid of the networks' height")
    }

    /// One label. Panics outside the grid.
    #[inline]
    pub fn get(&self, x: usize, y: usize, z: usize) -> u8 {
        self.column(x, y)[z]
    }

    /// Sets one label; copies nothing if the value is there already.
    #[inline]
    pub fn set(&mut self, x: usize, y: usize, z: usize, value: u8) {
        if self.get(x, y, z) != value {
            self.column_mut(x, y)[z] = value;
        }
    }

    #[inline]
    fn locate(&self, x: usize, y: usize) -> (usize, usize) {
        assert!(self.extent.holds(x, y), "column ({x}, {y})");
        let brick = (x / BRICK) * self.extent.ny().div_ceil(BRICK) + y / BRICK;
        (brick, ((x % BRICK) * BRICK + y % BRICK) * self.extent.nz())
    }

    /// Bricks along x and along y.
    #[inline]
    pub fn bricks_along(&self) -> [usize; 2] {
        bricks_along(self.extent)
    }

    /// First column of a brick and the number of its columns in the map, along x and y: fewer at the upper sides.
    pub fn brick_columns(&self, brick: usize) -> ([usize; 2], [usize; 2]) {
        brick_columns(self.extent, brick)
    }

    /// The bricks, `[bx][by]`; compare with [`Arc::ptr_eq`] to learn what changed.
    pub fn bricks(&self) -> &[Arc<Brick>] {
        &self.bricks
    }

    /// Indices of the bricks that are not the same memory in both grids (equal content may be listed); all of them if the
    /// grids have different extents.
    pub fn changed_bricks(&self, other: &Self) -> Vec<usize> {
        if self.extent != other.extent {
            return (0..self.bricks.len()).collect();
        }
        (0..self.bricks.len())
            .filter(|&b| !Arc::ptr_eq(&self.bricks[b], &other.bricks[b]))
            .collect()
    }

    /// Every voxel that is not `FILL`, as (x, y, z, value), in C order within each brick.
    pub fn iter_set(&self) -> impl Iterator<Item = (usize, usize, usize, u8)> + '_ {
        let bins = self.extent.nz();
        let fill = empty_brick(FILL, bins);
        let [_, along_y] = self.bricks_along();
        self.bricks
            .iter()
            .enumerate()
            .filter(move |(_, brick)| !Arc::ptr_eq(brick, &fill))
            .flat_map(move |(b, brick)| {
                brick
                    .iter()
                    .enumerate()
                    .filter(|(_, v)| **v != FILL)
                    .map(move |(i, v)| {
                        let (x, y, z) = (i / bins / BRICK, i / bins % BRICK, i % bins);
                        ((b / along_y) * BRICK + x, (b % along_y) * BRICK + y, z, *v)
                    })
            })
    }

    /// Number of voxels that are not `FILL`.
    pub fn count_set(&self) -> usize {
        self.bricks
            .iter()
            .map(|b| b.iter().filter(|v| **v != FILL).count())
            .sum()
    }

    /// Number of voxels in which two grids of the same extent differ. Panics if they have different ones.
    pub fn count_different(&self, other: &Self) -> usize {
        assert_eq!(self.extent, other.extent, "grids of different extents");
        self.changed_bricks(other)
            .into_iter()
            .map(|b| {
                let pairs = self.bricks[b].iter().zip(other.bricks[b].iter());
                pairs.filter(|(a, b)| a != b).count()
            })
            .sum()
    }
}

impl<const FILL: u8> PartialEq for BrickGrid<FILL> {
    fn eq(&self, other: &Self) -> bool {
        if self.extent != other.extent {
            return false;
        }
        let mut pairs = self.bricks.iter().zip(&other.bricks);
        pairs.all(|(a, b)| Arc::ptr_eq(a, b) || a == b)
    }
}

impl VoxelGrid {
    /// Voxels per class.
    pub fn class_counts(&self) -> [usize; Class::COUNT] {
        let mut counts = [0; Class::COUNT];
        for (_, _, _, class) in self.iter_set() {
            counts[class as usize] += 1;
        }
        counts[Class::Free as usize] = self.extent.voxels() - counts.iter().sum::<usize>();
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copy_on_write_touches_one_brick() {
        let mut a = VoxelGrid::new();
        a.set(5, 5, 5, 4);
        let b = a.clone();
        a.set(199, 199, 15, 7);
        assert_eq!(a.changed_bricks(&b), vec![168]);
        assert_eq!(a.count_different(&b), 1);
        assert_eq!(
            a.iter_set().collect::<Vec<_>>(),
            vec![(5, 5, 5, 4), (199, 199, 15, 7)]
        );
        assert_eq!(VoxelGrid::from_dense(&a.to_dense()).expect("640,000"), a);
        assert_eq!(VoxelGrid::from_dense(&[0; 3]), Err(3));
        assert_eq!(a.class_counts()[17], Window::VOXELS - 2);
    }
    #[test]
    fn grids_of_another_lattice_hold_their_bins() {
        let lattice = Lattice::new(0.2, 40, -5.0).expect("sound");
        let extent = Extent::over(lattice, [-256, -256], [512, 512]).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        grid.set(511, 0, 39, 4);
        grid.set(17, 500, 20, 11);
        assert_eq!(grid.column(17, 500).len(), 40);
        assert_eq!(
            grid.iter_set().collect::<Vec<_>>(),
            vec![(17, 500, 20, 11), (511, 0, 39, 4)]
        );
        let dense = grid.to_dense();
        assert_eq!(dense.len(), 512 * 512 * 40);
        assert_eq!(VoxelGrid::from_dense_over(extent, &dense), Ok(grid.clone()));
        // A lattice shares no columns with another one.
        assert_eq!(grid.crop(Extent::WINDOW).count_set(), 0);
        let part = extent.with_columns([-240, 240], [20, 10]).expect("sound");
        assert_eq!(grid.crop(part).get(1, 4, 20), 11);
    }

    #[test]
    fn a_window_of_a_map_is_cropped_and_pasted_back() {
        let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
        let mut map = VoxelGrid::over(extent);
        assert_eq!(map.bricks_along(), [30, 20]);
        assert_eq!(map.brick_columns(599), ([464, 304], [16, 16]));
        map.set(0, 0, 0, 11);
        map.set(479, 319, 15, 4);
        map.set(150, 110, 3, 9); // the origin of the ego frame
        let mut window = map.crop(Extent::WINDOW);
        assert_eq!(window.iter_set().collect::<Vec<_>>(), vec![(100, 100, 3, 9)]);
        window.set(100, 100, 4, 9);
        let before = map.clone();
        map.paste(&window);
        assert_eq!((map.get(150, 110, 4), map.count_set()), (9, 4));
        assert_eq!(map.changed_bricks(&before).len(), 1, "one column differs");
        let dense = map.to_dense();
        assert_eq!(VoxelGrid::from_dense_over(extent, &dense), Ok(map.clone()));
        assert_ne!(map.crop(Extent::WINDOW), map);
    }
}
