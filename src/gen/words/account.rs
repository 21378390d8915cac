//! Whether every content word of a text is in its reading: what is not is named, never passed over in silence.

use serde::Serialize;

use super::grammar;
use super::lexicon::{is_english, is_other_thing};
use super::notation;
use super::nouns::Noun;
use super::reading::{Quantity, Reading, Thing, What};
use super::tokens::{Speller, Token, number_word};
use place::beside_road::Span;

/// A word that the reading does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// No list has it.
    Unknown,
    /// It is understood, and nothing of it is carried out.
    NotCarriedOut,
    /// It lies beyond the longest text that is read.
    TooLong,
}

/// Where, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Missing {
    /// Bytes of the text.
    pub span: Span,
    /// The words.
    pub words: String,
    /// Why.
    pub why: Why,
}

/// Words by which numbers are worked out: numbers this near to them need not stand in the reading.
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
/// Words that take back what stands before them.
const CORRECTS: [&str; 7] = [
    "sorry",
    "mean",
    "meant",
    "scratch",
    "correction",
    "actually",
    "wait",
];
/// So many tokens away.
const NEAR: usize = 5;
/// What follows them is what is not meant.
const NOT: [&str; 10] = [
    "not", "no", "than", "from", "isnt", "wasnt", "of", "was", "were", "instead",
];

/// The words of a text that its reading does not hold.
pub fn missing(text: &str, tokens: &[Token], reading: &Reading, speller: &Speller) -> Vec<Missing> {
    let line = notation::write(reading);
    let said: Vec<&str> = line.split(' ').collect();
    let sums = sums(reading);
    let corrected = tokens
        .iter()
        .rposition(|t| CORRECTS.contains(&t.text.as_str()))
        .unwrap_or(0);
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
        let why = if let Some(v) = t.value {
            let there = number_is_said(v, t, &said) || !t.is_length && sums.contains(&v);
            let around = &tokens[i.saturating_sub(NEAR)..tokens.len().min(i + NEAR + 1)];
            // ("second 3" is a moment)
            let is_moment = before == "second";
            let works_out = !is_moment && around.iter().any(|t| ARITHMETIC.contains(&t.text.as_str()));
            let small = !t.is_length && (v <= 1.0 || works_out);
            (!there && !small && !NOT.contains(&before) && t.text != "hundred").then_some(Why::NotCarriedOut)
        } else if !t.senses.is_empty() {
            let there = t.senses.iter().any(|s| sense_is_said(s.kind, s.symbol, &said));
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
            // (verbs and adverbs tell how, and most say what the reading says)
            let tells = is_english(&t.text) && !is_other_thing(&t.text);
            (word && !known && !tells).then_some(Why::Unknown)
        };
        // (what was said before a correction is not meant)
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

/// What numbers of things add up to: "five cars, one of them red" is four and one.
fn sums(reading: &Reading) -> Vec<f64> {
    const MOST: u32 = 60;
    let mut sums = vec![0];
    let mut add = |t: &Thing| {
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
        let (who, things): (&[Thing], &[Thing]) = match &act.what {
            What::Add { things } => (&[], things),
            What::Replace { who, things } => (who, things),
            What::Remove { who }
            | What::Keep { who }
            | What::Leave { who }
            | What::Move { who, .. }
            | What::Turn { who, .. }
            | What::Set { who, .. }
            | What::Go { who, .. } => (who, &[]),
            What::Swap { one, other } => (std::slice::from_ref(one), std::slice::from_ref(other)),
            _ => continue,
        };
        who.iter().chain(things).for_each(&mut add);
    }
    sums.into_iter().skip(1).map(f64::from).collect()
}

fn number_is_said(v: f64, token: &Token, said: &[&str]) -> bool {
    said.iter().any(|s| {
        let length = s.strip_suffix('m').and_then(|n| n.parse::<f64>().ok());
        let plain = s
            .trim_start_matches('#')
            .trim_end_matches("kmh")
            .trim_end_matches('s')
            .parse::<f64>()
            .ok()
            .filter(|_| !token.is_length);
        length.or(plain).is_some_and(|n| (n - v).abs() < 0.06 + 1e-3 * v)
    })
}

fn sense_is_said(kind: &str, symbol: &str, said: &[&str]) -> bool {
    let has = |s: &str| said.contains(&s) || said.contains(&format!("not_{s}").as_str());
    if has(symbol) {
        return true;
    }
    match kind {
        // (what is called by a wider or a finer word, or by a pronoun)
        "noun" => {
            let Some(noun) = Noun::of(symbol) else { return true };
            said.iter().filter_map(|s| Noun::of(s)).any(|n| {
                // (who rides or drives is what is ridden)
                let rides = matches!(
                    n,
                    Noun::Bicycle | Noun::Motorcycle | Noun::Scooter | Noun::TwoWheeler
                );
                let person = noun.classes() == Noun::Person.classes();
                matches!(n, Noun::It | Noun::One | Noun::Thing)
                    || person && rides
                    || said.first() == Some(&"keep")
                    || n.classes().iter().any(|c| noun.classes().contains(c))
            })
        }
        // ("the colour of the bus", "no more rain")
        "paint" => said.contains(&"paint_of"),
        "weather" => said.contains(&"weather"),
        "time" => said.contains(&"time"),
        _ => false,
    }
}

/// "Left" and "right" of a sentence stand in its reading, but where they say that something has left, or is right there.
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
