//! Who is spared: "all the motor vehicles but the bus may disappear".

use super::super::tokens::Token;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_finite, leads, text};

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
