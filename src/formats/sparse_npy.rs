//! Occupancy as a list of voxels: one `.npy` array, a row per voxel that is not free. Three data sets keep theirs so, in the
//! frame of the LiDAR; they differ in the order of columns and in the size of cells.
//!
//! - OpenOccupancy (JeffWang987/OpenOccupancy, `LoadOccupancy`): z, y, x, class, or z, y, x, vx, vy, vz, class; class 0 is
//!   noise, which its readers ignore; what is free has no row.
//! - SurroundOcc (weiyithu/SurroundOcc, `docs/data.md`): x, y, z, class; class 0 is ignored, too.
//! - UniScene: as SurroundOcc, with smaller cells.
//!
//! Classes 1 to 16 are those of [`scene::Class`] in all of them.

use scene::{Frame, LidarPattern, Pose, Scene};

use crate::voxels::{DataCells, DataMap, LabelledCell, cells_of, check, physical};
use crate::{FormatError, npz};

/// A data set that keeps lists of voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SparseDataset {
    /// Assumption that is made when a file is read as this kind, for a person.
    pub assumed: &'static str,
    /// DataCells of its cells, in the LiDAR's frame.
    pub lattice: DataCells,
    /// True for rows that begin with z, y, x, false for x, y, z.
    pub z_first: bool,
}

/// See the module.
pub(crate) const OPEN_OCCUPANCY: SparseDataset = SparseDataset {
    assumed: "rows taken as OpenOccupancy: z, y, x, class in cells of 0.2 m of the LiDAR's frame, the LiDAR as on the nuScenes vehicle",
    lattice: DataCells {
        size: [512, 512, 40],
        cell_m: 0.2,
        min_m: [-51.2, -51.2, -5.0],
    },
    z_first: true,
};

/// See the module.
pub(crate) const SURROUND_OCC: SparseDataset = SparseDataset {
    assumed: "rows taken as SurroundOcc: x, y, z, class in cells of 0.5 m of the LiDAR's frame, the LiDAR as on the nuScenes vehicle",
    lattice: DataCells {
        size: [200, 200, 16],
        cell_m: 0.5,
        min_m: LOW_M,
    },
    z_first: false,
};

const SURROUND_OCC_FINE: SparseDataset = SparseDataset {
    assumed: "rows taken as SurroundOcc: x, y, z, class in cells of 0.2 m of the LiDAR's frame, the LiDAR as on the nuScenes vehicle",
    lattice: DataCells {
        size: [500, 500, 40],
        cell_m: 0.2,
        min_m: LOW_M,
    },
    z_first: false,
};

const UNI_SCENE: SparseDataset = SparseDataset {
    assumed: "rows taken as UniScene: x, y, z, class in cells of 0.125 m of the LiDAR's frame, the LiDAR as on the nuScenes vehicle",
    lattice: DataCells {
        size: [800, 800, 64],
        cell_m: 0.125,
        min_m: LOW_M,
    },
    z_first: false,
};

/// Lower corner of all but OpenOccupancy, m.
const LOW_M: [f64; 3] = [-50.0, -50.0, -5.0];

/// Kinds that a file may be of. Among those with z last, the coarsest comes first.
pub(crate) const KINDS: [SparseDataset; 4] = [OPEN_OCCUPANCY, SURROUND_OCC, SURROUND_OCC_FINE, UNI_SCENE];

impl SparseDataset {
    /// The cell that a row's first three values tell.
    pub fn cell(&self, [a, b, c]: [usize; 3]) -> [usize; 3] {
        match self.z_first {
            true => [c, b, a],
            false => [a, b, c],
        }
    }

    /// The data set's own map, if a scene is on it.
    pub fn own_map(&self, scene: &Scene) -> Option<DataMap> {
        let lidar = scene.rig.lidars.first()?;
        let map = DataMap::new(&self.lattice, &ego_from_lidar(lidar), lidar).ok()?;
        (map.extent() == scene.frame().extent()).then_some(map)
    }

    /// The kind of a file with these largest values in its first three columns: the smallest grid that holds them. Where both
    /// the first and the last column may be z, it is the one with smaller values.
    pub fn of_maxima(maxima: [usize; 3]) -> Option<SparseDataset> {
        let holds = |kind: &&SparseDataset| {
            let cell = kind.cell(maxima);
            (0..3).all(|axis| cell[axis] < kind.lattice.size[axis])
        };
        let is_first = maxima[0] <= maxima[2];
        let fitting = || KINDS.iter().filter(holds);
        let likely = fitting().find(|kind| kind.z_first == is_first);
        likely.or_else(|| fitting().next()).copied()
    }
}

/// The voxels of a map of the data set's own.
fn own_cells(frame: &Frame, map: &DataMap) -> Result<Vec<LabelledCell>, FormatError> {
    check(frame)?;
    let voxels = frame.occupancy.iter_set();
    let cell = |(x, y, z, class)| LabelledCell {
        at: map.cell([x, y, z]).map(|v| v as u16),
        class,
    };
    Ok(voxels.map(cell).collect())
}

/// A scene's voxels as such a file, sorted by the columns, at their true height instead of that of Occ3D.
pub(crate) fn to_bytes(scene: &Scene, kind: &SparseDataset) -> Result<Vec<u8>, FormatError> {
    let lidar = scene.rig.lidars.first();
    let lidar =
        lidar.ok_or_else(|| FormatError::new("the rig has no LiDAR, in whose frame the voxels are"))?;
    let cells = match kind.own_map(scene) {
        Some(map) => own_cells(scene.frame(), &map)?,
        None => cells_of(&physical(scene.frame())?, &kind.lattice, &ego_from_lidar(lidar)),
    };
    if cells.is_empty() {
        return Err(FormatError::new(
            "no voxel around the vehicle, and readers of such files expect one",
        ));
    }
    let row = |cell: &LabelledCell| {
        let [a, b, c] = kind.cell(cell.at.map(usize::from)).map(|v| v as i32);
        [a, b, c, i32::from(cell.class)]
    };
    let mut rows: Vec<[i32; 4]> = cells.iter().map(row).collect();
    rows.sort_unstable();
    npz::npy(&[rows.len(), 4], rows.as_flattened()).map_err(FormatError::new)
}

/// Where a LiDAR's frame is, which the data sets have their cells in.
pub(crate) fn ego_from_lidar(lidar: &LidarPattern) -> Pose {
    lidar.ego_from_sensor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_values_tell_the_kind() {
        let of = |a, b, c| SparseDataset::of_maxima([a, b, c]);
        assert_eq!(of(39, 511, 511), Some(OPEN_OCCUPANCY));
        assert_eq!(of(12, 20, 30), Some(OPEN_OCCUPANCY));
        assert_eq!(of(199, 199, 15), Some(SURROUND_OCC));
        assert_eq!(of(30, 20, 12), Some(SURROUND_OCC));
        assert_eq!(of(199, 199, 16), Some(SURROUND_OCC_FINE));
        assert_eq!(of(499, 20, 3), Some(SURROUND_OCC_FINE));
        assert_eq!(of(500, 20, 3), Some(UNI_SCENE));
        assert_eq!(of(799, 799, 63), Some(UNI_SCENE));
        assert_eq!(of(40, 20, 64), None);
        assert_eq!(of(800, 20, 3), None);
        // Both may be z here, and only one kind holds the middle column.
        assert_eq!(of(20, 511, 12), Some(UNI_SCENE));
        assert_eq!(of(39, 700, 39), Some(UNI_SCENE));
    }
}
