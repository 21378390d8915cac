//! Which of a group that is named first or afterwards: "the farthest of the three cars", "of the two cars, delete the one that
//! is nearer", "of the motor vehicles only the one behind us remains".

use super::super::foremost::ordinal;
use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::some_of::bare_np;
use super::topics::singular_of;
use super::words::{find, first_noun, is, is_place, leads, led, number, text, trimmed};
use crate::scene::Class;
use std::collections::BTreeMap;

const PICKS: &[&str] = &[
    "nearest",
    "closest",
    "nearer",
    "closer",
    "farthest",
    "furthest",
    "farther",
    "further",
    "most distant",
    "more distant",
    "remotest",
    "middle",
    "central",
    "leftmost",
    "rightmost",
    "foremost",
    "frontmost",
    "rearmost",
    "hindmost",
    "biggest",
    "largest",
    "smallest",
    "oncoming",
];
const GROUPS: &[&str] = &[
    "of the",
    "of these",
    "of those",
    "of my",
    "of our",
    "of all the",
    "of all",
];
const STAYS: &[&str] = &["remain", "remains", "stay", "stays", "survive", "survives"];

/// The sentence with such a choice as one noun phrase.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = pick_of(only_of(tokens));
    let out = pick_of_them(out, talk);
    let out = only_the_one(out);
    group_first(out)
}

/// "the middle one of the three": of the three cars, if nothing else is there three times.
pub(super) fn of_the_group(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let first = first_noun(&tokens).map_or(tokens.len(), |n| n.0);
    // the words for one of a group from here: how many tokens, and how many it has, if that is said
    let one_of = |i: usize| {
        let picks = i + pick_at(&tokens[i..]).filter(|_| is(tokens.get(i.wrapping_sub(1)), &["the"]))?;
        let one = picks + usize::from(is(tokens.get(picks), &["one"]));
        let of = leads(&tokens[one..], GROUPS).unwrap_or(0);
        let many = (of > 0).then(|| tokens.get(one + of).and_then(number)).flatten();
        let end = one + many.map_or(0, |_| of + 1);
        let described = |t: &Token| {
            matches!(
                look_up(text(t)),
                Some(Sense::State(_, false) | Sense::Color(_) | Sense::Size(_))
            ) || is(Some(t), &["oncoming", "approaching", "waiting", "moving"])
        };
        let noun = tokens[end..].iter().take_while(|t| described(t)).count() + end;
        let named = super::words::noun_at(&tokens[noun..]).is_some();
        (end > picks && !named && (of == 0 || many.is_some())).then_some((picks, end, many))
    };
    let Some((_, _, many)) = (1..first).find_map(one_of) else {
        return tokens;
    };
    let mut counts: BTreeMap<Class, i64> = BTreeMap::new();
    for b in talk.boxes.values() {
        *counts.entry(b.class).or_default() += 1;
    }
    counts.retain(|_, n| many.map_or(*n > 1, |m| *n == m));
    let last = counts
        .keys()
        .find(|c| talk.last.as_deref() == Some(c.label().as_str()));
    let class = match (last, counts.len()) {
        (Some(c), _) => *c,
        (None, 1) if talk.last.is_none() => *counts.keys().next().unwrap_or(&Class::Car),
        _ => return tokens,
    };
    rewritten(&tokens, |i, out| {
        let (picks, end, _) = one_of(i)?;
        out.extend_from_slice(&tokens[i..picks]);
        out.extend(led(&class.label(), &tokens[i], &[]));
        Some(end)
    })
}

/// "let both of them walk there" where nothing was named: the two that there are of one kind.
pub(super) fn both_of_them(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["both of them", "the two of them", "the pair of them"]) else {
        return tokens;
    };
    let mut counts: BTreeMap<Class, i64> = BTreeMap::new();
    for b in talk.boxes.values() {
        *counts.entry(b.class).or_default() += 1;
    }
    let mut two = counts.iter().filter(|(_, n)| **n == 2).map(|(c, _)| *c);
    match (two.next(), two.next()) {
        (Some(class), None) if talk.last.is_none() && first_noun(&tokens[..i]).is_none() => {
            let both = led("both", &tokens[i], &[]);
            let noun = led(&super::super::lexicon::plural(&class.label()), &tokens[i], &[]);
            [&tokens[..i], &both, &noun, &tokens[i + n..]].concat()
        }
        _ => tokens,
    }
}

/// "the front truck", "rear lorry": of several, the one ahead of us or behind us, else the first or last of them.
pub(super) fn front_and_rear(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let lead = is(tokens.get(i), &["lead", "preceding"]);
        let front = lead || is(tokens.get(i), &["front", "leading"]);
        let rear = is(tokens.get(i), &["rear", "back", "hind"]);
        let opens = out.last().is_none_or(|t| {
            t.kind != TokenKind::Word
                || is(Some(t), &["the", "that", "and", "but", "my", "our"])
                || super::super::rephrase::is_verb(t) && front && !lead
        });
        if !opens || !(front || rear) {
            return None;
        }
        // ("rear one a bus": of the kind named before)
        let before = first_noun(out).map(|n| out[n.0..n.1].to_vec());
        let one = is(tokens.get(i + 1), &["one"]);
        let (noun, end) = match (before, one) {
            (Some(noun), true) => (noun, i + 2),
            _ => {
                let (_, b) = first_noun(&tokens[i + 1..]).filter(|n| n.0 == 0)?;
                (tokens[i + 1..i + 1 + b].to_vec(), i + 1 + b)
            }
        };
        let at = &tokens[i];
        let many = matches!(
            super::look_up(text(noun.last()?)),
            Some(super::Sense::Noun(_, true))
        );
        // ("the lead truck" is the truck, if there is but one)
        if lead && !many && is(out.last(), &["the", "that", "my", "our"]) && talk.fits(&noun) == 1 {
            out.extend(noun);
            return Some(end);
        }
        if many || talk.fits(&noun) < 2 {
            return None;
        }
        // ("rear truck 30 m behind me")
        let opens = out.iter().all(|t| is(Some(t), &["the"]));
        if opens && is_place(&tokens[end..]) && number(&tokens[end]).is_some() {
            out.clear();
            out.extend(led("move", at, &[]));
        }
        if lead && is(out.last(), &["my", "our"]) {
            out.pop();
        }
        if !is(out.last(), &["the", "that", "my"]) {
            out.extend(led("the", at, &[]));
        }
        let side = led(if front { "ahead of me" } else { "behind me" }, at, &[]);
        let there = [&noun[..], &side].concat();
        // ("the lead vehicle" drives ahead of us in our lane)
        let in_lane = [&there[..], &led("in my lane", at, &[])].concat();
        if lead && talk.fits(&in_lane) == 1 {
            out.extend(in_lane);
        } else if talk.fits(&there) == 1 {
            out.extend(there);
        } else {
            out.extend(led(if front { "frontmost" } else { "rearmost" }, at, &[&noun]));
        }
        Some(end)
    })
}

/// How many tokens a word takes that picks one: an ordinal, too.
fn pick_at(tokens: &[Token]) -> Option<usize> {
    leads(tokens, PICKS).or_else(|| ordinal(text(tokens.first()?)).map(|_| 1))
}

/// One past the number that a group may have: "the three cars".
fn counted(tokens: &[Token], at: usize) -> usize {
    let many = tokens
        .get(at)
        .is_some_and(|t| number(t).is_some() || matches!(text(t), "both"));
    at + usize::from(many)
}

/// A word that picks one only before "one": "the left one of the two", not "to the left of the two".
fn side_at(tokens: &[Token]) -> Option<usize> {
    const SIDES: &[&str] = &["left hand", "right hand", "left", "right"];
    leads(tokens, SIDES).filter(|n| is(tokens.get(*n), &["one"]))
}

/// "only the right one of the two parked cars remains": of the two parked cars only the right one remains.
fn only_of(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["only the", "just the"]) else {
        return tokens;
    };
    let Some(pick) = pick_at(&tokens[n..]).or_else(|| side_at(&tokens[n..])) else {
        return tokens;
    };
    let one = n + pick + usize::from(is(tokens.get(n + pick), &["one"]));
    let Some(_) = leads(&tokens[one..], GROUPS) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[one..]).filter(|x| x.0 < 6) else {
        return tokens;
    };
    let end = one + b;
    let late = &tokens[end..];
    let stays = late
        .iter()
        .any(|t| STAYS.contains(&text(t)) || is(Some(t), &["left", "kept"]));
    if !stays || super::words::has_noun(late) {
        return tokens;
    }
    [&tokens[one..end], &tokens[..one], late].concat()
}

/// "the parked car from the left roadside has driven away": the one that stands there.
pub(super) fn from_there(mut tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    for i in 2..tokens.len() {
        let side = is(tokens.get(i), &["from"])
            && is(tokens.get(i + 1), &["the", "our", "my"])
            && is(
                tokens.get(i + 2),
                &[
                    "left", "right", "oncoming", "opposite", "crossing", "zebra", "sidewalk", "pavement",
                    "other",
                ],
            );
        if !side {
            continue;
        }
        let n = match super::words::longest(&tokens[i + 2..]) {
            Some((Sense::Place(..), n)) => n,
            _ if is(tokens.get(i + 3), &["side"]) => 2,
            _ => continue,
        };
        // (who goes from there to elsewhere is told apart by where he goes)
        let goes = is(tokens.get(i + 2 + n), &["to", "onto", "into", "over", "across"]);
        let Some((a, b)) = first_noun(&tokens[..i]).filter(|x| x.1 == i) else {
            continue;
        };
        let the = a > 0 && is(tokens.get(a - 1), &["the", "that", "parked"]);
        let lane = tokens[i..i + 2 + n].iter().any(|t| text(t) == "lane");
        let on = if lane { "in" } else { "on" };
        let np = [&tokens[a..b], &led(on, &tokens[i], &[&tokens[i + 1..i + 2 + n]])].concat();
        let moves = is(tokens.first(), &["move", "shift", "take", "bring"]) && !goes;
        if the && !goes && !moves && talk.fits(&np) == 1 {
            tokens[i].text = on.into();
        }
    }
    put_from(tokens, talk)
}

/// "put the pedestrian on the left sidewalk on the road": the one there goes to the road.
fn put_from(mut tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(tokens.first(), &["put", "place", "set", "stand", "park"]) || !is(tokens.get(1), &["the", "that"])
    {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens[1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let from = 1 + b;
    let on = |k: usize| is(tokens.get(k), &["on", "in"]) && is(tokens.get(k + 1), &["the", "our", "my"]);
    let goal = (from + 3..tokens.len()).find(|k| on(*k));
    if let Some(goal) = goal.filter(|k| {
        on(from)
            && !is(tokens.get(k - 1), &["of", "and"])
            && talk.fits(&tokens[1..*k]) == 1
            && !tokens[from..*k].iter().any(|t| t.kind != TokenKind::Word)
    }) {
        tokens[0].text = "move".into();
        tokens[goal].text = if is(tokens.get(goal), &["in"]) {
            "into"
        } else {
            "onto"
        }
        .into();
    }
    tokens
}

/// "the farthest of the three parked cars": the farthest parked car.
fn pick_of(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i - 1), &["the", "that"]).then_some(())?;
        let pick = pick_at(&tokens[i..]).or_else(|| side_at(&tokens[i..]))?;
        let mut k = i + pick;
        let many = tokens
            .get(k)
            .filter(|t| number(t).is_some() && text(t) != "one")
            .cloned();
        k += usize::from(many.is_some() || is(tokens.get(k), &["one", "ones"]));
        let of = k + leads(&tokens[k..], GROUPS)?;
        let np = counted(&tokens, of);
        let (_, b) = first_noun(&tokens[np..]).filter(|x| x.0 < 4)?;
        Some((i, pick, many, np, np + b))
    });
    let Some((i, pick, many, np, end)) = found else {
        return tokens;
    };
    let mut out = tokens[..i + pick].to_vec();
    match many {
        Some(many) => {
            out.push(many);
            out.extend_from_slice(&tokens[np..end]);
        }
        None => out.extend(singular_of(&tokens[np..end])),
    }
    out.extend_from_slice(&tokens[end..]);
    out
}

/// "the nearest of them": of what was spoken of last.
fn pick_of_them(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(last) = &talk.last else {
        return tokens;
    };
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i - 1), &["the"]).then_some(())?;
        let k = i + pick_at(&tokens[i..])?;
        let k = k + usize::from(is(tokens.get(k), &["one"]));
        let n = leads(
            &tokens[k..],
            &["of them", "of these", "of those", "of the group", "of the lot"],
        )?;
        (tokens.get(k + n).is_none_or(|t| t.kind != TokenKind::Word) || is_place(&tokens[k + n..]))
            .then_some((i, k, n))
    });
    match found {
        Some((i, k, n)) if first_noun(&tokens[..i]).is_none() => {
            let mut out = tokens[..i].to_vec();
            out.extend(tokens[i..k].iter().filter(|t| text(t) != "one").cloned());
            out.extend(led(last, &tokens[i], &[&tokens[k + n..]]));
            out
        }
        _ => tokens,
    }
}

/// "of the motor vehicles only the one behind us remains": all but that one go.
fn only_the_one(tokens: Vec<Token>) -> Vec<Token> {
    let Some((np, end)) = group(&tokens) else {
        return tokens;
    };
    let rest = trimmed(&tokens[end..]);
    // "only the nearest one should remain"
    let only = leads(rest, &["only the", "just the", "keep only the", "leave only the"]);
    // ("only the blue car stays": its noun is there already)
    if let Some(n) = only
        && rest.get(n).is_some_and(super::super::coloured_ones::is_colour)
        && let Some((0, b)) = rest.get(n + 1..).and_then(first_noun)
        && rest[n + 1 + b..].iter().any(|t| STAYS.contains(&text(t)))
    {
        let all = bare_np(np);
        let except = led("except the", &rest[0], &[&rest[n..n + 1 + b]]);
        return led("remove all the", &tokens[0], &[&all, &except]);
    }
    // ("of the three vehicles only the van may stay")
    if let Some(n) = only
        && let Some((a, b)) = rest.get(n..).and_then(first_noun).filter(|x| x.0 < 3)
        && rest[n..n + a]
            .iter()
            .all(|t| pick_at(std::slice::from_ref(t)).is_none())
        && rest[n + b..].iter().all(|t| t.kind == TokenKind::Word)
        && rest[n + b..].iter().any(|t| STAYS.contains(&text(t)))
    {
        let all = bare_np(np);
        let except = led("except the", &rest[0], &[&rest[n..n + b]]);
        return led("remove all the", &tokens[0], &[&all, &except]);
    }
    if let Some(n) = only
        && let Some(p) = rest.get(n..).and_then(|r| pick_at(r).or_else(|| side_at(r)))
        && (rest[n + p..]
            .iter()
            .any(|t| STAYS.contains(&text(t)) || is(Some(t), &["left", "kept"]))
            || n == 3)
        && first_noun(&rest[n + p..]).is_none_or(|x| x.0 > 1)
    {
        let all = bare_np(np);
        let one = singular_of(&all);
        // (of which one the comparative is said is not known any more)
        let pick = match text(&rest[n]) {
            "nearer" | "closer" => led("nearest", &rest[n], &[]),
            "farther" | "further" => led("farthest", &rest[n], &[]),
            _ => rest[n..n + p]
                .iter()
                .filter(|t| text(t) != "hand")
                .cloned()
                .collect(),
        };
        let except = led("except the", &rest[0], &[&pick, &one]);
        return led("remove all the", &tokens[0], &[&all, &except]);
    }
    let Some(n) = leads(
        rest,
        &[
            "only the one",
            "just the one",
            "only the ones",
            "just the ones",
            "keep only the one",
            "leave only the one",
            "keep only the ones",
            "leave only the ones",
            "keep the one",
            "leave the one",
            "spare the one",
            "spare only the one",
        ],
    ) else {
        return tokens;
    };
    let verb = is(rest.first(), &["keep", "leave", "spare"]);
    let close = rest
        .iter()
        .position(|t| {
            STAYS.contains(&text(t))
                || is(Some(t), &["should", "may", "must", "is", "are", "shall", "can"])
                || t.kind != TokenKind::Word
        })
        .unwrap_or(rest.len());
    let stays = verb
        || rest[close..]
            .iter()
            .any(|t| STAYS.contains(&text(t)) || is(Some(t), &["left", "kept"]));
    let skip = usize::from(is(rest.get(n), &["that", "which", "who"])) * 2;
    let place = rest.get(n + skip..close).unwrap_or(&[]);
    if !stays || !is_place(place) {
        return tokens;
    }
    let all = bare_np(np);
    let one = singular_of(&all);
    led(
        "remove all the",
        &tokens[0],
        &[&all, &led("except the", &rest[0], &[&one, place])],
    )
}

/// "of the two cars,": the group, and one past it.
fn group(tokens: &[Token]) -> Option<(&[Token], usize)> {
    let n = leads(
        tokens,
        &["of", "out of", "from among", "among", "from", "as for", "as to"],
    )?;
    is(tokens.get(n), &["the", "these", "those", "my", "our", "all"]).then_some(())?;
    let (_, b) = first_noun(&tokens[n..]).filter(|x| x.0 < 5)?;
    let end = n + b;
    // ("of the cars in my lane, ...")
    let comma = (end..tokens.len().min(end + 8)).find(|k| tokens[*k].kind == TokenKind::Comma);
    match comma.filter(|c| *c == end || is_place(&tokens[end..])) {
        Some(c) => Some((&tokens[n..c], c + 1)),
        None => Some((&tokens[n..end], end)),
    }
}

/// "of the two cars, delete the one that is nearer to us": the car that is.
fn group_first(tokens: Vec<Token>) -> Vec<Token> {
    let Some((np, end)) = group(&tokens) else {
        return tokens;
    };
    let rest = trimmed(&tokens[end..]);
    let noun = singular_of(&bare_np(np));
    let one = find(rest, &["the one", "the ones"]).filter(|(i, n)| {
        let next = &rest[i + n..];
        is_place(next) || is(next.first(), &["that", "which", "who", "thats", "whos"])
    });
    if let Some((i, n)) = one {
        let the = led("the", &rest[i], &[&noun]);
        return [&rest[..i], &the, &rest[i + n..]].concat();
    }
    let picked = (1..rest.len()).find_map(|i| {
        is(rest.get(i - 1), &["the"]).then_some(())?;
        let k = i + pick_at(&rest[i..]).or_else(|| side_at(&rest[i..]))?;
        let one = usize::from(is(rest.get(k), &["one"]));
        first_noun(&rest[k..]).is_none_or(|x| x.0 > 1).then_some((k, one))
    });
    let Some((k, one)) = picked else {
        return tokens;
    };
    // "the nearest into a van and the farthest into a pickup": each of them
    let mut out = [&rest[..k], &noun[..]].concat();
    let mut rest = rest[k + one..].to_vec();
    let next = (2..rest.len()).find_map(|i| {
        (is(rest.get(i - 1), &["the"]) && is(rest.get(i - 2), &["and", ",", "but"])).then_some(())?;
        let k = i + pick_at(&rest[i..])?;
        let one = usize::from(is(rest.get(k), &["one"]));
        first_noun(&rest[k..]).is_none_or(|x| x.0 > 1).then_some((k, one))
    });
    if let Some((k, one)) = next {
        rest.splice(k..k + one, noun);
    }
    out.extend(rest);
    out
}
