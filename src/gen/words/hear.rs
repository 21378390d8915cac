//! Runs both readers. Where they agree, a text is read; where they differ, or one is unsure, the result tells so.

use serde::Serialize;

use super::account::{Missing, Why, missing};
use super::beside::{self, SceneryClauses, take};
use super::canonical::canonical;
use super::conditions;
use super::grammar;
use super::guess::take_out_guesses;
use super::halt;
use super::indefinite;
use super::measure::measures;
use super::notation;
use super::reader::{LearnedReader, Mode};
use super::reading::Reading;
use super::slots;
use super::tokens::{LONGEST, Token, tokens};
use nn::weights::WeightsError;
use place::beside_road::TextSpan;

/// Confidence below which an act is reported as unsure: the least threshold at which at most 8 % of sentences, in six
/// styles that the reader had not learned, are wrong without any report, for prompts and for edits.
pub const UNSURE: f64 = 0.85;

/// Reader of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// The grammar and the learned reader, which agree.
    Both,
    /// The grammar, which read every word.
    Grammar,
    /// The learned reader.
    Learned,
    /// A language model behind an endpoint.
    Endpoint,
    /// The user, by hand.
    Hand,
}

/// A typing error that was mended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mended {
    /// Bytes of the text.
    pub span: TextSpan,
    /// The word as it is read.
    pub to: String,
}

/// Result of reading a text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckedReading {
    /// The reading that is carried out.
    pub reading: Reading,
    /// The reader that it comes from.
    pub by: By,
    /// The other reader's reading, if it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<Reading>,
    /// Indices of acts that the reader is unsure of.
    pub unsure: Vec<usize>,
    /// Words that are not in the reading.
    pub missing: Vec<Missing>,
    /// Typing errors that were mended.
    pub mended: Vec<Mended>,
}

impl CheckedReading {
    /// True if there is nothing to report about the reading.
    pub fn is_plain(&self) -> bool {
        self.other.is_none() && self.unsure.is_empty() && self.missing.is_empty()
    }
}

/// Reads a text: clauses on scenery first, the rest with both readers.
///
/// # Errors
///
/// If the bundled weights are damaged.
pub fn hear(text: &str, mode: Mode) -> Result<CheckedReading, WeightsError> {
    let SceneryClauses { said, rest, idle } = take(text, mode == Mode::Edit);
    let mut heard = hear_objects(&rest, mode)?;
    let named = idle.into_iter().map(|span| Missing {
        span,
        words: span.of(text).to_owned(),
        why: Why::NotCarriedOut,
    });
    heard.missing.extend(named);
    if let Some(other) = &mut heard.other {
        other.background.clone_from(&said);
    }
    heard.reading.background = said;
    Ok(heard)
}

/// Reads a text without clauses on scenery.
///
/// # Errors
///
/// If the bundled weights are damaged.
pub fn hear_objects(text: &str, mode: Mode) -> Result<CheckedReading, WeightsError> {
    let learned = LearnedReader::bundled()?;
    let said = learned.read(text, mode);
    let known = |t: &Token| t.value.is_some() || learned.knows(t);
    let plain = grammar::read(&without_unknown(&said.tokens, &known), mode);
    let agree = plain.is_whole() && says_the_same(&plain.reading, &said.reading, mode);
    let (by, reading, mut other) = match (agree, plain.is_whole()) {
        (true, _) => (By::Both, plain.reading, None),
        // (a text that the grammar reads completely is plain English)
        (false, true) => (By::Grammar, plain.reading, Some(said.reading)),
        (false, false) => (By::Learned, said.reading, None),
    };
    let mut reading = reading;
    let lost = match by {
        By::Learned => take_out_guesses(&mut reading, &said.tokens),
        _ => Vec::new(),
    };
    conditions::set_right(&mut reading, &said.tokens);
    if mode == Mode::Edit {
        indefinite::set_right(&mut reading, &said.tokens);
    }
    let numbers = measures(&said.tokens);
    for reading in std::iter::once(&mut reading).chain(&mut other) {
        slots::set_right(reading, &said.tokens, &numbers);
    }
    let halted = halt::set_right(&mut reading, text, &said.tokens, mode);
    let unsure = match by {
        By::Learned => (0..reading.acts.len())
            .filter(|i| reading.acts[*i].confidence < UNSURE)
            .collect(),
        _ => Vec::new(),
    };
    let mended = said.tokens.iter().filter_map(|t| {
        t.typed.as_ref().map(|_| Mended {
            span: t.span,
            to: t.text.clone(),
        })
    });
    let mut missing = missing(text, &said.tokens, &reading, learned.speller());
    // (one reported word of it is enough)
    let is_named = |span: &TextSpan| {
        missing
            .iter()
            .any(|m| m.span.start < span.end && m.span.end > span.start)
    };
    let unnamed: Vec<Missing> = lost
        .into_iter()
        .flatten()
        .filter(|span| !is_named(span))
        .map(|span| Missing {
            span,
            words: span.of(text).to_owned(),
            why: Why::Unknown,
        })
        .collect();
    missing.extend(unnamed);
    missing.extend(halted);
    let bytes_left = TextSpan {
        start: said
            .left_out
            .first()
            .map_or(LONGEST.min(text.len()), |t| t.span.start),
        end: text.len(),
    };
    if !bytes_left.of(text).trim().is_empty() {
        missing.push(Missing {
            span: bytes_left,
            words: bytes_left.of(text).chars().take(40).collect(),
            why: Why::TooLong,
        });
    }
    Ok(CheckedReading {
        missing,
        mended: mended.collect(),
        by,
        unsure,
        other: other.filter(|o| !o.acts.is_empty()),
        reading,
    })
}

/// The tokens without words that no list knows, and without the articles before them: these words are reported, and the
/// plain rest is read.
fn without_unknown(tokens: &[Token], known: &dyn Fn(&Token) -> bool) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for t in tokens {
        let word = t.text.chars().count() > 2 && t.text.chars().all(char::is_alphabetic);
        if !word || known(t) {
            out.push(t.clone());
        } else if out
            .last()
            .is_some_and(|l| matches!(l.text.as_str(), "a" | "an" | "the" | "some"))
        {
            out.pop();
        }
    }
    out
}

/// True if two readings ask for the same, regardless of order and form.
fn says_the_same(a: &Reading, b: &Reading, mode: Mode) -> bool {
    notation::write(&canonical(a, mode)) == notation::write(&canonical(b, mode))
}

/// A reading from elsewhere, combined with the reading of this program's readers. If it has no clause on scenery, the
/// clauses that this program read are kept.
///
/// # Errors
///
/// If the bundled weights are damaged.
pub fn against(
    text: &str,
    mut reading: Reading,
    own: Option<&CheckedReading>,
    mode: Mode,
) -> Result<CheckedReading, WeightsError> {
    let learned = LearnedReader::bundled()?;
    // (clauses on scenery that the program read count as read)
    let said = own.map_or_else(
        || take(text, mode == Mode::Edit).said,
        |o| o.reading.background.clone(),
    );
    let mut rest = text.to_owned();
    for span in said.iter().filter_map(|s| s.span) {
        beside::blank(&mut rest, span);
    }
    let text = &rest;
    let tokens = tokens(text, Some(learned.speller()));
    if reading.background.is_empty() {
        reading.background = said;
    }
    let other = own
        .map(|h| h.reading.clone())
        .filter(|o| !o.acts.is_empty() && !says_the_same(o, &reading, mode));
    slots::set_right(&mut reading, &tokens, &measures(&tokens));
    let mut missing = missing(text, &tokens, &reading, learned.speller());
    // (a word that is in no list here may be one that the model knows, of another language say)
    missing.retain(|m| m.why != Why::Unknown || reading.is_empty());
    Ok(CheckedReading {
        missing,
        reading,
        by: By::Endpoint,
        other,
        unsure: Vec::new(),
        mended: own.map(|h| h.mended.clone()).unwrap_or_default(),
    })
}
