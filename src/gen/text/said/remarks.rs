//! What is said beside a command: a remark that leads up to it, whom it speaks of, how the new ones are like the old.

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
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
    let out = deserving(out);
    let out = of_a_kind(out);
    let out = tidied(out);
    let out = watching(out);
    let out = theirs_instead(out);
    let out = in_to(out);
    like_the_first(out, talk)
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

/// "their mother stands there instead": a mother, in the place of those who are gone.
fn theirs_instead(tokens: Vec<Token>) -> Vec<Token> {
    let body = trimmed(&tokens);
    if !is(body.first(), &["their", "his", "her", "its", "a", "an"]) {
        return tokens;
    }
    let Some((_, b)) = first_noun(body).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let tail = &body[b..];
    // ("instead" at the end is cut off by `trimmed`)
    let instead = tokens.iter().any(|t| text(t) == "instead");
    let verb = leads(
        tail,
        &[
            "stands",
            "stand",
            "is",
            "waits",
            "sits",
            "walks",
            "now stands",
            "is now",
            "is standing",
            "is waiting",
            "comes",
            "has come",
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
    if verb > 0 && there == Some(tail.len() - verb) && (instead || is(tail.last(), &["place"])) {
        return led(
            "put a",
            &tokens[0],
            &[&body[1..b], &led("in their place", &tokens[0], &[])],
        );
    }
    tokens
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
            ],
        )?;
        let metres = tokens.get(i + n).is_some_and(|t| number(t).is_some())
            && super::words::is_unit(tokens.get(i + n + 1));
        metres.then_some((i, n))
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
    // ("15 m ahead" alone is a step)
    let bare = i + n + 3;
    if is(out.get(bare - 1), &["ahead", "behind"])
        && out.get(bare).is_none_or(|t| mark(t) || is(Some(t), &["and"]))
    {
        let us = led(
            if text(&out[bare - 1]) == "ahead" {
                "of us"
            } else {
                "us"
            },
            &tokens[i],
            &[],
        );
        out.splice(bare..bare, us);
    }
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
