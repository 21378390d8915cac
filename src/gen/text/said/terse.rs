//! Short notes: "motorcycle = police car", "cones farther: 30 m", "the cars reduced to one", "tow truck in our lane instead of
//! at the kerb", "of the three people one crosses, two wait", "line the cones up along the kerb".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, is_unit, leads, led, number, text, trimmed,
};

const SAME: &str = ", distance stays the same|, the distance stays the same|, distance unchanged|, the distance unchanged|, keeping its distance|, keeping the distance|, the distance remains|, distance remains the same|, the distance is the same as before|, at the distance it has|, just as far away as before|, as far away as before|, as far away as it is now";

const OVER: &str = "across the street at the zebra|across the street at the crossing|across the street on the zebra|across the street on the crossing|across the road at the zebra|across the road at the crossing|across the road on the zebra|across the road on the crossing|over the road at the crossing|over the road at the zebra|over the road on the zebra|over the road on the crossing|across the road at the zebra crossing|across the street at the zebra crossing|on the way over the crossing|on the way across the crossing|on the way over the zebra|on the way across the zebra";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&tokens, SAME, "");
    let out = replaced(&out, OVER, "on the crossing");
    let out = becomes(out, talk);
    let out = range_told(out, talk);
    let out = reduced(out, talk);
    let out = here_not_there(out, talk);
    let out = some_of_group(out, talk);
    lined_up(out, talk)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

fn the(np: &[Token]) -> Vec<Token> {
    if is(
        np.first(),
        &["the", "both", "my", "all", "that", "those", "these"],
    ) {
        np.to_vec()
    } else {
        led("the", &np[0], &[np])
    }
}

/// "motorcycle = police car": the one becomes the other.
fn becomes(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // ("truck -> bus, taxi -> van": each of them)
    let arrows = tokens.iter().filter(|t| is(Some(t), &[":", ">"])).count();
    if let Some(comma) = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]))
        .filter(|_| arrows > 1)
    {
        let one = becomes(tokens[..comma].to_vec(), talk);
        let rest = becomes(tokens[comma + 1..].to_vec(), talk);
        let both = one.len() != comma && rest.len() != tokens.len() - comma - 1;
        return if both {
            [&one, &led("and", &tokens[comma], &[&rest])[..]].concat()
        } else {
            tokens
        };
    }
    let Some(colon) = tokens.iter().position(|t| is(Some(t), &[":", ">"])) else {
        return tokens;
    };
    let (old, new) = (trimmed(&tokens[..colon]), trimmed(&tokens[colon + 1..]));
    let whole = |np: &[Token]| {
        let ends = |b: usize| {
            b == np.len() || np.as_ptr() == old.as_ptr() && is_place(&np[b..]) && !has_noun(&np[b..])
        };
        first_noun(np).is_some_and(|x| x.0 < 3 && ends(x.1))
            && !np.iter().any(|t| number(t).is_some_and(|n| n != 1))
    };
    let fresh = !is(new.first(), &["the", "both", "my", "all", "that", "no"]);
    if !whole(old)
        || !whole(new)
        || !fresh
        || talk.fits(old) != 1
        || is(old.first(), &["a", "an", "another", "no"])
    {
        return tokens;
    }
    let a = if is(new.first(), &["a", "an", "one"]) {
        "with"
    } else {
        "with a"
    };
    led(
        "replace",
        &tokens[0],
        &[&the(old), &led(a, &tokens[colon], &[new])],
    )
}

/// "motorcycle closer: 5 m", "cones farther away: 30 m": that is how far they are then.
fn range_told(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens.iter().position(|t| text(t) == ":").filter(|c| *c > 1) else {
        return tokens;
    };
    let words = trimmed(&tokens[..colon]);
    let Some((_, b)) = first_noun(words).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let way = leads(
        &words[b..],
        &[
            "closer",
            "nearer",
            "farther",
            "further",
            "farther away",
            "further away",
            "farther off",
            "further off",
            "distance",
            "closer to us",
            "nearer to us",
            "farther from us",
            "further from us",
            "farther away from us",
            "further away from us",
        ],
    );
    let metres = tokens.get(colon + 1).is_some_and(|t| number(t).is_some())
        && is_unit(tokens.get(colon + 2))
        && ends(tokens.get(colon + 3));
    if way != Some(words.len() - b) || !metres || talk.fits(&words[..b]) == 0 {
        return tokens;
    }
    let keep = led(
        "should keep a distance of",
        &tokens[colon],
        &[&tokens[colon + 1..]],
    );
    [&the(&words[..b])[..], &keep].concat()
}

/// "the cars reduced to one": one of them.
fn reduced(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const DOWN: &[&str] = &[
        "reduced to",
        "cut to",
        "cut down to",
        "brought down to",
        "thinned to",
        "thinned out to",
        "down to",
        "limited to",
        "reduced down to",
        "decimated to",
        "increased to",
        "raised to",
        "brought up to",
        "topped up to",
        "doubled to",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let helped = leads(
            &tokens[i..],
            &[
                "are",
                "is",
                "should be",
                "have been",
                "to be",
                "shall be",
                "must be",
                "get",
                "are to be",
            ],
        )
        .unwrap_or(0);
        let n = leads(&tokens[i + helped..], DOWN)?;
        let many = i + helped + n;
        let many = many + usize::from(is(tokens.get(many), &["just", "only", "a"]));
        (tokens.get(many).is_some_and(|t| number(t).is_some()) && ends(tokens.get(many + 1))).then_some(())?;
        let from = tokens[..i]
            .iter()
            .rposition(|t| ends(Some(t)) || is(Some(t), &["and", "but"]))
            .map_or(0, |k| k + 1);
        let np = &tokens[from..i];
        let (_, b) = first_noun(np).filter(|x| x.0 < 4)?;
        let plain = !super::super::rephrase::is_verb(&np[0]) && !np.iter().any(|t| number(t).is_some());
        (plain && (b == np.len() || is_place(&np[b..])) && talk.fits(np) > 0).then_some((from, i, many))
    });
    match found {
        Some((from, i, many)) => {
            let np: Vec<Token> = tokens[from..i]
                .iter()
                .filter(|t| !is(Some(t), &["the", "my", "all", "these", "those"]))
                .cloned()
                .collect();
            let keep = led("keep exactly", &tokens[from], &[&tokens[many..=many], &np]);
            [&tokens[..from], &keep, &tokens[many + 1..]].concat()
        }
        None => tokens,
    }
}

/// "tow truck in our lane instead of at the kerb": there, not here.
fn here_not_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["instead of", "rather than", "and not", "not"]).filter(|x| x.0 > 2)
    else {
        return tokens;
    };
    let close = (i + n..tokens.len())
        .find(|k| ends(tokens.get(*k)))
        .unwrap_or(tokens.len());
    let not = &tokens[i + n..close];
    let as_far = find(&tokens, &["same distance"]).is_some();
    if !is_place(not) || has_noun(not) || as_far || is(not.first(), &["to", "by"]) {
        return tokens;
    }
    let head = trimmed(&tokens[..i]);
    let Some((_, b)) = first_noun(head).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let verb = super::super::rephrase::is_verb(&head[0]) && super::words::noun_at(head).is_none()
        || head
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    let place = &head[b..];
    if verb
        || !is_place(place)
        || has_noun(place)
        || talk.fits(&head[..b]) != 1
        || is(head.first(), &["a", "an", "another", "one"])
    {
        return tokens;
    }
    led("move", &tokens[0], &[&the(&head[..b]), place, &tokens[close..]])
}

/// "of the three people one crosses, two wait": one of them does; "of the cars I need only half".
fn some_of_group(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "of the",
            "of these",
            "of those",
            "out of the",
            "from the",
            "of our",
            "of my",
        ],
    ) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &tokens[n..n + b];
    let mut k = n + b;
    k += usize::from(tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma));
    let rest = &tokens[k..];
    let there = talk.fits(&np[a..]);
    let bare = &np[usize::from(np.first().is_some_and(|t| number(t).is_some()))..];
    let half = find(
        rest,
        &[
            "only half of them",
            "just half of them",
            "half of them",
            "only half",
            "just half",
            "only a half",
            "half",
        ],
    )
    .filter(|x| x.0 < 5);
    if let Some((i, m)) = half
        && !has_noun(rest)
        && there > 1
    {
        let lead = &rest[..i];
        let tail = trimmed(&rest[i + m..]);
        let goes = lead.iter().any(|t| super::some_of::removes(Some(t)))
            || tail.iter().any(|t| {
                is(
                    Some(t),
                    &["go", "goes", "gone", "leave", "left", "away", "out", "disappear"],
                )
            });
        let keeps = lead
            .iter()
            .any(|t| is(Some(t), &["need", "want", "keep", "leave", "require", "like"]))
            || tail.iter().any(|t| {
                is(
                    Some(t),
                    &["stay", "stays", "remain", "remains", "enough", "needed"],
                )
            });
        if goes != keeps {
            return led("half the number of", &tokens[0], &[bare]);
        }
    }
    // "one is on the zebra, two still wait"
    let Some(many) = rest
        .first()
        .and_then(number)
        .filter(|m| *m >= 1 && (*m as usize) < there)
    else {
        return tokens;
    };
    let verb = rest
        .get(1)
        .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), many > 1));
    if !verb {
        return tokens;
    }
    let close = rest
        .iter()
        .position(|t| t.kind == TokenKind::Comma || is(Some(t), &["and", "while"]))
        .unwrap_or(rest.len());
    let tail = trimmed(rest.get(close + 1..).unwrap_or_default());
    let still = tail
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["the"]))
        && tail.len() < 7
        && tail.iter().any(|t| {
            is(
                Some(t),
                &[
                    "stay", "stays", "remain", "remains", "wait", "waits", "stand", "still",
                ],
            )
        })
        && !has_noun(tail)
        && !tail
            .iter()
            .any(|t| super::words::is_goal(std::slice::from_ref(t)));
    let whose = led("of the", &tokens[0], &[bare]);
    let tail: &[Token] = if still { &[] } else { &rest[close..] };
    [&rest[..1], &whose, &rest[1..close], tail].concat()
}

/// "line the cones up along the kerb": put them there.
fn lined_up(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(
        tokens.first(),
        &[
            "line",
            "range",
            "arrange",
            "spread",
            "distribute",
            "string",
            "align",
            "stack",
            "pile",
            "rank",
        ],
    ) {
        return tokens;
    }
    let from = 1 + usize::from(is(tokens.get(1), &["up", "out"]));
    let Some((_, b)) = first_noun(&tokens[from..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np = &tokens[from..from + b];
    let k = from + b + usize::from(is(tokens.get(from + b), &["up", "out"]));
    let at = is(tokens.get(k), &["along", "on", "at", "in", "beside", "down"]);
    if !at || !is(np.first(), &["the", "all", "both", "my", "these", "those"]) || talk.fits(np) == 0 {
        return tokens;
    }
    let place = match text(&tokens[k]) {
        "along" | "down" => led("on", &tokens[k], &[&tokens[k + 1..]]),
        _ => tokens[k..].to_vec(),
    };
    led("move", &tokens[0], &[np, &place])
}
