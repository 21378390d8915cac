//! Whose something is: "our bus" is the bus that is there, or a new one; "one of our vans" is a new one unless several are
//! there. "Our car" stays the ego vehicle.

use super::super::lexicon::{Sense, look_up};
use super::super::names::singular;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::some_of::removes;
use super::words::{first_noun, is, is_place, number, text, word};
use crate::scene::Class;

const WHOSE: &[&str] = &["our", "my", "your"];
/// Nouns that with "our" mean the ego vehicle.
const EGO: &[&str] = &[
    "car",
    "vehicle",
    "auto",
    "automobile",
    "ride",
    "ego",
    "host",
    "motor",
    "motorcar",
];
/// What makes the words a name of something else: "my truck driver", "our bus lane".
const GOES_ON: &[&str] = &[
    "lane", "lanes", "driver", "drivers", "stop", "side", "own", "s", "or",
];

/// A sentence in which nothing is owned.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !tokens.iter().any(|t| is(Some(t), WHOSE)) {
        return tokens;
    }
    rewritten(&tokens, |i, out| {
        one_of(&tokens, i, out, talk).or_else(|| owned(&tokens, i, out, talk))
    })
}

/// Where the words begin and end that name something owned, after "our".
fn np_at(tokens: &[Token]) -> Option<(usize, usize)> {
    let (a, b) = first_noun(tokens).filter(|x| x.0 < 5)?;
    let describes = |t: &Token| {
        t.kind != TokenKind::Comma
            && t.kind != TokenKind::Stop
            && !is_place(std::slice::from_ref(t))
            && !matches!(look_up(text(t)), Some(Sense::Place(..)))
            && !is(Some(t), &["of", "and", "own", "with", "lane"])
    };
    let whole = tokens[..a].iter().all(describes) && !is(tokens.get(b), GOES_ON);
    whole.then_some((a, b))
}

/// True if people are named: "our driver says" tells who speaks.
fn on_foot(noun: &[Token]) -> bool {
    let words = noun.iter().map(text).collect::<Vec<_>>().join(" ");
    matches!(look_up(&words), Some(Sense::Noun(n, _)) if n.classes.contains(&Class::Pedestrian))
}

/// "one of our vans", "two of our trucks".
fn one_of(tokens: &[Token], i: usize, out: &mut Vec<Token>, talk: &Talk<'_>) -> Option<usize> {
    let many = number(&tokens[i]).filter(|n| *n > 0)?;
    let of = is(tokens.get(i + 1), &["of"]) && is(tokens.get(i + 2), WHOSE);
    let from = of.then_some(i + 3)?;
    let (a, b) = np_at(&tokens[from..])?;
    let (a, b) = (from + a, from + b);
    let there = talk.fits(&tokens[a..b]);
    let by = is(out.last(), &["with", "for", "by", "into", "to", "as"]);
    let goes = removes(out.last());
    // ("add one of our taxis" brings one, whatever is there)
    let new = is(
        out.last(),
        &[
            "add",
            "insert",
            "include",
            "create",
            "draw",
            "show",
            "spawn",
            "introduce",
            "append",
        ],
    );
    let at = &tokens[i];
    if there as i64 > many && !by && !new {
        out.push(at.clone());
        out.extend(["of", "the"].map(|w| word(w, at)));
        out.extend_from_slice(&tokens[from..b]);
    } else if goes {
        out.push(word("the", at));
        one_or_more(&tokens[from..b], many, out);
    } else {
        out.push(if many == 1 { word("a", at) } else { at.clone() });
        one_or_more(&tokens[from..b], many, out);
    }
    Some(b)
}

/// The words of a noun phrase, in the singular for one.
fn one_or_more(np: &[Token], many: i64, out: &mut Vec<Token>) {
    let Some((last, before)) = np.split_last() else {
        return;
    };
    out.extend_from_slice(before);
    let one = if many == 1 {
        singular(text(last)).to_string()
    } else {
        text(last).to_string()
    };
    out.push(word(&one, last));
}

/// "our bus", "my two vans".
fn owned(tokens: &[Token], i: usize, out: &mut Vec<Token>, talk: &Talk<'_>) -> Option<usize> {
    is(tokens.get(i), WHOSE).then_some(())?;
    let from = i + 1;
    let (a, b) = np_at(&tokens[from..])?;
    let noun = &tokens[from + a..from + b];
    if noun.len() == 1 && is(noun.first(), EGO) || on_foot(noun) {
        return None;
    }
    let at = &tokens[i];
    let there = talk.fits(&tokens[from..from + b]) > 0;
    // (behind a bus that is not there is behind us)
    let beside = i > 0 && is_place(&tokens[i - 1..i])
        || is(
            out.last(),
            &[
                "of", "to", "behind", "before", "beside", "from", "than", "between", "near",
            ],
        );
    if there || removes(out.last()) {
        out.push(word("the", at));
    } else if beside {
        return None;
    } else if !matches!(look_up(text(noun.last()?)), Some(Sense::Noun(_, true)))
        && !tokens[from..from + a].iter().any(|t| number(t).is_some())
    {
        out.push(word("a", at));
    }
    Some(from)
}
