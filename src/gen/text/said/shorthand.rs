//! Edits in few words: "truck delete, cars stay", "bus and pickup out", "bus away, instead two motorcycles", "a third and a fourth
//! car".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::words::{first_noun, is, is_place, leads, led, number, text, trimmed};

/// "truck delete, cars stay": the verb first.
pub(super) fn verb_last(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // "bus and pickup out, please"
    // ("..., the red one stays" only says who is left)
    let stays = (0..tokens.len()).find(|k| {
        let link = tokens[*k].kind == TokenKind::Comma || text(&tokens[*k]) == "but";
        let rest = trimmed(&tokens[*k..]);
        let put = usize::from(is(rest.last(), &["put"]));
        let rest = &rest[..rest.len() - put];
        link && is(rest.first(), &["the", "both", "all"])
            && is(rest.last(), &["stay", "stays", "remain", "remains"])
            && talk.fits(&rest[..rest.len() - 1]) > 0
    });
    let body = trimmed(&tokens[..stays.unwrap_or(tokens.len())]);
    if let Some((last, nps)) = body.split_last()
        && is(Some(last), &["out", "away", "off", "gone"])
    {
        let list: Vec<&[Token]> = nps
            .split(|t| text(t) == "and" || t.kind == TokenKind::Comma)
            .collect();
        let named = list.len() > 1
            && list.iter().all(|np| {
                first_noun(np).is_some_and(|x| x.0 < 3 && x.1 == np.len())
                    && !np.iter().any(|t| HELPERS.contains(&text(t)))
                    && (np.len() == 1
                        || is(np.first(), &["the", "both", "all", "my"])
                        || super::super::coloured_ones::is_colour(&np[0]))
                    && talk.fits(np) > 0
            });
        if named {
            let mut out = led("remove", last, &[]);
            for (k, np) in list.iter().enumerate() {
                if k > 0 {
                    out.extend(led("and", last, &[]));
                }
                if !is(np.first(), &["the", "both", "all", "my"]) {
                    out.extend(led("the", last, &[]));
                }
                out.extend_from_slice(np);
            }
            return out;
        }
    }
    let mut out: Vec<Token> = Vec::new();
    let mut from = 0;
    let mut found = false;
    for i in 0..=tokens.len() {
        let link = tokens
            .get(i)
            .is_none_or(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]));
        if !link {
            continue;
        }
        let part = &tokens[from..i];
        let gone = is(part.last(), &["delete", "remove", "erase", "kill"]);
        let stays = is(part.last(), &["stay", "stays", "remain", "remains"]);
        let end = part
            .len()
            .saturating_sub(1 + usize::from(gone && part.len() > 2 && is(part.get(part.len() - 2), &["to"])));
        let np = &part[..end];
        let plain = first_noun(np).is_some_and(|x| x.0 < 4)
            && !np.iter().any(|t| {
                HELPERS.contains(&text(t)) || super::super::rephrase::is_verb(t) && !is(Some(t), &["box"])
            })
            && talk.fits(np) > 0;
        let the = if is(np.first(), &["the", "all", "both", "my", "every", "that"]) {
            ""
        } else {
            "the"
        };
        if gone && plain {
            out.extend(led(format!("remove {the}").trim(), &part[0], &[np]));
            found = true;
        } else if stays && plain && !the.is_empty() && found {
            out.extend(led("leave the", &part[0], &[np, &led("alone", &part[0], &[])]));
        } else {
            out.extend_from_slice(part);
        }
        out.extend(tokens.get(i).cloned());
        from = i + 1;
    }
    if found { out } else { tokens }
}

/// "a third and a fourth car": two more cars.
pub(super) fn ordinals_in_row(tokens: Vec<Token>) -> Vec<Token> {
    use super::super::foremost::ordinal;
    let found = (0..tokens.len()).find_map(|i| {
        let mut k = i;
        let mut many = 0;
        loop {
            is(tokens.get(k), &["a", "an"]).then_some(())?;
            ordinal(text(tokens.get(k + 1)?))?;
            many += 1;
            k += 2;
            let and = usize::from(tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma));
            let and = and + usize::from(is(tokens.get(k + and), &["and"]));
            if and == 0 {
                break;
            }
            k += and;
        }
        let (a, b) = first_noun(tokens.get(k..)?)?;
        (many > 1 && a < 3).then_some((i, many, k, k + b))
    });
    let Some((i, many, k, end)) = found else {
        return tokens;
    };
    let digit = Token {
        kind: TokenKind::Number(f64::from(many)),
        text: many.to_string(),
        span: tokens[i].span,
    };
    let mut np = tokens[k..end].to_vec();
    if let Some(last) = np.last_mut() {
        last.text = super::super::lexicon::plural(&last.text);
    }
    let more = led("more", &tokens[i], &[&np]);
    [&tokens[..i], &[digit], &more, &tokens[end..]].concat()
}

/// "turn her into a policeman with a second policeman next to him": and add one.
pub(super) fn became_with(tokens: Vec<Token>) -> Vec<Token> {
    let found = (3..tokens.len()).find(|k| {
        is(tokens.get(*k), &["with"])
            && is(tokens.get(k + 1), &["a", "an", "another", "two"])
            && tokens[..*k].iter().any(|t| {
                matches!(
                    text(t),
                    "into" | "become" | "becomes" | "replace" | "swap" | "turn" | "be" | "instead"
                )
            })
            && first_noun(&tokens[k + 1..]).is_some_and(|x| x.0 < 4 && is_place(&tokens[k + 1 + x.1..]))
            && (1..4).any(|n| super::words::noun_at(&tokens[k - n..*k]).is_some())
            && tokens[..*k]
                .iter()
                .rev()
                .take(5)
                .any(|t| matches!(text(t), "a" | "an"))
    });
    match found {
        Some(k) => [&tokens[..k], &led("and add", &tokens[k], &[&tokens[k + 1..]])].concat(),
        None => tokens,
    }
}

/// "two cars there instead": put there.
pub(super) fn there_instead(tokens: Vec<Token>) -> Vec<Token> {
    let fresh =
        is(tokens.first(), &["a", "an", "another"]) || tokens.first().is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(&tokens).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let n = leads(
        &tokens[b..],
        &[
            "there instead",
            "instead there",
            "in their place",
            "in its place",
            "in there instead",
            "in their stead",
        ],
    );
    match n.filter(|n| b + n == tokens.len()) {
        Some(_) => led(
            "put",
            &tokens[0],
            &[&tokens[..b], &led("in their place", &tokens[0], &[])],
        ),
        None => tokens,
    }
}

/// "bus away, instead two motorcycles in the same place": one for the other.
pub(super) fn out_and_in(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let gone = is(tokens.get(b), &["away", "out", "gone", "off"]);
    let Some(comma) = (b + 1..tokens.len().min(b + 4))
        .find(|k| tokens[*k].kind == TokenKind::Comma || is(tokens.get(*k), &["and"]))
    else {
        return tokens;
    };
    let verb =
        super::super::rephrase::is_verb(&tokens[0]) || tokens[..b].iter().any(|t| HELPERS.contains(&text(t)));
    if !gone || verb || talk.fits(&tokens[..b]) == 0 {
        return tokens;
    }
    let mut rest = trimmed(&tokens[comma + 1..]);
    // "cyclists off, mopeds on"
    if first_noun(rest).is_some_and(|x| x.0 == 0 && x.1 + 1 == rest.len()) && is(rest.last(), &["on", "in"]) {
        let all = if is(tokens.first(), &["the", "both", "all"]) {
            "replace"
        } else {
            "replace all the"
        };
        let with = led("with", &tokens[b], &[&rest[..rest.len() - 1]]);
        return led(all, &tokens[0], &[&tokens[..b], &with]);
    }
    let instead = is(rest.first(), &["instead"]);
    rest = trimmed(&rest[usize::from(instead)..]);
    rest = &rest[usize::from(is(rest.first(), &["a"]) && is(rest.get(1), &["new"]))..];
    let fresh =
        is(rest.first(), &["a", "an", "another", "new"]) || rest.first().is_some_and(|t| number(t).is_some());
    let Some((_, e)) = first_noun(rest).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let tail = trimmed(&rest[e..]);
    let same = super::predicate::in_place(tail).is_some_and(|p| p.0 == 0 && p.1 == tail.len())
        || is(tail.first(), &["instead", "there", "in"]) && tail.len() == 1;
    if !(same || instead && tail.is_empty()) {
        return tokens;
    }
    let lead = if is(tokens.first(), &["the", "both", "all", "that"]) {
        "replace"
    } else {
        "replace the"
    };
    let with = led("with", &tokens[b], &[&rest[..e]]);
    led(lead, &tokens[0], &[&tokens[..b], &with])
}
