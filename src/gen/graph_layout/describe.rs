//! Sentences about a scene as people would write them: many wordings for the same contents, drawn from a seed. Data for
//! the text encoder, and the descriptions in the memory bank.

use super::facts::{Environment, Facts, RoadKind, WEATHERS};
use scene::Class;
use scene::graph::ObjectState;
use world::draw::Draw;

fn road_words(kind: RoadKind) -> &'static [&'static str] {
    match kind {
        RoadKind::Straight => &[
            "straight road",
            "straight street",
            "street",
            "long straight avenue",
            "city street",
        ],
        RoadKind::Curve => &[
            "curved road",
            "bend",
            "winding street",
            "road that curves",
            "sweeping bend",
        ],
        RoadKind::TJunction => &[
            "T-junction",
            "t junction",
            "three-way junction",
            "side road joining",
            "tee intersection",
        ],
        RoadKind::Intersection => &[
            "intersection",
            "crossroads",
            "four-way junction",
            "junction",
            "crossing of two streets",
        ],
        RoadKind::Roundabout => &["roundabout", "traffic circle", "rotary", "circular junction"],
        RoadKind::Highway => &[
            "highway",
            "motorway",
            "freeway",
            "multi-lane highway",
            "dual carriageway",
        ],
        RoadKind::Parking => &[
            "street beside a car park",
            "parking lot",
            "road with a parking area",
            "car park",
        ],
        RoadKind::Suburb => &[
            "suburban street",
            "neighbourhood street",
            "quiet road with driveways",
            "residential street",
        ],
    }
}

fn environment_words(environment: Environment) -> &'static [&'static str] {
    match environment {
        Environment::Downtown => &["downtown", "in the city centre", "in the inner city", "in town"],
        Environment::UrbanExpressway => &["on an urban expressway", "on the ring road", "on the expressway"],
        Environment::Suburban => &["in the suburbs", "in a suburb", "suburban area"],
        Environment::Rural => &["in the countryside", "rural area", "out in the country"],
        Environment::Highway => &["outside town", "on the open highway", "between cities"],
        Environment::Residential => &["in a residential area", "among houses", "in a housing estate"],
        Environment::Industrial => &["in an industrial area", "by the factories", "near warehouses"],
        Environment::Nature => &["through a forest", "in nature", "between trees and fields"],
    }
}

/// Singular and plural names of a class.
fn names(class: Class) -> &'static [(&'static str, &'static str)] {
    match class {
        Class::Car => &[
            ("car", "cars"),
            ("vehicle", "vehicles"),
            ("passenger car", "passenger cars"),
        ],
        Class::Truck => &[("truck", "trucks"), ("lorry", "lorries"), ("van", "vans")],
        Class::Bus => &[("bus", "buses"), ("coach", "coaches"), ("city bus", "city buses")],
        Class::Trailer => &[("trailer", "trailers"), ("semi-trailer", "semi-trailers")],
        Class::ConstructionVehicle => &[
            ("excavator", "excavators"),
            ("construction vehicle", "construction vehicles"),
            ("digger", "diggers"),
        ],
        Class::Barrier => &[("barrier", "barriers"), ("barricade", "barricades")],
        Class::Motorcycle => &[
            ("motorcycle", "motorcycles"),
            ("motorbike", "motorbikes"),
            ("scooter", "scooters"),
        ],
        Class::Bicycle => &[
            ("bicycle", "bicycles"),
            ("cyclist", "cyclists"),
            ("bike", "bikes"),
        ],
        Class::Pedestrian => &[
            ("pedestrian", "pedestrians"),
            ("person", "people"),
            ("walker", "walkers"),
        ],
        Class::TrafficCone => &[
            ("traffic cone", "traffic cones"),
            ("cone", "cones"),
            ("pylon", "pylons"),
        ],
        _ => &[("object", "objects")],
    }
}

fn pick<'a>(draw: &mut Draw, words: &[&'a str]) -> &'a str {
    words[draw.below(words.len())]
}

fn counted(draw: &mut Draw, class: Class, state: ObjectState, n: usize) -> String {
    const NUMBERS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    let list = names(class);
    let (one, many) = list[draw.below(list.len())];
    let state = match (state, class) {
        (ObjectState::Parked, c) if c.is_vehicle() => pick(draw, &["parked ", "parked ", "standing ", ""]),
        (ObjectState::Moving, c) if c.is_vehicle() => pick(draw, &["moving ", "", "", "driving "]),
        (ObjectState::Moving, Class::Pedestrian) => pick(draw, &["walking ", "", ""]),
        (ObjectState::Waiting, c) if !matches!(c, Class::TrafficCone | Class::Barrier) => {
            pick(draw, &["waiting ", "stopped ", ""])
        }
        _ => "",
    };
    let number = match n {
        1 => pick(draw, &["a", "one", "a single"]).to_owned(),
        2..=12 if draw.chance(0.5) => NUMBERS[n].to_owned(),
        2..=12 if draw.chance(0.5) => n.to_string(),
        2..=3 => pick(draw, &["a few", "a couple of", "some"]).to_owned(),
        4..=8 => pick(draw, &["several", "some", "a number of"]).to_owned(),
        _ => pick(draw, &["many", "lots of", "a crowd of", "a lot of"]).to_owned(),
    };
    format!("{number} {state}{}", if n == 1 { one } else { many })
}

/// A sentence about a scene. `share` (0 to 1) is the share of the possible statements that it makes; the road or one
/// object is always in it.
pub fn sentence(facts: &Facts, share: f64, seed: u64) -> String {
    let mut draw = Draw::new(seed, "sentence");
    let vehicles: usize = Class::OBJECTS
        .iter()
        .filter(|c| c.is_vehicle())
        .map(|c| facts.count(*c))
        .sum();
    let busy = match vehicles + facts.count(Class::Pedestrian) / 2 {
        0..=2 => pick(&mut draw, &["empty", "deserted", "quiet"]),
        3..=12 => pick(&mut draw, &["calm", "", ""]),
        13..=25 => pick(&mut draw, &["busy", "lively", ""]),
        _ => pick(&mut draw, &["crowded", "very busy", "congested"]),
    };
    let mut parts = Vec::new();
    let road = pick(&mut draw, road_words(facts.road));
    let say_road = draw.chance(share.max(0.7));
    if say_road {
        let busy = if draw.chance(share) { busy } else { "" };
        let gap = if busy.is_empty() { "" } else { " " };
        parts.push(format!(
            "{}{busy}{gap}{road}",
            pick(&mut draw, &["", "a ", "the "])
        ));
    }
    if draw.chance(share) {
        parts.push(pick(&mut draw, environment_words(facts.environment)).to_owned());
    }
    if draw.chance(share) {
        let light = if facts.night {
            pick(&mut draw, &["at night", "in the dark", "after dark", "nighttime"])
        } else {
            pick(&mut draw, &["by day", "in daylight", "daytime", "during the day"])
        };
        parts.push(light.to_owned());
    }
    if draw.chance(share) {
        let words: &[&str] = match WEATHERS.get(facts.weather).copied().unwrap_or("sunny") {
            "cloudy" => &["cloudy", "under an overcast sky", "grey sky"],
            "rainy" => &["in the rain", "rainy", "wet road", "while it rains"],
            "snowy" => &["in snow", "snowy", "while it snows"],
            "foggy" => &["in fog", "foggy", "misty"],
            _ => &["sunny", "clear weather", "bright sun", "dry"],
        };
        parts.push(pick(&mut draw, words).to_owned());
    }
    if facts.lanes > 1 && draw.chance(share * 0.6) {
        parts.push(format!("{} lanes in each direction", facts.lanes));
    }
    if facts.crossing && draw.chance(share * 0.7) {
        parts.push(
            pick(
                &mut draw,
                &["with a zebra crossing", "with a pedestrian crossing", "crosswalk"],
            )
            .to_owned(),
        );
    }
    if facts.sidewalk && draw.chance(share * 0.3) {
        parts.push(
            pick(
                &mut draw,
                &["sidewalks on both sides", "with pavements", "with sidewalks"],
            )
            .to_owned(),
        );
    }
    let mut objects = Vec::new();
    for (class, counts) in &facts.counts {
        for state in ObjectState::ALL {
            let n = counts[state as usize];
            if n > 0 && draw.chance(if say_road { share } else { share.max(0.5) }) {
                objects.push(counted(&mut draw, *class, state, n));
            }
        }
    }
    if parts.is_empty() && objects.is_empty() {
        parts.push(road.to_owned());
    }
    if !objects.is_empty() {
        let joined = match objects.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => objects.join(""),
        };
        let link = pick(&mut draw, &["with ", "", "there are "]);
        parts.push(format!("{}{joined}", if parts.is_empty() { "" } else { link }));
    }
    parts.join(pick(&mut draw, &[", ", ", ", " "]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn a_full_description_says_it_and_a_short_one_is_short() {
        let facts = Facts {
            road: RoadKind::Roundabout,
            environment: Environment::Downtown,
            lanes: 2,
            oncoming: 1,
            crossing: true,
            sidewalk: true,
            carpark: false,
            counts: BTreeMap::from([(Class::Bus, [0, 0, 1]), (Class::TrafficCone, [0, 5, 0])]),
            night: true,
            weather: 2,
        };
        for seed in 0..50 {
            let long = sentence(&facts, 1.0, seed);
            assert_eq!(long, sentence(&facts, 1.0, seed));
            let has = |words: &[&str]| words.iter().any(|w| long.contains(w));
            assert!(has(road_words(RoadKind::Roundabout)), "{long}");
            assert!(has(&["bus", "coach"]) && has(&["cone", "pylon"]), "{long}");
            assert!(has(&["night", "dark"]) && has(&["rain", "wet"]), "{long}");
            assert!(sentence(&facts, 0.0, seed).len() < 60);
            assert!(!sentence(&facts, 0.0, seed).is_empty());
        }
    }
}
