//! A box of cubic cells in the frame of a data set.

use glam::DVec3;

/// Cells of a data set, counted from the lower corner along x, y and z of its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DataCells {
    /// Cells along each axis.
    pub size: [usize; 3],
    /// Edge of a cell, m.
    pub cell_m: f64,
    /// Lower corner, m.
    pub min_m: [f64; 3],
}

impl DataCells {
    /// Middle of a cell, m.
    pub fn center(&self, cell: [usize; 3]) -> DVec3 {
        let at = DVec3::from_array(cell.map(|c| c as f64 + 0.5));
        at * self.cell_m + DVec3::from_array(self.min_m)
    }

    /// A point in units of cells, 0 at the lower corner.
    pub fn to_cells(self, p: DVec3) -> DVec3 {
        (p - DVec3::from_array(self.min_m)) / self.cell_m
    }

    /// The cell that holds a point; half-open cells, `None` outside or for NaN.
    pub fn cell_at(&self, p: DVec3) -> Option<[usize; 3]> {
        let at = self.to_cells(p);
        let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < self.size[axis] as f64);
        inside.then(|| at.to_array().map(|v| v as usize))
    }

    /// Place of a cell in arrays `[x][y][z]`.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.size[1] + y) * self.size[2] + z
    }

    /// The cell at a place in arrays `[x][y][z]`.
    pub fn cell(&self, index: usize) -> [usize; 3] {
        let [_, ny, nz] = self.size;
        [index / (ny * nz), index / nz % ny, index % nz]
    }

    /// Cells in all.
    pub fn cells(&self) -> usize {
        self.size.iter().product()
    }

    /// The eight corners, m.
    pub fn corners_m(&self) -> [DVec3; 8] {
        let reach = DVec3::from_array(self.size.map(|n| n as f64)) * self.cell_m;
        std::array::from_fn(|i| {
            let side = |axis: usize| (i >> axis & 1) as f64;
            DVec3::from_array(self.min_m) + reach * DVec3::new(side(0), side(1), side(2))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centers_lie_in_their_cells() {
        let lattice = DataCells {
            size: [512, 512, 40],
            cell_m: 0.2,
            min_m: [-51.2, -51.2, -5.0],
        };
        for cell in [[0, 0, 0], [511, 511, 39], [256, 3, 17]] {
            assert_eq!(lattice.cell_at(lattice.center(cell)), Some(cell));
            assert_eq!(lattice.cell(lattice.index(cell)), cell);
        }
        assert_eq!(lattice.cells(), 512 * 512 * 40);
        assert_eq!(lattice.cell_at(DVec3::new(51.3, 0.0, 0.0)), None);
        assert_eq!(lattice.cell_at(DVec3::NAN), None);
        let [low, high] = [lattice.corners_m()[0], lattice.corners_m()[7]];
        assert!((low - DVec3::new(-51.2, -51.2, -5.0)).length() < 1e-9);
        assert!((high - DVec3::new(51.2, 51.2, 3.0)).length() < 1e-9);
    }
}
