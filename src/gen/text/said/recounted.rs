//! What is told by way of something else: "not come towards us but drive behind us", "what bothers me is the bus", "three instead
//! of two", "has swapped his car for a bus", "use a bus where the car is", "it's the bus that drives ahead of us".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::mistaken::{WHICH, kind};
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = so_many_instead(what_bothers(not_this_but(in_exchange(tokens))));
    own_swapped(&out, talk)
        .or_else(|| where_it_is(&out, talk))
        .or_else(|| made_out_of(&out, talk))
        .unwrap_or_else(|| the_one_that(out, talk))
}

/// "in exchange for", "in return for": instead of.
fn in_exchange(tokens: Vec<Token>) -> Vec<Token> {
    super::super::wording::replaced(
        &tokens,
        "in exchange for|in return for|in trade for|as a swap for|in swap for|in exchange against",
        "instead of",
    )
}

/// "the driver behind us has swapped his car for a bus", "the cyclist gets a moped instead of the bicycle".
fn own_swapped(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    // "give the cyclist a moped instead of the bicycle"
    let give = usize::from(is(tokens.first(), &["give", "hand"]));
    let rest = &tokens[give..];
    is(rest.first(), &["the", "that", "our", "my"]).then_some(())?;
    let (_, b) = first_noun(rest).filter(|x| x.0 < 4)?;
    let verb = (b..rest.len().min(b + 7)).find(|k| {
        is(
            rest.get(*k),
            &[
                "swapped",
                "swaps",
                "exchanged",
                "exchanges",
                "traded",
                "trades",
                "swap",
                "exchange",
                "trade",
                "gets",
                "get",
                "got",
                "receives",
                "rides",
                "drives",
                "takes",
                "has",
                "a",
            ],
        ) && (give == 1 && *k == b) == (text(&rest[*k]) == "a")
            && !(is(rest.get(*k), &["has"])
                && is(rest.get(k + 1), &["swapped", "exchanged", "traded", "got"]))
    })?;
    let np = trimmed(&rest[..verb]);
    let helpers = np[b.min(np.len())..]
        .iter()
        .all(|t| is(Some(t), &["has", "have", "should", "must", "now", "just", "can"]))
        || np.get(b..).is_some_and(is_place);
    let np: Vec<Token> = np
        .iter()
        .filter(|t| !is(Some(t), &["has", "have", "should", "must", "now", "just", "can"]))
        .cloned()
        .collect();
    let swaps = text(&rest[verb]).starts_with("swap")
        || text(&rest[verb]).starts_with("exchange")
        || text(&rest[verb]).starts_with("trade");
    let own = |t: Option<&Token>| is(t, &["his", "her", "their", "its", "the"]);
    let after = &rest[verb + usize::from(give == 0)..];
    let new = if swaps {
        own(after.first()).then_some(())?;
        let k = after
            .iter()
            .position(|t| is(Some(t), &["for", "against", "with"]))?;
        (1..5).contains(&k).then_some(())?;
        &after[k + 1..]
    } else {
        let (i, n) = find(after, &["instead of", "rather than", "in place of"])?;
        own(after.get(i + n)).then_some(())?;
        let (_, e) = first_noun(&after[i + n..]).filter(|x| x.0 < 3)?;
        trimmed(&after[i + n + e..]).is_empty().then_some(())?;
        &after[..i]
    };
    let new = trimmed(new);
    // (a driver is in what he gives away)
    let np = match first_noun(after).filter(|x| swaps && x.0 == 1) {
        Some(own) if is(rest.get(b - 1), &["driver", "motorist", "man", "woman", "person"]) => {
            [&rest[..1], &after[1..own.1], &np[b.min(np.len())..]].concat()
        }
        _ => np,
    };
    let (_, d) = kind(new).filter(|x| x.1 == new.len())?;
    (helpers && is(new.first(), &["a", "an"]) && talk.fits(&np) > 0).then(|| {
        led(
            "replace",
            &tokens[0],
            &[&np, &led("with", &tokens[0], &[&new[..d]])],
        )
    })
}

/// "make barriers out of the cones".
fn made_out_of(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    is(tokens.first(), &["make", "create", "form", "build"]).then_some(())?;
    let (_, b) = first_noun(&tokens[1..]).filter(|x| x.0 < 3)?;
    let new = &tokens[1..1 + b];
    let n = leads(&tokens[1 + b..], &["out of", "from", "of"])?;
    let old = trimmed(&tokens[1 + b + n..]);
    is(old.first(), &["the", "that", "all", "both", "these", "those"]).then_some(())?;
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    ((e == old.len() || is_place(&old[e..])) && !has_noun(&old[e..]) && talk.fits(old) > 0)
        .then(|| led("replace", &tokens[0], &[old, &led("with", &tokens[0], &[new])]))
}

/// "not come towards us but drive 15 m behind us": what it should do.
fn not_this_but(tokens: Vec<Token>) -> Vec<Token> {
    let Some((a, b)) = first_noun(&tokens)
        .filter(|x| x.0 > 0 && x.0 < 4 && is(tokens.first(), &["the", "both", "all", "that", "my"]))
    else {
        return tokens;
    };
    let not = (b..tokens.len().min(b + 6))
        .find(|k| is(tokens.get(*k), &["not", "shouldnt", "mustnt", "doesnt", "dont"]));
    let but = not.and_then(|not| (not + 2..tokens.len()).find(|k| is(tokens.get(*k), &["but"])));
    let (Some(not), Some(but)) = (not, but) else {
        return tokens;
    };
    let k = but
        + 1
        + leads(
            &tokens[but + 1..],
            &["rather", "instead", "should", "should be", "only", "just"],
        )
        .unwrap_or(0);
    let rest = &tokens[k..];
    let does = rest
        .first()
        .is_some_and(|t| super::words::is_finite(text(t), true))
        && !is(rest.first(), &["is", "are", "has"]);
    let place = (1..rest.len().min(4)).any(|i| is_place(&rest[i..]));
    let denied = &tokens[not + 1..but];
    let did = denied
        .first()
        .is_some_and(|t| super::words::is_finite(text(t), true));
    // ("is not coming towards us but riding ahead of us")
    let doing = |t: Option<&Token>| t.is_some_and(|t| text(t).ends_with("ing"));
    let ing = doing(rest.first()) && doing(denied.first());
    if !(place && (does && did || ing))
        || has_noun(denied)
        || denied.iter().any(|t| t.kind == TokenKind::Stop)
        || a > 3
    {
        return tokens;
    }
    let helper = led(if ing { "should be" } else { "should" }, &tokens[not], &[]);
    let comes = is(
        denied.first(),
        &["come", "coming", "approach", "approaching", "face", "facing"],
    );
    let ahead = (1..rest.len()).find_map(|k| {
        leads(
            &rest[k..],
            &[
                "ahead of us",
                "in front of us",
                "ahead of me",
                "in front of me",
                "ahead",
            ],
        )
        .map(|n| k + n)
    });
    let lane = rest
        .iter()
        .any(|t| is(Some(t), &["lane", "direction", "side", "towards"]));
    // (who rides ahead of us does not come towards us any more)
    match ahead.filter(|_| comes && !lane) {
        Some(end) => [
            &tokens[..b],
            &helper,
            &rest[..end],
            &led("in our direction", &tokens[not], &[]),
            &rest[end..],
        ]
        .concat(),
        None => [&tokens[..b], &helper, rest].concat(),
    }
}

/// "what bothers me is the motorcycle": the motorcycle.
fn what_bothers(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "what",
            "the only thing that",
            "the thing that",
            "one thing that",
            "all that",
        ],
    ) else {
        return tokens;
    };
    let is_at = (n + 1..tokens.len().min(n + 7)).find(|k| is(tokens.get(*k), &["is", "are"]));
    let bothers = tokens[n..is_at.unwrap_or(n)].iter().any(|t| {
        is(
            Some(t),
            &[
                "bothers",
                "disturbs",
                "annoys",
                "irritates",
                "dislike",
                "hate",
                "worries",
                "spoils",
                "bugs",
                "troubles",
                "wrong",
                "bothering",
                "disturbing",
            ],
        ) || is(Some(t), &["like"])
            && tokens[n..is_at.unwrap_or(n)]
                .iter()
                .any(|t| is(Some(t), &["dont", "not"]))
    });
    match is_at {
        Some(k)
            if bothers
                && !has_noun(&tokens[n..k])
                && is(
                    tokens.get(k + 1),
                    &["the", "that", "those", "these", "both", "all"],
                ) =>
        {
            tokens[k + 1..].to_vec()
        }
        _ => tokens,
    }
}

/// "three instead of two pedestrians on the left sidewalk": there should be three there.
fn so_many_instead(tokens: Vec<Token>) -> Vec<Token> {
    let there = leads(
        &tokens,
        &[
            "there should be",
            "there are",
            "there must be",
            "i want",
            "i need",
            "we need",
            "make it",
            "id like",
        ],
    )
    .unwrap_or(0);
    let rest = &tokens[there..];
    let n = 1 + leads(
        rest.get(1..).unwrap_or(&[]),
        &["instead of", "rather than", "not", "and not", "in place of"],
    )
    .unwrap_or(0);
    let count = |t: Option<&Token>| t.is_some_and(|t| number(t).is_some() && !is(Some(t), &["a", "an"]));
    let link = usize::from(
        n == 1 && rest.get(1).is_some_and(|t| t.kind == TokenKind::Comma) && is(rest.get(2), &["not"]),
    ) * 2;
    let n = n + link;
    if n == 1 || !count(rest.first()) || !count(rest.get(n)) {
        return tokens;
    }
    match first_noun(&rest[n + 1..]) {
        Some((a, b)) if a < 3 => {
            let late = &rest[n + 1 + b..];
            if late.is_empty() || is_place(late) {
                return led("there should be", &tokens[0], &[&rest[..1], &rest[n + 1..]]);
            }
            tokens
        }
        _ => tokens,
    }
}

/// "use a bus where the car is".
fn where_it_is(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "let",
            "use",
            "take",
            "show",
            "draw",
            "have",
            "i want",
            "i need",
            "id like",
            "there should be",
            "we need",
            "put",
            "place",
        ],
    )?;
    let new = &tokens[n..];
    let (_, b) = kind(new)?;
    is(new.first(), &["a", "an"]).then_some(())?;
    let stand = usize::from(is(
        new.get(b),
        &["stand", "be", "drive", "wait", "ride", "appear", "park"],
    ));
    is(new.get(b + stand), &["where"]).then_some(())?;
    let old = &new[b + stand + 1..];
    is(old.first(), &["the", "that"]).then_some(())?;
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    let verb = (e..old.len()).find(|k| is(old.get(*k), &["is", "stands", "drives", "was", "stood"]))?;
    let late = trimmed(&old[verb + 1..]);
    let late_ok = late.is_empty()
        || is(late.first(), &["standing", "driving", "now", "parked", "at"]) && late.len() < 3;
    let np = trimmed(&old[..verb]);
    (late_ok && (verb == e || is_place(&old[e..verb])) && talk.fits(np) > 0).then(|| {
        led(
            "replace",
            &tokens[0],
            &[np, &led("with", &tokens[0], &[&new[..b]])],
        )
    })
}

/// "it's the bus that drives ahead of us now, and the cyclist who is behind us": the bus drives there, the cyclist is there.
fn the_one_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let now = usize::from(is(tokens.first(), &["now", "then"]));
    let Some(n) = leads(
        &tokens[now..],
        &[
            "it is",
            "its",
            "it is now",
            "its now",
            "it should be",
            "it must be",
            "it was",
        ],
    ) else {
        return tokens;
    };
    let rest = &tokens[now + n..];
    let which = |part: &[Token]| {
        is(part.first(), &["the", "my", "that"]).then_some(())?;
        let (_, b) = first_noun(part).filter(|x| x.0 < 4)?;
        is(part.get(b), WHICH).then_some(())?;
        let verb = super::words::is_finite(text(part.get(b + 1)?), true)
            || is(part.get(b + 1), &["is", "are", "has", "should"]);
        let place = (b + 2..part.len().min(b + 5)).any(|k| is_place(&part[k..]));
        (verb && place && talk.fits(&part[..b]) > 0).then_some(b)
    };
    let Some(b) = which(rest) else {
        return tokens;
    };
    let mut out = rest[..b].to_vec();
    let mut part = &rest[b + 1..];
    // ("and the cyclist who is behind us")
    while let Some(k) =
        (2..part.len()).find(|k| is(part.get(k - 1), &["and", ","]) && which(&part[*k..]).is_some())
    {
        let c = which(&part[k..]).unwrap_or(1);
        out.extend_from_slice(&part[..k + c]);
        part = &part[k + c + 1..];
    }
    out.extend_from_slice(part);
    out
}
