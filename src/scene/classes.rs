//! The 18 occupancy classes (Occ3D ids), the 18 BEV layers (UniScene order), their names and colours.

use std::sync::atomic::{AtomicBool, Ordering};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An Occ3D class; the discriminant is the label value. Names and ids follow nuScenes.
#[expect(missing_docs, reason = "the names are the field's own")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Class {
    Others = 0,
    Barrier,
    Bicycle,
    Bus,
    Car,
    ConstructionVehicle,
    Motorcycle,
    Pedestrian,
    TrafficCone,
    Trailer,
    Truck,
    DriveableSurface,
    OtherFlat,
    Sidewalk,
    Terrain,
    Manmade,
    Vegetation,
    Free,
}

/// Colours of the classes on screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Palette {
    /// Close to the data set's own.
    #[default]
    Standard,
    /// Told apart with red-green blindness too: blue against orange and yellow, and by lightness.
    ColorBlindSafe,
}

/// The one palette of this process, as the display has one viewer. Commands never change it.
static SAFE: AtomicBool = AtomicBool::new(false);

impl Palette {
    /// The palette in use.
    pub fn current() -> Self {
        if SAFE.load(Ordering::Relaxed) {
            Palette::ColorBlindSafe
        } else {
            Palette::Standard
        }
    }

    /// Uses this palette from now on; pictures made before keep their colours.
    pub fn make_current(self) {
        SAFE.store(self == Palette::ColorBlindSafe, Ordering::Relaxed);
    }
}

/// After Okabe and Ito (2008), objects saturated, surroundings pale or dark.
const SAFE_COLORS: [[u8; 3]; 18] = [
    [128, 128, 128],
    [190, 120, 40],
    [204, 121, 167],
    [240, 228, 66],
    [0, 114, 178],
    [0, 190, 170],
    [230, 159, 0],
    [213, 94, 0],
    [255, 250, 200],
    [120, 80, 40],
    [86, 180, 233],
    [84, 88, 100],
    [150, 150, 146],
    [178, 166, 186],
    [176, 182, 150],
    [214, 212, 220],
    [44, 92, 70],
    [0, 0, 0],
];

impl Class {
    /// Number of classes, free included.
    pub const COUNT: usize = 18;
    /// Label value of empty space.
    pub const FREE: u8 = Class::Free as u8;
    /// Every class in the order of its label value.
    pub const ALL: [Class; 18] = [
        Class::Others,
        Class::Barrier,
        Class::Bicycle,
        Class::Bus,
        Class::Car,
        Class::ConstructionVehicle,
        Class::Motorcycle,
        Class::Pedestrian,
        Class::TrafficCone,
        Class::Trailer,
        Class::Truck,
        Class::DriveableSurface,
        Class::OtherFlat,
        Class::Sidewalk,
        Class::Terrain,
        Class::Manmade,
        Class::Vegetation,
        Class::Free,
    ];
    /// The ten classes a box may have.
    pub const OBJECTS: [Class; 10] = [
        Class::Car,
        Class::Truck,
        Class::ConstructionVehicle,
        Class::Bus,
        Class::Trailer,
        Class::Barrier,
        Class::Motorcycle,
        Class::Bicycle,
        Class::Pedestrian,
        Class::TrafficCone,
    ];

    /// The class with label value `id`, if `id` is one of 0..=17.
    #[inline]
    pub fn from_id(id: u8) -> Option<Class> {
        Self::ALL.get(id as usize).copied()
    }

    /// The label value.
    #[inline]
    pub fn id(self) -> u8 {
        self as u8
    }

    /// Name as in files: `driveable_surface`.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 18] = [
            "others",
            "barrier",
            "bicycle",
            "bus",
            "car",
            "construction_vehicle",
            "motorcycle",
            "pedestrian",
            "traffic_cone",
            "trailer",
            "truck",
            "driveable_surface",
            "other_flat",
            "sidewalk",
            "terrain",
            "manmade",
            "vegetation",
            "free",
        ];
        NAMES[self as usize]
    }

    /// The class of that name.
    pub fn from_name(name: &str) -> Option<Class> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// Name as shown to a person: `driveable surface`.
    pub fn label(self) -> String {
        self.name().replace('_', " ")
    }

    /// True for the ten classes a box may have.
    pub fn is_object(self) -> bool {
        (1..=10).contains(&self.id())
    }

    /// True for the classes that drive: bus, car, construction vehicle, trailer, truck.
    pub fn is_vehicle(self) -> bool {
        matches!(
            self,
            Class::Bus | Class::Car | Class::ConstructionVehicle | Class::Trailer | Class::Truck
        )
    }

    /// True for surfaces one stands on: ids 11 to 14.
    #[inline]
    pub fn is_ground(self) -> bool {
        (11..=14).contains(&self.id())
    }

    /// sRGB colour on screen. The hues keep the field's convention (palette of OccWorld and
    /// Occ3D); lightness is tuned so that large surfaces stay calm and objects stand out.
    pub fn color(self) -> [u8; 3] {
        self.color_in(Palette::current())
    }

    /// sRGB colour in a palette; no two classes have the same.
    pub fn color_in(self, palette: Palette) -> [u8; 3] {
        const COLORS: [[u8; 3]; 18] = [
            [128, 128, 128],
            [255, 120, 50],
            [255, 170, 190],
            [250, 220, 40],
            [30, 150, 245],
            [20, 220, 225],
            [255, 127, 0],
            [240, 40, 50],
            [255, 236, 140],
            [150, 85, 30],
            [160, 60, 240],
            [104, 94, 116],
            [139, 137, 137],
            [152, 124, 148],
            [138, 170, 98],
            [205, 203, 214],
            [62, 140, 66],
            [0, 0, 0],
        ];
        match palette {
            Palette::Standard => COLORS[self as usize],
            Palette::ColorBlindSafe => SAFE_COLORS[self as usize],
        }
    }

    /// Length, width and height in metres of a typical object of this class (median of the
    /// nuScenes boxes, rounded); `None` for classes that are not objects.
    pub fn typical_size_m(self) -> Option<[f64; 3]> {
        Some(match self {
            Class::Car => [4.6, 1.95, 1.7],
            Class::Truck => [6.9, 2.5, 2.85],
            Class::ConstructionVehicle => [6.4, 2.85, 3.2],
            Class::Bus => [11.0, 2.95, 3.5],
            Class::Trailer => [12.3, 2.9, 3.9],
            Class::Barrier => [0.5, 2.5, 1.0],
            Class::Motorcycle => [2.1, 0.8, 1.5],
            Class::Bicycle => [1.7, 0.6, 1.3],
            Class::Pedestrian => [0.7, 0.7, 1.75],
            Class::TrafficCone => [0.4, 0.4, 1.05],
            _ => return None,
        })
    }
}

/// A channel of the bird's-eye-view layout, in UniScene's order; the discriminant is the bit.
/// Layers 0 to 7 are map layers that the user paints; 8 to 17 are the footprints of boxes.
#[expect(missing_docs, reason = "the names are the field's own")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum BevLayer {
    DrivableArea = 0,
    PedCrossing,
    Walkway,
    StopLine,
    CarparkArea,
    RoadDivider,
    LaneDivider,
    RoadBlock,
    Car,
    Truck,
    ConstructionVehicle,
    Bus,
    Trailer,
    Barrier,
    Motorcycle,
    Bicycle,
    Pedestrian,
    TrafficCone,
}

impl BevLayer {
    /// Number of layers.
    pub const COUNT: usize = 18;
    /// The layers a user paints.
    pub const MAP: [BevLayer; 8] = [
        BevLayer::DrivableArea,
        BevLayer::PedCrossing,
        BevLayer::Walkway,
        BevLayer::StopLine,
        BevLayer::CarparkArea,
        BevLayer::RoadDivider,
        BevLayer::LaneDivider,
        BevLayer::RoadBlock,
    ];

    /// This layer's bit in a cell of a layout.
    #[inline]
    pub fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Layers that are taken away where this one is painted: other ground, and under a walkway the markings of the road.
    pub fn replaces(self) -> &'static [BevLayer] {
        match self {
            Self::DrivableArea => &[Self::Walkway, Self::CarparkArea],
            Self::CarparkArea => &[Self::DrivableArea, Self::Walkway],
            Self::Walkway => &[
                Self::DrivableArea,
                Self::CarparkArea,
                Self::RoadDivider,
                Self::LaneDivider,
                Self::StopLine,
            ],
            _ => &[],
        }
    }

    /// Layers that say what the ground is. A cell has one of them at most: painting one takes the others away.
    pub const GROUND: [BevLayer; 3] = [Self::DrivableArea, Self::Walkway, Self::CarparkArea];

    /// True for the layers that come from boxes.
    pub fn is_object(self) -> bool {
        self as u8 >= 8
    }

    /// The layer that shows boxes of `class`.
    pub fn of_object(class: Class) -> Option<BevLayer> {
        Some(match class {
            Class::Car => BevLayer::Car,
            Class::Truck => BevLayer::Truck,
            Class::ConstructionVehicle => BevLayer::ConstructionVehicle,
            Class::Bus => BevLayer::Bus,
            Class::Trailer => BevLayer::Trailer,
            Class::Barrier => BevLayer::Barrier,
            Class::Motorcycle => BevLayer::Motorcycle,
            Class::Bicycle => BevLayer::Bicycle,
            Class::Pedestrian => BevLayer::Pedestrian,
            Class::TrafficCone => BevLayer::TrafficCone,
            _ => return None,
        })
    }

    /// Name as in files: `drivable_area`.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 18] = [
            "drivable_area",
            "ped_crossing",
            "walkway",
            "stop_line",
            "carpark_area",
            "road_divider",
            "lane_divider",
            "road_block",
            "car",
            "truck",
            "construction_vehicle",
            "bus",
            "trailer",
            "barrier",
            "motorcycle",
            "bicycle",
            "pedestrian",
            "traffic_cone",
        ];
        NAMES[self as usize]
    }

    /// Name as shown to a person.
    pub fn label(self) -> String {
        self.name().replace('_', " ")
    }

    /// sRGB colour in the bird's-eye view.
    pub fn color(self) -> [u8; 3] {
        match self {
            BevLayer::DrivableArea => [78, 84, 96],
            BevLayer::PedCrossing => [236, 180, 178],
            BevLayer::Walkway => [152, 124, 148],
            BevLayer::StopLine => [250, 245, 240],
            BevLayer::CarparkArea => [90, 104, 122],
            BevLayer::RoadDivider => [255, 200, 0],
            BevLayer::LaneDivider => [205, 208, 214],
            BevLayer::RoadBlock => [120, 70, 60],
            object => Class::OBJECTS[object as usize - 8].color(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_names_and_layers_agree() {
        for (i, class) in Class::ALL.into_iter().enumerate() {
            assert_eq!(class.id() as usize, i);
            assert_eq!(Class::from_name(class.name()), Some(class));
            let as_json = serde_json::to_string(&class).expect("a unit variant");
            assert_eq!(as_json, format!("{:?}", class.name()));
            assert_eq!(class.is_object(), BevLayer::of_object(class).is_some());
        }
        for class in Class::OBJECTS {
            let layer = BevLayer::of_object(class).expect("an object");
            assert_eq!(layer.name(), class.name());
            assert_eq!(layer.color(), class.color());
        }
        assert_eq!(Class::from_id(18), None);
    }

    #[test]
    fn colors_tell_classes_apart() {
        for palette in [Palette::Standard, Palette::ColorBlindSafe] {
            let mut colors = Class::ALL.map(|class| class.color_in(palette)).to_vec();
            colors.sort_unstable();
            colors.dedup();
            assert_eq!(colors.len(), Class::COUNT, "{palette:?}");
        }
    }
}
