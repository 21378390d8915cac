//! Which numbers the classes have in a file of Occ3D's shape: three data sets share it.

use scene::{Class, Window};

/// How a file numbers its classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbering {
    /// Occ3D-nuScenes, as [`Class`]: 17 is free.
    Occ3d,
    /// OpenDriveLab's *openocc*, which has the same file name, array name and shape: car is 0, 16 is free.
    OpenOcc,
    /// Occ3D-Waymo, array `voxel_label`: 0 to 14, 23 in the files (15 after loading) is free.
    Waymo,
}

/// Classes of openocc in its order (`openocc_class_names` of the evaluation of SparseOcc).
const OPEN_OCC: [Class; 17] = [
    Class::Car,
    Class::Truck,
    Class::Trailer,
    Class::Bus,
    Class::ConstructionVehicle,
    Class::Bicycle,
    Class::Motorcycle,
    Class::Pedestrian,
    Class::TrafficCone,
    Class::Barrier,
    Class::DriveableSurface,
    Class::OtherFlat,
    Class::Sidewalk,
    Class::Terrain,
    Class::Manmade,
    Class::Vegetation,
    Class::Free,
];

/// Classes of Occ3D-Waymo in its order (readme of Occ3D), as the projects that train on both map them: general object,
/// vehicle, pedestrian, sign, cyclist, traffic light, pole, cone, bicycle, motorcycle, building, vegetation, tree trunk, road,
/// walkable.
const WAYMO: [Class; 15] = [
    Class::Others,
    Class::Car,
    Class::Pedestrian,
    Class::Manmade,
    Class::Bicycle,
    Class::Manmade,
    Class::Manmade,
    Class::TrafficCone,
    Class::Bicycle,
    Class::Motorcycle,
    Class::Manmade,
    Class::Vegetation,
    Class::Vegetation,
    Class::DriveableSurface,
    Class::Sidewalk,
];

/// Labels of free in files of Occ3D-Waymo, and in the arrays that its loaders make of them.
const WAYMO_FREE: [u8; 2] = [23, 15];

impl Numbering {
    /// The numbering of an array `semantics` with so many voxels of each label. Free is by far the most frequent label,
    /// so a file without 17 in which more than half of the voxels are 16 is openocc's.
    pub(super) fn of_histogram(counts: &[usize; 256]) -> Self {
        let free = usize::from(Class::FREE);
        match counts[free] == 0 && 2 * counts[free - 1] > Window::VOXELS {
            true => Self::OpenOcc,
            false => Self::Occ3d,
        }
    }

    /// The class that a label of the file stands for; `None` for a label without a class.
    pub fn class(self, label: u8) -> Option<Class> {
        let at = usize::from(label);
        match self {
            Self::Occ3d => Class::from_id(label),
            Self::OpenOcc => OPEN_OCC.get(at).copied(),
            Self::Waymo if WAYMO_FREE.contains(&label) => Some(Class::Free),
            Self::Waymo => WAYMO.get(at).copied(),
        }
    }

    /// The labels that a file may hold, for a message.
    pub(super) fn expected(self) -> &'static str {
        match self {
            Self::Occ3d => "0 to 17",
            Self::OpenOcc => "0 to 16",
            Self::Waymo => "0 to 14, and 15 or 23 for free",
        }
    }

    /// Note on what was assumed of the file's labels, for a person; `None` for the usual ones.
    pub fn note(self) -> Option<&'static str> {
        match self {
            Self::Occ3d => None,
            Self::OpenOcc => {
                Some("labels taken for those of OpenDriveLab's openocc (16 is free) and renumbered")
            }
            Self::Waymo => Some(
                "labels of Occ3D-Waymo renumbered: vehicles as cars; signs, lights, poles and buildings as manmade; cyclists as \
                 bicycles; walkable as sidewalk",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_label_has_its_class() {
        let of = |n: Numbering| (0..=255).filter_map(|l| n.class(l)).collect::<Vec<_>>();
        assert_eq!(of(Numbering::Occ3d), Class::ALL);
        assert_eq!(of(Numbering::OpenOcc), OPEN_OCC);
        // Every class but "others" once.
        let mut classes = OPEN_OCC.to_vec();
        classes.sort();
        assert_eq!(classes, Class::ALL[1..]);
        assert_eq!(Numbering::OpenOcc.class(0), Some(Class::Car));
        assert_eq!(Numbering::OpenOcc.class(17), None);
        assert_eq!(Numbering::Waymo.class(13), Some(Class::DriveableSurface));
        assert_eq!(Numbering::Waymo.class(23), Some(Class::Free));
        assert_eq!(Numbering::Waymo.class(15), Some(Class::Free));
        assert_eq!([16, 22, 24].map(|l| Numbering::Waymo.class(l)), [None; 3]);
    }

    #[test]
    fn the_most_frequent_label_tells() {
        let counts = |of: &[(usize, usize)]| {
            let mut counts = [0; 256];
            of.iter().for_each(|(label, n)| counts[*label] = *n);
            Numbering::of_histogram(&counts)
        };
        assert_eq!(counts(&[(17, 600_000), (16, 40_000)]), Numbering::Occ3d);
        assert_eq!(counts(&[(16, 600_000), (10, 40_000)]), Numbering::OpenOcc);
        // A single free voxel of Occ3D decides, and so does a file without a label that could be free.
        assert_eq!(counts(&[(16, 639_999), (17, 1)]), Numbering::Occ3d);
        assert_eq!(counts(&[(16, 320_000), (15, 320_000)]), Numbering::Occ3d);
    }
}
