//! What the speaker wants to be done: "have the taxi replaced by a bus", "I'd like every bus removed", "let a car be added".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::frame::unwrapped;
use super::words::{
    command_of, find, first_noun, is, is_finite, is_place, leads, led, number, text, trimmed, word,
};

/// "I want the cyclist on the pavement and another person beside him": the person is new.
pub(super) fn wished_beside(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, mood) = unwrapped(&tokens);
    let known = is(inner.first(), &["the", "my", "that", "both", "all"]);
    if !(mood.caused && known) {
        return tokens;
    }
    let lead = tokens.len() - inner.len();
    let found = (2..inner.len()).find(|k| {
        let fresh = is(inner.get(k + 1), &["a", "an", "another"])
            || inner.get(k + 1).is_some_and(|t| number(t).is_some());
        is(inner.get(*k), &["and"])
            && fresh
            && first_noun(&inner[k + 1..]).is_some_and(|n| n.0 < 4 && is_place(&inner[k + 1 + n.1..]))
            && first_noun(&inner[..*k]).is_some_and(|n| n.0 < 4 && is_place(&inner[n.1..*k]))
            && !inner[..*k].iter().any(|t| text(t) == "between")
    });
    match found {
        Some(k) => {
            let mut out = tokens[..=lead + k].to_vec();
            out.push(word("add", &tokens[lead + k]));
            out.extend_from_slice(&tokens[lead + k + 1..]);
            out
        }
        None => tokens,
    }
}

/// The command that a participle or another form of a verb stands for: "removed", "swapped".
pub(super) fn command(t: &Token) -> Option<String> {
    if let Some(c) = command_of(text(t)) {
        return Some(c.to_string());
    }
    (matches!(text(t), "put") && is_verb(t)).then(|| text(t).to_string())
}

/// "have the taxi replaced by a bus", "I'd like every bus removed, the motorcycle kept, and a lorry put behind us".
pub(super) fn caused(tokens: Vec<Token>) -> Vec<Token> {
    if is(tokens.first(), &["let", "lets"]) {
        return tokens;
    }
    // "have the pedestrian stand 8 m ahead, facing me": let
    let does = first_noun(&tokens)
        .filter(|n| n.0 < 5)
        .and_then(|n| tokens.get(n.1));
    if is(tokens.first(), &["have"])
        && is(
            tokens.get(1),
            &["the", "both", "my", "all", "that", "these", "those"],
        )
        && does.is_some_and(|t| is_finite(text(t), true) && command_of(text(t)).is_none())
    {
        return led("let", &tokens[0], &[&tokens[1..]]);
    }
    let (inner, mood) = unwrapped(&tokens);
    let lead = is(inner.first(), &["have", "get", "see", "want"])
        || leads(inner, &["to have", "to see", "to get"]).is_some();
    let from = match (lead, mood.caused) {
        (true, _) => leads(inner, &["to have", "to see", "to get"]).unwrap_or(1),
        (false, true) => 0,
        _ => return tokens,
    };
    // the parts of a list
    let body = &inner[from..];
    let mut parts: Vec<&[Token]> = Vec::new();
    let mut start = 0;
    for i in 0..=body.len() {
        let link = body
            .get(i)
            .is_none_or(|t| t.kind == TokenKind::Comma || text(t) == "and");
        if link {
            let part = trimmed(&body[start.min(i)..i]);
            let whole = participle(part).is_some();
            let next = trimmed(&body[i.min(body.len())..]);
            // "and a cyclist" belongs to what is before, unless it has a participle of its own
            let parted = i == body.len() || next.is_empty() || whole && starts_part(next);
            if parted && !part.is_empty() {
                parts.push(part);
                start = i + 1;
            }
        }
    }
    let mut out: Vec<Token> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let Some((at, verb)) = participle(part) else {
            if k == 0 {
                return tokens;
            }
            // a command of its own follows
            out.push(word("and", &part[0]));
            out.extend_from_slice(part);
            continue;
        };
        if k > 0 {
            out.push(word("and", &part[0]));
        }
        let rest = trimmed(&part[at + 1..]);
        if matches!(verb.as_str(), "keep" | "leave" | "retain" | "preserve") && parts.len() > 1 {
            let stays = led("as it is", &part[at], &[]);
            out.extend(led("leave", &part[at], &[&part[..at], &stays]));
            continue;
        }
        out.extend(led(&verb, &part[at], &[&part[..at], rest]));
    }
    if out.is_empty() { tokens } else { out }
}

/// "let it be dawn, and have the motorcycle replaced by a bicycle": the second half.
pub(super) fn caused_later(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|k| {
        is(tokens.get(*k), &["have", "get"])
            && is(tokens.get(k - 1), &["and", "then", "to", "also", "please"])
            && is(
                tokens.get(k + 1),
                &["the", "all", "both", "every", "my", "one", "that", "these"],
            )
    });
    let Some(k) = found else {
        return tokens;
    };
    let tail = tokens[k..].to_vec();
    let new = caused(tail.clone());
    if new == tail {
        return tokens;
    }
    let before = if is(tokens.get(k - 1), &["to"]) { k - 1 } else { k };
    [&tokens[..before], &new[..]].concat()
}

/// True if "the motorcycle kept" or a command begins here.
pub(super) fn starts_part(tokens: &[Token]) -> bool {
    let end = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma || text(t) == "and")
        .unwrap_or(tokens.len());
    participle(&tokens[..end]).is_some()
        || is_verb(&tokens[0]) && !is_place(tokens)
        || is(tokens.first(), &["have", "let", "add"])
}

/// Where the participle of "the taxi behind us replaced by a bus" stands, and its command.
pub(super) fn participle(part: &[Token]) -> Option<(usize, String)> {
    let known = is(
        part.first(),
        &[
            "the", "a", "an", "all", "both", "every", "each", "another", "my", "these", "those", "one",
        ],
    ) || part.first().is_some_and(|t| number(t).is_some());
    let (_, noun) = first_noun(part).filter(|n| n.0 < 5 && known)?;
    let stop = |t: &Token| matches!(text(t), "that" | "which" | "who" | "is" | "are" | "should");
    let at = (noun..part.len()).take_while(|k| !stop(&part[*k])).find(|k| {
        let word = text(&part[*k]);
        let describes = matches!(look_up(word), Some(Sense::State(..)))
            || matches!(word, "parked" | "marked" | "left" | "stopped" | "placed");
        command(&part[*k]).is_some() && !describes
    })?;
    Some((at, command(&part[at])?))
}

/// "let a car be added that waits at the zebra": add a car that waits there.
pub(super) fn let_be(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, _) = unwrapped(&tokens);
    let from = usize::from(is(
        inner.first(),
        &["let", "may", "shall", "should", "could", "can"],
    ));
    let body = &inner[from..];
    let fresh = is(body.first(), &["a", "an", "another", "one", "some"])
        || body.first().is_some_and(|t| number(t).is_some());
    // "let two children be with the pedestrian": two more
    let be = body.iter().position(|t| text(t) == "be");
    if let (1, true, Some(k)) = (from, fresh, be)
        && is(inner.first(), &["let"])
        && first_noun(&body[..k]).is_some_and(|x| x.1 == k)
        && (is_place(&body[k + 1..]) || is(body.get(k + 1), &["with"]))
    {
        let with = is(body.get(k + 1), &["with"]);
        let rest = &body[k + 1 + usize::from(with)..];
        let near = if with {
            led("next to", &body[0], &[rest])
        } else {
            rest.to_vec()
        };
        return led("add", &body[0], &[&body[..k], &near]);
    }
    // "let two taxis come instead"
    let comes = find(
        body,
        &["come", "appear", "be there", "come in", "stand there", "turn up"],
    )
    .filter(|(k, n)| k + n == body.len() && tokens.iter().any(|t| text(t) == "instead"));
    if let (1, true, Some((k, n))) = (from, fresh, comes)
        && first_noun(&body[..k]).is_some_and(|x| x.1 == k)
    {
        let place = led("in its place", &body[k], &[&body[k + n..]]);
        return led("put", &body[0], &[&body[..k], &place]);
    }
    let Some((i, n)) = find(
        body,
        &[
            "be added",
            "be put in",
            "be inserted",
            "to be added",
            "be placed",
            "be put",
        ],
    ) else {
        return tokens;
    };
    let short = first_noun(&body[..i]).is_some_and(|x| x.1 == i);
    if !(fresh && short) {
        return tokens;
    }
    let mut out = led("add", &body[0], &[&body[..i], &body[i + n..]]);
    // "have the lorry removed" may follow
    if let Some(k) =
        (2..out.len()).find(|k| is(out.get(*k), &["and"]) && is(out.get(k + 1), &["have", "get"]))
    {
        let rest = caused(out[k + 1..].to_vec());
        out.truncate(k + 1);
        out.extend(rest);
    }
    out
}
