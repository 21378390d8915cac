//! So many are wanted: "not two but four", "four would be better than two", "three are not enough, we need six", "must not exceed
//! three".

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::totals::{bare, links, plain_verb};
use super::words::{find, first_noun, is, is_place, leads, led, number, text, trimmed};

/// "not two but four people should be walking across": four.
pub(super) fn not_but(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["not"]).then_some(())?;
        let only = usize::from(is(tokens.get(i + 1), &["only", "just"]));
        tokens.get(i + 1 + only).filter(|t| number(t).is_some())?;
        let but = (i + 2 + only..tokens.len().min(i + 7 + only)).find(|k| is(tokens.get(*k), &["but"]))?;
        let many = but + 1 + usize::from(is(tokens.get(but + 1), &["rather"]));
        tokens.get(many).filter(|t| number(t).is_some())?;
        Some((i, but, many))
    });
    let Some((i, but, many)) = found else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(links).map_or(0, |k| k + 1);
    let close = (many..tokens.len())
        .find(|j| links(&tokens[*j]))
        .unwrap_or(tokens.len());
    let own = first_noun(&tokens[many..close]).filter(|x| x.0 < 4);
    let old = first_noun(&tokens[i..but]);
    let mut np: Vec<Token> = match (own, old) {
        (Some(_), _) => tokens[many + 1..close].to_vec(),
        (None, Some((a, b))) => [&tokens[i + a..i + b], &tokens[many + 1..close]].concat(),
        _ => return tokens,
    };
    np.retain(|t| !plain_verb(t));
    let mut out = tokens[..from].to_vec();
    out.extend(led(
        "keep exactly",
        &tokens[from],
        &[&tokens[many..=many], &np, &tokens[close..]],
    ));
    out
}

/// "behind us there should be one car only": one there.
pub(super) fn place_then_only(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "there should be",
            "there must be",
            "there shall be",
            "should be",
            "there ought to be",
            "i want",
            "i need",
            "there are to be",
            "there may be",
        ],
    )
    .filter(|x| x.0 > 0) else {
        return tokens;
    };
    let place = &tokens[..i];
    let k = i + n + usize::from(is(tokens.get(i + n), &["only", "just", "exactly"]));
    let many = tokens.get(k).filter(|t| number(t).is_some());
    let Some((_, b)) = tokens.get(k..).and_then(first_noun).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let only = k > i + n || is(tokens.get(k + b), &["only"]);
    let end = k + b + usize::from(is(tokens.get(k + b), &["only"]));
    let placed = is_place(place) && first_noun(place).is_none() && !place.iter().any(links);
    let np = tokens.get(k + 1..k + b).unwrap_or(&[]);
    match many {
        Some(many)
            if only
                && placed
                && tokens.get(end).is_none_or(links)
                && talk.fits(&[np, place].concat()) > 0 =>
        {
            led(
                "keep exactly",
                &tokens[0],
                &[std::slice::from_ref(many), np, place, &tokens[end..]],
            )
        }
        _ => tokens,
    }
}

/// "the number of cars must not exceed three": three, if there are more.
pub(super) fn exceeds(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "must not exceed",
            "should not exceed",
            "may not exceed",
            "shall not exceed",
            "mustnt exceed",
            "shouldnt exceed",
            "must not be more than",
            "should not be more than",
            "is limited to",
            "should be limited to",
            "must be limited to",
        ],
    )
    .filter(|x| x.0 > 0) else {
        return tokens;
    };
    let np = bare(&tokens[..i]);
    let many = tokens.get(i + n).filter(|t| number(t).is_some());
    match many {
        Some(many)
            if first_noun(np).is_some_and(|x| x.0 < 4)
                && talk.fits(np) > number(many).unwrap_or(0).max(0) as usize =>
        {
            led(
                "keep exactly",
                &tokens[0],
                &[std::slice::from_ref(many), np, &tokens[i + n + 1..]],
            )
        }
        _ => tokens,
    }
}

/// "five children would be nicer": five.
pub(super) fn nicer(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let counted = tokens
        .first()
        .is_some_and(|t| number(t).is_some_and(|n| n > 1) || text(t) == "one");
    // "three pedestrians fewer would be good"
    if counted
        && tokens
            .iter()
            .any(|t| matches!(text(t), "fewer" | "less" | "more"))
        && let Some((i, n)) = find(
            &tokens,
            &[
                "would be good",
                "would be nice",
                "would be better",
                "would be fine",
                "would be great",
                "would be welcome",
                "would be nicer",
                "would do",
            ],
        )
        && i + n == tokens.len()
    {
        return tokens[..i].to_vec();
    }
    let Some((_, b)) = first_noun(&tokens).filter(|x| counted && x.0 < 4) else {
        return tokens;
    };
    let Some((i, n)) = find(
        &tokens[b..],
        &[
            "would be nicer",
            "would be better",
            "would be preferable",
            "would be nice",
            "would be fine",
            "would be ideal",
            "would be right",
            "would be perfect",
            "would be more realistic",
            "would look better",
            "would be good",
        ],
    ) else {
        return tokens;
    };
    let place = &tokens[b..b + i];
    let ends = tokens.get(b + i + n).is_none_or(links);
    if !ends || !(place.is_empty() || is_place(place)) || talk.fits(&tokens[1..b]) == 0 {
        return tokens;
    }
    led(
        "keep exactly",
        &tokens[0],
        &[&tokens[..b + i], &tokens[b + i + n..]],
    )
}

/// "three cones is not enough, we need at least six": six.
pub(super) fn not_enough(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "is not enough",
            "are not enough",
            "isnt enough",
            "arent enough",
            "is too few",
            "are too few",
            "is insufficient",
            "are insufficient",
            "will not do",
            "wont do",
            "are too many",
            "is too many",
            "is too much",
            "are too much",
            "does not suffice",
            "do not suffice",
            "is a lot",
            "are a lot",
        ],
    ) else {
        return tokens;
    };
    let np = &tokens[..i];
    let known = is(np.first(), &["the", "these", "those", "only", "just", "my"])
        || np.first().is_some_and(|t| number(t).is_some());
    let rest = trimmed(&tokens[i + n..]);
    // ("there should be eight" may follow in a sentence of its own)
    if rest.is_empty()
        && !np.iter().any(links)
        && known
        && first_noun(np).is_some_and(|x| x.0 < 4)
        && talk.fits(bare(np)) > 0
    {
        return super::gifts::remark(bare(np));
    }
    let Some(k) = rest
        .iter()
        .take(6)
        .position(|t| number(t).is_some() && !is(Some(t), &["a", "an"]))
    else {
        return tokens;
    };
    let lead = rest[..k].iter().all(|t| {
        is(
            Some(t),
            &[
                "we", "i", "need", "want", "at", "least", "make", "it", "there", "should", "be", "let", "id",
                "like", "would", "use", "have", "rather", "give", "me", "please", "exactly", "a", "total",
                "of", "must", "say", "only", "just", "keep", "leave",
            ],
        )
    });
    // ("two of them near the car": where they are may be said, too)
    let of_them =
        2 * usize::from(is(rest.get(k + 1), &["of"]) && is(rest.get(k + 2), &["them", "these", "those"]));
    let place = rest.get(k + 1 + of_them..).unwrap_or(&[]);
    let placed = of_them > 0 && is_place(place) && !place.iter().any(|t| t.kind == TokenKind::Comma);
    let own = if placed { None } else { first_noun(&rest[k..]) };
    let ends = rest.get(k + 1).is_none_or(|t| {
        links(t)
            || is(
                Some(t),
                &["would", "will", "are", "is", "instead", "please", "of", "should"],
            )
    });
    if !known || !lead || first_noun(np).is_none_or(|x| x.0 > 4) || own.is_some() || !ends {
        return tokens;
    }
    let place = if placed { place } else { &[] };
    let mut who = bare(np).to_vec();
    if placed
        && let Some(last) = who.last_mut()
        && number(&rest[k]) != Some(1)
        && matches!(look_up(text(last)), Some(Sense::Noun(_, false)))
    {
        last.text = plural(text(last));
    }
    led("keep exactly", &tokens[0], &[&rest[k..=k], &who, place])
}

/// "the parked cars go from two to four", "the cones drop to three".
pub(super) fn from_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let known = is(tokens.first(), &["the", "our", "my", "these", "those"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| known && x.0 < 7) else {
        return tokens;
    };
    let grows = (b..tokens.len().min(b + 9)).find(|k| {
        is(
            tokens.get(*k),
            &[
                "go",
                "goes",
                "rise",
                "rises",
                "increase",
                "increases",
                "grow",
                "grows",
                "drop",
                "drops",
                "fall",
                "falls",
                "shrink",
                "shrinks",
                "climb",
                "climbs",
                "sink",
                "sinks",
                "decrease",
                "decreases",
                "reduced",
                "increased",
                "raised",
                "lowered",
                "cut",
                "number",
                "amount",
                "come",
                "limited",
                "rising",
                "went",
                "gone",
            ],
        )
    });
    let Some(v) = grows else {
        return tokens;
    };
    let mut k = v + 1;
    k += usize::from(is(tokens.get(k), &["up", "down", "back"]));
    let mut ranged = false;
    if is(tokens.get(k), &["from"]) && tokens.get(k + 1).is_some_and(|t| number(t).is_some()) {
        k += 2;
        ranged = true;
    }
    let to = is(tokens.get(k), &["to"]);
    let num = k + usize::from(to);
    let num = num + usize::from(is(tokens.get(num), &["just", "only", "exactly"]));
    let counts = is(tokens.get(v), &["number", "amount"]) && !to;
    let many = tokens.get(num).filter(|t| number(t).is_some() && (to || counts));
    let ends = tokens.get(num + 1).is_none_or(links);
    let strays = is(
        tokens.get(v),
        &[
            "go", "goes", "come", "went", "gone", "drop", "drops", "fall", "falls", "cut",
        ],
    ) && !ranged
        && first_noun(&tokens[..b]).is_some_and(|_| !tokens[..v].iter().any(|t| text(t) == "number"));
    let Some(many) = many.filter(|_| ends && !strays) else {
        return tokens;
    };
    let mut np = tokens[..v].to_vec();
    while np.last().is_some_and(plain_verb) {
        np.pop();
    }
    let np = bare(&np).to_vec();
    if talk.fits(&np) == 0 {
        return tokens;
    }
    led(
        "keep exactly",
        &tokens[0],
        &[std::slice::from_ref(many), &np, &tokens[num + 1..]],
    )
}

/// "five parked cars would be better than three", "I'd rather have four on the right than two".
pub(super) fn rather_than(tokens: Vec<Token>) -> Vec<Token> {
    let prefers = tokens.iter().any(|t| {
        matches!(
            text(t),
            "better" | "rather" | "prefer" | "nicer" | "preferable" | "sooner" | "preferred"
        )
    });
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], &["rather than", "than", "to", "over", "instead of"])?;
        let n = n + usize::from(is(tokens.get(i + n), &["only", "just", "the"]));
        let few = tokens.get(i + n).filter(|t| number(t).is_some())?;
        let of = leads(
            &tokens[i + n + 1..],
            &["of them", "of those", "as now", "as before"],
        )
        .unwrap_or(0);
        let end = i + n + 1 + of;
        // ("two cars rather than one have to be in the left lane")
        let goes_on = tokens
            .get(end)
            .is_none_or(|t| links(t) || super::lists::HELPERS.contains(&text(t)));
        (text(few) != "a" && goes_on).then_some((i, end))
    });
    let Some((i, end)) = found.filter(|_| prefers) else {
        return tokens;
    };
    let from = tokens[..i].iter().rposition(links).map_or(0, |k| k + 1);
    let Some(many) =
        (from..i).find(|k| number(&tokens[*k]).is_some() && !super::words::is_unit(tokens.get(k + 1)))
    else {
        return tokens;
    };
    if first_noun(&tokens[from..many]).is_some() || first_noun(&tokens[many..i]).is_none_or(|x| x.0 > 4) {
        return tokens;
    }
    let np: Vec<Token> = tokens[many + 1..i]
        .iter()
        .filter(|t| !plain_verb(t))
        .cloned()
        .collect();
    // "behind us there have to be two rather than one": two there
    let lead = &tokens[from..many];
    let verb = lead
        .iter()
        .position(|t| plain_verb(t) || is(Some(t), &["there", "i", "we", "id", "wed"]))
        .unwrap_or(lead.len());
    let place = if is_place(&lead[..verb]) {
        &lead[..verb]
    } else {
        &[]
    };
    let helped = tokens[end..].iter().take_while(|t| plain_verb(t)).count();
    // ("... should ride behind us")
    let rides = tokens
        .get(end + helped)
        .is_some_and(|t| helped > 0 && super::words::is_finite(text(t), true));
    let end = end + helped + usize::from(rides && is_place(&tokens[end + helped + 1..]));
    // ("... should follow us")
    let after = leads(
        &tokens[end..],
        &["follow us", "follow me", "following us", "following me"],
    );
    let behind = led("behind us", &tokens[from], &[]);
    let (end, place) = match after {
        Some(n) => (end + n, &behind[..]),
        None => (end, place),
    };
    let mut out = tokens[..from].to_vec();
    out.extend(led(
        "keep exactly",
        &tokens[from],
        &[&tokens[many..=many], &np, place, &tokens[end..]],
    ));
    out
}
