//! Facts about a scene in the terms of a prompt: kind of road, surroundings, lanes, counts, light and weather.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::graph_of::state_of;
use scene::graph::{LaneRole, ObjectState};
use scene::road_map::RoadMap;
use scene::{BevLayer, BevLayout, BoxId, Class, SceneBox};
use world::draw::Draw;

/// Kinds of roads that are distinguished.
#[expect(missing_docs, reason = "the words themselves")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RoadKind {
    Straight,
    Curve,
    TJunction,
    Intersection,
    Roundabout,
    Highway,
    Parking,
    Suburb,
}

impl RoadKind {
    /// All kinds, in the order of the templates' names.
    pub const ALL: [Self; 8] = [
        Self::Straight,
        Self::Curve,
        Self::TJunction,
        Self::Intersection,
        Self::Roundabout,
        Self::Highway,
        Self::Parking,
        Self::Suburb,
    ];

    /// The template that makes such a road.
    pub fn template(self) -> &'static str {
        world::template::TEMPLATES[self as usize]
    }

    /// The kind of road that a template makes.
    pub fn of_template(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.template() == name)
    }
}

/// X-Scene's surroundings.
#[expect(missing_docs, reason = "the words themselves")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Environment {
    Downtown,
    UrbanExpressway,
    Suburban,
    Rural,
    Highway,
    Residential,
    Industrial,
    Nature,
}

impl Environment {
    /// All surroundings.
    pub const ALL: [Self; 8] = [
        Self::Downtown,
        Self::UrbanExpressway,
        Self::Suburban,
        Self::Rural,
        Self::Highway,
        Self::Residential,
        Self::Industrial,
        Self::Nature,
    ];
}

/// X-Scene's weather; the first is dry.
pub const WEATHERS: [&str; 5] = ["sunny", "cloudy", "rainy", "snowy", "foggy"];

/// Facts that can be stated about a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// Kind of road.
    pub road: RoadKind,
    /// Surroundings.
    pub environment: Environment,
    /// Lanes in the ego vehicle's direction, its own included.
    pub lanes: usize,
    /// Lanes in the other direction.
    pub oncoming: usize,
    /// True if there is a crossing.
    pub crossing: bool,
    /// True if there are sidewalks.
    pub sidewalk: bool,
    /// True if there is a car park or a parking strip.
    pub carpark: bool,
    /// Objects by class and state; classes without objects are absent.
    pub counts: BTreeMap<Class, [usize; 3]>,
    /// True at night.
    pub night: bool,
    /// Index in [`WEATHERS`].
    pub weather: usize,
}

impl Facts {
    /// Number of features of a scene for the text encoder's training: kinds one-hot, counts as log(1 + n) / 3.
    pub const FEATURES: usize = 8 + 8 + 2 + 3 + 30 + 1 + 5;

    /// Facts of a scene. `template` is its name if it was made from one. Light and weather, which geometry does not
    /// show, are drawn from `seed`, as are surroundings that fit the road.
    pub fn from_layout(
        layout: &BevLayout,
        road: &RoadMap,
        boxes: &BTreeMap<BoxId, SceneBox>,
        template: Option<&str>,
        seed: u64,
    ) -> Self {
        let mut draw = Draw::new(seed, "facts");
        let kind = template
            .and_then(RoadKind::of_template)
            .unwrap_or_else(|| road_kind(layout, road));
        let fits: &[Environment] = match kind {
            RoadKind::Highway => &[Environment::Highway, Environment::UrbanExpressway],
            RoadKind::Suburb => &[
                Environment::Suburban,
                Environment::Residential,
                Environment::Rural,
            ],
            RoadKind::Parking => &[
                Environment::Residential,
                Environment::Industrial,
                Environment::Downtown,
            ],
            RoadKind::Curve => &[
                Environment::Rural,
                Environment::Suburban,
                Environment::Nature,
                Environment::Downtown,
            ],
            _ if layout.count(BevLayer::Walkway) == 0 => {
                &[Environment::Rural, Environment::Industrial, Environment::Nature]
            }
            _ => &[
                Environment::Downtown,
                Environment::Residential,
                Environment::Suburban,
            ],
        };
        let mut counts: BTreeMap<Class, [usize; 3]> = BTreeMap::new();
        for b in boxes.values() {
            counts.entry(b.class).or_default()[state_of(road, b) as usize] += 1;
        }
        let of_role = |roles: &[LaneRole]| road.lanes.iter().filter(|l| roles.contains(&l.role)).count();
        let any = |layer: BevLayer| layout.count(layer) > 100;
        Self {
            road: kind,
            environment: fits[draw.below(fits.len())],
            lanes: of_role(&[LaneRole::Ego, LaneRole::Left, LaneRole::Right]).max(1),
            oncoming: of_role(&[LaneRole::Oncoming]),
            crossing: !road.crossings.is_empty(),
            sidewalk: any(BevLayer::Walkway),
            carpark: any(BevLayer::CarparkArea),
            counts,
            night: draw.chance(0.25),
            weather: draw.weighted(&[0.4, 0.25, 0.2, 0.07, 0.08]),
        }
    }

    /// Number of objects of a class, in any state.
    pub fn count(&self, class: Class) -> usize {
        self.counts.get(&class).map_or(0, |n| n.iter().sum())
    }

    /// Number of objects of a class in one state.
    pub fn count_in(&self, class: Class, state: ObjectState) -> usize {
        self.counts.get(&class).map_or(0, |n| n[state as usize])
    }

    /// The features; see [`Facts::FEATURES`].
    pub fn features(&self) -> Vec<f32> {
        let mut out = vec![0.0; 16];
        out[self.road as usize] = 1.0;
        out[8 + self.environment as usize] = 1.0;
        out.extend([self.lanes as f32 / 3.0, self.oncoming as f32 / 3.0]);
        out.extend([self.crossing, self.sidewalk, self.carpark].map(|b| f32::from(u8::from(b))));
        for class in Class::OBJECTS {
            let counts = self.counts.get(&class).copied().unwrap_or_default();
            out.extend(counts.map(|n| (n as f32).ln_1p() / 3.0));
        }
        out.push(f32::from(u8::from(self.night)));
        out.extend((0..WEATHERS.len()).map(|i| f32::from(u8::from(i == self.weather))));
        out
    }
}

/// Kind of a road without a template, inferred from its lanes.
pub fn road_kind(layout: &BevLayout, road: &RoadMap) -> RoadKind {
    let ahead = road.junctions_m.iter().any(|p| p.length() < 35.0);
    let cross = road.lanes.iter().filter(|l| l.role == LaneRole::Cross).count();
    let same = road
        .lanes
        .iter()
        .filter(|l| matches!(l.role, LaneRole::Ego | LaneRole::Left | LaneRole::Right))
        .count();
    let turn = road.ego_lane.map_or(0.0, |i| {
        let points = &road.lanes[i].points_m;
        let n = points.len();
        let (a, b) = (points[1] - points[0], points[n - 1] - points[n - 2]);
        a.angle_to(b).abs()
    });
    if ahead && cross >= 4 {
        RoadKind::Intersection
    } else if ahead {
        RoadKind::TJunction
    } else if layout.count(BevLayer::CarparkArea) > 3000 {
        RoadKind::Parking
    } else if same >= 3 && layout.count(BevLayer::Walkway) < 200 {
        RoadKind::Highway
    } else if turn > 0.35 {
        RoadKind::Curve
    } else {
        RoadKind::Straight
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::{template, traffic};

    #[test]
    fn kinds_are_the_templates_in_order() {
        for (kind, name) in RoadKind::ALL.into_iter().zip(template::TEMPLATES) {
            assert_eq!(RoadKind::of_template(name), Some(kind));
            assert_eq!(format!("{kind:?}").to_lowercase(), name.replace('-', ""));
        }
    }

    #[test]
    fn features_count_what_is_there() {
        let layout = template::layout("intersection", 4).expect("listed");
        let boxes = traffic::place(&layout, 4, &traffic::TrafficSpec::NORMAL);
        let road = RoadMap::new(&layout);
        let facts = Facts::from_layout(&layout, &road, &boxes, None, 4);
        assert!(
            matches!(facts.road, RoadKind::Intersection | RoadKind::TJunction),
            "{:?}",
            facts.road
        );
        assert_eq!(facts.features().len(), Facts::FEATURES);
        let all: usize = Class::OBJECTS.iter().map(|c| facts.count(*c)).sum();
        assert_eq!(all, boxes.len());
    }
}
