//! Some of a group stay or go: "of the cars, leave only two", "the cones can go, all except two", "two cars are one too many".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::words::{find, first_noun, is, is_finite, leads, led, number, text, trimmed};

/// What says that something shall be there.
pub const WISHES: &[&str] = &[
    "there should be",
    "there must be",
    "there shall be",
    "let there be",
    "there are",
    "i want",
    "i would like",
    "id like",
    "i need",
    "we need",
    "we want",
    "put",
    "have",
    "make it",
    "make that",
    "use",
    "show",
    "give me",
    "id prefer",
    "let me have",
    "let it be",
    "add",
    "place",
    "id rather have",
    "park",
    "there ought to be",
    "there could be",
    "insert",
    "let us have",
];

/// The sentence in plain words, if it is one of them.
pub fn plain(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    of_them(tokens, talk)
        .or_else(|| for_each(tokens))
        .or_else(|| all_except(tokens))
        .or_else(|| instead_of_number(tokens))
        .or_else(|| too_many(tokens, talk))
        .or_else(|| only_of(tokens))
}

fn goes(tokens: &[Token]) -> bool {
    tokens.iter().any(|t| {
        matches!(
            text(t),
            "go" | "goes"
                | "gone"
                | "leave"
                | "disappear"
                | "vanish"
                | "removed"
                | "deleted"
                | "away"
                | "out"
                | "off"
                | "erased"
        )
    })
}

pub fn removes(t: Option<&Token>) -> bool {
    is(
        t,
        &[
            "remove", "delete", "erase", "take", "drop", "bin", "scrap", "cut", "lose", "clear", "discard",
        ],
    )
}

/// "remove them", "get rid of it".
pub fn removes_it(clause: &[Token]) -> bool {
    let verb = leads(
        clause,
        &[
            "remove",
            "delete",
            "erase",
            "leave out",
            "take out",
            "take away",
            "get rid of",
            "do away with",
        ],
    )
    .or_else(|| removes(clause.first()).then_some(1));
    verb.is_some_and(|n| {
        is(clause.get(n), &["it", "them", "him", "her"])
            && clause[n + 1..]
                .iter()
                .all(|t| is(Some(t), &["out", "away", "too", "please", "off", "now"]))
    })
}

fn digits(n: usize, at: &Token) -> Token {
    Token {
        kind: TokenKind::Number(n as f64),
        text: n.to_string(),
        span: at.span,
    }
}

/// A noun phrase without article and number.
pub fn bare_np(np: &[Token]) -> Vec<Token> {
    let skip = |t: &Token| {
        is(
            Some(t),
            &["the", "my", "these", "those", "all", "our", "of", "both"],
        ) || number(t).is_some()
    };
    let from = np.iter().position(|t| !skip(t)).unwrap_or(0);
    np[from..].to_vec()
}

/// "of the people on the right, leave only two".
fn of_them(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &["of", "out of", "among", "from among", "from", "as for", "as to"],
    )?;
    if !is(tokens.get(n), &["the", "my", "these", "those", "all", "our"]) {
        return None;
    }
    // "from the parked cars take one away"
    let comma = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma)
        .or_else(|| {
            (n + 2..tokens.len())
                .find(|k| removes(tokens.get(*k)) || is(tokens.get(*k), &["leave", "keep", "only", "just"]))
                .map(|k| k - 1)
                .filter(|k| first_noun(&tokens[n..=*k]).is_some())
        })
        // "of the four barriers one can go"
        .or_else(|| {
            let (_, b) = first_noun(&tokens[n..]).filter(|x| x.0 < 4)?;
            tokens.get(n + b).filter(|t| number(t).is_some())?;
            Some(n + b - 1)
        })?;
    let end = comma + usize::from(tokens[comma].kind != TokenKind::Comma);
    let np = tokens.get(n..end).filter(|np| first_noun(np).is_some())?;
    let rest = trimmed(&tokens[comma + 1..]);
    if first_noun(rest).is_some() {
        return None;
    }
    let k = rest.iter().position(|t| number(t).is_some()).filter(|k| *k < 4)?;
    let many = number(&rest[k])?.max(0) as usize;
    let keeps = is(
        rest.first(),
        &["leave", "keep", "retain", "spare", "preserve", "only", "just"],
    ) || rest[k + 1..].iter().any(|t| {
        matches!(
            text(t),
            "stay" | "stays" | "remain" | "remains" | "left" | "enough" | "suffice"
        )
    });
    let kept = if keeps {
        many
    } else if removes(rest.first()) || goes(&rest[k + 1..]) {
        talk.fits(np).checked_sub(many)?
    } else {
        return None;
    };
    Some(led(
        "keep exactly",
        &tokens[0],
        &[&[digits(kept, &rest[k])], &bare_np(np)],
    ))
}

/// "for each of the cones, put a barrier in its place".
fn for_each(tokens: &[Token]) -> Option<Vec<Token>> {
    let there = leads(
        tokens,
        &[
            "in place of each of the",
            "instead of each of the",
            "in place of every",
            "instead of every",
            "in place of each",
            "instead of each",
            "in place of all the",
            "instead of all the",
            "where each of the",
        ],
    );
    let n = there.or_else(|| {
        leads(
            tokens,
            &[
                "for each of the",
                "for each of these",
                "for every one of the",
                "for each",
                "for every",
            ],
        )
    })?;
    let (a, end) = first_noun(&tokens[n..]).map(|x| (n + x.0, n + x.1))?;
    let rest = trimmed(tokens.get(end..)?);
    let fresh = rest
        .iter()
        .take(5)
        .position(|t| matches!(text(t), "a" | "an" | "one"))?;
    let noun = first_noun(&rest[fresh..])?;
    let placed = find(
        rest,
        &[
            "in its place",
            "in their place",
            "instead",
            "in its stead",
            "where it stands",
            "where it is",
            "in that place",
            "there",
        ],
    )
    .is_some();
    if a > n + 3 || !(placed || there.is_some()) {
        return None;
    }
    let all = if is(tokens.get(n.saturating_sub(1)), &["the", "these"]) {
        "replace all the"
    } else {
        "replace every"
    };
    let with = led("with", &tokens[0], &[&rest[fresh..fresh + noun.1]]);
    Some(led(all, &tokens[0], &[&tokens[n..end], &with]))
}

/// "the cones can go, all except two", "remove the cones but for one".
fn all_except(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "all except for",
            "all except",
            "all but",
            "all bar",
            "all save",
            "except for",
            "except",
            "but for",
            "apart from",
            "save for",
            "but",
            "bar",
            "save",
            "with the exception of",
            "all of them except",
            "all of them but",
            "other than",
            "every one of them but",
        ],
    )?;
    let k = i + n;
    let many = number(tokens.get(k)?)?;
    // "all pedestrians apart from one person"
    let noun = first_noun(&tokens[k + 1..])
        .filter(|x| x.0 == 0)
        .map_or(0, |x| x.1);
    let end = &tokens[k + 1 + noun..];
    let ends = end.is_empty()
        || leads(end, &["of them", "of those", "of these", "please"]).is_some_and(|m| m == end.len());
    let before = trimmed(&tokens[..i]);
    let (a, b) = first_noun(before).filter(|x| x.0 < 5)?;
    let verb = before[b..]
        .iter()
        .position(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true))
        .map_or(before.len(), |v| b + v);
    let gone = goes(&before[b..])
        || removes(before.first())
        || leads(before, &["get rid of", "do away with"]).is_some();
    if !ends || !gone || many < 0 {
        return None;
    }
    let np = if removes(before.first()) {
        &before[a..]
    } else {
        &before[a..verb.max(b)]
    };
    Some(led("keep exactly", &tokens[0], &[&tokens[k..=k], np]))
}

/// "instead of just the one motorcycle there should be three".
fn instead_of_number(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, &["instead of", "rather than", "in place of"])?;
    let (a, b) = first_noun(&tokens[n..]).map(|x| (n + x.0, n + x.1))?;
    let counted = tokens[n..a].iter().any(|t| number(t).is_some());
    let rest = trimmed(&tokens[b..]);
    let suffices = number(rest.first()?).is_some()
        && (rest.len() == 1
            || rest[1..].iter().all(|t| {
                is(
                    Some(t),
                    &[
                        "will", "would", "should", "do", "suffice", "suffices", "be", "enough", "are", "is",
                        "please", "fine",
                    ],
                )
            }));
    if suffices && counted && a < n + 5 {
        return Some(led("keep exactly", &tokens[0], &[&rest[..1], &tokens[a..b]]));
    }
    // "instead of one car, three are waiting at the crossing"
    let w = leads(rest, WISHES).or_else(|| {
        let verb = rest
            .get(1)
            .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
        (verb && rest.first().is_some_and(|t| number(t).is_some())).then_some(0)
    })?;
    let k = w + usize::from(is(rest.get(w), &["just", "only"]));
    let many = rest.get(k).filter(|t| number(t).is_some())?;
    let ends =
        rest.len() == k + 1 || leads(&rest[k + 1..], &["of them", "please", "instead", "of those"]).is_some();
    // "three, all of them ahead of us"
    let tail = trimmed(&rest[k + 1..]);
    let all = leads(
        tail,
        &[
            "all of them",
            "all",
            "each of them",
            "every one of them",
            "all three",
            "of them",
            "both",
            "both of them",
        ],
    )
    .unwrap_or(0);
    let place = trimmed(&tail[all..]);
    let place = &place[if w == 0 {
        place
            .iter()
            .take_while(|t| HELPERS.contains(&text(t)) || is(Some(t), &["now", "to"]))
            .count()
    } else {
        0
    }..];
    let stands = usize::from(
        w == 0
            && is(
                place.first(),
                &[
                    "waiting", "standing", "wait", "stand", "drive", "driving", "walking", "walk", "parked",
                ],
            ),
    );
    let placed = w == 0
        && place.len() > stands
        && super::words::is_place(&place[stands..])
        && first_noun(place).is_none();
    let placed = placed
        || super::words::is_place(place)
            && first_noun(place).is_none()
            && !place.iter().any(|t| t.kind == TokenKind::Comma);
    let place = if placed { place } else { &[] };
    (counted && (ends || placed) && a < n + 5).then(|| {
        led(
            "keep exactly",
            &tokens[0],
            &[std::slice::from_ref(many), &tokens[a..b], place],
        )
    })
}

/// "two cyclists are one too many, so take one away".
fn too_many(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (i, n) = find(tokens, &["too many", "too much"])?;
    let be = (1..i).rev().find(|k| is(tokens.get(*k), &["is", "are"]))?;
    let many = tokens
        .get(be + 1)
        .filter(|t| number(t).is_some() && be + 2 == i)?;
    let (a, _) = first_noun(&tokens[..be]).filter(|x| x.0 < 4)?;
    let rest = trimmed(tokens.get(i + n..)?);
    let np = bare_np(&tokens[..be]);
    let np = if talk.fits(&np) > 0 {
        &np[..]
    } else {
        &tokens[a..be]
    };
    let left = talk.fits(np).checked_sub(number(many)?.max(0) as usize)?;
    // ("two will do", "make it two": said twice)
    let said =
        rest.iter().find_map(number) == Some(left as i64) && first_noun(rest).is_none() && rest.len() < 7;
    let takes =
        rest.is_empty() || removes(rest.first()) || leads(rest, &["get rid", "one", "so"]).is_some() || said;
    takes.then(|| led("keep exactly", &tokens[0], &[&[digits(left, many)], np]))
}

/// "only one of the two cars should stay".
fn only_of(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &["only", "just", "no more than", "exactly", "not more than"],
    )?;
    number(tokens.get(n)?)?;
    let of = leads(&tokens[n + 1..], &["of the", "of these", "of those", "of my"])?;
    let rest = &tokens[n + 1 + of..];
    let (_, b) = first_noun(rest).filter(|x| x.0 < 5)?;
    let stays = rest[b..].iter().any(|t| {
        matches!(
            text(t),
            "stay" | "stays" | "remain" | "remains" | "left" | "kept" | "needed"
        )
    });
    let end = (b..rest.len())
        .find(|k| HELPERS.contains(&text(&rest[*k])) || is_finite(text(&rest[*k]), true))
        .unwrap_or(b);
    stays.then(|| {
        led(
            "keep exactly",
            &tokens[0],
            &[&tokens[n..=n], &bare_np(&rest[..end])],
        )
    })
}
