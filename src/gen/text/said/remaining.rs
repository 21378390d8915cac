//! What shall be left, as a command: "let nothing remain but the truck", "not a single barrier should be left".

use super::super::tokens::{Token, TokenKind};
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
            | "us"
            | "me"
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
        .or_else(|| nothing_there(tokens))
}

/// "nobody is on foot any more": the people who walk go; before "on foot" is taken for a turn of speech. "Not a single
/// barrier", too, before "a single" is taken for a number.
pub(super) fn nobody_on_foot(tokens: Vec<Token>) -> Vec<Token> {
    let begin = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["nobody", "noone", "no"])
            && (*i == 0
                || tokens[i - 1].kind != TokenKind::Word
                || is(tokens.get(i - 1), &["and", "but", "so"]))
    });
    if let Some(i) = begin
        && let Some(n) = leads(
            &tokens[i..],
            &["nobody", "noone", "no one", "no pedestrian", "no person"],
        )
        && let Some((k, m)) = find(&tokens[i + n..], &["on foot"])
        && tokens[i + n..i + n + k].iter().all(stays)
    {
        let end = i + n + k + m;
        let late = leads(
            &tokens[end..],
            &["any more", "anymore", "any longer", "at all", "now"],
        )
        .unwrap_or(0);
        let all = led("remove all the pedestrians", &tokens[i], &[&tokens[end + late..]]);
        return [&tokens[..i], &all].concat();
    }
    none(&tokens).unwrap_or(tokens)
}

/// "nothing should be in the oncoming lane any more": all that is there goes.
fn nothing_there(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "nothing",
            "there should be nothing",
            "there must be nothing",
            "there shall be nothing",
            "there is nothing",
            "there is to be nothing",
            "i want nothing",
            "we want nothing",
            "i dont want anything",
            "we dont want anything",
            "there should not be anything",
            "there shouldnt be anything",
            "there must not be anything",
        ],
    )?;
    let said = tokens[n..]
        .iter()
        .take_while(|t| {
            is(
                Some(t),
                &[
                    "should", "must", "shall", "may", "is", "be", "to", "left", "standing", "parked",
                    "driving", "can", "will", "there", "seen", "visible", "found", "stand", "stands", "stay",
                    "stays", "remain", "remains", "stopped", "blocks", "moving",
                ],
            )
        })
        .count();
    let place = trimmed(&tokens[n + said..]);
    let late = [
        "any more",
        "anymore",
        "any longer",
        "at all",
        "now",
        "no more",
        "please",
    ];
    let end = find(place, &late).map_or(place.len(), |x| x.0);
    let place = trimmed(&place[..end]);
    let one = !place.iter().any(|t| t.kind != TokenKind::Word) && find(place, BUT).is_none();
    (one && super::words::is_place(place) && !has_noun(place))
        .then(|| led("remove all the objects", &tokens[0], &[place]))
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
    let of = &tokens[n..];
    let of = if of.first().is_some_and(|t| t.kind != TokenKind::Word) {
        &[]
    } else {
        trimmed(of)
    };
    let (_, b) = first_noun(of).filter(|x| x.0 < 3)?;
    // ("on the left" is a place)
    let side =
        (b + 1..of.len()).any(|k| is(of.get(k), &["left"]) && is(of.get(k - 1), &["the", "my", "our"]));
    (!side && of[b..].iter().all(stays)).then(|| led("remove all the", &tokens[0], &[&of[..b]]))
}
