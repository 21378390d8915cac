//! Time of day and weather of a picture, from names or from a prompt.

use std::str::FromStr;

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
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

/// What is in the air and on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
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
    /// Little to be seen beyond 40 m.
    Fog,
    /// Dust in the air and on everything.
    Sandstorm,
}

/// All that decides how a scene looks besides what is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Conditions {
    /// Time of day.
    pub time: TimeOfDay,
    /// Weather.
    pub weather: Weather,
    /// Varies colours, textures and where the sun stands.
    pub seed: u64,
}

impl TimeOfDay {
    /// Every time, by name.
    pub const ALL: [(&'static str, TimeOfDay); 4] = [
        ("dawn", TimeOfDay::Dawn),
        ("day", TimeOfDay::Day),
        ("dusk", TimeOfDay::Dusk),
        ("night", TimeOfDay::Night),
    ];
}

impl Weather {
    /// Every weather, by name.
    pub const ALL: [(&'static str, Weather); 6] = [
        ("clear", Weather::Clear),
        ("overcast", Weather::Overcast),
        ("rain", Weather::Rain),
        ("snow", Weather::Snow),
        ("fog", Weather::Fog),
        ("sandstorm", Weather::Sandstorm),
    ];
}

fn named<T: Copy>(all: &[(&'static str, T)], name: &str) -> Result<T, String> {
    let found = all.iter().find(|(n, _)| *n == name).map(|(_, v)| *v);
    let names: Vec<&str> = all.iter().map(|(n, _)| *n).collect();
    found.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

impl FromStr for TimeOfDay {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

impl FromStr for Weather {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// Words that name a time.
const TIMES: [(&[&str], TimeOfDay); 4] = [
    (
        &["night", "nighttime", "midnight", "dark", "nocturnal"],
        TimeOfDay::Night,
    ),
    (&["dusk", "sunset", "evening", "twilight"], TimeOfDay::Dusk),
    (&["dawn", "sunrise", "morning"], TimeOfDay::Dawn),
    (
        &["day", "daytime", "noon", "midday", "afternoon", "daylight"],
        TimeOfDay::Day,
    ),
];

/// Words that name a weather; the first row that occurs wins, so "foggy after rain" is rain.
const WEATHERS: [(&[&str], Weather); 6] = [
    (
        &["sandstorm", "dust", "dusty", "sandy", "duststorm"],
        Weather::Sandstorm,
    ),
    (
        &[
            "snow",
            "snowy",
            "snowing",
            "snowfall",
            "blizzard",
            "winter",
            "snowstorm",
        ],
        Weather::Snow,
    ),
    (
        &[
            "rain", "rainy", "raining", "wet", "drizzle", "storm", "stormy", "shower", "downpour",
        ],
        Weather::Rain,
    ),
    (&["fog", "foggy", "mist", "misty", "haze", "hazy"], Weather::Fog),
    (
        &["overcast", "cloudy", "clouds", "grey", "gray"],
        Weather::Overcast,
    ),
    (&["sunny", "clear", "sun", "bright"], Weather::Clear),
];

/// Words that turn the next one around, articles left out.
const NOT: [&str; 4] = ["no", "not", "without", "never"];
const ARTICLES: [&str; 4] = ["a", "an", "any", "the"];

impl Conditions {
    /// Spots words for time and weather, in any case; what is not named keeps its default (a clear
    /// day), and so does what is denied ("no rain").
    pub fn from_prompt(prompt: &str) -> Self {
        let text = prompt.to_lowercase();
        let words: Vec<&str> = text
            .split(|c: char| !c.is_alphanumeric())
            .filter(|w| !w.is_empty())
            .collect();
        let said = |names: &[&str]| {
            (0..words.len()).any(|i| {
                let before = words[..i].iter().rev().find(|w| !ARTICLES.contains(w));
                let denied = before.is_some_and(|w| NOT.contains(w));
                names.contains(&words[i]) && !denied
            })
        };
        let time = TIMES.iter().find(|(names, _)| said(names)).map(|(_, t)| *t);
        let weather = WEATHERS.iter().find(|(names, _)| said(names)).map(|(_, w)| *w);
        Self {
            time: time.unwrap_or_default(),
            weather: weather.unwrap_or_default(),
            seed: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prompts_name_time_and_weather() {
        let of = |text: &str| {
            let c = Conditions::from_prompt(text);
            (c.time, c.weather)
        };
        assert_eq!(of(""), (TimeOfDay::Day, Weather::Clear));
        assert_eq!(of("A rainy NIGHT in Boston"), (TimeOfDay::Night, Weather::Rain));
        assert_eq!(of("sunset, heavy snowfall"), (TimeOfDay::Dusk, Weather::Snow));
        assert_eq!(of("foggy morning"), (TimeOfDay::Dawn, Weather::Fog));
        assert_eq!(of("day, no rain, cloudy"), (TimeOfDay::Day, Weather::Overcast));
        assert_eq!(of("not a rainy night"), (TimeOfDay::Night, Weather::Clear));
        assert_eq!(of("a sandstorm at noon"), (TimeOfDay::Day, Weather::Sandstorm));
        assert_eq!(
            of("a training run; Saturday; 夜 \u{0}"),
            (TimeOfDay::Day, Weather::Clear)
        );
        for (name, time) in TimeOfDay::ALL {
            assert_eq!(name.parse(), Ok(time));
            assert_eq!(of(name).0, time);
        }
        for (name, weather) in Weather::ALL {
            assert_eq!(name.parse(), Ok(weather));
            assert_eq!(of(name).1, weather);
        }
        assert!(
            "hail"
                .parse::<Weather>()
                .expect_err("unknown")
                .contains("sandstorm")
        );
    }
}
