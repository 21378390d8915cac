//! What a sentence is wrapped in: "it would be nice if", "I want", "could", "according to the witness", "let".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::lists::{HELPERS, NEGATED, OPENERS, PRONOUNS, SUBORDINATE, WISHING};
use super::words::{begins, find, has_noun, is, leads, longest, text};

/// How what is inside was said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mood {
    /// Someone makes or wants it so: base forms are verbs, a place alone is where it shall be.
    pub caused: bool,
    /// It is denied: "I don't want the car to come towards me".
    pub denied: bool,
    /// Anything was taken off.
    pub framed: bool,
}

/// A wish of the speaker before its object: "I want", "we'd rather have".
fn wish(tokens: &[Token]) -> Option<usize> {
    if !is(tokens.first(), &["i", "we", "id", "wed", "you", "one", "youd"]) {
        return None;
    }
    let mut k = 1;
    let mut wishes = false;
    while let Some(t) = tokens.get(k) {
        match text(t) {
            "want" | "need" | "like" | "prefer" | "wish" | "love" | "require" | "expect" | "order"
            | "ask" | "hope" | "demand" | "wanted" => wishes = true,
            "rather"
                if matches!(text(&tokens[0]), "id" | "wed" | "youd")
                    || is(tokens.get(k - 1), &["would", "should", "had"]) =>
            {
                wishes = true;
            }
            "would" | "should" | "do" | "really" | "much" | "just" | "also" | "now" | "still"
            | "definitely" | "d" | "had" | "only" | "urgently" | "for" | "please" => {}
            "see" | "have" | "to" | "get" if wishes => {}
            // "I'd have every child look away" ("I'd have removed it" asks for nothing)
            "have"
                if (matches!(text(&tokens[0]), "id" | "wed" | "youd")
                    || is(tokens.get(k - 1), &["would"]))
                    && is(
                        tokens.get(k + 1),
                        &["the", "every", "each", "all", "both", "a", "an", "that"],
                    ) =>
            {
                wishes = true;
            }
            _ => break,
        }
        k += 1;
    }
    wishes.then_some(k)
}

/// True if the tokens name the speaker, a wish and nothing that a scene holds.
fn only_wishes(tokens: &[Token]) -> bool {
    !has_noun(tokens) && tokens.iter().any(|t| WISHING.contains(&text(t)))
}

/// One past "it would be nice if", "would it be possible that", "I'd be grateful if you", "what if".
fn conditional(tokens: &[Token]) -> Option<usize> {
    let k = (1..tokens.len().min(12)).find(|k| is(tokens.get(*k), &["if", "that", "when"]))?;
    if !only_wishes(&tokens[..k]) || tokens[..k].iter().any(|t| t.kind == TokenKind::Stop) {
        return None;
    }
    // "I want that car gone": "that" belongs to the car
    let points = text(&tokens[k]) == "that"
        && super::words::noun_at(&tokens[k + 1..]).is_some()
        && !is(
            tokens.get(k - 1),
            &[
                "be",
                "sure",
                "possible",
                "important",
                "so",
                "is",
                "was",
                "care",
                "ensure",
                "to",
                "it",
            ],
        );
    if points {
        return None;
    }
    let mut n = k + 1;
    if is(tokens.get(n), &["you", "we"]) {
        n += 1;
        while is(
            tokens.get(n),
            &[
                "could", "can", "would", "will", "might", "please", "just", "were", "to",
            ],
        ) {
            n += 1;
        }
    }
    Some(n)
}

/// One past a clause that only says when or why: "by the time the officers arrived,".
fn subordinate(tokens: &[Token]) -> Option<usize> {
    // "instead of standing, the bus should drive"
    if leads(tokens, &["instead of", "rather than"]).is_some()
        && let Some(comma) = tokens.iter().position(|t| t.kind == TokenKind::Comma)
        && !has_noun(&tokens[..comma])
        && tokens.len() > comma + 3
    {
        return Some(comma + 1);
    }
    leads(tokens, &SUBORDINATE)?;
    let comma = tokens.iter().position(|t| t.kind == TokenKind::Comma)?;
    let rest = &tokens[comma + 1..];
    let speaks = has_noun(rest) || is(rest.first(), &PRONOUNS) || is(rest.first(), &["i", "we", "there"]);
    // "as the bus, ..." and lists go on; a clause has a verb
    let verb = tokens[1..comma]
        .iter()
        .any(|t| super::words::is_finite(text(t), true) || HELPERS.contains(&text(t)));
    (speaks && verb && rest.len() > 2).then_some(comma + 1)
}

/// "according to the second statement", "as per the report,".
fn source(tokens: &[Token]) -> Option<usize> {
    let n = leads(
        tokens,
        &["according to", "as per", "as stated by", "as reported by", "per"],
    )?;
    let noun = tokens.iter().skip(n).position(|t| {
        matches!(
            text(t),
            "statement"
                | "statements"
                | "report"
                | "reports"
                | "witness"
                | "witnesses"
                | "log"
                | "protocol"
                | "notes"
                | "story"
                | "account"
                | "plan"
                | "sketch"
                | "driver"
                | "caller"
                | "record"
                | "records"
                | "script"
                | "file"
                | "video"
                | "footage"
                | "map"
                | "police"
                | "officer"
                | "evidence"
                | "testimony"
                | "version"
                | "him"
                | "her"
        )
    })?;
    let mut end = n + noun + 1;
    if tokens.get(end).is_some_and(|t| t.kind == TokenKind::Comma) {
        end += 1;
    }
    Some(end)
}

/// A short lead before a comma that names nothing: "in my opinion,", "to make it harder,".
fn lead(tokens: &[Token]) -> Option<usize> {
    let comma = tokens
        .iter()
        .take(7)
        .position(|t| t.kind == TokenKind::Comma || text(t) == ":")?;
    if comma == 0 {
        return None;
    }
    let plain = (0..comma).all(|i| {
        !matches!(
            longest(&tokens[i..]).map(|x| x.0),
            Some(
                Sense::Noun(..)
                    | Sense::Weather(_)
                    | Sense::Time(_)
                    | Sense::Place(..)
                    | Sense::Count(_)
                    | Sense::State(..)
                    | Sense::RoadKind(..)
                    | Sense::Verb(_)
                    | Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::Density(_)
                    | Sense::Environment(_)
                    | Sense::Not
                    | Sense::Nobody
                    | Sense::Pronoun
            )
        ) && !matches!(tokens[i].kind, TokenKind::Number(_))
    });
    let verb = super::super::rephrase::is_verb(&tokens[0])
        || super::words::is_finite(text(&tokens[0]), true)
        || tokens[..comma].iter().any(|t| HELPERS.contains(&text(t)));
    (plain && !verb && tokens.len() > comma + 3).then_some(comma + 1)
}

/// Takes off what the sentence is wrapped in.
pub fn unwrapped(mut tokens: &[Token]) -> (&[Token], Mood) {
    let mut mood = Mood::default();
    for _ in 0..8 {
        tokens = super::words::trimmed(tokens);
        let before = tokens.len();
        // ("next to the bus" is a place)
        let place = begins(tokens, "next to").is_some();
        if let Some(n) = leads(tokens, &OPENERS).filter(|n| *n < tokens.len() && !place) {
            tokens = &tokens[n..];
            mood.framed = true;
        } else if let Some(n) = source(tokens)
            .or_else(|| conditional(tokens))
            .or_else(|| subordinate(tokens))
            .filter(|n| *n < tokens.len())
        {
            tokens = &tokens[n..];
            mood.framed = true;
        } else if begins(tokens, "what if").is_some() {
            tokens = &tokens[2..];
            mood.framed = true;
        } else if let Some(n) = denial(tokens) {
            tokens = &tokens[n..];
            mood = Mood {
                caused: true,
                denied: true,
                framed: true,
            };
        } else if let Some(n) = wish(tokens).filter(|n| *n < tokens.len()) {
            // what is wished for, or what is to be done
            tokens = &tokens[n..];
            mood.caused = true;
            mood.framed = true;
        } else if let Some(n) = lead(tokens) {
            tokens = &tokens[n..];
        } else if let Some(n) = causative(tokens) {
            tokens = &tokens[n..];
            mood.caused = true;
            mood.framed = true;
        }
        if tokens.len() == before {
            break;
        }
    }
    (tokens, mood)
}

/// "I don't want", before an object and what it does.
fn denial(tokens: &[Token]) -> Option<usize> {
    if !is(tokens.first(), &["i", "we"]) {
        return None;
    }
    if begins(&tokens[1..], "no longer").is_some()
        && is(tokens.get(3), &["want", "need", "require", "like", "have"])
    {
        return Some(4);
    }
    let not = (1..3).find(|k| is(tokens.get(*k), &NEGATED))?;
    let verb = (not + 1..not + 3).find(|k| is(tokens.get(*k), &["want", "like", "need", "wish", "think"]))?;
    Some(verb + 1)
}

/// "let", "have", "could", before one that is known: one past it.
fn causative(tokens: &[Token]) -> Option<usize> {
    let first = tokens.first()?;
    let asks = matches!(
        text(first),
        "could" | "can" | "should" | "would" | "must" | "may" | "might" | "shall"
    );
    let makes = matches!(
        text(first),
        "let"
            | "have"
            | "make"
            | "get"
            | "ask"
            | "tell"
            | "order"
            | "see"
            | "allow"
            | "cause"
            | "instruct"
            | "want"
            | "need"
    );
    let known = tokens.get(1).is_some_and(|t| {
        matches!(
            text(t),
            "the"
                | "my"
                | "that"
                | "this"
                | "those"
                | "these"
                | "both"
                | "all"
                | "it"
                | "him"
                | "her"
                | "them"
                | "he"
                | "she"
                | "they"
                | "our"
                | "one"
                | "every"
                | "each"
        ) || matches!(look_up(text(t)), Some(Sense::Noun(..)))
            || super::words::number(t).is_some()
                && is(tokens.get(2), &["of"])
                && is(tokens.get(3), &["the", "my", "these", "those", "our"])
    });
    if !known {
        return None;
    }
    if asks {
        return Some(1);
    }
    // a verb or a place must follow, or it is another "make"
    let end = super::words::first_noun(&tokens[1..]).map_or(2, |n| n.1 + 1);
    let made = tokens.get(end..).is_some_and(|rest| {
        (0..rest.len().min(8)).any(|i| {
            super::words::is_finite(text(&rest[i]), true)
                || is(rest.get(i), &["to", "be", "trade", "swap", "change"])
        })
    });
    let rid = find(
        tokens,
        &[
            "rid of",
            "out of",
            "into a",
            "into an",
            "a bit",
            "as it is",
            "as they are",
        ],
    )
    .is_some();
    (makes && made && !rid).then_some(1)
}
