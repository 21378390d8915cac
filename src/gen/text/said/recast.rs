//! Sentences of edits cast into plain commands: "have the taxi replaced by a bus", "a lorry replaces the bus", "cars: 3",
//! "turn one into a cyclist and the car into a bus", "move him to the other pavement".

use super::super::holds::in_role;
use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::select::fitting;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::frame::unwrapped;
use super::words::{
    command_of, find, first_noun, has_noun, is, is_place, is_unit, leads, led, number, text, trimmed, word,
};
use crate::scene::graph::LaneRole as L;

/// A sentence (without its stop) in plain words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(
        &tokens,
        "get rid of|getting rid of|do away with|dispose of",
        "remove",
    );
    let out = everyone_there(out);
    let out = replaced(&out, "together with|along with|and also|as well as", "and");
    let out = replaced(&out, "not just|not only|not merely", "not");
    let out = replaced(
        &out,
        "further along the road , away from us|further along the road , away from me|further along the road|further down the road|further up the road|farther along the road|farther down the road|further on down the road|further along the street|further down the street|further along|farther along",
        "further away",
    );
    let out = replaced(
        &out,
        "have now reached|has now reached|has reached|have reached|has arrived on|have arrived on|has made it to|have made it to|has got to|have got to|has arrived at|have arrived at|have arrived in|has arrived in",
        "should go to",
    );
    let out = replaced(
        &out,
        "all that is parked|everything that is parked|everything parked|all that are parked|whatever is parked|anything parked|all things parked|everything which is parked",
        "all parked vehicles",
    );
    let out = replaced(&out, "a single one", "one");
    let out = replaced(&out, "a single", "one");
    let out = far_times(out);
    let out = wished_beside(out);
    let out = replaced(&out, "drop all|ditch all", "remove all");
    let out = replaced(&out, "drop both|ditch both", "remove both");
    let out = replaced(&out, "drop every|ditch every", "remove every");
    let out = replaced(
        &out,
        "everything stays except that|everything stays the same except that|everything stays as it is except that|everything remains except that|nothing changes except that|all stays as it is except that|all stays the same except that|the only change is that|the only difference is that|the one change is that|what changes is that",
        "",
    );
    let out = gets(left_over(without_care(out)));
    let out = now_there(out, talk);
    let out = pushed_away(half_of(out));
    let out = another_so_far(out);
    let out = to_so_far(out);
    let out = caused(out);
    let out = caused_later(out);
    let out = in_parts(out, &["let", "may", "could"], let_be);
    let out = so_many_not(out, talk);
    let out = takes_over(out);
    let out = place_first(out);
    let out = topic(out, talk);
    let out = of_group(gapped(out));
    let out = other_strip(out, talk);
    let out = instead(out, talk);
    let out = for_each(out, talk);
    let out = sent(out, talk);
    let out = no_more_than(out, talk);
    let out = off_with(out);
    let out = cleared_of(out);
    let out = own_side(out);
    super::which::any_so_many(not_those(out, talk), talk)
}

/// "there shouldn't be more than one parked car": exactly one, if there are more.
fn no_more_than(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "more than",
            "over",
            "at most",
            "no more than",
            "not more than",
            "a maximum of",
        ],
    ) else {
        return tokens;
    };
    let denied = is(tokens.get(i), &["no", "not", "at"])
        || tokens[..i]
            .iter()
            .any(|t| text(t).ends_with("nt") || matches!(text(t), "not" | "never" | "no"));
    let be = tokens[..i]
        .iter()
        .any(|t| matches!(text(t), "be" | "want" | "have" | "need" | "like" | "are" | "is"))
        || tokens[i + n..]
            .iter()
            .any(|t| matches!(text(t), "should" | "may" | "must" | "stay" | "remain"));
    let Some(many) = tokens.get(i + n).and_then(number).filter(|_| denied && be) else {
        return tokens;
    };
    let rest = &tokens[i + n + 1..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4) else {
        return tokens;
    };
    if talk.fits(&rest[..b]) <= many.max(0) as usize {
        return tokens;
    }
    let end = (b..rest.len())
        .find(|k| {
            rest[*k].kind != TokenKind::Word
                || is(
                    rest.get(*k),
                    &["and", "should", "may", "must", "here", "there", "any"],
                )
        })
        .unwrap_or(rest.len());
    led(
        "keep exactly",
        &tokens[0],
        &[&tokens[i + n..=i + n], &rest[..end]],
    )
}

/// "everybody off the pavement", "all cars out of my lane": who is there goes.
fn off_with(tokens: Vec<Token>) -> Vec<Token> {
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

/// "clear the junction of cars": the cars there go.
fn cleared_of(tokens: Vec<Token>) -> Vec<Token> {
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
    if !first_noun(what).is_some_and(|n| n.0 < 4) || has_noun(place) || place.is_empty() {
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
fn own_side(tokens: Vec<Token>) -> Vec<Token> {
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
fn everyone_there(tokens: Vec<Token>) -> Vec<Token> {
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

/// The same for what begins after "and" or a comma with one of these words.
fn in_parts(tokens: Vec<Token>, begin: &[&str], recast: fn(Vec<Token>) -> Vec<Token>) -> Vec<Token> {
    let mut out = recast(tokens);
    for k in 1..out.len() {
        let begins = is(out.get(k), begin)
            && (out[k - 1].kind == TokenKind::Comma || is(out.get(k - 1), &["and", "then", "but"]));
        if begins {
            let tail = out.split_off(k);
            out.extend(recast(tail));
            return out;
        }
    }
    out
}

/// "without touching the bus, add a taxi": what is not to change.
fn without_care(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "without touching",
            "without moving",
            "without changing",
            "without altering",
            "without disturbing",
            "without removing",
            "but without touching",
            "and without touching",
            "while leaving",
            "not touching",
        ],
    ) else {
        return tokens;
    };
    if !has_noun(&tokens[i + n..]) {
        return tokens;
    }
    let end = (i + n..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["and", "but"]))
        .map_or(tokens.len(), |k| k + 1);
    let out = [&tokens[..i], &tokens[end..]].concat();
    if has_noun(&out) {
        trimmed(&out).to_vec()
    } else {
        tokens
    }
}

/// "make the cyclist twice as far away": it should be so.
fn far_times(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make", "put", "set", "place", "move"]);
    let times = find(
        &tokens,
        &[
            "twice as far",
            "half as far",
            "three times as far",
            "double as far",
            "twice as close",
            "half as close",
        ],
    );
    match times.filter(|(i, _)| made && first_noun(&tokens[1..*i]).is_some_and(|n| 1 + n.1 == *i)) {
        Some((i, _)) => {
            let be = led("should be", &tokens[i], &[&tokens[i..]]);
            [&tokens[1..i], &be[..]].concat()
        }
        None => tokens,
    }
}

/// "I want the cyclist on the pavement and another person beside him": the person is new.
fn wished_beside(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, mood) = unwrapped(&tokens);
    let known = is(inner.first(), &["the", "my", "that", "both", "all"]);
    if !(mood.caused && known) {
        return tokens;
    }
    let lead = tokens.len() - inner.len();
    let found = (2..inner.len()).find(|k| {
        let fresh = is(inner.get(k + 1), &["a", "an", "another"])
            || inner.get(k + 1).is_some_and(|t| number(t).is_some());
        is(inner.get(*k), &["and"])
            && fresh
            && first_noun(&inner[k + 1..]).is_some_and(|n| n.0 < 4 && is_place(&inner[k + 1 + n.1..]))
            && first_noun(&inner[..*k]).is_some_and(|n| n.0 < 4 && is_place(&inner[n.1..*k]))
            && !inner[..*k].iter().any(|t| text(t) == "between")
    });
    match found {
        Some(k) => {
            let mut out = tokens[..=lead + k].to_vec();
            out.push(word("add", &tokens[lead + k]));
            out.extend_from_slice(&tokens[lead + k + 1..]);
            out
        }
        None => tokens,
    }
}

/// "the van gets a trailer": a trailer behind it.
fn gets(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "gets a",
            "receives a",
            "is given a",
            "should have a",
            "should get a",
            "tows a",
            "now tows a",
            "should tow a",
            "pulls a",
            "should pull a",
            "has a",
            "now has a",
        ],
    ) else {
        return tokens;
    };
    let known =
        is(tokens.first(), &["the", "my", "that"]) && first_noun(&tokens[..i]).is_some_and(|x| x.0 < 5);
    let trailer = super::words::longest(&tokens[i + n..])
        .is_some_and(|l| matches!(l.0, Sense::Noun(k, _) if k.classes[0] == crate::scene::Class::Trailer));
    if !(known && trailer) {
        return tokens;
    }
    let end = (i + n..tokens.len())
        .find(|k| tokens[*k].kind == TokenKind::Comma || text(&tokens[*k]) == "and")
        .unwrap_or(tokens.len());
    let behind = led("behind", &tokens[i], &[&tokens[..i]]);
    led(
        "add a",
        &tokens[0],
        &[&tokens[i + n..end], &behind, &tokens[end..]],
    )
}

/// "there are two women now": two in all.
fn now_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there are",
            "there is",
            "now there are",
            "now there is",
            "there are now",
            "there is now",
            "we now have",
            "now we have",
        ],
    ) else {
        return tokens;
    };
    let now = tokens.iter().any(|t| text(t) == "now");
    let many = tokens.get(n).and_then(number);
    let rest: Vec<Token> = tokens[n..].iter().filter(|t| text(t) != "now").cloned().collect();
    let bare = first_noun(&rest)
        .is_some_and(|x| x.0 < 4 && trimmed(&rest[x.1..]).is_empty() && talk.fits(&rest[x.0..x.1]) > 0);
    match many.filter(|_| now && bare) {
        Some(_) => led("keep exactly", &tokens[0], &[&rest]),
        None => tokens,
    }
}

/// "half the cones": half as many.
fn half_of(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "half the",
            "half of the",
            "only half the",
            "just half the",
            "only half of the",
        ],
    ) else {
        return tokens;
    };
    let bare = first_noun(&tokens[n..]).is_some_and(|x| x.0 < 3 && n + x.1 == tokens.len());
    if bare {
        led("half as many", &tokens[0], &[&tokens[n..]])
    } else {
        tokens
    }
}

/// "push it 8 m away": by so much, not to there.
fn pushed_away(tokens: Vec<Token>) -> Vec<Token> {
    let verb = tokens.iter().position(|t| {
        matches!(
            text(t),
            "push" | "move" | "shift" | "shove" | "pull" | "drag" | "nudge" | "send" | "drive"
        )
    });
    let found = verb.and_then(|v| {
        (v + 2..tokens.len()).find(|k| {
            is(tokens.get(*k), &["away"])
                && is_unit(tokens.get(k - 1))
                && tokens.get(k - 2).is_some_and(|t| number(t).is_some())
                && !is(tokens.get(k.wrapping_sub(3)), &["at", "to", "until", "is", "of"])
                && (tokens.get(k + 1).is_none_or(|t| t.kind != TokenKind::Word)
                    || is(tokens.get(k + 1), &["from", "and", "please"])
                        && !is(tokens.get(k + 2), &["the", "a", "it", "him", "her", "them"]))
        })
    });
    match found {
        Some(k) => {
            let mut out = tokens[..k].to_vec();
            out.push(word("further", &tokens[k]));
            out.extend_from_slice(&tokens[k..]);
            out
        }
        None => tokens,
    }
}

/// "only one pedestrian left on the crossing": left over, not on the left.
fn left_over(tokens: Vec<Token>) -> Vec<Token> {
    let few = tokens.iter().any(|t| {
        matches!(
            text(t),
            "only" | "just" | "should" | "must" | "exactly" | "no" | "one"
        )
    });
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let noun = i > 0 && matches!(look_up(text(&tokens[i - 1])), Some(Sense::Noun(..)));
        let next = tokens.get(i + 1).is_none_or(|n| {
            n.kind != TokenKind::Word
                || matches!(
                    text(n),
                    "on" | "in" | "at" | "there" | "here" | "standing" | "please"
                )
        });
        let be = tokens[..i]
            .iter()
            .any(|t| matches!(text(t), "be" | "have" | "want" | "need" | "is" | "are" | "only"));
        if !(text(t) == "left" && noun && next && few && be) {
            out.push(t.clone());
        }
    }
    out
}

/// "by another 10 metres": by 10 metres.
fn another_so_far(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let more = matches!(text(t), "another" | "further" | "extra")
            && tokens.get(i + 1).is_some_and(|n| number(n).is_some())
            && is_unit(tokens.get(i + 2));
        if !more {
            out.push(t.clone());
        }
    }
    out
}

/// "forward to thirty metres": so far away, not by so much.
fn to_so_far(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let way = is(
            tokens.get(i),
            &[
                "forward",
                "forwards",
                "back",
                "backwards",
                "out",
                "up",
                "on",
                "ahead",
                "away",
                "in",
                "down",
            ],
        );
        let to = is(tokens.get(i + 1), &["to"])
            && tokens.get(i + 2).is_some_and(|t| number(t).is_some())
            && is_unit(tokens.get(i + 3));
        if way
            && to
            && !tokens[i + 4..]
                .iter()
                .take(2)
                .any(|t| is(Some(t), &["left", "right"]))
        {
            out.extend(led("at a distance of", &tokens[i], &[&tokens[i + 2..i + 4]]));
            i += 4;
        } else {
            out.push(tokens[i].clone());
            i += 1;
        }
    }
    out
}

/// The command that a participle or another form of a verb stands for: "removed", "swapped".
fn command(t: &Token) -> Option<String> {
    if let Some(c) = command_of(text(t)) {
        return Some(c.to_string());
    }
    (matches!(text(t), "put") && is_verb(t)).then(|| text(t).to_string())
}

/// "have the taxi replaced by a bus", "I'd like every bus removed, the motorcycle kept, and a lorry put behind us".
fn caused(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, mood) = unwrapped(&tokens);
    if is(tokens.first(), &["let", "lets"]) {
        return tokens;
    }
    let lead = is(inner.first(), &["have", "get", "see", "want"])
        || leads(inner, &["to have", "to see", "to get"]).is_some();
    let from = match (lead, mood.caused) {
        (true, _) => leads(inner, &["to have", "to see", "to get"]).unwrap_or(1),
        (false, true) => 0,
        _ => return tokens,
    };
    // the parts of a list
    let body = &inner[from..];
    let mut parts: Vec<&[Token]> = Vec::new();
    let mut start = 0;
    for i in 0..=body.len() {
        let link = body
            .get(i)
            .is_none_or(|t| t.kind == TokenKind::Comma || text(t) == "and");
        if link {
            let part = trimmed(&body[start.min(i)..i]);
            let whole = participle(part).is_some();
            let next = trimmed(&body[i.min(body.len())..]);
            // "and a cyclist" belongs to what is before, unless it has a participle of its own
            let parted = i == body.len() || next.is_empty() || whole && starts_part(next);
            if parted && !part.is_empty() {
                parts.push(part);
                start = i + 1;
            }
        }
    }
    let mut out: Vec<Token> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let Some((at, verb)) = participle(part) else {
            if k == 0 {
                return tokens;
            }
            // a command of its own follows
            out.push(word("and", &part[0]));
            out.extend_from_slice(part);
            continue;
        };
        if k > 0 {
            out.push(word("and", &part[0]));
        }
        let rest = trimmed(&part[at + 1..]);
        if matches!(verb.as_str(), "keep" | "leave" | "retain" | "preserve") && parts.len() > 1 {
            let stays = led("as it is", &part[at], &[]);
            out.extend(led("leave", &part[at], &[&part[..at], &stays]));
            continue;
        }
        out.extend(led(&verb, &part[at], &[&part[..at], rest]));
    }
    if out.is_empty() { tokens } else { out }
}

/// "let it be dawn, and have the motorcycle replaced by a bicycle": the second half.
fn caused_later(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|k| {
        is(tokens.get(*k), &["have", "get"])
            && is(tokens.get(k - 1), &["and", "then", "to", "also", "please"])
            && is(
                tokens.get(k + 1),
                &["the", "all", "both", "every", "my", "one", "that", "these"],
            )
    });
    let Some(k) = found else {
        return tokens;
    };
    let tail = tokens[k..].to_vec();
    let new = caused(tail.clone());
    if new == tail {
        return tokens;
    }
    let before = if is(tokens.get(k - 1), &["to"]) { k - 1 } else { k };
    [&tokens[..before], &new[..]].concat()
}

/// "we need three barriers in our lane, not just one": exactly three there.
fn so_many_not(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["not", "instead of", "rather than", "and not"]).filter(|x| x.0 > 2)
    else {
        return tokens;
    };
    let from = i + n + usize::from(is(tokens.get(i + n), &["only", "just", "the"]));
    let closes = tokens.get(from).is_some_and(|t| number(t).is_some())
        && tokens.get(from + 1).is_none_or(|t| t.kind != TokenKind::Word);
    let before = trimmed(&tokens[..i]);
    let (inner, _) = unwrapped(before);
    let counted = inner.first().is_some_and(|t| number(t).is_some());
    let placed = first_noun(inner)
        .is_some_and(|x| x.0 < 4 && is_place(&inner[x.1..]) && talk.fits(&inner[x.0..x.1]) > 0);
    if !(closes && counted && placed) {
        return tokens;
    }
    led("keep exactly", &tokens[0], &[inner, &tokens[from + 1..]])
}

/// True if "the motorcycle kept" or a command begins here.
fn starts_part(tokens: &[Token]) -> bool {
    let end = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma || text(t) == "and")
        .unwrap_or(tokens.len());
    participle(&tokens[..end]).is_some()
        || is_verb(&tokens[0]) && !is_place(tokens)
        || is(tokens.first(), &["have", "let", "add"])
}

/// Where the participle of "the taxi behind us replaced by a bus" stands, and its command.
fn participle(part: &[Token]) -> Option<(usize, String)> {
    let known = is(
        part.first(),
        &[
            "the", "a", "an", "all", "both", "every", "each", "another", "my", "these", "those", "one",
        ],
    ) || part.first().is_some_and(|t| number(t).is_some());
    let (_, noun) = first_noun(part).filter(|n| n.0 < 5 && known)?;
    let stop = |t: &Token| matches!(text(t), "that" | "which" | "who" | "is" | "are" | "should");
    let at = (noun..part.len()).take_while(|k| !stop(&part[*k])).find(|k| {
        let word = text(&part[*k]);
        let describes = matches!(look_up(word), Some(Sense::State(..)))
            || matches!(word, "parked" | "marked" | "left" | "stopped" | "placed");
        command(&part[*k]).is_some() && !describes
    })?;
    Some((at, command(&part[at])?))
}

/// "let a car be added that waits at the zebra": add a car that waits there.
fn let_be(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, _) = unwrapped(&tokens);
    let from = usize::from(is(
        inner.first(),
        &["let", "may", "shall", "should", "could", "can"],
    ));
    let body = &inner[from..];
    let fresh = is(body.first(), &["a", "an", "another", "one", "some"])
        || body.first().is_some_and(|t| number(t).is_some());
    // "let two children be with the pedestrian": two more
    let be = body.iter().position(|t| text(t) == "be");
    if let (1, true, Some(k)) = (from, fresh, be)
        && is(inner.first(), &["let"])
        && first_noun(&body[..k]).is_some_and(|x| x.1 == k)
        && (is_place(&body[k + 1..]) || is(body.get(k + 1), &["with"]))
    {
        let with = is(body.get(k + 1), &["with"]);
        let rest = &body[k + 1 + usize::from(with)..];
        let near = if with {
            led("next to", &body[0], &[rest])
        } else {
            rest.to_vec()
        };
        return led("add", &body[0], &[&body[..k], &near]);
    }
    // "let two taxis come instead"
    let comes = find(
        body,
        &["come", "appear", "be there", "come in", "stand there", "turn up"],
    )
    .filter(|(k, n)| k + n == body.len() && tokens.iter().any(|t| text(t) == "instead"));
    if let (1, true, Some((k, n))) = (from, fresh, comes)
        && first_noun(&body[..k]).is_some_and(|x| x.1 == k)
    {
        let place = led("in its place", &body[k], &[&body[k + n..]]);
        return led("put", &body[0], &[&body[..k], &place]);
    }
    let Some((i, n)) = find(
        body,
        &[
            "be added",
            "be put in",
            "be inserted",
            "to be added",
            "be placed",
            "be put",
        ],
    ) else {
        return tokens;
    };
    let short = first_noun(&body[..i]).is_some_and(|x| x.1 == i);
    if !(fresh && short) {
        return tokens;
    }
    let mut out = led("add", &body[0], &[&body[..i], &body[i + n..]]);
    // "have the lorry removed" may follow
    if let Some(k) =
        (2..out.len()).find(|k| is(out.get(*k), &["and"]) && is(out.get(k + 1), &["have", "get"]))
    {
        let rest = caused(out[k + 1..].to_vec());
        out.truncate(k + 1);
        out.extend(rest);
    }
    out
}

/// "across the road, on the right, park a truck": the imperative first.
fn place_first(tokens: Vec<Token>) -> Vec<Token> {
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
                    || tokens[*i].kind == TokenKind::Comma && !is_place(&tokens[i + 1..k])
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

/// "a parked lorry replaces the bus": replace the bus with it.
fn takes_over(tokens: Vec<Token>) -> Vec<Token> {
    let fresh = is(tokens.first(), &["a", "an", "another", "one"])
        || tokens.first().is_some_and(|t| number(t).is_some());
    let found = find(
        &tokens,
        &[
            "replaces",
            "replace",
            "takes over from",
            "stands in for",
            "substitutes for",
            "supersedes",
            "will replace",
            "should replace",
            "is to replace",
            "takes the place of",
            "take the place of",
            "is there instead of",
            "comes instead of",
            "stands there instead of",
            "comes in the place of",
            "is put in place of",
            "ousts",
        ],
    );
    let Some((i, n)) = found.filter(|(i, _)| fresh && first_noun(&tokens[..*i]).is_some_and(|x| x.1 <= *i))
    else {
        return tokens;
    };
    let old = &tokens[i + n..];
    let known = is(
        old.first(),
        &["the", "my", "that", "this", "both", "all", "one", "every"],
    );
    if !known || !has_noun(old) {
        return tokens;
    }
    let end = old
        .iter()
        .position(|t| t.kind == TokenKind::Comma)
        .unwrap_or(old.len());
    let with = led("with", &tokens[0], &[&tokens[..i]]);
    led("replace", &tokens[0], &[&old[..end], &with, &old[end..]])
}

/// "cyclist: delete", "second car: turn into a bus", "cars: 3", "truck: none", "pedestrians: add a third one".
fn topic(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens
        .iter()
        .take(9)
        .position(|t| text(t) == ":")
        .filter(|c| *c > 0)
    else {
        return tokens;
    };
    let np = &tokens[..colon];
    let rest = trimmed(&tokens[colon + 1..]);
    let Some((_, end)) = first_noun(np) else {
        return tokens;
    };
    let noun = {
        let (a, b) = first_noun(np).unwrap_or((0, end));
        &np[a..b]
    };
    let plain_np = !np.iter().any(is_verb_word) && !np.iter().any(|t| t.kind != TokenKind::Word);
    let Some(first) = rest.first().filter(|_| plain_np) else {
        return tokens;
    };
    let the: Vec<Token> =
        if is(np.first(), &["the", "a", "an", "all", "both", "my"]) || number(&np[0]).is_some() {
            np.to_vec()
        } else {
            led("the", &np[0], &[np])
        };
    if talk.fits(np) == 0 {
        return tokens;
    }
    let ends = rest.len() == 1;
    if ends && is(Some(first), &["none", "gone", "out", "away", "nil", "off", "0"])
        || ends && number(first) == Some(0)
    {
        return led("remove all", &tokens[0], &[&the]);
    }
    if ends && number(first).is_some() {
        return led("keep exactly", &tokens[0], &[&rest[..1], np]);
    }
    if number(first).is_some() && is(rest.get(1), &["fewer", "less"]) {
        return [&rest[..1], noun, &rest[1..]].concat();
    }
    if number(first).is_some() && is(rest.get(1), &["more"]) && rest.len() == 2 {
        return led("add", &tokens[0], &[&rest[..2], noun]);
    }
    // "add a third one, also on the zebra"
    if let Some(n) = leads(
        rest,
        &[
            "add a second one",
            "add a third one",
            "add a fourth one",
            "add a fifth one",
            "add another one",
            "add another",
            "add one more",
            "one more",
            "another one",
            "add one",
            "a second one",
            "a third one",
        ],
    ) {
        let mut more = rest[n..].to_vec();
        more.retain(|t| t.kind != TokenKind::Comma && !matches!(text(t), "also" | "too"));
        let one = singular_of(noun);
        return led("add one more", &tokens[0], &[&one, &more]);
    }
    let pronoun = rest
        .iter()
        .position(|t| matches!(text(t), "it" | "them" | "him" | "her"));
    if is_verb(first) {
        return match pronoun.filter(|p| *p < 4) {
            Some(p) => [&rest[..p], &the[..], &rest[p + 1..]].concat(),
            None if !has_noun(rest) || is(rest.get(1), &["into", "to", "by", "with"]) => {
                [&rest[..1], &the[..], &rest[1..]].concat()
            }
            None => tokens,
        };
    }
    if is_place(rest) && !is(Some(first), &["left", "right", "up", "down"]) {
        return led("move", &tokens[0], &[&the, rest]);
    }
    tokens
}

fn is_verb_word(t: &Token) -> bool {
    is_verb(t)
        && !matches!(
            look_up(text(t)),
            Some(Sense::Noun(..) | Sense::State(..) | Sense::Article(_))
        )
        || matches!(text(t), "is" | "are" | "should" | "there")
}

fn singular_of(noun: &[Token]) -> Vec<Token> {
    let mut out = noun.to_vec();
    if let Some(last) = out.last_mut()
        && let Some(Sense::Noun(n, true)) = look_up(&last.text)
    {
        let one = last.text.strip_suffix('s').filter(|w| look_up(w).is_some());
        last.text = one.map_or_else(|| n.classes[0].label(), str::to_string);
    }
    out
}

/// "of the parked cars keep only one, and ...": the group after the verb, if more follows.
fn of_group(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "of the",
            "of these",
            "of those",
            "of my",
            "out of the",
            "from the",
            "among the",
        ],
    ) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &tokens[n..n + b];
    let k = n + b + usize::from(tokens.get(n + b).is_some_and(|t| t.kind == TokenKind::Comma));
    let keeps = is(tokens.get(k), &["keep", "leave", "retain", "spare"]);
    let takes = is(
        tokens.get(k),
        &["remove", "delete", "take", "erase", "drop", "scrap"],
    );
    let m = k + 1 + usize::from(is(tokens.get(k + 1), &["only", "just"]));
    let (Some(many), true) = (tokens.get(m).filter(|t| number(t).is_some()), keeps || takes) else {
        return tokens;
    };
    let end = m + 1 + usize::from(is(tokens.get(m + 1), &["away", "out", "there"]));
    if tokens.get(end).is_none() {
        return tokens;
    }
    let verb = if keeps { "keep exactly" } else { "remove any" };
    led(
        verb,
        &tokens[0],
        &[std::slice::from_ref(many), np, &tokens[end..]],
    )
}

/// "turn one of the workers into a cyclist and the car into a motorcycle": the verb again.
fn gapped(tokens: Vec<Token>) -> Vec<Token> {
    let (inner, _) = unwrapped(&tokens);
    let Some(verb) = inner.first().filter(|t| {
        is(
            Some(t),
            &[
                "turn",
                "change",
                "convert",
                "transform",
                "make",
                "replace",
                "swap",
                "exchange",
                "substitute",
            ],
        )
    }) else {
        return tokens;
    };
    let link: &[&str] = if is(Some(verb), &["replace", "swap", "exchange", "substitute"]) {
        &["with", "by", "for"]
    } else {
        &["into", "to"]
    };
    let Some(first) = (1..inner.len()).find(|k| is(inner.get(*k), link)) else {
        return tokens;
    };
    let second = (first + 2..inner.len()).find(|k| {
        is(inner.get(*k), &["and"])
            && is(inner.get(k + 1), &["the", "both", "all", "my", "one", "that"])
            && (k + 3..inner.len().min(k + 9)).any(|j| is(inner.get(j), link))
            && !inner[k + 1..].iter().take(6).any(|t| t.kind == TokenKind::Comma)
    });
    let Some(and) = second else {
        return tokens;
    };
    let mut out = inner[..=and].to_vec();
    out.push(verb.clone());
    out.extend_from_slice(&inner[and + 1..]);
    out
}

/// "to the other pavement", "to the other side of the road": the side where it is not.
fn other_strip(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
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
                    "crosses",
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

/// "bus behind ego instead, 15 m": what is there is moved.
fn instead(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = tokens
        .iter()
        .position(|t| text(t) == "instead")
        .filter(|i| *i > 1)
    else {
        return tokens;
    };
    let (Some((a, b)), false) = (first_noun(&tokens), is(tokens.get(i + 1), &["of"])) else {
        return tokens;
    };
    let bare = tokens[..a]
        .iter()
        .all(|t| matches!(look_up(text(t)), Some(Sense::State(..) | Sense::Color(_))));
    if !bare || b > i || !is_place(&tokens[b..]) || talk.fits(&tokens[..b]) != 1 || has_noun(&tokens[b..i]) {
        return tokens;
    }
    let mut rest = [&tokens[b..i], &tokens[i + 1..]].concat();
    rest.retain(|t| t.kind != TokenKind::Comma);
    led("move the", &tokens[0], &[&tokens[..b], &rest])
}

/// "put one cone behind each of the parked cars": as many as there are cars.
fn for_each(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !tokens.first().is_some_and(is_verb) {
        return tokens;
    }
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "each of the",
                "each one of the",
                "every one of the",
                "each of these",
                "each of those",
                "each",
                "every",
            ],
        )?;
        let led = is(
            tokens.get(i - 1),
            &[
                "behind", "of", "beside", "to", "near", "before", "by", "after", "ahead",
            ],
        ) && !is(tokens.get(i - 1), &["for"]);
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
        led.then_some((i, n, b))
    });
    let Some((i, n, b)) = found else {
        return tokens;
    };
    let many = talk.fits(&tokens[i + n..i + n + b]);
    let Some(one) = (1..i)
        .find(|k| is(tokens.get(*k), &["a", "an", "one", "another"]))
        .filter(|k| *k < 3)
    else {
        return tokens;
    };
    if many < 2 {
        return tokens;
    }
    let mut out = tokens[..one].to_vec();
    out.push(Token {
        kind: TokenKind::Number(many as f64),
        text: many.to_string(),
        span: tokens[one].span,
    });
    out.extend_from_slice(&tokens[one + 1..i]);
    out.extend(led(&format!("the {many}"), &tokens[i], &[]).into_iter().map(
        |t| match t.text.parse::<f64>() {
            Ok(v) => Token {
                kind: TokenKind::Number(v),
                ..t
            },
            Err(_) => t,
        },
    ));
    let noun = &tokens[i + n..i + n + b];
    let mut many_noun = noun.to_vec();
    if let Some(last) = many_noun.last_mut()
        && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
    {
        last.text = super::super::lexicon::plural(&last.text);
    }
    out.extend(many_noun);
    out.extend_from_slice(&tokens[i + n + b..]);
    out
}

/// "1 worker to the ego lane": so many of those that are there go.
fn sent(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // "buses to the left lane"
    if let Some((0, b)) = first_noun(&tokens)
        && super::words::is_goal(&tokens[b..])
        && !is_verb(&tokens[0])
        && talk.fits(&tokens[..b]) > 0
    {
        return led("move the", &tokens[0], &[&tokens]);
    }
    let counted = tokens.first().is_some_and(|t| number(t).is_some());
    let Some((a, b)) = first_noun(&tokens).filter(|n| counted && n.0 < 4) else {
        return tokens;
    };
    let to = is(tokens.get(b), &["to", "onto", "into"]) && super::words::is_goal(&tokens[b..]);
    let many = number(&tokens[0]).unwrap_or(0).max(0) as usize;
    let found = talk.fits(&tokens[1..b]);
    if !to || a < 1 || found < many || many == 0 {
        return tokens;
    }
    let lead = if found > many { "move any" } else { "move the" };
    led(lead, &tokens[0], &[&tokens])
}

/// "three trucks should be coming towards us, not cars": in the place of those.
fn not_those(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &["not", "and not", "but not", "instead of", "rather than"],
    )
    .filter(|x| x.0 > 2) else {
        return tokens;
    };
    let old = &tokens[i + n..];
    let counted = tokens
        .first()
        .is_some_and(|t| number(t).is_some() || matches!(text(t), "a" | "an"));
    let (Some((a, b)), Some((c, d))) = (first_noun(&tokens[..i]).filter(|x| x.0 < 4), first_noun(old)) else {
        return tokens;
    };
    let plain = c == 0 && matches!(look_up(text(&old[d - 1])), Some(Sense::Noun(_, true)));
    let closes = old
        .get(d)
        .is_none_or(|t| t.kind != TokenKind::Word || text(t) == "and");
    let same = tokens[a..b].iter().map(text).eq(old[c..d].iter().map(text));
    let said = &tokens[b..i];
    let helper = said.iter().any(|t| {
        matches!(
            text(t),
            "should" | "must" | "shall" | "are" | "is" | "be" | "ought"
        )
    });
    if !(counted && plain && closes && !same && helper) || talk.fits(&old[..d]) == 0 {
        return tokens;
    }
    let mut out = led("remove all the", &tokens[0], &[&old[..d]]);
    out.push(word("and", &tokens[0]));
    out.extend(led("add", &tokens[0], &[&tokens[..b]]));
    out.extend(
        trimmed(said)
            .iter()
            .filter(|t| {
                !matches!(
                    text(t),
                    "should" | "must" | "shall" | "are" | "is" | "be" | "ought" | "to"
                )
            })
            .cloned(),
    );
    out.extend_from_slice(&old[d..]);
    out
}
