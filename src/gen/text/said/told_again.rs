//! What points to a place that the same sentence names, and what it says twice: "on the right sidewalk, next to the car parked
//! there", "some children: four kids on the sidewalk", "a coach is coming the other way", "have crossed and left the picture".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::lists::{List, OTHER_WAY};
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, longest, number, text, trimmed};
use crate::scene::Class;
use std::sync::LazyLock;

/// "The right lane is empty; put a car there": a car in the right lane.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    const EMPTY: &[&str] = &[
        "empty",
        "free",
        "deserted",
        "unused",
        "unoccupied",
        "bare",
        "vacant",
        "clear",
    ];
    let mut from = 0;
    for i in 0..tokens.len() {
        if tokens[i].kind != TokenKind::Stop && tokens[i].kind != TokenKind::Comma {
            continue;
        }
        let here = &tokens[from..i];
        let place = is(here.first(), &["the", "our"])
            .then(|| here.get(1..).and_then(longest))
            .flatten()
            .filter(|x| {
                matches!(x.0, super::Sense::Place(..)) && is(here.get(1 + x.1), &["is", "looks", "seems"])
            });
        if place.is_none() || !is(here.last(), EMPTY) {
            if tokens[i].kind == TokenKind::Stop {
                from = i + 1;
            }
            continue;
        }
        let end = (i + 1..tokens.len())
            .find(|k| tokens[*k].kind == TokenKind::Stop)
            .unwrap_or(tokens.len());
        let rest = &tokens[i + 1..end];
        let so = usize::from(is(rest.first(), &["so", "and", "please"]));
        if let Some((_, n)) = place
            && is(here.last(), EMPTY)
            && is(
                rest.get(so),
                &["put", "add", "place", "set", "let", "have", "park"],
            )
            && let Some(there) = rest.iter().position(|t| is(Some(t), &["there"]))
            && rest
                .get(there + 1)
                .is_none_or(|t| is(Some(t), &["please", "too"]))
            && has_noun(&rest[..there])
        {
            let lane = is(here.get(n), &["lane", "junction", "intersection", "park", "lot"]);
            let at = led(if lane { "in" } else { "on" }, &rest[there], &[&here[..=n]]);
            let new = [&rest[so..there], &at, &rest[there + 1..]].concat();
            tokens.splice(from..end, new);
            return tokens;
        }
        if tokens[i].kind == TokenKind::Stop {
            from = i + 1;
        }
    }
    tokens
}

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = in_detail(wanted_there(tokens));
    let out = there_again(out, talk);
    crossed_and_left(other_way(out), talk)
}

/// "on the left roadside I also want a bulldozer": add a bulldozer there.
fn wanted_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (2..tokens.len().min(10)).find(|i| is(tokens.get(*i), &["i", "we", "id", "wed"])) else {
        return tokens;
    };
    let place = trimmed(&tokens[..i]);
    if !is(
        place.first(),
        &[
            "on", "in", "at", "along", "behind", "beside", "next", "ahead", "between", "to",
        ],
    ) || !is_place(place)
    {
        return tokens;
    }
    let mut k = i + 1;
    let mut wants = false;
    while is(
        tokens.get(k),
        &[
            "also",
            "additionally",
            "now",
            "still",
            "would",
            "want",
            "need",
            "like",
            "love",
            "to",
            "see",
            "have",
            "really",
            "just",
            "prefer",
            "too",
            "require",
            "rather",
            "could",
            "do",
            "with",
            "further",
        ],
    ) {
        wants |= is(
            tokens.get(k),
            &["want", "need", "like", "love", "prefer", "require"],
        );
        k += 1;
    }
    let new = tokens.get(k..).unwrap_or(&[]);
    let fresh = new
        .first()
        .is_some_and(|t| is(Some(t), &["a", "an", "another", "some"]) || number(t).is_some());
    let Some((_, b)) = first_noun(new).filter(|x| wants && fresh && x.0 < 5) else {
        return tokens;
    };
    let late = trimmed(&new[b..]);
    if !(late.is_empty()
        || leads(
            late,
            &["as well", "too", "also", "additionally", "in addition", "there"],
        ) == Some(late.len()))
    {
        return tokens;
    }
    led("add", &tokens[0], &[&new[..b], place])
}

/// The class that a noun names.
fn class_of(noun: &[Token]) -> Option<Class> {
    match longest(noun) {
        Some((super::Sense::Noun(n, _), k)) if k == noun.len() => n.classes.first().copied(),
        _ => None,
    }
}

/// "some children: four kids on the sidewalk": four kids.
fn in_detail(tokens: Vec<Token>) -> Vec<Token> {
    let Some(some) = (0..tokens.len().min(5)).find(|i| is(tokens.get(*i), &["some", "several", "more", "a"]))
    else {
        return tokens;
    };
    let lead = &tokens[..some];
    let Some((a, b)) = first_noun(&tokens[some..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let noun = &tokens[some + a..some + b];
    // ("a school group", "some more workers are needed")
    let mut k = some + b;
    if let Some(n) = leads(
        &tokens[k..],
        &[
            "are needed",
            "are missing",
            "are wanted",
            "are required",
            "group",
            "is needed",
            "too",
            "as well",
        ],
    ) {
        k += n;
    }
    let set_off = tokens
        .get(k)
        .is_some_and(|t| t.kind == TokenKind::Comma || matches!(text(t), ":" | "-"));
    let one = is(tokens.get(some), &["a"]) && !is(tokens.get(k.wrapping_sub(1)), &["group"]);
    let rest = tokens.get(k + 1..).unwrap_or(&[]);
    let counted = rest.first().is_some_and(|t| number(t).is_some());
    let Some((c, d)) = first_noun(rest).filter(|x| set_off && counted && !one && x.0 < 4) else {
        return tokens;
    };
    let same = class_of(noun).is_some() && class_of(noun) == class_of(&rest[c..d]);
    let adds = lead.is_empty()
        || lead.iter().all(|t| {
            is(
                Some(t),
                &[
                    "add", "bring", "in", "put", "have", "lets", "let", "us", "there", "are", "should", "be",
                    "i", "we", "want", "need", "show", "include", "insert", "place", "give", "me", "get",
                    "also",
                ],
            )
        });
    if !(same && adds) {
        return tokens;
    }
    led("add", &tokens[0], &[rest])
}

/// "on the right sidewalk, next to the car parked there": the car on the right; "behind the one that is already there".
fn there_again(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(there) = (4..tokens.len()).find(|i| {
        is(tokens.get(*i), &["there"])
            && is(
                tokens.get(i - 1),
                &[
                    "parked", "standing", "waiting", "already", "is", "stands", "parks", "are", "stopped",
                ],
            )
    }) else {
        return tokens;
    };
    // whom it tells apart
    let mut k = there;
    while is(
        tokens.get(k - 1),
        &[
            "parked", "standing", "waiting", "already", "is", "stands", "parks", "are", "that", "which",
            "who", "stopped", "thats",
        ],
    ) && k > 2
    {
        k -= 1;
    }
    let Some(the) = (0..k).rev().find(|i| is(tokens.get(*i), &["the"])) else {
        return tokens;
    };
    let np = &tokens[the + 1..k];
    let one = matches!(np, [t] if is(Some(t), &["one", "other"]));
    let own = first_noun(np).filter(|x| x.1 == np.len() && x.0 < 3);
    // a sentence that begins with whom it is about points to no place in it
    if !(one || own.is_some()) || the < 3 {
        return tokens;
    }
    let noun = if one {
        match first_noun(&tokens[..the]) {
            Some((a, b)) => super::topics::singular_of(&tokens[a..b]),
            None => return tokens,
        }
    } else {
        np.to_vec()
    };
    // the place that was said before
    let Some((side, on)) = (1..the).rev().find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "on the",
                "on our",
                "on my",
                "at the",
                "in the",
                "along the",
                "to the",
            ],
        )?;
        let side = is(tokens.get(i + n), &["left", "right"]).then(|| text(&tokens[i + n]).to_string());
        let on = matches!(longest(&tokens[i + n..]), Some((super::Sense::Place(..), _)));
        (side.is_some() || on).then(|| (side, tokens[i..the].to_vec()))
    }) else {
        return tokens;
    };
    let at = &tokens[there];
    let mut place: Vec<Token> = match side {
        // (whatever stands there stands on that side of the road)
        Some(side) => led("on the", at, &[&led(&side, at, &[])]),
        None => {
            let n = leads(&on, &["on the", "at the", "in the", "on our", "in our"]).unwrap_or(2);
            let len = on.get(n..).and_then(longest).map_or(0, |x| x.1);
            on[..(n + len).min(on.len())].to_vec()
        }
    };
    place.extend(led("side", at, &[]));
    if !is(place.get(2), &["left", "right"]) {
        place.pop();
    }
    let parked = tokens[k..there].iter().any(|t| is(Some(t), &["parked", "parks"]));
    let whole = [&led("the", at, &[])[..], &noun, &place].concat();
    if talk.fits(&whole) != 1 {
        return tokens;
    }
    let noun = if parked && !is(noun.first(), &["parked"]) {
        led("parked", at, &[&noun])
    } else {
        noun
    };
    [&tokens[..=the], &noun, &place, &tokens[there + 1..]].concat()
}

/// "a coach is coming the other way": towards us.
fn other_way(tokens: Vec<Token>) -> Vec<Token> {
    let fresh = tokens
        .iter()
        .take(5)
        .any(|t| is(Some(t), &["a", "an", "another", "one"]))
        || tokens.iter().take(4).any(|t| number(t).is_some());
    let Some((_, b)) = first_noun(&tokens).filter(|x| fresh && x.0 < 6) else {
        return tokens;
    };
    rewritten(&tokens, |i, out| {
        let goes = i >= b
            && is(
                tokens.get(i.wrapping_sub(1)),
                &[
                    "coming",
                    "comes",
                    "come",
                    "going",
                    "goes",
                    "drives",
                    "driving",
                    "approaching",
                    "approaches",
                    "rides",
                    "riding",
                    "heading",
                    "travelling",
                    "travels",
                ],
            );
        let from = usize::from(is(tokens.get(i), &["from"]));
        let n = leads(&tokens[i + from..], &OTHER_WAY).or_else(|| {
            leads(
                &tokens[i + from..],
                &[
                    "the other direction",
                    "the opposite direction",
                    "the opposite side",
                ],
            )
        })?;
        let closes = tokens
            .get(i + from + n)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["now", "and", "please"]));
        // (after "turned" it is a turn, and "back the way it came" a way)
        (goes && closes && !has_noun(&tokens[i..i + n])).then(|| {
            out.extend(led("towards us", &tokens[i], &[]));
            i + from + n
        })
    })
}

/// "all three have reached the other side and left the picture": they have left.
fn crossed_and_left(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    static LEFT: List = LazyLock::new(|| {
        "\
        left the picture|left the scene|left the frame|left the image|left the view|disappeared|vanished|\
        are gone|is gone|gone|left us|gone away|walked off|walked away|driven off|driven away|ridden off|\
        are out of sight|is out of sight|are out of the picture|left our view|left the area|disappear|\
        disappears|vanish|vanishes|leave the picture|leaves the picture|leave the scene|leaves the scene|\
        have left|has left|have gone|has gone|have disappeared|has disappeared|have left the scene|\
        has left the scene|have left the picture|has left the picture|gone home|gone on"
            .split('|')
            .collect()
    });
    let Some((and, _)) = find(&tokens, &["and", "and then", "and so", "and now"])
        .filter(|(i, n)| leads(&tokens[i + n..], &LEFT).is_some_and(|m| i + n + m == tokens.len()))
    else {
        return tokens;
    };
    let head = &tokens[..and];
    let Some((a, b)) = first_noun(head).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let whole = a > 0 || talk.fits(&head[..b]) > 0;
    let verb = is(
        head.get(b),
        &[
            "have", "has", "reach", "reaches", "finish", "finishes", "cross", "crosses", "walk", "walks",
            "drive", "drives", "turn", "turns", "ride", "rides", "are", "is", "had",
        ],
    );
    let one_subject = !has_noun(&head[b..]) && !head.iter().any(|t| t.kind == TokenKind::Comma);
    if !(whole && verb && one_subject) {
        return tokens;
    }
    [&head[..b], &led("have left the scene", &tokens[and], &[])].concat()
}
