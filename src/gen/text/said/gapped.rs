//! A verb that holds for what follows, too: "make the bus a lorry, the motorcycle a car", "the second car should be a van, and the
//! third one a bus".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::lists::HELPERS;
use super::topics::singular_of;
use super::words::{find, first_noun, is, is_place, led, number, text};

/// "make the bus a lorry, the motorcycle a car": make each.
pub(super) fn make_each(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = make_others(let_each(tokens));
    if !is(tokens.first(), &["make"]) || !is(tokens.get(1), &["the", "both", "all", "that"]) {
        return tokens;
    }
    let mut out: Vec<Token> = Vec::new();
    let mut made = false;
    for i in 0..tokens.len() {
        out.push(tokens[i].clone());
        let link = tokens[i].kind == TokenKind::Comma || is(tokens.get(i), &["and"]);
        let next = tokens.get(i + 1..).unwrap_or(&[]);
        let it = is(next.first(), &["it"])
            && next
                .get(1)
                .is_some_and(|t| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_))));
        let another = is(next.first(), &["the", "that"])
            && first_noun(next).is_some_and(|x| {
                x.0 < 4
                    && is(next.get(x.1), &["a", "an"])
                    && first_noun(&next[x.1..]).is_some_and(|y| y.0 < 3)
            });
        if link && (another || it && made) {
            made |= another;
            if tokens[i].kind == TokenKind::Comma {
                out.extend(led("and", &tokens[i], &[]));
            }
            out.extend(led("make", &tokens[i], &[]));
        }
    }
    out
}

/// "make both pedestrians cyclists", "make the bus ahead of us two cars": the one is replaced.
fn make_others(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make"])
        && is(
            tokens.get(1),
            &["the", "both", "all", "those", "these", "that", "my"],
        );
    let Some((a, b)) = first_noun(&tokens).filter(|x| made && x.0 < 5) else {
        return tokens;
    };
    let end = tokens.len()
        - tokens
            .iter()
            .rev()
            .take_while(|t| t.kind != TokenKind::Word || is(Some(t), &["please", "instead", "now"]))
            .count();
    let whole = |k: usize, at: usize| first_noun(&tokens[k..]).is_some_and(|x| x.0 == at && k + x.1 == end);
    let many = |k: usize| matches!(look_up(text(&tokens[k])), Some(Sense::Noun(_, true)));
    // (nouns that stand together are read as one)
    let b = (a + 1..b).find(|k| many(k - 1) && whole(*k, 0)).unwrap_or(b);
    let placed =
        |k: usize| k == b || is_place(&tokens[b..]) && is(tokens.get(k - 1), &["me", "us", "left", "right"]);
    let found = (b..end).find(|k| {
        let counted = number(&tokens[*k]).is_some_and(|n| n > 1) && whole(*k, 1);
        placed(*k) && (counted || many(*k) && whole(*k, 0) && many(b - 1))
    });
    match found {
        Some(k) => {
            let with = led("with", &tokens[k], &[&tokens[k..]]);
            led("replace", &tokens[0], &[&tokens[1..k], &with])
        }
        None => tokens,
    }
}

/// "let the blue car be a bus and the red one a motorcycle": make each.
fn let_each(tokens: Vec<Token>) -> Vec<Token> {
    let known = is(tokens.first(), &["let", "have"]) && is(tokens.get(1), &["the", "that"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| known && x.0 < 5) else {
        return tokens;
    };
    let be = (b..tokens.len().min(b + 6))
        .find(|k| is(tokens.get(*k), &["be", "become"]) && is(tokens.get(k + 1), &["a", "an"]));
    let Some(be) = be.filter(|be| *be == b || is_place(&tokens[b..])) else {
        return tokens;
    };
    // (the other's place may stand before what it becomes)
    let another = (be + 2..tokens.len()).find_map(|k| {
        let link = is(tokens.get(k), &["and"]) || tokens[k].kind == super::super::tokens::TokenKind::Comma;
        let the = k + 1 + usize::from(is(tokens.get(k + 1), &["and"]));
        (link && is(tokens.get(the), &["the", "that"])).then_some(())?;
        let next = &tokens[the..];
        let (_, b) = first_noun(next).filter(|x| x.0 < 4)?;
        let a = (b..next.len().min(b + 6)).find(|j| is(next.get(*j), &["a", "an"]))?;
        let told = a == b || is_place(&next[b..]) && !is_place(&next[a - 1..a]);
        (told && first_noun(&next[a..]).is_some_and(|x| x.0 < 4)).then_some((k, the))
    });
    match another {
        Some((k, the)) => {
            let first = led("make", &tokens[0], &[&tokens[1..be], &tokens[be + 1..k]]);
            [&first, &led("and make", &tokens[k], &[&tokens[the..]])[..]].concat()
        }
        None => tokens,
    }
}

/// "the second car should be a van, and the third one a bus": the verb again.
pub(super) fn same_verb(tokens: Vec<Token>) -> Vec<Token> {
    const VERBS: &[&str] = &[
        "should be",
        "should become",
        "becomes",
        "become",
        "should turn into",
        "turns into",
        "must be",
        "shall be",
        "is to be",
        "ought to be",
        "has to be",
        "should be replaced by",
        "should be replaced with",
        "is replaced by",
        "is replaced with",
        "should change into",
        "changes into",
        "is now",
        "can be",
        "could be",
    ];
    let Some((v, n)) = find(&tokens, VERBS).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[..v]) else {
        return tokens;
    };
    let second = (v + n + 1..tokens.len()).find_map(|k| {
        (is(tokens.get(k), &["and"]) || tokens[k].kind == TokenKind::Comma).then_some(())?;
        let the = k + 1 + usize::from(is(tokens.get(k + 1), &["and"]));
        is(tokens.get(the), &["the", "that"]).then_some(())?;
        let places = is_place(&tokens[v + n..]);
        let fresh = (the + 2..tokens.len().min(the + 6)).find(|j| {
            is(tokens.get(*j), &["a", "an"])
                || places && is_place(&tokens[*j..]) && super::words::noun_at(&tokens[j - 1..*j]).is_some()
        })?;
        let placed = is_place(&tokens[fresh..]);
        let who = &tokens[the..fresh];
        let plain = who.iter().all(|t| {
            t.kind == TokenKind::Word
                && !HELPERS.contains(&text(t))
                && !super::words::is_finite(text(t), false)
        });
        let verb_after = tokens[fresh..].iter().any(|t| HELPERS.contains(&text(t)));
        (plain && (placed && !verb_after || first_noun(&tokens[fresh..]).is_some_and(|x| x.0 < 4)))
            .then_some((the, fresh))
    });
    let Some((the, fresh)) = second else {
        return tokens;
    };
    let mut who = tokens[the..fresh].to_vec();
    if first_noun(&who).is_none() {
        who.retain(|t| text(t) != "one");
        who.extend(singular_of(&tokens[a..b]));
    }
    [&tokens[..the], &who, &tokens[v..v + n], &tokens[fresh..]].concat()
}
