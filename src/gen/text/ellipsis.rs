//! What a later clause leaves out because an earlier one said it, filled in from there: "all but one of the five", "the same
//! distance behind", "another pair", "at the left kerb and at the right", "the one to my right" of lanes.

use super::description::Anchor;
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};
use crate::scene::graph::LaneRole;

/// A text with what its clauses leave out.
pub fn filled(tokens: &[Token]) -> Vec<Token> {
    let mut out = Vec::new();
    for sentence in sentences(tokens) {
        let mut s = super::measures::farther_by(sentence, &out);
        s = super::measures::same_distance(&s, &out);
        s = same_side(&s, &out);
        s = super::ellipsis_lanes::one_lane(&s);
        s = super::ellipsis_lanes::has_again(&s);
        s = super::ellipsis_lanes::next_lane(&s);
        s = second_side(&s);
        s = place_again(&s, &out);
        s = replaced(
            &s,
            "every one of them|every single one of them|each and every one of them|each one of them|the lot of them",
            "all of them",
        );
        s = super::measures::same_number(&s);
        s = each_of_both(&s);
        s = more_groups(&s);
        s = our_way(&s);
        s = one_a_side(&s);
        s = each_has_one(&s);
        s = each_of_so_many(&s);
        out.extend(s);
    }
    all_but(&out)
}

/// Sentences with their stops; a semicolon does not part what leans on the clause before it.
fn sentences(tokens: &[Token]) -> impl Iterator<Item = &[Token]> {
    tokens.split_inclusive(|t| t.kind == TokenKind::Stop && t.text != ";")
}

/// An exact number.
pub fn number(t: &Token) -> Option<u32> {
    match (&t.kind, look_up(&t.text)) {
        (TokenKind::Number(v), _) if v.is_finite() && (0.0..1000.0).contains(v) => Some(v.round() as u32),
        (_, Some(Sense::Count(c))) if c.is_exact() => Some(c.n),
        _ => None,
    }
}

/// True for a single word that names objects.
pub fn is_noun(t: &Token) -> bool {
    t.kind == TokenKind::Word && matches!(look_up(&t.text), Some(Sense::Noun(..)))
}

pub(super) fn is_unit(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Unit(_)))
}

/// Kerbs, pavements: strips that each side of a road has.
pub(super) fn is_strip(word: &str) -> bool {
    matches!(
        look_up(word),
        Some(Sense::Place(
            Anchor::Lane(LaneRole::Roadside | LaneRole::Sidewalk),
            _
        ))
    )
}

pub(super) fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Stop | TokenKind::Mark))
}

pub(super) fn digits(n: u32, at: &Token) -> Token {
    Token {
        kind: TokenKind::Number(f64::from(n)),
        text: n.to_string(),
        span: at.span,
    }
}

/// "on that same side": the side that was named last.
fn same_side(sentence: &[Token], before: &[Token]) -> Vec<Token> {
    const SAME: &str = "on that same side|on the same side|on that side|on this side|on the selfsame side|at the same side|to the same side";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentence.len() {
        let side = out
            .iter()
            .chain(before)
            .rev()
            .find(|t| matches!(t.text.as_str(), "left" | "right"))
            .or_else(|| {
                before
                    .iter()
                    .rev()
                    .find(|t| matches!(t.text.as_str(), "left" | "right"))
            })
            .map(|t| t.text.clone());
        let own =
            |n: usize| begins(&sentence[i + n..], "of me|of us|of it|of the bus|of my car|as").is_none();
        match (begins(&sentence[i..], SAME).filter(|n| own(*n)), side) {
            (Some(n), Some(side)) => {
                out.extend(["on", "the", &side].map(|w| word(w, &sentence[i])));
                i += n;
                i += begins(&sentence[i..], "of the road|of the street|of the carriageway").unwrap_or(0);
            }
            _ => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "two at the left kerb and two at the right": the strip again.
fn second_side(sentence: &[Token]) -> Vec<Token> {
    let side = |t: &Token| matches!(t.text.as_str(), "left" | "right");
    let prep = |t: &Token| matches!(t.text.as_str(), "on" | "at" | "along" | "by" | "from");
    let mut strip: Option<(Token, Token, Token)> = None; // preposition, side, strip
    let mut out: Vec<Token> = Vec::new();
    let (mut i, mut named) = (0, 0);
    while i < sentence.len() {
        let t = &sentence[i];
        out.push(t.clone());
        i += 1;
        // "on the right kerb, two cars on the left": of the cars nothing was left out
        named += usize::from(is_noun(t));
        let led = out.len() > 2
            && prep(&out[out.len() - 3])
            && matches!(out[out.len() - 2].text.as_str(), "the" | "my" | "our");
        if !side(t) || !led {
            continue;
        }
        let lead = out[out.len() - 3].clone();
        let hand = usize::from(sentence.get(i).is_some_and(|t| t.text == "hand"));
        if let Some(place) = sentence.get(i + hand).filter(|t| is_strip(&t.text)) {
            strip = Some((lead, t.clone(), place.clone()));
            named = 0;
        } else if let Some((first, other, place)) = &strip
            && first.text == lead.text
            && other.text != t.text
            && named == 0
            && (ends(sentence.get(i))
                || sentence
                    .get(i)
                    .is_some_and(|t| matches!(t.text.as_str(), "and" | "one" | "too" | "as")))
        {
            i += usize::from(sentence.get(i).is_some_and(|t| t.text == "one"));
            out.push(Token {
                span: t.span,
                ..place.clone()
            });
        }
    }
    out
}

/// "the far pavement is empty, on the right one a mother walks": the pavement again.
fn place_again(sentence: &[Token], before: &[Token]) -> Vec<Token> {
    let place = |t: &&Token| is_strip(&t.text) || t.text == "lane";
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in sentence.iter().enumerate() {
        let sided = t.text == "one"
            && i > 1
            && matches!(
                sentence[i - 1].text.as_str(),
                "left" | "right" | "hand" | "far" | "near" | "opposite" | "oncoming"
            )
            && matches!(
                sentence[i - 2].text.as_str(),
                "the" | "my" | "our" | "left" | "right"
            );
        // (things on the left and on the right are no places)
        let noun = sided
            .then(|| out.iter().chain(before).rev().find(|t| place(t) || is_noun(t)))
            .flatten()
            .or_else(|| before.iter().rev().find(|t| sided && out.is_empty() && place(t)))
            .filter(place)
            .map(|t| t.text.clone());
        match noun {
            Some(noun) => out.push(word(&noun, t)),
            None => out.push(t.clone()),
        }
    }
    out
}

/// "on each of the two pavements" is "on each pavement".
fn each_of_both(sentence: &[Token]) -> Vec<Token> {
    const EACH: &str = "each of the two|each of the|each one of the two|each one of the|either of the two|either of the|each of both|each of our two";
    rewritten(sentence, |i, out| {
        let n = begins(&sentence[i..], EACH).unwrap_or(0);
        let singular = sentence.get(i + n).and_then(|t| t.text.strip_suffix('s'));
        let s = singular.filter(|s| n > 0 && (is_strip(s) || *s == "side"))?;
        out.extend(["each", s].map(|w| word(w, &sentence[i])));
        Some(i + n + 1)
    })
}

/// "another pair at the right" is "two more".
fn more_groups(sentence: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentence.len() {
        let n = begins(&sentence[i..], "another|a second|a further|one more|yet another").unwrap_or(0);
        let many = sentence.get(i + n).and_then(|t| match t.text.as_str() {
            "pair" | "couple" | "twosome" | "duo" => Some(2),
            "trio" | "threesome" => Some(3),
            "dozen" => Some(12),
            _ => number(t).filter(|k| *k > 1),
        });
        let noun = sentence
            .get(i + n + 1..)
            .is_some_and(|rest| begins(rest, "of").is_some() || rest.iter().take(2).any(is_noun));
        match many.filter(|_| n > 0 && !noun) {
            Some(k) => {
                out.push(digits(k, &sentence[i]));
                out.push(word("more", &sentence[i]));
                i += n + 1;
            }
            None => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "one heading my way, the other the opposite way": beside the opposite way, mine is the way that I go.
fn our_way(sentence: &[Token]) -> Vec<Token> {
    const OPPOSITE: &str = "the opposite way|the other way|in the opposite direction|in the other direction|the opposite direction|the other direction";
    let opposed = (0..sentence.len()).any(|i| begins(&sentence[i..], OPPOSITE).is_some());
    if !opposed {
        return sentence.to_vec();
    }
    replaced(
        sentence,
        "heading my way|heading our way|going my way|going our way|driving my way|driving our way|travelling my way|travelling our way|traveling my way|moving my way|moving our way|goes my way|drives my way|heads my way",
        "driving in the same direction as me",
    )
}

/// "two buses are parked, one on each side": the two of them on both sides.
fn one_a_side(sentence: &[Token]) -> Vec<Token> {
    const EACH: &str = "one on each|one on either|one at each|one at either|one along each";
    let Some(i) = (1..sentence.len()).find(|i| begins(&sentence[*i..], EACH).is_some()) else {
        return sentence.to_vec();
    };
    let two = sentence[..i].windows(3).any(|w| {
        (number(&w[0]) == Some(2) || matches!(w[0].text.as_str(), "pair" | "couple"))
            && w[1..].iter().any(is_noun)
    });
    let n = begins(&sentence[i..], EACH).unwrap_or(0);
    // "flanked by two motorbikes, one on either side": that is what flanking is
    let flanks = sentence[..i]
        .windows(2)
        .any(|w| w[0].text == "flanked" && w[1].text == "by");
    if flanks && i + n < sentence.len() && ends(sentence.get(i + n + 1)) {
        let apart = usize::from(sentence[i - 1].kind == TokenKind::Comma);
        return [&sentence[..i - apart], &sentence[i + n + 1..]].concat();
    }
    let Some(place) = sentence
        .get(i + n)
        .filter(|t| two && (t.text == "side" || is_strip(&t.text)))
    else {
        return sentence.to_vec();
    };
    let mut out = sentence[..i].to_vec();
    while out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
        out.pop();
    }
    let both = format!("{}s", place.text);
    out.extend(["on", "both", &both].map(|w| word(w, &sentence[i])));
    out.extend_from_slice(&sentence[i + n + 1..]);
    out
}

/// "two buses ..., and behind each of them stands a car": behind them stand two cars.
fn each_has_one(sentence: &[Token]) -> Vec<Token> {
    const EACH: &str = "each of them|each of the two|each of these|every one of them|each one|each of which|both of them|each";
    let Some(i) = (2..sentence.len()).find(|i| {
        let led = matches!(
            sentence[i - 1].text.as_str(),
            "behind" | "beside" | "of" | "to" | "near" | "before" | "on" | "following"
        );
        led && begins(&sentence[*i..], EACH).is_some_and(|n| {
            !sentence
                .get(i + n)
                .is_some_and(|t| is_noun(t) || is_strip(&t.text) || t.text == "side" || t.text == "other")
        })
    }) else {
        return sentence.to_vec();
    };
    let n = begins(&sentence[i..], EACH).unwrap_or(1);
    let many = (0..i).rev().find_map(|k| {
        let group =
            sentence[k + 1..i].iter().take(3).any(is_noun) && !sentence.get(k + 1).is_some_and(is_unit);
        number(&sentence[k]).filter(|c| group && (2..=12).contains(c))
    });
    let one = (i + n..sentence.len().min(i + n + 4))
        .find(|k| matches!(sentence[*k].text.as_str(), "a" | "an" | "one"));
    let (Some(many), Some(one)) = (many, one) else {
        return sentence.to_vec();
    };
    let mut out = sentence[..i].to_vec();
    out.push(word("them", &sentence[i]));
    out.extend_from_slice(&sentence[i + n..one]);
    out.push(digits(many, &sentence[one]));
    out.extend_from_slice(&sentence[one + 1..]);
    out
}

/// "beside each of three pylons stands a worker": beside three pylons three workers.
fn each_of_so_many(sentence: &[Token]) -> Vec<Token> {
    const EACH: &str = "each of the|each of our|each of those|each of|each one of the|every one of the";
    let found = (1..sentence.len()).find_map(|i| {
        let led = matches!(
            sentence[i - 1].text.as_str(),
            "behind" | "beside" | "to" | "near" | "before" | "of" | "by"
        );
        let n = begins(&sentence[i..], EACH).filter(|_| led)?;
        let many = sentence
            .get(i + n)
            .and_then(number)
            .filter(|k| (2..=12).contains(k))?;
        let noun = (i + n + 1..sentence.len().min(i + n + 4)).find(|k| is_noun(&sentence[*k]))?;
        let one = (noun + 1..sentence.len().min(noun + 5))
            .find(|k| matches!(sentence[*k].text.as_str(), "a" | "an" | "one"))?;
        Some((i, i + n, many, one))
    });
    let Some((each, count, many, one)) = found else {
        return sentence.to_vec();
    };
    let more = digits(many, &sentence[one]);
    let parts = [
        &sentence[..each],
        &sentence[count..one],
        &[more],
        &sentence[one + 1..],
    ];
    parts.concat()
}

/// "Five children. All but one are on the left": four of them are.
fn all_but(tokens: &[Token]) -> Vec<Token> {
    const ALL_BUT: &str = "all but|all except|all bar|all save|all except for|all but for|all apart from|everyone but|everybody but|everyone except|everybody except|every one but|all of them but|all of them except|all of them except for|all of them apart from";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let rest = &tokens[i..];
        let cut = begins(rest, ALL_BUT)
            .and_then(|n| Some((n, number(rest.get(n)?)?)))
            .filter(|(n, _)| !rest.get(n + 1).is_some_and(is_noun));
        let Some((n, less)) = cut else {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        };
        let mut next = n + 1;
        // "all but one of the five children"
        let of = begins(&rest[next..], "of the|of these|of those|of my").unwrap_or(0);
        let own = rest
            .get(next + of)
            .filter(|_| of > 0)
            .and_then(number)
            .zip(rest.get(next + of + 1).filter(|t| is_noun(t)));
        let whole = own.map(|(k, _)| k).or_else(|| {
            (0..out.len()).rev().find_map(|k| {
                let group = out[k + 1..].iter().take(3).any(is_noun) && !out.get(k + 1).is_some_and(is_unit);
                number(&out[k]).filter(|_| group)
            })
        });
        let Some(left) = whole.and_then(|w| w.checked_sub(less)).filter(|l| *l > 0) else {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        };
        if let Some((k, noun)) = own {
            out.extend([
                digits(k, &tokens[i]),
                noun.clone(),
                Token {
                    kind: TokenKind::Comma,
                    ..word(",", noun)
                },
            ]);
            next += of + 2;
        } else {
            next += begins(&rest[next..], "of them").unwrap_or(0);
        }
        out.push(digits(left, &tokens[i]));
        out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
        i += next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn said(text: &str) -> String {
        let list: Vec<String> = filled(&tokens(text)).into_iter().map(|t| t.text).collect();
        list.join(" ")
    }

    #[test]
    fn what_was_left_out_is_filled_in() {
        assert_eq!(
            said("Five men. All but two are on the left"),
            "five men . 3 of them are on the left"
        );
        assert_eq!(
            said("a bus 20 m ahead and a car the same distance behind me"),
            "a bus 20 m ahead and a car 20 m behind me"
        );
        assert_eq!(
            said("two at the left kerb and another pair at the right"),
            "two at the left kerb and 2 more at the right kerb"
        );
        assert_eq!(
            said("the lane to my left has a bus in it, the one to my right a taxi"),
            "the lane to my left has a bus in it , the lane to my right has a taxi"
        );
        assert_eq!(said("on each of the two pavements"), "on each pavement");
        assert_eq!(
            said("a taxi at the right kerb and a man on the pavement on that same side"),
            "a taxi at the right kerb and a man on the pavement on the right"
        );
        assert_eq!(
            said("two buses are parked, one on each side of the street"),
            "two buses are parked on both sides of the street"
        );
    }
}
