//! More and fewer of what is there: "people minus two", "one more of the people", "there used to be two buses, now there is none".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::words::{first_noun, is, leads, led, number, text, trimmed};

/// "people minus two, cyclists plus one".
pub(super) fn plus_minus(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut from = 0;
    let mut found = false;
    for i in 0..=tokens.len() {
        if tokens
            .get(i)
            .is_some_and(|t| t.kind != TokenKind::Comma && !is(Some(t), &["and"]))
        {
            continue;
        }
        let part = &tokens[from..i];
        let sign = part
            .iter()
            .position(|t| matches!(text(t), "minus" | "plus" | "less"));
        let sum = sign.filter(|k| {
            first_noun(&part[..*k]).is_some_and(|x| x.0 < 3 && x.1 == *k)
                && part.len() == k + 2
                && number(&part[k + 1]).is_some()
        });
        match sum {
            Some(k) => {
                found = true;
                let skip = usize::from(is(part.first(), &["the"]));
                let np = &part[skip..k];
                if text(&part[k]) == "plus" {
                    out.extend(led(
                        "add",
                        &part[0],
                        &[&part[k + 1..], &led("more", &part[0], &[np])],
                    ));
                } else {
                    out.extend(part[k + 1..].iter().cloned());
                    out.extend_from_slice(np);
                    out.extend(led("fewer", &part[0], &[]));
                }
            }
            None => out.extend_from_slice(part),
        }
        if let Some(link) = tokens.get(i) {
            let mut link = link.clone();
            // each sum is a command of its own
            if sum.is_some() && link.kind == TokenKind::Comma {
                link.text = "and".into();
                link.kind = TokenKind::Word;
            }
            out.push(link);
        }
        from = i + 1;
    }
    if found { out } else { tokens }
}

/// "there used to be two buses, now there is none".
pub(super) fn once_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there used to be",
            "there were once",
            "there was once",
            "there once was",
            "there once were",
            "there were",
            "there was",
            "we used to have",
        ],
    ) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let close = (n + b..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["but", "and"]))
        .unwrap_or(tokens.len());
    let np = &tokens[n + a..close];
    let denied = tokens[n..n + a]
        .iter()
        .any(|t| matches!(text(t), "no" | "not" | "never"));
    if denied || talk.fits(np) == 0 {
        return tokens;
    }
    let rest = trimmed(&tokens[close..]);
    let k = leads(
        rest,
        &[
            "now there is",
            "now there are",
            "there is now",
            "there are now",
            "now we have",
            "there is",
            "there are",
            "now",
        ],
    )
    .unwrap_or(0);
    let rest = trimmed(&rest[k..]);
    let rest = &rest[usize::from(is(rest.first(), &["only", "just"]))..];
    if is(rest.first(), &["none", "nothing"])
        || leads(rest, &["no longer any", "no more", "not any more"]).is_some()
    {
        return led("remove all the", &tokens[0], &[np]);
    }
    match rest
        .first()
        .filter(|t| number(t).is_some() && first_noun(rest).is_none())
    {
        Some(many) => led("keep exactly", &tokens[0], &[std::slice::from_ref(many), np]),
        None if rest.is_empty() => super::gifts::remark(np),
        None => tokens,
    }
}

/// The noun as it stands after the number.
fn of_number(np: &[Token], many: &Token) -> Vec<Token> {
    if number(many) == Some(1) {
        super::topics::singular_of(np)
    } else {
        np.to_vec()
    }
}

/// "one more of the people and one less of the cars".
pub(super) fn more_of_the(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let way = is(tokens.get(i + 1), &["more", "less", "fewer"]) && number(&tokens[i]).is_some();
        let of = tokens
            .get(i + 2..)
            .and_then(|t| leads(t, &["of the", "of those", "of these"]));
        let (n, b) = of.filter(|_| way).and_then(|n| {
            first_noun(&tokens[i + 2 + n..])
                .filter(|x| x.0 < 3)
                .map(|x| (n, x.1))
        })?;
        let np = &tokens[i + 2 + n..i + 2 + n + b];
        if is(tokens.get(i + 1), &["more"]) {
            let add = i == 0 || is(tokens.get(i - 1), &["and"]) || tokens[i - 1].kind == TokenKind::Comma;
            if add {
                out.extend(led("add", &tokens[i], &[]));
            }
            out.extend_from_slice(&tokens[i..i + 2]);
            out.extend(of_number(np, &tokens[i]));
        } else {
            out.push(tokens[i].clone());
            out.extend(of_number(np, &tokens[i]));
            out.extend(led("fewer", &tokens[i], &[]));
        }
        Some(i + 2 + n + b)
    })
}
