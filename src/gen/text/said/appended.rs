//! What is added to what was just said, and says it more exactly: "one more vehicle, namely a truck", "right behind the bus, that
//! is between it and us", "another bus, this one parked on the left", "he has made it over the road: he stands on the other side".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::told::NAMELY;
use super::super::wording::{begins, replaced, rewritten};
use super::Talk;
use super::words::{first_noun, has_noun, is, is_finite, is_goal, is_place, led, number, text};
use crate::scene::Class;

/// A sentence (without its stop) that says it once.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = services(tokens, talk);
    let out = crossed_once(out);
    let out = this_one(goes_there(off_the_strip(out)));
    counted_last(namely(that_is(coming_after(out))))
}

fn mark(t: &Token) -> bool {
    matches!(t.kind, TokenKind::Comma | TokenKind::Mark)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| mark(t) || is(Some(t), &["and", "too", "please", "now", "then", "but"]))
}

/// The classes that a noun may mean.
fn classes(np: &[Token]) -> Option<&'static [Class]> {
    let words: Vec<&str> = np.iter().map(text).collect();
    match look_up(&words.join(" ")).or_else(|| look_up(words.last()?)) {
        Some(Sense::Noun(n, _)) => Some(n.classes),
        _ => None,
    }
}

/// "the police must be behind us", where a police car is and no officer: it is meant.
fn services(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const SERVICES: &[(&str, &str)] = &[
        ("police", "police car"),
        ("fire brigade|fire department|fire service", "fire engine"),
        ("ambulance service|ambulance crew|paramedics", "ambulance"),
    ];
    rewritten(&tokens, |i, out| {
        let (n, car) = SERVICES
            .iter()
            .find_map(|(said, car)| begins(&tokens[i..], said).map(|n| (n, *car)))
            .filter(|_| is(out.last(), &["the"]))?;
        let own = first_noun(&tokens[i + n..]).is_some_and(|x| x.0 == 0);
        let called = |b: &&crate::scene::SceneBox| b.label.name.as_str().eq_ignore_ascii_case(car);
        let people = talk.boxes.values().any(|b| {
            b.class == Class::Pedestrian
                && super::super::names::is_called(b.label.name.as_str(), "police officer")
        });
        (!own && !people && talk.boxes.values().filter(called).count() == 1).then_some(())?;
        out.extend(led(car, &tokens[i], &[]));
        let next = tokens.get(i + n);
        match next.map(text) {
            Some("are") => out.extend(led("is", &tokens[i], &[])),
            Some("have") => out.extend(led("has", &tokens[i], &[])),
            Some(w) if is_finite(w, true) && !is_finite(w, false) => {
                let s = super::super::words::verbs::forms(w).s;
                out.extend(led(&s, &tokens[i], &[]));
            }
            _ => return Some(i + n),
        }
        Some(i + n + 1)
    })
}

/// "he has made it over the road: the man stands on the opposite sidewalk": where he stands counts, once.
fn crossed_once(tokens: Vec<Token>) -> Vec<Token> {
    const OVER: &str = "made it over|made it across|got over|got across|gone over|gone across|come over|come across|walked over|walked across|run over to|crossed|crossed over|run across|reached the other side of|\
        made it to the other side of|changed sides on|made it over to the other side of";
    const ROAD: &str = "the road|the street|the roadway|the carriageway|the crossing|the zebra crossing|the zebra|the crosswalk";
    const IS: &[&str] = &[
        "is", "are", "stands", "stand", "waits", "wait", "walks", "walk", "now", "was",
    ];
    let he = is(tokens.first(), &["he", "she", "they"]);
    let who = match first_noun(&tokens) {
        _ if he => 1,
        Some((_, b)) if is(tokens.first(), &["the", "that", "both", "all"]) => b,
        _ => return tokens,
    };
    let has = who + usize::from(is(tokens.get(who), &["has", "have"]));
    let now = has + usize::from(is(tokens.get(has), &["just", "now", "already", "safely"]));
    let Some(over) = tokens.get(now..).and_then(|t| begins(t, OVER)).map(|n| now + n) else {
        return tokens;
    };
    let end = over + begins(&tokens[over..], ROAD).unwrap_or(0);
    let end = end + usize::from(is(tokens.get(end), &["now", "safely", "already"]));
    let next = match tokens.get(end) {
        Some(t) if mark(t) => &tokens[end + 1..],
        _ => return tokens,
    };
    let next = if is(next.first(), &["and", "so", "now"]) {
        &next[1..]
    } else {
        next
    };
    let again = is(next.first(), &["he", "she", "they"]);
    let (subject, says) = match first_noun(next) {
        _ if again => (if he { &next[..1] } else { &tokens[..who] }, &next[1..]),
        Some((_, b)) if is(next.first(), &["the", "that", "both", "all"]) && b < 5 => next.split_at(b),
        _ => return tokens,
    };
    if is(says.first(), IS) && (1..says.len().min(4)).any(|k| is_place(&says[k..])) {
        [subject, says].concat()
    } else {
        tokens
    }
}

/// "steps off the kerb onto the road": where somebody comes from is known.
fn off_the_strip(tokens: Vec<Token>) -> Vec<Token> {
    const OFF: &str = "off the|off of the|down from the|down off the|out of the|from off the";
    const STRIP: &str = "sidewalk|pavement|kerb|curb|footpath|footway|walkway|verge|shoulder|roadside|kerbside|edge of the road|side of the road|grass|left sidewalk|right sidewalk|\
        left pavement|right pavement|left kerb|right kerb|kerbstone|kerb stone|left roadside|right roadside";
    rewritten(&tokens, |i, out| {
        let n =
            begins(&tokens[i..], OFF).filter(|_| has_noun(out) || is(out.first(), &["he", "she", "they"]))?;
        let m = begins(&tokens[i + n..], STRIP)?;
        let and = i + n + m + usize::from(is(tokens.get(i + n + m), &["and"]));
        is_goal(tokens.get(and..)?)
            .then_some(())
            .or_else(|| begins(&tokens[and..], "on to the|into the|onto the|in the|on the").map(|_| ()))?;
        Some(and)
    })
}

/// "one more cone, which goes to the left edge": at the left edge.
fn goes_there(tokens: Vec<Token>) -> Vec<Token> {
    const GOES: &str = "which goes|that goes|who goes|it goes|which belongs|that belongs|who belongs|which should go|that should go|who should go|which comes|that comes|which has to go|\
        which is to go|to be put|which must go|this one belongs|which should come|which is to come|which will go";
    let fresh = is(
        tokens.first(),
        &["another", "a", "an", "one", "add", "put", "place"],
    ) || tokens.first().is_some_and(|t| number(t).is_some());
    if !fresh {
        return tokens;
    }
    rewritten(&tokens, |i, out| {
        let comma = usize::from(tokens[i].kind == TokenKind::Comma);
        let n = begins(tokens.get(i + comma..)?, GOES)?;
        let np = first_noun(out).is_some_and(|x| x.0 < 6 && x.1 == out.len());
        let at = i + comma + n;
        // ("that goes to the left" goes there)
        let to = is_goal(&tokens[at..]) || is(tokens.get(at), &["on", "in", "at", "behind", "beside"]);
        (np && to && is_place(&tokens[at..])).then_some(())?;
        if !is(tokens.get(at), &["to", "onto", "into"]) {
            return Some(at);
        }
        let lane = tokens[at..]
            .iter()
            .take(5)
            .any(|t| is(Some(t), &["lane", "junction"]));
        out.extend(led(if lane { "in" } else { "on" }, &tokens[at], &[]));
        Some(at + 1)
    })
}

/// "another bus, this one parked on the left": another bus parked there.
fn this_one(tokens: Vec<Token>) -> Vec<Token> {
    const THIS: &str = "this one is|this one|this time|that one is|that one|the new one is|the new one|the second one is|the second one|this second one|this one being|but this one is|but this one|and this one is|\
        and this one|but this time|this other one|the latter is|the latter";
    rewritten(&tokens, |i, out| {
        (tokens[i].kind == TokenKind::Comma).then_some(())?;
        let n = begins(&tokens[i + 1..], THIS)?;
        let rest = tokens.get(i + 1 + n..)?;
        let new = out.iter().any(|t| {
            is(Some(t), &["another", "more", "further", "additional"])
                || super::super::foremost::ordinal(text(t)).is_some_and(|n| n > 1)
        });
        let state = usize::from(matches!(super::words::longest(rest), Some((Sense::State(..), 1))));
        let np = first_noun(out).is_some_and(|x| x.1 == out.len());
        (new && np && rest.get(state..).is_some_and(is_place)).then_some(i + 1 + n)
    })
}

/// "make a car come along after the cyclists": follow them.
fn coming_after(tokens: Vec<Token>) -> Vec<Token> {
    let out = replaced(
        &tokens,
        "comes along after|comes along behind|comes along following|comes on after|comes after",
        "follows",
    );
    let out = replaced(
        &out,
        "come along after|come along behind|come along following|come on after|come after",
        "follow",
    );
    replaced(
        &out,
        "coming along after|coming along behind|coming on after|coming after",
        "following",
    )
}

/// "right behind the truck, that is between it and us": both hold.
fn that_is(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        (mark(&tokens[i])).then_some(())?;
        let n = begins(&tokens[i + 1..], NAMELY)?;
        let rest = &tokens[i + 1 + n..];
        // ("on our side, that is on the right pavement" corrects: what comes last holds)
        let place = is(rest.first(), &["between"]);
        let whole = rest.iter().all(|t| !mark(t) && !is_verb_of_clause(t));
        (place && whole && out.len() > 2).then_some(())?;
        // whom "it" means there: what the place before names
        let at = (0..out.len()).rev().find(|k| is(out.get(*k), &["the", "that"]))?;
        let (_, b) = first_noun(&out[at..]).unwrap_or((0, 0));
        let anchor = out[at..at + b].to_vec();
        for t in rest {
            if is(Some(t), &["it", "him", "her", "them"]) && !anchor.is_empty() {
                out.extend_from_slice(&anchor);
            } else {
                out.push(t.clone());
            }
        }
        Some(tokens.len())
    })
}

fn is_verb_of_clause(t: &Token) -> bool {
    is(
        Some(t),
        &["is", "are", "should", "must", "has", "have", "stands", "drives"],
    )
}

/// "one more vehicle, namely a truck": one more truck.
fn namely(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], NAMELY)?;
        let np = tokens.get(i + n..)?;
        let article = is(np.first(), &["a", "an"]);
        let many = np.first().and_then(number);
        (article || many.is_some()).then_some(())?;
        let (_, b) = first_noun(np).filter(|x| x.0 < 4)?;
        ends(np.get(b)).then_some(())?;
        (!is(np.get(b), &["and"])).then_some(())?;
        // the wider word that it makes exact
        let (a, e) = first_noun(out)?;
        let fresh = out[..a]
            .iter()
            .any(|t| is(Some(t), &["a", "an", "another", "more", "some", "further"]) || number(t).is_some());
        let (old, new) = (classes(&out[a..e])?, classes(&np[1..b])?);
        let wider = old.len() > new.len() && new.iter().all(|c| old.contains(c))
            || is(
                out.get(e - 1),
                &[
                    "person",
                    "people",
                    "pedestrian",
                    "pedestrians",
                    "somebody",
                    "someone",
                ],
            ) && new == [Class::Pedestrian];
        (fresh && wider).then_some(())?;
        while out.last().is_some_and(mark) {
            out.pop();
        }
        out.splice(a..e, np[1..b].iter().cloned());
        let late = np.get(b).is_some_and(mark) && np.get(b + 1..).is_some_and(is_place);
        Some(i + n + b + usize::from(late))
    })
}

/// "a motorcycle escort rides in front: two bikes": so many of them.
fn counted_last(tokens: Vec<Token>) -> Vec<Token> {
    let escort = rewritten(&tokens, |i, out| {
        let led_by = is(tokens.get(i), &["escort"])
            && out
                .last()
                .is_some_and(|t| classes(std::slice::from_ref(t)).is_some());
        led_by.then_some(i + 1)
    });
    let Some(at) = (2..escort.len())
        .rev()
        .take(4)
        .find(|k| text(&escort[*k]) == ":" || escort[*k].kind == TokenKind::Mark)
    else {
        return escort;
    };
    let tail = &escort[at + 1..];
    let just = usize::from(is(tail.first(), &["just", "only"]));
    let Some(many) = tail.get(just).and_then(number).filter(|n| (1..10).contains(n)) else {
        return escort;
    };
    let head = &escort[..at];
    let single = is(head.first(), &["a", "an"]);
    let alike = match (first_noun(head), first_noun(&tail[just + 1..])) {
        (Some((a, b)), Some((0, e))) if e + just + 1 == tail.len() && a < 4 => {
            let (one, two) = (classes(&head[a..b]), classes(&tail[just + 1..]));
            let bikes = is(tail.last(), &["bike", "bikes"])
                && one.is_some_and(|c| c == [Class::Motorcycle] || c == [Class::Bicycle]);
            (bikes || one.is_some() && one == two).then_some(b)
        }
        _ => None,
    };
    match alike {
        Some(_) if single && many == 1 => head.to_vec(),
        Some(b) if single => {
            let mut out = head.to_vec();
            out[0] = tail[just].clone();
            let last = super::super::lexicon::plural(text(&out[b - 1]));
            out[b - 1].text = last;
            out
        }
        _ => escort,
    }
}
