//! What is said twice, beside the point or in an unusual order, in plain words.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::some_of::removes;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const EVERYTHING: &str = "everyone and everything|everything and everyone|everybody and everything|everything and everybody|anyone and anything|anything and anyone|anybody and anything";
const TRAFFIC: &str =
    "all traffic|all the traffic|any traffic|all other traffic|all of the traffic|every traffic";
const WITH_IT: &str =
    "with it to|with him to|with her to|with them to|along with it to|along to|together with it to";
const MEANT: &str = "what i meant was|what i meant is|what i really meant was|what i wanted was|what i want is|what i actually meant was|what i actually want is";
const AROUND: &str = "walking around here|walking about here|walking around there|walking around|walking about|wandering around|running around|strolling around|hanging around here|hanging around|hanging about|standing around here|standing around";
const SAME_SPOT: &str = "parked in the same place|parked in the same spot|standing in the same place|in the very same place|in the same place|in the same spot|at the same spot|at the same place|on the same spot";
const LIFT: &str =
    "pick up the|pick up that|pick up all the|pick up all|pick up both|pick up every|pick up one of the";
const SPARING: &[&str] = &[
    "except",
    "except for",
    "but",
    "apart from",
    "other than",
    "save for",
    "besides",
    "aside from",
];

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&tokens, EVERYTHING, "everything");
    let out = replaced(&out, TRAFFIC, "all vehicles");
    let out = replaced(&out, WITH_IT, "to");
    let out = replaced(&out, "out of here|outta here", "out");
    let out = replaced(&out, MEANT, "i meant");
    let out = match is(out.first(), &["i", "we"]) {
        true => replaced(&out, AROUND, ""),
        false => out,
    };
    let out = lifted(out);
    let exchanges = is(
        out.first(),
        &["exchange", "replace", "swap", "substitute", "trade"],
    );
    let out = if exchanges {
        replaced(&out, SAME_SPOT, "")
    } else {
        out
    };
    let out = replaced(
        &out,
        "could we have|can we have|could i have|can i have|may i have|may we have|might we have",
        "add",
    );
    let out = away_with(out);
    let out = included(fronted_exception(out));
    let out = set_out(purpose(out));
    let out = ordinals(all_to(out));
    let out = replaced(
        &out,
        "is enough for me|is enough for us|is plenty for me|is plenty for us",
        "is enough",
    );
    let out = replaced(
        &out,
        "are enough for me|are enough for us|are plenty for me",
        "are enough",
    );
    let out = every_in_list(in_the_middle(needed_so(turned_once(out))));
    let out = than_there(out);
    let out = all_that_is(out);
    let out = no_more_sky(out);
    let out = rest_stays(out);
    let out = wished_gone(out, talk);
    let out = out_and_in(out);
    let out = left_alone(out);
    let out = still_so(out);
    let out = closer_to(out);
    let out = other_out(out);
    let out = ones_spared(out);
    let out = no_but(out);
    let out = enough_so(just_those(out));
    let out = the_other_so_many(out);
    let out = match find(&out, &["instead of"])
        .filter(|(i, n)| out.get(i + n).is_some_and(|t| number(t).is_some()))
    {
        Some(_) => replaced(
            &out,
            "cross there|stand there|wait there|walk there|be there|stand here",
            "",
        ),
        None => out,
    };
    let out = replaced(
        &out,
        "let its driver stand|and its driver stands|let the driver stand",
        "add a man",
    );
    only_of(out, talk)
}

/// "away with the bus and with the people"
fn away_with(tokens: Vec<Token>) -> Vec<Token> {
    match leads(&tokens, &["away with", "down with", "off with", "out with"]) {
        Some(n)
            if find(&tokens, &["in with"]).is_none()
                && is(
                    tokens.get(n),
                    &["the", "all", "both", "my", "every", "that", "those"],
                ) =>
        {
            led(
                "remove",
                &tokens[0],
                &[&replaced(&tokens[n..], "and with", "and")],
            )
        }
        _ => tokens,
    }
}

/// "with the exception of the bus, remove everything"
fn fronted_exception(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "with the exception of",
            "apart from",
            "except for",
            "aside from",
            "other than",
            "save for",
        ],
    ) else {
        return tokens;
    };
    let comma = tokens.iter().position(comma).filter(|i| *i > n);
    match comma {
        Some(i)
            if removes(tokens.get(i + 1)) && is(tokens.get(i + 2), &["everything", "everyone", "all"]) =>
        {
            [&tokens[i + 1..], &led("except", &tokens[0], &[&tokens[n..i]])].concat()
        }
        _ => tokens,
    }
}

/// "everything, the bus included, except ...": the bus is in everything.
fn included(tokens: Vec<Token>) -> Vec<Token> {
    let end = (3..tokens.len()).find(|i| {
        is(tokens.get(*i), &["included", "includes", "too"])
            && tokens.get(i + 1).is_none_or(|t| t.kind != TokenKind::Word)
    });
    let Some(end) = end.filter(|i| text(&tokens[*i]) == "included") else {
        return tokens;
    };
    let all = is(tokens.get(1), &["everything", "everyone", "all", "every"]);
    match (0..end).rev().find(|i| comma(&tokens[*i])) {
        Some(start) if all => [
            &tokens[..start],
            tokens.get(end + 1..).map_or(
                &[][..],
                |r| if r.first().is_some_and(comma) { &r[1..] } else { r },
            ),
        ]
        .concat(),
        _ => tokens,
    }
}

/// "... so that my students see her": why, not what.
fn purpose(tokens: Vec<Token>) -> Vec<Token> {
    const WHY: &[&str] = &[
        "see",
        "sees",
        "notice",
        "learn",
        "learns",
        "know",
        "knows",
        "understand",
        "practise",
        "practice",
        "train",
        "test",
        "react",
        "feel",
        "brake",
        "watch",
    ];
    match find(&tokens, &["so that", "in order that"]).filter(|x| x.0 > 2) {
        Some((i, n))
            if tokens[i + n..].iter().take(5).any(|t| WHY.contains(&text(t)))
                && !tokens[i..].iter().any(comma) =>
        {
            tokens[..i].to_vec()
        }
        _ => tokens,
    }
}

/// "set three cones near her", "park two trucks there": they come.
fn set_out(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let opens =
            i == 0 || comma(&tokens[i - 1]) || is(tokens.get(i - 1), &["and", "so", "then", "please"]);
        let some = tokens.get(i + 1).is_some_and(|n| {
            number(n).is_some() && text(n) != "one" || matches!(text(n), "a" | "an" | "some" | "another")
        });
        let noun = first_noun(&tokens[i + 1..]).filter(|x| some && x.0 < 5);
        let thing = noun.is_some();
        // ("draw two of the cones closer" moves those that are there)
        let drawn = noun.is_some_and(|x| {
            let rest = &tokens[i + 1 + x.1..];
            !is(tokens.get(i + 2), &["of"])
                && !is(
                    rest.first(),
                    &[
                        "closer", "nearer", "back", "away", "up", "aside", "over", "forward", "to",
                    ],
                )
        });
        match text(t) {
            "draw" | "sketch" | "depict" | "picture" | "render" if opens && drawn => {
                out.push(super::words::word("add", t));
            }
            "set" | "lay" | "stand" | "position" if opens && thing => out.push(super::words::word("add", t)),
            "park"
                if opens
                    && thing
                    && tokens
                        .get(i + 1)
                        .is_some_and(|n| number(n).is_some() || is(Some(n), &["a", "an", "another"])) =>
            {
                out.extend(led("add", t, &[]));
                out.push(tokens[i + 1].clone());
                out.push(super::words::word("parked", t));
            }
            _ if i > 0
                && text(&tokens[i - 1]) == "park"
                && out.last().is_some_and(|o| text(o) == "parked") => {}
            _ => out.push(t.clone()),
        }
    }
    out
}

/// "all bicycles to the other sidewalk": they move.
fn all_to(tokens: Vec<Token>) -> Vec<Token> {
    let all = is(tokens.first(), &["all", "both", "every"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    match all && is(tokens.get(b), &["to", "onto", "into", "over", "across"]) {
        true => led("move", &tokens[0], &[&tokens]),
        false => tokens,
    }
}

/// "remove the third and the fourth car": the fourth first, so that the third stays the third.
fn ordinals(tokens: Vec<Token>) -> Vec<Token> {
    const NTH: [&str; 6] = ["first", "second", "third", "fourth", "fifth", "sixth"];
    let nth = |i: usize| NTH.iter().position(|n| is(tokens.get(i), &[n]));
    let found = (0..tokens.len()).find_map(|i| {
        removes(tokens.get(i)).then_some(())?;
        is(tokens.get(i + 1), &["the"]).then_some(())?;
        let a = nth(i + 2)?;
        is(tokens.get(i + 3), &["and"]).then_some(())?;
        let the = usize::from(is(tokens.get(i + 4), &["the"]));
        let b = nth(i + 4 + the)?;
        let (k, n) = first_noun(&tokens[i + 5 + the..]).filter(|x| x.0 == 0)?;
        Some((i, a.max(b), a.min(b), i + 5 + the + k, i + 5 + the + n))
    });
    let Some((i, high, low, a, b)) = found else {
        return tokens;
    };
    let one = |n: usize| {
        [
            led("the", &tokens[i], &[]),
            led(NTH[n], &tokens[i], &[&tokens[a..b]]),
        ]
        .concat()
    };
    [
        &tokens[..=i],
        &one(high),
        &led("and", &tokens[i], &[&tokens[i..=i]]),
        &one(low),
        &tokens[b..],
    ]
    .concat()
}

/// "turn the bus round, it must drive in the opposite direction": said twice.
fn turned_once(tokens: Vec<Token>) -> Vec<Token> {
    let turns = is(tokens.first(), &["turn", "rotate", "spin", "swing"]);
    let again = find(
        &tokens,
        &[
            "it must drive",
            "it should drive",
            "it has to drive",
            "it must go",
            "it should go",
            "it must face",
            "it should face",
            "so that it drives",
            "so that it goes",
        ],
    );
    match again.filter(|x| turns && x.0 > 2) {
        Some((i, n))
            if leads(
                &tokens[i + n..],
                &[
                    "in the opposite direction",
                    "in the other direction",
                    "the other way",
                    "the opposite way",
                ],
            )
            .is_some() =>
        {
            trimmed(&tokens[..i]).to_vec()
        }
        _ => tokens,
    }
}

/// "we need a road roller, so add one in the oncoming lane": one roller.
fn needed_so(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "we need",
            "i need",
            "i want",
            "we want",
            "there is no",
            "is missing",
        ],
    ) else {
        return tokens;
    };
    let Some((k, m)) = find(
        &tokens[i + n..],
        &[
            "so add one",
            "so put one",
            "so place one",
            "add one",
            "so let us add one",
        ],
    )
    .map(|(k, m)| (i + n + k, m)) else {
        return tokens;
    };
    let np = trimmed(&tokens[i + n..k]);
    let single = is(np.first(), &["a", "an"]) && first_noun(np).is_some_and(|x| x.1 == np.len());
    match single && !has_noun(&tokens[k + m..]) {
        true => led("add", &tokens[0], &[np, &tokens[k + m..]]),
        false => tokens,
    }
}

/// "the excavator, the worker and every cone": all cones.
fn every_in_list(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = tokens;
    for i in 1..out.len() {
        let listed = comma(&out[i - 1]) || text(&out[i - 1]) == "and";
        if listed
            && text(&out[i]) == "every"
            && out.iter().any(|t| removes(Some(t)))
            && let Some((a, b)) = first_noun(&out[i + 1..]).filter(|x| x.0 == 0 && x.1 == 1)
        {
            let at = i + 1 + a;
            let many = super::super::lexicon::plural(text(&out[at]));
            out[at] = super::words::word(&many, &out[i + b]);
            out[i] = super::words::word("all", &out[i].clone());
        }
    }
    out
}

/// "the car in the middle of the row": the middle car.
fn in_the_middle(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "in the middle of the row",
            "in the middle of the queue",
            "in the middle of the line",
            "in the middle of the three",
        ],
    ) else {
        return tokens;
    };
    let the = (0..i).rev().find(|k| is(tokens.get(*k), &["the"]));
    match the.filter(|k| first_noun(&tokens[*k..i]).is_some_and(|x| k + x.1 == i)) {
        Some(k) => [
            &tokens[..=k],
            &led("middle", &tokens[i], &[]),
            &tokens[k + 1..i],
            &tokens[i + n..],
        ]
        .concat(),
        None => tokens,
    }
}

fn comma(t: &Token) -> bool {
    t.kind == TokenKind::Comma
}

/// "pick up the cones": they go.
fn lifted(tokens: Vec<Token>) -> Vec<Token> {
    match leads(&tokens, &LIFT.split('|').collect::<Vec<_>>()) {
        Some(_) => led("remove", &tokens[0], &[&tokens[2..]]),
        None => tokens,
    }
}

/// "rather in front of us than behind us": in front of us.
fn than_there(tokens: Vec<Token>) -> Vec<Token> {
    let wish = tokens
        .iter()
        .any(|t| matches!(text(t), "rather" | "better" | "prefer" | "sooner" | "id"));
    let than = (2..tokens.len())
        .find(|i| is(tokens.get(*i), &["than"]) && is_place(&tokens[i + 1..]) && !has_noun(&tokens[i + 1..]));
    match than.filter(|_| wish) {
        Some(i) => tokens[..i].to_vec(),
        None => tokens,
    }
}

/// "clear away everything that is ahead of us"
fn all_that_is(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "everything that is",
            "everything which is",
            "everything thats",
            "whatever is",
            "all that is",
            "everything that stands",
            "everything that drives",
        ],
    ) else {
        return tokens;
    };
    let removing = tokens[..i].iter().any(|t| removes(Some(t)));
    if !removing || !is_place(&tokens[i + n..]) {
        return tokens;
    }
    led("remove all objects", &tokens[i], &[&tokens[i + n..]])
}

/// "no more snow, just an overcast sky": the sky that comes.
fn no_more_sky(tokens: Vec<Token>) -> Vec<Token> {
    let sky = |t: &Token| {
        matches!(
            text(t),
            "rain" | "snow" | "fog" | "clouds" | "sunshine" | "mist" | "storm" | "sandstorm" | "drizzle"
        )
    };
    let lead = leads(
        &tokens,
        &["no more", "no", "without", "not any more", "enough of the"],
    );
    let Some(n) = lead.filter(|n| tokens.get(*n).is_some_and(sky)) else {
        return tokens;
    };
    let from = n + 1;
    let next = leads(
        &tokens[from..]
            .iter()
            .filter(|t| !comma(t))
            .cloned()
            .collect::<Vec<_>>(),
        &["just", "only", "but", "instead", "rather"],
    );
    let begin = from + tokens[from..].iter().take_while(|t| comma(t)).count();
    match next {
        Some(k) if begin + k < tokens.len() && !has_noun(&tokens[begin + k..]) => {
            led("make it", &tokens[0], &[&tokens[begin + k..]])
        }
        _ => tokens,
    }
}

/// "empty the car park, only the pedestrian stays": everything goes but him.
fn rest_stays(tokens: Vec<Token>) -> Vec<Token> {
    let clears = is(tokens.first(), &["empty", "clear", "remove", "delete", "erase"]);
    let Some(i) = (2..tokens.len()).find(|i| comma(&tokens[*i]) || text(&tokens[*i]) == "and") else {
        return tokens;
    };
    let rest = trimmed(&tokens[i..]);
    let only = leads(rest, &["only", "just"]);
    let stays = find(
        rest,
        &[
            "stays",
            "stay",
            "remains",
            "remain",
            "is left",
            "are left",
            "may stay",
            "can stay",
            "should stay",
            "should remain",
        ],
    );
    match (only, stays) {
        (Some(a), Some((b, n))) if clears && b + n == rest.len() && b > a && has_noun(&rest[a..b]) => {
            led("remove everything except", &tokens[0], &[&rest[a..b]])
        }
        _ => tokens,
    }
}

/// "I would like the farther truck and the black car gone"
fn wished_gone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "i would like",
            "id like",
            "i want",
            "we want",
            "i need",
            "we would like",
            "wed like",
        ],
    ) else {
        return tokens;
    };
    let end = (i + n..tokens.len()).find(|k| {
        is(tokens.get(*k), &["gone", "removed", "deleted", "away", "taken"])
            && tokens
                .get(k + 1)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "away", "out"]))
    });
    let Some(end) = end else { return tokens };
    let np = &tokens[i + n..end];
    let list = np.iter().any(|t| text(t) == "and") && !np.iter().any(comma) && talk.fits(np) > 0;
    let lead = tokens[..i].len() < 8 && first_noun(&tokens[..i]).is_none();
    if !list || !lead {
        return tokens;
    }
    let after = end + 1 + usize::from(is(tokens.get(end + 1), &["away", "out"]));
    led("remove", &tokens[i], &[np, &tokens[after..]])
}

/// "both trucks out, one bus 20 m ahead in"
fn out_and_in(tokens: Vec<Token>) -> Vec<Token> {
    let out = (1..tokens.len()).find(|i| {
        is(tokens.get(*i), &["out"]) && tokens.get(i + 1).is_some_and(|t| comma(t) || text(t) == "and")
    });
    let (Some(i), Some(last)) = (out, tokens.last()) else {
        return tokens;
    };
    let plain =
        text(last) == "in" && i + 2 < tokens.len() - 1 && has_noun(&tokens[..i]) && !removes(tokens.first());
    if !plain {
        return tokens;
    }
    let what = trimmed(&tokens[i + 1..tokens.len() - 1]);
    // ("van out, bus in": in its place)
    let one = |np: &[Token]| {
        let kind = first_noun(np).filter(|x| x.1 == np.len() && x.0 < 3);
        kind.is_some_and(|x| {
            x.1 == x.0 + 1 && matches!(super::look_up(text(&np[x.0])), Some(super::Sense::Noun(_, false)))
        }) && np
            .iter()
            .all(|t| number(t).is_none() || is(Some(t), &["a", "an"]))
    };
    if one(&tokens[..i]) && one(what) {
        let the = if is(tokens.first(), &["the", "that"]) {
            "replace"
        } else {
            "replace the"
        };
        let with = if is(what.first(), &["a", "an", "the"]) {
            "with"
        } else {
            "with a"
        };
        return led(the, &tokens[0], &[&tokens[..i], &led(with, &tokens[i], &[what])]);
    }
    led(
        "remove",
        &tokens[0],
        &[&tokens[..i], &led("and add", &tokens[i], &[what])],
    )
}

/// "(turn it around) but leave it in our lane": it is there.
fn left_alone(tokens: Vec<Token>) -> Vec<Token> {
    const LEAVE: &[&str] = &[
        "but leave it",
        "but keep it",
        "but leave them",
        "but keep them",
        "but let it stay",
        "but leave him",
        "but leave her",
        "and leave it",
        "and keep it",
    ];
    match find(&tokens, LEAVE).filter(|x| x.0 > 2) {
        Some((i, n))
            if (is_place(&tokens[i + n..]) || is(tokens.get(i + n), &["where", "there", "as"]))
                && !tokens[i + n..].iter().any(|t| comma(t) || text(t) == "and") =>
        {
            trimmed(&tokens[..i]).to_vec()
        }
        _ => tokens,
    }
}

/// "make the car a motorcycle, staying in the left lane", "car -> cyclist, still coming towards us": as before.
fn still_so(tokens: Vec<Token>) -> Vec<Token> {
    let becomes = tokens.iter().enumerate().any(|(k, t)| {
        matches!(
            text(t),
            "make" | ">" | "replace" | "becomes" | "become" | "turn" | "swap" | "exchange"
        ) || text(t) == "into" && !super::words::is_goal(&tokens[k..])
    });
    let Some(i) = (3..tokens.len()).find(|i| comma(&tokens[*i])) else {
        return tokens;
    };
    let rest = trimmed(&tokens[i..]);
    let still = leads(rest, &["still", "but still", "yet still", "again"]).unwrap_or(0);
    let goes = rest.get(still).is_some_and(|t| {
        let w = text(t);
        matches!(w, "staying" | "remaining" | "keeping")
            || still > 0 && (w.ends_with("ing") || is_place(&rest[still..]))
    });
    let alone = !rest.iter().any(|t| comma(t) || matches!(text(t), "and" | "but"));
    match becomes && goes && alone {
        true => tokens[..i].to_vec(),
        false => tokens,
    }
}

/// "bring the truck closer, only 15 m ahead of us": to 15 m ahead of us.
fn closer_to(tokens: Vec<Token>) -> Vec<Token> {
    let way = (2..tokens.len()).find(|i| {
        is(
            tokens.get(*i),
            &["closer", "nearer", "back", "forward", "further", "farther"],
        ) && tokens.get(i + 1).is_some_and(comma)
    });
    let Some(i) = way else { return tokens };
    let n = leads(
        &tokens[i + 2..],
        &[
            "only",
            "just",
            "to",
            "to only",
            "to just",
            "to about",
            "about",
            "so that it is",
            "so it is",
            "so that it is only",
        ],
    )
    .unwrap_or(0);
    let at = i + 2 + n;
    let measured =
        tokens.get(at).is_some_and(|t| number(t).is_some()) && super::words::is_unit(tokens.get(at + 1));
    if !measured {
        return tokens;
    }
    let start = i - usize::from(is(tokens.get(i - 1), &["a"]));
    [&tokens[..start], &led("to", &tokens[i], &[]), &tokens[at..]].concat()
}

/// "leave just one pedestrian and take the other one out": said twice.
fn other_out(tokens: Vec<Token>) -> Vec<Token> {
    let keeps = is(tokens.first(), &["leave", "keep"]) && is(tokens.get(1), &["just", "only", "one"]);
    let and = (3..tokens.len()).find(|i| {
        text(&tokens[*i]) == "and"
            && removes(tokens.get(i + 1))
            && leads(
                &tokens[i + 2..],
                &[
                    "the other",
                    "the others",
                    "the rest",
                    "the other one",
                    "the other ones",
                    "all others",
                    "all the others",
                ],
            )
            .is_some()
            && !has_noun(&tokens[i + 2..])
    });
    match and.filter(|_| keeps) {
        Some(i) => tokens[..i].to_vec(),
        None => tokens,
    }
}

/// "all vehicles except the ones parked on the right": the vehicles.
fn ones_spared(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, SPARING) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[..i]).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let ones = is(tokens.get(i + n), &["the", "those"]) && is(tokens.get(i + n + 1), &["ones", "one"]);
    let those = is(tokens.get(i + n), &["those"]) && !ones;
    match (ones, those) {
        (true, _) => [
            &tokens[..i + n],
            &led("the", &tokens[i], &[]),
            &tokens[a..b],
            &tokens[i + n + 2..],
        ]
        .concat(),
        (_, true) if !has_noun(&tokens[i + n..]) => [
            &tokens[..i + n],
            &led("the", &tokens[i], &[]),
            &tokens[a..b],
            &tokens[i + n + 1..],
        ]
        .concat(),
        _ => tokens,
    }
}

/// "no cars except the white car": all others go.
fn no_but(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let opens = i == 0 || comma(&tokens[i - 1]) || is(tokens.get(i - 1), &["and", "but", "with", "want"]);
        if !opens || !is(tokens.get(i), &["no"]) {
            return None;
        }
        let (k, n) = find(&tokens[i..], SPARING)?;
        let np = &tokens[i + 1..i + k];
        let whole =
            first_noun(np).is_some_and(|x| x.0 < 3) && !np.iter().any(|t| comma(t) || text(t) == "and");
        let the = is(tokens.get(i + k + n), &["the", "my", "that", "those"]);
        (whole && the).then_some((i, k))
    });
    let Some((i, k)) = found else { return tokens };
    let keep = i - usize::from(i > 0 && is(tokens.get(i - 1), &["with", "want"]));
    [
        &tokens[..keep],
        &led("remove all", &tokens[i], &[]),
        &tokens[i + 1..i + k],
        &led(
            "except",
            &tokens[i + k],
            &[&tokens[i + k + find(&tokens[i + k..], SPARING).map_or(1, |x| x.1)..]],
        ),
    ]
    .concat()
}

/// "no excavator, no cones, just the car": what stays needs no word.
fn just_those(tokens: Vec<Token>) -> Vec<Token> {
    let denies = (0..tokens.len()).any(|i| is(tokens.get(i), &["no"]) && (i == 0 || comma(&tokens[i - 1])));
    let last = (2..tokens.len()).rev().find(|i| comma(&tokens[*i]));
    match last.filter(|_| denies) {
        Some(i)
            if is(tokens.get(i + 1), &["just", "only"])
                && is(tokens.get(i + 2), &["the", "my"])
                && first_noun(&tokens[i + 2..]).is_some_and(|x| i + 2 + x.1 == tokens.len()) =>
        {
            tokens[..i].to_vec()
        }
        _ => tokens,
    }
}

/// "two pedestrians are enough, so drop one of them": said twice.
fn enough_so(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, _)) = find(
        &tokens,
        &[
            "are enough",
            "is enough",
            "would be enough",
            "are sufficient",
            "will do",
            "suffice",
        ],
    ) else {
        return tokens;
    };
    let counted = tokens[..i].iter().any(|t| number(t).is_some());
    let so = (i..tokens.len())
        .find(|k| removes(tokens.get(k + 1)) && (comma(&tokens[*k]) || is(tokens.get(*k), &["so", "and"])));
    let over = so.is_some_and(|k| {
        leads(
            &tokens[k + 2..],
            &[
                "one of them",
                "the other",
                "the others",
                "the rest",
                "one",
                "two of them",
                "the third",
                "the surplus",
            ],
        )
        .is_some()
            && !has_noun(&tokens[k + 2..])
    });
    match so.filter(|_| counted && over) {
        Some(k) => trimmed(&tokens[..k]).to_vec(),
        None => tokens,
    }
}

/// "keep the green car and drop the other two cars": the other two.
fn the_other_so_many(tokens: Vec<Token>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens) else {
        return tokens;
    };
    let named = super::super::names::singular(text(&tokens[b - 1])).to_owned();
    let Some((i, n)) = find(&tokens[b..], &["the other"]).map(|(i, n)| (b + i, n)) else {
        return tokens;
    };
    let many = tokens.get(i + n).is_some_and(|t| number(t).is_some());
    let same = tokens
        .get(i + n + 1)
        .is_some_and(|t| super::super::names::singular(text(t)) == named);
    match many && same && is(tokens.first(), &["keep", "leave"]) {
        true => [&tokens[..i + n + 1], &tokens[i + n + 2..]].concat(),
        false => tokens,
    }
}

/// "of the cars on the right, keep only the green car"
fn only_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["of", "out of", "among", "from among", "from"]) else {
        return tokens;
    };
    let Some(i) = tokens.iter().position(comma).filter(|i| *i > n) else {
        return tokens;
    };
    let group = &tokens[n..i];
    let k = leads(
        &tokens[i + 1..],
        &[
            "keep only",
            "keep just",
            "leave only",
            "leave just",
            "only keep",
            "only leave",
            "just keep",
            "retain only",
            "spare only",
        ],
    );
    let Some(k) = k else { return tokens };
    let np = &tokens[i + 1 + k..];
    let definite = is(np.first(), &["the", "that", "those"]) && first_noun(np).is_some_and(|x| x.0 < 5);
    if !definite || talk.fits(group) == 0 {
        return tokens;
    }
    led(
        "remove all",
        &tokens[0],
        &[group, &led("except", &tokens[i], &[np])],
    )
}
