//! The light and the air of a scene: time of day, weather, wet ground, visibility, sun.

use std::borrow::Cow;
use std::str::FromStr;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// Part of the day; it decides how high the sun stands and which colour its light has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeOfDay {
    /// Low sun, cool.
    Dawn,
    /// High sun.
    #[default]
    Day,
    /// Low sun, warm.
    Dusk,
    /// Moon, street lamps and headlights.
    Night,
}

/// Weather: state of the air and of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weather {
    /// Some clouds.
    #[default]
    Clear,
    /// A closed sky.
    Overcast,
    /// Wet ground, streaks, haze.
    Rain,
    /// Covered ground, flakes.
    Snow,
    /// Little to be seen beyond 100 m.
    Fog,
    /// Dust in the air and on everything.
    Sandstorm,
}

impl TimeOfDay {
    /// Every time of day, in the order of a day.
    pub const ALL: [Self; 4] = [Self::Dawn, Self::Day, Self::Dusk, Self::Night];

    /// Name as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dawn => "dawn",
            Self::Day => "day",
            Self::Dusk => "dusk",
            Self::Night => "night",
        }
    }
}

impl Weather {
    /// Every weather.
    pub const ALL: [Self; 6] = [
        Self::Clear,
        Self::Overcast,
        Self::Rain,
        Self::Snow,
        Self::Fog,
        Self::Sandstorm,
    ];

    /// Name as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Overcast => "overcast",
            Self::Rain => "rain",
            Self::Snow => "snow",
            Self::Fog => "fog",
            Self::Sandstorm => "sandstorm",
        }
    }

    /// How wet the ground usually is in this weather, 0 to 1.
    pub fn usual_wetness(self) -> f64 {
        match self {
            Self::Rain => 1.0,
            Self::Fog => 0.25,
            Self::Clear | Self::Overcast | Self::Snow | Self::Sandstorm => 0.0,
        }
    }

    /// How far one usually sees in this weather, m.
    pub fn usual_visibility_m(self) -> f64 {
        // Share of light lost per m, as the pictures of each weather were tuned.
        let lost_per_m: f32 = match self {
            Self::Clear => 0.0011,
            Self::Overcast => 0.003,
            Self::Rain => 0.0085,
            Self::Snow => 0.010,
            Self::Fog => 0.042,
            Self::Sandstorm => 0.027,
        };
        LOSS_AT_VISIBILITY / f64::from(lost_per_m)
    }
}

/// Extinction times visibility: at the distance of visibility a contrast of 2 % is left (Koschmieder 1924), -ln 0.02.
const LOSS_AT_VISIBILITY: f64 = 3.912;

/// The value of a name; else an error in one line that lists the names.
fn named<T: Copy>(all: &[T], name_of: fn(T) -> &'static str, name: &str) -> Result<T, String> {
    let found = all.iter().copied().find(|v| name_of(*v) == name);
    let names: Vec<&str> = all.iter().map(|v| name_of(*v)).collect();
    found.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

impl FromStr for TimeOfDay {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, Self::name, name)
    }
}

impl FromStr for Weather {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, Self::name, name)
    }
}

// Written by hand: with a derive, each documented name would become a schema of its own, which endpoints understand
// less well.
impl JsonSchema for TimeOfDay {
    fn schema_name() -> Cow<'static, str> {
        "TimeOfDay".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "Part of the day.", "type": "string", "enum": Self::ALL.map(Self::name) })
    }
}

impl JsonSchema for Weather {
    fn schema_name() -> Cow<'static, str> {
        "Weather".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "What is in the air.", "type": "string", "enum": Self::ALL.map(Self::name) })
    }
}

/// Where the sun (at night the moon) stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// Degrees counter-clockwise from the x axis of the world frame.
    pub azimuth_deg: f64,
    /// Degrees above the horizon, 0 to 90.
    pub elevation_deg: f64,
}

/// Light and air of a scene: its look, apart from the objects in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// Time of day.
    pub time: TimeOfDay,
    /// Weather.
    pub weather: Weather,
    /// How wet the ground is, 0 (dry) to 1 (puddles).
    pub wetness: f64,
    /// How far one sees, m: there 2 % of a contrast is left.
    pub visibility_m: f64,
    /// Where the sun stands; none: as the time of day and the seed have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun: Option<Sun>,
    /// Varies colours, textures and where the sun stands.
    pub seed: u64,
}

impl Default for Conditions {
    fn default() -> Self {
        Self::usual(TimeOfDay::Day, Weather::Clear, 0)
    }
}

impl Conditions {
    /// Nearest and farthest visibility, m.
    pub const VISIBILITY_M: [f64; 2] = [5.0, 100_000.0];

    /// Ground, air and sun as they usually are at that time in that weather.
    pub fn usual(time: TimeOfDay, weather: Weather, seed: u64) -> Self {
        Self {
            time,
            weather,
            wetness: weather.usual_wetness(),
            visibility_m: weather.usual_visibility_m(),
            sun: None,
            seed,
        }
    }

    /// These conditions at another time; the sun moves to its usual place then.
    #[must_use]
    pub fn at(self, time: TimeOfDay) -> Self {
        let sun = self.sun.filter(|_| time == self.time);
        Self { time, sun, ..self }
    }

    /// These conditions in another weather; ground and air become as usual in it.
    #[must_use]
    pub fn under(self, weather: Weather) -> Self {
        if weather == self.weather {
            return self;
        }
        Self {
            weather,
            wetness: weather.usual_wetness(),
            visibility_m: weather.usual_visibility_m(),
            ..self
        }
    }

    /// Share of light that the air absorbs, per m.
    pub fn lost_per_m(&self) -> f64 {
        LOSS_AT_VISIBILITY / self.visibility_m
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        // Written so that NaN fails too.
        if !(0.0..=1.0).contains(&self.wetness) {
            return Some(format!("wetness is {}, expected 0 to 1", self.wetness));
        }
        let [near, far] = Self::VISIBILITY_M;
        if !(near..=far).contains(&self.visibility_m) {
            let found = self.visibility_m;
            return Some(format!("visibility_m is {found}, expected {near} to {far}"));
        }
        let sun = self.sun?;
        if !(-360.0..=360.0).contains(&sun.azimuth_deg) {
            let found = sun.azimuth_deg;
            return Some(format!("azimuth_deg of the sun is {found}, expected -360 to 360"));
        }
        if !(0.0..=90.0).contains(&sun.elevation_deg) {
            let found = sun.elevation_deg;
            return Some(format!("elevation_deg of the sun is {found}, expected 0 to 90"));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files() {
        for time in TimeOfDay::ALL {
            assert_eq!(time.name().parse(), Ok(time));
            let json = serde_json::to_value(time).expect("a name");
            assert_eq!(json, time.name());
        }
        for weather in Weather::ALL {
            assert_eq!(weather.name().parse(), Ok(weather));
            let json = serde_json::to_value(weather).expect("a name");
            assert_eq!(json, weather.name());
        }
        let unknown = "hail".parse::<Weather>().expect_err("unknown");
        assert!(unknown.contains("sandstorm"), "{unknown}");
    }

    #[test]
    fn what_is_not_sound_is_named() {
        let day = Conditions::default();
        let sun = |azimuth_deg, elevation_deg| Conditions {
            sun: Some(Sun {
                azimuth_deg,
                elevation_deg,
            }),
            ..day
        };
        let wet = |wetness| Conditions { wetness, ..day };
        let far = |visibility_m| Conditions { visibility_m, ..day };
        for good in [
            day,
            sun(-90.0, 0.0),
            sun(10.0, 90.0),
            wet(0.3),
            far(5.0),
            far(1e5),
        ] {
            assert_eq!(good.problem(), None);
        }
        for (bad, field) in [
            (wet(f64::NAN), "wetness"),
            (wet(1.01), "wetness"),
            (wet(-0.1), "wetness"),
            (far(f64::INFINITY), "visibility_m"),
            (far(0.0), "visibility_m"),
            (far(f64::NAN), "visibility_m"),
            (sun(f64::NAN, 10.0), "azimuth_deg"),
            (sun(0.0, -1.0), "elevation_deg"),
            (sun(0.0, f64::NAN), "elevation_deg"),
        ] {
            let problem = bad.problem().expect("not sound");
            assert!(
                problem.starts_with(field) && problem.contains("expected"),
                "{problem}"
            );
        }
        for weather in Weather::ALL {
            assert_eq!(Conditions::usual(TimeOfDay::Night, weather, 7).problem(), None);
        }
    }

    #[test]
    fn weather_brings_its_ground_and_air() {
        let rain = Conditions::default().under(Weather::Rain);
        assert_eq!(rain, Conditions::usual(TimeOfDay::Day, Weather::Rain, 0));
        let drying = Conditions { wetness: 0.4, ..rain };
        assert_eq!(drying.under(Weather::Rain).wetness, 0.4);
        assert_eq!(drying.at(TimeOfDay::Night).wetness, 0.4);
        let sun = Some(Sun {
            azimuth_deg: 5.0,
            elevation_deg: 20.0,
        });
        let set = Conditions { sun, ..rain };
        assert_eq!(set.at(TimeOfDay::Day).sun, sun);
        assert_eq!(set.at(TimeOfDay::Dusk).sun, None);
        // Conversion to metres and back gives the exact numbers that the pictures were tuned with.
        let fog = Conditions::usual(TimeOfDay::Day, Weather::Fog, 0);
        assert_eq!(fog.lost_per_m() as f32, 0.042_f32);
        assert_eq!(Conditions::default().lost_per_m() as f32, 0.0011_f32);
    }
}
