//! Things named without an article before what is said of them, as second-language speakers do: "scooter no need", "scooter not
//! good, change to bicycle", "scooter move to left side", "white van, please let it disappear", "silver drops back".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::gifts::begins_at;
use super::lists::{HELPERS, PRONOUNS};
use super::words::{first_noun, is, is_finite, is_place, leads, led, noun_at, number, text, trimmed};

const NO_NEED: &[&str] = &[
    "no need",
    "not need",
    "no needed",
    "not needed",
    "no want",
    "not want",
    "not wanted",
    "no necessary",
    "not necessary",
    "no longer need",
    "no more need",
    "dont need",
    "unneeded",
    "begone",
    "be gone",
    "bye",
    "bye bye",
    "adios",
    "outta here",
    "out of here",
    "not required",
];
const NOT_GOOD: &[&str] = &[
    "not good",
    "no good",
    "is not good",
    "is no good",
    "not ok",
    "not okay",
    "not right",
    "not suitable",
    "not correct",
    "not fitting",
    "wrong",
    "is wrong",
    "bad",
];
const BECOMES: &[&str] = &[
    "change to",
    "change into",
    "change it to",
    "change it into",
    "change for",
    "replace with",
    "replace by",
    "replace it with",
    "replace it by",
    "make it",
    "make",
    "swap for",
    "swap with",
    "swap it for",
    "turn into",
    "turn it into",
    "switch to",
    "switch it to",
    "use",
];
const DOES: &[&str] = &[
    "move",
    "go",
    "come",
    "turn",
    "stay",
    "disappear",
    "vanish",
    "stand",
    "wait",
    "drive",
    "become",
    "change",
    "leave",
    "walk",
    "ride",
    "face",
    "shift",
];
const OBJECTS: &[&str] = &["it", "them", "him", "her"];

/// How many of them are looked for in a sentence.
const MOST: usize = 4;

/// A sentence (without its stop) with its articles and helpers.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut tokens = coloured_subject(instead_of(tokens, talk));
    // ("bus no need, taxi no need")
    for _ in 0..MOST {
        match whole(&tokens, talk) {
            Some(new) => tokens = new,
            None => break,
        }
    }
    arrived(with_article(tokens, talk), talk)
}

/// "man has crossed already": the man, if one is there.
fn with_article(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let end = bare(&tokens, 0).filter(|end| is(tokens.get(*end), &["has", "had"]));
    match end {
        Some(end) if talk.fits(&tokens[..end]) == 1 => led("the", &tokens[0], &[&tokens]),
        _ => tokens,
    }
}

/// The first bare subject with what it lacks.
fn whole(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    (0..tokens.len()).find_map(|i| {
        let end = bare(tokens, i).filter(|end| talk.fits(&tokens[i..*end]) > 0)?;
        let new = unwanted(tokens, i, end)
            .or_else(|| enough(tokens, i, end))
            .or_else(|| exchanged(tokens, i, end))
            .or_else(|| ordered(tokens, i, end))
            .or_else(|| does(tokens, i, end))?;
        Some([&tokens[..i], &new[..]].concat())
    })
}

/// "instead bus I want a tram": instead of it; "need one ambulance": add it.
fn instead_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // ("need one ambulance" is a wish)
    if is(tokens.first(), &["need", "want"])
        && tokens
            .get(1)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "more"]))
    {
        return led("add", &tokens[0], &[&tokens[1..]]);
    }
    let noun = first_noun(tokens.get(1..).unwrap_or_default()).filter(|n| n.0 == 0);
    match noun {
        Some((_, b)) if is(tokens.first(), &["instead"]) && talk.fits(&tokens[1..=b]) > 0 => {
            led("instead of the", &tokens[0], &[&tokens[1..]])
        }
        _ => tokens,
    }
}

/// "silver drops back", "white out, red stays": the silver one.
fn coloured_subject(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let opens = begins_at(&tokens, i) && matches!(look_up(text(&tokens[i])), Some(Sense::Color(_)));
        let next = tokens.get(i + 1).filter(|_| opens)?;
        let does = is_finite(text(next), false) && noun_at(&tokens[i + 1..]).is_none();
        let away = is(Some(next), &["out", "away", "gone", "off"]) && closes(tokens.get(i + 2));
        // ("paint the bus red and white" tells how)
        let list = i > 0 && matches!(look_up(text(&tokens[i - 1])), Some(Sense::Color(_)))
            || is(out.last(), &["and", "but"])
                && i > 1
                && matches!(look_up(text(&tokens[i - 2])), Some(Sense::Color(_)));
        ((does || away) && !list).then_some(())?;
        out.extend(led("the", &tokens[i], &[&tokens[i..=i]]));
        out.extend(led("vehicle", &tokens[i], &[]));
        Some(i + 1)
    })
}

/// Where a noun ends that begins a clause with nothing before it but words that describe it.
fn bare(tokens: &[Token], i: usize) -> Option<usize> {
    let np = &tokens[i..];
    let (a, b) = first_noun(np).filter(|n| n.0 < 3 && begins_at(tokens, i))?;
    let described = np[..a].iter().all(|t| {
        matches!(
            look_up(text(t)),
            Some(Sense::Color(_) | Sense::State(_, false) | Sense::Size(_) | Sense::Attribute(_))
        )
    });
    described.then_some(i + b)
}

fn closes(t: Option<&Token>) -> bool {
    t.is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but", "so"]))
}

/// "scooter no need": it goes.
fn unwanted(tokens: &[Token], i: usize, end: usize) -> Option<Vec<Token>> {
    let rest = &tokens[end..];
    let n = leads(rest, NO_NEED)?;
    let more = leads(
        &rest[n..],
        &["any more", "anymore", "now", "please", "here", "at all"],
    )
    .unwrap_or(0);
    closes(rest.get(n + more)).then(|| led("remove the", &tokens[i], &[&tokens[i..end], &rest[n + more..]]))
}

/// "pedestrian one is enough": one of them is.
fn enough(tokens: &[Token], i: usize, end: usize) -> Option<Vec<Token>> {
    let many = tokens.get(end).filter(|t| number(t).is_some())?;
    let n = leads(
        &tokens[end + 1..],
        &[
            "is enough",
            "are enough",
            "enough",
            "is ok",
            "are ok",
            "will do",
            "is sufficient",
            "is plenty",
            "are plenty",
        ],
    )?;
    let rest = &tokens[end + 1 + n..];
    closes(rest.first()).then(|| {
        led(
            "keep only",
            &tokens[i],
            &[std::slice::from_ref(many), &tokens[i..end], rest],
        )
    })
}

/// "scooter not good, change to bicycle": one for the other.
fn exchanged(tokens: &[Token], i: usize, end: usize) -> Option<Vec<Token>> {
    let n = leads(&tokens[end..], NOT_GOOD)?;
    let rest = trimmed(&tokens[end + n..]);
    let verb = leads(rest, BECOMES)?;
    let article = usize::from(is(rest.get(verb), &["a", "an", "one"]));
    let (_, b) = first_noun(&rest[verb + article..]).filter(|x| x.0 < 3)?;
    let new = &rest[verb + article..verb + article + b];
    let mut out = led("replace the", &tokens[i], &[&tokens[i..end]]);
    out.extend(led("with a", &tokens[i], &[new, &rest[verb + article + b..]]));
    Some(out)
}

/// "white van, please let it disappear": whom it is about stands first.
fn ordered(tokens: &[Token], i: usize, end: usize) -> Option<Vec<Token>> {
    (tokens.get(end)?.kind == TokenKind::Comma).then_some(())?;
    let please = usize::from(is(tokens.get(end + 1), &["please", "just"]));
    let order = &tokens[end + 1 + please..];
    // "bus, it should drive behind us"
    if is(order.first(), &PRONOUNS) && order.get(1).is_some_and(|t| HELPERS.contains(&text(t))) {
        return Some(led("the", &tokens[i], &[&tokens[i..end], &order[1..]]));
    }
    let verb = super::super::rephrase::is_verb(order.first()?) || is(order.first(), &["let", "have"]);
    (verb && is(order.get(1), OBJECTS)).then(|| {
        let the = led("the", &tokens[i], &[&tokens[i..end]]);
        [&order[..1], &the, &order[2..]].concat()
    })
}

/// "scooter move to left side of the road": it should.
fn does(tokens: &[Token], i: usize, end: usize) -> Option<Vec<Token>> {
    let verb = tokens.get(end).filter(|t| is(Some(t), DOES))?;
    let rest = &tokens[end + 1..];
    let leaves = is(Some(verb), &["disappear", "vanish", "leave"]) && closes(rest.first());
    // ("car park on the left" is a place; "bus lane" too)
    (leaves || !rest.is_empty() && is_place(rest) || is(Some(verb), &["become", "change"])).then(|| {
        let the = led("the", &tokens[i], &[&tokens[i..end]]);
        [&the[..], &led("should", verb, &[&tokens[end..]])].concat()
    })
}

/// "children already finish crossing, now both stand on the right sidewalk": where they are now.
fn arrived(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|i| {
        tokens[i - 1].kind == TokenKind::Comma
            && is(tokens.get(*i), &["now"])
            && is(
                tokens.get(i + 1),
                &["both", "all", "they", "he", "she", "it", "each"],
            )
    });
    let Some(i) = found else {
        return tokens;
    };
    let before = &tokens[..i - 1];
    let over = before.iter().any(|t| {
        is(
            Some(t),
            &["finish", "finished", "done", "already", "arrived", "crossed"],
        )
    });
    let Some((_, b)) = first_noun(before).filter(|n| n.0 < 3 && over && talk.fits(&before[..n.1]) > 0) else {
        return tokens;
    };
    let verb = i + 2;
    let stands = tokens.get(verb).is_some_and(|t| is_finite(text(t), true));
    if !stands || !tokens.get(verb + 1..).is_some_and(is_place) {
        return tokens;
    }
    let the = if is(before.first(), &["the", "both", "all", "my", "that"]) {
        ""
    } else {
        "the"
    };
    let mut out = before[..b].to_vec();
    if !the.is_empty() {
        out.insert(0, super::words::word(the, &tokens[0]));
    }
    out.extend(led("should be", &tokens[verb], &[&tokens[verb + 1..]]));
    out
}
