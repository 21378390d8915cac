//! Who is spared: "all the motor vehicles but the bus may disappear".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::Token;
use super::Piece;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, text};

/// The sentence without an exception, and the noun phrase that was excepted.
pub fn except(tokens: &[Token]) -> Option<(Vec<Token>, Vec<Token>)> {
    let all = tokens
        .iter()
        .position(|t| matches!(text(t), "all" | "every" | "each" | "any" | "both"))?;
    let (i, n) = find(
        &tokens[all..],
        &[
            "but not",
            "but",
            "except for",
            "except",
            "apart from",
            "save for",
            "save",
            "bar",
            "other than",
            "excluding",
            "with the exception of",
            "besides",
            "aside from",
        ],
    )
    .map(|(i, n)| (all + i, n))?;
    // "everything but the bus" and the like are numbers of their own
    let group = first_noun(&tokens[all..i]).filter(|x| x.0 < 5)?;
    let plain = is(
        tokens.get(all + group.0),
        &["everything", "everyone", "everybody", "objects", "things"],
    );
    let from = i + n;
    let definite = is(tokens.get(from), &["the", "my", "that", "those", "these"]);
    if plain || !definite || leads(&tokens[from..], &["the one", "the ones", "the following"]).is_some() {
        return None;
    }
    let (_, noun) = first_noun(&tokens[from..]).filter(|x| x.0 < 4)?;
    let end = (from + noun..tokens.len())
        .find(|k| {
            let t = &tokens[*k];
            t.kind != super::super::tokens::TokenKind::Word
                || HELPERS.contains(&text(t))
                || is_finite(text(t), true)
                || matches!(text(t), "and" | "with" | "by" | "into" | "to" | "onto")
        })
        .unwrap_or(tokens.len());
    let rest = [&tokens[..i], &tokens[end..]].concat();
    has_noun(&rest).then(|| (rest, tokens[from..end].to_vec()))
}

/// What nobody wants of a kind goes, where it was said.
pub(super) fn unwanted(inner: &[Token], first: &Token) -> Option<Vec<Piece>> {
    let any = is(
        inner.first(),
        &["any", "a", "an", "more", "some", "anybody", "anyone"],
    );
    let (a, b) = first_noun(inner).filter(|n| n.0 < 4)?;
    let many = matches!(look_up(text(&inner[b - 1])), Some(Sense::Noun(_, true)));
    let mut rest = &inner[b..];
    for late in ["any more", "anymore", "any longer", "at all", "no more", "now"] {
        let n = late.split(' ').count();
        if let Some(cut) = rest
            .len()
            .checked_sub(n)
            .filter(|k| find(&rest[*k..], &[late]).is_some())
        {
            rest = &rest[..cut];
        }
    }
    let told = rest.first().is_some_and(|t| {
        is_place(rest) || text(t).ends_with("ing") || text(t) == "parked" || text(t) == "to"
    });
    let verb = usize::from(is(rest.first(), &["to"]) && is(rest.get(1), &["be", "stand", "drive", "wait"]));
    (!rest.is_empty() && told && (any || a == 0 && many)).then(|| {
        let body = is(inner.get(a), &["anybody", "anyone"]);
        let np = if body {
            led("people", first, &[])
        } else {
            inner[a..b].to_vec()
        };
        vec![Piece::Plain(led(
            "remove all the",
            first,
            &[&np, &rest[2 * verb..]],
        ))]
    })
}
