//! Who is there, in roundabout words: "the street to ourselves", "a crowd has gathered: six people, counting the officer",
//! "with the bus as the only exception", "without the cones and without the van".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const OURSELVES: &[&str] = &[
    "the street to ourselves",
    "the road to ourselves",
    "the street to myself",
    "the road to myself",
    "the street all to ourselves",
    "the road all to ourselves",
    "the street all to myself",
    "the road all to myself",
    "the whole street to ourselves",
    "the whole road to ourselves",
    "the whole street to myself",
    "the whole road to myself",
    "the place to ourselves",
];
const QUEUED: &str =
    "in the queue|in the line|in line|in the row|in the column|in the convoy|in the string|in the file";
const ACROSS: &str = "from the sidewalk they are on over to the one across the road|from the sidewalk they are on to the one across the road|over to the sidewalk across the road|over to the one across the road|over to the one on the other side|over to the one opposite|to the one across the road|to the one across the street|over to the one across the street";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = only_exception(tokens);
    let out = ourselves(out, talk);
    let out = queued(out);
    let out = superlative_after(out);
    let out = without_both(out);
    let out = crowd(out);
    let out = counting(out, talk);
    across(out)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

/// "with the truck as the only exception", "the truck being the only exception", "the truck excepted": except the truck.
fn only_exception(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "as the only exception",
            "as the sole exception",
            "as an exception",
            "as the one exception",
            "being the only exception",
            "being the sole exception",
            "being the exception",
            "is the only exception",
            "is the sole exception",
            "are the only exception",
            "are the only exceptions",
            "as the only exceptions",
            "being the only exceptions",
            "excepted",
            "exempted",
            "excluded",
            "as exception",
            "is the one exception",
        ],
    )
    .filter(|x| x.0 > 3) else {
        return swapped_exception(tokens);
    };
    let Some(from) = (1..i)
        .rev()
        .find(|k| ends(tokens.get(*k)) || is(tokens.get(*k), &["with", "and", "but"]))
    else {
        return tokens;
    };
    let np = &tokens[from + 1..i];
    let closed = ends(tokens.get(i + n));
    if !closed
        || !is(
            np.first(),
            &["the", "my", "that", "those", "these", "both", "our"],
        )
        || first_noun(np).is_none_or(|x| x.0 > 4)
    {
        return tokens;
    }
    let head = trimmed(&tokens[..from]);
    let head = if is(head.last(), &["with"]) {
        trimmed(&head[..head.len() - 1])
    } else {
        head
    };
    let except = led("except", &tokens[from], &[np]);
    [head, &except, &tokens[i + n..]].concat()
}

/// "the only exception is the truck", "the only exception: the truck".
fn swapped_exception(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "the only exception is",
            "the only exception being",
            "the only exception :",
            "only exception :",
            "the sole exception is",
            "with the only exception of",
            "with the sole exception of",
            "the only exceptions are",
            "the only exceptions being",
        ],
    )
    .filter(|x| x.0 > 2) else {
        return tokens;
    };
    let np = &tokens[i + n..];
    if !is(
        np.first(),
        &["the", "my", "that", "those", "these", "both", "our"],
    ) {
        return tokens;
    }
    let except = led("except", &tokens[i], &[np]);
    [trimmed(&tokens[..i]), &except].concat()
}

/// "I'd like the street to ourselves, apart from the bus": all that drives there goes, but the bus.
fn ourselves(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, OURSELVES) else {
        return tokens;
    };
    if has_noun(&tokens[..i]) {
        return tokens;
    }
    let rest = trimmed(&tokens[i + n..]);
    let but = leads(
        rest,
        &[
            "apart from",
            "except for",
            "except",
            "but for",
            "save for",
            "aside from",
            "other than",
            "besides",
            "bar",
        ],
    );
    let all: Vec<&str> = [("bicycle", "all bicycles"), ("vehicle", "all motor vehicles")]
        .into_iter()
        .filter(|(one, _)| talk.fits(&led(one, &tokens[i], &[])) > 0)
        .map(|x| x.1)
        .collect();
    if all.is_empty() || but.is_none() && !rest.is_empty() {
        return tokens;
    }
    let remove = led(&format!("remove {}", all.join(" and ")), &tokens[i], &[]);
    match but {
        Some(n) => [&remove[..], &led("except", &tokens[i], &[&rest[n..]])].concat(),
        None => remove,
    }
}

/// "of the three cars in the queue", "the third car in line": that they queue says nothing more.
fn queued(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = QUEUED
        .split('|')
        .filter_map(|p| find(&tokens, &[p]))
        .min_by_key(|x| x.0)
        .filter(|x| x.0 > 1)
    else {
        return tokens;
    };
    let noun = (1..=3.min(i)).any(|k| first_noun(&tokens[i - k..i]).is_some_and(|x| x.1 == k));
    let ordinal = tokens[..i].iter().rev().take(4).any(|t| {
        super::super::foremost::ordinal(text(t)).is_some() || is(Some(t), &["middle", "first", "last", "of"])
    });
    let group = leads(&tokens, &["of the", "out of the", "from the"]).is_some();
    // "the cars in line" alone may tell them from others
    if noun && (ordinal || group) && !is(tokens.get(i + n), &["with", "behind", "of"]) {
        return [&tokens[..i], &tokens[i + n..]].concat();
    }
    tokens
}

/// "the car farthest away from us": the farthest car.
fn superlative_after(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        let far = is(tokens.get(i), &["farthest", "furthest", "nearest", "closest"]);
        far.then_some(())?;
        let mut end = i + 1 + usize::from(is(tokens.get(i + 1), &["away", "off"]));
        if is(tokens.get(end), &["from", "to"]) {
            is(tokens.get(end + 1), &["us", "me"]).then_some(())?;
            end += 2;
        }
        let that = is(tokens.get(i - 1), &["is"]) && is(tokens.get(i.wrapping_sub(2)), &["that", "which"]);
        let close = if that { i - 2 } else { i };
        let a = (1..=3.min(close)).find(|k| first_noun(&tokens[close - k..close]) == Some((0, *k)))?;
        let noun = close - a;
        is(tokens.get(noun.wrapping_sub(1)), &["the", "that"]).then_some((i, end, noun, close))
    });
    match found {
        Some((i, end, noun, close)) => [
            &tokens[..noun],
            &tokens[i..=i],
            &tokens[noun..close],
            &tokens[end..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "without any barriers and without the van": both go.
fn without_both(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (2..tokens.len())
        .find(|i| is(tokens.get(*i), &["without"]) && is(tokens.get(i - 1), &["and", "but"]))
    else {
        return tokens;
    };
    let first = tokens[..i].iter().any(|t| text(t) == "without");
    let definite = is(
        tokens.get(i + 1),
        &["the", "that", "those", "these", "any", "all", "both", "my", "our"],
    );
    if !first || !definite || first_noun(&tokens[i + 1..]).is_none_or(|x| x.0 > 4) {
        return tokens;
    }
    let any = usize::from(is(tokens.get(i + 1), &["any"]));
    let remove = led(
        if any == 1 { "remove all the" } else { "remove" },
        &tokens[i],
        &[&tokens[i + 1 + any..]],
    );
    [&tokens[..i], &remove].concat()
}

/// "a small crowd has gathered on the left sidewalk: six people": six people are there.
fn crowd(tokens: Vec<Token>) -> Vec<Token> {
    const CROWDS: &[&str] = &[
        "crowd",
        "group",
        "bunch",
        "cluster",
        "gathering",
        "troop",
        "party",
        "throng",
        "queue",
        "line",
        "row",
        "team",
        "gang",
    ];
    let Some(colon) = (3..tokens.len()).find(|k| text(&tokens[*k]) == ":") else {
        return tokens;
    };
    let head = &tokens[..colon];
    let Some(c) = head.iter().take(5).position(|t| CROWDS.contains(&text(t))) else {
        return tokens;
    };
    let fresh =
        is(head.first(), &["a", "another"]) && !head[..c].iter().any(|t| number(t).is_some_and(|n| n > 1));
    let Some(place) =
        (c + 1..colon).find(|k| is_place(&head[*k..]) && !is(head.get(*k), &["up", "out", "off"]))
    else {
        return tokens;
    };
    let rest = &tokens[colon + 1..];
    let Some((_, b)) =
        first_noun(rest).filter(|x| x.0 < 4 && rest.first().is_some_and(|t| number(t).is_some()))
    else {
        return tokens;
    };
    if !fresh || is_place(&rest[b..]) {
        return tokens;
    }
    led("there are", &tokens[0], &[&rest[..b], &head[place..], &rest[b..]])
}

/// "six people on the left, counting the officer": five, where the officer is one.
fn counting(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["counting", "including", "inclusive of"]).filter(|x| x.0 > 2) else {
        return tokens;
    };
    let np = &tokens[i + n..];
    if !is(np.first(), &["the", "my", "that", "those", "these", "both"]) || !ends(tokens.get(i - 1)) {
        return tokens;
    }
    // "the two who are there": all that are
    let there = np
        .iter()
        .position(|t| matches!(text(t), "there" | "existing" | "present" | "have"))
        .filter(|k| {
            *k < 7
                && np[..*k]
                    .iter()
                    .any(|t| number(t).is_some() || is(Some(t), &["one", "ones", "those"]))
                && !has_noun(&np[..*k])
        });
    let b = match (first_noun(np).filter(|x| x.0 < 4), there) {
        (_, Some(k)) => k + 1,
        (Some(x), _) => x.1,
        _ => return tokens,
    };
    let close = (b..np.len())
        .find(|k| ends(np.get(*k)) || is(np.get(*k), &["and"]))
        .unwrap_or(np.len());
    let from = tokens[..i]
        .iter()
        .take(i - 1)
        .rposition(|t| ends(Some(t)) || is(Some(t), &["and"]))
        .map_or(0, |k| k + 1);
    let clause = &tokens[from..i];
    let Some(k) = clause.iter().position(|t| number(t).is_some_and(|n| n > 1)) else {
        return tokens;
    };
    let Some((_, e)) = first_noun(&clause[k..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let place = trimmed(&clause[k + e..]);
    let many = number(&clause[k]).unwrap_or(0).max(0) as usize;
    let old = if there.is_some() {
        talk.fits(&clause[k + 1..k + e])
    } else {
        talk.fits(&np[..close])
    };
    if old == 0 || many < old || !(place.is_empty() || is_place(place)) {
        return tokens;
    }
    let what = [&clause[k + 1..k + e], place].concat();
    let mut out = tokens[..from].to_vec();
    if talk.fits(&what) >= old {
        out.extend(led("keep exactly", &tokens[from], &[&clause[k..=k], &what]));
    } else {
        let more = Token {
            kind: TokenKind::Number((many - old) as f64),
            text: (many - old).to_string(),
            span: clause[k].span,
        };
        out.extend(led("add", &tokens[from], &[&[more], &what]));
    }
    out.extend_from_slice(&np[close..]);
    out
}

/// "over to the one across the road": to the other sidewalk.
fn across(tokens: Vec<Token>) -> Vec<Token> {
    let out = replaced(&tokens, ACROSS, "to the other sidewalk");
    // "from the sidewalk they are on to the other sidewalk"
    match (
        find(
            &out,
            &[
                "from the sidewalk",
                "from the pavement",
                "from their sidewalk",
                "from their pavement",
            ],
        ),
        find(&out, &["to the other sidewalk"]),
    ) {
        (Some((i, _)), Some((k, _))) if i > 1 && k > i => [&out[..i], &out[k..]].concat(),
        _ => out,
    }
}
