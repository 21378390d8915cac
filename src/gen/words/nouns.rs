//! Nouns of a reading: kinds of objects finer than the classes of boxes, and words that name several kinds.

use super::named::named;
use scene::{BoxName, Class};

named!(
    /// A kind of thing. `It` is what was spoken of last, `One` something of the kind that was spoken of last.
    Noun {
        Car = "car", Taxi = "taxi", PoliceCar = "police_car", Suv = "suv", Van = "van", Ambulance = "ambulance",
        Limousine = "limousine", Truck = "truck", Pickup = "pickup", Tanker = "tanker", DumpTruck = "dump_truck",
        GarbageTruck = "garbage_truck", FireTruck = "fire_truck", TowTruck = "tow_truck", BoxTruck = "box_truck",
        Semi = "semi", Bus = "bus", Minibus = "minibus", SchoolBus = "school_bus", Trailer = "trailer",
        Caravan = "caravan", ConstructionVehicle = "construction_vehicle", Excavator = "excavator",
        Bulldozer = "bulldozer", Crane = "crane", Roller = "roller", Forklift = "forklift", Tractor = "tractor",
        Loader = "loader", CementMixer = "cement_mixer", Motorcycle = "motorcycle", Scooter = "scooter",
        Bicycle = "bicycle", Person = "person", Man = "man", Woman = "woman", Child = "child", Worker = "worker",
        Policeman = "policeman", Cone = "cone", Barrier = "barrier", Vehicle = "vehicle",
        TwoWheeler = "two_wheeler", Thing = "thing", It = "it", One = "one",
    }
);

impl Noun {
    /// Classes of boxes that it may mean; the first is the one that is placed.
    pub fn classes(self) -> &'static [Class] {
        use Class as C;
        match self {
            Self::Car | Self::Taxi | Self::PoliceCar | Self::Suv | Self::Van | Self::Limousine => &[C::Car],
            Self::Truck
            | Self::Ambulance
            | Self::Pickup
            | Self::Tanker
            | Self::DumpTruck
            | Self::GarbageTruck
            | Self::FireTruck
            | Self::TowTruck
            | Self::BoxTruck
            | Self::Semi
            | Self::CementMixer => &[C::Truck],
            Self::Bus | Self::Minibus | Self::SchoolBus => &[C::Bus],
            Self::Trailer | Self::Caravan => &[C::Trailer],
            Self::ConstructionVehicle
            | Self::Excavator
            | Self::Bulldozer
            | Self::Crane
            | Self::Roller
            | Self::Forklift
            | Self::Tractor
            | Self::Loader => &[C::ConstructionVehicle],
            Self::Motorcycle | Self::Scooter => &[C::Motorcycle],
            Self::Bicycle => &[C::Bicycle],
            Self::Person | Self::Man | Self::Woman | Self::Child | Self::Worker | Self::Policeman => {
                &[C::Pedestrian]
            }
            Self::Cone => &[C::TrafficCone],
            Self::Barrier => &[C::Barrier],
            Self::Vehicle => &[
                C::Car,
                C::Truck,
                C::Bus,
                C::Trailer,
                C::ConstructionVehicle,
                C::Motorcycle,
            ],
            Self::TwoWheeler => &[C::Bicycle, C::Motorcycle],
            Self::Thing | Self::It | Self::One => &Class::OBJECTS,
        }
    }

    /// Usual length, width and height, m, where they differ from those of the class.
    pub fn size_m(self) -> Option<[f64; 3]> {
        Some(match self {
            Self::Suv => [4.8, 2.0, 1.85],
            Self::Van => [5.4, 2.1, 2.4],
            Self::Ambulance => [6.0, 2.2, 2.6],
            Self::Pickup => [5.6, 2.1, 1.9],
            Self::Minibus => [6.5, 2.2, 2.7],
            Self::Scooter => [1.8, 0.7, 1.4],
            Self::Child => [0.5, 0.5, 1.25],
            _ => return None,
        })
    }

    /// True if it is no more specific than the class: boxes of that noun have no name.
    pub fn is_plain(self) -> bool {
        matches!(
            self,
            Self::Car
                | Self::Truck
                | Self::Bus
                | Self::Trailer
                | Self::ConstructionVehicle
                | Self::Motorcycle
                | Self::Bicycle
                | Self::Person
                | Self::Cone
                | Self::Barrier
                | Self::Vehicle
                | Self::TwoWheeler
                | Self::Thing
                | Self::It
                | Self::One
        )
    }

    /// In words: `police car`.
    pub fn words(self) -> String {
        self.name().replace('_', " ")
    }

    /// The name that a box of this noun gets; empty for plain nouns.
    pub fn label(self) -> BoxName {
        if self.is_plain() {
            BoxName::default()
        } else {
            BoxName::new(&self.words())
        }
    }

    /// The plain noun of a class.
    pub fn of_class(class: Class) -> Self {
        const PLAIN: [Noun; 10] = [
            Noun::Car,
            Noun::Truck,
            Noun::Bus,
            Noun::Trailer,
            Noun::ConstructionVehicle,
            Noun::Motorcycle,
            Noun::Bicycle,
            Noun::Person,
            Noun::Cone,
            Noun::Barrier,
        ];
        PLAIN
            .into_iter()
            .find(|n| n.classes().first() == Some(&class))
            .unwrap_or(Self::Thing)
    }
}
