//! What points back over a whole text: "the latter", "those two cars? Gone."

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::lists::HELPERS;
use super::words::{
    first_noun, has_noun, is, is_finite, is_place, leads, led, noun_at, number, text, trimmed, word,
};

/// A text in which these are said plainly.
pub fn plain(tokens: Vec<Token>, source: &str) -> Vec<Token> {
    asked_and_gone(latter(tokens), source)
}

/// "both us and the motorcycle; it now drives in front of the latter": of the motorcycle.
fn latter(tokens: Vec<Token>) -> Vec<Token> {
    if !tokens.iter().any(|t| is(Some(t), &["latter", "former"])) {
        return tokens;
    }
    rewritten(&tokens, |i, out| {
        let last = is(tokens.get(i + 1), &["latter"]);
        let points = is(tokens.get(i), &["the"]) && (last || is(tokens.get(i + 1), &["former"]));
        // ("the former lorry driver", "the latter two")
        let alone = tokens
            .get(i + 2)
            .is_none_or(|t| number(t).is_none() && noun_at(&tokens[i + 2..]).is_none());
        if !points || !alone {
            return None;
        }
        let mut nouns: Vec<(usize, usize)> = nouns(out);
        // ("and a cyclist next to the latter": not the cyclist himself)
        let own = nouns.last().is_some_and(|(a, b)| {
            let fresh = (a.saturating_sub(3)..*a)
                .any(|k| is(out.get(k), &["a", "an", "another"]) || number(&out[k]).is_some());
            fresh
                && *b < out.len()
                && out[*b..]
                    .iter()
                    .all(|t| t.kind == TokenKind::Word && text(t) != "and")
        });
        if own {
            nouns.pop();
        }
        let (a, b) = match last {
            true => *nouns.last()?,
            false => *nouns.get(nouns.len().checked_sub(2)?)?,
        };
        // ("the white car and the black car": the colour tells which)
        let from = (a.saturating_sub(3)..a)
            .rev()
            .take_while(|k| {
                !is(out.get(*k), &["the", "a", "an", "my", "our", "that"]) && out[*k].kind == TokenKind::Word
            })
            .filter(|k| super::super::coloured_ones::is_colour(&out[*k]))
            .last()
            .unwrap_or(a);
        let np = out[from..b].to_vec();
        out.extend(led("the", &tokens[i], &[]));
        out.extend(np.iter().map(|t| word(text(t), &tokens[i + 1])));
        Some(i + 2)
    })
}

/// All nouns in order.
fn nouns(tokens: &[Token]) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut from = 0;
    while let Some((a, b)) = tokens.get(from..).and_then(first_noun) {
        out.push((from + a, from + b));
        from += b;
    }
    out
}

/// "those two cars in the left lane? Gone.": they go.
fn asked_and_gone(tokens: Vec<Token>, source: &str) -> Vec<Token> {
    const GONE: &[&str] = &[
        "gone",
        "all gone",
        "both gone",
        "out",
        "away",
        "out with it",
        "out with them",
        "away with it",
        "away with them",
        "history",
        "not needed",
        "not needed any more",
        "no longer needed",
        "no longer there",
        "no longer wanted",
        "not wanted",
        "not there",
        "not there any more",
        "superfluous",
        "unnecessary",
        "not necessary",
        "scrap it",
        "scrap them",
        "lose it",
        "lose them",
        "drop it",
        "drop them",
    ];
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut start = 0;
    let mut i = 0;
    while i < tokens.len() {
        let asked = tokens[i].kind == TokenKind::Stop
            && source.get(tokens[i].span.start..tokens[i].span.end) == Some("?");
        let np = &tokens[start.min(i)..i];
        let lead = leads(
            np,
            &[
                "and",
                "but",
                "also",
                "and what about",
                "what about",
                "and how about",
                "as for",
            ],
        );
        let np = &np[lead.unwrap_or(0)..];
        let known = is(
            np.first(),
            &[
                "the", "those", "these", "that", "this", "both", "all", "my", "our",
            ],
        );
        let bare = asked
            && known
            && np.len() < 14
            && first_noun(np).is_some_and(|x| x.0 < 5)
            && !np
                .iter()
                .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false) && !text(t).ends_with("ed"));
        let gone = bare
            .then(|| leads(&tokens[i + 1..], GONE))
            .flatten()
            .filter(|n| tokens.get(i + 1 + n).is_none_or(|t| t.kind != TokenKind::Word));
        let said = match gone {
            Some(n) => Some((led("remove", np.first().unwrap_or(&tokens[i]), &[np]), i + 1 + n)),
            None if bare => placed(&tokens, i + 1, np),
            None if asked => no_other(&tokens, i + 1, np),
            None => None,
        };
        if let Some((said, next)) = said {
            out.truncate(out.len() - (i - start));
            out.extend(said);
            i = next;
            start = i + 1;
            continue;
        }
        if tokens[i].kind == TokenKind::Stop {
            start = i + 1;
        }
        out.push(tokens[i].clone());
        i += 1;
    }
    out
}

/// "the two pedestrians? On the left sidewalk, please.": they should be there.
fn placed(tokens: &[Token], from: usize, np: &[Token]) -> Option<(Vec<Token>, usize)> {
    let end = (from..tokens.len())
        .find(|k| tokens[*k].kind == TokenKind::Stop)
        .unwrap_or(tokens.len());
    let place = trimmed(&tokens[from..end]);
    let only = is_place(place)
        && !is(
            place.first(),
            &[
                "out", "off", "away", "left", "right", "back", "over", "up", "down",
            ],
        )
        && place.len() > 1
        && !has_noun(place)
        && !place
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || t.kind == TokenKind::Comma);
    only.then(|| ([np, &led("should be", &tokens[from], &[place])].concat(), end))
}

/// "a bus in front of me? No. A truck.": the bus is a truck.
fn no_other(tokens: &[Token], from: usize, np: &[Token]) -> Option<(Vec<Token>, usize)> {
    let (_, b) = first_noun(np).filter(|x| x.0 < 4)?;
    let whole = is(np.first(), &["a", "an", "the"])
        && (b == np.len() || is_place(&np[b..]) && !has_noun(&np[b..]))
        && !np.iter().any(|t| HELPERS.contains(&text(t)));
    let no = leads(&tokens[from..], &["no", "nope", "not at all", "wrong"])?;
    let mut k = from + no;
    k += usize::from(tokens.get(k).is_some_and(|t| t.kind != TokenKind::Word));
    let end = (k..tokens.len())
        .find(|k| tokens[*k].kind == TokenKind::Stop)
        .unwrap_or(tokens.len());
    let new = trimmed(tokens.get(k..end)?);
    let fresh = is(new.first(), &["a", "an"]) && first_noun(new).is_some_and(|x| x.0 < 4 && x.1 == new.len());
    (whole && fresh && k > from + no).then(|| {
        let at = &tokens[from];
        (led("replace the", at, &[&np[1..], &led("with", at, &[new])]), end)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn pointers() {
        let said = |t: &str| {
            let list: Vec<String> = plain(tokens(t), t).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("the van has overtaken the bus; it is ahead of the latter"),
            "the van has overtaken the bus . it is ahead of the bus"
        );
        assert_eq!(
            said("those two cars in the left lane? Gone."),
            "remove those two cars in the left lane ."
        );
        assert_eq!(said("why is the car there? Out."), "why is the car there . out .");
        assert_eq!(
            said("A bus in front of me? No. A truck."),
            "replace the bus in front of me with a truck ."
        );
        assert_eq!(
            said("The two pedestrians? On the left sidewalk, please."),
            "the two pedestrians should be on the left sidewalk ."
        );
    }
}
