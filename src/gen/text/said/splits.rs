//! Sentences about several who do different things: "one stays, one crosses", "the cyclist stops and lets the woman cross",
//! "digger, cones and workers have all left", "three men, and all of them facing us".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = half_elsewhere(one_and_one(tokens, talk), talk);
    let out = lets_another(out, talk);
    let out = all_gone(out, talk);
    let out = all_facing(out);
    let out = change_sides(out, talk);
    gapped(of_that_place(out), talk)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

/// "the two men split up: one stays, one crosses to the right": one of the two men crosses.
fn one_and_one(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STAY: &[&str] = &[
        "stays",
        "remains",
        "stays put",
        "stays there",
        "stays where he is",
        "stays where she is",
        "stays where it is",
        "remains there",
        "keeps standing",
        "waits",
        "does not move",
        "stays behind",
        "keeps his place",
        "keeps her place",
        "keeps its place",
        "stays as it is",
    ];
    const ONE: &[&str] = &[
        "one",
        "the other one",
        "the other",
        "the second",
        "the second one",
        "another",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["one"]).then_some(())?;
        (ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and"])).then_some(())?;
        let n = leads(&tokens[i + 1..], STAY)?;
        let mut k = i + 1 + n;
        // ("one remains on the right sidewalk")
        if is_place(tokens.get(k..)?) {
            k = (k..tokens.len())
                .find(|j| ends(tokens.get(*j)) || is(tokens.get(*j), &["and", "while", "but"]))?;
        }
        (ends(tokens.get(k)) || is(tokens.get(k), &["and", "while", "but"])).then_some(())?;
        while k < tokens.len() && (ends(tokens.get(k)) || is(tokens.get(k), &["and", "but", "while"])) {
            k += 1;
        }
        let m = leads(tokens.get(k..)?, ONE)?;
        let verb = tokens.get(k + m)?;
        (is_finite(text(verb), false) || HELPERS.contains(&text(verb))).then_some((i, k + m))
    });
    let Some((i, verb)) = found else {
        return tokens;
    };
    let head = &tokens[..i];
    let Some((a, b)) = first_noun(head).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &head[..b];
    if talk.fits(&np[a..b]) < 2
        || is(head.get(b), &["in", "on"])
        || !is(np.first(), &["the", "both", "of", "these", "those"])
    {
        return tokens;
    }
    let who = led("one of the", &tokens[0], &[&np[a..b]]);
    [&who, &tokens[verb..]].concat()
}

/// "half the kids have gone over to the other pavement": so many of them.
fn half_elsewhere(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = leads(&tokens, &["move", "send", "put", "bring", "place", "let", "have"]).unwrap_or(0);
    let Some(n) = leads(
        &tokens[lead..],
        &[
            "half of the",
            "half the",
            "half of my",
            "half of these",
            "half of those",
        ],
    )
    .map(|n| lead + n) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let np = &tokens[n..n + b];
    let rest = &tokens[n + b..];
    let goes = (0..rest.len()).find(|k| {
        super::words::is_goal(&rest[*k..])
            || is(rest.get(*k), &["on", "in", "behind"]) && is_place(&rest[*k..])
    });
    let verb = lead > 0
        || rest
            .iter()
            .take(4)
            .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    let many = talk.fits(np);
    if goes.is_none() || !verb || many < 2 || many % 2 == 1 {
        return tokens;
    }
    let digit = Token {
        kind: TokenKind::Number((many / 2) as f64),
        text: (many / 2).to_string(),
        span: tokens[lead].span,
    };
    let of = led("of the", &tokens[lead], &[np, rest]);
    [&tokens[..lead], &[digit], &of].concat()
}

/// "the cyclist stops and lets the woman cross": two clauses.
fn lets_another(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "and lets",
                "and let",
                "to let",
                "letting",
                "and allows",
                "and is letting",
                "and has let",
            ],
        )?;
        let np = &tokens[i + n..];
        is(np.first(), &["the", "both", "my", "that", "all"]).then_some(())?;
        let (_, b) = first_noun(np).filter(|x| x.0 < 4)?;
        let verb = b + usize::from(is(np.get(b), &["to"]));
        let goes = is(
            np.get(verb),
            &["cross", "walk", "go", "drive", "move", "stand", "ride", "wait"],
        ) && np.len() > verb + 1
            && is_place(&np[verb + 1..]);
        (goes && talk.fits(&np[..b]) > 0).then_some((i, i + n, b, verb))
    });
    let Some((i, from, b, verb)) = found else {
        return tokens;
    };
    // ("have it stop to let the woman cross": a command leads)
    if !is(tokens.first(), &["the", "my", "that", "both", "let"]) {
        return tokens;
    }
    let np = &tokens[from..];
    let and = led(
        "and",
        &tokens[i],
        &[&np[..b], &led("should", &tokens[i], &[&np[verb..]])],
    );
    [&tokens[..i], &and].concat()
}

/// "excavator, cones and workers have all left": each of them.
fn all_gone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const GONE: &[&str] = &[
        "left",
        "gone",
        "disappeared",
        "vanished",
        "go",
        "disappear",
        "vanish",
        "leave",
        "away",
        "removed",
        "cleared away",
        "taken away",
        "packed up",
        "moved on",
        "be removed",
        "be gone",
        "been removed",
        "been taken away",
        "been cleared away",
    ];
    let found = (2..tokens.len()).find_map(|verb| {
        (HELPERS.contains(&text(&tokens[verb])) || is(tokens.get(verb), &["go", "leave"])).then_some(())?;
        let mut k = verb;
        while tokens.get(k).is_some_and(|t| {
            HELPERS.contains(&text(t))
                || is(Some(t), &["all", "now", "to", "both", "also", "already", "since"])
        }) {
            k += 1;
        }
        let n = leads(&tokens[k..], GONE).filter(|n| ends(tokens.get(k + n)))?;
        Some((verb, k, n))
    });
    let Some((verb, k, n)) = found else {
        return tokens;
    };
    // the list may follow a remark and a colon
    let colon = tokens[..verb]
        .iter()
        .rposition(|t| text(t) == ":" || t.kind == TokenKind::Stop)
        .map_or(0, |c| c + 1);
    let list = &tokens[colon..verb];
    let mut parts: Vec<&[Token]> = Vec::new();
    for part in list.split(|t| t.kind == TokenKind::Comma || text(t) == "and") {
        if !part.is_empty() {
            parts.push(part);
        }
    }
    let known = |p: &&[Token]| {
        first_noun(p).is_some_and(|x| x.0 < 4 && x.1 == p.len())
            && !p.iter().any(|t| {
                number(t).is_some() || is(Some(t), &["a", "an", "all", "no", "not", "but", "except"])
            })
            && talk.fits(p) > 0
    };
    if parts.len() < 2 || !parts.iter().all(known) {
        return tokens;
    }
    let mut out = led("remove", &tokens[0], &[]);
    for (i, p) in parts.iter().enumerate() {
        if i > 0 {
            out.extend(led("and", &p[0], &[]));
        }
        let the = !is(p.first(), &["the", "both", "my", "these", "those", "that"]);
        out.extend(if the { led("the", &p[0], &[p]) } else { p.to_vec() });
    }
    out.extend_from_slice(&tokens[k + n..]);
    out
}

/// "three men instead of two, and all of them facing us": all the men shall.
fn all_facing(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "all of them facing us",
            "all facing us",
            "all of them facing me",
            "all facing me",
            "all of them looking at us",
            "all looking at us",
            "all of them turned towards us",
            "all turned towards us",
            "every one of them facing us",
            "each of them facing us",
        ],
    )
    .filter(|x| x.0 > 3) else {
        return tokens;
    };
    if !ends(tokens.get(i + n)) {
        return tokens;
    }
    let head = trimmed(&tokens[..i]);
    let Some((a, b)) = first_noun(head) else {
        return tokens;
    };
    let face = led(
        ", and all the",
        &tokens[i],
        &[&head[a..b], &led("should face us", &tokens[i], &[])],
    );
    let mut out = [head, &face].concat();
    out[head.len()].kind = TokenKind::Comma;
    out.extend_from_slice(&tokens[i + n..]);
    out
}

/// "the parked cars change sides: the red one goes left": each goes to the other side.
fn change_sides(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const CHANGE: &[&str] = &[
        "change sides",
        "changes sides",
        "switch sides",
        "switches sides",
        "swap sides",
        "swaps sides",
        "change side",
        "changes side",
        "have changed sides",
        "has changed sides",
        "should change sides",
        "should swap sides",
        "should switch sides",
        "exchange sides",
    ];
    let Some((i, n)) = find(&tokens, CHANGE).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let lead = leads(&tokens, &["let", "make", "have"]).unwrap_or(0);
    let np = &tokens[lead..i];
    let end = i + n + leads(&tokens[i + n..], &["of the road", "of the street"]).unwrap_or(0);
    if !is(np.first(), &["the", "both", "my", "all", "that"])
        || first_noun(np).is_none_or(|x| x.0 > 4)
        || talk.fits(np) == 0
    {
        return tokens;
    }
    let rest = &tokens[end..];
    let again = is(rest.first(), &[":"]) && !rest.iter().any(|t| number(t).is_some_and(|n| n > 1));
    if !(again || ends(rest.first()) || is(rest.first(), &["and"])) {
        return tokens;
    }
    // two on opposite sides take each other's place
    let on_left = [np, &led("on the left", &tokens[i], &[])].concat();
    let apart = talk.fits(np) == 2 && talk.fits(&on_left) == 1;
    let side = led(
        if apart {
            "swap places"
        } else {
            "to the other side of the road"
        },
        &tokens[i],
        &[],
    );
    let go = if apart {
        [np, &side].concat()
    } else {
        led("move", &tokens[0], &[np, &side])
    };
    if again { go } else { [&go, rest].concat() }
}

/// "in our lane and the cones in the oncoming one": the oncoming lane.
fn of_that_place(mut tokens: Vec<Token>) -> Vec<Token> {
    const PLACES: &[&str] = &[
        "lane", "sidewalk", "pavement", "footpath", "roadside", "kerb", "curb", "shoulder", "footway",
        "verge",
    ];
    for i in 3..tokens.len() {
        let side = is(
            tokens.get(i - 1),
            &[
                "oncoming",
                "left",
                "right",
                "other",
                "opposite",
                "opposing",
                "neighbouring",
                "next",
            ],
        );
        let the = is(tokens.get(i - 2), &["the"])
            && is(
                tokens.get(i - 3),
                &["in", "on", "to", "into", "onto", "from", "along"],
            );
        if !(side && the && is(tokens.get(i), &["one"])) {
            continue;
        }
        let place = tokens[..i - 3]
            .iter()
            .rev()
            .find(|t| PLACES.contains(&text(t)))
            .map(|t| text(t).to_string());
        if let Some(place) = place.filter(|_| !has_noun(&tokens[i + 1..]) || ends(tokens.get(i + 1))) {
            tokens[i].text = place;
        }
    }
    tokens
}

/// "the digger stands in our lane and the cones in the oncoming lane": the cones should be there.
fn gapped(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) =
        first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "my", "both", "that"]))
    else {
        return tokens;
    };
    let verb = tokens
        .get(b)
        .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !verb {
        return tokens;
    }
    const PLACE_ENDS: &[&str] = &[
        "lane", "sidewalk", "pavement", "road", "street", "roadside", "kerb", "curb", "us", "me", "left",
        "right", "shoulder", "verge", "crossing", "zebra", "side", "ahead", "behind",
    ];
    let found = (b + 2..tokens.len()).find_map(|i| {
        let link = is(tokens.get(i), &["and", "while"]) || tokens[i].kind == TokenKind::Comma;
        (link && is(tokens.get(i - 1), PLACE_ENDS)).then_some(())?;
        let mut k = i + 1;
        while is(tokens.get(k), &["and", "while", "but"]) {
            k += 1;
        }
        let np = tokens.get(k..)?;
        is(np.first(), &["the", "both", "my", "that"]).then_some(())?;
        let (_, e) = first_noun(np).filter(|x| x.0 < 4)?;
        let place = &np[e..];
        let close = place
            .iter()
            .position(|t| t.kind == TokenKind::Stop)
            .unwrap_or(place.len());
        let plain = is_place(place)
            && !is(
                place.first(),
                &["to", "onto", "into", "left", "off", "out", "away"],
            )
            && !place[..close]
                .iter()
                .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
        (plain && talk.fits(&np[..e]) > 0).then_some(k + e)
    });
    match found {
        Some(at) => [&tokens[..at], &led("should be", &tokens[at], &[]), &tokens[at..]].concat(),
        None => tokens,
    }
}
