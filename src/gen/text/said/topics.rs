//! A thing named before what is said of it: "cyclist: delete", "cars: 3", "truck: none", "of the parked cars keep one".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::frame::unwrapped;
use super::words::{first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

/// "cyclist: delete", "second car: turn into a bus", "cars: 3", "truck: none", "pedestrians: add a third one".
pub(super) fn topic(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens
        .iter()
        .take(9)
        .position(|t| text(t) == ":")
        .filter(|c| *c > 0)
    else {
        return tokens;
    };
    let np = &tokens[..colon];
    let rest = trimmed(&tokens[colon + 1..]);
    // "trucks: no more than one, the closer one"
    let most = leads(
        rest,
        &[
            "no more than",
            "not more than",
            "at most",
            "only",
            "just",
            "exactly",
            "max",
            "maximum",
            "down to",
            "up to",
            "reduce to",
            "make it",
            "should be",
        ],
    )
    .unwrap_or(0);
    let closer = rest.iter().position(|t| t.kind == TokenKind::Comma);
    let nearest = closer.is_some_and(|c| {
        leads(
            &rest[c + 1..],
            &["the closer", "the nearer", "the closest", "the nearest"],
        )
        .is_some()
    });
    let rest = if rest.get(most).is_some_and(|t| number(t).is_some()) {
        &rest[most..if nearest {
            closer.unwrap_or(rest.len())
        } else {
            rest.len()
        }]
    } else {
        rest
    };
    let Some((_, end)) = first_noun(np) else {
        return tokens;
    };
    let noun = {
        let (a, b) = first_noun(np).unwrap_or((0, end));
        &np[a..b]
    };
    let plain_np = !np.iter().any(is_verb_word) && !np.iter().any(|t| t.kind != TokenKind::Word);
    // "the woman wants to catch the bus: ..." is a clause
    let clause = np
        .get(end)
        .is_some_and(|t| super::words::is_finite(text(t), false) || super::lists::HELPERS.contains(&text(t)));
    let Some(first) = rest.first().filter(|_| plain_np && !clause) else {
        return tokens;
    };
    let the: Vec<Token> =
        if is(np.first(), &["the", "a", "an", "all", "both", "my"]) || number(&np[0]).is_some() {
            np.to_vec()
        } else {
            led("the", &np[0], &[np])
        };
    if talk.fits(np) == 0 {
        return tokens;
    }
    let ends = rest.len() == 1;
    let gone = is(
        Some(first),
        &[
            "none", "gone", "out", "away", "nil", "off", "0", "zero", "nobody", "removed", "deleted",
        ],
    ) || number(first) == Some(0);
    if ends && gone {
        return led("remove all", &tokens[0], &[&the]);
    }
    if ends && number(first).is_some() {
        return led("keep exactly", &tokens[0], &[&rest[..1], np]);
    }
    if number(first).is_some() && is(rest.get(1), &["fewer", "less"]) {
        return [&rest[..1], noun, &rest[1..]].concat();
    }
    if number(first).is_some() && is(rest.get(1), &["more"]) && rest.len() == 2 {
        return led("add", &tokens[0], &[&rest[..2], noun]);
    }
    // "add a third one, also on the zebra"
    if let Some(n) = leads(
        rest,
        &[
            "add a second one",
            "add a third one",
            "add a fourth one",
            "add a fifth one",
            "add another one",
            "add another",
            "add one more",
            "one more",
            "another one",
            "add one",
            "a second one",
            "a third one",
        ],
    ) {
        let mut more = rest[n..].to_vec();
        more.retain(|t| t.kind != TokenKind::Comma && !matches!(text(t), "also" | "too"));
        let one = singular_of(noun);
        return led("add one more", &tokens[0], &[&one, &more]);
    }
    let pronoun = rest
        .iter()
        .position(|t| matches!(text(t), "it" | "them" | "him" | "her"));
    if is_verb(first) {
        return match pronoun.filter(|p| *p < 4) {
            Some(p) => [&rest[..p], &the[..], &rest[p + 1..]].concat(),
            None if !has_noun(rest) || is(rest.get(1), &["into", "to", "by", "with"]) => {
                [&rest[..1], &the[..], &rest[1..]].concat()
            }
            None => tokens,
        };
    }
    if is_place(rest) && !is(Some(first), &["left", "right", "up", "down"]) {
        return led("move", &tokens[0], &[&the, rest]);
    }
    tokens
}

pub(super) fn is_verb_word(t: &Token) -> bool {
    is_verb(t)
        && !matches!(
            look_up(text(t)),
            Some(Sense::Noun(..) | Sense::State(..) | Sense::Article(_))
        )
        || matches!(text(t), "is" | "are" | "should" | "there")
}

pub(super) fn singular_of(noun: &[Token]) -> Vec<Token> {
    let mut out = noun.to_vec();
    if let Some(last) = out.last_mut()
        && let Some(Sense::Noun(n, true)) = look_up(&last.text)
    {
        let one = last.text.strip_suffix('s').filter(|w| look_up(w).is_some());
        last.text = one.map_or_else(|| n.classes[0].label(), str::to_string);
    }
    out
}

/// "of the parked cars keep only one, and ...": the group after the verb, if more follows.
pub(super) fn of_group(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "of the",
            "of these",
            "of those",
            "of my",
            "out of the",
            "from the",
            "among the",
        ],
    ) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &tokens[n..n + b];
    let k = n + b + usize::from(tokens.get(n + b).is_some_and(|t| t.kind == TokenKind::Comma));
    let keeps = is(tokens.get(k), &["keep", "leave", "retain", "spare"]);
    let takes = is(
        tokens.get(k),
        &["remove", "delete", "take", "erase", "drop", "scrap"],
    );
    let m = k + 1 + usize::from(is(tokens.get(k + 1), &["only", "just"]));
    let (Some(many), true) = (tokens.get(m).filter(|t| number(t).is_some()), keeps || takes) else {
        return tokens;
    };
    let end = m + 1 + usize::from(is(tokens.get(m + 1), &["away", "out", "there"]));
    if tokens.get(end).is_none() {
        return tokens;
    }
    let verb = if keeps { "keep exactly" } else { "remove any" };
    led(
        verb,
        &tokens[0],
        &[std::slice::from_ref(many), np, &tokens[end..]],
    )
}

/// "turn one of the workers into a cyclist and the car into a motorcycle": the verb again.
pub(super) fn gapped(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, _) = unwrapped(&tokens);
    let Some(verb) = inner.first().filter(|t| {
        is(
            Some(t),
            &[
                "turn",
                "change",
                "convert",
                "transform",
                "make",
                "replace",
                "swap",
                "exchange",
                "substitute",
            ],
        )
    }) else {
        return tokens;
    };
    let link: &[&str] = if is(Some(verb), &["replace", "swap", "exchange", "substitute"]) {
        &["with", "by", "for"]
    } else {
        &["into", "to"]
    };
    let Some(first) = (1..inner.len()).find(|k| is(inner.get(*k), link)) else {
        return tokens;
    };
    let second = (first + 2..inner.len()).find(|k| {
        is(inner.get(*k), &["and"])
            && is(inner.get(k + 1), &["the", "both", "all", "my", "one", "that"])
            && (k + 3..inner.len().min(k + 9)).any(|j| is(inner.get(j), link))
            && !inner[k + 1..].iter().take(6).any(|t| t.kind == TokenKind::Comma)
    });
    let Some(and) = second else {
        return tokens;
    };
    let mut out = inner[..=and].to_vec();
    out.push(verb.clone());
    out.extend_from_slice(&inner[and + 1..]);
    out
}
