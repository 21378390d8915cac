//! The extent of a map: the part of the ground that it covers, known at run time.

use std::fmt;

use glam::DVec3;

use super::Lattice;

/// A rectangle of columns of a [`Lattice`] in the ego frame. Grids, layouts and reliefs carry theirs.
/// The networks see [`Extent::WINDOW`]; a map may be larger or smaller than that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Extent {
    /// Column at the lower corner, counted from the ego frame's origin.
    from: [i32; 2],
    /// Columns along x and y.
    size: [u32; 2],
    lattice: Lattice,
}

impl Default for Extent {
    fn default() -> Self {
        Self::WINDOW
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {} x {}", self.nx(), self.ny(), self.nz())
    }
}

impl Extent {
    /// Most columns along one side: 3.2 km of 0.4 m.
    pub const MAX_SIDE: usize = 8192;
    /// Most columns in all: 1.6 km by 1.6 km of 0.4 m.
    pub const MAX_COLUMNS: usize = 1 << 24;

    /// Most voxels in all: as many columns of 16 bins.
    pub const MAX_VOXELS: usize = Self::MAX_COLUMNS * 16;

    /// The frame of Occ3D, which the networks read and write: 200 x 200 columns around the ego vehicle.
    pub const WINDOW: Self = Self {
        from: [-100, -100],
        size: [200, 200],
        lattice: Lattice::OCC3D,
    };

    /// Columns `from..from + size` of the lattice of Occ3D, counted from the ego frame's origin. Errors as
    /// [`over`](Self::over).
    pub fn new(from: [i32; 2], size: [usize; 2]) -> Result<Self, String> {
        Self::over(Lattice::OCC3D, from, size)
    }

    /// Columns `from..from + size` of the same lattice. Errors as [`over`](Self::over).
    pub fn with_columns(&self, from: [i32; 2], size: [usize; 2]) -> Result<Self, String> {
        Self::over(self.lattice, from, size)
    }

    /// Columns `from..from + size` of a lattice, counted from the ego frame's origin. Errors in one line on a side of 0 or above
    /// [`MAX_SIDE`](Self::MAX_SIDE), on more than [`MAX_COLUMNS`](Self::MAX_COLUMNS), and farther than that from the origin.
    pub fn over(lattice: Lattice, from: [i32; 2], size: [usize; 2]) -> Result<Self, String> {
        let [nx, ny] = size;
        let sides = 1..=Self::MAX_SIDE;
        if !(sides.contains(&nx) && sides.contains(&ny)) || nx * ny > Self::MAX_COLUMNS {
            return Err(format!(
                "a map of {nx} x {ny} columns, expected sides of 1 to {} and at most {} columns",
                Self::MAX_SIDE,
                Self::MAX_COLUMNS
            ));
        }
        if nx * ny * lattice.bins() > Self::MAX_VOXELS {
            return Err(format!(
                "a map of {nx} x {ny} columns of {}, expected at most {} voxels",
                lattice.bins(),
                Self::MAX_VOXELS
            ));
        }
        const FARTHEST: i32 = Extent::MAX_COLUMNS as i32;
        if from.iter().any(|c| !(-FARTHEST..=FARTHEST).contains(c)) {
            return Err(format!(
                "a map from column {from:?}, expected at most {FARTHEST} columns from the origin"
            ));
        }
        Ok(Self {
            from,
            size: size.map(|n| n as u32),
            lattice,
        })
    }

    /// Lattice of its voxels.
    #[inline]
    pub const fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// Voxels along z (up).
    #[inline]
    pub const fn nz(&self) -> usize {
        self.lattice.bins()
    }

    /// Edge of a voxel, m.
    #[inline]
    pub const fn voxel_m(&self) -> f64 {
        self.lattice.voxel_m()
    }

    /// Column at the lower corner, counted from the ego frame's origin.
    pub const fn from(&self) -> [i32; 2] {
        self.from
    }

    /// Voxels along x (forward).
    #[inline]
    pub const fn nx(&self) -> usize {
        self.size[0] as usize
    }

    /// Voxels along y (left).
    #[inline]
    pub const fn ny(&self) -> usize {
        self.size[1] as usize
    }

    /// Voxels along x, y and z.
    #[inline]
    pub const fn shape(&self) -> [usize; 3] {
        [self.nx(), self.ny(), self.nz()]
    }

    /// Columns in all.
    #[inline]
    pub const fn columns(&self) -> usize {
        self.nx() * self.ny()
    }

    /// Voxels in all.
    pub const fn voxels(&self) -> usize {
        self.columns() * self.nz()
    }

    /// Lower corner in the ego frame, m.
    #[inline]
    pub fn min_m(&self) -> DVec3 {
        // 0.4 is not exact in binary, 2.5 is.
        let per_m = self.lattice.per_m();
        DVec3::new(
            f64::from(self.from[0]) / per_m,
            f64::from(self.from[1]) / per_m,
            self.lattice.bottom_m(),
        )
    }

    /// Upper corner in the ego frame, m.
    pub fn max_m(&self) -> DVec3 {
        let to =
            |axis: usize| (f64::from(self.from[axis]) + f64::from(self.size[axis])) / self.lattice.per_m();
        DVec3::new(to(0), to(1), self.lattice.top_m())
    }

    /// Place of a column in arrays `[x][y]`.
    #[inline]
    pub fn index(&self, x: usize, y: usize) -> usize {
        x * self.ny() + y
    }

    /// The column `[x, y]` at a place in arrays `[x][y]`.
    #[inline]
    pub fn column(&self, index: usize) -> [usize; 2] {
        [index / self.ny(), index % self.ny()]
    }

    /// Every column `[x, y]` in the order of arrays.
    pub fn all_columns(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [nx, ny] = [self.nx(), self.ny()];
        (0..nx).flat_map(move |x| (0..ny).map(move |y| [x, y]))
    }

    /// True if there is such a column.
    #[inline]
    pub fn holds(&self, x: usize, y: usize) -> bool {
        x < self.nx() && y < self.ny()
    }

    /// The voxel that holds a point of the ego frame; half-open cells, `None` outside or for NaN.
    /// Works in voxel units: 0.4 is not exact in binary.
    #[inline]
    pub fn voxel_at(&self, p_in_ego: DVec3) -> Option<[usize; 3]> {
        let u = self.to_voxel_units(p_in_ego);
        let n = self.shape();
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
    pub fn column_at(&self, x_m: f64, y_m: f64) -> Option<[usize; 2]> {
        self.voxel_at(DVec3::new(x_m, y_m, self.lattice.bottom_m()))
            .map(|v| [v[0], v[1]])
    }

    /// Ego-frame metres to voxel units (0 at the lower corner, 1 per voxel).
    #[inline]
    pub fn to_voxel_units(&self, p_in_ego: DVec3) -> DVec3 {
        // (p - min) / 0.4 as (p - min) * 2.5: 2.5 is exact.
        (p_in_ego - self.min_m()) * self.lattice.per_m()
    }

    /// Voxel units to ego-frame metres.
    #[inline]
    pub fn from_voxel_units(&self, u: DVec3) -> DVec3 {
        u / self.lattice.per_m() + self.min_m()
    }

    /// Centre of a voxel in the ego frame, m.
    #[inline]
    pub fn center(&self, x: usize, y: usize, z: usize) -> DVec3 {
        self.from_voxel_units(DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5))
    }

    /// The columns that two extents share: place and size in `self`, and place in `other`. `None` if they share none, and
    /// for another lattice.
    pub fn overlap(&self, other: &Self) -> Option<Overlap> {
        if self.lattice != other.lattice {
            return None;
        }
        let (mut here, mut there, mut size) = ([0; 2], [0; 2], [0; 2]);
        for axis in 0..2 {
            let (a, b) = (i64::from(self.from[axis]), i64::from(other.from[axis]));
            let from = a.max(b);
            let to = (a + i64::from(self.size[axis])).min(b + i64::from(other.size[axis]));
            if from >= to {
                return None;
            }
            here[axis] = (from - a) as usize;
            there[axis] = (from - b) as usize;
            size[axis] = (to - from) as usize;
        }
        Some(Overlap { here, there, size })
    }

    /// Values `[x][y]` over `self` taken from values over `of`; `fill` where `of` has none.
    pub fn crop<T: Copy>(&self, of: &Self, values: &[T], fill: T) -> Vec<T> {
        let mut out = vec![fill; self.columns()];
        self.paste(&mut out, of, values);
        out
    }

    /// Puts values `[x][y]` over `of` into values over `self`, where both have columns.
    pub fn paste<T: Copy>(&self, values: &mut [T], of: &Self, from: &[T]) {
        let Some(Overlap { here, there, size }) = self.overlap(of) else {
            return;
        };
        for x in 0..size[0] {
            let to = self.index(here[0] + x, here[1]);
            let at = of.index(there[0] + x, there[1]);
            values[to..to + size[1]].copy_from_slice(&from[at..at + size[1]]);
        }
    }
}

/// The columns that two extents share; see [`Extent::overlap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// Its first column in the first extent.
    pub here: [usize; 2],
    /// Its first column in the second extent.
    pub there: [usize; 2],
    /// Columns along x and y.
    pub size: [usize; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row 34 of the extremes table.
    #[test]
    fn row_34_grid_map() {
        let at = |x, y, z| Extent::WINDOW.voxel_at(DVec3::new(x, y, z));
        assert_eq!(at(-40.0, -40.0, -1.0), Some([0, 0, 0]));
        assert_eq!(at(40.0, 0.0, 0.0), None);
        assert_eq!(at(0.0, 40.0, 0.0), None);
        assert_eq!(at(0.0, 0.0, 5.4), None);
        assert_eq!(at(-0.0, 0.0, 0.0), Some([100, 100, 2]));
        for bad in [1e30, -1e30, f64::NAN, f64::INFINITY] {
            assert_eq!(at(bad, 0.0, 0.0), None);
            assert_eq!(at(0.0, 0.0, bad), None);
        }
        let map = Extent::new([-317, 45], [480, 320]).expect("sound");
        for extent in [Extent::WINDOW, map] {
            for [x, y] in extent.all_columns().step_by(7) {
                let center = extent.center(x, y, x % extent.nz());
                assert_eq!(extent.voxel_at(center), Some([x, y, x % extent.nz()]));
                assert_eq!(extent.column(extent.index(x, y)), [x, y]);
            }
            let (low, high) = (extent.min_m(), extent.max_m());
            assert_eq!(extent.to_voxel_units(low), DVec3::ZERO);
            let size = extent.shape().map(|n| n as f64 * 0.4);
            assert!(((high - low) - DVec3::from_array(size)).abs().max_element() < 1e-9);
        }
        let p = DVec3::new(12.345, -6.789, 0.123);
        let [x, y, z] = Extent::WINDOW.voxel_at(p).expect("inside");
        let center = Extent::WINDOW.center(x, y, z);
        assert!((center - p).abs().max_element() <= 0.2 + 1e-9);
    }

    #[test]
    fn sizes_that_are_no_map_are_refused_in_one_line() {
        for (from, size) in [
            ([0, 0], [0, 5]),
            ([0, 0], [Extent::MAX_SIDE + 1, 1]),
            ([0, 0], [8192, 8192]),
            ([0, 0], [usize::MAX, usize::MAX]),
            ([i32::MIN, 0], [1, 1]),
        ] {
            let problem = Extent::new(from, size).expect_err("no map");
            assert!(
                problem.lines().count() == 1 && problem.contains("expected"),
                "{problem}"
            );
        }
    }

    #[test]
    fn what_is_cropped_comes_back_where_it_was() {
        let map = Extent::new([-150, -110], [480, 320]).expect("sound");
        let values: Vec<u32> = (0..map.columns() as u32).collect();
        let window = Extent::WINDOW.crop(&map, &values, u32::MAX);
        let at = |x_m: f64, y_m: f64| {
            let [x, y] = map.column_at(x_m, y_m).expect("inside");
            let [u, v] = Extent::WINDOW.column_at(x_m, y_m).expect("inside");
            (values[map.index(x, y)], window[Extent::WINDOW.index(u, v)])
        };
        let (there, here) = at(12.3, -33.0);
        assert_eq!(there, here);
        let mut back = vec![u32::MAX; map.columns()];
        map.paste(&mut back, &Extent::WINDOW, &window);
        assert_eq!(back.iter().filter(|v| **v != u32::MAX).count(), 40_000);
        assert!(back.iter().zip(&values).all(|(b, v)| *b == u32::MAX || b == v));
        let away = Extent::new([500, 0], [10, 10]).expect("sound");
        assert_eq!(away.overlap(&Extent::WINDOW), None);
        assert!(away.crop(&Extent::WINDOW, &window, 7).iter().all(|v| *v == 7));
    }
}
