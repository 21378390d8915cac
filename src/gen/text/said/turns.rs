//! Turns of speech of single edits: "drop him back to 25 m", "leave the bus out", "where a child has joined them", "I meant a
//! coach, not a truck", "everything that has an engine", "on each of the two sidewalks".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::gapped::{make_each, same_verb};
use super::lists::HELPERS;
use super::shorthand::{became_with, ordinals_in_row, out_and_in, there_instead, verb_last};
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use crate::scene::graph::LaneRole as L;

const ENGINE: &str = "everything that has an engine|anything that has an engine|everything with an engine|anything with an engine|all things with an engine|everything that has a motor|anything that has a motor|everything with a motor|anything with a motor|whatever has an engine|whatever has a motor|everything motorised|everything motorized|everything that is motorised|everything that runs on an engine|everything powered by an engine";
const TWO_WHEELS: &str = "everything on two wheels|everything with two wheels|anything on two wheels|anything with two wheels|all two wheelers|everyone on two wheels|everybody on two wheels|everything that has two wheels|whatever has two wheels";
const RIDERS: &str = "everybody who rides a bike|everyone who rides a bike|everybody who rides a bicycle|everyone who rides a bicycle|everyone on a bike|everybody on a bike|everyone on a bicycle|everybody on a bicycle|everyone riding a bike|everybody riding a bike|anyone on a bike|anybody on a bike|everyone who cycles|everybody who cycles|all who cycle|all who ride a bike|everybody cycling|everyone cycling|anyone who cycles|whoever rides a bike|whoever is on a bike";
const WHEELS: &str = "everything on wheels|everything with wheels|anything on wheels|anything with wheels|everything that has wheels|anything that has wheels|everything on four wheels|everything with four wheels";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&tokens, ENGINE, "all motor vehicles");
    let out = replaced(&out, TWO_WHEELS, "all bicycles and all motorcycles");
    let out = replaced(&out, RIDERS, "all bicycles");
    let out = replaced(&out, WHEELS, "all vehicles and all bicycles");
    let out = replaced(
        &out,
        "for the night|for tonight|for the day|for today|for the time being|for good|this time|this time round|this time around",
        "",
    );
    let out = there_instead(verb_last(out, talk));
    let out = ordinals_in_row(out);
    let out = became_with(out);
    let out = out_and_in(out, talk);
    let out = on_each(out);
    let out = next_lane(out, talk);
    let out = meant(out, talk);
    let out = no_longer_but(out, talk);
    let out = appears(out);
    let out = where_another(out);
    let out = dropped(out);
    let out = make_each(taken_out(out));
    same_verb(out)
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || tokens[i - 1].kind != TokenKind::Word
        || is(tokens.get(i - 1), &["and", "then", "but", "so", "please", "now"])
}

/// "a pedestrian on each of the two sidewalks": one on the left one and one on the right one.
fn on_each(tokens: Vec<Token>) -> Vec<Token> {
    const STRIPS: &[&str] = &[
        "sidewalks",
        "pavements",
        "sidewalk",
        "pavement",
        "footpaths",
        "footpath",
        "roadsides",
        "roadside",
        "kerbs",
        "kerb",
        "curbs",
        "curb",
        "shoulders",
        "shoulder",
        "sides of the road",
        "sides of the street",
        "side of the road",
        "side of the street",
        "verges",
        "verge",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "on each of the two",
                "on each of the",
                "on each of both",
                "on each",
                "on either",
                "on every",
                "at each",
                "on both of the",
                "at either",
                "along each",
                "along either",
            ],
        )?;
        let m = leads(&tokens[i + n..], STRIPS)?;
        Some((i, n, m))
    });
    let Some((i, n, m)) = found else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[..i]) else {
        return tokens;
    };
    let lead = (0..a).rev().take_while(|k| {
        number(&tokens[*k]).is_some()
            || is(tokens.get(*k), &["a", "an", "another", "more", "parked", "new"])
            || matches!(
                look_up(text(&tokens[*k])),
                Some(Sense::State(_, false) | Sense::Size(_) | Sense::Color(_))
            )
    });
    let Some(from) = lead.last() else {
        return tokens;
    };
    let strip = tokens[i + n].text.trim_end_matches('s').to_string();
    let strip = match strip.as_str() {
        "side" => "roadside",
        other => other,
    };
    let close = trimmed(&tokens[b..i]);
    // "four cones, two on each side": two of them and two of them
    let share = match close {
        [n] => number(n),
        // ("one car on each side", which of them was put in before)
        [n, noun] if super::words::noun_at(std::slice::from_ref(noun)).is_some() => number(n),
        _ => None,
    };
    let share = share.filter(|_| number(&tokens[from]).is_some());
    let close = if share.is_some() { &close[..1] } else { close };
    let np = match share {
        Some(1) => [
            close,
            &tokens[from + 1..a],
            &super::topics::singular_of(&tokens[a..b]),
        ]
        .concat(),
        Some(_) => [close, &tokens[from + 1..b]].concat(),
        None => [&tokens[from..b], close].concat(),
    };
    let mut out = tokens[..from].to_vec();
    out.extend(led_after(&np, &format!("on the left {strip} and"), &tokens[i]));
    out.extend(led_after(&np, &format!("on the right {strip}"), &tokens[i]));
    out.extend_from_slice(&tokens[i + n + m..]);
    out
}

fn led_after(np: &[Token], words: &str, at: &Token) -> Vec<Token> {
    let mut out = np.to_vec();
    out.extend(led(words, at, &[]));
    out
}

/// "the lane next to mine": the left one, if there is one that goes our way, else the right one, else the oncoming one.
fn next_lane(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const NEXT: &[&str] = &[
        "the lane next to mine",
        "the lane next to ours",
        "the lane beside mine",
        "the lane beside ours",
        "the lane adjacent to mine",
        "the lane adjacent to ours",
        "the neighbouring lane",
        "the neighboring lane",
        "the adjacent lane",
        "the lane alongside mine",
        "the lane alongside ours",
        "the lane next door",
        "the lane next to my own",
        "the lane next to me",
        "the lane next to us",
        "the lane beside me",
        "the lane beside us",
    ];
    let Some((i, n)) = find(&tokens, NEXT) else {
        return tokens;
    };
    let lies = |role: L, side: f64| {
        (0..8).any(|k| {
            let p = glam::DVec2::new(f64::from(k) * 2.5, side * 3.5);
            super::super::holds::in_role(talk.map, role, p)
        })
    };
    let lane = if lies(L::Left, 1.0) {
        "the left lane"
    } else if lies(L::Right, -1.0) {
        "the right lane"
    } else {
        "the oncoming lane"
    };
    let lane = led(lane, &tokens[i], &[]);
    [&tokens[..i], &lane, &tokens[i + n..]].concat()
}

/// "I meant a coach, not a truck, coming towards us": the truck there becomes one.
fn meant(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "i meant",
            "i mean",
            "we meant",
            "i said",
            "it should be",
            "it should have been",
            "it was supposed to be",
            "it has to be",
            "it must be",
            "that should be",
            "that should have been",
            "i wanted",
            "i asked for",
            "make it",
            "make that",
            "it is",
            "its",
            "that is",
        ],
    ) else {
        return tokens;
    };
    let fresh = is(tokens.get(n), &["a", "an"]);
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let mut k = n + b;
    let comma = tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma);
    k += usize::from(comma);
    k += usize::from(is(tokens.get(k), &["and"]));
    let not = leads(&tokens[k..], &["not", "instead of", "rather than", "in place of"]);
    let Some(m) = not.filter(|_| fresh && is(tokens.get(k + not.unwrap_or(0)), &["a", "an", "the"])) else {
        return tokens;
    };
    let old = &tokens[k + m + 1..];
    let Some((c, d)) = first_noun(old).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let rest: Vec<Token> = old[d..]
        .iter()
        .filter(|t| t.kind != TokenKind::Comma)
        .cloned()
        .collect();
    if talk.fits(&old[c..d]) == 0 || has_noun(&rest) {
        return tokens;
    }
    let with = led("with", &tokens[n], &[&tokens[n..n + b]]);
    led("replace the", &tokens[0], &[&old[..d], &rest, &with])
}

/// "behind us I don't want a car any more but a motorcycle": that car becomes one.
fn no_longer_but(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "i dont want a",
            "i do not want a",
            "we dont want a",
            "we do not want a",
            "i dont want the",
            "i do not want the",
            "i no longer want a",
            "i no longer want the",
            "we no longer want a",
            "i dont need a",
            "we dont need a",
            "there should no longer be a",
            "there should not be a",
            "there shouldnt be a",
            "there must not be a",
            "not a",
            "no",
            "i dont want to see a",
            "there should be no longer a",
            "there should be not a",
            "no longer a",
            "no more",
        ],
    ) else {
        return tokens;
    };
    let old = &tokens[i + n..];
    let Some((a, b)) = first_noun(old).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let late = leads(&old[b..], &["any more", "anymore", "any longer", "there", "here"]).unwrap_or(0);
    let Some(but) = (b + late..old.len().min(b + late + 5)).find(|k| is(old.get(*k), &["but"])) else {
        return tokens;
    };
    let between = trimmed(&old[b + late..but]);
    let helped = between.iter().position(|t| {
        !HELPERS.contains(&text(t)) && !is(Some(t), &["wait", "stand", "drive", "park", "ride"])
    });
    let between = if is(tokens.get(i), &["no"]) {
        trimmed(&between[helped.unwrap_or(between.len())..])
    } else {
        between
    };
    if is(tokens.get(i), &["no"])
        && !(between.is_empty() || is(between.first(), &["there", "here"]) || is_place(between))
    {
        return tokens;
    }
    let fresh = is(old.get(but + 1), &["a", "an"]) || old.get(but + 1).is_some_and(|t| number(t).is_some());
    let Some((_, e)) = first_noun(&old[but + 1..]).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let end = but + 1 + e;
    let more = trimmed(&old[end..]);
    // "not a motorcycle but a van should be following us"
    let helped = more
        .iter()
        .take_while(|t| HELPERS.contains(&text(t)) || is(Some(t), &["to", "now"]))
        .count();
    let more = &more[helped..];
    let lead = trimmed(&tokens[..i]);
    let place = if is_place(lead) && first_noun(lead).is_none() {
        lead
    } else if lead.is_empty()
        || leads(
            lead,
            &[
                "there should be",
                "there must be",
                "it should be",
                "make it",
                "i want",
            ],
        ) == Some(lead.len())
    {
        if is_place(between) { between } else { more }
    } else {
        return tokens;
    };
    if !(place.is_empty() || is_place(place) && first_noun(place).is_none()) {
        return tokens;
    }
    let np = [&old[..b], place].concat();
    if talk.fits(&[&old[a..b], place].concat()) == 0 {
        return tokens;
    }
    let with = led("with", &tokens[i], &[&old[but + 1..end]]);
    led("replace the", &tokens[0], &[&np, &with])
}

/// "three pedestrians appear on the right": they should be there.
fn appears(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = tokens;
    for i in 1..out.len() {
        let comes = is(
            out.get(i),
            &[
                "appear",
                "appears",
                "emerge",
                "emerges",
                "materialise",
                "materialises",
                "arrive",
                "arrives",
            ],
        );
        if !comes || !(is_place(&out[i + 1..]) || out.get(i + 1).is_none_or(|t| t.kind != TokenKind::Word)) {
            continue;
        }
        let from = out[..i]
            .iter()
            .rposition(|t| {
                t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_))
                    || is(Some(t), &["and", "but", "then"])
            })
            .map_or(0, |k| k + 1);
        let clause = &out[from..i];
        let fresh = is(clause.first(), &["a", "an", "another", "some"])
            || clause.first().is_some_and(|t| number(t).is_some());
        if !fresh
            || first_noun(clause).is_none_or(|x| x.0 > 4)
            || clause.iter().any(|t| HELPERS.contains(&text(t)))
        {
            continue;
        }
        let be = if is_place(&out[i + 1..]) {
            "should be"
        } else {
            "should be there"
        };
        let be = led(be, &out[i], &[]);
        out.splice(i..=i, be);
        return appears(out);
    }
    out
}

/// "... to the right sidewalk, where a child has joined them": and a child there.
fn where_another(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|i| {
        is(tokens.get(*i), &["where"])
            && tokens[i - 1].kind == TokenKind::Comma
            && (is(tokens.get(i + 1), &["a", "an", "another", "some"])
                || tokens.get(i + 1).is_some_and(|t| number(t).is_some()))
    });
    let Some(i) = found else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    // the place that was named last
    let place = (0..i - 1).rev().find(|k| {
        is(
            tokens.get(*k),
            &["to", "on", "in", "onto", "into", "at", "behind", "near", "beside"],
        ) && is_place(&tokens[*k..])
    });
    let Some(place) = place else {
        return tokens;
    };
    let close = (i + 1 + b..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word)
        .unwrap_or(tokens.len());
    let at = match text(&tokens[place]) {
        "to" | "onto" => "on",
        "into" => "in",
        other => other,
    }
    .to_string();
    let there = led(&at, &tokens[i], &[&tokens[place + 1..i - 1]]);
    let add = led("and add", &tokens[i], &[&tokens[i + 1..i + 1 + b], &there]);
    [&tokens[..i - 1], &add, &tokens[close..]].concat()
}

/// "drop him back to 25 m behind us": moved, not taken out.
fn dropped(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = tokens;
    for i in 0..out.len() {
        if !is(out.get(i), &["drop"]) || !opens(&out, i) {
            continue;
        }
        let pronoun = is(out.get(i + 1), &["it", "him", "her", "them"]);
        let end = if pronoun {
            i + 2
        } else {
            match first_noun(&out[i + 1..])
                .filter(|x| x.0 < 4 && is(out.get(i + 1), &["the", "both", "that", "my"]))
            {
                Some((_, b)) => i + 1 + b,
                None => continue,
            }
        };
        let rest = &out[end..];
        let back = leads(
            rest,
            &[
                "back to",
                "back by",
                "back behind",
                "back into",
                "to",
                "into",
                "onto",
                "back",
            ],
        )
        .is_some();
        if back || pronoun && is_place(rest) && !is(rest.first(), &["out", "off", "away"]) {
            out[i].text = "move".into();
        }
    }
    out
}

/// "leave the bus out", "cross the two cones out", "stand the others down": taken away.
fn taken_out(tokens: Vec<Token>) -> Vec<Token> {
    for i in 0..tokens.len() {
        let verb = is(
            tokens.get(i),
            &[
                "leave", "cut", "cross", "rub", "rule", "strike", "edit", "crop", "weed", "filter", "pick",
                "throw", "kick", "chuck", "toss", "boot", "sort", "stand",
            ],
        );
        if !verb || !opens(&tokens, i) {
            continue;
        }
        let end = if is(tokens.get(i + 1), &["it", "him", "her", "them"]) {
            i + 2
        } else if let Some(n) = leads(
            &tokens[i + 1..],
            &["the others", "the rest", "the other two", "the other one"],
        ) {
            i + 1 + n
        } else {
            match first_noun(&tokens[i + 1..]).filter(|x| x.0 < 5) {
                Some((_, b)) => i + 1 + b,
                None => continue,
            }
        };
        // ("stand the others down")
        let down = is(tokens.get(i), &["stand"]);
        let out = is(tokens.get(end), if down { &["down"] } else { &["out"] })
            && tokens.get(end + 1).is_none_or(|t| {
                t.kind != TokenKind::Word
                    || is(
                        Some(t),
                        &["and", "please", "too", "entirely", "completely", "altogether"],
                    )
            });
        if out {
            let remove = led("remove", &tokens[i], &[&tokens[i + 1..end]]);
            return [&tokens[..i], &remove, &tokens[end + 1..]].concat();
        }
    }
    tokens
}
