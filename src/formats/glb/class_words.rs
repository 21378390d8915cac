//! Class and paint of a thing by its name: `Car_01`, `SM_TrafficCone`, `vehicle-truck-yellow`, `roadAsphalt`.

use scene::{Class, Paint};

/// Words and their class; of several words in a name the one that comes first here tells.
const WORDS: [(&str, Class); 137] = [
    // The most telling first: a fire truck is no fire, a bus stop no bus, a tree on grass a tree.
    ("excavator", Class::ConstructionVehicle),
    ("bulldozer", Class::ConstructionVehicle),
    ("digger", Class::ConstructionVehicle),
    ("forklift", Class::ConstructionVehicle),
    ("steamroller", Class::ConstructionVehicle),
    ("backhoe", Class::ConstructionVehicle),
    ("manmade", Class::Manmade),
    ("busstop", Class::Manmade),
    ("carport", Class::Manmade),
    ("carpark", Class::DriveableSurface),
    ("parking", Class::DriveableSurface),
    ("streetlight", Class::Manmade),
    ("streetlamp", Class::Manmade),
    ("trafficlight", Class::Manmade),
    ("trafficsign", Class::Manmade),
    ("roadsign", Class::Manmade),
    ("trafficcone", Class::TrafficCone),
    ("trailer", Class::Trailer),
    ("caravan", Class::Trailer),
    ("motorcycle", Class::Motorcycle),
    ("motorbike", Class::Motorcycle),
    ("scooter", Class::Motorcycle),
    ("moped", Class::Motorcycle),
    ("vespa", Class::Motorcycle),
    ("bicycle", Class::Bicycle),
    ("bike", Class::Bicycle),
    ("cyclist", Class::Bicycle),
    ("truck", Class::Truck),
    ("lorry", Class::Truck),
    ("pickup", Class::Truck),
    ("bus", Class::Bus),
    ("minibus", Class::Bus),
    ("coach", Class::Bus),
    ("tram", Class::Bus),
    ("car", Class::Car),
    ("cars", Class::Car),
    ("automobile", Class::Car),
    ("sedan", Class::Car),
    ("hatchback", Class::Car),
    ("suv", Class::Car),
    ("van", Class::Car),
    ("taxi", Class::Car),
    ("cab", Class::Car),
    ("police", Class::Car),
    ("ambulance", Class::Car),
    ("jeep", Class::Car),
    ("vehicle", Class::Car),
    ("vehicles", Class::Car),
    ("pedestrian", Class::Pedestrian),
    ("pedestrians", Class::Pedestrian),
    ("person", Class::Pedestrian),
    ("people", Class::Pedestrian),
    ("human", Class::Pedestrian),
    ("man", Class::Pedestrian),
    ("woman", Class::Pedestrian),
    ("child", Class::Pedestrian),
    ("walker", Class::Pedestrian),
    ("character", Class::Pedestrian),
    ("cone", Class::TrafficCone),
    ("cones", Class::TrafficCone),
    ("pylon", Class::TrafficCone),
    ("barrier", Class::Barrier),
    ("barriers", Class::Barrier),
    ("barricade", Class::Barrier),
    ("tree", Class::Vegetation),
    ("trees", Class::Vegetation),
    ("bush", Class::Vegetation),
    ("bushes", Class::Vegetation),
    ("hedge", Class::Vegetation),
    ("shrub", Class::Vegetation),
    ("shrubs", Class::Vegetation),
    ("plant", Class::Vegetation),
    ("plants", Class::Vegetation),
    ("vegetation", Class::Vegetation),
    ("foliage", Class::Vegetation),
    ("leaf", Class::Vegetation),
    ("leaves", Class::Vegetation),
    ("trunk", Class::Vegetation),
    ("forest", Class::Vegetation),
    ("palm", Class::Vegetation),
    ("oak", Class::Vegetation),
    ("pine", Class::Vegetation),
    ("building", Class::Manmade),
    ("buildings", Class::Manmade),
    ("house", Class::Manmade),
    ("houses", Class::Manmade),
    ("garage", Class::Manmade),
    ("tower", Class::Manmade),
    ("skyscraper", Class::Manmade),
    ("wall", Class::Manmade),
    ("walls", Class::Manmade),
    ("facade", Class::Manmade),
    ("roof", Class::Manmade),
    ("fence", Class::Manmade),
    ("guardrail", Class::Manmade),
    ("rail", Class::Manmade),
    ("pole", Class::Manmade),
    ("poles", Class::Manmade),
    ("lamp", Class::Manmade),
    ("light", Class::Manmade),
    ("sign", Class::Manmade),
    ("signs", Class::Manmade),
    ("bench", Class::Manmade),
    ("hydrant", Class::Manmade),
    ("bridge", Class::Manmade),
    ("sidewalk", Class::Sidewalk),
    ("sidewalks", Class::Sidewalk),
    ("footpath", Class::Sidewalk),
    ("walkway", Class::Sidewalk),
    ("kerb", Class::Sidewalk),
    ("curb", Class::Sidewalk),
    ("pavement", Class::Sidewalk),
    ("road", Class::DriveableSurface),
    ("roads", Class::DriveableSurface),
    ("street", Class::DriveableSurface),
    ("asphalt", Class::DriveableSurface),
    ("lane", Class::DriveableSurface),
    ("lanes", Class::DriveableSurface),
    ("highway", Class::DriveableSurface),
    ("crosswalk", Class::DriveableSurface),
    ("driveway", Class::DriveableSurface),
    ("junction", Class::DriveableSurface),
    ("intersection", Class::DriveableSurface),
    ("terrain", Class::Terrain),
    ("ground", Class::Terrain),
    ("grass", Class::Terrain),
    ("lawn", Class::Terrain),
    ("soil", Class::Terrain),
    ("dirt", Class::Terrain),
    ("earth", Class::Terrain),
    ("landscape", Class::Terrain),
    ("plane", Class::Terrain),
    ("water", Class::OtherFlat),
    ("river", Class::OtherFlat),
    ("floor", Class::OtherFlat),
    ("railway", Class::OtherFlat),
    ("others", Class::Others),
];

/// Words of things that are no part of a scene.
const NOTHING: [&str; 4] = ["sky", "skybox", "skydome", "skysphere"];
/// Words for several things at once.
const SEVERAL: [&str; 9] = [
    "cars",
    "vehicles",
    "trucks",
    "people",
    "pedestrians",
    "cones",
    "barriers",
    "group",
    "objects",
];

/// Meaning of a name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NameMeaning {
    /// The class, if a word tells it.
    pub(crate) class: Option<Class>,
    /// True where it names several things.
    pub(crate) several: bool,
    /// True for the sky.
    pub(crate) nothing: bool,
}

/// Reads the meaning of a name. Names of the program's own classes are taken literally.
pub(crate) fn said(name: &str) -> NameMeaning {
    let words = words(name);
    let has = |word: &str| words.iter().any(|w| w == word);
    // Two words that belong together, such as "traffic light".
    let pairs: Vec<String> = words.windows(2).map(|w| w.concat()).collect();
    let told = |word: &str| has(word) || pairs.iter().any(|p| p == word);
    let lower = name.to_lowercase();
    let own = Class::from_name(&lower).or_else(|| {
        let spaced = lower.trim_end_matches(|c: char| c.is_ascii_digit() || " ._-#".contains(c));
        Class::from_name(&spaced.replace([' ', '-'], "_"))
    });
    let by_words = || WORDS.iter().find(|(word, _)| told(word)).map(|(_, class)| *class);
    NameMeaning {
        class: own.filter(|class| *class != Class::Free).or_else(by_words),
        several: SEVERAL.iter().any(|word| has(word)),
        nothing: NOTHING.iter().any(|word| has(word)),
    }
}

/// The first paint that a name tells.
pub(crate) fn paint_said(name: &str) -> Option<Paint> {
    let told = |word: &String| {
        let word = if word == "gray" { "grey" } else { word };
        Paint::ALL.into_iter().find(|paint| paint.name() == word)
    };
    words(name).iter().find_map(told)
}

/// The words of a name in small letters: parted at everything that is no letter, and where a capital follows a small letter.
fn words(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut last_is_small = false;
    for c in name.chars() {
        let begins = c.is_uppercase() && last_is_small;
        if (!c.is_alphabetic() || begins) && out.last().is_some_and(|w| !w.is_empty()) {
            out.push(String::new());
        }
        last_is_small = c.is_lowercase();
        if c.is_alphabetic()
            && let Some(word) = out.last_mut()
        {
            word.extend(c.to_lowercase());
        }
    }
    out.retain(|word| !word.is_empty());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_all_kinds_tell_their_class() {
        for (name, class) in [
            ("Car_01", Some(Class::Car)),
            ("SM_TrafficCone.003", Some(Class::TrafficCone)),
            ("vehicle-truck-yellow", Some(Class::Truck)),
            ("roadAsphalt", Some(Class::DriveableSurface)),
            ("Traffic Light 4", Some(Class::Manmade)),
            ("bus stop", Some(Class::Manmade)),
            ("grass-trees-tall", Some(Class::Vegetation)),
            ("building-garage", Some(Class::Manmade)),
            ("character", Some(Class::Pedestrian)),
            ("driveable_surface", Some(Class::DriveableSurface)),
            ("construction_vehicle.001", Some(Class::ConstructionVehicle)),
            ("traffic_cone", Some(Class::TrafficCone)),
            ("other flat", Some(Class::OtherFlat)),
            ("man-made", Some(Class::Manmade)),
            ("carpet", None),
            ("Scandinavian", None),
            ("wheel-back-left", None),
            ("colormap", None),
            ("free", None),
            ("", None),
        ] {
            assert_eq!(said(name).class, class, "{name:?}");
        }
        assert!(said("SkyBox").nothing && said("Cars").several && !said("Car").several);
        assert_eq!(words("SM_busStop2B"), ["sm", "bus", "stop", "b"]);
    }

    #[test]
    fn no_word_is_there_twice() {
        let distinct: std::collections::BTreeSet<&str> = WORDS.iter().map(|(word, _)| *word).collect();
        assert_eq!(distinct.len(), WORDS.len());
        assert!(Class::OBJECTS.iter().all(|c| said(c.name()).class == Some(*c)));
    }
}
