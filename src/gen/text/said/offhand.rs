//! What is said by the way: "this panel works better without the cyclist", "the fleet has grown: six parked cars now", "those two
//! cars? Gone.", "put that one behind me", "the truck goes out of service".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::lists::HELPERS;
use super::some_of::{bare_np, removes};
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed, word};

/// Names of what is seen as a whole.
const PICTURE: &[&str] = &[
    "panel",
    "frame",
    "picture",
    "image",
    "shot",
    "scene",
    "view",
    "drawing",
    "sketch",
    "still",
    "illustration",
    "diagram",
    "slide",
    "composition",
    "lesson",
    "exercise",
    "example",
    "setting",
    "layout",
    "situation",
    "story",
    "thing",
    "plan",
];

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = works(tokens);
    let out = in_picture(&out);
    let out = out_of_picture(&out);
    let out = that_one(&out);
    let out = out_of_service(out, talk);
    let out = in_the_way(out, talk);
    let out = now_so_many(out, talk);
    let out = was_not(out, talk);
    let out = company(always_some(out), talk);
    let out = oncoming(so_that_it(is_oncoming(&only_that(out))));
    let out = remark_and_where(passed(us_both(out), talk), talk);
    let out = another_in_place(&waits_until(out));
    no_and_just(out)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || ends(tokens.get(i - 1))
        || is(tokens.get(i - 1), &["and", "but", "then", "so", "please", "now"])
}

/// "this panel works better without the cyclist", "it would look best with a bus behind me": with or without it.
fn works(tokens: Vec<Token>) -> Vec<Token> {
    const VERBS: &[&str] = &[
        "works", "work", "reads", "read", "looks", "look", "plays", "play", "functions", "function", "goes",
        "is", "be", "feels", "feel", "comes across", "come across", "does", "do",
    ];
    const HOW: &[&str] = &[
        "better", "best", "well", "fine", "nicer", "cleaner", "clearer", "simpler", "stronger", "nicely",
        "perfectly", "good", "great", "right",
    ];
    let it = usize::from(is(
        tokens.first(),
        &["it", "this", "that", "all", "everything"],
    ));
    let named = is(tokens.first(), &["the", "this", "that", "our", "my"]) && is(tokens.get(1), PICTURE);
    let mut k = if named { 2 } else { it };
    if k == 0 {
        return tokens;
    }
    while is(
        tokens.get(k),
        &["would", "will", "should", "could", "might", "may", "also", "really", "always", "just", "certainly"],
    ) {
        k += 1;
    }
    let Some(n) = leads(&tokens[k..], VERBS) else {
        return tokens;
    };
    k += n;
    while is(tokens.get(k), &["even", "much", "far", "a", "lot", "bit", "just", "as", "so", "quite"]) {
        k += 1;
    }
    let Some(n) = leads(&tokens[k..], HOW) else {
        return tokens;
    };
    k += n;
    k += usize::from(ends(tokens.get(k)) && k < tokens.len());
    match tokens.get(k).map(text) {
        Some("without") => led("remove", &tokens[k], &[&tokens[k + 1..]]),
        Some("with")
            if tokens.get(k + 1).is_some_and(|t| {
                number(t).is_some() || is(Some(t), &["a", "an", "another", "some", "more"])
            }) =>
        {
            led("add", &tokens[k], &[&tokens[k + 1..]])
        }
        Some("if" | "when" | "once") => tokens[k + 1..].to_vec(),
        _ => tokens,
    }
}

/// "no taxi in this panel": in the scene.
fn in_picture(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let seen = is(tokens.get(i), &["in", "from", "on"])
            && is(tokens.get(i + 1), &["this", "that"])
            && is(tokens.get(i + 2), PICTURE)
            && !is(tokens.get(i + 2), &["thing", "plan"]);
        (seen && (ends(tokens.get(i + 3)) || is(tokens.get(i + 3), &["and", "any"])) && has_noun(out))
            .then_some(i + 3)
    })
}

/// "has walked out of the frame", "drives out of the picture": it is gone.
fn out_of_picture(tokens: &[Token]) -> Vec<Token> {
    const GOES: &[&str] = &[
        "walked", "driven", "gone", "ridden", "moved", "stepped", "run", "rolled", "strolled", "wandered",
        "cycled", "pulled", "got", "gotten", "jogged", "disappeared", "passed",
    ];
    const GOING: &[&str] = &[
        "walks", "drives", "goes", "rides", "moves", "steps", "runs", "rolls", "strolls", "wanders", "cycles",
        "pulls", "walk", "drive", "go", "ride", "move", "step", "roll", "stroll", "wander", "cycle", "pull",
        "drove", "went", "rode", "ran", "walked", "rolled", "moved", "stepped", "jogs", "jog", "disappears",
        "disappear",
    ];
    rewritten(tokens, |i, out| {
        let n = leads(&tokens[i + 1..], &["out of", "off", "from"]).filter(|_| i > 0)?;
        let the = i + 1 + n;
        let end = the + usize::from(is(tokens.get(the), &["the", "this", "our", "my"]));
        let seen = end > the
            && is(
                tokens.get(end),
                &["frame", "picture", "image", "shot", "scene", "view", "panel", "screen", "sight"],
            )
            || n == 2 && is(tokens.get(end), &["view", "sight", "shot", "frame"]);
        let over = is(tokens.get(i), GOES) && is(out.last(), &["has", "have", "had", "already", "just", "since"]);
        if !seen || !(over || is(tokens.get(i), GOING)) {
            return None;
        }
        // ("move the bus out of the picture", "let it drive out of the frame" are orders)
        let orders = opens(tokens, i) || is(out.last(), &["to"]);
        if orders {
            return None;
        }
        out.push(word(if over { "gone" } else { "leaves" }, &tokens[i]));
        Some(end + 1)
    })
}

/// "put that one 8 m behind me": it.
fn that_one(tokens: &[Token]) -> Vec<Token> {
    const VERBS: &[&str] = &[
        "put", "place", "move", "bring", "set", "have", "let", "turn", "make", "paint", "remove", "delete",
        "take", "shift", "park", "send", "drive", "erase", "rotate", "push", "pull",
    ];
    rewritten(tokens, |i, out| {
        let n = leads(&tokens[i..], &["that one", "this one", "the new one", "that new one", "this new one"])?;
        let new = n == 3;
        let after = is(out.last(), VERBS);
        let subject = opens(tokens, i)
            && tokens.get(i + n).is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
        // ("the new one" of a sentence that names others is told by what it says)
        (after && i > 2 || subject && new && i > 2).then(|| {
            out.push(word("it", &tokens[i]));
            i + n
        })
    })
}

/// "take the bus out of service": it goes.
fn out_of_service(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const OUT: &[&str] = &[
        "out of service",
        "out of action",
        "out of commission",
        "out of operation",
        "out of circulation",
        "out of traffic",
        "out of play",
        "out of the equation",
        "out of use",
        "off duty",
        "off the streets",
    ];
    rewritten(&tokens, |i, out| {
        let takes = opens(&tokens, i) && is(tokens.get(i), &["take", "put", "pull"]);
        let (_, b) = takes.then(|| first_noun(&tokens[i + 1..]))?.filter(|x| x.0 < 5)?;
        let from = i + 1 + b;
        // (where it is may stand between)
        let at = (from..tokens.len().min(from + 8)).find(|k| leads(&tokens[*k..], OUT).is_some())?;
        let np = &tokens[i + 1..at];
        let whole = !np.iter().any(|t| ends(Some(t)) || is(Some(t), &["and"])) && talk.fits(np) > 0;
        let n = leads(&tokens[at..], OUT).filter(|_| whole)?;
        out.extend(led("remove", &tokens[i], &[np]));
        Some(at + n)
    })
}

/// "with all those cones in the way, clear them out": they go.
fn in_the_way(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = find(
        &tokens,
        &["in the way", "in my way", "in our way", "blocking the way", "in the road", "standing around"],
    );
    let Some((i, n)) = found else { return tokens };
    let Some(from) = (0..i).rev().find(|k| {
        is(tokens.get(*k), &["with", "of", "because"]) && is(tokens.get(k + 1), &["all", "the", "those", "these", "that"])
    }) else {
        return tokens;
    };
    let np = &tokens[from + 1..i];
    let mut k = i + n;
    while tokens.get(k).is_some_and(|t| ends(Some(t))) || is(tokens.get(k), &["so", "please", "and", "just", "now"]) {
        k += 1;
    }
    let orders = removes(tokens.get(k)) || is(tokens.get(k), &["get"]);
    let mut end = k + 1;
    while is(tokens.get(end), &["rid", "of"]) {
        end += 1;
    }
    let them = orders && is(tokens.get(end), &["them", "it", "him", "her"]);
    end += 1;
    while is(tokens.get(end), &["out", "away", "off", "please", "all", "up", "now"]) {
        end += 1;
    }
    if !them || end < tokens.len() || !first_noun(np).is_some_and(|x| x.1 == np.len()) || talk.fits(np) == 0 {
        return tokens;
    }
    led("remove", &tokens[0], &[np])
}

/// "our fleet has grown: six parked cars now", "five pedestrians now": so many of them.
fn now_so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let from = tokens
        .iter()
        .rposition(|t| text(t) == ":" || matches!(t.kind, TokenKind::Comma))
        .map_or(0, |k| k + 1);
    let body = trimmed(&tokens[from..]);
    let late = is(tokens.last(), &["now"]) || is(tokens.get(from), &["now"]);
    let Some(many) = body.first().filter(|t| late && number(t).is_some() && !is(Some(t), &["a", "an"])) else {
        return tokens;
    };
    let more = body.iter().any(|t| is(Some(t), &["more", "other", "of", "fewer", "less", "another", "and"]));
    let Some((_, b)) = first_noun(body).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let place = &body[b..];
    let plain = place.is_empty() || is_place(place) && !has_noun(place);
    let verb = body.iter().any(|t| HELPERS.contains(&text(t)));
    let remark = &tokens[..from];
    if more || verb || !plain || talk.fits(&body[1..]) == 0 || removes(remark.first()) || has_noun(remark) && !grows(remark) {
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
                "grown", "shrunk", "grew", "shrank", "increased", "decreased", "expanded", "changed", "grows",
                "shrinks", "bigger", "smaller", "larger", "doubled", "halved",
            ],
        )
    })
}

/// "what was driving in the left lane were two trucks, not two cars": the cars there are trucks.
fn was_not(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const BE: &[&str] = &["was", "were", "is", "are", "had been", "has been", "have been", "in fact was", "in fact were", "really was", "really were", "actually was", "actually were"];
    let Some(from) = (0..tokens.len().min(6)).find(|k| is(tokens.get(*k), &["what", "whatever", "who"])) else {
        return tokens;
    };
    let Some(not) = (from + 4..tokens.len()).rev().find(|k| is(tokens.get(*k), &["not"])) else {
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
    let old: Vec<Token> = bare_np(old).into_iter().filter(|t| !is(Some(t), &["a", "an"])).collect();
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

/// "no taxi and no barrier here, just me and that truck": what stays needs no word.
fn no_and_just(tokens: Vec<Token>) -> Vec<Token> {
    if !is(tokens.first(), &["no"]) {
        return tokens;
    }
    let last = (2..tokens.len()).rev().find(|i| {
        tokens[*i].kind == TokenKind::Comma && is(tokens.get(i + 1), &["just", "only", "nothing", "nobody"])
    });
    let Some(i) = last else { return tokens };
    let rest = &tokens[i + 1..];
    let known = rest
        .iter()
        .any(|t| is(Some(t), &["the", "that", "those", "my", "our", "this", "me", "us"]));
    let fresh = rest.iter().any(|t| number(t).is_some() || is(Some(t), &["a", "an", "some"]));
    if !known || fresh || rest.iter().any(|t| HELPERS.contains(&text(t))) {
        return tokens;
    }
    // "no taxi and no barrier": one denial for both
    let here = trimmed(&tokens[..i]);
    let here = match here.last() {
        Some(t) if is(Some(t), &["here", "there"]) => &here[..here.len() - 1],
        _ => here,
    };
    let denied: Vec<Token> = rewritten(here, |k, out| {
        (is(here.get(k), &["no"]) && k > 0 && is(out.last(), &["and", "or"])).then(|| {
            out.push(word("all", &here[k]));
            k + 1
        })
    });
    led("remove all", &tokens[0], &[&denied[1..]])
}

/// "there is always some white van around here, so give me one in the oncoming lane": a white van there.
fn always_some(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there is always", "there is usually", "there is often", "there is mostly", "theres always",
            "there was always", "you always see", "you often see", "we always have", "i always meet",
            "i always see", "one always sees", "we usually have", "there are always",
        ],
    ) else {
        return tokens;
    };
    let np = &tokens[n..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 5 && is(np.first(), &["a", "an", "some", "one"])) else {
        return tokens;
    };
    let Some(one) = (n + b..tokens.len()).find(|k| {
        is(tokens.get(*k), &["one"])
            && leads(&tokens[k - 1..], &["add one", "put one", "place one", "me one", "us one", "have one", "show one"]).is_some()
            && tokens.get(k + 1).is_some_and(|t| !is(Some(t), &["of", "more"]))
    }) else {
        return tokens;
    };
    if has_noun(&tokens[n + b..one]) || has_noun(&tokens[one + 1..]) {
        return tokens;
    }
    led("add a", &tokens[0], &[&np[1..b], &tokens[one + 1..]])
}

/// "the cyclist gets company from two more riders, also behind me": two more riders, behind me.
fn company(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "gets company from", "get company from", "gets company by", "has company from", "got company from",
            "has got company from", "gets company in the form of", "has company in the form of", "is given company by",
            "should get company from", "gets company :", "has company :", "has company now :", "gets company now :",
            "has got company :", "has company again :", "gets company ,", "is no longer alone :", "has company ,",
            "has company now ,", "is not alone any more :", "gets the company of", "has the company of", "enjoys the company of",
        ],
    ) else {
        return tokens;
    };
    let whom = &tokens[..i];
    let what = &tokens[i + n..];
    let fresh = what
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "some"]));
    let Some((_, b)) = first_noun(what).filter(|x| fresh && x.0 < 5) else {
        return tokens;
    };
    if talk.fits(whom) == 0 {
        return tokens;
    }
    let mut place = trimmed(&what[b..]);
    while is(place.first(), &["also", "too", "both", "all", "likewise"]) {
        place = trimmed(&place[1..]);
    }
    if place.is_empty() {
        return led("add", &tokens[0], &[what, &led("next to", &tokens[i], &[whom])]);
    }
    if !is_place(place) {
        return tokens;
    }
    // ("right behind it": behind whom it joins)
    let place = rewritten(place, |k, out| {
        is(place.get(k), &["it", "him", "her", "them"]).then(|| {
            out.extend_from_slice(whom);
            k + 1
        })
    });
    led("add", &tokens[0], &[&what[..b], &place])
}

/// "turn the black car round, so that it approaches us in the oncoming lane": where it ends counts.
fn so_that_it(tokens: Vec<Token>) -> Vec<Token> {
    if !is(tokens.first(), &["turn", "rotate", "spin", "swing", "let", "have"]) {
        return tokens;
    }
    let Some((i, n)) = find(&tokens, &["so that it", "so it", "such that it", "so that they", "so they"]) else {
        return tokens;
    };
    let comes = leads(
        &tokens[i + n..],
        &[
            "approaches us", "approaches me", "comes towards us", "comes towards me", "comes toward us",
            "comes toward me", "comes at us", "comes at me", "drives towards us", "drives towards me",
            "is coming towards us", "is coming towards me", "is approaching us", "is approaching me",
            "approach us", "approach me", "come towards us", "come towards me", "drive towards us",
            "drive towards me", "rides towards us", "rides towards me", "heads towards us", "heads towards me",
        ],
    );
    let Some(comes) = comes else { return tokens };
    let us = usize::from(is(tokens.get(1), &["us"]) && is(tokens.first(), &["let"]));
    let from = 1 + 2 * us;
    let Some((_, b)) = tokens.get(from..i).and_then(first_noun).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let place = &tokens[i + n + comes..];
    let lane = trimmed(place).is_empty() || is_place(place);
    if !lane {
        return tokens;
    }
    let np = &tokens[from..from + b];
    if trimmed(place).is_empty() {
        return [np, &led("should come towards us", &tokens[i], &[])].concat();
    }
    [np, &led("should be", &tokens[i], &[place])].concat()
}

/// "make the black car an oncoming car": it should come towards us.
fn oncoming(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make", "turn"]) && is(tokens.get(1), &["the", "that", "my"]);
    let Some((a, b)) = first_noun(&tokens[1.min(tokens.len())..]).filter(|x| made && x.0 < 4) else {
        return tokens;
    };
    let mut k = 1 + b;
    k += usize::from(is(tokens.get(k), &["into"]));
    let way = is(tokens.get(k), &["a", "an"]) && is(tokens.get(k + 1), &["oncoming", "approaching"]);
    let kind = tokens.get(k + 2);
    let same = kind.is_some_and(|t| text(t) == text(&tokens[a + 1]) || is(Some(t), &["vehicle", "one"]));
    if !way || !same || tokens.len() > k + 3 {
        return tokens;
    }
    [&tokens[1..1 + b], &led("should come towards us", &tokens[k], &[])].concat()
}

/// "let the bus be oncoming traffic", "the bus is oncoming now": it comes towards us.
fn is_oncoming(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = leads(
            &tokens[i..],
            &[
                "be oncoming traffic", "be oncoming", "is oncoming", "is now oncoming", "is oncoming now",
                "becomes oncoming traffic", "become oncoming traffic", "is now oncoming traffic", "are oncoming now",
                "are now oncoming", "should be oncoming", "becomes oncoming",
            ],
        )?;
        let clause = out.iter().rposition(|t| t.kind != TokenKind::Word).map_or(0, |k| k + 1);
        let (_, b) = first_noun(&out[clause..])?;
        let known = out[clause..].iter().any(|t| is(Some(t), &["the", "that", "my", "both"]))
            && clause + b == out.len()
            && ends(tokens.get(i + n));
        known.then(|| {
            let be = is(tokens.get(i), &["be", "become"]);
            out.extend(led(if be { "come towards us" } else { "should come towards us" }, &tokens[i], &[]));
            i + n
        })
    })
}

/// "only the white car changes: it moves to 25 m behind me": it does so, and nothing goes.
fn only_that(tokens: Vec<Token>) -> Vec<Token> {
    let only = is(tokens.first(), &["only", "just"]) && is(tokens.get(1), &["the", "that", "my"]);
    let Some((_, b)) = tokens.get(1..).and_then(first_noun).filter(|x| only && x.0 < 5) else {
        return tokens;
    };
    let verb = leads(
        &tokens[1 + b..],
        &[
            "changes", "change", "is different", "are different", "is affected", "is to change", "should change",
            "is changed", "must change", "needs changing", "needs to change", "is concerned",
        ],
    );
    let Some(colon) = verb.map(|n| 1 + b + n).filter(|k| ends(tokens.get(*k)) && *k + 2 < tokens.len()) else {
        return tokens;
    };
    let it = usize::from(is(tokens.get(colon + 1), &["it", "he", "she", "they"]));
    if it == 0 {
        return tokens;
    }
    [&tokens[1..1 + b], &tokens[colon + 2..]].concat()
}

/// "has passed us both, me and the motorbike": me and the motorbike.
fn us_both(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, _| {
        let n = leads(&tokens[i..], &["us both", "both of us", "the two of us"])?;
        let comma = tokens.get(i + n).is_some_and(|t| ends(Some(t)));
        (comma && is(tokens.get(i + n + 1), &["me", "us"]) && is(tokens.get(i + n + 2), &["and"])).then_some(i + n + 1)
    })
}

/// "the white car was tailgating him: 7 metres behind me": what it did leads up to where it is.
fn remark_and_where(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens.iter().position(|t| text(t) == ":") else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "that", "my", "both"]))
    else {
        return tokens;
    };
    let said = tokens.get(b..colon).unwrap_or(&[]);
    let place = trimmed(&tokens[colon + 1..]);
    let metres = place.first().is_some_and(|t| number(t).is_some())
        && place.get(1..).is_some_and(|p| super::words::unit_at(p).is_some())
        && !has_noun(place);
    let told = said.first().is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false))
        && !has_noun(said)
        && !said.iter().any(|t| is(Some(t), &["not", "no"]))
        && !(0..said.len()).any(|k| is_place(&said[k..]) && !text(&said[k]).ends_with("ing"));
    if !metres || !told || talk.fits(&tokens[..b]) == 0 {
        return tokens;
    }
    [&tokens[..b], &led("should be", &tokens[colon], &[place])].concat()
}

/// "has passed me and the car", "has passed the bus": it is ahead of the one that is farther on.
fn passed(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        is(tokens.get(i), &["has", "have"]).then_some(())?;
        let mut k = i + 1;
        while is(tokens.get(k), &["just", "already", "now", "since", "both", "meanwhile"]) {
            k += 1;
        }
        k += leads(&tokens[k..], &["passed", "overtaken", "gone past", "driven past", "ridden past", "got past"])?;
        // (who passed is named: "we have passed the bus" tells of us)
        has_noun(out).then_some(())?;
        k += usize::from(is(tokens.get(k), &["both"]));
        let me = is(tokens.get(k), &["me", "us"]);
        let and = me && is(tokens.get(k + 1), &["and"]);
        let np = tokens.get(if me { k + 2 } else { k }..).unwrap_or(&[]);
        let named = is(np.first(), &["the", "that"]) && (and || !me);
        let other = first_noun(np).filter(|x| named && x.0 < 4).map(|x| &np[..x.1]);
        let end = match other {
            Some(np) if and => k + 2 + np.len(),
            Some(np) => k + np.len(),
            None if me => k + 1,
            None => return None,
        };
        if !ends(tokens.get(end)) && !is(tokens.get(end), &["and", "so"]) {
            return None;
        }
        let beyond = other.filter(|np| {
            let boxes = talk.boxes_of(np);
            !me || !boxes.is_empty() && boxes.iter().all(|b| b.center_m.x > 0.0)
        });
        let at = &tokens[i];
        match beyond {
            Some(np) => out.extend(led("should be ahead of", at, &[np])),
            None => {
                let end = word("me", &tokens[end - 1]);
                out.extend(led("should be ahead of", at, &[&[end]]));
            }
        }
        Some(end)
    })
}

/// "waits at the crossing until the children are across": for how long says nothing of where.
fn waits_until(tokens: Vec<Token>) -> Vec<Token> {
    let Some(wait) = tokens
        .iter()
        .position(|t| is(Some(t), &["wait", "waits", "waiting", "stop", "stops", "stand", "stands", "hold", "holds", "stay", "stays"]))
    else {
        return tokens;
    };
    let Some(i) = (wait + 2..tokens.len()).find(|k| is(tokens.get(*k), &["until", "till"])) else {
        return tokens;
    };
    let end = (i..tokens.len())
        .find(|k| ends(tokens.get(*k)) || is(tokens.get(*k), &["and"]) && *k > i + 2)
        .unwrap_or(tokens.len());
    let clause = &tokens[i + 1..end];
    // ("until it is behind us" is where it ends)
    let other = has_noun(clause) || is(clause.first(), &["they", "everyone", "everybody", "nobody", "we"]);
    let verb = clause
        .iter()
        .skip(1)
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !other || !verb || !(wait + 1..i).any(|k| is_place(&tokens[k..i])) {
        return tokens;
    }
    [&tokens[..i], &tokens[end..]].concat()
}

/// "in its place a fourth barrier stands": another one.
fn another_in_place(tokens: &[Token]) -> Vec<Token> {
    const THERE: &[&str] = &["in its place", "in their place", "in its stead", "in their stead", "in their places"];
    rewritten(tokens, |i, out| {
        let after = out.len() > 2 && leads(&out[out.len() - 3..], THERE).is_some();
        let article = after && is(tokens.get(i), &["a", "an"]);
        let nth = tokens.get(i + 1).is_some_and(|t| {
            super::super::foremost::ordinal(text(t)).is_some() || is(Some(t), &["sixth", "seventh", "eighth", "new"])
        });
        let from = i + 1 + usize::from(nth);
        let (a, b) = article.then(|| first_noun(&tokens[from..]))?.filter(|x| x.0 < 3)?;
        // (of a kind that was spoken of: it is no part of those)
        let kind = text(&tokens[from + b - 1]);
        let again = nth || tokens[..i].iter().any(|t| text(t) == kind);
        again.then(|| {
            out.push(word("another", &tokens[i]));
            out.extend_from_slice(&tokens[from..from + a]);
            from + a
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn turns_of_speech() {
        let said = |list: Vec<Token>| {
            let list: Vec<String> = list.into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said(another_in_place(&tokens("it is gone, and in its place a fourth barrier stands"))),
            "it is gone , and in its place another barrier stands"
        );
        assert_eq!(
            said(works(tokens("this panel works better without the cyclist"))),
            "remove the cyclist"
        );
        assert_eq!(
            said(waits_until(tokens("the bus waits at the crossing until the kids are across"))),
            "the bus waits at the crossing"
        );
        assert_eq!(
            said(no_and_just(tokens("no taxi and no barrier here, just me and that truck"))),
            "remove all taxi and all barrier"
        );
        assert_eq!(
            said(out_of_picture(&tokens("the man has walked out of the frame"))),
            "the man has gone"
        );
    }
}
