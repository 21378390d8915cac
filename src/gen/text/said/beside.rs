//! Words beside a command that would be taken for one of their own, or that call one thing twice: "a second person, the driver,
//! stands there", "make that a car", "delete one, no, delete both", "six cones not four", "only with fog over it".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    first_noun, has_noun, is, is_finite, is_place, leads, led, longest, noun_at, number, text,
};
use crate::scene::Class;

/// A text in plainer words, before its clauses are parted.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let out = apposed(tokens);
    let out = withdrawn(out);
    let out = small(out);
    let out = out_of_so_many(out);
    without_mishap(out)
}

fn is_mark(t: Option<&Token>) -> bool {
    t.is_none_or(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)))
}

fn starts(out: &[Token]) -> bool {
    out.last().is_none_or(|t| t.kind == TokenKind::Stop)
}

fn classes(tokens: &[Token]) -> &'static [Class] {
    let run: Vec<&str> = tokens.iter().map(text).collect();
    match look_up(&run.join(" ")) {
        Some(Sense::Noun(n, _)) => n.classes,
        _ => &[],
    }
}

/// "a second person, the driver, stands next to it": one person; "a vehicle, a bus, comes": a bus.
fn apposed(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        (tokens[i].kind == TokenKind::Comma).then_some(())?;
        let end = out.len();
        let noun = (1..=3.min(end))
            .rev()
            .find(|n| noun_at(&out[end - n..]) == Some(*n))?;
        let from = (end.saturating_sub(noun + 4)..end - noun)
            .rev()
            .find(|k| is(out.get(*k), &["a", "an", "another"]))?;
        is(tokens.get(i + 1), &["a", "an", "the", "probably", "presumably"]).then_some(())?;
        let (a, b) = first_noun(&tokens[i + 1..]).filter(|n| n.0 < 4)?;
        let close = i + 1 + b;
        let own = tokens[i + 1..close]
            .iter()
            .all(|t| t.kind == TokenKind::Word && !HELPERS.contains(&text(t)));
        (own && tokens.get(close)?.kind == TokenKind::Comma).then_some(())?;
        let after = tokens.get(close + 1)?;
        // (a list goes on with what else there is)
        let does = HELPERS.contains(&text(after))
            || is_finite(text(after), true) && !matches!(text(after), "left" | "right")
            || text(after).ends_with("ing");
        (does && noun_at(&tokens[close + 1..]).is_none()).then_some(())?;
        let (general, special) = (classes(&out[end - noun..]), classes(&tokens[i + 1 + a..close]));
        let same = special.first().is_some_and(|c| general.contains(c));
        same.then_some(())?;
        if general.len() > 1 {
            out.truncate(from);
            out.extend_from_slice(&tokens[i + 1..close]);
        }
        Some(close + 1)
    })
}

/// "delete one pedestrian, no, sorry, delete both": only the last holds.
fn withdrawn(tokens: Vec<Token>) -> Vec<Token> {
    const NO: &[&str] = &[
        "no",
        "sorry",
        "wait",
        "hmm",
        "oh",
        "er",
        "uh",
        "actually",
        "rather",
        "i mean",
        "correction",
        "hang on",
        "hold on",
        "no no",
    ];
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut i = 0;
    while i < tokens.len() {
        // a run of such words with marks between them
        let mut k = i;
        let mut takes_back = false;
        while let Some(t) = tokens.get(k).filter(|_| k < i + 12) {
            if is_mark(Some(t)) {
                k += 1;
            } else if let Some(n) = leads(&tokens[k..], NO).filter(|n| k > i && is_mark(tokens.get(k + n))) {
                takes_back |= matches!(
                    text(t),
                    "no" | "sorry" | "wait" | "correction" | "i" | "hang" | "hold"
                );
                k += n;
            } else {
                break;
            }
        }
        if !(takes_back && is_mark(tokens.get(i)) && k < tokens.len()) {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        }
        let from = out
            .iter()
            .rposition(|t| t.kind == TokenKind::Stop)
            .map_or(0, |k| k + 1);
        let first = &out[from..];
        let again = &tokens[k..];
        let verb = first
            .iter()
            .rposition(|t| tokens.get(k).is_some_and(|v| is_verb(v) && text(v) == text(t)));
        let both = leads(
            &again[1.min(again.len())..],
            &[
                "both",
                "all of them",
                "all three",
                "all four",
                "all",
                "them all",
                "two",
                "three",
                "four",
                "five",
                "six",
                "one",
            ],
        )
        .filter(|n| is_mark(again.get(1 + n)) || is(again.get(1 + n), &["and", "instead"]));
        let object = verb.and_then(|v| {
            first_noun(&first[v..])
                .filter(|n| n.0 < 4)
                .map(|n| (v, first[v + n.0..v + n.1].to_vec()))
        });
        match (object, both) {
            (Some((v, noun)), Some(n)) => {
                out.truncate(from + v);
                out.push(again[0].clone());
                let whole = is(again.get(1), &["both", "all", "them"]);
                let all = super::as_now::all_of(&noun);
                if whole {
                    out.extend(led("all", &again[0], &[&all]));
                } else {
                    out.extend_from_slice(&again[1..1 + n]);
                    out.extend_from_slice(&all[1..]);
                }
                i = k + 1 + n;
            }
            _ => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// Length of a run of words that only take back what was said: "hmm, no,".
fn took_back(tokens: &[Token]) -> Option<usize> {
    const NO: &str = "no|hmm|hm|oh|er|uh|sorry|wait|no wait|hang on|hold on|correction|nope|oops|ah|well";
    let mut k = 0;
    while let Some(n) =
        begins(&tokens[k..], NO).filter(|n| tokens.get(k + n).is_some_and(|t| t.kind == TokenKind::Comma))
    {
        k += n + 1;
    }
    (k > 0).then_some(k)
}

/// Small turns, one by one.
fn small(tokens: Vec<Token>) -> Vec<Token> {
    const HAD: &str = "where you had only|where you had just|where you had|where we had only|where we had|where i had only|where i had|where there was only|where there was just|where there were only|where there had been only|where until now there was only|where it had been only";
    const SKY: &str = "only with|just with|but with|only in|just in";
    const OVER: &str = "over it|over it all|over everything|over them|over all of it|around it|in it|over the scene|on it|on top of it|on top";
    const MISTAKE: &str = "i made a mistake|i have made a mistake|ive made a mistake|we made a mistake|there was a mistake|i got it wrong|i got that wrong|that was wrong|that was a mistake|i was wrong|i was mistaken|my mistake|i mixed something up|i got something wrong";
    let sky = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    rewritten(&tokens, |i, out| {
        let t = &tokens[i];
        let opens = is_mark(out.last()) || is(out.last(), &["and", "but", "then", "please"]);
        // "let a second bus be parked on the left"
        if opens
            && is(Some(t), &["let", "have"])
            && is(tokens.get(i + 1), &["a", "an", "another"])
            && let Some((_, b)) = first_noun(&tokens[i + 1..]).filter(|n| n.0 < 5)
            && is(tokens.get(i + 1 + b), &["be"])
            && tokens[i + 1..i + 1 + b].iter().all(|t| t.kind == TokenKind::Word)
            && (is(tokens.get(i + 2 + b), &["parked"]) || tokens.get(i + 2 + b..).is_some_and(is_place))
        {
            out.extend(led("add", t, &[&tokens[i + 1..i + 1 + b]]));
            return Some(i + 2 + b);
        }
        // "everyone has left the zebra"
        if opens
            && is(Some(t), &["everyone", "everybody"])
            && is(
                tokens.get(i + 1),
                &[
                    "has", "should", "must", "is", "may", "can", "shall", "leaves", "goes",
                ],
            )
            && !tokens[i..]
                .iter()
                .take_while(|t| t.kind != TokenKind::Stop)
                .any(|t| is(Some(t), &["but", "except", "else", "who", "save", "apart"]))
        {
            out.extend(led("all the pedestrians", t, &[]));
            // (those who have left a place are those who were there)
            let left = is(tokens.get(i + 1), &["has"])
                && is(tokens.get(i + 2), &["left"])
                && is(tokens.get(i + 3), &["the"]);
            if left
                && let Some((Sense::Place(..), n)) = tokens.get(i + 4..).and_then(longest)
                && (is_mark(tokens.get(i + 4 + n)) || is(tokens.get(i + 4 + n), &["and"]))
            {
                out.extend(led("on the", t, &[&tokens[i + 4..i + 4 + n]]));
                out.extend(led("have left", t, &[]));
                return Some(i + 4 + n);
            }
            return Some(i + 1);
        }
        // "bicycles here: four of them, to my right"
        if text(t) == ":"
            && tokens.get(i + 1).is_some_and(|t| number(t).is_some())
            && is(tokens.get(i + 2), &["of"])
            && is(tokens.get(i + 3), &["them", "these"])
        {
            let link = |k: usize| {
                is_mark(out.get(k))
                    || is(out.get(k), &["and"])
                    || is(out.get(k), &["but"]) && (k == 0 || !is(out.get(k - 1), &["nothing"]))
            };
            let from = (0..out.len()).rev().find(|k| link(*k)).map_or(0, |k| k + 1);
            let (a, b) = first_noun(&out[from..])?;
            let lead = &out[from..from + a];
            // ("cyclists: three of them" says how many there are to be)
            let label = a == 0 && from + b == out.len();
            let plain = !label
                && !out[from..].iter().any(|t| {
                    HELPERS.contains(&text(t))
                        || is_verb(t) && !is(Some(t), &["only", "just"])
                        || number(t).is_some()
                })
                && !lead
                    .iter()
                    .any(|t| is(Some(t), &["the", "those", "these", "all", "both"]));
            if plain && matches!(look_up(text(&out[from + b - 1])), Some(Sense::Noun(_, true))) {
                let noun = out[from + a..from + b].to_vec();
                let place = if is_place(&out[from + b..]) {
                    out[from + b..].to_vec()
                } else {
                    Vec::new()
                };
                out.truncate(from);
                let comma = usize::from(tokens.get(i + 4).is_some_and(|t| t.kind == TokenKind::Comma));
                out.extend(led("add", t, &[&tokens[i + 1..i + 2], &noun, &place]));
                return Some(i + 4 + comma);
            }
        }
        // "..., while the first two keep standing there": as before
        if is(Some(t), &["while", "whereas"])
            && let Some(n) = begins(
                &tokens[i + 1..],
                "the first two|the first three|the first one|the first|the existing ones|the existing two|the original two|the original ones",
            )
            && is(
                tokens.get(i + 1 + n),
                &[
                    "keep",
                    "keeps",
                    "stay",
                    "stays",
                    "remain",
                    "remains",
                    "continue",
                    "continues",
                    "still",
                    "just",
                ],
            )
        {
            let end = (i..tokens.len())
                .find(|k| tokens[*k].kind == TokenKind::Stop)
                .unwrap_or(tokens.len());
            if out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
                out.pop();
            }
            return Some(end);
        }
        // "hmm, no, make it a car"
        if starts(out)
            && let Some(n) = took_back(&tokens[i..])
            && tokens.get(i + n).is_some_and(is_verb)
        {
            return Some(i + n);
        }
        // "I made a mistake: it was ..."
        if starts(out)
            && let Some(n) = begins(&tokens[i..], MISTAKE)
            && is_mark(tokens.get(i + n))
            && tokens.get(i + n + 1).is_some_and(|t| t.kind == TokenKind::Word)
            && tokens[i + n].kind != TokenKind::Stop
        {
            return Some(i + n + 1);
        }
        // "I wanted the van in front, 8 m ahead of me"
        if is(Some(t), &["in"])
            && is(tokens.get(i + 1), &["front"])
            && is_mark(tokens.get(i + 2))
            && out.len() > 2
        {
            let told = tokens.get(i + 2).is_some_and(|t| t.kind == TokenKind::Comma)
                && tokens.get(i + 3).is_some_and(|t| number(t).is_some())
                && tokens[i + 4..]
                    .iter()
                    .take(5)
                    .any(|t| is(Some(t), &["ahead", "front", "before"]));
            if told {
                return Some(i + 3);
            }
        }
        // "besides, the taxi was further off"
        if starts(out)
            && is(Some(t), &["besides", "moreover", "furthermore"])
            && tokens.get(i + 1)?.kind == TokenKind::Comma
        {
            return Some(i + 2);
        }
        // "make that a car"
        if is(Some(t), &["that"])
            && is(out.last(), &["make"])
            && (is(tokens.get(i + 1), &["a", "an"]))
            && first_noun(&tokens[i + 1..]).is_some_and(|n| n.0 < 4 && is_mark(tokens.get(i + 1 + n.1)))
            && out.len() > 3
        {
            out.extend(led("it", t, &[]));
            return Some(i + 1);
        }
        // "it was no ambulance that came towards me"
        if is(Some(t), &["no"])
            && is(out.last(), &["was", "is"])
            && is(out.get(out.len().checked_sub(2)?), &["it", "that", "this"])
            && first_noun(&tokens[i + 1..]).is_some_and(|n| n.0 < 2)
        {
            out.extend(led("not a", t, &[]));
            return Some(i + 1);
        }
        // "six cones not four"
        if is(Some(t), &["not"])
            && tokens
                .get(i + 1)
                .is_some_and(|t| number(t).is_some() && !is(Some(t), &["a", "an"]))
            && is_mark(tokens.get(i + 2))
            && (1..=3.min(out.len())).any(|n| noun_at(&out[out.len() - n..]) == Some(n))
            && !out.iter().any(|t| HELPERS.contains(&text(t)))
        {
            out.extend(led("instead of", t, &[]));
            return Some(i + 1);
        }
        // "three cars, where you had only one"
        if t.kind == TokenKind::Comma
            && let Some(n) = begins(&tokens[i + 1..], HAD)
            && tokens.get(i + 1 + n).is_some_and(|t| number(t).is_some())
            && is_mark(tokens.get(i + 2 + n))
        {
            out.extend(led("instead of", t, &[&tokens[i + 1 + n..i + 2 + n]]));
            return Some(i + 2 + n);
        }
        // "everything else as it is, only with fog over it"
        if let Some(n) = begins(&tokens[i..], SKY)
            && tokens.get(i + n).is_some_and(sky)
            && is_mark(out.last())
        {
            let more = begins(&tokens[i + n + 1..], OVER).unwrap_or(0);
            is_mark(tokens.get(i + n + 1 + more)).then_some(())?;
            out.extend_from_slice(&tokens[i + n - 1..=i + n]);
            return Some(i + n + 1 + more);
        }
        None
    })
}

/// "make two pedestrians out of the one and three cars out of the two": there are so many now.
fn out_of_so_many(tokens: Vec<Token>) -> Vec<Token> {
    let mut made = false;
    rewritten(&tokens, |i, out| {
        let verb =
            is(tokens.get(i), &["make"]) && (starts(out) || is(out.last(), &["and", "please", "also"]));
        let on = made && (is(tokens.get(i), &["and"]) || tokens[i].kind == TokenKind::Comma);
        (verb || on).then_some(())?;
        let from = i + 1 + usize::from(on && is(tokens.get(i + 1), &["and"]));
        tokens.get(from).filter(|t| number(t).is_some())?;
        let (_, b) = first_noun(&tokens[from..]).filter(|n| n.0 < 4)?;
        let n = begins(&tokens[from + b..], "out of the|out of|from the|of the")?;
        let end = from + b + n;
        tokens.get(end).filter(|t| number(t).is_some())?;
        is_mark(tokens.get(end + 1))
            .then_some(())
            .or_else(|| is(tokens.get(end + 1), &["and"]).then_some(()))?;
        if on {
            out.push(Token {
                kind: TokenKind::Stop,
                ..super::words::word(".", &tokens[i])
            });
        }
        out.extend(led("keep exactly", &tokens[i], &[&tokens[from..from + b]]));
        made = true;
        Some(end + 1)
    })
}

/// "somebody had a breakdown: a second car stands there": only what follows is seen.
fn without_mishap(tokens: Vec<Token>) -> Vec<Token> {
    const WHO: &str = "somebody had|someone had|somebody has had|someone has had|somebody has|someone has|someone has got|somebody has got|there has been|theres been|there was|we have had|weve had|we had";
    rewritten(&tokens, |i, out| {
        starts(out).then_some(())?;
        let n = begins(&tokens[i..], WHO)?;
        let article = usize::from(is(tokens.get(i + n), &["a", "an"]));
        (article == 1).then_some(())?;
        let colon = (i + n + 2..tokens.len().min(i + n + 6)).find(|k| text(&tokens[*k]) == ":")?;
        (!has_noun(&tokens[i + n..colon]) && has_noun(&tokens[colon..])).then_some(colon + 1)
    })
}

/// "a truck that waits for all of them", where they are on a crossing: it waits there; elsewhere that says only that it stands.
pub(super) fn waits_for(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STANDS: &[&str] = &[
        "waits", "wait", "waiting", "stopped", "stops", "stop", "stopping", "brakes", "braked", "yields",
        "yielding", "halted",
    ];
    const THEM: &str = "all of them|both of them|them all|them both|them|him|her|these people|the people|the pedestrians|those people";
    rewritten(&tokens, |i, out| {
        let stands = is(tokens.get(i), &["for", "to"]) && is(out.last(), STANDS);
        let n = begins(tokens.get(i + 1..)?, THEM).filter(|_| stands)?;
        let end = i + 1 + n;
        let rest = tokens.get(end..).unwrap_or(&[]);
        let at_stripes = || talk.fits(&led("pedestrians on the crossing", &tokens[i], &[])) > 0;
        let named = rest
            .iter()
            .any(|t| is(Some(t), &["zebra", "crossing", "crosswalk"]));
        let closes = is_mark(rest.first()) || is(rest.first(), &["and", "too", "there"]);
        if (closes || is_place(rest)) && !named && at_stripes() {
            out.extend(led("at the crossing", &tokens[i], &[]));
            return Some(end);
        }
        let pronoun = n == 1 || !is(tokens.get(i + 1), &["the", "these", "those"]);
        (pronoun && (closes || is_place(rest))).then_some(end)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn said_plainly() {
        let said = |t: &str| {
            let list: Vec<String> = plain(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("a second person, the driver, stands there"),
            "a second person stands there"
        );
        assert_eq!(said("a vehicle, a bus, stands there"), "a bus stands there");
        assert_eq!(said("a man, a bus, a car"), "a man , a bus , a car");
        assert_eq!(
            said("remove one man, no, sorry, remove both"),
            "remove all the men"
        );
        assert_eq!(said("six cones not four"), "six cones instead of four");
    }
}
