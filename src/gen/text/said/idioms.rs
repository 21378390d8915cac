//! Turns of speech with a noun or a number in them, as the commands that they stand for: "out with the bikes, in
//! with as many vans", "I've changed my mind about the bus", "in addition to the cars I want four more".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::{HELPERS, NEGATED};
use super::some_of::{WISHES, bare_np, removes};
use super::words::{find, first_noun, is, is_finite, leads, led, number, text, trimmed};

/// The sentence in plain words, if it is one of them.
pub fn plain(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let tokens = trimmed(tokens);
    let about = changed_mind(tokens);
    let tokens = about.unwrap_or(tokens);
    if let Some(new) = intention(tokens).or_else(|| stands_in(tokens)) {
        return Some(new);
    }
    super::remaining::plain(tokens)
        .or_else(|| super::some_of::plain(tokens, talk))
        .or_else(|| not_but(tokens))
        .or_else(|| out_and_in(tokens))
        .or_else(|| besides(tokens))
        .or_else(|| let_it_be(tokens, talk))
        .or_else(|| nobody_but(tokens))
        .or_else(|| likewise(tokens))
        .or_else(|| step_with(tokens))
        .or_else(|| none_there(tokens))
        .or_else(|| about.map(<[Token]>::to_vec))
}

/// "the digger is to be taken out, and likewise the barriers": the same is said of those.
fn likewise(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "and likewise",
            "likewise",
            "and so do",
            "and so does",
            "and so should",
            "and so must",
            "and so are",
            "so do",
            "so should",
            "so are",
            "as do",
            "as does",
            "as should",
            "as are",
            "and also",
            "as must",
            "as is",
            "and so is",
            "and equally",
            "and similarly",
        ],
    )?;
    let np = trimmed(&tokens[i + n..]);
    let definite = is(
        np.first(),
        &["the", "both", "all", "every", "that", "those", "these", "my"],
    );
    let plain = np
        .iter()
        .all(|t| !HELPERS.contains(&text(t)) || is(Some(t), &["both", "all"]));
    let before = trimmed(&tokens[..i]);
    let (_, b) = first_noun(before).filter(|x| x.0 < 5)?;
    let verb = (b..before.len())
        .find(|k| HELPERS.contains(&text(&before[*k])) || is_finite(text(&before[*k]), true))?;
    let and = led("and", &tokens[i], &[np, &before[verb..]]);
    (definite && plain && first_noun(np).is_some()).then(|| [before, &and].concat())
}

/// "ten metres further ahead with the bus": a step, and of what.
fn step_with(tokens: &[Token]) -> Option<Vec<Token>> {
    let k = (1..tokens.len()).rev().find(|k| text(&tokens[*k]) == "with")?;
    let np = trimmed(&tokens[k + 1..]);
    let known = is(np.first(), &["the", "that", "my", "both", "this"]);
    let (_, b) = first_noun(np).filter(|x| x.0 < 4)?;
    let step = trimmed(&tokens[..k]);
    let way = step.iter().any(|t| {
        matches!(
            text(t),
            "further"
                | "farther"
                | "closer"
                | "nearer"
                | "back"
                | "forward"
                | "left"
                | "right"
                | "ahead"
                | "behind"
                | "away"
                | "lane"
        )
    });
    let plain = first_noun(step).is_none()
        && !step.iter().any(|t| HELPERS.contains(&text(t)))
        && !super::super::rephrase::is_verb(step.first()?);
    let bare = !is(step.first(), &["out", "away", "off", "down", "up"]);
    (known && b == np.len() && way && plain && bare).then(|| led("move", &tokens[0], &[np, step]))
}

/// "no pedestrians on the left any more".
fn none_there(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, &["no more", "no"])?;
    let (a, b) = first_noun(&tokens[n..]).filter(|x| x.0 < 3)?;
    let rest = trimmed(&tokens[n + b..]);
    let end = find(rest, &["any more", "anymore", "any longer", "please", "now"]).map_or(rest.len(), |x| x.0);
    let place = trimmed(&rest[..end]);
    let placed = super::words::is_place(place)
        && !place.iter().any(|t| t.kind == TokenKind::Comma)
        && first_noun(place).is_none();
    (placed && !is(place.first(), &["to", "by", "up", "out", "off"]))
        .then(|| led("remove all the", &tokens[0], &[&tokens[n + a..n + b], place]))
}

/// "I've changed my mind about the bus, make it a van": of the bus.
fn changed_mind(tokens: &[Token]) -> Option<&[Token]> {
    let n = leads(
        tokens,
        &[
            "ive changed my mind about",
            "i have changed my mind about",
            "i changed my mind about",
            "as for",
            "as regards",
            "regarding",
            "concerning",
            "when it comes to",
            "with regard to",
            "as to",
            "about",
            "a word about",
            "what about",
            "second thoughts about",
            "on second thought about",
            "ive had second thoughts about",
        ],
    )?;
    let known = is(tokens.get(n), &["the", "that", "those", "these", "both", "my"]);
    let (_, end) = first_noun(&tokens[n..]).filter(|x| x.0 < 4)?;
    let parted = tokens[n + end..]
        .iter()
        .any(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark));
    (known && parted).then(|| &tokens[n..])
}

/// "has done its job, so remove it": a reason for what is asked. How many tokens its verb takes.
fn reason(rest: &[Token]) -> Option<usize> {
    let (so, n) =
        find(rest, &["so", "therefore", "hence", "thats why", "that is why"]).filter(|x| x.0 > 1)?;
    let gone = removes(rest.get(so + n)) || leads(&rest[so + n..], &["get rid of", "do away with"]).is_some();
    (gone && HELPERS.contains(&text(&rest[0]))).then_some(1)
}

/// "the driver of the van wants to take a break, so park his vehicle": what somebody is after changes nothing; what is asked for does.
fn intention(tokens: &[Token]) -> Option<Vec<Token>> {
    let tokens = &super::spoken::with_ones(tokens)[..];
    let (_, end) = first_noun(tokens).filter(|x| x.0 < 6)?;
    let wants = end
        + leads(
            &tokens[end..],
            &[
                "wants to",
                "want to",
                "needs to",
                "need to",
                "is about to",
                "are about to",
                "would like to",
                "plans to",
                "plan to",
                "intends to",
                "intend to",
                "is going to",
                "are going to",
                "hopes to",
                "has to",
                "wants a",
                "needs a",
            ],
        )
        .or_else(|| reason(&tokens[end..]))?;
    let cut = (wants..tokens.len()).find(|k| {
        matches!(tokens[*k].kind, TokenKind::Comma | TokenKind::Mark)
            || is(tokens.get(*k), &["so", "therefore"])
    })?;
    let mut from = cut;
    while tokens.get(from).is_some_and(|t| {
        t.kind != TokenKind::Word
            || matches!(text(t), "so" | "therefore" | "then" | "please" | "and" | "hence")
    }) {
        from += 1;
    }
    let rest = tokens.get(from..)?;
    let aim = &tokens[wants..cut];
    let who = &tokens[..end];
    let definite = is(
        who.first(),
        &["the", "all", "both", "my", "that", "those", "these"],
    );
    let orders = super::super::rephrase::is_verb(rest.first()?) || is(rest.first(), &["have", "let", "get"]);
    if !definite || !orders {
        return None;
    }
    let at =
        (1..rest.len()).find(|k| is(rest.get(*k), &["it", "him", "her", "them", "his", "their", "its"]))?;
    let own = is(rest.get(at), &["his", "her", "their", "its"])
        || is(rest.get(at), &["her"]) && is(rest.get(at + 1), &["vehicle", "car"]);
    // ("have her stand there": she)
    let own =
        own && !(is(rest.get(at), &["her"]) && rest.get(at + 1).is_some_and(|t| is_finite(text(t), true)));
    let thing = usize::from(is(rest.get(at + 1), &["vehicle", "car", "machine", "ride"]));
    if own && thing == 0 {
        return None;
    }
    // "are about to board the bus: bring them near it"
    let other = first_noun(aim).map(|n| led("the", &tokens[0], &[&aim[n.0..n.1]]));
    // several are no "it": "the people want to board the bus, so bring it back and let them wait"
    let several = matches!(
        who.last().and_then(|t| look_up(text(t))),
        Some(Sense::Noun(_, true))
    );
    if several && is(rest.get(at), &["it", "its"]) {
        let other = other.filter(|_| is(rest.get(at), &["it"]))?;
        let mut out = [&rest[..at], &other[..]].concat();
        for t in &rest[at + 1..] {
            match text(t) {
                "them" => out.extend_from_slice(who),
                _ => out.push(t.clone()),
            }
        }
        return Some(out);
    }
    let mut out = rest[..at].to_vec();
    out.extend_from_slice(who);
    for t in &rest[at + 1 + if own { thing } else { 0 }..] {
        match &other {
            Some(other) if text(t) == "it" => out.extend(other.iter().cloned()),
            _ => out.push(t.clone()),
        }
    }
    Some(out)
}

/// "in place of the digger there is now a roller, and it ...": the digger is replaced, and the rest is said of what replaces it.
fn stands_in(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "in place of",
            "instead of",
            "in the place of",
            "in lieu of",
            "in exchange for",
        ],
    )?;
    let known = is(tokens.get(n), &["the", "that", "both", "my", "all", "those"]);
    let (_, b) = first_noun(&tokens[n..]).filter(|x| x.0 < 5)?;
    let rest = trimmed(&tokens[n + b..]);
    let mut k = leads(rest, WISHES).or_else(|| {
        leads(
            rest,
            &[
                "there is",
                "there comes",
                "there stands",
                "comes",
                "stands",
                "there are",
                "we have",
                "we now have",
                "we see",
            ],
        )
    })?;
    while is(rest.get(k), &["now", "then", "to", "see", "just"]) {
        k += 1;
    }
    let fresh = is(rest.get(k), &["a", "an", "another"]) || number(rest.get(k)?).is_some();
    let (_, e) = first_noun(&rest[k..]).filter(|x| x.0 < 4)?;
    let more = rest.get(k + e..).filter(|m| {
        m.first()
            .is_some_and(|t| t.kind == TokenKind::Comma || text(t) == "and")
            && m.len() > 3
    })?;
    let with = led("with", &tokens[0], &[&rest[k..k + e], more]);
    (known && fresh).then(|| led("replace", &tokens[0], &[&tokens[n..n + b], &with]))
}

/// "there shouldn't be anybody here, just the cars": what is to be there is there.
fn nobody_but(tokens: &[Token]) -> Option<Vec<Token>> {
    let denied = tokens
        .iter()
        .take(6)
        .any(|t| NEGATED.contains(&text(t)) || matches!(text(t), "nobody" | "no" | "nothing"));
    let comma = (2..tokens.len()).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            && is(tokens.get(k + 1), &["just", "only", "but", "except"])
            && is(tokens.get(k + 2), &["the", "for", "those", "these", "my"])
    })?;
    let people = tokens[..comma].iter().any(|t| {
        matches!(
            text(t),
            "anybody" | "anyone" | "nobody" | "people" | "person" | "pedestrians" | "persons"
        )
    });
    let (_, e) = first_noun(&tokens[comma..]).filter(|x| x.0 < 6)?;
    (denied && people).then(|| [&tokens[..comma], &tokens[comma + e..]].concat())
}

/// "what waits there shouldn't be a car but a bus": what it shall be.
fn not_but(tokens: &[Token]) -> Option<Vec<Token>> {
    let but = (3..tokens.len())
        .find(|k| is(tokens.get(*k), &["but"]) && is(tokens.get(k + 1), &["a", "an", "two", "three"]))?;
    let not = (0..but).rev().find(|k| NEGATED.contains(&text(&tokens[*k])))?;
    let old = first_noun(&tokens[not..but])?;
    let article = tokens[not..not + old.0]
        .iter()
        .any(|t| matches!(text(t), "a" | "an"));
    if old.0 > 4 || not + old.1 != but || !article {
        return None;
    }
    let mut from = not;
    while from > 0 && HELPERS.contains(&text(&tokens[from - 1])) {
        from -= 1;
    }
    let subject = trimmed(&tokens[..from]);
    if subject.is_empty() {
        return None;
    }
    let old = &tokens[not + old.0..not + old.1];
    let what = leads(
        subject,
        &[
            "what is",
            "whats",
            "whatever is",
            "what",
            "the thing that is",
            "the thing",
            "the one that is",
        ],
    );
    let who = match what {
        // "that isn't a bus but a truck"
        None if subject.len() == 1 && is(subject.first(), &["that", "it", "this"]) => {
            led("the", &tokens[0], &[old])
        }
        Some(n) => led("the", &tokens[0], &[old, &subject[n..]]),
        None => subject.to_vec(),
    };
    Some([&who[..], &led("should be", &tokens[but], &[&tokens[but + 1..]])].concat())
}

/// "out with the bikes, in with as many vans".
fn out_and_in(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "out with",
            "away with",
            "off with",
            "down with",
            "enough of",
            "no more",
            "lose",
            "out go",
            "out goes",
        ],
    )?;
    let (i, m) = find(
        tokens,
        &[
            "in with", "on with", "up with", "bring in", "in come", "in comes", "in go", "in goes",
            "hello to",
        ],
    )?;
    let old = trimmed(tokens.get(n..i)?);
    let mut new = trimmed(&tokens[i + m..]);
    let as_many = leads(
        new,
        &[
            "just as many",
            "as many",
            "equally many",
            "the same number of",
            "an equal number of",
            "exactly as many",
            "some",
            "the",
        ],
    );
    new = &new[as_many.unwrap_or(0)..];
    let (old_noun, new_noun) = (first_noun(old)?, first_noun(new)?);
    let one = old
        .iter()
        .take(old_noun.0)
        .any(|t| matches!(text(t), "the" | "that" | "this" | "my"))
        && !matches!(look_up(text(&old[old_noun.1 - 1])), Some(Sense::Noun(_, true)));
    let lead = if one { "replace the" } else { "replace all the" };
    let with = led("with", &tokens[0], &[&new[..new_noun.1.max(1)]]);
    Some(led(lead, &tokens[0], &[&bare_np(old), &with]))
}

/// "in addition to the cars that are coming I want four more".
fn besides(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "in addition to",
            "besides",
            "apart from",
            "on top of",
            "as well as",
            "along with",
            "beside",
            "aside from",
            "next to having",
        ],
    )?;
    let (w, m) = find(tokens, WISHES).filter(|w| w.0 > n)?;
    let (a, b) = first_noun(&tokens[n..w]).map(|x| (n + x.0, n + x.1))?;
    let rest = trimmed(&tokens[w + m..]);
    let k = rest
        .iter()
        .position(|t| number(t).is_some() || is(Some(t), &["another", "a", "an"]))
        .filter(|k| *k < 2)?;
    let more = is(
        rest.get(k + 1),
        &["more", "others", "additional", "extra", "further"],
    );
    let own = first_noun(&rest[k..]).is_some_and(|x| x.0 < 4);
    if is(tokens.get(n), &["me", "us"]) || a > n + 4 {
        return None;
    }
    let tail = trimmed(&rest[k + 1 + usize::from(more)..]);
    let noun: &[Token] = if own { &[] } else { &tokens[a..b] };
    Some(led("add", &tokens[0], &[&rest[k..=k], noun, tail]))
}

/// "let it be three motorbikes coming towards me".
fn let_it_be(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "let it be",
            "let that be",
            "let there be",
            "let those be",
            "let them be",
        ],
    )?;
    let rest = &tokens[n..];
    let counted = number(rest.first()?).is_some() || is(rest.first(), &["a", "an", "some"]);
    let (a, b) = first_noun(rest).filter(|x| x.0 < 4)?;
    (counted && talk.fits(&rest[a..b]) == 0).then(|| led("add", &tokens[0], &[rest]))
}
