//! Which one is meant, in the words that picking boxes knows: "the nearer cab", "the car that is farther away", "whichever
//! truck is farthest", "the waiting one", "the middle car", "one of the two parked cars".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::words::{first_noun, is, leads, led, noun_at, number, text, word};

const NEAREST: &[&str] = &[
    "nearer to me",
    "nearer to us",
    "closer to me",
    "closer to us",
    "nearest to me",
    "nearest to us",
    "closest to me",
    "closest to us",
    "nearest",
    "closest",
    "nearer",
    "closer",
    "closer by",
    "nearer by",
    "the nearest",
    "the closest",
    "the nearest to us",
    "the nearest to me",
    "the closest to us",
    "the closest to me",
];
const FARTHEST: &[&str] = &[
    "farther away from me",
    "farther away from us",
    "further away from me",
    "further away from us",
    "farther away",
    "further away",
    "farther from me",
    "farther from us",
    "further from me",
    "further from us",
    "farthest from me",
    "farthest from us",
    "furthest from me",
    "furthest from us",
    "farthest away",
    "furthest away",
    "farthest away from us",
    "farthest away from me",
    "furthest away from us",
    "furthest away from me",
    "farthest",
    "furthest",
    "farther",
    "further",
    "farther off",
    "further off",
    "more distant",
    "most distant",
    "the farthest",
    "the furthest",
    "the farthest away",
    "the furthest away",
    "the most distant",
    "the farthest from us",
    "the farthest from me",
];

/// The longest of both lists here: the word for the pick and how many tokens it takes.
fn pick(tokens: &[Token]) -> Option<(&'static str, usize)> {
    let near = leads(tokens, NEAREST).map(|n| ("nearest", n));
    let far = leads(tokens, FARTHEST).map(|n| ("farthest", n));
    near.into_iter().chain(far).max_by_key(|x| x.1)
}

/// A sentence with its picks in plain words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = whichever(tokens);
    let out = by_relative(out);
    the_one(comparative(out, talk), talk)
}

/// "whichever truck is farthest from us": the farthest truck.
fn whichever(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = tokens
        .iter()
        .position(|t| matches!(text(t), "whichever" | "whatever" | "which"))
    else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[i + 1..]).filter(|n| n.0 < 3) else {
        return tokens;
    };
    let (a, b) = (i + 1 + a, i + 1 + b);
    let be = is(
        tokens.get(b),
        &["is", "stands", "happens", "drives", "comes", "are", "was"],
    );
    let from = b + 1 + usize::from(is(tokens.get(b), &["happens"])) * 2;
    match tokens.get(from..).and_then(pick).filter(|_| be) {
        Some((word, n)) => {
            let mut out = tokens[..i].to_vec();
            out.extend(led(
                &format!("the {word}"),
                &tokens[i],
                &[&tokens[i + 1..a], &tokens[a..b]],
            ));
            out.extend_from_slice(&tokens[from + n..]);
            out
        }
        None => tokens,
    }
}

/// "the car that is farther away from me": the farthest car.
fn by_relative(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["that", "which", "who"]).then_some(())?;
        let be = leads(
            &tokens[i + 1..],
            &["is", "are", "stands", "drives", "comes", "was"],
        )?;
        let (word, n) = pick(&tokens[i + 1 + be..])?;
        // "the car that is closer to the bus"
        let rest = &tokens[i + 1 + be + n..];
        if is(rest.first(), &["to", "than", "from", "behind"]) {
            return None;
        }
        let the = (0..i).rev().find(|k| is(tokens.get(*k), &["the"]))?;
        let noun = first_noun(&tokens[the..i]).filter(|x| x.0 < 5 && the + x.1 == i);
        noun.map(|_| (the, i, i + 1 + be + n, word))
    });
    match found {
        Some((the, that, end, pick)) => {
            let mut out = tokens[..=the].to_vec();
            out.push(word(pick, &tokens[the]));
            out.extend_from_slice(&tokens[the + 1..that]);
            out.extend_from_slice(&tokens[end..]);
            out
        }
        None => tokens,
    }
}

/// "the nearer cab", "the middle car", "Second car ahead".
fn comparative(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let the = is(tokens.get(i.wrapping_sub(1)), &["the", "that", "my"]);
        let noun = |k: usize| {
            // its adjectives may stand between
            let end = (k..tokens.len().min(k + 3)).find(|j| noun_at(&tokens[*j..]).is_some())?;
            let plain = tokens[k..end].iter().all(|t| {
                matches!(
                    look_up(text(t)),
                    Some(Sense::State(_, false) | Sense::Color(_) | Sense::Size(_))
                ) || is(Some(t), &["oncoming", "approaching"])
            });
            plain.then(|| end + noun_at(&tokens[end..]).unwrap_or(1))
        };
        let taken = [
            ("nearest", &["nearer", "closer"][..]),
            ("farthest", &["farther", "further", "more distant", "remoter"][..]),
        ]
        .into_iter()
        .find_map(|(pick, list)| leads(&tokens[i..], list).map(|n| (pick, n)))
        .filter(|(_, n)| the && noun(i + n).is_some());
        if let Some((pick, n)) = taken {
            out.push(word(pick, &tokens[i]));
            return Some(i + n);
        }
        // the middle one in order of distance
        let end = noun(i + 1);
        if let (true, true, Some(end)) = (the, is(tokens.get(i), &["middle", "central"]), end) {
            let many = talk.fits(&tokens[i + 1..end]);
            let nth = ["first", "second", "third", "fourth"].get(many.div_ceil(2).wrapping_sub(1));
            if let Some(nth) = nth.filter(|_| many % 2 == 1 && many > 1) {
                out.push(word(nth, &tokens[i]));
                return Some(i + 1);
            }
        }
        let opens = i == 0 || tokens[i - 1].kind != TokenKind::Word;
        let nth = super::super::foremost::ordinal(text(&tokens[i])).is_some() && noun(i + 1).is_some();
        if opens && nth {
            out.push(word("the", &tokens[i]));
        }
        None
    })
}

/// "behind the waiting one": the waiting car, if a car was spoken of.
fn the_one(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut out = tokens;
    for i in 2..out.len() {
        let adjective = matches!(
            look_up(text(&out[i - 1])),
            Some(Sense::State(_, false) | Sense::Pick(_) | Sense::Color(_) | Sense::Size(_))
        ) || is(
            out.get(i - 1),
            &["oncoming", "approaching", "waiting", "nearest", "farthest"],
        );
        if !is(out.get(i), &["one"]) || !adjective || !is(out.get(i - 2), &["the", "that"]) {
            continue;
        }
        let before = (0..i)
            .rev()
            .find_map(|k| noun_at(&out[k..i]).map(|n| out[k..k + n].to_vec()));
        let noun = before
            .or_else(|| talk.last.as_ref().map(|l| led(l, &out[i], &[])))
            .or_else(|| only_kind(&out[i - 1], talk).map(|l| led(&l, &out[i], &[])));
        if let Some(noun) = noun {
            let one = singular(&noun);
            out.splice(i..=i, one);
            return out;
        }
    }
    out
}

/// The one kind of vehicle of which the adjective holds for just one.
fn only_kind(adjective: &Token, talk: &Talk<'_>) -> Option<String> {
    let kinds = ["car", "truck", "bus", "motorcycle", "cyclist", "pedestrian"];
    let mut fit = kinds
        .into_iter()
        .filter(|k| talk.fits(&[adjective.clone(), word(k, adjective)]) == 1);
    let only = fit.next()?;
    fit.next().is_none().then(|| only.to_string())
}

fn singular(noun: &[Token]) -> Vec<Token> {
    let mut out = noun.to_vec();
    if let Some(last) = out.last_mut()
        && let Some(Sense::Noun(n, true)) = look_up(&last.text)
    {
        let one = last
            .text
            .strip_suffix('s')
            .filter(|w| matches!(look_up(w), Some(Sense::Noun(m, false)) if std::ptr::eq(m, n)));
        last.text = one.map_or_else(|| n.classes[0].label(), str::to_string);
    }
    out
}

/// "every car but the nearest": the nearest car.
pub fn spared(tokens: &[Token]) -> Vec<Token> {
    let ends = tokens.len();
    let tokens = tokens.to_vec();
    let found = (2..ends).find_map(|i| {
        let but = leads(
            &tokens[i..],
            &[
                "but",
                "except for",
                "except",
                "apart from",
                "save for",
                "save",
                "bar",
                "other than",
            ],
        )?;
        let from = i + but;
        let the = usize::from(is(tokens.get(from), &["the"]));
        let (pick, n) = pick(tokens.get(from + the..)?)?;
        let end = from + the + n;
        let closes = tokens.get(end).is_none_or(|t| t.kind != TokenKind::Word)
            || is(tokens.get(end), &["one", "and"])
            || super::lists::HELPERS.contains(&text(&tokens[end]));
        let (a, b) = first_noun(&tokens[..i])?;
        closes.then(|| {
            (
                from,
                end + usize::from(is(tokens.get(end), &["one"])),
                pick,
                tokens[a..b].to_vec(),
            )
        })
    });
    match found {
        Some((from, end, pick, noun)) => {
            let mut out = tokens[..from].to_vec();
            out.extend(led(&format!("the {pick}"), &tokens[from], &[&singular(&noun)]));
            out.extend_from_slice(&tokens[end..]);
            out
        }
        None => tokens,
    }
}

/// "remove one of the two parked cars", "ditch three of the cars", "remove one cone": any so many of those.
pub fn any_so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        out.push(tokens[i].clone());
        i += 1;
        let last = out.len() - 1;
        let verb = (is_verb(&out[last]) || is(out.last(), &["away", "out", "off", "rid", "of"]))
            && out[..=last].iter().rev().take(3).any(|t| {
                super::some_of::removes(Some(t))
                    || is(
                        Some(t),
                        &["rid", "ditch", "scrap", "kick", "throw", "chuck", "dump", "lose"],
                    )
            });
        let many = tokens
            .get(i)
            .and_then(|t| number(t).or(matches!(text(t), "a" | "an").then_some(1)));
        let Some(many) = many.filter(|n| verb && (1..40).contains(n)) else {
            continue;
        };
        let of = leads(
            &tokens[i + 1..],
            &["of the", "of these", "of those", "of my", "of our"],
        )
        .unwrap_or(0);
        // "one of the two": of as many as there are
        let all = usize::from(of > 0 && tokens.get(i + 1 + of).is_some_and(|t| number(t).is_some()));
        let from = i + 1 + of + all;
        let Some((_, b)) = tokens.get(from..).and_then(first_noun).filter(|n| n.0 < 4) else {
            continue;
        };
        let np = &tokens[from..from + b];
        let found = talk.fits(np);
        if found <= many as usize || is(np.first(), &["the", "other"]) {
            continue;
        }
        if is(out.get(last), &["drop", "lose", "cut", "clear"]) {
            out[last].text = "remove".into();
        }
        let any = word("any", &tokens[i]);
        out.push(any);
        // ("a car" is any one car)
        if number(&tokens[i]).is_some() {
            out.push(tokens[i].clone());
        } else {
            out.push(word("one", &tokens[i]));
        }
        i = from;
    }
    out
}
