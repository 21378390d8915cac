//! Links that nothing but a clause of its own follows: "..., and for that the cones have to be removed", "... and behind the car
//! there should be a truck", "... and could a police car follow me". Both halves are read one after the other.

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::apart::{orders_something, says};
use super::lists::{HELPERS, NEGATED};
use super::some_of::removes;
use super::words::{
    first_noun, has_noun, is, is_finite, is_place, leads, led, longest, noun_at, number, text,
};

/// Small leads after "and" that name no place of their own: what they point at is the clause before.
const LEADS: &[&str] = &[
    "for that",
    "for this",
    "to that end",
    "to this end",
    "for that purpose",
    "for this purpose",
    "for that reason",
    "for this reason",
    "in exchange",
    "in return",
    "by way of exchange",
    "as compensation",
    "in compensation",
    "to make up for it",
    "to make up for that",
    "to compensate",
    "on top of that",
    "on top of it",
    "besides that",
    "beyond that",
    "moreover",
    "furthermore",
    "apart from that",
    "other than that",
    "at the same time",
    "as a result",
    "because of that",
    "because of this",
];
const THERE_IS: &[&str] = &[
    "there should be",
    "there should also be",
    "there must be",
    "there shall be",
    "there has to be",
    "there is",
    "there are",
    "i want",
    "i need",
    "i would like",
    "id like",
    "we need",
    "we want",
];
const ASKS: &[&str] = &["could", "can", "should", "would", "may", "must"];
const ANYBODY: &[&str] = &["everyone", "everybody", "nobody", "somebody", "someone"];

/// The tokens with a full stop at each such link.
pub fn parted(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        out.extend(of_sentence(sentence.to_vec()));
    }
    out
}

fn of_sentence(tokens: Vec<Token>) -> Vec<Token> {
    // (nobody says so much in one sentence)
    if tokens.len() > 60 {
        return tokens;
    }
    let body = tokens.len() - usize::from(tokens.last().is_some_and(|t| t.kind == TokenKind::Stop));
    let found = (2..body).find_map(|a| {
        let link = |t: &Token| t.kind == TokenKind::Comma || is(Some(t), &["and", "but", "while"]);
        (link(&tokens[a]) && !link(&tokens[a - 1])).then_some(())?;
        let b = (a..body).find(|k| !link(&tokens[*k]))?;
        let words = tokens[a..b].iter().any(|t| t.kind == TokenKind::Word);
        next(&tokens[..a], &tokens[b..body], words).map(|n| (a, n))
    });
    let Some((a, next)) = found else {
        return tokens;
    };
    let stop = Token {
        kind: TokenKind::Stop,
        ..super::words::word(".", &tokens[a])
    };
    let mut out = tokens[..a].to_vec();
    out.push(stop);
    out.extend(of_sentence([&next[..], &tokens[body..]].concat()));
    out
}

fn fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another", "some"]) || t.is_some_and(|t| number(t).is_some())
}

/// One past something new that is named from here: "two cyclists".
fn new_one(tokens: &[Token]) -> Option<usize> {
    let (_, b) = first_noun(tokens).filter(|n| n.0 < 5 && fresh(tokens.first()))?;
    let own = !tokens[1..b]
        .iter()
        .any(|t| t.kind != TokenKind::Word || is(Some(t), &["of", "and", "the"]));
    own.then_some(b)
}

fn verbal(t: &Token) -> bool {
    let w = text(t);
    // ("cones" and "walkers" are no verbs here)
    if matches!(look_up(w), Some(Sense::Noun(..))) {
        return false;
    }
    HELPERS.contains(&w) || NEGATED.contains(&w) || is_finite(w, false) && !w.ends_with("ed")
}

/// True if a command or a statement is complete with these words.
fn whole(left: &[Token]) -> bool {
    const LEANING: &[&str] = &[
        "when", "if", "once", "after", "before", "while", "without", "instead", "rather", "as", "since",
        "because", "although", "though", "with", "where", "between", "whatever", "whoever", "what",
    ];
    let polite = left
        .iter()
        .take_while(|t| {
            is(Some(t), &["please", "now", "then", "and", "also", "ok"]) || t.kind == TokenKind::Comma
        })
        .count();
    let left = &left[polite..];
    let Some(first) = left.first().filter(|t| !is(Some(t), LEANING)) else {
        return false;
    };
    let who = has_noun(left)
        || left
            .iter()
            .any(|t| is(Some(t), &["it", "him", "her", "them", "he", "she", "they", "one"]));
    let wish = leads(
        left,
        &[
            "i want", "i need", "i would", "id like", "we need", "no more", "no",
        ],
    )
    .is_some();
    let number_changes = (fresh(Some(first)) || noun_at(left).is_some())
        && left
            .iter()
            .any(|t| is(Some(t), &["instead", "not", "more", "fewer"]));
    who && left.len() > 2
        && (is_verb(first)
            || wish
            || number_changes
            || is(Some(first), &["let", "have"])
            || left.iter().any(verbal))
        || super::parting::only_sky(left) && left.iter().any(verbal)
}

/// True if a clause begins here: an order, or someone with what is said of him.
fn clause(rest: &[Token]) -> bool {
    orders_something(rest)
        || says(rest)
        || who_does(rest).is_some()
        || leads(rest, THERE_IS).is_some() && has_noun(rest)
        || new_one(rest).is_some_and(|b| rest.get(b).is_some_and(verbal))
}

/// "a bus that faces me has to wait": one past the verb of the clause between.
fn who_does(rest: &[Token]) -> Option<usize> {
    let b = new_one(rest)?;
    is(rest.get(b), &["that", "which", "who"]).then_some(())?;
    let own = (b + 1..rest.len().min(b + 4)).find(|k| verbal(&rest[*k]))?;
    let verb = (own + 1..rest.len().min(own + 10)).find(|k| {
        is(
            rest.get(*k),
            &[
                "has", "should", "must", "is", "needs", "have", "are", "shall", "ought", "waits", "stands",
                "stops",
            ],
        ) && !is(rest.get(k - 1), &["that", "which", "who", "and"])
    })?;
    (verb + 1 < rest.len()).then_some(verb)
}

/// What is read after the full stop, if one stands here: the words after the link, with a verb that they share.
fn next(left: &[Token], right: &[Token], words: bool) -> Option<Vec<Token>> {
    whole(left).then_some(())?;
    let comma = |k: usize| usize::from(right.get(k).is_some_and(|t| t.kind == TokenKind::Comma));
    if let Some(n) = leads(right, LEADS) {
        let n = n + comma(n);
        return clause(&right[n..]).then_some(right[n..].to_vec());
    }
    // "and could a police car follow me"
    if words && is(right.first(), ASKS) {
        let asked = &right[1..];
        let who = new_one(asked).is_some_and(|b| asked.get(b).is_some_and(|t| is_finite(text(t), true)));
        return who.then_some(right.to_vec());
    }
    // "and as the lights have failed a policeman stands ...": only why
    if words
        && is(right.first(), &["as", "since", "because"])
        && is(right.get(1), &["the", "it", "there", "my"])
    {
        let from = (3..right.len().min(12)).find(|k| {
            let why = &right[1..*k - usize::from(right[k - 1].kind == TokenKind::Comma)];
            !has_noun(why)
                && why.iter().any(verbal)
                && new_one(&right[*k..]).is_some()
                && clause(&right[*k..])
        })?;
        return Some(right[from..].to_vec());
    }
    // "and everyone has left"
    if words && is(right.first(), ANYBODY) && right.get(1).is_some_and(verbal) && right.len() > 2 {
        return Some(right.to_vec());
    }
    // "and nobody on foot", "and no one on the left sidewalk"
    if words
        && leads(right, &["nobody", "no one"])
            .is_some_and(|n| is_place(&right[n..]) || leads(&right[n..], &["on foot", "else"]).is_some())
    {
        return (!right.iter().any(|t| is(Some(t), &["and", "but", "or"]))).then_some(right.to_vec());
    }
    if words && who_does(right).is_some() {
        return Some(right.to_vec());
    }
    // "remove the worker and half of the cones"
    let share = leads(right, &["half of the", "half the", "half of my"]);
    if words
        && removes(left.first())
        && !left[1..].iter().any(verbal)
        && share.is_some_and(|n| first_noun(&right[n..]).is_some_and(|x| x.0 < 3))
        && !right
            .iter()
            .take_while(|t| t.kind == TokenKind::Word && text(t) != "and")
            .any(verbal)
    {
        return Some(led("remove", &right[0], &[&right[0..]]));
    }
    // "of the three vehicles only the van may stay, and two people ..."
    if is(left.last(), &["stay", "stays", "remain", "remains"])
        && is(left.first(), &["of", "out"])
        && clause(right)
    {
        return Some(right.to_vec());
    }
    if words && is_place(right) {
        return placed(right);
    }
    // ", with a barrier between it and me"
    if is(right.first(), &["with"]) && left.iter().any(verbal) && !left.first().is_some_and(is_verb) {
        let b = new_one(&right[1..])?;
        let at = right.get(1 + b..)?;
        let told = is_place(at)
            && !at
                .iter()
                .any(|t| verbal(t) || is(Some(t), &["its", "his", "their"]));
        return told.then_some(led("add", &right[0], &[&right[1..]]));
    }
    // "no more barriers there, but a truck coming along it"
    let no = (0..left.len()).any(|k| {
        is(left.get(k), &["no"])
            && (k == 0 || left[k - 1].kind != TokenKind::Word)
            && !left[k..].iter().any(verbal)
    });
    if no
        && words
        && let Some(b) = new_one(right)
        && right.get(b).is_some_and(|t| text(t).ends_with("ing"))
        && is_place(&right[b + 1..])
    {
        return Some(led("add", &right[0], &[&in_strip(right, left)]));
    }
    // "change the van for a bus, the car for a truck"
    const TRADES: &[&str] = &[
        "change",
        "swap",
        "exchange",
        "replace",
        "trade",
        "switch",
        "turn",
        "convert",
        "substitute",
        "transform",
    ];
    if is(left.first(), TRADES) && is(right.first(), &["the", "both", "all", "that"]) {
        let by = |t: Option<&Token>| is(t, &["for", "by", "with", "into", "against"]);
        let each = first_noun(right).filter(|n| {
            n.0 < 4
                && by(right.get(n.1))
                && new_one(&right[n.1 + 1..]).is_some()
                && left.iter().any(|t| by(Some(t)))
        });
        if let Some((_, b)) = each {
            let into = is(right.get(b), &["into"]);
            let verb = if into { text(left.first()?) } else { "replace" };
            let by = led(if into { "into" } else { "with" }, &right[b], &[&right[b + 1..]]);
            return Some(led(verb, &right[0], &[&right[..b], &by]));
        }
    }
    let corrects = leads(&left[1..], &["instead of", "rather than"]).is_some()
        || (1..left.len()).any(|k| {
            leads(&left[k..], &["instead of", "rather than"])
                .is_some_and(|n| left.get(k + n).is_some_and(|t| number(t).is_some()))
        });
    // "motorcycle at 25 m instead of 15, no car"
    let none = is(right.first(), &["no"]) && first_noun(right).is_some_and(|n| n.0 < 3 && n.1 == right.len());
    if corrects
        && !left.iter().any(verbal)
        && (none
            || words
                && new_one(right).is_some_and(|b| {
                    b == right.len()
                        || is_place(&right[b..])
                        || is(right.get(b), &["parked"])
                        || text(&right[b]).ends_with("ing")
                }))
    {
        return Some(right.to_vec());
    }
    if !words {
        return None;
    }
    // "put the officer on the left sidewalk and two pedestrians on the right one"
    let puts = is(
        left.first(),
        &[
            "put", "place", "set", "station", "position", "stand", "move", "park",
        ],
    ) && is(left.get(1), &["the", "my", "that", "both", "all"])
        && first_noun(left).is_some_and(|n| n.0 < 5 && (n.1..left.len()).any(|k| is_place(&left[k..])));
    if puts
        && let Some(b) = new_one(right)
        && right.get(b..).is_some_and(is_place)
        && !is(
            right.get(b),
            &[
                "to", "into", "away", "out", "over", "back", "closer", "nearer", "by",
            ],
        )
        && !right[b..]
            .iter()
            .any(|t| verbal(t) || t.kind == TokenKind::Comma || is(Some(t), &["and", "closer", "further"]))
    {
        let verb = if is(left.first(), &["park"]) {
            "park"
        } else {
            "add"
        };
        return Some(led(verb, &right[0], &[right]));
    }
    None
}

/// "a truck coming along it": along the lane that was named.
fn in_strip(right: &[Token], left: &[Token]) -> Vec<Token> {
    let strip = (0..left.len()).find_map(|i| {
        is(left.get(i), &["the", "my", "our"]).then_some(())?;
        let (sense, n) = longest(&left[i + 1..])?;
        matches!(sense, Sense::Place(..)).then(|| &left[i..i + 1 + n])
    });
    let Some(strip) = strip else { return right.to_vec() };
    rewritten(right, |i, out| {
        let it = is(right.get(i), &["it"]) && is(out.last(), &["along", "in", "on", "down", "up"]);
        it.then(|| {
            out.pop();
            out.extend(led("in", &right[i], &[strip]));
            i + 1
        })
    })
}

/// "behind the car there should be a truck", "farther on, 25 m ahead of me, an excavator standing in my lane".
fn placed(right: &[Token]) -> Option<Vec<Token>> {
    if let Some(k) = (1..right.len().min(14)).find(|k| leads(&right[*k..], THERE_IS).is_some()) {
        let before = &right[..k];
        let own = !before.iter().any(verbal) && !is(before.last(), &["that", "which", "where", "if"]);
        return (own && has_noun(&right[k..])).then_some(right.to_vec());
    }
    // (a comma parts the place from who is there)
    let k = (1..right.len().min(16))
        .find(|k| right[*k].kind == TokenKind::Comma && new_one(&right[k + 1..]).is_some())?;
    let b = new_one(&right[k + 1..])? + k + 1;
    let stands = right
        .get(b)
        .is_none_or(|t| text(t).ends_with("ing") || is(Some(t), &["parked", "stopped"]));
    let place = &right[..k];
    let plain = !has_noun(place) && !place.iter().any(|t| verbal(t) || is(Some(t), &["and"]));
    (stands && plain).then_some(right.to_vec())
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn links_before_clauses() {
        let said = |t: &str| {
            let list: Vec<String> = parted(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("the truck should be ahead of me, and for that the cones have to be removed"),
            "the truck should be ahead of me . the cones have to be removed"
        );
        assert_eq!(
            said("remove the van and behind the car there should be a truck"),
            "remove the van . behind the car there should be a truck"
        );
        assert_eq!(
            said("put the officer on the left and two men on the right"),
            "put the officer on the left . add two men on the right"
        );
        for whole in [
            "remove the bus and the truck",
            "put a bus on the left and two cars on the right",
            "the bus should be behind the truck and in front of the car",
        ] {
            assert_eq!(said(whole), whole);
        }
    }
}
