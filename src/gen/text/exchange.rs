//! One thing for another: "a tram instead of the truck", "where the truck is, put a digger".

use super::lexicon::{Sense, look_up};
use super::said::words::{has_noun, led as command, number, text};
use super::tokens::{Token, TokenKind};
use super::wishes::SPEAKER;

const INSTEAD: &[&[&str]] = &[
    &["instead", "of"],
    &["in", "place", "of"],
    &["in", "the", "place", "of"],
    &["in", "lieu", "of"],
    &["rather", "than"],
    &["in", "exchange", "for"],
    &["as", "a", "replacement", "for"],
    &["as", "a", "substitute", "for"],
    &["as", "replacement", "for"],
    &["to", "replace"],
    &["replacing"],
];
/// What else begins a sentence that brings something in.
const BRINGS: &[&[&str]] = &[
    &["put"],
    &["place"],
    &["add"],
    &["insert"],
    &["show"],
    &["give", "me"],
    &["get", "me"],
    &["bring", "me"],
    &["fetch", "me"],
    &["find", "me"],
    &["fetch"],
    &["have"],
    &["use"],
    &["show", "me"],
    &["there", "should", "be"],
    &["there", "must", "be"],
    &["there", "shall", "be"],
    &["let", "there", "be"],
    &["there", "is"],
    &["there", "are"],
    &["make", "it"],
    &["make", "that"],
    &["we", "should", "have"],
    &["we", "should", "see"],
    &["drop"],
    &["set"],
    &["stick"],
];

pub fn begins_with(tokens: &[Token], words: &[&str]) -> bool {
    tokens.len() >= words.len() && tokens.iter().zip(words).all(|(t, w)| text(t) == *w)
}

pub fn is_noun(t: &Token) -> bool {
    matches!(look_up(text(t)), Some(Sense::Noun(..)))
}

fn by(at: &Token) -> Token {
    command("with", at, &[]).remove(0)
}

fn unwished(tokens: &[Token]) -> &[Token] {
    let skip = SPEAKER
        .iter()
        .chain(BRINGS)
        .filter(|w| begins_with(tokens, w))
        .map(|w| w.len())
        .max();
    &tokens[skip.unwrap_or(0).min(tokens.len())..]
}

/// Cuts small words and commas off both ends.
pub fn trimmed(mut tokens: &[Token]) -> &[Token] {
    let small = |t: &Token| {
        t.kind == TokenKind::Comma
            || matches!(
                text(t),
                "and" | "then" | "but" | "please" | "instead" | "now" | "so" | "there" | "also"
            )
    };
    while let Some((first, rest)) = tokens.split_first()
        && small(first)
        && text(first) != "there"
    {
        tokens = rest;
    }
    while let Some((last, rest)) = tokens.split_last()
        && small(last)
    {
        tokens = rest;
    }
    tokens
}

/// One thing for another: "a tram instead of the truck", "where the truck is, put a digger".
pub fn exchanged(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    let replace = |old: &[Token], new: &[Token]| {
        let (old, new) = (trimmed(old), trimmed(unwished(trimmed(new))));
        let both = has_noun(old) && has_noun(new);
        let fresh = new
            .first()
            .is_some_and(|t| matches!(text(t), "a" | "an" | "another") || number(t).is_some() || is_noun(t));
        (both && fresh).then(|| command("replace", first, &[old, &[by(first)], new]))
    };
    if matches!(text(first), "substitute" | "swap")
        && clause.get(1).is_some_and(|t| {
            let bare = text(first) == "substitute"
                && is_noun(t)
                && clause.windows(2).any(|w| {
                    text(&w[0]) == "for" && matches!(text(&w[1]), "the" | "all" | "every" | "both" | "those")
                });
            matches!(text(t), "a" | "an" | "in") || number(t).is_some() && text(t) != "both" || bare
        })
    {
        let k = clause.iter().position(|t| text(t) == "for")?;
        let new = if text(&clause[1]) == "in" {
            &clause[2..k.max(2)]
        } else {
            &clause[1..k]
        };
        return replace(&clause[k + 1..], new);
    }
    if text(first) == "where" {
        let is = clause.iter().position(|t| {
            matches!(
                text(t),
                "is" | "are" | "was" | "were" | "stands" | "stood" | "stand" | "sits" | "used" | "waits"
            )
        })?;
        let mut rest = &clause[is + 1..];
        while rest.first().is_some_and(|t| {
            !matches!(
                text(t),
                "a" | "an" | "i" | "id" | "we" | "put" | "place" | "there" | "add" | "show"
            ) && number(t).is_none()
        }) {
            rest = &rest[1..];
        }
        return replace(&clause[1..is], rest);
    }
    if let Some(k) = clause.iter().position(|t| text(t) == "where").filter(|k| *k > 1) {
        let is = clause[k..].iter().position(|t| {
            matches!(
                text(t),
                "is" | "are" | "was" | "were" | "stands" | "stood" | "stand" | "sits" | "used" | "now"
            )
        })? + k;
        return replace(&clause[k + 1..is], &clause[..k]);
    }
    let (k, n) = (0..clause.len()).find_map(|k| {
        INSTEAD
            .iter()
            .find(|w| begins_with(&clause[k..], w))
            .map(|w| (k, w.len()))
    })?;
    let old = &clause[k + n..];
    if k == 0 {
        // "instead of the truck(,) I'd like a bus"
        let noun = old.iter().position(is_noun)?;
        let cut = (noun + 1..old.len()).find(|i| {
            old[*i].kind == TokenKind::Comma
                || SPEAKER.iter().chain(BRINGS).any(|w| begins_with(&old[*i..], w))
                || matches!(text(&old[*i]), "a" | "an")
                || number(&old[*i]).is_some()
        })?;
        return replace(&old[..cut], &old[cut..]);
    }
    let definite = old.first().is_some_and(|t| {
        matches!(
            text(t),
            "the" | "that" | "this" | "my" | "both" | "all" | "every" | "one" | "those" | "these"
        )
    });
    let new = trimmed(unwished(trimmed(&clause[..k])));
    let moves = new
        .first()
        .is_some_and(|t| matches!(text(t), "the" | "move" | "both" | "all"));
    if !definite || moves {
        return None;
    }
    replace(old, new)
}
