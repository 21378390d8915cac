//! Description of a scene, as a prompt gives it: X-Scene's fields (arXiv 2506.13558, appendix B) as plain data.

use serde::{Deserialize, Serialize};

use crate::beside_road::SceneryClause;
use scene::clip::Manoeuvre;
use scene::graph::{LaneRole, ObjectState, RelationKind, SizeHint};
use scene::{BoxLabel, Class, Conditions, TimeOfDay, Weather};

macro_rules! named {
    ($(#[$doc:meta])* $name:ident { $($variant:ident = $text:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[expect(missing_docs, reason = "the names say it")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
        pub enum $name { $(#[serde(rename = $text)] $variant),+ }
        impl $name {
            /// Name as in files.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text),+ }
            }
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
        }
    };
}

named!(
    /// Among what.
    Environment {
        Downtown = "downtown", Urban = "urban", Suburban = "suburban", Residential = "residential", Rural = "rural",
        Highway = "highway", Industrial = "industrial", Nature = "nature",
    }
);
named!(
    /// Kind of road: the templates of procedural worlds.
    Road {
        Straight = "straight", Curve = "curve", TJunction = "t-junction", Intersection = "intersection",
        Roundabout = "roundabout", Highway = "highway", Parking = "parking", Suburb = "suburb",
    }
);
named!(
    /// How much is going on beside what is named.
    Density { Empty = "empty", Light = "light", Busy = "busy", Jam = "jam" }
);

/// How many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Count {
    /// Least number that fits the words.
    pub min: u32,
    /// Number that is placed.
    pub n: u32,
    /// Largest number that fits the words.
    pub max: u32,
}

impl Count {
    /// Exactly `n`.
    pub fn exactly(n: u32) -> Self {
        Self { min: n, n, max: n }
    }
    /// About `n`.
    pub fn about(min: u32, n: u32, max: u32) -> Self {
        Self { min, n, max }
    }
    /// True if one number was named.
    pub fn is_exact(self) -> bool {
        self.min == self.max
    }
}

/// Reference of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Anchor {
    /// The ego vehicle.
    Ego,
    /// Another object of the description, by index.
    Object(usize),
    /// A lane or strip.
    Lane(LaneRole),
    /// A pedestrian crossing.
    Crossing,
    /// A junction.
    Junction,
}

/// One stated relation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stated {
    /// The relation.
    pub relation: RelationKind,
    /// Reference of the relation.
    pub anchor: Anchor,
    /// The second one of `between`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub and: Option<Anchor>,
    /// Distance, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

/// Objects of one kind that were named together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Their class.
    pub class: Class,
    /// How many.
    pub count: Count,
    /// Their state: moving, parked or waiting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<ObjectState>,
    /// Larger or smaller than usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeHint>,
    /// Their name and paint.
    #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
    pub label: BoxLabel,
    /// Length, width and height of this kind, m, where it differs from its class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_m: Option<[f64; 3]>,
    /// Their places.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub relations: Vec<Stated>,
    /// Their manoeuvre in the course of time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Manoeuvre>,
}

impl ObjectSpec {
    /// One of them in words: `red taxi`.
    pub fn called(&self) -> String {
        self.label.called(&self.class.label())
    }
}

/// A class (or only those of it that are parked or moving) that must not occur.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Absent {
    /// The classes.
    pub classes: Vec<Class>,
    /// Limits it to objects of this state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<ObjectState>,
}

/// Requirements on the road.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoadWish {
    /// Kind of road.
    pub kind: Option<Road>,
    /// Lanes in both directions together, or of the ego's direction if `one_way`.
    pub lanes: Option<u32>,
    /// Traffic in the ego's direction only.
    pub one_way: bool,
    /// Narrower than usual.
    pub narrow: bool,
    /// Wider than usual.
    pub wide: bool,
    /// A pedestrian crossing.
    pub crossing: bool,
    /// Distance of the crossing ahead, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossing_m: Option<f64>,
    /// Sidewalks.
    pub sidewalk: bool,
    /// No pedestrian crossing.
    pub no_crossing: bool,
    /// No sidewalks.
    pub no_sidewalk: bool,
    /// The lane that the ego vehicle drives in among those of its direction: left, right, or `Ego` for the middle.
    pub own_lane: Option<LaneRole>,
}

/// A structured description of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Description {
    /// Time of day.
    pub time_of_day: Option<TimeOfDay>,
    /// Weather.
    pub weather: Option<Weather>,
    /// Surroundings.
    pub environment: Option<Environment>,
    /// The objects.
    pub foreground: Vec<ObjectSpec>,
    /// Classes that must not occur.
    pub absent: Vec<Absent>,
    /// Buildings, trees and the like.
    pub background: Vec<SceneryClause>,
    /// Amount of other traffic.
    pub density: Option<Density>,
    /// The road.
    pub road: RoadWish,
    /// Manoeuvre of the ego vehicle in the course of time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ego_motion: Option<Manoeuvre>,
    /// How long the scene lasts, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_s: Option<f64>,
    /// The statements about places, in words.
    pub layout: Vec<String>,
    /// One sentence.
    #[serde(rename = "abstract")]
    pub summary: String,
}

impl Description {
    /// Text for [`Scene::prompt`](scene::Scene): time, weather and surroundings.
    pub fn style(&self) -> String {
        let words = [
            self.time_of_day.map(TimeOfDay::name),
            self.weather.map(Weather::name),
            self.environment.map(Environment::name),
        ];
        words.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// Light and air of the scene; a clear day where nothing was stated.
    pub fn conditions(&self, seed: u64) -> Conditions {
        let (time, weather) = (self.time_of_day, self.weather);
        Conditions::usual(time.unwrap_or_default(), weather.unwrap_or_default(), seed)
    }

    /// True if nothing was stated that changes a scene.
    pub fn is_empty(&self) -> bool {
        let empty = Description {
            summary: self.summary.clone(),
            ..Self::default()
        };
        *self == empty
    }

    /// Fills `layout` and `summary` from the rest.
    pub fn summarise(&mut self) {
        let name = |a: &Anchor| match a {
            Anchor::Ego => "ego".to_string(),
            Anchor::Object(i) => self
                .foreground
                .get(*i)
                .map_or("object".into(), |o| format!("{} ({i})", o.called())),
            Anchor::Lane(role) => serde_json::to_value(role)
                .ok()
                .and_then(|v| v.as_str().map(|s| s.replace('_', " ")))
                .map_or("lane".into(), |s| {
                    if s.contains("side") || s == "road" || s == "carpark" {
                        s
                    } else {
                        format!("{s} lane")
                    }
                }),
            Anchor::Crossing => "crossing".into(),
            Anchor::Junction => "junction".into(),
        };
        let mut lines = Vec::new();
        for (i, o) in self.foreground.iter().enumerate() {
            for r in &o.relations {
                let far = r.distance_m.map_or(String::new(), |d| format!(", {d:.1} m"));
                let and = r
                    .and
                    .as_ref()
                    .map_or(String::new(), |a| format!(" and {}", name(a)));
                let relation = r.relation.name().replace('_', " ");
                lines.push(format!(
                    "{} ({i}) {relation} {}{and}{far}",
                    o.called(),
                    name(&r.anchor)
                ));
            }
        }
        let mut parts: Vec<String> = Vec::new();
        parts.extend(self.road.kind.map(|r| r.name().to_string()));
        parts.extend(self.density.map(|d| d.name().to_string()));
        let style = self.style();
        parts.extend((!style.is_empty()).then_some(style));
        for o in &self.foreground {
            parts.push(format!("{} x {}", o.count.n, o.called()));
        }
        for a in &self.absent {
            let names: Vec<String> = a.classes.iter().map(|c| c.label()).collect();
            parts.push(format!("no {}", names.join(", no ")));
        }
        self.layout = lines;
        self.summary = parts.join("; ");
    }
}
