//! Places said before who is there, where something known names one of them: "directly opposite the lorry, at the far kerb, a
//! car is parked", "behind the parked car there should be a second one". Who is there comes first.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::topics::singular_of;
use super::words::{first_noun, has_noun, is, is_place, is_unit, leads, led, longest, noun_at, number, text};

/// Words of a place that are no places themselves.
const SMALL: &[&str] = &[
    "the",
    "that",
    "our",
    "my",
    "us",
    "me",
    "of",
    "and",
    "just",
    "directly",
    "right",
    "left",
    "straight",
    "exactly",
    "immediately",
    "shortly",
    "close",
    "hand",
    "side",
    "far",
    "other",
    "opposite",
    "same",
    "own",
    "on",
    "in",
    "at",
    "to",
    "from",
    "its",
    "road",
    "street",
    "lane",
    "edge",
    "again",
    "further",
    "both",
];
const BEFORE: &[&str] = &[
    "just",
    "directly",
    "right",
    "straight",
    "exactly",
    "immediately",
    "shortly",
    "close",
    "somewhere",
];
const THERE: &[&str] = &[
    "there should be",
    "there must be",
    "there has to be",
    "there ought to be",
    "there needs to be",
    "there is to be",
    "there shall be",
    "there could be",
    "there is",
    "theres",
    "there will be",
    "should be",
    "i want",
    "i want to see",
    "i would like",
    "i would like to see",
    "i need",
    "we need",
    "we see",
    "let there be",
];
/// One more of what the place names.
const ONE_MORE: &[&str] = &[
    "a second one",
    "a third one",
    "another one",
    "a further one",
    "one more",
    "yet another one",
    "another",
    "a second",
    "a third",
    "one like it",
    "one of the same kind",
    "another of the same kind",
];

/// A sentence (without its stop) in its plain order.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = held(&tokens).unwrap_or(tokens);
    ordered(&out, talk).unwrap_or(out)
}

/// "the cross street gets one more truck": put it there.
fn held(tokens: &[Token]) -> Option<Vec<Token>> {
    const GETS: &[&str] = &[
        "gets",
        "should get",
        "is to get",
        "receives",
        "should receive",
        "is given",
        "needs",
        "could use",
        "wants",
        "should have",
        "must have",
        "should hold",
        "should carry",
        "must get",
        "has to get",
    ];
    is(tokens.first(), &["the", "our"]).then_some(())?;
    let own = usize::from(is(tokens.get(1), &["far", "near", "same"]));
    let n = match longest(tokens.get(1 + own..)?) {
        Some((Sense::Place(..), n)) => 1 + own + n,
        _ if is(tokens.first(), &["our"]) && is(tokens.get(1), &["lane"]) => 2,
        _ => return None,
    };
    let gets = n + leads(&tokens[n..], GETS)?;
    let np = &tokens[gets..];
    let fresh = is(np.first(), &["a", "an", "another"]) || np.first().and_then(number).is_some();
    let (_, b) = first_noun(np).filter(|x| fresh && x.0 < 5)?;
    (b == np.len()).then_some(())?;
    let wide = tokens[..n].iter().any(|t| {
        is(
            Some(t),
            &[
                "sidewalk",
                "pavement",
                "crossing",
                "street",
                "road",
                "roadside",
                "zebra",
                "crosswalk",
                "footpath",
                "verge",
            ],
        )
    });
    let at = led(if wide { "on" } else { "in" }, &tokens[0], &[&tokens[..n]]);
    Some(led("add", &tokens[0], &[np, &at]))
}

fn comma(t: &Token) -> bool {
    t.kind == TokenKind::Comma
}

/// True if nothing but places stands here, and each thing that they name is known.
fn only_places(tokens: &[Token]) -> bool {
    let mut i = 0;
    let mut known = false;
    while i < tokens.len() {
        let t = &tokens[i];
        if let Some(n) = noun_at(&tokens[i..]) {
            if !known {
                return false;
            }
            known = false;
            i += n;
            continue;
        }
        known |= is(Some(t), &["the", "that", "both", "those", "these"]);
        let described = known
            && matches!(
                look_up(text(t)),
                Some(
                    Sense::Color(_)
                        | Sense::State(_, false)
                        | Sense::Size(_)
                        | Sense::Attribute(_)
                        | Sense::Count(_)
                )
            );
        let place = is_place(&tokens[i..])
            || matches!(longest(&tokens[i..]), Some((Sense::Place(..) | Sense::Ego, _)));
        let n = match longest(&tokens[i..]) {
            Some((_, n)) if place => n,
            _ if number(t).is_some() || is_unit(Some(t)) => 1,
            _ if described || comma(t) || SMALL.contains(&text(t)) => 1,
            _ => return false,
        };
        i += n;
    }
    !known || tokens.last().is_some_and(|t| !is(Some(t), &["the", "that"]))
}

/// One more of what is named before, if that is how the clause begins: its words, and how many tokens it takes.
fn one_more(place: &[Token], clause: &[Token]) -> Option<(Vec<Token>, usize)> {
    let n = leads(clause, ONE_MORE)?;
    let next = &clause[n..];
    // ("another lorry" has a noun of its own)
    let own = first_noun(next)
        .is_some_and(|x| x.0 < 3 && !next[..x.0].iter().any(|t| is(Some(t), &["the"]) || comma(t)));
    let (a, b) = first_noun(place)?;
    (!own).then(|| (led("another", &clause[0], &[&singular_of(&place[a..b])]), n))
}

fn ordered(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let lead = leads(tokens, &["and", "then", "also", "now", "please"]).unwrap_or(0);
    let start = lead + leads(&tokens[lead..], BEFORE).unwrap_or(0);
    let goal = is(
        tokens.get(start),
        &[
            "into", "onto", "until", "till", "back", "forward", "closer", "off", "out", "up", "down", "by",
            "away", "over",
        ],
    );
    if goal || !tokens.get(start..).is_some_and(is_place) {
        return None;
    }
    let fresh = |i: usize| {
        let t = &tokens[i];
        let more = is(tokens.get(i), &["a", "an", "another", "some", "yet"])
            || number(t).is_some() && !is_place(&tokens[i..]);
        more && !is(tokens.get(i + 1), &["of"])
    };
    let at = (start + 1..tokens.len().min(start + 24)).find(|i| {
        leads(&tokens[*i..], THERE).is_some_and(|n| i + n < tokens.len() && fresh(i + n)) || fresh(*i)
    })?;
    let mut place = &tokens[lead..at];
    let set_off = place.iter().any(comma);
    while place.last().is_some_and(comma) {
        place = &place[..place.len() - 1];
    }
    let open = is(
        place.last(),
        &[
            "of", "to", "on", "in", "at", "from", "and", "between", "opposite", "behind", "beside", "near",
            "by", "with", "after", "before", "past", "than",
        ],
    );
    let named = has_noun(place);
    if !set_off && (open || !named) || !only_places(place) {
        return None;
    }
    let there = leads(&tokens[at..], THERE).unwrap_or(0);
    let clause = &tokens[at + there..];
    let (who, rest) = match one_more(place, clause) {
        Some((who, n)) => (who, &clause[n..]),
        None => {
            let (_, b) = first_noun(clause).filter(|x| x.0 < 5)?;
            (clause[..b].to_vec(), &clause[b..])
        }
    };
    // one clause only, of one thing
    let several = (0..rest.len()).any(|k| {
        is(
            rest.get(k),
            &["and", "but", "while", "which", "who", "that", "so"],
        ) || rest[k].kind == TokenKind::Mark
            || comma(&rest[k]) && has_noun(&rest[k..])
    });
    if several || rest.iter().any(|t| t.kind == TokenKind::Stop) || talk.text.len() > 400 {
        return None;
    }
    // ("have been left" is no place)
    let left = |k: usize| {
        k > 0 && is(rest.get(k), &["left"]) && is(rest.get(k - 1), &["been", "is", "are", "was", "were"])
    };
    let split = (0..rest.len())
        .find(|k| comma(&rest[*k]) || is_place(&rest[*k..]) && !left(*k))
        .unwrap_or(rest.len());
    // ("a courier on a motorbike" is one)
    let mount = leads(&rest[split..], &["on a", "on an", "on his", "on her"])
        .filter(|_| has_noun(&rest[split..]))
        .map_or(0, |_| first_noun(&rest[split..]).map_or(0, |x| x.1));
    let (verb, late) = rest.split_at(split + mount);
    let places: Vec<Token> = place.iter().filter(|t| !comma(t)).cloned().collect();
    let set_off = late.first().is_some_and(comma)
        && late.get(1..).is_some_and(|next| {
            !is_place(next)
                && !matches!(
                    next.first().and_then(|t| look_up(text(t))),
                    Some(Sense::State(..))
                )
        });
    // (what is set off and is no place speaks of more than that)
    if set_off {
        return None;
    }
    let late: Vec<Token> = late.iter().filter(|t| !comma(t)).cloned().collect();
    let lead = match there > 0 {
        true if number(&who[0]).is_some_and(|n| n > 1) => led("there should be", &tokens[at], &[]),
        true => led("add", &tokens[at], &[]),
        false if verb.is_empty() => led("add", &tokens[at], &[]),
        false => Vec::new(),
    };
    Some([&lead[..], &who, verb, &places, &late].concat())
}
