//! Cells of a data set as a map of their own lattice: the map stands still around the LiDAR, its columns are the cells'.

use glam::DVec3;
use scene::{Extent, Lattice, Pose};

use super::DataCells;

/// A map whose voxels are the cells of a data set, turned by quarters so that x is ahead. The origin is on the ground below
/// that of the data set's frame, usually the LiDAR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DataMap {
    cells: DataCells,
    /// Quarter turns from the data set's axes to the map's, 0 to 3.
    quarters: u8,
    extent: Extent,
}

impl DataMap {
    /// The map of cells in a frame that is turned and as high above the ground as `ego_from_cells` says. Errors in one line on
    /// cells that are no lattice.
    pub fn new(cells: &DataCells, ego_from_cells: &Pose) -> Result<Self, String> {
        let ahead = ego_from_cells.rotation * DVec3::X;
        let quarters = (ahead.truncate().to_angle() / std::f64::consts::FRAC_PI_2).round();
        let z_m = ego_from_cells.translation_m.z;
        let lattice = Lattice::new(cells.cell_m, cells.size[2], cells.min_m[2] + z_m)?;
        let mut out = Self {
            cells: *cells,
            quarters: quarters.rem_euclid(4.0) as u8,
            extent: Extent::WINDOW,
        };
        let corners = [[0, 0], [cells.size[0] - 1, cells.size[1] - 1]].map(|cell| out.turned(cell));
        let low = [0, 1].map(|axis| corners[0][axis].min(corners[1][axis]));
        let high = [0, 1].map(|axis| corners[0][axis].max(corners[1][axis]));
        let size = [0, 1].map(|axis| (high[axis] - low[axis] + 1) as usize);
        out.extent = Extent::over(lattice, low, size)?;
        Ok(out)
    }

    /// Columns and lattice of the map.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// True for a map of the same voxels that holds all cells: this one, or one that was made larger.
    pub fn lies_in(&self, map: Extent) -> bool {
        let [nx, ny, _] = map.shape();
        let [own_nx, own_ny, _] = self.extent.shape();
        let holds = |axis: usize, n: usize, own_n: usize| {
            let (low, own_low) = (map.from()[axis], self.extent.from()[axis]);
            low <= own_low && own_low + own_n as i32 <= low + n as i32
        };
        map.lattice() == self.extent.lattice() && holds(0, nx, own_nx) && holds(1, ny, own_ny)
    }

    /// The voxel of a cell.
    pub fn voxel(&self, cell: [usize; 3]) -> [usize; 3] {
        let at = self.turned([cell[0], cell[1]]);
        let from = self.extent.from();
        [(at[0] - from[0]) as usize, (at[1] - from[1]) as usize, cell[2]]
    }

    /// The cell of a voxel, the inverse of [`voxel`](Self::voxel).
    pub fn cell(&self, [x, y, z]: [usize; 3]) -> [usize; 3] {
        let from = self.extent.from();
        // Twice the place of the middle, so that it is whole.
        let at = [2 * (from[0] + x as i32) + 1, 2 * (from[1] + y as i32) + 1];
        let back = turned_by((4 - self.quarters) % 4, at);
        let low = self.low();
        let index = |axis: usize| ((back[axis] - 1) / 2 - low[axis]) as usize;
        [index(0), index(1), z]
    }

    /// Cells from the frame's origin to the lower corner.
    fn low(&self) -> [i32; 2] {
        [0, 1].map(|axis| (self.cells.min_m[axis] / self.cells.cell_m).round() as i32)
    }

    /// Column of a cell, counted from the map's origin.
    fn turned(&self, [i, j]: [usize; 2]) -> [i32; 2] {
        let low = self.low();
        let middle = [2 * (low[0] + i as i32) + 1, 2 * (low[1] + j as i32) + 1];
        turned_by(self.quarters, middle).map(|v| (v - 1).div_euclid(2))
    }
}

/// A point turned counter-clockwise by quarters.
fn turned_by(quarters: u8, [x, y]: [i32; 2]) -> [i32; 2] {
    match quarters {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use scene::SensorRig;

    #[test]
    fn every_cell_has_its_voxel_and_comes_back() {
        let rig = SensorRig::default();
        let lidar = &rig.lidars[0];
        for (size, min_m) in [([6, 4, 3], [-0.6, -0.4, -1.0]), ([4, 6, 2], [0.0, -0.6, -2.0])] {
            let cells = DataCells {
                size,
                cell_m: 0.2,
                min_m,
            };
            for quarters in 0..4 {
                let turn = f64::from(quarters) * std::f64::consts::FRAC_PI_2;
                let pose = Pose {
                    rotation: DQuat::from_rotation_z(turn + 0.01),
                    translation_m: lidar.translation_m.into(),
                };
                let map = DataMap::new(&cells, &pose).expect("sound");
                for index in 0..cells.cells() {
                    let cell = cells.cell(index);
                    let voxel = map.voxel(cell);
                    assert_eq!(map.cell(voxel), cell);
                    // Middles are the same place, turned.
                    let turned = DQuat::from_rotation_z(turn) * cells.center(cell);
                    let lifted = turned + DVec3::Z * lidar.translation_m[2];
                    let [x, y, z] = voxel;
                    assert!((map.extent().center(x, y, z) - lifted).length() < 1e-3);
                }
            }
        }
    }
}
