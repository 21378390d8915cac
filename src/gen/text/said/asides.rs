//! Remarks that end a command and ask for nothing: ", I like buses", ", that looks better", "so nobody runs into it".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::lists::HELPERS;
use super::words::{has_noun, is, is_finite, is_place, leads, number, text};

const FEELS: &[&str] = &[
    "like",
    "love",
    "adore",
    "hate",
    "dislike",
    "enjoy",
    "prefer",
    "detest",
    "fancy",
    "miss",
    "dont like",
    "do not like",
    "cant bear",
    "cannot bear",
    "can not bear",
    "cant stand",
    "cannot stand",
    "can not stand",
    "cant take",
    "cant look",
    "cant watch",
    "am fond of",
    "am afraid of",
    "am scared of",
    "am tired of",
    "am bored of",
    "am sick of",
    "am fed up with",
    "have always liked",
    "have always loved",
    "have always wanted",
    "have had enough of",
];
const WANTS: &[&str] = &[
    "want",
    "need",
    "like",
    "love",
    "prefer",
    "would like",
    "would love",
    "would prefer",
    "would rather have",
];
const WHOLE: &[&str] = &[
    "it",
    "things",
    "everything",
    "this place",
    "the place",
    "the scene",
    "the street",
    "the road",
    "my streets",
    "my roads",
    "my scenes",
];
/// What a scene may be without anything in it being other than it is.
const MOODS: &[&str] = &[
    "peaceful",
    "quiet",
    "calm",
    "simple",
    "tidy",
    "neat",
    "orderly",
    "realistic",
    "lively",
    "interesting",
    "nice",
    "pretty",
    "harmless",
    "boring",
    "relaxed",
    "uncluttered",
    "easy",
    "safe",
    "safer",
    "quieter",
    "calmer",
    "simpler",
    "tidier",
    "neater",
    "nicer",
    "easier",
    "better",
    "prettier",
    "cleaner",
    "fair",
    "fairer",
    "dangerous",
    "risky",
    "exciting",
    "funny",
    "ugly",
    "great",
    "fine",
    "good",
    "perfect",
    "silly",
    "cosy",
    "scary",
    "unsafe",
    "unfair",
    "enough",
    "fun",
];
const DEGREES: &[&str] = &[
    "much", "a", "lot", "far", "so", "very", "more", "just", "too", "really", "way", "less", "rather", "bit",
    "little", "also", "always", "most", "quite", "nice", "and",
];
const JUDGES: &[&str] = &[
    "is",
    "looks",
    "would be",
    "will be",
    "feels",
    "seems",
    "makes it",
    "makes things",
    "would look",
    "makes everything",
    "keeps it",
    "keeps things",
];
/// What somebody is to be spared.
const HARM: &[&str] = &[
    "runs",
    "run",
    "drives",
    "drive",
    "bumps",
    "bump",
    "crashes",
    "crash",
    "falls",
    "fall",
    "trips",
    "trip",
    "stumbles",
    "stumble",
    "hits",
    "hit",
    "gets",
    "get",
    "touches",
    "touch",
    "misses",
    "miss",
    "parks",
    "park",
    "enters",
    "enter",
    "collides",
    "collide",
    "slips",
    "slip",
    "rides",
    "ride",
    "can",
    "could",
    "overlooks",
    "has",
    "needs",
];
/// What somebody is to be able to do.
const HELP: &[&str] = &[
    "notice",
    "notices",
    "see",
    "sees",
    "slow",
    "slows",
    "know",
    "knows",
    "avoid",
    "avoids",
    "pass",
    "passes",
    "understand",
    "react",
    "can",
    "could",
    "brake",
    "brakes",
    "get",
    "gets",
    "are",
    "is",
];

/// A text without such remarks.
pub fn without(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = in_the_way(tokens);
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let close = sentence
            .iter()
            .position(|t| t.kind == TokenKind::Stop)
            .unwrap_or(sentence.len());
        match begin(&sentence[..close]) {
            Some(i) => out.extend(sentence[..i].iter().chain(&sentence[close..]).cloned()),
            None => out.extend_from_slice(sentence),
        }
    }
    out
}

/// "leave it in the junction, where it blocks everything": who has to wait is not told.
fn in_the_way(tokens: Vec<Token>) -> Vec<Token> {
    const WHERE: &str = "where it|where he|where she|where they|so that it|so that they|so it|so they|and it|which|because it|since it";
    const BLOCKS: &str = "blocks|block|obstructs|obstruct|holds up|hold up|is blocking|are blocking|will block|can block|stops|gets in the way of|is in the way of|disturbs|hinders";
    const ALL: &str = "everything|everybody|everyone|all|all of us|all traffic|all the traffic|the traffic|the whole traffic|everything else|everybody else|everyone else|all the others|the others|the whole road|the whole street|the way";
    rewritten(&tokens, |i, out| {
        let comma = usize::from(tokens[i].kind == TokenKind::Comma);
        let mut k = i + comma;
        k += begins(tokens.get(k..)?, WHERE)?;
        k += begins(tokens.get(k..)?, BLOCKS)?;
        k += begins(tokens.get(k..)?, ALL)?;
        let ends = tokens.get(k).is_none_or(|t| t.kind != TokenKind::Word);
        (ends && !out.is_empty()).then_some(k)
    })
}

/// Where the remark at the end of a sentence begins.
fn begin(sentence: &[Token]) -> Option<usize> {
    let from = sentence.len().saturating_sub(16).max(2);
    (from..sentence.len())
        .find(|i| {
            let before = &sentence[..*i];
            let rest = &sentence[*i..];
            if !asks(before) {
                return false;
            }
            let after_mark = matches!(before[i - 1].kind, TokenKind::Comma | TokenKind::Mark);
            let why = leads(rest, &["because", "since", "as", "for", "cause", "cos"]).unwrap_or(0);
            (after_mark || why > 0) && (feeling(&rest[why..]) || judgement(&rest[why..]))
                || purpose(rest)
                || (after_mark || is(before.last(), &["and", "so"])) && shows_it(rest)
        })
        // (the mark or "and" before goes with it)
        .map(|i| {
            let marks = sentence[..i]
                .iter()
                .rev()
                .take_while(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)));
            i - marks.count()
        })
}

/// "can you show it", "please add it": what was told is to be there anyhow.
fn shows_it(rest: &[Token]) -> bool {
    let ask = leads(
        rest,
        &[
            "can you",
            "could you",
            "can you please",
            "could you please",
            "would you",
            "please",
            "you can",
            "so please",
            "so can you",
            "do",
        ],
    )
    .unwrap_or(0);
    is(
        rest.get(ask),
        &["show", "display", "draw", "depict", "include", "picture"],
    ) && is(rest.get(ask + 1), &["it", "that", "this", "them", "him", "her"])
        && rest[ask + 2..].iter().all(|t| {
            is(
                Some(t),
                &["please", "too", "there", "here", "for", "me", "us", "as", "well"],
            )
        })
}

/// True if these words command or tell something of what is in the scene.
fn asks(before: &[Token]) -> bool {
    let first = before.iter().find(|t| {
        t.kind == TokenKind::Word
            && !is(
                Some(t),
                &["please", "and", "now", "then", "ok", "just", "also", "kindly"],
            )
    });
    let orders = first.is_some_and(is_verb);
    let says = has_noun(before)
        && (before.iter().any(|t| {
            HELPERS.contains(&text(t))
                || is_finite(text(t), false)
                || is(Some(t), &["more", "less", "fewer", "no"])
        }) || (1..before.len()).any(|k| is_place(&before[k..])));
    orders && before.len() > 1 || says
}

/// True if nothing in these words could tell how something is or where.
fn vague(rest: &[Token]) -> bool {
    // ("I can't stand the noise")
    let the =
        usize::from(is(rest.first(), &["the", "this", "all", "that", "such", "these"]) && !has_noun(rest));
    let rest = &rest[the..];
    rest.len() < 6
        && rest.iter().enumerate().all(|(k, t)| {
            let sense = look_up(text(t));
            t.kind == TokenKind::Word
                && number(t).is_none()
                && !is(
                    Some(t),
                    &[
                        "the", "my", "our", "a", "an", "this", "these", "those", "another", "more", "no",
                        "not", "only", "gone", "there", "if", "when", "instead", "one", "ones", "other",
                        "others", "rest",
                    ],
                )
                && !matches!(
                    sense,
                    Some(
                        Sense::Weather(_)
                            | Sense::Time(_)
                            | Sense::State(..)
                            | Sense::Color(_)
                            | Sense::Place(..)
                    )
                )
                && (is(Some(t), &["to"]) || !is_place(&rest[k..]))
        })
}

/// "I like buses", "I can't bear to watch", "I want it peaceful here".
fn feeling(rest: &[Token]) -> bool {
    let Some(who) = leads(rest, &["i", "we", "im", "ive", "id"]) else {
        return false;
    };
    let mut k = who;
    while is(
        rest.get(k),
        &[
            "really", "just", "simply", "always", "rather", "do", "much", "truly", "quite",
        ],
    ) {
        k += 1;
    }
    let rest = &rest[k..];
    let wants = leads(rest, WANTS).and_then(|n| leads(&rest[n..], WHOLE).map(|m| n + m));
    if let Some(n) = wants
        && mood(&rest[n..])
    {
        return true;
    }
    // ("I'm tired of buses")
    let feels = leads(rest, FEELS).or_else(|| {
        FEELS
            .iter()
            .filter_map(|f| f.strip_prefix("am ").or_else(|| f.strip_prefix("have ")))
            .find_map(|f| leads(rest, &[f]).filter(|_| who == 1 && k > 0))
    });
    feels.is_some_and(|n| {
        let what = &rest[n..];
        let way = leads(
            what,
            &["it this way", "it that way", "it like this", "it like that"],
        );
        // ("I can't bear to watch")
        let does = is(what.first(), &["to"])
            && is(what.get(1), &["watch", "look", "see", "think"])
            && what.len() < 5
            && !has_noun(what);
        way == Some(what.len()) || does || vague(what)
    })
}

/// "much more peaceful here".
fn mood(rest: &[Token]) -> bool {
    let n = rest
        .iter()
        .take_while(|t| is(Some(t), DEGREES) && !is(Some(t), MOODS))
        .count();
    let said = is(rest.get(n), MOODS) || is(rest.get(n), DEGREES) && n > 0;
    let tail = &rest[(n + 1).min(rest.len())..];
    let tail = &tail[usize::from(is(tail.first(), &["and", "here", "now"])).min(tail.len())..];
    said && tail.len() < 5
        && tail.iter().all(|t| {
            is(Some(t), MOODS)
                || is(
                    Some(t),
                    &[
                        "here",
                        "now",
                        "that",
                        "this",
                        "way",
                        "again",
                        "for",
                        "everyone",
                        "everybody",
                        "all",
                        "us",
                        "me",
                        "like",
                        "in",
                        "today",
                        "of",
                    ],
                )
        })
}

/// "that looks better", "it's safer that way", "too dangerous".
fn judgement(rest: &[Token]) -> bool {
    if let Some(n) = leads(rest, &["its", "thats"]) {
        return mood(&rest[n..]);
    }
    let who = leads(rest, &["that", "it", "this", "which"]);
    who.and_then(|n| leads(&rest[n..], JUDGES).map(|m| n + m))
        .is_some_and(|n| mood(&rest[n..]))
}

/// What something is put there to do.
const AIMS: &[&str] = &[
    "to warn",
    "to protect",
    "to alert",
    "to remind",
    "to prevent",
    "to discourage",
    "to deter",
    "to impress",
    "to scare",
    "to shield",
    "to safeguard",
    "to slow down",
    "to divert",
    "to annoy",
    "to stop people",
    "to stop cars",
    "to stop drivers",
    "to stop traffic",
    "to stop anyone",
    "to stop others",
    "to keep people",
    "to keep cars",
    "to keep drivers",
    "to keep traffic",
    "to keep anyone",
    "to keep others",
    "to keep everyone",
    "in order to warn",
    "in order to protect",
];

/// "so nobody runs into it", "so that people notice it", "to warn other drivers": what for.
fn purpose(rest: &[Token]) -> bool {
    if let Some(n) = leads(rest, AIMS) {
        let mark =
            |t: &Token| t.kind != TokenKind::Word || is(Some(t), &["and", "then", "but", "by", "with"]);
        return rest.len() > n && rest.len() < n + 8 && !rest.iter().any(mark);
    }
    let Some(n) = leads(rest, &["so that", "so"]) else {
        return false;
    };
    let rest = &rest[n..];
    let none = leads(
        rest,
        &[
            "nobody",
            "no one",
            "nothing",
            "no car",
            "no cars",
            "no driver",
            "no drivers",
        ],
    );
    let some = leads(
        rest,
        &[
            "people",
            "drivers",
            "everyone",
            "everybody",
            "others",
            "motorists",
            "other drivers",
            "the drivers",
            "road users",
            "one",
            "you",
            "the others",
        ],
    );
    let (verbs, n) = match (none, some) {
        (Some(n), _) => (HARM, n),
        (_, Some(n)) => (HELP, n),
        _ => return false,
    };
    let what = &rest[n..];
    let tail = &what[1.min(what.len())..];
    let ends = |t: &Token| {
        !matches!(t.kind, TokenKind::Word | TokenKind::Number(_)) || is(Some(t), &["and", "then"])
    };
    let gets = is(what.first(), &["has", "are", "is", "needs"]);
    let hurt = is(
        tail.first(),
        &["hurt", "warned", "safe", "careful", "to", "injured"],
    );
    is(what.first(), verbs) && !tail.iter().any(ends) && (!gets || hurt) && !has_noun(tail)
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn remarks_are_left_out() {
        let said = |t: &str| {
            let list: Vec<String> = without(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(said("make the car a bus, I like buses."), "make the car a bus .");
        assert_eq!(said("take both away, I can't bear to watch"), "take both away");
        assert_eq!(said("remove the bus, I want it peaceful here"), "remove the bus");
        assert_eq!(said("remove the bus, that looks much better"), "remove the bus");
        assert_eq!(
            said("two cones behind the bus so nobody runs into it"),
            "two cones behind the bus"
        );
        for whole in [
            "remove the bus , i want it behind me",
            "remove the bus , i want a car",
            "move the bus so nobody is behind it",
            "i like buses",
            "delete the car , i prefer the bus",
        ] {
            assert_eq!(said(whole), whole);
        }
    }
}
