//! What there is instead of what was said: "what was driving there were two trucks, not two cars", "it was not a bus but a tanker",
//! "our fleet has grown: six parked cars now".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::some_of::{bare_np, removes};
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    was_not(now_so_many(happier(none_left(not_but(tokens))), talk), talk)
}

/// "the jogger isn't on the pavement at all but in our lane": he should be in our lane.
fn not_but(tokens: Vec<Token>) -> Vec<Token> {
    const NOT: &[&str] = &[
        "isnt", "is not", "arent", "are not", "wasnt", "was not", "werent", "were not",
    ];
    let Some((i, n)) = find(&tokens, NOT).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let but = (i + n + 1..tokens.len()).find(|k| is(tokens.get(*k), &["but"]));
    let known = is(
        tokens.first(),
        &[
            "the", "both", "all", "that", "my", "those", "he", "she", "it", "they",
        ],
    );
    let Some(but) = but.filter(|_| known && is_place(&tokens[i + n..])) else {
        return tokens;
    };
    let at_all = is(tokens.get(but - 1), &["all", "anymore", "longer", "more"]);
    let rest = &tokens[but + 1..];
    if at_all && is_place(rest) {
        [&tokens[..i], &led("should be", &tokens[i], &[rest])].concat()
    } else {
        tokens
    }
}

/// "no child is on the left any more, they're all on the crossing": all of them are there, and none has gone away.
fn none_left(tokens: Vec<Token>) -> Vec<Token> {
    const THEY: &[&str] = &[
        "they are all",
        "theyre all",
        "they all are",
        "all of them are",
        "they are",
        "theyre",
        "all are",
        "they all stand",
        "all of them stand",
    ];
    let no = leads(&tokens, &["no", "not a single", "not one", "none of the"]);
    let Some((n, (_, b))) = no.and_then(|n| Some((n, first_noun(&tokens[n..]).filter(|x| x.0 < 3)?))) else {
        return tokens;
    };
    let later = (n + b..tokens.len()).find_map(|k| {
        (tokens[k].kind != TokenKind::Word || is(tokens.get(k), &["but", "as", "because"])).then_some(())?;
        let they = k + 1 + usize::from(is(tokens.get(k + 1), &["but", "because"]));
        leads(tokens.get(they..)?, THEY).map(|m| they + m)
    });
    match later {
        Some(at) if is_place(&tokens[at..]) => led(
            "all",
            &tokens[0],
            &[
                &tokens[n..n + b],
                &led("should be", &tokens[at], &[&tokens[at..]]),
            ],
        ),
        _ => tokens,
    }
}

/// "I'd feel better with the motorcycle in front of us rather than behind": it should be there.
fn happier(tokens: Vec<Token>) -> Vec<Token> {
    const HAPPY: &[&str] = &[
        "id feel better with",
        "i would feel better with",
        "id feel safer with",
        "i would feel safer with",
        "id be happier with",
        "i would be happier with",
        "wed be happier with",
        "it would be better with",
        "itd be better with",
        "it would look better with",
        "it looks better with",
        "it would be nicer with",
        "we would be better off with",
        "id be better off with",
    ];
    let Some((n, (_, b))) =
        leads(&tokens, HAPPY).and_then(|n| Some((n, first_noun(&tokens[n..]).filter(|x| x.0 < 4)?)))
    else {
        return tokens;
    };
    let place = &tokens[n + b..];
    let known = is(tokens.get(n), &["the", "both", "all", "that", "my"]);
    if !known || !is_place(place) {
        return tokens;
    }
    // (where it was until now)
    let than =
        (2..place.len()).find(|k| leads(&place[*k..], &["rather than", "instead of", "than"]).is_some());
    let place = match than {
        Some(k) if !has_noun(&place[k..]) => &place[..k],
        _ => place,
    };
    [&tokens[n..n + b], &led("should be", &tokens[n], &[place])].concat()
}

/// "what was driving in the left lane were two trucks, not two cars": the cars there are trucks.
fn was_not(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if let Some(new) = not_that(&tokens, talk)
        .or_else(|| it_was(&tokens, talk))
        .or_else(|| what_does(&tokens, talk))
    {
        return new;
    }
    const BE: &[&str] = &[
        "was",
        "were",
        "is",
        "are",
        "had been",
        "has been",
        "have been",
        "in fact was",
        "in fact were",
        "really was",
        "really were",
        "actually was",
        "actually were",
    ];
    let Some(from) = (0..tokens.len().min(6)).find(|k| is(tokens.get(*k), &["what", "whatever", "who"]))
    else {
        return tokens;
    };
    let Some(not) = (from + 4..tokens.len())
        .rev()
        .find(|k| is(tokens.get(*k), &["not"]))
    else {
        return tokens;
    };
    let old = &tokens[not + 1..];
    let fresh = |np: &[Token]| {
        np.first()
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an"]))
            && first_noun(np).is_some_and(|x| x.0 < 4 && x.1 == np.len())
    };
    let Some((at, n)) = (from + 3..not).rev().find_map(|k| {
        let n = leads(&tokens[k..], BE)?;
        fresh(trimmed(&tokens[k + n..not])).then_some((k, n))
    }) else {
        return tokens;
    };
    let new = trimmed(&tokens[at + n..not]);
    let Some(place) = (from + 2..at.min(from + 5)).find(|k| is_place(&tokens[*k..at])) else {
        return tokens;
    };
    let place = &tokens[place..at];
    if !fresh(old) || has_noun(place) {
        return tokens;
    }
    let old: Vec<Token> = bare_np(old)
        .into_iter()
        .filter(|t| !is(Some(t), &["a", "an"]))
        .collect();
    let there = [&old[..], place].concat();
    let np = if talk.fits(&there) > 0 { there } else { old };
    if talk.fits(&np) == 0 {
        return tokens;
    }
    led(
        "replace the",
        &tokens[from],
        &[&np, &led("with", &tokens[not], &[new])],
    )
}

/// "it was not a bus that was ahead of me but a tanker": the bus there is a tanker.
fn not_that(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &["it was not", "it is not", "it wasnt", "it isnt", "it were not"],
    )?;
    is(tokens.get(n), &["a", "an", "the"]).then_some(())?;
    let (_, b) = first_noun(&tokens[n..]).filter(|x| x.0 < 4)?;
    let that = n + b;
    is(tokens.get(that), &["that", "which", "who"]).then_some(())?;
    let but = (that + 2..tokens.len()).find(|k| is(tokens.get(*k), &["but"]))?;
    let place = (that + 1..but.min(that + 4)).find(|k| is_place(&tokens[*k..but]))?;
    let place = trimmed(&tokens[place..but]);
    let new = trimmed(&tokens[but + 1..]);
    let fresh = is(new.first(), &["a", "an"]) && first_noun(new).is_some_and(|x| x.0 < 4 && x.1 == new.len());
    let np = [&tokens[n + 1..that], place].concat();
    (fresh && !has_noun(place) && talk.fits(&np) > 0).then(|| {
        led(
            "replace the",
            &tokens[0],
            &[&np, &led("with", &tokens[but], &[new])],
        )
    })
}

/// "it was a pickup that was following us, not a car": the car that was is a pickup.
fn it_was(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "it is",
            "its",
            "it was",
            "that is",
            "thats",
            "that was",
            "it has to be",
            "it should be",
            "it must be",
            "it should have been",
            "it must have been",
            "it had been",
            "it is actually",
            "its actually",
            "it was actually",
            "it was in fact",
            "it is in fact",
            "it was really",
            "it is really",
            "its really",
        ],
    )?;
    let new = &tokens[n..];
    let (_, b) = first_noun(new).filter(|x| x.0 < 4 && is_new(new))?;
    let not = (n + b..tokens.len()).find(|k| {
        is(tokens.get(*k), &["not"]) && matches!(tokens[k - 1].kind, TokenKind::Comma | TokenKind::Mark)
    })?;
    let old = trimmed(&tokens[not + 1..]);
    let article = usize::from(is(old.first(), &["a", "an", "the"]));
    let whole = first_noun(old).is_some_and(|x| x.0 < 4 && x.1 == old.len());
    let said = &tokens[n + b..not];
    let relative = usize::from(is(said.first(), &["that", "which", "who"]));
    let helped = said[relative..]
        .iter()
        .take_while(|t| HELPERS.contains(&text(t)))
        .count();
    let place = trimmed(&said[relative + helped..]);
    let bare = &old[article..];
    (whole && bare.first().is_some_and(|t| number(t).is_none())).then_some(())?;
    let there = [bare, place].concat();
    let np = [&there[..], bare].into_iter().find(|np| talk.fits(np) == 1)?;
    Some(led(
        "replace the",
        &tokens[0],
        &[np, &led("with", &tokens[not], &[&new[..b]])],
    ))
}

/// "what waits there should be a bus rather than the car", "the thing ahead should be a van and not a bus": that becomes it.
fn what_does(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    leads(
        tokens,
        &[
            "what",
            "whatever",
            "who",
            "whoever",
            "the thing",
            "the vehicle",
            "the one",
        ],
    )?;
    let be = (2..tokens.len()).find_map(|k| {
        leads(
            &tokens[k..],
            &[
                "should be",
                "must be",
                "ought to be",
                "has to be",
                "shall be",
                "should have been",
                "is to be",
            ],
        )
        .map(|n| k + n)
    })?;
    let new = &tokens[be..];
    let (_, b) = first_noun(new).filter(|x| x.0 < 4 && is_new(new))?;
    let than = trimmed(&new[b..]);
    let n = leads(
        than,
        &[
            "rather than",
            "instead of",
            "in place of",
            "and not",
            "not",
            "in lieu of",
        ],
    )?;
    let old = &than[n..];
    let whole = first_noun(old).is_some_and(|x| x.0 < 4 && x.1 == old.len());
    let article = usize::from(is(old.first(), &["a", "an", "the", "that"]));
    let np = &old[article..];
    (whole && talk.fits(np) == 1).then(|| {
        led(
            "replace the",
            &tokens[0],
            &[np, &led("with", &tokens[be], &[&new[..b]])],
        )
    })
}

/// "a van", "two vans".
fn is_new(np: &[Token]) -> bool {
    is(np.first(), &["a", "an"]) || np.first().is_some_and(|t| number(t).is_some())
}

/// "our fleet has grown: six parked cars now", "five pedestrians now": so many of them.
fn now_so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // "two pedestrians now stand on the left instead": the two that are there
    if tokens.first().is_some_and(|t| number(t).is_some())
        && is(tokens.last(), &["instead"])
        && let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 3 && is(tokens.get(x.1), &["now"]))
        && tokens
            .get(b + 1)
            .is_some_and(|t| is_finite(text(t), true) || HELPERS.contains(&text(t)))
        && !has_noun(&tokens[b..])
        && number(&tokens[0]) == Some(talk.fits(&tokens[1..b]) as i64)
    {
        return led("the", &tokens[0], &[&tokens[..tokens.len() - 1]]);
    }
    let from = tokens
        .iter()
        .rposition(|t| text(t) == ":" || matches!(t.kind, TokenKind::Comma))
        .map_or(0, |k| k + 1);
    let body = trimmed(&tokens[from..]);
    let late = is(tokens.last(), &["now"]) || is(tokens.get(from), &["now"]);
    let Some(many) = body
        .first()
        .filter(|t| late && number(t).is_some() && !is(Some(t), &["a", "an"]))
    else {
        return tokens;
    };
    let more = body.iter().any(|t| {
        is(
            Some(t),
            &["more", "other", "of", "fewer", "less", "another", "and"],
        )
    });
    let Some((_, b)) = first_noun(body).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let place = &body[b..];
    let plain = place.is_empty() || is_place(place) && !has_noun(place);
    let verb = body.iter().any(|t| HELPERS.contains(&text(t)));
    let remark = &tokens[..from];
    if more
        || verb
        || !plain
        || talk.fits(&body[1..]) == 0
        || removes(remark.first())
        || has_noun(remark) && !grows(remark)
    {
        return tokens;
    }
    led("keep exactly", many, &[body])
}

/// "our car fleet has grown:": a remark on how many there are.
fn grows(remark: &[Token]) -> bool {
    remark.iter().any(|t| {
        is(
            Some(t),
            &[
                "grown",
                "shrunk",
                "grew",
                "shrank",
                "increased",
                "decreased",
                "expanded",
                "changed",
                "grows",
                "shrinks",
                "bigger",
                "smaller",
                "larger",
                "doubled",
                "halved",
            ],
        )
    })
}
