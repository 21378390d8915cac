//! The label sets that are known: a table a data set, and one list of all. Another set is another table here.

use super::Class;
use super::label_set::{LabelRow, LabelSet};

/// Every label set.
pub const ALL: [&LabelSet; 5] = [&NUSCENES, &OPEN_OCC, &OCC3D_WAYMO, &SEMANTIC_KITTI, &NUPLAN_OCC];

/// The set of that name.
pub fn from_id(id: &str) -> Option<&'static LabelSet> {
    ALL.into_iter().find(|set| set.id == id)
}

const fn row(label: u16, name: &'static str, class: Class) -> LabelRow {
    LabelRow { label, name, class }
}

/// Labels of nuScenes' lidarseg as Occ3D, OpenOccupancy and SurroundOcc use them: those of [`Class`], and noise.
pub static NUSCENES: LabelSet = LabelSet {
    id: "nuscenes",
    title: "nuScenes",
    rows: &[
        row(0, "others", Class::Others),
        row(1, "barrier", Class::Barrier),
        row(2, "bicycle", Class::Bicycle),
        row(3, "bus", Class::Bus),
        row(4, "car", Class::Car),
        row(5, "construction_vehicle", Class::ConstructionVehicle),
        row(6, "motorcycle", Class::Motorcycle),
        row(7, "pedestrian", Class::Pedestrian),
        row(8, "traffic_cone", Class::TrafficCone),
        row(9, "trailer", Class::Trailer),
        row(10, "truck", Class::Truck),
        row(11, "driveable_surface", Class::DriveableSurface),
        row(12, "other_flat", Class::OtherFlat),
        row(13, "sidewalk", Class::Sidewalk),
        row(14, "terrain", Class::Terrain),
        row(15, "manmade", Class::Manmade),
        row(16, "vegetation", Class::Vegetation),
        row(17, "free", Class::Free),
        row(255, "noise", Class::Others),
    ],
    written: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17],
};

/// Labels of OpenDriveLab's openocc (`openocc_class_names` of the evaluation of SparseOcc). It has no *others*.
pub static OPEN_OCC: LabelSet = LabelSet {
    id: "openocc",
    title: "OpenDriveLab's openocc",
    rows: &[
        row(0, "car", Class::Car),
        row(1, "truck", Class::Truck),
        row(2, "trailer", Class::Trailer),
        row(3, "bus", Class::Bus),
        row(4, "construction_vehicle", Class::ConstructionVehicle),
        row(5, "bicycle", Class::Bicycle),
        row(6, "motorcycle", Class::Motorcycle),
        row(7, "pedestrian", Class::Pedestrian),
        row(8, "traffic_cone", Class::TrafficCone),
        row(9, "barrier", Class::Barrier),
        row(10, "driveable_surface", Class::DriveableSurface),
        row(11, "other_flat", Class::OtherFlat),
        row(12, "sidewalk", Class::Sidewalk),
        row(13, "terrain", Class::Terrain),
        row(14, "manmade", Class::Manmade),
        row(15, "vegetation", Class::Vegetation),
        row(16, "free", Class::Free),
    ],
    written: [14, 9, 5, 3, 0, 4, 6, 7, 8, 2, 1, 10, 11, 12, 13, 14, 15, 16],
};

/// Labels of Occ3D-Waymo (its readme), with the classes that projects give them that train on both. Free is 23 in files and 15
/// after loading.
pub static OCC3D_WAYMO: LabelSet = LabelSet {
    id: "occ3d-waymo",
    title: "Occ3D-Waymo",
    rows: &[
        row(0, "general object", Class::Others),
        row(1, "vehicle", Class::Car),
        row(2, "pedestrian", Class::Pedestrian),
        row(3, "sign", Class::Manmade),
        row(4, "cyclist", Class::Bicycle),
        row(5, "traffic light", Class::Manmade),
        row(6, "pole", Class::Manmade),
        row(7, "construction cone", Class::TrafficCone),
        row(8, "bicycle", Class::Bicycle),
        row(9, "motorcycle", Class::Motorcycle),
        row(10, "building", Class::Manmade),
        row(11, "vegetation", Class::Vegetation),
        row(12, "tree trunk", Class::Vegetation),
        row(13, "road", Class::DriveableSurface),
        row(14, "walkable", Class::Sidewalk),
        row(15, "free", Class::Free),
        row(23, "free", Class::Free),
    ],
    written: [0, 0, 8, 1, 1, 1, 9, 2, 7, 1, 1, 13, 14, 14, 14, 10, 11, 23],
};

/// Raw ids of SemanticKITTI (`config/semantic-kitti.yaml`).
pub static SEMANTIC_KITTI: LabelSet = LabelSet {
    id: "semantic-kitti",
    title: "SemanticKITTI",
    rows: &[
        row(0, "unlabeled", Class::Free),
        row(1, "outlier", Class::Others),
        row(10, "car", Class::Car),
        row(11, "bicycle", Class::Bicycle),
        row(13, "bus", Class::Bus),
        row(15, "motorcycle", Class::Motorcycle),
        row(16, "on-rails", Class::Others),
        row(18, "truck", Class::Truck),
        row(20, "other-vehicle", Class::Trailer),
        row(30, "person", Class::Pedestrian),
        row(31, "bicyclist", Class::Bicycle),
        row(32, "motorcyclist", Class::Motorcycle),
        row(40, "road", Class::DriveableSurface),
        row(44, "parking", Class::DriveableSurface),
        row(48, "sidewalk", Class::Sidewalk),
        row(49, "other-ground", Class::OtherFlat),
        row(50, "building", Class::Manmade),
        row(51, "fence", Class::Manmade),
        row(52, "other-structure", Class::Manmade),
        row(60, "lane-marking", Class::DriveableSurface),
        row(70, "vegetation", Class::Vegetation),
        row(71, "trunk", Class::Vegetation),
        row(72, "terrain", Class::Terrain),
        row(80, "pole", Class::Manmade),
        row(81, "traffic-sign", Class::Manmade),
        row(99, "other-object", Class::Others),
        row(252, "moving-car", Class::Car),
        row(253, "moving-bicyclist", Class::Bicycle),
        row(254, "moving-person", Class::Pedestrian),
        row(255, "moving-motorcyclist", Class::Motorcycle),
        row(256, "moving-on-rails", Class::Others),
        row(257, "moving-bus", Class::Bus),
        row(258, "moving-truck", Class::Truck),
        row(259, "moving-other-vehicle", Class::Trailer),
    ],
    written: [
        99, 51, 11, 13, 10, 20, 15, 30, 99, 20, 18, 40, 49, 48, 72, 50, 70, 0,
    ],
};

/// Labels of Nuplan-Occ (`nuplan.yaml` of UniScene's second version). All that is no object is *background*: its reader tells
/// ground from what stands on it.
pub static NUPLAN_OCC: LabelSet = LabelSet {
    id: "nuplan-occ",
    title: "Nuplan-Occ",
    rows: &[
        row(0, "vehicle", Class::Car),
        row(1, "bicycle", Class::Bicycle),
        row(2, "pedestrian", Class::Pedestrian),
        row(3, "traffic_cone", Class::TrafficCone),
        row(4, "barrier", Class::Barrier),
        row(5, "czone_sign", Class::Barrier),
        row(6, "generic_object", Class::Others),
        row(7, "background", Class::Manmade),
    ],
    // (what is free has no row, and 8 is no label)
    written: [6, 4, 1, 0, 0, 0, 1, 2, 3, 0, 0, 7, 7, 7, 7, 7, 7, 8],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_ascend_and_each_class_has_one_of_its_set() {
        for set in ALL {
            assert!(
                set.rows.windows(2).all(|pair| pair[0].label < pair[1].label),
                "{}",
                set.id
            );
            assert_eq!(from_id(set.id).map(|s| s.id), Some(set.id));
            for class in Class::ALL {
                let written = set.label(class);
                let back = set.class(written);
                // A set that has a class gives it back.
                let has = set.rows.iter().any(|row| row.class == class);
                match has {
                    true => assert_eq!(back, Some(class), "{}: {class:?}", set.id),
                    false => assert!(back != Some(Class::Free), "{}: {class:?}", set.id),
                }
            }
        }
    }

    #[test]
    fn numbers_are_told_in_runs() {
        assert_eq!(OCC3D_WAYMO.numbers(), "0 to 15, 23");
        assert_eq!(OPEN_OCC.numbers(), "0 to 16");
    }
}
