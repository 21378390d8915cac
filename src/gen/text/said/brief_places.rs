//! Places in briefs: "beyond the barriers", "on the same side of the street", "jogger on the other sidewalk".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

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
pub(super) fn beyond(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
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
pub(super) fn with_doing(tokens: Vec<Token>) -> Vec<Token> {
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
pub(super) fn opposite_named(tokens: Vec<Token>) -> Vec<Token> {
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
pub(super) fn same_side(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = (2..tokens.len()).find_map(|i| begins(&tokens[i..], SAME_SIDE).map(|n| (i, n))) else {
        return tokens;
    };
    // the last that was named is what it is beside
    let side = (0..i).rev().find_map(|k| {
        let (_, b) = first_noun(&tokens[k..i]).filter(|x| x.0 > 0 && is(tokens.get(k), &["the", "that"]))?;
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

/// "on the cross street it should be two motorcycles": so many should be there.
pub(super) fn in_which_there(tokens: Vec<Token>) -> Vec<Token> {
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

/// "jogger on the other sidewalk": where he is not.
pub(super) fn to_the_other(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
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
