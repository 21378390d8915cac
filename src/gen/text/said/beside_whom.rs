//! Places told by who is there, or by where something was: "on each side of the barrier", "same lane, same distance", "the
//! child shouldn't be alone, put its mother next to it", "parked on the wrong side, it belongs on the left".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::company::mark;
use super::lane_of::name_of;
use super::words::{find, first_noun, has_noun, is, leads, led, text, trimmed};

/// A sentence in which they are told in full.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = same_again(on_each_side(tokens, talk), talk);
    wrong_side(not_alone(gives_company(out, talk), talk), talk)
}

/// "on each side of the barrier there must be one cone": one to its left and one to its right.
fn on_each_side(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const EACH: &[&str] = &[
        "on each side of",
        "on either side of",
        "on both sides of",
        "to each side of",
        "to either side of",
        "to both sides of",
        "at each side of",
    ];
    let Some((i, n)) = find(&tokens, EACH) else {
        return tokens;
    };
    let rest = &tokens[i + n..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4 && is(rest.first(), &["the", "that"])) else {
        return tokens;
    };
    let one = &rest[..b];
    let single = talk.fits(one) == 1;
    const ASKS: &[&str] = &[
        "there must be",
        "there should be",
        "there is",
        "there has to be",
        "put",
        "place",
        "add",
        "i want",
        "there shall be",
        "set",
        "i need",
        "there stands",
    ];
    let close = |part: &[Token]| {
        let part = trimmed(part);
        part.is_empty()
            || leads(
                part,
                &[
                    "close beside it",
                    "close to it",
                    "right beside it",
                    "right next to it",
                    "beside it",
                    "next to it",
                    "close by",
                    "near it",
                ],
            ) == Some(part.len())
    };
    let new = if i == 0 {
        let asks = leads(trimmed(&rest[b..]), ASKS).map(|n| &trimmed(&rest[b..])[n..]);
        asks.filter(|new| first_noun(new).is_some_and(|x| x.0 < 4 && close(&new[x.1..])))
    } else {
        leads(&tokens, ASKS)
            .map(|n| &tokens[n.min(i)..i])
            .filter(|new| first_noun(new).is_some_and(|x| x.1 == new.len()) && close(&rest[b..]))
    };
    let Some((new, e)) = new.and_then(|new| Some((new, first_noun(new)?.1))) else {
        return tokens;
    };
    if !single || !is(new.first(), &["a", "an", "one"]) {
        return tokens;
    }
    let at = &tokens[0];
    let a = led("a", at, &[&new[1..e]]);
    let left = led("right next to", at, &[one, &led("on its left", at, &[])]);
    let right = led("right next to", at, &[one, &led("on its right", at, &[])]);
    led("put", at, &[&a, &left, &led("and", at, &[]), &a, &right])
}

/// "the bus ought to be behind us; same lane, same distance": as far, and in that lane.
fn same_again(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &["same distance", "the same distance", "at the same distance"],
    ) else {
        return tokens;
    };
    let mut end = i + n;
    let mut from = i;
    let mut lane = false;
    while from > 0 && (mark(&tokens[from - 1]) || is(tokens.get(from - 1), &["and", "at", "the", "but"])) {
        from -= 1;
    }
    if from > 1 && is(tokens.get(from - 1), &["lane"]) && is(tokens.get(from - 2), &["same"]) {
        lane = true;
        from -= 2;
        while from > 0 && (mark(&tokens[from - 1]) || is(tokens.get(from - 1), &["in", "the", "but"])) {
            from -= 1;
        }
    }
    let late = trimmed(&tokens[end..]);
    if leads(late, &["same lane", "the same lane", "in the same lane"]) == Some(late.len())
        && !late.is_empty()
    {
        lane = true;
        end = tokens.len();
    }
    let body = &tokens[..from];
    let told = (|| {
        let (_, b) = first_noun(body).filter(|x| x.0 < 4 && is(body.first(), &["the", "that", "my"]))?;
        let at = find(
            &body[b..],
            &[
                "behind us",
                "behind me",
                "in front of us",
                "ahead of us",
                "in front of me",
                "ahead of me",
                "to our left",
                "to our right",
            ],
        )?;
        let not = body[b..b + at.0].iter().any(|t| is(Some(t), &["not"]));
        let metres = talk.range(&body[..b]).filter(|_| !not)?;
        let name = name_of(&talk.boxes_of(&body[..b]), talk).filter(|_| lane);
        Some((b + at.0, b + at.0 + at.1, metres, name))
    })();
    match told.filter(|_| lane && trimmed(&tokens[end..]).is_empty()) {
        Some((a, b, metres, name)) => {
            let at = &tokens[a];
            let count = Token {
                kind: TokenKind::Number(metres),
                ..super::words::word(&format!("{metres}"), at)
            };
            let mut out = body[..a].to_vec();
            out.push(count);
            out.extend(led("m", at, &[&body[a..b]]));
            if let Some(name) = name {
                out.extend(led(
                    &format!("{} {name}", if name.ends_with("lane") { "in" } else { "on" }),
                    at,
                    &[],
                ));
            }
            out
        }
        None => tokens,
    }
}

/// "give the pedestrian some company: a child right beside them": a child beside the pedestrian.
fn gives_company(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (|| {
        is(tokens.first(), &["give"]).then_some(())?;
        let np = &tokens[1..];
        let (_, b) = first_noun(np).filter(|x| x.0 < 4 && is(np.first(), &["the", "that", "both"]))?;
        let np = &np[..b];
        let rest = &tokens[1 + b..];
        let n = leads(
            rest,
            &[
                "some company",
                "company",
                "a bit of company",
                "a little company",
                "a companion",
                "some support",
            ],
        )?;
        let more = &rest[n..];
        mark(more.first()?).then_some(())?;
        let more = &more[1..];
        let k = more.len().checked_sub(2)?;
        let near = is(more.get(k), &["beside", "to", "with", "near", "by"]);
        let back = is(more.last(), &["them", "him", "her", "it"]);
        (near && back && has_noun(&more[..k]) && talk.fits(np) > 0)
            .then(|| led("put", &tokens[0], &[&more[..=k], np]))
    })();
    found.unwrap_or(tokens)
}

/// "the child shouldn't be alone, put its mother next to it": next to the child.
fn not_alone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (|| {
        let (_, b) =
            first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "that", "this"]))?;
        let n = b + leads(
            &tokens[b..],
            &[
                "shouldnt",
                "should not",
                "mustnt",
                "must not",
                "cant",
                "cannot",
                "isnt to",
                "is not to",
                "oughtnt to",
                "ought not to",
                "shall not",
                "doesnt want to",
                "needs not",
                "isnt",
                "is not",
                "shouldnt have to",
            ],
        )?;
        let alone = n + leads(
            &tokens[n..],
            &[
                "be alone",
                "be all alone",
                "stand alone",
                "stand there alone",
                "be here alone",
                "stand all alone",
                "wait alone",
                "be left alone",
                "stand around alone",
                "be on its own",
                "be on his own",
                "be on her own",
                "walk alone",
                "stay alone",
                "be out alone",
                "be there alone",
            ],
        )?;
        let rest = trimmed(&tokens[alone..]);
        let rest = if rest.first().is_some_and(|t| t.kind == TokenKind::Mark) {
            &rest[1..]
        } else {
            rest
        };
        let it = rest
            .iter()
            .rposition(|t| is(Some(t), &["it", "him", "her", "them"]))?;
        let verb = is(
            rest.first(),
            &[
                "put", "add", "place", "let", "have", "give", "set", "send", "bring",
            ],
        );
        let near = it > 1 && is(rest.get(it - 1), &["to", "beside", "with", "near", "by"]);
        (verb && near && has_noun(&rest[..it]) && talk.fits(&tokens[..b]) > 0)
            .then(|| [&rest[..it], &tokens[..b], &rest[it + 1..]].concat())
    })();
    found.unwrap_or(tokens)
}

/// "the trailer was parked on the wrong side, it belongs on the left": it belongs on the left side of the road.
fn wrong_side(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (|| {
        let (_, b) = first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "that", "my"]))?;
        let n = b + leads(
            &tokens[b..],
            &[
                "was parked",
                "is parked",
                "has been parked",
                "is standing",
                "stands",
                "was standing",
                "had been parked",
                "has parked",
                "parked",
            ],
        )?;
        let wrong = n + leads(
            &tokens[n..],
            &[
                "on the wrong side of the road",
                "on the wrong side of the street",
                "on the wrong side",
                "at the wrong edge of the road",
                "at the wrong kerb",
                "on the wrong edge of the road",
            ],
        )?;
        let next = trimmed(&tokens[wrong..]);
        let next = &next[usize::from(
            is(next.first(), &[":"]) || next.first().is_some_and(|t| t.kind == TokenKind::Mark),
        )..];
        let verb = leads(
            next,
            &[
                "it belongs",
                "it should be",
                "it must be",
                "it has to be",
                "it should stand",
                "it should be parked",
                "it has to stand",
                "it needs to be",
                "it goes",
                "it ought to be",
            ],
        )?;
        let side = verb
            + leads(
                &next[verb..],
                &[
                    "on the left",
                    "on the right",
                    "to the left",
                    "to the right",
                    "on the left one",
                    "on the right one",
                ],
            )?;
        let left = next[verb..side].iter().any(|t| text(t) == "left");
        (trimmed(&next[side..]).is_empty() && talk.fits(&tokens[..b]) > 0).then(|| {
            let goal = if left {
                "belongs on the left side of the road"
            } else {
                "belongs on the right side of the road"
            };
            [&tokens[..b], &led(goal, &tokens[b], &[])[..]].concat()
        })
    })();
    found.unwrap_or(tokens)
}
