//! What is said beside a command: a remark that leads up to it, whom it speaks of, how the new ones are like the old.

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{replaced, rewritten};
use super::Talk;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const LOOKS: &str = "looks our way|looks my way|look our way|look my way|looking our way|looking my way|looks in our direction|looks in my direction|look in our direction|look in my direction|looking in our direction|looking in my direction|glances our way|stares at us|stares our way|gazes at us|watches us|watching us";
const LIKE: &[&str] = &[
    "like the first",
    "like the others",
    "like the other",
    "like the rest",
    "like the ones already there",
    "like those already there",
    "like the ones that are there",
    "like those that are there",
    "like the old ones",
    "like the existing ones",
    "as are the others",
    "as the others are",
    "where the others are",
    "where the others stand",
    "where the first ones are",
    "like the ones there now",
    "the same as the others",
    "just like the others",
    "just like the first",
];

/// A sentence without such remarks.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&tokens, LOOKS, "faces us");
    let out = replaced(&out, "please to", "please");
    let out = now_so_far(gone_on(put_there(out)));
    let out = as_before(out);
    let out = replaced(&out, "the two on foot|both on foot", "the two pedestrians");
    let out = replaced(&out, "the three on foot", "the three pedestrians");
    let out = replaced(&out, "the one on foot", "the pedestrian");
    let out = and_left(out);
    let out = between_us(out);
    let out = deserving(out);
    let out = of_a_kind(out);
    let out = tidied(out);
    let out = left_there(watching(out));
    let out = that_makes(out);
    let out = theirs_instead(out);
    let out = in_to(to_ahead(out));
    like_the_first(out, talk)
}

/// "a colleague told me the taxi is a van": what was told.
pub(super) fn reported(tokens: Vec<Token>) -> Vec<Token> {
    const TELLS: &[&str] = &[
        "told me that",
        "told me",
        "told us that",
        "told us",
        "tells me that",
        "tells me",
        "tells us",
        "tells us that",
        "says that",
        "says",
        "said that",
        "said",
        "reports that",
        "reports",
        "reported that",
        "reported",
        "claims that",
        "claims",
        "claimed that",
        "informs us that",
        "informed us that",
        "informed me that",
        "insists that",
        "swears that",
        "swears",
        "reminds me that",
        "reminded me that",
        "points out that",
        "pointed out that",
        "notes that",
        "noted that",
        "remembers that",
        "recalls that",
    ];
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let fresh = is(tokens.first(), &["a", "my", "our", "an", "one"]);
    let Some(n) = leads(&tokens[b..], TELLS).filter(|_| fresh) else {
        return tokens;
    };
    let rest = &tokens[b + n..];
    if is(
        rest.first(),
        &[
            "the", "both", "all", "there", "it", "my", "two", "three", "nobody", "a", "an", "one",
        ],
    ) && (has_noun(rest) || is(rest.first(), &["it"]))
    {
        return rest.to_vec();
    }
    tokens
}

/// "as before, only that the van is behind us": what is other.
fn as_before(tokens: Vec<Token>) -> Vec<Token> {
    const SAME: &[&str] = &[
        "as before",
        "same as before",
        "the same as before",
        "everything as before",
        "all as before",
        "like before",
        "just as before",
        "as it was",
        "as it is",
        "everything as it is",
        "everything as it was",
        "all as it was",
        "the same scene",
        "same scene",
        "the same again",
        "same again",
        "the same thing",
    ];
    let Some(n) = leads(&tokens, SAME) else {
        return tokens;
    };
    let mut k = n;
    while tokens.get(k).is_some_and(|t| {
        mark(t) && t.kind != TokenKind::Stop
            || is(
                Some(t),
                &["only", "just", "but", "except", "that", "with", "and", "now"],
            )
    }) {
        k += 1;
    }
    let rest = &tokens[k..];
    // ("as before, but with a bus" brings one)
    let with = is(tokens.get(k - 1), &["with"]);
    if k == n || rest.is_empty() || with {
        return tokens;
    }
    rest.to_vec()
}

/// "has found a new owner and left": it is gone, whatever it did before.
fn and_left(tokens: Vec<Token>) -> Vec<Token> {
    const LEFT: &[&str] = &[
        "left",
        "gone",
        "driven off",
        "driven away",
        "walked off",
        "walked away",
        "disappeared",
        "vanished",
        "gone home",
        "moved on",
        "ridden off",
        "run off",
        "departed",
        "cleared off",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["and"]).then_some(())?;
        let n = leads(&tokens[i + 1..], LEFT)?;
        let end = i + 1 + n;
        tokens.get(end).is_none_or(mark).then_some(())?;
        let from = tokens[..i]
            .iter()
            .rposition(|t| mark(t) || is(Some(t), &["and", "but"]))
            .map_or(0, |k| k + 1);
        let (_, b) = first_noun(&tokens[from..i]).filter(|x| x.0 < 4)?;
        let has = from + b;
        let known = is(
            tokens.get(from),
            &["the", "both", "my", "that", "those", "these", "all", "one", "two"],
        );
        (known && is(tokens.get(has), &["has", "have"]) && i > has + 1).then_some((has + 1, i + 1))
    });
    match found {
        Some((from, to)) => [&tokens[..from], &tokens[to..]].concat(),
        None => tokens,
    }
}

/// "behind us, with 10 m between": 10 m behind us.
fn between_us(tokens: Vec<Token>) -> Vec<Token> {
    const PLACES: &[&str] = &[
        "behind us",
        "behind me",
        "ahead of us",
        "ahead of me",
        "in front of us",
        "in front of me",
        "behind",
        "ahead",
        "in front",
    ];
    let Some((i, n)) = find(&tokens, PLACES).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let mut k = i + n;
    while is(tokens.get(k), &[",", "with", "and", "leaving", "keeping", "at"])
        || tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma)
    {
        k += 1;
    }
    let metres =
        tokens.get(k).is_some_and(|t| number(t).is_some()) && super::words::is_unit(tokens.get(k + 1));
    let Some(m) = leads(
        &tokens[(k + 2).min(tokens.len())..],
        &[
            "between us",
            "in between",
            "between",
            "of space",
            "of space between",
            "of space between us",
            "of space in between",
            "of distance",
            "distance",
            "gap",
            "free",
            "apart",
            "of distance between us",
            "of air between us",
        ],
    )
    .filter(|_| metres && k > i + n) else {
        return tokens;
    };
    if tokens.get(k + 2 + m).is_some_and(|t| !mark(t)) {
        return tokens;
    }
    [
        &tokens[..i],
        &tokens[k..k + 2],
        &tokens[i..i + n],
        &tokens[k + 2 + m..],
    ]
    .concat()
}

/// "there is one barrier too many; take it away": said twice.
pub fn told_once(mut tokens: Vec<Token>) -> Vec<Token> {
    let found = (3..tokens.len()).find_map(|i| {
        let too = is(tokens.get(i - 1), &["many", "much"]) && is(tokens.get(i - 2), &["too"]);
        (too && mark(&tokens[i])).then_some(())?;
        let lead = tokens[..i]
            .iter()
            .rposition(|t| t.kind == TokenKind::Stop)
            .map_or(0, |k| k + 1);
        let counted = leads(&tokens[lead..i], &["there is", "there are", "theres"]).is_some_and(|n| {
            tokens.get(lead + n).is_some_and(|t| number(t).is_some()) && has_noun(&tokens[lead + n..i])
        });
        let mut from = i + 1;
        while is(tokens.get(from), &["so", "please", "and", "just"]) {
            from += 1;
        }
        let close = (from..tokens.len())
            .find(|k| mark(&tokens[*k]) || is(tokens.get(*k), &["and"]))
            .unwrap_or(tokens.len());
        (counted && super::some_of::removes_it(&tokens[from..close])).then_some((i, close))
    });
    if let Some((i, close)) = found {
        let ends = tokens.get(close).is_none_or(|t| t.kind == TokenKind::Stop);
        tokens.drain(if ends { i..close } else { i + 1..close + 1 });
    }
    tokens
}

fn mark(t: &Token) -> bool {
    matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop)
}

/// "the cyclist deserves a better place: let him ride in our lane": let the cyclist do so.
fn deserving(tokens: Vec<Token>) -> Vec<Token> {
    const WANTS: &[&str] = &[
        "deserves",
        "deserve",
        "needs",
        "need",
        "wants",
        "want",
        "could use",
        "could do with",
        "can do with",
        "has earned",
        "have earned",
        "ought to have",
        "merits",
        "is due",
        "is after",
        "is looking for",
        "are looking for",
        "would like",
    ];
    const PLACES: &[&str] = &[
        "place",
        "spot",
        "position",
        "location",
        "home",
        "lane",
        "side",
        "change",
        "break",
        "rest",
        "neighbour",
        "view",
        "treatment",
        "job",
        "task",
    ];
    let Some((i, n)) = find(&tokens, WANTS).filter(|x| x.0 > 1) else {
        return tokens;
    };
    let who = &tokens[..i];
    let definite = is(who.first(), &["the", "that", "my", "both", "those", "these"]);
    let Some(cut) = (i + n..tokens.len().min(i + n + 6)).find(|k| mark(&tokens[*k])) else {
        return tokens;
    };
    let what = &tokens[i + n..cut];
    let remark = what.iter().any(|t| PLACES.contains(&text(t))) && !has_noun(what);
    let rest = trimmed(&tokens[cut..]);
    let rest = if is(rest.first(), &[":"]) {
        trimmed(&rest[1..])
    } else {
        rest
    };
    let Some(at) = rest
        .iter()
        .position(|t| matches!(text(t), "it" | "him" | "her" | "them"))
    else {
        return tokens;
    };
    if !definite || !remark || !rest.first().is_some_and(is_verb) || first_noun(&rest[..at]).is_some() {
        return tokens;
    }
    [&rest[..at], who, &rest[at + 1..]].concat()
}

/// "cyclists pay no tax: replace the car by two of them": a remark on a kind, which "them" means.
fn of_a_kind(tokens: Vec<Token>) -> Vec<Token> {
    let Some(colon) = (2..tokens.len())
        .find(|k| matches!(text(&tokens[*k]), ":" | "-" | "–" | "—") || tokens[*k].kind == TokenKind::Stop)
    else {
        return tokens;
    };
    let Some((0, b)) = first_noun(&tokens) else {
        return tokens;
    };
    let many = matches!(look_up(text(&tokens[b - 1])), Some(Sense::Noun(_, true)));
    let remark = &tokens[b..colon.max(b)];
    let rest = trimmed(&tokens[colon + 1..]);
    let told = remark
        .iter()
        .any(|t| HELPERS.contains(&text(t)) && !is(Some(t), &["do", "does", "need"]) || number(t).is_some())
        || is_place(remark)
        || has_noun(remark)
        || !remark.iter().all(|t| t.kind == TokenKind::Word);
    if !many || remark.len() < 2 || told || !rest.first().is_some_and(is_verb) {
        return tokens;
    }
    let Some(at) = rest.iter().position(|t| text(t) == "them") else {
        return tokens;
    };
    let of = usize::from(at > 0 && is(rest.get(at - 1), &["of"]));
    [&rest[..at - of], &tokens[..b], &rest[at + 1..]].concat()
}

/// "somebody has tidied the cones away": they are taken away.
fn tidied(tokens: Vec<Token>) -> Vec<Token> {
    const WHO: &[&str] = &[
        "somebody has",
        "someone has",
        "somebody",
        "someone",
        "they have",
        "people have",
        "we have",
        "the police have",
        "the council has",
        "a colleague has",
        "the crew has",
        "the workers have",
        "workers have",
    ];
    const AWAY: &[&str] = &["away", "off", "up", "out", "aside"];
    const DONE: &[&str] = &[
        "tidied",
        "cleared",
        "cleaned",
        "packed",
        "taken",
        "carried",
        "carted",
        "swept",
        "towed",
        "put",
        "stowed",
        "hauled",
        "collected",
        "gathered",
        "picked",
        "dragged",
        "rolled",
        "driven",
        "took",
        "towed",
        "locked",
        "loaded",
        "wheeled",
    ];
    const ALONE: &[&str] = &[
        "removed",
        "stolen",
        "collected",
        "cleared",
        "confiscated",
        "stole",
        "impounded",
    ];
    let found = (0..tokens.len()).find_map(|i| {
        let starts = i == 0 || mark(&tokens[i - 1]) || is(tokens.get(i - 1), &["and", "but"]);
        let n = leads(&tokens[i..], WHO).filter(|_| starts)?;
        let n = n + leads(&tokens[i + n..], &["just", "already", "now", "finally", "since"]).unwrap_or(0);
        let verb = tokens.get(i + n)?;
        let from = i + n + 1;
        let early = usize::from(is(tokens.get(from), AWAY));
        let np = from + early;
        is(
            tokens.get(np),
            &["the", "all", "both", "my", "our", "that", "those", "these"],
        )
        .then_some(())?;
        let (_, b) = first_noun(&tokens[np..]).filter(|x| x.0 < 5)?;
        let close = (np + b..tokens.len())
            .find(|k| mark(&tokens[*k]) || is(tokens.get(*k), &["and", "but"]))
            .unwrap_or(tokens.len());
        let late = is(tokens.get(close - 1), AWAY);
        let all = DONE.contains(&text(verb)) && (late || early == 1)
            || ALONE.contains(&text(verb)) && close == np + b;
        all.then_some((i, np, if late { close - 1 } else { close }, close))
    });
    match found {
        Some((i, np, end, close)) => {
            let remove = led("remove", &tokens[i], &[&tokens[np..end]]);
            [&tokens[..i], &remove, &tokens[close..]].concat()
        }
        None => tokens,
    }
}

/// "somebody parked a bike at the right kerb": one is there.
fn left_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "somebody has",
            "someone has",
            "somebody",
            "someone",
            "they have",
            "they",
        ],
    ) else {
        return tokens;
    };
    let verb = is(
        tokens.get(n),
        &[
            "parked",
            "put",
            "left",
            "placed",
            "abandoned",
            "dumped",
            "dropped",
            "set",
            "stood",
            "added",
            "erected",
        ],
    );
    let k = n + 1 + usize::from(is(tokens.get(n + 1), &["up", "down"]));
    let fresh =
        is(tokens.get(k), &["a", "an", "another"]) || tokens.get(k).is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(&tokens[k.min(tokens.len())..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    if verb && fresh && is_place(&tokens[k + b..]) {
        return led("add", &tokens[0], &[&tokens[k..]]);
    }
    tokens
}

/// "add three more, then there are five": it says so already.
fn that_makes(mut tokens: Vec<Token>) -> Vec<Token> {
    let found = (3..tokens.len()).find_map(|i| {
        mark(&tokens[i - 1]).then_some(())?;
        let n = leads(
            &tokens[i..],
            &[
                "then there are",
                "then there will be",
                "then we have",
                "that makes",
                "which makes",
                "that is",
                "making",
                "so there are then",
            ],
        )?;
        tokens.get(i + n).filter(|t| number(t).is_some())?;
        let end = i
            + n
            + 1
            + leads(
                &tokens[i + n + 1..],
                &["of them", "in all", "altogether", "in total", "all told"],
            )
            .unwrap_or(0);
        let counted = tokens[..i]
            .iter()
            .any(|t| is(Some(t), &["more", "another", "fewer", "less"]));
        (counted && tokens.get(end).is_none_or(|t| t.kind == TokenKind::Stop)).then_some((i - 1, end))
    });
    if let Some((from, end)) = found {
        tokens.drain(from..end);
    }
    tokens
}

/// "three people watch it all from the left pavement": they are there.
fn watching(tokens: Vec<Token>) -> Vec<Token> {
    const WATCH: &[&str] = &[
        "watch",
        "watches",
        "watching",
        "observe",
        "observes",
        "look on",
        "looks on",
        "looking on",
        "are watching",
        "is watching",
        "follow the action",
        "spectate",
        "film",
        "films",
        "filming",
        "are filming",
        "is filming",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], WATCH)?;
        let from = (i + n..tokens.len().min(i + n + 5)).find(|k| is(tokens.get(*k), &["from"]))?;
        let what = tokens[i + n..from].iter().all(|t| {
            is(
                Some(t),
                &[
                    "it",
                    "all",
                    "this",
                    "that",
                    "everything",
                    "us",
                    "the",
                    "scene",
                    "traffic",
                    "action",
                    "whole",
                    "thing",
                    "on",
                    "what",
                    "happens",
                    "goes",
                    "going",
                ],
            )
        });
        (what && is_place(&led("on", &tokens[i], &[&tokens[from + 1..]]))).then_some((i, from))
    });
    match found {
        Some((i, from)) if has_noun(&tokens[..i]) => {
            let on = led("should be on", &tokens[i], &[]);
            [&tokens[..i], &on, &tokens[from + 1..]].concat()
        }
        _ => tokens,
    }
}

/// "their mother stands there instead", "a lorry is parked there instead": in the place of those who are gone.
fn theirs_instead(tokens: Vec<Token>) -> Vec<Token> {
    let whole = trimmed(&tokens);
    let from = whole
        .iter()
        .rposition(|t| mark(t) || is(Some(t), &["and"]))
        .map_or(0, |k| k + 1);
    let body = &whole[from..];
    let theirs = is(body.first(), &["their", "his", "her", "its"]);
    let fresh =
        is(body.first(), &["a", "an", "another"]) || body.first().is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(body).filter(|x| x.0 < 4 && (theirs || fresh)) else {
        return tokens;
    };
    let tail = &body[b..];
    // ("instead" at the end is cut off by `trimmed`)
    let instead = tokens.iter().rev().take(3).any(|t| text(t) == "instead");
    let verb = leads(
        tail,
        &[
            "stands",
            "stand",
            "is",
            "are",
            "waits",
            "wait",
            "sits",
            "walks",
            "now stands",
            "is now",
            "is standing",
            "is waiting",
            "comes",
            "has come",
            "is parked",
            "are parked",
            "is now parked",
            "has parked",
            "are standing",
        ],
    )
    .unwrap_or(0);
    let there = leads(
        &tail[verb..],
        &[
            "there",
            "here",
            "in their place",
            "in its place",
            "in his place",
            "in her place",
        ],
    );
    if verb == 0 || there != Some(tail.len() - verb) || !(instead || is(tail.last(), &["place"])) {
        return tokens;
    }
    let np = if theirs {
        led("a", &body[0], &[&body[1..b]])
    } else {
        body[..b].to_vec()
    };
    let put = led("put", &body[0], &[&np, &led("in their place", &body[0], &[])]);
    [&whole[..from], &put].concat()
}

/// "put there a bus": put a bus there.
fn put_there(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find(|i| {
        let fresh = is(tokens.get(i + 1), &["a", "an", "one", "another", "some"])
            || tokens.get(i + 1).is_some_and(|t| number(t).is_some());
        is(tokens.get(*i), &["there", "here"])
            && is(tokens.get(i - 1), &["put", "place", "set", "park"])
            && fresh
    });
    let Some(i) = found else {
        return tokens;
    };
    match first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4) {
        Some((_, b)) => {
            let there = led("in its place", &tokens[i], &[]);
            [
                &tokens[..i],
                &tokens[i + 1..i + 1 + b],
                &there,
                &tokens[i + 1 + b..],
            ]
            .concat()
        }
        None => tokens,
    }
}

/// "the taxi has gone on to 20 m ahead": there it is.
fn gone_on(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], &["has", "have", "is"]).unwrap_or(0);
        let m = leads(
            &tokens[i + n..],
            &[
                "gone",
                "moved",
                "driven",
                "rolled",
                "pulled",
                "gone on",
                "moved on",
                "driven on",
                "rolled on",
                "gone ahead",
                "goes",
                "moves",
                "drives",
                "rolls",
                "rides",
                "ridden",
                "goes on",
                "moves on",
                "drives on",
                "rolls on",
                "rides on",
                "closed",
                "closed up",
                "closes up",
                "come",
                "comes",
                "crept",
                "crept up",
            ],
        )?;
        let mut k = i + n + m;
        k += usize::from(is(
            tokens.get(k),
            &["on", "up", "in", "out", "forward", "back", "further", "ahead"],
        ));
        k += usize::from(is(tokens.get(k), &["to", "until"]));
        let to = is(tokens.get(k - 1), &["to", "until"]);
        let metres =
            tokens.get(k).is_some_and(|t| number(t).is_some()) && super::words::is_unit(tokens.get(k + 1));
        let there = is(tokens.get(k + 2), &["ahead", "behind"])
            || leads(
                &tokens[(k + 2).min(tokens.len())..],
                &["in front of us", "in front of me", "in front"],
            )
            .is_some();
        (to && metres && there && has_noun(&tokens[..i])).then_some((i, k))
    });
    let Some((i, k)) = found else {
        return tokens;
    };
    let mut rest = tokens[k..].to_vec();
    if rest.get(3).is_none_or(|t| mark(t) || is(Some(t), &["and"])) && is(rest.get(2), &["ahead", "behind"]) {
        let us = led(
            if text(&rest[2]) == "ahead" { "of us" } else { "us" },
            &tokens[i],
            &[],
        );
        rest.splice(3..3, us);
    }
    [&tokens[..i], &led("should be", &tokens[i], &[]), &rest].concat()
}

/// "drop back to 10 m ahead": a place ahead of us, no step.
fn to_ahead(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let metres = is(tokens.get(i), &["to", "until"])
            && tokens.get(i + 1).is_some_and(|t| number(t).is_some())
            && super::words::is_unit(tokens.get(i + 2));
        let next = tokens.get(i + 4);
        let ends = next.is_none_or(|t| mark(t) || is(Some(t), &["and", "but", "in", "on"]));
        let us = match tokens.get(i + 3).map(text).filter(|_| metres && ends)? {
            "ahead" => "of us",
            "behind" => "us",
            _ => return None,
        };
        out.extend_from_slice(&tokens[i..i + 4]);
        out.extend(led(us, &tokens[i], &[]));
        Some(i + 4)
    })
}

/// "has overtaken us and now rides 8 m ahead": ahead of us, not by so much.
fn now_so_far(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        let now = is(tokens.get(i), &["now"]);
        let done = is(tokens.get(i), &["and"])
            && tokens[..i].iter().any(|t| is(Some(t), &["has", "have"]))
            && has_noun(&tokens[..i]);
        let metres = (i + 1..tokens.len().min(i + 5)).find(|k| number(&tokens[*k]).is_some())?;
        let verb = tokens[i + 1..metres].iter().any(|t| {
            super::words::is_finite(text(t), false)
                && !is(Some(t), &["moved", "backed", "rolled", "pulled", "pushed"])
                || text(t).ends_with("ing")
                || is(Some(t), &["is", "are", "drive", "ride", "walk", "stand", "wait"])
        });
        let end = metres + 2;
        let ahead = is(tokens.get(end), &["ahead", "behind"])
            && tokens
                .get(end + 1)
                .is_none_or(|t| mark(t) || is(Some(t), &["and", "in", "on"]));
        ((now || done) && verb && super::words::is_unit(tokens.get(metres + 1)) && ahead).then_some(end)
    });
    match found {
        Some(end) => {
            let us = if text(&tokens[end]) == "ahead" {
                "of us"
            } else {
                "us"
            };
            [&tokens[..=end], &led(us, &tokens[end], &[]), &tokens[end + 1..]].concat()
        }
        None => tokens,
    }
}

/// "pull the cones in to 15 m ahead": to there, not by so much.
fn in_to(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "in to",
                "out to",
                "up to",
                "forward to",
                "back to",
                "down to",
                "closer to",
                "nearer to",
                "over to",
                "to",
            ],
        )?;
        let metres = tokens.get(i + n).is_some_and(|t| number(t).is_some())
            && super::words::is_unit(tokens.get(i + n + 1));
        // ("to 30 m ahead", and no more)
        let bare = is(tokens.get(i + n + 2), &["ahead", "behind"])
            && tokens
                .get(i + n + 3)
                .is_none_or(|t| mark(t) || is(Some(t), &["and"]));
        (metres && (n > 1 || bare)).then_some((i, n))
    });
    let Some((i, n)) = found else {
        return tokens;
    };
    let from = (0..i).rev().find(|k| {
        is(
            tokens.get(*k),
            &[
                "pull", "draw", "bring", "move", "push", "shift", "take", "drag", "set", "slide",
            ],
        )
    });
    let Some(from) = from.filter(|f| first_noun(&tokens[*f..i]).is_some_and(|x| f + x.1 == i) || i == f + 2)
    else {
        return tokens;
    };
    let place = &tokens[i + n + 2..];
    if !is_place(place) || is(place.first(), &["away", "further", "farther"]) {
        return tokens;
    }
    let mut out = tokens.clone();
    out[from].text = "move".into();
    [&out[..i], &led("to", &tokens[i], &[]), &out[i + n..]].concat()
}

/// "twice as many pedestrians, all of them on the right sidewalk like the first four": where they are is known.
fn like_the_first(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let times = leads(
        &tokens,
        &[
            "twice as many",
            "double the number of",
            "double the",
            "three times as many",
            "triple the",
            "triple the number of",
            "twice the number of",
            "twice the",
        ],
    );
    let mut out = tokens;
    if let Some((i, n)) = find(&out, LIKE).filter(|x| x.0 > 2) {
        let mut end = i + n;
        while out
            .get(end)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["ones", "one"]))
        {
            end += 1;
        }
        if out.get(end).is_none_or(mark) {
            out.drain(i..end);
        }
    }
    let (Some(n), Some((k, m))) = (
        times,
        find(&out, &["all of them", "each of them", "every one of them", "all"]).filter(|x| x.0 > 2),
    ) else {
        return out;
    };
    let Some((a, b)) = first_noun(&out[n..])
        .map(|x| (n + x.0, n + x.1))
        .filter(|x| x.1 <= k)
    else {
        return out;
    };
    let place = &out[k + m..];
    let alike = is_place(place) && !has_noun(place) && {
        let np = [&out[a..b], place].concat();
        talk.fits(&np) == talk.fits(&out[a..b])
    };
    let close = trimmed(&out[..k]).len();
    if alike && mark(&out[k - 1]) {
        out.truncate(close);
    }
    out
}
