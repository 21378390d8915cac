//! Who sits in or on something: "the lorry driver has climbed out and stands beside his lorry", "the cyclist should be riding a moped".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::words::{find, first_noun, is, is_place, leads, led, text};
use crate::scene::Class;

/// A sentence in plain words.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    mounts(climbs_out(drives_in(rides_own(mounted(put_on(tokens))))))
}

/// The two-wheeler that this word names.
fn two_wheels(t: &Token) -> bool {
    matches!(look_up(text(t)), Some(Sense::Noun(n, _)) if n.classes.len() == 1 && matches!(n.classes[0], Class::Bicycle | Class::Motorcycle))
}

/// "put one of the pedestrians on a bicycle": he becomes one.
fn put_on(tokens: Vec<Token>) -> Vec<Token> {
    let person =
        |t: &Token| matches!(look_up(text(t)), Some(Sense::Noun(n, _)) if n.classes[0] == Class::Pedestrian);
    let found = is(tokens.first(), &["put", "set", "seat", "get", "place", "sit"])
        .then(|| first_noun(&tokens[1..]))
        .flatten()
        .filter(|n| n.0 < 5 && person(&tokens[n.1]));
    let known = tokens[..tokens.len().min(6)]
        .iter()
        .any(|t| is(Some(t), &["the", "both", "that", "my", "our", "those"]));
    let Some((_, b)) = found.filter(|_| known) else {
        return tokens;
    };
    let on = leads(&tokens[1 + b..], &["on a", "on an", "onto a", "onto an"]).map(|n| 1 + b + n);
    let Some((from, end)) = on.and_then(|k| Some((k, k + first_noun(&tokens[k..]).filter(|x| x.0 < 3)?.1)))
    else {
        return tokens;
    };
    if !two_wheels(&tokens[end - 1]) {
        return tokens;
    }
    [
        &led("replace", &tokens[0], &[&tokens[1..=b]])[..],
        &led("with a", &tokens[0], &[&tokens[from..]]),
    ]
    .concat()
}

/// "a courier on a motorbike": the motorbike, which he rides.
fn mounted(tokens: Vec<Token>) -> Vec<Token> {
    let person = |t: &Token| matches!(look_up(text(t)), Some(Sense::Noun(n, false)) if n.classes[0] == Class::Pedestrian);
    rewritten(&tokens, |i, out| {
        let n = leads(
            &tokens[i..],
            &[
                "on a",
                "on an",
                "on his",
                "on her",
                "riding a",
                "riding his",
                "riding her",
            ],
        )?;
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 3)?;
        // ("put the man on a bicycle" makes him ride)
        let fresh =
            (1..4).any(|k| k < out.len() && is(out.get(out.len() - 1 - k), &["a", "an", "another", "one"]));
        let rides = fresh && out.last().is_some_and(person) && two_wheels(&tokens[i + n + b - 1]);
        let of_his = is(tokens.get(i + n + b), &["s"]);
        (rides && !of_his).then_some(())?;
        out.pop();
        out.extend_from_slice(&tokens[i + n..i + n + b]);
        Some(i + n + b)
    })
}

/// True for somebody who is not in the scene yet, named up to here.
fn somebody(who: &[Token]) -> bool {
    match who {
        [one] => is(Some(one), &["somebody", "someone"]),
        [first, ..] => is(Some(first), &["my", "our", "a", "an", "another", "some"])
            && first_noun(who).is_some_and(|x| {
                let whose = leads(&who[x.1..], &["of mine", "of ours", "of his", "of hers"]).unwrap_or(0);
                x.0 < 4 && x.1 + whose == who.len()
            })
            && who[1..].iter().all(
                |t| !matches!(look_up(text(t)), Some(Sense::Noun(n, _)) if n.classes[0] != Class::Pedestrian),
            ),
        [] => false,
    }
}

/// "my little brother rides his bike in our lane": a cyclist does.
fn rides_own(tokens: Vec<Token>) -> Vec<Token> {
    const RIDES: &[&str] = &[
        "rides",
        "is riding",
        "rode",
        "was riding",
        "comes on",
        "is on",
        "cycles on",
        "pedals",
        "drives",
    ];
    let found = (1..tokens.len().min(6)).find_map(|i| {
        let n = leads(&tokens[i..], RIDES).filter(|_| somebody(&tokens[..i]))?;
        let own = is(tokens.get(i + n), &["his", "her", "their", "a", "an", "my"]);
        let what = tokens.get(i + n + 1..)?;
        let (_, b) = first_noun(what).filter(|x| own && x.0 < 3 && two_wheels(&what[x.1 - 1]))?;
        Some((i + n + 1, i + n + 1 + b))
    });
    match found {
        Some((a, b)) => {
            let rides = led("rides", &tokens[0], &[&tokens[b..]]);
            led("a", &tokens[0], &[&tokens[a..b], &rides])
        }
        None => tokens,
    }
}

/// "somebody drives after us in a car": a car does.
fn drives_in(tokens: Vec<Token>) -> Vec<Token> {
    const DRIVES: &[&str] = &[
        "drives",
        "is driving",
        "drove",
        "comes",
        "is coming",
        "came",
        "follows",
        "is following",
        "waits",
        "is waiting",
        "rides",
        "is riding",
        "sits",
        "is sitting",
        "stands",
        "is standing",
        "approaches",
        "is approaching",
    ];
    let found = (1..tokens.len().min(6)).find_map(|i| {
        let n = leads(&tokens[i..], DRIVES).filter(|_| somebody(&tokens[..i]))?;
        let at = (i + n..tokens.len().min(i + n + 7)).find_map(|k| {
            is(tokens.get(k), &["in", "on", "with"]).then_some(())?;
            let what = tokens.get(k + 2..)?;
            let own = is(tokens.get(k + 1), &["a", "an", "his", "her", "their"]);
            let (_, b) = first_noun(what).filter(|x| own && x.0 < 3)?;
            let drives = matches!(look_up(text(&what[b - 1])), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle())
                || two_wheels(&what[b - 1]);
            drives.then_some((k, k + 2, k + 2 + b))
        })?;
        // (no other clause in between)
        (i..at.0)
            .all(|k| tokens[k].kind == super::super::tokens::TokenKind::Word && !is(tokens.get(k), &["and"]))
            .then_some((i, at))
    });
    match found {
        Some((i, (k, a, b))) => {
            let does = [&tokens[i..k], &tokens[b..]].concat();
            led("a", &tokens[0], &[&tokens[a..b], &does])
        }
        None => tokens,
    }
}

const OUT: &[&str] = &[
    "climbed out",
    "climbed down",
    "climbed off",
    "climbs out",
    "climbs down",
    "climbs off",
    "got out",
    "gotten out",
    "gets out",
    "got off",
    "gets off",
    "stepped out",
    "steps out",
    "stepped off",
    "jumped out",
    "jumps out",
    "hopped out",
    "hopped off",
    "got down",
    "dismounted",
    "dismounts",
    "come out",
    "alighted",
    "alights",
    "left his vehicle",
    "left his cab",
    "left her vehicle",
    "left his lorry",
    "left his truck",
    "left the cab",
    "left the vehicle",
];

/// "the lorry driver has climbed out and stands beside his lorry": a man beside the lorry.
fn climbs_out(tokens: Vec<Token>) -> Vec<Token> {
    const DRIVER: &[&str] = &[
        "driver", "drivers", "rider", "trucker", "s driver", "s rider", "' driver",
    ];
    if let Some(out) = out_of_it(&tokens) {
        return out;
    }
    if !is(tokens.first(), &["the", "my", "that"]) {
        return tokens;
    }
    // "the lorry driver", "the lorry's driver", "the driver of the lorry"
    let of = leads(&tokens[1..], &["driver of the", "rider of the"]);
    let found = match of {
        Some(n) => first_noun(&tokens[1 + n..])
            .filter(|x| x.0 < 3)
            .map(|x| (1 + n..1 + n + x.1, 1 + n + x.1)),
        None => (1..tokens.len().min(5)).find_map(|i| {
            let n = leads(&tokens[i..], DRIVER).filter(|_| i > 1)?;
            Some((1..i, i + n))
        }),
    };
    let Some((whose, verb)) = found else {
        return tokens;
    };
    let vehicle: Vec<Token> = tokens[whose]
        .iter()
        .map(|t| Token {
            text: text(t).trim_end_matches("'s").to_string(),
            ..t.clone()
        })
        .collect();
    if first_noun(&vehicle).is_none() {
        return tokens;
    }
    let has = leads(
        &tokens[verb..],
        &["has just", "has now", "has already", "had", "has", "just"],
    )
    .unwrap_or(0);
    let Some(n) = leads(&tokens[verb + has..], OUT) else {
        return tokens;
    };
    let rest = &tokens[verb + has + n..];
    let place =
        (0..rest.len()).find(|i| is_place(&rest[*i..]) && !is(rest.get(*i), &["out", "off", "down", "of"]));
    let mut out = led("add a man", &tokens[0], &[]);
    match place {
        Some(i) => {
            let own = (i..rest.len()).find(|k| is(rest.get(*k), &["his", "her", "its", "it"]));
            match own {
                Some(k) => {
                    out.extend_from_slice(&rest[i..k]);
                    out.extend(led("the", &rest[k], &[&vehicle]));
                    let end = first_noun(&rest[k..])
                        .filter(|x| x.0 < 3)
                        .map_or(k + 1, |x| k + x.1);
                    let end = if is(rest.get(k + 1), &["cab", "vehicle", "machine"]) {
                        k + 2
                    } else {
                        end
                    };
                    out.extend_from_slice(&rest[end.min(rest.len())..]);
                }
                None => out.extend_from_slice(&rest[i..]),
            }
        }
        None => out.extend(led("next to the", &tokens[0], &[&vehicle])),
    }
    out
}

/// "the driver has got out of the lorry and stands behind it": the lorry is named with what he did.
fn out_of_it(tokens: &[Token]) -> Option<Vec<Token>> {
    const WHO: &[&str] = &[
        "the driver",
        "its driver",
        "a driver",
        "the rider",
        "its rider",
        "someone",
        "somebody",
        "a passenger",
        "one passenger",
        "the passenger",
        "its owner",
        "the owner",
        "a man",
        "a woman",
        "the trucker",
    ];
    const HAS: &[&str] = &[
        "has just",
        "has now",
        "has already",
        "had",
        "has",
        "just",
        "is",
        "is just",
        "should have",
        "must have",
    ];
    const OF: &[&str] = &[
        "of the", "of that", "from the", "the", "of his", "of her", "from his",
    ];
    const OUT_OF: &[&str] = &[
        "getting out",
        "climbing out",
        "stepping out",
        "jumping out",
        "exited",
        "exits",
        "has left",
    ];
    let who = leads(tokens, WHO)?;
    let has = leads(&tokens[who..], HAS).unwrap_or(0);
    let verb = who + has;
    // ("has left the lorry in our lane" tells where the lorry is)
    let left = leads(&tokens[verb..], &["left"]);
    let n = leads(&tokens[verb..], OUT)
        .or_else(|| leads(&tokens[verb..], OUT_OF))
        .or(left)?;
    let of = leads(&tokens[verb + n..], OF)?;
    let np = &tokens[verb + n + of..];
    let (a, b) = first_noun(np).filter(|x| x.0 < 3)?;
    matches!(look_up(text(&np[b - 1])), Some(Sense::Noun(noun, false)) if noun.classes[0].is_vehicle())
        .then_some(())?;
    let rest = &np[b..];
    let goes_on = is(rest.first(), &["and"]) || rest.first().is_some_and(|t| t.kind == TokenKind::Comma);
    if !(goes_on || rest.is_empty() && left.is_none()) || a > 2 {
        return None;
    }
    let vehicle = led("the", &tokens[0], &[&np[..b]]);
    let place = (0..rest.len()).find(|i| is_place(&rest[*i..]));
    let Some(i) = place else {
        return rest
            .iter()
            .all(|t| !is(Some(t), &["and"]))
            .then(|| led("add a man next to", &tokens[0], &[&vehicle]));
    };
    let mut out = led("add a man", &tokens[0], &[]);
    for t in &rest[i..] {
        if is(Some(t), &["it"]) {
            out.extend_from_slice(&vehicle);
        } else {
            out.push(t.clone());
        }
    }
    Some(out)
}

/// "the cyclist should be riding a moped, not a bicycle": it becomes one.
fn mounts(tokens: Vec<Token>) -> Vec<Token> {
    const RIDES: &[&str] = &[
        "should be riding",
        "ought to be riding",
        "must be riding",
        "should ride",
        "ought to ride",
        "must ride",
        "should be on",
        "ought to be on",
        "must be on",
        "should sit on",
        "is to ride",
        "shall ride",
        "should rather ride",
        "is actually riding",
        "is riding",
        "is actually on",
        "has to ride",
    ];
    let rider = |t: &Token| two_wheels(t) || is(Some(t), &["rider"]);
    let Some((i, n)) = find(&tokens, RIDES) else {
        return tokens;
    };
    let what = &tokens[i + n..];
    let fresh = is(what.first(), &["a", "an"])
        && first_noun(what).is_some_and(|x| x.0 < 3 && two_wheels(&what[x.1 - 1]));
    if !fresh || !is(tokens.first(), &["the", "both", "that"]) || !tokens[..i].iter().any(rider) {
        return tokens;
    }
    let end = first_noun(what).map_or(what.len(), |x| x.1);
    let mut out = led("replace", &tokens[0], &[&tokens[..i]]);
    // ("the rider in front of me" is whoever rides there)
    let denied = what[end..].iter().find(|t| two_wheels(t));
    if let Some(t) = out.iter_mut().find(|t| t.text == "rider") {
        t.text = denied.map_or("cyclist", |d| text(d)).to_string();
    }
    out.extend(led("with", &tokens[0], &[&what[..end]]));
    out
}
