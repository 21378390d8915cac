//! Briefs as designers give them: "coach out, two motorbikes in the left lane", "farther off with the car, please: 32 m", "nobody
//! on foot, nothing parked, just the bus".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::brief_places::{beyond, in_which_there, opposite_named, same_side, to_the_other, with_doing};
use super::brief_turns::{
    apposed, in_other_words, instead_first, not_that, rider_apposed, sky_and_gone, sky_last, somebody_of,
};
use super::brief_wholes::TOO;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, is_unit, leads, led, number, text, trimmed,
};

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = instead_first(to_the_other(sky_last(cut_to(tokens)), talk), talk);
    let out = beyond(with_doing(out), talk);
    let out = same_side(opposite_named(not_that(in_other_words(out), talk)), talk);
    let out = out_and_in(pulls_out(out), talk);
    let out = farther_with(wanted_at(out, talk), talk);
    let out = nothing_but(out, talk);
    let out = sky_and_gone(in_which_there(out));
    somebody_of(rider_apposed(apposed(out)), talk)
}

/// "let the bus pull out: it drives in my lane now": it does not go away.
fn pulls_out(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(
        &tokens,
        &[
            "pull out",
            "pulls out",
            "has pulled out",
            "is pulling out",
            "pulled out",
            "pull away",
            "pulls away",
        ],
    ) else {
        return tokens;
    };
    let after = &tokens[k + n..];
    let mark = after
        .first()
        .is_some_and(|t| !matches!(t.kind, TokenKind::Word | TokenKind::Number(_)))
        || is(after.first(), &["and"]);
    let rest = trimmed(after);
    let subject = first_noun(&tokens[..k]).is_some_and(|x| x.1 == k);
    let verb = rest
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !(mark && subject && verb) {
        return tokens;
    }
    if is(rest.first(), &["it", "he", "she", "they"]) {
        let who: &[Token] = if is(tokens.first(), &["let", "have"]) {
            &tokens[1..k]
        } else {
            &tokens[..k]
        };
        return [who, &rest[1..]].concat();
    }
    tokens
}

pub(super) const OUT: [&str; 4] = ["out", "off", "away", "gone"];
const SAME_SPOT: &str = "in at the very same spot|in at the same spot|at the very same spot|at the same spot|in the very same spot|in the same spot|at the same place|\
    in the same place|in at the same place|in its place|in its spot|in its stead|in there|in instead|instead|in the same position|at the same position|in at the very same place|in";

/// "police car out, fire engine in at the very same spot", "coach out, two motorbikes in the left lane".
fn out_and_in(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let parts: Vec<&[Token]> = tokens
        .split(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]))
        .map(trimmed)
        .filter(|p| !p.is_empty())
        .collect();
    let [gone, new] = parts.as_slice() else {
        return tokens;
    };
    let Some((last, who)) = gone.split_last().filter(|x| is(Some(x.0), &OUT)) else {
        return tokens;
    };
    let named = first_noun(who).is_some_and(|x| x.0 < 4)
        && !who
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    let Some((a, b)) = first_noun(new).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let counted = new[..a]
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]));
    let definite = is(new.first(), &["the", "both", "all", "my", "that"]);
    let rest = trimmed(&new[b..]);
    let verbs = new
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false) || is(Some(t), &OUT));
    let there = begins(rest, SAME_SPOT).filter(|n| *n == rest.len());
    if is(rest.first(), &["on"]) && rest.len() == 1 {
        return tokens; // "cyclists off, mopeds on"
    }
    let fresh = counted || talk.fits(&new[..b]) == 0 || there.is_some_and(|n| n > 1);
    if !named
        || definite
        || verbs
        || !fresh
        || talk.fits(who) == 0
        || (rest.is_empty() || there.is_none() && !is_place(rest))
    {
        return tokens;
    }
    let the = if is(who.first(), &["the", "both", "all", "my", "that", "every"]) {
        ""
    } else {
        "the"
    };
    let mut out = led(
        "remove",
        last,
        &[
            &if the.is_empty() {
                Vec::new()
            } else {
                led(the, last, &[])
            },
            who,
        ],
    );
    out.extend(led(
        if counted { "and add" } else { "and add a" },
        &new[0],
        &[&new[..b]],
    ));
    if there.is_some() {
        out.extend(led("in its place", &new[0], &[]));
    } else {
        // ("in the left lane instead")
        let end = rest.len() - usize::from(is(rest.last(), &["instead"]));
        out.extend_from_slice(&rest[..end]);
    }
    out
}

/// "the barriers are too far off, I'd have them at 15 m", "... ; 10 m in front of me is what I'm after": that is where.
fn wanted_at(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((k, n)) = find(&tokens, TOO) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4 && x.1 < k + 1) else {
        return tokens;
    };
    let stands = tokens[b..k].iter().all(|t| {
        matches!(
            text(t),
            "is" | "are"
                | "sits"
                | "sit"
                | "stands"
                | "stand"
                | "drives"
                | "drive"
                | "seems"
                | "still"
                | "was"
                | "were"
                | "a"
                | "bit"
                | "rides"
                | "follows"
        )
    });
    let mark = (k + n..tokens.len()).find(|i| {
        matches!(tokens[*i].kind, TokenKind::Comma | TokenKind::Mark)
            || is(tokens.get(*i), &["so", "and"])
            || text(&tokens[*i]) == ";"
    });
    let Some(mark) = mark.filter(|m| *m <= k + n + 3 && stands && talk.fits(&tokens[..b]) > 0) else {
        return tokens;
    };
    let rest = &tokens[mark + 1..];
    let Some(m) = (0..rest.len()).find(|i| number(&rest[*i]).is_some() && is_unit(rest.get(i + 1))) else {
        return tokens;
    };
    // what is done to it is a command of its own: "push it 8 m away"
    if !rest[..m].iter().all(|t| is(Some(t), WISHES)) {
        return tokens;
    }
    let end = (m + 2..rest.len())
        .find(|i| {
            is(
                rest.get(*i),
                &[
                    "is", "would", "will", "should", "please", "and", "instead", "seems",
                ],
            ) || !matches!(rest[*i].kind, TokenKind::Word)
        })
        .unwrap_or(rest.len());
    let place = if end == m + 2 {
        led("away", &rest[m], &[])
    } else {
        Vec::new()
    };
    let who = if is(tokens.first(), &["the", "both", "all", "that", "my"]) {
        tokens[..b].to_vec()
    } else {
        led("the", &tokens[0], &[&tokens[..b]])
    };
    let tail = match rest.get(end) {
        Some(t) if is(Some(t), &["and"]) => &rest[end..],
        _ => &[][..],
    };
    [
        &who[..],
        &led("should be", &rest[m], &[&rest[m..end], &place]),
        tail,
    ]
    .concat()
}

const WISHES: &[&str] = &[
    "i",
    "id",
    "we",
    "wed",
    "would",
    "like",
    "have",
    "want",
    "need",
    "it",
    "them",
    "him",
    "her",
    "at",
    "should",
    "shall",
    "must",
    "be",
    "is",
    "are",
    "rather",
    "prefer",
    "only",
    "just",
    "better",
    "make",
    "that",
    "a",
    "the",
    "wants",
    "wish",
    "to",
    "about",
    "say",
    "something",
    "put",
    "there",
    "more",
];

const CLOSER: &[&str] = &[
    "farther off with",
    "further off with",
    "farther away with",
    "further away with",
    "closer with",
    "nearer with",
    "farther with",
    "further with",
    "farther back with",
    "further back with",
    "back with",
    "forward with",
    "farther out with",
    "further out with",
    "up with",
    "closer in with",
];

/// "farther off with the car, please: 32 m": that is how far it is.
fn farther_with(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, CLOSER) else {
        return tokens;
    };
    let rest = &tokens[n..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let after = trimmed(&rest[b..]);
    let after = if is(after.first(), &["to"]) {
        &after[1..]
    } else {
        after
    };
    let after: Vec<Token> = after
        .iter()
        .skip_while(|t| !matches!(t.kind, TokenKind::Number(_)) && number(t).is_none())
        .cloned()
        .collect();
    let metres = after.first().is_some_and(|t| number(t).is_some()) && is_unit(after.get(1));
    if !metres || talk.fits(&rest[..b]) == 0 {
        return tokens;
    }
    let away = if after.len() == 2 {
        led("away", &after[0], &[])
    } else {
        Vec::new()
    };
    [&rest[..b], &led("should be", &after[0], &[&after, &away])].concat()
}

/// "nobody on foot, nothing parked, just the bus": only the bus stays.
fn nothing_but(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let parts: Vec<&[Token]> = tokens
        .split(|t| t.kind == TokenKind::Comma || text(t) == ":")
        .map(trimmed)
        .filter(|p| !p.is_empty())
        .collect();
    let Some((last, before)) = parts.split_last() else {
        return tokens;
    };
    let keeps = is(last.first(), &["just", "only"]) && is(last.get(1), &["the", "my", "that", "both"]);
    let none = |p: &&&[Token]| is(p.first(), &["no", "nobody", "nothing", "noone", "neither"]) && p.len() < 8;
    // ("it is night, and neither cars nor people are left, just the motorcycle")
    let sky = before
        .iter()
        .take_while(|p| super::parting::only_sky(p) && !has_noun(p))
        .count();
    let (sky, before) = before.split_at(sky);
    let some = before.iter().filter(none).count();
    let bare = first_noun(last).is_some_and(|x| x.1 == last.len()) && talk.fits(&last[1..]) > 0;
    if !(keeps && bare && some > 0 && some == before.len()
        || keeps && bare && before.is_empty() && tokens.len() < 6)
    {
        return tokens;
    }
    let gone = led("remove everything except", &last[0], &[&last[1..]]);
    match sky.last() {
        Some(_) => {
            let words: Vec<&[Token]> = sky.to_vec();
            [words.concat(), led("and", &last[0], &[&gone])].concat()
        }
        None => gone,
    }
}

/// "cut the queue to a single person", "trim the row of cars down to two cars": so many stay.
fn cut_to(tokens: Vec<Token>) -> Vec<Token> {
    const LESS: &[&str] = &[
        "cut", "reduce", "trim", "shorten", "thin", "shrink", "bring", "limit", "pare",
    ];
    const GROUP: &[&str] = &[
        "queue",
        "line",
        "row",
        "group",
        "crowd",
        "bunch",
        "cluster",
        "gathering",
    ];
    if !is(tokens.first(), LESS) || !is(tokens.get(1), &["the", "that", "this"]) || !is(tokens.get(2), GROUP)
    {
        return tokens;
    }
    let Some((k, n)) = find(&tokens, &["down to", "to"]).filter(|x| x.0 > 2 && x.0 < 8) else {
        return tokens;
    };
    let rest = &tokens[k + n..];
    let one = leads(rest, &["a single", "just one", "only one", "one single"]);
    let from = one.or_else(|| rest.first().is_some_and(|t| number(t).is_some()).then_some(1));
    let Some((from, (_, b))) = from.and_then(|f| Some((f, first_noun(&rest[f..]).filter(|x| x.0 < 3)?)))
    else {
        return tokens;
    };
    let count = if one.is_some() {
        led("one", &rest[0], &[])
    } else {
        rest[..1].to_vec()
    };
    [
        &led("keep exactly", &tokens[0], &[&count, &rest[from..from + b]])[..],
        &rest[from + b..],
    ]
    .concat()
}
