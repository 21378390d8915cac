//! The numbers of SemanticKITTI's labels (PRBonn/semantic-kitti-api, config/semantic-kitti.yaml) and the classes of Occ3D.

use scene::Class;

/// Points of nothing: reflections and dust.
pub const OUTLIER: u16 = 1;

/// Every number that labels may have, but [`OUTLIER`], and its class.
const CLASSES: [(u16, Class); 33] = [
    (0, Class::Others), // unlabelled
    (10, Class::Car),
    (11, Class::Bicycle),
    (13, Class::Bus),
    (15, Class::Motorcycle),
    (16, Class::Others), // on rails
    (18, Class::Truck),
    (20, Class::Trailer), // other vehicle
    (30, Class::Pedestrian),
    (31, Class::Bicycle),    // bicyclist
    (32, Class::Motorcycle), // motorcyclist
    (40, Class::DriveableSurface),
    (44, Class::DriveableSurface), // parking
    (48, Class::Sidewalk),
    (49, Class::OtherFlat),
    (50, Class::Manmade),          // building
    (51, Class::Manmade),          // fence
    (52, Class::Manmade),          // other structure
    (60, Class::DriveableSurface), // lane marking
    (70, Class::Vegetation),
    (71, Class::Vegetation), // trunk
    (72, Class::Terrain),
    (80, Class::Manmade), // pole
    (81, Class::Manmade), // traffic sign
    (99, Class::Others),  // other object
    (252, Class::Car),    // from here on: moving
    (253, Class::Bicycle),
    (254, Class::Pedestrian),
    (255, Class::Motorcycle),
    (256, Class::Others), // on rails
    (257, Class::Bus),
    (258, Class::Truck),
    (259, Class::Trailer),
];

/// The class of a label, without its instance; `None` for numbers that no label has, and for [`OUTLIER`].
pub fn class_of(label: u16) -> Option<Class> {
    let found = CLASSES.binary_search_by_key(&label, |(number, _)| *number).ok();
    found.map(|at| CLASSES[at].1)
}

/// The label of a class, of an object that moves or does not; 0 for free. SemanticKITTI knows no construction vehicles (other
/// vehicle), barriers (fence), traffic cones (other object) and does not tell buildings from all that is built (building).
pub fn label_of(class: Class, moves: bool) -> u16 {
    let (still, moving) = match class {
        Class::Car => (10, 252),
        Class::Bicycle => (11, 253),
        Class::Bus => (13, 257),
        Class::Motorcycle => (15, 255),
        Class::Truck => (18, 258),
        Class::ConstructionVehicle | Class::Trailer => (20, 259),
        Class::Pedestrian => (30, 254),
        Class::DriveableSurface => (40, 40),
        Class::Sidewalk => (48, 48),
        Class::OtherFlat => (49, 49),
        Class::Manmade => (50, 50),
        Class::Barrier => (51, 51),
        Class::Vegetation => (70, 70),
        Class::Terrain => (72, 72),
        Class::Others | Class::TrafficCone => (99, 99),
        Class::Free => (0, 0),
    };
    if moves { moving } else { still }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_both_know_comes_back() {
        assert!(CLASSES.is_sorted_by_key(|(number, _)| *number));
        for class in Class::ALL {
            let expected = match class {
                Class::ConstructionVehicle => Class::Trailer,
                Class::Barrier => Class::Manmade,
                Class::TrafficCone | Class::Free => Class::Others,
                same => same,
            };
            for moves in [false, true] {
                assert_eq!(
                    class_of(label_of(class, moves)),
                    Some(expected),
                    "{class:?} {moves}"
                );
            }
        }
        for unknown in [1, 2, 12, 100, 251, 260, u16::MAX] {
            assert_eq!(class_of(unknown), None, "{unknown}");
        }
    }
}
