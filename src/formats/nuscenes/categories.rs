//! The 32 categories of nuScenes-lidarseg in the order of their index, and the classes of the scene. As in the lidarseg
//! challenge, except that vehicles of the police and ambulances are vehicles here, with their name.

use scene::{BoxName, Class};

/// Meaning of a category in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Means {
    /// Points of it are left out.
    Nothing,
    /// A class.
    Class(Class),
    /// A class, and the name of a box of it.
    Named(Class, &'static str),
}

use Means::{Class as Is, Named, Nothing};

/// Name and meaning of every category; the place is the index in lidarseg files. Of several of one class the first that has
/// no name of its own is written.
pub const ALL: [(&str, Means); 32] = [
    ("noise", Nothing),
    ("animal", Is(Class::Others)),
    ("human.pedestrian.adult", Is(Class::Pedestrian)),
    ("human.pedestrian.child", Named(Class::Pedestrian, "child")),
    (
        "human.pedestrian.construction_worker",
        Named(Class::Pedestrian, "construction worker"),
    ),
    ("human.pedestrian.personal_mobility", Is(Class::Others)),
    (
        "human.pedestrian.police_officer",
        Named(Class::Pedestrian, "police officer"),
    ),
    ("human.pedestrian.stroller", Is(Class::Others)),
    ("human.pedestrian.wheelchair", Is(Class::Others)),
    ("movable_object.barrier", Is(Class::Barrier)),
    ("movable_object.debris", Is(Class::Others)),
    ("movable_object.pushable_pullable", Is(Class::Others)),
    ("movable_object.trafficcone", Is(Class::TrafficCone)),
    ("static_object.bicycle_rack", Is(Class::Others)),
    ("vehicle.bicycle", Is(Class::Bicycle)),
    ("vehicle.bus.bendy", Named(Class::Bus, "bendy bus")),
    ("vehicle.bus.rigid", Is(Class::Bus)),
    ("vehicle.car", Is(Class::Car)),
    ("vehicle.construction", Is(Class::ConstructionVehicle)),
    ("vehicle.emergency.ambulance", Named(Class::Truck, "ambulance")),
    ("vehicle.emergency.police", Named(Class::Car, "police car")),
    ("vehicle.motorcycle", Is(Class::Motorcycle)),
    ("vehicle.trailer", Is(Class::Trailer)),
    ("vehicle.truck", Is(Class::Truck)),
    ("flat.driveable_surface", Is(Class::DriveableSurface)),
    ("flat.other", Is(Class::OtherFlat)),
    ("flat.sidewalk", Is(Class::Sidewalk)),
    ("flat.terrain", Is(Class::Terrain)),
    ("static.manmade", Is(Class::Manmade)),
    ("static.other", Is(Class::Others)),
    ("static.vegetation", Is(Class::Vegetation)),
    ("vehicle.ego", Nothing),
];

/// Names of T4, the format of Autoware's data sets, which has the tables of nuScenes, and their meanings.
const OF_T4: [(&str, Means); 17] = [
    ("car", Is(Class::Car)),
    ("truck", Is(Class::Truck)),
    ("bus", Is(Class::Bus)),
    ("trailer", Is(Class::Trailer)),
    ("ambulance", Named(Class::Truck, "ambulance")),
    ("fire_truck", Named(Class::Truck, "fire engine")),
    ("police_car", Named(Class::Car, "police car")),
    ("construction_vehicle", Is(Class::ConstructionVehicle)),
    ("bicycle", Is(Class::Bicycle)),
    ("motorcycle", Is(Class::Motorcycle)),
    ("motorbike", Is(Class::Motorcycle)),
    ("pedestrian", Is(Class::Pedestrian)),
    (
        "construction_worker",
        Named(Class::Pedestrian, "construction worker"),
    ),
    ("police_officer", Named(Class::Pedestrian, "police officer")),
    ("barrier", Is(Class::Barrier)),
    ("traffic_cone", Is(Class::TrafficCone)),
    ("unknown", Is(Class::Others)),
];

/// Index of `static.other`, which points of the class "others" get.
const STATIC_OTHER: u8 = 29;

/// The meaning of the category of that name; `None` for a name that is in neither list.
pub fn meaning(name: &str) -> Option<Means> {
    ALL.iter()
        .chain(&OF_T4)
        .find(|(known, _)| *known == name)
        .map(|(_, means)| *means)
}

/// The category of points of a class.
pub fn of_points(class: Class) -> u8 {
    let plain = |(_, means): &(&str, Means)| *means == Is(class);
    match class {
        Class::Others => STATIC_OTHER,
        _ => ALL.iter().position(plain).unwrap_or(0) as u8,
    }
}

/// The category of a box: that of its name, if a category of its class has that name, else that of its class.
pub fn of_box(class: Class, name: &BoxName) -> u8 {
    let named = |(_, means): &(&str, Means)| match means {
        Named(of, called) => *of == class && called.eq_ignore_ascii_case(name.as_str()),
        _ => false,
    };
    match ALL.iter().position(named) {
        Some(index) => index as u8,
        None => of_points(class),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_that_is_there_has_a_category_and_comes_back() {
        for class in Class::ALL.into_iter().filter(|c| *c != Class::Free) {
            let (name, means) = ALL[usize::from(of_points(class))];
            assert_eq!(means, Is(class), "{name}");
            assert_eq!(meaning(name), Some(means));
        }
        // Numbers that the devkit names in its tests and tutorials.
        assert_eq!(of_points(Class::DriveableSurface), 24);
        assert_eq!(of_points(Class::Car), 17);
        assert_eq!(ALL[31].0, "vehicle.ego");
        let named = |class, name| ALL[usize::from(of_box(class, &BoxName::new(name)))].0;
        assert_eq!(named(Class::Pedestrian, "Child"), "human.pedestrian.child");
        assert_eq!(named(Class::Car, "child"), "vehicle.car");
        assert_eq!(named(Class::Bus, ""), "vehicle.bus.rigid");
        assert_eq!(meaning("vehicle"), None);
        assert_eq!(meaning("car"), Some(Is(Class::Car)));
    }
}
