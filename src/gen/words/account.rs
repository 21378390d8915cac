//! Checks whether every content word of a text is in its reading. Words that are not are reported, never dropped
//! silently.

use serde::Serialize;

use super::grammar;
use super::lexicon::{is_english, is_other_thing};
use super::measure::{Measure, MeasuredQuantity, measures};
use super::notation;
use super::nouns::Noun;
use super::reading::{ActKind, AnchorPhrase, ObjectPhrase, Quantity, Reading};
use super::slots::{Slot, slots};
use super::tokens::{Speller, Token, number_word};
use place::beside_road::TextSpan;

/// A word that the reading does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// No list has the word.
    Unknown,
    /// The word is understood, but nothing of it is carried out.
    NotCarriedOut,
    /// The word lies beyond the longest text that is read.
    TooLong,
}

/// A word that the reading does not hold, with its place and the reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Missing {
    /// Bytes of the text that it takes.
    pub span: TextSpan,
    /// The words.
    pub words: String,
    /// The reason.
    pub why: Why,
}

/// Words of arithmetic: numbers near them need not be in the reading.
const ARITHMETIC: [&str; 27] = [
    "half",
    "twice",
    "double",
    "triple",
    "halve",
    "quadruple",
    "many",
    "more",
    "fewer",
    "less",
    "each",
    "total",
    "altogether",
    "second",
    "third",
    "other",
    "rest",
    "both",
    "apiece",
    "every",
    "per",
    "another",
    "remain",
    "remaining",
    "times",
    "dozen",
    "couple",
];
/// Words that retract the words before them.
const CORRECTS: [&str; 7] = [
    "sorry",
    "mean",
    "meant",
    "scratch",
    "correction",
    "actually",
    "wait",
];
/// Number of tokens within which a word is near another.
const NEAR: usize = 5;
/// Words before something that is not meant.
const NOT: [&str; 10] = [
    "not", "no", "than", "from", "isnt", "wasnt", "of", "was", "were", "instead",
];

/// The words of a text that its reading does not hold.
pub fn missing(text: &str, tokens: &[Token], reading: &Reading, speller: &Speller) -> Vec<Missing> {
    let line = notation::write(reading);
    let said: Vec<&str> = line.split(' ').collect();
    let numbers = ReadingNumbers::from_reading(reading, tokens);
    let nouns = named(reading);
    let corrected = tokens
        .iter()
        .rposition(|t| CORRECTS.contains(&t.text.as_str()))
        .unwrap_or(0);
    let mut of_text = measures(tokens).into_iter().peekable();
    let mut out: Vec<Missing> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let t = &tokens[i];
        let mut end = i + 1;
        while end < tokens.len()
            && !t.senses.is_empty()
            && tokens[end].senses == t.senses
            && t.value.is_none()
        {
            end += 1;
        }
        let before = i.checked_sub(1).map_or("", |k| tokens[k].text.as_str());
        while of_text.peek().is_some_and(|m| m.from < i) {
            of_text.next();
        }
        let measure = of_text.peek().filter(|m| m.from == i).copied();
        let why = if let Some(m) = measure {
            end = m.to;
            (!numbers.hold(&m)).then_some(Why::NotCarriedOut)
        } else if !t.senses.is_empty() {
            let there = t
                .senses
                .iter()
                .any(|s| sense_is_said(s.kind, s.symbol, &said, &nouns));
            let of_the_thing = t
                .senses
                .iter()
                .all(|s| !matches!(s.kind, "place" | "ego" | "road" | "group" | "env" | "density"));
            (!there && of_the_thing && !NOT.contains(&before)).then_some(Why::NotCarriedOut)
        } else if !side_is_said(t, before, &said) {
            Some(Why::NotCarriedOut)
        } else if let Some(n) = grammar::cannot(&tokens[i..]) {
            end = i + n;
            Some(Why::NotCarriedOut)
        } else {
            let word = t.text.chars().count() > 2 && t.text.chars().all(char::is_alphabetic);
            let known =
                speller.is_common(&t.text) || grammar::knows(&t.text) || number_word(&t.text).is_some();
            // (verbs and adverbs tell how, and most repeat what the reading holds)
            let tells = is_english(&t.text) && !is_other_thing(&t.text);
            (word && !known && !tells).then_some(Why::Unknown)
        };
        // (words before a correction are not meant)
        let taken_back = i < corrected && why == Some(Why::NotCarriedOut);
        if let Some(why) = why.filter(|_| !taken_back) {
            let span = t.span.to(tokens[end - 1].span);
            out.push(Missing {
                span,
                words: span.of(text).to_owned(),
                why,
            });
        }
        i = end;
    }
    out
}

/// The numbers that a reading holds, and hints on the numbers of the text from the words around them.
struct ReadingNumbers<'t> {
    tokens: &'t [Token],
    slots: Vec<Slot>,
    sums: Vec<f64>,
    tells_time: bool,
    halves: bool,
}

impl<'t> ReadingNumbers<'t> {
    fn from_reading(reading: &Reading, tokens: &'t [Token]) -> Self {
        Self {
            tokens,
            slots: slots(reading),
            sums: sums(reading),
            tells_time: reading
                .acts
                .iter()
                .any(|a| matches!(a.what, ActKind::Time { .. })),
            halves: notation::write(reading).split(' ').any(|s| s == "half"),
        }
    }

    /// True if a number of the text is in the reading with its meaning, or is not meant.
    fn hold(&self, m: &Measure) -> bool {
        self.is_taken_back(m)
            || self.slots.iter().any(|s| s.is(m))
            || match m.kind {
                MeasuredQuantity::Count => self.is_worked_out(m),
                MeasuredQuantity::Share => m.value == 50.0 && self.halves,
                // ("at 11 pm" is night)
                MeasuredQuantity::Clock => self.tells_time,
                _ => false,
            }
    }

    fn word(&self, i: Option<usize>) -> &str {
        i.and_then(|i| self.tokens.get(i)).map_or("", |t| t.text.as_str())
    }

    /// True if a number of things is a sum of others, or too small to be written as one.
    fn is_worked_out(&self, m: &Measure) -> bool {
        let i = m.from;
        let before = self.word(i.checked_sub(1));
        let around = &self.tokens[i.saturating_sub(NEAR)..self.tokens.len().min(i + NEAR + 1)];
        // ("second 3" is a moment)
        let is_moment = before == "second";
        let works_out = !is_moment && around.iter().any(|t| ARITHMETIC.contains(&t.text.as_str()));
        m.value <= 1.0 || works_out || self.sums.contains(&m.value) || self.word(Some(i)) == "hundred"
    }

    /// True if the words before a number say that it is not meant: "not 25", "from 15 to 20 m".
    fn is_taken_back(&self, m: &Measure) -> bool {
        let at = m.from.checked_sub(1);
        let before = self.word(at);
        if m.kind == MeasuredQuantity::Count {
            return NOT.contains(&before);
        }
        let earlier = self.word(at.and_then(|k| k.checked_sub(1)));
        match before {
            "not" | "no" | "isnt" | "wasnt" | "instead" | "was" | "were" => true,
            "of" => earlier == "instead",
            "than" => matches!(earlier, "rather" | "other"),
            "from" => self.word(Some(m.to)) == "to",
            _ => false,
        }
    }
}

/// A thing that a reading names.
struct NamedThing {
    noun: Noun,
    /// True if it stands for every thing there is: "remove all objects".
    is_everything: bool,
}

/// All things that a reading names.
fn named(reading: &Reading) -> Vec<NamedThing> {
    fn add(t: &ObjectPhrase, takes: bool, out: &mut Vec<NamedThing>) {
        // (the others of "no other vehicles" are those that were not named)
        let rest = takes && t.other;
        if !rest {
            out.push(NamedThing {
                noun: t.noun,
                is_everything: takes && t.noun == Noun::Thing,
            });
        }
        for p in &t.places {
            for a in [&p.to, &p.and].into_iter().flatten() {
                if let AnchorPhrase::Thing(t) = a {
                    add(t, false, out);
                }
            }
        }
        t.except.iter().for_each(|t| add(t, false, out));
    }
    let mut out = Vec::new();
    for act in &reading.acts {
        let takes = matches!(
            act.what,
            ActKind::Remove { .. } | ActKind::No { .. } | ActKind::Keep { .. } | ActKind::Leave { .. }
        );
        act.what.things(&mut |t| add(t, takes, &mut out));
    }
    out
}

/// Sums of the numbers of things: "five cars, one of them red" is four and one.
fn sums(reading: &Reading) -> Vec<f64> {
    const MOST: u32 = 60;
    let mut sums = vec![0];
    let mut add = |t: &ObjectPhrase| {
        let n = match t.quantity {
            Quantity::N(n) | Quantity::TheN(n) | Quantity::Range(n, _) => n,
            Quantity::The | Quantity::Unsaid => 1,
            _ => return,
        };
        let more: Vec<u32> = sums
            .iter()
            .map(|s| s + n)
            .filter(|s| *s <= MOST && !sums.contains(s))
            .collect();
        sums.extend(more);
    };
    for act in &reading.acts {
        if !matches!(act.what, ActKind::No { .. } | ActKind::Count { .. }) {
            act.what.things(&mut add);
        }
    }
    sums.into_iter().skip(1).map(f64::from).collect()
}

fn sense_is_said(kind: &str, symbol: &str, said: &[&str], nouns: &[NamedThing]) -> bool {
    let has = |s: &str| said.contains(&s) || said.contains(&format!("not_{s}").as_str());
    if has(symbol) {
        return true;
    }
    match kind {
        // (a wider or a narrower word names it too; a pronoun stands only for a thing that was named)
        "noun" => {
            let Some(noun) = Noun::of(symbol) else { return true };
            let stands_for = |n: Noun| matches!(n, Noun::It | Noun::One | Noun::Thing);
            // (a rider or driver stands for what is ridden)
            let rides = |n: Noun| {
                matches!(
                    n,
                    Noun::Bicycle | Noun::Motorcycle | Noun::Scooter | Noun::TwoWheeler
                )
            };
            let person = noun.classes() == Noun::Person.classes();
            said.first() == Some(&"keep")
                || stands_for(noun) && !nouns.is_empty()
                || nouns.iter().any(|n| {
                    let shares = || n.noun.classes().iter().any(|c| noun.classes().contains(c));
                    n.is_everything || person && rides(n.noun) || !stands_for(n.noun) && shares()
                })
        }
        // ("the colour of the bus", "no more rain")
        "paint" => said.contains(&"paint_of"),
        "weather" => said.contains(&"weather"),
        "time" => said.contains(&"time"),
        _ => false,
    }
}

/// True if the token is not a side ("left" or "right" after words such as "the"; not "has left" or "right there"), or
/// if the reading holds that side.
fn side_is_said(t: &Token, before: &str, said: &[&str]) -> bool {
    let side = t.text.as_str();
    let is_side = matches!(side, "left" | "right");
    let of = matches!(
        before,
        "the" | "my" | "our" | "to" | "on" | "its" | "your" | "his" | "far"
    );
    !is_side
        || !of
        || said
            .iter()
            .any(|s| s.contains(side) || matches!(*s, "other_side" | "other_lane" | "like"))
}
