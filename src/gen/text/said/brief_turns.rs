//! Who and what instead of what in briefs: "rather than cones use three barriers", "it is a coach that comes at us, not a car".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::briefs::OUT;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use crate::scene::Class;

/// "I'd like heavy rain and the motorbike gone": the sky, and who goes.
pub(super) fn sky_and_gone(tokens: Vec<Token>) -> Vec<Token> {
    let body = trimmed(&tokens);
    let Some((last, rest)) = body.split_last().filter(|x| is(Some(x.0), &OUT)) else {
        return tokens;
    };
    let Some(k) = rest.iter().rposition(|t| is(Some(t), &["and"])) else {
        return tokens;
    };
    let (sky, who) = (&rest[..k], &rest[k + 1..]);
    let definite =
        is(who.first(), &["the", "both", "all", "that"]) && first_noun(who).is_some_and(|x| x.1 == who.len());
    let plain = !who.iter().any(|t| HELPERS.contains(&text(t)));
    if !definite || !plain || has_noun(sky) || !super::parting::only_sky(sky) {
        return tokens;
    }
    [sky, &led("and remove", last, &[who])].concat()
}

const WIDE: &[&str] = &[
    "a two wheeler",
    "a vehicle",
    "another vehicle",
    "one more vehicle",
    "a person",
    "someone",
    "somebody",
    "a second vehicle",
    "a road user",
    "another road user",
    "something",
    "a witness",
    "another witness",
    "one more witness",
    "a bystander",
    "another bystander",
    "one more person",
    "another person",
    "a second person",
    "a passer by",
    "a passerby",
    "another passer by",
    "an onlooker",
    "a spectator",
    "a third person",
    "one person more",
    "an eyewitness",
];

/// "there is a two-wheeler too, a motorbike, parked behind the taxi": the motorbike.
pub(super) fn apposed(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(&tokens, WIDE) else {
        return tokens;
    };
    let also = leads(&tokens[k + n..], &["too", "as well", "also", "here", "there"]).unwrap_or(0);
    let comma = k + n + also;
    if tokens.get(comma).is_none_or(|t| t.kind != TokenKind::Comma)
        || !is(tokens.get(comma + 1), &["a", "an"])
    {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens[comma + 1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let end = comma + 1 + b;
    let skip = usize::from(tokens.get(end).is_some_and(|t| t.kind == TokenKind::Comma));
    [&tokens[..k], &tokens[comma + 1..end], &tokens[end + skip..]].concat()
}

/// "a second cyclist, a boy ahead of us": the boy rides.
pub(super) fn rider_apposed(tokens: Vec<Token>) -> Vec<Token> {
    const RIDER: [&str; 5] = ["cyclist", "motorcyclist", "biker", "rider", "bicyclist"];
    const PERSON: [&str; 14] = [
        "boy",
        "girl",
        "man",
        "woman",
        "lady",
        "kid",
        "child",
        "guy",
        "teenager",
        "student",
        "gentleman",
        "postman",
        "youth",
        "teen",
    ];
    let found = (1..tokens.len()).find(|k| {
        let also = usize::from(is(tokens.get(k + 1), &["too", "also"]));
        is(tokens.get(*k), &RIDER)
            && tokens
                .get(k + also + 1)
                .is_some_and(|t| t.kind == TokenKind::Comma)
            && is(tokens.get(k + also + 2), &["a", "an"])
    });
    let Some(k) = found else { return tokens };
    let from = k + 1 + usize::from(is(tokens.get(k + 1), &["too", "also"]));
    match (from + 2..tokens.len().min(from + 5)).find(|i| is(tokens.get(*i), &PERSON)) {
        Some(p) => [&tokens[..=k], &tokens[p + 1..]].concat(),
        None => tokens,
    }
}

const SOMEBODY: &[&str] = &[
    "the driver",
    "its driver",
    "the owner",
    "its owner",
    "the passenger",
    "a passenger",
    "the passengers",
    "the mechanic",
    "the mother",
    "the father",
    "the teacher",
    "a police officer",
    "the rider",
    "the bus driver",
    "the lorry driver",
    "the truck driver",
    "the car driver",
    "his driver",
];

/// "the driver should be standing next to the car": somebody new, where nobody is.
pub(super) fn somebody_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, SOMEBODY) else {
        return tokens;
    };
    let after = &tokens[n..];
    let wish = leads(
        after,
        &[
            "should be",
            "should stand",
            "must be",
            "has to be",
            "ought to be",
            "should now be",
            "should also be",
            "should wait",
            "stands",
            "is standing",
            "is now standing",
            "has got out and stands",
            "is waiting",
            "waits",
            "should be standing",
            "should be waiting",
        ],
    );
    let Some(w) = wish else { return tokens };
    let nobody = !talk.boxes.values().any(|b| b.class == Class::Pedestrian);
    if !nobody || !after[w..].iter().any(|t| text(t) == "the") {
        return tokens;
    }
    let rest = &after[w..];
    let rest = if is(rest.first(), &["standing", "waiting"]) {
        &rest[1..]
    } else {
        rest
    };
    led("add a pedestrian", &tokens[0], &[rest])
}

const AND_SKY: &[(&str, &str)] = &[
    (
        "and that it rains|and it rains|and it is raining|and it should rain|and that it is raining|and its raining|and that it should rain",
        "make it rain and",
    ),
    (
        "and that it snows|and it snows|and it is snowing|and it should snow|and that it is snowing|and its snowing|and that it should snow",
        "make it snow and",
    ),
    (
        "and that it is night|and it is night|and its night|and that it is dark|and it is dark|and its dark",
        "make it night and",
    ),
    (
        "and that it is foggy|and it is foggy|and its foggy|and that there is fog|and there is fog|and it is misty",
        "make it foggy and",
    ),
];

/// "the bus is not there any more and it rains": the sky first.
pub(super) fn sky_last(tokens: Vec<Token>) -> Vec<Token> {
    for (phrases, words) in AND_SKY {
        let found =
            (3..tokens.len()).find(|k| begins(&tokens[*k..], phrases).is_some_and(|n| k + n == tokens.len()));
        if let Some(k) = found.filter(|k| has_noun(&tokens[..*k])) {
            let from = leads(
                &tokens,
                &[
                    "make that",
                    "make sure that",
                    "make sure",
                    "see to it that",
                    "have it that",
                ],
            )
            .unwrap_or(0);
            return led(words, &tokens[0], &[&tokens[from..k]]);
        }
    }
    tokens
}

const INSTEAD: &[&str] = &[
    "instead of",
    "in place of",
    "in the place of",
    "rather than",
    "in lieu of",
    "than",
];
const WANT: &[&str] = &[
    "use",
    "put",
    "have",
    "show",
    "show me",
    "give me",
    "i need",
    "we need",
    "i want",
    "we want",
    "i would like",
    "id like",
    "i would prefer",
    "id prefer",
    "let us have",
    "lets have",
    "we should have",
    "there should be",
    "there shall be",
    "there must be",
    "add",
    "place",
    "take",
    "we could use",
    "i could use",
    "i would rather have",
    "id rather have",
    "we would like",
    "wed like",
    "please put",
    "please use",
    "i would like to have",
    "id like to have",
];

/// "rather than cones use three barriers by the digger": those go, these come; in their place, if no other is said.
pub(super) fn instead_first(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, INSTEAD) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let old = &tokens[n..n + b];
    let rest = trimmed(&tokens[n + b..]);
    let Some(w) = leads(rest, WANT) else { return tokens };
    let new = &rest[w..];
    let fresh =
        is(new.first(), &["a", "an", "another", "some"]) || new.first().is_some_and(|t| number(t).is_some());
    let Some((_, e)) = first_noun(new).filter(|x| x.0 < 4 && fresh) else {
        return tokens;
    };
    let tail = trimmed(&new[e..]);
    let bare = is(
        old.first(),
        &["the", "both", "all", "that", "those", "my", "every"],
    );
    let one = is(old.first(), &["a", "an"]) || number(&old[0]).is_some();
    if talk.fits(old) == 0 || one {
        return tokens;
    }
    let the = if bare {
        Vec::new()
    } else {
        led("the", &tokens[0], &[])
    };
    if tail.is_empty() {
        return led(
            "replace",
            &tokens[0],
            &[&the, old, &led("with", &tokens[0], &[&new[..e]])],
        );
    }
    // (how several stand is read with them)
    let told = is_place(tail)
        || is(
            tail.first(),
            &["who", "that", "which", "there", "instead", "parked"],
        )
        || tail[0].text.ends_with("ing");
    if !told
        || is(tail.first(), &["one", "each", "all", "both"])
        || new.get(e).is_some_and(|t| t.kind != TokenKind::Word)
    {
        return tokens;
    }
    // (where the old one is anyhow)
    if is_place(tail) && talk.fits(&[old, tail].concat()) > 0 {
        return led(
            "replace",
            &tokens[0],
            &[&the, old, &led("with", &tokens[0], &[&new[..e]])],
        );
    }
    let there =
        leads(tail, &["there", "in its place", "in their place", "instead"]).is_some_and(|m| m == tail.len());
    let tail = if there {
        led("in its place", &tokens[0], &[])
    } else {
        tail.to_vec()
    };
    [
        &led("remove", &tokens[0], &[&the, old])[..],
        &led("and add", &tokens[0], &[&new[..e]]),
        &tail,
    ]
    .concat()
}

/// "..., in other words swap them over": said before.
pub(super) fn in_other_words(mut tokens: Vec<Token>) -> Vec<Token> {
    const SAID: &[&str] = &[
        "in other words",
        "that is to say",
        "put differently",
        "in short",
        "to put it differently",
        "to say it differently",
    ];
    if let Some((k, _)) = find(&tokens, SAID).filter(|x| x.0 > 3 && has_noun(&tokens[..x.0])) {
        tokens.truncate(k);
        while tokens
            .last()
            .is_some_and(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)))
        {
            tokens.pop();
        }
    }
    tokens
}

/// "it's a coach that comes at us, not a car": the car that does becomes a coach.
pub(super) fn not_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "its",
            "it is",
            "it was",
            "that is",
            "thats",
            "this is",
            "it should be",
            "it must be",
            "it has to be",
        ],
    ) else {
        return tokens;
    };
    let Some(k) = (n + 2..tokens.len()).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            && is(tokens.get(k + 1), &["not", "and"])
            && leads(
                &tokens[k + 1..],
                &["not a", "not an", "and not a", "and not an", "not the"],
            )
            .is_some()
    }) else {
        return tokens;
    };
    let m = leads(&tokens[k + 1..], &["not", "and not"]).unwrap_or(1);
    let old = &tokens[k + 1 + m + 1..];
    let new = &tokens[n..k];
    let Some((_, b)) = first_noun(new).filter(|x| x.0 < 4 && is(new.first(), &["a", "an"])) else {
        return tokens;
    };
    let clause = &new[b..];
    let told = clause.is_empty() || is(clause.first(), &["that", "which", "who"]) || is_place(clause);
    let bare = first_noun(old).is_some_and(|x| x.0 < 3 && x.1 == old.len());
    if !told || !bare || talk.fits(old) == 0 {
        return tokens;
    }
    [
        &led("replace the", &tokens[0], &[old, clause])[..],
        &led("with", &tokens[0], &[&new[..b]]),
    ]
    .concat()
}
