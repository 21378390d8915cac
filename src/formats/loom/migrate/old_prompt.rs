//! Migration of versions 1 and 2, which drew time of day and weather from words of the prompt: the reading of that time, so
//! that the pictures of old scenes stay as they were. Never extended; today's reading is in the words' room.

use scene::{Conditions, TimeOfDay, Weather};

/// Words of a time; the first row of which one occurs counts.
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

/// Words of a weather; the first row of which one occurs counts.
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

/// Words that take the next one back, articles left out.
const NOT: [&str; 4] = ["no", "not", "without", "never"];
const ARTICLES: [&str; 4] = ["a", "an", "any", "the"];

/// The conditions that an old scene was drawn under.
pub(super) fn conditions(prompt: &str, seed: u64) -> Conditions {
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
    Conditions::usual(time.unwrap_or_default(), weather.unwrap_or_default(), seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_prompts_are_read_as_they_were() {
        let of = |text: &str| {
            let c = conditions(text, 3);
            assert_eq!(c, Conditions::usual(c.time, c.weather, 3));
            (c.time, c.weather)
        };
        assert_eq!(of(""), (TimeOfDay::Day, Weather::Clear));
        assert_eq!(of("A rainy NIGHT in Boston"), (TimeOfDay::Night, Weather::Rain));
        assert_eq!(of("sunset, heavy snowfall"), (TimeOfDay::Dusk, Weather::Snow));
        assert_eq!(of("foggy morning"), (TimeOfDay::Dawn, Weather::Fog));
        assert_eq!(of("day, no rain, cloudy"), (TimeOfDay::Day, Weather::Overcast));
        assert_eq!(of("not a rainy night"), (TimeOfDay::Night, Weather::Clear));
        assert_eq!(of("a sandstorm at noon"), (TimeOfDay::Day, Weather::Sandstorm));
        // Two sentences that it never understood; scenes that hold them stay as they were drawn.
        assert_eq!(of("sleet after nightfall"), (TimeOfDay::Day, Weather::Clear));
        assert_eq!(of("it is no longer raining"), (TimeOfDay::Day, Weather::Rain));
        for time in TimeOfDay::ALL {
            assert_eq!(of(time.name()).0, time);
        }
        for weather in Weather::ALL {
            assert_eq!(of(weather.name()).1, weather);
        }
    }
}
