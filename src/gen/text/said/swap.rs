//! Two that take each other's place: "swap the bus and the car", "the two change places", "A where B is and the other way round".

use super::super::edit_command::target_part;
use super::super::edit_grammar::{Back, Command};
use super::super::tag::tag;
use super::super::tokens::{Span, Token};
use super::super::words::edits::Verb;
use super::Talk;
use super::lists::EXCHANGING;
use super::words::{find, first_noun, is, text};

const PLACES: &[&str] = &[
    "places",
    "positions",
    "spots",
    "locations",
    "place",
    "position",
    "sides",
    "order",
    "slots",
    "lanes",
    "lane",
    "seats",
];

/// Where each noun phrase is, with its article and what describes it.
fn phrases(tokens: &[Token]) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut from = 0;
    while let Some((a, b)) = first_noun(&tokens[from..]) {
        let (start, end) = (from + a, from + b);
        let lead = (from..start)
            .rev()
            .take_while(|i| {
                !EXCHANGING.contains(&text(&tokens[*i]))
                    && !matches!(
                        text(&tokens[*i]),
                        "and" | "with" | "for" | "of" | "by" | "have" | "let" | "where" | "is" | "to" | "put"
                    )
                    && tokens[*i].kind == super::super::tokens::TokenKind::Word
            })
            .last()
            .unwrap_or(start);
        // "the car in the right lane" is that one
        let told =
            super::words::is_place(&tokens[end..]) && !is(tokens.get(end), &["to", "into", "over", "back"]);
        let stop = (end..tokens.len())
            .find(|i| {
                EXCHANGING.contains(&text(&tokens[*i]))
                    || tokens[*i].kind != super::super::tokens::TokenKind::Word
                    || is(
                        tokens.get(*i),
                        &[
                            "and", "with", "for", "by", "where", "is", "are", "should", "must", "so",
                            "places", "take", "takes",
                        ],
                    )
            })
            .unwrap_or(tokens.len());
        let end = if told { stop } else { end };
        out.push((lead, end));
        from = end;
    }
    out
}

/// A command that exchanges two, if the sentence asks for that.
pub fn swap(tokens: &[Token], talk: &Talk<'_>) -> Option<Command> {
    let verb = tokens
        .iter()
        .position(|t| EXCHANGING.contains(&text(t)))
        .or_else(|| {
            find(
                tokens,
                &[
                    "vice versa",
                    "each others place",
                    "each others places",
                    "each other place",
                    "one anothers place",
                    "one anothers places",
                ],
            )
            .map(|x| x.0)
        })
        .or_else(|| (tokens.iter().filter(|t| text(t) == "where").count() == 2).then_some(0))?;
    // "change to the right lane" is a way to go
    let goes = is(tokens.get(verb + 1), &["to", "into", "over", "onto"])
        || is(tokens.get(verb + 1), &["lane", "lanes", "sides"]) && is(tokens.get(verb + 2), &["to", "into"]);
    if goes {
        return None;
    }
    let twice = tokens.iter().filter(|t| text(t) == "where").count() == 2;
    let places = twice
        || find(tokens, PLACES).is_some()
        || find(
            tokens,
            &["vice versa", "each other", "each others", "one another"],
        )
        .is_some();
    let mut list = phrases(tokens);
    if twice && list.len() > 2 {
        list.truncate(2);
    }
    let span = tokens.iter().fold(tokens[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Swap, talk.text, span);
    // "let them swap places" of two that were named
    if list.is_empty()
        && places
        && tokens
            .iter()
            .any(|t| matches!(text(t), "they" | "them" | "two" | "both"))
    {
        c.back = Some(Back::Same);
        return Some(c);
    }
    // "the two trucks change places"
    if let ([one], true) = (list.as_slice(), places) {
        let np = &tokens[one.0..one.1];
        if talk.fits(np) != 2 || !np.iter().any(|t| matches!(text(t), "two" | "both" | "the")) {
            return None;
        }
        target_part(talk.text, &tag(np), &mut c);
        return Some(c);
    }
    let [one, two] = *list.get(..2)? else {
        return None;
    };
    if list.len() > 2 && !places {
        return None;
    }
    // "swap the bus for a van" puts another in its place
    let fresh = |np: &(usize, usize)| is(tokens.get(np.0), &["a", "an", "another", "some"]);
    let (a, b) = (&tokens[one.0..one.1], &tokens[two.0..two.1]);
    if fresh(&one) || fresh(&two) || talk.fits(a) != 1 || talk.fits(b) != 1 {
        return None;
    }
    let between = tokens[one.1..two.0]
        .iter()
        .any(|t| matches!(text(t), "for" | "into" | "to" | "by"));
    let plain = verb < one.0
        && !between
        && matches!(
            text(&tokens[verb]),
            "swap" | "exchange" | "interchange" | "switch" | "swop" | "swapping" | "exchanging" | "switching"
        );
    if !(places || plain) {
        return None;
    }
    let mut d = Command::new(Verb::Swap, talk.text, span);
    target_part(talk.text, &tag(a), &mut c);
    target_part(talk.text, &tag(b), &mut d);
    let (Some(x), Some(y)) = (c.targets.first().cloned(), d.targets.first().cloned()) else {
        return None;
    };
    c.mentions.clear();
    c.targets = vec![x, y];
    Some(c)
}
