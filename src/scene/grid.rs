//! The Occ3D voxel grid, stored in copy-on-write bricks: a snapshot costs 169 pointers, an edit
//! copies only the bricks it touches, and "what changed" is a comparison of pointers.

use std::sync::{Arc, LazyLock};

use glam::DVec3;

use super::Class;

/// Geometry of the grid: 200 x 200 x 16 voxels of 0.4 m in the ego frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSpec;

impl GridSpec {
    /// Voxels along x (forward).
    pub const NX: usize = 200;
    /// Voxels along y (left).
    pub const NY: usize = 200;
    /// Voxels along z (up).
    pub const NZ: usize = 16;
    /// Edge of a voxel, m.
    pub const VOXEL_M: f64 = 0.4;
    /// Lower corner of the grid in the ego frame, m.
    pub const MIN_M: [f64; 3] = [-40.0, -40.0, -1.0];
    /// Upper corner of the grid in the ego frame, m.
    pub const MAX_M: [f64; 3] = [40.0, 40.0, 5.4];
    /// Voxels in all.
    pub const VOXELS: usize = Self::NX * Self::NY * Self::NZ;
    /// Columns in all.
    pub const COLUMNS: usize = Self::NX * Self::NY;

    /// The voxel that holds a point of the ego frame; half-open cells, `None` outside or for NaN.
    /// Works in voxel units: 0.4 is not exact in binary.
    #[inline]
    pub fn voxel_at(p_in_ego: DVec3) -> Option<[usize; 3]> {
        let u = Self::to_voxel_units(p_in_ego);
        let n = [Self::NX, Self::NY, Self::NZ];
        let mut cell = [0; 3];
        for axis in 0..3 {
            let v = u[axis];
            // Written so that NaN fails too.
            if !(v >= 0.0 && v < n[axis] as f64) {
                return None;
            }
            cell[axis] = v as usize;
        }
        Some(cell)
    }

    /// The BEV cell under a point of the ego frame.
    #[inline]
    pub fn column_at(x_m: f64, y_m: f64) -> Option<[usize; 2]> {
        Self::voxel_at(DVec3::new(x_m, y_m, 0.0)).map(|v| [v[0], v[1]])
    }

    /// Ego-frame metres to voxel units (0 at the lower corner, 1 per voxel).
    #[inline]
    pub fn to_voxel_units(p_in_ego: DVec3) -> DVec3 {
        // (p - min) / 0.4 as (p - min) * 2.5: 2.5 is exact.
        (p_in_ego - DVec3::from_array(Self::MIN_M)) * 2.5
    }

    /// Voxel units to ego-frame metres.
    #[inline]
    pub fn from_voxel_units(u: DVec3) -> DVec3 {
        u / 2.5 + DVec3::from_array(Self::MIN_M)
    }

    /// Centre of a voxel in the ego frame, m.
    #[inline]
    pub fn center(x: usize, y: usize, z: usize) -> DVec3 {
        Self::from_voxel_units(DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5))
    }
}

/// Edge of a brick in voxels; the grid is one brick high.
pub const BRICK: usize = 16;
/// Bricks along x and along y.
pub const BRICKS: usize = GridSpec::NX.div_ceil(BRICK);
const BRICK_VOXELS: usize = BRICK * BRICK * BRICK;

/// One brick: labels `[x][y][z]`, z fastest, so that a column is 16 bytes in a row.
pub type Brick = [u8; BRICK_VOXELS];

/// 200 x 200 x 16 bytes in copy-on-write bricks; `FILL` is the value of untouched space.
#[derive(Clone, Debug)]
pub struct BrickGrid<const FILL: u8> {
    bricks: Vec<Arc<Brick>>, // [bx][by], BRICKS * BRICKS
}

/// Semantic occupancy: label values of [`Class`], free by default.
pub type VoxelGrid = BrickGrid<{ Class::FREE }>;

/// Voxels that the user painted: a class id, or [`NOT_PAINTED`].
pub type VoxelPaint = BrickGrid<NOT_PAINTED>;

/// Value of a voxel of [`VoxelPaint`] that the user did not touch.
pub const NOT_PAINTED: u8 = 255;

fn empty_brick(fill: u8) -> Arc<Brick> {
    static FREE: LazyLock<Arc<Brick>> = LazyLock::new(|| Arc::new([Class::FREE; BRICK_VOXELS]));
    static NONE: LazyLock<Arc<Brick>> = LazyLock::new(|| Arc::new([NOT_PAINTED; BRICK_VOXELS]));
    match fill {
        NOT_PAINTED => NONE.clone(),
        Class::FREE => FREE.clone(),
        other => Arc::new([other; BRICK_VOXELS]),
    }
}

impl<const FILL: u8> Default for BrickGrid<FILL> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const FILL: u8> BrickGrid<FILL> {
    /// A grid that holds only `FILL`.
    pub fn new() -> Self {
        Self {
            bricks: vec![empty_brick(FILL); BRICKS * BRICKS],
        }
    }

    /// From labels `[x][y][z]`, C order. Errors with the length found if it is not 640,000.
    pub fn from_dense(labels: &[u8]) -> Result<Self, usize> {
        if labels.len() != GridSpec::VOXELS {
            return Err(labels.len());
        }
        let mut grid = Self::new();
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
                let at = (x * GridSpec::NY + y) * GridSpec::NZ;
                let column = &labels[at..at + GridSpec::NZ];
                if column.iter().any(|&v| v != FILL) {
                    grid.column_mut(x, y).copy_from_slice(column);
                }
            }
        }
        Ok(grid)
    }

    /// Labels `[x][y][z]`, C order, 640,000 of them.
    pub fn to_dense(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(GridSpec::VOXELS);
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
                out.extend_from_slice(self.column(x, y));
            }
        }
        out
    }

    /// The 16 labels above a BEV cell, lowest first. Panics outside the grid.
    #[inline]
    pub fn column(&self, x: usize, y: usize) -> &[u8; GridSpec::NZ] {
        let (brick, at) = Self::locate(x, y);
        self.bricks[brick][at..at + GridSpec::NZ]
            .try_into()
            .expect("a column is 16 long")
    }

    /// The same for writing; copies the brick if a snapshot shares it.
    #[inline]
    pub fn column_mut(&mut self, x: usize, y: usize) -> &mut [u8; GridSpec::NZ] {
        let (brick, at) = Self::locate(x, y);
        (&mut Arc::make_mut(&mut self.bricks[brick])[at..at + GridSpec::NZ])
            .try_into()
            .expect("a column is 16 long")
    }

    /// One label. Panics outside the grid.
    #[inline]
    pub fn get(&self, x: usize, y: usize, z: usize) -> u8 {
        self.column(x, y)[z]
    }

    /// Sets one label; a value that is there already copies nothing.
    #[inline]
    pub fn set(&mut self, x: usize, y: usize, z: usize, value: u8) {
        if self.get(x, y, z) != value {
            self.column_mut(x, y)[z] = value;
        }
    }

    #[inline]
    fn locate(x: usize, y: usize) -> (usize, usize) {
        assert!(x < GridSpec::NX && y < GridSpec::NY, "column ({x}, {y})");
        let brick = (x / BRICK) * BRICKS + y / BRICK;
        (brick, ((x % BRICK) * BRICK + y % BRICK) * BRICK)
    }

    /// The bricks, `[bx][by]`; compare with [`Arc::ptr_eq`] to learn what changed.
    pub fn bricks(&self) -> &[Arc<Brick>] {
        &self.bricks
    }

    /// Indices of the bricks that are not the same memory in both grids (equal content may be listed).
    pub fn changed_bricks(&self, other: &Self) -> Vec<usize> {
        (0..self.bricks.len())
            .filter(|&b| !Arc::ptr_eq(&self.bricks[b], &other.bricks[b]))
            .collect()
    }

    /// Every voxel that is not `FILL`, as (x, y, z, value), in C order within each brick.
    pub fn iter_set(&self) -> impl Iterator<Item = (usize, usize, usize, u8)> + '_ {
        let fill = empty_brick(FILL);
        self.bricks
            .iter()
            .enumerate()
            .filter(move |(_, brick)| !Arc::ptr_eq(brick, &fill))
            .flat_map(|(b, brick)| {
                brick
                    .iter()
                    .enumerate()
                    .filter(|(_, v)| **v != FILL)
                    .map(move |(i, v)| {
                        let (x, y, z) = (i / (BRICK * BRICK), i / BRICK % BRICK, i % BRICK);
                        ((b / BRICKS) * BRICK + x, (b % BRICKS) * BRICK + y, z, *v)
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

    /// Number of voxels in which two grids differ.
    pub fn count_different(&self, other: &Self) -> usize {
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
        counts[Class::Free as usize] = GridSpec::VOXELS - counts.iter().sum::<usize>();
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row 34 of the extremes table.
    #[test]
    fn row_34_grid_map() {
        let at = |x, y, z| GridSpec::voxel_at(DVec3::new(x, y, z));
        assert_eq!(at(-40.0, -40.0, -1.0), Some([0, 0, 0]));
        assert_eq!(at(40.0, 0.0, 0.0), None);
        assert_eq!(at(0.0, 40.0, 0.0), None);
        assert_eq!(at(0.0, 0.0, 5.4), None);
        assert_eq!(at(-0.0, 0.0, 0.0), Some([100, 100, 2]));
        for bad in [1e30, -1e30, f64::NAN, f64::INFINITY] {
            assert_eq!(at(bad, 0.0, 0.0), None);
            assert_eq!(at(0.0, 0.0, bad), None);
        }
        for x in 0..GridSpec::NX {
            for z in 0..GridSpec::NZ {
                assert_eq!(GridSpec::voxel_at(GridSpec::center(x, x, z)), Some([x, x, z]));
            }
        }
        let p = DVec3::new(12.345, -6.789, 0.123);
        let [x, y, z] = GridSpec::voxel_at(p).expect("inside");
        assert!((GridSpec::center(x, y, z) - p).abs().max_element() <= 0.2 + 1e-9);
    }

    #[test]
    fn copy_on_write_touches_one_brick() {
        let mut a = VoxelGrid::new();
        a.set(5, 5, 5, 4);
        let b = a.clone();
        a.set(199, 199, 15, 7);
        assert_eq!(a.changed_bricks(&b), vec![BRICKS * BRICKS - 1]);
        assert_eq!(a.count_different(&b), 1);
        assert_eq!(
            a.iter_set().collect::<Vec<_>>(),
            vec![(5, 5, 5, 4), (199, 199, 15, 7)]
        );
        assert_eq!(VoxelGrid::from_dense(&a.to_dense()).expect("640,000"), a);
        assert_eq!(VoxelGrid::from_dense(&[0; 3]), Err(3));
        assert_eq!(a.class_counts()[17], GridSpec::VOXELS - 2);
    }
}
