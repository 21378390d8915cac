//! Imperatives that move, turn or replace what the scene has.

use super::super::edit_grammar::Back;
use super::super::tokens::{Token, TokenKind};
use super::lists::MOVES;
use super::predicate::parts;
use super::subject::{Kind, Subject, pointing};
use super::ways::split;
use super::words::{self, find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use super::{Piece, Talk, acts, predicate};

/// "turn the man so that his back is towards us": the end of the sentence says how.
pub(super) fn turn_about(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if !is(
        inner.first(),
        &[
            "turn",
            "rotate",
            "spin",
            "swivel",
            "orient",
            "orientate",
            "position",
            "place",
            "put",
        ],
    ) {
        return None;
    }
    // "turn it around"
    if is(inner.get(1), &["it", "him", "her", "them"])
        && inner.len() > 2
        && !is(inner.get(2), &["into", "on", "off", "up", "down"])
        && matches!(text(&inner[0]), "turn" | "rotate" | "spin" | "swivel")
        && !inner.iter().any(|t| matches!(text(t), "into" | "so"))
    {
        let s = Subject {
            kind: Kind::Back(if is(inner.get(1), &["him", "her"]) {
                Back::Person
            } else {
                Back::Same
            }),
            np: inner[1..2].to_vec(),
            noun: Vec::new(),
            pred: 2,
            plural: false,
        };
        let part = predicate::Part {
            main: led("turn", &inner[0], &[&inner[2..]]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    let (i, n) = find(
        inner,
        &["so that", "such that", "in such a way that", "with", "so"],
    )?;
    let end = first_noun(&inner[1..]).map_or(2, |x| x.1 + 1);
    if i < end || inner[end..i].iter().any(|t| t.kind == TokenKind::Comma) {
        return None;
    }
    let mut rest = &inner[i + n..];
    while is(
        rest.first(),
        &["it", "he", "she", "they", "its", "his", "her", "their", "the"],
    ) {
        rest = &rest[1..];
    }
    let about = rest.iter().any(|t| {
        matches!(
            text(t),
            "back"
                | "backs"
                | "rear"
                | "tail"
                | "front"
                | "nose"
                | "face"
                | "faces"
                | "facing"
                | "looks"
                | "look"
                | "points"
                | "point"
        )
    });
    if !about {
        return None;
    }
    let (kind, np) = match text(&inner[1]) {
        "it" | "them" => (Kind::Back(Back::Same), &inner[1..2]),
        "him" | "her" => (Kind::Back(Back::Person), &inner[1..2]),
        _ => (Kind::Known, &inner[1..end]),
    };
    let s = Subject {
        kind,
        np: np.to_vec(),
        noun: first_noun(np).map(|n| np[n.0..n.1].to_vec()).unwrap_or_default(),
        pred: end,
        plural: false,
    };
    let part = predicate::Part {
        main: led("turn", &inner[0], &[rest]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "replace three of the cones with barriers"
pub(super) fn some_replaced(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let verb = is(
        inner.first(),
        &[
            "replace",
            "swap",
            "exchange",
            "change",
            "turn",
            "convert",
            "substitute",
            "transform",
            "make",
        ],
    );
    let part = number(inner.get(1)?).is_some() && is(inner.get(2), &["of"]);
    if verb && !part && number(inner.get(1)?).is_some() {
        // "turn one car into a bus", of several
        let n = number(&inner[1])?.max(0) as usize;
        let (_, b) = first_noun(&inner[2..]).filter(|x| x.0 < 3)?;
        let k = (2 + b..inner.len())
            .find(|k| is(inner.get(*k), &["with", "by", "for", "into", "to", "against"]))?;
        let old = &inner[2..k];
        let swaps = is(inner.first(), &["swap", "exchange", "substitute"])
            && is(inner.get(k + 1), &["the", "all", "both"]);
        if swaps || n == 0 || talk.fits(old) <= n || !has_noun(&inner[k + 1..]) {
            return None;
        }
        let s = Subject {
            kind: Kind::Part,
            np: led("any", &inner[0], &[&inner[1..k]]),
            noun: inner[2..2 + b].to_vec(),
            pred: k,
            plural: true,
        };
        let part = predicate::Part {
            main: led("replaced by", &inner[0], &[&inner[k + 1..]]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    if !(verb && part) {
        return None;
    }
    let k = (3..inner.len()).find(|k| is(inner.get(*k), &["with", "by", "for", "into", "to", "against"]))?;
    let (a, b) = first_noun(&inner[3..k])?;
    let rest: Vec<Token> = inner[4..k]
        .iter()
        .filter(|t| number(t).is_none())
        .cloned()
        .collect();
    let s = Subject {
        kind: Kind::Part,
        np: led("any", &inner[0], &[&inner[1..2], &rest]),
        noun: inner[3 + a..3 + b].to_vec(),
        pred: k,
        plural: true,
    };
    let part = predicate::Part {
        main: led("replaced by", &inner[0], &[&inner[k + 1..]]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "put the car in the middle of my lane", "take it 5 m further back": what is known is moved.
pub(super) fn imperative(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let first = inner.first()?;
    // "add him", "put him there": he is there
    let added = matches!(text(first), "add" | "include" | "insert" | "put" | "place")
        && is(inner.get(1), &["it", "him", "her", "them"]);
    if added
        && inner[2..].iter().all(|t| {
            matches!(
                text(t),
                "there"
                    | "in"
                    | "too"
                    | "please"
                    | "now"
                    | "here"
                    | "into"
                    | "the"
                    | "scene"
                    | "picture"
                    | "to"
            )
        })
    {
        return Some(Vec::new());
    }
    let counts = inner
        .iter()
        .any(|t| matches!(text(t), "number" | "amount" | "count" | "total"));
    let makes = matches!(text(first), "make" | "have" | "let" | "get");
    // "make it 24 m behind us" says where, "make it five" how many
    let so_far = makes
        && inner.get(2).is_some_and(|t| number(t).is_some())
        && inner.get(3..).and_then(words::unit_at).is_some();
    if let Some(found) = made_into(inner, talk).or_else(|| rid_of_others(inner, talk)) {
        return Some(found);
    }
    if !MOVES.contains(&text(first)) || counts {
        return None;
    }
    if makes
        && is(inner.get(1), &["it", "that", "this"])
        && inner
            .get(2)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an"]))
        && !so_far
    {
        return None;
    }
    if text(first) == "make" && made_another(&inner[1..]) {
        return None;
    }
    let mut from = 1;
    while is(inner.get(from), &["over", "back", "up", "forward", "down"])
        && inner
            .get(from + 1)
            .is_some_and(|t| matches!(text(t), "the" | "both" | "that" | "my" | "it" | "all"))
    {
        from += 1;
    }
    let tokens = &inner[from..];
    let pronoun = is(tokens.first(), &["it", "him", "her", "them"]);
    let others = pointing(tokens).filter(|p| p.0 == Back::Others);
    let (np_end, s) = if let Some((back, n)) = others {
        let s = Subject {
            kind: Kind::Back(back),
            np: tokens[..n].to_vec(),
            noun: Vec::new(),
            pred: n,
            plural: false,
        };
        (n, s)
    } else if pronoun {
        let back = if is(tokens.first(), &["him", "her"]) {
            Back::Person
        } else {
            Back::Same
        };
        let s = Subject {
            kind: Kind::Back(back),
            np: tokens[..1].to_vec(),
            noun: Vec::new(),
            pred: 1,
            plural: false,
        };
        (1, s)
    } else {
        // "move one worker to the left, the other stays"
        let one_of = talk.others
            && first_noun(tokens).filter(|n| n.0 < 4).is_some_and(|n| {
                number(&tokens[0]).is_some_and(|k| talk.fits(&tokens[n.0..n.1]) > k.max(0) as usize)
            });
        let known = is(
            tokens.first(),
            &[
                "everything",
                "everyone",
                "everybody",
                "the",
                "that",
                "this",
                "those",
                "these",
                "both",
                "my",
                "all",
                "our",
                "every",
            ],
        ) || tokens.first().is_some_and(|t| {
            words::noun_at(std::slice::from_ref(t)).is_some() && !is(Some(t), &["somebody", "someone"])
        }) && talk.fits(&tokens[..first_noun(tokens)?.1]) > 0
            || number(tokens.first()?).is_some() && is(tokens.get(1), &["of"])
            || one_of;
        if !known {
            return None;
        }
        let noun = first_noun(tokens).filter(|n| n.0 < 7)?;
        let clean = tokens[..noun.0]
            .iter()
            .all(|t| t.kind != TokenKind::Comma && !matches!(text(t), "and" | "rid"));
        let two = is(tokens.get(noun.1), &["and"]);
        // "move the bus and the van to the right lane"
        let second = noun.1 + 1;
        let both =
            two && is(
                tokens.get(second),
                &["the", "my", "that", "both", "our", "those", "these"],
            ) && tokens
                .get(second..)
                .and_then(first_noun)
                .is_some_and(|n| n.0 < 5 && !is(tokens.get(second + n.1), &["and"]));
        if !clean || two && !both {
            return None;
        }
        let split = match both {
            true => second + split(&tokens[second..], talk)?,
            false => split(tokens, talk)?,
        };
        let part = is(tokens.get(1), &["of"]) && number(&tokens[0]).is_some();
        let np = if part {
            // "one of the two pedestrians"
            let rest: Vec<Token> = tokens[2..split]
                .iter()
                .enumerate()
                .filter(|(i, t)| !(*i == 1 && number(t).is_some()))
                .map(|(_, t)| t.clone())
                .collect();
            led("any", first, &[&tokens[..1], &rest])
        } else if one_of {
            led("any", first, &[&tokens[..split]])
        } else {
            tokens[..split].to_vec()
        };
        let s = Subject {
            kind: if part || one_of { Kind::Part } else { Kind::Known },
            np,
            noun: tokens[noun.0..noun.1].to_vec(),
            pred: split,
            plural: false,
        };
        (split, s)
    };
    let rest = trimmed(&tokens[np_end..]);
    // "out of my lane and onto the sidewalk"
    let goal = leads(rest, &["out of", "off", "away from", "from"])
        .and_then(|_| (1..rest.len()).find(|i| words::is_goal(&rest[*i..]) || is(rest.get(*i), &["to"])));
    // "out of the left lane and behind the truck"
    let goal = goal.or_else(|| {
        leads(rest, &["out of", "off", "away from", "from"])
            .and_then(|_| (1..rest.len()).find(|i| text(&rest[*i]) == "and" && is_place(&rest[i + 1..])))
            .map(|i| i + 1)
    });
    let rest = &rest[goal.unwrap_or(0)..];
    // "out of my lane and put it on the sidewalk"
    let put = leads(rest, &["out", "off", "away", "from", "up"]).and_then(|_| {
        (1..rest.len()).find(|i| {
            is(
                rest.get(*i),
                &[
                    "put", "place", "set", "move", "bring", "park", "lay", "leave", "send", "stand",
                ],
            ) && is(rest.get(i + 1), &["it", "them", "him", "her"])
        })
    });
    let rest = &rest[put.map_or(0, |k| k + 2)..];
    let out_of = leads(rest, &["out", "away", "off", "out of", "down"]).is_some() && !predicate_places(rest);
    if s.kind == Kind::Part && out_of {
        let part = predicate::Part {
            main: led("gone", first, &[]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    if rest.is_empty() || out_of {
        return None;
    }
    if !(0..rest.len()).any(|i| is_place(&rest[i..])) {
        return None;
    }
    // the verb says that metres are a way to go
    let mut main = vec![words::word(if so_far { "keep" } else { "move" }, first)];
    main.extend(inner[1..from].iter().cloned());
    let mut said = parts(rest, true);
    for p in &mut said {
        p.helped = true;
        p.is = false;
        p.not = false;
        p.perfect = false;
    }
    if let Some(p) = said.first_mut() {
        let park = matches!(text(first), "park" | "stand" | "leave");
        let mut whole = if park {
            vec![words::word(
                if text(first) == "park" {
                    "parked"
                } else {
                    "standing"
                },
                first,
            )]
        } else {
            main
        };
        whole.extend(std::mem::take(&mut p.main));
        p.main = whole;
    }
    acts::acts(&s, &said, true, inner, talk)
}

/// "make the truck behind me a bus": the place tells which, and what it becomes is named at the end.
fn made_another(tokens: &[Token]) -> bool {
    let Some((_, b)) = first_noun(tokens).filter(|n| n.0 < 4 && is_place(&tokens[n.1..])) else {
        return false;
    };
    (b + 1..tokens.len()).any(|k| {
        let into = usize::from(is(tokens.get(k), &["into"]));
        let of_place = is(
            tokens.get(k - 1),
            &[
                "behind",
                "beside",
                "near",
                "by",
                "at",
                "on",
                "in",
                "of",
                "to",
                "alongside",
                "opposite",
                "between",
                "and",
                "past",
                "with",
                "from",
                "over",
                "after",
                "before",
                "against",
                "like",
                "into",
                "onto",
                "than",
            ],
        );
        let end = tokens.len()
            - tokens[k..]
                .iter()
                .rev()
                .take_while(|t| t.kind != TokenKind::Word)
                .count();
        !of_place
            && is(tokens.get(k + into), &["a", "an"])
            && first_noun(&tokens[k + into..]).is_some_and(|n| n.0 < 4 && k + into + n.1 == end)
    })
}

/// "the bus: make it a van", "turn it into a van".
fn made_into(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let first = inner.first()?;
    let one = first_noun(inner).filter(|n| n.0 > 2 && n.0 < 6 && n.1 == inner.len());
    let into = usize::from(is(inner.get(2), &["into", "to"]));
    let makes_of = if into == 1 {
        is(Some(first), &["turn", "change", "convert", "transform", "make"])
    } else {
        text(first) == "make"
    };
    // "turn the other one into a truck", "make the others vans"
    if is(Some(first), &["turn", "change", "convert", "transform", "make"])
        && let Some((back, n)) = pointing(&inner[1..]).filter(|p| p.0 == Back::Others)
    {
        let end = 1 + n;
        let into = usize::from(is(inner.get(end), &["into", "to"]));
        if into == 1 || text(first) == "make" {
            let s = Subject {
                kind: Kind::Back(back),
                np: inner[1..end].to_vec(),
                noun: Vec::new(),
                pred: end,
                plural: true,
            };
            let part = predicate::Part {
                main: led("become", first, &[&inner[end + into..]]),
                helped: true,
                ..predicate::Part::default()
            };
            return acts::acts(&s, &[part], true, inner, talk);
        }
    }
    // "make the car behind us a lorry"
    if text(first) == "make"
        && is(inner.get(1), &["the", "my", "that", "this"])
        && let Some(n) = first_noun(&inner[1..]).filter(|n| n.0 < 5)
        && let Some(k) = (n.1 + 2..inner.len())
            .rev()
            .find(|k| is(inner.get(*k), &["a", "an"]))
        && first_noun(&inner[k..]).is_some_and(|x| x.0 < 4 && k + x.1 == inner.len())
        && is_place(&inner[n.1 + 1..])
        && is(
            inner.get(k - 1),
            &[
                "us", "me", "ego", "lane", "left", "right", "side", "sidewalk", "pavement", "roadside",
                "kerb", "curb", "ahead", "road", "street", "crossing", "front",
            ],
        )
        && talk.fits(&inner[1..k]) > 0
    {
        let s = Subject {
            kind: Kind::Known,
            np: inner[1..k].to_vec(),
            noun: inner[1 + n.0..1 + n.1].to_vec(),
            pred: k,
            plural: false,
        };
        let part = predicate::Part {
            main: led("become", first, &[&inner[k..]]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    if makes_of
        && is(inner.get(1), &["it", "that", "him", "her"])
        && is(inner.get(2 + into), &["a", "an"])
        && one.is_some()
        && talk.last.is_some()
    {
        let s = Subject {
            kind: Kind::Back(Back::Same),
            np: inner[1..2].to_vec(),
            noun: Vec::new(),
            pred: 2,
            plural: false,
        };
        let part = predicate::Part {
            main: led("become", first, &[&inner[2 + into..]]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    None
}

/// "get rid of the other": of the others of a group.
fn rid_of_others(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let n = leads(
        inner,
        &[
            "get rid of",
            "remove",
            "delete",
            "erase",
            "drop",
            "lose",
            "take away",
            "take out",
            "do away with",
            "scrap",
            "bin",
            "discard",
            "clear away",
            "dispose of",
            "throw out",
        ],
    )?;
    let (back, m) = pointing(&inner[n..])?;
    if back != Back::Others
        || trimmed(&inner[n + m..])
            .iter()
            .any(|t| !matches!(text(t), "away" | "too" | "please" | "as" | "well" | "off" | "out"))
    {
        return None;
    }
    let s = Subject {
        kind: Kind::Back(back),
        np: inner[n..n + m].to_vec(),
        noun: Vec::new(),
        pred: n + m,
        plural: false,
    };
    let part = predicate::Part {
        main: led("gone", &inner[0], &[]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

pub(super) fn predicate_places(rest: &[Token]) -> bool {
    (1..rest.len()).any(|i| is_place(&rest[i..])) || has_noun(rest)
}
