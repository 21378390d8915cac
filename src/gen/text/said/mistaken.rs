//! What was taken for something else, however it is said: "not a car, a bus", "sorry, I meant a bus behind us, not a car", "what
//! drives ahead of us is not a van, it's a bus", "the car was a mistake; a bus belongs there", "bus instead of car".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::List;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use std::sync::LazyLock;

static SORRY: List = LazyLock::new(|| {
    "\
    sorry|oops|ups|whoops|no|nope|wait|hmm|ah|oh|my mistake|my bad|correction|pardon|excuse me|damn|\
    well|sorry no|no sorry|oh no|wait no|no wait|typo|my fault"
        .split('|')
        .collect()
});
static MEANT: List = LazyLock::new(|| {
    "\
    i meant|i mean|we meant|i said|i wanted|i asked for|i ordered|i had in mind|make it|\
    it was supposed to be|it was meant to be|it should be|it should have been|it has to be|it must be|\
    that was supposed to be|that should be|that should have been|this should be|this was meant to be|\
    it is supposed to be|it ought to be|it is meant to be|i was thinking of|i was talking about|it is|\
    its|that is|thats|use|please use|better use|let us use|lets use|take|i want|i need|we need|there should be|there should have been|it was"
        .split('|')
        .collect()
});
static WRONG: List = LazyLock::new(|| {
    "\
    a mistake|my mistake|an error|wrong|not right|a slip|a typo|the wrong kind|a slip of the pen|\
    the wrong vehicle|the wrong thing|a misunderstanding|incorrect|not correct|false|out of place"
        .split('|')
        .collect()
});
static THERE: List = LazyLock::new(|| {
    "\
    there|in its place|there instead|instead|in that place|in its stead|in that spot|here|in his place|\
    in her place|in its spot|in that position|in the same place"
        .split('|')
        .collect()
});
static BELONGS: List = LazyLock::new(|| {
    "\
    belongs|should be|must be|should stand|should drive|should have been|goes|should go|ought to be|\
    has to be|is to be|was supposed to be|is supposed to be|is needed|should come|is|needs to be|\
    would be right|is meant to be|was meant to be|should be placed|stands|drives"
        .split('|')
        .collect()
});
pub(super) const WHICH: &[&str] = &["that", "which", "who"];

/// A sentence (without its stop) as the exchange that it asks for.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let rest = &tokens[excused(&tokens)..];
    denied_first(rest, talk)
        .or_else(|| denied_last(rest, talk))
        .or_else(|| told_of_place(rest, talk))
        .or_else(|| it_was_there(rest, talk))
        .or_else(|| belongs_there(rest, talk))
        .or_else(|| rides_other(rest, talk))
        .or_else(|| noted_for(rest, talk))
        .unwrap_or(tokens)
}

/// "The car was a mistake. A bus belongs there." is one sentence.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut from = 0;
    for i in 0..tokens.len() {
        if tokens[i].kind != TokenKind::Stop {
            continue;
        }
        let end = (i + 1..tokens.len())
            .find(|k| tokens[*k].kind == TokenKind::Stop)
            .unwrap_or(tokens.len());
        if mistake(&tokens[from..i]).is_some_and(|(_, n)| n == i - from)
            && new_there(&tokens[i + 1..end]).is_some()
        {
            tokens[i].kind = TokenKind::Comma;
            tokens[i].text = ",".into();
        }
        from = i + 1;
    }
    tokens
}

/// One past what only excuses the slip, and its comma.
fn excused(tokens: &[Token]) -> usize {
    // "according to the witness it was ..."
    if leads(tokens, &["according to"]).is_some()
        && let Some(k) =
            (3..tokens.len().min(8)).find(|k| is(tokens.get(*k), &["it", "that", "this", "what"]))
    {
        return k;
    }
    let n = leads(tokens, &SORRY).unwrap_or(0);
    match tokens.get(n) {
        Some(t) if n > 0 && t.kind == TokenKind::Comma => n + 1,
        _ if n > 0 && is(tokens.first(), &["sorry", "oops", "whoops"]) => n,
        _ => leads(
            tokens,
            &[
                "actually",
                "in fact",
                "in reality",
                "really",
                "rather",
                "of course",
                "clearly",
            ],
        )
        .unwrap_or(0),
    }
}

/// A kind that is named with an indefinite article or none at the start: where its noun begins and ends.
pub(super) fn kind(tokens: &[Token]) -> Option<(usize, usize)> {
    let (a, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let led = is(tokens.first(), &["a", "an"]) || a == 0;
    (led && !tokens[..a]
        .iter()
        .any(|t| number(t).is_some() && !is(Some(t), &["a", "an"])))
    .then_some((a, b))
}

fn many(noun: &[Token]) -> bool {
    noun.last()
        .is_some_and(|t| matches!(super::look_up(text(t)), Some(super::Sense::Noun(_, true))))
}

/// Replace the old ones, those at the place if that tells them, by the new.
fn exchange(old: &[Token], place: &[Token], new: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (old, new) = (trimmed(old), trimmed(new));
    let (a, b) = kind(old).filter(|x| x.1 == old.len())?;
    let (c, d) = kind(new).filter(|x| x.1 == new.len())?;
    let bare = &old[usize::from(is(old.first(), &["a", "an"]))..];
    let at = &old[a];
    let there = [bare, place].concat();
    let np = if !place.is_empty() && talk.fits(&led("the", at, &[&there])) > 0 {
        there
    } else {
        bare.to_vec()
    };
    let fits = talk.fits(&led("the", at, &[&np]));
    // (a colour of what is there already says nothing of another kind)
    let same = old[a..b].iter().map(text).eq(new[c..d].iter().map(text));
    (fits > 0 && !same && many(&old[a..b]) == many(&new[c..d])).then_some(())?;
    let lead = if many(&old[a..b]) {
        "replace all the"
    } else {
        "replace the"
    };
    let article = if many(&new[c..d]) || is(new.first(), &["a", "an"]) {
        "with"
    } else {
        "with a"
    };
    Some(led(lead, at, &[&np, &led(article, at, &[new])]))
}

/// "not a car, a bus", "no car but a bus behind us".
fn denied_first(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "not",
            "no",
            "it is not",
            "its not",
            "it isnt",
            "that is not",
            "thats not",
            "not just",
            "it was not",
            "it wasnt",
            "that was not",
        ],
    )?;
    let old = &tokens[n..];
    let (_, b) = kind(old)?;
    // "it is not a car that follows us but a bus"
    let which = usize::from(is(old.get(b), WHICH));
    let but = (b..old.len().min(b + 9)).find(|k| {
        old[*k].kind != TokenKind::Word && !matches!(old[*k].kind, TokenKind::Number(_))
            || is(old.get(*k), &["but"])
    })?;
    let place = stood(&old[b + which..but], which > 0)?;
    let rest = old.get(but..)?;
    let k = rest.iter().position(|t| {
        !(t.kind == TokenKind::Comma
            || t.kind == TokenKind::Mark
            || is(
                Some(t),
                &[
                    "but", "rather", "its", "it", "is", "instead", "make", "please", "it", "was",
                ],
            ))
    })?;
    let new = &rest[k..];
    let (_, d) = kind(new)?;
    let late = trimmed(&new[d..]);
    let late = if is(late.first(), WHICH) {
        stood(&late[1..], true)?
    } else {
        late
    };
    (late.is_empty() || is_place(late) && !has_noun(late)).then_some(())?;
    exchange(
        &old[..b],
        if late.is_empty() { place } else { late },
        &new[..d],
        talk,
    )
}

/// Where something is, of "follows us", "drives behind us", "behind us"; nothing of nothing.
fn stood(words: &[Token], verb: bool) -> Option<&[Token]> {
    let words = trimmed(words);
    if words.is_empty() || leads(words, &THERE) == Some(words.len()) {
        let words = &words[..0];
        return Some(words);
    }
    let k = if verb {
        // ("follows us" is a place by itself)
        (0..words.len().min(3)).find(|k| is_place(&words[*k..]))
    } else {
        is_place(words).then_some(0)
    };
    let place = &words[k?..];
    (!has_noun(place)).then_some(place)
}

/// "I meant a bus behind us, not a car", "bus, not car", "it is a bus that drives behind us, not a car".
fn denied_last(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let meant = leads(tokens, &MEANT).unwrap_or(0);
    let new = &tokens[meant..];
    let (_, b) = kind(new)?;
    let (not, n) = find(
        new,
        &[
            "and not",
            "not",
            "instead of",
            "rather than",
            "and no",
            "no",
            "in place of",
            "instead",
        ],
    )
    .filter(|x| {
        x.0 >= b
            && !is(
                new.get(x.0 + x.1),
                &["on", "in", "at", "behind", "ahead", "to", "from"],
            )
    })?;
    // (", instead a bus" brings something in)
    if is(new.get(not), &["instead"]) && !is(new.get(not + 1), &["of"]) {
        return None;
    }
    let old = trimmed(&new[not + n..]);
    let (_, e) = kind(old)?;
    let between = trimmed(&new[b..not]);
    let which = is(between.first(), WHICH);
    let place = stood(&between[usize::from(which)..], which)?;
    let late = trimmed(&old[e..]);
    // ("a car, not a bus, drives in the left lane")
    let verb =
        super::words::is_finite(late.first().map_or("", text), true) || is(late.first(), &["is", "should"]);
    let verb = verb && !late.is_empty();
    let place = if late.is_empty() {
        place
    } else {
        stood(late, verb)?
    };
    // (a full sentence about a new place is more than a slip)
    // ("a bus, not a pickup, in the junction", where the pickup is)
    let stands = || {
        let bare = &old[usize::from(is(old.first(), &["a", "an"]))..e];
        !late.is_empty() && talk.fits(&led("the", &old[0], &[bare, place])) > 0
    };
    (meant > 0 || place.is_empty() || which || verb || stands()).then_some(())?;
    exchange(&old[..e], place, &new[..b], talk)
}

/// "what drives ahead of us is not a van, it's a bus", "the thing behind us isn't a car but a bus".
fn told_of_place(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "what",
            "whatever",
            "who",
            "the one",
            "the thing",
            "the one that",
            "the vehicle",
            "the vehicle that",
            "the thing that",
            "that which",
            "that thing",
            "the road user",
        ],
    )?;
    let (is_at, m) = find(
        tokens,
        &[
            "is not",
            "isnt",
            "was not",
            "wasnt",
            "is no",
            "should not be",
            "shouldnt be",
            "cannot be",
            "cant be",
        ],
    )
    .filter(|x| x.0 > n && x.0 < 12)?;
    let verb = tokens.get(n..is_at)?;
    let place = stood(verb, !is_place(verb))?;
    if place.is_empty() {
        return None;
    }
    let old = &tokens[is_at + m..];
    let (_, b) = kind(old)?;
    let k = (b..old.len()).find(|k| {
        !(old[*k].kind != TokenKind::Word
            || is(
                old.get(*k),
                &[
                    "but", "its", "it", "is", "rather", "should", "be", "must", "that", "thats", "was",
                ],
            ))
    })?;
    let new = trimmed(&old[k..]);
    let (_, d) = kind(new).filter(|x| x.1 == new.len())?;
    exchange(&old[..b], place, &new[..d], talk)
}

/// "what followed us was a bicycle, not a motorcycle".
fn it_was_there(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "what",
            "whatever",
            "who",
            "the one that",
            "the thing that",
            "the vehicle that",
            "the one who",
            "that which",
        ],
    )?;
    let at = (n + 1..tokens.len().min(n + 8))
        .find(|k| is(tokens.get(*k), &["is", "was"]) && is(tokens.get(k + 1), &["a", "an"]))?;
    let verb = tokens.get(n..at)?;
    let place = stood(verb, !is_place(verb))?;
    let new = &tokens[at + 1..];
    let (_, b) = kind(new)?;
    let not = find(&new[b..], &["not", "and not", "rather than", "instead of"]).filter(|x| x.0 < 2)?;
    let old = trimmed(&new[b + not.0 + not.1..]);
    let (_, e) = kind(old).filter(|x| x.1 == old.len())?;
    exchange(&old[..e], place, &new[..b], talk)
}

/// "the car was a mistake": the end of what it names, and of the clause.
fn mistake(tokens: &[Token]) -> Option<(usize, usize)> {
    is(tokens.first(), &["the", "that", "this"]).then_some(())?;
    let (_, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let be =
        (b..tokens.len().min(b + 6)).find(|k| is(tokens.get(*k), &["is", "was", "are", "were", "seems"]))?;
    let just = usize::from(is(
        tokens.get(be + 1),
        &["just", "simply", "clearly", "obviously", "only"],
    ));
    let n = leads(&tokens[be + 1 + just..], &WRONG)?;
    (be == b || is_place(&tokens[b..be])).then_some((be, be + 1 + just + n))
}

/// "a bus belongs there", "there should be a bus": the new kind.
fn new_there(tokens: &[Token]) -> Option<&[Token]> {
    let tokens = trimmed(tokens);
    if let Some(n) = leads(
        tokens,
        &[
            "there should be",
            "there should have been",
            "it should be",
            "it should have been",
            "it was supposed to be",
            "i meant",
            "i wanted",
            "there must be",
            "make it",
        ],
    ) {
        let new = &tokens[n..];
        let (_, b) = kind(new)?;
        let late = trimmed(&new[b..]);
        return (late.is_empty() || leads(late, &THERE) == Some(late.len())).then_some(&new[..b]);
    }
    let (_, b) = kind(tokens)?;
    is(tokens.first(), &["a", "an"]).then_some(())?;
    let n = leads(&tokens[b..], &BELONGS)?;
    let late = trimmed(&tokens[b + n..]);
    (leads(late, &THERE) == Some(late.len()) && !late.is_empty()).then_some(&tokens[..b])
}

/// "instead of on a bicycle, he is on a moped", "he rides a moped rather than a bicycle".
fn rides_other(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const INSTEAD: [&str; 3] = ["instead of", "rather than", "and not"];
    let (i, n) = find(tokens, &INSTEAD)?;
    let on = |t: &[Token]| {
        leads(
            t,
            &["being on", "sitting on", "riding", "riding on", "on", "driving"],
        )
        .unwrap_or(0)
    };
    let (old, he) = if i == 0 {
        let comma = tokens.iter().position(|t| t.kind == TokenKind::Comma)?;
        (&tokens[n..comma], &tokens[comma + 1..])
    } else {
        (&tokens[i + n..], trimmed(&tokens[..i]))
    };
    let old = &old[on(old)..];
    is(he.first(), &["he", "she", "they"]).then_some(())?;
    let rides = 1 + leads(
        &he[1..],
        &[
            "is on",
            "is riding",
            "rides",
            "sits on",
            "is sitting on",
            "should be on",
            "should ride",
            "should be riding",
            "has",
            "is now on",
            "is now riding",
            "uses",
            "is driving",
            "drives",
        ],
    )?;
    exchange(old, &[], &he[rides..], talk).filter(|_| is(old.first(), &["a", "an"]))
}

/// "the car was a mistake; a bus belongs there".
fn belongs_there(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (end, n) = mistake(tokens)?;
    let new = new_there(tokens.get(n..)?)?;
    let np = &tokens[..end];
    (talk.fits(np) > 0).then(|| led("replace", &tokens[0], &[np, &led("with", &tokens[0], &[new])]))
}

/// "road roller instead of the digger, with a third worker beside it", "scooter for the grey car, and 9 m behind us": the one
/// for the other, and what more is told of it.
fn noted_for(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (a, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let article = is(tokens.first(), &["a", "an"]);
    let described = |t: &Token| {
        use super::Sense::{Attribute, Color, Size};
        matches!(super::look_up(text(t)), Some(Color(_) | Size(_) | Attribute(_))) || number(t).is_some()
    };
    (article || tokens[..a].iter().all(described)).then_some(())?;
    let n = leads(
        &tokens[b..],
        &[
            "instead of",
            "rather than",
            "in place of",
            "in lieu of",
            "for",
            "and not",
            "replacing",
            "replaces",
        ],
    )?;
    let old = &tokens[b + n..];
    is(old.first(), &["the", "that", "both", "all", "my", "our"]).then_some(())?;
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    let comma = (e..old.len()).find(|k| old[*k].kind == TokenKind::Comma);
    let end = comma.unwrap_or(old.len());
    // (the place tells which)
    let np = &old[..end];
    (end == e || is_place(&np[e..]) && !has_noun(&np[e..])).then_some(())?;
    (talk.fits(np) > 0 && talk.fits(np) == talk.fits(&[&old[..1], &np[1..]].concat())).then_some(())?;
    let many = many(&tokens[a..b]) || tokens[..a].iter().any(|t| number(t).is_some());
    let with = if article || many { "with" } else { "with a" };
    let more = old.get(end + 1..).unwrap_or(&[]);
    let more = trimmed(more);
    let not = find(more, &["rather than", "instead of", "not"]).map_or(more.len(), |x| x.0);
    let more = trimmed(&more[..not]);
    let at = usize::from(is(more.first(), &["at"]));
    let beside = is(more.first(), &["with"])
        && more
            .get(1)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]))
        && has_noun(more)
        && is(more.last(), &["it", "them", "him", "her"]);
    let far = super::headway::measure(&more[at..]).filter(|m| m.0 == 0);
    let tail = match far {
        _ if more.is_empty() => Vec::new(),
        _ if beside => led("and add", &more[0], &[&more[1..]]),
        Some((_, m)) if !has_noun(&more[at..]) && (at + m == more.len() || is_place(&more[at + m..])) => led(
            if many {
                "and move them to"
            } else {
                "and move it to"
            },
            &more[0],
            &[&more[at..]],
        ),
        _ => return None,
    };
    // (alone it is read well as it is)
    let whole = end == old.len() && !is(tokens.get(b), &["for", "replacing", "replaces"]);
    (!whole).then(|| {
        let new = led(with, &tokens[0], &[&tokens[..b], &tail]);
        led("replace", &tokens[0], &[np, &new])
    })
}

/// "the suspect's vehicle was not a bus but a lorry": whose it was tells no place.
pub(super) fn whose(tokens: Vec<Token>) -> Vec<Token> {
    let found = find(
        &tokens,
        &[
            "was not a",
            "wasnt a",
            "is not a",
            "isnt a",
            "was not an",
            "was no",
            "is no",
        ],
    )
    .filter(|x| (2..8).contains(&x.0));
    let Some((k, n)) = found else { return tokens };
    let things = ["vehicle", "thing", "object"];
    let thing = is(tokens.get(k - 1), &things);
    // ("the vehicle of the suspect")
    let owned = k > 3 && is(tokens.get(1), &things) && is(tokens.get(2), &["of"]);
    let of = text(&tokens[k - 2]).ends_with('s')
        || is(tokens.get(k - 2), &["his", "her", "their"])
        || k == 2 && is(tokens.first(), &["the", "that"]);
    let but = tokens[k + n..].iter().take(6).any(|t| is(Some(t), &["but"]));
    if !(thing && of || owned) || !but {
        return tokens;
    }
    led("it was not a", &tokens[0], &[&tokens[k + n..]])
}
