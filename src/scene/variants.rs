//! Sizes of real objects of each class, to choose from when a box is placed.

use super::Class;

/// A kind of object within a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// One of the ten object classes, as nuScenes sorts them: vans and people carriers are cars, pickups trucks.
    pub class: Class,
    /// Name shown to a person.
    pub name: &'static str,
    /// Length, width (without mirrors), height, m.
    pub size_m: [f64; 3],
}

const fn v(class: Class, name: &'static str, size_m: [f64; 3]) -> Variant {
    Variant { class, name, size_m }
}

/// Every kind. Sizes are those of common models (data sheets, rounded to 5 cm) and of the largest
/// vehicles that EU directive 96/53 allows: 2.55 m wide, 4.0 m high, buses 12, 15 and 18.75 m long.
pub const VARIANTS: [Variant; 45] = [
    v(Class::Car, "Microcar", [2.70, 1.65, 1.55]),
    v(Class::Car, "Compact", [4.05, 1.75, 1.45]),
    v(Class::Car, "Saloon", [4.70, 1.85, 1.45]),
    v(Class::Car, "Estate", [4.85, 1.85, 1.50]),
    v(Class::Car, "SUV", [4.70, 1.90, 1.70]),
    v(Class::Car, "Large SUV", [5.10, 2.00, 1.80]),
    v(Class::Car, "People carrier", [4.95, 1.95, 1.90]),
    v(Class::Car, "Delivery van", [5.95, 2.00, 2.60]),
    v(Class::Truck, "Pickup", [5.35, 1.90, 1.85]),
    v(Class::Truck, "Full-size pickup", [5.90, 2.05, 2.00]),
    v(Class::Truck, "Box truck, 7.5 t", [8.00, 2.50, 3.40]),
    v(Class::Truck, "Rigid, three axles", [10.00, 2.55, 3.80]),
    v(Class::Truck, "Tractor unit", [6.00, 2.50, 3.80]),
    v(Class::Truck, "Refuse collector", [10.20, 2.55, 3.60]),
    v(Class::Truck, "Fire engine", [8.20, 2.50, 3.30]),
    v(Class::Bus, "Minibus", [7.40, 2.05, 2.80]),
    v(Class::Bus, "City bus", [12.00, 2.55, 3.05]),
    v(Class::Bus, "Articulated bus", [18.00, 2.55, 3.10]),
    v(Class::Bus, "Coach", [13.00, 2.55, 3.75]),
    v(Class::Bus, "Double decker", [10.90, 2.55, 4.40]),
    v(Class::Trailer, "Semi-trailer", [13.60, 2.55, 4.00]),
    v(Class::Trailer, "Tank trailer", [12.00, 2.55, 3.60]),
    v(Class::Trailer, "Caravan", [6.50, 2.30, 2.60]),
    v(Class::Trailer, "Car trailer", [3.00, 1.60, 1.00]),
    v(Class::ConstructionVehicle, "Mini digger", [4.00, 1.60, 2.40]),
    v(Class::ConstructionVehicle, "Excavator", [9.50, 2.90, 3.10]),
    v(Class::ConstructionVehicle, "Wheel loader", [8.30, 2.70, 3.40]),
    v(Class::ConstructionVehicle, "Road roller", [4.70, 2.20, 3.00]),
    v(Class::ConstructionVehicle, "Mobile crane", [12.60, 2.75, 3.80]),
    v(Class::Motorcycle, "Scooter", [1.85, 0.70, 1.15]),
    v(Class::Motorcycle, "Scooter with rider", [1.85, 0.75, 1.65]),
    v(Class::Motorcycle, "Tourer", [2.40, 0.95, 1.45]),
    v(Class::Bicycle, "Bicycle, parked", [1.80, 0.60, 1.10]),
    v(Class::Bicycle, "Bicycle with rider", [1.80, 0.60, 1.75]),
    v(Class::Bicycle, "Cargo bicycle", [2.50, 0.90, 1.70]),
    v(Class::Pedestrian, "Child", [0.45, 0.45, 1.20]),
    v(Class::Pedestrian, "Tall adult", [0.75, 0.75, 1.90]),
    v(Class::Pedestrian, "Wheelchair user", [1.10, 0.70, 1.35]),
    v(Class::Pedestrian, "With pram", [1.60, 0.65, 1.70]),
    v(Class::Barrier, "Concrete, 3 m", [0.60, 3.00, 0.85]),
    v(Class::Barrier, "Water-filled", [0.50, 2.00, 1.00]),
    v(Class::Barrier, "Traffic board", [0.35, 1.00, 1.10]),
    v(Class::TrafficCone, "Cone, 50 cm", [0.30, 0.30, 0.50]),
    v(Class::TrafficCone, "Cone, 75 cm", [0.40, 0.40, 0.75]),
    v(Class::TrafficCone, "Post, 1 m", [0.30, 0.30, 1.00]),
];

/// The kinds of a class; its typical size ([`Class::typical_size_m`]) is not among them.
pub fn of_class(class: Class) -> impl Iterator<Item = &'static Variant> {
    VARIANTS.iter().filter(move |v| v.class == class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_class_has_kinds_near_its_typical_size() {
        for class in Class::OBJECTS {
            let [l, w, h] = class.typical_size_m().expect("an object");
            assert!(of_class(class).count() >= 3, "{class:?}");
            for kind in of_class(class) {
                for (found, typical) in kind.size_m.into_iter().zip([l, w, h]) {
                    assert!((0.2..3.0).contains(&(found / typical)), "{kind:?}");
                }
            }
        }
        assert!(VARIANTS.iter().all(|v| v.class.is_object()));
        let mut names: Vec<_> = VARIANTS.iter().map(|v| v.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), VARIANTS.len());
    }
}
