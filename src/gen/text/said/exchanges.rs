//! One for another in roundabout words: "in the digger's place stands a van", "rather than one tanker, two cars are coming",
//! "where there was a woman there are now four people", "for just as many cones".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::lists::{EXCHANGING, HELPERS};
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = keep_and_rest(tokens, talk);
    let out = place_of(no_but(out, talk), talk);
    let out = where_is(where_was(out, talk), talk);
    let out = in_place_of(out, talk);
    let out = just_as_many(out, talk);
    told_again(out, talk)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

fn begins_clause(tokens: &[Token], i: usize) -> bool {
    i == 0 || ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and", "but", "then", "so"])
}

fn is_fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another"]) || t.is_some_and(|t| number(t).is_some())
}

/// "keep the emergency vehicles, lose the rest": only those stay, where all of their kind are named.
fn keep_and_rest(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(
        tokens.first(),
        &["keep", "leave", "retain", "spare", "save", "preserve"],
    ) {
        return tokens;
    }
    let found = (3..tokens.len()).find_map(|i| {
        let link = ends(tokens.get(i)) || is(tokens.get(i), &["and", "but"]);
        link.then_some(())?;
        let k = i + 1 + usize::from(is(tokens.get(i + 1), &["and", "but"]));
        let n = leads(
            &tokens[k..],
            &[
                "remove",
                "delete",
                "erase",
                "lose",
                "drop",
                "clear",
                "scrap",
                "discard",
                "take away",
                "get rid of",
                "throw out",
                "clear away",
                "do away with",
                "bin",
            ],
        )?;
        let m = leads(
            &tokens[k + n..],
            &[
                "the rest",
                "everything else",
                "all else",
                "anything else",
                "all the rest",
                "the remainder",
                "all other things",
                "every other thing",
            ],
        )?;
        let late = k + n + m;
        let closed = tokens[late..]
            .iter()
            .all(|t| ends(Some(t)) || is(Some(t), &["please", "away", "out"]));
        closed.then_some((i, is(tokens.get(k + n + m - 1), &["rest"])))
    });
    let Some((i, rest)) = found else {
        return tokens;
    };
    let np = &tokens[1..i];
    let Some((a, b)) = first_noun(np).filter(|x| x.0 < 5) else {
        return tokens;
    };
    // ("keep the nearest cone, remove the rest" speaks of cones)
    let fit = talk.fits(np);
    let whole = !rest || talk.fits(&np[a..b]) == fit;
    if fit == 0
        || !whole
        || !is(
            np.first(),
            &["the", "my", "both", "all", "these", "those", "that"],
        )
    {
        return tokens;
    }
    led("keep only", &tokens[0], &[np])
}

/// "no motorbike this time but a cyclist": the motorbike becomes one.
fn no_but(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &["no", "not a", "not the", "no longer a", "not a single"],
    ) else {
        return tokens;
    };
    let Some((0, b)) = first_noun(&tokens[n..]) else {
        return tokens;
    };
    let mut k = n + b;
    k += leads(
        &tokens[k..],
        &[
            "this time",
            "any more",
            "anymore",
            "any longer",
            "here",
            "there",
            "for once",
        ],
    )
    .unwrap_or(0);
    k += usize::from(tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma));
    let but = leads(&tokens[k..], &["but", "rather", "instead"]);
    let Some(new) = but
        .and_then(|m| tokens.get(k + m..))
        .filter(|x| is_fresh(x.first()))
    else {
        return tokens;
    };
    let Some((_, e)) = first_noun(new).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let tail = trimmed(&new[e..]);
    // ("on the left sidewalk", where it is)
    let there = is_place(tail) && !has_noun(tail) && {
        let np = [&tokens[n..n + b], tail].concat();
        talk.fits(&np) == talk.fits(&tokens[n..n + b])
    };
    let same = there
        || leads(
            tail,
            &[
                "coming the same way",
                "going the same way",
                "in the same place",
                "the same way",
                "in the same lane",
                "at the same place",
                "in the same spot",
                "on the same spot",
                "there",
            ],
        )
        .is_some();
    let old = talk.fits(&tokens[n..n + b]);
    let many = matches!(look_up(text(&tokens[n + b - 1])), Some(Sense::Noun(_, true)));
    if old == 0 || old > 1 && !many || !(tail.is_empty() || same && !has_noun(tail)) {
        return tokens;
    }
    let mut fresh = new[..e].to_vec();
    if old > 1 && is(fresh.first(), &["a", "an"]) {
        fresh[0].text = "one".into();
    }
    let with = led("with", &tokens[0], &[&fresh]);
    let many = Token {
        kind: TokenKind::Number(old as f64),
        text: old.to_string(),
        span: tokens[0].span,
    };
    let counted: &[Token] = if old > 1 { std::slice::from_ref(&many) } else { &[] };
    led("replace the", &tokens[0], &[counted, &tokens[n..n + b], &with])
}

/// "in the digger's place": in place of the digger.
fn place_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["in", "into", "on", "at", "to"]).then_some(())?;
        is(tokens.get(i + 1), &["the", "that"]).then_some(())?;
        let (_, b) = first_noun(&tokens[i + 2..]).filter(|x| x.0 < 3)?;
        let end = i + 2 + b;
        let place = is(tokens.get(end), &["place", "stead", "spot", "position"]);
        (place && talk.fits(&tokens[i + 1..end]) > 0).then_some((i, end))
    });
    // "two parked cars take the trailer's place"
    let takes = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["take", "takes", "took", "fill", "fills"]).then_some(())?;
        is(tokens.get(i + 1), &["the", "that"]).then_some(())?;
        let (_, b) = first_noun(&tokens[i + 2..]).filter(|x| x.0 < 3)?;
        let end = i + 2 + b;
        let place = is(tokens.get(end), &["place", "spot", "position"]);
        let new = is_fresh(tokens.first()) && first_noun(&tokens[..i]).is_some_and(|x| x.1 == i);
        (place && new && talk.fits(&tokens[i + 1..end]) > 0).then_some((i, end))
    });
    if let Some((i, end)) = takes {
        let of = led("stand in place of", &tokens[i], &[&tokens[i + 1..end]]);
        return [&tokens[..i], &of, &tokens[end + 1..]].concat();
    }
    // "the cyclist's place is taken by a bus"
    let taken = first_noun(&tokens)
        .filter(|x| x.0 < 3 && is(tokens.first(), &["the", "that"]))
        .and_then(|(_, b)| {
            let n = leads(
                &tokens[b..],
                &[
                    "place is taken by",
                    "place is now taken by",
                    "place has been taken by",
                    "place was taken by",
                    "place should be taken by",
                    "spot is taken by",
                    "spot has been taken by",
                    "place goes to",
                    "spot goes to",
                    "place belongs to",
                ],
            )?;
            (is_fresh(tokens.get(b + n)) && talk.fits(&tokens[..b]) > 0).then_some((b, b + n))
        });
    if let Some((b, new)) = taken {
        let with = led("with", &tokens[b], &[&tokens[new..]]);
        return led("replace", &tokens[0], &[&tokens[..b], &with]);
    }
    match found {
        Some((i, end)) => {
            let of = led("in place of", &tokens[i], &[&tokens[i + 1..end]]);
            [&tokens[..i], &of, &tokens[end + 1..]].concat()
        }
        None => tokens,
    }
}

/// The noun phrase of what goes, as one that is known: "one woman", "a woman" and "the woman" alike.
fn known(np: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let np = trimmed(np);
    let mut k = 0;
    while is(
        np.get(k),
        &[
            "just", "only", "the", "that", "this", "a", "an", "our", "my", "those", "these",
        ],
    ) {
        k += 1;
    }
    let many = np.get(k).and_then(number);
    k += usize::from(many.is_some());
    let body = np.get(k..).filter(|b| first_noun(b).is_some_and(|x| x.0 < 3))?;
    let there = talk.fits(body);
    let all = many.is_none_or(|m| m.max(0) as usize == there);
    let one = is(np.first(), &["a", "an"]) || many == Some(1);
    let counted = &np[k - usize::from(many.is_some_and(|n| n > 1))..k];
    (there > 0 && all && (!one || there == 1)).then(|| led("the", &np[0], &[counted, body]))
}

/// What is said of the new one, as a clause about it: "with its front towards us" and "comes towards us" alike.
fn said_of(tail: &[Token], many: bool) -> Option<Vec<Token>> {
    let tail = trimmed(tail);
    let Some(first) = tail.first() else {
        return Some(Vec::new());
    };
    let front = leads(
        tail,
        &[
            "with its front",
            "with the front",
            "with its nose",
            "with its bonnet",
            "with his face",
            "with her face",
            "with their faces",
            "with its headlights",
            "with their fronts",
        ],
    );
    if let Some(n) = front {
        let turned = tail.get(n..).filter(|r| {
            is(
                r.first(),
                &["towards", "toward", "to", "facing", "pointing", "turned"],
            )
        })?;
        let us = is(turned.last(), &["us", "me"]);
        return us.then(|| led(", and it faces us", first, &[]));
    }
    let mut k = 0;
    while tail
        .get(k)
        .is_some_and(|t| HELPERS.contains(&text(t)) || is(Some(t), &["now", "still", "there"]))
    {
        k += 1;
    }
    let rest = trimmed(&tail[k..]);
    if rest.is_empty() || is(rest.first(), &["stands", "stand", "standing"]) && rest.len() == 1 {
        return Some(Vec::new());
    }
    let moves = k > 0 || is_finite(text(&rest[0]), true);
    if !moves && !is_place(rest) {
        return None;
    }
    // (where the old one was is where the new one is)
    let still = tail.iter().any(|t| text(t) == "still");
    if still {
        return Some(Vec::new());
    }
    let lead = match (many, moves && k == 0) {
        (true, true) => ", and they",
        (false, true) => ", and it",
        (true, false) => ", and they are",
        (false, false) => ", and it is",
    };
    Some(led(lead, first, &[rest]))
}

/// The command that puts the new in the place of the old, with what is said of the new.
fn exchange(old: Vec<Token>, new: &[Token]) -> Option<(Vec<Token>, usize)> {
    let (_, b) = first_noun(new).filter(|x| x.0 < 4 && is_fresh(new.first()))?;
    let close = (b..new.len())
        .find(|k| ends(new.get(*k)) || is(new.get(*k), &["and", "but"]))
        .unwrap_or(new.len());
    // "four people, still on the left sidewalk"
    let still =
        is(new.get(close + 1), &["still"]) && is_place(&new[close + 2..]) && !has_noun(&new[close + 2..]);
    let end = if still { new.len() } else { close };
    let many = number(&new[0]).is_some_and(|n| n > 1);
    let mut tail = said_of(&new[b..end], many)?;
    if let Some(comma) = tail.first_mut() {
        comma.kind = TokenKind::Comma;
    }
    // "instead of the two men a woman": one for both
    let several = old.iter().any(|t| number(t).is_some_and(|n| n > 1));
    let mut fresh = new[..b].to_vec();
    if several && is(fresh.first(), &["a", "an"]) {
        fresh[0].text = "one".into();
    }
    let with = led("with", &new[0], &[&fresh, &tail]);
    Some((led("replace", &old[0], &[&old, &with]), end))
}

/// "where there was one woman there are now four people".
fn where_was(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "where there was",
            "where there were",
            "where there used to be",
            "where there had been",
            "where once there was",
            "where once stood",
            "where there stood",
            "where before there was",
            "where formerly there was",
            "where until now there was",
        ],
    ) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let Some(old) = known(&tokens[n..n + b], talk) else {
        return tokens;
    };
    let mut k = n + b;
    while k < tokens.len() && !is_fresh(tokens.get(k)) {
        let small = ends(tokens.get(k))
            || HELPERS.contains(&text(&tokens[k]))
            || is(
                tokens.get(k),
                &[
                    "there", "now", "we", "see", "stands", "stand", "i", "want", "like", "before", "once",
                ],
            );
        if !small {
            return tokens;
        }
        k += 1;
    }
    match exchange(old, tokens.get(k..).unwrap_or_default()) {
        Some((out, end)) => [&out, &tokens[k + end..]].concat(),
        None => tokens,
    }
}

/// "use barriers where the cones are now": those become these.
fn where_is(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const REST: &str = "is|are|is now|are now|is at present|are at present|is right now|are right now|is at the moment|are at the moment|stands|stand|stands now|stand now|is standing|are standing|is currently|are currently|currently is|currently are|currently stands|currently stand|now stands|now stand|now is|now are|was|were|was before|were before|used to be|used to stand|stood|stood before|is parked|are parked|drives|drives now|waits|sits|sit";
    let uses = is(tokens.first(), &["use", "take"]);
    let Some((_, b)) = first_noun(&tokens[..tokens.len().min(6)]).filter(|_| uses) else {
        return tokens;
    };
    let new = &tokens[1..b];
    let at = is(tokens.get(b), &["where"]) && !is(new.first(), &["the", "that", "those", "both"]);
    let Some((_, e)) = tokens.get(b + 1..).and_then(first_noun).filter(|x| at && x.0 < 4) else {
        return tokens;
    };
    let (old, rest) = (&tokens[b + 1..b + 1 + e], &tokens[b + 1 + e..]);
    let told = begins(rest, REST).is_some_and(|n| trimmed(&rest[n..]).is_empty());
    match known(old, talk).filter(|_| told) {
        Some(old) => led("replace", &tokens[0], &[&old, &led("with", &tokens[b], &[new])]),
        None => tokens,
    }
}

/// "in place of the bus a cyclist comes towards us", "rather than one tanker, two cars are coming the other way".
fn in_place_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &["in place of", "rather than", "instead of", "in lieu of"],
        )
        .filter(|_| begins_clause(&tokens, i))?;
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
        let old = known(&tokens[i + n..i + n + b], talk)?;
        let mut k = i + n + b;
        let mut verbs = 0;
        while tokens.get(k).is_some_and(|t| {
            ends(Some(t))
                || HELPERS.contains(&text(t))
                || is(
                    Some(t),
                    &[
                        "there", "now", "we", "see", "stands", "stand", "comes", "come", "drives", "i",
                        "want", "like", "sits", "waits",
                    ],
                )
        }) && !is_fresh(tokens.get(k))
        {
            verbs += usize::from(tokens[k].kind == TokenKind::Word);
            k += 1;
        }
        let new = tokens.get(k..).filter(|x| is_fresh(x.first()))?;
        let (_, e) = first_noun(new).filter(|x| x.0 < 4)?;
        // others read what says no more than the two
        let close = (e..new.len()).find(|j| ends(new.get(*j))).unwrap_or(new.len());
        let tail = trimmed(&new[e..close]);
        let counted = is(tokens.get(i + n), &["one", "a", "an", "just", "only"]);
        (i > 0 || counted || verbs < 3 && !tail.is_empty() && !is(tail.first(), &["and"])).then_some(())?;
        let (out, end) = exchange(old, new)?;
        Some((i, out, k + end))
    });
    match found {
        Some((i, out, end)) => [&tokens[..i], &out, &tokens[end..]].concat(),
        None => tokens,
    }
}

/// "exchange the three barriers for just as many cones": for three.
fn just_as_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "just as many",
            "exactly as many",
            "equally many",
            "as many",
            "the same number of",
            "the same amount of",
            "an equal number of",
            "the very same number of",
        ],
    )
    .filter(|x| x.0 > 2 && is(tokens.get(x.0 - 1), &["for", "by", "with", "into"])) else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(|t| {
        is_verb(t) || EXCHANGING.contains(&text(t)) || is(Some(t), &["replaced", "exchanged", "swapped"])
    });
    let np = &tokens[from.map_or(0, |f| f + 1)..i - 1];
    let end = i + n;
    let new = first_noun(&tokens[end..]).filter(|x| x.0 < 3);
    let Some((_, b)) = new else {
        return tokens;
    };
    let goes_on = is(tokens.get(end + b), &["as"]);
    let many = talk.fits(np);
    if goes_on || from.is_none() || !has_noun(np) || many == 0 || many > 40 {
        return tokens;
    }
    let digit = Token {
        kind: TokenKind::Number(many as f64),
        text: many.to_string(),
        span: tokens[i].span,
    };
    [&tokens[..i], &[digit], &tokens[end..]].concat()
}

/// "switch the bus and the car: the car in front of us, the bus behind": what follows says it again.
fn told_again(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(
        tokens.first(),
        &["switch", "swap", "exchange", "interchange", "swop"],
    ) {
        return tokens;
    }
    let Some(cut) = (3..tokens.len()).find(|k| {
        text(&tokens[*k]) == ":" || tokens[*k].kind == TokenKind::Comma || is(tokens.get(*k), &["so"])
    }) else {
        return tokens;
    };
    let (head, tail) = (&tokens[1..cut], &tokens[cut..]);
    let nouns = |list: &[Token]| {
        let mut out: Vec<String> = Vec::new();
        let mut from = 0;
        while let Some((a, b)) = first_noun(&list[from..]) {
            out.push(text(&list[from + b - 1]).to_string());
            debug_assert!(a < b);
            from += b;
        }
        out
    };
    let (two, again) = (nouns(head), nouns(tail));
    let and = head.iter().filter(|t| is(Some(t), &["and", "with"])).count() == 1;
    let same = two.len() == 2 && !again.is_empty() && again.iter().all(|w| two.contains(w));
    let plain = !tail
        .iter()
        .any(|t| is_verb(t) && !is_place(std::slice::from_ref(t)) || number(t).is_some());
    let one_each = first_noun(head).is_some_and(|x| talk.fits(&head[..x.1]) == 1);
    if and && same && plain && one_each {
        return tokens[..cut].to_vec();
    }
    tokens
}
