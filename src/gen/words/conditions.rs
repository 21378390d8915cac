//! Time of day and weather of a text. The phrases are in the lexicon; this file knows the words that negate them: "no
//! rain", "it is no longer raining", "the fog has lifted", "dry road after the rain".

use super::lexicon::{LONGEST_PHRASE, Lexicon};
use super::reading::{Act, ActKind, Reading};
use super::tokens::{Token, tokens};
use place::beside_road::TextSpan;
use scene::{Conditions, TimeOfDay, Weather};

/// Time of day and weather of a text; `None` where it has no statement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StatedConditions {
    /// Time of day.
    pub time: Option<TimeOfDay>,
    /// Weather.
    pub weather: Option<Weather>,
}

/// One phrase for a time or a weather.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mention {
    what: TimeOrWeather,
    /// Tokens: from the first up to, but not including, the second.
    at: (usize, usize),
    /// True if the text negates it.
    denied: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TimeOrWeather {
    Time(TimeOfDay),
    Weather(Weather),
}

/// Words that negate the phrase after them.
const NOT: [&str; 15] = [
    "no", "not", "without", "never", "nor", "neither", "isnt", "arent", "wasnt", "doesnt", "dont", "didnt",
    "aint", "hardly", "free",
];
/// Words that negate a phrase only right before it: in "stopped in the rain" it rains.
const STOP: [&str; 3] = ["stop", "stops", "stopped"];
/// Words that may stand between a negating word and the phrase.
const BETWEEN: [&str; 14] = [
    "a", "an", "any", "the", "longer", "more", "at", "all", "in", "under", "of", "it", "being", "either",
];
/// Words that join phrases negated by one "no": "no rain or snow".
const JOINS: [&str; 3] = ["or", "nor", "and"];
/// Words after a weather that is over.
const OVER: [&[&str]; 16] = [
    &["has", "stopped"],
    &["has", "ended"],
    &["has", "passed"],
    &["has", "gone"],
    &["has", "cleared"],
    &["is", "over"],
    &["is", "gone"],
    &["is", "past"],
    &["stopped"],
    &["stops"],
    &["ended"],
    &["passed"],
    &["cleared"],
    &["any", "more"],
    &["anymore"],
    &["any", "longer"],
];
/// Words before a weather that is over.
const AFTER: [&str; 2] = ["after", "following"];
/// Words and marks that end a clause.
const ENDS: [&str; 6] = [".", ";", "!", "?", ":", "but"];

/// Reads a text. Of several statements the one with the strongest effect counts: a storm over rain, rain over clouds.
pub fn read(text: &str) -> StatedConditions {
    said(&mentions(&tokens(text, None)))
}

/// The conditions that a style text asks for; a clear day where it has no statement.
pub fn of_style(text: &str, seed: u64) -> Conditions {
    let said = read(text);
    Conditions::usual(
        said.time.unwrap_or_default(),
        said.weather.unwrap_or_default(),
        seed,
    )
}

/// Corrects a reading by the negations of its text: a negated weather becomes a clear one.
pub(super) fn set_right(reading: &mut Reading, tokens: &[Token]) {
    let mentions = mentions(tokens);
    let denied = |what: TimeOrWeather| {
        let mut of = mentions.iter().filter(|m| m.what == what).peekable();
        of.peek().is_some() && of.all(|m| m.denied)
    };
    let told = said(&mentions);
    let others: Vec<ActKind> = reading.acts.iter().map(|a| a.what.clone()).collect();
    reading.acts.retain_mut(|act| {
        let right = match act.what {
            ActKind::Weather { what } if denied(TimeOrWeather::Weather(what)) => ActKind::Weather {
                what: told.weather.unwrap_or_default(),
            },
            ActKind::Time { what } if denied(TimeOrWeather::Time(what)) => ActKind::Time {
                what: told.time.unwrap_or_default(),
            },
            _ => return true,
        };
        act.what = right;
        // (conditions of another act need no second act)
        !others.contains(&act.what)
    });
    // A negation that the readers missed.
    let speaks = |test: fn(&ActKind) -> bool| reading.acts.iter().any(|a| test(&a.what));
    let back = mentions
        .iter()
        .find(|m| m.denied && matches!(m.what, TimeOrWeather::Weather(_)));
    if let (Some(back), Some(weather), false) = (
        back,
        told.weather,
        speaks(|w| matches!(w, ActKind::Weather { .. })),
    ) {
        reading.acts.push(Act {
            what: ActKind::Weather { what: weather },
            span: span(tokens, back.at),
            confidence: 1.0,
        });
    }
}

fn span(tokens: &[Token], (from, to): (usize, usize)) -> Option<TextSpan> {
    let part = tokens.get(from..to)?;
    part.iter().map(|t| t.span).reduce(TextSpan::to)
}

/// The time and weather that all mentions together give.
fn said(mentions: &[Mention]) -> StatedConditions {
    let times = [TimeOfDay::Night, TimeOfDay::Dusk, TimeOfDay::Dawn, TimeOfDay::Day];
    let weathers = [
        Weather::Sandstorm,
        Weather::Snow,
        Weather::Rain,
        Weather::Fog,
        Weather::Overcast,
        Weather::Clear,
    ];
    let is =
        |what: TimeOrWeather, denied: bool| mentions.iter().any(|m| m.what == what && m.denied == denied);
    let time = times.into_iter().find(|t| is(TimeOrWeather::Time(*t), false));
    let weather = weathers
        .into_iter()
        .find(|w| is(TimeOrWeather::Weather(*w), false));
    // If a condition is only negated ("not at night", "no rain"), it is day or clear.
    let dark = times[..3].iter().any(|t| is(TimeOrWeather::Time(*t), true));
    let bad = weathers[..5].iter().any(|w| is(TimeOrWeather::Weather(*w), true));
    StatedConditions {
        time: time.or(dark.then_some(TimeOfDay::Day)),
        weather: weather.or(bad.then_some(Weather::Clear)),
    }
}

/// All phrases for times and weathers: at each word the longest that begins there.
fn mentions(tokens: &[Token]) -> Vec<Mention> {
    let mut out: Vec<Mention> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let most = LONGEST_PHRASE.min(tokens.len() - i);
        let found = (1..=most).rev().find_map(|n| {
            let words: Vec<&str> = tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
            let senses = Lexicon::bundled().senses(&words.join(" "))?;
            Some((n, senses))
        });
        let Some((n, senses)) = found else {
            i += 1;
            continue;
        };
        // ("a grey van" is not a grey sky, "a dark red car" not night)
        let next = tokens.get(i + n).map_or(&[][..], |t| &t.senses);
        let paints = senses.iter().any(|s| s.kind == "paint");
        let of_a_thing = next
            .iter()
            .any(|s| s.kind == "paint" || paints && s.kind == "noun");
        let what = senses.iter().find_map(|s| match s.kind {
            "time" => s.symbol.parse().ok().map(TimeOrWeather::Time),
            "weather" => s.symbol.parse().ok().map(TimeOrWeather::Weather),
            _ => None,
        });
        if let Some(what) = what.filter(|_| !of_a_thing) {
            let at = (i, i + n);
            let denied = is_denied(tokens, what, at) || is_joined(tokens, out.last(), i);
            out.push(Mention { what, at, denied });
        }
        i += n;
    }
    out
}

/// True if words around a phrase negate it.
fn is_denied(tokens: &[Token], what: TimeOrWeather, (from, to): (usize, usize)) -> bool {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut before = tokens[..from].iter().rev().map(|t| t.text.as_str());
    let first = before.find(|w| !BETWEEN.contains(w)).unwrap_or("");
    let no_longer = from >= 2 && (word(from - 2), word(from - 1)) == ("no", "longer");
    let right_before = tokens[..from]
        .iter()
        .rev()
        .map(|t| t.text.as_str())
        .find(|w| *w != "the");
    let stop = right_before.is_some_and(|w| STOP.contains(&w));
    // ("after dusk" is a time itself)
    let after = AFTER.contains(&first) && matches!(what, TimeOrWeather::Weather(_));
    let over = OVER
        .iter()
        .any(|words| words.iter().enumerate().all(|(k, w)| word(to + k) == *w));
    NOT.contains(&first) || stop || no_longer || after || over
}

/// True if a phrase is joined to a negated one: "no rain or snow".
fn is_joined(tokens: &[Token], last: Option<&Mention>, from: usize) -> bool {
    let Some(last) = last.filter(|m| m.denied) else {
        return false;
    };
    let between = tokens.get(last.at.1..from).unwrap_or_default();
    let joins = |t: &Token| {
        let w = t.text.as_str();
        JOINS.contains(&w) || w == "," || BETWEEN.contains(&w)
    };
    let or = between.iter().any(|t| matches!(t.text.as_str(), "or" | "nor"));
    let ends = between.iter().any(|t| ENDS.contains(&t.text.as_str()));
    or && !ends && between.iter().all(joins)
}

#[cfg(test)]
#[path = "conditions_tests.rs"]
mod tests;
