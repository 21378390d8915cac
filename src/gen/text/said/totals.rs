//! How many there shall be in the end: "twice as many as there are now", "until only one is left", "to eight in all", "four
//! would be better than two", "not two but four".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::frame::unwrapped;
use super::lists::HELPERS;
use super::some_of::WISHES;
use super::wanted::{exceeds, from_to, nicer, not_but, not_enough, place_then_only, rather_than};
use super::words::{find, first_noun, is, is_place, leads, led, number, text, trimmed};

const TIMES: &[&str] = &["twice", "double", "thrice", "triple", "half"];
const IN_ALL: &[&str] = &[
    "in all",
    "in total",
    "altogether",
    "all told",
    "overall",
    "all in all",
    "in sum",
    "all together",
];
const UNTIL: &[&str] = &[
    "until there are",
    "until there is",
    "till there are",
    "till there is",
    "until we have",
    "till we have",
    "until",
    "till",
    "leaving",
    "so that there are",
    "so that there is",
    "so that",
    "so there are",
    "so there is",
    "such that there are",
    "so we have",
    "so that we have",
    "making it",
    "to make it",
    "to make",
    "for a total of",
    "to a total of",
    "which makes",
    "which leaves",
    "making",
];
const LEFT: &[&str] = &[
    "remain",
    "remains",
    "are left",
    "is left",
    "left",
    "stay",
    "stays",
    "are left over",
    "is left over",
    "remaining",
    "are there",
    "is there",
    "are still there",
    "is still there",
];
const SAME_PLACE: &[&str] = &[
    "all on the same sidewalk as before",
    "on the same sidewalk as before",
    "on the same sidewalk as now",
    "all in the same place as before",
    "in the same place as before",
    "in the same lane as before",
    "all in the same lane as before",
    "all on the same sidewalk",
    "all in the same lane",
    "where the others are",
    "on the same side as before",
    "all on the same side as before",
    "on the same side as the others",
    "in the same lane as the others",
    "on the same sidewalk as the others",
    "in the same place as the others",
];

/// The sentence with such a number as a command.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = same_place(same_there(down_to(doubled(tokens), talk), talk));
    let out = exceeds(place_then_only(out, talk), talk);
    let out = times_as_many(out);
    let out = until(out, talk);
    let out = so_many_of_them(in_all(out, talk), talk);
    let out = not_but(out);
    from_to(not_enough(nicer(rather_than(out), talk), talk), talk)
}

pub(super) fn links(t: &Token) -> bool {
    t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)) || matches!(text(t), "and" | "but")
}

/// "parked cars down to two": so many of them are to be there.
fn down_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let the = usize::from(is(tokens.first(), &["the"]));
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &tokens[the..b];
    let n = leads(
        &tokens[b..],
        &["down to", "up to", "back to", "back down to", "back up to"],
    );
    let many = matches!(look_up(text(&tokens[b - 1])), Some(Sense::Noun(_, true)));
    let Some(k) = n
        .map(|n| b + n)
        .filter(|k| many && tokens.get(*k).is_some_and(|t| number(t).is_some()))
    else {
        return tokens;
    };
    // ("up to 20 m" is how far)
    let said = np
        .iter()
        .any(|t| super::super::rephrase::is_verb(t) || number(t).is_some());
    if said || !tokens.get(k + 1).is_none_or(links) || talk.fits(np) == 0 {
        return tokens;
    }
    // ("and a second nurse there")
    let rest = &tokens[k + 1..];
    let new = is(rest.get(1), &["a", "an", "another"]);
    let rest = match rest.split_first() {
        Some((and, more)) if new => led("and add", and, &[more]),
        _ => rest.to_vec(),
    };
    led("keep exactly", &tokens[0], &[&tokens[k..=k], np, &rest])
}

/// "five children, same pavement": so many are to be where those stand that are there.
fn same_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const SAME: &[&str] = &[
        "same sidewalk",
        "same pavement",
        "same lane",
        "same side",
        "same place",
        "same spot",
        "same edge",
        "same roadside",
        "same kerb",
        "same curb",
        "same footpath",
        "same strip",
        "same side of the road",
        "same side of the street",
        "same edge of the road",
    ];
    let found = find(&tokens, SAME).filter(|(i, n)| {
        let rest = trimmed(&tokens[i + n..]);
        let rest = &rest[leads(rest, &["as now", "as before", "as they are", "still"]).unwrap_or(0)..];
        *i > 2 && rest.is_empty()
    });
    let Some((i, _)) = found else { return tokens };
    let Some(comma) = (2..i).rev().find(|k| tokens[*k].kind == TokenKind::Comma) else {
        return tokens;
    };
    if !tokens[comma + 1..i]
        .iter()
        .all(|t| is(Some(t), &["on", "in", "at", "the", "all", "still"]))
    {
        return tokens;
    }
    let head = trimmed(&tokens[..comma]);
    let wish = leads(head, WISHES).unwrap_or(0);
    let there = usize::from(is(head.last(), &["there", "here"]));
    let head = &head[wish..head.len() - there];
    let whole = first_noun(head).is_some_and(|x| x.0 < 4 && x.1 == head.len());
    let adds = is(tokens.first(), &["add", "put", "place", "insert", "park"]);
    if adds || !whole || head.first().and_then(number).is_none_or(|n| n < 2) {
        return tokens;
    }
    // ("two more" are told by how many come)
    if is(head.get(1), &["more", "other", "further", "additional", "new"]) || talk.fits(&head[1..]) == 0 {
        return tokens;
    }
    led("keep exactly", &tokens[0], &[head])
}

/// "five, all on the same sidewalk as before": more of a kind stand where the others are anyhow.
fn same_place(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, SAME_PLACE).filter(|x| x.0 > 2) else {
        return tokens;
    };
    let counted = tokens[..i].iter().any(|t| number(t).is_some());
    let closes = tokens.get(i + n).is_none_or(links);
    if !counted || !closes {
        return tokens;
    }
    let comma = usize::from(tokens[i - 1].kind == TokenKind::Comma);
    [&tokens[..i - comma], &tokens[i + n..]].concat()
}

/// "we need twice the firefighters": double them.
fn doubled(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["twice", "double", "triple", "thrice"]) && is(tokens.get(i + 1), &["the"])
    }) else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(links).map_or(0, |k| k + 1);
    let wish = &tokens[from..i];
    let wished = !wish.is_empty()
        && (leads(wish, WISHES) == Some(wish.len())
            || unwrapped(wish).0.is_empty()
            || unwrapped(&tokens[from..]).0.len() + wish.len() == tokens.len() - from);
    let many = first_noun(&tokens[i + 2..]).is_some_and(|x| {
        x.0 < 3 && matches!(look_up(text(&tokens[i + 1 + x.1])), Some(Sense::Noun(_, true)))
    });
    if !wished || !many {
        return tokens;
    }
    let times = if is(tokens.get(i), &["triple", "thrice"]) {
        "triple"
    } else {
        "double"
    };
    [&tokens[..from], &led(times, &tokens[i], &[&tokens[i + 1..]])].concat()
}

/// "I need twice as many cones as there are now": twice as many cones.
fn times_as_many(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let times = is(tokens.get(i), TIMES)
            .then_some(1)
            .or_else(|| (number(&tokens[i]).is_some() && is(tokens.get(i + 1), &["times"])).then_some(2))?;
        let n = leads(
            &tokens[i + times..],
            &["as many", "the number of", "the amount of", "as much"],
        )?;
        let (_, b) = first_noun(&tokens[i + times + n..]).filter(|x| x.0 < 4)?;
        Some((i, i + times + n + b))
    });
    let Some((i, end)) = found else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(links).map_or(0, |k| k + 1);
    let wish = trimmed(&tokens[from..i]);
    let wished = wish.is_empty()
        || leads(wish, WISHES) == Some(wish.len())
        || unwrapped(wish).0.is_empty()
        || wish.iter().all(|t| {
            is(
                Some(t),
                &[
                    "i", "we", "need", "want", "would", "like", "to", "see", "have", "there", "should", "be",
                    "must", "id", "please", "could", "id", "make", "it", "add", "put", "us", "me", "give",
                    "now", "shall", "lets", "show", "exactly",
                ],
            )
        });
    if !wished {
        return tokens;
    }
    let mut rest = &tokens[end..];
    if let Some((k, n)) = find(
        rest,
        &[
            "as there are",
            "as we have",
            "as are there",
            "as now",
            "as before",
            "as you have",
            "as at present",
            "as currently",
            "as today",
            "that there are",
            "as there were",
            "as i have",
            "as are",
            "as it has",
            "as the scene has",
            "as they are",
        ],
    ) && k < 6
    {
        let place = &rest[..k];
        let close = (k + n..rest.len())
            .find(|j| links(&rest[*j]))
            .unwrap_or(rest.len());
        let mut out = tokens[..from].to_vec();
        out.extend_from_slice(&tokens[i..end]);
        out.extend_from_slice(place);
        out.extend_from_slice(&rest[close..]);
        return out;
    }
    rest = &tokens[i..];
    [&tokens[..from], rest].concat()
}

/// True if both name things of one kind.
fn same_kind(a: &[Token], b: &[Token]) -> bool {
    let class = |np: &[Token]| {
        let (i, j) = first_noun(np)?;
        match super::words::longest(&np[i..j]).map(|l| l.0) {
            Some(Sense::Noun(n, _)) => Some(n.classes[0]),
            _ => None,
        }
    };
    class(a).is_some() && class(a) == class(b)
}

/// A noun phrase without the article, quantity and "all".
pub(super) fn bare(np: &[Token]) -> &[Token] {
    let skip = |t: &Token| {
        is(
            Some(t),
            &[
                "the", "my", "these", "those", "all", "our", "of", "both", "some", "more", "a", "an", "few",
                "any", "enough", "other", "further", "up", "out", "down", "in", "away", "number", "another",
            ],
        ) || number(t).is_some()
    };
    &np[np.iter().position(|t| !skip(t)).unwrap_or(0)..]
}

/// "thin out the oncoming cars until only one remains", "add cones to our lane until there are six".
fn until(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, UNTIL).filter(|x| x.0 > 1) else {
        return tokens;
    };
    let mut k = i + n;
    while is(
        tokens.get(k),
        &[
            "only", "just", "exactly", "there", "are", "is", "no", "more", "than", "them",
        ],
    ) {
        k += 1;
    }
    let Some(many) = tokens.get(k).filter(|t| number(t).is_some()).cloned() else {
        return tokens;
    };
    if super::words::is_unit(tokens.get(k + 1)) {
        return tokens;
    }
    let close = (k + 1..tokens.len())
        .find(|j| links(&tokens[*j]))
        .unwrap_or(tokens.len());
    let after = &tokens[k + 1..close];
    let left = find(after, LEFT).or_else(|| find(after, IN_ALL));
    let sure = left.is_some()
        || is(tokens.get(i), &["until", "till", "leaving"])
        || text(&tokens[i + n - 1]) == "of"
        || n > 2 && text(&tokens[i]) == "so";
    let of = left.map_or(after, |x| &after[..x.0]);
    let own = first_noun(of).map(|x| &of[..x.1]);
    let start = tokens[..i]
        .iter()
        .rposition(|t| text(t) == "and" || t.kind == TokenKind::Mark)
        .map_or(0, |s| s + 1);
    let before = trimmed(&tokens[start..i]);
    let Some((a, b)) = first_noun(before).filter(|x| x.0 < 8) else {
        return tokens;
    };
    let verb = before.iter().take(a).any(super::super::rephrase::is_verb);
    // ("remove the cars, leaving two cones" speaks of others)
    if !sure || !verb || own.is_some_and(|o| !same_kind(o, &before[..b])) {
        return tokens;
    }
    let from = before[..a]
        .iter()
        .rposition(|t| {
            super::super::rephrase::is_verb(t)
                && look_up(text(t)).is_none_or(|s| !matches!(s, Sense::State(..)))
        })
        .map_or(0, |v| v + 1);
    let np = bare(&before[from..]);
    let np = match talk.fits(np) {
        0 if !is_place(&before[b.min(before.len())..]) => bare(&before[from..b]),
        _ => np,
    };
    let mut out = tokens[..start].to_vec();
    out.extend(led(
        "keep exactly",
        &tokens[start],
        &[&[many], np, &tokens[close..]],
    ));
    out
}

/// "fill the place up a bit, to eight parked cars in all", "double the cars, so there are four altogether".
fn in_all(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, IN_ALL).filter(|x| x.0 > 0) else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(links).map_or(0, |k| k + 1);
    let clause = &tokens[from..i];
    let Some(k) = clause.iter().position(|t| number(t).is_some()) else {
        return tokens;
    };
    let lead_noun = first_noun(&clause[..k]);
    let own = first_noun(&clause[k..]).map(|x| (k + x.0, k + x.1));
    let closes = tokens.get(i + n).is_none_or(links);
    if !closes || own.is_some_and(|o| o.0 > k + 4) || super::words::is_unit(clause.get(k + 1)) {
        return tokens;
    }
    let many = &clause[k..=k];
    let tail = &tokens[i + n..];
    // whose number it is: named here, or in what is said before
    let np = match (own, lead_noun) {
        (Some(_), _) => {
            // ("cars are parked": parked cars)
            let mut np: Vec<Token> = Vec::new();
            for t in clause[k + 1..].iter().filter(|t| !plain_verb(t)) {
                match is(Some(t), &["parked", "standing", "waiting"])
                    && first_noun(&np).is_some_and(|x| x.1 == np.len())
                {
                    true => np.insert(0, t.clone()),
                    false => np.push(t.clone()),
                }
            }
            np
        }
        (None, Some(_)) => return tokens,
        (None, None) => {
            let before = &tokens[..from];
            let Some((a, b)) = first_noun(before) else {
                // "More cars! Six altogether."
                return match &talk.last {
                    Some(last) if from == 0 => led(
                        "keep exactly",
                        &tokens[0],
                        &[many, &led(last, &tokens[0], &[]), tail],
                    ),
                    _ => tokens,
                };
            };
            let lead = (0..a)
                .rev()
                .take_while(|j| {
                    matches!(
                        look_up(text(&before[*j])),
                        Some(Sense::State(_, false) | Sense::Size(_))
                    ) || is(before.get(*j), &["oncoming", "parked"])
                })
                .last()
                .unwrap_or(a);
            let place = &before[b..];
            let close = place.iter().position(links).unwrap_or(place.len());
            let told = is_place(place) && talk.fits(&before[lead..b + close]) > 0;
            before[lead..if told { b + close } else { b }].to_vec()
        }
    };
    // what leads to that number is no command of its own, if it speaks of the same
    let before = trimmed(&tokens[..from]);
    let same = first_noun(before).is_none() || same_kind(before, &np);
    let kept: &[Token] = if same { &[] } else { &tokens[..from] };
    let mut out = kept.to_vec();
    // "on the crossing should be five children in total"
    let lead = trimmed(&clause[..k]);
    let verb = lead
        .iter()
        .position(|t| HELPERS.contains(&text(t)) || is(Some(t), &["there", "i", "we"]))
        .unwrap_or(0);
    let place = if own.is_some() && is_place(lead) && !is(lead.first(), &["to", "up", "down"]) {
        &lead[..verb]
    } else {
        &[]
    };
    out.extend(led("keep exactly", &tokens[from], &[many, &np, place, tail]));
    out
}

/// "pedestrians in greater number, five of them": five.
fn so_many_of_them(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (2..tokens.len()).find(|i| {
        tokens[i - 1].kind == TokenKind::Comma
            && number(&tokens[*i]).is_some()
            && is(tokens.get(i + 1), &["of"])
            && is(tokens.get(i + 2), &["them", "those", "these"])
            && tokens.get(i + 3).is_none_or(links)
    }) else {
        return tokens;
    };
    let from = tokens[..i - 1].iter().rposition(links).map_or(0, |k| k + 1);
    let Some((a, b)) = first_noun(&tokens[from..i - 1]).map(|x| (from + x.0, from + x.1)) else {
        return tokens;
    };
    let plural = matches!(look_up(text(&tokens[b - 1])), Some(Sense::Noun(_, true)));
    let adds = tokens[from..a].iter().any(|t| {
        super::super::rephrase::is_verb(t) && !is(Some(t), &["i", "we"])
            || is(Some(t), &["the", "more"])
            || number(t).is_some()
    });
    if !plural || adds {
        return tokens;
    }
    let place = &tokens[b..i - 1];
    let place = if is_place(place) && !is(place.first(), &["in"]) {
        place
    } else {
        &[]
    };
    let mut out = tokens[..from].to_vec();
    let fresh = talk.fits(&tokens[a..b]) == 0;
    // ("cones, two of them, behind the truck")
    let rest = &tokens[i + 3..];
    let late = usize::from(rest.first().is_some_and(|t| t.kind == TokenKind::Comma) && is_place(&rest[1..]));
    out.extend(led(
        if fresh { "add" } else { "keep exactly" },
        &tokens[from],
        &[&tokens[i..=i], &tokens[a..b], place, &rest[late..]],
    ));
    out
}

/// Small words that only say that it shall be so.
pub(super) fn plain_verb(t: &Token) -> bool {
    HELPERS.contains(&text(t)) || is(Some(t), &["to", "now", "rather", "better", "nicer", "preferable"])
}
