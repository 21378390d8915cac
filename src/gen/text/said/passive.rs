//! Something new that is said of what is there: "have the motorcycle followed by a police car", "the truck should tow a trailer".

use super::super::tokens::Token;
use super::Talk;
use super::lists::{ADVERBS, HELPERS};
use super::words::{find, first_noun, is, leads, led, number};

const BY: &[(&str, &[&str])] = &[
    (
        "behind",
        &[
            "followed by",
            "chased by",
            "pursued by",
            "tailed by",
            "trailed by",
            "shadowed by",
            "hunted by",
            "tailgated by",
            "being followed by",
        ],
    ),
    (
        "next to",
        &[
            "accompanied by",
            "flanked by",
            "joined by",
            "escorted by",
            "attended by",
        ],
    ),
    ("in front of", &["led by", "preceded by", "headed by"]),
    ("near", &["surrounded by", "ringed by", "encircled by"]),
];
const TOWS: &[&str] = &[
    "towing",
    "tow",
    "tows",
    "pulling",
    "pull",
    "pulls",
    "hauling",
    "haul",
    "hauls",
    "dragging",
    "drag",
    "drags",
    "drawing",
    "have in tow",
    "has in tow",
];

fn is_fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another", "some"]) || t.is_some_and(|t| number(t).is_some())
}

/// The target before a verb: what causes it and its helpers taken off.
fn known<'t>(tokens: &'t [Token], talk: &Talk<'_>) -> Option<&'t [Token]> {
    let (inner, _) = super::frame::unwrapped(tokens);
    let skip = leads(inner, &["have", "let", "get", "make", "see"]).unwrap_or(0);
    let mut np = &inner[skip..];
    while np
        .last()
        .is_some_and(|t| HELPERS.contains(&t.text.as_str()) || ADVERBS.contains(&t.text.as_str()))
    {
        np = &np[..np.len() - 1];
    }
    let definite = is(np.first(), &["the", "my", "that", "this", "both", "our"]);
    (definite && first_noun(np).is_some() && talk.fits(np) > 0).then_some(np)
}

/// "the bus gets another bus behind it": add it, where "it" is the bus.
fn gets(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "gets",
            "should get",
            "receives",
            "shall get",
            "must get",
            "is given",
            "should have",
            "needs",
            "could do with",
            "could use",
            "would benefit from",
            "deserves",
        ],
    )
    .filter(|x| x.0 > 1)?;
    let new = &tokens[i + n..];
    let (_, end) = first_noun(new).filter(|x| x.0 < 4)?;
    let it = (end + 1..new.len()).find(|k| is(new.get(*k), &["it", "him", "her", "them"]))?;
    let follows = is(
        new.get(end),
        &[
            "following",
            "tailing",
            "trailing",
            "behind",
            "beside",
            "riding",
            "driving",
            "walking",
            "standing",
        ],
    );
    let placed = it <= end + 4 && (follows || super::words::is_place(&new[end..]));
    let np = known(&tokens[..i], talk).filter(|_| placed && is_fresh(new.first()))?;
    Some(led("add", &tokens[0], &[&new[..it], np, &new[it + 1..]]))
}

/// The command to add it.
pub fn added(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let by = BY
        .iter()
        .find_map(|(relation, list)| find(tokens, list).map(|(i, n)| (*relation, i, n)));
    let tows = || {
        find(tokens, TOWS)
            .filter(|(i, n)| {
                *i > 1
                    && first_noun(&tokens[i + n..]).is_some_and(|x| {
                        x.0 < 4
                            && is(
                                tokens.get(i + n + x.0),
                                &["trailer", "caravan", "boat", "horsebox"],
                            )
                    })
            })
            .map(|(i, n)| ("behind", i, n))
    };
    if by.is_none()
        && let Some(found) = gets(tokens, talk)
    {
        return Some(found);
    }
    let (relation, i, n) = by.or_else(tows)?;
    let new = &tokens[i + n..];
    if !is_fresh(new.first()) || first_noun(new).is_none_or(|x| x.0 > 4) {
        return None;
    }
    let np = known(&tokens[..i], talk)?;
    let end = first_noun(new)?.1;
    let place = led(relation, &tokens[i], &[np]);
    Some(led("add", &tokens[0], &[&new[..end], &place]))
}
