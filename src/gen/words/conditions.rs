//! What a text says of time of day and weather. The phrases are the lexicon's; this file knows what takes them back:
//! "no rain", "it is no longer raining", "the fog has lifted", "dry road after the rain".

use super::lexicon::{LONGEST_PHRASE, Lexicon};
use super::reading::{Act, Reading, What};
use super::tokens::{Token, tokens};
use place::beside_road::Span;
use scene::{Conditions, TimeOfDay, Weather};

/// What a text says; nothing is said of what is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Said {
    /// Time of day.
    pub time: Option<TimeOfDay>,
    /// Weather.
    pub weather: Option<Weather>,
}

/// One phrase for a time or a weather.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mention {
    what: Named,
    /// Tokens from, and up to but not including.
    at: (usize, usize),
    /// True if the text takes it back.
    denied: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Named {
    Time(TimeOfDay),
    Weather(Weather),
}

/// Words that take back what follows.
const NOT: [&str; 15] = [
    "no", "not", "without", "never", "nor", "neither", "isnt", "arent", "wasnt", "doesnt", "dont", "didnt",
    "aint", "hardly", "free",
];
/// Words that do so only right before it: who "stopped in the rain" stands in it.
const STOP: [&str; 3] = ["stop", "stops", "stopped"];
/// Words that may stand between one of those and what it takes back.
const BETWEEN: [&str; 14] = [
    "a", "an", "any", "the", "longer", "more", "at", "all", "in", "under", "of", "it", "being", "either",
];
/// Words that join what is taken back by one "no": "no rain or snow".
const JOINS: [&str; 3] = ["or", "nor", "and"];
/// What follows a weather that is over.
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
/// What stands before a weather that is over.
const AFTER: [&str; 2] = ["after", "following"];
/// Where one clause ends and another begins.
const ENDS: [&str; 6] = [".", ";", "!", "?", ":", "but"];

/// Reads a text: what it says last is weighed against the rest by how much it shows, a storm above rain, rain above clouds.
pub fn read(text: &str) -> Said {
    said(&mentions(&tokens(text, None)))
}

/// The conditions that a style text asks for: what it does not name is a clear day.
pub fn of_style(text: &str, seed: u64) -> Conditions {
    let said = read(text);
    Conditions::usual(
        said.time.unwrap_or_default(),
        said.weather.unwrap_or_default(),
        seed,
    )
}

/// Sets right what a reading says against the denials of its text: a weather that is taken back is a clear one.
pub(super) fn set_right(reading: &mut Reading, tokens: &[Token]) {
    let mentions = mentions(tokens);
    let denied = |what: Named| {
        let mut of = mentions.iter().filter(|m| m.what == what).peekable();
        of.peek().is_some() && of.all(|m| m.denied)
    };
    let told = said(&mentions);
    let others: Vec<What> = reading.acts.iter().map(|a| a.what.clone()).collect();
    reading.acts.retain_mut(|act| {
        let right = match act.what {
            What::Weather { what } if denied(Named::Weather(what)) => What::Weather {
                what: told.weather.unwrap_or_default(),
            },
            What::Time { what } if denied(Named::Time(what)) => What::Time {
                what: told.time.unwrap_or_default(),
            },
            _ => return true,
        };
        act.what = right;
        // (what another act says needs no second one)
        !others.contains(&act.what)
    });
    // A denial that the readers passed over.
    let speaks = |test: fn(&What) -> bool| reading.acts.iter().any(|a| test(&a.what));
    let back = mentions
        .iter()
        .find(|m| m.denied && matches!(m.what, Named::Weather(_)));
    if let (Some(back), Some(weather), false) =
        (back, told.weather, speaks(|w| matches!(w, What::Weather { .. })))
    {
        reading.acts.push(Act {
            what: What::Weather { what: weather },
            span: span(tokens, back.at),
            confidence: 1.0,
        });
    }
}

fn span(tokens: &[Token], (from, to): (usize, usize)) -> Option<Span> {
    let part = tokens.get(from..to)?;
    part.iter().map(|t| t.span).reduce(Span::to)
}

/// What all mentions come to.
fn said(mentions: &[Mention]) -> Said {
    let times = [TimeOfDay::Night, TimeOfDay::Dusk, TimeOfDay::Dawn, TimeOfDay::Day];
    let weathers = [
        Weather::Sandstorm,
        Weather::Snow,
        Weather::Rain,
        Weather::Fog,
        Weather::Overcast,
        Weather::Clear,
    ];
    let is = |what: Named, denied: bool| mentions.iter().any(|m| m.what == what && m.denied == denied);
    let time = times.into_iter().find(|t| is(Named::Time(*t), false));
    let weather = weathers.into_iter().find(|w| is(Named::Weather(*w), false));
    // What is only taken back leaves the plain day: "not at night", "no rain".
    let dark = times[..3].iter().any(|t| is(Named::Time(*t), true));
    let bad = weathers[..5].iter().any(|w| is(Named::Weather(*w), true));
    Said {
        time: time.or(dark.then_some(TimeOfDay::Day)),
        weather: weather.or(bad.then_some(Weather::Clear)),
    }
}

/// All phrases for times and weathers, the longest that begins at each word.
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
        // ("a grey van" is no grey sky, "a dark red car" no night)
        let next = tokens.get(i + n).map_or(&[][..], |t| &t.senses);
        let paints = senses.iter().any(|s| s.kind == "paint");
        let of_a_thing = next
            .iter()
            .any(|s| s.kind == "paint" || paints && s.kind == "noun");
        let what = senses.iter().find_map(|s| match s.kind {
            "time" => s.symbol.parse().ok().map(Named::Time),
            "weather" => s.symbol.parse().ok().map(Named::Weather),
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

/// True if words around a phrase take it back.
fn is_denied(tokens: &[Token], what: Named, (from, to): (usize, usize)) -> bool {
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
    // ("after dusk" is a time of its own)
    let after = AFTER.contains(&first) && matches!(what, Named::Weather(_));
    let over = OVER
        .iter()
        .any(|words| words.iter().enumerate().all(|(k, w)| word(to + k) == *w));
    NOT.contains(&first) || stop || no_longer || after || over
}

/// True if a phrase is joined to one that is taken back: "no rain or snow".
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
