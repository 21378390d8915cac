//! Notes without a verb that send those who are there somewhere: "ambulance over to the right edge, parked", "front truck to thirty
//! metres, rear one also to thirty", "bus to 30 m, and both workers go with it".

use super::super::holds::role_of;
use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::{HELPERS, MATES};
use super::words::{
    first_noun, has_noun, is, is_finite, is_place, is_unit, leads, led, number, text, trimmed, word,
};
use crate::scene::graph::LaneRole as L;

const TO: &[&str] = &[
    "to",
    "onto",
    "into",
    "over to",
    "over into",
    "over onto",
    "across to",
    "up to",
    "back to",
    "out to",
    "down to",
    "back into",
    "back onto",
];
const ALSO: &[&str] = &[
    "also", "too", "likewise", "as well", "equally", "then", "now", "again",
];
const STRIPS: &[&str] = &[
    "edge", "kerb", "curb", "roadside", "shoulder", "verge", "side", "park", "lot", "bay", "space",
];

/// A sentence (without its stop) with its verbs.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = all_of_them(their_own(same_strip(tokens, talk)));
    let out = go_along(some_over(out, talk), talk);
    sent(out, talk)
}

/// "two of the people over on the left sidewalk": so many of them go there.
fn some_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const OF: &[&str] = &["of the", "of them", "of those", "of our", "of these"];
    let body = trimmed(&tokens);
    let wish = leads(body, WISHES).unwrap_or(0);
    let body = &body[wish..];
    let some = body
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["half", "some"]));
    let of = some.then(|| leads(&body[1..], OF)).flatten();
    let Some((of, (a, b))) = of.and_then(|n| Some((n, first_noun(&body[1 + n..])?))) else {
        return tokens;
    };
    let end = 1 + of + b;
    let place = &body[end..];
    let over = leads(place, &["over there", "over", "across", "instead", "now"]).unwrap_or(0);
    let place = &place[over..];
    let onto = is(place.first(), &["on", "onto", "to", "in", "into", "at"]);
    if a > 2
        || !onto
        || !is_place(place)
        || has_noun(place)
        || place.iter().any(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]) || says(t))
        || talk.fits(&body[of..end]) == 0
        // (who is there already only says which are meant)
        || over == 0 && talk.fits(&[&body[of..end], place].concat()) > 0
    {
        return tokens;
    }
    let to = led("to", &place[0], &[&place[1..]]);
    led("move", &tokens[0], &[&body[..end], &to])
}

/// "..., but their lorry stays": the lorry.
fn their_own(mut tokens: Vec<Token>) -> Vec<Token> {
    const STAYS: &[&str] = &[
        "stays",
        "stay",
        "remains",
        "remain",
        "can stay",
        "may stay",
        "should stay",
        "is left",
        "must stay",
        "can remain",
        "may remain",
        "is to stay",
        "shall stay",
        "has to stay",
        "should remain",
        "is kept",
    ];
    for i in 0..tokens.len() {
        let own = is(tokens.get(i), &["their", "his", "her", "its"])
            && !is(tokens.get(i + 1), &MATES)
            && (i == 0 || !is_verb(&tokens[i - 1]));
        let stays = own
            && first_noun(&tokens[i + 1..])
                .is_some_and(|n| n.0 < 2 && leads(&tokens[i + 1 + n.1..], STAYS).is_some());
        if stays {
            tokens[i].text = "the".into();
        }
    }
    tokens
}

const EDGES: &[&str] = &["edge", "kerb", "curb", "roadside", "shoulder", "side"];
const WALKS: &[&str] = &["sidewalk", "pavement", "footpath", "side"];
const LANES: &[&str] = &["lane"];

/// "behind the bus, same edge": the edge that the bus is at.
fn same_strip(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (4..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["same"]).then_some(())?;
        let (kinds, end) = match leads(
            &tokens[i + 1..],
            &["side of the road", "edge of the road", "side of the street"],
        ) {
            Some(n) => (tokens.get(i + 1)?, i + 1 + n),
            None => (tokens.get(i + 1)?, i + 2),
        };
        let from = (i.saturating_sub(2)..i)
            .find(|k| {
                (*k + 1..i).all(|j| is(tokens.get(j), &["on", "in", "at", "the"]))
                    && is(tokens.get(*k), &[",", "on", "in", "at", "the"])
            })
            .unwrap_or(i);
        let comma =
            from > 0 && tokens[from - 1].kind == TokenKind::Comma || tokens[from].kind == TokenKind::Comma;
        (comma && end == tokens.len()).then_some((from, text(kinds).to_string()))
    });
    let Some((from, kind)) = found else {
        return tokens;
    };
    let before = trimmed(&tokens[..from]);
    // what was named last with "the"
    let Some(the) = before.iter().rposition(|t| is(Some(t), &["the", "my", "that"])) else {
        return tokens;
    };
    let anchor = &before[the..];
    if the == 0 || !first_noun(anchor).is_some_and(|n| n.0 < 4 && n.1 == anchor.len()) {
        return tokens;
    }
    let role = talk.only(anchor).and_then(|b| role_of(talk.map, b));
    let (place, words): (&str, &[&str]) = match role {
        Some(L::LeftRoadside) => ("on the left edge of the road", EDGES),
        Some(L::RightRoadside) => ("on the right edge of the road", EDGES),
        Some(L::LeftSidewalk) => ("on the left sidewalk", WALKS),
        Some(L::RightSidewalk) => ("on the right sidewalk", WALKS),
        Some(L::Ego) => ("in my lane", LANES),
        Some(L::Left) => ("in the left lane", LANES),
        Some(L::Right) => ("in the right lane", LANES),
        Some(L::Oncoming) => ("in the oncoming lane", LANES),
        Some(L::Cross) => ("in the cross street", &["street", "road", "lane"]),
        _ => return tokens,
    };
    if words.contains(&kind.as_str()) {
        [before, &led(place, &tokens[tokens.len() - 1], &[])].concat()
    } else {
        tokens
    }
}

/// "the truck behind me away", "cyclist gone, child too", "the truck ahead of me gone, a van in its place".
pub(super) fn gone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if tokens.len() > 40 {
        return tokens;
    }
    let wish = leads(&tokens, WISHES).unwrap_or(0);
    let each = each_out(&tokens[wish..], talk);
    let body = trimmed(&each);
    // ("barriers away, five cones instead")
    let late = is(tokens.last(), &["instead"]) && !is(body.last(), &["instead"]);
    let mut out: Vec<Token> = Vec::new();
    let mut before = false;
    let list = parts(body);
    for (k, p) in list.iter().copied().enumerate() {
        let goes = leaves(p, before, talk);
        // ("cyclists off, mopeds on" is one for the other)
        if k == 0 && goes.is_none() || is(p.last(), &["on", "in"]) {
            return tokens;
        }
        if let Some(who) = stays(p, talk) {
            out.push(comma(&p[0]));
            out.extend(led("leave", &p[0], &[&who, &led("alone", &p[0], &[])]));
            before = false;
            continue;
        }
        let fresh = is(p.first(), &["a", "an", "another"]) || number(&p[0]).is_some();
        let last = k + 1 == list.len();
        let placed = || first_noun(p).is_some_and(|n| n.0 < 4 && is_place(&p[n.1..]));
        let there = super::predicate::in_place(p).is_some()
            || is(p.last(), &["instead"])
            || late && last
            || is(p.first(), &["a", "an", "another"]) && placed();
        // ("motorcycle in its place")
        let bare = first_noun(p).filter(|n| n.0 == 0 && talk.fits(&p[..n.1]) == 0);
        let verb = |i: usize| says(&p[i]) && super::words::noun_at(&p[i..=i]).is_none();
        let put = goes.is_none() && (fresh || bare.is_some()) && there && !(0..p.len()).any(verb);
        if k > 0 {
            let and = goes.is_some() || put;
            out.push(if and { word("and", &p[0]) } else { comma(&p[0]) });
        }
        match goes {
            Some(who) => {
                let the = is(
                    who.first(),
                    &["the", "both", "all", "my", "that", "these", "those"],
                );
                out.extend(led(if the { "remove" } else { "remove the" }, &p[0], &[who]));
                before = true;
            }
            None => {
                if put {
                    out.extend(led(if fresh { "put" } else { "put a" }, &p[0], &[]));
                }
                out.extend_from_slice(p);
                if put && late && last {
                    out.extend(led("instead", &p[0], &[]));
                }
                before = false;
            }
        }
    }
    out
}

const WISHES: &[&str] = &[
    "i want",
    "we want",
    "id like",
    "i would like",
    "wed like",
    "we would like",
    "i need",
    "we need",
    "id like to have",
    "id like to see",
    "i want to see",
    "id prefer",
    "i would prefer",
];

/// "car and truck both out", "cyclist and both women off, and a lorry behind us": each of them out.
fn each_out(tokens: &[Token], talk: &Talk<'_>) -> Vec<Token> {
    let found = (3..tokens.len()).find(|i| {
        is(tokens.get(*i), &["gone", "away", "out", "off"])
            && tokens
                .get(i + 1)
                .is_none_or(|t| t.kind == TokenKind::Comma || text(t) == "and")
    });
    let Some(i) = found else { return tokens.to_vec() };
    let end = i - usize::from(is(tokens.get(i - 1), &["both", "all", "each"]));
    let from = tokens[..end]
        .iter()
        .rposition(|t| t.kind != TokenKind::Word)
        .map_or(0, |k| k + 1);
    let list: Vec<&[Token]> = tokens[from..end].split(|t| text(t) == "and").collect();
    let bare = |np: &&[Token]| {
        first_noun(np).is_some_and(|n| n.0 < 4 && n.1 == np.len())
            && !is(np.first(), &["a", "an", "another"])
            && !np.iter().any(says)
            && !is_verb(&np[0])
            && talk.fits(np) > 0
    };
    if list.len() < 2 || !list.iter().all(bare) {
        return tokens.to_vec();
    }
    let mut out = tokens[..from].to_vec();
    for (k, np) in list.iter().enumerate() {
        if k > 0 {
            out.push(word("and", &tokens[i]));
        }
        out.extend_from_slice(np);
        out.push(tokens[i].clone());
    }
    out.extend_from_slice(&tokens[i + 1..]);
    out
}

/// "parked cars stay", "the bus can stay": who stays as he is.
fn stays(p: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const STAYING: &[&str] = &[
        "stay",
        "stays",
        "remain",
        "remains",
        "can stay",
        "may stay",
        "should stay",
        "to stay",
        "is to stay",
        "can remain",
        "may remain",
        "is fine",
        "are fine",
        "stay put",
        "stays put",
        "stay there",
        "stays there",
    ];
    let (_, b) = first_noun(p).filter(|n| n.0 < 4)?;
    (leads(&p[b..], STAYING) == Some(p.len() - b)).then_some(())?;
    let who = &p[..b];
    let all = number(&who[0]).is_none_or(|n| n.max(0) as usize == talk.fits(&who[1..]));
    let the = is(
        who.first(),
        &["the", "both", "all", "my", "that", "these", "those"],
    );
    let np = if the {
        who.to_vec()
    } else {
        led("the", &p[0], &[who])
    };
    (all && !is(who.first(), &["a", "an", "only", "just"]) && talk.fits(&np) > 0).then_some(np)
}

fn comma(at: &Token) -> Token {
    Token {
        kind: TokenKind::Comma,
        ..word(",", at)
    }
}

fn says(t: &Token) -> bool {
    HELPERS.contains(&text(t)) || is_finite(text(t), false)
}

/// Who goes by a part of a note; "child too" goes as who was named before.
fn leaves<'t>(p: &'t [Token], before: bool, talk: &Talk<'_>) -> Option<&'t [Token]> {
    let (last, who) = p.split_last()?;
    let away = is(Some(last), &["gone", "away", "out", "off"]) || before && is(Some(last), &["too", "also"]);
    let (a, b) = first_noun(who).filter(|n| away && n.0 < 4)?;
    let fresh = is(who.first(), &["a", "an", "another", "some", "no", "more"])
        || who[..a]
            .iter()
            .any(|t| is_verb(t) || number(t).is_some_and(|_| !is(Some(t), &["both"])));
    let place = &who[b..];
    let plain = place.is_empty()
        || is_place(place)
            && !has_noun(place)
            && !place.iter().any(|t| number(t).is_some())
            && is(
                place.last(),
                &[
                    "me", "us", "left", "right", "lane", "road", "street", "sidewalk", "pavement",
                ],
            );
    (!fresh && plain && !who.iter().any(says) && talk.fits(who) > 0).then_some(who)
}

/// "cones", which may be a verb, too.
fn names(t: &Token) -> bool {
    super::words::noun_at(std::slice::from_ref(t)).is_some()
}

/// One of a note's parts: who, where to.
struct Part<'t> {
    who: Vec<Token>,
    to: &'t [Token],
}

fn parts(tokens: &[Token]) -> Vec<&[Token]> {
    tokens
        .split(|t| t.kind == TokenKind::Comma || is(Some(t), &["and", "while", "but"]) || text(t) == ";")
        .filter(|p| !p.is_empty())
        .collect()
}

/// Who is sent where in a part; "the rear one" is of the kind named before.
fn part<'t>(tokens: &'t [Token], noun: Option<&[Token]>, talk: &Talk<'_>) -> Option<Part<'t>> {
    let one = (1..tokens.len().min(4)).find(|k| is(tokens.get(*k), &["one"]));
    let b = match (first_noun(tokens).filter(|n| n.0 < 4), one, noun) {
        (Some((_, b)), None, _) => b,
        (_, Some(k), Some(_)) => k + 1,
        _ => return None,
    };
    let mut who = tokens[..b].to_vec();
    if let (Some(k), Some(noun)) = (one, noun) {
        who.splice(k.., noun.iter().cloned());
    }
    let fresh = is(who.first(), &["a", "an", "another", "some", "no", "more"])
        || number(&who[0]).is_some()
        || who
            .iter()
            .any(|t| is_verb(t) || HELPERS.contains(&text(t)) || is_finite(text(t), false) && !names(t));
    let also = leads(&tokens[b..], ALSO).unwrap_or(0);
    let to = &tokens[b + also..];
    if fresh || leads(to, TO).is_none() || talk.fits(&who) == 0 {
        return None;
    }
    if !is(
        who.first(),
        &["the", "both", "all", "my", "that", "this", "these", "those"],
    ) {
        who = led("the", &who[0], &[&who]);
    }
    let end = (1..=2).find_map(|n| {
        let k = to.len().checked_sub(n)?;
        leads(&to[k..], ALSO).filter(|m| *m == n).map(|_| k)
    });
    Some(Part {
        who,
        to: &to[..end.unwrap_or(to.len())],
    })
}

/// "front truck to thirty metres, rear one also to thirty": move each of them.
fn sent(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if tokens.len() > 40 {
        return tokens;
    }
    let list = parts(trimmed(&tokens));
    let Some(first) = list.first().and_then(|p| part(p, None, talk)) else {
        return tokens;
    };
    let verb = |t: &Token| HELPERS.contains(&text(t)) || is_finite(text(t), false) && !names(t);
    let state = |t: &Token| is(Some(t), &["parked", "stopped", "standing"]);
    if list.iter().any(|p| p.iter().any(|t| verb(t) && !state(t))) {
        return tokens;
    }
    let noun = first_noun(&first.who).map(|n| first.who[n.0..n.1].to_vec());
    // "over to the right edge, parked"
    if let [_, state] = list.as_slice()
        && is(state.first(), &["parked"])
        && state.len() == 1
        && first.to.iter().any(|t| is(Some(t), STRIPS))
    {
        let n = leads(first.to, TO).unwrap_or(1);
        return led(
            "park",
            &tokens[0],
            &[&first.who, &led("on", &tokens[0], &[&first.to[n..]])],
        );
    }
    // ("red car to fifteen": metres)
    let metres = |to: &[Token]| is(to.first(), &["to"]) && to.len() == 2 && number(&to[1]).is_some();
    if list.len() == 1
        && metres(first.to)
        && talk.fits(&first.who) == 1
        && noun.as_deref().is_some_and(|n| !many(n))
    {
        return led(
            "move",
            &tokens[0],
            &[&first.who, first.to, &led("metres", &tokens[0], &[])],
        );
    }
    let unit = (1..first.to.len())
        .find(|k| is_unit(first.to.get(*k)))
        .map(|k| first.to[k].clone());
    let mut out = led("move", &tokens[0], &[&first.who, first.to]);
    for p in &list[1..] {
        let Some(next) = part(p, noun.as_deref(), talk) else {
            return tokens;
        };
        out.extend(led("and move", &p[0], &[&next.who, next.to]));
        // ("also to thirty")
        if next.to.last().is_some_and(|t| number(t).is_some())
            && let Some(unit) = &unit
        {
            out.push(unit.clone());
        }
    }
    let bare = is(first.to.first(), &["to"]) && list.len() == 1;
    if bare { tokens } else { out }
}

fn many(noun: &[Token]) -> bool {
    noun.last()
        .is_some_and(|t| matches!(look_up(text(t)), Some(Sense::Noun(_, true))))
}

/// "bus to thirty metres, and both workers go with it": they stay beside it.
fn go_along(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const ALONG: &[&str] = &[
        "go with it",
        "goes with it",
        "go along",
        "goes along",
        "come with it",
        "comes with it",
        "come along",
        "comes along",
        "move with it",
        "moves with it",
        "go with him",
        "goes with him",
        "go with them",
        "goes with them",
        "go along with it",
        "goes along with it",
        "come along with it",
        "follow along",
        "move along with it",
        "moves along with it",
        "stay with it",
        "stays with it",
        "stay beside it",
        "stays beside it",
        "stay next to it",
        "stays next to it",
        "should go with it",
        "should come along",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], ALONG)?;
        let from = tokens[..i].iter().rposition(|t| {
            t.kind != TokenKind::Word && number(t).is_none() || is(Some(t), &["and", "with"])
        })?;
        let who = trimmed(&tokens[from..i]);
        let whole = first_noun(who).is_some_and(|x| x.0 < 4 && x.1 == who.len()) && talk.fits(who) > 0;
        (whole && i + n == tokens.len()).then_some((from, i, i + n))
    });
    let Some((from, i, end)) = found else {
        return tokens;
    };
    let lead = trimmed(&tokens[..from]);
    let moves = is(
        lead.first(),
        &[
            "move", "shift", "put", "bring", "push", "pull", "send", "place", "drive", "park",
        ],
    );
    let body = &lead[usize::from(moves)..];
    let Some((_, b)) = first_noun(body).filter(|n| n.0 < 4) else {
        return tokens;
    };
    let placed = leads(&body[b..], TO).is_some() || moves && is_place(&body[b..]);
    if !placed || is(body.first(), &["a", "an", "another"]) || has_noun(&body[b..]) {
        return tokens;
    }
    let the = |np: &[Token]| match is(
        np.first(),
        &["the", "both", "all", "my", "that", "these", "those"],
    ) {
        true => np.to_vec(),
        false => led("the", &np[0], &[np]),
    };
    let who = the(trimmed(&tokens[from..i]));
    let first = led("move", &tokens[0], &[&the(&body[..b]), &body[b..]]);
    let next = led("next to", &tokens[i], &[&the(&body[..b])]);
    [
        &first,
        &led("and move", &tokens[i], &[&who])[..],
        &next,
        &tokens[end..],
    ]
    .concat()
}

/// "roller and two workers in the right lane, all of them ahead of me": that is where, too.
fn all_of_them(tokens: Vec<Token>) -> Vec<Token> {
    const ALL: &[&str] = &[
        "all of them",
        "both of them",
        "each of them",
        "all",
        "both",
        "everything",
        "all of it",
        "all three",
    ];
    let found = (3..tokens.len()).find_map(|i| {
        (tokens[i - 1].kind == TokenKind::Comma).then_some(())?;
        let n = leads(&tokens[i..], ALL)?;
        let rest = &tokens[i + n..];
        let bare = is_place(rest)
            && !has_noun(rest)
            && !is(rest.first(), &["to", "by", "out", "away", "off", "over"]);
        bare.then_some((i, i + n))
    });
    let Some((i, rest)) = found else {
        return tokens;
    };
    let before = &tokens[..i - 1];
    let verb = |t: &Token| HELPERS.contains(&text(t)) || is_finite(text(t), false);
    let (a, b) = first_noun(before).unwrap_or((9, 9));
    let another = before
        .iter()
        .position(|t| is(Some(t), &["and"]))
        .is_some_and(|k| has_noun(&before[k..]));
    if a > 2
        || before.iter().any(verb)
        || is_verb(&before[0])
        || !another
        || is(before.first(), &["the", "both", "all"])
    {
        return tokens;
    }
    // ("roller and two workers" are new)
    let bare = a == 0 && !before[..b].iter().any(|t| number(t).is_some());
    let lead = if bare { "add a" } else { "add" };
    led(lead, &tokens[0], &[before, &tokens[rest..]])
}
