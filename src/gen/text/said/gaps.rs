//! What an edit leaves out because the same sentence said it: "another behind it", "the one that is already there", and places
//! said before the command.

use super::super::lexicon::plural;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{find, first_noun, is, is_place, leads, led, noun_at, number, text, trimmed, unit_at};

const MORE: &[&str] = &[
    "another one",
    "a second one",
    "a third one",
    "a further one",
    "yet another one",
    "one more",
    "yet another",
    "another",
    "a second",
    "a third",
    "a new one",
];
const THERE: &[&str] = &[
    "the one thats already there",
    "the one that is already there",
    "the one thats there",
    "the one that is there",
    "the one already there",
    "the one there",
    "the existing one",
    "the present one",
    "the one we have",
    "the one that we have",
    "the one we already have",
    "the one thats there already",
    "the one that is there already",
    "the old one",
    "the current one",
    "the one there already",
    "the one i already have",
    "the original one",
    "the original",
    "the one in the scene",
];
const FIRST: &[&str] = &["the first one", "the first", "the other one"];
const WHOEVER: &[&str] = &[
    "whoever is",
    "whoever stands",
    "whoever is standing",
    "whoever walks",
    "whoever is walking",
    "whoevers",
    "anyone who is",
    "anybody who is",
    "everyone who is",
    "everybody who is",
    "all those who are",
    "those who are",
    "everyone who stands",
    "everybody who stands",
    "anyone who stands",
    "all who are",
    "whoever happens to be",
    "anyone standing",
    "everybody standing",
    "everyone standing",
];
const RIDERS: &[(&str, &[&str])] = &[
    ("cyclist", &["bike", "bicycle", "pushbike", "cycle"]),
    ("motorcyclist", &["motorbike", "motorcycle", "scooter", "moped"]),
];

/// The sentence with what it leaves out.
pub fn filled(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = people(tokens);
    let out = rider(out);
    let out = one_who(existing(out));
    let out = more_elsewhere(more_of_it(out), talk);
    place_last(out)
}

/// The noun of the sentence before a token, as it stands for one.
fn noun_before(tokens: &[Token], i: usize) -> Option<Vec<Token>> {
    let (a, b) = first_noun(&tokens[..i])?;
    let mut noun = tokens[a..b].to_vec();
    if !tokens[b - 1].text.ends_with('s') {
        return Some(super::topics::singular_of(&noun));
    }
    if let Some(last) = noun.last_mut()
        && let Some(one) = last.text.strip_suffix('s').map(str::to_string)
    {
        let mut single = last.clone();
        single.text = one;
        if noun_at(std::slice::from_ref(&single)).is_some() {
            *last = single;
        }
    }
    Some(noun)
}

/// "mark the trailer with a cone at its front and another": a cone, where the first that was named is there already.
fn fresh_before(tokens: &[Token], i: usize) -> Option<Vec<Token>> {
    let (a, b) = first_noun(&tokens[..i])?;
    let the = |t: &Token| {
        is(
            Some(t),
            &["the", "that", "both", "all", "my", "our", "these", "those"],
        )
    };
    tokens[..a].iter().rev().take(3).any(the).then_some(())?;
    let from = (b..i).find(|k| {
        (is(tokens.get(*k), &["a", "an"]) || number(&tokens[*k]).is_some())
            && unit_at(&tokens[k + 1..i]).is_none()
            && first_noun(&tokens[*k..i]).is_some_and(|n| n.0 < 4)
    })?;
    noun_before(&tokens[from..i], i - from)
}

/// "whoever is on the left pavement": all people there.
fn people(mut tokens: Vec<Token>) -> Vec<Token> {
    if let Some((i, n)) = find(&tokens, WHOEVER)
        && is_place(&tokens[i + n..])
        && first_noun(&tokens[i + n..]).is_none_or(|x| x.0 > 3)
    {
        // who tails or blocks us drives
        let drives = is(
            tokens.get(i + n),
            &[
                "tailing",
                "following",
                "driving",
                "chasing",
                "tailgating",
                "overtaking",
                "pursuing",
                "parked",
                "parking",
                "riding",
                "trailing",
                "coming",
                "oncoming",
            ],
        ) || tokens[i + n..]
            .iter()
            .any(|t| matches!(text(t), "lane" | "lanes"));
        let all = led(
            if drives { "all vehicles" } else { "all people" },
            &tokens[i],
            &[],
        );
        tokens.splice(i..i + n, all);
    }
    tokens
}

/// "the one who is on the bike": the cyclist.
fn rider(mut tokens: Vec<Token>) -> Vec<Token> {
    let one = find(
        &tokens,
        &[
            "the one who is on",
            "the one whos on",
            "the one on",
            "the one that is on",
            "the one thats on",
            "the one riding",
            "the one who is riding",
            "the person on",
            "the one who rides",
            "the man on",
            "the woman on",
            "whoever is on",
            "whoever rides",
            "whoever is riding",
            "the guy on",
        ],
    );
    let Some((i, n)) = one else {
        return tokens;
    };
    let article = usize::from(is(tokens.get(i + n), &["the", "a", "his", "her"]));
    let end = i + n + article;
    let rides = RIDERS.iter().find(|r| is(tokens.get(end), r.1));
    let foot = is(tokens.get(end), &["foot"]);
    if foot && is(tokens.get(i), &["whoever"]) {
        let all = led("all pedestrians", &tokens[i], &[]);
        tokens.splice(i..=end, all);
        return tokens;
    }
    if let Some(name) = rides.map(|r| r.0).or(foot.then_some("pedestrian")) {
        let the = led(&format!("the {name}"), &tokens[i], &[]);
        tokens.splice(i..=end, the);
    }
    tokens
}

/// "behind the one that is already there": behind the cyclist, if another cyclist is spoken of.
fn existing(mut tokens: Vec<Token>) -> Vec<Token> {
    let fresh = tokens
        .iter()
        .position(|t| matches!(text(t), "a" | "an" | "another" | "second" | "more") || number(t).is_some());
    let Some(fresh) = fresh else {
        return tokens;
    };
    let later = |x: &(usize, usize)| x.0 > fresh;
    let bare = |x: &(usize, usize)| noun_at(tokens.get(x.0 + x.1..).unwrap_or(&[])).is_none();
    let there = find(&tokens, THERE).filter(later);
    let first = find(&tokens, FIRST).filter(later).filter(bare).filter(|x| {
        x.0.checked_sub(1).is_some_and(|p| {
            is(
                tokens.get(p),
                &[
                    "behind", "of", "to", "beside", "near", "from", "before", "after", "opposite", "and",
                ],
            )
        })
    });
    let told = find(&tokens, &["the one"]).filter(later).filter(|x| {
        let next = &tokens[x.0 + x.1..];
        is(next.first(), &["that", "thats", "which", "who", "whos"]) || is_place(next)
    });
    // ("a lorry there and a second excavator near the first one": the first excavator)
    let second = first.and_then(|x| {
        let more = tokens[..x.0]
            .iter()
            .rposition(|t| matches!(text(t), "second" | "another" | "third" | "further" | "more"))?;
        let (a, b) = first_noun(&tokens[more..x.0])?;
        (a < 4).then(|| tokens[more + a..more + b].to_vec())
    });
    if let Some((i, n)) = there.or(told).or(first)
        && let Some(noun) = second.or_else(|| noun_before(&tokens, i))
    {
        let the = led("the", &tokens[i], &[&noun]);
        tokens.splice(i..i + n, the);
    }
    tokens
}

/// "let the one on the left walk across": what walks is a person.
fn one_who(mut tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["the one", "the ones"]) else {
        return tokens;
    };
    if first_noun(&tokens[..i]).is_some()
        || !is_place(&tokens[i + n..]) && !is(tokens.get(i + n), &["who", "that", "which", "whos", "thats"])
    {
        return tokens;
    }
    let many = is(tokens.get(i + 1), &["ones"]);
    let does = |list: &[&str]| tokens.iter().any(|t| list.contains(&text(t)));
    let name = if does(&[
        "walk", "walks", "walking", "cross", "crosses", "stroll", "strolls", "jog", "jogs", "who", "whos",
    ]) {
        "person"
    } else if does(&[
        "drive", "drives", "driving", "park", "parks", "parked", "brake", "overtake",
    ]) {
        "vehicle"
    } else if is(tokens.first(), &["let", "have", "make"]) {
        "object"
    } else {
        return tokens;
    };
    let name = match (name, many) {
        ("person", true) => "people".to_string(),
        (name, true) => format!("{name}s"),
        (name, false) => name.to_string(),
    };
    let the = led(&format!("the {name}"), &tokens[i], &[]);
    tokens.splice(i..i + n, the);
    tokens
}

/// "a car in front of the van and another behind it": another car.
fn more_of_it(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut i = 1;
    while i < tokens.len() {
        let found =
            leads(&tokens[i..], MORE).filter(|_| !is(tokens.get(i - 1), &["one", "the", "after", "behind"]));
        let Some(n) = found else {
            i += 1;
            continue;
        };
        let next = &tokens[i + n..];
        let own = (0..next.len().min(4))
            .take_while(|k| next[*k].kind == TokenKind::Word && (*k == 0 || !is_place(&next[*k..])))
            // ("another follow the truck" has no noun of its own)
            .take_while(|k| !is(next.get(*k), &["the", "my", "our", "it", "a", "an"]))
            .any(|k| noun_at(&next[k..]).is_some());
        let ends = next.first().is_none_or(|t| t.kind != TokenKind::Word)
            || is_place(next)
            || next.first().is_some_and(|t| {
                text(t).ends_with("ing")
                    || super::words::is_finite(text(t), true)
                    || matches!(
                        text(t),
                        "there" | "right" | "just" | "that" | "who" | "parked" | "too"
                    )
            });
        if let (false, true, Some(noun)) = (
            own,
            ends,
            fresh_before(&tokens, i).or_else(|| noun_before(&tokens, i)),
        ) {
            let more = led("another", &tokens[i], &[&noun]);
            let end = i + more.len();
            tokens.splice(i..i + n, more);
            i = end;
        } else {
            i += n;
        }
    }
    tokens
}

/// "add two people on the left sidewalk and one on the right sidewalk": one more, none of the two.
fn more_elsewhere(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const PUTS: &[&str] = &[
        "add",
        "insert",
        "include",
        "create",
        "show",
        "show me",
        "place",
        "put",
        "put in",
        "set up",
        "generate",
        "spawn",
        "i want",
        "i need",
        "we need",
        "i would like",
        "id like",
        "there are",
        "there is",
        "there should be",
        "give me",
        "let there be",
        "draw",
        "bring in",
    ];
    let Some((a, b)) = first_noun(&tokens) else {
        return tokens;
    };
    let puts = (0..a).find_map(|i| leads(&tokens[i..a], PUTS).map(|n| i + n));
    let Some(total) = puts
        .filter(|n| a < n + 4 && *n < a)
        .and_then(|n| number(&tokens[n]).or(is(tokens.get(n), &["a", "an"]).then_some(1)))
    else {
        return tokens;
    };
    // where a share of its own place begins: its number and what links it
    let mut shares: Vec<(usize, i64, bool)> = Vec::new();
    for i in b + 1..tokens.len() {
        let comma = tokens[i - 1].kind == TokenKind::Comma;
        let rest = &tokens[i + 1..];
        if let Some(n) = number(&tokens[i]).filter(|n| *n > 0)
            && (comma || is(tokens.get(i - 1), &["and", "plus"]))
            && is_place(rest)
            && unit_at(rest).is_none()
            && !is(rest.first(), &["to", "onto", "into", "back"])
        {
            shares.push((i, n, comma));
        }
    }
    let parts = shares.first().is_none_or(|s| s.2)
        && (shares.len() < 2 || shares.iter().map(|s| s.1).sum::<i64>() == total);
    if shares.is_empty()
        || parts
        || !is_place(&tokens[b..])
        || find(&tokens[b..], &["of them", "of these"]).is_some()
    {
        return tokens;
    }
    let one = noun_before(&tokens, b).unwrap_or_else(|| tokens[a..b].to_vec());
    let mut many = one.clone();
    if let Some(last) = many.last_mut() {
        last.text = plural(&last.text);
    }
    // (none of them is there yet: what there should be comes)
    let lead = puts.filter(|_| talk.fits(&one) == 0).unwrap_or(0);
    let mut out = if lead > 0 {
        led("add", &tokens[0], &[])
    } else {
        Vec::new()
    };
    for (i, t) in tokens.iter().enumerate().skip(lead) {
        out.push(t.clone());
        if let Some((_, n, _)) = shares.iter().find(|s| s.0 == i) {
            out.extend_from_slice(if *n == 1 { &one } else { &many });
        }
    }
    out
}

/// "between the truck and me, squeeze in a taxi": the command first.
fn place_last(tokens: Vec<Token>) -> Vec<Token> {
    let verb = |t: &Token| {
        super::super::rephrase::is_verb(t) && !matches!(text(t), "up" | "face" | "about" | "back" | "place")
    };
    if tokens.is_empty()
        || !is_place(&tokens)
        || verb(&tokens[0])
        || matches!(
            text(&tokens[0]),
            "to" | "into" | "onto" | "by" | "out" | "off" | "away" | "up" | "down" | "back"
        )
    {
        return tokens;
    }
    let Some(comma) = tokens
        .iter()
        .position(|t| t.kind == TokenKind::Comma)
        .filter(|c| (2..14).contains(c))
    else {
        return tokens;
    };
    let rest = trimmed(&tokens[comma + 1..]);
    let fresh = (1..rest.len().min(4))
        .any(|k| is(rest.get(k), &["a", "an", "another", "some"]) || number(&rest[k]).is_some());
    if rest.first().is_some_and(verb) && fresh && first_noun(rest).is_some() {
        let mut out = rest.to_vec();
        out.extend_from_slice(&tokens[..comma]);
        return out;
    }
    tokens
}
