//! What is asked for with its reason or condition: "I don't like that truck, use a bus", "if there's a lorry behind us, delete
//! it", "half of the workers are on their break, remove them", "a motorcycle should be coming towards us, not a car".

use super::super::lexicon::Sense;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::some_of::removes_it;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const DISLIKES: &[&str] = &[
    "i dont like",
    "i do not like",
    "i dislike",
    "i hate",
    "i cant stand",
    "im not happy with",
    "i am not happy with",
    "im tired of",
    "i am tired of",
    "im not fond of",
    "we dont like",
    "we do not like",
    "im fed up with",
    "i am fed up with",
    "i dont care for",
    "i do not care for",
    "im sick of",
    "forget",
    "never mind",
    "no longer",
    "i dont want",
    "i do not want",
];
const ABOUT: &[&str] = &[
    "i am not sure about",
    "im not sure about",
    "im unsure about",
    "i have doubts about",
    "i am thinking about",
    "consider",
    "im thinking about",
    "take a look at",
    "look at",
    "regarding",
    "concerning",
];
const DISTURBS: &[&str] = &[
    "disturbs",
    "disturb",
    "bothers me",
    "bother me",
    "annoys me",
    "annoy me",
    "disturbs me",
    "disturb me",
    "irritates me",
    "is annoying",
    "are annoying",
    "is boring",
    "are boring",
    "bothers us",
    "is not what i wanted",
    "isnt what i wanted",
    "is not right",
    "isnt right",
    "distracts",
    "distracts me",
    "is disturbing",
    "looks wrong",
    "looks odd",
    "is not good",
    "bores me",
    "is no good",
    "does not fit",
    "doesnt fit",
    "dont fit",
    "do not fit",
    "is unrealistic",
    "looks out of place",
];
const USES: &[&str] = &[
    "use",
    "take",
    "give me",
    "make it",
    "make that",
    "i want",
    "i would like",
    "id like",
    "id prefer",
    "i prefer",
    "i would prefer",
    "better",
    "rather",
    "put",
    "show",
    "id rather have",
    "i would rather have",
    "let it be",
    "show me",
    "id rather see",
    "have",
    "please use",
    "try",
    "let me have",
    "we need",
    "i need",
];
const BETTER: &[&str] = &[
    "would be better",
    "is better",
    "were better",
    "would be nicer",
    "would be preferable",
    "would fit better",
    "fits better",
    "would suit better",
    "would be more realistic",
    "will be better",
    "would do",
    "would look better",
    "would be more fitting",
];

/// The sentence as what is asked for.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = disliked(everybody_does(tokens), talk);
    let out = better(out, talk);
    let out = condition(out, talk);
    let out = some_then(out);
    let out = same_with(is_another(not_that(out, talk)), talk);
    with_gone(out, talk)
}

/// "everybody has got on the bus, so remove all the pedestrians": what is asked for.
fn everybody_does(tokens: Vec<Token>) -> Vec<Token> {
    let none = leads(
        &tokens,
        &["nobody", "no one", "noone", "no pedestrian", "no child"],
    );
    let all = leads(
        &tokens,
        &["everybody", "everyone", "people", "they all", "they have all"],
    );
    let Some(cut) = (2..tokens.len()).find(|k| {
        tokens[*k].kind != TokenKind::Word && !matches!(tokens[*k].kind, TokenKind::Number(_))
            || is(tokens.get(*k), &["so"])
    }) else {
        return tokens;
    };
    let remark = &tokens[..cut];
    // what shall be so is asked for itself
    let named = remark
        .iter()
        .position(|t| is(Some(t), &["the", "this", "that", "these", "those"]));
    let any = none
        .filter(|n| is(remark.get(n + 1), &["a", "an"]))
        .map(|n| n + 1);
    let does = any
        .or(named)
        .is_some_and(|k| first_noun(&remark[k..]).is_some_and(|x| x.0 < 3))
        || remark
            .iter()
            .any(|t| is(Some(t), &["this", "such", "weather", "rain", "time", "night"]));
    let asks = remark.iter().any(|t| {
        is(
            Some(t),
            &["should", "must", "shall", "may", "can", "except", "but"],
        )
    }) || !does && remark.iter().any(|t| is(Some(t), &["on", "in"]));
    let mut rest = trimmed(&tokens[cut..]);
    while is(rest.first(), &["so", "therefore", "please", "and", ":"]) {
        rest = trimmed(&rest[1..]);
    }
    let removes = super::some_of::removes(rest.first())
        && is(rest.get(1), &["the", "all", "both", "every", "those", "these"])
        && first_noun(rest).is_some_and(|x| x.0 < 5);
    let people = first_noun(rest).is_some_and(|(a, b)| {
        super::words::longest(&rest[a..b]).is_some_and(
            |l| matches!(l.0, Sense::Noun(n, _) if n.classes[0] == crate::scene::Class::Pedestrian),
        )
    });
    // "nobody takes the bus on Sundays, so remove it"
    if let (Some(n), true, false) = (none, removes_it(rest), asks)
        && let k = n + 1
        && is(
            remark.get(k),
            &["the", "this", "that", "these", "those", "a", "an", "my", "our"],
        )
        && let Some((_, b)) = first_noun(&remark[k..]).filter(|x| x.0 < 4)
    {
        return led("remove the", &tokens[0], &[&remark[k + 1..k + b]]);
    }
    if removes && (none.is_some() && !asks || all.is_some() && people) {
        return rest.to_vec();
    }
    tokens
}

/// Something new that is asked for: "use a bus", "a bus would be better", "rather a bus".
fn asked_for(rest: &[Token]) -> Option<&[Token]> {
    let rest = trimmed(rest);
    let from = leads(rest, USES).unwrap_or(0);
    let new = trimmed(&rest[from..]);
    let fresh = is(new.first(), &["a", "an"]) || new.first().is_some_and(|t| number(t).is_some());
    let (_, b) = first_noun(new).filter(|x| fresh && x.0 < 4)?;
    let tail = trimmed(&new[b..]);
    let ends = tail.is_empty()
        || leads(tail, BETTER) == Some(tail.len())
        || tail.iter().all(|t| {
            is(
                Some(t),
                &["instead", "please", "there", "in", "its", "place", "then"],
            )
        });
    let asks = from > 0 || !tail.is_empty();
    (ends && asks).then(|| &new[..b])
}

/// "I don't like that truck, use a bus", "the lorry behind us disturbs, a bus would be better".
fn disliked(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = leads(
        &tokens,
        &[
            "i think that",
            "i think",
            "i find that",
            "i find",
            "somehow",
            "honestly",
        ],
    )
    .unwrap_or(0);
    let body = trimmed(&tokens[lead..]);
    let comma = body
        .iter()
        .position(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)));
    let first = &body[..comma.unwrap_or(body.len())];
    let known = |np: &[Token]| {
        is(
            np.first(),
            &["the", "that", "this", "those", "these", "both", "my"],
        ) && first_noun(np).is_some_and(|x| x.0 < 4)
    };
    let np = match leads(first, DISLIKES).or_else(|| leads(first, ABOUT)) {
        Some(n) => first.get(n..),
        None => find(first, DISTURBS)
            .filter(|(i, n)| i + n == first.len())
            .map(|(i, _)| &first[..i]),
    };
    let Some(np) = np.filter(|np| known(np) && talk.fits(np) > 0) else {
        return tokens;
    };
    let mut the = np.to_vec();
    if is(the.first(), &["that", "this"]) {
        the[0].text = "the".into();
    }
    match comma.and_then(|c| asked_for(&body[c..])) {
        Some(new) => led("replace", &tokens[0], &[&the, &led("with", &tokens[0], &[new])]),
        // a complaint alone says only what "it" will mean
        None if comma.is_none() && leads(first, DISLIKES).is_none() => super::gifts::remark(&the),
        None => tokens,
    }
}

/// "a bus would be better": in the place of what was spoken of.
fn better(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let fresh = is(tokens.first(), &["a", "an"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let tail = trimmed(&tokens[b..]);
    match &talk.last {
        Some(last)
            if leads(tail, &BETTER[..9])
                .is_some_and(|n| n == tail.len() || is(tail.get(n), &["there", "here"])) =>
        {
            // ("it" is what was spoken of last; a noun, where there is just one)
            let the = led(&format!("the {last}"), &tokens[0], &[]);
            let it = if talk.fits(&the) == 1 {
                the
            } else {
                led("it", &tokens[0], &[])
            };
            led(
                "replace",
                &tokens[0],
                &[&it, &led("with", &tokens[0], &[&tokens[..b]])],
            )
        }
        _ => tokens,
    }
}

/// "if there's a lorry behind us, delete it": the lorry behind us; nothing, if there is none.
fn condition(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "if there is still",
            "if there are still",
            "if theres still",
            "if there is",
            "if there are",
            "if theres",
            "in case there is",
            "in case there are",
            "in case theres",
            "should there be",
            "if you see",
            "if you find",
            "where there is",
            "wherever there is",
            "wherever there are",
        ],
    ) else {
        return tokens;
    };
    let Some(comma) = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma || is(Some(t), &["then"]))
        .filter(|c| *c > n)
    else {
        return tokens;
    };
    let np = &tokens[n..comma];
    let skip = np
        .iter()
        .take_while(|t| is(Some(t), &["a", "an", "any", "some"]))
        .count();
    let np = &np[skip..];
    let rest = trimmed(&tokens[comma..]);
    if first_noun(np).is_none_or(|x| x.0 > 3) {
        return tokens;
    }
    let it = rest
        .iter()
        .position(|t| matches!(text(t), "it" | "them" | "him" | "her" | "one"));
    match it {
        Some(_) if talk.fits(np) == 0 => Vec::new(),
        Some(k) => [&rest[..k], &led("the", &rest[k], &[np]), &rest[k + 1..]].concat(),
        None => rest.to_vec(),
    }
}

/// "half of the workers are on their break, remove them": half of the workers.
fn some_then(tokens: Vec<Token>) -> Vec<Token> {
    let part =
        is(tokens.first(), &["half", "some", "most"]) || tokens.first().is_some_and(|t| number(t).is_some());
    if !part || !is(tokens.get(1), &["of"]) {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 6) else {
        return tokens;
    };
    let Some(cut) = (b..tokens.len()).find(|k| tokens[*k].kind != TokenKind::Word) else {
        return tokens;
    };
    let says = tokens
        .get(b)
        .is_some_and(|t| HELPERS.contains(&text(t)) || super::words::is_finite(text(t), true));
    let rest = trimmed(&tokens[cut..]);
    if says && !has_noun(rest) && removes_it(rest) {
        return led("remove", &tokens[0], &[&tokens[..b]]);
    }
    tokens
}

/// "a motorcycle should be coming towards us, not a car": the car that does becomes one.
fn not_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(not) = (3..tokens.len()).find(|k| {
        tokens[*k - 1].kind == TokenKind::Comma
            && leads(
                &tokens[*k..],
                &[
                    "not a",
                    "not an",
                    "and not a",
                    "instead of a",
                    "rather than a",
                    "not the",
                ],
            )
            .is_some()
    }) else {
        return tokens;
    };
    let n = leads(&tokens[not..], &["not", "and not", "instead of", "rather than"]).unwrap_or(1);
    let old = &tokens[not + n + 1..];
    let Some((0, e)) = first_noun(old) else {
        return tokens;
    };
    let there = leads(
        &tokens,
        &[
            "there should be",
            "there must be",
            "there ought to be",
            "there has to be",
            "i want",
            "i need",
            "it should be",
            "id like",
            "i would like",
        ],
    )
    .unwrap_or(0);
    let new = &tokens[there..not - 1];
    let fresh = is(new.first(), &["a", "an"]);
    let Some((_, b)) = first_noun(new).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let said: Vec<Token> = new[b..]
        .iter()
        .filter(|t| !HELPERS.contains(&text(t)) && !is(Some(t), &["to"]) || is(Some(t), &["to"]) && there > 0)
        .cloned()
        .collect();
    let closes = trimmed(&old[e..]).is_empty();
    let placed = said.is_empty() || is_place(&said) || text(&said[0]).ends_with("ing");
    let whose = [&old[..e], &said[..]].concat();
    if !closes || !placed || has_noun(&said) || talk.fits(&whose) != 1 {
        return tokens;
    }
    led(
        "replace the",
        &tokens[0],
        &[&whose, &led("with", &tokens[0], &[&new[..b]])],
    )
}

/// "the car isn't a car, it's a van": it should be a van.
fn is_another(tokens: Vec<Token>) -> Vec<Token> {
    let known = is(tokens.first(), &["the", "that", "this", "my"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| known && x.0 < 4) else {
        return tokens;
    };
    let place = (b..tokens.len())
        .find(|k| is(tokens.get(*k), &["isnt", "is", "shouldnt", "should"]))
        .unwrap_or(b);
    let Some(n) = leads(
        &tokens[place..],
        &[
            "isnt a",
            "isnt really a",
            "is not a",
            "is not really a",
            "is no",
            "shouldnt be a",
            "should not be a",
            "is no longer a",
            "isnt a real",
        ],
    ) else {
        return tokens;
    };
    let Some((_, c)) = first_noun(&tokens[place + n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let end = place + n + c;
    let link = usize::from(tokens.get(end).is_some_and(|t| t.kind == TokenKind::Comma));
    let Some(m) = leads(
        &tokens[end + link..],
        &[
            "its",
            "it is",
            "but",
            "but rather",
            "it should be",
            "rather",
            "it must be",
        ],
    ) else {
        return tokens;
    };
    let new = &tokens[end + link + m..];
    if !is(new.first(), &["a", "an"]) || (place > b && !is_place(&tokens[b..place])) {
        return tokens;
    }
    [&tokens[..place], &led("should be", &tokens[place], &[]), new].concat()
}

/// "show the same with the children on the left sidewalk": they should be there.
fn same_with(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let skip = leads(
        &tokens,
        &[
            "show me", "give me", "show", "draw", "make", "i want", "id like", "do",
        ],
    )
    .unwrap_or(0);
    let Some(n) = leads(
        &tokens[skip..],
        &[
            "the same again",
            "the same scene",
            "the same thing",
            "the same situation",
            "the same",
            "it again",
            "that again",
            "the scene",
            "this scene",
        ],
    ) else {
        return tokens;
    };
    let from = skip + n;
    let from = from + usize::from(tokens.get(from).is_some_and(|t| t.kind == TokenKind::Comma));
    let from = from + usize::from(is(tokens.get(from), &["but", "only", "just"]));
    if !is(tokens.get(from), &["with"]) || !is(tokens.get(from + 1), &["the", "both", "all", "my"]) {
        return tokens;
    }
    let np = &tokens[from + 1..];
    match first_noun(np).filter(|x| x.0 < 4 && is_place(&np[x.1..]) && talk.fits(&np[..x.1]) > 0) {
        Some((_, b)) => [&np[..b], &led("should be", &tokens[from], &[&np[b..]])].concat(),
        None => tokens,
    }
}

/// "by night and with the bus gone": the bus goes.
fn with_gone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["with"]).then_some(())?;
        is(tokens.get(i + 1), &["the", "that", "all", "both", "my", "every"]).then_some(())?;
        let (_, b) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4)?;
        let gone = (i + 1 + b..tokens.len().min(i + b + 8)).find(|k| {
            is(
                tokens.get(*k),
                &["gone", "removed", "deleted", "missing", "absent", "away"],
            )
        })?;
        let closes = tokens
            .get(gone + 1)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and"]));
        (closes
            && talk.fits(&tokens[i + 1..gone]) > 0
            && !tokens[i..gone].iter().any(|t| t.kind != TokenKind::Word))
        .then_some((i, gone))
    });
    let Some((i, gone)) = found else {
        return tokens;
    };
    let and = i > 0 && is(tokens.get(i - 1), &["and"]) || i == 0;
    let remove = led(
        if and { "remove" } else { "and remove" },
        &tokens[i],
        &[&tokens[i + 1..gone]],
    );
    [&tokens[..i], &remove, &tokens[gone + 1..]].concat()
}
