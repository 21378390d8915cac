//! Briefs as designers give them: "coach out, two motorbikes in the left lane", "farther off with the car, please: 32 m", "nobody
//! on foot, nothing parked, just the bus".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, is_unit, leads, led, number, text, trimmed,
};
use crate::scene::Class;

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = instead_first(to_the_other(sky_last(cut_to(tokens)), talk), talk);
    let out = beyond(with_doing(out), talk);
    let out = same_side(opposite_named(not_that(in_other_words(out), talk)), talk);
    let out = out_and_in(pulls_out(out), talk);
    let out = farther_with(wanted_at(out, talk), talk);
    let out = nothing_but(out, talk);
    let out = sky_and_gone(in_which_there(out));
    somebody_of(rider_apposed(apposed(out)), talk)
}

/// Where the box that these words mean stands, if it is one.
fn place_of(np: &[Token], talk: &Talk<'_>) -> Option<(glam::DVec2, f64)> {
    let boxes = talk.boxes_of(np);
    let first = boxes.first()?;
    let p = boxes.iter().map(|b| b.center_m.truncate()).sum::<glam::DVec2>() / boxes.len() as f64;
    Some((p, first.yaw_rad))
}

/// The strip or lane on which the box stands that these words mean.
pub(super) fn strip_of(np: &[Token], talk: &Talk<'_>) -> Option<&'static str> {
    use crate::scene::graph::LaneRole as L;
    let boxes = talk.boxes_of(np);
    match super::super::holds::role_of(talk.map, boxes.first()?)? {
        L::LeftSidewalk => Some("on the left sidewalk"),
        L::RightSidewalk => Some("on the right sidewalk"),
        L::LeftRoadside => Some("on the left roadside"),
        L::RightRoadside => Some("on the right roadside"),
        L::Ego => Some("in our lane"),
        L::Oncoming => Some("in the oncoming lane"),
        L::Left => Some("in the left lane"),
        L::Right => Some("in the right lane"),
        _ => None,
    }
}

const BEYOND: &str =
    "beyond|past|on the far side of|at the far side of|on the other side of|further on than|farther on than";
const SHORT_OF: &str = "short of|just short of|on this side of|this side of|on the near side of|at the near side of|just this side of";

/// "beyond the barriers", "short of the bus": seen from the ego vehicle, whichever way they face.
fn beyond(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let (n, far) = begins(&tokens[i..], BEYOND)
            .map(|n| (n, true))
            .or_else(|| begins(&tokens[i..], SHORT_OF).map(|n| (n, false)))?;
        let np = &tokens[i + n..];
        let (a, b) = first_noun(np).filter(|x| x.0 < 4 && x.0 > 0)?;
        if !np[..a].iter().all(|t| t.kind == TokenKind::Word) || is(np.first(), &["a", "an", "us", "me"]) {
            return None;
        }
        let (p, yaw) = place_of(&np[..b], talk)?;
        let ahead = yaw.cos() * p.x >= 0.0;
        out.extend(led(
            if ahead == far { "in front of" } else { "behind" },
            &tokens[i],
            &[],
        ));
        Some(i + n)
    })
}

/// "a zebra 10 m ahead with all three kids walking on it": they should walk on it.
fn with_doing(tokens: Vec<Token>) -> Vec<Token> {
    let Some(k) = (3..tokens.len()).find(|k| {
        is(tokens.get(*k), &["with"])
            && is(tokens.get(k + 1), &["all", "both", "the"])
            && has_noun(&tokens[..*k])
    }) else {
        return tokens;
    };
    let np = &tokens[k + 1..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let doing = np.get(b).is_some_and(|t| {
        matches!(
            text(t),
            "walking"
                | "crossing"
                | "standing"
                | "waiting"
                | "driving"
                | "riding"
                | "parked"
                | "coming"
                | "facing"
                | "following"
        )
    });
    if !doing || !np.get(b + 1..).is_some_and(is_place) {
        return tokens;
    }
    [
        &tokens[..k],
        &led("and", &tokens[k], &[&np[..b]]),
        &led("should be", &tokens[k], &[&np[b..]]),
    ]
    .concat()
}

/// "on the opposite pavement, the left one": on the left pavement.
fn opposite_named(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            && is(tokens.get(k + 1), &["the"])
            && is(tokens.get(k + 2), &["left", "right"])
            && is(tokens.get(k + 3), &["one"])
            && tokens.get(k + 4).is_none_or(|t| t.kind == TokenKind::Comma)
    });
    let Some(k) = found else { return tokens };
    let Some(o) = (k.saturating_sub(3)..k).find(|i| is(tokens.get(*i), &["opposite", "other", "far"])) else {
        return tokens;
    };
    let mut out = tokens;
    out[o].text = out[k + 2].text.clone();
    out.drain(k..k + 4);
    out
}

const SAME_SIDE: &str = "on the same side of the street|on the same side of the road|at the same side of the street|at the same side of the road|on that side of the street|\
    on that side of the road|on the same side of the carriageway|on the same side as it|at the same edge of the road|on the same edge of the road|at the same edge|on the same edge|at the same kerb|on the same kerb|\
    at the same curb|on the same roadside|at the same roadside|on the same shoulder";

/// "close to the trailer, on the same side of the street": on the side where the trailer stands.
fn same_side(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = (2..tokens.len()).find_map(|i| begins(&tokens[i..], SAME_SIDE).map(|n| (i, n))) else {
        return tokens;
    };
    // the last that was named is what it is beside
    let side = (0..i).rev().find_map(|k| {
        let (a, b) = first_noun(&tokens[k..i]).filter(|x| x.0 > 0 && is(tokens.get(k), &["the", "that"]))?;
        let _ = a;
        strip_of(&tokens[k..k + b], talk)
    });
    // "it is parked at the same edge, in front of the police car"
    let side = side.or_else(|| {
        let (a, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 > 0 && x.0 < 6)?;
        let the = i + n + a - 1;
        is(tokens.get(the), &["the", "that"]).then(|| strip_of(&tokens[the..i + n + b], talk))?
    });
    // (of the command that it is told with)
    let order = (1..i)
        .rev()
        .find(|k| is(tokens.get(k - 1), &["and", "then"]) && super::super::rephrase::is_verb(&tokens[*k]))
        .unwrap_or(0);
    let fresh = |from: usize| {
        tokens[order..from]
            .iter()
            .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]))
    };
    let end = first_noun(&tokens[order..i])
        .filter(|x| fresh(order + x.0))
        .map_or(i, |x| order + x.1);
    let Some(words) = side else {
        return tokens;
    };
    let from = i - usize::from(tokens[i - 1].kind == TokenKind::Comma);
    // (behind the other's name it would tell where that one stands)
    let strip = led(words, &tokens[i], &[]);
    [
        &tokens[..end.min(from)],
        &strip,
        &tokens[end.min(from)..from],
        &tokens[i + n..],
    ]
    .concat()
}

/// "let the bus pull out: it drives in my lane now": it does not go away.
fn pulls_out(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(
        &tokens,
        &[
            "pull out",
            "pulls out",
            "has pulled out",
            "is pulling out",
            "pulled out",
            "pull away",
            "pulls away",
        ],
    ) else {
        return tokens;
    };
    let after = &tokens[k + n..];
    let mark = after
        .first()
        .is_some_and(|t| !matches!(t.kind, TokenKind::Word | TokenKind::Number(_)))
        || is(after.first(), &["and"]);
    let rest = trimmed(after);
    let subject = first_noun(&tokens[..k]).is_some_and(|x| x.1 == k);
    let verb = rest
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !(mark && subject && verb) {
        return tokens;
    }
    if is(rest.first(), &["it", "he", "she", "they"]) {
        let who: &[Token] = if is(tokens.first(), &["let", "have"]) {
            &tokens[1..k]
        } else {
            &tokens[..k]
        };
        return [who, &rest[1..]].concat();
    }
    tokens
}

const OUT: [&str; 4] = ["out", "off", "away", "gone"];
const SAME_SPOT: &str = "in at the very same spot|in at the same spot|at the very same spot|at the same spot|in the very same spot|in the same spot|at the same place|\
    in the same place|in at the same place|in its place|in its spot|in its stead|in there|in instead|instead|in the same position|at the same position|in at the very same place|in";

/// "police car out, fire engine in at the very same spot", "coach out, two motorbikes in the left lane".
fn out_and_in(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let parts: Vec<&[Token]> = tokens
        .split(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]))
        .map(trimmed)
        .filter(|p| !p.is_empty())
        .collect();
    let [gone, new] = parts.as_slice() else {
        return tokens;
    };
    let Some((last, who)) = gone.split_last().filter(|x| is(Some(x.0), &OUT)) else {
        return tokens;
    };
    let named = first_noun(who).is_some_and(|x| x.0 < 4)
        && !who
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    let Some((a, b)) = first_noun(new).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let counted = new[..a]
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]));
    let definite = is(new.first(), &["the", "both", "all", "my", "that"]);
    let rest = trimmed(&new[b..]);
    let verbs = new
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false) || is(Some(t), &OUT));
    let there = begins(rest, SAME_SPOT).filter(|n| *n == rest.len());
    if is(rest.first(), &["on"]) && rest.len() == 1 {
        return tokens; // "cyclists off, mopeds on"
    }
    let fresh = counted || talk.fits(&new[..b]) == 0 || there.is_some_and(|n| n > 1);
    if !named
        || definite
        || verbs
        || !fresh
        || talk.fits(who) == 0
        || (rest.is_empty() || there.is_none() && !is_place(rest))
    {
        return tokens;
    }
    let the = if is(who.first(), &["the", "both", "all", "my", "that", "every"]) {
        ""
    } else {
        "the"
    };
    let mut out = led(
        "remove",
        last,
        &[
            &if the.is_empty() {
                Vec::new()
            } else {
                led(the, last, &[])
            },
            who,
        ],
    );
    out.extend(led(
        if counted { "and add" } else { "and add a" },
        &new[0],
        &[&new[..b]],
    ));
    if there.is_some() {
        out.extend(led("in its place", &new[0], &[]));
    } else {
        // ("in the left lane instead")
        let end = rest.len() - usize::from(is(rest.last(), &["instead"]));
        out.extend_from_slice(&rest[..end]);
    }
    out
}

const TOO: &[&str] = &[
    "closer than that",
    "nearer than that",
    "farther than that",
    "further away than that",
    "farther away than that",
    "further than that",
    "not that far",
    "not so far",
    "not that close",
    "not so close",
    "too far",
    "too far away",
    "too far off",
    "too far out",
    "too far ahead",
    "too far back",
    "too far behind",
    "too close",
    "too near",
    "much too close",
    "much too far",
    "far too close",
    "way too close",
    "way too far",
    "a bit too close",
    "a bit too far",
    "a little too close",
    "a little too far",
];

/// "the barriers are too far off, I'd have them at 15 m", "... ; 10 m in front of me is what I'm after": that is where.
fn wanted_at(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((k, n)) = find(&tokens, TOO) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4 && x.1 < k + 1) else {
        return tokens;
    };
    let stands = tokens[b..k].iter().all(|t| {
        matches!(
            text(t),
            "is" | "are"
                | "sits"
                | "sit"
                | "stands"
                | "stand"
                | "drives"
                | "drive"
                | "seems"
                | "still"
                | "was"
                | "were"
                | "a"
                | "bit"
                | "rides"
                | "follows"
        )
    });
    let mark = (k + n..tokens.len()).find(|i| {
        matches!(tokens[*i].kind, TokenKind::Comma | TokenKind::Mark)
            || is(tokens.get(*i), &["so", "and"])
            || text(&tokens[*i]) == ";"
    });
    let Some(mark) = mark.filter(|m| *m <= k + n + 3 && stands && talk.fits(&tokens[..b]) > 0) else {
        return tokens;
    };
    let rest = &tokens[mark + 1..];
    let Some(m) = (0..rest.len()).find(|i| number(&rest[*i]).is_some() && is_unit(rest.get(i + 1))) else {
        return tokens;
    };
    // what is done to it is a command of its own: "push it 8 m away"
    if !rest[..m].iter().all(|t| is(Some(t), WISHES)) {
        return tokens;
    }
    let end = (m + 2..rest.len())
        .find(|i| {
            is(
                rest.get(*i),
                &[
                    "is", "would", "will", "should", "please", "and", "instead", "seems",
                ],
            ) || !matches!(rest[*i].kind, TokenKind::Word)
        })
        .unwrap_or(rest.len());
    let place = if end == m + 2 {
        led("away", &rest[m], &[])
    } else {
        Vec::new()
    };
    let who = if is(tokens.first(), &["the", "both", "all", "that", "my"]) {
        tokens[..b].to_vec()
    } else {
        led("the", &tokens[0], &[&tokens[..b]])
    };
    let tail = match rest.get(end) {
        Some(t) if is(Some(t), &["and"]) => &rest[end..],
        _ => &[][..],
    };
    [
        &who[..],
        &led("should be", &rest[m], &[&rest[m..end], &place]),
        tail,
    ]
    .concat()
}

const WISHES: &[&str] = &[
    "i",
    "id",
    "we",
    "wed",
    "would",
    "like",
    "have",
    "want",
    "need",
    "it",
    "them",
    "him",
    "her",
    "at",
    "should",
    "shall",
    "must",
    "be",
    "is",
    "are",
    "rather",
    "prefer",
    "only",
    "just",
    "better",
    "make",
    "that",
    "a",
    "the",
    "wants",
    "wish",
    "to",
    "about",
    "say",
    "something",
    "put",
    "there",
    "more",
];

const CLOSER: &[&str] = &[
    "farther off with",
    "further off with",
    "farther away with",
    "further away with",
    "closer with",
    "nearer with",
    "farther with",
    "further with",
    "farther back with",
    "further back with",
    "back with",
    "forward with",
    "farther out with",
    "further out with",
    "up with",
    "closer in with",
];

/// "farther off with the car, please: 32 m": that is how far it is.
fn farther_with(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, CLOSER) else {
        return tokens;
    };
    let rest = &tokens[n..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let after = trimmed(&rest[b..]);
    let after = if is(after.first(), &["to"]) {
        &after[1..]
    } else {
        after
    };
    let after: Vec<Token> = after
        .iter()
        .skip_while(|t| !matches!(t.kind, TokenKind::Number(_)) && number(t).is_none())
        .cloned()
        .collect();
    let metres = after.first().is_some_and(|t| number(t).is_some()) && is_unit(after.get(1));
    if !metres || talk.fits(&rest[..b]) == 0 {
        return tokens;
    }
    let away = if after.len() == 2 {
        led("away", &after[0], &[])
    } else {
        Vec::new()
    };
    [&rest[..b], &led("should be", &after[0], &[&after, &away])].concat()
}

/// "nobody on foot, nothing parked, just the bus": only the bus stays.
fn nothing_but(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let parts: Vec<&[Token]> = tokens
        .split(|t| t.kind == TokenKind::Comma || text(t) == ":")
        .map(trimmed)
        .filter(|p| !p.is_empty())
        .collect();
    let Some((last, before)) = parts.split_last() else {
        return tokens;
    };
    let keeps = is(last.first(), &["just", "only"]) && is(last.get(1), &["the", "my", "that", "both"]);
    let none = |p: &&&[Token]| is(p.first(), &["no", "nobody", "nothing", "noone", "neither"]) && p.len() < 8;
    // ("it is night, and neither cars nor people are left, just the motorcycle")
    let sky = before
        .iter()
        .take_while(|p| super::parting::only_sky(p) && !has_noun(p))
        .count();
    let (sky, before) = before.split_at(sky);
    let some = before.iter().filter(none).count();
    let bare = first_noun(last).is_some_and(|x| x.1 == last.len()) && talk.fits(&last[1..]) > 0;
    if !(keeps && bare && some > 0 && some == before.len()
        || keeps && bare && before.is_empty() && tokens.len() < 6)
    {
        return tokens;
    }
    let gone = led("remove everything except", &last[0], &[&last[1..]]);
    match sky.last() {
        Some(_) => {
            let words: Vec<&[Token]> = sky.to_vec();
            [words.concat(), led("and", &last[0], &[&gone])].concat()
        }
        None => gone,
    }
}

/// "I'd like heavy rain and the motorbike gone": the sky, and who goes.
fn sky_and_gone(tokens: Vec<Token>) -> Vec<Token> {
    let body = trimmed(&tokens);
    let Some((last, rest)) = body.split_last().filter(|x| is(Some(x.0), &OUT)) else {
        return tokens;
    };
    let Some(k) = rest.iter().rposition(|t| is(Some(t), &["and"])) else {
        return tokens;
    };
    let (sky, who) = (&rest[..k], &rest[k + 1..]);
    let definite =
        is(who.first(), &["the", "both", "all", "that"]) && first_noun(who).is_some_and(|x| x.1 == who.len());
    let plain = !who.iter().any(|t| HELPERS.contains(&text(t)));
    if !definite || !plain || has_noun(sky) || !super::parting::only_sky(sky) {
        return tokens;
    }
    [sky, &led("and remove", last, &[who])].concat()
}

/// "on the cross street it should be two motorcycles": so many should be there.
fn in_which_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(
        &tokens,
        &[
            "it should be",
            "it shall be",
            "it must be",
            "it has to be",
            "it is to be",
            "it ought to be",
        ],
    )
    .filter(|x| x.0 > 1) else {
        return tokens;
    };
    let place = &tokens[..k];
    let counted = tokens
        .get(k + n)
        .is_some_and(|t| number(t).is_some_and(|v| v > 1))
        && has_noun(&tokens[k + n..]);
    if !counted || !is_place(place) || has_noun(place) || place.iter().any(|t| t.kind != TokenKind::Word) {
        return tokens;
    }
    [&led("there should be", &tokens[k], &[&tokens[k + n..]]), place].concat()
}

const WIDE: &[&str] = &[
    "a two wheeler",
    "a vehicle",
    "another vehicle",
    "one more vehicle",
    "a person",
    "someone",
    "somebody",
    "a second vehicle",
    "a road user",
    "another road user",
    "something",
    "a witness",
    "another witness",
    "one more witness",
    "a bystander",
    "another bystander",
    "one more person",
    "another person",
    "a second person",
    "a passer by",
    "a passerby",
    "another passer by",
    "an onlooker",
    "a spectator",
    "a third person",
    "one person more",
    "an eyewitness",
];

/// "there is a two-wheeler too, a motorbike, parked behind the taxi": the motorbike.
fn apposed(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(&tokens, WIDE) else {
        return tokens;
    };
    let also = leads(&tokens[k + n..], &["too", "as well", "also", "here", "there"]).unwrap_or(0);
    let comma = k + n + also;
    if tokens.get(comma).is_none_or(|t| t.kind != TokenKind::Comma)
        || !is(tokens.get(comma + 1), &["a", "an"])
    {
        return tokens;
    }
    let Some((a, b)) = first_noun(&tokens[comma + 1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let _ = a;
    let end = comma + 1 + b;
    let skip = usize::from(tokens.get(end).is_some_and(|t| t.kind == TokenKind::Comma));
    [&tokens[..k], &tokens[comma + 1..end], &tokens[end + skip..]].concat()
}

/// "a second cyclist, a boy ahead of us": the boy rides.
fn rider_apposed(tokens: Vec<Token>) -> Vec<Token> {
    const RIDER: [&str; 5] = ["cyclist", "motorcyclist", "biker", "rider", "bicyclist"];
    const PERSON: [&str; 14] = [
        "boy",
        "girl",
        "man",
        "woman",
        "lady",
        "kid",
        "child",
        "guy",
        "teenager",
        "student",
        "gentleman",
        "postman",
        "youth",
        "teen",
    ];
    let found = (1..tokens.len()).find(|k| {
        let also = usize::from(is(tokens.get(k + 1), &["too", "also"]));
        is(tokens.get(*k), &RIDER)
            && tokens
                .get(k + also + 1)
                .is_some_and(|t| t.kind == TokenKind::Comma)
            && is(tokens.get(k + also + 2), &["a", "an"])
    });
    let Some(k) = found else { return tokens };
    let from = k + 1 + usize::from(is(tokens.get(k + 1), &["too", "also"]));
    match (from + 2..tokens.len().min(from + 5)).find(|i| is(tokens.get(*i), &PERSON)) {
        Some(p) => [&tokens[..=k], &tokens[p + 1..]].concat(),
        None => tokens,
    }
}

const SOMEBODY: &[&str] = &[
    "the driver",
    "its driver",
    "the owner",
    "its owner",
    "the passenger",
    "a passenger",
    "the passengers",
    "the mechanic",
    "the mother",
    "the father",
    "the teacher",
    "a police officer",
    "the rider",
    "the bus driver",
    "the lorry driver",
    "the truck driver",
    "the car driver",
    "his driver",
];

/// "the driver should be standing next to the car": somebody new, where nobody is.
fn somebody_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, SOMEBODY) else {
        return tokens;
    };
    let after = &tokens[n..];
    let wish = leads(
        after,
        &[
            "should be",
            "should stand",
            "must be",
            "has to be",
            "ought to be",
            "should now be",
            "should also be",
            "should wait",
            "stands",
            "is standing",
            "is now standing",
            "has got out and stands",
            "is waiting",
            "waits",
            "should be standing",
            "should be waiting",
        ],
    );
    let Some(w) = wish else { return tokens };
    let nobody = !talk.boxes.values().any(|b| b.class == Class::Pedestrian);
    if !nobody || !after[w..].iter().any(|t| text(t) == "the") {
        return tokens;
    }
    let rest = &after[w..];
    let rest = if is(rest.first(), &["standing", "waiting"]) {
        &rest[1..]
    } else {
        rest
    };
    led("add a pedestrian", &tokens[0], &[rest])
}

const GONE: &[&str] = &[
    "are gone",
    "have gone",
    "have left",
    "are away",
    "have disappeared",
    "have vanished",
    "are no longer there",
    "are not there any more",
    "are not there anymore",
    "arent there any more",
    "have been removed",
    "have been cleared away",
    "have been taken away",
    "should go",
    "must go",
    "have to go",
    "can go",
    "should be gone",
    "should disappear",
    "should vanish",
    "need to go",
];

/// "the car on the shoulder and the cones are gone": both go.
fn both_gone(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, _)) = (2..tokens.len()).find_map(|k| {
        leads(&tokens[k..], GONE)
            .filter(|n| k + n == tokens.len())
            .map(|n| (k, n))
    }) else {
        return tokens;
    };
    let from = leads(&tokens, &["so", "and", "then", "now"]).unwrap_or(0);
    let who = &tokens[from..k];
    let parts: Vec<&[Token]> = who.split(|t| is(Some(t), &["and"])).collect();
    let [a, b] = parts.as_slice() else {
        return tokens;
    };
    let known = |p: &[Token]| {
        is(p.first(), &["the", "both", "all", "that", "those"])
            && first_noun(p).is_some_and(|x| x.0 < 4 && (x.1 == p.len() || is_place(&p[x.1..])))
            && p.iter()
                .all(|t| t.kind == TokenKind::Word && !HELPERS.contains(&text(t)))
    };
    // (without a place that is read as it stands)
    let placed = |p: &[Token]| first_noun(p).is_some_and(|x| x.1 < p.len());
    if !(known(a) && known(b) && (placed(a) || placed(b))) {
        return tokens;
    }
    led("remove", &tokens[0], &[a, &led("and remove", &b[0], &[b])])
}

const AND_SKY: &[(&str, &str)] = &[
    (
        "and that it rains|and it rains|and it is raining|and it should rain|and that it is raining|and its raining|and that it should rain",
        "make it rain and",
    ),
    (
        "and that it snows|and it snows|and it is snowing|and it should snow|and that it is snowing|and its snowing|and that it should snow",
        "make it snow and",
    ),
    (
        "and that it is night|and it is night|and its night|and that it is dark|and it is dark|and its dark",
        "make it night and",
    ),
    (
        "and that it is foggy|and it is foggy|and its foggy|and that there is fog|and there is fog|and it is misty",
        "make it foggy and",
    ),
];

/// "the bus is not there any more and it rains": the sky first.
fn sky_last(tokens: Vec<Token>) -> Vec<Token> {
    for (phrases, words) in AND_SKY {
        let found =
            (3..tokens.len()).find(|k| begins(&tokens[*k..], phrases).is_some_and(|n| k + n == tokens.len()));
        if let Some(k) = found.filter(|k| has_noun(&tokens[..*k])) {
            let from = leads(
                &tokens,
                &[
                    "make that",
                    "make sure that",
                    "make sure",
                    "see to it that",
                    "have it that",
                ],
            )
            .unwrap_or(0);
            return led(words, &tokens[0], &[&tokens[from..k]]);
        }
    }
    tokens
}

/// "jogger on the other sidewalk": where he is not.
fn to_the_other(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((a, b)) = first_noun(&tokens).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let the = is(tokens.first(), &["the", "that", "both"]);
    let bare = tokens[..a].iter().all(|t| {
        number(t).is_none()
            && !is(
                Some(t),
                &["a", "an", "another", "some", "add", "put", "place", "move"],
            )
    });
    let rest = trimmed(&tokens[b..]);
    let goal = leads(
        rest,
        &[
            "on the other",
            "on the opposite",
            "at the other",
            "at the opposite",
            "in the other",
            "in the opposite",
            "on other",
            "on opposite",
            "over the road",
        ],
    );
    let Some(n) = goal else { return tokens };
    let strip = rest.get(n).is_some_and(|t| {
        matches!(
            text(t),
            "sidewalk"
                | "pavement"
                | "side"
                | "kerb"
                | "curb"
                | "roadside"
                | "edge"
                | "shoulder"
                | "footpath"
                | "lane"
                | "verge"
        )
    });
    let ends = rest.len() == n + 1
        || leads(&rest[n + 1..], &["of the road", "of the street"]).is_some_and(|m| n + 1 + m == rest.len());
    if !bare || !strip || !ends || talk.fits(&tokens[..b]) != 1 {
        return tokens;
    }
    let who = if the {
        tokens[..b].to_vec()
    } else {
        led("the", &tokens[0], &[&tokens[..b]])
    };
    led(
        "move",
        &tokens[0],
        &[&who, &led("to the", &rest[0], &[&rest[n - 1..]])],
    )
}

const INSTEAD: &[&str] = &[
    "instead of",
    "in place of",
    "in the place of",
    "rather than",
    "in lieu of",
    "than",
];
const WANT: &[&str] = &[
    "use",
    "put",
    "have",
    "show",
    "show me",
    "give me",
    "i need",
    "we need",
    "i want",
    "we want",
    "i would like",
    "id like",
    "i would prefer",
    "id prefer",
    "let us have",
    "lets have",
    "we should have",
    "there should be",
    "there shall be",
    "there must be",
    "add",
    "place",
    "take",
    "we could use",
    "i could use",
    "i would rather have",
    "id rather have",
    "we would like",
    "wed like",
    "please put",
    "please use",
    "i would like to have",
    "id like to have",
];

/// "rather than cones use three barriers by the digger": those go, these come; in their place, if no other is said.
fn instead_first(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, INSTEAD) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let old = &tokens[n..n + b];
    let rest = trimmed(&tokens[n + b..]);
    let Some(w) = leads(rest, WANT) else { return tokens };
    let new = &rest[w..];
    let fresh =
        is(new.first(), &["a", "an", "another", "some"]) || new.first().is_some_and(|t| number(t).is_some());
    let Some((_, e)) = first_noun(new).filter(|x| x.0 < 4 && fresh) else {
        return tokens;
    };
    let tail = trimmed(&new[e..]);
    let bare = is(
        old.first(),
        &["the", "both", "all", "that", "those", "my", "every"],
    );
    let one = is(old.first(), &["a", "an"]) || number(&old[0]).is_some();
    if talk.fits(old) == 0 || one {
        return tokens;
    }
    let the = if bare {
        Vec::new()
    } else {
        led("the", &tokens[0], &[])
    };
    if tail.is_empty() {
        return led(
            "replace",
            &tokens[0],
            &[&the, old, &led("with", &tokens[0], &[&new[..e]])],
        );
    }
    // (how several stand is read with them)
    let told = is_place(tail)
        || is(
            tail.first(),
            &["who", "that", "which", "there", "instead", "parked"],
        )
        || tail[0].text.ends_with("ing");
    if !told
        || is(tail.first(), &["one", "each", "all", "both"])
        || new.get(e).is_some_and(|t| t.kind != TokenKind::Word)
    {
        return tokens;
    }
    // (where the old one is anyhow)
    if is_place(tail) && talk.fits(&[old, tail].concat()) > 0 {
        return led(
            "replace",
            &tokens[0],
            &[&the, old, &led("with", &tokens[0], &[&new[..e]])],
        );
    }
    let there =
        leads(tail, &["there", "in its place", "in their place", "instead"]).is_some_and(|m| m == tail.len());
    let tail = if there {
        led("in its place", &tokens[0], &[])
    } else {
        tail.to_vec()
    };
    [
        &led("remove", &tokens[0], &[&the, old])[..],
        &led("and add", &tokens[0], &[&new[..e]]),
        &tail,
    ]
    .concat()
}

/// Sentences of which one only makes sense with the next, or none of whose parts stands alone: before they are parted.
pub fn whole(tokens: Vec<Token>) -> Vec<Token> {
    let mut tokens = super::halves::joined(tokens);
    // "the red car is too far out; 10 m in front of me would do"
    for i in 3..tokens.len().saturating_sub(2) {
        let complaint = tokens[i].kind == TokenKind::Stop
            && TOO.iter().any(|t| {
                let n = t.split(' ').count();
                i >= n && leads(&tokens[i - n..i], &[t]).is_some()
            });
        // "bring the red car nearer; 8 metres in front of us will do"
        let closer = tokens[i].kind == TokenKind::Stop && is(tokens.get(i - 1), &["nearer", "closer", "back", "forward", "away"]);
        let order = closer
            .then(|| tokens[..i].iter().rposition(|t| t.kind == TokenKind::Stop).map_or(0, |k| k + 1))
            .filter(|from| {
                let end = tokens[i + 1..].iter().position(|t| t.kind == TokenKind::Stop).map_or(tokens.len(), |k| i + 1 + k);
                let please = usize::from(is(tokens.get(*from), &["please"]));
                super::super::rephrase::is_verb(&tokens[from + please])
                    && number(&tokens[i + 1]).is_some()
                    && is_unit(tokens.get(i + 2))
                    && tokens[i + 1..end].iter().any(|t| is(Some(t), &["do", "enough", "fine", "ok", "good", "perfect", "suffice"]))
            });
        if let Some(from) = order {
            let please = usize::from(is(tokens.get(from), &["please"]));
            let np = tokens[from + please + 1..i - 1].to_vec();
            let end = (i + 1..tokens.len()).find(|k| is(tokens.get(*k), &["will", "would", "is", "should", "ought"])).unwrap_or(tokens.len());
            let stop = (i + 1..tokens.len()).find(|k| tokens[*k].kind == TokenKind::Stop).unwrap_or(tokens.len());
            let place = tokens[i + 1..end.min(stop)].to_vec();
            let away = if place.len() == 2 { led("away", &place[0], &[]) } else { Vec::new() };
            let new = [&np[..], &led("should be", &tokens[i], &[&place, &away])].concat();
            tokens.splice(from..stop, new);
            break;
        }
        if complaint && number(&tokens[i + 1]).is_some() && is_unit(tokens.get(i + 2)) {
            tokens[i].kind = TokenKind::Comma;
        }
    }
    // "onlookers! Four of them, on the left sidewalk"
    tokens = rewritten(&tokens, |i, out| {
        let alone = i == 1 || i > 1 && tokens[i - 2].kind == TokenKind::Stop;
        let noun = i > 0
            && alone
            && tokens[i].kind == TokenKind::Stop
            && super::words::noun_at(&tokens[i - 1..i]).is_some();
        let of_them = tokens.get(i + 1).is_some_and(|t| number(t).is_some())
            && leads(tokens.get(i + 2..)?, &["of them"]).is_some();
        if !(noun && of_them) {
            return None;
        }
        let name = out.pop()?;
        out.extend(led("add", &name, &[&tokens[i + 1..i + 2]]));
        out.push(name);
        // (the comma after it)
        Some(i + 4 + usize::from(tokens.get(i + 4).is_some_and(|t| t.kind == TokenKind::Comma)))
    });
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
            _ => (sentence, &[][..]),
        };
        let mut clause = 0;
        // "the breakdown is cleared, so the car on the shoulder and the cones are gone"
        for k in 1..body.len() {
            if body[k - 1].kind == TokenKind::Comma && is(body.get(k), &["so", "and"]) {
                clause = k;
            }
        }
        out.extend_from_slice(&body[..clause]);
        out.extend(both_gone(body[clause..].to_vec()));
        out.extend_from_slice(stop);
    }
    out
}

/// "..., in other words swap them over": said before.
fn in_other_words(mut tokens: Vec<Token>) -> Vec<Token> {
    const SAID: &[&str] = &[
        "in other words",
        "that is to say",
        "put differently",
        "in short",
        "to put it differently",
        "to say it differently",
    ];
    if let Some((k, _)) = find(&tokens, SAID).filter(|x| x.0 > 3 && has_noun(&tokens[..x.0])) {
        tokens.truncate(k);
        while tokens
            .last()
            .is_some_and(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)))
        {
            tokens.pop();
        }
    }
    tokens
}

/// "it's a coach that comes at us, not a car": the car that does becomes a coach.
fn not_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "its",
            "it is",
            "it was",
            "that is",
            "thats",
            "this is",
            "it should be",
            "it must be",
            "it has to be",
        ],
    ) else {
        return tokens;
    };
    let Some(k) = (n + 2..tokens.len()).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            && is(tokens.get(k + 1), &["not", "and"])
            && leads(
                &tokens[k + 1..],
                &["not a", "not an", "and not a", "and not an", "not the"],
            )
            .is_some()
    }) else {
        return tokens;
    };
    let m = leads(&tokens[k + 1..], &["not", "and not"]).unwrap_or(1);
    let old = &tokens[k + 1 + m + 1..];
    let new = &tokens[n..k];
    let Some((_, b)) = first_noun(new).filter(|x| x.0 < 4 && is(new.first(), &["a", "an"])) else {
        return tokens;
    };
    let clause = &new[b..];
    let told = clause.is_empty() || is(clause.first(), &["that", "which", "who"]) || is_place(clause);
    let bare = first_noun(old).is_some_and(|x| x.0 < 3 && x.1 == old.len());
    if !told || !bare || talk.fits(old) == 0 {
        return tokens;
    }
    [
        &led("replace the", &tokens[0], &[old, clause])[..],
        &led("with", &tokens[0], &[&new[..b]]),
    ]
    .concat()
}

/// "cut the queue to a single person", "trim the row of cars down to two cars": so many stay.
fn cut_to(tokens: Vec<Token>) -> Vec<Token> {
    const LESS: &[&str] = &[
        "cut", "reduce", "trim", "shorten", "thin", "shrink", "bring", "limit", "pare",
    ];
    const GROUP: &[&str] = &[
        "queue",
        "line",
        "row",
        "group",
        "crowd",
        "bunch",
        "cluster",
        "gathering",
    ];
    if !is(tokens.first(), LESS) || !is(tokens.get(1), &["the", "that", "this"]) || !is(tokens.get(2), GROUP)
    {
        return tokens;
    }
    let Some((k, n)) = find(&tokens, &["down to", "to"]).filter(|x| x.0 > 2 && x.0 < 8) else {
        return tokens;
    };
    let rest = &tokens[k + n..];
    let one = leads(rest, &["a single", "just one", "only one", "one single"]);
    let from = one.or_else(|| rest.first().is_some_and(|t| number(t).is_some()).then_some(1));
    let Some((from, (_, b))) = from.and_then(|f| Some((f, first_noun(&rest[f..]).filter(|x| x.0 < 3)?)))
    else {
        return tokens;
    };
    let count = if one.is_some() {
        led("one", &rest[0], &[])
    } else {
        rest[..1].to_vec()
    };
    [
        &led("keep exactly", &tokens[0], &[&count, &rest[from..from + b]])[..],
        &rest[from + b..],
    ]
    .concat()
}
