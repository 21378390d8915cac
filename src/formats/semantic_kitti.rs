//! Voxels of SemanticKITTI's scene completion (PRBonn/semantic-kitti-api, `SSCDataset`): for each frame four files in
//! `sequences/NN/voxels/`, 256 x 256 x 32 cells of 0.2 m in C order, in the frame of the LiDAR: x forward, y left, z up.
//!
//! - `NNNNNN.label`: a little-endian u16 per cell, the raw id of its class, 0 where it is free;
//! - `.invalid`, `.occluded`, `.bin`: a bit per cell, the highest bit of a byte first: what no scan of the sequence saw; what
//!   the one scan does not see; where the one scan has points.
//!
//! A scene's LiDAR may be mounted at any turn: the cells are along the axes of the ego frame, around its place.

use scene::label_sets::SEMANTIC_KITTI;
use scene::{Class, LidarPattern, Pose};

use crate::voxels::{DataCells, DataMap};

/// Where the cells lie, around the LiDAR.
pub(crate) const LATTICE: DataCells = DataCells {
    size: [256, 256, 32],
    cell_m: 0.2,
    min_m: [0.0, -25.6, -2.0],
};
/// Cells in all.
pub(crate) const CELLS: usize = 256 * 256 * 32;
/// Bytes of a file with a bit per cell.
pub(crate) const BIT_BYTES: usize = CELLS / 8;

/// Label of points that belong to no object: reflections and dust.
pub(crate) const OUTLIER: u16 = 1;

/// The class of a point with that label; `None` for numbers that no label has, and for [`OUTLIER`]. A point without a label is
/// of the class others.
pub(crate) fn class_of_point(label: u16) -> Option<Class> {
    let known = SEMANTIC_KITTI.class(label).filter(|_| label != OUTLIER);
    known.map(|class| {
        if class == Class::Free {
            Class::Others
        } else {
            class
        }
    })
}

/// The label of a point of a class, on an object that moves or does not.
pub(crate) fn label_of(class: Class, moves: bool) -> u16 {
    let moving = match class {
        Class::Car => 252,
        Class::Bicycle => 253,
        Class::Pedestrian => 254,
        Class::Motorcycle => 255,
        Class::Bus => 257,
        Class::Truck => 258,
        Class::ConstructionVehicle | Class::Trailer => 259,
        _ => return SEMANTIC_KITTI.label(class),
    };
    if moves {
        moving
    } else {
        SEMANTIC_KITTI.label(class)
    }
}

/// Where the cells' frame is: at the place of the LiDAR, along the axes of the ego frame.
pub(crate) fn ego_from_cells(lidar: &LidarPattern) -> Pose {
    Pose {
        translation_m: lidar.translation_m.into(),
        ..Pose::IDENTITY
    }
}

/// The map of the cells around a LiDAR. Errors in one line.
pub(crate) fn own_map(lidar: &LidarPattern) -> Result<DataMap, String> {
    DataMap::new(&LATTICE, &ego_from_cells(lidar))
}

/// A bit per cell as bytes.
pub(crate) fn packed(bits: &[bool]) -> Vec<u8> {
    let byte = |bits: &[bool]| {
        let set = bits.iter().enumerate().filter(|(_, bit)| **bit);
        set.fold(0, |byte, (i, _)| byte | 0x80 >> i)
    };
    bits.chunks(8).map(byte).collect()
}

/// True where the bit of a cell is set.
pub(crate) fn bit(packed: &[u8], cell: usize) -> bool {
    packed
        .get(cell / 8)
        .is_some_and(|byte| byte << (cell % 8) & 0x80 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_cell_is_the_highest_bit() {
        let mut bits = vec![false; 16];
        (bits[0], bits[6], bits[15]) = (true, true, true);
        let bytes = packed(&bits);
        assert_eq!(bytes, [0b1000_0010, 0b0000_0001]);
        assert!((0..16).all(|i| bit(&bytes, i) == bits[i]) && !bit(&bytes, 16));
    }
}
