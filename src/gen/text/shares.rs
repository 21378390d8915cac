//! How a whole is shared out: "half of them", "four per side", "two of each", "the first at 10 m, then at 20 m". Put into
//! numbers and "on each side", which the grammar reads.

use super::description::Anchor;
use super::ellipsis::{digits, ends, is_noun, is_unit, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};
use crate::scene::graph::LaneRole;

/// A text with its shares in numbers.
pub fn counted(tokens: &[Token]) -> Vec<Token> {
    let out = of_which_there_are(&super::listed::plain(tokens));
    let out = replaced(&out, "of which|of whom", "of them");
    let out = of_a_group(&out);
    let out = some_of_so_many(&halves(&out));
    let out = as_many_of_both(&out);
    let out = two_strips(&out);
    let out = per_side(&out);
    each_so_far(&one_by_one(&out))
}

/// "three cars ahead of us, at 10 m, 20 m and 30 m": one at each of them.
fn each_so_far(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let at = begins(&tokens[i..], "at distances of|at a distance of|at")?;
        let mut far: Vec<&Token> = Vec::new();
        let mut unit = None;
        let mut k = i + at;
        while let Some(t) = tokens.get(k).filter(|t| matches!(t.kind, TokenKind::Number(_))) {
            far.push(t);
            k += 1;
            if let Some(t) = tokens.get(k).filter(|t| is_unit(t)) {
                unit = Some(t);
                k += 1;
            }
            // the next of the list
            let link = tokens[k.min(tokens.len())..]
                .iter()
                .take(3)
                .take_while(|t| t.kind == TokenKind::Comma || matches!(t.text.as_str(), "and" | "at"))
                .count();
            let more = tokens
                .get(k + link)
                .is_some_and(|t| matches!(t.kind, TokenKind::Number(_)));
            if link == 0 || !more {
                break;
            }
            k += link;
        }
        let unit = unit?;
        // ("at 10 m and 2 cars" is no list of distances)
        if far.len() < 2 || !is_unit(&tokens[k - 1]) || whole(out) != u32::try_from(far.len()).ok() {
            return None;
        }
        let way = begins(
            &tokens[k..],
            "ahead of us|ahead of me|ahead|behind us|behind me|behind|in front of us|in front of me|in front|away|from us",
        )
        .unwrap_or(0);
        if !ends(tokens.get(k + way)) {
            return None;
        }
        for (n, t) in far.into_iter().enumerate() {
            if n > 0 || out.last().is_none_or(|t| t.kind != TokenKind::Comma) {
                out.push(Token {
                    kind: TokenKind::Comma,
                    ..word(",", t)
                });
            }
            out.extend(["one", "at"].map(|w| word(w, t)));
            out.extend([t.clone(), unit.clone()]);
            out.extend_from_slice(&tokens[k..k + way]);
        }
        Some(k + way)
    })
}

pub(super) fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || matches!(
            tokens[i - 1].kind,
            TokenKind::Comma | TokenKind::Stop | TokenKind::Mark
        )
        || matches!(
            tokens[i - 1].text.as_str(),
            "and" | "while" | "but" | "where" | "with"
        )
}

/// "the cones, of which there are seven": seven of them.
fn of_which_there_are(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = "of which there are|of whom there are|of which i see|of which we see|of which there is|of which i need|of which i want";
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], LEAD).filter(|n| {
            tokens.get(i + n).is_some_and(|t| number(t).is_some()) && ends(tokens.get(i + n + 1))
        })?;
        out.push(tokens[i + n].clone());
        out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
        Some(i + n + 1)
    })
}

/// "Of the four cars, two are parked": the four cars, two of them.
fn of_a_group(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let the = tokens
            .get(i + 1)
            .is_some_and(|t| matches!(t.text.as_str(), "the" | "these" | "those" | "my" | "our"));
        let stop = matches!(
            i.checked_sub(1).map(|k| &tokens[k].kind),
            None | Some(TokenKind::Stop)
        );
        let rest = &tokens[i + 1..];
        let group = rest.iter().take(6).take_while(|t| !ends(Some(t))).any(is_noun)
            && rest.iter().take(7).any(|t| t.kind == TokenKind::Comma)
            && rest.get(1).is_some_and(|t| number(t).is_some());
        if !(t.text == "of" && stop && the && group) {
            out.push(t.clone());
        }
    }
    out
}

/// The number of the group that was named last.
fn whole(before: &[Token]) -> Option<u32> {
    (0..before.len()).rev().find_map(|k| {
        let group = before[k + 1..]
            .iter()
            .take(4)
            .take_while(|t| !ends(Some(t)))
            .any(is_noun);
        let unit = before.get(k + 1).is_some_and(is_unit);
        let dozen = (before[k].text == "dozen").then_some(12);
        let half = k > 0 && (before[k - 1].text == "half" || k > 1 && before[k - 2].text == "half");
        let many = dozen.map(|d| if half { d / 2 } else { d }).or(number(&before[k]));
        // "cars, six altogether"
        let total = begins(&before[k + 1..], "altogether|in total|in all|all told|of them").is_some()
            && before[..k].iter().rev().take(3).any(is_noun);
        many.filter(|n| (group || total) && !unit && *n > 1)
    })
}

/// "of the six parked cars": their number, their words, and how many words that is.
fn own_group(rest: &[Token]) -> Option<((u32, &[Token]), usize)> {
    let of = begins(rest, "of the|of these|of those|of my|of our|of all")?;
    let whole = rest.get(of).and_then(number).filter(|n| *n > 1)?;
    let noun = (of + 1..rest.len().min(of + 4)).find(|k| is_noun(&rest[*k]))?;
    let plain = !rest[of..noun].iter().any(|t| ends(Some(t))) && !rest.get(noun + 1).is_some_and(is_noun);
    plain.then(|| ((whole, &rest[of - 1..=noun]), noun + 1))
}

/// "one of the two men crosses, the other waits": the two men, one of them.
fn some_of_so_many(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let many = number(&tokens[i]).filter(|_| opens(tokens, i));
        let (_, ((_, noun), len)) =
            many.and_then(|m| Some((m, own_group(&tokens[i + 1..]).filter(|g| g.0.0 > m)?)))?;
        out.extend_from_slice(noun);
        out.push(Token {
            kind: TokenKind::Comma,
            ..word(",", &tokens[i])
        });
        out.push(tokens[i].clone());
        out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
        Some(i + 1 + len)
    })
}

/// "half of them": so many.
fn halves(tokens: &[Token]) -> Vec<Token> {
    const SHARES: [((u32, u32), &str); 5] = [
        ((1, 2), "one half|a half|half"),
        ((1, 3), "a third|one third"),
        ((1, 4), "a quarter|one quarter|a fourth"),
        ((2, 3), "two thirds|2 thirds"),
        ((3, 4), "three quarters|3 quarters|three fourths"),
    ];
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = SHARES
            .iter()
            .find_map(|(d, said)| begins(&tokens[i..], said).map(|n| (*d, n)));
        let Some(((share, divisor), n)) = found else {
            // "the other half", "the remaining half"
            match begins(
                &tokens[i..],
                "the other half of them|the other half|the remaining half|the second half",
            ) {
                Some(n) if whole(&out).is_some() => {
                    out.extend(["the", "others"].map(|w| word(w, &tokens[i])));
                    i += n;
                }
                _ => {
                    out.push(tokens[i].clone());
                    i += 1;
                }
            }
            continue;
        };
        let rest = &tokens[i + n..];
        // "half of the six cars are parked": six cars, three of them
        if let Some((group, len)) = own_group(rest).filter(|g| opens(tokens, i) && g.0.0 % divisor == 0) {
            let (whole, noun) = group;
            out.extend_from_slice(noun);
            out.push(Token {
                kind: TokenKind::Comma,
                ..word(",", &tokens[i])
            });
            out.push(digits(whole / divisor * share, &tokens[i]));
            out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
            i += n + len;
            continue;
        }
        let of = begins(rest, "of them|of these|of those").unwrap_or(0);
        // "half of the cars", "half the cars"
        let own = begins(rest, "of the|the|of my|of these|of those")
            .filter(|k| of == 0 && rest.get(*k).is_some_and(is_noun))
            .map_or(0, |k| k + 1);
        let next = rest.get(of.max(own));
        let bare = divisor == 2
            && next.is_some_and(|t| {
                matches!(
                    look_up(&t.text),
                    Some(Sense::State(..) | Sense::In | Sense::At | Sense::Rel(_) | Sense::EgoRel(_))
                ) || matches!(t.text.as_str(), "are" | "is" | "of" | "on" | "to")
            })
            && opens(tokens, i);
        let many = whole(&out).filter(|w| w % divisor == 0 && (of + own > 0 || bare));
        match many {
            Some(many) => {
                out.push(digits(many / divisor * share, &tokens[i]));
                out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
                i += n + of.max(own);
            }
            None => {
                out.extend_from_slice(&tokens[i..i + n]);
                i += n;
            }
        }
    }
    out
}

/// "as many buses as trucks: two of each": two of the one, two of the other.
fn as_many_of_both(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let each = (1..sentence.len()).find_map(|i| {
            let n = begins(
                &sentence[i..],
                "of each|of each kind|of each sort|of each type|of either|apiece|of both|each|of both kinds",
            )?;
            let many = number(&sentence[i - 1]).filter(|k| (1..=20).contains(k))?;
            (ends(sentence.get(i + n)) || sentence.get(i + n)?.text == "in").then_some((i, n, many))
        });
        let Some((at, n, many)) = each else {
            out.extend_from_slice(sentence);
            continue;
        };
        // what is counted: nouns in the plural without numbers of their own
        let mut lead = at - 1;
        while lead > 0
            && (ends(Some(&sentence[lead - 1]))
                || matches!(
                    sentence[lead - 1].text.as_str(),
                    "namely" | "that" | "is" | "which" | "exactly" | "with"
                ))
        {
            lead -= 1;
        }
        let plural: Vec<usize> = (0..lead)
            .filter(|k| matches!(look_up(&sentence[*k].text), Some(Sense::Noun(_, true))))
            .collect();
        let open = |k: &usize| !sentence[..*k].iter().rev().take(3).any(|t| number(t).is_some());
        let listed = plural.len() > 1
            && plural.iter().all(open)
            && (plural[0]..lead).all(|k| {
                plural.contains(&k)
                    || ends(Some(&sentence[k]))
                    || matches!(
                        sentence[k].text.as_str(),
                        "and"
                            | "as"
                            | "or"
                            | "plus"
                            | "in"
                            | "this"
                            | "the"
                            | "scene"
                            | "picture"
                            | "here"
                            | "there"
                    )
                    || matches!(
                        look_up(&sentence[k].text),
                        Some(Sense::State(_, false) | Sense::Attribute(_))
                    )
            });
        if !listed {
            out.extend_from_slice(sentence);
            continue;
        }
        let first = begins(
            &sentence[plural[0].saturating_sub(2)..],
            "as many|equally many|just as many",
        )
        .map_or(plural[0], |_| plural[0] - 2);
        out.extend_from_slice(&sentence[..first]);
        for (j, k) in plural.iter().enumerate() {
            if j > 0 {
                out.push(word("and", &sentence[*k]));
            }
            out.push(digits(many, &sentence[*k]));
            out.push(sentence[*k].clone());
        }
        out.extend_from_slice(&sentence[at + n..]);
    }
    out
}

fn is_strip(word: &str) -> bool {
    word == "sides"
        || matches!(
            look_up(word),
            Some(Sense::Place(
                Anchor::Lane(LaneRole::Roadside | LaneRole::Sidewalk),
                _
            ))
        )
}

/// "on the two pavements": on both.
fn two_strips(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], "the two|our two|these two|the 2").filter(|n| {
            tokens
                .get(i + n)
                .is_some_and(|t| t.text.ends_with('s') && is_strip(&t.text))
        })?;
        out.push(word("both", &tokens[i]));
        Some(i + n)
    })
}

/// "on both sides, two each", "four per side": on each side.
fn per_side(tokens: &[Token]) -> Vec<Token> {
    const PER: &str = "per side|a side|each side|to each side|to a side|at each side|along each side|per kerb|per curb|per pavement|per sidewalk|for each side|per edge|either side|each kerb|each pavement|each sidewalk|on each of them|on either of them|to either side|on each one";
    const EACH: &str = "each|apiece|on each|on either|along each|at each|per each";
    const BOTH: &str = "both sides|each side|either side|both kerbs|both curbs|both pavements|both sidewalks|both edges|both footpaths|both shoulders|both verges|left and right|opposite sides|opposite pavements|opposite sidewalks";
    let mut sides = false;
    rewritten(tokens, |i, out| {
        if tokens[i].kind == TokenKind::Stop && tokens[i].text != ";" {
            sides = false;
        }
        sides |= begins(&tokens[i..], BOTH).is_some();
        // (the number of a noun is no share: "two cars each")
        let counted = out.last().is_some_and(|t| number(t).is_some()) && out.len() > 1;
        let n = begins(&tokens[i..], PER)
            .or_else(|| begins(&tokens[i..], EACH).filter(|n| sides && ends(tokens.get(i + n))))
            .filter(|_| counted)?;
        out.extend(["on", "each", "side"].map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// "first at 10 m, then at 20 m": one at 10 m, one at 20 m.
fn one_by_one(tokens: &[Token]) -> Vec<Token> {
    let far = |i: usize| {
        let at = begins(&tokens[i..], "at|at about|at roughly|after")?;
        let unit = tokens.get(i + at + 1).is_some_and(is_unit);
        (tokens.get(i + at).is_some_and(|t| number(t).is_some()) && unit).then_some(())
    };
    let lead = |i: usize| {
        begins(
            &tokens[i..],
            "and then|then|and next|next|and finally|finally|and lastly|lastly",
        )
    };
    let first =
        (1..tokens.len()).find(|i| tokens[*i].text == "first" && opens(tokens, *i) && far(i + 1).is_some());
    let Some(first) = first else {
        return tokens.to_vec();
    };
    let then = |i: usize| opens(tokens, i) && lead(i).is_some_and(|n| far(i + n).is_some());
    if !(first..tokens.len()).any(then) {
        return tokens.to_vec();
    }
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = if i == first {
            Some(1)
        } else {
            lead(i).filter(|_| i > first && then(i))
        };
        match n {
            Some(n) => {
                out.push(word("one", &tokens[i]));
                i += n;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn shares_in_numbers() {
        let said = |t: &str| {
            let list: Vec<String> = counted(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("six cars: half of them come, the other half go"),
            "six cars : 3 of them come , the others go"
        );
        assert_eq!(
            said("parked cars on both sides, two each"),
            "parked cars on both sides , two on each side"
        );
        assert_eq!(said("four cars, two per side"), "four cars , two on each side");
        assert_eq!(
            said("as many buses as trucks, namely two of each"),
            "2 buses and 2 trucks"
        );
        assert_eq!(said("half a mile ahead"), "half a mile ahead");
        assert_eq!(
            said("cars: first at 10 m, then at 20 m"),
            "cars : one at 10 m , one at 20 m"
        );
    }
}
