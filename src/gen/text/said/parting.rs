//! Where a sentence falls apart into clauses.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::frame::unwrapped;
use super::lists::{HELPERS, MOVES, NEGATED, PRONOUNS};
use super::predicate::in_place;
use super::subject::{Kind, subject};
use super::words::{self, find, first_noun, has_noun, is, is_place, leads, number, text};

/// Words before what is meant as a whole.
pub(super) const WHOLE: [&str; 9] = [
    "the", "that", "both", "my", "all", "every", "each", "those", "these",
];

/// Where a sentence falls apart: after a comma, "and" or "but", where a subject with its verb or an imperative begins.
pub(super) fn clauses<'t>(body: &'t [Token], talk: &Talk<'_>) -> Vec<&'t [Token]> {
    let mut out = Vec::new();
    let mut from = 0;
    let mut i = 1;
    while i < body.len() {
        let t = &body[i];
        let link = matches!(t.kind, TokenKind::Comma | TokenKind::Mark)
            && !matches!(text(t), "#" | "/" | "\"")
            || matches!(
                text(t),
                "and" | "but" | "so" | "then" | "while" | "whereas" | "because"
            );
        if link {
            let mut next = i + 1;
            while body.get(next).is_some_and(|t| {
                t.kind == TokenKind::Comma
                    || matches!(
                        text(t),
                        "and" | "but" | "so" | "then" | "while" | "also" | "therefore" | "hence"
                    )
            }) {
                next += 1;
            }
            // "everything but the bus"
            if text(t) == "but"
                && is(
                    body.get(i.wrapping_sub(1)),
                    &[
                        "everything",
                        "everyone",
                        "everybody",
                        "all",
                        "nothing",
                        "anything",
                        "nobody",
                    ],
                )
            {
                i += 1;
                continue;
            }
            // "all cars but one can go"
            if text(t) == "but"
                && body.get(next).is_some_and(|t| number(t).is_some())
                && body[from..i].iter().any(|t| matches!(text(t), "all" | "every"))
            {
                i += 1;
                continue;
            }
            if super::colours::paired(&body[from..i], &body[next.min(body.len())..]) {
                out.push(&body[from..i]);
                from = next;
                i = next;
                continue;
            }
            let rest = &body[next.min(body.len())..(next + 40).min(body.len())];
            let lead = matches!(
                text(&body[from]),
                "where" | "instead" | "if" | "when" | "since" | "because" | "as" | "by" | "until"
            ) && from == 0
                && !has_noun(&body[from..i]);
            let styled = body[from..i]
                .iter()
                .any(|t| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_))));
            let spoken = styled
                || has_noun(&body[from..i])
                || is(body.get(from), &["nothing", "nobody", "everybody", "everyone", "everything"])
                || is(body.get(from), &PRONOUNS)
                || is(body.get(from + 1), &["it", "them", "him", "her"])
                || body[i..next].iter().any(|t| text(t) == "so") && opens_order(rest)
                // "make room: the bus goes to the right edge"
                || text(t) == ":" && !(from..i).any(|k| is_place(&body[k..i]))
                || super::some_of::removes_it(&body[from..i])
                || body[from..i].iter().any(|t| HELPERS.contains(&text(t)));
            // "take the barrier and put it behind me" is one
            let lifts = is(body.get(from), &["take", "grab", "pick", "lift", "get"])
                && is(body.get(next + 1), &["it", "them", "him", "her"])
                && !(from + 1..i).any(|k| {
                    let off = (from + 1..=k).any(|j| is(body.get(j), &["out", "off", "away", "from"]));
                    is_place(&body[k..i]) && !off
                });
            // "both walkers, they must change"
            let named = is(rest.first(), &PRONOUNS)
                && t.kind == TokenKind::Comma
                && first_noun(&body[from..i]).is_some_and(|n| {
                    n.0 < 5
                        && is(
                            body.get(from),
                            &["the", "both", "all", "that", "those", "these", "my"],
                        )
                })
                && !body[from..i]
                    .iter()
                    .any(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), false));
            let therefore = is(rest.first(), &PRONOUNS) && body[i..next].iter().any(|t| text(t) == "so");
            // "undo the barriers, and instead of the digger put a truck there"
            let instead = is(body.get(next - 1), &["and", "but", "then"])
                && leads(rest, &["instead of the", "in place of the", "rather than the"]).is_some()
                && super::super::rephrase::is_verb(&body[from]);
            // "the van and the truck are to disappear": two subjects of one verb
            let let_ = usize::from(is(body.get(from), &["let", "have", "should", "may"]));
            let joined = text(t) == "and"
                && is(
                    body.get(from + let_),
                    &["the", "both", "all", "every", "my", "that", "those", "these"],
                )
                && first_noun(&body[from..i]).is_some_and(|n| n.0 < 5 + let_ && from + n.1 == i)
                && is(
                    body.get(next),
                    &["the", "both", "all", "every", "my", "that", "those", "these"],
                );
            // "only the cones and barriers are left"
            let only = text(t) == "and"
                && is(body.get(from), &["only", "just"])
                && first_noun(&body[from..i]).is_some_and(|n| n.0 < 5 && from + n.1 == i)
                && first_noun(&body[next.min(body.len())..]).is_some_and(|n| n.0 < 3);
            if joined || only {
                i += 1;
                continue;
            }
            // weather and light are told apart from the rest
            let next_link = (next..body.len())
                .find(|k| {
                    body[*k].kind == TokenKind::Comma || matches!(text(&body[*k]), "and" | "but" | "while")
                })
                .unwrap_or(body.len());
            let sky = only_sky(&body[from..i]) && next < body.len() && !only_sky(&body[next..])
                || only_sky(&body[next.min(body.len())..next_link]) && !only_sky(&body[from..i]) && spoken;
            if sky {
                out.push(&body[from..i]);
                from = next;
                i = next.max(i + 1);
                continue;
            }
            let goes_on =
                text(t) == "and" || t.kind == TokenKind::Comma || matches!(text(t), "while" | "whereas");
            if !lead
                && !lifts
                && !named
                && !therefore
                && spoken
                && (instead
                    || keeps_others(rest, &body[from..i])
                    || tells_of_new(rest, &body[from..i], talk)
                    || opens(
                        rest,
                        &Talk {
                            carried: goes_on && (carries(&body[from..i]) || carried_on(&body[from..i], talk)),
                            last: None,
                            ..*talk
                        },
                    ))
                && !starts_where(&body[from..i])
            {
                out.push(&body[from..i]);
                from = next;
                i = next;
            }
        }
        i += 1;
    }
    out.push(&body[from..]);
    out.retain(|c| !c.is_empty());
    out
}

/// True if these words are of weather and light alone.
pub(super) fn only_sky(tokens: &[Token]) -> bool {
    let style = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    // "clear the kerb" is no weather
    let clears = is(tokens.first(), &["clear"])
        && is(
            tokens.get(1),
            &[
                "the", "my", "our", "all", "away", "out", "up", "off", "every", "that", "this", "both",
            ],
        );
    let points = (0..tokens.len()).any(|i| {
        is(tokens.get(i), &["it", "them", "he", "she", "they"])
            && !is(
                tokens.get(i + 1),
                &[
                    "be", "is", "should", "becomes", "gets", "has", "was", "turns", "starts", "begins",
                    "must", "all",
                ],
            )
            && !is(tokens.get(i.wrapping_sub(1)), &["make", "let"])
    });
    tokens.iter().any(style)
        && !clears
        && !has_noun(tokens)
        && !is(tokens.first(), &["where", "instead", "rather"])
        && !points
        && !tokens.iter().any(|t| number(t).is_some())
}

/// "where the truck is, put a digger" and "instead of the van, ..." are one clause.
pub(super) fn starts_where(tokens: &[Token]) -> bool {
    is(
        tokens.first(),
        &["where", "instead", "whatever", "whichever", "rather", "unless"],
    ) && has_noun(tokens)
        || leads(
            tokens,
            &[
                "in place of",
                "in lieu of",
                "by the time",
                "apart from",
                "except for",
            ],
        )
        .is_some()
}

/// True if a clause is "put the truck in the left lane".
pub(super) fn carries(clause: &[Token]) -> bool {
    let (inner, _) = unwrapped(clause);
    carrying(inner)
        && first_noun(inner).is_some_and(|n| n.0 < 6 && (n.1..inner.len()).any(|i| is_place(&inner[i..])))
}

/// True if the verb that begins these words may hold for the next clause, too: "put ...", "take ... to ...".
pub(super) fn carrying(inner: &[Token]) -> bool {
    const SENDS: &[&str] = &[
        "put",
        "move",
        "place",
        "set",
        "bring",
        "shift",
        "send",
        "position",
        "reposition",
        "relocate",
        "transfer",
        "park",
        "stand",
    ];
    const TAKES: &[&str] = &["take", "get", "pull", "push", "steer", "guide", "slide", "drag"];
    let goal = || inner.iter().any(|t| is(Some(t), &["to", "into", "onto"]));
    is(inner.first(), SENDS) || is(inner.first(), TAKES) && goal()
}

/// True if a clause is "the truck goes over to the left lane": who is known is elsewhere.
pub(super) fn carried_on(clause: &[Token], talk: &Talk<'_>) -> bool {
    let (inner, mood) = unwrapped(clause);
    subject(inner, talk, mood.caused).is_some_and(|s| {
        let pred = &inner[s.pred..];
        s.kind == Kind::Known
            && s.pred > 1
            && !mood.denied
            && is(inner.first(), &WHOLE)
            && !pred
                .iter()
                .any(|t| NEGATED.contains(&text(t)) || t.kind == TokenKind::Comma)
            && (1..pred.len()).any(|i| is_place(&pred[i..]))
            && super::predicate::parts(pred, s.plural || mood.caused)
                .iter()
                .all(|p| !p.is_gone() && !p.perfect)
    })
}

/// "the taxi is at the kerb and two people stand next to it": after a whole clause of its own a number of something new does.
fn tells_of_new(rest: &[Token], before: &[Token], talk: &Talk<'_>) -> bool {
    let (inner, mood) = unwrapped(rest);
    let let_ = usize::from(is(inner.first(), &["let", "have"]));
    let inner = &inner[let_..];
    let caused = mood.caused || let_ == 1;
    let fresh = inner.first().is_some_and(|t| {
        number(t).is_some() || matches!(text(t), "some" | "several" | "many" | "somebody" | "someone")
    });
    if !fresh || mood.denied || is(inner.get(1), &["of", "more", "others"]) {
        return false;
    }
    let near = &inner[..inner.len().min(14)];
    let does = subject(near, talk, caused).is_some_and(|s| {
        let verb = near.get(s.pred).map_or("", text);
        s.kind == Kind::Fresh && words::is_finite(verb, true) && !verb.ends_with("ed")
    });
    let (inner, mood) = unwrapped(before);
    let whole = inner.first().is_some_and(super::super::rephrase::is_verb) && has_noun(inner)
        || subject(inner, talk, mood.caused).is_some_and(|s| {
            let base = s.plural || mood.caused;
            let verb = inner.get(s.pred).map_or("", text);
            HELPERS.contains(&verb) || words::is_finite(verb, base)
        });
    does && whole
}

/// "the worker is gone, keep only one of the cones": so many of another kind.
fn keeps_others(rest: &[Token], before: &[Token]) -> bool {
    let class = |np: &[Token]| {
        let (a, b) = first_noun(np)?;
        match words::longest(&np[a..b]).map(|l| l.0) {
            Some(Sense::Noun(n, _)) => n.classes.first().copied(),
            _ => None,
        }
    };
    let keep = leads(rest, &["keep only", "keep exactly", "keep just", "keep"]);
    let counted = keep.is_some_and(|n| rest.get(n).is_some_and(|t| number(t).is_some()));
    let states = has_verb(before) && !before.first().is_some_and(super::super::rephrase::is_verb);
    counted && states && class(rest).is_some() && class(rest) != class(before)
}

/// "so let the bus stand there": what stands before only says why.
fn opens_order(rest: &[Token]) -> bool {
    (is(rest.first(), &MOVES) || rest.first().is_some_and(super::super::rephrase::is_verb))
        && is(
            rest.get(1),
            &[
                "the", "both", "all", "every", "my", "our", "that", "those", "these", "a", "an", "another",
                "it", "them", "him", "her",
            ],
        )
}

/// True if a verb is said of what is named first ("the parked car at the kerb" has none).
pub(super) fn has_verb(clause: &[Token]) -> bool {
    let from = first_noun(clause).map_or(0, |n| n.0);
    let helps = clause.iter().any(|t| HELPERS.contains(&text(t)));
    helps || clause[from..].iter().any(|t| words::is_finite(text(t), false))
}

/// True if a clause of its own begins here.
pub(super) fn opens(rest: &[Token], talk: &Talk<'_>) -> bool {
    let (inner, mood) = unwrapped(rest);
    let Some(first) = inner.first() else {
        return false;
    };
    if mood.denied
        || leads(
            rest,
            &[
                "there is",
                "there are",
                "there should",
                "there must",
                "there shall",
                "i dont",
                "we dont",
                "i would",
                "id like",
                "i want",
                "i need",
                "we need",
                "away with",
                "off with",
                "out with",
                "down with",
                "no more",
                "enough of",
            ],
        )
        .is_some()
    {
        return true;
    }
    // "and no bus"
    if is(rest.first(), &["no"])
        && first_noun(rest).is_some_and(|n| {
            n.0 < 3
                && rest
                    .get(n.1)
                    .is_none_or(|t| t.kind != TokenKind::Word || matches!(text(t), "and" | "any" | "either"))
        })
    {
        return true;
    }
    let near = &inner[..inner.len().min(14)];
    // "and turn the pickup so that it faces us"
    let orders = is(inner.first(), &MOVES)
        || is(
            inner.first(),
            &["turn", "rotate", "spin", "remove", "delete", "add", "replace"],
        );
    if orders
        && is(
            inner.get(1),
            &[
                "the", "it", "them", "him", "her", "both", "all", "my", "every", "each", "those", "these",
                "a", "an", "another", "some",
            ],
        )
    {
        return true;
    }
    if let Some(s) = subject(
        near,
        talk,
        mood.caused && leads(rest, &["let", "have", "make", "get"]).is_some(),
    ) {
        // "the tanker and the van and put a car there": the verb is a command of its own
        if s.pred > 0 && is(near.get(s.pred - 1), &["and", "then"]) && s.kind == Kind::Known {
            return false;
        }
        // "15 m ahead, two cars parked": a list goes on, and is no clause
        return match s.kind {
            Kind::Fresh => {
                HELPERS.contains(&text(&near[s.pred]))
                    || find(near, &["in"]).is_some() && text(&near[s.pred]) == "in"
                    || is(near.first(), &["a", "an", "another"])
                        && near[s.pred..]
                            .iter()
                            .find(|t| !super::lists::ADVERBS.contains(&text(t)))
                            .is_some_and(|t| words::is_finite(text(t), false) && !text(t).ends_with("ed"))
                    || in_place(near).is_some()
            }
            Kind::Known => {
                is(
                    near.first(),
                    &[
                        "the", "my", "that", "this", "those", "these", "both", "all", "every", "our",
                    ],
                ) || HELPERS.contains(&text(&near[s.pred]))
                    || matches!(text(&near[s.pred]), "in" | "out" | "gone" | "away" | "off")
            }
            _ => true,
        };
    }
    // "and in its place there is a roller"
    if in_place(near).is_some_and(|p| p.0 == 0) && has_noun(&near[2..]) {
        return true;
    }
    // "and a tram in its place"
    if is(near.first(), &["a", "an", "another"])
        && first_noun(near).is_some_and(|n| in_place(&near[n.1..]).is_some_and(|p| p.0 < 2))
    {
        return true;
    }
    // "... and the car in the right lane"
    if is(near.first(), &WHOLE)
        && first_noun(near).is_some_and(|n| n.0 < 4 && is_place(&near[n.1..]))
        && talk.carried
        && !has_verb(near)
    {
        return true;
    }
    // "and now only one worker is there"
    if is(inner.first(), &["only", "just"]) && inner.get(1).is_some_and(|t| number(t).is_some()) {
        return true;
    }
    // "and double the barriers"
    if is(
        inner.first(),
        &["double", "halve", "triple", "treble", "quadruple"],
    ) && is(inner.get(1), &["the", "all", "my"])
    {
        return true;
    }
    // "one car fewer"
    if number(first).is_some()
        && first_noun(inner).is_some_and(|n| n.0 < 4 && is(inner.get(n.1), &["fewer", "less"]))
    {
        return true;
    }
    // "two would do"
    if number(first).is_some()
        && is(
            inner.get(1),
            &["would", "will", "is", "are", "should", "must", "may"],
        )
    {
        return true;
    }
    let verb = super::super::rephrase::is_verb(first)
        && !is_place(inner)
        && !matches!(text(first), "up" | "face" | "facing" | "about");
    // "take away all the pedestrians", "set up four cones"
    let brings = is(
        inner.first(),
        &[
            "take", "set", "put", "bring", "clear", "throw", "get", "wipe", "line", "pull",
        ],
    );
    let particle = usize::from(brings && is(inner.get(1), &["away", "up", "down", "in", "out", "off"]));
    verb && inner.get(1 + particle).is_some_and(|t| {
        matches!(
            text(t),
            "the"
                | "a"
                | "an"
                | "it"
                | "them"
                | "him"
                | "her"
                | "both"
                | "all"
                | "that"
                | "this"
                | "another"
                | "my"
                | "one"
                | "two"
                | "everything"
                | "everyone"
                | "nothing"
                | "any"
        ) || number(t).is_some()
    })
}
