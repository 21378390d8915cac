//! Groups that grow: "the two pedestrians have been joined by three others on the crossing", "she gets a companion on the same
//! sidewalk".

use super::super::lexicon::plural;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::{List, MATES};
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use std::sync::LazyLock;

/// A sentence (without its stop) as the command that adds who comes.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = super::group_sizes::plain(super::lines::plain(tokens, talk), talk);
    // ("the bus is gone, and the woman gets a companion")
    let links = (2..out.len()).filter(|k| {
        (mark(&out[k - 1]) || is(out.get(k - 1), &["and"]))
            && is(out.get(*k), &["the", "one", "both", "that"])
    });
    if let Some((k, new)) = links.rev().find_map(|k| Some((k, comes_to(&out[k..], talk)?))) {
        return [&out[..k], &new].concat();
    }
    comes_to(&out, talk).unwrap_or(out)
}

fn mark(t: &Token) -> bool {
    !matches!(t.kind, TokenKind::Word | TokenKind::Number(_))
}

/// How many come, of what kind if that is said, and one past the words: "three others", "a second one", "two more women".
fn comers(tokens: &[Token]) -> Option<(Vec<Token>, Option<Vec<Token>>, usize)> {
    let first = tokens.first()?;
    let one = is(Some(first), &["a", "an", "another", "one"]);
    (one || number(first).is_some()).then_some(())?;
    let mut k = 1;
    while is(
        tokens.get(k),
        &["other", "more", "further", "additional", "new", "extra"],
    ) || tokens
        .get(k)
        .is_some_and(|t| super::super::foremost::ordinal(text(t)).is_some())
    {
        k += 1;
    }
    let count = if one {
        led("one", first, &[])
    } else {
        vec![first.clone()]
    };
    // (the mates of people are people)
    let mate = tokens.get(k).is_some_and(|t| MATES.contains(&text(t)))
        || is(tokens.get(k), &["others", "one", "ones", "other", "companion"]);
    if mate {
        return Some((count, None, k + 1));
    }
    if k > 1 && (tokens.get(k).is_none_or(mark) || is_place(&tokens[k..])) {
        return Some((count, None, k));
    }
    let (a, b) = first_noun(&tokens[k..]).filter(|x| x.0 < 3)?;
    Some((count, Some(tokens[k + a..k + b].to_vec()), k + b))
}

/// "have been joined by three others", "get company from three more", "gets a companion on the same sidewalk".
fn comes_to(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    static JOINED: List = LazyLock::new(|| {
        "\
        have been joined by|has been joined by|are joined by|is joined by|were joined by|was joined by|\
        get joined by|gets joined by|should be joined by|get company from|gets company from|get company by|\
        gets company by|have got company from|has got company from|have company from|has company from|\
        are now joined by|is now joined by|have now been joined by|has now been joined by|\
        receive company from|should get company from|must be joined by"
            .split('|')
            .collect()
    });
    static GETS: List = LazyLock::new(|| {
        "\
        gets|get|has got|have got|should get|should have|needs|receives|is given|is getting"
            .split('|')
            .collect()
    });
    const COMPANY: &[&str] = &[
        "company",
        "some company",
        "reinforcement",
        "reinforcements",
        "support",
    ];
    let passive = find(tokens, &JOINED);
    let (whom, new) = match passive {
        Some((i, n)) => (&tokens[..i], &tokens[i + n..]),
        None => {
            if let Some((i, n)) = find(
                tokens,
                &[
                    "have joined",
                    "has joined",
                    "join",
                    "joins",
                    "are joining",
                    "joined",
                ],
            ) && let Some((_, None, k)) = comers(&tokens[..i])
                && k == i
            {
                return add(&tokens[..i], &tokens[i + n..], &[], talk);
            }
            let (_, b) = first_noun(tokens).filter(|x| x.0 < 5)?;
            let i = (b..tokens.len().min(b + 6)).find(|k| leads(&tokens[*k..], &GETS).is_some())?;
            (i == b || is_place(&tokens[b..i])).then_some(())?;
            let n = leads(&tokens[i..], &GETS)?;
            let new = &tokens[i + n..];
            if let Some(c) = leads(new, COMPANY) {
                let one = led("another one", &tokens[i], &[]);
                return add(&one, &tokens[..i], &new[c..], talk);
            }
            // (only mates: "gets a trailer" is read elsewhere)
            let (_, kind, _) = comers(new)?;
            kind.is_none().then_some(())?;
            (&tokens[..i], new)
        }
    };
    let (_, _, k) = comers(new)?;
    add(&new[..k], whom, &new[k..], talk)
}

/// Add those who come where they are said to be, or where the others are.
fn add(new: &[Token], whom: &[Token], late: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let whom = trimmed(whom);
    let late = trimmed(late);
    let (count, kind, _) = comers(new)?;
    let one_of = 2 * usize::from(is(whom.first(), &["one"]) && is(whom.get(1), &["of"]));
    let np = &whom[one_of..];
    let (a, b) = first_noun(np).filter(|x| x.0 < 4)?;
    is(
        np.first(),
        &["the", "both", "these", "those", "my", "that", "all"],
    )
    .then_some(())?;
    let theirs = trimmed(&np[b..]);
    (theirs.is_empty() || is_place(theirs)).then_some(())?;
    (talk.fits(np) > 0 || talk.fits(&np[a..b]) > 0).then_some(())?;
    let at = &whom[0];
    let many = number(&count[0]).is_some_and(|n| n > 1);
    let noun = match &kind {
        Some(kind) => kind.clone(),
        None => {
            let one = super::topics::singular_of(&np[a..b]);
            let mut noun = one.clone();
            if let (true, Some(last)) = (many, noun.last_mut()) {
                last.text = plural(text(last));
            }
            noun
        }
    };
    let more = led(if many { "more" } else { "" }, at, &[]);
    let head = if many {
        [&count[..], &more[..]].concat()
    } else {
        led("another", at, &[])
    };
    let same = leads(
        late,
        &[
            "on the same",
            "in the same",
            "at the same",
            "with him",
            "with her",
            "with them",
            "at his side",
            "at her side",
            "there",
        ],
    );
    let place: Vec<Token> = match (same, late.is_empty()) {
        (Some(_), _) | (None, true) => {
            let all = talk.boxes_of(&np[a..b]).len();
            if !theirs.is_empty() && same.is_none() {
                theirs.to_vec()
            } else if talk.fits(&[&led("the", at, &[])[..], &np[a..b]].concat()) == all
                && kind.is_none()
                && all > 0
                && (all == 1 || one_of == 0)
                && same.is_none()
            {
                led("next to", at, &[np])
            } else {
                let one = super::topics::singular_of(&np[a..b]);
                let np = if one_of > 0 {
                    led("a", at, &[&one])
                } else {
                    np.to_vec()
                };
                strip_of(&np, talk).map_or_else(|| led("next to", at, &[&np]), |s| led(s, at, &[]))
            }
        }
        _ => {
            let his = late.iter().any(|t| is(Some(t), &["him", "her", "it", "them"]));
            (is_place(late) && (his || !has_noun(late))).then_some(())?;
            late.iter()
                .flat_map(|t| {
                    if is(Some(t), &["him", "her", "it", "them"]) {
                        np.to_vec()
                    } else {
                        vec![t.clone()]
                    }
                })
                .collect()
        }
    };
    Some(led("add", at, &[&head, &noun, &place]))
}

/// The sidewalk on which all of these are.
fn strip_of(np: &[Token], talk: &Talk<'_>) -> Option<&'static str> {
    use crate::scene::graph::LaneRole as L;
    let (a, b) = first_noun(np)?;
    let roles: Vec<_> = talk
        .boxes_of(&np[a..b])
        .iter()
        .map(|x| super::super::holds::role_of(talk.map, x))
        .collect();
    let first = (*roles.first()?)?;
    roles.iter().all(|r| *r == Some(first)).then_some(())?;
    match first {
        L::LeftSidewalk => Some("on the left sidewalk"),
        L::RightSidewalk => Some("on the right sidewalk"),
        L::LeftRoadside => Some("on the left roadside"),
        L::RightRoadside => Some("on the right roadside"),
        _ => None,
    }
}
