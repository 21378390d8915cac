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

/// Facts about a class. A class is one row of [`ROWS`].
struct ClassRow {
    class: Class,
    /// Name as in files.
    name: &'static str,
    /// sRGB colour in each [`Palette`]: close to the palette of OccWorld and Occ3D, with lightness tuned so that large surfaces
    /// stay calm and objects stand out; and after Okabe and Ito (2008), objects saturated, surroundings pale or dark.
    colors: [[u8; 3]; 2],
    role: ClassRole,
    /// Length, width and height of a typical object, m (median of the nuScenes boxes, rounded).
    size_m: Option<[f64; 3]>,
}

/// Part that a class plays in a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ClassRole {
    /// Object that drives, has a box.
    Vehicle,
    /// Other object with a box.
    Object,
    /// Surface that one stands on.
    Ground,
    /// All else.
    Other,
}

const fn row(
    class: Class,
    name: &'static str,
    role: ClassRole,
    colors: [[u8; 3]; 2],
    size_m: Option<[f64; 3]>,
) -> ClassRow {
    ClassRow {
        class,
        name,
        colors,
        role,
        size_m,
    }
}

/// Every class, in the order of its label value.
#[rustfmt::skip]
static ROWS: [ClassRow; Class::COUNT] = [
    row(Class::Others, "others", ClassRole::Other, [[128, 128, 128], [128, 128, 128]], None),
    row(Class::Barrier, "barrier", ClassRole::Object, [[255, 120, 50], [190, 120, 40]], Some([0.5, 2.5, 1.0])),
    row(Class::Bicycle, "bicycle", ClassRole::Object, [[255, 170, 190], [204, 121, 167]], Some([1.7, 0.6, 1.3])),
    row(Class::Bus, "bus", ClassRole::Vehicle, [[250, 220, 40], [240, 228, 66]], Some([11.0, 2.95, 3.5])),
    row(Class::Car, "car", ClassRole::Vehicle, [[30, 150, 245], [0, 114, 178]], Some([4.6, 1.95, 1.7])),
    row(Class::ConstructionVehicle, "construction_vehicle", ClassRole::Vehicle, [[20, 220, 225], [0, 190, 170]], Some([6.4, 2.85, 3.2])),
    row(Class::Motorcycle, "motorcycle", ClassRole::Object, [[255, 127, 0], [230, 159, 0]], Some([2.1, 0.8, 1.5])),
    row(Class::Pedestrian, "pedestrian", ClassRole::Object, [[240, 40, 50], [213, 94, 0]], Some([0.7, 0.7, 1.75])),
    row(Class::TrafficCone, "traffic_cone", ClassRole::Object, [[255, 236, 140], [255, 250, 200]], Some([0.4, 0.4, 1.05])),
    row(Class::Trailer, "trailer", ClassRole::Vehicle, [[150, 85, 30], [120, 80, 40]], Some([12.3, 2.9, 3.9])),
    row(Class::Truck, "truck", ClassRole::Vehicle, [[160, 60, 240], [86, 180, 233]], Some([6.9, 2.5, 2.85])),
    row(Class::DriveableSurface, "driveable_surface", ClassRole::Ground, [[104, 94, 116], [84, 88, 100]], None),
    row(Class::OtherFlat, "other_flat", ClassRole::Ground, [[139, 137, 137], [150, 150, 146]], None),
    row(Class::Sidewalk, "sidewalk", ClassRole::Ground, [[152, 124, 148], [178, 166, 186]], None),
    row(Class::Terrain, "terrain", ClassRole::Ground, [[138, 170, 98], [176, 182, 150]], None),
    row(Class::Manmade, "manmade", ClassRole::Other, [[205, 203, 214], [214, 212, 220]], None),
    row(Class::Vegetation, "vegetation", ClassRole::Other, [[62, 140, 66], [44, 92, 70]], None),
    row(Class::Free, "free", ClassRole::Other, [[0, 0, 0], [0, 0, 0]], None),
];

impl Class {
    /// Number of classes, free included.
    pub const COUNT: usize = 18;
    /// Label value of empty space.
    pub const FREE: u8 = Class::Free as u8;
    /// Every class in the order of its label value.
    pub const ALL: [Class; Class::COUNT] = {
        let mut all = [Class::Free; Class::COUNT];
        let mut i = 0;
        while i < all.len() {
            all[i] = ROWS[i].class;
            i += 1;
        }
        all
    };
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

    fn row(self) -> &'static ClassRow {
        &ROWS[self as usize]
    }

    /// Name as in files: `driveable_surface`.
    pub fn name(self) -> &'static str {
        self.row().name
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
        matches!(self.row().role, ClassRole::Vehicle | ClassRole::Object)
    }

    /// True for the classes that drive: bus, car, construction vehicle, trailer, truck.
    pub fn is_vehicle(self) -> bool {
        self.row().role == ClassRole::Vehicle
    }

    /// True for surfaces one stands on: ids 11 to 14.
    #[inline]
    pub fn is_ground(self) -> bool {
        self.row().role == ClassRole::Ground
    }

    /// sRGB colour on screen.
    pub fn color(self) -> [u8; 3] {
        self.color_in(Palette::current())
    }

    /// sRGB colour in a palette; no two classes have the same.
    pub fn color_in(self, palette: Palette) -> [u8; 3] {
        self.row().colors[palette as usize]
    }

    /// Length, width and height in metres of a typical object of this class; `None` for classes that are not objects.
    pub fn typical_size_m(self) -> Option<[f64; 3]> {
        self.row().size_m
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
