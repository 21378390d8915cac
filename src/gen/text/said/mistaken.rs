//! What was taken for something else, however it is said: "not a car, a bus", "sorry, I meant a bus behind us, not a car", "what
//! drives ahead of us is not a van, it's a bus", "the car was a mistake; a bus belongs there", "bus instead of car".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const SORRY: &[&str] = &[
    "sorry", "oops", "ups", "whoops", "no", "nope", "wait", "hmm", "ah", "oh", "my mistake", "my bad", "correction",
    "pardon", "excuse me", "damn", "well", "sorry no", "no sorry", "oh no", "wait no", "no wait", "typo", "my fault",
];
const MEANT: &[&str] = &[
    "i meant", "i mean", "we meant", "i said", "i wanted", "i asked for", "i ordered", "i had in mind", "make it",
    "it was supposed to be", "it was meant to be", "it should be", "it should have been", "it has to be", "it must be",
    "that was supposed to be", "that should be", "that should have been", "this should be", "this was meant to be",
    "it is supposed to be", "it ought to be", "it is meant to be", "i was thinking of", "i was talking about", "it is",
    "its", "that is", "thats", "i want", "i need", "we need", "there should be", "there should have been", "it was",
];
const WRONG: &[&str] = &[
    "a mistake", "my mistake", "an error", "wrong", "not right", "a slip", "a typo", "the wrong kind", "a slip of the pen",
    "the wrong vehicle", "the wrong thing", "a misunderstanding", "incorrect", "not correct", "false", "out of place",
];
const THERE: &[&str] = &[
    "there", "in its place", "there instead", "instead", "in that place", "in its stead", "in that spot", "here",
    "in his place", "in her place", "in its spot", "in that position", "in the same place",
];
const BELONGS: &[&str] = &[
    "belongs", "should be", "must be", "should stand", "should drive", "should have been", "goes", "should go",
    "ought to be", "has to be", "is to be", "was supposed to be", "is supposed to be", "is needed", "should come", "is",
    "needs to be", "would be right", "is meant to be", "was meant to be", "should be placed", "stands", "drives",
];
const WHICH: &[&str] = &["that", "which", "who"];

/// A sentence (without its stop) as the exchange that it asks for.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = so_many_instead(what_bothers(not_this_but(in_exchange(tokens))));
    let rest = &tokens[excused(&tokens)..];
    denied_first(rest, talk)
        .or_else(|| denied_last(rest, talk))
        .or_else(|| told_of_place(rest, talk))
        .or_else(|| belongs_there(rest, talk))
        .or_else(|| own_swapped(rest, talk))
        .or_else(|| where_it_is(rest, talk))
        .or_else(|| made_out_of(rest, talk))
        .unwrap_or_else(|| the_one_that(tokens, talk))
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
        if mistake(&tokens[from..i]).is_some_and(|(_, n)| n == i - from) && new_there(&tokens[i + 1..end]).is_some() {
            tokens[i].kind = TokenKind::Comma;
            tokens[i].text = ",".into();
        }
        from = i + 1;
    }
    tokens
}

/// One past what only excuses the slip, and its comma.
fn excused(tokens: &[Token]) -> usize {
    let n = leads(tokens, SORRY).unwrap_or(0);
    match tokens.get(n) {
        Some(t) if n > 0 && t.kind == TokenKind::Comma => n + 1,
        _ if n > 0 && is(tokens.first(), &["sorry", "oops", "whoops"]) => n,
        _ => leads(tokens, &["actually", "in fact", "in reality", "really", "rather", "of course", "clearly"]).unwrap_or(0),
    }
}

/// A kind that is named with an indefinite article or none at the start: where its noun begins and ends.
fn kind(tokens: &[Token]) -> Option<(usize, usize)> {
    let (a, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let led = is(tokens.first(), &["a", "an"]) || a == 0;
    (led && !tokens[..a].iter().any(|t| number(t).is_some() && !is(Some(t), &["a", "an"]))).then_some((a, b))
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
    let lead = if many(&old[a..b]) { "replace all the" } else { "replace the" };
    let article = if many(&new[c..d]) || is(new.first(), &["a", "an"]) { "with" } else { "with a" };
    Some(led(lead, at, &[&np, &led(article, at, &[new])]))
}

/// "not a car, a bus", "no car but a bus behind us".
fn denied_first(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(tokens, &["not", "no", "it is not", "its not", "it isnt", "that is not", "thats not", "not just", "it was not", "it wasnt", "that was not"])?;
    let old = &tokens[n..];
    let (_, b) = kind(old)?;
    // "it is not a car that follows us but a bus"
    let which = usize::from(is(old.get(b), WHICH));
    let but = (b..old.len().min(b + 9)).find(|k| {
        old[*k].kind != TokenKind::Word && !matches!(old[*k].kind, TokenKind::Number(_)) || is(old.get(*k), &["but"])
    })?;
    let place = stood(&old[b + which..but], which > 0)?;
    let rest = old.get(but..)?;
    let k = rest
        .iter()
        .position(|t| {
            !(t.kind == TokenKind::Comma || t.kind == TokenKind::Mark
                || is(Some(t), &["but", "rather", "its", "it", "is", "instead", "make", "please", "it", "was"]))
        })?;
    let new = &rest[k..];
    let (_, d) = kind(new)?;
    let late = trimmed(&new[d..]);
    let late = if is(late.first(), WHICH) { stood(&late[1..], true)? } else { late };
    (late.is_empty() || is_place(late) && !has_noun(late)).then_some(())?;
    exchange(&old[..b], if late.is_empty() { place } else { late }, &new[..d], talk)
}

/// Where something is, of "follows us", "drives behind us", "behind us"; nothing of nothing.
fn stood(words: &[Token], verb: bool) -> Option<&[Token]> {
    let words = trimmed(words);
    if words.is_empty() || leads(words, THERE) == Some(words.len()) {
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
    let meant = leads(tokens, MEANT).unwrap_or(0);
    let new = &tokens[meant..];
    let (_, b) = kind(new)?;
    let (not, n) = find(
        new,
        &["and not", "not", "instead of", "rather than", "and no", "no", "in place of", "instead"],
    )
    .filter(|x| x.0 >= b && !is(new.get(x.0 + x.1), &["on", "in", "at", "behind", "ahead", "to", "from"]))?;
    // (", instead a bus" brings something in)
    is(new.get(not), &["instead"]).then(|| is(new.get(not + 1), &["of"])).unwrap_or(true).then_some(())?;
    let old = trimmed(&new[not + n..]);
    let (_, e) = kind(old)?;
    let between = trimmed(&new[b..not]);
    let which = is(between.first(), WHICH);
    let place = stood(&between[usize::from(which)..], which)?;
    let late = trimmed(&old[e..]);
    // ("a car, not a bus, drives in the left lane")
    let verb = super::words::is_finite(late.first().map_or("", text), true) || is(late.first(), &["is", "should"]);
    let place = if late.is_empty() { place } else { stood(late, verb)? };
    // (a full sentence about a new place is more than a slip)
    (meant > 0 || place.is_empty() || which).then_some(())?;
    exchange(&old[..e], place, &new[..b], talk)
}

/// "what drives ahead of us is not a van, it's a bus", "the thing behind us isn't a car but a bus".
fn told_of_place(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "what", "whatever", "who", "the one", "the thing", "the one that", "the vehicle", "the vehicle that",
            "the thing that", "that which", "that thing", "the road user",
        ],
    )?;
    let (is_at, m) = find(
        tokens,
        &["is not", "isnt", "was not", "wasnt", "is no", "should not be", "shouldnt be", "cannot be", "cant be"],
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
            || is(old.get(*k), &["but", "its", "it", "is", "rather", "should", "be", "must", "that", "thats", "was"]))
    })?;
    let new = trimmed(&old[k..]);
    let (_, d) = kind(new).filter(|x| x.1 == new.len())?;
    exchange(&old[..b], place, &new[..d], talk)
}

/// "the car was a mistake": the end of what it names, and of the clause.
fn mistake(tokens: &[Token]) -> Option<(usize, usize)> {
    is(tokens.first(), &["the", "that", "this"]).then_some(())?;
    let (_, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let be = (b..tokens.len().min(b + 6)).find(|k| is(tokens.get(*k), &["is", "was", "are", "were", "seems"]))?;
    let just = usize::from(is(tokens.get(be + 1), &["just", "simply", "clearly", "obviously", "only"]));
    let n = leads(&tokens[be + 1 + just..], WRONG)?;
    (be == b || is_place(&tokens[b..be])).then_some((be, be + 1 + just + n))
}

/// "a bus belongs there", "there should be a bus": the new kind.
fn new_there(tokens: &[Token]) -> Option<&[Token]> {
    let tokens = trimmed(tokens);
    if let Some(n) = leads(tokens, &["there should be", "there should have been", "it should be", "it should have been", "it was supposed to be", "i meant", "i wanted", "there must be", "make it"]) {
        let new = &tokens[n..];
        let (_, b) = kind(new)?;
        let late = trimmed(&new[b..]);
        return (late.is_empty() || leads(late, THERE) == Some(late.len())).then_some(&new[..b]);
    }
    let (_, b) = kind(tokens)?;
    is(tokens.first(), &["a", "an"]).then_some(())?;
    let n = leads(&tokens[b..], BELONGS)?;
    let late = trimmed(&tokens[b + n..]);
    (leads(late, THERE) == Some(late.len()) && !late.is_empty()).then_some(&tokens[..b])
}

/// "the car was a mistake; a bus belongs there".
fn belongs_there(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (end, n) = mistake(tokens)?;
    let new = new_there(tokens.get(n..)?)?;
    let np = &tokens[..end];
    (talk.fits(np) > 0).then(|| led("replace", &tokens[0], &[np, &led("with", &tokens[0], &[new])]))
}

/// "in exchange for", "in return for": instead of.
fn in_exchange(tokens: Vec<Token>) -> Vec<Token> {
    super::super::wording::replaced(
        &tokens,
        "in exchange for|in return for|in trade for|as a swap for|in swap for|in exchange against",
        "instead of",
    )
}

/// "the driver behind us has swapped his car for a bus", "the cyclist gets a moped instead of the bicycle".
fn own_swapped(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    // "give the cyclist a moped instead of the bicycle"
    let give = usize::from(is(tokens.first(), &["give", "hand"]));
    let rest = &tokens[give..];
    is(rest.first(), &["the", "that", "our", "my"]).then_some(())?;
    let (_, b) = first_noun(rest).filter(|x| x.0 < 4)?;
    let verb = (b..rest.len().min(b + 7)).find(|k| {
        is(
            rest.get(*k),
            &[
                "swapped", "swaps", "exchanged", "exchanges", "traded", "trades", "swap", "exchange", "trade", "gets",
                "get", "got", "receives", "rides", "drives", "takes", "has", "a",
            ],
        ) && (give == 1 && *k == b) == (text(&rest[*k]) == "a")
            && !(is(rest.get(*k), &["has"]) && is(rest.get(k + 1), &["swapped", "exchanged", "traded", "got"]))
    })?;
    let np = trimmed(&rest[..verb]);
    let helpers = np[b.min(np.len())..].iter().all(|t| is(Some(t), &["has", "have", "should", "must", "now", "just", "can"]) )
        || is_place(&np[b..]);
    let np: Vec<Token> = np.iter().filter(|t| !is(Some(t), &["has", "have", "should", "must", "now", "just", "can"])).cloned().collect();
    let swaps = text(&rest[verb]).starts_with("swap") || text(&rest[verb]).starts_with("exchange") || text(&rest[verb]).starts_with("trade");
    let own = |t: Option<&Token>| is(t, &["his", "her", "their", "its", "the"]);
    let after = &rest[verb + usize::from(give == 0)..];
    let new = if swaps {
        own(after.first()).then_some(())?;
        let k = after.iter().position(|t| is(Some(t), &["for", "against", "with"]))?;
        (1..5).contains(&k).then_some(())?;
        &after[k + 1..]
    } else {
        let (i, n) = find(after, &["instead of", "rather than", "in place of"])?;
        own(after.get(i + n)).then_some(())?;
        let (_, e) = first_noun(&after[i + n..]).filter(|x| x.0 < 3)?;
        trimmed(&after[i + n + e..]).is_empty().then_some(())?;
        &after[..i]
    };
    let new = trimmed(new);
    // (a driver is in what he gives away)
    let np = match first_noun(after).filter(|x| swaps && x.0 == 1) {
        Some(own) if is(rest.get(b - 1), &["driver", "motorist", "man", "woman", "person"]) => {
            [&rest[..1], &after[1..own.1], &np[b.min(np.len())..]].concat()
        }
        _ => np,
    };
    let (_, d) = kind(new).filter(|x| x.1 == new.len())?;
    (helpers && is(new.first(), &["a", "an"]) && talk.fits(&np) > 0)
        .then(|| led("replace", &tokens[0], &[&np, &led("with", &tokens[0], &[&new[..d]])]))
}

/// "make barriers out of the cones".
fn made_out_of(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    is(tokens.first(), &["make", "create", "form", "build"]).then_some(())?;
    let (_, b) = first_noun(&tokens[1..]).filter(|x| x.0 < 3)?;
    let new = &tokens[1..1 + b];
    let n = leads(&tokens[1 + b..], &["out of", "from", "of"])?;
    let old = trimmed(&tokens[1 + b + n..]);
    is(old.first(), &["the", "that", "all", "both", "these", "those"]).then_some(())?;
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    ((e == old.len() || is_place(&old[e..])) && !has_noun(&old[e..]) && talk.fits(old) > 0)
        .then(|| led("replace", &tokens[0], &[old, &led("with", &tokens[0], &[new])]))
}

/// "not come towards us but drive 15 m behind us": what it should do.
fn not_this_but(tokens: Vec<Token>) -> Vec<Token> {
    let Some((a, b)) = first_noun(&tokens).filter(|x| x.0 > 0 && x.0 < 4 && is(tokens.first(), &["the", "both", "all", "that", "my"])) else {
        return tokens;
    };
    let not = (b..tokens.len().min(b + 6)).find(|k| is(tokens.get(*k), &["not", "shouldnt", "mustnt", "doesnt", "dont"]));
    let but = not.and_then(|not| (not + 2..tokens.len()).find(|k| is(tokens.get(*k), &["but"])));
    let (Some(not), Some(but)) = (not, but) else {
        return tokens;
    };
    let k = but + 1 + leads(&tokens[but + 1..], &["rather", "instead", "should", "should be", "only", "just"]).unwrap_or(0);
    let rest = &tokens[k..];
    let does = rest.first().is_some_and(|t| super::words::is_finite(text(t), true)) && !is(rest.first(), &["is", "are", "has"]);
    let place = (1..rest.len().min(4)).any(|i| is_place(&rest[i..]));
    let denied = &tokens[not + 1..but];
    let did = denied.first().is_some_and(|t| super::words::is_finite(text(t), true));
    if !(does && place && did) || has_noun(denied) || denied.iter().any(|t| t.kind == TokenKind::Stop) || a > 3 {
        return tokens;
    }
    let helper = led("should", &tokens[not], &[]);
    [&tokens[..b], &helper, rest].concat()
}

/// "what bothers me is the motorcycle": the motorcycle.
fn what_bothers(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["what", "the only thing that", "the thing that", "one thing that", "all that"]) else {
        return tokens;
    };
    let is_at = (n + 1..tokens.len().min(n + 7)).find(|k| is(tokens.get(*k), &["is", "are"]));
    let bothers = tokens[n..is_at.unwrap_or(n)].iter().any(|t| {
        is(Some(t), &["bothers", "disturbs", "annoys", "irritates", "dislike", "hate", "worries", "spoils", "bugs", "troubles", "wrong", "bothering", "disturbing"])
            || is(Some(t), &["like"]) && tokens[n..is_at.unwrap_or(n)].iter().any(|t| is(Some(t), &["dont", "not"]))
    });
    match is_at {
        Some(k) if bothers && !has_noun(&tokens[n..k]) && is(tokens.get(k + 1), &["the", "that", "those", "these", "both", "all"]) => {
            tokens[k + 1..].to_vec()
        }
        _ => tokens,
    }
}

/// "three instead of two pedestrians on the left sidewalk": there should be three there.
fn so_many_instead(tokens: Vec<Token>) -> Vec<Token> {
    let there = leads(&tokens, &["there should be", "there are", "there must be", "i want", "i need", "we need", "make it", "id like"]).unwrap_or(0);
    let rest = &tokens[there..];
    let n = 1 + leads(rest.get(1..).unwrap_or(&[]), &["instead of", "rather than", "not", "and not", "in place of"]).unwrap_or(0);
    let count = |t: Option<&Token>| t.is_some_and(|t| number(t).is_some() && !is(Some(t), &["a", "an"]));
    let link = usize::from(n == 1 && rest.get(1).is_some_and(|t| t.kind == TokenKind::Comma) && is(rest.get(2), &["not"])) * 2;
    let n = n + link;
    if n == 1 || !count(rest.first()) || !count(rest.get(n)) {
        return tokens;
    }
    match first_noun(&rest[n + 1..]) {
        Some((a, b)) if a < 3 => {
            let late = &rest[n + 1 + b..];
            if late.is_empty() || is_place(late) {
                return led("there should be", &tokens[0], &[&rest[..1], &rest[n + 1..]]);
            }
            tokens
        }
        _ => tokens,
    }
}

/// "use a bus where the car is".
fn where_it_is(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(tokens, &["let", "use", "take", "show", "draw", "have", "i want", "i need", "id like", "there should be", "we need", "put", "place"])?;
    let new = &tokens[n..];
    let (_, b) = kind(new)?;
    is(new.first(), &["a", "an"]).then_some(())?;
    let stand = usize::from(is(new.get(b), &["stand", "be", "drive", "wait", "ride", "appear", "park"]));
    is(new.get(b + stand), &["where"]).then_some(())?;
    let old = &new[b + stand + 1..];
    is(old.first(), &["the", "that"]).then_some(())?;
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    let verb = (e..old.len()).find(|k| is(old.get(*k), &["is", "stands", "drives", "was", "stood"]))?;
    let late = trimmed(&old[verb + 1..]);
    let late_ok = late.is_empty() || is(late.first(), &["standing", "driving", "now", "parked", "at"]) && late.len() < 3;
    let np = trimmed(&old[..verb]);
    (late_ok && (verb == e || is_place(&old[e..verb])) && talk.fits(np) > 0)
        .then(|| led("replace", &tokens[0], &[np, &led("with", &tokens[0], &[&new[..b]])]))
}

/// "it's the bus that drives ahead of us now, and the cyclist who is behind us": the bus drives there, the cyclist is there.
fn the_one_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let now = usize::from(is(tokens.first(), &["now", "then"]));
    let Some(n) = leads(
        &tokens[now..],
        &["it is", "its", "it is now", "its now", "it should be", "it must be", "it was"],
    ) else {
        return tokens;
    };
    let rest = &tokens[now + n..];
    let which = |part: &[Token]| {
        is(part.first(), &["the", "my", "that"]).then_some(())?;
        let (_, b) = first_noun(part).filter(|x| x.0 < 4)?;
        is(part.get(b), WHICH).then_some(())?;
        let verb = super::words::is_finite(text(part.get(b + 1)?), true) || is(part.get(b + 1), &["is", "are", "has", "should"]);
        let place = (b + 2..part.len().min(b + 5)).any(|k| is_place(&part[k..]));
        (verb && place && talk.fits(&part[..b]) > 0).then_some(b)
    };
    let Some(b) = which(rest) else {
        return tokens;
    };
    let mut out = rest[..b].to_vec();
    let mut part = &rest[b + 1..];
    // ("and the cyclist who is behind us")
    while let Some(k) = (2..part.len()).find(|k| {
        is(part.get(k - 1), &["and", ","]) && which(&part[*k..]).is_some()
    }) {
        let c = which(&part[k..]).unwrap_or(1);
        out.extend_from_slice(&part[..k + c]);
        part = &part[k + c + 1..];
    }
    out.extend_from_slice(part);
    out
}
