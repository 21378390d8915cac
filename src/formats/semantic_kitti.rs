//! Voxels of SemanticKITTI's scene completion (PRBonn/semantic-kitti-api, `SSCDataset`): for each frame four files in
//! `sequences/NN/voxels/`, 256 x 256 x 32 cells of 0.2 m in C order, in the frame of the LiDAR: x forward, y left, z up.
//!
//! - `NNNNNN.label`: a little-endian u16 per cell, the raw id of its class, 0 where it is free;
//! - `.invalid`, `.occluded`, `.bin`: a bit per cell, the highest bit of a byte first: what no scan of the sequence saw; what
//!   the one scan does not see; where the one scan has points.
//!
//! A scene's LiDAR may be mounted at any turn: the cells are along the axes of the ego frame, around its place.

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

/// Raw ids with their names (`config/semantic-kitti.yaml`) and classes; `None` is free.
pub(crate) const RAW: [(u16, &str, Option<Class>); 34] = [
    (0, "unlabeled", None),
    (1, "outlier", Some(Class::Others)),
    (10, "car", Some(Class::Car)),
    (11, "bicycle", Some(Class::Bicycle)),
    (13, "bus", Some(Class::Bus)),
    (15, "motorcycle", Some(Class::Motorcycle)),
    (16, "on-rails", Some(Class::Others)),
    (18, "truck", Some(Class::Truck)),
    (20, "other-vehicle", Some(Class::Trailer)),
    (30, "person", Some(Class::Pedestrian)),
    (31, "bicyclist", Some(Class::Bicycle)),
    (32, "motorcyclist", Some(Class::Motorcycle)),
    (40, "road", Some(Class::DriveableSurface)),
    (44, "parking", Some(Class::DriveableSurface)),
    (48, "sidewalk", Some(Class::Sidewalk)),
    (49, "other-ground", Some(Class::OtherFlat)),
    (50, "building", Some(Class::Manmade)),
    (51, "fence", Some(Class::Manmade)),
    (52, "other-structure", Some(Class::Manmade)),
    (60, "lane-marking", Some(Class::DriveableSurface)),
    (70, "vegetation", Some(Class::Vegetation)),
    (71, "trunk", Some(Class::Vegetation)),
    (72, "terrain", Some(Class::Terrain)),
    (80, "pole", Some(Class::Manmade)),
    (81, "traffic-sign", Some(Class::Manmade)),
    (99, "other-object", Some(Class::Others)),
    (252, "moving-car", Some(Class::Car)),
    (253, "moving-bicyclist", Some(Class::Bicycle)),
    (254, "moving-person", Some(Class::Pedestrian)),
    (255, "moving-motorcyclist", Some(Class::Motorcycle)),
    (256, "moving-on-rails", Some(Class::Others)),
    (257, "moving-bus", Some(Class::Bus)),
    (258, "moving-truck", Some(Class::Truck)),
    (259, "moving-other-vehicle", Some(Class::Trailer)),
];

/// The raw id that a class is written as.
pub(crate) fn raw_id(class: Class) -> u16 {
    let name = match class {
        Class::Others | Class::TrafficCone => "other-object",
        Class::Barrier => "fence",
        Class::Bicycle => "bicycle",
        Class::Bus => "bus",
        Class::Car => "car",
        Class::ConstructionVehicle | Class::Trailer => "other-vehicle",
        Class::Motorcycle => "motorcycle",
        Class::Pedestrian => "person",
        Class::Truck => "truck",
        Class::DriveableSurface => "road",
        Class::OtherFlat => "other-ground",
        Class::Sidewalk => "sidewalk",
        Class::Terrain => "terrain",
        Class::Manmade => "building",
        Class::Vegetation => "vegetation",
        Class::Free => "unlabeled",
    };
    let known = RAW.iter().find(|(_, of, _)| *of == name);
    known.map_or(0, |(id, ..)| *id)
}

/// The class of a raw id. The outer `None` is an id that is not known, the inner one is free.
pub(crate) fn class_of(raw: u16) -> Option<Option<Class>> {
    let at = RAW.binary_search_by_key(&raw, |(id, ..)| *id).ok()?;
    Some(RAW[at].2)
}

/// Label of points that belong to no object: reflections and dust.
pub(crate) const OUTLIER: u16 = 1;

/// The class of a point with that label; `None` for numbers that no label has, and for [`OUTLIER`]. A point without a label is
/// of the class others.
pub(crate) fn class_of_point(label: u16) -> Option<Class> {
    let known = class_of(label).filter(|_| label != OUTLIER);
    known.map(|class| class.unwrap_or(Class::Others))
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
        _ => return raw_id(class),
    };
    if moves { moving } else { raw_id(class) }
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
    DataMap::new(&LATTICE, &ego_from_cells(lidar), lidar)
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
    fn ids_ascend_and_classes_have_one() {
        assert!(RAW.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for class in Class::ALL {
            let raw = raw_id(class);
            assert_eq!(raw == 0, class == Class::Free, "{class:?}");
            let back = class_of(raw).expect("known").unwrap_or(Class::Free);
            let expected = match class {
                Class::Barrier => Class::Manmade,
                Class::ConstructionVehicle => Class::Trailer,
                Class::TrafficCone => Class::Others,
                same => same,
            };
            assert_eq!(back, expected);
        }
        assert_eq!(class_of(2), None);
        assert_eq!(class_of(252), Some(Some(Class::Car)));
    }

    #[test]
    fn the_first_cell_is_the_highest_bit() {
        let mut bits = vec![false; 16];
        (bits[0], bits[6], bits[15]) = (true, true, true);
        let bytes = packed(&bits);
        assert_eq!(bytes, [0b1000_0010, 0b0000_0001]);
        assert!((0..16).all(|i| bit(&bytes, i) == bits[i]) && !bit(&bytes, 16));
    }
}
