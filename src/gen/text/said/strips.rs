//! Sides and places: "to the other pavement", "everybody off the pavement", "into the lane on its right", "clear the junction of cars".

use super::super::holds::in_role;
use super::super::lexicon::Sense;
use super::super::select::fitting;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text};
use crate::scene::graph::LaneRole as L;

/// "everybody off the pavement", "all cars out of my lane": who is there goes.
pub(super) fn off_with(tokens: Vec<Token>) -> Vec<Token> {
    let all = is(tokens.first(), &["everybody", "everyone", "all", "every"]);
    let Some((i, n)) = find(&tokens, &["off", "out of", "away from"]).filter(|x| all && x.0 > 0 && x.0 < 6)
    else {
        return tokens;
    };
    let place = super::words::longest(
        &tokens[(i + n + usize::from(is(tokens.get(i + n), &["the", "my", "our"]))).min(tokens.len())..],
    );
    let own = super::words::longest(&tokens[(i + n).min(tokens.len())..]);
    let named = [place, own]
        .into_iter()
        .flatten()
        .any(|p| matches!(p.0, Sense::Place(..)));
    let verb = tokens.iter().any(|t| {
        matches!(
            text(t),
            "to" | "onto" | "into" | "is" | "are" | "should" | "must" | "goes" | "move"
        )
    });
    if !named || verb {
        return tokens;
    }
    let who = if is(tokens.first(), &["everybody", "everyone"]) {
        led("pedestrians", &tokens[0], &[&tokens[1..i]])
    } else {
        tokens[1..i].to_vec()
    };
    let lane = tokens[i + n..].iter().any(|t| text(t) == "lane");
    let place = led(if lane { "in" } else { "on" }, &tokens[i], &[&tokens[i + n..]]);
    led("remove all", &tokens[0], &[&who, &place])
}

/// "change the cyclist to the opposite lane": move him there.
pub(super) fn changed_to(mut tokens: Vec<Token>) -> Vec<Token> {
    let known = is(
        tokens.get(1),
        &[
            "the", "both", "all", "that", "every", "my", "it", "him", "her", "them",
        ],
    );
    let changes = known && is(tokens.first(), &["change", "switch", "alter", "adjust"]);
    let end = match is(tokens.get(1), &["it", "him", "her", "them"]) {
        true => Some(2),
        false => first_noun(&tokens).filter(|x| x.0 < 5).map(|x| x.1),
    };
    let Some(to) = end.filter(|b| changes && is(tokens.get(*b), &["to", "into", "onto", "over"])) else {
        return tokens;
    };
    let to = to + usize::from(is(tokens.get(to), &["over"]) && is(tokens.get(to + 1), &["to", "into"]));
    let named = (to + 1..tokens.len().min(to + 4)).find_map(|k| {
        super::words::longest(&tokens[k..]).filter(|s| matches!(s.0, Sense::Place(..) | Sense::Noun(..)))
    });
    if matches!(named, Some((Sense::Place(..), _))) {
        tokens[0].text = "move".into();
    }
    tokens
}

/// "stop the truck on the crossing so that it blocks it", "bring the bus to a halt at the kerb": it stands there.
pub(super) fn stopped_at(tokens: Vec<Token>) -> Vec<Token> {
    const HALT: &[&str] = &["to a halt", "to a stop", "to a standstill", "to rest"];
    let brings = is(tokens.first(), &["bring"]);
    let known = is(tokens.get(1), &["the", "both", "that", "my"]);
    if !known || !brings && !is(tokens.first(), &["stop", "halt"]) {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let halt = leads(&tokens[b..], HALT);
    let from = b + halt.unwrap_or(0);
    let end = find(&tokens, &["so that", "so as to", "such that"]).map_or(tokens.len(), |x| x.0);
    let place = tokens.get(from..end).unwrap_or_default();
    let plain = brings == halt.is_some()
        && is_place(place)
        && !is(place.first(), &["from", "to", "until", "by"])
        && !place
            .iter()
            .any(|t| matches!(t.kind, TokenKind::Comma) || is(Some(t), &["and"]));
    // (what it is for says the same, if it only blocks)
    let blocks = end == tokens.len()
        || tokens[end..]
            .iter()
            .any(|t| is(Some(t), &["blocks", "obstructs", "block", "obstruct", "stands"]));
    if !plain || !blocks {
        return tokens;
    }
    let rest = match tokens[end..]
        .iter()
        .position(|t| t.kind == TokenKind::Comma || text(t) == "and")
    {
        Some(k) => &tokens[end + k..],
        None => &[],
    };
    [&tokens[1..b], &led("stands", &tokens[0], &[place, rest])].concat()
}

/// "get all three pedestrians off the site": they go.
pub(super) fn off_site(tokens: Vec<Token>) -> Vec<Token> {
    const SITES: &[&str] = &[
        "off the site",
        "off the building site",
        "off the construction site",
        "off the premises",
        "off the grounds",
        "off the map",
        "off the scene",
        "off the set",
        "off the lot",
        "off the parking lot",
        "off the car park",
        "off the stage",
        "off the screen",
        "off the picture",
        "off the plan",
    ];
    const ROADS: &[&str] = &[
        "off the road",
        "off the street",
        "off the highway",
        "off the motorway",
        "off the freeway",
        "off the carriageway",
    ];
    let gets = is(tokens.first(), &["get", "take", "have"]);
    let sends = is(
        tokens.first(),
        &[
            "move", "bring", "drive", "push", "pull", "send", "kick", "lift", "clear", "shoo", "usher",
            "lead",
        ],
    );
    let whom = is(
        tokens.get(1),
        &["the", "both", "all", "my", "that", "those", "these", "every"],
    );
    let Some((a, b)) =
        first_noun(tokens.get(1..).unwrap_or(&[])).filter(|n| n.0 < 5 && whom && (gets || sends))
    else {
        return tokens;
    };
    let found = (1 + b..tokens.len().min(b + 10)).find_map(|i| {
        let n = leads(&tokens[i..], SITES)
            .or_else(|| leads(&tokens[i..], ROADS).filter(|_| gets && !walks(&tokens[1 + a..1 + b])))?;
        let end = tokens.get(i + n).is_none_or(|t| {
            t.kind != TokenKind::Word || is(Some(t), &["and", "please", "now", "completely"])
        });
        // ("off the road and onto the sidewalk")
        let goes_on = (i + n..tokens.len().min(i + n + 3))
            .any(|k| is(tokens.get(k), &["to", "onto", "into", "over", "on"]));
        (end && !goes_on).then_some((i, i + n))
    });
    match found {
        Some((i, end)) => led("remove", &tokens[0], &[&tokens[1..i], &tokens[end..]]),
        None => tokens,
    }
}

/// True if people are named.
fn walks(noun: &[Token]) -> bool {
    matches!(super::words::longest(noun), Some((Sense::Noun(n, _), _)) if n.classes[0] == crate::scene::Class::Pedestrian)
}

/// "clear the junction of cars": the cars there go.
pub(super) fn cleared_of(tokens: Vec<Token>) -> Vec<Token> {
    let verb = is(
        tokens.first(),
        &["clear", "empty", "free", "rid", "sweep", "strip", "relieve"],
    );
    let Some(of) = tokens
        .iter()
        .position(|t| text(t) == "of")
        .filter(|k| verb && *k > 1)
    else {
        return tokens;
    };
    let what = &tokens[of + 1..];
    // "the left side of the road" has its own "of"
    let last = (of..tokens.len())
        .rev()
        .find(|k| text(&tokens[*k]) == "of")
        .unwrap_or(of);
    let (place, what) = if has_noun(what) && !is(what.first(), &["the", "my", "our"]) {
        (&tokens[1..of], what)
    } else {
        (&tokens[1..last], &tokens[last + 1..])
    };
    if first_noun(what).is_none_or(|n| n.0 > 3) || has_noun(place) || place.is_empty() {
        return tokens;
    }
    let article = usize::from(is(place.first(), &["the", "my", "our"]));
    let prep = match super::words::longest(&place[article..]).map(|p| p.0) {
        Some(Sense::Place(super::super::description::Anchor::Junction, _)) => "at",
        Some(Sense::Place(super::super::description::Anchor::Lane(role), _))
            if !matches!(role, L::Sidewalk | L::LeftSidewalk | L::RightSidewalk | L::Road) =>
        {
            "in"
        }
        _ => "on",
    };
    let skip = usize::from(is(what.first(), &["all", "any"]));
    led(
        "remove all",
        &tokens[0],
        &[&what[skip..], &led(prep, &tokens[0], &[place])],
    )
}

/// "into the lane on its right": one lane to the right.
pub(super) fn own_side(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = leads(
            &tokens[i..],
            &[
                "into the lane",
                "to the lane",
                "onto the lane",
                "in the lane",
                "over to the lane",
                "over into the lane",
            ],
        );
        let side = n.and_then(|n| {
            let m = leads(
                &tokens[i + n..],
                &[
                    "on its", "to its", "on his", "to his", "on her", "to her", "on their", "to their",
                ],
            )?;
            let side = tokens
                .get(i + n + m)
                .filter(|t| matches!(text(t), "left" | "right"))?;
            Some((n + m + 1, text(side).to_string()))
        });
        match side {
            Some((n, side)) => {
                out.extend(led(&format!("one lane to the {side}"), &tokens[i], &[]));
                i += n;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "move everyone on the sidewalk": all the people there.
pub(super) fn everyone_there(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["everyone", "everybody"])
            && is(
                tokens.get(i + 1),
                &["on", "in", "at", "standing", "walking", "waiting"],
            )
    });
    let goes = |i: usize| {
        tokens[i..]
            .iter()
            .any(|t| matches!(text(t), "to" | "onto" | "into" | "across" | "over"))
    };
    match found.filter(|i| goes(*i)) {
        Some(i) => {
            let all = led("all the pedestrians", &tokens[i], &[]);
            [&tokens[..i], &all[..], &tokens[i + 1..]].concat()
        }
        None => tokens,
    }
}

/// "across the road, on the right, park a truck": the imperative first.
pub(super) fn place_first(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|k| {
        let fresh = is(tokens.get(k + 1), &["a", "an", "another", "one", "some"])
            || tokens.get(k + 1).is_some_and(|t| number(t).is_some());
        let puts = is(
            tokens.get(k),
            &["park", "put", "place", "add", "set", "insert", "position"],
        ) && fresh;
        let from = (0..k)
            .rev()
            .find(|i| {
                is(tokens.get(*i), &["and", "then"])
                    || i + 1 < k && tokens[*i].kind == TokenKind::Comma && !is_place(&tokens[i + 1..k])
            })
            .map_or(0, |i| i + 1);
        let end = (k + 1..tokens.len())
            .find(|i| tokens[*i].kind == TokenKind::Comma || text(&tokens[*i]) == "and")
            .unwrap_or(tokens.len());
        let bare = first_noun(&tokens[k + 1..end]).is_some_and(|n| k + 1 + n.1 == end);
        (puts && from < k && is_place(&tokens[from..k]) && bare).then_some((from, k, end))
    });
    match found {
        Some((from, k, end)) => {
            let place: Vec<Token> = tokens[from..k]
                .iter()
                .filter(|t| t.kind != TokenKind::Comma)
                .cloned()
                .collect();
            // ("across the road on the right roadside": the last place is the one)
            let vague = leads(&place, &["across the road", "across the street", "over the road"])
                .filter(|n| is(place.get(*n), &["on", "at", "in"]))
                .unwrap_or(0);
            let place = place[vague..].to_vec();
            [&tokens[..from], &tokens[k..end], &place, &tokens[end..]].concat()
        }
        None => tokens,
    }
}

/// "to the other pavement", "to the other side of the road": the side where it is not.
pub(super) fn other_strip(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STRIPS: &[&str] = &[
        "sidewalk",
        "pavement",
        "footpath",
        "kerb",
        "curb",
        "roadside",
        "shoulder",
        "verge",
        "walkway",
        "footway",
        "side of the road",
        "side of the street",
        "side of the carriageway",
        "side",
        "edge of the road",
        "edge of the street",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let the = is(tokens.get(i - 1), &["the"]) && is(tokens.get(i), &["other", "opposite", "far"]);
        // ("has reached the opposite pavement" is read as a whole)
        let led = i > 1 && is(tokens.get(i - 2), &["to", "onto", "on", "at", "along"]);
        let n = leads(tokens.get(i + 1..)?, STRIPS).filter(|_| the && led)?;
        Some((i, n))
    });
    let Some((i, n)) = found else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[..i]).filter(|x| x.0 < 6) else {
        return tokens;
    };
    let (from, _) = (a.saturating_sub(1), b);
    let end = (b..i)
        .find(|k| {
            is(
                tokens.get(*k),
                &[
                    "to", "over", "onto", "across", "should", "is", "are", "on", "from", "goes", "go",
                    "crosses", "has", "have", "must", "walk", "walks", "cross", "move", "moves", "change",
                    "changes",
                ],
            )
        })
        .unwrap_or(b);
    let (_, mentions) = super::parse(talk.text, &super::tag(&tokens[from..end]));
    let Some(m) = mentions.iter().find(|m| !m.is_anchor && !m.gone) else {
        return tokens;
    };
    let ids = fitting(talk.map, talk.boxes, m, &mentions);
    let left = |id: &crate::scene::BoxId| {
        let p = talk.boxes[id].center_m.truncate();
        in_role(talk.map, L::LeftSidewalk, p)
            || !in_role(talk.map, L::RightSidewalk, p) && talk.map.course(p).map_or(p.y, |c| c.1) > 0.5
    };
    let Some(first) = ids.first() else {
        return tokens;
    };
    if !ids.iter().all(|id| left(id) == left(first)) {
        return tokens;
    }
    let side = if left(first) { "right" } else { "left" };
    let walks = talk.boxes[first].class == crate::scene::Class::Pedestrian;
    let wide = is(tokens.get(i + 1), &["side", "edge"]);
    let mut out = tokens[..i].to_vec();
    // a road has lanes on its sides; who walks is on the pavement there
    let place = match (wide, walks) {
        (true, true) => format!("{side} pavement"),
        (true, false) => format!("{side} roadside"),
        _ => format!("{side} {}", text(&tokens[i + 1])),
    };
    let used = if wide { n } else { 1 };
    out.extend(led(&place, &tokens[i], &[&tokens[i + 1 + used..]]));
    out
}
