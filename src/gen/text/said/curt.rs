//! Curt notes, as testers write them: "bus too close. Should be 30 m ahead", "3 pedestrians on right sidewalk, expected 2", "car +
//! truck: delete both", "more traffic: two buses".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

/// A sentence (without its stop) in whole words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = complaint(tokens, talk);
    let out = without_subject(out, talk);
    let out = expected(out);
    let out = all_of_these(out);
    same_place(in_particular(out))
}

const COMPLAINTS: &[&str] = &[
    "too close",
    "too near",
    "too far",
    "too far away",
    "too far off",
    "too far ahead",
    "wrong side",
    "on wrong side",
    "on the wrong side",
    "wrong lane",
    "in wrong lane",
    "in the wrong lane",
    "wrong place",
    "in wrong place",
    "in the wrong place",
    "wrong way",
    "wrong way round",
    "wrong direction",
    "facing wrong way",
    "facing the wrong way",
    "misplaced",
    "wrong position",
    "in wrong position",
    "wrong spot",
];

/// "bus too close", "lorry parked on wrong side, must be left edge of road": the bus is.
fn complaint(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((a, b)) = first_noun(&tokens).filter(|n| n.0 < 3) else {
        return tokens;
    };
    let bare = tokens[..a].iter().all(|t| {
        matches!(
            look_up(text(t)),
            Some(Sense::Color(_) | Sense::State(..) | Sense::Size(_))
        )
    });
    let parked = usize::from(is(
        tokens.get(b),
        &["parked", "standing", "placed", "is", "stands"],
    ));
    let Some(n) = leads(&tokens[b + parked..], COMPLAINTS).filter(|_| bare && talk.fits(&tokens[..b]) == 1)
    else {
        return tokens;
    };
    let end = b + parked + n;
    let mut rest = trimmed(&tokens[end..]);
    if is(rest.first(), &["for", "to", "of"]) && rest.len() < 3 {
        rest = &[];
    }
    let mut out = led("the", &tokens[0], &[&tokens[..b]]);
    if rest.is_empty() {
        out.extend(led("is", &tokens[0], &[&tokens[end - n..end]]));
        return out;
    }
    // what it must be follows
    let must = leads(rest, MUST).unwrap_or(0);
    if must == 0 {
        return tokens;
    }
    out.extend(led("should be", &tokens[0], &[&placed(&rest[must..])]));
    out
}

const MUST: &[&str] = &[
    "must be",
    "should be",
    "has to be",
    "needs to be",
    "ought to be",
    "shall be",
    "should stand",
    "must stand",
    "should have been",
    "supposed to be",
    "belongs",
    "should go",
    "must go",
    "needs to go",
    "has to go",
];

/// "left edge of road": on it.
fn placed(rest: &[Token]) -> Vec<Token> {
    let side = is(rest.first(), &["left", "right", "opposite", "oncoming", "other"])
        && is(
            rest.get(1),
            &[
                "edge", "side", "lane", "sidewalk", "pavement", "roadside", "kerb", "curb", "shoulder",
            ],
        );
    if side {
        let prep = if is(rest.get(1), &["lane"]) {
            "in the"
        } else {
            "on the"
        };
        return led(prep, &rest[0], &[rest]);
    }
    rest.to_vec()
}

/// "should be 30 m ahead", "move to left edge of road": what was spoken of last.
fn without_subject(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if talk.last.is_none() || tokens.len() < 3 {
        return tokens;
    }
    if let Some(n) = leads(&tokens, MUST).filter(|n| !is(tokens.get(*n), &["there", "the", "a", "an"])) {
        let place = placed(&tokens[n..]);
        return if is_place(&place) {
            led("it should be", &tokens[0], &[&place])
        } else {
            tokens
        };
    }
    let goes = is(
        tokens.first(),
        &[
            "move", "shift", "put", "place", "bring", "push", "pull", "relocate", "drag", "set", "send",
        ],
    );
    let to = is(
        tokens.get(1),
        &[
            "to", "into", "onto", "in", "on", "behind", "beside", "next", "ahead", "further", "closer",
            "back",
        ],
    ) || number(&tokens[1]).is_some() && super::words::is_unit(tokens.get(2));
    let object = first_noun(&tokens).is_some_and(|n| n.0 > 0 && !is_place(&tokens[1..n.0]));
    if !(goes && to) || object {
        return tokens;
    }
    let mut out = led(text(&tokens[0]), &tokens[0], &[]);
    out.extend(led("it", &tokens[0], &[&tokens[1..]]));
    out
}

/// "3 pedestrians on right sidewalk, expected 2": there should be 2.
fn expected(tokens: Vec<Token>) -> Vec<Token> {
    const WANTED: &[&str] = &[
        "expected",
        "expecting",
        "wanted",
        "should be",
        "must be",
        "required",
        "target",
        "spec says",
        "we expected",
        "i expected",
        "needed",
    ];
    let Some(_) = tokens.first().and_then(number) else {
        return tokens;
    };
    let found = (2..tokens.len()).find_map(|i| {
        let mark = tokens[i].kind != TokenKind::Word;
        let n = mark.then(|| leads(&tokens[i + 1..], WANTED))??;
        let many = tokens.get(i + 1 + n).filter(|t| number(t).is_some())?;
        (i + 2 + n == tokens.len()).then_some((i, many))
    });
    match found {
        Some((i, many)) if has_noun(&tokens[1..i]) => led(
            "there should be exactly",
            &tokens[0],
            &[std::slice::from_ref(many), &tokens[1..i]],
        ),
        _ => tokens,
    }
}

/// "car + truck: delete both": delete the car and the truck.
fn all_of_these(tokens: Vec<Token>) -> Vec<Token> {
    let Some(colon) = tokens.iter().position(|t| text(t) == ":") else {
        return tokens;
    };
    let (list, order) = (&tokens[..colon], &tokens[colon + 1..]);
    let verb = order.first().is_some_and(is_verb);
    let all = order.len() > 1 && is(order.get(1), &["both", "them", "all"]);
    let parts: Vec<&[Token]> = list
        .split(|t| t.kind != TokenKind::Word && t.kind != TokenKind::Stop || is(Some(t), &["and"]))
        .filter(|p| !p.is_empty())
        .collect();
    let nouns = parts
        .iter()
        .all(|p| first_noun(p).is_some_and(|n| n.0 < 3 && n.1 == p.len()));
    if !(verb && all && nouns && parts.len() > 1) {
        return tokens;
    }
    let mut out = led(text(&order[0]), &order[0], &[]);
    for (k, part) in parts.iter().enumerate() {
        if k > 0 {
            out.extend(led("and", &order[0], &[]));
        }
        let the = if is(part.first(), &["the", "all", "both", "my"]) {
            &[][..]
        } else {
            &led("the", &part[0], &[])[..]
        };
        out.extend_from_slice(the);
        out.extend_from_slice(part);
    }
    let after = usize::from(is(order.get(2), &["of"])) * 2;
    out.extend_from_slice(&order[(2 + after).min(order.len())..]);
    out
}

/// "more traffic: add two buses", "add a road user: one cyclist": what comes after the colon is what is meant.
fn in_particular(tokens: Vec<Token>) -> Vec<Token> {
    let Some(colon) = tokens
        .iter()
        .position(|t| text(t) == ":")
        .filter(|k| *k > 0 && *k < 9)
    else {
        return tokens;
    };
    let (mut lead, rest) = (&tokens[..colon], &tokens[colon + 1..]);
    while let Some((_, first)) = lead
        .split_last()
        .filter(|x| is(Some(x.0), &["well", "as", "too", "also", "please"]))
    {
        lead = first;
    }
    let from_front = [
        "from the front",
        "coming towards us",
        "coming the other way",
        "in the other direction",
        "from ahead",
        "from the other direction",
    ]
    .iter()
    .find_map(|p| {
        lead.len()
            .checked_sub(p.split(' ').count())
            .filter(|k| *k > 0 && leads(&lead[*k..], &[*p]).is_some())
    });
    if let Some(k) = from_front {
        lead = &lead[..k];
    }
    // "some oncoming traffic: one tanker, one car": oncoming, all of them
    let oncoming = from_front.is_some() || lead.len() > 1 && is(lead.get(lead.len() - 2), &["oncoming"]);
    let wide = |t: &Token| matches!(look_up(text(t)), Some(Sense::Noun(n, _)) if n.classes.len() > 3);
    let general = is(
        lead.last(),
        &[
            "traffic",
            "company",
            "user",
            "users",
            "action",
            "life",
            "variety",
            "vehicles",
            "vehicle",
            "participant",
            "participants",
            "change",
            "edit",
            "request",
            "correction",
            "update",
            "fix",
        ],
    );
    let company = is(lead.last(), &["company", "user", "users"]);
    let narrow =
        !company && (0..lead.len()).any(|i| super::words::noun_at(&lead[i..]).is_some() && !wide(&lead[i]));
    let more = is(
        lead.first(),
        &[
            "give",
            "lets",
            "more",
            "some",
            "add",
            "a",
            "extra",
            "additional",
            "small",
            "one",
            "please",
            "we",
            "i",
            "there",
            "traffic",
            "oncoming",
        ],
    );
    let fresh = rest
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]));
    let orders = rest.first().is_some_and(is_verb);
    if !(general && more && !narrow && (fresh || orders) && has_noun(rest)) {
        return tokens;
    }
    if orders {
        return rest.to_vec();
    }
    let rest = super::super::wording::rewritten(rest, |i, out| {
        let noun = oncoming
            && super::words::noun_at(&rest[i..]).is_some()
            && (i == 0 || super::words::noun_at(&rest[i - 1..]).is_none());
        if !noun {
            return None;
        }
        out.extend(led("oncoming", &rest[i], &[&rest[i..=i]]));
        Some(i + 1)
    });
    // (what comes towards us is ahead)
    let far = oncoming
        && rest.len() > 2
        && super::words::is_unit(rest.last())
        && number(&rest[rest.len() - 2]).is_some();
    let ahead = if far {
        led("ahead", &tokens[0], &[])
    } else {
        Vec::new()
    };
    led("add", &tokens[0], &[&rest, &ahead])
}

/// "lorry -> trailer, same position": what takes a place is there anyhow.
fn same_place(tokens: Vec<Token>) -> Vec<Token> {
    const SAME: &[&str] = &[
        "same position",
        "same place",
        "same spot",
        "same location",
        "in the same position",
        "in the same place",
        "in the same spot",
        "at the same position",
        "at the same place",
        "at the same spot",
        "the same position",
        "the same place",
    ];
    let becomes = tokens
        .iter()
        .any(|t| is(Some(t), &["replace", "swap", ">", "into", "=", "becomes"]));
    let cut = (2..tokens.len()).find(|i| {
        tokens[*i].kind == TokenKind::Comma
            && leads(&tokens[i + 1..], SAME).is_some_and(|n| i + 1 + n == tokens.len())
    });
    match cut {
        Some(i) if becomes => tokens[..i].to_vec(),
        _ => tokens,
    }
}
