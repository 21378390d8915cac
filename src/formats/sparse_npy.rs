//! Occupancy as a list of voxels: one `.npy` array, a row per voxel that is not free. Three data sets keep theirs so, in the
//! frame of the LiDAR; they differ in the order of columns and in the size of cells.
//!
//! - OpenOccupancy (JeffWang987/OpenOccupancy, `LoadOccupancy`): z, y, x, class, or z, y, x, vx, vy, vz, class; class 0 is
//!   noise, which its readers ignore; what is free has no row.
//! - SurroundOcc (weiyithu/SurroundOcc, `docs/data.md`): x, y, z, class; class 0 is ignored, too.
//! - UniScene: as SurroundOcc, with smaller cells.
//!
//! Classes 1 to 16 are those of [`scene::Class`] in all of them.

use scene::label_sets::NUSCENES;
use scene::{Class, Frame, LabelSet, LidarPattern, Pose, Scene};

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

/// See the module.
pub(crate) const SURROUND_OCC_FINE: SparseDataset = SparseDataset {
    assumed: "rows taken as SurroundOcc: x, y, z, class in cells of 0.2 m of the LiDAR's frame, the LiDAR as on the nuScenes vehicle",
    lattice: DataCells {
        size: [500, 500, 40],
        cell_m: 0.2,
        min_m: LOW_M,
    },
    z_first: false,
};

/// See the module.
pub(crate) const UNI_SCENE: SparseDataset = SparseDataset {
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
    /// The cell that a row's first three values tell, and the values that tell a cell.
    pub fn cell<T>(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        match self.z_first {
            true => [c, b, a],
            false => [a, b, c],
        }
    }

    /// The data set's own map, if that of a scene holds it.
    pub fn own_map(&self, scene: &Scene) -> Option<DataMap> {
        let lidar = scene.rig.lidars.first()?;
        let map = DataMap::new(&self.lattice, &ego_from_lidar(lidar)).ok()?;
        map.lies_in(scene.frame().extent()).then_some(map)
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

/// The first of some kinds whose own map that of a scene holds.
pub(crate) fn own_kind(kinds: &[SparseDataset], scene: &Scene) -> Option<SparseDataset> {
    kinds.iter().find(|kind| kind.own_map(scene).is_some()).copied()
}

/// Rows of the cells that are not free, of a scene in the voxels of Occ3D, at their true height: x, y, z, label.
pub(crate) fn resampled_rows(
    frame: &Frame,
    cells: &DataCells,
    ego_from_cells: &Pose,
    set: &LabelSet,
) -> Result<Vec<[i32; 4]>, FormatError> {
    let row = |cell: &LabelledCell| {
        let [x, y, z] = cell.at.map(i32::from);
        let class = Class::from_id(cell.class).unwrap_or(Class::Others);
        [x, y, z, i32::from(set.label(class))]
    };
    Ok(cells_of(&physical(frame)?, cells, ego_from_cells)
        .iter()
        .map(row)
        .collect())
}

/// Rows of the voxels of a frame that lie on a data set's own map: x, y, z of the cell, and the label that it was read with where
/// no edit changed the class.
pub(crate) fn own_rows(frame: &Frame, map: &DataMap, set: &LabelSet) -> Result<Vec<[i32; 4]>, FormatError> {
    check(frame)?;
    let frame = frame.crop(map.extent());
    let data_labels = frame
        .inferred
        .data_labels
        .as_ref()
        .filter(|labels| labels.set() == set);
    let row = |(x, y, z, class)| {
        let class = Class::from_id(class).unwrap_or(Class::Others);
        let label = match data_labels {
            Some(labels) => labels.label([x, y, z], class),
            None => set.label(class),
        };
        let [i, j, k] = map.cell([x, y, z]).map(|v| v as i32);
        [i, j, k, i32::from(label)]
    };
    Ok(frame.occupancy.iter_set().map(row).collect())
}

/// A scene's voxels as a file of the first of some kinds on whose own map it is, or else of the first of them: sorted by the
/// columns, at their true height instead of that of Occ3D.
pub(crate) fn to_bytes(scene: &Scene, kinds: &[SparseDataset]) -> Result<Vec<u8>, FormatError> {
    let lidar = scene.rig.lidars.first();
    let lidar =
        lidar.ok_or_else(|| FormatError::new("the rig has no LiDAR, in whose frame the voxels are"))?;
    let own = own_kind(kinds, scene);
    let kind = own.unwrap_or(kinds[0]);
    let mut rows = match own.and_then(|kind| kind.own_map(scene)) {
        Some(map) => own_rows(scene.frame(), &map, &NUSCENES)?,
        None => resampled_rows(scene.frame(), &kind.lattice, &ego_from_lidar(lidar), &NUSCENES)?,
    };
    for row in &mut rows {
        let [x, y, z, _] = *row;
        row[..3].copy_from_slice(&kind.cell([x, y, z]));
    }
    as_array(rows)
}

/// Rows as an array, sorted. Errors if there is none.
pub(crate) fn as_array(mut rows: Vec<[i32; 4]>) -> Result<Vec<u8>, FormatError> {
    if rows.is_empty() {
        return Err(FormatError::new(
            "no voxel around the vehicle, and readers of such files expect one",
        ));
    }
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
