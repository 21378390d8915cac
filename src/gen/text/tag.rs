//! Tokens to senses: the longest run of words that the lexicon knows, read from left to right.

use super::description::Count;
use super::lexicon::{LONGEST, Sense, look_up, nearest};
use super::tokens::{Span, Token, TokenKind};
use super::words::places;

/// What an item is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tag {
    /// A run of words with a meaning.
    Is(Sense),
    /// Digits.
    Number(f64),
    /// A comma.
    Comma,
    /// The end of a sentence.
    Stop,
    /// A colon, a dash, a bracket.
    Mark,
    /// Not in the lexicon.
    Unknown,
}

/// A run of tokens.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it means.
    pub tag: Tag,
    /// Its words, as looked up.
    pub words: String,
    /// Where it stood.
    pub span: Span,
    /// What a misspelt word was taken for.
    pub read_as: Option<&'static str>,
}

fn is_place_like(sense: Sense) -> bool {
    matches!(sense, Sense::Place(..) | Sense::FarSide | Sense::BothSides(_))
}

/// Tags all tokens.
pub fn tag(tokens: &[Token]) -> Vec<Item> {
    let tokens = &super::wording::without_order(tokens)[..];
    let word = |i: usize| {
        tokens
            .get(i)
            .filter(|t| matches!(t.kind, TokenKind::Word | TokenKind::Symbol))
            .map(|t| t.text.as_str())
    };
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let token = &tokens[i];
        let plain = match token.kind {
            TokenKind::Number(v) => Some(number(v, tokens.get(i + 1))),
            TokenKind::Comma => Some(Tag::Comma),
            TokenKind::Stop => Some(Tag::Stop),
            TokenKind::Mark => Some(Tag::Mark),
            TokenKind::Word | TokenKind::Symbol => None,
        };
        if let Some(tag) = plain {
            out.push(Item {
                tag,
                words: token.text.clone(),
                span: token.span,
                read_as: None,
            });
            i += 1;
            continue;
        }
        let run = |from: usize, n: usize| -> Option<String> {
            let words: Option<Vec<&str>> = (from..from + n).map(word).collect();
            words.map(|w| w.join(" "))
        };
        let found = (1..=LONGEST).rev().find_map(|n| {
            let words = run(i, n)?;
            let mut sense = look_up(&words);
            // "the lane to the left of yours"
            if sense.is_none()
                && n > 1
                && (i..i + n).any(|k| {
                    word(k).is_some_and(|w| matches!(w, "your" | "our" | "yours" | "ours" | "you" | "us"))
                })
            {
                let mine: Vec<&str> = (i..i + n).filter_map(word).map(as_mine).collect();
                sense = look_up(&mine.join(" "));
            }
            let sense = sense?;
            // "parked across from a bus"
            let across = n > 1 && words.ends_with(" across");
            if across && word(i + n) == Some("from") {
                return None;
            }
            // "parked across the street from a bus"
            let road = word(i + n) == Some("the")
                && word(i + n + 1).is_some_and(|w| matches!(w, "street" | "road" | "way"));
            if across && road && word(i + n + 2) == Some("from") {
                return None;
            }
            // "in our lane ahead of us"
            if n > 1
                && words.ends_with(" ahead")
                && matches!(sense, Sense::Place(..))
                && word(i + n) == Some("of")
            {
                return None;
            }
            // "on the left" must not tear "left lane" apart.
            let torn = n > 1
                && !is_place_like(sense)
                && (i + 1..i + n).any(|from| {
                    (i + n - from + 1..=LONGEST)
                        .filter_map(|m| run(from, m))
                        .any(|w| {
                            look_up(&w).is_some_and(is_place_like) && w.split(' ').next().is_some_and(is_side)
                        })
                });
            (!torn).then_some((n, words, sense))
        });
        let (n, words, tag, read_as) = match found {
            Some((n, words, sense)) => (n, words, Tag::Is(sense), None),
            None => {
                let guess = nearest(&token.text);
                let tag = guess.and_then(look_up).map_or(Tag::Unknown, Tag::Is);
                (1, token.text.clone(), tag, guess)
            }
        };
        out.push(Item {
            tag,
            words,
            span: token.span.to(tokens[i + n - 1].span),
            read_as,
        });
        i += n;
    }
    super::compounds::joined(settle(out))
}

fn as_mine(word: &str) -> &str {
    match word {
        "your" | "our" => "my",
        "yours" | "ours" => "mine",
        "you" | "us" => "me",
        other => other,
    }
}

fn is_side(word: &str) -> bool {
    let sides = places::LEFT.split('|').chain(places::RIGHT.split('|'));
    let middle = matches!(word, "middle" | "centre" | "center");
    middle || sides.into_iter().any(|s| s.split(' ').next() == Some(word))
}

fn number(v: f64, _next: Option<&Token>) -> Tag {
    Tag::Number(v)
}

/// Words whose sense hangs on their neighbours: "crossing", "pedestrian crossing", "parking", "twenty five".
fn settle(items: Vec<Item>) -> Vec<Item> {
    let mut out: Vec<Item> = Vec::new();
    let mut skip = 0;
    for (i, item) in items.iter().enumerate() {
        if skip > 0 {
            skip -= 1;
            continue;
        }
        let next = items.get(i + 1);
        let after_next = items.get(i + 2);
        let before = out.last();
        let follows_place = before.is_some_and(|b| {
            matches!(
                b.tag,
                Tag::Is(
                    Sense::Article(_) | Sense::In | Sense::At | Sense::Rel(_) | Sense::Color(_) | Sense::Not
                )
            ) || matches!(b.words.as_str(), "my" | "with" | "wide" | "our" | "of")
                // "an ordinary crossing"
                || matches!(b.tag, Tag::Is(Sense::Attribute(_) | Sense::Size(_)))
                    && matches!(out.as_slice(), [.., a, _] if matches!(a.tag, Tag::Is(Sense::Article(_))))
        });
        match (item.words.as_str(), item.tag) {
            ("crossing", _) => {
                // After an article or a preposition it is a place, after a noun it is done by it.
                let sense = if follows_place || before.is_none() && !next.is_some_and(leads_to_road) {
                    look_up("crosswalk")
                } else {
                    look_up("walking across")
                };
                out.push(Item {
                    tag: sense.map_or(Tag::Unknown, Tag::Is),
                    ..item.clone()
                });
            }
            ("pedestrian crossing" | "ped crossing", _)
                if next.is_some_and(leads_to_road)
                    && !(at_place(out.as_slice())
                        && next.is_some_and(|n| n.tag == Tag::Is(Sense::Article(false))))
                    || one_more(out.as_slice()) =>
            {
                // "a pedestrian crossing the road"
                let cut = item.span.start + item.words.find(' ').unwrap_or(0);
                out.push(Item {
                    tag: look_up("pedestrian").map_or(Tag::Unknown, Tag::Is),
                    words: "pedestrian".into(),
                    span: Span {
                        start: item.span.start,
                        end: cut,
                    },
                    read_as: None,
                });
                out.push(Item {
                    tag: look_up("walking across").map_or(Tag::Unknown, Tag::Is),
                    words: "crossing".into(),
                    span: Span {
                        start: cut + 1,
                        end: item.span.end,
                    },
                    read_as: None,
                });
            }
            // "straight at us", not "a straight road"
            ("straight", _)
                if !before.is_some_and(|b| {
                    matches!(
                        b.tag,
                        Tag::Is(Sense::Article(_) | Sense::Attribute(_) | Sense::Size(_))
                    )
                }) && !next.is_some_and(|n| {
                    matches!(
                        n.tag,
                        Tag::Is(
                            Sense::Place(..) | Sense::RoadKind(..) | Sense::Width(_) | Sense::Environment(_)
                        )
                    )
                }) =>
            {
                out.push(Item {
                    tag: Tag::Is(Sense::Filler),
                    ..item.clone()
                });
            }
            // "is walking back to it": towards it
            ("back to", Tag::Is(Sense::Rel(_)))
                if before.is_some_and(|b| {
                    matches!(
                        b.tag,
                        Tag::Is(Sense::State(crate::scene::graph::ObjectState::Moving, _))
                    )
                }) =>
            {
                out.push(Item {
                    tag: look_up("walking towards").map_or(Tag::Unknown, Tag::Is),
                    ..item.clone()
                });
            }
            // "barriers close the oncoming lane"
            ("close", _)
                if next.is_some_and(|n| {
                    n.tag == Tag::Is(Sense::Article(true)) || matches!(n.words.as_str(), "my" | "our")
                }) && after_next.is_some_and(|n| matches!(n.tag, Tag::Is(Sense::Place(..))))
                    || next.is_some_and(|n| {
                        (n.words.starts_with("my ") || n.words.starts_with("our "))
                            && matches!(n.tag, Tag::Is(Sense::Place(..)))
                    }) && item.words == "close" =>
            {
                out.push(Item {
                    tag: look_up("closing").map_or(Tag::Unknown, Tag::Is),
                    ..item.clone()
                });
            }
            ("parking", _) if !follows_place => out.push(Item {
                tag: look_up("parked").map_or(Tag::Unknown, Tag::Is),
                ..item.clone()
            }),
            // "double decker" and the like are longer runs; "a couple" alone is two people.
            ("a couple" | "couple", Tag::Is(Sense::Count(_)))
                if !next.is_some_and(continues_noun)
                    // "a couple walking through it", not "a couple parked cars"
                    || matches!(next.map(|n| n.tag), Some(Tag::Is(Sense::State(_, false))))
                        && !after_next.is_some_and(|n| matches!(n.tag, Tag::Is(Sense::Noun(..) | Sense::Color(_) | Sense::Size(_)))) =>
            {
                let tag = look_up("pedestrian").map_or(Tag::Unknown, Tag::Is);
                out.push(item.clone());
                out.push(Item { tag, ..item.clone() });
            }
            (_, Tag::Is(Sense::Count(units))) if units.is_exact() && (1..10).contains(&units.n) => {
                let tens = out.last().and_then(|b| match b.tag {
                    Tag::Is(Sense::Count(c)) if c.is_exact() && c.n >= 20 && c.n % 10 == 0 && c.n < 100 => {
                        Some(c.n)
                    }
                    _ => None,
                });
                match (tens, out.last_mut()) {
                    (Some(tens), Some(last)) => {
                        last.tag = Tag::Is(Sense::Count(Count::exactly(tens + units.n)));
                        last.words = format!("{} {}", last.words, item.words);
                        last.span = last.span.to(item.span);
                    }
                    _ => out.push(item.clone()),
                }
            }
            // "18-wheeler"
            (_, Tag::Number(_))
                if next.is_some_and(|n| {
                    matches!(n.words.as_str(), "wheeler" | "wheelers" | "tonner" | "seater")
                }) => {}
            (_, Tag::Number(hour))
                if next.is_some_and(|n| matches!(n.words.as_str(), "am" | "pm" | "oclock")) =>
            {
                // "11 o'clock in the morning"
                let part = after_next.map_or("", |n| n.words.as_str());
                let later = matches!(part, "in the evening" | "in the afternoon")
                    || part == "at night" && hour >= 5.0;
                if later || matches!(part, "in the morning" | "at night") {
                    skip = 2;
                }
                let pm = later || next.is_some_and(|n| n.words == "pm");
                out.push(Item {
                    tag: Tag::Is(Sense::Time(time_of(hour, pm))),
                    ..item.clone()
                });
            }
            ("am" | "pm" | "oclock", _)
                if before.is_some_and(|b| matches!(b.tag, Tag::Is(Sense::Time(_)))) =>
            {
                if let Some(last) = out.last_mut() {
                    last.span = last.span.to(item.span);
                }
            }
            // 22:30
            (_, Tag::Number(hour))
                if next.is_some_and(|n| n.words == ":")
                    && after_next.is_some_and(|n| matches!(n.tag, Tag::Number(m) if m < 60.0))
                    && hour < 25.0 =>
            {
                out.push(Item {
                    tag: Tag::Is(Sense::Time(time_of(hour, false))),
                    ..item.clone()
                });
                skip = 2;
                if items
                    .get(i + 3)
                    .is_some_and(|n| matches!(n.words.as_str(), "hrs" | "hours" | "hour" | "h" | "oclock"))
                {
                    skip = 3;
                }
            }
            // "0340 hrs"
            (_, Tag::Number(clock))
                if next.is_some_and(|n| matches!(n.words.as_str(), "hrs" | "hours" | "h"))
                    && item.span.end - item.span.start == 4
                    && clock < 2400.0 =>
            {
                out.push(Item {
                    tag: Tag::Is(Sense::Time(time_of((clock / 100.0).floor(), false))),
                    ..item.clone()
                });
                skip = 1;
            }
            // "at 3 in the morning"
            (_, Tag::Number(hour))
                if hour <= 12.0
                    && next.is_some_and(|n| {
                        matches!(
                            n.words.as_str(),
                            "in the morning" | "in the evening" | "in the afternoon" | "at night"
                        )
                    }) =>
            {
                let part = next.map_or("", |n| n.words.as_str());
                let pm = part != "in the morning" && !(part == "at night" && hour < 5.0);
                out.push(Item {
                    tag: Tag::Is(Sense::Time(time_of(hour, pm))),
                    ..item.clone()
                });
                skip = 1;
            }
            // "two nos. JCB"
            ("nos" | "numbers" | "no", _)
                if before.is_some_and(|b| matches!(b.tag, Tag::Is(Sense::Count(_)) | Tag::Number(_)))
                    && (item.words != "no" || item.span.end - item.span.start == 3) =>
            {
                skip = usize::from(next.is_some_and(|n| n.tag == Tag::Stop) && items.get(i + 2).is_some());
            }
            _ => out.push(item.clone()),
        }
    }
    out
}

pub(super) fn time_of(hour: f64, pm: bool) -> super::description::TimeOfDay {
    use super::description::TimeOfDay::{Dawn, Day, Dusk, Night};
    let hour = if pm && hour < 12.0 { hour + 12.0 } else { hour };
    match hour {
        h if h < 5.0 => Night,
        h if h < 8.0 => Dawn,
        h if h < 18.0 => Day,
        h if h < 21.0 => Dusk,
        _ => Night,
    }
}

/// True after "at the", "on a": a place follows.
fn at_place(before: &[Item]) -> bool {
    matches!(
        before,
        [.., prep, article] if matches!(article.tag, Tag::Is(Sense::Article(_))) && matches!(prep.tag, Tag::Is(Sense::In | Sense::At | Sense::Rel(_)))
    )
}

/// True after "another", where somebody crosses already: no second zebra is meant.
fn one_more(before: &[Item]) -> bool {
    let more = before.last().is_some_and(|b| {
        matches!(
            b.words.as_str(),
            "another" | "a second" | "a third" | "one more" | "a further"
        )
    });
    more && before.iter().any(
        |b| matches!(b.tag, Tag::Is(Sense::Noun(n, _)) if n.classes[0] == crate::scene::Class::Pedestrian),
    )
}

fn leads_to_road(item: &Item) -> bool {
    matches!(
        item.tag,
        Tag::Is(Sense::Article(_) | Sense::Place(..) | Sense::In | Sense::At | Sense::Attribute(_))
    ) || matches!(
        item.words.as_str(),
        "my" | "our" | "from" | "in front of" | "behind" | "ahead of" | "in front"
    )
}

fn continues_noun(item: &Item) -> bool {
    matches!(
        item.tag,
        Tag::Is(
            Sense::Noun(..)
                | Sense::Color(_)
                | Sense::Size(_)
                | Sense::State(_, false)
                | Sense::Attribute(_)
                | Sense::EgoRel(_)
                | Sense::Pick(_)
        )
    ) || item.words == "of"
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn words(prompt: &str) -> Vec<String> {
        tag(&tokens(prompt)).into_iter().map(|i| i.words).collect()
    }

    #[test]
    fn longest_runs_but_no_torn_places() {
        assert_eq!(words("on the left"), ["on the left"]);
        assert_eq!(words("on the left lane"), ["on", "the", "left lane"]);
        assert_eq!(
            words("on the left side of the road"),
            ["on", "the", "left side of the road"]
        );
        assert_eq!(
            words("on the left side of the bus"),
            ["on the left side of", "the", "bus"]
        );
        assert_eq!(words("twenty five cars"), ["twenty five", "cars"]);
        assert_eq!(
            words("a pedestrian crossing the road"),
            ["a", "pedestrian", "crossing", "the", "road"]
        );
        assert_eq!(
            words("at the pedestrian crossing"),
            ["at", "the", "pedestrian crossing"]
        );
    }
}
