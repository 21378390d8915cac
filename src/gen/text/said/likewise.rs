//! What holds for another, too, and what is told in pairs: "the fog is gone, and so is the woman", "a van in place of the pickup
//! and a cyclist in place of the motorcycle", "two cars more, two people less", "two people are enough on the sidewalk".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::frame::unwrapped;
use super::lists::HELPERS;
use super::predicate::{Part, parts};
use super::subject::subject;
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

const FOR: &[&str] = &["in place of", "in the place of", "instead of", "in lieu of"];
const ENOUGH: &[&str] = &[
    "are enough",
    "is enough",
    "would be enough",
    "will be enough",
    "should be enough",
    "are plenty",
    "is plenty",
    "is sufficient",
    "is quite enough",
    "is more than enough",
    "would be plenty",
    "will be plenty",
    "suffices",
    "would do",
    "will do",
    "are sufficient",
    "suffice",
    "will suffice",
    "would suffice",
    "are quite enough",
    "are more than enough",
];

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = where_were(number_of(remark(tokens)));
    let out = so_too(out, talk);
    let out = paired(out, talk);
    let out = more_and_less(out);
    let out = if talk.others { out } else { enough_there(out) };
    let out = some_of_them(out, talk);
    let out = just_so_many(spared_too(out), talk);
    and_none(out, talk)
}

fn known(t: Option<&Token>) -> bool {
    is(
        t,
        &[
            "the", "all", "both", "every", "my", "our", "that", "those", "these",
        ],
    )
}

fn closes(t: Option<&Token>) -> bool {
    t.is_none_or(|t| !matches!(t.kind, TokenKind::Word | TokenKind::Number(_)))
}

/// "traffic thins out: of the three cars only one is left": what stands before names nothing.
fn remark(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Mark && text(t) == ":")
        .filter(|i| *i > 0 && *i < 8)
    else {
        return tokens;
    };
    let before: Vec<Token> = tokens[..i]
        .iter()
        .filter(|t| text(t) != "traffic")
        .cloned()
        .collect();
    let style = before.iter().any(|t| {
        super::look_up(text(t)).is_some_and(|s| {
            matches!(
                s,
                super::Sense::Weather(_) | super::Sense::Time(_) | super::Sense::Place(..)
            )
        })
    });
    let says = before.len() > 1
        && !style
        && !has_noun(&before)
        && before
            .iter()
            .all(|t| t.kind == TokenKind::Word && number(t).is_none());
    let orders = is(
        before.first(),
        &[
            "add", "remove", "delete", "put", "place", "make", "change", "keep", "replace", "move", "please",
        ],
    ) && !is(before.get(1), &["room", "way", "space"]);
    let points = before.iter().any(|t| {
        is(
            Some(t),
            &[
                "it",
                "they",
                "them",
                "he",
                "she",
                "him",
                "her",
                "one",
                "others",
                "other",
                "rest",
                "no",
                "not",
                "only",
                "nothing",
                "nobody",
                "everything",
                "everybody",
            ],
        )
    });
    let place = (0..before.len())
        .any(|k| is_place(&before[k..]) && !is(before.get(k), &["out", "up", "down", "off", "over"]));
    if !says || orders || points || place || tokens.len() < i + 3 {
        return tokens;
    }
    tokens[i + 1..].to_vec()
}

/// "the number of cyclists has gone down to two".
fn number_of(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["the number of", "the count of", "the amount of"]) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[n..])
        .filter(|x| x.0 < 3)
        .map(|x| (n + x.0, n + x.1))
    else {
        return tokens;
    };
    let verb = (b..tokens.len())
        .find(|k| HELPERS.contains(&text(&tokens[*k])) || is_finite(text(&tokens[*k]), false));
    let to = (b..tokens.len()).rev().find(|k| {
        is(
            tokens.get(*k),
            &["to", "by", "is", "now", "be", "at", "just", "only"],
        ) && tokens.get(k + 1).is_some_and(|t| number(t).is_some())
    });
    let (Some(verb), Some(to)) = (verb, to) else {
        return tokens;
    };
    let end = to + 2;
    let closed = tokens
        .get(end)
        .is_none_or(|t| closes(Some(t)) || is(Some(t), &["and", "now"]));
    if !closed || super::words::is_unit(tokens.get(end)) || verb > to {
        return tokens;
    }
    let place = if is_place(&tokens[b..verb]) {
        &tokens[b..verb]
    } else {
        &[]
    };
    let np = &tokens[a..b];
    let many = &tokens[to + 1..end];
    let at = &tokens[0];
    let out = if is(tokens.get(to), &["by"]) {
        let less = tokens[verb..to].iter().any(|t| {
            matches!(
                text(t),
                "down"
                    | "fallen"
                    | "fell"
                    | "falls"
                    | "dropped"
                    | "drops"
                    | "shrunk"
                    | "shrinks"
                    | "reduced"
                    | "decreased"
                    | "decreases"
                    | "sunk"
                    | "lowered"
                    | "cut"
            )
        });
        let more = tokens[verb..to].iter().any(|t| {
            matches!(
                text(t),
                "up" | "grown"
                    | "grew"
                    | "grows"
                    | "risen"
                    | "rises"
                    | "rose"
                    | "increased"
                    | "increases"
                    | "raised"
            )
        });
        match (less, more) {
            (true, false) => led("remove", at, &[many, np, place]),
            (false, true) => led("add", at, &[many, &led("more", at, &[np, place])]),
            _ => return tokens,
        }
    } else {
        led("keep exactly", at, &[many, np, place])
    };
    [&out, &tokens[end..]].concat()
}

/// "where four children were walking there are only two now": only two are left.
fn where_were(tokens: Vec<Token>) -> Vec<Token> {
    if !is(tokens.first(), &["where"]) || !tokens.iter().any(|t| matches!(text(t), "were" | "was" | "used")) {
        return tokens;
    }
    let mut from = 1;
    while is(
        tokens.get(from),
        &[
            "there", "once", "before", "were", "was", "used", "to", "be", "stood",
        ],
    ) {
        from += 1;
    }
    let first = tokens.get(from).filter(|t| number(t).is_some());
    let Some((a, b)) = first_noun(tokens.get(from..).unwrap_or_default())
        .filter(|x| first.is_some() && x.0 < 4)
        .map(|x| (from + x.0, from + x.1))
    else {
        return tokens;
    };
    let Some(k) = (b..tokens.len())
        .find(|k| number(&tokens[*k]).is_some() && !super::words::is_unit(tokens.get(k + 1)))
    else {
        return tokens;
    };
    let said = tokens[b..k].iter().any(|t| {
        matches!(
            text(t),
            "there" | "only" | "just" | "now" | "are" | "is" | "remain"
        )
    });
    let own = first_noun(&tokens[k..]);
    if !said
        || own.is_some()
            && tokens[k..].iter().all(|t| {
                !tokens[a..b]
                    .iter()
                    .any(|n| n.text.trim_end_matches('s') == t.text.trim_end_matches('s'))
            })
    {
        return tokens;
    }
    let place = (b..k).find(|j| is(tokens.get(*j), &["on", "in", "at", "along", "beside", "behind"]));
    let place: &[Token] = place.map_or(&[], |j| {
        let end = (j..k)
            .find(|e| closes(tokens.get(*e)) || is(tokens.get(*e), &["there", "only", "just", "now"]))
            .unwrap_or(k);
        &tokens[j..end]
    });
    let place = if is_place(place) { place } else { &[] };
    led(
        "keep exactly",
        &tokens[0],
        &[&tokens[k..=k], &tokens[from + 1..b], place],
    )
}

/// True if the clause says that its subject is gone.
fn says_gone(clause: &[Token], talk: &Talk<'_>) -> bool {
    let (inner, mood) = unwrapped(clause);
    if mood.denied {
        return false;
    }
    let sky = find(
        clause,
        &[
            "is gone",
            "has gone",
            "is over",
            "has lifted",
            "has stopped",
            "has passed",
            "has cleared",
            "has vanished",
            "has disappeared",
            "are gone",
            "have gone",
        ],
    );
    sky.is_some_and(|(i, n)| i + n == clause.len())
        || subject(inner, talk, mood.caused).is_some_and(|s| {
            parts(&inner[s.pred..], s.plural || mood.caused)
                .iter()
                .any(Part::is_gone)
        })
}

/// "the fog is gone, and so is the woman", "the shoppers have fled and the cyclist, too".
fn so_too(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let so = find(
        &tokens,
        &[
            "so is", "so are", "so has", "so have", "so did", "so does", "so do",
        ],
    )
    .filter(|x| x.0 > 2);
    if let Some((i, n)) = so {
        let np = &tokens[i + n..];
        let before = trimmed(&tokens[..i]);
        if known(np.first())
            && first_noun(np).is_some_and(|x| closes(np.get(x.1)) || is_place(&np[x.1..]))
            && says_gone(before, talk)
        {
            let end = np.iter().position(|t| closes(Some(t))).unwrap_or(np.len());
            let and = led("and remove", &tokens[i], &[&np[..end]]);
            return [before, &and, &np[end..]].concat();
        }
        return tokens;
    }
    // "... and the cyclist, too"
    let Some(k) = (3..tokens.len()).find(|k| {
        is(tokens.get(*k), &["too", "also", "as"])
            && tokens
                .get(k + if text(&tokens[*k]) == "as" { 2 } else { 1 })
                .is_none_or(|t| closes(Some(t)))
    }) else {
        return tokens;
    };
    let end = if tokens[k - 1].kind == TokenKind::Comma {
        k - 1
    } else {
        k
    };
    let Some(and) = (2..end).rev().find(|j| is(tokens.get(*j), &["and"])) else {
        return tokens;
    };
    let np = &tokens[and + 1..end];
    let whole = known(np.first())
        && first_noun(np).is_some_and(|x| {
            x.1 == np.len() || is_place(&np[x.1..]) && !np.iter().any(|t| HELPERS.contains(&text(t)))
        });
    let verb = np.iter().any(|t| is_finite(text(t), false));
    let before = trimmed(&tokens[..and]);
    let gone = (0..before.len())
        .filter(|k| *k == 0 || closes(before.get(k - 1)) || is(before.get(k - 1), &["so", "and", "but"]))
        .any(|k| says_gone(&before[k..], talk));
    if !whole || verb || !gone {
        return tokens;
    }
    let step = if text(&tokens[k]) == "as" { 2 } else { 1 };
    [
        before,
        &led("and remove", &tokens[and], &[np]),
        &tokens[k + step..],
    ]
    .concat()
}

/// "put a van in place of the pickup and a cyclist in place of the motorcycle".
fn paired(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, FOR).filter(|x| x.0 > 1) else {
        return tokens;
    };
    let Some((j, m)) = find(&tokens[i + n..], FOR).map(|x| (i + n + x.0, x.1)) else {
        return tokens;
    };
    let Some(and) = (i + n..j).find(|k| is(tokens.get(*k), &["and"]) || tokens[*k].kind == TokenKind::Comma)
    else {
        return tokens;
    };
    let fresh = |t: Option<&Token>| is(t, &["a", "an", "another"]) || t.is_some_and(|t| number(t).is_some());
    let Some(from) = (0..i).find(|k| fresh(tokens.get(*k))) else {
        return tokens;
    };
    let second = and + 1 + usize::from(is(tokens.get(and + 1), &["and"]));
    let (new1, old1) = (&tokens[from..i], &tokens[i + n..and]);
    let (new2, old2) = (&tokens[second..j], &tokens[j + m..]);
    let one = |np: &[Token]| first_noun(np).is_some_and(|x| x.1 == np.len() && x.0 < 4);
    let end = old2.iter().position(|t| closes(Some(t))).unwrap_or(old2.len());
    let there =
        known(old1.first()) && known(old2.first()) && talk.fits(old1) > 0 && talk.fits(&old2[..end]) > 0;
    if !(there && fresh(new2.first()) && one(new1) && one(new2)) || has_noun(&tokens[..from]) {
        return tokens;
    }
    let at = &tokens[0];
    let mut out = led("replace", at, &[old1]);
    out.extend(led("with", at, &[new1]));
    out.extend(led("and replace", at, &[&old2[..end]]));
    out.extend(led("with", at, &[new2, &old2[end..]]));
    out
}

/// "two cars more, two shoppers less".
fn more_and_less(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut from = 0;
    for end in 0..=tokens.len() {
        let link = tokens
            .get(end)
            .is_none_or(|t| t.kind == TokenKind::Comma || is(Some(t), &["and", "but"]));
        if !link {
            continue;
        }
        let part = &tokens[from..end];
        from = end + 1;
        if part.is_empty() {
            continue;
        }
        let noun = first_noun(part).filter(|x| x.0 > 0 && x.0 < 4 && number(&part[0]).is_some());
        let last = noun.and_then(|x| (x.1 + 1 == part.len()).then(|| text(&part[x.1])));
        let verb = match last {
            Some("more") => "add",
            Some("less" | "fewer") => "remove",
            _ => return tokens,
        };
        if !out.is_empty() {
            out.extend(led("and", &part[0], &[]));
        }
        let np = &part[..part.len() - 1];
        let more = if verb == "add" {
            [&np[..1], &led("more", &part[0], &[&np[1..]])].concat()
        } else {
            np.to_vec()
        };
        out.extend(led(verb, &part[0], &[&more]));
    }
    out
}

/// "two people are enough on the sidewalk": so many there.
fn enough_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, ENOUGH).filter(|x| x.0 > 1) else {
        return tokens;
    };
    let from = tokens[..i]
        .iter()
        .rposition(|t| closes(Some(t)) || is(Some(t), &["and", "but"]))
        .map_or(0, |k| k + 1);
    let np = &tokens[from..i];
    let place = &tokens[i + n..];
    let end = place
        .iter()
        .position(|t| closes(Some(t)) || is(Some(t), &["and", "but"]))
        .unwrap_or(place.len());
    let counted = np.first().is_some_and(|t| number(t).is_some())
        && first_noun(np).is_some_and(|x| x.1 == np.len() && x.0 < 4);
    // ("..., and put the others on the right" needs them)
    let rest = &place[end..];
    let moves = find(rest, &["the others", "the other", "the rest"])
        .is_some_and(|x| (x.0 + x.1..rest.len()).any(|k| is_place(&rest[k..])))
        && !rest.iter().any(|t| super::some_of::removes(Some(t)));
    if moves || !counted || end == 0 || !is_place(&place[..end]) || has_noun(&place[..end]) {
        return tokens;
    }
    [
        &tokens[..from],
        &led("keep exactly", &tokens[from], &[np, &place[..end]]),
        &place[end..],
    ]
    .concat()
}

/// "..., but one of them changes lanes": of those that were named.
fn some_of_them(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find(|i| {
        number(&tokens[*i]).is_some()
            && is(tokens.get(i + 1), &["of"])
            && is(tokens.get(i + 2), &["them", "these", "those"])
            && tokens
                .get(i + 3)
                .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true))
            && (*i == 0 || closes(tokens.get(i - 1)) || is(tokens.get(i - 1), &["but", "and", "while"]))
    });
    let Some(i) = found else {
        return tokens;
    };
    let mut named: Option<Vec<Token>> = None;
    let mut from = 0;
    while let Some((a, b)) = first_noun(&tokens[from..i]) {
        let np = tokens[from + a..from + b].to_vec();
        let many = matches!(
            super::look_up(text(&np[np.len() - 1])),
            Some(super::Sense::Noun(_, true))
        );
        if many && talk.fits(&np) as i64 > number(&tokens[i]).unwrap_or(0) {
            named = Some(np);
        }
        from += b;
    }
    let noun = named.or_else(|| {
        talk.last
            .as_ref()
            .map(|l| led(&super::super::lexicon::plural(l), &tokens[i], &[]))
            .filter(|np| i == 0 && talk.fits(np) as i64 > number(&tokens[i]).unwrap_or(0))
    });
    match noun {
        Some(np) => [
            &tokens[..i + 2],
            &led("the", &tokens[i], &[&np]),
            &tokens[i + 3..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "I can do without the cyclist, but not without the truck": that one stays.
fn spared_too(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["but not without", "not without"]).filter(|x| x.0 > 3) else {
        return tokens;
    };
    let np = &tokens[i + n..];
    let end = np
        .iter()
        .position(|t| closes(Some(t)) || is(Some(t), &["and"]))
        .unwrap_or(np.len());
    let whole = known(np.first()) && leads(np, &["the one"]).is_none() && has_noun(&np[..end]);
    if !whole || !has_noun(&tokens[..i]) {
        return tokens;
    }
    let out = [trimmed(&tokens[..i]), &np[end..]].concat();
    match leads(
        &out,
        &[
            "i can do without",
            "we can do without",
            "i could do without",
            "we could do without",
        ],
    ) {
        Some(n) => led("remove", &tokens[0], &[&out[n..]]),
        None => out,
    }
}

/// "just one cyclist should be riding behind us", "let three cars wait at the crossing instead of two".
fn just_so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = leads(&tokens, &["only", "just", "let", "have"]).unwrap_or(0);
    let only = lead > 0 && is(tokens.first(), &["only", "just"]);
    let than = (3..tokens.len()).find(|k| {
        leads(&tokens[*k..], &["instead of", "rather than"]) == Some(2)
            && tokens.get(k + 2).is_some_and(|t| number(t).is_some())
            && tokens.get(k + 3).is_none_or(|t| closes(Some(t)))
    });
    let Some((_, b)) = first_noun(tokens.get(lead..).unwrap_or_default())
        .filter(|x| x.0 > 0 && x.0 < 4 && number(&tokens[lead]).is_some())
        .map(|x| (lead + x.0, lead + x.1))
    else {
        return tokens;
    };
    let end = than.unwrap_or(tokens.len());
    let verb = tokens
        .get(b)
        .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !(only || than.is_some()) || !verb || end <= b {
        return tokens;
    }
    let mut place = &tokens[b..end];
    while let Some((first, rest)) = place.split_first()
        && (HELPERS.contains(&text(first))
            || text(first).ends_with("ing")
            || is(
                Some(first),
                &["parked", "wait", "stand", "drive", "walk", "ride", "to"],
            ))
    {
        place = rest;
    }
    let np = &tokens[lead + 1..b];
    let at = [np, place].concat();
    let many = number(&tokens[lead]).unwrap_or(0).max(0) as usize;
    // (fewer than that are there: more are wanted, and that is read elsewhere)
    let whole = place.is_empty()
        || is_place(place) && !has_noun(place) && place.iter().all(|t| t.kind != TokenKind::Comma);
    let there = if place.is_empty() {
        talk.fits(np)
    } else {
        talk.fits(&at)
    };
    // "two pedestrians wait at the crossing instead of one": one more comes there
    let before = than.and_then(|k| number(&tokens[k + 2])).unwrap_or(0).max(0) as usize;
    let grows = than.is_some() && before > 0 && many > before && there < many && talk.fits(np) == before;
    if grows && whole && !place.is_empty() {
        let more = led("add", &tokens[0], &[]);
        let count = Token {
            kind: TokenKind::Number((many - before) as f64),
            ..tokens[lead].clone()
        };
        return [
            &more[..],
            &[count],
            &led("more", &tokens[0], &[np]),
            &led("waiting", &tokens[0], &[place]),
        ]
        .concat();
    }
    if !whole || there == 0 || only && there <= many {
        return tokens;
    }
    let rest = than.map_or(&[][..], |k| &tokens[k + 3..]);
    [
        &led("keep exactly", &tokens[0], &[&tokens[lead..=lead], &at]),
        rest,
    ]
    .concat()
}

/// "make it seven parked cars and no scooter": those go.
fn and_none(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        (is(tokens.get(i), &["no"]) && is(tokens.get(i - 1), &["and", "but"])).then_some(())?;
        let (_, b) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 3)?;
        let np = &tokens[i + 1..i + 1 + b];
        let end = tokens.get(i + 1 + b).is_none_or(|t| closes(Some(t)));
        (end && talk.fits(np) > 0).then_some((i, i + 1 + b))
    });
    let orders = leads(
        &tokens,
        &[
            "make it",
            "make that",
            "keep",
            "leave",
            "add",
            "put",
            "give me",
            "give us",
            "place",
            "show",
        ],
    )
    .is_some();
    match found.filter(|_| orders) {
        Some((i, end)) => {
            let mut np = tokens[i + 1..end].to_vec();
            if let Some(last) = np.last_mut()
                && matches!(super::look_up(&last.text), Some(super::Sense::Noun(_, false)))
            {
                last.text = super::super::lexicon::plural(&last.text);
            }
            [
                &tokens[..i - 1],
                &led("and remove all the", &tokens[i], &[&np]),
                &tokens[end..],
            ]
            .concat()
        }
        None => tokens,
    }
}
