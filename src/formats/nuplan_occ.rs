//! Nuplan-Occ (Arlo0o/UniScene, branch v2, `generate_occ_nuplan.py`): an `.npz` with the array `occ`, a row per voxel that is
//! not free: x, y, z and a label of [`NUPLAN_OCC`], in 400 x 400 x 32 cells of 0.25 m along the vehicle's axes.
//!
//! How high the frame's origin is above the ground, the files do not say, and parts of the data set differ (`-3 ~ 5`, `-5 ~ 3`):
//! the ground is looked for in the voxels.

use scene::label_sets::NUPLAN_OCC;
use scene::{LidarPattern, Pose, Scene};

use crate::sparse_npy::{as_array, own_rows, resampled_rows};
use crate::voxels::{DataCells, DataMap};
use crate::{FormatError, npz};

/// Name of the array.
pub(crate) const ARRAY: &str = "occ";

/// Where the cells lie.
pub(crate) const LATTICE: DataCells = DataCells {
    size: [400, 400, 32],
    cell_m: 0.25,
    min_m: [-50.0, -50.0, -3.0],
};

/// Where the cells' frame is, the middle of a layer of them being on the ground.
pub(crate) fn ego_from_cells(ground: usize) -> Pose {
    let up = -LATTICE.center([0, 0, ground]).z;
    Pose {
        translation_m: [0.0, 0.0, up].into(),
        ..Pose::IDENTITY
    }
}

/// The data set's own map, if that of a scene holds it, whatever layer the ground is.
pub(crate) fn own_map(scene: &Scene) -> Option<DataMap> {
    let maps = (0..LATTICE.size[2]).filter_map(|ground| DataMap::new(&LATTICE, &ego_from_cells(ground)).ok());
    maps.into_iter().find(|map| map.lies_in(scene.frame().extent()))
}

/// A scene as such a file; one in other voxels around its first LiDAR, at its height above the ground.
pub(crate) fn to_bytes(scene: &Scene) -> Result<Vec<u8>, FormatError> {
    let rows = match own_map(scene) {
        Some(map) => own_rows(scene.frame(), &map, &NUPLAN_OCC)?,
        None => {
            let around: fn(&LidarPattern) -> Pose = |lidar| Pose {
                translation_m: lidar.translation_m.into(),
                ..Pose::IDENTITY
            };
            let lidar = scene.rig.lidars.first();
            let lidar =
                lidar.ok_or_else(|| FormatError::new("the rig has no LiDAR, around which the voxels are"))?;
            resampled_rows(scene.frame(), &LATTICE, &around(lidar), &NUPLAN_OCC)?
        }
    };
    npz::holding(ARRAY, &as_array(rows)?).map_err(FormatError::new)
}
