//! Who goes where, and by what doing: "make room by sending the van to the left", "split the walkers evenly between both
//! sidewalks", "fill the left lane until there are four cars in it", "the right lane is closed: five cones there".

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    command_of, find, first_noun, has_noun, is, is_place, leads, led, longest, number, text, trimmed,
};
use crate::scene::Class;

const BIGGER: &str = "anything bigger than a car|anything larger than a car|everything bigger than a car|everything larger than a car|whatever is bigger than a car|whatever is larger than a car|everything that is bigger than a car|everything that is larger than a car|anything that is bigger than a car|anything that is larger than a car|all vehicles bigger than a car|all vehicles larger than a car|every vehicle bigger than a car|every vehicle larger than a car|anything heavier than a car|everything heavier than a car|all heavy vehicles|every heavy vehicle|all the heavy vehicles|the heavy vehicles";
const BIG: &str = "all trucks and all buses and all trailers and all construction vehicles";
const RATHER: &str = "rather than";

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut out = replaced(&tokens, BIGGER, BIG);
    // ("rather" opens sentences otherwise)
    if leads(&out, &[RATHER]).is_some() && out.iter().any(|t| t.kind == TokenKind::Comma) {
        out = replaced(&out, RATHER, "instead of");
    }
    let out = carried_things(bus_stops(out));
    let out = ours(out, talk);
    let out = by_doing(out);
    let out = called_for(out);
    let out = filled(out, talk);
    let out = the_other_too(dealt_out(out, talk), talk);
    placed_there(out)
}

/// "move the two workers: one to the left pavement, the other to the right one": each is moved.
fn the_other_too(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(tokens.first(), &super::lists::MOVES) {
        return tokens;
    }
    let Some((a, b)) = first_noun(&tokens).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let goes = |k: usize| {
        is(
            tokens.get(k),
            &[
                "to", "onto", "into", "on", "in", "at", "behind", "ahead", "next", "beside",
            ],
        ) && is_place(&tokens[k..])
    };
    let ones = ["one of them", "the first one", "the first", "one"];
    // the group before, or one of it
    let from = match (leads(&tokens[b..], &[":", ","]), number(&tokens[1])) {
        (Some(m), _) => leads(&tokens[b + m..], &ones).map(|n| b + m + n),
        (None, Some(1)) => Some(b),
        _ => None,
    };
    let Some(from) = from.filter(|f| goes(*f)) else {
        return tokens;
    };
    let found = (from + 2..tokens.len()).find_map(|k| {
        let link = closes(tokens.get(k - 1)) || is(tokens.get(k - 1), &["and"]);
        let n = leads(
            &tokens[k..],
            &[
                "the other one",
                "the other",
                "the second one",
                "the second",
                "one",
            ],
        )?;
        (link && goes(k + n)).then_some((k, k + n))
    });
    let Some((k, other)) = found.filter(|_| talk.fits(&tokens[a..b]) == 2) else {
        return tokens;
    };
    let one = super::topics::singular_of(&tokens[a..b]);
    let before = trimmed(&tokens[from..k]);
    [
        &led("move one", &tokens[0], &[&one, before]),
        &led("and move the other", &tokens[k], &[])[..],
        &tokens[other..],
    ]
    .concat()
}

fn closes(t: Option<&Token>) -> bool {
    t.is_none_or(|t| !matches!(t.kind, TokenKind::Word | TokenKind::Number(_)))
}

/// "let the bus stop behind us": there it is a verb.
fn bus_stops(mut tokens: Vec<Token>) -> Vec<Token> {
    for i in 3..tokens.len() {
        let bus = is(tokens.get(i - 1), &["bus"]) && is(tokens.get(i), &["stop", "stand"]);
        let let_ = is(tokens.get(i - 2), &["the", "that", "our", "my"])
            && is(
                tokens.get(i - 3),
                &["let", "have", "make", "want", "need", "see", "should"],
            );
        if bus && let_ && tokens.get(i + 1).is_none_or(|t| !HELPERS.contains(&text(t))) {
            tokens[i].text = "wait".into();
        }
    }
    tokens
}

/// "a man with a stick": what somebody carries is not in the scene.
fn carried_things(mut tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len().saturating_sub(2)).find(|i| {
        let person = match look_up(text(&tokens[i - 1])) {
            Some(Sense::Noun(n, _)) => n.classes[0] == Class::Pedestrian,
            _ => false,
        };
        person
            && is(tokens.get(*i), &["with", "carrying", "holding"])
            && is(tokens.get(i + 1), &["a", "an", "his", "her", "their", "two"])
            && !matches!(
                look_up(text(&tokens[i + 2])),
                Some(
                    Sense::Noun(..)
                        | Sense::Place(..)
                        | Sense::Color(_)
                        | Sense::Size(_)
                        | Sense::Attribute(_)
                        | Sense::State(..)
                )
            )
            && tokens[i + 2].kind == TokenKind::Word
            && !is_place(&tokens[i + 2..])
    });
    if let Some(i) = found {
        tokens.drain(i..i + 3);
    }
    tokens
}

/// "the car takes its place in ours": in our lane.
fn ours(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (1..tokens.len()).find(|i| {
        is(tokens.get(*i), &["ours", "mine"])
            && is(tokens.get(i - 1), &["in", "into", "from", "to", "on", "onto"])
            && talk.text.to_lowercase().contains("lane")
    }) else {
        return tokens;
    };
    let lane = led(
        if text(&tokens[i]) == "ours" {
            "our lane"
        } else {
            "my lane"
        },
        &tokens[i],
        &[],
    );
    [&tokens[..i], &lane, &tokens[i + 1..]].concat()
}

/// "clear our lane by shifting the cones to the left": what is done is the command, what stands before it only says why.
fn by_doing(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["by"]).then_some(())?;
        let doing = tokens.get(i + 1).filter(|t| text(t).ends_with("ing"))?;
        let verb = command_of(text(doing))?;
        let np = tokens.get(i + 2..)?;
        let known = is(
            np.first(),
            &[
                "the",
                "all",
                "both",
                "every",
                "a",
                "an",
                "another",
                "it",
                "them",
                "him",
                "her",
                "my",
                "our",
                "that",
                "those",
                "these",
                "one",
                "two",
                "three",
                "everyone",
                "everybody",
                "everything",
            ],
        ) || np.first().is_some_and(|t| number(t).is_some());
        known.then_some((i, verb))
    });
    let Some((i, verb)) = found else {
        return tokens;
    };
    let from = tokens[..i]
        .iter()
        .rposition(|t| matches!(t.kind, TokenKind::Mark | TokenKind::Stop))
        .map_or(0, |k| k + 1);
    let before = trimmed(&tokens[from..i]);
    // ("replace the bus by moving ..." and what names a thing that the doing does not is left alone)
    let same = match first_noun(before) {
        Some((a, b)) => tokens[i..]
            .iter()
            .any(|t| before[a..b].iter().any(|n| stem(text(n)) == stem(text(t)))),
        None => true,
    };
    let pronoun = is(tokens.get(i + 2), &["it", "them", "him", "her"]);
    if !same && !pronoun || pronoun && has_noun(before) {
        return tokens;
    }
    [&tokens[..from], &led(verb, &tokens[i], &[&tokens[i + 2..]])].concat()
}

fn stem(word: &str) -> &str {
    word.strip_suffix('s').unwrap_or(word)
}

/// "the plan calls for nine cones", "my list says two vans": so many there shall be.
fn called_for(tokens: Vec<Token>) -> Vec<Token> {
    const PAPERS: &[&str] = &[
        "plan",
        "script",
        "report",
        "invoice",
        "list",
        "form",
        "protocol",
        "drawing",
        "sketch",
        "specification",
        "spec",
        "order",
        "permit",
        "statement",
        "file",
        "record",
        "records",
        "notes",
        "test case",
        "scenario",
        "ticket",
        "regulations",
        "rules",
        "sheet",
    ];
    const SAYS: &[&str] = &[
        "calls for",
        "asks for",
        "says",
        "requires",
        "demands",
        "prescribes",
        "specifies",
        "lists",
        "states",
        "shows",
        "mentions",
        "provides for",
        "speaks of",
        "says there are",
        "says there should be",
        "says there must be",
        "foresees",
        "call for",
        "require",
    ];
    let Some((k, n)) = find(&tokens, SAYS).filter(|x| x.0 > 0 && x.0 < 5) else {
        return tokens;
    };
    let paper = is(tokens.get(k - 1), PAPERS) || k > 1 && leads(&tokens[k - 2..k], PAPERS) == Some(2);
    let Some(many) = tokens
        .get(k + n)
        .filter(|t| number(t).is_some() && !matches!(text(t), "a" | "an"))
    else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[k + n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    if !paper || has_noun(&tokens[..k - 1]) {
        return tokens;
    }
    let end = k + n + b;
    let np = &tokens[k + n + 1..end];
    let rest = &tokens[end..];
    let out = led("keep exactly", &tokens[0], &[std::slice::from_ref(many), np]);
    // what follows only says how that comes about
    let follows = is_place(rest) && !has_noun(rest);
    if follows {
        return [&out, rest].concat();
    }
    out
}

/// "fill the left lane until there are four cars in it": so many there.
fn filled(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "fill up",
            "fill in",
            "fill",
            "stock up",
            "top up",
            "fill the scene so",
        ],
    ) else {
        return tokens;
    };
    let the = usize::from(is(tokens.get(n), &["the", "our", "my"]));
    let Some((Sense::Place(..), m)) = tokens.get(n + the..).and_then(longest) else {
        return tokens;
    };
    let place = &tokens[n..n + the + m];
    let mut rest = &tokens[n + the + m..];
    while is(
        rest.first(),
        &["up", "so", "that", "until", "till", "with", "to", ","],
    ) {
        rest = &rest[1..];
    }
    let until = rest.len() + n + the + m < tokens.len();
    let more = leads(rest, &["there are", "there is", "we have", "it has", "it holds"]).unwrap_or(0);
    let rest = &rest[more..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4 && number(&rest[0]).is_some()) else {
        return tokens;
    };
    let tail = trimmed(&rest[b..]);
    let there = leads(
        tail,
        &[
            "in it",
            "on it",
            "there",
            "in there",
            "standing there",
            "parked there",
            "in all",
            "in total",
        ],
    )
    .unwrap_or(0);
    if !until || !tail[there..].is_empty() {
        return tokens;
    }
    let lane = place.iter().any(|t| {
        matches!(
            text(t),
            "lane" | "lanes" | "junction" | "intersection" | "carpark" | "roundabout"
        )
    });
    let at = led(if lane { "in" } else { "on" }, &tokens[0], &[place]);
    // ("with four more cars" come on top)
    let added = rest[..b]
        .iter()
        .any(|t| is(Some(t), &["more", "further", "additional", "extra"]));
    let there_are = !added && (talk.fits(&[&rest[1..b], &at].concat()) > 0 || more > 0);
    led(
        if there_are { "keep exactly" } else { "add" },
        &tokens[0],
        &[&rest[..b], &at],
    )
}

/// "split the four walkers evenly between the two sidewalks": half of them on either.
fn dealt_out(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STRIPS: &[&str] = &[
        "sidewalk", "pavement", "footpath", "roadside", "kerb", "curb", "shoulder", "verge",
    ];
    let Some(n) = leads(
        &tokens,
        &[
            "split up",
            "split",
            "divide",
            "distribute",
            "spread out",
            "spread",
            "share out",
            "deal out",
        ],
    ) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[n..])
        .filter(|x| x.0 < 5)
        .map(|x| (n + x.0, n + x.1))
    else {
        return tokens;
    };
    let known = is(tokens.get(n), &["the", "all", "those", "these", "our", "my"]);
    let strip = tokens[b..]
        .iter()
        .find_map(|t| STRIPS.iter().find(|s| stem(text(t)) == **s));
    let side = find(
        &tokens[b..],
        &[
            "sides of the road",
            "sides of the street",
            "side of the road",
            "side of the street",
            "edges of the road",
        ],
    );
    let strip = match (strip, side) {
        (Some(s), _) => *s,
        (None, Some(_)) => "roadside",
        _ => return tokens,
    };
    let both = tokens[b..]
        .iter()
        .any(|t| matches!(text(t), "both" | "two" | "each" | "either" | "every"));
    let many = talk.fits(&tokens[a..b]);
    // what more is said must only say that it is even
    let other = first_noun(&tokens[b..]).is_some();
    if !known || !both || other || many < 2 || many % 2 == 1 {
        return tokens;
    }
    let half = Token {
        kind: TokenKind::Number((many / 2) as f64),
        text: (many / 2).to_string(),
        span: tokens[0].span,
    };
    let at = &tokens[0];
    let mut out = led("move", at, &[&[half]]);
    out.extend(led("of the", at, &[&tokens[a..b]]));
    out.extend(led(
        &format!("to the left {strip} and move the others to the right {strip}"),
        at,
        &[],
    ));
    out
}

/// "the right lane is closed: five cones there": there is where was said before.
fn placed_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, t)) = tokens.iter().enumerate().find(|(i, t)| {
        text(t) == "there"
            && *i > 3
            && !tokens.get(i + 1).is_some_and(|t| {
                HELPERS.contains(&text(t)) || matches!(text(t), "stand" | "stands" | "isnt" | "arent")
            })
            && !is(
                tokens.get(i.wrapping_sub(1)),
                &[
                    "is", "are", "not", "still", "already", "it", "them", "him", "her", "over", "up", "down",
                    "out", "from", "who", "that",
                ],
            )
    }) else {
        return tokens;
    };
    let body = trimmed(&tokens[..i]);
    let the = usize::from(is(body.first(), &["the", "our", "my"]));
    let Some((Sense::Place(..), n)) = body.get(the..).and_then(longest).filter(|_| the == 1) else {
        return tokens;
    };
    let side = leads(
        &body[the + n..],
        &[
            "to our right",
            "to our left",
            "to my right",
            "to my left",
            "on our right",
            "on our left",
            "on the right",
            "on the left",
            "to the right",
            "to the left",
        ],
    )
    .unwrap_or(0);
    let place = &body[..the + n + side];
    let state = body
        .get(the + n + side)
        .is_some_and(|t| HELPERS.contains(&text(t)));
    let Some(mark) = tokens[..i]
        .iter()
        .position(|t| t.kind == TokenKind::Mark && matches!(text(t), ":" | "-"))
    else {
        return tokens;
    };
    if !state || mark < place.len() || has_noun(&tokens[..mark]) {
        return tokens;
    }
    let lane = place.iter().any(|t| {
        matches!(
            text(t),
            "lane" | "lanes" | "junction" | "intersection" | "carpark" | "roundabout"
        )
    });
    let at = led(if lane { "in" } else { "on" }, t, &[place]);
    // "no motorcycle there any longer, but five cones"
    let late = leads(&tokens[i + 1..], &["any longer", "any more", "anymore", "now"]).unwrap_or(0);
    let rest = &tokens[i + 1 + late..];
    let head = trimmed(&tokens[mark + 1..i]);
    let gone = leads(head, &["no", "not a", "no more"]);
    let but = (0..rest.len())
        .find(|k| is(rest.get(*k), &["but", "instead"]))
        .filter(|k| *k < 2);
    match (gone, but) {
        (Some(g), Some(k)) => {
            let mut np = head[g..].to_vec();
            if let Some(last) = np.last_mut()
                && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
            {
                last.text = plural(&last.text);
            }
            let remove = led("remove all the", t, &[&np, &at]);
            let add = led("and add", t, &[trimmed(&rest[k + 1..]), &at]);
            [remove, add].concat()
        }
        (Some(g), None) if rest.is_empty() => led("remove all the", t, &[&head[g..], &at]),
        (None, _) if closes(rest.first()) && is_fresh(head.first()) => {
            [&led("add", t, &[head]), &at[..], rest].concat()
        }
        _ => tokens,
    }
}

fn is_fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another", "some"]) || t.is_some_and(|t| number(t).is_some())
}
