//! Definitions that reading and writing LAS share (ASPRS LAS 1.4 R15): classes, lengths of records, names of own
//! fields.

use scene::Class;

/// Name of the extra byte with the class in Occ3D, 0 to 17.
pub const CLASS_FIELD: &str = "occ3d_class";
/// Name of the extra bytes with the ring of the LiDAR.
pub const RING_FIELD: &str = "ring";
/// Name of the program that wrote the file, in the header: a file of this program has its points in the ego frame.
pub const SOFTWARE: &str = "sceneloom";
/// Classes that the standard has no number for are written as this and their number in Occ3D: 64 to 255 are for users.
const FIRST_OF_USERS: u8 = 64;

/// Meaning of a classification of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asprs {
    /// A class.
    Class(Class),
    /// No class yet: never classified, unclassified, reserved.
    Unclassified,
    /// Noise, an echo of no object.
    Noise,
    /// A number that users may give any meaning.
    OfUsers,
}

/// Numbers of the standard that stand for a class.
const CLASSES: [(u8, Class); 16] = [
    (11, Class::DriveableSurface), // road surface
    (17, Class::DriveableSurface), // bridge deck
    (2, Class::Terrain),           // ground
    (20, Class::Terrain),          // ignored ground
    (21, Class::Terrain),          // snow
    (9, Class::OtherFlat),         // water
    (10, Class::OtherFlat),        // rail
    (3, Class::Vegetation),        // low
    (4, Class::Vegetation),        // medium
    (5, Class::Vegetation),        // high
    (6, Class::Manmade),           // building
    (13, Class::Manmade),          // wire, guard
    (14, Class::Manmade),          // wire, conductor
    (15, Class::Manmade),          // transmission tower
    (16, Class::Manmade),          // connector of wires
    (19, Class::Manmade),          // overhead structure
];

/// The meaning of a number of the standard.
pub fn of_asprs(number: u8) -> Asprs {
    match number {
        7 | 18 => Asprs::Noise,
        FIRST_OF_USERS.. => Asprs::OfUsers,
        _ => CLASSES
            .iter()
            .find(|(n, _)| *n == number)
            .map_or(Asprs::Unclassified, |(_, class)| Asprs::Class(*class)),
    }
}

/// The number of the standard for a class, with `height_m` the height of the point above the ground. Ground other than
/// road is 2; a class without a number of the standard is 64 plus its number in Occ3D.
pub fn asprs_of(class: Class, height_m: f64) -> u8 {
    match class {
        Class::DriveableSurface => 11,
        Class::Terrain | Class::Sidewalk | Class::OtherFlat => 2,
        Class::Manmade => 6,
        Class::Vegetation if height_m < 0.5 => 3,
        Class::Vegetation if height_m < 2.0 => 4,
        Class::Vegetation => 5,
        other => FIRST_OF_USERS + other.id(),
    }
}

/// Bytes of a point of this format without extra bytes; `None` for a format that does not exist.
pub fn record_length(format: u8) -> Option<usize> {
    const LENGTHS: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    LENGTHS.get(usize::from(format)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_with_a_number_come_back_and_the_others_are_of_users() {
        for class in Class::ALL {
            let back: Vec<Asprs> = [0.0, 1.0, 9.0].map(|h| of_asprs(asprs_of(class, h))).into();
            let expected = match class {
                Class::Sidewalk | Class::OtherFlat | Class::Terrain => Asprs::Class(Class::Terrain),
                Class::DriveableSurface | Class::Manmade | Class::Vegetation => Asprs::Class(class),
                _ => Asprs::OfUsers,
            };
            assert_eq!(back, [expected; 3], "{class:?}");
        }
        for number in [0, 1, 8, 12, 22, 63] {
            assert_eq!(of_asprs(number), Asprs::Unclassified, "{number}");
        }
        assert_eq!([7, 18].map(of_asprs), [Asprs::Noise; 2]);
        assert_eq!((record_length(6), record_length(11)), (Some(30), None));
    }
}
