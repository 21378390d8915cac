//! How many a group is to have, and which of it stay: "could the group on the crossing be bigger, five people in all?", "two people
//! are too few, let's have five", "only one of them stays here, the other two are there".

use super::super::lexicon::plural;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::List;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use std::sync::LazyLock;

/// A sentence (without its stop) with its groups in plain numbers.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = leaves_and_joins(tokens);
    some_stay(&out, talk)
        .or_else(|| group_of(&out))
        .or_else(|| with_the_others(&out, talk))
        .or_else(|| too_few(&out))
        .unwrap_or(out)
}

fn mark(t: &Token) -> bool {
    !matches!(t.kind, TokenKind::Word | TokenKind::Number(_))
}

/// "Only one of them stays here. The other two are there." is one sentence, and nobody goes.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut from = 0;
    for i in 0..tokens.len() {
        if tokens[i].kind == TokenKind::Word && !is(tokens.get(i), &["while", "whereas"])
            || !matches!(
                tokens[i].kind,
                TokenKind::Stop | TokenKind::Comma | TokenKind::Word
            )
        {
            continue;
        }
        let here = &tokens[from..i];
        let only = is(here.first(), &["only", "just"]) && here.get(1).is_some_and(|t| number(t).is_some());
        if !only {
            if tokens[i].kind == TokenKind::Stop {
                from = i + 1;
            }
            continue;
        }
        let end = (i + 1..tokens.len())
            .find(|k| tokens[*k].kind == TokenKind::Stop)
            .unwrap_or(tokens.len());
        let rest = &tokens[i + 1..end];
        let others = leads(
            rest,
            &[
                "the other",
                "the others",
                "and the other",
                "and the others",
                "the rest",
                "the remaining",
                "while the other",
                "but the other",
            ],
        )
        .is_some_and(|n| {
            (n..rest.len()).any(|k| is(rest.get(k), &["on", "to", "onto", "in", "at", "behind", "beside"]))
        });
        let stays = here.iter().position(|t| {
            is(
                Some(t),
                &[
                    "stays", "stay", "remains", "remain", "is", "are", "stands", "waits", "keeps",
                ],
            )
        });
        if let (true, Some(stays)) = (others, stays)
            && stays + 1 < here.len()
            && !rest
                .iter()
                .any(|t| is(Some(t), &["gone", "removed", "disappear", "leave", "go"]))
        {
            let mut new = here[1..2].to_vec();
            // "one pedestrian is still on the crossing": one of those that are there
            if is(here.get(2), &["of"]) {
                new.extend_from_slice(&here[2..stays]);
            } else {
                let many: Vec<Token> = here[2..stays]
                    .iter()
                    .enumerate()
                    .map(|(k, t)| {
                        let last = k + 3 == stays && number(&here[1]) == Some(1);
                        if last {
                            super::words::word(&plural(text(t)), t)
                        } else {
                            t.clone()
                        }
                    })
                    .collect();
                new.extend(led("of the", &here[1], &[&many]));
            }
            let verb = if number(&here[1]) == Some(1) {
                "stays"
            } else {
                "stay"
            };
            new.extend(led(verb, &here[stays], &[]));
            new.extend(
                here[stays + 1..]
                    .iter()
                    .filter(|t| !is(Some(t), &["still"]))
                    .cloned(),
            );
            let comma = Token {
                kind: TokenKind::Comma,
                ..super::words::word(",", &tokens[i])
            };
            let link = if is(tokens.get(i), &["while", "whereas"]) {
                Vec::new()
            } else {
                vec![comma]
            };
            new.extend(link);
            tokens.splice(from..=i, new);
            // (one such sentence is enough)
            return tokens;
        }
        if tokens[i].kind == TokenKind::Stop {
            from = i + 1;
        }
    }
    tokens
}

/// "leaves the sidewalk and joins them": joins them.
fn leaves_and_joins(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (2..tokens.len()).find(|i| {
        is(tokens.get(*i), &["leaves", "leave", "left"])
            && is(tokens.get(i + 1), &["the", "his", "her", "their", "its"])
    }) else {
        return tokens;
    };
    let and = (i + 2..tokens.len().min(i + 8)).find(|k| is(tokens.get(*k), &["and"]));
    match and.filter(|k| {
        leads(
            &tokens[k + 1..],
            &["joins", "join", "joined", "has joined", "have joined"],
        )
        .is_some()
    }) {
        Some(and) if !has_noun(&tokens[i + 1..and]) => {
            let has = usize::from(is(tokens.get(i - 1), &["has", "have"]));
            [&tokens[..i - has], &tokens[and + 1..]].concat()
        }
        _ => tokens,
    }
}

/// "two workers stay on the right sidewalk, one is on the left one", of three that are there: one of them goes.
fn some_stay(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let many = number(tokens.first()?)?;
    let (a, b) = first_noun(tokens).filter(|x| x.0 > 0 && x.0 < 5)?;
    leads(
        &tokens[b..],
        &[
            "stay",
            "stays",
            "remain",
            "remains",
            "should stay",
            "keep standing",
            "are still",
        ],
    )?;
    let link = (b + 1..tokens.len()).find(|k| {
        (mark(&tokens[*k]) || is(tokens.get(*k), &["and", "while", "but"]))
            && !is(tokens.get(k + 1), &["and", "while", "but"])
    })?;
    if has_noun(&tokens[b..link]) {
        return None;
    }
    let rest = &tokens[link + 1..];
    let others = number(rest.first()?)?;
    let own = first_noun(rest).filter(|x| x.0 == 1).map_or(1, |x| x.1);
    let verb = is(
        rest.get(own),
        &[
            "is", "are", "goes", "go", "moves", "move", "stands", "stand", "walks", "walk", "crosses",
            "should",
        ],
    );
    let place = (own + 1..rest.len().min(own + 5)).any(|k| is_place(&rest[k..]));
    let noun = &tokens[a..b];
    (verb && place && many + others == talk.fits(noun) as i64 && many > 0).then_some(())?;
    let of = led("of the", &rest[0], &[noun]);
    Some([&rest[..1], &of, &rest[own..]].concat())
}

/// "the group on the crossing should be five people", "... be bigger, five people in all".
fn group_of(tokens: &[Token]) -> Option<Vec<Token>> {
    let ask = usize::from(is(
        tokens.first(),
        &["could", "can", "should", "let", "make", "have", "might", "may"],
    ));
    static GROUP: List = LazyLock::new(|| {
        "\
        group|crowd|bunch|cluster|queue|gathering|row|line|party|team"
            .split('|')
            .collect()
    });
    is(tokens.get(ask), &["the", "that", "this"]).then_some(())?;
    is(tokens.get(ask + 1), &GROUP).then_some(())?;
    let be = (ask + 2..tokens.len().min(ask + 14)).find(|k| {
        is(
            tokens.get(*k),
            &[
                "be", "should", "consist", "comprise", "grow", "grows", "has", "have", "number", "count",
                "must", "needs", "increase", "shrink", "consists", "ought", "contain",
            ],
        )
    })?;
    let middle = &tokens[ask + 2..be];
    // "the group of pedestrians on the crossing"
    let of = usize::from(is(middle.first(), &["of"]));
    let named = first_noun(middle).filter(|x| of == 1 && x.0 == 1);
    let place = trimmed(&middle[named.map_or(0, |x| x.1)..]);
    (place.is_empty() || is_place(place)).then_some(())?;
    if has_noun(place) {
        return None;
    }
    let rest = &tokens[be..];
    let n = (0..rest.len()).find(|k| number(&rest[*k]).is_some())?;
    static AROUND: List = LazyLock::new(|| {
        "\
        be|should|consist|consists|comprise|grow|grows|has|have|number|count|must|needs|increase|shrink|to|\
        of|bigger|larger|smaller|say|ie|namely|up|down|ought|contain|now|a|bit|little|made|at|least|about|\
        with|like"
            .split('|')
            .collect()
    });
    rest[..n]
        .iter()
        .all(|t| mark(t) || AROUND.contains(&text(t)))
        .then_some(())?;
    let after = &rest[n + 1..];
    let more = usize::from(is(after.first(), &["more"]));
    let noun = first_noun(&after[more..])
        .filter(|x| x.0 < 2)
        .map(|x| (&after[more + x.0..more + x.1], more + x.1));
    let walk = place.iter().any(|t| {
        is(
            Some(t),
            &[
                "crossing",
                "zebra",
                "sidewalk",
                "pavement",
                "crosswalk",
                "footpath",
            ],
        )
    });
    let people = led("people", &tokens[0], &[]);
    let (what, used) = match (noun, named) {
        (Some((noun, used)), _) => (noun, used),
        (None, Some(x)) => (&middle[x.0..x.1], more),
        (None, None) if walk => (&people[..], more),
        _ => return None,
    };
    let late = trimmed(&after[used..]);
    let ends = late.is_empty()
        || leads(
            late,
            &[
                "in all",
                "in total",
                "altogether",
                "all in all",
                "strong",
                "instead",
                "now",
                "members",
                "overall",
            ],
        ) == Some(late.len());
    ends.then_some(())?;
    let lead = if more == 1 { "add" } else { "there should be" };
    let more = led("more", &tokens[0], &[]);
    let more = if lead == "add" { &more[..] } else { &[][..] };
    Some(led(lead, &tokens[0], &[&rest[n..=n], more, what, place]))
}

/// "a third worker stands with the other two on the sidewalk": one more of them, there.
fn with_the_others(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let there = leads(
        tokens,
        &[
            "there is",
            "there should be",
            "add",
            "put",
            "i want",
            "we need",
            "let",
        ],
    )
    .unwrap_or(0);
    let rest = &tokens[there..];
    let ordinal = is(rest.first(), &["a"])
        && rest
            .get(1)
            .is_some_and(|t| super::super::foremost::ordinal(text(t)).is_some());
    (ordinal || is(rest.first(), &["another"])).then_some(())?;
    let (a, b) = first_noun(rest).filter(|x| x.0 < 4)?;
    let (i, n) = find(
        rest,
        &[
            "with the",
            "beside the",
            "next to the",
            "alongside the",
            "among the",
        ],
    )
    .filter(|x| x.0 >= b && x.0 < b + 4)?;
    let verb = rest[b..i].iter().all(|t| {
        is(
            Some(t),
            &[
                "is", "stands", "stand", "standing", "walks", "waits", "waiting", "be", "should", "now",
            ],
        )
    });
    let mut k = i + n;
    let other = is(rest.get(k), &["other", "others", "rest"]);
    k += usize::from(other);
    let many = rest.get(k).is_some_and(|t| number(t).is_some());
    k += usize::from(many);
    k += usize::from(
        rest.get(k)
            .is_some_and(|t| text(t) == text(&rest[b - 1]) || text(t) == plural(text(&rest[b - 1]))),
    );
    let place = trimmed(rest.get(k..)?);
    (verb && (other || many) && (place.is_empty() || is_place(place)) && !has_noun(place)).then_some(())?;
    (talk.fits(&rest[a..b]) > 0).then_some(())?;
    Some(led("add another", &tokens[0], &[&rest[a..b], place]))
}

/// "two people on the zebra are too few, let's have five": there should be five there.
fn too_few(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "are too few",
            "is too few",
            "are not enough",
            "is not enough",
            "arent enough",
            "isnt enough",
            "are too many",
            "is too many",
            "are too little",
        ],
    )?;
    number(tokens.first()?)?;
    let head = &tokens[..i];
    let (a, b) = first_noun(head).filter(|x| x.0 < 4 && x.0 > 0)?;
    let place = trimmed(&head[b..]);
    (is_place(place) && !has_noun(place)).then_some(())?;
    let rest = tokens.get(i + n..)?;
    let from = rest.iter().position(|t| !mark(t))?;
    let k = leads(
        &rest[from..],
        &[
            "lets have",
            "let us have",
            "have",
            "make it",
            "let it be",
            "let there be",
            "i want",
            "we need",
            "i need",
            "should be",
            "it should be",
            "there should be",
            "id like",
            "i would like",
            "id prefer",
            "make that",
            "we want",
            "better",
        ],
    )
    .unwrap_or(0);
    let many = rest.get(from + k)?;
    number(many)?;
    let late = trimmed(&rest[from + k + 1..]);
    let said = first_noun(late).map_or(0, |x| x.1);
    let late = trimmed(&late[said..]);
    let ends = late.is_empty()
        || is(
            late.first(),
            &["would", "are", "is", "please", "instead", "of", "there", "will"],
        ) && !has_noun(late);
    ends.then(|| {
        led(
            "there should be",
            &tokens[0],
            &[std::slice::from_ref(many), &head[a..b], place],
        )
    })
}
