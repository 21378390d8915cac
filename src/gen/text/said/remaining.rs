//! What shall be left, as a command: "let nothing remain but the truck", "not a single barrier should be left".

use super::super::tokens::Token;
use super::words::{find, first_noun, has_noun, is, leads, led, text, trimmed};

const NOTHING: &[&str] = &[
    "let nothing",
    "leave nothing",
    "keep nothing",
    "have nothing",
    "there should be nothing",
    "there must be nothing",
    "there shall be nothing",
    "i want nothing",
    "i want to see nothing",
    "nothing",
    "let nobody",
    "leave nobody",
    "nobody",
];
const BUT: &[&str] = &[
    "but for",
    "but",
    "except for",
    "except",
    "apart from",
    "other than",
    "save for",
    "save",
    "besides",
    "aside from",
    "bar",
];
const NONE: &[&str] = &[
    "not a single",
    "not one single",
    "not one",
    "not any",
    "no single",
    "no",
    "none of the",
    "none of these",
    "none of those",
    "there should be not a single",
    "there should not be a single",
    "there shouldnt be a single",
    "there should not be any",
    "there shouldnt be any",
    "there must not be a single",
    "there must not be any",
    "there mustnt be any",
    "i do not want to see any",
    "i dont want to see any",
    "i do not want to see a single",
    "i dont want to see a single",
    "we do not want to see any",
    "we dont want to see any",
    "i do not want any",
    "i dont want any",
    "we do not want any",
    "we dont want any",
    "i want no",
    "we want no",
    "i want to see no",
];

/// Words that say of something only that it is still there.
fn stays(t: &Token) -> bool {
    matches!(
        text(t),
        "should"
            | "shall"
            | "must"
            | "may"
            | "can"
            | "will"
            | "to"
            | "is"
            | "are"
            | "be"
            | "being"
            | "left"
            | "remain"
            | "remains"
            | "remaining"
            | "stay"
            | "stays"
            | "staying"
            | "standing"
            | "there"
            | "here"
            | "around"
            | "behind"
            | "over"
            | "in"
            | "on"
            | "the"
            | "this"
            | "scene"
            | "picture"
            | "survive"
            | "survives"
            | "exist"
            | "exists"
            | "at"
            | "all"
            | "any"
            | "more"
            | "anymore"
            | "longer"
            | "please"
            | "now"
    )
}

/// The sentence as a command, if it says what shall be left.
pub(super) fn plain(tokens: &[Token]) -> Option<Vec<Token>> {
    nothing_but(tokens)
        .or_else(|| alone(tokens))
        .or_else(|| none(tokens))
}

/// "leave nothing but the truck", "nothing should be left except for the truck".
fn nothing_but(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, NOTHING)?;
    let (i, e) = find(&tokens[n..], BUT)?;
    let kept = trimmed(&tokens[n + i + e..]);
    let end = kept.iter().rposition(|t| !stays(t))? + 1;
    let only_said = tokens[n..n + i].iter().all(stays);
    (only_said && has_noun(&kept[..end])).then(|| led("keep only", &tokens[0], &[&kept[..end]]))
}

/// "the truck alone stays".
fn alone(tokens: &[Token]) -> Option<Vec<Token>> {
    let alone = tokens.iter().position(|t| text(t) == "alone")?;
    let rest = &tokens[alone + 1..];
    let definite = is(tokens.first(), &["the", "that", "those", "these", "my"]);
    let (_, b) = first_noun(&tokens[..alone])?;
    (definite && b == alone && !rest.is_empty() && rest.iter().all(stays))
        .then(|| led("keep only", &tokens[0], &[&tokens[..alone]]))
}

/// "not a single barrier should be left", "no oncoming traffic": all of them go.
fn none(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, NONE)?;
    let of = trimmed(&tokens[n..]);
    let (_, b) = first_noun(of).filter(|x| x.0 < 3)?;
    of[b..]
        .iter()
        .all(stays)
        .then(|| led("remove all the", &tokens[0], &[&of[..b]]))
}
